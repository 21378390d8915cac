//! Expected labels of a box that no sensor ever saw: the faces of its draft that look towards a drive along the ego's x
//! axis. Labels are hollow, and the far side of a vehicle is missing.

use std::collections::HashMap;

use glam::DVec3;

use scene::draft::{box_columns, ground_bin};
use scene::{BevLayout, Extent, SceneBox, Window};

/// Positions of the drive's sensor, ego frame, m.
const SENSORS_X_M: [f64; 7] = [-30.0, -20.0, -10.0, 0.0, 10.0, 20.0, 30.0];
const SENSOR_Z_M: f64 = 1.84;
/// Outward normals of a voxel's faces, except the lower one.
const FACES: [[i64; 3]; 5] = [[1, 0, 0], [-1, 0, 0], [0, 1, 0], [0, -1, 0], [0, 0, 1]];

/// The voxels of a box's draft that such a drive sees, `[x, y, z]`, from the ground of `layout` up.
pub fn seen_voxels(layout: &BevLayout, b: &SceneBox) -> Vec<[usize; 3]> {
    let columns: HashMap<[usize; 2], [usize; 2]> = box_columns(Extent::WINDOW, b)
        .into_iter()
        .map(|(x, y, layers)| ([x, y], [ground_bin(layout, x, y).min(layers - 1), layers]))
        .collect();
    let solid = |[x, y, z]: [i64; 3]| {
        let at = [usize::try_from(x), usize::try_from(y)];
        let [Ok(x), Ok(y)] = at else { return false };
        let span = columns.get(&[x, y]);
        span.is_some_and(|[ground, layers]| (*ground as i64..*layers as i64).contains(&z))
    };
    let seen = |[x, y, z]: [usize; 3]| {
        let center = Window::center(x, y, z);
        FACES.iter().any(|face| {
            let beside = [x as i64 + face[0], y as i64 + face[1], z as i64 + face[2]];
            let normal = DVec3::new(face[0] as f64, face[1] as f64, face[2] as f64);
            let faces =
                |x_m: &f64| normal.dot(DVec3::new(*x_m, 0.0, SENSOR_Z_M) - center) > Window::VOXEL_M / 2.0;
            !solid(beside) && SENSORS_X_M.iter().any(faces)
        })
    };
    let all = columns
        .iter()
        .flat_map(|([x, y], [ground, layers])| (*ground..*layers).map(|z| [*x, *y, z]));
    let mut found: Vec<_> = all.filter(|v| seen(*v)).collect();
    found.sort_unstable();
    found
}

#[cfg(test)]
mod tests {
    use glam::DVec2;

    use super::*;
    use scene::{BoxId, Class};

    #[test]
    fn near_sides_are_seen_and_the_inside_is_not() {
        let bus = SceneBox {
            id: BoxId(1),
            class: Class::Bus,
            center_m: DVec3::new(4.0, 8.0, 1.6),
            size_m: DVec3::new(12.0, 2.9, 3.2),
            yaw_rad: 0.0,
            velocity_mps: DVec2::ZERO,
            label: Default::default(),
        };
        let voxels = seen_voxels(&BevLayout::default(), &bus);
        let solid: usize = box_columns(Extent::WINDOW, &bus).iter().map(|c| c.2).sum();
        assert!(
            voxels.len() > solid / 8 && voxels.len() < solid / 3,
            "{} of {solid}",
            voxels.len()
        );
        let ys = || voxels.iter().map(|v| v[1]);
        let (near, far) = (ys().min().expect("some"), ys().max().expect("some"));
        let side = |y| voxels.iter().filter(|v| v[1] == y).count();
        assert!(side(near) > 5 * side(far), "{} {}", side(near), side(far)); // of the far side only the ends
        let ends = [95, 124].map(|x| voxels.iter().filter(|v| v[0] == x).count());
        assert!(ends.iter().all(|n| *n > 20), "{ends:?}");
    }

    #[test]
    fn a_box_beyond_the_grid_has_none() {
        let far = SceneBox {
            id: BoxId(1),
            class: Class::Car,
            center_m: DVec3::new(400.0, f64::NAN, 0.8),
            size_m: DVec3::new(4.6, 1.9, 1.6),
            yaw_rad: 0.0,
            velocity_mps: DVec2::ZERO,
            label: Default::default(),
        };
        assert!(seen_voxels(&BevLayout::default(), &far).is_empty());
    }
}
