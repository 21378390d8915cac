//! Options of the tools, at the top of the left panel.

use egui::Ui;

use crate::command::{Command, GenerationCommand};
use crate::state::UiState;
use crate::theme;
use crate::widgets::hint::caption;
use crate::widgets::icons::{self, section};
use editor::arrange::Pivot;
use editor::flood::FillBounds;
use editor::lane_strip::LaneStrip;
use editor::transform::{Kind, Orientation};
use scene::{Class, variants};

use super::{PaintShape, RegionShape, ToolCommand, VoxelMode};

fn button(ui: &mut Ui, name: &str, hint: &str, enabled: bool) -> bool {
    let response = ui.add_enabled(enabled, egui::Button::new(name));
    response.on_hover_text(hint).clicked()
}

/// Of the select tool.
pub fn select(ui: &mut Ui, state: &mut UiState, commands: &mut Vec<Command>) {
    section(ui, "Select");
    let tools = &mut state.tools;
    icons::segments(
        ui,
        &mut tools.lasso,
        &[
            (
                false,
                "Marquee",
                "V: click, or drag over empty ground; Shift adds and removes",
            ),
            (true, "Lasso", "O: drag around boxes"),
        ],
    );
    ui.add_space(3.0);
    let kinds = [
        (
            Kind::Move,
            "Move",
            "W; X, Y, Z keep to an axis, digits set the way",
        ),
        (Kind::Turn, "Turn", "E; digits set the angle"),
        (Kind::Scale, "Scale", "R; digits set the factor"),
    ];
    icons::segments(ui, &mut tools.gizmo, &kinds);
    ui.add_space(3.0);
    icons::segments(
        ui,
        &mut tools.orientation,
        &[
            (Orientation::World, "World", "axes of the ego vehicle"),
            (Orientation::Local, "Local", "axes of the box chosen last"),
        ],
    );
    ui.add_space(3.0);
    icons::segments(
        ui,
        &mut tools.pivot,
        &[
            (Pivot::Own, "Own centres", "the keys turn each box about itself"),
            (
                Pivot::Middle,
                "Middle",
                "the keys turn all about the middle between them",
            ),
        ],
    );
    ui.add_space(3.0);
    ui.horizontal(|ui| {
        ui.checkbox(&mut tools.snap_grid, "Grid")
            .on_hover_text("Moves snap to this step; hold Ctrl for the same");
        let steps = [(0.1, "0.1", "m"), (0.4, "0.4", "m, a voxel"), (1.0, "1 m", "")];
        icons::segments(ui, &mut tools.grid_m, &steps);
    });
    ui.horizontal(|ui| {
        ui.checkbox(&mut tools.snap_lane, "Lanes")
            .on_hover_text("Moves snap to lane centre and heading");
        ui.checkbox(&mut tools.snap_ground, "Ground")
            .on_hover_text("Moves set boxes on the ground");
        ui.checkbox(&mut tools.things.snap_kerb, "Kerb")
            .on_hover_text("Moves set things beside the kerb");
    });
    let any = state.selected.is_some();
    let things = !state.tools.things.chosen.is_empty();
    let mut on = |clicked: bool, command| {
        if clicked {
            commands.push(Command::Tools(command));
        }
    };
    ui.add_space(3.0);
    ui.horizontal_wrapped(|ui| {
        ui.spacing_mut().item_spacing = egui::vec2(3.0, 3.0);
        on(
            match things && !any {
                true => button(ui, "To kerb", "D: beside the nearest kerb", true),
                false => button(ui, "To lane", "D: lane centre, heading and ground", any),
            },
            ToolCommand::ToLane,
        );
        on(button(ui, "To ground", "Shift+D", any), ToolCommand::DropToGround);
        on(
            button(ui, "Row…", "Ctrl+Shift+D: copies at a spacing", any),
            ToolCommand::AskRow,
        );
        on(
            button(ui, "Mirror", "Ctrl+M: about the ego x axis", any),
            ToolCommand::Mirror(false),
        );
        on(button(ui, "Mirrored copy", "", any), ToolCommand::Mirror(true));
    });
    ui.checkbox(
        &mut state.tools.mirror_keeps_direction,
        "Mirrored ones keep to traffic",
    )
    .on_hover_text("A box that changes sides is turned by 180°");
}

/// Shapes of the brush and what belongs to them.
pub fn brush(ui: &mut Ui, state: &mut UiState, commands: &mut Vec<Command>) {
    let mut shape = state.tools.shape;
    for part in PaintShape::ALL.chunks(3) {
        if icons::segments(ui, &mut shape, part) {
            commands.push(Command::Tools(ToolCommand::Shape(shape)));
        }
        ui.add_space(2.0);
    }
    match state.tools.shape {
        PaintShape::Polygon => caption(
            ui,
            "Click points. Enter or a double click closes, Backspace takes one back, Esc drops all.",
        ),
        PaintShape::Street => {
            let street = &mut state.tools.street;
            let lanes = 0..=LaneStrip::MAX_LANES;
            slider(ui, "Lanes ahead", &mut street.forward, lanes.clone());
            slider(ui, "Lanes back", &mut street.backward, lanes);
            slider(ui, "Lane, m", &mut street.lane_m, LaneStrip::LANE_M);
            slider(ui, "Walkway, m", &mut street.walk_m, 0.0..=6.0);
            caption(
                ui,
                "Click points along the middle; Enter or a double click lays the street.",
            );
        }
        PaintShape::Fill => {
            icons::segments(
                ui,
                &mut state.tools.fill,
                &[
                    (
                        FillBounds::AnyLayer,
                        "To any layer",
                        "stops where any map layer changes",
                    ),
                    (
                        FillBounds::OwnLayer,
                        "To its own",
                        "stops where the painted layer changes",
                    ),
                ],
            );
        }
        PaintShape::Pick => caption(
            ui,
            "Click takes over the layer under the pointer, as Alt+click always does.",
        ),
        _ => {}
    }
    ui.add_space(2.0);
}

pub(crate) fn slider<N: egui::emath::Numeric>(
    ui: &mut Ui,
    name: &str,
    value: &mut N,
    range: std::ops::RangeInclusive<N>,
) {
    ui.horizontal(|ui| {
        let (rect, _) = ui.allocate_exact_size(egui::vec2(80.0, theme::ROW), egui::Sense::hover());
        let font = egui::TextStyle::Body.resolve(ui.style());
        let at = rect.left_center();
        ui.painter()
            .text(at, egui::Align2::LEFT_CENTER, name, font, theme::text_weak());
        ui.spacing_mut().slider_width = 60.0;
        let decimals = usize::from(!N::INTEGRAL);
        ui.add(egui::Slider::new(value, range).max_decimals(decimals))
            .accessible_name(name);
    });
}

/// Kinds of the class of the next box.
pub fn variants_ui(ui: &mut Ui, state: &mut UiState) {
    let class = state.box_class;
    let mut chosen = state.tools.variants.get(&class).copied();
    let name = |i: Option<usize>| {
        let kind = i.and_then(|i| variants::of_class(class).nth(i));
        let size = kind
            .map(|k| k.size_m)
            .or(class.typical_size_m())
            .unwrap_or_default();
        let name = kind.map_or("Typical", |k| k.name);
        format!("{name}   {:.2} × {:.2} × {:.2} m", size[0], size[1], size[2])
    };
    let combo = egui::ComboBox::from_id_salt("kind of box")
        .width(ui.available_width() - 8.0)
        .selected_text(name(chosen));
    let shown = combo.show_ui(ui, |ui| {
        let count = variants::of_class(class).count();
        for i in std::iter::once(None).chain((0..count).map(Some)) {
            ui.selectable_value(&mut chosen, i, name(i));
        }
    });
    shown
        .response
        .widget_info(|| egui::WidgetInfo::labeled(egui::accesskit::Role::ComboBox, true, "Kind of box"));
    match chosen {
        Some(i) => drop(state.tools.variants.insert(class, i)),
        None => drop(state.tools.variants.remove(&class)),
    }
}

/// Of the measure tool.
pub fn measure(ui: &mut Ui, state: &UiState) {
    section(ui, "Measure");
    let text = state.tools.measure.text(None);
    caption(
        ui,
        "Click points in the bird's-eye view: two give a distance, a third the angle. Box corners catch them, Esc clears.",
    );
    if let Some(text) = text {
        ui.label(egui::RichText::new(text).color(theme::text_strong()));
    }
}

/// Of the region tool.
pub fn region(ui: &mut Ui, state: &mut UiState, commands: &mut Vec<Command>) {
    section(ui, "Region to draw anew");
    caption(
        ui,
        "Mark it in the bird's-eye view, Shift takes away. All else, and boxes in it, stay as they are.",
    );
    let ways = [
        (RegionShape::Rectangle, "Rectangle", "drag from corner to corner"),
        (RegionShape::Lasso, "Lasso", "draw around it"),
        (
            RegionShape::Brush,
            "Brush",
            "paint the mark; [ and ] change the size",
        ),
    ];
    icons::segments(ui, &mut state.tools.region_shape, &ways);
    if state.tools.region_shape == RegionShape::Brush {
        slider(ui, "Brush, m", &mut state.brush_m, UiState::BRUSH_M);
    }
    let n = state.tools.region.count();
    let area_m2 = n as f64 * 2.56;
    caption(ui, &format!("{area_m2:.0} m² marked"));
    slider(ui, "Strength", &mut state.tools.region_strength, 0.05..=1.0);
    caption(ui, "1: all of it new. Less is a variation of what is there.");
    ui.horizontal(|ui| {
        if button(ui, "Draw anew", "each time from other noise", n > 0) {
            commands.push(Command::Generation(GenerationCommand::Generate { full: false }));
        }
        if button(ui, "Clear region", "", n > 0) {
            state.tools.region = Default::default();
        }
    });
}

/// Modes of the voxel tool.
pub fn voxels(ui: &mut Ui, state: &mut UiState, commands: &mut Vec<Command>) {
    let mut mode = state.tools.voxel_mode;
    for part in VoxelMode::ALL.chunks(3) {
        if icons::segments(ui, &mut mode, part) {
            commands.push(Command::Tools(ToolCommand::Voxels(mode)));
        }
        ui.add_space(2.0);
    }
    if matches!(state.tools.voxel_mode, VoxelMode::Brush | VoxelMode::Block) {
        slider(ui, "Height, vx", &mut state.tools.voxel_height, 1..=16);
    }
    ui.checkbox(&mut state.tools.symmetry, "Symmetry about the ego axis")
        .on_hover_text("S");
    if state.tools.voxel_mode == VoxelMode::Wand {
        chosen_voxels(ui, state, commands);
    }
}

fn chosen_voxels(ui: &mut Ui, state: &UiState, commands: &mut Vec<Command>) {
    let n = state.tools.voxels.len();
    let text = match n {
        0 => "Click voxels to choose what is connected; Shift adds.".to_owned(),
        1 => "1 voxel chosen".to_owned(),
        n => format!("{n} voxels chosen"),
    };
    caption(ui, &text);
    let mut on = |clicked: bool, command| {
        if clicked {
            commands.push(Command::Tools(command));
        }
    };
    ui.horizontal_wrapped(|ui| {
        ui.spacing_mut().item_spacing = egui::vec2(3.0, 3.0);
        let paint = ToolCommand::PaintChosenVoxels;
        on(button(ui, "Remove them", "Del", n > 0), paint(Class::Free));
        on(
            button(ui, "Recolour them", "in the class below", n > 0),
            paint(state.voxel_class),
        );
        on(
            button(ui, "Lock them", "generation keeps them", n > 0),
            ToolCommand::LockChosenVoxels(true),
        );
        on(
            button(ui, "Unlock them", "", n > 0),
            ToolCommand::LockChosenVoxels(false),
        );
    });
}
