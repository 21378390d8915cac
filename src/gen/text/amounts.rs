//! Numbers that change: "reduce the cars by one", "double the cones", "one pedestrian less", "all but one of the cars".

use super::exchange::{begins_with, is_noun};
use super::lexicon::{Sense, look_up};
use super::rephrase::{Change, strip};
use super::said::words::{has_noun, led as command, number, text};
use super::tokens::Token;
use super::words::edits::{VERBS, Verb};

/// Numbers: "reduce the cars by one", "cut the cones down to two", "there is one car too many", "remove all but one of them".
pub fn counted(clause: &[Token]) -> Option<(Vec<Token>, Option<Change>)> {
    let first = clause.first()?;
    let plain = |tokens: &[Token]| -> Vec<Token> {
        let skip = [
            "the", "number", "of", "count", "amount", "total", "quantity", "how", "many", "there", "are",
            "up", "down",
        ];
        let from = tokens
            .iter()
            .position(|t| !skip.contains(&text(t)) && number(t).is_none())
            .unwrap_or(0);
        let end = tokens
            .iter()
            .rposition(|t| !matches!(text(t), "up" | "down" | "back" | "from" | "in" | "number"))
            .map_or(tokens.len(), |e| e + 1);
        tokens.get(from..end).unwrap_or(&[]).to_vec()
    };
    let less = matches!(
        text(first),
        "reduce"
            | "lower"
            | "decrease"
            | "cut"
            | "diminish"
            | "drop"
            | "shrink"
            | "bring"
            | "take"
            | "trim"
            | "thin"
            | "scale"
            | "lessen"
            | "get"
            | "pare"
            | "whittle"
            | "narrow"
            | "limit"
            | "restrict"
            | "cap"
    );
    let more = matches!(
        text(first),
        "increase"
            | "raise"
            | "bump"
            | "grow"
            | "boost"
            | "up"
            | "bring"
            | "get"
            | "take"
            | "augment"
            | "expand"
            | "extend"
            | "push"
            | "set"
            | "make"
            | "change"
            | "adjust"
            | "turn"
    );
    if less || more {
        let last = clause.len().checked_sub(1)?;
        let tail = (1..clause.len())
            .rev()
            .take(5)
            .find(|k| matches!(text(&clause[*k]), "by" | "to"));
        if let Some(k) = tail {
            let n = clause[k + 1..].iter().find_map(number);
            let noun_before = has_noun(&clause[1..k]);
            let noun_after = has_noun(&clause[k + 1..])
                || clause[k + 1..]
                    .iter()
                    .any(|t| matches!(look_up(text(t)), Some(Sense::Unit(_) | Sense::Place(..))));
            let small =
                |t: &Token| matches!(text(t), "just" | "only" | "exactly" | "a" | "single" | "merely");
            let at_once = clause[k + 1..]
                .iter()
                .find(|t| !small(t))
                .is_some_and(|t| number(t).is_some())
                && text(&clause[k - 1]) != "next";
            let fits = at_once && k < last && noun_before && !noun_after && clause[k + 1..].len() <= 4;
            if let (Some(n), true) = (n, fits) {
                let np = plain(&clause[1..k]);
                if text(&clause[k]) == "by"
                    && !matches!(
                        text(first),
                        "bring" | "get" | "take" | "set" | "make" | "change" | "turn" | "push" | "adjust"
                    )
                {
                    let n = if more { n } else { -n };
                    return Some((command("keep the", first, &[&np]), Some(Change::Plus(n))));
                }
                let moves = clause[k + 1..]
                    .iter()
                    .any(|t| matches!(text(t), "degrees" | "left" | "right"));
                if text(&clause[k]) == "to" && !moves {
                    let number = clause[k + 1..].iter().find(|t| number(t).is_some()).cloned()?;
                    return Some((command("keep exactly", first, &[&[number], &np]), None));
                }
            }
        }
    }
    // "there is one car too many", "two cars too few"
    if let Some(k) = clause
        .windows(2)
        .position(|w| text(&w[0]) == "too" && matches!(text(&w[1]), "many" | "few" | "much"))
    {
        let n = clause[..k]
            .iter()
            .find_map(|t| number(t).or(matches!(text(t), "a" | "an").then_some(1)))?;
        let noun = clause[..k].iter().position(is_noun)?;
        let from = clause[..noun]
            .iter()
            .rposition(|t| number(t).is_some() || matches!(text(t), "a" | "an"))
            .map_or(0, |f| f + 1);
        let n = if text(&clause[k + 1]) == "few" { n } else { -n };
        return Some((
            command("keep the", first, &[&clause[from..k]]),
            Some(Change::Plus(n)),
        ));
    }
    // "all but one of the parked cars", "all the cars but one", "all except two cones"
    let removing = VERBS.iter().any(|(v, l)| {
        matches!(v, Verb::Remove | Verb::Clear)
            && l.split('|').any(|w| w.split(' ').next() == Some(text(first)))
    });
    if removing && let Some(all) = clause.iter().position(|t| matches!(text(t), "all" | "every")) {
        let but = (all + 1..clause.len())
            .find(|k| matches!(text(&clause[*k]), "but" | "except" | "save" | "bar"))?;
        let n_at = (but + 1..clause.len().min(but + 4)).find(|k| number(&clause[*k]).is_some())?;
        let before: Vec<Token> = clause[all + 1..but]
            .iter()
            .filter(|t| !matches!(text(t), "the" | "of" | "my"))
            .cloned()
            .collect();
        let after: Vec<Token> = clause[n_at + 1..]
            .iter()
            .filter(|t| !matches!(text(t), "of" | "the" | "them" | "my"))
            .cloned()
            .collect();
        let np = if has_noun(&before) { before } else { after };
        if has_noun(&np) {
            return Some((
                command("keep exactly", first, &[&[clause[n_at].clone()], &np]),
                None,
            ));
        }
    }
    None
}

/// "double the cars", "half as many cars", "two fewer pedestrians", "one pedestrian less".
pub fn arithmetic(rest: &[Token]) -> Option<(Vec<Token>, Change)> {
    let at = |words: &[&str]| -> Option<usize> { (0..rest.len()).find(|i| begins_with(&rest[*i..], words)) };
    let first = &rest[0];
    let times = [
        ("double", 2.0),
        ("triple", 3.0),
        ("treble", 3.0),
        ("quadruple", 4.0),
        ("halve", 0.5),
        ("twice", 2.0),
        ("thrice", 3.0),
    ];
    let lead = strip(
        rest,
        &[
            &["make"],
            &["make", "it"],
            &["put"],
            &["add"],
            &["have"],
            &["show"],
        ],
    );
    let mut factor = lead
        .first()
        .and_then(|t| times.iter().find(|(w, _)| t.text == *w))
        .map(|(_, f)| *f);
    if begins_with(lead, &["half", "as", "many"])
        || begins_with(lead, &["half", "the", "number"])
        || begins_with(lead, &["cut", "the", "number"]) && at(&["half"]).is_some()
    {
        factor = Some(0.5);
    }
    if lead.get(1).is_some_and(|t| t.text == "times") {
        factor = lead.first().and_then(number).map(|n| n as f64);
    }
    let noun_from = |tokens: &[Token]| -> Option<usize> { tokens.iter().position(is_noun) };
    if let Some(f) = factor {
        let noun = noun_from(lead)?;
        let double_decker = lead[0].text == "double"
            && lead
                .get(1)
                .is_some_and(|t| t.text == "decker" || t.text == "parked");
        if double_decker {
            return None;
        }
        // what is said between the number words and the noun belongs to it
        let small = ["the", "number", "of", "as", "many", "times", "a"];
        let mut from = noun;
        while from > 1 && !small.contains(&lead[from - 1].text.as_str()) && number(&lead[from - 1]).is_none()
        {
            from -= 1;
        }
        let end = lead
            .iter()
            .position(|t| matches!(t.text.as_str(), "in" if t.text == "half"))
            .unwrap_or(lead.len());
        return Some((
            led_by("keep the", first, &lead[from.min(end)..end]),
            Change::Times(f),
        ));
    }
    // fewer and less; more, where it comes after the noun
    let fewer = rest
        .iter()
        .position(|t| matches!(t.text.as_str(), "fewer" | "less"))?;
    let n = rest[..fewer]
        .iter()
        .rev()
        .find_map(|t| number(t).or((matches!(t.text.as_str(), "a" | "an")).then_some(1)))
        .unwrap_or(1);
    let noun = noun_from(rest)?;
    let next_to_noun = fewer + 1 == rest.len()
        || fewer < noun
        || rest[fewer + 1].text == "please"
        || super::said::words::is_place(&rest[fewer + 1..]);
    if !next_to_noun || rest.get(fewer + 1).is_some_and(|t| t.text == "than") {
        return None;
    }
    let mut tokens: Vec<Token> = Vec::new();
    for (i, t) in rest.iter().enumerate() {
        let skip = i == fewer
            || (i < noun
                && (number(t).is_some()
                    || matches!(t.text.as_str(), "a" | "an" | "make" | "it" | "one" | "have")));
        if !skip {
            tokens.push(t.clone());
        }
    }
    Some((led_by("keep the", first, &tokens), Change::Plus(-n)))
}

fn led_by(verb: &str, at: &Token, rest: &[Token]) -> Vec<Token> {
    command(verb, at, &[rest])
}
