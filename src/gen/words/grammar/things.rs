//! Noun phrases: "the two parked red cars on the left", "a bus 20 m ahead of me".

use super::super::lexicon::{LONGEST_PHRASE, Lexicon};
use super::super::nouns::Noun;
use super::super::reading::{ObjectPhrase, PaintWish, Pick, Quantity};
use super::Grammar;
use scene::Paint;
use scene::graph::{ObjectState, SizeHint};

impl Grammar<'_> {
    /// Things joined by "and".
    pub(super) fn list(&self, mut i: usize, places: bool) -> Option<(Vec<ObjectPhrase>, usize)> {
        let (first, end) = self.thing(i, places)?;
        let mut things = vec![first];
        i = end;
        loop {
            let joint = match self.word(i) {
                "," if matches!(self.word(i + 1), "and" | "plus") => i + 2,
                "," | "and" | "plus" | "&" => i + 1,
                _ => match (self.word(i), self.word(i + 1), self.word(i + 2)) {
                    ("as", "well", "as") => i + 3,
                    _ => return Some((things, i)),
                },
            };
            match self.thing(joint, places) {
                // (existing and new things do not form one list)
                Some((t, end)) if self.alike(&things[0], &t) => {
                    things.push(t);
                    i = end;
                }
                _ => return Some((things, i)),
            }
        }
    }

    fn alike(&self, a: &ObjectPhrase, b: &ObjectPhrase) -> bool {
        let there = |t: &ObjectPhrase| t.quantity.is_definite() || t.noun == Noun::It || t.id.is_some();
        there(a) == there(b)
    }

    /// One noun phrase; with the parts after the noun, if `places`.
    pub(super) fn thing(&self, i: usize, places: bool) -> Option<(ObjectPhrase, usize)> {
        if let Some(end) = self.after("it", i) {
            let many = matches!(self.word(i), "them" | "they" | "those" | "these");
            let quantity = if many { Quantity::All } else { Quantity::The };
            return Some((ObjectPhrase::new(Noun::It).with(quantity), end));
        }
        if let ("#", Some(n)) = (self.word(i), self.tokens.get(i + 1).and_then(|t| t.value)) {
            let mut t = ObjectPhrase::new(Noun::Thing).with(Quantity::The);
            t.id = Some(n as u32);
            return Some((t, i + 2));
        }
        let (mut t, i) = self.before_noun(i)?;
        let (noun, many, mut i) = self.noun(i, &t)?;
        t.noun = noun;
        if let ("#", Some(n)) = (self.word(i), self.tokens.get(i + 1).and_then(|t| t.value)) {
            t.id = Some(n as u32);
            t.quantity = Quantity::The;
            i += 2;
        }
        t.quantity = match t.quantity {
            Quantity::The if many => Quantity::All,
            Quantity::Unsaid if many => Quantity::All,
            // ("every car", "each bus")
            q => q,
        };
        if places {
            i = self.after_noun(&mut t, i);
        }
        if matches!(t.noun, Noun::Cone | Noun::Barrier) {
            t.state = None; // (they can only stand)
        }
        Some((t, i))
    }

    fn before_noun(&self, mut i: usize) -> Option<(ObjectPhrase, usize)> {
        let mut t = ObjectPhrase::new(Noun::Thing);
        let number = |i: usize| {
            let token = self.tokens.get(i)?;
            let v = token.value.filter(|v| {
                !token.is_length && !token.is_speed && v.fract() == 0.0 && (0.0..1e6).contains(v)
            })?;
            Some(v as u32)
        };
        // "two to four", "3-5", "between three and five"
        let range = |i: usize| {
            let from = if self.word(i) == "between" || self.word(i) == "from" {
                i + 1
            } else {
                i
            };
            let a = number(from)?;
            let joint = matches!(self.word(from + 1), "to" | "-" | "–" | "or")
                || from > i && self.word(from + 1) == "and";
            let b = number(from + 2).filter(|b| joint && *b > a)?;
            Some((a, b, from + 3))
        };
        i = self.after("only", i).unwrap_or(i);
        if let Some((a, b, end)) = range(i) {
            t.quantity = Quantity::Range(a, b);
            i = end;
        } else if let Some((n, end)) = self.symbol("dozen", i) {
            t.quantity = Quantity::N(n.parse().ok()?);
            i = end;
        } else if let Some(end) = self.after("two", i) {
            t.quantity = Quantity::N(2);
            i = end;
        } else if let Some(end) = self.after("both", i) {
            t.quantity = Quantity::TheN(2);
            i = end;
        } else if let Some(end) = self.after("half", i) {
            t.quantity = Quantity::Half;
            i = end;
        } else if let Some(end) = self.after("many", i) {
            t.quantity = Quantity::Many;
            i = end;
        } else if let Some(end) = self.after("all", i) {
            t.quantity = Quantity::All;
            i = end;
            if let Some(n) = number(i) {
                t.quantity = Quantity::TheN(n);
                i += 1;
            }
        } else if let Some(n) = number(i) {
            t.quantity = Quantity::N(n);
            i += 1;
            if self.word(i) == "of" {
                i = self.after("the", i + 1)?;
            } else if let Some(end) = self.after("more", i) {
                i = end;
            }
        } else if let Some(end) = self.after("some", i) {
            t.quantity = Quantity::Some;
            i = end;
        } else if let Some(end) = self.after("the", i) {
            t.quantity = Quantity::The;
            i = end;
        } else if let Some(end) = self.after("a", i) {
            t.quantity = Quantity::N(1);
            i = end;
        }
        if let Some(end) = self.after("other", i) {
            t.other = true;
            i = end;
        }
        if let (Quantity::The, Some(n)) = (t.quantity, number(i)) {
            t.quantity = Quantity::TheN(n);
            i += 1;
        }
        if let Some((pick, end)) = self.symbol("pick", i) {
            t.pick = Pick::of(pick);
            i = end;
        } else if let Some((nth, end)) = self.symbol("nth", i).filter(|_| t.quantity == Quantity::The) {
            t.nth = nth.parse().ok();
            i = end;
        }
        loop {
            if self.word(i) == "," && t.paint.is_some() | t.size.is_some() {
                i += 1;
            }
            if let Some((size, end)) = self.symbol("size", i).filter(|_| t.size.is_none()) {
                t.size = Some(if size == "large" {
                    SizeHint::Large
                } else {
                    SizeHint::Small
                });
                i = end;
            } else if let Some((state, end)) = self.symbol("state", i).filter(|_| t.state.is_none()) {
                t.state = state_of(state);
                i = end;
            } else if let Some((paint, end)) = self.paint(i).filter(|_| t.paint.is_none()) {
                t.paint = Some(PaintWish::Is(paint));
                i = end;
            } else if self.word(i) == "oncoming" && self.noun(i + 1, &t).is_some() {
                t.places
                    .push(super::places::to_ego(super::super::reading::Relation::Oncoming));
                i += 1;
            } else {
                return Some((t, i));
            }
        }
    }

    /// The noun at a token, whether it is a plural, and the token after it.
    fn noun(&self, i: usize, t: &ObjectPhrase) -> Option<(Noun, bool, usize)> {
        let most = LONGEST_PHRASE.min(self.tokens.len().saturating_sub(i));
        let found = (1..=most).rev().find_map(|n| {
            let words: Vec<&str> = self.tokens[i..i + n].iter().map(|t| t.text.as_str()).collect();
            let senses = Lexicon::bundled().senses(&words.join(" "))?;
            let s = senses.iter().find(|s| s.kind == "noun")?;
            Some((Noun::of(s.symbol)?, s.many, i + n))
        });
        if found.is_some() {
            return found;
        }
        let said = t.paint.is_some() || t.pick.is_some() || t.nth.is_some() || t.other || t.state.is_some();
        let counted = t.quantity != Quantity::Unsaid;
        match self.after("one", i) {
            Some(end) if said && counted => Some((Noun::One, self.word(i) == "ones", end)),
            _ if t.other && counted => Some((Noun::One, matches!(t.quantity, Quantity::TheN(n) if n > 1), i)),
            _ => None,
        }
    }

    /// States, places and exceptions behind the noun.
    fn after_noun(&self, t: &mut ObjectPhrase, mut i: usize) -> usize {
        loop {
            let linked = self.after("link", i).unwrap_or(i);
            if let Some((state, end)) = self.symbol("state", linked).filter(|_| t.state.is_none())
                && self.place(linked).is_none_or(|(_, e)| e < end)
            {
                t.state = state_of(state);
                i = end;
            } else if let Some((place, end)) = self.place(linked) {
                t.places.push(place);
                i = end;
            } else if let Some((relation, end)) = self.symbol("group", linked) {
                t.places.extend(super::places::alone(relation));
                i = end;
            } else if let Some(end) = self.after("except", i)
                && self.deep.get() < 2
                && let Some((not, end)) = {
                    self.deep.set(self.deep.get() + 1);
                    let not = self.list(end, true);
                    self.deep.set(self.deep.get() - 1);
                    not
                }
            {
                t.except = not;
                i = end;
            } else if (self.word(i) == "," || self.word(i) == "and" && !t.places.is_empty())
                && self.place(i + 1).is_some()
                && self.thing(i + 1, false).is_none()
            {
                i += 1;
            } else {
                return i;
            }
        }
    }

    /// A paint, if the word has no other meaning here.
    pub(super) fn paint(&self, i: usize) -> Option<(Paint, usize)> {
        let senses = Lexicon::bundled().senses(self.word(i))?;
        let s = senses.iter().find(|s| s.kind == "paint")?;
        Some((Paint::ALL.into_iter().find(|p| p.name() == s.symbol)?, i + 1))
    }
}

pub(super) fn state_of(name: &str) -> Option<ObjectState> {
    Some(match name {
        "parked" => ObjectState::Parked,
        "moving" => ObjectState::Moving,
        _ => ObjectState::Waiting,
    })
}
