//! From a bundle of lanes to a road.

use glam::DVec2;

use super::super::geometry::ReferenceLine;
use super::bundles::{Bundle, Member};
use super::chains::{Chain, GroundKind, surface};
use super::fit::{placed, reference};
use super::strips::{PAVED_M, Station, Strip, Strips, median};
use scene::BevLayout;

/// Narrowest and widest half of a lane without neighbours, m.
const HALF_M: [f64; 2] = [1.2, 4.0];
/// Widths that a lane between others may have, m.
const LANE_M: [f64; 2] = [2.0, 6.2];
/// Borders lie no farther from the middle between two lanes, m.
const OFF_MIDDLE_M: f64 = 0.5;
/// Half of the widest lane beside one that is far away, m.
const WIDEST_HALF_M: f64 = 2.6;
/// Two lanes with less between them share a border, m.
const SHARED_M: f64 = 0.3;

/// A road that is to be written.
pub(super) struct WrittenRoad {
    /// Id in the file.
    pub id: u32,
    /// Id of the junction that it connects through.
    pub junction: Option<u32>,
    pub reference: ReferenceLine,
    /// Places of the stations along the reference line, m: 0 first, its length last.
    pub s_m: Vec<f64>,
    pub strips: Strips,
    /// Neighbours before its start and beyond its end.
    pub ends: [Option<End>; 2],
    /// For each strip the ids of the lanes before and behind.
    pub links: Vec<[Option<i32>; 2]>,
    /// True for lanes that are driven both ways.
    pub two_way: bool,
    /// True for left-hand traffic.
    pub left_hand: bool,
    /// The bundle that it is made of; `None` for connecting roads.
    pub bundle: Option<usize>,
    /// Elements of `<objects>` and of `<signals>`.
    pub objects: Vec<String>,
    pub signals: Vec<String>,
}

/// Neighbour at an end of a road.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum End {
    /// A road, at its end if true, else at its start.
    Road(u32, bool),
    Junction(u32),
}

/// A lane at an end of a road.
#[derive(Clone, Copy, Debug)]
pub(super) struct Contact {
    /// Middle of the lane.
    pub at_m: DVec2,
    /// Direction of its traffic, rad.
    pub heading_rad: f64,
    pub width_m: f64,
    /// Id of the lane.
    pub lane: i32,
}

impl WrittenRoad {
    /// Id of a strip's lane.
    pub fn lane_id(&self, strip: usize) -> i32 {
        let center = self.strips.center;
        match strip < center {
            true => (center - strip) as i32,
            false => -((strip - center) as i32) - 1,
        }
    }

    /// True for a lane whose traffic runs against the rule of its side.
    pub fn is_reversed(&self, strip: usize) -> bool {
        let Strip::Lane { along, .. } = self.strips.kinds[strip] else {
            return false;
        };
        let by_rule = (strip >= self.strips.center) != self.left_hand;
        along != by_rule
    }

    /// A strip at the start (`false`) or end of the road; `None` if it is no lane or has no width there.
    pub fn contact(&self, strip: usize, at_end: bool) -> Option<Contact> {
        let Strip::Lane { along, .. } = self.strips.kinds[strip] else {
            return None;
        };
        let i = if at_end { self.s_m.len() - 1 } else { 0 };
        let base = self.reference.at(self.s_m[i]);
        let [left, right] = [strip, strip + 1].map(|b| self.strips.borders_m[b][i]);
        let turn = if along { 0.0 } else { std::f64::consts::PI };
        (left - right > 0.5).then(|| Contact {
            at_m: base.offset((left + right) / 2.0),
            heading_rad: base.heading_rad + turn,
            width_m: left - right,
            lane: self.lane_id(strip),
        })
    }

    /// The road of a bundle; `None` if its line has no length.
    pub fn of_bundle(
        layout: &BevLayout,
        chains: &[Chain],
        bundle: &Bundle,
        left_hand: bool,
        is_own: impl Fn(DVec2) -> bool,
    ) -> Option<Self> {
        let chain = &chains[bundle.chain];
        let stations: Vec<Station> = bundle.samples.iter().map(|k| station(chain, *k)).collect();
        let lanes = lanes(layout, chains, bundle, &stations, left_hand, &is_own);
        // The line between the two directions, as far from the first lane as it mostly is.
        let mut middle = lanes.borders_m[lanes.center].clone();
        middle.sort_by(f64::total_cmp);
        let shift_m = middle[middle.len() / 2];
        let line: Vec<DVec2> = stations.iter().map(|s| s.at_m + s.left * shift_m).collect();
        let reference = reference(&line, [None, None])?;
        let mut strips = lanes.with_sides(layout, &stations, PAVED_M, is_own);
        let (s_m, off_m) = placed(&reference, &line);
        strips.seen_from(|i| shift_m - off_m[i]);
        strips.straighten();
        Some(Self {
            id: 0,
            junction: None,
            links: vec![[None; 2]; strips.kinds.len()],
            two_way: bundle.members.iter().any(|m| chains[m.chain].two_way),
            reference,
            s_m,
            strips,
            ends: [None; 2],
            left_hand,
            bundle: None,
            objects: Vec::new(),
            signals: Vec::new(),
        })
    }
}

/// A sample with the direction across its lane, over a metre and a half to both sides.
fn station(chain: &Chain, k: usize) -> Station {
    let far = |by: isize| (0..=3).rev().find_map(|n| chain.step(k, by * n)).unwrap_or(k);
    let ahead = chain.points_m[far(1)] - chain.points_m[far(-1)];
    Station {
        at_m: chain.points_m[k],
        left: ahead.normalize_or(DVec2::X).perp(),
    }
}

/// The lanes of a bundle as strips, seen from its first lane.
fn lanes(
    layout: &BevLayout,
    chains: &[Chain],
    bundle: &Bundle,
    stations: &[Station],
    left_hand: bool,
    is_own: &impl Fn(DVec2) -> bool,
) -> Strips {
    let n = bundle.members.len();
    let alone = alone_half_m(layout, &chains[bundle.chain], stations, is_own);
    let there = |i: usize| -> Vec<(usize, f64)> {
        let members = bundle.members.iter().enumerate();
        members
            .filter_map(|(m, member)| Some((m, member.beside[i]?.1)))
            .collect()
    };
    let all: Vec<Vec<(usize, f64)>> = (0..stations.len()).map(there).collect();
    let fair = all.iter().filter(|lanes| shared(lanes, 0.0).is_some()).count();
    let share = fair * 10 >= all.len() * 9;
    // Left and right border of every lane; where it is not, both are the border of its neighbour.
    let mut edges: Vec<Vec<[f64; 2]>> = vec![Vec::with_capacity(stations.len()); n];
    for (i, lanes) in all.iter().enumerate() {
        let borders = match shared(lanes, alone[i]).filter(|_| share) {
            Some(borders) => borders,
            None => halves(lanes, alone[i]),
        };
        let mut at = 0;
        for (m, edges) in edges.iter_mut().enumerate() {
            match lanes.get(at) {
                Some((there, _)) if *there == m => {
                    edges.push(borders[at]);
                    at += 1;
                }
                _ => edges.push([if at > 0 { borders[at - 1][1] } else { borders[0][0] }; 2]),
            }
        }
    }
    let split = split(&bundle.members, left_hand);
    let mut out = Strips {
        kinds: Vec::new(),
        borders_m: vec![edges[0].iter().map(|e| e[0]).collect()],
        center: 0,
    };
    for (m, member) in bundle.members.iter().enumerate() {
        if m > 0 {
            let gap = edges[m - 1]
                .iter()
                .zip(&edges[m])
                .any(|(a, b)| a[1] - b[0] > SHARED_M);
            if gap {
                out.kinds.push(Strip::Between);
                out.borders_m.push(edges[m].iter().map(|e| e[0]).collect());
            } else {
                let last = out.borders_m.len() - 1;
                let middle = |(a, b): (&[f64; 2], &[f64; 2])| (a[1] + b[0]) / 2.0;
                out.borders_m[last] = edges[m - 1].iter().zip(&edges[m]).map(middle).collect();
            }
        }
        if m == split {
            out.center = out.kinds.len();
        }
        out.kinds.push(Strip::Lane {
            chain: member.chain,
            along: member.along,
        });
        out.borders_m.push(edges[m].iter().map(|e| e[1]).collect());
    }
    if split == n {
        out.center = out.kinds.len();
    }
    // Never growing to the right, whatever the lanes did.
    for b in 1..out.borders_m.len() {
        let (left, right) = out.borders_m.split_at_mut(b);
        for (l, r) in left[b - 1].iter().zip(&mut right[0]) {
            *r = r.min(*l);
        }
    }
    out
}

/// Half of the width that a lane alone has at each station: as far as its narrower side is paved.
fn alone_half_m(
    layout: &BevLayout,
    chain: &Chain,
    stations: &[Station],
    is_own: &impl Fn(DVec2) -> bool,
) -> Vec<f64> {
    if let Some(half_m) = chain.half_m {
        return vec![half_m; stations.len()];
    }
    let extent = layout.extent();
    let mut last = None;
    let mut looks: Vec<Option<f64>> = Vec::with_capacity(stations.len());
    for s in stations {
        let paved = |side: f64| {
            let looks = (1..=(HALF_M[1] * 10.0) as i32).map(|i| f64::from(i) / 10.0);
            let mut free = looks.take_while(|m| {
                let p = s.at_m + s.left * (side * m);
                surface(layout, extent, p) == GroundKind::Road && is_own(p)
            });
            free.by_ref().last().unwrap_or(0.0)
        };
        if surface(layout, extent, s.at_m) != GroundKind::Beyond {
            last = Some(paved(1.0).min(paved(-1.0)).clamp(HALF_M[0], HALF_M[1]));
        }
        looks.push(last);
    }
    let first = looks.iter().flatten().next().copied().unwrap_or(1.75);
    let filled: Vec<f64> = looks.iter().map(|l| l.unwrap_or(first)).collect();
    median(&median(&filled))
}

/// Borders of lanes that put each lane in the middle between its own. One number is free and chosen so that the borders
/// are nearest to the middles between lanes. `None` if a border would be too far from there, or a lane would get a
/// width that no lane has.
fn shared(lanes: &[(usize, f64)], alone_m: f64) -> Option<Vec<[f64; 2]>> {
    if let [(_, t)] = lanes {
        return Some(vec![[t + alone_m, t - alone_m]]);
    }
    let mut constant = vec![0.0];
    for (_, t) in lanes {
        constant.push(2.0 * t - constant[constant.len() - 1]);
    }
    let sign = |i: usize| if i.is_multiple_of(2) { 1.0 } else { -1.0 };
    let middle = |i: usize| (lanes[i - 1].1 + lanes[i].1) / 2.0;
    let inner = 1..lanes.len();
    let free = inner
        .clone()
        .map(|i| sign(i) * (middle(i) - constant[i]))
        .sum::<f64>()
        / inner.len() as f64;
    let border = |i: usize| sign(i) * free + constant[i];
    let near = inner
        .clone()
        .all(|i| (border(i) - middle(i)).abs() < OFF_MIDDLE_M);
    let wide = (0..lanes.len()).all(|i| (LANE_M[0]..=LANE_M[1]).contains(&(border(i) - border(i + 1))));
    (near && wide).then(|| (0..lanes.len()).map(|i| [border(i), border(i + 1)]).collect())
}

/// Borders half way to the nearer neighbour, with ground between lanes where the other is farther.
fn halves(lanes: &[(usize, f64)], alone_m: f64) -> Vec<[f64; 2]> {
    let half = |i: usize| {
        let to_left = i.checked_sub(1).map(|before| lanes[before].1 - lanes[i].1);
        let to_right = lanes.get(i + 1).map(|next| lanes[i].1 - next.1);
        let nearer = to_left.into_iter().chain(to_right).reduce(f64::min);
        nearer.map_or(alone_m, |m| (m / 2.0).min(WIDEST_HALF_M))
    };
    let lanes = lanes.iter().enumerate();
    lanes.map(|(i, (_, t))| [t + half(i), t - half(i)]).collect()
}

/// The first of the lanes that lie right of the reference line.
fn split(members: &[Member], left_hand: bool) -> usize {
    let right_along = !left_hand;
    let wrong = |split: usize| {
        let (left, right) = members.split_at(split);
        left.iter().filter(|m| m.along == right_along).count()
            + right.iter().filter(|m| m.along != right_along).count()
    };
    (0..=members.len()).min_by_key(|s| wrong(*s)).unwrap_or(0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lanes_lie_in_the_middle_of_their_borders() {
        let lanes = [(0, 7.0), (1, 3.5), (2, 0.25), (3, -3.0)];
        // Widths 3.75, 3.25, 3.25, 3.25 at borders 8.875, 5.125, 1.875, -1.375, -4.625.
        let borders = shared(&lanes, 0.0).expect("fair lanes");
        for ((_, t), [l, r]) in lanes.iter().zip(&borders) {
            assert!(((l + r) / 2.0 - t).abs() < 1e-9 && l - r > 2.9);
        }
        for pair in borders.windows(2) {
            assert!((pair[0][1] - pair[1][0]).abs() < 1e-9);
        }
        assert_eq!(shared(&[(0, 0.0)], 1.5), Some(vec![[1.5, -1.5]]));
        // A strip of 2.5 m between two pairs.
        let parted = [(0, 9.5), (1, 6.0), (2, 0.0), (3, -3.5)];
        assert!(shared(&parted, 0.0).is_none());
        let borders = halves(&parted, 0.0);
        assert_eq!(
            borders,
            [[11.25, 7.75], [7.75, 4.25], [1.75, -1.75], [-1.75, -5.25]]
        );
    }
}
