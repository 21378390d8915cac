//! Places: "in front of me", "20 m behind the bus", "on the left pavement".

use super::super::lexicon::Lexicon;
use super::super::notation::anchor_of;
use super::super::reading::Quantity;
use super::super::reading::{AnchorPhrase, PlacePhrase, Relation};
use super::Grammar;
use scene::graph::LaneRole;

pub(super) fn to_ego(relation: Relation) -> PlacePhrase {
    PlacePhrase {
        relation,
        to: Some(AnchorPhrase::Ego),
        and: None,
        metres: None,
    }
}

/// A place that needs no anchor.
pub(super) fn alone(relation: &str) -> Option<PlacePhrase> {
    Some(PlacePhrase {
        relation: Relation::of(relation)?,
        to: None,
        and: None,
        metres: None,
    })
}

impl Grammar<'_> {
    fn metres(&self, i: usize) -> Option<(f64, usize)> {
        let t = self.tokens.get(i).filter(|t| t.is_length)?;
        Some(((t.value? * 10.0).round() / 10.0, i + 1))
    }

    /// One place.
    pub(super) fn place(&self, i: usize) -> Option<(PlacePhrase, usize)> {
        // "20 m ahead of the bus", "20 m away", "at 20 m"
        let at = self.after("at", i).filter(|e| self.metres(*e).is_some());
        if let Some((metres, end)) = self.metres(at.unwrap_or(i)) {
            if let Some((mut place, end)) = self.plain_place(end)
                && place.metres.is_none()
                && !matches!(place.to, Some(AnchorPhrase::Lane(_)))
            {
                place.metres = Some(metres);
                return Some((place, end));
            }
            let end = match self.after("away", end) {
                Some(away) => {
                    let from = if self.word(away) == "from" { away + 1 } else { away };
                    self.ego(from).unwrap_or(away)
                }
                None if at.is_some() => end,
                None => return None,
            };
            return Some((
                PlacePhrase {
                    metres: Some(metres),
                    ..to_ego(Relation::At)
                },
                end,
            ));
        }
        let (mut place, end) = self.plain_place(i)?;
        // "ahead of me at 20 m", "behind the bus, 5 m away"
        let far = self.after("at", end).unwrap_or(end);
        if let (true, Some((metres, after))) = (far > end, self.metres(far))
            && place.metres.is_none()
            && !matches!(place.to, Some(AnchorPhrase::Lane(_)))
            && self.plain_place(after).is_none()
        {
            place.metres = Some(metres);
            return Some((place, after));
        }
        Some((place, end))
    }

    fn plain_place(&self, i: usize) -> Option<(PlacePhrase, usize)> {
        let by_relation = self
            .table
            .all_at("rel", self.tokens, i)
            .find_map(|(name, end)| self.related(name, end));
        let by_ego = self.table.all_at("ego", self.tokens, i).find_map(|(name, end)| {
            let relation = Relation::of(name)?;
            // ("left" alone is a side only if no noun follows that it could belong to)
            Some((to_ego(relation), end))
        });
        match (by_relation, by_ego) {
            (Some(a), Some(b)) if b.1 > a.1 => Some(b),
            (a, b) => a.or(b),
        }
    }

    fn related(&self, name: &str, end: usize) -> Option<(PlacePhrase, usize)> {
        let (relation, crossing) = match name {
            "on_crossing" => (Relation::On, true),
            name => (Relation::of(name)?, false),
        };
        let place = |to, end| {
            Some((
                PlacePhrase {
                    relation,
                    to: Some(to),
                    and: None,
                    metres: None,
                },
                end,
            ))
        };
        if relation == Relation::Between {
            return self.between(end);
        }
        if let Some((lane, end)) = self.symbol("lane", end) {
            let anchor = anchor_of(lane)?;
            let fits = match &anchor {
                AnchorPhrase::Crossing => {
                    return match relation {
                        Relation::On | Relation::Crossing => Some((
                            PlacePhrase {
                                relation: Relation::On,
                                to: Some(anchor),
                                and: None,
                                metres: None,
                            },
                            end,
                        )),
                        _ => place(anchor, end),
                    };
                }
                AnchorPhrase::Junction => true,
                AnchorPhrase::Lane(LaneRole::Road) => {
                    matches!(relation, Relation::On | Relation::Crossing | Relation::Blocking)
                }
                _ => matches!(
                    relation,
                    Relation::On | Relation::Blocking | Relation::Near | Relation::NextTo
                ),
            };
            return if fits && !crossing {
                place(anchor, end)
            } else {
                None
            };
        }
        if crossing
            || matches!(
                relation,
                Relation::On | Relation::Blocking | Relation::Crossing | Relation::Waiting
            )
        {
            return None;
        }
        if let Some(end) = self.ego(end) {
            return place(AnchorPhrase::Ego, end);
        }
        if self.after("each_other", end).is_some()
            && matches!(relation, Relation::Facing | Relation::Near | Relation::NextTo)
        {
            let end = self.after("each_other", end)?;
            return place(AnchorPhrase::EachOther, end);
        }
        let each = matches!(self.word(end), "each" | "every");
        let (mut t, end) = self.thing(end, false)?;
        if each && t.quantity == Quantity::All {
            t.quantity = Quantity::Each;
        }
        place(AnchorPhrase::Thing(Box::new(t)), end)
    }

    fn between(&self, i: usize) -> Option<(PlacePhrase, usize)> {
        let one = |i: usize| match self.ego(i) {
            Some(end) => Some((AnchorPhrase::Ego, end)),
            None => self
                .thing(i, false)
                .map(|(t, end)| (AnchorPhrase::Thing(Box::new(t)), end)),
        };
        let (first, end) = one(i)?;
        let second = if self.word(end) == "and" {
            one(end + 1)
        } else {
            None
        };
        let place = |to, and, end| {
            let place = PlacePhrase {
                relation: Relation::Between,
                to: Some(to),
                and,
                metres: None,
            };
            Some((place, end))
        };
        match (first, second) {
            (first, Some((second, end))) => place(first, Some(second), end),
            (AnchorPhrase::Thing(t), None) => {
                let several = matches!(t.quantity, Quantity::TheN(n) | Quantity::N(n) if n > 1)
                    || t.quantity == Quantity::All;
                if several {
                    place(AnchorPhrase::Thing(t), None, end)
                } else {
                    None
                }
            }
            _ => None,
        }
    }

    /// The token after words for the ego vehicle.
    fn ego(&self, i: usize) -> Option<usize> {
        let most = 4.min(self.tokens.len().saturating_sub(i));
        (1..=most).rev().find_map(|n| {
            let words: Vec<&str> = self.tokens[i..i + n].iter().map(|t| t.text.as_str()).collect();
            let senses = Lexicon::bundled().senses(&words.join(" "))?;
            senses.iter().any(|s| s.kind == "ego").then_some(i + n)
        })
    }
}
