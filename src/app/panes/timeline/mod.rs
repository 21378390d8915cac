//! The timeline: play, scrub, step; moving objects, their keyframes and speeds.

mod graph;
mod row_menu;
mod rows;
mod transport;

pub(crate) use transport::scope_name;

use egui::Ui;

use super::id::PaneId;
use super::motion_menu;
use super::pane::{Pane, PaneContext, PanePlacement};
use crate::command::Command;
use editor::Edit;
use language::{t, tf};
use widgets::icons::Icon;
use widgets::theme;

/// The pane of the timeline.
#[derive(Default)]
pub struct Timeline {
    rows: rows::TrackRows,
}

/// Length of a clip made by the button, s.
const USUAL_LENGTH_S: f64 = 8.0;

impl Pane for Timeline {
    fn id(&self) -> PaneId {
        PaneId::TIMELINE
    }

    fn title(&self) -> String {
        "Timeline".into()
    }

    fn icon(&self) -> Icon {
        Icon::Clock
    }

    fn place(&self) -> PanePlacement {
        PanePlacement::BelowViews
    }

    fn controls(&mut self, ui: &mut Ui, cx: &mut PaneContext<'_>, _commands: &mut Vec<Command>) {
        if cx.document.scene().clip().length_s > 0.0 {
            transport::scope(ui, cx.state);
        }
    }

    fn ui(&mut self, ui: &mut Ui, cx: &mut PaneContext<'_>, commands: &mut Vec<Command>) {
        theme::panel_frame().show(ui, |ui| {
            let scene = cx.document.scene().clone();
            ui.spacing_mut().item_spacing.y = 4.0;
            if scene.clip().length_s == 0.0 {
                return still(ui, &scene, cx, commands);
            }
            transport::bar(ui, &scene, cx.state, commands);
            let graph_points = if ui.available_height() > 150.0 { 58.0 } else { 0.0 };
            let rows_points = (ui.available_height() - graph_points).max(40.0);
            let findings = cx.checking.findings().map_or(&[][..], |f| f.as_slice());
            let track = self
                .rows
                .show(ui, &scene, (cx.state, findings), rows_points, commands);
            if graph_points > 0.0 {
                graph::show(ui, &scene, cx.state.selected, track);
            }
        });
    }
}

/// Draws the pane for a scene of one moment, with the buttons that turn it into a clip.
fn still(ui: &mut Ui, scene: &scene::Scene, cx: &mut PaneContext<'_>, commands: &mut Vec<Command>) {
    ui.label(t("This scene is one moment: nothing in it moves."));
    let hint =
        t("Let something move: choose an object, then a motion. Or make the scene longer and set keyframes.");
    ui.label(egui::RichText::new(hint).color(theme::text_weak()));
    ui.horizontal(|ui| {
        motion_menu::menu(ui, scene, cx.state, commands);
        transport::forecast(ui, commands);
        if ui
            .button(tf!("Make it {n} s long", n = format!("{USUAL_LENGTH_S:.0}")))
            .clicked()
        {
            let edit = Edit::SetLength {
                length_s: USUAL_LENGTH_S,
                rate_hz: None,
            };
            commands.push(Command::Apply("Set length", vec![edit]));
        }
    });
}
