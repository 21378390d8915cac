//! The result of placing the objects of a graph.

use scene::SceneBox;

/// Boxes that were placed, and what did not fit or hold.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Placement {
    /// Boxes; the id of each is that of its node.
    pub boxes: Vec<SceneBox>,
    /// Nodes that found no place, with the reason.
    pub left_out: Vec<(u32, String)>,
    /// Indices of statements that do not hold.
    pub unmet: Vec<usize>,
}

impl Placement {
    /// Deviation from all statements: an object left out counts as four statements that do not hold.
    pub fn cost(&self) -> usize {
        self.left_out.len() * 4 + self.unmet.len()
    }
}
