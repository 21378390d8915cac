//! What a sentence leaves to be pointed at by the next: "why is nobody on the right sidewalk? Put somebody there", "the
//! sidewalk is empty. Put two children on the right one", "who is behind us? A car."

use super::super::lexicon::Sense;
use super::super::tokens::{Token, TokenKind};
use super::Talk;
use super::words::{first_noun, is, led, longest, number};

/// Words for strips that "one" may stand for.
const STRIPS: &[&str] = &[
    "lane", "sidewalk", "pavement", "roadside", "kerb", "curb", "shoulder", "footpath", "verge", "lanes", "sidewalks",
    "pavements", "roadsides",
];

/// What is left of the sentence before.
#[derive(Clone, Debug, Default)]
pub struct Left {
    /// A strip of the road.
    strip: Option<String>,
    /// A place with its preposition, if nothing was done there.
    place: Option<Vec<Token>>,
    /// It was a question.
    asked: bool,
}

impl Left {
    /// After a sentence; `quiet` if it changed nothing.
    pub fn of(tokens: &[Token], asked: bool, quiet: bool, before: Self) -> Self {
        let strip = tokens
            .iter()
            .rev()
            .find(|t| is(Some(t), STRIPS))
            .map(|t| t.text.trim_end_matches('s').to_string())
            .or(before.strip);
        let place = (0..tokens.len()).rev().find_map(|i| {
            is(tokens.get(i), &["on", "in", "at"]).then_some(())?;
            let the = usize::from(is(tokens.get(i + 1), &["the", "our", "my"]));
            let at = tokens.get(i + 1 + the..).and_then(longest)?;
            matches!(at.0, Sense::Place(..)).then(|| tokens[i..i + 1 + the + at.1].to_vec())
        });
        Self {
            strip,
            place: place.filter(|_| quiet),
            asked,
        }
    }

    /// The sentence with what it points at.
    pub fn resolved(&self, tokens: &[Token], talk: &Talk<'_>) -> Vec<Token> {
        let mut out = tokens.to_vec();
        if let Some(strip) = &self.strip
            && !out.iter().any(|t| is(Some(t), STRIPS))
            && let Some(i) = (3..out.len()).find(|i| {
                is(out.get(*i), &["one"])
                    && is(out.get(i - 1), &["left", "right", "other", "oncoming", "opposite"])
                    && is(out.get(i - 2), &["the"])
                    && is(out.get(i - 3), &["on", "in", "to", "onto", "into"])
            })
        {
            out[i].text.clone_from(strip);
        }
        let body = out.len() - usize::from(out.last().is_some_and(|t| t.kind == TokenKind::Stop));
        let fresh = out[..body]
            .iter()
            .any(|t| is(Some(t), &["a", "an", "another", "some", "somebody", "someone", "two"]) || number(t).is_some());
        if let Some(place) = &self.place
            && fresh
            && body > 1
            && is(out.get(body - 1), &["there"])
            && first_noun(&out[..body]).is_some()
        {
            out.splice(body - 1..body, place.iter().cloned());
            return out;
        }
        // the answer to a question says nothing new
        if self.asked
            && is(out.first(), &["a", "an"])
            && first_noun(&out[..body]).is_some_and(|n| n.0 < 4 && n.1 == body)
            && talk.fits(&out[1..body]) > 0
        {
            let the = led("the", &out[0], &[]);
            out.splice(0..1, the);
        }
        out
    }
}
