//! Voxels that hang in the air: nothing connects them to the ground.

use super::components::{bins_set, groups, main_class};
use super::{Context, Finding, Fix, Severity, middle};
use crate::editor::Edit;
use crate::scene::{Class, Frame, GridSpec};

pub const NAME: &str = "floating_voxels";
/// Groups that are listed one by one, the largest; the rest is one finding.
const LISTED: usize = 40;
/// Vegetation that floats in groups of at least so many voxels is the crown of a tree.
pub const CROWN: usize = 8;

pub fn check(context: &Context<'_>, out: &mut Vec<Finding>) {
    let frame = context.frame;
    let bits = context.bits();
    let mut cells = Vec::new();
    for (c, (all, stands)) in bits.occupied.iter().zip(&bits.supported).enumerate() {
        cells.extend(bins_set(c, all & !stands));
    }
    let mut groups: Vec<_> = groups(cells)
        .into_iter()
        .filter(|g| is_known_to_float(frame, g))
        .collect();
    groups.sort_by_key(|g| std::cmp::Reverse(g.len()));
    let rest = groups.split_off(groups.len().min(LISTED));
    let paint = |label: &'static str, cells: Vec<[usize; 3]>, class: Class| Fix {
        label,
        edits: vec![Edit::PaintVoxels { cells, class }],
    };
    let remove = |cells: Vec<[usize; 3]>| paint("Remove floating voxels", cells, Class::Free);
    for group in groups {
        let class = main_class(&frame.occupancy, &group);
        let above_m = lowest_m(&group);
        let text = match group.len() {
            1 => format!(
                "A voxel of {} floats {above_m:.1} m above the ground",
                class.label()
            ),
            n => format!(
                "{n} voxels of {} float {above_m:.1} m above the ground",
                class.label()
            ),
        };
        out.push(Finding {
            check: NAME,
            severity: Severity::Warning,
            where_m: middle(&group),
            box_id: None,
            cells: group.clone(),
            text,
            // A crown misses its stem; anything else is more likely to be too much.
            fixes: match class == Class::Vegetation && group.len() >= CROWN {
                true => vec![
                    paint("Put a stem under it", stem(frame, &group), class),
                    remove(group),
                ],
                false => vec![remove(group)],
            },
        });
    }
    if let Some(first) = rest.first() {
        let where_m = middle(first);
        let count = rest.len();
        let cells: Vec<_> = rest.into_iter().flatten().collect();
        out.push(Finding {
            check: NAME,
            severity: Severity::Warning,
            where_m,
            box_id: None,
            cells: cells.clone(),
            text: format!("{count} smaller groups float, {} voxels", cells.len()),
            fixes: vec![remove(cells)],
        });
    }
}

/// False for what may be held by something that the frame does not show: beyond the sides or the top of the grid
/// (objects excepted, they stand on their own), or by voxels below that no sensor observed.
pub fn is_known_to_float(frame: &Frame, group: &[[usize; 3]]) -> bool {
    let is_object =
        |[x, y, z]: [usize; 3]| Class::from_id(frame.occupancy.get(x, y, z)).is_some_and(Class::is_object);
    let at_edge = |[x, y, z]: [usize; 3]| {
        x == 0 || y == 0 || x + 1 == GridSpec::NX || y + 1 == GridSpec::NY || z + 1 == GridSpec::NZ
    };
    let unobserved = |[x, y, z]: [usize; 3]| {
        let words = frame.inferred.unobserved.as_ref().map(|u| u.words());
        z > 0 && words.is_some_and(|w| w[x * GridSpec::NY + y] >> (z - 1) & 1 == 1)
    };
    !group
        .iter()
        .any(|c| (at_edge(*c) && !is_object(*c)) || unobserved(*c))
}

/// Lower face of the lowest voxel above the ground's surface, m.
pub fn lowest_m(group: &[[usize; 3]]) -> f64 {
    let lowest = group.iter().map(|c| c[2]).min().unwrap_or(0);
    (GridSpec::center(0, 0, lowest).z - GridSpec::VOXEL_M / 2.0).max(0.0)
}

/// Free voxels from the ground to the underside of a group, under the voxel that is nearest to its middle.
pub fn stem(frame: &Frame, group: &[[usize; 3]]) -> Vec<[usize; 3]> {
    let middle = middle(group).truncate();
    let lowest = |[x, y, z]: &&[usize; 3]| !group.contains(&[*x, *y, z.wrapping_sub(1)]);
    let off = |c: &[usize; 3]| {
        GridSpec::center(c[0], c[1], c[2])
            .truncate()
            .distance_squared(middle)
    };
    let Some(&[x, y, top]) = group
        .iter()
        .filter(lowest)
        .min_by(|a, b| off(a).total_cmp(&off(b)))
    else {
        return Vec::new();
    };
    let free = |z: &usize| frame.occupancy.get(x, y, *z) == Class::FREE;
    (0..top).filter(free).map(|z| [x, y, z]).collect()
}
