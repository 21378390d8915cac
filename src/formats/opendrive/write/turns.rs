//! Turns between the arms of a junction that no lane joins, over paved ground.

use std::collections::BTreeSet;

use glam::DVec2;

use super::chains::{GroundKind, STEP_M, surface};
use super::connect::{ConnectionContext, Gates, NEAR_ZONE, ZoneLaneEnd, ZonePath, is_apart};
use super::curve::{BACK_RAD, curve};
use super::fit::wrapped;
use super::roads::Contact;
use scene::road_map::resampled;

/// Turns below this go straight on, rad.
const STRAIGHT_RAD: f64 = 0.5;
/// Tightest turn, m.
const RADIUS_M: f64 = 2.5;
/// Paved ground to both sides of a turn's middle, m; the smaller width only if the larger one is found nowhere.
const ASIDE_M: [f64; 2] = [1.4, 0.9];
/// On this share of its way, at least.
const PAVED_SHARE: f64 = 0.97;
/// Tighter curves, where the widest one would leave the pavement.
const TIGHTER: [f64; 3] = [0.8, 0.65, 0.5];
/// A vehicle joins or leaves a ring over a way from and to, m.
const JOIN_M: [f64; 2] = [3.0, 16.0];

/// Turns between arms that no lane joins, where the ground is paved.
pub(super) fn turns(ground: &ConnectionContext<'_>, gates: &Gates, ways: &mut Vec<ZonePath>) {
    let arms = |doors: &[ZoneLaneEnd]| -> Vec<(usize, bool)> {
        let arms: BTreeSet<(usize, bool)> = doors.iter().map(ZoneLaneEnd::arm).collect();
        arms.into_iter().collect()
    };
    let joined: BTreeSet<_> = ways.iter().map(|w| (w.from.arm(), w.to.arm())).collect();
    let of = |doors: &[ZoneLaneEnd], arm: (usize, bool)| -> Vec<ZoneLaneEnd> {
        let mut lanes: Vec<ZoneLaneEnd> = doors.iter().filter(|d| d.arm() == arm).copied().collect();
        // From left to right as traffic sees them.
        let left = |d: &ZoneLaneEnd| DVec2::from_angle(d.contact.heading_rad).perp_dot(d.contact.at_m);
        lanes.sort_by(|a, b| left(b).total_cmp(&left(a)));
        lanes
    };
    let mut found = Vec::new();
    for from in arms(&gates.inward) {
        for to in arms(&gates.outward) {
            if from == to || joined.contains(&(from, to)) || joined.contains(&(to, from)) && both(gates, from)
            {
                continue;
            }
            let (inward, outward) = (of(&gates.inward, from), of(&gates.outward, to));
            let turn = wrapped(outward[0].contact.heading_rad - inward[0].contact.heading_rad);
            let pairs: Vec<(ZoneLaneEnd, ZoneLaneEnd)> = if turn.abs() > BACK_RAD {
                continue;
            } else if turn > STRAIGHT_RAD {
                vec![(inward[0], outward[0])]
            } else if turn < -STRAIGHT_RAD {
                vec![(inward[inward.len() - 1], outward[outward.len() - 1])]
            } else {
                inward.iter().copied().zip(outward.iter().copied()).collect()
            };
            for (from, to) in pairs {
                let ways =
                    |aside_m| direct(ground, from, to, aside_m).or_else(|| around(ground, from, to, aside_m));
                let points_m = ASIDE_M.into_iter().find_map(ways);
                found.extend(points_m.map(|points_m| ZonePath { from, to, points_m }));
            }
        }
    }
    ways.extend(found.into_iter().filter(is_apart));
}

/// Lanes that no way begins or ends at get the straightest one that can be driven.
pub(super) fn left_alone(ground: &ConnectionContext<'_>, gates: &Gates, ways: &mut Vec<ZonePath>) {
    let same = |a: &ZoneLaneEnd, b: &ZoneLaneEnd| (a.arm(), a.contact.lane) == (b.arm(), b.contact.lane);
    for from in &gates.inward {
        if !ways.iter().any(|w| same(&w.from, from)) {
            ways.extend(straightest(ground, gates.outward.iter().map(|to| (*from, *to))));
        }
    }
    for to in &gates.outward {
        if !ways.iter().any(|w| same(&w.to, to)) {
            ways.extend(straightest(ground, gates.inward.iter().map(|from| (*from, *to))));
        }
    }
}

fn straightest(
    ground: &ConnectionContext<'_>,
    pairs: impl Iterator<Item = (ZoneLaneEnd, ZoneLaneEnd)>,
) -> Option<ZonePath> {
    let turn = |(from, to): &(ZoneLaneEnd, ZoneLaneEnd)| {
        let turn = wrapped(to.contact.heading_rad - from.contact.heading_rad).abs();
        turn + 0.01 * from.contact.at_m.distance(to.contact.at_m)
    };
    let mut pairs: Vec<(ZoneLaneEnd, ZoneLaneEnd)> =
        pairs.filter(|(from, to)| from.arm() != to.arm()).collect();
    pairs.sort_by(|a, b| turn(a).total_cmp(&turn(b)));
    let way = pairs.into_iter().find_map(|(from, to)| {
        let points_m = ASIDE_M.into_iter().find_map(|m| direct(ground, from, to, m))?;
        Some(ZonePath { from, to, points_m })
    });
    way.filter(is_apart)
}

/// True if an arm is a lane that is driven both ways: a way through it counts for both directions.
fn both(gates: &Gates, arm: (usize, bool)) -> bool {
    gates.inward.iter().any(|d| d.arm() == arm && d.two_way)
}

/// A way that can be driven: one curve, or else straight ways and a tighter curve around the corner.
fn direct(
    ground: &ConnectionContext<'_>,
    from: ZoneLaneEnd,
    to: ZoneLaneEnd,
    aside_m: f64,
) -> Option<Vec<DVec2>> {
    let (from, to) = (from.contact, to.contact);
    let tighter = TIGHTER.iter().filter_map(|share| around_corner(from, to, *share));
    let all = curve(from, to).into_iter().chain(tighter);
    all.into_iter()
        .find(|points| is_drivable(ground, points, aside_m))
}

/// A curve that begins and ends at a share of the way to the crossing of the two lanes; `None` if they do not cross
/// ahead.
fn around_corner(from: Contact, to: Contact, share: f64) -> Option<Vec<DVec2>> {
    let [out, back] = [from, to].map(|c| DVec2::from_angle(c.heading_rad));
    let (way, sine) = (to.at_m - from.at_m, out.perp_dot(back));
    if sine.abs() < STRAIGHT_RAD.sin() {
        return None;
    }
    let (before, behind) = (way.perp_dot(back) / sine, way.perp_dot(out) / sine);
    let leg = before.min(-behind) * share;
    if leg <= 0.0 {
        return None;
    }
    let moved = |c: Contact, by: DVec2| Contact {
        at_m: c.at_m + by,
        ..c
    };
    let begin = moved(from, out * (before - leg));
    let end = moved(to, back * (behind + leg));
    let turn = curve(begin, end)?;
    Some([from.at_m].into_iter().chain(turn).chain([to.at_m]).collect())
}

/// True where a vehicle can follow a line: paved and not too tight.
fn is_drivable(ground: &ConnectionContext<'_>, points: &[DVec2], aside_m: f64) -> bool {
    let total: f64 = points.windows(2).map(|w| w[0].distance(w[1])).sum();
    let even = resampled(points, (total / STEP_M).ceil().max(3.0) as usize + 1);
    let extent = ground.layout.extent();
    let (mut looks, mut paved) = (0, 0);
    for triple in even.windows(3) {
        let (a, b) = (triple[1] - triple[0], triple[2] - triple[1]);
        let turn = wrapped(b.to_angle() - a.to_angle()).abs();
        if turn * RADIUS_M > a.length().min(b.length()).max(0.1) * 1.2 {
            return false;
        }
        let left = (triple[2] - triple[0]).normalize_or_zero().perp();
        for aside in [-aside_m, 0.0, aside_m] {
            looks += 1;
            let here = surface(ground.layout, extent, triple[1] + left * aside);
            paved += usize::from(!matches!(here, GroundKind::Other | GroundKind::Walkway));
        }
    }
    f64::from(paved as u32) >= PAVED_SHARE * f64::from(looks)
}

/// A way along a third lane of the zone: onto a ring, around and off it.
fn around(
    ground: &ConnectionContext<'_>,
    from: ZoneLaneEnd,
    to: ZoneLaneEnd,
    aside_m: f64,
) -> Option<Vec<DVec2>> {
    let first = ground.chains[from.chain].step(from.k, 1).unwrap_or(from.k);
    let zone = (0..NEAR_ZONE as isize)
        .filter_map(|n| {
            ground
                .zones
                .of(from.chain, ground.chains[from.chain].step(first, n)?)
        })
        .next()?;
    let mut best: Option<(f64, Vec<DVec2>)> = None;
    for (c, chain) in ground.chains.iter().enumerate() {
        if !chain.closed || c == from.chain || c == to.chain {
            continue;
        }
        let at = |k: usize| Contact {
            at_m: chain.points_m[k],
            heading_rad: chain.direction(k).to_angle(),
            width_m: 0.0,
            lane: 0,
        };
        let near = |p: DVec2| {
            move |k: &usize| {
                let m = chain.points_m[*k].distance(p);
                ground.zones.of(c, *k) == Some(zone) && (JOIN_M[0]..JOIN_M[1]).contains(&m)
            }
        };
        let onto = (0..chain.len()).filter(near(from.contact.at_m));
        let onto = onto.filter_map(|k| Some((k, curve(from.contact, at(k))?)));
        let onto: Vec<_> = onto
            .filter(|(_, points)| is_drivable(ground, points, aside_m))
            .collect();
        let off = (0..chain.len()).filter(near(to.contact.at_m));
        let off = off.filter_map(|k| Some((k, curve(at(k), to.contact)?)));
        let off: Vec<_> = off
            .filter(|(_, points)| is_drivable(ground, points, aside_m))
            .collect();
        for (a, first) in &onto {
            for (b, last) in &off {
                let n = (b + chain.len() - a) % chain.len();
                if n < 2
                    || n > chain.len() - 4
                    || !(0..n).all(|i| ground.zones.of(c, (a + i) % chain.len()) == Some(zone))
                {
                    continue;
                }
                let [join_m, leave_m] =
                    [first, last].map(|l| l.windows(2).map(|w| w[0].distance(w[1])).sum::<f64>());
                let way_m = join_m + leave_m + n as f64 * STEP_M;
                if best.as_ref().is_none_or(|(shortest, _)| way_m < *shortest) {
                    let ring = (1..n).map(|i| chain.points_m[(a + i) % chain.len()]);
                    best = Some((
                        way_m,
                        first
                            .iter()
                            .copied()
                            .chain(ring)
                            .chain(last.iter().copied())
                            .collect(),
                    ));
                }
            }
        }
    }
    best.map(|(_, points)| points)
}
