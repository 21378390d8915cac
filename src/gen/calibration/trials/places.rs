//! Places for the edits that `eval editing` tries.

use glam::DVec3;

use scene::raster::{box_cells, disc_cells};
use scene::{BevLayer, BoxId, BoxLabel, Class, Extent, Frame, PolylineKind, SceneBox, Window};
use world::draw::Draw;

/// A free place on road along the nearest lane, for a new box of a class or for `moved`.
pub fn on_free_road(frame: &Frame, class: Class, moved: Option<SceneBox>, seed: u64) -> Option<SceneBox> {
    let mut draw = Draw::new(seed, "free road");
    let objects: u32 = Class::OBJECTS
        .iter()
        .filter_map(|c| BevLayer::of_object(*c))
        .map(BevLayer::bit)
        .sum();
    let cells = frame.bev_channels();
    let lanes: Vec<_> = frame
        .layout
        .polylines
        .iter()
        .filter(|l| l.kind == PolylineKind::LaneCenter)
        .collect();
    let size_m = match moved {
        Some(b) => b.size_m,
        None => DVec3::from_array(class.typical_size_m()?),
    };
    for _ in 0..400 {
        let lane = lanes.get(draw.below(lanes.len()))?;
        let k = draw.below(lane.points_m.len().saturating_sub(1));
        let (a, b) = (*lane.points_m.get(k)?, *lane.points_m.get(k + 1)?);
        let ground_m = frame.layout.relief.height_m(a);
        let placed = SceneBox {
            id: moved.map_or(BoxId(0), |b| b.id),
            class,
            center_m: a.extend(ground_m + size_m.z / 2.0),
            size_m,
            yaw_rad: (b - a).to_angle(),
            velocity_mps: glam::DVec2::ZERO,
            label: BoxLabel::default(),
        };
        let mut free = placed.footprint().iter().all(|c| c.abs().max_element() < 38.0) && a.length() > 6.0;
        box_cells(Extent::WINDOW, &placed, 0.8, |x, y| {
            free &= cells[x * Window::NY + y] & objects == 0
        });
        box_cells(Extent::WINDOW, &placed, 0.0, |x, y| {
            free &= frame.layout.has(BevLayer::DrivableArea, x, y)
        });
        if free {
            return Some(placed);
        }
    }
    None
}

/// Columns beside a road that only ground covers, two metres around a random place.
pub fn verge(frame: &Frame, seed: u64) -> Option<Vec<[usize; 2]>> {
    let mut draw = Draw::new(seed, "verge");
    let is_road = |x: usize, y: usize| frame.layout.has(BevLayer::DrivableArea, x, y);
    let bare = |x: usize, y: usize| {
        let column = frame.occupancy.column(x, y);
        let ground = |l: &u8| *l == Class::FREE || Class::from_id(*l).is_some_and(Class::is_ground);
        !is_road(x, y) && column.iter().all(ground)
    };
    for _ in 0..400 {
        let (x, y) = (10 + draw.below(180), 10 + draw.below(180));
        let beside = bare(x, y)
            && [(x - 3, y), (x + 3, y), (x, y - 3), (x, y + 3)]
                .iter()
                .any(|(x, y)| is_road(*x, *y));
        let mut cells = Vec::new();
        disc_cells(Extent::WINDOW, Window::center(x, y, 0).truncate(), 2.0, |x, y| {
            if bare(x, y) {
                cells.push([x, y]);
            }
        });
        if beside && cells.len() >= 40 {
            return Some(cells);
        }
    }
    None
}

/// Columns of a crossing, three metres wide, over the road at a random place of a lane.
pub fn across_the_road(frame: &Frame, seed: u64) -> Option<Vec<[usize; 2]>> {
    let mut draw = Draw::new(seed, "crossing");
    let cells = frame.bev_channels();
    let road_only =
        |x: usize, y: usize| cells[x * Window::NY + y] & !line_bits() == BevLayer::DrivableArea.bit();
    let lanes: Vec<_> = frame
        .layout
        .polylines
        .iter()
        .filter(|l| l.kind == PolylineKind::LaneCenter && l.points_m.len() > 1)
        .collect();
    for _ in 0..100 {
        let lane = lanes.get(draw.below(lanes.len()))?;
        let k = draw.below(lane.points_m.len() - 1);
        let (a, b) = (lane.points_m[k], lane.points_m[k + 1]);
        if a.abs().max_element() > 34.0 {
            continue;
        }
        let across = (b - a).normalize_or_zero().perp();
        let mut found = Vec::new();
        for i in -20..=20 {
            disc_cells(
                Extent::WINDOW,
                a + across * (f64::from(i) * scene::Window::VOXEL_M),
                1.5,
                |x, y| {
                    if road_only(x, y) {
                        found.push([x, y]);
                    }
                },
            );
        }
        found.sort_unstable();
        found.dedup();
        if found.len() >= 60 {
            return Some(found);
        }
    }
    None
}

/// Lines that may run over a road.
fn line_bits() -> u32 {
    BevLayer::RoadDivider.bit() | BevLayer::LaneDivider.bit() | BevLayer::StopLine.bit()
}
