//! How a scene is drawn: wgpu, into an own colour and depth target, in the window and without one.
//!
//! [`Viewport::render`] draws only if something changed; [`Viewport::color_view`] is what the window
//! shows (an egui native texture) and [`Viewport::render_to_image`] what a screenshot saves. All
//! coordinates are in the ego frame, which is the world of this view. One drawable is one file here
//! and one shader of the same name in `shaders/`.

pub mod appearance;
mod background;
mod camera;
mod change;
mod device;
mod ego;
mod error;
mod faces;
mod ground;
mod image;
pub mod light;
mod lines;
mod marks;
pub mod meshing;
pub mod panels;
mod points;
mod pool;
pub mod shaders;
mod shared;
pub mod splats;
mod target;
mod voxels;

use std::hash::{DefaultHasher, Hash as _, Hasher as _};

pub use appearance::{APPEARANCE_UNIFORM_BYTES, LookError, LookRenderer};
pub use camera::{ViewCamera, ViewPreset};
pub use device::headless_device;
pub use error::ViewportError;
pub use image::MAX_SUPERSAMPLE;
pub use points::{LidarColorMode, lidar_colors};
pub use shared::{COLOR_FORMAT, FRAME_UNIFORM_BYTES, FrameUniforms};
pub use splats::{SPLAT_UNIFORM_BYTES, SplatError, SplatRenderer};

use change::{Change, PixelRect};
use marks::Marks;
use scene::{BoxId, GridSpec, LidarSweep, SceneBox, SensorRig, VoxelGrid};
use shared::Shared;
use target::Target;

/// Top of the ground bin, m: where the drawn ground is, 0.6 m below the physical one.
pub const GROUND_TOP_M: f64 = GridSpec::MIN_M[2] + GridSpec::VOXEL_M;

/// What is behind the scene.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Background {
    /// Vertical gradient, sRGB.
    Gradient {
        /// At the upper edge.
        top: [u8; 3],
        /// At the lower edge.
        bottom: [u8; 3],
    },
    /// Nothing: alpha 0. Fog is off.
    Transparent,
}

impl Background {
    /// For a dark window.
    pub const DARK: Background = Background::Gradient {
        top: [58, 66, 80],
        bottom: [27, 30, 37],
    };
    /// For a light window.
    pub const LIGHT: Background = Background::Gradient {
        top: [206, 218, 231],
        bottom: [238, 240, 243],
    };
}

/// Where the layout shows as a plane on the ground.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LayoutPlane {
    /// Nowhere.
    Off,
    /// In columns without any voxel.
    WhereEmpty,
    /// Everywhere, over ground voxels too.
    Always,
}

/// What is shown and how.
#[derive(Clone, Debug, PartialEq)]
pub struct ViewOptions {
    /// Show the occupancy.
    pub voxels: bool,
    /// Bit c hides class c.
    pub hidden_classes: u32,
    /// Hide voxels above this height, ego z, m; the bin that holds it stays.
    pub clip_above_m: Option<f64>,
    /// Thin lines between voxels.
    pub voxel_edges: bool,
    /// Sun shadows and shading by the sky that is in sight.
    pub shadows: bool,
    /// Road markings of the layout on ground voxels.
    pub markings: bool,
    /// The layout as a plane.
    pub layout_plane: LayoutPlane,
    /// Opacity of that plane, 0 to 1.
    pub layout_opacity: f32,
    /// Boxes as wire frames.
    pub boxes: bool,
    /// How much lower boxes, ego vehicle and cameras are drawn than they are, m. Labels put the ground
    /// 0.6 m below the physical one ([`GROUND_TOP_M`]), so this makes things stand on the drawn road;
    /// whoever picks boxes in the view adds it to the ray's z first. 0 draws them where they are.
    pub drop_m: f64,
    /// LiDAR returns.
    pub lidar: bool,
    /// Size of a LiDAR return, pixels.
    pub point_px: f32,
    /// The ego vehicle.
    pub ego: bool,
    /// Frusta of the rig's cameras.
    pub frusta: bool,
    /// Lines on the ground every 10 m, and axes.
    pub grid_lines: bool,
    /// What is behind.
    pub background: Background,
    /// Samples per pixel: 1, or 4 for smooth edges; other values mean 1.
    pub samples: u32,
    /// Physical pixels per point, for line widths.
    pub pixels_per_point: f32,
}

impl Default for ViewOptions {
    fn default() -> Self {
        Self {
            voxels: true,
            hidden_classes: 0,
            clip_above_m: None,
            voxel_edges: true,
            shadows: true,
            markings: true,
            layout_plane: LayoutPlane::WhereEmpty,
            layout_opacity: 0.9,
            boxes: true,
            drop_m: -GROUND_TOP_M,
            lidar: true,
            point_px: 2.5,
            ego: true,
            frusta: false,
            grid_lines: true,
            background: Background::DARK,
            samples: 4,
            pixels_per_point: 1.0,
        }
    }
}

/// Returns of a LiDAR with a colour each.
#[derive(Clone, Copy, Debug)]
pub struct LidarView<'a> {
    /// The returns.
    pub sweep: &'a LidarSweep,
    /// sRGB, one per return; see [`lidar_colors`].
    pub colors: &'a [[u8; 4]],
}

/// Voxels under the brush or the pointer, or marked.
#[derive(Clone, Copy, Debug)]
pub struct BrushCells<'a> {
    /// Voxel indices x, y, z; those outside of the grid are ignored.
    pub cells: &'a [[usize; 3]],
    /// sRGB.
    pub color: [u8; 3],
}

/// All that one picture shows, borrowed.
#[derive(Clone, Copy, Debug)]
pub struct ViewScene<'a> {
    /// Occupancy.
    pub grid: &'a VoxelGrid,
    /// Layout, one bit per layer, `[x][y]`, 40,000 cells; of another size it shows nothing.
    pub bev: &'a [u32],
    /// Boxes; those with a [`SceneBox::problem`] are left out.
    pub boxes: &'a [&'a SceneBox],
    /// Selected boxes.
    pub selected: &'a [BoxId],
    /// Box under the pointer.
    pub hovered: Option<BoxId>,
    /// Voxels under the brush, or marked: one list for each colour.
    pub brush: &'a [BrushCells<'a>],
    /// LiDAR returns.
    pub lidar: Option<LidarView<'a>>,
    /// Sensors and ego vehicle.
    pub rig: &'a SensorRig,
    /// What is shown.
    pub options: &'a ViewOptions,
}

/// The 3D view: device objects of every drawable, and the picture drawn last.
#[derive(Debug)]
pub struct Viewport {
    shared: Shared,
    pipelines: [Option<Pipelines>; 2], // 1 sample, 4 samples
    target: Target,
    drawn: Option<Drawn>,
    drawn_rect: PixelRect,
    voxels: voxels::Voxels,
    ground: ground::Ground,
    lines: lines::Lines,
    faces: faces::Faces,
    points: points::Points,
    ego: ego::Ego,
    uploaded: Uploaded,
}

/// What the picture was drawn from, as far as it is not in the drawables.
#[derive(Clone, Debug, PartialEq)]
struct Drawn {
    uniforms: FrameUniforms,
    options: ViewOptions,
}

/// Fingerprints of what the device holds; `None` before the first upload.
#[derive(Debug, Default)]
struct Uploaded {
    marks: Option<Marks>,
    points: Option<u64>,
    ego: Option<(SensorRig, u64)>,
    layout: Option<(u64, LayoutPlane, bool)>,
}

#[derive(Debug)]
struct Pipelines {
    voxels: wgpu::RenderPipeline,
    ego: wgpu::RenderPipeline,
    points: wgpu::RenderPipeline,
    background: wgpu::RenderPipeline,
    eraser: wgpu::RenderPipeline,
    ground: wgpu::RenderPipeline,
    lines: wgpu::RenderPipeline,
    hidden_lines: wgpu::RenderPipeline,
    faces: wgpu::RenderPipeline,
}

/// A usable [`ViewOptions::drop_m`].
fn drop_m(options: &ViewOptions) -> f64 {
    if options.drop_m.is_finite() {
        options.drop_m.clamp(-100.0, 100.0)
    } else {
        0.0
    }
}

/// 1 or 4.
fn samples(wanted: u32) -> u32 {
    if wanted == 4 { 4 } else { 1 }
}

impl Viewport {
    /// Makes the device objects; pipelines follow with the first picture.
    pub fn new(device: &wgpu::Device, queue: &wgpu::Queue) -> Self {
        Self {
            shared: Shared::new(device, queue),
            pipelines: [None, None],
            target: Target::new(device, [1, 1], 1),
            drawn: None,
            drawn_rect: [0; 4],
            voxels: voxels::Voxels::new(),
            ground: ground::Ground::default(),
            lines: lines::Lines::default(),
            faces: faces::Faces::default(),
            points: points::Points::default(),
            ego: ego::Ego::default(),
            uploaded: Uploaded::default(),
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
        let now = Drawn {
            uniforms: FrameUniforms::new(camera, scene.options, size, [0.0; 2]),
            options: scene.options.clone(),
        };
        let mut change = self.upload(device, queue, scene, fingerprint_of_words(scene.bev));
        let same_view = |drawn: &Drawn| drawn.uniforms == now.uniforms && drawn.options == now.options;
        if self.target.size != size || self.target.samples != samples {
            self.target = Target::new(device, size, samples);
            change = Change::All;
        } else if !self.target.keeps() && change != Change::None
            || !self.drawn.as_ref().is_some_and(same_view)
        {
            change = Change::All;
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
        self.build_pipelines(device, samples);
        let whole = (camera, &now.uniforms, scene.options);
        self.draw(device, queue, &self.target, whole, part);
        self.drawn_rect = part.unwrap_or([0, 0, size[0], size[1]]);
        self.drawn = Some(now);
        true
    }

    /// What of the picture was drawn last, pixels: left, top, width, height of all of it or of what a change touched.
    pub fn drawn_rect(&self) -> [u32; 4] {
        self.drawn_rect
    }

    /// The picture drawn last, [`COLOR_FORMAT`]: sRGB-encoded, premultiplied alpha, not converted on
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
        self.voxels.quads()
    }

    /// Draws into another target; the drawables then hold `scene`.
    fn draw_into(
        &mut self,
        device: &wgpu::Device,
        queue: &wgpu::Queue,
        target: &Target,
        camera: &ViewCamera,
        scene: &ViewScene<'_>,
        jitter_px: [f64; 2],
    ) {
        self.upload(device, queue, scene, fingerprint_of_words(scene.bev));
        self.build_pipelines(device, target.samples);
        let uniforms = FrameUniforms::new(camera, scene.options, target.size, jitter_px);
        self.draw(device, queue, target, (camera, &uniforms, scene.options), None);
    }

    /// Makes the next [`Viewport::render`] draw in any case.
    fn forget(&mut self) {
        self.drawn = None;
    }

    /// Brings the drawables up to date; what of the picture that changes.
    fn upload(
        &mut self,
        device: &wgpu::Device,
        queue: &wgpu::Queue,
        scene: &ViewScene<'_>,
        bev: u64,
    ) -> Change {
        let (options, mut change) = (scene.options, Change::None);
        let px = f64::from(options.pixels_per_point);
        let grid_changed = !self.voxels.holds(scene.grid, options);
        if grid_changed {
            change.add(
                self.voxels
                    .update(device, queue, &self.shared, scene.grid, options),
            );
        }
        let layout = (bev, options.layout_plane, options.voxels);
        if grid_changed || self.uploaded.layout != Some(layout) {
            change.add(
                self.ground
                    .update(queue, &self.shared, scene.bev, scene.grid, options),
            );
            self.uploaded.layout = Some(layout);
        }
        let marks = Marks::of(scene);
        if self.uploaded.marks.as_ref() != Some(&marks) {
            self.lines.write(device, queue, &marks.see_through, &marks.plain);
            self.faces.write(device, queue, &marks.faces);
            change.add(match &self.uploaded.marks {
                Some(old) => marks.change_from(old, px),
                None => Change::All,
            });
            self.uploaded.marks = Some(marks);
        }
        let lidar = scene.lidar.filter(|_| options.lidar);
        let points = lidar.map_or(0, fingerprint_of_points);
        if self.uploaded.points != Some(points) {
            let nothing = LidarSweep::default();
            let (sweep, colors) = lidar.map_or((&nothing, &[][..]), |l| (l.sweep, l.colors));
            let point_px = f64::from(options.point_px);
            change.add(self.points.write(device, queue, sweep, colors, point_px));
            self.uploaded.points = Some(points);
        }
        let ego = Some((scene.rig, options.drop_m.to_bits()));
        if self.uploaded.ego.as_ref().map(|(rig, drop)| (rig, *drop)) != ego {
            self.ego.write(device, queue, scene.rig, drop_m(options));
            self.uploaded.ego = Some((scene.rig.clone(), options.drop_m.to_bits()));
            change = Change::All;
        }
        change
    }

    fn build_pipelines(&mut self, device: &wgpu::Device, samples: u32) {
        let shared = &self.shared;
        self.pipelines[usize::from(samples > 1)].get_or_insert_with(|| Pipelines {
            voxels: voxels::Voxels::pipeline(device, shared, samples),
            ego: ego::Ego::pipeline(device, shared, samples),
            points: points::Points::pipeline(device, shared, samples),
            background: background::pipeline(device, shared, samples),
            eraser: background::eraser(device, shared, samples),
            ground: ground::Ground::pipeline(device, shared, samples),
            lines: lines::Lines::pipeline(device, shared, samples, false),
            hidden_lines: lines::Lines::pipeline(device, shared, samples, true),
            faces: faces::Faces::pipeline(device, shared, samples),
        });
    }

    /// Draws all of a picture, or only what lies in a rectangle of it.
    fn draw(
        &self,
        device: &wgpu::Device,
        queue: &wgpu::Queue,
        target: &Target,
        (camera, uniforms, options): (&ViewCamera, &FrameUniforms, &ViewOptions),
        part: Option<PixelRect>,
    ) {
        let Some(pipelines) = &self.pipelines[usize::from(target.samples > 1)] else {
            return;
        };
        let [w, h] = target.size;
        let rect = part.unwrap_or([0, 0, w, h]);
        let margin_px = points::Points::reach_px(f64::from(options.point_px));
        let camera = &camera.sane();
        let clip = change::crop(rect, margin_px, target.size) * camera.clip_from_world(target.size);
        let shared = &self.shared;
        shared.write_uniforms(queue, uniforms);
        let mut encoder = device.create_command_encoder(&wgpu::CommandEncoderDescriptor {
            label: Some("viewport"),
        });
        {
            let mut pass = target.begin(&mut encoder, part.is_some());
            pass.set_bind_group(0, &shared.bind_group, &[]);
            if let Some([x, y, w, h]) = part {
                pass.set_scissor_rect(x, y, w, h);
                pass.set_pipeline(&pipelines.eraser);
                pass.draw(0..3, 0..1);
            }
            // Opaque things first and near ones before far ones: a software rasteriser then shades
            // little that is covered later.
            if options.ego {
                pass.set_pipeline(&pipelines.ego);
                self.ego.draw(&mut pass, shared);
            }
            pass.set_pipeline(&pipelines.points);
            self.points.draw(&mut pass, &clip);
            pass.set_pipeline(&pipelines.voxels);
            self.voxels.draw(&mut pass, shared, camera, &clip);
            if options.background != Background::Transparent {
                pass.set_pipeline(&pipelines.background);
                pass.draw(0..3, 0..1);
            }
            if self.ground.is_visible() && uniforms.shows_layout_plane() {
                pass.set_pipeline(&pipelines.ground);
                pass.draw(0..4, 0..1);
            }
            pass.set_pipeline(&pipelines.hidden_lines);
            self.lines.draw_see_through(&mut pass, shared);
            pass.set_pipeline(&pipelines.faces);
            self.faces.draw(&mut pass, shared);
            pass.set_pipeline(&pipelines.lines);
            self.lines.draw_plain(&mut pass, shared);
            self.lines.draw_see_through(&mut pass, shared);
        }
        queue.submit([encoder.finish()]);
    }
}

fn fingerprint_of_words(words: &[u32]) -> u64 {
    let mut hasher = DefaultHasher::new();
    hasher.write(bytemuck::cast_slice(words));
    hasher.finish()
}

fn fingerprint_of_points(lidar: LidarView<'_>) -> u64 {
    let mut hasher = DefaultHasher::new();
    (lidar.sweep.points.len(), lidar.sweep.physical).hash(&mut hasher);
    for p in &lidar.sweep.points {
        hasher.write(bytemuck::cast_slice(&p.position_in_ego));
    }
    hasher.write(lidar.colors.as_flattened());
    hasher.finish()
}
