//! Returns on scenery.

use glam::{DVec2, DVec3};

use crate::lidar::{rig_sweep, rolling};
use crate::pictures::scenery::SceneryShapes;
use scene::background::{Building, LineKind, SceneryLine};
use scene::{Background, BevLayout, Class, Form, Frame, LidarPoint, LidarSweep, Scene, SensorRig, VoxelGrid};

/// A scene with a house aslant and a wall.
fn scene() -> Scene {
    let mut background = Background::default();
    let along = DVec2::from_angle(0.35);
    let house = Building::rectangle(DVec2::new(14.0, 6.0), DVec2::new(6.0, 4.0), along, 9.0);
    background.add(Form::Building(house));
    let points_m = vec![DVec2::new(-8.0, -6.0), DVec2::new(6.0, -8.0)];
    background.add(Form::Line(SceneryLine::typical(LineKind::Wall, points_m)));
    let (layout, mut grid) = (BevLayout::default(), VoxelGrid::new());
    for [x, y] in grid.extent().all_columns() {
        grid.set(x, y, 0, Class::Terrain.id());
    }
    for thing in background.iter() {
        for ([x, y], labels) in thing.columns(&layout) {
            for (z, label) in labels.into_iter().enumerate().filter(|(_, l)| *l != Class::FREE) {
                grid.set(x, y, z, label);
            }
        }
    }
    let frame = Frame::new(layout, Default::default(), grid);
    let mut scene = Scene::single("street", frame, std::sync::Arc::new(SensorRig::default()), 1);
    scene.background = std::sync::Arc::new(background);
    scene
}

/// Distance of a point from the solids' surfaces along its ray, m, for points above the ground.
fn off_m(scene: &Scene, sweep: &LidarSweep) -> Vec<f64> {
    let mut solids = Vec::new();
    let things = scene.background.iter();
    things.for_each(|t| t.solids(&|_| 0.0, &mut solids));
    let from = scene.rig.lidars[0].ego_from_sensor().translation_m;
    let off = |point: &LidarPoint| {
        let p = DVec3::from_array(point.position_in_ego.map(f64::from));
        let way = (p - from).normalize();
        let met = solids.iter().filter_map(|s| s.enter(from, way, 100.0));
        let exact = met.min_by(f64::total_cmp)?;
        (p.z > 0.05 && point.class == Class::Manmade).then(|| (exact - (p - from).length()).abs())
    };
    let mut all: Vec<f64> = sweep.points.iter().filter_map(off).collect();
    all.sort_by(f64::total_cmp);
    all
}

#[test]
fn returns_lie_on_the_walls_and_not_on_their_voxels() {
    let scene = scene();
    let voxels = rig_sweep(&scene.frame().occupancy, &scene.rig).expect("a LiDAR");
    let (voxels, exact) = (off_m(&scene, &voxels), off_m(&scene, &rolling::exact(&scene)));
    assert!(exact.len() > 500, "{} returns", exact.len());
    let at = |all: &[f64], share: f64| all[(all.len() as f64 * share) as usize];
    assert!(at(&voxels, 0.5) > 0.05, "{} m", at(&voxels, 0.5));
    assert!(at(&exact, 0.99) < 0.002, "{} m", at(&exact, 0.99));
    // Without its things a scene is swept as its voxels are.
    let mut unknown = scene.clone();
    unknown.background = Default::default();
    assert!(SceneryShapes::of_lidars(&unknown, None).is_none());
    assert_eq!(
        rolling::exact(&unknown).points,
        rig_sweep(&scene.frame().occupancy, &scene.rig)
            .expect("a LiDAR")
            .points
    );
}
