//! Participles, verbs of state and colours.

use super::super::mention::Prep;
use super::super::tag::Item;
use super::super::tokens::Span;
use super::Parser;
use crate::scene::Class;
use crate::scene::graph::{ObjectState, RelationKind};

impl Parser<'_> {
    pub(super) fn state(&mut self, state: ObjectState, finite: bool, prenominal: bool, item: &Item) {
        let span = item.span;
        // "nobody is walking": of nobody
        let nobody = (1..=2).any(|k| {
            matches!(
                self.at.checked_sub(k).and_then(|i| self.sense(i)),
                Some(super::super::lexicon::Sense::Nobody)
            )
        });
        if self.denied && nobody && !self.edits {
            return;
        }
        // "a bus with a cyclist beside it is waiting": the bus
        let singular = ["is ", "was ", "has "].iter().any(|w| item.words.starts_with(w));
        if finite && singular && !self.relative && self.pending.is_none() && !self.edits {
            self.back_to_host();
        }
        self.denied &= !(finite || self.after_is());
        let meant = self
            .item(self.at.wrapping_sub(1))
            .is_some_and(|b| matches!(b.words.as_str(), "to" | "wants to" | "want to"));
        if meant && self.ego_subject && self.head.is_empty() {
            return; // "we want to overtake a cyclist"
        }
        if (item.words.starts_with("overtak") || item.words == "passing" || item.words == "passes")
            && (!self.head.is_empty() || self.ego_subject)
            && self.pending.is_none()
            && self.anchor_ahead(self.at + 1)
        {
            // Past another, on its left.
            let targets = if finite {
                self.subjects(true)
            } else {
                self.targets()
            };
            let of_ego = matches!(self.sense(self.at + 1), Some(super::super::lexicon::Sense::Ego));
            for t in targets.iter().copied() {
                self.mentions[t].spec.state = Some(state);
                if of_ego {
                    // past us in the oncoming lane it goes our way
                    self.mentions[t]
                        .spec
                        .relations
                        .push(super::super::description::Stated {
                            relation: RelationKind::SameDirection,
                            anchor: super::super::description::Anchor::Ego,
                            and: None,
                            distance_m: None,
                            span,
                        });
                }
            }
            self.last = targets;
            self.begin(Prep::Rels(vec![RelationKind::LeftOf]), span);
            return;
        }
        let possessed = self
            .item(self.at.wrapping_sub(1))
            .is_some_and(|b| matches!(b.words.as_str(), "its" | "their" | "his" | "her" | "my" | "our"));
        if possessed && finite {
            return; // "waits for its turn"
        }
        if prenominal && !finite {
            self.pre.state = Some(state);
            self.pre.cover(span);
            return;
        }
        let state = if std::mem::take(&mut self.pre.not) {
            if state == ObjectState::Moving {
                ObjectState::Waiting
            } else {
                ObjectState::Moving
            }
        } else {
            state
        };
        if prenominal && !finite {
            self.pre.state = Some(state);
            self.pre.cover(span);
            return;
        }
        self.flush();
        let targets = if finite || self.after_is() {
            self.subjects(true)
        } else {
            self.targets()
        };
        if targets.is_empty() {
            if !self.ego_subject {
                self.fronted_state = Some(state);
            }
            return;
        }
        // "waiting to turn left"
        let aim = self
            .item(self.at.wrapping_sub(1))
            .is_some_and(|b| b.words == "to");
        let stands = |t: &usize| {
            let state = self.mentions[*t].spec.state;
            matches!(state, Some(ObjectState::Waiting | ObjectState::Parked))
        };
        if aim && targets.iter().any(stands) {
            return;
        }
        for t in targets.iter().copied() {
            // "a lady cycling ahead of us" is on a bicycle
            let pedals = item.words.split(' ').any(|w| {
                matches!(
                    w,
                    "cycling"
                        | "cycles"
                        | "cycle"
                        | "cycled"
                        | "pedalling"
                        | "pedaling"
                        | "pedals"
                        | "biking"
                )
            });
            let m = &mut self.mentions[t];
            // "the parked van, which stands on the right": still parked
            let stands = matches!(
                item.words.as_str(),
                "stands" | "stand" | "is standing" | "are standing" | "stood" | "standing"
            );
            if stands && m.spec.state == Some(ObjectState::Parked) {
                continue;
            }
            if pedals && m.spec.class == Class::Pedestrian && !self.edits {
                m.mounts(Class::Bicycle);
            }
            m.spec.state = Some(state);
            if !m.spec.attributes.contains(&item.words) && item.words.len() > 3 {
                m.spec.attributes.push(item.words.clone());
            }
        }
        if (finite || self.fresh && targets == self.head) && !self.relative {
            self.last = targets;
        }
        self.chain = false;
    }

    pub(super) fn color(&mut self, color: &str, prenominal: bool, span: Span) {
        if prenominal {
            self.pre.color = Some(color.to_string());
            self.pre.cover(span);
            return;
        }
        // "the car that is not red"
        let denied = std::mem::take(&mut self.pre.not)
            || self
                .item(self.at.wrapping_sub(1))
                .is_some_and(|i| matches!(i.words.as_str(), "not" | "isnt" | "arent"));
        let denied = if denied {
            format!("not {color}")
        } else {
            String::new()
        };
        let color = if denied.is_empty() { color } else { denied.as_str() };
        let targets = if self.after_is() {
            self.subjects(true)
        } else {
            self.targets()
        };
        if targets.is_empty() {
            self.pre.color = Some(color.to_string());
            self.pre.cover(span);
        }
        for t in targets {
            self.mentions[t].spec.color = Some(color.to_string());
        }
    }
}
