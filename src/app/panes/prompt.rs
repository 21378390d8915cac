//! The pane of the prompt: its field, the reading of its words, the plan of a new scene.

mod completion;
pub mod field;
mod graph;
pub mod plan;
mod reading;
pub mod recalled;
mod recent;
mod typed_text;

use egui::Ui;

use super::id::PaneId;
use super::pane::{Pane, PaneContext, PanePlacement};
use crate::command::Command;
use language::t;
use widgets::icons::Icon;
use widgets::theme;

/// The pane of the prompt.
pub struct PromptPane;

impl Pane for PromptPane {
    fn id(&self) -> PaneId {
        PaneId::PROMPT
    }

    fn title(&self) -> String {
        "Prompt".into()
    }

    fn icon(&self) -> Icon {
        Icon::Words
    }

    fn place(&self) -> PanePlacement {
        PanePlacement::ColumnAtOnce
    }

    fn column_points(&self) -> f32 {
        266.0
    }

    fn ui(&mut self, ui: &mut Ui, cx: &mut PaneContext<'_>, commands: &mut Vec<Command>) {
        let scene = cx.document.settled_scene();
        let tools = &mut cx.state.tools;
        theme::panel_frame().show(ui, |ui| {
            if !tools.region.is_empty() {
                ui.checkbox(&mut tools.words_within, t("Only in the marked region"))
                    .on_hover_text(t(
                        "Words change only what lies there, and what they add comes there. Roads, time and weather are the whole scene's.",
                    ));
            }
            cx.prompt.last_step = cx.document.undo_label().map(str::to_owned);
            cx.prompt.show(ui, scene, commands);
        });
    }
}
