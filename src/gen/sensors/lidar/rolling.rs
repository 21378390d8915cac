//! A sweep of a scene in which things move: a LiDAR that spins sees each direction at its own time.

use std::sync::Arc;

use glam::DVec2;

use crate::lidar;
use crate::lidar::learned::{self, Drops};
use crate::lidar::shaped::onto_shapes;
use crate::pictures::scenery::SceneryShapes;
use nets::ModelError;
use nets::lidar::LidarNet;
use scene::{LidarSweep, Scene, SceneBox};

/// Parts of a revolution. While one of them is swept, things stand still and the own vehicle drives straight on.
const PARTS: u32 = 8;
/// Distance by which a voxel may stick out of its box, m: one voxel.
const AROUND_M: f64 = scene::Lattice::OCC3D.voxel_m();

/// The exact sweep of a scene's first LiDAR ([`lidar::rig_sweep`]) with returns on the shapes of boxes ([`onto_shapes`]), as
/// [`sweep`] makes it; empty if the rig has none.
pub fn exact(scene: &Scene) -> LidarSweep {
    exact_with(scene, SceneryShapes::of_lidars(scene, None).as_ref())
}

/// The sweep of [`exact`], with the scenery that the scene's LiDARs can reach.
pub fn exact_with(scene: &Scene, scenery: Option<&SceneryShapes>) -> LidarSweep {
    let made: Result<_, std::convert::Infallible> = sweep(scene, |s| {
        let mut sweep = lidar::rig_sweep(&s.frame().occupancy, &s.rig).unwrap_or_default();
        onto_shapes(&mut sweep, s.frame(), &s.rig, s.seed, scenery);
        Ok(sweep)
    });
    made.unwrap_or_default()
}

/// The exact sweep of the voxels alone, without [`onto_shapes`]: the networks of perception learned from it.
pub fn of_voxels(scene: &Scene) -> LidarSweep {
    let whole = |s: &Scene| lidar::rig_sweep(&s.frame().occupancy, &s.rig).unwrap_or_default();
    let made: Result<_, std::convert::Infallible> = sweep(scene, |s| Ok(whole(s)));
    made.unwrap_or_default()
}

/// The learned sweep ([`learned::rig_sweep`]) with echoes on the shapes of boxes, as [`sweep`] makes it; empty if the rig has no
/// LiDAR. Errors if the network cannot compute.
pub fn learned(net: &LidarNet, scene: &Scene, drops: Drops) -> Result<LidarSweep, ModelError> {
    sweep(scene, |s| {
        let mut sweep = learned::rig_sweep(net, &s.frame().occupancy, &s.rig, drops)?;
        onto_shapes(&mut sweep, s.frame(), &s.rig, s.seed, None);
        Ok(sweep)
    })
}

/// True if things or the own vehicle move while the first LiDAR spins.
pub fn is_rolling(scene: &Scene) -> bool {
    let spins = scene.rig.lidars.first().is_some_and(|l| l.spin_hz > 0.0);
    spins && !scene.clip().stands()
}

/// The sweep of a scene's first LiDAR that ends at the moment shown, with the time and the velocity of its points. `whole`
/// makes the sweep of a scene as it stands; the scene's rig is where the ego vehicle is at that moment
/// ([`Scene::with_rig_in_world`]). Before a clip begins everything stands where it is at its start. Errors are those of
/// `whole`.
pub fn sweep<E>(
    scene: &Scene,
    mut whole: impl FnMut(&Scene) -> Result<LidarSweep, E>,
) -> Result<LidarSweep, E> {
    let Some(pattern) = scene.rig.lidars.first() else {
        return whole(scene);
    };
    let mut all = LidarSweep::default();
    if is_rolling(scene) {
        let columns = pattern.columns_in_sector();
        let parts = (0..PARTS).map(|i| [i, i + 1].map(|i| columns * i / PARTS));
        for [from, to] in parts.filter(|[from, to]| from < to) {
            let mut then = at(scene, scene.time_s() - pattern.before_end_s(to));
            if let Some(first) = Arc::make_mut(&mut then.rig).lidars.first_mut() {
                *first = first.part(from, to - from);
            }
            let mut sweep = whole(&then)?;
            tell_velocity(&mut sweep, &then);
            for point in &mut sweep.points {
                point.azimuth += from as u16;
            }
            all.points.append(&mut sweep.points);
            all.rays += sweep.rays;
            all.physical = sweep.physical;
        }
        all.points.sort_by_key(|p| (p.ring, p.azimuth));
    } else {
        all = whole(scene)?;
        tell_velocity(&mut all, scene);
    }
    for point in &mut all.points {
        point.time_s = -pattern.before_end_s(point.azimuth.into()) as f32;
    }
    Ok(all)
}

/// The scene at another moment, its rig on the vehicle there.
fn at(scene: &Scene, time_s: f64) -> Scene {
    let mut then = scene.at(time_s.max(0.0));
    let mut rig = scene.rig.standing_at(&then.frame().world_from_ego);
    if let Some(moving) = then.clip().ego_moving(then.time_s()) {
        rig.ego_speed_mps = moving.velocity_mps.length();
    }
    then.rig = rig.into();
    then
}

/// Gives points on moving boxes the velocity of the box. In a clip everything stands that has no motion of its own, whatever its
/// label says.
fn tell_velocity(sweep: &mut LidarSweep, scene: &Scene) {
    let clip = scene.clip();
    let moves = |b: &SceneBox| clip.stands() || clip.tracks.contains_key(&b.id);
    let moving = |b: &&SceneBox| b.velocity_mps != DVec2::ZERO && moves(b);
    let boxes: Vec<&SceneBox> = scene.frame().boxes.values().filter(moving).collect();
    if boxes.is_empty() {
        return;
    }
    for point in &mut sweep.points {
        if point.class.is_ground() {
            continue;
        }
        let [x, y, _] = point.position_in_ego.map(f64::from);
        if let Some(b) = boxes.iter().find(|b| holds(b, DVec2::new(x, y))) {
            point.velocity_mps = b.velocity_mps.as_vec2().to_array();
        }
    }
}

/// True if a place is in a box, or near enough to belong to its label.
fn holds(b: &SceneBox, at_m: DVec2) -> bool {
    let local = DVec2::from_angle(-b.yaw_rad).rotate(at_m - b.center_m.truncate());
    let reach = b.size_m.truncate() / 2.0 + AROUND_M;
    local.abs().cmple(reach).all()
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeMap;

    use glam::DVec3;

    use super::*;
    use scene::clip::ObjectVoxels;
    use scene::{BevLayout, BoxId, Class, Frame, Key, Motion, SensorRig, Track, VoxelGrid};

    const WALL: usize = 150; // 60 m ahead of the map's middle: x = 20 m

    /// A wall 20 m ahead, and a car between it and us that crosses from right to left at 20 m/s; the ego vehicle drives
    /// at `ego_mps`.
    fn scene(ego_mps: f64, spin_hz: f64) -> Scene {
        let mut grid = VoxelGrid::new();
        for y in 0..200 {
            (0..14).for_each(|z| grid.set(WALL, y, z, Class::Manmade.id()));
        }
        let mut rig = SensorRig::default();
        let lidar = &mut rig.lidars[0];
        (lidar.spin_hz, lidar.own_body, lidar.beyond_grid) = (spin_hz, false, false);
        lidar.translation_m[0] = 0.0;
        rig.lidars.truncate(1);
        let frame = Frame::new(BevLayout::default(), BTreeMap::new(), grid);
        let mut scene = Scene::single("crossing", frame, Arc::new(rig), 1);
        let made = SceneBox {
            id: BoxId(7),
            class: Class::Car,
            center_m: DVec3::new(10.0, 0.0, 0.4),
            size_m: DVec3::new(4.0, 2.0, 2.4),
            yaw_rad: std::f64::consts::FRAC_PI_2,
            velocity_mps: DVec2::ZERO,
            label: Default::default(),
        };
        let mut own = VoxelGrid::new();
        for (x, y, layers) in scene::draft::box_columns(own.extent(), &made) {
            (0..layers).for_each(|z| own.set(x, y, z, Class::Car.id()));
        }
        let key = |time_s: f64, x: f64, y: f64, yaw_deg: f64| Key {
            time_s,
            at_m: DVec2::new(x, y),
            yaw_deg,
        };
        scene.change_clip(|clip| {
            clip.length_s = 2.0;
            let way = vec![key(0.0, 10.0, -20.0, 90.0), key(2.0, 10.0, 20.0, 90.0)];
            let track = Track {
                made,
                motion: Motion::Keys(way),
                there_s: [None; 2],
                voxels: ObjectVoxels::cut(&own, &made, |_, label| label != Class::FREE),
                settled: true,
                own_shape: false,
            };
            clip.tracks.insert(made.id, track);
            if ego_mps > 0.0 {
                clip.ego = Some(Motion::Keys(vec![
                    key(0.0, -ego_mps, 0.0, 0.0),
                    key(2.0, ego_mps, 0.0, 0.0),
                ]));
            }
        });
        scene.at(1.0).with_rig_in_world().into_owned()
    }

    #[test]
    fn a_part_of_a_sweep_is_its_columns() {
        let lidar = &SensorRig::default().lidars[0];
        let part = lidar.part(100, 20);
        assert_eq!(part.columns_in_sector(), 20);
        assert_eq!(part.azimuth_rad(3), lidar.azimuth_rad(103));
        assert_eq!(part.before_end_s(20), 0.0);
    }

    #[test]
    fn what_moves_is_seen_where_it_is_at_the_time_of_its_ray() {
        let scene = scene(0.0, 10.0);
        let sweep = exact(&scene);
        let on_car: Vec<_> = sweep.points.iter().filter(|p| p.class == Class::Car).collect();
        assert!(on_car.len() > 300, "{}", on_car.len());
        let key = |p: &scene::LidarPoint| (p.ring, p.azimuth);
        assert!(sweep.points.windows(2).all(|w| key(&w[0]) < key(&w[1])));
        let part_s = 0.1 / f64::from(PARTS);
        for p in &on_car {
            let then_s = f64::from(p.time_s);
            assert!((-0.1..0.0).contains(&then_s));
            // Within half its length, a voxel and what it drives in a part.
            let off_m = f64::from(p.position_in_ego[1]) - 20.0 * then_s;
            assert!(off_m.abs() < 2.0 + 0.4 + 20.0 * part_s, "{off_m} at {then_s}");
            assert!((p.velocity_mps[1] - 20.0).abs() < 1e-4 && p.velocity_mps[0].abs() < 1e-4);
        }
        // Straight ahead is a part of a turn before the end, so the car is not where it is at the end.
        let middle = on_car
            .iter()
            .map(|p| f64::from(p.position_in_ego[1]))
            .sum::<f64>()
            / on_car.len() as f64;
        let still = exact(&self::scene(0.0, 0.0));
        let at_end: Vec<_> = still.points.iter().filter(|p| p.class == Class::Car).collect();
        let end = at_end
            .iter()
            .map(|p| f64::from(p.position_in_ego[1]))
            .sum::<f64>()
            / at_end.len() as f64;
        assert!((end - middle).abs() > 0.3, "{middle} {end}");
        assert!(still.points.iter().all(|p| p.time_s == 0.0));
    }

    #[test]
    fn walls_stay_where_they_are_while_we_drive() {
        let scene = scene(15.0, 10.0);
        let sweep = exact(&scene);
        let wall: Vec<_> = sweep
            .points
            .iter()
            .filter(|p| p.class == Class::Manmade && p.position_in_ego[1].abs() < 10.0)
            .collect();
        assert!(wall.len() > 500);
        for p in wall {
            assert!((p.position_in_ego[0] - 20.0).abs() < 1e-3, "{p:?}");
            assert_eq!(p.velocity_mps, [0.0; 2]);
        }
    }

    #[test]
    fn the_learned_sweep_of_what_stands_is_the_same_whatever_moves_elsewhere() {
        let net = LidarNet::bundled().expect("the shipped weights");
        let scene = scene(0.0, 0.0);
        // The car is 10 m and more from the rays that end on the left half of the wall, more than the network sees.
        let wall_at = |time_s: f64| {
            let sweep = learned(&net, &scene.at(time_s), Drops::Keep).expect("a sweep");
            let points = sweep.points.into_iter();
            points
                .filter(|p| p.class == Class::Manmade && p.position_in_ego[1] > 0.0)
                .collect::<Vec<_>>()
        };
        let (before, after) = (wall_at(0.0), wall_at(0.4));
        assert!(before.len() > 500, "{}", before.len());
        assert_eq!(before, after);
    }

    #[test]
    fn nothing_moves_and_the_sweep_is_the_plain_one() {
        let mut scene = scene(0.0, 0.0).still();
        scene.rig = Arc::new(SensorRig::default());
        let plain = lidar::rig_sweep(&scene.frame().occupancy, &scene.rig).expect("a LiDAR");
        let told = of_voxels(&scene);
        let bare = |p: &scene::LidarPoint| (p.position_in_ego, p.range_m, p.ring, p.azimuth, p.class);
        assert!(plain.points.iter().map(bare).eq(told.points.iter().map(bare)));
        assert_eq!(plain.rays, told.rays);
        scene.rig = Arc::new(SensorRig {
            lidars: Vec::new(),
            ..SensorRig::default()
        });
        assert!(exact(&scene).points.is_empty());
    }
}
