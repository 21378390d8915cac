//! Scans of nuScenes (`.pcd.bin`): x, y, z, intensity and ring as f32, no header; with labels if they are beside it.
//!
//! A scan `NAME.pcd.bin` has its labels in `NAME_lidarseg.bin`, or in the only file in its folder whose name ends in
//! `_lidarseg.bin`: one byte a point, one of the 32 classes of nuScenes-lidarseg, or one of the 16 of its challenge
//! (those of Occ3D) if none is above 16. Points are in the frame of the sensor. Its pose is taken to be that of the
//! LiDAR of the default rig, the one of nuScenes, and a note says so. See `cloud` for the use of points with and
//! without labels.

use std::collections::BTreeMap;
use std::path::Path;

use scene::{Class, SensorRig};

use super::cloud::{Cloud, Label};
use super::scan::{ScanFormat, file_name, labels_beside};
use super::{Content, ImportFile, Importer};
use crate::{FormatError, Holds};

/// See the module.
pub const IMPORTER: Importer = Importer {
    id: "nuscenes-lidar",
    title: "nuScenes scans (.pcd.bin)",
    extensions: &[],
    holds: &[Holds::Points],
    largest: 512 << 20,
    recognises: |head| ScanFormat::NuScenes.are_in(head),
    in_folder: None,
    read,
    #[cfg(test)]
    sample: tests::sample,
};

/// Ending of the names of label files.
const LABELS: &str = "_lidarseg.bin";

/// Classes of nuScenes-lidarseg in their order, as Occ3D has them; none for noise and the own vehicle.
const CLASSES: [Option<Class>; 32] = [
    None,                             // noise
    Some(Class::Others),              // animal
    Some(Class::Pedestrian),          // adult
    Some(Class::Pedestrian),          // child
    Some(Class::Pedestrian),          // construction worker
    Some(Class::Others),              // personal mobility
    Some(Class::Pedestrian),          // police officer
    Some(Class::Others),              // stroller
    Some(Class::Others),              // wheelchair
    Some(Class::Barrier),             // barrier
    Some(Class::Others),              // debris
    Some(Class::Others),              // pushable, pullable
    Some(Class::TrafficCone),         // traffic cone
    Some(Class::Others),              // bicycle rack
    Some(Class::Bicycle),             // bicycle
    Some(Class::Bus),                 // bus, bendy
    Some(Class::Bus),                 // bus, rigid
    Some(Class::Car),                 // car
    Some(Class::ConstructionVehicle), // construction
    Some(Class::Others),              // ambulance
    Some(Class::Others),              // police
    Some(Class::Motorcycle),          // motorcycle
    Some(Class::Trailer),             // trailer
    Some(Class::Truck),               // truck
    Some(Class::DriveableSurface),    // driveable surface
    Some(Class::OtherFlat),           // other flat
    Some(Class::Sidewalk),            // sidewalk
    Some(Class::Terrain),             // terrain
    Some(Class::Manmade),             // manmade
    Some(Class::Others),              // other static
    Some(Class::Vegetation),          // vegetation
    None,                             // own vehicle
];

/// Reads such a file under any name.
pub(super) fn read(source: &ImportFile<'_>) -> Result<Content, FormatError> {
    let points = ScanFormat::NuScenes.read(source.bytes)?;
    let labels = match labels_name(source.path) {
        Some(name) => labels_beside(source, &name, (points.len(), 1))?,
        None => None,
    };
    let is_challenge = labels.as_ref().is_some_and(|l| l.iter().all(|id| *id <= 16));
    let rig = SensorRig::default();
    let ego_from_sensor = rig.lidars.first().map(scene::LidarPattern::ego_from_sensor);
    let ego_from_sensor = ego_from_sensor.unwrap_or_default();
    let (mut cloud, mut left_away) = (Cloud::of_guessed_sensor(source), 0);
    for (i, (at, strength)) in points.enumerate() {
        let label = match labels.as_ref().map(|l| l[i]) {
            None => Label::None,
            Some(id) if is_challenge => Class::from_id(id).map_or(Label::Unknown, Label::Class),
            Some(id) => match CLASSES.get(usize::from(id)) {
                None => Label::Unknown,
                Some(Some(class)) => Label::Class(*class),
                Some(None) => {
                    left_away += 1;
                    continue;
                }
            },
        };
        cloud.add_return(at, &ego_from_sensor, label, strength);
    }
    let [x, y, z] = ego_from_sensor.translation_m.to_array();
    let mut left_out = BTreeMap::from([
        (
            format!(
                "pose of the sensor, taken as in the default rig: {x:.2}, {y:.2}, {z:.2} m (unless the ground shows another height), x to the right"
            ),
            1,
        ),
        ("intensity".to_owned(), 1),
        ("ring".to_owned(), 1),
    ]);
    if left_away > 0 {
        left_out.insert("points of noise and of the own vehicle".into(), left_away);
    }
    let loaded = cloud.scene(source.name, left_out).map_err(FormatError::new)?;
    Ok(Content::Scene(Box::new(loaded)))
}

/// The name of the file of labels beside a scan.
fn labels_name(path: Option<&Path>) -> Option<String> {
    let (path, name) = (path?, file_name(path));
    let stem = name.strip_suffix(".bin").unwrap_or(&name);
    let own = format!("{}{LABELS}", stem.strip_suffix(".pcd").unwrap_or(stem));
    let folder = path
        .parent()
        .filter(|p| !p.as_os_str().is_empty())
        .unwrap_or(Path::new("."));
    if folder.join(&own).is_file() {
        return Some(own);
    }
    let names = std::fs::read_dir(folder).ok()?;
    let names = names.filter_map(|file| file.ok()?.file_name().into_string().ok());
    let mut names = names.filter(|name| name.ends_with(LABELS));
    let only = names.next()?;
    names.next().is_none().then_some(only)
}

#[cfg(test)]
#[path = "nuscenes_lidar_tests.rs"]
mod tests;
