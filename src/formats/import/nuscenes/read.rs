//! A scene of the tables, put together: key frames, objects, sensors.

use std::collections::{BTreeMap, HashMap, HashSet};

use glam::{DQuat, DVec3};
use scene::message::quoted;
use scene::{BoxLabel, BoxName, Class, Pose, SensorRig};

use super::{Skipped, count, rig, rows};
use crate::FormatError;
use crate::import::ImportFile;
use crate::nuscenes::categories::{self, Means};
use crate::nuscenes::tables::{
    Attribute, CalibratedSensor, Category, EgoPose, Instance, Lidarseg, NuscenesMap, NuscenesSample,
    NuscenesSensor, SampleAnnotation, SampleData, SceneRow,
};
use crate::nuscenes::{pose, yaw_rad};
use crate::sensor_names::LIDAR;

/// Farthest that a vehicle may be from the origin of the global frame, m: coordinates of countries fit.
const FARTHEST_M: f64 = 1e7;

/// A scene of the tables, in its world frame.
pub(super) struct Recording {
    /// `scene-0061`.
    pub(super) name: String,
    /// In words.
    pub(super) description: String,
    /// In order of time, at least one.
    pub(super) frames: Vec<KeyFrame>,
    /// Whatever has boxes of a class of objects.
    pub(super) objects: Vec<Object>,
    /// Sensors.
    pub(super) rig: SensorRig,
    /// The frame that all of this is in, from that of the tables.
    pub(super) world_from_global: Pose,
    /// True for a folder that Sceneloom wrote: it holds no recording.
    pub(super) is_own: bool,
    /// Class of each number in lidarseg files; `None` for points that are left out.
    pub(super) labels: Vec<Option<Class>>,
}

/// A key frame.
pub(super) struct KeyFrame {
    /// Token of the sample.
    pub(super) token: String,
    /// From the first one on, s.
    pub(super) time_s: f64,
    /// Where the vehicle was.
    pub(super) world_from_ego: Pose,
    /// Its sweep, if it has one.
    pub(super) sweep: Option<RecordedSweep>,
}

/// A sweep.
pub(super) struct RecordedSweep {
    /// File, from the folder of the data set on.
    pub(super) filename: String,
    /// File of its labels, from there on.
    pub(super) labels: Option<String>,
    /// Pose of the frame of its points.
    pub(super) ego_from_lidar: Pose,
    /// Place of the sensor in the ego frame, m.
    pub(super) sensor_m: DVec3,
}

/// An object through the scene.
pub(super) struct Object {
    /// Class of the object.
    pub(super) class: Class,
    /// Its name, where its category has one.
    pub(super) label: BoxLabel,
    /// True if it is parked in every key frame.
    pub(super) parked: bool,
    /// By place in the key frames.
    pub(super) boxes: BTreeMap<usize, Annotation>,
}

/// A box of a key frame, in the world frame.
#[derive(Clone, Copy, Debug)]
pub(super) struct Annotation {
    /// m.
    pub(super) center_m: DVec3,
    /// Length, width, height, m.
    pub(super) size_m: DVec3,
    /// Counter-clockwise from x.
    pub(super) yaw_rad: f64,
}

/// All scenes, by name.
pub(super) fn listed(source: &ImportFile<'_>) -> Result<Vec<SceneRow>, FormatError> {
    let mut scenes: Vec<SceneRow> = rows::parse(source.bytes, |_| true).map_err(FormatError::new)?;
    scenes.sort_by(|a, b| (&a.name, &a.token).cmp(&(&b.name, &b.token)));
    Ok(scenes)
}

/// A scene by its place in the list.
pub(super) fn recording(
    source: &ImportFile<'_>,
    which: usize,
    skipped: &mut Skipped,
) -> Result<Recording, FormatError> {
    let scenes = listed(source)?;
    let found = scenes.len();
    count(skipped, "scenes", found.saturating_sub(1));
    let scene = scenes.into_iter().nth(which);
    let scene =
        scene.ok_or_else(|| FormatError::new(format!("{found} scenes, expected at least {}", which + 1)))?;
    let samples = samples(source, &scene, skipped)?;
    let place: HashMap<&str, usize> = samples.iter().enumerate().map(|(i, s)| (&*s.token, i)).collect();

    let data: Vec<SampleData> = rows::of(source, "sample_data", |row: &SampleData| {
        row.is_key_frame && place.contains_key(&*row.sample_token)
    })?;
    let sensors: Vec<NuscenesSensor> = rows::of(source, "sensor", |_| true)?;
    let wanted: HashSet<&str> = data.iter().map(|d| &*d.calibrated_sensor_token).collect();
    let lidars = sensors.iter().filter(|sensor| sensor.modality == "lidar");
    let lidars: HashSet<&str> = lidars.map(|sensor| &*sensor.token).collect();
    let calibrated: Vec<CalibratedSensor> =
        rows::of(source, "calibrated_sensor", |row: &CalibratedSensor| {
            wanted.contains(&*row.token) || lidars.contains(&*row.sensor_token)
        })?;
    let kinds = Kinds::new(&sensors, &calibrated);
    let rig = rig::rig(&kinds, &data, skipped);
    if let Some(problem) = rig.problem() {
        return Err(FormatError::new(format!("sensor.json: {problem}")));
    }
    let reference = reference(&kinds, &data, &place, samples.len());
    if let Some(i) = reference.iter().position(Option::is_none) {
        let token = quoted(&samples[i].token, 40);
        return Err(FormatError::new(format!(
            "sample {token}: no sensor's data, expected at least one"
        )));
    }
    let reference: Vec<&SampleData> = reference.into_iter().flatten().collect();
    let global_from_ego = ego_poses(source, &reference)?;
    let (world_from_global, is_own) = world_from_global(source, &scene, &global_from_ego[0])?;
    let (mut frames, from) = (Vec::new(), samples[0].timestamp);
    let labels_of = lidarseg(source, &reference)?;
    for ((sample, data), pose) in samples.iter().zip(&reference).zip(&global_from_ego) {
        frames.push(KeyFrame {
            token: sample.token.clone(),
            time_s: (sample.timestamp - from) as f64 / 1e6,
            world_from_ego: world_from_global * *pose,
            sweep: sweep(&kinds, data, &labels_of)?,
        });
    }
    Ok(Recording {
        objects: objects(source, &place, &world_from_global, skipped)?,
        labels: label_classes(source)?,
        name: scene.title.unwrap_or(scene.name),
        description: scene.description,
        frames,
        rig,
        world_from_global,
        is_own,
    })
}

/// The key frames of a scene in order of time.
fn samples(
    source: &ImportFile<'_>,
    scene: &SceneRow,
    skipped: &mut Skipped,
) -> Result<Vec<NuscenesSample>, FormatError> {
    let mut samples: Vec<NuscenesSample> = rows::of(source, "sample", |row: &NuscenesSample| {
        row.scene_token == scene.token
    })?;
    samples.sort_by(|a, b| (a.timestamp, &a.token).cmp(&(b.timestamp, &b.token)));
    let found = samples.len();
    samples.dedup_by_key(|s| s.timestamp);
    count(
        skipped,
        "key frames at the time of another",
        found - samples.len(),
    );
    let span = samples.first().zip(samples.last());
    let span_us = span.map(|(a, b)| i128::from(b.timestamp) - i128::from(a.timestamp));
    match span_us {
        None => Err(FormatError::new(format!(
            "scene {}: 0 samples, expected at least one",
            quoted(&scene.name, 40)
        ))),
        Some(us) if us as f64 > scene::Clip::MAX_LENGTH_S * 1e6 => Err(FormatError::new(format!(
            "scene {}: {} s from first to last sample, expected at most {}",
            quoted(&scene.name, 40),
            us / 1_000_000,
            scene::Clip::MAX_LENGTH_S
        ))),
        Some(_) => Ok(samples),
    }
}

/// Sensors by the token of their calibration.
pub(super) struct Kinds<'a> {
    by_token: HashMap<&'a str, (&'a CalibratedSensor, &'a NuscenesSensor)>,
    /// Channels in the order of the table.
    pub(super) channels: Vec<&'a str>,
}

impl<'a> Kinds<'a> {
    fn new(sensors: &'a [NuscenesSensor], calibrated: &'a [CalibratedSensor]) -> Self {
        let by_token: HashMap<&str, &NuscenesSensor> = sensors.iter().map(|s| (&*s.token, s)).collect();
        let pair = |c: &'a CalibratedSensor| Some((&*c.token, (c, *by_token.get(&*c.sensor_token)?)));
        Self {
            by_token: calibrated.iter().filter_map(pair).collect(),
            channels: sensors.iter().map(|s| &*s.channel).collect(),
        }
    }

    /// Places of all LiDARs that the tables know in the ego frame, m.
    pub(super) fn lidar_places(&self) -> impl Iterator<Item = DVec3> + '_ {
        let lidars = self
            .by_token
            .values()
            .filter(|(_, sensor)| sensor.modality == "lidar");
        lidars.map(|(calibrated, _)| DVec3::from_array(calibrated.translation))
    }

    /// The sensor that measured something.
    pub(super) fn of(&self, data: &SampleData) -> Option<(&'a CalibratedSensor, &'a NuscenesSensor)> {
        self.by_token.get(&*data.calibrated_sensor_token).copied()
    }
}

/// For each key frame the file whose ego pose is used: that of the LiDAR, else that of the first sensor there is.
fn reference<'a>(
    kinds: &Kinds<'_>,
    data: &'a [SampleData],
    place: &HashMap<&str, usize>,
    frames: usize,
) -> Vec<Option<&'a SampleData>> {
    let rank = |data: &SampleData| match kinds.of(data).map(|(_, sensor)| sensor) {
        Some(sensor) if sensor.channel == LIDAR => 0,
        Some(sensor) if sensor.modality == "lidar" => 1,
        Some(_) => 2,
        None => 3,
    };
    let mut out: Vec<Option<&SampleData>> = vec![None; frames];
    for row in data {
        let Some(slot) = place.get(&*row.sample_token).map(|i| &mut out[*i]) else {
            continue;
        };
        if slot.is_none_or(|best| rank(row) < rank(best)) {
            *slot = Some(row);
        }
    }
    out
}

/// Poses of the vehicle, one for each.
fn ego_poses(source: &ImportFile<'_>, of: &[&SampleData]) -> Result<Vec<Pose>, FormatError> {
    let wanted: HashSet<&str> = of.iter().map(|d| &*d.ego_pose_token).collect();
    let found: Vec<EgoPose> = rows::of(source, "ego_pose", |row: &EgoPose| wanted.contains(&*row.token))?;
    let by_token: HashMap<&str, &EgoPose> = found.iter().map(|p| (&*p.token, p)).collect();
    let one = |data: &&SampleData| {
        let what = format!("ego pose {}", quoted(&data.ego_pose_token, 40));
        let row = by_token.get(&*data.ego_pose_token);
        let row = row.ok_or_else(|| FormatError::new(format!("{what}: not in ego_pose.json")))?;
        let pose = pose(&what, row.rotation, row.translation).map_err(FormatError::new)?;
        match pose.translation_m.abs().max_element() <= FARTHEST_M {
            true => Ok(pose),
            false => Err(FormatError::new(format!(
                "{what}: translation {}, expected within {FARTHEST_M} m",
                pose.translation_m
            ))),
        }
    };
    of.iter().map(one).collect()
}

/// The frame that the scene's coordinates are in, see the module above, and whether Sceneloom wrote the folder.
fn world_from_global(
    source: &ImportFile<'_>,
    scene: &SceneRow,
    first: &Pose,
) -> Result<(Pose, bool), FormatError> {
    let maps: Vec<NuscenesMap> = rows::of_optional(source, "map", |row: &NuscenesMap| {
        row.log_tokens.contains(&scene.log_token)
    })?;
    let origin_m = maps.iter().find_map(|m| m.world_origin_m);
    Ok(
        match origin_m.filter(|o| o.iter().all(|v| v.abs() <= FARTHEST_M)) {
            Some([x, y]) => {
                let world_from_global = Pose {
                    rotation: DQuat::IDENTITY,
                    translation_m: DVec3::new(-x, -y, 0.0),
                };
                (world_from_global, true)
            }
            None => {
                let at = first.translation_m;
                let mut global_from_world = Pose::planar(at.x, at.y, yaw_rad(first.rotation));
                global_from_world.translation_m.z = at.z;
                (global_from_world.inverse(), false)
            }
        },
    )
}

/// Files of labels by the token of their sweep.
fn lidarseg(source: &ImportFile<'_>, of: &[&SampleData]) -> Result<HashMap<String, String>, FormatError> {
    let wanted: HashSet<&str> = of.iter().map(|d| &*d.token).collect();
    let rows: Vec<Lidarseg> = rows::of_optional(source, "lidarseg", |row: &Lidarseg| {
        wanted.contains(&*row.sample_data_token)
    })?;
    Ok(rows
        .into_iter()
        .map(|r| (r.sample_data_token, r.filename))
        .collect())
}

fn sweep(
    kinds: &Kinds<'_>,
    data: &SampleData,
    labels_of: &HashMap<String, String>,
) -> Result<Option<RecordedSweep>, FormatError> {
    let Some((calibrated, _)) = kinds.of(data).filter(|(_, sensor)| sensor.modality == "lidar") else {
        return Ok(None);
    };
    let ego_from_lidar = pose("LiDAR", calibrated.rotation, calibrated.translation);
    let ego_from_lidar = ego_from_lidar.map_err(FormatError::new)?;
    Ok(Some(RecordedSweep {
        filename: data.filename.clone(),
        labels: labels_of.get(&data.token).cloned(),
        sensor_m: rig::lidar_place(kinds, &ego_from_lidar),
        ego_from_lidar,
    }))
}

/// Class of each number in lidarseg files.
fn label_classes(source: &ImportFile<'_>) -> Result<Vec<Option<Class>>, FormatError> {
    let categories: Vec<Category> = rows::of(source, "category", |_| true)?;
    let mut out = vec![Some(Class::Others); 256];
    for category in &categories {
        if let Some(index) = category.index {
            out[usize::from(index)] = match categories::meaning(&category.name) {
                Some(Means::Nothing) => None,
                Some(Means::Class(class) | Means::Named(class, _)) => Some(class),
                None => Some(Class::Others),
            };
        }
    }
    Ok(out)
}

/// Boxes of the key frames by object, in the order of the table of instances.
fn objects(
    source: &ImportFile<'_>,
    place: &HashMap<&str, usize>,
    world_from_global: &Pose,
    skipped: &mut Skipped,
) -> Result<Vec<Object>, FormatError> {
    let annotations: Vec<SampleAnnotation> =
        rows::of(source, "sample_annotation", |row: &SampleAnnotation| {
            place.contains_key(&*row.sample_token)
        })?;
    let mut of_instance: HashMap<&str, Vec<&SampleAnnotation>> = HashMap::new();
    for row in &annotations {
        of_instance.entry(&row.instance_token).or_default().push(row);
    }
    let instances: Vec<Instance> = rows::of(source, "instance", |row: &Instance| {
        of_instance.contains_key(&*row.token)
    })?;
    let categories: Vec<Category> = rows::of(source, "category", |_| true)?;
    let name_of: HashMap<&str, &str> = categories.iter().map(|c| (&*c.token, &*c.name)).collect();
    let attributes: Vec<Attribute> = rows::of_optional(source, "attribute", |_| true)?;
    let parked: HashSet<&str> = attributes
        .iter()
        .filter(|a| ["vehicle.parked", "vehicle_state.parked"].contains(&&*a.name))
        .map(|a| &*a.token)
        .collect();
    let mut out = Vec::new();
    for instance in &instances {
        let Some(rows) = of_instance.remove(&*instance.token) else {
            continue;
        };
        let name = name_of
            .get(&*instance.category_token)
            .copied()
            .unwrap_or("no category");
        let (class, called) = match categories::meaning(name) {
            Some(Means::Class(class)) => (class, ""),
            Some(Means::Named(class, called)) => (class, called),
            _ => (Class::Others, ""),
        };
        if !class.is_object() {
            count(skipped, &format!("boxes of {}", quoted(name, 40)), rows.len());
            continue;
        }
        let mut object = Object {
            class,
            label: BoxLabel {
                name: BoxName::new(called),
                paint: None,
            },
            parked: rows
                .iter()
                .all(|row| row.attribute_tokens.iter().any(|t| parked.contains(&**t))),
            boxes: BTreeMap::new(),
        };
        for row in rows {
            let Some(annotation) = annotation(row, world_from_global) else {
                count(skipped, "boxes that are not finite", 1);
                continue;
            };
            if object
                .boxes
                .insert(place[&*row.sample_token], annotation)
                .is_some()
            {
                count(skipped, "boxes of an object that has another in its key frame", 1);
            }
        }
        out.push(object);
    }
    count(
        skipped,
        "boxes of no instance",
        of_instance.values().map(Vec::len).sum(),
    );
    Ok(out)
}

/// `None` if a number is not finite or the quaternion is none.
fn annotation(row: &SampleAnnotation, world_from_global: &Pose) -> Option<Annotation> {
    let at = pose("box", row.rotation, row.translation).ok()?;
    let at = *world_from_global * at;
    let [width, length, height] = row.size;
    let sound = DVec3::new(length, width, height);
    (at.translation_m.is_finite() && sound.is_finite()).then_some(Annotation {
        center_m: at.translation_m,
        size_m: sound,
        yaw_rad: yaw_rad(at.rotation),
    })
}
