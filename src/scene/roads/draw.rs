//! Drawing of a road network into a layout.

use std::collections::BTreeMap;

use glam::DVec2;

use super::area::alongside;
use super::corner::{JunctionGeometry, corners};
use super::{Arm, LaneKind, NodeId, NodeKind, Road, RoadId, RoadLane, RoadNetwork, RoadNode, curve};
use crate::{BevLayer, BevLayout, Extent, Polyline, PolylineKind, raster};

/// Layers that roads are drawn into.
pub const LAYERS: [BevLayer; 7] = [
    BevLayer::DrivableArea,
    BevLayer::CarparkArea,
    BevLayer::Walkway,
    BevLayer::PedCrossing,
    BevLayer::StopLine,
    BevLayer::RoadDivider,
    BevLayer::LaneDivider,
];

/// The drawing of a network, without anything else.
#[derive(Clone, Debug)]
pub struct RoadDrawing {
    /// Layers over the map, on flat ground; no lines.
    pub layout: BevLayout,
    /// Lines by their owner.
    pub owners: BTreeMap<RoadElement, Vec<Polyline>>,
}

/// A node at which roads meet, with everything that its corners depend on.
#[derive(Clone, Debug, PartialEq)]
pub struct Junction {
    /// The node.
    pub node: RoadNode,
    /// Distance from the node that it draws on, m.
    pub reach_m: f64,
    /// Its arms: place where each leaves, m, and its lanes on the left and on the right.
    pub arms: Vec<(Arm, DVec2, Vec<RoadLane>, Vec<RoadLane>)>,
}

/// Owner of a line.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum RoadElement {
    /// A road.
    Road(RoadId),
    /// A roundabout.
    Node(NodeId),
}

/// Surface of a cell, in the order in which one covers another.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
enum CellSurface {
    Nothing,
    Walk,
    Park,
    Road,
}

impl RoadNetwork {
    /// The drawing of the network over a map. Cells: road over parking over walkway. Lines: lane middles, dividers up
    /// to the junctions, stop lines and crossings.
    pub fn draw(&self, extent: Extent) -> RoadDrawing {
        let lines = self.lines();
        let corners = corners(self, &lines);
        let mut surface = vec![CellSurface::Nothing; extent.columns()];
        let mut put = |[x, y]: [usize; 2], what: CellSurface| {
            let at = &mut surface[extent.index(x, y)];
            *at = what.max(*at);
        };
        for road in &self.roads {
            let line = &lines[&road.id];
            let length_m = curve::length_m(line);
            let free_m = [false, true].map(|right| free_side(road, right, &corners, length_m));
            for near in alongside(extent, line, road.reach_m(true).max(road.reach_m(false))) {
                let [from_m, to_m] = free_m[usize::from(near.left_m < 0.0)];
                let at_junction = near.along_m < from_m || near.along_m > to_m;
                if let Some(what) = surface_at(road, near.left_m, at_junction) {
                    put(near.cell, what);
                }
            }
        }
        for (line, walk_m) in &corners.walks {
            raster::line_cells(extent, line, *walk_m, |x, y| put([x, y], CellSurface::Walk));
        }
        for outline in &corners.paved {
            raster::polygon_cells(extent, outline, |x, y| put([x, y], CellSurface::Road));
        }
        for (center, radius_m) in &corners.islands {
            raster::disc_cells(extent, *center, *radius_m, |x, y| {
                surface[extent.index(x, y)] = CellSurface::Nothing;
            });
        }
        let mut layout = BevLayout::over(extent);
        for ([x, y], what) in extent.all_columns().zip(surface) {
            let layer = match what {
                CellSurface::Nothing => continue,
                CellSurface::Walk => BevLayer::Walkway,
                CellSurface::Park => BevLayer::CarparkArea,
                CellSurface::Road => BevLayer::DrivableArea,
            };
            layout.set(layer, x, y, true);
        }
        let owners = self.marks(&lines, &corners);
        for line in owners.values().flatten() {
            raster::draw_polyline(&mut layout, line);
        }
        RoadDrawing { layout, owners }
    }

    /// All of its roads and roundabouts.
    pub fn owners(&self) -> Vec<RoadElement> {
        let rings = self
            .nodes
            .iter()
            .filter(|n| matches!(n.kind, NodeKind::Roundabout { .. }));
        let roads = self.roads.iter().map(|r| RoadElement::Road(r.id));
        roads.chain(rings.map(|n| RoadElement::Node(n.id))).collect()
    }

    /// The columns that roads and roundabouts cover, without walkways, and a rim of `rim_m` around them.
    pub fn surface_of(&self, extent: Extent, owners: &[RoadElement], rim_m: f64) -> Vec<bool> {
        let mut out = vec![false; extent.columns()];
        let lines = self.lines();
        for owner in owners {
            match owner {
                RoadElement::Road(id) => {
                    let (Some(road), Some(line)) = (self.road(*id), lines.get(id)) else {
                        continue;
                    };
                    let kerbs = [false, true].map(|right| road.kerb_m(right, true) + rim_m);
                    for near in alongside(extent, line, kerbs[0].max(kerbs[1])) {
                        let [x, y] = near.cell;
                        out[extent.index(x, y)] |= near.left_m <= kerbs[0] && -near.left_m <= kerbs[1];
                    }
                }
                RoadElement::Node(id) => {
                    let Some(node) = self.node(*id) else { continue };
                    if let NodeKind::Roundabout { island_m, ring_m } = node.kind {
                        let radius_m = island_m + ring_m + rim_m;
                        raster::disc_cells(extent, node.at_m, radius_m, |x, y| {
                            out[extent.index(x, y)] = true
                        });
                    }
                }
            }
        }
        out
    }

    /// The nodes at which roads meet, as they are drawn.
    pub fn junctions(&self) -> Vec<Junction> {
        let lines = self.lines();
        let corners = corners(self, &lines);
        let meets = self.nodes.iter().filter_map(|node| {
            let arms = self.arms(node.id);
            let back = arms
                .iter()
                .filter_map(|a| corners.setback_m.get(&(a.road, a.end)));
            let reach_m = back.copied().fold(0.0, f64::max);
            let arm = |a: &Arm| {
                let (road, line) = (self.road(a.road)?, lines.get(&a.road)?);
                let along = if a.end == 0 {
                    reach_m
                } else {
                    curve::length_m(line) - reach_m
                };
                Some((
                    *a,
                    curve::at(line, along).0,
                    road.left.clone(),
                    road.right.clone(),
                ))
            };
            (reach_m > 0.0).then(|| Junction {
                node: *node,
                reach_m,
                arms: arms.iter().filter_map(arm).collect(),
            })
        });
        meets.collect()
    }

    fn marks(
        &self,
        lines: &BTreeMap<RoadId, Vec<DVec2>>,
        corners: &JunctionGeometry,
    ) -> BTreeMap<RoadElement, Vec<Polyline>> {
        let mut out: BTreeMap<RoadElement, Vec<Polyline>> = BTreeMap::new();
        for road in &self.roads {
            out.insert(
                RoadElement::Road(road.id),
                self.marks_of(road, &lines[&road.id], corners),
            );
        }
        for (node, points_m) in &corners.lanes {
            let line = Polyline {
                kind: PolylineKind::LaneCenter,
                points_m: points_m.clone(),
            };
            out.entry(RoadElement::Node(*node)).or_default().push(line);
        }
        out
    }

    fn marks_of(&self, road: &Road, line: &[DVec2], corners: &JunctionGeometry) -> Vec<Polyline> {
        let mut out = Vec::new();
        let mut push = |kind, points_m: Vec<DVec2>| {
            if points_m.len() > 1 {
                out.push(Polyline { kind, points_m });
            }
        };
        let length_m = curve::length_m(line);
        let free_m = free_part(road, corners, length_m);
        let free = |points: Vec<DVec2>| cut(line, points, free_m);
        let driven = |right: bool| road.side(right).first().is_some_and(|l| l.kind.is_carriageway());
        if driven(true) && driven(false) {
            push(PolylineKind::RoadDivider, free(line.to_vec()));
        }
        for right in [true, false] {
            let (sign, mut off) = (if right { -1.0 } else { 1.0 }, 0.0);
            let lanes = road.side(right);
            for (i, lane) in lanes.iter().enumerate() {
                if lane.kind.is_driven() {
                    let middle = curve::beside(line, sign * (off + lane.width_m / 2.0));
                    let mut middle = cut(line, middle, self.lane_part(road, corners, length_m));
                    if !right {
                        middle.reverse();
                    }
                    push(PolylineKind::LaneCenter, middle);
                }
                off += lane.width_m;
                let marked = |l: &RoadLane| l.kind.is_carriageway() && l.kind != LaneKind::Shoulder;
                if marked(lane) && lanes.get(i + 1).is_some_and(marked) {
                    push(PolylineKind::LaneDivider, free(curve::beside(line, sign * off)));
                }
            }
        }
        for stop in &road.stops {
            let (at, way) = curve::at(line, beyond_corners(stop.at_m, 0.0, free_m));
            let off = road.kerb_m(stop.right, false) * if stop.right { -1.0 } else { 1.0 };
            if off != 0.0 {
                push(PolylineKind::StopLine, vec![at, at + way.perp() * off]);
            }
        }
        for crossing in &road.crossings {
            let (at, way) = curve::at(
                line,
                beyond_corners(crossing.at_m, crossing.width_m / 2.0, free_m),
            );
            let half = way * (crossing.width_m / 2.0);
            let (l, r) = (
                at + way.perp() * road.kerb_m(false, false),
                at - way.perp() * road.kerb_m(true, false),
            );
            push(
                PolylineKind::PedCrossing,
                vec![l - half, r - half, r + half, l + half],
            );
        }
        out
    }

    /// The part of a road along which its lanes run: up to its nodes, but not into roundabouts.
    fn lane_part(&self, road: &Road, corners: &JunctionGeometry, length_m: f64) -> [f64; 2] {
        let ring = |end: usize| {
            let node = self.node(road.ends[end]);
            node.is_some_and(|n| matches!(n.kind, NodeKind::Roundabout { .. }))
        };
        let free = free_part(road, corners, length_m);
        [
            if ring(0) { free[0] } else { 0.0 },
            if ring(1) { free[1] } else { length_m },
        ]
    }
}

/// The part of a road outside of its junctions, from and to, m.
fn free_part(road: &Road, corners: &JunctionGeometry, length_m: f64) -> [f64; 2] {
    let back = |end: usize| corners.setback_m.get(&(road.id, end)).copied().unwrap_or(0.0);
    [back(0), length_m - back(1)]
}

/// The place along a road nearest to `at_m` that keeps `reach_m` on both sides clear of junctions; the middle of the
/// free part where there is no room.
fn beyond_corners(at_m: f64, reach_m: f64, free_m: [f64; 2]) -> f64 {
    let (low, high) = (free_m[0] + reach_m, free_m[1] - reach_m);
    if low < high {
        at_m.clamp(low, high)
    } else {
        (free_m[0] + free_m[1]) / 2.0
    }
}

/// The part of a road outside of its junctions on one side, from and to, m.
fn free_side(road: &Road, right: bool, corners: &JunctionGeometry, length_m: f64) -> [f64; 2] {
    let back = |end: usize| corners.side_m.get(&(road.id, end, right)).copied().unwrap_or(0.0);
    [back(0), length_m - back(1)]
}

/// The surface at `left_m` to the left of a road's line; `None` where the road has none.
fn surface_at(road: &Road, left_m: f64, at_junction: bool) -> Option<CellSurface> {
    let right = left_m < 0.0;
    let mut edge = 0.0;
    let lane = road.side(right).iter().find(|lane| {
        edge += lane.width_m;
        left_m.abs() <= edge
    });
    match lane?.kind {
        LaneKind::Verge => None,
        LaneKind::Walk => Some(CellSurface::Walk),
        LaneKind::Parking if !at_junction => Some(CellSurface::Park),
        _ => Some(CellSurface::Road),
    }
}

/// The part of a line beside another that lies between two places along that other line.
fn cut(line: &[DVec2], beside: Vec<DVec2>, part_m: [f64; 2]) -> Vec<DVec2> {
    let length_m = curve::length_m(line);
    if part_m[0] <= 0.0 && part_m[1] >= length_m {
        return beside;
    }
    let on = |along: f64| {
        let (at, _) = curve::at(line, along);
        curve::project(&beside, at).map_or(0.0, |p| p.0)
    };
    curve::part(&beside, on(part_m[0]), on(part_m[1]))
}
