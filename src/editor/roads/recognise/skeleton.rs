//! The middle of the paved area as a graph: thinned to lines of one column, traced, and freed of spurs.

use std::collections::BTreeMap;

use glam::DVec2;

use scene::Extent;
use scene::roads::curve;

use super::mask::Mask;

/// A spur is shorter than this factor times the distance to the kerb where it begins, and this length, m.
const SPUR: f64 = 1.35;
const SPUR_M: f64 = 2.0;
/// Rounds of thinning. A paved area wider than twice so many columns is not thinned to a line: it is a square.
const ROUNDS: usize = 90;
/// More lines than this are no roads.
const MOST: usize = 5000;
/// Junctions closer than this factor times the distance to the kerb there are one.
const ONE: f64 = 1.25;

/// Point where lines end or meet.
#[derive(Clone, Debug)]
pub(super) struct Knot {
    /// Position, m.
    pub at_m: DVec2,
    /// Distance to the kerb, m.
    pub depth_m: f64,
}

/// A line from knot to knot.
#[derive(Clone, Debug)]
pub(super) struct Chain {
    /// Knots at its ends.
    pub ends: [usize; 2],
    /// The way between, m.
    pub points_m: Vec<DVec2>,
}

impl Chain {
    /// Its length, m.
    pub fn length_m(&self) -> f64 {
        curve::length_m(&self.points_m)
    }
}

/// Knots and chains.
#[derive(Clone, Debug, Default)]
pub(super) struct Graph {
    pub knots: Vec<Knot>,
    pub chains: Vec<Chain>,
}

impl Graph {
    /// How many ends of chains are at each knot.
    fn degrees(&self) -> Vec<usize> {
        let mut out = vec![0; self.knots.len()];
        self.chains.iter().flat_map(|c| c.ends).for_each(|e| out[e] += 1);
        out
    }

    /// Chains at a knot; one that ends there twice is counted twice.
    pub fn degree(&self, knot: usize) -> usize {
        self.chains
            .iter()
            .flat_map(|c| c.ends)
            .filter(|e| *e == knot)
            .count()
    }
}

/// The graph of a mask.
pub(super) fn trace(mask: &Mask) -> Graph {
    let thin = thinned(mask);
    let mut graph = walk(mask, &thin);
    // Scattered patches are no network.
    if graph.chains.len() > MOST {
        return Graph::default();
    }
    prune(&mut graph, mask);
    contract(&mut graph);
    merge_joints(&mut graph);
    graph
}

/// Columns around one, counter-clockwise from the one ahead; `None` beyond the margin.
fn around(extent: Extent, i: usize) -> [Option<usize>; 8] {
    const WAYS: [[i64; 2]; 8] = [
        [1, 0],
        [1, 1],
        [0, 1],
        [-1, 1],
        [-1, 0],
        [-1, -1],
        [0, -1],
        [1, -1],
    ];
    let (nx, ny) = (extent.nx() as i64, extent.ny() as i64);
    let (x, y) = ((i as i64) / ny, (i as i64) % ny);
    WAYS.map(|[dx, dy]| {
        let (x, y) = (x + dx, y + dy);
        (x >= 0 && x < nx && y >= 0 && y < ny).then(|| (x * ny + y) as usize)
    })
}

fn thinned(mask: &Mask) -> Vec<bool> {
    let mut on = mask.paved.clone();
    let mut open: Vec<usize> = (0..on.len()).filter(|i| on[*i]).collect();
    for _ in 0..ROUNDS {
        let mut gone_any = false;
        for first in [true, false] {
            let goes = |i: &usize| {
                let p = around(mask.extent, *i).map(|n| n.is_some_and(|n| on[n]));
                let count = p.iter().filter(|v| **v).count();
                let turns = (0..8).filter(|k| !p[*k] && p[(k + 1) % 8]).count();
                // East, north, west, south.
                let [e, n, w, s] = [p[0], p[2], p[4], p[6]];
                let sides = match first {
                    true => !(e && s && (n || w)),
                    false => !(n && w && (e || s)),
                };
                (2..=6).contains(&count) && turns == 1 && sides
            };
            let gone: Vec<usize> = open.iter().copied().filter(goes).collect();
            gone_any |= !gone.is_empty();
            gone.iter().for_each(|i| on[*i] = false);
            open.retain(|i| on[*i]);
        }
        if !gone_any {
            break;
        }
    }
    on
}

/// Follows the thin lines from knot to knot.
fn walk(mask: &Mask, thin: &[bool]) -> Graph {
    let near = |i: usize| -> Vec<usize> {
        let all = around(mask.extent, i);
        let set = |k: usize| all[k].filter(|n| thin[*n]);
        // A corner is no neighbour where a side leads there as well.
        let is_new = |k: usize| k.is_multiple_of(2) || set(k - 1).or(set((k + 1) % 8)).is_none();
        (0..8).filter(|k| is_new(*k)).filter_map(set).collect()
    };
    let mut knot_of = vec![usize::MAX; thin.len()];
    let mut graph = Graph::default();
    let lit = || (0..thin.len()).filter(|i| thin[*i]);
    let mut parts: Vec<Vec<usize>> = Vec::new();
    for start in lit().filter(|i| near(*i).len() != 2) {
        if knot_of[start] != usize::MAX {
            continue;
        }
        let (mut open, mut part) = (vec![start], Vec::new());
        knot_of[start] = parts.len();
        while let Some(i) = open.pop() {
            part.push(i);
            for j in around(mask.extent, i).into_iter().flatten() {
                if thin[j] && near(j).len() != 2 && knot_of[j] == usize::MAX {
                    knot_of[j] = parts.len();
                    open.push(j);
                }
            }
        }
        parts.push(part);
    }
    let mut seen = vec![false; thin.len()];
    // A ring without a junction has a knot anywhere.
    let mut reached = knot_of.iter().map(|k| *k != usize::MAX).collect::<Vec<_>>();
    let mut follow = |from: usize, first: usize, knot_of: &[usize], reached: &mut Vec<bool>| {
        let (mut way, mut last, mut now) = (vec![from], from, first);
        while knot_of[now] == usize::MAX {
            if std::mem::replace(&mut seen[now], true) {
                return None;
            }
            reached[now] = true;
            way.push(now);
            let next = near(now)
                .into_iter()
                .find(|n| *n != last && (knot_of[*n] != usize::MAX || !seen[*n]))?;
            (last, now) = (now, next);
        }
        way.push(now);
        Some((way, knot_of[now]))
    };
    let mut chains = Vec::new();
    let mut followed = vec![false; thin.len()];
    for (k, part) in parts.iter().enumerate() {
        for (i, first) in part
            .iter()
            .flat_map(|i| near(*i).into_iter().map(move |n| (*i, n)))
        {
            if knot_of[first] == k || (knot_of[first] != usize::MAX && knot_of[first] < k) || followed[first]
            {
                continue;
            }
            if let Some((way, end)) = follow(i, first, &knot_of, &mut reached) {
                way[1..way.len() - 1].iter().for_each(|i| followed[*i] = true);
                chains.push(([k, end], way));
            }
        }
    }
    for start in lit() {
        if reached[start] {
            continue;
        }
        let k = parts.len();
        parts.push(vec![start]);
        knot_of[start] = k;
        reached[start] = true;
        if let Some(first) = near(start).first().copied()
            && let Some((way, end)) = follow(start, first, &knot_of, &mut reached)
        {
            chains.push(([k, end], way));
        }
    }
    for part in &parts {
        let at_m = part.iter().map(|i| mask.point_m(*i)).sum::<DVec2>() / part.len() as f64;
        let depth_m = part.iter().map(|i| mask.depth_m[*i]).fold(0.0, f64::max);
        graph.knots.push(Knot { at_m, depth_m });
    }
    let points = |(ends, way): ([usize; 2], Vec<usize>)| Chain {
        ends,
        points_m: way.into_iter().map(|i| mask.point_m(i)).collect(),
    };
    graph.chains = chains.into_iter().map(points).collect();
    graph
}

/// Removes spurs: lines to a free end that only lead to a corner of the paved area. At each knot the shortest goes
/// first, and the rest is looked at again.
fn prune(graph: &mut Graph, mask: &Mask) {
    loop {
        let degrees = graph.degrees();
        let mut shortest: BTreeMap<usize, (f64, usize)> = BTreeMap::new();
        for (i, chain) in graph.chains.iter().enumerate() {
            let Some(free) = chain.ends.iter().position(|e| degrees[*e] == 1) else {
                continue;
            };
            let (tip, root) = (chain.ends[free], chain.ends[1 - free]);
            if degrees[root] < 3 || !mask.is_on_map(graph.knots[tip].at_m) {
                continue;
            }
            let length_m = chain.length_m();
            let best = shortest.entry(root).or_insert((f64::INFINITY, i));
            if length_m < SPUR * graph.knots[root].depth_m + SPUR_M && length_m < best.0 {
                *best = (length_m, i);
            }
        }
        shortest.retain(|_, (length_m, _)| length_m.is_finite());
        if shortest.is_empty() {
            return;
        }
        let mut gone: Vec<usize> = shortest.into_values().map(|s| s.1).collect();
        gone.sort_unstable();
        for i in gone.into_iter().rev() {
            graph.chains.remove(i);
        }
        merge_joints(graph);
    }
}

/// Makes knots one that are nearer to each other than the road is wide.
fn contract(graph: &mut Graph) {
    loop {
        let degrees = graph.degrees();
        let short = graph.chains.iter().position(|c| {
            let [a, b] = c.ends;
            let deep = graph.knots[a].depth_m.max(graph.knots[b].depth_m);
            a != b && degrees[a] > 2 && degrees[b] > 2 && c.length_m() < ONE * deep
        });
        let Some(i) = short else { return };
        let [a, b] = graph.chains.remove(i).ends;
        let (ka, kb) = (&graph.knots[a], &graph.knots[b]);
        graph.knots[a] = Knot {
            at_m: (ka.at_m + kb.at_m) / 2.0,
            depth_m: ka.depth_m.max(kb.depth_m),
        };
        for end in graph.chains.iter_mut().flat_map(|c| &mut c.ends) {
            if *end == b {
                *end = a;
            }
        }
    }
}

/// Two chains that meet at a knot where nothing else does are one.
pub(super) fn merge_joints(graph: &mut Graph) {
    let mut chains: Vec<Option<Chain>> = graph.chains.drain(..).map(Some).collect();
    let mut at: Vec<Vec<usize>> = vec![Vec::new(); graph.knots.len()];
    for (i, chain) in chains.iter().enumerate() {
        for end in chain.iter().flat_map(|c| c.ends) {
            at[end].push(i);
        }
    }
    for knot in 0..at.len() {
        let [a, b] = at[knot][..] else { continue };
        if a == b {
            continue;
        }
        let (Some(mut first), Some(mut second)) = (chains[a].take(), chains[b].take()) else {
            continue;
        };
        if first.ends[1] != knot {
            first.points_m.reverse();
            first.ends.reverse();
        }
        if second.ends[0] != knot {
            second.points_m.reverse();
            second.ends.reverse();
        }
        first.points_m.extend(second.points_m.into_iter().skip(1));
        first.ends[1] = second.ends[1];
        at[knot].clear();
        at[second.ends[1]]
            .iter_mut()
            .filter(|i| **i == b)
            .for_each(|i| *i = a);
        chains[a] = Some(first);
    }
    graph.chains = chains.into_iter().flatten().collect();
}
