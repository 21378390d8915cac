//! OpenDRIVE import: geometry against reference points, own roads against what they were made of, real
//! files against their measured counts, broken files against panics and silence.

mod bad_input;
mod beside;
mod heights;
mod own_roads;
mod real_files;
mod reference;

use std::path::{Path, PathBuf};

use formats::opendrive::{self, LayoutImport, RoadNetwork};
use glam::DVec2;
use scene::{BevLayer, Window};

/// The bundled roads.
const OWN: [&str; 6] = [
    "every_geometry",
    "four_arm_junction",
    "left_hand_bend",
    "motorway_exit",
    "parking_street",
    "straight_two_way",
];

fn root() -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR"))
}

fn own_bytes(name: &str) -> Vec<u8> {
    let path = root().join("assets/roads").join(format!("{name}.xodr"));
    std::fs::read(&path).unwrap_or_else(|e| panic!("{}: {e}", path.display()))
}

fn own(name: &str) -> RoadNetwork {
    opendrive::read(&own_bytes(name)).unwrap_or_else(|e| panic!("{name}: {e}"))
}

/// The folder of real files, if this machine has it.
fn data_dir() -> Option<PathBuf> {
    let beside = root().join("../shared/data");
    let named = std::env::var_os("SCENELOOM_DATA").map(PathBuf::from);
    [Some(beside), named]
        .into_iter()
        .flatten()
        .map(|d| d.join("roads/opendrive"))
        .find(|d: &PathBuf| Path::is_dir(d))
}

/// Area of a layer, m2.
fn area_m2(import: &LayoutImport, layer: BevLayer) -> f64 {
    import.layout.count(layer) as f64 * Window::VOXEL_M * Window::VOXEL_M
}

/// The map layers at a place of the ego frame.
fn layers_at(import: &LayoutImport, x_m: f64, y_m: f64) -> Vec<BevLayer> {
    let [x, y] = Window::column_at(x_m, y_m).expect("inside the window");
    BevLayer::MAP
        .into_iter()
        .filter(|l| import.layout.has(*l, x, y))
        .collect()
}

/// The window at a road's reference line, looking along it.
fn window_at(network: &RoadNetwork, road: usize, s_m: f64) -> LayoutImport {
    let here = network.roads[road].reference.at(s_m);
    network.to_layout(here.position_m, here.heading_rad)
}

/// Headings differ by less than `tolerance_rad`, full turns aside.
fn same_heading(a: f64, b: f64, tolerance_rad: f64) -> bool {
    DVec2::from_angle(a).angle_to(DVec2::from_angle(b)).abs() < tolerance_rad
}
