//! Clauses: commands, statements about the scene, and contents of a new scene.

use super::super::lexicon::{LONGEST_PHRASE, Lexicon};
use super::super::mode::Mode;
use super::super::nouns::Noun;
use super::super::reading::{
    ActKind, Amount, Destination, Feature, ObjectPhrase, PlacePhrase, Quantity, Relation, Traits, Turn, Way,
};
use super::Grammar;
use super::things::state_of;
use place::description::{Density, Environment, Road};
use scene::graph::ObjectState;
use scene::{TimeOfDay, Weather};

type ParsedAct = Option<(ActKind, usize)>;

impl Grammar<'_> {
    /// The act that begins at a token.
    pub(super) fn act(&self, i: usize) -> ParsedAct {
        if let Some(end) = self.after("rest", i) {
            return Some((ActKind::Leave { who: Vec::new() }, end));
        }
        let edit = self.mode == Mode::Edit;
        let ways: [&dyn Fn() -> ParsedAct; 6] = [
            &|| self.none(i),
            &|| self.condition(i),
            &|| self.feature(i),
            &|| if edit { self.command(i) } else { None },
            &|| if edit { self.statement(i) } else { None },
            &|| self.new_things(i),
        ];
        let found = ways.iter().filter_map(|way| way());
        found.reduce(|best, next| if next.1 > best.1 { next } else { best })
    }

    /// "No pedestrians", "nothing else".
    fn none(&self, i: usize) -> ParsedAct {
        if let Some((what, end)) = self.symbol("alone", i) {
            let mut t = ObjectPhrase::new(Noun::of(what)?);
            t.other = true;
            return Some((ActKind::No { who: vec![t] }, end));
        }
        let end = self.after("none", i)?;
        let (mut who, end) = self.list(end, true)?;
        for t in &mut who {
            if matches!(t.quantity, Quantity::The | Quantity::TheN(_) | Quantity::N(_)) {
                return None;
            }
            t.quantity = Quantity::Unsaid;
        }
        Some((ActKind::No { who }, end))
    }

    /// Time, weather, road, surroundings, density.
    fn condition(&self, i: usize) -> ParsedAct {
        let mut at = i;
        while let Some(next) = self.after("article", at) {
            at = next;
        }
        if self.word(at) == ":" {
            at += 1;
        }
        let most = LONGEST_PHRASE.min(self.tokens.len().saturating_sub(at));
        (1..=most).rev().find_map(|n| {
            let words: Vec<&str> = self.tokens[at..at + n].iter().map(|t| t.text.as_str()).collect();
            let senses = Lexicon::bundled().senses(&words.join(" "))?;
            let prompt = self.mode == Mode::Prompt;
            let what = senses.iter().find_map(|s| {
                let named = |name: &str| name.replace('-', "_") == s.symbol;
                Some(match s.kind {
                    "time" => ActKind::Time {
                        what: TimeOfDay::ALL.iter().copied().find(|x| named(x.name()))?,
                    },
                    "weather" => ActKind::Weather {
                        what: Weather::ALL.iter().copied().find(|x| named(x.name()))?,
                    },
                    "road" if prompt => ActKind::Road {
                        what: Road::ALL.iter().copied().find(|x| named(x.name()))?,
                    },
                    // (a car park as the kind of road, not as the place of something)
                    "place" if prompt && s.symbol == "carpark" => ActKind::Road { what: Road::Parking },
                    "env" if prompt => ActKind::Env {
                        what: Environment::ALL.iter().copied().find(|x| named(x.name()))?,
                    },
                    "density" if prompt => ActKind::Density {
                        what: Density::ALL.iter().copied().find(|x| named(x.name()))?,
                    },
                    _ => return None,
                })
            })?;
            // ("a foggy highway": the road is read after this)
            Some((what, at + n))
        })
    }

    /// "A zebra crossing 20 m ahead".
    fn feature(&self, i: usize) -> ParsedAct {
        let i = self.after("have", i).unwrap_or(i);
        let i = match self.symbol("verb", i) {
            Some(("add", end)) => end,
            _ => i,
        };
        let (what, end) = self.symbol("has", i)?;
        let what = Feature::of(what)?;
        let (mut places, mut end) = (Vec::new(), end);
        while let Some((place, next)) = self.place(end) {
            places.push(place);
            end = next;
        }
        Some((ActKind::Has { what, places }, end))
    }

    /// New things.
    fn new_things(&self, i: usize) -> ParsedAct {
        let i = self.after("have", i).unwrap_or(i);
        let (mut things, end) = self.list(i, true)?;
        let prompt = self.mode == Mode::Prompt;
        for t in &mut things {
            match t.quantity {
                Quantity::N(_) | Quantity::Range(..) | Quantity::Some | Quantity::Many => {}
                // (a bare plural in a new scene means some)
                Quantity::All
                    if prompt && self.after("all", i).is_none() && self.after("the", i).is_none() =>
                {
                    t.quantity = Quantity::Some;
                }
                Quantity::Unsaid if prompt => t.quantity = Quantity::N(1),
                _ => return None,
            }
            if t.other
                || t.pick.is_some()
                || !t.except.is_empty()
                || t.noun == Noun::It
                || t.noun == Noun::One
            {
                return None;
            }
        }
        Some((ActKind::Add { things }, end))
    }

    /// A verb with its objects.
    fn command(&self, i: usize) -> ParsedAct {
        let i = self.after("polite", i).unwrap_or(i);
        let all = self.table.all_at("verb", self.tokens, i);
        let mut best: ParsedAct = None;
        for (verb, end) in all {
            for found in self.verb(verb, end).into_iter().flatten() {
                if best.as_ref().is_none_or(|b| found.1 > b.1) {
                    best = Some(found);
                }
            }
        }
        // one verb for several senses: "swap", "put", "turn", "set", "make"
        for verb in ["swap", "move", "set", "replace", "turn"] {
            let end = self.table.all_at("verb", self.tokens, i).map(|f| f.1).next();
            let is = |kind: &str| match kind {
                "swap" => matches!(self.word(i), "swap" | "exchange" | "switch"),
                "move" => matches!(self.word(i), "put" | "place" | "set" | "bring" | "take"),
                "set" => matches!(self.word(i), "turn" | "make" | "paint"),
                "replace" => matches!(self.word(i), "swap" | "turn" | "make" | "change"),
                "turn" => matches!(self.word(i), "turn" | "rotate"),
                _ => false,
            };
            let end = match end {
                Some(_) if is(verb) => i + 1,
                _ => continue,
            };
            for found in self.verb(verb, end).into_iter().flatten() {
                if best.as_ref().is_none_or(|b| found.1 > b.1) {
                    best = Some(found);
                }
            }
        }
        best
    }

    fn verb(&self, verb: &str, i: usize) -> Vec<ParsedAct> {
        let who = |places: bool| self.list(i, places);
        let there = |list: &[ObjectPhrase]| {
            list.iter().all(|t| {
                t.quantity != Quantity::Unsaid && !matches!(t.quantity, Quantity::Some | Quantity::Many)
            })
        };
        match verb {
            "add" => vec![self.new_things(i)],
            "remove" => vec![
                who(true)
                    .filter(|w| there(&w.0))
                    .map(|(who, end)| (ActKind::Remove { who }, self.after("gone", end).unwrap_or(end))),
            ],
            "keep" => vec![
                who(true)
                    .filter(|w| there(&w.0))
                    .map(|(who, end)| (ActKind::Keep { who }, end)),
            ],
            "leave" => vec![who(true).filter(|w| there(&w.0)).map(|(who, end)| {
                let tail = [
                    "as it is",
                    "as they are",
                    "alone",
                    "where it is",
                    "where they are",
                    "there",
                ];
                let end = tail.iter().find_map(|t| self.exactly(t, end)).unwrap_or(end);
                (ActKind::Leave { who }, end)
            })],
            "replace" => vec![self.replaced(i, true), self.replaced(i, false)],
            "move" => vec![self.moved(i, false), self.moved(i, true), self.taken(i)],
            "turn" => vec![self.turned(i, false), self.turned(i, true)],
            "set" => vec![self.painted(i, false), self.painted(i, true)],
            "park" => vec![self.parked(i)],
            "stop" => vec![who(true).filter(|w| there(&w.0)).map(|(who, end)| {
                let traits = Traits {
                    state: Some(ObjectState::Waiting),
                    ..Traits::default()
                };
                (ActKind::Set { who, traits }, end)
            })],
            "swap" => vec![self.swapped(i)],
            "double" => vec![self.times(i, 2.0)],
            "triple" => vec![self.times(i, 3.0)],
            "halve" => vec![self.times(i, 0.5)],
            _ => Vec::new(),
        }
    }

    /// The token after these exact words.
    fn exactly(&self, words: &str, i: usize) -> Option<usize> {
        let words: Vec<&str> = words.split(' ').collect();
        let same = words.iter().enumerate().all(|(k, w)| self.word(i + k) == *w);
        same.then_some(i + words.len())
    }

    /// "Take the bus away".
    fn taken(&self, i: usize) -> ParsedAct {
        let (who, end) = self.list(i, true)?;
        let end = self.after("gone", end)?;
        Some((ActKind::Remove { who }, end))
    }

    fn replaced(&self, i: usize, places: bool) -> ParsedAct {
        let (who, end) = self.list(i, places)?;
        let end = self.after("with", end)?;
        let (mut things, end) = self.list(end, false)?;
        let all = who.len() == 1 && who[0].quantity == Quantity::All;
        for t in &mut things {
            match t.quantity {
                Quantity::N(_) | Quantity::Range(..) | Quantity::Some | Quantity::Many => {}
                Quantity::All if all => {}
                _ => return None,
            }
        }
        Some((ActKind::Replace { who, things }, end))
    }

    fn destination(&self, i: usize) -> Option<(Destination, usize)> {
        let by = self.after("by", i).unwrap_or(i);
        let length = |i: usize| {
            let t = self.tokens.get(i).filter(|t| t.is_length)?;
            Some(((t.value? * 10.0).round() / 10.0, i + 1))
        };
        // "5 m closer", "closer by 5 m", "to the left"
        let (metres, at) = match length(by) {
            Some((m, end)) => (Some(m), end),
            None => (None, i),
        };
        if let Some((way, end)) = self.symbol("way", at) {
            let way = Way::of(way)?;
            let by = self.after("by", end).unwrap_or(end);
            let (metres, end) = match (metres, length(by)) {
                (None, Some((m, end))) => (Some(m), end),
                _ => (metres, end),
            };
            // ("to the left of the bus" is a place)
            if self.is_end(end) {
                return Some((Destination::By { way, metres }, end));
            }
        }
        let start = if self.word(i) == "to" && self.place(i).is_none() {
            i + 1
        } else {
            i
        };
        let (mut places, mut end) = (Vec::new(), start);
        while let Some((place, next)) = self.place(end) {
            places.push(place);
            end = next;
        }
        (!places.is_empty()).then_some((Destination::To(places), end))
    }

    fn moved(&self, i: usize, places: bool) -> ParsedAct {
        let (who, end) = self.list(i, places)?;
        if !who.iter().all(|t| {
            t.quantity.is_definite()
                || t.noun == Noun::It
                || matches!(t.quantity, Quantity::N(_)) && t.pick.is_some()
        }) {
            return None;
        }
        let (to, end) = self.destination(end)?;
        Some((ActKind::Move { who, to }, end))
    }

    fn turned(&self, i: usize, places: bool) -> ParsedAct {
        let (who, end) = self.list(i, places)?;
        if !who.iter().all(|t| t.quantity.is_definite() || t.noun == Noun::It) {
            return None;
        }
        let (how, end) = self.symbol("turns", end)?;
        let turn = match how {
            "around" => Turn::Around,
            "left" => Turn::Left(90.0),
            "right" => Turn::Left(-90.0),
            _ => Turn::Along,
        };
        self.is_end(end).then_some((ActKind::Turn { who, turn }, end))
    }

    fn traits(&self, i: usize) -> Option<(Traits, usize)> {
        if let Some((paint, end)) = self.paint(i) {
            return Some((
                Traits {
                    paint: Some(paint),
                    ..Traits::default()
                },
                end,
            ));
        }
        let (state, end) = self.symbol("state", i)?;
        Some((
            Traits {
                state: state_of(state),
                ..Traits::default()
            },
            end,
        ))
    }

    fn painted(&self, i: usize, places: bool) -> ParsedAct {
        let (who, end) = self.list(i, places)?;
        if !who
            .iter()
            .all(|t| t.quantity.is_definite() || t.noun == Noun::It || matches!(t.quantity, Quantity::N(_)))
        {
            return None;
        }
        let end = if self.word(end) == "in" { end + 1 } else { end };
        let (traits, end) = self.traits(end)?;
        self.is_end(end).then_some((ActKind::Set { who, traits }, end))
    }

    fn parked(&self, i: usize) -> ParsedAct {
        let (who, end) = self.list(i, false)?;
        if who.iter().all(|t| t.quantity.is_definite() || t.noun == Noun::It) {
            if let Some((Destination::To(places), end)) = self.destination(end) {
                return Some((
                    ActKind::Move {
                        who,
                        to: Destination::To(places),
                    },
                    end,
                ));
            }
            let traits = Traits {
                state: Some(ObjectState::Parked),
                ..Traits::default()
            };
            return self.is_end(end).then_some((ActKind::Set { who, traits }, end));
        }
        let (what, end) = self.new_things(i)?;
        let ActKind::Add { mut things } = what else {
            return None;
        };
        things
            .iter_mut()
            .for_each(|t| t.state = Some(ObjectState::Parked));
        Some((ActKind::Add { things }, end))
    }

    fn swapped(&self, i: usize) -> ParsedAct {
        let (one, end) = self.thing(i, false)?;
        let joint = matches!(self.word(end), "and" | "with").then_some(end + 1)?;
        let (other, end) = self.thing(joint, true)?;
        let both = |t: &ObjectPhrase| t.quantity == Quantity::The;
        if !(both(&one) && both(&other)) {
            return None;
        }
        let (one, other) = (Box::new(one), Box::new(other));
        Some((ActKind::Swap { one, other }, end))
    }

    fn times(&self, i: usize, factor: f64) -> ParsedAct {
        let (mut t, end) = self.thing(i, true)?;
        t.quantity = Quantity::Unsaid;
        let amount = Amount::Times(factor);
        Some((ActKind::Count { who: vec![t], amount }, end))
    }

    /// A statement about something that is there: "the bus is red", "the truck should be 20 m ahead".
    fn statement(&self, i: usize) -> ParsedAct {
        let mut best: ParsedAct = None;
        for places in [false, true] {
            let Some((who, end)) = self.list(i, places) else {
                continue;
            };
            let there = |t: &ObjectPhrase| {
                t.quantity.is_definite()
                    || matches!(t.noun, Noun::It | Noun::One)
                    || matches!(t.quantity, Quantity::N(_)) && self.word(i + 1) == "of"
            };
            if !who.iter().all(there) {
                continue;
            }
            for found in self.said_of(who, end) {
                if best.as_ref().is_none_or(|b| found.1 > b.1) {
                    best = Some(found);
                }
            }
        }
        best
    }

    fn said_of(&self, who: Vec<ObjectPhrase>, end: usize) -> Vec<(ActKind, usize)> {
        let mut out = Vec::new();
        let gone = self.after("goes", end).or(self.after("gone", end));
        if let Some(end) = gone.filter(|e| self.is_end(*e)) {
            out.push((ActKind::Remove { who: who.clone() }, end));
        }
        if let Some(end) = self.after("stays", end).filter(|e| self.is_end(*e)) {
            out.push((ActKind::Leave { who: who.clone() }, end));
        }
        let is = self.after("becomes", end);
        let at = is.unwrap_or(end);
        if let Some((traits, end)) = self.traits(at).filter(|(_, e)| self.is_end(*e)) {
            out.push((
                ActKind::Set {
                    who: who.clone(),
                    traits,
                },
                end,
            ));
        }
        if let Some((to, end)) = self.destination(at).filter(|(_, e)| self.is_end(*e)) {
            let to = match to {
                // ("the bus is on the right": it goes there)
                Destination::By {
                    way: Way::Left,
                    metres: None,
                } => Destination::To(vec![ego_side(Relation::Left)]),
                Destination::By {
                    way: Way::Right,
                    metres: None,
                } => Destination::To(vec![ego_side(Relation::Right)]),
                Destination::By {
                    way: Way::Forward,
                    metres: None,
                } => Destination::To(vec![ego_side(Relation::Ahead)]),
                to => to,
            };
            out.push((ActKind::Move { who: who.clone(), to }, end));
        }
        if is.is_some()
            && let Some((things, end)) = self.list(at, false).filter(|(_, e)| self.is_end(*e))
            && things
                .iter()
                .all(|t| matches!(t.quantity, Quantity::N(_)) && !t.other)
        {
            out.push((ActKind::Replace { who, things }, end));
        }
        out
    }
}

fn ego_side(relation: Relation) -> PlacePhrase {
    super::places::to_ego(relation)
}
