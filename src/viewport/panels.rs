//! Draws the panels of the window: triangles with a texture, as egui makes them, by `shaders/panels.wgsl`. For software
//! rasterisers, which take six times as long with egui's own shader.

use super::shaders::SHADERS;

/// A corner of a triangle, as egui lays it out: position and texture coordinate in points and parts, RGBA.
#[repr(C)]
#[derive(Clone, Copy, Debug, bytemuck::Pod, bytemuck::Zeroable)]
pub struct PanelVertex {
    /// Points.
    pub position: [f32; 2],
    /// 0 to 1.
    pub at: [f32; 2],
    /// Premultiplied, gamma-encoded.
    pub color: [u8; 4],
}

const _: () = assert!(size_of::<PanelVertex>() == 20);

/// Part of a frame: triangles of one texture in one rectangle.
#[derive(Clone, Debug, PartialEq)]
pub struct PanelMesh {
    /// Left, top, width, height, pixels, inside the target.
    pub scissor: [u32; 4],
    /// Of the frame's indices.
    pub indices: std::ops::Range<u32>,
    /// What is added to them.
    pub base_vertex: i32,
}

/// Pipeline and buffers.
#[derive(Debug)]
pub struct Panels {
    pipeline: wgpu::RenderPipeline,
    screen: wgpu::Buffer,
    screen_group: wgpu::BindGroup,
    vertices: wgpu::Buffer,
    indices: wgpu::Buffer,
}

fn buffer(device: &wgpu::Device, label: &str, size: u64, usage: wgpu::BufferUsages) -> wgpu::Buffer {
    device.create_buffer(&wgpu::BufferDescriptor {
        label: Some(label),
        size,
        usage: usage | wgpu::BufferUsages::COPY_DST,
        mapped_at_creation: false,
    })
}

fn uniform(size: u64) -> wgpu::BindingType {
    wgpu::BindingType::Buffer {
        ty: wgpu::BufferBindingType::Uniform,
        has_dynamic_offset: false,
        min_binding_size: std::num::NonZeroU64::new(size),
    }
}

impl Panels {
    /// For a target of that format, which must not be sRGB-converting. Textures come as bind groups of egui's renderer:
    /// the layout here is the same entry by entry.
    pub fn new(device: &wgpu::Device, format: wgpu::TextureFormat) -> Self {
        let entry = |binding, visibility, ty| wgpu::BindGroupLayoutEntry {
            binding,
            visibility,
            ty,
            count: None,
        };
        let fragment = wgpu::ShaderStages::FRAGMENT;
        let screen_layout = device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
            label: Some("panels: screen"),
            entries: &[entry(0, wgpu::ShaderStages::VERTEX, uniform(16))],
        });
        let texture = wgpu::BindingType::Texture {
            sample_type: wgpu::TextureSampleType::Float { filterable: true },
            view_dimension: wgpu::TextureViewDimension::D2,
            multisampled: false,
        };
        let sampler = wgpu::BindingType::Sampler(wgpu::SamplerBindingType::Filtering);
        let texture_layout = device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
            label: Some("panels: texture"),
            entries: &[
                entry(0, fragment, texture),
                entry(1, fragment, sampler),
                entry(2, fragment, uniform(16)), // flags that only egui's shader reads
            ],
        });
        let source = SHADERS
            .iter()
            .find(|s| s.name == "panels")
            .map_or("", |s| s.source);
        let module = device.create_shader_module(wgpu::ShaderModuleDescriptor {
            label: Some("panels"),
            source: wgpu::ShaderSource::Wgsl(source.into()),
        });
        let layout = device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
            label: Some("panels"),
            bind_group_layouts: &[Some(&screen_layout), Some(&texture_layout)],
            immediate_size: 0,
        });
        let over = |src_factor, dst_factor| wgpu::BlendComponent {
            src_factor,
            dst_factor,
            operation: wgpu::BlendOperation::Add,
        };
        use wgpu::BlendFactor::{One, OneMinusDstAlpha, OneMinusSrcAlpha};
        let pipeline = device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
            label: Some("panels"),
            layout: Some(&layout),
            vertex: wgpu::VertexState {
                module: &module,
                entry_point: Some("vs_main"),
                buffers: &[Some(wgpu::VertexBufferLayout {
                    array_stride: size_of::<PanelVertex>() as u64,
                    step_mode: wgpu::VertexStepMode::Vertex,
                    attributes: &wgpu::vertex_attr_array![0 => Float32x2, 1 => Float32x2, 2 => Uint32],
                })],
                compilation_options: wgpu::PipelineCompilationOptions::default(),
            },
            primitive: wgpu::PrimitiveState::default(),
            depth_stencil: None,
            multisample: wgpu::MultisampleState::default(),
            fragment: Some(wgpu::FragmentState {
                module: &module,
                entry_point: Some("fs_main"),
                targets: &[Some(wgpu::ColorTargetState {
                    format,
                    blend: Some(wgpu::BlendState {
                        color: over(One, OneMinusSrcAlpha),
                        alpha: over(OneMinusDstAlpha, One),
                    }),
                    write_mask: wgpu::ColorWrites::ALL,
                })],
                compilation_options: wgpu::PipelineCompilationOptions::default(),
            }),
            multiview_mask: None,
            cache: None,
        });
        let screen = buffer(device, "panels: screen", 16, wgpu::BufferUsages::UNIFORM);
        let screen_group = device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: Some("panels: screen"),
            layout: &screen_layout,
            entries: &[wgpu::BindGroupEntry {
                binding: 0,
                resource: screen.as_entire_binding(),
            }],
        });
        Self {
            pipeline,
            screen,
            screen_group,
            vertices: buffer(device, "panels: vertices", 1 << 20, wgpu::BufferUsages::VERTEX),
            indices: buffer(device, "panels: indices", 1 << 19, wgpu::BufferUsages::INDEX),
        }
    }

    /// Brings a frame to the device. `size_points` is that of the window.
    pub fn upload(
        &mut self,
        device: &wgpu::Device,
        queue: &wgpu::Queue,
        size_points: [f32; 2],
        vertices: &[PanelVertex],
        indices: &[u32],
    ) {
        let [w, h] = size_points;
        queue.write_buffer(&self.screen, 0, bytemuck::cast_slice(&[w, h, 0.0, 0.0]));
        let (vertices, indices): (&[u8], &[u8]) =
            (bytemuck::cast_slice(vertices), bytemuck::cast_slice(indices));
        let room = |bytes: &[u8]| (bytes.len() as u64).next_power_of_two();
        if self.vertices.size() < vertices.len() as u64 {
            let usage = wgpu::BufferUsages::VERTEX;
            self.vertices = buffer(device, "panels: vertices", room(vertices), usage);
        }
        if self.indices.size() < indices.len() as u64 {
            let usage = wgpu::BufferUsages::INDEX;
            self.indices = buffer(device, "panels: indices", room(indices), usage);
        }
        queue.write_buffer(&self.vertices, 0, vertices);
        queue.write_buffer(&self.indices, 0, indices);
    }

    /// Draws parts of the frame uploaded last, each with its texture; those without one are left out.
    pub fn draw<'t>(
        &self,
        pass: &mut wgpu::RenderPass<'static>,
        parts: impl Iterator<Item = (&'t PanelMesh, Option<&'t wgpu::BindGroup>)>,
    ) {
        pass.set_pipeline(&self.pipeline);
        pass.set_bind_group(0, &self.screen_group, &[]);
        pass.set_vertex_buffer(0, self.vertices.slice(..));
        pass.set_index_buffer(self.indices.slice(..), wgpu::IndexFormat::Uint32);
        for (mesh, texture) in parts {
            let Some(texture) = texture else { continue };
            let [x, y, width, height] = mesh.scissor;
            pass.set_bind_group(1, texture, &[]);
            pass.set_scissor_rect(x, y, width, height);
            pass.draw_indexed(mesh.indices.clone(), mesh.base_vertex, 0..1);
        }
    }
}
