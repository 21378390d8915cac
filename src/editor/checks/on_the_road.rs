//! Plants, buildings and poles that stand on drivable ground. Crowns that hang over it are fine.

use super::{Context, Finding, Findings, Fix, Severity, middle, removal};
use language::{t, tf};
use scene::support::{bins_set, groups, main_class, supported};
use scene::{BevLayer, BevLayout, Class, Extent};

pub const NAME: &str = "on_the_road";
/// Voxels at most this many bins above the ground count as low and stand in the way. In labels, whose voxels reach two
/// bins further down than things do, that is an underside lower than 1.8 m.
const LOW_BINS: usize = 4;
/// Fewer low voxels are noise of labels.
const LEAST_VOXELS: usize = 3;
/// Groups that are listed one by one, the largest; the rest is one finding.
const LISTED: usize = 40;
/// How far away the ground is looked for under a thing that covers it, columns.
const REACH: usize = 8;

pub fn check(context: &Context<'_>, out: &mut Findings) {
    let frame = context.frame;
    let (grid, layout) = (&frame.occupancy, &frame.layout);
    let (extent, bits) = (frame.extent(), context.bits());
    // Runs of voxels that begin low on the road, and which of them are low.
    let mut runs = vec![0u64; extent.columns()];
    let mut low = vec![0u64; extent.columns()];
    for (c, [x, y]) in extent.all_columns().enumerate() {
        let of = |class: Class| bits.by_class[usize::from(class.id())].get(c).copied();
        let standing = of(Class::Manmade).unwrap_or(0) | of(Class::Vegetation).unwrap_or(0);
        if standing == 0 || !is_well_on_road(layout, x, y) {
            continue;
        }
        let foot = foot(extent, &bits.ground, x, y);
        low[c] = standing & (((1u64 << (LOW_BINS + 1)) - 1) << foot);
        runs[c] = low[c];
        for z in 1..extent.nz() {
            runs[c] |= standing & 1 << z & (runs[c] & 1 << (z - 1)) << 1;
        }
    }
    if low.iter().all(|bits| *bits == 0) {
        return;
    }
    // The voxels that only these runs support, such as a crown, go with them.
    let without: Vec<u64> = bits
        .occupied
        .iter()
        .zip(&runs)
        .map(|(all, run)| all & !run)
        .collect();
    let after = supported(extent, &without, &bits.ground);
    let mut cells = Vec::new();
    for c in 0..extent.columns() {
        cells.extend(bins_set(
            extent,
            c,
            runs[c] | (bits.supported[c] & !after[c] & without[c]),
        ));
    }
    let is_low = |[x, y, z]: &&[usize; 3]| low[extent.index(*x, *y)] >> z & 1 == 1;
    let mut groups = groups(extent, cells);
    groups.retain(|g| g.iter().filter(is_low).count() >= LEAST_VOXELS);
    groups.sort_by_key(|g| std::cmp::Reverse(g.len()));
    let rest = groups.split_off(groups.len().min(LISTED));
    let mut report = |text: String, where_m: glam::DVec3, cells: Vec<[usize; 3]>, n: usize| {
        let finding = Finding {
            check: NAME,
            severity: Severity::Warning,
            where_m,
            box_id: None,
            text,
            fixes: vec![Fix {
                label: "Clear the road",
                edits: removal(frame, &cells),
            }],
            time_s: None,
            cells,
        };
        out.push_all(finding, n);
    };
    for group in groups {
        let class = main_class(grid, &group).label();
        let text = tf!(
            "{n} voxels of {class} stand on the road",
            n = group.len(),
            class = t(&class)
        );
        report(text, middle(extent, &group), group, 1);
    }
    if let Some(first) = rest.first() {
        let (where_m, count) = (middle(extent, first), rest.len());
        let cells: Vec<_> = rest.into_iter().flatten().collect();
        let text = tf!(
            "{n} smaller things stand on the road, {voxels} voxels",
            n = count,
            voxels = cells.len()
        );
        report(text, where_m, cells, count);
    }
}

/// True for a cell of road or car park, not blocked by works, with nothing else around it: a kerb is drawn as coarsely
/// as a voxel.
fn is_well_on_road(layout: &BevLayout, x: usize, y: usize) -> bool {
    let road = |cell: u32| {
        let drivable = BevLayer::DrivableArea.bit() | BevLayer::CarparkArea.bit();
        cell & drivable != 0 && cell & BevLayer::RoadBlock.bit() == 0
    };
    let extent = layout.extent();
    let xs = x.saturating_sub(1)..=(x + 1).min(extent.nx() - 1);
    let ys = y.saturating_sub(1)..=(y + 1).min(extent.ny() - 1);
    xs.into_iter()
        .all(|i| ys.clone().all(|j| road(layout.cell(i, j))))
}

/// Bin of the ground in a column or, where a thing covers it, of the nearest column that shows any; else the lowest bin.
fn foot(extent: Extent, ground: &[u64], x: usize, y: usize) -> u32 {
    for reach in 0..=REACH {
        let xs = x.saturating_sub(reach)..=(x + reach).min(extent.nx() - 1);
        let ys = y.saturating_sub(reach)..=(y + reach).min(extent.ny() - 1);
        let bins = xs.flat_map(|i| ys.clone().map(move |j| ground[extent.index(i, j)]));
        if let Some(lowest) = bins.filter(|g| *g != 0).map(u64::trailing_zeros).min() {
            return lowest;
        }
    }
    0
}
