//! A finding of the quality checks that the user has looked at and accepted.

use std::sync::Arc;

use glam::DVec3;
use serde::{Deserialize, Serialize};

use super::BoxId;

/// An accepted finding, and the reason why it may stay.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Waiver {
    /// Name of the check, as in reports.
    pub check: Arc<str>,
    /// The box it is about, if it is about one.
    #[serde(default, rename = "box", skip_serializing_if = "Option::is_none")]
    pub box_id: Option<BoxId>,
    /// Place of the finding, ego frame, m.
    pub where_m: DVec3,
    /// Reason why it may stay.
    pub reason: Arc<str>,
}
