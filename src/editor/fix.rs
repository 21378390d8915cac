//! Repairs all findings that can be repaired.

use scene::{Edit, Scene};

use crate::apply_all;
use crate::checks::{self, Finding, waive};

/// The first fix of every finding that has one, as edits to be applied together. A fix that no longer applies after
/// those before it (the box is gone already) is left out, and so is that of a finding that is waived.
pub fn fix_all(scene: &Scene, findings: &[Finding]) -> Vec<Edit> {
    fix(scene, findings, MOST_ROUNDS)
}

/// The same for these findings alone: no others are repaired after them.
pub fn fix_these(scene: &Scene, findings: &[Finding]) -> Vec<Edit> {
    fix(scene, findings, 0)
}

fn fix(scene: &Scene, findings: &[Finding], rounds: usize) -> Vec<Edit> {
    let mut scratch = scene.clone();
    let mut edits = Vec::new();
    let mut fix = |findings: &[&Finding], scratch: &mut Scene| {
        for fix in findings.iter().filter_map(|f| f.fixes.first()) {
            let mut next = scratch.clone();
            if apply_all(&fix.edits, &mut next).is_ok() && next.rev != scratch.rev {
                *scratch = next;
                edits.extend(fix.edits.iter().cloned());
            }
        }
    };
    fix(
        &waive::open(scene.frame(), findings).collect::<Vec<_>>(),
        &mut scratch,
    );
    // A box that is moved out of one may come to stand in the next.
    for _ in 0..rounds {
        let left = checks::overlaps(&scratch);
        let frame = scratch.frame().clone();
        let crowded: Vec<&Finding> = waive::open(&frame, &left).collect();
        let before = scratch.rev;
        fix(&crowded, &mut scratch);
        if scratch.rev == before {
            break;
        }
    }
    edits
}

/// Times that boxes are moved apart again, at most.
pub(crate) const MOST_ROUNDS: usize = 8;
