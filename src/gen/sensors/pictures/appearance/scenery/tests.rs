//! Scenery is drawn as its solids, but for what was cut out of it or painted onto it.

use glam::{DVec2, DVec3, Vec3};

use super::super::Appearance;
use super::super::prepared::{SurfaceHit, SurfaceKind};
use scene::background::{Building, LineKind, Post, PostKind, Roof, SceneryLine};
use scene::{Background, BevLayout, Class, Conditions, Form, Frame, SensorRig, VoxelGrid};

/// A frame in which the voxels of some things stand on grass.
fn frame_of(background: &Background) -> Frame {
    let layout = BevLayout::default();
    let mut grid = VoxelGrid::new();
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
    Frame::new(layout, Default::default(), grid)
}

/// A house 12 m ahead, a post, and a wall that runs aslant.
fn things() -> Background {
    let mut things = Background::default();
    let house = Building {
        roof: Roof::Gabled,
        ..Building::rectangle(DVec2::new(16.0, 0.0), DVec2::new(6.0, 4.0), DVec2::Y, 27.0)
    };
    things.add(Form::Building(house));
    things.add(Form::Post(Post::typical(
        PostKind::Pole,
        DVec2::new(5.0, 3.0),
        0.0,
    )));
    let wall = SceneryLine::typical(
        LineKind::Wall,
        vec![DVec2::new(4.0, -6.0), DVec2::new(12.0, -9.0)],
    );
    things.add(Form::Line(wall));
    things
}

fn appearance(frame: &Frame, background: &Background) -> Appearance {
    Appearance::with_things(frame, background, &SensorRig::default(), &Conditions::default())
}

fn hit(appearance: &Appearance, way: Vec3) -> Option<SurfaceHit> {
    appearance.trace((Vec3::new(0.0, 0.0, 1.5), way.normalize()), 0.0, 200.0, false)
}

/// Distance of the first of the things' solids along a ray.
fn exact_m(background: &Background, way: Vec3) -> Option<f64> {
    let (o, d) = (DVec3::new(0.0, 0.0, 1.5), way.as_dvec3().normalize());
    let mut solids = Vec::new();
    background.iter().for_each(|t| t.solids(&|_| 0.0, &mut solids));
    let met = solids.iter().filter_map(|s| s.enter(o, d, 200.0));
    met.min_by(f64::total_cmp)
}

/// Rays over the view ahead.
fn ways() -> impl Iterator<Item = Vec3> {
    (-40..40).flat_map(|y| (-4..85).map(move |z| Vec3::new(1.0, y as f32 * 0.02, z as f32 * 0.03)))
}

#[test]
fn rays_end_on_the_solids_at_their_true_heights() {
    let background = things();
    let appearance = appearance(&frame_of(&background), &background);
    let (mut met, mut highest) = (0, 0.0f32);
    for way in ways() {
        let found = hit(&appearance, way).filter(|h| matches!(h.what, SurfaceKind::Thing(..)));
        match (exact_m(&background, way), found) {
            (None, found) => assert!(found.is_none(), "{way}: {found:?}"),
            (Some(t), found) => {
                let on_ground = 1.5 + f64::from(way.normalize().z) * t < 0.2;
                let Some(found) = found else {
                    assert!(on_ground, "{way}: nothing, expected {t} m");
                    continue;
                };
                met += 1;
                highest = highest.max(found.p.z);
                assert!((f64::from(found.t) - t).abs() < 0.002, "{way}: {} {t}", found.t);
            }
        }
    }
    assert!(met > 1000, "{met} rays");
    // The map ends 5.4 m above the ground.
    assert!(highest > 26.9, "{highest} m");
}

#[test]
fn what_is_cut_out_by_hand_is_open_and_nothing_else_changes() {
    let background = things();
    let mut frame = frame_of(&background);
    let whole = appearance(&frame, &background);
    // A hole of 2 x 2.4 m through the whole house.
    let extent = frame.extent();
    let (low, high) = (DVec3::new(9.0, -1.0, 1.0), DVec3::new(24.0, 1.0, 3.4));
    let in_hole = |p: DVec3| p.cmpge(low).all() && p.cmple(high).all();
    for [x, y] in extent.all_columns() {
        for z in 0..extent.nz() {
            if in_hole(extent.center(x, y, z)) && frame.occupancy.get(x, y, z) != Class::FREE {
                frame.occupancy.set(x, y, z, Class::FREE);
                frame.painted.set(x, y, z, Class::FREE);
            }
        }
    }
    let cut = appearance(&frame, &background);
    let through = Vec3::new(1.0, 0.0, 0.04);
    assert!(hit(&whole, through).is_some_and(|h| h.t < 13.0));
    assert!(hit(&cut, through).is_none(), "{:?}", hit(&cut, through));
    let (mut same, mut voxels) = (0, 0);
    for way in ways() {
        let (before, after) = (hit(&whole, way), hit(&cut, way));
        let around = before.is_some_and(|h| {
            let p = h.p.as_dvec3();
            p.cmpge(low - 1.5).all() && p.cmple(high + 1.5).all()
        });
        if around {
            voxels += usize::from(after.is_some_and(|h| matches!(h.what, SurfaceKind::Voxel(15))));
            continue;
        }
        same += 1;
        assert_eq!(
            before.map(|h| h.t.to_bits()),
            after.map(|h| h.t.to_bits()),
            "{way}"
        );
    }
    assert!(
        same > 2000 && voxels > 50,
        "{same} rays as before, {voxels} on voxels around the hole"
    );
}

#[test]
fn a_thing_that_is_not_there_is_not_drawn_and_paint_stays() {
    let background = things();
    let mut frame = frame_of(&background);
    let extent = frame.extent();
    // The house is gone, its thing still known.
    for [x, y] in extent
        .all_columns()
        .filter(|[x, y]| extent.center(*x, *y, 0).x > 9.0)
    {
        (1..extent.nz()).for_each(|z| frame.occupancy.set(x, y, z, Class::FREE));
    }
    let ahead = Vec3::new(1.0, 0.0, 0.0);
    assert!(hit(&appearance(&frame, &background), ahead).is_none());
    // Voxels painted beside the pole are nobody's strays.
    let [x, y] = extent.column_at(5.0, 3.4).expect("on the map");
    for z in 3..8 {
        frame.occupancy.set(x, y, z, Class::Manmade.id());
    }
    let beside = Vec3::new(5.0, 3.4, 0.0);
    let seen = |frame: &Frame| hit(&appearance(frame, &background), beside).is_some_and(|h| h.t < 8.0);
    assert!(!seen(&frame), "a stray of the pole");
    (3..8).for_each(|z| frame.painted.set(x, y, z, Class::Manmade.id()));
    assert!(seen(&frame), "painted");
}

#[test]
fn outlines_that_are_not_convex_are_met_as_they_are() {
    let mut background = Background::default();
    let corners = [
        [8.0, -6.0],
        [20.0, -6.0],
        [20.0, 6.0],
        [8.0, 6.0],
        [8.0, 2.0],
        [14.0, 2.0],
        [14.0, -2.0],
        [8.0, -2.0],
    ];
    background.add(Form::Building(Building {
        outline_m: corners.map(DVec2::from).to_vec(),
        height_m: 6.0,
        roof: Roof::Flat,
        facade: Default::default(),
    }));
    let appearance = appearance(&frame_of(&background), &background);
    for y in -60..60 {
        let way = Vec3::new(1.0, y as f32 * 0.01, 0.01);
        let (found, exact) = (hit(&appearance, way), exact_m(&background, way));
        let found = found.map(|h| f64::from(h.t));
        let near = found.zip(exact).is_some_and(|(a, b)| (a - b).abs() < 0.002);
        assert!(
            near || found.is_none() && exact.is_none(),
            "{way}: {found:?} {exact:?}"
        );
    }
}

#[test]
fn inferred_things_must_explain_the_voxels_around_them_too() {
    let background = things();
    let mut frame = frame_of(&background);
    frame.inferred.background = true;
    let ahead = Vec3::new(1.0, 0.0, 0.1);
    let is_solid = |frame: &Frame| {
        let hit = hit(&appearance(frame, &background), ahead).expect("a house stands there");
        matches!(hit.what, SurfaceKind::Thing(..))
    };
    assert!(is_solid(&frame));
    let drawn = |frame: &Frame| {
        appearance(frame, &background)
            .things
            .iter()
            .filter(|t| t.is_scenery())
            .count()
    };
    let before = drawn(&frame);
    // Two more rows of voxels all around: the house that was inferred is too small.
    let extent = frame.extent();
    let near = |[x, y]: &[usize; 2]| {
        let p = extent.center(*x, *y, 0).truncate();
        (p.x - 16.0).abs() < 4.9 && p.y.abs() < 6.9
    };
    for [x, y] in extent.all_columns().filter(near) {
        (1..extent.nz()).for_each(|z| frame.occupancy.set(x, y, z, Class::Manmade.id()));
    }
    assert!(!is_solid(&frame));
    assert!(drawn(&frame) < before);
    // A house that somebody put there is not in question.
    frame.inferred.background = false;
    assert_eq!(drawn(&frame), before);
}

/// A voxel is a hole if a hand took it out; one that is missing is a ragged edge.
#[test]
fn a_hole_of_one_voxel_is_open_if_a_hand_made_it() {
    let background = things();
    let mut frame = frame_of(&background);
    let extent = frame.extent();
    let way = Vec3::new(1.0, 0.015, 0.0);
    let before = hit(&appearance(&frame, &background), way).expect("a house");
    let in_hole =
        |p: DVec3| (9.0..24.0).contains(&p.x) && (0.0..0.4).contains(&p.y) && (1.4..1.8).contains(&p.z);
    let hole: Vec<[usize; 3]> = extent
        .all_columns()
        .flat_map(|[x, y]| (0..extent.nz()).map(move |z| [x, y, z]))
        .filter(|[x, y, z]| {
            in_hole(extent.center(*x, *y, *z)) && frame.occupancy.get(*x, *y, *z) != Class::FREE
        })
        .collect();
    hole.iter()
        .for_each(|[x, y, z]| frame.occupancy.set(*x, *y, *z, Class::FREE));
    let ragged = hit(&appearance(&frame, &background), way).expect("still a house");
    assert_eq!(ragged.t.to_bits(), before.t.to_bits());
    hole.iter()
        .for_each(|[x, y, z]| frame.painted.set(*x, *y, *z, Class::FREE));
    assert!(hit(&appearance(&frame, &background), way).is_none_or(|h| h.t > before.t + 0.3));
}
