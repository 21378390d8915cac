//! Predictions of a small network for the LiDAR sweep of a scene, compared with its boxes: boxes that it misses, and
//! boxes that it sees where there are none.

use crate::lidar::{recorded, rolling};
use crate::pictures::painter::PaintError;
pub use nets::perceiver::against::LEAST_RETURNS;
use nets::perceiver::against::{Beside, against};
use nets::perceiver::detection::Detection;
use nets::perceiver::stands::{Stands, standing};
use nets::perceiver::{LidarPerceiver, Perceived};
use scene::{BoxId, Extent, Lattice, LidarSweep, Pose, Scene, SceneBox};

/// Radius around a return within which columns count, columns: 1.2 m.
const NEAR_COLUMNS: usize = 3;

/// Predictions for a scene's sweep, compared with the scene.
#[derive(Clone, Debug, PartialEq)]
pub struct SweepReport {
    /// Boxes with [`LEAST_RETURNS`] returns or more: missed ones first, then those with the most returns first.
    pub boxes: Vec<SeenBySweep>,
    /// Boxes that the network detects, the surest first.
    pub detections: Vec<Detected>,
    /// Share of the columns within 1.2 m of a return whose kind is predicted correctly.
    pub right: f64,
    /// Prediction for each column `[x][y]` of the window around the vehicle.
    pub stands: Vec<Stands>,
    /// Map from the vehicle.
    pub map_from_vehicle: Pose,
    /// Where the columns lie, in the frame of the vehicle.
    pub window: Extent,
}

/// A box of the scene in the sweep.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SeenBySweep {
    /// The box.
    pub id: BoxId,
    /// Returns on it.
    pub returns: usize,
    /// Score of the box's detection; `None` if it is not detected.
    pub score: Option<f32>,
}

impl SeenBySweep {
    /// True if the network does not detect it.
    pub fn is_missed(&self) -> bool {
        self.score.is_none()
    }
}

/// A box that the network detects.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Detected {
    /// Place, size, heading and class on the map.
    pub thing: SceneBox,
    /// Score, 0 to 1.
    pub score: f32,
    /// The box of the scene that it belongs to; `None` where there is none of its kind.
    pub of: Option<BoxId>,
}

/// Looks at the sweep of a scene's first LiDAR. Errors if the network cannot be read or refuses the sweep.
pub fn report(scene: &Scene) -> Result<SweepReport, PaintError> {
    let seen = PerceivedSweep::from_scene(scene)?;
    let mut boxes: Vec<SeenBySweep> = seen
        .besides
        .iter()
        .filter(|b| b.returns >= LEAST_RETURNS)
        .map(|b| seen.score(b))
        .collect();
    boxes.sort_by_key(|b| (!b.is_missed(), std::cmp::Reverse(b.returns)));
    let of = |i: usize| seen.besides.iter().find(|b| b.found == Some(i)).map(|b| b.id);
    let detected = |(i, d): (usize, &Detection)| Detected {
        thing: d.to_box(BoxId(0)).in_frame(&seen.map_from_vehicle),
        score: d.score,
        of: of(i),
    };
    let detections: Vec<Detected> = seen
        .perceived
        .detections
        .iter()
        .enumerate()
        .map(detected)
        .collect();
    // Ground truth of the columns around the vehicle, in its own frame, near returns.
    let scene = &*scene.in_lattice(Lattice::OCC3D);
    let around = scene.in_ego();
    let truth = standing(&around.frame().occupancy.crop(Extent::WINDOW));
    let told = truth
        .iter()
        .zip(&seen.perceived.stands)
        .zip(near(&seen.sweep, &seen.map_from_vehicle));
    let told = told.filter_map(|((truth, said), near)| near.then_some(Stands::of_label(*truth)? == *said));
    let (right, all) = told.fold((0usize, 0usize), |(r, n), ok| (r + usize::from(ok), n + 1));
    Ok(SweepReport {
        boxes,
        detections,
        right: if all == 0 { 1.0 } else { right as f64 / all as f64 },
        stands: seen.perceived.stands,
        map_from_vehicle: seen.map_from_vehicle,
        window: Extent::WINDOW,
    })
}

/// Result for one box; `None` if it is not in the window.
pub fn sight(scene: &Scene, id: BoxId) -> Result<Option<SeenBySweep>, PaintError> {
    let seen = PerceivedSweep::from_scene(scene)?;
    let beside = seen.besides.iter().find(|b| b.id == id);
    Ok(beside.map(|b| seen.score(b)))
}

/// A sweep, the predictions for it, and the boxes of the scene to compare with.
struct PerceivedSweep {
    perceived: Perceived,
    besides: Vec<Beside>,
    map_from_vehicle: Pose,
    sweep: LidarSweep,
}

impl PerceivedSweep {
    fn from_scene(scene: &Scene) -> Result<Self, PaintError> {
        let network = |e: &dyn std::fmt::Display| PaintError::Network(e.to_string());
        let net = LidarPerceiver::bundled().map_err(|e| network(&e))?;
        let of_sensors = scene.for_sensors();
        let recorded = recorded::sweep_of(&of_sensors);
        let sweep = recorded.unwrap_or_else(|| rolling::of_voxels(&of_sensors));
        let map_from_vehicle = scene.frame().world_from_ego;
        let perceived = net.perceive_sweep(&sweep, &map_from_vehicle);
        let perceived = perceived.map_err(|e| network(&e))?;
        let boxes = scene.frame().boxes.values();
        let found = against(&perceived.detections, boxes, &sweep, &map_from_vehicle);
        Ok(Self {
            perceived,
            besides: found.boxes,
            map_from_vehicle,
            sweep,
        })
    }

    fn score(&self, beside: &Beside) -> SeenBySweep {
        let detection = beside.found.and_then(|i| self.perceived.detections.get(i));
        SeenBySweep {
            id: beside.id,
            returns: beside.returns,
            score: detection.map(|d| d.score),
        }
    }
}

/// For each column of the window, whether a return of a sweep on the map is near.
pub(crate) fn near(sweep: &LidarSweep, map_from_vehicle: &Pose) -> Vec<bool> {
    let to_vehicle = map_from_vehicle.inverse();
    let [nx, ny] = [Extent::WINDOW.nx(), Extent::WINDOW.ny()];
    let mut near = vec![false; nx * ny];
    for point in &sweep.points {
        let at = to_vehicle.apply(point.position_in_ego.map(f64::from).into());
        let Some([x, y]) = Extent::WINDOW.column_at(at.x, at.y) else {
            continue;
        };
        for x in x.saturating_sub(NEAR_COLUMNS)..(x + NEAR_COLUMNS + 1).min(nx) {
            near[x * ny..][y.saturating_sub(NEAR_COLUMNS)..(y + NEAR_COLUMNS + 1).min(ny)].fill(true);
        }
    }
    near
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use super::*;
    use scene::{Class, Frame, SensorRig};
    use world::World;
    use world::voxelize::{Vertical, complete};

    fn scene() -> Scene {
        let world = World::random(3);
        let grid = complete(&world, Vertical::Occ3d);
        let frame = Frame::new(world.layout.clone(), world.boxes.clone(), grid);
        Scene::single("crossing", frame, Arc::new(SensorRig::default()), 1)
    }

    #[test]
    fn most_boxes_are_seen_and_one_that_goes_is_seen_no_more() {
        let scene = scene();
        let report = report(&scene).expect("the shipped network");
        assert!(report.right > 0.5, "{}", report.right);
        assert!(report.boxes.is_sorted_by_key(|b| !b.is_missed()));
        let seen: Vec<&SeenBySweep> = report.boxes.iter().filter(|b| !b.is_missed()).collect();
        assert!(!seen.is_empty());
        for b in &seen {
            let boxes = &scene.frame().boxes;
            let detected = report
                .detections
                .iter()
                .find(|d| d.of == Some(b.id))
                .expect("found");
            assert!(
                detected
                    .thing
                    .center_m
                    .truncate()
                    .distance(boxes[&b.id].center_m.truncate())
                    < 2.0
            );
            assert_eq!(sight(&scene, b.id).expect("seen"), Some(**b));
        }
        assert_eq!(sight(&scene, BoxId(9999)), Ok(None));
        assert!(
            seen.iter()
                .any(|b| scene.frame().boxes[&b.id].class == Class::Car)
        );
    }
}
