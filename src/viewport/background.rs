//! The gradient behind the scene.

use super::shared::{PipelineSpec, Shared};

/// Covers what nothing else covered: drawn after the opaque things, at the far end of depth.
pub(super) fn pipeline(device: &wgpu::Device, shared: &Shared, samples: u32) -> wgpu::RenderPipeline {
    PipelineSpec {
        shader: "background",
        depth_write: false,
        ..PipelineSpec::OPAQUE
    }
    .build(device, shared, samples)
}
