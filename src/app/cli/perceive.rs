//! `sceneloom perceive`: predictions of small networks for a scene, from the cameras, the LiDAR and both; and a search
//! for a change after which one misses an object.

use std::ops::ControlFlow;
use std::path::PathBuf;

use anyhow::{Context, anyhow};
use serde_json::json;

use super::document;
use super::progress::ProgressLine;
use super::{CommandResult, Common, Moment, Stop, output};
use app::open;
use authoring::corner_case::{self, NetworkSensors, Vary};
use scene::{BoxId, Scene};
use sensors::perceive::voxels::{self, Hears, PerceptionInput, VoxelReport};
use sensors::perceive::{pictures, sweep};

/// Arguments.
#[derive(clap::Args)]
pub struct Perceive {
    /// Scene to look at.
    scene: PathBuf,
    /// Number of the box that is to be missed.
    #[arg(long = "box", value_name = "ID", requires = "vary")]
    of: Option<u32>,
    /// Property that is varied until the box is missed.
    #[arg(long, requires = "of")]
    vary: Option<Vary>,
    /// Sensor whose network is to miss it: the cameras if left out. Without a search all networks look.
    #[arg(long)]
    by: Option<NetworkSensors>,
    /// Scene to write in which it is missed.
    #[arg(short, long, value_name = "S.loom", requires = "vary")]
    output: Option<PathBuf>,
    #[command(flatten)]
    moment: Moment,
    #[command(flatten)]
    common: Common,
}

impl Perceive {
    pub(super) fn run(self) -> CommandResult {
        let scene = self.moment.apply_to(open::scene(&self.scene)?)?;
        match (self.of, self.vary) {
            (Some(id), Some(vary)) => self.search(&scene, BoxId(id), vary, self.by.unwrap_or_default()),
            _ if self.by.is_some() => {
                let problem = "--by is of a search: add --box ID and --vary WHAT, or leave it out and all networks look";
                Err(anyhow!(problem).into())
            }
            _ => self.look(&scene),
        }
    }

    fn look(&self, scene: &Scene) -> CommandResult {
        let placed = scene.for_sensors();
        let found = pictures::report(&placed)?;
        let swept = sweep::report(scene)?;
        let heard = PerceptionInput::from_scene(scene)?;
        let told = |hears| voxels::report_of(scene, &heard, hears);
        let (both, alone) = (told(Hears::Both)?, [told(Hears::Lidar)?, told(Hears::Cameras)?]);
        let name = |camera: usize| &placed.rig.cameras[camera].name;
        let boxes = found.boxes.iter().map(|b| {
            json!({
                "box": b.thing.id.0,
                "class": placed.frame().boxes.get(&b.thing.id).map(|b| b.class.name()),
                "camera": name(b.camera),
                "visible_px": b.thing.visible_px,
                "share_seen": round(b.thing.share),
                "missed": b.thing.is_missed(),
            })
        });
        let ghosts = found
            .ghost_px
            .iter()
            .enumerate()
            .map(|(i, px)| (name(i).clone(), json!(px)));
        let report = json!({
            "boxes": boxes.collect::<Vec<_>>(),
            "ghost_px": ghosts.collect::<serde_json::Map<_, _>>(),
            "pixels_right": round(found.right),
            "lidar": of_sweep(scene, &swept),
            "voxels": of_voxels(scene, &both, &alone),
        });
        output::report(&self.common, &report, || {
            let line = |b: &pictures::SeenByRig| {
                let missed = if b.thing.is_missed() { "missed" } else { "seen" };
                let class = placed
                    .frame()
                    .boxes
                    .get(&b.thing.id)
                    .map_or("box", |b| b.class.name());
                format!(
                    "{missed}: {class} #{} in {}, {} px, {:.0} % of them taken for a thing",
                    b.thing.id.0,
                    name(b.camera),
                    b.thing.visible_px,
                    b.thing.share * 100.0
                )
            };
            let mut lines: Vec<String> = found.boxes.iter().map(line).collect();
            lines.push(format!(
                "classes right: {:.1} % of the pixels",
                found.right * 100.0
            ));
            lines.extend(swept.boxes.iter().map(|b| {
                let class = scene.frame().boxes.get(&b.id).map_or("box", |b| b.class.name());
                match b.score {
                    Some(score) => format!(
                        "seen by the LiDAR: {class} #{}, {} returns, score {score:.2}",
                        b.id.0, b.returns
                    ),
                    None => format!("missed by the LiDAR: {class} #{}, {} returns", b.id.0, b.returns),
                }
            }));
            let ghosts = swept.detections.iter().filter(|d| d.of.is_none()).count();
            lines.push(format!(
                "boxes of the LiDAR's network where there are none: {ghosts}"
            ));
            lines.push(format!(
                "right where the LiDAR sees: {:.1} % of the columns",
                swept.right * 100.0
            ));
            lines.extend(both.boxes.iter().map(|b| {
                let class = scene.frame().boxes.get(&b.id).map_or("box", |b| b.class.name());
                let missed = if b.is_missed() { "missed" } else { "seen" };
                format!(
                    "{missed} among the voxels told from both: {class} #{}, {:.0} % of {} voxels",
                    b.id.0,
                    b.share * 100.0,
                    b.voxels
                )
            }));
            lines.push(format!(
                "things among them where there are none: {}",
                both.ghosts.len()
            ));
            lines.push(format!(
                "voxels told from both, IoU where the LiDAR sees: {:.3}; from the LiDAR alone {:.3}, from the cameras alone {:.3}",
                both.iou, alone[0].iou, alone[1].iou
            ));
            lines.join("\n")
        });
        Ok(())
    }

    fn search(&self, scene: &Scene, id: BoxId, vary: Vary, by: NetworkSensors) -> CommandResult {
        if !by.varies().contains(&vary) {
            let problem = match by {
                NetworkSensors::Cameras => {
                    "speed means nothing to cameras that take pictures in a moment: vary distance, offset, fog, time or weather"
                }
                _ => "light and air mean nothing to the LiDAR: vary distance, offset or speed",
            };
            return Err(anyhow!(problem).into());
        }
        let progress = ProgressLine::new(&self.common);
        let search = corner_case::search(scene, id, vary, by, |_, [k, most]| {
            progress.at("search", k, most);
            ControlFlow::Continue(())
        })?;
        progress.done();
        let last = search.tried.last().context("nothing was tried")?;
        let edits = search.found.as_ref();
        if let (Some(path), Some(edits)) = (&self.output, edits) {
            let mut document = document::opened(scene.clone());
            document.apply_all("Corner case", edits)?;
            document::save(path, &document)?;
        }
        let tried = search.tried.iter().map(|t| {
            json!({
                "what": t.change.to_string(), (visible(by)): t.sight.visible, "share_seen": round(t.sight.share),
                "judged": t.sight.is_judged(),
            })
        });
        let report = json!({
            "box": id.0,
            "missed": edits.is_some(),
            "at": last.change.to_string(),
            "time_s": round(search.at_s),
            "edits": edits,
            "tried": tried.collect::<Vec<_>>(),
            "file": self.output.as_ref().filter(|_| edits.is_some()),
        });
        output::report(&self.common, &report, || {
            let lines = search.tried.iter().map(|t| {
                let (n, percent) = (t.sight.visible, t.sight.share * 100.0);
                match by {
                    NetworkSensors::Cameras => {
                        format!("{}: {n} px, {percent:.0} % of them taken for a thing", t.change)
                    }
                    NetworkSensors::Lidar => format!("{}: {n} returns, {percent:.0} % sure", t.change),
                    NetworkSensors::Both => {
                        format!("{}: {percent:.0} % of {n} voxels taken for a thing", t.change)
                    }
                }
            });
            let mut lines: Vec<String> = lines.collect();
            lines.push(match edits {
                Some(_) => format!("box {} is missed: {}", id.0, last.change),
                None if search.tried.iter().all(|t| !t.sight.is_judged()) => {
                    format!("box {} is hidden, too small or too far away to be judged", id.0)
                }
                None => format!("box {} is never missed while it is plain to see", id.0),
            });
            lines.join("\n")
        });
        match edits {
            Some(_) => Ok(()),
            None if self.output.is_some() => Err(Stop::Short(format!(
                "box {} is never missed: no scene was written",
                id.0
            ))),
            None => Ok(()),
        }
    }
}

/// The predictions of the LiDAR's network, as JSON.
fn of_sweep(scene: &Scene, swept: &sweep::SweepReport) -> serde_json::Value {
    let class = |id| scene.frame().boxes.get(&id).map(|b| b.class.name());
    let boxes = swept.boxes.iter().map(|b| {
        json!({
            "box": b.id.0,
            "class": class(b.id),
            "returns": b.returns,
            "score": b.score.map(|s| round(s.into())),
            "missed": b.is_missed(),
        })
    });
    let ghosts = swept.detections.iter().filter(|d| d.of.is_none()).map(|d| {
        json!({
            "class": d.thing.class.name(),
            "center_m": d.thing.center_m.to_array().map(round),
            "size_m": d.thing.size_m.to_array().map(round),
            "yaw_deg": round(d.thing.yaw_rad.to_degrees()),
            "score": round(d.score.into()),
        })
    });
    json!({
        "boxes": boxes.collect::<Vec<_>>(),
        "ghosts": ghosts.collect::<Vec<_>>(),
        "columns_right": round(swept.right),
    })
}

/// The predictions of the network of both sensors, and its scores with one of them, as JSON.
fn of_voxels(scene: &Scene, both: &VoxelReport, [lidar, cameras]: &[VoxelReport; 2]) -> serde_json::Value {
    let class = |id| scene.frame().boxes.get(&id).map(|b| b.class.name());
    let boxes = both.boxes.iter().map(|b| {
        json!({
            "box": b.id.0,
            "class": class(b.id),
            "voxels": b.voxels,
            "share_seen": round(b.share),
            "missed": b.is_missed(),
        })
    });
    let ghosts = both.ghosts.iter().map(|g| {
        json!({
            "class": g.thing.class.name(),
            "center_m": g.thing.center_m.to_array().map(round),
            "voxels": g.voxels,
        })
    });
    let figures = |r: &VoxelReport| json!({ "iou": round(r.iou), "classes_right": round(r.right) });
    json!({
        "boxes": boxes.collect::<Vec<_>>(),
        "ghosts": ghosts.collect::<Vec<_>>(),
        "both": figures(both),
        "lidar_alone": figures(lidar),
        "cameras_alone": figures(cameras),
    })
}

/// The name in the report of the count that must be large enough for a sensor.
fn visible(by: NetworkSensors) -> &'static str {
    match by {
        NetworkSensors::Cameras => "visible_px",
        NetworkSensors::Lidar => "returns",
        NetworkSensors::Both => "voxels",
    }
}

fn round(v: f64) -> f64 {
    (v * 1000.0).round() / 1000.0
}
