//! Rows 34, 36 and 52: cells, polylines and rays.

use std::collections::{BTreeSet, HashSet};

use editor::Shape;
use glam::{DVec2, DVec3};
use numeric::splitmix::scatter;
use scene::raster::line_cells;
use scene::{LidarPattern, SensorRig, Window};
use sensors::lidar::Rays;

/// Row 34: any point is in range or none, and its voxel's centre is within half a voxel.
#[test]
fn row_34_points_and_centres() {
    let odd = [
        -40.0,
        40.0,
        39.999_999_999_999_99,
        -40.000_000_000_000_01,
        -0.0,
        0.0,
        5e-324,
        1e30,
        -1e30,
        f64::NAN,
        f64::INFINITY,
        -1.0,
        5.4,
        0.4,
        0.2,
        1e-12,
    ];
    let mut inside = 0;
    for i in 0..60_000u64 {
        let at = |k: u64| match i % 3 {
            0 => odd[(scatter(i * 7 + k) * odd.len() as f64) as usize],
            _ => scatter(i * 7 + k) * 90.0 - 45.0,
        };
        let p = DVec3::new(at(0), at(1), at(2) / if i % 2 == 0 { 8.0 } else { 1.0 });
        let Some([x, y, z]) = Window::voxel_at(p) else {
            continue;
        };
        assert!(x < Window::NX && y < Window::NY && z < Window::NZ);
        let off = (Window::center(x, y, z) - p).abs().max_element();
        assert!(off <= 0.2 + 1e-12, "{p}: {off}");
        inside += 1;
    }
    assert!(inside > 10_000);
}

/// Row 36: equal to the line without its repeated points, whatever crosses itself; and a stroke over the whole map with
/// hundreds of points costs no more memory than the map (it did: every segment kept its own cells).
#[test]
fn row_36_strokes() {
    for seed in 0..200u64 {
        let n = 2 + seed % 12;
        let points: Vec<DVec2> = (0..n)
            .map(|i| {
                DVec2::new(
                    scatter(seed * 99 + i) * 90.0 - 45.0,
                    scatter(seed * 77 + i + 5000) * 90.0 - 45.0,
                )
            })
            .collect();
        let repeated: Vec<DVec2> = points.iter().flat_map(|p| [*p; 3]).collect();
        let cells = |points: &[DVec2]| {
            let mut out = BTreeSet::new();
            line_cells(scene::Extent::WINDOW, points, 0.3, |x, y| {
                out.insert((x, y));
            });
            out
        };
        assert_eq!(cells(&points), cells(&repeated));
    }
    let wide = Shape::Line {
        points_m: (0..2000)
            .map(|i| DVec2::new(f64::from(i % 2) * 78.0 - 39.0, 0.0))
            .collect(),
        width_m: 1e6,
    };
    assert_eq!(
        wide.cells(scene::Extent::WINDOW).expect("all of it").len(),
        Window::COLUMNS
    );
}

/// Row 52: every ray of a revolution is unique and of unit length, with any mount, sector and speed.
#[test]
fn row_52_rays() {
    let nuscenes = SensorRig::default().lidars[0].clone();
    for (beams, columns, sector_deg) in [
        (1, 1084, 360.0),
        (32, 1084, 360.0),
        (128, 1024, 360.0),
        (64, 1080, 120.0),
    ] {
        for clockwise in [false, true] {
            let step = 40.0 / f64::from(beams);
            let pattern = LidarPattern {
                elevations_deg: (0..beams).map(|b| -30.0 + step * f64::from(b)).collect(),
                columns,
                sector_deg,
                clockwise,
                spin_hz: 20.0,
                ..nuscenes.clone()
            };
            let rays = Rays::new(&pattern, DVec3::X * 30.0);
            assert_eq!(rays.directions.len(), pattern.rays());
            let unique: HashSet<[u64; 3]> = rays
                .directions
                .iter()
                .map(|d| {
                    assert!((d.length() - 1.0).abs() < 1e-12, "{d}");
                    d.to_array().map(f64::to_bits)
                })
                .collect();
            assert_eq!(unique.len(), pattern.rays(), "{beams} beams, {columns} columns");
        }
    }
}
