//! Commands to a scene: where each begins, what it is about, where to, how far, into what.

use std::collections::BTreeMap;

use glam::DVec2;

use super::description::{Count, ObjectSpec, Reading};
use super::edit_command::{imperatives, target_part};
use super::lanes::LaneMap;
use super::mention::Mention;
use super::rephrase::{Change, rephrase};
use super::said::{
    Left, Piece, Room, Talk, apart, as_orders, chosen, except, facts, parted_at_links, plain_beside,
    pointed_back, rejoined, room_of, said, told_once, unasked, without_asides, worded,
};
use super::tag::tag;
use super::tokens::{Span, Token, TokenKind, tokens};
use super::wording::begins;
use super::words::edits::{Pick, Verb};
use crate::scene::graph::{LaneRole, ObjectState};
use crate::scene::{BoxId, Class, SceneBox};

/// Where a box is moved to.
#[derive(Clone, Debug, PartialEq)]
pub enum Destination {
    /// By metres in a direction of the ego frame.
    By {
        /// Unit vector.
        direction: DVec2,
        /// How far, if it was said.
        metres: Option<f64>,
    },
    /// Nearer to the ego vehicle, or away from it.
    Toward {
        /// Away.
        away: bool,
        /// How far, if it was said.
        metres: Option<f64>,
    },
    /// So far from the ego vehicle, on the side where it is.
    Range(f64),
    /// So many times as far from the ego vehicle as it is.
    Times(f64),
    /// So many lanes to the left; to the right if negative.
    Lanes(i32),
    /// Where the relations of this object hold; its anchors come with the command.
    Place(Box<ObjectSpec>),
}

/// How a box is turned.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Turn {
    /// Counter-clockwise, rad.
    By(f64),
    /// To face the ego vehicle.
    ToEgo,
    /// Its back to the ego vehicle.
    FromEgo,
    /// Along its lane.
    WithLane,
    /// Along its lane, the way the ego vehicle goes.
    WithEgo,
    /// Along its lane, towards the ego vehicle's front.
    Against,
}

/// What a command speaks of without naming it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Back {
    /// What was spoken of last: "it".
    Same,
    /// Those that the last ones were picked from, without them: "the other two".
    Others,
    /// "he", "she": what was spoken of last, else the only person.
    Person,
}

/// One command.
#[derive(Clone, Debug)]
pub struct Command {
    /// What to do.
    pub verb: Verb,
    /// Its words.
    pub text: String,
    /// Where in the prompt.
    pub span: Span,
    /// All that was read of it.
    pub reading: Reading,
    /// What it is about.
    pub targets: Vec<Mention>,
    /// Everything that it names, as relations refer to it.
    pub mentions: Vec<Mention>,
    /// Spans of what "the" was said of.
    pub definite: Vec<Span>,
    /// Which of several an anchor is: "behind the nearest car".
    pub picks: Vec<(Span, Pick)>,
    /// What replaces the target.
    pub by: Option<Mention>,
    /// Where to.
    pub destination: Option<Destination>,
    /// Anchors of the destination.
    pub(super) anchors: Vec<ObjectSpec>,
    /// How to turn.
    pub turn: Option<Turn>,
    /// What it should do.
    pub state: Option<ObjectState>,
    /// The words of the colour that it gives.
    pub color: Option<String>,
    /// A lane or strip that was named alone.
    pub place: Option<LaneRole>,
    /// By how much a number changes.
    pub change: Option<Change>,
    /// Which of several in order of distance, from 1; 0 is the last.
    pub nth: Option<usize>,
    /// What it is about was named before.
    pub back: Option<Back>,
    /// What it is not about: "all cars but the taxi".
    pub except: Vec<Mention>,
    /// What is added stands where others were taken away.
    pub in_place: bool,
    /// "only", "just": all else goes.
    pub only: bool,
    /// No verb was said.
    pub implied: bool,
    /// Boxes that were found before an earlier command of the sentence made others of them.
    pub found: Option<Vec<BoxId>>,
    /// Each of those named is meant: "the nurse and the child".
    pub each: bool,
}

impl Command {
    /// A command of which nothing but the verb is known.
    pub(super) fn new(verb: Verb, text: &str, span: Span) -> Self {
        Self {
            verb,
            text: span.of(text).to_string(),
            span,
            reading: Reading::default(),
            targets: Vec::new(),
            mentions: Vec::new(),
            definite: Vec::new(),
            picks: Vec::new(),
            by: None,
            destination: None,
            anchors: Vec::new(),
            turn: None,
            state: None,
            color: None,
            place: None,
            change: None,
            nth: None,
            back: None,
            except: Vec::new(),
            in_place: false,
            only: false,
            implied: false,
            found: None,
            each: false,
        }
    }

    /// The objects of a description that puts `spec`, as `class`, where the destination says.
    pub fn with_anchors(&self, spec: &ObjectSpec, class: Class) -> Vec<ObjectSpec> {
        let mut out = self.anchors.clone();
        if out.is_empty() {
            out.push(spec.clone());
        }
        if let Some(first) = out.first_mut() {
            *first = ObjectSpec {
                class,
                count: Count::exactly(1),
                ..spec.clone()
            };
        }
        out
    }
}

/// "cars: 3, truck: none": each label begins a sentence.
fn labelled_apart(mut tokens: Vec<Token>) -> Vec<Token> {
    let colon = |t: &Token| t.text == ":";
    for i in 1..tokens.len() {
        let label = tokens[i].kind == TokenKind::Comma
            && tokens[..i].iter().any(colon)
            && (i + 2..tokens.len().min(i + 5)).any(|k| {
                colon(&tokens[k])
                    && tokens[i + 1..k].iter().all(|t| t.kind == TokenKind::Word)
                    && super::rephrase::is_noun(&tokens[k - 1])
            });
        // "van to the right lane, buses to the left lane"
        let sends = |part: &[Token]| {
            let to = part
                .iter()
                .take(4)
                .position(|t| matches!(t.text.as_str(), "to" | "onto" | "into"));
            to.is_some_and(|k| {
                k > 0
                    && super::rephrase::is_noun(&part[k - 1])
                    && part[..k].iter().all(|t| t.kind == TokenKind::Word)
            })
        };
        let start = (0..i)
            .rev()
            .find(|k| tokens[*k].kind == TokenKind::Stop)
            .map_or(0, |k| k + 1);
        let label = label
            || tokens[i].kind == TokenKind::Comma && sends(&tokens[start..i]) && sends(&tokens[i + 1..]);
        if label {
            tokens[i].kind = TokenKind::Stop;
        }
    }
    tokens
}

/// The class that a noun names, if the scene has just one of it.
fn only_one(t: &Token, boxes: &BTreeMap<BoxId, SceneBox>) -> Option<Class> {
    let class = match super::lexicon::look_up(&t.text) {
        Some(super::lexicon::Sense::Noun(n, _)) => *n.classes.first()?,
        _ => return None,
    };
    (boxes.values().filter(|b| b.class == class).count() == 1).then_some(class)
}

/// Words of the longest sentence in which turns of speech are looked for.
const LONGEST_SENTENCE: usize = 400;

/// "take it out", "remove them": nothing but that.
fn takes_it(words: &str) -> bool {
    let words = words.to_lowercase();
    let mut list = words
        .split_whitespace()
        .filter(|w| !matches!(*w, "so" | "please" | "just" | "then"));
    let removes = list.next().is_some_and(|w| {
        matches!(
            w,
            "take" | "remove" | "delete" | "erase" | "drop" | "clear" | "get"
        )
    });
    let it = list
        .next()
        .is_some_and(|w| matches!(w, "it" | "them" | "him" | "her"));
    removes && it && list.count() < 3
}

/// "keep exactly two cars": the rest of them goes.
fn keeps_so_many(c: &Command) -> bool {
    let counted = |m: &Mention| !m.definite && !m.uncounted && m.pick.is_none();
    c.verb == Verb::Keep && c.change.is_none() && c.targets.first().is_some_and(counted)
}

/// Reads a text sentence by sentence, each with the scene that those before have left.
pub(super) struct Reader<'t> {
    text: &'t str,
    tokens: Vec<Token>,
    at: usize,
    last_noun: Option<Vec<Token>>,
    /// What the sentences before left to be pointed at.
    left: Left,
    /// What the sentences before named, one of a kind.
    named: Vec<Class>,
    /// What the sentence before left room for.
    room: Room,
    /// The sentence before kept so many: the others are gone.
    kept: bool,
}

impl<'t> Reader<'t> {
    pub(super) fn new(text: &'t str) -> Self {
        Self {
            text,
            tokens: unasked(as_orders(apart(unasked(as_orders(rejoined(labelled_apart(
                super::parker::parker(
                    &told_once(without_asides(pointed_back(
                        super::said::whole(super::said::cut(parted_at_links(plain_beside(facts(
                            super::same_words::commands(&super::common::plain(&tokens(text))),
                        ))))),
                        text,
                    ))),
                    true,
                ),
            ))))))),
            at: 0,
            last_noun: None,
            left: Left::default(),
            named: Vec::new(),
            room: Room::default(),
            kept: false,
        }
    }

    /// True if no sentence is left.
    pub(super) fn ended(&self) -> bool {
        self.tokens[self.at.min(self.tokens.len())..]
            .iter()
            .all(|t| t.kind != TokenKind::Word)
    }

    /// "one pedestrian is enough; take the other two off" is one sentence.
    fn join_enough(&mut self, from: usize) {
        let stop = (from..self.tokens.len()).find(|i| self.tokens[*i].kind == TokenKind::Stop);
        let Some(stop) = stop.filter(|s| *s > from + 1) else {
            return;
        };
        let semicolon = self
            .text
            .get(self.tokens[stop].span.start..self.tokens[stop].span.end)
            == Some(";");
        if semicolon
            && matches!(
                self.tokens[stop - 1].text.as_str(),
                "enough" | "sufficient" | "plenty" | "do"
            )
        {
            self.tokens[stop].kind = TokenKind::Comma;
        }
    }

    /// "keep the bus; remove the others" is one sentence.
    fn join_kept(&mut self, from: usize) {
        const OTHERS: &str = "remove the others|delete the others|erase the others|remove the rest|delete the rest|erase the rest|remove all others|\
            delete all others|remove everything else|delete everything else|clear the rest|take the others away|take the rest away";
        let stop = (from..self.tokens.len()).find(|i| self.tokens[*i].kind == TokenKind::Stop);
        let keeps = begins(
            &self.tokens[from..],
            "keep the|leave the|keep my|keep only the|leave only the|keep both|keep just the",
        );
        if let (Some(stop), Some(_)) = (stop, keeps)
            && begins(&self.tokens[stop + 1..], OTHERS).is_some()
        {
            self.tokens[stop].kind = TokenKind::Comma;
        }
    }

    /// The commands of the next sentence; `None` at the end.
    pub(super) fn next(
        &mut self,
        map: &LaneMap<'_>,
        boxes: &BTreeMap<BoxId, SceneBox>,
        last: &[BoxId],
    ) -> Option<Vec<Command>> {
        if self.at >= self.tokens.len() {
            return None;
        }
        let from = self.at;
        self.join_enough(from);
        self.join_kept(from);
        let stop = (from..self.tokens.len()).find(|i| self.tokens[*i].kind == TokenKind::Stop);
        // "Woman to my right. Same distance." is one sentence
        let stop = stop.map(|s| {
            let goes_on = begins(
                &self.tokens[s + 1..],
                "same distance|at the same distance|the same distance",
            )
            .is_some();
            if !goes_on {
                return s;
            }
            self.tokens[s].kind = TokenKind::Comma;
            (s..self.tokens.len())
                .find(|i| self.tokens[*i].kind == TokenKind::Stop)
                .unwrap_or(self.tokens.len() - 1)
        });
        let end = stop.map_or(self.tokens.len(), |s| s + 1);
        self.at = end;
        let of_last = last.first().and_then(|id| boxes.get(id)).map(|b| b.class);
        let talk = Talk {
            text: self.text,
            other: self.named.iter().rev().copied().find(|c| Some(*c) != of_last),
            map,
            boxes,
            others: begins(
                &self.tokens[end..],
                "the other|the others|and the other|but the other|the rest|the remaining|and the others",
            )
            .is_some(),
            carried: false,
            room: self.room,
            last: of_last.map(|c| c.label()),
        };
        let asked = self.tokens[from..end]
            .last()
            .is_some_and(|t| self.text.get(t.span.start..t.span.end) == Some("?"));
        let pointed = self.left.resolved(&self.tokens[from..end], &talk);
        // (nobody says so much in one sentence; it is read as a list of plain commands)
        if end - from > LONGEST_SENTENCE {
            return Some(imperatives(
                self.text,
                &rephrase(&self.tokens[from..end]),
                &mut self.last_noun,
            ));
        }
        let whole = &super::said::spared(&chosen(&pointed, &talk))[..];
        let cut = except(whole);
        let pieces = said(&worded(cut.as_ref().map_or(whole, |c| &c.0), &talk), &talk);
        let mut out: Vec<Command> = Vec::new();
        for piece in pieces {
            match piece {
                Piece::Meant(command, noun) => {
                    self.last_noun = noun.or(self.last_noun.take());
                    out.push(*command);
                }
                Piece::Plain(tokens) => {
                    out.extend(imperatives(self.text, &rephrase(&tokens), &mut self.last_noun));
                }
            }
        }
        // "delete the car behind us, but keep the black car"
        let kept: Vec<Mention> = out
            .iter()
            .filter(|c| c.verb == Verb::Keep && !c.only && c.change.is_none())
            .flat_map(|c| {
                c.targets
                    .iter()
                    .filter(|m| m.definite && m.uncounted && !m.plural && m.spec.relations.is_empty())
            })
            .cloned()
            .collect();
        for c in out
            .iter_mut()
            .filter(|c| c.verb == Verb::Remove && c.except.is_empty())
        {
            c.except.clone_from(&kept);
        }
        // "I don't need the blue car any more, take it out": said twice
        for i in 1..out.len() {
            let again =
                out[i].verb == Verb::Remove && out[i - 1].verb == Verb::Remove && takes_it(&out[i].text);
            if again {
                out[i].verb = Verb::Note;
            }
        }
        // "one man is plenty there; stand the others down": said twice
        for i in 0..out.len() {
            let kept = match i {
                0 => self.kept,
                _ => keeps_so_many(&out[i - 1]),
            };
            if kept && out[i].verb == Verb::Remove && out[i].back == Some(Back::Others) {
                out[i].verb = Verb::Note;
            }
        }
        self.kept = out.last().is_some_and(keeps_so_many);
        self.room = out
            .iter()
            .rev()
            .find_map(|c| room_of(c.verb))
            .unwrap_or(self.room);
        let quiet = out.iter().all(|c| c.verb == Verb::Note);
        self.left = Left::of(&pointed, asked, quiet, std::mem::take(&mut self.left));
        if let Some((_, np)) = cut {
            let mut spared = Command::new(Verb::Note, self.text, np[0].span);
            target_part(self.text, &tag(&np), &mut spared);
            for c in out
                .iter_mut()
                .filter(|c| c.targets.iter().any(|t| t.plural || t.pick == Some(Pick::All)))
                .take(1)
            {
                c.except.clone_from(&spared.targets);
            }
        }
        self.named = (from..end)
            .filter_map(|i| only_one(&self.tokens[i], boxes))
            .collect();
        Some(out)
    }
}
