//! A check after a reading was carried out: its statements must hold in the resulting scene.

use super::nouns::Noun;
use super::reading::{ActKind, Amount, ObjectPhrase, Quantity, Reading};
use super::remark::Remark;
use super::resolve::words_of;
use super::stage::Stage;

/// Remarks on acts whose claims do not hold.
pub(super) fn look_again(stage: &mut Stage<'_>, reading: &Reading) {
    for (i, act) in reading.acts.iter().enumerate() {
        stage.act = i;
        match &act.what {
            ActKind::Leave { who } => who.iter().for_each(|t| spared(stage, t)),
            ActKind::Count {
                who,
                amount: Amount::To(least, most),
            } if !undone_later(reading, i) => {
                for t in who {
                    counted(stage, t, *least as usize, *most as usize);
                }
            }
            ActKind::No { who } if !undone_later(reading, i) => {
                for t in who.iter().filter(|t| !t.other) {
                    counted(stage, t, 0, 0);
                }
            }
            _ => {}
        }
    }
}

/// True if a later act adds things, so that a number need not hold in the end.
fn undone_later(reading: &Reading, i: usize) -> bool {
    let brings = |w: &ActKind| {
        matches!(
            w,
            ActKind::Add { .. } | ActKind::Replace { .. } | ActKind::Count { .. }
        )
    };
    reading.acts[i + 1..].iter().any(|a| brings(&a.what))
}

/// Adds a remark if boxes that were to stay have changed.
fn spared(stage: &mut Stage<'_>, t: &ObjectPhrase) {
    if t.other || matches!(t.noun, Noun::It | Noun::One) {
        return; // (it is no longer known which one was meant)
    }
    let now = std::mem::replace(&mut stage.boxes, stage.first.clone());
    let meant = stage.fitting(t);
    let before = std::mem::replace(&mut stage.boxes, now);
    if meant.iter().any(|id| before.get(id) != stage.boxes.get(id)) {
        stage.remark(Remark::Spared { what: words_of(t) });
    }
}

fn counted(stage: &mut Stage<'_>, t: &ObjectPhrase, least: usize, most: usize) {
    let fits = stage.fitting(&ObjectPhrase {
        quantity: Quantity::All,
        ..t.clone()
    });
    // (boxes that were to stay are not surplus)
    let spared = fits.iter().filter(|id| stage.stays.contains(id)).count();
    let (there, most) = (fits.len(), most.max(spared));
    let asked = stage.out.questions.iter().any(|q| q.act == stage.act);
    if !asked && !(least..=most).contains(&there) {
        stage.remark(Remark::TooFew {
            what: super::resolve::plural(&words_of(t)),
            found: there,
            wanted: most,
        });
    }
}
