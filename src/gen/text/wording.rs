//! Turns of speech put into plain words before a text is read: what only says how a group is ordered, what a text is for.

use std::cell::RefCell;
use std::collections::HashMap;
use std::hash::BuildHasherDefault;
use std::rc::Rc;

use super::fnv::Fnv;
use super::lexicon::{Sense, look_up};
use super::tokens::{Token, TokenKind};

/// A word that stands where another stood.
pub fn word(text: &str, at: &Token) -> Token {
    Token {
        kind: TokenKind::Word,
        text: text.to_string(),
        span: at.span,
    }
}

/// Phrases by their first word.
type Phrases = HashMap<&'static str, Vec<&'static str>, BuildHasherDefault<Fnv>>;
/// Lists by where they stand in memory.
type Lists = HashMap<(usize, usize), Rc<Phrases>, BuildHasherDefault<Fnv>>;

thread_local! {
    // every word of a text is looked for in every list: going through them took seconds for a long text
    static LISTS: RefCell<Lists> = RefCell::default();
}

fn by_first_word(phrases: &'static str) -> Phrases {
    let mut out = Phrases::default();
    for phrase in phrases.split('|') {
        let first = phrase.split(' ').next().unwrap_or(phrase);
        out.entry(first).or_default().push(phrase);
    }
    out
}

/// Length of the longest of these phrases (joined by bars) that begins the tokens.
pub fn begins(tokens: &[Token], phrases: &'static str) -> Option<usize> {
    let first = tokens.first()?.text.as_str();
    let at = (phrases.as_ptr() as usize, phrases.len());
    let list = LISTS.with(|lists| {
        let mut lists = lists.borrow_mut();
        Rc::clone(lists.entry(at).or_insert_with(|| Rc::new(by_first_word(phrases))))
    });
    list.get(first)?
        .iter()
        .filter_map(|phrase| {
            let n = phrase.split(' ').count();
            let same = tokens.len() >= n && phrase.split(' ').zip(tokens).all(|(w, t)| w == t.text);
            same.then_some(n)
        })
        .max()
}

/// Goes through the tokens once. Where `turn` finds what it looks for at a place, it puts what shall stand there at the end
/// of the tokens so far and tells where to go on; every other token is kept as it is.
pub fn rewritten(
    tokens: &[Token],
    mut turn: impl FnMut(usize, &mut Vec<Token>) -> Option<usize>,
) -> Vec<Token> {
    let mut out = Vec::with_capacity(tokens.len());
    let mut i = 0;
    while i < tokens.len() {
        match turn(i, &mut out) {
            Some(next) => i = next,
            None => {
                out.push(tokens[i].clone());
                i += 1;
            }
        }
    }
    out
}

/// Puts a phrase in the place of every one of these (joined by bars); nothing, if it is empty.
pub fn replaced(tokens: &[Token], phrases: &'static str, by: &str) -> Vec<Token> {
    rewritten(tokens, |i, out| {
        let n = begins(&tokens[i..], phrases)?;
        out.extend(by.split_whitespace().map(|w| word(w, &tokens[i])));
        Some(i + n)
    })
}

const EACH: &str = "one|each|each one|every one|each of them|one of them|one car|each car|one vehicle|each vehicle|one truck|one bus|one person";
const CLOSELY: &str = "directly|right|close|closely|just|immediately|straight|tightly|hard|waiting|standing|driving|riding|parked|walking|queueing|queuing|lined up|stacked up";
const AFTER: &str = "behind|after|following|trailing|in back of|close behind";
const NEXT: &str = "another|the other|the other one|another one|the next|the next one|the one before|the one before it|the one in front|the one ahead|the last|the previous one|the preceding one";
const TOGETHER: &str = "behind each other|behind one another|after each other|after one another|following each other|following one another|nose to tail|bumper to bumper|end to end|in a row|in single file|single file|in indian file|in one file|in a queue|in a line|in one line|in a column|in a convoy|in convoy|in a chain|in a string|in tandem|back to back|in a long line|in a long queue|one by one|in a straight line|lined up behind each other|lined up one behind the other";

/// Length of a phrase that only says that those of a group stand one behind another.
pub fn order(tokens: &[Token]) -> Option<usize> {
    if let Some(n) = begins(tokens, TOGETHER) {
        return Some(n);
    }
    let mut n = begins(tokens, EACH)?;
    n += begins(&tokens[n..], CLOSELY).unwrap_or(0);
    n += begins(&tokens[n..], AFTER)?;
    n += begins(&tokens[n..], NEXT)?;
    // "one behind the other truck" names a truck
    let noun = tokens
        .get(n)
        .is_some_and(|t| matches!(look_up(&t.text), Some(Sense::Noun(..))));
    let own = tokens[n - 1].text != "another";
    (!noun || !own && tokens[0].text != "one").then_some(n)
}

/// The words without those that only say that a group stands in a row: that is how groups are placed. A jam is left to be one.
pub fn without_order(tokens: &[Token]) -> Vec<Token> {
    let mut out: Vec<Token> = Vec::new();
    let mut i = 0;
    while i < tokens.len() {
        let jam = begins(&tokens[i..], "bumper to bumper").is_some()
            && !(out.last().is_some_and(|t| t.kind == TokenKind::Comma));
        match order(&tokens[i..]).filter(|_| !jam && !out.is_empty()) {
            Some(n) => {
                i += n;
                let ends = tokens
                    .get(i)
                    .is_none_or(|t| matches!(t.kind, TokenKind::Stop | TokenKind::Comma));
                while ends
                    && out.last().is_some_and(|t| {
                        t.kind == TokenKind::Comma || matches!(t.text.as_str(), "and" | "all")
                    })
                {
                    out.pop();
                }
                // ("two cyclists, one after the other, ride ahead of us" is one clause)
                let verb = tokens.get(i + 1).is_some_and(|t| {
                    super::said::words::is_finite(&t.text, true)
                        || matches!(t.text.as_str(), "are" | "is" | "should" | "must")
                });
                if verb && tokens.get(i).is_some_and(|t| t.kind == TokenKind::Comma) {
                    i += 1;
                }
            }
            None => {
                out.push(tokens[i].clone());
                i += 1;
            }
        }
    }
    if out.iter().any(|t| t.kind != TokenKind::Stop) {
        out
    } else {
        tokens.to_vec()
    }
}

const FACING: &str = "facing each other|facing one another|face each other|face one another|faces each other|looking at each other|looking at one another|face to face|face to face with each other|face to face with one another|face to face to each other|facing one the other|each facing the other|one facing the other|nose to nose|head to head|front to front|nose against nose|eye to eye|opposite each other|opposite one another|turned towards each other|turned to each other|turned toward each other|turned towards one another|pointing at each other|pointing towards each other|their fronts towards each other|with their fronts towards each other|vis a vis";
const FRAMES: &str = "a scene in which|the scene in which|a scene where|a scene with|a situation in which|a situation where|a scenario in which|a scenario where|a picture in which|a picture where|a setting in which|a setting where|a street on which|a moment in which|a moment when|a case in which|a case where";

/// A prompt in plain words.
pub fn prompt(tokens: &[Token]) -> Vec<Token> {
    let mut out: Vec<Token> = Vec::new();
    let tokens = super::answers::in_full(&super::common::plain(tokens));
    let tokens = super::choices::made(&super::reports::plain(&tokens));
    let tokens = super::spaces::filled(&super::people::seen(&tokens));
    let tokens = &super::turned::round(&super::plain_turns::filled(&tokens))[..];
    for sentence in tokens.split_inclusive(|t| t.kind == TokenKind::Stop) {
        out.extend(without_aim(&without_purpose(&super::titles::without(sentence))));
    }
    let out = super::inverted::ordered(&super::ellipsis::filled(&super::shares::counted(&out)));
    let out = replaced(&out, FRAMES, "");
    let out = replaced(
        &out,
        ", left and right ,|, on the left and on the right ,|, on the left and the right ,|, to the left and to the right ,",
        ",",
    );
    let out = replaced(&out, "all in all|in sum|in all", "altogether");
    let out = replaced(&out, super::order::NEAR_FIRST, "nearfirst");
    let out = replaced(&out, super::order::FAR_FIRST, "farfirst");
    let mut out = faced(&out);
    // "the lane directly to our right"
    let mut i = 1;
    while i + 2 < out.len() {
        let adverb = matches!(
            out[i].text.as_str(),
            "directly" | "immediately" | "right" | "just" | "straight" | "next"
        );
        if adverb
            && matches!(out[i - 1].text.as_str(), "lane" | "one")
            && begins(
                &out[i + 1..],
                "to our right|to our left|to my right|to my left|to the right|to the left|on our right|on our left|on my right|on my left|on the right|on the left|right of|left of",
            )
            .is_some()
        {
            out.remove(i);
        }
        // "has stopped right on the zebra"
        let led = matches!(
            out[i - 1].text.as_str(),
            "the"
                | "my"
                | "our"
                | "your"
                | "its"
                | "his"
                | "her"
                | "their"
                | "far"
                | "front"
                | "rear"
                | "on"
                | "to"
                | "turn"
                | "turns"
                | "turning"
                | "ahead"
                | "behind"
                | "left"
                | "further"
                | "and"
                | "or"
                | "of"
                | "from"
                | "lane"
        );
        if out[i].text == "right"
            && !led
            && begins(
                &out[i + 1..],
                "on the|on a|on top of|onto the|in the middle|at the|across the|on our|on my",
            )
            .is_some()
        {
            out.remove(i);
        }
        i += 1;
    }
    out
}

const ABREAST: &str = "side by side|two abreast|abreast|next to each other|next to one another|beside each other|beside one another|alongside each other|alongside one another|shoulder to shoulder|neck and neck|level with each other|level with one another|parallel to each other|one beside the other|one next to the other";

/// "facing each other" in one word, unless it is "face to face with" something.
fn faced(tokens: &[Token]) -> Vec<Token> {
    let mut out = Vec::new();
    let mut i = 0;
    while i < tokens.len() {
        let met = begins(&tokens[i..], FACING).filter(|n| {
            !tokens
                .get(i + n)
                .is_some_and(|t| matches!(t.text.as_str(), "with" | "to"))
        });
        match met {
            Some(n) => {
                out.push(word("facetoface", &tokens[i]));
                i += n;
            }
            // ("abreast of us" is a place)
            None if begins(&tokens[i..], ABREAST)
                .is_some_and(|n| begins(&tokens[i + n..], "with|of").is_none()) =>
            {
                out.push(word("sidebyside", &tokens[i]));
                i += begins(&tokens[i..], ABREAST).unwrap_or(1);
            }
            None => {
                out.push(tokens[i].clone());
                i += 1;
            }
        }
    }
    out
}

/// "bollards stand there to keep cars off the pavement": what something is to do is not in the scene.
fn without_aim(sentence: &[Token]) -> Vec<Token> {
    const AIMS: &str = "to keep|to stop|to prevent|to protect|to warn|to save|to remind|to help|in order to|so as to|to avoid|to discourage|to deter|to make sure|to ensure";
    let Some(i) = (3..sentence.len()).find(|i| begins(&sentence[*i..], AIMS).is_some()) else {
        return sentence.to_vec();
    };
    let had = sentence[..i]
        .iter()
        .any(|t| matches!(look_up(&t.text), Some(Sense::Noun(..))));
    let wish = matches!(
        sentence[i - 1].text.as_str(),
        "want"
            | "like"
            | "need"
            | "have"
            | "try"
            | "order"
            | "has"
            | "had"
            | "needs"
            | "going"
            | "about"
            | "begins"
            | "starts"
            | "supposed"
            | "ready"
            | "wants"
            | "used"
            | "waiting"
            | "waits"
            | "wait"
            | "trying"
    );
    if !had || wish {
        return sentence.to_vec();
    }
    let end = (i..sentence.len())
        .find(|k| sentence[*k].kind != TokenKind::Word && !matches!(sentence[*k].kind, TokenKind::Number(_)))
        .unwrap_or(sentence.len());
    [&sentence[..i], &sentence[end..]].concat()
}

/// "For the lesson on passing parked vehicles I need a truck": what a scene is for is not in it.
fn without_purpose(sentence: &[Token]) -> Vec<Token> {
    let lead = begins(
        sentence,
        "for|to|in order to|so that|as part of|as preparation for|in preparation for",
    );
    let Some(lead) = lead else {
        return sentence.to_vec();
    };
    // "to the left, I need a car" says where
    let place = sentence.get(lead).is_some_and(|t| {
        matches!(
            t.text.as_str(),
            "the" | "my" | "our" | "your" | "its" | "left" | "right"
        )
    });
    if place && begins(sentence, "to").is_some() {
        return sentence.to_vec();
    }
    let near = &sentence[..sentence.len().min(24)];
    let wish = (lead..near.len()).find(|i| {
        begins(
            &near[*i..],
            "i need|we need|id need|wed need|i would need|we would need|i could use|we could use|i could do with|we could do with|i want|we want|i would like|we would like|id like|i require|we require|please|give me|show me|show us|make me|create|draw|build|set up|lets have|let us have|i am looking for|im looking for",
        )
        .is_some()
    });
    let aim = begins(sentence, "for").is_none()
        || near.iter().any(|t| {
            matches!(
                t.text.as_str(),
                "lesson"
                    | "lessons"
                    | "exercise"
                    | "test"
                    | "tests"
                    | "training"
                    | "demo"
                    | "drill"
                    | "lecture"
                    | "study"
                    | "exam"
                    | "course"
                    | "class"
                    | "experiment"
                    | "report"
                    | "practice"
                    | "practising"
                    | "practicing"
                    | "case"
                    | "research"
                    | "assessment"
                    | "validation"
                    | "evaluation"
                    | "testing"
                    | "teaching"
                    | "presentation"
                    | "module"
                    | "session"
            )
        });
    match wish {
        Some(k) if aim => {
            // "For the foggy roundabout test": what it is to be like is
            let said = sentence[lead..k].iter().filter(|t| {
                matches!(
                    look_up(&t.text),
                    Some(Sense::Weather(_) | Sense::Time(_) | Sense::RoadKind(..) | Sense::Place(_, Some(_)))
                )
            });
            said.chain(&sentence[k..]).cloned().collect()
        }
        _ => sentence.to_vec(),
    }
}

#[cfg(test)]
mod tests {
    use super::super::tokens::tokens;
    use super::*;

    fn text(tokens: &[Token]) -> String {
        let words: Vec<&str> = tokens.iter().map(|t| t.text.as_str()).collect();
        words.join(" ")
    }

    #[test]
    fn a_row_is_no_further_car() {
        let row = |t: &str| text(&without_order(&tokens(t)));
        for how in [
            "one behind another",
            "one after the other",
            "nose to tail",
            "each behind the next",
            "one close behind the other",
            "bumper to bumper",
            "behind each other",
        ] {
            assert_eq!(
                row(&format!("three cars ahead of me, {how}")),
                "three cars ahead of me",
                "{how}"
            );
        }
        assert_eq!(row("one behind the other truck"), "one behind the other truck");
        assert_eq!(row("bumper to bumper traffic"), "bumper to bumper traffic");
    }

    #[test]
    fn prompts_in_plain_words() {
        let plain = |t: &str| text(&prompt(&tokens(t)));
        assert_eq!(
            plain("For the lesson on parked vehicles I need a bus"),
            "i need a bus"
        );
        assert_eq!(plain("the lane directly to our right"), "the lane to our right");
        assert_eq!(
            plain("a taxi stops right on the zebra"),
            "a taxi stops on the zebra"
        );
        assert_eq!(plain("two men facing each other"), "two men facetoface");
    }
}
