//! The GLB container: a header, a JSON chunk, and at most one binary chunk that we read.
//!
//! Source: glTF 2.0, section 4 (binary glTF layout).

use super::super::error::Fault;

/// The first four bytes of a GLB file.
pub(crate) const GLB_MAGIC: &[u8] = b"glTF";

const JSON: u32 = 0x4e4f_534a;
const BIN: u32 = 0x004e_4942;

/// The JSON text and the binary chunk, both still unchecked.
#[derive(Debug)]
pub(super) struct Glb<'a> {
    pub(super) json: &'a [u8],
    pub(super) bin: Option<&'a [u8]>,
}

/// Splits a GLB file into its chunks; chunks of unknown kinds are skipped, as the format asks.
pub(super) fn split(bytes: &[u8]) -> Result<Glb<'_>, Fault> {
    let word = |at: usize| -> Option<u32> {
        Some(u32::from_le_bytes(bytes.get(at..at.checked_add(4)?)?.try_into().ok()?))
    };
    let (Some(version), Some(length)) = (word(4), word(8)) else {
        return Err(Fault::invalid("header", format!("{} bytes", bytes.len()), "at least 12"));
    };
    if !bytes.starts_with(GLB_MAGIC) {
        return Err(Fault::invalid("header.magic", format!("{:02x?}", &bytes[..4]), "\"glTF\""));
    }
    if version != 2 {
        return Err(Fault::Unsupported {
            place: "header.version".into(),
            feature: format!("binary glTF {version}"),
            help: "export as glTF 2.0".into(),
        });
    }
    let length = length as usize;
    if length > bytes.len() {
        let found = format!("{length}, though the file has {} bytes", bytes.len());
        return Err(Fault::invalid("header.length", found, "the length of the file (is it truncated?)"));
    }
    let (mut json, mut bin, mut at) = (None, None, 12_usize);
    for chunk in 0.. {
        if at == length {
            break;
        }
        let place = format!("chunks[{chunk}]");
        let (Some(size), Some(kind)) = (word(at), word(at + 4)) else {
            return Err(Fault::invalid(place, format!("{} bytes", length - at), "a chunk of at least 8"));
        };
        let (start, size) = (at + 8, size as usize);
        // Some writers leave the padding of the last chunk out of the file's length.
        let Some(end) = start.checked_add(size).filter(|&end| end <= length) else {
            let found = format!("a length of {size}");
            let left = length.saturating_sub(start);
            return Err(Fault::invalid(format!("{place}.length"), found, format!("at most {left}")));
        };
        match (chunk, kind) {
            (0, JSON) => json = Some(&bytes[start..end]),
            (0, _) => break,
            (_, BIN) if bin.is_none() => bin = Some(&bytes[start..end]),
            _ => {}
        }
        at = end;
    }
    let json = json.ok_or_else(|| Fault::invalid("chunks[0]", "no JSON chunk", "one"))?;
    Ok(Glb { json, bin })
}
