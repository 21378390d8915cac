//! Map layers from ground labels.

use crate::{BevLayer, BevLayout, Class, VoxelGrid, Window};

/// Columns around a gap that must be road on opposite sides for it to be road: 3.2 m bridges a car's width.
const REACH: usize = 8;

/// Drivable area from driveable surface and walkways from sidewalk. Objects hide the ground that they
/// stand on, and labels have holes: a column without ground that has the same ground on two opposite
/// sides within reach gets it too. The relief is read from the bins that ground lies in.
pub fn layout(labels: &VoxelGrid) -> BevLayout {
    let mut layout = BevLayout::default();
    layout.relief = super::relief(labels);
    for (class, layer) in [
        (Class::DriveableSurface, BevLayer::DrivableArea),
        (Class::Sidewalk, BevLayer::Walkway),
    ] {
        let seen: Vec<bool> = columns(labels).map(|c| c.contains(&class.id())).collect();
        let open: Vec<bool> = columns(labels)
            .map(|c| !c.iter().any(|l| Class::from_id(*l).is_some_and(Class::is_ground)))
            .collect();
        for x in 0..Window::NX {
            for y in 0..Window::NY {
                let at = x * Window::NY + y;
                if seen[at] || (open[at] && between(&seen, x, y)) {
                    layout.set(layer, x, y, true);
                }
            }
        }
    }
    layout
}

fn columns(labels: &VoxelGrid) -> impl Iterator<Item = &[u8; Window::NZ]> {
    (0..Window::COLUMNS).map(|c| labels.column(c / Window::NY, c % Window::NY))
}

/// True if something set lies on both sides along x, along y or along a diagonal.
fn between(seen: &[bool], x: usize, y: usize) -> bool {
    let meets = |dx: isize, dy: isize| {
        (1..=REACH as isize).any(|i| {
            let (x, y) = (x as isize + i * dx, y as isize + i * dy);
            let inside = (0..Window::NX as isize).contains(&x) && (0..Window::NY as isize).contains(&y);
            inside && seen[x as usize * Window::NY + y as usize]
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
}
