//! A canonical order for acts that can be said in any order: readings that ask for the same are equal. Twin of
//! `training/words/canonical.py`.

use super::mode::Mode;
use super::reading::{Act, Anchor, Destination, Place, Reading, Relation, Thing, Turn, What};
use scene::graph::{LaneRole, ObjectState};

/// The acts in that order, without spans and confidences, and without acts on scenery.
pub fn canonical(reading: &Reading, mode: Mode) -> Reading {
    let mut out: Vec<What> = Vec::new();
    for act in &reading.acts {
        let mut what = act.what.clone();
        sort_what(&mut what);
        match (out.last_mut(), what) {
            (Some(What::Add { things }), What::Add { things: more }) => things.extend(more),
            (Some(What::Remove { who }), What::Remove { who: more })
            | (Some(What::Keep { who }), What::Keep { who: more })
            | (Some(What::No { who }), What::No { who: more }) => who.extend(more),
            (_, what) => out.push(what),
        }
    }
    out.sort_by_key(|what| rank(what, mode));
    // (acts that were apart may now be adjacent)
    let mut acts: Vec<Act> = Vec::new();
    for what in out {
        match (acts.last_mut().map(|a| &mut a.what), what) {
            (Some(What::Add { things }), What::Add { things: more }) if mode == Mode::Prompt => {
                things.extend(more)
            }
            (_, what) => acts.push(what.into()),
        }
    }
    Reading::of(acts)
}

fn rank(what: &What, mode: Mode) -> u8 {
    match (what, mode) {
        (What::Leave { .. }, _) => 30,
        (What::No { .. }, Mode::Prompt) => 29,
        (What::Go { .. }, Mode::Prompt) => 20,
        (What::Time { .. } | What::Weather { .. }, Mode::Edit) => 0,
        (_, Mode::Edit) => 1,
        (What::Road { .. }, _) => 0,
        (What::Lanes { .. }, _) => 1,
        (What::OneWay, _) => 2,
        (What::Narrow, _) => 3,
        (What::Wide, _) => 4,
        (What::OwnLane { .. }, _) => 5,
        (What::Time { .. }, _) => 6,
        (What::Weather { .. }, _) => 7,
        (What::Env { .. }, _) => 8,
        (What::Density { .. }, _) => 9,
        (What::Has { .. }, _) => 10,
        (What::Lacks { .. }, _) => 11,
        (What::Length { .. }, _) => 12,
        _ => 13,
    }
}

fn sort_what(what: &mut What) {
    match what {
        What::Add { things: a } | What::No { who: a } | What::Remove { who: a } | What::Keep { who: a } => {
            sort_all(a)
        }
        What::Leave { who: a }
        | What::Set { who: a, .. }
        | What::Count { who: a, .. }
        | What::Go { who: a, .. } => sort_all(a),
        What::Replace { who, things } => {
            sort_all(who);
            sort_all(things);
        }
        What::Move { who, to } => {
            sort_all(who);
            if let Destination::To(places) = to {
                sort_places(places);
            }
        }
        What::Turn { who, turn } => {
            sort_all(who);
            if let Turn::To(places) = turn {
                sort_places(places);
            }
        }
        What::Swap { one, other } => {
            sort_places(&mut one.places);
            sort_places(&mut other.places);
        }
        What::Has { places, .. } => sort_places(places),
        _ => {}
    }
}

fn sort_all(things: &mut [Thing]) {
    for t in things {
        // (objects parked on the right stand at the right kerb)
        if t.state == Some(ObjectState::Parked) {
            t.places.iter_mut().for_each(at_the_kerb);
        }
        sort_places(&mut t.places);
        sort_all(&mut t.except);
    }
}

fn at_the_kerb(p: &mut Place) {
    let role = match p.relation {
        Relation::Left => LaneRole::LeftRoadside,
        Relation::Right => LaneRole::RightRoadside,
        _ => return,
    };
    if p.to == Some(Anchor::Ego) && p.metres.is_none() {
        (p.relation, p.to) = (Relation::On, Some(Anchor::Lane(role)));
    }
}

fn sort_places(places: &mut [Place]) {
    for p in places.iter_mut() {
        for anchor in [p.to.as_mut(), p.and.as_mut()].into_iter().flatten() {
            if let Anchor::Thing(t) = anchor {
                sort_places(&mut t.places);
            }
        }
    }
    places.sort_by_key(|p| p.relation);
}
