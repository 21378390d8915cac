//! Changes of a scene that words ask for: plain data with final geometry; the application turns them into its own edits.

use glam::{DVec2, DVec3};
use serde::Serialize;

use scene::{BoxId, BoxLabel, Conditions, SceneBox};

/// One change of a scene.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum TextEdit {
    /// Takes a box away.
    Remove {
        /// Which.
        id: BoxId,
    },
    /// Puts a box in; its id is free in the scene.
    Add {
        /// The box.
        object: SceneBox,
    },
    /// Moves or turns a box.
    Move {
        /// Which.
        id: BoxId,
        /// New centre, m.
        center_m: DVec3,
        /// New heading, rad.
        yaw_rad: f64,
    },
    /// Puts another class (with its size) in the place of a box.
    Replace {
        /// Which.
        id: BoxId,
        /// The new box, of the same id.
        object: SceneBox,
    },
    /// Names and paints a box.
    Label {
        /// Which.
        id: BoxId,
        /// Its name and paint from now on.
        label: BoxLabel,
    },
    /// Paints a pedestrian crossing.
    Crossing {
        /// Its corners, m.
        outline_m: Vec<DVec2>,
    },
    /// Takes a pedestrian crossing away.
    EraseCrossing {
        /// Its corners, m.
        outline_m: Vec<DVec2>,
    },
    /// Sets light and air.
    Conditions {
        /// The new ones.
        conditions: Conditions,
    },
    /// Sets the text that describes the style.
    Style {
        /// `night, rain`.
        prompt: String,
    },
}
