//! The row of the voxel tool in the table of tools.

use super::{ID, VoxelTool};
use crate::tools::{Hand, Shortcut, ToolDef, ToolGroup, ToolId, VoxelMode, VoxelVerb, When};

const fn shortcut(
    id: &'static str,
    title: &'static str,
    keys: &'static str,
    when: When,
    set: fn(&mut Hand),
) -> Shortcut {
    Shortcut {
        id,
        title,
        keys,
        when,
        set,
    }
}

fn mode(hand: &mut Hand, mode: VoxelMode) {
    (hand.tool, hand.voxel_mode) = (ID, mode);
}

fn verb(hand: &mut Hand, verb: VoxelVerb) {
    (hand.tool, hand.verb) = (ID, verb);
}

/// Its row of the table.
pub static DEF: ToolDef = ToolDef {
    id: ID,
    title: "Voxels",
    key: "B in 3D",
    icon: "voxel",
    group: ToolGroup::Scene,
    is_brush: true,
    paints: true,
    shortcuts: &[
        shortcut(
            ID.0,
            "Voxel brush (over the 3D view)",
            "B",
            When::OverSpace,
            |h| {
                h.tool = if h.tool == ID { ToolId::BRUSH } else { ID };
            },
        ),
        shortcut("voxel_attach", "Attach voxels", "T", When::Always, |h| {
            verb(h, VoxelVerb::Attach)
        }),
        shortcut("voxel_remove", "Remove voxels", "R", When::Always, |h| {
            verb(h, VoxelVerb::Remove)
        }),
        shortcut("voxel_recolour", "Recolour voxels", "Y", When::Always, |h| {
            verb(h, VoxelVerb::Recolour)
        }),
        shortcut("voxel_block", "Voxels: block", "U", When::OverSpace, |h| {
            mode(h, VoxelMode::Block)
        }),
        shortcut("voxel_row", "Voxels: row", "L", When::OverSpace, |h| {
            mode(h, VoxelMode::Row)
        }),
        shortcut("voxel_fill", "Voxels: flood", "K", When::OverSpace, |h| {
            mode(h, VoxelMode::Fill)
        }),
        shortcut("voxel_pull", "Voxels: pull a face", "P", When::OverSpace, |h| {
            mode(h, VoxelMode::Extrude)
        }),
        shortcut("voxel_wand", "Voxels: magic wand", "Shift+O", When::Always, |h| {
            mode(h, VoxelMode::Wand)
        }),
        shortcut(
            "voxels_in_box",
            "Voxels: choose in a box",
            "",
            When::Always,
            |h| mode(h, VoxelMode::ChooseBlock),
        ),
        shortcut(
            "voxels_in_sphere",
            "Voxels: choose in a sphere",
            "",
            When::Always,
            |h| mode(h, VoxelMode::ChooseSphere),
        ),
        shortcut(
            "voxels_in_lasso",
            "Voxels: choose by lasso",
            "",
            When::Always,
            |h| mode(h, VoxelMode::ChooseLasso),
        ),
        shortcut(
            "voxels_in_polygon",
            "Voxels: choose by polygon",
            "",
            When::Always,
            |h| mode(h, VoxelMode::ChoosePolygon),
        ),
        shortcut("voxel_tip", "Voxel brush: block or ball", "", When::Always, |h| {
            (h.tool, h.voxel_mode, h.voxel_tip) = (ID, VoxelMode::Brush, h.voxel_tip.other());
        }),
        shortcut(
            "symmetry",
            "Symmetry about the ego axis",
            "S",
            When::Always,
            |h| {
                h.symmetry = !h.symmetry;
            },
        ),
    ],
    make: || Box::new(VoxelTool::default()),
};
