//! Clauses of a form of their own: numbers, halves, places before their subject, one thing for another.

use super::super::edit_command::{target_part, verb_of};
use super::super::edit_grammar::Command;
use super::super::lexicon::{Sense, look_up};
use super::super::tag::tag;
use super::super::tokens::{Span, Token, TokenKind};
use super::super::words::edits::Verb;
use super::lists::{ADVERBS, HELPERS, PRESENT};
use super::predicate::parts;
use super::subject::{Kind, Subject};
use super::ways::{is_step, times};
use super::words::{self, find, first_noun, has_noun, is, is_place, leads, led, number, text, trimmed};
use super::{Piece, Talk, acts, predicate};

/// Something new and where it shall be: "a woman has to stand between the two trucks".
pub(super) fn fresh(s: &Subject, pred: &[Token], clause: &[Token], talk: &Talk<'_>) -> Option<Vec<Piece>> {
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
    // "a bulldozer alone can't do it" is a remark
    if !parts.is_empty() && parts.iter().all(|p| p.not) {
        return Some(Vec::new());
    }
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
        while let Some(n) = leads(words, &PRESENT) {
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
    while is(main.first(), &["and"]) {
        main.remove(0);
    }
    // "directly behind the first one"
    if let Some((i, n)) = find(
        &main,
        &[
            "the other two",
            "the other three",
            "the other four",
            "the others",
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
        let many = is(main.get(i + n - 1), &["two", "three", "four", "others"]);
        let one = if let (true, [noun]) = (many, s.noun.as_slice()) {
            let many = matches!(look_up(text(noun)), Some(Sense::Noun(_, true)));
            vec![if many {
                noun.clone()
            } else {
                words::word(&super::super::lexicon::plural(text(noun)), noun)
            }]
        } else if is(main.get(i + n - 1), &["first", "one", "other"]) {
            super::topics::singular_of(&s.noun)
        } else {
            s.noun.clone()
        };
        let the = led("the", first, &[&one]);
        main.splice(i..i + n, the);
    }
    // "behind it": what else was named
    let other = first_noun(&main)
        .map(|n| main[n.0..n.1].to_vec())
        .or_else(|| talk.last.as_ref().map(|l| led(l, first, &[])));
    if let (Some(other), Some(k)) = (
        other,
        (1..main.len()).find(|k| {
            is(main.get(*k), &["it", "him", "her", "them"])
                && (1..=4.min(*k)).any(|n| is_place(&main[k - n..]))
        }),
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
pub(super) fn fragment(inner: &[Token], talk: &Talk<'_>) -> Option<Vec<Piece>> {
    if super::super::rephrase::is_verb(&inner[0])
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
    if !bare || verb || talk.fits(&inner[..end]) != 1 || !(goal || is_step(&inner[end..])) {
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
pub(super) fn inverted(inner: &[Token], talk: &Talk<'_>) -> Option<Vec<Piece>> {
    if !is_place(inner) || super::super::rephrase::is_verb(&inner[0]) {
        return None;
    }
    if let Some(found) = subject_late(inner) {
        return Some(found);
    }
    let verb = (1..inner.len())
        .find(|i| HELPERS.contains(&text(&inner[*i])) || words::is_finite(text(&inner[*i]), false))?;
    let mut from = verb + 1;
    while inner.get(from).is_some_and(|t| {
        ADVERBS.contains(&text(t))
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
    // "on the left roadside there should be four cars": in all
    let many = inner
        .get(from)
        .filter(|t| number(t).is_some() && !is(Some(t), &["a", "an", "one"]));
    let total = many.is_some()
        && is(inner.get(verb), &["should", "must", "shall", "ought"])
        && find(
            &inner[verb - 1..from],
            &[
                "there should be",
                "there must be",
                "there shall be",
                "there ought to be",
            ],
        )
        .is_some()
        && !inner[from..end]
            .iter()
            .any(|t| is(Some(t), &["more", "other", "further", "additional", "extra"]))
        && inner.len() == end;
    let before = &inner[..verb.saturating_sub(1)];
    if total && talk.fits(&[&inner[from + 1..end], before].concat()) > 0 {
        return Some(vec![Piece::Plain(led(
            "keep exactly",
            &inner[0],
            &[&inner[from..end], before],
        ))]);
    }
    // (a comma parts the place from what more is said)
    Some(vec![Piece::Plain(led(
        "add",
        &inner[0],
        &[&inner[from..end], &inner[..verb], &inner[end..]],
    ))])
}

/// "behind the bus a car is waiting": a car waits there.
fn subject_late(inner: &[Token]) -> Option<Vec<Piece>> {
    // the place has ended: with its noun, a lane, or one that it is seen from
    let ended = |k: usize| {
        is(
            inner.get(k - 1),
            &[
                "us", "me", "it", "them", "him", "her", "ahead", "behind", "left", "right", "there",
            ],
        ) || (0..k).any(|i| {
            words::noun_at(&inner[i..k]).is_some_and(|n| i + n == k)
                || words::longest(&inner[i..k])
                    .is_some_and(|l| i + l.1 == k && matches!(l.0, Sense::Place(..)))
        })
    };
    let from = (2..inner.len().min(12)).find(|k| {
        let fresh = is(inner.get(*k), &["a", "an", "another"])
            || number(&inner[*k]).is_some() && words::unit_at(&inner[k + 1..]).is_none();
        fresh && ended(*k)
    })?;
    let (_, b) = first_noun(&inner[from..]).filter(|x| x.0 < 4)?;
    let end = from + b;
    let verb = inner.get(end)?;
    let helped = inner[end..]
        .iter()
        .take_while(|t| HELPERS.contains(&text(t)) || ADVERBS.contains(&text(t)))
        .count();
    let many = matches!(
        super::super::lexicon::look_up(text(&inner[end - 1])),
        Some(Sense::Noun(_, true))
    );
    let before = &inner[..from];
    let asks = before
        .iter()
        .any(|t| HELPERS.contains(&text(t)) || t.kind == TokenKind::Comma);
    if asks || helped == 0 && !words::is_finite(text(verb), many) {
        return None;
    }
    Some(vec![Piece::Plain(led(
        "add",
        &inner[0],
        &[
            &inner[from..end],
            &inner[end + helped..].iter().take(1).cloned().collect::<Vec<_>>(),
            before,
            inner.get(end + helped + 1..).unwrap_or(&[]),
        ],
    ))])
}

/// "only four must stay"
pub(super) fn only_so_many(inner: &[Token], talk: &Talk<'_>) -> Option<Vec<Piece>> {
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

/// "half of the cones can go", "remove half the cones"
pub(super) fn half(inner: &[Token]) -> Option<Vec<Piece>> {
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
    // ("knock off half of the cones")
    let removing = i == 1 && matches!(text(&inner[0]), "take" | "drop" | "clear")
        || (1..3).contains(&i) && verb_of(&inner[..=i]) == Some(Verb::Remove);
    let end = i + n + first_noun(&inner[i + n..])?.1;
    // (half of them stay where half of them go)
    let been = predicate::parts(&inner[end..], true)
        .iter()
        .any(predicate::Part::is_gone);
    let keeps = is(inner.first(), &["only", "just", "keep", "leave", "retain"]) && i <= 2;
    let goes = keeps
        || i == 0 && been
        || i == 0
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
                        | "enough"
                        | "suffice"
                        | "suffices"
                        | "do"
                        | "plenty"
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
pub(super) fn distance_times(inner: &[Token], talk: &Talk<'_>) -> Option<Vec<Piece>> {
    if !is(inner.first(), &["double", "halve", "triple", "half"]) {
        return None;
    }
    let factor = times(inner)?;
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
pub(super) fn all_but(inner: &[Token]) -> Option<Vec<Piece>> {
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

/// "we have run out of cones"
pub(super) fn run_out(inner: &[Token], talk: &Talk<'_>) -> Option<Vec<Piece>> {
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
pub(super) fn preferred(inner: &[Token], talk: &Talk<'_>) -> Option<Vec<Piece>> {
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
    // "rather have a tram than a bus": the only bus
    let only = is(old.first(), &["a", "an"]) && talk.fits(&old[1..end]) == 1;
    let the = led("the", &inner[0], &[&old[1..]]);
    let (old, end, known) = if only {
        (&the[..], end, true)
    } else {
        (old, end, known)
    };
    (fresh && known && has_noun(new) && first_noun(new)?.0 < 4 && talk.fits(&old[..end]) > 0).then(|| {
        vec![Piece::Plain(led(
            "replace",
            &inner[0],
            &[old, &led("with", &inner[0], &[new])],
        ))]
    })
}

/// "make a bus of that truck"
pub(super) fn made_of(inner: &[Token]) -> Option<Vec<Piece>> {
    let several = first_noun(inner).is_some_and(|x| x.0 == 1)
        || inner
            .get(1)
            .is_some_and(|t| number(t).is_some() || is(Some(t), &["a", "an"]));
    if !is(inner.first(), &["make", "build", "create", "form"]) || !several {
        return None;
    }
    let (i, n) = find(inner, &["out of", "of", "from"])?;
    let (new, old) = (&inner[1..i], &inner[i + n..]);
    let known = is(
        old.first(),
        &[
            "the", "that", "this", "those", "both", "my", "it", "them", "all", "every",
        ],
    );
    let end = first_noun(old).map_or(1, |x| x.1).min(old.len());
    // "out of two of the parked cars": any two of them
    let some = old.first().is_some_and(|t| number(t).is_some())
        && is(old.get(1), &["of"])
        && is(old.get(2), &["the", "those", "these", "my"])
        && end > 3;
    let old = match some {
        true => led("any", &old[0], &[&old[..1], &old[3..end]]),
        false => old[..end].to_vec(),
    };
    ((known || some) && has_noun(new)).then(|| {
        vec![Piece::Plain(led(
            "replace",
            &inner[0],
            &[&old, &led("with", &inner[0], &[new])],
        ))]
    })
}

/// "a tanker comes in its place", "put one lorry at the same place"
pub(super) fn takes_place(inner: &[Token], i: usize, n: usize, talk: &Talk<'_>) -> Option<Vec<Piece>> {
    // "remove the car and put one in its place" is more than one command
    // ("drop a van in its place" puts one there)
    let drops = is(inner.first(), &["drop"])
        && (is(inner.get(1), &["a", "an", "another"]) || inner.get(1).is_some_and(|t| number(t).is_some()));
    if super::some_of::removes(inner.first()) && !drops {
        return None;
    }
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
                || look_up(text(&rest[*k])).is_some_and(|s| {
                    matches!(
                        s,
                        Sense::Color(_) | Sense::Size(_) | Sense::Attribute(_) | Sense::State(_, false)
                    )
                })
                || matches!(text(&rest[*k]), "oncoming" | "approaching" | "more")
        })
        .last()
        // "on its place comes motorbike"
        .or((a == 0
            || !is(
                rest.get(a - 1),
                &["the", "that", "this", "my", "both", "those", "these"],
            ))
        .then_some(a))?;
    let np = &rest[lead..b];
    let span = inner.iter().fold(inner[0].span, |s: Span, t| s.to(t.span));
    let mut c = Command::new(Verb::Add, talk.text, span);
    target_part(talk.text, &tag(np), &mut c);
    c.in_place = true;
    c.by = c.targets.first().cloned();
    let noun = Some(rest[a..b].to_vec());
    Some(vec![Piece::Meant(Box::new(c), noun)])
}
