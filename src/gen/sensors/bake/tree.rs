//! Sorts samples into an octree and chooses its leaves: small where colours change or another surface begins, large
//! elsewhere, up to the allowed number.

use std::cmp::Ordering;
use std::collections::BinaryHeap;

use glam::Vec3;
use rayon::prelude::*;

use super::samples::{SampleGroup, SurfaceSample};
use scene::Class;

/// Edge of the smallest cell on the map, m.
const FINEST_M: f32 = 0.02;
/// Bits of a place along each axis.
const BITS: u32 = 16;
/// The largest cell is 2^7 of the finest.
const LARGEST: u32 = 7;

/// Cost of a pixel on the border of a surface, per pixel of the cell's width: its Gaussian reaches over the border.
const EDGE_COST: f32 = 0.006;
/// Cost of a pixel where normals point apart.
const BEND_COST: f32 = 0.1;

/// How much nearer a viewer may come than the cameras of the bake, m, and the least distance of a viewer, m.
const BESIDE_M: f32 = 1.5;
const NEAREST_M: f32 = 1.2;
/// Largest edge of a cell over its distance.
const LARGE: f32 = 0.15;

/// A cell of the tree: samples `from..to` of the sorted list.
#[derive(Clone, Copy, Debug)]
pub(super) struct Leaf {
    pub from: u32,
    pub to: u32,
    /// Edge, m.
    pub size_m: f32,
}

/// Edge of a group's smallest cell, m.
fn finest_m(group: &SampleGroup) -> f32 {
    match group.is_skyline {
        false => FINEST_M,
        true => 4.0 * FINEST_M,
    }
}

/// Cells are this much longer along a surface's normal, so that few of them cut a sliver from it.
const DEEP: f32 = 4.0;

/// The axis along which a surface faces most; 3 for leaves, which face everywhere.
fn facing(s: &SurfaceSample, group: &SampleGroup) -> usize {
    let n = s.normal.map(|v| i32::from(v).abs());
    if group.class == Class::Vegetation.id() && !group.is_skyline {
        3
    } else if n[2] >= n[0] && n[2] >= n[1] {
        2
    } else {
        usize::from(n[1] > n[0])
    }
}

/// The code of a sample: its group, the axis that it faces along, then its place, bits of x, y and z in turn.
fn code(s: &SurfaceSample, groups: &[SampleGroup]) -> u64 {
    let group = &groups[usize::from(s.group)];
    let (cell, facing) = (finest_m(group), facing(s, group));
    let half = (1u32 << (BITS - 1)) as f32;
    let bits = |axis: usize| {
        let long = if axis == facing { DEEP } else { 1.0 };
        spread(((s.at[axis] / (cell * long)).floor() + half).clamp(0.0, 2.0 * half - 1.0) as u64)
    };
    let above = u64::from(s.group) << 2 | facing as u64;
    above << (3 * BITS) | bits(0) << 2 | bits(1) << 1 | bits(2)
}

/// Puts two zeros between every two of 16 bits.
fn spread(v: u64) -> u64 {
    let v = (v | v << 32) & 0x001f_0000_0000_ffff;
    let v = (v | v << 16) & 0x001f_0000_ff00_00ff;
    let v = (v | v << 8) & 0x100f_00f0_0f00_f00f;
    let v = (v | v << 4) & 0x10c3_0c30_c30c_30c3;
    (v | v << 2) & 0x1249_2492_4924_9249
}

/// A cell that may be divided.
struct DivisibleCell {
    from: u32,
    to: u32,
    /// Its edge is 2^level of the finest.
    level: u32,
    gain: f32,
}

impl PartialEq for DivisibleCell {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other) == Ordering::Equal
    }
}

impl Eq for DivisibleCell {}

impl PartialOrd for DivisibleCell {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl Ord for DivisibleCell {
    /// Orders by gain; on a tie the first cell counts as larger.
    fn cmp(&self, other: &Self) -> Ordering {
        let by_gain = self.gain.total_cmp(&other.gain);
        by_gain
            .then(other.from.cmp(&self.from))
            .then(self.level.cmp(&other.level))
    }
}

/// Sorts samples by their codes and chooses the leaves, in the same order. There may be more than `most` leaves if
/// every group needs its share.
pub(super) fn leaves(
    samples: Vec<SurfaceSample>,
    groups: &[SampleGroup],
    eyes: &[Vec3],
    most: usize,
) -> (Vec<SurfaceSample>, Vec<Leaf>) {
    let mut keys: Vec<(u64, u32)> = samples
        .par_iter()
        .enumerate()
        .map(|(i, s)| (code(s, groups), i as u32))
        .collect();
    keys.par_sort_unstable();
    let sorted: Vec<SurfaceSample> = keys.par_iter().map(|(_, i)| samples[*i as usize]).collect();
    drop(samples);
    let codes: Vec<u64> = keys.into_iter().map(|(code, _)| code).collect();
    let tree = Tree {
        samples: &sorted,
        codes: &codes,
        groups,
        eyes,
    };
    let mut roots = Vec::new();
    tree.divide(0, codes.len() as u32, LARGEST, &mut |from, to| {
        roots.push((from, to))
    });
    let mut done: Vec<(u32, u32, u32)> = Vec::new();
    let opened: Vec<DivisibleCell> = roots
        .par_iter()
        .map(|(from, to)| tree.open(*from, *to, LARGEST))
        .collect();
    let mut count = opened.len();
    let mut heap = BinaryHeap::from(opened);
    while let Some(cell) = heap.pop() {
        if cell.level == 0 || cell.gain <= 0.0 || count >= most {
            done.push((cell.from, cell.to, cell.level));
            continue;
        }
        let level = cell.level - 1;
        count -= 1;
        tree.divide(cell.from, cell.to, level, &mut |from, to| {
            count += 1;
            heap.push(tree.open(from, to, level));
        });
    }
    done.sort_unstable();
    let leaf = |(from, to, level): (u32, u32, u32)| {
        let finest_m = finest_m(&groups[usize::from(sorted[from as usize].group)]);
        Leaf {
            from,
            to,
            size_m: finest_m * (1u32 << level) as f32,
        }
    };
    let leaves = done.into_iter().map(leaf).collect();
    (sorted, leaves)
}

struct Tree<'a> {
    samples: &'a [SurfaceSample],
    codes: &'a [u64],
    groups: &'a [SampleGroup],
    /// Places that cameras look from.
    eyes: &'a [Vec3],
}

impl Tree<'_> {
    /// Calls `part` for each cell of a level among these samples.
    fn divide(&self, from: u32, to: u32, level: u32, part: &mut dyn FnMut(u32, u32)) {
        let (mut at, to) = (from as usize, to as usize);
        while at < to {
            let cell = self.codes[at] >> (3 * level);
            let end = at + self.codes[at..to].partition_point(|c| c >> (3 * level) == cell);
            part(at as u32, end as u32);
            at = end;
        }
    }

    fn open(&self, from: u32, to: u32, level: u32) -> DivisibleCell {
        let mut gain = 0.0;
        if level > 0 && to - from > 1 && self.is_too_large(from, to, level) {
            gain = f32::INFINITY;
        } else if level > 0 && to - from > 2 {
            let whole = self.cost(from, to, level);
            let (mut parts, mut count) = (0.0, 0u32);
            self.divide(from, to, level - 1, &mut |a, b| {
                // The variation of colours in a cell is unknown from a single sample.
                let n = (b - a) as f32;
                parts += match b - a {
                    1 => 0.7 * whole / (to - from) as f32,
                    _ => self.cost(a, b, level - 1) * (n / (n - 1.0)).min(2.0),
                };
                count += 1;
            });
            gain = match count {
                // The division needs no additional Gaussian.
                1 => (whole - parts).max(whole * 0.5),
                _ => (whole - parts) / (count - 1) as f32,
            };
        }
        DivisibleCell {
            from,
            to,
            level,
            gain,
        }
    }

    fn size_m(&self, from: u32, level: u32) -> f32 {
        let group = self.samples[from as usize].group;
        finest_m(&self.groups[usize::from(group)]) * (1u32 << level) as f32
    }

    /// True if a cell is so near to where cameras are that its Gaussian, projected to first order, would reach across their
    /// pictures.
    fn is_too_large(&self, from: u32, to: u32, level: u32) -> bool {
        let at = self.samples[(from + (to - from) / 2) as usize].at;
        let nearest = self
            .eyes
            .iter()
            .map(|e| e.distance_squared(at))
            .fold(f32::INFINITY, f32::min);
        let room = (nearest.sqrt() - BESIDE_M).max(NEAREST_M);
        self.size_m(from, level) > LARGE * room
    }

    /// Error with which one colour and one disc show these samples: squared differences summed over pixels.
    fn cost(&self, from: u32, to: u32, level: u32) -> f32 {
        let samples = &self.samples[from as usize..to as usize];
        let (mut sum, mut square, mut normal, mut edge) = (Vec3::ZERO, 0.0f32, Vec3::ZERO, 0.0f32);
        for s in samples {
            let c = Vec3::from(s.rgb.map(f32::from)) / 255.0;
            sum += c;
            square += c.length_squared();
            normal += Vec3::from(s.normal.map(f32::from)) / 127.0;
            if s.is_edge {
                edge += 1.0 / s.width_m;
            }
        }
        let n = samples.len() as f32;
        let size_m = self.size_m(from, level);
        let spread = (square - sum.length_squared() / n).max(0.0);
        let bent = (n - normal.length()).max(0.0);
        spread + EDGE_COST * edge * size_m + BEND_COST * bent
    }
}
