//! What a small camera network sees of the scene: boxes that it misses, things where there are none, and a search for a
//! change after which it misses the chosen box.

use std::sync::Arc;

use egui::{RichText, Ui};

use authoring::corner_case::{Change, Vary};
use editor::Document;
use language::{t, tf};
use scene::{BoxId, Scene};
use sensors::cameras::perceived;
use sensors::perceived::{LEAST_PX, SeenByRig};
use widgets::icons::{Icon, section};
use widgets::theme;

use super::id::PaneId;
use super::pane::{Pane, PaneContext, Place};
use crate::camera_views::camera_label;
use crate::command::{Command, ViewCommand};
use crate::perceiving::{Found, Perceiving};

/// From this width on there are columns, points.
const WIDE: f32 = 560.0;
/// Fewer pixels of things where there are none are not worth a line.
const LEAST_GHOST_PX: usize = 20;

/// The pane.
pub struct Perception {
    perceiving: Option<Perceiving>,
    vary: Vary,
}

impl Default for Perception {
    fn default() -> Self {
        Self {
            perceiving: None,
            vary: Vary::Distance,
        }
    }
}

impl Pane for Perception {
    fn id(&self) -> PaneId {
        PaneId::named("perception")
    }

    fn title(&self) -> String {
        "Perception".into()
    }

    fn icon(&self) -> Icon {
        Icon::Eye
    }

    fn place(&self) -> Place {
        Place::BelowViews
    }

    fn controls(&mut self, ui: &mut Ui, cx: &mut PaneContext<'_>, commands: &mut Vec<Command>) {
        let Some(perceiving) = &self.perceiving else {
            return;
        };
        if let Some(problem) = &perceiving.problem {
            ui.colored_label(ui.visuals().error_fg_color, problem);
        }
        if let Some((_, report)) = &perceiving.seen {
            let percent = format!("{:.1}", report.right * 100.0);
            let text = tf!("Classes right: {percent} % of the pixels", percent = percent);
            let what = t("A small camera network that learned from the pictures looks at all cameras.");
            ui.label(RichText::new(text).small().color(theme::text_weak()))
                .on_hover_text(what);
        }
        if perceiving.is_stale(cx.document.scene().rev) {
            ui.add(egui::Spinner::new().size(12.0).color(theme::text_weak()));
        }
        if ui.button(t("Show what it sees in the cameras")).clicked() {
            commands.push(Command::View(ViewCommand::Cameras(perceived::VIEW.id)));
        }
    }

    fn ui(&mut self, ui: &mut Ui, cx: &mut PaneContext<'_>, commands: &mut Vec<Command>) {
        if self.perceiving.is_none() {
            let ctx = ui.ctx().clone();
            self.perceiving = Perceiving::spawn(Arc::new(move || ctx.request_repaint())).ok();
        }
        let Some(perceiving) = &mut self.perceiving else {
            ui.label(t("The system gives no thread for it"));
            return;
        };
        if !cx.document.is_dragging() {
            perceiving.update(cx.document.scene());
        }
        let vary = &mut self.vary;
        let wide = ui.available_width() > WIDE;
        theme::panel_frame().show(ui, |ui| {
            let area = egui::ScrollArea::vertical()
                .id_salt("perception")
                .auto_shrink(false);
            area.show(ui, |ui| {
                ui.spacing_mut().item_spacing.y = 3.0;
                if !wide {
                    report_ui(ui, perceiving, cx, [true, true], commands);
                    search_ui(ui, perceiving, vary, cx, commands);
                    return;
                }
                ui.columns(3, |columns| {
                    report_ui(&mut columns[0], perceiving, cx, [true, false], commands);
                    report_ui(&mut columns[1], perceiving, cx, [false, true], commands);
                    search_ui(&mut columns[2], perceiving, vary, cx, commands);
                });
            });
        });
    }
}

/// What is missed and things where there are none, or what is seen, or both.
fn report_ui(
    ui: &mut Ui,
    perceiving: &Perceiving,
    cx: &PaneContext<'_>,
    [wrong, right]: [bool; 2],
    commands: &mut Vec<Command>,
) {
    let report = perceiving.seen.as_ref().map(|(_, report)| report);
    let boxes = report.map_or(&[][..], |report| &report.boxes);
    let missed = boxes.iter().take_while(|b| b.thing.is_missed()).count();
    let (missed, seen) = boxes.split_at(missed);
    for (title, boxes, shown) in [(t("Missed"), missed, wrong), (t("Seen"), seen, right)] {
        if !shown {
            continue;
        }
        section(ui, title);
        match (report, boxes) {
            (None, _) => drop(ui.add(egui::Spinner::new().size(12.0).color(theme::text_weak()))),
            (_, []) => drop(ui.label(RichText::new(t("none")).color(theme::text_weak()))),
            (_, boxes) => boxes.iter().for_each(|b| row(ui, b, cx, commands)),
        }
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

/// A box: a click chooses it.
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
    if ui.selectable_label(chosen, text).on_hover_text(hint).clicked() {
        commands.push(Command::Select(Some(id)));
    }
}

/// The search for a change after which the chosen box is missed.
fn search_ui(
    ui: &mut Ui,
    perceiving: &mut Perceiving,
    vary: &mut Vary,
    cx: &mut PaneContext<'_>,
    commands: &mut Vec<Command>,
) {
    section(ui, t("Corner case"));
    if let Some((change, [k, most])) = perceiving.searching {
        ui.horizontal(|ui| {
            ui.add(egui::Spinner::new().size(12.0));
            ui.label(format!("{k}/{most}  {}", words(change)));
            if ui.button(t("Stop")).clicked() {
                perceiving.stop();
            }
        });
        return;
    }
    let chosen = cx
        .state
        .selected
        .and_then(|id| cx.document.scene().frame().boxes.get(&id));
    let Some(b) = chosen else {
        let text =
            t("Choose a box, and a change of the scene is searched after which the network misses it.");
        ui.label(RichText::new(text).color(theme::text_weak()));
        return;
    };
    ui.horizontal(|ui| {
        ui.label(t("Vary"));
        egui::ComboBox::from_id_salt("vary")
            .selected_text(t(vary.title()))
            .show_ui(ui, |ui| {
                for value in Vary::ALL {
                    ui.selectable_value(vary, value, t(value.title()));
                }
            })
            .response
            .on_hover_text(t("What is changed step by step until the box is missed"))
            .accessible_name(t("Vary"));
        if ui.button(t("Search")).clicked() {
            perceiving.search(cx.document.scene(), b.id, *vary);
        }
    });
    let found = perceiving.found.as_mut().filter(|f| f.id == b.id);
    if let Some(found) = found {
        found_ui(ui, found, cx, commands);
    }
}

/// What a search found.
fn found_ui(ui: &mut Ui, found: &mut Found, cx: &mut PaneContext<'_>, commands: &mut Vec<Command>) {
    let Some(last) = found.search.tried.last() else {
        return;
    };
    if found.search.tried.len() == 1 && last.sight.visible_px < LEAST_PX {
        ui.label(tf!(
            "Too small to be judged: {n} pixels, at least {least} are needed",
            n = last.sight.visible_px,
            least = LEAST_PX
        ));
        return;
    }
    // The last try may show too little of it to be judged.
    let tried = &found.search.tried;
    let judged = tried.iter().rev().find(|t| t.sight.visible_px >= LEAST_PX);
    let last = judged.unwrap_or(last);
    let percent = format!("{:.0}", last.sight.share * 100.0);
    let Some(edits) = &found.search.found else {
        if found.search.stopped {
            ui.label(tf!("Stopped; not missed in the first {n} tries", n = tried.len()));
            return;
        }
        ui.label(tf!(
            "Not missed in {n} tries; in the last that can be judged {percent} % of {px} pixels are seen",
            n = tried.len(),
            percent = percent,
            px = last.sight.visible_px
        ));
        return;
    };
    ui.label(tf!(
        "Missed: {change}. {percent} % of {px} pixels are seen.",
        change = words(last.change),
        percent = percent,
        px = last.sight.visible_px
    ));
    if edits.is_empty() {
        return;
    }
    let current = cx.document.scene().rev == found.of;
    ui.add_enabled_ui(current, |ui| {
        ui.horizontal(|ui| {
            if ui
                .button(t("Take it"))
                .on_hover_text(t("Changes the scene so"))
                .clicked()
            {
                commands.push(Command::Apply("Corner case", edits.clone()));
            }
            let keep = ui.button(t("Keep as a version"));
            if keep
                .on_hover_text(t("The scene stays; the corner case is in the list of versions"))
                .clicked()
            {
                keep_version(cx.document.scene(), found.id, last.change, edits, cx.versions);
                found.kept = true;
                commands.push(Command::View(ViewCommand::ShowPane(PaneId::VERSIONS)));
            }
        });
    });
    if found.kept {
        ui.label(RichText::new(t("kept in the list of versions")).small().color(theme::text_weak()));
    }
    if !current {
        ui.label(
            RichText::new(t("the scene has changed since"))
                .small()
                .color(theme::text_weak()),
        );
    }
}

fn keep_version(
    scene: &Arc<Scene>,
    id: BoxId,
    change: Change,
    edits: &[editor::Edit],
    versions: &mut crate::shell::versions::Versions,
) {
    let mut document = Document::new((**scene).clone());
    // The search applied the same edits to the same state.
    if document.apply_all("Corner case", edits).is_ok() {
        let note = format!("#{}: {}", id.0, words(change));
        versions.push("Corner case".into(), note, document.scene().clone());
    }
}

/// A change in the language that is shown.
fn words(change: Change) -> String {
    let m = |m: f64| format!("{m:.1}");
    match change {
        Change::None => t("as it is").to_owned(),
        Change::Away(away_m) => tf!("{distance} m from the ego vehicle", distance = m(away_m)),
        Change::Aside(left_m) if left_m < 0.0 => tf!("{distance} m to the right", distance = m(-left_m)),
        Change::Aside(left_m) => tf!("{distance} m to the left", distance = m(left_m)),
        Change::Visibility(far_m) => tf!("visibility {distance} m", distance = format!("{far_m:.0}")),
        Change::Time(time) => t(time.name()).to_owned(),
        Change::Weather(weather) => t(weather.name()).to_owned(),
    }
}
