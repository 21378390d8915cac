//! Voxels of a movable class that belong to no box.

use super::{Context, Finding, Findings, Fix, MOST, Severity, middle, removal};
use crate::Edit;
use language::{t, tf};
use scene::raster::box_cells;
use scene::{Class, infer, support};

pub const NAME: &str = "occupancy_without_box";
/// Voxels this far outside a box still belong to it, m: networks draw objects up to a voxel and a half too wide.
const MARGIN_M: f64 = 0.6;
/// Smaller groups are noise of labels, voxels.
const LEAST_VOXELS: usize = 4;
/// A group that would need more boxes is noise, and a person has to decide.
const MOST_BOXES: usize = 64;

pub fn check(context: &Context<'_>, out: &mut Findings) {
    let frame = context.frame;
    let extent = frame.extent();
    // Bit per class: columns in which it is explained by a box.
    let mut explained = vec![0u32; extent.columns()];
    for b in &context.boxes {
        box_cells(extent, b, MARGIN_M, |x, y| {
            explained[extent.index(x, y)] |= 1 << b.class.id()
        });
    }
    let mut left: Vec<Vec<[usize; 3]>> = vec![Vec::new(); Class::COUNT];
    for (x, y, z, label) in frame.occupancy.iter_set() {
        let is_object = Class::from_id(label).is_some_and(Class::is_object);
        if is_object && explained[extent.index(x, y)] >> label & 1 == 0 {
            left[label as usize].push([x, y, z]);
        }
    }
    let mut groups: Vec<(Class, Vec<[usize; 3]>)> = Vec::new();
    for class in Class::OBJECTS {
        let cells = std::mem::take(&mut left[class as usize]);
        let of_class = support::groups(extent, cells).into_iter();
        groups.extend(of_class.filter(|g| g.len() >= LEAST_VOXELS).map(|g| (class, g)));
    }
    if groups.len() > MOST {
        // The largest are listed.
        groups.sort_by_key(|(_, g)| std::cmp::Reverse(g.len()));
    }
    for (class, group) in groups {
        if out.is_full() {
            out.count((Severity::Warning, NAME, None), middle(extent, &group));
            continue;
        }
        out.push(Finding {
            check: NAME,
            severity: Severity::Warning,
            where_m: middle(extent, &group),
            box_id: None,
            time_s: None,
            cells: group.clone(),
            text: tf!(
                "{n} voxels of {class} belong to no box",
                n = group.len(),
                class = t(&class.label())
            ),
            fixes: match boxes_for(context, class, &group) {
                boxes if boxes.len() > MOST_BOXES => Vec::new(),
                edits => vec![
                    Fix {
                        label: "Add a box",
                        edits,
                    },
                    Fix {
                        label: "Remove these voxels",
                        edits: removal(frame, &group),
                    },
                ],
            },
        });
    }
}

/// Boxes around the voxels, as a correction: the voxels stay as they are.
fn boxes_for(context: &Context<'_>, class: Class, group: &[[usize; 3]]) -> Vec<Edit> {
    let found = infer::boxes_around(context.frame.extent(), class, group);
    let add = |b: scene::SceneBox| Edit::Correct {
        edit: Box::new(Edit::AddBox {
            class,
            center_m: b.center_m,
            size_m: b.size_m,
            yaw_deg: b.yaw_rad.to_degrees(),
            velocity_mps: None,
            id: Some(context.fresh_id()),
            label: Default::default(),
        }),
    };
    found.into_iter().map(add).collect()
}
