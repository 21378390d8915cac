//! The 3D view: the last picture, and the state that it was drawn from.

use std::hash::{DefaultHasher, Hasher as _};

use super::change::{self, PictureChange, PixelRect};
use super::drawable::{self, DrawContext, DrawInput, DrawLayer, Drawable, Gpu};
use super::marks::Marks;
use super::points::Points;
use super::shared::{DrawableResources, FrameUniforms};
use super::target::RenderTarget;
use super::{ViewCamera, ViewOptions, ViewScene};
use scene::Extent;

/// The 3D view: device objects of every drawable, and the picture drawn last.
#[derive(Debug)]
pub struct Viewport {
    shared: DrawableResources,
    drawables: Vec<Box<dyn Drawable>>,
    pub(super) target: RenderTarget,
    drawn: Option<FrameInputs>,
    drawn_rect: PixelRect,
}

/// The part of the input of the last picture that no drawable keeps.
#[derive(Clone, Debug, PartialEq)]
struct FrameInputs {
    uniforms: FrameUniforms,
    options: ViewOptions,
}

/// The map until a first one is shown.
pub(super) fn nothing() -> Extent {
    Extent::new([0; 2], [1; 2]).expect("a sound size")
}

/// 1 or 4.
pub(super) fn samples(wanted: u32) -> u32 {
    if wanted == 4 { 4 } else { 1 }
}

impl Viewport {
    /// Makes the device objects; pipelines follow with the first picture.
    pub fn new(device: &wgpu::Device, queue: &wgpu::Queue) -> Self {
        Self {
            shared: DrawableResources::new(device, queue, nothing()),
            drawables: drawable::all(),
            target: RenderTarget::new(device, [1, 1], 1),
            drawn: None,
            drawn_rect: [0; 4],
        }
    }

    /// Draws into the own target, `width` x `height` physical pixels. Does nothing and returns false
    /// if the picture is already there or a side is zero; sides beyond the device's limit are cut.
    ///
    /// After a change of size [`Viewport::color_view`] is a new view: register it again.
    pub fn render(
        &mut self,
        device: &wgpu::Device,
        queue: &wgpu::Queue,
        camera: &ViewCamera,
        scene: &ViewScene<'_>,
        width: u32,
        height: u32,
    ) -> bool {
        if width == 0 || height == 0 {
            return false;
        }
        let max = device.limits().max_texture_dimension_2d;
        let size = [width.min(max), height.min(max)];
        let samples = samples(scene.options.samples);
        let now = FrameInputs {
            uniforms: FrameUniforms::new(camera, scene.options, scene.grid.extent(), size, [0.0; 2]),
            options: scene.options.clone(),
        };
        let mut change = self.prepare(device, queue, scene);
        let same_view = |drawn: &FrameInputs| drawn.uniforms == now.uniforms && drawn.options == now.options;
        if self.target.size != size || self.target.samples != samples {
            self.target = RenderTarget::new(device, size, samples);
            change = PictureChange::All;
        } else if !self.target.keeps() && change != PictureChange::None
            || !self.drawn.as_ref().is_some_and(same_view)
        {
            change = PictureChange::All;
        }
        let clip = camera.sane().clip_from_world(size);
        let part = match change::touched(&change, &clip, size) {
            Ok(None) => {
                self.drawn = Some(now);
                return false;
            }
            Ok(part) => part,
            Err(change::Whole) => None,
        };
        self.build(device, queue, samples);
        let whole = (camera, &now.uniforms, scene.options);
        self.draw(device, queue, &self.target, whole, part);
        self.drawn_rect = part.unwrap_or([0, 0, size[0], size[1]]);
        self.drawn = Some(now);
        true
    }

    /// The rectangle of the picture that was drawn last, pixels: left, top, width, height.
    pub fn drawn_rect(&self) -> [u32; 4] {
        self.drawn_rect
    }

    /// The picture drawn last, `COLOR_FORMAT`: sRGB-encoded, premultiplied alpha, not converted on
    /// sampling, which is what egui expects of a native texture. 1 x 1 before the first picture.
    pub fn color_view(&self) -> &wgpu::TextureView {
        &self.target.color_view
    }

    /// Size of that picture, pixels.
    pub fn size(&self) -> [u32; 2] {
        self.target.size
    }

    /// Rectangles that the occupancy became; two triangles each.
    pub fn voxel_quads(&self) -> usize {
        let voxels = self.drawables.iter().find(|d| d.name() == "voxels");
        voxels.map_or(0, |d| d.quads())
    }

    /// Memory of all vertices on the device, bytes.
    pub fn memory_bytes(&self) -> u64 {
        self.drawables.iter().map(|d| d.memory_bytes()).sum()
    }

    /// Draws into another target; the drawables then hold `scene`.
    pub(super) fn draw_into(
        &mut self,
        device: &wgpu::Device,
        queue: &wgpu::Queue,
        target: &RenderTarget,
        camera: &ViewCamera,
        scene: &ViewScene<'_>,
        jitter_px: [f64; 2],
    ) {
        self.prepare(device, queue, scene);
        self.build(device, queue, target.samples);
        let extent = scene.grid.extent();
        let uniforms = FrameUniforms::new(camera, scene.options, extent, target.size, jitter_px);
        self.draw(device, queue, target, (camera, &uniforms, scene.options), None);
    }

    /// Makes the next [`Viewport::render`] draw even if nothing changed.
    pub(super) fn forget(&mut self) {
        self.drawn = None;
    }

    /// Brings the drawables up to date. Returns which part of the picture changes by that.
    fn prepare(
        &mut self,
        device: &wgpu::Device,
        queue: &wgpu::Queue,
        scene: &ViewScene<'_>,
    ) -> PictureChange {
        let (marks, mut change) = (Marks::of(scene), PictureChange::None);
        self.shared.fit(device, queue, scene.grid.extent());
        let gpu = Gpu {
            device,
            queue,
            shared: &self.shared,
        };
        let shown = DrawInput {
            scene,
            marks: &marks,
            bev: fingerprint(bytemuck::cast_slice(scene.bev)),
        };
        for drawable in &mut self.drawables {
            change.add(drawable.prepare(gpu, shown));
        }
        change
    }

    fn build(&mut self, device: &wgpu::Device, queue: &wgpu::Queue, samples: u32) {
        let gpu = Gpu {
            device,
            queue,
            shared: &self.shared,
        };
        for drawable in &mut self.drawables {
            drawable.build(gpu, samples);
        }
    }

    /// Draws all of a picture, or only a rectangle of it.
    fn draw(
        &self,
        device: &wgpu::Device,
        queue: &wgpu::Queue,
        target: &RenderTarget,
        (camera, uniforms, options): (&ViewCamera, &FrameUniforms, &ViewOptions),
        part: Option<PixelRect>,
    ) {
        let [w, h] = target.size;
        let rect = part.unwrap_or([0, 0, w, h]);
        let margin_px = Points::reach_px(f64::from(options.point_px));
        let camera = &camera.sane();
        let view = DrawContext {
            camera,
            clip: change::crop(rect, margin_px, target.size) * camera.clip_from_world(target.size),
            uniforms,
            options,
            shared: &self.shared,
            samples: target.samples,
            part: part.is_some(),
        };
        self.shared.write_uniforms(queue, uniforms);
        let mut encoder = device.create_command_encoder(&wgpu::CommandEncoderDescriptor {
            label: Some("viewport"),
        });
        {
            let mut pass = target.begin(&mut encoder, view.part);
            pass.set_bind_group(0, self.shared.bind_group(), &[]);
            if let Some([x, y, w, h]) = part {
                pass.set_scissor_rect(x, y, w, h);
            }
            for layer in DrawLayer::ALL {
                for drawable in &self.drawables {
                    drawable.draw(&mut pass, &view, layer);
                }
            }
        }
        queue.submit([encoder.finish()]);
    }
}

fn fingerprint(bytes: &[u8]) -> u64 {
    let mut hasher = DefaultHasher::new();
    hasher.write(bytes);
    hasher.finish()
}
