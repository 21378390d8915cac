//! Map layers from ground labels.

use crate::{BevLayer, BevLayout, Class, Extent, VoxelGrid};

/// Distance from a gap within which road must be on opposite sides for it to be road, m: bridges a car's width.
const REACH_M: f64 = 3.2;

/// Drivable area from driveable surface and walkways from sidewalk. Objects hide the ground that they
/// stand on, and labels have holes: a column without ground that has the same ground on two opposite
/// sides within reach gets it too. The relief is read from the bins that ground lies in.
pub fn layout(labels: &VoxelGrid) -> BevLayout {
    let extent = labels.extent();
    let mut layout = BevLayout::over(extent);
    layout.relief = super::relief(labels);
    for (class, layer) in [
        (Class::DriveableSurface, BevLayer::DrivableArea),
        (Class::Sidewalk, BevLayer::Walkway),
    ] {
        let seen: Vec<bool> = columns(labels).map(|c| c.contains(&class.id())).collect();
        let open: Vec<bool> = columns(labels)
            .map(|c| !c.iter().any(|l| Class::from_id(*l).is_some_and(Class::is_ground)))
            .collect();
        for (at, [x, y]) in extent.all_columns().enumerate() {
            if seen[at] || (open[at] && between(extent, &seen, x, y)) {
                layout.set(layer, x, y, true);
            }
        }
    }
    layout
}

fn columns(labels: &VoxelGrid) -> impl Iterator<Item = &[u8]> {
    let columns = labels.extent().all_columns();
    columns.map(|[x, y]| labels.column(x, y))
}

/// True if something set lies on both sides along x, along y or along a diagonal.
fn between(extent: Extent, seen: &[bool], x: usize, y: usize) -> bool {
    let [nx, ny] = [extent.nx(), extent.ny()].map(|n| n as isize);
    let reach = (REACH_M * extent.lattice().per_m()).round() as isize;
    let meets = |dx: isize, dy: isize| {
        (1..=reach).any(|i| {
            let (x, y) = (x as isize + i * dx, y as isize + i * dy);
            let inside = (0..nx).contains(&x) && (0..ny).contains(&y);
            inside && seen[extent.index(x as usize, y as usize)]
        })
    };
    [(1, 0), (0, 1), (1, 1), (1, -1)]
        .into_iter()
        .any(|(dx, dy)| meets(dx, dy) && meets(-dx, -dy))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn road_goes_on_under_a_car_and_over_holes_but_not_beyond() {
        let mut labels = VoxelGrid::new();
        for x in 0..200 {
            for y in 80..120 {
                labels.set(x, y, 0, Class::DriveableSurface.id());
            }
            for y in 120..126 {
                labels.set(x, y, 1, Class::Sidewalk.id());
            }
        }
        for x in 50..62 {
            for y in 95..100 {
                for z in 0..5 {
                    labels.set(x, y, z, Class::Car.id());
                }
            }
        }
        labels.set(150, 100, 0, Class::FREE);
        let layout = layout(&labels);
        assert!(layout.has(BevLayer::DrivableArea, 55, 97));
        assert!(layout.has(BevLayer::DrivableArea, 150, 100));
        assert_eq!(layout.count(BevLayer::DrivableArea), 200 * 40);
        assert_eq!(layout.count(BevLayer::Walkway), 200 * 6);
    }

    #[test]
    fn a_map_of_any_extent_is_read_as_its_window_is() {
        let extent = Extent::new([-300, 40], [260, 230]).expect("sound");
        let (mut labels, mut window) = (VoxelGrid::over(extent), VoxelGrid::new());
        for (x, y) in (20..180).flat_map(|x| (70..110).map(move |y| (x, y))) {
            let bin = x / 40;
            labels.set(x, y, bin, Class::DriveableSurface.id());
            window.set(x, y, bin, Class::DriveableSurface.id());
        }
        let (found, expected) = (layout(&labels), layout(&window));
        assert_eq!(found.extent(), extent);
        assert_eq!(
            found.count(BevLayer::DrivableArea),
            expected.count(BevLayer::DrivableArea)
        );
        assert_eq!(found.relief.column_m(90, 90), expected.relief.column_m(90, 90));
        assert!(found.relief.column_m(150, 90) > 0.8);
    }
}
