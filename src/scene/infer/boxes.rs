//! Oriented boxes from object voxels: connected columns of one class, the rectangle of least area around
//! them, and the class's usual size where the labels show too little or several objects at once.

use std::collections::BTreeMap;

use glam::{DVec2, DVec3};

use crate::{BoxId, BoxLabel, Class, Extent, Frame, Lattice, Relief, SceneBox, VoxelGrid, Window};

/// Fewest voxels of a component that is worth a box.
const LEAST_VOXELS: usize = 4;
/// A component this many times as long or wide as the class usually is holds several objects.
const SEVERAL: f64 = 1.6;
/// Objects are two voxels taller in these labels than they are: the ground lies in bin 0.
const SMEAR_M: f64 = 2.0 * Window::VOXEL_M;

/// A box for every object in the labels, [`Frame::MAX_BOXES`] at most. Which end of it is the front is a guess.
pub fn boxes(labels: &VoxelGrid) -> BTreeMap<BoxId, SceneBox> {
    let mut out = BTreeMap::new();
    let relief = super::relief(labels);
    for class in Class::OBJECTS {
        for component in components(labels, class, &relief) {
            for part in split(class, &component) {
                if out.len() >= Frame::MAX_BOXES {
                    return out;
                }
                let id = BoxId(out.len() as u32 + 1);
                let mut b = part.to_box(id, class);
                b.center_m.z += relief.height_m(b.center_m.truncate());
                out.insert(id, b);
            }
        }
    }
    out
}

/// Boxes around voxels `[x, y, z]` of one class on a map that are taken to touch each other; several where they are too many
/// for one object. The ids count from 1.
pub fn boxes_around(extent: Extent, class: Class, voxels: &[[usize; 3]]) -> Vec<SceneBox> {
    let mut columns: Vec<[usize; 2]> = voxels.iter().map(|&[x, y, _]| [x, y]).collect();
    columns.sort_unstable();
    columns.dedup();
    // As the labels of Occ3D have it, whose bin of the same height counts.
    let top =
        |z: usize| Lattice::OCC3D.bin(extent.center(0, 0, z).z + (extent.voxel_m() - Window::VOXEL_M) / 2.0);
    let component = Component {
        points_m: columns
            .iter()
            .map(|&[x, y]| extent.center(x, y, 0).truncate())
            .collect(),
        top: voxels.iter().map(|v| v[2]).max().map_or(0, top),
    };
    if component.points_m.is_empty() {
        return Vec::new();
    }
    let parts = split(class, &component).into_iter().zip(1..);
    parts.map(|(part, id)| part.to_box(BoxId(id), class)).collect()
}

/// Columns of one object: centres on the ground and the highest voxel, counted from the bin of the ground.
struct Component {
    points_m: Vec<DVec2>,
    top: usize,
}

/// Connected columns (8 neighbours) that hold a class; small ones are left out.
fn components(labels: &VoxelGrid, class: Class, relief: &Relief) -> Vec<Component> {
    let height = |c: usize| {
        let column = labels.column(c / Window::NY, c % Window::NY);
        let top = column.iter().rposition(|l| *l == class.id())?;
        Some(top.saturating_sub(Lattice::OCC3D.ground_bin(relief.column_m(c / Window::NY, c % Window::NY))))
    };
    let voxels = |c: usize| {
        let column = labels.column(c / Window::NY, c % Window::NY);
        column.iter().filter(|l| **l == class.id()).count()
    };
    let mut seen = vec![false; Window::COLUMNS];
    let mut out = Vec::new();
    for start in 0..Window::COLUMNS {
        if seen[start] || height(start).is_none() {
            continue;
        }
        seen[start] = true;
        let mut part = vec![start];
        let mut next = 0;
        while next < part.len() {
            let (x, y) = (part[next] / Window::NY, part[next] % Window::NY);
            next += 1;
            for x in x.saturating_sub(1)..=(x + 1).min(Window::NX - 1) {
                for y in y.saturating_sub(1)..=(y + 1).min(Window::NY - 1) {
                    let near = x * Window::NY + y;
                    if height(near).is_some() && !std::mem::replace(&mut seen[near], true) {
                        part.push(near);
                    }
                }
            }
        }
        if part.iter().map(|c| voxels(*c)).sum::<usize>() >= LEAST_VOXELS {
            let center = |c: &usize| Window::center(c / Window::NY, c % Window::NY, 0).truncate();
            out.push(Component {
                points_m: part.iter().map(center).collect(),
                top: part.iter().filter_map(|c| height(*c)).max().unwrap_or(0),
            });
        }
    }
    out
}

/// An upright rectangle on the ground.
#[derive(Clone, Copy, Debug)]
struct BoxFootprint {
    center_m: DVec2,
    /// Along the heading and across it.
    size_m: DVec2,
    yaw_rad: f64,
    height_m: f64,
}

impl BoxFootprint {
    fn to_box(self, id: BoxId, class: Class) -> SceneBox {
        SceneBox {
            id,
            class,
            center_m: self.center_m.extend(self.height_m / 2.0),
            size_m: self.size_m.extend(self.height_m),
            yaw_rad: self.yaw_rad,
            velocity_mps: DVec2::ZERO,
            label: BoxLabel::default(),
        }
    }
}

/// Share of a rectangle's area that must be columns for it to count as filled.
const FILLED: f64 = 0.7;

/// Centre, length, width and heading of the rectangle around the columns; length is the longer side. The
/// heading is that of least area, by trying headings a degree apart; where the columns fill it, their
/// second moments tell it more exactly.
fn around(points: &[DVec2]) -> (DVec2, DVec2, f64) {
    let headings = (0..90).map(|degree| f64::from(degree).to_radians());
    let least = |yaw: &f64| {
        let (_, size) = extent(points, *yaw);
        size.x * size.y
    };
    let mut yaw = headings
        .min_by(|a, b| least(a).total_cmp(&least(b)))
        .unwrap_or(0.0);
    if points.len() as f64 * Window::VOXEL_M.powi(2) > FILLED * least(&yaw) {
        yaw = heading_of_moments(points);
    }
    let (center, size) = extent(points, yaw);
    if size.x >= size.y {
        (center, size, yaw)
    } else {
        (
            center,
            DVec2::new(size.y, size.x),
            yaw + std::f64::consts::FRAC_PI_2,
        )
    }
}

/// Centre and size of the rectangle of that heading. Half a column more on every side than the centres.
fn extent(points: &[DVec2], yaw: f64) -> (DVec2, DVec2) {
    let along = DVec2::from_angle(yaw);
    let local = points
        .iter()
        .map(|p| DVec2::new(p.dot(along), p.dot(along.perp())));
    let (low, high) = local.fold((DVec2::INFINITY, DVec2::NEG_INFINITY), |(low, high), p| {
        (low.min(p), high.max(p))
    });
    let middle = (low + high) / 2.0;
    (
        along * middle.x + along.perp() * middle.y,
        high - low + DVec2::splat(Window::VOXEL_M),
    )
}

/// Axis of the largest spread.
fn heading_of_moments(points: &[DVec2]) -> f64 {
    let mean = points.iter().sum::<DVec2>() / points.len() as f64;
    let (mut xx, mut xy, mut yy) = (0.0, 0.0, 0.0);
    for d in points.iter().map(|p| *p - mean) {
        xx += d.x * d.x;
        xy += d.x * d.y;
        yy += d.y * d.y;
    }
    0.5 * (2.0 * xy).atan2(xx - yy)
}

/// One rectangle per object of the component.
fn split(class: Class, component: &Component) -> Vec<BoxFootprint> {
    let typical = DVec3::from_array(class.typical_size_m().unwrap_or([1.0; 3]));
    // The longer side of a barrier is its width.
    let sideways = typical.y > typical.x;
    let usual = if sideways {
        DVec2::new(typical.y, typical.x)
    } else {
        typical.truncate()
    };
    let (center, size, yaw) = around(&component.points_m);
    let along = DVec2::from_angle(yaw);
    let count = |size: f64, usual: f64| {
        if size > usual * SEVERAL {
            (size / usual).round().max(2.0)
        } else {
            1.0
        }
    };
    // Cells of an object: at least a voxel each way, so that small things are not cut to crumbs.
    let cell = usual.max(DVec2::splat(2.0 * Window::VOXEL_M));
    let (columns, rows) = (count(size.x, cell.x), count(size.y, cell.y));
    let height_m =
        ((component.top + 1) as f64 * Window::VOXEL_M - SMEAR_M).clamp(0.5 * typical.z, 2.0 * typical.z);
    let mut out = Vec::new();
    for i in 0..columns as usize {
        for j in 0..rows as usize {
            let share = |i: usize, n: f64| (i as f64 + 0.5) / n - 0.5;
            let offset = DVec2::new(share(i, columns) * size.x, share(j, rows) * size.y);
            let middle = center + along * offset.x + along.perp() * offset.y;
            let part = size / DVec2::new(columns, rows);
            let inside = |p: &&DVec2| {
                let local = **p - middle;
                local.dot(along).abs() <= part.x / 2.0 + 1e-9
                    && local.dot(along.perp()).abs() <= part.y / 2.0 + 1e-9
            };
            if component.points_m.iter().filter(inside).count() == 0 {
                continue; // an empty corner of an L
            }
            out.push(fitted(middle, part, yaw, usual, height_m, sideways));
        }
    }
    out
}

/// Grown to the class's usual size where the labels show only the near side: away from the ego.
fn fitted(middle: DVec2, part: DVec2, yaw: f64, usual: DVec2, height_m: f64, sideways: bool) -> BoxFootprint {
    let along = DVec2::from_angle(yaw);
    let axes = [along, along.perp()];
    let size = part.max(usual * 0.9).min(usual * SEVERAL);
    let mut center_m = middle;
    for (axis, grown) in axes.into_iter().zip((size - part).to_array()) {
        let away = if middle.dot(axis) < 0.0 { -1.0 } else { 1.0 };
        center_m += axis * (away * grown.max(0.0) / 2.0);
    }
    let (size_m, yaw_rad) = if sideways {
        (DVec2::new(size.y, size.x), yaw - std::f64::consts::FRAC_PI_2)
    } else {
        (size, yaw)
    };
    BoxFootprint {
        center_m,
        size_m,
        yaw_rad,
        height_m,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::raster::box_cells;

    fn object(class: Class, x: f64, y: f64, yaw_deg: f64) -> SceneBox {
        let size = DVec3::from_array(class.typical_size_m().expect("an object"));
        SceneBox {
            id: BoxId(1),
            class,
            center_m: DVec3::new(x, y, size.z / 2.0),
            size_m: size,
            yaw_rad: yaw_deg.to_radians(),
            velocity_mps: DVec2::ZERO,
            label: BoxLabel::default(),
        }
    }

    fn painted(objects: &[SceneBox]) -> VoxelGrid {
        let mut labels = VoxelGrid::new();
        for b in objects {
            let top = ((b.size_m.z + SMEAR_M) / Window::VOXEL_M).round() as usize;
            box_cells(crate::Extent::WINDOW, b, 0.0, |x, y| {
                (0..top).for_each(|z| labels.set(x, y, z, b.class.id()))
            });
        }
        labels
    }

    /// Difference of two headings without regard to front and back, in degrees.
    fn heading_gap(a: f64, b: f64) -> f64 {
        let gap = (a - b).to_degrees().rem_euclid(180.0);
        gap.min(180.0 - gap)
    }

    #[test]
    fn boxes_come_back_from_their_voxels() {
        for class in [Class::Car, Class::Truck, Class::Bus, Class::Barrier] {
            for (x, y, yaw) in [
                (12.0, 3.0, 0.0),
                (-15.0, 8.0, 35.0),
                (20.0, -18.0, 91.0),
                (3.0, 25.0, 160.0),
            ] {
                let truth = object(class, x, y, yaw);
                let found: Vec<SceneBox> = boxes(&painted(&[truth])).into_values().collect();
                let [one] = found[..] else {
                    panic!("{class:?} at {yaw}: {} boxes", found.len());
                };
                assert_eq!((one.class, one.problem()), (class, None));
                assert!(
                    one.center_m.distance(truth.center_m) < 0.5,
                    "{class:?} {yaw}: {}",
                    one.center_m
                );
                assert!(
                    (one.size_m - truth.size_m).abs().max_element() < 0.95,
                    "{class:?} {yaw}: {}",
                    one.size_m
                );
                assert!(heading_gap(one.yaw_rad, truth.yaw_rad) < 8.0, "{class:?} {yaw}");
            }
        }
    }

    #[test]
    fn touching_cars_are_two_and_half_a_car_is_one() {
        let row = [
            object(Class::Car, 10.0, 4.0, 0.0),
            object(Class::Car, 14.7, 4.0, 0.0),
        ];
        assert_eq!(boxes(&painted(&row)).len(), 2);
        let mut half = painted(&[object(Class::Car, 14.0, 0.0, 0.0)]);
        for x in 136..200 {
            for y in 0..200 {
                for z in 0..16 {
                    half.set(x, y, z, Class::FREE);
                }
            }
        }
        let found: Vec<SceneBox> = boxes(&half).into_values().collect();
        assert_eq!(found.len(), 1);
        // Its rear is seen, the rest is behind it.
        assert!((found[0].center_m.x - 14.0).abs() < 0.5, "{}", found[0].center_m);
        assert!(found[0].size_m.x > 4.0);
        assert!(boxes(&VoxelGrid::new()).is_empty());
    }

    #[test]
    fn people_and_cones_are_small() {
        let labels = painted(&[
            object(Class::Pedestrian, 5.0, 5.0, 0.0),
            object(Class::Pedestrian, 8.0, 5.0, 0.0),
            object(Class::TrafficCone, -6.0, 2.0, 0.0),
        ]);
        let found = boxes(&labels);
        let count = |class: Class| found.values().filter(|b| b.class == class).count();
        assert_eq!(
            (count(Class::Pedestrian), count(Class::TrafficCone), found.len()),
            (2, 1, 3)
        );
        assert!(found.values().all(|b| b.size_m.truncate().max_element() < 1.6));
    }
}
