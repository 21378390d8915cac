//! What lies across a road: lanes, and to both sides of them paved ground, car parks and walkways as far as the cells of the
//! layout say.

use glam::DVec2;

use super::chains::{Surface, surface};
use scene::BevLayout;

/// Paved ground belongs to a road up to this far from its lanes, m.
const PAVED_M: f64 = 10.0;
/// A car park as far beyond that, m.
const CARPARK_M: f64 = 8.0;
/// A walkway begins at most this far from the paved ground, m.
const VERGE_M: f64 = 3.0;
/// And is at most that wide, m.
const WALKWAY_M: f64 = 8.0;
/// Distance between two looks at the ground, m.
const LOOK_M: f64 = 0.1;
/// A strip that is nowhere wider is none, m: it holds no centre of a cell.
const NARROWEST_M: f64 = 0.15;
/// Widths are medians over so many stations to both sides: cells leave steps where a road runs at a slant.
const AROUND: usize = 3;

/// What a strip of a road is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Strip {
    /// A lane of this chain; true if it is driven along the road.
    Lane { chain: usize, along: bool },
    /// Paved ground between lanes.
    Between,
    /// Paved ground beside the lanes.
    Shoulder,
    /// Car park.
    Parking,
    /// Neither paved nor walked on.
    Verge,
    /// Walkway.
    Walkway,
}

/// Borders of strips at stations along a road.
#[derive(Clone, Debug)]
pub(super) struct Strips {
    /// From left to right.
    pub kinds: Vec<Strip>,
    /// One more than there are strips, each with a value per station: how far left, m; never growing to the right.
    pub borders_m: Vec<Vec<f64>>,
    /// The border at which lanes to the left end and those to the right begin.
    pub center: usize,
}

/// Where one station looks from.
pub(super) struct Station {
    pub at_m: DVec2,
    /// Unit vector to the left.
    pub left: DVec2,
}

impl Strips {
    /// Adds what lies to both sides. `is_own` tells of a place whether it belongs to this road and to no other.
    pub fn with_sides(mut self, layout: &BevLayout, stations: &[Station], is_own: impl Fn(DVec2) -> bool) -> Self {
        let left = sides(layout, stations, &self.borders_m[0], 1.0, &is_own);
        let right = sides(layout, stations, &self.borders_m[self.kinds.len()], -1.0, &is_own);
        for (kind, edge) in left {
            self.kinds.insert(0, kind);
            self.borders_m.insert(0, edge);
            self.center += 1;
        }
        for (kind, edge) in right {
            self.kinds.push(kind);
            self.borders_m.push(edge);
        }
        self
    }

    /// The same seen from a place `by_m` (per station) to the left of where it was.
    pub fn seen_from(&mut self, by_m: impl Fn(usize) -> f64) {
        for border in &mut self.borders_m {
            border.iter_mut().enumerate().for_each(|(i, t)| *t -= by_m(i));
        }
    }
}

/// How far the ground of each kind reaches from the edge of the lanes at one station, m.
#[derive(Clone, Copy)]
struct Reach {
    paved_m: f64,
    carpark_m: f64,
    walkway_m: [f64; 2], // from, to
}

/// Strips to one side (1: left) with their outer borders, from the lanes outward.
fn sides(
    layout: &BevLayout,
    stations: &[Station],
    edge_m: &[f64],
    side: f64,
    is_own: &impl Fn(DVec2) -> bool,
) -> Vec<(Strip, Vec<f64>)> {
    let looks: Vec<Option<Reach>> = stations
        .iter()
        .zip(edge_m)
        .map(|(s, edge)| look(layout, s.at_m + s.left * *edge, s.left * side, is_own))
        .collect();
    let known = known(&looks);
    let of = |value: fn(&Reach) -> f64| median(&known.iter().map(value).collect::<Vec<_>>());
    let paved = of(|r| r.paved_m);
    let carpark: Vec<f64> = of(|r| r.carpark_m).iter().zip(&paved).map(|(c, p)| c.max(*p)).collect();
    let from: Vec<f64> = of(|r| r.walkway_m[0]).iter().zip(&carpark).map(|(w, c)| w.max(*c)).collect();
    let to: Vec<f64> = of(|r| r.walkway_m[1]).iter().zip(&from).map(|(t, f)| t.max(*f)).collect();
    let mut out: Vec<(Strip, Vec<f64>)> = Vec::new();
    let mut inner = vec![0.0; stations.len()];
    for (kind, outer) in [
        (Strip::Shoulder, paved),
        (Strip::Parking, carpark),
        (Strip::Verge, from),
        (Strip::Walkway, to),
    ] {
        let wide = outer.iter().zip(&inner).any(|(o, i)| o - i > NARROWEST_M);
        if wide {
            out.push((kind, outer.clone()));
            inner = outer;
        } else if kind != Strip::Walkway {
            // Nothing there: what follows begins where this began.
            continue;
        }
    }
    if out.last().is_some_and(|(kind, _)| *kind == Strip::Verge) {
        out.pop();
    }
    for (_, outer) in &mut out {
        for (value, edge) in outer.iter_mut().zip(edge_m) {
            *value = edge + side * *value;
        }
    }
    out
}

/// Looks outward from the edge of the lanes; `None` where the edge itself is beyond the map.
fn look(layout: &BevLayout, edge: DVec2, out: DVec2, is_own: &impl Fn(DVec2) -> bool) -> Option<Reach> {
    let extent = layout.extent();
    let at = |m: f64| {
        let p = edge + out * m;
        match surface(layout, extent, p) {
            Surface::Beyond => Surface::Beyond,
            found if is_own(p) => found,
            _ => Surface::Beyond,
        }
    };
    if surface(layout, extent, edge) == Surface::Beyond {
        return None;
    }
    // The far end of the run of one surface that begins at `from`.
    let run = |of: Surface, from: f64, most: f64| {
        let mut m = from;
        while m < from + most && at(m + LOOK_M / 2.0) == of {
            m += LOOK_M;
        }
        m
    };
    let paved_m = run(Surface::Road, 0.0, PAVED_M);
    let carpark_m = run(Surface::Carpark, paved_m, CARPARK_M);
    let mut from = carpark_m;
    let capped = paved_m >= PAVED_M || carpark_m - paved_m >= CARPARK_M;
    while !capped && from < carpark_m + VERGE_M && at(from + LOOK_M / 2.0) == Surface::Other {
        from += LOOK_M;
    }
    let to = if capped { from } else { run(Surface::Walkway, from, WALKWAY_M) };
    let walkway_m = if to > from { [from, to] } else { [carpark_m; 2] };
    Some(Reach {
        paved_m,
        carpark_m,
        walkway_m,
    })
}

/// Stations beyond the map take over what the nearest one on it has.
fn known(looks: &[Option<Reach>]) -> Vec<Reach> {
    const NOTHING: Reach = Reach {
        paved_m: 0.0,
        carpark_m: 0.0,
        walkway_m: [0.0; 2],
    };
    let mut last = looks.iter().flatten().next().copied().unwrap_or(NOTHING);
    looks
        .iter()
        .map(|look| {
            last = look.unwrap_or(last);
            last
        })
        .collect()
}

/// Running median, shorter at the ends.
pub(super) fn median(values: &[f64]) -> Vec<f64> {
    let n = values.len();
    (0..n)
        .map(|i| {
            let reach = AROUND.min(i).min(n - 1 - i);
            let mut around = values[i - reach..=i + reach].to_vec();
            around.sort_by(f64::total_cmp);
            around[reach]
        })
        .collect()
}
