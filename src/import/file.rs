//! Reads files that somebody else named: regular files only, within a size limit, and for resources
//! only below the scene's folder.

use std::fs::{self, File};
use std::io::Read;
use std::path::{Component, Path, PathBuf};

use super::budget::Budget;
use super::error::Fault;

/// The bytes of the regular file at `path`, charged to `budget`.
pub(crate) fn read_regular(path: &Path, budget: &mut Budget) -> Result<Vec<u8>, Fault> {
    let fault = |reason: String| Fault::File { path: path.into(), reason };
    // Asks for the kind before opening, since opening a pipe would wait for its writer.
    let meta = fs::metadata(path).map_err(|e| fault(reason(&e)))?;
    if meta.is_dir() {
        return Err(fault("found a folder, expected a file".into()));
    }
    if !meta.is_file() {
        return Err(fault("found a pipe, socket or device, expected a regular file".into()));
    }
    let place = path.file_name().unwrap_or_default().to_string_lossy();
    budget.charge_bytes(meta.len(), 1, &place)?;
    let mut bytes = Vec::with_capacity(meta.len() as usize);
    // A file that grows meanwhile is cut where it ended, and found wanting by the parser.
    let file = File::open(path).map_err(|e| fault(reason(&e)))?;
    file.take(meta.len()).read_to_end(&mut bytes).map_err(|e| fault(reason(&e)))?;
    Ok(bytes)
}

/// The bytes of the regular file at `path`, which `place` names.
pub(crate) fn read_named(path: &Path, place: &str, budget: &mut Budget) -> Result<Vec<u8>, Fault> {
    read_regular(path, budget).map_err(|fault| match fault {
        Fault::File { path, reason } => Fault::File { path, reason: format!("{reason} ({place} names it)") },
        other => other,
    })
}

/// What a reference that stays in the scene's folder looks like.
const BELOW: &str = "a relative path below the scene's folder, or a data: URI";

/// The file that the relative reference `uri` names, which must lie below `folder`.
pub(crate) fn resolve(folder: &Path, uri: &str, place: &str) -> Result<PathBuf, Fault> {
    below(folder, &relative(uri, place)?, place)
}

/// The relative path that `uri` stands for: no scheme, and %-escapes undone.
pub(crate) fn relative(uri: &str, place: &str) -> Result<String, Fault> {
    let fault = |found: String| Fault::invalid(place, found, BELOW);
    let colon = uri.find(':').unwrap_or(usize::MAX);
    if colon < uri.find('/').unwrap_or(usize::MAX) {
        return Err(fault(format!("the scheme {:?}", &uri[..=colon])));
    }
    percent_decode(uri)
        .and_then(|bytes| String::from_utf8(bytes).ok())
        .ok_or_else(|| fault(format!("{uri:?}, which is no path")))
}

/// The file at the path `relative` from `folder`, which must lie below it.
pub(crate) fn below(folder: &Path, relative: &str, place: &str) -> Result<PathBuf, Fault> {
    let fault = |found: String| Fault::invalid(place, found, BELOW);
    if relative.is_empty() || relative.contains(['\0', '\\']) {
        return Err(fault(format!("{relative:?}, which is no path")));
    }
    let mut depth = 0_i64;
    for part in Path::new(relative).components() {
        depth += match part {
            Component::Normal(_) => 1,
            Component::CurDir => 0,
            Component::ParentDir => -1,
            Component::RootDir | Component::Prefix(_) => i64::MIN / 2,
        };
        if depth < 0 {
            return Err(fault(format!("{relative:?}, which leads outside")));
        }
    }
    // Symbolic links may lead outside as well.
    let path = folder.join(relative);
    let real = |p: &Path| {
        p.canonicalize().map_err(|e| Fault::File {
            path: path.clone(),
            reason: format!("{} ({place} names it)", reason(&e)),
        })
    };
    let folder = real(if folder.as_os_str().is_empty() { Path::new(".") } else { folder })?;
    if real(&path)?.starts_with(folder) {
        Ok(path)
    } else {
        Err(fault(format!("{relative:?}, a link that leads outside")))
    }
}

/// `relative` without `.` and `..`, and with `/` between names.
pub(crate) fn tidy(relative: &str) -> String {
    let mut names: Vec<std::borrow::Cow<'_, str>> = Vec::new();
    for part in Path::new(relative).components() {
        match part {
            Component::Normal(name) => names.push(name.to_string_lossy()),
            Component::ParentDir => _ = names.pop(),
            Component::CurDir | Component::RootDir | Component::Prefix(_) => {}
        }
    }
    names.join("/")
}

/// The bytes in a `data:` URI, or `None` where `uri` is of another kind.
pub(crate) fn data_uri(uri: &str, place: &str) -> Option<Result<Vec<u8>, Fault>> {
    let is_data = uri.get(..5).is_some_and(|s| s.eq_ignore_ascii_case("data:"));
    let decode = |rest: &str| {
        let (head, body) = rest.split_once(',')?;
        let base64 = head.len() >= 7
            && head.is_char_boundary(head.len() - 7)
            && head[head.len() - 7..].eq_ignore_ascii_case(";base64");
        if base64 { base64_decode(body) } else { percent_decode(body) }
    };
    is_data.then(|| {
        decode(&uri[5..]).ok_or_else(|| Fault::invalid(place, "a broken data: URI", "base64 or %-escapes"))
    })
}

/// What the file system said, without the operating system's number.
fn reason(e: &std::io::Error) -> String {
    match e.kind() {
        std::io::ErrorKind::NotFound => "no such file".into(),
        std::io::ErrorKind::PermissionDenied => "permission denied".into(),
        _ => e.to_string(),
    }
}

/// Undoes %-escapes (RFC 3986, section 2.1).
fn percent_decode(text: &str) -> Option<Vec<u8>> {
    let mut out = Vec::with_capacity(text.len());
    let mut bytes = text.bytes();
    while let Some(byte) = bytes.next() {
        out.push(if byte == b'%' {
            let mut digit = || char::from(bytes.next()?).to_digit(16);
            (digit()? * 16 + digit()?) as u8
        } else {
            byte
        });
    }
    Some(out)
}

/// Base64 with the standard or the URL alphabet, padded or not (RFC 4648).
fn base64_decode(text: &str) -> Option<Vec<u8>> {
    let text = text.trim_end_matches('=').as_bytes();
    if text.len() % 4 == 1 {
        return None;
    }
    let mut out = Vec::with_capacity(text.len() / 4 * 3 + 2);
    for group in text.chunks(4) {
        let mut bits = 0_u32;
        for &c in group {
            let six = match c {
                b'A'..=b'Z' => c - b'A',
                b'a'..=b'z' => c - b'a' + 26,
                b'0'..=b'9' => c - b'0' + 52,
                b'+' | b'-' => 62,
                b'/' | b'_' => 63,
                _ => return None,
            };
            bits = bits << 6 | u32::from(six);
        }
        bits <<= 6 * (4 - group.len());
        out.extend_from_slice(&bits.to_be_bytes()[1..group.len()]);
    }
    Some(out)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The test vectors of RFC 4648, section 10, and its URL alphabet.
    #[test]
    fn base64_reads_the_vectors_of_its_rfc() {
        let check = |text: &str, expected: Option<&[u8]>| {
            assert_eq!(base64_decode(text).as_deref(), expected, "{text}");
        };
        check("", Some(b""));
        check("Zg==", Some(b"f"));
        check("Zm8=", Some(b"fo"));
        check("Zm8", Some(b"fo"));
        check("Zm9v", Some(b"foo"));
        check("Zm9vYmFy", Some(b"foobar"));
        check("-_8=", Some(&[0xfb, 0xff]));
        check("Z", None);
        check("Zm 9v", None);
    }

    /// No reference of a scene may reach a file outside its folder (gltf-pipeline#673).
    #[test]
    fn references_stay_below_the_folder() {
        let dir = tempfile::tempdir().unwrap();
        let inside = dir.path().join("scene");
        fs::create_dir_all(inside.join("sub")).unwrap();
        for file in ["a b.bin", "sub/c.bin"] {
            fs::write(inside.join(file), "x").unwrap();
        }
        fs::write(dir.path().join("secret"), "x").unwrap();
        let good = |uri: &str| assert!(resolve(&inside, uri, "here").is_ok(), "{uri}");
        good("a%20b.bin");
        good("./sub/c.bin");
        good("sub/../a b.bin");
        let bad = |uri: &str| assert!(resolve(&inside, uri, "here").is_err(), "{uri}");
        bad("../secret");
        bad("%2e%2e/secret");
        bad("sub/../../secret");
        bad(dir.path().join("secret").to_str().unwrap());
        bad("file:///etc/hostname");
        bad("C:secret");
        bad("a%ff");
        bad("a%2");
        bad("a%00b");
        bad("");
        #[cfg(unix)]
        {
            std::os::unix::fs::symlink(dir.path().join("secret"), inside.join("link")).unwrap();
            bad("link");
        }
    }
}
