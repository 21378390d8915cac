//! A prompt to a structured description: a shallow grammar over tagged words. Every word ends up in a phrase,
//! among the small words, or in `not_understood`; nothing is guessed.
//!
//! A clause has a subject (the first noun that no preposition leads to). A relation belongs to the noun before it; after
//! a comma, `and` or a finite verb to the subject; at the start of a clause to the nouns that follow.

use super::description::{
    Absent, Anchor, Became, Count, Density, Description, Phrase, Reading, Road, Stated, TimeOfDay, Unread,
    Weather,
};
use super::lexicon::Sense;
use super::mention::{Frag, Mention, Pre, Prep, apply};
use super::tag::{Item, Tag, tag};
use super::tokens::{LONGEST, Span, tokens};
use super::words::edits::{Pick, Verb};
use super::words::objects::{NOUNS, WORKS};
use super::words::places;
use crate::scene::Class;
use crate::scene::graph::{LaneRole, ObjectState, RelationKind};

/// Most objects that one prompt may place; more are counted, not placed.
pub const MOST_MENTIONS: usize = 200;

pub(super) struct Pending {
    pub(super) prep: Prep,
    span: Span,
    first: Option<Anchor>,
    fresh: bool,
    anded: bool,
    pub(super) not: bool,
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
    fronted_state: Option<ObjectState>,
    pub(super) chain: bool, // only nouns so far in this clause
    list: Vec<usize>,       // those nouns
    linked: bool,           // "and" or a comma right before
    anded: bool,            // "and" right before
    fresh: bool,            // nothing but small words since the clause began or a comma
    pub(super) pending: Option<Pending>,
    pub(super) pre: Pre,
    not_goes_on: bool,
    distance: Option<(f64, Span)>,
    topic: Option<(Anchor, Span)>,
    reversed: Option<(RelationKind, Span, Vec<usize>, Option<Anchor>)>,
    relative: bool,
    with: bool,
    pub(super) edits: bool,
    denied: bool,                   // what follows says where something is not
    pub(super) listed: Vec<Stated>, // where what a colon introduces stands
}

/// Reads a prompt.
pub fn read(prompt: &str) -> Reading {
    let tokens = tokens(prompt);
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
            fronted_state: None,
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
            with: false,
            edits,
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

    /// True if a noun phrase begins at item `i`.
    pub(super) fn noun_ahead(&self, i: usize) -> bool {
        for j in i..(i + 10).min(self.items.len()) {
            let item = &self.items[j];
            match item.tag {
                Tag::Is(Sense::Noun(..) | Sense::Works) => return true,
                Tag::Is(
                    Sense::Article(_)
                    | Sense::Count(_)
                    | Sense::State(_, false)
                    | Sense::Size(_)
                    | Sense::Color(_)
                    | Sense::Attribute(_)
                    | Sense::Pick(_)
                    | Sense::Part(_)
                    | Sense::Not,
                ) => {}
                Tag::Is(Sense::Weather(_) | Sense::Time(_)) if is_color(&item.words) => {}
                Tag::Is(Sense::EgoRel(_)) if is_prenominal(&item.words) => {}
                // "in the car park stand two cars"
                Tag::Is(Sense::State(_, true)) if j == i => {}
                Tag::Is(Sense::Filler)
                    if matches!(
                        item.words.as_str(),
                        "of" | "about"
                            | "exactly"
                            | "only"
                            | "just"
                            | "other"
                            | "there is"
                            | "there are"
                            | "is"
                            | "are"
                            | "my"
                            | "another"
                    ) => {}
                Tag::Number(_) if !matches!(self.sense(j + 1), Some(Sense::Unit(_))) => {}
                Tag::Unknown => {}
                _ => return false,
            }
        }
        false
    }

    /// True if something that a relation can end in begins at item `i`.
    fn anchor_ahead(&self, i: usize) -> bool {
        let mut j = i;
        while matches!(
            self.sense(j),
            Some(Sense::Article(_) | Sense::Filler | Sense::Size(_) | Sense::Attribute(_))
        ) {
            j += 1;
        }
        matches!(
            self.sense(j),
            Some(Sense::Ego | Sense::Pronoun | Sense::Place(..) | Sense::Part(_))
        ) || self.noun_ahead(j)
    }

    pub(super) fn run(&mut self) {
        while self.at < self.items.len() {
            let item = &self.items[self.at];
            if let Some(meant) = item.read_as {
                let note = format!("{:?} was read as {meant:?}", item.words);
                self.reading.notes.push(note);
            }
            let small = self.step(item);
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
                self.end_clause();
                return true;
            }
            Tag::Comma | Tag::Mark if item.words == "#" => {
                return true;
            }
            Tag::Comma | Tag::Mark => {
                self.flush();
                if item.words == ":" {
                    self.introduce();
                }
                let not_list = self.pre.not && !self.pre.says_something();
                self.pre = Pre {
                    not: not_list,
                    ..Pre::default()
                };
                self.not_goes_on &= self.list_goes_on();
                self.linked = true;
                self.denied = false;
                self.fresh = true;
                self.relative = false;
                self.reversed = self.reversed.take().filter(|_| self.last.is_empty());
                return true;
            }
            Tag::Unknown => {
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
                    return false;
                }
                let back = if self.item(self.at.wrapping_sub(1)).is_some_and(|i| i.words == ":") {
                    2
                } else {
                    1
                };
                if matches!(self.sense(self.at.wrapping_sub(back)), Some(Sense::Noun(_, true)))
                    && !self.noun_ahead(self.at + 1)
                    && (1.0..1000.0).contains(&v)
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

    fn sense_step(&mut self, sense: Sense, item: &'a Item) -> bool {
        let span = item.span;
        let prenominal = self.noun_directly(self.at + 1);
        match sense {
            Sense::Filler | Sense::Unit(_) | Sense::Away | Sense::Bound(_) => {
                match item.words.as_str() {
                    "with" | "has" | "have" | "having" => {
                        self.with = true;
                        self.topic = None;
                    }
                    "which" | "who" | "that is" | "that are" | "who is" | "who are" | "which is"
                    | "which are" | "thats" | "whos" => {
                        self.relative = true;
                    }
                    "each" | "every" => self.pre.each = true,
                    "it is" | "its" | "its a" if self.head.is_empty() => {
                        self.head = self.before.clone();
                        self.last = self.before.clone();
                        self.chain = false;
                    }
                    "where" => self.end_clause(),
                    _ => {}
                }
                return true;
            }
            Sense::Fraction(share) => {
                if let Some(Sense::Unit(m)) = self.sense(self.at + 1) {
                    self.at += 1;
                    let span = span.to(self.items[self.at].span);
                    self.distance_said(share * m, span);
                } else {
                    return true;
                }
            }
            Sense::Pick(pick) => {
                match pick {
                    Pick::More => {}
                    // "the cone furthest away"
                    _ if self.edits && !self.noun_ahead(self.at + 1) && !self.last.is_empty() => {
                        for i in self.last.clone() {
                            self.mentions[i].pick = Some(pick);
                        }
                        self.pending = None;
                        return false;
                    }
                    _ => self.pre.pick = Some(pick),
                }
                self.pre.cover(span);
            }
            Sense::Verb(verb) => {
                // In a description, "remove all cars" means that there are none, other verbs add nothing.
                self.flush();
                self.pre = Pre {
                    not: verb == Verb::Remove,
                    ..Pre::default()
                };
                self.fresh = true;
                self.head.clear();
                return true;
            }
            Sense::And | Sense::Or => {
                if let Some(p) = &self.pending
                    && p.first.is_some()
                {
                    return true; // between A and B
                }
                self.flush();
                if sense == Sense::And {
                    self.not_goes_on &= self
                        .items
                        .get(self.at + 1)
                        .is_some_and(|i| matches!(i.tag, Tag::Is(Sense::Noun(..))))
                        || self.list_goes_on();
                }
                self.linked = true;
                self.anded = true;
                self.fresh = true;
                self.relative = false;
                return true;
            }
            Sense::But => {
                self.soft_end();
                return true;
            }
            Sense::Article(definite) => {
                self.pre.article = Some(definite);
                self.pre.cover(span);
                return true;
            }
            // "deserted except for a bicycle"
            Sense::Not
                if item.words.starts_with("except")
                    && (self.d().density == Some(Density::Empty) || !self.d().absent.is_empty()) =>
            {
                self.denied = false;
                self.not_goes_on = false;
                return true;
            }
            Sense::Not => {
                self.pre.not = true;
                self.pre.cover(span);
                return true;
            }
            Sense::Nobody => {
                self.absent(vec![Class::Pedestrian], None, span);
            }
            Sense::Count(count)
                if !count.is_exact() && matches!(self.sense(self.at + 1), Some(Sense::Unit(_))) =>
            {
                self.at += 1;
                let span = span.to(self.items[self.at].span);
                self.unread(span, Some("how many?".into()));
            }
            Sense::Count(count) => {
                let unit = matches!(self.sense(self.at + 1), Some(Sense::Unit(_)));
                if unit && self.try_distance(f64::from(count.n), span) {
                    return false;
                }
                if let (Some(Sense::Fraction(share)), Some(Sense::Unit(m))) =
                    (self.sense(self.at + 1), self.sense(self.at + 2))
                {
                    self.at += 2;
                    let span = span.to(self.items[self.at].span);
                    self.distance_said((f64::from(count.n) + share) * m, span);
                    return false;
                }
                self.count(count, span);
            }
            Sense::State(state, finite) => self.state(state, finite, prenominal, item),
            Sense::Size(size) => {
                if prenominal {
                    self.pre.size = Some(size);
                    self.pre.cover(span);
                } else if !matches!(
                    self.sense(self.at + 1),
                    Some(Sense::Place(..) | Sense::RoadKind(..))
                ) {
                    let targets = self.subjects(true);
                    for t in targets {
                        self.mentions[t].spec.size = Some(size);
                    }
                }
            }
            Sense::Color(color) => self.color(color, prenominal, span),
            Sense::Attribute(word) => {
                if prenominal {
                    self.pre.attributes.push(word.to_string());
                    self.pre.cover(span);
                } else {
                    for t in self.targets() {
                        self.mentions[t].spec.attributes.push(word.to_string());
                    }
                }
            }
            Sense::Noun(_, false) if item.words.is_ascii() && self.noun_next() => {
                // "tanker lorry", "bus driver": the last noun says what it is.
                self.pre.cover(span);
                self.pre.attributes.push(item.words.clone());
            }
            Sense::Noun(noun, plural) => {
                let word = item.read_as.unwrap_or(&item.words).to_string();
                self.noun(noun, &word, plural, span);
            }
            Sense::Works => self.works(span),
            Sense::Rel(kind) => {
                if kind == RelationKind::Near
                    && matches!(item.words.as_str(), "around" | "about")
                    && !self.anchor_ahead(self.at + 1)
                {
                    return true;
                }
                self.begin(Prep::Rels(vec![kind]), span);
            }
            Sense::EgoRel(kinds) => {
                if is_prenominal(&item.words) && self.noun_directly(self.at + 1) && !self.takes_object(item) {
                    self.fronted_once(kinds, span);
                    return false;
                }
                let of = self.item(self.at + 1).is_some_and(|n| n.words == "of");
                // "on the left a bus, in front a cone and behind a person"
                let listed = self.fresh
                    && self.fronted.last().is_some_and(|f| f.anchor == Anchor::Ego)
                    && matches!(
                        self.sense(self.at + 1),
                        Some(Sense::Article(false) | Sense::Count(_))
                    )
                    && self.noun_ahead(self.at + 1);
                if listed {
                    self.begin(Prep::Rels(kinds.to_vec()), span);
                    self.anchor(Anchor::Ego, span);
                } else if (of || self.takes_object(item)) && self.anchor_ahead(self.at + 1) {
                    self.begin(Prep::Rels(kinds.to_vec()), span);
                } else {
                    self.begin(Prep::Rels(kinds.to_vec()), span);
                    let host = self
                        .last
                        .first()
                        .and_then(|&i| self.mentions[i].host)
                        .filter(|_| {
                            matches!(
                                item.words.as_str(),
                                "behind" | "in front" | "close behind" | "right behind" | "ahead"
                            )
                        });
                    self.anchor(host.map_or(Anchor::Ego, Anchor::Object), span);
                }
            }
            Sense::Reversed(kind) => {
                self.flush();
                let subjects = self.subjects(false);
                let topic = self.topic.take().map(|t| t.0);
                self.reversed = Some((kind, span, subjects, topic));
            }
            Sense::Fixed(kind, anchor) => {
                self.reading.description.road.crossing |= anchor == Anchor::Crossing;
                self.begin(Prep::Rels(vec![kind]), span);
                self.anchor(anchor, span);
            }
            Sense::FarSide => {
                self.begin(Prep::FarSide, span);
                self.anchor(Anchor::Ego, span);
            }
            Sense::BothSides(each) => {
                self.flush();
                let targets = self.targets();
                if targets.is_empty() {
                    self.unread(span, Some("nothing stands before it".into()));
                }
                let each = each || targets.iter().any(|t| self.mentions[*t].spec.count.n == 1);
                self.chain = false;
                for t in targets {
                    self.mentions[t].both = Some(each);
                    self.mentions[t].spec.span = self.mentions[t].spec.span.to(span);
                }
            }
            Sense::In => {
                // "on" before a bound or a kind of road is a small word.
                self.begin(Prep::In, span);
            }
            Sense::At => self.begin(Prep::At, span),
            Sense::Across => self.begin(Prep::Across, span),
            Sense::Place(anchor, road) => self.place(anchor, road, item),
            Sense::RoadKind(road, environment) => self.road_kind(road, environment, span),
            Sense::OneWay => {
                self.d().road.one_way = true;
                self.phrase(span, Became::Road, "one-way road");
                self.drop_pending();
            }
            Sense::Width(narrow) => {
                let road = &mut self.d().road;
                (road.narrow, road.wide) = (narrow, !narrow);
                self.phrase(
                    span,
                    Became::Road,
                    if narrow { "narrow road" } else { "wide road" },
                );
                self.drop_pending();
            }
            Sense::Ego => {
                if self.pending.is_some() {
                    self.anchor(Anchor::Ego, span);
                } else {
                    return true;
                }
            }
            Sense::Pronoun => return self.pronoun(item),
            Sense::Part(_) if self.pending.is_some() && !self.noun_ahead(self.at + 1) => {
                // "one in front of the other"
                let targets = self.targets();
                let noun = targets.first().map(|t| self.mentions[*t].spec.noun.clone());
                let other = (0..self.mentions.len())
                    .rev()
                    .find(|i| !targets.contains(i) && Some(&self.mentions[*i].spec.noun) == noun.as_ref());
                match other {
                    Some(i) => self.anchor(Anchor::Object(i), span),
                    None => {
                        let span = self.pending.take().map_or(span, |p| p.span.to(span));
                        self.unread(span, Some("what it points to was not named".into()));
                    }
                }
            }
            Sense::Part(all) => self.part(all, Count::exactly(1), span),
            Sense::Time(time) => {
                if (is_color(&item.words) || item.words == "dark") && prenominal {
                    self.pre.attributes.push(item.words.clone());
                    return false;
                }
                self.time(time, span);
            }
            Sense::Weather(weather) => {
                let described =
                    is_color(&item.words) && (prenominal || self.after_is() && !self.head.is_empty());
                if described {
                    let word = places_color(&item.words);
                    self.color(word, prenominal, span);
                } else {
                    self.weather(weather, span);
                }
            }
            Sense::Environment(environment) => {
                if !self.pre.not {
                    self.d().environment.get_or_insert(environment);
                    self.phrase(
                        span,
                        Became::Environment,
                        &format!("surroundings: {}", environment.name()),
                    );
                }
                self.drop_pending();
                self.pre = Pre::default();
            }
            Sense::Density(density) => {
                let density = match (self.pre.not, density) {
                    (true, Density::Empty) => Density::Light,
                    (true, _) => Density::Empty,
                    (false, d) => d,
                };
                self.pre.not = false;
                self.d().density = Some(density);
                self.phrase(span, Became::Density, &format!("traffic: {}", density.name()));
                if self
                    .pending
                    .as_ref()
                    .is_some_and(|p| matches!(p.prep, Prep::In | Prep::At))
                    && !self.anchor_ahead(self.at + 1)
                {
                    self.drop_pending();
                }
                return true;
            }
            Sense::Background => {
                let lead = self.pending.take();
                if let Some(p) = lead.filter(|p| matches!(p.prep, Prep::Rels(_))) {
                    let span = p.span.to(span);
                    self.unread(
                        span,
                        Some("surroundings are drawn freely: nothing can be placed by them".into()),
                    );
                } else if self.pre.not {
                    self.unread(span, Some("surroundings are drawn freely".into()));
                } else {
                    let index = self.reading.description.background.len();
                    let word = item.words.clone();
                    self.phrase(span, Became::Background(index), &format!("background: {word}"));
                    self.d().background.push(word);
                }
                self.pre = Pre::default();
            }
            Sense::Cannot(why) => {
                let span = self.pre.span.map_or(span, |s| s.to(span));
                let span = self.pending.take().map_or(span, |p| p.span.to(span));
                self.pre = Pre::default();
                self.unread(span, Some(why.into()));
            }
        }
        false
    }

    fn after_is(&self) -> bool {
        let before = self.item(self.at.wrapping_sub(1)).map(|i| i.words.as_str());
        matches!(before, Some("is" | "are" | "was" | "looks"))
    }

    /// True if a list of denied things goes on after a comma: "no cars, buses or people".
    fn list_goes_on(&self) -> bool {
        let mut j = self.at + 1;
        while let Some(item) = self.item(j) {
            match item.tag {
                Tag::Is(Sense::Or) => return true,
                Tag::Is(Sense::Noun(_, true))
                | Tag::Comma
                | Tag::Is(Sense::State(_, false) | Sense::Color(_)) => j += 1,
                _ => return false,
            }
        }
        false
    }

    fn takes_object(&self, item: &Item) -> bool {
        places::RELATIONS
            .iter()
            .any(|(_, l)| l.split('|').any(|w| w.trim() == item.words))
    }

    fn noun_directly(&self, i: usize) -> bool {
        for j in i..(i + 6).min(self.items.len()) {
            match self.items[j].tag {
                Tag::Is(Sense::Noun(..)) => return true,
                Tag::Is(Sense::Size(_) | Sense::Color(_) | Sense::Attribute(_) | Sense::State(_, false)) => {}
                Tag::Is(Sense::Weather(_) | Sense::Time(_)) if is_color(&self.items[j].words) => {}
                _ => return false,
            }
        }
        false
    }

    fn noun_next(&self) -> bool {
        self.item(self.at + 1)
            .is_some_and(|n| n.words.is_ascii() && matches!(n.tag, Tag::Is(Sense::Noun(..))))
            && !self.edits
    }

    fn history_last(&self) -> Option<&usize> {
        self.last.last()
    }

    // --- numbers and distances ---

    fn count(&mut self, count: Count, span: Span) {
        if let Some(Sense::Place(Anchor::Lane(role), _)) = self.sense(self.at + 1)
            && matches!(role, LaneRole::Ego | LaneRole::Road)
            && self.items[self.at + 1].words.starts_with("lane")
            && self.pending.is_none()
        {
            // "two lanes", "four lane road"
            self.at += 1;
            let mut whole = span.to(self.items[self.at].span);
            if let Some(next) = self.item(self.at + 1)
                && matches!(
                    next.tag,
                    Tag::Is(Sense::Place(Anchor::Lane(LaneRole::Road), _) | Sense::RoadKind(..))
                )
            {
                if let Tag::Is(Sense::RoadKind(road, environment)) = next.tag {
                    self.road_kind(road, environment, next.span);
                }
                self.at += 1;
                whole = whole.to(next.span);
            }
            self.d().road.lanes = Some(count.n.clamp(1, 8));
            self.phrase(whole, Became::Road, &format!("{} lanes", count.n));
            self.pre = Pre::default();
            return;
        }
        let next_is_part = !self.noun_ahead(self.at + 1);
        if next_is_part && !self.edits && self.bare_number(self.at) && !self.fronted.is_empty() {
            // "on the left are three cars, and on the right two."
            self.again(count, span);
            return;
        }
        if next_is_part && !self.edits && self.pending.is_none() && self.numbers_last(count, span) {
            return;
        }
        if next_is_part && self.group_behind().is_some() {
            self.part(false, count, span);
            return;
        }
        if next_is_part
            && self.edits
            && matches!(self.items[self.at].words.as_str(), "one")
            && self.pending.is_none()
        {
            // "the one behind me"
            if let Some(noun) = NOUNS.last() {
                self.noun(noun, "object", false, span);
            }
            return;
        }
        if next_is_part {
            // a number of nothing: "a lot of traffic" and the like come as one run
            if !matches!(
                self.sense(self.at + 1),
                Some(
                    Sense::Filler
                        | Sense::Environment(_)
                        | Sense::Place(..)
                        | Sense::Background
                        | Sense::Cannot(_)
                        | Sense::RoadKind(..)
                        | Sense::Pick(_)
                        | Sense::Density(_)
                        | Sense::Size(_)
                        | Sense::Part(_)
                )
            ) && !self.edits
            {
                self.unread(span, Some("a number of what?".into()));
            }
        }
        self.pre.count = Some(count);
        self.pre.cover(span);
    }

    fn try_distance(&mut self, value: f64, span: Span) -> bool {
        let Some(Sense::Unit(m)) = self.sense(self.at + 1) else {
            return false;
        };
        self.at += 1;
        let span = span.to(self.items[self.at].span);
        self.distance_said(value * m, span);
        true
    }

    fn distance_said(&mut self, metres: f64, span: Span) {
        let back = (1..=2)
            .filter_map(|k| self.sense(self.at.wrapping_sub(1 + k)))
            .collect::<Vec<_>>();
        let metres = match back
            .iter()
            .find_map(|s| if let Sense::Bound(b) = s { Some(*b) } else { None })
        {
            Some(true) => metres * 0.6,
            Some(false) => metres * 1.3,
            None => metres,
        };
        let metres = if metres.is_finite() { metres } else { 1e6 };
        let next = self.item(self.at + 1);
        if next.is_some_and(|n| matches!(n.words.as_str(), "long" | "wide" | "tall" | "high" | "deep")) {
            self.at += 1;
            let to = self.items[self.at].span;
            self.unread(span.to(to), Some("sizes in metres are set in the window".into()));
            return;
        }
        if matches!(next.map(|n| n.tag), Some(Tag::Is(Sense::Away))) {
            self.at += 1;
            if self.anchor_ahead(self.at + 1) && next.is_some_and(|n| n.words.ends_with("from")) {
                self.begin(Prep::Rels(vec![RelationKind::Near]), span);
                if let Some(p) = &mut self.pending {
                    p.distance_m = Some(metres);
                }
                return;
            }
        }
        // "15 m away on the right": how far, and on which side; "15 m to the right" is the offset itself.
        let side_next = matches!(
            self.sense(self.at + 1),
            Some(Sense::EgoRel([RelationKind::LeftOf] | [RelationKind::RightOf]))
        );
        let away = matches!(self.sense(self.at), Some(Sense::Away));
        let targets = self.targets();
        if side_next && away && self.pending.is_none() && !targets.is_empty() {
            for t in targets {
                self.mentions[t].spec.relations.push(Stated {
                    relation: RelationKind::Near,
                    anchor: Anchor::Ego,
                    and: None,
                    distance_m: Some(metres),
                    span,
                });
            }
            return;
        }
        let relation_next = matches!(self.sense(self.at + 1), Some(Sense::Rel(_) | Sense::EgoRel(_)))
            || self.item(self.at + 1).is_some_and(|i| i.words == "to");
        if relation_next {
            self.distance = Some((metres, span));
            return;
        }
        if let Some(p) = &mut self.pending
            && !matches!(p.prep, Prep::In | Prep::At)
        {
            p.distance_m = Some(metres);
            return;
        }
        // "at 20 m", "at a distance of 20 m": of the relation before
        self.pending = None;
        let targets = self.targets();
        let mut used = false;
        for t in targets.iter().copied() {
            let list = &mut self.mentions[t].spec.relations;
            if let Some(r) = list
                .iter_mut()
                .rev()
                .find(|r| r.distance_m.is_none() && is_directed(r.relation))
            {
                r.distance_m = Some(metres);
                used = true;
            } else if list.is_empty() {
                list.push(Stated {
                    relation: RelationKind::Near,
                    anchor: Anchor::Ego,
                    and: None,
                    distance_m: Some(metres),
                    span,
                });
                used = true;
            }
        }
        self.chain &= !used; // what comes next is no longer of one list with these
        if !used && targets.is_empty() {
            if let Some(f) = self.fronted.iter_mut().rev().find(|f| f.distance_m.is_none()) {
                f.distance_m = Some(metres);
            } else {
                self.distance = Some((metres, span));
            }
        }
    }

    // --- relations ---

    fn begin(&mut self, prep: Prep, span: Span) {
        self.flush();
        let not = std::mem::take(&mut self.pre.not) || self.denied;
        if !self.noun_ahead(self.at + 1) || self.pre.says_something() {
            // What stood before the noun that never came belongs to what follows the place.
            if let Some(state) = self.pre.state.take() {
                self.fronted_state = Some(state);
            }
        }
        self.pre = Pre::default();
        let distance_m = self.distance.take().map(|d| d.0);
        self.pending = Some(Pending {
            prep,
            span,
            first: None,
            fresh: self.fresh,
            anded: self.anded || self.after_and(),
            not,
            distance_m,
        });
    }

    fn anchor(&mut self, anchor: Anchor, span: Span) {
        let Some(mut p) = self.pending.take() else {
            return;
        };
        let between = p.prep == Prep::Rels(vec![RelationKind::Between]);
        if between && p.first.is_none() {
            let plural = match anchor {
                Anchor::Object(i) => self.mentions.get(i).is_some_and(|m| m.plural),
                _ => false,
            };
            if !plural {
                p.first = Some(anchor);
                p.span = p.span.to(span);
                self.pending = Some(p);
                return;
            }
        }
        let (anchor, and) = match p.first {
            Some(first) => (first, Some(anchor)),
            None => (anchor, if between { Some(anchor) } else { None }),
        };
        let frag = Frag {
            prep: p.prep,
            anchor,
            and,
            distance_m: p.distance_m,
            span: p.span.to(span),
        };
        if p.not {
            self.unread(frag.span, Some("where something is not, is not read".into()));
            return;
        }
        // "a motorbike and, behind it, a truck"
        let set_off = p.fresh
            && p.anded
            && self.item(self.at + 1).is_some_and(|n| n.tag == Tag::Comma)
            && matches!(
                self.item(self.at + 2).map(|n| n.tag),
                Some(Tag::Is(Sense::Article(false) | Sense::Count(_)) | Tag::Number(_))
            )
            && self.noun_ahead(self.at + 2);
        let new_noun = set_off || self.noun_ahead(self.at + 1) || self.bare_number(self.at + 1);
        if self.head.is_empty() || (p.fresh && new_noun) {
            if !self.head.is_empty() || !self.chain {
                self.new_clause();
            }
            self.fronted.push(frag);
            self.chain = true;
            return;
        }
        let targets = if p.fresh {
            self.head.clone()
        } else {
            self.targets()
        };
        let own = |t: &usize| {
            let me = Anchor::Object(*t);
            frag.anchor == me && frag.and.is_none()
        };
        for t in targets.iter().filter(|t| !own(t)) {
            apply(&mut self.mentions[*t].spec, &frag);
        }
        self.chain = false;
    }

    /// Ends a relation that nothing followed.
    pub(super) fn flush(&mut self) {
        let Some(p) = self.pending.take() else {
            return;
        };
        let span = p.span;
        let default = match (&p.prep, p.first) {
            (_, Some(first)) => Some(first),
            (Prep::Rels(kinds), None) => match kinds.first() {
                Some(RelationKind::Crossing) => Some(Anchor::Lane(LaneRole::Road)),
                Some(RelationKind::Blocking) => Some(Anchor::Lane(LaneRole::Ego)),
                Some(
                    RelationKind::InFrontOf
                    | RelationKind::Behind
                    | RelationKind::LeftOf
                    | RelationKind::RightOf
                    | RelationKind::Near
                    | RelationKind::NextTo
                    | RelationKind::Across
                    | RelationKind::Following
                    | RelationKind::Facing
                    | RelationKind::OppositeDirection
                    | RelationKind::SameDirection
                    | RelationKind::FarFrom,
                ) => Some(Anchor::Ego),
                _ => None,
            },
            _ => None,
        };
        let words = span.of(self.prompt).to_string();
        match default {
            Some(anchor) => {
                self.pending = Some(Pending { first: None, ..p });
                if self
                    .pending
                    .as_ref()
                    .is_some_and(|p| p.prep == Prep::Rels(vec![RelationKind::Between]))
                {
                    self.pending = None;
                    self.unread(span, Some("between what?".into()));
                } else {
                    self.anchor(anchor, span);
                }
            }
            None if matches!(p.prep, Prep::In | Prep::At | Prep::Across) => {}
            None => self.unread(span, Some(format!("{words} what?"))),
        }
    }

    fn drop_pending(&mut self) {
        if self
            .pending
            .as_ref()
            .is_some_and(|p| matches!(p.prep, Prep::In | Prep::At))
        {
            self.pending = None;
        }
    }

    /// An adjective that says where: "an oncoming truck".
    fn fronted_once(&mut self, kinds: &[RelationKind], span: Span) {
        let attributes = std::mem::take(&mut self.pre);
        self.pre = attributes;
        self.pre.cover(span);
        self.pre.attributes.push(format!(
            "\u{1}{}",
            kinds.iter().map(|k| k.name()).collect::<Vec<_>>().join(",")
        ));
    }

    /// Who a relation or a participle right here speaks of.
    fn targets(&self) -> Vec<usize> {
        if self.fresh && !self.relative {
            return self.head.clone();
        }
        // What is said of a trailer holds for what draws it.
        match self.last.as_slice() {
            [i] if self.mentions[*i].spec.class == Class::Trailer => match self.mentions[*i].host {
                Some(host) => vec![*i, host],
                None => vec![*i],
            },
            last => last.to_vec(),
        }
    }

    /// Who a verb speaks of: finite ones the subject, unless after "which".
    fn subjects(&self, finite: bool) -> Vec<usize> {
        if self.relative || !finite {
            self.last.clone()
        } else {
            self.head.clone()
        }
    }

    fn state(&mut self, state: ObjectState, finite: bool, prenominal: bool, item: &Item) {
        let span = item.span;
        if (item.words.starts_with("overtak") || item.words == "passing" || item.words == "passes")
            && !self.head.is_empty()
            && self.pending.is_none()
            && self.anchor_ahead(self.at + 1)
        {
            // Past another, on its left.
            let targets = if finite {
                self.subjects(true)
            } else {
                self.targets()
            };
            for t in targets.iter().copied() {
                self.mentions[t].spec.state = Some(state);
            }
            self.last = targets;
            self.begin(Prep::Rels(vec![RelationKind::LeftOf]), span);
            return;
        }
        let state = if std::mem::take(&mut self.pre.not) {
            if state == ObjectState::Moving {
                ObjectState::Waiting
            } else {
                ObjectState::Moving
            }
        } else {
            state
        };
        if prenominal
            && !finite
            && self.pending.is_none()
            && !(self.head_waits_for_verb() && self.pre.span.is_none())
        {
            self.pre.state = Some(state);
            self.pre.cover(span);
            return;
        }
        if prenominal && !finite {
            self.pre.state = Some(state);
            self.pre.cover(span);
            return;
        }
        self.flush();
        let targets = if finite || self.after_is() {
            self.subjects(true)
        } else {
            self.targets()
        };
        if targets.is_empty() {
            self.fronted_state = Some(state);
            return;
        }
        for t in targets.iter().copied() {
            let m = &mut self.mentions[t];
            m.spec.state = Some(state);
            if !m.spec.attributes.contains(&item.words) && item.words.len() > 3 {
                m.spec.attributes.push(item.words.clone());
            }
        }
        if finite && !self.relative {
            self.last = targets;
        }
        self.chain = false;
    }

    fn head_waits_for_verb(&self) -> bool {
        false
    }

    fn color(&mut self, color: &str, prenominal: bool, span: Span) {
        if prenominal {
            self.pre.color = Some(color.to_string());
            self.pre.cover(span);
            return;
        }
        let targets = if self.after_is() {
            self.subjects(true)
        } else {
            self.targets()
        };
        if targets.is_empty() {
            self.pre.color = Some(color.to_string());
            self.pre.cover(span);
        }
        for t in targets {
            self.mentions[t].spec.color = Some(color.to_string());
        }
    }

    // --- nouns ---

    fn mention_by_id(&mut self, span: Span) {
        if let Some(noun) = NOUNS.last() {
            self.noun(noun, "box", false, span);
        }
    }

    fn absent(&mut self, classes: Vec<Class>, state: Option<ObjectState>, span: Span) {
        let index = self.reading.description.absent.len();
        let names: Vec<String> = classes.iter().take(3).map(|c| c.label()).collect();
        self.phrase(
            span,
            Became::Absent(index),
            &format!("none: {}", names.join(", ")),
        );
        self.d().absent.push(Absent { classes, state, span });
        self.pre = Pre::default();
        self.denied = true;
    }

    fn noun(&mut self, noun: &'static super::words::objects::Noun, word: &str, plural: bool, span: Span) {
        let mut pre = std::mem::take(&mut self.pre);
        let whole = pre.span.map_or(span, |s| s.to(span));
        let zero = pre.count.is_some_and(|c| c.n == 0);
        if pre.not || zero || (self.not_goes_on && pre.count.is_none() && pre.article.is_none()) {
            // "one lane is not a car" has no meaning here; a denied anchor is not read.
            if self.pending.take().is_some() {
                self.unread(whole, Some("where something is not, is not read".into()));
                return;
            }
            self.absent(noun.classes.to_vec(), pre.state, whole);
            self.not_goes_on = true;
            return;
        }
        self.not_goes_on = false;
        self.denied = false;
        if self.holds_others(noun, &pre)
            || self.rides(noun, word, &pre)
            || self.says_which(noun, word, plural, &pre)
        {
            return;
        }
        if self.mentions.len() >= MOST_MENTIONS {
            self.unread(whole, Some(format!("more than {MOST_MENTIONS} things are named")));
            return;
        }
        // Adjectives that say where.
        let wheres: Vec<String> = pre
            .attributes
            .iter()
            .filter_map(|a| a.strip_prefix('\u{1}').map(str::to_string))
            .collect();
        pre.attributes.retain(|a| !a.starts_with('\u{1}'));
        if word == "traffic"
            && matches!(self.item(self.at + 1).map(|i| i.tag), Some(Tag::Mark))
            && self.noun_ahead(self.at + 2)
        {
            // "oncoming traffic: two coaches" names them itself.
            for kinds in &wheres {
                let kinds = RelationKind::ALL
                    .into_iter()
                    .filter(|k| kinds.split(',').any(|n| n == k.name()))
                    .collect();
                self.fronted.push(Frag {
                    prep: Prep::Rels(kinds),
                    anchor: Anchor::Ego,
                    and: None,
                    distance_m: None,
                    span: whole,
                });
            }
            return;
        }
        let some_one = !plural
            && noun.several == 1
            && self
                .item(self.at.wrapping_sub(1))
                .is_some_and(|i| i.words == "some");
        if some_one {
            pre.count = None; // "some guy"
        }
        let each = pre.each;
        let mut mention = Mention::new(noun, word, plural, pre, span);
        if each {
            mention.both = None;
        }
        for kinds in wheres {
            let kinds: Vec<RelationKind> = kinds
                .split(',')
                .filter_map(|n| RelationKind::ALL.into_iter().find(|k| k.name() == n))
                .collect();
            let frag = Frag {
                prep: Prep::Rels(kinds),
                anchor: Anchor::Ego,
                and: None,
                distance_m: None,
                span: whole,
            };
            apply(&mut mention.spec, &frag);
        }
        if matches!(word, "everything" | "anything") {
            mention.pick = mention.pick.or(Some(Pick::All));
        }
        let index = self.coreferent(&mention).unwrap_or_else(|| {
            self.mentions.push(mention.clone());
            self.mentions.len() - 1
        });
        let old = index + 1 != self.mentions.len()
            || !std::ptr::eq(self.mentions[index].classes, mention.classes)
            || self.mentions[index].spec.span != mention.spec.span;
        if old && mention.spec.color.is_some() {
            self.mentions[index].spec.color = mention.spec.color.clone();
        }
        if self.pending.is_some() && !old && self.is_ego_car(index) {
            self.mentions.truncate(index);
            self.anchor(Anchor::Ego, span);
            return;
        }
        if self.pending.is_some() {
            if !old {
                self.mentions[index].is_anchor = true;
            }
            let before = self.head.clone();
            let between = self
                .pending
                .as_ref()
                .is_some_and(|p| p.first.is_none() && p.prep == Prep::Rels(vec![RelationKind::Between]));
            self.anchor(Anchor::Object(index), span);
            if !between && !before.is_empty() && !self.head.is_empty() {
                self.last = vec![index];
            }
            self.with = false;
            return;
        }
        if let Some((kind, rspan, subjects, topic)) = self.reversed.take() {
            let anchor = topic.or(subjects.first().map(|s| Anchor::Object(*s)));
            match anchor {
                Some(anchor) => {
                    let frag = Frag {
                        prep: Prep::Rels(vec![kind]),
                        anchor,
                        and: None,
                        distance_m: None,
                        span: rspan.to(span),
                    };
                    apply(&mut self.mentions[index].spec, &frag);
                    self.reversed = Some((kind, rspan, subjects, topic)); // "by cones and barriers"
                }
                None => self.unread(rspan, Some("of what?".into())),
            }
            if self.head.is_empty() {
                self.head = vec![index];
            }
            self.last = vec![index];
            return;
        }
        // A new subject, or one more of a list.
        let host = self.head.first().copied().filter(|_| self.with);
        self.with = false;
        if !old {
            self.mentions[index].host = host;
        }
        if self.linked && self.chain && !self.list.is_empty() {
            // "a car, a bus and a truck ahead" speaks of three, "three cars, a bus ahead" of the bus.
            self.list.push(index);
            self.head = if self.anded {
                self.list.clone()
            } else {
                vec![index]
            };
        } else {
            if !self.head.is_empty() {
                self.fronted_if_done();
            }
            self.list = vec![index];
            self.head = vec![index];
        }
        self.last = self.head.clone();
        if let Some(state) = self.fronted_state
            && self.mentions[index].spec.state.is_none()
        {
            self.mentions[index].spec.state = Some(state);
        }
        for frag in self.fronted.clone() {
            if frag.anchor != Anchor::Object(index) {
                apply(&mut self.mentions[index].spec, &frag);
            }
        }
        if !old && self.mentions[index].spec.relations.is_empty() {
            self.mentions[index].spec.relations = self.listed.clone();
        }
        if let Some((metres, dspan)) = self.distance.take() {
            self.mentions[index].spec.relations.push(Stated {
                relation: RelationKind::Near,
                anchor: Anchor::Ego,
                and: None,
                distance_m: Some(metres),
                span: dspan,
            });
        }
        self.topic = None;
    }

    /// A noun after the list that a fronted place was said of: the place is used up.
    fn fronted_if_done(&mut self) {
        if !self.chain {
            self.fronted.clear();
            self.fronted_state = None;
        }
        self.chain = true;
    }

    /// An object named before that "the ..." points to.
    fn coreferent(&self, new: &Mention) -> Option<usize> {
        if !new.definite || new.pick.is_some() || self.edits {
            return None;
        }
        let fits = |m: &Mention| {
            let nouns = m.classes[0] == new.classes[0]
                || (new.classes.len() > 1 && new.classes.contains(&m.spec.class));
            let colors = match (&m.spec.color, &new.spec.color) {
                (Some(a), Some(b)) => a == b,
                (None, Some(_)) => self.after_is(),
                _ => true,
            };
            let states = new.spec.state.is_none() || m.spec.state == new.spec.state;
            let counts = new.uncounted || m.spec.count.n == new.spec.count.n;
            !m.gone && nouns && colors && states && counts
        };
        (0..self.mentions.len()).rev().find(|&i| fits(&self.mentions[i]))
    }

    /// A group that a number without a noun can be a part of.
    fn group_behind(&self) -> Option<usize> {
        let next = self.item(self.at + 1)?;
        let told = matches!(
            next.tag,
            Tag::Is(
                Sense::Rel(_)
                    | Sense::EgoRel(_)
                    | Sense::In
                    | Sense::At
                    | Sense::State(..)
                    | Sense::Color(_)
                    | Sense::FarSide
                    | Sense::Fixed(..)
                    | Sense::Pronoun
                    | Sense::Not
            )
        ) || (matches!(next.tag, Tag::Number(_) | Tag::Is(Sense::Count(_)))
            && matches!(self.sense(self.at + 2), Some(Sense::Unit(_))))
            || matches!(next.words.as_str(), "of them" | "of" | "is" | "are" | "to")
            || matches!(
                (next.tag, is_color(&next.words)),
                (Tag::Is(Sense::Weather(_)), true)
            );
        if !told {
            return None;
        }
        (0..self.mentions.len())
            .rev()
            .find(|&i| !self.mentions[i].gone && self.mentions[i].plural && !self.mentions[i].is_anchor)
    }

    /// "one on the left and the other on the right"
    fn part(&mut self, all: bool, count: Count, span: Span) {
        if self.noun_ahead(self.at + 1) && !all {
            return; // "the other car", "another bus"
        }
        let parent = (0..self.mentions.len()).rev().find(|&i| {
            !self.mentions[i].gone
                && !self.mentions[i].is_anchor
                && (self.mentions[i].plural || self.mentions[i].spec.count.n > 1)
        });
        if matches!(
            self.item(self.at + 1).map(|i| i.words.as_str()),
            Some("one" | "ones")
        ) {
            self.at += 1; // "the first one"
        }
        let Some(parent) = parent else {
            if self.pending.is_none()
                && !self.last.is_empty()
                && (span.of(self.prompt).to_lowercase().starts_with("another")
                    || span.of(self.prompt).to_lowercase().starts_with("a "))
            {
                // "a car on the left and another on the right"
                let mut twin = self.mentions[self.last[0]].clone();
                twin.spec.relations.clear();
                twin.spec.span = span;
                twin.spec.count = Count::exactly(1);
                self.mentions.push(twin);
                let index = self.mentions.len() - 1;
                self.flush();
                self.head = vec![index];
                self.last = vec![index];
                self.chain = false;
                return;
            }
            return;
        };
        self.flush();
        let left = self.mentions[parent].spec.count;
        let of_them = self.item(self.at + 1).is_some_and(|i| i.words.starts_with("of"));
        if of_them && self.mentions[parent].uncounted && self.ends(self.at + 2) {
            // "cones along the edge, six of them"
            self.mentions[parent].spec.count = count;
            self.mentions[parent].uncounted = false;
            return;
        }
        if !all
            && !of_them
            && !self.edits
            && count.n > 1
            && count.n >= left.n
            && !self.mentions[parent].spec.relations.is_empty()
        {
            // "two cars on the left and two on the right"
            self.again(count, span);
            return;
        }
        let n = if all { left.n } else { count.n.min(left.n) };
        let mut part = self.mentions[parent].clone();
        part.spec.count = if left.is_exact() || !all {
            Count::exactly(n)
        } else {
            left
        };
        part.plural = n > 1;
        part.spec.span = span;
        self.mentions.push(part);
        let index = self.mentions.len() - 1;
        let rest = left.n - n;
        let parent_spec = &mut self.mentions[parent].spec;
        parent_spec.count = Count {
            min: left.min.saturating_sub(n),
            n: rest,
            max: left.max.saturating_sub(n),
        };
        self.mentions[parent].gone = rest == 0;
        self.head = vec![index];
        self.last = vec![index];
        self.chain = false;
        self.pre = Pre::default();
    }

    fn works(&mut self, span: Span) {
        if std::mem::take(&mut self.pre.not) {
            self.absent(
                vec![Class::TrafficCone, Class::Barrier, Class::ConstructionVehicle],
                None,
                span,
            );
            return;
        }
        self.pre = Pre::default();
        // Works are a place too: "a car in front of the roadworks" stands by their first part.
        let first = self.mentions.len();
        let led = self.pending.is_some();
        for (class, n) in WORKS {
            if let Some(noun) = NOUNS.iter().find(|x| x.classes == [*class]) {
                let mut m = Mention::new(noun, class.label().as_str(), *n > 1, Pre::default(), span);
                m.spec.count = if *n == 1 {
                    Count::about(1, 1, 2)
                } else {
                    Count::about(2, *n, 3 * n)
                };
                m.spec.state = Some(ObjectState::Parked);
                self.mentions.push(m);
            }
        }
        let all: Vec<usize> = (first..self.mentions.len()).collect();
        for &i in &all[1..] {
            self.mentions[i].spec.relations.push(Stated {
                relation: RelationKind::Near,
                anchor: Anchor::Object(first),
                and: None,
                distance_m: None,
                span,
            });
        }
        if led {
            let had = self.head.clone();
            self.anchor(Anchor::Object(first), span);
            if !had.is_empty() {
                self.last = vec![first];
            }
            return;
        }
        for frag in self.fronted.clone() {
            apply(&mut self.mentions[first].spec, &frag);
        }
        self.head = vec![first];
        self.last = vec![first];
    }

    fn pronoun(&mut self, item: &Item) -> bool {
        if matches!(item.words.as_str(), "that" | "this" | "those" | "these")
            && matches!(self.sense(self.at + 1), Some(Sense::Noun(..)))
        {
            self.pre.article = Some(true); // "that car"
            self.pre.cover(item.span);
            return true;
        }
        if matches!(item.words.as_str(), "that") {
            self.relative = true;
        }
        if self.pending.is_some() {
            let targets = self.targets();
            let skip = |i: &usize| targets.contains(i) || self.mentions[*i].gone;
            let antecedent = match item.words.as_str() {
                "that" | "this" => None,
                _ => {
                    let host = targets.first().and_then(|t| self.mentions[*t].host);
                    let subject = self.head.iter().chain(&self.before).copied().find(|i| !skip(i));
                    host.or(subject)
                        .or_else(|| (0..self.mentions.len()).rev().find(|i| !skip(i)))
                }
            };
            let fresh = self.pending.as_ref().is_some_and(|p| p.fresh);
            let antecedent = if fresh && self.noun_ahead(self.at + 1) {
                self.head.first().or(self.before.first()).copied().or(antecedent)
            } else {
                antecedent
            };
            match antecedent {
                Some(i) => self.anchor(Anchor::Object(i), item.span),
                None if item.words == "that" => return true,
                None if self.fronted.iter().any(|f| f.anchor == Anchor::Ego) => {
                    self.anchor(Anchor::Ego, item.span)
                }
                None => {
                    let span = self.pending.take().map_or(item.span, |p| p.span.to(item.span));
                    self.unread(span, Some("what it points to was not named".into()));
                }
            }
            return false;
        }
        if self.head.is_empty()
            && matches!(
                item.words.as_str(),
                "it" | "they" | "he" | "she" | "these" | "those"
            )
        {
            self.head = self.before.clone();
            self.last = self.before.clone();
            self.chain = false;
        }
        true
    }

    // --- places, style ---

    fn place(&mut self, anchor: Anchor, road: Option<Road>, item: &Item) {
        let span = item.span;
        let not = std::mem::take(&mut self.pre.not);
        let definite = self.pre.article == Some(true);
        self.pre = Pre::default();
        if not && self.pending.is_none() {
            match anchor {
                Anchor::Crossing => self.d().road.no_crossing = true,
                Anchor::Lane(LaneRole::Sidewalk) => self.d().road.no_sidewalk = true,
                Anchor::Junction => self.d().road.kind = Some(Road::Straight),
                _ => {
                    self.unread(span, Some("a road without it cannot be made".into()));
                    return;
                }
            }
            self.phrase(span, Became::Road, &format!("none: {}", item.words));
            return;
        }
        // What must be there for the place to be.
        match anchor {
            Anchor::Crossing => self.d().road.crossing = true,
            Anchor::Lane(LaneRole::Sidewalk | LaneRole::LeftSidewalk | LaneRole::RightSidewalk) => {
                self.d().road.sidewalk = true
            }
            _ => {}
        }
        if let Some(kind) = road {
            let lamp = item.words.contains("light")
                || item.words.contains("sign")
                || item.words.contains("line")
                || item.words.contains("signal");
            let wish = &mut self.reading.description.road.kind;
            // "traffic light" does not turn a t-junction into crossroads.
            if wish.is_none() || (!lamp && *wish != Some(Road::Roundabout) && *wish != Some(Road::TJunction))
            {
                *wish = Some(kind);
            }
        }
        if self.pending.is_some() {
            let fronts = self.head.is_empty();
            let next_noun = self.noun_ahead(self.at + 1)
                || matches!(
                    self.item(self.at + 1).map(|i| i.tag),
                    Some(Tag::Comma | Tag::Mark)
                );
            let vague = matches!(anchor, Anchor::Lane(LaneRole::Road))
                || (road.is_some() && !definite && !matches!(anchor, Anchor::Lane(LaneRole::Carpark)));
            let plain = self
                .pending
                .as_ref()
                .is_some_and(|p| matches!(p.prep, Prep::In | Prep::At));
            if fronts && plain && (vague || !next_noun) {
                // "On a busy street, ..." sets the stage and says nothing of one object.
                self.pending = None;
                self.phrase(span, Became::Road, &item.words);
            } else {
                if road.is_some() {
                    self.phrase(span, Became::Road, &item.words);
                }
                self.anchor(anchor, span);
            }
            return;
        }
        if road.is_some() || matches!(anchor, Anchor::Crossing | Anchor::Lane(LaneRole::Sidewalk)) {
            self.phrase(span, Became::Road, &item.words);
        }
        self.topic = Some((anchor, span));
    }

    fn road_kind(&mut self, road: Road, environment: Option<super::description::Environment>, span: Span) {
        let not = std::mem::take(&mut self.pre.not);
        self.pre = Pre::default();
        self.drop_pending();
        if not {
            self.unread(span, Some("which road it is not, is not read".into()));
            return;
        }
        let wish = &mut self.reading.description.road.kind;
        // A junction on a highway is a junction.
        let keeps = matches!(
            wish,
            Some(Road::Intersection | Road::TJunction | Road::Roundabout | Road::Parking)
        ) && matches!(road, Road::Straight | Road::Suburb);
        if !keeps {
            *wish = Some(road);
        }
        if let Some(environment) = environment {
            self.d().environment.get_or_insert(environment);
        }
        self.phrase(span, Became::Road, &format!("road: {}", road.name()));
        if self.pending.is_some() {
            self.pending = None;
        }
        self.topic = Some((Anchor::Lane(LaneRole::Road), span));
    }

    fn time(&mut self, time: TimeOfDay, span: Span) {
        let not = std::mem::take(&mut self.pre.not);
        self.drop_pending();
        self.pre = Pre::default();
        if not {
            self.unread(span, Some("when it is not, is not read".into()));
            return;
        }
        let old = self.reading.description.time_of_day;
        match old {
            Some(old) if old != time => {
                // "late afternoon sun at night": the first one stays.
                let note = format!(
                    "{} and {} were said: it is {}",
                    old.name(),
                    time.name(),
                    old.name()
                );
                if !(old == TimeOfDay::Day || time == TimeOfDay::Day) {
                    self.reading.notes.push(note);
                } else if old == TimeOfDay::Day {
                    self.d().time_of_day = Some(time);
                }
            }
            _ => self.d().time_of_day = Some(time),
        }
        self.phrase(span, Became::Time, &format!("time: {}", time.name()));
    }

    fn weather(&mut self, weather: Weather, span: Span) {
        let not = std::mem::take(&mut self.pre.not) || self.not_goes_on;
        self.drop_pending();
        self.pre = Pre::default();
        if not {
            let dry = if weather == Weather::Clear {
                Weather::Overcast
            } else {
                Weather::Clear
            };
            if self.reading.description.weather.is_none() {
                self.d().weather = Some(dry);
            }
            self.phrase(span, Became::Weather, &format!("weather: not {}", weather.name()));
            return;
        }
        match self.reading.description.weather {
            Some(old) if old != weather => {
                let rank = |w: Weather| match w {
                    Weather::Sandstorm => 5,
                    Weather::Snow => 4,
                    Weather::Rain => 3,
                    Weather::Fog => 2,
                    Weather::Overcast => 1,
                    Weather::Clear => 0,
                };
                let kept = if rank(weather) > rank(old) { weather } else { old };
                if rank(old).min(rank(weather)) > 1 || kept == Weather::Clear {
                    self.reading.notes.push(format!(
                        "{} and {} were said: pictures show {}",
                        old.name(),
                        weather.name(),
                        kept.name()
                    ));
                }
                self.d().weather = Some(kept);
            }
            _ => self.d().weather = Some(weather),
        }
        self.phrase(span, Became::Weather, &format!("weather: {}", weather.name()));
    }

    // --- clauses ---

    fn new_clause(&mut self) {
        self.denied = false;
        if !self.head.is_empty() {
            self.before = std::mem::take(&mut self.head);
        }
        self.last.clear();
        self.list.clear();
        self.fronted.clear();
        self.fronted_state = None;
        self.reversed = None;
        self.relative = false;
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

fn is_prenominal(words: &str) -> bool {
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
