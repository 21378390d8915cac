//! Pictures as bytes.

use image::codecs::jpeg::JpegEncoder;
use image::codecs::png::{CompressionType, FilterType, PngEncoder};
use image::{ExtendedColorType, ImageEncoder};
use tonic::Status;

use crate::wire::ImageFormat;

/// Quality of JPEG where a request gives none.
const JPEG_QUALITY: u8 = 95;

/// How a picture is packed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Packing {
    /// PNG, three channels.
    Png,
    /// JPEG of a quality from 1 to 100.
    Jpeg(u8),
    /// All red bytes row by row, then all green, then all blue.
    Planar,
}

impl Packing {
    /// Reads the packing of a request. Quality is a percentage, or a share up to 1; 0 stands for 95. Errors in one line
    /// if the format is not served or the quality is beyond 100.
    pub fn from_format(image_format: i32, quality: f32) -> Result<Self, Status> {
        const SERVED: &str = "expected PNG (1), JPEG (2) or RGB_UINT8_PLANAR (4)";
        match ImageFormat::try_from(image_format) {
            Ok(ImageFormat::Png) => Ok(Self::Png),
            Ok(ImageFormat::RgbUint8Planar) => Ok(Self::Planar),
            Ok(ImageFormat::Jpeg) => {
                // Written so that NaN fails too.
                if !(0.0..=100.0).contains(&quality) {
                    return Err(Status::invalid_argument(format!(
                        "image_quality is {quality}, expected 0 to 100"
                    )));
                }
                let percent = if quality <= 1.0 { quality * 100.0 } else { quality };
                Ok(Self::Jpeg(match percent.round() as u8 {
                    0 => JPEG_QUALITY,
                    percent => percent,
                }))
            }
            Ok(ImageFormat::Undefined) => Err(Status::invalid_argument(format!(
                "image_format is UNDEFINED (0), {SERVED}"
            ))),
            Ok(other) => Err(Status::unimplemented(format!(
                "image_format is {} ({image_format}), {SERVED}",
                format!("{other:?}").to_uppercase()
            ))),
            Err(_) => Err(Status::invalid_argument(format!(
                "image_format is {image_format}, {SERVED}"
            ))),
        }
    }
}

/// Packs a picture of RGBA, row by row. Errors if an encoder does.
pub fn pack([width, height]: [u32; 2], rgba: Vec<u8>, packing: Packing) -> Result<Vec<u8>, Status> {
    let pixels = rgba.as_chunks::<4>().0;
    if packing == Packing::Planar {
        let planes = (0..3).flat_map(|i| pixels.iter().map(move |p| p[i]));
        return Ok(planes.collect());
    }
    let mut rgb = Vec::with_capacity(pixels.len() * 3);
    pixels.iter().for_each(|p| rgb.extend_from_slice(&p[..3]));
    drop(rgba);
    let mut out = Vec::new();
    let done =
        match packing {
            Packing::Jpeg(quality) => JpegEncoder::new_with_quality(&mut out, quality).write_image(
                &rgb,
                width,
                height,
                ExtendedColorType::Rgb8,
            ),
            _ => PngEncoder::new_with_quality(&mut out, CompressionType::Fast, FilterType::Adaptive)
                .write_image(&rgb, width, height, ExtendedColorType::Rgb8),
        };
    done.map_err(|e| Status::internal(format!("encode a picture of {width}x{height}: {e}")))?;
    Ok(out)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pictures_come_back() {
        let size = [5, 3];
        let rgba: Vec<u8> = (0..15).flat_map(|i| [i * 16, 255 - i * 16, i, 255]).collect();
        let png = pack(size, rgba.clone(), Packing::Png).expect("packed");
        let back = image::load_from_memory(&png).expect("a picture");
        assert_eq!(back.color(), image::ColorType::Rgb8);
        assert_eq!(back.to_rgba8().into_raw(), rgba);
        let planar = pack(size, rgba.clone(), Packing::Planar).expect("packed");
        assert_eq!(planar.len(), 45);
        assert_eq!([planar[2], planar[17], planar[32]], [32, 223, 2]);
        let jpeg = pack(size, rgba, Packing::Jpeg(95)).expect("packed");
        let back = image::load_from_memory(&jpeg).expect("a picture");
        assert_eq!([back.width(), back.height()], size);
    }

    #[test]
    fn formats_and_qualities_are_checked() {
        assert_eq!(Packing::from_format(2, 95.0).expect("JPEG"), Packing::Jpeg(95));
        assert_eq!(Packing::from_format(2, 0.9).expect("JPEG"), Packing::Jpeg(90));
        assert_eq!(Packing::from_format(2, 0.0).expect("JPEG"), Packing::Jpeg(95));
        assert_eq!(Packing::from_format(1, f32::NAN).expect("PNG"), Packing::Png);
        let code = |format, quality| Packing::from_format(format, quality).expect_err("refused").code();
        assert_eq!(code(2, f32::NAN), tonic::Code::InvalidArgument);
        assert_eq!(code(2, 101.0), tonic::Code::InvalidArgument);
        assert_eq!(code(0, 1.0), tonic::Code::InvalidArgument);
        assert_eq!(code(77, 1.0), tonic::Code::InvalidArgument);
        for format in [3, 5, 6] {
            assert_eq!(code(format, 1.0), tonic::Code::Unimplemented);
        }
    }
}
