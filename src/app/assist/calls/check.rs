//! `check`: the quality checks.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::call::Operation;
use crate::desk::{Desk, Done};
use app::findings;
use editor::checks::{self, Finding, SeverityCounts, waive};
use editor::fix::plan_at_once;
use scene::Scene;

/// Findings that a receipt lists at most.
const MOST_FINDINGS: usize = 200;

/// Arguments of `check`.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct CheckCall {
    /// Also look with cameras and LiDAR, which takes a few seconds.
    #[serde(default = "yes")]
    sensors: bool,
    /// Apply the first repair of each finding that has one and is better for it, as one undo step, and check again. No repair is done that brings something as bad, or that makes the map larger.
    #[serde(default)]
    fix: bool,
}

fn yes() -> bool {
    true
}

/// Receipt of `check`.
#[derive(Debug, Serialize, JsonSchema)]
pub struct Checked {
    /// Findings, errors first; at most 200.
    findings: Vec<CheckFinding>,
    /// Open findings that are errors.
    errors: usize,
    /// Open findings that are warnings.
    warnings: usize,
    /// Open findings that are worth knowing and no mistakes: boxes that no sensor sees.
    infos: usize,
    /// Findings that were waived: they may stand.
    waived: usize,
    /// Changes by the repairs, if they were asked for.
    fixed: Option<Done>,
    /// Number of the state that was checked.
    revision: u64,
}

/// A finding of a check.
#[derive(Debug, Serialize, JsonSchema)]
pub struct CheckFinding {
    /// Name of the check.
    check: String,
    /// `error`, `warning` or `info`.
    severity: String,
    /// Position, world frame, m.
    where_m: [f64; 3],
    /// Time, s; none if it is about the moment that is shown.
    time_s: Option<f64>,
    /// The box that it is about.
    #[serde(rename = "box")]
    box_id: Option<u32>,
    /// The problem, in a line.
    text: String,
    /// Why it may stand, if it was waived.
    waived: Option<String>,
    /// Names of repairs, the best first.
    fixes: Vec<String>,
}

fn found(scene: &Scene, f: &Finding) -> CheckFinding {
    let tidy = |v: f64| (v * 100.0).round() / 100.0 + 0.0;
    CheckFinding {
        check: f.check.to_owned(),
        severity: f.severity.name().to_owned(),
        where_m: f.where_m.to_array().map(tidy),
        time_s: f.time_s,
        box_id: f.box_id.map(|id| id.0),
        text: f.text.clone(),
        waived: waive::of(scene.frame(), f).map(|w| w.reason.to_string()),
        fixes: f.fixes.iter().map(|fix| fix.label.to_owned()).collect(),
    }
}

impl Operation for CheckCall {
    const NAME: &'static str = "check";
    const ABOUT: &'static str = "Runs the quality checks: boxes that overlap, float, stand off the road or against the lane, voxels without a box, boxes that no sensor sees. Call it before export. An edit `waive` lets a finding stand.";
    const EXAMPLE: &'static str = r#"{"sensors": false, "fix": false}"#;
    const CHANGES: bool = true;
    type Receipt = Checked;

    fn run(self, desk: &mut Desk) -> anyhow::Result<Checked> {
        let look = |scene: &Scene| match self.sensors {
            true => findings::check(scene),
            false => checks::run_checks(scene, None),
        };
        let mut scene = desk.scene()?;
        let mut findings = look(&scene);
        let mut fixed = None;
        if self.fix {
            let edits = plan_at_once(&scene, &findings).edits();
            if !edits.is_empty() {
                fixed = Some(desk.apply("Repair what the checks found".into(), edits)?);
                scene = desk.scene()?;
                findings = look(&scene);
            }
        }
        let open: Vec<&Finding> = waive::open(scene.frame(), &findings).collect();
        let counts = SeverityCounts::from_findings(open.iter().copied());
        let waived = findings.len() - open.len();
        Ok(Checked {
            findings: findings
                .iter()
                .take(MOST_FINDINGS)
                .map(|f| found(&scene, f))
                .collect(),
            errors: counts.errors,
            warnings: counts.warnings,
            infos: counts.infos,
            waived,
            fixed,
            revision: desk.number(scene.content()),
        })
    }
}
