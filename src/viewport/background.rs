//! The gradient behind the scene, and the clearing of a part of the picture that is drawn again.

use super::Background;
use super::change::PictureChange;
use super::drawable::{DrawContext, DrawInput, DrawLayer, Drawable, Gpu, Pipelines};
use super::shared::PipelineSpec;

/// Drawable of the background behind everything.
#[derive(Debug, Default)]
pub(super) struct Backdrop {
    eraser: Pipelines,
    gradient: Pipelines,
}

impl Drawable for Backdrop {
    fn name(&self) -> &'static str {
        "background"
    }

    fn prepare(&mut self, _gpu: Gpu<'_>, _shown: DrawInput<'_>) -> PictureChange {
        PictureChange::None // it is in the uniforms
    }

    fn build(&mut self, gpu: Gpu<'_>, samples: u32) {
        // Clears all pixels within the scissors, as if nothing had been drawn.
        let eraser = PipelineSpec {
            shader: "background",
            fragment: "fs_nothing",
            depth_compare: wgpu::CompareFunction::Always,
            ..PipelineSpec::OPAQUE
        };
        // Covers the pixels that nothing else covered, at the far end of depth.
        let gradient = PipelineSpec {
            shader: "background",
            depth_write: false,
            ..PipelineSpec::OPAQUE
        };
        self.eraser
            .build(samples, || eraser.build(gpu.device, gpu.shared, samples));
        self.gradient
            .build(samples, || gradient.build(gpu.device, gpu.shared, samples));
    }

    fn draw(&self, pass: &mut wgpu::RenderPass<'_>, view: &DrawContext<'_>, layer: DrawLayer) {
        let drawn = match layer {
            DrawLayer::Erase => view.part && self.eraser.set(pass, view),
            DrawLayer::Backdrop => {
                view.options.background != Background::Transparent && self.gradient.set(pass, view)
            }
            _ => false,
        };
        if drawn {
            pass.draw(0..3, 0..1);
        }
    }

    fn memory_bytes(&self) -> u64 {
        0
    }
}
