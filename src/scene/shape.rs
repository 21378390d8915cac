//! Shapes of a brush on the bird's-eye view: from what the user drew to grid cells.

use glam::DVec2;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::edit::EditError;
use crate::{Extent, raster};

/// An area on the ground, world frame, m (cells: grid indices). A cell belongs to a shape if its centre does.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub enum Shape {
    /// A round dab; always at least the cell under its centre.
    Disc {
        /// Middle, m.
        #[schemars(with = "[f64; 2]")]
        center_m: DVec2,
        /// Radius, m, at least 0.
        radius_m: f64,
    },
    /// An upright rectangle.
    Rect {
        /// Lower corner, m.
        #[schemars(with = "[f64; 2]")]
        min_m: DVec2,
        /// Upper corner, m.
        #[schemars(with = "[f64; 2]")]
        max_m: DVec2,
    },
    /// A closed polygon (even-odd rule); the first vertex is not repeated.
    Polygon {
        /// At least three vertices, m.
        #[schemars(with = "Vec<[f64; 2]>")]
        points_m: Vec<DVec2>,
    },
    /// A stroke with round ends, never thinner than one cell.
    Line {
        /// At least one vertex, m.
        #[schemars(with = "Vec<[f64; 2]>")]
        points_m: Vec<DVec2>,
        /// Full width, m, at least 0.
        width_m: f64,
    },
    /// Cells by index `[x, y]`.
    Cells(Vec<[usize; 2]>),
}

impl Shape {
    /// Half the width of the thinnest stroke, m: just over half a cell, so that a diagonal stays connected.
    const MIN_HALF_WIDTH_M: f64 = 0.21;

    /// The cells `[x, y]` of a map that the shape covers, sorted, each once. The part outside the map is cut
    /// off (explicit cells outside are an error). Errors: numbers that are not finite or negative,
    /// too few points, or no cell at all.
    pub fn cells(&self, extent: Extent) -> Result<Vec<[usize; 2]>, EditError> {
        // One bit a cell: a wide stroke of many points visits the same cells again and again.
        let mut covered = vec![false; extent.columns()];
        let mut visit = |x: usize, y: usize| covered[extent.index(x, y)] = true;
        match self {
            Self::Disc { center_m, radius_m } => {
                finite("center_m", &[*center_m])?;
                not_negative("radius_m", *radius_m)?;
                raster::disc_cells(extent, *center_m, *radius_m, visit);
            }
            Self::Rect { min_m, max_m } => {
                finite("min_m", &[*min_m])?;
                finite("max_m", &[*max_m])?;
                let (a, b) = (min_m.min(*max_m), min_m.max(*max_m));
                raster::polygon_cells(extent, &[a, DVec2::new(b.x, a.y), b, DVec2::new(a.x, b.y)], visit);
            }
            Self::Polygon { points_m } => {
                at_least("points_m", points_m.len(), 3)?;
                finite("points_m", points_m)?;
                raster::polygon_cells(extent, points_m, visit);
            }
            Self::Line { points_m, width_m } => {
                at_least("points_m", points_m.len(), 1)?;
                finite("points_m", points_m)?;
                not_negative("width_m", *width_m)?;
                let half_m = (width_m / 2.0).max(Self::MIN_HALF_WIDTH_M);
                // Round ends; these are all there is if the pointer did not move.
                raster::disc_cells(extent, points_m[0], half_m, &mut visit);
                raster::line_cells(extent, points_m, half_m, visit);
            }
            Self::Cells(list) => {
                at_least("cells", list.len(), 1)?;
                for &[x, y] in list {
                    if !extent.holds(x, y) {
                        return Err(EditError::CellOutside {
                            cell: vec![x, y],
                            extent,
                        });
                    }
                    visit(x, y);
                }
            }
        }
        let cells = covered.iter().enumerate().filter(|(_, c)| **c);
        let cells: Vec<[usize; 2]> = cells.map(|(i, _)| extent.column(i)).collect();
        match cells.is_empty() {
            true => Err(EditError::NoCell),
            false => Ok(cells),
        }
    }
}

fn finite(field: &'static str, points: &[DVec2]) -> Result<(), EditError> {
    match points.iter().find(|p| !p.is_finite()) {
        Some(p) => Err(EditError::Number {
            field,
            found: format!("[{}, {}]", p.x, p.y),
            expected: "finite numbers",
        }),
        None => Ok(()),
    }
}

fn not_negative(field: &'static str, value: f64) -> Result<(), EditError> {
    if value.is_finite() && value >= 0.0 {
        return Ok(());
    }
    Err(EditError::Number {
        field,
        found: value.to_string(),
        expected: "a finite number of at least 0",
    })
}

/// Errors unless a list holds at least the expected number of entries.
pub fn at_least(field: &'static str, found: usize, expected: usize) -> Result<(), EditError> {
    if found >= expected {
        return Ok(());
    }
    Err(EditError::TooFew {
        field,
        found,
        expected,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn v(x: f64, y: f64) -> DVec2 {
        DVec2::new(x, y)
    }

    #[test]
    fn areas_match() {
        let rect = Shape::Rect {
            min_m: v(2.0, 4.0),
            max_m: v(0.0, 0.0), // corners in any order
        };
        assert_eq!(rect.cells(Extent::WINDOW).expect("inside").len(), 5 * 10);
        let disc = Shape::Disc {
            center_m: v(0.0, 0.0),
            radius_m: 8.0,
        };
        let area_m2 = disc.cells(Extent::WINDOW).expect("inside").len() as f64 * 0.16;
        assert!(
            (area_m2 / (64.0 * std::f64::consts::PI) - 1.0).abs() < 0.01,
            "{area_m2}"
        );
        let everything = Shape::Rect {
            min_m: v(-1e9, -1e9),
            max_m: v(1e9, 1e9),
        };
        assert_eq!(
            everything.cells(Extent::WINDOW).expect("cut").len(),
            Extent::WINDOW.columns()
        );
    }

    #[test]
    fn a_click_and_a_thin_line_leave_a_connected_mark() {
        let click = Shape::Line {
            points_m: vec![v(1.1, 1.1); 3],
            width_m: 0.0,
        };
        assert_eq!(click.cells(Extent::WINDOW), Ok(vec![[102, 102]]));
        let diagonal = Shape::Line {
            points_m: vec![v(0.1, 0.1), v(9.9, 7.3)],
            width_m: 0.0,
        };
        let cells = diagonal.cells(Extent::WINDOW).expect("inside");
        let touches =
            |a: &[usize; 2], b: &[usize; 2]| a != b && a[0].abs_diff(b[0]) <= 1 && a[1].abs_diff(b[1]) <= 1;
        assert!(cells.iter().all(|a| cells.iter().any(|b| touches(a, b))));
        assert!(cells.len() >= 25);
    }

    #[test]
    fn bad_shapes_are_named() {
        let text = |shape: Shape| shape.cells(Extent::WINDOW).expect_err("bad").to_string();
        let nan = Shape::Disc {
            center_m: v(f64::NAN, 0.0),
            radius_m: 1.0,
        };
        assert_eq!(text(nan), "center_m is [NaN, 0], expected finite numbers");
        let negative = Shape::Disc {
            center_m: v(0.0, 0.0),
            radius_m: -1.0,
        };
        assert_eq!(
            text(negative),
            "radius_m is -1, expected a finite number of at least 0"
        );
        let flat = Shape::Polygon {
            points_m: vec![v(0.0, 0.0); 2],
        };
        assert_eq!(text(flat), "points_m holds 2 entries, expected at least 3");
        assert_eq!(
            text(Shape::Cells(vec![[3, 200]])),
            "cell [3, 200] is outside the grid of 200 x 200 x 16"
        );
        assert_eq!(
            text(Shape::Cells(vec![])),
            "cells holds 0 entries, expected at least 1"
        );
        let far = Shape::Disc {
            center_m: v(100.0, 0.0),
            radius_m: 1.0,
        };
        assert_eq!(text(far), "the shape covers no cell of the grid");
    }
}
