//! Worlds over maps larger than the window that procedural scenery and voxelisation know: window by window on a fixed
//! lattice, each with a seed of its own place.

use std::collections::BTreeMap;

use rayon::prelude::*;

use super::scenery_around::merged;
use scene::background::in_extent;
use scene::moved::Columns;
use scene::{Background, BevLayout, BoxId, Extent, SceneBox, Thing, VoxelGrid, Window};
use world::World;
use world::draw::hash;
use world::scenery;
use world::voxelize::{Vertical, complete};

/// What stands in a neighbouring window may reach into this one, columns.
const AROUND: usize = 40;

/// One window of the lattice.
#[derive(Clone, Copy)]
struct Tile {
    /// Its part of the map.
    extent: Extent,
    /// Brings it to the origin.
    to_window: Columns,
}

/// The windows that cover a map, from its lower corner on. The order is fixed.
fn tiles(extent: Extent) -> Vec<Tile> {
    let side = Window::NX as i32;
    let [from_x, from_y] = extent.from();
    let counts = [extent.nx().div_ceil(Window::NX), extent.ny().div_ceil(Window::NY)];
    let corner = |i: usize, j: usize| [from_x + side * i as i32, from_y + side * j as i32];
    let all = (0..counts[0]).flat_map(|i| (0..counts[1]).map(move |j| (i, j)));
    let tile = |(i, j)| {
        let from = corner(i, j);
        let extent = Extent::new(from, [Window::NX, Window::NY]).ok()?;
        let middle = [0, 1].map(|axis| -(from[axis] - Extent::WINDOW.from()[axis]));
        Some(Tile {
            extent,
            to_window: Columns(middle),
        })
    };
    all.filter_map(tile).collect()
}

impl Tile {
    /// The layout there, as a window around the origin.
    fn layout(&self, layout: &BevLayout) -> BevLayout {
        self.to_window.layout(&layout.crop(self.extent))
    }

    /// The boxes that reach into it, moved along.
    fn boxes(&self, boxes: &BTreeMap<BoxId, SceneBox>) -> BTreeMap<BoxId, SceneBox> {
        let (low, high) = (self.extent.min_m(), self.extent.max_m());
        let reaches = |b: &&SceneBox| {
            let reach = b.size_m.truncate().length() / 2.0;
            let p = b.center_m.truncate();
            (p + reach).cmpgt(low.truncate()).all() && (p - reach).cmplt(high.truncate()).all()
        };
        boxes
            .values()
            .filter(reaches)
            .map(|b| (b.id, self.to_window.scene_box(b)))
            .collect()
    }

    fn moved(&self, things: &[Thing], by: Columns) -> Background {
        let pose = scene::Pose {
            rotation: glam::DQuat::IDENTITY,
            translation_m: by.way_m().extend(0.0),
        };
        things.iter().cloned().collect::<Background>().in_frame(&pose)
    }
}

/// What stands beside the roads of a map: what is `there` already, and scenery around it.
pub fn scenery_over(
    layout: &BevLayout,
    boxes: &BTreeMap<BoxId, SceneBox>,
    there: Background,
    seed: u64,
) -> Background {
    let tiles = tiles(layout.extent());
    let drawn: Vec<Background> = tiles
        .par_iter()
        .map(|tile| {
            let [x, y] = tile.extent.from().map(|c| u64::from(c as u32));
            let own_seed = hash(seed ^ hash(x << 32 | y));
            let drawn = scenery::background(&tile.layout(layout), &tile.boxes(boxes), own_seed);
            // What stands in another window, or beyond the map, is that one's.
            let inside = |t: &&Thing| {
                let p = t.form.middle_m();
                let own = Extent::WINDOW.column_at(p.x, p.y).is_some();
                let on_map = p - tile.to_window.way_m();
                own && layout.extent().column_at(on_map.x, on_map.y).is_some()
            };
            let kept: Vec<Thing> = drawn.iter().filter(inside).cloned().collect();
            tile.moved(&kept, tile.to_window.back())
        })
        .collect();
    drawn
        .iter()
        .fold(there, |there, drawn| merged(layout.extent(), there, drawn))
}

/// The voxels of a world over a map.
pub fn occupancy_over(
    layout: &BevLayout,
    boxes: &BTreeMap<BoxId, SceneBox>,
    background: &Background,
    seed: u64,
) -> VoxelGrid {
    let tiles = tiles(layout.extent());
    let parts: Vec<VoxelGrid> = tiles
        .par_iter()
        .map(|tile| {
            let [x, y] = tile.extent.from();
            let wide = Extent::new(
                [x - AROUND as i32, y - AROUND as i32],
                [Window::NX + 2 * AROUND, Window::NY + 2 * AROUND],
            );
            let near = in_extent(wide.unwrap_or(tile.extent), background.iter());
            let things = tile.moved(&near, tile.to_window);
            let world = World::with_background(tile.layout(layout), tile.boxes(boxes), things, seed);
            let grid = complete(&world, Vertical::Occ3d);
            tile.to_window.back().grid(&grid)
        })
        .collect();
    let mut grid = VoxelGrid::over(layout.extent());
    parts.iter().for_each(|part| grid.paste(part));
    grid
}

#[cfg(test)]
mod tests {
    use super::*;
    use scene::{BevLayer, Class};
    use world::template;

    /// On a map that is the window, it is the world that it always was.
    #[test]
    fn a_map_of_one_window_is_that_window() {
        let layout = template::layout("straight", 5).expect("a template");
        let boxes = world::traffic::place(&layout, 5, &world::traffic::TrafficSpec::NORMAL);
        let there = scenery::background(&layout, &boxes, 5);
        let found = occupancy_over(&layout, &boxes, &there, 5);
        let world = World::with_background(layout, boxes, there, 5);
        assert_eq!(found, complete(&world, Vertical::Occ3d));
    }

    #[test]
    fn a_long_road_has_scenery_all_along_and_no_seam_in_it() {
        let extent = Extent::new([-150, -130], [640, 260]).expect("sound");
        let mut layout = BevLayout::over(extent);
        for [x, y] in extent.all_columns() {
            let p = extent.center(x, y, 0);
            layout.set(BevLayer::DrivableArea, x, y, p.y.abs() < 6.0);
            layout.set(BevLayer::Walkway, x, y, (6.0..9.0).contains(&p.y.abs()));
        }
        let boxes = BTreeMap::new();
        let background = scenery_over(&layout, &boxes, Background::default(), 3);
        assert!(background.len() > 60, "{} things", background.len());
        let grid = occupancy_over(&layout, &boxes, &background, 3);
        assert_eq!(grid.extent(), extent);
        let counts = grid.class_counts();
        assert!(counts[Class::Manmade as usize] + counts[Class::Vegetation as usize] > 20_000);
        for x in 0..extent.nx() {
            let [_, y] = extent.column_at(0.0, 0.0).expect("inside");
            assert_eq!(grid.get(x, y, 0), Class::DriveableSurface.id(), "a gap at {x}");
        }
        // Again, and on another number of threads, it is the same.
        let pool = rayon::ThreadPoolBuilder::new()
            .num_threads(1)
            .build()
            .expect("a pool");
        let again = pool.install(|| {
            let background = scenery_over(&layout, &boxes, Background::default(), 3);
            occupancy_over(&layout, &boxes, &background, 3)
        });
        assert_eq!(again, grid);
    }
}
