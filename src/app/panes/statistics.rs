//! Statistics of the scene: voxels and boxes per class, the road, things beside it, the last sweep.

use std::collections::BTreeMap;
use std::sync::Arc;

use egui::accesskit::Role;
use egui::{Align2, Rect, Sense, TextStyle, Ui, WidgetInfo, vec2};

use scene::{BevLayer, Class, Scene};

use super::camera_strip::thousands;
use super::id::PaneId;
use super::pane::{Pane, PaneContext, PanePlacement};
use crate::command::Command;
use language::{t, tf};
use widgets::icons::{Icon, section};
use widgets::theme;

/// Width of the class names, and of the numbers behind the bars, points.
const NAME_POINTS: f32 = 116.0;
const NUMBER_POINTS: f32 = 62.0;

/// Height of a row of the bars, points.
const ROW_POINTS: f32 = 17.0;

/// The scene in numbers.
#[derive(Default)]
pub struct Statistics {
    counted: Option<(Arc<Scene>, SceneCounts)>,
}

/// Counts of one state of a scene.
#[derive(Clone, Debug, PartialEq)]
struct SceneCounts {
    /// Voxels of each class, the most frequent class first, without empty space.
    voxels: Vec<(Class, usize)>,
    /// Boxes of each class, in the order of the classes.
    boxes: BTreeMap<Class, usize>,
    drivable_m2: f64,
    /// Share of voxels that are not empty, 0 to 1.
    occupied: f64,
    things: usize,
}

impl SceneCounts {
    fn from_scene(scene: &Scene) -> Self {
        let frame = scene.frame();
        let counts = frame.occupancy.class_counts();
        let count = |class: Class| counts[usize::from(class.id())];
        let solid = Class::ALL.into_iter().filter(|class| *class != Class::Free);
        let mut voxels: Vec<(Class, usize)> = solid.map(|class| (class, count(class))).collect();
        voxels.retain(|(_, n)| *n > 0);
        voxels.sort_by_key(|(_, n)| std::cmp::Reverse(*n));
        let mut boxes = BTreeMap::new();
        for b in frame.boxes.values() {
            *boxes.entry(b.class).or_default() += 1;
        }
        let set: usize = voxels.iter().map(|(_, n)| n).sum();
        let cells = frame.layout.count(BevLayer::DrivableArea);
        Self {
            voxels,
            boxes,
            drivable_m2: cells as f64 * frame.extent().voxel_m().powi(2),
            occupied: set as f64 / frame.extent().voxels() as f64,
            things: scene.background.len(),
        }
    }
}

impl Pane for Statistics {
    fn id(&self) -> PaneId {
        PaneId::named("statistics")
    }

    fn title(&self) -> String {
        "Statistics".into()
    }

    fn icon(&self) -> Icon {
        Icon::Bars
    }

    fn place(&self) -> PanePlacement {
        PanePlacement::Column
    }

    fn column_points(&self) -> f32 {
        266.0
    }

    fn ui(&mut self, ui: &mut Ui, cx: &mut PaneContext<'_>, _commands: &mut Vec<Command>) {
        let counts = match &self.counted {
            Some((of, counts)) if Arc::ptr_eq(of, cx.scene) => counts,
            _ => {
                let counts = SceneCounts::from_scene(cx.scene);
                &self.counted.insert((cx.scene.clone(), counts)).1
            }
        };
        let current = !cx.sensing.lidar_stale(cx.document.scene().rev);
        let points = cx
            .sensing
            .lidar()
            .filter(|_| current)
            .map(|sweep| sweep.points.len());
        theme::panel_frame().show(ui, |ui| {
            let area = egui::ScrollArea::vertical()
                .id_salt("statistics")
                .auto_shrink(false);
            area.show(ui, |ui| {
                ui.spacing_mut().item_spacing.y = 2.0;
                ui.label(tf!(
                    "Drivable area: {area} m²",
                    area = format!("{:.0}", counts.drivable_m2)
                ));
                ui.label(tf!(
                    "Occupied: {percent} % of all voxels",
                    percent = format!("{:.1}", counts.occupied * 100.0)
                ));
                ui.label(tf!("Beside the road: {n} things", n = thousands(counts.things)));
                ui.label(match points {
                    Some(points) => tf!("Last sweep: {n} points", n = thousands(points)),
                    None => t("Last sweep: none yet").to_owned(),
                });
                section(ui, t("Voxels"));
                let most = counts.voxels.first().map_or(1, |(_, n)| *n);
                for (class, n) in &counts.voxels {
                    let all = thousands(*n);
                    let what = match n {
                        1 => tf!("{n} voxel", n = all),
                        _ => tf!("{n} voxels", n = all),
                    };
                    bar(ui, *class, *n, most, &what);
                }
                section(ui, t("Boxes"));
                let most = counts.boxes.values().copied().max().unwrap_or(1);
                for (class, n) in &counts.boxes {
                    let all = thousands(*n);
                    let what = match n {
                        1 => tf!("{n} box", n = all),
                        _ => tf!("{n} boxes", n = all),
                    };
                    bar(ui, *class, *n, most, &what);
                }
                if counts.boxes.is_empty() {
                    ui.label(egui::RichText::new(t("none")).color(theme::text_weak()));
                }
            });
        });
    }
}

/// A row: the class, a bar in proportion to the largest number, and the number; `what` gives the number in words.
fn bar(ui: &mut Ui, class: Class, n: usize, most: usize, what: &str) {
    let size = vec2(ui.available_width(), ROW_POINTS);
    let (rect, response) = ui.allocate_exact_size(size, Sense::hover());
    let (name, number) = (theme::sentence(t(&class.label())), thousands(n));
    let label = format!("{name}: {what}");
    response.widget_info(|| WidgetInfo::labeled(Role::Label, true, &label));
    let font = TextStyle::Small.resolve(ui.style());
    let painter = ui.painter_at(rect);
    let left = rect.left_center();
    painter.text(left, Align2::LEFT_CENTER, name, font.clone(), theme::text());
    painter.text(
        rect.right_center(),
        Align2::RIGHT_CENTER,
        number,
        font,
        theme::text_weak(),
    );
    let room = (rect.width() - NAME_POINTS - NUMBER_POINTS).max(0.0);
    let length = (room * n as f32 / most.max(1) as f32).max(1.0);
    let corner = rect.left_top() + vec2(NAME_POINTS, 4.0);
    let filled = Rect::from_min_size(corner, vec2(length, ROW_POINTS - 8.0));
    painter.rect_filled(filled, 2.0, theme::class_color(class));
}

#[cfg(test)]
mod tests {
    use super::*;
    use scene::{BevLayout, BoxId, Extent, Frame, SceneBox, VoxelGrid};

    #[test]
    fn what_is_there_is_counted_and_nothing_else() {
        let mut layout = BevLayout::default();
        for x in 0..10 {
            layout.set(BevLayer::DrivableArea, x, 3, true);
        }
        let mut grid = VoxelGrid::new();
        grid.set(1, 2, 3, Class::Car.id());
        for x in 0..3 {
            grid.set(x, 5, 0, Class::Vegetation.id());
        }
        let car = SceneBox {
            id: BoxId(1),
            class: Class::Car,
            center_m: glam::DVec3::ZERO,
            size_m: glam::DVec3::ONE,
            yaw_rad: 0.0,
            velocity_mps: glam::DVec2::ZERO,
            label: Default::default(),
        };
        let frame = Frame::new(layout, [(BoxId(1), car)].into(), grid);
        let counts = SceneCounts::from_scene(&Scene::single("test", frame, Arc::default(), 1));
        assert_eq!(counts.voxels, [(Class::Vegetation, 3), (Class::Car, 1)]);
        assert_eq!(counts.boxes, [(Class::Car, 1)].into());
        assert!((counts.drivable_m2 - 10.0 * 0.16).abs() < 1e-9);
        assert!((counts.occupied * Extent::WINDOW.voxels() as f64 - 4.0).abs() < 1e-9);
        assert_eq!(counts.things, 0);
    }
}
