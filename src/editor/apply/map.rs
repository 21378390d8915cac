//! Edits of map layers and lines, and the ground under them at once.

use std::sync::Arc;

use glam::DVec2;
use scene::shape::at_least;
use scene::{BevLayer, BevLayout, Edit, EditError, Frame, Polyline, SceneBox, raster};

use crate::{immediate, junction};

/// Applies an edit of the map; `false` if it is about something else.
pub(super) fn apply(edit: &Edit, frame: &mut Frame) -> Result<bool, EditError> {
    match edit {
        Edit::PaintBev { layer, shape, value } => {
            if layer.is_object() {
                return Err(EditError::ObjectLayer(*layer));
            }
            let mut cells = shape.cells(frame.extent())?;
            let before: Vec<u32> = cells.iter().map(|[x, y]| frame.layout.cell(*x, *y)).collect();
            match value {
                true => replace_ground(&mut frame.layout, *layer, &cells),
                false => junction::cut_lines(&mut frame.layout, *layer, &cells),
            }
            for &[x, y] in &cells {
                if frame.layout.has(*layer, x, y) != *value {
                    frame.layout.set(*layer, x, y, *value);
                }
            }
            let mut before = before.into_iter();
            cells.retain(|[x, y]| before.next() != Some(frame.layout.cell(*x, *y)));
            if immediate::shapes_ground(*layer) {
                immediate::lay_ground(frame, &cells);
            }
        }
        Edit::AddPolylines { lines } => {
            check_lines(lines)?;
            add_lines(&mut frame.layout, lines);
        }
        _ => return Ok(false),
    }
    Ok(true)
}

/// Takes away what a layer replaces where it is painted.
pub(super) fn replace_ground(layout: &mut BevLayout, layer: BevLayer, cells: &[[usize; 2]]) {
    for gone in layer.replaces() {
        let there = cells.iter().copied().filter(|[x, y]| layout.has(*gone, *x, *y));
        let there: Vec<[usize; 2]> = there.collect();
        if there.is_empty() {
            continue;
        }
        junction::cut_lines(layout, *gone, &there);
        for [x, y] in there {
            layout.set(*gone, x, y, false);
        }
    }
}

pub(super) fn add_lines(layout: &mut BevLayout, lines: &[Polyline]) {
    for line in lines {
        raster::draw_polyline(layout, line);
    }
    Arc::make_mut(&mut layout.polylines).extend_from_slice(lines);
}

fn check_lines(lines: &[Polyline]) -> Result<(), EditError> {
    at_least("lines", lines.len(), 1)?;
    for line in lines {
        at_least("points_m", line.points_m.len(), 2)?;
        let limit = DVec2::splat(SceneBox::LIMIT_M);
        // Written so that NaN fails too.
        if let Some(p) = line.points_m.iter().find(|p| !p.abs().cmple(limit).all()) {
            return Err(EditError::Number {
                field: "points_m",
                found: format!("[{}, {}]", p.x, p.y),
                expected: "finite numbers within 10000 m",
            });
        }
    }
    Ok(())
}
