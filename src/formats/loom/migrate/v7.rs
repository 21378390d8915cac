//! From version 7 to 8: objects may be grouped, hidden and locked.

use super::{Migration, MigrationChange};

pub(super) const TO_V8: Migration = Migration {
    from: 7,
    what: "groups, hidden and locked objects",
    change: MigrationChange::Added,
};
