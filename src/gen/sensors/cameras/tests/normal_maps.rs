//! Normal maps: walls face the camera, the ground up, each with the right sign.

use glam::DVec3;

use super::*;
use scene::{Class, Window};

/// The colour in the middle of a normal map of voxels, from a camera at the origin, 1.5 m up.
fn middle(voxels: impl Fn(DVec3) -> Option<Class>, yaw_deg: f64, pitch_down_deg: f64) -> [i32; 3] {
    let mut grid = VoxelGrid::new();
    for (x, y, z) in (0..Window::VOXELS).map(|i| {
        (
            i / Window::NZ / Window::NY,
            i / Window::NZ % Window::NY,
            i % Window::NZ,
        )
    }) {
        if let Some(class) = voxels(Window::center(x, y, z)) {
            grid.set(x, y, z, class.id());
        }
    }
    let frame = Frame::new(BevLayout::default(), Default::default(), grid);
    let mut camera = Camera::new("CAM", 60.0);
    camera.translation_m = [0.0, 0.0, 1.5];
    // Yaw to the left, then the nose down, then from optical to body axes.
    let turn = |axis: DVec3, deg: f64| glam::DQuat::from_axis_angle(axis, f64::to_radians(deg));
    let optical = glam::DQuat::from_xyzw(-0.5, 0.5, -0.5, 0.5);
    let q = turn(DVec3::Z, yaw_deg) * turn(DVec3::Y, pitch_down_deg) * optical;
    camera.rotation_wxyz = [q.w, q.x, q.y, q.z];
    let picture = drawn(
        &normals::Normals,
        &frame,
        Conditions::default(),
        &camera,
        [41, 23],
    );
    let Ok(CameraPicture::Picture(image)) = picture else {
        panic!("no picture")
    };
    let at = (11 * 41 + 20) * 4;
    [0, 1, 2].map(|i| i32::from(image.rgba[at + i]))
}

#[track_caller]
fn assert_near(found: [i32; 3], expected: [i32; 3]) {
    let near = found.iter().zip(expected).all(|(a, b)| (a - b).abs() <= 8);
    assert!(near, "{found:?}, expected {expected:?}");
}

fn ground(p: DVec3) -> Option<Class> {
    (p.z < -0.6).then_some(Class::DriveableSurface)
}

#[test]
fn a_wall_faces_the_camera() {
    let wall = |p: DVec3| (p.x > 10.0 && p.x < 12.0).then_some(Class::Manmade);
    assert_near(middle(wall, 0.0, 0.0), [128, 128, 255]);
    // Turned to the left the camera has the wall's normal, 30 degrees off its axis, on its left.
    assert_near(middle(wall, 30.0, 0.0), [64, 128, 238]);
    assert_near(middle(wall, -30.0, 0.0), [191, 128, 238]);
    // To a camera with its nose up, what is level points up.
    assert_near(middle(wall, 0.0, -10.0), [128, 150, 253]);
}

#[test]
fn a_wall_on_the_left_faces_right() {
    let left = |p: DVec3| (p.y > 6.0 && p.y < 8.0).then_some(Class::Manmade);
    assert_near(middle(left, 60.0, 0.0), [191, 128, 238]);
    let right = |p: DVec3| (p.y < -6.0 && p.y > -8.0).then_some(Class::Manmade);
    assert_near(middle(right, -60.0, 0.0), [64, 128, 238]);
}

#[test]
fn the_ground_points_up_and_the_sky_nowhere() {
    // Straight down, up is towards the camera; at a slant, up in the picture too.
    assert_near(middle(ground, 0.0, 90.0), [128, 128, 255]);
    assert_near(middle(ground, 40.0, 30.0), [128, 238, 191]);
    assert_eq!(middle(ground, 0.0, -20.0), [128; 3]);
}
