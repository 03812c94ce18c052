//! The GLB container: a header, a JSON chunk, and a binary chunk (glTF 2.0, section 4).

/// The file; `None` where it would be longer than its 32-bit length can say.
pub(super) fn pack(json: &str, bin: &[u8]) -> Option<Vec<u8>> {
    let padded = |n: usize| n.next_multiple_of(4);
    let bin_chunk = if bin.is_empty() { 0 } else { 8 + padded(bin.len()) };
    let length = 12 + 8 + padded(json.len()) + bin_chunk;
    let total = u32::try_from(length).ok()?;
    let mut out = Vec::with_capacity(length);
    let word = |out: &mut Vec<u8>, n: usize| out.extend((n as u32).to_le_bytes());
    out.extend(b"glTF");
    word(&mut out, 2);
    out.extend(total.to_le_bytes());
    word(&mut out, padded(json.len()));
    out.extend(b"JSON");
    out.extend(json.as_bytes());
    out.resize(padded(out.len()), b' ');
    if !bin.is_empty() {
        word(&mut out, padded(bin.len()));
        out.extend(b"BIN\0");
        out.extend(bin);
        out.resize(padded(out.len()), 0);
    }
    Some(out)
}
