//! `sceneloom new`: a scene from a procedural world.

use std::path::PathBuf;

use anyhow::anyhow;
use serde_json::json;

use super::{CommandResult, Common, output};
use app::open;
use formats::loom;
use scene::{Class, Lattice, Scene, drawn};
use world::scenery::RoadsideKind;
use world::template::TEMPLATES;
use world::terrain::Terrain;

/// Arguments.
#[derive(clap::Args)]
pub struct New {
    /// Kind of street; `list` names them all.
    #[arg(long, value_name = "NAME")]
    template: String,
    /// Kind of place; one that suits the road if left out.
    #[arg(long, value_enum, value_name = "NAME")]
    setting: Option<RoadsideKind>,
    /// The lie of the land.
    #[arg(long, value_enum, value_name = "NAME", default_value = "flat")]
    terrain: Terrain,
    /// Fixes every random draw.
    #[arg(long, default_value_t = 0)]
    seed: u64,
    /// Edge of the voxels, m: 0.4 as the networks have it, or 0.05 to 2.
    #[arg(long, value_name = "M", default_value_t = Lattice::OCC3D.voxel_m(), allow_negative_numbers = true)]
    voxel: f64,
    /// Voxels above one another, from about 1 m below the road up, at most 64; up to 5.4 m above it if left out.
    #[arg(long, value_name = "N")]
    bins: Option<usize>,
    /// Scene to write.
    #[arg(short, long, value_name = "S.loom")]
    output: Option<PathBuf>,
    #[command(flatten)]
    common: Common,
}

/// Voxels per class that occurs, by name.
pub fn class_counts(scene: &Scene) -> serde_json::Map<String, serde_json::Value> {
    let counts = scene.frame().occupancy.class_counts();
    let occupied = Class::ALL
        .into_iter()
        .filter(|c| *c != Class::Free && counts[c.id() as usize] > 0);
    occupied
        .map(|c| (c.name().into(), counts[c.id() as usize].into()))
        .collect()
}

impl New {
    pub(super) fn run(self) -> CommandResult {
        if self.template == "list" {
            output::report(&self.common, &json!({ "templates": TEMPLATES }), || {
                TEMPLATES.join("\n")
            });
            return Ok(());
        }
        let path = self
            .output
            .ok_or_else(|| anyhow!("-o S.loom is missing: where should the scene go?"))?;
        let scene = open::from_template_on(&self.template, self.seed, self.setting, self.terrain)
            .ok_or_else(|| {
                anyhow!(
                    "--template is {:?}, expected one of {}",
                    self.template,
                    TEMPLATES.join(", ")
                )
            })?;
        let lattice =
            drawn::new_lattice(self.voxel, self.bins).map_err(|e| anyhow!("--voxel, --bins: {e}"))?;
        let scene = scene.drawn_in(lattice);
        loom::save(&path, &scene)?;
        let frame = scene.frame();
        let report = json!({
            "boxes": frame.boxes.len(),
            "things": scene.background.len(),
            "occupied_voxels": frame.occupancy.count_set(),
            "classes": class_counts(&scene),
            "seed": self.seed,
            "file": path,
        });
        output::report(&self.common, &report, || {
            let (boxes, things) = (frame.boxes.len(), scene.background.len());
            let voxels = frame.occupancy.count_set();
            format!(
                "{}: {boxes} boxes, {things} things beside the road, {voxels} occupied voxels",
                path.display()
            )
        });
        Ok(())
    }
}
