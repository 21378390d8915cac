//! The right pane: the chosen box in numbers, and the list of boxes.

use egui::Ui;
use glam::DVec3;

use language::{t, tf};

use super::box_menu;
use super::group_list::{self, ObjectListRow};
use super::id::PaneId;
use super::object_order::listing_ui;
use super::pane::{Pane, PaneContext, PanePlacement};
use super::{thing_list, things};
use crate::canvas_draw::box_color;
use crate::command::{Command, ViewCommand};
use crate::fields::{caption, field, fields, number, numbers, short, typed};
use crate::panes::label::label_ui;
use crate::state::{UiState, called};
use crate::tools::{Choose, Hand, ToolCommand};
use editor::transform::Orientation;
use editor::{Document, Edit, arrange};
use numeric::decimal::decimal;
use scene::clip::Path;
use scene::{BoxId, Class, Frame, Members, Scene, SceneBox, Thing};
use widgets::icons::Icon;
use widgets::icons::{self, section};
use widgets::theme;

/// The pane of the chosen box in numbers, and of the list of boxes.
pub struct Objects;

impl Pane for Objects {
    fn id(&self) -> PaneId {
        PaneId::OBJECTS
    }

    fn title(&self) -> String {
        "Objects".into()
    }

    fn icon(&self) -> Icon {
        Icon::List
    }

    fn place(&self) -> PanePlacement {
        PanePlacement::ColumnAtOnce
    }

    fn column_points(&self) -> f32 {
        266.0
    }

    fn ui(&mut self, ui: &mut Ui, cx: &mut PaneContext<'_>, commands: &mut Vec<Command>) {
        theme::panel_frame().show(ui, |ui| objects_ui(ui, cx.document, cx.state, commands));
    }
}

/// Draws the pane.
pub fn objects_ui(ui: &mut Ui, document: &Document, state: &mut UiState, commands: &mut Vec<Command>) {
    let scene = document.scene();
    let frame = scene.frame();
    let room = ui.available_height();
    let wanted: Option<f32> = ui.data(|d| d.get_temp(list_height_id()));
    let most = (room - LEAST_INSPECTOR).max(LEAST_LIST);
    // The list does not move when the inspector changes, so a second click hits the same row.
    let below = wanted.unwrap_or(room - INSPECTOR).clamp(LEAST_LIST, most);
    let gap = theme::GAP / 2.0 + ui.spacing().item_spacing.y;
    egui::ScrollArea::vertical()
        .id_salt("inspector")
        .max_height((room - below - gap).max(LEAST_INSPECTOR))
        .auto_shrink(false)
        .show(ui, |ui| {
            inferred(ui, frame, &mut state.correcting, commands);
            section(ui, t("Inspector"));
            let things: Vec<&Thing> = state.tools.things.chosen_in(&scene.background).collect();
            let chosen = state.chosen().len();
            if chosen > 0 && !things.is_empty() {
                // The fields of the things are below those of the boxes, mostly out of sight.
                let text = tf!("{n} boxes and things", n = chosen + things.len());
                ui.label(egui::RichText::new(text).color(theme::text_strong()));
                let text = t("Move, delete, copy, mirror and rows take all of them.");
                ui.label(egui::RichText::new(text).small().color(theme::text_weak()));
            }
            match state.selected.and_then(|id| frame.boxes.get(&id)) {
                Some(_) if state.chosen().len() > 1 => several(ui, frame, &state.tools, commands),
                Some(b) => {
                    inspector(ui, scene, b, &state.tools, commands);
                    own_shape(ui, scene, b.id, commands);
                }
                None if things.is_empty() => {
                    ui.label(egui::RichText::new(t("Nothing selected")).color(theme::text_weak()));
                }
                None => {}
            }
            things::inspector(ui, &things, &document.settled_scene().background, commands);
        });
    let rows = thing_list::rows(&scene.background, &state.tools);
    let boxes = match frame.boxes.len() {
        1 => t("1 box").to_owned(),
        n => tf!("{n} boxes", n = n),
    };
    let title = match scene.background.len() {
        0 => boxes,
        1 => tf!("{boxes}, 1 thing", boxes = boxes),
        n => tf!("{boxes}, {n} things", boxes = boxes, n = n),
    };
    divide(ui, &title, below, most);
    let listing = listing_ui(ui);
    let list_height = ui.available_height().max(80.0);
    let ego_m = frame.world_from_ego.translation_m.truncate();
    let boxes = listing.listed(frame.boxes.values(), ego_m);
    // Things beside the road are not searched, so a filtered list leaves them out.
    let rows = if listing.filters() { Vec::new() } else { rows };
    if boxes.is_empty() && listing.filters() {
        ui.weak(t("No object of that name, class, paint or number."));
    }
    let list = egui::ScrollArea::vertical()
        .id_salt("boxes")
        .max_height(list_height)
        .auto_shrink([false, false]);
    ui.spacing_mut().item_spacing.y = 1.0;
    let boxes = group_list::rows(ui, &scene.arranged, &boxes);
    let list = reveal(ui, list, &boxes, state.selected, list_height);
    list.show_rows(ui, theme::ROW, boxes.len() + rows.len(), |ui, range| {
        for i in range {
            match boxes.get(i) {
                Some(ObjectListRow::Group(at, group)) => {
                    group_list::group_ui(ui, (*at, group), scene, state, commands);
                }
                Some(ObjectListRow::Box(b, inside)) => {
                    ui.push_id(b.id.0, |ui| box_row(ui, b, *inside, (scene, state), commands));
                }
                None => thing_list::row_ui(ui, &rows[i - boxes.len()], scene, &mut state.tools, commands),
            }
        }
    });
}

/// Least height of the list of boxes with its title, and of the inspector, points.
const LEAST_LIST: f32 = 118.0;
const LEAST_INSPECTOR: f32 = 60.0;
/// Height of the inspector of a box, points.
const INSPECTOR: f32 = 178.0;

/// Id of the list's height that the user set; unset, the inspector decides it.
fn list_height_id() -> egui::Id {
    egui::Id::unique("height of the list of boxes")
}

/// The title of the list. Dragging it divides the height between inspector and list; a double click resets that.
fn divide(ui: &mut Ui, title: &str, height: f32, most: f32) {
    ui.add_space(theme::GAP / 2.0);
    let top = ui.cursor().top();
    ui.add_space(2.0);
    section(ui, title);
    let line = egui::Rect::from_x_y_ranges(ui.max_rect().x_range(), top..=ui.cursor().top());
    let response = ui.interact(line, ui.scope_id().with("divide"), egui::Sense::click_and_drag());
    let name = t("Height of the list of boxes");
    response.widget_info(|| egui::WidgetInfo::labeled(egui::accesskit::Role::Splitter, true, name));
    let color = match response.dragged() || response.hovered() {
        true => theme::accent(),
        false => theme::field_hover(),
    };
    if response.hovered() || response.dragged() {
        ui.set_cursor_icon(egui::CursorIcon::ResizeVertical);
    }
    ui.painter()
        .hline(line.x_range(), line.top(), egui::Stroke::new(1.0, color));
    if response.dragged() {
        // A drag starts from the height on screen, which may be more than the height asked for.
        let from = match response.drag_started() {
            true => ui.max_rect().bottom() - line.top(),
            false => height,
        };
        let wanted = from - response.drag_delta().y;
        ui.data_mut(|d| d.insert_temp(list_height_id(), wanted.clamp(LEAST_LIST, most)));
    }
    if response.double_clicked() {
        ui.data_mut(|d| d.remove_temp::<f32>(list_height_id()));
    }
}

/// Scrolls to the chosen box once, when another box was chosen elsewhere.
fn reveal(
    ui: &Ui,
    list: egui::ScrollArea,
    rows: &[ObjectListRow<'_>],
    selected: Option<BoxId>,
    height: f32,
) -> egui::ScrollArea {
    let memory = egui::Id::unique("box revealed");
    let before: Option<BoxId> = ui.data(|d| d.get_temp(memory)).flatten();
    if before == selected {
        return list;
    }
    ui.data_mut(|d| d.insert_temp(memory, selected));
    let is_it = |row: &ObjectListRow<'_>| matches!(row, ObjectListRow::Box(b, _) if Some(b.id) == selected);
    match rows.iter().position(is_it) {
        Some(row) => {
            let at = row as f32 * (theme::ROW + 1.0) - height / 2.0;
            list.vertical_scroll_offset(at.max(0.0))
        }
        None => list,
    }
}

/// Lists the parts of an imported frame that were guessed, with buttons to correct and to confirm them.
fn inferred(ui: &mut Ui, frame: &Frame, correcting: &mut bool, commands: &mut Vec<Command>) {
    if !frame.inferred.any() {
        return;
    }
    section(ui, t("Inferred from labels"));
    let boxes = match frame.inferred.boxes.len() {
        0 => "",
        1 => t("1 box"),
        n => &tf!("{n} boxes", n = n),
    };
    if frame.inferred.background {
        let what = t("What stands beside the road is a guess.");
        ui.label(egui::RichText::new(what).small().color(theme::text_weak()));
    }
    let what = match (frame.inferred.layout, boxes) {
        (false, "") => String::new(),
        (true, "") => t("The map layers are guesses.").to_owned(),
        (true, boxes) => tf!("The map layers and {boxes} are guesses.", boxes = boxes),
        (false, boxes) => tf!("{boxes}: guesses.", boxes = boxes),
    };
    if !what.is_empty() {
        ui.label(egui::RichText::new(what).small().color(theme::text_weak()));
    }
    ui.horizontal(|ui| {
        ui.checkbox(correcting, t("Correct them")).on_hover_text(t(
            "While ticked, edits of boxes and map layers change no voxel and generate nothing.",
        ));
        let confirm = ui
            .button(t("Confirm all"))
            .on_hover_text(t("They are right as they are."));
        if confirm.clicked() {
            commands.push(Command::ConfirmInferred);
        }
    });
    ui.add_space(theme::GAP);
}

fn box_row(
    ui: &mut Ui,
    b: &SceneBox,
    inside: bool,
    (scene, state): (&Scene, &mut UiState),
    commands: &mut Vec<Command>,
) {
    let guess = scene.frame().inferred.boxes.contains(&b.id);
    let chosen = state.is_chosen(b.id);
    let ego_m = scene.frame().world_from_ego.translation_m.truncate();
    let name = theme::sentence(&called(b));
    let mark = if guess { t("guess") } else { "" };
    let gap = if guess { "   " } else { "" };
    let right = format!(
        "{mark}{gap}#{}   {:.0} m",
        b.id.0,
        b.center_m.truncate().distance(ego_m)
    );
    let label = tf!("Box {id} {name}", id = b.id.0, name = called(b));
    let color = theme::rgb(box_color(b, state.shown.by_track));
    let color = match scene.arranged.hidden.boxes.contains(&b.id) {
        true => color.gamma_multiply(0.35),
        false => color,
    };
    let row = ui
        .horizontal(|ui| {
            ui.spacing_mut().item_spacing.x = 0.0;
            ui.add_space(if inside { theme::ROW * 0.8 } else { 0.0 });
            let room = (ui.available_width() - group_list::SWITCHES).max(40.0);
            let row = ui
                .allocate_ui(egui::vec2(room, theme::ROW), |ui| {
                    icons::row(ui, color, &name, &right, chosen, &label)
                })
                .inner;
            let it = Members::of([b.id], []);
            group_list::switches(ui, &it, &scene.arranged, &label, commands);
            row
        })
        .inner;
    let adds = ui.input(|i| i.modifiers.shift || i.modifiers.command);
    if row.clicked() && adds {
        commands.push(Command::Tools(ToolCommand::Choose(vec![b.id], Choose::Toggle)));
    } else if row.clicked() {
        commands.push(Command::Select(Some(b.id)));
    }
    if row.double_clicked() {
        commands.push(Command::View(ViewCommand::FrameSelection));
    }
    box_menu::of_row(&row, scene, state, b.id, commands);
}

fn inspector(ui: &mut Ui, scene: &Scene, b: &SceneBox, hand: &Hand, commands: &mut Vec<Command>) {
    ui.horizontal(|ui| {
        let mut class = b.class;
        let (rect, _) = ui.allocate_exact_size(egui::vec2(16.0, theme::ROW), egui::Sense::hover());
        icons::swatch(ui, rect.center(), 14.0, theme::class_color(class));
        let combo = egui::ComboBox::from_id_salt("class")
            .width((ui.available_width() - 100.0).clamp(48.0, 118.0))
            .selected_text(theme::sentence(t(&class.label())));
        combo.show_ui(ui, |ui| {
            for other in Class::OBJECTS {
                ui.selectable_value(&mut class, other, theme::sentence(t(&other.label())));
            }
        });
        if class != b.class {
            commands.push(Command::Apply(
                "Change class",
                vec![Edit::SetBoxClass { id: b.id, class }],
            ));
        }
        ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), |ui| {
            ui.spacing_mut().item_spacing.x = 0.0;
            if icons::button(ui, Icon::Trash, t("Delete box"), "Del", false, true).clicked() {
                commands.push(Command::Tools(ToolCommand::Delete));
            }
            if icons::button(ui, Icon::Copy, t("Duplicate box"), "Ctrl+D", false, true).clicked() {
                commands.push(Command::Tools(ToolCommand::Duplicate));
            }
            if icons::button(ui, Icon::Focus, t("Frame box"), "F", false, true).clicked() {
                commands.push(Command::View(ViewCommand::FrameSelection));
            }
        });
    });
    ui.add_space(2.0);
    label_ui(ui, &[*b], commands);
    let local = hand.orientation == Orientation::Local;
    let [mut center, mut size] = [b.center_m, b.size_m];
    let limit = SceneBox::LIMIT_M;
    // In the box's own axes its position would always be zero; the fields shift the box instead.
    let position = match local {
        false => numbers(
            ui,
            t("Position"),
            ["X", "Y", "Z"],
            &mut center,
            -limit..=limit,
            0.05,
        ),
        true => {
            let start = shift_start(ui, b);
            let mut shift = start.to_local(b.center_m);
            let names = [t("Ahead"), t("Left"), t("Up")];
            let fields = numbers(ui, t("Shift"), names, &mut shift, -limit..=limit, 0.05);
            center = start.to_ego(shift);
            fields
        }
    };
    let dimensions = numbers(
        ui,
        t("Size"),
        [t("Length"), t("Width"), t("Height")],
        &mut size,
        0.1..=60.0,
        0.05,
    );
    let mut yaw_deg = heading_deg(b.yaw_rad);
    let turned = ui
        .horizontal(|ui| {
            caption(ui, t("Heading"));
            let drag = typed(&mut yaw_deg, |v| decimal(v, 1))
                .speed(0.5)
                .fixed_decimals(1)
                .suffix("°");
            let drag = ui
                .add_sized([64.0, theme::ROW], drag)
                .accessible_name(t("Heading"));
            speed(ui, scene, b, commands);
            drag
        })
        .inner;
    let id = b.id;
    let edit = |center_m, yaw_deg, size_m| Edit::MoveBox {
        id,
        center_m,
        yaw_deg,
        size_m,
    };
    field(&position, "Move box", edit(Some(center), None, None), commands);
    field(&dimensions, "Resize box", edit(None, None, Some(size)), commands);
    field(&turned, "Turn box", edit(None, Some(yaw_deg), None), commands);
}

/// Tells that a box has the shape of a model, with a button that removes the shape.
fn own_shape(ui: &mut Ui, scene: &Scene, id: BoxId, commands: &mut Vec<Command>) {
    let track = scene.clip().tracks.get(&id);
    if !track.is_some_and(|t| t.own_shape) {
        return;
    }
    ui.horizontal(|ui| {
        caption(ui, t("Shape"));
        ui.label(t("From a model")).on_hover_text(t(
            "It keeps this shape wherever it is moved. Another size or class gives it a generated one.",
        ));
        let button = ui
            .button(t("Take away"))
            .on_hover_text(t("The shape is generated again"));
        if button.clicked() {
            let cells = Vec::new();
            commands.push(Command::Apply(
                "Take the shape away",
                vec![Edit::SetShape { id, cells }],
            ));
        }
    });
}

/// A heading in degrees, from -180 to 180. A heading outside the range of the field would be clamped as if it were
/// typed, and turn every chosen box.
fn heading_deg(yaw_rad: f64) -> f64 {
    (yaw_rad.to_degrees() + 180.0).rem_euclid(360.0) - 180.0
}

/// The speed of a box and its number. The speed can be set unless keyframes or another object decide it.
fn speed(ui: &mut Ui, scene: &Scene, b: &SceneBox, commands: &mut Vec<Command>) {
    /// Largest speed, km/h.
    const MOST_KMH: f64 = Path::MAX_MPS * 3.6;
    let mut kmh = b.velocity_mps.length() * 3.6;
    if arrange::with_speed(scene, b.id, b.velocity_mps.length()).is_some() {
        let drag = typed(&mut kmh, |v| short(v, 1))
            .range(0.0..=MOST_KMH)
            .speed(0.5)
            .max_decimals(1)
            .suffix(" km/h");
        let response = ui
            .add_sized([76.0, theme::ROW], drag)
            .on_hover_text(t("Speed over ground"))
            .accessible_name(t("Speed"));
        let edits = || arrange::with_speed(scene, b.id, kmh / 3.6).unwrap_or_default();
        if response.changed() || response.drag_stopped() {
            fields(&response, "Set speed", edits(), commands);
        }
    } else {
        let text = if kmh < 0.5 {
            t("standing").to_owned()
        } else {
            format!("{kmh:.0} km/h")
        };
        ui.label(text).on_hover_text(t(
            "Speed over ground, as its keyframes or what it is attached to have it",
        ));
    }
    ui.label(egui::RichText::new(format!("#{}", b.id.0)).color(theme::text_weak()));
}

/// The box as it was when it was chosen: the origin of shifts along its own axes.
fn shift_start(ui: &Ui, b: &SceneBox) -> SceneBox {
    let memory = egui::Id::unique("box when chosen");
    let kept: Option<SceneBox> = ui.data(|d| d.get_temp(memory)).flatten();
    match kept.filter(|k| k.id == b.id && k.yaw_rad == b.yaw_rad) {
        Some(kept) => kept,
        None => {
            ui.data_mut(|d| d.insert_temp(memory, Some(*b)));
            *b
        }
    }
}

/// Several boxes in numbers: a shift of their middle moves all, a size or heading is set for all.
fn several(ui: &mut Ui, frame: &Frame, hand: &Hand, commands: &mut Vec<Command>) {
    let ids = hand.chosen();
    let boxes = arrange::boxes_of(frame, &ids);
    let (Some(first), Some(middle_m)) = (boxes.first(), arrange::middle_m(&boxes)) else {
        return;
    };
    ui.horizontal(|ui| {
        ui.label(egui::RichText::new(tf!("{n} boxes chosen", n = boxes.len())).color(theme::text_strong()));
        ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), |ui| {
            ui.spacing_mut().item_spacing.x = 0.0;
            if icons::button(ui, Icon::Trash, t("Delete boxes"), "Del", false, true).clicked() {
                commands.push(Command::Tools(ToolCommand::Delete));
            }
            if icons::button(ui, Icon::Copy, t("Duplicate boxes"), "Ctrl+D", false, true).clicked() {
                commands.push(Command::Tools(ToolCommand::Duplicate));
            }
        });
    });
    let one_class = boxes.iter().all(|b| b.class == first.class);
    let mut class = one_class.then_some(first.class);
    let several = || t("Several classes").to_owned();
    let name = class.map_or_else(several, |c| theme::sentence(t(&c.label())));
    let combo = egui::ComboBox::from_id_salt("class of several")
        .width(150.0)
        .selected_text(name);
    combo.show_ui(ui, |ui| {
        for other in Class::OBJECTS {
            ui.selectable_value(&mut class, Some(other), theme::sentence(t(&other.label())));
        }
    });
    if let Some(class) = class.filter(|_| !one_class || class != Some(first.class)) {
        let edits = ids.iter().map(|id| Edit::SetBoxClass { id: *id, class });
        commands.push(Command::Apply("Change class", edits.collect()));
    }
    label_ui(ui, &boxes, commands);
    let limit = SceneBox::LIMIT_M;
    let (mut center, mut size, mut yaw_deg) = (middle_m, first.size_m, heading_deg(first.yaw_rad));
    let position = numbers(
        ui,
        t("Middle"),
        ["X", "Y", "Z"],
        &mut center,
        -limit..=limit,
        0.05,
    );
    let names = [t("Length"), t("Width"), t("Height")];
    let dimensions = numbers(ui, t("Size"), names, &mut size, 0.1..=60.0, 0.05);
    let turned = number(
        ui,
        t("Heading"),
        t("Heading"),
        &mut yaw_deg,
        -360.0..=360.0,
        "°",
        1,
    );
    let of_each = |edit: &dyn Fn(&SceneBox) -> [Option<DVec3>; 2], yaw_deg: Option<f64>| {
        let one = |b: &SceneBox| {
            let [center_m, size_m] = edit(b);
            Edit::MoveBox {
                id: b.id,
                center_m,
                yaw_deg,
                size_m,
            }
        };
        boxes.iter().map(one).collect::<Vec<_>>()
    };
    let moved = of_each(&|b| [Some(b.center_m + (center - middle_m)), None], None);
    fields(&position, "Move boxes", moved, commands);
    fields(
        &dimensions,
        "Resize boxes",
        of_each(&|_| [None, Some(size)], None),
        commands,
    );
    fields(
        &turned,
        "Turn boxes",
        of_each(&|_| [None, None], Some(yaw_deg)),
        commands,
    );
}

/// The box after (1) or before (-1) the chosen one, by id, wrapping around.
pub fn neighbour(ids: &[BoxId], chosen: Option<BoxId>, step: i32) -> Option<BoxId> {
    let count = ids.len() as i64;
    if count == 0 {
        return None;
    }
    let at = chosen.and_then(|id| ids.iter().position(|i| *i == id));
    let next = match at {
        Some(at) => (at as i64 + i64::from(step)).rem_euclid(count),
        None if step > 0 => 0,
        None => count - 1,
    };
    ids.get(next as usize).copied()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A pedestrian placed at 371 degrees turned all chosen boxes as soon as the inspector showed them.
    #[test]
    fn headings_beyond_a_turn_lie_within_their_field() {
        for deg in [371.0, -200.0, 540.0, 180.0, -0.5, 1e4] {
            let shown = heading_deg(f64::to_radians(deg));
            assert!((-180.0..=180.0).contains(&shown), "{deg}: {shown}");
            let off = (shown - deg).to_radians();
            assert!(off.cos() > 0.999_999, "{deg}: {shown}");
        }
    }

    #[test]
    fn stepping_through_boxes_goes_round() {
        let ids = [BoxId(2), BoxId(5), BoxId(9)];
        assert_eq!(neighbour(&ids, None, 1), Some(BoxId(2)));
        assert_eq!(neighbour(&ids, Some(BoxId(9)), 1), Some(BoxId(2)));
        assert_eq!(neighbour(&ids, Some(BoxId(2)), -1), Some(BoxId(9)));
        assert_eq!(neighbour(&[], Some(BoxId(2)), 1), None);
    }
}
