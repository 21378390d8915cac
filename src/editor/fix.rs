//! Repairs of the findings of a scene as a plan: plain data, made without changing the scene. A repair is in the plan
//! only if it removes its finding and brings no new finding that is as bad.

use std::collections::BTreeMap;
use std::ops::ControlFlow;

use scene::{Edit, Scene, SceneRev};

use crate::apply_all;
use crate::arranged;
use crate::checks::{self, Finding, FindingKind, FindingTally, Severity, SeverityCounts, waive};

/// Rounds at most; each looks again at the findings that the repairs before it left.
const MOST_ROUNDS: usize = 8;
/// Scenes that are tried out for a plan, at most.
const MOST_TRIES: usize = 600;
/// Failed tries in a row for findings of one severity, after which the other findings of that severity are left.
const MOST_IN_VAIN: usize = 64;

/// One repair of a plan.
#[derive(Clone, Debug, PartialEq)]
pub struct Repair {
    /// Finding that it repairs, without its list of repairs.
    pub finding: Finding,
    /// Name of the repair: `Drop to the ground`.
    pub label: &'static str,
    /// The edits.
    pub edits: Vec<Edit>,
}

/// Why a finding stays as it is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Stays {
    /// Its repair would bring a finding that is as bad, or would not help.
    NoBetter,
    /// Its repair makes the map larger, which is done only if it is asked for by itself.
    AskedForAlone,
    /// Its repair would change locked parts.
    Locked,
    /// It was not tried: the planning was stopped, or there were too many repairs to try.
    NotTried,
}

/// Plan of repairs for the findings of a scene.
#[derive(Clone, Debug, PartialEq)]
pub struct RepairPlan {
    /// The state that it was made for.
    pub of: SceneRev,
    /// Repairs that are done, in order.
    pub repairs: Vec<Repair>,
    /// Findings that have a repair and stay as they are, each with the reason.
    pub stays: Vec<(Finding, Stays)>,
    /// Open findings of the checks that need no sensor, before: all of them, whether they are listed or not.
    pub before: SeverityCounts,
    /// Counts as in `before`, after the repairs.
    pub after: SeverityCounts,
    /// True if `watch` ended the planning before everything was tried.
    pub stopped: bool,
}

impl RepairPlan {
    /// All edits, to be applied as one undo step.
    pub fn edits(&self) -> Vec<Edit> {
        self.repairs
            .iter()
            .flat_map(|r| r.edits.iter().cloned())
            .collect()
    }
}

/// How far a plan is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct RepairProgress {
    /// Repairs that were decided about, in this round.
    pub decided: usize,
    /// Repairs that there are to decide about, in this round.
    pub of: usize,
    /// Repairs that are in the plan by now.
    pub kept: usize,
}

/// Asked before each scene that is tried out, which takes as long as a check; `Break` ends the planning.
pub type Watch<'a> = dyn FnMut(RepairProgress) -> ControlFlow<()> + 'a;
/// How edits are applied in the end, for example as corrections.
pub type Meaning = dyn Fn(Vec<Edit>) -> Vec<Edit>;

/// Plans repairs of these findings, and of the findings that they leave, in rounds. Waived findings and locked objects
/// are not touched. The result depends on nothing but the scene, the findings and when `watch` ends it.
pub fn plan_all(scene: &Scene, findings: &[Finding], meaning: &Meaning, watch: &mut Watch<'_>) -> RepairPlan {
    plan(scene, findings, MOST_ROUNDS, meaning, watch)
}

/// Like [`plan_all`], for these findings alone: findings that are left or new are not repaired.
pub fn plan_these(
    scene: &Scene,
    findings: &[Finding],
    meaning: &Meaning,
    watch: &mut Watch<'_>,
) -> RepairPlan {
    plan(scene, findings, 0, meaning, watch)
}

/// All repairs, with edits as they are and without a way to stop.
pub fn plan_at_once(scene: &Scene, findings: &[Finding]) -> RepairPlan {
    plan_all(
        scene,
        findings,
        &|edits| edits,
        &mut |_| ControlFlow::Continue(()),
    )
}

fn plan(
    scene: &Scene,
    findings: &[Finding],
    rounds: usize,
    meaning: &Meaning,
    watch: &mut Watch<'_>,
) -> RepairPlan {
    let (all, tally) = checks::run_counted(scene);
    let mut planning = Planning {
        scene: scene.clone(),
        tally,
        repairs: Vec::new(),
        refused: Vec::new(),
        progress: RepairProgress {
            decided: 0,
            of: 0,
            kept: 0,
        },
        tries: 0,
        in_vain: 0,
        stopped: false,
        meaning,
        watch,
    };
    let before = open_counts(scene, &all, &planning.tally);
    let asked: Vec<Finding> = waive::open(scene.frame(), findings).cloned().collect();
    let (mut todo, mut left) = (asked.clone(), None);
    for round in 0..=rounds {
        let kept = planning.repairs.len();
        planning.round(&todo);
        if planning.repairs.len() == kept {
            break;
        }
        let found = checks::run_counted(&planning.scene).0;
        todo = waive::open(planning.scene.frame(), &found).cloned().collect();
        left = Some(found);
        if planning.is_over() || round == rounds {
            break;
        }
    }
    let left = left.unwrap_or(all);
    RepairPlan {
        of: scene.rev,
        stays: planning.staying(asked, &left),
        before,
        after: open_counts(&planning.scene, &left, &planning.tally),
        stopped: planning.stopped,
        repairs: planning.repairs,
    }
}

/// The number of findings without a waiver, by severity.
fn open_counts(scene: &Scene, found: &[Finding], tally: &FindingTally) -> SeverityCounts {
    let waived = found.iter().filter(|f| waive::of(scene.frame(), f).is_some());
    let (all, waived) = (tally.counts(), SeverityCounts::from_findings(waived));
    SeverityCounts {
        errors: all.errors.saturating_sub(waived.errors),
        warnings: all.warnings.saturating_sub(waived.warnings),
        infos: all.infos.saturating_sub(waived.infos),
    }
}

/// A plan in the making.
struct Planning<'a, 'w> {
    /// The scene with the repairs so far.
    scene: Scene,
    /// Number of findings of each kind in that scene.
    tally: FindingTally,
    repairs: Vec<Repair>,
    /// Edits that were tried and are not done.
    refused: Vec<(Vec<Edit>, Stays)>,
    progress: RepairProgress,
    tries: usize,
    in_vain: usize,
    stopped: bool,
    meaning: &'a Meaning,
    watch: &'a mut Watch<'w>,
}

impl Planning<'_, '_> {
    fn is_over(&self) -> bool {
        self.stopped || self.tries >= MOST_TRIES
    }

    /// Tries the repairs of all these findings, errors first.
    fn round(&mut self, findings: &[Finding]) {
        let repairs: Vec<Repair> = findings.iter().filter_map(|f| self.repair_of(f)).collect();
        (self.progress.decided, self.progress.of) = (0, repairs.len());
        for severity in [Severity::Error, Severity::Warning] {
            let of = |r: &&Repair| r.finding.severity == severity;
            let batch: Vec<Repair> = repairs.iter().filter(of).cloned().collect();
            self.in_vain = 0;
            self.attempt(&batch);
        }
    }

    /// The repair of a finding that is worth a try.
    fn repair_of(&mut self, finding: &Finding) -> Option<Repair> {
        let fix = finding.first_fix()?;
        let edits = (self.meaning)(fix.edits.clone());
        if self.refused.iter().any(|(of, _)| *of == edits) {
            return None;
        }
        if arranged::unlocked(&self.scene, edits.clone()).0 != edits {
            self.refused.push((edits, Stays::Locked));
            return None;
        }
        Some(Repair {
            finding: Finding {
                fixes: Vec::new(),
                ..finding.clone()
            },
            label: fix.label,
            edits,
        })
    }

    /// Keeps these repairs if together they make it better; else tries each half of them by itself.
    fn attempt(&mut self, batch: &[Repair]) {
        if batch.is_empty() || self.in_vain >= MOST_IN_VAIN || self.is_over() {
            return;
        }
        self.stopped |= (self.watch)(self.progress).is_break();
        if self.stopped {
            return;
        }
        self.tries += 1;
        match self.with(batch) {
            Some((scene, tally)) => {
                (self.scene, self.tally) = (scene, tally);
                self.repairs.extend_from_slice(batch);
                self.progress.decided += batch.len();
                self.progress.kept = self.repairs.len();
                self.in_vain = 0;
            }
            None => {
                self.in_vain += 1;
                if let [one] = batch {
                    self.refused.push((one.edits.clone(), Stays::NoBetter));
                    self.progress.decided += 1;
                    return;
                }
                let (first, second) = batch.split_at(batch.len() / 2);
                self.attempt(first);
                self.attempt(second);
            }
        }
    }

    /// The scene with these repairs of one severity, and its findings; `None` unless it is better: the repaired
    /// findings are gone, and no new finding is as bad or worse.
    fn with(&self, batch: &[Repair]) -> Option<(Scene, FindingTally)> {
        let severity = batch.first()?.finding.severity;
        let edits: Vec<Edit> = batch.iter().flat_map(|r| r.edits.iter().cloned()).collect();
        let mut scene = self.scene.clone();
        apply_all(&edits, &mut scene).ok()?;
        let mut repaired = BTreeMap::<FindingKind, usize>::new();
        for Repair { finding, .. } in batch {
            *repaired
                .entry((finding.severity, finding.check, finding.box_id))
                .or_default() += 1;
        }
        let tally = checks::tally(&scene);
        let new = |(kind, n): (FindingKind, usize)| kind.0 >= severity && n > self.tally.count_of(kind);
        let gone =
            |(kind, n): (&FindingKind, &usize)| tally.count_of(*kind) + n <= self.tally.count_of(*kind);
        (!tally.iter().any(new) && repaired.iter().all(gone)).then_some((scene, tally))
    }

    /// The findings among `asked` that have a repair and are still there, each with the reason.
    fn staying(&self, asked: Vec<Finding>, left: &[Finding]) -> Vec<(Finding, Stays)> {
        let same = |a: &Finding, b: &Finding| (a.check, a.box_id, &a.text) == (b.check, b.box_id, &b.text);
        let is_done = |f: &Finding| self.repairs.iter().any(|r| same(&r.finding, f));
        let is_left = |f: &Finding| {
            let of_its_box = |l: &Finding| f.box_id.is_some() && (l.check, l.box_id) == (f.check, f.box_id);
            left.iter().any(|l| same(l, f) || of_its_box(l))
        };
        let why = |f: &Finding| match f.first_fix() {
            None => Stays::AskedForAlone,
            Some(fix) => {
                let edits = (self.meaning)(fix.edits.clone());
                let refused = self.refused.iter().rev().find(|(of, _)| *of == edits);
                refused.map_or(Stays::NotTried, |(_, why)| *why)
            }
        };
        asked
            .into_iter()
            .filter(|f| f.severity > Severity::Info && !f.fixes.is_empty())
            .filter(|f| !is_done(f) && is_left(f))
            .map(|f| (why(&f), f))
            .map(|(why, f)| (f, why))
            .collect()
    }
}

#[cfg(test)]
mod tests;
