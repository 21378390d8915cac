//! Junctions: connecting roads along the lanes that lead through a zone, and turns between the others.

use std::collections::{BTreeMap, BTreeSet, HashMap};

use glam::DVec2;

use super::bundles::Bundled;
use super::chains::{Chain, Near, STEP_M, Sample, Surface, surface};
use super::curve::{BACK_RAD, curve};
use super::fit::{placed, reference, wrapped};
use super::roads::{Contact, End, Road};
use super::strips::{PAVED_IN_JUNCTION_M, Station, Strip, Strips};
use super::zones::Zones;
use scene::BevLayout;
use scene::road_map::resampled;

/// Free samples between the end of a road and its zone, at most.
const NEAR_ZONE: usize = 40;
/// Turns below this go straight on, rad.
const STRAIGHT_RAD: f64 = 0.5;
/// Tightest turn, m.
const RADIUS_M: f64 = 2.5;
/// A turn keeps so much paved ground to both sides of its middle, m.
const ASIDE_M: f64 = 1.4;
/// On this share of its way, at least.
const PAVED_SHARE: f64 = 0.98;
/// A vehicle joins or leaves a ring over a way from and to, m.
const JOIN_M: [f64; 2] = [3.0, 16.0];

/// A lane begins or ends beside another one if it is that near, m, and runs as it does, as a cosine.
const BESIDE_M: f64 = 1.0;
const ALIKE_COSINE: f64 = 0.9;
/// Changes from lane to lane on one way, and ways that are tried from one lane, at most.
const MOST_CHANGES: usize = 5;
const MOST_WALKS: usize = 200;
/// Samples of one way, at most.
const LONGEST_WALK: usize = 800;

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
    pub near: &'a Near,
    pub zones: &'a mut Zones,
    pub left_hand: bool,
}

/// Adds connecting roads and answers the junctions. Roads are those of the bundles, with ids; new ones get the ids from
/// `next_id` on, junctions those behind.
pub(super) fn connect(
    ground: &mut Ground<'_>,
    bundled: &Bundled,
    roads: &mut Vec<Road>,
    next_id: u32,
) -> Vec<Junction> {
    let gates = gates(ground, bundled, roads);
    let forks = Forks::find(ground);
    let mut id = next_id;
    let mut junctions = Vec::new();
    for gates in gates.values() {
        let (mut ways, forked) = through(ground, &forks, gates);
        if !forked {
            // A layout that has its turns needs no others.
            turns(ground, gates, &mut ways);
        }
        left_alone(ground, gates, &mut ways);
        let mut connections = Vec::new();
        for way in ways {
            let Some(mut road) = connecting(ground, &way) else {
                continue;
            };
            let lane = road
                .strips
                .kinds
                .iter()
                .position(|k| matches!(k, Strip::Lane { .. }));
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
        let Some(zone) = ground.zones.of(chain, k) else {
            continue;
        };
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

/// Where lanes begin beside others and where they end beside others, in zones.
struct Forks {
    /// Lanes that begin beside a sample.
    begin: HashMap<(usize, usize), Vec<usize>>,
    /// The sample beside the end of a lane.
    end: HashMap<usize, (usize, usize)>,
}

impl Forks {
    fn find(ground: &Ground<'_>) -> Self {
        let mut out = Self {
            begin: HashMap::new(),
            end: HashMap::new(),
        };
        for (i, chain) in ground.chains.iter().enumerate() {
            if chain.closed || chain.two_way {
                continue;
            }
            // The other lane passes by: it does not begin or end there itself.
            let passes = |s: &Sample, begins: bool| {
                let other = &ground.chains[s.chain];
                other.closed || if begins { s.k >= 2 } else { s.k + 2 < other.len() }
            };
            let beside = |k: usize, begins: bool| {
                let direction = chain.direction(k);
                let zone = ground.zones.of(i, k)?;
                let fits = |s: &&Sample| {
                    s.chain != i
                        && passes(s, begins)
                        && s.direction.dot(direction) > ALIKE_COSINE
                        && ground.zones.of(s.chain, s.k) == Some(zone)
                };
                let at_m = chain.points_m[k];
                let all = ground.near.within(at_m, BESIDE_M).filter(fits);
                let nearest = all.min_by(|a, b| {
                    let [a, b] = [a, b].map(|s| s.at_m.distance_squared(at_m));
                    a.total_cmp(&b)
                });
                nearest.map(|s| (s.chain, s.k))
            };
            if let Some(host) = beside(0, true) {
                out.begin.entry(host).or_default().push(i);
            }
            if let Some(host) = beside(chain.len() - 1, false) {
                out.end.insert(i, host);
            }
        }
        out
    }
}

/// A walk along lanes of a zone.
#[derive(Clone)]
struct Walk {
    chain: usize,
    k: usize,
    points_m: Vec<DVec2>,
    changes: usize,
}

/// Ways along lanes that lead through, also over lanes that fork off and join; true if any does.
fn through(ground: &Ground<'_>, forks: &Forks, gates: &Gates) -> (Vec<Way>, bool) {
    let mut out: Vec<Way> = Vec::new();
    let mut forked = false;
    for from in &gates.inward {
        let chain = &ground.chains[from.chain];
        let ahead = DVec2::from_angle(from.contact.heading_rad);
        // A lane that is driven both ways is followed from either end.
        let by = if chain.direction(from.k).dot(ahead) < 0.0 {
            -1
        } else {
            1
        };
        if by < 0 && !from.two_way {
            continue;
        }
        let mut open = vec![Walk {
            chain: from.chain,
            k: from.k,
            points_m: vec![from.contact.at_m],
            changes: 0,
        }];
        let mut walks = 0;
        while let Some(mut walk) = open.pop() {
            walks += 1;
            for _ in 0..LONGEST_WALK {
                let chain = &ground.chains[walk.chain];
                if walk.changes < MOST_CHANGES && walks < MOST_WALKS && by > 0 {
                    for other in forks.begin.get(&(walk.chain, walk.k)).into_iter().flatten() {
                        let mut fork = walk.clone();
                        (fork.chain, fork.k) = (*other, 0);
                        fork.changes += 1;
                        open.push(fork);
                    }
                }
                let next = match chain.step(walk.k, by) {
                    Some(next) => (walk.chain, next),
                    None => match forks.end.get(&walk.chain) {
                        Some(host) if walk.changes < MOST_CHANGES => {
                            walk.changes += 1;
                            *host
                        }
                        _ => break,
                    },
                };
                (walk.chain, walk.k) = next;
                let is_here = |d: &&Door| (d.chain, d.k) == next && d.arm() != from.arm();
                if let Some(to) = gates.outward.iter().find(is_here) {
                    let mut points_m = walk.points_m;
                    points_m.push(to.contact.at_m);
                    forked |= walk.changes > 0;
                    out.push(Way {
                        from: *from,
                        to: *to,
                        points_m,
                    });
                    break;
                }
                if next == (from.chain, from.k) {
                    break;
                }
                walk.points_m.push(ground.chains[next.0].points_m[next.1]);
            }
        }
    }
    out.retain(is_apart);
    // The shortest way between two lanes; both ways of a lane that is driven both ways are one road.
    out.sort_by_key(|way| way.points_m.len());
    let mut seen = BTreeSet::new();
    out.retain(|way| {
        let [a, b] = [way.from, way.to].map(|d| (d.road, d.at_end, d.contact.lane));
        seen.insert(if way.from.two_way {
            [a.min(b), a.max(b)]
        } else {
            [a, b]
        })
    });
    (out, forked)
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
            if from == to || joined.contains(&(from, to)) || joined.contains(&(to, from)) && both(gates, from)
            {
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

/// Lanes that no way begins or ends at get the straightest one that can be driven.
fn left_alone(ground: &Ground<'_>, gates: &Gates, ways: &mut Vec<Way>) {
    let same = |a: &Door, b: &Door| (a.arm(), a.contact.lane) == (b.arm(), b.contact.lane);
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

fn straightest(ground: &Ground<'_>, pairs: impl Iterator<Item = (Door, Door)>) -> Option<Way> {
    let turn = |(from, to): &(Door, Door)| {
        let turn = wrapped(to.contact.heading_rad - from.contact.heading_rad).abs();
        turn + 0.01 * from.contact.at_m.distance(to.contact.at_m)
    };
    let mut pairs: Vec<(Door, Door)> = pairs.filter(|(from, to)| from.arm() != to.arm()).collect();
    pairs.sort_by(|a, b| turn(a).total_cmp(&turn(b)));
    let way = pairs.into_iter().find_map(|(from, to)| {
        let points_m = curve(from.contact, to.contact).filter(|points| is_drivable(ground, points))?;
        Some(Way { from, to, points_m })
    });
    way.filter(is_apart)
}

/// True if an arm is a lane that is driven both ways: a way through it counts for both directions.
fn both(gates: &Gates, arm: (usize, bool)) -> bool {
    gates.inward.iter().any(|d| d.arm() == arm && d.two_way)
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
        let onto: Vec<_> = onto.filter(|(_, points)| is_drivable(ground, points)).collect();
        let off = (0..chain.len()).filter(near(to.contact.at_m));
        let off = off.filter_map(|k| Some((k, curve(at(k), to.contact)?)));
        let off: Vec<_> = off.filter(|(_, points)| is_drivable(ground, points)).collect();
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
    let mut strips = lane.with_sides(ground.layout, &stations, PAVED_IN_JUNCTION_M, |_| true);
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
