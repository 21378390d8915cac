//! `sceneloom check`: the quality checks of a scene, and what of it can be repaired.

use std::path::PathBuf;
use std::time::Instant;

use anyhow::{anyhow, bail};
use serde_json::{Value, json};

use super::{Common, Outcome, Stop, output};
use crate::app::{checking, open, panels};
use crate::editor::checks::{self, Finding, Severity};
use crate::formats::project;

/// Arguments.
#[derive(clap::Args)]
pub struct Check {
    /// Scene to check.
    scene: PathBuf,
    /// Leave out the two checks that need cameras and LiDAR.
    #[arg(long)]
    no_sensors: bool,
    /// Apply the first fix of every finding that has one, and check again.
    #[arg(long, requires = "output")]
    fix: bool,
    /// Scene to write with --fix.
    #[arg(short, long, value_name = "S.loom")]
    output: Option<PathBuf>,
    #[command(flatten)]
    common: Common,
}

fn report_of(finding: &Finding) -> Value {
    let tidy = |v: f64| (v * 1000.0).round() / 1000.0 + 0.0;
    json!({
        "check": finding.check,
        "severity": finding.severity.name(),
        "where_m": finding.where_m.to_array().map(tidy),
        "box": finding.box_id,
        "text": finding.text,
        "fixes": finding.fixes.iter().map(|f| f.label).collect::<Vec<_>>(),
    })
}

impl Check {
    fn findings(&self, scene: &crate::scene::Scene) -> Vec<Finding> {
        match self.no_sensors {
            true => checks::run_checks(scene, None),
            false => checking::check(scene),
        }
    }

    pub(super) fn run(self) -> Outcome {
        if self.output.is_some() && !self.fix {
            return Err(anyhow!("-o is given without --fix: check alone writes no scene").into());
        }
        let mut scene = open::scene(&self.scene)?;
        let start = Instant::now();
        let mut findings = self.findings(&scene);
        let (mut fixed, mut files) = (0, Vec::new());
        if let Some(path) = &self.output {
            let before = findings.len();
            let mut apply = || -> anyhow::Result<()> {
                for edit in checks::fix_all(&scene, &findings) {
                    if let Err(error) = edit.apply(&mut scene) {
                        bail!("a fix does not apply: {error}");
                    }
                }
                Ok(())
            };
            apply()?;
            findings = self.findings(&scene);
            fixed = before.saturating_sub(findings.len());
            project::save(path, &scene)?;
            files.push(path);
        }
        let wall_s = start.elapsed().as_secs_f64();
        let errors = findings.iter().filter(|f| f.severity == Severity::Error).count();
        let report = json!({
            "findings": findings.iter().map(report_of).collect::<Vec<_>>(),
            "errors": errors,
            "warnings": findings.len() - errors,
            "fixed": fixed,
            "files": files,
            "wall_s": wall_s,
        });
        let summary = panels::checks::summary(&findings);
        output::report(&self.common, &report, || {
            let line = |f: &Finding| {
                let p = f.where_m;
                format!(
                    "{}: {} [{}] at {:.1}, {:.1}, {:.1} m",
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
        match errors {
            0 => Ok(()),
            _ => Err(Stop::Short(format!("{}: {summary}", self.scene.display()))),
        }
    }
}
