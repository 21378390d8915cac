//! What is edited somewhere recolours nothing elsewhere.

use std::collections::BTreeMap;

use glam::{DVec2, Vec3};

use super::field::FARTHEST_M;
use super::prepared::SurfaceKind;
use super::*;
use scene::{Background, BevLayer, Class, Extent, Frame, SensorRig, VoxelGrid};
use world::World;
use world::draw::Draw;
use world::voxelize::{Vertical, complete};

/// What a place of man-made things looks like, to the last bit.
type Look = [u32; 7];

/// Looks of man-made things by ray, each with its place on the map, m.
type Looks = BTreeMap<usize, (DVec2, Look)>;

/// The looks that some rays from above the road meet.
fn looks(frame: &Frame, background: &Background) -> Looks {
    let conditions = Conditions {
        time: scene::TimeOfDay::Night,
        seed: 7,
        ..Conditions::default()
    };
    let rig = SensorRig::default();
    let appearance = Appearance::with_things(frame, background, &rig, &conditions);
    let look = |ray: usize| {
        let (eye, turn, up) = (ray % 5, ray / 5 % 360, ray / 1800);
        let from = [
            [0.0, 0.0],
            [-20.0, -9.0],
            [24.0, 14.0],
            [-6.0, 30.0],
            [9.0, -28.0],
        ][eye];
        let way = glam::Vec2::from_angle((turn as f32).to_radians()).extend(up as f32 * 0.03 - 0.2);
        let from = Vec3::new(from[0], from[1], 5.5);
        let hit = appearance.trace((from, way.normalize()), 0.0, 60.0, false)?;
        let made = match hit.what {
            SurfaceKind::Ground => false,
            SurfaceKind::Voxel(label) => label == Class::Manmade.id(),
            SurfaceKind::Thing(i, ..) => appearance.things[i as usize].is_scenery(),
        };
        let s = appearance.surface(&hit, Vec3::X, 0.02);
        let [r, g, b] = s.albedo.to_array();
        let [er, eg, eb] = s.emit.to_array();
        let look = [r, g, b, s.mirror, er, eg, eb].map(f32::to_bits);
        made.then_some((ray, (hit.p.truncate().as_dvec2(), look)))
    };
    (0..5 * 360 * 12).filter_map(look).collect()
}

/// A random edit around a place, at most this wide.
const WIDE_M: f64 = 8.0;

fn edited(frame: &Frame, at_m: DVec2, draw: &mut Draw) -> Frame {
    let mut frame = frame.clone();
    let half_m = DVec2::new(draw.range(0.5, 4.0), draw.range(0.5, 4.0));
    let (what, high) = (draw.below(4), 2 + draw.below(13));
    let extent = frame.extent();
    let near = |[x, y]: &[usize; 2]| {
        let off = (extent.center(*x, *y, 0).truncate() - at_m).abs();
        off.cmple(half_m).all()
    };
    let columns: Vec<[usize; 2]> = extent.all_columns().filter(near).collect();
    for [x, y] in columns {
        let column = frame.occupancy.column_mut(x, y);
        match what {
            0 => column[1..high].fill(Class::Manmade.id()),
            1 => column.fill(Class::FREE),
            2 => column[1..high].fill(Class::Vegetation.id()),
            _ => {
                column.fill(Class::FREE);
                column[2] = Class::Sidewalk.id();
                frame.layout.set(BevLayer::Walkway, x, y, true);
            }
        }
    }
    frame
}

/// Edits of a world; places farther than `margin_m` from them look as before. Returns how many were compared.
fn compared(seed: u64, known: bool, margin_m: f64) -> usize {
    let world = World::random(seed);
    let grid = complete(&world, Vertical::Occ3d);
    let frame = Frame::new(world.layout.clone(), world.boxes.clone(), grid);
    let background = match known {
        true => world.background.clone(),
        false => Background::default(),
    };
    let before = looks(&frame, &background);
    let mut draw = Draw::new(seed, "far edits");
    let mut count = 0;
    for _ in 0..12 {
        // Where something stands more often than not: there an edit joins and parts.
        let at_m = match draw.below(3) {
            0 => DVec2::new(draw.range(-38.0, 38.0), draw.range(-38.0, 38.0)),
            _ => {
                let all: Vec<_> = before.values().collect();
                all[draw.below(all.len())].0
            }
        };
        let after = edited(&frame, at_m, &mut draw);
        let after = looks(&after, &background);
        for (ray, (place, look)) in &before {
            // Rays that pass the edit may end elsewhere.
            let Some((now, after)) = after.get(ray).filter(|(now, _)| now == place) else {
                continue;
            };
            if (*now - at_m).abs().max_element() > margin_m + WIDE_M / 2.0 {
                count += 1;
                assert_eq!(after, look, "seed {seed}: a ray to {now}, edit at {at_m}");
            }
        }
    }
    count
}

#[test]
fn an_edit_recolours_nothing_far_from_it() {
    // Things keep their look but for the voxels that are edited; of what no thing explains a part may change with it.
    let known: usize = (0..4).map(|seed| compared(seed, true, 7.0)).sum();
    let unknown: usize = (0..4).map(|seed| compared(seed, false, FARTHEST_M + 2.0)).sum();
    assert!(known > 100_000 && unknown > 40_000, "{known} {unknown}");
}

/// Two houses that a wall of voxels joins stay two; one house has one look.
#[test]
fn houses_that_are_joined_keep_their_own_looks() {
    use scene::background::Building;
    let mut background = Background::default();
    let house = |x: f64, half: DVec2| {
        scene::Form::Building(Building::rectangle(DVec2::new(x, 18.0), half, DVec2::X, 9.0))
    };
    background.add(house(-20.0, DVec2::new(14.0, 6.0)));
    background.add(house(20.0, DVec2::splat(6.0)));
    let layout = scene::BevLayout::default();
    let mut grid = VoxelGrid::new();
    for thing in background.iter() {
        for ([x, y], labels) in thing.columns(&layout) {
            grid.column_mut(x, y).copy_from_slice(&labels);
        }
    }
    let apart = Frame::new(layout, Default::default(), grid);
    let mut joined = apart.clone();
    let extent = Extent::WINDOW;
    for i in 0..60 {
        let [x, y] = extent
            .column_at(-10.0 + f64::from(i) * 0.4, 18.0)
            .expect("inside");
        joined.occupancy.column_mut(x, y)[3..8].fill(Class::Manmade.id());
    }
    let looks = |frame: &Frame| {
        let rig = SensorRig::default();
        let appearance = Appearance::with_things(frame, &background, &rig, &Conditions::default());
        // Walls that face the road.
        let at = |x: f32| {
            let hit = appearance.trace((Vec3::new(x, 8.0, 2.0), Vec3::Y), 0.0, 20.0, false);
            let hit = hit.expect("a house stands there");
            let SurfaceKind::Thing(i, ..) = hit.what else {
                panic!("{hit:?}");
            };
            appearance.things[i as usize].id
        };
        ([-33.0, -24.0, -20.0, -7.0].map(at), at(20.0))
    };
    assert_eq!(looks(&apart), looks(&joined));
    let (long, other) = looks(&apart);
    assert!(
        long.iter().all(|id| *id == long[0] && *id != other),
        "{long:?} {other}"
    );
}
