//! A person's marks on the variants of a batch: stars, and variants to leave out. Kept beside the variants in
//! `marks.json`.

use std::collections::BTreeSet;
use std::path::Path;

use anyhow::Context;
use serde::{Deserialize, Serialize};

use formats::{atomic, input};

const FILE: &str = "marks.json";

/// Marked variants, by number.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Marks {
    /// Starred variants, worth a second look.
    pub starred: BTreeSet<usize>,
    /// Discarded variants, to be left out by readers of the index.
    pub discarded: BTreeSet<usize>,
}

impl Marks {
    /// Reads the marks of a batch's folder; empty if there are none yet. Errors if the file cannot be read.
    pub fn read(output: &Path) -> anyhow::Result<Self> {
        let path = output.join(FILE);
        if !path.exists() {
            return Ok(Self::default());
        }
        let text = input::read_text(&path, input::LARGEST_TEXT)?;
        serde_json::from_str(&text).with_context(|| path.display().to_string())
    }

    /// Writes the marks.
    pub fn write(&self, output: &Path) -> anyhow::Result<()> {
        let path = output.join(FILE);
        atomic::write(&path, serde_json::to_string(self)?.as_bytes())
            .with_context(|| format!("write {}", path.display()))
    }

    /// Stars a variant, or takes the star away. A star takes a discarded variant back in.
    pub fn star(&mut self, variant: usize) {
        if !self.starred.remove(&variant) {
            self.starred.insert(variant);
            self.discarded.remove(&variant);
        }
    }

    /// Leaves a variant out, or takes it back in.
    pub fn discard(&mut self, variant: usize) {
        if !self.discarded.remove(&variant) {
            self.discarded.insert(variant);
            self.starred.remove(&variant);
        }
    }
}
