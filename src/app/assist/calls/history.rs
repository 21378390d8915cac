//! `undo` and `redo`, and the list of steps.

use anyhow::bail;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::call::Operation;
use crate::desk::{Desk, Done};
use editor::{Document, Undone};

/// Arguments of `undo`.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Undo {
    /// How many steps.
    #[serde(default = "one")]
    #[schemars(range(min = 1, max = 1000))]
    steps: u32,
    /// In place of the last steps this one alone, by its number in `history`: later ones are applied again, and warnings name
    /// those that cannot be without it.
    #[serde(default)]
    step: Option<usize>,
}

/// Arguments of `redo`.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Redo {
    /// How many steps.
    #[serde(default = "one")]
    #[schemars(range(min = 1, max = 1000))]
    steps: u32,
}

/// Later steps that do not apply any more, named in a receipt at most.
const MOST_SKIPPED: usize = 8;

fn one() -> u32 {
    1
}

/// Arguments of `history`: none.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct History {}

/// A step of the history.
#[derive(Debug, Serialize, JsonSchema)]
pub struct Step {
    /// Its number; 0 is the state that was opened.
    step: usize,
    /// Its name.
    name: String,
    /// Maker: `user`, `assistant`, or another name; none for the state that was opened.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    author: Option<String>,
    /// True if a later step leaves it out.
    left_out: bool,
}

/// Receipt of `history`.
#[derive(Debug, Serialize, JsonSchema)]
pub struct Steps {
    /// All steps, the oldest first.
    steps: Vec<Step>,
    /// The step whose state is shown; later ones can be redone.
    shown: usize,
}

/// Receipt of `undo` and `redo`.
#[derive(Debug, Serialize, JsonSchema)]
pub struct Moved {
    /// Changes of the scene.
    #[serde(flatten)]
    done: Done,
    /// Names of the steps that were undone or redone, in that order.
    steps: Vec<String>,
}

/// One step back or forward: its name, and the later steps of others that do not apply any more. A document of a window has
/// steps of others too, which stay.
fn step(document: &mut Document, alone: bool, back: bool) -> Option<(String, Vec<String>)> {
    let plain = |name: Option<String>| name.map(|name| (name, Vec::new()));
    match (alone, back) {
        (true, true) => plain(document.undo().map(str::to_owned)),
        (true, false) => plain(document.redo().map(str::to_owned)),
        (false, false) => plain(document.redo_own()),
        (false, true) => document.undo_own().map(|undone| match undone {
            Undone::Back(name) => (name, Vec::new()),
            Undone::LeftOut(left) => (left.label, left.skipped),
        }),
    }
}

fn travel(desk: &mut Desk, steps: u32, back: bool) -> anyhow::Result<Moved> {
    if !(1..=1000).contains(&steps) {
        bail!("steps is {steps}, expected 1 to 1000");
    }
    let alone = desk.is_own();
    let ((names, skipped), states) = desk.with(move |document| {
        let (mut names, mut skipped) = (Vec::new(), Vec::new());
        for _ in 0..steps {
            match step(document, alone, back) {
                Some((name, mut lines)) => {
                    names.push(name);
                    skipped.append(&mut lines);
                }
                None => break,
            }
        }
        (names, skipped)
    })?;
    let (verb, what) = if back { ("undo", "Undo") } else { ("redo", "Redo") };
    if names.is_empty() {
        bail!("there is nothing to {verb}");
    }
    let mut done = desk.done(format!("{what} {}", names.join(", ")), &states);
    // A state that comes back was checked when it was made; the findings of one that others changed since are told.
    if skipped.is_empty() && alone {
        done.warnings.clear();
    }
    done.warnings.splice(0..0, skipped.into_iter().take(MOST_SKIPPED));
    if names.len() < steps as usize {
        let found = names.len();
        done.warnings.push(format!(
            "{found} of {steps} steps: there was nothing more to {verb}"
        ));
    }
    Ok(Moved { done, steps: names })
}

/// Leaves one step out, wherever it is.
fn leave_out(desk: &mut Desk, step: usize) -> anyhow::Result<Moved> {
    let (left, states) = desk.with(move |document| document.leave_out(step))?;
    let left = left?;
    let mut done = desk.done(format!("Leave out {}", left.label), &states);
    done.warnings
        .splice(0..0, left.skipped.into_iter().take(MOST_SKIPPED));
    let steps = vec![left.label];
    Ok(Moved { done, steps })
}

impl Operation for Undo {
    const NAME: &'static str = "undo";
    const ABOUT: &'static str = "Takes back the last change of the scene, or the last few: each call that changed it is one step. A failed call is none. In a window the changes of this session are taken back, and those of the user stay.";
    const EXAMPLE: &'static str = r#"{"steps": 1}"#;
    const CHANGES: bool = true;
    type Receipt = Moved;

    fn run(self, desk: &mut Desk) -> anyhow::Result<Moved> {
        match self.step {
            Some(step) => leave_out(desk, step),
            None => travel(desk, self.steps, true),
        }
    }
}

impl Operation for Redo {
    const NAME: &'static str = "redo";
    const ABOUT: &'static str = "Brings back what undo took away.";
    const EXAMPLE: &'static str = r#"{"steps": 1}"#;
    const CHANGES: bool = true;
    type Receipt = Moved;

    fn run(self, desk: &mut Desk) -> anyhow::Result<Moved> {
        travel(desk, self.steps, false)
    }
}

impl Operation for History {
    const NAME: &'static str = "history";
    const ABOUT: &'static str = "Lists the steps that led to the scene, with their makers: those of the file it was opened from, of this session and of a window. The file keeps them.";
    const EXAMPLE: &'static str = "{}";
    const CHANGES: bool = false;
    type Receipt = Steps;

    fn run(self, desk: &mut Desk) -> anyhow::Result<Steps> {
        desk.look(|document| {
            let line = |(step, found): (usize, editor::HistoryStep<'_>)| Step {
                step,
                name: found.label.to_owned(),
                author: found.author.map(|author| author.name().to_owned()),
                left_out: found.is_left_out,
            };
            Steps {
                steps: document
                    .history_steps()
                    .into_iter()
                    .enumerate()
                    .map(line)
                    .collect(),
                shown: document.position(),
            }
        })
    }
}
