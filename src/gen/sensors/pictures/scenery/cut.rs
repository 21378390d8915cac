//! Places where something was cut out of a thing: there its remaining voxels are drawn instead of its solids.

use std::collections::BTreeSet;

use scene::background::ColumnLabels;
use scene::{Class, VoxelGrid, VoxelPaint};

/// A voxel: column and bin.
pub(super) type Voxel = [usize; 3];

/// Largest share of a thing's voxels that may be missing beside its cuts: labels have no more of a bench.
const MOST_MISSING: f64 = 0.35;
/// Distance of the voxels beside a thing that it should explain.
const BESIDE: usize = 2;
/// Least intersection over union of an inferred thing and the voxels.
const LEAST_IOU: f64 = 0.8;
/// Voxels around a cut in which solids are left out, and farther voxels that stay, so that both overlap.
const AROUND: usize = 1;
/// See [`AROUND`].
const OVERLAP: usize = 2;
/// Most cuts of a thing; with more it stays in the field.
const MOST: usize = 6;

/// A cut: its lowest and its highest voxel, with those around.
pub(super) type Cut = [Voxel; 2];

/// Voxels that a thing lacks.
pub(super) struct Missing<'a> {
    /// All voxels that the thing has if nothing is missing.
    columns: &'a ColumnLabels,
    /// Those that are missing.
    pub voxels: BTreeSet<Voxel>,
    /// Those that were cleared by hand.
    pub by_hand: BTreeSet<Voxel>,
    /// Number of voxels that the thing has if nothing is missing.
    whole: usize,
    /// Columns of which nothing is there.
    bare: BTreeSet<[usize; 2]>,
}

impl<'a> Missing<'a> {
    /// Compares the voxels of a thing with those of the map.
    pub fn new(columns: &'a ColumnLabels, occupancy: &VoxelGrid, painted: &VoxelPaint) -> Self {
        let mut out = Self {
            voxels: BTreeSet::new(),
            by_hand: BTreeSet::new(),
            columns,
            whole: 0,
            bare: BTreeSet::new(),
        };
        for ([x, y], labels) in columns {
            let (held, painted) = (occupancy.column(*x, *y), painted.column(*x, *y));
            for z in (0..labels.len()).filter(|z| labels[*z] != Class::FREE) {
                out.whole += 1;
                if held[z] == Class::FREE {
                    out.voxels.insert([*x, *y, z]);
                }
                if painted[z] == Class::FREE {
                    out.by_hand.insert([*x, *y, z]);
                }
            }
            let own: Vec<usize> = (0..labels.len()).filter(|z| labels[*z] != Class::FREE).collect();
            if own.len() > 1 && own.iter().all(|z| held[*z] == Class::FREE) {
                out.bare.insert([*x, *y]);
            }
        }
        out
    }

    /// All voxels that the thing has if nothing is missing.
    fn whole(&self) -> impl Iterator<Item = Voxel> {
        self.columns.iter().flat_map(|([x, y], labels)| {
            let own = (0..labels.len()).filter(|z| labels[*z] != Class::FREE);
            own.map(|z| [*x, *y, z])
        })
    }

    /// True if a thing and the man-made voxels within two of it are the same but for a fifth of all (intersection over
    /// union).
    pub fn explains(&self, occupancy: &VoxelGrid) -> bool {
        let size = occupancy.extent().shape();
        let whole: BTreeSet<Voxel> = self.whole().collect();
        let mut around = BTreeSet::new();
        for v in &whole {
            for k in 0..125 {
                let step = [k / 25, k / 5 % 5, k % 5];
                let near: [usize; 3] = std::array::from_fn(|i| (v[i] + step[i]).wrapping_sub(BESIDE));
                if (0..3).all(|i| near[i] < size[i]) && !whole.contains(&near) {
                    around.insert(near);
                }
            }
        }
        let made = |[x, y, z]: &Voxel| occupancy.get(*x, *y, *z) == Class::Manmade.id();
        let beside = around.iter().filter(|v| made(v)).count();
        let shared = self.whole - self.voxels.len();
        shared as f64 >= LEAST_IOU * (self.whole + beside) as f64
    }

    /// The cuts of a thing on a map of `[nx, ny, nz]` voxels: what was cleared by hand, missing pieces of two voxels each
    /// way, and three bare columns or more beside one another; what is smaller are ragged edges. `None` if there are too many, or
    /// if too much is missing beside them.
    pub fn cuts(&self, size: Voxel) -> Option<Vec<Cut>> {
        let is_block = |[x, y, z]: &Voxel| {
            let corner = |k: usize| [x + (k & 1), y + (k >> 1 & 1), z + (k >> 2)];
            (0..8).all(|k| self.voxels.contains(&corner(k)))
        };
        let is_gap = |[x, y, _]: &Voxel| {
            let around = (0..9).map(|k| [(x + k / 3).wrapping_sub(1), (y + k % 3).wrapping_sub(1)]);
            self.bare.contains(&[*x, *y]) && around.filter(|c| self.bare.contains(c)).count() > 2
        };
        let missing = self.voxels.iter().filter(|v| is_block(v) || is_gap(v));
        let begin = self.by_hand.iter().chain(missing);
        let begin: BTreeSet<Voxel> = begin.copied().collect();
        let (mut seen, mut cuts) = (BTreeSet::new(), Vec::new());
        for start in begin {
            if !seen.insert(start) {
                continue;
            }
            let (mut low, mut high, mut open) = (start, start, vec![start]);
            while let Some(v) = open.pop() {
                for axis in 0..3 {
                    (low[axis], high[axis]) = (low[axis].min(v[axis]), high[axis].max(v[axis]));
                }
                for k in (0..27).filter(|k| *k != 13) {
                    let step = [k / 9, k / 3 % 3, k % 3];
                    let near: [usize; 3] = std::array::from_fn(|i| (v[i] + step[i]).wrapping_sub(1));
                    let lacks = self.voxels.contains(&near) || self.by_hand.contains(&near);
                    if lacks && seen.insert(near) {
                        open.push(near);
                    }
                }
            }
            if cuts.len() == MOST {
                return None;
            }
            let low = low.map(|v| v.saturating_sub(AROUND));
            let high = std::array::from_fn(|i| (high[i] + AROUND).min(size[i].saturating_sub(1)));
            cuts.push([low, high]);
        }
        let is_left = |v: &Voxel| !cuts.iter().any(|cut| holds(cut, *v));
        let (missing, whole) = match cuts.is_empty() {
            true => (self.voxels.len(), self.whole),
            false => (
                self.voxels.iter().filter(|v| is_left(v)).count(),
                self.whole().filter(is_left).count(),
            ),
        };
        let is_there = whole > 0 && missing as f64 <= MOST_MISSING * whole as f64;
        (is_there || self.whole == 0).then_some(cuts)
    }
}

/// True if a voxel lies in a cut or around it, so that it stays.
pub fn holds([low, high]: &Cut, voxel: Voxel) -> bool {
    (0..3).all(|i| (low[i].saturating_sub(OVERLAP)..=high[i] + OVERLAP).contains(&voxel[i]))
}
