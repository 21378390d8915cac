//! Translucent rectangles: cells under the brush, fills of boxes, the soft shadow of the ego vehicle.

use bytemuck::{Pod, Zeroable};
use glam::DVec3;

use super::shared::{PipelineSpec, Shared, VertexBuffer};

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

/// Rectangles on the device.
#[derive(Debug, Default)]
pub(super) struct Faces {
    quads: VertexBuffer,
}

impl Faces {
    pub fn pipeline(device: &wgpu::Device, shared: &Shared, samples: u32) -> wgpu::RenderPipeline {
        PipelineSpec {
            shader: "faces",
            stride: size_of::<FaceVertex>(),
            attributes: &wgpu::vertex_attr_array![0 => Float32x4, 1 => Unorm8x4],
            blend: true,
            depth_write: false,
            ..PipelineSpec::OPAQUE
        }
        .build(device, shared, samples)
    }

    pub fn write(&mut self, device: &wgpu::Device, queue: &wgpu::Queue, list: &FaceList) {
        self.quads.write(device, queue, "faces", &list.vertices);
    }

    pub fn draw(&self, pass: &mut wgpu::RenderPass<'_>, shared: &Shared) {
        self.quads.draw_quads(pass, shared, 0..self.quads.quads());
    }
}
