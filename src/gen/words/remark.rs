//! Requests that could not be met as stated, and decisions worth knowing: first as values, then as words for people.

use std::fmt;

use serde::Serialize;

use super::reading::Relation;

/// One remark on an act.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(tag = "remark", rename_all = "snake_case")]
pub enum Remark {
    /// No box of the scene fits.
    Nobody {
        /// The thing that was named.
        what: String,
    },
    /// The only one of its kind was taken, although not everything stated about it holds.
    OnlyOne {
        /// The thing that was named.
        what: String,
        /// Its place.
        place: String,
    },
    /// Fewer things fit than were named; the fitting ones were taken.
    TooFew {
        /// The thing that was named.
        what: String,
        /// Number of things that fit.
        found: usize,
        /// Number of things that were named.
        wanted: usize,
    },
    /// These were taken of several.
    Chosen {
        /// The things that were named.
        what: String,
        /// The ones taken: `nearest`, `farthest` or `first named`.
        which: &'static str,
    },
    /// Not all new things found room.
    LeftOut {
        /// Number of things that were placed.
        placed: usize,
        /// Number of things that were asked for.
        wanted: usize,
        /// The reason.
        why: String,
    },
    /// Relations that do not hold at the places found.
    Unmet {
        /// The relations.
        relations: Vec<&'static str>,
    },
    /// The thing was placed, but not at the stated distance.
    Off {
        /// Relation that the distance belongs to.
        relation: &'static str,
        /// Distance that was asked for, m.
        asked_m: f64,
        /// Distance that was found, m.
        found_m: f64,
    },
    /// The ego vehicle moves, although nothing else does.
    WeGoOn,
    /// A box finds no place at its destination and stays.
    NoRoom {
        /// Its id.
        id: u32,
    },
    /// A box would leave the scene and stays.
    Outside {
        /// Its id.
        id: u32,
    },
    /// Two boxes overlap now.
    Overlaps {
        /// The box that was placed.
        id: u32,
        /// The other; `None` is the ego vehicle.
        other: Option<u32>,
    },
    /// No distance was stated.
    DefaultStep {
        /// Distance that was taken, m.
        metres: f64,
    },
    /// There is no lane at the destination.
    NoLane {
        /// The box that stays.
        id: u32,
    },
    /// The request holds already.
    Already,
    /// Only a new scene can change it.
    NotInEdits {
        /// The part that would change.
        what: &'static str,
    },
    /// The road has no room for it.
    NoCrossing,
    /// The place that "there" refers to is unknown, because nothing was removed.
    NoSpot,
    /// A place that has no meaning here was ignored.
    PlaceIgnored {
        /// Relation of the place.
        relation: Relation,
    },
    /// A thing that an act changes was to stay.
    Spared {
        /// The thing.
        what: String,
    },
    /// Each thing can have only one motion in a scene: the last one counts.
    OneMotion {
        /// The thing.
        what: String,
    },
    /// A motion that is not possible.
    NoMotion {
        /// The reason.
        why: String,
    },
    /// The ego vehicle drives, although the text does not ask for it: the request needs it.
    EgoDrives,
    /// A thing that moves was not there before and was added.
    IsNew {
        /// The thing.
        what: String,
    },
    /// More was asked for than is carried out at once.
    TooMuch,
}

impl fmt::Display for Remark {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Nobody { what } => write!(f, "no {what} is in the scene"),
            Self::OnlyOne { what, place } => write!(f, "{what}: the only one was taken, {place}"),
            Self::TooFew { what, found, wanted } => write!(f, "{what}: {wanted} were named, {found} fit"),
            Self::Chosen { what, which } => write!(f, "of the {what} the {which} were taken"),
            Self::LeftOut { placed, wanted, why } => write!(f, "{placed} of {wanted} were placed: {why}"),
            Self::Unmet { relations } => {
                let mut words: Vec<String> = relations.iter().map(|r| r.replace('_', " ")).collect();
                words.dedup();
                write!(f, "not everything said could be met: {}", words.join(", "))
            }
            Self::Off {
                relation,
                asked_m,
                found_m,
            } => write!(
                f,
                "{}: {found_m} m in place of {asked_m} m",
                relation.replace('_', " ")
            ),
            Self::WeGoOn => write!(f, "we ourselves go on"),
            Self::NoRoom { id } => write!(f, "box {id} finds no room there: not moved"),
            Self::Outside { id } => write!(
                f,
                "box {id} would leave the scene, which reaches 40 m from the ego vehicle: not moved"
            ),
            Self::Overlaps { id, other: Some(o) } => write!(f, "box {id} now overlaps box {o}"),
            Self::Overlaps { id, other: None } => write!(f, "box {id} now overlaps the ego vehicle"),
            Self::DefaultStep { metres } => write!(f, "no distance was said: moved by {metres} m"),
            Self::NoLane { id } => write!(f, "no lane is there for box {id}: not moved"),
            Self::Already => write!(f, "it is so already"),
            Self::NotInEdits { what } => write!(f, "{what} stays: only a new scene can change it"),
            Self::NoCrossing => write!(f, "the road has no room for a crossing there"),
            Self::NoSpot => write!(f, "where \"there\" is was not said"),
            Self::PlaceIgnored { relation } => {
                write!(f, "{} means nothing here", relation.name().replace('_', " "))
            }
            Self::Spared { what } => write!(f, "{what} was said to stay, and is changed"),
            Self::OneMotion { what } => {
                write!(f, "{what}: one motion each, the last one counts")
            }
            Self::NoMotion { why } => write!(f, "{why}"),
            Self::EgoDrives => write!(f, "we drive along our lane at 36 km/h"),
            Self::IsNew { what } => write!(f, "the {what} is new"),
            Self::TooMuch => write!(f, "more was asked for than is carried out at once"),
        }
    }
}
