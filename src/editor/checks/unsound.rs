//! Check of contents that no scene may have: numbers that are not finite, labels outside the palette, boxes under a
//! wrong id, the same object twice.

use std::collections::BTreeMap;

use glam::DVec3;

use super::{Context, Finding, Findings, Fix, Severity, middle, name_of, removal};
use crate::Edit;
use language::{t, tf};
use scene::{BoxId, Class, SceneBox};

pub const NAME: &str = "unsound";
/// Boxes of one class whose centres, sizes and headings differ by less than this are the same object.
const SAME_M: f64 = 0.15;
const SAME_RAD: f64 = 0.1;

pub fn check(context: &Context<'_>, out: &mut Findings) {
    let frame = context.frame;
    for (id, b) in &frame.boxes {
        let problem = match b.problem() {
            None if *id == b.id => continue,
            None => tf!("box {id} is filed under id {other}", id = b.id.0, other = id.0),
            Some(problem) => problem,
        };
        let fix = ("Remove the box", Edit::RemoveBox { id: *id });
        out.push(error(b.center_m, Some(*id), problem, vec![fix]));
    }
    for (i, a) in context.boxes.iter().enumerate() {
        for b in context.boxes[i + 1..].iter().filter(|b| are_duplicates(a, b)) {
            let text = tf!(
                "{thing} is there twice, as {id} too",
                thing = name_of(a),
                id = b.id.0
            );
            let fix = ("Remove the copy", Edit::RemoveBox { id: b.id });
            out.push(error(b.center_m, Some(b.id), text, vec![fix]));
        }
    }
    for (i, line) in frame.layout.polylines.iter().enumerate() {
        if let Some(p) = line.points_m.iter().find(|p| !p.is_finite()) {
            let text = tf!(
                "polyline {i} has a vertex at {place}, expected finite numbers",
                i = i,
                place = p
            );
            out.push(error(DVec3::ZERO, None, text, Vec::new()));
        }
    }
    if !frame.time_s.is_finite() || !frame.world_from_ego.translation_m.is_finite() {
        let text = t("time or pose of the frame is not finite").to_owned();
        out.push(error(DVec3::ZERO, None, text, Vec::new()));
    }
    if let Some(problem) = context.scene.rig.problem() {
        out.push(error(
            DVec3::ZERO,
            None,
            tf!("sensors: {problem}", problem = problem),
            Vec::new(),
        ));
    }
    let mut outside: BTreeMap<u8, Vec<[usize; 3]>> = BTreeMap::new();
    for (x, y, z, label) in frame.occupancy.iter_set().filter(|(.., l)| *l > Class::FREE) {
        outside.entry(label).or_default().push([x, y, z]);
    }
    for (label, cells) in outside {
        let text = tf!(
            "{n} voxels hold label {label}, expected 0 to {most}",
            n = cells.len(),
            label = label,
            most = Class::FREE
        );
        let mut finding = error(middle(context.frame.extent(), &cells), None, text, Vec::new());
        finding.fixes.push(Fix {
            label: "Remove these voxels",
            edits: removal(frame, &cells),
        });
        out.push(finding);
    }
}

fn error(at_m: DVec3, id: Option<BoxId>, text: String, fixes: Vec<(&'static str, Edit)>) -> Finding {
    let fixes = fixes.into_iter().map(|(label, edit)| Fix {
        label,
        edits: vec![edit],
    });
    Finding {
        check: NAME,
        severity: Severity::Error,
        where_m: if at_m.is_finite() { at_m } else { DVec3::ZERO },
        box_id: id,
        time_s: None,
        cells: Vec::new(),
        text,
        fixes: fixes.collect(),
    }
}

/// True if two boxes are one object, entered twice.
pub fn are_duplicates(a: &SceneBox, b: &SceneBox) -> bool {
    let turn = (a.yaw_rad - b.yaw_rad).rem_euclid(std::f64::consts::TAU);
    a.class == b.class
        && a.center_m.distance(b.center_m) < SAME_M
        && (a.size_m - b.size_m).abs().max_element() < SAME_M
        && turn.min(std::f64::consts::TAU - turn) < SAME_RAD
}
