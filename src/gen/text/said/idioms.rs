//! Turns of speech with a noun or a number in them, as the commands that they stand for: "of the cars, leave only two", "out
//! with the bikes, in with as many vans", "two cars are one too many".

use super::super::lexicon::{Sense, look_up};
use super::super::tokens::{Token, TokenKind};
use super::Talk;
use super::lists::{HELPERS, NEGATED};
use super::words::{find, first_noun, is, is_finite, leads, led, number, text, trimmed};

const WISHES: &[&str] = &[
    "there should be", "there must be", "there shall be", "let there be", "there are", "i want", "i would like", "id like",
    "i need", "we need", "we want", "put", "have", "make it", "make that", "use", "show", "give me", "id prefer", "let me have",
    "let it be", "add", "place", "id rather have", "park", "there ought to be", "there could be", "insert", "let us have",
];

/// The sentence in plain words, if it is one of them.
pub fn plain(tokens: &[Token], talk: &Talk<'_>) -> Option<Vec<Token>> {
    let tokens = trimmed(tokens);
    of_them(tokens, talk)
        .or_else(|| for_each(tokens))
        .or_else(|| all_except(tokens))
        .or_else(|| not_but(tokens))
        .or_else(|| instead_of_number(tokens))
        .or_else(|| out_and_in(tokens))
        .or_else(|| too_many(tokens))
        .or_else(|| besides(tokens))
        .or_else(|| let_it_be(tokens, talk))
}

fn goes(tokens: &[Token]) -> bool {
    tokens.iter().any(|t| {
        matches!(
            text(t),
            "go" | "goes" | "gone" | "leave" | "disappear" | "vanish" | "removed" | "deleted" | "away" | "out" | "off" | "erased"
        )
    })
}

fn removes(t: Option<&Token>) -> bool {
    is(t, &["remove", "delete", "erase", "take", "drop", "bin", "scrap", "cut", "lose", "clear", "discard"])
}

fn digits(n: usize, at: &Token) -> Token {
    Token {
        kind: TokenKind::Number(n as f64),
        text: n.to_string(),
        span: at.span,
    }
}

/// A noun phrase without article and number.
fn bare_np(np: &[Token]) -> Vec<Token> {
    let skip = |t: &Token| is(Some(t), &["the", "my", "these", "those", "all", "our", "of", "both"]) || number(t).is_some();
    let from = np.iter().position(|t| !skip(t)).unwrap_or(0);
    np[from..].to_vec()
}

/// "of the people on the right, leave only two".
fn of_them(tokens: &[Token], talk: &Talk<'_>) -> Option<Vec<Token>> {
    let n = leads(tokens, &["of", "out of", "among", "from among", "from", "as for", "as to"])?;
    if !is(tokens.get(n), &["the", "my", "these", "those", "all", "our"]) {
        return None;
    }
    let comma = tokens.iter().position(|t| t.kind == TokenKind::Comma)?;
    let np = tokens.get(n..comma).filter(|np| first_noun(np).is_some())?;
    let rest = trimmed(&tokens[comma + 1..]);
    if first_noun(rest).is_some() {
        return None;
    }
    let k = rest.iter().position(|t| number(t).is_some()).filter(|k| *k < 4)?;
    let many = number(&rest[k])?.max(0) as usize;
    let keeps = is(rest.first(), &["leave", "keep", "retain", "spare", "preserve", "only", "just"])
        || rest[k + 1..].iter().any(|t| matches!(text(t), "stay" | "stays" | "remain" | "remains" | "left" | "enough" | "suffice"));
    let kept = if keeps {
        many
    } else if removes(rest.first()) || goes(&rest[k + 1..]) {
        talk.fits(np).checked_sub(many)?
    } else {
        return None;
    };
    Some(led("keep exactly", &tokens[0], &[&[digits(kept, &rest[k])], &bare_np(np)]))
}

/// "for each of the cones, put a barrier in its place".
fn for_each(tokens: &[Token]) -> Option<Vec<Token>> {
    let there = leads(tokens, &["in place of each of the", "instead of each of the", "in place of every", "instead of every", "in place of each", "instead of each", "in place of all the", "instead of all the", "where each of the"]);
    let n = there.or_else(|| leads(tokens, &["for each of the", "for each of these", "for every one of the", "for each", "for every"]))?;
    let (a, end) = first_noun(&tokens[n..]).map(|x| (n + x.0, n + x.1))?;
    let rest = trimmed(tokens.get(end..)?);
    let fresh = rest.iter().take(5).position(|t| matches!(text(t), "a" | "an" | "one"))?;
    let noun = first_noun(&rest[fresh..])?;
    let placed = find(rest, &["in its place", "in their place", "instead", "in its stead", "where it stands", "where it is", "in that place", "there"]).is_some();
    if a > n + 3 || !(placed || there.is_some()) {
        return None;
    }
    let all = if is(tokens.get(n.saturating_sub(1)), &["the", "these"]) { "replace all the" } else { "replace every" };
    let with = led("with", &tokens[0], &[&rest[fresh..fresh + noun.1]]);
    Some(led(all, &tokens[0], &[&tokens[n..end], &with]))
}

/// "the cones can go, all except two", "remove the cones but for one".
fn all_except(tokens: &[Token]) -> Option<Vec<Token>> {
    let (i, n) = find(
        tokens,
        &[
            "all except for", "all except", "all but", "all bar", "all save", "except for", "except", "but for", "apart from",
            "save for", "but", "bar", "save", "with the exception of", "all of them except", "all of them but", "other than",
            "every one of them but",
        ],
    )?;
    let k = i + n;
    let many = number(tokens.get(k)?)?;
    let end = &tokens[k + 1..];
    let ends = end.is_empty() || leads(end, &["of them", "of those", "of these", "please"]).is_some_and(|m| m == end.len());
    let before = trimmed(&tokens[..i]);
    let (a, b) = first_noun(before).filter(|x| x.0 < 5)?;
    let verb = before[b..]
        .iter()
        .position(|t| HELPERS.contains(&text(t)) || is_finite(text(t), true))
        .map_or(before.len(), |v| b + v);
    let gone = goes(&before[b..]) || removes(before.first()) || leads(before, &["get rid of", "do away with"]).is_some();
    if !ends || !gone || many < 0 {
        return None;
    }
    let np = if removes(before.first()) { &before[a..] } else { &before[a..verb.max(b)] };
    Some(led("keep exactly", &tokens[0], &[&tokens[k..=k], np]))
}

/// "what waits there shouldn't be a car but a bus": what it shall be.
fn not_but(tokens: &[Token]) -> Option<Vec<Token>> {
    let but = (3..tokens.len()).find(|k| is(tokens.get(*k), &["but"]) && is(tokens.get(k + 1), &["a", "an", "two", "three"]))?;
    let not = (0..but).rev().find(|k| NEGATED.contains(&text(&tokens[*k])))?;
    let old = first_noun(&tokens[not..but])?;
    let article = tokens[not..not + old.0].iter().any(|t| matches!(text(t), "a" | "an"));
    if old.0 > 4 || not + old.1 != but || !article {
        return None;
    }
    let mut from = not;
    while from > 0 && HELPERS.contains(&text(&tokens[from - 1])) {
        from -= 1;
    }
    let subject = trimmed(&tokens[..from]);
    if subject.is_empty() {
        return None;
    }
    let old = &tokens[not + old.0..not + old.1];
    let what = leads(subject, &["what is", "whats", "whatever is", "what", "the thing that is", "the thing", "the one that is"]);
    let who = match what {
        Some(n) => led("the", &tokens[0], &[old, &subject[n..]]),
        None => subject.to_vec(),
    };
    Some([&who[..], &led("should be", &tokens[but], &[&tokens[but + 1..]])].concat())
}

/// "instead of just the one motorcycle there should be three".
fn instead_of_number(tokens: &[Token]) -> Option<Vec<Token>> {
    let n = leads(tokens, &["instead of", "rather than", "in place of"])?;
    let (a, b) = first_noun(&tokens[n..]).map(|x| (n + x.0, n + x.1))?;
    let counted = tokens[n..a].iter().any(|t| number(t).is_some());
    let rest = trimmed(&tokens[b..]);
    let w = leads(rest, WISHES)?;
    let k = w + usize::from(is(rest.get(w), &["just", "only"]));
    let many = rest.get(k).filter(|t| number(t).is_some())?;
    let ends = rest.len() == k + 1 || leads(&rest[k + 1..], &["of them", "please", "instead", "of those"]).is_some();
    (counted && ends && a < n + 5).then(|| led("keep exactly", &tokens[0], &[std::slice::from_ref(many), &tokens[a..b]]))
}

/// "out with the bikes, in with as many vans".
fn out_and_in(tokens: &[Token]) -> Option<Vec<Token>> {
    let n = leads(tokens, &["out with", "away with", "off with", "down with", "enough of", "no more", "lose", "out go", "out goes"])?;
    let (i, m) = find(tokens, &["in with", "on with", "up with", "bring in", "in come", "in comes", "in go", "in goes", "hello to"])?;
    let old = trimmed(tokens.get(n..i)?);
    let mut new = trimmed(&tokens[i + m..]);
    let as_many = leads(new, &["just as many", "as many", "equally many", "the same number of", "an equal number of", "exactly as many", "some", "the"]);
    new = &new[as_many.unwrap_or(0)..];
    let (old_noun, new_noun) = (first_noun(old)?, first_noun(new)?);
    let one = old.iter().take(old_noun.0).any(|t| matches!(text(t), "the" | "that" | "this" | "my"))
        && !matches!(look_up(text(&old[old_noun.1 - 1])), Some(Sense::Noun(_, true)));
    let lead = if one { "replace the" } else { "replace all the" };
    let with = led("with", &tokens[0], &[&new[..new_noun.1.max(1)]]);
    Some(led(lead, &tokens[0], &[&bare_np(old), &with]))
}

/// "two cyclists are one too many, so take one away".
fn too_many(tokens: &[Token]) -> Option<Vec<Token>> {
    let (i, n) = find(tokens, &["too many", "too much"])?;
    let be = (1..i).rev().find(|k| is(tokens.get(*k), &["is", "are"]))?;
    let many = tokens.get(be + 1).filter(|t| number(t).is_some() && be + 2 == i)?;
    let (a, b) = first_noun(&tokens[..be]).filter(|x| x.0 < 4)?;
    let rest = trimmed(tokens.get(i + n..)?);
    let takes = rest.is_empty() || removes(rest.first()) || leads(rest, &["get rid", "one", "so"]).is_some();
    takes.then(|| led("remove", &tokens[0], &[std::slice::from_ref(many), &tokens[a..b.max(a + 1)], &tokens[b..be]]))
}

/// "in addition to the cars that are coming I want four more".
fn besides(tokens: &[Token]) -> Option<Vec<Token>> {
    let n = leads(tokens, &["in addition to", "besides", "apart from", "on top of", "as well as", "along with", "beside", "aside from", "next to having"])?;
    let (w, m) = find(tokens, WISHES).filter(|w| w.0 > n)?;
    let (a, b) = first_noun(&tokens[n..w]).map(|x| (n + x.0, n + x.1))?;
    let rest = trimmed(&tokens[w + m..]);
    let k = rest.iter().position(|t| number(t).is_some() || is(Some(t), &["another", "a", "an"])).filter(|k| *k < 2)?;
    let more = is(rest.get(k + 1), &["more", "others", "additional", "extra", "further"]);
    let own = first_noun(&rest[k..]).is_some_and(|x| x.0 < 4);
    if is(tokens.get(n), &["me", "us"]) || a > n + 4 {
        return None;
    }
    let tail = trimmed(&rest[k + 1 + usize::from(more)..]);
    let noun: &[Token] = if own { &[] } else { &tokens[a..b] };
    Some(led("add", &tokens[0], &[&rest[k..=k], noun, tail]))
}

/// "let it be three motorbikes coming towards me".
fn let_it_be(tokens: &[Token], talk: &Talk<'_>) -> Option<Vec<Token>> {
    let n = leads(tokens, &["let it be", "let that be", "let there be", "let those be", "let them be"])?;
    let rest = &tokens[n..];
    let counted = number(rest.first()?).is_some() || is(rest.first(), &["a", "an", "some"]);
    let (a, b) = first_noun(rest).filter(|x| x.0 < 4)?;
    (counted && talk.fits(&rest[a..b]) == 0).then(|| led("add", &tokens[0], &[rest]))
}
