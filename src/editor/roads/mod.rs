//! The road network of a scene: its changes are drawn into the layout, and painted roads are recognised as a network.

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

/// The network of a scene: its own or, if it has none, the one recognised in its layout.
pub fn network_of(scene: &Scene) -> Arc<RoadNetwork> {
    match scene.roads.is_empty() {
        true => Arc::new(recognise(&scene.canvas().layout, &RoadNetwork::default())),
        false => scene.roads.clone(),
    }
}

/// Applies a change of the network to a scene. One that changes nothing keeps the revision.
pub(crate) fn apply(scene: &mut Scene, change: &RoadChange) -> Result<(), EditError> {
    let (known, before) = (!scene.roads.is_empty(), network_of(scene));
    let sound = |net: &RoadNetwork| net.problem().map_or(Ok(()), |p| Err(EditError::BadRoads(p)));
    if *change == (RoadChange::Recognise {}) {
        let after = match known {
            true => Arc::new(recognise(&scene.canvas().layout, &before)),
            false => before,
        };
        sound(&after)?;
        if after != scene.roads {
            scene.touch();
            scene.roads = after;
        }
        return Ok(());
    }
    let after = change::changed(&before, change).map_err(EditError::BadRoads)?;
    sound(&after)?;
    let anew = match change {
        RoadChange::Redraw { id } => Some(*id),
        _ => None,
    };
    if after == *before && anew.is_none() {
        return Ok(());
    }
    scene.change_canvas(|frame| redraw::redraw(frame, &before, &after, anew));
    scene.roads = Arc::new(after);
    Ok(())
}
