//! The left pane: options of the tool in hand, and the layers of the bird's-eye view.

use egui::accesskit::Role;
use egui::{Color32, Sense, Ui, WidgetInfo, pos2, vec2};

use super::id::PaneId;
use super::pane::{Pane, PaneContext};
use super::saved_brushes::saved_brushes_ui;
use crate::bev_image::DRAW_ORDER;
use crate::command::{Command, GenerationCommand};
use crate::pointer::carry_out;
use crate::scenery::{SceneryMethod, TYPICAL_BUILDING, TYPICAL_VEGETATION};
use crate::seed_wish::SeedWish;
use crate::state::UiState;
use crate::tools::things::ThingCommand;
use crate::tools::{ToolCommand, ToolState, option_rows};
use crate::views_shown::Underlay;
use editor::merge::merge;
use editor::tools::brush;
use language::{t, tf};
use scene::{BevLayer, BevLayout, Frame, Scene};
use widgets::hint::caption;
use widgets::icons::Icon;
use widgets::icons::{self, section};
use widgets::theme;

/// Area of a latent cell that is inpainted, m².
const REGION_CELL_M2: f64 = 2.56;

/// The pane of tool options and map layers.
pub struct Tools;

impl Pane for Tools {
    fn id(&self) -> PaneId {
        PaneId::TOOLS
    }

    fn title(&self) -> String {
        "Tools".into()
    }

    fn icon(&self) -> Icon {
        Icon::Brush
    }

    fn column_points(&self) -> f32 {
        230.0
    }

    fn ui(&mut self, ui: &mut Ui, cx: &mut PaneContext<'_>, commands: &mut Vec<Command>) {
        let scene = cx.document.scene();
        theme::panel_frame().show(ui, |ui| layers_ui(ui, scene, cx.state, commands));
    }
}

/// Draws the pane.
pub fn layers_ui(ui: &mut Ui, scene: &Scene, state: &mut UiState, commands: &mut Vec<Command>) {
    let (frame, scene_seed) = (scene.frame(), scene.seed);
    egui::ScrollArea::vertical().auto_shrink(false).show(ui, |ui| {
        options(ui, frame, &mut state.tools, commands);
        let UiState { tools, brushes, .. } = state;
        saved_brushes_ui(ui, &mut tools.hand, brushes);
        ui.add_space(theme::GAP);
        section(ui, t("Map layers"));
        for layer in BevLayer::MAP {
            layer_row(ui, &frame.layout, layer, &mut state.tools, commands);
        }
        opacity_rows(ui, &mut state.tools, state.shown.underlay == Underlay::Both);
        ui.add_space(theme::GAP);
        section(ui, t("Overlays"));
        toggle_row(ui, t("Boxes"), &mut state.shown.boxes);
        toggle_row(ui, t("A colour for each box"), &mut state.shown.by_track);
        things_row(ui, &state.tools, commands);
        toggle_row(ui, t("Lanes and dividers"), &mut state.shown.lines);
        toggle_row(ui, t("LiDAR points in BEV"), &mut state.shown.lidar_from_above);
        toggle_row(ui, t("Grid, 10 m"), &mut state.shown.grid);
        if frame.inferred.unobserved.is_some() {
            toggle_row(ui, t("Unobserved"), &mut state.shown.unobserved);
        }
        ui.add_space(theme::GAP);
        section(ui, t("Scenery"));
        let named = &mut state.named;
        density_row(ui, t("Vegetation"), &mut named.vegetation, TYPICAL_VEGETATION as f32);
        density_row(ui, t("Buildings"), &mut named.building, TYPICAL_BUILDING as f32);
        density_row(ui, t("Clutter"), &mut named.clutter, 0.25);
        density_row(ui, t("Completeness"), &mut named.completeness, 1.0);
        seed_row(ui, &mut state.seed, scene_seed);
        caption(
            ui,
            t("What generation is asked for. Unticked, a new scene is free (but complete) and an edit keeps what is there."),
        );
        scenery_row(ui, &mut state.tools, commands);
    });
}

/// The choice of the kind of place, and the button that draws scenery.
fn scenery_row(ui: &mut Ui, tools: &mut ToolState, commands: &mut Vec<Command>) {
    ui.horizontal(|ui| {
        let chosen = &mut tools.drawer;
        egui::ComboBox::from_id_salt("setting")
            .width(92.0)
            .selected_text(t(chosen.label()))
            .show_ui(ui, |ui| {
                for drawer in SceneryMethod::all() {
                    ui.selectable_value(chosen, drawer, t(drawer.label()));
                }
            })
            .response
            .widget_info(|| WidgetInfo::labeled(Role::ComboBox, true, t("Kind of place")));
        let hint = t(
            "Regenerates what stands beside the roads, as things: by rules for a kind of place, or by a network; voxels of scenery without a thing go",
        );
        let draw = ui.button(t("Draw")).on_hover_text(hint);
        draw.widget_info(|| WidgetInfo::labeled(Role::Button, true, t("Draw scenery")));
        if draw.clicked() {
            commands.push(Command::Generation(GenerationCommand::DrawScenery));
        }
    });
    let place = match tools.region.is_empty() {
        true => t("Everywhere; in a region if one is marked (N)."),
        false => t("In the marked region."),
    };
    caption(ui, place);
}

/// A checkbox and a slider for a density of generation; `typical` is the value to begin with.
fn density_row(ui: &mut Ui, name: &str, value: &mut Option<f32>, typical: f32) {
    ui.horizontal(|ui| {
        let mut on = value.is_some();
        // The checkbox gets a fixed width: a row wider than the pane would make the pane grow.
        let (rect, _) = ui.allocate_exact_size(vec2(104.0, theme::ROW), Sense::hover());
        let left = egui::Layout::left_to_right(egui::Align::Center);
        let mut column = ui.new_child(egui::UiBuilder::new().max_rect(rect).layout(left));
        let tick = column.checkbox(&mut on, name);
        if tick.changed() {
            *value = on.then_some(typical);
        }
        let mut shown = value.unwrap_or(typical);
        ui.spacing_mut().slider_width = 38.0;
        let slider = egui::Slider::new(&mut shown, 0.0..=1.0).fixed_decimals(2);
        let slider = ui
            .add_enabled(on, slider)
            .accessible_name(tf!("{name} density", name = name));
        if slider.changed() {
            *value = Some(shown);
        }
    });
}

/// The seed of generation on request.
fn seed_row(ui: &mut Ui, wish: &mut SeedWish, scene_seed: u64) {
    ui.horizontal_wrapped(|ui| {
        ui.label(t("Seed"));
        let mut seed = wish.seed_for(scene_seed);
        let field = egui::DragValue::new(&mut seed).speed(1.0);
        let field = ui
            .add(field)
            .on_hover_text(t("The same scene, settings and seed give the same result"))
            .accessible_name(t("Seed of the generation"));
        if field.changed() {
            wish.value = Some(seed);
        }
        let roll = ui
            .button(t("Draw one"))
            .on_hover_text(t("Another seed, at random"));
        roll.widget_info(|| WidgetInfo::labeled(Role::Button, true, t("Draw a seed")));
        if roll.clicked() {
            wish.roll();
        }
        ui.checkbox(&mut wish.another, t("each time"))
            .on_hover_text(t("Another seed for each result that is asked for"));
    });
}

/// Options of the tool in hand.
fn options(ui: &mut Ui, frame: &Frame, tools: &mut ToolState, commands: &mut Vec<Command>) {
    tools.region_m2 = tools.region.count() as f64 * REGION_CELL_M2;
    let id = tools.tool;
    let settings = tools.toolbox.tool(id).options(&tools.hand);
    for (setting, value) in option_rows::show(ui, &settings) {
        let ToolState { toolbox, hand, .. } = tools;
        let acts = toolbox.tool_mut(id).set(hand, frame, setting, value);
        carry_out(acts, commands);
    }
}

fn layer_row(
    ui: &mut Ui,
    layout: &BevLayout,
    layer: BevLayer,
    tools: &mut ToolState,
    commands: &mut Vec<Command>,
) {
    let label = layer.label();
    let label = t(&label);
    let shown = tools.shows(layer);
    let chosen = tools.tool == brush::ID && tools.layer == layer;
    ui.horizontal(|ui| {
        ui.spacing_mut().item_spacing.x = 2.0;
        let shows = eye(ui, shown, &tf!("Show {what}", what = label))
            .on_hover_text(t("Alt+click shows it alone"));
        if shows.clicked() && ui.input(|i| i.modifiers.alt) {
            solo(tools, layer);
        } else if shows.clicked() {
            tools.layers_shown ^= layer.bit();
            tools.before_solo = None;
        }
        let locked = tools.is_locked(layer);
        if lock(ui, locked, &tf!("Lock {what}", what = label)).clicked() {
            tools.layers_locked ^= layer.bit();
        }
        let share = layout.count(layer) as f64 * 100.0 / layout.extent().columns() as f64;
        let right = match share {
            0.0 => String::new(),
            s if s < 1.0 => "<1 %".to_owned(),
            s => format!("{s:.0} %"),
        };
        let color = theme::rgb(layer.color()).gamma_multiply(if shown { 1.0 } else { 0.4 });
        let name = theme::sentence(label);
        let row = icons::row(ui, color, &name, &right, chosen, &tf!("Paint {what}", what = label));
        let hint = match BevLayer::GROUND.contains(&layer) {
            true => t(
                "Choose for the brush. A place is road, walkway or car park: what is painted last replaces the others",
            ),
            false => t("Choose for the brush"),
        };
        let row = row.on_hover_text(hint);
        row.context_menu(|ui| merge_menu(ui, layout, layer, commands));
        if row.clicked() {
            tools.layer = layer;
            commands.push(Command::Tool(brush::ID));
        }
    });
}

/// The menu of layers into which a layer can be merged.
fn merge_menu(ui: &mut Ui, layout: &BevLayout, layer: BevLayer, commands: &mut Vec<Command>) {
    ui.label(egui::RichText::new(t("Merge into")).color(theme::text_weak()));
    for into in BevLayer::MAP.into_iter().filter(|other| *other != layer) {
        let name = theme::sentence(t(&into.label()));
        let button = ui.add_enabled(layout.count(layer) > 0, egui::Button::new(name));
        if button.clicked() {
            commands.push(Command::Apply("Merge layers", merge(layout, layer, into)));
        }
    }
}

/// Shows one layer alone; if it is alone already, shows the layers from before.
fn solo(tools: &mut ToolState, layer: BevLayer) {
    match tools.before_solo {
        Some(before) if tools.layers_shown == layer.bit() => {
            tools.layers_shown = before;
            tools.before_solo = None;
        }
        before => {
            tools.before_solo = before.or(Some(tools.layers_shown));
            tools.layers_shown = layer.bit();
        }
    }
}

/// Sliders for the opacity of the chosen layer, and of all layers over the voxels.
fn opacity_rows(ui: &mut Ui, tools: &mut ToolState, over_voxels: bool) {
    let slider = |ui: &mut Ui, caption: &str, value: &mut f32, name: &str| {
        ui.horizontal(|ui| {
            ui.label(egui::RichText::new(caption).color(theme::text_weak()));
            // (the width that the field beside it leaves)
            ui.spacing_mut().slider_width = (ui.available_width() - 62.0).clamp(24.0, 74.0);
            let slider = egui::Slider::new(value, 0.0..=1.0).fixed_decimals(2);
            ui.add(slider).on_hover_text(name).accessible_name(name);
        });
    };
    if let Some(k) = DRAW_ORDER.iter().position(|layer| *layer == tools.layer) {
        let name = tf!("Opacity of {layer}", layer = t(&tools.layer.label()));
        slider(ui, t("Opacity"), &mut tools.layer_opacity[k], &name);
    }
    if over_voxels {
        slider(
            ui,
            t("All, on voxels"),
            &mut tools.layers_opacity,
            t("Opacity of the layers over voxels"),
        );
    }
}

pub(super) fn lock(ui: &mut Ui, locked: bool, name: &str) -> egui::Response {
    let (rect, response) = ui.allocate_exact_size(vec2(16.0, theme::ROW), Sense::click());
    response.widget_info(|| WidgetInfo::selected(Role::CheckBox, true, locked, name));
    let color = match (locked, response.hovered()) {
        (true, _) => theme::warn(),
        (false, true) => theme::text_weak(),
        // Nearly invisible unless it is locked or hovered: a lock beside every layer would be noise.
        (false, false) => theme::field_hover(),
    };
    Icon::Lock.paint(ui, rect.shrink2(vec2(2.0, 6.0)), color);
    icons::focus_ring(ui, &response, rect);
    response
}

fn toggle_row(ui: &mut Ui, name: &str, on: &mut bool) {
    ui.horizontal(|ui| {
        ui.spacing_mut().item_spacing.x = 2.0;
        if eye(ui, *on, &tf!("Show {what}", what = name.to_lowercase())).clicked() {
            *on = !*on;
        }
        let color = if *on { theme::text() } else { theme::text_weak() };
        let (rect, response) = ui.allocate_exact_size(vec2(ui.available_width(), theme::ROW), Sense::click());
        let body = egui::TextStyle::Body.resolve(ui.style());
        let at = pos2(rect.left() + 8.0, rect.center().y);
        ui.painter()
            .text(at, egui::Align2::LEFT_CENTER, name, body, color);
        if response.clicked() {
            *on = !*on;
        }
    });
}

/// Draws the switches for things beside the road: shown, locked.
fn things_row(ui: &mut Ui, tools: &ToolState, commands: &mut Vec<Command>) {
    let mut send = |command| commands.push(Command::Tools(ToolCommand::Thing(command)));
    let things = &tools.things;
    ui.horizontal(|ui| {
        ui.spacing_mut().item_spacing.x = 2.0;
        if eye(ui, things.shown, t("Show scenery")).clicked() {
            send(ThingCommand::ToggleShown);
        }
        if lock(ui, things.locked, t("Lock scenery")).clicked() {
            send(ThingCommand::ToggleLocked);
        }
        let color = match things.is_open() {
            true => theme::text(),
            false => theme::text_weak(),
        };
        ui.label(egui::RichText::new(t("Scenery")).color(color));
    });
}

pub(super) fn eye(ui: &mut Ui, shown: bool, name: &str) -> egui::Response {
    let (rect, response) = ui.allocate_exact_size(vec2(theme::ROW, theme::ROW), Sense::click());
    response.widget_info(|| WidgetInfo::selected(Role::CheckBox, true, shown, name));
    let color = match (response.hovered(), shown) {
        (true, _) => theme::text_strong(),
        (false, true) => theme::text_weak(),
        (false, false) => Color32::from_rgb(90, 96, 106),
    };
    let icon = if shown { Icon::Eye } else { Icon::EyeOff };
    icon.paint(ui, rect.shrink(5.0), color);
    icons::focus_ring(ui, &response, rect);
    response
}
