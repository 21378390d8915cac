//! `new`: a scene from a procedural world.

use anyhow::{Context, anyhow};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::names;
use crate::call::Operation;
use crate::desk::{Desk, Done};
use authoring::open;
use scene::{Lattice, drawn};
use world::scenery::RoadsideKind;
use world::template::TEMPLATES;
use world::terrain::Terrain;

/// Arguments of `new`.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct New {
    /// Kind of street.
    #[schemars(schema_with = "names::template")]
    template: String,
    /// Fixes every random draw: the same seed gives the same scene.
    #[serde(default)]
    seed: u64,
    /// Kind of place; one that suits the road if left out.
    #[serde(default)]
    setting: Option<RoadsideKind>,
    /// The lie of the land.
    #[serde(default)]
    terrain: Terrain,
    /// Edge of the voxels, m: 0.05 to 2; 0.4, as the networks have it, if left out.
    #[serde(default)]
    voxel_m: Option<f64>,
    /// Voxels above one another, from about 1 m below the road up, at most 64; up to 5.4 m above it if left out.
    #[serde(default)]
    bins: Option<usize>,
}

/// Receipt of `new`.
#[derive(Debug, Serialize, JsonSchema)]
pub struct NewSceneReceipt {
    /// Changes of the scene.
    #[serde(flatten)]
    done: Done,
    /// Name of the scene.
    name: String,
    /// Boxes in it: vehicles, people, barriers, cones.
    boxes: usize,
    /// Things beside the road: buildings, trees, posts.
    things: usize,
    /// Voxels that are not free.
    occupied_voxels: usize,
}

impl Operation for New {
    const NAME: &'static str = "new";
    const ABOUT: &'static str = "Replaces the scene by a new one from a procedural world: road, traffic, buildings, trees and voxels on a map of 80 x 80 m around the ego vehicle. It can be undone.";
    const EXAMPLE: &'static str =
        r#"{"template": "t-junction", "seed": 3, "setting": "city", "terrain": "flat"}"#;
    const CHANGES: bool = true;
    type Receipt = NewSceneReceipt;

    fn run(self, desk: &mut Desk) -> anyhow::Result<NewSceneReceipt> {
        names::check("template", &self.template, &TEMPLATES)?;
        let from = desk.scene()?.content();
        let scene = open::from_template_on(&self.template, self.seed, self.setting, self.terrain)
            .context("no such template")?;
        let voxel_m = self.voxel_m.unwrap_or(Lattice::OCC3D.voxel_m());
        let lattice = drawn::new_lattice(voxel_m, self.bins).map_err(|e| anyhow!("voxel_m, bins: {e}"))?;
        let scene = scene.drawn_in(lattice);
        let (frame, name) = (scene.frame().clone(), scene.name.to_string());
        let things = scene.background.len();
        let done = desk.put(format!("New {}", self.template), from, scene)?;
        Ok(NewSceneReceipt {
            done,
            name,
            boxes: frame.boxes.len(),
            things,
            occupied_voxels: frame.occupancy.count_set(),
        })
    }
}
