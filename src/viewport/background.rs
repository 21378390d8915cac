//! The gradient behind the scene, and the nothing that a part of the picture is drawn again upon.

use super::shared::{PipelineSpec, Shared};

/// Makes all pixels, within the scissors, as if nothing had been drawn.
pub(super) fn eraser(device: &wgpu::Device, shared: &Shared, samples: u32) -> wgpu::RenderPipeline {
    PipelineSpec {
        shader: "background",
        fragment: "fs_nothing",
        depth_compare: wgpu::CompareFunction::Always,
        ..PipelineSpec::OPAQUE
    }
    .build(device, shared, samples)
}

/// Covers what nothing else covered: drawn after the opaque things, at the far end of depth.
pub(super) fn pipeline(device: &wgpu::Device, shared: &Shared, samples: u32) -> wgpu::RenderPipeline {
    PipelineSpec {
        shader: "background",
        depth_write: false,
        ..PipelineSpec::OPAQUE
    }
    .build(device, shared, samples)
}
