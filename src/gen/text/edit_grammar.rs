//! Commands to a scene: where each begins, what it is about, where to, how far, into what.

use std::f64::consts::{FRAC_PI_2, PI};

use glam::DVec2;

use super::description::{Anchor, Count, ObjectSpec, Reading};
use super::lexicon::{Sense, look_up};
use super::mention::Mention;
use super::parse::Parser;
use super::rephrase::{Change, rephrase};
use super::tag::{Item, Tag, tag};
use super::tokens::{Span, Token, TokenKind, tokens};
use super::words::edits::{VERBS, Verb};
use crate::scene::Class;
use crate::scene::graph::{LaneRole, ObjectState, RelationKind};

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
    /// What replaces the target.
    pub by: Option<Mention>,
    /// Where to.
    pub destination: Option<Destination>,
    /// Anchors of the destination.
    anchors: Vec<ObjectSpec>,
    /// How to turn.
    pub turn: Option<Turn>,
    /// What it should do.
    pub state: Option<ObjectState>,
    /// A colour was named.
    pub color: bool,
    /// A lane or strip that was named alone.
    pub place: Option<LaneRole>,
    /// By how much a number changes.
    pub change: Option<Change>,
    /// Which of several in order of distance, from 1; 0 is the last.
    pub nth: Option<usize>,
}

impl Command {
    /// The objects of a description that puts `spec`, as `class`, where the destination says.
    pub fn with_anchors(&self, spec: &ObjectSpec, class: Class) -> Vec<ObjectSpec> {
        let mut out = self.anchors.clone();
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

fn verb_at(tokens: &[Token], i: usize) -> Option<(Verb, usize)> {
    let run = |n: usize| -> Option<String> {
        let words: Option<Vec<&str>> = (i..i + n)
            .map(|k| {
                tokens
                    .get(k)
                    .filter(|t| t.kind == TokenKind::Word)
                    .map(|t| t.text.as_str())
            })
            .collect();
        words.map(|w| w.join(" "))
    };
    let found = (1..=4).rev().find_map(|n| {
        let words = run(n)?;
        let verb = VERBS
            .iter()
            .find(|(_, list)| list.split('|').any(|w| w == words))?;
        Some((verb.0, n))
    })?;
    let next = tokens.get(i + found.1).map(|t| t.text.as_str());
    let word = tokens[i].text.as_str();
    let sure = match word {
        // "clear night", "light rain", "set of cones" are no commands
        "clear" | "leave" | "face" | "lose" => matches!(
            next,
            Some(
                "the"
                    | "my"
                    | "all"
                    | "out"
                    | "every"
                    | "everything"
                    | "our"
                    | "only"
                    | "just"
                    | "two"
                    | "one"
            )
        ),
        "set" => !matches!(next, Some("of")),
        "color" | "colour" | "drop" | "pull" | "park" => next.is_some(),
        _ => true,
    };
    sure.then_some(found)
}

fn begins(tokens: &[Token], i: usize) -> bool {
    let polite = [
        "and",
        "then",
        "please",
        "also",
        "now",
        "lets",
        "you",
        "just",
        "to",
        "finally",
        "next",
        "afterwards",
        "but",
    ];
    match i.checked_sub(1).map(|k| &tokens[k]) {
        None => true,
        Some(t) => match t.kind {
            TokenKind::Stop | TokenKind::Comma | TokenKind::Mark => true,
            TokenKind::Word => polite.contains(&t.text.as_str()),
            _ => false,
        },
    }
}

/// The commands of a text; a text without a verb adds, keeps so many ("only two cars") or sets the style.
pub fn commands(text: &str) -> Vec<Command> {
    let rephrased = rephrase(&tokens(text));
    let all = &rephrased.tokens;
    let mut starts: Vec<(usize, usize, Option<Verb>)> = Vec::new(); // first token, words of the verb, verb
    let mut i = 0;
    let mut open = false;
    while i < all.len() {
        if all[i].kind == TokenKind::Stop {
            open = false;
            i += 1;
            continue;
        }
        // "stop the bus", "park the van"
        let stop = begins(all, i)
            && matches!(all[i].text.as_str(), "stop" | "halt" | "park" | "start")
            && matches!(
                all.get(i + 1).map(|t| t.text.as_str()),
                Some("the" | "all" | "every" | "raining" | "snowing")
            );
        if stop {
            starts.push((i, 1, Some(Verb::Make)));
            open = true;
            i += 2;
            continue;
        }
        match verb_at(all, i).filter(|_| begins(all, i)) {
            Some((verb, n)) => {
                starts.push((i, n, Some(verb)));
                open = true;
                i += n;
            }
            None => {
                if !open && all[i].kind != TokenKind::Comma {
                    let polite = [
                        "please", "now", "then", "also", "and", "could", "can", "you", "lets", "i", "want",
                        "to",
                    ];
                    if !polite.contains(&all[i].text.as_str()) {
                        starts.push((i, 0, None));
                        open = true;
                    }
                }
                i += 1;
            }
        }
    }
    let mut out = Vec::new();
    let mut last_noun: Option<Vec<Token>> = None;
    for (k, (from, n, verb)) in starts.iter().enumerate() {
        let end = starts.get(k + 1).map_or(all.len(), |s| s.0);
        let stop = (*from..end)
            .find(|j| all[*j].kind == TokenKind::Stop)
            .unwrap_or(end);
        let mut to = stop.max(*from + 1);
        while to > from + 1
            && (all[to - 1].kind == TokenKind::Comma || matches!(all[to - 1].text.as_str(), "and" | "then"))
        {
            to -= 1;
        }
        let slice = super::back::resolved(&all[*from..to], *n, last_noun.as_ref());
        if let Some(noun) = super::back::named(&slice[*n..], *verb) {
            last_noun = Some(noun);
        }
        let mut c = command(text, &slice, *n, *verb);
        let start = all[*from].span.start;
        c.change = rephrased.changes.iter().find(|(at, _)| *at == start).map(|x| x.1);
        c.nth = rephrased
            .ordinals
            .iter()
            .find(|(at, _)| (c.span.start..=c.span.end).contains(at))
            .map(|x| x.1);
        out.push(c);
    }
    out
}

fn words(items: &[Item]) -> Vec<&str> {
    items.iter().map(|i| i.words.as_str()).collect()
}

fn parse(text: &str, items: &[Item]) -> (Reading, Vec<Mention>) {
    let mut parser = Parser::new(text, items, true);
    parser.run();
    let mentions = parser.mentions.clone();
    (parser.finish(), mentions)
}

fn command(text: &str, tokens: &[Token], verb_words: usize, verb: Option<Verb>) -> Command {
    // A verb that was put in bears the span of the first word.
    let span = tokens.iter().fold(tokens[0].span, |s, t| s.to(t.span));
    let first = tokens[0].text.as_str();
    let items = tag(&tokens[verb_words.min(tokens.len())..]);
    let list = words(&items);
    let has = |w: &str| list.contains(&w);
    let definite_next = matches!(list.first(), Some(&"the" | &"my" | &"that" | &"this"));
    let only = list.iter().take(3).any(|w| {
        matches!(
            *w,
            "only" | "just" | "exactly" | "just one" | "only one" | "exactly one"
        )
    }) || tokens
        .windows(2)
        .any(|w| w[0].text == "should" && w[1].text == "be");
    // "the bus further ahead": what is there already is not added.
    let there_already = verb.is_none()
        && matches!(list.first(), Some(&"the" | &"my" | &"that" | &"this" | &"both"))
        && matches!(
            items
                .iter()
                .skip(1)
                .take(3)
                .find(|i| !is_adjective(i))
                .map(|i| i.tag),
            Some(Tag::Is(Sense::Noun(..)))
        );
    let placed = items.iter().any(|i| {
        matches!(
            i.tag,
            Tag::Is(Sense::Rel(_) | Sense::EgoRel(_) | Sense::In | Sense::At | Sense::FarSide)
        )
    });
    let mut verb = match verb {
        None if only => Verb::Keep,
        None if there_already && placed => Verb::Move,
        None if there_already => Verb::Make,
        None => Verb::Add,
        Some(Verb::Add) if only => Verb::Keep,
        // "put the bus behind the truck" moves it
        Some(Verb::Add)
            if definite_next
                && !matches!(
                    first,
                    "add"
                        | "insert"
                        | "include"
                        | "create"
                        | "generate"
                        | "show"
                        | "bring"
                        | "introduce"
                        | "spawn"
                        | "append"
                        | "give"
                        | "duplicate"
                        | "drop"
                ) =>
        {
            Verb::Move
        }
        // "drop the barrier" takes it away, "drop a barrier" puts one in
        Some(Verb::Add) if definite_next && matches!(first, "drop") => Verb::Remove,
        Some(v) => v,
    };
    let mut c = Command {
        verb,
        text: span.of(text).to_string(),
        span,
        reading: Reading::default(),
        targets: Vec::new(),
        mentions: Vec::new(),
        definite: Vec::new(),
        by: None,
        destination: None,
        anchors: Vec::new(),
        turn: None,
        state: match first {
            "stop" | "halt" => Some(ObjectState::Waiting),
            "park" => Some(ObjectState::Parked),
            "start" => Some(ObjectState::Moving),
            _ => None,
        },
        color: items.iter().any(|i| matches!(i.tag, Tag::Is(Sense::Color(_)))) || has("grey") || has("gray"),
        place: items.iter().find_map(|i| match i.tag {
            Tag::Is(Sense::Place(Anchor::Lane(role), _)) if super::edit::clears(role) => Some(role),
            _ => None,
        }),
        change: None,
        nth: None,
    };
    let noun_at = items
        .iter()
        .position(|i| matches!(i.tag, Tag::Is(Sense::Noun(..) | Sense::Works)))
        .or_else(|| items.iter().position(|i| i.words == "#").map(|k| k + 1));
    let after_noun = noun_at.map_or(0, |n| n + 1);
    // What the target is turned into.
    if matches!(verb, Verb::Replace | Verb::Turn | Verb::Make) {
        let cut = items.iter().enumerate().skip(after_noun).find_map(|(k, i)| {
            let word = matches!(
                i.words.as_str(),
                "with" | "by" | "for" | "into" | "to" | "against"
            ) || (verb == Verb::Make && matches!(i.tag, Tag::Is(Sense::Article(false))));
            let noun_follows = items[k + 1..]
                .iter()
                .take(5)
                .any(|x| matches!(x.tag, Tag::Is(Sense::Noun(..))));
            let turning = verb == Verb::Turn && i.words != "into";
            (word && noun_follows && !turning).then_some(k)
        });
        if let Some(k) = cut {
            verb = if verb == Verb::Make {
                Verb::Make
            } else {
                Verb::Replace
            };
            let (r, m) = parse(text, &items[k + 1..]);
            c.by = m.first().cloned();
            c.reading.not_understood.extend(r.not_understood);
            target_part(text, &items[..k], &mut c);
            c.verb = verb;
            return c;
        }
    }
    match verb {
        Verb::Move => moving(text, &items, after_noun, &mut c),
        Verb::Turn => turning(text, &items, after_noun, &mut c),
        Verb::Make if after_noun > 0 && items[after_noun..].iter().any(|i| is_turn_word(&i.words)) => {
            turning(text, &items, after_noun, &mut c);
        }
        _ => {
            target_part(text, &items, &mut c);
            // "reduce the cars to two"
            if let [.., to, number] = items.as_slice()
                && (matches!(verb, Verb::Keep | Verb::Make)
                    && matches!(to.words.as_str(), "to" | "up to" | "down to" | "back to")
                    || verb == Verb::Make && matches!(to.tag, Tag::Is(Sense::Noun(..))))
            {
                let n = match number.tag {
                    Tag::Number(v) if v.is_finite() && v >= 0.0 => Some(v as u32),
                    Tag::Is(Sense::Count(count)) => Some(count.n),
                    _ => None,
                };
                if let (Some(n), Some(m)) = (n, c.targets.first_mut()) {
                    m.spec.count = Count::exactly(n);
                    m.uncounted = false;
                }
            }
        }
    }
    // "turn the rain off", "switch to night": about the style alone.
    let style = c.reading.description.time_of_day.is_some() || c.reading.description.weather.is_some();
    if c.targets.is_empty() && style && matches!(verb, Verb::Turn | Verb::Move | Verb::Replace | Verb::Keep) {
        c.verb = if has("off") || list.last() == Some(&"off") {
            Verb::Remove
        } else {
            Verb::Make
        };
    }
    if c.targets.is_empty() && style && first == "stop" {
        c.verb = Verb::Remove;
    }
    if verb == Verb::Make && c.state.is_none() {
        c.state = items
            .iter()
            .skip(after_noun)
            .find_map(|i| match (i.words.as_str(), i.tag) {
                ("stop" | "wait" | "stand still" | "halt", _) => Some(ObjectState::Waiting),
                ("move" | "drive" | "walk" | "go" | "start", _) => Some(ObjectState::Moving),
                (_, Tag::Is(Sense::State(s, _))) => Some(s),
                _ => None,
            });
        if let (Some(_), Some(m)) = (c.state, c.targets.first_mut()) {
            m.spec.state = None; // what it shall do is not what it does
        }
    }
    c
}

fn is_adjective(item: &Item) -> bool {
    matches!(
        item.tag,
        Tag::Is(
            Sense::Article(_)
                | Sense::State(_, false)
                | Sense::Size(_)
                | Sense::Color(_)
                | Sense::Attribute(_)
                | Sense::Count(_)
        ) | Tag::Number(_)
    )
}

fn note_definite(c: &mut Command, mentions: &[Mention]) {
    c.definite
        .extend(mentions.iter().filter(|m| m.definite).map(|m| m.spec.span));
}

fn target_part(text: &str, items: &[Item], c: &mut Command) {
    let (reading, mentions) = parse(text, items);
    note_definite(c, &mentions);
    c.targets = mentions
        .iter()
        .filter(|m| !m.is_anchor && !m.gone && m.host.is_none())
        .cloned()
        .collect();
    c.mentions = mentions;
    let unread = std::mem::take(&mut c.reading.not_understood);
    c.reading = reading;
    c.reading.not_understood.extend(unread);
}

fn direction(words: &str) -> Option<DVec2> {
    Some(match words {
        "left"
        | "to the left"
        | "to my left"
        | "leftwards"
        | "leftward"
        | "to our left"
        | "to the left side"
        | "to the left hand side" => DVec2::Y,
        "right"
        | "to the right"
        | "to my right"
        | "rightwards"
        | "rightward"
        | "to our right"
        | "to the right side"
        | "to the right hand side" => DVec2::NEG_Y,
        "forward" | "forwards" | "ahead" | "further ahead" | "farther ahead" | "up" | "to the front"
        | "further forward" | "up ahead" | "further on" | "further along" => DVec2::X,
        "back" | "backwards" | "backward" | "down" | "to the rear" | "further back" | "to the back"
        | "rearwards" | "further behind" => DVec2::NEG_X,
        _ => return None,
    })
}

fn metres_at(items: &[Item], i: usize) -> Option<(f64, usize)> {
    let unit = |k: usize| match items.get(k).map(|x| x.tag) {
        Some(Tag::Is(Sense::Unit(m))) => Some(m),
        _ => None,
    };
    match items.get(i)?.tag {
        Tag::Number(v) => unit(i + 1).map(|m| (v * m, 2)),
        Tag::Is(Sense::Count(count)) => unit(i + 1).map(|m| (f64::from(count.n) * m, 2)),
        Tag::Is(Sense::Fraction(share)) => unit(i + 1).map(|m| (share * m, 2)),
        Tag::Is(Sense::Article(false)) => unit(i + 1).map(|m| (m, 2)),
        _ => None,
    }
}

fn moving(text: &str, items: &[Item], after_noun: usize, c: &mut Command) {
    let mut metres = None;
    let mut dir: Option<DVec2> = None;
    let mut toward: Option<bool> = None;
    let mut cut = items.len();
    let mut place_from = None;
    let mut i = after_noun;
    while i < items.len() {
        let w = items[i].words.as_str();
        if let Some((m, n)) = metres_at(items, i) {
            // "20 m ahead of the bus" is a place, "3 m left" a step; both begin here.
            metres = Some(m);
            cut = cut.min(i);
            let next = items.get(i + n);
            let of_ego = next.is_some_and(|x| {
                matches!(x.tag, Tag::Is(Sense::EgoRel(_)))
                    && [" me", " us", " of the ego"].iter().any(|t| x.words.ends_with(t))
            });
            if of_ego || next.is_some_and(|x| matches!(x.tag, Tag::Is(Sense::Rel(_)))) {
                place_from.get_or_insert(i);
                break;
            }
            i += n;
            continue;
        }
        let side = w.ends_with(" side") && metres.is_none() && metres_at(items, i + 1).is_none();
        if side && direction(w).is_some() {
            // "to the left side" is a place
            cut = cut.min(i);
            place_from = Some(i);
            break;
        }
        if let Some(d) = direction(w) {
            let ends = items[i + 1..].iter().all(|x| {
                matches!(
                    x.tag,
                    Tag::Is(
                        Sense::Filler
                            | Sense::Unit(_)
                            | Sense::Count(_)
                            | Sense::Article(_)
                            | Sense::At
                            | Sense::Fraction(_)
                    ) | Tag::Number(_)
                        | Tag::Comma
                )
            });
            if ends {
                dir = Some(d);
                cut = cut.min(i);
            }
        } else if matches!(
            w,
            "closer" | "nearer" | "closer to" | "nearer to" | "towards" | "toward"
        ) || (w == "close to" && i > after_noun)
        {
            toward = Some(false);
            cut = cut.min(i);
        } else if matches!(
            w,
            "away from"
                | "away"
                | "farther away"
                | "further away"
                | "further"
                | "farther"
                | "further off"
                | "farther off"
        ) {
            toward = Some(true);
            cut = cut.min(i);
        } else if matches!(w, "to" | "onto" | "into" | "on to" | "over to") && cut == items.len() {
            cut = i;
            place_from = Some(i);
            break;
        }
        i += 1;
    }
    if cut == items.len() && place_from.is_none() {
        // "move the bus behind the truck": what is said of it is where it goes.
        let from = (after_noun..items.len()).find(|k| {
            matches!(
                items[*k].tag,
                Tag::Is(
                    Sense::Rel(_) | Sense::EgoRel(_) | Sense::In | Sense::At | Sense::FarSide | Sense::Across
                )
            )
        });
        if let Some(k) = from {
            cut = k;
            place_from = Some(k);
        }
    }
    target_part(text, &items[..cut], c);
    c.destination = match (place_from, dir, toward) {
        (Some(from), ..) => destination(text, items, after_noun, from, c),
        (None, Some(direction), _) => Some(Destination::By { direction, metres }),
        (None, None, Some(away)) => Some(Destination::Toward { away, metres }),
        _ => None,
    };
}

fn destination(
    text: &str,
    items: &[Item],
    after_noun: usize,
    from: usize,
    c: &mut Command,
) -> Option<Destination> {
    let noun = items.get(after_noun.checked_sub(1)?)?.clone();
    let noun = Item {
        tag: match noun.tag {
            Tag::Is(Sense::Noun(n, _)) => Tag::Is(Sense::Noun(n, false)),
            _ => look_up("car").map_or(Tag::Unknown, Tag::Is),
        },
        ..noun
    };
    let mut rest: Vec<Item> = items[from..].to_vec();
    if matches!(rest.first().map(|i| i.words.as_str()), Some("to" | "over to")) {
        rest.remove(0);
        let place_first = rest
            .iter()
            .find(|i| !matches!(i.tag, Tag::Is(Sense::Article(_) | Sense::Filler)));
        if place_first.is_some_and(|i| matches!(i.tag, Tag::Is(Sense::Place(..) | Sense::Noun(..)))) {
            let anchor = if place_first.is_some_and(|i| matches!(i.tag, Tag::Is(Sense::Noun(..)))) {
                "next to"
            } else {
                "on"
            };
            rest.insert(
                0,
                Item {
                    tag: look_up(anchor).map_or(Tag::Unknown, Tag::Is),
                    words: anchor.into(),
                    span: items[from].span,
                    read_as: None,
                },
            );
        }
    }
    let mut whole = vec![noun];
    whole.extend(rest);
    let (reading, mentions) = parse(text, &whole);
    note_definite(c, &mentions);
    c.reading.not_understood.extend(reading.not_understood);
    let spec = reading.description.foreground.first()?.clone();
    if !spec.relations.iter().any(|r| super::edit::places_it(r.relation)) {
        return None;
    }
    c.anchors = reading.description.foreground;
    Some(Destination::Place(Box::new(spec)))
}

/// "face the other way"
fn turned_back(list: &[&str]) -> bool {
    let said = list.join(" ");
    [
        "other way",
        "opposite way",
        "other direction",
        "opposite direction",
        "wrong way",
        "reverse direction",
    ]
    .iter()
    .any(|w| said.contains(w))
}

fn is_turn_word(w: &str) -> bool {
    matches!(
        w,
        "around"
            | "round"
            | "clockwise"
            | "counterclockwise"
            | "anticlockwise"
            | "degrees"
            | "degree"
            | "deg"
            | "°"
            | "face"
            | "facing"
            | "looking at"
            | "about"
            | "backwards"
            | "counter"
            | "look"
            | "point"
            | "the other way"
            | "opposite direction"
            | "in the opposite direction"
            | "in the other direction"
    )
}

fn turning(text: &str, items: &[Item], after_noun: usize, c: &mut Command) {
    let list = words(items);
    let rest = &list[after_noun.min(list.len())..];
    let at = |w: &str| rest.iter().position(|x| *x == w);
    let degrees = items.iter().enumerate().skip(after_noun).find_map(|(k, i)| {
        let next = items.get(k + 1).map(|n| n.words.as_str());
        let is = matches!(next, Some("degrees" | "degree" | "deg" | "°"));
        match i.tag {
            Tag::Number(v) if is => Some(v),
            Tag::Is(Sense::Count(n)) if is => Some(f64::from(n.n)),
            _ => None,
        }
    });
    let right = rest
        .iter()
        .any(|w| matches!(*w, "right" | "to the right" | "rightwards"))
        || (at("clockwise").is_some() && at("counter").is_none() && at("anti").is_none());
    let left = rest.iter().any(|w| {
        matches!(
            *w,
            "left" | "to the left" | "leftwards" | "counterclockwise" | "anticlockwise"
        )
    });
    let our_way = items
        .iter()
        .skip(after_noun)
        .any(|i| i.tag == Tag::Is(Sense::EgoRel(&[RelationKind::SameDirection])));
    let ego = items
        .iter()
        .skip(after_noun)
        .any(|i| matches!(i.tag, Tag::Is(Sense::Ego)));
    let away = rest.iter().any(|w| w.contains("away"));
    c.turn = match (degrees, left, right) {
        (Some(d), _, true) => Some(Turn::By(-d.to_radians())),
        (Some(d), ..) if d.is_finite() => Some(Turn::By(d.to_radians())),
        _ if our_way => Some(Turn::WithEgo),
        _ if ego && away => Some(Turn::FromEgo),
        _ if ego => Some(Turn::ToEgo),
        _ if rest
            .iter()
            .any(|w| matches!(*w, "around" | "round" | "about" | "backwards"))
            || turned_back(&list) =>
        {
            Some(Turn::By(PI))
        }
        (_, true, _) => Some(Turn::By(FRAC_PI_2)),
        (_, _, true) => Some(Turn::By(-FRAC_PI_2)),
        _ if rest.iter().any(|w| matches!(*w, "straight" | "along")) => Some(Turn::WithLane),
        _ => None,
    };
    let cut = items
        .iter()
        .enumerate()
        .skip(after_noun)
        .find(|(_, i)| {
            let w = i.words.as_str();
            is_turn_word(w)
                || i.tag == Tag::Is(Sense::EgoRel(&[RelationKind::SameDirection]))
                || matches!(
                    w,
                    "by" | "to"
                        | "left"
                        | "right"
                        | "to the left"
                        | "to the right"
                        | "so"
                        | "towards"
                        | "toward"
                        | "away from"
                        | "away"
                        | "straight"
                        | "along"
                        | "facing away from"
                        | "looking towards"
                        | "pointing at"
                )
                || matches!(i.tag, Tag::Number(_))
        })
        .map_or(items.len(), |(k, _)| k);
    target_part(text, &items[..cut], c);
}
