//! What could not be done as it was said, and decisions worth knowing: values first, words for people last.

use std::fmt;

use serde::Serialize;

use super::reading::Relation;

/// One remark on an act.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(tag = "remark", rename_all = "snake_case")]
pub enum Remark {
    /// Nothing of the scene fits.
    Nobody {
        /// What was named.
        what: String,
    },
    /// The only one of its kind was taken, though not all that was said of it holds.
    OnlyOne {
        /// What was named.
        what: String,
        /// Where it stands.
        place: String,
    },
    /// Fewer fit than were named; those were taken.
    TooFew {
        /// What was named.
        what: String,
        /// That fit.
        found: usize,
        /// That were named.
        wanted: usize,
    },
    /// Of several those were taken.
    Chosen {
        /// What was named.
        what: String,
        /// Which.
        which: &'static str,
    },
    /// Not all new things found room.
    LeftOut {
        /// Placed.
        placed: usize,
        /// Asked for.
        wanted: usize,
        /// Why.
        why: String,
    },
    /// Relations that do not hold where the things stand now.
    Unmet {
        /// Which.
        relations: Vec<&'static str>,
    },
    /// It stands, and not as far away as was said.
    Off {
        /// What the distance is of.
        relation: &'static str,
        /// As it was said, m.
        asked_m: f64,
        /// As it is, m.
        found_m: f64,
    },
    /// The ego vehicle moves, though nobody else does.
    WeGoOn,
    /// A box finds no place there and stays.
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
        /// The one that came.
        id: u32,
        /// The other; `None` is the ego vehicle.
        other: Option<u32>,
    },
    /// No distance was said.
    DefaultStep {
        /// What was taken, m.
        metres: f64,
    },
    /// No lane is there.
    NoLane {
        /// The box that stays.
        id: u32,
    },
    /// It is so already.
    Already,
    /// Only a new scene can change it.
    NotInEdits {
        /// What.
        what: &'static str,
    },
    /// The road has no room for it.
    NoCrossing,
    /// What was taken away stands nowhere.
    NoSpot,
    /// What was said of the place has no meaning here.
    PlaceIgnored {
        /// Which relation.
        relation: Relation,
    },
    /// A thing that an act changes was said to stay.
    Spared {
        /// What.
        what: String,
    },
    /// Something can do one thing only in the course of a scene: the last that was said.
    OneMotion {
        /// What.
        what: String,
    },
    /// A motion that cannot be.
    NoMotion {
        /// Why.
        why: String,
    },
    /// The ego vehicle drives, though nobody said so: what was asked for needs it.
    EgoDrives,
    /// Somebody moves who was not there before.
    IsNew {
        /// Who.
        what: String,
    },
    /// More than is carried out.
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
