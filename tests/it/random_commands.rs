//! Many thousand random commands on a document: whatever is edited, dragged, undone, refused or generated, the scene
//! stays sound after every one of them, and undo visits the states that were there.
//! `SCENELOOM_RANDOM_COMMANDS` sets their number, `SCENELOOM_RANDOM_SEED` the seed.

use std::collections::BTreeMap;
use std::sync::Arc;

use app::open;
use editor::{Document, Edit, Shape};
use glam::{DVec2, DVec3};
use numeric::splitmix::SplitMix64;
use scene::grid::NOT_PAINTED;
use scene::{BevLayer, BoxId, Class, Frame, Key, Motion, Scene, SceneBox, SceneRev, Scope, Window};

const COMMANDS: u64 = 10_000;
/// States are compared voxel by voxel at every so many commands; by everything else at each.
const DEEP_EVERY: u64 = 25;

/// Draws of what a user might do.
struct Random(SplitMix64);

impl Random {
    fn below(&mut self, n: usize) -> usize {
        self.0.below(n)
    }
    fn one_in(&mut self, n: usize) -> bool {
        self.below(n) == 0
    }
    fn unit(&mut self) -> f64 {
        self.0.unit()
    }
    /// Now and then something that no user could type.
    fn number(&mut self, low: f64, high: f64) -> f64 {
        match self.below(60) {
            0 => f64::NAN,
            1 => f64::INFINITY,
            2 => -1e300,
            3 => 1e-300,
            _ => low + (high - low) * self.unit(),
        }
    }
    fn point(&mut self) -> DVec2 {
        DVec2::new(self.number(-45.0, 45.0), self.number(-45.0, 45.0))
    }
    fn of<T: Copy>(&mut self, all: &[T]) -> T {
        all[self.below(all.len())]
    }
}

fn some_box(random: &mut Random, scene: &Scene) -> BoxId {
    let ids: Vec<BoxId> = scene.frame().boxes.keys().copied().collect();
    match ids.is_empty() || random.one_in(12) {
        true => BoxId(random.of(&[0, 1, 999, u32::MAX])),
        false => random.of(&ids),
    }
}

fn shape(random: &mut Random) -> Shape {
    match random.below(5) {
        0 => Shape::Disc {
            center_m: random.point(),
            radius_m: random.number(0.0, 6.0),
        },
        1 => Shape::Rect {
            min_m: random.point(),
            max_m: random.point(),
        },
        2 => Shape::Polygon {
            points_m: (0..random.below(7)).map(|_| random.point()).collect(),
        },
        3 => Shape::Line {
            points_m: (0..random.below(5)).map(|_| random.point()).collect(),
            width_m: random.number(0.0, 4.0),
        },
        _ => Shape::Cells(
            (0..random.below(20))
                .map(|_| [random.below(203), random.below(203)])
                .collect(),
        ),
    }
}

fn cells(random: &mut Random) -> Vec<[usize; 3]> {
    let at = [random.below(202), random.below(202), random.below(17)];
    let n = random.below(40);
    (0..n)
        .map(|_| {
            [
                at[0] + random.below(4),
                at[1] + random.below(4),
                (at[2] + random.below(3)) % 17,
            ]
        })
        .collect()
}

fn edit(random: &mut Random, scene: &Scene) -> Edit {
    let center = |random: &mut Random| random.point().extend(random.number(-1.0, 4.0));
    let size = |random: &mut Random| {
        DVec3::new(
            random.number(0.2, 13.0),
            random.number(0.2, 3.0),
            random.number(0.2, 4.0),
        )
    };
    match random.below(16) {
        13 | 14 => {
            let times = [0.0, random.number(0.1, 3.0), random.number(0.1, 3.0)];
            let key = |time_s: &f64| Key {
                time_s: *time_s,
                at_m: random.point(),
                yaw_deg: random.number(-400.0, 400.0),
            };
            let keys: Vec<Key> = times.iter().map(key).collect();
            Edit::SetMotion {
                id: (!random.one_in(4)).then(|| some_box(random, scene)),
                motion: (!random.one_in(4)).then_some(Motion::Keys(keys)),
                from_s: random.one_in(5).then(|| random.number(0.0, 3.0)),
                to_s: random.one_in(5).then(|| random.number(0.0, 3.0)),
            }
        }
        15 => Edit::At {
            frame: None,
            time_s: random.one_in(2).then(|| random.number(0.0, 3.2)),
            track: None,
            scope: Some(random.of(&Scope::ALL)),
            edit: Box::new(edit(random, scene)),
        },
        0 | 1 => Edit::AddBox {
            class: match random.one_in(10) {
                true => random.of(&Class::ALL),
                false => random.of(&Class::OBJECTS),
            },
            center_m: center(random),
            size_m: size(random),
            yaw_deg: random.number(-720.0, 720.0),
            velocity_mps: random.one_in(2).then(|| random.point()),
            id: random.one_in(4).then(|| BoxId(random.below(60) as u32)),
            label: Default::default(),
        },
        2 | 3 => Edit::RemoveBox {
            id: some_box(random, scene),
        },
        4 | 5 => Edit::MoveBox {
            id: some_box(random, scene),
            center_m: random.one_in(2).then(|| center(random)),
            yaw_deg: random.one_in(2).then(|| random.number(-200.0, 200.0)),
            size_m: random.one_in(3).then(|| size(random)),
        },
        6 => Edit::SetBoxClass {
            id: some_box(random, scene),
            class: random.of(&Class::ALL),
        },
        7 | 8 => Edit::PaintBev {
            layer: match random.one_in(10) {
                true => BevLayer::Car,
                false => random.of(&BevLayer::MAP),
            },
            shape: shape(random),
            value: random.one_in(2),
        },
        9 => Edit::PaintVoxels {
            cells: cells(random),
            class: random.of(&Class::ALL),
        },
        10 => match random.below(4) {
            0 => Edit::ClearPaint {},
            1 => Edit::ConfirmInferred {},
            _ => Edit::UnlockVoxels { cells: cells(random) },
        },
        11 => Edit::SetPrompt {
            prompt: random.of(&["", "rain", "night, fog", "a\u{0}b\nc", "雨"]).into(),
        },
        _ => {
            let inner = edit(random, scene);
            Edit::Correct {
                edit: Box::new(inner),
            }
        }
    }
}

/// What must hold for every scene that a document shows.
fn sweep(scene: &Scene) {
    assert_eq!(scene.clip().problem(), None);
    assert!((0.0..=scene.clip().length_s).contains(&scene.time_s()));
    assert_eq!(scene.rig.problem(), None);
    for frame in [scene.canvas(), scene.frame()] {
        frame_is_sound(frame);
    }
}

fn frame_is_sound(frame: &Frame) {
    for boxes in [&frame.boxes, &frame.source.boxes] {
        for (id, b) in boxes {
            assert_eq!((b.id, b.problem()), (*id, None));
        }
    }
    assert!(
        frame.inferred.boxes.iter().all(|id| frame.boxes.contains_key(id)),
        "a guess without a box"
    );
    for layout in [&frame.layout, &frame.source.layout] {
        assert_eq!(layout.cells().len(), Window::COLUMNS);
        assert!(
            layout.cells().iter().all(|c| c >> BevLayer::MAP.len() == 0),
            "bits of objects in the map"
        );
    }
    assert_eq!(frame.occupancy.bricks().len(), 13 * 13);
    assert_eq!(frame.painted.bricks().len(), 13 * 13);
}

/// The grids: labels within the palette, paint shown as it was painted, nothing beyond the grid's last row.
fn grids_are_sound(frame: &Frame) {
    for (x, y, z, label) in frame.occupancy.iter_set() {
        assert!(
            label < Class::FREE && x < Window::NX && y < Window::NY,
            "{label} at {x}, {y}, {z}"
        );
    }
    for (x, y, z, class) in frame.painted.iter_set() {
        assert!(class <= Class::FREE && class != NOT_PAINTED);
        assert_eq!(frame.occupancy.get(x, y, z), class, "painted voxel {x}, {y}, {z}");
    }
}

/// Everything of a state but its grids' contents, which share their memory where they are equal.
fn same(a: &Scene, b: &Scene, deep: bool) -> bool {
    let grids = |a: &Frame, b: &Frame| match deep {
        true => a.occupancy == b.occupancy && a.painted == b.painted && a.layout == b.layout,
        false => a.occupancy.changed_bricks(&b.occupancy).is_empty(),
    };
    let boxes = |f: &Frame| -> BTreeMap<BoxId, SceneBox> { f.boxes.clone() };
    a.prompt == b.prompt
        && a.clip() == b.clip()
        && boxes(a.canvas()) == boxes(b.canvas())
        && grids(a.canvas(), b.canvas())
        && boxes(a.frame()) == boxes(b.at(a.time_s()).frame())
}

/// What the document should hold: the states by step, kept apart from it.
struct Model {
    states: Vec<Arc<Scene>>,
    at: usize,
}

impl Model {
    fn note(&mut self, document: &Document) {
        let now = document.settled_scene();
        if now.content() == self.states[self.at].content() {
            return; // refused, or it changed nothing
        }
        self.states.truncate(self.at + 1);
        self.states.push(now.clone());
        self.at += 1;
        // Memory bounds the history: the oldest states go, and only as many as it takes.
        let gone = self.states.len().saturating_sub(document.history().len());
        if gone > 0 {
            assert!(document.position() >= Document::LEAST_UNDO);
            self.states.drain(..gone);
            self.at -= gone;
        }
    }
}

fn env(name: &str, default: u64) -> u64 {
    std::env::var(name)
        .ok()
        .and_then(|v| v.parse().ok())
        .unwrap_or(default)
}

/// Some previews, then let go or given up.
fn drag(document: &mut Document, model: &mut Model, random: &mut Random, before: &Scene) {
    for _ in 0..1 + random.below(5) {
        let edit = edit(random, before);
        let was = document.scene().rev;
        if document.preview(&edit).is_err() {
            assert_eq!(document.scene().rev, was, "a refused preview shows");
        }
        assert_eq!(document.settled_scene().rev, before.rev, "a preview is no step");
        sweep(document.scene());
    }
    match random.below(4) {
        0 => document.cancel_drag(),
        1 => {
            let dragging = document.is_dragging();
            let label = document.undo();
            assert!(
                !dragging || label.is_none(),
                "undo ends the drag and nothing else"
            );
            if !dragging && label.is_some() {
                model.at -= 1;
            }
        }
        _ => document.commit_drag("Drag"),
    }
    document.cancel_drag();
    model.note(document);
}

/// The invariants, after command `i`.
fn check(document: &Document, model: &Model, i: u64) {
    assert!(!document.is_dragging());
    assert_eq!(document.history().len(), model.states.len(), "command {i}");
    assert!(document.history().len() <= Document::MAX_STEPS);
    assert_eq!(document.position(), model.at, "command {i}");
    let deep = i.is_multiple_of(DEEP_EVERY);
    let (shown, expected) = (document.scene(), &model.states[model.at]);
    assert_eq!(shown.content(), expected.content(), "command {i}");
    assert!(
        same(shown, expected, deep),
        "command {i}: not the state that was there"
    );
    sweep(shown);
    if deep {
        [shown.canvas(), shown.frame()]
            .iter()
            .for_each(|f| grids_are_sound(f));
    }
}

#[test]
fn random_commands_break_nothing() {
    let (commands, seed) = (
        env("SCENELOOM_RANDOM_COMMANDS", COMMANDS),
        env("SCENELOOM_RANDOM_SEED", 1),
    );
    let mut random = Random(SplitMix64::new(seed));
    let mut start = open::bundled().expect("bundled");
    start.change_clip(|clip| clip.length_s = 3.0);
    let mut document = Document::new(start);
    let mut model = Model {
        states: vec![document.scene().clone()],
        at: 0,
    };
    let (mut applied, mut refused, mut undone) = (0u64, 0u64, 0u64);
    for i in 0..commands {
        let before = document.settled_scene().clone();
        match random.below(20) {
            0..=8 => {
                let edits: Vec<Edit> = (0..1 + random.below(3))
                    .map(|_| edit(&mut random, &before))
                    .collect();
                match document.apply_all("Edit", &edits) {
                    Ok(()) => applied += 1,
                    Err(error) => {
                        refused += 1;
                        assert!(
                            !error.to_string().is_empty() && !error.to_string().contains('\n'),
                            "{error}"
                        );
                        assert_eq!(
                            document.settled_scene().rev,
                            before.rev,
                            "refused, yet changed: {edits:?}"
                        );
                    }
                }
                model.note(&document);
            }
            9..=12 => {
                drag(&mut document, &mut model, &mut random, &before);
            }
            13..=15 => {
                for _ in 0..1 + random.below(6) {
                    let could = document.can_undo();
                    assert_eq!(document.undo().is_some(), could);
                    if could {
                        model.at -= 1;
                        undone += 1;
                    }
                }
            }
            16 | 17 => {
                for _ in 0..1 + random.below(6) {
                    let could = document.can_redo();
                    assert_eq!(document.redo().is_some(), could);
                    model.at += usize::from(could);
                }
            }
            18 => {
                // A result comes: for this state, or too late for another.
                let mut occupancy = before.for_generation().frame().occupancy.clone();
                for [x, y, z] in cells(&mut random) {
                    if x < Window::NX && y < Window::NY && z < Window::NZ {
                        occupancy.set(x, y, z, Class::Vegetation.id());
                    }
                }
                let late = random.one_in(3);
                let content = if late { SceneRev::fresh() } else { before.content() };
                assert_eq!(document.adopt(content, occupancy).is_err(), late);
                model.states[model.at] = document.settled_scene().clone();
            }
            _ => match random.below(3) {
                0 => {
                    let index = random.below(document.history().len() + 2);
                    assert_eq!(document.jump_to(index), index < model.states.len());
                    if index < model.states.len() {
                        model.at = index;
                    }
                }
                1 => {
                    document.show(random.below(40) as f64 * 0.1);
                    model.states[model.at] = document.settled_scene().clone();
                }
                _ => {
                    document.mark_saved();
                    assert!(!document.is_dirty());
                }
            },
        }
        check(&document, &model, i);
    }
    println!("{commands} commands: {applied} applied, {refused} refused, {undone} undone");
    assert!(commands < 500 || (applied > commands / 10 && refused > commands / 50 && undone > commands / 10));
}
