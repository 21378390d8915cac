//! Draws the meshes of the window's UI: triangles with a texture, as egui makes them, by `shaders/ui_mesh.wgsl`. For software
//! rasterisers, which take six times as long with egui's own shader.

use super::shaders::SHADERS;

/// A corner of a triangle, as egui lays it out: position and texture coordinate in points and parts, RGBA.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, bytemuck::Pod, bytemuck::Zeroable)]
pub struct UiVertex {
    /// Points.
    pub position: [f32; 2],
    /// 0 to 1.
    pub at: [f32; 2],
    /// Premultiplied, gamma-encoded.
    pub color: [u8; 4],
}

const _: () = assert!(size_of::<UiVertex>() == 20);

/// Part of a frame: triangles of one texture in one rectangle.
#[derive(Clone, Debug, PartialEq)]
pub struct UiMesh {
    /// Left, top, width, height, pixels, inside the target.
    pub scissor: [u32; 4],
    /// Range of the frame's indices.
    pub indices: std::ops::Range<u32>,
    /// Number that is added to each index.
    pub base_vertex: i32,
}

/// Pipelines, buffers, and the picture of the window.
#[derive(Debug)]
pub struct UiPainter {
    pipeline: wgpu::RenderPipeline,
    wipe: wgpu::RenderPipeline,
    copy: wgpu::RenderPipeline,
    screen: wgpu::Buffer,
    screen_group: wgpu::BindGroup,
    texture_layout: wgpu::BindGroupLayout,
    sampler: wgpu::Sampler,
    vertices: wgpu::Buffer,
    indices: wgpu::Buffer,
    format: wgpu::TextureFormat,
    canvas: Option<UiPicture>,
}

/// The picture that the window shows, kept here because the target of a frame does not keep the last one.
#[derive(Debug)]
struct UiPicture {
    size: [u32; 2],
    view: wgpu::TextureView,
    group: wgpu::BindGroup,
}

/// Size of the uniforms, bytes: width and height of the window in points, two unused, the colour behind everything.
const SCREEN_BYTES: u64 = 32;

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

/// Layouts of what the shader binds: the uniforms of the window, and a texture as egui's renderer binds it.
struct Layouts {
    screen: wgpu::BindGroupLayout,
    texture: wgpu::BindGroupLayout,
}

impl Layouts {
    fn new(device: &wgpu::Device) -> Self {
        let entry = |binding, visibility, ty| wgpu::BindGroupLayoutEntry {
            binding,
            visibility,
            ty,
            count: None,
        };
        let (both, fragment) = (wgpu::ShaderStages::VERTEX_FRAGMENT, wgpu::ShaderStages::FRAGMENT);
        let texture = wgpu::BindingType::Texture {
            sample_type: wgpu::TextureSampleType::Float { filterable: true },
            view_dimension: wgpu::TextureViewDimension::D2,
            multisampled: false,
        };
        let sampler = wgpu::BindingType::Sampler(wgpu::SamplerBindingType::Filtering);
        Self {
            screen: device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
                label: Some("ui: screen"),
                entries: &[entry(0, both, uniform(SCREEN_BYTES))],
            }),
            texture: device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
                label: Some("ui: texture"),
                entries: &[
                    entry(0, fragment, texture),
                    entry(1, fragment, sampler),
                    entry(2, fragment, uniform(16)), // flags that only egui's shader reads
                ],
            }),
        }
    }
}

/// The pipelines that wipe a rectangle, copy the picture and draw meshes.
fn pipelines(
    device: &wgpu::Device,
    format: wgpu::TextureFormat,
    layouts: &Layouts,
) -> [wgpu::RenderPipeline; 3] {
    let source = SHADERS
        .iter()
        .find(|s| s.name == "ui_mesh")
        .map_or("", |s| s.source);
    let module = device.create_shader_module(wgpu::ShaderModuleDescriptor {
        label: Some("ui_mesh"),
        source: wgpu::ShaderSource::Wgsl(source.into()),
    });
    let layout = |label, bind_group_layouts: &[Option<&wgpu::BindGroupLayout>]| {
        device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
            label: Some(label),
            bind_group_layouts,
            immediate_size: 0,
        })
    };
    let plain = layout("ui: wipe", &[Some(&layouts.screen)]);
    let textured = layout("ui_mesh", &[Some(&layouts.screen), Some(&layouts.texture)]);
    let over = |src_factor, dst_factor| wgpu::BlendComponent {
        src_factor,
        dst_factor,
        operation: wgpu::BlendOperation::Add,
    };
    use wgpu::BlendFactor::{One, OneMinusDstAlpha, OneMinusSrcAlpha};
    let blend = wgpu::BlendState {
        color: over(One, OneMinusSrcAlpha),
        alpha: over(OneMinusDstAlpha, One),
    };
    let vertices = [Some(wgpu::VertexBufferLayout {
        array_stride: size_of::<UiVertex>() as u64,
        step_mode: wgpu::VertexStepMode::Vertex,
        attributes: &wgpu::vertex_attr_array![0 => Float32x2, 1 => Float32x2, 2 => Uint32],
    })];
    let pipeline = |vertex, fragment, blend: Option<wgpu::BlendState>| {
        device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
            label: Some(fragment),
            layout: Some(if fragment == "fs_wipe" { &plain } else { &textured }),
            vertex: wgpu::VertexState {
                module: &module,
                entry_point: Some(vertex),
                buffers: if blend.is_some() { &vertices } else { &[] },
                compilation_options: wgpu::PipelineCompilationOptions::default(),
            },
            primitive: wgpu::PrimitiveState::default(),
            depth_stencil: None,
            multisample: wgpu::MultisampleState::default(),
            fragment: Some(wgpu::FragmentState {
                module: &module,
                entry_point: Some(fragment),
                targets: &[Some(wgpu::ColorTargetState {
                    format,
                    blend,
                    write_mask: wgpu::ColorWrites::ALL,
                })],
                compilation_options: wgpu::PipelineCompilationOptions::default(),
            }),
            multiview_mask: None,
            cache: None,
        })
    };
    [
        pipeline("vs_all", "fs_wipe", None),
        pipeline("vs_all", "fs_copy", None),
        pipeline("vs_main", "fs_main", Some(blend)),
    ]
}

impl UiPainter {
    /// For a target of that format, which must not be sRGB-converting. Textures come as bind groups of egui's renderer,
    /// so the layout here equals its layout entry by entry.
    pub fn new(device: &wgpu::Device, format: wgpu::TextureFormat) -> Self {
        let layouts = Layouts::new(device);
        let [wipe, copy, pipeline] = pipelines(device, format, &layouts);
        let screen = buffer(device, "ui: screen", SCREEN_BYTES, wgpu::BufferUsages::UNIFORM);
        let screen_group = device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: Some("ui: screen"),
            layout: &layouts.screen,
            entries: &[wgpu::BindGroupEntry {
                binding: 0,
                resource: screen.as_entire_binding(),
            }],
        });
        Self {
            pipeline,
            wipe,
            copy,
            screen,
            screen_group,
            texture_layout: layouts.texture,
            sampler: device.create_sampler(&wgpu::SamplerDescriptor::default()),
            vertices: buffer(device, "ui: vertices", 1 << 20, wgpu::BufferUsages::VERTEX),
            indices: buffer(device, "ui: indices", 1 << 19, wgpu::BufferUsages::INDEX),
            format,
            canvas: None,
        }
    }

    /// Brings a frame to the device: vertices and indices. `size_points` is that of the window, `clear` the colour behind
    /// everything, gamma-encoded.
    pub fn upload(
        &mut self,
        device: &wgpu::Device,
        queue: &wgpu::Queue,
        size_points: [f32; 2],
        clear: [f32; 4],
        (vertices, indices): (&[UiVertex], &[u32]),
    ) {
        let ([w, h], [r, g, b, a]) = (size_points, clear);
        let screen = [w, h, 0.0, 0.0, r, g, b, a];
        queue.write_buffer(&self.screen, 0, bytemuck::cast_slice(&screen));
        let (vertices, indices): (&[u8], &[u8]) =
            (bytemuck::cast_slice(vertices), bytemuck::cast_slice(indices));
        let room = |bytes: &[u8]| (bytes.len() as u64).next_power_of_two();
        if self.vertices.size() < vertices.len() as u64 {
            let usage = wgpu::BufferUsages::VERTEX;
            self.vertices = buffer(device, "ui: vertices", room(vertices), usage);
        }
        if self.indices.size() < indices.len() as u64 {
            let usage = wgpu::BufferUsages::INDEX;
            self.indices = buffer(device, "ui: indices", room(indices), usage);
        }
        queue.write_buffer(&self.vertices, 0, vertices);
        queue.write_buffer(&self.indices, 0, indices);
    }

    /// Makes the picture as large as the window, pixels; true if it is a new one that is still empty.
    pub fn fit(&mut self, device: &wgpu::Device, size: [u32; 2]) -> bool {
        let size = size.map(|s| s.max(1));
        if self.canvas.as_ref().is_some_and(|c| c.size == size) {
            return false;
        }
        let usage = wgpu::TextureUsages::RENDER_ATTACHMENT | wgpu::TextureUsages::TEXTURE_BINDING;
        let texture = device.create_texture(&wgpu::TextureDescriptor {
            label: Some("window"),
            size: wgpu::Extent3d {
                width: size[0],
                height: size[1],
                depth_or_array_layers: 1,
            },
            mip_level_count: 1,
            sample_count: 1,
            dimension: wgpu::TextureDimension::D2,
            format: self.format,
            usage,
            view_formats: &[],
        });
        let view = texture.create_view(&wgpu::TextureViewDescriptor::default());
        let entry = |binding, resource| wgpu::BindGroupEntry { binding, resource };
        let group = device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: Some("window"),
            layout: &self.texture_layout,
            entries: &[
                entry(0, wgpu::BindingResource::TextureView(&view)),
                entry(1, wgpu::BindingResource::Sampler(&self.sampler)),
                entry(2, self.screen.as_entire_binding()),
            ],
        });
        self.canvas = Some(UiPicture { size, view, group });
        true
    }

    /// Draws some rectangles of the picture again, pixels. `parts` gives the meshes of the last uploaded frame in a
    /// rectangle, each with its texture.
    pub fn draw<'t>(
        &self,
        device: &wgpu::Device,
        queue: &wgpu::Queue,
        rects: &[[u32; 4]],
        parts: impl Fn([u32; 4]) -> Vec<(UiMesh, &'t wgpu::BindGroup)>,
    ) {
        let Some(canvas) = self.canvas.as_ref().filter(|_| !rects.is_empty()) else {
            return;
        };
        let [w, h] = canvas.size;
        let mut encoder = device.create_command_encoder(&wgpu::CommandEncoderDescriptor {
            label: Some("window"),
        });
        {
            let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
                label: Some("window"),
                color_attachments: &[Some(wgpu::RenderPassColorAttachment {
                    view: &canvas.view,
                    depth_slice: None,
                    resolve_target: None,
                    ops: wgpu::Operations {
                        load: wgpu::LoadOp::Load,
                        store: wgpu::StoreOp::Store,
                    },
                })],
                depth_stencil_attachment: None,
                timestamp_writes: None,
                occlusion_query_set: None,
                multiview_mask: None,
            });
            pass.set_bind_group(0, &self.screen_group, &[]);
            for rect in rects {
                let [x, y] = [rect[0].min(w), rect[1].min(h)];
                let [width, height] = [rect[2].min(w - x), rect[3].min(h - y)];
                pass.set_pipeline(&self.wipe);
                pass.set_scissor_rect(x, y, width, height);
                pass.draw(0..3, 0..1);
                pass.set_pipeline(&self.pipeline);
                pass.set_vertex_buffer(0, self.vertices.slice(..));
                pass.set_index_buffer(self.indices.slice(..), wgpu::IndexFormat::Uint32);
                for (mesh, texture) in parts([x, y, width, height]) {
                    let [x, y, width, height] = mesh.scissor;
                    pass.set_bind_group(1, texture, &[]);
                    pass.set_scissor_rect(x, y, width, height);
                    pass.draw_indexed(mesh.indices.clone(), mesh.base_vertex, 0..1);
                }
            }
        }
        queue.submit([encoder.finish()]);
    }

    /// Shows the picture in a target of `size` pixels.
    pub fn show(&self, pass: &mut wgpu::RenderPass<'static>, size: [u32; 2]) {
        let Some(canvas) = self.canvas.as_ref().filter(|c| c.size == size) else {
            return;
        };
        pass.set_pipeline(&self.copy);
        pass.set_bind_group(0, &self.screen_group, &[]);
        pass.set_bind_group(1, &canvas.group, &[]);
        pass.set_viewport(0.0, 0.0, size[0] as f32, size[1] as f32, 0.0, 1.0);
        pass.set_scissor_rect(0, 0, size[0], size[1]);
        pass.draw(0..3, 0..1);
    }
}
