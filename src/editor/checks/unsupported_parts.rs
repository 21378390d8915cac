//! Check of parts of one class that stand on nothing although they touch another class: a crown that only leans on a
//! wall, a wall that hangs in a hedge. Parts that touch nothing at all are found by `floating_voxels`.

use super::floating_voxels::lowest_m;
use super::{Context, Finding, Findings, Fix, Severity, middle};
use crate::Edit;
use language::{t, tf};
use scene::Class;
use scene::support::{
    CROWN, bins_set, ground, groups, is_known_to_float, neighbours, reached, stem, usual_ground_bins,
};

pub const NAME: &str = "unsupported_parts";
/// Smaller parts are noise of labels, voxels.
const LEAST_VOXELS: usize = 8;
/// Parts that are listed one by one, the largest; the others are counted.
const LISTED: usize = 40;

pub fn check(context: &Context<'_>, out: &mut Findings) {
    let frame = context.frame;
    let (extent, bits) = (frame.extent(), context.bits());
    let mut parts: Vec<(Class, Vec<[usize; 3]>)> = Vec::new();
    // Standing voxels replace the ground's own voxel, in whatever bin the ground lies beside them.
    let ground = ground(extent, &bits.by_class);
    let usual = usual_ground_bins(extent, &ground);
    let beside: Vec<u64> = (0..extent.columns())
        .map(|c| neighbours(extent, c).fold(0, |word, n| word | ground[n]))
        .collect();
    let standing = |c: &&Class| **c != Class::Free && !c.is_ground();
    for class in Class::ALL.iter().filter(standing) {
        let own = &bits.by_class[usize::from(class.id())];
        if own.is_empty() {
            continue;
        }
        // Held from below: in the ground or where it usually lies, or on a voxel of another class.
        let rests = reached(extent, own, |c| {
            usual | beside[c] | (bits.occupied[c] & !own[c]) << 1
        });
        let mut cells = Vec::new();
        for c in 0..extent.columns() {
            cells.extend(bins_set(extent, c, own[c] & !rests[c] & bits.supported[c]));
        }
        let large = groups(extent, cells)
            .into_iter()
            .filter(|g| g.len() >= LEAST_VOXELS);
        let known =
            large.filter(|g| is_known_to_float(&frame.occupancy, frame.inferred.unobserved.as_ref(), g));
        parts.extend(known.map(|g| (*class, g)));
    }
    parts.sort_by_key(|(_, g)| std::cmp::Reverse(g.len()));
    for (i, (class, part)) in parts.into_iter().enumerate() {
        if i >= LISTED || out.is_full() {
            out.count((Severity::Warning, NAME, None), middle(extent, &part));
            continue;
        }
        let paint = |label: &'static str, cells: Vec<[usize; 3]>, class: Class| Fix {
            label,
            edits: vec![Edit::PaintVoxels { cells, class }],
        };
        let mut fixes = vec![paint("Remove the part", part.clone(), Class::Free)];
        let stem = stem(&frame.occupancy, &part);
        if class == Class::Vegetation && part.len() >= CROWN && !stem.is_empty() {
            fixes.insert(0, paint("Put a stem under it", stem, class));
        }
        out.push(Finding {
            check: NAME,
            severity: Severity::Warning,
            where_m: middle(extent, &part),
            box_id: None,
            text: tf!(
                "{n} voxels of {class} rest on nothing, {height} m above the ground",
                n = part.len(),
                class = t(&class.label()),
                height = format!("{:.1}", lowest_m(extent, &part))
            ),
            time_s: None,
            cells: part,
            fixes,
        });
    }
}
