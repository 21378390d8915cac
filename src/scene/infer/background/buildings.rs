//! Buildings from manmade columns. Labels show their facades; their depth is hidden behind, and is guessed.

use glam::DVec2;

use super::columns::{ClassColumns, closed, middle_m, parts};
use super::rectangle::{SceneryRectangle, split};
use crate::background::{Building, Facade, Roof};
use crate::raster::polygon_cells;
use crate::{Extent, VoxelGrid};

/// Columns lower than this are walls and fences, m.
const LOWEST_M: f64 = 2.2;
/// Fewer columns of a facade are an arm of a lamp or a sign: 6 m².
const FEWEST: usize = 38;
/// Shortest facade, m.
const SHORTEST_M: f64 = 3.0;
/// Height above which columns are cut off by the top of the grid, m; a building that is cut off gets this height.
const CUT_M: f64 = 5.2;
const CUT_HEIGHT_M: f64 = 6.0;
/// Longest facade and deepest building that are taken as one building, m.
const LONGEST_M: f64 = 46.0;
const DEEPEST_M: f64 = 17.0;
/// Depth that a facade without visible sides is given, m.
const USUAL_DEPTH_M: f64 = 10.0;
/// Share of a rectangle that may show open ground or other things.
const OPEN: f64 = 0.14;
/// Facades whose heights differ by more belong to two buildings, m.
const STEP_M: f64 = 1.0;

/// Buildings of the labels; their columns are marked in `taken`.
pub(super) fn buildings(labels: &VoxelGrid, manmade: &ClassColumns, taken: &mut [bool]) -> Vec<Building> {
    let map = labels.extent();
    let tall: Vec<bool> = (0..map.columns())
        .map(|c| manmade.top_m[c] >= LOWEST_M && manmade.count(c) >= 4)
        .collect();
    // Columns where nothing was seen: inside or behind something, or out of reach.
    let is_hidden = |[x, y]: [usize; 2]| labels.column(x, y).iter().all(|l| *l == crate::Class::FREE);
    let hidden: Vec<bool> = map.all_columns().map(is_hidden).collect();
    let mut pieces: Vec<(SceneryRectangle, Vec<usize>)> = Vec::new();
    for part in parts(map, &closed(map, &tall, 1)) {
        let part: Vec<usize> = part.into_iter().filter(|c| tall[*c]).collect();
        if part.len() < FEWEST {
            continue;
        }
        let fits = |r: &SceneryRectangle, columns: &[usize]| {
            let (mut open, mut all) = (0, 0);
            polygon_cells(map, &r.corners_m(), |x, y| {
                let c = map.index(x, y);
                all += 1;
                open += usize::from(!tall[c] && !hidden[c] && manmade.top_m[c] == 0.0);
            });
            let size = 2.0 * r.half_m;
            let sound =
                size.x <= LONGEST_M && size.y <= DEEPEST_M && f64::from(open as u32) <= OPEN * f64::from(all);
            sound && height_step(r, columns, manmade).is_none()
        };
        for (rectangle, columns) in split(map, part, &fits) {
            pieces.extend(by_height(rectangle, columns, manmade));
        }
    }
    pieces.retain(|(r, columns)| columns.len() >= FEWEST / 2 && 2.0 * r.half_m.x >= SHORTEST_M);
    pieces.sort_by_key(|(_, columns)| std::cmp::Reverse(columns.len()));
    for (rectangle, _) in &pieces {
        polygon_cells(map, &rectangle.corners_m(), |x, y| taken[map.index(x, y)] = true);
    }
    let mut out = Vec::new();
    for (rectangle, columns) in pieces {
        let may = |p: DVec2| {
            map.column_at(p.x, p.y).is_some_and(|[x, y]| {
                let c = map.index(x, y);
                !taken[c] && (hidden[c] || manmade.top_m[c] > 0.0)
            })
        };
        let deep = deepened(map, rectangle, &may);
        polygon_cells(map, &deep.corners_m(), |x, y| taken[map.index(x, y)] = true);
        columns.iter().for_each(|c| taken[*c] = true);
        let top = top_m(&columns, manmade);
        out.push(Building {
            outline_m: deep.corners_m(),
            height_m: if top >= CUT_M { CUT_HEIGHT_M } else { top },
            roof: Roof::Flat,
            facade: Facade::Plain,
        });
    }
    out
}

/// Height below which nearly all columns stay, m.
fn top_m(columns: &[usize], manmade: &ClassColumns) -> f64 {
    let mut tops: Vec<f64> = columns.iter().map(|c| manmade.top_m[*c]).collect();
    tops.sort_by(f64::total_cmp);
    tops[(tops.len() - 1) * 9 / 10]
}

/// Place along a rectangle, from its middle, where the height changes and stays changed, m.
fn height_step(r: &SceneryRectangle, columns: &[usize], manmade: &ClassColumns) -> Option<f64> {
    let slot_m = 2.0 * manmade.map.voxel_m();
    let slots = (2.0 * r.half_m.x / slot_m) as usize;
    let mut tops = vec![0.0_f64; slots + 1];
    for c in columns {
        let at = ((r.local(middle_m(manmade.map, *c)).x + r.half_m.x) / slot_m).max(0.0) as usize;
        let slot = &mut tops[at.min(slots)];
        *slot = slot.max(manmade.top_m[*c]);
    }
    // Four slots on either side that agree among themselves.
    let level = |list: &[f64]| {
        let (low, high) = list
            .iter()
            .fold((f64::INFINITY, 0.0_f64), |(l, h), t| (l.min(*t), h.max(*t)));
        (high - low < 0.9).then_some((low + high) / 2.0)
    };
    let n = 4;
    (n..tops.len().saturating_sub(n)).find_map(|i| {
        let (before, after) = (level(&tops[i - n..i])?, level(&tops[i..i + n])?);
        ((before - after).abs() > STEP_M).then_some(i as f64 * slot_m - r.half_m.x)
    })
}

/// Cuts a straight part where its height changes.
fn by_height(
    r: SceneryRectangle,
    columns: Vec<usize>,
    manmade: &ClassColumns,
) -> Vec<(SceneryRectangle, Vec<usize>)> {
    let mut out = Vec::new();
    let mut open = vec![(r, columns)];
    while let Some((r, columns)) = open.pop() {
        let cut = height_step(&r, &columns, manmade);
        let (a, b): (Vec<usize>, Vec<usize>) = match cut {
            Some(at) => columns
                .iter()
                .partition(|c| r.local(middle_m(manmade.map, **c)).x < at),
            None => (Vec::new(), Vec::new()),
        };
        if a.is_empty() || b.is_empty() {
            out.push((r, columns));
            continue;
        }
        open.extend([b, a].map(|part| (SceneryRectangle::around(manmade.map, &part), part)));
    }
    out
}

/// A shallow rectangle reaches back where nothing was seen: away from the ego vehicle first, up to the usual depth.
fn deepened(map: Extent, r: SceneryRectangle, may: &dyn Fn(DVec2) -> bool) -> SceneryRectangle {
    let (mut low, mut high) = (-r.half_m.y, r.half_m.y);
    let away_is_high = r.middle_m.dot(r.along.perp()) >= 0.0;
    let step = map.voxel_m();
    for is_high in [away_is_high, !away_is_high] {
        while high - low < USUAL_DEPTH_M {
            let next = if is_high { high + step } else { low - step };
            let line = if is_high {
                next - step / 2.0
            } else {
                next + step / 2.0
            };
            let count = (2.0 * r.half_m.x / step).max(1.0) as usize;
            let at = |i: usize| {
                r.ground(DVec2::new(
                    (i as f64 + 0.5) / count as f64 * 2.0 * r.half_m.x - r.half_m.x,
                    line,
                ))
            };
            let free = (0..count).filter(|i| may(at(*i))).count();
            if free * 10 < count * 8 {
                break;
            }
            if is_high { high = next } else { low = next }
        }
    }
    SceneryRectangle {
        middle_m: r.ground(DVec2::new(0.0, (low + high) / 2.0)),
        half_m: DVec2::new(r.half_m.x, (high - low) / 2.0),
        along: r.along,
    }
}
