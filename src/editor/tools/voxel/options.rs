//! Options of the voxel tool, and actions on chosen voxels.

use crate::tools::paints::voxel_classes;
use crate::tools::setting::{Control, NumberSlider, ToolOption};
use crate::tools::{Hand, VoxelMode, VoxelTip, VoxelVerb};
use language::tf;

/// All options of the tool.
pub(super) fn options(hand: &Hand) -> Vec<ToolOption> {
    let mut out = vec![
        ToolOption::title("Voxel brush"),
        ToolOption::segments("mode", hand.voxel_mode, &VoxelMode::ALL, 3),
    ];
    if hand.voxel_mode == VoxelMode::Brush {
        out.push(ToolOption::segments("tip", hand.voxel_tip, &VoxelTip::ALL, 2));
    }
    if matches!(hand.voxel_mode, VoxelMode::Brush | VoxelMode::Block) {
        let height = hand.voxel_height as f64;
        out.push(ToolOption::number("height", "Height, vx", height, [1.0, 16.0], 0));
    }
    out.push(ToolOption::toggle(
        "symmetry",
        hand.symmetry,
        "Symmetry about the ego axis",
        "S",
    ));
    if matches!(hand.voxel_mode, VoxelMode::ChooseLasso | VoxelMode::ChoosePolygon) {
        let hint = "The outline chooses voxels behind others, too";
        out.push(ToolOption::toggle(
            "through",
            hand.voxels_through,
            "Hidden ones, too",
            hint,
        ));
    }
    if hand.voxel_mode.chooses() {
        out.extend(chosen(hand));
    }
    if hand.voxel_mode == VoxelMode::Stamp {
        out.extend(stamp(hand));
        return out;
    }
    out.extend([
        ToolOption::segments("verb", hand.verb, &VoxelVerb::ALL, 3),
        ToolOption::gap(),
        ToolOption::new(
            "size",
            Control::Number(NumberSlider {
                title: "Size",
                label: "Voxel brush size",
                hint: "[ and ], or Ctrl+wheel",
                value: hand.voxel_size as f64,
                range: [1.0, Hand::MAX_VOXEL_SIZE as f64],
                unit: " vx",
                decimals: 0,
                logarithmic: false,
                wide: true,
            }),
        ),
        ToolOption::gap(),
    ]);
    out.push(match hand.verb {
        VoxelVerb::Remove => ToolOption::text(
            "Removes voxels in the 3D view. Painted voxels are locked: generation keeps them.",
        ),
        _ => ToolOption::new(
            "class",
            Control::Class {
                chosen: hand.voxel_class,
                classes: voxel_classes().collect(),
                verb: "Voxel",
            },
        ),
    });
    out
}

/// Actions on the chosen voxels.
fn chosen(hand: &Hand) -> [ToolOption; 2] {
    let n = hand.voxels.len();
    let text = match n {
        0 => "No voxel is chosen. Shift adds to those chosen, Ctrl takes out of them.".to_owned(),
        1 => "1 voxel chosen".to_owned(),
        n => tf!("{n} voxels chosen", n = n),
    };
    let buttons = vec![
        ToolOption::button("remove", "Remove them", "Del", n > 0),
        ToolOption::button("recolour", "Recolour them", "in the class below", n > 0),
        ToolOption::button("lock", "Lock them", "generation keeps them", n > 0),
        ToolOption::button("unlock", "Unlock them", "", n > 0),
        ToolOption::button(
            "stamp",
            "Keep as stamp",
            "set down elsewhere, as often as you like",
            n > 0,
        ),
    ];
    [ToolOption::text(text), ToolOption::new("", Control::Row(buttons))]
}

/// Actions on the stamp.
fn stamp(hand: &Hand) -> Vec<ToolOption> {
    match hand.stamp.len() {
        0 => vec![ToolOption::text(
            "Choose voxels first, by wand, box, sphere or lasso, and keep them as a stamp",
        )],
        n => vec![
            ToolOption::text(tf!("{n} voxels are set down where you click.", n = n)),
            ToolOption::button("turn_stamp", "Turn by 90°", "", true),
        ],
    }
}
