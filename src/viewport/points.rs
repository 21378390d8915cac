//! LiDAR returns: small discs, and the colours they can have. They are held in squares of the ground, so that those out of
//! view cost nothing, and an edit draws again only what it changed.

use std::hash::{DefaultHasher, Hash as _, Hasher as _};

use bytemuck::{Pod, Zeroable};
use glam::DVec3;

use super::LidarView;
use super::change::{EgoBounds, PictureChange, may_be_seen};
use super::drawable::{DrawContext, DrawInput, DrawLayer, Drawable, Gpu, Pipelines};
use super::shared::{PipelineSpec, VertexBuffer};
use scene::{Class, LidarPoint, LidarSweep, Provenance};

#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
#[repr(C)]
struct PointVertex {
    position_m: [f32; 3],
    color: [u8; 4],
}

const _: () = assert!(size_of::<PointVertex>() == 16);

/// Meaning of the colour of a LiDAR return.
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
    /// Origin in a recorded sweep: grey is recorded, blue was measured by other sweeps, green was added,
    /// orange and violet are told from what was measured nearby.
    Origin,
}

/// One sRGB colour per return, alpha 255.
pub fn lidar_colors(sweep: &LidarSweep, mode: LidarColorMode) -> Vec<[u8; 4]> {
    let rings = sweep.points.iter().map(|p| p.ring).max().unwrap_or(0).max(1);
    let origins = sweep
        .provenance
        .iter()
        .copied()
        .chain(std::iter::repeat(Provenance::Added));
    let color = |(p, origin): (&LidarPoint, Provenance)| match mode {
        LidarColorMode::Origin => match origin {
            Provenance::Recorded | Provenance::Emptied => [150, 158, 168, 255],
            Provenance::OtherSweep => [104, 196, 255, 255],
            Provenance::Ground => [255, 178, 66, 255],
            Provenance::Added => [92, 214, 130, 255],
            Provenance::Continued => [190, 124, 240, 255],
        },
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
    sweep.points.iter().zip(origins).map(color).collect()
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

/// Edge of a square of the ground, m, and squares along a side; the outermost also hold the returns beyond them.
const SQUARE_M: f32 = 8.0;
const SQUARES: usize = 16;

/// Returns over one square.
#[derive(Debug, Default)]
struct Square {
    triangles: VertexBuffer,
    vertices: Vec<PointVertex>, // as uploaded
    part: Option<EgoBounds>,
}

/// Drawable of a sweep.
#[derive(Debug)]
pub(super) struct Points {
    pipelines: Pipelines,
    squares: Vec<Square>,
    uploaded: Option<u64>, // fingerprint
}

impl Default for Points {
    fn default() -> Self {
        Self {
            pipelines: Pipelines::default(),
            squares: (0..SQUARES * SQUARES).map(|_| Square::default()).collect(),
            uploaded: None,
        }
    }
}

impl Drawable for Points {
    fn name(&self) -> &'static str {
        "points"
    }

    fn prepare(&mut self, gpu: Gpu<'_>, shown: DrawInput<'_>) -> PictureChange {
        let options = shown.scene.options;
        let lidar = shown.scene.lidar.filter(|_| options.lidar);
        let points = lidar.map_or(0, fingerprint);
        if self.uploaded == Some(points) {
            return PictureChange::None;
        }
        self.uploaded = Some(points);
        let nothing = LidarSweep::default();
        let (sweep, colors) = lidar.map_or((&nothing, &[][..]), |l| (l.sweep, l.colors));
        let lift_m = match shown.scene.grid.extent().lattice() {
            lattice if lattice.lowered() == 0 => 0.0,
            lattice => lattice.ground_top_m() as f32,
        };
        self.write(gpu, sweep, colors, (f64::from(options.point_px), lift_m))
    }

    fn build(&mut self, gpu: Gpu<'_>, samples: u32) {
        let spec = PipelineSpec {
            shader: "points",
            stride: size_of::<PointVertex>(),
            attributes: &wgpu::vertex_attr_array![0 => Float32x3, 1 => Unorm8x4],
            ..PipelineSpec::OPAQUE
        };
        self.pipelines
            .build(samples, || spec.build(gpu.device, gpu.shared, samples));
    }

    /// Draws the squares in view. A square beyond -1 or 1 in the space of `clip` is out of view: `clip` leaves room for
    /// the discs, see [`Points::reach_px`].
    fn draw(&self, pass: &mut wgpu::RenderPass<'_>, view: &DrawContext<'_>, layer: DrawLayer) {
        if layer != DrawLayer::Opaque || !self.pipelines.set(pass, view) {
            return;
        }
        for square in &self.squares {
            let seen = |p: EgoBounds| may_be_seen(p.low_m, p.high_m, &view.clip);
            if square.part.is_some_and(seen) {
                square.triangles.draw_triangles(pass);
            }
        }
    }

    fn memory_bytes(&self) -> u64 {
        self.squares.iter().map(|s| s.triangles.memory_bytes()).sum()
    }
}

fn fingerprint(lidar: LidarView<'_>) -> u64 {
    let mut hasher = DefaultHasher::new();
    (lidar.sweep.points.len(), lidar.sweep.physical).hash(&mut hasher);
    for p in &lidar.sweep.points {
        hasher.write(bytemuck::cast_slice(&p.position_in_ego));
    }
    hasher.write(lidar.colors.as_flattened());
    hasher.finish()
}

fn square_of([x, y, _]: [f32; 3]) -> usize {
    let along = |v: f32| (v / SQUARE_M + SQUARES as f32 / 2.0).clamp(0.0, SQUARES as f32 - 1.0) as usize;
    along(x) * SQUARES + along(y)
}

impl Points {
    /// How far a disc of `point_px` may reach from the point, px: the triangle around a disc is twice as large as the
    /// disc, and a disc nearby is twice as large as `point_px`.
    pub fn reach_px(point_px: f64) -> f64 {
        4.0 * point_px + 2.0
    }

    /// Uploads the returns; a return without a colour is white, a non-finite one is left out. Returns which part of the
    /// picture changes, with discs of `point_px`.
    fn write(
        &mut self,
        gpu: Gpu<'_>,
        sweep: &LidarSweep,
        colors: &[[u8; 4]],
        (point_px, lift_m): (f64, f32),
    ) -> PictureChange {
        // The ground is drawn where the labels have it, so returns on the physical ground are moved with it.
        let lift_m = if sweep.physical { lift_m } else { 0.0 };
        let at = |[x, y, z]: [f32; 3]| [x, y, z + lift_m];
        let mut squares: Vec<Vec<PointVertex>> = vec![Vec::new(); SQUARES * SQUARES];
        for (i, p) in sweep.points.iter().enumerate() {
            if p.position_in_ego.iter().all(|v| v.is_finite()) {
                let vertex = PointVertex {
                    position_m: at(p.position_in_ego),
                    color: colors.get(i).copied().unwrap_or([255; 4]),
                };
                squares[square_of(vertex.position_m)].extend([vertex; 3]);
            }
        }
        let mut seen = PictureChange::None;
        for (square, vertices) in self.squares.iter_mut().zip(squares) {
            if square.vertices == vertices {
                continue;
            }
            let at = |v: &PointVertex| DVec3::from_array(v.position_m.map(f64::from));
            let part = EgoBounds::around(vertices.iter().map(at));
            for part in [part, square.part].into_iter().flatten() {
                seen.add(PictureChange::part(part, Self::reach_px(point_px)));
            }
            square.triangles.write(gpu.device, gpu.queue, "points", &vertices);
            (square.vertices, square.part) = (vertices, part);
        }
        seen
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
            time_s: 0.0,
            velocity_mps: [0.0; 2],
        };
        let sweep = LidarSweep {
            points: vec![
                point(0.0, 0, Class::Car),
                point(1e9, 31, Class::Free),
                point(f32::NAN, 5, Class::Bus),
            ],
            rays: 3,
            physical: false,
            provenance: Vec::new(),
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
