//! The select tool from above: boxes and things chosen, moved, turned and resized on the map.

use glam::{DVec2, DVec3};

use crate::pick::{self, Handle};
use crate::tools::{
    Act, At, CLICK_SLACK, Choose, ChooseBy, Context, Cursor, HANDLE_REACH, Hand, Key, Modifiers, Pointer,
    ReadonlyContext, Response, Role, ToolMark,
};
use crate::transform::{Axis, Pull, Transform, TransformKind};
use crate::{Edit, choose};
use scene::{Extent, Frame, SceneBox};

use super::boxes::{self, Steered, step_name, transform};
use super::gizmo::{Gizmo, GizmoPart};
use super::motion::{self, MotionDrag};
use super::things::{self, Pull as ThingPull, ThingDrag, thing_under};

/// Drag in progress in the view from above. All points are of the ego frame, m.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum TopViewDrag {
    /// Moves, turns or scales boxes.
    Boxes {
        transform: Transform,
        from_m: DVec2,
        to_m: DVec2,
        /// The pointer has left the place where it went down, or something was typed.
        moved: bool,
    },
    /// Takes hold of the corner of a box.
    Corner {
        start: SceneBox,
        corner: usize,
        from_m: DVec2,
        moved: bool,
    },
    /// Drags chosen things.
    Things {
        drag: ThingDrag,
        from_m: DVec2,
        moved: bool,
    },
    /// Drags a keyframe or a place of a path.
    Motion {
        drag: MotionDrag,
        from_m: DVec2,
        moved: bool,
    },
    /// Chooses in a rectangle.
    Marquee { from_m: DVec2, to_m: DVec2, how: Choose },
    /// Chooses in an outline.
    Lasso { points_m: Vec<DVec2>, how: Choose },
}

/// How far the line of an axis is drawn to both sides, m: across the whole map.
fn axis_reach_m(extent: Extent) -> f64 {
    const LEAST_M: f64 = 200.0;
    let across = extent.max_m() - extent.min_m();
    across.truncate().length().max(LEAST_M)
}

fn held(transform: Transform, at_m: DVec2) -> TopViewDrag {
    TopViewDrag::Boxes {
        transform,
        from_m: at_m,
        to_m: at_m,
        moved: false,
    }
}

/// True over the knob that turns the chosen box: it goes before an arrow that runs under it.
fn is_over_knob(frame: &Frame, hand: &Hand, at_m: DVec2, reach_m: f64) -> bool {
    let b = hand.selected.and_then(|id| frame.boxes.get(&id));
    !hand.outlines() && b.is_some_and(|b| pick::handle_at(b, at_m, reach_m) == Some(Handle::Rotate))
}

/// The drag that a press starts.
pub(super) fn press(cx: &mut Context<'_>, pointer: &Pointer) -> Option<TopViewDrag> {
    let at_m = cx.ground_m(pointer.at)?;
    let frame = cx.settled.frame();
    let reach_m = HANDLE_REACH / cx.view.scale();
    let (shift, chosen) = (pointer.held.shift, cx.hand.chosen());
    // The arrows light up under the pointer whatever chooses, so they can be pulled too.
    let gizmo = Gizmo::new(cx.settled, cx.hand, cx.view);
    let over_knob = is_over_knob(frame, cx.hand, at_m, reach_m);
    if let Some(GizmoPart::Axis(axis)) = gizmo.filter(|_| !over_knob).and_then(|g| g.at(pointer.at)) {
        let mut transform = transform(frame, cx.hand, &chosen, cx.hand.gizmo);
        transform.axis = Some(axis);
        return Some(held(transform, at_m));
    }
    if !cx.hand.outlines() {
        let first = cx.hand.selected.and_then(|id| frame.boxes.get(&id));
        let handle = first.and_then(|b| pick::handle_at(b, at_m, reach_m));
        match (first, handle) {
            (_, Some(Handle::Rotate)) => {
                return Some(held(
                    transform(frame, cx.hand, &chosen, TransformKind::Turn),
                    at_m,
                ));
            }
            // A corner resizes one box.
            (Some(b), Some(Handle::Corner(corner))) if chosen.len() == 1 && !shift => {
                return Some(TopViewDrag::Corner {
                    start: *b,
                    corner,
                    from_m: at_m,
                    moved: false,
                });
            }
            _ => {}
        }
        let over_box = pick::box_at(frame, at_m);
        // Over the object itself, a press drags the object, and its motion with it.
        if over_box.is_none_or(|id| !cx.hand.is_chosen(id))
            && let Some(drag) = MotionDrag::held(cx.settled, cx.hand, at_m, reach_m)
        {
            return Some(TopViewDrag::Motion {
                drag,
                from_m: at_m,
                moved: false,
            });
        }
        if let Some(id) = over_box {
            if shift && !(chosen.len() == 1 && cx.hand.is_chosen(id)) {
                cx.hand.choose(&[id], Choose::Toggle);
                // A release elsewhere than the press moves nothing: the press meant the selection.
                return Some(TopViewDrag::Marquee {
                    from_m: at_m,
                    to_m: at_m,
                    how: Choose::Add,
                });
            }
            boxes::take(cx.settled, cx.hand, id);
            let ids = boxes::with(cx.hand, id);
            return Some(held(transform(frame, cx.hand, &ids, TransformKind::Move), at_m));
        }
        // A thing is chosen by a click and moved once it is: a drag over a forest still marks.
        if let Some(drag) = things::held(cx.settled, cx.hand, at_m, reach_m, shift) {
            return Some(TopViewDrag::Things {
                drag,
                from_m: at_m,
                moved: false,
            });
        }
    }
    let how = how(pointer.held);
    match cx.hand.choose_by {
        ChooseBy::Rectangle => Some(TopViewDrag::Marquee {
            from_m: at_m,
            to_m: at_m,
            how,
        }),
        ChooseBy::Lasso => Some(TopViewDrag::Lasso {
            points_m: vec![at_m],
            how,
        }),
        // (its corners are set by clicks)
        ChooseBy::Polygon => None,
    }
}

/// Continues a drag to the place of the pointer.
pub(super) fn drag(drag: &mut TopViewDrag, cx: &Context<'_>, pointer: &Pointer) -> Response {
    let Some(at_m) = cx.ground_m(pointer.at) else {
        return Response::none();
    };
    let (frame, scale) = (cx.frame(), cx.view.scale());
    let left = |from_m: DVec2| from_m.distance(at_m) * scale > CLICK_SLACK;
    match drag {
        TopViewDrag::Boxes {
            from_m, to_m, moved, ..
        } => {
            *to_m = at_m;
            *moved |= left(*from_m);
            show(drag, frame, cx.hand, pointer.held)
        }
        TopViewDrag::Corner {
            start,
            corner,
            from_m,
            moved,
        } => {
            *moved |= left(*from_m);
            if !*moved {
                return Response::none();
            }
            let (center_m, size_m) = pick::resized_by_corner(start, *corner, at_m);
            Response::act(Act::Preview(vec![Edit::MoveBox {
                id: start.id,
                center_m: Some(center_m),
                yaw_deg: None,
                size_m: Some(size_m),
            }]))
        }
        TopViewDrag::Things { drag, from_m, moved } => {
            *moved |= left(*from_m);
            let edits = match *moved {
                true => drag.edits(frame, cx.hand, at_m - *from_m, 0.0, pointer.held),
                false => Vec::new(),
            };
            preview(edits)
        }
        TopViewDrag::Motion { drag, from_m, moved } => {
            *moved |= left(*from_m);
            match *moved {
                true => drag.preview(cx.settled, cx.hand, at_m, pointer.held),
                false => Response::none(),
            }
        }
        TopViewDrag::Marquee { to_m, .. } => {
            *to_m = at_m;
            Response::none()
        }
        TopViewDrag::Lasso { points_m, .. } => {
            if points_m.last().is_none_or(|p| p.distance(at_m) > 2.0 / scale) {
                points_m.push(at_m);
            }
            Response::none()
        }
    }
}

/// Shows edits, if there are any.
pub(super) fn preview(edits: Vec<Edit>) -> Response {
    match edits.is_empty() {
        true => Response::none(),
        false => Response::act(Act::Preview(edits)),
    }
}

/// Shows boxes as far as they are pulled.
fn show(drag: &TopViewDrag, frame: &Frame, hand: &Hand, held: Modifiers) -> Response {
    let TopViewDrag::Boxes {
        transform,
        from_m,
        to_m,
        moved: true,
    } = drag
    else {
        return Response::none();
    };
    let moves = transform.kind == TransformKind::Move;
    let pull = pull(transform, *from_m, *to_m, held.shift && moves);
    let grid = held.ctrl || transform.kind == TransformKind::Turn && held.shift;
    preview(boxes::edits(transform, &pull, frame, hand, grid))
}

/// How far the pointer pulls a drag on this view.
fn pull(transform: &Transform, from_m: DVec2, to_m: DVec2, keep_axis: bool) -> Pull {
    let mut flat = to_m - from_m;
    if keep_axis && transform.axis.is_none() {
        // Shift keeps to the axis that was moved along most.
        if flat.x.abs() > flat.y.abs() {
            flat.y = 0.0;
        } else {
            flat.x = 0.0;
        }
    }
    let middle_m = transform.middle_m().truncate();
    let arm_m = from_m.distance(middle_m);
    Pull {
        delta_m: match transform.axis {
            // From above, up on the screen is up.
            Some(Axis::Z) => DVec3::Z * flat.x,
            _ => flat.extend(0.0),
        },
        turn_deg: transform.turn_deg(from_m, to_m),
        factor: match arm_m > 1e-3 {
            true => to_m.distance(middle_m) / arm_m,
            false => 1.0,
        },
    }
}

/// A key while something is dragged.
pub(super) fn key(
    drag: &mut TopViewDrag,
    cx: &Context<'_>,
    key: Key,
    repeat: bool,
    held: Modifiers,
) -> Response {
    let TopViewDrag::Boxes { transform, moved, .. } = drag else {
        return Response::none();
    };
    let steered = boxes::steer(transform, key, repeat, held);
    let name = step_name(transform);
    match steered {
        Steered::Not => return Response::none(),
        Steered::Same => return Response::taken(),
        Steered::Changed | Steered::Done => *moved = true,
    }
    let mut response = show(drag, cx.frame(), cx.hand, held);
    response.taken = true;
    if steered == Steered::Done {
        response.done = true;
        return response.and(Act::Commit(name.into()));
    }
    response
}

/// Ends a drag when the button comes up.
pub(super) fn release(drag: TopViewDrag, cx: &mut Context<'_>) -> Response {
    let (scene, scale) = (cx.settled, cx.view.scale());
    let frame = scene.frame();
    let reach_m = HANDLE_REACH / scale;
    let click = |hand: &mut Hand, at_m, how| {
        let hit = thing_under(scene, hand, at_m, reach_m);
        things::choose(hand, hit, how);
    };
    match drag {
        TopViewDrag::Boxes {
            transform,
            moved: true,
            ..
        } => return Response::act(Act::Commit(step_name(&transform).into())),
        TopViewDrag::Boxes { transform, .. } => {
            // A click on one of several chooses it alone.
            let several = cx.hand.chosen().len() > 1 || !cx.hand.things.chosen.is_empty();
            if transform.kind == TransformKind::Move
                && transform.axis.is_none()
                && several
                && let Some(b) = transform.start.first()
            {
                cx.hand.choose(&[b.id], Choose::Only);
            }
        }
        TopViewDrag::Corner { moved: true, .. } => return Response::act(Act::Commit("Resize box".into())),
        TopViewDrag::Corner { .. } => {}
        TopViewDrag::Things {
            drag, moved: true, ..
        } => return Response::act(Act::Commit(drag.label().into())),
        TopViewDrag::Things { drag, from_m, .. } => {
            // A click on one of several chooses it alone.
            if drag.pull() == ThingPull::Place {
                click(cx.hand, from_m, Choose::Only);
            }
        }
        TopViewDrag::Motion {
            drag, moved: true, ..
        } => return Response::act(Act::Commit(drag.label().into())),
        TopViewDrag::Motion { .. } => {}
        TopViewDrag::Marquee { from_m, to_m, how } => {
            if from_m.distance(to_m) * scale > CLICK_SLACK {
                cx.hand.choose(&choose::in_rect(frame, from_m, to_m), how);
                let (min, max) = (from_m.min(to_m), from_m.max(to_m));
                let inside = |p: DVec2| p.cmpge(min).all() && p.cmple(max).all();
                things::choose_in(scene, cx.hand, how, inside);
            } else if pick::box_at(frame, from_m).is_none() || how != Choose::Add {
                click(cx.hand, from_m, how);
            }
        }
        TopViewDrag::Lasso { points_m, how } => {
            if points_m.len() >= 3 {
                outline(cx, &points_m, how);
            } else if let Some(id) = points_m.first().and_then(|p| pick::box_at(frame, *p)) {
                let how = if how == Choose::Add { Choose::Toggle } else { how };
                cx.hand.choose(&[id], how);
            } else if let Some(at_m) = points_m.first() {
                click(cx.hand, *at_m, how);
            }
        }
    }
    Response::none()
}

/// Chooses the objects in an outline, ego frame, m.
pub(super) fn outline(cx: &mut Context<'_>, points_m: &[DVec2], how: Choose) {
    let scene = cx.settled;
    cx.hand.choose(&choose::in_outline(scene.frame(), points_m), how);
    things::choose_in(scene, cx.hand, how, |p| choose::is_inside(points_m, p));
}

/// The way in which the objects of a rectangle or outline join the selection, by the held keys.
pub(super) fn how(held: Modifiers) -> Choose {
    match (held.shift, held.ctrl) {
        (true, _) => Choose::Add,
        (false, true) => Choose::Remove,
        (false, false) => Choose::Only,
    }
}

/// The cursor at the place of the pointer.
pub(super) fn cursor(sight: &ReadonlyContext<'_>) -> Cursor {
    let Some(at_m) = sight.ground_m() else {
        return Cursor::Default;
    };
    let (hand, frame) = (sight.hand, sight.scene.frame());
    let reach_m = HANDLE_REACH / sight.view.scale();
    let selected = hand.selected.and_then(|id| frame.boxes.get(&id));
    match selected.and_then(|b| pick::handle_at(b, at_m, reach_m)) {
        Some(Handle::Rotate) => Cursor::Turn,
        Some(Handle::Corner(_)) => Cursor::Crosshair,
        Some(Handle::Body) => Cursor::Move,
        None if motion::is_over_knot(sight, at_m) => Cursor::Move,
        None if pick::box_at(frame, at_m).is_some() => Cursor::Pointing,
        None => match thing_under(sight.scene, hand, at_m, reach_m) {
            Some(id) if hand.things.chosen.contains(&id) => Cursor::Move,
            Some(_) => Cursor::Pointing,
            None => Cursor::Default,
        },
    }
}

/// The marks over the map.
pub(super) fn overlay(drag: Option<&TopViewDrag>, sight: &ReadonlyContext<'_>) -> Vec<ToolMark> {
    let mut out = Vec::new();
    if let None | Some(TopViewDrag::Corner { .. }) = drag
        && let Some(gizmo) = Gizmo::new(sight.scene, sight.hand, sight.view)
    {
        let reach_m = HANDLE_REACH / sight.view.scale();
        let over_knob = sight
            .ground_m()
            .is_some_and(|at_m| is_over_knob(sight.scene.frame(), sight.hand, at_m, reach_m));
        let pointer = sight.pointer.filter(|_| !over_knob);
        out.extend(gizmo.marks(pointer.and_then(|p| gizmo.at(p.at))));
    }
    match drag {
        Some(TopViewDrag::Marquee { from_m, to_m, .. }) => {
            out.push(ToolMark::Rect((*from_m).into(), (*to_m).into(), Role::Choose));
        }
        Some(TopViewDrag::Lasso { points_m, .. }) => {
            let closed = points_m.iter().chain(points_m.first()).map(|p| (*p).into());
            out.push(ToolMark::Dashed(closed.collect(), Role::Choose));
        }
        Some(TopViewDrag::Boxes {
            transform,
            from_m,
            to_m,
            moved: true,
        }) => {
            if let Some(axis) = transform.axis {
                let reach_m = axis_reach_m(sight.settled.frame().extent());
                let (middle_m, along_m) = (transform.middle_m(), transform.axis_in_ego(axis) * reach_m);
                let ends = [middle_m - along_m, middle_m + along_m].map(At::Ego);
                out.push(ToolMark::Line(ends.to_vec(), Role::Axis(axis as usize)));
            }
            let held = sight.pointer.map(|p| p.held).unwrap_or_default();
            let pull = pull(
                transform,
                *from_m,
                *to_m,
                held.shift && transform.kind == TransformKind::Move,
            );
            let text = transform.text(&pull, &sight.hand.snap(held.ctrl));
            out.push(ToolMark::Tag((*to_m).into(), text));
        }
        Some(TopViewDrag::Things {
            drag,
            from_m,
            moved: true,
        }) if drag.pull() == ThingPull::Place => {
            if let Some(at_m) = sight.ground_m() {
                let text = format!("{:.1} m", (at_m - *from_m).length());
                out.push(ToolMark::Tag(at_m.into(), text));
            }
        }
        Some(TopViewDrag::Motion {
            drag, moved: true, ..
        }) => {
            if let Some(at_m) = sight.ground_m() {
                out.push(ToolMark::Tag(at_m.into(), drag.text()));
            }
        }
        _ => {}
    }
    let knots_m = motion::knots_m(sight);
    out.extend(knots_m.into_iter().map(|p| ToolMark::Handle(p.into())));
    let corners_m = things::handles_m(sight.scene, sight.hand);
    out.extend(corners_m.into_iter().map(|p| ToolMark::Handle(p.into())));
    out
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeMap;

    use super::*;
    use scene::{BevLayout, VoxelGrid};

    #[test]
    fn shift_keeps_to_an_axis() {
        let frame = Frame::new(BevLayout::default(), BTreeMap::new(), VoxelGrid::new());
        let t = transform(&frame, &Hand::default(), &[], TransformKind::Move);
        let p = pull(&t, DVec2::ZERO, DVec2::new(3.0, 1.0), true);
        assert_eq!(p.delta_m, DVec3::new(3.0, 0.0, 0.0));
        let up = Transform {
            axis: Some(Axis::Z),
            ..t
        };
        assert_eq!(
            pull(&up, DVec2::ZERO, DVec2::new(2.0, 9.0), true).delta_m,
            DVec3::Z * 2.0
        );
    }
}
