//! The road network of a scene: how changes of it come into the layout, and how what is painted becomes a network.

mod add;
mod change;
mod recognise;
mod redraw;
pub mod street;
#[cfg(test)]
mod tests;
mod wish;

use std::sync::Arc;

use scene::roads::RoadChange;
use scene::{EditError, RoadNetwork, Scene};

pub use recognise::recognise;
pub use street::Street;

/// The network of a scene: its own or, if it has none, what is recognised in its layout.
pub fn network_of(scene: &Scene) -> Arc<RoadNetwork> {
    match scene.roads.is_empty() {
        true => Arc::new(recognise(&scene.canvas().layout, &RoadNetwork::default())),
        false => scene.roads.clone(),
    }
}

/// The network after a change; the layout says what is painted. Errors say what cannot be.
pub fn changed(
    before: &RoadNetwork,
    change: &RoadChange,
    layout: &scene::BevLayout,
) -> Result<RoadNetwork, EditError> {
    let after = match change {
        RoadChange::Recognise {} => recognise(layout, before),
        change => change::changed(before, change).map_err(EditError::BadRoads)?,
    };
    match after.problem() {
        Some(problem) => Err(EditError::BadRoads(problem)),
        None => Ok(after),
    }
}

/// Applies a change of the network to a scene. One that changes nothing keeps the revision.
pub(crate) fn apply(scene: &mut Scene, change: &RoadChange) -> Result<(), EditError> {
    let before = network_of(scene);
    let after = changed(&before, change, &scene.canvas().layout)?;
    let anew = match change {
        RoadChange::Redraw { id } => Some(*id),
        _ => None,
    };
    if after == *scene.roads && anew.is_none() {
        return Ok(());
    }
    if after != *before || anew.is_some() {
        scene.change_canvas(|frame| redraw::redraw(frame, &before, &after, anew));
    } else {
        scene.touch();
    }
    scene.roads = Arc::new(after);
    Ok(())
}
