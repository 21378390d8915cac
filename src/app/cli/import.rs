//! `sceneloom import`: a scene from a file of any format that is read, see `formats::import`.

use std::collections::BTreeMap;
use std::path::PathBuf;

use anyhow::{Context, anyhow};
use glam::DVec2;
use serde_json::json;

use super::{CommandResult, Common, output};
use app::open::{self, Imported, Placement};
use authoring::read;
use formats::import::{self, Content, ImportOptions, ImportedScene, Importer};
use formats::loom;
use scene::{BevLayer, Scene};

/// Arguments.
#[derive(clap::Args)]
pub struct Import {
    #[arg(help = format!("File to read: {}", import::in_words()))]
    file: PathBuf,
    /// Ego position in the file's frame, m; without it a place on a lane near a junction.
    #[arg(long, value_name = "X,Y", value_parser = point, allow_hyphen_values = true)]
    at: Option<DVec2>,
    /// Ego heading in the file's frame, degrees counter-clockwise; without it along the lane.
    #[arg(long, value_name = "DEG", allow_hyphen_values = true)]
    heading: Option<f64>,
    /// Length (along the heading) and width of the map, m; without it 80x80. A long one lies mostly ahead. `all`: the whole
    /// network.
    #[arg(long, value_name = "LxW", value_parser = map_size)]
    size: Option<MapSize>,
    /// Fixes the traffic.
    #[arg(long, default_value_t = 0)]
    seed: u64,
    /// For a point cloud: lift it by so many metres, 0 for not at all; without it a sweep whose ground lies beside the
    /// map is lifted onto it, which is told.
    #[arg(long, value_name = "M", allow_hyphen_values = true)]
    lift: Option<f64>,
    /// For voxels of a data set: take them to those of the networks, 0.4 m and 16 bins, in place of their own.
    #[arg(long)]
    resample: bool,
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
pub(super) fn point(text: &str) -> Result<DVec2, String> {
    let numbers: Option<Vec<f64>> = text.split(',').map(|v| v.trim().parse().ok()).collect();
    match numbers.as_deref() {
        Some(&[x, y]) if x.is_finite() && y.is_finite() => Ok(DVec2::new(x, y)),
        _ => Err("expected two finite numbers X,Y in metres".into()),
    }
}

/// How large a map is.
#[derive(Clone, Copy)]
enum MapSize {
    All,
    Sides([f64; 2]),
}

/// `LxW` in metres, or `all`.
fn map_size(text: &str) -> Result<MapSize, String> {
    if text == "all" {
        return Ok(MapSize::All);
    }
    let numbers: Option<Vec<f64>> = text.split('x').map(|v| v.trim().parse().ok()).collect();
    match numbers.as_deref() {
        Some(&[length_m, width_m]) => {
            let size_m = Some([length_m, width_m]);
            let placement = Placement {
                size_m,
                ..Placement::default()
            };
            placement
                .problem()
                .map_or(Ok(MapSize::Sides([length_m, width_m])), Err)
        }
        _ => Err("expected two lengths in metres, such as 300x100, or all".into()),
    }
}

impl Import {
    pub(super) fn run(self) -> CommandResult {
        if let Some(heading) = self.heading
            && !heading.is_finite()
        {
            return Err(anyhow!("--heading is {heading}, expected a finite angle in degrees").into());
        }
        let options = ImportOptions {
            lift_m: self.lift,
            resample: self.resample,
        };
        let (importer, content) = read::file_with(&self.file, options)?;
        match content {
            Content::Scene(_) if self.is_placed() => {
                let file = self.file.display();
                Err(anyhow!(
                    "{file}: a scene; --at, --heading, --size, --empty and --bare are for road files"
                )
                .into())
            }
            Content::Scene(loaded) => self.whole(importer, &loaded),
            Content::Recipe(recipe) => {
                let loaded = ImportedScene {
                    sweep: None,
                    scene: app::again(&recipe)?,
                    inferred: &[],
                    skipped: Default::default(),
                    notes: Vec::new(),
                };
                self.whole(importer, &loaded)
            }
            Content::Roads(network) => {
                let placement = Placement {
                    at_m: self.at,
                    heading_rad: self.heading.map(f64::to_radians),
                    size_m: match self.size {
                        Some(MapSize::Sides(size_m)) => Some(size_m),
                        _ => None,
                    },
                    whole: matches!(self.size, Some(MapSize::All)),
                    seed: self.seed,
                    empty: self.empty,
                    bare: self.bare,
                };
                if let Some(problem) = placement.problem_on(&network) {
                    return Err(anyhow!("{}: {problem}", self.file.display()).into());
                }
                let name = import::scene_name(&self.file);
                self.roads(importer, &open::on_roads(*network, &name, &placement))
            }
        }
    }

    /// True if something is said that road files alone understand.
    fn is_placed(&self) -> bool {
        self.at.is_some() || self.heading.is_some() || self.size.is_some() || self.empty || self.bare
    }

    /// A place on roads.
    fn roads(&self, importer: &Importer, imported: &Imported) -> CommandResult {
        let frame = imported.scene.frame();
        let (at, heading) = imported.pose;
        if frame.layout.count(BevLayer::DrivableArea) == 0 {
            let file = self.file.display();
            return Err(anyhow!("{file}: no road on the map around --at {:.1},{:.1}", at.x, at.y).into());
        }
        loom::save(&self.output, &imported.scene).context("write the scene")?;
        let heights_m = frame.layout.relief.heights_m().unwrap_or_default();
        let lowest_m = heights_m.iter().copied().fold(0.0, f32::min);
        let highest_m = heights_m.iter().copied().fold(0.0, f32::max);
        let report = json!({
            "format": importer.id,
            "boxes": frame.boxes.len(),
            "roads": imported.roads,
            "lanes": imported.lanes,
            "own_layout": imported.is_own,
            "bridges": imported.bridges,
            "things": imported.scene.background.len(),
            "things_of_file": imported.things_of_file,
            "scenery_left_out": imported.scenery_left_out,
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
            let mut note = match beside.is_empty() {
                true => String::new(),
                false => format!("; counted as drivable: {}", beside.join(", ")),
            };
            if imported.scenery_left_out > 0 {
                note.push_str(&format!(
                    "; {} things of scenery left out, evenly over the map: a scene holds {}",
                    imported.scenery_left_out,
                    scene::Background::MAX_THINGS
                ));
            }
            if imported.is_own {
                note.push_str("; the layout is the one that sceneloom wrote, to the last cell");
            }
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
                listed(&imported.skipped),
            )
        });
        Ok(())
    }

    /// A scene as the file holds it, with a report of its inferred parts.
    fn whole(&self, importer: &Importer, loaded: &ImportedScene) -> CommandResult {
        let scene = &loaded.scene;
        loom::save(&self.output, scene).context("write the scene")?;
        let frame = scene.frame();
        let report = json!({
            "format": importer.id,
            "boxes": frame.boxes.len(),
            "roads": 0,
            "lanes": 0,
            "skipped": loaded.skipped,
            "inferred": loaded.inferred,
            "notes": loaded.notes,
            "things": things(scene),
            "occupied_voxels": frame.occupancy.count_set(),
            "file": self.output,
        });
        output::report(&self.common, &report, || {
            let inferred = match loaded.inferred.is_empty() {
                true => "",
                false => "inferred: ",
            };
            let skipped = match loaded.skipped.is_empty() {
                true => String::new(),
                false => format!("; left out or assumed: {}", listed(&loaded.skipped)),
            };
            let notes: String = loaded.notes.iter().map(|note| format!("; {note}")).collect();
            format!(
                "{}: {} occupied voxels; {inferred}{} boxes, {} road and {} sidewalk columns, {} things beside the road{notes}{skipped}",
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

/// Kinds with their numbers; `nothing` if there are none. Of very many the first are named.
fn listed(counts: &BTreeMap<String, usize>) -> String {
    const MOST: usize = 40;
    let mut kinds: Vec<String> = counts
        .iter()
        .take(MOST)
        .map(|(kind, n)| format!("{kind} {n}"))
        .collect();
    match counts.len() {
        0 => return "nothing".into(),
        n if n > MOST => kinds.push(format!("{} other kinds", n - MOST)),
        _ => {}
    }
    kinds.join(", ")
}

/// Number of things of each kind.
fn things(scene: &Scene) -> BTreeMap<&'static str, usize> {
    let mut counts = BTreeMap::new();
    for thing in scene.background.iter() {
        *counts.entry(thing.form.name()).or_default() += 1;
    }
    counts
}
