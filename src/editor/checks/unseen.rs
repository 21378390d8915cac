//! Objects that no sensor tells anything about: no pixel in any camera, no LiDAR return.

use std::collections::BTreeMap;

use super::box_without_occupancy::voxels;
use super::{Context, Finding, Findings, Severity, name_of};
use language::{filled, t};
use scene::BoxId;

pub const NO_CAMERA: &str = "unseen_by_cameras";
pub const NO_LIDAR: &str = "no_lidar_returns";

pub fn by_cameras(context: &Context<'_>, out: &mut Findings) {
    let counts = context.seen.and_then(|s| s.camera_pixels.as_ref());
    unseen(
        context,
        NO_CAMERA,
        counts,
        "{thing} is in no camera picture: hidden, too small, or out of view",
        out,
    );
}

pub fn by_lidar(context: &Context<'_>, out: &mut Findings) {
    let counts = context.seen.and_then(|s| s.lidar_returns.as_ref());
    unseen(context, NO_LIDAR, counts, "{thing} has no LiDAR return", out);
}

fn unseen(
    context: &Context<'_>,
    check: &'static str,
    counts: Option<&BTreeMap<BoxId, u32>>,
    problem: &str,
    out: &mut Findings,
) {
    let Some(counts) = counts else { return };
    for b in &context.boxes {
        // A box without voxels, or outside the grid, is another finding.
        if counts.get(&b.id).is_none_or(|n| *n == 0) && voxels(&context.frame.occupancy, b) > 0 {
            out.push(Finding {
                check,
                severity: Severity::Info,
                where_m: b.center_m,
                box_id: Some(b.id),
                time_s: None,
                cells: Vec::new(),
                text: filled(t(problem), &[("thing", &name_of(b))]),
                fixes: Vec::new(),
            });
        }
    }
}
