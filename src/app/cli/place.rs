//! `sceneloom place`: an object out of another file, put into a scene or given to a box as its shape.

use std::path::PathBuf;

use anyhow::{Context, anyhow};
use glam::DVec2;
use serde_json::json;

use super::document;
use super::{CommandResult, Common, output};
use app::open;
use editor::Edit;
use editor::models::{self, ModelPlacement};
use formats::model;
use scene::{BoxId, Scene};

/// Arguments.
#[derive(clap::Args)]
pub struct PlaceArgs {
    /// File that holds the object: .glb, .gltf, .vox, .loom or another that becomes a scene.
    model: PathBuf,
    /// Scene that gets it.
    scene: PathBuf,
    /// Number of the object's box, of a file that holds several.
    #[arg(long, value_name = "ID")]
    of: Option<u32>,
    /// Box of the scene that gets the shape and the size, in place of a new one.
    #[arg(long, value_name = "ID", conflicts_with_all = ["at", "heading"])]
    to: Option<u32>,
    /// Position, world frame, m; without it ahead of the ego vehicle. The nearest free place is taken.
    #[arg(long, value_name = "X,Y", value_parser = super::import::point, allow_hyphen_values = true)]
    at: Option<DVec2>,
    /// Heading, degrees counter-clockwise from x; without it as the lane there.
    #[arg(long, value_name = "DEG", allow_hyphen_values = true)]
    heading: Option<f64>,
    /// Scene to write.
    #[arg(short, long, value_name = "S.loom")]
    output: PathBuf,
    #[command(flatten)]
    common: Common,
}

impl PlaceArgs {
    pub(super) fn run(self) -> CommandResult {
        if self.heading.is_some_and(|heading| !heading.is_finite()) {
            return Err(anyhow!("--heading is not a finite angle in degrees").into());
        }
        let model = model::read(&self.model, self.of.map(BoxId))?;
        let scene = open::scene(&self.scene)?;
        let placed = self.placed(&scene, &model)?;
        let mut document = document::opened(scene);
        document.apply_all("Place a model", &placed.edits)?;
        document::save(&self.output, &document)?;
        let scene = document.scene();
        let b = scene
            .frame()
            .boxes
            .get(&placed.id)
            .context("the model was not placed")?;
        let report = json!({
            "box": b.id.0,
            "class": b.class.name(),
            "center_m": b.center_m.to_array(),
            "size_m": b.size_m.to_array(),
            "heading_deg": b.yaw_rad.to_degrees(),
            "voxels": model.cells.len(),
            "file": self.output,
        });
        output::report(&self.common, &report, || {
            let [x, y, _] = b.center_m.to_array();
            format!(
                "{}: box {}, {}, {} voxels, at {x:.1}, {y:.1} m",
                self.output.display(),
                b.id.0,
                b.called(),
                model.cells.len()
            )
        });
        Ok(())
    }

    fn placed(&self, scene: &Scene, model: &scene::Model) -> anyhow::Result<ModelPlacement> {
        if let Some(id) = self.to.map(BoxId) {
            let b = scene.frame().boxes.get(&id);
            let b = b.ok_or(editor::EditError::UnknownBox { id })?;
            let edits: Vec<Edit> = models::give(model, b);
            return Ok(ModelPlacement { edits, id });
        }
        let at_m = self.at.unwrap_or_else(|| models::ahead_m(scene, model));
        models::place(scene, model, at_m, self.heading)
            .map_err(|problem| anyhow!("{}: {problem}", self.scene.display()))
    }
}
