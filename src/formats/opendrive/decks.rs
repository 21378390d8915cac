//! Stretches of road that cross above the ground, as bridges.

use glam::DVec2;

use super::RoadNetwork;
use super::elevation::edge_heights_m;
use super::lanes::LaneGround;
use super::layout::MapCut;
use super::levels::{Off, RoadLevels, Stretch, body_edges};
use super::sampling::LaneEdges;
use super::xml::{Skipped, count};
use scene::background::Bridge;
use scene::{Form, Relief};

/// A step along a deck, m.
const STEP_M: f64 = 2.0;
/// A deck is level: one that climbs by more than twice this is several, m.
const LEVEL_M: f64 = 0.5;
/// Thickness of a deck, m.
const THICKNESS_M: f64 = 0.9;
/// Longest stretch that is followed, m.
const LONGEST_M: f64 = 2000.0;

/// One cross-section of a deck, ego frame.
struct DeckSection {
    middle_m: DVec2,
    width_m: f64,
    top_m: f64, // in the file's frame
}

/// The bridges of a window over this relief; `file_from_ego_m` is the height of the ego's ground in the file.
pub(super) fn bridges(
    network: &RoadNetwork,
    window: &MapCut,
    levels: &RoadLevels,
    relief: &Relief,
    file_from_ego_m: f64,
    skipped: &mut Skipped,
) -> Vec<Form> {
    let mut out = Vec::new();
    for stretch in &levels.stretches {
        match stretch.off {
            Off::Hidden => count(skipped, "road below the ego's road (left out there)"),
            Off::Carried => {
                for piece in pieces(network, window, stretch) {
                    let middle = &piece[piece.len() / 2];
                    let top_m = piece.iter().map(|s| s.top_m).sum::<f64>() / piece.len() as f64;
                    let bridge = Form::Bridge(Bridge {
                        points_m: piece.iter().map(|s| s.middle_m).collect(),
                        width_m: piece.iter().map(|s| s.width_m).fold(0.0, f64::max),
                        height_m: top_m - file_from_ego_m - relief.height_m(middle.middle_m),
                        thickness_m: THICKNESS_M,
                        for_vehicles: for_vehicles(network, stretch),
                    });
                    match bridge.problem() {
                        None => out.push(bridge),
                        Some(_) => count(skipped, "bridge without a usable size"),
                    }
                }
            }
        }
    }
    out
}

fn for_vehicles(network: &RoadNetwork, stretch: &Stretch) -> bool {
    let section = network.roads[stretch.road].section_at(0.5 * (stretch.from_s_m + stretch.to_s_m));
    section.is_some_and(|s| s.grounds().contains(&LaneGround::Road))
}

/// The stretch inside the window, cut where it would not be level.
fn pieces(network: &RoadNetwork, window: &MapCut, stretch: &Stretch) -> Vec<Vec<DeckSection>> {
    let road = &network.roads[stretch.road];
    let from = stretch.from_s_m.max(0.0);
    let to = stretch.to_s_m.min(road.length_m()).min(from + LONGEST_M);
    let steps = ((to - from) / STEP_M).ceil().max(1.0);
    let mut runs: Vec<Vec<DeckSection>> = vec![Vec::new()];
    for i in 0..=steps as usize {
        let s_m = from + (to - from) * i as f64 / steps;
        let cross = road.section_at(s_m).and_then(|section| {
            let [first, last] = body_edges(&section.grounds())?;
            let row = LaneEdges::at(road, section, s_m);
            let heights = edge_heights_m(&road.surface, section, &row, s_m);
            Some(DeckSection {
                middle_m: window.to_ego(row.between(first, last)),
                width_m: row.t_m[first] - row.t_m[last],
                top_m: 0.5 * (heights[first][0] + heights[last - 1][1]),
            })
        });
        let inside = |s: &DeckSection| window.holds(s.middle_m, 0.0);
        match (cross.filter(inside), runs.last_mut()) {
            (Some(cross), Some(run)) => run.push(cross),
            (None, Some(run)) if run.is_empty() => {}
            _ => runs.push(Vec::new()),
        }
    }
    let mut out = Vec::new();
    for run in runs {
        let mut piece: Vec<DeckSection> = Vec::new();
        for cross in run {
            if let Some(first) = piece.first()
                && (cross.top_m - first.top_m).abs() > 2.0 * LEVEL_M
                && piece.len() > 1
            {
                // The next piece begins where this one ends.
                let joint = piece.last().map(|s| DeckSection { ..*s });
                out.push(std::mem::replace(&mut piece, joint.into_iter().collect()));
            }
            piece.push(cross);
        }
        out.push(piece);
    }
    out.retain(|piece| piece.len() > 1);
    out
}
