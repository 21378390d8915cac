//! One variant: its scene and its files.

use std::collections::BTreeMap;
use std::path::Path;
use std::sync::Arc;

use anyhow::{Context, bail};

use super::deep_pictures;
use super::plan::{Base, BatchGeneration, BatchPlan, Output, VariantChange, video};
use super::record::{FILE, FileRecord, Findings, VariantRecord};
use super::thumb;
use crate::camera_views::LidarModel;
use crate::clip_export::{ClipOptions, ClipView, clip};
use crate::export::{ExportOptions, ExportProgress, export_all};
use crate::open::{self, Placement};
use crate::text;
use authoring::new_ground::with_scenery;
use authoring::whole::scenery_first;
use editor::checks::Severity;
use editor::{Document, Edit, apply_all};
use formats::export::ExportSpan;
use formats::recipe::{Recipe, hex_of};
use formats::{atomic, loom};
use job::pipeline::OccPipeline;
use job::{GenParams, Job, JobCtx, Pipeline, RegionMode};
use nets::OccModels;
use scene::draw::hash;
use scene::{Class, Scene};
use sensors::cameras::pictures;
use trade::Presets;

/// Size of each camera in moving pictures, pixels.
const CLIP_SIZE: [u32; 2] = [400, 225];

/// Maker of the variants of a plan.
pub struct Maker {
    plan: BatchPlan,
    /// Folder of the plan, to which its paths are relative.
    folder: std::path::PathBuf,
    models: Option<Arc<OccModels>>,
}

impl Maker {
    /// A maker for a plan in a folder. Errors if the plan asks for networks that are not there, or for a quality that
    /// no preset has.
    pub fn new(plan: BatchPlan, folder: &Path) -> anyhow::Result<Self> {
        let models = match &plan.generate {
            Some(generate) => {
                params_of(generate, 0)?;
                Some(OccModels::open(None)?)
            }
            None => None,
        };
        Ok(Self {
            plan,
            folder: folder.into(),
            models,
        })
    }

    /// The plan.
    pub fn plan(&self) -> &BatchPlan {
        &self.plan
    }

    /// Makes a variant in an empty folder that exists, and returns its record. The record is the last file that is
    /// written. Errors in one line.
    pub fn make(&self, variant: usize, into: &Path) -> anyhow::Result<VariantRecord> {
        let mut record = VariantRecord {
            variant,
            changes: self.changes(variant),
            ..VariantRecord::default()
        };
        let scene = self.scene_of(&record)?;
        let recipe = Recipe::of(&scene);
        record.seed = scene.seed;
        record.scene_sha256 = recipe.scene_sha256;
        record.boxes = scene.in_ego().frame().boxes.values().copied().collect();
        record.conditions = scene.conditions;
        record.findings = self.plan.check.then(|| findings(&scene));
        let times = self.times_s(&scene);
        record.frames = times.len();
        for (i, time_s) in times.iter().enumerate() {
            let moment = scene.at(*time_s);
            let named = format!("f{i:04}");
            let folder = if times.len() > 1 {
                into.join(&named)
            } else {
                into.into()
            };
            for output in &self.plan.write {
                self.write(output, &moment, &folder, i == 0)?;
            }
        }
        thumb::write(&scene, &into.join(thumb::FILE))?;
        record.files = files_of(into)?;
        let text = serde_json::to_string_pretty(&record)?;
        atomic::write(&into.join(FILE), text.as_bytes()).context("write the record")?;
        Ok(record)
    }

    /// The changes that a variant takes, by axis.
    pub fn changes(&self, variant: usize) -> BTreeMap<String, Vec<VariantChange>> {
        let values = self.plan.values_of(variant);
        let axes = self.plan.sweep.iter().zip(values);
        axes.map(|(axis, i)| (axis.name.clone(), axis.value(i))).collect()
    }

    /// The changes in the order of the plan.
    fn in_order<'r>(&self, record: &'r VariantRecord) -> Vec<&'r VariantChange> {
        let axes = self.plan.sweep.iter();
        axes.flat_map(|axis| record.changes.get(&axis.name).into_iter().flatten())
            .collect()
    }

    /// The scene of a variant.
    pub fn scene(&self, variant: usize) -> anyhow::Result<Scene> {
        self.scene_of(&VariantRecord {
            variant,
            changes: self.changes(variant),
            ..VariantRecord::default()
        })
    }

    fn scene_of(&self, record: &VariantRecord) -> anyhow::Result<Scene> {
        let changes = self.in_order(record);
        let (mut seed, mut base) = (self.plan.seed, &self.plan.base);
        for change in &changes {
            match change {
                VariantChange::Seed(new) => seed = *new,
                VariantChange::Base(new) => base = new,
                _ => {}
            }
        }
        let mut document = Document::new(self.base(base, seed)?);
        for change in changes {
            let edits = edits_of(change, document.scene(), seed)?;
            if !edits.is_empty() {
                let edits = with_scenery(document.scene(), edits);
                document.apply_all("Variant", &edits)?;
            }
        }
        if let (Some(generate), Some(models)) = (&self.plan.generate, &self.models) {
            let params = params_of(generate, seed)?;
            let scenery = scenery_first(document.scene(), &params)?;
            document.apply_all("Draw scenery", &scenery)?;
            let job = Job {
                scene: document.scene().clone(),
                params,
            };
            // A pipeline for each variant: nothing carries over from another one.
            let result = OccPipeline::new(models.clone()).run(&job, &JobCtx::detached())?;
            document.adopt(result.rev(), result.occupancy.clone())?;
        }
        Ok(Scene::clone(document.scene()))
    }

    fn base(&self, base: &Base, seed: u64) -> anyhow::Result<Scene> {
        match base {
            Base::Template(name) => open::from_template(name, seed).with_context(|| {
                let named = scene::message::quoted(name, 60);
                format!(
                    "template is {named:?}, expected one of {}",
                    world::template::TEMPLATES.join(", ")
                )
            }),
            Base::Scene(file) => open::scene(&self.folder.join(file)),
            Base::Road(road) => {
                let network = open::road_network(&self.folder.join(&road.file))?;
                let placement = Placement {
                    at_m: road.at_m,
                    heading_rad: road.heading_deg.map(f64::to_radians),
                    seed,
                    ..Placement::default()
                };
                if let Some(problem) = placement.problem_on(&network) {
                    bail!("{}: {problem}", road.file.display());
                }
                let name = formats::import::scene_name(&road.file);
                Ok(open::on_roads(network, &name, &placement).scene)
            }
            Base::Words(words) => {
                let recipe = Recipe {
                    words: vec![words.clone()],
                    scene: "words".into(),
                    seed,
                    ..Recipe::default()
                };
                let made = crate::again(&recipe)?;
                // The conditions that the words ask for.
                let read = text::read(words)?;
                let mut scene = made;
                scene.conditions = read.described.description.conditions(scene.seed);
                scene.touch();
                Ok(scene)
            }
        }
    }

    /// Moments for which the files of a moment are written, s.
    fn times_s(&self, scene: &Scene) -> Vec<f64> {
        let Some(hz) = self.plan.frames_hz.filter(|_| scene.clip().length_s > 0.0) else {
            return vec![scene.time_s()];
        };
        let frames = (scene.clip().length_s * hz + 1e-6) as usize + 1;
        (0..frames).map(|i| i as f64 / hz).collect()
    }

    /// Writes one output of a moment below a folder. An output that holds the whole clip is written with the first
    /// moment only.
    fn write(&self, output: &Output, scene: &Scene, folder: &Path, first: bool) -> anyhow::Result<()> {
        let place = folder.join(&output.format);
        let make = || std::fs::create_dir_all(&place).with_context(|| format!("create {}", place.display()));
        if output.format == "loom" {
            if first {
                make()?;
                loom::save(&place.join("scene.loom"), scene)?;
            }
            return Ok(());
        }
        if let Some(kind) = video(&output.format) {
            if first {
                make()?;
                let bytes = clip(scene, &clip_options(output, scene), kind, &|_, _| true)?;
                let path = place.join(format!("cameras.{}", output.format));
                atomic::write(&path, &bytes).with_context(|| format!("write {}", path.display()))?;
            }
            return Ok(());
        }
        let Some(format) = formats::export::from_id(&output.format) else {
            bail!("format {:?} is not known", output.format);
        };
        if format.span == ExportSpan::Clip && !first {
            return Ok(());
        }
        make()?;
        let mut options = ExportOptions::default();
        if let Some(size) = output.size {
            options.camera_size = size;
        }
        if output.learned_lidar {
            options.lidar = LidarModel::Learned;
        }
        let written = export_all(scene, &[format], &options, &place, &ExportProgress::default())?;
        match self.plan.pack {
            Some(_) => deep_pictures::as_arrays(&written),
            None => Ok(()),
        }
    }
}

/// The pictures of all cameras over the whole clip.
fn clip_options(output: &Output, scene: &Scene) -> ClipOptions {
    ClipOptions {
        view: ClipView::Cameras {
            view: pictures::VIEW.id,
            source: pictures::ID,
            camera: None,
        },
        size: output.size.unwrap_or(CLIP_SIZE),
        span_s: [0.0, scene.clip().length_s],
        rate_hz: scene.clip().rate_hz,
        paint: None,
    }
}

/// The knobs of a generation.
fn params_of(generate: &BatchGeneration, seed: u64) -> anyhow::Result<GenParams> {
    let presets = Presets::bundled();
    let Some(preset) = presets.named(&generate.quality) else {
        let names: Vec<&str> = presets.all.iter().map(|s| s.name.as_str()).collect();
        let found = scene::message::quoted(&generate.quality, 60);
        bail!(
            "generate: quality is {found:?}, expected one of {}",
            names.join(", ")
        );
    };
    let whole = match generate.whole {
        true => GenParams::whole_scene(),
        false => GenParams::default(),
    };
    let region = whole.region;
    Ok(GenParams {
        seed,
        region: if generate.whole { RegionMode::Full } else { region },
        ..preset.knobs.on(whole)
    })
}

/// The edits that make a change in a scene.
fn edits_of(change: &VariantChange, scene: &Scene, seed: u64) -> anyhow::Result<Vec<Edit>> {
    Ok(match change {
        VariantChange::Seed(_) | VariantChange::Base(_) => Vec::new(),
        VariantChange::Conditions { time, weather } => {
            let timed = time.map_or(scene.conditions, |time| scene.conditions.at(time));
            vec![Edit::SetConditions {
                conditions: weather.map_or(timed, |weather| timed.under(weather)),
            }]
        }
        VariantChange::Words(words) => by_words(words, scene, seed)?,
        VariantChange::Edits(edits) => text::with_conditions(edits, scene.conditions.seed),
        VariantChange::Offset { id, by_m, turn_deg } => {
            let Some(b) = scene.frame().boxes.get(id) else {
                bail!("offset: box {} does not exist", id.0);
            };
            if !(by_m.is_finite() && turn_deg.is_finite()) {
                bail!("offset of box {}: a number is not finite", id.0);
            }
            let ahead = b.heading();
            let moved = b.center_m + (ahead * by_m.x + ahead.perp() * by_m.y).extend(0.0);
            vec![Edit::MoveBox {
                id: *id,
                center_m: Some(moved),
                yaw_deg: Some(b.yaw_rad.to_degrees() + turn_deg),
                size_m: None,
            }]
        }
        VariantChange::Count { class, n } => counted(*class, *n, scene, seed)?,
    })
}

fn by_words(words: &str, scene: &Scene, seed: u64) -> anyhow::Result<Vec<Edit>> {
    let edited = text::read_edit(words, scene, seed)?;
    if edited.asks() || edited.edits().is_empty() {
        bail!(
            "words {:?}: {}",
            scene::message::quoted(words, 80),
            edited.answer()
        );
    }
    let mut edits = edited.edits();
    edits.push(Edit::KeepWords { words: words.into() });
    Ok(edits)
}

/// Edits that leave exactly `n` boxes of a class. Boxes to remove are drawn by the seed; boxes to add stand where words
/// would put them. Errors if there is no room for them.
fn counted(class: Class, n: usize, scene: &Scene, seed: u64) -> anyhow::Result<Vec<Edit>> {
    let mut there: Vec<_> = scene
        .frame()
        .boxes
        .values()
        .filter(|b| b.class == class)
        .map(|b| b.id)
        .collect();
    if there.len() > n {
        there.sort_by_key(|id| hash(seed ^ hash(u64::from(id.0))));
        return Ok(there[n..].iter().map(|id| Edit::RemoveBox { id: *id }).collect());
    }
    let more = n - there.len();
    if more == 0 {
        return Ok(Vec::new());
    }
    let plural = match (class, more) {
        (_, 1) => class.label(),
        (Class::Bus, _) => "buses".into(),
        _ => format!("{}s", class.label()),
    };
    let edits = by_words(&format!("add {more} {plural}"), scene, seed)?;
    let mut after = scene.clone();
    apply_all(&edits, &mut after)?;
    let found = after.frame().boxes.values().filter(|b| b.class == class).count();
    match found == n {
        true => Ok(edits),
        false => bail!("count: there is room for {found} {plural}, not for {n}"),
    }
}

fn findings(scene: &Scene) -> Findings {
    let mut out = Findings::default();
    for finding in crate::findings::check(scene) {
        match finding.severity {
            Severity::Error => out.errors += 1,
            Severity::Warning => out.warnings += 1,
            Severity::Info => out.infos += 1,
        }
        *out.by_check.entry(finding.check.to_owned()).or_default() += 1;
    }
    out
}

/// Every file below a folder, in the order of their paths.
fn files_of(folder: &Path) -> anyhow::Result<Vec<FileRecord>> {
    let (mut files, mut open) = (Vec::new(), vec![folder.to_path_buf()]);
    while let Some(at) = open.pop() {
        for entry in std::fs::read_dir(&at).with_context(|| at.display().to_string())? {
            let path = entry?.path();
            if path.is_dir() {
                open.push(path);
                continue;
            }
            let bytes = std::fs::read(&path).with_context(|| path.display().to_string())?;
            let relative = path.strip_prefix(folder).unwrap_or(&path);
            let parts = relative
                .components()
                .map(|c| c.as_os_str().to_string_lossy().into_owned());
            files.push(FileRecord {
                path: parts.collect::<Vec<_>>().join("/"),
                bytes: bytes.len() as u64,
                sha256: hex_of(&bytes),
            });
        }
    }
    files.sort_by(|a, b| a.path.cmp(&b.path));
    Ok(files)
}
