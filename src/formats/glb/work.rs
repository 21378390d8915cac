//! Cost of turning a document into voxels, told from its triangles before any voxel is made.

use glam::DVec3;
use scene::Extent;
use scene::message::quoted;

use super::document::{GltfDocument, LeftOut};
use crate::FormatError;

/// Most units of work for all triangles of a document: columns that they cover, those along their rims [`RIM`] times. A few
/// seconds, and more than 512 MiB of triangles of a decimetre need.
pub(super) const MOST_WORK: u64 = 1 << 29;
/// How much more a column on the rim of a triangle costs than one within it.
pub(super) const RIM: u64 = 4;

/// Errors where the triangles of a document would cost more than [`MOST_WORK`]; the line names the node that costs most.
/// `place` brings a triangle of a node onto the map, or is `None` for one that is not shown.
pub(super) fn check(
    document: &GltfDocument<'_>,
    cost: impl Fn(Extent, [DVec3; 3]) -> u64,
    extent: Extent,
    place: impl Fn(usize, [DVec3; 3]) -> Option<[DVec3; 3]>,
) -> Result<(), FormatError> {
    let (mut in_all, mut dearest) = (0u64, (0u64, 0usize));
    for (i, node) in document.nodes.iter().enumerate() {
        let mut own = 0u64;
        document.triangles(node, &mut LeftOut::default(), |_, corners| {
            let corners = place(i, corners);
            own = own.saturating_add(corners.map_or(0, |c| cost(extent, c)));
        })?;
        in_all = in_all.saturating_add(own);
        dearest = dearest.max((own, i));
    }
    if in_all <= MOST_WORK {
        return Ok(());
    }
    let name = quoted(&document.nodes[dearest.1].name, 40);
    Err(FormatError::new(format!(
        "triangles that cover about {in_all} columns of the map, {} of them in node {} {name:?}, expected at most {MOST_WORK}: \
         fewer large triangles over one another, or a smaller map",
        dearest.0, dearest.1
    )))
}
