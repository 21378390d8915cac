//! Tests of edits of the background: local, undoable, in every frame, and refused in one line.

use glam::DVec3;

use super::*;
use crate::Document;
use scene::background::{Building, Facade, LineKind, Roof, SceneryLine, Tree, TreeKind};
use scene::{BoxId, Relief, SceneBox, SensorRig};

fn building(height_m: f64) -> Form {
    Form::Building(Building {
        outline_m: vec![
            DVec2::new(10.0, 10.0),
            DVec2::new(20.0, 10.0),
            DVec2::new(20.0, 18.0),
            DVec2::new(10.0, 18.0),
        ],
        height_m,
        roof: Roof::Flat,
        facade: Facade::Balconies,
    })
}

fn tree(x: f64, y: f64) -> Form {
    Form::Tree(Tree {
        position_m: DVec2::new(x, y),
        height_m: 5.0,
        crown_radius_m: 1.6,
        kind: TreeKind::Broadleaf,
    })
}

fn scene(relief: Relief) -> Scene {
    let mut layout = BevLayout::default();
    layout.relief = relief;
    let car = SceneBox {
        id: BoxId(1),
        class: Class::Car,
        center_m: DVec3::new(5.0, 0.0, 0.85),
        size_m: DVec3::new(4.6, 1.95, 1.7),
        yaw_rad: 0.0,
        velocity_mps: DVec2::ZERO,
        label: Default::default(),
    };
    let boxes: BTreeMap<_, _> = [(car.id, car)].into_iter().collect();
    let grid = scene::draft::draft(&layout, boxes.values());
    Scene::single(
        "test",
        Frame::new(layout, boxes, grid),
        SensorRig::default().into(),
        1,
    )
}

fn columns_changed(a: &VoxelGrid, b: &VoxelGrid) -> Vec<DVec2> {
    let all = Extent::WINDOW.all_columns().map(|[x, y]| (x, y));
    let changed = all.filter(|(x, y)| a.column(*x, *y) != b.column(*x, *y));
    changed
        .map(|(x, y)| Extent::WINDOW.center(x, y, 0).truncate())
        .collect()
}

/// A building raised, a tree row deleted, a hedge drawn: only their own ground changes, and undo brings all back.
#[test]
fn edits_of_things_are_local_and_undoable() {
    for relief in [
        Relief::FLAT,
        Relief::from_fn(Extent::WINDOW, |p| 0.03 * p.x + 0.02 * p.y),
    ] {
        let mut doc = Document::new(scene(relief));
        let empty = doc.scene().frame().occupancy.clone();
        let row: Vec<Form> = (0..5).map(|i| tree(-20.0 + 6.0 * f64::from(i), -9.0)).collect();
        let forms = [row, vec![building(3.0)]].concat();
        doc.apply("Add", &Edit::AddThings { forms }).expect("sound");
        let with_all = doc.scene().frame().occupancy.clone();
        assert!(with_all.class_counts()[Class::Vegetation as usize] > 150);
        assert!(with_all.class_counts()[Class::Manmade as usize] > 2000);

        let house = ThingId(6);
        doc.apply(
            "Raise",
            &Edit::RaiseThings {
                ids: vec![house],
                by_m: 6.0,
            },
        )
        .expect("sound");
        let raised = doc.scene().frame().occupancy.clone();
        assert!(raised.count_set() > with_all.count_set() + 500);
        for p in columns_changed(&with_all, &raised) {
            assert!(p.x > 8.0 && p.x < 22.0 && p.y > 8.0 && p.y < 20.0, "{p}");
        }

        doc.apply(
            "Remove",
            &Edit::RemoveThings {
                ids: (1..=5).map(ThingId).collect(),
            },
        )
        .expect("there");
        let cut = doc.scene().frame().occupancy.clone();
        assert_eq!(cut.class_counts()[Class::Vegetation as usize], 0);
        for p in columns_changed(&raised, &cut) {
            assert!((p.y + 9.0).abs() < 3.0, "{p}");
        }
        // Where trees stood the ground is back.
        let trees_only = columns_changed(&empty, &cut);
        assert!(trees_only.iter().all(|p| p.x > 8.0 && p.y > 8.0));

        let hedge = SceneryLine::typical(
            LineKind::Hedge,
            vec![DVec2::new(-10.0, 6.0), DVec2::new(6.0, 6.0)],
        );
        doc.apply(
            "Hedge",
            &Edit::AddThings {
                forms: vec![Form::Line(hedge)],
            },
        )
        .expect("sound");
        let hedged = &doc.scene().frame().occupancy;
        let changed = columns_changed(&cut, hedged);
        assert!(changed.len() > 60 && changed.iter().all(|p| (p.y - 6.0).abs() < 1.2));
        // Nothing is pending: the source shows the same.
        assert_eq!(*hedged, doc.scene().frame().source.occupancy);
        for _ in 0..4 {
            doc.undo().expect("a step");
        }
        assert_eq!(doc.scene().frame().occupancy, empty);
        assert!(doc.scene().background.is_empty());
    }
}

#[test]
fn a_neighbour_of_what_goes_stays_whole() {
    let mut alone = Document::new(scene(Relief::FLAT));
    let add = |forms: Vec<Form>| Edit::AddThings { forms };
    alone
        .apply("Add", &add(vec![tree(0.0, 8.0), building(6.0)]))
        .expect("sound");
    let mut doc = Document::new(scene(Relief::FLAT));
    doc.apply("Add", &add(vec![tree(0.0, 8.0), building(6.0), tree(2.2, 8.0)]))
        .expect("sound");
    doc.apply(
        "Remove",
        &Edit::RemoveThings {
            ids: vec![ThingId(3)],
        },
    )
    .expect("there");
    assert_eq!(
        doc.scene()
            .frame()
            .occupancy
            .count_different(&alone.scene().frame().occupancy),
        0
    );
}

#[test]
fn every_moment_of_a_clip_sees_the_same_things() {
    let mut clip = scene(Relief::FLAT);
    let key = |time_s: f64, x: f64| scene::Key {
        time_s,
        at_m: DVec2::new(x, 0.0),
        yaw_deg: 0.0,
    };
    clip.change_clip(|c| {
        c.length_s = 2.0;
        c.ego = Some(scene::Motion::Keys(vec![key(0.0, 0.0), key(2.0, 8.0)]));
    });
    let mut doc = Document::new(clip);
    doc.show(1.0);
    doc.apply(
        "Add",
        &Edit::AddThings {
            forms: vec![tree(0.0, 12.0)],
        },
    )
    .expect("sound");
    let first = doc.scene().at(0.0).frame().clone();
    let plants = first
        .occupancy
        .iter_set()
        .filter(|v| v.3 == Class::Vegetation.id());
    let (n, sum) = plants.fold((0, 0.0), |(n, sum), v| {
        (n + 1, sum + Extent::WINDOW.center(v.0, v.1, v.2).x)
    });
    assert!(n > 30 && (sum / f64::from(n)).abs() < 0.5, "{n} {sum}");
    for time_s in [1.0, 2.0] {
        let frame = doc.scene().at(time_s).frame().clone();
        assert_eq!(frame.occupancy.changed_bricks(&first.occupancy), [0; 0]);
        assert_eq!(frame.world_from_ego.translation_m.x, 4.0 * time_s);
    }
}

#[test]
fn painted_voxels_and_cars_are_left_alone() {
    let mut doc = Document::new(scene(Relief::FLAT));
    doc.apply(
        "Paint",
        &Edit::PaintVoxels {
            cells: vec![[100, 130, 5]],
            class: Class::Barrier,
        },
    )
    .expect("inside");
    let cars = doc.scene().frame().occupancy.class_counts()[Class::Car as usize];
    let over = SceneryLine::typical(LineKind::Wall, vec![DVec2::new(5.0, 0.0), DVec2::new(0.2, 12.2)]);
    doc.apply(
        "Wall",
        &Edit::AddThings {
            forms: vec![Form::Line(over)],
        },
    )
    .expect("sound");
    let grid = &doc.scene().frame().occupancy;
    assert_eq!(grid.class_counts()[Class::Car as usize], cars);
    assert_eq!(grid.get(100, 130, 5), Class::Barrier.id());
}

#[test]
fn bad_edits_leave_the_scene_as_it_was() {
    let mut doc = Document::new(scene(Relief::FLAT));
    doc.apply(
        "Add",
        &Edit::AddThings {
            forms: vec![building(6.0)],
        },
    )
    .expect("sound");
    let rev = doc.scene().rev;
    let mut crossed = building(6.0);
    if let Form::Building(b) = &mut crossed {
        b.outline_m.swap(1, 2);
    }
    let id = ThingId(1);
    for (edit, says) in [
        (
            Edit::AddThings {
                forms: vec![tree(0.0, 0.0), crossed],
            },
            "cross",
        ),
        (
            Edit::AddThings {
                forms: vec![tree(0.0, 0.0); 100_000],
            },
            "100001 things",
        ),
        (Edit::AddThings { forms: vec![] }, "at least 1"),
        (
            Edit::RemoveThings {
                ids: vec![ThingId(99)],
            },
            "thing 99",
        ),
        (
            Edit::RaiseThings {
                ids: vec![id],
                by_m: -6.0,
            },
            "height_m is 0",
        ),
        (
            Edit::RaiseThings {
                ids: vec![id],
                by_m: f64::NAN,
            },
            "by_m is NaN",
        ),
        (
            Edit::RaiseThings {
                ids: vec![id],
                by_m: 1e6,
            },
            "height_m",
        ),
        (
            Edit::MoveThings {
                ids: vec![id],
                by_m: DVec2::new(f64::INFINITY, 0.0),
                turn_deg: 0.0,
            },
            "by_m",
        ),
        (
            Edit::ChangeThing {
                id,
                form: building(f64::NAN),
            },
            "height_m is NaN",
        ),
    ] {
        let error = doc.apply("Bad", &edit).expect_err(says).to_string();
        assert!(error.contains(says) && !error.contains('\n'), "{error}");
        assert_eq!(doc.scene().rev, rev);
    }
}

/// Removing an area of shrubs takes every low plant of its ground, also where none was drawn for it; what is higher or
/// beside it stays.
#[test]
fn shrubs_go_with_all_their_ground() {
    let mut doc = Document::new(scene(Relief::FLAT));
    let outline_m = [(10.0, 10.0), (16.0, 10.0), (16.0, 14.0), (10.0, 14.0)].map(|(x, y)| DVec2::new(x, y));
    let area = scene::background::Shrubs {
        outline_m: outline_m.to_vec(),
        height_m: 1.0,
        per_m2: 0.05,
    };
    doc.apply(
        "Add",
        &Edit::AddThings {
            forms: vec![Form::Shrubs(area)],
        },
    )
    .expect("sound");
    let columns = |lo: f64, hi: f64| {
        let all = Extent::WINDOW.all_columns();
        all.filter(move |[x, y]| {
            let p = Extent::WINDOW.center(*x, *y, 0);
            (10.0..16.0).contains(&p.x) && (lo..hi).contains(&p.y)
        })
    };
    let cells: Vec<[usize; 3]> = columns(10.0, 16.0)
        .flat_map(|[x, y]| [[x, y, 2], [x, y, 12]])
        .collect();
    let mut scene = Scene::clone(doc.scene());
    for [x, y, z] in &cells {
        scene.change_canvas(|f| f.occupancy.set(*x, *y, *z, Class::Vegetation.id()));
    }
    let mut doc = Document::new(scene);
    let ids = vec![ThingId(1)];
    doc.apply("Remove", &Edit::RemoveThings { ids }).expect("there");
    let after = &doc.scene().frame().occupancy;
    let left = |lo, hi, z| {
        columns(lo, hi)
            .filter(|[x, y]| after.get(*x, *y, z) == Class::Vegetation.id())
            .count()
    };
    assert_eq!(left(10.0, 14.0, 2), 0);
    assert_eq!(left(10.0, 14.0, 12), columns(10.0, 14.0).count());
    assert!(left(14.8, 16.0, 2) > 20);
}
