//! Strips across a road: lanes, and to both sides of them paved ground, car parks and walkways as far as the cells of
//! the layout say.

use glam::DVec2;

use super::chains::{GroundKind, surface};
use scene::BevLayout;

/// Paved ground belongs to a road up to this far from its lanes, m; less to one that leads through a junction, as it turns.
pub(super) const PAVED_M: f64 = 10.0;
pub(super) const PAVED_IN_JUNCTION_M: f64 = 6.0;
/// A car park belongs to it up to this far beyond that, m.
const CARPARK_M: f64 = 8.0;
/// A walkway begins at most this far from the paved ground, m.
const VERGE_M: f64 = 3.0;
/// Widest walkway, m.
const WALKWAY_M: f64 = 8.0;
/// Distance between two looks at the ground, m.
const LOOK_M: f64 = 0.1;
/// A strip that is nowhere wider than this is dropped, m: it holds no centre of a cell.
const NARROWEST_M: f64 = 0.15;
/// A middle that is nowhere farther from the reference line than this is moved onto it, m.
const NEARLY_M: f64 = 0.03;
/// Widths are medians over so many stations to both sides: cells leave steps where a road runs at a slant.
const AROUND: usize = 3;

/// Kind of a strip of a road.
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
    /// The border between the lanes to the left and those to the right.
    pub center: usize,
}

/// Where one station looks from.
pub(super) struct Station {
    pub at_m: DVec2,
    /// Unit vector to the left.
    pub left: DVec2,
}

impl Strips {
    /// Adds the ground to both sides, with paved ground up to `most_m` wide. `is_own` says whether a place belongs to
    /// this road and to no other.
    pub fn with_sides(
        mut self,
        layout: &BevLayout,
        stations: &[Station],
        most_m: f64,
        is_own: impl Fn(DVec2) -> bool,
    ) -> Self {
        let around = RoadsideProbe {
            layout,
            most_m,
            is_own: &is_own,
        };
        let left = around.sides(stations, &self.borders_m[0], 1.0);
        let right = around.sides(stations, &self.borders_m[self.kinds.len()], -1.0);
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

    /// Puts the line between left and right lanes onto the reference line if it is hardly off it.
    pub fn straighten(&mut self) {
        let center = self.borders_m[self.center].clone();
        if center.iter().all(|t| t.abs() < NEARLY_M) {
            self.seen_from(|i| center[i]);
        }
    }

    /// Measures the borders from a place `by_m` (per station) to the left of where they were measured from.
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
    beyond_m: f64,       // paved ground behind a car park
    walkway_m: [f64; 2], // from, to
}

/// Surroundings of the lanes, as far as they are looked at.
struct RoadsideProbe<'a> {
    layout: &'a BevLayout,
    most_m: f64,
    is_own: &'a dyn Fn(DVec2) -> bool,
}

impl RoadsideProbe<'_> {
    /// Strips to one side (1: left) with their outer borders, from the lanes outward.
    fn sides(&self, stations: &[Station], edge_m: &[f64], side: f64) -> Vec<(Strip, Vec<f64>)> {
        let looks: Vec<Option<Reach>> = stations
            .iter()
            .zip(edge_m)
            .map(|(s, edge)| self.look(s.at_m + s.left * *edge, s.left * side))
            .collect();
        let known = known(&looks);
        let of = |value: fn(&Reach) -> f64| median(&known.iter().map(value).collect::<Vec<_>>());
        let paved = of(|r| r.paved_m);
        let carpark: Vec<f64> = of(|r| r.carpark_m)
            .iter()
            .zip(&paved)
            .map(|(c, p)| c.max(*p))
            .collect();
        let beyond: Vec<f64> = of(|r| r.beyond_m)
            .iter()
            .zip(&carpark)
            .map(|(b, c)| b.max(*c))
            .collect();
        let from: Vec<f64> = of(|r| r.walkway_m[0])
            .iter()
            .zip(&beyond)
            .map(|(w, b)| w.max(*b))
            .collect();
        let to: Vec<f64> = of(|r| r.walkway_m[1])
            .iter()
            .zip(&from)
            .map(|(t, f)| t.max(*f))
            .collect();
        let mut out: Vec<(Strip, Vec<f64>)> = Vec::new();
        let mut inner = vec![0.0; stations.len()];
        for (kind, outer) in [
            (Strip::Shoulder, paved),
            (Strip::Parking, carpark),
            (Strip::Shoulder, beyond),
            (Strip::Verge, from),
            (Strip::Walkway, to),
        ] {
            let wide = outer.iter().zip(&inner).any(|(o, i)| o - i > NARROWEST_M);
            // A strip that is too narrow is dropped, so the next one begins where it began.
            if wide {
                out.push((kind, outer.clone()));
                inner = outer;
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
    fn look(&self, edge: DVec2, out: DVec2) -> Option<Reach> {
        let (layout, extent, most_m) = (self.layout, self.layout.extent(), self.most_m);
        let at = |m: f64| {
            let p = edge + out * m;
            match surface(layout, extent, p) {
                GroundKind::Beyond => GroundKind::Beyond,
                found if (self.is_own)(p) => found,
                _ => GroundKind::Beyond,
            }
        };
        if surface(layout, extent, edge) == GroundKind::Beyond {
            return None;
        }
        // The far end of the run of one surface that begins at `from`.
        let run = |of: GroundKind, from: f64, most: f64| {
            let mut m = from;
            while m < from + most && at(m + LOOK_M / 2.0) == of {
                m += LOOK_M;
            }
            m
        };
        let paved_m = run(GroundKind::Road, 0.0, most_m);
        let carpark_m = run(GroundKind::Carpark, paved_m, CARPARK_M);
        let beyond_m = match carpark_m > paved_m {
            true => run(GroundKind::Road, carpark_m, most_m),
            false => carpark_m,
        };
        let mut from = beyond_m;
        let capped = paved_m >= most_m || carpark_m - paved_m >= CARPARK_M;
        while !capped && from < beyond_m + VERGE_M && at(from + LOOK_M / 2.0) == GroundKind::Other {
            from += LOOK_M;
        }
        let to = if capped {
            from
        } else {
            run(GroundKind::Walkway, from, WALKWAY_M)
        };
        let walkway_m = if to > from { [from, to] } else { [beyond_m; 2] };
        Some(Reach {
            paved_m,
            carpark_m,
            beyond_m,
            walkway_m,
        })
    }
}

/// Stations beyond the map take the values of the nearest station on it.
fn known(looks: &[Option<Reach>]) -> Vec<Reach> {
    const NOTHING: Reach = Reach {
        paved_m: 0.0,
        carpark_m: 0.0,
        beyond_m: 0.0,
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
