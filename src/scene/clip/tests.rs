use glam::{DVec2, DVec3};

use super::*;
use crate::grid::NOT_PAINTED;
use crate::{BevLayer, BevLayout, Class, Edit, Extent, Frame, Scene, SensorRig, VoxelGrid};

fn car(id: u32, x: f64, y: f64, yaw_rad: f64) -> SceneBox {
    SceneBox {
        id: BoxId(id),
        class: Class::Car,
        center_m: DVec3::new(x, y, 0.8),
        size_m: DVec3::new(4.4, 1.9, 1.6),
        yaw_rad,
        velocity_mps: DVec2::ZERO,
        label: Default::default(),
    }
}

/// Voxels of a car with a bonnet, so that its heading shows.
fn voxels(extent: Extent, b: &SceneBox) -> Arc<ObjectVoxels> {
    let mut grid = VoxelGrid::over(extent);
    for (x, y, layers) in crate::draft::box_columns(extent, b) {
        (0..layers).for_each(|z| grid.set(x, y, z, b.class.id()));
    }
    ObjectVoxels::cut(&grid, b, |_, label| label != Class::FREE)
}

/// A road on a map, a wall beside it, and car 7 that drives along x at 10 m/s for 4 s.
fn scene() -> Scene {
    let extent = Extent::new([-60, -40], [300, 80]).expect("sound");
    let mut layout = BevLayout::over(extent);
    let mut occupancy = VoxelGrid::over(extent);
    for x in 0..300 {
        for y in 0..80 {
            layout.set(BevLayer::DrivableArea, x, y, true);
            occupancy.set(x, y, 0, Class::DriveableSurface.id());
        }
        (0..5).for_each(|z| occupancy.set(x, 60, z, Class::Manmade.id()));
    }
    let standing = car(3, 5.0, 4.0, 0.0);
    let frame = Frame::new(layout, [(standing.id, standing)].into(), occupancy);
    let mut scene = Scene::single("clip", frame, Arc::new(SensorRig::default()), 1);
    let made = car(7, 0.0, 0.0, 0.0);
    let key = |time_s: f64, x: f64| Key {
        time_s,
        at_m: DVec2::new(x, 0.0),
        yaw_deg: 0.0,
    };
    let track = Track {
        made,
        motion: Motion::Keys(vec![key(0.0, 0.0), key(4.0, 40.0)]),
        there_s: [None; 2],
        voxels: voxels(extent, &made),
        settled: true,
        own_shape: false,
    };
    scene.change_clip(|clip| {
        clip.length_s = 4.0;
        clip.tracks.insert(made.id, track);
    });
    scene
}

#[test]
fn a_view_shows_the_objects_of_its_moment_and_leaves_the_canvas_alone() {
    let scene = scene();
    let canvas = scene.canvas().occupancy.clone();
    for i in 0..=40 {
        let view = scene.at(f64::from(i) * 0.1);
        assert_eq!(view.canvas().occupancy.count_different(&canvas), 0);
        let b = view.frame().boxes[&BoxId(7)];
        assert!((b.center_m.x - f64::from(i)).abs() < 1e-9, "{b:?}");
        let middle = view
            .frame()
            .extent()
            .voxel_at(b.center_m.with_z(0.0))
            .expect("inside");
        assert_eq!(
            view.frame().occupancy.get(middle[0], middle[1], 4),
            Class::Car.id()
        );
        // A voxel of the car or one of the canvas: nothing else.
        let (shown, inside) = (&view.frame().occupancy, |p: DVec3| {
            b.contains(p.with_z(b.center_m.z), MARGIN_M)
        });
        for (x, y, z, label) in shown.iter_set() {
            let p = view.frame().extent().center(x, y, z);
            assert!(label == canvas.get(x, y, z) || label == Class::Car.id() && inside(p));
        }
        // The shape is the same up to half a voxel: as many voxels, give or take one layer.
        let (now, made) = (
            shown.count_different(&canvas),
            scene.frame().occupancy.count_different(&canvas),
        );
        assert!(now.abs_diff(made) * 5 <= made, "{now} voxels against {made}");
    }
    assert_eq!(scene.at(2.0).at(0.0).frame().occupancy, scene.frame().occupancy);
}

#[test]
fn where_it_was_made_an_object_is_bit_for_bit_what_it_was() {
    for yaw in [0.0, 0.3, 1.2, -2.0] {
        let made = car(9, 3.3, -1.7, yaw);
        let extent = Extent::WINDOW;
        let mut grid = VoxelGrid::over(extent);
        for (i, (x, y, layers)) in crate::draft::box_columns(extent, &made).into_iter().enumerate() {
            (0..layers).for_each(|z| grid.set(x, y, z, if i % 3 == 0 { 4 } else { 10 }));
        }
        let voxels = ObjectVoxels::cut(&grid, &made, |_, label| label != Class::FREE);
        let mut out = VoxelGrid::over(extent);
        voxels.stamp(&mut out, &crate::VoxelPaint::over(extent), &made, &made);
        assert_eq!(out, grid);
    }
}

/// `fold` of an unchanged view gives the scene, and the view of a folded change equals the changed view.
#[test]
fn changes_of_a_view_go_to_the_canvas_or_to_the_object() {
    let start = scene();
    for time_s in [0.0, 1.3, 4.0] {
        let mut same = start.at(time_s);
        same.change(Scope::WholeTrack, |_| ());
        assert_eq!((same.canvas(), same.clip()), (start.canvas(), start.clip()));

        // A voxel far from the car belongs to the canvas, at all times.
        let mut wall = start.at(time_s);
        wall.change(Scope::WholeTrack, |f| {
            f.occupancy.set(10, 10, 3, Class::Manmade.id())
        });
        assert_eq!(wall.clip(), start.clip());
        assert_eq!(wall.at(2.2).frame().occupancy.get(10, 10, 3), Class::Manmade.id());

        // A voxel painted on its roof moves with it.
        let mut rack = start.at(time_s);
        let b = rack.frame().boxes[&BoxId(7)];
        let [x, y, _] = rack
            .frame()
            .extent()
            .voxel_at(b.center_m.with_z(0.0))
            .expect("inside");
        rack.change(Scope::WholeTrack, |f| {
            let top = (0..16)
                .rev()
                .find(|z| f.occupancy.get(x, y, *z) != Class::FREE)
                .expect("a roof");
            f.occupancy.set(x, y, top + 1, Class::Others.id());
            f.painted.set(x, y, top + 1, Class::Others.id());
            f.occupancy.set(x, y, top, Class::Others.id());
        });
        let others = |s: &Scene| {
            s.frame()
                .occupancy
                .iter_set()
                .filter(|v| v.3 == Class::Others.id())
                .count()
        };
        assert!(others(&rack) >= 1);
        assert!(others(&rack.at(3.0)) >= 1, "{time_s}");
        assert_eq!(
            rack.canvas().occupancy.count_different(&start.canvas().occupancy),
            0
        );
    }
}

#[test]
fn a_moved_object_moves_at_one_moment_from_there_on_or_always() {
    let start = scene().at(2.0);
    let moved = |scope| {
        let mut scene = start.clone();
        scene.change(scope, |f| {
            f.boxes.get_mut(&BoxId(7)).expect("there").center_m.y += 3.0;
        });
        [0.0, 1.0, 2.0, 3.0, 4.0].map(|t| scene.at(t).frame().boxes[&BoxId(7)].center_m.y.round() as i32)
    };
    assert_eq!(moved(Scope::WholeTrack), [3; 5]);
    assert_eq!(moved(Scope::FromHereOn), [0, 2, 3, 3, 3]);
    assert_eq!(moved(Scope::Moment), [0, 2, 3, 2, 0]);
    // The voxels move with it, and are not drawn again.
    let mut scene = start.clone();
    scene.change(Scope::WholeTrack, |f| {
        f.boxes.get_mut(&BoxId(7)).expect("there").center_m.y += 3.0;
    });
    let (a, b) = (&start.clip().tracks[&BoxId(7)], &scene.clip().tracks[&BoxId(7)]);
    assert!(Arc::ptr_eq(&a.voxels, &b.voxels) && b.settled);
}

#[test]
fn a_removed_object_is_gone_and_a_resized_one_is_a_draft() {
    let mut gone = scene().at(1.0);
    gone.change(Scope::WholeTrack, |f| f.boxes.remove(&BoxId(7)));
    assert!(gone.clip().tracks.is_empty() && gone.at(3.0).frame().boxes.len() == 1);
    assert_eq!(gone.at(3.0).frame().occupancy, gone.canvas().occupancy);
    let mut leaves = scene().at(1.0);
    leaves.change(Scope::FromHereOn, |f| f.boxes.remove(&BoxId(7)));
    assert!(leaves.at(0.9).frame().boxes.contains_key(&BoxId(7)));
    assert!(!leaves.at(1.0).frame().boxes.contains_key(&BoxId(7)));
    // Its id is not free.
    assert_eq!(leaves.at(3.0).frame().next_box_id(), BoxId(8));
    let mut larger = scene().at(1.0);
    larger.change(Scope::WholeTrack, |f| {
        f.boxes.get_mut(&BoxId(7)).expect("there").size_m.x = 9.0
    });
    assert!(!larger.clip().tracks[&BoxId(7)].settled);
}

#[test]
fn networks_are_asked_about_what_stands_and_about_drafts_alone() {
    let mut scene = scene().at(2.5);
    assert!(!scene.for_generation().frame().boxes.contains_key(&BoxId(7)));
    assert_eq!(scene.for_generation().frame().occupancy, scene.canvas().occupancy);
    scene.change_clip(|clip| clip.tracks.get_mut(&BoxId(7)).expect("there").settled = false);
    let asked = scene.for_generation().into_owned();
    assert_eq!(
        asked.frame().boxes[&BoxId(7)].center_m.x,
        0.0,
        "where it was made"
    );
    assert!(!asked.frame().source.boxes.contains_key(&BoxId(7)));
    assert_eq!(asked.content(), scene.content());
    // The answer is a truck-like car and a new wall voxel.
    let mut answer = Frame::clone(asked.frame());
    let before = scene.canvas().occupancy.clone();
    let [x, y, _] = answer.extent().voxel_at(DVec3::ZERO).expect("inside");
    answer.occupancy.set(x, y, 6, Class::Car.id());
    answer.occupancy.set(0, 0, 2, Class::Manmade.id());
    answer.source = Arc::new(crate::SourceFrame {
        layout: answer.layout.clone(),
        boxes: answer.boxes.clone(),
        occupancy: answer.occupancy.clone(),
    });
    scene.set_generated(answer);
    assert_eq!(scene.time_s(), 2.5);
    let track = &scene.clip().tracks[&BoxId(7)];
    assert!(track.settled && track.voxels.labels.chunks(16).any(|c| c[6] == Class::Car.id()));
    assert_eq!(scene.canvas().occupancy.count_different(&before), 1);
    assert_eq!(scene.canvas().source.occupancy.get(0, 0, 2), Class::Manmade.id());
    assert!(
        scene.frame().source.boxes.contains_key(&BoxId(7))
            && !scene.canvas().source.boxes.contains_key(&BoxId(7))
    );
    assert_eq!(
        scene.frame().source.occupancy,
        scene.frame().occupancy,
        "nothing waits"
    );
}

#[test]
fn time_is_no_part_of_what_a_scene_is() {
    let mut scene = scene();
    let (rev, content) = (scene.rev, scene.content());
    assert!(scene.show(1.0) && !scene.show(1.0));
    assert!(scene.rev != rev && scene.content() == content);
    assert!(scene.show(99.0) && scene.time_s() == 4.0, "within the clip");
    assert!(!scene.show(f64::NAN));
    scene.change(Scope::WholeTrack, |f| f.occupancy.set(0, 0, 9, 1));
    assert_ne!(scene.content(), content);
}

#[test]
fn painted_voxels_of_the_canvas_stay_where_an_object_passes() {
    let mut scene = scene();
    scene.change_canvas(|f| {
        f.painted.set(85, 40, 2, Class::Barrier.id());
        f.occupancy.set(85, 40, 2, Class::Barrier.id());
    });
    for i in 0..=40 {
        let view = scene.at(f64::from(i) * 0.1);
        assert_eq!(view.frame().occupancy.get(85, 40, 2), Class::Barrier.id());
        assert_ne!(view.frame().painted.get(85, 40, 2), NOT_PAINTED);
    }
}

#[test]
fn bad_clips_are_told_in_one_line() {
    let start = scene();
    let with = |change: &dyn Fn(&mut Clip)| {
        let mut clip = Clip::clone(start.clip());
        change(&mut clip);
        clip.problem()
    };
    let attached = |to| Motion::Attached {
        to: BoxId(to),
        at_m: DVec2::X,
        yaw_deg: 0.0,
    };
    let track = start.clip().tracks[&BoxId(7)].clone();
    let many = |clip: &mut Clip| {
        for i in 10..10_010 {
            let mut track = track.clone();
            track.made.id = BoxId(i);
            clip.tracks.insert(BoxId(i), track);
        }
    };
    assert_eq!(with(&|_| ()), None);
    for (problem, says) in [
        (with(&|c| c.length_s = f64::NAN), "a clip of NaN s"),
        (
            with(&|c| c.length_s = 1e5),
            "a clip of 100000 s, expected 0 to 600",
        ),
        (with(&|c| c.rate_hz = 0.0), "0 frames per second"),
        (
            with(&|c| (c.length_s, c.rate_hz) = (600.0, 100.0)),
            "60001 frames",
        ),
        (with(&many), "10001 tracks, expected at most 2000"),
        (
            with(&|c| c.tracks.get_mut(&BoxId(7)).expect("there").motion = attached(7)),
            "in a circle",
        ),
        (
            with(&|c| c.tracks.get_mut(&BoxId(7)).expect("there").motion = attached(8)),
            "track 8, which does not exist",
        ),
        (with(&|c| c.ego = Some(attached(8))), "ego: attached to track 8"),
        (
            with(&|c| c.tracks.get_mut(&BoxId(7)).expect("there").there_s = [Some(2.0), Some(1.0)]),
            "the first before",
        ),
        (
            with(&|c| c.ego = Some(Motion::Keys(Vec::new()))),
            "ego: 0 keyframes",
        ),
    ] {
        let problem = problem.expect(says);
        assert!(problem.contains(says) && !problem.contains('\n'), "{problem}");
    }
    let _: Option<Edit> = None;
}

#[test]
fn a_view_knows_how_far_walkers_have_come() {
    let mut scene = scene();
    scene.change_clip(|clip| {
        let track = clip.tracks.get_mut(&BoxId(7)).expect("there");
        track.made.class = Class::Pedestrian;
    });
    let covered = |time_s: f64| scene.at(time_s).frame().covered_m.get(&BoxId(7)).copied();
    assert!((covered(1.5).expect("a walker") - 15.0).abs() < 1e-9);
    scene.change_clip(|clip| clip.tracks.get_mut(&BoxId(7)).expect("there").made.class = Class::Car);
    assert_eq!(scene.at(1.5).frame().covered_m.get(&BoxId(7)), None);
}
