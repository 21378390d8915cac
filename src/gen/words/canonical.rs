//! A canonical order for acts that can be said in any order: readings that ask for the same are equal. Twin of
//! `training/words/canonical.py`.

use super::mode::Mode;
use super::reading::{
    Act, ActKind, AnchorPhrase, Destination, ObjectPhrase, PlacePhrase, Reading, Relation, Turn,
};
use scene::graph::{LaneRole, ObjectState};

/// The acts in that order, without spans and confidences, and without acts on scenery.
pub fn canonical(reading: &Reading, mode: Mode) -> Reading {
    let mut out: Vec<ActKind> = Vec::new();
    for act in &reading.acts {
        let mut what = act.what.clone();
        sort_what(&mut what);
        match (out.last_mut(), what) {
            (Some(ActKind::Add { things }), ActKind::Add { things: more }) => things.extend(more),
            (Some(ActKind::Remove { who }), ActKind::Remove { who: more })
            | (Some(ActKind::Keep { who }), ActKind::Keep { who: more })
            | (Some(ActKind::No { who }), ActKind::No { who: more }) => who.extend(more),
            (_, what) => out.push(what),
        }
    }
    out.sort_by_key(|what| rank(what, mode));
    // (acts that were apart may now be adjacent)
    let mut acts: Vec<Act> = Vec::new();
    for what in out {
        match (acts.last_mut().map(|a| &mut a.what), what) {
            (Some(ActKind::Add { things }), ActKind::Add { things: more }) if mode == Mode::Prompt => {
                things.extend(more)
            }
            (_, what) => acts.push(what.into()),
        }
    }
    Reading::of(acts)
}

fn rank(what: &ActKind, mode: Mode) -> u8 {
    match (what, mode) {
        (ActKind::Leave { .. }, _) => 30,
        (ActKind::No { .. }, Mode::Prompt) => 29,
        (ActKind::Go { .. }, Mode::Prompt) => 20,
        (ActKind::Time { .. } | ActKind::Weather { .. }, Mode::Edit) => 0,
        (_, Mode::Edit) => 1,
        (ActKind::Road { .. }, _) => 0,
        (ActKind::Lanes { .. }, _) => 1,
        (ActKind::OneWay, _) => 2,
        (ActKind::Narrow, _) => 3,
        (ActKind::Wide, _) => 4,
        (ActKind::OwnLane { .. }, _) => 5,
        (ActKind::Time { .. }, _) => 6,
        (ActKind::Weather { .. }, _) => 7,
        (ActKind::Env { .. }, _) => 8,
        (ActKind::Density { .. }, _) => 9,
        (ActKind::Has { .. }, _) => 10,
        (ActKind::Lacks { .. }, _) => 11,
        (ActKind::Length { .. }, _) => 12,
        _ => 13,
    }
}

fn sort_what(what: &mut ActKind) {
    match what {
        ActKind::Add { things: a }
        | ActKind::No { who: a }
        | ActKind::Remove { who: a }
        | ActKind::Keep { who: a } => sort_all(a),
        ActKind::Leave { who: a }
        | ActKind::Set { who: a, .. }
        | ActKind::Count { who: a, .. }
        | ActKind::Go { who: a, .. } => sort_all(a),
        ActKind::Replace { who, things } => {
            sort_all(who);
            sort_all(things);
        }
        ActKind::Move { who, to } => {
            sort_all(who);
            if let Destination::To(places) = to {
                sort_places(places);
            }
        }
        ActKind::Turn { who, turn } => {
            sort_all(who);
            if let Turn::To(places) = turn {
                sort_places(places);
            }
        }
        ActKind::Swap { one, other } => {
            sort_places(&mut one.places);
            sort_places(&mut other.places);
        }
        ActKind::Has { places, .. } => sort_places(places),
        _ => {}
    }
}

fn sort_all(things: &mut [ObjectPhrase]) {
    for t in things {
        // (objects parked on the right stand at the right kerb)
        if t.state == Some(ObjectState::Parked) {
            t.places.iter_mut().for_each(at_the_kerb);
        }
        sort_places(&mut t.places);
        sort_all(&mut t.except);
    }
}

fn at_the_kerb(p: &mut PlacePhrase) {
    let role = match p.relation {
        Relation::Left => LaneRole::LeftRoadside,
        Relation::Right => LaneRole::RightRoadside,
        _ => return,
    };
    if p.to == Some(AnchorPhrase::Ego) && p.metres.is_none() {
        (p.relation, p.to) = (Relation::On, Some(AnchorPhrase::Lane(role)));
    }
}

fn sort_places(places: &mut [PlacePhrase]) {
    for p in places.iter_mut() {
        for anchor in [p.to.as_mut(), p.and.as_mut()].into_iter().flatten() {
            if let AnchorPhrase::Thing(t) = anchor {
                sort_places(&mut t.places);
            }
        }
    }
    places.sort_by_key(|p| p.relation);
}
