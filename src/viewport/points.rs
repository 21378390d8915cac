//! LiDAR returns: small discs, and the colours they can have.

use bytemuck::{Pod, Zeroable};

use super::shared::{PipelineSpec, Shared, VertexBuffer};
use crate::scene::{Class, LidarPoint, LidarSweep};

#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
#[repr(C)]
struct PointVertex {
    position_m: [f32; 3],
    color: [u8; 4],
}

const _: () = assert!(size_of::<PointVertex>() == 16);

/// What the colour of a LiDAR return tells.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum LidarColorMode {
    /// Distance from the sensor: near is warm, far is cool; the scale ends at 50 m.
    Range,
    /// Class of the voxel that was hit.
    Class,
    /// Beam, lowest to highest.
    Ring,
    /// Strength of the echo, 0 to 64 of 255: brighter ones are rare.
    Intensity,
    /// How likely the echo is lost: pale is sure, red is lost more often than not.
    Drop,
}

/// One sRGB colour per return, alpha 255.
pub fn lidar_colors(sweep: &LidarSweep, mode: LidarColorMode) -> Vec<[u8; 4]> {
    let rings = sweep.points.iter().map(|p| p.ring).max().unwrap_or(0).max(1);
    let color = |p: &LidarPoint| match mode {
        LidarColorMode::Range => ramp(p.range_m / 50.0),
        LidarColorMode::Ring => ramp(f32::from(p.ring) / f32::from(rings)),
        LidarColorMode::Intensity => ramp(1.0 - (p.intensity / 64.0).sqrt()),
        LidarColorMode::Drop => {
            let t = if p.drop_probability > 0.0 {
                p.drop_probability.min(1.0)
            } else {
                0.0
            };
            let mix = |pale: f32, red: f32| (pale + (red - pale) * t).round() as u8;
            [mix(214.0, 255.0), mix(226.0, 48.0), mix(236.0, 60.0), 255]
        }
        LidarColorMode::Class => {
            // Lighter than the voxel underneath, or it could not be seen on it.
            let base = match p.class {
                Class::Free => [255; 3],
                class => class.color(),
            };
            let [r, g, b] = base.map(|c| c + ((255 - c) as f32 * 0.45) as u8);
            [r, g, b, 255]
        }
    };
    sweep.points.iter().map(color).collect()
}

/// A ramp of even lightness steps: amber, rose, violet, blue, cyan; NaN gives the far end.
fn ramp(t: f32) -> [u8; 4] {
    const STOPS: [[f32; 3]; 5] = [
        [255.0, 214.0, 102.0],
        [255.0, 143.0, 107.0],
        [222.0, 98.0, 156.0],
        [126.0, 110.0, 226.0],
        [72.0, 190.0, 236.0],
    ];
    let t = if t.is_nan() { 1.0 } else { t.clamp(0.0, 1.0) } * (STOPS.len() - 1) as f32;
    let i = (t as usize).min(STOPS.len() - 2);
    let f = t - i as f32;
    let mix = |c: usize| (STOPS[i][c] + (STOPS[i + 1][c] - STOPS[i][c]) * f).round() as u8;
    [mix(0), mix(1), mix(2), 255]
}

/// Drawable of a sweep.
#[derive(Debug, Default)]
pub(super) struct Points {
    triangles: VertexBuffer,
}

impl Points {
    pub fn pipeline(device: &wgpu::Device, shared: &Shared, samples: u32) -> wgpu::RenderPipeline {
        PipelineSpec {
            shader: "points",
            stride: size_of::<PointVertex>(),
            attributes: &wgpu::vertex_attr_array![0 => Float32x3, 1 => Unorm8x4],
            ..PipelineSpec::OPAQUE
        }
        .build(device, shared, samples)
    }

    /// Uploads the returns; a return without a colour is white, a non-finite one is left out.
    pub fn write(
        &mut self,
        device: &wgpu::Device,
        queue: &wgpu::Queue,
        sweep: &LidarSweep,
        colors: &[[u8; 4]],
    ) {
        // The ground is drawn where the labels have it; so is what was measured on the physical one.
        let lift_m = if sweep.physical {
            super::GROUND_TOP_M as f32
        } else {
            0.0
        };
        let at = |[x, y, z]: [f32; 3]| [x, y, z + lift_m];
        let vertices: Vec<PointVertex> = sweep
            .points
            .iter()
            .enumerate()
            .filter(|(_, p)| p.position_in_ego.iter().all(|v| v.is_finite()))
            .flat_map(|(i, p)| {
                [PointVertex {
                    position_m: at(p.position_in_ego),
                    color: colors.get(i).copied().unwrap_or([255; 4]),
                }; 3]
            })
            .collect();
        self.triangles.write(device, queue, "points", &vertices);
    }

    pub fn draw(&self, pass: &mut wgpu::RenderPass<'_>) {
        self.triangles.draw_triangles(pass);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_return_has_a_colour() {
        let point = |range_m, ring, class| LidarPoint {
            position_in_ego: [1.0, 2.0, 3.0],
            range_m,
            ring,
            azimuth: 0,
            class,
            intensity: 0.0,
            drop_probability: 0.0,
        };
        let sweep = LidarSweep {
            points: vec![
                point(0.0, 0, Class::Car),
                point(1e9, 31, Class::Free),
                point(f32::NAN, 5, Class::Bus),
            ],
            rays: 3,
            physical: false,
        };
        for mode in [LidarColorMode::Range, LidarColorMode::Class, LidarColorMode::Ring] {
            let colors = lidar_colors(&sweep, mode);
            assert_eq!(colors.len(), 3);
            assert_ne!(colors[0], colors[1]);
            assert!(colors.iter().all(|c| c[3] == 255));
        }
        let by_range = lidar_colors(&sweep, LidarColorMode::Range);
        assert_eq!(by_range[1], by_range[2]);
        assert!(lidar_colors(&LidarSweep::default(), LidarColorMode::Ring).is_empty());
    }
}
