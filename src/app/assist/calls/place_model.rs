//! `place_model`: an object out of a file of the folder, as a box of the scene.

use anyhow::anyhow;
use glam::DVec2;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::call::Operation;
use crate::desk::{Desk, Done};
use editor::EditError;
use editor::models::{self, ModelPlacement};
use formats::model;
use scene::{BoxId, Class};

/// Arguments of `place_model`.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct PlaceModel {
    /// File in the folder of this session: a glTF model (.glb, .gltf), a MagicaVoxel shape (.vox), or a scene (.loom).
    file: String,
    /// Number of the object's box, of a file that holds several.
    #[serde(default)]
    of: Option<BoxId>,
    /// Box of the scene that gets the shape and the size, in place of a new one.
    #[serde(default)]
    to: Option<BoxId>,
    /// Position, world frame, m; ahead of the ego vehicle if left out. The nearest free place is taken.
    #[serde(default)]
    at_m: Option<[f64; 2]>,
    /// Heading, degrees counter-clockwise from x; as the lane there if left out.
    #[serde(default)]
    heading_deg: Option<f64>,
}

/// Receipt of `place_model`.
#[derive(Debug, Serialize, JsonSchema)]
pub struct ModelPlaced {
    /// Changes of the scene.
    #[serde(flatten)]
    done: Done,
    /// Number of its box.
    #[serde(rename = "box")]
    box_id: BoxId,
    /// Its class.
    class: Class,
    /// Length, width, height, m.
    size_m: [f64; 3],
    /// Its middle, world frame, m.
    center_m: [f64; 3],
    /// Its heading, degrees counter-clockwise from x.
    heading_deg: f64,
    /// Voxels of its shape.
    shape_voxels: usize,
}

impl Operation for PlaceModel {
    const NAME: &'static str = "place_model";
    const ABOUT: &'static str = "Puts an object out of a file (a glTF model, a MagicaVoxel shape, a box of another scene) into the scene as a box that keeps the shape of the model wherever it moves, or gives that shape to a box that is there. list_files tells what is there.";
    const EXAMPLE: &'static str = r#"{"file": "a.loom", "of": 1, "at_m": [14, -5]}"#;
    const CHANGES: bool = true;
    type Receipt = ModelPlaced;

    fn run(self, desk: &mut Desk) -> anyhow::Result<ModelPlaced> {
        let path = desk.folder.existing(&self.file)?;
        let model = model::read(&path, self.of)?;
        let scene = desk.scene()?;
        let placed = match self.to {
            Some(id) => {
                let b = scene.frame().boxes.get(&id).ok_or(EditError::UnknownBox { id })?;
                ModelPlacement {
                    edits: models::give(&model, b),
                    id,
                }
            }
            None => {
                let at_m = self.at_m.map(DVec2::from);
                let at_m = at_m.unwrap_or_else(|| models::ahead_m(&scene, &model));
                models::place(&scene, &model, at_m, self.heading_deg)
                    .map_err(|problem| anyhow!("{}: {problem}", self.file))?
            }
        };
        let step = format!("Place {}", self.file);
        let done = desk.apply(step, placed.edits)?;
        let scene = desk.scene()?;
        let b = scene.frame().boxes.get(&placed.id);
        let b = b.ok_or(EditError::UnknownBox { id: placed.id })?;
        Ok(ModelPlaced {
            done,
            box_id: b.id,
            class: b.class,
            size_m: b.size_m.to_array(),
            center_m: b.center_m.to_array(),
            heading_deg: b.yaw_rad.to_degrees(),
            shape_voxels: model.cells.len(),
        })
    }
}
