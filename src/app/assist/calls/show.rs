//! `show`: which moment of a scene that lasts is shown, edited and seen.

use anyhow::bail;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::call::Operation;
use crate::desk::Desk;

/// Arguments of `show`.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Show {
    /// Moment of the scene, s, from 0 to its length.
    time_s: f64,
}

/// Receipt of `show`.
#[derive(Debug, Serialize, JsonSchema)]
pub struct ShowReceipt {
    /// The moment that is shown now, s.
    time_s: f64,
    /// Length of the scene, s; 0 for one moment.
    length_s: f64,
    /// Where the ego vehicle is then, world frame: x and y in m, heading in degrees.
    ego: [f64; 3],
    /// Boxes that are there then.
    boxes: usize,
}

impl Operation for Show {
    const NAME: &'static str = "show";
    const ABOUT: &'static str = "Goes to another moment of a scene that lasts. Edits, render, check, state and export look at the moment that is shown. It is not an undo step.";
    const EXAMPLE: &'static str = r#"{"time_s": 0}"#;
    const CHANGES: bool = false;
    type Receipt = ShowReceipt;

    fn run(self, desk: &mut Desk) -> anyhow::Result<ShowReceipt> {
        let length_s = desk.scene()?.clip().length_s;
        // Written so that NaN fails too.
        if !(0.0..=length_s).contains(&self.time_s) {
            bail!("time_s is {}, expected 0 to {length_s} s", self.time_s);
        }
        let (_, [_, scene]) = desk.with(move |document| document.show(self.time_s))?;
        let frame = scene.frame();
        let pose = frame.world_from_ego;
        let ahead = pose.rotation * glam::DVec3::X;
        Ok(ShowReceipt {
            time_s: scene.time_s(),
            length_s,
            ego: [
                pose.translation_m.x,
                pose.translation_m.y,
                ahead.y.atan2(ahead.x).to_degrees(),
            ],
            boxes: frame.boxes.len(),
        })
    }
}
