//! Pictures of 16 bits as arrays. The usual decoders of WebDataset turn every PNG into 8 bits, which leaves two
//! different values in a depth picture.

use std::path::PathBuf;

use anyhow::Context;
use formats::{atomic, npz, png};

/// Replaces each PNG of 16 bits among files that were just written by an `.npy` (u16, `[height, width]`).
pub fn as_arrays(files: &[(PathBuf, u64)]) -> anyhow::Result<()> {
    for (path, _) in files {
        if path.extension().is_none_or(|e| e != "png") {
            continue;
        }
        let bytes = std::fs::read(path).with_context(|| path.display().to_string())?;
        let Some(([width, height], values)) = png::grey16_inside(&bytes) else {
            continue;
        };
        let array = npz::npy_u16(&[height, width], &values).with_context(|| path.display().to_string())?;
        let place = path.with_extension("npy");
        atomic::write(&place, &array).with_context(|| format!("write {}", place.display()))?;
        std::fs::remove_file(path).with_context(|| format!("remove {}", path.display()))?;
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_pictures_of_16_bits_become_arrays_and_keep_their_values() {
        let folder = tempfile::tempdir().expect("a folder");
        let write = |name: &str, bytes: &[u8]| {
            let path = folder.path().join(name);
            std::fs::write(&path, bytes).expect("a file");
            (path, bytes.len() as u64)
        };
        let values: Vec<u16> = (0..12).map(|i| i * 4999).collect();
        let notes = png::Notes::default();
        let deep = png::grey16(4, 3, &values, &notes).expect("a picture");
        let plain = png::rgba(1, 1, &[1, 2, 3, 255], &notes).expect("a picture");
        let files = [
            write("a_depth_mm.png", &deep),
            write("a.png", &plain),
            write("b.json", b"{}"),
        ];
        as_arrays(&files).expect("written");
        let there = |name: &str| folder.path().join(name).exists();
        assert!(there("a.png") && there("b.json") && !there("a_depth_mm.png"));
        let array = std::fs::read(folder.path().join("a_depth_mm.npy")).expect("an array");
        let (head, body) = array.split_at(array.len() - 24);
        let head = String::from_utf8_lossy(head);
        assert!(head.contains("'<u2'") && head.contains("(3, 4"), "{head}");
        let read: Vec<u16> = body
            .chunks_exact(2)
            .map(|b| u16::from_le_bytes([b[0], b[1]]))
            .collect();
        assert_eq!(read, values);
    }
}
