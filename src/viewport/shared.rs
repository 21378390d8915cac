//! Resources that all drawables share on the device: uniforms, scene textures, one index buffer, pipelines.

use bytemuck::{Pod, Zeroable};
use glam::Vec3;

use super::light::{LightBlock, SUN};
use super::shaders::SHADERS;
use super::{Background, ViewCamera, ViewOptions};
use scene::{Class, Extent};

/// Format of the picture: sRGB-encoded values in a format that does not convert, as egui expects of
/// textures; alpha is premultiplied.
pub const COLOR_FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Rgba8Unorm;
/// Reversed depth: 1 near, 0 far.
pub(super) const DEPTH_FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Depth32Float;

/// Rectangles that one draw call can index with 16 bits.
pub(super) const QUADS_PER_DRAW: u32 = 16384;

/// Uniforms of a picture; the same layout as `Frame` in `shaders/shared/frame.wgsl`.
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub struct FrameUniforms {
    clip_from_ego: [[f32; 4]; 4],
    eye: [f32; 4],
    forward: [f32; 4],
    screen: [f32; 4],
    background_top: [f32; 4],
    background_bottom: [f32; 4],
    sun: [f32; 4],
    toggles: [f32; 4],
    grid_min: [f32; 4],
    grid_size: [f32; 4],
    ground: [f32; 4],
    palette: [[f32; 4]; Class::COUNT],
}

/// Height of the layout's plane above the top of the ground's voxels, m.
const OVER_GROUND_M: f64 = 0.015;

/// Fog is made for maps as wide as this, m; it begins farther away over wider ones.
const FOG_OVER_M: f64 = 80.0;

/// Size of the uniforms, bytes; a test compares it with the shader's.
pub const FRAME_UNIFORM_BYTES: usize = size_of::<FrameUniforms>();

impl FrameUniforms {
    /// The uniforms of one picture of a map; `jitter_px` shifts it by parts of a pixel.
    pub fn new(
        camera: &ViewCamera,
        options: &ViewOptions,
        extent: Extent,
        size_px: [u32; 2],
        jitter_px: [f64; 2],
    ) -> Self {
        let camera = camera.sane();
        let (w, h) = (f64::from(size_px[0].max(1)), f64::from(size_px[1].max(1)));
        let shift = glam::DMat4::from_translation(glam::DVec3::new(
            2.0 * jitter_px[0] / w,
            -2.0 * jitter_px[1] / h,
            0.0,
        ));
        let clip = shift * camera.clip_from_world(size_px);
        let forward = camera.axes()[2].as_vec3();
        // Edge of a pixel: in perspective per metre of distance.
        let at_target = camera.height_at_target_m() / h;
        let pixel = if camera.ortho {
            at_target
        } else {
            at_target / camera.distance_m
        };
        let (top, bottom, opaque) = match options.background {
            Background::Gradient { top, bottom } => (top, bottom, 1.0),
            Background::Transparent => ([0; 3], [0; 3], 0.0),
        };
        let rgba = |c: [u8; 3], a: f32| {
            let [r, g, b] = c.map(|v| f32::from(v) / 255.0);
            [r, g, b, a]
        };
        let fog = if camera.ortho { 0.0 } else { 0.38 * opaque };
        let low = extent.min_m();
        let wide = (extent.max_m() - low).truncate().max_element() / FOG_OVER_M;
        let finite = |v: f32, or: f32| if v.is_finite() { v } else { or };
        Self {
            clip_from_ego: clip.as_mat4().to_cols_array_2d(),
            eye: camera
                .eye_m()
                .as_vec3()
                .extend(f32::from(u8::from(camera.ortho)))
                .to_array(),
            forward: forward.extend(pixel as f32).to_array(),
            screen: [
                w as f32,
                h as f32,
                finite(options.pixels_per_point, 1.0).clamp(0.1, 16.0),
                finite(options.point_px, 3.0).clamp(0.5, 64.0),
            ],
            background_top: rgba(top, opaque),
            background_bottom: rgba(bottom, opaque),
            sun: Vec3::from_array(SUN).normalize().extend(fog).to_array(),
            toggles: [
                f32::from(u8::from(options.voxel_edges)),
                f32::from(u8::from(options.markings)),
                f32::from(u8::from(options.shadows)),
                finite(options.layout_opacity, 1.0).clamp(0.0, 1.0),
            ],
            grid_min: low.as_vec3().extend(wide.max(1.0) as f32).to_array(),
            grid_size: [
                extent.nx() as f32,
                extent.ny() as f32,
                extent.nz() as f32,
                extent.voxel_m() as f32,
            ],
            ground: [
                (extent.lattice().ground_top_m() + OVER_GROUND_M) as f32,
                0.0,
                0.0,
                0.0,
            ],
            palette: Class::ALL.map(|class| {
                let [r, g, b, _] = rgba(class.color(), 1.0);
                [r * r, g * g, b * b, f32::from(u8::from(class.is_ground()))]
            }),
        }
    }
}

impl FrameUniforms {
    /// False if the layout plane would be fully transparent.
    pub(super) fn shows_layout_plane(&self) -> bool {
        self.toggles[3] > 0.0
    }
}

/// Device objects that all drawables bind or draw with.
#[derive(Debug)]
pub(super) struct DrawableResources {
    pub bind_group_layout: wgpu::BindGroupLayout,
    pub quad_indices: wgpu::Buffer,
    uniforms: wgpu::Buffer,
    sampler: wgpu::Sampler,
    of_map: OfMap,
}

/// Resources as large as the map.
#[derive(Debug)]
struct OfMap {
    extent: Extent,
    bind_group: wgpu::BindGroup,
    light: wgpu::Texture,
    markings: wgpu::Texture,
    layout: wgpu::Texture,
}

impl DrawableResources {
    /// For a map of this extent.
    pub fn new(device: &wgpu::Device, queue: &wgpu::Queue, extent: Extent) -> Self {
        let uniforms = device.create_buffer(&wgpu::BufferDescriptor {
            label: Some("frame"),
            size: FRAME_UNIFORM_BYTES as u64,
            usage: wgpu::BufferUsages::UNIFORM | wgpu::BufferUsages::COPY_DST,
            mapped_at_creation: false,
        });
        let sampler = device.create_sampler(&wgpu::SamplerDescriptor {
            label: Some("light"),
            mag_filter: wgpu::FilterMode::Linear,
            min_filter: wgpu::FilterMode::Linear,
            ..Default::default()
        });
        let bind_group_layout = bind_group_layout(device);
        let indices: Vec<u16> = (0..QUADS_PER_DRAW)
            .flat_map(|q| [0, 1, 2, 0, 2, 3].map(|i| (q * 4 + i) as u16))
            .collect();
        let quad_indices = device.create_buffer(&wgpu::BufferDescriptor {
            label: Some("quad indices"),
            size: (indices.len() * 2) as u64,
            usage: wgpu::BufferUsages::INDEX | wgpu::BufferUsages::COPY_DST,
            mapped_at_creation: false,
        });
        queue.write_buffer(&quad_indices, 0, bytemuck::cast_slice(&indices));
        let of_map = OfMap::new(device, queue, extent, (&bind_group_layout, &uniforms, &sampler));
        Self {
            bind_group_layout,
            quad_indices,
            uniforms,
            sampler,
            of_map,
        }
    }

    /// Makes the textures anew, fully lit and without a layout, if they are of another map.
    pub fn fit(&mut self, device: &wgpu::Device, queue: &wgpu::Queue, extent: Extent) {
        if self.of_map.extent != extent {
            let with = (&self.bind_group_layout, &self.uniforms, &self.sampler);
            self.of_map = OfMap::new(device, queue, extent, with);
        }
    }

    pub fn bind_group(&self) -> &wgpu::BindGroup {
        &self.of_map.bind_group
    }

    pub fn write_uniforms(&self, queue: &wgpu::Queue, uniforms: &FrameUniforms) {
        queue.write_buffer(&self.uniforms, 0, bytemuck::bytes_of(uniforms));
    }

    /// Columns that have light, from the map's lower corner: all, unless the device has no texture so large.
    pub fn lit_columns(&self) -> [usize; 2] {
        let size = self.of_map.light.size();
        [size.width as usize - 2, size.height as usize - 2]
    }

    /// Columns beyond [`Self::lit_columns`] are left out.
    pub fn write_light(&self, queue: &wgpu::Queue, block: &LightBlock) {
        let [x, y] = block.origin;
        let lit = self.lit_columns();
        let size = [0, 1].map(|i| block.size[i].min(lit[i].saturating_sub(block.origin[i])));
        write_texture(
            queue,
            &self.of_map.light,
            ([x + 1, y + 1, 1], [size[0], size[1], self.of_map.extent.nz()]),
            (2, block.size),
            bytemuck::cast_slice(&block.cells),
        );
    }

    /// Uploads both textures as RGBA8, sRGB, straight alpha, `[y][x]` of the map.
    pub fn write_layout(&self, queue: &wgpu::Queue, markings: &[[u8; 4]], plane: &[[u8; 4]]) {
        let OfMap { extent, .. } = self.of_map;
        for (texture, texels) in [(&self.of_map.markings, markings), (&self.of_map.layout, plane)] {
            let size = texture.size();
            write_texture(
                queue,
                texture,
                ([0; 3], [size.width as usize, size.height as usize, 1]),
                (4, [extent.nx(), extent.ny()]),
                texels.as_flattened(),
            );
        }
    }
}

impl OfMap {
    /// Textures as large as the map, or as the device allows.
    fn new(
        device: &wgpu::Device,
        queue: &wgpu::Queue,
        extent: Extent,
        (layout, uniforms, sampler): (&wgpu::BindGroupLayout, &wgpu::Buffer, &wgpu::Sampler),
    ) -> Self {
        use wgpu::{TextureDimension as Dim, TextureFormat as Format};
        let texture = |label, size: [usize; 3], dimension, format| {
            device.create_texture(&wgpu::TextureDescriptor {
                label: Some(label),
                size: texture_size(size),
                mip_level_count: 1,
                sample_count: 1,
                dimension,
                format,
                usage: wgpu::TextureUsages::TEXTURE_BINDING | wgpu::TextureUsages::COPY_DST,
                view_formats: &[],
            })
        };
        let limits = device.limits();
        let columns = [extent.nx(), extent.ny()];
        // The light has a border of one cell.
        let [w, h] = columns.map(|n| (n + 2).min(limits.max_texture_dimension_3d as usize));
        let volume = [w, h, extent.nz() + 2];
        let [nx, ny] = columns.map(|n| n.min(limits.max_texture_dimension_2d as usize));
        let light = texture("light volume", volume, Dim::D3, Format::Rg8Unorm);
        let markings = texture("markings", [nx, ny, 1], Dim::D2, Format::Rgba8Unorm);
        let plane = texture("layout plane", [nx, ny, 1], Dim::D2, Format::Rgba8Unorm);
        // Fully lit, border included: the border is never written again.
        let lit = vec![255u8; w * h * volume[2] * 2];
        write_texture(queue, &light, ([0; 3], volume), (2, [w, h]), &lit);
        let view = |t: &wgpu::Texture| t.create_view(&wgpu::TextureViewDescriptor::default());
        let entry = |binding, resource| wgpu::BindGroupEntry { binding, resource };
        let bind_group = device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: Some("shared"),
            layout,
            entries: &[
                entry(0, uniforms.as_entire_binding()),
                entry(1, wgpu::BindingResource::TextureView(&view(&light))),
                entry(2, wgpu::BindingResource::Sampler(sampler)),
                entry(3, wgpu::BindingResource::TextureView(&view(&markings))),
                entry(4, wgpu::BindingResource::TextureView(&view(&plane))),
            ],
        });
        Self {
            extent,
            bind_group,
            light,
            markings,
            layout: plane,
        }
    }
}

fn bind_group_layout(device: &wgpu::Device) -> wgpu::BindGroupLayout {
    let fragment = wgpu::ShaderStages::FRAGMENT;
    let sampled = |binding, view_dimension| wgpu::BindGroupLayoutEntry {
        binding,
        visibility: fragment,
        ty: wgpu::BindingType::Texture {
            sample_type: wgpu::TextureSampleType::Float { filterable: true },
            view_dimension,
            multisampled: false,
        },
        count: None,
    };
    device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
        label: Some("shared"),
        entries: &[
            wgpu::BindGroupLayoutEntry {
                binding: 0,
                visibility: wgpu::ShaderStages::VERTEX_FRAGMENT,
                ty: wgpu::BindingType::Buffer {
                    ty: wgpu::BufferBindingType::Uniform,
                    has_dynamic_offset: false,
                    min_binding_size: None,
                },
                count: None,
            },
            sampled(1, wgpu::TextureViewDimension::D3),
            wgpu::BindGroupLayoutEntry {
                binding: 2,
                visibility: fragment,
                ty: wgpu::BindingType::Sampler(wgpu::SamplerBindingType::Filtering),
                count: None,
            },
            sampled(3, wgpu::TextureViewDimension::D2),
            sampled(4, wgpu::TextureViewDimension::D2),
        ],
    })
}

fn texture_size([width, height, depth]: [usize; 3]) -> wgpu::Extent3d {
    wgpu::Extent3d {
        width: width as u32,
        height: height as u32,
        depth_or_array_layers: depth as u32,
    }
}

/// Writes `size` texels at `at` from rows and images of texels that may be longer than that.
fn write_texture(
    queue: &wgpu::Queue,
    texture: &wgpu::Texture,
    (at, size): ([usize; 3], [usize; 3]),
    (texel_bytes, [row, rows]): (usize, [usize; 2]),
    bytes: &[u8],
) {
    if size.contains(&0) {
        return;
    }
    queue.write_texture(
        wgpu::TexelCopyTextureInfo {
            texture,
            mip_level: 0,
            origin: wgpu::Origin3d {
                x: at[0] as u32,
                y: at[1] as u32,
                z: at[2] as u32,
            },
            aspect: wgpu::TextureAspect::All,
        },
        bytes,
        wgpu::TexelCopyBufferLayout {
            offset: 0,
            bytes_per_row: Some((row * texel_bytes) as u32),
            rows_per_image: Some(rows as u32),
        },
        texture_size(size),
    );
}

/// How a drawable's pipeline differs from the others.
#[derive(Clone, Copy, Debug)]
pub(super) struct PipelineSpec<'a> {
    /// Name of the shader file, without its ending.
    pub shader: &'static str,
    pub fragment: &'static str,
    pub stride: usize,
    pub attributes: &'a [wgpu::VertexAttribute],
    pub blend: bool,
    pub depth_write: bool,
    pub depth_compare: wgpu::CompareFunction,
    pub cull: bool,
    pub topology: wgpu::PrimitiveTopology,
}

impl PipelineSpec<'_> {
    /// Opaque, depth-tested triangles.
    pub const OPAQUE: PipelineSpec<'static> = PipelineSpec {
        shader: "",
        fragment: "fs_main",
        stride: 0,
        attributes: &[],
        blend: false,
        depth_write: true,
        depth_compare: wgpu::CompareFunction::GreaterEqual,
        cull: false,
        topology: wgpu::PrimitiveTopology::TriangleList,
    };

    pub fn build(
        &self,
        device: &wgpu::Device,
        shared: &DrawableResources,
        samples: u32,
    ) -> wgpu::RenderPipeline {
        let source = SHADERS
            .iter()
            .find(|s| s.name == self.shader)
            .map(|s| s.source)
            .expect("every drawable's shader is in the list; tests/shaders.rs checks it");
        let module = device.create_shader_module(wgpu::ShaderModuleDescriptor {
            label: Some(self.shader),
            source: wgpu::ShaderSource::Wgsl(source.into()),
        });
        let layout = device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
            label: Some(self.shader),
            bind_group_layouts: &[Some(&shared.bind_group_layout)],
            immediate_size: 0,
        });
        let buffer = wgpu::VertexBufferLayout {
            array_stride: self.stride as u64,
            step_mode: wgpu::VertexStepMode::Vertex,
            attributes: self.attributes,
        };
        let buffers = [Some(buffer)];
        device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
            label: Some(self.shader),
            layout: Some(&layout),
            vertex: wgpu::VertexState {
                module: &module,
                entry_point: Some("vs_main"),
                compilation_options: Default::default(),
                buffers: if self.stride == 0 { &[] } else { &buffers },
            },
            primitive: wgpu::PrimitiveState {
                topology: self.topology,
                cull_mode: self.cull.then_some(wgpu::Face::Back),
                ..Default::default()
            },
            depth_stencil: Some(wgpu::DepthStencilState {
                format: DEPTH_FORMAT,
                depth_write_enabled: Some(self.depth_write),
                depth_compare: Some(self.depth_compare),
                stencil: wgpu::StencilState::default(),
                bias: wgpu::DepthBiasState::default(),
            }),
            multisample: wgpu::MultisampleState {
                count: samples,
                ..Default::default()
            },
            fragment: Some(wgpu::FragmentState {
                module: &module,
                entry_point: Some(self.fragment),
                compilation_options: Default::default(),
                targets: &[Some(wgpu::ColorTargetState {
                    format: COLOR_FORMAT,
                    blend: self
                        .blend
                        .then_some(wgpu::BlendState::PREMULTIPLIED_ALPHA_BLENDING),
                    write_mask: wgpu::ColorWrites::ALL,
                })],
            }),
            multiview_mask: None,
            cache: None,
        })
    }
}

/// A vertex buffer; grows, never shrinks.
#[derive(Debug, Default)]
pub(super) struct VertexBuffer {
    buffer: Option<wgpu::Buffer>,
    stride: u64,
    vertices: u32,
}

/// Largest vertex buffer, bytes: within the downlevel limit of 128 MiB with room to spare.
const MAX_BUFFER_BYTES: usize = 64 << 20;

impl VertexBuffer {
    /// Replaces the content. What exceeds the largest buffer is left out.
    pub fn write<V: Pod>(&mut self, device: &wgpu::Device, queue: &wgpu::Queue, label: &str, vertices: &[V]) {
        let stride = size_of::<V>();
        // Whole rectangles and whole triangles: a multiple of 12.
        let most = MAX_BUFFER_BYTES / stride / 12 * 12;
        let bytes: &[u8] = bytemuck::cast_slice(&vertices[..vertices.len().min(most)]);
        self.stride = stride as u64;
        self.vertices = (bytes.len() / stride) as u32;
        if bytes.is_empty() {
            return;
        }
        let size = bytes.len() as u64;
        let buffer = match &mut self.buffer {
            Some(buffer) if buffer.size() >= size => buffer,
            slot => slot.insert(device.create_buffer(&wgpu::BufferDescriptor {
                label: Some(label),
                size: size.next_power_of_two().max(256),
                usage: wgpu::BufferUsages::VERTEX | wgpu::BufferUsages::COPY_DST,
                mapped_at_creation: false,
            })),
        };
        queue.write_buffer(buffer, 0, bytes);
    }

    /// Draws some of the rectangles, four vertices each, with the pipeline that is set.
    pub fn draw_quads(
        &self,
        pass: &mut wgpu::RenderPass<'_>,
        shared: &DrawableResources,
        quads: std::ops::Range<u32>,
    ) {
        self.draw_quads_as(pass, shared, quads, 0);
    }

    /// Draws rectangles as [`Self::draw_quads`] does, as an instance of this number.
    pub fn draw_quads_as(
        &self,
        pass: &mut wgpu::RenderPass<'_>,
        shared: &DrawableResources,
        quads: std::ops::Range<u32>,
        instance: u32,
    ) {
        let Some(buffer) = &self.buffer else { return };
        let end = quads.end.min(self.quads());
        let mut start = quads.start;
        if start >= end {
            return;
        }
        pass.set_index_buffer(shared.quad_indices.slice(..), wgpu::IndexFormat::Uint16);
        while start < end {
            let count = (end - start).min(QUADS_PER_DRAW);
            let bytes = 4 * self.stride;
            pass.set_vertex_buffer(
                0,
                buffer.slice(u64::from(start) * bytes..u64::from(start + count) * bytes),
            );
            pass.draw_indexed(0..count * 6, 0, instance..instance + 1);
            start += count;
        }
    }

    /// Draws all as triangles, three vertices each.
    pub fn draw_triangles(&self, pass: &mut wgpu::RenderPass<'_>) {
        let Some(buffer) = self.buffer.as_ref().filter(|_| self.vertices > 0) else {
            return;
        };
        pass.set_vertex_buffer(0, buffer.slice(..));
        pass.draw(0..self.vertices, 0..1);
    }

    /// Memory on the device, bytes.
    pub fn memory_bytes(&self) -> u64 {
        self.buffer.as_ref().map_or(0, wgpu::Buffer::size)
    }

    /// Number of rectangles held.
    pub fn quads(&self) -> u32 {
        self.vertices / 4
    }
}
