//! A drag that moves, turns or scales boxes: the edits of a pointer move, a locked axis, typed digits and snapping.

use glam::{DVec2, DVec3};

use numeric::decimal::decimal;
use scene::{Frame, SceneBox};

use super::Edit;
use super::arrange::{LANE_REACH_M, Pivot, middle_m, standing, turned, wrapped_deg};
use super::lanes::nearest_lane;

/// Part of the boxes that a drag changes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum TransformKind {
    /// The place.
    #[default]
    Move,
    /// The heading.
    Turn,
    /// The size.
    Scale,
}

/// A direction that a drag keeps to.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Axis {
    /// Forward.
    X,
    /// Left.
    Y,
    /// Up.
    Z,
}

impl Axis {
    /// All three.
    pub const ALL: [Axis; 3] = [Axis::X, Axis::Y, Axis::Z];

    /// Its unit vector in its own axes.
    pub fn unit(self) -> DVec3 {
        [DVec3::X, DVec3::Y, DVec3::Z][self as usize]
    }
}

/// Frame whose axes are used.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Orientation {
    /// Axes of the ego frame.
    #[default]
    World,
    /// Axes of the box that was chosen last.
    Local,
}

/// Snaps of a move.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Snap {
    /// Multiples of this, m; degrees are multiples of 15 then, factors of 0.1. `None` means free.
    pub grid_m: Option<f64>,
    /// Lane centre and heading, within reach.
    pub lane: bool,
    /// The ground plane z = 0.
    pub ground: bool,
}

/// How far from a lane a move is caught by it, m.
const CATCH_M: f64 = 2.0;

/// A drag in progress. Every frame starts over from the boxes as they were.
#[derive(Clone, Debug, PartialEq)]
pub struct Transform {
    /// Part of the boxes that it changes.
    pub kind: TransformKind,
    /// The boxes as they were when the drag began; a box that was pressed comes first.
    pub start: Vec<SceneBox>,
    /// Axis that it keeps to.
    pub axis: Option<Axis>,
    /// Frame of that axis.
    pub orientation: Orientation,
    /// Point about which several boxes turn.
    pub pivot: Pivot,
    /// Typed text: metres, degrees or a factor.
    pub typed: String,
}

/// How far the pointer went.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pull {
    /// In the ego frame, m; for moves.
    pub delta_m: DVec3,
    /// Counter-clockwise, degrees; for turns.
    pub turn_deg: f64,
    /// 1 leaves the size; for scaling.
    pub factor: f64,
}

impl Default for Pull {
    fn default() -> Self {
        Self {
            delta_m: DVec3::ZERO,
            turn_deg: 0.0,
            factor: 1.0,
        }
    }
}

impl Transform {
    /// Takes a character of a number, as far as it still is one: digits, one point, a sign in front.
    pub fn type_char(&mut self, c: char) {
        let takes = match c {
            '0'..='9' => self.typed.len() < 9,
            '.' => !self.typed.contains('.'),
            '-' => {
                // A second one takes the first back.
                match self.typed.strip_prefix('-') {
                    Some(rest) => self.typed = rest.to_owned(),
                    None => self.typed.insert(0, '-'),
                }
                return;
            }
            _ => false,
        };
        if takes {
            self.typed.push(c);
        }
    }

    /// The number typed so far, if it is one.
    pub fn typed_value(&self) -> Option<f64> {
        self.typed.parse::<f64>().ok().filter(|v| v.is_finite())
    }

    /// Keeps to an axis, or to none if it does already.
    pub fn toggle_axis(&mut self, axis: Axis) {
        self.axis = (self.axis != Some(axis)).then_some(axis);
    }

    /// Unit vector of an axis in the ego frame.
    pub fn axis_in_ego(&self, axis: Axis) -> DVec3 {
        let local = axis.unit();
        match (self.orientation, self.start.first()) {
            (Orientation::Local, Some(b)) => {
                let h = b.heading();
                DVec3::new(
                    local.x * h.x - local.y * h.y,
                    local.x * h.y + local.y * h.x,
                    local.z,
                )
            }
            _ => local,
        }
    }

    /// The edits that the drag asks for so far.
    pub fn edits(&self, frame: &Frame, pull: &Pull, snap: &Snap) -> Vec<Edit> {
        match self.kind {
            TransformKind::Move => self.moved(frame, pull.delta_m, snap),
            TransformKind::Turn => {
                let free = match snap.grid_m {
                    Some(_) => (pull.turn_deg / 15.0).round() * 15.0,
                    None => pull.turn_deg,
                };
                turned(&self.start, self.typed_value().unwrap_or(free), self.pivot)
            }
            TransformKind::Scale => self.scaled(pull.factor, snap),
        }
    }

    /// The shift before lanes and ground have their say, m.
    fn delta_m(&self, free_m: DVec3, snap: &Snap) -> DVec3 {
        let axis = self.axis.map(|a| self.axis_in_ego(a));
        if let Some(typed_m) = self.typed_value() {
            let direction = axis.or(free_m.try_normalize()).unwrap_or(DVec3::X);
            return direction * typed_m;
        }
        let kept_m = axis.map_or(free_m, |a| a * free_m.dot(a));
        let (Some(step_m), Some(first)) = (snap.grid_m.filter(|s| *s > 0.0), self.start.first()) else {
            return kept_m;
        };
        match axis {
            Some(a) => a * ((kept_m.dot(a) / step_m).round() * step_m),
            // The first box comes to lie on the grid; an unmoved height stays.
            None => {
                let to_m = ((first.center_m + kept_m) / step_m).round() * step_m - first.center_m;
                DVec3::new(to_m.x, to_m.y, if kept_m.z == 0.0 { 0.0 } else { to_m.z })
            }
        }
    }

    fn moved(&self, frame: &Frame, free_m: DVec3, snap: &Snap) -> Vec<Edit> {
        let delta_m = self.delta_m(free_m, snap);
        let edit = |b: &SceneBox| {
            let mut center_m = b.center_m + delta_m;
            let mut yaw_deg = None;
            let caught = (snap.lane && self.typed.is_empty() && self.axis.is_none())
                .then(|| nearest_lane(&frame.layout, center_m.truncate(), CATCH_M.min(LANE_REACH_M)))
                .flatten();
            if let Some(lane) = caught {
                center_m = lane.at_m.extend(center_m.z);
                yaw_deg = Some(wrapped_deg(lane.yaw_rad.to_degrees()));
            }
            if self.axis != Some(Axis::Z) {
                // It keeps its height above the ground.
                let ground_m = |p: DVec3| frame.layout.relief.height_m(p.truncate());
                center_m.z += ground_m(center_m) - ground_m(b.center_m);
            }
            if snap.ground && self.axis != Some(Axis::Z) {
                center_m = standing(frame, b, center_m.truncate());
            }
            Edit::MoveBox {
                id: b.id,
                center_m: Some(center_m),
                yaw_deg,
                size_m: None,
            }
        };
        self.start.iter().map(edit).collect()
    }

    /// Sizes scaled about the middle of each bottom, so that standing boxes keep standing.
    fn scaled(&self, factor: f64, snap: &Snap) -> Vec<Edit> {
        const SMALLEST_M: f64 = 0.1;
        let free = match snap.grid_m {
            Some(_) => (factor * 10.0).round() / 10.0,
            None => factor,
        };
        let factor = self.typed_value().unwrap_or(free);
        if !(factor.is_finite() && factor > 0.0) {
            return Vec::new();
        }
        let by = match self.axis {
            None => DVec3::splat(factor),
            Some(axis) => DVec3::ONE + axis.unit() * (factor - 1.0),
        };
        let edit = |b: &SceneBox| {
            let size_m = (b.size_m * by).clamp(DVec3::splat(SMALLEST_M), DVec3::splat(SceneBox::LIMIT_M));
            let lift_m = (size_m.z - b.size_m.z) / 2.0;
            Edit::MoveBox {
                id: b.id,
                center_m: Some(b.center_m + DVec3::Z * lift_m),
                yaw_deg: None,
                size_m: Some(size_m),
            }
        };
        self.start.iter().map(edit).collect()
    }

    /// Text about the drag for the user: `x  1.25 m`.
    pub fn text(&self, pull: &Pull, snap: &Snap) -> String {
        let axis = match self.axis {
            Some(Axis::X) => "x  ",
            Some(Axis::Y) => "y  ",
            Some(Axis::Z) => "z  ",
            None => "",
        };
        if !self.typed.is_empty() {
            let unit = ["m", "°", "×"][self.kind as usize];
            return format!("{axis}{} {unit}", self.typed);
        }
        match self.kind {
            TransformKind::Move => {
                let d = self.delta_m(pull.delta_m, snap);
                let [x, y, z] = d.to_array().map(|v| decimal(v, 2));
                format!("{axis}{:.2} m  ({x}, {y}, {z})", d.length())
            }
            TransformKind::Turn => format!("{}°", decimal(wrapped_deg(pull.turn_deg), 1)),
            TransformKind::Scale => format!("{axis}× {:.2}", pull.factor),
        }
    }

    /// The middle of the boxes as they were, m.
    pub fn middle_m(&self) -> DVec3 {
        middle_m(&self.start).unwrap_or(DVec3::ZERO)
    }

    /// The angle from one point of the ground to another about the middle, degrees, -180 to 180.
    pub fn turn_deg(&self, from_m: DVec2, to_m: DVec2) -> f64 {
        let middle_m = self.middle_m().truncate();
        let angle = (from_m - middle_m).angle_to(to_m - middle_m);
        if angle.is_finite() {
            angle.to_degrees()
        } else {
            0.0
        }
    }
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeMap;

    use super::*;
    use scene::{BevLayout, BoxId, Class, Polyline, PolylineKind, VoxelGrid};

    fn start(kind: TransformKind) -> Transform {
        let car = |id, x, yaw_rad| SceneBox {
            id: BoxId(id),
            class: Class::Car,
            center_m: DVec3::new(x, 2.03, 1.85),
            size_m: DVec3::new(4.0, 2.0, 1.7),
            yaw_rad,
            velocity_mps: DVec2::ZERO,
            label: Default::default(),
        };
        Transform {
            kind,
            start: vec![car(1, 0.07, std::f64::consts::FRAC_PI_2), car(2, 6.0, 0.0)],
            axis: None,
            orientation: Orientation::World,
            pivot: Pivot::Own,
            typed: String::new(),
        }
    }

    fn frame() -> Frame {
        let lane = Polyline {
            kind: PolylineKind::LaneCenter,
            points_m: vec![DVec2::new(-40.0, 3.0), DVec2::new(40.0, 3.0)],
        };
        let layout = BevLayout::from_cells(vec![0; 40_000], vec![lane]).expect("the right size");
        Frame::new(layout, BTreeMap::new(), VoxelGrid::new())
    }

    fn first(edits: &[Edit]) -> (DVec3, Option<f64>, Option<DVec3>) {
        match edits[0] {
            Edit::MoveBox {
                center_m,
                yaw_deg,
                size_m,
                ..
            } => (center_m.unwrap_or(DVec3::NAN), yaw_deg, size_m),
            _ => panic!("a move"),
        }
    }

    #[test]
    fn axes_digits_and_grids_decide_a_move() {
        let pull = Pull {
            delta_m: DVec3::new(3.0, 1.0, 0.0),
            ..Pull::default()
        };
        let at = |t: &Transform, snap: &Snap| first(&t.edits(&frame(), &pull, snap)).0;
        let free = Snap::default();
        let mut t = start(TransformKind::Move);
        assert_eq!(t.edits(&frame(), &pull, &free).len(), 2);
        assert!(at(&t, &free).distance(DVec3::new(3.07, 3.03, 1.85)) < 1e-9);
        let grid = Snap {
            grid_m: Some(0.4),
            ..free
        };
        assert!(at(&t, &grid).distance(DVec3::new(3.2, 3.2, 1.85)) < 1e-9);
        t.toggle_axis(Axis::X);
        assert!(at(&t, &free).distance(DVec3::new(3.07, 2.03, 1.85)) < 1e-9);
        // The first box looks along ego y: its own x axis is that.
        t.orientation = Orientation::Local;
        assert!(at(&t, &free).distance(DVec3::new(0.07, 3.03, 1.85)) < 1e-9);
        "-2x..5-".chars().for_each(|c| t.type_char(c));
        assert_eq!(t.typed, "2.5");
        assert!(at(&t, &grid).distance(DVec3::new(0.07, 4.53, 1.85)) < 1e-9);
        t.toggle_axis(Axis::X);
        assert_eq!(t.axis, None);
        t.typed = "-".into();
        assert_eq!(t.typed_value(), None);
    }

    #[test]
    fn lanes_and_the_ground_catch_a_move() {
        let pull = Pull::default();
        let both = Snap {
            grid_m: None,
            lane: true,
            ground: true,
        };
        let mut t = start(TransformKind::Move);
        let (at, yaw, _) = first(&t.edits(&frame(), &pull, &both));
        assert!(
            at.distance(DVec3::new(0.07, 3.0, 0.85)) < 1e-9 && yaw == Some(0.0),
            "{at}"
        );
        t.axis = Some(Axis::Z);
        let (at, yaw, _) = first(&t.edits(&frame(), &pull, &both));
        assert!(
            at.distance(DVec3::new(0.07, 2.03, 1.85)) < 1e-9 && yaw.is_none(),
            "{at}"
        );
    }

    #[test]
    fn turns_and_sizes() {
        let pull = Pull {
            turn_deg: 40.0,
            factor: 1.52,
            ..Pull::default()
        };
        let grid = Snap {
            grid_m: Some(1.0),
            ..Snap::default()
        };
        let t = start(TransformKind::Turn);
        let yaw = first(&t.edits(&frame(), &pull, &grid)).1.expect("turned");
        assert!((yaw - 135.0).abs() < 1e-9, "{yaw}");
        let quarter = t.turn_deg(
            t.middle_m().truncate() + DVec2::X,
            t.middle_m().truncate() + DVec2::Y,
        );
        assert!((quarter - 90.0).abs() < 1e-9);
        assert_eq!(t.turn_deg(t.middle_m().truncate(), DVec2::X), 0.0);
        let mut t = start(TransformKind::Scale);
        t.axis = Some(Axis::Z);
        let (center, _, size) = first(&t.edits(&frame(), &pull, &grid));
        assert!(size.expect("scaled").distance(DVec3::new(4.0, 2.0, 2.55)) < 1e-9);
        assert!(
            (center.z - size.expect("scaled").z / 2.0 - 1.0).abs() < 1e-9,
            "its bottom stays"
        );
        t.typed = "0".into();
        assert!(t.edits(&frame(), &pull, &grid).is_empty());
    }
}
