//! Numpy archives, written: named arrays of any little-endian type, compressed; equal arrays give equal bytes.

use std::io::{Cursor, Write as _};

/// One array of an archive.
pub struct Array<'a> {
    /// Name without `.npy`.
    pub name: &'a str,
    /// Numpy's type string: `|u1`, `<u2`, `<u4`, `<f4`.
    pub descr: &'a str,
    /// Length of each axis, row-major.
    pub shape: &'a [usize],
    /// Values, little-endian.
    pub bytes: Vec<u8>,
}

/// The archive as bytes.
pub fn to_bytes(arrays: &[Array<'_>]) -> Vec<u8> {
    let mut zip = zip::ZipWriter::new(Cursor::new(Vec::new()));
    let options = zip::write::SimpleFileOptions::default().last_modified_time(zip::DateTime::default());
    let mut write = || -> zip::result::ZipResult<()> {
        for a in arrays {
            // A tuple of one ends in a comma.
            let shape: String = a.shape.iter().map(|n| format!("{n}, ")).collect();
            let header = format!(
                "{{'descr': '{}', 'fortran_order': False, 'shape': ({}), }}",
                a.descr,
                shape.trim_end()
            );
            // Magic, version and length take ten bytes; data starts at a multiple of 64.
            let padded = (header.len() + 11).next_multiple_of(64) - 10;
            zip.start_file(format!("{}.npy", a.name), options)?;
            zip.write_all(b"\x93NUMPY\x01\x00")?;
            zip.write_all(&(padded as u16).to_le_bytes())?;
            zip.write_all(format!("{header:<0$}\n", padded - 1).as_bytes())?;
            zip.write_all(&a.bytes)?;
        }
        Ok(())
    };
    write().expect("writing to memory");
    zip.finish().expect("writing to memory").into_inner()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numpy_reads_what_is_written() {
        let values: Vec<u32> = (0..6).map(|i| i * 1000).collect();
        let array = |name, shape| Array {
            name,
            descr: "<u4",
            shape,
            bytes: values.iter().flat_map(|v| v.to_le_bytes()).collect(),
        };
        let bytes = to_bytes(&[array("flat", &[6]), array("square", &[2, 3])]);
        let mut zip = zip::ZipArchive::new(Cursor::new(bytes)).expect("an archive");
        for (name, shape) in [("flat.npy", vec![6]), ("square.npy", vec![2, 3])] {
            let array = npyz::NpyFile::new(zip.by_name(name).expect(name)).expect("an npy file");
            assert_eq!(array.shape(), shape);
            assert_eq!(array.into_vec::<u32>().expect("u32"), values);
        }
    }
}
