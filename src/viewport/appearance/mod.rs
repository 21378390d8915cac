//! Camera pictures on the graphics card: the light that reaches each pixel, as `generation::sensors::pictures::appearance` computes
//! it on the processor, to rounding. Glare and tone are put on it there, by one and the same code.

mod layout;

pub use layout::{APPEARANCE_UNIFORM_BYTES, appearance_source};

use layout::GpuView;

use super::splats::buffers::Growing;
use super::splats::pipelines::checked;
use super::splats::read::mapped;
use scene::Camera;
use scene::appearance::AppearanceData;

/// Rows that are drawn in one piece: a card that also draws the screen is not held up for long.
const BAND: u32 = 64;
/// Edge of a workgroup, as in the shader.
const GROUP: u32 = 8;
/// Bytes of a pixel in each of the two buffers.
const PIXEL_BYTES: u64 = 16;

/// Why the graphics card draws no pictures; the caller draws them on the processor then. One line.
#[derive(Clone, Debug, thiserror::Error)]
#[error("the graphics device draws no camera pictures: {0}")]
pub struct AppearanceError(String);

/// Draws pictures' light on a graphics device. May be used on any one thread; its calls wait for the device.
#[derive(Debug)]
pub struct AppearanceRenderer {
    device: wgpu::Device,
    queue: wgpu::Queue,
    middle: wgpu::ComputePipeline,
    edges: wgpu::ComputePipeline,
    view: Growing,
    words: Growing,
    samples: Growing,
    light: Growing,
    staging: Growing,
    appearance: Option<AppearanceData>, // without its words
}

impl AppearanceRenderer {
    /// Errors if the device is too small or refuses the shader.
    pub fn new(device: &wgpu::Device, queue: &wgpu::Queue) -> Result<AppearanceRenderer, AppearanceError> {
        use wgpu::BufferUsages as U;
        let build = || {
            let module = device.create_shader_module(wgpu::ShaderModuleDescriptor {
                label: Some("appearance"),
                source: wgpu::ShaderSource::Wgsl(appearance_source().into()),
            });
            ["middle", "edges"].map(|entry| {
                device.create_compute_pipeline(&wgpu::ComputePipelineDescriptor {
                    label: Some(entry),
                    layout: None,
                    module: &module,
                    entry_point: Some(entry),
                    compilation_options: Default::default(),
                    cache: None,
                })
            })
        };
        let [middle, edges] = checked(device, build).map_err(|e| AppearanceError(e.to_string()))?;
        Ok(AppearanceRenderer {
            middle,
            edges,
            view: Growing::new("appearance view", U::UNIFORM | U::COPY_DST),
            words: Growing::new("appearance words", U::STORAGE | U::COPY_DST),
            samples: Growing::new("appearance samples", U::STORAGE),
            light: Growing::new("appearance light", U::STORAGE | U::COPY_SRC),
            staging: Growing::new("appearance staging", U::COPY_DST | U::MAP_READ),
            appearance: None,
            device: device.clone(),
            queue: queue.clone(),
        })
    }

    /// Uploads the scene that is drawn from now on. Errors if it does not fit the device.
    pub fn set_appearance(&mut self, appearance: &AppearanceData) -> Result<(), AppearanceError> {
        self.appearance = None; // until it is there
        let bytes: &[u8] = bytemuck::cast_slice(&appearance.words);
        self.fits(bytes.len() as u64)?;
        checked(&self.device, || {
            let buffer = self.words.at_least(&self.device, bytes.len() as u64);
            self.queue.write_buffer(buffer, 0, bytes);
        })
        .map_err(|e| AppearanceError(e.to_string()))?;
        self.appearance = Some(AppearanceData {
            words: Vec::new(),
            ..appearance.clone()
        });
        Ok(())
    }

    fn fits(&self, bytes: u64) -> Result<(), AppearanceError> {
        let limits = self.device.limits();
        let binding: u64 = limits.max_storage_buffer_binding_size;
        let most = binding.min(limits.max_buffer_size);
        if bytes > most {
            return Err(AppearanceError(format!(
                "{bytes} bytes are needed at once, {most} can be had"
            )));
        }
        Ok(())
    }

    /// Linear light of a camera's `width * height` pixels, row-major; with `edges`, four samples where a pixel differs
    /// from its neighbours. Errors if no appearance was set, or the device fails.
    pub fn light(
        &mut self,
        camera: &Camera,
        [width, height]: [u32; 2],
        edges: bool,
    ) -> Result<Vec<[f32; 3]>, AppearanceError> {
        let Some(appearance) = &self.appearance else {
            return Err(AppearanceError("no appearance was set".into()));
        };
        let pixels = u64::from(width) * u64::from(height);
        let Some(view) = GpuView::new(appearance, camera, [width, height]).filter(|_| pixels > 0) else {
            return Ok(vec![[0.0; 3]; pixels as usize]);
        };
        let bytes = pixels * PIXEL_BYTES;
        self.fits(bytes)?;
        let out = self.draw(&view, [width, height], bytes, edges);
        out.map_err(|e| AppearanceError(e.to_string()))
    }

    fn draw(
        &mut self,
        view: &GpuView,
        [width, height]: [u32; 2],
        bytes: u64,
        edges: bool,
    ) -> Result<Vec<[f32; 3]>, super::SplatError> {
        let Self {
            device,
            queue,
            middle,
            edges: edge_pipeline,
            view: view_buffer,
            words,
            samples,
            light,
            staging,
            ..
        } = self;
        let staging = checked(device, || {
            let view_buffer = view_buffer.at_least(device, APPEARANCE_UNIFORM_BYTES as u64);
            let words = words.at_least(device, 16);
            let samples = samples.at_least(device, bytes);
            let light = light.at_least(device, bytes);
            let pipelines = [Some(&*middle), edges.then_some(&*edge_pipeline)];
            for pipeline in pipelines.into_iter().flatten() {
                let buffers = [view_buffer, words, samples, light];
                let entries: Vec<wgpu::BindGroupEntry<'_>> = (0..)
                    .zip(buffers)
                    .map(|(binding, buffer)| wgpu::BindGroupEntry {
                        binding,
                        resource: buffer.as_entire_binding(),
                    })
                    .collect();
                let bind_group = device.create_bind_group(&wgpu::BindGroupDescriptor {
                    label: Some("appearance"),
                    layout: &pipeline.get_bind_group_layout(0),
                    entries: &entries,
                });
                for row in (0..height).step_by(BAND as usize) {
                    let uniform = view.starting_at_row(row);
                    queue.write_buffer(view_buffer, 0, bytemuck::bytes_of(&uniform));
                    let label = Some("appearance");
                    let mut encoder =
                        device.create_command_encoder(&wgpu::CommandEncoderDescriptor { label });
                    let mut pass = encoder.begin_compute_pass(&wgpu::ComputePassDescriptor::default());
                    pass.set_pipeline(pipeline);
                    pass.set_bind_group(0, &bind_group, &[]);
                    let rows = BAND.min(height - row);
                    pass.dispatch_workgroups(width.div_ceil(GROUP), rows.div_ceil(GROUP), 1);
                    drop(pass);
                    queue.submit([encoder.finish()]);
                }
            }
            let staging = staging.at_least(device, bytes);
            let mut encoder = device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
            encoder.copy_buffer_to_buffer(light, 0, staging, 0, bytes);
            queue.submit([encoder.finish()]);
            staging
        })?;
        mapped(device, staging, bytes, |numbers| {
            let numbers: &[f32] = bytemuck::cast_slice(numbers);
            numbers.chunks_exact(4).map(|c| [c[0], c[1], c[2]]).collect()
        })
    }
}
