//! `prompt`: words that make a scene or change it.

use std::sync::Arc;

use anyhow::bail;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::call::Operation;
use crate::desk::{Desk, Done};
use authoring::prompting::How;
use authoring::text::{self, Edited, doubts};
use editor::Edit;
use words::account::Why;
use words::answer::sentence;
use words::hear::CheckedReading;
use words::notation;

/// Arguments of `prompt`.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct PromptCall {
    /// Content of the new scene, or changes of this one; plain English.
    text: String,
    /// Purpose of the words.
    #[serde(default)]
    make: Make,
    /// Fixes every random draw.
    #[serde(default)]
    seed: u64,
}

/// Purpose of the words.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Make {
    /// They change the scene that is there.
    #[default]
    Change,
    /// They describe a new scene, which replaces the one that is there.
    New,
}

/// Receipt of `prompt`.
#[derive(Debug, Serialize, JsonSchema)]
pub struct Prompted {
    /// Changes of the scene.
    #[serde(flatten)]
    done: Done,
    /// The answer, in a sentence.
    answer: String,
    /// Phrases, each with its effect.
    phrases: Vec<Phrase>,
    /// Phrases about things beside the road, as they were read.
    beside_the_road: Vec<String>,
    /// Words that had no effect.
    not_understood: Vec<NotUnderstood>,
    /// Questions that must be answered first: while there is one nothing changes. Say it again and name the box
    /// (`#12`).
    questions: Vec<Question>,
    /// Wishes that were not met, in words.
    shortfalls: Vec<String>,
    /// Further remarks.
    notes: Vec<String>,
    /// The whole reading in a line of notation.
    notation: String,
}

/// A phrase and what it became.
#[derive(Debug, Serialize, JsonSchema)]
pub struct Phrase {
    /// The words, if the reader knows them.
    words: Option<String>,
    /// Its effect, in words.
    became: String,
    /// How sure the reader is, 0 to 1.
    confidence: f64,
    /// Ids of boxes that it put in.
    added: Vec<u32>,
    /// Ids of boxes that it took away.
    removed: Vec<u32>,
    /// Ids of boxes that it changed.
    changed: Vec<u32>,
    /// Parts that could not be done as they were said.
    remarks: Vec<String>,
}

/// Words that had no effect.
#[derive(Debug, Serialize, JsonSchema)]
pub struct NotUnderstood {
    /// The words.
    words: String,
    /// `unknown` (in no list), `not_carried_out` (understood, and nothing of it was done) or `too_long` (not read).
    why: String,
}

/// A question that must be answered first.
#[derive(Debug, Serialize, JsonSchema)]
pub struct Question {
    /// The question.
    text: String,
    /// Objects that fit.
    candidates: Vec<Fits>,
}

/// An object that fits where one was meant.
#[derive(Debug, Serialize, JsonSchema)]
pub struct Fits {
    /// How to name it: `#12`.
    name: String,
    /// Its place, in words.
    place: String,
}

/// The receipt of a text as it was read: phrases, words that were not understood, shortfalls.
fn heard(done: Done, text: &str, heard: &CheckedReading, answer: String) -> Prompted {
    let phrases = heard.reading.acts.iter().map(|act| Phrase {
        words: act.span.map(|span| span.of(text).to_owned()),
        became: sentence(&act.what),
        confidence: act.confidence,
        added: Vec::new(),
        removed: Vec::new(),
        changed: Vec::new(),
        remarks: Vec::new(),
    });
    let missing = heard.missing.iter().map(|m| NotUnderstood {
        words: m.words.clone(),
        why: match m.why {
            Why::Unknown => "unknown",
            Why::NotCarriedOut => "not_carried_out",
            Why::TooLong => "too_long",
        }
        .to_owned(),
    });
    Prompted {
        done,
        answer,
        phrases: phrases.collect(),
        beside_the_road: heard.reading.background.iter().map(|s| s.described()).collect(),
        not_understood: missing.collect(),
        questions: Vec::new(),
        shortfalls: Vec::new(),
        notes: doubts(heard),
        notation: notation::write(&heard.reading),
    }
}

fn questions(edited: &Edited) -> Vec<Question> {
    let of_boxes = edited.outcome.questions.iter().map(|q| Question {
        text: q.text.clone(),
        candidates: q
            .candidates
            .iter()
            .map(|c| Fits {
                name: format!("#{}", c.id.0),
                place: format!("{}, {}", c.class.replace('_', " "), c.place),
            })
            .collect(),
    });
    let of_things = edited.things.questions.iter().map(|q| Question {
        text: q.text.clone(),
        candidates: q
            .candidates
            .iter()
            .map(|c| Fits {
                name: c.answer(),
                place: c.place.clone(),
            })
            .collect(),
    });
    of_boxes.chain(of_things).collect()
}

/// Name of the undo step: the words.
fn step_name(text: &str) -> String {
    let words = text.split_whitespace().collect::<Vec<_>>().join(" ");
    format!("\u{201c}{}\u{201d}", scene::message::quoted(&words, 60))
}

impl PromptCall {
    fn change(self, desk: &mut Desk) -> anyhow::Result<Prompted> {
        let scene = desk.scene()?;
        let edited = text::read_edit(&self.text, &scene, self.seed)?;
        let mut edits = edited.edits();
        let (questions, answer) = (questions(&edited), edited.answer_on(&scene));
        let done = match questions.is_empty() && !edits.is_empty() {
            true => {
                edits.push(Edit::KeepWords {
                    words: self.text.clone(),
                });
                desk.apply(step_name(&self.text), edits)?
            }
            false => desk.done(String::new(), &[scene.clone(), scene]),
        };
        let mut out = heard(done, &self.text, &edited.heard, answer);
        for (i, phrase) in out.phrases.iter_mut().enumerate() {
            if let Some(of) = edited.outcome.done.get(i) {
                phrase.added = of.added.iter().map(|id| id.0).collect();
                phrase.removed = of.removed.iter().map(|b| b.id.0).collect();
                phrase.changed = of.changed.iter().map(|id| id.0).collect();
            }
            let remarks = edited.outcome.remarks.iter().filter(|(act, _)| *act == i);
            phrase.remarks = remarks.map(|(_, r)| r.to_string()).collect();
        }
        out.questions = questions;
        out.shortfalls.clone_from(&edited.things.cannot);
        out.notes.extend(edited.things.done.iter().cloned());
        Ok(out)
    }

    fn new_scene(self, desk: &mut Desk) -> anyhow::Result<Prompted> {
        let from = desk.scene()?.content();
        let prompted = text::read(&self.text)?;
        let description = &prompted.described.description;
        let mut made = text::make(&self.text, description, self.seed, &How::default());
        made.scene.words = Arc::new(vec![self.text.clone()]);
        made.scene.name = text::title(&self.text).into();
        let shortfalls = text::shortfalls(&made.laid);
        let nodes = made.laid.graphed.nodes.clone();
        let placed = made.scene.frame().boxes.clone();
        let done = desk.put("Scene from words".into(), from, made.scene)?;
        let mut out = heard(done, &self.text, &prompted.heard, prompted.answer());
        for (i, phrase) in out.phrases.iter_mut().enumerate() {
            let objects = prompted.described.from.iter().zip(&nodes);
            let of_phrase = objects.filter(|((act, _), _)| *act == i);
            let ids = of_phrase.flat_map(|(_, ids)| ids);
            phrase.added = ids
                .copied()
                .filter(|id| placed.contains_key(&scene::BoxId(*id)))
                .collect();
            let remarks = prompted.described.remarks.iter().filter(|(act, _)| *act == i);
            phrase.remarks = remarks.map(|(_, r)| r.to_string()).collect();
        }
        out.shortfalls = shortfalls;
        out.notes.extend(made.laid.notes);
        Ok(out)
    }
}

impl Operation for PromptCall {
    const NAME: &'static str = "prompt";
    const ABOUT: &'static str = "Reads plain English and carries it out: make \"new\" builds a scene from a description (\"a T junction in the rain, two parked cars, a cyclist ahead\"), make \"change\" edits the scene that is there (\"remove the nearest car\", \"three pedestrians on the crossing\", \"at night\"). The receipt tells what each phrase became, which words had no effect, and asks if more than one thing fits. One undo step.";
    const EXAMPLE: &'static str =
        r#"{"text": "add a parked car 12 m ahead on the right", "make": "change", "seed": 0}"#;
    const CHANGES: bool = true;
    type Receipt = Prompted;

    fn run(self, desk: &mut Desk) -> anyhow::Result<Prompted> {
        if self.text.trim().is_empty() {
            bail!("text is empty, expected words that describe a scene or a change");
        }
        match self.make {
            Make::Change => self.change(desk),
            Make::New => self.new_scene(desk),
        }
    }
}
