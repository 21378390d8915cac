//! A prompt to a structured description: a shallow grammar over tagged words. Every word ends up in a phrase,
//! among the small words, or in `not_understood`; nothing is guessed.
//!
//! A clause has a subject (the first noun that no preposition leads to). A relation belongs to the noun before it; after
//! a comma, `and` or a finite verb to the subject; at the start of a clause to the nouns that follow.

mod ahead;
mod denied;
mod groups;
mod headings;
mod labels;
mod nouns;
mod numbers;
mod pairs;
mod relations;
mod sense;
mod sides;
mod small;
mod states;
mod style;

use super::description::{Anchor, Became, Count, Description, Phrase, Reading, Stated, Unread};
use super::lexicon::Sense;
use super::mention::{Frag, Mention, Pre, Prep};
use super::tag::{Item, Tag, tag};
use super::tokens::{LONGEST, Span, tokens};
use super::wording;
use crate::scene::graph::{ObjectState, RelationKind};

/// Most objects that one prompt may place; more are counted, not placed.
pub const MOST_MENTIONS: usize = 200;

pub(super) struct Pending {
    pub(super) prep: Prep,
    span: Span,
    first: Option<Anchor>,
    fresh: bool,
    anded: bool,
    pub(super) not: bool,
    finite: bool, // said by "is": of the subject
    ego: bool,    // the ego vehicle is the subject
    distance_m: Option<f64>,
}

/// The state of reading.
pub(super) struct Parser<'a> {
    prompt: &'a str,
    pub(super) items: &'a [Item],
    pub(super) at: usize,
    pub(super) mentions: Vec<Mention>,
    pub(super) reading: Reading,
    pub(super) head: Vec<usize>,
    pub(super) last: Vec<usize>,
    pub(super) before: Vec<usize>, // subject of the clause before
    pub(super) fronted: Vec<Frag>,
    pub(super) headed: Vec<Frag>, // "our lane: a van at 10 m, another at 25 m": of all of the list
    pub(super) fronted_state: Option<ObjectState>,
    fronted_both: Option<bool>,  // "on both sides stand ..."
    pub(super) chain: bool,      // only nouns so far in this clause
    pub(super) list: Vec<usize>, // those nouns
    linked: bool,                // "and" or a comma right before
    anded: bool,                 // "and" right before
    pub(super) fresh: bool,      // nothing but small words since the clause began or a comma
    pub(super) pending: Option<Pending>,
    pub(super) pre: Pre,
    not_goes_on: bool,
    distance: Option<(f64, Span)>,
    pub(super) topic: Option<(Anchor, Span)>,
    reversed: Option<(RelationKind, Span, Vec<usize>, Option<Anchor>)>,
    pub(super) relative: bool,
    ego_subject: bool,                     // "I am behind a bus"
    ego_named: bool,                       // "the host vehicle": "it" may mean it
    ego_topic: bool,                       // "it" did mean it in this sentence
    last_lane: Option<Anchor>,             // named last
    pub(super) last_place: Option<Anchor>, // the same of any place but the road
    pub(super) whole: Option<usize>,       // the group that the last part was taken from
    sentence: usize,                       // the first mention of the sentence
    sentence_before: usize,                // of the last one that named something
    pub(super) alike: Option<usize>,       // "so is the bus": what the next noun is like
    pub(super) enumerated: Option<usize>, // "People: two on the left, ..." counts this group one after another
    front: Option<Anchor>,                // what a place at the head of a clause was of
    pair: Vec<usize>,                     // the two of "between a van and a lorry"
    with: bool,
    pub(super) edits: bool,
    pub(super) order: Option<(bool, Option<usize>)>, // a list by distance: near first, the one before
    pub(super) aside: Option<(usize, usize)>,        // a group and the part of it that a comma set apart
    denied: bool,                                    // what follows says where something is not
    pub(super) listed: Vec<Stated>,                  // where what a colon introduces stands
}

/// Reads a prompt.
pub fn read(prompt: &str) -> Reading {
    let tokens = wording::prompt(&tokens(prompt));
    let items = tag(&tokens);
    let mut parser = Parser::new(prompt, &items, false);
    parser.run();
    let mut reading = parser.finish();
    if prompt.len() > LONGEST {
        reading.not_understood.push(Unread {
            span: Span {
                start: LONGEST,
                end: prompt.len(),
            },
            text: "...".into(),
            why: Some(format!("only the first {LONGEST} bytes are read")),
        });
    }
    reading
}

impl<'a> Parser<'a> {
    pub(super) fn new(prompt: &'a str, items: &'a [Item], edits: bool) -> Self {
        Self {
            prompt,
            items,
            at: 0,
            mentions: Vec::new(),
            reading: Reading::default(),
            head: Vec::new(),
            last: Vec::new(),
            before: Vec::new(),
            fronted: Vec::new(),
            headed: Vec::new(),
            fronted_state: None,
            fronted_both: None,
            chain: true,
            list: Vec::new(),
            linked: false,
            anded: false,
            fresh: true,
            pending: None,
            pre: Pre::default(),
            not_goes_on: false,
            distance: None,
            topic: None,
            reversed: None,
            relative: false,
            ego_subject: false,
            ego_named: false,
            ego_topic: false,
            last_lane: None,
            last_place: None,
            whole: None,
            sentence: 0,
            sentence_before: 0,
            alike: None,
            enumerated: None,
            front: None,
            pair: Vec::new(),
            with: false,
            edits,
            order: None,
            aside: None,
            denied: false,
            listed: Vec::new(),
        }
    }

    fn d(&mut self) -> &mut Description {
        &mut self.reading.description
    }

    pub(super) fn item(&self, i: usize) -> Option<&'a Item> {
        self.items.get(i)
    }

    pub(super) fn sense(&self, i: usize) -> Option<Sense> {
        match self.item(i)?.tag {
            Tag::Is(s) => Some(s),
            _ => None,
        }
    }

    pub(super) fn run(&mut self) {
        while self.at < self.items.len() {
            let item = &self.items[self.at];
            if let Some(meant) = item.read_as {
                let note = format!("{:?} was read as {meant:?}", item.words);
                self.reading.notes.push(note);
            }
            let small = self.step(item);
            // what describes a noun to come leaves the list that it is one of
            let small =
                small || self.pending.is_none() && self.pre.says_something() && self.noun_ahead(self.at + 1);
            if !small {
                self.linked = false;
                self.anded = false;
                self.fresh = false;
            }
            self.at += 1;
        }
        self.end_clause();
    }

    /// Reads one item; true if it was a small word that leaves boundaries as they are.
    fn step(&mut self, item: &'a Item) -> bool {
        let span = item.span;
        match item.tag {
            Tag::Stop => {
                self.ego_topic = false;
                self.enumerated = None;
                self.headed.clear();
                if self.sentence < self.mentions.len() {
                    self.sentence_before = self.sentence;
                }
                self.sentence = self.mentions.len();
                self.order = None;
                self.end_clause();
                return true;
            }
            Tag::Comma | Tag::Mark if item.words == "#" => {
                return true;
            }
            Tag::Comma | Tag::Mark => {
                let idle = self.pending.as_ref().is_some_and(|p| p.first.is_none());
                if item.words == ":" && self.mentions.is_empty() {
                    // "Follow-to-stop:" is a heading, "Ahead:" is not
                    if idle {
                        self.pending = None;
                    }
                    self.fronted.retain(|f| match &f.prep {
                        Prep::Rels(kinds) if f.anchor == Anchor::Ego => !kinds.iter().any(|k| {
                            matches!(
                                k,
                                RelationKind::Following
                                    | RelationKind::Blocking
                                    | RelationKind::Crossing
                                    | RelationKind::Facing
                            )
                        }),
                        _ => true,
                    });
                }
                if item.words == ":" {
                    // "we would like this: ..." is not about us
                    self.ego_subject &=
                        !self.head.is_empty() || !self.last.is_empty() || self.pending.is_some();
                    self.heading();
                }
                self.flush();
                if item.words == ":" {
                    self.introduce();
                }
                let just_not = self.sense(self.at.wrapping_sub(1)) == Some(Sense::Not); // "you may not, since ..."
                let not_list = self.pre.not && !self.pre.says_something() && !just_not;
                self.pre = Pre {
                    not: not_list,
                    ..Pre::default()
                };
                self.not_goes_on &= self.list_goes_on();
                self.past_aside();
                self.linked = true;
                self.denied = false;
                self.fresh = true;
                self.relative = false;
                self.reversed = self.reversed.take().filter(|_| self.last.is_empty());
                return true;
            }
            Tag::Unknown => {
                // "on arrival one truck stood there": what the preposition led to is not known
                let led = self
                    .pending
                    .as_ref()
                    .is_some_and(|p| matches!(p.prep, Prep::In | Prep::At));
                let fresh = matches!(
                    self.item(self.at + 1).map(|n| n.tag),
                    Some(Tag::Number(_) | Tag::Comma | Tag::Is(Sense::Article(_) | Sense::Count(_)))
                );
                // "pushing a wheelbarrow": what it is beside is not known
                let beside = self
                    .pending
                    .as_ref()
                    .is_some_and(|p| p.first.is_none() && p.prep == Prep::Rels(vec![RelationKind::NextTo]));
                let article = matches!(self.sense(self.at.wrapping_sub(1)), Some(Sense::Article(false)));
                if beside && article && !self.edits && !self.noun_ahead(self.at + 1) {
                    self.pending = None;
                    for i in self.last.clone() {
                        let spec = &mut self.mentions[i].spec;
                        spec.state = spec.state.or(Some(ObjectState::Moving));
                    }
                }
                if led && fresh && !self.edits {
                    self.pending = None;
                }
                // "a grader is levelling the oncoming lane": where it does that
                let the = usize::from(matches!(self.sense(self.at + 1), Some(Sense::Article(true))));
                let place = matches!(
                    self.sense(self.at + 1 + the),
                    Some(Sense::Place(Anchor::Lane(_), _))
                );
                let mine = self
                    .item(self.at + 1)
                    .is_some_and(|n| n.words.starts_with("our ") || n.words.starts_with("my "));
                let does = item.words.ends_with("ing") && self.after_is()
                    // "a snow plough clears our lane"
                    || item.words.ends_with('s')
                        && the + usize::from(mine) > 0
                        && matches!(self.sense(self.at.wrapping_sub(1)), Some(Sense::Noun(_, false)));
                if place && does && self.pending.is_none() && !self.last.is_empty() && !self.edits {
                    self.begin(Prep::In, span);
                    return true;
                }
                self.unread(span, None);
                return true;
            }
            Tag::Number(v) => {
                if self.item(self.at.wrapping_sub(1)).is_some_and(|b| b.words == "#") {
                    self.pre.id = Some(v as u32);
                    self.pre.cover(span);
                    if !self.noun_ahead(self.at + 1) && self.edits {
                        self.mention_by_id(span);
                    }
                    return false;
                }
                if !self.edits && self.labelled(v) {
                    return false;
                }
                let label = self.item(self.at + 1).is_some_and(|n| n.words == ":");
                if !self.edits
                    && label
                    && matches!(self.sense(self.at.wrapping_sub(1)), Some(Sense::Noun(_, false)))
                    && let Some(&i) = self.last.last()
                {
                    // "Ped 1: on the crossing"
                    self.mentions[i].uncounted = false;
                    return false;
                }
                if self.edits
                    && !matches!(self.sense(self.at + 1), Some(Sense::Unit(_)))
                    && let (Some(&i), Some(Sense::Noun(..))) =
                        (self.history_last(), self.sense(self.at.wrapping_sub(1)))
                {
                    // "car 7"
                    self.mentions[i].id = Some(v as u32);
                    self.mentions[i].spec.span = self.mentions[i].spec.span.to(span);
                    return false;
                }
                if self.try_distance(v, span) {
                    return self.distance.is_some();
                }
                let back = if self.item(self.at.wrapping_sub(1)).is_some_and(|i| i.words == ":") {
                    2
                } else {
                    1
                };
                if v == 0.0 && self.none_of_it(back, span) {
                    return false;
                }
                if matches!(self.sense(self.at.wrapping_sub(back)), Some(Sense::Noun(..)))
                    && !self.noun_ahead(self.at + 1)
                    && (1.0..1000.0).contains(&v)
                    && (back == 1 || self.ends(self.at + 1))
                    && let Some(&i) = self.last.last()
                    && self.mentions[i].uncounted
                {
                    // "cones x8"
                    let m = &mut self.mentions[i];
                    m.spec.count = Count::exactly(v as u32);
                    m.uncounted = false;
                    m.spec.span = m.spec.span.to(span);
                    return false;
                }
                let n = if v.is_finite() && v >= 0.0 {
                    v.round().min(1e6) as u32
                } else {
                    1_000_000
                };
                self.count(Count::exactly(n), span);
            }
            Tag::Is(sense) => return self.sense_step(sense, item),
        }
        false
    }

    // --- clauses ---

    pub(super) fn new_clause(&mut self) {
        self.denied = false;
        if !self.head.is_empty() {
            self.before = std::mem::take(&mut self.head);
        }
        self.last.clear();
        self.list.clear();
        self.fronted.clear();
        self.fronted_state = None;
        self.fronted_both = None;
        self.reversed = None;
        self.relative = false;
        self.ego_subject = false;
        self.with = false;
        self.chain = true;
    }

    fn soft_end(&mut self) {
        self.flush();
        self.new_clause();
        self.pre = Pre::default();
        self.fresh = true;
        self.not_goes_on = false;
    }

    fn end_clause(&mut self) {
        self.listed.clear();
        self.soft_end();
        self.linked = false;
        if let Some((_, span)) = self.distance.take() {
            self.unread(span, Some("a distance to what?".into()));
        }
        self.topic = None;
    }

    fn phrase(&mut self, span: Span, became: Became, meaning: &str) {
        self.reading.phrases.push(Phrase {
            span,
            text: span.of(self.prompt).to_string(),
            became,
            meaning: meaning.to_string(),
        });
    }

    fn unread(&mut self, span: Span, why: Option<String>) {
        // Neighbours become one entry.
        if let Some(last) = self.reading.not_understood.last_mut()
            && last.why == why
            && self
                .prompt
                .get(last.span.end..span.start)
                .is_some_and(|gap| gap.trim().is_empty() && gap.len() < 3)
        {
            last.span = last.span.to(span);
            last.text = last.span.of(self.prompt).to_string();
            return;
        }
        self.reading.not_understood.push(Unread {
            span,
            text: span.of(self.prompt).to_string(),
            why,
        });
    }

    pub(super) fn finish(mut self) -> Reading {
        super::finish::finish(&mut self.mentions, &mut self.reading, self.prompt);
        self.reading
    }
}

fn is_directed(kind: RelationKind) -> bool {
    !matches!(
        kind,
        RelationKind::On | RelationKind::ParkedOn | RelationKind::Crossing | RelationKind::WaitingAt
    )
}

pub(super) fn is_prenominal(words: &str) -> bool {
    matches!(
        words,
        "oncoming"
            | "distant"
            | "nearby"
            | "approaching"
            | "opposing"
            | "incoming"
            | "on coming"
            | "upcoming"
    )
}

fn is_color(words: &str) -> bool {
    matches!(words, "grey" | "gray" | "dark" | "bright")
}

fn places_color(words: &str) -> &'static str {
    match words {
        "dark" => "dark",
        "bright" => "bright",
        _ => "grey",
    }
}
