//! Time of one LiDAR cast of the reference (34,688 rays, 200 x 200 x 16 voxels) and of a whole
//! sweep with new masks. Run: `cargo bench --bench raycast`. Open3D 0.20 needs 3.19 ms on two
//! threads for the same rays, after 68.6 ms to build its tree.

use glam::DVec3;
use numeric::quantile::median;
use rayon::prelude::*;
use scene::{Class, SensorRig, VoxelGrid, Window};
use sensors::lidar;
use sensors::lidar::caster::Caster;
use sensors::raycast::{ColumnMasks, LANES, Packet};

#[path = "timing.rs"]
mod timing;

fn main() {
    let path = concat!(
        env!("CARGO_MANIFEST_DIR"),
        "/tests/reference/raycast/occupancy.npz"
    );
    let file = std::fs::File::open(path).expect("the reference grid");
    let mut zip = zip::ZipArchive::new(file).expect("an npz file");
    let array = zip.by_name("occupancy.npy").expect("an occupancy array");
    let occupied: Vec<u8> = npyz::NpyFile::new(array)
        .expect("an npy file")
        .into_vec()
        .expect("u8");
    let label = |o: &u8| if *o == 1 { Class::Manmade.id() } else { Class::FREE };
    let grid =
        VoxelGrid::from_dense(&occupied.iter().map(label).collect::<Vec<_>>()).expect("640,000 labels");
    let masks = ColumnMasks::from_grid(&grid);
    let rays: Vec<DVec3> = (0..32)
        .flat_map(|beam| {
            let el = (-30.67 + 41.34 * f64::from(beam) / 31.0).to_radians();
            (0..1084).map(move |step| {
                let az = std::f64::consts::TAU * f64::from(step) / 1084.0 - std::f64::consts::PI;
                DVec3::new(el.cos() * az.cos(), el.cos() * az.sin(), el.sin())
            })
        })
        .collect();
    let origin = DVec3::new(40.0, 40.0, 2.24) / Window::VOXEL_M;
    let cast = |d: &DVec3| {
        masks
            .cast_in_voxels(origin, *d, f64::INFINITY)
            .map_or(0.0, |h| h.0)
    };
    let one_by_one = || rays.iter().map(cast).filter(|t| *t > 0.0).count();
    // All elevations of one azimuth, eight a packet.
    const GROUPS: usize = 32 / LANES;
    let packet = |i: usize| {
        let (column, group) = (i / GROUPS, i % GROUPS);
        Packet {
            origin,
            directions: std::array::from_fn(|lane| rays[(group * LANES + lane) * 1084 + column]),
        }
    };
    let packets = |from: usize, count: usize| {
        let mut hits = 0;
        masks.cast_packets(
            count,
            f64::INFINITY,
            |i| packet(from + i),
            |_, met| {
                hits += met.iter().filter(|m| m.is_some_and(|m| m.0 > 0.0)).count();
            },
        );
        hits
    };
    // Taking turns, so that a busy machine slows both alike.
    let ratios: Vec<f64> = (0..60)
        .map(|_| {
            let start = std::time::Instant::now();
            let hits = one_by_one();
            let alone = start.elapsed();
            let start = std::time::Instant::now();
            assert_eq!(packets(0, 1084 * GROUPS), hits);
            start.elapsed().as_secs_f64() / alone.as_secs_f64()
        })
        .collect();
    println!(
        "packets take {:.2} of the time of single rays (median of turns)",
        median(&ratios)
    );
    timing::time("single rays, one thread", 60, one_by_one);
    timing::time("cast, one thread", 60, || packets(0, 1084 * GROUPS));
    timing::time("cast, all threads", 60, || {
        let tasks = (0..1084usize).into_par_iter().step_by(16);
        tasks
            .map(|c| packets(c * GROUPS, (1084 - c).min(16) * GROUPS))
            .sum()
    });
    timing::time("masks of the whole grid", 60, || {
        let masks = ColumnMasks::from_grid(&grid);
        usize::from(masks.column(3, 4))
    });
    let full = &SensorRig::default().lidars[0];
    timing::time("sweep with what lies beyond the grid", 20, || {
        lidar::sweep(&grid, full, None).points.len()
    });
    let mut inside = full.clone();
    inside.beyond_grid = false;
    let pattern = &inside;
    timing::time("sweep with masks", 60, || {
        lidar::sweep(&grid, pattern, None).points.len()
    });
    // A car beside the road, there in one grid and not in the other.
    let mut with_car = grid.clone();
    for (x, y, z) in (118..130).flat_map(|x| (106..111).flat_map(move |y| (1..6).map(move |z| (x, y, z)))) {
        let label = if grid.get(x, y, z) == Class::FREE {
            Class::Car.id()
        } else {
            Class::FREE
        };
        with_car.set(x, y, z, label);
    }
    let mut caster = Caster::new(&grid, pattern, glam::DVec3::ZERO, None);
    let mut there = false;
    timing::time("kept sweep after a car came or went", 60, || {
        there = !there;
        caster.update(if there { &with_car } else { &grid });
        caster.cast_last()
    });
    timing::time("its points", 60, || caster.sweep().points.len());
}
