//! Trees from vegetation: stems where they show, else the middles of crowns; every high column goes to the nearest.

use glam::DVec2;

use super::columns::{ClassColumns, around, middle_m};
use crate::Extent;
use crate::background::{Tree, TreeKind};
use crate::distance::signed_distance_m;

/// Vegetation lower than this is shrubs, m.
const LOWEST_M: f64 = 2.0;
/// Trees stand at least this far apart, m.
const APART_M: f64 = 1.3;
/// Largest crown, m.
const LARGEST_M: f64 = 3.6;
/// Columns above this are cut off by the top of the grid, m; such a tree has this height.
const CUT_M: f64 = 5.2;
const CUT_HEIGHT_M: f64 = 6.5;
/// How often crowns are sought in what the trees found do not cover.
const PASSES: usize = 3;
/// A stem counts for so much more than a crown.
const STEM: f64 = 100.0;

/// Trees of the labels; the columns of their crowns are marked in `taken`.
pub(super) fn trees(vegetation: &ClassColumns, taken: &mut [bool]) -> Vec<Tree> {
    let map = vegetation.map;
    let high: Vec<bool> = (0..map.columns())
        .map(|c| vegetation.top_m[c] >= LOWEST_M)
        .collect();
    let mut left = high.clone();
    let mut trees: Vec<Tree> = Vec::new();
    for pass in 0..PASSES {
        let scores = scores(vegetation, &left, pass == 0);
        let seeds = peaks(map, &scores, &trees);
        if seeds.is_empty() {
            break;
        }
        // Every high column belongs to the nearest of the new trees.
        let mut crowns: Vec<Vec<usize>> = vec![Vec::new(); seeds.len()];
        for c in (0..map.columns()).filter(|c| left[*c]) {
            let p = middle_m(map, c);
            let near = (0..seeds.len()).min_by(|a, b| {
                let d = |i: usize| seeds[i].distance_squared(p);
                d(*a).total_cmp(&d(*b))
            });
            if let Some(i) = near.filter(|i| seeds[*i].distance(p) <= LARGEST_M) {
                crowns[i].push(c);
            }
        }
        for (seed, crown) in seeds.iter().zip(&crowns).filter(|(_, crown)| crown.len() >= 2) {
            trees.push(tree(*seed, crown, vegetation));
        }
        for tree in &trees {
            let reach = tree.crown_radius_m + 0.5 * map.voxel_m();
            crate::raster::disc_cells(map, tree.position_m, reach, |x, y| {
                let c = map.index(x, y);
                (left[c], taken[c]) = (false, true);
            });
        }
    }
    trees
}

/// How much a column looks like the middle of a tree; 0 where there is no crown.
fn scores(vegetation: &ClassColumns, left: &[bool], with_stems: bool) -> Vec<f64> {
    let map = vegetation.map;
    let deep = signed_distance_m(map, |c| left[c]);
    let crown = |c: usize| match left[c] {
        // Deep inside the crown, high and dense.
        true => {
            f64::from(deep[c].abs()).min(4.0)
                + 0.25 * vegetation.top_m[c]
                + 0.05 * f64::from(vegetation.count(c))
        }
        false => 0.0,
    };
    let rough: Vec<f64> = (0..map.columns()).map(crown).collect();
    let smooth = |c: usize| {
        let (sum, n) = around(map, c, 1).fold((0.0, 0), |(sum, n), near| (sum + rough[near], n + 1));
        sum / f64::from(n)
    };
    (0..map.columns())
        .map(|c| match (left[c], with_stems && is_stem(vegetation, c)) {
            (false, _) => 0.0,
            (true, true) => smooth(c) + STEM,
            (true, false) => smooth(c),
        })
        .collect()
}

/// True if the column reaches the ground under a crown, and most of what is around it does not.
fn is_stem(vegetation: &ClassColumns, c: usize) -> bool {
    if vegetation.low(c) < 3 {
        return false;
    }
    let (mut open, mut all) = (0, 0);
    let near_by = |reach| around(vegetation.map, c, reach);
    for near in near_by(3).filter(|n| !near_by(1).any(|m| m == *n)) {
        all += 1;
        open += u32::from(vegetation.low(near) <= 1);
    }
    open * 10 >= all * 7
}

/// Places of the highest scores, apart from each other and from the trees that are there.
fn peaks(map: Extent, scores: &[f64], trees: &[Tree]) -> Vec<DVec2> {
    let is_peak = |c: &usize| {
        let reach = if scores[*c] >= STEM { 2 } else { 3 };
        scores[*c] > 0.0
            && around(map, *c, reach).all(|n| scores[n] < scores[*c] || (scores[n] == scores[*c] && n >= *c))
    };
    let mut order: Vec<usize> = (0..scores.len()).filter(is_peak).collect();
    order.sort_by(|a, b| scores[*b].total_cmp(&scores[*a]).then(a.cmp(b)));
    let mut out: Vec<DVec2> = Vec::new();
    for c in order {
        let p = middle_m(map, c);
        let apart = out.iter().all(|o| o.distance(p) >= APART_M);
        if apart && trees.iter().all(|t| t.position_m.distance(p) >= 0.8) {
            out.push(p);
        }
    }
    out
}

fn tree(place_m: DVec2, crown: &[usize], vegetation: &ClassColumns) -> Tree {
    let mut reach: Vec<f64> = crown
        .iter()
        .map(|c| middle_m(vegetation.map, *c).distance(place_m))
        .collect();
    reach.sort_by(f64::total_cmp);
    let radius = reach[(reach.len() - 1) * 9 / 10] + 0.5 * vegetation.map.voxel_m();
    let top = crown.iter().map(|c| vegetation.top_m[*c]).fold(0.0, f64::max);
    Tree {
        position_m: place_m,
        height_m: if top >= CUT_M { CUT_HEIGHT_M } else { top },
        crown_radius_m: radius.clamp(0.4, LARGEST_M),
        kind: TreeKind::Broadleaf,
    }
}
