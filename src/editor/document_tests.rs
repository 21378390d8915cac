//! Tests of the document: whatever is done to it, undo visits the same scenes.

use crate::Apply;
use std::collections::BTreeMap;

use glam::{DVec2, DVec3};
use proptest::prelude::*;

use super::*;
use crate::Shape;
use scene::draft::draft;
use scene::{
    BevLayer, BevLayout, BoxId, Class, Conditions, Extent, Frame, SceneBox, SensorRig, TimeOfDay, Weather,
};

pub(crate) fn start() -> Scene {
    let mut layout = BevLayout::default();
    for x in 60..140 {
        for y in 90..110 {
            layout.set(BevLayer::DrivableArea, x, y, true);
        }
    }
    let b = |id: u32| SceneBox {
        id: BoxId(id),
        class: Class::Car,
        center_m: DVec3::new(f64::from(id) * 6.0 - 10.0, 0.0, 0.85),
        size_m: DVec3::new(4.6, 1.95, 1.7),
        yaw_rad: 0.1,
        velocity_mps: DVec2::ZERO,
        label: Default::default(),
    };
    let boxes: BTreeMap<_, _> = (1..=3).map(|id| (BoxId(id), b(id))).collect();
    let occupancy = draft(&layout, boxes.values());
    let frame = Frame::new(layout, boxes, occupancy);
    let mut scene = Scene::single("start", frame, Arc::new(SensorRig::default()), 1);
    // The last one drives along for a second.
    let key = |time_s: f64, x: f64| scene::Key {
        time_s,
        at_m: DVec2::new(x, 0.0),
        yaw_deg: 0.1_f64.to_degrees(),
    };
    let motion = Edit::SetMotion {
        id: Some(BoxId(3)),
        motion: Some(scene::Motion::Keys(vec![key(0.0, 8.0), key(1.0, 14.0)])),
        from_s: None,
        to_s: None,
    };
    crate::apply::Apply::apply(&motion, &mut scene).expect("sound");
    scene
}

/// All that two equal scenes share, the revision aside.
fn same(a: &Scene, b: &Scene) -> bool {
    (
        &a.name,
        &a.prompt,
        a.conditions,
        &a.rig,
        a.canvas(),
        a.clip(),
        a.time_s(),
        a.seed,
    ) == (
        &b.name,
        &b.prompt,
        b.conditions,
        &b.rig,
        b.canvas(),
        b.clip(),
        b.time_s(),
        b.seed,
    )
}

pub(crate) fn add(x: f64, y: f64) -> Edit {
    Edit::AddBox {
        class: Class::TrafficCone,
        center_m: DVec3::new(x, y, 0.5),
        size_m: DVec3::new(0.5, 0.5, 1.0),
        yaw_deg: 0.0,
        velocity_mps: None,
        id: None,
        label: Default::default(),
    }
}

pub(crate) fn slide(x: f64) -> Edit {
    Edit::MoveBox {
        id: BoxId(1),
        center_m: Some(DVec3::new(x, 0.0, 0.85)),
        yaw_deg: None,
        size_m: None,
    }
}

/// Edits near the road; many hit each other, some are refused.
pub(crate) fn any_edit() -> impl Strategy<Value = Edit> {
    let id = (1u32..8).prop_map(BoxId);
    let object = prop::sample::select(Class::OBJECTS.to_vec());
    let class = prop::sample::select(Class::ALL.to_vec());
    let layer = prop::sample::select(BevLayer::MAP.to_vec());
    let place = (-20.0..20.0f64, -5.0..5.0f64);
    let voxels = prop::collection::vec((70usize..130, 90usize..110, 0usize..17), 0..8);
    let voxels = voxels.prop_map(|v| v.into_iter().map(|(x, y, z)| [x, y, z]).collect::<Vec<_>>());
    prop_oneof![
        id.clone().prop_map(|id| Edit::RemoveBox { id }),
        (object.clone(), place.clone(), 0.0..360.0f64).prop_map(|(class, (x, y), yaw_deg)| {
            let size_m = DVec3::from_array(class.typical_size_m().expect("an object"));
            Edit::AddBox {
                class,
                center_m: DVec3::new(x, y, size_m.z / 2.0),
                size_m,
                yaw_deg,
                velocity_mps: None,
                id: None,
                label: Default::default(),
            }
        }),
        (id.clone(), place.clone(), prop::option::of(0.0..360.0f64)).prop_map(|(id, (x, y), yaw_deg)| {
            Edit::MoveBox {
                id,
                center_m: Some(DVec3::new(x, y, 0.9)),
                yaw_deg,
                size_m: None,
            }
        }),
        (id, class.clone()).prop_map(|(id, class)| Edit::SetBoxClass { id, class }),
        (layer, place, 0.0..4.0f64, any::<bool>()).prop_map(|(layer, (x, y), radius_m, value)| {
            Edit::PaintBev {
                layer,
                shape: Shape::Disc {
                    center_m: DVec2::new(x, y),
                    radius_m,
                },
                value,
            }
        }),
        (voxels.clone(), class).prop_map(|(cells, class)| Edit::PaintVoxels { cells, class }),
        voxels.prop_map(|cells| Edit::UnlockVoxels { cells }),
        Just(Edit::ClearPaint {}),
        "[a-c]{0,2}".prop_map(|prompt| Edit::SetPrompt { prompt }),
        (0..4usize, 0..6usize, 0..3u64).prop_map(|(time, weather, seed)| Edit::SetConditions {
            conditions: Conditions::usual(TimeOfDay::ALL[time], Weather::ALL[weather], seed),
        }),
    ]
}

/// What a session does to a document.
#[derive(Clone, Debug)]
enum Action {
    Apply(Edit),
    Group(Vec<Edit>),
    Drag(Vec<Edit>, bool),
    Undo,
    Redo,
    Adopt,
    Jump(usize),
}

fn any_action() -> impl Strategy<Value = Action> {
    prop_oneof![
        6 => any_edit().prop_map(Action::Apply),
        1 => prop::collection::vec(any_edit(), 0..4).prop_map(Action::Group),
        2 => (prop::collection::vec(any_edit(), 1..5), any::<bool>()).prop_map(|(e, c)| Action::Drag(e, c)),
        3 => Just(Action::Undo),
        2 => Just(Action::Redo),
        1 => Just(Action::Adopt),
        1 => (0usize..20).prop_map(Action::Jump),
    ]
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(150))]

    /// Row 27 of the extremes table, with everything a session can do: the document behaves like a
    /// plain list of deep copies.
    #[test]
    fn row_27_undo_visits_the_same_scenes(actions in prop::collection::vec(any_action(), 1..40)) {
        let mut document = Document::new(start());
        let mut model: Vec<Scene> = vec![start()];
        let mut at = 0usize;
        for action in actions {
            let before = document.scene().clone();
            let mut pushed = false;
            match action {
                Action::Apply(edit) => {
                    let mut twin = Scene::clone(&before);
                    let expected = edit.apply(&mut twin);
                    prop_assert_eq!(&document.apply("apply", &edit), &expected);
                    prop_assert!(same(document.scene(), &twin));
                    pushed = document.scene().rev != before.rev;
                }
                Action::Group(edits) => {
                    let all = document.apply_all("group", &edits);
                    if all.is_err() {
                        prop_assert_eq!(document.scene().rev, before.rev);
                    }
                    pushed = document.scene().rev != before.rev;
                }
                Action::Drag(edits, commit) => {
                    let mut last = before.clone();
                    for edit in &edits {
                        let mut twin = Scene::clone(&before); // each preview starts over
                        if document.preview(edit).is_ok() {
                            edit.apply(&mut twin).expect("as in the preview");
                            last = Arc::new(twin);
                        }
                        prop_assert!(same(document.scene(), &last));
                    }
                    if commit {
                        document.commit_drag("drag");
                        prop_assert!(same(document.scene(), &last));
                        pushed = document.scene().rev != before.rev;
                    } else {
                        document.cancel_drag();
                        prop_assert_eq!(document.scene().rev, before.rev);
                    }
                    prop_assert!(!document.is_dragging());
                }
                Action::Undo => {
                    prop_assert_eq!(document.can_undo(), at > 0);
                    prop_assert_eq!(document.undo_label().is_some(), at > 0);
                    prop_assert_eq!(document.undo().is_some(), at > 0);
                    at = at.saturating_sub(1);
                }
                Action::Redo => {
                    let can = at + 1 < model.len();
                    prop_assert_eq!(document.can_redo(), can);
                    prop_assert_eq!(document.redo().is_some(), can);
                    at += usize::from(can);
                }
                Action::Adopt => {
                    let mut result = before.for_generation().frame().occupancy.clone();
                    result.set(3, 3, 3, 16);
                    let rev = document.adopt(before.content(), result).expect("current");
                    prop_assert_eq!(rev, document.scene().content());
                    prop_assert_eq!(document.scene().frame().occupancy.get(3, 3, 3), 16);
                    prop_assert!(document.adopt(before.content(), VoxelGrid::new()).is_err());
                    model[at] = Scene::clone(document.scene());
                }
                Action::Jump(index) => {
                    prop_assert_eq!(document.jump_to(index), index < model.len());
                    if index < model.len() {
                        at = index;
                    }
                }
            }
            if pushed {
                model.truncate(at + 1);
                model.push(Scene::clone(document.scene()));
                at += 1;
            }
            prop_assert_eq!(document.position(), at);
            prop_assert_eq!(document.history().len(), model.len());
            prop_assert!(same(document.scene(), &model[at]));
            if document.scene().rev == before.rev {
                prop_assert!(same(document.scene(), &before), "same revision, same scene");
            }
        }
        while document.undo().is_some() {}
        prop_assert!(same(document.scene(), &model[0]));
        while document.redo().is_some() {}
        prop_assert!(same(document.scene(), model.last().expect("never empty")));
    }
}

/// Row 27 of the extremes table to the letter: many edits, undo all, the initial scene, in rounds.
#[test]
fn row_27_a_thousand_edits_undone() {
    use proptest::strategy::ValueTree;
    use proptest::test_runner::TestRunner;
    let mut runner = TestRunner::deterministic();
    let strategy = any_edit();
    let mut document = Document::new(start());
    document.set_history_limit(usize::MAX);
    let initial = document.scene().clone();
    let mut applied = 0;
    while applied < 1000 {
        for _ in 0..255 {
            let edit = strategy.new_tree(&mut runner).expect("a value").current();
            let _ = document.apply("edit", &edit); // some are refused; that is part of the test
        }
        let last = document.scene().clone();
        applied += document.position();
        let mut undone = 0;
        while document.undo().is_some() {
            undone += 1;
        }
        assert!(undone > 100, "most edits are sound: {undone}");
        assert_eq!(document.scene().rev, initial.rev);
        assert!(same(document.scene(), &initial));
        assert_eq!(
            document.scene().frame().occupancy.to_dense(),
            initial.frame().occupancy.to_dense()
        );
        while document.redo().is_some() {}
        assert_eq!(document.scene().rev, last.rev);
        assert!(same(document.scene(), &last));
        document.jump_to(0);
    }
}

#[test]
fn a_drag_is_one_step_and_starts_over_each_time() {
    let mut document = Document::new(start());
    let initial = document.scene().clone();
    for step in 1..=20 {
        document.preview(&slide(f64::from(step))).expect("sound");
        assert_eq!(document.history().len(), 1);
        assert!(Arc::ptr_eq(document.settled_scene(), &initial));
    }
    // The refused preview leaves the last one.
    document.preview(&slide(f64::NAN)).expect_err("NaN");
    assert_eq!(document.scene().frame().boxes[&BoxId(1)].center_m.x, 20.0);
    document.commit_drag("Move car");
    assert_eq!(document.undo_label(), Some("Move car"));
    let mut direct = Document::new(start());
    direct.apply("Move car", &slide(20.0)).expect("sound");
    assert!(
        same(document.scene(), direct.scene()),
        "no trace of the way, only of the end"
    );
    // Undo during a drag cancels the drag and nothing else.
    document.preview(&slide(0.0)).expect("sound");
    assert_eq!(document.undo(), None);
    assert_eq!(document.position(), 1);
    assert_eq!(document.undo(), Some("Move car"));
    assert_eq!(document.redo_label(), Some("Move car"));
    // A drag back to the start is no step.
    let here = document.scene().frame().boxes[&BoxId(1)].center_m.x;
    document.preview(&slide(here + 1.0)).expect("sound");
    document.preview(&slide(here)).expect("sound");
    document.commit_drag("Move car");
    assert_eq!((document.position(), document.history().len()), (0, 2));
    document.commit_drag("nothing to commit");
    assert_eq!(document.history().len(), 2);
}

#[test]
fn groups_are_all_or_nothing() {
    let mut document = Document::new(start());
    let before = document.scene().clone();
    let bad = [add(1.0, 1.0), add(2.0, 2.0), Edit::RemoveBox { id: BoxId(99) }];
    document.apply_all("Group", &bad).expect_err("no box 99");
    assert!(Arc::ptr_eq(document.scene(), &before));
    document.apply_all("Group", &bad[..2]).expect("sound");
    assert_eq!(document.history().collect::<Vec<_>>(), ["Open", "Group"]);
    assert_eq!(document.scene().frame().boxes.len(), 5);
    assert_eq!(document.undo(), Some("Group"));
    assert_eq!(document.scene().frame().boxes.len(), 3);
}

#[test]
fn results_settle_their_state_and_late_ones_are_refused() {
    let mut document = Document::new(start());
    document.apply("Cone", &add(0.0, 2.0)).expect("sound");
    let rev = document.scene().content();
    let mut result = VoxelGrid::new();
    result.set(10, 10, 5, Class::Vegetation.id());
    let settled = document.adopt(rev, result.clone()).expect("current");
    assert_ne!(settled, rev);
    assert_eq!(document.history().len(), 2, "no new step");
    let frame = document.scene().canvas().clone();
    assert_eq!(frame.occupancy, result);
    assert_eq!(frame.source.occupancy, result);
    assert_eq!(frame.source.boxes, frame.boxes);
    // Late: another edit, a drag, the old revision.
    assert_eq!(document.adopt(rev, VoxelGrid::new()), Err(Stale));
    document.preview(&slide(3.0)).expect("sound");
    let dragged = document.scene().content();
    assert_eq!(document.adopt(dragged, VoxelGrid::new()), Err(Stale));
    assert_eq!(document.adopt(settled, VoxelGrid::new()), Err(Stale));
    document.cancel_drag();
    // Undo leads to the state before, redo to the settled one.
    document.undo();
    assert_eq!(document.scene().frame().occupancy, start().frame().occupancy);
    document.redo();
    assert_eq!(document.scene().content(), settled);
    assert_eq!(document.scene().canvas().occupancy, result);
}

#[test]
fn saved_and_dirty() {
    let mut document = Document::new(start());
    assert!(!document.is_dirty());
    document.apply("Cone", &add(0.0, 2.0)).expect("sound");
    assert!(document.is_dirty());
    document.undo();
    assert!(!document.is_dirty(), "undone to what the file holds");
    document.redo();
    document.mark_saved();
    assert!(!document.is_dirty());
    document.undo();
    assert!(document.is_dirty());
    document.redo();
    let rev = document.scene().content();
    document.adopt(rev, VoxelGrid::new()).expect("current");
    assert!(document.is_dirty(), "the file lacks the result");
    document.mark_saved();
    assert!(document.show(0.5));
    assert!(!document.is_dirty(), "looking at another moment is no change");
    assert_eq!(document.scene().time_s(), 0.5);
    assert!(!document.show(0.5));
}

/// A job runs while the user looks at another moment: its result is of the same content.
#[test]
fn a_result_is_adopted_whatever_moment_is_shown() {
    let mut document = Document::new(start());
    let asked = document.scene().content();
    assert!(document.show(0.7));
    let mut result = document.scene().for_generation().frame().occupancy.clone();
    result.set(7, 8, 9, Class::Vegetation.id());
    document.adopt(asked, result.clone()).expect("the same content");
    let scene = document.scene();
    assert_eq!(scene.time_s(), 0.7);
    assert_eq!(
        scene.at(0.0).frame().occupancy.get(7, 8, 9),
        Class::Vegetation.id()
    );
    assert_eq!(scene.canvas().occupancy, result);
    // Adopted or edited since, it is too late.
    assert_eq!(document.adopt(asked, result.clone()), Err(Stale));
    let asked = document.scene().content();
    document
        .apply("Remove", &Edit::RemoveBox { id: BoxId(1) })
        .expect("there");
    assert_eq!(document.adopt(asked, result), Err(Stale));
    // Undo keeps the moment.
    document.undo();
    assert_eq!(document.scene().time_s(), 0.7);
}

#[test]
fn history_is_bounded() {
    let mut document = Document::new(start());
    for i in 0..600 {
        document
            .apply(
                "Prompt",
                &Edit::SetPrompt {
                    prompt: i.to_string(),
                },
            )
            .expect("always");
    }
    while document.undo().is_some() {}
    // A new edit drops what could be redone.
    document
        .apply("Prompt", &Edit::SetPrompt { prompt: "x".into() })
        .expect("always");
    assert!(!document.can_redo());
    assert_eq!(document.history().len(), 2);
}

/// Memory bounds the history, not the number of steps: many small ones stay, few large ones.
#[test]
fn the_history_is_bounded_by_bytes() {
    let paint = |i: usize, all: bool| Edit::PaintVoxels {
        cells: match all {
            true => (0..Extent::WINDOW.nx())
                .flat_map(|x| (0..Extent::WINDOW.ny()).map(move |y| [x, y, 3]))
                .collect(),
            false => vec![[i % Extent::WINDOW.nx(), 7, 9]],
        },
        class: [Class::Car, Class::Bus][i % 2],
    };
    let limit = 8 << 20;
    let run = |all: bool, steps: usize| {
        let mut document = Document::new(start());
        document.set_history_limit(limit);
        for i in 0..steps {
            document.apply("Paint", &paint(i, all)).expect("sound");
            assert!(
                document.history_bytes() <= limit || document.position() <= Document::LEAST_UNDO,
                "step {i}: {} bytes",
                document.history_bytes()
            );
            // The count follows the steps that are left.
            let counted: usize = document.steps[1..]
                .iter()
                .zip(&document.steps)
                .map(|(step, before)| {
                    let ops: usize = step.ops.iter().map(Op::bytes).sum();
                    step.scene.bytes_beside(&before.scene) + ops
                })
                .sum();
            assert_eq!(counted, document.history_bytes());
        }
        document
    };
    let small = run(false, 200);
    assert_eq!(small.history().len(), 201, "nothing had to go");
    // Every brick twice, occupancy and paint, and the cells of the edit: 2.4 MB a step.
    let mut large = run(true, 40);
    assert_eq!(
        large.position(),
        Document::LEAST_UNDO,
        "the last ones can be undone in any case"
    );
    let mut undone = 0;
    while large.undo().is_some() {
        undone += 1;
    }
    assert_eq!(undone, Document::LEAST_UNDO);
    // Room for more is of use to what comes; less lets go of the oldest at once.
    large.set_history_limit(usize::MAX);
    for i in 0..20 {
        large.apply("Paint", &paint(i, true)).expect("sound");
    }
    assert_eq!(large.position(), 20);
    large.set_history_limit(28 << 20);
    assert!(
        large.history_bytes() <= 28 << 20 && (9..15).contains(&large.position()),
        "{}",
        large.position()
    );
    // A result that is adopted counts with its step, and what comes after it too.
    let mut grid = large.scene().for_generation().frame().occupancy.clone();
    (0..Extent::WINDOW.nx()).for_each(|x| grid.set(x, 9, 9, Class::Vegetation.id()));
    let before = large.history_bytes();
    large.adopt(large.scene().content(), grid).expect("shown");
    assert_ne!(large.history_bytes(), before);
}

#[test]
fn what_was_inpainted_can_be_undone() {
    let mut document = Document::new(start());
    let before = document.scene().clone();
    let mut occupancy = before.for_generation().frame().occupancy.clone();
    occupancy.set(3, 4, 5, Class::Manmade.id());
    let rev = document
        .adopt_as_step("Generate", before.content(), occupancy.clone())
        .expect("shown");
    assert_eq!(document.scene().content(), rev);
    assert_eq!(document.scene().canvas().occupancy, occupancy);
    assert_eq!(document.scene().canvas().source.occupancy, occupancy);
    assert_eq!(document.undo(), Some("Generate"));
    assert_eq!(document.scene().content(), before.content());
    assert_eq!(document.scene().frame().occupancy, before.frame().occupancy);
    assert_eq!(document.redo(), Some("Generate"));
    // Too late: another state is shown by now.
    assert_eq!(
        document.adopt_as_step("Generate", before.content(), occupancy),
        Err(Stale)
    );
}
