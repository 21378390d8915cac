//! What a sentence leaves to be pointed at by the next: "why is nobody on the right sidewalk? Put somebody there", "the
//! sidewalk is empty. Put two children on the right one", "who is behind us? A car."

use super::super::lexicon::{Sense, look_up};
use super::super::tokens::{Token, TokenKind};
use super::super::wording::{begins, rewritten};
use super::Talk;
use super::words::{first_noun, is, is_place, leads, led, longest, number};
use crate::scene::Class;

/// Words for strips that "one" may stand for.
const STRIPS: &[&str] = &[
    "lane",
    "sidewalk",
    "pavement",
    "roadside",
    "kerb",
    "curb",
    "shoulder",
    "footpath",
    "verge",
    "lanes",
    "sidewalks",
    "pavements",
    "roadsides",
];

/// What is left of the sentence before.
#[derive(Clone, Debug, Default)]
pub struct Left {
    /// A strip of the road.
    strip: Option<String>,
    /// A place with its preposition, if nothing was done there.
    place: Option<Vec<Token>>,
    /// It changed nothing.
    quiet: bool,
    /// It was a question.
    asked: bool,
    /// What it spoke of with a number, if it changed nothing: "there are two cyclists behind us".
    counted: Option<Vec<Token>>,
}

/// The number of a sentence that names nothing else: "I need four", "eight is right".
fn only_number(body: &[Token]) -> Option<&Token> {
    let small = [
        "i", "we", "need", "want", "would", "like", "should", "be", "there", "id", "make", "it", "is", "are",
        "right", "enough", "better", "fine", "correct", "ideal", "perfect", "needed", "ok", "good", "do",
        "suffice", "suffices", "please", "at", "least", "rather", "let", "us", "have", "will", "must",
        "nicer", "them", "of", "exactly", "only", "just", "in", "all", "total", "say", "the", "number",
        "but", "however", "actually", "instead", "to", "prefer", "more", "like", "see",
    ];
    let mut many = body
        .iter()
        .filter(|t| number(t).is_some() && !is(Some(t), &["a", "an"]));
    let first = many.next()?;
    let plain = body
        .iter()
        .all(|t| number(t).is_some() || t.kind == TokenKind::Comma || is(Some(t), &small));
    // ("two more" is two more)
    let more = body.iter().any(|t| t.text == "more");
    (many.next().is_none() && plain && !more).then_some(first)
}

/// "a policeman stands beside her", where nobody was named and one person is there: that one; "with them": all of several.
pub(super) fn only_person(tokens: Vec<Token>, talk: &Talk<'_>) -> Vec<Token> {
    const BY: &str = "next to|beside|behind|ahead of|in front of|near|close to|by|opposite|alongside|towards|facing|with|after|left of|right of|to the left of|to the right of";
    let people = talk
        .boxes
        .values()
        .filter(|b| b.class == Class::Pedestrian)
        .count();
    if people == 0 {
        return tokens;
    }
    let (pronouns, whom): (&[&str], _) = match people {
        1 => (&["him", "her"], "the pedestrian"),
        _ => (&["them"], "the pedestrians"),
    };
    let person = |t: &Token| matches!(look_up(&t.text), Some(Sense::Noun(n, _)) if matches!(n.classes[0], Class::Pedestrian | Class::Bicycle | Class::Motorcycle));
    let mut out = rewritten(&tokens, |i, out| {
        is(tokens.get(i), pronouns).then_some(())?;
        // ("her car" is hers)
        tokens
            .get(i + 1)
            .is_none_or(|t| t.kind != TokenKind::Word || is(Some(t), &["and", "on", "in", "too"]))
            .then_some(())?;
        let by = (1..=4.min(i)).any(|k| begins(&tokens[i - k..i], BY) == Some(k));
        let many = out.iter().filter(|t| person(t)).count();
        let new = is(
            out.first(),
            &[
                "a", "an", "another", "put", "add", "place", "park", "set", "one", "two", "three", "their",
                "his", "her",
            ],
        );
        let named = many > usize::from(new);
        (by && !named).then(|| {
            if is(out.last(), &["with"]) {
                out.pop();
                out.extend(led("next to", &tokens[i], &[]));
            }
            out.extend(led(whom, &tokens[i], &[]));
            i + 1
        })
    });
    // "their teacher stands with them": somebody new
    if out != tokens && is(out.first(), &["their", "his", "her"]) && out.get(1).is_some_and(person) {
        let new = led("add a", &out[0], &[]);
        out.splice(..1, new);
    }
    out
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
        let body = tokens.len() - usize::from(tokens.last().is_some_and(|t| t.kind == TokenKind::Stop));
        let counted = (0..body).find_map(|i| {
            let few = is(tokens.get(i), &["few", "many"]);
            (few || number(&tokens[i]).is_some()).then_some(())?;
            let (_, b) = first_noun(&tokens[i + 1..body]).filter(|x| x.0 < 3)?;
            let place = &tokens[i + 1 + b..body];
            let told = is_place(place) && !place.iter().any(|t| t.kind == TokenKind::Comma);
            Some(tokens[i + 1..i + 1 + b + if told { place.len() } else { 0 }].to_vec())
        });
        Self {
            counted: counted.filter(|_| quiet),
            quiet,
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
                    && is(
                        out.get(i - 1),
                        &["left", "right", "other", "oncoming", "opposite"],
                    )
                    && is(out.get(i - 2), &["the"])
                    && is(out.get(i - 3), &["on", "in", "to", "onto", "into"])
            })
        {
            out[i].text.clone_from(strip);
        }
        let body = out.len() - usize::from(out.last().is_some_and(|t| t.kind == TokenKind::Stop));
        let fresh = out[..body].iter().any(|t| {
            is(
                Some(t),
                &["a", "an", "another", "some", "somebody", "someone", "two"],
            ) || number(t).is_some()
        });
        if let Some(place) = &self.place
            && fresh
            && body > 1
            && is(out.get(body - 1), &["there"])
            && first_noun(&out[..body]).is_some()
        {
            out.splice(body - 1..body, place.iter().cloned());
            return out;
        }
        if let Some(np) = &self.counted
            && let Some(many) = only_number(&out[..body])
            && talk.fits(np) > 0
        {
            return led(
                "keep exactly",
                &tokens[0],
                &[std::slice::from_ref(many), np, &tokens[body..]],
            );
        }
        // "is the bus necessary? I'd prefer a truck": in its place
        if self.quiet
            && talk.last.is_some()
            && let Some(n) = leads(
                &out,
                &[
                    "id prefer",
                    "i would prefer",
                    "i prefer",
                    "id rather have",
                    "i would rather have",
                    "better",
                    "rather",
                    "id rather see",
                    "we would prefer",
                ],
            )
            && is(out.get(n), &["a", "an"])
            && first_noun(&out[n..body]).is_some_and(|x| x.0 < 4 && n + x.1 == body)
        {
            return led("replace it with", &tokens[0], &[&out[n..]]);
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
