//! Models of other files as objects of a scene.

use glam::DVec2;

use crate::arrange::wrapped_deg;
use crate::lanes::nearest_lane;
use scene::relations::overlap_m;
use scene::{BoxId, BoxLabel, Edit, Extent, Frame, Model, Scene, SceneBox};

/// A model that is placed on the road takes the middle and the heading of a lane as near as this, m.
const LANE_REACH_M: f64 = 3.0;
/// A free place is looked for in rings so far apart, m, and in so many of them.
const RING_M: f64 = 2.0;
const RINGS: usize = 20;
/// Distance of the nearest part of a model ahead of the ego vehicle's origin, m.
const AHEAD_M: f64 = 8.0;
/// Length and width that are kept free where the ego vehicle stands, m.
const EGO_M: [f64; 2] = [5.0, 2.2];

/// A model on its way into a scene.
pub struct ModelPlacement {
    /// Edits that put it there.
    pub edits: Vec<Edit>,
    /// The number of its box.
    pub id: BoxId,
}

/// Place of a model that is put ahead of the ego vehicle, world frame, m.
pub fn ahead_m(scene: &Scene, model: &Model) -> DVec2 {
    let ahead_m = AHEAD_M + model.size_m.x / 2.0;
    let p = glam::DVec3::new(ahead_m, 0.0, 0.0);
    scene.frame().world_from_ego.apply(p).truncate()
}

/// Puts a model where nothing stands, as near to `at_m` (world frame, m) as can be. Without a heading it stands as the lane
/// there, on its middle, or with heading 0 beside lanes. Errors in one line if no number is left for a box, or no place.
pub fn place(
    scene: &Scene,
    model: &Model,
    at_m: DVec2,
    yaw_deg: Option<f64>,
) -> Result<ModelPlacement, String> {
    let frame = scene.frame();
    let id = frame.next_box_id();
    if frame.is_taken(id) {
        return Err("no number is left for another box".into());
    }
    let stand = |near_m: DVec2| {
        let lane = nearest_lane(&frame.layout, near_m, LANE_REACH_M).filter(|_| yaw_deg.is_none());
        match lane {
            Some(lane) => (lane.at_m, wrapped_deg(lane.yaw_rad.to_degrees())),
            None => (near_m, yaw_deg.unwrap_or(0.0)),
        }
    };
    let (at_m, yaw_deg) = near(at_m)
        .map(stand)
        .find(|(at_m, yaw_deg)| is_free(frame, model, *at_m, *yaw_deg))
        .ok_or("no free place is near")?;
    Ok(ModelPlacement {
        edits: model.placed(scene, id, at_m, yaw_deg),
        id,
    })
}

/// Gives a box that is there the shape and the size of a model, and its paint where the box has none of its own.
pub fn give(model: &Model, b: &SceneBox) -> Vec<Edit> {
    let label = BoxLabel {
        paint: b.label.paint.or(model.label.paint),
        ..b.label
    };
    let painted = (label != b.label).then_some(Edit::LabelBox { id: b.id, label });
    painted.into_iter().chain(model.given_to(b)).collect()
}

/// A point, and points around it in rings.
fn near(at_m: DVec2) -> impl Iterator<Item = DVec2> {
    let ring = move |i: usize| {
        let count = 6 * i;
        (0..count).map(move |k| {
            let angle = std::f64::consts::TAU * k as f64 / count as f64;
            at_m + DVec2::from_angle(angle) * RING_M * i as f64
        })
    };
    std::iter::once(at_m).chain((1..=RINGS).flat_map(ring))
}

fn is_free(frame: &Frame, model: &Model, at_m: DVec2, yaw_deg: f64) -> bool {
    let b = SceneBox {
        id: BoxId(0),
        class: model.class,
        center_m: at_m.extend(0.0),
        size_m: model.size_m,
        yaw_rad: yaw_deg.to_radians(),
        velocity_mps: DVec2::ZERO,
        label: model.label,
    };
    let ego = frame.world_from_ego;
    let local = ego.inverse().apply(at_m.extend(ego.translation_m.z)).truncate();
    let reach_m = model.size_m.truncate().length() / 2.0;
    let [length_m, width_m] = EGO_M;
    let off_ego =
        local.x.abs() > length_m / 2.0 + reach_m || local.y.abs() > width_m / 2.0 + reach_m.min(2.0);
    is_on(frame.extent(), at_m) && off_ego && frame.boxes.values().all(|other| overlap_m(&b, other) <= 0.0)
}

fn is_on(extent: Extent, at_m: DVec2) -> bool {
    extent.column_at(at_m.x, at_m.y).is_some()
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use super::*;
    use crate::apply_all;
    use glam::DVec3;
    use scene::{BevLayout, BoxLabel, Class, Paint, SensorRig, draft};

    /// A wedge: high at its rear, low ahead.
    fn wedge() -> Model {
        let cells = (-5..5).flat_map(|x| {
            let top = if x < 0 { 4 } else { 1 };
            (-2..2).flat_map(move |y| (-2..top).map(move |z| [x, y, z]))
        });
        Model {
            class: Class::Truck,
            size_m: DVec3::new(4.0, 1.6, 1.6),
            above_ground_m: 0.0,
            label: BoxLabel::default(),
            cells: cells.collect(),
        }
    }

    fn empty() -> Scene {
        let layout = BevLayout::over(Extent::WINDOW);
        let occupancy = draft::draft(&layout, std::iter::empty());
        let frame = Frame::new(layout, Default::default(), occupancy);
        Scene::single("a", frame, Arc::new(SensorRig::default()), 0)
    }

    fn with_a_wedge() -> (Scene, BoxId) {
        let mut scene = empty();
        let placed = place(&scene, &wedge(), DVec2::new(12.0, 4.0), Some(0.0)).expect("room");
        apply_all(&placed.edits, &mut scene).expect("sound");
        (scene, placed.id)
    }

    fn count(scene: &Scene) -> usize {
        let label = Class::Truck.id();
        let occupancy = &scene.frame().occupancy;
        let columns = occupancy.extent().all_columns();
        columns
            .map(|[x, y]| occupancy.column(x, y).iter().filter(|l| **l == label).count())
            .sum()
    }

    #[test]
    fn a_model_keeps_its_shape_wherever_it_goes_and_is_not_generated() {
        let (mut scene, id) = with_a_wedge();
        assert_eq!(Model::of(&scene, Some(id)), Ok(wedge()));
        assert_eq!(count(&scene), wedge().cells.len());
        assert!(!scene.for_generation().frame().boxes.contains_key(&id));
        assert!(scene.clip().stands());
        let turned = Edit::MoveBox {
            id,
            center_m: Some(DVec3::new(-8.4, -3.2, 0.8)),
            yaw_deg: Some(180.0),
            size_m: None,
        };
        apply_all(&[turned], &mut scene).expect("sound");
        assert_eq!(Model::of(&scene, Some(id)), Ok(wedge()));
        assert_eq!(count(&scene), wedge().cells.len());
        // High where its rear is now.
        let at = |x: f64| {
            scene
                .frame()
                .occupancy
                .extent()
                .column_at(x, -3.1)
                .expect("on the map")
        };
        let top = |[x, y]: [usize; 2]| {
            scene
                .frame()
                .occupancy
                .column(x, y)
                .iter()
                .rposition(|l| *l == Class::Truck.id())
        };
        assert!(top(at(-7.0)) > top(at(-9.8)));
    }

    #[test]
    fn a_model_that_moves_keeps_its_shape_and_so_does_one_that_stops() {
        let (mut scene, id) = with_a_wedge();
        let key = |time_s: f64, x: f64| scene::Key {
            time_s,
            at_m: DVec2::new(x, 4.0),
            yaw_deg: 0.0,
        };
        let motion = |motion| Edit::SetMotion {
            id: Some(id),
            motion,
            from_s: None,
            to_s: None,
        };
        let drives = scene::Motion::Keys(vec![key(0.0, 12.0), key(4.0, 22.0)]);
        apply_all(&[motion(Some(drives))], &mut scene).expect("sound");
        scene.show(2.0);
        assert_eq!(scene.frame().boxes[&id].center_m.x, 17.0);
        assert_eq!(Model::of(&scene, Some(id)), Ok(wedge()));
        apply_all(&[motion(None)], &mut scene).expect("sound");
        assert!(scene.clip().stands() && scene.frame().own_shapes.contains_key(&id));
        assert_eq!(scene.frame().boxes[&id].center_m.x, 17.0);
        assert_eq!(Model::of(&scene, Some(id)), Ok(wedge()));
        // Another size is another shape.
        let larger = Edit::MoveBox {
            id,
            center_m: None,
            yaw_deg: None,
            size_m: Some(DVec3::new(6.0, 2.4, 3.0)),
        };
        apply_all(&[larger], &mut scene).expect("sound");
        assert!(scene.frame().own_shapes.is_empty() && !scene.clip().tracks[&id].settled);
    }

    #[test]
    fn a_box_takes_the_paint_of_a_model_unless_it_has_its_own() {
        let mut model = wedge();
        model.label.paint = Some(Paint::Yellow);
        for (own, then) in [(None, Paint::Yellow), (Some(Paint::Blue), Paint::Blue)] {
            let mut scene = empty();
            let placed = place(&scene, &wedge(), DVec2::new(12.0, 4.0), None).expect("room");
            apply_all(&placed.edits[..1], &mut scene).expect("sound");
            let mut label = scene.frame().boxes[&placed.id].label;
            label.paint = own;
            let id = placed.id;
            apply_all(&[Edit::LabelBox { id, label }], &mut scene).expect("sound");
            let edits = give(&model, &scene.frame().boxes[&id]);
            apply_all(&edits, &mut scene).expect("sound");
            assert_eq!(
                scene.frame().boxes[&id].label,
                BoxLabel {
                    paint: Some(then),
                    ..label
                }
            );
            assert_eq!(Model::of(&scene, Some(id)).expect("there").cells, model.cells);
        }
    }

    #[test]
    fn a_model_that_is_lifted_or_stands_on_a_slope_keeps_its_shape() {
        let (mut scene, id) = with_a_wedge();
        let moved = |center_m: DVec3| Edit::MoveBox {
            id,
            center_m: Some(center_m),
            yaw_deg: None,
            size_m: None,
        };
        apply_all(&[moved(DVec3::new(12.0, 4.0, 1.6))], &mut scene).expect("sound");
        let lifted = Model::of(&scene, Some(id)).expect("there");
        assert_eq!(lifted.cells, wedge().cells);
        assert!((lifted.above_ground_m - 0.8).abs() < 1e-9);
        assert!(scene.clip().tracks[&id].settled && scene.frame().own_shapes.contains_key(&id));
        // A slope: whatever the height of the ground, it is the same shape.
        let mut scene = empty();
        scene.change_canvas(|canvas| {
            let extent = canvas.extent();
            canvas.layout.relief = scene::Relief::from_fn(extent, |p| p.x * 0.05);
        });
        let placed = place(&scene, &wedge(), DVec2::new(12.0, 4.0), Some(0.0)).expect("room");
        apply_all(&placed.edits, &mut scene).expect("sound");
        for x in [12.0, 13.3, 17.1, -9.0] {
            let z_m = scene.frame().layout.relief.height_m(DVec2::new(x, 4.0)) + 0.8;
            apply_all(&[moved(DVec3::new(x, 4.0, z_m))], &mut scene).expect("sound");
            assert_eq!(
                Model::of(&scene, Some(placed.id)).map(|m| m.cells),
                Ok(wedge().cells),
                "{x}"
            );
            assert!(scene.clip().tracks[&placed.id].settled);
        }
    }

    #[test]
    fn a_voxel_painted_onto_a_model_becomes_a_part_of_it() {
        let (mut scene, id) = with_a_wedge();
        let [x, y] = scene.frame().extent().column_at(13.0, 4.1).expect("on the map");
        let top = scene
            .frame()
            .occupancy
            .column(x, y)
            .iter()
            .rposition(|l| *l == Class::Truck.id());
        let cells = vec![[x, y, top.expect("there") + 1]];
        let class = Class::Truck;
        apply_all(&[Edit::PaintVoxels { cells, class }], &mut scene).expect("sound");
        let painted = Model::of(&scene, Some(id)).expect("there");
        assert_eq!(painted.cells.len(), wedge().cells.len() + 1);
        assert!(scene.clip().tracks[&id].own_shape && scene.clip().tracks[&id].settled);
    }

    #[test]
    fn copies_have_the_shape_too() {
        let (mut scene, id) = with_a_wedge();
        let copies = crate::arrange::duplicate(scene.frame(), &[id]);
        apply_all(&copies.edits, &mut scene).expect("sound");
        assert_eq!(Model::of(&scene, Some(copies.ids[0])), Ok(wedge()));
    }

    #[test]
    fn without_cells_a_box_has_the_voxels_of_its_class_again() {
        let (mut scene, id) = with_a_wedge();
        let b = scene.frame().boxes[&id];
        let mut plain = empty();
        apply_all(&[b.into()], &mut plain).expect("sound");
        apply_all(
            &[Edit::SetShape {
                id,
                cells: Vec::new(),
            }],
            &mut scene,
        )
        .expect("sound");
        assert!(scene.clip().tracks.is_empty());
        assert_eq!(scene.frame().boxes[&id], b);
        assert_eq!(scene.frame().occupancy, plain.frame().occupancy);
        // Once more it changes nothing.
        let content = scene.content();
        apply_all(
            &[Edit::SetShape {
                id,
                cells: Vec::new(),
            }],
            &mut scene,
        )
        .expect("sound");
        assert_eq!(scene.content(), content);
    }

    #[test]
    fn cells_beside_the_box_are_refused_and_change_nothing() {
        let (mut scene, id) = with_a_wedge();
        let content = scene.content();
        for cell in [[i32::MAX, 0, 0], [0, i32::MIN, 0], [0, 0, 99], [-8, 0, 0]] {
            let edit = Edit::SetShape {
                id,
                cells: vec![cell],
            };
            let error = apply_all(&[edit], &mut scene).expect_err("beside it").to_string();
            assert!(error.contains("is not on the box"), "{error}");
        }
        let none = Edit::SetShape {
            id: BoxId(77),
            cells: vec![[0; 3]],
        };
        assert!(apply_all(&[none], &mut scene).is_err());
        assert_eq!(scene.content(), content);
    }

    #[test]
    fn a_taken_place_is_avoided_and_a_full_map_is_said() {
        let (mut scene, first) = with_a_wedge();
        let next = place(&scene, &wedge(), DVec2::new(12.0, 4.0), Some(0.0)).expect("room");
        apply_all(&next.edits, &mut scene).expect("sound");
        let boxes = &scene.frame().boxes;
        assert!(overlap_m(&boxes[&first], &boxes[&next.id]) <= 0.0);
        assert!(place(&scene, &wedge(), DVec2::new(500.0, 0.0), None).is_err());
    }
}
