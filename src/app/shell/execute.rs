//! Carries out commands, after the frame was drawn.

use egui::Context;

use authoring::new_ground::with_scenery;
use editor::document::Label;
use editor::tools::{add_box, select};
use editor::{Edit, left_standing, off_lane};
use language::{t, tf};
use scene::SceneBox;

use super::app::SceneloomApp;
use super::toasts::MessageLevel;
use crate::command::Command;
use crate::panes::objects::neighbour;
use crate::tools::{Choose, ToolState};
use crate::windows::tour::Tour;

impl SceneloomApp {
    /// Carries out one command.
    pub fn execute(&mut self, command: Command, ctx: &Context) {
        self.state.note_paint();
        let before = self.document.settled_scene().content();
        let travels = matches!(
            command,
            Command::Undo | Command::Redo | Command::JumpTo(_) | Command::LeaveOut(_)
        );
        self.state.remember_selection(before);
        match command {
            Command::Apply(label, edits) => self.apply(label, &edits),
            Command::ApplyWords(words, edits) => self.apply_words(&words, &edits),
            Command::Preview(edits) => {
                let edits = self.unlocked(edits, false);
                let edits = self.meant(edits);
                if let Err(error) = self.document.preview_all(&edits) {
                    self.fail(error.to_string());
                }
            }
            Command::Commit(label) => {
                self.document.commit_drag(label);
                self.note_correction();
            }
            Command::CancelDrag => self.document.cancel_drag(),
            Command::Undo => self.undo(),
            Command::Redo => drop(self.document.redo_own()),
            Command::JumpTo(index) => drop(self.document.jump_to(index)),
            Command::LeaveOut(index) => self.leave_out(index),
            Command::ReplayHistory => self.replay_history(),
            Command::Tools(command) => self.tool_command(command, ctx),
            Command::Select(id) => self.state.choose(id.as_slice(), Choose::Only),
            Command::SelectNext(step) => {
                let scene = self.document.scene();
                let hidden = &scene.arranged.hidden.boxes;
                let seen = scene.frame().boxes.keys().filter(|id| !hidden.contains(id));
                let ids: Vec<_> = seen.copied().collect();
                let next = neighbour(&ids, self.state.selected, step);
                self.state.choose(next.as_slice(), Choose::Only);
            }
            Command::Escape => self.escape(),
            Command::Tool(tool) => {
                let ToolState { toolbox, hand, .. } = &mut self.state.tools;
                toolbox.take(hand, tool);
            }
            Command::BrushSize(step) => self.state.step_brush(step),
            Command::BrushHeight(step) => self.state.step_height(step),
            Command::ConfirmInferred => {
                self.state.correcting = false;
                self.apply("Confirm what was inferred", &[Edit::ConfirmInferred {}]);
            }
            Command::ClearPaint => self.apply("Unlock painted voxels", &[Edit::ClearPaint {}]),
            Command::Repair(command) => self.repair(command, ctx),
            Command::OpenSettings => self.state.windows.settings = true,
            Command::BeginTour => self.state.windows.tour = Some(Tour::begin(&self.document)),
            Command::PlaceClass(class) => {
                self.state.tool = add_box::ID;
                self.state.box_class = class;
            }
            Command::PaintWith(place) => self.state.paint_with(place),
            Command::PaintWithLast => self.state.paint_with_last(),
            Command::File(command) => self.file_command(command, ctx),
            Command::View(command) => self.view_command(command, ctx),
            Command::Generation(command) => self.generation_command(command, ctx),
            Command::Time(command) => self.time_command(command),
            Command::Toggle(window) => self.toggle(window),
        }
        // Without guesses there is nothing to correct, and no switch that shows the mode.
        self.state.correcting &= self.document.scene().frame().inferred.any();
        // Objects that an edit or undo removed are deselected.
        self.state.tidy_selection(self.document.scene());
        let after = self.document.settled_scene().content();
        if travels && after != before {
            self.state.recall_selection(after, self.document.scene());
        }
    }

    pub(crate) fn fail(&mut self, text: String) {
        let now_s = self.now_s();
        self.toasts.push(MessageLevel::Error, text, now_s);
    }

    pub(crate) fn apply(&mut self, label: impl Into<Label>, edits: &[Edit]) {
        if let Some(layer) = self
            .state
            .locked_layer(&self.document.scene().frame().layout, edits)
        {
            return self.fail(tf!("Layer \"{name}\" is locked", name = t(&layer.label())));
        }
        if self.state.tools.things.locked && edits.iter().any(Edit::is_of_things) {
            return self.fail(t("Scenery is locked").to_owned());
        }
        let open = self.unlocked(edits.to_vec(), true);
        if open.is_empty() && !edits.is_empty() {
            return;
        }
        let label = self.meant_label(label.into(), &open);
        let edits = self.meant(with_scenery(self.document.scene(), open));
        let said: Vec<String> = edits
            .iter()
            .filter_map(|edit| off_lane(self.document.scene(), edit))
            .chain(left_standing(self.document.scene(), &edits))
            .collect();
        match self.document.apply_all(label, &edits) {
            Err(error) => self.fail(error.to_string()),
            Ok(()) => {
                let now_s = self.now_s();
                said.into_iter()
                    .for_each(|line| self.toasts.push(MessageLevel::Info, line, now_s));
            }
        }
        self.note_correction();
    }

    /// Notes that a correction changed the condition under which the source was inverted.
    pub(crate) fn note_correction(&mut self) {
        if self.state.correcting {
            self.generation.live.source_changed();
        }
    }

    pub(crate) fn selected_box(&self) -> Option<SceneBox> {
        let id = self.state.selected?;
        self.document.scene().frame().boxes.get(&id).copied()
    }

    fn escape(&mut self) {
        if self.document.is_dragging() {
            self.document.cancel_drag();
        } else if self.state.windows.close_one() {
            // Closed the window that lies over everything else.
        } else if self.state.cameras.enlarged.is_some() {
            self.state.cameras.enlarged = None;
        } else if !self.state.tools.voxels.is_empty() {
            self.state.tools.voxels.clear();
        } else if self.state.tool != select::ID {
            self.state.tool = select::ID;
        } else if self.state.any_chosen() {
            self.state.choose(&[], Choose::Only);
        } else {
            self.state.correcting = false;
        }
    }
}
