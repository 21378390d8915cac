//! Lanes side by side, grouped: each bundle becomes a road. Parts of lanes that are free of zones belong to one bundle
//! each.

use std::collections::{BTreeMap, BinaryHeap};

use glam::DVec2;

use super::chains::{Chain, GroundKind, Near, surface};
use super::zones::{ALONG_COSINE, ChainStretch, Zones, runs};
use scene::BevLayout;

/// Middles of lanes that are side by side are this far apart, m.
const APART_M: [f64; 2] = [1.5, 6.0];
/// Samples beside one another differ by at most this along the lane, m.
const BESIDE_M: f64 = 0.3;
/// A neighbour that is present on fewer samples than this is dropped, and a gap of at most so many is closed.
const SHORT: usize = 6;
/// Half of the zone where a lane parts from its bundle, samples.
const PART: usize = 6;
/// A rest of lanes before a zone is part of the zone if it is shorter than this, samples.
const RAGGED: usize = 30;
/// Shortest road, samples.
const SHORTEST: usize = 8;
/// Rounds in which zones grow where lanes part.
const ROUNDS: usize = 16;

/// A lane of a bundle, seen along the bundle's first lane.
#[derive(Clone, Debug)]
pub(super) struct Member {
    pub chain: usize,
    /// True if it is driven in the direction of the first lane.
    pub along: bool,
    /// Sample beside each sample of the first lane, and how far to the left it is, m; none where the lane is not there.
    pub beside: Vec<Option<(usize, f64)>>,
}

/// Lanes side by side.
#[derive(Clone, Debug)]
pub(super) struct Bundle {
    /// The lane that the others are seen from.
    pub chain: usize,
    /// Its samples, in driving direction.
    pub samples: Vec<usize>,
    /// All lanes from left to right, this one too.
    pub members: Vec<Member>,
}

/// Bundles, and the bundle of every sample of every chain.
pub(super) struct Bundled {
    pub bundles: Vec<Bundle>,
    pub owner: Vec<Vec<Option<usize>>>,
}

/// Groups the free parts of lanes. Zones grow where a lane leaves its neighbours without an end.
pub(super) fn bundled(layout: &BevLayout, chains: &[Chain], near: &Near, zones: &mut Zones) -> Bundled {
    for round in 0.. {
        let mut pass = Pass {
            layout,
            chains,
            near,
            zones,
            owner: chains.iter().map(|c| vec![None; c.len()]).collect(),
            bundles: Vec::new(),
            cuts: Vec::new(),
            is_last: round == ROUNDS,
        };
        pass.run();
        pass.leftovers();
        let (bundles, owner, cuts) = (pass.bundles, pass.owner, pass.cuts);
        if cuts.is_empty() || round == ROUNDS {
            return Bundled { bundles, owner };
        }
        cuts.iter().for_each(|cut| zones.join(cut));
        zones.settle(chains);
    }
    unreachable!("the last round returns")
}

struct Pass<'a> {
    layout: &'a BevLayout,
    chains: &'a [Chain],
    near: &'a Near,
    zones: &'a Zones,
    owner: Vec<Vec<Option<usize>>>,
    bundles: Vec<Bundle>,
    cuts: Vec<Vec<(usize, usize)>>,
    /// Whatever parts is left together.
    is_last: bool,
}

/// A neighbour beside a sample.
struct LaneNeighbour {
    chain: usize,
    k: usize,
    left_m: f64,
    along: bool,
}

impl Pass<'_> {
    /// The longest free stretch first, with all that runs beside it.
    fn run(&mut self) {
        let all = (0..self.chains.len()).flat_map(|c| self.zones.free(self.chains, c));
        let mut queue: BinaryHeap<(usize, std::cmp::Reverse<(usize, usize)>)> = BinaryHeap::new();
        let put = |queue: &mut BinaryHeap<_>, run: ChainStretch| {
            if run.len >= SHORTEST {
                queue.push((run.len, std::cmp::Reverse((run.chain, run.from))));
            }
        };
        all.for_each(|run| put(&mut queue, run));
        while let Some((len, std::cmp::Reverse((chain, from)))) = queue.pop() {
            let run = ChainStretch { len, chain, from };
            let samples: Vec<usize> = run.samples(&self.chains[chain]).collect();
            let left: Vec<&[usize]> = samples
                .split(|k| self.owner[chain][*k].is_some())
                .filter(|part| !part.is_empty())
                .collect();
            match left.as_slice() {
                [whole] if whole.len() == samples.len() => {
                    let samples = whole.to_vec();
                    self.bundle(chain, samples);
                }
                parts => parts.iter().for_each(|part| {
                    let run = ChainStretch {
                        len: part.len(),
                        chain,
                        from: part[0],
                    };
                    put(&mut queue, run);
                }),
            }
        }
    }

    fn is_open(&self, chain: usize, k: usize) -> bool {
        self.zones.of(chain, k).is_none() && self.owner[chain][k].is_none()
    }

    /// Neighbours to one side of a sample (1: left), the nearest first.
    fn neighbours(&self, chain: usize, k: usize, side: f64) -> Vec<LaneNeighbour> {
        let (p, direction) = (self.chains[chain].points_m[k], self.chains[chain].direction(k));
        let left = direction.perp() * side;
        let mut out: Vec<LaneNeighbour> = Vec::new();
        let mut at_m = 0.0;
        loop {
            let here = p + left * at_m;
            let mut best: Option<LaneNeighbour> = None;
            for s in self.near.within(here, APART_M[1] + 0.5) {
                let cosine = s.direction.dot(direction);
                let along_m = (s.at_m - p).dot(direction);
                if cosine.abs() < ALONG_COSINE || along_m.abs() > BESIDE_M || s.chain == chain {
                    continue;
                }
                if !self.is_open(s.chain, s.k) || out.iter().any(|h| h.chain == s.chain) {
                    continue;
                }
                // Where the other lane crosses the line across this one.
                let slope = direction.perp_dot(s.direction) / cosine * side;
                let left_m = (s.at_m - p).dot(left) - along_m * slope;
                let apart_m = left_m - at_m;
                let nearer = best.as_ref().is_none_or(|b| left_m < b.left_m * side);
                if (APART_M[0]..=APART_M[1]).contains(&apart_m) && nearer {
                    best = Some(LaneNeighbour {
                        chain: s.chain,
                        k: s.k,
                        left_m: left_m * side,
                        along: cosine > 0.0,
                    });
                }
            }
            match best {
                Some(hit) if self.is_paved(here, p + left * (hit.left_m * side)) => {
                    at_m = hit.left_m * side;
                    out.push(hit);
                }
                _ => return out,
            }
        }
    }

    /// True if one can drive from the one place to the other.
    fn is_paved(&self, from: DVec2, to: DVec2) -> bool {
        let extent = self.layout.extent();
        (1..8).all(|i| {
            let here = surface(self.layout, extent, from.lerp(to, f64::from(i) / 8.0));
            matches!(here, GroundKind::Road | GroundKind::Carpark | GroundKind::Beyond)
        })
    }

    fn bundle(&mut self, chain: usize, mut samples: Vec<usize>) {
        let mut others: BTreeMap<usize, Member> = BTreeMap::new();
        for (i, k) in samples.iter().enumerate() {
            for hit in [1.0, -1.0]
                .iter()
                .flat_map(|side| self.neighbours(chain, *k, *side))
            {
                let member = others.entry(hit.chain).or_insert_with(|| Member {
                    chain: hit.chain,
                    along: hit.along,
                    beside: vec![None; samples.len()],
                });
                member.beside[i] = Some((hit.k, hit.left_m));
            }
        }
        others.retain(|_, m| {
            fill(&mut m.beside);
            m.beside.iter().flatten().count() >= SHORT
        });
        let own = Member {
            chain,
            along: true,
            beside: samples.iter().map(|k| Some((*k, 0.0))).collect(),
        };
        let mut members: Vec<Member> = others.into_values().chain([own]).collect();
        let mean = |m: &Member| {
            let all: Vec<f64> = m.beside.iter().flatten().map(|b| b.1).collect();
            all.iter().sum::<f64>() / all.len() as f64
        };
        members.sort_by(|a, b| mean(b).total_cmp(&mean(a)));
        self.trim(chain, &mut samples, &mut members);
        if samples.len() < SHORTEST {
            // Beyond the map, or hardly on it: looked at no more.
            for k in &samples {
                self.owner[chain][*k] = Some(usize::MAX);
            }
            return;
        }
        let cuts = self.partings(&samples, &members);
        if cuts.is_empty() || self.is_last {
            let id = self.bundles.len();
            for member in &members {
                self.claim(member, id);
            }
            self.bundles.push(Bundle {
                chain,
                samples,
                members,
            });
        } else {
            self.cuts.extend(cuts);
            // Not to be looked at again in this round.
            for k in &samples {
                self.owner[chain][*k] = Some(usize::MAX);
            }
        }
    }

    /// Drops ends at which every lane lies beyond the map. Next to a zone as much stays as a road needs.
    fn trim(&self, chain: usize, samples: &mut Vec<usize>, members: &mut [Member]) {
        let extent = self.layout.extent();
        let n = samples.len();
        let inside = |i: usize| {
            let mut places = members
                .iter()
                .filter_map(|m| Some(self.chains[m.chain].points_m[m.beside[i]?.0]));
            places.any(|p| extent.column_at(p.x, p.y).is_some())
        };
        let meets = |k: usize, by: isize| {
            let beyond = self.chains[chain].step(k, by);
            beyond.is_some_and(|k| self.zones.of(chain, k).is_some())
        };
        let (at_start, at_end) = (meets(samples[0], -1), meets(samples[n - 1], 1));
        let first = (0..n).find(|i| inside(*i));
        let last = (0..n).rev().find(|i| inside(*i));
        let (first, last) = match (first, last, at_start, at_end) {
            (Some(first), Some(last), ..) => (first, last),
            (_, _, true, _) => (0, 0),
            (_, _, _, true) => (n - 1, n - 1),
            _ => return samples.truncate(1),
        };
        let from = if at_start { 0 } else { first.saturating_sub(1) };
        let to = if at_end { n - 1 } else { (last + 1).min(n - 1) };
        let from = from.min(to.saturating_sub(SHORTEST));
        let to = to.max((from + SHORTEST).min(n - 1));
        *samples = samples[from..=to].to_vec();
        for member in members {
            member.beside = member.beside[from..=to].to_vec();
        }
    }

    /// Where a lane joins or leaves the others and goes on, or changes places with another.
    fn partings(&self, samples: &[usize], members: &[Member]) -> Vec<Vec<(usize, usize)>> {
        let mut cuts = Vec::new();
        let last = samples.len() - 1;
        for member in members {
            let chain = &self.chains[member.chain];
            let there = |i: usize| member.beside[i].is_some();
            for i in (0..=last).filter(|i| there(*i)) {
                for (edge, ahead) in [(i > 0 && !there(i - 1), false), (i < last && !there(i + 1), true)] {
                    let Some((k, _)) = member.beside[i].filter(|_| edge) else {
                        continue;
                    };
                    let by = if ahead == member.along { 1 } else { -1 };
                    let goes_on = chain.step(k, by * 4).is_some();
                    if goes_on {
                        let mut cut = self.cut(samples, members, i, ahead);
                        cut.extend((0..4).filter_map(|n| Some((member.chain, chain.step(k, by * n)?))));
                        cuts.push(cut);
                    }
                }
            }
        }
        let wrong = (0..=last).find(|i| {
            let lefts: Vec<f64> = members.iter().filter_map(|m| Some(m.beside[*i]?.1)).collect();
            lefts.windows(2).any(|pair| pair[0] <= pair[1])
        });
        cuts.extend(wrong.map(|i| self.cut(samples, members, i, true)));
        cuts
    }

    /// All lanes around a place of the first lane; up to its end if a zone begins shortly behind.
    fn cut(&self, samples: &[usize], members: &[Member], i: usize, ahead: bool) -> Vec<(usize, usize)> {
        let (n, chain) = (samples.len(), &self.chains[members_first(members, samples).chain]);
        let own = members_first(members, samples).chain;
        let (mut from, mut to) = (i.saturating_sub(PART), (i + PART).min(n - 1));
        let mut out = Vec::new();
        if ahead && n - i < RAGGED {
            if let Some(k) = chain
                .step(samples[n - 1], 1)
                .filter(|k| self.zones.of(own, *k).is_some())
            {
                (from, to) = (i, n - 1);
                out.push((own, k));
            }
        } else if !ahead
            && i < RAGGED
            && let Some(k) = chain
                .step(samples[0], -1)
                .filter(|k| self.zones.of(own, *k).is_some())
        {
            (from, to) = (0, i);
            out.push((own, k));
        }
        for member in members {
            out.extend((from..=to).filter_map(|i| Some((member.chain, member.beside[i]?.0))));
        }
        out
    }

    /// All samples of a lane from where it comes to where it ends.
    fn claim(&mut self, member: &Member, id: usize) {
        let chain = &self.chains[member.chain];
        let mut before: Option<usize> = None;
        for (k, _) in member.beside.iter().flatten() {
            // Bends leave samples out on their outer side.
            let mut at = before.unwrap_or(*k);
            let by = if member.along { 1 } else { -1 };
            for _ in 0..8 {
                if at == *k {
                    break;
                }
                match chain.step(at, by) {
                    Some(next) => at = next,
                    None => break,
                }
                if at != *k && self.zones.of(member.chain, at).is_none() {
                    self.owner[member.chain][at].get_or_insert(id);
                }
            }
            self.owner[member.chain][*k] = Some(id);
            before = Some(*k);
        }
    }

    /// Makes zones of short rests beside a zone that are in no bundle, and of places where one bundle changes to
    /// another.
    fn leftovers(&mut self) {
        for (i, chain) in self.chains.iter().enumerate() {
            for run in runs(chain, i, |k| self.is_open(i, k)) {
                let last = (run.from + run.len - 1) % chain.len();
                let ends = [chain.step(run.from, -1), chain.step(last, 1)];
                let zone = ends
                    .into_iter()
                    .flatten()
                    .find(|k| self.zones.of(i, *k).is_some());
                if let Some(zone) = zone.filter(|_| run.len < RAGGED) {
                    let mut cut: Vec<(usize, usize)> = run.samples(chain).map(|k| (i, k)).collect();
                    cut.push((i, zone));
                    self.cuts.push(cut);
                }
            }
            for k in 0..chain.len() {
                let Some(next) = chain.step(k, 1) else { continue };
                let (Some(a), Some(b)) = (self.owner[i][k], self.owner[i][next]) else {
                    continue;
                };
                if a != b && a != usize::MAX && b != usize::MAX {
                    let mut cut = self.around(a, i, k);
                    cut.extend(self.around(b, i, next));
                    self.cuts.push(cut);
                }
            }
        }
    }

    /// All lanes of a bundle around a sample of one of them.
    fn around(&self, bundle: usize, chain: usize, k: usize) -> Vec<(usize, usize)> {
        let bundle = &self.bundles[bundle];
        let member = bundle.members.iter().find(|m| m.chain == chain);
        let at = member.and_then(|m| {
            m.beside
                .iter()
                .position(|b| b.is_some_and(|b| b.0.abs_diff(k) <= 1))
        });
        let Some(at) = at else {
            return vec![(chain, k)];
        };
        let part = at.saturating_sub(PART)..=(at + PART).min(bundle.samples.len() - 1);
        let members = bundle.members.iter();
        members
            .flat_map(|m| {
                part.clone()
                    .filter_map(|i| Some((m.chain, m.beside[i]?.0)))
                    .collect::<Vec<_>>()
            })
            .collect()
    }
}

/// The member that the others are seen from: beside itself everywhere.
fn members_first<'a>(members: &'a [Member], samples: &[usize]) -> &'a Member {
    let own = |m: &&Member| m.along && m.beside.iter().zip(samples).all(|(b, k)| *b == Some((*k, 0.0)));
    members.iter().find(own).unwrap_or(&members[0])
}

/// Closes short gaps.
fn fill(beside: &mut [Option<(usize, f64)>]) {
    let mut last: Option<usize> = None;
    for i in 0..beside.len() {
        let Some((_, here_m)) = beside[i] else { continue };
        if let Some(from) = last
            && (2..=SHORT).contains(&(i - from))
            && let Some((k, before_m)) = beside[from]
        {
            for (n, gap) in beside[from + 1..i].iter_mut().enumerate() {
                let share = (n + 1) as f64 / (i - from) as f64;
                *gap = Some((k, before_m + (here_m - before_m) * share));
            }
        }
        last = Some(i);
    }
}
