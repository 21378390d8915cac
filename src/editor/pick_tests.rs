//! Tests of picking, against exact rational arithmetic and against every voxel one by one.

use std::collections::BTreeMap;

use proptest::prelude::*;

use super::*;
use scene::{BevLayout, Window};

fn ray(o: [f64; 3], d: [f64; 3]) -> PickRay {
    PickRay::new(o.into(), d.into()).expect("a direction")
}

fn some_box(id: u32, center: [f64; 3], size: [f64; 3], yaw_rad: f64) -> SceneBox {
    SceneBox {
        id: BoxId(id),
        class: Class::Car,
        center_m: center.into(),
        size_m: size.into(),
        yaw_rad,
        velocity_mps: DVec2::ZERO,
        label: Default::default(),
    }
}

fn frame(boxes: &[SceneBox], grid: VoxelGrid) -> Frame {
    let boxes: BTreeMap<_, _> = boxes.iter().map(|b| (b.id, *b)).collect();
    Frame::new(BevLayout::default(), boxes, grid)
}

/// A fraction with positive denominator.
#[derive(Clone, Copy)]
struct Ratio(i128, i128);

impl Ratio {
    fn new(n: i128, d: i128) -> Ratio {
        if d < 0 { Ratio(-n, -d) } else { Ratio(n, d) }
    }

    fn less(self, other: Ratio) -> bool {
        self.0 * other.1 < other.0 * self.1
    }
}

/// The slab test in exact arithmetic: closed box, whole line.
fn slab_exact(o: [i32; 3], d: [i32; 3], min: [i32; 3], max: [i32; 3]) -> Option<[Option<Ratio>; 2]> {
    let (mut enter, mut leave): (Option<Ratio>, Option<Ratio>) = (None, None);
    for axis in 0..3 {
        let at = |face: i32| Ratio::new(i128::from(face - o[axis]), i128::from(d[axis]));
        if d[axis] == 0 {
            if o[axis] < min[axis] || o[axis] > max[axis] {
                return None;
            }
            continue;
        }
        let (mut a, mut b) = (at(min[axis]), at(max[axis]));
        if b.less(a) {
            std::mem::swap(&mut a, &mut b);
        }
        enter = Some(enter.map_or(a, |e| if e.less(a) { a } else { e }));
        leave = Some(leave.map_or(b, |l| if b.less(l) { b } else { l }));
    }
    match (enter, leave) {
        (Some(e), Some(l)) if l.less(e) => None,
        _ => Some([enter, leave]),
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(4000))]

    /// Row 46 of the extremes table: small whole numbers, so that faces, edges, corners and zero
    /// directions on the very plane come up all the time.
    #[test]
    fn row_46_slab_equals_rational_oracle(
        o in prop::array::uniform3(-4i32..=4),
        d in prop::array::uniform3(-3i32..=3),
        a in prop::array::uniform3(-3i32..=3),
        size in prop::array::uniform3(0i32..=3),
        negative_zero in any::<bool>(),
    ) {
        let max = [a[0] + size[0], a[1] + size[1], a[2] + size[2]];
        let f = |v: [i32; 3]| DVec3::from_array(v.map(f64::from));
        let mut direction = f(d);
        if negative_zero {
            direction = DVec3::from_array(direction.to_array().map(|v| if v == 0.0 { -0.0 } else { v }));
        }
        let got = slab(f(o), direction, f(a), f(max));
        let want = slab_exact(o, d, a, max);
        prop_assert_eq!(got.is_some(), want.is_some());
        if let (Some((enter, leave)), Some([e, l])) = (got, want) {
            let value = |r: Option<Ratio>, all: f64| r.map_or(all, |r| r.0 as f64 / r.1 as f64);
            prop_assert_eq!(enter, value(e, f64::NEG_INFINITY));
            prop_assert_eq!(leave, value(l, f64::INFINITY));
        }
    }

    /// Row 45 of the extremes table, for picking: the same voxel distance as asking every voxel.
    #[test]
    fn row_45_dda_equals_every_voxel(
        // In half voxels: origins on faces, edges and corners, inside the grid and out.
        o in (-40i32..440, -40i32..440, -20i32..60),
        d in prop::array::uniform3(-3i32..=3),
        voxels in prop::collection::vec((80usize..120, 80usize..120, 0usize..16), 1..60),
        jitter in any::<bool>(),
    ) {
        prop_assume!(d != [0, 0, 0]);
        let mut grid = VoxelGrid::new();
        for (x, y, z) in &voxels {
            grid.set(*x, *y, *z, 15);
        }
        let half = DVec3::new(f64::from(o.0), f64::from(o.1), f64::from(o.2)) / 2.0;
        let mut direction = DVec3::from_array(d.map(f64::from));
        if jitter {
            direction += DVec3::new(0.0123, -0.0456, 0.00789);
        }
        let r = PickRay::new(Extent::WINDOW.from_voxel_units(half), direction).expect("finite");
        let got = ray_voxels(&r, &grid, |_, _| true);
        let hits = |shrink: f64| {
            let origin = Extent::WINDOW.to_voxel_units(r.origin_in_ego);
            let each = voxels.iter().filter_map(|(x, y, z)| {
                let min = DVec3::new(*x as f64, *y as f64, *z as f64);
                let (lo, hi) = (min + shrink, min + 1.0 - shrink);
                let (enter, leave) = slab(origin, r.direction_in_ego, lo, hi)?;
                (leave >= 0.0).then_some(enter.max(0.0) * Window::VOXEL_M)
            });
            each.reduce(f64::min)
        };
        // A ray along a face or through an edge may count for either side: the answer lies between
        // that for slightly smaller and slightly larger voxels.
        let (strict, loose) = (hits(1e-9), hits(-1e-9));
        match got {
            Some(hit) => {
                prop_assert!(voxels.contains(&hit.cell.into()));
                let loose = loose.expect("a hit touches a voxel");
                prop_assert!(hit.distance_m >= loose - 1e-6);
                if let Some(strict) = strict {
                    prop_assert!(hit.distance_m <= strict + 1e-6);
                }
                prop_assert_eq!(hit.normal.iter().map(|n| n.abs()).sum::<i32>(), 1);
                let along: f64 = (0..3).map(|a| r.direction_in_ego[a] * f64::from(hit.normal[a])).sum();
                prop_assert!(along < 0.0, "a face is entered against its normal");
            }
            None => prop_assert!(strict.is_none(), "missed a voxel at {strict:?}"),
        }
    }
}

#[test]
fn row_45_far_and_degenerate_rays_end() {
    let mut grid = VoxelGrid::new();
    grid.set(199, 199, 15, 15);
    let corner = Extent::WINDOW.center(199, 199, 15);
    let direction = DVec3::new(-1.0, -2.0, -0.1);
    let far = PickRay::new(corner - direction.normalize() * 1e6, direction).expect("finite");
    let hit = ray_voxels(&far, &grid, |_, _| true).expect("aimed at its centre");
    assert_eq!(hit.cell, [199, 199, 15]);
    assert!((hit.distance_m - 1e6).abs() < 1.0);
    // The longest way through the grid: every plane once.
    let diagonal = ray([-40.0, -40.0, -1.0], [80.0, 80.0, 6.4]);
    assert_eq!(
        ray_voxels(&diagonal, &grid, |_, _| true).map(|h| h.cell),
        Some([199, 199, 15])
    );
    assert_eq!(ray_voxels(&diagonal, &grid, |_, label| label != 15), None);
    for bad in [f64::NAN, f64::INFINITY] {
        assert_eq!(PickRay::new(DVec3::new(bad, 0.0, 0.0), DVec3::X), None);
        assert_eq!(PickRay::new(DVec3::ZERO, DVec3::new(bad, 0.0, 0.0)), None);
    }
    assert_eq!(PickRay::new(DVec3::ZERO, DVec3::ZERO), None);
}

#[test]
fn rays_meet_turned_boxes_and_the_ground() {
    let b = some_box(1, [10.0, 0.0, 1.0], [4.0, 2.0, 2.0], std::f64::consts::FRAC_PI_2);
    let hit = ray_box(&ray([0.0, 0.0, 1.0], [1.0, 0.0, 0.0]), &b).expect("in the way");
    assert!(
        (hit - 9.0).abs() < 1e-12,
        "turned by 90 degrees its width faces us: {hit}"
    );
    assert_eq!(ray_box(&ray([10.0, 0.0, 1.0], [0.3, 0.4, 0.0]), &b), Some(0.0));
    assert_eq!(ray_box(&ray([20.0, 0.0, 1.0], [1.0, 0.0, 0.0]), &b), None);
    let down = ray([1.0, 2.0, 10.0], [0.0, 0.0, -1.0]);
    assert_eq!(ray_ground(&down, 0.0), Some(DVec3::new(1.0, 2.0, 0.0)));
    assert_eq!(ray_ground(&ray([0.0; 3], [1.0, 0.0, 0.0]), -1.0), None);
    assert_eq!(ray_ground(&ray([0.0, 0.0, 1.0], [1.0, 0.0, 0.1]), 0.0), None);
}

#[test]
fn pick_prefers_what_is_in_front_and_gives_voxels_to_their_box() {
    let car = some_box(7, [10.0, 0.0, 0.85], [4.6, 1.95, 1.7], 0.0);
    let mut grid = VoxelGrid::new();
    // The car's blob reaches a voxel beyond its rear (x = 7.7 m) and down to bin 0; a wall stands at x = 4 m, y < -1 m.
    let [x, y, _] = Extent::WINDOW
        .voxel_at(DVec3::new(7.5, 0.1, 0.0))
        .expect("inside");
    grid.set(x, y, 0, Class::Car.id());
    let [wx, wy, wz] = Extent::WINDOW
        .voxel_at(DVec3::new(4.1, -2.1, 1.1))
        .expect("inside");
    grid.set(wx, wy, wz, Class::Manmade.id());
    let f = frame(&[car], grid);
    let id_of = |hit: Option<PickHit>| match hit {
        Some(PickHit::Box { id, .. }) => Some(id),
        _ => None,
    };
    assert_eq!(
        id_of(pick(&f, &ray([0.0, 0.0, 1.0], [1.0, 0.0, 0.0]))),
        Some(BoxId(7))
    );
    // Aimed low: the ray passes below the box and meets the blob in bin 0.
    assert_eq!(
        id_of(pick(&f, &ray([0.0, 0.1, -0.8], [1.0, 0.0, 0.0]))),
        Some(BoxId(7))
    );
    let wall = pick(&f, &ray([0.0, -2.1, 1.1], [1.0, 0.0, 0.0]));
    match wall {
        Some(PickHit::Voxel(v)) => {
            assert_eq!((v.cell, v.normal), ([wx, wy, wz], [-1, 0, 0]));
            assert_eq!(v.neighbour(Extent::WINDOW), Some([wx - 1, wy, wz]));
        }
        other => panic!("expected the wall, got {other:?}"),
    }
    let ground = pick(&f, &ray([0.0, 20.0, 10.0], [0.0, 0.0, -1.0]));
    assert_eq!(
        ground,
        Some(PickHit::Ground {
            point_in_ego: DVec3::new(0.0, 20.0, 0.0)
        })
    );
    assert_eq!(pick(&f, &ray([0.0, 20.0, 10.0], [0.0, 0.0, 1.0])), None);
}

#[test]
fn birds_eye_picking_takes_the_topmost_box_and_its_handles() {
    let truck = some_box(1, [0.0, 0.0, 1.5], [8.0, 3.0, 3.0], 0.0);
    let cone = some_box(2, [0.0, 0.0, 0.4], [0.5, 0.5, 0.8], 0.0);
    let crate_on_top = some_box(3, [1.0, 0.0, 3.5], [1.0, 1.0, 1.0], 0.0);
    let f = frame(&[truck, cone, crate_on_top], VoxelGrid::new());
    let at = |x, y| box_at(&f, DVec2::new(x, y));
    assert_eq!(at(0.0, 0.0), Some(BoxId(1)));
    assert_eq!(at(1.2, 0.2), Some(BoxId(3)));
    assert_eq!(at(0.0, 1.6), None);
    assert_eq!(at(f64::NAN, 0.0), None);

    assert_eq!(handle_at(&truck, rotate_knob(&truck), 0.3), Some(Handle::Rotate));
    assert_eq!(
        handle_at(&truck, DVec2::new(-4.1, 1.4), 0.3),
        Some(Handle::Corner(1))
    );
    assert_eq!(handle_at(&truck, DVec2::new(1.0, 0.5), 0.3), Some(Handle::Body));
    // Seen from afar it is moved, not resized by corners that would cover it.
    assert_eq!(handle_at(&truck, DVec2::new(0.2, 0.1), 1.5), Some(Handle::Body));
    assert_eq!(handle_at(&truck, DVec2::new(-4.1, 1.4), 9.0), None);
    assert_eq!(handle_at(&truck, DVec2::new(0.0, 5.0), 0.3), None);
    assert_eq!(yaw_deg_towards(&truck, DVec2::new(0.0, 3.0)), Some(90.0));
    assert_eq!(yaw_deg_towards(&truck, DVec2::ZERO), None);
}

#[test]
fn a_corner_drag_keeps_the_opposite_corner() {
    let b = some_box(1, [3.0, -2.0, 1.0], [4.0, 2.0, 2.0], 0.7);
    for corner in 0..4 {
        let opposite = b.footprint()[(corner + 2) % 4];
        for target in [
            b.footprint()[corner] + DVec2::new(0.3, 0.5),
            b.center_m.truncate(),
            opposite * 3.0,
        ] {
            let (center_m, size_m) = resized_by_corner(&b, corner, target);
            let new = SceneBox {
                center_m,
                size_m,
                ..b
            };
            assert_eq!(new.problem(), None);
            assert!((new.footprint()[(corner + 2) % 4] - opposite).length() < 1e-9);
            assert_eq!((new.center_m.z, new.size_m.z), (1.0, 2.0));
        }
        let (center_m, size_m) = resized_by_corner(&b, corner, b.footprint()[corner]);
        assert!((center_m - b.center_m).length() < 1e-9 && (size_m - b.size_m).length() < 1e-9);
    }
}
