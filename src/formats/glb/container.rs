//! The GLB container: a header, a chunk of JSON and a chunk of bytes (glTF 2.0, section 4).

use crate::FormatError;

const MAGIC: &[u8; 4] = b"glTF";
const VERSION: u32 = 2;
const JSON: &[u8; 4] = b"JSON";
const BIN: &[u8; 4] = b"BIN\0";
/// Bytes of the file's header, and of a chunk's.
const HEADER: usize = 12;
const CHUNK_HEADER: usize = 8;

/// The chunks of a GLB file.
pub(crate) struct Chunks<'a> {
    /// The document, as UTF-8.
    pub(crate) json: &'a [u8],
    /// The first buffer; `None` if the file has no such chunk.
    pub(crate) bin: Option<&'a [u8]>,
}

/// True for the first bytes of a GLB file.
pub(crate) fn is_glb(head: &[u8]) -> bool {
    head.starts_with(MAGIC)
}

/// Takes a GLB file apart. Chunks of other kinds are passed over, as the standard wants it.
pub(crate) fn split(bytes: &[u8]) -> Result<Chunks<'_>, FormatError> {
    let word = |at: usize| {
        let word = bytes.get(at..at.checked_add(4)?)?;
        Some(u32::from_le_bytes(word.try_into().ok()?))
    };
    let cut = || FormatError::new(format!("{} bytes, expected a GLB file", bytes.len()));
    let version = word(4).ok_or_else(cut)?;
    if version != VERSION {
        return Err(FormatError::new(format!(
            "GLB version {version}, expected {VERSION}"
        )));
    }
    let length = word(8).ok_or_else(cut)? as usize;
    if length > bytes.len() || length < HEADER {
        return Err(FormatError::new(format!(
            "{} bytes, expected {length} as in the header of the GLB",
            bytes.len()
        )));
    }
    let (mut at, mut json, mut bin) = (HEADER, None, None);
    while at < length {
        let size = word(at).ok_or_else(cut)? as usize;
        let kind = bytes.get(at + 4..at + CHUNK_HEADER).ok_or_else(cut)?;
        let from = at + CHUNK_HEADER;
        let to = from.checked_add(size).filter(|to| *to <= length).ok_or_else(|| {
            FormatError::new(format!(
                "a chunk of {size} bytes at byte {at}, expected at most {}",
                length.saturating_sub(from)
            ))
        })?;
        match kind {
            kind if kind == JSON && json.is_none() => json = Some(&bytes[from..to]),
            kind if kind == BIN && bin.is_none() => bin = Some(&bytes[from..to]),
            _ => {}
        }
        // Chunks begin at multiples of four; some writers leave out the padding of the last one.
        at = to.next_multiple_of(4);
    }
    let json = json.ok_or_else(|| FormatError::new("a GLB file without a chunk of JSON"))?;
    Ok(Chunks { json, bin })
}

/// Puts a GLB file together, without a second chunk where there are no bytes. Errors where it would be larger than the container can say.
pub(crate) fn join(json: &[u8], bin: &[u8]) -> Result<Vec<u8>, FormatError> {
    let padded = |part: &[u8]| part.len().next_multiple_of(4);
    let of = |part: &[u8]| CHUNK_HEADER + padded(part);
    let total = HEADER + of(json) + if bin.is_empty() { 0 } else { of(bin) };
    let size = |n: usize| {
        u32::try_from(n)
            .map_err(|_| FormatError::new(format!("a GLB of {total} bytes, expected below 4 GiB")))
    };
    let mut out = Vec::with_capacity(total);
    out.extend(MAGIC);
    out.extend(VERSION.to_le_bytes());
    out.extend(size(total)?.to_le_bytes());
    for (kind, part, padding) in [(JSON, json, b' '), (BIN, bin, 0)] {
        if kind == BIN && part.is_empty() {
            continue;
        }
        out.extend(size(padded(part))?.to_le_bytes());
        out.extend(kind);
        out.extend(part);
        out.resize(out.len() + padded(part) - part.len(), padding);
    }
    Ok(out)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_joined_is_split_again() {
        let file = join(b"{\"a\": 1}x", &[1, 2, 3, 4, 5]).expect("small");
        assert!(is_glb(&file) && file.len().is_multiple_of(4));
        let chunks = split(&file).expect("whole");
        assert_eq!(chunks.json, b"{\"a\": 1}x   ");
        assert_eq!(chunks.bin, Some(&[1, 2, 3, 4, 5, 0, 0, 0][..]));
    }

    #[test]
    fn every_cut_is_one_line() {
        let file = join(b"{}", &[1, 2, 3, 4]).expect("small");
        for cut in 0..file.len() {
            assert!(split(&file[..cut]).is_err(), "cut at {cut}");
        }
        let mut claims = file.clone();
        claims[12..16].copy_from_slice(&u32::MAX.to_le_bytes());
        let line = split(&claims).err().expect("a chunk of 4 GB").to_string();
        assert!(line.contains("4294967295 bytes at byte 12"), "{line}");
        let mut old = file.clone();
        old[4] = 1;
        assert!(split(&old).err().expect("old").to_string().contains("version 1"));
    }
}
