//! The ego vehicle as a body on the road: its origin is the rear axle, not its middle, and gaps count from its bumpers.

use scene::{BoxId, Class, Clip, Frame, Moving, Scene, SceneBox, SensorRig};

/// The ego vehicle as a box at a time of the clip, world frame; its standing place if it does not move. The box's id
/// has no meaning.
pub(crate) fn ego_box(scene: &Scene, time_s: f64) -> SceneBox {
    ego_box_of(scene.clip(), scene.canvas(), &scene.rig, time_s)
}

/// Like [`ego_box`], from the parts of a scene.
pub(crate) fn ego_box_of(clip: &Clip, canvas: &Frame, rig: &SensorRig, time_s: f64) -> SceneBox {
    let pose = clip.ego_at(time_s, &canvas.world_from_ego, &canvas.layout.relief);
    let ahead = (pose.rotation * glam::DVec3::X).truncate();
    let moving = clip
        .ego_moving(time_s)
        .unwrap_or_else(|| Moving::still(pose.translation_m.truncate(), ahead.to_angle()));
    SceneBox {
        id: BoxId(0),
        class: Class::Car,
        center_m: pose.apply(rig.ego_center_m.into()),
        size_m: rig.ego_size_m.into(),
        yaw_rad: moving.yaw_rad,
        velocity_mps: moving.velocity_mps,
        label: Default::default(),
    }
}
