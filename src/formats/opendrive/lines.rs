//! Lane centres and dividers of a road, followed from step to step, cut to the window and thinned.

use glam::DVec2;

use super::lanes::{LaneGround, LaneKind, LaneSection, Travel};
use super::sampling::LaneEdges;
use scene::PolylineKind;
use scene::roads::curve;

/// Narrowest lane that takes part in dividers, m.
const NARROWEST_M: f64 = 0.4;
/// Narrowest lane whose middle can be driven, m.
const DRIVABLE_M: f64 = 1.5;
/// Two lanes farther apart than this have two lines between them, not one, m.
const APART_M: f64 = 0.6;
/// Ways along a road that differ by less are one place, m.
const SAME_PLACE_M: f64 = 1e-6;
/// Largest jump from one section to the next within one line, m.
const JUMP_M: f64 = 0.3;
/// A dropped vertex lies within this of the line that is kept, m.
const THIN_M: f64 = 0.02;
/// A shorter piece of line is noise, m.
const SHORTEST_M: f64 = 0.5;

/// A line that runs midway between two lane edges.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct MidwayLine {
    pub kind: PolylineKind,
    edges: [usize; 2],
    against_line: bool,
}

/// Facts about lines that hold over a whole section.
pub(super) struct SectionLines<'a> {
    pub section: &'a LaneSection,
    pub grounds: &'a [LaneGround],
    /// Connecting roads have lane centres but no dividers.
    pub in_junction: bool,
    /// False for a file without any road mark: an edge without a mark is a line then.
    pub marks_known: bool,
    /// The speed limit at an s in m, mm/s.
    pub limit_at: &'a dyn Fn(f64) -> Option<u32>,
}

impl SectionLines<'_> {
    /// The lines between two rows: a centre for each traffic lane, one or two dividers between
    /// neighbours that carry traffic.
    pub fn tracks(&self, from: &LaneEdges, to: &LaneEdges) -> Vec<MidwayLine> {
        let width = |i: usize| 0.5 * (from.width(i) + to.width(i));
        let middle_s = 0.5 * (from.s_m + to.s_m);
        let mut tracks = Vec::new();
        let mut add = |kind, edges, against_line| {
            tracks.push(MidwayLine {
                kind,
                edges,
                against_line,
            });
        };
        let mut before: Option<(usize, Travel)> = None;
        for (i, lane) in self.section.lanes_left_to_right().enumerate() {
            let traffic = lane.kind.carries_traffic();
            if traffic && width(i) >= DRIVABLE_M {
                add(
                    PolylineKind::LaneCenter,
                    [i, i + 1],
                    lane.travel == Travel::Backward,
                );
                if let Some(mm_per_s) = (self.limit_at)(middle_s) {
                    add(
                        PolylineKind::SpeedLimit { mm_per_s },
                        [i, i + 1],
                        lane.travel == Travel::Backward,
                    );
                }
            }
            let cycles = lane.kind == LaneKind::Biking && self.grounds[i] == LaneGround::Road;
            if !(traffic || cycles) || width(i) < NARROWEST_M {
                continue;
            }
            if let Some((left, travel)) = before.replace((i, lane.travel))
                && !self.in_junction
            {
                let (a, b) = (left + 1, i);
                let apart = 0.5 * (from.t_m[a] - from.t_m[b] + to.t_m[a] - to.t_m[b]) > APART_M;
                let painted = |mut edges: std::ops::RangeInclusive<usize>| {
                    edges.any(|e| self.section.painted(e, middle_s).unwrap_or(!self.marks_known))
                };
                match (travel == lane.travel, apart) {
                    (false, false) => add(PolylineKind::RoadDivider, [a, b], false),
                    (false, true) => {
                        for edge in self.median_edges(a, b) {
                            add(PolylineKind::RoadDivider, [edge, edge], false);
                        }
                    }
                    (true, false) if painted(a..=b) => add(PolylineKind::LaneDivider, [a, b], false),
                    (true, false) => {}
                    (true, true) => {
                        for edge in [a, b].into_iter().filter(|e| painted(*e..=*e)) {
                            add(PolylineKind::LaneDivider, [edge, edge], false);
                        }
                    }
                }
            }
        }
        tracks
    }

    /// The edges of the unpaved lanes between two lane edges with opposite traffic; the two edges themselves if all is
    /// paved.
    fn median_edges(&self, left: usize, right: usize) -> [usize; 2] {
        let mut unpaved =
            (left..right).filter(|i| matches!(self.grounds[*i], LaneGround::Other | LaneGround::Walkway));
        match unpaved.next() {
            Some(first) => [first, unpaved.next_back().unwrap_or(first) + 1],
            None => [left, right],
        }
    }
}

/// The lines of one road while it is walked, in the file's frame.
#[derive(Default)]
pub(super) struct Follower {
    open: Vec<(MidwayLine, Vec<DVec2>)>,
    end_s_m: f64,
    done: Vec<(PolylineKind, Vec<DVec2>)>,
}

impl Follower {
    /// Goes one step along the road. `budget` pays for finding out which line continues which.
    pub fn step(&mut self, tracks: &[MidwayLine], from: &LaneEdges, to: &LaneEdges, budget: &mut usize) {
        let ends = |t: &MidwayLine| [from, to].map(|row| row.between(t.edges[0], t.edges[1]));
        // Records of different kinds may begin at places that differ by rounding.
        let goes_on = (self.end_s_m - from.s_m).abs() < SAME_PLACE_M;
        let same = goes_on
            && self.open.len() == tracks.len()
            && self.open.iter().zip(tracks).all(|((old, points), new)| {
                old == new && points.last().is_some_and(|p| p.distance(ends(new)[0]) < JUMP_M)
            });
        if same {
            for ((track, points), _) in self.open.iter_mut().zip(tracks) {
                points.push(ends(track)[1]);
            }
        } else {
            *budget = budget.saturating_sub(self.open.len() * tracks.len());
            let mut old = std::mem::take(&mut self.open);
            for track in tracks {
                let [start, end] = ends(track);
                let nearest = old
                    .iter()
                    .enumerate()
                    .filter(|(_, (o, _))| {
                        goes_on && o.kind == track.kind && o.against_line == track.against_line
                    })
                    .filter_map(|(i, (_, points))| points.last().map(|p| (p.distance(start), i)))
                    .filter(|(distance, _)| *distance < JUMP_M)
                    .min_by(|a, b| a.0.total_cmp(&b.0));
                let mut points = match nearest {
                    Some((_, i)) => old.swap_remove(i).1,
                    None => vec![start],
                };
                points.push(end);
                self.open.push((*track, points));
            }
            self.close(old);
        }
        self.end_s_m = to.s_m;
    }

    fn close(&mut self, lines: Vec<(MidwayLine, Vec<DVec2>)>) {
        self.done.extend(lines.into_iter().map(|(track, mut points)| {
            if track.against_line {
                points.reverse();
            }
            (track.kind, points)
        }));
    }

    /// All lines; lane centres run in driving direction.
    pub fn finish(mut self) -> Vec<(PolylineKind, Vec<DVec2>)> {
        let open = std::mem::take(&mut self.open);
        self.close(open);
        self.done
    }
}

/// The parts of a line inside the square of half width `half_m` around the origin, each thinned.
pub(super) fn clipped(points: &[DVec2], corners_m: (DVec2, DVec2)) -> Vec<Vec<DVec2>> {
    let mut parts: Vec<Vec<DVec2>> = Vec::new();
    let mut open = false;
    for ends in points.windows(2) {
        let Some((a, b)) = clip_segment(ends[0], ends[1], corners_m) else {
            open = false;
            continue;
        };
        match parts.last_mut().filter(|_| open && a == ends[0]) {
            Some(part) => part.push(b),
            None => parts.push(vec![a, b]),
        }
        open = b == ends[1];
    }
    parts.retain(|part| part.windows(2).map(|ends| ends[0].distance(ends[1])).sum::<f64>() >= SHORTEST_M);
    parts.iter().map(|part| curve::simplified(part, THIN_M)).collect()
}

/// Liang and Barsky 1984: the part of a segment inside the rectangle, `None` if there is none.
fn clip_segment(a: DVec2, b: DVec2, (low, high): (DVec2, DVec2)) -> Option<(DVec2, DVec2)> {
    let d = b - a;
    let (mut from, mut to) = (0.0f64, 1.0f64);
    for axis in 0..2 {
        for (rate, room) in [(-d[axis], a[axis] - low[axis]), (d[axis], high[axis] - a[axis])] {
            if rate == 0.0 && room < 0.0 || !room.is_finite() {
                return None;
            }
            if rate < 0.0 {
                from = from.max(room / rate);
            } else if rate > 0.0 {
                to = to.min(room / rate);
            }
        }
    }
    (from < to).then(|| {
        let start = if from > 0.0 { a + d * from } else { a };
        (start, if to < 1.0 { a + d * to } else { b })
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_are_cut_to_the_window_and_thinned() {
        let through: Vec<DVec2> = (-60..=60).map(|x| DVec2::new(f64::from(x), 1.0)).collect();
        assert_eq!(
            clipped(&through, (DVec2::splat(-40.0), DVec2::splat(40.0))),
            [[DVec2::new(-40.0, 1.0), DVec2::new(40.0, 1.0)]]
        );
        let out_and_in = [[0.0, 0.0], [50.0, 0.0], [50.0, 10.0], [0.0, 10.0]].map(DVec2::from_array);
        let parts = clipped(&out_and_in, (DVec2::splat(-40.0), DVec2::splat(40.0)));
        assert_eq!(parts.len(), 2);
        assert_eq!(parts[1], [DVec2::new(40.0, 10.0), DVec2::new(0.0, 10.0)]);
        let circle: Vec<DVec2> = (0..=200)
            .map(|i| DVec2::from_angle(f64::from(i) / 50.0) * 10.0)
            .collect();
        let thin = &clipped(&circle, (DVec2::splat(-40.0), DVec2::splat(40.0)))[0];
        assert!(thin.len() < 60 && thin.len() > 10, "{}", thin.len());
        assert!(
            clipped(
                &[DVec2::NAN, DVec2::ZERO, DVec2::INFINITY],
                (DVec2::splat(-40.0), DVec2::splat(40.0))
            )
            .is_empty()
        );
    }
}
