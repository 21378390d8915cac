//! `undo` and `redo`.

use anyhow::bail;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::call::Operation;
use crate::desk::{Desk, Done};

/// Arguments of `undo`.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Undo {
    /// How many steps.
    #[serde(default = "one")]
    #[schemars(range(min = 1, max = 1000))]
    steps: u32,
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

fn one() -> u32 {
    1
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

fn travel(desk: &mut Desk, steps: u32, back: bool) -> anyhow::Result<Moved> {
    if !(1..=1000).contains(&steps) {
        bail!("steps is {steps}, expected 1 to 1000");
    }
    let (names, states) = desk.with(move |document| {
        let mut names = Vec::new();
        for _ in 0..steps {
            let name = if back { document.undo() } else { document.redo() };
            match name {
                Some(name) => names.push(name.to_owned()),
                None => break,
            }
        }
        names
    })?;
    let (verb, what) = if back { ("undo", "Undo") } else { ("redo", "Redo") };
    if names.is_empty() {
        bail!("there is nothing to {verb}");
    }
    let mut done = desk.done(format!("{what} {}", names.join(", ")), &states);
    // A state that comes back was checked when it was made.
    done.warnings.clear();
    if names.len() < steps as usize {
        let found = names.len();
        done.warnings.push(format!(
            "{found} of {steps} steps: there was nothing more to {verb}"
        ));
    }
    Ok(Moved { done, steps: names })
}

impl Operation for Undo {
    const NAME: &'static str = "undo";
    const ABOUT: &'static str = "Takes back the last change of the scene, or the last few: each call that changed it is one step. A failed call is none.";
    const EXAMPLE: &'static str = r#"{"steps": 1}"#;
    const CHANGES: bool = true;
    type Receipt = Moved;

    fn run(self, desk: &mut Desk) -> anyhow::Result<Moved> {
        travel(desk, self.steps, true)
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
