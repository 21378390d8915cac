//! Rows and grids of copies, of boxes and of things beside the road.

use glam::DVec2;

use scene::background::PostKind;
use scene::{BoxId, Form, Frame, Scene, SceneBox};

use super::arrange::{Added, LANE_REACH_M, add, boxes_of, shapes_of};
use super::lanes::{along, nearest_lane};

/// Most copies of one box or thing.
pub const MAX_COPIES: usize = 200;
/// How far a lane may be from a thing beside the road that is to follow it, m.
const BESIDE_REACH_M: f64 = 25.0;

/// Line along which a row of copies runs.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum RowAlong {
    /// The heading of each box; for things that of the ego vehicle.
    #[default]
    Heading,
    /// The nearest lane; the heading where there is none.
    Lane,
    /// To the left of the heading.
    Side,
}

/// A row of copies, or several beside each other.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CopyRows {
    /// Copies of each box in the first row, the original not counted.
    pub copies: usize,
    /// From one to the next, centre to centre, m; negative goes backward.
    pub spacing_m: f64,
    /// Direction of the row.
    pub along: RowAlong,
    /// Rows, the first one counted.
    pub rows: usize,
    /// From one row to the next, m: to the left of the way that the first runs, negative to the right.
    pub apart_m: f64,
}

impl Default for CopyRows {
    fn default() -> Self {
        Self {
            copies: 4,
            spacing_m: 7.0,
            along: RowAlong::Heading,
            rows: 1,
            apart_m: 4.0,
        }
    }
}

impl CopyRows {
    /// Copies of each box or thing that are asked for, before those beside the map are left out.
    pub fn asked(&self) -> usize {
        self.places().count()
    }

    /// Ways along and across the row to each copy, m.
    fn places(&self) -> impl Iterator<Item = DVec2> + '_ {
        let sound = self.spacing_m.is_finite() && self.apart_m.is_finite();
        let [copies, rows] = match sound {
            true => [self.copies, self.rows].map(|n| n.min(MAX_COPIES)),
            false => [0, 1],
        };
        let across = (0..rows.max(1)).flat_map(move |row| (0..=copies).map(move |i| [i, row]));
        across
            .filter(|at| *at != [0, 0])
            .take(MAX_COPIES)
            .map(|[i, row]| DVec2::new(self.spacing_m * i as f64, self.apart_m * row as f64))
    }
}

/// Rows of copies of each box; at most [`MAX_COPIES`] each. A copy along a lane keeps its distance to the
/// lane's middle and turns with it.
pub fn row(frame: &Frame, ids: &[BoxId], row: &CopyRows) -> Added {
    add(frame, row_boxes(frame, ids, row), &shapes_of(frame, ids))
}

/// The copies of boxes, not yet named; those beside the map are left out.
pub fn row_boxes(frame: &Frame, ids: &[BoxId], row: &CopyRows) -> Vec<SceneBox> {
    let mut copies = Vec::new();
    for b in boxes_of(frame, ids) {
        let way = RowPath::from_frame(frame, row, b.center_m.truncate(), b.yaw_rad, LANE_REACH_M);
        copies.extend(row.places().map(|by_m| {
            let (at_m, turn_rad) = way.to(frame, b.center_m.truncate(), by_m);
            SceneBox {
                center_m: at_m.extend(b.center_m.z),
                yaw_rad: b.yaw_rad + turn_rad,
                velocity_mps: DVec2::from_angle(turn_rad).rotate(b.velocity_mps),
                ..b
            }
        }));
    }
    copies.retain(|b| b.problem().is_none() && on_map(frame, b.center_m.truncate()));
    copies
}

/// The copies of things (world frame); those whose middle is beside the map are left out.
pub fn row_forms(scene: &Scene, forms: &[&Form], row: &CopyRows) -> Vec<Form> {
    let frame = scene.frame();
    let world_from_ego = frame.world_from_ego;
    let mut copies = Vec::new();
    for form in forms.iter().map(|f| f.in_frame(&world_from_ego.inverse())) {
        let middle_m = form.middle_m();
        let way = RowPath::from_frame(frame, row, middle_m, 0.0, BESIDE_REACH_M);
        for by_m in row.places() {
            let (at_m, turn_rad) = way.to(frame, middle_m, by_m);
            let turn = DVec2::from_angle(turn_rad);
            let mut copy = form.clone();
            copy.map_points(|p| at_m + turn.rotate(p - middle_m), turn_rad);
            if on_map(frame, at_m) {
                copies.push(copy.in_frame(&world_from_ego));
            }
        }
    }
    copies
}

fn on_map(frame: &Frame, p_m: DVec2) -> bool {
    frame.extent().column_at(p_m.x, p_m.y).is_some()
}

/// The way that a row runs, from one box or thing on.
enum RowPath {
    /// Straight, in this direction.
    Straight(DVec2),
    /// Along a lane, from this point.
    Lane(super::lanes::CentrelinePoint),
}

impl RowPath {
    fn from_frame(frame: &Frame, row: &CopyRows, at_m: DVec2, yaw_rad: f64, reach_m: f64) -> Self {
        let heading = DVec2::from_angle(yaw_rad);
        let lane = || nearest_lane(&frame.layout, at_m, reach_m);
        match row.along {
            RowAlong::Heading => Self::Straight(heading),
            RowAlong::Side => Self::Straight(heading.perp()),
            RowAlong::Lane => lane().map_or(Self::Straight(heading), Self::Lane),
        }
    }

    /// Place of a copy of an object at `from_m`, and the angle by which the copy is turned, rad.
    fn to(&self, frame: &Frame, from_m: DVec2, by_m: DVec2) -> (DVec2, f64) {
        match self {
            Self::Straight(ahead) => (from_m + *ahead * by_m.x + ahead.perp() * by_m.y, 0.0),
            Self::Lane(start) => {
                let (at_m, yaw_rad) = along(&frame.layout, start, by_m.x);
                let turn_rad = yaw_rad - start.yaw_rad;
                let left = DVec2::from_angle(start.yaw_rad).perp();
                let aside_m = from_m - start.at_m + left * by_m.y;
                (at_m + DVec2::from_angle(turn_rad).rotate(aside_m), turn_rad)
            }
        }
    }
}

/// A thing (world frame) mirrored about the ego x axis. With `keep_direction` signs face the traffic of their new side.
pub fn mirrored_form(frame: &Frame, form: &Form, keep_direction: bool) -> Form {
    let mut out = form.in_frame(&frame.world_from_ego.inverse());
    out.map_points(|p| DVec2::new(p.x, -p.y), 0.0);
    match &mut out {
        Form::Post(post) => {
            let faces_traffic = matches!(post.kind, PostKind::Sign | PostKind::TrafficLight);
            let half_turn = f64::from(u8::from(keep_direction && faces_traffic)) * std::f64::consts::PI;
            post.yaw_rad = half_turn - post.yaw_rad;
        }
        // The points of an outline go around it the same way as before.
        Form::Building(b) => b.outline_m.reverse(),
        Form::Shrubs(s) => s.outline_m.reverse(),
        Form::Tree(_) | Form::Line(_) | Form::Bridge(_) => {}
    }
    out.in_frame(&frame.world_from_ego)
}

#[cfg(test)]
#[path = "rows_tests.rs"]
mod tests;
