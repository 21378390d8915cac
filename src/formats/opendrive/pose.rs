//! Where to look from: a good default place in a network, and the lane nearest to a chosen one.

use std::collections::BTreeMap;

use glam::DVec2;

use super::lanes::{Lane, LaneKind, LaneSection, Travel};
use super::sampling::{BUDGET, LaneEdges, walk};
use super::{RoadEnd, RoadNetwork, XodrJunction, XodrRoad};

/// How far before a junction the default place is, m: its middle is then well ahead, all of it in view.
const BEFORE_JUNCTION_M: f64 = 12.0;
/// Narrowest lane that is chosen, m.
const NARROWEST_M: f64 = 2.0;
/// Widest lane that is a lane and not a yard, m.
const WIDEST_M: f64 = 6.0;

/// A place in the middle of a traffic lane.
#[derive(Clone, Debug, PartialEq)]
pub struct LanePose {
    /// On the lane's centre, m, in the file's frame.
    pub position_m: DVec2,
    /// In driving direction, rad.
    pub heading_rad: f64,
    /// Id of the road.
    pub road: String,
    /// Id of the lane.
    pub lane: i32,
    /// How far it is from the place asked for, m.
    pub distance_m: f64,
}

impl RoadNetwork {
    /// A place worth opening: the kerb-side traffic lane of the longest approach to the junction with
    /// the most approaches; without a junction, half way along the longest road. Position in m and
    /// heading in rad, in the file's frame.
    pub fn suggest_pose(&self) -> (DVec2, f64) {
        if self.own.is_some() {
            return (DVec2::ZERO, 0.0); // where the ego vehicle was when Sceneloom wrote the file
        }
        if let Some(start) = self.start {
            return start;
        }
        let mut junctions: Vec<&XodrJunction> = self.junctions.iter().collect();
        junctions.sort_by_key(|j| std::cmp::Reverse(j.incoming.len())); // stable: file order on a tie
        let mut leading = self.approaches();
        let near_junction = junctions.iter().find_map(|junction| {
            let mut approaches = leading.remove(junction.id.as_str()).unwrap_or_default();
            approaches.sort_by(|a, b| b.0.length_m().total_cmp(&a.0.length_m()));
            approaches.into_iter().find_map(|(road, at_end)| {
                let back = BEFORE_JUNCTION_M.min(road.length_m() / 2.0);
                let (s_m, travel) = if at_end {
                    (road.length_m() - back, Travel::Forward)
                } else {
                    (back, Travel::Backward)
                };
                outermost_lane(road, s_m, Some(travel))
            })
        });
        near_junction
            .or_else(|| {
                let mut roads: Vec<&XodrRoad> = self.roads.iter().collect();
                roads.sort_by(|a, b| b.length_m().total_cmp(&a.length_m()));
                let any_lane = |travel| {
                    roads
                        .iter()
                        .find_map(|r| outermost_lane(r, r.length_m() / 2.0, travel))
                };
                any_lane(Some(Travel::Forward)).or_else(|| any_lane(None))
            })
            .or_else(|| {
                let road = self.roads.first()?;
                let middle = road.reference.at(road.length_m() / 2.0);
                Some((middle.position_m, middle.heading_rad))
            })
            .unwrap_or((DVec2::ZERO, 0.0))
    }

    /// By junction, the ends at which roads lead into it; true for a road's end, false for its start.
    fn approaches(&self) -> BTreeMap<&str, Vec<(&XodrRoad, bool)>> {
        let mut out: BTreeMap<&str, Vec<(&XodrRoad, bool)>> = BTreeMap::new();
        for road in self.roads.iter().filter(|road| road.junction.is_none()) {
            for (end, is_end) in [(&road.successor, true), (&road.predecessor, false)] {
                if let Some(RoadEnd::Junction(id)) = end {
                    out.entry(id).or_default().push((road, is_end));
                }
            }
        }
        out
    }

    /// Corners of the rectangle around all reference lines, file frame, m; both the origin if there is no road.
    pub fn bounds_m(&self) -> [DVec2; 2] {
        let (low, high) = self.bounds_from(|p| p);
        [low, high]
    }

    /// Corners of the rectangle around all reference lines in another frame, m; both zero if there is no road. `frame`
    /// takes a point of the file's frame to the other.
    pub fn bounds_from(&self, frame: impl Fn(DVec2) -> DVec2) -> (DVec2, DVec2) {
        // A curve leaves the chord between two of its points by less than the margin that callers add.
        const STEPS: usize = 64;
        let points = self.roads.iter().flat_map(|road| {
            let length_m = road.length_m();
            (0..=STEPS).map(move |i| road.reference.at(length_m * i as f64 / STEPS as f64).position_m)
        });
        let sound = points.map(frame).filter(|p| p.is_finite());
        sound
            .map(|p| (p, p))
            .reduce(|a, b| (a.0.min(b.0), a.1.max(b.1)))
            .unwrap_or_default()
    }

    /// The nearest place in the middle of a traffic lane; `None` if the network has none or `at_m` is
    /// not finite. Found to a quarter of a metre along the lane.
    pub fn pose_on_lane_near(&self, at_m: DVec2) -> Option<LanePose> {
        if !at_m.is_finite() {
            return None;
        }
        let mut best: Option<LanePose> = None;
        let mut roads: Vec<(f64, &XodrRoad)> = self
            .roads
            .iter()
            .map(|road| {
                let middle = road.reference.at(road.length_m() / 2.0).position_m;
                (middle.distance(at_m) - road.length_m() / 2.0, road)
            })
            .collect();
        roads.sort_by(|a, b| a.0.total_cmp(&b.0)); // likely ones first, so that the search narrows early
        let mut budget = BUDGET;
        for (_, road) in roads {
            for section in &road.sections {
                let radius_m = best.as_ref().map_or(f64::INFINITY, |b| b.distance_m);
                walk(road, section, at_m, radius_m, &mut budget, |from, _, _| {
                    for (i, lane) in section.lanes_left_to_right().enumerate() {
                        if !lane.kind.carries_traffic() || from.width(i) < NARROWEST_M {
                            continue;
                        }
                        let position_m = from.between(i, i + 1);
                        let distance_m = position_m.distance(at_m);
                        if best.as_ref().is_none_or(|b| distance_m < b.distance_m) {
                            best = Some(LanePose {
                                position_m,
                                heading_rad: from.heading_rad(lane.travel),
                                road: road.id.clone(),
                                lane: lane.id,
                                distance_m,
                            });
                        }
                    }
                    best.as_ref().map(|b| b.distance_m)
                });
            }
        }
        best
    }
}

/// The traffic lane farthest from the centre line that runs the given way (any way for `None`).
fn outermost_lane(road: &XodrRoad, s_m: f64, travel: Option<Travel>) -> Option<(DVec2, f64)> {
    let section: &LaneSection = road.section_at(s_m)?;
    let row = LaneEdges::at(road, section, s_m);
    let lanes = section.lanes_left_to_right().enumerate();
    let fits = |(i, lane): &(usize, &Lane)| {
        lane.kind == LaneKind::Driving
            && (NARROWEST_M..=WIDEST_M).contains(&row.width(*i))
            && travel.is_none_or(|t| t == lane.travel)
    };
    let (i, lane) = lanes
        .filter(fits)
        .max_by_key(|(_, lane)| lane.id.unsigned_abs())?;
    Some((row.between(i, i + 1), row.heading_rad(lane.travel)))
}
