//! From version 5 to 6: a file may keep versions and typed words beside its scene.

use super::{Migration, MigrationChange};

pub(super) const TO_V6: Migration = Migration {
    from: 5,
    what: "versions and typed words beside the scene",
    change: MigrationChange::Added,
};
