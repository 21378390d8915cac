//! Walls, fences, rails, hedges and poles from columns that belong to no building and no tree.

use glam::DVec2;

use super::columns::{ClassColumns, middle_m, parts};
use super::rectangle::{SceneryRectangle, split};
use crate::background::{LineKind, Post, PostKind, SceneryLine, Shrubs};
use crate::{Extent, Form};

/// Most columns of a pole.
const POLE: usize = 4;
/// Shortest line, and widest one, m.
const SHORTEST_M: f64 = 2.0;
const WIDEST_M: f64 = 1.7;
/// Share of its rectangle that a straight part fills.
const FILLED: f64 = 0.62;

/// Walls, fences, rails and poles of the manmade columns of `left`.
pub(super) fn walls_and_poles(manmade: &ClassColumns, left: &[bool]) -> Vec<Form> {
    let map = manmade.map;
    let mut out = Vec::new();
    for part in parts(map, left) {
        if part.len() <= POLE {
            out.push(pole(&part, manmade));
            continue;
        }
        for (r, columns) in split(map, part, &|r, columns| {
            2.0 * r.half_m.y <= WIDEST_M || is_filled(map, r, columns)
        }) {
            let top = top_m(&columns, manmade);
            if 2.0 * r.half_m.x < SHORTEST_M && columns.len() <= 2 * POLE {
                out.push(pole(&columns, manmade));
                continue;
            }
            let kind = match top {
                t if t < 1.0 => LineKind::GuardRail,
                // Mesh and boards let rays through: the labels of a fence have gaps.
                t if t < LineKind::Fence.typical_m().0 + 0.3 && !is_dense(map, &r, &columns) => {
                    LineKind::Fence
                }
                _ => LineKind::Wall,
            };
            out.push(line(map, kind, &r, top));
        }
    }
    out
}

/// Hedges and areas of shrubs of the columns of `left`.
pub(super) fn hedges_and_shrubs(vegetation: &ClassColumns, left: &[bool]) -> Vec<Form> {
    let map = vegetation.map;
    let mut out = Vec::new();
    for part in parts(map, left).into_iter().filter(|p| p.len() >= 3) {
        for (r, columns) in split(map, part, &|r, columns| is_filled(map, r, columns)) {
            let top = top_m(&columns, vegetation);
            let is_hedge =
                2.0 * r.half_m.y <= WIDEST_M && r.half_m.x > 2.0 && top > 0.7 && is_dense(map, &r, &columns);
            out.push(match is_hedge {
                true => line(map, LineKind::Hedge, &r, top),
                false => Form::Shrubs(Shrubs {
                    outline_m: r.corners_m(),
                    height_m: top,
                    per_m2: 1.0,
                }),
            });
        }
    }
    out
}

fn top_m(columns: &[usize], of: &ClassColumns) -> f64 {
    let tops = columns.iter().map(|c| of.top_m[*c]);
    tops.fold(0.3, f64::max)
}

fn share(map: Extent, r: &SceneryRectangle, columns: &[usize]) -> f64 {
    columns.len() as f64 * map.voxel_m().powi(2) / r.area_m2()
}

fn is_filled(map: Extent, r: &SceneryRectangle, columns: &[usize]) -> bool {
    share(map, r, columns) >= FILLED
}

fn is_dense(map: Extent, r: &SceneryRectangle, columns: &[usize]) -> bool {
    share(map, r, columns) > 0.8
}

fn line(map: Extent, kind: LineKind, r: &SceneryRectangle, top_m: f64) -> Form {
    let end = DVec2::new(r.half_m.x, 0.0);
    // Columns are wider than most lines: half a column on either side is theirs.
    let width = (2.0 * r.half_m.y - map.voxel_m()).max(kind.typical_m().1);
    Form::Line(SceneryLine {
        kind,
        points_m: vec![r.ground(-end), r.ground(end)],
        height_m: top_m,
        width_m: width,
    })
}

fn pole(columns: &[usize], manmade: &ClassColumns) -> Form {
    let middle = columns.iter().map(|c| middle_m(manmade.map, *c)).sum::<DVec2>() / columns.len() as f64;
    let top = top_m(columns, manmade);
    let kind = match top {
        t if t < 1.3 => PostKind::Bollard,
        t if t < 3.2 && columns.len() > 1 => PostKind::Sign,
        _ => PostKind::Pole,
    };
    // The nearest of its columns, so that it stands on one.
    let near = columns
        .iter()
        .map(|c| middle_m(manmade.map, *c))
        .min_by(|a, b| a.distance(middle).total_cmp(&b.distance(middle)));
    Form::Post(Post {
        kind,
        position_m: near.unwrap_or(middle),
        yaw_rad: 0.0,
        height_m: top,
    })
}
