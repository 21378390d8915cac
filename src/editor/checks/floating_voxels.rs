//! Voxels that hang in the air: nothing connects them to the ground.

use super::{Context, Finding, Findings, Fix, Severity, middle};
use crate::Edit;
use language::{t, tf};
use scene::support::{CROWN, bins_set, groups, is_known_to_float, main_class, stem};
use scene::{Class, Extent};

pub const NAME: &str = "floating_voxels";
/// Groups that are listed one by one, the largest; the rest is one finding.
const LISTED: usize = 40;

pub fn check(context: &Context<'_>, out: &mut Findings) {
    let frame = context.frame;
    let (extent, bits) = (frame.extent(), context.bits());
    let mut cells = Vec::new();
    for (c, (all, stands)) in bits.occupied.iter().zip(&bits.supported).enumerate() {
        cells.extend(bins_set(extent, c, all & !stands));
    }
    let mut groups: Vec<_> = groups(extent, cells)
        .into_iter()
        .filter(|g| is_known_to_float(&frame.occupancy, frame.inferred.unobserved.as_ref(), g))
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
        let (label, height) = (class.label(), format!("{:.1}", lowest_m(extent, &group)));
        let text = match group.len() {
            1 => tf!(
                "A voxel of {class} floats {height} m above the ground",
                class = t(&label),
                height = height
            ),
            n => tf!(
                "{n} voxels of {class} float {height} m above the ground",
                n = n,
                class = t(&label),
                height = height
            ),
        };
        out.push(Finding {
            check: NAME,
            severity: Severity::Warning,
            where_m: middle(extent, &group),
            box_id: None,
            time_s: None,
            cells: group.clone(),
            text,
            // A crown misses its stem; anything else is more likely to be too much.
            fixes: match class == Class::Vegetation && group.len() >= CROWN {
                true => vec![
                    paint("Put a stem under it", stem(&frame.occupancy, &group), class),
                    remove(group),
                ],
                false => vec![remove(group)],
            },
        });
    }
    if let Some(first) = rest.first() {
        let where_m = middle(extent, first);
        let count = rest.len();
        let cells: Vec<_> = rest.into_iter().flatten().collect();
        let finding = Finding {
            check: NAME,
            severity: Severity::Warning,
            where_m,
            box_id: None,
            time_s: None,
            cells: cells.clone(),
            text: tf!(
                "{n} smaller groups float, {voxels} voxels",
                n = count,
                voxels = cells.len()
            ),
            fixes: vec![remove(cells)],
        };
        out.push_all(finding, count);
    }
}

/// Lower face of the lowest voxel above the ground's surface, m.
pub fn lowest_m(extent: Extent, group: &[[usize; 3]]) -> f64 {
    let lowest = group.iter().map(|c| c[2]).min().unwrap_or(0);
    (extent.center(0, 0, lowest).z - extent.voxel_m() / 2.0).max(0.0)
}
