//! Formats that can be written: one file here and one line of the table each. The window's dialog and the command line both
//! use this table.

pub mod boxes;
pub mod control_video;
pub mod depth;
mod exporter;
pub mod gaussians_glb;
pub mod gaussians_ply;
pub mod glb;
pub mod kitti;
pub mod las;
pub mod loom;
pub mod mcap;
pub mod nuplan_occ;
pub mod nuscenes;
pub mod nuscenes_lidar;
pub mod nuscenes_radar;
pub mod occ3d;
pub mod opendrive;
pub mod openlabel;
pub mod openoccupancy;
pub mod openscenario;
pub mod pcd;
pub mod pictures;
pub mod ply;
pub mod recording;
pub mod semantic;
pub mod semantic_kitti;
pub mod surroundocc;
pub mod truth;
pub mod view;
pub mod vox;
pub mod world_scenario;

use scene::Scene;

use crate::sparse_npy;

pub use exporter::{
    BoxVisibility, ExportPicture, ExportSpan, Exporter, ObservationMasks, OutFile, Product, Products,
};

/// Every format for other programs, in the order of lists. The program's own, [`loom::EXPORTER`], is what saving writes.
const TABLE: &[&Exporter] = &[
    &occ3d::EXPORTER,
    &occ3d::WAYMO_EXPORTER,
    &openoccupancy::EXPORTER,
    &surroundocc::EXPORTER,
    &nuplan_occ::EXPORTER,
    &semantic_kitti::EXPORTER,
    &vox::EXPORTER,
    &boxes::EXPORTER,
    &glb::EXPORTER,
    &nuscenes_lidar::EXPORTER,
    &nuscenes_radar::EXPORTER,
    &ply::EXPORTER,
    &pcd::EXPORTER,
    &las::EXPORTER,
    &las::PACKED,
    &recording::EXPORTER,
    &kitti::EXPORTER,
    &semantic::EXPORTER,
    &depth::EXPORTER,
    &pictures::EXPORTER,
    &truth::EXPORTER,
    &gaussians_ply::EXPORTER,
    &gaussians_glb::EXPORTER,
    &view::EXPORTER,
    &world_scenario::EXPORTER,
    &control_video::EXPORTER,
    &nuscenes::EXPORTER,
    &mcap::EXPORTER,
    &openlabel::EXPORTER,
    &opendrive::EXPORTER,
    &openscenario::EXPORTER,
];

/// Every format for other programs, in the order of lists.
pub fn all() -> &'static [&'static Exporter] {
    TABLE
}

/// True if a format writes the voxels of a map of another lattice as they are: the program's own, and a data set's own for a
/// scene on its map.
pub fn keeps_lattice(format: &Exporter, scene: &Scene) -> bool {
    let is_on = |kinds: &[sparse_npy::SparseDataset]| sparse_npy::own_kind(kinds, scene).is_some();
    match format.id {
        id if id == loom::EXPORTER.id => true,
        id if id == openoccupancy::EXPORTER.id => is_on(&openoccupancy::KINDS),
        id if id == surroundocc::EXPORTER.id => is_on(&surroundocc::KINDS),
        id if id == nuplan_occ::EXPORTER.id => crate::nuplan_occ::own_map(scene).is_some(),
        id if id == semantic_kitti::EXPORTER.id => semantic_kitti::own_map_of(scene).is_some(),
        _ => false,
    }
}

/// The formats that *all* writes of a scene: every format but Gaussians, which take a minute and more, MP4 where the program lacks
/// its encoder, radar scans where the rig has no radar, and the recording of a scene that has none.
pub fn usual(scene: &Scene) -> Vec<&'static Exporter> {
    let lacks = |f: &&'static Exporter| match f.needs {
        [Product::Radar] => scene.rig.radars.is_empty(),
        [Product::Recording] => scene.kept.sweeps.is_empty(),
        _ => false,
    };
    let is_slow = |f: &&'static Exporter| f.needs.contains(&Product::Gaussians);
    let is_absent = |f: &&'static Exporter| !cfg!(feature = "video") && f.id == control_video::EXPORTER.id;
    let written = all().iter().copied();
    written
        .filter(|f| !is_slow(f) && !is_absent(f) && !lacks(f))
        .collect()
}

/// The format of that name.
pub fn from_id(id: &str) -> Option<&'static Exporter> {
    all().iter().find(|e| e.id == id).copied()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_tidy() {
        assert_eq!(
            OutFile::new("../CAM FRONT_ä.png", Vec::new()).name,
            ".._CAM_FRONT_ä.png"
        );
        let deep = OutFile::new("a b", Vec::new()).within("/sweeps/../LIDAR TOP/");
        assert_eq!(deep.name, "sweeps/_/LIDAR_TOP/a_b");
        assert_eq!(from_id("ply").map(|e| e.file_name), Some(Some("lidar.ply")));
        assert!(from_id("loom").is_none() && from_id("fbx").is_none());
    }
}
