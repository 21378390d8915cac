//! Pictures of a frame from above, one pixel per column: the map layers in their draw order, and
//! the top of the occupancy.

use egui::{Color32, ColorImage};

use scene::{BevLayer, BevLayout, Class, Extent, Unobserved, VoxelGrid};

pub use editor::tools::DRAW_ORDER;

/// A picture of a map, one pixel per column. Rows run against ego x and the pixels of a row against ego y, so forward
/// is up.
pub(super) fn from_above(extent: Extent, pixel: impl Fn(usize, usize) -> Color32) -> ColorImage {
    let [nx, ny] = [extent.nx(), extent.ny()];
    let pixels = (0..nx).rev().flat_map(|x| (0..ny).rev().map(move |y| (x, y)));
    ColorImage::new([ny, nx], pixels.map(|(x, y)| pixel(x, y)).collect())
}

/// The map layers that are drawn, and their opacity.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LayerStyle {
    /// Bits of the layers that are shown.
    pub shown: u32,
    /// Opacity of each layer of [`DRAW_ORDER`], 0 to 255.
    pub opacity: [u8; DRAW_ORDER.len()],
    /// Opacity of all layers together, 0 to 255.
    pub veil: u8,
}

/// The map layers of each column, drawn over one another; `behind` in columns without a layer.
pub fn layers(layout: &BevLayout, style: &LayerStyle, behind: Color32) -> ColorImage {
    let solid = style.opacity == [255; DRAW_ORDER.len()];
    let colors = DRAW_ORDER.map(|layer| {
        let mut color = layer.color();
        if is_divider(layer) {
            // Half of the road shows through: a divider is a line, but its cells are four times as wide.
            let under = BevLayer::DrivableArea.color();
            color = std::array::from_fn(|i| ((u16::from(color[i]) + u16::from(under[i])) / 2) as u8);
        }
        color
    });
    let of = |k: usize, alpha: u8| {
        let [r, g, b] = colors[k];
        Color32::from_rgba_unmultiplied(r, g, b, alpha)
    };
    from_above(layout.extent(), |x, y| {
        let cell = layout.cell(x, y) & style.shown;
        let mut here = (0..DRAW_ORDER.len()).filter(|k| cell & DRAW_ORDER[*k].bit() != 0);
        match solid {
            true => here.next_back().map_or(behind, |k| of(k, style.veil)),
            false => {
                let veiled = |k: usize| (u16::from(style.opacity[k]) * u16::from(style.veil) / 255) as u8;
                here.fold(behind, |below, k| below.blend(of(k, veiled(k))))
            }
        }
    })
}

fn is_divider(layer: BevLayer) -> bool {
    matches!(layer, BevLayer::RoadDivider | BevLayer::LaneDivider)
}

/// The highest voxel of each column by class, brighter the higher it is; `behind` in empty columns.
pub fn occupancy(grid: &VoxelGrid, behind: Color32) -> ColorImage {
    from_above(grid.extent(), |x, y| {
        let column = grid.column(x, y);
        let Some(z) = column.iter().rposition(|v| *v != Class::FREE) else {
            return behind;
        };
        let class = Class::from_id(column[z]).unwrap_or(Class::Others);
        let light = 0.62 + 0.38 * (z as f32 / 11.0).min(1.0);
        let [r, g, b] = class.color().map(|c| (f32::from(c) * light) as u8);
        Color32::from_rgb(r, g, b)
    })
}

/// A violet veil over unobserved columns, denser the larger the unobserved share of a column.
pub fn unobserved(mask: &Unobserved) -> ColorImage {
    from_above(mask.extent(), |x, y| {
        let alpha = (150.0 * mask.share(x, y)) as u8;
        Color32::from_rgba_unmultiplied(126, 87, 194, alpha)
    })
}

/// A rectangle of pixels.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Pixels {
    /// Left and upper edge.
    pub min: [usize; 2],
    /// Width and height.
    pub size: [usize; 2],
}

impl Pixels {
    /// False if it holds no pixel.
    pub fn is_positive(self) -> bool {
        self.size[0] > 0 && self.size[1] > 0
    }
}

/// The rectangle around the pixels that differ; `None` for pictures of different size.
pub fn differing(a: &ColorImage, b: &ColorImage) -> Option<Pixels> {
    if a.size != b.size {
        return None;
    }
    let (mut low, mut high) = ([usize::MAX; 2], [0; 2]);
    let width = a.size[0].max(1);
    for (y, (ours, theirs)) in a.pixels.chunks(width).zip(b.pixels.chunks(width)).enumerate() {
        if ours == theirs {
            continue;
        }
        for x in (0..ours.len()).filter(|&x| ours[x] != theirs[x]) {
            low = [low[0].min(x), low[1].min(y)];
            high = [high[0].max(x + 1), high[1].max(y + 1)];
        }
    }
    let nothing = low[0] == usize::MAX;
    Some(match nothing {
        true => Pixels {
            min: [0; 2],
            size: [0; 2],
        },
        false => Pixels {
            min: low,
            size: [high[0] - low[0], high[1] - low[1]],
        },
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_differs_lies_in_the_rectangle() {
        let before = ColorImage::filled([7, 5], Color32::BLACK);
        let mut after = before.clone();
        let rect = |min, size| Some(Pixels { min, size });
        assert_eq!(differing(&after, &before), rect([0, 0], [0, 0]));
        after[(2, 3)] = Color32::RED;
        after[(5, 1)] = Color32::RED;
        assert_eq!(differing(&after, &before), rect([2, 1], [4, 3]));
        assert_eq!(
            differing(&after, &ColorImage::filled([5, 7], Color32::BLACK)),
            None
        );
    }

    fn solid(shown: u32) -> LayerStyle {
        LayerStyle {
            shown,
            opacity: [255; DRAW_ORDER.len()],
            veil: 255,
        }
    }

    #[test]
    fn forward_is_up_and_left_is_left() {
        let mut layout = BevLayout::default();
        layout.set(BevLayer::DrivableArea, 199, 199, true); // far ahead, far left
        layout.set(BevLayer::Walkway, 199, 199, true);
        let image = layers(&layout, &solid(0xff), Color32::TRANSPARENT);
        let [r, g, b] = BevLayer::Walkway.color();
        assert_eq!(image.pixels[0], Color32::from_rgb(r, g, b));
        assert_eq!(image.pixels[1], Color32::TRANSPARENT);
        let style = solid(!BevLayer::Walkway.bit());
        let without = layers(&layout, &style, Color32::TRANSPARENT);
        let [r, g, b] = BevLayer::DrivableArea.color();
        assert_eq!(without.pixels[0], Color32::from_rgb(r, g, b));
        // A half opaque walkway over the road has a colour between both.
        let mut style = solid(0xff);
        style.opacity[2] = 128;
        let half = layers(&layout, &style, Color32::TRANSPARENT).pixels[0];
        let between = |i: usize| {
            let (a, b) = (BevLayer::Walkway.color()[i], BevLayer::DrivableArea.color()[i]);
            (i32::from(half.to_array()[i]) - (i32::from(a) + i32::from(b)) / 2).abs() < 4
        };
        assert!((0..3).all(between) && half.is_opaque(), "{half:?}");
        let map = Extent::new([-10, -3], [6, 4]).expect("sound");
        let image = layers(&BevLayout::over(map), &solid(0xff), Color32::TRANSPARENT);
        assert_eq!(image.size, [4, 6]);
        let mut grid = VoxelGrid::new();
        grid.set(0, 0, 15, Class::Car.id()); // behind, right
        let image = occupancy(&grid, Color32::BLACK);
        let [r, g, b] = Class::Car.color();
        assert_eq!(image.pixels[199 * 200 + 199], Color32::from_rgb(r, g, b));
    }
}
