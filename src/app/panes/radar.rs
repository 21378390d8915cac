//! The newest scans of all radars from above, forward up: where something gave an echo, how strong it was and how fast it moves
//! along the ray.

use std::sync::Arc;

use egui::accesskit::Role;
use egui::{Align2, Color32, Pos2, Rect, Sense, Stroke, TextStyle, Ui, WidgetInfo, vec2};
use glam::{DVec2, DVec3};

use super::areas::in_rect;
use super::id::PaneId;
use super::pane::{Pane, PaneContext};
use crate::camera_views::{FAST_MPS, MOVES_MPS, RCS_DBSM, RadarColors, RadarShown, radar_color};
use crate::command::Command;
use crate::place_marks;
use crate::state::called;
use crate::tools::ToolCommand;
use crate::windows::open::SensorChoice;
use language::{t, tf};
use scene::{Pose, RadarPattern, RadarReturn, RadarScan, Scene, SceneBox};
use widgets::icons::Icon;
use widgets::theme;

/// Distance from the pointer within which a return counts as pointed at, points.
const NEAR: f32 = 9.0;
/// Time over which the line of a moving target shows its way, s.
const AHEAD_S: f64 = 0.5;
/// Reach of the picture from its middle, m.
const REACH_M: std::ops::RangeInclusive<f64> = 15.0..=300.0;

/// The pane of the newest radar scans.
pub struct Radar;

impl Pane for Radar {
    fn id(&self) -> PaneId {
        PaneId::RADAR
    }

    fn title(&self) -> String {
        "Radar".into()
    }

    fn icon(&self) -> Icon {
        Icon::Radar
    }

    fn controls(&mut self, ui: &mut Ui, cx: &mut PaneContext<'_>, _commands: &mut Vec<Command>) {
        let colors = [
            (RadarColors::Speed, "Speed"),
            (RadarColors::Strength, "Strength"),
            (RadarColors::Class, "Class"),
        ];
        let shown = colors.iter().find(|(mode, _)| *mode == cx.state.radar.colors);
        egui::ComboBox::from_id_salt("radar colours")
            .selected_text(t(shown.map_or("Speed", |(_, name)| name)))
            .width(84.0)
            .show_ui(ui, |ui| {
                for (mode, name) in colors {
                    ui.selectable_value(&mut cx.state.radar.colors, mode, t(name));
                }
            })
            .response
            .accessible_name(t("Radar colour"));
        let stale = cx.sensing.radar_stale(cx.document.scene().rev);
        if stale && cx.sensing.radar().is_some() && !cx.state.playback.playing {
            let spinner = egui::Spinner::new().size(12.0).color(theme::text_weak());
            ui.add(spinner).on_hover_text(t("updating"));
        }
    }

    fn ui(&mut self, ui: &mut Ui, cx: &mut PaneContext<'_>, commands: &mut Vec<Command>) {
        cx.state.radar.drawn = RadarShown::DRAWN;
        let area = ui.available_rect_before_wrap();
        let (scene, scans) = (cx.scene.clone(), cx.sensing.radar().cloned());
        in_rect(ui, area, |ui| show(ui, &scene, scans.as_ref(), cx, commands));
    }
}

/// A map of the surroundings: the vehicle's place on screen, and points in a metre.
struct RadarMap {
    middle: Pos2,
    scale: f32,
    ego_from_world: Pose,
}

impl RadarMap {
    fn at(&self, p_in_ego: DVec2) -> Pos2 {
        self.middle + vec2(-p_in_ego.y as f32, -p_in_ego.x as f32) * self.scale
    }

    fn of_world(&self, p: DVec3) -> Pos2 {
        self.at(self.ego_from_world.apply(p).truncate())
    }

    fn of_return(&self, one: &RadarReturn) -> Pos2 {
        self.of_world(place_of(one))
    }
}

fn place_of(one: &RadarReturn) -> DVec3 {
    DVec3::from_array(one.position_m.map(f64::from))
}

fn show(
    ui: &mut Ui,
    scene: &Scene,
    scans: Option<&Arc<Vec<RadarScan>>>,
    cx: &mut PaneContext<'_>,
    commands: &mut Vec<Command>,
) {
    let rect = ui.available_rect_before_wrap();
    let response = ui.allocate_rect(rect, Sense::click());
    response.widget_info(|| WidgetInfo::labeled(Role::Canvas, true, t("Radar")));
    ui.painter().rect_filled(rect, 0.0, theme::well());
    let Some(scans) = scans.filter(|_| !scene.rig.radars.is_empty()) else {
        let text = match scene.rig.radars.is_empty() {
            true => t("This vehicle has no radar. Sensors… adds one."),
            false => t("rendering…"),
        };
        let font = TextStyle::Body.resolve(ui.style());
        let painter = ui.painter();
        painter.text(
            rect.center(),
            Align2::CENTER_CENTER,
            text,
            font,
            theme::text_weak(),
        );
        return;
    };
    if response.hovered() {
        let turned = ui.input(|i| f64::from(i.smooth_scroll_delta.y));
        let reach_m = cx.state.radar.reach_m * (-turned / 300.0).exp();
        cx.state.radar.reach_m = reach_m.clamp(*REACH_M.start(), *REACH_M.end());
    }
    let map = RadarMap {
        middle: rect.center(),
        scale: rect.width().min(rect.height()) / 2.0 / cx.state.radar.reach_m as f32,
        ego_from_world: scene.frame().world_from_ego.inverse(),
    };
    let inside = ui.painter().with_clip_rect(rect.intersect(ui.clip_rect()));
    rings(&inside, ui, &map, cx.state.radar.reach_m);
    for (i, radar) in scene.rig.radars.iter().enumerate() {
        let windows = &cx.state.windows;
        let is_chosen = windows.sensors && windows.sensor == SensorChoice::Radar(i);
        field_of_view(&inside, &map, radar, is_chosen);
    }
    let chosen = cx.state.chosen();
    for b in scene.frame().boxes.values() {
        let edge = match chosen.contains(&b.id) {
            true => Stroke::new(1.8, theme::accent()),
            false => Stroke::new(1.0, Color32::from_white_alpha(70)),
        };
        outline(&inside, &map, b, edge);
    }
    vehicle(&inside, &map, scene);
    let all = || {
        scans
            .iter()
            .flat_map(|scan| scan.returns.iter().map(move |one| (scan, one)))
    };
    for (scan, radar) in scans.iter().zip(&scene.rig.radars) {
        let sensor = map.at(DVec3::from_array(radar.translation_m).truncate());
        for one in &scan.returns {
            mark(&inside, &map, one, sensor, cx.state.radar.colors);
        }
    }
    let entries = colors_told(cx.state.radar.colors);
    if !entries.is_empty() {
        let height = 10.0 + 16.0 * entries.len() as f32;
        super::compare::legend(ui, rect.left_bottom() + vec2(8.0, -height - 8.0), &entries);
    }
    if let Some(place_m) = place_marks::elsewhere(cx.state, PaneId::RADAR) {
        place_marks::draw(&inside, map.of_world(place_m));
    }
    let Some(p) = response.hover_pos() else { return };
    let distance = |one: &RadarReturn| map.of_return(one).distance(p);
    let near = all().min_by(|a, b| distance(a.1).total_cmp(&distance(b.1)));
    let near = near.filter(|(_, one)| distance(one) <= NEAR);
    let hit = near.and_then(|(_, one)| box_of(scene, one));
    if let Some((scan, one)) = near {
        inside.circle_stroke(map.of_return(one), 7.0, Stroke::new(1.5, Color32::WHITE));
        cx.state.pointed.readout = readout(scan, one, hit);
        place_marks::point(cx.state, PaneId::RADAR, place_of(one));
    }
    if response.clicked() {
        let shift = ui.input(|i| i.modifiers.shift);
        commands.push(Command::Tools(ToolCommand::clicked(hit.map(|b| b.id), shift)));
    }
}

/// Entries of the legend.
fn colors_told(colors: RadarColors) -> Vec<(Color32, String)> {
    let of = |speed_over_ground_mps: f32, rcs_dbsm: f32| RadarReturn {
        speed_over_ground_mps,
        rcs_dbsm,
        position_m: [0.0; 3],
        range_m: 1.0,
        azimuth_rad: 0.0,
        elevation_rad: None,
        speed_mps: 0.0,
        snr_db: 0.0,
        class: scene::Class::Others,
    };
    let entry = |one: RadarReturn, text: String| (radar_color(&one, colors), text);
    match colors {
        RadarColors::Class => Vec::new(),
        RadarColors::Speed => vec![
            entry(of(-FAST_MPS, 0.0), t("comes nearer").into()),
            entry(of(0.0, 0.0), t("stands").into()),
            entry(of(FAST_MPS, 0.0), t("goes away").into()),
        ],
        RadarColors::Strength => RCS_DBSM
            .map(|rcs| entry(of(0.0, rcs), tf!("{rcs} dBsm", rcs = format!("{rcs:.0}"))))
            .to_vec(),
    }
}

fn readout(scan: &RadarScan, one: &RadarReturn, hit: Option<&SceneBox>) -> String {
    tf!(
        "{radar}  ·  {range} m at {azimuth}°  ·  {speed} m/s, {ground} over ground  ·  {rcs} dBsm  ·  {class}",
        radar = scan.radar,
        range = format!("{:.1}", one.range_m),
        azimuth = numeric_text(one.azimuth_rad.to_degrees(), 0),
        speed = numeric_text(one.speed_mps, 1),
        ground = numeric_text(one.speed_over_ground_mps, 1),
        rcs = numeric_text(one.rcs_dbsm, 1),
        class = match hit {
            Some(b) => format!("{} #{}", called(b), b.id.0),
            None => t(&one.class.label()).to_owned(),
        }
    )
}

/// A number without a sign of zero.
fn numeric_text(value: f32, digits: usize) -> String {
    numeric::decimal::decimal(f64::from(value), digits)
}

/// The box that a return belongs to, seen from above; the smallest of several.
fn box_of<'a>(scene: &'a Scene, one: &RadarReturn) -> Option<&'a SceneBox> {
    const MARGIN_M: f64 = 0.8;
    let hidden = &scene.arranged.hidden.boxes;
    let at = place_of(one).truncate();
    let holds = |b: &&SceneBox| {
        let level = at.extend(b.center_m.z);
        b.class == one.class && !hidden.contains(&b.id) && b.contains(level, MARGIN_M)
    };
    let volume = |b: &SceneBox| b.size_m.element_product();
    let all = scene.frame().boxes.values().filter(holds);
    all.min_by(|a, b| volume(a).total_cmp(&volume(b)))
}

/// Circles of distance with their numbers.
fn rings(painter: &egui::Painter, ui: &Ui, map: &RadarMap, reach_m: f64) {
    let steps_m = [5.0, 10.0, 20.0, 50.0, 100.0];
    let step_m = steps_m
        .into_iter()
        .find(|step| reach_m / step <= 5.0)
        .unwrap_or(100.0);
    let font = TextStyle::Small.resolve(ui.style());
    for i in 1..=8 {
        let radius_m = step_m * f64::from(i);
        let radius = radius_m as f32 * map.scale;
        painter.circle_stroke(
            map.middle,
            radius,
            Stroke::new(1.0, Color32::from_white_alpha(26)),
        );
        let at = map.at(DVec2::new(radius_m, 0.0)) + vec2(3.0, 0.0);
        painter.text(
            at,
            Align2::LEFT_TOP,
            format!("{radius_m:.0} m"),
            font.clone(),
            theme::text_weak(),
        );
    }
}

/// The edge of a field of view.
fn field_of_view(painter: &egui::Painter, map: &RadarMap, radar: &RadarPattern, is_chosen: bool) {
    const STEPS: usize = 96;
    let (pose, half_deg) = (radar.ego_from_sensor(), radar.half_azimuth_deg());
    let reach_m = |azimuth_deg: f64| {
        let holds = radar
            .fields
            .iter()
            .filter(|f| azimuth_deg.abs() <= f.half_azimuth_deg + 1e-9);
        holds.map(|f| f.max_range_m).fold(0.0, f64::max)
    };
    let mut edge = vec![map.at(pose.translation_m.truncate())];
    for i in 0..=STEPS {
        let azimuth_deg = half_deg * (2.0 * i as f64 / STEPS as f64 - 1.0);
        let (sin, cos) = azimuth_deg.to_radians().sin_cos();
        let p = pose.apply(DVec3::new(cos, sin, 0.0) * reach_m(azimuth_deg));
        edge.push(map.at(p.truncate()));
    }
    let line = match is_chosen {
        true => Stroke::new(2.0, theme::accent()),
        false => Stroke::new(1.0, theme::accent().gamma_multiply(0.45)),
    };
    painter.add(egui::Shape::closed_line(edge, line));
}

fn outline(painter: &egui::Painter, map: &RadarMap, b: &SceneBox, edge: Stroke) {
    let half = b.size_m / 2.0;
    let corner = |x: f64, y: f64| map.of_world(b.to_ego(DVec3::new(x * half.x, y * half.y, 0.0)));
    let corners = vec![
        corner(1.0, 1.0),
        corner(-1.0, 1.0),
        corner(-1.0, -1.0),
        corner(1.0, -1.0),
    ];
    painter.add(egui::Shape::closed_line(corners, edge));
}

fn vehicle(painter: &egui::Painter, map: &RadarMap, scene: &Scene) {
    let rig = &scene.rig;
    let ([x, y, _], [length, width, _]) = (rig.ego_center_m, rig.ego_size_m);
    let corner = |ahead: f64, left: f64| map.at(DVec2::new(x + ahead * length / 2.0, y + left * width / 2.0));
    let body = Rect::from_two_pos(corner(1.0, 1.0), corner(-1.0, -1.0));
    painter.rect_filled(body.expand(1.0), 2.0, Color32::from_rgb(228, 232, 238));
}

/// A return: a disc as large as its echo is strong, with its way along the ray if it moves.
fn mark(painter: &egui::Painter, map: &RadarMap, one: &RadarReturn, sensor: Pos2, colors: RadarColors) {
    let (at, color) = (map.of_return(one), radar_color(one, colors));
    let [low, high] = RCS_DBSM;
    let share = ((one.rcs_dbsm - low) / (high - low)).clamp(0.0, 1.0);
    painter.circle_filled(at, 1.8 + 2.6 * share, color);
    if one.speed_over_ground_mps.abs() >= MOVES_MPS {
        let from_sensor = (at - sensor).normalized();
        let way = f64::from(one.speed_over_ground_mps) * AHEAD_S;
        painter.line_segment(
            [at, at + from_sensor * way as f32 * map.scale],
            Stroke::new(1.5, color),
        );
    }
}
