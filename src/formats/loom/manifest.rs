//! `manifest.json`: format and version of a project file.

use serde::{Deserialize, Serialize};

use scene::message::quoted;

use super::archive::parse;
use super::migrate::Migration;
use super::{FORMAT, MANIFEST, ProjectError, VERSION};

/// The manifest as it is written.
#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Manifest {
    format: String,
    version: u32,
    /// How many frames; of versions 1 to 4 only.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(super) frames: Option<u64>,
}

impl Manifest {
    /// The manifest of the version that is written.
    pub(super) fn present() -> Self {
        Self {
            format: FORMAT.into(),
            version: VERSION,
            frames: None,
        }
    }
}

/// The part of a manifest that every version has.
#[derive(Deserialize)]
pub(super) struct AnyManifest {
    format: String,
    version: u64,
}

impl AnyManifest {
    pub(super) fn parse(bytes: &[u8]) -> Result<Self, ProjectError> {
        let any: Self = parse(MANIFEST, bytes)?;
        match any.format == FORMAT {
            true => Ok(any),
            false => Err(ProjectError::Format {
                found: quoted(&any.format, 40),
            }),
        }
    }

    /// The version, if it is the present one or `migrations` lead from it to that.
    pub(super) fn version(&self, migrations: &[Migration]) -> Result<u32, ProjectError> {
        let known = |v: &u32| *v == VERSION || migrations.iter().any(|step| step.from == *v);
        let version = u32::try_from(self.version).ok().filter(known);
        version.ok_or(ProjectError::Version { found: self.version })
    }
}
