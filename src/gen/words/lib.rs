//! From words to what they ask: readers turn a text into a [`Reading`](reading::Reading), plain values that know no scene;
//! the resolver finds the things that are meant in a scene and asks back; the executor carries out. `README.md` walks one
//! sentence through.

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
pub mod hear;
pub mod lexicon;
mod named;
pub mod notation;
pub mod nouns;
mod plan;
pub mod reader;
pub mod reading;
pub mod remark;
mod resolve;
pub mod stage;
pub mod tokens;

#[cfg(test)]
mod place_tests;
#[cfg(test)]
mod tests;
