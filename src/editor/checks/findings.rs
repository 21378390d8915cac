//! What the checks found, with a bound for each of them: a scene of noise has more findings than anybody reads.

use glam::DVec3;

use super::{Finding, Severity};
use language::tf;

/// Findings of one check that are listed; the others are counted in one more.
pub const MOST: usize = 200;

/// Collects findings check by check.
#[derive(Default)]
pub(super) struct Findings {
    list: Vec<Finding>,
    /// Where the findings of the check that runs begin.
    from: usize,
    /// Findings of that check beyond those that are listed: how many, the worst of them, and where the first is.
    more: Option<(usize, Severity, DVec3)>,
}

impl Findings {
    /// True once the check that runs has as many findings as are listed: then [`Self::count`] is enough.
    pub fn is_full(&self) -> bool {
        self.list.len() - self.from >= MOST
    }

    /// Takes a finding in, or counts it.
    pub fn push(&mut self, finding: Finding) {
        match self.is_full() {
            true => self.count(finding.severity, finding.where_m),
            false => self.list.push(finding),
        }
    }

    /// Counts a finding that is not listed.
    pub fn count(&mut self, severity: Severity, where_m: DVec3) {
        let (n, worst, first_m) = self.more.unwrap_or((0, severity, where_m));
        self.more = Some((n + 1, worst.max(severity), first_m));
    }

    /// Ends a check: what was only counted becomes its last finding.
    pub fn end(&mut self, check: &'static str) {
        if let Some((n, severity, where_m)) = self.more.take() {
            self.list.push(Finding {
                check,
                severity,
                where_m,
                box_id: None,
                time_s: None,
                cells: Vec::new(),
                text: tf!("and {n} more of {check}", n = n, check = check),
                fixes: Vec::new(),
            });
        }
        self.from = self.list.len();
    }

    /// All of them, errors first.
    pub fn done(mut self) -> Vec<Finding> {
        self.list.sort_by_key(|f| std::cmp::Reverse(f.severity));
        self.list
    }
}
