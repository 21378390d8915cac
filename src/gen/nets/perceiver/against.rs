//! Detections compared with the boxes of a scene: boxes that are found, boxes that are missed, and detections where
//! there is no box.

use glam::DVec2;

use super::detection::{Detection, DetectionGroup};
use scene::{BoxId, Extent, LidarSweep, Pose, SceneBox};

/// Centres nearer than this belong together, m.
pub const NEAR_M: f64 = 2.0;
/// Least number of returns on a box that counts as missed if it is not detected.
pub const LEAST_RETURNS: usize = 5;
/// Largest distance of a return of the same class outside its box that still counts as on it, m.
const MARGIN_M: f64 = 0.3;

/// A box of a scene, compared with the detections.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Beside {
    /// The box.
    pub id: BoxId,
    /// Returns on it.
    pub returns: usize,
    /// Place of its detection in the list, if there is one.
    pub found: Option<usize>,
}

impl Beside {
    /// True if it has enough returns and is not detected.
    pub fn is_missed(&self) -> bool {
        self.found.is_none() && self.returns >= LEAST_RETURNS
    }
}

/// A scene, compared with the detections.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Against {
    /// Boxes in the window, in the order they were given.
    pub boxes: Vec<Beside>,
    /// Places in the list of detections that belong to no box of their group.
    pub ghosts: Vec<usize>,
}

impl Against {
    /// Boxes that are missed, those with the most returns first.
    pub fn missed(&self) -> Vec<Beside> {
        let mut missed: Vec<Beside> = self.boxes.iter().copied().filter(Beside::is_missed).collect();
        missed.sort_by_key(|b| std::cmp::Reverse(b.returns));
        missed
    }
}

/// Compares detections, the surest first, with boxes; each takes the nearest free box of its group within [`NEAR_M`].
/// Detections are in the frame of the vehicle, boxes and sweep in that of the map, `map_from_vehicle` between them.
pub fn against<'a>(
    detections: &[Detection],
    boxes: impl IntoIterator<Item = &'a SceneBox>,
    sweep: &LidarSweep,
    map_from_vehicle: &Pose,
) -> Against {
    let to_vehicle = map_from_vehicle.inverse();
    let inside = |b: &&SceneBox| {
        let p = to_vehicle.apply(b.center_m);
        Extent::WINDOW.column_at(p.x, p.y).is_some()
    };
    let boxes: Vec<&SceneBox> = boxes.into_iter().filter(inside).collect();
    let mut besides: Vec<Beside> = boxes
        .iter()
        .map(|b| Beside {
            id: b.id,
            returns: returns_on(b, sweep),
            found: None,
        })
        .collect();
    let mut ghosts = Vec::new();
    for (i, detection) in detections.iter().enumerate() {
        let at = map_from_vehicle.apply(detection.center_m.map(f64::from).into());
        let far = |b: &SceneBox| DVec2::distance(b.center_m.truncate(), at.truncate());
        let free = boxes.iter().zip(&mut besides).filter(|(b, beside)| {
            beside.found.is_none()
                && DetectionGroup::from_class(b.class) == Some(detection.group)
                && far(b) < NEAR_M
        });
        match free.min_by(|a, b| far(a.0).total_cmp(&far(b.0))) {
            Some((_, beside)) => beside.found = Some(i),
            None => ghosts.push(i),
        }
    }
    Against {
        boxes: besides,
        ghosts,
    }
}

/// Returns of its class in or beside the footprint of a box.
pub fn returns_on(b: &SceneBox, sweep: &LidarSweep) -> usize {
    let reach = b.size_m.truncate() / 2.0 + MARGIN_M;
    let on = |at: [f32; 3]| {
        let local = b.to_local(at.map(f64::from).into());
        local.truncate().abs().cmple(reach).all()
    };
    let points = sweep.points.iter();
    points
        .filter(|p| p.class == b.class && on(p.position_in_ego))
        .count()
}
