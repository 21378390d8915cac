//! Requests that are refused.

use tonic::Code::{self, InvalidArgument, NotFound, OutOfRange, Unimplemented};

use crate::fixture::{self, own_picture};
use crate::renderer::{Renderer, ServerLidarModel};
use crate::wire::{
    CameraParam, DynamicObject, ImageFormat, LidarRenderRequest, LidarSpec, PosePair, Quat, RgbRenderRequest,
    Vec3,
};
use crate::{lidar, picture};

/// What the error says, its code, and what makes a good request one that gets it.
type Case<'a> = (&'a str, Code, &'a dyn Fn(&mut RgbRenderRequest));

fn refused(renderer: &Renderer, good: &RgbRenderRequest, cases: &[Case]) {
    for (said, code, change) in cases {
        let mut request = good.clone();
        change(&mut request);
        let error = picture::render(renderer, &request).expect_err(said);
        assert_eq!(error.code(), *code, "{said}: {error}");
        assert!(error.message().contains(said), "{said}: {}", error.message());
        assert!(
            !error.message().contains('\n') && error.message().len() < 300,
            "{error}"
        );
    }
}

/// The pair with its end at another place.
fn ends_at(mut pair: Option<PosePair>, x: f32) -> Option<PosePair> {
    if let Some(pose) = pair.as_mut().and_then(|p| p.end_pose.as_mut()) {
        pose.vec = Some(Vec3 { x, y: 0.0, z: 0.0 });
    }
    pair
}

#[test]
fn bad_requests_are_errors_of_one_line() {
    let folder = tempfile::tempdir().expect("a folder");
    fixture::write(folder.path());
    let renderer = fixture::renderer(folder.path(), ServerLidarModel::Exact);
    let scene = renderer.scenes.get("clip").expect("a scene");
    let good = own_picture("clip", &scene);
    assert!(picture::render(&renderer, &good).is_ok());
    let nan_place = |x: f32| ends_at(good.sensor_pose, x);
    let nan_turn = |w: f32| {
        let mut pair = good.sensor_pose;
        if let Some(pose) = pair.as_mut().and_then(|p| p.start_pose.as_mut()) {
            pose.quat = Some(Quat {
                w,
                x: 0.0,
                y: 0.0,
                z: 0.0,
            });
        }
        pair
    };
    let cases: &[Case] = &[
        ("no scene", NotFound, &|r| r.scene_id = "nowhere\n\"".into()),
        ("0x90", InvalidArgument, &|r| r.resolution_w = 0),
        ("expected at most 16777216", InvalidArgument, &|r| {
            r.resolution_w = u32::MAX
        }),
        ("16777216", InvalidArgument, &|r| {
            (r.resolution_w, r.resolution_h) = (4097, 4096)
        }),
        ("sensor_pose is missing", InvalidArgument, &|r| {
            r.sensor_pose = None
        }),
        ("end_pose.vec", InvalidArgument, &|r| {
            r.sensor_pose = nan_place(f32::NAN)
        }),
        ("end_pose.vec", InvalidArgument, &|r| {
            r.sensor_pose = nan_place(1e30)
        }),
        ("start_pose.quat", InvalidArgument, &|r| {
            r.sensor_pose = nan_turn(f32::NAN)
        }),
        ("start_pose.quat", InvalidArgument, &|r| {
            r.sensor_pose = nan_turn(0.0)
        }),
        ("ego_pose", InvalidArgument, &|r| {
            r.ego_pose = Some(PosePair::default())
        }),
        ("camera_intrinsics is missing", InvalidArgument, &|r| {
            r.camera_intrinsics = None
        }),
        ("no lens", InvalidArgument, &|r| {
            r.camera_intrinsics = Some(Default::default())
        }),
        ("focal_px", InvalidArgument, &|r| {
            let param = r.camera_intrinsics.as_mut().and_then(|s| s.camera_param.as_mut());
            if let Some(CameraParam::Pinhole(p)) = param {
                p.focal_length_x = 0.0;
            }
        }),
        ("not finite", InvalidArgument, &|r| {
            let param = r.camera_intrinsics.as_mut().and_then(|s| s.camera_param.as_mut());
            if let Some(CameraParam::Pinhole(p)) = param {
                p.principal_point_x = f64::NAN;
            }
        }),
        ("shutter_type is 17", InvalidArgument, &|r| {
            if let Some(spec) = &mut r.camera_intrinsics {
                spec.shutter_type = 17;
            }
        }),
        ("an end at most", InvalidArgument, &|r| r.frame_start_us = 7),
        ("an end at most", InvalidArgument, &|r| r.frame_end_us = u64::MAX),
        ("the clip lasts 2 s", OutOfRange, &|r| {
            (r.frame_start_us, r.frame_end_us) = (2_000_001, 2_000_001)
        }),
        ("image_format", InvalidArgument, &|r| r.image_format = 0),
        ("image_format is AV1", Unimplemented, &|r| {
            r.image_format = ImageFormat::Av1.into()
        }),
        ("ego mask", InvalidArgument, &|r| r.insert_ego_mask = true),
    ];
    refused(&renderer, &good, cases);
    let sweep = LidarRenderRequest {
        scene_id: "clip".into(),
        lidar_config: Some(LidarSpec { lidar_type: 9 }),
        ..LidarRenderRequest::default()
    };
    let error = lidar::render(&renderer, &sweep).expect_err("an unknown device");
    assert!(error.message().contains("lidar_type is 9"));
    assert!(picture::render(&renderer, &good).is_ok(), "as before");
}

#[test]
fn objects_that_cannot_be_placed_are_errors_of_one_line() {
    let folder = tempfile::tempdir().expect("a folder");
    fixture::write(folder.path());
    let renderer = fixture::renderer(folder.path(), ServerLidarModel::Exact);
    let scene = renderer.scenes.get("clip").expect("a scene");
    let good = own_picture("clip", &scene);
    let object = |track: &str, pair| DynamicObject {
        track_id: track.into(),
        pose_pair: pair,
    };
    let id = scene.canvas().boxes.keys().next().expect("a box").0.to_string();
    let cases: &[Case] = &[
        ("\"99999\"", InvalidArgument, &|r| {
            r.dynamic_objects = vec![object("99999", good.sensor_pose)]
        }),
        ("\"x\\ny\"", InvalidArgument, &|r| {
            r.dynamic_objects = vec![object("x\ny", good.sensor_pose)]
        }),
        ("twice", InvalidArgument, &|r| {
            r.dynamic_objects = vec![object(&id, good.sensor_pose), object(&id, good.sensor_pose)]
        }),
        ("pose_pair is missing", InvalidArgument, &|r| {
            r.dynamic_objects = vec![object(&id, None)]
        }),
        ("dynamic_objects", InvalidArgument, &|r| {
            r.dynamic_objects = vec![object(&id, ends_at(good.sensor_pose, f32::NAN))]
        }),
        ("expected at most 2000", InvalidArgument, &|r| {
            r.dynamic_objects = vec![object(&id, good.sensor_pose); 2001]
        }),
    ];
    refused(&renderer, &good, cases);
}
