//! Feature maps over the top view, and rectangles of latent cells.

/// A feature map: `rows x columns` places of `width` channels, channel fastest.
#[derive(Clone, Debug, PartialEq)]
pub struct FeatureMap {
    /// Values.
    pub data: Vec<f32>,
    /// Places along x.
    pub rows: usize,
    /// Places along y.
    pub columns: usize,
    /// Channels.
    pub width: usize,
}

impl FeatureMap {
    /// Half as many places each way, four times the channels, ordered (dx, dy, channel).
    pub fn fold(&self) -> Self {
        let (rows, columns, width) = (self.rows / 2, self.columns / 2, self.width);
        let mut data = Vec::with_capacity(self.data.len());
        for at in 0..rows * columns {
            let (x, y) = (at / columns * 2, at % columns * 2);
            for dx in 0..2 {
                let from = ((x + dx) * self.columns + y) * width;
                data.extend_from_slice(&self.data[from..from + 2 * width]);
            }
        }
        Self {
            data,
            rows,
            columns,
            width: 4 * width,
        }
    }

    /// The inverse of [`fold`](Self::fold).
    pub fn unfold(&self) -> Self {
        let (rows, columns, width) = (2 * self.rows, 2 * self.columns, self.width / 4);
        let mut data = Vec::with_capacity(self.data.len());
        for x in 0..rows {
            for y in 0..self.columns {
                let from = (x / 2 * self.columns + y) * self.width + x % 2 * 2 * width;
                data.extend_from_slice(&self.data[from..from + 2 * width]);
            }
        }
        Self {
            data,
            rows,
            columns,
            width,
        }
    }
}

/// A rectangle of latent cells.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct CellRect {
    /// First cell along x.
    pub x: usize,
    /// First cell along y.
    pub y: usize,
    /// Cells along x.
    pub rows: usize,
    /// Cells along y.
    pub columns: usize,
    /// Cells of the whole map along x and along y.
    pub side: usize,
}

impl CellRect {
    /// The wanted cells of a square map and `reach` more on every side, cut to the map; `None` if none
    /// is wanted.
    pub fn around(cells: &[bool], reach: usize) -> Option<Self> {
        let side = cells.len().isqrt();
        let wanted = || (0..cells.len()).filter(|c| cells[*c]);
        let (x0, x1) = (
            wanted().map(|c| c / side).min()?,
            wanted().map(|c| c / side).max()?,
        );
        let (y0, y1) = (
            wanted().map(|c| c % side).min()?,
            wanted().map(|c| c % side).max()?,
        );
        let (x, y) = (x0.saturating_sub(reach), y0.saturating_sub(reach));
        let (x_end, y_end) = ((x1 + reach + 1).min(side), (y1 + reach + 1).min(side));
        Some(Self {
            x,
            y,
            rows: x_end - x,
            columns: y_end - y,
            side,
        })
    }

    /// The whole map of `side x side` cells.
    pub fn whole(side: usize) -> Self {
        Self {
            x: 0,
            y: 0,
            rows: side,
            columns: side,
            side,
        }
    }

    /// The rectangle at the same place in cells half as large.
    pub fn halved(self) -> Self {
        Self {
            x: 2 * self.x,
            y: 2 * self.y,
            rows: 2 * self.rows,
            columns: 2 * self.columns,
            side: 2 * self.side,
        }
    }

    /// Numbers of its cells, row by row.
    pub fn cells(self) -> impl Iterator<Item = usize> {
        (self.x..self.x + self.rows)
            .flat_map(move |x| (self.y..self.y + self.columns).map(move |y| x * self.side + y))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const SIDE: usize = 50;
    const CELLS: usize = SIDE * SIDE;

    #[test]
    fn unfold_is_the_inverse_of_fold() {
        let map = FeatureMap {
            data: (0..4 * 6 * 3).map(|i| i as f32).collect(),
            rows: 4,
            columns: 6,
            width: 3,
        };
        let folded = map.fold();
        assert_eq!((folded.rows, folded.columns, folded.width), (2, 3, 12));
        // Place (1, 2) holds columns (2, 4), (2, 5), (3, 4), (3, 5).
        let expected: Vec<f32> = [2 * 6 + 4, 2 * 6 + 5, 3 * 6 + 4, 3 * 6 + 5]
            .iter()
            .flat_map(|at| (0..3).map(move |c| (at * 3 + c) as f32))
            .collect();
        assert_eq!(&folded.data[5 * 12..], &expected[..]);
        assert_eq!(folded.unfold().data, map.data);
    }

    #[test]
    fn window_is_cut_to_the_map() {
        let mut cells = [false; CELLS];
        assert_eq!(CellRect::around(&cells, 3), None);
        cells[SIDE + 10] = true;
        cells[4 * SIDE + 48] = true;
        let window = CellRect::around(&cells, 3).expect("two cells");
        let expected = CellRect {
            x: 0,
            y: 7,
            rows: 8,
            columns: 43,
            side: SIDE,
        };
        assert_eq!(window, expected);
        assert_eq!(window.cells().count(), 8 * 43);
    }
}
