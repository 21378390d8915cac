//! One row of the judge's table: a set of scenes, the features kept of each, and the set's figures beside other worlds.

use std::collections::BTreeMap;
use std::sync::Arc;

use serde_json::{Map, Value, json};

use super::agreement::Agreement;
use super::{distribution, two_sample};
use crate::suite::with_interval;
use editor::checks::{Severity, names, run_checks};
use metrics::extractor::Extractor;
use metrics::local::{Windows, depth, occupancy};
use metrics::shape::{FIGURES, ShapeFigures, shape};
use scene::{Scene, SensorRig, VoxelGrid};
use sensors::pictures::march::{MarchOptions, MarchScene};
use world::draw::Draw;

/// Number of cells of the extractor's map, and of windows of occupancy, that are taken of a scene for distances.
const TAKEN: usize = 48;

/// The sets of scenes, in the order of the table. All but the first are made for the layouts of the second.
pub const ROWS: [(&str, &str); 12] = [
    ("other_worlds", "what every row is compared with"),
    ("worlds", "as many worlds: the floor"),
    ("through_vae", "the worlds, encoded and decoded"),
    (
        "vae_told",
        "the same, its decoder told the draft with the background",
    ),
    (
        "through_fine",
        "the worlds, through the fine VAE: the most that refining could reach",
    ),
    ("generated", "from the layouts alone"),
    ("background_given", "from the layouts and the worlds' background"),
    ("given_coarse", "the same without the fine stage"),
    (
        "scenery_drawn",
        "from the layouts and a background drawn by rules, as it is shown",
    ),
    (
        "scenery_learned",
        "the same, the background drawn by the scenery network",
    ),
    (
        "without_draft",
        "from the layouts alone, the draft hidden from the network",
    ),
    ("draft_alone", "the drafts of the layouts"),
];

/// Features and figures kept of one scene.
pub struct SceneFeatures {
    shape: ShapeFigures,
    pooled: Vec<f64>,
    cells: Windows,
    windows: Windows,
    patches: Windows,
    depths: Windows,
    /// Findings by check, errors, and all.
    findings: BTreeMap<&'static str, f64>,
}

impl SceneFeatures {
    /// Takes features of occupancy made for the layout and boxes of a scene; `index` seeds the choice of windows.
    pub fn from_scene(
        scene: &Scene,
        grid: &VoxelGrid,
        index: u64,
        extractor: &Extractor,
    ) -> anyhow::Result<Self> {
        let cells = extractor.cells(grid)?;
        let windows = occupancy::windows(grid);
        let mut draw = Draw::new(index, "windows taken");
        let mut some = |all: &Windows| -> Windows {
            let each = (0..TAKEN).map(|i| i * all.len() / TAKEN..(i + 1) * all.len() / TAKEN);
            each.map(|part| all[part.start + draw.below(part.len())].clone())
                .collect()
        };
        Ok(Self {
            shape: shape(grid),
            pooled: mean(&cells),
            cells: some(&cells),
            windows: some(&windows),
            patches: occupancy::patches(&windows),
            depths: depths(scene, grid),
            findings: findings(scene, grid),
        })
    }
}

fn mean(rows: &Windows) -> Vec<f64> {
    let mut sums = vec![0.0; rows.first().map_or(0, Vec::len)];
    for row in rows {
        sums.iter_mut().zip(row).for_each(|(s, v)| *s += v);
    }
    sums.iter().map(|s| s / rows.len() as f64).collect()
}

/// Windows of the depth images of the nuScenes cameras, of the voxels alone.
fn depths(scene: &Scene, grid: &VoxelGrid) -> Windows {
    let options = MarchOptions {
        boxes: false,
        lines: false,
        ..MarchOptions::default()
    };
    let frame = scene.frame();
    let march = MarchScene::new(grid, &frame.layout, &frame.boxes, &options);
    let [width, height] = depth::IMAGE;
    let views = march.render_rig(&SensorRig::default(), width, height);
    views.iter().flat_map(|v| depth::windows(&v.depth_m)).collect()
}

fn findings(scene: &Scene, grid: &VoxelGrid) -> BTreeMap<&'static str, f64> {
    let mut scene = scene.clone();
    scene.change_canvas(|frame| {
        frame.occupancy = grid.clone();
        Arc::make_mut(&mut frame.source).occupancy = grid.clone();
    });
    let mut out = BTreeMap::from([("all", 0.0), ("errors", 0.0)]);
    out.extend(names().map(|name| (name, 0.0)));
    for finding in run_checks(&scene, None) {
        let is_error = finding.severity == Severity::Error;
        for (name, counts) in [("all", true), (finding.check, true), ("errors", is_error)] {
            *out.entry(name).or_default() += f64::from(u8::from(counts));
        }
    }
    out
}

/// A set of scenes.
#[derive(Default)]
pub struct SceneSet {
    pub agreement: Agreement,
    pub scenes: Vec<SceneFeatures>,
}

impl SceneSet {
    /// Takes one scene in.
    pub fn add(&mut self, scene: &Scene, grid: &VoxelGrid, seen: SceneFeatures) {
        self.agreement.add(scene, grid);
        self.scenes.push(seen);
    }

    fn each<T: Clone>(&self, of: impl Fn(&SceneFeatures) -> &T) -> Vec<T> {
        self.scenes.iter().map(|s| of(s).clone()).collect()
    }

    fn shape(&self) -> Value {
        let rows = FIGURES.iter().filter_map(|(name, _)| {
            let found: Vec<f64> = self
                .scenes
                .iter()
                .filter_map(|s| s.shape.get(name).copied())
                .collect();
            (!found.is_empty()).then(|| ((*name).to_owned(), with_interval(&found)))
        });
        Value::Object(rows.collect())
    }

    fn findings(&self) -> Value {
        let mut out = Map::new();
        for name in self.scenes.first().into_iter().flat_map(|s| s.findings.keys()) {
            let found: Vec<f64> = self.scenes.iter().map(|s| s.findings[name]).collect();
            if found.iter().any(|n| *n > 0.0) || ["all", "errors"].contains(name) {
                out.insert((*name).to_owned(), with_interval(&found));
            }
        }
        Value::Object(out)
    }

    /// All figures; distances only from two scenes on. `others` are the worlds that the set is compared with.
    pub fn report(&self, others: &SceneSet, seed: u64) -> anyhow::Result<Value> {
        let pair = |of: fn(&SceneFeatures) -> &Windows| [others.each(of), self.each(of)];
        let mut out = json!({
            "layout_agreement": self.agreement.report(),
            "shape": self.shape(),
            "findings": self.findings(),
        });
        if !std::ptr::eq(self, others) && self.scenes.len() > 1 {
            out["distances"] = distribution::distances(
                [&others.each(|s| &s.pooled), &self.each(|s| &s.pooled)],
                &pair(|s| &s.cells),
                &pair(|s| &s.windows),
            )?;
            out["told_apart"] = json!({
                "occupancy": two_sample::report(&pair(|s| &s.patches), &occupancy::names(), seed)?,
                "depth": two_sample::report(&pair(|s| &s.depths), &depth::names(), seed)?,
            });
        }
        Ok(out)
    }
}
