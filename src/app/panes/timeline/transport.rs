//! Buttons that play and step, the time in numbers, and the moments for which edits count.

use egui::{RichText, Ui};

use numeric::decimal::decimal;
use scene::{Clip, Scene, Scope};

use crate::command::{Command, FileCommand, TimeCommand};
use crate::fields::{short, typed};
use crate::panes::motion_menu;
use crate::playback::Playback;
use crate::state::UiState;
use editor::Edit;
use language::{t, tf};
use widgets::icons::{self, Icon};
use widgets::theme;

/// The name of a scope.
pub(crate) fn scope_name(scope: Scope) -> &'static str {
    match scope {
        Scope::Moment => "This moment",
        Scope::FromHereOn => "From here on",
        Scope::WholeTrack => "Whole track",
    }
}

/// Draws the choice of moments for which an edit of a moving object counts.
pub(super) fn scope(ui: &mut Ui, state: &mut UiState) {
    let choices = [
        (
            Scope::WholeTrack,
            t(scope_name(Scope::WholeTrack)),
            t("it moves as before, elsewhere"),
        ),
        (
            Scope::FromHereOn,
            t(scope_name(Scope::FromHereOn)),
            t("until a second before this moment it moves as before"),
        ),
        (
            Scope::Moment,
            t(scope_name(Scope::Moment)),
            t("a keyframe at this moment; its other keyframes stay"),
        ),
    ];
    icons::choice(
        ui,
        &mut state.playback.scope,
        &choices,
        t("Moved objects change for"),
    );
    ui.label(RichText::new(t("Moving objects:")).color(theme::text_weak()));
}

/// Draws the row of buttons and numbers.
pub(super) fn bar(ui: &mut Ui, scene: &Scene, state: &mut UiState, commands: &mut Vec<Command>) {
    let clip = scene.clip();
    ui.horizontal_wrapped(|ui| {
        ui.spacing_mut().item_spacing.x = 4.0;
        let playing = state.playback.playing;
        let buttons = [
            (
                Icon::ToStart,
                "To the start",
                "To the start",
                TimeCommand::ToStart,
            ),
            (
                Icon::KeyBack,
                "Keyframe before",
                "To the keyframe before, of what is chosen  (<)",
                TimeCommand::Key(-1),
            ),
            (
                Icon::StepBack,
                "Frame back",
                "A frame back  (,)",
                TimeCommand::Step(-1),
            ),
            (
                if playing { Icon::Pause } else { Icon::Play },
                "Play",
                "Play or pause  (Space)",
                TimeCommand::Play,
            ),
            (
                Icon::StepForward,
                "Frame forward",
                "A frame forward  (.)",
                TimeCommand::Step(1),
            ),
            (
                Icon::KeyForward,
                "Next keyframe",
                "To the next keyframe, of what is chosen  (>)",
                TimeCommand::Key(1),
            ),
            (Icon::ToEnd, "To the end", "To the end", TimeCommand::ToEnd),
        ];
        for (icon, name, hint, command) in buttons {
            let selected = playing && command == TimeCommand::Play;
            if icons::button(ui, icon, t(name), t(hint), selected, true).clicked() {
                commands.push(Command::Time(command));
            }
        }
        ui.separator();
        let frame = clip.frame_at(scene.time_s());
        let time = format!("{:5.2} s", scene.time_s());
        ui.label(RichText::new(time).monospace().color(theme::text_strong()))
            .on_hover_text(tf!(
                "Frame {frame} of {last}",
                frame = frame,
                last = clip.frames() - 1
            ));
        ui.label(
            RichText::new(tf!("frame {n}", n = format!("{frame:>3}")))
                .small()
                .monospace()
                .color(theme::text_weak()),
        );
        ui.separator();
        length(ui, clip, commands);
        speed(ui, &mut state.playback);
        ui.toggle_value(&mut state.playback.looping, t("Loop"));
        span(ui, clip, &mut state.playback, commands);
        ui.toggle_value(&mut state.playback.paths, t("Paths"))
            .on_hover_text(t("Where moving objects go, in both large views"));
        ui.toggle_value(&mut state.playback.onion, t("Onion skin"))
            .on_hover_text(t("Where the chosen object is a second earlier and later"));
        ui.toggle_value(&mut state.playback.follow, t("Follow"))
            .on_hover_text(t(
                "The 3D view goes along with the chosen object, or with us if none is chosen",
            ));
        ui.separator();
        motion_menu::menu(ui, scene, state, commands);
        traffic(ui, scene, commands);
        forecast(ui, commands);
        if ui
            .button(t("Save clip…"))
            .on_hover_text(t(
                "All that is played as moving pictures, of the 3D view, the map or the cameras",
            ))
            .clicked()
        {
            commands.push(Command::File(FileCommand::SaveClip));
        }
    });
}

/// The button that gives a path to objects that have only a speed.
fn traffic(ui: &mut Ui, scene: &Scene, commands: &mut Vec<Command>) {
    let standing = scene.canvas().boxes.values();
    let waiting = standing.filter(|b| b.velocity_mps.length() > 0.3).count();
    let hint = tf!(
        "{n} objects have a speed but stand still: they drive along their lanes and keep their distance",
        n = waiting
    );
    // The button stays in place when disabled, or the button beside it would come under the pointer.
    let button = ui.add_enabled(waiting > 0, egui::Button::new(t("Let traffic drive")));
    if button.on_hover_text(hint).clicked() {
        commands.push(Command::Time(TimeCommand::Traffic));
    }
}

/// Time by which a forecast lengthens a scene, s.
const FORECAST_S: f64 = 3.0;

/// The button that makes a forecast.
pub(super) fn forecast(ui: &mut Ui, commands: &mut Vec<Command>) {
    let hint = t(
        "3 s more: what moves goes on along its lane and behind whoever is ahead, so do we, and the map grows",
    );
    if ui.button(t("Forecast")).on_hover_text(hint).clicked() {
        commands.push(Command::Time(TimeCommand::Forecast(FORECAST_S)));
    }
}

fn length(ui: &mut Ui, clip: &Clip, commands: &mut Vec<Command>) {
    let mut length_s = clip.length_s;
    let value = typed(&mut length_s, |v| decimal(v, 1))
        .range(0.0..=Clip::MAX_LENGTH_S)
        .speed(0.1)
        .fixed_decimals(1)
        .prefix(t("of "))
        .suffix(" s");
    let response = ui.add(value).on_hover_text(t("How long the scene lasts"));
    let edit = || Edit::SetLength {
        length_s,
        rate_hz: None,
    };
    if response.changed() && length_s != clip.length_s {
        commands.push(Command::Preview(vec![edit()]));
    }
    if response.drag_stopped() || response.lost_focus() {
        commands.push(Command::Commit("Set length"));
    }
    let mut rate_hz = clip.rate_hz;
    let value = typed(&mut rate_hz, |v| short(v, 2))
        .range(1.0..=60.0)
        .speed(0.1)
        .suffix(" Hz");
    let response = ui
        .add(value)
        .on_hover_text(t("Frames per second of single steps and of what is written"));
    if response.changed() && rate_hz != clip.rate_hz {
        let edit = Edit::SetLength {
            length_s: clip.length_s,
            rate_hz: Some(rate_hz),
        };
        commands.push(Command::Preview(vec![edit]));
    }
    if response.drag_stopped() || response.lost_focus() {
        commands.push(Command::Commit("Set frame rate"));
    }
}

fn speed(ui: &mut Ui, playback: &mut Playback) {
    let name = |speed: f64| format!("{speed} x");
    egui::ComboBox::from_id_salt("speed")
        .selected_text(name(playback.speed))
        .width(52.0)
        .show_ui(ui, |ui| {
            for speed in Playback::SPEEDS {
                ui.selectable_value(&mut playback.speed, speed, name(speed));
            }
        })
        .response
        .on_hover_text(t("How fast it plays"));
}

fn span(ui: &mut Ui, clip: &Clip, playback: &mut Playback, commands: &mut Vec<Command>) {
    if ui
        .button(t("In"))
        .on_hover_text(t("What is played begins here"))
        .clicked()
    {
        commands.push(Command::Time(TimeCommand::In));
    }
    if ui
        .button(t("Out"))
        .on_hover_text(t("What is played ends here"))
        .clicked()
    {
        commands.push(Command::Time(TimeCommand::Out));
    }
    let [from, to] = playback.span(clip.length_s);
    if playback.span_s.is_some()
        && ui
            .button(format!("{from:.1} – {to:.1} s ×"))
            .on_hover_text(t("Plays all of it again"))
            .clicked()
    {
        playback.span_s = None;
    }
}
