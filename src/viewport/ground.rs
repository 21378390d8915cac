//! The layout: road markings painted on ground voxels, and a thin plane with all of its layers.

use super::change::{EgoBounds, PictureChange};
use super::drawable::{DrawContext, DrawInput, DrawLayer, Drawable, Gpu, Pipelines};
use super::shared::PipelineSpec;
use super::{LayoutPlane, ViewOptions};
use scene::{BevLayer, Class, Extent, VoxelGrid};

/// Layers that lie on ground voxels as paint, later ones on top, with their opacity.
const PAINT: [(BevLayer, f32); 5] = [
    (BevLayer::CarparkArea, 0.35),
    (BevLayer::PedCrossing, 0.62),
    (BevLayer::StopLine, 0.85),
    (BevLayer::LaneDivider, 0.72),
    (BevLayer::RoadDivider, 0.80),
];

/// Layers of the plane, later ones on top.
const PLANE: [BevLayer; 8] = [
    BevLayer::DrivableArea,
    BevLayer::CarparkArea,
    BevLayer::Walkway,
    BevLayer::PedCrossing,
    BevLayer::StopLine,
    BevLayer::LaneDivider,
    BevLayer::RoadDivider,
    BevLayer::RoadBlock,
];

/// Drawable of the layout: both textures as uploaded last, compared to learn what changed.
#[derive(Debug, Default)]
pub(super) struct LayoutDrawable {
    pipelines: Pipelines,
    extent: Option<Extent>,
    markings: Vec<[u8; 4]>,
    plane: Vec<[u8; 4]>,
    made_from: Option<MadeFrom>,
}

/// Sources of both textures: grid, fingerprint of the cells, kind of plane, voxels shown.
type MadeFrom = (VoxelGrid, u64, LayoutPlane, bool);

impl LayoutDrawable {
    /// Uploads the textures if they differ from the last ones. Returns which part of the picture changes.
    fn update(
        &mut self,
        gpu: Gpu<'_>,
        bev: &[u32],
        grid: &VoxelGrid,
        options: &ViewOptions,
    ) -> PictureChange {
        let extent = grid.extent();
        let markings = marking_texels(extent, bev);
        let plane = plane_texels(bev, grid, options);
        if self.extent == Some(extent) && markings == self.markings && plane == self.plane {
            return PictureChange::None;
        }
        gpu.shared.write_layout(gpu.queue, &markings, &plane);
        // Shown on top of the ground voxels of a column, and beneath them.
        let mut seen = match self.extent == Some(extent) {
            true => PictureChange::None,
            false => PictureChange::All,
        };
        for (texels, old) in [(&markings, &self.markings), (&plane, &self.plane)] {
            seen.add(differing(texels, old, grid));
        }
        (self.extent, self.markings, self.plane) = (Some(extent), markings, plane);
        seen
    }

    /// Updates the plane where only some bricks of the grid have changed; markings do not depend on them.
    fn update_bricks(
        &mut self,
        gpu: Gpu<'_>,
        (bev, bricks): (&[u32], &[usize]),
        grid: &VoxelGrid,
        options: &ViewOptions,
    ) -> PictureChange {
        let extent = grid.extent();
        if !only_where_empty(options) || bev.len() != extent.columns() {
            return PictureChange::None;
        }
        let mut around = ChangedTexels::default();
        for &brick in bricks {
            let ([x0, y0], [w, h]) = grid.brick_columns(brick);
            for (x, y) in (x0..x0 + w).flat_map(|x| (y0..y0 + h).map(move |y| (x, y))) {
                let new = plane_texel(grid, [x, y], bev[extent.index(x, y)], true);
                let old = &mut self.plane[y * extent.nx() + x];
                if std::mem::replace(old, new) != new {
                    around.add(grid, x, y);
                }
            }
        }
        let seen = around.change(extent);
        if seen != PictureChange::None {
            gpu.shared.write_layout(gpu.queue, &self.markings, &self.plane);
        }
        seen
    }

    /// True if the plane would show anything.
    fn is_visible(&self) -> bool {
        self.plane.iter().any(|t| t[3] != 0)
    }
}

impl Drawable for LayoutDrawable {
    fn name(&self) -> &'static str {
        "ground"
    }

    fn prepare(&mut self, gpu: Gpu<'_>, shown: DrawInput<'_>) -> PictureChange {
        let (scene, options) = (shown.scene, shown.scene.options);
        let now = (
            scene.grid.clone(),
            shown.bev,
            options.layout_plane,
            options.voxels,
        );
        let same = |(grid, bev, plane, voxels): &MadeFrom| {
            (*bev, *plane, *voxels) == (now.1, now.2, now.3) && grid.extent() == now.0.extent()
        };
        let held = self.made_from.as_ref().filter(|old| same(old));
        let changed = held.map(|(grid, ..)| scene.grid.changed_bricks(grid));
        self.made_from = Some(now);
        match changed {
            Some(bricks) if bricks.is_empty() => PictureChange::None,
            Some(bricks) => self.update_bricks(gpu, (scene.bev, &bricks), scene.grid, options),
            None => self.update(gpu, scene.bev, scene.grid, options),
        }
    }

    fn build(&mut self, gpu: Gpu<'_>, samples: u32) {
        let spec = PipelineSpec {
            shader: "ground",
            blend: true,
            depth_write: false,
            topology: wgpu::PrimitiveTopology::TriangleStrip,
            ..PipelineSpec::OPAQUE
        };
        self.pipelines
            .build(samples, || spec.build(gpu.device, gpu.shared, samples));
    }

    fn draw(&self, pass: &mut wgpu::RenderPass<'_>, view: &DrawContext<'_>, layer: DrawLayer) {
        if layer == DrawLayer::Ground
            && self.is_visible()
            && view.uniforms.shows_layout_plane()
            && self.pipelines.set(pass, view)
        {
            pass.draw(0..4, 0..1);
        }
    }

    fn memory_bytes(&self) -> u64 {
        0 // its textures are shared
    }
}

/// Columns whose texels differ, and the highest ground voxel among them.
#[derive(Default)]
struct ChangedTexels(Option<([usize; 3], [usize; 3])>);

impl ChangedTexels {
    fn add(&mut self, grid: &VoxelGrid, x: usize, y: usize) {
        let is_ground = |label: &u8| Class::from_id(*label).is_some_and(Class::is_ground);
        let top = grid.column(x, y).iter().rposition(is_ground).map_or(1, |z| z + 1);
        let (low, high) = self.0.unwrap_or(([x, y, 0], [0, 0, 1]));
        self.0 = Some((
            [low[0].min(x), low[1].min(y), 0],
            [high[0].max(x + 1), high[1].max(y + 1), high[2].max(top)],
        ));
    }

    fn change(self, extent: Extent) -> PictureChange {
        let Some((low, high)) = self.0 else {
            return PictureChange::None;
        };
        let part = EgoBounds::of_voxels(extent, low, high);
        // The plane lies just above the top of the lowest bin.
        let high_m = part.high_m + glam::DVec3::Z * 0.05;
        PictureChange::part(EgoBounds { high_m, ..part }, 2.0)
    }
}

/// Where texels `[y][x]` differ, up to the highest ground voxel.
fn differing(new: &[[u8; 4]], old: &[[u8; 4]], grid: &VoxelGrid) -> PictureChange {
    let extent = grid.extent();
    if new.len() != old.len() || new.len() != extent.columns() {
        return PictureChange::All;
    }
    let mut around = ChangedTexels::default();
    for (i, _) in new.iter().zip(old).enumerate().filter(|(_, (a, b))| a != b) {
        around.add(grid, i % extent.nx(), i / extent.nx());
    }
    around.change(extent)
}

/// Cells of the layout, `[x][y]`, read as texels `[y][x]`; a layout of another size shows nothing.
fn texels(extent: Extent, bev: &[u32], texel: impl Fn(usize, usize, u32) -> [u8; 4]) -> Vec<[u8; 4]> {
    let mut out = vec![[0; 4]; extent.columns()];
    if bev.len() == extent.columns() {
        let nx = extent.nx();
        for ([x, y], bits) in extent.all_columns().zip(bev) {
            out[y * nx + x] = texel(x, y, *bits);
        }
    }
    out
}

fn marking_texels(extent: Extent, bev: &[u32]) -> Vec<[u8; 4]> {
    texels(extent, bev, |_, _, bits| {
        let top = PAINT.iter().rev().find(|(layer, _)| bits & layer.bit() != 0);
        top.map_or([0; 4], |(layer, opacity)| {
            let [r, g, b] = layer.color();
            [r, g, b, (opacity * 255.0) as u8]
        })
    })
}

fn plane_texels(bev: &[u32], grid: &VoxelGrid, options: &ViewOptions) -> Vec<[u8; 4]> {
    if options.layout_plane == LayoutPlane::Off {
        return vec![[0; 4]; grid.extent().columns()];
    }
    let only_empty = only_where_empty(options);
    texels(grid.extent(), bev, |x, y, bits| {
        plane_texel(grid, [x, y], bits, only_empty)
    })
}

/// True if voxels hide the plane.
fn only_where_empty(options: &ViewOptions) -> bool {
    options.layout_plane == LayoutPlane::WhereEmpty && options.voxels
}

fn plane_texel(grid: &VoxelGrid, [x, y]: [usize; 2], bits: u32, only_empty: bool) -> [u8; 4] {
    if only_empty && grid.column(x, y).iter().any(|c| *c < Class::FREE) {
        return [0; 4];
    }
    let map = PLANE.into_iter().rev().find(|layer| bits & layer.bit() != 0);
    let objects = Class::OBJECTS
        .into_iter()
        .filter_map(BevLayer::of_object)
        .find(|layer| bits & layer.bit() != 0);
    match (objects, map) {
        (Some(layer), _) | (None, Some(layer)) => {
            let [r, g, b] = layer.color();
            [r, g, b, 255]
        }
        (None, None) => [0; 4],
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn textures_follow_the_layout() {
        let extent = Extent::new([-150, -110], [480, 320]).expect("sound");
        let mut bev = vec![0; extent.columns()];
        bev[extent.index(30, 70)] = BevLayer::DrivableArea.bit() | BevLayer::RoadDivider.bit();
        bev[extent.index(31, 70)] = BevLayer::DrivableArea.bit() | BevLayer::Car.bit();
        let at = |x: usize| 70 * 480 + x;
        let paint = marking_texels(extent, &bev);
        assert_eq!(paint[at(30)][..3], BevLayer::RoadDivider.color());
        assert_eq!(paint[at(31)], [0; 4]);
        let mut grid = VoxelGrid::over(extent);
        let mut options = ViewOptions {
            layout_plane: LayoutPlane::WhereEmpty,
            ..ViewOptions::default()
        };
        assert_eq!(
            plane_texels(&bev, &grid, &options)[at(31)][..3],
            BevLayer::Car.color()
        );
        grid.set(31, 70, 0, 11);
        assert_eq!(plane_texels(&bev, &grid, &options)[at(31)], [0; 4]);
        options.layout_plane = LayoutPlane::Always;
        assert_eq!(plane_texels(&bev, &grid, &options)[at(31)][3], 255);
        options.layout_plane = LayoutPlane::Off;
        assert!(plane_texels(&bev, &grid, &options).iter().all(|t| t[3] == 0));
        // A layout of another size is not read past its end.
        assert!(marking_texels(extent, &[1; 7]).iter().all(|t| t[3] == 0));
    }
}
