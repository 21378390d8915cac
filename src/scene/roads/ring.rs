//! Roundabouts: the ring, how arms open into it, and the lanes that lead in and out.

use std::f64::consts::TAU;

use glam::DVec2;

use super::corner::{JunctionArm, JunctionGeometry, set_back};
use super::{RoadNode, curve};

/// Distance before the ring at which an arm begins to widen, m.
const FLARE_M: f64 = 5.0;
/// Angle about the island between the middle of an arm and the places where its lanes join and leave the ring.
const JOIN_RAD: f64 = 0.5;
/// Length of a piece of the ring, rad.
const STEP_RAD: f64 = 0.05;

/// Draws the ring of a node with its arms; `size_m` holds the radius of the island and the width of the ring.
pub(super) fn draw(node: &RoadNode, arms: &[JunctionArm<'_>], size_m: [f64; 2], out: &mut JunctionGeometry) {
    let ([island_m, ring_m], center) = (size_m, node.at_m);
    let (outer_m, middle_m) = (island_m + ring_m, island_m + ring_m / 2.0);
    let on_ring = |angle: f64, radius_m: f64| center + DVec2::from_angle(angle) * radius_m;
    let circle = |from: f64, to: f64, radius_m: f64| -> Vec<DVec2> {
        let steps = ((to - from) / STEP_RAD).ceil().max(2.0);
        (0..=steps as usize)
            .map(|k| on_ring(from + (to - from) * k as f64 / steps, radius_m))
            .collect()
    };
    out.paved.push(circle(0.0, TAU, outer_m));
    out.islands.push((center, island_m));
    let walk_m = arms
        .iter()
        .flat_map(|a| [a.walk_m(true), a.walk_m(false)])
        .fold(0.0, f64::max);
    if walk_m > 0.0 {
        out.walks.push((circle(0.0, TAU, outer_m), walk_m));
    }
    // Places on the ring at which lanes join or leave it.
    let mut joints: Vec<f64> = Vec::new();
    let gap = neighbours(arms, center, outer_m);
    for seen in arms {
        for left in [true, false] {
            flare(seen, left, center, outer_m, out);
        }
        let Some(heading) = heading(seen, center, outer_m) else {
            continue;
        };
        let clear_m = out
            .setback_m
            .get(&(seen.arm.road, seen.arm.end))
            .copied()
            .unwrap_or(outer_m);
        let apart = JOIN_RAD.min(gap / 3.0);
        for inward in [true, false] {
            let angle = heading + if inward { apart } else { -apart };
            let join = on_ring(angle, middle_m);
            let along = DVec2::from_angle(angle).perp();
            let mut any = false;
            for lane in lanes(seen, inward) {
                let (foot, _) = curve::at(&lane, clear_m);
                let about = join + along * (foot.distance(join) * if inward { -0.4 } else { 0.4 });
                let mut way = curve::corner(foot, about, join);
                if !inward {
                    way.reverse();
                }
                out.lanes.push((node.id, way));
                any = true;
            }
            if any {
                joints.push(angle.rem_euclid(TAU));
            }
        }
    }
    joints.sort_by(f64::total_cmp);
    joints.dedup_by(|a, b| (*a - *b).abs() < 1e-6);
    match joints.as_slice() {
        [] => out.lanes.push((node.id, circle(0.0, TAU, middle_m))),
        [first, ..] => {
            let ends = joints[1..].iter().copied().chain([first + TAU]);
            let pieces = joints
                .iter()
                .zip(ends)
                .map(|(a, b)| (node.id, circle(*a, b, middle_m)));
            out.lanes.extend(pieces);
        }
    }
}

/// The direction in which an arm leaves the ring, rad.
fn heading(seen: &JunctionArm<'_>, center: DVec2, outer_m: f64) -> Option<f64> {
    let beyond = seen.out_m.iter().find(|p| p.distance(center) >= outer_m)?;
    Some((*beyond - center).to_angle())
}

/// The smallest angle between neighbouring arms, rad.
fn neighbours(arms: &[JunctionArm<'_>], center: DVec2, outer_m: f64) -> f64 {
    let mut all: Vec<f64> = arms.iter().filter_map(|a| heading(a, center, outer_m)).collect();
    all.sort_by(f64::total_cmp);
    let Some(first) = all.first().copied() else {
        return TAU;
    };
    let next = all[1..].iter().copied().chain([first + TAU]);
    all.iter().zip(next).map(|(a, b)| b - a).fold(TAU, f64::min)
}

/// Widens the kerb of an arm into that of the ring.
fn flare(seen: &JunctionArm<'_>, left: bool, center: DVec2, outer_m: f64, out: &mut JunctionGeometry) {
    let kerb = seen.kerb(left);
    let Some(last) = kerb
        .array_windows::<2>()
        .rposition(|[a, b]| a.distance(center) < outer_m && b.distance(center) >= outer_m)
    else {
        return;
    };
    let (a, b) = (kerb[last], kerb[last + 1]);
    // Bisection for the place where the piece leaves the circle.
    let (mut low, mut high) = (0.0, 1.0);
    for _ in 0..40 {
        let t = (low + high) / 2.0;
        if a.lerp(b, t).distance(center) < outer_m {
            low = t
        } else {
            high = t
        }
    }
    let meet = a.lerp(b, high);
    let along = curve::length_m(&kerb[..=last]) + a.distance(meet);
    let from = curve::at(&kerb, along + FLARE_M.min(seen.length_m * 0.3)).0;
    let turn = FLARE_M / outer_m * if left { 1.0 } else { -1.0 };
    let to = center + DVec2::from_angle(turn).rotate(meet - center);
    let round = curve::corner(from, meet, to);
    let walk_m = seen.walk_m(left);
    if walk_m > 0.0 {
        out.walks.push((round.clone(), walk_m));
    }
    out.paved.push(std::iter::once(meet).chain(round).collect());
    set_back(out, seen, left, from);
}

/// Middles of the driven lanes of an arm that lead to the node, or away from it; from the node outward.
fn lanes(seen: &JunctionArm<'_>, inward: bool) -> Vec<Vec<DVec2>> {
    // Lanes on the right of the line are driven along it: outward at its beginning.
    let right = (seen.arm.end == 0) != inward;
    let sign = if seen.side(true) == right { 1.0 } else { -1.0 };
    let (mut off, mut out) = (0.0, Vec::new());
    for lane in seen.road.side(right) {
        if lane.kind.is_driven() {
            out.push(curve::beside(&seen.out_m, sign * (off + lane.width_m / 2.0)));
        }
        off += lane.width_m;
    }
    out
}
