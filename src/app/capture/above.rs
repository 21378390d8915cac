//! Pictures of a scene from above, ahead is up: as large as fits the frame, centred.

use anyhow::Context;
use image::imageops::{FilterType, resize};

use scene::raster::box_cells;
use scene::{BevLayer, BoxId, Class, Extent, Scene, SceneBox};
use sensors::lidar::recorded;

use super::{BEHIND, Subject};
use crate::picture::{self, RgbaPicture};

/// Brightness of scenery on the map, of 255.
const SCENERY: u16 = 150;
/// Colour of the ego vehicle.
pub(super) const EGO_COLOR: [u8; 3] = [235, 238, 242];

/// Pixels per metre of a map that fills a frame.
pub(super) fn per_m(scene: &Scene, size: [u32; 2]) -> f64 {
    let extent = scene.frame().extent();
    per_column(extent, size) * extent.nx() as f64 / (extent.max_m() - extent.min_m()).x
}

fn per_column(extent: Extent, [width, height]: [u32; 2]) -> f64 {
    (f64::from(width) / extent.ny() as f64).min(f64::from(height) / extent.nx() as f64)
}

/// A picture of the size `size`, pixels. Cells are drawn at a whole number of pixels, then scaled down.
pub(super) fn picture(scene: &Scene, subject: Subject, size: [u32; 2]) -> anyhow::Result<RgbaPicture> {
    let frame = scene.frame();
    let extent = frame.extent();
    let wanted = per_column(extent, size);
    let scale = wanted.ceil().max(1.0) as usize;
    let drawn = match subject {
        Subject::Occupancy => picture::occupancy_top(&frame.occupancy, scale),
        Subject::Lidar => picture::lidar_top(extent, &recorded::sweep_or_exact(&scene.for_sensors()), scale),
        _ => map(scene, scale),
    };
    let [w, h] = [extent.ny(), extent.nx()].map(|n| ((n as f64 * wanted) as u32).max(1));
    let fitted = match [w, h] == [drawn.width as u32, drawn.height as u32] {
        true => drawn,
        false => {
            let whole = image::RgbaImage::from_raw(drawn.width as u32, drawn.height as u32, drawn.rgba);
            let whole = whole.context("a picture has four bytes per pixel")?;
            RgbaPicture {
                width: w as usize,
                height: h as usize,
                rgba: resize(&whole, w, h, FilterType::Triangle).into_raw(),
            }
        }
    };
    let [width, height] = size.map(|s| s as usize);
    let mut out = RgbaPicture::filled(width, height, BEHIND);
    let middle = |whole: usize, part: usize| whole.saturating_sub(part) / 2;
    out.put(
        &fitted,
        middle(width, fitted.width),
        middle(height, fitted.height),
    );
    Ok(out)
}

/// The layout, the boxes, the scenery and the ego vehicle.
fn map(scene: &Scene, scale: usize) -> RgbaPicture {
    let frame = scene.frame();
    let extent = frame.extent();
    let mut out = picture::layout_top(frame, scale);
    let mut boxes = vec![false; extent.columns()];
    for b in frame.boxes.values() {
        box_cells(extent, b, 0.0, |x, y| boxes[extent.index(x, y)] = true);
    }
    for [x, y] in extent.all_columns() {
        let bare = !boxes[extent.index(x, y)] && !BevLayer::MAP.iter().any(|l| frame.layout.has(*l, x, y));
        if let Some(class) = scenery(frame.occupancy.column(x, y)).filter(|_| bare) {
            out.fill_column(extent, [x, y], scale, scenery_color(class));
        }
    }
    box_cells(extent, &ego(scene), 0.0, |x, y| {
        out.fill_column(extent, [x, y], scale, EGO_COLOR)
    });
    out
}

/// The colour of scenery of a class.
pub(super) fn scenery_color(class: Class) -> [u8; 3] {
    class.color().map(|c| (u16::from(c) * SCENERY / 255) as u8)
}

/// The scenery classes that top at least one column of the map.
pub(super) fn sceneries(scene: &Scene) -> Vec<Class> {
    let frame = scene.frame();
    let tops = frame.extent().all_columns();
    let tops: Vec<Class> = tops
        .filter_map(|[x, y]| scenery(frame.occupancy.column(x, y)))
        .collect();
    let mut all = vec![Class::Manmade, Class::Vegetation];
    all.retain(|c| tops.contains(c));
    all
}

/// The scenery class on top of a column; `None` if another class is on top.
fn scenery(column: &[u8]) -> Option<Class> {
    let top = column.iter().rev().find(|v| **v != Class::FREE)?;
    Class::from_id(*top).filter(|c| matches!(c, Class::Manmade | Class::Vegetation))
}

/// The ego vehicle as a box on the map.
fn ego(scene: &Scene) -> SceneBox {
    let in_ego = SceneBox {
        id: BoxId(0),
        class: Class::Car,
        center_m: scene.rig.ego_center_m.into(),
        size_m: scene.rig.ego_size_m.into(),
        yaw_rad: 0.0,
        velocity_mps: Default::default(),
        label: Default::default(),
    };
    in_ego.in_frame(&scene.frame().world_from_ego)
}
