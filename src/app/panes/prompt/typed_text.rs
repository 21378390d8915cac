//! A prompt read both ways: as a change of the open scene and as a new scene. Chips change the reading itself, not the
//! words.

use crate::text::{self, Edited, Prompted};
use scene::{BoxId, Scene, SceneRev};
use words::hear::{By, CheckedReading};
use words::notation;
use words::reading::{ActKind, ObjectPhrase, Quantity, Reading};

/// The two readings of a text.
pub struct Both {
    /// The text.
    pub text: String,
    /// The reading as a new scene; an error in one line.
    pub prompted: Result<Prompted, String>,
    /// The reading as a change, with its effect on the scene of revision `rev`.
    pub edited: Result<Edited, String>,
    rev: SceneRev,
    seed: u64,
}

impl Both {
    /// Reads a text both ways.
    pub fn from_text(text: &str, scene: &Scene, seed: u64) -> Self {
        let line = |e: anyhow::Error| format!("{e:#}");
        Self {
            prompted: text::read(text).map_err(line),
            edited: text::read_edit(text, scene, seed).map_err(line),
            text: text.to_owned(),
            rev: scene.rev,
            seed,
        }
    }

    /// Applies the change again if the scene or the seed is another one; returns true if it did.
    pub fn follow(&mut self, scene: &Scene, seed: u64) -> bool {
        if (scene.rev, seed) == (self.rev, self.seed) {
            return false;
        }
        (self.rev, self.seed) = (scene.rev, seed);
        let again = text::read_edit(&self.text, scene, seed);
        self.edited = match (again, &self.edited) {
            // (a reading that was changed by hand stays, unless it names boxes: those may be of another scene)
            (Ok(_), Ok(old)) if old.heard.by == By::Hand && !names_boxes(&old.heard.reading) => {
                Ok(text::edited(old.heard.clone(), scene, seed))
            }
            (again, _) => again.map_err(|e| format!("{e:#}")),
        };
        true
    }

    /// True if the words describe a whole scene rather than a change: things with a road, or with light, weather or
    /// density.
    pub fn is_described(&self) -> bool {
        let Ok(p) = &self.prompted else { return false };
        let acts = || p.heard.reading.acts.iter().map(|a| &a.what);
        let road = acts().any(|w| matches!(w, ActKind::Road { .. }));
        let light = acts().any(|w| {
            matches!(
                w,
                ActKind::Time { .. } | ActKind::Weather { .. } | ActKind::Density { .. }
            )
        });
        let things = acts().any(|w| matches!(w, ActKind::Add { .. }));
        let changes = self.edited.as_ref().is_ok_and(|e| {
            let acts = e.heard.reading.acts.iter().map(|a| &a.what);
            acts.into_iter().any(|w| {
                !matches!(
                    w,
                    ActKind::Add { .. }
                        | ActKind::Time { .. }
                        | ActKind::Weather { .. }
                        | ActKind::Has { .. }
                        | ActKind::No { .. }
                        | ActKind::Road { .. }
                        | ActKind::Density { .. }
                        | ActKind::Env { .. }
                        | ActKind::Lanes { .. }
                        | ActKind::OneWay
                        | ActKind::Narrow
                        | ActKind::Wide
                        | ActKind::OwnLane { .. }
                )
            })
        });
        things && (road || light) && !changes
    }

    /// Takes the other reader's reading of the new scene.
    pub fn take_other_prompt(&mut self) {
        if let Ok(p) = &self.prompted
            && let Some(other) = p.heard.other.clone()
        {
            self.set_prompt(|r| *r = other);
        }
    }

    /// Takes the other reader's reading of the change.
    pub fn take_other_edit(&mut self, scene: &Scene) {
        if let Ok(e) = &self.edited
            && let Some(other) = e.heard.other.clone()
        {
            self.set_edit(scene, |r| *r = other);
        }
    }

    /// Changes the reading of the new scene by hand.
    pub fn set_prompt(&mut self, change: impl FnOnce(&mut Reading)) {
        if let Ok(p) = &self.prompted {
            let heard = by_hand(&p.heard, change);
            self.prompted = Ok(Prompted::new(heard));
        }
    }

    /// Changes the reading of the change by hand.
    pub fn set_edit(&mut self, scene: &Scene, change: impl FnOnce(&mut Reading)) {
        if let Ok(e) = &self.edited {
            let heard = by_hand(&e.heard, change);
            self.edited = Ok(text::edited(heard, scene, self.seed));
        }
    }
}

fn by_hand(heard: &CheckedReading, change: impl FnOnce(&mut Reading)) -> CheckedReading {
    let mut heard = heard.clone();
    change(&mut heard.reading);
    heard.by = By::Hand;
    heard.other = None;
    heard.unsure.clear();
    heard
}

/// Removes an act of the reading, or one thing of an act.
pub fn take_out(reading: &mut Reading, act: usize, thing: Option<usize>) {
    let Some(a) = reading.acts.get_mut(act) else {
        return;
    };
    if let (Some(k), ActKind::Add { things } | ActKind::No { who: things }) = (thing, &mut a.what)
        && things.len() > 1
    {
        if k < things.len() {
            things.remove(k);
        }
        return;
    }
    reading.acts.remove(act);
}

/// Sets the number of a thing that is added; 0 removes it.
pub fn set_number(reading: &mut Reading, act: usize, thing: usize, n: u32) {
    if n == 0 {
        take_out(reading, act, Some(thing));
        return;
    }
    if let Some(ActKind::Add { things }) = reading.acts.get_mut(act).map(|a| &mut a.what)
        && let Some(t) = things.get_mut(thing)
    {
        t.quantity = Quantity::N(n);
    }
}

/// Answers which box is meant if several match. `asked` is the thing in notation. If several boxes are meant, this one
/// is named and the others are still asked for.
pub fn answer(reading: &mut Reading, act: usize, asked: &str, id: BoxId) {
    let Some(a) = reading.acts.get_mut(act) else {
        return;
    };
    if let ActKind::Remove { who }
    | ActKind::Keep { who }
    | ActKind::Leave { who }
    | ActKind::Set { who, .. }
    | ActKind::Go { who, .. }
    | ActKind::Move { who, .. }
    | ActKind::Turn { who, .. }
    | ActKind::Replace { who, .. } = &mut a.what
        && let Some(k) = who.iter().position(|t| notation::thing(t) == asked)
        && let Quantity::TheN(n) = who[k].quantity
        && n > 1
    {
        let mut rest = who[k].clone();
        rest.quantity = if n == 2 {
            Quantity::The
        } else {
            Quantity::TheN(n - 1)
        };
        named(&mut who[k], id);
        rest.except.push(who[k].clone());
        who.insert(k + 1, rest);
        return;
    }
    let mut done = false;
    each_thing(&mut a.what, &mut |t| {
        if !done && notation::thing(t) == asked {
            named(t, id);
            done = true;
        }
    });
}

/// Makes a thing stand for this box only.
fn named(t: &mut ObjectPhrase, id: BoxId) {
    t.id = Some(id.0);
    (t.quantity, t.pick, t.nth, t.other) = (Quantity::The, None, None, false);
    t.places.clear();
    t.except.clear();
}

/// True if a reading names boxes or things by their numbers.
fn names_boxes(reading: &Reading) -> bool {
    let mut found = reading.background.iter().any(|s| s.id.is_some());
    for act in &mut reading.clone().acts {
        each_thing(&mut act.what, &mut |t| found |= t.id.is_some());
    }
    found
}

/// Calls `f` with every thing of an act, anchors included.
fn each_thing(what: &mut ActKind, f: &mut dyn FnMut(&mut ObjectPhrase)) {
    use words::reading::{AnchorPhrase, Destination, PlacePhrase, Turn};
    fn places(list: &mut [PlacePhrase], f: &mut dyn FnMut(&mut ObjectPhrase)) {
        for p in list {
            for anchor in [p.to.as_mut(), p.and.as_mut()].into_iter().flatten() {
                if let AnchorPhrase::Thing(t) = anchor {
                    one(t, f);
                }
            }
        }
    }
    fn one(t: &mut ObjectPhrase, f: &mut dyn FnMut(&mut ObjectPhrase)) {
        f(t);
        places(&mut t.places, f);
        t.except.iter_mut().for_each(|e| one(e, f));
    }
    match what {
        ActKind::Add { things: a }
        | ActKind::No { who: a }
        | ActKind::Remove { who: a }
        | ActKind::Keep { who: a }
        | ActKind::Leave { who: a }
        | ActKind::Go { who: a, .. }
        | ActKind::Count { who: a, .. } => a.iter_mut().for_each(|t| one(t, f)),
        ActKind::Replace { who, things } => who.iter_mut().chain(things).for_each(|t| one(t, f)),
        ActKind::Move { who, to } => {
            who.iter_mut().for_each(|t| one(t, f));
            if let Destination::To(list) = to {
                places(list, f);
            }
        }
        ActKind::Turn { who, turn } => {
            who.iter_mut().for_each(|t| one(t, f));
            if let Turn::To(list) = turn {
                places(list, f);
            }
        }
        ActKind::Set { who, traits } => {
            who.iter_mut().for_each(|t| one(t, f));
            if let Some(t) = &mut traits.paint_of {
                one(t, f);
            }
        }
        ActKind::Swap { one: a, other: b } => {
            one(a, f);
            one(b, f);
        }
        ActKind::Has { places: list, .. } => places(list, f),
        ActKind::Time { .. }
        | ActKind::Weather { .. }
        | ActKind::Road { .. }
        | ActKind::Env { .. }
        | ActKind::Density { .. }
        | ActKind::Lacks { .. }
        | ActKind::Lanes { .. }
        | ActKind::Length { .. }
        | ActKind::OneWay
        | ActKind::Narrow
        | ActKind::Wide
        | ActKind::OwnLane { .. } => {}
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use words::notation::{parse, write};

    #[test]
    fn chips_and_answers_change_the_reading() {
        let mut r = parse("add 2 car and 1 bus ( behind the truck ) ; time night").expect("valid");
        set_number(&mut r, 0, 0, 5);
        answer(&mut r, 0, "the truck", BoxId(7));
        assert_eq!(
            write(&r),
            "add 5 car and 1 bus ( behind the truck #7 ) ; time night"
        );
        take_out(&mut r, 0, Some(0));
        take_out(&mut r, 1, None);
        assert_eq!(write(&r), "add 1 bus ( behind the truck #7 )");
        set_number(&mut r, 0, 0, 0);
        assert!(r.acts.is_empty());
        take_out(&mut r, 3, Some(1));
        let mut r = parse("go the car ( behind ego ) cut_in from 3s").expect("valid");
        answer(&mut r, 0, "the car ( behind ego )", BoxId(5));
        assert_eq!(write(&r), "go the car #5 cut_in from 3s");
        let mut r = parse("remove the 2 car").expect("valid");
        answer(&mut r, 0, "the 2 car", BoxId(3));
        assert_eq!(write(&r), "remove the car #3 and the car ( except the car #3 )");
    }
}
