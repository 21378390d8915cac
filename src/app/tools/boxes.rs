//! Carries out the commands of the tools.

use egui::Context;
use glam::DVec2;

use crate::panes::id::PaneId;
use crate::shell::app::SceneloomApp;
use crate::shell::toasts::Level;
use crate::state::Tool;
use editor::arrange::{self, Added, Clipboard};
use editor::{Edit, Shape, voxel_ops};
use job::redraw::RedrawMask;
use scene::{Frame, GridSpec};

use super::{Choose, PaintShape, ToolCommand};

impl SceneloomApp {
    /// Carries out one command of the tools.
    pub(crate) fn tool_command(&mut self, command: ToolCommand, ctx: &Context) {
        let ids = self.state.chosen();
        let frame = self.document.settled_scene().frame().clone();
        let of_voxels = command == ToolCommand::Delete && self.has_voxels();
        if !of_voxels && self.carry(&command, ctx) {
            return;
        }
        match command {
            ToolCommand::Thing(command) => self.thing_command(command),
            ToolCommand::Choose(ids, how) => self.state.choose(&ids, how),
            ToolCommand::ChooseAll => {
                let all: Vec<_> = frame.boxes.keys().copied().collect();
                self.state.choose(&all, Choose::Only);
            }
            ToolCommand::ChooseNone => {
                self.state.choose(&[], Choose::Only);
                self.state.tools.voxels.clear();
            }
            ToolCommand::ChooseOthers => {
                let others = frame.boxes.keys().copied().filter(|id| !ids.contains(id));
                let others: Vec<_> = others.collect();
                self.state.choose(&others, Choose::Only);
            }
            ToolCommand::Delete if self.has_voxels() => {
                self.paint_chosen_voxels("Remove voxels", scene::Class::Free);
            }
            ToolCommand::Delete => {
                let label = of(&ids, "Delete box", "Delete boxes");
                self.apply_some(label, arrange::remove(&frame, &ids));
            }
            ToolCommand::Duplicate => {
                let label = of(&ids, "Duplicate box", "Duplicate boxes");
                self.add_boxes(label, arrange::duplicate(&frame, &ids));
            }
            ToolCommand::Copy => self.copy(&frame, ctx),
            ToolCommand::Cut => {
                self.copy(&frame, ctx);
                let label = of(&ids, "Cut box", "Cut boxes");
                self.apply_some(label, arrange::remove(&frame, &ids));
            }
            ToolCommand::Paste => {
                let over_bev = self.state.hovered_pane == Some(PaneId::BEV);
                let at_m = self.state.tools.pointer_m.filter(|_| over_bev);
                let added = arrange::paste(&frame, &self.state.tools.clipboard, at_m);
                let label = of(&added.ids, "Paste box", "Paste boxes");
                self.add_boxes(label, added);
            }
            ToolCommand::Nudge(step_m) => {
                let label = of(&ids, "Nudge box", "Nudge boxes");
                self.apply_some(label, arrange::shift(&frame, &ids, step_m));
            }
            ToolCommand::Turn(degrees) => {
                let label = of(&ids, "Turn box", "Turn boxes");
                let pivot = self.state.tools.pivot;
                self.apply_some(label, arrange::turn(&frame, &ids, degrees, pivot));
            }
            ToolCommand::AskRow => match ids.is_empty() {
                true => self.note("Choose the boxes to copy first"),
                false => self.state.tools.row_open = true,
            },
            ToolCommand::Row(row) => self.add_boxes("Row of boxes", arrange::row(&frame, &ids, &row)),
            ToolCommand::Mirror(copies) => {
                let keep = self.state.tools.mirror_keeps_direction;
                if copies {
                    self.add_boxes("Mirrored copies", arrange::mirror_copy(&frame, &ids, keep));
                } else {
                    let label = of(&ids, "Mirror box", "Mirror boxes");
                    self.apply_some(label, arrange::mirror(&frame, &ids, keep));
                }
            }
            ToolCommand::DropToGround => {
                self.apply_some("Drop to ground", arrange::drop_to_ground(&frame, &ids));
            }
            ToolCommand::ToLane => self.apply_some("Snap to lane", arrange::to_lane(&frame, &ids)),
            ToolCommand::Lasso(lasso) => {
                (self.state.tool, self.state.tools.lasso) = (Tool::Select, lasso);
            }
            ToolCommand::Gizmo(kind) => {
                (self.state.tool, self.state.tools.gizmo) = (Tool::Select, kind);
            }
            ToolCommand::Shape(shape) => {
                (self.state.tool, self.state.tools.shape) = (Tool::Brush, shape);
                self.state.tools.points_m.clear();
            }
            ToolCommand::PickLayer(layer) => {
                self.state.layer = layer;
                // Picking is done once, then one paints.
                if self.state.tools.shape == PaintShape::Pick {
                    self.state.tools.shape = PaintShape::Stroke;
                }
            }
            ToolCommand::Voxels(mode) => {
                (self.state.tool, self.state.tools.voxel_mode) = (Tool::Voxel, mode);
            }
            ToolCommand::ChooseVoxels(cells, add) => {
                let chosen = &mut self.state.tools.voxels;
                if !add {
                    chosen.clear();
                }
                chosen.extend(cells);
                chosen.sort_unstable();
                chosen.dedup();
            }
            ToolCommand::PaintChosenVoxels(class) => {
                let label = match class {
                    scene::Class::Free => "Remove voxels",
                    _ => "Recolour voxels",
                };
                self.paint_chosen_voxels(label, class);
            }
            ToolCommand::LockChosenVoxels(lock) => {
                let cells = self.state.tools.voxels.clone();
                if lock {
                    self.apply_some("Lock voxels", voxel_ops::lock(&frame, &cells));
                } else if !cells.is_empty() {
                    self.apply("Unlock voxels", &[Edit::UnlockVoxels { cells }]);
                }
            }
            ToolCommand::PickClass(class) => self.state.voxel_class = class,
            ToolCommand::Symmetry => self.state.tools.symmetry = !self.state.tools.symmetry,
            ToolCommand::Point(at_m) => self.point(at_m),
            ToolCommand::ClosePoints => self.close_points(),
            ToolCommand::DropPoint => drop(self.state.tools.points_m.pop()),
            ToolCommand::ClearPoints => {
                self.state.tools.points_m.clear();
                self.state.tools.measure.points_m.clear();
            }
            ToolCommand::Region(a_m, b_m, on) => {
                for [i, j] in RedrawMask::of_rect(a_m, b_m).cells() {
                    self.state.tools.region.set(i, j, on);
                }
            }
            ToolCommand::RegionOutline(points_m, on) => {
                for [i, j] in RedrawMask::of_outline(&points_m).cells() {
                    self.state.tools.region.set(i, j, on);
                }
            }
            ToolCommand::RegionStroke(a_m, b_m, width_m, on) => {
                let stroke = Shape::Line {
                    points_m: vec![a_m, b_m],
                    width_m,
                };
                // A stroke beside the grid marks nothing.
                let columns = stroke.cells().unwrap_or_default();
                self.state.tools.region.set_columns(&columns, on);
            }
            ToolCommand::Note(text) => self.note(&text),
        }
    }

    pub(crate) fn note(&mut self, text: &str) {
        let now_s = self.now_s();
        self.toasts.push(Level::Info, text, now_s);
    }

    fn has_voxels(&self) -> bool {
        self.state.tool == Tool::Voxel && !self.state.tools.voxels.is_empty()
    }

    fn apply_some(&mut self, label: &'static str, edits: Vec<Edit>) {
        if !edits.is_empty() {
            self.apply(label, &edits);
        }
    }

    /// Adds boxes and chooses them.
    fn add_boxes(&mut self, label: &'static str, added: Added) {
        if !added.ids.is_empty() {
            self.apply(label, &added.edits);
            self.state.choose(&added.ids, Choose::Only);
            let outside = added.edits.iter().filter(|e| lies_outside(e)).count();
            if outside > 0 {
                let text = format!("{outside} of {} lie outside the map", added.ids.len());
                let now_s = self.now_s();
                self.toasts.push(Level::Info, text, now_s);
            }
        }
    }

    /// Keeps the chosen boxes, and gives the window system the edits that add them: without a text on its clipboard it
    /// would not tell of the chord that pastes.
    fn copy(&mut self, frame: &Frame, ctx: &egui::Context) {
        let boxes = arrange::boxes_of(frame, &self.state.chosen());
        if !boxes.is_empty() {
            let edits: Vec<Edit> = boxes.iter().map(arrange::adding).collect();
            ctx.copy_text(serde_json::to_string(&edits).unwrap_or_default());
            self.state.tools.clipboard = Clipboard { boxes };
            self.state.tools.things.clipboard.clear();
        }
    }

    fn paint_chosen_voxels(&mut self, label: &'static str, class: scene::Class) {
        let cells = std::mem::take(&mut self.state.tools.voxels);
        if !cells.is_empty() {
            self.apply(label, &[Edit::PaintVoxels { cells, class }]);
        }
    }

    fn point(&mut self, at_m: DVec2) {
        const APART_M: f64 = 0.05;
        let tools = &mut self.state.tools;
        if self.state.tool == Tool::Measure {
            tools.measure.add(at_m);
        } else if tools.points_m.last().is_none_or(|p| p.distance(at_m) > APART_M) {
            tools.points_m.push(at_m);
        }
    }

    /// Paints the outline or lays the street that was drawn.
    fn close_points(&mut self) {
        let street = self.state.tools.shape == PaintShape::Street;
        if street {
            let layout = &self.document.settled_scene().frame().layout;
            let edits = self.state.tools.street.edits(&self.state.tools.points_m, layout);
            // What was drawn stays until the layer is unlocked.
            if self.state.locked_layer(&edits).is_some() {
                return self.apply("Lay street", &edits);
            }
            self.state.tools.points_m.clear();
            return self.apply_some("Lay street", edits);
        }
        let points_m = std::mem::take(&mut self.state.tools.points_m);
        let value = !self.state.erase;
        if points_m.len() >= 3 {
            let layer = self.state.layer;
            let shape = Shape::Polygon { points_m };
            let label = if value { "Paint polygon" } else { "Erase polygon" };
            self.apply(label, &[Edit::PaintBev { layer, shape, value }]);
        }
    }
}

/// The name of a step for one box or for several.
pub(crate) fn of<T>(ids: &[T], one: &'static str, several: &'static str) -> &'static str {
    if ids.len() > 1 { several } else { one }
}

/// True if an edit adds a box whose middle is beside the grid.
fn lies_outside(edit: &Edit) -> bool {
    match edit {
        Edit::AddBox { center_m, .. } => GridSpec::column_at(center_m.x, center_m.y).is_none(),
        _ => false,
    }
}
