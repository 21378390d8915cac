//! Lines of constant width on screen: boxes, camera frusta, the metre grid.

use bytemuck::{Pod, Zeroable};
use glam::DVec3;

use super::change::PictureChange;
use super::drawable::{DrawContext, DrawInput, DrawLayer, Drawable, Gpu, Pipelines};
use super::marks::{differing, marked};
use super::shared::{PipelineSpec, VertexBuffer};

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
    /// The two ends, ego frame, m, and the width in points.
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

/// Drawable of lines: those of the first list show faintly through the things that hide them.
#[derive(Debug, Default)]
pub(super) struct Lines {
    in_sight: Pipelines,
    covered: Pipelines,
    lists: [LineList; 2], // see-through, plain, as uploaded
    see_through: VertexBuffer,
    plain: VertexBuffer,
}

/// The pipeline of lines in sight (`covered` false) or behind things (true).
fn spec(covered: bool) -> PipelineSpec<'static> {
    const ATTRIBUTES: [wgpu::VertexAttribute; 4] = wgpu::vertex_attr_array![
        0 => Float32x3, 1 => Float32x3, 2 => Unorm8x4, 3 => Float32
    ];
    PipelineSpec {
        shader: "lines",
        fragment: if covered { "fs_hidden" } else { "fs_main" },
        stride: size_of::<LineVertex>(),
        attributes: &ATTRIBUTES,
        blend: true,
        depth_write: false,
        depth_compare: match covered {
            true => wgpu::CompareFunction::Less,
            false => wgpu::CompareFunction::GreaterEqual,
        },
        ..PipelineSpec::OPAQUE
    }
}

impl Drawable for Lines {
    fn name(&self) -> &'static str {
        "lines"
    }

    fn prepare(&mut self, gpu: Gpu<'_>, shown: DrawInput<'_>) -> PictureChange {
        let px = f64::from(shown.scene.options.pixels_per_point);
        let lists = [&shown.marks.see_through, &shown.marks.plain];
        let buffers = [(&mut self.see_through, "lines"), (&mut self.plain, "plain lines")];
        let mut seen = PictureChange::None;
        for ((list, held), (buffer, label)) in lists.into_iter().zip(&mut self.lists).zip(buffers) {
            if list == held {
                continue;
            }
            let differing = differing(&list.vertices, &held.vertices);
            let width_pt = differing.iter().map(|v| v.line().1).fold(0.0, f64::max);
            let ends = differing.iter().flat_map(|v| v.line().0);
            seen.add(marked(ends, width_pt * px + 2.0));
            buffer.write(gpu.device, gpu.queue, label, &list.vertices);
            *held = list.clone();
        }
        seen
    }

    fn build(&mut self, gpu: Gpu<'_>, samples: u32) {
        for (pipelines, covered) in [(&mut self.in_sight, false), (&mut self.covered, true)] {
            pipelines.build(samples, || spec(covered).build(gpu.device, gpu.shared, samples));
        }
    }

    fn draw(&self, pass: &mut wgpu::RenderPass<'_>, view: &DrawContext<'_>, layer: DrawLayer) {
        let all = |pass: &mut wgpu::RenderPass<'_>, lines: &VertexBuffer| {
            lines.draw_quads(pass, view.shared, 0..lines.quads());
        };
        match layer {
            DrawLayer::Covered if self.covered.set(pass, view) => all(pass, &self.see_through),
            DrawLayer::Lines if self.in_sight.set(pass, view) => {
                all(pass, &self.plain);
                all(pass, &self.see_through);
            }
            _ => {}
        }
    }

    fn memory_bytes(&self) -> u64 {
        self.see_through.memory_bytes() + self.plain.memory_bytes()
    }

    fn quads(&self) -> usize {
        (self.see_through.quads() + self.plain.quads()) as usize
    }
}
