//! PNG pictures as bytes: colour, 16-bit grey, class labels with a palette; with text inside.

use png::{BitDepth, ColorType, Compression, Encoder, Filter};

/// Why a picture could not be encoded. One line each.
#[derive(Debug, thiserror::Error)]
pub enum PngError {
    /// The number of values is wrong: one for each pixel is needed, and at least one pixel.
    #[error("{found} values for {width} x {height} pixels, expected {expected}, and at least one")]
    Size {
        /// Pixels per row.
        width: usize,
        /// Rows.
        height: usize,
        /// Values given.
        found: usize,
        /// Values needed.
        expected: usize,
    },
    /// A label without a colour, or more colours than a palette holds.
    #[error("label {highest} and {colors} colours, expected a colour for each label, at most 256")]
    Palette {
        /// Highest label of the picture.
        highest: u8,
        /// Colours given.
        colors: usize,
    },
    /// The encoder refused.
    #[error("the picture could not be encoded: {0}")]
    Encoder(#[from] png::EncodingError),
}

/// Content of a picture beside its pixels.
#[derive(Clone, Copy, Debug, Default)]
pub struct Notes<'a> {
    /// Text: a keyword of 1 to 79 Latin letters and digits, and its value. Other keywords are left out.
    pub text: &'a [(&'a str, &'a str)],
    /// A scene as a `.loom` file.
    pub scene: Option<&'a [u8]>,
}

/// The [`Notes`] in a picture.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Inside<'a> {
    /// Keywords and their values.
    pub text: Vec<(String, String)>,
    /// A scene as a `.loom` file.
    pub scene: Option<&'a [u8]>,
}

/// First bytes of every PNG.
pub const SIGNATURE: &[u8] = b"\x89PNG\r\n\x1a\n";

/// The chunk that holds a scene: ancillary, private, safe to copy.
const SCENE_CHUNK: png::chunk::ChunkType = png::chunk::ChunkType(*b"slLm");

/// Texts that are read at most.
const MOST_TEXTS: usize = 64;

/// The notes in the bytes of a PNG; its pixels are not looked at. Errors in one line if a chunk is cut off.
pub fn notes_inside(bytes: &[u8]) -> Result<Inside<'_>, String> {
    let mut rest = bytes.strip_prefix(SIGNATURE).ok_or("no PNG")?;
    let mut inside = Inside::default();
    while !rest.is_empty() {
        let (head, after) = rest.split_at_checked(8).ok_or("cut off in a chunk's header")?;
        let length = u32::from_be_bytes([head[0], head[1], head[2], head[3]]) as usize;
        let (data, after) = after
            .split_at_checked(length)
            .ok_or_else(|| format!("a chunk of {length} bytes, expected at most {}", after.len()))?;
        let (_, after) = after.split_at_checked(4).ok_or("cut off in a check sum")?;
        match &head[4..] {
            b"slLm" => inside.scene = Some(data),
            b"iTXt" if inside.text.len() < MOST_TEXTS => inside.text.extend(plain_text(data)),
            b"IEND" => return Ok(inside),
            _ => {}
        }
        rest = after;
    }
    Err("the end of the picture is missing".into())
}

/// Keyword and text of an iTXt chunk that is not compressed.
fn plain_text(data: &[u8]) -> Option<(String, String)> {
    let mut parts = data.splitn(2, |b| *b == 0);
    let keyword = parts.next()?;
    // Flag and method of the compression, then language and translated keyword, each ending in a zero.
    let rest = parts.next()?.strip_prefix(&[0, 0])?;
    let text = rest.splitn(3, |b| *b == 0).nth(2)?;
    let read = |bytes: &[u8]| String::from_utf8(bytes.to_vec()).ok();
    Some((read(keyword)?, read(text)?))
}

/// RGBA, 8 bits each, row-major. Errors if there are not `4 * width * height` bytes.
pub fn rgba(width: usize, height: usize, pixels: &[u8], notes: &Notes<'_>) -> Result<Vec<u8>, PngError> {
    checked(width, height, pixels.len(), 4)?;
    encode(
        [width, height],
        (ColorType::Rgba, BitDepth::Eight),
        None,
        pixels,
        notes,
    )
}

/// Grey, 16 bits: depth in millimetres. Errors if there are not `width * height` values.
pub fn grey16(width: usize, height: usize, values: &[u16], notes: &Notes<'_>) -> Result<Vec<u8>, PngError> {
    checked(width, height, values.len(), 1)?;
    let bytes: Vec<u8> = values.iter().flat_map(|v| v.to_be_bytes()).collect();
    encode(
        [width, height],
        (ColorType::Grayscale, BitDepth::Sixteen),
        None,
        &bytes,
        notes,
    )
}

/// Width and height, and the values of a grey picture of 16 bits, row-major; none if the bytes are another picture, or damaged.
pub fn grey16_inside(bytes: &[u8]) -> Option<([usize; 2], Vec<u16>)> {
    let mut reader = png::Decoder::new(std::io::Cursor::new(bytes)).read_info().ok()?;
    if reader.output_color_type() != (ColorType::Grayscale, BitDepth::Sixteen) {
        return None;
    }
    let mut pixels = vec![0; reader.output_buffer_size()?];
    let frame = reader.next_frame(&mut pixels).ok()?;
    let values = pixels.chunks_exact(2).map(|b| u16::from_be_bytes([b[0], b[1]]));
    Some(([frame.width as usize, frame.height as usize], values.collect()))
}

/// Labels, 8 bits, with the colour of each: viewers show the colours, programs read the labels. Errors if there are
/// not `width * height` labels or not 1 to 256 colours, or a label has none.
pub fn indexed(
    width: usize,
    height: usize,
    labels: &[u8],
    palette: &[[u8; 3]],
    notes: &Notes<'_>,
) -> Result<Vec<u8>, PngError> {
    checked(width, height, labels.len(), 1)?;
    let highest = labels.iter().max().copied().unwrap_or(0);
    if usize::from(highest) >= palette.len() || palette.len() > 256 {
        return Err(PngError::Palette {
            highest,
            colors: palette.len(),
        });
    }
    let kind = (ColorType::Indexed, BitDepth::Eight);
    encode([width, height], kind, Some(palette.as_flattened()), labels, notes)
}

fn checked(width: usize, height: usize, found: usize, channels: usize) -> Result<(), PngError> {
    let expected = width.saturating_mul(height).saturating_mul(channels);
    match found == expected && expected > 0 {
        true => Ok(()),
        false => Err(PngError::Size {
            width,
            height,
            found,
            expected,
        }),
    }
}

fn encode(
    [width, height]: [usize; 2],
    (color, depth): (ColorType, BitDepth),
    palette: Option<&[u8]>,
    bytes: &[u8],
    notes: &Notes<'_>,
) -> Result<Vec<u8>, PngError> {
    let mut out = Vec::new();
    let mut encoder = Encoder::new(&mut out, width as u32, height as u32);
    encoder.set_color(color);
    encoder.set_depth(depth);
    encoder.set_compression(Compression::Fast);
    encoder.set_filter(Filter::Adaptive);
    if let Some(palette) = palette {
        encoder.set_palette(palette);
        // Filters are for shades; labels are not.
        encoder.set_compression(Compression::Balanced);
        encoder.set_filter(Filter::NoFilter);
    }
    for (keyword, said) in notes.text {
        let sound = (1..80).contains(&keyword.len()) && keyword.bytes().all(|b| b.is_ascii_alphanumeric());
        if sound {
            // A zero would end the text.
            encoder.add_itxt_chunk((*keyword).to_owned(), said.replace('\0', " "))?;
        }
    }
    let mut writer = encoder.write_header()?;
    if let Some(scene) = notes.scene {
        writer.write_chunk(SCENE_CHUNK, scene)?;
    }
    writer.write_image_data(bytes)?;
    writer.finish()?;
    Ok(out)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn labels_read_back_as_their_colours() {
        let palette = [[1, 2, 3], [200, 100, 50], [9, 8, 7]];
        let labels = [0, 1, 2, 2, 1, 0, 1, 1];
        let text = [("Prompt", "Nebel, 5\0°C"), ("", "no keyword"), ("a b", "a space")];
        let notes = Notes {
            text: &text,
            scene: Some(b"loom"),
        };
        let bytes = indexed(4, 2, &labels, &palette, &notes).expect("sound");
        let inside = notes_inside(&bytes).expect("whole");
        assert_eq!(inside.scene, Some(&b"loom"[..]));
        assert_eq!(inside.text, [("Prompt".to_owned(), "Nebel, 5 °C".to_owned())]);
        for cut in 0..bytes.len() {
            notes_inside(&bytes[..cut]).expect_err("cut off");
        }
        let image = image::load_from_memory(&bytes).expect("a PNG").to_rgb8();
        assert_eq!(image.dimensions(), (4, 2));
        let found: Vec<[u8; 3]> = image.pixels().map(|p| p.0).collect();
        assert_eq!(found, labels.map(|l| palette[usize::from(l)]));
        // The labels themselves, for programs; and the text.
        let mut decoder = png::Decoder::new(std::io::Cursor::new(&bytes));
        decoder.set_transformations(png::Transformations::IDENTITY);
        let mut reader = decoder.read_info().expect("a PNG");
        let mut raw = [0; 8];
        reader.next_frame(&mut raw).expect("whole");
        let info = reader.info();
        assert_eq!((raw, info.color_type), (labels, ColorType::Indexed));
        let said: Vec<(String, String)> = info
            .utf8_text
            .iter()
            .map(|t| (t.keyword.clone(), t.get_text().expect("UTF-8")))
            .collect();
        assert_eq!(said, [("Prompt".to_owned(), "Nebel, 5 °C".to_owned())]);
    }

    #[test]
    fn depths_keep_all_bits_and_wrong_sizes_are_refused() {
        let values = [0, 1, 255, 256, 40_000, 65_535];
        let bytes = grey16(3, 2, &values, &Notes::default()).expect("sound");
        let image = image::load_from_memory(&bytes).expect("a PNG").to_luma16();
        assert_eq!(image.into_raw(), values);
        grey16(4, 2, &values, &Notes::default()).expect_err("too few");
        rgba(0, 0, &[], &Notes::default()).expect_err("nothing");
        let line = indexed(1, 1, &[3], &[[0; 3]; 3], &Notes::default())
            .expect_err("no colour for label 3")
            .to_string();
        assert!(line.starts_with("label 3 and 3 colours"), "{line}");
        let pixels = [1, 2, 3, 4, 250, 251, 252, 0];
        let bytes = rgba(1, 2, &pixels, &Notes::default()).expect("sound");
        assert_eq!(
            image::load_from_memory(&bytes)
                .expect("a PNG")
                .to_rgba8()
                .into_raw(),
            pixels
        );
    }
}
