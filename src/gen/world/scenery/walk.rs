//! Lines that keep a distance from the road: for house fronts, fences, rails and rows of trees.

use glam::DVec2;

use super::site::ScenerySite;
use scene::{Extent, Window};

/// Steps along a line, m.
const STEP_M: f64 = 0.8;
/// Distance that lines continue outside the grid, m.
const BEYOND_M: f64 = 1.0;

/// Lines at `distance_m` from paved ground, with a vertex about every 0.8 m; the road is on their right.
pub(super) fn lines(site: &ScenerySite<'_>, distance_m: f64) -> Vec<Vec<DVec2>> {
    let mut seen = vec![false; Window::COLUMNS];
    let mut out = Vec::new();
    for start in 0..Window::COLUMNS {
        if seen[start] {
            continue;
        }
        // The cell's own distance differs from the blended one at its centre by rounding only.
        if (site.cell_to_paved_m(start) - distance_m).abs() > 0.26 {
            continue;
        }
        let p = Window::center(start / Window::NY, start % Window::NY, 0).truncate();
        if (site.paved_m(p) - distance_m).abs() > 0.25 {
            continue;
        }
        let ahead = walk(site, p, distance_m, 1.0, &mut seen);
        let mut back = walk(site, p, distance_m, -1.0, &mut seen);
        back.reverse();
        back.extend(ahead.into_iter().skip(1));
        mark(p, &mut seen);
        if back.len() > 3 {
            out.push(back);
        }
    }
    out
}

fn mark(p: DVec2, seen: &mut [bool]) {
    scene::raster::disc_cells(Extent::WINDOW, p, 1.3, |x, y| seen[x * Window::NY + y] = true);
}

fn walk(site: &ScenerySite<'_>, from: DVec2, distance_m: f64, sign: f64, seen: &mut [bool]) -> Vec<DVec2> {
    let (mut p, mut out) = (from, vec![from]);
    let mut fresh: Vec<DVec2> = Vec::new();
    let half = 40.0 + BEYOND_M;
    for _ in 0..600 {
        let Some(away) = site.away(p) else { break };
        // Keeps the road on the right: the line runs with `away` on its left.
        let along = -away.perp() * sign;
        let mut next = p + along * STEP_M;
        if let Some(turned) = site.away(next) {
            next += turned * (distance_m - site.paved_m(next)).clamp(-0.5, 0.5);
        }
        if next.abs().max_element() > half || (site.paved_m(next) - distance_m).abs() > 0.5 {
            break;
        }
        // A line that closes, or meets another, ends there.
        if Window::column_at(next.x, next.y).is_some_and(|[x, y]| seen[x * Window::NY + y]) {
            break;
        }
        // Cells right behind the walker are not marked yet, or it would stop at once.
        fresh.push(next);
        if fresh.len() > 4 {
            mark(fresh.remove(0), seen);
        }
        out.push(next);
        p = next;
    }
    fresh.into_iter().for_each(|p| mark(p, seen));
    out
}

/// The part of a line from `from_m` to `to_m` along it.
pub(super) fn part(line: &[DVec2], from_m: f64, to_m: f64) -> Vec<DVec2> {
    let mut out = Vec::new();
    let mut along = 0.0;
    for pair in line.windows(2) {
        let length = pair[0].distance(pair[1]);
        let at = |m: f64| pair[0].lerp(pair[1], ((m - along) / length.max(1e-9)).clamp(0.0, 1.0));
        if along + length > from_m && along < to_m {
            if out.is_empty() {
                out.push(at(from_m));
            }
            out.push(at(to_m));
        }
        along += length;
    }
    out
}

/// Length of a line, m.
pub(super) fn length_m(line: &[DVec2]) -> f64 {
    line.windows(2).map(|w| w[0].distance(w[1])).sum()
}

/// The line with fewer vertices: those that turn it by less than a few degrees are left out.
pub(super) fn thinned(line: &[DVec2]) -> Vec<DVec2> {
    let mut out: Vec<DVec2> = Vec::new();
    for (i, p) in line.iter().enumerate() {
        let last = i + 1 == line.len();
        let keep = match (out.last(), line.get(i + 1)) {
            (Some(before), Some(next)) => {
                let (a, b) = (
                    (*p - *before).normalize_or_zero(),
                    (*next - *p).normalize_or_zero(),
                );
                a.dot(b) < 0.995 || before.distance(*p) > 6.0
            }
            _ => true,
        };
        if keep || last {
            out.push(*p);
        }
    }
    out
}
