//! Briefs of which one sentence only makes sense with the next, or none of whose parts stands alone.

use super::super::tokens::{Token, TokenKind};
use super::super::wording::rewritten;
use super::lists::HELPERS;
use super::words::{first_noun, is, is_place, is_unit, leads, led, number, text};

pub(super) const TOO: &[&str] = &[
    "closer than that",
    "nearer than that",
    "farther than that",
    "further away than that",
    "farther away than that",
    "further than that",
    "not that far",
    "not so far",
    "not that close",
    "not so close",
    "too far",
    "too far away",
    "too far off",
    "too far out",
    "too far ahead",
    "too far back",
    "too far behind",
    "too close",
    "too near",
    "much too close",
    "much too far",
    "far too close",
    "way too close",
    "way too far",
    "a bit too close",
    "a bit too far",
    "a little too close",
    "a little too far",
];

const GONE: &[&str] = &[
    "are gone",
    "have gone",
    "have left",
    "are away",
    "have disappeared",
    "have vanished",
    "are no longer there",
    "are not there any more",
    "are not there anymore",
    "arent there any more",
    "have been removed",
    "have been cleared away",
    "have been taken away",
    "should go",
    "must go",
    "have to go",
    "can go",
    "should be gone",
    "should disappear",
    "should vanish",
    "need to go",
];

/// "the car on the shoulder and the cones are gone": both go.
pub(super) fn both_gone(tokens: Vec<Token>) -> Vec<Token> {
    let Some((k, _)) = (2..tokens.len()).find_map(|k| {
        leads(&tokens[k..], GONE)
            .filter(|n| k + n == tokens.len())
            .map(|n| (k, n))
    }) else {
        return tokens;
    };
    let from = leads(&tokens, &["so", "and", "then", "now"]).unwrap_or(0);
    let who = &tokens[from..k];
    let parts: Vec<&[Token]> = who.split(|t| is(Some(t), &["and"])).collect();
    let [a, b] = parts.as_slice() else {
        return tokens;
    };
    let known = |p: &[Token]| {
        is(p.first(), &["the", "both", "all", "that", "those"])
            && first_noun(p).is_some_and(|x| x.0 < 4 && (x.1 == p.len() || is_place(&p[x.1..])))
            && p.iter()
                .all(|t| t.kind == TokenKind::Word && !HELPERS.contains(&text(t)))
    };
    // (without a place that is read as it stands)
    let placed = |p: &[Token]| first_noun(p).is_some_and(|x| x.1 < p.len());
    if !(known(a) && known(b) && (placed(a) || placed(b))) {
        return tokens;
    }
    led("remove", &tokens[0], &[a, &led("and remove", &b[0], &[b])])
}

/// Sentences of which one only makes sense with the next, or none of whose parts stands alone: before they are parted.
pub fn whole(tokens: Vec<Token>) -> Vec<Token> {
    let mut tokens = super::halves::joined(tokens);
    // "the red car is too far out; 10 m in front of me would do"
    for i in 3..tokens.len().saturating_sub(2) {
        let complaint = tokens[i].kind == TokenKind::Stop
            && TOO.iter().any(|t| {
                let n = t.split(' ').count();
                i >= n && leads(&tokens[i - n..i], &[t]).is_some()
            });
        // "bring the red car nearer; 8 metres in front of us will do"
        let closer = tokens[i].kind == TokenKind::Stop
            && is(
                tokens.get(i - 1),
                &["nearer", "closer", "back", "forward", "away"],
            );
        let order = closer
            .then(|| {
                tokens[..i]
                    .iter()
                    .rposition(|t| t.kind == TokenKind::Stop)
                    .map_or(0, |k| k + 1)
            })
            .filter(|from| {
                let end = tokens[i + 1..]
                    .iter()
                    .position(|t| t.kind == TokenKind::Stop)
                    .map_or(tokens.len(), |k| i + 1 + k);
                let please = usize::from(is(tokens.get(*from), &["please"]));
                from + please + 1 < i
                    && super::super::rephrase::is_verb(&tokens[from + please])
                    && number(&tokens[i + 1]).is_some()
                    && is_unit(tokens.get(i + 2))
                    && tokens[i + 1..end].iter().any(|t| {
                        is(
                            Some(t),
                            &["do", "enough", "fine", "ok", "good", "perfect", "suffice"],
                        )
                    })
            });
        if let Some(from) = order {
            let please = usize::from(is(tokens.get(from), &["please"]));
            let np = tokens[from + please + 1..i - 1].to_vec();
            let end = (i + 1..tokens.len())
                .find(|k| is(tokens.get(*k), &["will", "would", "is", "should", "ought"]))
                .unwrap_or(tokens.len());
            let stop = (i + 1..tokens.len())
                .find(|k| tokens[*k].kind == TokenKind::Stop)
                .unwrap_or(tokens.len());
            let place = tokens[i + 1..end.min(stop)].to_vec();
            let away = if place.len() == 2 {
                led("away", &place[0], &[])
            } else {
                Vec::new()
            };
            let new = [&np[..], &led("should be", &tokens[i], &[&place, &away])].concat();
            tokens.splice(from..stop, new);
            break;
        }
        if complaint && number(&tokens[i + 1]).is_some() && is_unit(tokens.get(i + 2)) {
            tokens[i].kind = TokenKind::Comma;
        }
    }
    // "onlookers! Four of them, on the left sidewalk"
    tokens = rewritten(&tokens, |i, out| {
        let alone = i == 1 || i > 1 && tokens[i - 2].kind == TokenKind::Stop;
        let noun = i > 0
            && alone
            && tokens[i].kind == TokenKind::Stop
            && super::words::noun_at(&tokens[i - 1..i]).is_some();
        let of_them = tokens.get(i + 1).is_some_and(|t| number(t).is_some())
            && leads(tokens.get(i + 2..)?, &["of them"]).is_some();
        if !(noun && of_them) {
            return None;
        }
        let name = out.pop()?;
        out.extend(led("add", &name, &[&tokens[i + 1..i + 2]]));
        out.push(name);
        // (the comma after it)
        Some(i + 4 + usize::from(tokens.get(i + 4).is_some_and(|t| t.kind == TokenKind::Comma)))
    });
    let mut out = Vec::with_capacity(tokens.len());
    for sentence in tokens.split_inclusive(|t| t.kind == TokenKind::Stop) {
        let (body, stop) = match sentence.split_last() {
            Some((last, body)) if last.kind == TokenKind::Stop => (body, std::slice::from_ref(last)),
            _ => (sentence, &[][..]),
        };
        let mut clause = 0;
        // "the breakdown is cleared, so the car on the shoulder and the cones are gone"
        for k in 1..body.len() {
            if body[k - 1].kind == TokenKind::Comma && is(body.get(k), &["so", "and"]) {
                clause = k;
            }
        }
        out.extend_from_slice(&body[..clause]);
        out.extend(both_gone(body[clause..].to_vec()));
        out.extend_from_slice(stop);
    }
    out
}
