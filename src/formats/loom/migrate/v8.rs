//! From version 8 to 9: things know whether they were placed.

use super::{Migration, MigrationChange};

/// In an older file no thing says so: all may have been drawn by a seed.
pub(super) const TO_V9: Migration = Migration {
    from: 8,
    what: "which things beside the roads were placed and not drawn by a seed",
    change: MigrationChange::Added,
};
