//! `kept.json`, the versions beside it and the recording: the parts of a project that do not belong to its scene.

use std::io::{Read, Seek};
use std::sync::Arc;

use serde::{Deserialize, Serialize};

use scene::Scene;
use scene::kept::{KeptVersion, ProjectHistory};
use scene::message::{of_lines, quoted};

use super::archive::{MAX_JSON, Reader, Writer, parse, within};
use super::{LARGEST_FILE, ProjectError};
use super::{log, recording};

const KEPT: &str = "kept.json";

#[derive(Default, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
struct KeptHeader {
    #[serde(skip_serializing_if = "Vec::is_empty")]
    versions: Vec<VersionHeader>,
    #[serde(skip_serializing_if = "Vec::is_empty")]
    typed: Vec<String>,
}

#[derive(Default, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
struct VersionHeader {
    #[serde(skip_serializing_if = "String::is_empty")]
    name: String,
    label: String,
    #[serde(skip_serializing_if = "String::is_empty")]
    note: String,
    #[serde(skip_serializing_if = "std::ops::Not::not")]
    starred: bool,
}

fn entry(index: usize) -> String {
    format!("versions/{index:04}.loom")
}

fn check(versions: usize, typed: usize) -> Result<(), ProjectError> {
    within(
        "the number of versions",
        versions as u64,
        ProjectHistory::MAX_VERSIONS as u64,
    )?;
    within(
        "the number of typed lines",
        typed as u64,
        ProjectHistory::MAX_TYPED as u64,
    )
}

/// Writes nothing if nothing is kept.
pub(super) fn write(out: &mut Writer, kept: &ProjectHistory) -> Result<(), ProjectError> {
    if !kept.versions.is_empty() || !kept.typed.is_empty() {
        write_versions(out, kept)?;
    }
    recording::write(out, &kept.sweeps)?;
    log::write(out, kept)
}

fn write_versions(out: &mut Writer, kept: &ProjectHistory) -> Result<(), ProjectError> {
    check(kept.versions.len(), kept.typed.len())?;
    let version = |v: &KeptVersion| VersionHeader {
        name: v.name.clone(),
        label: v.label.clone(),
        note: v.note.clone(),
        starred: v.starred,
    };
    let header = KeptHeader {
        versions: kept.versions.iter().map(version).collect(),
        typed: kept.typed.clone(),
    };
    out.json(KEPT, &header)?;
    for (i, version) in kept.versions.iter().enumerate() {
        out.packed(&entry(i), &version.loom)?;
    }
    Ok(())
}

/// Reads the kept versions, typed texts, the recording and the log; the versions are not opened.
pub(super) fn read<R: Read + Seek>(file: &mut Reader<R>) -> Result<ProjectHistory, ProjectError> {
    let mut kept = read_versions(file)?;
    kept.sweeps = recording::read(file)?;
    log::read(file, &mut kept);
    Ok(kept)
}

fn read_versions<R: Read + Seek>(file: &mut Reader<R>) -> Result<ProjectHistory, ProjectError> {
    if !file.has(KEPT) {
        return Ok(ProjectHistory::default());
    }
    let header: KeptHeader = parse(KEPT, &file.bytes(KEPT, MAX_JSON)?)?;
    check(header.versions.len(), header.typed.len())?;
    let version = |(i, v): (usize, VersionHeader)| {
        Ok(KeptVersion {
            name: quoted(&v.name, Scene::LONGEST_NAME),
            label: quoted(&v.label, Scene::LONGEST_NAME),
            note: of_lines(&v.note),
            starred: v.starred,
            loom: Arc::new(file.bytes(&entry(i), LARGEST_FILE)?),
        })
    };
    let versions = header.versions.into_iter().enumerate().map(version);
    Ok(ProjectHistory {
        versions: versions.collect::<Result<_, ProjectError>>()?,
        typed: header.typed,
        ..ProjectHistory::default()
    })
}
