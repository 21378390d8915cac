//! Numbers along a road as records: widths and offsets as straight pieces, heights as cubics.

use super::roads::WrittenRoad;
use super::strips::Strip;
use scene::Relief;

/// One record: where it begins and a, b, c, d from there on.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct CubicRecord {
    pub s_m: f64,
    pub k: [f64; 4],
}

/// Pieces whose slopes differ by less are one.
const SAME_SLOPE: f64 = 2e-6;
/// Heights are kept to this, m.
const HEIGHT_M: f64 = 0.01;
/// Tilts are kept to this, and smaller ones are dropped, rad.
const TILT_RAD: f64 = 0.003;

/// Straight pieces through as few of the values as stay within `near` of all.
pub(super) fn straight(s_m: &[f64], values: &[f64], near: f64) -> Vec<CubicRecord> {
    let mut kept = vec![0];
    let mut stack = vec![(0, values.len() - 1)];
    while let Some((from, to)) = stack.pop() {
        let slope = (values[to] - values[from]) / (s_m[to] - s_m[from]);
        let off = |i: &usize| (values[from] + slope * (s_m[*i] - s_m[from]) - values[*i]).abs();
        let farthest = (from + 1..to).max_by(|a, b| off(a).total_cmp(&off(b)));
        match farthest.filter(|i| off(i) > near) {
            Some(i) => stack.extend([(i, to), (from, i)]),
            None => kept.push(to),
        }
    }
    let pieces = kept.windows(2).map(|ends| {
        let [from, to] = [ends[0], ends[1]];
        let slope = (values[to] - values[from]) / (s_m[to] - s_m[from]);
        CubicRecord {
            s_m: s_m[from],
            k: [values[from], slope, 0.0, 0.0],
        }
    });
    let mut out: Vec<CubicRecord> = Vec::new();
    for piece in pieces {
        // One that goes on as the last one does is no other.
        let same = |last: &CubicRecord| (last.k[1] - piece.k[1]).abs() < SAME_SLOPE;
        if !out.last().is_some_and(same) {
            out.push(piece);
        }
    }
    out
}

/// Heights of the ground under the reference line of a road; none if all of it is at 0.
pub(super) fn elevation(road: &WrittenRoad, relief: &Relief) -> Vec<CubicRecord> {
    if relief.is_flat() {
        return Vec::new();
    }
    let z: Vec<f64> = road
        .s_m
        .iter()
        .map(|s| relief.height_m(road.reference.at(*s).position_m))
        .collect();
    let last = z.len() - 1;
    let slope = |i: usize| {
        let (a, b) = (i.saturating_sub(2), (i + 2).min(last));
        (z[b] - z[a]) / (road.s_m[b] - road.s_m[a])
    };
    let mut out = Vec::new();
    let mut stack = vec![(0, last)];
    while let Some((from, to)) = stack.pop() {
        let run = road.s_m[to] - road.s_m[from];
        let (rise, a, b) = (z[to] - z[from], slope(from), slope(to));
        let k = [
            z[from],
            a,
            (3.0 * rise / run - 2.0 * a - b) / run,
            (a + b - 2.0 * rise / run) / (run * run),
        ];
        let at = |i: usize| {
            let ds = road.s_m[i] - road.s_m[from];
            k[0] + ds * (k[1] + ds * (k[2] + ds * k[3]))
        };
        if to - from > 1 && (from + 1..to).any(|i| (at(i) - z[i]).abs() > HEIGHT_M) {
            let middle = usize::midpoint(from, to);
            stack.extend([(middle, to), (from, middle)]);
        } else {
            out.push(CubicRecord {
                s_m: road.s_m[from],
                k,
            });
        }
    }
    out
}

/// Tilt of the ground across the lanes of a road; none if it is tilted nowhere.
pub(super) fn superelevation(road: &WrittenRoad, relief: &Relief) -> Vec<CubicRecord> {
    if relief.is_flat() {
        return Vec::new();
    }
    let is_lane = |k: &Strip| matches!(k, Strip::Lane { .. });
    let first = road.strips.kinds.iter().position(is_lane).unwrap_or(0);
    let last = road.strips.kinds.iter().rposition(is_lane).unwrap_or(0) + 1;
    let tilts: Vec<f64> = (0..road.s_m.len())
        .map(|i| {
            let base = road.reference.at(road.s_m[i]);
            let [left, right] = [first, last].map(|b| road.strips.borders_m[b][i]);
            let [high, low] = [left, right].map(|t| relief.height_m(base.offset(t)));
            ((high - low) / (left - right).max(1.0)).atan()
        })
        .collect();
    match tilts.iter().all(|t| t.abs() < TILT_RAD) {
        true => Vec::new(),
        false => straight(&road.s_m, &tilts, TILT_RAD),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn few_pieces_stay_near_all_values() {
        let s: Vec<f64> = (0..100).map(f64::from).collect();
        let v: Vec<f64> = s
            .iter()
            .map(|s| if *s < 40.0 { 3.0 } else { 3.0 + 0.1 * (s - 40.0) })
            .collect();
        let pieces = straight(&s, &v, 0.01);
        assert_eq!(pieces.len(), 2, "{pieces:?}");
        assert_eq!(pieces[1].s_m, 40.0);
        assert!((pieces[1].k[1] - 0.1).abs() < 1e-9);
        assert_eq!(straight(&[0.0, 2.0], &[1.0, 1.0], 0.1).len(), 1);
    }
}
