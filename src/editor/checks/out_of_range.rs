//! Boxes that stick in the ground, hover over it, or leave the grid at its top or sides.

use super::{Context, Finding, Findings, Fix, Severity, name_of};
use crate::Edit;
use language::tf;
use scene::{Extent, SceneBox};

pub const NAME: &str = "out_of_range";
/// Allowed distance of a bottom from the ground, m: the ground is known by the column, and boxes are level.
const TOLERANCE_M: f64 = 0.6;

pub fn check(context: &Context<'_>, out: &mut Findings) {
    for b in &context.boxes {
        let ground_m = context.frame.layout.relief.height_m(b.center_m.truncate());
        let Some((severity, text, may_drop)) = problem(context.frame.extent(), b, ground_m) else {
            continue;
        };
        let dropped = b.center_m.truncate().extend(ground_m + b.size_m.z / 2.0);
        let fixes = may_drop.then(|| Fix {
            label: "Drop to the ground",
            edits: vec![Edit::MoveBox {
                id: b.id,
                center_m: Some(dropped),
                yaw_deg: None,
                size_m: None,
            }],
        });
        out.push(Finding {
            check: NAME,
            severity,
            where_m: b.center_m,
            box_id: Some(b.id),
            time_s: None,
            cells: Vec::new(),
            text,
            fixes: fixes.into_iter().collect(),
        });
    }
}

/// The problem of a box's place on ground of this height, and whether putting it on the ground helps.
fn problem(extent: Extent, b: &SceneBox, ground_m: f64) -> Option<(Severity, String, bool)> {
    let half_m = b.size_m.z / 2.0;
    let (bottom_m, top_m) = (b.center_m.z - half_m, b.center_m.z + half_m);
    let roof_m = extent.lattice().top_m();
    let fits = ground_m + b.size_m.z <= roof_m;
    let center = b.center_m;
    if extent.column_at(center.x, center.y).is_none() {
        let [x, y] = [center.x, center.y].map(|v| format!("{v:.1}"));
        let text = tf!(
            "{thing} stands outside the map, at {x}, {y} m",
            thing = name_of(b),
            x = x,
            y = y
        );
        return Some((Severity::Warning, text, false));
    }
    if top_m <= ground_m {
        return Some((
            Severity::Error,
            tf!(
                "{thing} lies under the ground, its top at {top} m",
                thing = name_of(b),
                top = format!("{top_m:.1}")
            ),
            fits,
        ));
    }
    if bottom_m >= roof_m {
        return Some((
            Severity::Error,
            tf!(
                "{thing} flies above the grid, its bottom at {bottom} m",
                thing = name_of(b),
                bottom = format!("{bottom_m:.1}")
            ),
            fits,
        ));
    }
    if top_m > roof_m {
        return Some((
            Severity::Warning,
            tf!(
                "{thing} is cut off at {limit} m, its top is at {top} m",
                thing = name_of(b),
                limit = roof_m,
                top = format!("{top_m:.1}")
            ),
            fits && bottom_m > ground_m,
        ));
    }
    let above_m = bottom_m - ground_m;
    if above_m < -TOLERANCE_M {
        return Some((
            Severity::Warning,
            tf!(
                "{thing} sticks {depth} m in the ground",
                thing = name_of(b),
                depth = format!("{:.1}", -above_m)
            ),
            fits,
        ));
    }
    (above_m > TOLERANCE_M).then(|| {
        let height = format!("{above_m:.1}");
        let text = tf!(
            "{thing} hovers {height} m above the ground",
            thing = name_of(b),
            height = height
        );
        (Severity::Warning, text, fits)
    })
}
