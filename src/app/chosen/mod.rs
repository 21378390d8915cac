//! Carries out commands of the tools and of the selection.

mod arranging;
mod carry;
mod things;

use egui::Context;

use crate::command::Command;
use crate::panes::id::PaneId;
use crate::shell::actions::ACTIONS;
use crate::shell::app::SceneloomApp;
use crate::shell::toasts::MessageLevel;
use crate::tools::{Choose, ToolCommand, ToolState};
use editor::Edit;
use editor::arrange::{self, Added, Clipboard, Ties};
use editor::fit::fit;
use editor::rows;
use editor::tools::{Act, road, voxel};
use language::{t, tf};
use scene::Extent;

impl SceneloomApp {
    /// Deletes the chosen parts of roads. Returns false if none is chosen, or if their tool is not in hand.
    fn delete_road(&mut self) -> bool {
        let tools = &mut self.state.tools.hand;
        let Some(part) = tools.road.chosen.filter(|_| tools.tool == road::ID) else {
            return false;
        };
        tools.road.chosen = None;
        if let Some(edits) = road::deletion(self.document.settled_scene(), part) {
            self.apply_some("Delete road", edits);
        }
        true
    }

    /// Carries out one command of the tools.
    pub(crate) fn tool_command(&mut self, command: ToolCommand, ctx: &Context) {
        let ids = self.state.chosen();
        let frame = self.document.settled_scene().frame().clone();
        let ties = Ties::from_selection(self.document.settled_scene(), &ids);
        if command == ToolCommand::Delete && self.delete_road() {
            return;
        }
        let of_voxels = command == ToolCommand::Delete && self.has_voxels();
        if !of_voxels && self.carry(&command, ctx) {
            return;
        }
        match command {
            ToolCommand::Thing(command) => self.thing_command(command),
            ToolCommand::Arrange(how) => self.arrange(how),
            ToolCommand::HideOthers => self.hide_others(),
            ToolCommand::ShowAll => self.show_all(),
            ToolCommand::UnlockAll => self.unlock_all(),
            ToolCommand::Choose(ids, how) => self.state.choose(&ids, how),
            ToolCommand::ChooseAll => {
                let hidden = &self.document.settled_scene().arranged.hidden.boxes;
                let all = frame.boxes.keys().copied().filter(|id| !hidden.contains(id));
                let all: Vec<_> = all.collect();
                self.state.choose(&all, Choose::Only);
            }
            ToolCommand::ChooseNone => {
                self.state.choose(&[], Choose::Only);
                self.state.tools.voxels.clear();
            }
            ToolCommand::ChooseOthers => {
                let hidden = &self.document.scene().arranged.hidden.boxes;
                let others = frame.boxes.keys().copied();
                let others: Vec<_> = others
                    .filter(|id| !ids.contains(id) && !hidden.contains(id))
                    .collect();
                self.state.choose(&others, Choose::Only);
            }
            ToolCommand::Delete if self.has_voxels() => {
                for act in self.state.paint_chosen_voxels(scene::Class::Free) {
                    self.act(act, ctx);
                }
            }
            ToolCommand::Delete => {
                let label = count_noun(&ids, "Delete box", "Delete boxes");
                self.apply_some(label, arrange::remove(&frame, &ids));
            }
            ToolCommand::Duplicate => {
                let label = count_noun(&ids, "Duplicate box", "Duplicate boxes");
                self.add_boxes(label, arrange::duplicate(&frame, &ids).with(&ties));
            }
            ToolCommand::Copy => self.copy(ctx),
            ToolCommand::Cut => {
                self.copy(ctx);
                let label = count_noun(&ids, "Cut box", "Cut boxes");
                self.apply_some(label, arrange::remove(&frame, &ids));
            }
            ToolCommand::Paste => {
                let over_bev = self.state.pointed.pane == Some(PaneId::BEV);
                let at_m = self.state.tools.pointer_m.filter(|_| over_bev);
                let added = arrange::paste(&frame, &self.state.tools.clipboard, at_m);
                let label = count_noun(&added.ids, "Paste box", "Paste boxes");
                self.add_boxes(label, added);
            }
            ToolCommand::PasteAt(at_m) => {
                self.state.tools.pointer_m = Some(at_m);
                self.state.pointed.pane = Some(PaneId::BEV);
                self.tool_command(ToolCommand::Paste, ctx);
            }
            ToolCommand::Nudge(step_m) => {
                let label = count_noun(&ids, "Nudge box", "Nudge boxes");
                self.apply_some(label, arrange::shift(&frame, &ids, step_m));
            }
            ToolCommand::Turn(degrees) => {
                let label = count_noun(&ids, "Turn box", "Turn boxes");
                let pivot = self.state.tools.pivot;
                self.apply_some(label, arrange::turn(&frame, &ids, degrees, pivot));
            }
            ToolCommand::AskRow => match ids.is_empty() {
                true => self.note(t("Choose what to copy first")),
                false => self.state.tools.row_open = true,
            },
            ToolCommand::Row(row) => {
                self.add_boxes("Row of boxes", rows::row(&frame, &ids, &row).with(&ties))
            }
            ToolCommand::Mirror(copies) => {
                let keep = self.state.tools.mirror_keeps_direction;
                if copies {
                    self.add_boxes(
                        "Mirrored copies",
                        arrange::mirror_copy(&frame, &ids, keep).with(&ties),
                    );
                } else {
                    let label = count_noun(&ids, "Mirror box", "Mirror boxes");
                    self.apply_some(label, arrange::mirror(&frame, &ids, keep));
                }
            }
            ToolCommand::DropToGround => {
                self.apply_some("Drop to ground", arrange::drop_to_ground(&frame, &ids));
            }
            ToolCommand::Fit => {
                let edits: Vec<Edit> = ids.iter().filter_map(|id| fit(&frame, *id)).collect();
                match edits.is_empty() && !ids.is_empty() {
                    true => self.note(t("It fits its voxels, or has too few of them")),
                    false => {
                        self.apply_some("Fit to voxels", edits);
                        // The source was inverted for the box as it was; the box has changed.
                        self.generation.live.source_changed();
                    }
                }
            }
            ToolCommand::ToLane => self.apply_some("Snap to lane", arrange::to_lane(&frame, &ids)),
            ToolCommand::Act(act) => self.act(act, ctx),
            ToolCommand::Shortcut(id) => {
                let ToolState { toolbox, hand, .. } = &mut self.state.tools;
                toolbox.shortcut(hand, id);
            }
        }
    }

    pub(crate) fn note(&mut self, text: &str) {
        let now_s = self.now_s();
        self.toasts.push(MessageLevel::Info, text, now_s);
    }

    fn has_voxels(&self) -> bool {
        self.state.tool == voxel::ID && !self.state.tools.voxels.is_empty()
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
            let outside = added
                .edits
                .iter()
                .filter(|e| lies_outside(self.document.scene().frame().extent(), e))
                .count();
            if outside > 0 {
                let text = tf!(
                    "{n} of {all} lie outside the map",
                    n = outside,
                    all = added.ids.len()
                );
                let now_s = self.now_s();
                self.toasts.push(MessageLevel::Info, text, now_s);
            }
        }
    }

    /// Copies the chosen boxes, and puts the edits that add them on the system's clipboard. Without a text there the
    /// window system would not report the chord that pastes.
    fn copy(&mut self, ctx: &egui::Context) {
        let clipboard = Clipboard::from_selection(self.document.settled_scene(), &self.state.chosen());
        if !clipboard.boxes.is_empty() {
            let edits: Vec<Edit> = clipboard.boxes.iter().map(arrange::adding).collect();
            ctx.copy_text(serde_json::to_string(&edits).unwrap_or_default());
            self.state.tools.clipboard = clipboard;
            self.state.tools.things.clipboard.clear();
        }
    }

    /// Carries out an act of a tool.
    fn act(&mut self, act: Act, ctx: &Context) {
        match act {
            Act::Preview(edits) => self.execute(Command::Preview(edits), ctx),
            // An edit that fails is reported only when the button is released.
            Act::Try(edits) => {
                let edits = self.unlocked(edits, false);
                if self.document.preview_all(&edits).is_err() {
                    self.document.cancel_drag();
                }
            }
            Act::Commit(label) => {
                self.document.commit_drag(label);
                self.note_correction();
            }
            Act::Cancel => self.document.cancel_drag(),
            Act::Apply(label, edits) => self.apply(label, &edits),
            Act::AddBoxes(label, edits, ids) => {
                self.apply(label, &edits);
                self.state.choose(&ids, Choose::Only);
            }
            Act::AddThings(forms) => self.add_things("Add {things}", forms, Vec::new()),
            Act::Mark(area, on) => self
                .state
                .tools
                .mark(self.document.scene().frame().extent(), &area, on),
            Act::Note(text) => self.note(t(&text)),
            Act::Ask(id) => {
                let action = ACTIONS.iter().find(|a| a.id == id);
                if let Some(action) = action {
                    self.execute(action.command(), ctx);
                }
            }
        }
    }
}

/// The name of an undo step for one object or for several.
pub(crate) fn count_noun<T>(ids: &[T], one: &'static str, several: &'static str) -> &'static str {
    if ids.len() > 1 { several } else { one }
}

/// True if an edit adds a box whose centre is outside the map.
fn lies_outside(extent: Extent, edit: &Edit) -> bool {
    match edit {
        Edit::AddBox { center_m, .. } => extent.column_at(center_m.x, center_m.y).is_none(),
        _ => false,
    }
}
