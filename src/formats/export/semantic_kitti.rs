//! Occupancy as the voxels of SemanticKITTI: the labels, and which voxels one scan sees.

use glam::DVec3;
use scene::label_sets::SEMANTIC_KITTI;
use scene::solid::fill::SMEAR;
use scene::{Class, Frame, LidarSweep, Pose, Scene, Window};

use super::{ExportSpan, Exporter, ObservationMasks, OutFile, Product, Products};
use crate::semantic_kitti::{CELLS, LATTICE, ego_from_cells, own_map, packed};
use crate::voxels::{DataMap, Physical, cells_of, check, physical};
use crate::{FormatError, Holds};

/// See `semantic_kitti`.
pub const EXPORTER: Exporter = Exporter {
    id: "semantic-kitti",
    title: "Occupancy: SemanticKITTI voxels, 256 x 256 x 32 cells of 0.2 m ahead of the LiDAR, with what one scan sees",
    file_name: None,
    holds: &[Holds::Occupancy],
    lost: "of a scene in other voxels: what is behind the LiDAR, more than 51.2 m ahead of it, 25.6 m beside it or 2 m below it; barriers come back as \
           manmade, construction vehicles as trailers, traffic cones as others; things less than three voxels high come back \
           three high",
    span: ExportSpan::Moment,
    needs: &[Product::Sweep, Product::Observed],
    write,
};

/// Points of an exact sweep lie on the faces of voxels; moved by this along the ray they lie inside, m.
const INTO_M: f64 = 0.02;

fn write(scene: &Scene, products: &mut dyn Products) -> Result<Vec<OutFile>, FormatError> {
    let lidar = scene.rig.lidars.first();
    let lidar = lidar.ok_or_else(|| FormatError::new("the rig has no LiDAR, around which the voxels are"))?;
    let frame = scene.frame();
    let pose = ego_from_cells(lidar);
    let labels = match own_map_of(scene) {
        Some(map) => own_labels(frame, &map)?,
        None => resampled(frame, &pose)?,
    };
    let observed = products.observed()?;
    let (mut invalid, mut occluded) = (vec![false; CELLS], vec![false; CELLS]);
    for (index, label) in labels.iter().enumerate() {
        let p = pose.apply(LATTICE.center(LATTICE.cell(index)));
        invalid[index] = *label == 0 && !is_known(frame, p);
        occluded[index] = !is_seen(*label, &observed, p);
    }
    let scan = scan(&products.sweep()?, &labels, &pose);
    let file = |extension: &str, bytes| {
        OutFile::new(&format!("000000.{extension}"), bytes).within("sequences/00/voxels")
    };
    Ok(vec![
        file("bin", packed(&scan)),
        file("label", labels.iter().flat_map(|id| id.to_le_bytes()).collect()),
        file("invalid", packed(&invalid)),
        file("occluded", packed(&occluded)),
    ])
}

/// The data set's own map, if that of a scene holds it.
pub(super) fn own_map_of(scene: &Scene) -> Option<DataMap> {
    let map = own_map(scene.rig.lidars.first()?).ok()?;
    map.lies_in(scene.frame().extent()).then_some(map)
}

/// Raw ids of all cells, of a scene on the data set's own map.
fn own_labels(frame: &Frame, map: &DataMap) -> Result<Vec<u16>, FormatError> {
    check(frame)?;
    let frame = frame.crop(map.extent());
    let data_labels = frame.inferred.data_labels.as_ref();
    let data_labels = data_labels.filter(|labels| labels.set() == &SEMANTIC_KITTI);
    let mut labels = vec![0; CELLS];
    for (x, y, z, class) in frame.occupancy.iter_set() {
        let class = Class::from_id(class).unwrap_or(Class::Others);
        let usual = SEMANTIC_KITTI.label(class);
        let id = data_labels.map_or(usual, |labels| labels.label([x, y, z], class));
        labels[LATTICE.index(map.cell([x, y, z]))] = id;
    }
    Ok(labels)
}

/// Raw ids of all cells, of a scene in the voxels of Occ3D.
fn resampled(frame: &Frame, pose: &Pose) -> Result<Vec<u16>, FormatError> {
    let mut labels = vec![0; CELLS];
    for cell in cells_of(&physical(frame)?, &LATTICE, pose) {
        let class = Class::from_id(cell.class).unwrap_or(Class::Others);
        labels[LATTICE.index(cell.at.map(usize::from))] = SEMANTIC_KITTI.label(class);
    }
    Ok(labels)
}

/// True at a point of the map whose content the scene knows: within its edge, and not where a data set's masks say that
/// nothing observed it.
fn is_known(frame: &Frame, p_in_ego: DVec3) -> bool {
    frame.extent().voxel_at(p_in_ego).is_some_and(|[x, y, z]| {
        let unobserved = frame.inferred.unobserved.as_ref();
        unobserved.is_none_or(|u| u.words()[u.extent().index(x, y)] >> z & 1 == 0)
    })
}

/// True at a point, in a cell of a label, that a ray of the LiDAR passed or ended at. Rays met the ground where Occ3D has it.
fn is_seen(label: u16, observed: &ObservationMasks, p_in_ego: DVec3) -> bool {
    let Some([x, y, z]) = Physical::voxel_at(ObservationMasks::EXTENT, p_in_ego) else {
        return false;
    };
    let is_ground = SEMANTIC_KITTI.class(label).is_some_and(Class::is_ground);
    let bin = if is_ground { z.saturating_sub(SMEAR) } else { z };
    let word = observed.lidar.get(ObservationMasks::EXTENT.index(x, y));
    word.is_some_and(|word| u32::from(*word) >> bin & 1 == 1)
}

/// The cells in which a sweep has points. An exact sweep met the ground where Occ3D has it: its points there are
/// raised, and only points in a labelled cell count.
fn scan(sweep: &LidarSweep, labels: &[u16], pose: &Pose) -> Vec<bool> {
    let mut cells = vec![false; CELLS];
    for point in &sweep.points {
        let mut p = DVec3::from_array(point.position_in_ego.map(f64::from));
        if !sweep.physical {
            p += (p - pose.translation_m).normalize_or_zero() * INTO_M;
            if point.class.is_ground() {
                p.z += SMEAR as f64 * Window::VOXEL_M;
            }
        }
        let Some(cell) = LATTICE.cell_at(pose.inverse().apply(p)) else {
            continue;
        };
        let index = LATTICE.index(cell);
        cells[index] |= sweep.physical || labels[index] != 0;
    }
    cells
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::import::Content;
    use crate::semantic_kitti::bit;
    use crate::table_tests::{Small, random_scene, round_trip, scene};
    use scene::{BoxId, Extent, VoxelGrid};

    fn files(scene: &Scene, products: &mut dyn Products) -> [Vec<u8>; 4] {
        let files = write(scene, products).expect("written");
        let names: Vec<&str> = files.iter().map(|f| f.name.as_str()).collect();
        let folder = "sequences/00/voxels/000000";
        let expected = ["bin", "label", "invalid", "occluded"].map(|e| format!("{folder}.{e}"));
        assert_eq!(names, expected);
        let bytes: Vec<Vec<u8>> = files.into_iter().map(|f| f.bytes).collect();
        bytes.try_into().expect("four files")
    }

    /// Of a hundred scenes every column comes back that lies ahead of the LiDAR in the cells' range, with the classes that the
    /// format has, and things at least three voxels high.
    #[test]
    fn what_lies_ahead_comes_back() {
        let mut same = 0;
        for seed in 0..100 {
            let scene = random_scene(seed);
            let [_, label, ..] = files(&scene, &mut Small);
            let back = crate::import::semantic_kitti::labels(&label).expect("read");
            let mut physical = Physical::raised(&scene.frame().occupancy);
            let extent = Extent::WINDOW;
            for [x, y] in extent.all_columns() {
                let column = physical.column_mut(x, y);
                for label in column.iter_mut().filter(|label| **label != Class::FREE) {
                    let class = Class::from_id(*label).expect("a class");
                    *label = SEMANTIC_KITTI.shown(SEMANTIC_KITTI.label(class)).id();
                }
                column[..2].fill(Class::FREE); // below the cells
            }
            let expected = physical.lowered();
            for [x, y] in extent.all_columns() {
                let p = extent.center(x, y, 0);
                match p.x > 1.2 && p.y.abs() < 25.2 {
                    true => assert_eq!(back.column(x, y), expected.column(x, y), "seed {seed}: {x}, {y}"),
                    false if p.x < 0.6 || p.y.abs() > 26.0 => {
                        assert!(back.column(x, y).iter().all(|l| *l == Class::FREE));
                        continue;
                    }
                    false => continue,
                }
                same += back.column(x, y).iter().filter(|l| **l != Class::FREE).count();
            }
        }
        assert!(same > 200_000, "{same} voxels tell nothing");
    }

    /// What the masks say comes back with the labels.
    #[test]
    fn the_four_files_are_read_together() {
        let Some(Content::Scene(back)) = round_trip(&EXPORTER, &scene()) else {
            panic!("read as a scene");
        };
        let unobserved = back.scene.frame().inferred.unobserved.clone().expect("a mask");
        let word = |x_m: f64, y_m: f64| {
            let [x, y] = Extent::WINDOW.column_at(x_m, y_m).expect("inside");
            unobserved.words()[Extent::WINDOW.index(x, y)]
        };
        // Nothing is known of what is behind, and all of what is ahead.
        assert_eq!(word(-10.0, 0.0), 0xffff);
        assert_eq!(word(10.0, 0.0), 0);
        assert_eq!(
            back.skipped.keys().filter(|k| k.contains("file")).count(),
            2,
            "{:?}",
            back.skipped
        );
    }

    /// A sweep that met the top of a road's voxel and a wall, and the free air between them.
    #[test]
    fn one_scan_marks_where_it_ends_and_what_it_misses() {
        struct Two(scene::LidarPattern);
        impl Products for Two {
            fn show(&mut self, time_s: f64) -> Result<(), FormatError> {
                Small.show(time_s)
            }
            fn seen(&mut self) -> Result<super::super::BoxVisibility, FormatError> {
                Small.seen()
            }
            fn observed(&mut self) -> Result<ObservationMasks, FormatError> {
                Small.observed()
            }
            fn sweep(&mut self) -> Result<LidarSweep, FormatError> {
                let point = Small.sweep()?.points[0];
                let [x, y, _] = self.0.translation_m.map(|v| v as f32);
                let at = |class, position_in_ego| scene::LidarPoint {
                    class,
                    position_in_ego,
                    ..point
                };
                Ok(LidarSweep {
                    points: vec![
                        at(Class::DriveableSurface, [x + 10.0, y, -0.6]),
                        at(Class::Manmade, [20.0, y, 1.9]),
                        at(Class::Manmade, [25.0, y, 1.9]),
                    ],
                    rays: 3,
                    physical: false,
                    provenance: Vec::new(),
                })
            }
            fn sweep_edits(&mut self, _: usize) -> Result<scene::SweepEdits, FormatError> {
                Small.sweep_edits(0)
            }

            fn radars(&mut self) -> Result<Vec<scene::RadarScan>, FormatError> {
                Small.radars()
            }
            fn camera_maps(
                &mut self,
                take: &mut dyn FnMut(scene::CameraMaps) -> Result<(), FormatError>,
            ) -> Result<(), FormatError> {
                Small.camera_maps(take)
            }
            fn pictures(
                &mut self,
                take: &mut dyn FnMut(super::super::ExportPicture) -> Result<(), FormatError>,
            ) -> Result<(), FormatError> {
                Small.pictures(take)
            }
            fn truth(
                &mut self,
                take: &mut dyn FnMut(
                    crate::export::ExportPicture,
                    scene::CameraTruth,
                ) -> Result<(), FormatError>,
            ) -> Result<(), FormatError> {
                Small.truth(take)
            }
            fn gaussians(&mut self) -> Result<scene::GaussianScene, FormatError> {
                Small.gaussians()
            }
            fn recipe(&self) -> &crate::recipe::Recipe {
                Small.recipe()
            }
            fn world_from_ego(&self) -> scene::Pose {
                Small.world_from_ego()
            }
            fn view(&mut self) -> Result<super::super::ExportPicture, FormatError> {
                Small.view()
            }
        }
        let mut scene = scene();
        scene.change_canvas(|frame| {
            let mut grid = VoxelGrid::new();
            (100..150).for_each(|x| (95..106).for_each(|y| grid.set(x, y, 0, Class::DriveableSurface.id())));
            (0..10).for_each(|z| (95..106).for_each(|y| grid.set(150, y, z, Class::Manmade.id())));
            frame.occupancy = grid;
            frame.boxes.remove(&BoxId(4));
        });
        let pattern = scene.rig.lidars[0].clone();
        let pose = ego_from_cells(&pattern);
        let [bin, label, invalid, occluded] = files(&scene, &mut Two(pattern));
        let cell = |x: f64, z: f64| {
            let p = pose.inverse().apply(DVec3::new(x, 0.05, z));
            LATTICE.index(LATTICE.cell_at(p).expect("inside"))
        };
        let raw = |cell: usize| u16::from_le_bytes([label[2 * cell], label[2 * cell + 1]]);
        let set: Vec<usize> = (0..CELLS).filter(|i| bit(&bin, *i)).collect();
        assert_eq!(set.len(), 2, "the point behind the wall lies in nothing");
        assert_eq!((raw(cell(10.9, 0.1)), raw(cell(20.1, 1.9))), (40, 50));
        assert!(set.iter().all(|i| raw(*i) != 0));
        assert!(set.contains(&cell(20.1, 1.9)), "{set:?}");
        // The lower half of the columns ahead is seen, the ground with them; nothing beyond the map is known.
        assert!(!bit(&occluded, cell(10.9, 0.1)) && !bit(&occluded, cell(10.9, 2.0)));
        assert!(bit(&occluded, cell(10.9, 3.0)));
        assert!(!bit(&invalid, cell(30.0, 2.0)) && bit(&invalid, cell(42.0, 2.0)));
        assert!(bit(&invalid, cell(10.9, 5.9)) && !bit(&invalid, cell(10.9, 5.0)));
    }
}
