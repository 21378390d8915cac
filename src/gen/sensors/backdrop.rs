//! What a LiDAR sees of the town around a procedural world: level ground, houses and trees beyond the grid. Without it
//! every pulse that leaves the grid would be one without an echo, which real sweeps do not show (`real_statistics.md`,
//! section 3: a tenth of the echoes come from beyond 34 m).

use glam::DVec3;

use crate::generation::world::World;
use crate::generation::world::draw::{Draw, hash, noise};
use crate::scene::{BevLayer, Class, GridSpec};

/// Half the edge of the grid, m.
const GRID_M: f64 = 40.0;
/// How far beyond it rows of houses and trees stand, m.
const ROWS_M: [f64; 3] = [2.5, 11.0, 24.0];
/// Length of a plot along a row, m.
const PLOT_M: f64 = 9.0;
/// Shares of plots that are open, and that are open or built on; the others have trees.
const OPEN: f64 = 0.4;
const BUILT: f64 = 0.75;

/// A surface beyond the grid.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Behind {
    /// Distance along the ray, m.
    pub range_m: f64,
    /// What was hit.
    pub class: Class,
    /// Outward unit normal.
    pub normal: DVec3,
    /// Names the house or tree, never 0; the ground is 0.
    pub instance: u32,
}

/// The first surface beyond the grid along a ray that meets nothing inside it; `dir` is a unit vector.
pub fn cast(world: &World, origin: DVec3, dir: DVec3, max_range_m: f64) -> Option<Behind> {
    let mut best: Option<Behind> = None;
    if dir.z < -1e-6 {
        let range_m = -origin.z / dir.z;
        let p = origin + dir * range_m;
        if GridSpec::column_at(p.x, p.y).is_none() && range_m > 0.0 && range_m <= max_range_m {
            let class = if is_street(world, p) {
                Class::DriveableSurface
            } else {
                Class::Terrain
            };
            best = Some(Behind {
                range_m,
                class,
                normal: DVec3::Z,
                instance: 0,
            });
        }
    }
    for (row, beyond_m) in ROWS_M.into_iter().enumerate() {
        // Where the ray leaves the square on whose sides the row stands.
        let reach = GRID_M + beyond_m;
        let side = |axis: usize| -> f64 {
            match dir[axis] {
                d if d.abs() < 1e-12 => f64::INFINITY,
                d => (reach * d.signum() - origin[axis]) / d,
            }
        };
        let axis = usize::from(side(1) < side(0));
        let range_m = side(axis);
        let limit = best.map_or(max_range_m, |b| b.range_m);
        // Written so that NaN is no hit.
        if !(range_m > 0.0 && range_m < limit) {
            continue;
        }
        let p = origin + dir * range_m;
        if let Some((class, instance)) = stands(world, p, axis, row) {
            let mut normal = DVec3::ZERO;
            normal[axis] = -dir[axis].signum();
            return Some(Behind {
                range_m,
                class,
                normal,
                instance,
            });
        }
    }
    best
}

/// What stands at a point of a row.
fn stands(world: &World, p: DVec3, axis: usize, row: usize) -> Option<(Class, u32)> {
    if p.z < 0.0 || is_street(world, p) {
        return None;
    }
    let along = p[1 - axis];
    let plot = (along / PLOT_M).floor();
    let side = (axis * 2) as u64 + u64::from(p[axis] > 0.0);
    let key = hash(world.seed() ^ hash(plot as i64 as u64 ^ hash(side * 8 + row as u64)));
    let mut draw = Draw::new(key, "backdrop");
    let (kind, size) = (draw.unit(), draw.unit());
    let instance = (key as u32).max(1);
    let inside = (along / PLOT_M - plot - 0.5).abs() * PLOT_M;
    if kind < OPEN {
        None
    } else if kind < BUILT {
        (p.z < 3.5 + 10.0 * size && inside < 0.47 * PLOT_M).then_some((Class::Manmade, instance))
    } else {
        let top = 3.0 + 6.0 * size + 1.5 * noise(key, along * 0.8, 0.0);
        // Light falls through crowns, and under them.
        let leafy = noise(key, along * 2.5, p.z * 2.5) > -0.25;
        (p.z < top && p.z > 0.9 && leafy).then_some((Class::Vegetation, instance))
    }
}

/// True where a street that leaves the grid would go on.
fn is_street(world: &World, p: DVec3) -> bool {
    let most = GRID_M - 0.2;
    let edge = p
        .truncate()
        .clamp(glam::DVec2::splat(-most), glam::DVec2::splat(most));
    GridSpec::column_at(edge.x, edge.y)
        .is_some_and(|[x, y]| world.layout.cells()[x * GridSpec::NY + y] & BevLayer::DrivableArea.bit() != 0)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// All hits lie beyond the grid and within range, streets stay open, rays of any kind are survived.
    #[test]
    fn hits_lie_beyond_the_grid() {
        let world = World::random(4);
        let origin = DVec3::new(0.9, 0.0, 1.84);
        let (mut found, mut walls, mut street) = (0, 0, 0);
        for i in 0..4000 {
            let (a, z) = (f64::from(i) * 0.0157, f64::from(i % 37) * 0.01 - 0.06);
            let dir = DVec3::new(a.cos(), a.sin(), z).normalize();
            let hit = cast(&world, origin, dir, 90.0);
            assert_eq!(hit, cast(&world, origin, dir, 90.0));
            let Some(hit) = hit else { continue };
            let p = origin + dir * hit.range_m;
            assert!(p.truncate().abs().max_element() >= GRID_M - 1e-9 && hit.range_m <= 90.0);
            assert!(hit.normal.dot(dir) < 0.0 && (hit.normal.length() - 1.0).abs() < 1e-12);
            found += 1;
            walls += usize::from(hit.instance > 0);
            street += usize::from(hit.instance > 0 && is_street(&world, p));
        }
        assert!(
            found > 1000 && walls > 500 && street == 0,
            "{found} {walls} {street}"
        );
        for bad in [DVec3::ZERO, DVec3::splat(f64::NAN), DVec3::Z, -DVec3::Z] {
            let hit = cast(&world, origin, bad, 90.0);
            assert!(hit.is_none_or(|h| h.range_m.is_finite()));
            assert!(cast(&world, bad * f64::INFINITY, DVec3::X, 90.0).is_none_or(|h| h.range_m.is_finite()));
        }
    }
}
