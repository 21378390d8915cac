//! Numpy archives, written: named arrays, compressed; equal arrays give equal bytes.

use std::io::{self, Cursor, Read as _, Write as _};

use bytemuck::cast_slice;
use npyz::{AutoSerialize, WriteOptions, WriterBuilder};

/// One array of an archive.
pub struct Array<'a> {
    /// Name without `.npy`.
    pub name: &'a str,
    /// Length of each axis, row-major.
    pub shape: &'a [usize],
    /// The values, as many as the shape has places.
    pub values: NpzValues,
}

/// Values of an array, of one of numpy's types (little-endian in the file).
pub enum NpzValues {
    /// `|u1`.
    U8(Vec<u8>),
    /// `<u2`.
    U16(Vec<u16>),
    /// `<u4`.
    U32(Vec<u32>),
    /// `<f4`.
    F32(Vec<f32>),
}

/// The archive as bytes. Errors if an array has not as many values as its shape says.
pub fn to_bytes(arrays: &[Array<'_>]) -> io::Result<Vec<u8>> {
    let mut zip = zip::ZipWriter::new(Cursor::new(Vec::new()));
    let options = zip::write::SimpleFileOptions::default().last_modified_time(zip::DateTime::default());
    for a in arrays {
        let (header, values): (_, &[u8]) = match &a.values {
            NpzValues::U8(values) => (header::<u8>(a.shape, values.len())?, values),
            NpzValues::U16(values) => (header::<u16>(a.shape, values.len())?, cast_slice(values)),
            NpzValues::U32(values) => (header::<u32>(a.shape, values.len())?, cast_slice(values)),
            NpzValues::F32(values) => (header::<f32>(a.shape, values.len())?, cast_slice(values)),
        };
        zip.start_file(npyz::npz::file_name_from_array_name(a.name), options)?;
        zip.write_all(&header)?;
        // At once: npyz writes values one by one.
        zip.write_all(values)?;
    }
    Ok(zip.finish()?.into_inner())
}

/// An archive with one array, given as an `.npy` file.
pub fn holding(name: &str, npy: &[u8]) -> io::Result<Vec<u8>> {
    let mut zip = zip::ZipWriter::new(Cursor::new(Vec::new()));
    let options = zip::write::SimpleFileOptions::default().last_modified_time(zip::DateTime::default());
    zip.start_file(npyz::npz::file_name_from_array_name(name), options)?;
    zip.write_all(npy)?;
    Ok(zip.finish()?.into_inner())
}

/// An array of an archive as an `.npy` file; `None` if there is none of that name, or it is larger than the limit, bytes.
pub fn entry(bytes: &[u8], name: &str, limit: u64) -> Option<Vec<u8>> {
    let mut zip = zip::ZipArchive::new(Cursor::new(bytes)).ok()?;
    let file = zip.by_name(&npyz::npz::file_name_from_array_name(name)).ok()?;
    let mut out = Vec::new();
    file.take(limit + 1).read_to_end(&mut out).ok()?;
    (out.len() as u64 <= limit).then_some(out)
}

/// One array of whole numbers (`<i4`) as an `.npy` file. Errors if it has not as many values as its shape says.
pub fn npy(shape: &[usize], values: &[i32]) -> io::Result<Vec<u8>> {
    let mut out = header::<i32>(shape, values.len())?;
    out.extend_from_slice(cast_slice(values));
    Ok(out)
}

/// One array of whole numbers (`<u2`) as an `.npy` file. Errors as [`npy`] does.
pub fn npy_u16(shape: &[usize], values: &[u16]) -> io::Result<Vec<u8>> {
    let mut out = header::<u16>(shape, values.len())?;
    out.extend_from_slice(cast_slice(values));
    Ok(out)
}

/// The header that comes before so many values as they lie in memory. Errors if the shape has not as many places.
fn header<T: AutoSerialize>(shape: &[usize], values: usize) -> io::Result<Vec<u8>> {
    if shape.iter().product::<usize>() != values {
        let what = format!("{values} values in an array of shape {shape:?}");
        return Err(io::Error::new(io::ErrorKind::InvalidData, what));
    }
    let shape: Vec<u64> = shape.iter().map(|n| *n as u64).collect();
    let options = WriteOptions::<T>::new().default_dtype().shape(&shape);
    options.writer(Vec::new()).write_header_only()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numpy_reads_what_is_written() {
        let values: Vec<u32> = (0..6).map(|i| i * 1000).collect();
        let array = |name, shape| Array {
            name,
            shape,
            values: NpzValues::U32(values.clone()),
        };
        let bytes = to_bytes(&[array("flat", &[6]), array("square", &[2, 3])]).expect("memory");
        let mut zip = zip::ZipArchive::new(Cursor::new(bytes)).expect("an archive");
        for (name, shape) in [("flat.npy", vec![6]), ("square.npy", vec![2, 3])] {
            let array = npyz::NpyFile::new(zip.by_name(name).expect(name)).expect("an npy file");
            assert_eq!(array.shape(), shape);
            assert_eq!(array.into_vec::<u32>().expect("u32"), values);
        }
        to_bytes(&[array("short", &[7])]).expect_err("six values for seven places");
    }

    /// Type strings are those that other programs expect, and values begin at a multiple of 64 as numpy writes them.
    #[test]
    fn headers_are_those_of_numpy() {
        for (values, descr) in [
            (NpzValues::U8(vec![1]), "'|u1'"),
            (NpzValues::U16(vec![1]), "'<u2'"),
            (NpzValues::U32(vec![1]), "'<u4'"),
            (NpzValues::F32(vec![1.0]), "'<f4'"),
        ] {
            let one = Array {
                name: "a",
                shape: &[1],
                values,
            };
            let bytes = to_bytes(&[one]).expect("memory");
            let mut zip = zip::ZipArchive::new(Cursor::new(bytes)).expect("an archive");
            let mut npy = Vec::new();
            io::Read::read_to_end(&mut zip.by_name("a.npy").expect("a"), &mut npy).expect("whole");
            let header = usize::from(u16::from_le_bytes([npy[8], npy[9]]));
            let text = String::from_utf8_lossy(&npy[10..10 + header]).into_owned();
            assert!(text.contains(descr) && text.contains("(1,"), "{text}");
            assert_eq!((10 + header) % 16, 0);
        }
    }
}
