//! Clauses of a sentence about scenery: plain values, a part of a `Reading` (in `words`) and of its JSON Schema.

use std::fmt;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use scene::background::{LineKind, PostKind, TreeKind};
use world::scenery::RoadsideKind;

/// Bytes `start..end` of a text.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize, JsonSchema)]
pub struct TextSpan {
    /// First byte.
    pub start: usize,
    /// One past the last byte.
    pub end: usize,
}

impl TextSpan {
    /// The span from the first byte of this one to the last byte of the other.
    pub fn to(self, other: Self) -> Self {
        Self {
            start: self.start.min(other.start),
            end: self.end.max(other.end),
        }
    }

    /// The text it names; empty if it does not fit.
    pub fn of(self, text: &str) -> &str {
        text.get(self.start..self.end).unwrap_or("")
    }
}

/// A kind of thing that stands beside the road.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum SceneryKind {
    /// Buildings, of a kind of place if the word says so: a warehouse is industry.
    Building(Option<RoadsideKind>),
    /// Trees, of a kind if the word says so.
    Tree(Option<TreeKind>),
    /// Bushes and undergrowth.
    Shrubs,
    /// A hedge, wall, fence or rail.
    Line(LineKind),
    /// A pole, sign, lamp, stop, bench or bin.
    Post(PostKind),
    /// A kind of place: a forest.
    Place(RoadsideKind),
    /// Trees, shrubs and hedges.
    Plants,
    /// Any thing; only with its number.
    Thing,
}

/// Kind of request.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Verb {
    /// Be there, in a description.
    #[default]
    Have,
    /// Come.
    Add,
    /// Go; in a description: not be there.
    Remove,
    /// Become higher.
    Raise,
    /// Become lower.
    Lower,
    /// Become as is said next; only while reading.
    #[serde(skip)]
    Make,
    /// Go elsewhere.
    Move,
}

/// A side of the ego's road.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum SideOf {
    /// Left of it.
    Left,
    /// Right of it.
    Right,
}

/// Place that something is near to.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum NearTo {
    /// A pedestrian crossing.
    Crossing,
    /// A junction.
    Junction,
    /// The ego vehicle.
    Ego,
}

/// Place of things, as far as it was stated.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct Where {
    /// Which side of the ego's road; none is either.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub side: Option<SideOf>,
    /// Ahead of the ego vehicle (true) or behind it.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub ahead: Option<bool>,
    /// How far ahead, behind, or from what it is near to, m.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub distance_m: Option<f64>,
    /// Near to what.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub near: Option<NearTo>,
    /// All along the road.
    #[serde(skip_serializing_if = "std::ops::Not::not")]
    pub along: bool,
}

/// How high, or by how much.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Amount {
    /// So many storeys.
    Storeys(f64),
    /// So many metres.
    Metres(f64),
}

/// One clause about what stands beside the road.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct SceneryClause {
    /// The request.
    pub verb: Verb,
    /// The things.
    pub what: SceneryKind,
    /// Number of a thing: `tree #12`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub id: Option<u32>,
    /// All of them, or a kind as a whole.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub plural: bool,
    /// "The": one or those that are there already.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub definite: bool,
    /// A number of things.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub count: Option<u32>,
    /// A row of them.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub row: bool,
    /// Nearest (true) or furthest.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub nearest: Option<bool>,
    /// Many (true) or few.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub dense: Option<bool>,
    /// Tall (true) or low.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub tall: Option<bool>,
    /// The height that they have or get.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub height: Option<Amount>,
    /// By how much they change, or move.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub by: Option<Amount>,
    /// Way of a move in the ego frame: forward and to the left, together of length 1.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub way: Option<(f64, f64)>,
    /// Their place.
    #[serde(default)]
    pub place: Where,
    /// Bytes of the text, if the reader knows them.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub span: Option<TextSpan>,
}

impl SceneryClause {
    /// A clause of only a request and its things.
    pub fn new(verb: Verb, what: SceneryKind) -> Self {
        Self {
            verb,
            what,
            id: None,
            plural: false,
            definite: false,
            count: None,
            row: false,
            nearest: None,
            dense: None,
            tall: None,
            height: None,
            by: None,
            way: None,
            place: Where::default(),
            span: None,
        }
    }

    /// The reason why it cannot be carried out, for values from outside the program; `None` if it can.
    pub fn problem(&self) -> Option<&'static str> {
        let lengths = [self.height, self.by].into_iter().flatten().map(|a| match a {
            Amount::Storeys(n) => n * 3.0,
            Amount::Metres(m) => m,
        });
        let far = |m: f64| !(0.0..=1000.0).contains(&m);
        match () {
            () if self.what == SceneryKind::Thing && self.id.is_none() => Some("a thing without its number"),
            () if self.count.is_some_and(|n| n > 500) => Some("a count above 500"),
            () if lengths.into_iter().chain(self.place.distance_m).any(far) => {
                Some("a length that is not between 0 and 1000 m")
            }
            () if self.verb == Verb::Move && (self.by.is_none() || self.way.is_none()) => {
                Some("a move without length or way")
            }
            () if self.way.is_some_and(|w| (w.0.hypot(w.1) - 1.0).abs() > 0.01) => {
                Some("a way whose length is not 1")
            }
            () => None,
        }
    }

    /// Its things without article and place: `dense trees`, `tree #12`.
    fn bare(&self) -> String {
        let noun = match self.what {
            SceneryKind::Building(None) => "building".to_owned(),
            SceneryKind::Building(Some(of)) => match of {
                RoadsideKind::Suburb => "house".into(),
                RoadsideKind::OldTown => "old house".into(),
                RoadsideKind::Country => "farm".into(),
                RoadsideKind::Industry => "warehouse".into(),
                RoadsideKind::Retail => "shop".into(),
                _ => "city building".into(),
            },
            SceneryKind::Tree(None) => "tree".into(),
            SceneryKind::Tree(Some(TreeKind::Conifer)) => "conifer".into(),
            SceneryKind::Tree(Some(TreeKind::Columnar)) => "poplar".into(),
            SceneryKind::Tree(Some(TreeKind::Bare)) => "bare tree".into(),
            SceneryKind::Tree(Some(TreeKind::Broadleaf)) => "broadleaf tree".into(),
            SceneryKind::Shrubs => "shrubs".into(),
            SceneryKind::Line(kind) => kind.name().replace('_', " "),
            SceneryKind::Post(kind) => kind.name().replace('_', " "),
            SceneryKind::Place(of) => of.label().to_lowercase(),
            SceneryKind::Plants => "greenery".into(),
            SceneryKind::Thing => "thing".into(),
        };
        let noun = match self.is_many() && !self.is_mass() {
            true if noun.ends_with("ch") || noun.ends_with('s') => format!("{noun}es"),
            true => format!("{noun}s"),
            false => noun,
        };
        let mut words: Vec<String> = Vec::new();
        words.extend(
            self.nearest
                .map(|n| if n { "nearest" } else { "farthest" }.into()),
        );
        words.extend(self.count.map(|n| n.to_string()));
        words.extend(self.dense.map(|d| if d { "dense" } else { "sparse" }.into()));
        words.extend(self.tall.map(|t| if t { "tall" } else { "low" }.into()));
        words.push(noun);
        words.extend(self.id.map(|id| format!("#{id}")));
        words.join(" ")
    }

    fn is_mass(&self) -> bool {
        matches!(
            self.what,
            SceneryKind::Shrubs | SceneryKind::Plants | SceneryKind::Place(_)
        )
    }

    fn is_many(&self) -> bool {
        self.plural || self.row || self.count.is_some_and(|n| n != 1)
    }

    /// Its things without their place: `dense trees`, `the tree #12`.
    pub fn things(&self) -> String {
        let things = self.bare();
        let (many, is_mass) = (self.is_many(), self.is_mass());
        match (self.row, self.definite || self.nearest.is_some()) {
            (true, true) => format!("the row of {things}"),
            (true, false) => format!("a row of {things}"),
            (false, true) => format!("the {things}"),
            (false, false) if many || is_mass || self.id.is_some() || self.count.is_some() => things,
            (false, false) if things.starts_with(['a', 'e', 'i', 'o', 'u']) => format!("an {things}"),
            (false, false) => format!("a {things}"),
        }
    }

    /// The clause as part of a new scene, in words: `no trees near the crossing`.
    pub fn described(&self) -> String {
        if self.verb == Verb::Remove {
            return format!("no {}{}", self.bare(), self.place());
        }
        let has = Self {
            verb: Verb::Have,
            ..self.clone()
        };
        has.to_string()
    }

    /// The place in words, with a space before it; empty if none was stated.
    pub fn place(&self) -> String {
        let place = &self.place;
        let mut out = String::new();
        let far = place
            .distance_m
            .map(|m| format!(" {} m", (m * 10.0).round() / 10.0));
        match (place.near, place.ahead) {
            (Some(near), _) => {
                let near = match near {
                    NearTo::Crossing => "the crossing",
                    NearTo::Junction => "the junction",
                    NearTo::Ego => "the ego vehicle",
                };
                out += &far.map_or_else(|| format!(" near {near}"), |m| format!(" within{m} of {near}"));
            }
            (None, Some(false)) => out += &format!("{} behind", far.unwrap_or_default()),
            (None, Some(true)) => out += &format!("{} ahead", far.unwrap_or_default()),
            (None, None) => out += &far.map_or_else(String::new, |m| format!("{m} ahead")),
        }
        if place.along && !self.row {
            out += " along the road";
        }
        match place.side {
            Some(SideOf::Left) => out += " on the left",
            Some(SideOf::Right) => out += " on the right",
            None => {}
        }
        out
    }
}

impl fmt::Display for SceneryClause {
    /// The request in words: `removes the trees on the left`.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (things, place) = (self.things(), self.place());
        let amount = |a: Amount| match a {
            Amount::Storeys(n) => format!("{n} {}", if n == 1.0 { "storey" } else { "storeys" }),
            Amount::Metres(m) => format!("{} m", (m * 10.0).round() / 10.0),
        };
        let high = self
            .height
            .map(|h| format!(", {} high", amount(h)))
            .unwrap_or_default();
        let by = self.by.map(|b| format!(" by {}", amount(b))).unwrap_or_default();
        match self.verb {
            Verb::Have | Verb::Make => write!(f, "{things}{place}{high}"),
            Verb::Add => write!(f, "adds {things}{place}{high}"),
            Verb::Remove => write!(f, "removes {things}{place}"),
            Verb::Raise if self.height.is_some() => write!(
                f,
                "makes {things}{place} {} high",
                amount(self.height.unwrap_or(Amount::Metres(0.0)))
            ),
            Verb::Raise => write!(f, "makes {things}{place} taller{by}"),
            Verb::Lower => write!(f, "makes {things}{place} lower{by}"),
            Verb::Move => {
                let way = match self.way {
                    Some((x, _)) if x > 0.5 => " forward",
                    Some((x, _)) if x < -0.5 => " back",
                    Some((_, y)) if y > 0.0 => " to the left",
                    _ => " to the right",
                };
                write!(f, "moves {things}{place}{by}{way}")
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_from_elsewhere_are_checked() {
        let tree = SceneryClause::new(Verb::Add, SceneryKind::Tree(None));
        assert_eq!(tree.problem(), None);
        let bad: [fn(&mut SceneryClause); 6] = [
            |s| s.what = SceneryKind::Thing,
            |s| s.count = Some(501),
            |s| s.height = Some(Amount::Storeys(1e9)),
            |s| s.place.distance_m = Some(-1.0),
            |s| s.verb = Verb::Move,
            |s| (s.by, s.way) = (Some(Amount::Metres(1.0)), Some((1e300, 0.0))),
        ];
        for (i, bad) in bad.iter().enumerate() {
            let mut said = tree.clone();
            bad(&mut said);
            assert!(said.problem().is_some(), "{i}");
        }
    }
}
