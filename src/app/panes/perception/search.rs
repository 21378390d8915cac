//! The search for a change of the scene after which a network misses the chosen box.

use std::sync::Arc;

use egui::{RichText, Ui};

use authoring::corner_case::{NetworkSensors, SceneVariation, Tried, Vary, speed_matters};
use editor::Document;
use language::{t, tf};
use nets::perceiver::SCORE;
use scene::{BoxId, Scene};
use sensors::perceive::pictures::MISSED_BELOW;
use widgets::icons::section;
use widgets::theme;

use crate::command::{Command, TimeCommand, ViewCommand};
use crate::panes::id::PaneId;
use crate::panes::pane::PaneContext;
use crate::perceiving::{FinishedSearch, Perceiving};

/// Draws the search for a change after which the chosen box is missed.
pub(super) fn search_ui(
    ui: &mut Ui,
    perceiving: &mut Perceiving,
    (vary, by): (&mut Vary, NetworkSensors),
    cx: &mut PaneContext<'_>,
    commands: &mut Vec<Command>,
) {
    section(ui, t("Corner case"));
    if let Some((change, [k, most])) = perceiving.searching {
        ui.horizontal_wrapped(|ui| {
            if ui.button(t("Stop")).clicked() {
                perceiving.stop();
            }
            ui.add(egui::Spinner::new().size(12.0));
            ui.label(format!("{k}/{most}  {}", words(change)));
        });
    }
    let chosen = cx
        .state
        .selected
        .and_then(|id| cx.document.scene().frame().boxes.get(&id));
    let Some(b) = chosen else {
        if perceiving.searching.is_some() {
            return;
        }
        let text =
            t("Choose a box, and a change of the scene is searched after which the network misses it.");
        ui.label(RichText::new(text).color(theme::text_weak()));
        return;
    };
    if perceiving.searching.is_none() {
        wish_ui(ui, perceiving, (vary, by), b.id, cx.document.scene());
    }
    let found = perceiving
        .found
        .iter_mut()
        .filter(|f| f.id == b.id && f.by() == by);
    for (i, found) in found.enumerate() {
        if i > 0 {
            ui.separator();
        }
        ui.push_id(i, |ui| found_ui(ui, found, cx, commands));
    }
}

/// The choice of the property to vary, and the button that starts the search.
fn wish_ui(
    ui: &mut Ui,
    perceiving: &mut Perceiving,
    (vary, by): (&mut Vary, NetworkSensors),
    id: BoxId,
    scene: &Arc<Scene>,
) {
    ui.horizontal_wrapped(|ui| {
        ui.label(t("Vary"));
        egui::ComboBox::from_id_salt("vary")
            .selected_text(t(vary.title()))
            .show_ui(ui, |ui| {
                let matters = |v: &&Vary| **v != Vary::Speed || speed_matters(scene);
                for value in by.varies().iter().filter(matters) {
                    ui.selectable_value(vary, *value, t(value.title()));
                }
            })
            .response
            .on_hover_text(t("What is changed step by step until the box is missed"))
            .accessible_name(t("Vary"));
        let search = ui.button(t("Search"));
        let hint = match by {
            NetworkSensors::Cameras | NetworkSensors::Both => tf!(
                "Until the network takes less than {percent} % of the box for a thing",
                percent = format!("{:.0}", MISSED_BELOW * 100.0)
            ),
            NetworkSensors::Lidar => tf!(
                "Until the network is less than {percent} % sure of the box",
                percent = format!("{:.0}", SCORE * 100.0)
            ),
        };
        if search.on_hover_text(hint).clicked() {
            perceiving.search(scene, id, *vary, by);
        }
    });
}

/// Draws the result of a search.
fn found_ui(ui: &mut Ui, found: &mut FinishedSearch, cx: &mut PaneContext<'_>, commands: &mut Vec<Command>) {
    let Some(last) = found.search.tried.last() else {
        return;
    };
    let (id, at_s) = (found.id, found.search.at_s);
    let (n, least) = (last.sight.visible, last.sight.by.least());
    if found.search.tried.len() == 1 && !last.sight.is_judged() {
        ui.label(match last.sight.by {
            NetworkSensors::Cameras => tf!(
                "Too small to be judged: {n} pixels, at least {least} are needed",
                n = n,
                least = least
            ),
            NetworkSensors::Lidar => tf!(
                "Too few returns to be judged: {n}, at least {least} are needed",
                n = n,
                least = least
            ),
            NetworkSensors::Both => tf!(
                "Too few voxels to be judged: {n}, at least {least} are needed",
                n = n,
                least = least
            ),
        });
        return;
    }
    // In the last try too little of the box may be visible to judge it.
    let tried = &found.search.tried;
    let judged = tried.iter().rev().find(|t| t.sight.is_judged());
    let last = judged.unwrap_or(last);
    let Some(edits) = &found.search.found else {
        if found.search.stopped {
            ui.label(tf!("Stopped; not missed in the first {n} tries", n = tried.len()));
            return;
        }
        let n = tried.len();
        ui.label(tf!(
            "Not missed in {n} tries. In the last that can be judged, {change}: {sight}",
            n = n,
            change = words(last.change),
            sight = sight(last)
        ));
        return;
    };
    ui.label(tf!(
        "Missed: {change}. {sight}",
        change = words(last.change),
        sight = sight(last)
    ));
    if edits.is_empty() {
        return;
    }
    let current = cx.document.scene().rev == found.of;
    ui.add_enabled_ui(current, |ui| {
        ui.horizontal_wrapped(|ui| {
            if ui
                .button(t("Take it"))
                .on_hover_text(t("Changes the scene so"))
                .clicked()
            {
                commands.push(Command::Apply("Corner case", edits.clone()));
                commands.push(Command::Time(TimeCommand::Show(at_s)));
            }
            let keep = ui.button(t("Keep as a version"));
            if keep
                .on_hover_text(t("The scene stays; the corner case is in the list of versions"))
                .clicked()
            {
                keep_version(cx.document.scene(), (id, at_s), last.change, edits, cx.versions);
                found.kept = true;
                commands.push(Command::View(ViewCommand::ShowPane(PaneId::VERSIONS)));
            }
        });
    });
    if found.kept {
        ui.label(
            RichText::new(t("kept in the list of versions"))
                .small()
                .color(theme::text_weak()),
        );
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
    (id, at_s): (BoxId, f64),
    change: SceneVariation,
    edits: &[editor::Edit],
    versions: &mut crate::shell::versions::Versions,
) {
    let mut document = Document::new((**scene).clone());
    // The search applied the same edits to the same state.
    if document.apply_all("Corner case", edits).is_ok() {
        let note = format!("#{}: {}", id.0, words(change));
        let scene = Arc::new(document.scene().at(at_s));
        versions.push("Corner case".into(), note, scene);
    }
}

/// The prediction of the box in a try, in words.
fn sight(tried: &Tried) -> String {
    let (n, percent) = (tried.sight.visible, format!("{:.0}", tried.sight.share * 100.0));
    match tried.sight.by {
        NetworkSensors::Cameras => tf!("{percent} % of {n} pixels are seen.", percent = percent, n = n),
        NetworkSensors::Lidar => tf!("{n} returns, {percent} % sure.", percent = percent, n = n),
        NetworkSensors::Both => tf!("{percent} % of {n} voxels are seen.", percent = percent, n = n),
    }
}

/// A change in words of the interface's language.
fn words(change: SceneVariation) -> String {
    let m = |m: f64| format!("{m:.1}");
    match change {
        SceneVariation::None => t("as it is").to_owned(),
        SceneVariation::Away(away_m) => tf!("{distance} m from the ego vehicle", distance = m(away_m)),
        SceneVariation::Aside(left_m) if left_m < 0.0 => {
            tf!("{distance} m to the right", distance = m(-left_m))
        }
        SceneVariation::Aside(left_m) => tf!("{distance} m to the left", distance = m(left_m)),
        SceneVariation::Visibility(far_m) => tf!("visibility {distance} m", distance = format!("{far_m:.0}")),
        SceneVariation::Time(time) => t(time.name()).to_owned(),
        SceneVariation::Weather(weather) => t(weather.name()).to_owned(),
        SceneVariation::Speed(mps) => tf!("{speed} km/h", speed = format!("{:.0}", mps * 3.6)),
    }
}
