//! Findings that the user has looked at and lives with: kept in the frame, with the reason.

use glam::DVec3;

use super::{Finding, names};
use crate::EditError;
use scene::{BoxId, Frame, Waiver};

/// Findings without a box are the same as long as they are this near, m.
const NEAR_M: f64 = 2.0;
/// Longest reason, characters.
const LONGEST: usize = 400;

/// True if the waiver is about this finding.
pub fn covers(waiver: &Waiver, finding: &Finding) -> bool {
    &*waiver.check == finding.check && waiver.box_id == finding.box_id && {
        waiver.box_id.is_some() || waiver.where_m.distance(finding.where_m) <= NEAR_M
    }
}

/// The waiver of a finding, if there is one.
pub fn of<'a>(frame: &'a Frame, finding: &Finding) -> Option<&'a Waiver> {
    frame.waivers.iter().find(|w| covers(w, finding))
}

/// Findings without a waiver.
pub fn open<'a>(frame: &'a Frame, findings: &'a [Finding]) -> impl Iterator<Item = &'a Finding> {
    findings.iter().filter(move |f| of(frame, f).is_none())
}

/// A sound waiver. Errors name what is wrong with it.
pub(crate) fn checked(
    check: &str,
    box_id: Option<BoxId>,
    where_m: DVec3,
    reason: &str,
) -> Result<Waiver, EditError> {
    if !names().any(|name| name == check) {
        return Err(EditError::BadWaiver(format!(
            "there is no check {check:?}, expected one of {}",
            names().collect::<Vec<_>>().join(", ")
        )));
    }
    if !where_m.is_finite() {
        return Err(EditError::BadWaiver("where_m is not finite".into()));
    }
    let reason: String = reason.trim().chars().take(LONGEST).collect();
    if reason.is_empty() {
        return Err(EditError::BadWaiver("a waiver needs a reason".into()));
    }
    Ok(Waiver {
        check: check.into(),
        box_id,
        where_m,
        reason: reason.into(),
    })
}
