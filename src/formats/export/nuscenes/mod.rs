//! nuScenes tables: see [`crate::nuscenes`]. Written for the devkit (nuscenes-devkit 1.2.0), with lidarseg, a map mask and a
//! map expansion.
//!
//! Key frames are every 0.5 s from the start of the clip; a scene that stands still is one. Between them are LiDAR sweeps and radar scans at
//! 10 Hz, in clips of up to a minute. The global frame is the world frame, moved so that the map lies where x and y are
//! positive, as map masks want it; `map.json` says by how much. `log.json` has the recipe.

mod annotations;
mod expansion;
mod map;
mod outline;
mod sensors;

use glam::{DVec2, DVec3};
use scene::{Pose, Scene, SceneBox};
use serde::Serialize;

use super::{ExportSpan, Exporter, OutFile, Product, Products};
use crate::nuscenes::tables::{
    Attribute, CalibratedSensor, Category, EgoPose, Instance, Lidarseg, Log, NuscenesMap, NuscenesSample,
    NuscenesSensor, SampleAnnotation, SampleData, SceneRow, Visibility,
};
use crate::nuscenes::tokens::Tokens;
use crate::nuscenes::{KEY_FRAMES_HZ, categories};
use crate::recipe::Recipe;
use crate::{FormatError, Holds, moments};

/// See the module.
pub const EXPORTER: Exporter = Exporter {
    id: "nuscenes",
    title: "nuScenes: a folder of tables, LiDAR sweeps, radar scans, pictures and a map, for the devkit",
    file_name: None,
    holds: &[Holds::Boxes, Holds::Points, Holds::Pictures],
    lost: "what happens between key frames and after the last one, names and paint of boxes, velocities of a scene that \
           stands still, slopes of the ground, beams of the LiDAR and further LiDARs, patterns of radars, distortion and shutters of cameras, size of the own vehicle; voxels, map \
           and scenery are inferred anew from the LiDAR",
    span: ExportSpan::Clip,
    needs: &[Product::Sweep, Product::Radar, Product::Truth],
    write,
};

/// Name of the folder of tables.
const VERSION: &str = "v1.0-mini";
/// When every clip starts, µs: 2020-09-13 12:26:40 UTC. A clip has no date.
const START_US: i64 = 1_600_000_000_000_000;
const DATE: &str = "2020-09-13";
/// Which car. The devkit reads no meaning into it.
const VEHICLE: &str = "sceneloom";
/// The one of the devkit's four places with traffic on the right. Its map API refuses other names.
const LOCATION: &str = "boston-seaport";

/// Name of the split of `splits.json` that the scene is in.
const SPLIT: &str = "all";

/// All rows.
#[derive(Default)]
struct Tables {
    sample: Vec<NuscenesSample>,
    sample_data: Vec<SampleData>,
    ego_pose: Vec<EgoPose>,
    sensor: Vec<NuscenesSensor>,
    calibrated_sensor: Vec<CalibratedSensor>,
    sample_annotation: Vec<SampleAnnotation>,
    instance: Vec<Instance>,
    lidarseg: Vec<Lidarseg>,
}

/// The export while it is made: the tables and files so far.
struct Writing<'a> {
    scene: &'a Scene,
    tokens: Tokens,
    /// From the world frame to the global frame, m.
    shift_m: DVec2,
    tables: Tables,
    files: Vec<OutFile>,
}

fn write(scene: &Scene, products: &mut dyn Products) -> Result<Vec<OutFile>, FormatError> {
    if let Some(problem) = scene.rig.problem() {
        return Err(FormatError::new(problem));
    }
    let low = scene.canvas().extent().min_m().truncate();
    let mut writing = Writing {
        scene,
        tokens: Tokens::from_scene(scene),
        shift_m: 0.0 - low,
        tables: Tables::default(),
        files: Vec::new(),
    };
    let times_s = moments::times_s(scene, KEY_FRAMES_HZ);
    let mut sensors = sensors::Sensors::new(&mut writing);
    let mut boxes = annotations::Annotations::default();
    for (i, &time_s) in times_s.iter().enumerate() {
        let sample = writing.sample_token(i);
        if let Some(before_s) = i.checked_sub(1).map(|i| times_s[i]) {
            sensors.between(&mut writing, products, &sample, before_s..time_s)?;
        }
        products.show(time_s)?;
        let now = scene.at(time_s);
        if let Some(problem) = now.frame().boxes.values().find_map(SceneBox::problem) {
            return Err(FormatError::new(problem));
        }
        let seen = sensors.key_frame(&mut writing, products, &sample, &now)?;
        boxes.key_frame(&mut writing, i, &now, &seen);
        let neighbour = |other: Option<usize>| {
            other
                .filter(|i| *i < times_s.len())
                .map_or_else(String::new, |i| writing.sample_token(i))
        };
        let row = NuscenesSample {
            token: sample,
            timestamp: timestamp_us(time_s),
            scene_token: writing.tokens.token("scene", 0),
            prev: neighbour(i.checked_sub(1)),
            next: neighbour(Some(i + 1)),
        };
        writing.tables.sample.push(row);
    }
    sensors.link(&mut writing);
    boxes.finish(&mut writing);
    map::write(&mut writing)?;
    writing.finish(products.recipe())
}

/// Times of the tables; they count from the start of the clip.
fn timestamp_us(time_s: f64) -> i64 {
    START_US + (time_s * 1e6).round() as i64
}

impl Writing<'_> {
    fn sample_token(&self, key_frame: usize) -> String {
        self.tokens.token("sample", key_frame as u64)
    }

    /// A point of the world frame in the global frame.
    fn global(&self, p_in_world: DVec3) -> [f64; 3] {
        (p_in_world + self.shift_m.extend(0.0)).to_array()
    }

    fn global_pose(&self, world_from_ego: &Pose) -> ([f64; 4], [f64; 3]) {
        let q = world_from_ego.rotation;
        (
            crate::nuscenes::wxyz(q),
            self.global(world_from_ego.translation_m),
        )
    }

    /// A file, its path from the folder of the data set on.
    fn file(&mut self, folder: &str, name: &str, bytes: Vec<u8>) -> String {
        let file = OutFile::new(name, bytes).within(folder);
        let path = file.name.clone();
        self.files.push(file);
        path
    }

    fn table<T: Serialize>(&mut self, name: &str, rows: &[T]) -> Result<(), FormatError> {
        let mut bytes = b"[\n".to_vec();
        for (i, row) in rows.iter().enumerate() {
            bytes.extend(if i == 0 { &b""[..] } else { &b",\n"[..] });
            serde_json::to_writer(&mut bytes, row).map_err(FormatError::new)?;
        }
        bytes.extend(b"\n]\n");
        self.file(VERSION, &format!("{name}.json"), bytes);
        Ok(())
    }

    /// The tables as files, after those that they name.
    fn finish(mut self, recipe: &Recipe) -> Result<Vec<OutFile>, FormatError> {
        let tables = std::mem::take(&mut self.tables);
        let log = self.tokens.token("log", 0);
        let first_and_last = [tables.sample.first(), tables.sample.last()];
        let [first, last] = first_and_last.map(|s| s.map(|s| s.token.clone()).unwrap_or_default());
        let scene = SceneRow {
            token: self.tokens.token("scene", 0),
            log_token: log.clone(),
            nbr_samples: tables.sample.len() as u64,
            first_sample_token: first,
            last_sample_token: last,
            name: scene_name(&self.tokens),
            description: annotations::description(self.scene),
            title: Some(self.scene.name.to_string()).filter(|title| !title.is_empty()),
        };
        let splits = serde_json::json!({ SPLIT: [&scene.name] });
        self.table("scene", &[scene])?;
        self.file(
            VERSION,
            "splits.json",
            serde_json::to_vec(&splits).map_err(FormatError::new)?,
        );
        let row = Log {
            token: log.clone(),
            logfile: log_name(self.scene),
            vehicle: VEHICLE.into(),
            date_captured: DATE.into(),
            location: LOCATION.into(),
            recipe: Some(serde_json::to_value(recipe).map_err(FormatError::new)?),
        };
        self.table("log", &[row])?;
        let row = NuscenesMap {
            token: self.tokens.token("map", 0),
            log_tokens: vec![log],
            category: "semantic_prior".into(),
            filename: map::mask_path(&self.tokens),
            world_origin_m: Some(self.shift_m.to_array()),
        };
        self.table("map", &[row])?;
        let category = |(index, (name, _)): (usize, &(&str, categories::Means))| Category {
            token: self.tokens.token("category", index as u64),
            name: (*name).to_owned(),
            description: String::new(),
            index: Some(index as u8),
        };
        let rows: Vec<Category> = categories::ALL.iter().enumerate().map(category).collect();
        self.table("category", &rows)?;
        let rows: Vec<Attribute> = annotations::attributes(&self.tokens);
        self.table("attribute", &rows)?;
        let rows: Vec<Visibility> = annotations::visibilities();
        self.table("visibility", &rows)?;
        self.table("sensor", &tables.sensor)?;
        self.table("calibrated_sensor", &tables.calibrated_sensor)?;
        self.table("ego_pose", &tables.ego_pose)?;
        self.table("sample", &tables.sample)?;
        self.table("sample_data", &tables.sample_data)?;
        self.table("instance", &tables.instance)?;
        self.table("sample_annotation", &tables.sample_annotation)?;
        // The devkit counts the files of a folder that must be there once the table is.
        if !tables.lidarseg.is_empty() {
            self.table("lidarseg", &tables.lidarseg)?;
        }
        Ok(self.files)
    }
}

/// Name of the scene, `scene-` and four digits; the devkit makes a number of them. The names of the data set end at
/// 1110.
fn scene_name(tokens: &Tokens) -> String {
    let token = tokens.token("scene", 0);
    let number = u64::from_str_radix(&token[..12], 16).unwrap_or(0);
    format!("scene-{}", 2000 + number % 8000)
}

/// Name of the recording, which is also in the names of files.
fn log_name(scene: &Scene) -> String {
    format!("sceneloom-{}", scene.seed)
}

#[cfg(test)]
mod tests;
