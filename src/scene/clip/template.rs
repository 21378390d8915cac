//! Manoeuvres that have a name. The editor computes the motion of one, because it knows the lanes.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::Class;

/// A way to move.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Template {
    /// Along its lane at a steady speed.
    Drive,
    /// Along its lane behind whoever is ahead, at their distance.
    Follow,
    /// Along its lane, then to a stop that begins at the time asked for.
    Stop,
    /// Along its lane, then into the lane of the ego vehicle, or the next one.
    CutIn,
    /// Straight across the road from where it stands.
    Cross,
    /// From the side of the road into the lane.
    PullOut,
    /// From the lane to the side of the road.
    Park,
    /// Along its lane to the next street on the left, and into it.
    TurnLeft,
    /// Along its lane to the next street on the right, and into it.
    TurnRight,
}

impl Template {
    /// Every template.
    pub const ALL: [Template; 9] = [
        Template::Drive,
        Template::Follow,
        Template::Stop,
        Template::CutIn,
        Template::Cross,
        Template::PullOut,
        Template::Park,
        Template::TurnLeft,
        Template::TurnRight,
    ];

    /// Its name in files and in the notation of words.
    pub fn name(self) -> &'static str {
        match self {
            Self::Drive => "drive",
            Self::Follow => "follow",
            Self::Stop => "stop",
            Self::CutIn => "cut_in",
            Self::Cross => "cross",
            Self::PullOut => "pull_out",
            Self::Park => "park",
            Self::TurnLeft => "turn_left",
            Self::TurnRight => "turn_right",
        }
    }

    /// Its name for a person.
    pub fn title(self) -> &'static str {
        match self {
            Self::Drive => "Drive along the lane",
            Self::Follow => "Follow the one ahead",
            Self::Stop => "Stop",
            Self::CutIn => "Cut in",
            Self::Cross => "Cross the road",
            Self::PullOut => "Pull out",
            Self::Park => "Park",
            Self::TurnLeft => "Turn left",
            Self::TurnRight => "Turn right",
        }
    }

    /// True if its main action begins at a moment of its own.
    pub fn has_a_moment(self) -> bool {
        !matches!(
            self,
            Self::Drive | Self::Follow | Self::TurnLeft | Self::TurnRight
        )
    }

    /// Its description in a sentence.
    pub fn hint(self) -> &'static str {
        match self {
            Self::Drive => "Along its lane at a steady speed",
            Self::Follow => "Along its lane; keeps its distance to whoever is ahead, and stops behind them",
            Self::Stop => "Along its lane; brakes gently to a stop from the chosen time on",
            Self::CutIn => {
                "Along its lane; from the chosen time on it changes into ours, or into the next lane"
            }
            Self::Cross => "Waits until the chosen time, then goes straight across the road",
            Self::PullOut => "Stands until the chosen time, then drives off into the lane",
            Self::Park => "Along its lane; from the chosen time on it slows down and stops at the side",
            Self::TurnLeft => "Along its lane; slows down and turns into the next street on the left",
            Self::TurnRight => "Along its lane; slows down and turns into the next street on the right",
        }
    }
}

impl Template {
    /// The usual speed of a class in it, m/s; of the ego vehicle if none.
    pub fn usual_mps(class: Option<Class>) -> f64 {
        match class {
            Some(Class::Pedestrian) => 1.5,
            Some(Class::Bicycle) => 5.0,
            _ => 10.0,
        }
    }
}

/// How fast, where no number says it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Pace {
    /// Slower than usual.
    Slow,
    /// Faster than usual: who walks runs.
    Fast,
}

impl Pace {
    /// Times the usual speed.
    pub fn factor(self) -> f64 {
        match self {
            Self::Slow => 0.5,
            Self::Fast => 1.8,
        }
    }
}

/// A manoeuvre as words ask for it.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Manoeuvre {
    /// Which.
    pub what: Template,
    /// When it begins, s.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub from_s: Option<f64>,
    /// It begins when so much is between it and the ego vehicle, m, bumper to bumper; who follows keeps so much to the one ahead.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub gap_m: Option<f64>,
    /// Speed, km/h.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub kmh: Option<f64>,
    /// How fast, where no speed was said.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub pace: Option<Pace>,
}

impl Manoeuvre {
    /// This manoeuvre as a continuation of another: it takes over the other's speed where it has none of its own. The
    /// flag is false if more of the other than its speed is lost.
    pub fn after(mut self, before: &Self) -> (Self, bool) {
        if self.kmh.is_none() && self.pace.is_none() {
            (self.kmh, self.pace) = (before.kmh, before.pace);
        }
        let is_a_speed = matches!(before.what, Template::Drive | Template::Follow) && before.from_s.is_none();
        (self, is_a_speed && before.gap_m.is_none())
    }

    /// A manoeuvre without time, distance or speed.
    pub fn from_template(what: Template) -> Self {
        Self {
            what,
            from_s: None,
            gap_m: None,
            kmh: None,
            pace: None,
        }
    }
}
