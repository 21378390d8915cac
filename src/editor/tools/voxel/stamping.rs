//! Voxels that were kept, set down by a click.

use glam::DVec2;

use super::target::target;
use crate::Edit;
use crate::tools::{Act, Context, Hand, Pointer, Response, ScreenProjection, VoxelVerb};
use crate::voxel_ops::VoxelIndex;
use scene::{Class, Frame};

/// The voxels of the stamp, by class, where a press would set it down; empty where it has no place.
pub(super) fn stamp_at(
    frame: &Frame,
    hand: &Hand,
    view: &dyn ScreenProjection,
    at: DVec2,
) -> Vec<(Class, Vec<VoxelIndex>)> {
    let cell = view
        .ray(at)
        .and_then(|ray| target(frame, VoxelVerb::Attach, [1, 1], &ray).first().copied());
    cell.map_or_else(Vec::new, |cell| hand.stamp.at(frame, cell))
}

/// Sets the stamp down.
pub(super) fn stamped(cx: &Context<'_>, pointer: &Pointer) -> Response {
    if cx.hand.stamp.is_empty() {
        let text = "Choose voxels first, by wand, box, sphere or lasso, and keep them as a stamp";
        return Response::act(Act::Note(text.into()));
    }
    let parts = stamp_at(cx.frame(), cx.hand, cx.view, pointer.at);
    let edits: Vec<Edit> = parts
        .into_iter()
        .map(|(class, cells)| Edit::PaintVoxels { cells, class })
        .collect();
    match edits.is_empty() {
        true => Response::none(),
        false => Response::act(Act::Apply("Stamp voxels".into(), edits)),
    }
}
