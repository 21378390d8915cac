//! Distances and numbers that point back: "the same distance behind", "twice that distance", "just as many on the right".

use super::ellipsis::{digits, ends, is_unit, number};
use super::tokens::{Token, TokenKind};
use super::wording::{begins, rewritten};

/// Distances as multiples of the one that was named last.
const MULTIPLES: [(f64, &str); 4] = [
    (
        2.0,
        "twice that distance|at twice that distance|double that distance|at double that distance|twice the distance|at twice the distance|double the distance|at double the distance|twice as far|twice as far away|double as far",
    ),
    (
        0.5,
        "half that distance|at half that distance|half the distance|at half the distance|half as far|half as far away",
    ),
    (
        3.0,
        "three times that distance|at three times that distance|three times the distance|three times as far|thrice that distance|triple that distance|three times as far away",
    ),
    (
        1.5,
        "one and a half times that distance|one and a half times as far",
    ),
];

/// "another 12 m further on": so much more than was named last.
pub(super) fn farther_by(sentence: &[Token], before: &[Token]) -> Vec<Token> {
    const MORE: &str = "another|a further|a good|yet another";
    const ON: &str = "further on|farther on|further ahead|farther ahead|further up|further along|beyond that|beyond|on|further|farther|further down|further down the road|further up the road";
    rewritten(sentence, |i, out| {
        let said: Vec<&Token> = before.iter().chain(out.iter()).collect();
        let last = said
            .windows(2)
            .rposition(|w| number(w[0]).is_some() && is_unit(w[1]))
            .and_then(|k| Some((k, number(said[k])?)));
        let more = begins(&sentence[i..], MORE).filter(|n| sentence.get(i + n + 1).is_some_and(is_unit));
        let found = more.zip(last).and_then(|(n, (k, first))| {
            let metres = number(sentence.get(i + n)?)?;
            let on = begins(&sentence[i + n + 2..], ON)?;
            // ("12 m further on than the bus" says from where)
            let free = sentence.get(i + n + 2 + on).is_none_or(|t| {
                t.kind != TokenKind::Word || matches!(t.text.as_str(), "in" | "and" | "is" | "a")
            });
            let way = said[k + 2..].iter().take(2).find_map(|t| match t.text.as_str() {
                "behind" => Some("behind"),
                "ahead" | "in" => Some("ahead of"),
                _ => None,
            });
            free.then_some((n + 2 + on, first + metres, way.unwrap_or("ahead of")))
        });
        let (n, metres, way) = found?;
        out.push(digits(metres, &sentence[i]));
        out.push(sentence[i + n - 1].clone());
        if let Some(unit) = out.last_mut() {
            unit.text = "m".into();
            unit.kind = TokenKind::Word;
        }
        out.extend(
            way.split(' ')
                .chain(["me"])
                .map(|w| super::wording::word(w, &sentence[i])),
        );
        Some(i + n)
    })
}

/// "the same distance behind me": as many metres as were named last.
pub(super) fn same_distance(sentence: &[Token], before: &[Token]) -> Vec<Token> {
    const SAME: &str = "the same distance|at the same distance|the very same distance|at an equal distance|an equal distance|just as far|equally far|as far again|the same number of metres|as many metres|that same distance";
    let mut out: Vec<Token> = Vec::new();
    let mut i = 0;
    while i < sentence.len() {
        let said: Vec<&Token> = before.iter().chain(out.iter()).collect();
        let metres = said
            .windows(2)
            .rev()
            .find(|w| number(w[0]).is_some() && is_unit(w[1]))
            .map(|w| [w[0].clone(), w[1].clone()]);
        let times = MULTIPLES
            .iter()
            .find_map(|(factor, list)| begins(&sentence[i..], list).map(|n| (n, *factor)));
        match (begins(&sentence[i..], SAME).map(|n| (n, 1.0)).or(times), metres) {
            (Some((n, factor)), Some(mut metres)) => {
                if let (TokenKind::Number(v), true) = (metres[0].kind.clone(), factor != 1.0) {
                    metres[0].kind = TokenKind::Number(v * factor);
                    metres[0].text = format!("{}", v * factor);
                }
                out.extend(metres);
                i += n;
                i += begins(&sentence[i..], "away from|from|away")
                    .filter(|_| ends(sentence.get(i + 1)))
                    .unwrap_or(0);
            }
            _ => {
                out.push(sentence[i].clone());
                i += 1;
            }
        }
    }
    out
}

/// "one bus and twice as many cars": two.
const TIMES: [(f64, &str); 4] = [
    (
        2.0,
        "twice as many|double as many|two times as many|twice the number of|double the number of",
    ),
    (
        3.0,
        "three times as many|thrice as many|three times the number of",
    ),
    (4.0, "four times as many"),
    (0.5, "half as many|half the number of"),
];

/// "three people on the left and just as many on the right": three.
pub(super) fn same_number(sentence: &[Token]) -> Vec<Token> {
    const AS_MANY: &str = "just as many|equally many|the same number|as many again|exactly as many|as many";
    let mut out: Vec<Token> = Vec::new();
    let mut i = 0;
    while i < sentence.len() {
        let n = begins(&sentence[i..], AS_MANY).filter(|n| {
            !sentence
                .get(i + n)
                .is_some_and(|t| matches!(t.text.as_str(), "as" | "of"))
        });
        let many = (0..out.len())
            .rev()
            .find(|k| number(&out[*k]).is_some() && !out.get(k + 1).is_some_and(is_unit))
            .and_then(|k| number(&out[k]));
        let times = TIMES
            .iter()
            .find_map(|(times, said)| begins(&sentence[i..], said).map(|n| (n, *times)));
        match (n.map(|n| (n, 1.0)).or(times), many) {
            (Some((n, times)), Some(many)) if (f64::from(many) * times).fract() == 0.0 => {
                let many = (f64::from(many) * times) as u32;
                out.push(digits(many, &sentence[i]));
                i += n;
            }
            _ => {
                out.push(sentence[i].clone());
                i += 1;
            }
        }
    }
    out
}
