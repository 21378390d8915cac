//! Remark on vehicles that are to drive where there is no lane.

use scene::{Edit, Scene, Template};

use crate::lanes::nearest_lane;
use crate::traffic::lane_path::REACH_M;
use crate::traffic::template::shown;
use language::tf;

/// The remark on an [`Edit::LetMove`] of a vehicle (the ego vehicle too) without a lane under it, in one line; `None`
/// for [`Template::Cross`] and for any other edit.
pub fn off_lane(scene: &Scene, edit: &Edit) -> Option<String> {
    let &Edit::LetMove { id, template, .. } = edit else {
        return None;
    };
    let frame = scene.frame();
    let class = id.and_then(|id| frame.boxes.get(&id)).map(|b| b.class);
    if template == Template::Cross || class.is_some_and(|class| !class.is_vehicle()) {
        return None;
    }
    let at_m = shown(scene, id)?.at_m;
    let lane = nearest_lane(&frame.layout, at_m, f64::INFINITY);
    if lane.is_some_and(|lane| lane.distance_m <= REACH_M) {
        return None;
    }
    Some(match id {
        None => tf!(
            "The ego vehicle stands where no lane is within {reach} m: it goes straight ahead",
            reach = REACH_M,
        ),
        Some(id) => tf!(
            "Box {id} stands where no lane is within {reach} m: it goes straight ahead",
            id = id.0,
            reach = REACH_M,
        ),
    })
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use glam::{DVec2, DVec3};

    use super::*;
    use crate::{apply_all, remarks};
    use scene::{BevLayout, BoxId, Class, Frame, Polyline, PolylineKind, SensorRig, VoxelGrid};

    #[test]
    fn who_drives_without_a_lane_is_told() {
        let mut layout = BevLayout::default();
        layout.polylines = Arc::new(vec![Polyline {
            kind: PolylineKind::LaneCenter,
            points_m: vec![DVec2::new(-40.0, 0.0), DVec2::new(40.0, 0.0)],
        }]);
        let frame = Frame::new(layout, Default::default(), VoxelGrid::new());
        let mut scene = Scene::single("road", frame, Arc::new(SensorRig::default()), 1);
        let add = |class, y: f64| Edit::AddBox {
            class,
            center_m: DVec3::new(10.0, y, 1.0),
            size_m: DVec3::new(4.0, 1.9, 2.0),
            yaw_deg: 0.0,
            velocity_mps: None,
            id: None,
            label: Default::default(),
        };
        apply_all(&[add(Class::Truck, 30.0), add(Class::Car, 3.0)], &mut scene).expect("sound");
        let drive = |id, template| Edit::LetMove {
            id,
            template,
            mps: None,
            from_s: None,
            gap_m: None,
        };
        let said = |id: Option<u32>, template| remarks(&scene, &[drive(id.map(BoxId), template)]);
        let truck = said(Some(1), Template::Drive);
        assert_eq!(truck.len(), 1);
        assert!(
            truck[0].starts_with("Box 1 ") && truck[0].contains("no lane is within 6 m"),
            "{truck:?}"
        );
        assert!(!truck[0].contains('\n'));
        assert_eq!(said(Some(2), Template::Drive), [""; 0]);
        assert_eq!(said(None, Template::Drive), [""; 0]);
        assert_eq!(said(Some(1), Template::Cross), [""; 0]);
        // Of a box that comes with the same edits too.
        let both = [add(Class::Bus, -20.0), drive(Some(BoxId(3)), Template::Follow)];
        assert_eq!(remarks(&scene, &both).len(), 1);
    }
}
