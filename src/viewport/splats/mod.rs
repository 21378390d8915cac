//! Camera maps by Gaussian splatting on the graphics card: the same maps as
//! `src/gen/sensors/splat.rs` draws on the processor, to rounding.
//!
//! Several cameras go through one sequence of compute passes: project, radix sort by depth, list per
//! tile of 16 x 16 pixels, blend. Only what every device offers is used: no subgroups, four storage
//! buffers a stage, the limits of `headless_device`.

pub(crate) mod buffers;
mod encode;
mod error;
mod layout;
pub(crate) mod pipelines;
pub(crate) mod read;

use std::ops::Range;

pub use error::SplatError;
pub use layout::SPLAT_UNIFORM_BYTES;

use buffers::Growing;
use encode::{Data, LEDGER_BYTES, PAIR_BYTES, SPLAT_BYTES, SplatBatchSize, SplatWorkspace};
use layout::{GpuBatch, GpuGaussian, MAX_VIEWS};
use pipelines::{GROUP, Pipelines, checked};
use scene::splats::{Gaussian, RawMaps, SplatOptions};
use scene::{Camera, CameraMaps, SensorRig};

/// Edge of a tile, px.
const TILE: u32 = 16;
/// Touches of splats and tiles that there is room for at first; six views of a street have some
/// 400,000 at 800 x 450.
const FIRST_ROOM: u32 = 1 << 20;

/// Longest side of an image, px.
const MAX_SIDE: u32 = 16384;

/// Maps that are computed, in the order in which they lie in the device's buffer.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum SplatMapSet {
    /// Coverage, expected depth, median depth, label.
    Maps = 4,
    /// Then margin and the light that was left.
    All = 6,
}

/// Draws camera maps on a graphics device. Buffers stay between frames; the cloud is uploaded by
/// [`SplatRenderer::set_cloud`] only. May be used on any one thread; its calls wait for the device.
#[derive(Debug)]
pub struct SplatRenderer {
    device: wgpu::Device,
    queue: wgpu::Queue,
    pipelines: Pipelines,
    work: SplatWorkspace,
    batch: Growing,
    gaussians: Growing,
    count: u32,
    room: u32,
    drawn: Vec<SplatBatch>,
    /// Maps of each batch of the last drawing, and where they are read from.
    maps: Vec<Growing>,
    staging: Growing,
}

/// One batch of the last drawing.
#[derive(Debug)]
struct SplatBatch {
    cameras: Range<usize>,
    bytes_per_camera: u64,
}

impl SplatRenderer {
    /// Errors if the device is too small or refuses the shaders; draw on the processor then.
    pub fn new(device: &wgpu::Device, queue: &wgpu::Queue) -> Result<SplatRenderer, SplatError> {
        let pipelines = Pipelines::new(device)?;
        use wgpu::BufferUsages as U;
        Ok(SplatRenderer {
            pipelines,
            work: checked(device, || SplatWorkspace::new(device, queue))?,
            batch: Growing::new("splat batch", U::UNIFORM | U::COPY_DST),
            gaussians: Growing::new("splat gaussians", U::STORAGE | U::COPY_DST),
            count: 0,
            room: FIRST_ROOM,
            drawn: Vec::new(),
            maps: Vec::new(),
            staging: Growing::new("splat staging", U::COPY_DST | U::MAP_READ),
            device: device.clone(),
            queue: queue.clone(),
        })
    }

    /// Uploads the Gaussians that are drawn from now on. Errors if there are more than the device can hold (with 128
    /// MiB a buffer: four million).
    pub fn set_cloud(&mut self, gaussians: &[Gaussian]) -> Result<(), SplatError> {
        let kept: Vec<GpuGaussian> = gaussians.iter().filter_map(GpuGaussian::new).collect();
        let max = self.max_items();
        let count = u32::try_from(kept.len()).ok().filter(|&n| n <= max);
        let Some(count) = count else {
            return Err(SplatError::Gaussians {
                count: kept.len(),
                max: max as usize,
            });
        };
        let bytes: &[u8] = bytemuck::cast_slice(&kept);
        self.count = 0; // until they are there
        checked(&self.device, || {
            let buffer = self.gaussians.at_least(&self.device, bytes.len() as u64);
            self.queue.write_buffer(buffer, 0, bytes);
        })
        .inspect_err(|_| self.gaussians.clear())?;
        self.count = count;
        Ok(())
    }

    /// Draws the maps of all cameras and leaves them on the device, see [`SplatRenderer::maps`].
    /// Returns when the device has done so. Errors leave maps of an earlier drawing or none.
    pub fn draw(
        &mut self,
        cameras: &[Camera],
        size_px: [u32; 2],
        options: &SplatOptions,
    ) -> Result<(), SplatError> {
        let nobody: Option<fn(usize, &[u32])> = None;
        self.draw_and(cameras, size_px, options, SplatMapSet::Maps, nobody)
    }

    /// Draws the maps of a rig's cameras, in the rig's order, and reads them back.
    pub fn render_rig(
        &mut self,
        rig: &SensorRig,
        [width, height]: [u32; 2],
        options: &SplatOptions,
    ) -> Result<Vec<CameraMaps>, SplatError> {
        let raw = self.read(&rig.cameras, [width, height], options, SplatMapSet::Maps)?;
        let named = raw.into_iter().zip(&rig.cameras);
        Ok(named.map(|(m, c)| m.into_camera_maps(&c.name, options)).collect())
    }

    /// Draws all maps of all cameras and reads them back.
    pub fn render_raw(
        &mut self,
        cameras: &[Camera],
        size_px: [u32; 2],
        options: &SplatOptions,
    ) -> Result<Vec<RawMaps>, SplatError> {
        self.read(cameras, size_px, options, SplatMapSet::All)
    }

    /// Where the last drawing's maps of a camera begin on the device: buffer and byte. Four planes
    /// of `width * height` values each follow: coverage, expected depth in m, median depth in m (f32),
    /// heaviest id (i32, -1 for none). `None` for a camera that was not drawn.
    pub fn maps(&self, camera: usize) -> Option<(&wgpu::Buffer, u64)> {
        let at = self.drawn.iter().position(|d| d.cameras.contains(&camera))?;
        let drawn = &self.drawn[at];
        let before = (camera - drawn.cameras.start) as u64;
        Some((self.maps[at].get()?, before * drawn.bytes_per_camera))
    }

    fn read(
        &mut self,
        cameras: &[Camera],
        [width, height]: [u32; 2],
        options: &SplatOptions,
        planes: SplatMapSet,
    ) -> Result<Vec<RawMaps>, SplatError> {
        let (w, h) = (width as usize, height as usize);
        let mut out: Vec<RawMaps> = Vec::with_capacity(cameras.len());
        let each = |_, words: &[u32]| out.push(read::raw_maps(w, h, words));
        self.draw_and(cameras, [width, height], options, planes, Some(each))?;
        if w * h == 0 {
            out = cameras.iter().map(|_| RawMaps::empty(w, h)).collect();
        }
        Ok(out)
    }

    /// Draws batch after batch and shows the planes of each camera to `each`, if it asks for them.
    fn draw_and(
        &mut self,
        cameras: &[Camera],
        size_px: [u32; 2],
        options: &SplatOptions,
        planes: SplatMapSet,
        mut each: Option<impl FnMut(usize, &[u32])>,
    ) -> Result<(), SplatError> {
        self.drawn.clear();
        let [width, height] = size_px;
        if width == 0 || height == 0 {
            return Ok(());
        }
        let limits = self.device.limits();
        let bytes_per_camera = u64::from(width) * u64::from(height) * 4 * planes as u64;
        let fitting = max_bytes(&limits) / bytes_per_camera;
        if width > MAX_SIDE || height > MAX_SIDE || fitting == 0 {
            return Err(SplatError::Size { width, height });
        }
        let tiles = size_px.map(|v| v.div_ceil(TILE));
        // Rows of tiles are counted on over all cameras, in 16 bits.
        let by_rows = u16::MAX as usize / tiles[1] as usize;
        let by_items = self.max_items() / self.count.max(1);
        let mut views = MAX_VIEWS.min(by_rows).min(by_items as usize);
        views = views.min(usize::try_from(fitting).unwrap_or(usize::MAX)).max(1);
        let max_room = (max_bytes(&limits) / PAIR_BYTES).min(1 << 24) as u32;
        let mut start = 0;
        while start < cameras.len() {
            let range = start..cameras.len().min(start + views);
            let uniforms = GpuBatch::new(
                &cameras[range.clone()],
                size_px,
                self.count,
                planes as u32,
                options,
            );
            let shape = SplatBatchSize {
                gaussians: self.count,
                views: range.len() as u32,
                tiles,
                room: self.room,
                key_bits: layout::key_bits(options),
            };
            let drawn = SplatBatch {
                cameras: range.clone(),
                bytes_per_camera,
            };
            let touches = self.draw_batch(&uniforms, shape, drawn, &mut each);
            let touches = touches.inspect_err(|_| self.clear())?;
            if touches <= self.room {
                start = range.end;
            } else if touches <= max_room {
                self.room = touches.next_power_of_two().min(max_room);
            } else if range.len() > 1 {
                views = range.len() / 2;
            } else {
                return Err(SplatError::Crowded {
                    touches,
                    max: max_room,
                });
            }
        }
        Ok(())
    }

    /// Draws a batch and waits for it. Returns the number of touches; if that exceeds the room for them, the maps are
    /// not complete, and they have not been handed out.
    fn draw_batch(
        &mut self,
        uniforms: &GpuBatch,
        shape: SplatBatchSize,
        drawn: SplatBatch,
        each: &mut Option<impl FnMut(usize, &[u32])>,
    ) -> Result<u32, SplatError> {
        let Self {
            device,
            queue,
            pipelines,
            work,
            batch,
            gaussians,
            maps,
            staging,
            ..
        } = self;
        let at = self.drawn.len();
        if at == maps.len() {
            let usage = wgpu::BufferUsages::STORAGE | wgpu::BufferUsages::COPY_SRC;
            maps.push(Growing::new("splat maps", usage));
        }
        let bytes = drawn.bytes_per_camera * u64::from(shape.views);
        let staged = LEDGER_BYTES + if each.is_some() { bytes } else { 0 };
        let staging = checked(device, || {
            let batch = batch.at_least(device, SPLAT_UNIFORM_BYTES as u64);
            queue.write_buffer(batch, 0, bytemuck::bytes_of(uniforms));
            let data = Data {
                batch,
                gaussians: gaussians.at_least(device, 32),
                maps: maps[at].at_least(device, bytes),
            };
            let label = Some("splats");
            let mut encoder = device.create_command_encoder(&wgpu::CommandEncoderDescriptor { label });
            work.encode((device, queue), &mut encoder, pipelines, data, shape);
            let staging = staging.at_least(device, staged);
            if let Some(ledger) = work.ledger.get() {
                encoder.copy_buffer_to_buffer(ledger, 0, staging, 0, LEDGER_BYTES);
            }
            if each.is_some() {
                encoder.copy_buffer_to_buffer(data.maps, 0, staging, LEDGER_BYTES, bytes);
            }
            queue.submit([encoder.finish()]);
            staging
        })?;
        let words_per_camera = (drawn.bytes_per_camera / 4) as usize;
        let touches = read::mapped(device, staging, staged, |words| {
            let touches = words[2];
            if let (true, Some(each)) = (touches <= shape.room, each) {
                let maps = words[LEDGER_BYTES as usize / 4..].chunks_exact(words_per_camera);
                for (camera, planes) in drawn.cameras.clone().zip(maps) {
                    each(camera, planes);
                }
            }
            touches
        })?;
        if touches <= shape.room {
            self.drawn.push(drawn);
        }
        Ok(touches)
    }

    /// Lets go of buffers that may be damaged.
    fn clear(&mut self) {
        self.drawn.clear();
        self.maps.clear();
        self.work.clear();
        self.batch.clear();
        self.staging.clear();
    }

    /// How many pairs of camera and Gaussian one batch can have.
    fn max_items(&self) -> u32 {
        let limits = self.device.limits();
        let groups = u64::from(limits.max_compute_workgroups_per_dimension) * u64::from(GROUP);
        let bytes = max_bytes(&limits) / SPLAT_BYTES;
        groups.min(bytes).try_into().unwrap_or(u32::MAX)
    }
}

/// Bytes that one storage buffer can have.
fn max_bytes(limits: &wgpu::Limits) -> u64 {
    let binding: u64 = limits.max_storage_buffer_binding_size;
    binding.min(limits.max_buffer_size)
}
