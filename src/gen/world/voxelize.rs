//! Worlds to voxels, two ways: complete (every voxel of every solid) and as real labels are made
//! (LiDAR sweeps along a drive, accumulated, majority per voxel, with holes and occlusion).

use glam::{DVec2, DVec3};
use rayon::prelude::*;

use super::World;
use super::draw::Draw;
use crate::scene::raster::bev_channels;
use crate::scene::solid::fill::{SMEAR, fill, smear_down};
use crate::scene::{BevLayer, Class, GridSpec, LidarPattern, Polyline, PolylineKind, Relief, VoxelGrid};

/// Where the ground sits vertically.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub enum Vertical {
    /// As in the Occ3D labels: the ground two bins below its true height, in bin 0, and every
    /// other voxel extended two bins down (`real_statistics.md`, 2.2).
    #[default]
    Occ3d,
    /// As measured: the ground in bin 2.
    Physical,
}

/// A lowest hit up to so many bins above the ground still belongs to something standing on it, before the smear.
const HIGHEST_UNDERSIDE: usize = 4;
/// Ground this many bins above other ground is a deck that stands over it.
const DECK: usize = 4;

/// Every voxel that a solid fills, and the ground under them: what a sensor that sees everything
/// would label; see [`fill`]. An object's voxels stay in the columns of its box's footprint, as the
/// layout's do: what sticks out by less than half a column belongs to no column.
pub fn complete(world: &World, vertical: Vertical) -> VoxelGrid {
    let mut best = vec![(0u8, Class::FREE); GridSpec::VOXELS]; // votes, class
    let bev = bev_channels(&world.layout, world.boxes.values());
    for s in world.solids() {
        let layer = BevLayer::of_object(s.class).map_or(0, BevLayer::bit);
        let counts = |x: usize, y: usize| layer == 0 || bev[x * GridSpec::NY + y] & layer != 0;
        fill(s, counts, |x, y, z, votes| {
            let cell = &mut best[(x * GridSpec::NY + y) * GridSpec::NZ + z];
            if votes > cell.0 {
                *cell = (votes, s.class.id());
            }
        });
    }
    let mut grid = VoxelGrid::new();
    for x in 0..GridSpec::NX {
        for y in 0..GridSpec::NY {
            let at = (x * GridSpec::NY + y) * GridSpec::NZ;
            let mut column = [Class::FREE; GridSpec::NZ];
            for (z, (_, class)) in best[at..at + GridSpec::NZ].iter().enumerate() {
                column[z] = *class;
            }
            let height = world.ground_height(GridSpec::center(x, y, 0).truncate());
            let ground = (Relief::physical_bin(height), world.ground_class(x, y).id());
            finish_column(&mut column, Some(ground), vertical);
            grid.column_mut(x, y).copy_from_slice(&column);
        }
    }
    grid
}

/// Puts the ground below what stands on it and applies the vertical convention.
fn finish_column(column: &mut [u8; GridSpec::NZ], ground: Option<(usize, u8)>, vertical: Vertical) {
    if vertical == Vertical::Occ3d {
        smear_down(column);
    }
    if let Some((bin, class)) = ground {
        let shift = if vertical == Vertical::Occ3d { SMEAR } else { 0 };
        let bin = bin.saturating_sub(shift);
        // Objects replace the ground they stand on.
        if column[bin] == Class::FREE {
            column[bin] = class;
        }
        for cell in &mut column[..bin] {
            *cell = Class::FREE;
        }
    }
}

/// How the simulated labelling drive goes.
#[derive(Clone, Debug)]
pub struct Drive {
    /// Sweeps along the drive.
    pub sweeps: usize,
    /// Metres between sweeps.
    pub step_m: f64,
    /// Share of rays that bring nothing back for no reason.
    pub dropout: f64,
    /// Standard deviation of the measured range, m.
    pub range_noise_m: f64,
}

impl Default for Drive {
    fn default() -> Self {
        Self {
            sweeps: 24,
            step_m: 1.8,
            dropout: 0.08,
            range_noise_m: 0.02,
        }
    }
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
    let mut poses = drive_poses(world, drive);
    let stray = 0.0004; // hits that land a voxel beside their surface: speckle
    let mount = pattern.ego_from_sensor();
    let sweeps: Vec<Vec<(u32, u8)>> = poses
        .par_drain(..)
        .enumerate()
        .map(|(i, (position, yaw))| {
            let mut draw = Draw::new(seed ^ (i as u64) << 32, "sweep");
            let world_from_sensor = world.layout.relief.pose_on(position, yaw) * mount;
            let origin = world_from_sensor.translation_m;
            let mut hits = Vec::with_capacity(1 << 14);
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
                    let noise = (draw.unit() + draw.unit() + draw.unit() - 1.5) * 2.0 * drive.range_noise_m;
                    let mut p = origin + dir * (hit.range_m + noise + 0.03);
                    if draw.chance(stray) {
                        p += DVec3::new(draw.range(-0.5, 0.5), draw.range(-0.5, 0.5), draw.range(0.0, 0.6));
                    }
                    if let Some([x, y, z]) = GridSpec::voxel_at(p) {
                        hits.push((((x * GridSpec::NY + y) * GridSpec::NZ + z) as u32, hit.class.id()));
                    }
                }
            }
            hits
        })
        .collect();
    // Boyer-Moore majority vote per voxel, in sweep order.
    let mut votes = vec![(0u16, Class::FREE); GridSpec::VOXELS];
    for (voxel, class) in sweeps.into_iter().flatten() {
        let (count, winner) = &mut votes[voxel as usize];
        match (*count, *winner == class) {
            (0, _) => (*count, *winner) = (1, class),
            (_, true) => *count = count.saturating_add(1),
            (_, false) => *count -= 1,
        }
    }
    let mut ground: Vec<Option<(usize, u8)>> = Vec::with_capacity(GridSpec::COLUMNS);
    for column_votes in votes.chunks_exact_mut(GridSpec::NZ) {
        let is_ground = |v: &(u16, u8)| Class::from_id(v.1).is_some_and(Class::is_ground);
        let z = column_votes.iter().position(is_ground);
        ground.push(z.map(|z| (z, column_votes[z].1)));
        // What is left are things that stand on it, and decks over it.
        let below_deck = z.map_or(0, |z| (z + DECK).min(GridSpec::NZ));
        let all = column_votes[..below_deck].iter_mut().filter(|v| is_ground(v));
        all.for_each(|v| *v = (0, Class::FREE));
    }
    for _ in 0..2 {
        ground = closed(&ground);
    }
    let mut grid = VoxelGrid::new();
    for (c, column_votes) in votes.chunks_exact(GridSpec::NZ).enumerate() {
        let mut column: [u8; GridSpec::NZ] = std::array::from_fn(|z| column_votes[z].1);
        if vertical == Vertical::Occ3d {
            let p = GridSpec::center(c / GridSpec::NY, c % GridSpec::NY, 0).truncate();
            extend_to_ground(&mut column, Relief::physical_bin(world.ground_height(p)));
        }
        if ground[c].is_none() && column.iter().all(|l| *l == Class::FREE) {
            continue;
        }
        finish_column(&mut column, ground[c], vertical);
        grid.column_mut(c / GridSpec::NY, c % GridSpec::NY)
            .copy_from_slice(&column);
    }
    grid
}

/// Ground with its small holes filled, as surface reconstruction does before labels are made: a column
/// without any takes that of its neighbours if half of the eight have some.
fn closed(ground: &[Option<(usize, u8)>]) -> Vec<Option<(usize, u8)>> {
    let at = |x: usize, y: usize| -> Option<(usize, u8)> {
        let inside = x < GridSpec::NX && y < GridSpec::NY;
        inside.then(|| ground[x * GridSpec::NY + y]).flatten()
    };
    let fill = |c: usize| {
        let (x, y) = (c / GridSpec::NY, c % GridSpec::NY);
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
fn extend_to_ground(column: &mut [u8; GridSpec::NZ], ground: usize) {
    let Some(lowest) = column.iter().position(|l| *l != Class::FREE) else {
        return;
    };
    let is_object = Class::from_id(column[lowest]).is_some_and(|c| Class::OBJECTS.contains(&c));
    if is_object && lowest > ground && lowest <= ground + HIGHEST_UNDERSIDE {
        let label = column[lowest];
        column[ground..lowest].fill(label);
    }
}

/// Poses of the labelling drive: along the lane nearest to the ego, as far as it stays in the grid.
fn drive_poses(world: &World, drive: &Drive) -> Vec<(DVec2, f64)> {
    let lanes = world
        .layout
        .polylines
        .iter()
        .filter(|l| l.kind == PolylineKind::LaneCenter);
    let nearest = |line: &Polyline| {
        let distances = line.points_m.iter().map(|p| p.length_squared());
        distances.fold(f64::INFINITY, f64::min)
    };
    let lane = lanes.min_by(|a, b| nearest(a).total_cmp(&nearest(b)));
    let straight: Vec<DVec2> = [-40.0, 40.0].map(|x| DVec2::new(x, 0.0)).to_vec();
    let points = lane.map_or(&straight, |l| &l.points_m);
    // Every metre of the lane, then the ones nearest to the ego at the wanted spacing.
    let mut fine = Vec::new();
    for pair in points.windows(2) {
        let (d, length) = (
            (pair[1] - pair[0]).normalize_or(DVec2::X),
            pair[0].distance(pair[1]),
        );
        fine.extend((0..length.ceil() as usize).map(|i| (pair[0] + d * i as f64, d.to_angle())));
    }
    fine.retain(|(p, _)| p.abs().max_element() < 39.0);
    let start = (0..fine.len())
        .min_by(|a, b| fine[*a].0.length().total_cmp(&fine[*b].0.length()))
        .unwrap_or(0);
    let half = drive.sweeps as f64 / 2.0;
    (0..drive.sweeps)
        .filter_map(|i| {
            let at = start as f64 + (i as f64 - half) * drive.step_m;
            (at >= 0.0).then(|| fine.get(at as usize).copied()).flatten()
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::SensorRig;

    #[test]
    fn ground_is_where_the_convention_says() {
        let world = World::random(2);
        for (vertical, bin) in [(Vertical::Occ3d, 0), (Vertical::Physical, 2)] {
            let grid = complete(&world, vertical);
            let road = grid.iter_set().filter(|v| v.3 == Class::DriveableSurface.id());
            let (at, all) = road.fold((0, 0), |(at, all), v| (at + usize::from(v.2 == bin), all + 1));
            assert!(
                all > 2000 && at == all,
                "{vertical:?}: {at} of {all} road voxels in bin {bin}"
            );
        }
    }

    #[test]
    fn labels_are_repeatable_sparser_and_agree_where_they_see() {
        let world = World::random(4);
        let full = complete(&world, Vertical::Occ3d);
        let pattern = &SensorRig::default().lidars[0];
        let drive = Drive {
            sweeps: 6,
            step_m: 6.0,
            ..Drive::default()
        };
        let seen = labels(&world, pattern, &drive, Vertical::Occ3d, 9);
        assert_eq!(seen, labels(&world, pattern, &drive, Vertical::Occ3d, 9));
        assert!(seen.count_set() < full.count_set() && seen.count_set() > 5000);
        let (mut same, mut both) = (0, 0);
        for (x, y, z, class) in seen.iter_set() {
            let truth = full.get(x, y, z);
            if truth != Class::FREE {
                both += 1;
                same += usize::from(truth == class);
            }
        }
        assert!(same * 100 > both * 93, "{same} of {both} agree");
    }
}
