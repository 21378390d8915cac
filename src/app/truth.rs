//! Camera pictures with their ground truth, for the command line, the export and data sets.

use anyhow::bail;

use scene::{CameraTruth, Pose, Scene};
use sensors::cameras::{CameraInput, bounds};
use sensors::pictures::appearance::{Appearance, CameraImage, NextMoment, Quality};

/// Memory of a picture with its ground truth, bytes per pixel.
pub const BYTES_PER_PIXEL: u64 = 160;

/// Renders each camera of a scene with its ground truth, in the rig's order, and hands both on before the next is made.
/// The scene's sensors are in the world ([`Scene::with_rig_in_world`]); `input` is the scene for camera sources. Flow
/// leads to the clip's next frame, if there is one. Errors if there is no camera, if the pictures are too large, or if
/// `take` fails.
pub fn each_camera(
    scene: &Scene,
    input: &CameraInput<'_>,
    size: [u32; 2],
    quality: Quality,
    mut take: impl FnMut(CameraImage, CameraTruth) -> anyhow::Result<()>,
) -> anyhow::Result<()> {
    if scene.rig.cameras.is_empty() {
        bail!("the rig {:?} has no camera", scene.rig.name);
    }
    bounds::check(size, BYTES_PER_PIXEL, 0)?;
    let appearance = Appearance::with_things(input.frame, input.background, input.rig, &input.conditions);
    let later = next_frame(scene);
    for (i, camera) in scene.rig.cameras.iter().enumerate() {
        let next = later.as_ref().map(|later| NextMoment {
            camera: later.rig.cameras[i].clone(),
            boxes: &later.frame().boxes,
            after_s: later.time_s() - scene.time_s(),
        });
        let (image, truth) =
            appearance.render_truth(camera, size, quality, &input.frame.boxes, next.as_ref());
        take(image, truth)?;
    }
    Ok(())
}

/// The scene at the clip's next frame, with the sensors on the vehicle there; `None` at the end, or if the scene does
/// not move.
fn next_frame(scene: &Scene) -> Option<Scene> {
    let clip = scene.clip();
    let time_s = scene.time_s() + 1.0 / clip.rate_hz;
    if clip.stands() || time_s > clip.length_s + 1e-9 {
        return None;
    }
    let mut later = scene.at(time_s);
    later.rig = scene.rig.standing_at(&later.frame().world_from_ego).into();
    Some(later)
}

/// Transforms the ground truth, camera and boxes, into another frame than that of the sensors' poses.
pub fn place(truth: &mut CameraTruth, outer_from_inner: &Pose) {
    let pose = *outer_from_inner * truth.camera.ego_from_camera();
    let q = pose.rotation;
    truth.camera.rotation_wxyz = [q.w, q.x, q.y, q.z];
    truth.camera.translation_m = pose.translation_m.to_array();
    for seen in &mut truth.boxes {
        seen.of = seen.of.in_frame(outer_from_inner);
    }
}
