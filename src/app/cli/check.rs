//! `sceneloom check`: the quality checks of a scene, and repairs of its findings.

use std::collections::BTreeMap;
use std::path::PathBuf;
use std::time::Instant;

use anyhow::{Context, anyhow};
use serde_json::{Value, json};

use super::document;
use super::{CommandResult, Common, Moment, Stop, output};
use app::findings;
use app::open;
use app::panes;
use editor::checks::{self, Finding, SeverityCounts, waive};
use editor::fix::{self, Repair};
use scene::Scene;

/// Arguments.
#[derive(clap::Args)]
pub struct CheckArgs {
    /// Scene to check.
    scene: PathBuf,
    /// Leave out the two checks that need cameras and LiDAR.
    #[arg(long)]
    no_sensors: bool,
    /// Apply the first repair of every finding that has one and is better for it, and check again. No repair is done
    /// that brings something as bad, or that makes the map larger.
    #[arg(long, requires = "output")]
    fix: bool,
    /// Scene to write with --fix.
    #[arg(short, long, value_name = "S.loom")]
    output: Option<PathBuf>,
    #[command(flatten)]
    moment: Moment,
    #[command(flatten)]
    common: Common,
}

fn report_of(scene: &Scene, finding: &Finding) -> Value {
    let tidy = |v: f64| (v * 1000.0).round() / 1000.0 + 0.0;
    json!({
        "check": finding.check,
        "severity": finding.severity.name(),
        "where_m": finding.where_m.to_array().map(tidy),
        "time_s": finding.time_s,
        "box": finding.box_id,
        "text": finding.text,
        "waived": waive::of(scene.frame(), finding).map(|w| w.reason.to_string()),
        "fixes": finding.fixes.iter().map(|f| f.label).collect::<Vec<_>>(),
    })
}

fn repair_of(repair: &Repair) -> Value {
    json!({
        "check": repair.finding.check,
        "box": repair.finding.box_id,
        "text": repair.finding.text,
        "does": repair.label,
    })
}

impl CheckArgs {
    fn findings(&self, scene: &Scene) -> Vec<Finding> {
        match self.no_sensors {
            true => checks::run_checks(scene, None),
            false => findings::check(scene),
        }
    }

    pub(super) fn run(self) -> CommandResult {
        if self.output.is_some() && !self.fix {
            return Err(anyhow!("-o is given without --fix: check alone writes no scene").into());
        }
        let mut scene = self.moment.apply_to(open::scene(&self.scene)?)?;
        let start = Instant::now();
        let mut findings = self.findings(&scene);
        let (mut repairs, mut files) = (Vec::new(), Vec::new());
        if let Some(path) = &self.output {
            let plan = fix::plan_at_once(&scene, &findings);
            let mut document = document::opened(scene);
            document
                .apply_all("Fix findings", &plan.edits())
                .context("a fix does not apply")?;
            document::save(path, &document)?;
            scene = Scene::clone(document.settled_scene());
            findings = self.findings(&scene);
            files.push(path);
            repairs = plan.repairs;
        }
        let wall_s = start.elapsed().as_secs_f64();
        let open: Vec<Finding> = waive::open(scene.frame(), &findings).cloned().collect();
        let counts = SeverityCounts::from_findings(&open);
        let mut kinds = BTreeMap::<&str, usize>::new();
        open.iter().for_each(|f| *kinds.entry(f.check).or_default() += 1);
        let report = json!({
            "findings": findings.iter().map(|f| report_of(&scene, f)).collect::<Vec<_>>(),
            "errors": counts.errors,
            "warnings": counts.warnings,
            "infos": counts.infos,
            "kinds": kinds,
            "waived": findings.len() - open.len(),
            "fixed": repairs.len(),
            "repairs": repairs.iter().map(repair_of).collect::<Vec<_>>(),
            "files": files,
            "wall_s": wall_s,
        });
        let summary = panes::checks::in_words(counts);
        output::report(&self.common, &report, || {
            let line = |f: &Finding| {
                let p = f.where_m;
                let waived = waive::of(scene.frame(), f)
                    .map_or_else(String::new, |w| format!(" (waived: {})", w.reason));
                format!(
                    "{}: {} [{}] at {:.1}, {:.1}, {:.1} m{waived}",
                    f.severity.name(),
                    f.text,
                    f.check,
                    p.x,
                    p.y,
                    p.z
                )
            };
            match findings.is_empty() {
                true => "all is well: no check found anything".into(),
                false => findings.iter().map(line).collect::<Vec<_>>().join("\n"),
            }
        });
        match counts.errors {
            0 => Ok(()),
            _ => Err(Stop::Short(format!("{}: {summary}", self.scene.display()))),
        }
    }
}
