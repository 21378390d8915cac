//! Writes the roads of a layout as OpenDRIVE 1.8. Lanes that run side by side become one road; where lanes cross, meet
//! or part, roads end at a junction with one connecting road for each lane that leads through and for turns between the
//! others. Paved ground, car parks and walkways beside the lanes become lanes too. Ground that no lane crosses gets
//! lanes along its middle; the remaining ground is written as areas. Sceneloom's own rows follow, see `own_rows`.

mod areas;
mod bundles;
mod chains;
mod connect;
mod curve;
pub(crate) mod fit;
pub(crate) mod lane_graph;
mod limits;
mod middles;
mod on_road;
mod profile;
mod roads;
mod strips;
mod turns;
mod ways;
mod xml;
mod zones;

use super::own_rows;
use bundles::Bundled;
use chains::{Chain, Near};
use connect::{ConnectionContext, WrittenJunction};
use limits::SpeedLimitSource;
use on_road::OnRoads;
use roads::WrittenRoad;
use scene::distance::nearest_source;
use scene::{Background, BevLayout, RoadNetwork};
use zones::Zones;

/// Ground beside a way of one lane that is still its own, m.
const VERGE_M: f64 = 0.6;

/// Amount of detail in a file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Detail {
    /// Roads alone.
    Roads,
    /// Roads, and areas for ground that no road covers.
    #[cfg(test)]
    Areas,
    /// Roads, areas, and Sceneloom's own rows.
    Rows,
}

/// The bytes of an OpenDRIVE file with the roads of a layout, and signs and traffic lights of the background. Its frame is that of the
/// layout. Speed limits are those of `roads`, the scene's network, else of the layout's own lines.
pub fn to_bytes(name: &str, layout: &BevLayout, roads: &RoadNetwork, background: &Background) -> Vec<u8> {
    text_of(name, layout, (roads, background), Detail::Rows).into_bytes()
}

/// The text of a file with chosen detail, without a road network's limits and without background.
#[cfg(test)]
pub(super) fn to_text(name: &str, layout: &BevLayout, detail: Detail) -> String {
    text_of(
        name,
        layout,
        (&RoadNetwork::default(), &Background::default()),
        detail,
    )
}

fn text_of(
    name: &str,
    layout: &BevLayout,
    (reshaped, background): (&RoadNetwork, &Background),
    detail: Detail,
) -> String {
    let limits = SpeedLimitSource::from_layout(layout, reshaped);
    let (mut roads, junctions) = network(layout);
    if roads.is_empty() {
        roads.push(on_road::nowhere(layout));
    }
    let mut on_roads = OnRoads::new(&mut roads);
    on_roads.crossings(layout);
    on_roads.stop_lines(layout);
    on_roads.signals(background);
    let header = xml::header(name, layout);
    let mut body = xml::network(&roads, &junctions, layout, &limits);
    if detail != Detail::Roads {
        // The roads as a reader sees them show which ground is missing.
        let text = format!("{header}{body}</OpenDRIVE>\n");
        if let Ok(read) = super::read(text.as_bytes()) {
            let found = read
                .to_layout_over(layout.extent(), glam::DVec2::ZERO, 0.0)
                .layout;
            OnRoads::new(&mut roads).areas(layout, &found);
            body = xml::network(&roads, &junctions, layout, &limits);
        }
    }
    let rows = match detail {
        Detail::Rows => own_rows::write(layout, &body),
        _ => String::new(),
    };
    format!("{header}{body}{rows}</OpenDRIVE>\n")
}

/// Roads and junctions of a layout.
fn network(layout: &BevLayout) -> (Vec<WrittenRoad>, Vec<WrittenJunction>) {
    let mut chains = chains::of_layout(layout);
    let mut near = Near::new(&chains);
    let mut found = grouped(layout, &chains, &near);
    let painted = middles::lanes(layout, &near, is_left_hand(&found.1));
    if !painted.is_empty() {
        chains.extend(painted);
        near = Near::new(&chains);
        found = grouped(layout, &chains, &near);
    }
    let (mut zones, bundled) = found;
    let left_hand = is_left_hand(&bundled);
    let mut roads = of_bundles(layout, &chains, &near, &bundled, left_hand);
    let next_id = roads.len() as u32 + 1;
    let mut ground = ConnectionContext {
        layout,
        chains: &chains,
        near: &near,
        zones: &mut zones,
        left_hand,
    };
    let junctions = connect::connect(&mut ground, &bundled, &mut roads, next_id);
    (roads, junctions)
}

fn grouped(layout: &BevLayout, chains: &[Chain], near: &Near) -> (Zones, Bundled) {
    let mut zones = Zones::find(layout.extent(), chains, near);
    let bundled = bundles::bundled(layout, chains, near, &mut zones);
    (zones, bundled)
}

/// One road for each bundle, with the ids from 1 on.
fn of_bundles(
    layout: &BevLayout,
    chains: &[Chain],
    near: &Near,
    bundled: &Bundled,
    left_hand: bool,
) -> Vec<WrittenRoad> {
    let extent = layout.extent();
    let mut sample_in = vec![None; extent.columns()];
    for (c, chain) in chains.iter().enumerate().filter(|(_, chain)| !chain.two_way) {
        for (k, p) in chain.points_m.iter().enumerate() {
            if let Some([x, y]) = extent.column_at(p.x, p.y) {
                sample_in[extent.index(x, y)] = Some((c, k));
            }
        }
    }
    let nearest = nearest_source(extent, |column| sample_in[column].is_some()).unwrap_or_default();
    let mut out = Vec::new();
    for (id, bundle) in bundled.bundles.iter().enumerate() {
        let is_member = |chain: usize| bundle.members.iter().any(|m| m.chain == chain);
        let first = &chains[bundle.chain];
        // Ground is a road's where one of its lanes is the nearest, in a junction too. A way of one lane has its own width alone.
        let is_own = |p: glam::DVec2| {
            if let Some(half_m) = first.half_m.filter(|_| first.two_way) {
                let mut around = near.within(p, half_m + VERGE_M);
                return around.any(|s| is_member(s.chain));
            }
            let Some([x, y]) = extent.column_at(p.x, p.y) else {
                return false;
            };
            let source = nearest.get(extent.index(x, y)).map(|c| sample_in[*c as usize]);
            let Some((chain, k)) = source.flatten() else {
                return true;
            };
            match bundled.owner[chain][k] {
                Some(owner) if owner != usize::MAX => owner == id,
                _ => is_member(chain),
            }
        };
        if let Some(mut road) = WrittenRoad::of_bundle(layout, chains, bundle, left_hand, is_own) {
            road.id = out.len() as u32 + 1;
            road.bundle = Some(id);
            out.push(road);
        }
    }
    out
}

/// True if oncoming traffic is mostly to the right.
fn is_left_hand(bundled: &Bundled) -> bool {
    let mut right_hand = 0i64;
    for bundle in &bundled.bundles {
        for pair in bundle.members.windows(2) {
            // Members run from left to right. With right-hand traffic, oncoming lanes lie to the left of the lane that
            // is driven.
            match (pair[0].along, pair[1].along) {
                (false, true) => right_hand += bundle.samples.len() as i64,
                (true, false) => right_hand -= bundle.samples.len() as i64,
                _ => {}
            }
        }
    }
    right_hand < 0
}

#[cfg(test)]
mod limits_tests;
#[cfg(test)]
mod measure;
#[cfg(test)]
mod tests;
#[cfg(test)]
pub(crate) use measure::picture;
