//! `export`: files for other programs.

use anyhow::{Context, bail};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::names;
use crate::call::Operation;
use crate::desk::Desk;
use crate::folder::FileEntry;
use app::camera_views::LidarModel;
use app::export::{ExportOptions, ExportProgress, export_all};
use formats::export::{self, Exporter};
use scene::message::quoted;

/// Arguments of `export`.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Export {
    /// Kind of file; see the description of this call.
    #[schemars(schema_with = "names::format")]
    format: String,
    /// File (with the ending of the format) or folder in the folder of this session; the usual name of the format if left out.
    #[serde(default)]
    name: Option<String>,
    /// Width and height of camera pictures, pixels.
    #[serde(default = "usual_size")]
    #[schemars(schema_with = "names::size")]
    size: [u32; 2],
    /// The LiDAR network instead of exact rays.
    #[serde(default)]
    learned_lidar: bool,
    /// Write over files that are there.
    #[serde(default)]
    replace: bool,
}

fn usual_size() -> [u32; 2] {
    [800, 450]
}

/// Receipt of `export`.
#[derive(Debug, Serialize, JsonSchema)]
pub struct Exported {
    /// The files.
    files: Vec<FileEntry>,
    /// Content of the files.
    holds: String,
    /// Content that is lost when they are read again; empty if none is.
    lost: String,
    /// Number of the state that was written.
    revision: u64,
}

/// The ending that the name of a file must have: `.npz`.
fn ending(file_name: &str) -> &str {
    file_name.find('.').map_or("", |dot| &file_name[dot..])
}

impl Export {
    /// The name of the file or folder.
    fn target(&self, format: &Exporter) -> anyhow::Result<String> {
        let Some(usual) = format.file_name else {
            return Ok(self.name.clone().unwrap_or_else(|| format.id.to_owned()));
        };
        let name = self.name.clone().unwrap_or_else(|| usual.to_owned());
        if !name.ends_with(ending(usual)) {
            let shown = quoted(&name, 60);
            bail!("name is {shown:?}, expected one that ends in {}", ending(usual));
        }
        Ok(name)
    }
}

impl Operation for Export {
    const NAME: &'static str = "export";
    const ABOUT: &'static str =
        "Writes the scene as files of another format into the folder of this session.";
    const EXAMPLE: &'static str = r#"{"format": "occ3d", "name": "labels.npz", "replace": true}"#;
    const CHANGES: bool = false;
    type Receipt = Exported;

    fn run(self, desk: &mut Desk) -> anyhow::Result<Exported> {
        let Some(format) = export::from_id(&self.format) else {
            let ids: Vec<&str> = export::all().iter().map(|f| f.id).collect();
            let shown = quoted(&self.format, 60);
            bail!("format is {shown:?}, expected one of {}", ids.join(", "));
        };
        names::check_size(self.size)?;
        let name = self.target(format)?;
        match format.file_name {
            Some(_) => desk.folder.may_write(&name, self.replace)?,
            None => desk.folder.may_write(&format!("{name}/x"), true)?,
        }
        let options = ExportOptions {
            camera_size: self.size,
            lidar: match self.learned_lidar {
                true => LidarModel::Learned,
                false => LidarModel::Recorded,
            },
            ..ExportOptions::default()
        };
        let scene = desk.scene()?;
        let staging = desk.folder.staging()?;
        let inner = staging.path().join("out");
        std::fs::create_dir(&inner).context("make a folder for new files")?;
        export_all(&scene, &[format], &options, &inner, &ExportProgress::default())?;
        let files = desk
            .folder
            .publish(&inner, (&name, format.file_name), self.replace)?;
        Ok(Exported {
            files,
            holds: format.title.to_owned(),
            lost: format.lost.to_owned(),
            revision: desk.number(scene.content()),
        })
    }
}
