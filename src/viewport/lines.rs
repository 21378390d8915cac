//! Lines of constant width on screen: boxes, camera frusta, the metre grid.

use bytemuck::{Pod, Zeroable};
use glam::DVec3;

use super::shared::{PipelineSpec, Shared, VertexBuffer};

/// One corner of a line's quad; all four carry the whole line.
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub(super) struct LineVertex {
    from_m: [f32; 3],
    to_m: [f32; 3],
    color: [u8; 4],
    width_pt: f32,
}

const _: () = assert!(size_of::<LineVertex>() == 32);

impl LineVertex {
    /// Both ends, ego frame, m, and the width in points.
    pub fn line(&self) -> ([DVec3; 2], f64) {
        let at = |p: [f32; 3]| DVec3::from_array(p.map(f64::from));
        ([at(self.from_m), at(self.to_m)], f64::from(self.width_pt))
    }
}

/// Lines being collected.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct LineList {
    pub vertices: Vec<LineVertex>,
}

impl LineList {
    /// A line between two points, ego frame, m; colour sRGB with straight alpha. Non-finite ones are left out.
    pub fn add(&mut self, from_m: DVec3, to_m: DVec3, color: [u8; 4], width_pt: f32) {
        let (from, to) = (from_m.as_vec3(), to_m.as_vec3());
        if from.is_finite() && to.is_finite() {
            let vertex = LineVertex {
                from_m: from.to_array(),
                to_m: to.to_array(),
                color,
                width_pt,
            };
            self.vertices.extend([vertex; 4]);
        }
    }

    /// A line through several points.
    pub fn path(&mut self, points_m: &[DVec3], color: [u8; 4], width_pt: f32) {
        for pair in points_m.windows(2) {
            self.add(pair[0], pair[1], color, width_pt);
        }
    }
}

/// Lines on the device: those of the first list show through what hides them, faintly.
#[derive(Debug, Default)]
pub(super) struct Lines {
    see_through: VertexBuffer,
    plain: VertexBuffer,
}

impl Lines {
    /// The pipeline of what is in sight (`hidden` false) or behind something (true).
    pub fn pipeline(
        device: &wgpu::Device,
        shared: &Shared,
        samples: u32,
        hidden: bool,
    ) -> wgpu::RenderPipeline {
        PipelineSpec {
            shader: "lines",
            fragment: if hidden { "fs_hidden" } else { "fs_main" },
            stride: size_of::<LineVertex>(),
            attributes: &wgpu::vertex_attr_array![
                0 => Float32x3, 1 => Float32x3, 2 => Unorm8x4, 3 => Float32
            ],
            blend: true,
            depth_write: false,
            depth_compare: if hidden {
                wgpu::CompareFunction::Less
            } else {
                wgpu::CompareFunction::GreaterEqual
            },
            ..PipelineSpec::OPAQUE
        }
        .build(device, shared, samples)
    }

    pub fn write(
        &mut self,
        device: &wgpu::Device,
        queue: &wgpu::Queue,
        see_through: &LineList,
        plain: &LineList,
    ) {
        self.see_through
            .write(device, queue, "lines", &see_through.vertices);
        self.plain.write(device, queue, "plain lines", &plain.vertices);
    }

    pub fn draw_plain(&self, pass: &mut wgpu::RenderPass<'_>, shared: &Shared) {
        self.plain.draw_quads(pass, shared, 0..self.plain.quads());
    }

    pub fn draw_see_through(&self, pass: &mut wgpu::RenderPass<'_>, shared: &Shared) {
        self.see_through
            .draw_quads(pass, shared, 0..self.see_through.quads());
    }
}
