use glam::{DMat4, DVec3};

use super::*;
use crate::clip_tests::{Plain, clip_scene};
use scene::{BoxId, BoxLabel, BoxName, Paint};

fn written(scene: &Scene) -> Value {
    let bytes = to_bytes(scene, &mut Plain::of(scene)).expect("written");
    assert_eq!(bytes, to_bytes(scene, &mut Plain::of(scene)).expect("again"));
    let mut file: Value = serde_json::from_slice(&bytes).expect("JSON");
    file["openlabel"].take()
}

fn numbers(value: &Value) -> Vec<f64> {
    serde_json::from_value(value.clone()).expect("numbers")
}

fn transform(value: &Value) -> DMat4 {
    let rows: [f64; 16] = numbers(&value["matrix4x4"]).try_into().expect("16 numbers");
    DMat4::from_cols_array(&rows).transpose()
}

#[test]
fn cuboids_are_where_the_boxes_are_and_the_quaternion_ends_with_w() {
    let scene = clip_scene(2);
    let file = written(&scene);
    assert_eq!(
        file["frame_intervals"],
        json!([{"frame_start": 0, "frame_end": 20}])
    );
    assert_eq!(file["frames"].as_object().expect("frames").len(), 21);
    for i in [0, 7, 20] {
        let now = scene.at(f64::from(i) / 10.0);
        let frame = &file["frames"][i.to_string()];
        assert_eq!(frame["frame_properties"]["timestamp"], now.time_s());
        let objects = frame["objects"].as_object().expect("objects");
        assert_eq!(objects.len(), now.frame().boxes.len());
        for b in now.frame().boxes.values() {
            let cuboid = &objects[&b.id.0.to_string()]["object_data"]["cuboid"][0];
            let v = numbers(&cuboid["val"]);
            assert_eq!(v[..3], b.center_m.to_array());
            assert_eq!(v[7..], b.size_m.to_array());
            assert_eq!(v[3..5], [0.0; 2]);
            assert!((2.0 * v[5].atan2(v[6]) - b.yaw_rad).sin().abs() < 1e-9);
        }
        // The transform takes points of the vehicle to the world.
        let to_odom = &frame["frame_properties"]["transforms"]["vehicle-iso8855_to_odom"];
        let p = DVec3::new(3.0, -1.0, 0.5);
        let found = transform(&to_odom["transform_src_to_dst"]).transform_point3(p);
        assert!((found - now.frame().world_from_ego.apply(p)).length() < 1e-9);
    }
}

#[test]
fn objects_say_when_they_are_there_and_what_they_are_called() {
    let mut scene = clip_scene(3);
    scene.change_canvas(|canvas| {
        let b = canvas.boxes.get_mut(&BoxId(1)).expect("there");
        b.label = BoxLabel {
            name: BoxName::new("the \"taxi\""),
            paint: Some(Paint::Yellow),
        };
    });
    let file = written(&scene);
    // Box 2 comes at 0.7 s, box 4 leaves at 1.2 s.
    let of = |id: &str| &file["objects"][id];
    assert_eq!(
        of("2")["frame_intervals"],
        json!([{"frame_start": 7, "frame_end": 20}])
    );
    assert_eq!(
        of("4")["frame_intervals"],
        json!([{"frame_start": 0, "frame_end": 11}])
    );
    assert_eq!(of("4")["object_data_pointers"]["shape"]["type"], "cuboid");
    assert_eq!(of("1")["type"], scene.frame().boxes[&BoxId(1)].class.name());
    let texts = [
        json!({"name": "name", "val": "the \"taxi\""}),
        json!({"name": "paint", "val": "yellow"}),
    ];
    assert_eq!(of("1")["object_data"]["text"], json!(texts));
    assert_eq!(
        intervals(&[0, 1, 4, 6, 7]),
        json!([
            {"frame_start": 0, "frame_end": 1}, {"frame_start": 4, "frame_end": 4}, {"frame_start": 6, "frame_end": 7}
        ])
    );
}

#[test]
fn sensors_hang_on_the_vehicle() {
    let scene = clip_scene(4);
    let file = written(&scene);
    let systems = &file["coordinate_systems"];
    assert_eq!(
        systems["vehicle-iso8855"]["children"]
            .as_array()
            .expect("names")
            .len(),
        7
    );
    let camera = &scene.rig.cameras[1];
    let system = &systems["CAM_FRONT"];
    assert_eq!(system["parent"], "vehicle-iso8855");
    let ahead = transform(&system["pose_wrt_parent"]).transform_vector3(DVec3::Z);
    assert!((ahead - camera.ego_from_camera().rotation * DVec3::Z).length() < 1e-9);
    assert!(ahead.x > 0.99);
    let pinhole = &file["streams"]["CAM_FRONT"]["stream_properties"]["intrinsics_pinhole"];
    assert_eq!(numbers(&pinhole["camera_matrix"])[5], camera.focal_px[1]);
    assert_eq!(file["streams"]["LIDAR_TOP"]["type"], "lidar");
    assert_eq!(file["metadata"]["recipe"]["scene"], "random");
}

#[test]
fn lenses_have_their_coefficients() {
    let mut scene = crate::table_tests::scene();
    let rig = std::sync::Arc::make_mut(&mut scene.rig);
    rig.cameras[0].lens = Lens::Distorted {
        k: [0.1, 0.2, 0.3, 0.4, 0.5, 0.6],
        p: [0.01, 0.02],
    };
    rig.cameras[1].lens = Lens::Fisheye {
        k: [0.1, 0.2, 0.3, 0.4],
        max_angle_deg: 95.0,
    };
    rig.cameras[2].lens = Lens::FTheta {
        c: [1.0, 0.0, 0.1, 0.0, 0.0, 0.0],
        max_angle_deg: 95.0,
    };
    let file = written(&scene);
    let of = |camera: &str| &file["streams"][camera]["stream_properties"];
    let pinhole = &of("CAM_FRONT_LEFT")["intrinsics_pinhole"];
    assert_eq!(
        numbers(&pinhole["distortion_coeffs"]),
        [0.1, 0.2, 0.01, 0.02, 0.3, 0.4, 0.5, 0.6]
    );
    let fisheye = &of("CAM_FRONT")["intrinsics_fisheye"];
    assert_eq!(numbers(&fisheye["lens_coeffs"]), [0.1, 0.2, 0.3, 0.4]);
    assert_eq!(fisheye["width_px"], 1600);
    assert_eq!(of("CAM_FRONT_RIGHT")["intrinsics_custom"]["coefficients"][2], 0.1);
}

#[test]
fn a_scene_that_stands_still_is_one_frame_and_what_is_not_finite_is_refused() {
    let mut scene = crate::table_tests::scene();
    let file = written(&scene);
    assert_eq!(file["frames"].as_object().expect("frames").len(), 1);
    assert_eq!(file["tags"]["2"]["tag_data"]["text"][0]["val"], "fog");
    scene.change_canvas(|c| c.boxes.get_mut(&BoxId(4)).expect("there").yaw_rad = f64::NAN);
    let line = to_bytes(&scene, &mut Plain::of(&scene))
        .expect_err("NaN")
        .to_string();
    assert!(line.contains("yaw_rad"), "{line}");
}
