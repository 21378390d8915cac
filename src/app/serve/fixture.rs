//! Scenes and requests for tests.

use std::path::Path;
use std::sync::Arc;

use crate::lens::spec_of;
use crate::poses;
use crate::renderer::{Renderer, ServerLidarModel};
use crate::wire::{ImageFormat, PosePair, RgbRenderRequest};
use editor::{Apply, Edit};
use scene::{Class, Frame, Pose, Scene, SensorRig, Template, draft};
use sensors::pictures::appearance::Quality;
use world::{template, traffic};

/// A junction where nothing moves.
pub fn still() -> Scene {
    let layout = template::layout("t-junction", 4).expect("a template");
    let boxes = traffic::place(&layout, 4, &traffic::TrafficSpec::NORMAL);
    let occupancy = draft::draft(&layout, boxes.values());
    let frame = Frame::new(layout, boxes, occupancy);
    Scene::single("junction", frame, Arc::new(SensorRig::default()), 4)
}

/// The junction of [`still`], where the own vehicle and a car drive for two seconds.
pub fn clip() -> Scene {
    let mut scene = still();
    let car = *scene
        .frame()
        .boxes
        .values()
        .find(|b| b.class == Class::Car)
        .expect("a car");
    let length = Edit::SetLength {
        length_s: 2.0,
        rate_hz: None,
    };
    let drive = |id| Edit::LetMove {
        id,
        template: Template::Drive,
        mps: Some(6.0),
        from_s: None,
        gap_m: None,
    };
    for edit in [length, drive(None), drive(Some(car.id))] {
        edit.apply(&mut scene).expect("an edit");
    }
    scene
}

/// Writes both as `still.loom` and `clip.loom`.
pub fn write(folder: &Path) {
    for (name, scene) in [("still", still()), ("clip", clip())] {
        formats::loom::save(&folder.join(format!("{name}.loom")), &scene).expect("saved");
    }
}

/// A renderer of a folder.
pub fn renderer(folder: &Path, lidar: ServerLidarModel) -> Renderer {
    Renderer::new(&[folder.to_owned()], 2, 2, (lidar, Quality::Full)).expect("scenes")
}

/// One pose for a whole frame.
pub fn held(pose: &Pose) -> Option<PosePair> {
    Some(PosePair {
        start_pose: Some(poses::write(pose)),
        end_pose: Some(poses::write(pose)),
    })
}

/// A small picture of the second camera of a scene's rig where the scene has it, at its first moment.
pub fn own_picture(id: &str, scene: &Scene) -> RgbRenderRequest {
    let camera = &scene.rig.cameras[1];
    let vehicle = scene.at(0.0).frame().world_from_ego;
    RgbRenderRequest {
        scene_id: id.into(),
        resolution_w: 160,
        resolution_h: 90,
        camera_intrinsics: Some(spec_of(camera)),
        frame_end_us: 1,
        sensor_pose: held(&(vehicle * camera.ego_from_camera())),
        image_format: ImageFormat::Png.into(),
        ..RgbRenderRequest::default()
    }
}
