//! A matrix as a kernel sees it.

/// A matrix inside a slice: value (r, c) lies at `r * row_stride + c * column_stride`.
#[derive(Clone, Copy)]
pub struct MatrixView<'a> {
    pub(crate) data: &'a [f32],
    pub(crate) row_stride: usize,
    pub(crate) column_stride: usize,
}

impl<'a> MatrixView<'a> {
    /// Rows of `row_stride` values from the start of `data`; rows may overlap.
    pub fn rows(data: &'a [f32], row_stride: usize) -> Self {
        Self {
            data,
            row_stride,
            column_stride: 1,
        }
    }

    /// The transpose of [`rows`](Self::rows).
    pub fn columns(data: &'a [f32], column_stride: usize) -> Self {
        Self {
            data,
            row_stride: 1,
            column_stride,
        }
    }

    /// Value (row, column).
    pub fn at(&self, row: usize, column: usize) -> f32 {
        self.data[row * self.row_stride + column * self.column_stride]
    }

    /// True if a matrix of that size lies inside the slice; both at least 1.
    pub(crate) fn holds(&self, rows: usize, columns: usize) -> bool {
        (rows - 1) * self.row_stride + (columns - 1) * self.column_stride < self.data.len()
    }
}
