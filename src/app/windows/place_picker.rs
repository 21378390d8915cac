//! The window that chooses the place of a scene on a network of roads: the whole network from above; a click chooses
//! the place.

use egui::accesskit::Role;
use egui::{Color32, DragValue, Pos2, Rect, Sense, Shape, Stroke, Ui, WidgetInfo, pos2, vec2};
use glam::DVec2;

use authoring::open::Placement;
use formats::opendrive::RoadNetwork;
use language::{t, tf};
use widgets::theme;

/// Size of the picture, points.
const PICTURE_POINTS: egui::Vec2 = vec2(660.0, 440.0);
/// Least distance between two points of a drawn road, m.
const STEP_M: f64 = 2.0;
/// Most points of a road.
const MOST_POINTS: f64 = 400.0;
/// Width of a road in the picture, m.
const ROAD_M: f64 = 7.0;
/// Most points per metre.
const LARGEST_SCALE: f64 = 20.0;

/// The network, and the choices of the user.
pub struct PlacePicker {
    network: RoadNetwork,
    /// Name of the new scene.
    pub name: String,
    roads_m: Vec<Vec<DVec2>>,
    bounds_m: [DVec2; 2],
    center_m: DVec2,
    scale: Option<f64>,
    at: (DVec2, f64),
    whole: bool,
    size_m: [f64; 2],
    traffic: bool,
    scenery: bool,
    seed: u64,
}

impl PlacePicker {
    /// A picker at the place that the network suggests.
    pub fn new(network: RoadNetwork, name: String) -> Self {
        let line = |road: &formats::opendrive::XodrRoad| {
            let length_m = road.length_m();
            let steps = (length_m / STEP_M).ceil().clamp(1.0, MOST_POINTS) as usize;
            let point = |i: usize| road.reference.at(length_m * i as f64 / steps as f64).position_m;
            (0..=steps).map(point).filter(|p| p.is_finite()).collect()
        };
        let roads_m: Vec<Vec<DVec2>> = network.roads.iter().map(line).collect();
        let bounds_m = network.bounds_m();
        Self {
            at: network.suggest_pose(),
            center_m: (bounds_m[0] + bounds_m[1]) / 2.0,
            network,
            name,
            roads_m,
            bounds_m,
            scale: None,
            whole: false,
            size_m: [80.0; 2],
            traffic: true,
            scenery: true,
            seed: 0,
        }
    }

    /// The road network.
    pub fn into_network(self) -> RoadNetwork {
        self.network
    }

    /// The choices of the user.
    pub fn placement(&self) -> Placement {
        let usual = self.size_m == [80.0; 2];
        Placement {
            at_m: Some(self.at.0),
            heading_rad: Some(self.at.1),
            size_m: (!usual).then_some(self.size_m),
            whole: self.whole,
            seed: self.seed,
            empty: !self.traffic,
            bare: !self.scenery,
        }
    }

    /// Moves to the lane nearest to a place.
    fn choose(&mut self, at_m: DVec2) {
        if let Some(pose) = self.network.pose_on_lane_near(at_m) {
            self.at = (pose.position_m, pose.heading_rad);
        }
    }

    fn to_screen(&self, rect: Rect, scale: f64, p: DVec2) -> Pos2 {
        let d = (p - self.center_m) * scale;
        rect.center() + vec2(d.x as f32, -d.y as f32)
    }

    fn to_file(&self, rect: Rect, scale: f64, p: Pos2) -> DVec2 {
        let d = p - rect.center();
        self.center_m + DVec2::new(f64::from(d.x), -f64::from(d.y)) / scale
    }

    /// The corners of the map, file frame, m.
    fn map_m(&self) -> [DVec2; 4] {
        let extent = self.placement().extent(&self.network, self.at);
        let (low, high) = (extent.min_m().truncate(), extent.max_m().truncate());
        let turn = DVec2::from_angle(self.at.1);
        [low, DVec2::new(high.x, low.y), high, DVec2::new(low.x, high.y)].map(|p| self.at.0 + turn.rotate(p))
    }

    fn picture(&mut self, ui: &mut Ui) {
        let (rect, response) = ui.allocate_exact_size(PICTURE_POINTS, Sense::click_and_drag());
        response.widget_info(|| {
            WidgetInfo::labeled(
                Role::Canvas,
                true,
                t("Network of roads: a click chooses the place"),
            )
        });
        let extent_m = (self.bounds_m[1] - self.bounds_m[0]).max(DVec2::splat(1.0));
        let fits = (f64::from(rect.width()) / extent_m.x).min(f64::from(rect.height()) / extent_m.y) * 0.94;
        let mut scale = self.scale.unwrap_or(fits);
        if response.dragged() {
            let d = response.drag_delta();
            self.center_m -= DVec2::new(f64::from(d.x), -f64::from(d.y)) / scale;
        }
        if let Some(pointer) = response.hover_pos() {
            let wheel = f64::from(ui.input(|i| i.smooth_scroll_delta().y));
            if wheel != 0.0 {
                let under_m = self.to_file(rect, scale, pointer);
                scale = (scale * (wheel * 0.004).exp()).clamp(fits.min(LARGEST_SCALE) * 0.5, LARGEST_SCALE);
                self.center_m += under_m - self.to_file(rect, scale, pointer);
            }
        }
        self.scale = Some(scale);
        if response.clicked()
            && let Some(at) = response.interact_pointer_pos()
        {
            self.choose(self.to_file(rect, scale, at));
        }
        let painter = ui.painter_at(rect);
        painter.rect_filled(rect, theme::RADIUS, theme::well());
        let corners: Vec<Pos2> = self
            .map_m()
            .iter()
            .map(|p| self.to_screen(rect, scale, *p))
            .collect();
        painter.add(Shape::convex_polygon(
            corners,
            theme::accent_fill(),
            Stroke::new(1.5, theme::accent()),
        ));
        let width = (ROAD_M * scale).clamp(1.5, 60.0) as f32;
        let stroke = Stroke::new(width, theme::text_weak().gamma_multiply(0.6));
        for road in &self.roads_m {
            let points: Vec<Pos2> = road.iter().map(|p| self.to_screen(rect, scale, *p)).collect();
            painter.add(Shape::line(points, stroke));
        }
        let at = self.to_screen(rect, scale, self.at.0);
        let turn = DVec2::from_angle(self.at.1);
        let arrow = [(9.0, 0.0), (-6.0, 5.5), (-6.0, -5.5)].map(|(x, y)| {
            let p = turn.rotate(DVec2::new(x, y));
            pos2(at.x + p.x as f32, at.y - p.y as f32)
        });
        painter.add(Shape::convex_polygon(
            arrow.to_vec(),
            Color32::WHITE,
            Stroke::new(1.0, theme::accent()),
        ));
    }

    fn options(&mut self, ui: &mut Ui) {
        ui.horizontal(|ui| {
            ui.label(t("Map"));
            ui.add_enabled_ui(!self.whole, |ui| {
                for (value, hint) in self
                    .size_m
                    .iter_mut()
                    .zip([t("Length, along the heading"), t("Width")])
                {
                    let value = DragValue::new(value)
                        .range(20.0..=Placement::MAX_SIZE_M)
                        .speed(1.0)
                        .suffix(" m");
                    ui.add(value).on_hover_text(hint);
                }
                for (name, size_m) in [
                    ("80 × 80", [80.0; 2]),
                    ("300 × 100", [300.0, 100.0]),
                    ("1000 × 100", [1000.0, 100.0]),
                ] {
                    if ui.small_button(name).clicked() {
                        self.size_m = size_m;
                    }
                }
            });
            ui.checkbox(&mut self.whole, t("All of it"));
        });
        ui.horizontal(|ui| {
            ui.checkbox(&mut self.traffic, t("Traffic"));
            ui.checkbox(&mut self.scenery, t("Scenery"));
            ui.label(t("Seed"));
            ui.add(DragValue::new(&mut self.seed).speed(0.1));
            let degrees = self.at.1.to_degrees().rem_euclid(360.0);
            let text = tf!(
                "at {x}, {y} m, heading {degrees}°",
                x = format!("{:.0}", self.at.0.x),
                y = format!("{:.0}", self.at.0.y),
                degrees = format!("{degrees:.0}")
            );
            ui.label(egui::RichText::new(text).color(theme::text_weak()));
        });
    }
}

/// Draws the window; returns true once a scene is to be made.
pub fn place_picker(ui: &Ui, picker: &mut PlacePicker, open: &mut bool) -> bool {
    let mut make = false;
    egui::Window::new(tf!("A place on {roads}", roads = picker.name))
        .id(egui::Id::unique("place picker"))
        .open(open)
        .default_pos(pos2(380.0, 110.0))
        .resizable(false)
        .show(ui.ctx(), |ui| {
            picker.picture(ui);
            ui.add_space(4.0);
            picker.options(ui);
            let problem = picker.placement().problem_on(&picker.network);
            ui.horizontal(|ui| {
                let button = egui::Button::new(t("Make the scene")).selected(true);
                make = ui.add_enabled(problem.is_none(), button).clicked();
                let weak = |text: &str, color: Color32| egui::RichText::new(text).color(color);
                match problem {
                    Some(problem) => ui.label(weak(&problem, theme::bad())),
                    None => ui.label(weak(
                        t("Click chooses a lane · drag pans · wheel zooms"),
                        theme::text_weak(),
                    )),
                };
            });
        });
    make
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_click_chooses_the_lane_under_it() {
        let text = r#"<OpenDRIVE><header revMajor="1" revMinor="6"/>
            <road name="" length="400" id="1" junction="-1"><planView>
            <geometry s="0" x="0" y="0" hdg="0" length="400"><line/></geometry></planView>
            <lanes><laneSection s="0"><left><lane id="1" type="driving"><width sOffset="0" a="3.5" b="0" c="0" d="0"/></lane></left>
            <center><lane id="0" type="none"/></center>
            <right><lane id="-1" type="driving"><width sOffset="0" a="3.5" b="0" c="0" d="0"/></lane></right></laneSection></lanes>
            </road></OpenDRIVE>"#;
        let network = formats::opendrive::read(text.as_bytes()).expect("a road");
        let mut picker = PlacePicker::new(network, "road".into());
        picker.choose(DVec2::new(300.0, 2.0));
        assert!(
            (picker.at.0 - DVec2::new(300.0, 1.75)).length() < 0.3,
            "{:?}",
            picker.at
        );
        assert!(
            (picker.at.1.abs() - std::f64::consts::PI).abs() < 0.01,
            "its left lane leads back"
        );
        let rect = Rect::from_min_size(Pos2::ZERO, PICTURE_POINTS);
        let p = DVec2::new(120.0, -7.0);
        let back = picker.to_file(rect, 1.5, picker.to_screen(rect, 1.5, p));
        assert!((back - p).length() < 0.01);
        picker.whole = true;
        let corners = picker.map_m();
        let inside = |p: DVec2| {
            let (low, high) = corners
                .iter()
                .fold((corners[0], corners[0]), |(l, h), c| (l.min(*c), h.max(*c)));
            p.cmpge(low).all() && p.cmple(high).all()
        };
        assert!(
            inside(DVec2::ZERO) && inside(DVec2::new(400.0, 0.0)),
            "{corners:?}"
        );
        assert_eq!(picker.placement().problem_on(&picker.network), None);
    }
}
