//! PNG pictures as bytes: colour, 16-bit grey, class labels with a palette; with text inside.

use image::codecs::png::PngEncoder;
use image::{ExtendedColorType, ImageEncoder, ImageResult};

/// Bytes before the first chunk, and those of the header chunk after it: length, type, 13 bytes, check sum.
const SIGNATURE: usize = 8;
const HEADER: usize = 4 + 4 + 13 + 4;
/// Place of the colour type within the file, and its value for a palette (PNG specification 11.2.2).
const COLOR_TYPE: usize = SIGNATURE + 8 + 9;
const PALETTE: u8 = 3;

/// RGBA, 8 bits each, row-major. Errors if there are not `4 * width * height` bytes.
pub fn rgba(width: usize, height: usize, pixels: &[u8]) -> ImageResult<Vec<u8>> {
    encode(width, height, pixels, ExtendedColorType::Rgba8)
}

/// Grey, 16 bits: depth in millimetres. Errors if there are not `width * height` values.
pub fn grey16(width: usize, height: usize, values: &[u16]) -> ImageResult<Vec<u8>> {
    let bytes: Vec<u8> = values.iter().flat_map(|v| v.to_ne_bytes()).collect();
    encode(width, height, &bytes, ExtendedColorType::L16)
}

/// Labels, 8 bits, with the colour of each: viewers show the colours, programs read the labels. Errors if there are
/// not `width * height` labels or not 1 to 256 colours, or a label has none.
pub fn indexed(width: usize, height: usize, labels: &[u8], palette: &[[u8; 3]]) -> ImageResult<Vec<u8>> {
    let highest = labels.iter().max().copied().unwrap_or(0);
    if usize::from(highest) >= palette.len() || palette.len() > 256 {
        let problem = format!(
            "label {highest} and {} colours, expected a colour for each label",
            palette.len()
        );
        return Err(image::ImageError::Parameter(
            image::error::ParameterError::from_kind(image::error::ParameterErrorKind::Generic(problem)),
        ));
    }
    // A grey picture has the very bytes of a palette picture but for the header; the encoder writes no palettes.
    let mut bytes = encode(width, height, labels, ExtendedColorType::L8)?;
    bytes[COLOR_TYPE] = PALETTE;
    let check = crc32(&bytes[SIGNATURE + 4..SIGNATURE + HEADER - 4]);
    bytes[SIGNATURE + HEADER - 4..SIGNATURE + HEADER].copy_from_slice(&check.to_be_bytes());
    insert(&mut bytes, &chunk(b"PLTE", palette.as_flattened()));
    Ok(bytes)
}

/// Adds UTF-8 text under a keyword of 1 to 79 Latin letters (an iTXt chunk); another keyword adds nothing.
pub fn add_text(png: &mut Vec<u8>, keyword: &str, text: &str) {
    let sound = (1..80).contains(&keyword.len()) && keyword.bytes().all(|b| b.is_ascii_alphanumeric());
    if !sound || png.len() < SIGNATURE + HEADER {
        return;
    }
    // Not compressed; no language, no translated keyword. A zero would end the text.
    let mut body = keyword.as_bytes().to_vec();
    body.extend([0; 5]);
    body.extend(text.replace('\0', " ").into_bytes());
    insert(png, &chunk(b"iTXt", &body));
}

fn encode(width: usize, height: usize, bytes: &[u8], kind: ExtendedColorType) -> ImageResult<Vec<u8>> {
    let expected = width * height * usize::from(kind.bits_per_pixel() / 8);
    if bytes.len() != expected || expected == 0 {
        let problem = format!(
            "{} bytes for {width} x {height} pixels, expected {expected}",
            bytes.len()
        );
        return Err(image::ImageError::Parameter(
            image::error::ParameterError::from_kind(image::error::ParameterErrorKind::Generic(problem)),
        ));
    }
    let mut out = Vec::new();
    PngEncoder::new(&mut out).write_image(bytes, width as u32, height as u32, kind)?;
    Ok(out)
}

/// Puts a chunk right behind the header.
fn insert(png: &mut Vec<u8>, chunk: &[u8]) {
    let at = SIGNATURE + HEADER;
    png.splice(at..at, chunk.iter().copied());
}

fn chunk(kind: &[u8; 4], body: &[u8]) -> Vec<u8> {
    let mut out = (body.len() as u32).to_be_bytes().to_vec();
    out.extend(kind);
    out.extend(body);
    let check = crc32(&out[4..]);
    out.extend(check.to_be_bytes());
    out
}

/// The check sum of PNG chunks (specification, annex D).
fn crc32(bytes: &[u8]) -> u32 {
    let step = |crc: u32, byte: &u8| {
        (0..8).fold(crc ^ u32::from(*byte), |c, _| {
            if c & 1 == 1 {
                0xedb8_8320 ^ (c >> 1)
            } else {
                c >> 1
            }
        })
    };
    !bytes.iter().fold(u32::MAX, step)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn labels_read_back_as_their_colours() {
        assert_eq!(crc32(b"123456789"), 0xcbf4_3926); // the check value of CRC-32/ISO-HDLC
        let palette = [[1, 2, 3], [200, 100, 50], [9, 8, 7]];
        let labels = [0, 1, 2, 2, 1, 0, 1, 1];
        let mut bytes = indexed(4, 2, &labels, &palette).expect("sound");
        add_text(&mut bytes, "Prompt", "Nebel, 5 °C");
        let image = image::load_from_memory(&bytes).expect("a PNG").to_rgb8();
        assert_eq!(image.dimensions(), (4, 2));
        let found: Vec<[u8; 3]> = image.pixels().map(|p| p.0).collect();
        assert_eq!(found, labels.map(|l| palette[usize::from(l)]));
        assert!(
            bytes
                .windows(11)
                .any(|w| w == "Nebel, 5 °C".as_bytes()[..11].to_vec())
        );
        let before = bytes.clone();
        add_text(&mut bytes, "", "no keyword");
        assert_eq!(bytes, before);
    }

    #[test]
    fn depths_keep_all_bits_and_wrong_sizes_are_refused() {
        let values = [0, 1, 255, 256, 40_000, 65_535];
        let bytes = grey16(3, 2, &values).expect("sound");
        let image = image::load_from_memory(&bytes).expect("a PNG").to_luma16();
        assert_eq!(image.into_raw(), values);
        grey16(4, 2, &values).expect_err("too few");
        rgba(0, 0, &[]).expect_err("nothing");
        indexed(1, 1, &[3], &[[0; 3]; 3]).expect_err("no colour for label 3");
    }
}
