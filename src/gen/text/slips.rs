//! Slips of the tongue that a text puts right itself: "twenty metres behind us, ah no, fifteen", "two cars, sorry, three cars",
//! "forget the bus ... hm, no, keep it".

use super::ellipsis::number;
use super::lexicon::{Sense, look_up};
use super::rephrase::is_verb;
use super::tokens::{Token, TokenKind};
use super::wording::{begins, rewritten, word};

/// What only marks a pause.
const PAUSE: &str = "ah|oh|uh|um|er|erm|eh|hm|hmm|hmmm|well|oops|whoops";
/// What takes back what was said last.
const BACK: &str = "no|nope|wait|sorry|no wait|wait no|no sorry|sorry no|i mean|i meant|scratch that|strike that|\
    correction|pardon|pardon me|excuse me|or rather|or better|better|actually|actually no|no actually|\
    no better|no i mean|no i meant|on second thought|on second thoughts|no rather|sorry i mean|sorry i meant|\
    let me correct that|let me correct myself|i take that back|no lets say|no let us say|lets rather say|or no";
const KEPT: &str = "keep it|keep them|keep him|keep her|leave it|leave them|leave him|leave her|leave it in|leave them in|leave it there|\
    leave them there|let it stay|let them stay|let him stay|let her stay|it stays|they stay|he stays|she stays|it can stay|they can stay|\
    it may stay|they may stay|it should stay|they should stay|keep it in|keep them in|leave it be|leave it alone|dont|do not|keep that|\
    keep it there|keep them there|keep it after all|let it be|leave it where it is|keep it where it is";
/// What may follow the number that is right.
const BETTER: &str = "is better|would be better|might be better|is nicer|is right|would be right|is enough|will do|would do|is more like it|please";
const REMOVES: &str = "remove|delete|erase|take out|take away|take|forget|forget about|lose|drop|scrap|clear|bin|cancel|kill|discard|get rid of|\
    do away with|leave out|ditch|away with|out with";

fn is_gap(t: Option<&Token>) -> bool {
    t.is_some_and(|t| matches!(t.kind, TokenKind::Comma | TokenKind::Stop | TokenKind::Mark))
}

fn is_unit(t: &Token) -> bool {
    matches!(look_up(&t.text), Some(Sense::Unit(_)))
}

/// A text in which what was put right is said but once.
pub(super) fn put_right(tokens: Vec<Token>) -> Vec<Token> {
    let out = rewritten(&tokens, |i, out| said_anew(&tokens, i, out));
    rewritten(&out.clone(), |i, to| kept_after_all(&out, i, to))
}

/// One past the words from here that take something back, with the marks about them, and whether they do more than pause.
fn taken_back(tokens: &[Token], from: usize) -> Option<(usize, bool)> {
    let mut i = from;
    let (mut back, mut paused) = (false, false);
    loop {
        if is_gap(tokens.get(i)) {
            i += 1;
        } else if let Some(n) = tokens.get(i..).and_then(|t| begins(t, BACK)) {
            back = true;
            i += n;
        } else if let Some(n) = tokens.get(i..).and_then(|t| begins(t, "make it|make that"))
            && (back || paused)
        {
            // (alone it says how many there are to be now: "there are four, make it five")
            back = true;
            i += n;
        } else if let Some(n) = tokens.get(i..).and_then(|t| begins(t, PAUSE)) {
            paused = true;
            i += n;
        } else {
            return ((back || paused) && i < tokens.len()).then_some((i, back));
        }
    }
}

/// "twenty metres behind us, ah no, fifteen": fifteen metres behind us.
fn said_anew(tokens: &[Token], i: usize, out: &mut [Token]) -> Option<usize> {
    if i == 0 || !is_gap(tokens.get(i)) {
        return None;
    }
    let (at, back) = taken_back(tokens, i)?;
    // ("at fifteen", "to fifteen", "only three")
    let at = at
        + begins(
            &tokens[at..],
            "at|to|only|just|rather|about|its|it is|it should be",
        )
        .unwrap_or(0);
    let new = tokens.get(at).filter(|t| number(t).is_some() && t.text != "a")?;
    let end = (at + 1..tokens.len())
        .find(|k| is_gap(tokens.get(*k)) || tokens[*k].text == "and")
        .unwrap_or(tokens.len());
    let late = &tokens[at + 1..end];
    let better = (0..late.len()).find(|k| begins(&late[*k..], BETTER) == Some(late.len() - k));
    let late = &late[..better.unwrap_or(late.len())];
    (back || better.is_some()).then_some(())?;
    let from = out
        .iter()
        .rposition(|t| t.kind == TokenKind::Stop)
        .map_or(0, |k| k + 1);
    // of several numbers the one that counts the same
    let same = |k: &usize| match (late.first(), out.get(k + 1)) {
        (Some(a), Some(b)) => a.text == b.text || is_unit(a) && is_unit(b),
        (Some(_), None) => false,
        (None, _) => true,
    };
    let old = (from..out.len())
        .rev()
        .filter(|k| number(&out[*k]).is_some() && !matches!(out[*k].text.as_str(), "a" | "one"))
        .find(same)?;
    // nothing else is new
    let told = late
        .iter()
        .all(|t| is_unit(t) || out[old..].iter().any(|o| o.text == t.text));
    if !told || out.len() - old > 10 {
        return None;
    }
    out[old] = new.clone();
    Some(end)
}

/// "forget the bus ... hm, no, keep it": the bus is left as it is.
fn kept_after_all(tokens: &[Token], i: usize, out: &mut Vec<Token>) -> Option<usize> {
    if i == 0 || !is_gap(tokens.get(i)) {
        return None;
    }
    let (at, _) = taken_back(tokens, i).filter(|x| x.1)?;
    let n = begins(&tokens[at..], KEPT)?;
    let end = at + n;
    is_gap(tokens.get(end))
        .then_some(())
        .or((end == tokens.len()).then_some(()))?;
    let from = out
        .iter()
        .rposition(|t| t.kind == TokenKind::Stop || matches!(t.text.as_str(), "and" | "then"))
        .map_or(0, |k| k + 1);
    let from = from + begins(&out[from..], "please|ok|okay|then|now|just").unwrap_or(0);
    let verb = begins(&out[from..], REMOVES)?;
    let named = out.get(from + verb).is_some_and(|t| {
        matches!(
            t.text.as_str(),
            "the" | "that" | "both" | "all" | "my" | "our" | "those" | "these"
        )
    });
    if !named || out[from + verb..].iter().any(is_verb) {
        return None;
    }
    if matches!(out.last()?.text.as_str(), "out" | "away" | "off") {
        out.pop();
    }
    let at = out[from].clone();
    out.splice(from..from + verb, [word("leave", &at)]);
    out.extend(["as", "it", "is"].map(|w| word(w, &at)));
    // what follows is a command of its own
    let next = (end..tokens.len()).find(|k| {
        !(is_gap(tokens.get(*k))
            || matches!(tokens[*k].text.as_str(), "and" | "but" | "just" | "only" | "then"))
    });
    if let Some(next) = next {
        out.push(Token {
            kind: TokenKind::Stop,
            ..word(".", &at)
        });
        return Some(next);
    }
    Some(tokens.len())
}

#[cfg(test)]
mod tests {
    use super::super::tokens::tokens;
    use super::*;

    #[test]
    fn slips_are_put_right() {
        let said = |t: &str| {
            let list: Vec<String> = put_right(tokens(t)).into_iter().map(|t| t.text).collect();
            list.join(" ")
        };
        assert_eq!(
            said("taxi twenty metres behind us, ah no, fifteen"),
            "taxi fifteen metres behind us"
        );
        assert_eq!(
            said("Two cars 20 m ahead, sorry, three cars."),
            "three cars 20 m ahead ."
        );
        assert_eq!(said("A bus 20 m ahead. No wait, 25 m."), "a bus 25 m ahead .");
        assert_eq!(
            said("there are four cars, make it five"),
            "there are four cars , make it five"
        );
        assert_eq!(said("four cars, er, make it five"), "five cars");
        assert_eq!(said("moped 30 m ahead, hm, 25 is better"), "moped 25 m ahead");
        assert_eq!(
            said("two cars ahead, no three trucks"),
            "two cars ahead , no three trucks"
        );
        assert_eq!(
            said("forget the bus... hm, no, keep it, just delete the car"),
            "leave the bus as it is . delete the car"
        );
    }
}
