//! Where lanes cross, meet or part: zones that become junctions. Every sample of every chain is free or in one zone.

use glam::DVec2;

use super::chains::{Chain, Near, STEP_M};
use scene::Extent;

/// Lanes that run along each other are in one another's way when they are closer, m.
const ALONG_M: f64 = 1.7;
/// Lanes that cross are in one another's way when their samples are closer, m.
const CROSSING_M: f64 = 3.0;
/// Lanes run along each other up to this angle, as a cosine.
pub(super) const ALONG_COSINE: f64 = 0.94;
/// A lane that comes back to itself does so after this way, m.
const OWN_M: f64 = 12.0;
/// Two places of a lane in the way of others are one zone if the free way between them is shorter, m.
const GAP_M: f64 = 6.0;
/// A zone reaches this far beyond the obstructed part, m.
const MARGIN_M: f64 = 3.0;
/// Shortest free part of a lane beside a zone, m; a shorter one joins the zone.
const SHORTEST_FREE_M: f64 = 4.0;

/// No zone.
const FREE: u32 = u32::MAX;

/// Zones of all chains.
#[derive(Clone, Debug)]
pub(super) struct Zones {
    label: Vec<Vec<u32>>,
    parent: Vec<u32>,
}

/// A stretch of a chain: `len` samples from `from` on, around the end of a ring.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct ChainStretch {
    pub len: usize,
    pub chain: usize,
    pub from: usize,
}

impl ChainStretch {
    /// The samples in order.
    pub fn samples(self, chain: &Chain) -> impl DoubleEndedIterator<Item = usize> + use<> {
        let n = chain.len();
        (0..self.len).map(move |i| (self.from + i) % n)
    }
}

fn steps(way_m: f64) -> usize {
    (way_m / STEP_M).round() as usize
}

impl Zones {
    /// Everywhere free.
    fn none(chains: &[Chain]) -> Self {
        Self {
            label: chains.iter().map(|c| vec![FREE; c.len()]).collect(),
            parent: Vec::new(),
        }
    }

    /// Where the lanes are in one another's way, on the map: beyond it they only go straight on.
    pub fn find(extent: Extent, chains: &[Chain], near: &Near) -> Self {
        let mut zones = Self::none(chains);
        let beyond = |p: DVec2| extent.column_at(p.x, p.y).is_none();
        for (i, chain) in chains.iter().enumerate() {
            for (k, p) in chain.points_m.iter().enumerate() {
                let direction = chain.direction(k);
                for other in near.within(*p, CROSSING_M) {
                    if (other.chain, other.k) <= (i, k) || beyond(*p) && beyond(other.at_m) {
                        continue;
                    }
                    let apart = other.k.abs_diff(k);
                    let apart = if chain.closed {
                        apart.min(chain.len() - apart)
                    } else {
                        apart
                    };
                    if other.chain == i && apart <= steps(OWN_M) {
                        continue;
                    }
                    let way = other.at_m - *p;
                    let along = other.direction.dot(direction).abs() >= ALONG_COSINE;
                    let aside_m = direction.perp_dot(way).abs();
                    if !along || (aside_m < ALONG_M && way.dot(direction).abs() <= STEP_M) {
                        zones.join(&[(i, k), (other.chain, other.k)]);
                    }
                }
            }
        }
        zones.close(chains, steps(GAP_M));
        zones.grow(chains, steps(MARGIN_M));
        zones.settle(chains);
        zones
    }

    /// The zone of a sample.
    pub fn of(&self, chain: usize, k: usize) -> Option<usize> {
        let label = self.label[chain][k];
        (label != FREE).then(|| self.root(label) as usize)
    }

    fn root(&self, mut label: u32) -> u32 {
        while self.parent[label as usize] != label {
            label = self.parent[label as usize];
        }
        label
    }

    /// Puts all these samples into one zone, with the zones that they are in.
    pub fn join(&mut self, samples: &[(usize, usize)]) {
        let roots = samples.iter().map(|(c, k)| self.label[*c][*k]);
        let root = roots.filter(|l| *l != FREE).map(|l| self.root(l)).min();
        let root = root.unwrap_or_else(|| {
            self.parent.push(self.parent.len() as u32);
            self.parent.len() as u32 - 1
        });
        for (chain, k) in samples {
            let old = self.label[*chain][*k];
            if old != FREE {
                let old = self.root(old);
                self.parent[old as usize] = root;
            }
            self.label[*chain][*k] = root;
        }
    }

    /// Joins two zones of a chain across a free part between them that is shorter than `shortest` samples.
    pub fn close(&mut self, chains: &[Chain], shortest: usize) {
        for chain in 0..chains.len() {
            for run in self.free(chains, chain) {
                let (before, after) = self.beside(chains, run);
                if let (Some(before), Some(after)) = (before, after)
                    && run.len < shortest
                {
                    let mut all: Vec<(usize, usize)> =
                        run.samples(&chains[chain]).map(|k| (chain, k)).collect();
                    all.extend([(chain, before), (chain, after)]);
                    self.join(&all);
                }
            }
        }
    }

    /// Closes gaps that are too short for a road, and gives up ends of chains that are.
    pub fn settle(&mut self, chains: &[Chain]) {
        let shortest = steps(SHORTEST_FREE_M);
        self.close(chains, shortest);
        for chain in 0..chains.len() {
            for run in self.free(chains, chain) {
                let (before, after) = self.beside(chains, run);
                if let Some(zone) = before.or(after)
                    && run.len < shortest
                {
                    let mut all: Vec<(usize, usize)> =
                        run.samples(&chains[chain]).map(|k| (chain, k)).collect();
                    all.push((chain, zone));
                    self.join(&all);
                }
            }
        }
    }

    fn grow(&mut self, chains: &[Chain], by: usize) {
        for (i, chain) in chains.iter().enumerate() {
            for run in self.free(chains, i) {
                let (before, after) = self.beside(chains, run);
                let samples: Vec<usize> = run.samples(chain).collect();
                let reach = by.min(run.len);
                for (edge, part) in [(before, &samples[..reach]), (after, &samples[run.len - reach..])] {
                    if let Some(edge) = edge {
                        let mut all: Vec<(usize, usize)> = part.iter().map(|k| (i, *k)).collect();
                        all.push((i, edge));
                        self.join(&all);
                    }
                }
            }
        }
    }

    /// The free stretches of a chain, in order.
    pub fn free(&self, chains: &[Chain], chain: usize) -> Vec<ChainStretch> {
        runs(&chains[chain], chain, |k| self.label[chain][k] == FREE)
    }

    /// The samples before and behind a stretch; `None` at an end of the chain, and for a ring that is free all around.
    pub fn beside(&self, chains: &[Chain], run: ChainStretch) -> (Option<usize>, Option<usize>) {
        let chain = &chains[run.chain];
        if chain.closed && run.len == chain.len() {
            return (None, None);
        }
        let last = (run.from + run.len - 1) % chain.len();
        (chain.step(run.from, -1), chain.step(last, 1))
    }
}

/// The stretches of a chain that hold a condition, in order; one that goes around the end of a ring is one.
pub(super) fn runs(of: &Chain, chain: usize, holds: impl Fn(usize) -> bool) -> Vec<ChainStretch> {
    let n = of.len();
    // A ring is read from the first sample behind one that does not hold.
    let first = match of.closed {
        true => (0..n).find(|k| !holds((k + n - 1) % n)).unwrap_or(0),
        false => 0,
    };
    let mut out: Vec<ChainStretch> = Vec::new();
    let mut open = false;
    for i in 0..n {
        let k = (first + i) % n;
        if !holds(k) {
            open = false;
            continue;
        }
        match out.last_mut().filter(|_| open) {
            Some(run) => run.len += 1,
            None => out.push(ChainStretch {
                len: 1,
                chain,
                from: k,
            }),
        }
        open = true;
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    fn straight(from: [f64; 2], to: [f64; 2]) -> Chain {
        Chain::new(&[DVec2::from_array(from), DVec2::from_array(to)], false)
    }

    fn zones(chains: &[Chain]) -> Zones {
        Zones::find(Extent::WINDOW, chains, &Near::new(chains))
    }

    #[test]
    fn lanes_that_cross_share_a_zone_and_neighbours_do_not() {
        let chains = [
            straight([-40.0, 0.0], [40.0, 0.0]),
            straight([40.0, 3.5], [-40.0, 3.5]),
            straight([5.0, -40.0], [5.0, 40.0]),
        ];
        let zones = zones(&chains);
        let at = |chain: usize, x: f64| {
            let place = |p: &DVec2| (p.x + p.y - x).abs();
            let points = &chains[chain].points_m;
            let k = (0..points.len()).min_by(|a, b| place(&points[*a]).total_cmp(&place(&points[*b])));
            zones.of(chain, k.expect("samples"))
        };
        assert!(at(0, 5.0).is_some() && at(0, 5.0) == at(2, 5.0) && at(0, 5.0) == at(2, 8.0));
        assert_eq!(at(0, -10.0), None);
        assert_eq!(at(2, -20.0), None);
        assert_eq!(zones.free(&chains, 0).len(), 2);
        // Up to 3 m in the way, and a margin of 3 m.
        let first = zones.free(&chains, 0)[0];
        assert!(
            (first.len as f64 * STEP_M - (45.0 - 6.0)).abs() < 1.0,
            "{first:?}"
        );
    }

    #[test]
    fn a_ring_is_free_beyond_its_arms() {
        let ring: Vec<DVec2> = (0..200)
            .map(|i| DVec2::from_angle(f64::from(i) * std::f64::consts::TAU / 200.0) * 20.0)
            .collect();
        let chains = [
            Chain::new(&ring, true),
            straight([60.0, 0.0], [22.0, 0.0]),
            straight([-22.0, 0.0], [-60.0, 0.0]),
        ];
        let zones = zones(&chains);
        let free = zones.free(&chains, 0);
        assert_eq!(free.len(), 2, "{free:?}");
        assert_ne!(zones.of(0, 0), None);
        for run in free {
            let (before, after) = zones.beside(&chains, run);
            let zone = |k: Option<usize>| zones.of(0, k.expect("a ring")).expect("a zone");
            assert_ne!(zone(before), zone(after));
        }
    }
}
