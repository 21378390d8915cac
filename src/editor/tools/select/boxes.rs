//! Dragging of chosen boxes: the state of a drag, the keys that steer it, its undo step.

use crate::Edit;
use crate::arrange::{Pivot, boxes_of};
use crate::tools::{Choose, Hand, Key, Modifiers};
use crate::transform::{Axis, Pull, Transform, TransformKind};
use scene::{BoxId, Frame, Members, Scene, SceneBox, ThingId};

use super::things::along_with;

/// A drag of boxes that has not begun to move.
pub(super) fn transform(frame: &Frame, hand: &Hand, ids: &[BoxId], kind: TransformKind) -> Transform {
    Transform {
        kind,
        start: boxes_of(frame, ids),
        axis: None,
        orientation: hand.orientation,
        pivot: match kind {
            // The ring turns the boxes about the middle of the ring.
            TransformKind::Turn => Pivot::Middle,
            _ => hand.pivot,
        },
        typed: String::new(),
    }
}

/// Edits of the boxes as far as the pointer pulls them; chosen things go along.
pub(super) fn edits(transform: &Transform, pull: &Pull, frame: &Frame, hand: &Hand, grid: bool) -> Vec<Edit> {
    let edits = transform.edits(frame, pull, &hand.snap(grid));
    along_with(edits, &transform.start, hand)
}

/// The name of the undo step that a drag makes.
pub(super) fn step_name(transform: &Transform) -> &'static str {
    let boxes: &[SceneBox] = &transform.start;
    let several = boxes.len() > 1;
    match (transform.kind, several) {
        (TransformKind::Move, false) => "Move box",
        (TransformKind::Move, true) => "Move boxes",
        (TransformKind::Turn, false) => "Turn box",
        (TransformKind::Turn, true) => "Turn boxes",
        (TransformKind::Scale, false) => "Resize box",
        (TransformKind::Scale, true) => "Resize boxes",
    }
}

/// Effect of a key on a drag of boxes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Steered {
    /// None: the key is not for the drag.
    Not,
    /// The key is for the drag and changes nothing.
    Same,
    /// The drag changed and has to be shown.
    Changed,
    /// The drag is finished.
    Done,
}

/// Takes a key that steers a drag: X, Y, Z, digits, Backspace, Enter.
pub(super) fn steer(transform: &mut Transform, key: Key, repeat: bool, held: Modifiers) -> Steered {
    if held.ctrl {
        return Steered::Not;
    }
    match key {
        Key::Axis(_) if repeat => return Steered::Same,
        Key::Axis(axis) => match Axis::ALL.get(axis) {
            Some(axis) => transform.toggle_axis(*axis),
            None => return Steered::Not,
        },
        Key::Digit(c) => transform.type_char(c),
        Key::Backspace => drop(transform.typed.pop()),
        Key::Enter => return Steered::Done,
        Key::Escape => return Steered::Not,
    }
    Steered::Changed
}

/// Chooses a box that is not chosen, and the group that it is in.
pub(super) fn take(scene: &Scene, hand: &mut Hand, id: BoxId) {
    if hand.is_chosen(id) {
        return;
    }
    hand.choose(&[id], Choose::Only);
    choose_groups(scene, hand);
}

/// Extends the selection to whole groups; the box chosen last stays the first.
pub(super) fn choose_groups(scene: &Scene, hand: &mut Hand) {
    let chosen = members(hand);
    let whole = scene.arranged.with_groups(&chosen);
    if whole == chosen {
        return;
    }
    let last = hand.selected;
    let boxes: Vec<BoxId> = whole
        .boxes
        .into_iter()
        .filter(|id| Some(*id) != last)
        .chain(last)
        .collect();
    hand.choose(&boxes, Choose::Only);
    let things: Vec<ThingId> = whole.things.into_iter().collect();
    hand.choose_things(&things, Choose::Add);
}

/// The chosen boxes and things.
pub(super) fn members(hand: &Hand) -> Members {
    Members::of(hand.chosen(), hand.things.chosen.iter().copied())
}

/// The boxes that a press on one of them moves: all that are chosen with it first, or it alone.
pub(super) fn with(hand: &Hand, id: BoxId) -> Vec<BoxId> {
    match hand.is_chosen(id) {
        true => {
            let others = hand.chosen().into_iter().filter(|c| *c != id);
            std::iter::once(id).chain(others).collect()
        }
        false => vec![id],
    }
}
