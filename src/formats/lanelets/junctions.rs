//! Which lanelets lie in a junction, and which lead into it.

use std::collections::{BTreeMap, BTreeSet};

use super::{Lanelet, Use};
use crate::opendrive::{RoadEnd, XodrJunction};

/// Junctions, and the neighbours before and behind every lanelet.
pub(super) struct Junctions {
    pub junctions: Vec<XodrJunction>,
    /// Id of the junction of each lanelet in one.
    pub junction_of: BTreeMap<i64, String>,
    before: BTreeMap<i64, RoadEnd>,
    behind: BTreeMap<i64, RoadEnd>,
}

impl Junctions {
    /// Neighbours of a lanelet: before its start, and beyond its end.
    pub fn ends(&self, id: i64) -> [Option<RoadEnd>; 2] {
        [&self.before, &self.behind].map(|ends| ends.get(&id).cloned())
    }
}

/// A lanelet is in a junction if its way in or out is shared: another one begins or ends where it does. Junctions are those lanelets
/// that share ways, joined.
pub(super) fn find(lanelets: &[Lanelet]) -> Junctions {
    let traffic: BTreeMap<i64, &Lanelet> = lanelets
        .iter()
        .filter(|l| l.use_ == Use::Traffic)
        .map(|l| (l.id, l))
        .collect();
    let mut before: BTreeMap<i64, Vec<i64>> = BTreeMap::new();
    let behind = |l: &Lanelet| -> Vec<i64> {
        let ids = l.successors.iter().copied().filter(|id| traffic.contains_key(id));
        ids.collect()
    };
    for l in traffic.values() {
        for next in behind(l) {
            before.entry(next).or_default().push(l.id);
        }
    }
    // The least id of the lanelets that a lanelet is joined with.
    let mut joined: BTreeMap<i64, i64> = BTreeMap::new();
    // Every lanelet on the way is joined with the last one directly, so that no chain is walked twice.
    fn root(joined: &mut BTreeMap<i64, i64>, id: i64) -> i64 {
        let mut top = id;
        while let Some(up) = joined.get(&top).filter(|up| **up != top) {
            top = *up;
        }
        let mut at = id;
        while let Some(up) = joined.get_mut(&at).filter(|up| **up != top) {
            at = std::mem::replace(up, top);
        }
        top
    }
    let shared = traffic
        .values()
        .map(|l| behind(l))
        .chain(before.values().cloned());
    for group in shared.filter(|group| group.len() > 1).collect::<Vec<_>>() {
        let least = group
            .iter()
            .map(|id| root(&mut joined, *id))
            .min()
            .unwrap_or(group[0]);
        for id in group {
            let top = root(&mut joined, id);
            joined.insert(top, least);
            joined.insert(id, least);
        }
    }
    let ids: Vec<i64> = joined.keys().copied().collect();
    let junction_of: BTreeMap<i64, String> = ids
        .into_iter()
        .map(|id| (id, format!("junction {}", root(&mut joined, id))))
        .collect();
    let mut out = Junctions {
        junctions: Vec::new(),
        junction_of,
        before: BTreeMap::new(),
        behind: BTreeMap::new(),
    };
    let mut incoming: BTreeMap<String, BTreeSet<String>> = BTreeMap::new();
    let mut connections: BTreeMap<String, usize> = BTreeMap::new();
    for l in traffic.values() {
        let ways = behind(l);
        for next in &ways {
            if let Some(junction) = out.junction_of.get(next) {
                incoming
                    .entry(junction.clone())
                    .or_default()
                    .insert(l.id.to_string());
                *connections.entry(junction.clone()).or_default() += 1;
            }
        }
        let end = |ids: &[i64]| match ids {
            [] => None,
            [first, ..] => Some(match out.junction_of.get(first) {
                Some(junction) if !out.junction_of.contains_key(&l.id) => RoadEnd::Junction(junction.clone()),
                _ => RoadEnd::Road(first.to_string()),
            }),
        };
        let (start, finish) = (end(before.get(&l.id).map_or(&[][..], Vec::as_slice)), end(&ways));
        out.before.extend(start.map(|e| (l.id, e)));
        out.behind.extend(finish.map(|e| (l.id, e)));
    }
    out.junctions = incoming
        .into_iter()
        .map(|(id, incoming)| XodrJunction {
            connections: connections.get(&id).copied().unwrap_or_default(),
            incoming: incoming.into_iter().collect(),
            id,
        })
        .collect();
    out
}
