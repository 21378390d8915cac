//! Predicates for relations of a box, for placing boxes and for picking them by words. The thresholds lie inside those
//! of the scene graph's own predicates wherever both are needed.

use glam::DVec2;

use super::lanes::LaneMap;
use scene::graph::{LaneRole, RelationKind};
use scene::{BevLayer, BoxId, BoxLabel, Class, SceneBox};

/// Reference of a relation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum RelationReference {
    /// An object, or the ego vehicle.
    Thing(SceneBox),
    /// A lane or strip.
    Lane(LaneRole),
    /// The crossing that is meant.
    Crossing,
    /// The nearest junction.
    Junction,
}

/// The ego vehicle as a box; distances to it count from the origin.
pub fn ego() -> SceneBox {
    SceneBox {
        id: BoxId(u32::MAX),
        class: Class::Car,
        center_m: glam::DVec3::new(1.4, 0.0, 0.8),
        size_m: glam::DVec3::new(4.6, 1.95, 1.6),
        yaw_rad: 0.0,
        velocity_mps: DVec2::ZERO,
        label: BoxLabel::default(),
    }
}

fn at(b: &SceneBox) -> DVec2 {
    if b.id == BoxId(u32::MAX) {
        DVec2::ZERO
    } else {
        b.center_m.truncate()
    }
}

/// The direction that front, behind, left and right of a box count from.
pub fn course(b: &SceneBox) -> DVec2 {
    match b.class {
        Class::Pedestrian | Class::TrafficCone | Class::Barrier => DVec2::X,
        _ => b.heading(),
    }
}

/// Depth of the overlap of two footprints when both are grown by half of `margin_m`; 0 or less if they are apart
/// (separating axes).
pub fn overlap_m(a: &SceneBox, b: &SceneBox, margin_m: f64) -> f64 {
    let d = (b.center_m - a.center_m).truncate();
    let reach = |x: &SceneBox, axis: DVec2| {
        let h = x.heading();
        (x.size_m.x * h.dot(axis).abs() + x.size_m.y * h.perp_dot(axis).abs() + margin_m) / 2.0
    };
    let axes = [a.heading(), a.heading().perp(), b.heading(), b.heading().perp()];
    axes.into_iter()
        .map(|axis| reach(a, axis) + reach(b, axis) - d.dot(axis).abs())
        .fold(f64::INFINITY, f64::min)
}

fn outline_m(outline: &[DVec2], p: DVec2) -> f64 {
    let mut inside = false;
    let mut best = f64::INFINITY;
    for (i, a) in outline.iter().enumerate() {
        let b = outline[(i + 1) % outline.len()];
        if (a.x <= p.x) != (b.x <= p.x) && a.y + (p.x - a.x) / (b.x - a.x) * (b.y - a.y) > p.y {
            inside = !inside;
        }
        let t = ((p - *a).dot(b - *a) / (b - *a).length_squared().max(1e-12)).clamp(0.0, 1.0);
        best = best.min(p.distance(*a + (b - *a) * t));
    }
    if inside { -best } else { best }
}

/// Free space between two footprints, m.
pub fn gap_m(a: &SceneBox, b: &SceneBox) -> f64 {
    let corner = |from: &SceneBox, to: &SceneBox| {
        let outline = to.footprint();
        from.footprint()
            .map(|c| outline_m(&outline, c))
            .into_iter()
            .fold(f64::INFINITY, f64::min)
    };
    corner(a, b).min(corner(b, a)).max(0.0)
}

const ROAD: u32 = 1 << BevLayer::DrivableArea as u32;
const WALK: u32 = 1 << BevLayer::Walkway as u32;
const LOT: u32 = 1 << BevLayer::CarparkArea as u32;

/// True if the centre of the box lies in a lane or strip.
pub fn in_role(map: &LaneMap<'_>, role: LaneRole, p: DVec2) -> bool {
    use LaneRole as L;
    let lateral = || map.course(p).map_or(p.y, |c| c.1);
    let near_lane = || {
        let lane = map.nearest(p);
        lane.filter(|l| l.p.distance(p) < 1.75).map(|l| l.role)
    };
    match role {
        L::Ego | L::Left | L::Right | L::Oncoming | L::Cross => near_lane() == Some(role),
        L::Road => map.has(ROAD, p),
        L::Sidewalk => map.has(WALK, p),
        L::LeftSidewalk => map.has(WALK, p) && lateral() > 0.0,
        L::RightSidewalk => map.has(WALK, p) && lateral() < 0.0,
        L::Carpark => map.has(LOT, p),
        L::Roadside | L::LeftRoadside | L::RightRoadside => {
            let side = match role {
                L::LeftRoadside => lateral() > 0.0,
                L::RightRoadside => lateral() < 0.0,
                _ => true,
            };
            // Beside the lanes, or on the outer half of the outermost one.
            let edge = (0..16).any(|k| {
                let d = DVec2::from_angle(f64::from(k) * std::f64::consts::TAU / 16.0);
                !map.has(ROAD, p + d * 2.6)
            });
            side && edge
        }
    }
}

/// The lane or strip that a box counts to.
pub fn role_of(map: &LaneMap<'_>, b: &SceneBox) -> Option<LaneRole> {
    use LaneRole as L;
    let p = b.center_m.truncate();
    let walks = [L::LeftSidewalk, L::RightSidewalk];
    let lanes = [L::Ego, L::Left, L::Right, L::Oncoming, L::Cross];
    // (parking strips at the edge of the road are roadsides)
    let lot = in_role(map, L::Carpark, p) && map.nearest(p).is_none_or(|l| l.p.distance(p) > 4.5);
    let strips = if lot {
        [L::Carpark, L::LeftRoadside, L::RightRoadside]
    } else {
        [L::LeftRoadside, L::RightRoadside, L::Carpark]
    };
    let all: Vec<L> = match b.class {
        Class::Pedestrian => walks.to_vec(),
        // A driver is in a lane; a box standing beside one is at the edge.
        _ if b.velocity_mps.length() > 0.5 => [&lanes[..], &strips, &walks].concat(),
        _ => {
            let off = map.nearest(p).map_or(f64::INFINITY, |l| l.p.distance(p));
            let small = matches!(b.class, Class::TrafficCone | Class::Barrier);
            if off < if small { 1.6 } else { 0.8 } {
                [&lanes[..], &strips, &walks].concat()
            } else {
                [&strips[..], &walks, &lanes].concat()
            }
        }
    };
    all.into_iter().find(|role| in_role(map, *role, p))
}

/// Distance between a box and the reference of a relation, measured as for the relation.
pub fn measured(relation: RelationKind, from: &SceneBox, to: &SceneBox) -> f64 {
    use RelationKind as R;
    let (axis, d) = (course(to), from.center_m.truncate() - at(to));
    match relation {
        R::InFrontOf | R::Behind | R::Following => axis.dot(d).abs(),
        R::LeftOf | R::RightOf => axis.perp_dot(d).abs(),
        _ => d.length(),
    }
}

/// Distance between a box and a target, measured as for the relation, m; `None` if there is no such target.
pub fn from_m(
    map: &LaneMap<'_>,
    relation: RelationKind,
    from: &SceneBox,
    to: &RelationReference,
) -> Option<f64> {
    let p = from.center_m.truncate();
    match to {
        RelationReference::Thing(b) => Some(measured(relation, from, b)),
        RelationReference::Lane(role) => {
            let lane = map
                .points
                .iter()
                .filter(|l| *role == LaneRole::Road || l.role == *role);
            lane.map(|l| l.p.distance(p)).min_by(f64::total_cmp)
        }
        RelationReference::Crossing => Some(outline_m(map.crossing()?, p).max(0.0)),
        RelationReference::Junction => Some((map.junction?.distance(p) - 10.0).max(0.0)),
    }
}

/// True if `relation` holds between a box and a target. Stated distances are met to 15 %, or 1.5 m.
pub fn holds(
    map: &LaneMap<'_>,
    relation: RelationKind,
    from: &SceneBox,
    to: &RelationReference,
    and: Option<&SceneBox>,
    distance_m: Option<f64>,
) -> bool {
    use RelationKind as R;
    let p = from.center_m.truncate();
    let standing = from.velocity_mps.length() < 0.5;
    let heading = from.heading();
    let crosswise = || map.nearest(p).is_some_and(|l| l.dir.dot(heading).abs() < 0.7);
    let (held, distance) = match to {
        RelationReference::Thing(b) => {
            let held = to_thing(map, relation, from, b, and, distance_m.is_some());
            let distance = measured(relation, from, b);
            (held, distance)
        }
        RelationReference::Lane(role) => {
            let lane = map.points.iter().filter(|l| match role {
                LaneRole::Road => true,
                r => l.role == *r,
            });
            let nearest = lane.min_by(|a, b| a.p.distance_squared(p).total_cmp(&b.p.distance_squared(p)));
            let off = nearest.map_or(f64::INFINITY, |l| l.p.distance(p));
            let reach = |l: &super::lanes::LaneSample| {
                let offsets = from.footprint().map(|c| l.dir.perp_dot(c - l.p));
                let (low, high) = offsets
                    .iter()
                    .fold((f64::MAX, f64::MIN), |(a, b), v| (a.min(*v), b.max(*v)));
                low <= 0.9 && high >= -0.9 && l.dir.dot(p - l.p).abs() < 1.0 + from.size_m.x / 2.0
            };
            let held = match relation {
                R::On => in_role(map, *role, p),
                R::ParkedOn => standing && in_role(map, *role, p),
                R::Blocking => standing && nearest.is_some_and(reach),
                R::Crossing => {
                    let there = *role == LaneRole::Road || off < 4.0;
                    there && (map.has(ROAD, p) || map.has(BevLayer::PedCrossing.bit(), p)) && crosswise()
                }
                R::Across => in_role(map, *role, p) && crosswise(),
                R::Near => off < 7.0,
                R::NextTo => off < 4.8 && off > 1.75,
                R::WaitingAt => standing && off < 8.0,
                R::SameDirection | R::Following => nearest.is_some_and(|l| l.dir.dot(heading) > 0.88),
                R::OppositeDirection => nearest.is_some_and(|l| l.dir.dot(heading) < -0.88),
                R::LeftOf => nearest.is_some_and(|l| l.dir.perp_dot(p - l.p) > 1.8),
                R::RightOf => nearest.is_some_and(|l| l.dir.perp_dot(p - l.p) < -1.8),
                R::FarFrom => off > 20.0,
                _ => true,
            };
            (held, off)
        }
        RelationReference::Crossing => {
            let Some(outline) = map.crossing() else {
                return false;
            };
            let center = outline.iter().sum::<DVec2>() / outline.len() as f64;
            (
                area(map, relation, from, outline_m(outline, p), center),
                outline_m(outline, p).max(0.0),
            )
        }
        RelationReference::Junction => {
            let Some(center) = map.junction else {
                return false;
            };
            let off = center.distance(p) - 10.0;
            (area(map, relation, from, off, center), off.max(0.0))
        }
    };
    held && distance_m.is_none_or(|d| (distance - d).abs() <= (0.15 * d).max(1.5))
}

/// True if `relation` holds between a box and another. With `measured_m` a distance was stated, which then decides on
/// nearness.
fn to_thing(
    map: &LaneMap<'_>,
    relation: RelationKind,
    from: &SceneBox,
    b: &SceneBox,
    and: Option<&SceneBox>,
    measured_m: bool,
) -> bool {
    use RelationKind as R;
    let p = from.center_m.truncate();
    let standing = from.velocity_mps.length() < 0.5;
    let heading = from.heading();
    let crosswise = || map.nearest(p).is_some_and(|l| l.dir.dot(heading).abs() < 0.7);
    let (axis, d) = (course(b), p - b.center_m.truncate());
    let (fwd, lat) = (axis.dot(d), axis.perp_dot(d));
    let half = b.size_m.truncate() / 2.0;
    let is_ego = b.id == BoxId(u32::MAX);
    let toward = heading.dot((at(b) - p).normalize_or_zero());
    match relation {
        // (roads bend: a box far down the road is ahead of the ego vehicle)
        R::InFrontOf => {
            fwd > half.x && lat.abs() <= (if is_ego && fwd > 10.0 { 0.85 } else { 0.6 } * fwd).max(2.0)
        }
        R::Behind => -fwd > half.x && lat.abs() <= (-0.6 * fwd).max(2.0),
        // For the ego vehicle it means the whole side of the street.
        R::LeftOf => lat > half.y.max(0.8) + 0.1 && (is_ego || fwd.abs() <= (2.0 * lat).max(half.x + 4.0)),
        R::RightOf => -lat > half.y.max(0.8) + 0.1 && (is_ego || fwd.abs() <= (-2.0 * lat).max(half.x + 4.0)),
        R::Near if measured_m => true,
        R::Near => gap_m(from, b) <= 5.5,
        R::NextTo => gap_m(from, b) <= 3.2,
        R::FarFrom => gap_m(from, b) >= 20.5,
        R::Between => and.is_some_and(|c| {
            let (a, c) = (at(b), at(c));
            let (line, length) = ((c - a).normalize_or_zero(), c.distance(a));
            let t = (p - a).dot(line) / length.max(1e-9);
            (0.12..=0.88).contains(&t) && line.perp_dot(p - a).abs() <= (0.3 * length).max(1.8)
        }),
        R::Across => {
            p.distance(at(b)) > 4.0
                && map
                    .course(p)
                    .zip(map.course(at(b)))
                    .is_some_and(|(x, y)| (x.1 - y.1).abs() > 4.0 && (x.0 - y.0).abs() < 14.0)
        }
        R::Blocking => standing && fwd > half.x && lat.abs() < 1.0 + from.size_m.y / 2.0,
        R::Facing => toward > 0.75,
        R::FacingAway => toward < -0.75,
        R::Following => fwd < -half.x && lat.abs() < 2.0 && -fwd < 36.0 && heading.dot(b.heading()) > 0.88,
        R::SameDirection => heading.dot(b.heading()) > 0.88,
        R::OppositeDirection => heading.dot(b.heading()) < -0.88,
        R::Crossing => fwd > half.x && crosswise(),
        R::WaitingAt => standing && gap_m(from, b) < 7.0,
        R::On | R::ParkedOn => is_ego && in_role(map, LaneRole::Ego, p),
    }
}

fn area(map: &LaneMap<'_>, relation: RelationKind, from: &SceneBox, off: f64, center: DVec2) -> bool {
    use RelationKind as R;
    let p = from.center_m.truncate();
    let standing = from.velocity_mps.length() < 0.5;
    let ahead = map
        .course(center)
        .zip(map.course(p))
        .map_or(0.0, |(c, q)| q.0 - c.0);
    match relation {
        R::On => off <= -0.2,
        R::ParkedOn => off <= 0.0 && standing,
        R::Near => off <= 5.5,
        R::NextTo => off > 0.0 && off <= 3.0,
        R::FarFrom => off >= 20.5,
        R::InFrontOf => off > 0.2 && ahead < 0.0 && off <= 11.0,
        R::Behind => off > 0.2 && ahead > 0.0 && off <= 11.0,
        R::Crossing => off <= 0.8,
        R::WaitingAt => {
            let before = from.heading().dot(center - p) > 0.0;
            let on_road = map.has(ROAD, p);
            // A vehicle stops with its front before the stripes, and not far before.
            let (front_m, most_m) = if on_road {
                (from.size_m.x / 2.0, 3.5)
            } else {
                (0.0, 7.0)
            };
            standing && off > 0.2 + front_m && off - from.size_m.x / 2.0 <= most_m && (before || !on_road)
        }
        R::Blocking => standing && off <= 0.0,
        R::LeftOf => off > 0.0 && off < 11.0 && (p - center).y > 0.5,
        R::RightOf => off > 0.0 && off < 11.0 && (p - center).y < -0.5,
        R::Facing => from.heading().dot((center - p).normalize_or_zero()) > 0.75,
        R::FacingAway => from.heading().dot((center - p).normalize_or_zero()) < -0.75,
        _ => off <= 8.0,
    }
}
