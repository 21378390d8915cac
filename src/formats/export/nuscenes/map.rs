//! The map: a mask of where one drives and walks, and the map expansion.

use png::{BitDepth, ColorType, Compression, Encoder, Filter};
use scene::{BevLayer, BevLayout};

use super::{LOCATION, Writing, expansion};
use crate::FormatError;
use crate::nuscenes::tokens::Tokens;

/// Pixels of a mask along the side of a column: the devkit takes them as 0.1 m.
const PER_COLUMN: usize = 4;
/// Layers of the mask: ground that is driven or walked on.
const ON_MASK: [BevLayer; 4] = [
    BevLayer::DrivableArea,
    BevLayer::PedCrossing,
    BevLayer::Walkway,
    BevLayer::CarparkArea,
];

/// Where the mask is, from the folder of the data set on.
pub(super) fn mask_path(tokens: &Tokens) -> String {
    format!("maps/{}.png", tokens.token("map", 0))
}

pub(super) fn write(writing: &mut Writing<'_>) -> Result<(), FormatError> {
    let layout = &writing.scene.canvas().layout;
    let bytes = mask(layout).map_err(|e| FormatError::new(format!("map mask: {e}")))?;
    let name = format!("{}.png", writing.tokens.token("map", 0));
    writing.file("maps", &name, bytes);
    let bytes = expansion::to_bytes(layout, writing.shift_m, &writing.tokens)?;
    writing.file("maps/expansion", &format!("{LOCATION}.json"), bytes);
    Ok(())
}

/// Grey values of 8 bits: 255 on the mask, 0 beside it. The lower left corner is the origin of the global frame.
fn mask(layout: &BevLayout) -> Result<Vec<u8>, png::EncodingError> {
    let extent = layout.extent();
    let [nx, ny] = [extent.nx(), extent.ny()];
    let bits = ON_MASK.iter().fold(0, |bits, layer| bits | layer.bit());
    let mut out = Vec::new();
    let mut encoder = Encoder::new(&mut out, (nx * PER_COLUMN) as u32, (ny * PER_COLUMN) as u32);
    encoder.set_color(ColorType::Grayscale);
    encoder.set_depth(BitDepth::Eight);
    encoder.set_compression(Compression::Fast);
    encoder.set_filter(Filter::NoFilter);
    let mut writer = encoder.write_header()?;
    // Row by row: the mask of a large map has a gigabyte of pixels.
    let mut rows = writer.stream_writer()?;
    for y in (0..ny).rev() {
        let shade = |x: usize| if layout.cell(x, y) & bits == 0 { 0 } else { 255 };
        let row: Vec<u8> = (0..nx * PER_COLUMN).map(|i| shade(i / PER_COLUMN)).collect();
        for _ in 0..PER_COLUMN {
            std::io::Write::write_all(&mut rows, &row)?;
        }
    }
    rows.finish()?;
    writer.finish()?;
    Ok(out)
}

#[cfg(test)]
mod tests {
    use super::*;
    use scene::Extent;

    #[test]
    fn the_mask_has_north_up_and_four_pixels_a_column() {
        let mut layout = BevLayout::over(Extent::new([-5, 2], [3, 2]).expect("sound"));
        layout.set(BevLayer::Walkway, 2, 0, true);
        layout.set(BevLayer::LaneDivider, 0, 0, true);
        let image = image::load_from_memory(&mask(&layout).expect("memory")).expect("a PNG");
        let image = image.to_luma8();
        assert_eq!(image.dimensions(), (12, 8));
        let on: Vec<(u32, u32)> = (image.enumerate_pixels().filter(|(.., p)| p.0[0] == 255))
            .map(|(x, y, _)| (x, y))
            .collect();
        assert_eq!(on.len(), 16);
        assert!(on.iter().all(|(x, y)| *x >= 8 && *y >= 4), "lower right");
    }
}
