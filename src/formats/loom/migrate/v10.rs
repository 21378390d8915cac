//! From version 10 to 11: maps of other lattices than that of Occ3D.

use super::{Migration, MigrationChange};

/// A file of version 10 names no lattice: its voxels are those of Occ3D.
pub(super) const TO_V11: Migration = Migration {
    from: 10,
    what: "voxels of any size, in up to 64 bins above one another",
    change: MigrationChange::Added,
};
