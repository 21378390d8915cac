//! Costs of putting an object at a place, in the unit of the placer: distance of the place from the stated one.

use glam::{DVec2, DVec3};

use super::holds::{RelationReference, course, gap_m, measured};
use super::spots::Spot;
use scene::graph::{GraphEdge, RelationKind};
use scene::{BoxId, BoxLabel, Class, SceneBox};

/// A spot for an object that is only told a direction to face: it stays at its place. `None` for others, and for
/// drivers, which keep to their lane.
pub(super) fn turned_where_it_is(
    old: &SceneBox,
    stated: &[(GraphEdge, Option<RelationReference>)],
) -> Option<Spot> {
    use RelationKind as R;
    let drives = old.class != Class::Pedestrian && old.velocity_mps.length() > 0.5;
    let p = old.center_m.truncate();
    let mut looks = None;
    for (e, to) in stated {
        match (e.relation, to) {
            (R::On | R::ParkedOn, Some(RelationReference::Lane(_))) => {}
            (R::Facing | R::FacingAway, Some(to)) => {
                let away = if e.relation == R::FacingAway { -1.0 } else { 1.0 };
                looks = Some(match to {
                    RelationReference::Thing(b) if b.id.0 == u32::MAX => -p * away,
                    RelationReference::Thing(b) => (b.center_m.truncate() - p) * away,
                    _ => return None,
                });
            }
            _ => return None,
        }
    }
    let moves = old.velocity_mps.length() > 0.5;
    looks.filter(|_| !drives).map(|way| Spot {
        p,
        yaw_rad: way.to_angle(),
        cost: -10.0,
        still: !moves,
        moves,
        on_road: true,
        anywhere: old.class == Class::Pedestrian,
    })
}

/// Cost of bringing a box to a place: the distance, and the turn.
pub(super) fn moved_far(old: &SceneBox, s: &Spot) -> f64 {
    let turned = 1.0 - old.heading().dot(DVec2::from_angle(s.yaw_rad));
    let walks = old.class == Class::Pedestrian;
    0.25 * old.center_m.truncate().distance(s.p) + if walks { 0.2 } else { 1.5 } * turned
}

/// Distance from the line, m, with surcharges for the distance from its middle and for places beyond its middle half.
pub(super) fn off_line(ends: [DVec2; 2], p: DVec2) -> f64 {
    let line = ends[1] - ends[0];
    let (dir, length) = (line.normalize_or_zero(), line.length());
    let along = dir.dot(p - ends[0]) - length / 2.0;
    // (readers expect the middle)
    dir.perp_dot(p - ends[0]).abs() + 0.4 * along.abs() + 0.5 * (along.abs() - length / 4.0).max(0.0)
}

/// Cost of a place far before or behind the named thing.
pub(super) fn off_thing(e: &GraphEdge, to: &Option<RelationReference>, p: DVec2) -> f64 {
    match (e.relation, to) {
        (RelationKind::InFrontOf | RelationKind::Behind, Some(RelationReference::Thing(b)))
            if b.id.0 != u32::MAX && e.distance_m.is_none() =>
        {
            let gap = p.distance(b.center_m.truncate()) - b.size_m.x / 2.0;
            0.15 * (gap - 6.0).clamp(0.0, 30.0)
        }
        _ => 0.0,
    }
}

/// Distance beyond "near", at most 30 m, for a statement that something is near.
pub(super) fn off_near(e: &GraphEdge, to: &Option<RelationReference>, b: &SceneBox) -> Option<f64> {
    match (e.relation, to) {
        (RelationKind::Near, Some(RelationReference::Thing(to))) if e.distance_m.is_none() => {
            Some((gap_m(b, to) - 3.0).clamp(0.0, 30.0))
        }
        _ => None,
    }
}

/// Deviation of a place from stated distances, m, and from being level with the thing that it is beside.
pub(super) fn off_measure(stated: &[(GraphEdge, Option<RelationReference>)], s: &Spot, size_m: DVec3) -> f64 {
    let b = SceneBox {
        id: BoxId(0),
        class: Class::Car,
        center_m: s.p.extend(0.0),
        size_m,
        yaw_rad: s.yaw_rad,
        velocity_mps: DVec2::ZERO,
        label: BoxLabel::default(),
    };
    let of = |(e, t): &(GraphEdge, Option<RelationReference>)| {
        let Some(RelationReference::Thing(to)) = t else {
            return 0.0;
        };
        let missed = e
            .distance_m
            .map_or(0.0, |d| (measured(e.relation, &b, to) - d).abs());
        // "beside" means level with it
        let level = if e.relation == RelationKind::NextTo && to.class != Class::Pedestrian {
            0.6 * course(to).dot(s.p - to.center_m.truncate()).abs()
        } else {
            0.0
        };
        missed.min(20.0) + level.min(12.0)
    };
    stated.iter().map(of).sum()
}
