//! What comes back of sweeps that were written as points.

use std::collections::BTreeMap;

use glam::DVec3;
use scene::{CameraMaps, Class, LidarPoint, LidarSweep, Scene, VoxelGrid, Window};

use crate::export::{self, BoxVisibility, ExportPicture, Exporter, OutFile, Products};
use crate::import::{self, Content, ImportedScene};
use crate::table_tests::random_scene;
use crate::{FormatError, semantic_kitti};

/// Products of one sweep.
pub(crate) struct OneSweep(pub(crate) LidarSweep);

fn absent<T>() -> Result<T, FormatError> {
    Err(FormatError::new("only a sweep"))
}

impl Products for OneSweep {
    fn show(&mut self, _time_s: f64) -> Result<(), FormatError> {
        Ok(())
    }

    fn seen(&mut self) -> Result<BoxVisibility, FormatError> {
        absent()
    }

    fn sweep(&mut self) -> Result<LidarSweep, FormatError> {
        Ok(self.0.clone())
    }

    fn sweep_edits(&mut self, _: usize) -> Result<scene::SweepEdits, FormatError> {
        absent()
    }

    fn radars(&mut self) -> Result<Vec<scene::RadarScan>, FormatError> {
        absent()
    }

    fn camera_maps(
        &mut self,
        _take: &mut dyn FnMut(CameraMaps) -> Result<(), FormatError>,
    ) -> Result<(), FormatError> {
        absent()
    }

    fn pictures(
        &mut self,
        _take: &mut dyn FnMut(ExportPicture) -> Result<(), FormatError>,
    ) -> Result<(), FormatError> {
        absent()
    }

    fn observed(&mut self) -> Result<crate::export::ObservationMasks, FormatError> {
        absent()
    }

    fn truth(
        &mut self,
        _take: &mut dyn FnMut(ExportPicture, scene::CameraTruth) -> Result<(), FormatError>,
    ) -> Result<(), FormatError> {
        absent()
    }

    fn gaussians(&mut self) -> Result<scene::GaussianScene, FormatError> {
        absent()
    }

    fn recipe(&self) -> &crate::recipe::Recipe {
        crate::table_tests::Small.recipe()
    }

    fn world_from_ego(&self) -> scene::Pose {
        scene::Pose::IDENTITY
    }

    fn view(&mut self) -> Result<ExportPicture, FormatError> {
        absent()
    }
}

/// A point with this class, in the ego frame.
pub(crate) fn point(at: DVec3, class: Class) -> LidarPoint {
    LidarPoint {
        position_in_ego: at.as_vec3().to_array(),
        range_m: at.length() as f32,
        ring: 7,
        azimuth: 1,
        class,
        intensity: 51.0,
        drop_probability: 0.0,
        time_s: -0.025,
        velocity_mps: [0.0; 2],
    }
}

/// These points as they are: where the ground lies is where it lies.
pub(crate) fn sweep(points: Vec<LidarPoint>) -> LidarSweep {
    LidarSweep {
        rays: points.len(),
        points,
        physical: true,
        provenance: Vec::new(),
    }
}

/// A point in the middle of every voxel of a scene.
fn middles(scene: &Scene) -> LidarSweep {
    let voxels = scene.frame().occupancy.iter_set();
    let point = |(x, y, z, label)| point(Window::center(x, y, z), Class::from_id(label).expect("a class"));
    sweep(voxels.map(point).collect())
}

/// Writes a sweep and reads the files.
pub(crate) fn back(exporter: &Exporter, scene: &Scene, sweep: LidarSweep) -> ImportedScene {
    let files = (exporter.write)(scene, &mut OneSweep(sweep)).expect(exporter.id);
    let folder = in_folder(&files);
    let path = match files.as_slice() {
        [file] => folder.path().join(&file.name),
        _ => folder.path().to_path_buf(),
    };
    match import::read(&path).expect(exporter.id).1 {
        Content::Scene(loaded) => *loaded,
        other => panic!("{other:?}: expected a scene"),
    }
}

/// A folder with these files.
pub(crate) fn in_folder(files: &[OutFile]) -> tempfile::TempDir {
    let folder = tempfile::tempdir().expect("a folder");
    for file in files {
        let path = folder.path().join(&file.name);
        std::fs::create_dir_all(path.parent().expect("a folder")).expect("made");
        std::fs::write(path, &file.bytes).expect("written");
    }
    folder
}

/// What comes back of the middles of voxels with these classes: all of them, but what is "others" where the own vehicle is, and
/// ground, if most of the road around the vehicle lies in bin 1 or 2, lower by as many bins.
fn expected(scene: &Scene, class_of: fn(Class) -> Class) -> VoxelGrid {
    let voxels: Vec<([usize; 3], Class)> = scene
        .frame()
        .occupancy
        .iter_set()
        .map(|(x, y, z, label)| ([x, y, z], class_of(Class::from_id(label).expect("a class"))))
        .filter(|([x, y, z], class)| {
            let at = Window::center(*x, *y, *z) - DVec3::new(1.0, 0.0, 0.78);
            let is_own = at.abs().cmplt(DVec3::new(2.24, 1.065, 0.98)).all() && at.z + 0.78 > 0.3;
            !(is_own && *class == Class::Others)
        })
        .collect();
    let median = |is: fn(Class) -> bool| {
        let near = |[x, y, _]: [usize; 3]| Window::center(x, y, 0).truncate().length() <= 20.0;
        let mut bins: Vec<usize> = voxels
            .iter()
            .filter(|(v, c)| is(*c) && near(*v))
            .map(|(v, _)| v[2])
            .collect();
        bins.sort_unstable();
        (bins.len() >= 20).then(|| bins[(bins.len() - 1) / 2])
    };
    let level = median(|c| c == Class::DriveableSurface).or_else(|| median(Class::is_ground));
    let down = level.filter(|bin| (1..=2).contains(bin)).unwrap_or(0);
    let mut votes: BTreeMap<[usize; 3], BTreeMap<u8, usize>> = BTreeMap::new();
    for ([x, y, z], class) in voxels {
        let z = if class.is_ground() {
            z.saturating_sub(down)
        } else {
            z
        };
        *votes.entry([x, y, z]).or_default().entry(class.id()).or_default() += 1;
    }
    let mut grid = VoxelGrid::new();
    for ([x, y, z], votes) in votes {
        let most = *votes.values().max().expect("a vote");
        let mut best: Vec<u8> = votes
            .into_iter()
            .filter(|(_, n)| *n == most)
            .map(|(c, _)| c)
            .collect();
        best.sort_by_key(|c| (*c == Class::Others.id(), *c));
        grid.set(x, y, z, best[0]);
    }
    grid
}

/// Formats that name the classes of Occ3D.
const WITH_CLASSES: [&Exporter; 4] = [
    &export::pcd::EXPORTER,
    &export::ply::EXPORTER,
    &export::las::EXPORTER,
    &export::las::PACKED,
];

/// A hundred random scenes, each in one of the formats in turn, the first in all of them.
fn each_scene(formats: &[&'static Exporter], test: impl Fn(&'static Exporter, &Scene)) {
    for seed in 0..100 {
        let scene = random_scene(seed);
        for (i, exporter) in formats.iter().enumerate() {
            if seed == 0 || seed as usize % formats.len() == i {
                test(exporter, &scene);
            }
        }
    }
}

#[test]
fn voxels_come_back_with_their_classes() {
    each_scene(&WITH_CLASSES, |exporter, scene| {
        let found = back(exporter, scene, middles(scene));
        assert!(
            found.scene.frame().occupancy == expected(scene, |c| c),
            "{}",
            exporter.id
        );
    });
}

#[test]
fn kitti_brings_back_the_classes_it_knows() {
    each_scene(&[&export::kitti::EXPORTER], |exporter, scene| {
        let found = back(exporter, scene, middles(scene));
        let known = |c| semantic_kitti::class_of_point(semantic_kitti::label_of(c, false)).expect("written");
        assert!(found.scene.frame().occupancy == expected(scene, known));
    });
}

/// A scan without labels keeps what stands where it is; ground may be lowered, and classes are told by shape.
#[test]
fn scans_without_labels_bring_back_where_something_is() {
    let checked = std::cell::Cell::new(0);
    each_scene(&[&export::nuscenes_lidar::EXPORTER], |exporter, scene| {
        // As it is: nothing is taken to the physical ground.
        let mut sweep = middles(scene);
        sweep.physical = true;
        let found = back(exporter, scene, sweep);
        // Voxels at random may look like ground on which the sweep is put.
        if !found.notes.is_empty() {
            return;
        }
        checked.set(checked.get() + 1);
        let before = expected(scene, |_| Class::Others);
        let (before, after) = (&before, &found.scene.frame().occupancy);
        for [x, y] in after.extent().all_columns() {
            let is_set = |column: &[u8]| column.iter().any(|l| *l != Class::FREE);
            assert_eq!(is_set(before.column(x, y)), is_set(after.column(x, y)), "{x} {y}");
        }
        let things = after.iter_set().filter(|(.., l)| !(11..=14).contains(l));
        for (x, y, z, _) in things {
            assert_ne!(before.get(x, y, z), Class::FREE, "{x} {y} {z}");
        }
        assert_eq!(found.inferred[0], "classes");
    });
    assert!(checked.get() > 50, "{}", checked.get());
}
