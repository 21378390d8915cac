//! The bird's-eye view, with the reference state on it or beside it.

use egui::{Rect, Ui};

use super::areas::{clipped, halves, in_rect, left_part, sides};
use super::box_menu::{self, Under};
use super::compare::{CompareMode, legend, wipe_line};
use super::id::PaneId;
use super::pane::{Pane, PaneContext};
use crate::canvas::CanvasInput;
use crate::command::Command;
use crate::map_edges;
use crate::views_shown::Underlay;
use editor::pick;
use language::t;
use widgets::icons::{self, Icon};

/// The bird's-eye view.
pub struct Bev;

impl Pane for Bev {
    fn id(&self) -> PaneId {
        PaneId::BEV
    }

    fn title(&self) -> String {
        "Bird's-eye view".into()
    }

    fn icon(&self) -> Icon {
        Icon::Map
    }

    fn shows_before(&self) -> bool {
        true
    }

    fn controls(&mut self, ui: &mut Ui, cx: &mut PaneContext<'_>, _commands: &mut Vec<Command>) {
        let choices = [
            (Underlay::Layout, t("Layout"), t("map layers")),
            (Underlay::Occupancy, t("Occupancy"), t("voxels from above")),
            (Underlay::Both, t("Both"), t("layers over voxels")),
        ];
        icons::choice(
            ui,
            &mut cx.state.shown.underlay,
            &choices,
            t("Bird's-eye view shows"),
        );
    }

    fn ui(&mut self, ui: &mut Ui, cx: &mut PaneContext<'_>, commands: &mut Vec<Command>) {
        let area = ui.available_rect_before_wrap();
        let scene = cx.scene;

        let mode = cx.compare.mode(&cx.state.compare);
        let (left, right) = halves(area);
        let rect = if mode == CompareMode::Side { right } else { area };
        let input = CanvasInput {
            scene: &cx.seen.scene,
            settled: &cx.seen.settled,
            lidar: cx.sensing.lidar().map(|l| &**l),
            unsettled: cx.unsettled.clone(),
            generating: cx.generating,
        };
        if cx.compare.shows_reference(&cx.state.compare, scene)
            && let Some(map) = cx.canvas.map
        {
            clipped(ui, area, |ui| {
                cx.compare.bev_view.still(ui, area, &map, scene, cx.state);
            });
            return;
        }
        let (canvas, state) = (&mut *cx.canvas, &mut *cx.state);
        in_rect(ui, rect, |ui| {
            box_menu::hold(ui, PaneId::BEV);
            let response = canvas.show(ui, &input, state, commands);
            if let Some(map) = canvas.map {
                box_menu::of_view(ui, &response, (PaneId::BEV, scene, state), commands, |at| {
                    let at_m = map.to_ego(at);
                    Under {
                        id: pick::box_at(input.scene.frame(), at_m),
                        at_m: Some(at_m),
                    }
                });
            }
            if mode == CompareMode::Off
                && let Some(map) = &canvas.map
            {
                map_edges::show(ui, map, scene.canvas().extent(), commands);
            }
        });
        if let (true, Some(last), Some(map)) = (cx.tuning.show_modelled, &cx.tuning.last, &cx.canvas.map) {
            super::modelled::draw(ui, rect, map, last, cx.sensing.sampled());
        }
        if let (CompareMode::Off, Some(marks)) = (mode, &cx.state.shown.detection_marks) {
            let entries = marks.map_legend(scene.rev);
            legend(ui, area.left_top() + egui::vec2(8.0, 8.0), &entries);
        }
        let (Some(reference), Some(map)) = (cx.compare.reference.clone(), cx.canvas.map) else {
            return;
        };
        match mode {
            CompareMode::Off => {}
            CompareMode::Side => {
                clipped(ui, left, |ui| {
                    cx.compare.bev_view.still(ui, left, &map, &reference, cx.state);
                });
                sides(ui, left, right, cx.state.compare.names());
            }
            CompareMode::Wipe => {
                let part = left_part(area, cx.state.compare.wipe_at);
                clipped(ui, part, |ui| {
                    cx.compare.bev_view.still(ui, area, &map, &reference, cx.state);
                });
                wipe_line(ui, area, &mut cx.state.compare);
            }
            CompareMode::Difference => {
                if let Some((difference, texture)) = cx.compare.difference(ui, scene) {
                    let entries = difference.legend();
                    let extent = scene.frame().extent();
                    let (low, high) = (extent.min_m().truncate(), extent.max_m().truncate());
                    let grid = Rect::from_two_pos(map.to_screen(low), map.to_screen(high));
                    let unit = Rect::from_min_max(egui::pos2(0.0, 0.0), egui::pos2(1.0, 1.0));
                    let painter = ui.painter_at(area);
                    painter.image(texture, grid, unit, egui::Color32::WHITE);
                    legend(ui, area.left_top() + egui::vec2(8.0, 8.0), &entries);
                }
            }
        }
    }
}
