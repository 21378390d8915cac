//! Figures of how well roads come back when they are written and read again, and a picture to look at.

use std::collections::BTreeMap;
use std::path::PathBuf;

use glam::DVec2;

use super::*;
use crate::loom;
use scene::road_map::{project, resampled};
use scene::{BevLayer, Extent, PolylineKind, Window};

/// Figures of how well a layout came back.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct RoundTripFigures {
    /// Overlap of paved ground (roads and car parks) and of walkways, 0 to 1.
    pub road: f64,
    pub walkway: f64,
    /// Share of the lanes of the layout within half a metre of one that came back, and the other way round.
    pub lanes: f64,
    pub lanes_back: f64,
}

fn iou(a: &BevLayout, b: &BevLayout, bits: u32) -> f64 {
    let (mut both, mut either) = (0, 0);
    for (a, b) in a.cells().iter().zip(b.cells()) {
        let (a, b) = (a & bits != 0, b & bits != 0);
        both += usize::from(a && b);
        either += usize::from(a || b);
    }
    if either == 0 {
        1.0
    } else {
        both as f64 / either as f64
    }
}

pub(super) fn lanes(layout: &BevLayout) -> Vec<Vec<DVec2>> {
    let extent = layout.extent();
    let corners = (extent.min_m().truncate(), extent.max_m().truncate());
    let lines = layout
        .polylines
        .iter()
        .filter(|l| l.kind == PolylineKind::LaneCenter);
    lines
        .flat_map(|l| crate::opendrive::lines::clipped(&l.points_m, corners))
        .collect()
}

/// Share of the length of lines that lies within half a metre of others that run as they do.
fn near(lines: &[Vec<DVec2>], others: &[Vec<DVec2>]) -> f64 {
    let (mut all, mut found) = (0.0, 0.0);
    for line in lines {
        let length: f64 = line.windows(2).map(|w| w[0].distance(w[1])).sum();
        let even = resampled(line, (length / 0.5).ceil().max(1.0) as usize + 1);
        for pair in even.windows(2) {
            let (p, way) = (pair[0].midpoint(pair[1]), pair[0].distance(pair[1]));
            let ahead = (pair[1] - pair[0]).normalize_or_zero();
            let mut hits = others.iter().filter_map(|o| project(o, p));
            all += way;
            if hits.any(|h| h.distance_m <= 0.5 && h.direction.dot(ahead) > 0.8) {
                found += way;
            }
        }
    }
    if all == 0.0 { 1.0 } else { found / all }
}

pub(super) fn figures(layout: &BevLayout, found: &BevLayout) -> RoundTripFigures {
    let vehicles = BevLayer::DrivableArea.bit() | BevLayer::CarparkArea.bit();
    let (a, b) = (lanes(layout), lanes(found));
    RoundTripFigures {
        road: iou(layout, found, vehicles),
        walkway: iou(layout, found, BevLayer::Walkway.bit()),
        lanes: near(&a, &b),
        lanes_back: near(&b, &a),
    }
}

pub(super) fn read_back(layout: &BevLayout, detail: Detail) -> crate::opendrive::LayoutImport {
    let text = to_text("test", layout, detail);
    let network = crate::opendrive::read(text.as_bytes()).unwrap_or_else(|e| panic!("{e}"));
    network.to_layout_over(layout.extent(), DVec2::ZERO, 0.0)
}

/// The layouts of a file: of a scene, or cut out of a network where a scene would begin; of the whole network if `SCENELOOM_WHOLE`
/// is set.
fn layout_of(path: &std::path::Path) -> BevLayout {
    let bytes = std::fs::read(path).expect("read");
    if let Ok(scene) = loom::from_bytes(&bytes) {
        return scene.canvas().layout.clone();
    }
    let network = crate::opendrive::read(&bytes).expect("roads");
    if std::env::var("SCENELOOM_WHOLE").is_err() {
        let (at_m, heading_rad) = network.suggest_pose();
        return network.to_layout(at_m, heading_rad).layout;
    }
    let [low, high] = network.bounds_m();
    let column = |m: f64| (m / Window::VOXEL_M).floor() as i32;
    let from = (low - 24.0).to_array().map(column);
    let size = ((high - low + 48.0) / Window::VOXEL_M)
        .to_array()
        .map(|n| n as usize + 1);
    let extent = Extent::new(from, size).expect("a map");
    network.to_layout_over(extent, DVec2::ZERO, 0.0).layout
}

/// Figures of many scenes by kind of street: `SCENELOOM_LOOMS=folder [SCENELOOM_OUT=folder] cargo test -p sceneloom-formats --lib
/// write::measure -- --ignored --nocapture`. `SCENELOOM_ONLY` is a part of the names.
#[test]
#[ignore = "reads scenes that the program makes"]
fn figures_of_many_scenes() {
    let folder = PathBuf::from(std::env::var("SCENELOOM_LOOMS").expect("a folder of scenes"));
    let out = std::env::var("SCENELOOM_OUT").ok().map(PathBuf::from);
    let only = std::env::var("SCENELOOM_ONLY").unwrap_or_default();
    let entries = std::fs::read_dir(folder).expect("a folder");
    let mut files: Vec<PathBuf> = entries.map(|e| e.expect("an entry").path()).collect();
    files.retain(|p| p.extension().is_some_and(|e| e == "loom" || e == "xodr"));
    files.retain(|p| p.to_string_lossy().contains(&only));
    files.sort();
    let mut of_kind: BTreeMap<String, Vec<[RoundTripFigures; 2]>> = BTreeMap::new();
    for path in &files {
        let name = path.file_stem().expect("a name").to_string_lossy().into_owned();
        let layout = layout_of(path);
        let since = std::time::Instant::now();
        let own = read_back(&layout, Detail::Rows);
        assert!(
            own.is_own && own.layout == layout,
            "{name} comes back to the last bit"
        );
        let took = since.elapsed();
        let both = [Detail::Roads, Detail::Areas].map(|detail| {
            let found = read_back(&layout, detail).layout;
            if let Some(out) = &out {
                picture(&out.join(format!("{name}-{detail:?}.png")), &layout, &found);
                let text = to_text(&name, &layout, detail);
                std::fs::write(out.join(format!("{name}-{detail:?}.xodr")), text).expect("written");
            }
            figures(&layout, &found)
        });
        println!("{name} {} ({took:.1?}): {both:.3?}", layout.extent());
        let kind = name
            .rsplit_once('-')
            .map_or(name.clone(), |(kind, _)| kind.to_owned());
        of_kind.entry(kind).or_default().push(both);
    }
    for (kind, all) in &of_kind {
        let mean =
            |of: &dyn Fn(&[RoundTripFigures; 2]) -> f64| all.iter().map(of).sum::<f64>() / all.len() as f64;
        println!(
            "{kind:14} road {:.3} {:.3}  walkway {:.3} {:.3}  lanes {:.3} back {:.3}  ({} scenes)",
            mean(&|f| f[0].road),
            mean(&|f| f[1].road),
            mean(&|f| f[0].walkway),
            mean(&|f| f[1].walkway),
            mean(&|f| f[0].lanes),
            mean(&|f| f[0].lanes_back),
            all.len()
        );
    }
}

/// Missing ground in red, surplus ground in blue, agreeing ground in grey; lanes of the layout dark, lanes that came
/// back green.
pub(crate) fn picture(path: &std::path::Path, layout: &BevLayout, found: &BevLayout) {
    let extent = layout.extent();
    let scale = 4;
    let (w, h) = (extent.nx() * scale, extent.ny() * scale);
    let mut image = image::RgbImage::new(w as u32, h as u32);
    let place = |x: usize, y: usize| ((x) as u32, (h - 1 - y) as u32);
    for [x, y] in extent.all_columns() {
        let bits = [layout, found].map(|l| {
            let c = l.cell(x, y);
            if c & (BevLayer::DrivableArea.bit() | BevLayer::CarparkArea.bit()) != 0 {
                1
            } else if c & BevLayer::Walkway.bit() != 0 {
                2
            } else {
                0
            }
        });
        let color = match bits {
            [1, 1] => [150, 150, 150],
            [2, 2] => [200, 190, 160],
            [0, 0] => [255, 255, 255],
            [1, _] => [255, 80, 80],
            [2, _] => [255, 170, 120],
            [_, 1] => [80, 80, 255],
            _ => [150, 170, 255],
        };
        for (dx, dy) in (0..scale).flat_map(|dx| (0..scale).map(move |dy| (dx, dy))) {
            let (px, py) = place(x * scale + dx, y * scale + dy);
            image.put_pixel(px, py, image::Rgb(color));
        }
    }
    let mut draw = |lines: &[Vec<DVec2>], color: [u8; 3]| {
        for line in lines {
            let length: f64 = line.windows(2).map(|w| w[0].distance(w[1])).sum();
            for p in resampled(line, (length * 20.0) as usize + 2) {
                let q = (p - extent.min_m().truncate()) * extent.lattice().per_m() * scale as f64;
                if q.x >= 0.0 && q.y >= 0.0 && (q.x as usize) < w && (q.y as usize) < h {
                    let (px, py) = place(q.x as usize, q.y as usize);
                    image.put_pixel(px, py, image::Rgb(color));
                }
            }
        }
    };
    draw(&lanes(layout), [60, 60, 60]);
    draw(&lanes(found), [0, 150, 0]);
    image.save(path).expect("written");
}
