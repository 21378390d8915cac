//! Worlds over maps larger than the window of procedural scenery and voxelisation: window by window on a fixed lattice,
//! each with a seed of its own place.

use std::collections::BTreeMap;

use rayon::prelude::*;

use super::scenery_around::OccupiedColumns;
use scene::background::in_extent;
use scene::moved::ColumnShift;
use scene::{Background, BevLayout, BoxId, Extent, Form, SceneBox, Thing, VoxelGrid, Window};
use world::World;
use world::draw::hash;
use world::scenery;
use world::voxelize::{Vertical, complete};

/// Distance from which things of a neighbouring window may reach into this one, columns.
const AROUND: usize = 40;

/// One window of the lattice.
#[derive(Clone, Copy)]
struct Tile {
    /// Its part of the map.
    extent: Extent,
    /// The move that brings it to the origin.
    to_window: ColumnShift,
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
            to_window: ColumnShift(middle),
        })
    };
    all.filter_map(tile).collect()
}

impl Tile {
    /// The layout in its part of the map, as a window around the origin.
    fn layout(&self, layout: &BevLayout) -> BevLayout {
        self.to_window.layout(&layout.crop(self.extent))
    }

    /// The boxes that reach into it, moved along with it.
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

    fn moved(&self, things: &[Thing], by: ColumnShift) -> Background {
        let pose = scene::Pose {
            rotation: glam::DQuat::IDENTITY,
            translation_m: by.way_m().extend(0.0),
        };
        things.iter().cloned().collect::<Background>().in_frame(&pose)
    }
}

/// Scenery of a map: the things of `there`, and procedural scenery around them, as much as a scene can hold. Also the
/// number of drawn things that were left out because a scene cannot hold them.
pub fn scenery_over(
    layout: &BevLayout,
    boxes: &BTreeMap<BoxId, SceneBox>,
    there: Background,
    seed: u64,
) -> (Background, usize) {
    let tiles = tiles(layout.extent());
    let drawn: Vec<Background> = tiles
        .par_iter()
        .map(|tile| {
            let [x, y] = tile.extent.from().map(|c| u64::from(c as u32));
            let own_seed = hash(seed ^ hash(x << 32 | y));
            let drawn = scenery::background(&tile.layout(layout), &tile.boxes(boxes), own_seed);
            // A thing whose middle is in another window belongs to that window; beyond the map there are none.
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
    // Things of a window keep clear of those of the windows before it.
    let mut taken = OccupiedColumns::by(layout.extent(), there.iter().map(|t| &t.form));
    let mut forms: Vec<&Form> = Vec::new();
    for drawn in &drawn {
        let before = forms.len();
        forms.extend(drawn.iter().map(|t| &t.form).filter(|form| taken.is_free(form)));
        forms[before..].iter().for_each(|form| taken.add(form));
    }
    let room = Background::MAX_THINGS.saturating_sub(there.len());
    let kept = thinned(&forms, room);
    let left_out = forms.len() - kept.len();
    let mut out = there;
    for form in kept {
        out.add(form.clone());
    }
    (out, left_out)
}

/// A selection of forms of at most `room`, evenly over the map; plants and posts are dropped before buildings, walls
/// and bridges.
fn thinned<'a>(forms: &[&'a Form], room: usize) -> Vec<&'a Form> {
    let is_small = |form: &Form| matches!(form, Form::Tree(_) | Form::Post(_) | Form::Shrubs(_));
    let small = forms.iter().filter(|form| is_small(form)).count();
    let large = forms.len() - small;
    let room_of = [large.min(room), small.min(room - large.min(room))];
    let mut met = [0; 2];
    let mut keeps = |form: &&&Form| {
        let kind = usize::from(is_small(form));
        let (n, of, most) = (met[kind], [large, small][kind], room_of[kind]);
        met[kind] += 1;
        n * most / of != (n + 1) * most / of
    };
    forms.iter().filter(|form| keeps(form)).copied().collect()
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
    use glam::DVec2;
    use scene::background::{Building, Tree, TreeKind};
    use scene::{BevLayer, Class};
    use world::template;

    /// On a map of one window, the world is that of the window.
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
        let (background, left_out) = scenery_over(&layout, &boxes, Background::default(), 3);
        assert_eq!(left_out, 0);
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
            let (background, _) = scenery_over(&layout, &boxes, Background::default(), 3);
            occupancy_over(&layout, &boxes, &background, 3)
        });
        assert_eq!(again, grid);
    }

    /// An earlier version worked for 104 s on a map with 30,075 things and then refused it.
    #[test]
    fn more_than_a_scene_holds_is_thinned_evenly() {
        let tree = |x: usize| {
            Form::Tree(Tree {
                position_m: DVec2::new(x as f64, 0.0),
                height_m: 6.0,
                crown_radius_m: 1.5,
                kind: TreeKind::Broadleaf,
            })
        };
        let house = |x: usize| {
            let at = DVec2::new(x as f64, 20.0);
            Form::Building(Building::rectangle(at, DVec2::splat(5.0), DVec2::X, 9.0))
        };
        let all: Vec<Form> = (0..900)
            .map(|x| if x % 9 == 0 { house(x) } else { tree(x) })
            .collect();
        let forms: Vec<&Form> = all.iter().collect();
        assert_eq!(thinned(&forms, 900), forms);
        let kept = thinned(&forms, 300);
        assert_eq!(kept.len(), 300);
        let houses = |forms: &[&Form]| forms.iter().filter(|f| matches!(f, Form::Building(_))).count();
        assert_eq!(houses(&kept), 100);
        // A third of the trees of every part: 200 of 800.
        for part in 0..10 {
            let within = |f: &&&Form| (part * 90..part * 90 + 90).contains(&(f.middle_m().x as usize));
            let trees = kept.iter().filter(within).count() - 10;
            assert!((19..=21).contains(&trees), "{trees}");
        }
        assert_eq!(houses(&thinned(&forms, 40)), 40);
        assert_eq!(thinned(&forms, 40).len(), 40);
        assert!(thinned(&forms, 0).is_empty());
    }
}
