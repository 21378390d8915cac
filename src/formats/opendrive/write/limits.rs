//! Speed limits of written roads.

use std::collections::BTreeMap;
use std::fmt::Write as _;

use glam::DVec2;

use super::roads::WrittenRoad;
use super::strips::Strip;
use crate::xml_text::number;
use scene::speed_limits::SpeedLimits;
use scene::{BevLayout, RoadId, RoadNetwork};

/// A road that is written so near to one of the network is that one, m.
const NETWORK_REACH_M: f64 = 1.0;
/// A limit holds for a lane whose middle is so near to its line, m.
const LANE_REACH_M: f64 = 1.2;
/// A shorter stretch of a limit is as the one before, m.
const SHORTEST_M: f64 = 3.0;
/// A limit of this unit that is so near to a whole number is that number.
const WHOLE: f64 = 0.01;

/// Where limits come from: roads that a user has reshaped go before lines of the layout.
pub(super) struct SpeedLimitSource<'a> {
    roads: &'a RoadNetwork,
    middles: BTreeMap<RoadId, Vec<DVec2>>,
    along_lanes: SpeedLimits,
}

impl<'a> SpeedLimitSource<'a> {
    pub fn from_layout(layout: &BevLayout, roads: &'a RoadNetwork) -> Self {
        Self {
            roads,
            middles: roads.lines(),
            along_lanes: SpeedLimits::from_layout(layout),
        }
    }

    /// The `<type>` elements of a road, each with its limit; none if no limit is known.
    pub fn write(&self, out: &mut String, road: &WrittenRoad) {
        let runs = self.runs(road);
        if runs.iter().all(|(_, limit)| limit.is_none()) {
            return;
        }
        for (s_m, limit) in runs {
            let _ = writeln!(out, "    <type s=\"{}\" type=\"unknown\">", number(s_m));
            if let Some(mps) = limit {
                let (max, unit) = in_words(mps);
                let _ = writeln!(out, "      <speed max=\"{max}\" unit=\"{unit}\"/>");
            }
            out.push_str("    </type>\n");
        }
    }

    /// Limits in m/s and where each begins, m along the road; at least one.
    fn runs(&self, road: &WrittenRoad) -> Vec<(f64, Option<f64>)> {
        let middle = road.reference.at(road.reference.end_s_m() / 2.0);
        let found = self
            .roads
            .road_among(&self.middles, middle.position_m, NETWORK_REACH_M);
        if let Some(kph) = found.and_then(|id| self.roads.road(id)?.limit_kph) {
            return vec![(0.0, Some(kph / 3.6))];
        }
        let end_m = road.reference.end_s_m();
        let mut runs: Vec<(f64, Option<f64>)> = Vec::new();
        for (i, s_m) in road.s_m.iter().enumerate() {
            let limit = self.of_lanes(road, i);
            if runs.last().is_none_or(|(_, last)| *last != limit) {
                runs.push((*s_m, limit));
            }
        }
        let mut out: Vec<(f64, Option<f64>)> = Vec::new();
        for (i, (s_m, limit)) in runs.iter().enumerate() {
            let until = runs.get(i + 1).map_or(end_m, |next| next.0);
            match out.last() {
                Some((_, last)) if until - s_m < SHORTEST_M || last == limit => {}
                None if until - s_m < SHORTEST_M && runs.len() > 1 => {}
                None => out.push((0.0, *limit)),
                Some(_) => out.push((*s_m, *limit)),
            }
        }
        if out.is_empty() {
            out.push((0.0, runs.last().and_then(|run| run.1)));
        }
        out
    }

    /// The limit of most of a road's lanes at a station, m/s; the lower one of two that as many have.
    fn of_lanes(&self, road: &WrittenRoad, station: usize) -> Option<f64> {
        let base = road.reference.at(road.s_m[station]);
        let borders = &road.strips.borders_m;
        let mut votes: BTreeMap<u64, usize> = BTreeMap::new(); // by bits: limits are positive
        for (strip, kind) in road.strips.kinds.iter().enumerate() {
            if matches!(kind, Strip::Lane { .. }) {
                let middle_m = 0.5 * (borders[strip][station] + borders[strip + 1][station]);
                let limit = self.along_lanes.at_mps(base.offset(middle_m), LANE_REACH_M);
                if let Some(mps) = limit {
                    *votes.entry(mps.to_bits()).or_default() += 1;
                }
            }
        }
        let most = votes
            .iter()
            .max_by_key(|(bits, n)| (**n, std::cmp::Reverse(**bits)));
        most.map(|(bits, _)| f64::from_bits(*bits))
    }
}

/// A limit in the unit in which it is a whole number, first km/h, then mph; else in m/s.
fn in_words(mps: f64) -> (String, &'static str) {
    for (unit, per_mps) in [("km/h", 3.6), ("mph", 1.0 / 0.447_04)] {
        let value = mps * per_mps;
        if (value - value.round()).abs() < WHOLE && value.round() >= 1.0 {
            return (number(value.round()), unit);
        }
    }
    (number(mps), "m/s")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn limits_are_whole_numbers_of_their_unit() {
        let of = |mm_per_s: u32| in_words(f64::from(mm_per_s) / 1000.0);
        assert_eq!(of(13_889), ("50".into(), "km/h"));
        assert_eq!(of(11_176), ("25".into(), "mph"));
        assert_eq!(of(24_587), ("55".into(), "mph"));
        assert_eq!(of(10_000), ("36".into(), "km/h"));
        assert_eq!(of(9_100), ("9.1".into(), "m/s"));
    }
}
