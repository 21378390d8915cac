//! Junctions: connecting roads along the lanes that lead through a zone, and turns between the others.

use std::collections::{BTreeMap, BTreeSet};

use glam::DVec2;

use super::bundles::Bundled;
use super::chains::{Chain, STEP_M, Surface, surface};
use super::fit::{reference, wrapped};
use super::roads::{Contact, End, Road, placed};
use super::strips::{Station, Strip, Strips};
use super::zones::Zones;
use scene::BevLayout;
use scene::road_map::resampled;

/// Free samples between the end of a road and its zone, at most.
const NEAR_ZONE: usize = 40;
/// Turns beyond this go back, rad.
const BACK_RAD: f64 = 2.6;
/// Turns below this go straight on, rad.
const STRAIGHT_RAD: f64 = 0.5;
/// Tightest turn, m.
const RADIUS_M: f64 = 2.5;
/// A turn keeps so much paved ground to both sides of its middle, m.
const ASIDE_M: f64 = 0.8;
/// On this share of its way, at least.
const PAVED_SHARE: f64 = 0.95;
/// A vehicle joins or leaves a ring over a way from and to, m.
const JOIN_M: [f64; 2] = [3.0, 16.0];

/// A junction that is to be written.
pub(super) struct Junction {
    pub id: u32,
    pub connections: Vec<Connection>,
}

/// From a lane of an incoming road to the lane of a connecting road.
#[derive(Clone, Copy)]
pub(super) struct Connection {
    pub incoming: u32,
    pub connecting: u32,
    pub from: i32,
    pub to: i32,
}

/// A lane where a road meets a zone.
#[derive(Clone, Copy)]
struct Door {
    road: usize,
    at_end: bool,
    contact: Contact,
    chain: usize,
    k: usize,
    two_way: bool,
}

impl Door {
    fn arm(&self) -> (usize, bool) {
        (self.road, self.at_end)
    }
}

/// Where traffic comes into a zone and where it leaves it.
#[derive(Default)]
struct Gates {
    inward: Vec<Door>,
    outward: Vec<Door>,
}

/// What is asked about while roads are connected.
pub(super) struct Ground<'a> {
    pub layout: &'a BevLayout,
    pub chains: &'a [Chain],
    pub zones: &'a mut Zones,
    pub left_hand: bool,
}

/// Adds connecting roads and answers the junctions. Roads are those of the bundles, with ids; new ones get the ids from
/// `next_id` on, junctions those behind.
pub(super) fn connect(ground: &mut Ground<'_>, bundled: &Bundled, roads: &mut Vec<Road>, next_id: u32) -> Vec<Junction> {
    let gates = gates(ground, bundled, roads);
    let mut id = next_id;
    let mut junctions = Vec::new();
    for gates in gates.values() {
        let mut ways = through(ground, gates);
        turns(ground, gates, &mut ways);
        let mut connections = Vec::new();
        for way in ways {
            let Some(mut road) = connecting(ground, &way) else {
                continue;
            };
            let lane = road.strips.kinds.iter().position(|k| matches!(k, Strip::Lane { .. }));
            let Some(lane) = lane else { continue };
            road.id = id;
            id += 1;
            road.links[lane] = [Some(way.from.contact.lane), Some(way.to.contact.lane)];
            road.ends = [way.from, way.to].map(|door| Some(End::Road(roads[door.road].id, door.at_end)));
            connections.push(Connection {
                incoming: roads[way.from.road].id,
                connecting: road.id,
                from: way.from.contact.lane,
                to: road.lane_id(lane),
            });
            for door in [way.from, way.to] {
                // Its id is known once all connecting roads have theirs.
                roads[door.road].ends[usize::from(door.at_end)] = Some(End::Junction(junctions.len() as u32));
            }
            road.junction = Some(junctions.len() as u32);
            roads.push(road);
        }
        if !connections.is_empty() {
            junctions.push(Junction {
                id: junctions.len() as u32,
                connections,
            });
        }
    }
    for junction in &mut junctions {
        junction.id += id;
    }
    for road in roads {
        road.junction = road.junction.map(|j| j + id);
        for end in road.ends.iter_mut().flatten() {
            if let End::Junction(j) = end {
                *j += id;
            }
        }
    }
    junctions
}

/// The lanes at the ends of roads, by zone. Zones that one end of a road touches become one.
fn gates(ground: &mut Ground<'_>, bundled: &Bundled, roads: &[Road]) -> BTreeMap<usize, Gates> {
    let mut doors: Vec<(Door, bool, usize, usize)> = Vec::new(); // inward, sample in the zone
    for (r, road) in roads.iter().enumerate() {
        for at_end in [false, true] {
            let mut of_end: Vec<(usize, usize)> = Vec::new();
            for strip in 0..road.strips.kinds.len() {
                let Strip::Lane { chain, along } = road.strips.kinds[strip] else {
                    continue;
                };
                let Some(contact) = road.contact(strip, at_end) else {
                    continue;
                };
                let Some(bundle) = road.bundle.map(|b| &bundled.bundles[b]) else {
                    continue;
                };
                let member = bundle.members.iter().find(|m| m.chain == chain);
                let i = if at_end { bundle.samples.len() - 1 } else { 0 };
                let Some((k, _)) = member.and_then(|m| m.beside[i]) else {
                    continue;
                };
                let inward = along == at_end;
                let by = if inward { 1 } else { -1 };
                let line = &ground.chains[chain];
                let beyond = (1..NEAR_ZONE as isize).map_while(|n| line.step(k, by * n));
                let Some(zone) = beyond.into_iter().find(|k| ground.zones.of(chain, *k).is_some()) else {
                    continue;
                };
                of_end.push((chain, zone));
                let door = Door {
                    road: r,
                    at_end,
                    contact,
                    chain,
                    k,
                    two_way: line.two_way,
                };
                doors.push((door, inward, chain, zone));
            }
            if !of_end.is_empty() {
                ground.zones.join(&of_end);
            }
        }
    }
    let mut out: BTreeMap<usize, Gates> = BTreeMap::new();
    for (door, inward, chain, k) in doors {
        let Some(zone) = ground.zones.of(chain, k) else { continue };
        let gates = out.entry(zone).or_default();
        let back = || {
            let mut back = door;
            back.contact.heading_rad += std::f64::consts::PI;
            back
        };
        match inward {
            true => gates.inward.push(door),
            false => gates.outward.push(door),
        }
        if door.two_way {
            match inward {
                true => gates.outward.push(back()),
                false => gates.inward.push(back()),
            }
        }
    }
    out
}

/// A way through a zone, from its first to its last point.
struct Way {
    from: Door,
    to: Door,
    points_m: Vec<DVec2>,
}

/// Ways along lanes that lead through.
fn through(ground: &Ground<'_>, gates: &Gates) -> Vec<Way> {
    let mut out = Vec::new();
    for from in &gates.inward {
        let chain = &ground.chains[from.chain];
        for by in [1, -1] {
            // A lane that is driven both ways is followed from either end.
            let ahead = DVec2::from_angle(from.contact.heading_rad);
            let fits = by == 1 || from.two_way;
            if !fits || chain.direction(from.k).dot(ahead) * f64::from(by) < 0.0 {
                continue;
            }
            let mut points = vec![from.contact.at_m];
            let mut k = from.k;
            while let Some(next) = chain.step(k, by as isize) {
                k = next;
                let to = gates.outward.iter().find(|d| d.chain == from.chain && d.k == k);
                if let Some(to) = to.filter(|to| to.arm() != from.arm()) {
                    points.push(to.contact.at_m);
                    out.push(Way {
                        from: *from,
                        to: *to,
                        points_m: points,
                    });
                    break;
                }
                points.push(chain.points_m[k]);
                if k == from.k || points.len() > chain.len() {
                    break;
                }
            }
        }
    }
    out.retain(|way| is_apart(way));
    // Both ways of a lane that is driven both ways are one road.
    let mut seen = BTreeSet::new();
    out.retain(|way| {
        let [a, b] = [way.from, way.to].map(|d| (d.road, d.at_end, d.contact.lane));
        !way.from.two_way || seen.insert([a.min(b), a.max(b)])
    });
    out
}

fn is_apart(way: &Way) -> bool {
    let length: f64 = way.points_m.windows(2).map(|w| w[0].distance(w[1])).sum();
    length > 1.0
}

/// Turns between arms that no lane joins, where the ground is paved.
fn turns(ground: &Ground<'_>, gates: &Gates, ways: &mut Vec<Way>) {
    let arms = |doors: &[Door]| -> Vec<(usize, bool)> {
        let arms: BTreeSet<(usize, bool)> = doors.iter().map(Door::arm).collect();
        arms.into_iter().collect()
    };
    let joined: BTreeSet<_> = ways.iter().map(|w| (w.from.arm(), w.to.arm())).collect();
    let of = |doors: &[Door], arm: (usize, bool)| -> Vec<Door> {
        let mut lanes: Vec<Door> = doors.iter().filter(|d| d.arm() == arm).copied().collect();
        // From left to right as traffic sees them.
        let left = |d: &Door| DVec2::from_angle(d.contact.heading_rad).perp_dot(d.contact.at_m);
        lanes.sort_by(|a, b| left(b).total_cmp(&left(a)));
        lanes
    };
    let mut found = Vec::new();
    for from in arms(&gates.inward) {
        for to in arms(&gates.outward) {
            if from == to || joined.contains(&(from, to)) || joined.contains(&(to, from)) && both(gates, from) {
                continue;
            }
            let (inward, outward) = (of(&gates.inward, from), of(&gates.outward, to));
            let turn = wrapped(outward[0].contact.heading_rad - inward[0].contact.heading_rad);
            let pairs: Vec<(Door, Door)> = if turn.abs() > BACK_RAD {
                continue;
            } else if turn > STRAIGHT_RAD {
                vec![(inward[0], outward[0])]
            } else if turn < -STRAIGHT_RAD {
                vec![(inward[inward.len() - 1], outward[outward.len() - 1])]
            } else {
                inward.iter().copied().zip(outward.iter().copied()).collect()
            };
            for (from, to) in pairs {
                let direct = curve(from.contact, to.contact).filter(|points| is_drivable(ground, points));
                let points_m = direct.or_else(|| around(ground, from, to));
                found.extend(points_m.map(|points_m| Way { from, to, points_m }));
            }
        }
    }
    ways.extend(found.into_iter().filter(is_apart));
}

/// True if an arm is a lane that is driven both ways: a way through it counts for both directions.
fn both(gates: &Gates, arm: (usize, bool)) -> bool {
    gates.inward.iter().any(|d| d.arm() == arm && d.two_way)
}

/// A smooth way from one place and heading to another; `None` where it would turn back or wind.
fn curve(from: Contact, to: Contact) -> Option<Vec<DVec2>> {
    let way = to.at_m - from.at_m;
    let turn = wrapped(to.heading_rad - from.heading_rad);
    let [out, back] = [from, to].map(|c| DVec2::from_angle(c.heading_rad));
    if way.dot(out) < 0.0 || way.dot(back) < 0.0 || way.length() < 1.0 || turn.abs() > BACK_RAD {
        return None;
    }
    // Hermite's cubic with the speed of a circle of that turn.
    let speed = way.length() / (turn / 4.0).cos().powi(2);
    let count = (way.length() / STEP_M).ceil().max(4.0) as usize * 2;
    let at = |i: usize| {
        let p = i as f64 / count as f64;
        let (p2, p3) = (p * p, p * p * p);
        from.at_m * (2.0 * p3 - 3.0 * p2 + 1.0)
            + out * (speed * (p3 - 2.0 * p2 + p))
            + to.at_m * (3.0 * p2 - 2.0 * p3)
            + back * (speed * (p3 - p2))
    };
    Some((0..=count).map(at).collect())
}

/// True where a vehicle can follow a line: paved and not too tight.
fn is_drivable(ground: &Ground<'_>, points: &[DVec2]) -> bool {
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
        for aside in [-ASIDE_M, 0.0, ASIDE_M] {
            looks += 1;
            let here = surface(ground.layout, extent, triple[1] + left * aside);
            paved += usize::from(!matches!(here, Surface::Other | Surface::Walkway));
        }
    }
    f64::from(paved as u32) >= PAVED_SHARE * f64::from(looks)
}

/// A way along a third lane of the zone: onto a ring, around and off it.
fn around(ground: &Ground<'_>, from: Door, to: Door) -> Option<Vec<DVec2>> {
    let first = ground.chains[from.chain].step(from.k, 1).unwrap_or(from.k);
    let zone = (0..NEAR_ZONE as isize)
        .filter_map(|n| ground.zones.of(from.chain, ground.chains[from.chain].step(first, n)?))
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
        let onto: Vec<_> = onto.filter(|(_, points)| is_drivable(ground, points)).collect();
        let off = (0..chain.len()).filter(near(to.contact.at_m));
        let off = off.filter_map(|k| Some((k, curve(at(k), to.contact)?)));
        let off: Vec<_> = off.filter(|(_, points)| is_drivable(ground, points)).collect();
        for (a, first) in &onto {
            for (b, last) in &off {
                let n = (b + chain.len() - a) % chain.len();
                if n < 2 || n > chain.len() - 4 || !(0..n).all(|i| ground.zones.of(c, (a + i) % chain.len()) == Some(zone)) {
                    continue;
                }
                let [join_m, leave_m] = [first, last].map(|l| l.windows(2).map(|w| w[0].distance(w[1])).sum::<f64>());
                let way_m = join_m + leave_m + n as f64 * STEP_M;
                if best.as_ref().is_none_or(|(shortest, _)| way_m < *shortest) {
                    let ring = (1..n).map(|i| chain.points_m[(a + i) % chain.len()]);
                    best = Some((way_m, first.iter().copied().chain(ring).chain(last.iter().copied()).collect()));
                }
            }
        }
    }
    best.map(|(_, points)| points)
}

/// The road of one lane along a way; its width goes over from one lane's to the other's.
fn connecting(ground: &Ground<'_>, way: &Way) -> Option<Road> {
    let total: f64 = way.points_m.windows(2).map(|w| w[0].distance(w[1])).sum();
    let count = (total / STEP_M).ceil().max(2.0) as usize + 1;
    let middle = resampled(&way.points_m, count);
    let [from, to] = [way.from.contact, way.to.contact];
    let last = count - 1;
    let left = |i: usize| match i {
        0 => DVec2::from_angle(from.heading_rad).perp(),
        i if i == last => DVec2::from_angle(to.heading_rad).perp(),
        i => (middle[(i + 2).min(last)] - middle[i.saturating_sub(2)])
            .normalize_or(DVec2::X)
            .perp(),
    };
    let stations: Vec<Station> = (0..count)
        .map(|i| Station {
            at_m: middle[i],
            left: left(i),
        })
        .collect();
    let half = |i: usize| {
        let p = i as f64 / last as f64;
        let share = p * p * (3.0 - 2.0 * p);
        (from.width_m + (to.width_m - from.width_m) * share) / 2.0
    };
    let side = if ground.left_hand { -1.0 } else { 1.0 };
    let line: Vec<DVec2> = (0..count)
        .map(|i| stations[i].at_m + stations[i].left * (side * half(i)))
        .collect();
    let reference = reference(&line, [Some(from.heading_rad), Some(to.heading_rad)])?;
    let lane = Strips {
        kinds: vec![Strip::Lane {
            chain: usize::MAX,
            along: true,
        }],
        borders_m: vec![
            (0..count).map(half).collect(),
            (0..count).map(|i| -half(i)).collect(),
        ],
        center: usize::from(ground.left_hand),
    };
    let mut strips = lane.with_sides(ground.layout, &stations, |_| true);
    let (s_m, off_m) = placed(&reference, &line);
    strips.seen_from(|i| side * half(i) - off_m[i]);
    Some(Road {
        id: 0,
        junction: None,
        links: vec![[None; 2]; strips.kinds.len()],
        two_way: way.from.two_way,
        reference,
        s_m,
        strips,
        ends: [None; 2],
        left_hand: ground.left_hand,
        bundle: None,
        objects: Vec::new(),
        signals: Vec::new(),
    })
}
