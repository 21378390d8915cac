//! From version 6 to 7: a scene may have a road network.

use super::{Migration, MigrationChange};

pub(super) const TO_V7: Migration = Migration {
    from: 6,
    what: "the road network",
    change: MigrationChange::Added,
};
