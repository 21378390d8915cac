//! Baking of a whole scene: the places from which a clip is looked at.

use super::{BakeInput, BakeOptions, bake, stands};
use scene::{GaussianScene, Pose, Scene};

/// Most poses of the vehicle's path from which a clip is looked at.
const PATH_POSES: usize = 8;

/// Lifts the moment that a scene shows, whose sensors are in the world ([`Scene::with_rig_in_world`]), to Gaussians in
/// the ego frame of that moment. The places from which a clip is looked at lie around the whole path of the ego
/// vehicle. `go_on` gets the progress, 0 to 1; returns `None` once `go_on` returns false.
pub fn bake_scene(
    scene: &Scene,
    options: &BakeOptions,
    go_on: &(dyn Fn(f32) -> bool + Sync),
) -> Option<GaussianScene> {
    let input = BakeInput {
        frame: scene.frame(),
        rig: &scene.rig,
        background: &scene.background,
        conditions: scene.conditions,
        path: &path(scene),
    };
    let mut baked = bake(&input, options, go_on)?;
    baked.place(&scene.frame().world_from_ego.inverse());
    Some(baked)
}

/// The places from which [`bake_scene`] looks at a scene, in the world.
pub fn places(scene: &Scene, options: &BakeOptions) -> Vec<Pose> {
    stands::stands(
        scene.frame(),
        &scene.rig,
        &path(scene),
        options.reach_m,
        options.stands,
    )
}

/// Poses of the ego vehicle, in the world, midway in time between those from which [`bake_scene`] looks at a clip; none
/// for a scene that stands still.
pub fn between(scene: &Scene) -> Vec<Pose> {
    let steps = (0..PATH_POSES - 1).map(|i| i as f64 + 0.5);
    steps.filter_map(|step| on_way(scene, step)).collect()
}

/// Poses of the ego vehicle now and over the clip.
fn path(scene: &Scene) -> Vec<Pose> {
    let way = (0..PATH_POSES).filter_map(|i| on_way(scene, i as f64));
    [scene.frame().world_from_ego].into_iter().chain(way).collect()
}

/// Pose of the ego vehicle after `step` steps of its path; `None` if it stands still.
fn on_way(scene: &Scene, step: f64) -> Option<Pose> {
    let clip = scene.clip();
    clip.ego.as_ref()?;
    let time_s = clip.length_s * step / (PATH_POSES - 1) as f64;
    let relief = &scene.canvas().layout.relief;
    Some(clip.ego_at(time_s, &scene.canvas().world_from_ego, relief))
}
