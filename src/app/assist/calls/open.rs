//! `open`: a scene from a file of the folder.

use anyhow::{Context, bail};
use glam::DVec2;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::call::Operation;
use crate::desk::{Desk, Done};
use authoring::again::again;
use authoring::open::{self, Placement};
use authoring::read;
use formats::import::{self, Content, ImportOptions};

/// Arguments of `open`.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct OpenCall {
    /// File in the folder of this session, such as `a.loom`, `road.xodr` or `labels.npz`; without it the scene that ships with
    /// the program.
    #[serde(default)]
    file: Option<String>,
    /// For a road file: position of the ego vehicle in the file's frame, m; a good place on a lane if left out.
    #[serde(default)]
    at_m: Option<[f64; 2]>,
    /// For a road file: heading of the ego vehicle, degrees counter-clockwise from x; along the lane if left out.
    #[serde(default)]
    heading_deg: Option<f64>,
    /// For a road file: length and width of the map, m; 80 x 80 if left out.
    #[serde(default)]
    size_m: Option<[f64; 2]>,
    /// For a point cloud: height by which it is lifted, m, 0 for not at all; if left out, a sweep whose ground lies
    /// beside the map is lifted onto it, and `notes` says by how much.
    #[serde(default)]
    lift_m: Option<f64>,
    /// For voxels of a data set: true to take them to those of the networks, 0.4 m and 16 bins, in place of their own.
    #[serde(default)]
    resample: bool,
}

/// Receipt of `open`.
#[derive(Debug, Serialize, JsonSchema)]
pub struct OpenReceipt {
    /// Changes of the scene.
    #[serde(flatten)]
    done: Done,
    /// Name of the scene.
    name: String,
    /// Format of the file.
    format: String,
    /// Boxes in it.
    boxes: usize,
    /// Things beside the road.
    things: usize,
    /// How long it lasts, s; 0 for one moment.
    length_s: f64,
    /// Notes on adjustments of the content that were not asked for.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    notes: Vec<String>,
}

impl Operation for OpenCall {
    const NAME: &'static str = "open";
    const ABOUT: &'static str = "Replaces the scene by one from a file: a project (.loom), roads (.xodr), occupancy labels (.npz), a picture that this program made (.png), or another format that is read. It can be undone. list_files tells what is there.";
    const EXAMPLE: &'static str = r#"{"file": "a.loom"}"#;
    const CHANGES: bool = true;
    type Receipt = OpenReceipt;

    fn run(self, desk: &mut Desk) -> anyhow::Result<OpenReceipt> {
        let from = desk.scene()?.content();
        let placement = Placement {
            at_m: self.at_m.map(DVec2::from),
            heading_rad: self.heading_deg.map(f64::to_radians),
            size_m: self.size_m,
            ..Placement::default()
        };
        let said = [
            self.at_m.is_some(),
            self.heading_deg.is_some(),
            self.size_m.is_some(),
        ];
        let mut notes = Vec::new();
        let options = ImportOptions {
            lift_m: self.lift_m,
            resample: self.resample,
        };
        let (scene, format) = match &self.file {
            None if options != ImportOptions::default() => {
                bail!("lift_m and resample are for files, expected one")
            }
            None => (open::bundled()?, "loom"),
            Some(file) => {
                let path = desk.folder.existing(file)?;
                let (importer, content) = read::file_with(&path, options)?;
                let scene = match content {
                    Content::Scene(_) | Content::Recipe(_) if said.contains(&true) => {
                        bail!("{file}: a scene; at_m, heading_deg and size_m are for road files")
                    }
                    Content::Scene(loaded) => {
                        notes = loaded.notes;
                        loaded.scene
                    }
                    Content::Recipe(recipe) => again(&recipe).with_context(|| file.clone())?,
                    Content::Roads(network) => {
                        if let Some(problem) = placement.problem_on(&network) {
                            bail!("{file}: {problem}");
                        }
                        open::on_roads(*network, &import::scene_name(&path), &placement).scene
                    }
                };
                (scene, importer.id)
            }
        };
        desk.take_versions(&scene);
        let (name, boxes, things) = (
            scene.name.to_string(),
            scene.frame().boxes.len(),
            scene.background.len(),
        );
        let length_s = scene.clip().length_s;
        let step = format!("Open {}", self.file.as_deref().unwrap_or("the first scene"));
        Ok(OpenReceipt {
            done: desk.put(step, from, scene)?,
            name,
            format: format.to_owned(),
            boxes,
            things,
            length_s,
            notes,
        })
    }
}
