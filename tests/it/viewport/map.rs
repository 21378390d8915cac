//! Maps of another extent than the networks' window: all of them is drawn, and edited far out.

use glam::DVec3;
use scene::{BevLayer, Class, Extent, SensorRig, VoxelGrid};
use viewport::meshing::{Solidity, Visible, mesh_bricks};
use viewport::{
    LayoutPlane, MarkedVoxels, ViewCamera, ViewOptions, ViewPreset, ViewScene, Viewport, headless_device,
};

use super::pixels::{hue_apart, scene_of};

const SIZE: [u32; 2] = [320, 240];

fn map() -> Extent {
    Extent::new([-150, -110], [480, 320]).expect("a sound size")
}

/// A wall at x = 100 m, 1.2 m thick, 16 m wide and 4 m high.
fn with_wall() -> VoxelGrid {
    let mut grid = VoxelGrid::over(map());
    let [x, y0] = map().column_at(100.1, -8.0).expect("on the map");
    for i in 0..3 * 40 * 10 {
        grid.set(x + i % 3, y0 + i / 3 % 40, i / 120, Class::Car.id());
    }
    grid
}

fn options() -> ViewOptions {
    ViewOptions {
        grid_lines: false,
        ego: false,
        samples: 1,
        ..ViewOptions::default()
    }
}

fn at(picture: &[u8], camera: &ViewCamera, p: DVec3) -> [u8; 4] {
    let pixel = camera.project(p, SIZE).expect("in view");
    let i = (pixel.y as usize * SIZE[0] as usize + pixel.x as usize) * 4;
    picture[i..i + 4].try_into().expect("four channels")
}

#[test]
fn a_wall_100_m_ahead_is_drawn_where_it_stands() {
    let (_, device, queue) = headless_device().expect("an adapter; apt install mesa-vulkan-drivers");
    let (rig, options) = (SensorRig::default(), options());
    let mut viewport = Viewport::new(&device, &queue);
    let mut picture = |camera: &ViewCamera, scene: &ViewScene<'_>| {
        viewport
            .render_to_image(&device, &queue, camera, scene, SIZE, 1)
            .expect("a picture")
    };
    let wall = with_wall();
    let mut near = ViewCamera::default();
    near.focus(DVec3::new(100.0, 0.0, 1.0), 10.0);
    let mut all = ViewCamera::default();
    all.focus_map(map(), 1.0);
    let (on_wall, on_top) = (DVec3::new(100.0, 0.1, 0.9), DVec3::new(100.6, 0.1, 3.0));
    // A window in between: the textures follow, to and fro.
    let window = VoxelGrid::over(Extent::WINDOW);
    picture(&near, &scene_of(&window, &rig, &options));
    let top = ViewCamera::preset_over(ViewPreset::Top, map());
    for (camera, p) in [(near, on_wall), (all, on_wall), (top, on_top)] {
        let found = at(&picture(&camera, &scene_of(&wall, &rig, &options)), &camera, p);
        let apart = hue_apart(found, Class::Car.color());
        assert!(apart < 14.0, "{found:?} is {apart:.1} degrees off, {camera:?}");
        let bare = at(&picture(&camera, &scene_of(&window, &rig, &options)), &camera, p);
        assert!(
            hue_apart(bare, Class::Car.color()) > 14.0,
            "{bare:?} where there is nothing"
        );
    }
    let cropped = wall.crop(Extent::new([240, -30], [50, 70]).expect("sound"));
    let found = at(
        &picture(&near, &scene_of(&cropped, &rig, &options)),
        &near,
        on_wall,
    );
    assert!(hue_apart(found, Class::Car.color()) < 14.0, "{found:?}");
}

/// Paint on the ground, the plane beside it and cells under the brush, all of them 100 m ahead.
#[test]
fn the_layout_and_the_brush_reach_as_far_as_the_map() {
    let (_, device, queue) = headless_device().expect("an adapter; apt install mesa-vulkan-drivers");
    let extent = map();
    let (mut grid, mut bev) = (VoxelGrid::over(extent), vec![0; extent.columns()]);
    let column = |x_m: f64, y_m: f64| extent.column_at(x_m, y_m).expect("on the map");
    for x_m in 80..120 {
        for y_m in -20..20 {
            for k in 0..9 {
                let [x, y] = column(
                    f64::from(x_m) + 0.4 * f64::from(k / 3),
                    f64::from(y_m) + 0.4 * f64::from(k % 3),
                );
                bev[extent.index(x, y)] = BevLayer::RoadDivider.bit();
                if y_m >= 0 {
                    grid.set(x, y, 0, Class::DriveableSurface.id());
                }
            }
        }
    }
    let options = ViewOptions {
        layout_opacity: 1.0,
        layout_plane: LayoutPlane::WhereEmpty,
        ..options()
    };
    let rig = SensorRig::default();
    let [x, y] = column(100.0, 62.0);
    let cells: Vec<[usize; 3]> = (0..49).map(|i| [x + i / 7, y + i % 7, 0]).collect();
    let brush = [MarkedVoxels {
        voxels: &cells,
        color: [255, 0, 0],
    }];
    let scene = ViewScene {
        bev: &bev,
        brush: &brush,
        ..scene_of(&grid, &rig, &options)
    };
    let camera = ViewCamera::preset_over(ViewPreset::Top, extent);
    let mut viewport = Viewport::new(&device, &queue);
    let picture = viewport
        .render_to_image(&device, &queue, &camera, &scene, SIZE, 1)
        .expect("a picture");
    let found = |x_m: f64, y_m: f64| at(&picture, &camera, DVec3::new(x_m, y_m, -0.6));
    let yellow = BevLayer::RoadDivider.color();
    assert!(
        hue_apart(found(100.0, 10.0), yellow) < 15.0,
        "{:?}",
        found(100.0, 10.0)
    );
    assert_eq!(found(100.0, -10.0)[..3], yellow);
    assert!(
        hue_apart(found(60.0, 10.0), yellow) > 15.0,
        "{:?}",
        found(60.0, 10.0)
    );
    let red = found(101.2, 63.2);
    assert!(red[0] > red[1] + 40, "{red:?} under the brush");
}

/// The faces of the wall, and that an edit beside it draws a small part of the picture.
#[test]
fn an_edit_far_out_meshes_its_bricks_and_draws_its_pixels() {
    let mut grid = with_wall();
    let solid = Solidity::from_grid(&grid, Visible::ALL);
    let bricks: Vec<usize> = (0..grid.bricks().len()).collect();
    let meshes = mesh_bricks(&grid, &solid, &bricks);
    // Each side is cut at the borders of bricks: 40 voxels along y lie in three of them.
    let quads: usize = meshes.iter().map(|m| m.vertices.len() / 4).sum();
    let [_, y0] = map().column_at(100.1, -8.0).expect("on the map");
    let parts = (y0 + 39) / 16 - y0 / 16 + 1;
    assert_eq!(quads, parts * 4 + 2);
    let held: Vec<usize> = bricks
        .iter()
        .copied()
        .filter(|b| !meshes[*b].vertices.is_empty())
        .collect();
    assert_eq!(held.len(), parts);

    let (_, device, queue) = headless_device().expect("an adapter; apt install mesa-vulkan-drivers");
    let (rig, options) = (SensorRig::default(), options());
    let mut camera = ViewCamera::default();
    camera.focus(DVec3::new(100.0, 0.0, 1.0), 25.0);
    let mut kept = Viewport::new(&device, &queue);
    let [w, h] = SIZE;
    kept.render(&device, &queue, &camera, &scene_of(&grid, &rig, &options), w, h);
    assert_eq!(kept.voxel_quads(), quads);
    let before = grid.clone();
    let [x, y] = map().column_at(97.0, 3.0).expect("on the map");
    grid.set(x, y, 0, Class::Pedestrian.id());
    assert_eq!(grid.changed_bricks(&before).len(), 1);
    assert!(kept.render(&device, &queue, &camera, &scene_of(&grid, &rig, &options), w, h));
    let [_, _, across, down] = kept.drawn_rect();
    assert!(across * down < w * h / 3, "{across} x {down} pixels drawn");
    assert_eq!(kept.voxel_quads(), quads + 6);
    let mut fresh = Viewport::new(&device, &queue);
    fresh.render(&device, &queue, &camera, &scene_of(&grid, &rig, &options), w, h);
    let shown = kept.shown(&device, &queue).expect("read back");
    let whole = fresh.shown(&device, &queue).expect("read back");
    assert!(shown == whole);
}
