//! `sceneloom import`: a scene from a road network or from labels.

use std::collections::BTreeMap;
use std::path::PathBuf;

use anyhow::{Context, bail};
use glam::DVec2;
use serde_json::json;

use super::{Common, Outcome, output};
use crate::app::open::{self, Kind, Placement};
use crate::formats::project;
use crate::scene::{BevLayer, Scene};

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
        let (at, heading) = imported.pose;
        let report = json!({
            "format": "opendrive",
            "boxes": frame.boxes.len(),
            "roads": imported.roads,
            "lanes": imported.lanes,
            "skipped": imported.skipped,
            "at_m": [at.x, at.y],
            "heading_deg": heading.to_degrees(),
            "file": self.output,
        });
        output::report(&self.common, &report, || {
            format!(
                "{}: {} roads, {} lanes, {} boxes; ego at {:.1}, {:.1} heading {:.1} deg; not understood: {}",
                self.output.display(),
                imported.roads,
                imported.lanes,
                frame.boxes.len(),
                at.x,
                at.y,
                heading.to_degrees(),
                if imported.skipped.is_empty() {
                    "nothing".into()
                } else {
                    format!("{:?}", imported.skipped)
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
