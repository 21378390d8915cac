//! Sentences that say how the scene shall be, or what has become of something in it, as commands. A sentence is taken out
//! of what it is wrapped in ([`frame`]), parted into clauses, and of each clause the subject ([`subject`]) and what is
//! said of it ([`predicate`]) are told apart; what follows for the scene stands in [`acts`]. Who is meant is decided by
//! what the scene holds. Clauses that are none of this are left to the grammar of imperatives.

mod acts;
mod frame;
mod predicate;
mod subject;
mod swap;
mod words;

use std::collections::BTreeMap;

use super::edit_command::{parse, target_part};
use super::edit_grammar::{Back, Command};
use super::lanes::LaneMap;
use super::lexicon::{Sense, look_up};
use super::select::fitting;
use super::tag::tag;
use super::tokens::{Span, Token, TokenKind};
use super::words::edits::Verb;
use crate::scene::{BoxId, SceneBox};
use frame::unwrapped;
use predicate::{in_place, parts};
use subject::{Kind, Subject, subject};
use words::{HELPERS, find, first_noun, has_noun, is, is_place, leads, led, number, text, trimmed};

/// What a sentence is read with.
pub struct Talk<'a> {
    pub text: &'a str,
    pub map: &'a LaneMap<'a>,
    pub boxes: &'a BTreeMap<BoxId, SceneBox>,
    /// A word for what was spoken of last.
    pub last: Option<String>,
    /// The clause before moves something: its verb may hold for the next.
    pub carried: bool,
    /// The sentence speaks of "the other" of several, too.
    pub others: bool,
}

impl Talk<'_> {
    /// How many boxes of the scene fit these words.
    pub fn fits(&self, np: &[Token]) -> usize {
        let (_, mentions) = parse(self.text, &tag(np));
        let Some(m) = mentions.iter().find(|m| !m.is_anchor && !m.gone) else {
            return 0;
        };
        fitting(self.map, self.boxes, m, &mentions).len()
    }

    /// A noun for a pronoun.
    fn stand_in(&self, s: &Subject) -> Option<String> {
        match s.kind {
            Kind::Back(Back::Person) => Some(self.last.clone().unwrap_or_else(|| "pedestrian".into())),
            Kind::Back(_) => self.last.clone(),
            _ => None,
        }
    }
}

/// One command of a sentence, or words for the grammar of imperatives.
pub enum Piece {
    /// A command with the noun that "it" will mean.
    Meant(Box<Command>, Option<Vec<Token>>),
    /// Left to others.
    Plain(Vec<Token>),
}

/// Reads a sentence with its stop.
pub fn said(sentence: &[Token], talk: &Talk<'_>) -> Vec<Piece> {
    let plain = || vec![Piece::Plain(sentence.to_vec())];
    let Some((stop, body)) = sentence.split_last().map(|(last, body)| {
        if last.kind == TokenKind::Stop {
            (Some(last), body)
        } else {
            (None, sentence)
        }
    }) else {
        return Vec::new();
    };
    if body.is_empty() {
        return Vec::new();
    }
    let asked = stop.is_some_and(|s| talk.text.get(s.span.start..s.span.end) == Some("?"));
    if asked && let Some(found) = question(body, talk) {
        return found;
    }
    if let Some(c) = swap::swap(body, talk) {
        return vec![Piece::Meant(Box::new(c), None)];
    }
    // people are on foot anyhow; "the one behind me" is something
    let body = &with_ones(&without_feet(body))[..];
    let mut out: Vec<Piece> = Vec::new();
    let mut understood = false;
    let others = find(body, &["the other", "the others", "the rest", "the remaining"]).is_some();
    let mut before: Option<String> = talk.last.clone();
    let parted = clauses(body, talk);
    let mut lead: Option<Token> = None;
    for clause in parted {
        // "put the truck on the left and the car on the right"
        let mut clause = clause.to_vec();
        let bare = is(clause.first(), &["the", "that", "both", "my"])
            && first_noun(&clause).is_some_and(|n| n.0 < 4 && is_place(&clause[n.1..]))
            && !clause
                .iter()
                .any(|t| HELPERS.contains(&text(t)) || words::is_finite(text(t), false));
        if let (true, Some(verb)) = (bare, &lead) {
            clause.insert(0, verb.clone());
        }
        let verb = unwrapped(&clause).0.first().cloned();
        lead = verb.filter(|v| {
            matches!(
                text(v),
                "put" | "move" | "place" | "set" | "bring" | "shift" | "send"
            )
        });
        let clause = &clause[..];
        let talk = Talk {
            last: before.clone(),
            others,
            ..*talk
        };
        match clause_of(clause, &talk) {
            Some(found) => {
                understood = true;
                out.extend(found);
            }
            None => {
                let mut tokens = clause.to_vec();
                tokens.push(Token {
                    kind: TokenKind::Stop,
                    ..words::word(".", &clause[clause.len() - 1])
                });
                out.push(Piece::Plain(tokens));
            }
        }
        if let Some((a, b)) = first_noun(clause) {
            let run: Vec<&str> = clause[a..b].iter().map(text).collect();
            before = Some(run.join(" "));
        }
    }
    // who is gone and then is elsewhere has only left where he was
    for i in 0..out.len() {
        let elsewhere = out[i + 1..].iter().any(|p| matches!(p, Piece::Meant(c, _) if c.back.is_some_and(|b| b != Back::Others) && matches!(c.verb, Verb::Move | Verb::Turn | Verb::Make | Verb::Replace)));
        if let (true, Piece::Meant(c, _)) = (elsewhere, &mut out[i])
            && c.verb == Verb::Remove
        {
            c.verb = Verb::Note;
        }
    }
    if understood { out } else { plain() }
}

/// "the one behind me", "what's behind me" as "the object behind me".
fn with_ones(body: &[Token]) -> Vec<Token> {
    let mut out = body.to_vec();
    // "the driver of the bus", "the bus driver": the bus
    if let Some((i, n)) = find(
        &out,
        &[
            "the driver of",
            "the person driving",
            "the driver in",
            "the man driving",
            "the woman driving",
        ],
    ) {
        out.drain(i..i + n);
    }
    let mut i = 1;
    while i < out.len() {
        let vehicle =
            matches!(look_up(text(&out[i - 1])), Some(Sense::Noun(n, _)) if n.classes[0].is_vehicle());
        if vehicle && is(out.get(i), &["driver", "drivers"]) {
            out.remove(i);
        }
        // "the car in the right one": lane
        let side = is(
            out.get(i - 1),
            &["left", "right", "other", "oncoming", "opposite", "hand"],
        );
        let place = out[..i].iter().rev().find(|t| {
            matches!(
                text(t),
                "lane" | "sidewalk" | "pavement" | "side" | "kerb" | "curb" | "roadside" | "shoulder"
            )
        });
        if let (true, true, Some(place)) = (side, is(out.get(i), &["one"]), place.cloned()) {
            out[i] = words::word(text(&place), &out[i].clone());
        }
        i += 1;
    }
    let mut i = 0;
    while i + 1 < out.len() {
        let the = is(out.get(i), &["the", "that", "this"]) && is(out.get(i + 1), &["one", "ones"]);
        let more = out.get(i + 2..).unwrap_or(&[]);
        let told = is_place(more) || is(more.first(), &["that", "which", "who"]);
        let first = i == 0 || words::trimmed(&out[..i]).is_empty();
        if the && told && first {
            out[i + 1] = words::word("object", &out[i + 1].clone());
        }
        let what = first
            && (is(out.get(i), &["whats"])
                || is(out.get(i), &["what", "whatever", "whoever"])
                    && is(out.get(i + 1), &["is", "drives", "stands", "comes"]));
        if what {
            let n = if text(&out[i]) == "whats" { 1 } else { 2 };
            let later = out[i + n..].iter().any(|t| HELPERS.contains(&text(t)));
            if later && is_place(&out[i + n..]) {
                let the = led("the object", &out[i].clone(), &[]);
                out.splice(i..i + n, the);
            }
        }
        i += 1;
    }
    out
}

/// The words without "on foot" and "who is on foot".
fn without_feet(body: &[Token]) -> Vec<Token> {
    let Some((i, n)) = find(
        body,
        &[
            "who is on foot",
            "who are on foot",
            "that is on foot",
            "that are on foot",
            "on foot",
        ],
    ) else {
        return body.to_vec();
    };
    let mut out = body.to_vec();
    out.drain(i..i + n);
    out
}

/// "why is the cyclist in front of me?" changes nothing; who it speaks of is remembered.
fn question(body: &[Token], talk: &Talk<'_>) -> Option<Vec<Piece>> {
    let (inner, _) = unwrapped(body);
    let first = inner.first()?;
    let asks = matches!(
        text(first),
        "why"
            | "where"
            | "wheres"
            | "who"
            | "whos"
            | "whose"
            | "when"
            | "is"
            | "are"
            | "does"
            | "do"
            | "did"
            | "was"
            | "were"
            | "has"
            | "have"
            | "which"
    ) || text(first) == "how" && !is(inner.get(1), &["about"])
        || text(first) == "what" && !is(inner.get(1), &["if", "about"]);
    let begun = matches!(
        text(&body[0]),
        "why" | "where" | "wheres" | "who" | "whos" | "does" | "is" | "are" | "did"
    );
    if !(asks || begun)
        || is(body.get(1), &["not", "dont"])
        || leads(
            body,
            &[
                "is it possible",
                "is there any way",
                "is there a way",
                "have the",
                "have a",
                "do you mind",
                "do you think you could",
            ],
        )
        .is_some()
    {
        return None;
    }
    let mut out = Vec::new();
    if let Some((a, b)) = first_noun(body) {
        let lead = (0..a)
            .rev()
            .take_while(|i| matches!(text(&body[*i]), "the" | "my" | "that" | "this"))
            .last()
            .or((talk.fits(&body[a..b]) > 0).then_some(a));
        if let Some(lead) = lead {
            out.push(remembered(&body[lead..b], talk));
        }
    }
    Some(out)
}

/// A command that does nothing but say what "it" will mean.
fn remembered(np: &[Token], talk: &Talk<'_>) -> Piece {
    let span = np.iter().fold(np[0].span, |s: Span, t| s.to(t.span));
    let mut c = Command::new(Verb::Note, talk.text, span);
    target_part(talk.text, &tag(np), &mut c);
    let noun = first_noun(np).map(|n| np[n.0..n.1].to_vec());
    Piece::Meant(Box::new(c), noun)
}

/// Where a sentence falls apart: after a comma, "and" or "but", where a subject with its verb or an imperative begins.
fn clauses<'t>(body: &'t [Token], talk: &Talk<'_>) -> Vec<&'t [Token]> {
    let mut out = Vec::new();
    let mut from = 0;
    let mut i = 1;
    while i < body.len() {
        let t = &body[i];
        let link = matches!(t.kind, TokenKind::Comma | TokenKind::Mark)
            && !matches!(text(t), "#" | "/" | "\"")
            || matches!(
                text(t),
                "and" | "but" | "so" | "then" | "while" | "whereas" | "because"
            );
        if link {
            let mut next = i + 1;
            while body.get(next).is_some_and(|t| {
                t.kind == TokenKind::Comma
                    || matches!(
                        text(t),
                        "and" | "but" | "so" | "then" | "while" | "also" | "therefore" | "hence"
                    )
            }) {
                next += 1;
            }
            // "all cars but one can go"
            if text(t) == "but"
                && body.get(next).is_some_and(|t| number(t).is_some())
                && body[from..i].iter().any(|t| matches!(text(t), "all" | "every"))
            {
                i += 1;
                continue;
            }
            let rest = &body[next.min(body.len())..(next + 40).min(body.len())];
            let lead = matches!(
                text(&body[from]),
                "where" | "instead" | "if" | "when" | "since" | "because" | "as" | "by" | "until"
            ) && from == 0
                && !has_noun(&body[from..i]);
            let styled = body[from..i]
                .iter()
                .any(|t| matches!(look_up(text(t)), Some(Sense::Weather(_) | Sense::Time(_))));
            let spoken = styled
                || has_noun(&body[from..i])
                || is(body.get(from), words::PRONOUNS)
                || body[from..i].iter().any(|t| HELPERS.contains(&text(t)));
            // "take the barrier and put it behind me" is one
            let lifts = is(body.get(from), &["take", "grab", "pick", "lift", "get"])
                && is(body.get(next + 1), &["it", "them", "him", "her"])
                && !(from + 1..i).any(|k| is_place(&body[k..i]));
            // "both walkers, they must change"
            let named = is(rest.first(), words::PRONOUNS)
                && t.kind == TokenKind::Comma
                && first_noun(&body[from..i]).is_some_and(|n| {
                    n.0 < 5
                        && is(
                            body.get(from),
                            &["the", "both", "all", "that", "those", "these", "my"],
                        )
                })
                && !body[from..i]
                    .iter()
                    .any(|t| HELPERS.contains(&text(t)) || words::is_finite(text(t), false));
            let therefore =
                is(rest.first(), words::PRONOUNS) && body[i..next].iter().any(|t| text(t) == "so");
            if !lead
                && !lifts
                && !named
                && !therefore
                && spoken
                && opens(
                    rest,
                    &Talk {
                        carried: text(t) == "and" && carries(&body[from..i]),
                        last: None,
                        ..*talk
                    },
                )
                && !starts_where(&body[from..i])
            {
                out.push(&body[from..i]);
                from = next;
                i = next;
            }
        }
        i += 1;
    }
    out.push(&body[from..]);
    out.retain(|c| !c.is_empty());
    out
}

/// True if a clause is "put the truck in the left lane".
fn carries(clause: &[Token]) -> bool {
    let (inner, _) = unwrapped(clause);
    is(
        inner.first(),
        &["put", "move", "place", "set", "bring", "shift", "send"],
    ) && first_noun(inner).is_some_and(|n| n.0 < 6 && (n.1..inner.len()).any(|i| is_place(&inner[i..])))
}

/// "where the truck is, put a digger" and "instead of the van, ..." are one clause.
fn starts_where(tokens: &[Token]) -> bool {
    is(
        tokens.first(),
        &["where", "instead", "whatever", "whichever", "rather", "unless"],
    ) && has_noun(tokens)
        || leads(
            tokens,
            &[
                "in place of",
                "in lieu of",
                "by the time",
                "apart from",
                "except for",
            ],
        )
        .is_some()
}

/// True if a clause of its own begins here.
fn opens(rest: &[Token], talk: &Talk<'_>) -> bool {
    let (inner, mood) = unwrapped(rest);
    let Some(first) = inner.first() else {
        return false;
    };
    if mood.denied
        || leads(
            rest,
            &[
                "there is",
                "there are",
                "there should",
                "there must",
                "there shall",
                "i dont",
                "we dont",
                "i would",
                "id like",
                "i want",
                "i need",
                "we need",
            ],
        )
        .is_some()
    {
        return true;
    }
    let near = &inner[..inner.len().min(14)];
    if let Some(s) = subject(near, talk, false) {
        // "15 m ahead, two cars parked": a list goes on, and is no clause
        return match s.kind {
            Kind::Fresh => {
                HELPERS.contains(&text(&near[s.pred]))
                    || find(near, &["in"]).is_some() && text(&near[s.pred]) == "in"
                    || in_place(near).is_some()
            }
            Kind::Known => {
                is(
                    near.first(),
                    &[
                        "the", "my", "that", "this", "those", "these", "both", "all", "every", "our",
                    ],
                ) || HELPERS.contains(&text(&near[s.pred]))
                    || matches!(text(&near[s.pred]), "in" | "out" | "gone" | "away" | "off")
            }
            _ => true,
        };
    }
    // "and in its place there is a roller"
    if in_place(near).is_some_and(|p| p.0 == 0) && has_noun(&near[2..]) {
        return true;
    }
    // "and a tram in its place"
    if is(near.first(), &["a", "an", "another"])
        && first_noun(near).is_some_and(|n| in_place(&near[n.1..]).is_some_and(|p| p.0 == 0))
    {
        return true;
    }
    // "... and the car in the right lane"
    if is(near.first(), &["the", "that", "both", "my"])
        && first_noun(near).is_some_and(|n| n.0 < 4 && is_place(&near[n.1..]))
        && talk.carried
        && !near.iter().any(|t| HELPERS.contains(&text(t)))
    {
        return true;
    }
    // "two would do"
    if number(first).is_some()
        && is(
            inner.get(1),
            &["would", "will", "is", "are", "should", "must", "may"],
        )
    {
        return true;
    }
    let verb = super::rephrase::is_verb(first)
        && !is_place(inner)
        && !matches!(text(first), "up" | "face" | "facing" | "about");
    verb && inner.get(1).is_some_and(|t| {
        matches!(
            text(t),
            "the"
                | "a"
                | "an"
                | "it"
                | "them"
                | "him"
                | "her"
                | "both"
                | "all"
                | "that"
                | "this"
                | "another"
                | "my"
                | "one"
                | "two"
                | "everything"
                | "everyone"
                | "nothing"
                | "any"
        ) || number(t).is_some()
    })
}

/// One clause; `None` if it is left to the grammar of imperatives.
fn clause_of(clause: &[Token], talk: &Talk<'_>) -> Option<Vec<Piece>> {
    let (inner, mood) = unwrapped(clause);
    let inner = trimmed(inner);
    let first = inner.first()?;
    // weather and time have grammars of their own
    let style = |t: &Token| matches!(look_up(text(t)), Some(Sense::Weather(_) | Sense::Time(_)));
    if inner.iter().any(style) && !has_noun(inner) {
        return None;
    }
    // "the cones, please set them up ..."
    if is(inner.first(), &["the", "those", "these", "both", "that", "my"])
        && first_noun(inner).is_some_and(|n| n.1 == inner.len() && n.0 < 4)
        && talk.fits(inner) > 0
    {
        return Some(vec![remembered(inner, talk)]);
    }
    // "I can't see the pedestrian"
    if let Some((i, n)) = find(
        inner,
        &[
            "cant see",
            "cannot see",
            "can not see",
            "dont see",
            "barely see",
            "hardly see",
            "do not see",
        ],
    ) && i < 3
        && has_noun(&inner[i + n..])
    {
        return Some(vec![remembered(&inner[i + n..], talk)]);
    }
    if let Some(found) = half(inner) {
        return Some(found);
    }
    // "there are too many parked cars"
    if let Some(n) = leads(
        inner,
        &[
            "there are too many",
            "there are too few",
            "there is too much",
            "there are far too many",
            "there are way too many",
        ],
    ) && has_noun(&inner[n..])
    {
        return Some(vec![remembered(&inner[n..], talk)]);
    }
    if let Some(found) = distance_times(inner, talk) {
        return Some(found);
    }
    if let Some(found) = all_but(inner) {
        return Some(found);
    }
    if find(
        inner,
        &[
            "likewise",
            "as do",
            "so do",
            "so should",
            "as should",
            "as are",
            "so are",
            "as well as",
            "and so",
            "except",
            "apart from",
            "other than",
            "nothing but",
            "everything but",
            "all but",
            "everyone but",
            "everybody but",
        ],
    )
    .is_some()
    {
        return None;
    }
    if let Some(verb) = mood.framed.then(|| words::command_of(text(first))).flatten() {
        // "if you removed everybody": what is asked for is said in the past
        let mut tokens = led(verb, first, &[&inner[1..]]);
        return match imperative(&tokens, talk) {
            Some(found) => Some(found),
            None => {
                tokens.push(Token {
                    kind: TokenKind::Stop,
                    ..words::word(".", first)
                });
                Some(vec![Piece::Plain(tokens)])
            }
        };
    }
    if let Some(found) = fragment(inner, talk)
        .or_else(|| inverted(inner))
        .or_else(|| only_so_many(inner, talk))
    {
        return Some(found);
    }
    if let Some(found) = run_out(inner, talk)
        .or_else(|| preferred(inner, talk))
        .or_else(|| made_of(inner))
    {
        return Some(found);
    }
    if let Some((i, n)) = in_place(inner)
        && let Some(found) = takes_place(inner, i, n, talk)
    {
        return Some(found);
    }
    if let Some(found) = imperative(inner, talk) {
        return Some(found);
    }
    if mood.denied
        && let Some((a, b)) = first_noun(inner).filter(|n| n.0 < 4)
        && (a == 0 || !is(inner.first(), &["a", "an"]))
        && trimmed(&inner[b..]).iter().all(|t| {
            matches!(
                text(t),
                "anymore"
                    | "any"
                    | "more"
                    | "here"
                    | "there"
                    | "at"
                    | "all"
                    | "in"
                    | "the"
                    | "scene"
                    | "picture"
                    | "now"
                    | "longer"
            )
        })
    {
        let any = usize::from(is(inner.first(), &["any"]));
        return Some(vec![Piece::Plain(led("remove", first, &[&inner[any..b]]))]);
    }
    if let Some(found) = turn_about(inner, talk).or_else(|| some_replaced(inner, talk)) {
        return Some(found);
    }
    let s = subject(inner, talk, mood.caused)?;
    if mood.denied {
        // what it shall not do changes nothing; that it shall not be there does
        let parts = parts(&inner[s.pred..], true);
        let bare = parts.iter().all(|p| {
            p.main.is_empty()
                || p.begins(&["here", "there", "any more", "anymore", "in the scene"])
                    .is_some()
        });
        return (!bare && s.kind != Kind::Fresh).then(|| vec![remembered(&s.np, talk)]);
    }
    let pred = &inner[s.pred..];
    if s.kind == Kind::Fresh {
        return fresh(&s, pred, inner, talk);
    }
    // "the cyclist I don't need any more"
    if matches!(text(pred.first()?), "i" | "we" | "you") {
        let not = pred.iter().take(3).any(|t| words::NEGATED.contains(&text(t)));
        let verb = find(
            pred,
            &["need", "want", "like", "require", "see", "prefer", "have"],
        )?;
        let rest = &pred[verb.0 + 1..];
        if not {
            let np = led("remove", first, &[&s.np]);
            return Some(vec![Piece::Plain(np)]);
        }
        let parts = parts(rest, true);
        return acts::acts(&s, &parts, true, inner, talk);
    }
    // "fire engine in" of one that is there: more of it is not meant
    if is(pred.first(), &["in"]) {
        return None;
    }
    let parts = parts(pred, s.plural || mood.caused);
    // "Bus is too far off": a complaint says only what "it" will mean
    let complaint = find(
        pred,
        &[
            "wrong way",
            "wrong direction",
            "wrong side",
            "wrong lane",
            "wrong place",
            "wrong spot",
            "the wrong way round",
        ],
    )
    .is_some()
        || parts.iter().all(|p| {
            p.begins(&["too far", "too close", "too near", "wrong", "in the wrong", "too"])
                .is_some()
        });
    if complaint && !parts.iter().any(predicate::Part::is_gone) && matches!(s.kind, Kind::Known) {
        return Some(vec![remembered(&s.np, talk)]);
    }
    acts::acts(&s, &parts, mood.caused, inner, talk)
}

/// Something new and where it shall be: "a woman has to stand between the two trucks".
fn fresh(s: &Subject, pred: &[Token], clause: &[Token], talk: &Talk<'_>) -> Option<Vec<Piece>> {
    let first = &clause[0];
    let np: Vec<Token> = {
        // "a second bus", "another bus" is one more
        let skip = |t: &Token| {
            matches!(
                text(t),
                "second" | "third" | "fourth" | "further" | "additional" | "extra" | "new"
            )
        };
        let own = is(s.np.first(), &["their", "his", "her", "its"]);
        let lead = if own { led("a", first, &[]) } else { Vec::new() };
        lead.into_iter()
            .chain(s.np.iter().skip(usize::from(own)).filter(|t| !skip(t)).cloned())
            .collect()
    };
    let parts = parts(pred, true);
    let helped = parts.iter().any(|p| p.helped);
    if parts.iter().any(|p| {
        p.begins(&[
            "enough",
            "plenty",
            "sufficient",
            "suffices",
            "suffice",
            "do",
            "too",
        ])
        .is_some()
    }) {
        return None;
    }
    let counted = s.np.first().is_some_and(|t| number(t).is_some())
        && !s.np.iter().any(|t| matches!(text(t), "more" | "another"));
    let mut main: Vec<Token> = Vec::new();
    for p in parts.iter().filter(|p| !p.not) {
        let mut words = &p.main[..];
        while let Some(n) = leads(
            words,
            &[
                "needed",
                "wanted",
                "required",
                "added",
                "be added",
                "there",
                "missing",
                "in",
                "present",
                "put in",
                "inserted",
                "necessary",
                "here",
                "also",
                "too",
                "to be",
                "joining",
                "placed",
                "put",
                "positioned",
            ],
        ) {
            if n == 1 && text(&words[0]) == "in" && words.len() > 1 && words[1].kind != TokenKind::Comma {
                break;
            }
            words = &words[n..];
            while words.first().is_some_and(|t| {
                t.kind == TokenKind::Comma || matches!(text(t), "too" | "but" | "also" | "over")
            }) {
                words = &words[1..];
            }
        }
        main.extend_from_slice(words);
        main.push(words::word("and", first));
    }
    main.pop();
    // "directly behind the first one"
    if let Some((i, n)) = find(
        &main,
        &[
            "the first one",
            "the first",
            "the other one",
            "the other",
            "the existing one",
            "the one that is there",
            "the one already there",
            "the one there",
            "that one",
            "the old one",
            "the present one",
        ],
    ) && words::noun_at(&main[i + n..]).is_none()
    {
        let the = led("the", first, &[&s.noun]);
        main.splice(i..i + n, the);
    }
    // "behind it": what else was named
    let other = first_noun(&main)
        .map(|n| main[n.0..n.1].to_vec())
        .or_else(|| talk.last.as_ref().map(|l| led(l, first, &[])));
    if let (Some(other), Some(k)) = (
        other,
        (1..main.len()).find(|k| is(main.get(*k), &["it", "him", "her", "them"]) && is_place(&main[k - 1..])),
    ) && other.first().map(text) != s.noun.first().map(text)
    {
        main.splice(k..=k, led("the", first, &[&other]));
    }
    let in_out = is(pred.first(), &["in"]);
    if !(helped || in_out) || counted && !in_out && main.is_empty() {
        return None;
    }
    Some(vec![Piece::Plain(led("add", first, &[&np, &main]))])
}

/// "Truck one lane to the right", "bus a bit closer": a step without a verb.
fn fragment(inner: &[Token], talk: &Talk<'_>) -> Option<Vec<Piece>> {
    if super::rephrase::is_verb(&inner[0])
        || number(&inner[0]).is_some()
        || is(inner.first(), &["a", "an", "another"])
    {
        return None;
    }
    let (from, end) = first_noun(inner).filter(|n| n.0 < 4)?;
    let bare = inner[..from]
        .iter()
        .all(|t| !HELPERS.contains(&text(t)) && t.kind == TokenKind::Word);
    let verb = inner[end..]
        .iter()
        .any(|t| HELPERS.contains(&text(t)) || words::is_finite(text(t), false));
    let goal = is(inner.get(end), &["to", "onto", "into"]) && inner.len() > end + 1;
    if !bare || verb || talk.fits(&inner[..end]) != 1 || !(goal || acts::is_step(&inner[end..])) {
        return None;
    }
    let s = Subject {
        kind: Kind::Known,
        np: inner[..end].to_vec(),
        noun: inner[from..end].to_vec(),
        pred: end,
        plural: false,
    };
    let part = predicate::Part {
        main: led("move", &inner[0], &[&inner[end..]]),
        helped: true,
        ..predicate::Part::default()
    };
    acts::acts(&s, &[part], true, inner, talk)
}

/// "behind the truck comes a car": the thing after its place and verb.
fn inverted(inner: &[Token]) -> Option<Vec<Piece>> {
    if !is_place(inner) || super::rephrase::is_verb(&inner[0]) {
        return None;
    }
    let verb = (1..inner.len())
        .find(|i| HELPERS.contains(&text(&inner[*i])) || words::is_finite(text(&inner[*i]), false))?;
    let mut from = verb + 1;
    while inner.get(from).is_some_and(|t| {
        words::ADVERBS.contains(&text(t))
            || HELPERS.contains(&text(t))
            || matches!(text(t), "there" | "be" | "come" | "stand" | "drive")
    }) {
        from += 1;
    }
    let fresh = inner
        .get(from)
        .is_some_and(|t| matches!(text(t), "a" | "an" | "another" | "some") || number(t).is_some());
    let noun = first_noun(&inner[from.min(inner.len())..])?;
    if !fresh || noun.0 > 4 {
        return None;
    }
    let end = from + noun.1;
    // (a comma parts the place from what more is said)
    Some(vec![Piece::Plain(led(
        "add",
        &inner[0],
        &[&inner[from..end], &inner[..verb], &inner[end..]],
    ))])
}

/// "half of the cones can go", "remove half the cones"
fn half(inner: &[Token]) -> Option<Vec<Piece>> {
    let (i, n) = find(
        inner,
        &[
            "half of the",
            "half the",
            "half of my",
            "half of these",
            "half of those",
            "every second one of the",
        ],
    )?;
    let removing = i == 1
        && matches!(
            text(&inner[0]),
            "remove" | "delete" | "take" | "erase" | "drop" | "clear" | "lose" | "scrap" | "bin"
        );
    let end = i + n + first_noun(&inner[i + n..])?.1;
    let goes = i == 0
        && inner[end..].iter().any(|t| {
            matches!(
                text(t),
                "go" | "gone"
                    | "leave"
                    | "leaves"
                    | "left"
                    | "away"
                    | "removed"
                    | "disappear"
                    | "out"
                    | "off"
                    | "superfluous"
            )
        });
    (removing || goes).then(|| {
        vec![Piece::Plain(led(
            "half the number of",
            &inner[0],
            &[&inner[i + n..end]],
        ))]
    })
}

/// "double the distance to the truck"
fn distance_times(inner: &[Token], talk: &Talk<'_>) -> Option<Vec<Piece>> {
    if !is(inner.first(), &["double", "halve", "triple", "half"]) {
        return None;
    }
    let factor = acts::times(inner)?;
    let np_from = find(inner, &["to the", "of the", "from the", "and the"])?.0 + 1;
    let end = np_from + first_noun(&inner[np_from..])?.1;
    let s = Subject {
        kind: Kind::Known,
        np: inner[np_from..end].to_vec(),
        noun: inner[end - 1..end].to_vec(),
        pred: end,
        plural: false,
    };
    let word = if factor > 2.0 {
        "triple"
    } else if factor > 1.0 {
        "twice"
    } else {
        "half"
    };
    let part = predicate::Part {
        main: led(&format!("{word} as far"), &inner[0], &[]),
        helped: true,
        ..predicate::Part::default()
    };
    acts::acts(&s, &[part], true, inner, talk)
}

/// "all parked cars but one can go"
fn all_but(inner: &[Token]) -> Option<Vec<Piece>> {
    if !is(inner.first(), &["all", "every"]) {
        return None;
    }
    let but = inner
        .iter()
        .position(|t| matches!(text(t), "but" | "except" | "save" | "bar"))?;
    let n = (but + 1..inner.len().min(but + 3)).find(|k| number(&inner[*k]).is_some())?;
    let goes = inner[n + 1..].iter().any(|t| {
        matches!(
            text(t),
            "go" | "goes"
                | "gone"
                | "leave"
                | "left"
                | "leaves"
                | "away"
                | "removed"
                | "deleted"
                | "disappear"
                | "vanish"
                | "out"
                | "off"
                | "home"
        )
    });
    let before: Vec<Token> = inner[1..but]
        .iter()
        .filter(|t| !matches!(text(t), "the" | "of" | "my"))
        .cloned()
        .collect();
    let end = (n + 1..inner.len())
        .find(|k| HELPERS.contains(&text(&inner[*k])) || words::is_finite(text(&inner[*k]), true))
        .unwrap_or(inner.len());
    let after: Vec<Token> = inner[n + 1..end]
        .iter()
        .filter(|t| !matches!(text(t), "the" | "of" | "my" | "them"))
        .cloned()
        .collect();
    let np = if has_noun(&before) { before } else { after };
    (goes && has_noun(&np)).then(|| {
        vec![Piece::Plain(led(
            "keep exactly",
            &inner[0],
            &[&inner[n..=n], &np],
        ))]
    })
}

/// "only four must stay"
fn only_so_many(inner: &[Token], talk: &Talk<'_>) -> Option<Vec<Piece>> {
    let stays = inner.iter().any(|t| {
        matches!(
            text(t),
            "stay"
                | "stays"
                | "remain"
                | "remains"
                | "left"
                | "enough"
                | "suffice"
                | "do"
                | "plenty"
                | "suffices"
                | "sufficient"
        )
    });
    let n = predicate::alone(inner)?;
    let noun = talk.last.as_ref()?;
    (stays && !has_noun(inner)).then(|| {
        vec![Piece::Plain(led(
            "keep exactly",
            &inner[0],
            &[&[n], &led(noun, &inner[0], &[])],
        ))]
    })
}

/// "we have run out of cones"
fn run_out(inner: &[Token], talk: &Talk<'_>) -> Option<Vec<Piece>> {
    let (i, n) = find(
        inner,
        &[
            "run out of",
            "ran out of",
            "are out of",
            "are short of",
            "have no",
            "got no",
            "have no more",
            "are rid of",
        ],
    )?;
    let we = inner[..i].iter().any(|t| matches!(text(t), "we" | "i" | "they"));
    let np = trimmed(&inner[i + n..]);
    (we && i < 4 && has_noun(np) && talk.fits(np) > 0)
        .then(|| vec![Piece::Plain(led("remove all the", &inner[0], &[np]))])
}

/// "a bus than the truck", "a tram to the van", after "I'd rather have".
fn preferred(inner: &[Token], talk: &Talk<'_>) -> Option<Vec<Piece>> {
    // "a tram where the bus is"
    if let Some(k) = inner.iter().position(|t| text(t) == "where").filter(|k| *k > 1) {
        let (new, rest) = (trimmed(&inner[..k]), &inner[k + 1..]);
        let is_at = rest
            .iter()
            .position(|t| HELPERS.contains(&text(t)) || words::is_finite(text(t), true))?;
        let fresh = is(new.first(), &["a", "an", "another"]) || number(new.first()?).is_some();
        let known = is(rest.first(), &["the", "that", "this", "both", "my", "those"]);
        return (fresh && known && has_noun(new) && has_noun(&rest[..is_at])).then(|| {
            vec![Piece::Plain(led(
                "replace",
                &inner[0],
                &[&rest[..is_at], &led("with", &inner[0], &[new])],
            ))]
        });
    }
    let (i, n) = find(
        inner,
        &[
            "rather than",
            "instead of",
            "in place of",
            "than",
            "over",
            "in lieu of",
        ],
    )?;
    let (new, old) = (trimmed(&inner[..i]), trimmed(&inner[i + n..]));
    let fresh = new
        .first()
        .is_some_and(|t| matches!(text(t), "a" | "an" | "another"));
    let known = old
        .first()
        .is_some_and(|t| matches!(text(t), "the" | "that" | "this" | "both" | "my" | "those"));
    let end = first_noun(old)?.1;
    (fresh && known && has_noun(new) && first_noun(new)?.0 < 4 && talk.fits(&old[..end]) > 0).then(|| {
        vec![Piece::Plain(led(
            "replace",
            &inner[0],
            &[old, &led("with", &inner[0], &[new])],
        ))]
    })
}

/// "make a bus of that truck"
fn made_of(inner: &[Token]) -> Option<Vec<Piece>> {
    if !is(inner.first(), &["make", "build", "create", "form"])
        || !is(inner.get(1), &["a", "an", "two", "three"])
    {
        return None;
    }
    let (i, n) = find(inner, &["out of", "of", "from"])?;
    let (new, old) = (&inner[1..i], &inner[i + n..]);
    let known = is(
        old.first(),
        &["the", "that", "this", "those", "both", "my", "it", "them"],
    );
    let end = first_noun(old).map_or(1, |x| x.1);
    (known && has_noun(new)).then(|| {
        vec![Piece::Plain(led(
            "replace",
            &inner[0],
            &[&old[..end], &led("with", &inner[0], &[new])],
        ))]
    })
}

/// "a tanker comes in its place", "put one lorry at the same place"
fn takes_place(inner: &[Token], i: usize, n: usize, talk: &Talk<'_>) -> Option<Vec<Piece>> {
    let mut rest: Vec<Token> = inner[..i].to_vec();
    rest.extend_from_slice(&inner[i + n..]);
    let (a, b) = first_noun(&rest)?;
    let lead = (0..a)
        .rev()
        .take_while(|k| {
            matches!(
                text(&rest[*k]),
                "a" | "an" | "another" | "some" | "new" | "big" | "small" | "large"
            ) || number(&rest[*k]).is_some()
                || look_up(text(&rest[*k]))
                    .is_some_and(|s| matches!(s, Sense::Color(_) | Sense::Size(_) | Sense::Attribute(_)))
        })
        .last()?;
    let np = &rest[lead..b];
    let span = inner.iter().fold(inner[0].span, |s: Span, t| s.to(t.span));
    let mut c = Command::new(Verb::Add, talk.text, span);
    target_part(talk.text, &tag(np), &mut c);
    c.in_place = true;
    c.by = c.targets.first().cloned();
    let noun = Some(rest[a..b].to_vec());
    Some(vec![Piece::Meant(Box::new(c), noun)])
}

/// "replace three of the cones with barriers"
fn some_replaced(inner: &[Token], talk: &Talk<'_>) -> Option<Vec<Piece>> {
    let verb = is(
        inner.first(),
        &[
            "replace",
            "swap",
            "exchange",
            "change",
            "turn",
            "convert",
            "substitute",
            "transform",
            "make",
        ],
    );
    let part = number(inner.get(1)?).is_some() && is(inner.get(2), &["of"]);
    if !(verb && part) {
        return None;
    }
    let k = (3..inner.len()).find(|k| is(inner.get(*k), &["with", "by", "for", "into", "to", "against"]))?;
    let (a, b) = first_noun(&inner[3..k])?;
    let rest: Vec<Token> = inner[4..k]
        .iter()
        .filter(|t| number(t).is_none())
        .cloned()
        .collect();
    let s = Subject {
        kind: Kind::Part,
        np: led("any", &inner[0], &[&inner[1..2], &rest]),
        noun: inner[3 + a..3 + b].to_vec(),
        pred: k,
        plural: true,
    };
    let part = predicate::Part {
        main: led("replaced by", &inner[0], &[&inner[k + 1..]]),
        helped: true,
        ..predicate::Part::default()
    };
    acts::acts(&s, &[part], true, inner, talk)
}

/// "turn the man so that his back is towards us": the end of the sentence says how.
fn turn_about(inner: &[Token], talk: &Talk<'_>) -> Option<Vec<Piece>> {
    if !is(
        inner.first(),
        &[
            "turn",
            "rotate",
            "spin",
            "swivel",
            "orient",
            "orientate",
            "position",
            "place",
            "put",
        ],
    ) {
        return None;
    }
    // "turn it around"
    if is(inner.get(1), &["it", "him", "her", "them"])
        && inner.len() > 2
        && !is(inner.get(2), &["into", "on", "off", "up", "down"])
        && matches!(text(&inner[0]), "turn" | "rotate" | "spin" | "swivel")
        && !inner.iter().any(|t| matches!(text(t), "into" | "so"))
    {
        let s = Subject {
            kind: Kind::Back(if is(inner.get(1), &["him", "her"]) {
                Back::Person
            } else {
                Back::Same
            }),
            np: inner[1..2].to_vec(),
            noun: Vec::new(),
            pred: 2,
            plural: false,
        };
        let part = predicate::Part {
            main: led("turn", &inner[0], &[&inner[2..]]),
            helped: true,
            ..predicate::Part::default()
        };
        return acts::acts(&s, &[part], true, inner, talk);
    }
    let (i, n) = find(
        inner,
        &["so that", "such that", "in such a way that", "with", "so"],
    )?;
    let end = first_noun(&inner[1..]).map_or(2, |x| x.1 + 1);
    if i < end || inner[end..i].iter().any(|t| t.kind == TokenKind::Comma) {
        return None;
    }
    let mut rest = &inner[i + n..];
    while is(
        rest.first(),
        &["it", "he", "she", "they", "its", "his", "her", "their", "the"],
    ) {
        rest = &rest[1..];
    }
    let about = rest.iter().any(|t| {
        matches!(
            text(t),
            "back"
                | "backs"
                | "rear"
                | "tail"
                | "front"
                | "nose"
                | "face"
                | "faces"
                | "facing"
                | "looks"
                | "look"
                | "points"
                | "point"
        )
    });
    if !about {
        return None;
    }
    let (kind, np) = match text(&inner[1]) {
        "it" | "them" => (Kind::Back(Back::Same), &inner[1..2]),
        "him" | "her" => (Kind::Back(Back::Person), &inner[1..2]),
        _ => (Kind::Known, &inner[1..end]),
    };
    let s = Subject {
        kind,
        np: np.to_vec(),
        noun: first_noun(np).map(|n| np[n.0..n.1].to_vec()).unwrap_or_default(),
        pred: end,
        plural: false,
    };
    let part = predicate::Part {
        main: led("turn", &inner[0], &[rest]),
        helped: true,
        ..predicate::Part::default()
    };
    acts::acts(&s, &[part], true, inner, talk)
}

/// "put the car in the middle of my lane", "take it 5 m further back": what is known is moved.
fn imperative(inner: &[Token], talk: &Talk<'_>) -> Option<Vec<Piece>> {
    const MOVES: &[&str] = &[
        "move",
        "shift",
        "put",
        "place",
        "bring",
        "pull",
        "push",
        "set",
        "send",
        "drive",
        "slide",
        "take",
        "get",
        "relocate",
        "reposition",
        "position",
        "drag",
        "nudge",
        "roll",
        "transfer",
        "displace",
        "park",
        "stand",
        "steer",
        "have",
        "let",
        "draw",
        "lead",
        "guide",
        "switch",
        "swing",
        "budge",
        "scoot",
        "make",
        "lay",
        "leave",
        "walk",
        "back",
        "carry",
        "shove",
        "transport",
        "edge",
        "moving",
        "putting",
        "placing",
        "bringing",
        "pulling",
        "pushing",
        "moved",
        "brought",
        "pulled",
        "pushed",
        "placed",
        "shifted",
        "shifting",
    ];
    let first = inner.first()?;
    // "add him", "put him there": he is there
    let added = matches!(text(first), "add" | "include" | "insert" | "put" | "place")
        && is(inner.get(1), &["it", "him", "her", "them"]);
    if added
        && inner[2..].iter().all(|t| {
            matches!(
                text(t),
                "there"
                    | "in"
                    | "too"
                    | "please"
                    | "now"
                    | "here"
                    | "into"
                    | "the"
                    | "scene"
                    | "picture"
                    | "to"
            )
        })
    {
        return Some(Vec::new());
    }
    let counts = inner
        .iter()
        .any(|t| matches!(text(t), "number" | "amount" | "count" | "total"));
    let makes = matches!(text(first), "make" | "have" | "let" | "get");
    if !MOVES.contains(&text(first)) || counts {
        return None;
    }
    if makes
        && is(inner.get(1), &["it", "that", "this"])
        && inner
            .get(2)
            .is_some_and(|t| number(t).is_some() || is(Some(t), &["a", "an"]))
    {
        return None;
    }
    let mut from = 1;
    while is(inner.get(from), &["over", "back", "up", "forward", "down"])
        && inner
            .get(from + 1)
            .is_some_and(|t| matches!(text(t), "the" | "both" | "that" | "my" | "it" | "all"))
    {
        from += 1;
    }
    let tokens = &inner[from..];
    let pronoun = is(tokens.first(), &["it", "him", "her", "them"]);
    let (np_end, s) = if pronoun {
        let back = if is(tokens.first(), &["him", "her"]) {
            Back::Person
        } else {
            Back::Same
        };
        let s = Subject {
            kind: Kind::Back(back),
            np: tokens[..1].to_vec(),
            noun: Vec::new(),
            pred: 1,
            plural: false,
        };
        (1, s)
    } else {
        let known = is(
            tokens.first(),
            &[
                "everything",
                "everyone",
                "everybody",
                "the",
                "that",
                "this",
                "those",
                "these",
                "both",
                "my",
                "all",
                "our",
                "every",
            ],
        ) || tokens
            .first()
            .is_some_and(|t| words::noun_at(std::slice::from_ref(t)).is_some())
            && talk.fits(&tokens[..first_noun(tokens)?.1]) > 0
            || number(tokens.first()?).is_some() && is(tokens.get(1), &["of"]);
        if !known {
            return None;
        }
        let noun = first_noun(tokens).filter(|n| n.0 < 7)?;
        let clean = tokens[..noun.0]
            .iter()
            .all(|t| t.kind != TokenKind::Comma && !matches!(text(t), "and" | "rid"));
        if !clean || is(tokens.get(noun.1), &["and"]) {
            return None;
        }
        let split = acts::split(tokens, talk)?;
        let part = is(tokens.get(1), &["of"]) && number(&tokens[0]).is_some();
        let np = if part {
            led("any", first, &[&tokens[..1], &tokens[2..split]])
        } else {
            tokens[..split].to_vec()
        };
        let s = Subject {
            kind: if part { Kind::Part } else { Kind::Known },
            np,
            noun: tokens[noun.0..noun.1].to_vec(),
            pred: split,
            plural: false,
        };
        (split, s)
    };
    let rest = trimmed(&tokens[np_end..]);
    // "out of my lane and onto the sidewalk"
    let goal = leads(rest, &["out of", "off", "away from", "from"])
        .and_then(|_| (1..rest.len()).find(|i| words::is_goal(&rest[*i..]) || is(rest.get(*i), &["to"])));
    let rest = &rest[goal.unwrap_or(0)..];
    let out_of = leads(rest, &["out", "away", "off", "out of", "down"]).is_some() && !predicate_places(rest);
    if s.kind == Kind::Part && out_of {
        let part = predicate::Part {
            main: led("gone", first, &[]),
            helped: true,
            ..predicate::Part::default()
        };
        return acts::acts(&s, &[part], true, inner, talk);
    }
    if rest.is_empty() || out_of {
        return None;
    }
    if !(0..rest.len()).any(|i| is_place(&rest[i..])) {
        return None;
    }
    // the verb says that metres are a way to go
    let mut main = vec![words::word("move", first)];
    main.extend(inner[1..from].iter().cloned());
    let mut said = parts(rest, true);
    for p in &mut said {
        p.helped = true;
        p.is = false;
        p.not = false;
        p.perfect = false;
    }
    if let Some(p) = said.first_mut() {
        let park = matches!(text(first), "park" | "stand");
        let mut whole = if park {
            vec![words::word(
                if text(first) == "park" {
                    "parked"
                } else {
                    "standing"
                },
                first,
            )]
        } else {
            main
        };
        whole.extend(std::mem::take(&mut p.main));
        p.main = whole;
    }
    acts::acts(&s, &said, true, inner, talk)
}

fn predicate_places(rest: &[Token]) -> bool {
    (1..rest.len()).any(|i| is_place(&rest[i..])) || has_noun(rest)
}
