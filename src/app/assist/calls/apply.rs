//! `apply`: typed edits as one undo step.

use anyhow::bail;
use schemars::JsonSchema;
use serde::Deserialize;

use crate::call::Operation;
use crate::desk::{Desk, Done};
use authoring::text::with_conditions;
use editor::Edit;
use scene::message::quoted;

/// Edits of one call at most.
const MOST_EDITS: usize = 10_000;

/// Arguments of `apply`.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Apply {
    /// The edits, carried out in order: all of them, or none. Each is an object with one key, the kind of edit. All places are
    /// in the world frame (at the start of a scene the ego frame: x ahead, y left, z up, origin at the rear axle on the ground),
    /// in m; sizes are length, width, height; angles are degrees counter-clockwise from x.
    edits: Vec<Edit>,
    /// Name of the undo step.
    #[serde(default)]
    step: Option<String>,
}

impl Operation for Apply {
    const NAME: &'static str = "apply";
    const ABOUT: &'static str = "Applies typed edits as one undo step: put in, move, resize, relabel or remove boxes (vehicles, people, cones); paint map layers (drivable_area, ped_crossing, walkway, ...); add or remove trees, buildings and posts; paint voxels; set motions, length, weather, sensors. Sizes in m, length first; center_m is the middle of a box, so z is half its height on level ground. Voxels of what was edited are drafts until generate.";
    const EXAMPLE: &'static str = r#"{"edits": [{"add_box": {"class": "pedestrian", "center_m": [12, 3, 0.9], "size_m": [0.7, 0.7, 1.8], "yaw_deg": -90}}, {"paint_bev": {"layer": "ped_crossing", "shape": {"rect": {"min_m": [10, -6], "max_m": [14, 6]}}, "value": true}}]}"#;
    const CHANGES: bool = true;
    type Receipt = Done;

    fn run(self, desk: &mut Desk) -> anyhow::Result<Done> {
        let count = self.edits.len();
        if count == 0 || count > MOST_EDITS {
            bail!("edits holds {count} entries, expected 1 to {MOST_EDITS}");
        }
        let step = match &self.step {
            Some(step) if !step.trim().is_empty() => quoted(step.trim(), 60),
            _ if count == 1 => "Edit by an assistant".to_owned(),
            _ => format!("{count} edits by an assistant"),
        };
        let seed = desk.scene()?.conditions.seed;
        desk.apply(step, with_conditions(&self.edits, seed))
    }
}
