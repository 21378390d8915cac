//! Junctions: connecting roads along the lanes that lead through a zone, and turns between the others.

use std::collections::BTreeMap;

use glam::DVec2;

use super::bundles::Bundled;
use super::chains::{Chain, Near, STEP_M};
use super::fit::{placed, reference};
use super::roads::{Contact, End, WrittenRoad};
use super::strips::{PAVED_IN_JUNCTION_M, Station, Strip, Strips};
use super::turns::{left_alone, turns};
use super::ways::{Forks, through};
use super::zones::Zones;
use scene::BevLayout;
use scene::road_map::resampled;

/// Free samples between the end of a road and its zone, at most.
pub(super) const NEAR_ZONE: usize = 40;

/// A junction that is to be written.
pub(super) struct WrittenJunction {
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
pub(super) struct ZoneLaneEnd {
    pub road: usize,
    pub at_end: bool,
    pub contact: Contact,
    /// The lane and its last sample on the road.
    pub chain: usize,
    pub k: usize,
    pub two_way: bool,
}

impl ZoneLaneEnd {
    /// The end of the road that it belongs to.
    pub fn arm(&self) -> (usize, bool) {
        (self.road, self.at_end)
    }
}

/// Where traffic comes into a zone and where it leaves it.
#[derive(Default)]
pub(super) struct Gates {
    pub inward: Vec<ZoneLaneEnd>,
    pub outward: Vec<ZoneLaneEnd>,
}

/// Data for connecting roads.
pub(super) struct ConnectionContext<'a> {
    pub layout: &'a BevLayout,
    pub chains: &'a [Chain],
    pub near: &'a Near,
    pub zones: &'a mut Zones,
    pub left_hand: bool,
}

/// Adds connecting roads and returns the junctions. `roads` are those of the bundles, with ids; new roads get the ids
/// from `next_id` on, and junctions the ids behind those.
pub(super) fn connect(
    ground: &mut ConnectionContext<'_>,
    bundled: &Bundled,
    roads: &mut Vec<WrittenRoad>,
    next_id: u32,
) -> Vec<WrittenJunction> {
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
            junctions.push(WrittenJunction {
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
fn gates(
    ground: &mut ConnectionContext<'_>,
    bundled: &Bundled,
    roads: &[WrittenRoad],
) -> BTreeMap<usize, Gates> {
    let mut doors: Vec<(ZoneLaneEnd, bool, usize, usize)> = Vec::new(); // inward, sample in the zone
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
                let door = ZoneLaneEnd {
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
pub(super) struct ZonePath {
    pub from: ZoneLaneEnd,
    pub to: ZoneLaneEnd,
    pub points_m: Vec<DVec2>,
}

/// True for a way that has a length.
pub(super) fn is_apart(way: &ZonePath) -> bool {
    let length: f64 = way.points_m.windows(2).map(|w| w[0].distance(w[1])).sum();
    length > 1.0
}

/// The road of one lane along a way; its width goes over from one lane's to the other's.
fn connecting(ground: &ConnectionContext<'_>, way: &ZonePath) -> Option<WrittenRoad> {
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
    Some(WrittenRoad {
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
