//! From version 3 to 4.

use super::{Migration, MigrationChange};

/// Absent in a file of version 3: every frame is a window of 200 x 200 columns.
pub(super) const TO_V4: Migration = Migration {
    from: 3,
    what: "maps of another extent than the networks' window",
    change: MigrationChange::Added,
};
