//! Flood fill on the bird's-eye view.

use scene::{BevLayer, BevLayout};

/// Border of a fill.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum FillBounds {
    /// Cells of exactly the same map layers as the first.
    #[default]
    AnyLayer,
    /// Cells that have, or have not, the painted layer as the first.
    OwnLayer,
}

/// Cells `[x, y]` that connect to `start` by their sides and are alike, sorted; at most all of the map. Empty if
/// the start is outside the grid.
pub fn flood(layout: &BevLayout, layer: BevLayer, start: [usize; 2], bounds: FillBounds) -> Vec<[usize; 2]> {
    let [x, y] = start;
    let extent = layout.extent();
    if !extent.holds(x, y) {
        return Vec::new();
    }
    let mask = match bounds {
        FillBounds::AnyLayer => u32::MAX,
        FillBounds::OwnLayer => layer.bit(),
    };
    let wanted = layout.cell(x, y) & mask;
    let mut seen = vec![false; extent.columns()];
    let mut open = vec![start];
    seen[extent.index(x, y)] = true;
    while let Some([x, y]) = open.pop() {
        let neighbours = [
            [x.wrapping_sub(1), y],
            [x + 1, y],
            [x, y.wrapping_sub(1)],
            [x, y + 1],
        ];
        for [x, y] in neighbours {
            if !extent.holds(x, y) || seen[extent.index(x, y)] {
                continue;
            }
            if layout.cell(x, y) & mask == wanted {
                seen[extent.index(x, y)] = true;
                open.push([x, y]);
            }
        }
    }
    let mut cells = Vec::new();
    for (x, row) in seen.chunks_exact(extent.ny()).enumerate() {
        cells.extend((0..row.len()).filter(|y| row[*y]).map(|y| [x, y]));
    }
    cells
}

#[cfg(test)]
mod tests {
    use scene::Extent;

    use super::*;

    #[test]
    fn a_fill_stops_at_layers() {
        let mut layout = BevLayout::default();
        // A square ring of road around 8 x 8 cells, cut in two by a divider.
        for i in 50..60 {
            for (x, y) in [(i, 50), (i, 59), (50, i), (59, i)] {
                layout.set(BevLayer::DrivableArea, x, y, true);
            }
        }
        for x in 51..59 {
            layout.set(BevLayer::LaneDivider, x, 54, true);
        }
        let count = |start, bounds| flood(&layout, BevLayer::DrivableArea, start, bounds).len();
        assert_eq!(count([52, 52], FillBounds::AnyLayer), 8 * 3);
        assert_eq!(count([52, 52], FillBounds::OwnLayer), 8 * 8);
        assert_eq!(count([50, 50], FillBounds::AnyLayer), 36);
        assert_eq!(
            count([0, 0], FillBounds::AnyLayer),
            Extent::WINDOW.columns() - 100
        );
        assert_eq!(count([200, 0], FillBounds::AnyLayer), 0);
    }
}
