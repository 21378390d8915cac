//! A LiDAR sweep as a request asks for it.

use glam::DVec3;
use tonic::Status;

use crate::moment::{self, PlacedObject, TimeSpan};
use crate::poses::Pair;
use crate::renderer::Renderer;
use crate::wire::{LidarDeviceType, LidarRenderRequest, LidarRenderReturn};
use scene::{LidarPattern, Pose, Scene, SensorRig};
use sensors::lidar;
use sensors::lidar::learned::{self, Drops};
use sensors::lidar::shaped::onto_shapes;
use sensors::pictures::scenery::SceneryShapes;

/// Parts of a spin. While one of them is swept, things stand still and the LiDAR moves on straight.
const PARTS: u32 = 8;

/// The pattern of a device, at the origin. Beams follow the published fields of view and spacings; between the spacings that are
/// published they are even.
pub fn pattern_of(device: LidarDeviceType) -> LidarPattern {
    let even = |from: f64, step: f64, count: u32| (0..count).map(move |i| from + step * f64::from(i));
    let (name, elevations_deg, columns, first_azimuth_deg, sector_deg, clockwise): (_, Vec<f64>, _, _, _, _) =
        match device {
            // 40 degrees in all, an eighth of a degree apart from -6 to 2; spins clockwise from straight behind.
            LidarDeviceType::Pandar128 => {
                let below = even(-25.0, 0.5, 38);
                let middle = even(-6.0, 0.125, 65);
                let above = even(2.52, 0.52, 25);
                let all = below.chain(middle).chain(above).collect();
                ("PANDAR128", all, 1800, 180.0, 360.0, true)
            }
            // 25.4 degrees in all, 120 degrees wide, straight ahead, from right to left.
            LidarDeviceType::At128 => {
                let all = even(-12.5, 0.2, 128).collect();
                ("AT128", all, 3600, -60.0, 120.0, false)
            }
        };
    LidarPattern {
        name: name.into(),
        elevations_deg,
        columns,
        first_azimuth_deg,
        sector_deg,
        clockwise,
        spin_hz: 0.0,
        part: None,
        max_range_m: 200.0,
        min_range_m: 0.5,
        own_body: false,
        beyond_grid: true,
        rotation_wxyz: [1.0, 0.0, 0.0, 0.0],
        translation_m: [0.0; 3],
    }
}

/// Renders a sweep. Errors in one line.
pub fn render(renderer: &Renderer, request: &LidarRenderRequest) -> Result<LidarRenderReturn, Status> {
    let device = request.lidar_config.map_or(0, |c| c.lidar_type);
    let device = LidarDeviceType::try_from(device).map_err(|_| {
        Status::invalid_argument(format!(
            "lidar_type is {device}, expected PANDAR128 (0) or AT128 (1)"
        ))
    })?;
    let scene = renderer.scenes.get(&request.scene_id)?;
    let spin = Spin {
        scene: &scene,
        span: TimeSpan::read(request.frame_start_us, request.frame_end_us, &scene)?,
        sensor: Pair::read(request.sensor_pose.as_ref(), "sensor_pose")?,
        placed: moment::placed(&scene, &request.dynamic_objects)?,
        pattern: pattern_of(device),
    };
    spin.sweep(renderer)
}

/// A request, read.
struct Spin<'a> {
    scene: &'a Scene,
    span: TimeSpan,
    sensor: Pair,
    placed: Vec<PlacedObject>,
    pattern: LidarPattern,
}

impl Spin<'_> {
    /// True if anything moves while the LiDAR spins.
    fn moves(&self) -> bool {
        let placed = self.placed.iter().any(|p| p.at.start != p.at.end);
        self.sensor.start != self.sensor.end
            || self.span.length_s > 0.0 && (placed || !self.scene.clip().stands())
    }

    /// The points, part by part, in the LiDAR's frame at the end of the spin.
    fn sweep(&self, renderer: &Renderer) -> Result<LidarRenderReturn, Status> {
        let parts = if self.moves() { PARTS } else { 1 };
        let columns = self.pattern.columns_in_sector();
        let end_from_world = self.sensor.end.inverse();
        let mut out = LidarRenderReturn::default();
        let scenery = match renderer.net {
            Some(_) => None,
            None => {
                let reach =
                    [self.sensor.start, self.sensor.end].map(|p| (p.translation_m, self.pattern.max_range_m));
                SceneryShapes::within(self.scene.frame(), &self.scene.background, &reach)
            }
        };
        for part in 0..parts {
            let [from, to] = [part, part + 1].map(|i| columns * i / parts);
            let shares = [part, part + 1].map(|i| f64::from(i) / f64::from(parts));
            let middle = (shares[0] + shares[1]) / 2.0;
            let share = if parts == 1 { 0.0 } else { middle };
            let frame = moment::frame(self.scene, &self.span, share, &self.placed)?;
            let rig = self.rig(share, shares[1], [from, to - from]);
            let grid = &frame.occupancy;
            let mut sweep = match &renderer.net {
                Some(net) => learned::rig_sweep(net, grid, &rig, Drops::Likely)
                    .map_err(|e| Status::internal(format!("the LiDAR network: {e}")))?,
                None => lidar::rig_sweep(grid, &rig).unwrap_or_default(),
            };
            onto_shapes(&mut sweep, &frame, &rig, self.scene.seed, scenery.as_ref());
            for point in &sweep.points {
                let p = DVec3::from_array(point.position_in_ego.map(f64::from));
                let p = end_from_world.apply(p).as_vec3();
                if p.is_finite() {
                    out.point_xyzs.extend(p.to_array());
                    out.point_intensities
                        .push((point.intensity / 255.0).clamp(0.0, 1.0));
                }
            }
        }
        out.num_points = out.point_intensities.len() as u32;
        let bytes = |values: &[f32]| values.iter().flat_map(|v| v.to_le_bytes()).collect();
        out.point_xyzs_buffer = bytes(&out.point_xyzs);
        out.point_intensities_buffer = bytes(&out.point_intensities);
        Ok(out)
    }

    /// The rig with these columns (the first, and how many) of the LiDAR: turned as at one share of the spin, and where it is at
    /// another, their end.
    fn rig(&self, turned: f64, end: f64, [first, count]: [u32; 2]) -> SensorRig {
        let pose = Pose {
            rotation: self.sensor.at(turned).rotation,
            translation_m: self.sensor.at(end).translation_m,
        };
        let mount = self.scene.rig.lidars.first().map(LidarPattern::ego_from_sensor);
        let mount = mount.unwrap_or(Pose {
            translation_m: DVec3::new(0.94, 0.0, 1.84),
            ..Pose::IDENTITY
        });
        let vehicle = pose * mount.inverse();
        let way_m = self.sensor.end.translation_m - self.sensor.start.translation_m;
        let rolls = self.span.length_s > 0.0 && way_m != DVec3::ZERO;
        let mut lidar = self.pattern.part(first, count);
        let q = pose.rotation;
        (lidar.rotation_wxyz, lidar.translation_m) = ([q.w, q.x, q.y, q.z], pose.translation_m.to_array());
        let mut speed_mps = 0.0;
        if rolls {
            // All columns of the sector within the span, whatever share of the circle they are.
            let columns = f64::from(self.pattern.columns_in_sector());
            lidar.spin_hz = columns / f64::from(self.pattern.columns) / self.span.length_s;
            speed_mps = (vehicle.rotation * DVec3::X).dot(way_m) / self.span.length_s;
        }
        SensorRig {
            lidars: vec![lidar],
            ego_speed_mps: speed_mps,
            vehicle,
            ..(*self.scene.rig).clone()
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn patterns_are_as_published() {
        let pandar = pattern_of(LidarDeviceType::Pandar128);
        let at = pattern_of(LidarDeviceType::At128);
        for (pattern, columns, low_deg, high_deg) in [(&pandar, 1800, -25.0, 15.0), (&at, 1200, -12.5, 12.9)]
        {
            assert_eq!(pattern.elevations_deg.len(), 128);
            assert_eq!(pattern.columns_in_sector(), columns);
            assert!(pattern.elevations_deg.is_sorted());
            let ends = [pattern.elevations_deg[0], pattern.elevations_deg[127]];
            assert!(
                (ends[0] - low_deg).abs() < 1e-9 && (ends[1] - high_deg).abs() < 1e-9,
                "{ends:?}"
            );
        }
        assert!((at.azimuth_rad(600)).abs() < 1e-9, "its middle looks ahead");
    }
}
