//! The select tool in space: boxes and things chosen by a ray, moved on their level, pulled by the gizmo, raised.

use glam::{DVec2, DVec3};

use crate::choose;
use crate::pick::{self, PickHit};
use crate::pick_things;
use crate::tools::rays::along_axis;
use crate::tools::{
    Act, At, CLICK_SLACK, Choose, ChooseBy, Context, Hand, Key, Modifiers, Pointer, ReadonlyContext,
    Response, Role, ScreenProjection, ToolMark, farthest_m, point_of,
};
use crate::transform::{Axis, Orientation, Pull, Transform, TransformKind};
use scene::{BoxId, Frame, Scene, ThingId};

use super::above::{how, preview};
use super::boxes::{self, Steered, step_name, transform};
use super::gizmo::{Gizmo, GizmoPart};
use super::things::{self, Pull as ThingPull, ThingDrag};

/// How near the pointer takes hold of the knob, points.
const KNOB_REACH: f64 = 9.0;
/// Points of a way on the screen are this far apart, points.
const APART: f64 = 2.0;
/// Things are raised by this much at most in one drag, m.
const MOST_UP_M: f64 = 100.0;

/// Drag in progress in the 3D view. Places are points of the screen.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum SpaceDrag {
    /// Moves, turns or scales boxes.
    Boxes {
        transform: Transform,
        /// Point that the drag pulls, m: the one that was hit, or the middle of the boxes for the gizmo.
        grabbed_m: DVec3,
        from: DVec2,
        to: DVec2,
        /// The pointer has left the place where it went down, or something was typed.
        moved: bool,
        /// The box under the pointer.
        hit: Option<BoxId>,
    },
    /// Drags chosen things.
    Things {
        drag: ThingDrag,
        grabbed_m: DVec3,
        from: DVec2,
        moved: bool,
        hit: Option<ThingId>,
    },
    /// Chooses in a rectangle or an outline.
    Area {
        points: Vec<DVec2>,
        lasso: bool,
        how: Choose,
    },
}

/// The thing that was hit, if things can be chosen.
fn thing_of(scene: &Scene, hand: &Hand, hit: &PickHit) -> Option<ThingId> {
    let PickHit::Voxel(voxel) = hit else { return None };
    let open = hand.things.is_open();
    open.then(|| pick_things::thing_of_voxel(scene.frame(), &scene.background, voxel.cell))?
}

/// The drag that a press on a thing starts.
fn press_things(cx: &Context<'_>, pointer: &Pointer) -> Option<SpaceDrag> {
    let drag = |pull, grabbed_m, hit| {
        Some(SpaceDrag::Things {
            drag: ThingDrag::new(cx.settled, cx.hand, pull)?,
            grabbed_m,
            from: pointer.at,
            moved: false,
            hit,
        })
    };
    let knob_m = things::knob_m(cx.settled, cx.hand);
    if let Some(knob_m) = knob_m
        && cx
            .view
            .project(knob_m)
            .is_some_and(|p| p.distance(pointer.at) < KNOB_REACH)
    {
        return drag(ThingPull::Height, knob_m, None);
    }
    if pointer.held.shift || cx.hand.outlines() {
        return None;
    }
    let ray = cx.view.ray(pointer.at)?;
    let hit = pick::pick(cx.frame(), &ray)?;
    let id = thing_of(cx.settled, cx.hand, &hit).filter(|id| cx.hand.things.chosen.contains(id))?;
    drag(ThingPull::Place, point_of(&hit, &ray), Some(id))
}

/// The drag that a press starts.
pub(super) fn press(cx: &mut Context<'_>, pointer: &Pointer) -> Option<SpaceDrag> {
    if let Some(drag) = press_things(cx, pointer) {
        return Some(drag);
    }
    let at = pointer.at;
    if let Some(drag) = press_gizmo(cx, at) {
        return Some(drag);
    }
    let ray = cx.view.ray(at)?;
    match pick::pick(cx.frame(), &ray) {
        Some(hit @ PickHit::Box { id, .. }) if !pointer.held.shift && !cx.hand.outlines() => {
            if cx.settled.arranged.group_of_box(id).is_some() {
                boxes::take(cx.settled, cx.hand, id);
            }
            Some(SpaceDrag::Boxes {
                transform: transform(
                    cx.frame(),
                    cx.hand,
                    &boxes::with(cx.hand, id),
                    TransformKind::Move,
                ),
                grabbed_m: point_of(&hit, &ray),
                from: at,
                to: at,
                moved: false,
                hit: Some(id),
            })
        }
        // (its corners are set by clicks)
        _ if cx.hand.choose_by == ChooseBy::Polygon => None,
        _ => Some(SpaceDrag::Area {
            points: vec![at],
            lasso: cx.hand.outlines(),
            how: how(pointer.held),
        }),
    }
}

/// The drag that a press on the gizmo starts.
fn press_gizmo(cx: &Context<'_>, at: DVec2) -> Option<SpaceDrag> {
    let frame = cx.frame();
    let gizmo = Gizmo::new(cx.settled, cx.hand, cx.view);
    if let Some(part) = gizmo.and_then(|g| g.at(at)) {
        let mut transform = transform(frame, cx.hand, &cx.hand.chosen(), cx.hand.gizmo);
        if transform.kind == TransformKind::Scale {
            transform.orientation = Orientation::Local;
        }
        transform.axis = match part {
            GizmoPart::Axis(axis) => Some(axis),
            GizmoPart::Ring => None,
        };
        return Some(SpaceDrag::Boxes {
            grabbed_m: transform.middle_m(),
            transform,
            from: at,
            to: at,
            moved: false,
            hit: None,
        });
    }
    None
}

/// Continues a drag to the place of the pointer.
pub(super) fn drag(drag: &mut SpaceDrag, cx: &Context<'_>, pointer: &Pointer) -> Response {
    let at = pointer.at;
    match drag {
        SpaceDrag::Boxes { from, to, moved, .. } => {
            *to = at;
            *moved |= from.distance(at) > CLICK_SLACK;
            show(drag, cx.view, cx.frame(), cx.hand, pointer.held)
        }
        SpaceDrag::Things {
            drag,
            grabbed_m,
            from,
            moved,
            ..
        } => {
            *moved |= from.distance(at) > CLICK_SLACK;
            let limit_m = farthest_m(cx.frame().extent());
            let way_m = way_m(cx.view, limit_m, drag.pull(), *grabbed_m, [*from, at]).filter(|_| *moved);
            let Some(way_m) = way_m else {
                return Response::none();
            };
            // In space Alt turns the camera.
            let held = Modifiers {
                alt: false,
                ..pointer.held
            };
            preview(drag.edits(cx.frame(), cx.hand, way_m.truncate(), way_m.z, held))
        }
        SpaceDrag::Area { points, lasso, .. } => {
            if !*lasso {
                points.truncate(1);
            }
            if points.last().is_none_or(|p| p.distance(at) > APART) {
                points.push(at);
            }
            Response::none()
        }
    }
}

/// Way of the pointer on the level of the dragged object, or up, m; `None` beyond `limit_m` from the ego vehicle.
fn way_m(
    view: &dyn ScreenProjection,
    limit_m: f64,
    pull: ThingPull,
    grabbed_m: DVec3,
    [from, to]: [DVec2; 2],
) -> Option<DVec3> {
    let (start, now) = (view.ray(from)?, view.ray(to)?);
    if pull == ThingPull::Height {
        let up = along_axis(&now, grabbed_m, DVec3::Z)? - along_axis(&start, grabbed_m, DVec3::Z)?;
        return Some(DVec3::Z * up.clamp(-MOST_UP_M, MOST_UP_M));
    }
    let to_m = pick::ray_ground(&now, grabbed_m.z).filter(|p| p.truncate().length() < limit_m)?;
    Some((to_m - pick::ray_ground(&start, grabbed_m.z)?).with_z(0.0))
}

/// How far the pointer pulls a drag of boxes; places beyond `limit_m` from the ego vehicle do not count.
fn pull(
    transform: &Transform,
    view: &dyn ScreenProjection,
    limit_m: f64,
    grabbed_m: DVec3,
    [from, to]: [DVec2; 2],
) -> Option<Pull> {
    let (start, now) = (view.ray(from)?, view.ray(to)?);
    let mut pull = Pull::default();
    let middle_m = transform.middle_m();
    match (transform.kind, transform.axis) {
        (TransformKind::Move, Some(axis)) => {
            let axis = transform.axis_in_ego(axis);
            let way_m = along_axis(&now, grabbed_m, axis)? - along_axis(&start, grabbed_m, axis)?;
            pull.delta_m = axis * way_m.clamp(-limit_m, limit_m);
        }
        (TransformKind::Move, None) => {
            let to_m = pick::ray_ground(&now, grabbed_m.z).filter(|p| p.truncate().length() < limit_m)?;
            pull.delta_m = (to_m - pick::ray_ground(&start, grabbed_m.z)?).with_z(0.0);
        }
        (TransformKind::Turn, _) => {
            let on_ground = |ray| Some(pick::ray_ground(ray, middle_m.z)?.truncate());
            pull.turn_deg = transform.turn_deg(on_ground(&start)?, on_ground(&now)?);
        }
        (TransformKind::Scale, Some(axis)) => {
            let axis = transform.axis_in_ego(axis);
            let from_m = along_axis(&start, middle_m, axis)?;
            pull.factor = along_axis(&now, middle_m, axis)? / from_m;
        }
        (TransformKind::Scale, None) => {
            let middle = view.project(middle_m)?;
            pull.factor = to.distance(middle) / from.distance(middle).max(1.0);
        }
    }
    Some(pull)
}

fn show(
    drag: &SpaceDrag,
    view: &dyn ScreenProjection,
    frame: &Frame,
    hand: &Hand,
    held: Modifiers,
) -> Response {
    if let SpaceDrag::Boxes {
        transform,
        grabbed_m,
        from,
        to,
        moved: true,
        ..
    } = drag
        && let Some(pull) = pull(
            transform,
            view,
            farthest_m(frame.extent()),
            *grabbed_m,
            [*from, *to],
        )
    {
        return preview(boxes::edits(transform, &pull, frame, hand, held.ctrl));
    }
    Response::none()
}

/// A key while something is dragged.
pub(super) fn key(
    drag: &mut SpaceDrag,
    cx: &Context<'_>,
    key: Key,
    repeat: bool,
    held: Modifiers,
) -> Response {
    let SpaceDrag::Boxes { transform, moved, .. } = drag else {
        return Response::none();
    };
    let steered = boxes::steer(transform, key, repeat, held);
    let name = step_name(transform);
    match steered {
        Steered::Not => return Response::none(),
        Steered::Same => return Response::taken(),
        Steered::Changed | Steered::Done => *moved = true,
    }
    let mut response = show(drag, cx.view, cx.frame(), cx.hand, held);
    response.taken = true;
    if steered == Steered::Done {
        response.done = true;
        return response.and(Act::Commit(name.into()));
    }
    response
}

/// Ends a drag when the button comes up.
pub(super) fn release(drag: SpaceDrag, cx: &mut Context<'_>, at: DVec2) -> Response {
    match drag {
        SpaceDrag::Boxes {
            transform,
            moved,
            hit,
            ..
        } => {
            // A box that was not chosen is, once it was moved; a click chooses it alone.
            if let Some(id) = hit.filter(|_| !moved || transform.start.len() == 1) {
                cx.hand.choose(&[id], Choose::Only);
            }
            match moved {
                true => Response::act(Act::Commit(step_name(&transform).into())),
                false => Response::none(),
            }
        }
        SpaceDrag::Things {
            drag, moved: true, ..
        } => Response::act(Act::Commit(drag.label().into())),
        SpaceDrag::Things { hit, .. } => {
            // A click on one of several chooses it alone; one on the knob changes nothing.
            let there = hit.filter(|id| cx.settled.background.get(*id).is_some());
            if there.is_some() && cx.hand.things.is_open() {
                things::choose(cx.hand, there, Choose::Only);
            }
            Response::none()
        }
        SpaceDrag::Area { points, lasso, how } => {
            match points.iter().all(|p| p.distance(at) <= CLICK_SLACK) {
                true => click(cx, at, how),
                false => area(cx, &points, at, lasso, how),
            }
            Response::none()
        }
    }
}

fn click(cx: &mut Context<'_>, at: DVec2, how: Choose) {
    let scene = cx.settled;
    let hit = cx.view.ray(at).and_then(|ray| pick::pick(scene.frame(), &ray));
    match (hit, how) {
        (Some(PickHit::Box { id, .. }), Choose::Add) => cx.hand.choose(&[id], Choose::Toggle),
        (Some(PickHit::Box { id, .. }), how) => cx.hand.choose(&[id], how),
        (hit, how) => {
            let thing = hit.and_then(|hit| thing_of(scene, cx.hand, &hit));
            things::choose(cx.hand, thing, how);
        }
    }
}

fn area(cx: &mut Context<'_>, points: &[DVec2], at: DVec2, lasso: bool, how: Choose) {
    let outline: Vec<DVec2> = match (lasso, points.first()) {
        (false, Some(from)) => {
            let (min, max) = (from.min(at), from.max(at));
            vec![min, DVec2::new(max.x, min.y), max, DVec2::new(min.x, max.y)]
        }
        _ => points.to_vec(),
    };
    chosen_in(cx, &outline, how);
}

/// Chooses the objects in an outline on the screen.
pub(super) fn chosen_in(cx: &mut Context<'_>, outline: &[DVec2], how: Choose) {
    let (scene, view) = (cx.settled, cx.view);
    let frame = scene.frame();
    let inside = |p_m: DVec3| view.project(p_m).is_some_and(|p| choose::is_inside(outline, p));
    let taken = frame.boxes.values().filter(|b| inside(b.center_m));
    let ids: Vec<BoxId> = taken.map(|b| b.id).collect();
    cx.hand.choose(&ids, how);
    let on_screen = |p: DVec2| inside(p.extend(frame.layout.relief.height_m(p)));
    things::choose_in(scene, cx.hand, how, on_screen);
}

/// The part of the gizmo that is dragged.
fn held_part(axis: Option<Axis>, kind: TransformKind) -> Option<GizmoPart> {
    match (kind, axis) {
        (TransformKind::Turn, _) => Some(GizmoPart::Ring),
        (_, axis) => axis.map(GizmoPart::Axis),
    }
}

/// The marks over the view.
pub(super) fn overlay(drag: Option<&SpaceDrag>, sight: &ReadonlyContext<'_>) -> Vec<ToolMark> {
    let mut out = Vec::new();
    let gizmo = Gizmo::new(sight.scene, sight.hand, sight.view);
    let pointer = sight.pointer.map(|p| p.at);
    let limit_m = farthest_m(sight.settled.frame().extent());
    match drag {
        None => {
            if let Some(gizmo) = gizmo {
                out.extend(gizmo.marks(pointer.and_then(|p| gizmo.at(p))));
            }
        }
        Some(SpaceDrag::Boxes {
            transform,
            grabbed_m,
            from,
            to,
            moved,
            ..
        }) => {
            if let Some(gizmo) = gizmo {
                out.extend(gizmo.marks(held_part(transform.axis, transform.kind)));
            }
            let pull = pull(transform, sight.view, limit_m, *grabbed_m, [*from, *to]);
            if let (true, Some(pull)) = (*moved, pull) {
                let grid = sight.pointer.is_some_and(|p| p.held.ctrl);
                let text = transform.text(&pull, &sight.hand.snap(grid));
                out.push(ToolMark::Tag(At::Screen(*to), text));
            }
        }
        Some(SpaceDrag::Area { points, lasso, .. }) => match (lasso, points.first(), points.last()) {
            (false, Some(a), Some(b)) => {
                out.push(ToolMark::Rect(At::Screen(*a), At::Screen(*b), Role::Choose));
            }
            _ => {
                let closed = points.iter().chain(points.first()).map(|p| At::Screen(*p));
                out.push(ToolMark::Dashed(closed.collect(), Role::Choose));
            }
        },
        Some(SpaceDrag::Things {
            drag,
            grabbed_m,
            from,
            moved: true,
            ..
        }) => {
            if let Some(to) = pointer
                && let Some(way_m) = way_m(sight.view, limit_m, drag.pull(), *grabbed_m, [*from, to])
            {
                let text = match drag.pull() {
                    ThingPull::Height => format!("{:+.1} m", way_m.z),
                    _ => format!("{:.1} m", way_m.length()),
                };
                out.push(ToolMark::Tag(At::Screen(to), text));
            }
        }
        Some(SpaceDrag::Things { .. }) => {}
    }
    if let Some(knob_m) = things::knob_m(sight.scene, sight.hand) {
        let knob = sight.view.project(knob_m);
        let hot = pointer.zip(knob).is_some_and(|(p, k)| p.distance(k) < KNOB_REACH);
        out.push(ToolMark::Knob(knob_m, hot));
    }
    out
}
