//! `sceneloom versions`: the versions that a scene's file keeps: listed, taken out as a scene of their own, added.

use std::path::PathBuf;
use std::sync::Arc;

use anyhow::{Context, anyhow, bail};
use serde_json::json;

use super::{CommandResult, Common, output};
use app::open;
use formats::loom;
use scene::{KeptVersion, ProjectHistory, Scene};

/// Arguments.
#[derive(clap::Args)]
pub struct VersionsCommand {
    /// Scene whose versions are meant.
    scene: PathBuf,
    /// Write this version as a scene of its own: its number, or its name.
    #[arg(long, value_name = "VERSION", requires = "output", conflicts_with = "keep")]
    take: Option<String>,
    /// Add the scene as it is as a version of this name, with a star.
    #[arg(long, value_name = "NAME", requires = "output")]
    keep: Option<String>,
    /// Scene to write with --take or --keep.
    #[arg(short, long, value_name = "S.loom")]
    output: Option<PathBuf>,
    #[command(flatten)]
    common: Common,
}

impl VersionsCommand {
    pub(super) fn run(self) -> CommandResult {
        let mut scene = open::scene(&self.scene)?;
        if self.output.is_some() && self.take.is_none() && self.keep.is_none() {
            return Err(anyhow!("-o is given without --take or --keep: a list writes no scene").into());
        }
        if let Some(name) = &self.keep {
            keep(&mut scene, name)?;
        }
        let file = self.scene.display();
        if let Some(path) = &self.output {
            match &self.take {
                None => loom::save(path, &scene)?,
                Some(wanted) => {
                    let version = find(&scene.kept, wanted).with_context(|| file.to_string())?;
                    let taken =
                        loom::from_bytes(&version.loom).with_context(|| format!("{file}: {wanted}"))?;
                    loom::save(path, &taken.with_sweeps_of(&scene))?
                }
            };
        }
        let versions = &scene.kept.versions;
        let of = |(i, v): (usize, &KeptVersion)| {
            json!({
                "number": i + 1,
                "name": v.name,
                "label": v.label,
                "note": v.said(),
                "made_with": v.made().and_then(|m| serde_json::from_str::<serde_json::Value>(m).ok()),
                "starred": v.starred,
                "bytes": v.loom.len(),
            })
        };
        let report = json!({
            "versions": versions.iter().enumerate().map(of).collect::<Vec<_>>(),
            "typed": scene.kept.typed,
            "files": self.output.iter().collect::<Vec<_>>(),
        });
        output::report(&self.common, &report, || match versions.is_empty() {
            true => "no versions".into(),
            false => {
                let line = |(i, v): (usize, &KeptVersion)| {
                    let star = if v.starred { "★" } else { " " };
                    let note = match v.said() {
                        "" => String::new(),
                        said => format!(" ({said})"),
                    };
                    format!("{:3} {star} {}{note}", i + 1, v.title())
                };
                let lines: Vec<String> = versions.iter().enumerate().map(line).collect();
                lines.join("\n")
            }
        });
        Ok(())
    }
}

/// Adds the scene to the versions; a version of that name is replaced.
fn keep(scene: &mut Scene, name: &str) -> anyhow::Result<()> {
    let name = name.trim();
    if name.is_empty() || name.chars().count() > 80 || name.contains(char::is_control) {
        bail!("the name of a version is {name:?}, expected 1 to 80 characters on one line");
    }
    let packed = loom::alone_to_bytes(scene)?;
    let kept = Arc::make_mut(&mut scene.kept);
    kept.versions.retain(|v| v.name != name);
    kept.versions.push(KeptVersion {
        name: name.to_owned(),
        label: "Kept by the command line".into(),
        note: String::new(),
        starred: true,
        loom: Arc::new(packed),
    });
    Ok(())
}

fn find<'a>(kept: &'a ProjectHistory, wanted: &str) -> anyhow::Result<&'a KeptVersion> {
    let number = wanted.parse::<usize>().ok().and_then(|n| n.checked_sub(1));
    let by_name = kept.versions.iter().rev().find(|v| v.name == wanted);
    by_name
        .or_else(|| kept.versions.get(number?))
        .with_context(|| match kept.versions.len() {
            0 => format!("no version {wanted:?}: the file keeps none"),
            n => format!("no version {wanted:?}, expected a name or 1 to {n}"),
        })
}
