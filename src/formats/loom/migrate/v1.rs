//! From version 1 to 2.

use super::{Migration, MigrationChange};

/// The step that adds background and relief. A file of version 1 has neither: nothing stands beside the roads, and the
/// ground is flat.
pub(super) const TO_V2: Migration = Migration {
    from: 1,
    what: "the background, and the relief of the ground",
    change: MigrationChange::Added,
};
