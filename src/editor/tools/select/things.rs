//! Chosen things dragged on either view: moved together with the chosen boxes, a corner pulled, raised. Each move of
//! the pointer starts over from the things as they were when the button went down.

use glam::{DVec2, DVec3};

use crate::arrange::boxes_of;
use crate::pick_things;
use crate::{Edit, kerb};
use language::tf;
use scene::{Form, Frame, Scene, SceneBox, ThingId};

use crate::tools::beside::{KERB_M, words};
use crate::tools::{Choose, Hand, Modifiers};

/// Drag of chosen things in progress.
#[derive(Clone, Debug, PartialEq)]
pub struct ThingDrag {
    /// The chosen things, world frame.
    start: Vec<(ThingId, Form)>,
    boxes: Vec<SceneBox>,
    /// Part of them that the pointer changes.
    pull: Pull,
}

/// Part of the things that a drag changes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Pull {
    /// The place of all of them.
    Place,
    /// One corner of the first.
    Corner(usize),
    /// The height of all of them.
    Height,
}

impl ThingDrag {
    /// Begins a drag of the chosen things; `None` without a thing.
    pub fn new(scene: &Scene, hand: &Hand, pull: Pull) -> Option<Self> {
        let things = hand.things.chosen_in(&scene.background);
        let start: Vec<_> = things.map(|t| (t.id, t.form.clone())).collect();
        (!start.is_empty()).then(|| Self {
            start,
            boxes: boxes_of(scene.frame(), &hand.chosen()),
            pull,
        })
    }

    /// The part that is changed.
    pub fn pull(&self) -> Pull {
        self.pull
    }

    /// Edits for a way on the ground of the ego frame, m, and a way up, m.
    pub fn edits(&self, frame: &Frame, hand: &Hand, way_m: DVec2, up_m: f64, held: Modifiers) -> Vec<Edit> {
        let ids = || self.start.iter().map(|(id, _)| *id).collect();
        match self.pull {
            Pull::Place => {
                let way_m = self.snapped(frame, hand, way_m, held);
                let mut edits: Vec<Edit> = self.boxes.iter().map(|b| moved_box(b, way_m)).collect();
                edits.push(Edit::MoveThings {
                    ids: ids(),
                    by_m: way_m,
                    turn_deg: 0.0,
                });
                edits
            }
            Pull::Corner(index) => {
                let (id, form) = &self.start[0];
                let Some(&corner_m) = form.points_m().get(index) else {
                    return Vec::new();
                };
                let at_m = corner_m + way_m;
                let form = pick_things::with_corner(form, index, at_m);
                // An outline that crosses itself is not shown: the one before stays.
                let sound = form.problem().is_none();
                sound
                    .then_some(Edit::ChangeThing { id: *id, form })
                    .into_iter()
                    .collect()
            }
            Pull::Height => {
                let lowest = self
                    .start
                    .iter()
                    .map(|(_, f)| f.height_m())
                    .fold(f64::MAX, f64::min);
                let step_m = 0.1;
                let by_m = (up_m / step_m).round() * step_m;
                vec![Edit::RaiseThings {
                    ids: ids(),
                    by_m: by_m.max(LEAST_M - lowest),
                }]
            }
        }
    }

    fn snapped(&self, frame: &Frame, hand: &Hand, way_m: DVec2, held: Modifiers) -> DVec2 {
        if hand.things.snap_kerb && !held.alt {
            let forms: Vec<Form> = self.start.iter().map(|(_, f)| f.clone()).collect();
            if let Some(rest_m) = kerb::way_to_kerb(&frame.layout, &forms, way_m, KERB_M) {
                return way_m + rest_m;
            }
        }
        match hand.snap(held.ctrl).grid_m {
            Some(grid_m) => (way_m / grid_m).round() * grid_m,
            None => way_m,
        }
    }

    /// The name of the undo step that it makes.
    pub fn label(&self) -> String {
        let forms: Vec<&Form> = self.start.iter().map(|(_, f)| f).collect();
        let things = words::count(&forms);
        match self.pull {
            Pull::Place if self.boxes.is_empty() => tf!("Move {things}", things = things),
            Pull::Place => tf!("Move {n} boxes and things", n = self.boxes.len() + forms.len()),
            Pull::Corner(_) => tf!("Reshape {things}", things = things),
            Pull::Height => tf!("Raise {things}", things = things),
        }
    }
}

/// Things are not dragged lower than this, m.
const LEAST_M: f64 = 0.5;

fn moved_box(b: &SceneBox, way_m: DVec2) -> Edit {
    Edit::MoveBox {
        id: b.id,
        center_m: Some(b.center_m + way_m.extend(0.0)),
        yaw_deg: None,
        size_m: None,
    }
}

/// Edits that let the chosen things go where the edits of a drag of boxes take the first of these.
pub(super) fn along_with(mut edits: Vec<Edit>, boxes: &[SceneBox], hand: &Hand) -> Vec<Edit> {
    let ids: Vec<ThingId> = hand.things.chosen.iter().copied().collect();
    let first = edits.iter().find_map(|edit| match edit {
        Edit::MoveBox {
            id,
            center_m: Some(center_m),
            yaw_deg: None,
            size_m: None,
        } => boxes.iter().find(|b| b.id == *id).map(|b| *center_m - b.center_m),
        _ => None,
    });
    if let (Some(way_m), false) = (first, ids.is_empty()) {
        edits.push(Edit::MoveThings {
            ids,
            by_m: way_m.truncate(),
            turn_deg: 0.0,
        });
    }
    edits
}

/// The thing under a point of the ground (ego frame, m) that a click would choose.
pub fn thing_under(scene: &Scene, hand: &Hand, at_m: DVec2, reach_m: f64) -> Option<ThingId> {
    let open = hand.things.is_open();
    open.then(|| pick_things::thing_at(&scene.background, at_m, reach_m))
        .flatten()
}

/// The drag that a press from above starts among the chosen things: of a corner if there is only one thing, or of all
/// of them.
pub(super) fn held(scene: &Scene, hand: &Hand, at_m: DVec2, reach_m: f64, shift: bool) -> Option<ThingDrag> {
    let things = &hand.things;
    if shift || things.chosen.is_empty() {
        return None;
    }
    let mut chosen = things.chosen_in(&scene.background);
    if let (Some(one), None, None) = (chosen.next(), chosen.next(), hand.selected)
        && let Some(corner) = pick_things::corner_at(&one.form, at_m, reach_m)
    {
        return ThingDrag::new(scene, hand, Pull::Corner(corner));
    }
    let hit = thing_under(scene, hand, at_m, reach_m)?;
    things
        .chosen
        .contains(&hit)
        .then(|| ThingDrag::new(scene, hand, Pull::Place))?
}

/// A click where no box is: chooses the thing there, or nothing.
pub(super) fn choose(hand: &mut Hand, hit: Option<ThingId>, how: Choose) {
    match (hit, how) {
        (Some(id), Choose::Add) => hand.choose_things(&[id], Choose::Toggle),
        (Some(id), how) => hand.choose_things(&[id], how),
        (None, Choose::Only) => hand.choose(&[], Choose::Only),
        (None, _) => {}
    }
}

/// Adds the things whose middle (ego frame, m) lies in an area to the selection, or takes them out of it.
pub(super) fn choose_in(scene: &Scene, hand: &mut Hand, how: Choose, inside: impl Fn(DVec2) -> bool) {
    if hand.things.is_open() {
        let ids = pick_things::things_in(&scene.background, inside);
        if !ids.is_empty() {
            let how = match how {
                Choose::Remove => Choose::Remove,
                _ => Choose::Add,
            };
            hand.choose_things(&ids, how);
        }
    }
}

/// Corners that can be pulled of the one chosen thing, ego frame, m.
pub(super) fn handles_m(scene: &Scene, hand: &Hand) -> Vec<DVec2> {
    let mut chosen = hand.things.chosen_in(&scene.background);
    match (chosen.next(), chosen.next()) {
        (Some(one), None) if hand.selected.is_none() => match &one.form {
            Form::Tree(_) | Form::Post(_) => Vec::new(),
            form => form.points_m(),
        },
        _ => Vec::new(),
    }
}

/// The knob that raises the chosen things in the 3D view: in the middle of their top, ego frame, m.
pub(super) fn knob_m(scene: &Scene, hand: &Hand) -> Option<DVec3> {
    let frame = scene.frame();
    let chosen = hand.things.chosen_in(&scene.background);
    let tops: Vec<DVec3> = chosen.map(|t| top_m(&t.form, frame)).collect();
    (!tops.is_empty()).then(|| {
        let middle = tops.iter().sum::<DVec3>() / tops.len() as f64;
        let highest = tops.iter().map(|t| t.z).fold(f64::MIN, f64::max);
        middle.with_z(highest + 0.6)
    })
}

/// The middle of a form's top, ego frame, m.
fn top_m(form: &Form, frame: &Frame) -> DVec3 {
    let points = form.points_m();
    // The middle of a bent line lies beside it.
    let middle = match form {
        Form::Line(_) | Form::Bridge(_) => points[points.len() / 2],
        _ => form.middle_m(),
    };
    middle.extend(frame.layout.relief.height_m(middle) + form.height_m())
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use super::*;
    use scene::background::Building;
    use scene::{Background, BevLayout, VoxelGrid};

    #[test]
    fn drags_start_over_and_keep_outlines_sound() {
        let frame = Frame::new(BevLayout::default(), Default::default(), VoxelGrid::new());
        let mut scene = Scene::single("test", frame, Arc::default(), 0);
        let mut background = Background::default();
        let house = Building::rectangle(DVec2::new(100.0, 10.0), DVec2::new(4.0, 3.0), DVec2::X, 6.0);
        let id = background.add(Form::Building(house));
        scene.background = Arc::new(background);
        let mut hand = Hand::default();
        assert_eq!(ThingDrag::new(&scene, &hand, Pull::Place), None);
        hand.choose_things(&[id], Choose::Only);
        let drag = |pull| ThingDrag::new(&scene, &hand, pull).expect("a house is chosen");
        let frame = scene.frame();
        let moved = drag(Pull::Place).edits(frame, &hand, DVec2::X * 2.0, 0.0, Modifiers::default());
        let [Edit::MoveThings { by_m, .. }] = &moved[..] else {
            panic!("{moved:?}");
        };
        assert_eq!(*by_m, DVec2::X * 2.0);
        let lowered = drag(Pull::Height).edits(frame, &hand, DVec2::ZERO, -50.0, Modifiers::default());
        assert!(matches!(&lowered[..], [Edit::RaiseThings { by_m, .. }] if *by_m == -5.5));
        let corner = drag(Pull::Corner(2));
        let pulled = corner.edits(frame, &hand, DVec2::X, 0.0, Modifiers::default());
        let [Edit::ChangeThing { form, .. }] = &pulled[..] else {
            panic!("{pulled:?}");
        };
        assert!(form.points_m()[2].distance(DVec2::new(105.0, 13.0)) < 1e-9);
        // Over the opposite wall it would cross.
        assert!(
            corner
                .edits(frame, &hand, DVec2::new(-2.0, -9.0), 0.0, Modifiers::default())
                .is_empty()
        );
        assert_eq!(corner.label(), "Reshape building");
    }
}
