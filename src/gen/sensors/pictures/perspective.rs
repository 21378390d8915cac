//! Perspective maps of boxes and lanes: where each part of the layout lies in a camera's picture, hidden or not, as
//! image models take it for a condition (X-Scene 6.6, MagicDrive).

use glam::{DVec2, DVec3};

use crate::raycast::rays::CameraRays;
use scene::{BevLayer, BevLayout, Camera, Class, PerspectiveMap, PolylineKind, Pose, Relief, SceneBox};

/// Width of a painted line on the ground, m.
const LINE_M: f64 = 0.2;
/// Distance nearer than which nothing is drawn, m along the optical axis.
const NEAR_M: f64 = 0.1;
/// Distance beyond which ground is left out, m along the optical axis.
const FAR_M: f64 = 120.0;
/// Longest piece of a line that is drawn as one quad, m: clipping a short piece keeps its width.
const PIECE_M: f64 = 4.0;
/// How often a piece is halved along both sides where a lens bends it.
const SPLITS: u32 = 5;
/// Largest bend of a side that counts as straight: distance of its middle from the straight line, px.
const STRAIGHT_PX: f64 = 0.3;
/// Bit of the drivable area and of the first object class.
const DRIVABLE: u32 = 3;
const FIRST_OBJECT: u32 = 4;

/// Channel of a line.
fn line_channel(kind: PolylineKind) -> Option<u32> {
    match kind {
        PolylineKind::RoadDivider => Some(0),
        PolylineKind::LaneDivider => Some(1),
        PolylineKind::PedCrossing => Some(2),
        PolylineKind::LaneCenter | PolylineKind::StopLine | PolylineKind::SpeedLimit { .. } => None,
    }
}

/// Corners of a face, in the order of [`SceneBox`]'s local axes; two faces each of x, y, z.
const FACES: [[usize; 4]; 6] = [
    [0, 1, 3, 2],
    [4, 5, 7, 6],
    [0, 1, 5, 4],
    [2, 3, 7, 6],
    [0, 2, 6, 4],
    [1, 3, 7, 5],
];
/// Pairs of corners of a box; bits of a corner are its signs along x, y and z.
pub const EDGES: [[usize; 2]; 12] = [
    [0, 1],
    [2, 3],
    [4, 5],
    [6, 7],
    [0, 2],
    [1, 3],
    [4, 6],
    [5, 7],
    [0, 4],
    [1, 5],
    [2, 6],
    [3, 7],
];

/// The maps of one camera at `width` x `height` pixels (0 gives an empty map). The ground lies at the height of the layout's relief.
pub fn render<'a>(
    layout: &BevLayout,
    boxes: impl Iterator<Item = &'a SceneBox>,
    camera: &Camera,
    width: u32,
    height: u32,
) -> PerspectiveMap {
    let mut canvas = PerspectiveRaster::new(camera, width, height);
    canvas.ground(layout);
    for line in layout.polylines.iter() {
        if let Some(channel) = line_channel(line.kind) {
            let closed = line.kind == PolylineKind::PedCrossing;
            canvas.line(&line.points_m, closed, &layout.relief, channel);
        }
    }
    // Far boxes first, so that edges of near ones end up on top.
    let mut boxes: Vec<(f64, &SceneBox)> = boxes.map(|b| (canvas.in_camera(b.center_m).z, b)).collect();
    boxes.sort_by(|a, b| b.0.total_cmp(&a.0).then(a.1.id.cmp(&b.1.id)));
    for (_, b) in boxes {
        canvas.velocity = b.velocity_mps.extend(0.0);
        canvas.scene_box(b);
    }
    PerspectiveMap {
        camera: camera.name.clone(),
        width: width as usize,
        height: height as usize,
        channels: canvas.channels,
        edges: canvas.edges,
    }
}

struct PerspectiveRaster {
    camera: Camera,
    camera_from_ego: Pose,
    rays: CameraRays,
    /// Velocity of the drawn thing, for shutters that roll, m/s.
    velocity: DVec3,
    width: usize,
    height: usize,
    channels: Vec<u16>,
    edges: Vec<u8>,
}

impl PerspectiveRaster {
    fn new(camera: &Camera, width: u32, height: u32) -> Self {
        let camera = camera.resized(width.max(1), height.max(1));
        let n = width as usize * height as usize;
        Self {
            camera_from_ego: camera.ego_from_camera().inverse(),
            rays: CameraRays::new(&camera, width, height),
            velocity: DVec3::ZERO,
            camera,
            width: width as usize,
            height: height as usize,
            channels: vec![0; n],
            edges: vec![0; n],
        }
    }

    fn in_camera(&self, p_in_ego: DVec3) -> DVec3 {
        self.camera_from_ego.apply(p_in_ego)
    }

    fn pixel(&self, p: DVec3) -> DVec2 {
        let [fx, fy] = self.camera.focal_px;
        let [cx, cy] = self.camera.center_px;
        DVec2::new(fx * p.x / p.z + cx, fy * p.y / p.z + cy)
    }

    /// Looks up the layout where each pixel's ray meets the ground.
    fn ground(&mut self, layout: &BevLayout) {
        let extent = layout.extent();
        for i in 0..self.channels.len() {
            let (u, v) = ((i % self.width) as f64 + 0.5, (i / self.width) as f64 + 0.5);
            let ray = self.rays.at(u, v);
            if ray.direction == DVec3::ZERO {
                continue;
            }
            let met = layout.relief.met_by(ray.origin, ray.direction, FAR_M);
            let Some(depth_m) = met.filter(|depth_m| *depth_m > NEAR_M) else {
                continue;
            };
            let p = ray.origin + ray.direction * depth_m;
            let Some([x, y]) = extent.column_at(p.x, p.y) else {
                continue;
            };
            let cell = layout.cell(x, y);
            let drivable = BevLayer::DrivableArea.bit() | BevLayer::CarparkArea.bit();
            self.channels[i] |= u16::from(cell & drivable != 0) << DRIVABLE;
            self.channels[i] |= u16::from(cell & BevLayer::PedCrossing.bit() != 0) << 2;
        }
    }

    /// A painted line as quads on the ground.
    fn line(&mut self, points: &[DVec2], closed: bool, relief: &Relief, channel: u32) {
        let n = points.len();
        let count = if closed && n > 2 { n } else { n.saturating_sub(1) };
        for i in 0..count {
            let (a, b) = (points[i], points[(i + 1) % n]);
            let along = b - a;
            let length = along.length();
            if !(length > 1e-9 && length < 1e5) {
                continue;
            }
            let side = along.perp() / length * (LINE_M / 2.0);
            let pieces = (length / PIECE_M).ceil().max(1.0) as usize;
            for piece in 0..pieces {
                let at = |k: usize| a + along * (k as f64 / pieces as f64);
                let (p, q) = (at(piece), at(piece + 1));
                let quad = [p + side, q + side, q - side, p - side].map(|p| p.extend(relief.height_m(p)));
                self.polygon(&quad, channel);
            }
        }
    }

    fn scene_box(&mut self, b: &SceneBox) {
        let Some(class) = Class::OBJECTS.iter().position(|c| *c == b.class) else {
            return;
        };
        let half = b.size_m / 2.0;
        let sign = |bit: usize| if bit == 0 { -1.0 } else { 1.0 };
        let corners: [DVec3; 8] =
            std::array::from_fn(|i| b.to_ego(half * DVec3::new(sign(i & 4), sign(i & 2), sign(i & 1))));
        for face in FACES {
            self.polygon(&face.map(|i| corners[i]), FIRST_OBJECT + class as u32);
        }
        for edge in EDGES {
            self.edge(edge.map(|i| corners[i]), class as u8 + 1);
        }
    }

    /// Sets a channel in the picture of a flat convex polygon of the ego frame.
    fn polygon(&mut self, corners: &[DVec3; 4], channel: u32) {
        if !self.rays.is_plain() {
            return self.bent_quad(*corners, channel, SPLITS);
        }
        let corners: Vec<DVec3> = corners.iter().map(|p| self.in_camera(*p)).collect();
        let outline: Vec<DVec2> = clip_near(&corners).into_iter().map(|p| self.pixel(p)).collect();
        self.fill(&outline, channel);
    }

    /// A quad whose sides a lens bends: in pieces whose sides are straight to a third of a pixel.
    fn bent_quad(&mut self, quad: [DVec3; 4], channel: u32, splits: u32) {
        let [a, b, c, d] = quad;
        let middle = |p: DVec3, q: DVec3| (p + q) / 2.0;
        let sides = [middle(a, b), middle(b, c), middle(c, d), middle(d, a)];
        let at = |p: DVec3| self.rays.seen_at(p, self.velocity);
        let (corners, middles) = (quad.map(at), sides.map(at));
        let bends = |i: usize| match (corners[i], corners[(i + 1) % 4], middles[i]) {
            (Some(p), Some(q), Some(m)) => ((p + q) / 2.0).distance(m) > STRAIGHT_PX,
            (None, None, None) => false,
            _ => true,
        };
        let seen = corners.iter().chain(&middles).filter(|p| p.is_some()).count();
        // A large piece may be seen although no corner is.
        let is_large = quad.iter().any(|p| p.distance(a) > PIECE_M);
        if splits > 0 && ((0..4).any(bends) || is_large) {
            let m = (a + b + c + d) / 4.0;
            let [ab, bc, cd, da] = sides;
            for piece in [[a, ab, m, da], [ab, b, bc, m], [m, bc, c, cd], [da, m, cd, d]] {
                self.bent_quad(piece, channel, splits - 1);
            }
        } else if seen == 8 {
            let outline: Vec<DVec2> = corners.into_iter().flatten().collect();
            self.fill(&outline, channel);
        }
    }

    /// Sets a channel inside a convex outline, px.
    fn fill(&mut self, outline: &[DVec2], channel: u32) {
        if outline.len() < 3 || outline.iter().any(|p| !p.is_finite()) {
            return;
        }
        let top = outline.iter().fold(f64::INFINITY, |m, p| m.min(p.y));
        let bottom = outline.iter().fold(f64::NEG_INFINITY, |m, p| m.max(p.y));
        let rows = self.height as f64;
        for row in
            (top - 0.5).ceil().clamp(0.0, rows) as usize..(bottom + 0.5).ceil().clamp(0.0, rows) as usize
        {
            let y = row as f64 + 0.5;
            let (mut left, mut right) = (f64::INFINITY, f64::NEG_INFINITY);
            for (i, a) in outline.iter().enumerate() {
                let b = outline[(i + 1) % outline.len()];
                if (a.y <= y) != (b.y <= y) {
                    let x = a.x + (b.x - a.x) * ((y - a.y) / (b.y - a.y));
                    (left, right) = (left.min(x), right.max(x));
                }
            }
            let columns = self.width as f64;
            let first = (left - 0.5).ceil().clamp(0.0, columns) as usize;
            let end = ((right - 0.5).floor() + 1.0).clamp(0.0, columns) as usize;
            for pixel in &mut self.channels[row * self.width..][first..end.max(first)] {
                *pixel |= 1 << channel;
            }
        }
    }

    /// Draws a line one pixel wide.
    fn edge(&mut self, ends: [DVec3; 2], value: u8) {
        if !self.rays.is_plain() {
            for line in bent_line(&self.rays, ends, self.velocity) {
                self.stroke(line, value);
            }
            return;
        }
        let ends = clip_near(&ends.map(|p| self.in_camera(p)));
        let [a, b] = match ends[..] {
            [a, b] | [a, b, _] => [self.pixel(a), self.pixel(b)],
            _ => return,
        };
        self.stroke([a, b], value);
    }

    fn stroke(&mut self, [a, b]: [DVec2; 2], value: u8) {
        let Some((a, b)) = clip_to_image(a, b, DVec2::new(self.width as f64, self.height as f64)) else {
            return;
        };
        let steps = (b - a).abs().max_element().ceil().max(1.0);
        for i in 0..=steps as usize {
            let p = a + (b - a) * (i as f64 / steps);
            let (x, y) = (p.x as usize, p.y as usize);
            if x < self.width && y < self.height {
                self.edges[y * self.width + x] = value;
            }
        }
    }
}

/// The picture of a straight line of the frame of the sensors' poses as pieces that are straight to a third of a pixel, px;
/// parts that the lens does not see are left out. `velocity_mps` is that of the line, for shutters that roll.
pub fn bent_line(rays: &CameraRays, ends: [DVec3; 2], velocity_mps: DVec3) -> Vec<[DVec2; 2]> {
    fn part(rays: &CameraRays, [a, b]: [DVec3; 2], velocity: DVec3, splits: u32, out: &mut Vec<[DVec2; 2]>) {
        let m = (a + b) / 2.0;
        let seen = [a, m, b].map(|p| rays.seen_at(p, velocity));
        match seen {
            [Some(p), Some(q), Some(r)] if splits == 0 || ((p + r) / 2.0).distance(q) <= STRAIGHT_PX => {
                out.push([p, r]);
            }
            [None, None, None] if a.distance(b) <= PIECE_M => {}
            _ if splits == 0 => {}
            _ => {
                part(rays, [a, m], velocity, splits - 1, out);
                part(rays, [m, b], velocity, splits - 1, out);
            }
        }
    }
    let mut out = Vec::new();
    if ends.iter().all(|p| p.is_finite()) {
        part(rays, ends, velocity_mps, 2 * SPLITS, &mut out);
    }
    out
}

/// The part of a polygon (or of a line of two points) of the optical frame, m, that lies more than 0.1 m in front of the
/// camera. Of a line: two points in its order, or none.
pub fn clip_near(corners: &[DVec3]) -> Vec<DVec3> {
    let mut out = Vec::with_capacity(corners.len() + 1);
    for (i, a) in corners.iter().enumerate() {
        let b = corners[(i + 1) % corners.len()];
        if a.z > NEAR_M {
            out.push(*a);
        }
        let crosses = (a.z > NEAR_M) != (b.z > NEAR_M);
        // A line's way back is the line itself.
        if crosses && (corners.len() > 2 || i == 0) {
            out.push(*a + (b - *a) * ((NEAR_M - a.z) / (b.z - a.z)));
        }
    }
    out
}

/// The part of a line inside `[0, size]` (Liang and Barsky), so that its length in pixels is bounded.
fn clip_to_image(a: DVec2, b: DVec2, size: DVec2) -> Option<(DVec2, DVec2)> {
    if !a.is_finite() || !b.is_finite() {
        return None;
    }
    let d = b - a;
    let (mut t0, mut t1) = (0.0f64, 1.0f64);
    for axis in 0..2 {
        for (p, q) in [(-d[axis], a[axis]), (d[axis], size[axis] - a[axis])] {
            if p == 0.0 {
                if q < 0.0 {
                    return None;
                }
            } else if p < 0.0 {
                t0 = t0.max(q / p);
            } else {
                t1 = t1.min(q / p);
            }
        }
    }
    (t0 <= t1).then(|| (a + d * t0, a + d * t1))
}

#[cfg(test)]
mod tests {
    use super::*;
    use scene::{BoxId, Polyline, SensorRig};

    fn ahead() -> Camera {
        let mut camera = SensorRig::default().cameras[1].clone();
        camera.rotation_wxyz = [0.5, -0.5, 0.5, -0.5];
        camera.translation_m = [0.0, 0.0, 1.5];
        (camera.width, camera.height) = (320, 180);
        (camera.focal_px, camera.center_px) = ([200.0; 2], [160.0, 90.0]);
        camera
    }

    fn car(x_m: f64) -> SceneBox {
        SceneBox {
            id: BoxId(1),
            class: Class::Car,
            center_m: DVec3::new(x_m, 0.0, 0.75),
            size_m: DVec3::new(4.0, 2.0, 1.5),
            yaw_rad: 0.0,
            velocity_mps: DVec2::ZERO,
            label: Default::default(),
        }
    }

    #[test]
    fn a_box_covers_its_silhouette() {
        let map = render(
            &BevLayout::default(),
            [&car(12.0)].into_iter(),
            &ahead(),
            320,
            180,
        );
        let channel =
            FIRST_OBJECT + Class::OBJECTS.iter().position(|c| *c == Class::Car).expect("car") as u32;
        let covered: Vec<usize> = (0..320 * 180)
            .filter(|&i| map.channels[i] >> channel & 1 == 1)
            .collect();
        // Its near face, 10 m away, spans 2 m by 1.5 m: 40 x 30 pixels below the horizon.
        let xs = covered.iter().map(|i| i % 320);
        assert_eq!((xs.clone().min(), xs.max()), (Some(140), Some(179)));
        let ys = covered.iter().map(|i| i / 320);
        assert_eq!((ys.clone().min(), ys.max()), (Some(90), Some(119)));
        assert_eq!(covered.len(), 40 * 30);
        assert!(map.edges.iter().filter(|e| **e > 0).count() > 120);
    }

    /// On a grade of 10 % a line runs on to where level ground would have ended at the horizon.
    #[test]
    fn lines_and_road_follow_the_relief() {
        let mut layout = BevLayout::default();
        layout.relief = Relief::from_fn(scene::Extent::WINDOW, |p| 0.1 * p.x.max(0.0));
        for (x, y) in (100..200).flat_map(|x| (95..105).map(move |y| (x, y))) {
            layout.set(BevLayer::DrivableArea, x, y, true);
        }
        layout.polylines = vec![Polyline {
            kind: PolylineKind::LaneDivider,
            points_m: vec![DVec2::new(1.0, 0.0), DVec2::new(39.0, 0.0)],
        }]
        .into();
        let map = render(&layout, [].into_iter(), &ahead(), 320, 180);
        let top =
            |bit: u32| (0..180).find(|row| (0..320).any(|x| map.channels[row * 320 + x] >> bit & 1 == 1));
        // At 39 m the ground lies at 3.9 m, 2.4 m above the camera: 12 rows above the horizon, row 90.
        for bit in [1, DRIVABLE] {
            let row = top(bit).expect("seen");
            assert!((76..=79).contains(&row), "bit {bit}: row {row}");
        }
    }

    #[test]
    fn lines_and_road_lie_on_the_ground() {
        let mut layout = BevLayout::default();
        for x in 100..200 {
            for y in 95..105 {
                layout.set(BevLayer::DrivableArea, x, y, true);
            }
        }
        let points_m = vec![DVec2::new(-5.0, 0.0), DVec2::new(39.0, 0.0)];
        layout.polylines = vec![Polyline {
            kind: PolylineKind::LaneDivider,
            points_m,
        }]
        .into();
        let map = render(&layout, [].into_iter(), &ahead(), 320, 180);
        // A pixel 30 rows below the horizon sees the ground at 10 m, where 0.2 m are four pixels.
        let row = &map.channels[119 * 320..120 * 320];
        let line: Vec<usize> = (0..320).filter(|&x| row[x] & 2 != 0).collect();
        assert!(
            (3..=5).contains(&line.len()) && line[0] >= 157 && line[0] <= 159,
            "{line:?}"
        );
        let road = row.iter().filter(|c| *c >> DRIVABLE & 1 == 1).count();
        assert!((78..=82).contains(&road), "{road} pixels of 4 m");
        assert!(
            map.channels[..89 * 320].iter().all(|c| *c == 0),
            "nothing above the horizon"
        );
    }

    #[test]
    fn boxes_around_and_behind_the_camera_and_odd_numbers_do_no_harm() {
        let mut odd = car(f64::NAN);
        let boxes = [car(0.0), car(-12.0), car(1e9)];
        let map = render(&BevLayout::default(), boxes.iter(), &ahead(), 64, 36);
        // The camera stands in the first box, on its roof's height: everything below is that box.
        assert!(map.channels.iter().any(|c| *c != 0));
        let behind = render(&BevLayout::default(), [&car(-12.0)].into_iter(), &ahead(), 64, 36);
        assert!(behind.channels.iter().all(|c| *c == 0) && behind.edges.iter().all(|e| *e == 0));
        odd.yaw_rad = f64::INFINITY;
        let mut camera = ahead();
        camera.translation_m = [f64::NAN, 0.0, 1e300];
        render(&BevLayout::default(), [&odd].into_iter(), &camera, 16, 9);
        assert!(
            render(&BevLayout::default(), [&odd].into_iter(), &ahead(), 0, 9)
                .channels
                .is_empty()
        );
    }
}
