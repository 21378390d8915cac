//! Ways through a zone along its lanes, also over lanes that fork off and join.

use std::collections::{BTreeSet, HashMap};

use glam::DVec2;

use super::chains::ChainSample;
use super::connect::{ConnectionContext, Gates, ZoneLaneEnd, ZonePath, is_apart};

/// A lane begins or ends beside another one if it is that near, m, and runs as it does, as a cosine.
const BESIDE_M: f64 = 1.0;
const ALIKE_COSINE: f64 = 0.9;
/// Changes from lane to lane on one way, and ways that are tried from one lane, at most.
const MOST_CHANGES: usize = 5;
const MOST_WALKS: usize = 200;
/// Samples of one way, at most.
const LONGEST_WALK: usize = 800;

/// Where lanes begin beside others and where they end beside others, in zones.
pub(super) struct Forks {
    /// Lanes that begin beside a sample.
    begin: HashMap<(usize, usize), Vec<usize>>,
    /// The sample beside the end of a lane.
    end: HashMap<usize, (usize, usize)>,
}

impl Forks {
    pub fn find(ground: &ConnectionContext<'_>) -> Self {
        let mut out = Self {
            begin: HashMap::new(),
            end: HashMap::new(),
        };
        for (i, chain) in ground.chains.iter().enumerate() {
            if chain.closed || chain.two_way {
                continue;
            }
            // The other lane passes by: it does not begin or end there itself.
            let passes = |s: &ChainSample, begins: bool| {
                let other = &ground.chains[s.chain];
                other.closed || if begins { s.k >= 2 } else { s.k + 2 < other.len() }
            };
            let beside = |k: usize, begins: bool| {
                let direction = chain.direction(k);
                let zone = ground.zones.of(i, k)?;
                let fits = |s: &&ChainSample| {
                    s.chain != i
                        && passes(s, begins)
                        && s.direction.dot(direction) > ALIKE_COSINE
                        && ground.zones.of(s.chain, s.k) == Some(zone)
                };
                let at_m = chain.points_m[k];
                let all = ground.near.within(at_m, BESIDE_M).filter(fits);
                let nearest = all.min_by(|a, b| {
                    let [a, b] = [a, b].map(|s| s.at_m.distance_squared(at_m));
                    a.total_cmp(&b)
                });
                nearest.map(|s| (s.chain, s.k))
            };
            if let Some(host) = beside(0, true) {
                out.begin.entry(host).or_default().push(i);
            }
            if let Some(host) = beside(chain.len() - 1, false) {
                out.end.insert(i, host);
            }
        }
        out
    }
}

/// A walk along lanes of a zone.
#[derive(Clone)]
struct Walk {
    chain: usize,
    k: usize,
    points_m: Vec<DVec2>,
    changes: usize,
}

/// Ways along lanes that lead through, also over lanes that fork off and join; true if any does.
pub(super) fn through(ground: &ConnectionContext<'_>, forks: &Forks, gates: &Gates) -> (Vec<ZonePath>, bool) {
    let mut out: Vec<ZonePath> = Vec::new();
    let mut forked = false;
    for from in &gates.inward {
        let chain = &ground.chains[from.chain];
        let ahead = DVec2::from_angle(from.contact.heading_rad);
        // A lane that is driven both ways is followed from either end.
        let by = if chain.direction(from.k).dot(ahead) < 0.0 {
            -1
        } else {
            1
        };
        if by < 0 && !from.two_way {
            continue;
        }
        let mut open = vec![Walk {
            chain: from.chain,
            k: from.k,
            points_m: vec![from.contact.at_m],
            changes: 0,
        }];
        let mut walks = 0;
        while let Some(mut walk) = open.pop() {
            walks += 1;
            for _ in 0..LONGEST_WALK {
                let chain = &ground.chains[walk.chain];
                if walk.changes < MOST_CHANGES && walks < MOST_WALKS && by > 0 {
                    for other in forks.begin.get(&(walk.chain, walk.k)).into_iter().flatten() {
                        let mut fork = walk.clone();
                        (fork.chain, fork.k) = (*other, 0);
                        fork.changes += 1;
                        open.push(fork);
                    }
                }
                let next = match chain.step(walk.k, by) {
                    Some(next) => (walk.chain, next),
                    None => match forks.end.get(&walk.chain) {
                        Some(host) if walk.changes < MOST_CHANGES => {
                            walk.changes += 1;
                            *host
                        }
                        _ => break,
                    },
                };
                (walk.chain, walk.k) = next;
                let is_here = |d: &&ZoneLaneEnd| (d.chain, d.k) == next && d.arm() != from.arm();
                if let Some(to) = gates.outward.iter().find(is_here) {
                    let mut points_m = walk.points_m;
                    points_m.push(to.contact.at_m);
                    forked |= walk.changes > 0;
                    out.push(ZonePath {
                        from: *from,
                        to: *to,
                        points_m,
                    });
                    break;
                }
                if next == (from.chain, from.k) {
                    break;
                }
                walk.points_m.push(ground.chains[next.0].points_m[next.1]);
            }
        }
    }
    out.retain(is_apart);
    // The shortest way between two lanes; both ways of a lane that is driven both ways are one road.
    out.sort_by_key(|way| way.points_m.len());
    let mut seen = BTreeSet::new();
    out.retain(|way| {
        let [a, b] = [way.from, way.to].map(|d| (d.road, d.at_end, d.contact.lane));
        seen.insert(if way.from.two_way {
            [a.min(b), a.max(b)]
        } else {
            [a, b]
        })
    });
    (out, forked)
}
