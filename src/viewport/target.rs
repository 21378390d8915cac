//! The picture drawn into: colour, depth and, for smooth edges, their multisampled twins.

use super::shared::{COLOR_FORMAT, DEPTH_FORMAT};

/// Own colour and depth target; egui's pass has no depth.
#[derive(Debug)]
pub(super) struct RenderTarget {
    pub size: [u32; 2],
    pub samples: u32,
    pub color: wgpu::Texture,
    pub color_view: wgpu::TextureView,
    multisampled: Option<wgpu::TextureView>,
    depth: wgpu::TextureView,
}

impl RenderTarget {
    /// `size` in pixels, each side at least 1 and within the device's limit; `samples` 1 or 4.
    pub fn new(device: &wgpu::Device, size: [u32; 2], samples: u32) -> Self {
        let texture = |label, format, sample_count, usage| {
            device.create_texture(&wgpu::TextureDescriptor {
                label: Some(label),
                size: wgpu::Extent3d {
                    width: size[0],
                    height: size[1],
                    depth_or_array_layers: 1,
                },
                mip_level_count: 1,
                sample_count,
                dimension: wgpu::TextureDimension::D2,
                format,
                usage: wgpu::TextureUsages::RENDER_ATTACHMENT | usage,
                view_formats: &[],
            })
        };
        let view = |t: &wgpu::Texture| t.create_view(&wgpu::TextureViewDescriptor::default());
        let none = wgpu::TextureUsages::empty();
        let color = texture(
            "viewport color",
            COLOR_FORMAT,
            1,
            wgpu::TextureUsages::TEXTURE_BINDING | wgpu::TextureUsages::COPY_SRC,
        );
        Self {
            size,
            samples,
            color_view: view(&color),
            multisampled: (samples > 1)
                .then(|| view(&texture("viewport multisampled", COLOR_FORMAT, samples, none))),
            depth: view(&texture("viewport depth", DEPTH_FORMAT, samples, none)),
            color,
        }
    }

    /// True if the last drawing is kept, colour and depth: with one sample a pixel.
    pub fn keeps(&self) -> bool {
        self.multisampled.is_none()
    }

    /// Starts a pass that clears colour and depth, or continues on the kept ones.
    pub fn begin<'e>(&self, encoder: &'e mut wgpu::CommandEncoder, go_on: bool) -> wgpu::RenderPass<'e> {
        let go_on = go_on && self.keeps();
        let (view, resolve_target) = match &self.multisampled {
            Some(multisampled) => (multisampled, Some(&self.color_view)),
            None => (&self.color_view, None),
        };
        encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some("viewport"),
            color_attachments: &[Some(wgpu::RenderPassColorAttachment {
                view,
                depth_slice: None,
                resolve_target,
                ops: wgpu::Operations {
                    load: match go_on {
                        true => wgpu::LoadOp::Load,
                        false => wgpu::LoadOp::Clear(wgpu::Color::TRANSPARENT),
                    },
                    store: if resolve_target.is_some() {
                        wgpu::StoreOp::Discard
                    } else {
                        wgpu::StoreOp::Store
                    },
                },
            })],
            depth_stencil_attachment: Some(wgpu::RenderPassDepthStencilAttachment {
                view: &self.depth,
                depth_ops: Some(wgpu::Operations {
                    load: match go_on {
                        true => wgpu::LoadOp::Load,
                        false => wgpu::LoadOp::Clear(0.0),
                    },
                    store: match self.keeps() {
                        true => wgpu::StoreOp::Store,
                        false => wgpu::StoreOp::Discard,
                    },
                }),
                stencil_ops: None,
            }),
            timestamp_writes: None,
            occlusion_query_set: None,
            multiview_mask: None,
        })
    }
}
