//! Pictures made without a window: top views, the 3D view off screen, and sheets of several pictures.

use anyhow::bail;

use crate::camera_views::{RadarColors, radar_color};
use crate::look::Look;
use crate::pictured;
use scene::raster::box_cells;
use scene::{
    BevLayer, Class, Extent, Frame, LidarSweep, MultiPlaneImage, RadarScan, Scene, SceneBox, VoxelGrid,
};
use sensors::cameras::bounds;
use sensors::pictures::appearance::AppearanceCache;
use sensors::{lidar::recorded, pictures::color};
use viewport::{
    Background, LidarColorMode, LidarView, ViewCamera, ViewOptions, ViewPreset, ViewScene, Viewport,
    headless_device, lidar_colors,
};

/// Colour between the pictures of a sheet, sRGB.
pub const SHEET_COLOR: [u8; 3] = [24, 26, 31];

/// A picture: RGBA8, row-major, top row first.
#[derive(Clone, Debug)]
pub struct RgbaPicture {
    /// Pixels per row.
    pub width: usize,
    /// Rows.
    pub height: usize,
    /// Four bytes per pixel.
    pub rgba: Vec<u8>,
}

impl RgbaPicture {
    /// A picture of one colour.
    pub fn filled(width: usize, height: usize, color: [u8; 3]) -> Self {
        let pixel = [color[0], color[1], color[2], 255];
        Self {
            width,
            height,
            rgba: pixel.repeat(width * height),
        }
    }

    fn set(&mut self, x: usize, y: usize, color: [u8; 3]) {
        if x < self.width && y < self.height {
            let at = (y * self.width + x) * 4;
            self.rgba[at..at + 3].copy_from_slice(&color);
        }
    }

    /// Fills a column of a grid seen from above, ahead is up, with `scale` pixels per column.
    pub fn fill_column(&mut self, extent: Extent, [x, y]: [usize; 2], scale: usize, color: [u8; 3]) {
        let (left, top) = ((extent.ny() - 1 - y) * scale, (extent.nx() - 1 - x) * scale);
        for i in 0..scale * scale {
            self.set(left + i % scale, top + i / scale, color);
        }
    }

    /// Copies another picture in at (x, y). Parts that do not fit are cut off.
    pub fn put(&mut self, other: &RgbaPicture, x: usize, y: usize) {
        for row in 0..other.height.min(self.height.saturating_sub(y)) {
            let n = other.width.min(self.width.saturating_sub(x)) * 4;
            let from = row * other.width * 4;
            let to = ((y + row) * self.width + x) * 4;
            self.rgba[to..to + n].copy_from_slice(&other.rgba[from..from + n]);
        }
    }

    /// Arranges pictures side by side in rows, with a margin around each.
    pub fn sheet(rows: &[Vec<RgbaPicture>], margin: usize) -> Self {
        let width = |row: &Vec<RgbaPicture>| row.iter().map(|p| p.width + margin).sum::<usize>() + margin;
        let height = |row: &Vec<RgbaPicture>| row.iter().map(|p| p.height).max().unwrap_or(0) + margin;
        let w = rows.iter().map(width).max().unwrap_or(margin);
        let mut out = RgbaPicture::filled(w, rows.iter().map(height).sum::<usize>() + margin, SHEET_COLOR);
        let mut y = margin;
        for row in rows {
            let mut x = margin;
            for p in row {
                out.put(p, x, y);
                x += p.width + margin;
            }
            y += height(row);
        }
        out
    }
}

/// Draws grid cells seen from above: ego x is up, ego y is left.
fn top_view(extent: Extent, scale: usize, cell: impl Fn(usize, usize) -> [u8; 3]) -> RgbaPicture {
    let mut out = RgbaPicture::filled(extent.ny() * scale, extent.nx() * scale, [0; 3]);
    for [x, y] in extent.all_columns() {
        out.fill_column(extent, [x, y], scale, cell(x, y));
    }
    out
}

fn scaled(color: [u8; 3], by: f32) -> [u8; 3] {
    color.map(|c| (f32::from(c) * by).clamp(0.0, 255.0) as u8)
}

/// The layout from above, `scale` pixels per cell, boxes in their colours.
pub fn layout_top(frame: &Frame, scale: usize) -> RgbaPicture {
    use BevLayer::{
        CarparkArea, DrivableArea, LaneDivider, PedCrossing, RoadBlock, RoadDivider, StopLine, Walkway,
    };
    let order = [
        DrivableArea,
        RoadBlock,
        Walkway,
        StopLine,
        CarparkArea,
        PedCrossing,
        RoadDivider,
        LaneDivider,
    ];
    let extent = frame.extent();
    let mut boxes: Vec<Option<&SceneBox>> = vec![None; extent.columns()];
    for b in frame.boxes.values() {
        box_cells(extent, b, 0.0, |x, y| boxes[extent.index(x, y)] = Some(b));
    }
    top_view(extent, scale, |x, y| {
        if let Some(b) = boxes[extent.index(x, y)] {
            return b.class.color();
        }
        let top = order.into_iter().rev().find(|l| frame.layout.has(*l, x, y));
        top.map_or([38, 41, 48], BevLayer::color)
    })
}

/// Occupancy from above: the class of the highest voxel, brighter with height.
pub fn occupancy_top(grid: &VoxelGrid, scale: usize) -> RgbaPicture {
    let highest = (grid.extent().nz() - 1).max(1) as f32;
    top_view(grid.extent(), scale, |x, y| {
        let column = grid.column(x, y);
        let top = column.iter().rposition(|label| *label != Class::FREE);
        top.and_then(|z| Some((z, Class::from_id(column[z])?)))
            .map_or([20, 22, 27], |(z, class)| {
                scaled(class.color(), 0.62 + 0.38 * z as f32 / highest)
            })
    })
}

/// Sheet of nine planes of a multi-plane image, near to far, each at a third of its size.
pub fn plane_sheet(image: &MultiPlaneImage) -> RgbaPicture {
    const SIDE: usize = 3;
    let (w, h) = (image.width / SIDE, image.height / SIDE);
    let (width, height) = (w * SIDE, h * SIDE);
    let mut rgba = vec![255; width * height * 4];
    for tile in 0..SIDE * SIDE {
        // Evenly spaced in log depth from 5 m: near planes hold little but road.
        let depth_m = 5.0 * (image.planes.far_m / 5.0).powf(tile as f64 / (SIDE * SIDE) as f64);
        let step_m = image.planes.depth_m(1) - image.planes.depth_m(0);
        let plane = ((depth_m - image.planes.near_m) / step_m).max(0.0) as u16;
        let slice = color::plane_rgba(image, plane);
        let (x0, y0) = (tile % SIDE * w, tile / SIDE * h);
        for (y, x) in (0..h).flat_map(|y| (0..w).map(move |x| (y, x))) {
            let from = (y * SIDE * image.width + x * SIDE) * 4;
            let to = ((y0 + y) * width + x0 + x) * 4;
            rgba[to..to + 4].copy_from_slice(&slice[from..from + 4]);
        }
    }
    RgbaPicture { width, height, rgba }
}

/// LiDAR returns above a map, coloured by range.
pub fn lidar_top(extent: Extent, sweep: &LidarSweep, scale: usize) -> RgbaPicture {
    let mut out = RgbaPicture::filled(extent.ny() * scale, extent.nx() * scale, [16, 18, 22]);
    for p in &sweep.points {
        let [x, y, _] = p.position_in_ego.map(f64::from);
        let u = extent.to_voxel_units(glam::DVec3::new(x, y, 0.0)) * scale as f64;
        let (px, py) = (out.width as f64 - u.y, out.height as f64 - u.x);
        if px >= 0.0 && py >= 0.0 {
            // Two pixels wide and never dark, so that a sparse ring is visible.
            let bright = color::ramp(0.35 + 0.65 * (1.0 - (p.range_m / 45.0).min(1.0)));
            for i in 0..4 {
                out.set(px as usize + i % 2, py as usize + i / 2, bright);
            }
        }
    }
    out
}

/// Radar returns above the map layers, dimmed, in the colours of their speeds as in the pane; larger where the echo is stronger.
pub fn radar_top(frame: &Frame, scans: &[RadarScan], scale: usize) -> RgbaPicture {
    let mut out = layout_top(frame, scale);
    for channel in out.rgba.chunks_exact_mut(4).flat_map(|pixel| &mut pixel[..3]) {
        *channel /= 3;
    }
    let extent = frame.extent();
    for one in scans.iter().flat_map(|scan| &scan.returns) {
        let [x, y, _] = one.position_m.map(f64::from);
        let u = extent.to_voxel_units(glam::DVec3::new(x, y, 0.0)) * scale as f64;
        let (px, py) = (out.width as f64 - u.y, out.height as f64 - u.x);
        let [r, g, b, _] = radar_color(one, RadarColors::Speed).to_array();
        let radius = if one.rcs_dbsm < 5.0 { 1 } else { 2 };
        for (i, j) in (-radius..=radius).flat_map(|i| (-radius..=radius).map(move |j| (i, j))) {
            let (px, py) = (px + f64::from(i), py + f64::from(j));
            if px >= 0.0 && py >= 0.0 {
                out.set(px as usize, py as usize, [r, g, b]);
            }
        }
    }
    out
}

/// Memory of a 3D picture, bytes per pixel: the target with four samples of colour and depth, the sums of
/// supersampling, the picture and its PNG.
pub const SHOT_BYTES_PER_PIXEL: u64 = 80;

/// Options of a 3D picture.
#[derive(Clone, Debug)]
pub struct ShotOptions {
    /// The viewpoint.
    pub camera: ViewCamera,
    /// Size in pixels.
    pub size: [u32; 2],
    /// Supersampling per axis.
    pub supersample: u32,
    /// True: without background.
    pub transparent: bool,
    /// True: with LiDAR returns.
    pub lidar: bool,
    /// True: with boxes.
    pub boxes: bool,
    /// What the scene is shown as. A picture has all of its own and no marks: what is said here of boxes, LiDAR returns and the
    /// background is of voxels.
    pub look: Look,
}

impl Default for ShotOptions {
    fn default() -> Self {
        Self {
            camera: ViewCamera::preset(ViewPreset::Perspective),
            size: [1280, 720],
            supersample: 2,
            transparent: false,
            lidar: false,
            boxes: true,
            look: Look::Voxels,
        }
    }
}

/// The 3D view off screen: voxels by a viewport on a device of its own, pictures by the processor.
pub struct View3d {
    card: Option<(wgpu::Device, wgpu::Queue, Viewport)>,
    cache: AppearanceCache,
    /// What draws.
    pub adapter: String,
}

impl View3d {
    /// A view that draws one look. Errors without an adapter if it needs one.
    pub fn new(look: Look) -> anyhow::Result<Self> {
        let cache = AppearanceCache::default();
        if look == Look::Pictures {
            return Ok(Self {
                card: None,
                cache,
                adapter: "the processor".into(),
            });
        }
        let (info, device, queue) = headless_device()?;
        let viewport = Viewport::new(&device, &queue);
        Ok(Self {
            card: Some((device, queue, viewport)),
            cache,
            adapter: info.name,
        })
    }

    /// Draws a scene's frame in the look it was made for. Errors if the size does not fit into memory, if it came out in one
    /// colour, or if a picture is to be orthographic.
    pub fn shot(&mut self, scene: &Scene, options: &ShotOptions) -> anyhow::Result<RgbaPicture> {
        let Some((device, queue, viewport)) = &mut self.card else {
            return pictured::shot(scene, &options.camera, options.size, &self.cache);
        };
        bounds::check(options.size, SHOT_BYTES_PER_PIXEL, 0)?;
        let of_sensors = scene;
        let scene = &*scene.with_rig_in_world();
        let frame = scene.frame();
        let sweep = match options.lidar {
            true => recorded::sweep_or_exact(&of_sensors.for_sensors()),
            false => LidarSweep::default(),
        };
        let colors = lidar_colors(&sweep, LidarColorMode::Range);
        let mut view = ViewOptions {
            boxes: options.boxes,
            lidar: options.lidar,
            ..ViewOptions::default()
        };
        if options.transparent {
            view.background = Background::Transparent;
        }
        let boxes: Vec<&SceneBox> = frame.boxes.values().collect();
        let bev = frame.bev_channels();
        let view_scene = ViewScene {
            grid: &frame.occupancy,
            bev: &bev,
            boxes: &boxes,
            selected: &[],
            hovered: None,
            brush: &[],
            lidar: options.lidar.then_some(LidarView {
                sweep: &sweep,
                colors: &colors,
            }),
            rig: &scene.rig,
            options: &view,
        };
        let [width, height] = options.size;
        let rgba = viewport.render_to_image(
            device,
            queue,
            &options.camera,
            &view_scene,
            options.size,
            options.supersample,
        )?;
        if !options.transparent && rgba.chunks_exact(4).all(|p| p == &rgba[..4]) {
            bail!("the 3D view came out in one colour");
        }
        Ok(RgbaPicture {
            width: width as usize,
            height: height as usize,
            rgba,
        })
    }
}
