//! What a command says after its object: "two taxis, both parked on the left", "with a bus each", ", but on the other side".

use super::super::lexicon::plural;
use super::super::rephrase::is_verb;
use super::super::tokens::{Token, TokenKind};
use super::super::wording::rewritten;
use super::words::{first_noun, is, is_finite, is_place, led, number, text, word};

/// A sentence with such tails in plain words.
pub fn plain(tokens: Vec<Token>) -> Vec<Token> {
    let out = both_placed(tokens);
    but_there(&one_each(&out))
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
        let says = |t: &Token| is_verb(t) && !is_place(std::slice::from_ref(t)) || is_finite(text(t), false);
        let bare = but && is(rest.first(), &["on", "in", "at", "behind", "beside"]) && is_place(rest);
        (bare && out.first().is_some_and(is_verb) && !rest.iter().any(says)).then_some(i + 2)
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
