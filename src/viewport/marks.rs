//! Marks that are drawn over the voxels as lines and fills: boxes, frusta, the metre grid, brush cells.

use std::collections::HashSet;

use glam::DVec3;

use super::change::{EgoBounds, PictureChange};
use super::faces::{FaceList, FaceStyle};
use super::lines::LineList;
use super::meshing::NORMALS;
use super::options::drop_m;
use super::track_color::track_color;
use super::{ViewScene, ego};
use scene::{Camera, Extent, Optics, SceneBox, SensorRig};

/// All marks of a picture.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Marks {
    /// Lines that show through the things that hide them.
    pub see_through: LineList,
    /// Other lines.
    pub plain: LineList,
    /// Fills.
    pub faces: FaceList,
}

const SELECTED: [u8; 3] = [255, 255, 255];
const FRUSTUM: [u8; 3] = [122, 196, 255];
/// Side of the square that a soft shadow's blob covers, relative to the vehicle.
const SHADOW_SPREAD: f64 = 1.5;

impl Marks {
    /// The marks of a scene, under its options.
    pub fn of(scene: &ViewScene<'_>) -> Self {
        let mut marks = Self::default();
        let (options, extent) = (scene.options, scene.grid.extent());
        let down = DVec3::Z * drop_m(extent.lattice(), options);
        if options.grid_lines {
            marks.metre_grid(extent);
        }
        if options.ego {
            marks.ego_shadow(scene.rig, down.z);
        }
        if options.frusta {
            for camera in &scene.rig.cameras {
                marks.frustum(camera, down);
            }
        }
        if options.boxes {
            for b in scene.boxes.iter().filter(|b| b.problem().is_none()) {
                let selected = scene.selected.contains(&b.id);
                let lowered = SceneBox {
                    center_m: b.center_m - down,
                    ..**b
                };
                let color = match options.by_track {
                    true => track_color(b.id),
                    false => b.class.color(),
                };
                marks.scene_box(&lowered, color, selected, scene.hovered == Some(b.id));
            }
        }
        for brush in scene.brush {
            marks.cells(extent, brush.voxels, brush.color);
        }
        marks
    }

    /// Lines every 10 m over the map and along its sides, and the axes.
    fn metre_grid(&mut self, extent: Extent) {
        const STEP_M: f64 = 10.0;
        let z = extent.lattice().ground_top_m() + 0.005;
        let (low, high) = (extent.min_m(), extent.max_m());
        let mut places: Vec<f64> = [low.x, low.y, high.x, high.y].to_vec();
        let (first, last) = (low.x.min(low.y) / STEP_M, high.x.max(high.y) / STEP_M);
        places.extend((first.ceil() as i64..=last.floor() as i64).map(|i| i as f64 * STEP_M));
        places.sort_by(f64::total_cmp);
        places.dedup();
        for at in places.into_iter().filter(|at| *at != 0.0) {
            let line = |axis: usize| {
                let side = at == low[axis] || at == high[axis];
                let full = (at / STEP_M).fract() == 0.0;
                let within = side || full && (low[axis]..high[axis]).contains(&at);
                within.then_some([206, 214, 226, if side { 70 } else { 34 }])
            };
            if let Some(grey) = line(1) {
                let ends = [DVec3::new(low.x, at, z), DVec3::new(high.x, at, z)];
                self.plain.add(ends[0], ends[1], grey, 1.0);
            }
            if let Some(grey) = line(0) {
                let ends = [DVec3::new(at, low.y, z), DVec3::new(at, high.y, z)];
                self.plain.add(ends[0], ends[1], grey, 1.0);
            }
        }
        // Axes: x forward red, y left green, stronger ahead and to the left than behind.
        for (axis, [r, g, b]) in [(0, [240, 104, 96]), (1, [120, 200, 110])] {
            if !(low[1 - axis]..=high[1 - axis]).contains(&0.0) {
                continue;
            }
            let at = |v: f64| {
                let mut p = DVec3::new(0.0, 0.0, z);
                p[axis] = v;
                p
            };
            let middle = 0f64.clamp(low[axis], high[axis]);
            if low[axis] < middle {
                self.plain.add(at(middle), at(low[axis]), [r, g, b, 50], 1.0);
            }
            if middle < high[axis] {
                self.plain.add(at(middle), at(high[axis]), [r, g, b, 130], 1.4);
            }
        }
    }

    fn ego_shadow(&mut self, rig: &SensorRig, drop_m: f64) {
        let (size, center) = ego::measures(rig);
        let (l, w) = (size.x / 2.0 * SHADOW_SPREAD, size.y / 2.0 * SHADOW_SPREAD);
        let at = |x: f64, y: f64| {
            let p = DVec3::new(center.x + x, center.y + y, 0.01);
            rig.vehicle.apply(p) - DVec3::Z * drop_m
        };
        self.faces.add(
            [at(l, w), at(-l, w), at(-l, -w), at(l, -w)],
            [8, 10, 14, 170],
            FaceStyle::Blob,
        );
    }

    fn frustum(&mut self, camera: &Camera, down: DVec3) {
        const DEPTH_M: f64 = 2.2;
        let pose = camera.ego_from_camera();
        let [w, h] = [f64::from(camera.width), f64::from(camera.height)];
        let optics = Optics::new(camera);
        let [cx, cy] = camera.center_px;
        let at = |u: f64, v: f64| {
            // The frustum ends nearer to its middle where the lens sees nothing.
            let towards = |share: f64| optics.direction(cx + (u - cx) * share, cy + (v - cy) * share);
            let ways = (0..20).map(|i| towards(1.0 - f64::from(i) / 20.0));
            let way = ways.into_iter().find(|d| *d != DVec3::ZERO).unwrap_or(DVec3::Z);
            pose.apply(way * DEPTH_M) - down
        };
        let apex = pose.translation_m - down;
        let corners = [at(0.0, 0.0), at(w, 0.0), at(w, h), at(0.0, h)];
        let [r, g, b] = FRUSTUM;
        for i in 0..4 {
            self.see_through.add(apex, corners[i], [r, g, b, 120], 1.0);
            self.see_through
                .add(corners[i], corners[(i + 1) % 4], [r, g, b, 230], 1.4);
        }
        // A tick on the upper edge says which way is up.
        let up = at(w / 2.0, -0.22 * h);
        self.see_through
            .path(&[at(0.42 * w, 0.0), up, at(0.58 * w, 0.0)], [r, g, b, 230], 1.2);
        self.faces.add(corners, [r, g, b, 16], FaceStyle::Plain);
    }

    fn scene_box(&mut self, b: &SceneBox, color: [u8; 3], selected: bool, hovered: bool) {
        let [r, g, bl] = lighter(color, if hovered { 0.55 } else { 0.22 });
        let color = if selected {
            [SELECTED[0], SELECTED[1], SELECTED[2], 255]
        } else {
            [r, g, bl, 255]
        };
        let width = match (selected, hovered) {
            (true, _) => 2.8,
            (false, true) => 2.2,
            _ => 1.4,
        };
        let half = b.size_m / 2.0;
        let corner = |sx: f64, sy: f64, sz: f64| b.to_ego(DVec3::new(sx, sy, sz) * half);
        let ring = [(1.0, 1.0), (-1.0, 1.0), (-1.0, -1.0), (1.0, -1.0)];
        let low = ring.map(|(x, y)| corner(x, y, -1.0));
        let high = ring.map(|(x, y)| corner(x, y, 1.0));
        let lines = &mut self.see_through;
        for i in 0..4 {
            let j = (i + 1) % 4;
            lines.add(low[i], low[j], color, width);
            lines.add(high[i], high[j], color, width);
            lines.add(low[i], high[i], color, width);
        }
        // Heading: a chevron on the roof, its tip at the front edge, and a tick ahead of the box.
        let tip = corner(1.0, 0.0, 1.0);
        let back = 1.0 - (b.size_m.y / b.size_m.x).min(1.2);
        lines.path(
            &[corner(back, 1.0, 1.0), tip, corner(back, -1.0, 1.0)],
            color,
            width,
        );
        let nose = corner(1.0, 0.0, -1.0);
        let ahead = b.heading().extend(0.0) * (0.25 * b.size_m.x).clamp(0.3, 1.5);
        lines.add(nose, nose + ahead, color, width + 0.8);
        if selected || hovered {
            let fill = [color[0], color[1], color[2], if selected { 30 } else { 18 }];
            for i in 0..4 {
                let j = (i + 1) % 4;
                self.faces
                    .add([low[i], low[j], high[j], high[i]], fill, FaceStyle::Plain);
            }
            self.faces.add(high, fill, FaceStyle::Plain);
        }
    }

    /// The outer faces of a set of voxels, each with a rim.
    fn cells(&mut self, extent: Extent, cells: &[[usize; 3]], color: [u8; 3]) {
        let limit = extent.shape();
        let inside: HashSet<[usize; 3]> = cells
            .iter()
            .copied()
            .filter(|c| (0..3).all(|i| c[i] < limit[i]))
            .collect();
        let mut order: Vec<_> = inside.iter().copied().collect();
        order.sort_unstable();
        let [r, g, b] = color;
        for cell in order {
            for normal in NORMALS {
                let next = [0, 1, 2].map(|i| cell[i].wrapping_add_signed(normal[i] as isize));
                if inside.contains(&next) {
                    continue;
                }
                let n = DVec3::from_array(normal.map(f64::from));
                let u = DVec3::new(n.y, n.z, n.x);
                let v = n.cross(u);
                let half = extent.voxel_m() / 2.0;
                let middle = extent.center(cell[0], cell[1], cell[2]) + n * (half + 0.012);
                let at = |a: f64, b: f64| middle + (u * a + v * b) * half;
                self.faces.add(
                    [at(-1.0, -1.0), at(1.0, -1.0), at(1.0, 1.0), at(-1.0, 1.0)],
                    [r, g, b, 84],
                    FaceStyle::Rim,
                );
            }
        }
    }
}

/// Rectangles (four vertices each) of two lists, without those that both have at the same place, counted from the front
/// or from the back.
pub(super) fn differing<V: Copy + PartialEq>(a: &[V], b: &[V]) -> Vec<V> {
    let whole = |vertices: usize| vertices / 4 * 4;
    let same = whole(a.iter().zip(b).take_while(|(a, b)| a == b).count());
    let (a, b) = (&a[same..], &b[same..]);
    let same = whole(
        (a.iter().rev())
            .zip(b.iter().rev())
            .take_while(|(a, b)| a == b)
            .count(),
    );
    [&a[..a.len() - same], &b[..b.len() - same]].concat()
}

/// The change of a picture by some points and what is drawn around them, up to `around_px` pixels wide.
pub(super) fn marked(points_m: impl Iterator<Item = DVec3>, around_px: f64) -> PictureChange {
    let mut points_m = points_m.peekable();
    if points_m.peek().is_none() {
        return PictureChange::None;
    }
    // They are drawn a little nearer to the viewer than they are, along the line of sight: at the same pixels.
    EgoBounds::around(points_m).map_or(PictureChange::All, |part| PictureChange::part(part, around_px))
}

fn lighter(color: [u8; 3], by: f32) -> [u8; 3] {
    color.map(|c| c + (f32::from(255 - c) * by) as u8)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn brush_cells_show_their_outer_faces_only() {
        let faces = |cells: &[[usize; 3]]| {
            let mut marks = Marks::default();
            marks.cells(Extent::WINDOW, cells, [255; 3]);
            marks.faces.vertices.len() / 4
        };
        assert_eq!(faces(&[]), 0);
        assert_eq!(faces(&[[5, 5, 5]]), 6);
        assert_eq!(faces(&[[5, 5, 5], [6, 5, 5]]), 10);
        assert_eq!(faces(&[[5, 5, 5], [5, 5, 5]]), 6);
        assert_eq!(faces(&[[0, 0, 0]]), 6);
        // Cells outside of the grid are left out.
        assert_eq!(faces(&[[200, 0, 0], [0, 0, 16]]), 0);
    }

    /// The lines as they were when every map was a window, and on a map beside the ego vehicle.
    #[test]
    fn the_metre_grid_covers_the_map() {
        let lines = |extent: Extent| {
            let mut marks = Marks::default();
            marks.metre_grid(extent);
            marks.plain
        };
        let (z, end) = (crate::GROUND_TOP_M + 0.005, 40.0);
        let mut expected = LineList::default();
        for i in [-4i32, -3, -2, -1, 1, 2, 3, 4] {
            let at = f64::from(i) * 10.0;
            let grey = [206, 214, 226, if i.abs() == 4 { 70 } else { 34 }];
            expected.add(DVec3::new(-end, at, z), DVec3::new(end, at, z), grey, 1.0);
            expected.add(DVec3::new(at, -end, z), DVec3::new(at, end, z), grey, 1.0);
        }
        let o = DVec3::new(0.0, 0.0, z);
        for (axis, [r, g, b]) in [(DVec3::X, [240, 104, 96]), (DVec3::Y, [120, 200, 110])] {
            expected.add(o, o - axis * end, [r, g, b, 50], 1.0);
            expected.add(o, o + axis * end, [r, g, b, 130], 1.4);
        }
        assert_eq!(lines(Extent::WINDOW), expected);
        // x 4.8 m to 25.2 m, y -4 m to 8 m: both sides and full tens along each, and the x axis ahead.
        let beside = Extent::new([12, -10], [51, 30]).expect("sound");
        assert_eq!(lines(beside).vertices.len() / 4, 4 + 2 + 1);
    }
}
