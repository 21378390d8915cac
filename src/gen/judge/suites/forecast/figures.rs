//! Figures of a forecast besides its nearness to the truth: how still standing things are, and how well an object keeps
//! its shape.

use std::collections::BTreeMap;

use glam::{DVec2, DVec3};

use authoring::drives::DriveFrame;
use scene::{Class, Extent, Pose, SceneBox, VoxelGrid, Window};

/// Figures of a method by name, one per drive.
#[derive(Default)]
pub struct ForecastFigures(pub BTreeMap<String, Vec<f64>>);

impl ForecastFigures {
    /// Adds a value; `None` is left out.
    pub fn add(&mut self, name: &str, value: Option<f64>) {
        self.0.entry(name.to_owned()).or_default().extend(value);
    }
}

/// The frame's pose on the ground.
pub fn pose(frame: &DriveFrame) -> Pose {
    let [x, y, yaw_rad] = frame.pose;
    Pose::planar(x, y, yaw_rad)
}

/// Column of one frame in which a point of another frame lies.
pub fn column_in(p: DVec3, from: &Pose, to: &Pose) -> Option<[usize; 2]> {
    let q = to.inverse().apply(from.apply(p.with_z(0.0)));
    Extent::WINDOW.column_at(q.x, q.y)
}

/// True in the columns of boxes that move, and around them.
pub fn moving_columns<'a>(boxes: impl Iterator<Item = &'a SceneBox>) -> Vec<bool> {
    let mut out = vec![false; Window::COLUMNS];
    for b in boxes.filter(|b| b.velocity_mps.length() > 0.1) {
        scene::raster::box_cells(Extent::WINDOW, b, 0.8, |x, y| out[x * Window::NY + y] = true);
    }
    out
}

/// Share of voxels that change from one frame to the next, among those occupied in either of the two, where nothing
/// moves and both frames see the place.
pub fn flicker(truth: &[DriveFrame], found: &[VoxelGrid]) -> Option<f64> {
    let (mut held, mut differ) = (0u64, 0u64);
    for (pair, grids) in truth.windows(2).zip(found.windows(2)) {
        let [here, there] = [pose(&pair[1]), pose(&pair[0])];
        let moving = [1, 0].map(|i| moving_columns(pair[i].boxes.values()));
        for c in 0..Window::COLUMNS {
            let (x, y) = (c / Window::NY, c % Window::NY);
            let Some([i, j]) = column_in(Window::center(x, y, 0), &here, &there) else {
                continue;
            };
            if moving[0][c] || moving[1][i * Window::NY + j] {
                continue;
            }
            for (a, b) in grids[1].column(x, y).iter().zip(grids[0].column(i, j)) {
                if *a != Class::FREE || *b != Class::FREE {
                    held += 1;
                    differ += u64::from(a != b);
                }
            }
        }
    }
    (held > 0).then(|| differ as f64 / held as f64)
}

/// Variation of the number of voxels of each object that moves and stays in sight over the frames (standard deviation
/// over mean); mean over all objects.
pub fn shape_spread(truth: &[DriveFrame], found: &[VoxelGrid]) -> Option<f64> {
    let inside = |b: &SceneBox| b.center_m.truncate().abs().max_element() < 36.0;
    let first = truth.first()?;
    let moving = first
        .boxes
        .values()
        .filter(|b| b.velocity_mps.length() > 0.5 && inside(b));
    let mut spreads = Vec::new();
    for b in moving {
        let boxes: Option<Vec<&SceneBox>> = truth
            .iter()
            .map(|f| f.boxes.get(&b.id).filter(|b| inside(b)))
            .collect();
        let Some(boxes) = boxes else {
            continue;
        };
        let counts: Vec<f64> = boxes
            .iter()
            .zip(found)
            .map(|(b, grid)| voxels_of(grid, b))
            .collect();
        let mean = counts.iter().sum::<f64>() / counts.len() as f64;
        if mean > 0.0 {
            let variance = counts.iter().map(|n| (n - mean).powi(2)).sum::<f64>() / counts.len() as f64;
            spreads.push(variance.sqrt() / mean);
        }
    }
    (!spreads.is_empty()).then(|| spreads.iter().sum::<f64>() / spreads.len() as f64)
}

fn voxels_of(grid: &VoxelGrid, b: &SceneBox) -> f64 {
    let mut n = 0;
    scene::raster::box_cells(Extent::WINDOW, b, scene::Window::VOXEL_M, |x, y| {
        n += grid.column(x, y).iter().filter(|l| **l == b.class.id()).count();
    });
    n as f64
}

/// A box after it has moved on at its velocity.
pub fn moved_on(b: &SceneBox, seconds: f64, from: &Pose, to: &Pose) -> SceneBox {
    let way: DVec2 = b.velocity_mps * seconds;
    let on = SceneBox {
        center_m: b.center_m + way.extend(0.0),
        ..*b
    };
    on.in_frame(from).in_frame(&to.inverse())
}

#[cfg(test)]
mod tests {
    use super::*;
    use authoring::drives::{drive_scene, frames_of};

    /// What comes of one world hardly flickers, what comes of two does; the truth's objects keep their shape.
    #[test]
    fn one_world_flickers_less_than_two() {
        let truth = frames_of(&drive_scene(9, 3, |_| None)).0;
        let own: Vec<VoxelGrid> = truth.iter().map(|f| f.dense.clone()).collect();
        let still = flicker(&truth, &own).expect("something stands");
        let other = frames_of(&drive_scene(9, 4, |_| None)).0;
        let mixed: Vec<VoxelGrid> = own
            .iter()
            .zip(&other)
            .enumerate()
            .map(|(i, (a, b))| if i % 2 == 0 { a.clone() } else { b.dense.clone() })
            .collect();
        let worlds = flicker(&truth, &mixed).expect("something stands");
        assert!(still < 0.2 && worlds > 2.0 * still, "{still} and {worlds}");
        assert!(shape_spread(&truth, &own).is_none_or(|s| s < 0.15));
    }
}
