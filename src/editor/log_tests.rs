//! Tests of the log: a history that was written and replayed is the same, steps leave it and come back, editors undo their own.

use proptest::prelude::*;

use super::*;
use crate::document::tests::{add, any_edit, slide, start};
use scene::background::{Tree, TreeKind};
use scene::{BoxId, Edit, Form, ThingId, VoxelGrid};

/// An action on a document with its log.
#[derive(Clone, Debug)]
enum Action {
    Apply(Edit),
    Things(Vec<Edit>),
    Drag(Edit, Edit),
    Adopt(u8),
    AdoptAsStep(u8),
    Restore,
    Show(f64),
    Undo,
    Redo,
    Jump(usize),
    LeaveOut(usize),
    UndoAs(bool),
    RedoAs(bool),
}

fn tree(x: f64) -> Form {
    Form::Tree(Tree {
        position_m: glam::DVec2::new(x, 12.0),
        height_m: 6.0,
        crown_radius_m: 1.5,
        kind: TreeKind::Conifer,
    })
}

fn any_thing_edit() -> impl Strategy<Value = Edit> {
    let forms = || prop::collection::vec((-20.0..20.0f64).prop_map(tree), 1..3);
    let ids = prop::collection::vec((1u32..6).prop_map(ThingId), 1..3);
    prop_oneof![
        2 => forms().prop_map(|forms| Edit::AddThings { forms }),
        1 => forms().prop_map(|forms| Edit::DrawScenery { forms }),
        2 => ids.prop_map(|ids| Edit::RemoveThings { ids }),
    ]
}

fn any_action() -> impl Strategy<Value = Action> {
    prop_oneof![
        6 => any_edit().prop_map(Action::Apply),
        3 => prop::collection::vec(any_thing_edit(), 1..4).prop_map(Action::Things),
        2 => (any_edit(), any_edit()).prop_map(|(a, b)| Action::Drag(a, b)),
        2 => (0u8..16).prop_map(Action::Adopt),
        1 => (0u8..16).prop_map(Action::AdoptAsStep),
        1 => Just(Action::Restore),
        1 => (0.0..1.0f64).prop_map(Action::Show),
        3 => Just(Action::Undo),
        1 => Just(Action::Redo),
        1 => (0usize..12).prop_map(Action::Jump),
        2 => (0usize..12).prop_map(Action::LeaveOut),
        1 => any::<bool>().prop_map(Action::UndoAs),
        1 => any::<bool>().prop_map(Action::RedoAs),
    ]
}

fn result(document: &Document, at: u8) -> VoxelGrid {
    let mut result = document.scene().for_generation().frame().occupancy.clone();
    let at = usize::from(at);
    result.set(90 + at, 100, at, 16);
    result.set(3, 3, 3, at as u8);
    result
}

/// Actions may be refused; that is part of the test.
fn act(document: &mut Document, action: Action) {
    let content = document.settled_scene().content();
    let author = |user: bool| if user { Author::USER } else { Author::ASSISTANT };
    match action {
        Action::Apply(edit) => drop(document.apply("apply", &edit)),
        Action::Things(edits) => drop(document.apply_all("things", &edits)),
        Action::Drag(first, last) => {
            drop(document.preview(&first));
            drop(document.preview(&last));
            document.commit_drag("drag");
        }
        Action::Adopt(at) => {
            let _ = document.adopt(content, result(document, at));
        }
        Action::AdoptAsStep(at) => {
            let occupancy = result(document, at);
            let _ = document.adopt_as_step("generate", content, occupancy);
        }
        Action::Restore => {
            let mut scene = start();
            scene.prompt = "another".into();
            document.restore("restore", &scene);
        }
        Action::Show(time_s) => {
            document.show(time_s);
        }
        Action::Undo => drop(document.undo()),
        Action::Redo => drop(document.redo()),
        Action::Jump(index) => {
            document.jump_to(index);
        }
        Action::LeaveOut(index) => drop(document.leave_out(index)),
        Action::UndoAs(user) => {
            let before = document.set_author(author(user));
            drop(document.undo_own());
            document.set_author(before);
        }
        Action::RedoAs(user) => {
            let before = document.set_author(author(user));
            drop(document.redo_own());
            document.set_author(before);
        }
    }
}

/// Every state of two documents, and the moment that is shown.
fn assert_same(a: &Document, b: &Document) {
    assert_eq!(a.position(), b.position());
    assert_eq!(a.history().collect::<Vec<_>>(), b.history().collect::<Vec<_>>());
    for (i, (a, b)) in a.steps.iter().zip(&b.steps).enumerate() {
        assert!(a.scene.is_same(&b.scene), "step {i}");
    }
}

fn reopened(document: &Document) -> Document {
    let (again, problem) = Document::open(document.to_save());
    assert_eq!(problem, None);
    again
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(40))]

    /// Whatever a session does, its log leads to the same states, and the session goes on from there.
    #[test]
    fn a_log_leads_to_the_same_states(
        first in prop::collection::vec(any_action(), 1..45),
        then in prop::collection::vec(any_action(), 1..10),
    ) {
        let mut document = Document::new(start());
        first.into_iter().for_each(|action| act(&mut document, action));
        let mut again = reopened(&document);
        assert_same(&document, &again);
        prop_assert_eq!(document.replays(), Ok(true));
        // What loses its oldest steps still leads to the same states.
        document.set_history_limit(1);
        assert_same(&document, &reopened(&document));
        then.into_iter().for_each(|action| act(&mut again, action));
        assert_same(&again, &reopened(&again));
    }
}

fn steps(document: &Document) -> Vec<(&str, bool)> {
    let steps = document.history_steps().into_iter();
    steps.map(|step| (step.label, step.is_left_out)).collect()
}

#[test]
fn a_step_is_left_out_and_comes_back() {
    let mut document = Document::new(start());
    document.apply("Cone", &add(0.0, 3.0)).expect("sound");
    let cone = *document.scene().frame().boxes.keys().max().expect("boxes");
    document.apply("Slide", &slide(4.0)).expect("sound");
    let move_cone = Edit::MoveBox {
        id: cone,
        center_m: Some(glam::DVec3::new(2.0, 3.0, 0.5)),
        yaw_deg: None,
        size_m: None,
    };
    document.apply("Move cone", &move_cone).expect("sound");
    let with_cone = document.scene().clone();
    let left = document.leave_out(1).expect("a step");
    assert_eq!(left.label, "Cone");
    assert!(left.changed);
    assert_eq!(
        left.skipped,
        [format!("Move cone: box {} does not exist in this frame", cone.0)]
    );
    let boxes = &document.scene().frame().boxes;
    assert!(!boxes.contains_key(&cone));
    assert_eq!(boxes[&BoxId(1)].center_m.x, 4.0, "what came later stays");
    let mut never = Document::new(start());
    never.apply("Slide", &slide(4.0)).expect("sound");
    assert!(document.scene().is_same(never.scene()), "as if it had never been");
    assert_eq!(
        steps(&document),
        [
            ("Open", false),
            ("Cone", true),
            ("Slide", false),
            ("Move cone", false),
            ("Leave out a step", false)
        ]
    );
    assert_eq!(document.leave_out(1), Err(LeaveOutError::Already(1)));
    assert_eq!(document.leave_out(4), Err(LeaveOutError::LeavesOut(4)));
    assert_eq!(
        document.leave_out(0),
        Err(LeaveOutError::NoStep { found: 0, most: 4 })
    );
    assert_eq!(
        document.leave_out(9),
        Err(LeaveOutError::NoStep { found: 9, most: 4 })
    );
    assert_eq!(document.undo(), Some("Leave out a step"));
    assert!(document.scene().is_same(&with_cone));
    // A step that a later one replaces leaves nothing behind.
    document.restore("Go to version", &start());
    let left = document.leave_out(2).expect("a step");
    assert!(!left.changed);
    assert_eq!(document.history().len(), 5, "no step");
}

/// A result goes with its edit, and another edit's result fits where nothing else is.
#[test]
fn results_follow_their_edits() {
    let mut document = Document::new(start());
    document.apply("Cone", &add(0.0, 3.0)).expect("sound");
    let content = document.scene().content();
    document.adopt(content, result(&document, 1)).expect("shown");
    document.apply("Slide", &slide(4.0)).expect("sound");
    let content = document.scene().content();
    document.adopt(content, result(&document, 2)).expect("shown");
    let left = document.leave_out(1).expect("a step");
    assert_eq!(left.skipped, ["Slide: 1 voxels of its result do not fit"]);
    let occupancy = &document.scene().canvas().occupancy;
    assert_eq!([occupancy.get(91, 100, 1), occupancy.get(92, 100, 2)], [17, 16]);
    assert_same(&document, &reopened(&document));
}

/// An undone step may get its result late: what can be redone was made without it.
#[test]
fn a_late_result_leaves_what_can_be_redone() {
    let mut document = Document::new(start());
    document.apply("Cone", &add(0.0, 3.0)).expect("sound");
    document.apply("Slide", &slide(4.0)).expect("sound");
    let end = document.scene().clone();
    document.undo();
    let content = document.scene().content();
    document.adopt(content, result(&document, 5)).expect("shown");
    let mut again = reopened(&document);
    assert_same(&document, &again);
    assert_eq!(again.redo(), Some("Slide"));
    assert!(again.scene().is_same(&end));
    // A result of the state that was opened is part of it.
    let mut document = Document::new(start());
    document
        .adopt(document.scene().content(), result(&document, 5))
        .expect("shown");
    let again = reopened(&document);
    assert_same(&document, &again);
    assert!(!again.can_undo() && !again.is_dirty());
}

#[test]
fn editors_undo_their_own_steps() {
    let mut document = Document::new(start());
    document.apply("Mine", &add(0.0, 3.0)).expect("sound");
    document.set_author(Author::ASSISTANT);
    document.apply("Theirs", &slide(4.0)).expect("sound");
    document.set_author(Author::USER);
    assert_eq!(document.undo_own_label(), Some("Mine"));
    assert!(matches!(document.undo_own(), Some(Undone::LeftOut(left)) if left.label == "Mine"));
    let boxes = &document.scene().frame().boxes;
    assert_eq!((boxes.len(), boxes[&BoxId(1)].center_m.x), (3, 4.0));
    assert_eq!(document.redo_own_label(), Some("Mine"));
    assert_eq!(document.redo_own().as_deref(), Some("Mine"));
    assert_eq!(document.scene().frame().boxes.len(), 4);
    assert_eq!(document.redo_own_label(), None);
    // The assistant has one step and no more.
    document.set_author(Author::ASSISTANT);
    assert_eq!(document.undo_own(), Some(Undone::Back("Theirs".into())));
    assert_eq!(document.undo_own(), None);
    assert_eq!(document.redo_own().as_deref(), Some("Theirs"));
    // The user takes back the others' too once there is nothing else, and in the end the scene is as it was opened.
    document.set_author(Author::USER);
    document.undo_own().expect("mine");
    assert_eq!(document.undo_own_label(), Some("Theirs"));
    document.undo_own().expect("theirs");
    assert_eq!(document.undo_own(), None);
    assert!(document.scene().is_same(&start()));
    // Steps of an earlier session are the user's.
    let mut document = reopened(&document);
    document.jump_to(2);
    assert_eq!(document.undo_own(), Some(Undone::Back("Theirs".into())));
}

fn with_log(change: impl FnOnce(&mut OpLog)) -> Scene {
    let mut document = Document::new(start());
    document.apply("Cone", &add(0.0, 3.0)).expect("sound");
    document.apply("Slide", &slide(4.0)).expect("sound");
    document.apply("Slide", &slide(5.0)).expect("sound");
    document.leave_out(1).expect("a step");
    let mut scene = document.to_save();
    let mut log = OpLog::clone(&document.log().expect("changes"));
    change(&mut log);
    Arc::make_mut(&mut scene.kept).log = Some(Arc::new(log));
    scene
}

/// Opens a scene with a log that is not sound: the scene is there, and a line says what is wrong.
fn refused(change: impl FnOnce(&mut OpLog)) -> (Document, String) {
    let scene = with_log(change);
    let (document, problem) = Document::open(scene.clone());
    assert!(document.scene().is_same(&scene), "nothing is lost");
    assert!(!document.is_dirty());
    let problem = problem.expect("a line");
    assert!(!problem.contains('\n') && problem.len() < 160, "{problem}");
    (document, problem)
}

#[test]
fn a_log_that_is_not_sound_costs_the_history_alone() {
    let (document, problem) = refused(|log| log.ops[2].parent = Some(OpId(77)));
    assert!(
        problem.contains("follows change 77, which is not before it"),
        "{problem}"
    );
    assert!(!document.can_undo());
    let (_, problem) = refused(|log| log.ops[1].parent = Some(log.ops[2].id));
    assert!(problem.contains("not before it"), "{problem}");
    refused(|log| log.ops[1].id = log.ops[0].id);
    refused(|log| log.ops[1].joins = true);
    refused(|log| log.ops[2].shown_s = f64::NAN);
    refused(|log| log.ops[0].id = OpId(u64::MAX));
    refused(|log| {
        log.ops[3].change = Change::Without {
            ops: vec![OpId(99)],
            is_undo: false,
        }
    });
    refused(|log| log.ops = vec![log.ops[0].clone(); OpLog::MAX_OPS + 1]);
    refused(|log| log.at = 5);
    // Sound, but of another state: as far as it goes, then the scene of the file.
    let (mut document, problem) = refused(|log| {
        log.ops[1].change = Change::Edits {
            edits: [slide(f64::NAN)].into(),
            things_from: None,
        };
    });
    assert!(problem.contains("breaks off: \"Slide\""), "{problem}");
    assert_eq!(document.history().last(), Some("Changed outside the history"));
    assert_eq!(document.undo(), Some("Changed outside the history"));
    assert_eq!(document.undo(), Some("Cone"));
    let (document, problem) = refused(|log| drop(log.ops.pop()));
    assert!(problem.contains("step 4 is shown"), "{problem}");
    assert!(!document.can_undo());
    let (document, problem) = refused(|log| log.at = 2);
    assert!(problem.contains("outside"), "{problem}");
    assert_eq!(document.history().len(), 6);
}

#[test]
fn a_foreign_author_is_one_among_others() {
    let scene = with_log(|log| log.ops[1].author = Author("somebody".into()));
    let (mut document, problem) = Document::open(scene);
    assert_eq!(problem, None);
    let authors: Vec<&str> = document
        .history_steps()
        .iter()
        .filter_map(|s| Some(s.author?.name()))
        .collect();
    assert_eq!(authors, ["user", "somebody", "user", "user"]);
    while document.undo_own().is_some() {}
    assert!(document.scene().is_same(&start()));
}

/// A copy that was edited and generated elsewhere becomes one step, with its changes.
#[test]
fn a_document_takes_over_what_a_copy_did() {
    let mut document = Document::new(start());
    document.apply("Slide", &slide(4.0)).expect("sound");
    let mut copy = Document::new(Scene::clone(document.settled_scene()));
    copy.apply("Draw", &add(0.0, 3.0)).expect("sound");
    copy.adopt(copy.scene().content(), result(&copy, 3))
        .expect("shown");
    let end = copy.scene().clone();
    document.take_over("Generate", copy).expect("of that state");
    assert_eq!(
        steps(&document),
        [("Open", false), ("Slide", false), ("Generate", false)]
    );
    assert!(document.scene().is_same(&end));
    assert_same(&document, &reopened(&document));
    document
        .take_over("Generate", Document::new(start()))
        .expect_err("of another state");
    // Nothing done is no step.
    let idle = Document::new(Scene::clone(document.settled_scene()));
    document.take_over("Generate", idle).expect("of that state");
    assert_eq!(document.history().len(), 3);
}

/// A result alone, which a copy adopted into the state that it began with, is a step too.
#[test]
fn a_result_alone_is_taken_over() {
    let mut document = Document::new(start());
    let mut copy = Document::new(Scene::clone(document.settled_scene()));
    copy.adopt(copy.scene().content(), result(&copy, 3))
        .expect("shown");
    let end = copy.scene().clone();
    document.take_over("Generate", copy).expect("of that state");
    assert_eq!(document.undo_label(), Some("Generate"));
    assert!(document.scene().is_same(&end));
    assert_same(&document, &reopened(&document));
}

/// Boxes and things keep their numbers, whatever is left out before them.
#[test]
fn numbers_stay_when_an_earlier_step_is_left_out() {
    let mut document = Document::new(start());
    for (name, y) in [("A", 3.0), ("B", 4.0), ("C", 5.0)] {
        document.apply(name, &add(0.0, y)).expect("sound");
    }
    let b = BoxId(5);
    let moved = Edit::MoveBox {
        id: b,
        center_m: Some(glam::DVec3::new(9.0, 4.0, 0.5)),
        yaw_deg: None,
        size_m: None,
    };
    document.apply("Move B", &moved).expect("sound");
    assert_eq!(document.leave_out(1).expect("a step").skipped, [""; 0]);
    let boxes = &document.scene().frame().boxes;
    assert_eq!(boxes.keys().map(|id| id.0).collect::<Vec<_>>(), [1, 2, 3, 5, 6]);
    assert_eq!((boxes[&b].center_m.x, boxes[&BoxId(6)].center_m.x), (9.0, 0.0));
    assert_same(&document, &reopened(&document));
    // The same of things.
    let tree = |x: f64| Edit::AddThings { forms: vec![tree(x)] };
    let mut document = Document::new(start());
    document.apply("A", &tree(0.0)).expect("sound");
    document.apply("B", &tree(5.0)).expect("sound");
    document.leave_out(1).expect("a step");
    document.apply("C", &tree(9.0)).expect("sound");
    let ids: Vec<u32> = document
        .scene()
        .background
        .iter()
        .map(|thing| thing.id.0)
        .collect();
    assert_eq!(ids, [2, 3]);
    assert_same(&document, &reopened(&document));
    // Scenery that is drawn anew takes the numbers of the old.
    let again = [
        Edit::RemoveThings {
            ids: vec![ThingId(2), ThingId(3)],
        },
        tree(1.0),
        tree(2.0),
    ];
    document.apply_all("Draw scenery", &again).expect("sound");
    assert_same(&document, &reopened(&document));
}

/// A step that the history has forgotten stays left out.
#[test]
fn a_forgotten_step_stays_left_out() {
    let mut document = Document::new(start());
    for y in 0..3 {
        document
            .apply(format!("{y}"), &add(0.0, f64::from(y) + 3.0))
            .expect("sound");
    }
    document.leave_out(1).expect("a step");
    for x in 0..6 {
        document.apply("Slide", &slide(f64::from(x))).expect("sound");
    }
    let end = document.scene().clone();
    document.set_history_limit(1);
    assert_eq!(document.position(), Document::LEAST_UNDO);
    assert_eq!(document.replays(), Ok(true));
    let mut again = reopened(&document);
    assert_same(&document, &again);
    assert!(again.scene().is_same(&end));
    // What lies before a state as a whole has no effect of its own.
    assert!(!again.leave_out(1).expect("a step").changed);
}

/// Steps that cannot be taken back from under others are passed over.
#[test]
fn undo_passes_over_steps_that_are_replaced() {
    let mut document = Document::new(start());
    document.apply("Mine", &slide(4.0)).expect("sound");
    document.set_author(Author::ASSISTANT);
    let mut other = start();
    other.prompt = "another".into();
    document.restore("Open another", &other);
    document.set_author(Author::USER);
    assert_eq!(document.undo_own(), Some(Undone::Back("Open another".into())));
    assert_eq!(document.undo_own(), Some(Undone::Back("Mine".into())));
    assert_eq!(document.undo_own(), None);
    document.jump_to(2);
    document
        .apply("Words", &Edit::SetPrompt { prompt: "x".into() })
        .expect("sound");
    assert_eq!(document.leave_out(2), Err(LeaveOutError::Whole(2)));
    document.set_author(Author::ASSISTANT);
    assert_eq!(document.undo_own(), None, "the user went on from there");
}

#[test]
fn undo_takes_back_that_a_step_was_left_out() {
    let mut document = Document::new(start());
    document.apply("A", &add(0.0, 3.0)).expect("sound");
    document.apply("B", &slide(4.0)).expect("sound");
    let both = document.scene().clone();
    document.leave_out(1).expect("a step");
    assert_eq!(document.undo_own_label(), Some("Leave out a step"));
    assert_eq!(document.undo_own(), Some(Undone::Back("Leave out a step".into())));
    assert!(document.scene().is_same(&both));
    assert_eq!(document.redo_own().as_deref(), Some("Leave out a step"));
}

/// Cells are counted from the corner of the map, and roads from those before them.
#[test]
fn what_an_earlier_step_numbered_is_named() {
    let mut document = Document::new(start());
    let longer = Edit::ExtendMap {
        ahead_m: 0.0,
        behind_m: 8.0,
        left_m: 0.0,
        right_m: 0.0,
    };
    document.apply("Longer", &longer).expect("sound");
    let paint = Edit::PaintVoxels {
        cells: vec![[100, 100, 3]],
        class: scene::Class::Manmade,
    };
    document.apply("Paint", &paint).expect("sound");
    let left = document.leave_out(1).expect("a step");
    assert_eq!(
        left.skipped,
        ["Paint: it is of voxels of the map as an earlier change left it"]
    );
}

/// Versions and typed texts of a file stay with all its states.
#[test]
fn the_file_keeps_its_versions_whatever_step_is_shown() {
    let mut scene = start();
    Arc::make_mut(&mut scene.kept).typed.push("add a car".into());
    let mut document = Document::new(scene);
    document.apply("A", &add(0.0, 3.0)).expect("sound");
    document.apply("B", &slide(4.0)).expect("sound");
    let mut again = reopened(&document);
    assert_eq!(again.to_save().kept.typed, ["add a car"]);
    again.leave_out(1).expect("a step");
    assert_eq!(again.to_save().kept.typed, ["add a car"]);
    again.jump_to(0);
    assert_eq!(again.to_save().kept.typed, ["add a car"]);
}
