//! What the pointer does on the bird's-eye view: strokes, boxes moved, turned, resized and placed.
//! Every drag starts over from the settled state each frame; release commits one undo step.

use egui::{Key, PointerButton, Response, Ui};
use glam::{DVec2, DVec3};

use crate::editor::pick::{self, Handle};
use crate::editor::{Edit, Shape};
use crate::scene::{BevLayer, BoxId, Class, Frame, PolylineKind, Scene, SceneBox};

use super::canvas::{Canvas, ScreenMap, readout};
use super::command::Command;
use super::pointer::{self, Step};
use super::state::{Tool, UiState};

/// What the pointer is doing.
#[derive(Clone, Debug, Default, PartialEq)]
pub enum Gesture {
    /// Nothing.
    #[default]
    None,
    /// Was cancelled; waits for the button to come up.
    Ignored,
    /// Paints.
    Stroke {
        /// Way so far, ego frame, m.
        points_m: Vec<DVec2>,
        /// Layer painted.
        layer: BevLayer,
        /// Width, m.
        width_m: f64,
        /// Clears instead of setting.
        erase: bool,
    },
    /// Takes hold of a box.
    Box {
        /// The box as it was.
        start: SceneBox,
        /// By what.
        handle: Handle,
        /// Where the pointer went down, ego frame, m.
        grabbed_m: DVec2,
        /// The pointer has left the place where it went down.
        moved: bool,
    },
    /// Places a box: the press is its place, the drag its heading.
    Place {
        /// Middle of the footprint, m.
        at_m: DVec2,
        /// Heading, rad.
        yaw_rad: f64,
    },
}

/// Points that the pointer may move and still click.
const CLICK_SLACK: f64 = 4.0;
/// Size of handles under the pointer, points.
const HANDLE_REACH: f64 = 8.0;

impl Canvas {
    /// Answers the pointer; pushes what should happen.
    pub(super) fn interact(
        &mut self,
        ui: &Ui,
        response: &Response,
        map: &ScreenMap,
        scene: &Scene,
        state: &mut UiState,
        commands: &mut Vec<Command>,
    ) {
        if let Some(pointer) = response.hover_pos() {
            state.readout = readout(scene, map.to_ego(pointer));
            self.set_cursor(ui, map, scene, state, map.to_ego(pointer));
        }
        let (space, shift, escape) = ui.input(|i| {
            (
                i.key_down(Key::Space),
                i.modifiers.shift,
                i.key_pressed(Key::Escape),
            )
        });
        if escape && self.gesture != Gesture::None {
            if self.gesture != Gesture::Ignored {
                commands.push(Command::CancelDrag);
            }
            self.gesture = Gesture::Ignored;
        }
        for step in pointer::steps(ui, response) {
            match step {
                Step::Press(PointerButton::Primary, at, modifiers) if !space => {
                    let at_m = map.to_ego(at);
                    self.gesture = self.begin(map, scene, state, at_m, modifiers.shift, commands);
                    self.drag(map, scene, at_m, modifiers.shift, commands);
                }
                Step::Move(at) => self.drag(map, scene, map.to_ego(at), shift, commands),
                Step::Release(PointerButton::Primary, at) if self.gesture != Gesture::None => {
                    self.drag(map, scene, map.to_ego(at), shift, commands);
                    let gesture = std::mem::take(&mut self.gesture);
                    end(gesture, state, commands);
                }
                _ => {}
            }
        }
    }

    fn set_cursor(&self, ui: &Ui, map: &ScreenMap, scene: &Scene, state: &UiState, at_m: DVec2) {
        use egui::CursorIcon;
        if ui.input(|i| i.key_down(Key::Space) || i.pointer.middle_down()) {
            ui.ctx().set_cursor_icon(CursorIcon::Grab);
            return;
        }
        let icon = match state.tool {
            Tool::Brush => CursorIcon::None,
            Tool::AddBox => CursorIcon::Crosshair,
            Tool::Voxel => CursorIcon::NotAllowed,
            Tool::Select => {
                let selected = state.selected.and_then(|id| scene.frame().boxes.get(&id));
                match selected.and_then(|b| pick::handle_at(b, at_m, HANDLE_REACH / map.scale)) {
                    Some(Handle::Rotate) => CursorIcon::Alias,
                    Some(Handle::Corner(_)) => CursorIcon::Crosshair,
                    Some(Handle::Body) => CursorIcon::Move,
                    None if pick::box_at(scene.frame(), at_m).is_some() => CursorIcon::PointingHand,
                    None => CursorIcon::Default,
                }
            }
        };
        ui.ctx().set_cursor_icon(icon);
    }

    fn begin(
        &self,
        map: &ScreenMap,
        scene: &Scene,
        state: &UiState,
        at_m: DVec2,
        shift: bool,
        commands: &mut Vec<Command>,
    ) -> Gesture {
        match state.tool {
            Tool::Brush => Gesture::Stroke {
                points_m: Vec::new(),
                layer: state.layer,
                width_m: state.brush_m,
                erase: state.erase || shift,
            },
            Tool::AddBox => Gesture::Place {
                at_m,
                yaw_rad: lane_heading(scene.frame(), at_m).unwrap_or(0.0),
            },
            Tool::Voxel => Gesture::Ignored,
            Tool::Select => {
                let boxes = &scene.frame().boxes;
                let reach_m = HANDLE_REACH / map.scale;
                let selected = state.selected.and_then(|id| boxes.get(&id));
                if let Some(b) = selected
                    && let Some(handle) = pick::handle_at(b, at_m, reach_m)
                {
                    return Gesture::Box {
                        start: *b,
                        handle,
                        grabbed_m: at_m,
                        moved: false,
                    };
                }
                let hit = pick::box_at(scene.frame(), at_m);
                if hit != state.selected {
                    commands.push(Command::Select(hit));
                }
                match hit.and_then(|id| boxes.get(&id)) {
                    Some(b) => Gesture::Box {
                        start: *b,
                        handle: Handle::Body,
                        grabbed_m: at_m,
                        moved: false,
                    },
                    None => Gesture::Ignored,
                }
            }
        }
    }

    fn drag(
        &mut self,
        map: &ScreenMap,
        scene: &Scene,
        at_m: DVec2,
        shift: bool,
        commands: &mut Vec<Command>,
    ) {
        match &mut self.gesture {
            Gesture::None | Gesture::Ignored => {}
            Gesture::Stroke {
                points_m,
                layer,
                width_m,
                erase,
            } => {
                let far_enough = points_m.last().is_none_or(|last| last.distance(at_m) > 0.1);
                if far_enough {
                    points_m.push(at_m);
                    let shape = Shape::Line {
                        points_m: points_m.clone(),
                        width_m: *width_m,
                    };
                    // Strokes beside the grid paint nothing; that is no error to show.
                    if shape.cells().is_ok() {
                        pointer::preview(
                            commands,
                            vec![Edit::PaintBev {
                                layer: *layer,
                                shape,
                                value: !*erase,
                            }],
                        );
                    }
                }
            }
            Gesture::Box {
                start,
                handle,
                grabbed_m,
                moved,
            } => {
                *moved |= grabbed_m.distance(at_m) * map.scale > CLICK_SLACK;
                if *moved && let Some(edit) = dragged(start, *handle, *grabbed_m, at_m, shift) {
                    pointer::preview(commands, vec![edit]);
                }
            }
            Gesture::Place {
                at_m: place_m,
                yaw_rad,
            } => {
                if place_m.distance(at_m) * map.scale > 3.0 * CLICK_SLACK {
                    *yaw_rad = snapped((at_m - *place_m).to_angle(), shift);
                } else {
                    *yaw_rad = lane_heading(scene.frame(), *place_m).unwrap_or(0.0);
                }
            }
        }
    }
}

fn end(gesture: Gesture, state: &UiState, commands: &mut Vec<Command>) {
    match gesture {
        Gesture::None | Gesture::Ignored => {}
        Gesture::Stroke { erase, .. } => {
            commands.push(Command::Commit(if erase { "Erase layer" } else { "Paint layer" }));
        }
        Gesture::Box {
            handle, moved: true, ..
        } => commands.push(Command::Commit(match handle {
            Handle::Body => "Move box",
            Handle::Rotate => "Turn box",
            Handle::Corner(_) => "Resize box",
        })),
        Gesture::Box { .. } => {}
        Gesture::Place { at_m, yaw_rad } => commands.push(Command::AddBox {
            class: state.box_class,
            at_m,
            yaw_rad,
        }),
    }
}

/// With `snap` the nearest multiple of 15 degrees.
fn snapped(yaw_rad: f64, snap: bool) -> f64 {
    let step = 15f64.to_radians();
    if snap {
        (yaw_rad / step).round() * step
    } else {
        yaw_rad
    }
}

/// The edit that a drag of a box asks for.
fn dragged(start: &SceneBox, handle: Handle, grabbed_m: DVec2, at_m: DVec2, snap: bool) -> Option<Edit> {
    let id = start.id;
    let change = |center_m: Option<DVec3>, yaw_deg: Option<f64>, size_m: Option<DVec3>| {
        Some(Edit::MoveBox {
            id,
            center_m,
            yaw_deg,
            size_m,
        })
    };
    match handle {
        Handle::Body => {
            let mut delta = at_m - grabbed_m;
            if snap {
                // Shift keeps to the axis that was moved along most.
                if delta.x.abs() > delta.y.abs() {
                    delta.y = 0.0
                } else {
                    delta.x = 0.0
                }
            }
            change(Some(start.center_m + delta.extend(0.0)), None, None)
        }
        Handle::Rotate => {
            let yaw_deg = pick::yaw_deg_towards(start, at_m)?;
            change(None, Some(snapped(yaw_deg.to_radians(), snap).to_degrees()), None)
        }
        Handle::Corner(corner) => {
            let (center_m, size_m) = pick::resized_by_corner(start, corner, at_m);
            change(Some(center_m), None, Some(size_m))
        }
    }
}

/// Heading of the nearest lane, if one is within reach of a point, rad.
pub(super) fn lane_heading(frame: &Frame, at_m: DVec2) -> Option<f64> {
    const REACH_M: f64 = 6.0;
    let lanes = frame
        .layout
        .polylines
        .iter()
        .filter(|l| l.kind == PolylineKind::LaneCenter);
    let pieces = lanes.flat_map(|l| l.points_m.array_windows::<2>());
    let measured = pieces.filter_map(|[a, b]| {
        let along = *b - *a;
        let length_squared = along.length_squared();
        if !length_squared.is_finite() || length_squared == 0.0 {
            return None;
        }
        let t = ((at_m - *a).dot(along) / length_squared).clamp(0.0, 1.0);
        Some((at_m.distance(*a + along * t), along.to_angle()))
    });
    let (distance_m, yaw_rad) = measured.min_by(|a, b| a.0.total_cmp(&b.0))?;
    (distance_m <= REACH_M).then_some(yaw_rad)
}

/// A box of typical size that stands on the ground; `None` for a class that is no object.
pub(super) fn new_box(frame: &Frame, class: Class, at_m: DVec2, yaw_rad: f64) -> Option<SceneBox> {
    let size_m = DVec3::from_array(class.typical_size_m()?);
    let id = frame
        .boxes
        .keys()
        .next_back()
        .map_or(Some(1), |id| id.0.checked_add(1))?;
    Some(SceneBox {
        id: BoxId(id),
        class,
        center_m: at_m.extend(size_m.z / 2.0),
        size_m,
        yaw_rad,
        velocity_mps: DVec2::ZERO,
    })
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeMap;

    use super::*;
    use crate::scene::{BevLayout, Polyline, VoxelGrid};

    #[test]
    fn new_boxes_follow_the_nearest_lane() {
        let lane = |from: [f64; 2], to: [f64; 2]| Polyline {
            kind: PolylineKind::LaneCenter,
            points_m: vec![from.into(), to.into()],
        };
        let lanes = vec![lane([-30.0, 2.0], [30.0, 2.0]), lane([30.0, -2.0], [-30.0, -2.0])];
        let layout = BevLayout::from_cells(vec![0; 40_000], lanes).expect("the right size");
        let frame = Frame::new(layout, BTreeMap::new(), VoxelGrid::new());
        let yaw = |x, y| lane_heading(&frame, DVec2::new(x, y));
        assert_eq!(yaw(0.0, 1.0), Some(0.0));
        assert!((yaw(0.0, -1.0).expect("near").abs() - std::f64::consts::PI).abs() < 1e-12);
        assert_eq!(yaw(0.0, 9.0), None);
        let car = new_box(&frame, Class::Car, DVec2::new(1.0, 2.0), 0.0).expect("an object");
        assert!((car.center_m.z - car.size_m.z / 2.0).abs() < 1e-12 && car.problem().is_none());
        assert!(new_box(&frame, Class::Terrain, DVec2::ZERO, 0.0).is_none());
    }

    #[test]
    fn shift_keeps_to_an_axis_and_to_steps() {
        let frame = Frame::new(BevLayout::default(), BTreeMap::new(), VoxelGrid::new());
        let b = new_box(&frame, Class::Car, DVec2::ZERO, 0.0).expect("an object");
        let edit = dragged(&b, Handle::Body, DVec2::ZERO, DVec2::new(3.0, 1.0), true);
        let Some(Edit::MoveBox {
            center_m: Some(c), ..
        }) = edit
        else {
            panic!()
        };
        assert_eq!(c.truncate(), DVec2::new(3.0, 0.0));
        let edit = dragged(&b, Handle::Rotate, DVec2::ZERO, DVec2::new(3.0, 1.0), true);
        let Some(Edit::MoveBox {
            yaw_deg: Some(yaw), ..
        }) = edit
        else {
            panic!()
        };
        assert!((yaw - 15.0).abs() < 1e-9, "{yaw}");
    }
}
