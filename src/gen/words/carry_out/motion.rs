//! Motion in the course of time.

use std::collections::BTreeSet;

use super::super::reading::{AnchorPhrase, ObjectPhrase, PlacePhrase, Quantity, Relation};
use super::super::remark::Remark;
use super::super::resolve::{Spare, words_of};
use super::super::stage::Stage;
use scene::clip::{Manoeuvre, Template};
use scene::{BoxId, Clip, Edit};

/// Time up to which a manoeuvre may be seen without making the scene longer, s.
const USUAL_LENGTH_S: f64 = 8.0;
/// Place of a new road user if none is stated, m ahead of us.
const AHEAD_M: f64 = 15.0;
/// Time for which a manoeuvre is seen after it begins, s.
const SEEN_S: f64 = 5.0;

impl Stage<'_> {
    /// Makes boxes carry out a manoeuvre, or the ego vehicle if `who` is empty.
    pub(super) fn go(&mut self, who: &[ObjectPhrase], how: &Manoeuvre) {
        let least_s = how.from_s.map_or(0.0, |from_s| from_s + SEEN_S);
        if least_s > self.length_s.max(USUAL_LENGTH_S) {
            self.last_for(least_s);
        }
        if who.is_empty() {
            self.ego_moves = true;
            // (a follower keeps the gap to the one ahead)
            let keeps = how.what == Template::Follow;
            if how.gap_m.is_some() && !keeps {
                let why = "we are never a distance from ourselves: it begins soon".to_owned();
                self.remark(Remark::NoMotion { why });
            }
            let gap_m = how.gap_m.filter(|_| keeps);
            let how = Manoeuvre { gap_m, ..*how };
            self.out.edits.push(Edit::let_move(&how, None, None));
            self.done().scene = true;
            return;
        }
        let Some(ids) = self.movers(who) else {
            return;
        };
        // A vehicle that stands cannot be cut in on or approached.
        let comes_near = how.gap_m.is_some() && how.what != Template::Follow;
        let needs_us = how.what == Template::CutIn || comes_near;
        if needs_us && !self.ego_moves && !ids.is_empty() {
            self.ego_moves = true;
            self.out.edits.push(Edit::let_move(
                &Manoeuvre::from_template(Template::Follow),
                None,
                None,
            ));
            self.remark(Remark::EgoDrives);
        }
        for id in ids {
            let class = self.boxes.get(&id).map(|b| b.class);
            let (how, all) = self
                .does
                .get(&id)
                .map_or((*how, true), |before| how.after(before));
            if !all {
                let what = who.iter().map(words_of).collect::<Vec<_>>().join(" and ");
                self.remark(Remark::OneMotion { what });
            }
            self.does.insert(id, how);
            self.out.edits.push(Edit::let_move(&how, Some(id), class));
            self.done().changed.push(id);
        }
    }

    /// The boxes that are to move. If one of a kind is named and none is there, it is added first: ahead of us, if no
    /// place is stated.
    fn movers(&mut self, who: &[ObjectPhrase]) -> Option<Vec<BoxId>> {
        let [thing] = who else {
            return self.those(who, Spare::Nearest);
        };
        let named = |stage: &Self, id: &BoxId| {
            thing.noun.is_plain() || stage.boxes[id].label.name == thing.noun.label()
        };
        let is_there = self.fitting(thing).iter().any(|id| named(self, id));
        if thing.quantity != Quantity::N(1) || is_there {
            return self.those(who, Spare::Nearest);
        }
        let mut new = thing.clone();
        if new.places.is_empty() {
            new.places.push(PlacePhrase {
                relation: Relation::Ahead,
                to: Some(AnchorPhrase::Ego),
                and: None,
                metres: Some(AHEAD_M),
            });
        }
        let before: BTreeSet<BoxId> = self.boxes.keys().copied().collect();
        self.add(&[new]);
        let ids: Vec<BoxId> = self
            .boxes
            .keys()
            .copied()
            .filter(|id| !before.contains(id))
            .collect();
        if ids.is_empty() {
            return None;
        }
        self.remark(Remark::IsNew {
            what: words_of(thing),
        });
        Some(ids)
    }

    /// Sets the length of the scene.
    pub(super) fn last_for(&mut self, seconds: f64) {
        self.done().scene = true;
        self.length_s = seconds.clamp(0.0, Clip::MAX_LENGTH_S);
        self.out.edits.push(Edit::SetLength {
            length_s: self.length_s,
            rate_hz: None,
        });
    }
}
