//! `list_files`: the files of the folder.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::call::Operation;
use crate::desk::Desk;
use crate::folder::FileEntry;

/// Arguments of `list_files`: none.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct ListFiles {}

/// Receipt of `list_files`.
#[derive(Debug, Serialize, JsonSchema)]
pub struct FileList {
    /// Files of the folder and of folders in it, by name.
    files: Vec<FileEntry>,
    /// True if there are more than are listed.
    more: bool,
}

impl Operation for ListFiles {
    const NAME: &'static str = "list_files";
    const ABOUT: &'static str =
        "Lists the files in the folder of this session, the only one that calls read and write.";
    const EXAMPLE: &'static str = "{}";
    const CHANGES: bool = false;
    type Receipt = FileList;

    fn run(self, desk: &mut Desk) -> anyhow::Result<FileList> {
        let (files, more) = desk.folder.list()?;
        Ok(FileList { files, more })
    }
}
