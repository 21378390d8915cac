//! Sentences that say how the scene shall be, or what has become of something in it, as commands. A sentence is taken out
//! of what it is wrapped in ([`frame`]), parted into clauses, and of each clause the subject (`subject.rs`) and what is
//! said of it ([`predicate`]) are told apart; what follows for the scene stands in [`acts`]. Who is meant is decided by
//! what the scene holds. Clauses that are none of this are left to the grammar of imperatives.

mod actors;
mod acts;
mod apart;
mod appended;
mod arrivals;
mod as_now;
mod asides;
mod asked;
mod bare;
mod beside;
mod beside_whom;
mod brief_places;
mod brief_turns;
mod brief_wholes;
mod briefs;
mod bystanders;
mod causing;
mod clipped;
mod colours;
mod company;
mod corrected;
mod curt;
mod dealt;
mod doers;
mod exception;
mod exchanges;
mod forms;
mod frame;
mod fronted;
mod gapped;
mod gaps;
mod gaze;
mod gifts;
mod group_sizes;
mod halves;
mod happier;
mod headway;
mod idioms;
mod in_passing;
mod joined_by;
mod kept;
mod lane_of;
mod left;
mod likewise;
mod limits;
mod lines;
mod links;
pub(super) mod lists;
mod loose_ends;
mod mistaken;
mod newcomers;
mod nominal;
mod notes;
mod of_several;
mod offhand;
mod orders;
mod owned;
mod paired;
mod parting;
mod passing;
mod passive;
mod placing;
mod plainly;
mod pointers;
mod predicate;
mod presence;
mod question;
mod reasons;
mod recast;
mod recounted;
mod remaining;
mod remarks;
mod riders;
mod seconds;
mod shorthand;
mod sites;
mod skies;
mod small_turns;
mod some_of;
mod spaces;
mod speakers;
mod splits;
mod spoken;
mod stead;
mod steps;
mod strides;
mod strips;
mod subject;
mod sums;
mod swap;
mod tails;
mod terse;
mod testimony;
#[cfg(test)]
mod tests;
mod tidy;
mod told_again;
mod topics;
mod totals;
mod turns;
mod untouched;
mod vacated;
mod wanted;
mod ways;
mod which;
mod wider;
mod worded;
pub(super) mod words;

use super::edit_command::{parse, target_part};
use super::edit_grammar::{Back, Command};
use super::lanes::LaneMap;
use super::lexicon::{Sense, look_up};
use super::select::fitting;
use super::tag::tag;
use super::tokens::{Span, Token, TokenKind};
use super::words::edits::Verb;
use crate::scene::{BoxId, Class, SceneBox};
pub use apart::apart;
pub use asides::without as without_asides;
pub use asked::unasked;
pub use beside::plain as plain_beside;
pub use brief_wholes::whole;
pub use exception::except;
use forms::{
    all_but, distance_times, fragment, fresh, half, inverted, made_of, only_so_many, preferred, run_out,
    takes_place,
};
use frame::unwrapped;
pub use in_passing::facts;
pub use left::Left;
pub use links::parted as parted_at_links;
use lists::{ELSEWHERE_READ, HELPERS, NEGATED};
pub use loose_ends::cut;
pub use nominal::plain as as_orders;
use orders::{imperative, some_replaced, turn_about};
use parting::clauses;
pub use pointers::plain as pointed_back;
use predicate::{in_place, parts};
use question::question;
pub use remarks::told_once;
use spoken::{with_ones, without_feet};
use std::collections::BTreeMap;
use subject::{Kind, Subject, subject};
pub use vacated::{Room, room_of};
pub use which::spared;
pub use worded::worded;
use words::{find, first_noun, has_noun, is, is_place, leads, led, text, trimmed};

/// What a sentence is read with.
pub struct Talk<'a> {
    pub text: &'a str,
    pub map: &'a LaneMap<'a>,
    pub boxes: &'a BTreeMap<BoxId, SceneBox>,
    /// A word for what was spoken of last.
    pub last: Option<String>,
    /// What else the sentence before named.
    pub other: Option<Class>,
    /// The clause before moves something: its verb may hold for the next.
    pub carried: bool,
    /// The sentence speaks of "the other" of several, too.
    pub others: bool,
    /// What went before leaves room to be pointed at.
    pub room: Room,
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

    /// The boxes of the scene that fit these words.
    pub fn boxes_of(&self, np: &[Token]) -> Vec<SceneBox> {
        let (_, mentions) = parse(self.text, &tag(np));
        let Some(m) = mentions.iter().find(|m| !m.is_anchor && !m.gone) else {
            return Vec::new();
        };
        fitting(self.map, self.boxes, m, &mentions)
            .iter()
            .filter_map(|id| self.boxes.get(id).copied())
            .collect()
    }

    /// True if no box can be what is named with an article or a number.
    pub fn has_none(&self, np: &[Token]) -> bool {
        let (_, mentions) = parse(self.text, &tag(np));
        let m = mentions.iter().find(|m| !m.is_anchor && !m.gone);
        m.is_some_and(|m| !self.boxes.values().any(|b| super::names::may_be(b, m)))
    }

    /// True if these words mean so many boxes as they name: "the lorry", where a pickup is a truck, too.
    fn tells(&self, np: &[Token]) -> bool {
        let (_, mentions) = parse(self.text, &tag(np));
        let Some(m) = mentions.iter().find(|m| !m.is_anchor && !m.gone) else {
            return false;
        };
        let n = super::names::plainly(self.boxes_of(np), m).len();
        n == 1 || n > 1 && m.plural
    }

    /// The box that these words mean, if no other fits.
    fn only(&self, np: &[Token]) -> Option<&SceneBox> {
        let (_, mentions) = parse(self.text, &tag(np));
        let m = mentions.iter().find(|m| !m.is_anchor && !m.gone)?;
        match fitting(self.map, self.boxes, m, &mentions).as_slice() {
            [id] => self.boxes.get(id),
            _ => None,
        }
    }

    /// How far the boxes are that fit these words, m, if they are all as far.
    fn range(&self, np: &[Token]) -> Option<f64> {
        let (_, mentions) = parse(self.text, &tag(np));
        let m = mentions.iter().find(|m| !m.is_anchor && !m.gone)?;
        let ids = fitting(self.map, self.boxes, m, &mentions);
        let far: Vec<f64> = ids
            .iter()
            .filter_map(|id| self.boxes.get(id))
            .map(|b| b.center_m.truncate())
            .map(|p| {
                if ids.len() > 1 {
                    p.x.abs().max(p.y.abs())
                } else {
                    p.length()
                }
            })
            .collect();
        let first = far.first()?;
        far.iter().all(|f| (f - first).abs() < 2.5).then(|| first.round())
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

/// Longest sentence in tokens in which choices and totals are looked for.
const LONGEST_CHOICE: usize = 120;

/// A sentence with choices among a group and totals said plainly: before exceptions are looked for.
pub fn chosen(sentence: &[Token], talk: &Talk<'_>) -> Vec<Token> {
    let (body, stop) = match sentence.split_last() {
        Some((last, body)) if last.kind == TokenKind::Stop => (body, std::slice::from_ref(last)),
        _ => (sentence, &[][..]),
    };
    // (nobody says so much in one sentence; each turn of speech looks through all of it)
    if body.len() > LONGEST_CHOICE {
        return sentence.to_vec();
    }
    let out = in_passing::plain(stead::plain(body.to_vec(), talk), talk);
    let out = testimony::plain(bystanders::plain(out, talk));
    let out = fronted::plain(appended::plain(speakers::plain(out, talk), talk), talk);
    let out = owned::plain(remarks::reported(beside::waits_for(out, talk)), talk);
    let out = clipped::plain(loose_ends::plain(out, talk), talk);
    let out = actors::unseen(out);
    if out.is_empty() {
        return stop.to_vec();
    }
    let out = actors::plain(out, talk);
    let out = as_now::plain(paired::plain(out, talk), talk);
    let out = placing::plain(bare::plain(out, talk), talk);
    let out = headway::plain(happier::plain(out, talk), talk);
    let out = of_several::from_there(of_several::both_of_them(out, talk), talk);
    let out = mistaken::plain(recounted::plain(out, talk), talk);
    let out = joined_by::plain(told_again::plain(out, talk), talk);
    let out = sites::plain(kept::plain(briefs::plain(out, talk), talk), talk);
    let out = left::only_person(gaze::plain(spoken::coming(out, talk), talk), talk);
    let out = passing::plain(corrected::plain(offhand::plain(out, talk), talk), talk);
    let out = tidy::plain(tails::plain(small_turns::plain(spoken::sides_named(out))), talk);
    let out = seconds::plain(vacated::plain(out, talk), talk);
    let out = notes::plain(lane_of::plain(out, talk), talk);
    let out = of_several::front_and_rear(spoken::engine(spoken::little_ones(out, talk), talk), talk);
    let out = notes::gone(out, talk);
    let out = riders::plain(curt::plain(out, talk));
    let out = newcomers::plain(plainly::plain(out, talk), talk);
    let out = splits::plain(remarks::plain(out, talk), talk);
    let out = presence::plain(company::plain(wider::plain(out, talk), talk), talk);
    let out = terse::plain(exchanges::plain(out, talk), talk);
    let out = reasons::plain(out, talk);
    let out = doers::plain(dealt::plain(out, talk), talk);
    let out = of_several::of_the_group(likewise::plain(out, talk), talk);
    let out = arrivals::plain(gifts::plain(turns::plain(out, talk), talk), talk);
    if out.is_empty() {
        return stop.to_vec();
    }
    let out = exception::the_one_spared(out);
    let out = exception::all_stays_but(exception::cleared_but(out));
    let out = exception::everything_but(remaining::nobody_on_foot(out));
    let out = of_several::plain(out, talk);
    let mut out = totals::plain(out, talk);
    out.extend_from_slice(stop);
    out
}

/// Two sentences that only mean something together as one: "the car was a mistake; a bus belongs there".
pub fn rejoined(tokens: Vec<Token>) -> Vec<Token> {
    group_sizes::joined(told_again::joined(mistaken::joined(headway::joined(
        in_passing::joined(paired::joined(paired::of_two(spaces::crossed(tokens)))),
    ))))
}

/// Reads a sentence with its stop.
pub fn said(sentence: &[Token], talk: &Talk<'_>) -> Vec<Piece> {
    // "there must be a bus behind me, not a car"
    let not = (1..sentence.len()).find(|i| {
        is(sentence.get(*i), &["not"])
            && is(sentence.get(i + 1), &["a", "an"])
            && sentence[i - 1].kind == TokenKind::Comma
            && !sentence[*i..].iter().any(|t| HELPERS.contains(&text(t)))
    });
    let sentence = &sentence[..not.map_or(sentence.len(), |n| n - 1)];
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
    let others =
        talk.others || find(body, &["the other", "the others", "the rest", "the remaining"]).is_some();
    let mut before: Option<String> = talk.last.clone();
    let parted = clauses(body, talk);
    understood |= parted.len() > 1 && parted.iter().any(|c| parting::only_sky(c));
    let mut lead: Option<Token> = None;
    let mut previous: Vec<Token> = Vec::new();
    let mut room = talk.room;
    for clause in parted {
        // "put the truck on the left and the car on the right"
        let mut clause = clause.to_vec();
        let bare = is(clause.first(), &parting::WHOLE)
            && first_noun(&clause).is_some_and(|n| n.0 < 4 && is_place(&clause[n.1..]))
            && !parting::has_verb(&clause);
        if let (true, Some(verb)) = (bare, &lead) {
            clause.insert(0, words::word(text(verb), &clause[0]));
        }
        if colours::goes_on(&clause, &previous) {
            clause.insert(0, words::word("paint", &clause[0]));
            understood = true;
        }
        previous = unwrapped(&clause).0.to_vec();
        let verb = previous.first().cloned();
        let told = parting::carried_on(&clause, talk).then(|| words::word("put", &clause[0]));
        lead = verb.filter(|_| parting::carrying(&previous)).or(told);
        let clause = &clause[..];
        let talk = Talk {
            last: before.clone(),
            others,
            room,
            ..*talk
        };
        // "the workers have gone home, so leave them out": said twice
        let twice = matches!(out.last(), Some(Piece::Meant(c, _)) if c.verb == Verb::Remove)
            && some_of::removes_it(unwrapped(clause).0);
        if twice {
            continue;
        }
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
        room = vacated::room_after(&out).unwrap_or(room);
        if let Some((a, b)) = first_noun(clause) {
            let run: Vec<&str> = clause[a..b].iter().map(text).collect();
            before = Some(run.join(" "));
        }
    }
    // who is gone and then is elsewhere has only left where he was
    for i in 0..out.len() {
        // ("it" is he as long as nobody else is named)
        let still = out[i + 1..]
            .iter()
            .take_while(|p| matches!(p, Piece::Meant(c, _) if c.targets.is_empty()));
        let elsewhere = still.into_iter().any(|p| matches!(p, Piece::Meant(c, _) if c.back.is_some_and(|b| b != Back::Others) && matches!(c.verb, Verb::Move | Verb::Turn | Verb::Make | Verb::Replace)));
        if let (true, Piece::Meant(c, _)) = (elsewhere, &mut out[i])
            && c.verb == Verb::Remove
        {
            c.verb = Verb::Note;
        }
    }
    // ("whatever is behind us, make it a coach" is one)
    let topic = is(
        body.first(),
        &["whatever", "whoever", "whichever", "what", "anything"],
    );
    if understood || out.len() > 1 && !topic {
        out
    } else {
        plain()
    }
}

/// A command that does nothing but say what "it" will mean.
fn remembered(np: &[Token], talk: &Talk<'_>) -> Piece {
    let span = np.iter().fold(np[0].span, |s: Span, t| s.to(t.span));
    let mut c = Command::new(Verb::Note, talk.text, span);
    target_part(talk.text, &tag(np), &mut c);
    let noun = first_noun(np).map(|n| np[n.0..n.1].to_vec());
    Piece::Meant(Box::new(c), noun)
}

/// "I need the truck in our lane" where it is not there yet: the lane is where it shall be.
fn to_lane(s: &Subject, pred: &[Token], talk: &Talk<'_>) -> bool {
    let Some(lane) = pred.iter().take(5).position(|t| is(Some(t), &["lane", "lanes"])) else {
        return false;
    };
    let rest = &pred[lane + 1..];
    let closes = rest.first().is_none_or(|t| {
        t.kind != TokenKind::Word
            || text(t).ends_with("ing")
            || is_place(rest)
            || is(Some(t), &["and", "now"])
    });
    closes && !has_noun(&pred[..lane]) && talk.fits(&[&s.np, &pred[..=lane]].concat()) == 0
}

/// One clause; `None` if it is left to the grammar of imperatives.
fn clause_of(clause: &[Token], talk: &Talk<'_>) -> Option<Vec<Piece>> {
    let (inner, mood) = unwrapped(clause);
    let inner = trimmed(inner);
    let first = inner.first()?;
    if let Some(mut tokens) = colours::painted(inner, talk) {
        tokens.push(Token {
            kind: TokenKind::Stop,
            ..words::word(".", first)
        });
        return Some(vec![Piece::Plain(tokens)]);
    }
    if let Some(over) = sites::finished(inner) {
        return Some(vec![Piece::Plain(over)]);
    }
    // weather and time have grammars of their own
    let style = |t: &Token| matches!(look_up(text(t)), Some(Sense::Weather(_) | Sense::Time(_)));
    if inner.iter().any(style) && !has_noun(inner) {
        return None;
    }
    // "the cones, please set them up ..."
    if !mood.denied
        && is(inner.first(), &["the", "those", "these", "both", "that", "my"])
        && first_noun(inner).is_some_and(|n| n.1 == inner.len() && n.0 < 4)
        && talk.fits(inner) > 0
    {
        return Some(vec![remembered(inner, talk)]);
    }
    // "leave the car behind me as it is"
    if let Some(np) = untouched::stays(inner)
        .or_else(|| untouched::stays(trimmed(clause)))
        .filter(|np| talk.fits(np) > 0)
    {
        return Some(vec![remembered(np, talk)]);
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
    // "and no bus"
    if is(inner.first(), &["no"])
        && let Some(gone) = remaining::plain(inner)
    {
        return Some(vec![Piece::Plain(gone)]);
    }
    if let Some(found) = vacated::filled(inner, talk).or_else(|| half(inner)) {
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
            "we have too many",
            "we have too few",
            "i see too many",
            "i see too few",
            "i have too many",
            "i have too few",
            "too many",
            "too few",
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
    if find(inner, &ELSEWHERE_READ).is_some() {
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
        .or_else(|| inverted(inner, talk))
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
    // ("the white car stays where it is" goes nowhere)
    if let Some((i, n)) = in_place(inner).filter(|x| !inner[..x.0].iter().any(untouched::stands_still))
        && let Some(found) = takes_place(inner, i, n, talk)
    {
        return Some(found);
    }
    if let Some(found) = imperative(inner, talk) {
        return Some(found);
    }
    // "I don't want any cars behind me any more"
    if mood.denied
        && let Some(found) = exception::unwanted(inner, first)
    {
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
        let not = pred.iter().take(3).any(|t| NEGATED.contains(&text(t)));
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
    // ("I want it in our lane" says where)
    let where_to =
        pred.len() > 1 && (matches!(s.kind, Kind::Back(_)) || mood.caused && to_lane(&s, pred, talk));
    if is(pred.first(), &["in"]) && !where_to {
        return None;
    }
    // "the fourth is still crossing": as before
    let still = pred.iter().take(3).any(|t| text(t) == "still")
        || leads(
            pred,
            &["is about to", "are about to", "was about to", "were about to"],
        )
        .is_some();
    if still
        && !pred
            .iter()
            .any(|t| is(Some(t), &["should", "must", "shall", "needs", "not"]))
        && !pred.iter().any(|t| matches!(text(t), "and" | "but"))
    {
        return Some(vec![remembered(&s.np, talk)]);
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
            let verb = usize::from(
                p.main
                    .first()
                    .is_some_and(|t| words::is_finite(text(t), true) || text(t).ends_with("ing")),
            );
            let close = [
                "too",
                "way too",
                "far too",
                "much too",
                "a bit too",
                "a little too",
                "dangerously",
                "uncomfortably",
            ];
            p.begins(&["too far", "too close", "too near", "wrong", "in the wrong", "too"])
                .is_some()
                || leads(&p.main[verb..], &close).is_some_and(|n| {
                    is(
                        p.main.get(verb + n),
                        &["far", "close", "near", "closely", "tightly"],
                    )
                })
        });
    if complaint && !parts.iter().any(predicate::Part::is_gone) && matches!(s.kind, Kind::Known) {
        return Some(vec![remembered(&s.np, talk)]);
    }
    acts::acts(&s, &parts, mood.caused, inner, talk)
}
