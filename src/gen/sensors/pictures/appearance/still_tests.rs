//! Frames prepared with a cache look as without one, whatever changed, and share what did not.

use std::sync::Arc;

use glam::DVec2;

use super::*;
use scene::background::{Building, Roof};
use scene::{Background, BevLayer, Class, Form, Frame, SceneBox, SensorRig};
use world::World;
use world::voxelize::{Vertical, complete};

const SIZE: [u32; 2] = [64, 36];

/// A street with a house ahead, which is in its voxels.
fn street() -> (Frame, Background) {
    let world = World::random(5);
    let mut grid = complete(&world, Vertical::Occ3d);
    let house = Building {
        roof: Roof::Gabled,
        ..Building::rectangle(DVec2::new(22.0, 6.0), DVec2::new(5.0, 4.0), DVec2::Y, 9.0)
    };
    let mut things = Background::default();
    things.add(Form::Building(house));
    let thing = things.iter().next().expect("the house");
    for ([x, y], labels) in thing.columns(&world.layout) {
        for (z, label) in labels.into_iter().enumerate().filter(|(_, l)| *l != Class::FREE) {
            grid.set(x, y, z, label);
        }
    }
    let frame = Frame::new(world.layout.clone(), world.boxes.clone(), grid);
    (frame, things)
}

fn fresh(frame: &Frame, background: &Background) -> Appearance {
    Appearance::with_things(frame, background, &SensorRig::default(), &Conditions::default())
}

fn cached(frame: &Frame, background: &Background, cache: &AppearanceCache) -> Appearance {
    let (rig, conditions) = (SensorRig::default(), Conditions::default());
    Appearance::with_cache(frame, background, &rig, &conditions, cache)
}

/// Pictures of two cameras.
fn pictures(appearance: &Appearance) -> Vec<CameraImage> {
    let cameras = SensorRig::default().cameras.into_iter().take(2);
    let draw = |c| appearance.render(&c, SIZE[0], SIZE[1], Quality::Preview);
    cameras.map(draw).collect()
}

fn moved(frame: &Frame, by_m: f64) -> Frame {
    let mut frame = frame.clone();
    let boxes = frame.boxes.values().map(|b| SceneBox {
        center_m: b.center_m + glam::DVec3::X * by_m,
        ..*b
    });
    frame.boxes = boxes.map(|b| (b.id, b)).collect();
    frame
}

#[test]
fn frames_look_the_same_with_a_cache() {
    let (frame, background) = street();
    let cache = AppearanceCache::default();
    let mut cut = frame.clone();
    for [x, y] in frame
        .extent()
        .all_columns()
        .filter(|[x, y]| x % 3 == 0 && (98..120).contains(y))
    {
        (5..9).for_each(|z| cut.occupancy.set(x, y, z, Class::FREE));
    }
    let mut hole = frame.clone();
    for [x, y] in frame
        .extent()
        .all_columns()
        .filter(|[x, y]| (149..155).contains(x) && (112..118).contains(y))
    {
        (4..9).for_each(|z| {
            hole.occupancy.set(x, y, z, Class::FREE);
            hole.painted.set(x, y, z, Class::FREE);
        });
    }
    let mut paved = frame.clone();
    for [x, y] in frame
        .extent()
        .all_columns()
        .filter(|[x, _]| (120..130).contains(x))
    {
        paved.layout.set(BevLayer::Walkway, x, y, true);
    }
    let mut taller = background.clone();
    taller = taller
        .iter()
        .cloned()
        .map(|mut t| {
            t.look += 1;
            t
        })
        .collect();
    let frames = [
        (&frame, &background),
        (&moved(&frame, 3.0), &background),
        (&hole, &background),
        (&moved(&hole, 1.0), &background),
        (&cut, &background),
        (&frame, &taller),
        (&paved, &taller),
        (&moved(&cut, -2.0), &Background::default()),
        (&frame, &background),
    ];
    let mut all = Vec::new();
    for (i, (frame, background)) in frames.into_iter().enumerate() {
        let with = pictures(&cached(frame, background, &cache));
        assert_eq!(with, pictures(&fresh(frame, background)), "frame {i}");
        all.push(with);
    }
    // They are not all of the same.
    assert!(all.windows(2).all(|pair| pair[0] != pair[1]));
}

#[test]
fn what_stands_is_prepared_once_while_boxes_move() {
    let (mut frame, background) = street();
    let cache = AppearanceCache::default();
    // Nothing in the voxels moves with the boxes.
    for [x, y] in frame.extent().all_columns() {
        for z in 0..frame.extent().nz() {
            if Class::from_id(frame.occupancy.get(x, y, z)).is_some_and(Class::is_object) {
                frame.occupancy.set(x, y, z, Class::FREE);
            }
        }
    }
    let first = cached(&frame, &background, &cache);
    let second = cached(&moved(&frame, 1.5), &background, &cache);
    assert!(Arc::ptr_eq(&first.field, &second.field) && Arc::ptr_eq(&first.ground, &second.ground));
    assert!(Arc::ptr_eq(&first.paint, &second.paint));
    frame.occupancy.set(150, 40, 8, Class::Manmade.id());
    let third = cached(&frame, &background, &cache);
    assert!(!Arc::ptr_eq(&second.field, &third.field) && Arc::ptr_eq(&second.ground, &third.ground));
}

/// A picture of half of the samples: those are as ever, the others are near them or samples too.
#[test]
fn pictures_that_play_keep_every_second_pixel_and_all_edges() {
    let (frame, background) = street();
    let appearance = fresh(&frame, &background);
    let [w, h] = [120, 68];
    for camera in &SensorRig::default().cameras[..3] {
        let whole = appearance.render_plain(camera, [w, h], Quality::Preview);
        let played = appearance.render_plain(camera, [w, h], Quality::Play);
        let (mut mean, mut far, mut taken) = (0.0, 0, 0);
        for (i, (a, b)) in whole.iter().zip(&played).enumerate() {
            let (x, y) = (i % w as usize, i / w as usize);
            let off = (0..3).map(|k| (a[k] - b[k]).abs()).fold(0.0, f32::max);
            match sparse::is_between(x, y) {
                false => assert_eq!(a, b),
                true => taken += usize::from(off > 0.0),
            }
            mean += off / whole.len() as f32;
            far += usize::from(off > 0.1);
        }
        assert!(taken > whole.len() / 8, "{taken} of {} take a mean", whole.len());
        assert!(
            mean < 0.01 && far * 50 < whole.len(),
            "{}: {mean}, {far}",
            camera.name
        );
    }
}

/// A stroke of one voxel on the road lies below the road's physical height by its labels, and is seen all the same.
#[test]
fn what_is_painted_onto_the_ground_is_seen() {
    let (mut frame, background) = street();
    let before = pictures(&fresh(&frame, &background));
    for [x, y] in frame
        .extent()
        .all_columns()
        .filter(|[x, y]| (112..118).contains(x) && (98..103).contains(y))
    {
        frame.occupancy.set(x, y, 1, Class::Manmade.id());
        frame.painted.set(x, y, 1, Class::Manmade.id());
    }
    let appearance = fresh(&frame, &background);
    let camera = &SensorRig::default().cameras[1];
    let truth = appearance.truth(camera, SIZE, &frame.boxes, None);
    let seen = truth.pixels.iter().filter(|p| p.class == Class::Manmade.id());
    let low = seen.filter(|p| (3.0..9.0).contains(&p.depth_m)).count();
    assert!(low > 20 && pictures(&appearance) != before, "{low} pixels");
}
