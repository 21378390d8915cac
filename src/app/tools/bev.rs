//! What the tools do on the bird's-eye view: rectangles, lines, outlines, fills, selections, boxes moved together.
//! Every drag starts over from the settled state each frame; release commits one undo step.

use egui::{Key, Modifiers, Response, Ui};
use glam::{DVec2, DVec3};

use crate::canvas::ScreenMap;
use crate::canvas_tools::Gesture;
use crate::command::Command;
use crate::pointer;
use crate::state::{Tool, UiState};
use editor::arrange::boxes_of;
use editor::pick::{self, Handle};
use editor::transform::{Axis, Kind, Pull, Transform};
use editor::{Edit, Shape, choose, flood, measure};
use scene::{BevLayer, BoxId, Frame, GridSpec, Scene, SceneBox};

use super::boxes::of;
use super::things::ThingCommand;
use super::things::drag::{self, Pull as ThingPull, ThingDrag};
use super::things::press::{self, ThingPress};
use super::{Choose, PaintShape, RegionShape, ToolCommand, gizmo};

/// What the pointer is doing with one of these tools.
#[derive(Clone, Debug, PartialEq)]
pub enum BevGesture {
    /// Paints the shape between two points.
    Paint {
        /// Rectangle, or line.
        rectangle: bool,
        /// Where the pointer went down, m.
        from_m: DVec2,
        /// Layer painted.
        layer: BevLayer,
        /// Width of a line, m.
        width_m: f64,
        /// Clears instead of setting.
        erase: bool,
    },
    /// Chooses boxes in a rectangle.
    Marquee {
        /// Where the pointer went down, m.
        from_m: DVec2,
        /// Where it is, m.
        to_m: DVec2,
        /// Adds to the selection.
        add: bool,
    },
    /// Chooses boxes in an outline.
    Lasso {
        /// Way so far, m.
        points_m: Vec<DVec2>,
        /// Adds to the selection.
        add: bool,
    },
    /// Marks what an outline goes around.
    RegionOutline {
        /// Way so far, m.
        points_m: Vec<DVec2>,
        /// Marks, or takes the mark away.
        on: bool,
    },
    /// Marks what is drawn anew.
    Region {
        /// Where the pointer went down, m.
        from_m: DVec2,
        /// Where it is, m.
        to_m: DVec2,
        /// Marks, or takes the mark away.
        on: bool,
    },
    /// Moves, turns or scales boxes.
    Transform {
        /// What becomes of them.
        transform: Transform,
        /// Where the pointer went down, m.
        from_m: DVec2,
        /// Where it is, m.
        to_m: DVec2,
        /// The pointer has left the place where it went down, or something was typed.
        moved: bool,
    },
    /// Draws with a tool for things.
    Thing(ThingPress),
    /// Drags chosen things.
    Things {
        /// What was taken hold of.
        drag: ThingDrag,
        /// Where the pointer went down, m.
        from_m: DVec2,
        /// The pointer has left the place where it went down.
        moved: bool,
    },
}

/// Points that the pointer may move and still click.
pub(crate) const CLICK_SLACK: f64 = 4.0;
/// Size of handles under the pointer, points.
const HANDLE_REACH: f64 = 8.0;

/// What a press begins, if it is for one of these tools.
pub(crate) fn begin(
    map: &ScreenMap,
    scene: &Scene,
    state: &UiState,
    at_m: DVec2,
    modifiers: Modifiers,
    commands: &mut Vec<Command>,
) -> Option<Gesture> {
    let frame = scene.frame();
    match state.tool {
        Tool::Brush => paint(frame, state, at_m, modifiers, commands),
        Tool::Select => Some(Gesture::Tool(select(
            map, scene, state, at_m, modifiers, commands,
        )?)),
        Tool::Measure => {
            let at_m = measure::snapped(frame, at_m, HANDLE_REACH / map.scale);
            commands.push(Command::Tools(ToolCommand::Point(at_m)));
            Some(Gesture::Ignored)
        }
        Tool::Region if state.tools.region_shape == RegionShape::Lasso => {
            Some(Gesture::Tool(BevGesture::RegionOutline {
                points_m: vec![at_m],
                on: !modifiers.shift,
            }))
        }
        Tool::Region => Some(Gesture::Tool(BevGesture::Region {
            from_m: at_m,
            to_m: at_m,
            on: !modifiers.shift,
        })),
        Tool::Thing(_) => {
            let begun = ThingPress::begin(state, at_m, modifiers.alt, CLICK_SLACK / map.scale, commands);
            Some(begun.map_or(Gesture::Ignored, |press| Gesture::Tool(BevGesture::Thing(press))))
        }
        Tool::AddBox | Tool::Voxel => None,
    }
}

fn paint(
    frame: &Frame,
    state: &UiState,
    at_m: DVec2,
    modifiers: Modifiers,
    commands: &mut Vec<Command>,
) -> Option<Gesture> {
    let shape = state.tools.shape;
    if modifiers.alt || shape == PaintShape::Pick {
        if let Some(layer) = layer_at(frame, state, at_m) {
            commands.push(Command::Tools(ToolCommand::PickLayer(layer)));
        }
        return Some(Gesture::Ignored);
    }
    let layer = state.layer;
    let erase = state.erase || modifiers.shift;
    if shape != PaintShape::Street && state.tools.is_locked(layer) {
        let text = format!(
            "Layer {:?} is locked: its lock is in the list of layers",
            layer.label()
        );
        commands.push(Command::Tools(ToolCommand::Note(text)));
        return Some(Gesture::Ignored);
    }
    let between = |rectangle| {
        Gesture::Tool(BevGesture::Paint {
            rectangle,
            from_m: at_m,
            layer,
            width_m: state.brush_m,
            erase,
        })
    };
    match shape {
        PaintShape::Stroke if modifiers.ctrl || modifiers.command => Some(between(false)),
        PaintShape::Stroke | PaintShape::Pick => None,
        PaintShape::Rectangle => Some(between(true)),
        PaintShape::Line => Some(between(false)),
        PaintShape::Polygon | PaintShape::Street => {
            commands.push(Command::Tools(ToolCommand::Point(at_m)));
            Some(Gesture::Ignored)
        }
        PaintShape::Fill => {
            if let Some(start) = GridSpec::column_at(at_m.x, at_m.y) {
                let cells = flood::flood(&frame.layout, layer, start, state.tools.fill);
                let label = if erase { "Fill: erase" } else { "Fill" };
                let edit = Edit::PaintBev {
                    layer,
                    shape: Shape::Cells(cells),
                    value: !erase,
                };
                commands.push(Command::Apply(label, vec![edit]));
            }
            Some(Gesture::Ignored)
        }
    }
}

/// The uppermost shown map layer under a point.
fn layer_at(frame: &Frame, state: &UiState, at_m: DVec2) -> Option<BevLayer> {
    let [x, y] = GridSpec::column_at(at_m.x, at_m.y)?;
    let order = crate::bev_image::DRAW_ORDER;
    let there = |l: &&BevLayer| state.shows(**l) && frame.layout.has(**l, x, y);
    order.iter().rev().find(there).copied()
}

fn select(
    map: &ScreenMap,
    scene: &Scene,
    state: &UiState,
    at_m: DVec2,
    modifiers: Modifiers,
    commands: &mut Vec<Command>,
) -> Option<BevGesture> {
    let frame = scene.frame();
    let chosen = state.chosen();
    let reach_m = HANDLE_REACH / map.scale;
    let hit = pick::box_at(frame, at_m);
    // The arrows light up under the pointer whatever chooses, so they can be pulled too.
    if let Some(axis) = gizmo::bev_axis_at(map, frame, state, at_m) {
        let mut transform = transform(frame, state, &chosen, state.tools.gizmo);
        transform.axis = Some(axis);
        return Some(held(transform, at_m));
    }
    if !state.tools.lasso {
        let first = state.selected.and_then(|id| frame.boxes.get(&id));
        let handle = first.and_then(|b| pick::handle_at(b, at_m, reach_m));
        match handle {
            Some(Handle::Rotate) => return Some(held(transform(frame, state, &chosen, Kind::Turn), at_m)),
            // A corner resizes one box: the canvas does that.
            Some(Handle::Corner(_)) if chosen.len() == 1 && !modifiers.shift => return None,
            _ => {}
        }
        if let Some(id) = hit {
            if modifiers.shift && !(chosen.len() == 1 && state.is_chosen(id)) {
                commands.push(Command::Tools(ToolCommand::Choose(vec![id], Choose::Toggle)));
                // Letting go elsewhere than pressed moves nothing: the selection is what was meant.
                return Some(BevGesture::Marquee {
                    from_m: at_m,
                    to_m: at_m,
                    add: true,
                });
            }
            let ids = match state.is_chosen(id) {
                true => std::iter::once(id)
                    .chain(chosen.into_iter().filter(|c| *c != id))
                    .collect(),
                false => {
                    commands.push(Command::Select(Some(id)));
                    vec![id]
                }
            };
            return Some(held(transform(frame, state, &ids, Kind::Move), at_m));
        }
        // A thing is chosen by a click and moved once it is: a drag over a forest still marks.
        if let Some(drag) = press::held_things(scene, state, at_m, reach_m, modifiers.shift) {
            return Some(BevGesture::Things {
                drag,
                from_m: at_m,
                moved: false,
            });
        }
    }
    let add = modifiers.shift;
    Some(match state.tools.lasso {
        true => BevGesture::Lasso {
            points_m: vec![at_m],
            add,
        },
        false => BevGesture::Marquee {
            from_m: at_m,
            to_m: at_m,
            add,
        },
    })
}

fn held(transform: Transform, at_m: DVec2) -> BevGesture {
    BevGesture::Transform {
        transform,
        from_m: at_m,
        to_m: at_m,
        moved: false,
    }
}

/// A drag of boxes that has not begun to move.
pub(crate) fn transform(frame: &Frame, state: &UiState, ids: &[BoxId], kind: Kind) -> Transform {
    Transform {
        kind,
        start: boxes_of(frame, ids),
        axis: None,
        orientation: state.tools.orientation,
        pivot: match kind {
            // The ring goes about the middle of what it is drawn around.
            Kind::Turn => editor::arrange::Pivot::Middle,
            _ => state.tools.pivot,
        },
        typed: String::new(),
    }
}

/// What a move of the pointer changes.
pub(crate) fn drag(
    gesture: &mut BevGesture,
    map: &ScreenMap,
    scene: &Scene,
    state: &UiState,
    at_m: DVec2,
    modifiers: Modifiers,
    commands: &mut Vec<Command>,
) {
    let frame = scene.frame();
    match gesture {
        BevGesture::Thing(press) => press.drag(at_m, modifiers.alt, commands),
        BevGesture::Things { drag, from_m, moved } => {
            *moved |= from_m.distance(at_m) * map.scale > CLICK_SLACK;
            if *moved {
                let edits = drag.edits(frame, state, at_m - *from_m, 0.0, modifiers.into());
                if !edits.is_empty() {
                    pointer::preview(commands, edits);
                }
            }
        }
        BevGesture::Paint {
            rectangle,
            from_m,
            layer,
            width_m,
            erase,
        } => {
            let shape = match rectangle {
                true => Shape::Rect {
                    min_m: from_m.min(at_m),
                    max_m: from_m.max(at_m),
                },
                false => Shape::Line {
                    points_m: vec![*from_m, straightened(*from_m, at_m, modifiers.shift && !*erase)],
                    width_m: *width_m,
                },
            };
            // Shapes beside the grid paint nothing; that is no error to show.
            if shape.cells().is_ok() {
                let edit = Edit::PaintBev {
                    layer: *layer,
                    shape,
                    value: !*erase,
                };
                pointer::preview(commands, vec![edit]);
            }
        }
        BevGesture::Region { from_m, to_m, on } if state.tools.region_shape == RegionShape::Brush => {
            commands.push(Command::Tools(ToolCommand::RegionStroke(
                *from_m,
                at_m,
                state.brush_m,
                *on,
            )));
            (*from_m, *to_m) = (at_m, at_m);
        }
        BevGesture::Marquee { to_m, .. } | BevGesture::Region { to_m, .. } => *to_m = at_m,
        BevGesture::Lasso { points_m, .. } | BevGesture::RegionOutline { points_m, .. } => {
            let apart_m = 2.0 / map.scale;
            if points_m.last().is_none_or(|p| p.distance(at_m) > apart_m) {
                points_m.push(at_m);
            }
        }
        BevGesture::Transform {
            transform,
            from_m,
            to_m,
            moved,
        } => {
            *to_m = at_m;
            *moved |= from_m.distance(at_m) * map.scale > CLICK_SLACK;
            if *moved {
                let edits = moved_boxes(transform, frame, state, *from_m, at_m, modifiers);
                if !edits.is_empty() {
                    pointer::preview(commands, edits);
                }
            }
        }
    }
}

/// With `snap` the point at the nearest multiple of 15 degrees.
fn straightened(from_m: DVec2, to_m: DVec2, snap: bool) -> DVec2 {
    let d = to_m - from_m;
    if !snap || d.length() == 0.0 {
        return to_m;
    }
    let step = 15f64.to_radians();
    from_m + DVec2::from_angle((d.to_angle() / step).round() * step) * d.length()
}

/// How far the pointer pulls a drag on this view.
pub(crate) fn pull(transform: &Transform, from_m: DVec2, to_m: DVec2, keep_axis: bool) -> Pull {
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

fn moved_boxes(
    transform: &Transform,
    frame: &Frame,
    state: &UiState,
    from_m: DVec2,
    to_m: DVec2,
    modifiers: Modifiers,
) -> Vec<Edit> {
    let pull = pull(
        transform,
        from_m,
        to_m,
        modifiers.shift && transform.kind == Kind::Move,
    );
    let turns = transform.kind == Kind::Turn;
    let snap = state.tools.snap(modifiers.ctrl || turns && modifiers.shift);
    let edits = transform.edits(frame, &pull, &snap);
    drag::along_with(edits, &transform.start, frame, state)
}

/// What letting go does.
pub(crate) fn end(
    gesture: BevGesture,
    map: &ScreenMap,
    scene: &Scene,
    state: &UiState,
    commands: &mut Vec<Command>,
) {
    let frame = scene.frame();
    match gesture {
        BevGesture::Thing(press) => press.end(commands),
        BevGesture::Things {
            drag, moved: true, ..
        } => {
            let commit = ThingCommand::Commit(drag.label());
            commands.push(Command::Tools(ToolCommand::Thing(commit)));
        }
        BevGesture::Things { drag, from_m, .. } => {
            // A click on one of several chooses it alone.
            if drag.pull() == ThingPull::Place {
                press::click(scene, state, from_m, HANDLE_REACH / map.scale, false, commands);
            }
        }
        BevGesture::Paint { rectangle, erase, .. } => {
            commands.push(Command::Commit(match (rectangle, erase) {
                (true, false) => "Paint rectangle",
                (true, true) => "Erase rectangle",
                (false, false) => "Paint line",
                (false, true) => "Erase line",
            }))
        }
        BevGesture::Marquee { from_m, to_m, add } => {
            if from_m.distance(to_m) * map.scale > CLICK_SLACK {
                chosen(choose::in_rect(frame, from_m, to_m), add, commands);
                let (min, max) = (from_m.min(to_m), from_m.max(to_m));
                press::in_area(
                    scene,
                    state,
                    |p| p.cmpge(min).all() && p.cmple(max).all(),
                    commands,
                );
            } else if pick::box_at(frame, from_m).is_none() || !add {
                press::click(scene, state, from_m, HANDLE_REACH / map.scale, add, commands);
            }
        }
        // A brush has marked on its way.
        BevGesture::Region { .. } if state.tools.region_shape == RegionShape::Brush => {}
        BevGesture::Region { from_m, to_m, on } => {
            // A click marks the cell under it.
            let around = DVec2::splat(GridSpec::VOXEL_M / 2.0);
            let (min_m, max_m) = (from_m.min(to_m) - around, from_m.max(to_m) + around);
            commands.push(Command::Tools(ToolCommand::Region(min_m, max_m, on)));
        }
        BevGesture::RegionOutline { points_m, on } => {
            commands.push(Command::Tools(ToolCommand::RegionOutline(points_m, on)));
        }
        BevGesture::Lasso { points_m, add } => {
            if points_m.len() >= 3 {
                chosen(choose::in_outline(frame, &points_m), add, commands);
                press::in_area(scene, state, |p| choose::is_inside(&points_m, p), commands);
            } else if let Some(id) = points_m.first().and_then(|p| pick::box_at(frame, *p)) {
                let how = if add { Choose::Toggle } else { Choose::Only };
                commands.push(Command::Tools(ToolCommand::Choose(vec![id], how)));
            } else if let Some(at_m) = points_m.first() {
                press::click(scene, state, *at_m, HANDLE_REACH / map.scale, add, commands);
            }
        }
        BevGesture::Transform {
            transform,
            moved: true,
            ..
        } => commands.push(Command::Commit(step_name(&transform))),
        BevGesture::Transform { transform, .. } => {
            // A click on one of several chooses it alone.
            if transform.kind == Kind::Move
                && transform.axis.is_none()
                && (state.chosen().len() > 1 || !state.tools.things.chosen.is_empty())
                && let Some(b) = transform.start.first()
            {
                commands.push(Command::Select(Some(b.id)));
            }
        }
    }
}

/// Chooses what a rectangle or lasso took.
pub(crate) fn chosen(ids: Vec<BoxId>, add: bool, commands: &mut Vec<Command>) {
    let how = if add { Choose::Add } else { Choose::Only };
    commands.push(Command::Tools(ToolCommand::Choose(ids, how)));
}

/// The name of the undo step that a drag makes.
pub(crate) fn step_name(transform: &Transform) -> &'static str {
    let boxes: &[SceneBox] = &transform.start;
    match transform.kind {
        Kind::Move => of(boxes, "Move box", "Move boxes"),
        Kind::Turn => of(boxes, "Turn box", "Turn boxes"),
        Kind::Scale => of(boxes, "Resize box", "Resize boxes"),
    }
}

/// What a key does to a drag of boxes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum DragKey {
    /// Something changed: show it.
    Changed,
    /// Enter: that is it.
    Done,
}

/// Takes the keys that a drag of boxes is steered by: X, Y, Z, digits, Backspace, Enter. They are nobody else's then.
pub(crate) fn drag_keys(ui: &Ui, transform: &mut Transform) -> Option<DragKey> {
    let mut answer = None;
    ui.input_mut(|i| {
        i.events.retain(|event| {
            let egui::Event::Key {
                key,
                pressed: true,
                repeat,
                modifiers,
                ..
            } = event
            else {
                return true;
            };
            if modifiers.ctrl || modifiers.command {
                return true;
            }
            let digit = match key {
                Key::Num0 => '0',
                Key::Num1 => '1',
                Key::Num2 => '2',
                Key::Num3 => '3',
                Key::Num4 => '4',
                Key::Num5 => '5',
                Key::Num6 => '6',
                Key::Num7 => '7',
                Key::Num8 => '8',
                Key::Num9 => '9',
                Key::Period | Key::Comma => '.',
                Key::Minus => '-',
                _ => ' ',
            };
            let axis = match key {
                Key::X => Some(Axis::X),
                Key::Y => Some(Axis::Y),
                Key::Z => Some(Axis::Z),
                _ => None,
            };
            match (digit, axis, key) {
                (_, Some(axis), _) if !repeat => transform.toggle_axis(axis),
                (_, Some(_), _) => return false,
                (_, _, Key::Enter) => {
                    answer = Some(DragKey::Done);
                    return false;
                }
                (_, _, Key::Backspace) => drop(transform.typed.pop()),
                (' ', ..) => return true,
                (c, ..) => transform.type_char(c),
            }
            answer = answer.or(Some(DragKey::Changed));
            false
        });
    });
    answer
}

/// Keys that belong to what is being drawn point by point, or dragged; they are taken from the frame's input.
pub(crate) fn keys(
    ui: &Ui,
    response: &Response,
    gesture: &mut Gesture,
    frame: &Frame,
    state: &UiState,
    commands: &mut Vec<Command>,
) {
    if let Gesture::Tool(BevGesture::Transform {
        transform,
        from_m,
        to_m,
        moved,
    }) = gesture
        && let Some(key) = drag_keys(ui, transform)
    {
        *moved = true;
        let edits = moved_boxes(transform, frame, state, *from_m, *to_m, ui.input(|i| i.modifiers));
        if !edits.is_empty() {
            pointer::preview(commands, edits);
        }
        if key == DragKey::Done {
            commands.push(Command::Commit(step_name(transform)));
            *gesture = Gesture::Ignored;
        }
        return;
    }
    press::keys(ui, response, state, commands);
    let draws =
        matches!(state.tools.shape, PaintShape::Polygon | PaintShape::Street) && state.tool == Tool::Brush;
    let points = match state.tool {
        Tool::Measure => state.tools.measure.points_m.len(),
        _ if draws => state.tools.points_m.len(),
        _ => 0,
    };
    if points == 0 || ui.ctx().text_edit_focused() {
        return;
    }
    let twice = draws
        && response.contains_pointer()
        && ui.input(|i| i.pointer.button_double_clicked(egui::PointerButton::Primary));
    if twice {
        commands.push(Command::Tools(ToolCommand::ClosePoints));
    }
    let mut take = |key: Key, command: ToolCommand| {
        if ui.input_mut(|i| i.consume_key(Modifiers::NONE, key)) {
            commands.push(Command::Tools(command));
        }
    };
    take(Key::Escape, ToolCommand::ClearPoints);
    if draws {
        take(Key::Enter, ToolCommand::ClosePoints);
        take(Key::Backspace, ToolCommand::DropPoint);
    }
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeMap;

    use super::*;
    use scene::{BevLayout, VoxelGrid};

    #[test]
    fn shift_keeps_to_an_axis_and_to_steps() {
        let at = straightened(DVec2::ZERO, DVec2::new(3.0, 1.0), true);
        assert!((at.to_angle().to_degrees() - 15.0).abs() < 1e-9);
        let frame = Frame::new(BevLayout::default(), BTreeMap::new(), VoxelGrid::new());
        let state = UiState::default();
        let t = transform(&frame, &state, &[], Kind::Move);
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
