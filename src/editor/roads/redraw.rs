//! Draws a changed network into the layout: cells that both networks draw alike keep whatever was painted there.

use std::collections::BTreeSet;

use glam::DVec2;

use scene::roads::{LAYERS, RoadDrawing, RoadElement};
use scene::{BevLayout, Extent, Frame, Polyline, RoadId, RoadNetwork};

use crate::immediate;
use crate::junction::CellSet;

/// Columns beside a road within which painted cells change together with it.
const RIM: usize = 3;
/// A line with a larger share than this on a changed road belongs to that road.
const OWN: f64 = 0.75;
/// Places on a line are looked at in steps of this length, m.
const STEP_M: f64 = 0.5;

/// Brings a frame's layout from what `before` draws to what `after` draws. `anew` is a road that is drawn whatever is there.
pub(super) fn redraw(frame: &mut Frame, before: &RoadNetwork, after: &RoadNetwork, anew: Option<RoadId>) {
    let extent = frame.extent();
    let (old, new) = (before.draw(extent), after.draw(extent));
    let forced =
        anew.map(|id| after.surface_of(extent, &[RoadElement::Road(id)], RIM as f64 * extent.voxel_m()));
    let bits: u32 = LAYERS.iter().map(|l| l.bit()).sum();
    let drawn = |d: &RoadDrawing, [x, y]: [usize; 2]| d.layout.cell(x, y) & bits;
    let differs = |at: [usize; 2]| drawn(&old, at) != drawn(&new, at);
    let mut due = vec![false; extent.columns()];
    for at in extent.all_columns().filter(|at| differs(*at)) {
        due[extent.index(at[0], at[1])] = true;
    }
    // Cells beside a change that are no road any more are remains of a road that was painted a little wider.
    let edge = grown(extent, &due);
    let junctions = changed_junctions(before, after);
    let mut cells = Vec::new();
    for at in extent.all_columns() {
        let i = extent.index(at[0], at[1]);
        let is_rest = edge[i] && drawn(&new, at) == 0 && drawn(&old, at) == 0;
        let is_forced = forced.as_ref().is_some_and(|f| f[i]);
        // A junction that changed is drawn whole: older paint there does not fit any more.
        let p = extent.center(at[0], at[1], 0).truncate();
        let at_junction =
            || (drawn(&new, at) | drawn(&old, at)) != 0 && junctions.iter().any(|(m, r)| p.distance(*m) < *r);
        if due[i] || is_rest || is_forced || at_junction() {
            cells.push(at);
        }
    }
    let mut touched = Vec::new();
    for at in cells {
        let [x, y] = at;
        let was = frame.layout.cell(x, y);
        for layer in LAYERS {
            frame.layout.set(layer, x, y, drawn(&new, at) & layer.bit() != 0);
        }
        if frame.layout.cell(x, y) != was {
            touched.push(at);
        }
    }
    swap_lines(&mut frame.layout, [before, after], [&old, &new], anew);
    immediate::lay_ground(frame, &touched);
}

/// Middle and radius of the junctions that one network draws otherwise than another, in both of them, m.
fn changed_junctions(before: &RoadNetwork, after: &RoadNetwork) -> Vec<(DVec2, f64)> {
    let (old, new) = (before.junctions(), after.junctions());
    let all = old.iter().chain(&new);
    let due = all.filter(|j| !(old.contains(j) && new.contains(j)));
    due.map(|j| (j.node.at_m, j.reach_m)).collect()
}

/// Columns that are set or near to one that is.
fn grown(extent: Extent, cells: &[bool]) -> Vec<bool> {
    let mut out = cells.to_vec();
    for [x, y] in extent.all_columns().filter(|[x, y]| cells[extent.index(*x, *y)]) {
        for i in x.saturating_sub(RIM)..=(x + RIM).min(extent.nx() - 1) {
            for j in y.saturating_sub(RIM)..=(y + RIM).min(extent.ny() - 1) {
                out[extent.index(i, j)] = true;
            }
        }
    }
    out
}

/// Takes the lines of changed roads out of a layout, and puts the new ones in.
fn swap_lines(
    layout: &mut BevLayout,
    nets: [&RoadNetwork; 2],
    drawn: [&RoadDrawing; 2],
    anew: Option<RoadId>,
) {
    let extent = layout.extent();
    let [old, new] = drawn.map(|d| &d.owners);
    let all: BTreeSet<_> = old.keys().chain(new.keys()).copied().collect();
    let is_anew = |o: &RoadElement| anew.is_some_and(|id| *o == RoadElement::Road(id));
    let due: Vec<_> = all
        .into_iter()
        .filter(|o| old.get(o) != new.get(o) || is_anew(o))
        .collect();
    if due.is_empty() {
        return;
    }
    let surface = nets[0].surface_of(extent, &due, 0.0);
    let others: Vec<_> = old.keys().filter(|o| !due.contains(o)).copied().collect();
    let beside = nets[0].surface_of(extent, &others, 0.0);
    let on = |cells: &[bool]| -> Vec<[usize; 2]> {
        let on = extent.all_columns().filter(|[x, y]| cells[extent.index(*x, *y)]);
        on.collect()
    };
    let own: Vec<bool> = surface.iter().zip(&beside).map(|(a, b)| *a && !*b).collect();
    let (whole, own) = (
        CellSet::new(extent, &on(&surface)),
        CellSet::new(extent, &on(&own)),
    );
    // Lines under a new road are removed, except those of other roads.
    let under = CellSet::new(extent, &on(&nets[1].surface_of(extent, &due, 0.0)));
    let of_others: Vec<&Polyline> = others.iter().filter_map(|o| new.get(o)).flatten().collect();
    let mut lines: Vec<Polyline> = Vec::new();
    for line in layout.polylines.iter() {
        if of_others.contains(&line) {
            lines.push(line.clone());
            continue;
        }
        if share(&whole, &line.points_m) > OWN || share(&under, &line.points_m) > OWN {
            continue;
        }
        if !own.touches(&line.points_m) {
            lines.push(line.clone());
            continue;
        }
        if share(&own, &line.points_m) < 0.02 {
            lines.push(line.clone());
            continue;
        }
        let pieces = own.outside(&line.points_m).into_iter();
        lines.extend(pieces.map(|points_m| Polyline {
            kind: line.kind,
            points_m,
        }));
    }
    lines.extend(due.iter().filter_map(|o| new.get(o)).flatten().cloned());
    layout.polylines = lines.into();
}

/// Share of a line that lies on an area, 0 to 1; its part beyond the map does not count.
fn share(area: &CellSet, points_m: &[DVec2]) -> f64 {
    let (mut all, mut on) = (0usize, 0usize);
    for [a, b] in points_m.array_windows::<2>() {
        let steps = (a.distance(*b) / STEP_M).ceil().clamp(1.0, 10_000.0);
        for k in 0..=steps as usize {
            let p = a.lerp(*b, k as f64 / steps);
            let Some(inside) = area.at(p) else { continue };
            all += 1;
            on += usize::from(inside);
        }
    }
    if all == 0 { 0.0 } else { on as f64 / all as f64 }
}
