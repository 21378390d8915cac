//! Time of the learned sweep (34,688 rays) on a complete world: the field, the rays, and after a car came or went.
//! Run: `cargo bench --bench lidar`.

use nets::lidar::LidarNet;
use nets::lidar::field::RaySampling;
use scene::{Class, SensorRig};
use sensors::lidar::learned;
use sensors::lidar::learned_caster::LearnedCaster;
use sensors::lidar::truth;
use world::World;
use world::voxelize::{Vertical, complete};

#[path = "timing.rs"]
mod timing;

fn main() {
    let net = LidarNet::bundled().expect("the shipped weights");
    let rig = SensorRig::default();
    for seed in [3, 11] {
        let world = World::random(seed);
        timing::time("true sweep of the world", 15, || {
            truth::sweep(&world, &rig.lidars[0], seed).len()
        });
        let grid = complete(&world, Vertical::Occ3d);
        let field = net.field(&grid).expect("a finite field");
        println!("world {seed}: {} voxels", field.keys.len());
        timing::time("field", 15, || net.field(&grid).map_or(0, |f| f.keys.len()));
        let rays = learned::rays(&rig.lidars[0], glam::DVec3::ZERO);
        timing::time("rays", 15, || {
            let answers = net.shoot(&field, &rays, RaySampling::Prior);
            let answers = answers.expect("the processor never fails");
            answers.iter().filter(|a| a.is_hit()).count()
        });
        let mut with_car = grid.clone();
        for (x, y, z) in (118..130).flat_map(|x| (106..111).flat_map(move |y| (1..6).map(move |z| (x, y, z))))
        {
            let free = grid.get(x, y, z) == Class::FREE;
            with_car.set(x, y, z, if free { Class::Car.id() } else { Class::FREE });
        }
        let kept = LearnedCaster::of_rig(net.clone(), &grid, &rig).expect("a finite field");
        let mut kept = kept.expect("the rig has a LiDAR");
        let mut there = false;
        timing::time("kept sweep after a car came or went", 30, || {
            there = !there;
            kept.update(if there { &with_car } else { &grid })
                .expect("a finite field");
            usize::from(kept.shot_last() > 0)
        });
        println!("{} rays shot again", kept.shot_last());
    }
}
