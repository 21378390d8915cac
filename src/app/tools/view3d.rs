//! What the tools do in the 3D view: boxes chosen together and pulled by the gizmo; blocks, rows, floods and
//! faces of voxels.

use egui::{Modifiers, Pos2, Rect, Ui};
use glam::{DVec2, DVec3};

use crate::command::Command;
use crate::pointer;
use crate::state::{Tool, UiState, VoxelVerb};
use crate::view3d::{View3d, View3dInput, point_of};
use crate::view3d_tools::{Gesture3d, target};
use editor::pick::{self, Hit, Ray, VoxelHit};
use editor::transform::{Axis, Kind, Orientation, Pull, Transform};
use editor::voxel_ops::{self, Cell};
use editor::{Edit, choose};
use scene::{BoxId, Class, Frame, GridSpec};

use super::bev::{DragKey, chosen, drag_keys, step_name, transform};
use super::gizmo::{Gizmo, Part};
use super::things::drag::along_with;
use super::things::press;
use super::view3d_things::{self, ThingGesture};
use super::{Choose, ToolCommand, VoxelMode, bev_draw};

/// What the pointer is doing with one of these tools.
#[derive(Clone, Debug, PartialEq)]
pub enum ViewGesture {
    /// Moves, turns or scales boxes.
    Transform {
        /// What becomes of them.
        transform: Transform,
        /// Point that was taken hold of, m.
        grabbed_m: DVec3,
        /// Where the pointer went down.
        from: Pos2,
        /// Where it is.
        to: Pos2,
        /// The pointer has left the place where it went down, or something was typed.
        moved: bool,
        /// The box under the pointer.
        hit: Option<BoxId>,
    },
    /// Chooses boxes in a rectangle or an outline on the screen.
    Area {
        /// Way so far.
        points: Vec<Pos2>,
        /// Outline instead of rectangle.
        lasso: bool,
        /// Adds to the selection.
        add: bool,
    },
    /// A block of voxels.
    Block {
        /// Where it begins, and the face that was pressed.
        first: VoxelHit,
        /// The corner under the pointer.
        last: Cell,
        /// Layers along the face's normal.
        height: i32,
        /// What is done.
        verb: VoxelVerb,
    },
    /// A row of voxels.
    Row {
        /// Where it begins.
        first: Cell,
        /// What is done.
        verb: VoxelVerb,
    },
    /// Of things, in `view3d_things.rs`.
    Things(ThingGesture),
    /// A face pulled out or pushed in.
    Pull {
        /// The voxel that was pressed.
        first: VoxelHit,
        /// The face.
        face: Vec<Cell>,
    },
}

/// Points that the pointer may move and still click.
const CLICK_SLACK: f32 = 4.0;
/// Rays this near to parallel with an axis say nothing about it.
const PARALLEL: f64 = 1e-6;

/// Where along a line through `point` the ray comes nearest, m; `None` for a ray that runs along it.
pub(super) fn along_axis(ray: &Ray, point_m: DVec3, axis: DVec3) -> Option<f64> {
    let (d, w) = (ray.direction_in_ego, point_m - ray.origin_in_ego);
    let b = axis.dot(d);
    let denominator = 1.0 - b * b;
    (denominator > PARALLEL).then(|| (b * d.dot(w) - axis.dot(w)) / denominator)
}

/// Where a ray meets the plane through a point across an axis of the grid.
fn on_plane(ray: &Ray, point_m: DVec3, axis: usize) -> Option<DVec3> {
    let d = ray.direction_in_ego[axis];
    if d.abs() < PARALLEL {
        return None;
    }
    let t = (point_m[axis] - ray.origin_in_ego[axis]) / d;
    // Not by distance: the rays of an orthographic view begin far away.
    let p = ray.at(t);
    (t >= 0.0 && p.abs().max_element() < 400.0).then_some(p)
}

fn class_of(state: &UiState, verb: VoxelVerb) -> Class {
    match verb {
        VoxelVerb::Remove => Class::Free,
        _ => state.voxel_class,
    }
}

fn step_of(verb: VoxelVerb) -> &'static str {
    match verb {
        VoxelVerb::Attach => "Attach voxels",
        VoxelVerb::Remove => "Remove voxels",
        VoxelVerb::Recolour => "Recolour voxels",
    }
}

/// What a press begins, if it is for one of these tools.
pub(crate) fn begin(
    view: &View3d,
    input: &View3dInput<'_>,
    state: &UiState,
    at: Pos2,
    modifiers: Modifiers,
    commands: &mut Vec<Command>,
) -> Option<Gesture3d> {
    match state.tool {
        Tool::Select | Tool::Thing(_)
            if let Some(held) = view3d_things::begin(view, input, state, at, modifiers, commands) =>
        {
            Some(Gesture3d::Tool(ViewGesture::Things(held)))
        }
        Tool::Select => Some(Gesture3d::Tool(select(view, input, state, at, modifiers)?)),
        Tool::Voxel => voxels(view, input, state, at, modifiers, commands),
        Tool::Measure | Tool::Region | Tool::Thing(_) => Some(Gesture3d::Ignored),
        Tool::Brush | Tool::AddBox => None,
    }
}

fn select(
    view: &View3d,
    input: &View3dInput<'_>,
    state: &UiState,
    at: Pos2,
    modifiers: Modifiers,
) -> Option<ViewGesture> {
    let frame = input.scene.frame();
    let ids = state.chosen();
    let project = |p: DVec3| view.project(p);
    let gizmo = Gizmo::new(frame, state, &Axis::ALL, view.camera.axes()[0], &project);
    if let Some(part) = gizmo.and_then(|g| g.at(at)) {
        let mut transform = transform(frame, state, &ids, state.tools.gizmo);
        if transform.kind == Kind::Scale {
            transform.orientation = Orientation::Local;
        }
        transform.axis = match part {
            Part::Axis(axis) => Some(axis),
            Part::Ring => None,
        };
        let grabbed_m = transform.middle_m();
        return Some(ViewGesture::Transform {
            transform,
            grabbed_m,
            from: at,
            to: at,
            moved: false,
            hit: None,
        });
    }
    let ray = view.pointer(at)?.ray;
    let hit = pick::pick(frame, &ray);
    match hit {
        Some(hit @ Hit::Box { id, .. }) if !modifiers.shift && !state.tools.lasso => {
            let ids = match state.is_chosen(id) {
                true => std::iter::once(id)
                    .chain(ids.into_iter().filter(|c| *c != id))
                    .collect(),
                false => vec![id],
            };
            Some(ViewGesture::Transform {
                transform: transform(frame, state, &ids, Kind::Move),
                grabbed_m: point_of(&hit, &ray),
                from: at,
                to: at,
                moved: false,
                hit: Some(id),
            })
        }
        _ => Some(ViewGesture::Area {
            points: vec![at],
            lasso: state.tools.lasso,
            add: modifiers.shift,
        }),
    }
}

fn voxels(
    view: &View3d,
    input: &View3dInput<'_>,
    state: &UiState,
    at: Pos2,
    modifiers: Modifiers,
    commands: &mut Vec<Command>,
) -> Option<Gesture3d> {
    let frame = input.settled.frame();
    let mode = state.tools.voxel_mode;
    if mode == VoxelMode::Brush {
        return None;
    }
    let ray = view.pointer(at)?.ray;
    let hit = pick::ray_voxels(&ray, &frame.occupancy, |_, _| true);
    let verb = match modifiers.shift && mode != VoxelMode::Wand {
        true => VoxelVerb::Remove,
        false => state.verb,
    };
    let first = target(frame, verb, [1, 1], &ray).first().copied();
    Some(match mode {
        VoxelMode::Block | VoxelMode::Brush => first.map_or(Gesture3d::Ignored, |cell| {
            let normal = hit.map_or([0, 0, 1], |h| h.normal);
            Gesture3d::Tool(ViewGesture::Block {
                first: VoxelHit {
                    cell,
                    normal,
                    label: Class::FREE,
                    distance_m: 0.0,
                },
                last: cell,
                height: state.tools.voxel_height as i32,
                verb,
            })
        }),
        VoxelMode::Row => first.map_or(Gesture3d::Ignored, |first| {
            Gesture3d::Tool(ViewGesture::Row { first, verb })
        }),
        VoxelMode::Extrude => match hit {
            Some(first) => Gesture3d::Tool(ViewGesture::Pull {
                face: voxel_ops::face(&frame.occupancy, first.cell, first.normal),
                first,
            }),
            None => Gesture3d::Ignored,
        },
        VoxelMode::Fill | VoxelMode::Wand => {
            let cells = hit.map_or_else(Vec::new, |h| voxel_ops::connected(&frame.occupancy, h.cell));
            let cells = state.tools.both_sides(cells);
            let cells = voxel_ops::only(&frame.occupancy, cells, false);
            if mode == VoxelMode::Wand {
                commands.push(Command::Tools(ToolCommand::ChooseVoxels(cells, modifiers.shift)));
            } else if !cells.is_empty() {
                let class = class_of(state, verb);
                let label = if class == Class::Free {
                    "Remove voxels"
                } else {
                    "Fill voxels"
                };
                commands.push(Command::Apply(label, vec![Edit::PaintVoxels { cells, class }]));
            }
            Gesture3d::Ignored
        }
    })
}

/// Takes over the class of the voxel under the pointer.
pub(crate) fn pick_class(view: &View3d, input: &View3dInput<'_>, at: Pos2, commands: &mut Vec<Command>) {
    let grid = &input.settled.frame().occupancy;
    let hit = view
        .pointer(at)
        .and_then(|p| pick::ray_voxels(&p.ray, grid, |_, _| true));
    if let Some(class) = hit.and_then(|h| Class::from_id(h.label)) {
        commands.push(Command::Tools(ToolCommand::PickClass(class)));
    }
}

/// What a move of the pointer changes.
pub(crate) fn drag(
    gesture: &mut ViewGesture,
    view: &View3d,
    input: &View3dInput<'_>,
    state: &UiState,
    at: Pos2,
    ctrl: bool,
    commands: &mut Vec<Command>,
) {
    match gesture {
        ViewGesture::Transform { from, to, moved, .. } => {
            *to = at;
            *moved |= from.distance(at) > CLICK_SLACK;
            show_transform(gesture, view, input.settled.frame(), state, ctrl, commands);
        }
        ViewGesture::Things(held) => view3d_things::drag(held, view, input, state, at, ctrl, commands),
        ViewGesture::Area { points, lasso, .. } => {
            if !*lasso {
                points.truncate(1);
            }
            if points.last().is_none_or(|p| p.distance(at) > 2.0) {
                points.push(at);
            }
        }
        ViewGesture::Block { first, last, .. } => {
            let axis = (0..3).find(|a| first.normal[*a] != 0).unwrap_or(2);
            let [x, y, z] = first.cell;
            let plane = view
                .pointer(at)
                .and_then(|p| on_plane(&p.ray, GridSpec::center(x, y, z), axis));
            if let Some(p) = plane {
                let limit = [GridSpec::NX, GridSpec::NY, GridSpec::NZ];
                let units = GridSpec::to_voxel_units(p);
                for a in (0..3).filter(|a| *a != axis) {
                    last[a] = units[a].clamp(0.0, limit[a] as f64 - 1.0) as usize;
                }
                last[axis] = first.cell[axis];
            }
            show_block(gesture, input.settled.frame(), state, commands);
        }
        ViewGesture::Row { first, verb } => {
            let Some(ray) = view.pointer(at).map(|p| p.ray) else {
                return;
            };
            let frame = input.settled.frame();
            if let Some(last) = target(frame, *verb, [1, 1], &ray).first() {
                let cells = voxel_ops::line(*first, *last, state.voxel_size);
                show_voxels(cells, frame, state, *verb, commands);
            }
        }
        ViewGesture::Pull { first, face } => {
            let edits = pulled(view, input.settled.frame(), state, first, face, at);
            match edits {
                Some(edit) => pointer::preview(commands, vec![edit]),
                None => commands.push(Command::CancelDrag),
            }
        }
    }
}

fn show_voxels(
    cells: Vec<Cell>,
    frame: &Frame,
    state: &UiState,
    verb: VoxelVerb,
    commands: &mut Vec<Command>,
) {
    let cells = voxel_ops::only(
        &frame.occupancy,
        state.tools.both_sides(cells),
        verb == VoxelVerb::Attach,
    );
    if !cells.is_empty() {
        let class = class_of(state, verb);
        pointer::preview(commands, vec![Edit::PaintVoxels { cells, class }]);
    }
}

fn show_block(gesture: &ViewGesture, frame: &Frame, state: &UiState, commands: &mut Vec<Command>) {
    let ViewGesture::Block {
        first,
        last,
        height,
        verb,
    } = gesture
    else {
        return;
    };
    let axis = (0..3).find(|a| first.normal[*a] != 0).unwrap_or(2);
    // Attached blocks grow out of the face, others into it.
    let outward = if *verb == VoxelVerb::Attach { 1 } else { -1 };
    let mut far = *last;
    let end = first.cell[axis] as i32 + outward * first.normal[axis] * (height - 1);
    far[axis] = end.max(0) as usize;
    show_voxels(voxel_ops::between(first.cell, far), frame, state, *verb, commands);
}

/// The edit of a face pulled as far as the pointer is.
fn pulled(
    view: &View3d,
    frame: &Frame,
    state: &UiState,
    first: &VoxelHit,
    face: &[Cell],
    at: Pos2,
) -> Option<Edit> {
    let [x, y, z] = first.cell;
    let normal = DVec3::from_array(first.normal.map(f64::from));
    let surface_m = GridSpec::center(x, y, z) + normal * (GridSpec::VOXEL_M / 2.0);
    let way_m = along_axis(&view.pointer(at)?.ray, surface_m, normal)?;
    let layers = (way_m / GridSpec::VOXEL_M).round().clamp(-200.0, 200.0) as i32;
    let cells = voxel_ops::extrude(&frame.occupancy, face, first.normal, layers);
    let cells = state.tools.both_sides(cells);
    let cells = voxel_ops::only(&frame.occupancy, cells, layers > 0);
    let class = match layers > 0 {
        true => Class::from_id(first.label)?,
        false => Class::Free,
    };
    (!cells.is_empty()).then_some(Edit::PaintVoxels { cells, class })
}

/// How far the pointer pulls a drag of boxes.
fn pull(transform: &Transform, view: &View3d, grabbed_m: DVec3, from: Pos2, to: Pos2) -> Option<Pull> {
    let (start, now) = (view.pointer(from)?.ray, view.pointer(to)?.ray);
    let mut pull = Pull::default();
    let middle_m = transform.middle_m();
    match (transform.kind, transform.axis) {
        (Kind::Move, Some(axis)) => {
            let axis = transform.axis_in_ego(axis);
            let way_m = along_axis(&now, grabbed_m, axis)? - along_axis(&start, grabbed_m, axis)?;
            pull.delta_m = axis * way_m.clamp(-400.0, 400.0);
        }
        (Kind::Move, None) => {
            let to_m = pick::ray_ground(&now, grabbed_m.z).filter(|p| p.truncate().length() < 400.0)?;
            pull.delta_m = (to_m - pick::ray_ground(&start, grabbed_m.z)?).with_z(0.0);
        }
        (Kind::Turn, _) => {
            let on_ground = |ray: &Ray| Some(pick::ray_ground(ray, middle_m.z)?.truncate());
            pull.turn_deg = transform.turn_deg(on_ground(&start)?, on_ground(&now)?);
        }
        (Kind::Scale, Some(axis)) => {
            let axis = transform.axis_in_ego(axis);
            let from_m = along_axis(&start, middle_m, axis)?;
            pull.factor = along_axis(&now, middle_m, axis)? / from_m;
        }
        (Kind::Scale, None) => {
            let middle = view.project(middle_m)?;
            pull.factor = f64::from(to.distance(middle) / from.distance(middle).max(1.0));
        }
    }
    Some(pull)
}

fn show_transform(
    gesture: &ViewGesture,
    view: &View3d,
    frame: &Frame,
    state: &UiState,
    ctrl: bool,
    commands: &mut Vec<Command>,
) {
    if let ViewGesture::Transform {
        transform,
        grabbed_m,
        from,
        to,
        moved: true,
        ..
    } = gesture
        && let Some(pull) = pull(transform, view, *grabbed_m, *from, *to)
    {
        let edits = transform.edits(frame, &pull, &state.tools.snap(ctrl));
        let edits = along_with(edits, &transform.start, frame, state);
        if !edits.is_empty() {
            pointer::preview(commands, edits);
        }
    }
}

/// What letting go does.
pub(crate) fn end(
    gesture: ViewGesture,
    view: &View3d,
    input: &View3dInput<'_>,
    state: &UiState,
    at: Pos2,
    commands: &mut Vec<Command>,
) {
    match gesture {
        ViewGesture::Transform {
            transform,
            moved: true,
            hit,
            ..
        } => {
            // A box that was not chosen is, once it was moved.
            if let (Some(id), 1) = (hit, transform.start.len()) {
                commands.push(Command::Select(Some(id)));
            }
            commands.push(Command::Commit(step_name(&transform)));
        }
        ViewGesture::Transform { hit, .. } => {
            if let Some(id) = hit {
                commands.push(Command::Select(Some(id)));
            }
        }
        ViewGesture::Things(held) => view3d_things::end(held, input, state, commands),
        ViewGesture::Area { points, lasso, add } => {
            let frame = input.scene.frame();
            let clicked = points.iter().all(|p| p.distance(at) <= CLICK_SLACK);
            if clicked {
                let hit = view.pointer(at).and_then(|p| pick::pick(frame, &p.ray));
                let id = match hit {
                    Some(Hit::Box { id, .. }) => Some(id),
                    _ => None,
                };
                match (id, add) {
                    (Some(id), true) => {
                        commands.push(Command::Tools(ToolCommand::Choose(vec![id], Choose::Toggle)));
                    }
                    (None, add) => {
                        let thing = hit.and_then(|hit| view3d_things::thing_of(input, state, &hit));
                        press::choose(thing, add, commands);
                    }
                    (id, false) => commands.push(Command::Select(id)),
                }
                return;
            }
            let outline: Vec<DVec2> = match (lasso, points.first()) {
                (false, Some(from)) => {
                    let r = Rect::from_two_pos(*from, at);
                    [r.left_top(), r.right_top(), r.right_bottom(), r.left_bottom()]
                        .map(flat)
                        .to_vec()
                }
                _ => points.iter().map(|p| flat(*p)).collect(),
            };
            let inside = |c: DVec3| {
                view.project(c)
                    .is_some_and(|p| choose::is_inside(&outline, flat(p)))
            };
            let boxes = frame.boxes.values().filter(|b| inside(b.center_m));
            chosen(boxes.map(|b| b.id).collect(), add, commands);
            let on_screen = |p: DVec2| inside(p.extend(frame.layout.relief.height_m(p)));
            press::in_area(input.scene, state, on_screen, commands);
        }
        ViewGesture::Block { verb, .. } | ViewGesture::Row { verb, .. } => {
            commands.push(Command::Commit(step_of(verb)));
        }
        ViewGesture::Pull { .. } => commands.push(Command::Commit("Pull voxels")),
    }
}

fn flat(p: Pos2) -> DVec2 {
    DVec2::new(p.x.into(), p.y.into())
}

/// Keys and wheel that steer a drag; they are taken from the frame's input.
pub(crate) fn keys(
    ui: &Ui,
    view: &View3d,
    gesture: &mut Gesture3d,
    input: &View3dInput<'_>,
    state: &UiState,
    commands: &mut Vec<Command>,
) {
    let (ctrl, notches) = ui.input(|i| (i.modifiers.ctrl, wheel(&i.events)));
    match gesture {
        Gesture3d::Tool(held @ ViewGesture::Transform { .. }) => {
            let ViewGesture::Transform { transform, moved, .. } = held else {
                return;
            };
            let Some(key) = drag_keys(ui, transform) else {
                return;
            };
            *moved = true;
            let name = step_name(transform);
            show_transform(held, view, input.settled.frame(), state, ctrl, commands);
            if key == DragKey::Done {
                commands.push(Command::Commit(name));
                *gesture = Gesture3d::Ignored;
            }
        }
        Gesture3d::Tool(block @ ViewGesture::Block { .. }) if notches != 0 => {
            if let ViewGesture::Block { height, .. } = block {
                *height = (*height + notches).clamp(1, GridSpec::NZ as i32);
            }
            show_block(block, input.settled.frame(), state, commands);
        }
        _ => {}
    }
}

/// Steps of the wheel, up positive.
fn wheel(events: &[egui::Event]) -> i32 {
    let notch = |e: &egui::Event| match e {
        egui::Event::MouseWheel { delta, .. } if delta.y > 0.0 => 1,
        egui::Event::MouseWheel { delta, .. } if delta.y < 0.0 => -1,
        _ => 0,
    };
    events.iter().map(notch).sum()
}

/// Draws over the finished view.
pub(crate) fn draw(ui: &Ui, view: &View3d, input: &View3dInput<'_>, state: &UiState) {
    let painter = ui.painter().with_clip_rect(view.rect);
    let pointer = ui
        .input(|i| i.pointer.latest_pos())
        .filter(|p| view.rect.contains(*p));
    let project = |p: DVec3| view.project(p);
    let gizmo = Gizmo::new(
        input.scene.frame(),
        state,
        &Axis::ALL,
        view.camera.axes()[0],
        &project,
    );
    match &view.gesture {
        Gesture3d::Tool(ViewGesture::Transform {
            transform,
            grabbed_m,
            from,
            to,
            moved,
            ..
        }) => {
            if let Some(gizmo) = gizmo {
                gizmo.draw(&painter, bev_draw::held_part(transform.axis, transform.kind));
            }
            if let (true, Some(pull)) = (*moved, pull(transform, view, *grabbed_m, *from, *to)) {
                let ctrl = ui.input(|i| i.modifiers.ctrl);
                bev_draw::tag(&painter, *to, &transform.text(&pull, &state.tools.snap(ctrl)));
            }
        }
        Gesture3d::Tool(ViewGesture::Area { points, lasso, .. }) => {
            match (lasso, points.first(), points.last()) {
                (false, Some(a), Some(b)) => bev_draw::marquee(&painter, Rect::from_two_pos(*a, *b)),
                _ => bev_draw::lasso(&painter, points.clone()),
            }
        }
        Gesture3d::Tool(ViewGesture::Block {
            first, last, height, ..
        }) => {
            let across: Vec<usize> = (0..3)
                .filter(|a| first.normal[*a] == 0)
                .map(|a| first.cell[a].abs_diff(last[a]) + 1)
                .collect();
            if let (Some(p), [a, b]) = (pointer, &across[..]) {
                bev_draw::tag(&painter, p, &format!("{a} × {b} × {height} voxels"));
            }
        }
        Gesture3d::None => {
            if let Some(gizmo) = gizmo {
                gizmo.draw(&painter, pointer.and_then(|p| gizmo.at(p)));
            }
        }
        _ => {}
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rays_meet_axes_and_planes() {
        let ray = Ray::new(DVec3::new(0.0, -10.0, 2.0), DVec3::Y).expect("a direction");
        let at = along_axis(&ray, DVec3::new(-3.0, 0.0, 2.0), DVec3::X).expect("crosses");
        assert!((at - 3.0).abs() < 1e-12);
        let up = along_axis(&ray, DVec3::new(1.0, 5.0, 0.0), DVec3::Z).expect("passes by");
        assert!((up - 2.0).abs() < 1e-12);
        assert_eq!(along_axis(&ray, DVec3::ZERO, DVec3::Y), None);
        assert_eq!(
            on_plane(&ray, DVec3::new(0.0, 4.0, 0.0), 1),
            Some(DVec3::new(0.0, 4.0, 2.0))
        );
        assert_eq!(on_plane(&ray, DVec3::ZERO, 2), None);
        assert_eq!(on_plane(&ray, DVec3::new(0.0, -20.0, 0.0), 1), None);
    }
}
