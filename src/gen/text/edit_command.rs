//! Imperatives: where each command begins, what it is about, into what.

use super::description::{Anchor, Count, Reading};
use super::edit_grammar::Command;
use super::edit_moving::{is_turn_word, moving, turning};
use super::lexicon::Sense;
use super::mention::Mention;
use super::parse::Parser;
use super::rephrase::Rephrased;
use super::tag::{Item, Tag, tag};
use super::tokens::{Token, TokenKind};
use super::words::edits::{VERBS, Verb};
use crate::scene::graph::ObjectState;

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

/// The verb that these words begin with.
pub(super) fn verb_of(tokens: &[Token]) -> Option<Verb> {
    verb_at(tokens, 0).map(|v| v.0)
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

/// The commands of a sentence; one without a verb adds, keeps so many ("only two cars") or sets the style.
pub(super) fn imperatives(
    text: &str,
    rephrased: &Rephrased,
    last_noun: &mut Option<Vec<Token>>,
) -> Vec<Command> {
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
        let mut c = command(text, &slice, *n, *verb);
        let becomes = c.by.is_some() || slice.iter().any(|t| t.text == "into");
        let role = if becomes { Some(Verb::Replace) } else { *verb };
        if let Some(noun) = super::back::named(&slice[*n..], role) {
            *last_noun = Some(noun);
        }
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

pub(super) fn words(items: &[Item]) -> Vec<&str> {
    items.iter().map(|i| i.words.as_str()).collect()
}

pub(super) fn parse(text: &str, items: &[Item]) -> (Reading, Vec<Mention>) {
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
    // "drop one of them", "drop the other two"
    let points = list.first().is_some_and(|w| {
        w.starts_with("the ")
            || w.ends_with(" of")
            || w.contains(" of ")
            || matches!(*w, "it" | "them" | "both" | "all" | "every")
    }) || list.get(1).is_some_and(|w| w.starts_with("of"));
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
        && matches!(
            list.first(),
            Some(&"the" | &"my" | &"that" | &"this" | &"both" | &"all the" | &"all of the" | &"all my")
        )
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
    let given = verb;
    let mut verb = match verb {
        None if only => Verb::Keep,
        // "the cyclist behind us has two friends with him" asks for nothing that is known
        None if there_already && placed && says_something(tokens) => Verb::Note,
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
        Some(Verb::Add) if matches!(first, "drop") && (definite_next || points) => Verb::Remove,
        Some(v) => v,
    };
    let implied = given.is_none();
    let mut c = Command::new(verb, text, span);
    c.implied = implied;
    c.only = tokens
        .iter()
        .take(4)
        .any(|t| matches!(t.text.as_str(), "only" | "just" | "nothing" | "alone"));
    c.state = match first {
        "stop" | "halt" => Some(ObjectState::Waiting),
        "park" => Some(ObjectState::Parked),
        "start" => Some(ObjectState::Moving),
        _ => None,
    };
    let painted = super::edit_paint::given(&items, verb);
    let items = match painted {
        Some((color, rest)) => {
            c.color = Some(color);
            verb = Verb::Paint;
            c.verb = verb;
            rest
        }
        None => items.clone(),
    };
    c.place = items.iter().find_map(|i| match i.tag {
        Tag::Is(Sense::Place(Anchor::Lane(role), _)) if super::edit::clears(role) => Some(role),
        _ => None,
    });
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
            // "with a coach 16 m behind me": there, not where the old one stands
            let same = items[k..]
                .iter()
                .any(|i| i.words == "same" || i.words.contains("same "));
            let told = verb == Verb::Replace && !same;
            if let Some(spec) = r.description.foreground.first().filter(|s| told && is_placed(s)) {
                c.destination = Some(super::edit_grammar::Destination::Place(Box::new(spec.clone())));
                c.anchors.clone_from(&r.description.foreground);
            }
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

/// True if a verb is said of what is named.
/// True if it is said where it shall be, not only which way it faces.
fn is_placed(spec: &super::description::ObjectSpec) -> bool {
    use crate::scene::graph::RelationKind as R;
    let way = |r: R| {
        matches!(
            r,
            R::SameDirection | R::OppositeDirection | R::Facing | R::FacingAway
        )
    };
    spec.relations
        .iter()
        .any(|r| !way(r.relation) || r.distance_m.is_some())
}

fn says_something(tokens: &[Token]) -> bool {
    let noun = tokens.iter().position(super::rephrase::is_noun).unwrap_or(0);
    tokens[noun..].iter().any(|t| {
        matches!(
            t.text.as_str(),
            "has"
                | "have"
                | "had"
                | "is"
                | "are"
                | "was"
                | "were"
                | "does"
                | "do"
                | "did"
                | "disturbs"
                | "seems"
                | "looks"
        )
    })
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

pub(super) fn note_definite(c: &mut Command, mentions: &[Mention]) {
    // "next to truck": what is named bare is looked for, too
    let known = |m: &&Mention| m.definite || m.bare && m.is_anchor && !m.plural;
    c.definite
        .extend(mentions.iter().filter(known).map(|m| m.spec.span));
    c.picks
        .extend(mentions.iter().filter_map(|m| m.pick.map(|p| (m.spec.span, p))));
}

pub(super) fn target_part(text: &str, items: &[Item], c: &mut Command) {
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
