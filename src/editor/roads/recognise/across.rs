//! Cross-section of a road: its lanes, read at many places along it.

use glam::DVec2;

use scene::roads::{LaneKind, RoadLane, curve};
use scene::{BevLayer, BevLayout, PolylineKind};

/// Spacing of the stations along a road, m.
const STATION_M: f64 = 2.0;
/// Spacing of the samples across it, m.
const STEP_M: f64 = 0.2;
/// Reach to either side, m.
const REACH_M: f64 = 32.0;
/// Approximate width of a lane that no lines show, m.
const LANE_M: f64 = 3.4;
/// A paved strip beyond lanes of their own width that is wider than this is a shoulder, m.
const SHOULDER_M: f64 = 1.0;

/// Lanes of a road whose middle is known.
#[derive(Debug)]
pub(super) struct Across {
    /// Offset of the reference line to the left of the middle, m.
    pub left_m: f64,
    /// Lanes left of it.
    pub left: Vec<RoadLane>,
    /// Lanes right of it.
    pub right: Vec<RoadLane>,
    /// True if all lanes are driven against the middle line: the road is to be turned around.
    pub against: bool,
}

/// Cross-section at one place, as distances to the left of the middle, m.
struct RoadCrossSection {
    paved: [f64; 2],         // right and left kerb
    park: [f64; 2],          // width of parking behind them
    walk: [f64; 2],          // width of walkway behind that
    lanes: Vec<(f64, bool)>, // middle, and true if driven along
    divide: Option<f64>,
}

/// Reads the lanes of a road along its middle line; `None` where nothing is paved.
pub(super) fn read(layout: &BevLayout, middle_m: &[DVec2]) -> Option<Across> {
    let length_m = curve::length_m(middle_m);
    let count = (length_m / STATION_M).floor().clamp(1.0, 400.0) as usize;
    let at = |k: usize| curve::at(middle_m, length_m * (k as f64 + 0.5) / count as f64);
    let near = near_lines(layout, middle_m);
    let sections: Vec<RoadCrossSection> = (0..count).filter_map(|k| section(layout, &near, at(k))).collect();
    if sections.is_empty() {
        return None;
    }
    let of = |value: &dyn Fn(&RoadCrossSection) -> f64| median(sections.iter().map(value).collect());
    let kerbs = [0, 1].map(|side| of(&|s| s.paved[side]));
    let outside = [0, 1].map(|side| [of(&|s| s.park[side]), of(&|s| s.walk[side])]);
    let (along, against) = (lanes_of(&sections, true), lanes_of(&sections, false));
    let turned = along.is_empty() && !against.is_empty();
    let divides: Vec<f64> = sections.iter().filter_map(|s| s.divide).collect();
    let divide = (2 * divides.len() > sections.len()).then(|| median(divides));
    let counts = match (along.len(), against.len()) {
        (0, 0) => guess(kerbs[1] - kerbs[0], divide.is_some()),
        counts => counts.into(),
    };
    let reference = match (counts, along.last(), against.first()) {
        ([_, 0], ..) => kerbs[1],
        ([0, _], ..) => kerbs[0],
        (_, Some(a), Some(b)) => divide.filter(|d| (*a..*b).contains(d)).unwrap_or((a + b) / 2.0),
        ([a, b], ..) => divide.unwrap_or(kerbs[0] + (kerbs[1] - kerbs[0]) * a as f64 / (a + b) as f64),
    };
    let spacing = spacing(&along).or(spacing(&against));
    let side = |count: usize, kerb_m: f64, [park, walk]: [f64; 2]| {
        let mut lanes = Vec::new();
        if count > 0 {
            let each = kerb_m / count as f64;
            let width = spacing
                .filter(|s| kerb_m - s * count as f64 > SHOULDER_M)
                .unwrap_or(each);
            lanes.extend((0..count).map(|_| lane(LaneKind::Drive, width)));
            if kerb_m - width * count as f64 > SHOULDER_M / 2.0 {
                lanes.push(lane(LaneKind::Shoulder, kerb_m - width * count as f64));
            }
        }
        if park > 1.0 {
            lanes.push(lane(LaneKind::Parking, park));
        }
        if walk > 0.6 {
            lanes.push(lane(LaneKind::Walk, walk));
        }
        lanes
    };
    Some(Across {
        left_m: reference,
        right: side(counts[0], reference - kerbs[0], outside[0]),
        left: side(counts[1], kerbs[1] - reference, outside[1]),
        against: turned,
    })
}

fn lane(kind: LaneKind, width_m: f64) -> RoadLane {
    let (low, high) = (*scene::Road::LANE_M.start(), *scene::Road::LANE_M.end());
    // A tenth of a metre is finer than the painted cells.
    let width_m = ((width_m * 10.0).round() / 10.0).clamp(low, high);
    RoadLane { kind, width_m }
}

/// Lanes along and against a road of that width without lane lines.
fn guess(width_m: f64, divided: bool) -> [usize; 2] {
    let count = ((width_m / LANE_M).round() as usize).clamp(1, 2 * scene::Road::MAX_LANES - 4);
    match count {
        1 if divided || width_m >= 4.6 => [1, 1],
        1 => [1, 0],
        n => [n.div_ceil(2), n / 2],
    }
}

/// A piece of a lane middle (true) or of a road divider.
type Piece = (bool, [DVec2; 2]);

/// Pieces of lines that may pass through sections of a road.
fn near_lines(layout: &BevLayout, middle_m: &[DVec2]) -> Vec<Piece> {
    let low = middle_m.iter().copied().reduce(DVec2::min).unwrap_or_default() - REACH_M;
    let high = middle_m.iter().copied().reduce(DVec2::max).unwrap_or_default() + REACH_M;
    let lines = layout.polylines.iter().filter_map(|line| match line.kind {
        PolylineKind::LaneCenter => Some((true, line)),
        PolylineKind::RoadDivider => Some((false, line)),
        _ => None,
    });
    let pieces = lines.flat_map(|(lane, line)| line.points_m.array_windows::<2>().map(move |p| (lane, *p)));
    pieces
        .filter(|(_, [a, b])| a.max(*b).cmpge(low).all() && a.min(*b).cmple(high).all())
        .collect()
}

fn section(layout: &BevLayout, near: &[Piece], (at, way): (DVec2, DVec2)) -> Option<RoadCrossSection> {
    let extent = layout.extent();
    let left = way.perp();
    let has = |off: f64, layer: BevLayer| {
        let p = at + left * off;
        extent.column_at(p.x, p.y).map(|[x, y]| layout.has(layer, x, y))
    };
    if has(0.0, BevLayer::DrivableArea) != Some(true) {
        return None;
    }
    // From the middle outward on one side; what leaves the map says nothing.
    let side = |sign: f64| {
        let run = |from: f64, layer: BevLayer| {
            let mut off = from;
            while off < REACH_M {
                match has(sign * off, layer) {
                    None => return None,
                    Some(true) => off += STEP_M,
                    Some(false) => break,
                }
            }
            Some(off)
        };
        let kerb = run(0.0, BevLayer::DrivableArea)?;
        let park = run(kerb, BevLayer::CarparkArea)?;
        let walk = run(park, BevLayer::Walkway)?;
        // A car park is no parking strip.
        let strip = if park - kerb > 4.0 { 0.0 } else { park - kerb };
        let walk = if strip == 0.0 && park > kerb {
            0.0
        } else {
            walk - park
        };
        (kerb < REACH_M).then_some([kerb - STEP_M / 2.0, strip, walk.min(8.0)])
    };
    let (right, left_side) = (side(-1.0)?, side(1.0)?);
    let kerbs = [-right[0], left_side[0]];
    let (mut lanes, mut divide) = (Vec::new(), None);
    for (is_lane, [a, b]) in near {
        let (da, db) = ((*a - at).dot(way), (*b - at).dot(way));
        if (da <= 0.0) == (db <= 0.0) {
            continue;
        }
        let p = a.lerp(*b, da / (da - db));
        let (off, heading) = ((p - at).dot(left), (*b - *a).normalize_or_zero().dot(way));
        if off < kerbs[0] || off > kerbs[1] || heading.abs() < 0.8 {
            continue;
        }
        match is_lane {
            true => lanes.push((off, heading > 0.0)),
            false => divide = Some(off),
        }
    }
    lanes.sort_by(|a, b| a.0.total_cmp(&b.0));
    Some(RoadCrossSection {
        paved: kerbs,
        park: [right[1], left_side[1]],
        walk: [right[2], left_side[2]],
        lanes,
        divide,
    })
}

/// Middles of the lanes of one direction, from right to left, as most places show them.
fn lanes_of(sections: &[RoadCrossSection], along: bool) -> Vec<f64> {
    let of = |s: &RoadCrossSection| {
        s.lanes
            .iter()
            .filter(|l| l.1 == along)
            .map(|l| l.0)
            .collect::<Vec<f64>>()
    };
    let counts: Vec<f64> = sections.iter().map(|s| of(s).len() as f64).collect();
    let count = median(counts) as usize;
    let same: Vec<Vec<f64>> = sections.iter().map(of).filter(|l| l.len() == count).collect();
    (0..count.min(scene::Road::MAX_LANES - 3))
        .map(|i| median(same.iter().map(|l| l[i]).collect()))
        .collect()
}

fn spacing(lanes: &[f64]) -> Option<f64> {
    let gaps: Vec<f64> = lanes.array_windows::<2>().map(|[a, b]| b - a).collect();
    (!gaps.is_empty()).then(|| median(gaps))
}

/// The middle value, one that there is and not a mean of two (half of a road may have a parking strip); 0 of none.
fn median(values: Vec<f64>) -> f64 {
    match values.is_empty() {
        true => 0.0,
        false => numeric::quantile::quantile(&values, 0.5),
    }
}
