//! From version 1 to 2.

use super::{Change, Migration};

/// Both are absent in a file of version 1: nothing stands beside the roads, and the ground is flat.
pub(super) const TO_V2: Migration = Migration {
    from: 1,
    what: "the background, and the relief of the ground",
    change: Change::Added,
};
