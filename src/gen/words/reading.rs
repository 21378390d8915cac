//! Requests of a sentence to a scene, as plain values: the same from every reader. Nothing here knows a scene. The JSON
//! of these types has a published schema (`sceneloom prompt --schema`); `notation` is their one-line form.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::beside::SceneryClause;
use super::named::named;
use super::nouns::Noun;
use place::beside_road::TextSpan;
use place::description::{Density, Environment, Road};
use scene::clip::Manoeuvre;
use scene::graph::{LaneRole, ObjectState, SizeHint};
use scene::{Paint, TimeOfDay, Weather};

/// All requests of a text, in order.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Reading {
    /// Changes of objects, road and light.
    pub acts: Vec<Act>,
    /// Requests about buildings, trees and other things beside the road.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub background: Vec<SceneryClause>,
}

impl Reading {
    /// A reading of these acts, without requests about things beside the road.
    pub fn of(acts: Vec<Act>) -> Self {
        Self {
            acts,
            background: Vec::new(),
        }
    }

    /// True if it asks for nothing.
    pub fn is_empty(&self) -> bool {
        self.acts.is_empty() && self.background.is_empty()
    }
}

/// One thing to do.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Act {
    /// The kind of act.
    #[serde(flatten)]
    pub what: ActKind,
    /// Bytes of the text that say it, if the reader knows them.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub span: Option<TextSpan>,
    /// How sure the reader is, 0 to 1: the learned one is as sure as of the symbol it is least sure of.
    #[serde(default = "sure", skip_serializing_if = "is_sure")]
    pub confidence: f64,
}

fn sure() -> f64 {
    1.0
}

fn is_sure(x: &f64) -> bool {
    *x >= 1.0
}

impl From<ActKind> for Act {
    fn from(what: ActKind) -> Self {
        Self {
            what,
            span: None,
            confidence: 1.0,
        }
    }
}

/// A kind of act.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(tag = "act", rename_all = "snake_case")]
pub enum ActKind {
    /// New things.
    Add {
        /// Which.
        things: Vec<ObjectPhrase>,
    },
    /// There shall be none of these.
    No {
        /// The things.
        who: Vec<ObjectPhrase>,
    },
    /// These go.
    Remove {
        /// Which.
        who: Vec<ObjectPhrase>,
    },
    /// All but these go.
    Keep {
        /// Which stay.
        who: Vec<ObjectPhrase>,
    },
    /// These stay as they are; an empty list is all that is not spoken of.
    Leave {
        /// Which.
        who: Vec<ObjectPhrase>,
    },
    /// New things stand where these are.
    Replace {
        /// Which go.
        who: Vec<ObjectPhrase>,
        /// Which come.
        things: Vec<ObjectPhrase>,
    },
    /// These go elsewhere.
    Move {
        /// Which.
        who: Vec<ObjectPhrase>,
        /// Where to.
        to: Destination,
    },
    /// These are turned.
    Turn {
        /// Which.
        who: Vec<ObjectPhrase>,
        /// How.
        turn: Turn,
    },
    /// These get other traits.
    Set {
        /// Which.
        who: Vec<ObjectPhrase>,
        /// New traits.
        #[serde(rename = "look")]
        traits: Traits,
    },
    /// So many of these there shall be.
    Count {
        /// The things.
        who: Vec<ObjectPhrase>,
        /// How many.
        amount: Amount,
    },
    /// Two change places.
    Swap {
        /// One.
        one: Box<ObjectPhrase>,
        /// The other.
        other: Box<ObjectPhrase>,
    },
    /// Things that move in the course of time.
    Go {
        /// The things that move; the ego vehicle if the list is empty.
        #[serde(default, skip_serializing_if = "Vec::is_empty")]
        who: Vec<ObjectPhrase>,
        /// How.
        how: Manoeuvre,
    },
    /// So long the scene lasts.
    Length {
        /// Seconds.
        seconds: f64,
    },
    /// Time of day.
    Time {
        /// Which.
        what: TimeOfDay,
    },
    /// Weather.
    Weather {
        /// Which.
        what: Weather,
    },
    /// Kind of road.
    Road {
        /// Which.
        what: Road,
    },
    /// Surroundings.
    Env {
        /// Which.
        what: Environment,
    },
    /// How busy it is.
    Density {
        /// Which.
        what: Density,
    },
    /// The road has it.
    Has {
        /// The part of a road.
        what: Feature,
        /// Its places.
        #[serde(default, skip_serializing_if = "Vec::is_empty")]
        places: Vec<PlacePhrase>,
    },
    /// The road has none.
    Lacks {
        /// The part of a road.
        what: Feature,
    },
    /// Lanes in both directions together.
    Lanes {
        /// How many.
        n: u32,
    },
    /// Traffic in our direction only.
    OneWay,
    /// A narrow road.
    Narrow,
    /// A wide road.
    Wide,
    /// The lane that the ego vehicle drives in, of those of its direction.
    OwnLane {
        /// Which.
        what: LaneSide,
    },
}

impl ActKind {
    /// Visits the things that the act is about, those that it changes first; the anchors of their places are left out.
    pub fn things(&self, visit: &mut dyn FnMut(&ObjectPhrase)) {
        match self {
            Self::Add { things } => things.iter().for_each(visit),
            Self::No { who }
            | Self::Remove { who }
            | Self::Keep { who }
            | Self::Leave { who }
            | Self::Move { who, .. }
            | Self::Turn { who, .. }
            | Self::Count { who, .. }
            | Self::Go { who, .. } => who.iter().for_each(visit),
            Self::Replace { who, things } => who.iter().chain(things).for_each(visit),
            Self::Set { who, traits } => {
                let of = traits.paint_of.as_deref();
                who.iter().chain(of).for_each(visit);
            }
            Self::Swap { one, other } => [&**one, &**other].into_iter().for_each(visit),
            _ => {}
        }
    }
}

named!(
    /// Parts of a road.
    Feature { Crossing = "crossing", Sidewalk = "sidewalk" }
);
named!(
    /// One of the lanes of a direction.
    LaneSide { Left = "left", Right = "right", Middle = "middle" }
);
named!(
    /// Which one of several, seen from the ego vehicle.
    Pick {
        Nearest = "nearest", Farthest = "farthest", Leftmost = "leftmost", Rightmost = "rightmost",
        Frontmost = "frontmost", Rearmost = "rearmost", Largest = "largest", Smallest = "smallest",
    }
);
named!(
    /// How a thing stands to another, or to a part of the road.
    Relation {
        There = "there", Like = "like", InLine = "in_line", SideBySide = "side_by_side", On = "on",
        Blocking = "blocking", Crossing = "crossing", Waiting = "waiting", Between = "between",
        Following = "following", Ahead = "ahead", Behind = "behind", Left = "left", Right = "right",
        NextTo = "next_to", Near = "near", Far = "far", At = "at", Across = "across", Oncoming = "oncoming",
        SameWay = "same_way", Facing = "facing", FacingAway = "facing_away",
    }
);
named!(
    /// A direction to move in, as the ego vehicle sees it.
    Way { Left = "left", Right = "right", Forward = "forward", Back = "back", Nearer = "nearer", Away = "away" }
);

/// How many.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Quantity {
    /// Not said.
    #[default]
    Unsaid,
    /// A certain one: "the car".
    The,
    /// So many certain ones: "the two cars".
    TheN(u32),
    /// Every thing that fits, without a number.
    All,
    /// In an anchor: each of the things that fit has its own: "a worker behind each bus".
    Each,
    /// Half of those that fit.
    Half,
    /// A few.
    Some,
    /// A lot.
    Many,
    /// So many, whichever.
    N(u32),
    /// At least and at most so many.
    Range(u32, u32),
}

impl Quantity {
    /// True if it means specific things, not any of a kind.
    pub fn is_certain(self) -> bool {
        matches!(self, Self::The | Self::TheN(_))
    }

    /// True if it means something that is there, or was named before.
    pub fn is_definite(self) -> bool {
        matches!(
            self,
            Self::The | Self::TheN(_) | Self::All | Self::Each | Self::Half
        )
    }
}

/// A paint, or any but one.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum PaintWish {
    /// The given paint.
    Is(Paint),
    /// Any other.
    Not(Paint),
}

/// Things, new ones or some that are there.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct ObjectPhrase {
    /// Their kind.
    pub noun: Noun,
    /// How many.
    #[serde(default, skip_serializing_if = "is_unsaid")]
    pub quantity: Quantity,
    /// Not those that were spoken of before.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub other: bool,
    /// Which of several.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub pick: Option<Pick>,
    /// The first, the second (1, 2, ...) seen from the ego vehicle; 0 is the last.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub nth: Option<u32>,
    /// Smaller or larger than usual.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub size: Option<SizeHint>,
    /// Their state: moving, parked or waiting.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub state: Option<ObjectState>,
    /// Their paint.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub paint: Option<PaintWish>,
    /// The number of a box of the scene.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub id: Option<u32>,
    /// Their places.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub places: Vec<PlacePhrase>,
    /// Things that are excluded.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub except: Vec<ObjectPhrase>,
}

fn is_unsaid(q: &Quantity) -> bool {
    *q == Quantity::Unsaid
}

impl ObjectPhrase {
    /// A thing of which only the kind is stated.
    pub fn new(noun: Noun) -> Self {
        Self {
            noun,
            quantity: Quantity::Unsaid,
            other: false,
            pick: None,
            nth: None,
            size: None,
            state: None,
            paint: None,
            id: None,
            places: Vec::new(),
            except: Vec::new(),
        }
    }

    /// The thing in another quantity.
    pub fn with(mut self, quantity: Quantity) -> Self {
        self.quantity = quantity;
        self
    }
}

/// Where something is.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct PlacePhrase {
    /// How it stands.
    pub relation: Relation,
    /// To what.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub to: Option<AnchorPhrase>,
    /// The second one of `between`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub and: Option<AnchorPhrase>,
    /// How far, m.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub metres: Option<f64>,
}

/// Reference of a place.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum AnchorPhrase {
    /// The ego vehicle.
    Ego,
    /// A pedestrian crossing.
    Crossing,
    /// A junction.
    Junction,
    /// A lane or strip.
    Lane(LaneRole),
    /// The other side of the road than where it is.
    OtherSide,
    /// The other lane than where it is.
    OtherLane,
    /// The others of the same group.
    EachOther,
    /// A thing: there, named before, or new if it has a number.
    Thing(Box<ObjectPhrase>),
}

/// Where something moves.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Destination {
    /// To where this holds.
    To(Vec<PlacePhrase>),
    /// That way.
    By {
        /// Which.
        way: Way,
        /// How far, m.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        metres: Option<f64>,
    },
    /// So many lanes to the left; to the right if negative.
    Lanes(i32),
    /// So many times as far from the ego vehicle.
    Times(f64),
}

/// How something is turned.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Turn {
    /// Half a turn.
    Around,
    /// To the left, degrees; to the right if negative.
    Left(f64),
    /// Along its lane.
    Along,
    /// So that this holds.
    To(Vec<PlacePhrase>),
}

/// New traits of something: its look and its state from now on.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct Traits {
    /// Size.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub size: Option<SizeHint>,
    /// State: moving, parked or waiting.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub state: Option<ObjectState>,
    /// Paint.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub paint: Option<Paint>,
    /// The paint of another thing.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub paint_of: Option<Box<ObjectPhrase>>,
}

/// How many there shall be.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Amount {
    /// Between these.
    To(u32, u32),
    /// So many times as many.
    Times(f64),
}
