//! A camera's picture of a world scenario: cuboids of five kinds that run from dark in front to light behind, with grey
//! edges, and the lines and areas of the map, all darker with distance. Colours and widths are those of version 3 of
//! the public renderer.

use std::f64::consts::FRAC_PI_2;

use glam::DVec3;
use scene::{Pose, SceneBox};

use super::draw::{Corner, MultisamplePicture};
use super::draw_lines::{DOUBLE_M, LONG_DASH_M, beside, dashes, triangles};
use super::ftheta::FTheta;
use super::map::{Marking, ScenarioMap};
use super::{ObjectCategory, category};

/// Farthest distance that is drawn, m; colours go to black up to there.
const FARTHEST_M: f64 = 200.0;
/// Nearest distance that is drawn, m.
const NEAREST_M: f64 = 0.05;
/// Width of the picture that widths of lines are given for, pixels.
const WIDTH_PX: f64 = 1280.0;
/// Widths of the map's lines, and of the edges of cuboids.
const LINE_PX: f64 = 12.0;
const EDGE_PX: f64 = 4.0;

const BOUNDARY: [u8; 3] = [253, 1, 232];
const STOP_LINE: [u8; 3] = [108, 179, 59];
const CROSSING: [u8; 3] = [139, 93, 255];
const WHITE: [u8; 3] = [255, 255, 255];
const YELLOW: [u8; 3] = [255, 255, 0];
const EDGE: [u8; 3] = [200, 200, 200];

/// How much nearer lines are taken to be than they are, so that they lie on cuboids, and how much farther areas are, so that
/// lines of many pixels lie on them.
const LINES_IN_FRONT: f64 = 0.998;
const AREAS_BEHIND: f64 = 1.05;

impl ObjectCategory {
    /// Colours in front and behind.
    fn colors(self) -> [[u8; 3]; 2] {
        match self {
            Self::Car => [[0, 46, 136], [126, 206, 255]],
            Self::Truck => [[204, 55, 0], [255, 192, 64]],
            Self::Pedestrian => [[148, 0, 62], [255, 124, 171]],
            Self::Cyclist => [[0, 80, 66], [102, 208, 198]],
            Self::Others => [[53, 26, 20], [166, 136, 125]],
        }
    }
}

/// The map as lines and areas of one colour each, in the frame of the scenario.
pub(crate) struct ColoredMap {
    lines: Vec<([u8; 3], Vec<DVec3>)>,
    areas: Vec<[DVec3; 3]>,
}

impl ColoredMap {
    /// The lines and areas of a map.
    pub(crate) fn from_map(map: &ScenarioMap) -> Self {
        let mut lines = Vec::new();
        for (marking, line) in &map.lines {
            match marking {
                Marking::Divider => {
                    lines.extend([DOUBLE_M, -DOUBLE_M].map(|offset_m| (YELLOW, beside(line, offset_m))));
                }
                Marking::LaneDivider => {
                    lines.extend(dashes(line, LONG_DASH_M).into_iter().map(|dash| (WHITE, dash)));
                }
            }
        }
        lines.extend(map.boundaries.iter().map(|line| (BOUNDARY, line.clone())));
        lines.extend(map.stop_lines.iter().map(|line| (STOP_LINE, line.clone())));
        Self {
            lines,
            areas: map
                .crossings
                .iter()
                .flat_map(|outline| triangles(outline))
                .collect(),
        }
    }
}

/// A camera at a moment, and the picture that it takes.
pub(crate) struct Shot<'a> {
    pub(crate) canvas: &'a mut MultisamplePicture,
    pub(crate) model: &'a FTheta,
    /// Where the camera is (optical axes) in the frame of the scenario.
    pub(crate) scenario_from_camera: Pose,
}

impl Shot<'_> {
    /// Draws all that is seen.
    pub(crate) fn draw(&mut self, painted: &ColoredMap, boxes: &[SceneBox]) {
        self.canvas.begin(self.model.width, self.model.height);
        let camera_from_scenario = self.scenario_from_camera.inverse();
        let eye = Eye {
            model: self.model,
            at_m: self.scenario_from_camera.translation_m,
            camera_from_scenario,
            line_scale: f64::from(self.model.width) / WIDTH_PX,
        };
        for triangle in &painted.areas {
            eye.area(self.canvas, triangle, CROSSING, 0);
        }
        for (color, line) in &painted.lines {
            for pair in line.windows(2) {
                eye.line(self.canvas, [pair[0], pair[1]], *color, LINE_PX);
            }
        }
        for b in boxes {
            eye.cuboid(self.canvas, b);
        }
    }
}

/// Projects into one picture.
struct Eye<'a> {
    model: &'a FTheta,
    at_m: DVec3,
    camera_from_scenario: Pose,
    line_scale: f64,
}

impl Eye<'_> {
    /// Place of a point in the picture, and its depth along the optical axis, m; `None` if it is not drawn.
    fn corner(&self, p: DVec3, color: DVec3) -> Option<(Corner, f64)> {
        let local = self.camera_from_scenario.apply(p);
        let distance_m = local.length();
        // Written so that NaN fails too.
        if !(distance_m > NEAREST_M && local.z < FARTHEST_M) {
            return None;
        }
        let shade = (1.0 - local.z / FARTHEST_M).clamp(0.0, 1.0);
        let corner = Corner {
            at: self.model.project(local)?,
            distance_m,
            color: color * shade,
        };
        Some((corner, local.z))
    }

    /// Longest part of a line at a distance, m, for which no bend of the lens is missed.
    fn step_m(distance_m: f64, longest_m: f64) -> f64 {
        (0.06 * distance_m).clamp(0.04, longest_m)
    }

    fn line(&self, canvas: &mut MultisamplePicture, ends: [DVec3; 2], color: [u8; 3], width_px: f64) {
        let color = DVec3::from_array(color.map(f64::from));
        let [a, b] = ends;
        let length_m = a.distance(b);
        let along = ((self.at_m - a).dot(b - a) / length_m.powi(2).max(1e-12)).clamp(0.0, 1.0);
        let nearest_m = a.lerp(b, along).distance(self.at_m);
        if nearest_m.is_nan() || nearest_m > 2.0 * FARTHEST_M {
            return;
        }
        let parts = (length_m / Self::step_m(nearest_m, 1.0)).ceil().clamp(1.0, 400.0) as usize;
        let at = |i: usize| self.corner(a.lerp(b, i as f64 / parts as f64), color);
        let mut last = at(0);
        for i in 1..=parts {
            let next = at(i);
            if let (Some((from, near)), Some((to, far))) = (last, next) {
                let shrink = (1.0 - (near + far) / 2.0 / FARTHEST_M).clamp(0.0, 1.0);
                let in_front = |c: Corner| Corner {
                    distance_m: c.distance_m * LINES_IN_FRONT,
                    ..c
                };
                let width = width_px * self.line_scale * shrink;
                canvas.line(&[in_front(from), in_front(to)], width);
            }
            last = next;
        }
    }

    /// A triangle on the ground, parted until its parts are small.
    fn area(&self, canvas: &mut MultisamplePicture, [a, b, c]: &[DVec3; 3], color: [u8; 3], depth: usize) {
        const DEEPEST: usize = 16;
        let sides = [(*a, *b, *c), (*b, *c, *a), (*c, *a, *b)];
        let longest = sides
            .into_iter()
            .max_by(|x, y| x.0.distance(x.1).total_cmp(&y.0.distance(y.1)));
        let Some((p, q, r)) = longest else { return };
        let long_m = p.distance(q);
        let distance_m = ((*a + *b + *c) / 3.0).distance(self.at_m) - long_m;
        if long_m > Self::step_m(distance_m.max(0.0), 2.0) && depth < DEEPEST {
            let middle = (p + q) / 2.0;
            self.area(canvas, &[p, middle, r], color, depth + 1);
            self.area(canvas, &[middle, q, r], color, depth + 1);
            return;
        }
        let color = DVec3::from_array(color.map(f64::from));
        let corner = |p: &DVec3| {
            let (corner, _) = self.corner(*p, color)?;
            let distance_m = corner.distance_m * AREAS_BEHIND;
            Some(Corner { distance_m, ..corner })
        };
        if let (Some(a), Some(b), Some(c)) = (corner(a), corner(b), corner(c)) {
            canvas.triangle(&[a, b, c]);
        }
    }

    fn cuboid(&self, canvas: &mut MultisamplePicture, b: &SceneBox) {
        let half = b.size_m / 2.0;
        let eye = b.to_local(self.at_m);
        let nearest_m = (eye - eye.clamp(-half, half)).length();
        let local = self.camera_from_scenario.apply(b.center_m);
        let radius = (half.length() / local.length().max(1e-9)).min(1.0).asin();
        let is_behind = radius < FRAC_PI_2 && local.angle_between(DVec3::Z) - radius > self.widest_rad();
        // A camera in a box does not see it. Written so that NaN fails too.
        if !(nearest_m > NEAREST_M && nearest_m < 2.0 * FARTHEST_M) || is_behind {
            return;
        }
        let [front, back] = category(b.class)
            .1
            .colors()
            .map(|c| DVec3::from_array(c.map(f64::from)));
        let step_m = Self::step_m(nearest_m, 1.0);
        for axis in 0..3 {
            for side in [-1.0, 1.0] {
                // Faces that look away are hidden by the others.
                if eye[axis] * side > half[axis] {
                    let color = |x: f64| back.lerp(front, (x / b.size_m.x + 0.5).clamp(0.0, 1.0));
                    self.face(canvas, b, axis, side, step_m, &color);
                }
            }
        }
        for axis in 0..3 {
            for (u, v) in [(-1.0, -1.0), (-1.0, 1.0), (1.0, -1.0), (1.0, 1.0)] {
                let end = |along: f64| {
                    let mut p = DVec3::ZERO;
                    (p[axis], p[(axis + 1) % 3], p[(axis + 2) % 3]) = (along, u, v);
                    b.to_ego(p * half)
                };
                self.line(canvas, [end(-1.0), end(1.0)], EDGE, EDGE_PX);
            }
        }
    }

    /// A face of a box, parted so that its parts are small.
    fn face(
        &self,
        canvas: &mut MultisamplePicture,
        b: &SceneBox,
        axis: usize,
        side: f64,
        step_m: f64,
        color: &dyn Fn(f64) -> DVec3,
    ) {
        let [u, v] = [(axis + 1) % 3, (axis + 2) % 3];
        let parts = [u, v].map(|axis| (b.size_m[axis] / step_m).ceil().clamp(1.0, 128.0) as usize);
        let corner = |i: usize, j: usize| {
            let mut p = DVec3::ZERO;
            p[axis] = side / 2.0;
            p[u] = i as f64 / parts[0] as f64 - 0.5;
            p[v] = j as f64 / parts[1] as f64 - 0.5;
            let p = p * b.size_m;
            self.corner(b.to_ego(p), color(p.x)).map(|(corner, _)| corner)
        };
        for i in 0..parts[0] {
            let mut last = [corner(i, 0), corner(i + 1, 0)];
            for j in 1..=parts[1] {
                let next = [corner(i, j), corner(i + 1, j)];
                if let ([Some(a), Some(b)], [Some(c), Some(d)]) = (last, next) {
                    canvas.triangle(&[a, b, c]);
                    canvas.triangle(&[b, d, c]);
                }
                last = next;
            }
        }
    }

    /// Angle from the optical axis beyond which nothing is drawn.
    fn widest_rad(&self) -> f64 {
        self.model.widest_rad()
    }
}
