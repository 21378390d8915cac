//! Labels made like real ones: LiDAR sweeps along a drive, accumulated, the majority per voxel.

use glam::DVec3;
use rayon::prelude::*;

use super::drive::{Drive, poses};
use super::observed::{Passed, seen_by_cameras};
use super::{Vertical, finish_column};
use crate::World;
use scene::draw::Draw;
use scene::{Class, LidarPattern, SensorRig, VoxelGrid, Window};

/// Highest bin above the ground at which a column's lowest hit still belongs to an object that stands on it, before the
/// smear.
const HIGHEST_UNDERSIDE: usize = 4;
/// Number of bins above other ground from which on ground is a deck over it.
const DECK: usize = 4;

/// Labels of a drive, and the voxels it observed; free where unobserved means unknown.
pub struct Labelled {
    /// The labels.
    pub grid: VoxelGrid,
    /// One flag per voxel, `[x][y][z]`: true if a ray ended in it or went through it; false for ground that was filled
    /// in from around.
    pub by_lidar: Vec<bool>,
    /// Voxels of those that a camera of the rig sees from the vehicle's place: in a picture, with nothing in front.
    pub by_camera: Vec<bool>,
}

/// Labels as a data set has them: sweeps of `pattern` from poses along the road through the ego,
/// accumulated; the majority class of the hits in a voxel wins.
pub fn labels(
    world: &World,
    pattern: &LidarPattern,
    drive: &Drive,
    vertical: Vertical,
    seed: u64,
) -> VoxelGrid {
    let sweeps = drive_through(world, pattern, drive, seed, false);
    voted(world, sweeps.into_iter().map(|s| s.hits), vertical).0
}

/// The labels with the masks that a data set has beside them, by the first LiDAR and the cameras of a rig.
pub fn labelled(world: &World, rig: &SensorRig, drive: &Drive, vertical: Vertical, seed: u64) -> Labelled {
    let (grid, by_lidar) = observed_labels(world, rig.lidars.first(), drive, vertical, seed);
    let by_camera = seen_by_cameras(&grid, &by_lidar, rig);
    Labelled {
        grid,
        by_lidar,
        by_camera,
    }
}

/// The labels without cameras' masks, and per voxel `[x][y][z]` whether the LiDAR observed it.
pub fn observed_labels(
    world: &World,
    lidar: Option<&LidarPattern>,
    drive: &Drive,
    vertical: Vertical,
    seed: u64,
) -> (VoxelGrid, Vec<bool>) {
    let mut passed = Passed::default();
    let sweeps = lidar.map(|lidar| drive_through(world, lidar, drive, seed, true));
    let sweeps = sweeps.into_iter().flatten().map(|s| {
        passed.join(&s.passed);
        s.hits
    });
    let (grid, filled) = voted(world, sweeps.collect::<Vec<_>>().into_iter(), vertical);
    let mut by_lidar = Vec::with_capacity(Window::VOXELS);
    for (c, filled) in filled.into_iter().enumerate() {
        let column = grid.column(c / Window::NY, c % Window::NY);
        by_lidar.extend((0..Window::NZ).map(|z| match column[z] {
            Class::FREE => passed.has(c * Window::NZ + z),
            label => !filled || !Class::from_id(label).is_some_and(Class::is_ground),
        }));
    }
    (grid, by_lidar)
}

/// One sweep: voxels that were hit and their classes, and those that rays went through.
struct SweepVoxels {
    hits: Vec<(u32, u8)>,
    passed: Passed,
}

fn drive_through(
    world: &World,
    pattern: &LidarPattern,
    drive: &Drive,
    seed: u64,
    with_passed: bool,
) -> Vec<SweepVoxels> {
    let stray = 0.0004; // hits that land a voxel beside their surface: speckle
    let mount = pattern.ego_from_sensor();
    poses(world, drive)
        .into_par_iter()
        .enumerate()
        .map(|(i, (position, yaw))| {
            let mut draw = Draw::new(seed ^ (i as u64) << 32, "sweep");
            let world_from_sensor = world.layout.relief.pose_on(position, yaw) * mount;
            let origin = world_from_sensor.translation_m;
            let mut hits = Vec::with_capacity(1 << 14);
            let mut passed = Passed::default();
            let columns = pattern.columns / 2; // half the columns at random phases: the drive overlaps enough
            for elevation in &pattern.elevations_deg {
                let (sin_el, cos_el) = elevation.to_radians().sin_cos();
                for _ in 0..columns {
                    let (sin_az, cos_az) = (draw.unit() * std::f64::consts::TAU).sin_cos();
                    let dir =
                        world_from_sensor.rotation * DVec3::new(cos_el * cos_az, cos_el * sin_az, sin_el);
                    if draw.chance(drive.dropout) {
                        continue;
                    }
                    let Some(hit) = world.cast(origin, dir, 70.0) else {
                        continue;
                    };
                    if with_passed {
                        passed.walk(origin, origin + dir * hit.range_m);
                    }
                    let noise = (draw.unit() + draw.unit() + draw.unit() - 1.5) * 2.0 * drive.range_noise_m;
                    let mut p = origin + dir * (hit.range_m + noise + 0.03);
                    if draw.chance(stray) {
                        p += DVec3::new(draw.range(-0.5, 0.5), draw.range(-0.5, 0.5), draw.range(0.0, 0.6));
                    }
                    if let Some([x, y, z]) = Window::voxel_at(p) {
                        hits.push((((x * Window::NY + y) * Window::NZ + z) as u32, hit.class.id()));
                    }
                }
            }
            SweepVoxels { hits, passed }
        })
        .collect()
}

/// The grid of the hits, and for each column whether its ground was filled in from around.
fn voted(
    world: &World,
    sweeps: impl Iterator<Item = Vec<(u32, u8)>>,
    vertical: Vertical,
) -> (VoxelGrid, Vec<bool>) {
    // Boyer-Moore majority vote per voxel, in sweep order.
    let mut votes = vec![(0u16, Class::FREE); Window::VOXELS];
    for (voxel, class) in sweeps.flatten() {
        let (count, winner) = &mut votes[voxel as usize];
        match (*count, *winner == class) {
            (0, _) => (*count, *winner) = (1, class),
            (_, true) => *count = count.saturating_add(1),
            (_, false) => *count -= 1,
        }
    }
    let mut ground: Vec<Option<(usize, u8)>> = Vec::with_capacity(Window::COLUMNS);
    for column_votes in votes.chunks_exact_mut(Window::NZ) {
        let is_ground = |v: &(u16, u8)| Class::from_id(v.1).is_some_and(Class::is_ground);
        let z = column_votes.iter().position(is_ground);
        ground.push(z.map(|z| (z, column_votes[z].1)));
        // The remaining hits are objects that stand on the ground, and decks over it.
        let below_deck = z.map_or(0, |z| (z + DECK).min(Window::NZ));
        let all = column_votes[..below_deck].iter_mut().filter(|v| is_ground(v));
        all.for_each(|v| *v = (0, Class::FREE));
    }
    let hit: Vec<bool> = ground.iter().map(Option::is_some).collect();
    for _ in 0..2 {
        ground = closed(&ground);
    }
    let mut grid = VoxelGrid::new();
    for (c, column_votes) in votes.chunks_exact(Window::NZ).enumerate() {
        let mut column: [u8; Window::NZ] = std::array::from_fn(|z| column_votes[z].1);
        if vertical == Vertical::Occ3d {
            let p = Window::center(c / Window::NY, c % Window::NY, 0).truncate();
            extend_to_ground(&mut column, scene::Lattice::OCC3D.bin(world.ground_height(p)));
        }
        if ground[c].is_none() && column.iter().all(|l| *l == Class::FREE) {
            continue;
        }
        finish_column(&mut column, ground[c], vertical);
        grid.column_mut(c / Window::NY, c % Window::NY)
            .copy_from_slice(&column);
    }
    let filled = hit.into_iter().zip(&ground).map(|(hit, g)| !hit && g.is_some());
    (grid, filled.collect())
}

/// Ground with its small holes filled, as surface reconstruction does before labels are made: a column without ground
/// takes that of its neighbours if half of the eight have some.
fn closed(ground: &[Option<(usize, u8)>]) -> Vec<Option<(usize, u8)>> {
    let at = |x: usize, y: usize| -> Option<(usize, u8)> {
        let inside = x < Window::NX && y < Window::NY;
        inside.then(|| ground[x * Window::NY + y]).flatten()
    };
    let fill = |c: usize| {
        let (x, y) = (c / Window::NY, c % Window::NY);
        let around = (0..9).filter(|i| *i != 4);
        let near: Vec<(usize, u8)> = around
            .filter_map(|i| at((x + i / 3).wrapping_sub(1), (y + i % 3).wrapping_sub(1)))
            .collect();
        let votes = |g: &(usize, u8)| near.iter().filter(|n| *n == g).count();
        near.iter()
            .max_by_key(|g| votes(g))
            .copied()
            .filter(|_| near.len() >= 4)
    };
    (0..ground.len()).map(|c| ground[c].or_else(|| fill(c))).collect()
}

/// Real labels of vehicles and people reach the ground although sensors see little of their undersides:
/// fills an object's column from its lowest hit down to the bin of the ground.
fn extend_to_ground(column: &mut [u8; Window::NZ], ground: usize) {
    let Some(lowest) = column.iter().position(|l| *l != Class::FREE) else {
        return;
    };
    let is_object = Class::from_id(column[lowest]).is_some_and(|c| Class::OBJECTS.contains(&c));
    if is_object && lowest > ground && lowest <= ground + HIGHEST_UNDERSIDE {
        let label = column[lowest];
        column[ground..lowest].fill(label);
    }
}
