//! From a whole scene to its Gaussians: which places a clip is looked at from.

use super::{BakeInput, BakeOptions, bake, stands};
use scene::{GaussianScene, Pose, Scene};

/// Poses of the vehicle's path that are looked from, at most.
const PATH_POSES: usize = 8;

/// Lifts the moment that a scene shows, whose sensors are in the world ([`Scene::with_rig_in_world`]), to Gaussians in the ego
/// frame of that moment. Of a clip the places from which it is looked at lie around the whole way of the ego vehicle. `go_on` is
/// told how far it is, 0 to 1; `None` once it says no.
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

/// Poses of the ego vehicle midway in time between those of its way from which [`bake_scene`] looks at a clip, in the world;
/// none of a scene that stands still.
pub fn between(scene: &Scene) -> Vec<Pose> {
    let steps = (0..PATH_POSES - 1).map(|i| i as f64 + 0.5);
    steps.filter_map(|step| on_way(scene, step)).collect()
}

/// Where the ego vehicle is now, and over the clip.
fn path(scene: &Scene) -> Vec<Pose> {
    let way = (0..PATH_POSES).filter_map(|i| on_way(scene, i as f64));
    [scene.frame().world_from_ego].into_iter().chain(way).collect()
}

/// The ego vehicle after so many steps of its way; `None` if it stands still.
fn on_way(scene: &Scene, step: f64) -> Option<Pose> {
    let clip = scene.clip();
    clip.ego.as_ref()?;
    let time_s = clip.length_s * step / (PATH_POSES - 1) as f64;
    let relief = &scene.canvas().layout.relief;
    Some(clip.ego_at(time_s, &scene.canvas().world_from_ego, relief))
}
