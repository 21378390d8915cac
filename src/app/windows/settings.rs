//! The window of all settings: language, looks, memory, keys, the first minutes, assistants.

use egui::{Ui, Window};

use crate::command::{Command, FileCommand};
use crate::painting::PaintWish;
use crate::shell::guests::{Guests, OpenDoor};
use crate::shell::keymap::{Chords, Keymap, PRESETS};
use crate::shell::settings::Settings;
use crate::windows::open::OpenWindows;
use language::t;
use scene::classes::Palette;
use sensors::pictures::painter::{PaintOptions, SchedulerKind};
use widgets::icons::section;
use widgets::theme::{self, Theme};

/// Width of its contents, points.
const WIDTH: f32 = 420.0;
/// Width of the names, points.
const NAMES: f32 = 130.0;

/// Height of the bars at the top and at the bottom, points.
const BARS: f32 = 42.0;

/// Data that the window changes or shows.
pub struct Choices<'a> {
    /// The settings.
    pub settings: &'a mut Settings,
    /// The chords of all actions.
    pub keymap: &'a mut Keymap,
    /// State of the door for assistants.
    pub guests: &'a Guests,
}

/// Draws the window while it is open.
pub fn settings_ui(ui: &Ui, choices: Choices<'_>, windows: &mut OpenWindows, commands: &mut Vec<Command>) {
    if !windows.settings {
        return;
    }
    let mut open = true;
    let most = ui.max_rect().height() - 4.0 * BARS;
    Window::new(t("Settings"))
        .id(egui::Id::unique("settings"))
        .open(&mut open)
        .resizable(false)
        .collapsible(false)
        .default_pos(ui.max_rect().center() - egui::vec2(WIDTH / 2.0, 240.0))
        .show(ui.ctx(), |ui| {
            // In a low window the contents scroll.
            let scroll = egui::ScrollArea::vertical()
                .max_height(most)
                .min_scrolled_height(most);
            scroll.show(ui, |ui| {
                ui.set_width(WIDTH);
                let Choices {
                    settings,
                    keymap,
                    guests,
                } = choices;
                section(ui, t("Looks"));
                looks(ui, settings);
                section(ui, t("Work"));
                work(ui, settings, keymap, windows);
                section(ui, t("Learned pictures"));
                ui.checkbox(
                    &mut settings.learned_pictures,
                    t("Offer them among the views, as an experiment"),
                )
                .on_hover_text(t(
                    "A network paints what the cameras see. The exact pictures look better",
                ));
                painting(ui, &mut settings.painting, commands);
                section(ui, t("First minutes"));
                rows(ui, "first minutes", |ui| {
                    ui.label(t("At the start"));
                    ui.checkbox(&mut settings.start_screen, t("Show the start screen"));
                    ui.end_row();
                    ui.label(t("Tour"));
                    if ui.button(t("Begin the tour in three steps")).clicked() {
                        commands.push(Command::BeginTour);
                    }
                    ui.end_row();
                });
                if guests.are_possible() {
                    section(ui, t("Assistants"));
                    assistants(ui, settings, guests);
                }
            });
        });
    windows.settings &= open;
}

/// Rows of names and values.
fn rows(ui: &mut Ui, salt: &str, add: impl FnOnce(&mut Ui)) {
    egui::Grid::new(("settings", salt))
        .num_columns(2)
        .min_col_width(NAMES)
        .spacing([theme::GAP * 2.0, theme::GAP])
        .show(ui, add);
    ui.add_space(theme::GAP);
}

fn looks(ui: &mut Ui, settings: &mut Settings) {
    rows(ui, "looks", |ui| {
        ui.label(t("Language"));
        languages(ui, settings);
        ui.end_row();
        ui.label(t("Theme"));
        ui.horizontal(|ui| {
            ui.selectable_value(&mut settings.theme, Theme::Dark, t("Dark"));
            ui.selectable_value(&mut settings.theme, Theme::Light, t("Light"));
        });
        ui.end_row();
        ui.label(t("Class colours"));
        ui.horizontal(|ui| {
            ui.selectable_value(&mut settings.classes, Palette::Standard, t("Standard"));
            ui.selectable_value(
                &mut settings.classes,
                Palette::ColorBlindSafe,
                t("Colour-blind safe"),
            );
        });
        ui.end_row();
        ui.label(t("Size of everything"));
        let mut percent = (ui.ctx().zoom_factor() * 100.0).round();
        let slider = egui::DragValue::new(&mut percent)
            .range(50.0..=300.0)
            .speed(5.0)
            .suffix(" %")
            .update_while_editing(false); // the field keeps its size while it is typed into
        if ui.add(slider).on_hover_text(t("Ctrl + and Ctrl −")).changed() {
            settings.ui_scale = percent / 100.0;
            ui.ctx().set_zoom_factor(settings.ui_scale);
        }
        ui.end_row();
    });
}

/// Choice of the language: English, and all languages that have a file.
fn languages(ui: &mut Ui, settings: &mut Settings) {
    let all = language::all();
    let name = |code: &str| all.iter().find(|l| l.code == code).map_or("English", |l| &l.name);
    egui::ComboBox::from_id_salt("language")
        .selected_text(name(&settings.language))
        .show_ui(ui, |ui| {
            ui.selectable_value(&mut settings.language, String::new(), "English");
            for language in all {
                ui.selectable_value(&mut settings.language, language.code.clone(), &language.name);
            }
        })
        .response
        .on_hover_text(t(
            "Texts of the window. Sentences that change a scene are read in English. A file of your own, languages/NAME.json beside the settings, adds a language.",
        ))
        .accessible_name(t("Language"));
}

fn work(ui: &mut Ui, settings: &mut Settings, keymap: &mut Keymap, windows: &mut OpenWindows) {
    rows(ui, "work", |ui| {
        ui.label(t("Keys"));
        ui.horizontal(|ui| {
            let mut preset = keymap.preset.clone();
            egui::ComboBox::from_id_salt("preset of keys")
                .selected_text(t(&preset))
                .show_ui(ui, |ui| {
                    for (name, _) in PRESETS {
                        ui.selectable_value(&mut preset, name.to_owned(), t(name));
                    }
                })
                .response
                .on_hover_text(t(
                    "Keys as in another program; choosing one drops changes of single keys",
                ))
                .accessible_name(t("Preset"));
            if preset != keymap.preset {
                *keymap = Keymap::new(&preset, Chords::new());
            }
            if ui.button(t("Change keys…")).clicked() {
                windows.keys = true;
            }
        });
        ui.end_row();
        ui.label(t("Memory for undo"));
        let field = egui::DragValue::new(&mut settings.history_mb)
            .range(Settings::HISTORY_MB)
            .speed(4.0)
            .suffix(" MB");
        ui.add(field)
            .on_hover_text(t("Older steps go when the history takes more"))
            .accessible_name(t("Memory for undo"));
        ui.end_row();
        ui.label(t("Recent files"));
        let any = !settings.recent.is_empty();
        if ui.add_enabled(any, egui::Button::new(t("Forget them"))).clicked() {
            settings.recent.clear();
        }
        ui.end_row();
    });
}

/// Settings of the weights that paint camera pictures.
fn painting(ui: &mut Ui, painting: &mut PaintWish, commands: &mut Vec<Command>) {
    rows(ui, "painting", |ui| {
        ui.label(t("Weights"));
        ui.horizontal(|ui| {
            let choose = ui.button(t("Choose folder…")).on_hover_text(t(
                "A folder as training/train_pictures.py leaves it, or one of Stable Diffusion 1 or 2 with a model_index.json",
            ));
            if choose.clicked() {
                commands.push(Command::File(FileCommand::PictureWeights));
            }
            let own = painting.weights.is_some();
            let shipped = ui.add_enabled(own, egui::Button::new(t("Those of Sceneloom")));
            if shipped
                .on_hover_text(t("Back to the weights that came with the program"))
                .clicked()
            {
                (painting.weights, painting.steps, painting.guidance) = (None, None, None);
            }
        });
        ui.end_row();
        if let Some(folder) = &painting.weights {
            ui.label("");
            ui.add(egui::Label::new(folder.display().to_string()).truncate());
            ui.end_row();
        }
        let options = painting.options();
        ui.label(t("Steps"));
        let mut steps = options.steps;
        let field = egui::DragValue::new(&mut steps)
            .range(PaintWish::STEPS)
            .speed(0.1);
        let field = ui
            .add(field)
            .on_hover_text(t("From noise to a picture; more steps take longer"));
        if field.accessible_name(t("Steps")).changed() {
            painting.steps = Some(steps);
        }
        ui.end_row();
        ui.label(t("Guidance"));
        let mut guidance = options.guidance;
        let field = egui::DragValue::new(&mut guidance)
            .range(PaintWish::GUIDANCE)
            .speed(0.02)
            .fixed_decimals(1);
        let field = ui
            .add(field)
            .on_hover_text(t("How strictly the pictures obey what they are told"));
        if field.accessible_name(t("Guidance")).changed() {
            painting.guidance = Some(guidance);
        }
        ui.end_row();
        if painting.is_public() {
            public_weights(ui, painting, &options);
        }
    });
}

/// Further settings for public weights.
fn public_weights(ui: &mut Ui, painting: &mut PaintWish, options: &PaintOptions) {
    ui.label(t("Strength"));
    let mut strength = options.strength;
    let field = egui::DragValue::new(&mut strength)
        .range(PaintWish::STRENGTH)
        .speed(0.005)
        .fixed_decimals(2);
    let field = ui
        .add(field)
        .on_hover_text(t("How much of the rendered picture is painted anew"));
    if field.accessible_name(t("Strength")).changed() {
        painting.strength = Some(strength);
    }
    ui.end_row();
    ui.label(t("Width"));
    let mut width_px = options.width_px;
    let field = egui::DragValue::new(&mut width_px)
        .range(PaintWish::WIDTH_PX)
        .speed(4.0)
        .suffix(" px");
    if ui.add(field).accessible_name(t("Width")).changed() {
        painting.width_px = Some(width_px);
    }
    ui.end_row();
    ui.label(t("Words"));
    ui.add(egui::TextEdit::singleline(&mut painting.prompt).hint_text(t("a photograph of a street")))
        .on_hover_text(t("What the pictures show; time, weather and camera are added"));
    ui.end_row();
    ui.label(t("Without"));
    ui.add(egui::TextEdit::singleline(&mut painting.negative))
        .on_hover_text(t("What the pictures do not show, in words"));
    ui.end_row();
    ui.label(t("Scheduler"));
    let name = |kind: Option<SchedulerKind>| match kind {
        None => t("that of the folder"),
        Some(SchedulerKind::Ddim) => "DDIM",
        Some(SchedulerKind::Pndm) => "PNDM",
        Some(SchedulerKind::DpmPp) => "DPM++ 2M",
        Some(SchedulerKind::Euler) => "Euler",
        Some(SchedulerKind::UniPc) => "UniPC",
    };
    let all = SchedulerKind::ALL.into_iter().map(Some);
    egui::ComboBox::from_id_salt("scheduler")
        .selected_text(name(painting.scheduler))
        .show_ui(ui, |ui| {
            for kind in std::iter::once(None).chain(all) {
                ui.selectable_value(&mut painting.scheduler, kind, name(kind));
            }
        })
        .response
        .on_hover_text(t("How a step is made of what the network says"))
        .accessible_name(t("Scheduler"));
    ui.end_row();
}

fn assistants(ui: &mut Ui, settings: &mut Settings, guests: &Guests) {
    ui.checkbox(&mut settings.assistants, t("May drive this editor"))
        .on_hover_text(t(
            "Programs on this machine that show the token work on the scene, by a fixed set of calls; each change can be undone",
        ));
    if let (true, Some(door)) = (settings.assistants, guests.open()) {
        door_ui(ui, door);
    }
    if let Some(problem) = guests.problem() {
        ui.colored_label(ui.visuals().error_fg_color, problem);
    }
}

/// Draws the address and the token for assistants.
fn door_ui(ui: &mut Ui, door: &OpenDoor) {
    ui.add_space(theme::GAP);
    let row = |ui: &mut Ui, name: &str, copies: &str, value: &str| {
        ui.label(name);
        ui.horizontal(|ui| {
            ui.monospace(value);
            let copy = ui.small_button(t("Copy")).on_hover_text(copies);
            if copy.clicked() {
                ui.ctx().copy_text(value.to_owned());
            }
        });
        ui.end_row();
    };
    rows(ui, "assistants", |ui| {
        row(ui, t("Address"), t("Copy the address"), &door.url);
        row(ui, t("Token"), t("Copy the token"), &door.token);
        ui.label(t("Files"));
        ui.monospace(door.folder.display().to_string())
            .on_hover_text(t("The one folder whose files assistants may read and write"));
        ui.end_row();
    });
}
