//! Predictions of the networks as lists: missed boxes, detected boxes, and false detections.

use egui::{RichText, Ui};

use crate::camera_views::camera_label;
use crate::command::{Command, ViewCommand};
use crate::panes::pane::PaneContext;
use crate::perceiving::Perceiving;
use language::{t, tf};
use scene::SceneBox;
use sensors::cameras::perceived;
use sensors::perceive::pictures::SeenByRig;
use sensors::perceive::sweep::SeenBySweep;
use sensors::perceive::voxels::SeenInVoxels;
use widgets::icons::section;
use widgets::theme;

/// Fewest pixels of false detections in a camera that are listed.
const LEAST_GHOST_PX: usize = 20;

/// Lists the missed boxes, the detected boxes, or both. `boxes` has the missed ones first; `None` before the first
/// prediction.
fn missed_and_seen<B>(
    ui: &mut Ui,
    boxes: Option<&[B]>,
    is_missed: impl Fn(&B) -> bool,
    [wrong, right]: [bool; 2],
    mut row: impl FnMut(&mut Ui, &B),
) {
    let all = boxes.unwrap_or_default();
    let (missed, seen) = all.split_at(all.iter().take_while(|b| is_missed(b)).count());
    for (title, part, shown) in [(t("Missed"), missed, wrong), (t("Seen"), seen, right)] {
        if !shown {
            continue;
        }
        section(ui, title);
        match (boxes, part) {
            (None, _) => drop(ui.add(egui::Spinner::new().size(12.0).color(theme::text_weak()))),
            (_, []) => drop(ui.label(RichText::new(t("none")).color(theme::text_weak()))),
            (_, part) => part.iter().for_each(|b| row(ui, b)),
        }
    }
}

/// Tells how many boxes of the scene are in no list.
fn left_out(ui: &mut Ui, listed: usize, cx: &PaneContext<'_>) {
    let n = cx.document.scene().frame().boxes.len().saturating_sub(listed);
    if n > 0 {
        let text = tf!(
            "{n} more are hidden, too small or too far away to be judged",
            n = n
        );
        ui.label(RichText::new(text).small().color(theme::text_weak()));
    }
}

/// Lists for the LiDAR network: missed boxes and false detections, or detected boxes, or both.
pub(super) fn sweep_ui(
    ui: &mut Ui,
    perceiving: &Perceiving,
    cx: &PaneContext<'_>,
    [wrong, right]: [bool; 2],
    commands: &mut Vec<Command>,
) {
    let report = perceiving.swept.as_ref().map(|(_, report)| report);
    let boxes = report.map(|report| &report.boxes[..]);
    missed_and_seen(ui, boxes, SeenBySweep::is_missed, [wrong, right], |ui, b| {
        swept_row(ui, b, cx, commands);
    });
    if let Some(report) = report.filter(|_| right) {
        left_out(ui, report.boxes.len(), cx);
    }
    let Some(report) = report.filter(|_| wrong) else {
        return;
    };
    let ghosts: Vec<_> = report.detections.iter().filter(|d| d.of.is_none()).collect();
    if ghosts.is_empty() {
        return;
    }
    section(ui, t("Things where there are none"));
    let ego_m = report.map_from_vehicle.translation_m;
    for ghost in ghosts {
        let text = tf!(
            "{class}: {percent} % sure, {distance} m from the ego vehicle",
            class = theme::sentence(t(&ghost.thing.class.label())),
            percent = format!("{:.0}", ghost.score * 100.0),
            distance = format!("{:.0}", (ghost.thing.center_m - ego_m).truncate().length())
        );
        if ui.selectable_label(false, text).clicked() {
            commands.push(Command::View(ViewCommand::FrameAt(ghost.thing.center_m)));
        }
    }
}

/// Lists for the network of both sensors: missed boxes and false detections, or detected boxes, or both.
pub(super) fn told_ui(
    ui: &mut Ui,
    perceiving: &Perceiving,
    cx: &PaneContext<'_>,
    [wrong, right]: [bool; 2],
    commands: &mut Vec<Command>,
) {
    let report = perceiving.told.as_ref().map(|(_, report)| report);
    let boxes = report.map(|report| &report.boxes[..]);
    missed_and_seen(ui, boxes, SeenInVoxels::is_missed, [wrong, right], |ui, b| {
        let Some(of) = cx.document.scene().frame().boxes.get(&b.id) else {
            return;
        };
        let text = tf!(
            "{name}: {percent} % of {n} voxels",
            name = format!("{} #{}", theme::sentence(t(&of.class.label())), b.id.0),
            n = b.voxels,
            percent = format!("{:.0}", b.share * 100.0)
        );
        let chosen = cx.state.selected == Some(b.id);
        let response = ui.selectable_label(chosen, text);
        choose_on_click(&response, of, commands);
    });
    if let Some(report) = report.filter(|_| right) {
        left_out(ui, report.boxes.len(), cx);
    }
    let Some(report) = report.filter(|r| wrong && !r.ghosts.is_empty()) else {
        return;
    };
    section(ui, t("Things where there are none"));
    let ego_m = report.map_from_vehicle.translation_m;
    for ghost in &report.ghosts {
        let text = tf!(
            "{class}: {n} voxels, {distance} m from the ego vehicle",
            class = theme::sentence(t(&ghost.thing.class.label())),
            n = ghost.voxels,
            distance = format!("{:.0}", (ghost.thing.center_m - ego_m).truncate().length())
        );
        if ui.selectable_label(false, text).clicked() {
            commands.push(Command::View(ViewCommand::FrameAt(ghost.thing.center_m)));
        }
    }
}

/// Row of a box in the sweep; a click chooses it.
fn swept_row(ui: &mut Ui, seen: &SeenBySweep, cx: &PaneContext<'_>, commands: &mut Vec<Command>) {
    let Some(b) = cx.document.scene().frame().boxes.get(&seen.id) else {
        return;
    };
    let name = format!("{} #{}", theme::sentence(t(&b.class.label())), seen.id.0);
    let text = match seen.score {
        Some(score) => tf!(
            "{name}: {n} returns, {percent} % sure",
            name = name,
            n = seen.returns,
            percent = format!("{:.0}", score * 100.0)
        ),
        None => tf!("{name}: {n} returns", name = name, n = seen.returns),
    };
    let chosen = cx.state.selected == Some(seen.id);
    let response = ui.selectable_label(chosen, text);
    choose_on_click(&response, b, commands);
}

/// Lists for the camera network: missed boxes and false detections, or detected boxes, or both.
pub(super) fn report_ui(
    ui: &mut Ui,
    perceiving: &Perceiving,
    cx: &PaneContext<'_>,
    [wrong, right]: [bool; 2],
    commands: &mut Vec<Command>,
) {
    let report = perceiving.seen.as_ref().map(|(_, report)| report);
    let boxes = report.map(|report| &report.boxes[..]);
    let is_missed = |b: &SeenByRig| b.thing.is_missed();
    missed_and_seen(ui, boxes, is_missed, [wrong, right], |ui, b| {
        row(ui, b, cx, commands)
    });
    if let Some(report) = report.filter(|_| right) {
        left_out(ui, report.boxes.len(), cx);
    }
    let Some(report) = report.filter(|_| wrong) else {
        return;
    };
    let ghosts: Vec<(usize, usize)> = report.ghost_px.iter().copied().enumerate().collect();
    let ghosts: Vec<_> = ghosts
        .into_iter()
        .filter(|(_, px)| *px >= LEAST_GHOST_PX)
        .collect();
    if ghosts.is_empty() {
        return;
    }
    section(ui, t("Things where there are none"));
    for (camera, px) in ghosts {
        let Some(of) = cx.scene.rig.cameras.get(camera) else {
            continue;
        };
        let text = tf!("{camera}: {n} pixels", camera = camera_label(&of.name), n = px);
        if ui.selectable_label(false, text).clicked() {
            commands.push(Command::View(ViewCommand::Cameras(perceived::VIEW.id)));
            commands.push(Command::View(ViewCommand::Inspect(Some(camera))));
        }
    }
}

/// Row of a box in the cameras; a click chooses it.
fn row(ui: &mut Ui, seen: &SeenByRig, cx: &PaneContext<'_>, commands: &mut Vec<Command>) {
    let id = seen.thing.id;
    let (Some(b), Some(camera)) = (
        cx.document.scene().frame().boxes.get(&id),
        cx.scene.rig.cameras.get(seen.camera),
    ) else {
        return;
    };
    let text = format!(
        "{} #{}  ·  {}  ·  {:.0} %",
        theme::sentence(t(&b.class.label())),
        id.0,
        camera_label(&camera.name),
        seen.thing.share * 100.0
    );
    let hint = tf!(
        "{n} pixels show it; the network takes {percent} % of them for a thing",
        n = seen.thing.visible_px,
        percent = format!("{:.0}", seen.thing.share * 100.0)
    );
    let chosen = cx.state.selected == Some(id);
    let response = ui.selectable_label(chosen, text).on_hover_text(hint);
    choose_on_click(&response, b, commands);
}

/// A click on the row of a box chooses it and moves the views there, as in the list of checks.
fn choose_on_click(response: &egui::Response, b: &SceneBox, commands: &mut Vec<Command>) {
    if response.clicked() {
        commands.push(Command::Select(Some(b.id)));
        commands.push(Command::View(ViewCommand::FrameAt(b.center_m)));
    }
}
