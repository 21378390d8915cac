//! From version 9 to 10: the log of changes.

use super::{Migration, MigrationChange};

/// An older file has no log: its history begins when it is opened.
pub(super) const TO_V10: Migration = Migration {
    from: 9,
    what: "every change since an origin, so that undo goes on after the file is opened again",
    change: MigrationChange::Added,
};
