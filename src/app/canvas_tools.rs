//! What the pointer does on the bird's-eye view: strokes, boxes moved, turned, resized and placed.
//! Every drag starts over from the settled state each frame; release commits one undo step.

use egui::{Key, Modifiers, PointerButton, Response, Ui};
use glam::{DVec2, DVec3};

use editor::arrange::LANE_REACH_M;
use editor::lanes::nearest_lane;
use editor::pick::{self, Handle};
use editor::{Edit, Shape};
use scene::{BevLayer, BoxId, BoxLabel, Class, Frame, Scene, SceneBox};

use super::canvas::{Canvas, ScreenMap, readout};
use super::command::Command;
use super::pointer::{self, Step};
use super::state::{Tool, UiState};
use super::tools::bev::{self, BevGesture};
use super::tools::{PaintShape, things};

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
    /// Of the tools in `tools/bev.rs`.
    Tool(BevGesture),
    /// Takes hold of the corner of a box.
    Box {
        /// The box as it was.
        start: SceneBox,
        /// Index of the corner.
        corner: usize,
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
        let (space, escape) = ui.input(|i| (i.key_down(Key::Space), i.key_pressed(Key::Escape)));
        if escape && self.gesture != Gesture::None {
            if self.gesture != Gesture::Ignored {
                commands.push(Command::CancelDrag);
            }
            self.gesture = Gesture::Ignored;
        }
        let held = ui.input(|i| i.modifiers);
        for step in pointer::steps(ui, response) {
            match step {
                Step::Press(PointerButton::Primary, at, modifiers) if !space => {
                    let at_m = map.to_ego(at);
                    self.gesture = self.begin(map, scene, state, at_m, modifiers, commands);
                    self.drag(map, scene, state, at_m, modifiers, commands);
                }
                Step::Move(at) => self.drag(map, scene, state, map.to_ego(at), held, commands),
                Step::Release(PointerButton::Primary, at) if self.gesture != Gesture::None => {
                    self.drag(map, scene, state, map.to_ego(at), held, commands);
                    match std::mem::take(&mut self.gesture) {
                        Gesture::Tool(gesture) => bev::end(gesture, map, scene, state, commands),
                        gesture => end(gesture, state, commands),
                    }
                }
                _ => {}
            }
        }
        // After the pointer: the click that ends an outline is one of its points.
        bev::keys(ui, response, &mut self.gesture, scene.frame(), state, commands);
    }

    fn set_cursor(&self, ui: &Ui, map: &ScreenMap, scene: &Scene, state: &UiState, at_m: DVec2) {
        use egui::CursorIcon;
        if ui.input(|i| i.key_down(Key::Space) || i.pointer.middle_down()) {
            ui.ctx().set_cursor_icon(CursorIcon::Grab);
            return;
        }
        let icon = match state.tool {
            Tool::Brush if state.tools.is_locked(state.layer) => CursorIcon::NotAllowed,
            Tool::Brush if state.tools.shape == PaintShape::Stroke => CursorIcon::None,
            Tool::Brush => CursorIcon::Crosshair,
            Tool::Thing(_) if !state.tools.things.is_open() => CursorIcon::NotAllowed,
            Tool::AddBox | Tool::Measure | Tool::Region | Tool::Thing(_) => CursorIcon::Crosshair,
            Tool::Voxel => CursorIcon::NotAllowed,
            Tool::Select => {
                let selected = state.selected.and_then(|id| scene.frame().boxes.get(&id));
                match selected.and_then(|b| pick::handle_at(b, at_m, HANDLE_REACH / map.scale)) {
                    Some(Handle::Rotate) => CursorIcon::Alias,
                    Some(Handle::Corner(_)) => CursorIcon::Crosshair,
                    Some(Handle::Body) => CursorIcon::Move,
                    None if pick::box_at(scene.frame(), at_m).is_some() => CursorIcon::PointingHand,
                    None => match things::draw::under(scene, state, at_m, HANDLE_REACH / map.scale) {
                        Some(id) if state.tools.things.chosen.contains(&id) => CursorIcon::Move,
                        Some(_) => CursorIcon::PointingHand,
                        None => CursorIcon::Default,
                    },
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
        modifiers: Modifiers,
        commands: &mut Vec<Command>,
    ) -> Gesture {
        if let Some(gesture) = bev::begin(map, scene, state, at_m, modifiers, commands) {
            return gesture;
        }
        match state.tool {
            Tool::Brush => Gesture::Stroke {
                points_m: Vec::new(),
                layer: state.layer,
                width_m: state.brush_m,
                erase: state.erase || modifiers.shift,
            },
            Tool::AddBox => Gesture::Place {
                at_m,
                yaw_rad: lane_heading(scene.frame(), at_m).unwrap_or(0.0),
            },
            Tool::Voxel | Tool::Measure | Tool::Region | Tool::Thing(_) => Gesture::Ignored,
            // What is left to the canvas is the corner of the one chosen box.
            Tool::Select => {
                let chosen = state.selected.and_then(|id| scene.frame().boxes.get(&id));
                let handle = chosen.and_then(|b| pick::handle_at(b, at_m, HANDLE_REACH / map.scale));
                match (chosen, handle) {
                    (Some(b), Some(Handle::Corner(corner))) => Gesture::Box {
                        start: *b,
                        corner,
                        grabbed_m: at_m,
                        moved: false,
                    },
                    _ => Gesture::Ignored,
                }
            }
        }
    }

    fn drag(
        &mut self,
        map: &ScreenMap,
        scene: &Scene,
        state: &UiState,
        at_m: DVec2,
        modifiers: Modifiers,
        commands: &mut Vec<Command>,
    ) {
        match &mut self.gesture {
            Gesture::None | Gesture::Ignored => {}
            Gesture::Tool(gesture) => {
                bev::drag(gesture, map, scene, state, at_m, modifiers, commands);
            }
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
                corner,
                grabbed_m,
                moved,
            } => {
                *moved |= grabbed_m.distance(at_m) * map.scale > CLICK_SLACK;
                if *moved {
                    let (center_m, size_m) = pick::resized_by_corner(start, *corner, at_m);
                    let edit = Edit::MoveBox {
                        id: start.id,
                        center_m: Some(center_m),
                        yaw_deg: None,
                        size_m: Some(size_m),
                    };
                    pointer::preview(commands, vec![edit]);
                }
            }
            Gesture::Place {
                at_m: place_m,
                yaw_rad,
            } => {
                if place_m.distance(at_m) * map.scale > 3.0 * CLICK_SLACK {
                    *yaw_rad = snapped((at_m - *place_m).to_angle(), modifiers.shift);
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
        Gesture::Box { moved: true, .. } => commands.push(Command::Commit("Resize box")),
        Gesture::Tool(_) | Gesture::Box { .. } => {}
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

/// Heading of the nearest lane, if one is within reach of a point, rad.
pub(super) fn lane_heading(frame: &Frame, at_m: DVec2) -> Option<f64> {
    nearest_lane(&frame.layout, at_m, LANE_REACH_M).map(|lane| lane.yaw_rad)
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
        center_m: at_m.extend(frame.layout.relief.height_m(at_m) + size_m.z / 2.0),
        size_m,
        yaw_rad,
        velocity_mps: DVec2::ZERO,
        label: BoxLabel::default(),
    })
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeMap;

    use super::*;
    use scene::{BevLayout, Polyline, PolylineKind, VoxelGrid};

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
}
