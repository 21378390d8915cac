//! What a command says after its object: "two taxis, both parked on the left", "with a bus each", ", but on the other side".

use super::super::lexicon::plural;
use super::super::rephrase::is_verb;
use super::super::tokens::{Token, TokenKind};
use super::super::wording::{replaced, rewritten};
use super::words::{find, first_noun, is, is_finite, is_place, leads, led, number, text, trimmed, word};

/// A sentence with such tails in plain words.
pub fn plain(tokens: Vec<Token>) -> Vec<Token> {
    let tokens = replaced(&tokens, "sketch in|draw in|pencil in|paint in", "add");
    let out = both_placed(out_of_here(without_purpose(tokens)));
    but_there(&one_each(&out))
}

/// "clear out the bus so that only the car is left", "waiting to let her pass": what it is good for says nothing more.
fn without_purpose(tokens: Vec<Token>) -> Vec<Token> {
    const LEFT: &[&str] = &["left", "remains", "remain", "there", "stays", "stay", "visible"];
    const REMOVES: &[&str] = &[
        "remove", "delete", "clear", "take", "erase", "get", "drop", "throw", "lose", "kick",
    ];
    let only = find(
        &tokens,
        &[
            "so that only",
            "so only",
            "such that only",
            "until only",
            "so that just",
        ],
    )
    .filter(|x| x.0 > 2 && is(tokens.first(), REMOVES))
    .filter(|x| {
        let rest = &tokens[x.0 + x.1..];
        // ("until only two are left" says how many)
        let known = is(rest.first(), &["the", "my", "our"]);
        known && is(rest.last(), LEFT) && first_noun(rest).is_some_and(|n| n.0 < 4)
    });
    if let Some((i, _)) = only {
        return trimmed(&tokens[..i]).to_vec();
    }
    let lets = find(
        &tokens,
        &["to let", "in order to let", "so as to let", "to allow"],
    )
    .filter(|x| {
        let rest = &tokens[x.0 + x.1..];
        x.0 > 2
            && rest.len() < 7
            && is(
                rest.last(),
                &[
                    "pass", "by", "through", "past", "cross", "over", "across", "go", "in", "out",
                ],
            )
    });
    match lets {
        Some((i, _)) => trimmed(&tokens[..i]).to_vec(),
        None => tokens,
    }
}

/// "get the taxi out of here": remove it.
fn out_of_here(tokens: Vec<Token>) -> Vec<Token> {
    const AWAY: &[&str] = &[
        "out of here",
        "out of there",
        "out of the scene",
        "out of the picture",
        "out of the frame",
        "out of sight",
        "out of my sight",
        "out of this",
        "out of service",
        "off the site",
        "off the set",
        "off the scene",
        "off the map",
    ];
    rewritten(&tokens, |i, out| {
        let opens = i == 0
            || tokens[i - 1].kind != TokenKind::Word
            || is(tokens.get(i - 1), &["and", "then", "please", "now"]);
        let np = (opens
            && is(
                tokens.get(i),
                &["get", "take", "drag", "pull", "move", "bring", "throw", "kick"],
            ))
        .then(|| first_noun(&tokens[i + 1..]))?
        .filter(|n| n.0 < 5)?;
        let end = i + 1 + np.1;
        let n = leads(&tokens[end..], AWAY)?;
        out.extend(led("remove", &tokens[i], &[&tokens[i + 1..end]]));
        Some(end + n)
    })
}

/// "replace the car and the truck with a bus each": with buses.
fn one_each(tokens: &[Token]) -> Vec<Token> {
    rewritten(tokens, |i, out| {
        let one = is(tokens.get(i), &["a", "an", "one"])
            && is(out.last(), &["with", "by", "into", "for"])
            && out.iter().any(|t| is(Some(t), &["and", "both", "two", "three"]));
        let (a, b) = one.then(|| first_noun(&tokens[i..]))?.filter(|n| n.0 == 1)?;
        if !is(tokens.get(i + b), &["each", "apiece"]) {
            return None;
        }
        out.extend(tokens[i + a..i + b - 1].iter().cloned());
        let last = &tokens[i + b - 1];
        out.push(word(&plural(text(last)), last));
        Some(i + b + 1)
    })
}

/// "make it two taxis, both parked on the left": make it two, and both are there.
fn both_placed(tokens: Vec<Token>) -> Vec<Token> {
    let made = is(tokens.first(), &["make"])
        && is(tokens.get(1), &["it", "that", "them"])
        && tokens.get(2).is_some_and(|t| number(t).is_some());
    let Some((a, b)) = first_noun(&tokens).filter(|n| made && n.0 < 6) else {
        return tokens;
    };
    let mut from = b;
    if tokens.get(from).is_some_and(|t| t.kind == TokenKind::Comma) {
        from += 1;
    }
    let all = usize::from(is(tokens.get(from), &["both", "all", "each"]));
    let of = if is(tokens.get(from + all), &["of"]) { 2 } else { 0 };
    let rest = &tokens[(from + all + of).min(tokens.len())..];
    let parked = usize::from(is(
        rest.first(),
        &["parked", "standing", "waiting", "walking", "driving"],
    ));
    if from == b || all == 0 || !is_place(rest.get(parked..).unwrap_or(&[])) {
        return tokens;
    }
    let mut out = tokens[..b].to_vec();
    out.extend(led("and all the", &tokens[b], &[&tokens[a..b]]));
    out.extend(led("should be", &tokens[b], &[rest]));
    out
}

/// "add two more, but on the left side": on the left side.
fn but_there(tokens: &[Token]) -> Vec<Token> {
    rewritten(tokens, |i, out| {
        let but = tokens[i].kind == TokenKind::Comma && is(tokens.get(i + 1), &["but", "only", "though"]);
        let rest = tokens.get(i + 2..)?;
        let end = rest
            .iter()
            .position(|t| is(Some(t), &["and"]) || t.kind == TokenKind::Comma);
        let rest = &rest[..end.unwrap_or(rest.len())];
        let says = |t: &Token| is_verb(t) && !is_place(std::slice::from_ref(t)) || is_finite(text(t), false);
        let bare = but && is(rest.first(), &["on", "in", "at", "behind", "beside"]) && is_place(rest);
        let adds =
            |t: &Token| is_verb(t) || super::words::number(t).is_some() || is(Some(t), &["another", "more"]);
        (bare && out.first().is_some_and(adds) && !rest.iter().any(says)).then_some(i + 2)
    })
}

#[cfg(test)]
mod tests {
    use super::super::super::tokens::tokens;
    use super::*;

    #[test]
    fn tails() {
        let said = |t: &str| {
            let list: Vec<String> = plain(tokens(t)).into_iter().map(|t| t.text).collect();
            list.join(" ")
        };
        assert_eq!(
            said("replace the car and the truck with a bus each"),
            "replace the car and the truck with buses"
        );
        assert_eq!(
            said("make it two taxis, both parked on the left"),
            "make it two taxis and all the taxis should be parked on the left"
        );
        assert_eq!(
            said("add two more cars, but on the left side of the road"),
            "add two more cars on the left side of the road"
        );
        assert_eq!(
            said("remove the cars, but on the left keep one"),
            "remove the cars , but on the left keep one"
        );
    }
}
