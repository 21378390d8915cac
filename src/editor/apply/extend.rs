//! More map: roads go on beyond its edge as they reach it, and the ground there waits to be generated.

use std::sync::Arc;

use glam::DVec2;
use scene::roads::{Arm, NodeId};
use scene::{
    BevLayout, Edit, EditError, Extent, Frame, Inferred, Polyline, PolylineKind, Road, RoadNetwork, Scene,
    SourceFrame, draft,
};

/// Distance from a lane's middle, along the edge, within which the ground goes on in the lane's direction, m; elsewhere
/// it goes straight out.
const BESIDE_LANE_M: f64 = 18.0;
/// Lanes that leave the map nearer to one another than this are those of one road, m.
const ONE_ROAD_M: f64 = 8.0;
/// A line that ends within this distance of the edge counts as one that reaches it, m.
const AT_EDGE_M: f64 = 2.5;
/// Length by which lines go on beyond the new edge, m.
const BEYOND_M: f64 = 5.0;
/// Least sine of the angle to the edge at which a line leaves the map.
const STEEPEST: f64 = 0.35;

/// Applies an [`Edit::ExtendMap`]. On error nothing has changed.
pub(super) fn apply(edit: &Edit, scene: &mut Scene) -> Result<(), EditError> {
    let &Edit::ExtendMap {
        ahead_m,
        behind_m,
        left_m,
        right_m,
    } = edit
    else {
        return Ok(());
    };
    let old = scene.canvas().extent();
    let mut columns = [0; 4];
    let sides = [
        ("behind_m", behind_m),
        ("ahead_m", ahead_m),
        ("right_m", right_m),
        ("left_m", left_m),
    ];
    for ((field, m), columns) in sides.into_iter().zip(&mut columns) {
        if !(0.0..=FARTHEST_M).contains(&m) {
            return Err(EditError::Number {
                field,
                found: m.to_string(),
                expected: "0 to 2000 m",
            });
        }
        *columns = (m / old.voxel_m()).round() as i32;
    }
    let mut layout = scene.canvas().layout.clone();
    let mut roads = scene.roads.clone();
    for (side, columns) in SIDES.into_iter().zip(columns).filter(|(_, columns)| *columns > 0) {
        let leavings = side.leavings(&layout);
        let larger = side.extended(&layout, &leavings, columns)?;
        if !roads.is_empty() {
            side.extend_roads(
                [layout.extent(), larger.extent()],
                &leavings,
                Arc::make_mut(&mut roads),
            );
        }
        layout = larger;
    }
    if layout.extent() == old {
        return Ok(());
    }
    scene.roads = roads;
    scene.change_canvas(|canvas| *canvas = over(canvas, layout));
    Ok(())
}

/// Farthest that a map grows on one side at once, m.
const FARTHEST_M: f64 = 2000.0;

/// A frame over a larger layout. The new part holds a draft of its ground and no source: it is to be generated.
fn over(frame: &Frame, layout: BevLayout) -> Frame {
    let (old, new) = (frame.extent(), layout.extent());
    let mut occupancy = draft::draft(&layout, frame.boxes.values());
    occupancy.paste(&frame.occupancy);
    let source = SourceFrame {
        layout: frame.source.layout.crop(new),
        boxes: frame.source.boxes.clone(),
        occupancy: frame.source.occupancy.crop(new),
    };
    debug_assert!(old.overlap(&new).is_some());
    Frame {
        layout,
        occupancy,
        painted: frame.painted.crop(new),
        inferred: Inferred {
            unobserved: frame.inferred.unobserved.as_ref().map(|u| u.crop(new)),
            data_labels: frame.inferred.data_labels.as_ref().map(|l| l.crop(new)),
            ..frame.inferred.clone()
        },
        source: Arc::new(source),
        ..frame.clone()
    }
}

/// One side of a map: along x or y, at its lower or upper end.
#[derive(Clone, Copy)]
struct MapSide {
    axis: usize,
    upper: bool,
}

const SIDES: [MapSide; 4] = [
    MapSide {
        axis: 0,
        upper: false,
    },
    MapSide { axis: 0, upper: true },
    MapSide {
        axis: 1,
        upper: false,
    },
    MapSide { axis: 1, upper: true },
];

/// Exit of a lane from the map: its place along the edge, m, and its shift along the edge per metre outward.
#[derive(Clone, Copy)]
struct Leaving {
    along_m: f64,
    slope: f64,
}

impl MapSide {
    fn outward(self) -> DVec2 {
        let sign = if self.upper { 1.0 } else { -1.0 };
        if self.axis == 0 {
            DVec2::new(sign, 0.0)
        } else {
            DVec2::new(0.0, sign)
        }
    }

    /// Distance of a point outside of this edge, m; negative inside.
    fn outside_m(self, extent: Extent, p: DVec2) -> f64 {
        let edge = if self.upper {
            extent.max_m()
        } else {
            extent.min_m()
        };
        (p - edge.truncate()).dot(self.outward())
    }

    fn along_m(self, p: DVec2) -> f64 {
        if self.axis == 0 { p.y } else { p.x }
    }

    /// Place along the edge and slope of a line through a point in a direction that leads out.
    fn leaving(self, extent: Extent, p: DVec2, way: DVec2) -> Option<Leaving> {
        let out = way.normalize_or_zero().dot(self.outward());
        let slope = self.along_m(way.normalize_or_zero()) / out;
        (out >= STEEPEST).then(|| Leaving {
            along_m: self.along_m(p) - self.outside_m(extent, p) * slope,
            slope,
        })
    }

    /// Exits of all lanes on this side, in either driving direction.
    fn leavings(self, layout: &BevLayout) -> Vec<Leaving> {
        let extent = layout.extent();
        let lanes = layout
            .polylines
            .iter()
            .filter(|l| l.kind == PolylineKind::LaneCenter);
        let leaving = |[a, b]: [DVec2; 2]| {
            let (a_m, b_m) = (self.outside_m(extent, a), self.outside_m(extent, b));
            let crosses = a_m <= 0.0 && b_m > 0.0 || a_m < b_m && (-AT_EDGE_M..=0.0).contains(&b_m);
            crosses.then(|| self.leaving(extent, b, b - a)).flatten()
        };
        let found = lanes.flat_map(|line| {
            let both_ways = line
                .points_m
                .array_windows::<2>()
                .flat_map(|[a, b]| [[*a, *b], [*b, *a]]);
            both_ways.filter_map(leaving).collect::<Vec<_>>()
        });
        let corners = [extent.min_m().truncate(), extent.max_m().truncate()].map(|p| self.along_m(p));
        let mut found: Vec<Leaving> = found
            .filter(|l| (corners[0]..=corners[1]).contains(&l.along_m))
            .collect();
        found.sort_by(|a, b| a.along_m.total_cmp(&b.along_m));
        // Lanes of one road, or of a junction that the edge cuts, go on side by side, in the direction of the
        // straightest of them.
        let mut side_by_side = Vec::new();
        for road in found.chunk_by(|a, b| b.along_m - a.along_m < ONE_ROAD_M) {
            let straightest = road
                .iter()
                .map(|l| l.slope)
                .min_by(|a, b| a.abs().total_cmp(&b.abs()));
            let slope = straightest.unwrap_or_default();
            side_by_side.extend(road.iter().map(|l| Leaving { slope, ..*l }));
        }
        side_by_side
    }

    /// The layout with so many more columns on this side. Roads go on there in the direction in which they leave the
    /// map.
    fn extended(
        self,
        layout: &BevLayout,
        leavings: &[Leaving],
        columns: i32,
    ) -> Result<BevLayout, EditError> {
        let old = layout.extent();
        let (mut from, mut size) = (old.from(), [old.nx(), old.ny()]);
        size[self.axis] += columns as usize;
        if !self.upper {
            from[self.axis] -= columns;
        }
        let new = old.with_columns(from, size).map_err(EditError::BadMap)?;
        let last = [old.nx(), old.ny()].map(|n| n as i64 - 1);
        // Each new column copies the column at the edge from which its road comes.
        let cell = |[x, y]: [usize; 2]| {
            let p = new.center(x, y, 0).truncate();
            let outside_m = self.outside_m(old, p);
            let nearest = leavings
                .iter()
                .map(|l| (l, (self.along_m(p) - outside_m * l.slope - l.along_m).abs()))
                .min_by(|a, b| a.1.total_cmp(&b.1));
            let beside = nearest.filter(|(_, off_m)| *off_m <= BESIDE_LANE_M);
            // Straight outward of an exit whose road turned aside there is no road.
            let left = |l: &Leaving| (self.along_m(p) - l.along_m).abs() <= BESIDE_LANE_M;
            if outside_m > 0.0 && beside.is_none() && leavings.iter().any(left) {
                return 0;
            }
            let slope = beside.map_or(0.0, |(l, _)| l.slope);
            let mut at = p - self.outward() * outside_m.max(0.0);
            at[1 - self.axis] -= outside_m.max(0.0) * slope;
            let column = |axis: usize| {
                let column = (at[axis] / old.voxel_m()).floor() as i64 - i64::from(old.from()[axis]);
                column.clamp(0, last[axis]) as usize
            };
            layout.cell(column(0), column(1))
        };
        let cells = new.all_columns().map(cell).collect();
        let lines = layout
            .polylines
            .iter()
            .map(|line| self.line_to([old, new], leavings, line))
            .collect();
        let mut out = BevLayout::from_cells_over(new, cells, lines)
            .map_err(|found| EditError::BadMap(format!("{found} columns")))?;
        out.relief = layout.relief.crop(new);
        Ok(out)
    }

    /// A line of the road that ends at the old edge or beyond it goes on to the new one as the drawn road does.
    fn line_to(self, extents: [Extent; 2], leavings: &[Leaving], line: &Polyline) -> Polyline {
        let mut line = line.clone();
        if matches!(line.kind, PolylineKind::StopLine | PolylineKind::PedCrossing) {
            return line;
        }
        for _ in 0..2 {
            line.points_m.reverse();
            if let Some(points_m) = self.end_to(extents, leavings, &line.points_m) {
                line.points_m = points_m;
            }
        }
        line
    }

    /// The points of a line whose end leaves the old map, led on from the old edge to beyond the new one; `None` if it does not.
    fn end_to(self, [old, new]: [Extent; 2], leavings: &[Leaving], points_m: &[DVec2]) -> Option<Vec<DVec2>> {
        let inside = points_m.iter().rposition(|p| self.outside_m(old, *p) <= 0.0)?;
        let mut out = points_m[..=inside].to_vec();
        let last = out[inside];
        // The point where it crosses the edge, or its end just before it.
        let (end, way) = match points_m.get(inside + 1) {
            Some(next) => {
                let (from_m, to_m) = (self.outside_m(old, last), self.outside_m(old, *next));
                (last.lerp(*next, -from_m / (to_m - from_m)), *next - last)
            }
            None if self.outside_m(old, last) >= -AT_EDGE_M => {
                (last, last - *out.get(inside.checked_sub(1)?)?)
            }
            None => return None,
        };
        let along = self.along_m(end);
        let corners = [old.min_m().truncate(), old.max_m().truncate()].map(|p| self.along_m(p));
        if !(corners[0] - ONE_ROAD_M..=corners[1] + ONE_ROAD_M).contains(&along) {
            return None; // it left over another edge before
        }
        let slope = self.slope_of(old, leavings, end, way)?;
        let outside_m = -self.outside_m(new, end) + BEYOND_M;
        let mut on = end + self.outward() * outside_m;
        on[1 - self.axis] += outside_m * slope;
        if end != last {
            out.push(end);
        }
        out.push(on);
        Some(out)
    }

    /// The slope with which the road goes on whose line leaves at `end` in a direction; `None` if it does not lead out.
    fn slope_of(self, old: Extent, leavings: &[Leaving], end: DVec2, way: DVec2) -> Option<f64> {
        let leaving = self.leaving(old, end, way)?;
        let off_m = |l: &&Leaving| (l.along_m - leaving.along_m).abs();
        let lane = leavings.iter().min_by(|a, b| off_m(a).total_cmp(&off_m(b)));
        let beside = lane.filter(|l| off_m(l) < ONE_ROAD_M);
        Some(beside.map_or(leaving.slope, |l| l.slope))
    }

    /// Roads of the network that end at the old edge or beyond it go on to the new one as well.
    fn extend_roads(self, [old, new]: [Extent; 2], leavings: &[Leaving], roads: &mut RoadNetwork) {
        let ends: Vec<(NodeId, Arm)> = roads
            .nodes
            .iter()
            .filter(|node| self.outside_m(old, node.at_m) >= -AT_EDGE_M)
            .filter_map(|node| match roads.arms(node.id).as_slice() {
                [only] => Some((node.id, *only)),
                _ => None,
            })
            .collect();
        for (node, arm) in ends {
            let Some(road) = roads.road(arm.road) else {
                continue;
            };
            let mut points_m = roads.points_m(road);
            if arm.end == 0 {
                points_m.reverse();
            }
            let Some(new_m) = self.end_to([old, new], leavings, &points_m) else {
                continue;
            };
            let length_m = |points: &[DVec2]| points.array_windows::<2>().map(|[a, b]| a.distance(*b)).sum();
            let (was_m, is_m): (f64, f64) = (length_m(&points_m), length_m(&new_m));
            let [_, via_m @ .., end_m] = new_m.as_slice() else {
                continue;
            };
            let mut via_m = via_m.to_vec();
            if arm.end == 0 {
                via_m.reverse();
            }
            if via_m.len() > Road::MAX_VIA {
                continue;
            }
            if let Some(node) = roads.node_mut(node) {
                node.at_m = *end_m;
            }
            if let Some(road) = roads.road_mut(arm.road) {
                road.via_m = via_m;
                if arm.end == 0 {
                    // Places along it are counted from where it begins.
                    road.crossings.iter_mut().for_each(|c| c.at_m += is_m - was_m);
                    road.stops.iter_mut().for_each(|s| s.at_m += is_m - was_m);
                }
            }
        }
    }
}

#[cfg(test)]
#[path = "extend_tests.rs"]
mod tests;
