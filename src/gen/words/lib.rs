//! Understands texts. Two readers turn a text into a [`Reading`](reading::Reading), plain values that know no scene; the
//! resolver finds the things in the scene that the text names, and asks back if several fit; the executor makes edits or a
//! description. `README.md` follows one sentence through all of it.

pub mod account;
pub mod answer;
pub mod beside;
pub mod canonical;
pub mod carry_out;
mod check;
pub mod conditions;
pub mod describe;
pub mod grammar;
mod guess;
mod halt;
pub mod hear;
mod indefinite;
pub mod lexicon;
pub mod measure;
mod mode;
mod named;
pub mod notation;
pub mod nouns;
mod plan;
pub mod reader;
pub mod reading;
pub mod remark;
mod resolve;
pub mod slots;
pub mod stage;
pub mod tokens;

#[cfg(test)]
mod measure_tests;
#[cfg(test)]
mod place_tests;
#[cfg(test)]
mod tests;
