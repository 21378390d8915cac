//! The things of a scene that words mean.

use glam::DVec2;

use super::place::FreeGround;
use super::{NearTo, SceneryClause, SceneryKind, SideOf, Where};
use scene::background::{LineKind, PostKind};
use scene::road_map::{RoadMap, outline_distance_m};
use scene::{Background, Form, Thing, ThingId};

/// Distances that count as "near" a crossing, a junction, and the ego vehicle, m.
const NEAR_M: [f64; 3] = [12.0, 20.0, 15.0];
/// Largest distance of a thing "12 m ahead" from that place, m.
const OFF_M: f64 = 6.0;
/// Most candidates that a question names.
const MOST: usize = 8;
/// Largest distance of the trees of a row from each other and from the paved ground, m.
const ROW_GAP_M: f64 = 14.0;
const ROW_FROM_PAVED_M: f64 = 2.6;

/// Result of looking up the things of a clause in a scene.
pub(super) enum Meant {
    /// These things; none if nothing fits.
    These(Vec<ThingId>),
    /// One thing is meant and several fit: each with its place in words and the clause that means it alone.
    Ask(Vec<(ThingId, String, SceneryClause)>),
}

/// True if any of the points is near the place that was stated.
pub(super) fn is_near(roads: &RoadMap, place: &Where, points_m: &[DVec2]) -> bool {
    let Some(near) = place.near else { return true };
    let reach = place.distance_m.unwrap_or(
        NEAR_M[match near {
            NearTo::Crossing => 0,
            NearTo::Junction => 1,
            NearTo::Ego => 2,
        }],
    );
    points_m.iter().any(|p| match near {
        NearTo::Crossing => roads.crossings.iter().any(|c| {
            scene::road_map::inside(&c.outline_m, *p) || outline_distance_m(&c.outline_m, *p) <= reach
        }),
        NearTo::Junction => roads.junctions_m.iter().any(|j| j.distance(*p) <= reach),
        NearTo::Ego => p.length() <= reach,
    })
}

/// True if the word names the form.
pub(super) fn is(what: SceneryKind, form: &Form) -> bool {
    match (what, form) {
        (SceneryKind::Thing, _)
        | (SceneryKind::Building(_), Form::Building(_))
        | (SceneryKind::Shrubs, Form::Shrubs(_)) => true,
        (SceneryKind::Tree(kind), Form::Tree(t)) => kind.is_none_or(|k| t.kind == k),
        (SceneryKind::Line(LineKind::Wall), Form::Line(l)) => {
            matches!(l.kind, LineKind::Wall | LineKind::RetainingWall)
        }
        (SceneryKind::Line(kind), Form::Line(l)) => l.kind == kind,
        (SceneryKind::Post(PostKind::Pole), Form::Post(p)) => {
            matches!(
                p.kind,
                PostKind::Pole | PostKind::StreetLight | PostKind::Sign | PostKind::TrafficLight
            )
        }
        (SceneryKind::Post(kind), Form::Post(p)) => p.kind == kind,
        (SceneryKind::Plants | SceneryKind::Place(world::scenery::RoadsideKind::Forest), form) => {
            match form {
                Form::Tree(_) | Form::Shrubs(_) => true,
                Form::Line(l) => l.kind == LineKind::Hedge,
                _ => false,
            }
        }
        _ => false,
    }
}

/// The things in the grid that a clause means; `things` are in the ego frame.
pub(super) fn targets(said: &SceneryClause, things: &Background, ground: &FreeGround) -> Meant {
    if let Some(id) = said.id {
        let found = things.get(ThingId(id)).filter(|t| is(said.what, &t.form));
        return Meant::These(found.map(|t| t.id).into_iter().collect());
    }
    let mut fits: Vec<&Thing> = things
        .iter()
        .filter(|t| is(said.what, &t.form) && is_there(said, t, ground))
        .collect();
    fits.sort_by(|a, b| a.form.middle_m().length().total_cmp(&b.form.middle_m().length()));
    if said.row {
        return row(&fits, said, ground);
    }
    if let (Some(along), None) = (said.place.distance_m, said.place.near) {
        let along = if said.place.ahead == Some(false) {
            -along
        } else {
            along
        };
        let off = |t: &Thing| (ground.roads.along_ego_lane(t.form.middle_m()).x - along).abs();
        fits.retain(|t| off(t) <= OFF_M);
        fits.sort_by(|a, b| off(a).total_cmp(&off(b)));
        fits.truncate(if said.plural { usize::MAX } else { 1 });
    }
    let ids = |list: &[&Thing]| Meant::These(list.iter().map(|t| t.id).collect());
    let n = said.count.unwrap_or(1) as usize;
    match said.nearest {
        Some(true) => return ids(&fits[..n.min(fits.len())]),
        Some(false) => return ids(&fits[fits.len() - n.min(fits.len())..]),
        None => {}
    }
    match () {
        () if said.plural && said.count.is_none() => ids(&fits),
        // "remove two trees": which two does not matter; "a taller building": the nearest.
        () if !said.definite => ids(&fits[..n.min(fits.len())]),
        () if fits.len() <= n => ids(&fits),
        () => Meant::Ask(
            fits.iter()
                .take(MOST)
                .map(|t| candidate(said, t, ground))
                .collect(),
        ),
    }
}

fn candidate(said: &SceneryClause, thing: &Thing, ground: &FreeGround) -> (ThingId, String, SceneryClause) {
    let own = ground.roads.along_ego_lane(thing.form.middle_m());
    let along = if own.x >= 0.0 { "ahead" } else { "behind" };
    let side = if own.y >= 0.0 { "left" } else { "right" };
    let place = format!(
        "{:.0} m {along}, {:.0} m {side}, {:.1} m high",
        own.x.abs(),
        own.y.abs(),
        thing.form.height_m()
    );
    let alone = SceneryClause {
        id: Some(thing.id.0),
        count: None,
        place: Where::default(),
        ..said.clone()
    };
    (thing.id, place, alone)
}

fn is_there(said: &SceneryClause, thing: &Thing, ground: &FreeGround) -> bool {
    let (place, points) = (&said.place, thing.form.points_m());
    let middle = thing.form.middle_m();
    let own = ground.roads.along_ego_lane(middle);
    let side = match place.side {
        Some(SideOf::Left) => own.y > 0.0,
        Some(SideOf::Right) => own.y < 0.0,
        None => true,
    };
    let ahead = place.ahead.is_none_or(|ahead| (own.x > 0.0) == ahead);
    side && ahead && is_near(&ground.roads, place, &points)
}

/// The row that is meant: trees one after another along the road.
fn row(fits: &[&Thing], said: &SceneryClause, ground: &FreeGround) -> Meant {
    let mut list: Vec<(&Thing, DVec2)> = fits
        .iter()
        .filter(|t| ground.paved_m(t.form.middle_m()) <= ROW_FROM_PAVED_M)
        .map(|t| (*t, ground.roads.along_ego_lane(t.form.middle_m())))
        .collect();
    list.sort_by(|a, b| a.1.x.total_cmp(&b.1.x));
    let mut rows: Vec<Vec<(&Thing, DVec2)>> = Vec::new();
    for (t, own) in list {
        let belongs = |row: &&mut Vec<(&Thing, DVec2)>| {
            row.last().is_some_and(|(last, at)| {
                let apart = last.form.middle_m().distance(t.form.middle_m());
                (at.y > 0.0) == (own.y > 0.0) && apart <= ROW_GAP_M && (at.y - own.y).abs() < 4.0
            })
        };
        match rows.iter_mut().find(belongs) {
            Some(row) => row.push((t, own)),
            None => rows.push(vec![(t, own)]),
        }
    }
    rows.retain(|r| r.len() >= 3);
    let of = |left: bool| rows.iter().filter(move |r| (r[0].1.y > 0.0) == left).flatten();
    match (of(true).next(), of(false).next()) {
        (Some(a), Some(b)) if !said.plural => Meant::Ask(
            [(a, SideOf::Left, "left"), (b, SideOf::Right, "right")]
                .map(|((t, _), side, name)| {
                    let mut alone = said.clone();
                    alone.place.side = Some(side);
                    (t.id, format!("the row on the {name}"), alone)
                })
                .to_vec(),
        ),
        _ => Meant::These(rows.iter().flatten().map(|(t, _)| t.id).collect()),
    }
}
