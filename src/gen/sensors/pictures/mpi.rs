//! Semantic multi-plane images: the classes on fronto-parallel planes of a camera, after SyntheOcc
//! (arXiv 2410.00337) equations 1 to 3, for any camera and size.
//!
//! Plane l of D lies at depth d_l = d_min + (d_max - d_min) l / D; a pixel's ray meets it at T K^-1 (u d, v d, d), and
//! shows the class of the voxel in which that point lies (half-open cells, so nothing is half a voxel off; pixel
//! centres at + 1/2). Stored as runs of planes of one class.

use glam::DVec3;
use rayon::prelude::*;

use crate::raycast::grid_span;
use crate::raycast::rays::CameraRays;
use crate::splat::cloud::{render_id, road_id};
use scene::sensor_data::{PlaneDepths, PlaneRun, RenderId};
use scene::{Camera, Class, Extent, Lattice, MultiPlaneImage, VoxelGrid};

const FREE: u8 = Class::FREE;
/// Free in a table of render ids, where 17 is a crossing.
const NONE: RenderId = RenderId::MAX;

/// The render ids of all voxels, `[x][y][z]`, ready for any number of cameras.
pub struct RenderIds {
    extent: Extent,
    /// Voxels along each axis.
    size: DVec3,
    /// Columns along y.
    ny: usize,
    ids: Vec<RenderId>,
}

impl RenderIds {
    /// Render ids of a grid; `bev` holds one bit per layer for each column (an empty slice has no lines).
    pub fn new(grid: &VoxelGrid, bev: &[u32]) -> Self {
        let extent = grid.extent();
        let mut ids = vec![NONE; extent.voxels()];
        for (column, ids) in ids.chunks_exact_mut(Lattice::OCC3D.bins()).enumerate() {
            let road = road_id(bev.get(column).copied().unwrap_or(0));
            let [x, y] = extent.column(column);
            let labels = grid.column(x, y);
            for (id, &label) in ids.iter_mut().zip(labels) {
                if label != FREE {
                    *id = render_id(label, road);
                }
            }
        }
        Self {
            extent,
            size: DVec3::from_array(extent.shape().map(|n| n as f64)),
            ny: extent.ny(),
            ids,
        }
    }

    /// The id at a point in voxel units; `NONE` where free, outside the grid or not finite.
    #[inline]
    fn at(&self, p: DVec3) -> RenderId {
        // Written so that NaN fails too; a cast towards 0 would put -0.5 into voxel 0.
        if !(p.min_element() >= 0.0 && p.cmplt(self.size).all()) {
            return NONE;
        }
        self.ids[(p.x as usize * self.ny + p.y as usize) * Lattice::OCC3D.bins() + p.z as usize]
    }
}

/// The planes of one camera at `width` x `height` pixels (0 gives an empty image).
pub fn render(
    ids: &RenderIds,
    camera: &Camera,
    width: u32,
    height: u32,
    planes: PlaneDepths,
) -> MultiPlaneImage {
    let rays = CameraRays::new(camera, width, height);
    let row = |y: u32| {
        let (mut counts, mut runs) = (Vec::with_capacity(width as usize), Vec::new());
        for x in 0..width {
            let before = runs.len();
            let ray = rays.at(f64::from(x) + 0.5, f64::from(y) + 0.5);
            // Unit depth, so that a multiple of it is a depth.
            let (origin, step) = (
                ids.extent.to_voxel_units(ray.origin),
                ray.direction / Lattice::OCC3D.voxel_m(),
            );
            if step != DVec3::ZERO {
                trace(ids, origin, step, planes, &mut runs);
            }
            counts.push((runs.len() - before) as u32);
        }
        (counts, runs)
    };
    let rows: Vec<(Vec<u32>, Vec<PlaneRun>)> = (0..height).into_par_iter().map(row).collect();
    let mut starts = Vec::with_capacity(width as usize * height as usize + 1);
    starts.push(0);
    let mut runs = Vec::with_capacity(rows.iter().map(|(_, runs)| runs.len()).sum());
    let mut total = 0;
    for (counts, row) in rows {
        for count in counts {
            total += count;
            starts.push(total);
        }
        runs.extend(row);
    }
    MultiPlaneImage {
        camera: camera.name.clone(),
        width: width as usize,
        height: height as usize,
        planes,
        starts,
        runs,
    }
}

/// The runs of planes along one ray; `ray` is the step for one metre of depth, voxel units.
fn trace(ids: &RenderIds, origin: DVec3, ray: DVec3, planes: PlaneDepths, runs: &mut Vec<PlaneRun>) {
    let Some(span) = grid_span(ids.extent, origin, ray) else {
        return;
    };
    // Planes a step outside the span are looked at too: their points decide for themselves.
    let step_m = planes.depth_m(1) - planes.depth_m(0);
    let index =
        |depth_m: f64| ((depth_m - planes.depth_m(0)) / step_m).clamp(0.0, f64::from(planes.count)) as u16;
    let (first, last) = (
        index(span.enter).saturating_sub(1),
        index(span.leave).saturating_add(1),
    );
    let mut open: Option<PlaneRun> = None;
    for plane in first..=last.min(planes.count.saturating_sub(1)) {
        let id = ids.at(origin + ray * planes.depth_m(plane));
        match &mut open {
            Some(run) if run.id == id => run.end = plane + 1,
            _ => {
                runs.extend(open.take());
                let end = plane + 1;
                open = (id != NONE).then_some(PlaneRun {
                    first: plane,
                    end,
                    id,
                });
            }
        }
    }
    runs.extend(open);
}

#[cfg(test)]
mod tests {
    use super::*;
    use scene::{SensorRig, Window, draft};
    use world::World;

    /// The definition, point by point, in the ego frame.
    fn direct(
        grid: &VoxelGrid,
        bev: &[u32],
        camera: &Camera,
        pixel: [u32; 2],
        depth_m: f64,
    ) -> Option<RenderId> {
        let at = |i: usize| (f64::from(pixel[i]) + 0.5 - camera.center_px[i]) / camera.focal_px[i] * depth_m;
        let p = camera.ego_from_camera().apply(DVec3::new(at(0), at(1), depth_m));
        let [x, y, z] = Window::voxel_at(p)?;
        let label = grid.get(x, y, z);
        (label != FREE).then(|| render_id(label, road_id(bev[x * Window::NY + y])))
    }

    #[test]
    fn every_plane_shows_the_voxel_that_it_cuts() {
        let world = World::random(11);
        let grid = draft::draft(&world.layout, world.boxes.values());
        let bev = world.layout.cells();
        let ids = RenderIds::new(&grid, bev);
        let mut wide = SensorRig::default().cameras[0].clone();
        wide.focal_px = [70.0, 200.0]; // 170 degrees
        for camera in SensorRig::default().cameras.iter().chain([&wide]) {
            let (w, h) = (48, 27);
            let image = render(&ids, camera, w, h, PlaneDepths::default());
            let small = camera.resized(w, h);
            let (mut seen, mut wrong) = (0, 0);
            for plane in (0..256).step_by(3) {
                let slice = image.slice(plane);
                for (i, &found) in slice.iter().enumerate() {
                    let pixel = [i as u32 % w, i as u32 / w];
                    let truth = direct(&grid, bev, &small, pixel, image.planes.depth_m(plane));
                    wrong += usize::from(truth != found);
                    seen += usize::from(truth.is_some());
                }
            }
            // Points within rounding of a voxel's face may fall on either side.
            assert!(seen > 300 && wrong <= 2, "{}: {wrong} of {seen}", camera.name);
            let first = image.first_visible();
            let near = |i: usize| (0..256).find_map(|p| image.at(i, p));
            assert!((0..first.len()).step_by(7).all(|i| first[i] == near(i)));
        }
    }

    #[test]
    fn a_wall_shows_where_it_stands_and_odd_cameras_do_no_harm() {
        let mut grid = VoxelGrid::new();
        for y in 0..Window::NY {
            for z in 0..Lattice::OCC3D.bins() {
                grid.set(150, y, z, Class::Manmade.id()); // x = 20.0 to 20.4 m
            }
        }
        let mut camera = SensorRig::default().cameras[1].clone();
        camera.rotation_wxyz = [0.5, -0.5, 0.5, -0.5]; // straight ahead
        camera.translation_m = [0.0, 0.0, 1.5];
        let ids = RenderIds::new(&grid, &[]);
        let image = render(&ids, &camera, 64, 36, PlaneDepths::default());
        let runs = image.pixel(18 * 64 + 32);
        // d = 0.2 + 51 l / 256: planes 100 (20.12 m) and 101 (20.32 m).
        assert_eq!(
            runs,
            [PlaneRun {
                first: 100,
                end: 102,
                id: Class::Manmade.id()
            }]
        );
        for (translation, focal) in [
            ([20.2, 0.0, 1.5], 1e-3),
            ([1e9, 0.0, 1.5], 1e9),
            ([f64::NAN; 3], 1.0),
        ] {
            (camera.translation_m, camera.focal_px) = (translation, [focal; 2]);
            let odd = render(&ids, &camera, 8, 6, PlaneDepths::default());
            assert_eq!(odd.starts.len(), 49);
        }
        assert_eq!(render(&ids, &camera, 0, 9, PlaneDepths::default()).runs, []);
        let one = PlaneDepths {
            count: 1,
            near_m: 20.1,
            far_m: 21.0,
        };
        assert!(
            render(&ids, &SensorRig::default().cameras[1], 8, 6, one)
                .slice(0)
                .len()
                == 48
        );
    }
}
