//! Rows 45 and 46 of the extremes table, and the upkeep of the masks.

use super::*;
use numeric::splitmix::scatter;
use scene::Window;

const N: [usize; 3] = [Window::NX, Window::NY, Window::NZ];

/// The window, a map, a map that is longer than packets go and no whole number of blocks wide, and a small one.
fn extents() -> [Extent; 4] {
    let new = |from, size| Extent::new(from, size).expect("sound");
    [
        Extent::WINDOW,
        new([-150, -110], [480, 320]),
        new([7, -500], [37, 1003]),
        new([-3, -4], [5, 9]),
    ]
}

/// The oracle of row 45: a plain three-axis walk, voxel by voxel, after the reference's script.
/// Returns the voxels visited (the last one is the hit if the flag is set) and the distance.
fn plain_walk(masks: &ColumnMasks, o: DVec3, d: DVec3) -> (Vec<[usize; 3]>, Option<f64>) {
    let mut visited = Vec::new();
    let mut cell = [0i64; 3];
    let (mut step, mut t_next) = ([0i64; 3], [f64::INFINITY; 3]);
    let t_plane = |axis: usize, cell: i64| {
        let side = if d[axis] > 0.0 {
            (cell + 1) as f64 - o[axis]
        } else {
            o[axis] - cell as f64
        };
        side * (1.0 / d[axis].abs())
    };
    for axis in 0..3 {
        cell[axis] = o[axis].floor() as i64;
        if d[axis] != 0.0 {
            step[axis] = d[axis].signum() as i64;
            t_next[axis] = t_plane(axis, cell[axis]);
        }
    }
    // Where the ray leaves the grid; a voxel touched only there is not visited.
    let last = |axis: usize| {
        if d[axis] > 0.0 {
            masks.shape[axis] as i64 - 1
        } else {
            0
        }
    };
    let leave = (0..3)
        .filter(|&a| d[a] != 0.0)
        .map(|a| t_plane(a, last(a)))
        .fold(f64::INFINITY, f64::min);
    let mut t_in = 0.0;
    while visited.is_empty() || t_in < leave {
        let c = cell.map(|v| v as usize);
        visited.push(c);
        if masks.occupied(c[0], c[1], c[2]) {
            return (visited, Some(t_in));
        }
        let mut axis = 0;
        for a in 1..3 {
            if t_next[a] < t_next[axis] {
                axis = a;
            }
        }
        t_in = t_next[axis];
        cell[axis] += step[axis];
        t_next[axis] = t_plane(axis, cell[axis]);
    }
    (visited, None)
}

fn scattered_voxels(extent: Extent, count: u64) -> ColumnMasks {
    let mut masks = ColumnMasks::from_grid(&VoxelGrid::over(extent));
    for i in 0..count {
        let v = [0, 1, 2].map(|a| (scatter(i * 3 + a) * masks.shape[a as usize] as f64) as usize);
        masks.set(v[0], v[1], v[2], true);
    }
    masks
}

fn walk_of(masks: &ColumnMasks, o: DVec3, d: DVec3) -> (Vec<[usize; 3]>, Option<f64>) {
    let mut visited = Vec::new();
    let start = GridEntry::new(masks.shape, o, d, f64::INFINITY).expect("starts inside");
    let hit = walk(masks, start.state(), start.t_end, |v| visited.push(v));
    // The cast, which skips what is free, comes to the same end.
    assert_eq!(
        masks.cast_in_voxels(o, d, f64::INFINITY),
        hit,
        "origin {o}, direction {d}"
    );
    (visited, hit.map(|h| h.0))
}

#[test]
fn row_45_dda_equals_the_plain_walk() {
    let masks = scattered_voxels(Extent::WINDOW, 3000);
    let empty = ColumnMasks::from_grid(&VoxelGrid::new());
    let mut rays = Vec::new();
    for i in 0..4000 {
        let at = |k: u64| scatter(1_000_000 + i * 8 + k);
        let o = DVec3::new(at(0) * 200.0, at(1) * 200.0, at(2) * 16.0);
        let d = DVec3::new(at(3) - 0.5, at(4) - 0.5, (at(5) - 0.5) * 0.3);
        rays.push((o, d.normalize()));
        // On faces, edges and corners.
        rays.push((o.floor(), d.normalize()));
    }
    // Parallel to axes and through edges and corners: ratios of two keep f64 exact.
    let parts = [0.0, -0.0, 1.0, -1.0, 2.0, -0.5];
    for x in parts {
        for y in parts {
            for z in parts {
                for o in [
                    DVec3::new(100.0, 100.0, 8.0),
                    DVec3::new(100.5, 99.5, 7.5),
                    DVec3::new(3.25, 0.0, 0.0),
                    DVec3::new(199.75, 199.0, 15.0),
                ] {
                    if DVec3::new(x, y, z) != DVec3::ZERO {
                        rays.push((o, DVec3::new(x, y, z)));
                    }
                }
            }
        }
    }
    for (o, d) in rays {
        for masks in [&masks, &empty] {
            let (got, want) = (walk_of(masks, o, d), plain_walk(masks, o, d));
            assert_eq!(got, want, "origin {o}, direction {d}");
            assert!(got.0.len() <= 416, "{} voxels from {o} along {d}", got.0.len());
        }
    }
}

/// From outside, and with a limited range, skipping free slabs changes nothing either.
#[test]
fn row_45_scan_equals_the_walk() {
    let (mut hits, mut misses) = (0, 0);
    for (extent, count) in extents()
        .into_iter()
        .flat_map(|e| [30, 1000, 100_000].map(|n| (e, n)))
    {
        let masks = scattered_voxels(extent, count);
        let [nx, ny, _] = masks.shape.map(|n| n as f64 + 60.0);
        for i in 0..20_000 {
            let at = |k: u64| scatter(5_000_000 + i * 8 + k);
            let o = DVec3::new(at(0) * nx - 30.0, at(1) * ny - 30.0, at(2) * 24.0 - 4.0);
            let o = if i % 3 == 0 { o.round() } else { o };
            let d = DVec3::new(
                at(3) - 0.5,
                at(4) - 0.5,
                (at(5) - 0.5) * if i % 2 == 0 { 0.2 } else { 1.0 },
            );
            // Some exactly diagonal, from corner to corner.
            let d = if i % 7 == 0 {
                DVec3::new(d.x, d.x * d.y.signum(), d.z)
            } else {
                d
            };
            let max_t = if i % 5 == 0 { at(6) * 300.0 } else { 1e9 };
            let d = d.normalize();
            let want = GridEntry::new(masks.shape, o, d, max_t)
                .and_then(|s| walk(&masks, s.state(), s.t_end, |_| ()));
            assert_eq!(
                masks.cast_in_voxels(o, d, max_t),
                want,
                "origin {o}, direction {d}"
            );
            hits += u32::from(want.is_some());
            misses += u32::from(want.is_none());
        }
    }
    assert!(hits > 5000 && misses > 5000, "{hits} {misses}");
}

#[test]
fn row_45_dda_extremes() {
    let mut masks = ColumnMasks::from_grid(&VoxelGrid::new());
    masks.set(100, 100, 4, true);
    let cast = |o: [f64; 3], d: [f64; 3]| masks.cast_in_voxels(o.into(), d.into(), 1e9);
    let hit = |t: f64| Some((t, [100, 100, 4]));
    // Inside, on a face, grazing along a face from either side, through an edge and a corner.
    assert_eq!(cast([100.5, 100.5, 4.5], [1.0, 0.0, 0.0]), hit(0.0));
    assert_eq!(cast([100.0, 100.0, 4.0], [0.0, 0.0, 1.0]), hit(0.0));
    assert_eq!(cast([0.5, 100.0, 4.0], [1.0, -0.0, 0.0]), hit(99.5));
    assert_eq!(cast([0.5, 101.0, 4.5], [1.0, 0.0, 0.0]), None);
    assert_eq!(cast([0.5, 100.5, 5.0], [1.0, 0.0, -0.0]), None);
    assert_eq!(cast([98.0, 98.0, 4.5], [1.0, 1.0, 0.0]), hit(2.0));
    assert_eq!(cast([98.0, 98.0, 2.0], [1.0, 1.0, 1.0]), hit(2.0));
    // From far away, from above, from below; pointing away; parallel and outside.
    let (t, voxel) = cast([-1e6, 100.5, 4.5], [1.0, 0.0, 0.0]).expect("straight on");
    assert_eq!((t, voxel), (1_000_100.0, [100, 100, 4]));
    let far = DVec3::new(-1e6, -1e6, 1e5);
    let d = (DVec3::new(100.4, 100.3, 4.6) - far).normalize();
    let (t, voxel) = masks.cast_in_voxels(far, d, 1e9).expect("far ray");
    assert_eq!(voxel, [100, 100, 4]);
    let p = far + d * t;
    assert!(
        (p - DVec3::new(100.4, 100.3, 4.6)).abs().max_element() < 0.7,
        "{p}"
    );
    assert_eq!(cast([100.5, 100.5, 1e6], [0.0, 0.0, -1.0]), hit(999_995.0));
    assert_eq!(cast([100.5, 100.5, -1e6], [0.0, 0.0, 1.0]), hit(1_000_004.0));
    assert_eq!(cast([100.5, 100.5, 1e6], [0.0, 0.0, 1.0]), None);
    assert_eq!(cast([100.5, 300.0, 4.5], [1.0, 0.0, 0.0]), None);
    // Not numbers, no direction, and components too small to matter.
    for bad in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
        assert_eq!(cast([bad, 0.0, 0.0], [1.0, 0.0, 0.0]), None);
        assert_eq!(cast([0.5, 0.5, 0.5], [1.0, bad, 0.0]), None);
    }
    assert_eq!(cast([100.5, 100.5, 4.5], [0.0, -0.0, 0.0]), None);
    assert_eq!(cast([0.5, 100.0, 4.0], [1.0, -1e-310, 1e-310]), hit(99.5));
    // The range is a limit, and counts itself.
    let limited = |max_t| masks.cast_in_voxels([90.0, 100.5, 4.5].into(), DVec3::X, max_t);
    assert_eq!(limited(10.0), hit(10.0));
    assert_eq!(limited(9.999_999), None);
    assert_eq!(limited(-1.0), None);
    assert_eq!(limited(f64::NAN), None);
}

/// The slab test in exact integers: origins and directions are quarters, so every entry and exit
/// is a ratio of small integers.
fn exact_span(o: [i128; 3], d: [i128; 3]) -> Option<[(i128, i128); 2]> {
    let (mut enter, mut leave) = ((0i128, 1i128), None::<(i128, i128)>);
    let less = |a: (i128, i128), b: (i128, i128)| a.0 * b.1 < b.0 * a.1; // denominators > 0
    for axis in 0..3 {
        let n = N[axis] as i128 * 4;
        if d[axis] == 0 {
            if o[axis] < 0 || o[axis] >= n {
                return None;
            }
            continue;
        }
        let ratio = |plane: i128| ((plane - o[axis]) * d[axis].signum(), d[axis].abs());
        let (mut a, mut b) = (ratio(0), ratio(n));
        if less(b, a) {
            (a, b) = (b, a);
        }
        if less(enter, a) {
            enter = a;
        }
        if leave.is_none_or(|l| less(b, l)) {
            leave = Some(b);
        }
    }
    let leave = leave?;
    let starts_inside = (0..3).all(|a| o[a] >= 0 && o[a] < N[a] as i128 * 4);
    (less(enter, leave) || starts_inside).then_some([enter, leave])
}

#[test]
fn row_46_slab_equals_rational_oracle() {
    let coordinates = [-400i128, -1, 0, 1, 37, 63, 64, 65, 799, 800, 801, 4000];
    let (mut inside, mut outside) = (0, 0);
    for x in coordinates {
        for y in coordinates {
            for z in coordinates {
                // Powers of two keep each quotient exact in f64.
                for direction in 0..7i128.pow(3) {
                    let part = |k: u32| [0, 1, -1, 4, -4, 16, -2][(direction / 7i128.pow(k) % 7) as usize];
                    let (o, d) = ([x, y, z], [part(0), part(1), part(2)]);
                    let quarters = |v: [i128; 3]| DVec3::from_array(v.map(|v| v as f64 / 4.0));
                    let got = grid_span(Extent::WINDOW, quarters(o), quarters(d));
                    match exact_span(o, d) {
                        Some([enter, leave]) => {
                            let span = got.unwrap_or_else(|| panic!("missed: {o:?} {d:?}"));
                            assert_eq!(span.enter, enter.0 as f64 / enter.1 as f64, "{o:?} {d:?}");
                            assert_eq!(span.leave, leave.0 as f64 / leave.1 as f64, "{o:?} {d:?}");
                            inside += 1;
                        }
                        None => {
                            assert_eq!(got, None, "{o:?} {d:?}");
                            outside += 1;
                        }
                    }
                }
            }
        }
    }
    assert!(inside > 10_000 && outside > 10_000, "{inside} {outside}");
    // -0.0 is 0, on the plane itself too.
    let along = |y| {
        let origin = DVec3::new(0.0, y, 8.0);
        grid_span(Extent::WINDOW, origin, DVec3::new(1.0, -0.0, 0.0))
    };
    assert!(along(0.0).is_some() && along(-0.0).is_some());
    assert!(along(200.0).is_none());
}

#[test]
fn update_follows_changed_bricks() {
    let mut grid = VoxelGrid::new();
    let before = grid.clone();
    let mut masks = ColumnMasks::from_grid(&grid);
    for (x, y, z) in [(0, 0, 0), (199, 199, 15), (17, 130, 3), (17, 130, 9)] {
        grid.set(x, y, z, Class::Others.id());
    }
    masks.update(&grid, &grid.changed_bricks(&before));
    assert_eq!(masks, ColumnMasks::from_grid(&grid));
    assert_eq!(masks.column(17, 130), 1 << 3 | 1 << 9);
    masks.update(&before, &[0, 168, 10_000]);
    assert_eq!(masks.column(0, 0), 0);
    assert_eq!(masks.column(199, 199), 0);
    let map = VoxelGrid::over(extents()[1]);
    masks.update(&map, &[]);
    assert_eq!(masks, ColumnMasks::from_grid(&map));
}

/// Rays cast in packets find what each finds alone: fans of any tilt and spread, along axes and diagonals, from
/// planes, from outside, with limited range, through few voxels and through many.
#[test]
fn row_45_packets_equal_single_rays() {
    let (mut hits, mut misses) = (0, 0);
    for (extent, count) in extents()
        .into_iter()
        .flat_map(|e| [0, 30, 1000, 30_000, 300_000].map(|n| (e, n)))
    {
        let masks = scattered_voxels(extent, count);
        let [nx, ny, _] = masks.shape.map(|n| n as f64);
        let ray = |i: u64| {
            let at = |k: u64| scatter(9_000_000 + i * 16 + k);
            let mut origin = DVec3::new(at(0) * nx, at(1) * ny, at(2) * 16.0);
            if i.is_multiple_of(5) {
                origin = origin.floor();
            }
            if i.is_multiple_of(31) {
                origin.z += 10.0;
            }
            let tilt = glam::DQuat::from_rotation_x((at(3) - 0.5) * [0.0, 0.04, 0.5][i as usize % 3]);
            let (azimuth, lowest, step) = (at(4) * std::f64::consts::TAU, (at(5) - 0.5) * 1.2, at(6) * 0.1);
            let directions = std::array::from_fn(|lane| {
                let elevation = lowest + step * lane as f64;
                if i.is_multiple_of(4) {
                    let flat = DVec3::new(azimuth.cos(), azimuth.sin(), 0.0).round();
                    return flat + DVec3::Z * (elevation * 8.0).round() / 8.0;
                }
                let (sin_e, cos_e) = elevation.sin_cos();
                tilt * DVec3::new(cos_e * azimuth.cos(), cos_e * azimuth.sin(), sin_e)
            });
            Packet { origin, directions }
        };
        for (max_t, from) in [(1e9, 0), (60.0, 20_000), (0.0, 40_000), (f64::NAN, 40_100)] {
            let packets = if max_t >= 1.0 { 20_000 } else { 100 };
            let mut seen = 0;
            masks.cast_packets(
                packets,
                max_t,
                |i| ray(from + i as u64),
                |i, met| {
                    assert_eq!(i, seen);
                    seen += 1;
                    let Packet { origin, directions } = ray(from + i as u64);
                    for (met, d) in met.iter().zip(directions) {
                        let alone = masks.cast_in_voxels(origin, d, max_t);
                        let alone = alone.map(|(t, voxel)| (t, voxel.map(|v| v as u16)));
                        assert_eq!(*met, alone, "origin {origin}, direction {d}, range {max_t}");
                        hits += u32::from(met.is_some());
                        misses += u32::from(met.is_none());
                    }
                },
            );
            assert_eq!(seen, packets);
        }
    }
    assert!(hits > 100_000 && misses > 100_000, "{hits} {misses}");
    // Nonsense among the rays does not disturb the others.
    let masks = scattered_voxels(Extent::WINDOW, 30_000);
    let mut directions = [DVec3::new(0.8, 0.6, -0.02); LANES];
    directions[1] = DVec3::NAN;
    directions[2] = DVec3::ZERO;
    directions[3] = DVec3::Z;
    directions[4] = -directions[0];
    directions[5] = DVec3::new(1e300, 1e300, 0.0);
    for origin in [DVec3::new(100.5, 99.5, 8.5), DVec3::NAN, DVec3::splat(-1e9)] {
        masks.cast_packets(
            1,
            1e9,
            |_| Packet { origin, directions },
            |_, met| {
                for (met, d) in met.iter().zip(directions) {
                    let alone = masks.cast_in_voxels(origin, d, 1e9);
                    assert_eq!(
                        *met,
                        alone.map(|(t, voxel)| (t, voxel.map(|v| v as u16))),
                        "{origin} {d}"
                    );
                }
            },
        );
    }
}

/// The instructions make no difference.
#[test]
fn wide_operations_equal_plain_ones() {
    use super::wide::{Plain, Wide, WideKernel};
    struct Check;
    impl WideKernel for Check {
        fn with(self, wide: impl Wide) {
            for i in 0..20_000u64 {
                let at = |k: u64| scatter(77_000_000 + i * 32 + k);
                let of = |from: u64, span: f64| -> [i32; LANES] {
                    std::array::from_fn(|lane| ((at(from + lane as u64) - 0.4) * span * 4_194_304.0) as i32)
                };
                let (height, step) = (of(0, 30.0), of(8, if i % 3 == 0 { 0.01 } else { 2.0 }));
                let (slabs, union) = (
                    (at(16) * 9.0) as i32,
                    (at(17) * 65_536.0) as u32 & (at(18) * 65_536.0) as u32,
                );
                let touching = wide.touching(&height, &step, slabs, union << 1);
                assert_eq!(touching, Plain.touching(&height, &step, slabs, union << 1));
                let (mut a, mut b) = (height, height);
                wide.climb(&mut a, &step, slabs);
                Plain.climb(&mut b, &step, slabs);
                assert_eq!(a, b);
                assert_eq!(wide.bounds(&height), Plain.bounds(&height));
            }
        }
    }
    super::wide::run(Check);
    Plain.run(Check);
}
