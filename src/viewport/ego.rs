//! The ego vehicle: a car one recognises, from a few dozen flat faces.

use bytemuck::{Pod, Zeroable};
use glam::DVec3;

use super::change::PictureChange;
use super::drawable::{DrawContext, DrawInput, DrawLayer, Drawable, Gpu, Pipelines};
use super::options::drop_m;
use super::shared::{PipelineSpec, VertexBuffer};
use scene::{Pose, SensorRig};

#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub(super) struct EgoVertex {
    position_m: [f32; 3],
    normal: [i8; 4],
    color: [u8; 4],
}

const _: () = assert!(size_of::<EgoVertex>() == 20);

const BODY: [u8; 3] = [236, 238, 242];
const GLASS: [u8; 3] = [58, 68, 82];
const TRIM: [u8; 3] = [52, 55, 62];
const TYRE: [u8; 3] = [38, 39, 43];
const HEADLIGHT: [u8; 3] = [255, 246, 214];
const TAIL_LIGHT: [u8; 3] = [226, 62, 56];

/// Drawable of the ego vehicle.
#[derive(Debug, Default)]
pub(super) struct Ego {
    pipelines: Pipelines,
    quads: VertexBuffer,
    uploaded: Option<(SensorRig, u64)>, // with the bits of how much lower it is drawn
}

impl Drawable for Ego {
    fn name(&self) -> &'static str {
        "ego"
    }

    fn prepare(&mut self, gpu: Gpu<'_>, shown: DrawInput<'_>) -> PictureChange {
        let (rig, options) = (shown.scene.rig, shown.scene.options);
        let drop_m = drop_m(shown.scene.grid.extent().lattice(), options);
        let lowered = drop_m.to_bits();
        let held = self.uploaded.as_ref().map(|(rig, lowered)| (rig, *lowered));
        if held == Some((rig, lowered)) {
            return PictureChange::None;
        }
        let vertices = car(rig, drop_m);
        self.quads.write(gpu.device, gpu.queue, "ego", &vertices);
        self.uploaded = Some((rig.clone(), lowered));
        PictureChange::All
    }

    fn build(&mut self, gpu: Gpu<'_>, samples: u32) {
        let spec = PipelineSpec {
            shader: "ego",
            stride: size_of::<EgoVertex>(),
            attributes: &wgpu::vertex_attr_array![0 => Float32x3, 1 => Snorm8x4, 2 => Unorm8x4],
            ..PipelineSpec::OPAQUE
        };
        self.pipelines
            .build(samples, || spec.build(gpu.device, gpu.shared, samples));
    }

    fn draw(&self, pass: &mut wgpu::RenderPass<'_>, view: &DrawContext<'_>, layer: DrawLayer) {
        if layer == DrawLayer::Opaque && view.options.ego && self.pipelines.set(pass, view) {
            self.quads.draw_quads(pass, view.shared, 0..self.quads.quads());
        }
    }

    fn memory_bytes(&self) -> u64 {
        self.quads.memory_bytes()
    }

    fn quads(&self) -> usize {
        self.quads.quads() as usize
    }
}

/// Length, width, height of the vehicle and the middle of its footprint, m; odd rigs give a usual car.
pub(super) fn measures(rig: &SensorRig) -> (DVec3, DVec3) {
    let size = DVec3::from_array(rig.ego_size_m);
    let center = DVec3::from_array(rig.ego_center_m);
    let sound = size.is_finite() && size.min_element() > 0.1 && size.max_element() < 50.0;
    (
        if sound { size } else { DVec3::new(4.08, 1.73, 1.56) },
        if center.is_finite() { center } else { DVec3::ZERO },
    )
}

struct EgoMeshBuilder {
    size: DVec3,
    base: DVec3,
    vertices: Vec<EgoVertex>,
}

/// The mesh stands `drop_m` below the physical ground.
fn car(rig: &SensorRig, drop_m: f64) -> Vec<EgoVertex> {
    let (size, center) = measures(rig);
    let mut b = EgoMeshBuilder {
        size,
        base: DVec3::new(center.x, center.y, -drop_m),
        vertices: Vec::new(),
    };
    // Positions as shares of length (-.5 rear to .5 front), width and height.
    b.solid(
        [-0.5, 0.5],
        [0.19, 0.46],
        [-0.5, 0.5],
        [0.48, 0.48],
        0.46,
        BODY,
        BODY,
    );
    b.solid(
        [-0.5, 0.5],
        [0.46, 0.58],
        [-0.49, 0.47],
        [0.46, 0.44],
        0.44,
        BODY,
        BODY,
    );
    b.solid(
        [-0.47, 0.24],
        [0.58, 0.96],
        [-0.36, 0.05],
        [0.43, 0.36],
        0.36,
        GLASS,
        BODY,
    );
    b.solid(
        [-0.36, 0.05],
        [0.96, 1.0],
        [-0.34, 0.03],
        [0.36, 0.33],
        0.33,
        BODY,
        BODY,
    );
    b.solid(
        [-0.505, 0.505],
        [0.15, 0.27],
        [-0.505, 0.505],
        [0.485, 0.485],
        0.47,
        TRIM,
        TRIM,
    );
    for side in [-1.0, 1.0] {
        for at in [-0.305, 0.315] {
            b.wheel(at, side);
        }
        b.lamp(0.5, side, HEADLIGHT);
        b.lamp(-0.5, side, TAIL_LIGHT);
    }
    b.place(&rig.vehicle);
    b.vertices
}

impl EgoMeshBuilder {
    /// Moves the built vehicle to where the vehicle is.
    fn place(&mut self, vehicle: &Pose) {
        if *vehicle == Pose::IDENTITY {
            return;
        }
        for v in &mut self.vertices {
            let p = glam::Vec3::from_array(v.position_m).as_dvec3();
            v.position_m = vehicle.apply(p).as_vec3().to_array();
            let [x, y, z, w] = v.normal;
            let n = vehicle.rotation * DVec3::new(f64::from(x), f64::from(y), f64::from(z));
            let [x, y, z] = n.to_array().map(|v| v.round() as i8);
            v.normal = [x, y, z, w];
        }
    }

    fn at(&self, x: f64, y: f64, z: f64) -> DVec3 {
        self.base + DVec3::new(x, y, z) * self.size
    }

    fn quad(&mut self, corners: [DVec3; 4], color: [u8; 3]) {
        let normal = (corners[1] - corners[0])
            .cross(corners[3] - corners[0])
            .normalize_or_zero();
        let [x, y, z] = (normal * 127.0).to_array().map(|v| v.round() as i8);
        let [r, g, b] = color;
        self.vertices.extend(corners.map(|c| EgoVertex {
            position_m: c.as_vec3().to_array(),
            normal: [x, y, z, 0],
            color: [r, g, b, 255],
        }));
    }

    /// A block that may taper: `x` and `y_half` below, `x_top` and `y_top` above, over the heights `z`.
    #[expect(
        clippy::too_many_arguments,
        reason = "a table of numbers reads best on one line"
    )]
    fn solid(
        &mut self,
        x: [f64; 2],
        z: [f64; 2],
        x_top: [f64; 2],
        y_half: [f64; 2],
        y_top: f64,
        sides: [u8; 3],
        top: [u8; 3],
    ) {
        // y_half: at the rear and at the front of the lower edge.
        let low = [
            self.at(x[1], y_half[1], z[0]),
            self.at(x[0], y_half[0], z[0]),
            self.at(x[0], -y_half[0], z[0]),
            self.at(x[1], -y_half[1], z[0]),
        ];
        let high = [
            self.at(x_top[1], y_top, z[1]),
            self.at(x_top[0], y_top, z[1]),
            self.at(x_top[0], -y_top, z[1]),
            self.at(x_top[1], -y_top, z[1]),
        ];
        for i in 0..4 {
            let j = (i + 1) % 4;
            self.quad([low[i], low[j], high[j], high[i]], sides);
        }
        self.quad(high, top);
        self.quad([low[3], low[2], low[1], low[0]], TRIM);
    }

    /// An octagonal wheel on one side.
    fn wheel(&mut self, at: f64, side: f64) {
        let radius = 0.205 * self.size.z;
        let center = self.at(at, side * 0.44, 0.0) + DVec3::Z * radius;
        let half = DVec3::Y * (0.055 * self.size.y);
        let rim = |i: usize| {
            let (s, c) = ((i as f64 + 0.5) * std::f64::consts::TAU / 8.0).sin_cos();
            DVec3::new(c, 0.0, s) * radius
        };
        for i in 0..8 {
            let (a, b) = (center + rim(i), center + rim(i + 1));
            self.quad([a - half, a + half, b + half, b - half], TYRE);
        }
        for face in [-1.0, 1.0] {
            let disc = |scale: f64, out: f64, i: usize| center + rim(i) * scale + half * (face * out);
            let mut fan = |scale: f64, out: f64, color| {
                for i in [0, 2, 4, 6] {
                    let (a, b, c) = (
                        disc(scale, out, i),
                        disc(scale, out, i + 1),
                        disc(scale, out, i + 2),
                    );
                    let m = center + half * (face * out);
                    let corners = if face < 0.0 { [m, a, b, c] } else { [m, c, b, a] };
                    self.quad(corners, color);
                }
            };
            fan(1.0, 1.0, TYRE);
            fan(0.55, 1.05, [150, 153, 160]);
        }
    }

    fn lamp(&mut self, end: f64, side: f64, color: [u8; 3]) {
        let x = end * 1.004;
        let (y0, y1) = (side * 0.30, side * 0.45);
        let (z0, z1) = (0.36, 0.45);
        let corners = [
            self.at(x, y0, z0),
            self.at(x, y1, z0),
            self.at(x, y1, z1),
            self.at(x, y0, z1),
        ];
        let outward = (corners[1] - corners[0]).cross(corners[3] - corners[0]).x * end > 0.0;
        let [a, b, c, d] = corners;
        self.quad(if outward { corners } else { [a, d, c, b] }, color);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_car_fits_its_measures_and_faces_outward() {
        let rig = SensorRig::default();
        let (size, center) = measures(&rig);
        let vertices = car(&rig, 0.6);
        let middle = DVec3::new(center.x, center.y, size.z / 2.0 - 0.6);
        for v in &vertices {
            let p = glam::Vec3::from_array(v.position_m).as_dvec3() - middle;
            assert!(
                p.abs().cmple(size * 0.51).all(),
                "{p} is outside of a car of {size}"
            );
            let n = v.normal;
            assert!(n[0] != 0 || n[1] != 0 || n[2] != 0);
        }
        // The roof looks up.
        let top = vertices
            .iter()
            .max_by(|a, b| a.position_m[2].total_cmp(&b.position_m[2]))
            .expect("not empty");
        assert!(
            vertices
                .iter()
                .any(|v| v.position_m[2] == top.position_m[2] && v.normal[2] > 100)
        );
        let odd = SensorRig {
            ego_size_m: [f64::NAN, 0.0, 1e9],
            ego_center_m: [f64::INFINITY; 3],
            ..rig
        };
        assert!(
            car(&odd, 0.0)
                .iter()
                .all(|v| v.position_m.iter().all(|c| c.is_finite()))
        );
    }
}
