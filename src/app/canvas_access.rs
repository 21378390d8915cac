//! The map for screen readers: each box is a button with its name and position.

use egui::accesskit::{self, Action, Role};
use egui::{Rect, Ui};

use language::{t, tf};
use scene::{Pose, Scene, SceneBox};

use super::command::Command;
use super::screen_map::ScreenMap;
use super::state::{UiState, called};

/// Most boxes that are announced. A longer list is better read in the pane of objects.
const MOST: usize = 200;

/// The name of a box on the map: `Car 5 on the map: 12 m ahead, 3 m to the left`.
fn label(b: &SceneBox, ego: &Pose) -> String {
    let from_ego = ego.rotation.inverse() * (b.center_m - ego.translation_m);
    let along = if from_ego.x >= 0.0 {
        t("ahead")
    } else {
        t("behind")
    };
    let aside = if from_ego.y >= 0.0 {
        t("to the left")
    } else {
        t("to the right")
    };
    tf!(
        "{name} {id} on the map: {x} m {along}, {y} m {aside}",
        name = called(b),
        id = b.id.0,
        x = format!("{:.0}", from_ego.x.abs()),
        along = along,
        y = format!("{:.0}", from_ego.y.abs()),
        aside = aside,
    )
}

/// Announces the boxes in view, and answers requests to choose one.
pub(super) fn boxes(ui: &Ui, map: &ScreenMap, scene: &Scene, state: &UiState, commands: &mut Vec<Command>) {
    let frame = scene.frame();
    for b in frame.boxes.values().take(MOST) {
        let corners = b.footprint().map(|p| map.to_screen(p));
        let rect = Rect::from_points(&corners).intersect(map.rect);
        if !rect.is_positive() {
            continue;
        }
        let id = egui::Id::unique(("box on the map", b.id.0));
        let told = ui.ctx().accesskit_node_builder(id, |node| {
            node.set_role(Role::Button);
            node.set_label(label(b, &frame.world_from_ego));
            node.set_selected(state.is_chosen(b.id));
            node.set_bounds(accesskit::Rect {
                x0: rect.min.x.into(),
                y0: rect.min.y.into(),
                x1: rect.max.x.into(),
                y1: rect.max.y.into(),
            });
            node.add_action(Action::Click);
        });
        if told.is_none() {
            // No screen reader runs.
            return;
        }
        if ui.input(|i| i.has_accesskit_action_request(id, Action::Click)) {
            commands.push(Command::Select(Some(b.id)));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::{DQuat, DVec2, DVec3};
    use scene::{BoxId, Class};

    #[test]
    fn a_box_is_told_of_as_the_driver_sees_it() {
        let b = SceneBox {
            id: BoxId(5),
            class: Class::Car,
            center_m: DVec3::new(10.0, 12.0, 0.0),
            size_m: DVec3::ONE,
            yaw_rad: 0.0,
            velocity_mps: DVec2::ZERO,
            label: Default::default(),
        };
        let ego = Pose {
            translation_m: DVec3::new(10.0, 0.0, 0.0),
            rotation: DQuat::from_rotation_z(std::f64::consts::FRAC_PI_2),
        };
        assert_eq!(label(&b, &ego), "car 5 on the map: 12 m ahead, 0 m to the left");
        let behind = SceneBox {
            center_m: DVec3::new(14.0, -3.0, 0.0),
            ..b
        };
        assert_eq!(
            label(&behind, &ego),
            "car 5 on the map: 3 m behind, 4 m to the right"
        );
    }
}
