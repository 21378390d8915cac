//! Things in the 3D view: chosen by the voxels that show them, moved on the ground, raised by a knob, drawn by the tools.

use egui::{Modifiers, Pos2, Ui};
use glam::{DVec2, DVec3};

use crate::command::Command;
use crate::pointer;
use crate::state::{Tool, UiState};
use crate::view3d::{View3d, View3dInput, point_of};
use crate::view3d_tools::Gesture3d;
use editor::pick::{self, Hit};
use editor::pick_things;
use scene::ThingId;

use super::ToolCommand;
use super::bev_draw;
use super::things::ThingCommand;
use super::things::drag::{Held, Pull, ThingDrag};
use super::things::draw as overlay;
use super::things::press::{self, ThingPress};
use super::view3d::{ViewGesture, along_axis};

/// What the pointer is doing with things.
#[derive(Clone, Debug, PartialEq)]
pub enum ThingGesture {
    /// Draws with a tool for things.
    Draw(ThingPress),
    /// Drags chosen things.
    Drag {
        /// What was taken hold of.
        drag: ThingDrag,
        /// The point that was taken hold of, m.
        grabbed_m: DVec3,
        /// Where the pointer went down.
        from: Pos2,
        /// The pointer has left the place where it went down.
        moved: bool,
        /// The thing under the pointer.
        hit: Option<ThingId>,
    },
}

/// Points that the pointer may move and still click.
const CLICK_SLACK: f32 = 4.0;

/// Where the pointer meets ground or voxels, without the drag in progress, m.
fn ground_m(view: &View3d, input: &View3dInput<'_>, at: Pos2) -> Option<DVec2> {
    let ray = view.pointer(at)?.ray;
    let hit = pick::pick(input.settled.frame(), &ray)?;
    let p = point_of(&hit, &ray).truncate();
    (p.length() < 400.0).then_some(p)
}

/// The thing that was hit, if things can be chosen.
pub(super) fn thing_of(input: &View3dInput<'_>, state: &UiState, hit: &Hit) -> Option<ThingId> {
    let Hit::Voxel(voxel) = hit else { return None };
    let scene = input.scene;
    let open = state.tools.things.is_open();
    open.then(|| pick_things::thing_of_voxel(scene.frame(), &scene.background, voxel.cell))?
}

/// What a press begins, if it is for a thing.
pub(super) fn begin(
    view: &View3d,
    input: &View3dInput<'_>,
    state: &UiState,
    at: Pos2,
    modifiers: Modifiers,
    commands: &mut Vec<Command>,
) -> Option<ThingGesture> {
    if matches!(state.tool, Tool::Thing(_)) {
        let at_m = ground_m(view, input, at)?;
        let reach_m = reach_m(view, at, at_m);
        // Alt turns the camera here.
        return ThingPress::begin(state, at_m, false, reach_m, commands).map(ThingGesture::Draw);
    }
    let drag = |pull, grabbed_m, hit| {
        Some(ThingGesture::Drag {
            drag: ThingDrag::new(input.scene, state, pull)?,
            grabbed_m,
            from: at,
            moved: false,
            hit,
        })
    };
    if let Some(knob_m) = overlay::knob_m(input.scene, state)
        && view
            .project(knob_m)
            .is_some_and(|knob| knob.distance(at) < overlay::KNOB_REACH)
    {
        return drag(Pull::Height, knob_m, None);
    }
    if modifiers.shift || state.tools.lasso {
        return None;
    }
    let ray = view.pointer(at)?.ray;
    let hit = pick::pick(input.scene.frame(), &ray)?;
    let id = thing_of(input, state, &hit).filter(|id| state.tools.things.chosen.contains(id))?;
    drag(Pull::Place, point_of(&hit, &ray), Some(id))
}

/// How far on the ground the pointer may move and still click, m.
fn reach_m(view: &View3d, at: Pos2, at_m: DVec2) -> f64 {
    let beside = egui::pos2(at.x + CLICK_SLACK, at.y);
    let ground = |p| view.pointer(p).and_then(|p| pick::ray_ground(&p.ray, 0.0));
    match (ground(at), ground(beside)) {
        (Some(a), Some(b)) => a.distance(b).clamp(0.1, 2.0),
        _ => (at_m.length() * 0.01).clamp(0.1, 2.0),
    }
}

/// What a move of the pointer changes.
pub(super) fn drag(
    gesture: &mut ThingGesture,
    view: &View3d,
    input: &View3dInput<'_>,
    state: &UiState,
    at: Pos2,
    ctrl: bool,
    commands: &mut Vec<Command>,
) {
    match gesture {
        ThingGesture::Draw(press) => {
            if let Some(at_m) = ground_m(view, input, at) {
                press.drag(at_m, false, commands);
            }
        }
        ThingGesture::Drag {
            drag,
            grabbed_m,
            from,
            moved,
            ..
        } => {
            *moved |= from.distance(at) > CLICK_SLACK;
            let Some(way_m) = way_m(view, drag.pull(), *grabbed_m, *from, at).filter(|_| *moved) else {
                return;
            };
            let held = Held {
                free: false,
                grid: ctrl,
            };
            let frame = input.settled.frame();
            let edits = drag.edits(frame, state, way_m.truncate(), way_m.z, held);
            if !edits.is_empty() {
                pointer::preview(commands, edits);
            }
        }
    }
}

/// How far the pointer went on the level of what it holds, or up, m.
fn way_m(view: &View3d, pull: Pull, grabbed_m: DVec3, from: Pos2, to: Pos2) -> Option<DVec3> {
    let (start, now) = (view.pointer(from)?.ray, view.pointer(to)?.ray);
    if pull == Pull::Height {
        let up = along_axis(&now, grabbed_m, DVec3::Z)? - along_axis(&start, grabbed_m, DVec3::Z)?;
        return Some(DVec3::Z * up.clamp(-100.0, 100.0));
    }
    let to_m = pick::ray_ground(&now, grabbed_m.z).filter(|p| p.truncate().length() < 400.0)?;
    Some((to_m - pick::ray_ground(&start, grabbed_m.z)?).with_z(0.0))
}

/// What letting go does.
pub(super) fn end(
    gesture: ThingGesture,
    input: &View3dInput<'_>,
    state: &UiState,
    commands: &mut Vec<Command>,
) {
    match gesture {
        ThingGesture::Draw(press) => press.end(commands),
        ThingGesture::Drag {
            drag, moved: true, ..
        } => {
            let commit = ThingCommand::Commit(drag.label());
            commands.push(Command::Tools(ToolCommand::Thing(commit)));
        }
        ThingGesture::Drag { hit, .. } => {
            // A click on one of several chooses it alone; one on the knob changes nothing.
            let there = hit.filter(|id| input.scene.background.get(*id).is_some());
            if there.is_some() && state.tools.things.is_open() {
                press::choose(there, false, commands);
            }
        }
    }
}

/// Draws over the finished view.
pub(crate) fn draw(ui: &Ui, view: &View3d, input: &View3dInput<'_>, state: &UiState) {
    let painter = ui.painter().with_clip_rect(view.rect);
    let pointer = ui
        .input(|i| i.pointer.latest_pos())
        .filter(|p| view.rect.contains(*p) && state.hovered_pane == Some(crate::panes::id::PaneId::VIEW3D));
    let drawing = matches!(state.tool, Tool::Thing(_));
    let at_m = pointer.filter(|_| drawing).and_then(|p| ground_m(view, input, p));
    let project = |p: DVec3| view.project(p);
    overlay::in_3d(&painter, &project, input.scene, state, (pointer, at_m));
    if let Gesture3d::Tool(ViewGesture::Things(ThingGesture::Drag {
        drag,
        grabbed_m,
        from,
        moved: true,
        ..
    })) = &view.gesture
        && let Some(to) = pointer
        && let Some(way_m) = way_m(view, drag.pull(), *grabbed_m, *from, to)
    {
        let text = match drag.pull() {
            Pull::Height => format!("{:+.1} m", way_m.z),
            _ => format!("{:.1} m", way_m.length()),
        };
        bev_draw::tag(&painter, to, &text);
    }
}
