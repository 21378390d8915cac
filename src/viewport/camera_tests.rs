//! Views fit what they shall, and nothing that is not finite comes out.

use super::*;

const SIZE: [u32; 2] = [640, 360];

fn all() -> impl Iterator<Item = ViewCamera> {
    ViewPreset::ALL.into_iter().map(ViewCamera::preset)
}

#[test]
fn ray_goes_through_what_is_projected() {
    for camera in all() {
        for p in [DVec3::new(12.0, 3.0, 1.0), DVec3::new(9.0, -2.5, 0.4)] {
            let Some(pixel) = camera.project(p, SIZE) else {
                continue;
            };
            let (origin, dir) = camera.ray_in_world(pixel, SIZE);
            assert!((dir.length() - 1.0).abs() < 1e-12);
            let miss = (p - origin).cross(dir).length();
            assert!(miss < 1e-9, "{camera:?}: {miss} m");
            assert!((p - origin).dot(dir) > 0.0);
        }
    }
}

#[test]
fn a_camera_of_pictures_sees_what_the_view_shows() {
    for view in all() {
        let Some(camera) = view.to_camera(SIZE) else {
            assert!(view.ortho);
            continue;
        };
        let from_ego = camera.ego_from_camera().inverse();
        for p in [
            view.target_m,
            DVec3::new(14.0, 3.0, 1.0),
            DVec3::new(19.0, -2.5, 0.4),
        ] {
            let seen = from_ego.apply(p);
            let pixel = DVec2::new(
                camera.focal_px[0] * seen.x / seen.z + camera.center_px[0],
                camera.focal_px[1] * seen.y / seen.z + camera.center_px[1],
            );
            let shown = view.project(p, SIZE).expect("in front");
            assert!(
                seen.z > 0.0 && (pixel - shown).length() < 1e-6,
                "{view:?}: {pixel} {shown}"
            );
        }
    }
}

#[test]
fn target_is_in_the_middle_and_depth_is_reversed() {
    for camera in all() {
        let pixel = camera.project(camera.target_m, SIZE).expect("in front");
        assert!((pixel - DVec2::new(320.0, 180.0)).length() < 1e-6);
        let depth = |p: DVec3| {
            let c = camera.clip_from_world(SIZE) * p.extend(1.0);
            c.z / c.w
        };
        let forward = camera.axes()[2];
        assert!(depth(camera.target_m) > depth(camera.target_m + forward));
        assert!((0.0..=1.0).contains(&depth(camera.target_m)));
    }
    // From above, ego x points up on screen and ego y (left) to the left.
    let top = ViewCamera::preset(ViewPreset::Top);
    let ahead = top.project(DVec3::new(10.0, 0.0, 0.0), SIZE).expect("seen");
    let left = top.project(DVec3::new(0.0, 10.0, 0.0), SIZE).expect("seen");
    assert!(ahead.y < 180.0 && (ahead.x - 320.0).abs() < 1e-6);
    assert!(left.x < 320.0 && (left.y - 180.0).abs() < 1e-6);
}

#[test]
fn a_map_fits_in() {
    // The middle of each side; a view from the side may cut the corners, as it always did.
    let seen = |camera: &ViewCamera, extent: Extent, corners: bool| {
        let (low, high) = (extent.min_m(), extent.max_m());
        let middle = (low + high) / 2.0;
        (0..9).all(|i| {
            let pick = |axis: usize, k: usize| [low, middle, high][k][axis];
            let p = DVec3::new(pick(0, i / 3), pick(1, i % 3), 0.0);
            let c = camera.clip_from_world([480, 480]) * p.extend(1.0);
            let inside = c.x.abs() <= c.w && c.y.abs() <= c.w && (0.0..=c.w).contains(&c.z);
            inside || !corners && i / 3 != 1 && i % 3 != 1
        })
    };
    for (from, size) in [
        ([-100, -100], [200, 200]),
        ([-150, -110], [480, 320]),
        ([3000, -4000], [8192, 2048]),
        ([0, 0], [1, 1]),
    ] {
        let extent = Extent::new(from, size).expect("sound");
        for preset in [ViewPreset::Perspective, ViewPreset::Top] {
            let mut camera = ViewCamera::preset(preset);
            camera.focus_map(extent, 1.0);
            assert!(
                camera == camera.sane() && seen(&camera, extent, true),
                "{preset:?} {extent}"
            );
        }
        if size[0] > 1 {
            assert!(
                seen(&ViewCamera::preset_over(ViewPreset::Top, extent), extent, true),
                "{extent}"
            );
        }
    }
    // In panes of any shape it is in the view, and some side of it comes near the edge.
    for size_px in [[480, 480], [1600, 500], [300, 900]] {
        for (from, size) in [([-100, -100], [200, 200]), ([-375, -125], [750, 250])] {
            let extent = Extent::new(from, size).expect("sound");
            let mut camera = ViewCamera::default();
            camera.focus_map(extent, f64::from(size_px[0]) / f64::from(size_px[1]));
            let (low, high) = (extent.min_m(), extent.max_m());
            let corners = [[low.x, low.y], [low.x, high.y], [high.x, low.y], [high.x, high.y]];
            let reach = corners.map(|[x, y]| {
                let c = camera.clip_from_world(size_px) * DVec3::new(x, y, 0.0).extend(1.0);
                (c.x.abs() / c.w).max(c.y.abs() / c.w)
            });
            let most = reach.into_iter().fold(0.0, f64::max);
            assert!((0.85..=1.0).contains(&most), "{size_px:?} {size:?}: {reach:?}");
        }
    }
    for preset in ViewPreset::ALL {
        let over = ViewCamera::preset_over(preset, Extent::WINDOW);
        let usual = ViewCamera::preset(preset).sane();
        assert!((over.distance_m - usual.distance_m).abs() < 1e-9 && over.target_m == usual.target_m);
    }
}

#[test]
fn zoom_keeps_the_point_under_the_cursor() {
    for mut camera in all() {
        let p = camera.target_m + camera.axes()[0] * 2.0;
        let before = camera.project(p, SIZE).expect("in front");
        camera.zoom(1.3, Some(p));
        let after = camera.project(p, SIZE).expect("in front");
        assert!((before - after).length() < 1e-6, "{camera:?}");
    }
}

#[test]
fn the_wheel_keeps_what_is_under_the_pointer_in_every_view() {
    for mut camera in all() {
        let [right, up, forward] = camera.axes();
        let eye = camera.eye_m();
        let aim = camera.target_m + right * 3.0 - up;
        let (from_m, way) = match camera.ortho {
            true => (aim - forward * 900.0, forward),
            false => (eye, (aim - eye).normalize()),
        };
        let p = camera.zoom_point_m(from_m, way, None);
        assert!((p - aim).length() < 1e-6, "{camera:?}");
        let before = camera.project(p, SIZE).expect("in front");
        camera.zoom(2.0, Some(p));
        assert!((camera.project(p, SIZE).expect("in front") - before).length() < 1e-6);
    }
}

#[test]
fn a_whole_map_is_never_seen_from_its_edge() {
    let mut camera = ViewCamera::preset(ViewPreset::Ego);
    (camera.pitch_rad, camera.fov_y_rad) = (0.0, 2.0);
    camera.focus_map(Extent::WINDOW, 1.5);
    assert_eq!(camera.pitch_rad, ViewCamera::default().pitch_rad);
    assert_eq!(camera.fov_y_rad, ViewCamera::default().fov_y_rad);
    let mut side = ViewCamera::preset(ViewPreset::Side);
    side.focus_map(Extent::WINDOW, 1.5);
    assert!(side.ortho && side.pitch_rad == ViewCamera::preset(ViewPreset::Side).pitch_rad);
}

#[test]
fn pan_follows_the_pointer() {
    let mut camera = ViewCamera::default();
    let p = camera.target_m;
    camera.pan(DVec2::new(30.0, -20.0), SIZE);
    let moved = camera.project(p, SIZE).expect("in front") - DVec2::new(320.0, 180.0);
    assert!((moved - DVec2::new(30.0, -20.0)).length() < 1e-6, "{moved}");
}

#[test]
fn nothing_non_finite_comes_out() {
    let bad = [f64::NAN, f64::INFINITY, f64::NEG_INFINITY, 1e300, -1e300, 0.0];
    for v in bad {
        let camera = ViewCamera {
            target_m: DVec3::splat(v),
            distance_m: v,
            yaw_rad: v,
            pitch_rad: v,
            fov_y_rad: v,
            ortho: v == 0.0,
        };
        for size in [[0, 0], [1, 4000], SIZE] {
            let matrix = camera.sane().clip_from_world(size);
            assert!(matrix.is_finite(), "{v}: {matrix}");
            let (origin, dir) = camera.ray_in_world(DVec2::splat(v), size);
            assert!(origin.is_finite() && dir.is_finite());
        }
        let mut moved = ViewCamera::default();
        moved.orbit(v, v);
        moved.turn_head(v, v);
        moved.zoom(v, Some(DVec3::splat(v)));
        moved.fly(DVec3::splat(v));
        moved.pan(DVec2::splat(v), [0, 0]);
        moved.focus(DVec3::splat(v), v);
        assert!(moved.clip_from_world(SIZE).is_finite(), "{v}");
        assert_eq!(ViewCamera::default().project(DVec3::splat(f64::NAN), SIZE), None);
    }
}

#[test]
fn looks_through_the_rig() {
    let rig = scene::SensorRig::default();
    for camera in &rig.cameras {
        let view = ViewCamera::through(camera);
        let eye = DVec3::from_array(camera.translation_m);
        assert!((view.eye_m() - eye).length() < 1e-9);
        let ahead = camera.ego_from_camera().rotation * DVec3::Z;
        assert!(view.axes()[2].dot(ahead) > 0.9999);
    }
}

#[test]
fn the_driver_sits_as_high_above_the_ground_in_every_lattice() {
    let eye_m = |extent: Extent| ViewCamera::preset_over(ViewPreset::Ego, extent).eye_m().z;
    let fine = Lattice::new(0.2, 32, -1.0).expect("sound");
    // Labels of Occ3D have the ground 0.8 m lower.
    let raised_m = eye_m(Extent::WINDOW.in_lattice(fine)) - eye_m(Extent::WINDOW);
    assert!((raised_m - 0.8).abs() < 1e-9, "{raised_m}");
}
