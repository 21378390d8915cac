//! The report of `eval generation` as a table for a person: one line per figure, one column per set of scenes.

use std::fmt::Write;

use serde_json::Value;

use super::row::ROWS;
use metrics::shape::FIGURES;

/// Width of a column, and of the names before them, characters.
const COLUMN: usize = 17;
const NAME: usize = 30;

/// Figures of all rows: name, and JSON pointer into a row.
fn lines() -> Vec<(String, String)> {
    let mut out: Vec<(String, String)> = [
        ("drivable agreement", "/layout_agreement/drivable_per_frame"),
        ("vehicle agreement", "/layout_agreement/vehicles_per_frame"),
        ("told apart: patch", "/told_apart/occupancy/window"),
        ("told apart: scene", "/told_apart/occupancy/scene"),
        ("told apart: depth window", "/told_apart/depth/window"),
        ("told apart: depth, scene", "/told_apart/depth/scene"),
        ("pooled F3D", "/distances/pooled/f3d"),
        ("pooled KID", "/distances/pooled/kid"),
        ("cells Frechet", "/distances/cells/frechet"),
        ("cells kernel", "/distances/cells/kernel"),
        ("windows Frechet", "/distances/windows/frechet"),
        ("windows kernel", "/distances/windows/kernel"),
        ("findings", "/findings/all"),
        ("findings: errors", "/findings/errors"),
    ]
    .map(|(name, at)| (name.to_owned(), at.to_owned()))
    .into();
    let shapes = FIGURES
        .iter()
        .map(|(name, _)| ((*name).to_owned(), format!("/shape/{name}")));
    out.extend(shapes);
    out
}

/// Three significant digits, without an exponent.
fn number(value: f64) -> String {
    let digits = 2 - value.abs().max(1e-4).log10().floor() as i32;
    format!("{value:.*}", digits.clamp(0, 4) as usize)
}

fn cell(value: Option<&Value>) -> String {
    let mean = |v: &Value| v.as_f64().or_else(|| v.get("mean")?.as_f64());
    let of_some = |v: &&Value| v.get("n").and_then(Value::as_u64) != Some(0);
    let Some((value, mean)) = value.filter(of_some).and_then(|v| Some((v, mean(v)?))) else {
        return "-".into();
    };
    match value.get("ci95").and_then(Value::as_f64) {
        Some(half) => format!("{} ± {}", number(mean), number(half)),
        None => number(mean),
    }
}

/// The rows of these names, one column each, as lines of text.
pub fn rows_table(rows: &[&str], report: &Value) -> String {
    let mut out = format!("{:NAME$}", "");
    for name in rows {
        let _ = write!(out, " {name:>COLUMN$}");
    }
    for (name, at) in lines() {
        let _ = write!(out, "\n{name:NAME$}");
        for row in rows {
            let value = report.get("rows").and_then(|r| r.get(row)?.pointer(&at));
            let _ = write!(out, " {:>COLUMN$}", cell(value));
        }
    }
    out
}

/// The report as lines of text; figures beside the rows follow as JSON.
pub fn table(report: &Value) -> String {
    let mut out = rows_table(&ROWS.map(|(name, _)| name), report);
    for (what, at) in [
        ("same seed, other road", "same_seed_other_road_manmade_iou"),
        ("same road, other seed", "same_road_other_seed_manmade_iou"),
    ] {
        let of = |row: &str| cell(report.pointer(&format!("/background/{row}/{at}")));
        let _ = write!(
            out,
            "\nmanmade IoU, {what}: worlds {}, generated {}",
            of("worlds"),
            of("generated")
        );
    }
    let mut rest = report.clone();
    if let Some(rest) = rest.as_object_mut() {
        rest.remove("rows");
        rest.remove("background");
    }
    let rest = serde_json::to_string_pretty(&rest).unwrap_or_default();
    out + "\n" + &rest
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    #[test]
    fn every_row_and_figure_has_its_place() {
        let row = json!({
            "shape": { "roof_steps": { "mean": 0.01234, "ci95": 0.002, "n": 3 } },
            "distances": { "pooled": { "f3d": 12.345 } },
        });
        let text = table(&json!({ "rows": { "generated": row }, "steps": 20 }));
        let line = |name: &str| {
            text.lines()
                .find(|l| l.starts_with(name))
                .expect("a line")
                .to_owned()
        };
        assert!(line("roof_steps").contains("0.0123 ± 0.0020"), "{text}");
        assert!(line("pooled F3D").contains("12.3") && line("pooled KID").contains('-'));
        assert!(text.contains("\"steps\": 20") && !text.contains("\"rows\""));
        let widths: Vec<usize> = text.lines().take(5).map(|l| l.chars().count()).collect();
        assert!(widths.iter().all(|w| *w == widths[0]), "{widths:?}");
    }
}
