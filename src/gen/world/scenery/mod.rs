//! Scenery, drawn from a seed as things: it follows the road and its surroundings.

mod frontage;
mod lines;
mod plants;
mod setting;
mod site;
mod structures;
mod walk;

use std::collections::BTreeMap;

use scene::draw::Draw;
use scene::{Background, BevLayout, BoxId, SceneBox};

pub use setting::{RoadsideKind, RoadsideStyle, Style};
use site::ScenerySite;
pub use site::distance_cells;

/// The background of `seed`: its style is drawn to suit the layout.
pub fn background(layout: &BevLayout, boxes: &BTreeMap<BoxId, SceneBox>, seed: u64) -> Background {
    background_of(layout, boxes, &Style::drawn(layout, seed), seed)
}

/// A background of this style; keeps clear of roads, sidewalks and boxes. Ids count from 1.
pub fn background_of(
    layout: &BevLayout,
    boxes: &BTreeMap<BoxId, SceneBox>,
    style: &Style,
    seed: u64,
) -> Background {
    let mut site = ScenerySite::new(layout, boxes, style, seed);
    // Largest first: each keeps clear of the things before it.
    structures::walls(&mut site);
    structures::bridges(&mut site, &mut Draw::new(seed, "bridges"));
    frontage::buildings(&mut site);
    lines::lines(&mut site);
    lines::posts(&mut site, &mut Draw::new(seed, "posts"));
    plants::avenues(&mut site, &mut Draw::new(seed, "avenue"));
    plants::trees(&mut site, &mut Draw::new(seed, "trees"));
    plants::shrubs(&mut site, &mut Draw::new(seed, "shrubs"));
    site.out
}

#[cfg(test)]
mod tests;
