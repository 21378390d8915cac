use std::collections::BTreeMap;
use std::sync::LazyLock;

use glam::DVec3;

use super::*;
use crate::pictures::appearance::Quality;
use scene::{BoxId, Class, SceneBox, truth};
use world::World;
use world::template;
use world::terrain::Terrain;
use world::voxelize::{Vertical, complete};

/// A straight road with one car, baked with little work.
fn small() -> (Frame, SensorRig, GaussianScene) {
    let layout = template::layout("straight", 1).expect("a template");
    let car = SceneBox {
        id: BoxId(7),
        class: Class::Car,
        center_m: DVec3::new(9.0, 0.0, 0.8),
        size_m: DVec3::new(4.4, 1.9, 1.6),
        yaw_rad: 0.0,
        velocity_mps: Default::default(),
        label: Default::default(),
    };
    let world = World::new(layout, BTreeMap::from([(car.id, car)]), 1);
    let grid = complete(&world, Vertical::Occ3d);
    let frame = Frame::new(world.layout.clone(), world.boxes.clone(), grid);
    let rig = SensorRig::default();
    let baked = bake(&input(&frame, &rig), &OPTIONS, &|_| true).expect("not cancelled");
    (frame, rig, baked)
}

fn input<'a>(frame: &'a Frame, rig: &'a SensorRig) -> BakeInput<'a> {
    static NOTHING: LazyLock<Background> = LazyLock::new(Background::default);
    BakeInput {
        frame,
        rig,
        background: &NOTHING,
        conditions: Conditions::default(),
        path: &[],
    }
}

const OPTIONS: BakeOptions = BakeOptions {
    most: 8000,
    stands: 2,
    reach_m: 6.0,
    size_px: [64, 36],
    steps: 10,
    rounds: 2,
};

#[test]
fn pictures_of_what_was_baked_are_near_the_renderers() {
    let (frame, rig, baked) = small();
    assert!(baked.gaussians.iter().all(SceneGaussian::is_sound));
    assert!(baked.gaussians.len() > 2000 && baked.baking.samples > 10_000);
    let appearance = Appearance::new(&frame, &rig, &Conditions::default());
    for camera in &rig.cameras {
        let there = appearance.render_plain(camera, OPTIONS.size_px, Quality::Full);
        let ours = draw::render(&baked.gaussians, camera, OPTIONS.size_px);
        let off = there.iter().flatten().zip(ours.iter().flatten());
        let square = off.map(|(a, b)| f64::from(a - b).powi(2)).sum::<f64>() / (3 * there.len()) as f64;
        // 20 dB.
        assert!(square < 0.01, "{}: {square}", camera.name);
    }
}

#[test]
fn gaussians_of_a_box_lie_on_it_and_the_sky_far_away() {
    let (frame, _, baked) = small();
    let car = &frame.boxes[&BoxId(7)];
    let (mut on_car, mut of_sky) = (0, 0);
    for g in &baked.gaussians {
        let at = Vec3::from(g.position_m).as_dvec3();
        if g.instance == 7 {
            assert!(
                car.contains(at, 0.5) && g.class == truth::of_class(Class::Car),
                "{g:?}"
            );
            assert!(g.strength > 0.0);
            on_car += 1;
        }
        if g.class == truth::SKY {
            assert!(g.instance == 0 && g.strength == 0.0 && at.length() > 1000.0);
            of_sky += 1;
        }
    }
    assert!(on_car > 50 && of_sky >= 320, "{on_car} {of_sky}");
}

#[test]
fn the_same_on_any_number_of_threads_and_nothing_once_cancelled() {
    let (frame, rig, baked) = small();
    let pool = rayon::ThreadPoolBuilder::new()
        .num_threads(1)
        .build()
        .expect("a thread");
    let again = pool.install(|| bake(&input(&frame, &rig), &OPTIONS, &|_| true));
    assert_eq!(again, Some(baked));
    assert_eq!(bake(&input(&frame, &rig), &OPTIONS, &|_| false), None);
}

#[test]
fn places_are_free_and_apart() {
    let (frame, rig, _) = small();
    let found = stands::stands(&frame, &rig, &[rig.vehicle], 15.0, 8);
    assert!(found.len() > 4, "{}", found.len());
    for (i, pose) in found.iter().enumerate().skip(1) {
        assert!(stands::fits(&frame, &rig, pose));
        let nearest = found[..i]
            .iter()
            .map(|p| p.translation_m.distance(pose.translation_m));
        assert!(nearest.fold(f64::INFINITY, f64::min) >= 0.99);
    }
}

#[test]
fn on_hills_places_are_on_the_ground() {
    let mut layout = template::layout("straight", 1).expect("a template");
    layout.relief = Terrain::Hills.relief(&layout, 3);
    let world = World::new(layout, BTreeMap::new(), 1);
    let frame = Frame::new(
        world.layout.clone(),
        BTreeMap::new(),
        complete(&world, Vertical::Occ3d),
    );
    let rig = SensorRig::default();
    let found = stands::stands(&frame, &rig, &[rig.vehicle], 20.0, 6);
    let heights = found[1..].iter().map(|pose| pose.translation_m.z);
    assert!(heights.fold(0.0f64, |a, z| a.max(z.abs())) > 0.05);
    for pose in &found[1..] {
        let ground_m = frame.layout.relief.height_m(pose.translation_m.truncate());
        assert!((pose.translation_m.z - ground_m).abs() < 1e-6);
    }
}
