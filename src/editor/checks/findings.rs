//! Collected findings, with a bound on the list of each check: a scene of noise has more findings than anybody reads.
//! All of them are counted.

use std::collections::{BTreeMap, BTreeSet};

use glam::DVec3;

use super::{Finding, Severity, SeverityCounts};
use language::tf;
use scene::grid::NOT_PAINTED;
use scene::{BoxId, Recorded, Scene, VoxelPaint};

/// Findings of one check that are listed; the others are counted in one more.
pub const MOST: usize = 200;

/// Kind of a finding: severity, name of the check, box.
pub(crate) type FindingKind = (Severity, &'static str, Option<BoxId>);

/// How many findings there are of each kind, whether they are listed or not.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub(crate) struct FindingTally(BTreeMap<FindingKind, usize>);

impl FindingTally {
    /// Findings of one kind.
    pub fn count_of(&self, kind: FindingKind) -> usize {
        self.0.get(&kind).copied().unwrap_or(0)
    }

    /// Kinds that there are, and how many of each.
    pub fn iter(&self) -> impl Iterator<Item = (FindingKind, usize)> + '_ {
        self.0.iter().map(|(kind, n)| (*kind, *n))
    }

    /// How many there are of each severity.
    pub fn counts(&self) -> SeverityCounts {
        let mut out = SeverityCounts::default();
        for ((severity, ..), n) in self.iter() {
            *out.of_mut(severity) += n;
        }
        out
    }

    fn add(&mut self, kind: FindingKind, n: usize) {
        *self.0.entry(kind).or_default() += n;
    }
}

/// Collects findings check by check.
pub(super) struct Findings {
    list: Vec<Finding>,
    tally: FindingTally,
    /// Findings of each check that are listed at most.
    most: usize,
    /// Boxes that are as a recording has them: findings about them are worth knowing and no mistakes.
    recorded: BTreeSet<BoxId>,
    /// Painted voxels of a recording: findings about all its other voxels are no mistakes either.
    painted: Option<VoxelPaint>,
    /// Index of the first finding of the check that runs.
    from: usize,
    /// Findings of that check beyond those that are listed: how many, the worst of them, and where the first is.
    more: Option<(usize, Severity, DVec3)>,
}

impl Findings {
    /// Lists so many findings of each check and counts the others.
    pub fn listing(most: usize) -> Self {
        Self {
            list: Vec::new(),
            tally: FindingTally::default(),
            most,
            recorded: BTreeSet::new(),
            painted: None,
            from: 0,
            more: None,
        }
    }

    /// Like [`Self::listing`], with the recorded parts of the scene: findings about them are listed as
    /// [`Severity::Info`].
    pub fn from_scene(scene: &Scene, most: usize) -> Self {
        Self {
            recorded: Recorded::boxes_in(scene),
            painted: Recorded::painted_in(scene),
            ..Self::listing(most)
        }
    }

    /// True once the check that runs has as many findings as are listed: then [`Self::count`] is enough.
    pub fn is_full(&self) -> bool {
        self.list.len() - self.from >= self.most
    }

    /// Takes a finding in, or counts it.
    pub fn push(&mut self, finding: Finding) {
        self.push_all(finding, 1);
    }

    /// Takes in one finding that stands for `n`, or counts them.
    pub fn push_all(&mut self, mut finding: Finding, n: usize) {
        let is_measured = |painted: &VoxelPaint| {
            let mut cells = finding.cells.iter();
            !finding.cells.is_empty() && cells.all(|&[x, y, z]| painted.get(x, y, z) == NOT_PAINTED)
        };
        let is_recorded = match finding.box_id {
            Some(id) => self.is_recorded(id),
            None => self.painted.as_ref().is_some_and(is_measured),
        };
        if is_recorded {
            finding.severity = Severity::Info;
        }
        self.take(finding, n);
    }

    /// Takes in a finding about a recorded box and something that a user made; its severity stays.
    pub fn push_made(&mut self, finding: Finding) {
        self.take(finding, 1);
    }

    fn take(&mut self, finding: Finding, n: usize) {
        let kind = (finding.severity, finding.check, finding.box_id);
        match self.is_full() {
            true => (0..n).for_each(|_| self.count_as(kind, finding.where_m)),
            false => {
                self.tally.add(kind, n);
                self.list.push(finding);
            }
        }
    }

    /// Counts a finding that is not listed.
    pub fn count(&mut self, (severity, check, box_id): FindingKind, where_m: DVec3) {
        // Of voxels that are only counted it is not known which were painted.
        let is_recorded = box_id.map_or(self.painted.is_some(), |id| self.is_recorded(id));
        let severity = if is_recorded { Severity::Info } else { severity };
        self.count_as((severity, check, box_id), where_m);
    }

    fn count_as(&mut self, kind: FindingKind, where_m: DVec3) {
        self.tally.add(kind, 1);
        let severity = kind.0;
        let (n, worst, first_m) = self.more.unwrap_or((0, severity, where_m));
        self.more = Some((n + 1, worst.max(severity), first_m));
    }

    /// True for a box that is as a recording has it.
    pub fn is_recorded(&self, id: BoxId) -> bool {
        self.recorded.contains(&id)
    }

    /// Ends a check: its findings that were only counted become its last finding.
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

    /// The listed findings, errors first, and the number of all findings of each kind.
    pub fn done(mut self) -> (Vec<Finding>, FindingTally) {
        self.list.sort_by_key(|f| std::cmp::Reverse(f.severity));
        (self.list, self.tally)
    }
}
