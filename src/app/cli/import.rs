//! `sceneloom import`: a scene from a road network or from labels.

use std::collections::BTreeMap;
use std::path::PathBuf;

use anyhow::{Context, bail};
use glam::DVec2;
use serde_json::json;

use super::{Common, Outcome, output};
use crate::open::{self, Kind, Placement};
use formats::project;
use scene::{BevLayer, Scene};

/// Arguments.
#[derive(clap::Args)]
pub struct Import {
    /// OpenDRIVE road network, or Occ3D labels (`labels.npz`).
    file: PathBuf,
    /// Ego position in the file's frame, m; without it a place on a lane near a junction.
    #[arg(long, value_name = "X,Y", value_parser = point, allow_hyphen_values = true)]
    at: Option<DVec2>,
    /// Ego heading in the file's frame, degrees counter-clockwise; without it along the lane.
    #[arg(long, value_name = "DEG", allow_hyphen_values = true)]
    heading: Option<f64>,
    /// Fixes the traffic.
    #[arg(long, default_value_t = 0)]
    seed: u64,
    /// Without vehicles and people.
    #[arg(long)]
    empty: bool,
    /// Road and traffic only: no scenery but what the file holds.
    #[arg(long)]
    bare: bool,
    /// Scene to write.
    #[arg(short, long, value_name = "S.loom")]
    output: PathBuf,
    #[command(flatten)]
    common: Common,
}

/// `X,Y` as finite metres.
fn point(text: &str) -> Result<DVec2, String> {
    let numbers: Option<Vec<f64>> = text.split(',').map(|v| v.trim().parse().ok()).collect();
    match numbers.as_deref() {
        Some(&[x, y]) if x.is_finite() && y.is_finite() => Ok(DVec2::new(x, y)),
        _ => Err("expected two finite numbers X,Y in metres".into()),
    }
}

impl Import {
    pub(super) fn run(self) -> Outcome {
        if let Some(heading) = self.heading
            && !heading.is_finite()
        {
            return Err(anyhow::anyhow!("--heading is {heading}, expected a finite angle in degrees").into());
        }
        if open::kind(&self.file)? == Kind::Occ3d {
            return self.labels();
        }
        let placement = Placement {
            at_m: self.at,
            heading_rad: self.heading.map(f64::to_radians),
            seed: self.seed,
            empty: self.empty,
            bare: self.bare,
        };
        let imported = open::import(&self.file, &placement)?;
        let frame = imported.scene.frame();
        if frame.layout.count(BevLayer::DrivableArea) == 0 {
            let (at, _) = imported.pose;
            (|| -> anyhow::Result<()> {
                bail!(
                    "{}: no road within 40 m of --at {:.1},{:.1}",
                    self.file.display(),
                    at.x,
                    at.y
                )
            })()?;
        }
        project::save(&self.output, &imported.scene).context("write the scene")?;
        let heights_m = frame.layout.relief.heights_m().unwrap_or_default();
        let lowest_m = heights_m.iter().copied().fold(0.0, f32::min);
        let highest_m = heights_m.iter().copied().fold(0.0, f32::max);
        let (at, heading) = imported.pose;
        let report = json!({
            "format": "opendrive",
            "boxes": frame.boxes.len(),
            "roads": imported.roads,
            "lanes": imported.lanes,
            "bridges": imported.bridges,
            "things": imported.scene.background.len(),
            "things_of_file": imported.things_of_file,
            "relief_m": [lowest_m, highest_m],
            "skipped": imported.skipped,
            "drivable_beside_traffic": imported.drivable_beside_traffic,
            "at_m": [at.x, at.y],
            "heading_deg": heading.to_degrees(),
            "file": self.output,
        });
        let beside: Vec<String> = imported
            .drivable_beside_traffic
            .iter()
            .map(|(kind, columns)| format!("{columns} columns of {kind} lanes"))
            .collect();
        output::report(&self.common, &report, || {
            let note = match beside.is_empty() {
                true => String::new(),
                false => format!("; counted as drivable: {}", beside.join(", ")),
            };
            let skipped: Vec<String> = imported
                .skipped
                .iter()
                .map(|(kind, n)| format!("{kind} {n}"))
                .collect();
            format!(
                "{}: {} roads, {} lanes, {} bridges, {} boxes, {} things beside the road ({} of the file), ground {:.1} to \
                 {:.1} m; ego at {:.1}, {:.1} heading {:.1} deg; not understood: {}{note}",
                self.output.display(),
                imported.roads,
                imported.lanes,
                imported.bridges,
                frame.boxes.len(),
                imported.scene.background.len() - imported.bridges,
                imported.things_of_file,
                lowest_m,
                highest_m,
                at.x,
                at.y,
                heading.to_degrees(),
                match skipped.is_empty() {
                    true => "nothing".into(),
                    false => skipped.join(", "),
                }
            )
        });
        Ok(())
    }

    /// Labels carry neither layout nor boxes nor things: all are inferred.
    fn labels(&self) -> Outcome {
        let scene = open::labels(&self.file)?;
        project::save(&self.output, &scene).context("write the scene")?;
        let frame = scene.frame();
        let report = json!({
            "format": "occ3d",
            "boxes": frame.boxes.len(),
            "roads": 0,
            "lanes": 0,
            "skipped": {},
            "inferred": ["layout", "boxes", "background"],
            "things": things(&scene),
            "occupied_voxels": frame.occupancy.count_set(),
            "file": self.output,
        });
        output::report(&self.common, &report, || {
            format!(
                "{}: {} occupied voxels; inferred: {} boxes, {} road and {} sidewalk columns, {} things beside the road",
                self.output.display(),
                frame.occupancy.count_set(),
                frame.boxes.len(),
                frame.layout.count(BevLayer::DrivableArea),
                frame.layout.count(BevLayer::Walkway),
                scene.background.len(),
            )
        });
        Ok(())
    }
}

/// Number of things of each kind.
fn things(scene: &Scene) -> BTreeMap<&'static str, usize> {
    let mut counts = BTreeMap::new();
    for thing in scene.background.iter() {
        *counts.entry(thing.form.name()).or_default() += 1;
    }
    counts
}
