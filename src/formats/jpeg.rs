//! JPEG pictures as bytes, for formats that ask for them.

use image::ExtendedColorType;
use image::codecs::jpeg::JpegEncoder;

/// Quality of every picture, 1 to 100.
const QUALITY: u8 = 95;

/// sRGB of a picture as JPEG, 95 %; alpha is left out. Pixels are four bytes each, row-major, top row first. Errors in one
/// line if there are not `4 * width * height` bytes, none, or a side has more than 65,535 pixels.
pub fn rgba(width: usize, height: usize, pixels: &[u8]) -> Result<Vec<u8>, String> {
    let expected = width.saturating_mul(height).saturating_mul(4);
    let sides = [width, height].map(u16::try_from);
    let ([Ok(columns), Ok(rows)], true) = (sides, pixels.len() == expected && expected > 0) else {
        return Err(format!(
            "a picture of {width} x {height} pixels in {} bytes, expected {expected}, and sides of 1 to {}",
            pixels.len(),
            u16::MAX
        ));
    };
    let (pixels, _) = pixels.as_chunks::<4>();
    let rgb: Vec<u8> = pixels.iter().flat_map(|[r, g, b, _]| [*r, *g, *b]).collect();
    let mut out = Vec::new();
    JpegEncoder::new_with_quality(&mut out, QUALITY)
        .encode(&rgb, columns.into(), rows.into(), ExtendedColorType::Rgb8)
        .map_err(|e| format!("the picture could not be encoded: {e}"))?;
    Ok(out)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn colours_come_back_and_wrong_sizes_are_refused() {
        let pixels: Vec<u8> = (0..64 * 32)
            .flat_map(|i| match i % 64 < 32 {
                true => [200, 30, 40, 255],
                false => [10, 90, 210, 255],
            })
            .collect();
        let bytes = rgba(64, 32, &pixels).expect("sound");
        let image = image::load_from_memory(&bytes).expect("a JPEG").to_rgb8();
        assert_eq!(image.dimensions(), (64, 32));
        for (x, expected) in [(4, [200, 30, 40]), (60, [10, 90, 210])] {
            let found = image.get_pixel(x, 16).0;
            assert!(
                found.iter().zip(expected).all(|(a, b)| a.abs_diff(b) < 6),
                "{found:?}"
            );
        }
        for (width, height) in [(64, 31), (0, 0), (70_000, 1), (usize::MAX, 2)] {
            rgba(width, height, &pixels).expect_err("no such picture");
        }
    }
}
