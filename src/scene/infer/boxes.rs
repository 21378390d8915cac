//! Oriented boxes from object voxels: connected columns of one class, the rectangle of least area around
//! them, and the class's usual size where the labels show too little or several objects at once.

use std::collections::BTreeMap;

use glam::{DVec2, DVec3};

use crate::support::neighbours;
use crate::variants::of_class;
use crate::{BoxId, BoxLabel, Class, Extent, Frame, Lattice, Relief, SceneBox, VoxelGrid, Window};

/// Fewest voxels of a component that is worth a box, in voxels of 0.4 m; as much area in others.
const LEAST_VOXELS: f64 = 4.0;
/// A component this many times as long or wide as the class usually is holds several objects.
const SEVERAL: f64 = 1.6;
/// Mean height by which the top of a voxel is above the object in it, voxels: [`crate::draft`] fills a voxel of which the object
/// reaches a sixth.
const ABOVE: f64 = 1.0 / 3.0;

/// A box for every object in the labels, [`Frame::MAX_BOXES`] at most. Which end of it is the front is a guess.
pub fn boxes(labels: &VoxelGrid) -> BTreeMap<BoxId, SceneBox> {
    let mut out = BTreeMap::new();
    let relief = super::relief(labels);
    for class in Class::OBJECTS {
        for component in joined(class, components(labels, class, &relief)) {
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
    let Some(top) = voxels.iter().map(|v| v[2]).max() else {
        return Vec::new();
    };
    let component = Component {
        points_m: columns
            .iter()
            .map(|&[x, y]| extent.center(x, y, 0).truncate())
            .collect(),
        voxel_m: extent.voxel_m(),
        height_m: height_m(extent.lattice(), top, 0.0),
    };
    let parts = split(class, &component).into_iter().zip(1..);
    parts.map(|(part, id)| part.to_box(BoxId(id), class)).collect()
}

/// Columns of one object.
struct Component {
    /// Their centres on the ground.
    points_m: Vec<DVec2>,
    /// Edge of a column, m.
    voxel_m: f64,
    /// Height of the highest voxel above the ground, m.
    height_m: f64,
}

/// Height of an object above ground of some height, from its highest bin, m.
fn height_m(lattice: Lattice, top: usize, ground_m: f64) -> f64 {
    let voxel_m = lattice.voxel_m();
    match lattice.lowered() {
        0 => lattice.bottom_m() + (top as f64 + 1.0 - ABOVE) * voxel_m - ground_m,
        // Objects are taller in such labels than they are: they reach down to the ground.
        by => {
            let above = top.saturating_sub(lattice.ground_bin(ground_m));
            (above + 1) as f64 * voxel_m - by as f64 * voxel_m
        }
    }
}

/// Connected columns (8 neighbours) that hold a class; small ones are left out.
fn components(labels: &VoxelGrid, class: Class, relief: &Relief) -> Vec<Component> {
    let extent = labels.extent();
    // Number of voxels of the class in each column, and the highest.
    let mut held = vec![(0u8, 0u8); extent.columns()];
    for (x, y, z, _) in labels.iter_set().filter(|v| v.3 == class.id()) {
        let (count, top) = &mut held[extent.index(x, y)];
        (*count, *top) = (*count + 1, (*top).max(z as u8));
    }
    let least = (LEAST_VOXELS * (Window::VOXEL_M / extent.voxel_m()).powi(2)).ceil() as usize;
    let mut seen = vec![false; held.len()];
    let mut out = Vec::new();
    for start in 0..held.len() {
        if seen[start] || held[start].0 == 0 {
            continue;
        }
        seen[start] = true;
        let mut part = vec![start];
        let mut next = 0;
        while next < part.len() {
            let near = neighbours(extent, part[next]);
            part.extend(near.filter(|near| held[*near].0 > 0 && !std::mem::replace(&mut seen[*near], true)));
            next += 1;
        }
        if part.iter().map(|c| usize::from(held[*c].0)).sum::<usize>() >= least {
            let point = |c: &usize| {
                let [x, y] = extent.column(*c);
                extent.center(x, y, 0).truncate()
            };
            let height = |c: &usize| {
                let [x, y] = extent.column(*c);
                height_m(extent.lattice(), held[*c].1.into(), relief.column_m(x, y))
            };
            out.push(Component {
                points_m: part.iter().map(point).collect(),
                voxel_m: extent.voxel_m(),
                height_m: part.iter().map(height).fold(0.0, f64::max),
            });
        }
    }
    out
}

/// Length and width of the largest single object of a class, m: what is larger holds several. `None` for classes whose objects
/// are much alike.
fn largest(class: Class) -> Option<DVec2> {
    Some(match class {
        Class::Bus => DVec2::new(19.5, 3.6),
        Class::Truck | Class::Trailer => DVec2::new(18.5, 3.6),
        Class::ConstructionVehicle => DVec2::new(16.0, 4.4),
        _ => return None,
    })
}

/// Distance between parts of one large object in labels, m: where sensors saw nothing of it.
const GAP_M: f64 = 1.7;
/// Longer than the diagonal of the largest object, m.
const FARTHEST_M: f64 = 20.0;

/// Parts of a class among which those of one object are looked for, at most.
const MOST_PARTS: usize = 300;

/// Parts of large objects put together: those near each other whose rectangle is that of one object.
fn joined(class: Class, mut parts: Vec<Component>) -> Vec<Component> {
    let Some(largest) = largest(class).filter(|_| parts.len() <= MOST_PARTS) else {
        return parts;
    };
    let area_m2 = |c: &Component| c.points_m.len() as f64 * c.voxel_m.powi(2);
    let smallest_m2 = of_class(class)
        .map(|kind| kind.size_m[0] * kind.size_m[1])
        .fold(f64::INFINITY, f64::min);
    // Two whole objects that stand close are two.
    let is_part = |c: &Component| area_m2(c) < 0.7 * smallest_m2;
    let mut first = 0;
    while first < parts.len() {
        let joins = |other: &Component| {
            let one = &parts[first];
            let fits = area_m2(one) + area_m2(other) <= largest.x * largest.y;
            if !fits || !(is_part(one) || is_part(other)) || !are_near(one, other) {
                return false;
            }
            let all = [one.points_m.as_slice(), &other.points_m].concat();
            let (_, size, _) = around(&all, one.voxel_m);
            size.x <= largest.x && size.y <= largest.y
        };
        match (first + 1..parts.len()).find(|i| joins(&parts[*i])) {
            Some(i) => {
                let other = parts.swap_remove(i);
                let one = &mut parts[first];
                one.points_m.extend(other.points_m);
                one.height_m = one.height_m.max(other.height_m);
                // Those passed before may be near it now.
                parts.swap(0, first);
                first = 0;
            }
            None => first += 1,
        }
    }
    parts
}

fn are_near(a: &Component, b: &Component) -> bool {
    let way = |c: &Component| c.points_m.first().copied().unwrap_or_default();
    if way(a).distance(way(b)) > 2.0 * FARTHEST_M {
        return false;
    }
    let near = |p: &DVec2| b.points_m.iter().any(|q| q.distance_squared(*p) < GAP_M * GAP_M);
    a.points_m.iter().any(near)
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
fn around(points: &[DVec2], voxel_m: f64) -> (DVec2, DVec2, f64) {
    let headings = (0..90).map(|degree| f64::from(degree).to_radians());
    let least = |yaw: &f64| {
        let (_, size) = extent(points, *yaw, voxel_m);
        size.x * size.y
    };
    let mut yaw = headings
        .min_by(|a, b| least(a).total_cmp(&least(b)))
        .unwrap_or(0.0);
    if points.len() as f64 * voxel_m.powi(2) > FILLED * least(&yaw) {
        yaw = heading_of_moments(points);
    }
    let (center, size) = extent(points, yaw, voxel_m);
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
fn extent(points: &[DVec2], yaw: f64, voxel_m: f64) -> (DVec2, DVec2) {
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
        high - low + DVec2::splat(voxel_m),
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

/// Usual size of an object of this height, m: that of its class, unless the height is that of another kind of large object, as of a
/// small trailer.
fn usual_size_m(class: Class, height_m: f64) -> DVec3 {
    let typical = DVec3::from_array(class.typical_size_m().unwrap_or([1.0; 3]));
    if largest(class).is_none() || (height_m - typical.z).abs() < 0.45 * typical.z {
        return typical;
    }
    let kinds = of_class(class).map(|kind| DVec3::from_array(kind.size_m));
    let off = |size: &DVec3| (size.z - height_m).abs();
    kinds.min_by(|a, b| off(a).total_cmp(&off(b))).unwrap_or(typical)
}

/// Length by which labels of an object are longer or wider than it is, at most, m.
const LABELS_MORE_M: f64 = 1.3;

/// True if a rectangle of columns is that of one of the known kinds of large objects.
fn is_kind(class: Class, size: DVec2) -> bool {
    let fits = |size: f64, kind: f64| (-0.6..LABELS_MORE_M).contains(&(size - kind));
    largest(class).is_some()
        && of_class(class).any(|kind| fits(size.x, kind.size_m[0]) && size.y - kind.size_m[1] < LABELS_MORE_M)
}

/// One rectangle per object of the component.
fn split(class: Class, component: &Component) -> Vec<BoxFootprint> {
    let typical = usual_size_m(class, component.height_m);
    // The longer side of a barrier is its width.
    let sideways = typical.y > typical.x;
    let usual = if sideways {
        DVec2::new(typical.y, typical.x)
    } else {
        typical.truncate()
    };
    let (center, size, yaw) = around(&component.points_m, component.voxel_m);
    let along = DVec2::from_angle(yaw);
    let largest = largest(class).unwrap_or(usual * SEVERAL).max(usual * SEVERAL);
    let is_kind = is_kind(class, size);
    let count = |size: f64, usual: f64| {
        if size > usual * SEVERAL && !is_kind {
            (size / usual).round().max(2.0)
        } else {
            1.0
        }
    };
    // Cells of an object: at least a voxel each way, so that small things are not cut to crumbs.
    let cell = usual.max(DVec2::splat(2.0 * component.voxel_m));
    let (columns, rows) = (count(size.x, cell.x), count(size.y, cell.y));
    let height_m = component.height_m.clamp(0.5 * typical.z, 2.0 * typical.z);
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
            out.push(fitted(middle, part, yaw, [usual, largest], height_m, sideways));
        }
    }
    out
}

/// Grown to the class's usual size where the labels show only the near side: away from the ego.
fn fitted(
    middle: DVec2,
    part: DVec2,
    yaw: f64,
    [usual, largest]: [DVec2; 2],
    height_m: f64,
    sideways: bool,
) -> BoxFootprint {
    let along = DVec2::from_angle(yaw);
    let axes = [along, along.perp()];
    let size = part.max(usual * 0.9).min(largest);
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
            let top = (b.size_m.z / Window::VOXEL_M).round() as usize + 2;
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

    #[test]
    fn boxes_have_the_heights_of_finer_voxels() {
        let lattice = Lattice::new(0.2, 40, -3.2).expect("sound");
        let extent = Extent::over(lattice, [-100, -100], [200, 200]).expect("sound");
        let mut layout = crate::BevLayout::over(extent);
        for [x, y] in extent.all_columns() {
            layout.set(crate::BevLayer::DrivableArea, x, y, true);
        }
        let truth = [
            object(Class::Car, 8.0, 3.0, 20.0),
            object(Class::Pedestrian, -5.0, 2.0, 0.0),
        ];
        let labels = crate::draft::draft(&layout, truth.iter());
        let found: Vec<SceneBox> = boxes(&labels).into_values().collect();
        assert_eq!(found.len(), 2);
        for (one, truth) in found.iter().zip(&truth) {
            assert_eq!(one.class, truth.class);
            let off = (one.size_m.z - truth.size_m.z).abs();
            assert!(
                off < 0.15,
                "{:?}: {} for {}",
                one.class,
                one.size_m.z,
                truth.size_m.z
            );
            assert!(one.center_m.distance(truth.center_m) < 0.3, "{}", one.center_m);
        }
    }
}
