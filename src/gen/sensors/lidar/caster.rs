//! A LiDAR sweep that is kept: after an edit only the rays whose free path or hit touches a changed voxel are cast
//! again. The result equals a fresh sweep, ray by ray.

use glam::DVec3;
use rayon::prelude::*;

use crate::beyond::border::Border;
use crate::lidar::shaped;
use crate::lidar::surroundings::{Height, SurroundingHits};
use crate::lidar::{EgoBox, Rays, look_through};
use crate::pictures::scenery::SceneryShapes;
use crate::raycast::{ColumnMasks, LANES, Packet, PacketHit};
use scene::{Class, Extent, Frame, Lattice, LidarPattern, LidarPoint, LidarSweep, SensorRig, VoxelGrid};

/// With more changed boxes than this, all rays are cast: testing them would cost as much.
const MAX_BOXES: usize = 16;
/// Widens changed boxes by far more than rounding, voxels.
const MARGIN: f64 = 1e-6;
/// Columns of the pattern per task.
const TASK: usize = 16;
/// Tests of a ray against a changed box per task, and rays cast one by one per task.
const TESTS: usize = 8192;
const RAYS: usize = 512;

/// Free length of a ray, m, and its return.
type RayOutcome = (f32, Option<LidarPoint>);

/// One LiDAR, the voxels that it saw last and what each ray found.
#[derive(Clone, Debug)]
pub struct Caster {
    pattern: LidarPattern,
    exclude: Option<EgoBox>,
    rays: Rays,
    columns: usize,
    /// Origin of each column, voxel units.
    origins: Vec<DVec3>,
    /// Unit normal of the plane that holds the rays of each column.
    normals: Vec<DVec3>,
    grid: VoxelGrid,
    masks: ColumnMasks,
    /// Free length, m, and return of each ray.
    found: Vec<RayOutcome>,
    cast: usize,
    /// The own vehicle and what lies beyond the grid.
    around: SurroundingHits,
}

/// Changed voxels, half-open, in voxel units.
#[derive(Clone, Copy, Debug)]
struct Changed {
    low: DVec3,
    high: DVec3,
}

impl Caster {
    /// Casts every ray of a pattern on a vehicle that drives at `velocity_mps`. Rays pass through voxels whose centre
    /// lies in `exclude`.
    pub fn new(
        grid: &VoxelGrid,
        pattern: &LidarPattern,
        velocity_mps: DVec3,
        exclude: Option<EgoBox>,
    ) -> Self {
        let rays = Rays::new(pattern, velocity_mps);
        let extent = grid.extent();
        let mut caster = Self {
            around: SurroundingHits::new(grid, extent, pattern, &rays, exclude, Height::AsLabelled),
            pattern: pattern.clone(),
            exclude,
            columns: rays.origins.len(),
            origins: in_voxels(extent, &rays),
            normals: rays.normals(pattern),
            found: vec![(0.0, None); rays.directions.len()],
            rays,
            grid: grid.clone(),
            masks: ColumnMasks::from_grid(grid),
            cast: 0,
        };
        caster.leave_out();
        caster.cast_all();
        caster
    }

    /// Brings the sweep up to date with `grid`, which may have another extent.
    pub fn update(&mut self, grid: &VoxelGrid) {
        let extent = grid.extent();
        if extent != self.grid.extent() {
            self.around.update(grid, extent, &self.pattern, &self.rays);
            self.origins = in_voxels(extent, &self.rays);
            self.masks = ColumnMasks::from_grid(grid);
            self.grid = grid.clone();
            self.leave_out();
            self.cast_all();
            return;
        }
        let bricks = self.grid.changed_bricks(grid);
        let changed: Vec<Changed> = bricks
            .iter()
            .filter_map(|&b| changed_in(&self.grid, grid, b))
            .collect();
        self.grid = grid.clone();
        if changed
            .iter()
            .any(|c| Border::is_touched(extent, [c.low.x, c.low.y], [c.high.x, c.high.y]))
        {
            self.around.update(grid, extent, &self.pattern, &self.rays);
        }
        if changed.is_empty() {
            self.cast = 0;
            return;
        }
        self.masks.update(grid, &bricks);
        self.leave_out();
        if changed.len() > MAX_BOXES {
            self.cast_all();
            return;
        }
        // The rays of a column lie in one plane: only columns whose plane meets a box are looked at ray by ray.
        let columns: Vec<usize> = (0..self.columns)
            .filter(|&c| changed.iter().any(|b| b.cuts(self.origins[c], self.normals[c])))
            .collect();
        let beams = self.found.len() / self.columns.max(1);
        let (kept, changed, columns) = (&*self, &changed, &columns);
        let beam = |beam: usize| {
            columns.iter().filter_map(move |&column| {
                let ray = beam * kept.columns + column;
                let reach = f64::from(kept.found[ray].0) / Lattice::OCC3D.voxel_m();
                let inverse = kept.rays.directions[ray].to_array().map(inverse).into();
                let met = |b: &Changed| b.is_met(kept.origins[column], inverse, reach);
                changed.iter().any(met).then_some(ray)
            })
        };
        let at_once = TESTS / (columns.len() * changed.len()).max(1) + 1;
        let again: Vec<usize> = (0..beams)
            .into_par_iter()
            .with_min_len(at_once)
            .flat_map_iter(beam)
            .collect();
        let new: Vec<_> = again
            .par_iter()
            .with_min_len(RAYS)
            .map(|&ray| self.cast_one(ray))
            .collect();
        for (&ray, new) in again.iter().zip(new) {
            self.found[ray] = new;
        }
        self.cast = again.len();
    }

    /// The sweep, with returns in beam-major order.
    pub fn sweep(&self) -> LidarSweep {
        let end = |(ray, (free_m, point)): (usize, &RayOutcome)| {
            let met = free_m.is_finite();
            // The strength of exact echoes is not known.
            let strengthless = |p| LidarPoint {
                intensity: 0.0,
                drop_probability: 0.0,
                ..p
            };
            let instead = self.around.instead(ray, met);
            instead.map_or(*point, |p| p.map(strengthless))
        };
        LidarSweep {
            points: self.found.iter().enumerate().filter_map(end).collect(),
            rays: self.found.len(),
            physical: false,
            provenance: Vec::new(),
        }
    }

    /// The returns on the shapes of boxes ([`shaped::onto_shapes`]); the frame has the voxels that were cast last, `seed` is the
    /// scene's.
    pub fn shaped(
        &self,
        frame: &Frame,
        rig: &SensorRig,
        seed: u64,
        scenery: Option<&SceneryShapes>,
    ) -> LidarSweep {
        let mut sweep = self.sweep();
        shaped::place(&mut sweep, (frame, scenery), rig, seed, Some(&self.masks));
        sweep
    }

    /// Rays that the last update cast.
    pub fn cast_last(&self) -> usize {
        self.cast
    }

    fn leave_out(&mut self) {
        if let Some(ego) = self.exclude {
            look_through(&mut self.masks, ego);
        }
    }

    /// Casts the rays of a column in packets.
    fn cast_all(&mut self) {
        let mut found = std::mem::take(&mut self.found);
        let columns = self.columns.max(1);
        let beams = found.len() / columns;
        // Each task fills a few columns of all rows.
        let mut rows: Vec<_> = found
            .chunks_mut(columns)
            .map(|row| row.chunks_mut(TASK))
            .collect();
        let tasks: Vec<Vec<&mut [RayOutcome]>> = (0..columns.div_ceil(TASK))
            .map(|_| rows.iter_mut().filter_map(Iterator::next).collect())
            .collect();
        let groups = beams.div_ceil(LANES).max(1);
        tasks.into_par_iter().enumerate().for_each(|(task, mut rows)| {
            let packet = |i: usize| {
                let (column, group) = (task * TASK + i / groups, i % groups);
                let mut directions = [DVec3::ZERO; LANES];
                for (lane, d) in directions.iter_mut().enumerate() {
                    *d = self.rays.directions[(group * LANES + lane).min(beams - 1) * columns + column];
                }
                Packet {
                    origin: self.origins[column],
                    directions,
                }
            };
            let count = rows.first().map_or(0, |row| row.len() * groups);
            let max_t = self.pattern.max_range_m / Lattice::OCC3D.voxel_m();
            self.masks.cast_packets(count, max_t, packet, |i, met| {
                let (column, first) = (i / groups, i % groups * LANES);
                for (beam, met) in (first..beams).zip(met) {
                    rows[beam][column] = self.found(beam * columns + task * TASK + column, *met);
                }
            });
        });
        self.cast = found.len();
        self.found = found;
    }

    #[inline]
    fn cast_one(&self, ray: usize) -> RayOutcome {
        let (origin, direction) = (self.origins[ray % self.columns], self.rays.directions[ray]);
        let max_t = self.pattern.max_range_m / Lattice::OCC3D.voxel_m();
        let met = self.masks.cast_in_voxels(origin, direction, max_t);
        self.found(ray, met.map(|(t, voxel)| (t, voxel.map(|v| v as u16))))
    }

    /// Result of a ray that met a voxel or nothing: its reach in m, and its point if it met one within range.
    #[inline]
    fn found(&self, ray: usize, met: PacketHit) -> RayOutcome {
        let Some((t, voxel)) = met else {
            return (f32::INFINITY, None);
        };
        let (origin, direction) = self.rays.get(ray);
        let range_m = t * Lattice::OCC3D.voxel_m();
        let [x, y, z] = voxel.map(usize::from);
        let point = || LidarPoint {
            position_in_ego: (origin + direction * range_m).as_vec3().to_array(),
            range_m: range_m as f32,
            ring: (ray / self.columns) as u16,
            azimuth: (ray % self.columns) as u16,
            // A label outside the table can only come from a damaged grid; it still reflects.
            class: Class::from_id(self.grid.get(x, y, z)).unwrap_or(Class::Others),
            intensity: 0.0,
            drop_probability: 0.0,
            time_s: 0.0,
            velocity_mps: [0.0; 2],
        };
        // Rounded up, so that the voxel that was hit is within reach.
        let reach = (range_m as f32).next_up();
        (reach, (range_m >= self.pattern.min_range_m).then(point))
    }
}

/// The origins of rays in voxel units.
fn in_voxels(extent: Extent, rays: &Rays) -> Vec<DVec3> {
    let origins = rays.origins.iter();
    origins.map(|o| extent.to_voxel_units(*o)).collect()
}

/// The box around the voxels of a brick that differ. `None` if none does.
fn changed_in(before: &VoxelGrid, after: &VoxelGrid, brick: usize) -> Option<Changed> {
    let ([x0, y0], [along_x, along_y]) = before.brick_columns(brick);
    let mut found: Option<([usize; 3], [usize; 3])> = None;
    for x in x0..x0 + along_x {
        for y in y0..y0 + along_y {
            let (a, b) = (before.column(x, y), after.column(x, y));
            if a == b {
                continue;
            }
            for z in (0..Lattice::OCC3D.bins()).filter(|&z| a[z] != b[z]) {
                let (low, high) = found.get_or_insert(([x, y, z], [x, y, z]));
                for (axis, v) in [x, y, z].into_iter().enumerate() {
                    low[axis] = low[axis].min(v);
                    high[axis] = high[axis].max(v);
                }
            }
        }
    }
    let (low, high) = found?;
    let point = |p: [usize; 3], by: f64| DVec3::from_array(p.map(|v| v as f64 + by));
    Some(Changed {
        low: point(low, -MARGIN),
        high: point(high, 1.0 + MARGIN),
    })
}

/// 1 / d. For an axis at rest the number is so large that only boxes in the ray's way count, and no NaN arises.
fn inverse(d: f64) -> f64 {
    if d == 0.0 { 1e300 } else { 1.0 / d }
}

impl Changed {
    /// True if a plane through `origin` with the unit normal `normal` meets the box.
    #[inline]
    fn cuts(&self, origin: DVec3, normal: DVec3) -> bool {
        let (middle, half) = ((self.low + self.high) / 2.0, (self.high - self.low) / 2.0);
        // Wider by far more than rounding, from any origin that f64 can tell voxels apart from.
        let wide = 1e-3 + 1e-12 * origin.abs().max_element();
        let beside = normal.dot(middle - origin).abs() > normal.abs().dot(half) + wide;
        !beside
    }

    /// True if a ray meets the box at most `reach` from its origin (slab test).
    #[inline]
    fn is_met(&self, origin: DVec3, inverse: DVec3, reach: f64) -> bool {
        let (a, b) = ((self.low - origin) * inverse, (self.high - origin) * inverse);
        let (near, far) = (a.min(b), a.max(b));
        near.max_element().max(0.0) <= far.min_element().min(reach + 2.0 * MARGIN)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use scene::Window;
    use world::draw::Draw;

    fn world() -> VoxelGrid {
        let mut grid = VoxelGrid::new();
        for x in 0..Window::NX {
            for y in 0..Window::NY {
                if (x / 7 + y / 5) % 3 != 0 {
                    grid.set(x, y, 0, Class::DriveableSurface.id());
                }
                if (x * 31 + y * 17) % 97 == 0 {
                    for z in 1..(x + y) % 13 {
                        grid.set(x, y, z, Class::Vegetation.id());
                    }
                }
            }
        }
        grid
    }

    #[test]
    fn an_updated_sweep_is_a_fresh_one() {
        let rig = SensorRig::default();
        let ego = Some(EgoBox::of_rig(&rig));
        let mut moving = rig.lidars[0].clone();
        (moving.spin_hz, moving.clockwise, moving.sector_deg) = (10.0, true, 200.0);
        for (pattern, speed) in [(&rig.lidars[0], 0.0), (&moving, 14.0)] {
            let mut grid = world();
            let mut caster = Caster::new(&grid, pattern, DVec3::X * speed, ego);
            let mut least = caster.cast_last();
            assert_eq!(least, pattern.rays());
            let mut draw = Draw::new(5, "edits");
            for edit in 0..60 {
                // Blocks of one to nine columns, added, taken away or repainted; some in the ego vehicle.
                let mut below = |n: usize| draw.below(n);
                let (size, class) = (
                    [1 + below(9), 1 + below(9), 1 + below(8)],
                    [4, 17, 15, 11][below(4)],
                );
                let near = edit % 3 == 0;
                let at = if near {
                    [94 + below(12), 94 + below(12)]
                } else {
                    [below(190), below(190)]
                };
                for i in 0..size[0] * size[1] * size[2] {
                    let [dx, dy, dz] = [i % size[0], i / size[0] % size[1], i / size[0] / size[1]];
                    grid.set((at[0] + dx).min(199), (at[1] + dy).min(199), dz, class);
                }
                caster.update(&grid);
                least = least.min(caster.cast_last());
                let fresh = Caster::new(&grid, pattern, DVec3::X * speed, ego);
                assert_eq!(caster.sweep(), fresh.sweep(), "edit {edit}");
            }
            assert!(least < pattern.rays() / 20, "{least} rays at least");
            caster.update(&grid.clone());
            assert_eq!(caster.cast_last(), 0, "nothing changed");
        }
    }

    #[test]
    fn a_rolling_sweep_sees_from_where_the_vehicle_was() {
        let mut grid = VoxelGrid::new();
        for y in 0..Window::NY {
            for z in 0..Lattice::OCC3D.bins() {
                grid.set(150, y, z, Class::Manmade.id()); // a wall, its face at x = 20 m
            }
        }
        let mut pattern = SensorRig::default().lidars[0].clone();
        pattern.rotation_wxyz = [1.0, 0.0, 0.0, 0.0];
        pattern.translation_m = [0.0, 0.0, 2.0];
        (pattern.elevations_deg, pattern.columns, pattern.spin_hz) = (vec![0.0], 8, 10.0);
        let sweep = Caster::new(&grid, &pattern, DVec3::X * 20.0, None).sweep();
        // Column 0 looks ahead, a whole turn before the end: the vehicle was 2 m back.
        let first = sweep.points[0];
        assert_eq!(first.azimuth, 0);
        assert!((first.range_m - 22.0).abs() < 1e-5 && (first.position_in_ego[0] - 20.0).abs() < 1e-5);
        pattern.spin_hz = 0.0;
        assert!(
            (Caster::new(&grid, &pattern, DVec3::X * 20.0, None).sweep().points[0].range_m - 20.0).abs()
                < 1e-5
        );
        pattern.sector_deg = 90.0;
        assert_eq!(pattern.rays(), 2);
        (pattern.columns, pattern.sector_deg) = (1080, 120.0);
        assert_eq!(pattern.columns_in_sector(), 360);
    }
}
