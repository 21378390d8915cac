use std::collections::BTreeSet;

use super::messages::{Grid, VoxelGrid};
use super::*;
use crate::clip_tests::{Plain, clip_scene};
use scene::{BevLayer, BoxId, Class, Extent};

/// Messages of the file by topic: log time and bytes.
type Messages = BTreeMap<String, Vec<(u64, Vec<u8>)>>;

fn written(scene: &Scene) -> (Vec<u8>, Messages) {
    let bytes = to_bytes(scene, &mut Plain::of(scene)).expect("written");
    let mut out = Messages::new();
    for message in mcap::MessageStream::new(&bytes).expect("an MCAP file") {
        let message = message.expect("whole");
        let schema = message.channel.schema.as_ref().expect("a schema");
        assert!(
            schema.encoding == "protobuf" && *schema.data == *DESCRIPTORS,
            "{}",
            schema.name
        );
        let list = out.entry(message.channel.topic.clone()).or_default();
        list.push((message.log_time, message.data.to_vec()));
    }
    (bytes, out)
}

fn decode<M: Message + Default>(messages: &Messages, topic: &str, at: usize) -> M {
    M::decode(&*messages[topic][at].1).expect(topic)
}

#[test]
fn every_topic_is_there_at_every_moment() {
    let mut scene = clip_scene(3);
    scene.change_clip(|clip| clip.rate_hz = 4.0);
    let (bytes, messages) = written(&scene);
    let topics: Vec<&str> = messages.keys().map(String::as_str).collect();
    assert_eq!(topics.len(), 7 + 2 * 6 + 5, "{topics:?}");
    for (topic, list) in &messages {
        let once = ["/drivable_area", "/semantic_map"].contains(&topic.as_str());
        let times: Vec<u64> = list.iter().map(|(time_ns, _)| *time_ns).collect();
        let expected: Vec<u64> = (0..9).map(|i| i * 250_000_000).collect();
        assert_eq!(times, if once { vec![0] } else { expected }, "{topic}");
    }
    assert!(topics.contains(&"/cam_front_left/image_rect_compressed"));
    // A car straight ahead of each radar, 12 m away: see [`Plain`].
    let cloud: PointCloud = decode(&messages, "/radar_front_left/points", 0);
    let number = |i: usize| f32::from_le_bytes(cloud.data[4 * i..][..4].try_into().expect("four"));
    assert_eq!(
        (cloud.frame_id.as_str(), cloud.data.len()),
        ("RADAR_FRONT_LEFT", 29)
    );
    assert!((number(0) - 12.0).abs() < 1e-4 && number(1).abs() < 1e-4);
    assert_eq!([number(3), number(5)], [-2.0, 10.0]);
    assert_eq!(bytes, written(&scene).0, "equal scenes give equal bytes");
}

#[test]
fn boxes_vehicle_and_sensors_are_where_they_are() {
    let scene = clip_scene(5);
    let (_, messages) = written(&scene);
    for at in [0, 9, 20] {
        let now = scene.at(f64::from(at as u32) / 10.0);
        let update: SceneUpdate = decode(&messages, "/markers/annotations", at);
        assert_eq!(update.deletions[0].r#type, 1);
        assert_eq!(update.entities.len(), now.frame().boxes.len());
        for (entity, b) in update.entities.iter().zip(now.frame().boxes.values()) {
            let cube = entity.cubes[0];
            assert_eq!(entity.id, format!("box {}", b.id.0));
            assert_eq!(cube.size, Some(b.size_m.into()));
            let pose = cube.pose.expect("a pose");
            assert_eq!(pose.position, Some(b.center_m.into()));
            let q = pose.orientation.expect("a rotation");
            assert_eq!((q.x, q.y), (0.0, 0.0));
            assert!((2.0 * q.z.atan2(q.w) - b.yaw_rad).sin().abs() < 1e-9);
        }
        let tf: FrameTransforms = decode(&messages, "/tf", at);
        let frames: Vec<(&str, &str)> = tf
            .transforms
            .iter()
            .map(|t| (t.parent_frame_id.as_str(), t.child_frame_id.as_str()))
            .collect();
        assert_eq!((frames[0], frames.len()), (("map", "base_link"), 13));
        assert_eq!(frames[7], ("base_link", "LIDAR_TOP"));
        assert_eq!(frames[8], ("base_link", "RADAR_FRONT"));
        let ego = now.frame().world_from_ego;
        assert_eq!(tf.transforms[0].translation, Some(ego.translation_m.into()));
        let pose: PoseInFrame = decode(&messages, "/pose", at);
        assert_eq!(pose.pose, Some(ego.into()));
    }
    let last = messages["/markers/annotations"].len() - 1;
    let update: SceneUpdate = decode(&messages, "/markers/annotations", last);
    let ids: BTreeSet<&str> = update.entities.iter().map(|e| e.id.as_str()).collect();
    assert!(
        !ids.contains("box 4") && ids.contains("box 2"),
        "one came and one left: {ids:?}"
    );
}

#[test]
fn points_stand_on_the_ground_and_pictures_have_their_calibration() {
    let scene = clip_scene(6);
    let (_, messages) = written(&scene);
    let cloud: PointCloud = decode(&messages, "/lidar_top", 0);
    let pose = scene.rig.lidars[0].ego_from_sensor();
    let mut ground = 0;
    for point in cloud.data.chunks_exact(cloud.point_stride as usize) {
        let [x, y, z] = [0, 4, 8].map(|i| {
            f64::from(f32::from_le_bytes(
                point[i..i + 4].try_into().expect("four bytes"),
            ))
        });
        let in_ego = pose.apply(DVec3::new(x, y, z));
        if Class::from_id(point[18]).is_some_and(Class::is_ground) {
            ground += 1;
            assert!(in_ego.z.abs() < 1e-3, "{in_ego}");
        }
    }
    assert!(ground > 100, "{ground}");
    assert_eq!(
        cloud.fields.last().map(|f| (f.name.as_str(), f.offset)),
        Some(("class", 18))
    );
    let info: CameraCalibration = decode(&messages, "/cam_front/camera_info", 0);
    let camera = scene.rig.cameras[1].resized(32, 18);
    assert_eq!(
        (info.width, info.height, info.frame_id.as_str()),
        (32, 18, "CAM_FRONT")
    );
    assert_eq!(info.intrinsic[0], camera.focal_px[0]);
    assert_eq!(info.projection[6], camera.center_px[1]);
    let image: CompressedImage = decode(&messages, "/cam_front/image_rect_compressed", 0);
    let picture = image::load_from_memory(&image.data).expect("a JPEG");
    assert_eq!((picture.width(), image.format.as_str()), (32, "jpeg"));
}

#[test]
fn lenses_have_their_coefficients_in_the_order_of_opencv() {
    let mut scene = crate::table_tests::scene();
    let rig = std::sync::Arc::make_mut(&mut scene.rig);
    let p = [0.01, 0.02];
    rig.cameras[0].lens = Lens::Distorted {
        k: [0.1, 0.2, 0.3, 0.0, 0.0, 0.0],
        p,
    };
    rig.cameras[1].lens = Lens::Distorted {
        k: [0.1, 0.2, 0.3, 0.4, 0.5, 0.6],
        p,
    };
    rig.cameras[2].lens = Lens::Fisheye {
        k: [0.1, 0.2, 0.3, 0.4],
        max_angle_deg: 95.0,
    };
    let (_, messages) = written(&scene);
    let of = |camera: &str| -> (String, Vec<f64>) {
        let info: CameraCalibration = decode(&messages, &format!("/{camera}/camera_info"), 0);
        (info.distortion_model, info.distortion)
    };
    assert_eq!(
        of("cam_front_left"),
        ("plumb_bob".into(), vec![0.1, 0.2, 0.01, 0.02, 0.3])
    );
    let all = vec![0.1, 0.2, 0.01, 0.02, 0.3, 0.4, 0.5, 0.6];
    assert_eq!(of("cam_front"), ("rational_polynomial".into(), all));
    assert_eq!(
        of("cam_front_right"),
        ("kannala_brandt".into(), vec![0.1, 0.2, 0.3, 0.4])
    );
    assert_eq!(of("cam_back"), (String::new(), Vec::new()));
    assert!(messages.contains_key("/cam_front/image_compressed"));
    assert!(messages.contains_key("/cam_back/image_rect_compressed"));
}

#[test]
fn grids_have_x_along_columns_and_z_along_slices() {
    let scene = clip_scene(7);
    let (_, messages) = written(&scene);
    let layout = &scene.canvas().layout;
    let grid: Grid = decode(&messages, "/drivable_area", 0);
    let bytes = |x: usize, y: usize| grid.data[y * grid.row_stride as usize + x * grid.cell_stride as usize];
    for [x, y] in Extent::WINDOW.all_columns() {
        assert_eq!(bytes(x, y) == 1, layout.has(BevLayer::DrivableArea, x, y));
    }
    // The voxels turn with the vehicle; at the start it is at the origin.
    let grid: VoxelGrid = decode(&messages, "/occupancy", 0);
    let [sx, sy, sz] = [grid.cell_stride, grid.row_stride, grid.slice_stride].map(|n| n as usize);
    let frame = scene.frame();
    for (x, y, z, label) in frame.occupancy.iter_set() {
        let at = z * sz + y * sy + x * sx;
        assert_eq!(&grid.data[at + 3..at + 5], &[255, label]);
    }
    let set = grid.data.chunks_exact(5).filter(|cell| cell[3] != 0).count();
    assert_eq!(set, frame.occupancy.count_set());
    let corner = grid.pose.and_then(|p| p.position).expect("a corner");
    assert_eq!((corner.x, corner.y, corner.z), (-40.0, -40.0, -1.0));
}

#[test]
fn what_cannot_be_written_is_one_line_and_what_lacks_sensors_is_written() {
    let mut scene = crate::table_tests::scene();
    let rig = std::sync::Arc::make_mut(&mut scene.rig);
    rig.cameras.clear();
    rig.lidars.clear();
    rig.radars.clear();
    assert_eq!(written(&scene).1.len(), 6);
    scene.change_canvas(|c| c.boxes.get_mut(&BoxId(4)).expect("there").center_m.x = f64::INFINITY);
    let line = to_bytes(&scene, &mut Plain::of(&scene))
        .expect_err("not finite")
        .to_string();
    assert!(line.contains("center_m"), "{line}");
}
