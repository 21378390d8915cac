//! Notation to values.

use super::super::nouns::Noun;
use super::super::reading::{
    ActKind, Amount, AnchorPhrase, Destination, Feature, LaneSide, ObjectPhrase, PaintWish, Pick,
    PlacePhrase, Quantity, Reading, Relation, Traits, Turn, Way,
};
use super::{PACES, SIZES, STATES, anchors, paint, plain};
use place::description::{Density, Environment, Road};
use scene::clip::{Manoeuvre, Template};
use scene::graph::{ObjectState, SizeHint};
use scene::{TimeOfDay, Weather};

/// Reason why a line is not a reading.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{found:?} where {expected} should be, after {after:?}")]
pub struct NotationError {
    /// The token that does not fit; empty at the end.
    pub found: String,
    /// Tokens that would fit.
    pub expected: String,
    /// The tokens before.
    pub after: String,
}

/// Longest line that is read, letters.
pub const LONGEST: usize = 20_000;
/// Deepest nesting of things in places of things.
const DEEPEST: usize = 6;

/// The reading of a line.
///
/// # Errors
///
/// If a token does not fit; the error names it.
pub fn parse(line: &str) -> Result<Reading, NotationError> {
    let spaced: String = line
        .chars()
        .take(LONGEST)
        .flat_map(|c| match c {
            '(' | ')' | ';' => vec![' ', c, ' '],
            c => vec![c],
        })
        .collect();
    let mut p = Parser {
        tokens: spaced.split_whitespace().collect(),
        at: 0,
        deep: 0,
    };
    let mut reading = Reading::default();
    while p.at < p.tokens.len() {
        reading.acts.push(p.act()?.into());
        if p.at < p.tokens.len() {
            p.expect(";")?;
        }
    }
    Ok(reading)
}

/// State of a beginning of a line.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Prefix {
    /// True if it is a valid reading as it stands.
    pub is_whole: bool,
    /// True if it can be continued to a valid reading.
    pub is_open: bool,
}

impl Default for Prefix {
    /// The state of an empty line.
    fn default() -> Self {
        Self {
            is_whole: false,
            is_open: true,
        }
    }
}

/// Whether a line is the beginning of a reading.
pub fn prefix(line: &str) -> Prefix {
    match parse(line) {
        Ok(reading) => Prefix {
            is_whole: !reading.acts.is_empty(),
            is_open: true,
        },
        Err(error) => Prefix {
            is_whole: false,
            is_open: error.found.is_empty(),
        },
    }
}

struct Parser<'t> {
    tokens: Vec<&'t str>,
    at: usize,
    deep: usize,
}

type Parsed<T> = Result<T, NotationError>;

impl<'t> Parser<'t> {
    fn peek(&self) -> &'t str {
        self.tokens.get(self.at).copied().unwrap_or("")
    }

    fn wrong<T>(&self, expected: &str) -> Parsed<T> {
        Err(NotationError {
            found: self.peek().into(),
            expected: expected.into(),
            after: self.tokens[self.at.saturating_sub(5)..self.at].join(" "),
        })
    }

    /// Takes the token if it is this one.
    fn takes(&mut self, token: &str) -> bool {
        let is = self.peek() == token;
        self.at += usize::from(is);
        is
    }

    fn expect(&mut self, token: &str) -> Parsed<()> {
        if self.takes(token) {
            Ok(())
        } else {
            self.wrong(token)
        }
    }

    /// Takes the token if `of` knows it.
    fn maybe<T>(&mut self, of: impl FnOnce(&str) -> Option<T>) -> Option<T> {
        let found = of(self.peek());
        self.at += usize::from(found.is_some());
        found
    }

    fn must<T>(&mut self, expected: &str, of: impl FnOnce(&str) -> Option<T>) -> Parsed<T> {
        match self.maybe(of) {
            Some(found) => Ok(found),
            None => self.wrong(expected),
        }
    }

    fn whole(&mut self) -> Parsed<u32> {
        self.must("a whole number", whole)
    }

    fn number(&mut self) -> Parsed<f64> {
        self.must("a number", |t| {
            t.parse().ok().filter(|x: &f64| x.is_finite() && *x >= 0.0)
        })
    }

    fn metres(&mut self) -> Option<f64> {
        self.maybe(|t| measure(t, "m"))
    }

    fn list(&mut self) -> Parsed<Vec<ObjectPhrase>> {
        let mut things = vec![self.thing()?];
        while self.takes("and") {
            things.push(self.thing()?);
        }
        Ok(things)
    }

    fn act(&mut self) -> Parsed<ActKind> {
        let verb = self.peek();
        self.at += 1;
        Ok(match verb {
            "add" => ActKind::Add { things: self.list()? },
            "no" => ActKind::No { who: self.list()? },
            "remove" => ActKind::Remove { who: self.list()? },
            "keep" => ActKind::Keep { who: self.list()? },
            "leave" if self.takes("rest") => ActKind::Leave { who: Vec::new() },
            "leave" => ActKind::Leave { who: self.list()? },
            "replace" => {
                let who = self.list()?;
                self.expect("with")?;
                let things = self.list()?;
                ActKind::Replace { who, things }
            }
            "swap" => {
                let one = Box::new(self.thing()?);
                self.expect("and")?;
                let other = Box::new(self.thing()?);
                ActKind::Swap { one, other }
            }
            "move" => {
                let who = self.list()?;
                let to = self.destination()?;
                ActKind::Move { who, to }
            }
            "turn" => {
                let who = self.list()?;
                let turn = self.turn()?;
                ActKind::Turn { who, turn }
            }
            "set" => {
                let who = self.list()?;
                let traits = self.traits()?;
                ActKind::Set { who, traits }
            }
            "count" => {
                let who = self.list()?;
                let amount = self.count()?;
                ActKind::Count { who, amount }
            }
            "go" => {
                let who = if self.takes("ego") {
                    Vec::new()
                } else {
                    self.list()?
                };
                let how = self.manoeuvre()?;
                ActKind::Go { who, how }
            }
            "length" => ActKind::Length {
                seconds: self.must("seconds", |t| measure(t, "s"))?,
            },
            "time" => ActKind::Time {
                what: self.must("a time of day", |t| {
                    TimeOfDay::ALL.iter().copied().find(|x| x.name() == t)
                })?,
            },
            "weather" => ActKind::Weather {
                what: self.must("a weather", |t| {
                    Weather::ALL.iter().copied().find(|x| x.name() == t)
                })?,
            },
            "road" => ActKind::Road {
                what: self.must("a kind of road", |t| {
                    Road::ALL.iter().copied().find(|x| plain(x.name()) == t)
                })?,
            },
            "env" => ActKind::Env {
                what: self.must("surroundings", |t| {
                    Environment::ALL.iter().copied().find(|x| x.name() == t)
                })?,
            },
            "density" => ActKind::Density {
                what: self.must("a density", |t| {
                    Density::ALL.iter().copied().find(|x| x.name() == t)
                })?,
            },
            "has" => ActKind::Has {
                what: self.must("crossing or sidewalk", Feature::of)?,
                places: self.places()?,
            },
            "lacks" => ActKind::Lacks {
                what: self.must("crossing or sidewalk", Feature::of)?,
            },
            "lanes" => ActKind::Lanes { n: self.whole()? },
            "one_way" => ActKind::OneWay,
            "narrow" => ActKind::Narrow,
            "wide" => ActKind::Wide,
            "own_lane" => ActKind::OwnLane {
                what: self.must("left, right or middle", LaneSide::of)?,
            },
            _ => {
                self.at -= 1;
                return self.wrong("a verb");
            }
        })
    }

    fn manoeuvre(&mut self) -> Parsed<Manoeuvre> {
        let named = |t: &str| Template::ALL.iter().copied().find(|x| x.name() == t);
        let mut how = Manoeuvre::from_template(self.must("a manoeuvre", named)?);
        if self.takes("from") {
            how.from_s = Some(self.must("seconds", |t| measure(t, "s"))?);
        }
        if self.takes("gap") {
            how.gap_m = Some(self.must("metres", |t| measure(t, "m"))?);
        }
        if self.takes("speed") {
            how.kmh = Some(self.must("km/h", |t| measure(t, "kmh"))?);
        }
        how.pace = self.maybe(|t| PACES.into_iter().find(|x| x.0 == t).map(|x| x.1));
        Ok(how)
    }

    fn destination(&mut self) -> Parsed<Destination> {
        if self.takes("to") {
            let places = self.places()?;
            return if places.is_empty() {
                self.wrong("(")
            } else {
                Ok(Destination::To(places))
            };
        }
        self.expect("by")?;
        if self.takes("times") {
            return Ok(Destination::Times(self.number()?));
        }
        for (lane, sign) in [("lane_left", 1), ("lane_right", -1)] {
            if self.takes(lane) {
                let n = self.maybe(whole).unwrap_or(1).min(20);
                return Ok(Destination::Lanes(sign * n as i32));
            }
        }
        let way = self.must("a way to move", Way::of)?;
        let metres = self.metres();
        Ok(Destination::By { way, metres })
    }

    fn turn(&mut self) -> Parsed<Turn> {
        if self.takes("around") {
            return Ok(Turn::Around);
        }
        if self.takes("along") {
            return Ok(Turn::Along);
        }
        for (side, sign) in [("left", 1.0), ("right", -1.0)] {
            if self.takes(side) {
                let degrees = self.maybe(|t| measure(t, "deg")).unwrap_or(90.0);
                return Ok(Turn::Left(sign * degrees));
            }
        }
        self.expect("to")?;
        let places = self.places()?;
        if places.is_empty() {
            self.wrong("(")
        } else {
            Ok(Turn::To(places))
        }
    }

    fn traits(&mut self) -> Parsed<Traits> {
        let mut traits = Traits::default();
        loop {
            if let Some(x) = self.maybe(size) {
                traits.size = Some(x);
            } else if let Some(x) = self.maybe(state) {
                traits.state = Some(x);
            } else if let Some(x) = self.maybe(paint) {
                traits.paint = Some(x);
            } else if self.takes("paint_of") {
                traits.paint_of = Some(Box::new(self.thing()?));
            } else if traits == Traits::default() {
                return self.wrong("a size, state or paint");
            } else {
                return Ok(traits);
            }
        }
    }

    fn count(&mut self) -> Parsed<Amount> {
        if self.takes("times") {
            return Ok(Amount::Times(self.number()?));
        }
        self.expect("to")?;
        let least = self.whole()?;
        let most = if self.takes("..") { self.whole()? } else { least };
        Ok(Amount::To(least, most.max(least)))
    }

    fn thing(&mut self) -> Parsed<ObjectPhrase> {
        if self.deep >= DEEPEST {
            return self.wrong("no deeper nesting");
        }
        self.deep += 1;
        let thing = self.thing_within();
        self.deep -= 1;
        thing
    }

    fn thing_within(&mut self) -> Parsed<ObjectPhrase> {
        let mut t = ObjectPhrase::new(Noun::Thing);
        let the = self.takes("the");
        t.quantity = match self.peek() {
            "all" => Quantity::All,
            "each" => Quantity::Each,
            "half" => Quantity::Half,
            "some" => Quantity::Some,
            "many" => Quantity::Many,
            _ if the => Quantity::The,
            _ => Quantity::Unsaid,
        };
        self.at += usize::from(!matches!(t.quantity, Quantity::The | Quantity::Unsaid));
        t.other = self.takes("other");
        if let Some(n) = self.maybe(whole) {
            t.quantity = if the {
                Quantity::TheN(n)
            } else if self.takes("..") {
                let most = self.whole()?;
                Quantity::Range(n.min(most), most.max(n))
            } else {
                Quantity::N(n)
            };
        }
        t.pick = self.maybe(Pick::of);
        if self.takes("nth") {
            t.nth = Some(self.whole()?);
        }
        t.size = self.maybe(size);
        t.state = self.maybe(state);
        t.paint = self.maybe(paint_wish);
        t.noun = match self.maybe(Noun::of) {
            Some(noun) => noun,
            None if t.other => Noun::Thing,
            None => return self.wrong("a noun"),
        };
        t.id = self.maybe(|x| x.strip_prefix('#').and_then(|n| n.parse().ok()));
        while self.peek() == "(" {
            if self.tokens.get(self.at + 1) == Some(&"except") {
                self.at += 2;
                t.except.extend(self.list()?);
                self.expect(")")?;
            } else {
                t.places.push(self.place()?);
            }
        }
        Ok(t)
    }

    fn places(&mut self) -> Parsed<Vec<PlacePhrase>> {
        let mut places = Vec::new();
        while self.peek() == "(" {
            places.push(self.place()?);
        }
        Ok(places)
    }

    fn anchor(&mut self) -> Parsed<AnchorPhrase> {
        match self.maybe(|t| anchors().find(|(name, _)| *name == t)) {
            Some((_, anchor)) => Ok(anchor),
            None => Ok(AnchorPhrase::Thing(Box::new(self.thing()?))),
        }
    }

    fn place(&mut self) -> Parsed<PlacePhrase> {
        self.expect("(")?;
        let relation = self.must("a relation", Relation::of)?;
        let mut place = PlacePhrase {
            relation,
            to: None,
            and: None,
            metres: None,
        };
        if !matches!(
            relation,
            Relation::There | Relation::InLine | Relation::SideBySide
        ) {
            place.to = Some(self.anchor()?);
        }
        if relation == Relation::Between && self.takes("and") {
            place.and = Some(self.anchor()?);
        }
        place.metres = self.metres();
        if relation == Relation::At && place.metres.is_none() {
            return self.wrong("metres");
        }
        self.expect(")")?;
        Ok(place)
    }
}

fn whole(t: &str) -> Option<u32> {
    (!t.is_empty() && t.bytes().all(|b| b.is_ascii_digit()))
        .then(|| t.parse().ok())
        .flatten()
}

fn measure(t: &str, unit: &str) -> Option<f64> {
    let number = t.strip_suffix(unit)?;
    let starts = number.starts_with(|c: char| c.is_ascii_digit());
    number.parse().ok().filter(|x: &f64| starts && x.is_finite())
}

fn state(t: &str) -> Option<ObjectState> {
    STATES.into_iter().find(|x| x.0 == t).map(|x| x.1)
}

fn size(t: &str) -> Option<SizeHint> {
    SIZES.into_iter().find(|x| x.0 == t).map(|x| x.1)
}

fn paint_wish(t: &str) -> Option<PaintWish> {
    match t.strip_prefix("not_") {
        Some(name) => paint(name).map(PaintWish::Not),
        None => paint(t).map(PaintWish::Is),
    }
}
