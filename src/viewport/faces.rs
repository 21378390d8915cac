//! Translucent rectangles: cells under the brush, fills of boxes, the soft shadow of the ego vehicle.

use bytemuck::{Pod, Zeroable};
use glam::DVec3;

use super::change::PictureChange;
use super::drawable::{DrawContext, DrawInput, DrawLayer, Drawable, Gpu, Pipelines};
use super::marks::{differing, marked};
use super::shared::{PipelineSpec, VertexBuffer};

/// How a rectangle is filled; the value goes to the shader.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum FaceStyle {
    /// Evenly.
    Plain = 0,
    /// With a brighter rim.
    Rim = 1,
    /// Fading out toward its border.
    Blob = 2,
}

#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub(super) struct FaceVertex {
    p_style: [f32; 4],
    color: [u8; 4],
}

const _: () = assert!(size_of::<FaceVertex>() == 20);

impl FaceVertex {
    /// Ego frame, m.
    pub fn position_m(&self) -> DVec3 {
        let [x, y, z, _] = self.p_style.map(f64::from);
        DVec3::new(x, y, z)
    }
}

/// Rectangles being collected.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct FaceList {
    pub vertices: Vec<FaceVertex>,
}

impl FaceList {
    /// A rectangle by its corners in order, ego frame, m; colour sRGB with straight alpha.
    pub fn add(&mut self, corners_m: [DVec3; 4], color: [u8; 4], style: FaceStyle) {
        if corners_m.iter().all(|c| c.as_vec3().is_finite()) {
            self.vertices.extend(corners_m.map(|c| FaceVertex {
                p_style: c.as_vec3().extend(style as u8 as f32).to_array(),
                color,
            }));
        }
    }
}

/// Drawable of translucent rectangles.
#[derive(Debug, Default)]
pub(super) struct Faces {
    pipelines: Pipelines,
    list: FaceList, // as uploaded
    quads: VertexBuffer,
}

impl Drawable for Faces {
    fn name(&self) -> &'static str {
        "faces"
    }

    fn prepare(&mut self, gpu: Gpu<'_>, shown: DrawInput<'_>) -> PictureChange {
        let list = &shown.marks.faces;
        if *list == self.list {
            return PictureChange::None;
        }
        let differing = differing(&list.vertices, &self.list.vertices);
        self.quads.write(gpu.device, gpu.queue, "faces", &list.vertices);
        self.list = list.clone();
        marked(differing.iter().map(|v| v.position_m()), 2.0)
    }

    fn build(&mut self, gpu: Gpu<'_>, samples: u32) {
        let spec = PipelineSpec {
            shader: "faces",
            stride: size_of::<FaceVertex>(),
            attributes: &wgpu::vertex_attr_array![0 => Float32x4, 1 => Unorm8x4],
            blend: true,
            depth_write: false,
            ..PipelineSpec::OPAQUE
        };
        self.pipelines
            .build(samples, || spec.build(gpu.device, gpu.shared, samples));
    }

    fn draw(&self, pass: &mut wgpu::RenderPass<'_>, view: &DrawContext<'_>, layer: DrawLayer) {
        if layer == DrawLayer::Fills && self.pipelines.set(pass, view) {
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
