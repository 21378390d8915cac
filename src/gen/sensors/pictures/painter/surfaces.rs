//! Correspondence of pixels: which pixel of the frame before, or of the camera beside, shows the same surface. Depth
//! and motion are known exactly, so noise and colours can move with their surfaces.

use glam::DVec3;
use rayon::prelude::*;

use super::seen::RingFrame;
use crate::raycast::rays::CameraRays;

/// Depth taken where there is no surface, m.
const FAR_M: f64 = 2000.0;
/// Largest difference in depth for the same surface: this share of the depth plus this many metres.
const SAME_SHARE: f64 = 0.03;
const SAME_M: f64 = 0.25;

/// One view of a frame.
struct SurfaceView<'a> {
    seen: &'a RingFrame,
    place: usize,
    rays: CameraRays,
    size: [usize; 2],
}

impl<'a> SurfaceView<'a> {
    fn from_ring(seen: &'a RingFrame, place: usize) -> Self {
        let camera = seen.camera(place);
        Self {
            seen,
            place,
            rays: CameraRays::new(camera, camera.width, camera.height),
            size: [camera.height as usize, camera.width as usize],
        }
    }

    fn all(seen: &'a RingFrame, views: usize) -> Vec<Self> {
        (0..views).map(|place| Self::from_ring(seen, place)).collect()
    }

    /// Depth of a pixel, m.
    fn depth_m(&self, [row, column]: [usize; 2]) -> f64 {
        match self.seen.pixels(self.place).0.depth_m[row * self.size[1] + column] {
            deep if deep > 0.0 => f64::from(deep),
            _ => FAR_M,
        }
    }

    /// Place of the surface in a pixel, world frame, m.
    fn surface(&self, at: [usize; 2]) -> DVec3 {
        let ray = self.rays.at(at[1] as f64 + 0.5, at[0] as f64 + 0.5);
        ray.origin + ray.direction * self.depth_m(at)
    }

    /// The pixel that shows a place; `None` if it is outside of the picture or hidden.
    fn pixel(&self, p_m: DVec3) -> Option<[usize; 2]> {
        let px = self.rays.project(p_m);
        let within = |v: f64, n: usize| (v >= 0.0 && v < n as f64).then_some(v as usize);
        let at = [within(px.y, self.size[0])?, within(px.x, self.size[1])?];
        let deep = self.depth_m(at);
        // Everything without depth is one sky, whatever distance is assumed for it.
        let is_sky = deep == FAR_M && px.z > FAR_M / 2.0;
        let same = px.z > 0.0 && (deep - px.z).abs() <= SAME_M + SAME_SHARE * px.z;
        (is_sky || same).then_some(at)
    }
}

/// For each pixel `[view][row][column]` of a frame the pixel of an earlier frame that showed the same surface, in the
/// same view if it did there. Both rings have the given number of views.
pub(super) fn pixels_before(now: &RingFrame, before: &RingFrame, views: usize) -> Vec<Option<u32>> {
    let (now, then) = (SurfaceView::all(now, views), SurfaceView::all(before, views));
    let pixels = now.first().map_or(0, |v| v.size[0] * v.size[1]);
    let of_pixel = |i: usize| {
        let view = &now[i / pixels];
        let at = [i % pixels / view.size[1], i % view.size[1]];
        let p_m = view.surface(at);
        // The ring's neighbours look past the edges.
        let beside = [
            view.place,
            (view.place + 1) % views,
            (view.place + views - 1) % views,
        ];
        beside
            .iter()
            .find_map(|place| Some((*place, then[*place].pixel(p_m)?)))
            .map(|(place, [row, column])| (place * pixels + row * view.size[1] + column) as u32)
    };
    (0..views * pixels).into_par_iter().map(of_pixel).collect()
}

/// Correspondence as [`pixels_before`] gives it, for cells of `cell` pixels a side, by the pixels in their middles.
pub(super) fn cells_of(pixels: &[Option<u32>], [height, width]: [usize; 2], cell: usize) -> Vec<Option<u32>> {
    let (rows, columns) = (height / cell, width / cell);
    let views = pixels.len() / (height * width).max(1);
    let of_cell = |i: usize| {
        let (view, row, column) = (i / (rows * columns), i / columns % rows, i % columns);
        let middle = |n: usize| n * cell + cell / 2;
        let from = pixels[(view * height + middle(row)) * width + middle(column)]? as usize;
        let (view, row, column) = (from / (height * width), from / width % height, from % width);
        let at = [row / cell, column / cell];
        (at[0] < rows && at[1] < columns).then(|| ((view * rows + at[0]) * columns + at[1]) as u32)
    };
    (0..views * rows * columns).map(of_cell).collect()
}

/// For each cell of `cell` pixels a side `[view][row][column]` the cell of a view drawn before it, in `order`, that
/// shows the same surface: the two share their noise. The first cell that shows a surface has none.
pub(super) fn shared_cells(seen: &RingFrame, order: &[usize], cell: usize) -> Vec<Option<u32>> {
    let views = SurfaceView::all(seen, order.len());
    let [height, width] = views.first().map_or([0, 0], |v| v.size);
    let (rows, columns) = (height / cell, width / cell);
    let mut from: Vec<Option<u32>> = vec![None; order.len() * rows * columns];
    for (done, place) in order.iter().enumerate() {
        for i in 0..rows * columns {
            let middle = [i / columns, i % columns].map(|n| n * cell + cell / 2);
            let p_m = views[*place].surface(middle);
            let found = order[..done].iter().find_map(|other| {
                let [row, column] = views[*other].pixel(p_m)?.map(|n| n / cell);
                let at = (row < rows && column < columns).then(|| (other * rows + row) * columns + column)?;
                // If that cell shares the noise of a third view, this one does too.
                Some(from[at].unwrap_or(at as u32))
            });
            from[place * rows * columns + i] = found;
        }
    }
    from
}
