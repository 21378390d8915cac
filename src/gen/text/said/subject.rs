//! Who a clause speaks of, and where what it says of him begins.

use super::super::edit_grammar::Back;
use super::super::tokens::{Token, TokenKind};
use super::Talk;
use super::lists::{ADVERBS, BECOMES, HELPERS, NEGATED, PRONOUNS};
use super::words::{first_noun, is, is_finite, is_place, led, number, text};

/// What kind of subject it is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// Named before: "it", "the other two".
    Back(Back),
    /// In the scene: "the bus", "both cars", "bus".
    Known,
    /// Some of those in the scene: "one of the children".
    Part,
    /// New: "a bus", "two more people".
    Fresh,
}

/// A subject.
#[derive(Clone, Debug)]
pub struct Subject {
    pub kind: Kind,
    /// Its words, as a command names a target.
    pub np: Vec<Token>,
    /// Its noun.
    pub noun: Vec<Token>,
    /// Where the predicate begins.
    pub pred: usize,
    /// More than one: base forms are finite.
    pub plural: bool,
}

pub(super) fn pointing(tokens: &[Token]) -> Option<(Back, usize)> {
    let first = tokens.first()?;
    let others = [
        "the other ones",
        "the other one",
        "the other two",
        "the other three",
        "the other four",
        "the others",
        "the other",
        "the rest of them",
        "the rest",
        "the remaining ones",
        "the remaining two",
        "the remaining three",
        "the remaining one",
        "the second one",
        "the third one",
        "the fourth one",
        "the last one",
    ];
    if let Some(n) = super::words::leads(tokens, &others)
        && super::words::noun_at(&tokens[n..]).is_none()
    {
        return Some((Back::Others, n));
    }
    // "the fourth is still crossing"
    let nth = super::words::leads(
        tokens,
        &["the second", "the third", "the fourth", "the fifth", "the last"],
    );
    if let Some(n) = nth
        && tokens.get(n).is_some_and(|t| {
            HELPERS.contains(&text(t))
                || is_finite(text(t), false) && super::words::noun_at(&tokens[n..]).is_none()
        })
    {
        return Some((Back::Others, n));
    }
    let both = super::words::leads(
        tokens,
        &[
            "both of them",
            "all of them",
            "these two",
            "those two",
            "the two of them",
            "the two",
            "all three of them",
            "these",
            "those",
        ],
    );
    if let Some(n) = both
        && super::words::noun_at(&tokens[n..]).is_none()
    {
        return Some((Back::Same, n));
    }
    match text(first) {
        "he" | "she" | "hes" | "shes" | "hell" | "shell" | "hed" | "shed" | "him" | "her" => {
            Some((Back::Person, 1))
        }
        // "it's no longer there"
        "its"
            if is(tokens.get(1), &NEGATED)
                || is(tokens.get(1), &ADVERBS)
                || is(
                    tokens.get(1),
                    &[
                        "no", "gone", "a", "an", "moving", "standing", "waiting", "parked", "there",
                    ],
                )
                || super::words::number(tokens.get(1).unwrap_or(first)).is_some()
                || tokens.len() > 1
                    && is_place(&tokens[1..])
                    && !is(tokens.get(1), &["left", "right", "back"]) =>
        {
            Some((Back::Same, 1))
        }
        w if PRONOUNS.contains(&w) || w == "them" => Some((Back::Same, 1)),
        "that" | "this" | "both" | "one" if is(tokens.get(1), &HELPERS) || is(tokens.get(1), &NEGATED) => {
            (text(first) != "one").then_some((Back::Same, 1))
        }
        _ => None,
    }
}

/// Where the predicate begins after a noun phrase that ends at `from`.
fn predicate_at(tokens: &[Token], from: usize, base: bool) -> Option<usize> {
    let mut relative = false;
    let mut k = from;
    while k < tokens.len() {
        let t = &tokens[k];
        match t.kind {
            TokenKind::Comma if relative => {
                relative = false;
                k += 1;
                continue;
            }
            // "both walkers, they must change"
            TokenKind::Comma if is(tokens.get(k + 1), &PRONOUNS) => {
                return (k + 2 < tokens.len()).then_some(k + 2);
            }
            TokenKind::Comma | TokenKind::Stop => return None,
            TokenKind::Mark | TokenKind::Symbol => {
                // "excavator -> left roadside", "parked cars: four are enough"
                let mut next = k + 1;
                while tokens
                    .get(next)
                    .is_some_and(|t| matches!(t.kind, TokenKind::Mark | TokenKind::Symbol))
                {
                    next += 1;
                }
                return (next < tokens.len() && !matches!(text(t), "(" | ")" | "\"" | "/")).then_some(next);
            }
            _ => {}
        }
        let w = text(t);
        if matches!(w, "that" | "which" | "who" | "whom") {
            relative = true;
            k += 1;
            // its verb belongs to it
            while k < tokens.len()
                && (HELPERS.contains(&text(&tokens[k]))
                    || ADVERBS.contains(&text(&tokens[k]))
                    || NEGATED.contains(&text(&tokens[k]))
                    || matches!(text(&tokens[k]), "i" | "we" | "you" | "see"))
            {
                k += 1;
            }
            if tokens.get(k).is_some_and(|t| is_finite(text(t), true)) {
                k += 1;
            }
            continue;
        }
        // "the cyclist I don't need any more"
        if matches!(w, "i" | "we" | "you")
            && tokens
                .get(k + 1)
                .is_some_and(|t| !is_place(std::slice::from_ref(t)))
        {
            return Some(k);
        }
        // "bicycle change to scooter"
        if k == from && super::words::leads(&tokens[k..], &BECOMES).is_some() {
            return Some(k);
        }
        // "on the cross street", "a stop": after an article it is no verb
        let named = k > 0
            && is(
                tokens.get(k - 1),
                &[
                    "the", "a", "an", "my", "our", "this", "that", "all", "every", "each", "both", "these",
                    "those",
                ],
            )
            && k > from;
        if named && !HELPERS.contains(&w) {
            k += 1;
            continue;
        }
        let helper =
            HELPERS.contains(&w) || NEGATED.contains(&w) || w == "no" && is(tokens.get(k + 1), &["longer"]);
        if helper || is_finite(w, base) && !modifies(tokens, k) {
            return Some(k);
        }
        if ADVERBS.contains(&w)
            && tokens
                .get(k + 1)
                .is_some_and(|t| HELPERS.contains(&text(t)) || is_finite(text(t), base))
        {
            return Some(k);
        }
        // "to wait" after "I want the bus"
        if w == "to"
            && base
            && tokens
                .get(k + 1)
                .is_some_and(|t| is_finite(text(t), true) || HELPERS.contains(&text(t)))
        {
            return Some(k);
        }
        // "parked cars out", "fire engine in"
        let ends = tokens
            .get(k + 1)
            .is_none_or(|t| matches!(t.kind, TokenKind::Comma | TokenKind::Stop));
        if ends && k == from && matches!(w, "out" | "away" | "off" | "gone" | "in") {
            return Some(k);
        }
        k += 1;
    }
    None
}

/// "the car parked on the left has gone": a past form before another verb only says which.
fn modifies(tokens: &[Token], k: usize) -> bool {
    let w = text(&tokens[k]);
    let past = w.ends_with("ed") || matches!(w, "stuck" | "stood" | "sat" | "driven");
    past && tokens[k + 1..]
        .iter()
        .take_while(|t| !matches!(t.kind, TokenKind::Comma | TokenKind::Stop))
        .any(|t| HELPERS.contains(&text(t)))
        && !tokens[k + 1..].iter().take(12).any(|t| text(t) == "and")
}

/// The subject of a clause with the predicate found; `caused`: after "let" and "I want".
pub fn subject(tokens: &[Token], talk: &Talk<'_>, caused: bool) -> Option<Subject> {
    if let Some((back, n)) = pointing(tokens) {
        let plural = !is(tokens.first(), &["it", "he", "she", "that", "this"]);
        let first = text(&tokens[0]);
        // "hes behind me": the verb is in the pronoun
        let pred = if matches!(
            first,
            "its"
                | "hes"
                | "shes"
                | "theyre"
                | "itll"
                | "hell"
                | "shell"
                | "theyll"
                | "hed"
                | "shed"
                | "theyd"
                | "itd"
        ) {
            Some(1)
        } else {
            predicate_at(tokens, n, plural || caused).filter(|p| *p == n || *p == n + 1)
        };
        // "I want her riding 9 m in front of us"
        let doing = |t: &Token| {
            matches!(
                super::super::lexicon::look_up(text(t)),
                Some(super::super::lexicon::Sense::State(..))
            )
        };
        let pred = pred.or_else(|| {
            (caused && (is_place(&tokens[n..]) || tokens.get(n).is_some_and(doing))).then_some(n)
        })?;
        return Some(Subject {
            kind: Kind::Back(back),
            np: tokens[..n].to_vec(),
            noun: Vec::new(),
            pred,
            plural,
        });
    }
    let first = tokens.first()?;
    if matches!(first.kind, TokenKind::Comma | TokenKind::Mark | TokenKind::Stop)
        || matches!(
            text(first),
            "there"
                | "no"
                | "nobody"
                | "nothing"
                | "i"
                | "we"
                | "you"
                | "where"
                | "whatever"
                | "whichever"
                | "only"
                | "just"
        )
    {
        return None;
    }
    // "clear the car away" is no clear car
    if text(first) == "clear" && is(tokens.get(1), &["the", "my", "both", "those", "these", "that"]) {
        return None;
    }
    // "add four cars parked on the right"
    let orders = matches!(
        text(first),
        "add" | "insert" | "include" | "create" | "show" | "remove" | "delete" | "erase" | "replace"
    );
    if orders
        && tokens.get(1).is_some_and(|t| {
            number(t).is_some() || matches!(text(t), "a" | "an" | "another" | "some" | "the" | "all" | "both")
        })
    {
        return None;
    }
    let who = matches!(
        text(first),
        "whoever" | "everyone" | "everybody" | "anyone" | "anybody" | "whoevers"
    );
    let (noun, end) = first_noun(tokens).filter(|n| n.0 < 9)?;
    // before the noun stand only words that describe it
    let described = tokens[..noun].iter().enumerate().all(|(i, t)| {
        t.kind != TokenKind::Comma
            && t.kind != TokenKind::Mark
            && !(HELPERS.contains(&text(t)) || NEGATED.contains(&text(t)))
            && (!is_place(&tokens[i..noun])
                || matches!(
                    text(t),
                    "left"
                        | "right"
                        | "further"
                        | "farther"
                        | "closer"
                        | "nearer"
                        | "up"
                        | "back"
                        | "oncoming"
                        | "approaching"
                ))
            && !matches!(
                text(t),
                "it" | "them"
                    | "him"
                    | "there"
                    | "with"
                    | "for"
                    | "as"
                    | "like"
                    | "than"
                    | "where"
                    | "instead"
                    | "without"
                    | "and"
                    | "or"
            )
    });
    if !described && !who {
        return None;
    }
    let described_fresh = matches!(
        text(first),
        "a" | "an" | "another" | "some" | "somebody" | "someone" | "their" | "his" | "her" | "its"
    ) || tokens[..noun]
        .iter()
        .any(|t| matches!(text(t), "more" | "additional" | "extra" | "another" | "further"));
    let of = tokens.iter().take(noun).position(|t| text(t) == "of");
    let part = of.is_some_and(|k| {
        k <= 2
            && (number(first).is_some() || matches!(text(first), "any" | "some" | "either" | "most"))
            && is(tokens.get(k + 1), &["the", "these", "those", "my", "our"])
    });
    // "one pedestrian crosses, the other one stays": one of those that are there
    let leaves = is(
        tokens.get(end),
        &[
            "leave",
            "leaves",
            "disappear",
            "disappears",
            "vanish",
            "vanishes",
            "depart",
            "departs",
            "goes",
            "left",
            "walks",
            "drives",
        ],
    ) && (!is(tokens.get(end), &["goes", "walks", "drives"])
        || is(tokens.get(end + 1), &["away", "off", "home"]));
    let one_of = (talk.others || leaves)
        && !part
        && number(first).is_some_and(|n| n >= 1 && talk.fits(&tokens[noun..end]) > n as usize)
        && !described_fresh;
    // "two cars have driven home": of those that are there
    let leave = !part
        && !described_fresh
        && number(first).is_some_and(|n| n >= 1 && talk.fits(&tokens[noun..end]) >= n as usize);
    let definite = matches!(
        text(first),
        "the"
            | "my"
            | "that"
            | "this"
            | "these"
            | "those"
            | "both"
            | "all"
            | "every"
            | "each"
            | "our"
            | "your"
            | "said"
    ) || who;
    let bare = !definite && !described_fresh && !part && number(first).is_none();
    let plural = matches!(
        super::super::lexicon::look_up(&tokens[end - 1].text),
        Some(super::super::lexicon::Sense::Noun(_, true))
    ) || matches!(text(first), "these" | "those" | "both" | "all")
        || tokens[..noun].iter().any(|t| number(t).is_some_and(|n| n > 1))
        || is(tokens.get(end), &["and"]);
    let base = caused || plural;
    // "he who drives the car" is the car
    let from = end;
    let pred = predicate_at(tokens, from, base);
    let pred = match pred {
        // "15 m behind me, not in front"
        Some(p) if caused && NEGATED.contains(&text(&tokens[p])) => {
            (from..p).find(|i| is_place(&tokens[*i..p])).unwrap_or(p)
        }
        Some(p) => p,
        // "I'd like to see the bus waiting at the crossing"
        None if caused
            && is(
                tokens.get(from),
                &[
                    "waiting", "standing", "driving", "walking", "riding", "crossing", "facing",
                ],
            )
            && definite
            && talk.fits(&tokens[..end]) == 1 =>
        {
            from
        }
        // "I need the truck 15 m behind me"
        None if caused => (from..tokens.len()).find(|i| is_place(&tokens[*i..]))?,
        None => return None,
    };
    let one_of = one_of
        || leave
            && !tokens[pred..]
                .iter()
                .any(|t| matches!(text(t), "missing" | "absent"))
            && super::predicate::parts(&tokens[pred..], true)
                .iter()
                .any(super::predicate::Part::is_gone);
    let known = definite || bare && talk.fits(&tokens[..end]) > 0;
    let kind = if part || one_of {
        Kind::Part
    } else if known {
        Kind::Known
    } else {
        Kind::Fresh
    };
    let mut np: Vec<Token> = if who {
        // "whoever drives the car behind us": the car; "everybody": all people
        tokens[noun.saturating_sub(1)..pred].to_vec()
    } else {
        tokens[..pred].to_vec()
    };
    while np.last().is_some_and(|t| {
        matches!(t.kind, TokenKind::Mark | TokenKind::Symbol | TokenKind::Comma)
            || ADVERBS.contains(&text(t))
            || PRONOUNS.contains(&text(t))
    }) {
        np.pop();
    }
    if one_of {
        np = led("any", first, &[&np]);
    } else if part {
        let k = of.unwrap_or(1);
        let rest: Vec<Token> = np[k + 2..]
            .iter()
            .enumerate()
            .filter(|(i, t)| !(*i == 0 && number(t).is_some()))
            .map(|(_, t)| t.clone())
            .collect();
        np = led("any", first, &[&np[..1], &rest]);
    }
    Some(Subject {
        kind,
        np,
        noun: tokens[noun..end].to_vec(),
        pred,
        plural,
    })
}
