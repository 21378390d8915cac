//! Exact sweeps meet the ground where labels have it, two bins below its physical height, and the parts of objects that
//! labels let reach down to it. A file for others has the ground where boxes and vehicles stand on it.

use glam::DVec3;
use scene::{Frame, LidarSweep, draft};

/// Shortens each ray that goes through the physical ground to the point where it meets it; a return from below becomes
/// one of the ground. A sweep that is physical already is not changed. `origin_in_ego` is where the LiDAR is; points
/// are in the ego frame of `frame`, whose other coordinates are in the world frame.
pub fn to_physical_ground(sweep: &mut LidarSweep, origin_in_ego: DVec3, frame: &Frame) {
    if sweep.physical {
        return;
    }
    let (pose, relief) = (frame.world_from_ego, &frame.layout.relief);
    let origin = pose.apply(origin_in_ego);
    for point in &mut sweep.points {
        let in_ego = DVec3::from_array(point.position_in_ego.map(f64::from));
        let way = pose.apply(in_ego) - origin;
        let Some(share) = relief.met_by(origin, way, 1.0).filter(|share| *share > 0.0) else {
            continue;
        };
        let met = origin_in_ego + (in_ego - origin_in_ego) * share;
        point.position_in_ego = met.as_vec3().to_array();
        point.range_m *= share as f32;
        if !point.class.is_ground() {
            let at = origin + way * share;
            let cell = frame.extent().column_at(at.x, at.y);
            point.class = draft::ground_class(cell.map_or(0, |[x, y]| frame.layout.cell(x, y)));
            point.velocity_mps = [0.0; 2];
        }
    }
    sweep.physical = true;
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::clip_tests::{clip_scene, point};
    use scene::{Class, Pose};

    #[test]
    fn rays_end_at_the_physical_ground_and_objects_keep_what_is_above_it() {
        let scene = clip_scene(3);
        let mut frame = (**scene.frame()).clone();
        frame.world_from_ego = Pose::planar(3.0, -2.0, 0.4);
        let mut sweep = LidarSweep {
            points: vec![
                point([10.0, 0.0, -0.6], Class::DriveableSurface),
                point([10.0, 0.0, -0.4], Class::Car),
                point([10.0, 0.0, 0.9], Class::Car),
            ],
            rays: 3,
            physical: false,
            provenance: Vec::new(),
        };
        let above = sweep.points[2];
        to_physical_ground(&mut sweep, DVec3::new(0.0, 0.0, 1.8), &frame);
        assert!(sweep.physical);
        for (point, share) in sweep.points.iter().zip([1.8 / 2.4, 1.8 / 2.2]) {
            let [x, y, z] = point.position_in_ego;
            assert!((f64::from(x) - 10.0 * share).abs() < 1e-5 && y.abs() < 1e-5 && z.abs() < 1e-5);
            assert!(point.class.is_ground(), "{point:?}");
        }
        assert_eq!(sweep.points[2], above);
        let before = sweep.clone();
        to_physical_ground(&mut sweep, DVec3::Z, &frame);
        assert_eq!(sweep, before);
    }
}
