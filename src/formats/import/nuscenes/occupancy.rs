//! Voxels from measurements: Occ3D labels or LiDAR sweeps of the key frames, put together in the world frame. Moving
//! objects are taken out; tracks have voxels of their own.

use std::sync::Arc;

use glam::DVec3;
use scene::{
    BevLayer, BevLayout, BoxId, Class, Extent, SceneBox, SensorRig, SweepRecording, Unobserved, VoxelGrid,
    Window, draft, infer,
};

use super::objects::{RecordedObjects, holds};
use super::read::{KeyFrame, RecordedSweep, Recording};
use super::{Skipped, count};
use crate::import::ImportFile;
use crate::import::drive::survey::{SurveyedDrive, SurveyedWorld};
use crate::import::imported_sweep::{ImportedSweep, SweepSource};
use crate::occ3d;
use crate::sweep_file;

/// Largest file of a sweep or of its labels, bytes: a hundred times those of the data set.
const LARGEST_SWEEP: u64 = 64 << 20;
/// Bytes of a point.
const POINT: usize = 20;
/// A point this far outside of a box still comes from what is in it, m.
const MARGIN_M: f64 = 0.15;
/// A voxel this far outside of a box still belongs to what is in it, m.
const VOXEL_MARGIN_M: f64 = Window::VOXEL_M;
/// Classes that a number can hold beside its voxel.
const CLASSES: u64 = 32;

/// The parts of the scene that stand still.
pub(super) struct StaticScene {
    pub(super) layout: BevLayout,
    pub(super) voxels: VoxelGrid,
    pub(super) unobserved: Option<Unobserved>,
}

impl StaticScene {
    /// What shapes tell, with drafts of the objects that stand.
    pub(super) fn of_shapes(world: SurveyedWorld, things: &RecordedObjects) -> Self {
        let world = world.with_drafts(things.standing.values());
        Self {
            layout: world.layout,
            voxels: world.voxels,
            unobserved: None,
        }
    }
}

/// `None` if there is neither a label nor a sweep on the map.
pub(super) fn observed(
    source: &ImportFile<'_>,
    recording: &Recording,
    things: &RecordedObjects,
    extent: Extent,
    skipped: &mut Skipped,
) -> Option<StaticScene> {
    let mut touched = vec![true; extent.columns()];
    let (mut voxels, unobserved) = match labels(source, recording, things, extent, &mut touched, skipped) {
        Some((voxels, unobserved)) => (voxels, unobserved),
        None => (sweeps(source, recording, things, extent, skipped)?, None),
    };
    let layout = infer::layout(&voxels);
    lay_ground(&mut voxels, &layout, &touched);
    Some(StaticScene {
        layout,
        voxels,
        unobserved,
    })
}

/// The sweeps of the key frames, to be kept with the scene; `None` if there are none. Those that cannot be read are left out: their
/// points are counted where voxels are made.
pub(super) fn kept_sweeps(
    source: &ImportFile<'_>,
    recording: &Recording,
    drive: Option<Arc<SurveyedDrive>>,
) -> Option<ImportedSweep> {
    let sweep = |frame: &KeyFrame| {
        let sweep = frame.sweep.as_ref()?;
        let bytes = source
            .beside(&in_data_set(&sweep.filename)?, LARGEST_SWEEP)
            .ok()?;
        let is_whole = !bytes.is_empty() && bytes.len().is_multiple_of(POINT);
        let world_from_file = frame.world_from_ego * sweep.ego_from_lidar;
        is_whole.then(|| SweepSource {
            name: sweep.filename.rsplit('/').next().unwrap_or_default().to_owned(),
            format: sweep_file::NUSCENES,
            bytes: Arc::new(bytes),
            time_s: frame.time_s,
            world_from_file,
            sensor_m: frame.world_from_ego.apply(sweep.sensor_m),
        })
    };
    let files: Vec<SweepSource> = recording
        .frames
        .iter()
        .filter_map(sweep)
        .take(SweepRecording::MOST)
        .collect();
    let first = files.first()?;
    let mut all = ImportedSweep::without_returns(first.world_from_file, first.sensor_m);
    (all.files, all.drive) = (files, drive);
    Some(all)
}

/// Adds ground voxels where the layout has ground and the voxels have none: between the rings of a LiDAR, and where
/// moving objects were taken out.
fn lay_ground(voxels: &mut VoxelGrid, layout: &BevLayout, touched: &[bool]) {
    let ground = BevLayer::DrivableArea.bit() | BevLayer::Walkway.bit();
    for (at, [x, y]) in layout.extent().all_columns().enumerate() {
        let cell = layout.cell(x, y);
        let bin = draft::ground_bin(layout, x, y);
        let is_ground = |l: &u8| Class::from_id(*l).is_some_and(Class::is_ground);
        let column = voxels.column(x, y);
        if touched[at] && cell & ground != 0 && column[bin] == Class::FREE && !column.iter().any(is_ground) {
            voxels.set(x, y, bin, draft::ground_class(cell).id());
        }
    }
}

/// True for a name that a folder may have.
fn is_plain(name: &str) -> bool {
    !name.is_empty() && name != "." && name != ".." && !name.contains(['/', '\\', ':', '\0'])
}

/// Path of a file of the data set, from the folder of its tables; `None` for a path that leads out of the data set.
pub(super) fn in_data_set(filename: &str) -> Option<String> {
    filename
        .split('/')
        .all(is_plain)
        .then(|| format!("../{filename}"))
}

/// Occ3D labels of the key frames, each column from the nearest one that has them.
fn labels(
    source: &ImportFile<'_>,
    recording: &Recording,
    things: &RecordedObjects,
    extent: Extent,
    touched: &mut [bool],
    skipped: &mut Skipped,
) -> Option<(VoxelGrid, Option<Unobserved>)> {
    let files: Vec<(usize, String)> = (recording.frames.iter().enumerate())
        .filter_map(|(i, f)| Some((i, labels_path(source, recording, f)?)))
        .collect();
    if files.is_empty() {
        return None;
    }
    let nearest: Vec<usize> = extent
        .all_columns()
        .map(|[x, y]| {
            let p = extent.center(x, y, 0).truncate();
            let away = |i: &usize| {
                let ego = recording.frames[files[*i].0].world_from_ego.translation_m;
                ego.truncate().distance_squared(p)
            };
            (0..files.len())
                .min_by(|a, b| away(a).total_cmp(&away(b)))
                .unwrap_or(0)
        })
        .collect();
    let mut voxels = VoxelGrid::over(extent);
    let (mut words, mut masked, mut any) =
        (vec![extent.lattice().all_bins(); extent.columns()], false, false);
    touched.fill(false);
    for (i, (frame, path)) in files.iter().enumerate() {
        let labels = source.beside(path, occ3d::LARGEST_FILE);
        let Some(labels) = labels.ok().and_then(|bytes| occ3d::read(&bytes).ok()) else {
            count(skipped, "Occ3D labels that could not be read", 1);
            continue;
        };
        any = true;
        let hidden = occ3d_unobserved(&labels);
        masked |= hidden.is_some();
        let ego_from_world = recording.frames[*frame].world_from_ego.inverse();
        for (at, [x, y]) in extent
            .all_columns()
            .enumerate()
            .filter(|(at, _)| nearest[*at] == i)
        {
            let center = extent.center(x, y, 0);
            let p = ego_from_world.apply(center.with_z(0.0));
            let Some([u, v]) = Window::column_at(p.x, p.y) else {
                continue;
            };
            let mut column = *labels.labels.window_column(u, v);
            touched[at] = take_out(&mut column, &things.moving[*frame], center);
            if column.iter().any(|l| *l != Class::FREE) {
                *voxels.window_column_mut(x, y) = column;
            }
            words[at] = hidden.as_ref().map_or(0, |h| h.words()[u * Window::NY + v]);
        }
    }
    let unobserved = masked.then(|| Unobserved::from_words(extent, words)).flatten();
    any.then_some((voxels, unobserved))
}

fn occ3d_unobserved(frame: &occ3d::Occ3dFrame) -> Option<Unobserved> {
    let seen = match (&frame.lidar_observed, &frame.camera_observed) {
        (Some(lidar), Some(camera)) => lidar.iter().zip(camera).map(|(a, b)| *a || *b).collect(),
        (Some(one), None) | (None, Some(one)) => one.clone(),
        (None, None) => return None,
    };
    Unobserved::from_observed(&seen)
}

/// Frees the voxels of moving objects in a column; true if there were any.
fn take_out(column: &mut [u8; Window::NZ], moving: &[SceneBox], center: DVec3) -> bool {
    let mut any = false;
    for b in moving {
        if !b.contains(center.with_z(b.center_m.z), VOXEL_MARGIN_M) {
            continue;
        }
        for label in column.iter_mut().filter(|l| **l == b.class.id()) {
            *label = Class::FREE;
            any = true;
        }
    }
    any
}

/// Points of the sweeps by the vote of each voxel, and the drafts of standing boxes.
fn sweeps(
    source: &ImportFile<'_>,
    recording: &Recording,
    things: &RecordedObjects,
    extent: Extent,
    skipped: &mut Skipped,
) -> Option<VoxelGrid> {
    let mut votes = Votes {
        extent,
        voxels: Vec::new(),
        not_finite: 0,
        elsewhere: 0,
    };
    for (frame, moving) in recording.frames.iter().zip(&things.moving) {
        let Some(sweep) = &frame.sweep else { continue };
        let read = |filename: &str| source.beside(&in_data_set(filename)?, LARGEST_SWEEP).ok();
        let Some(points) = read(&sweep.filename) else {
            count(skipped, "LiDAR sweeps that could not be read", 1);
            continue;
        };
        let labels = sweep.labels.as_deref().map(|f| read(f).unwrap_or_default());
        let labels = labels.filter(|labels| {
            let fits = labels.len() == points.len() / POINT;
            count(
                skipped,
                "lidarseg files of another length than their sweep",
                usize::from(!fits),
            );
            fits
        });
        count(
            skipped,
            "LiDAR sweeps that end within a point",
            usize::from(!points.len().is_multiple_of(POINT)),
        );
        votes.add(
            recording,
            (frame, sweep),
            &points,
            labels.as_deref(),
            (things, moving),
        );
    }
    count(skipped, "points that are not finite", votes.not_finite);
    count(skipped, "points beside the map", votes.elsewhere);
    let mut voxels = votes.grid()?;
    things
        .standing
        .values()
        .for_each(|b| draft::stamp_box(&mut voxels, b));
    Some(voxels)
}

/// Points on the map, each as its voxel and class in one number.
struct Votes {
    extent: Extent,
    voxels: Vec<u64>,
    not_finite: usize,
    elsewhere: usize,
}

impl Votes {
    /// The points of a sweep but for those in boxes and on the own vehicle.
    fn add(
        &mut self,
        recording: &Recording,
        (frame, sweep): (&KeyFrame, &RecordedSweep),
        points: &[u8],
        labels: Option<&[u8]>,
        (things, moving): (&RecordedObjects, &[SceneBox]),
    ) {
        let standing: Vec<(&BoxId, &SceneBox)> = things.standing.iter().collect();
        for (i, point) in points.chunks_exact(POINT).enumerate() {
            let number = |axis: usize| {
                let bytes = &point[4 * axis..4 * axis + 4];
                f64::from(f32::from_le_bytes([bytes[0], bytes[1], bytes[2], bytes[3]]))
            };
            let in_lidar = DVec3::new(number(0), number(1), number(2));
            if !in_lidar.is_finite() {
                self.not_finite += 1;
                continue;
            }
            let class = match labels {
                Some(labels) => recording.labels[usize::from(labels[i])],
                None => Some(Class::Others),
            };
            let (in_ego, Some(class)) = (sweep.ego_from_lidar.apply(in_lidar), class) else {
                continue;
            };
            let p = frame.world_from_ego.apply(in_ego);
            let in_box = |b: &SceneBox| holds(b, p, MARGIN_M);
            if on_vehicle(&recording.rig, in_ego)
                || moving.iter().any(in_box)
                || standing.iter().any(|(_, b)| in_box(b))
            {
                continue;
            }
            // In labels the ground lies two bins lower than it is.
            let voxel = match class.is_ground() {
                true => {
                    let column = self.extent.column_at(p.x, p.y);
                    column.map(|[x, y]| [x, y, scene::Lattice::OCC3D.ground_bin(p.z)])
                }
                false => self.extent.voxel_at(p),
            };
            match voxel {
                Some([x, y, z]) => {
                    let at = (self.extent.index(x, y) * Window::NZ + z) as u64;
                    self.voxels.push(at * CLASSES + u64::from(class.id()));
                }
                None => self.elsewhere += 1,
            }
        }
    }

    /// Each voxel gets the class that most of its points have; of equally many the lowest class, "others" last. `None`
    /// without any point.
    fn grid(mut self) -> Option<VoxelGrid> {
        self.voxels.sort_unstable();
        let mut grid = VoxelGrid::over(self.extent);
        for points in self.voxels.chunk_by(|a, b| a / CLASSES == b / CLASSES) {
            let votes = points.chunk_by(|a, b| a == b);
            let winner = votes.max_by_key(|v| {
                let class = v[0] % CLASSES;
                (v.len(), class != 0, std::cmp::Reverse(class))
            })?;
            let at = (winner[0] / CLASSES) as usize;
            let [x, y] = self.extent.column(at / Window::NZ);
            grid.set(x, y, at % Window::NZ, (winner[0] % CLASSES) as u8);
        }
        (!self.voxels.is_empty()).then_some(grid)
    }
}

/// Places of the points of a sweep, in m in the frame of the LiDAR; `None` if it cannot be read or is cut.
pub(super) fn sweep_points(
    source: &ImportFile<'_>,
    sweep: &RecordedSweep,
) -> Option<impl Iterator<Item = DVec3> + use<>> {
    let bytes = source
        .beside(&in_data_set(&sweep.filename)?, LARGEST_SWEEP)
        .ok()?;
    if bytes.is_empty() || !bytes.len().is_multiple_of(POINT) {
        return None;
    }
    let points = 0..bytes.len() / POINT;
    Some(points.map(move |i| {
        let number = |axis: usize| {
            let from = i * POINT + 4 * axis;
            let bytes = bytes[from..].first_chunk().copied().unwrap_or_default();
            f64::from(f32::from_le_bytes(bytes))
        };
        DVec3::new(number(0), number(1), number(2))
    }))
}

/// True if the key frames have labels of their voxels or their points.
pub(super) fn is_labelled(source: &ImportFile<'_>, recording: &Recording) -> bool {
    recording.frames.iter().any(|frame| {
        let has_points = frame.sweep.as_ref().is_some_and(|sweep| sweep.labels.is_some());
        has_points || labels_path(source, recording, frame).is_some()
    })
}

/// Path of the Occ3D labels of a key frame, if they are there.
fn labels_path(source: &ImportFile<'_>, recording: &Recording, frame: &KeyFrame) -> Option<String> {
    let plain = is_plain(&recording.name) && is_plain(&frame.token);
    let path = format!("../gts/{}/{}/labels.npz", recording.name, frame.token);
    let there = source.place(&path).is_ok_and(|p| p.is_file());
    (plain && there).then_some(path)
}

/// True for a return from the own vehicle.
pub(super) fn on_vehicle(rig: &SensorRig, p_in_ego: DVec3) -> bool {
    let half = DVec3::from_array(rig.ego_size_m) / 2.0 + MARGIN_M;
    let away = p_in_ego - DVec3::from_array(rig.ego_center_m);
    // Down to just above the road.
    away.abs().cmple(half).all() && p_in_ego.z > 0.2
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn paths_do_not_lead_out_of_the_data_set() {
        assert_eq!(
            in_data_set("samples/L/a.bin").as_deref(),
            Some("../samples/L/a.bin")
        );
        for bad in [
            "",
            "/etc/passwd",
            "../a",
            "samples/../../a",
            "samples//a",
            "C:/a",
            "a\\b",
            "a/\0",
        ] {
            assert_eq!(in_data_set(bad), None, "{bad:?}");
        }
    }
}
