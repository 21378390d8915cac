//! Answers about the server: its version, the scenes, their cameras and the trajectory of their vehicle.

use tonic::Status;

use crate::lens;
use crate::poses;
use crate::renderer::Renderer;
use crate::wire::{
    ApiVersion, AvailableCamera, AvailableCamerasRequest, AvailableCamerasReturn, AvailableEgoMasksReturn,
    AvailableScenesReturn, AvailableTrajectoriesRequest, AvailableTrajectoriesReturn, AvailableTrajectory,
    Empty, PoseAtTime, Trajectory, VersionId,
};

/// Version of AlpaSim's messages that are followed.
pub const API_VERSION: ApiVersion = ApiVersion {
    major: 0,
    minor: 54,
    patch: 0,
};

/// The program's version. Never an error.
pub fn version(_: &Renderer, _: &Empty) -> Result<VersionId, Status> {
    Ok(VersionId {
        version_id: format!("sceneloom {}", env!("CARGO_PKG_VERSION")),
        git_hash: String::new(),
        grpc_api_version: Some(API_VERSION),
    })
}

/// The scenes. Never an error.
pub fn scenes(renderer: &Renderer, _: &Empty) -> Result<AvailableScenesReturn, Status> {
    Ok(AvailableScenesReturn {
        scene_ids: renderer.scenes.ids(),
    })
}

/// The masks of the own vehicle: there are none. Never an error.
pub fn ego_masks(_: &Renderer, _: &Empty) -> Result<AvailableEgoMasksReturn, Status> {
    Ok(AvailableEgoMasksReturn::default())
}

/// The cameras of a scene's rig. Errors if there is no such scene.
pub fn cameras(
    renderer: &Renderer,
    request: &AvailableCamerasRequest,
) -> Result<AvailableCamerasReturn, Status> {
    let scene = renderer.scenes.get(&request.scene_id)?;
    let one = |camera: &scene::Camera| AvailableCamera {
        intrinsics: Some(lens::spec_of(camera)),
        rig_to_camera: Some(poses::write(&camera.ego_from_camera())),
        logical_id: camera.name.clone(),
    };
    Ok(AvailableCamerasReturn {
        available_cameras: scene.rig.cameras.iter().map(one).collect(),
    })
}

/// The trajectory of a scene's vehicle, one pose per frame of the clip; a single one if the scene stands still. Errors
/// if there is no such scene.
pub fn trajectories(
    renderer: &Renderer,
    request: &AvailableTrajectoriesRequest,
) -> Result<AvailableTrajectoriesReturn, Status> {
    let scene = renderer.scenes.get(&request.scene_id)?;
    let (clip, canvas) = (scene.clip(), scene.canvas());
    let at = |frame: usize| {
        let time_s = clip.time_of(frame);
        let pose = clip.ego_at(time_s, &canvas.world_from_ego, &canvas.layout.relief);
        PoseAtTime {
            pose: Some(poses::write(&pose)),
            timestamp_us: (time_s * 1e6).round() as u64,
        }
    };
    let frames = if clip.length_s > 0.0 { clip.frames() } else { 1 };
    let trajectory = Trajectory {
        poses: (0..frames).map(at).collect(),
    };
    Ok(AvailableTrajectoriesReturn {
        available_trajectories: vec![AvailableTrajectory {
            trajectory: Some(trajectory),
        }],
    })
}
