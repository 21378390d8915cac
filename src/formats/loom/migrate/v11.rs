//! From version 11 to 12: the sweeps that a scene was imported from.

use super::{Migration, MigrationChange};

/// A file of version 11 keeps no sweep: its points became voxels.
pub(super) const TO_V12: Migration = Migration {
    from: 11,
    what: "the recorded sweeps that a scene was imported from, byte for byte",
    change: MigrationChange::Added,
};
