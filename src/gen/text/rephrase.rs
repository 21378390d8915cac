//! Edits said as statements, turned into commands before they are read: "the bus should go" is "remove the bus", "the taxi
//! ought to be a van" is "make the taxi a van", "one pedestrian less" is "keep the pedestrians", with one fewer.

use super::amounts::{arithmetic, counted};
use super::exchange::exchanged;
use super::existence::{nobody, sent_off, there};
use super::foremost::{POLITE, name_people, take_and_put, take_ordinals, topic};
use super::lexicon::{Sense, look_up};
use super::tokens::{Token, TokenKind};
use super::wishes::{SPEAKER, stated, wished};
use super::words::edits::VERBS;

/// How a number changes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Change {
    /// So many times as many.
    Times(f64),
    /// So many more, or fewer.
    Plus(i64),
}

/// A text after rephrasing: its tokens, the number change of a sentence (by its first token), ordinals taken out.
#[derive(Clone, Debug, Default)]
pub struct Rephrased {
    /// Tokens as commands.
    pub tokens: Vec<Token>,
    /// Start of a sentence in bytes, and its change of number.
    pub changes: Vec<(usize, Change)>,
    /// Byte where an ordinal stood ("the second truck"), and its number from 1; 0 is the last.
    pub ordinals: Vec<(usize, usize)>,
}

const UNWISH: &[&[&str]] = &[
    &["i", "dont", "want"],
    &["i", "do", "not", "want"],
    &["we", "dont", "need"],
    &["i", "dont", "need"],
    &["we", "dont", "want"],
    &["dont", "show"],
    &["do", "not", "show"],
    &["do", "away", "with"],
    &["no", "more"],
    &["enough", "of"],
    &["away", "with"],
    &["off", "with"],
    &["out", "with"],
    &["make", "do", "without"],
];

pub fn starts_with(tokens: &[Token], words: &[&str]) -> bool {
    tokens.len() >= words.len() && tokens.iter().zip(words).all(|(t, w)| t.text == *w)
}

pub fn strip<'a>(mut tokens: &'a [Token], lists: &[&[&str]]) -> &'a [Token] {
    'again: loop {
        for words in lists {
            if tokens.len() > words.len() && starts_with(tokens, words) {
                tokens = &tokens[words.len()..];
                continue 'again;
            }
        }
        return tokens;
    }
}

pub fn sense(t: &Token) -> Option<Sense> {
    look_up(&t.text)
}

pub fn number(t: &Token) -> Option<i64> {
    match (&t.kind, sense(t)) {
        (TokenKind::Number(v), _) if v.is_finite() && (0.0..1000.0).contains(v) => Some(v.round() as i64),
        (_, Some(Sense::Count(c))) if c.is_exact() => Some(i64::from(c.n)),
        _ => None,
    }
}

pub fn is_noun(t: &Token) -> bool {
    matches!(sense(t), Some(Sense::Noun(..)))
}

pub(super) fn is_verb(t: &Token) -> bool {
    VERBS.iter().any(|(_, list)| {
        list.split('|')
            .any(|w| w.split(' ').next() == Some(t.text.as_str()))
    })
}

pub fn is_place_word(t: &Token) -> bool {
    matches!(
        sense(t),
        Some(Sense::Rel(_) | Sense::EgoRel(_) | Sense::In | Sense::At | Sense::Across)
    )
}

pub fn word(text: &str, at: &Token) -> Token {
    Token {
        kind: TokenKind::Word,
        text: text.to_string(),
        span: at.span,
    }
}

pub fn with_verb(verb: &str, at: &Token, rest: &[Token]) -> Vec<Token> {
    let mut out: Vec<Token> = verb.split(' ').map(|w| word(w, at)).collect();
    out.extend_from_slice(rest);
    out
}

/// Rewrites a text sentence by sentence.
pub fn rephrase(tokens: &[Token]) -> Rephrased {
    let mut out = Rephrased::default();
    for sentence in tokens.split_inclusive(|t| t.kind == TokenKind::Stop) {
        let (body, stop) = match sentence.split_last() {
            Some((last, body)) if last.kind == TokenKind::Stop => (body, Some(last)),
            _ => (sentence, None),
        };
        let put_back = topic(body);
        let body = put_back.as_deref().unwrap_or(body);
        let body = take_ordinals(&take_and_put(&name_people(body)), &mut out);
        // "one car fewer, and add a cyclist"
        let cut = (1..body.len()).find(|i| {
            matches!(body[i - 1].text.as_str(), "fewer" | "less")
                && (body[*i].kind == TokenKind::Comma || body[*i].text == "and")
        });
        let parts = match cut {
            Some(i) => vec![&body[..i], strip(&body[i + 1..], &[&["and"], &["then"]])],
            None => vec![&body[..]],
        };
        for (k, body) in parts.into_iter().enumerate() {
            let Some(first) = body.first() else {
                continue;
            };
            if k > 0 {
                out.tokens.push(Token {
                    kind: TokenKind::Stop,
                    ..word(".", first)
                });
            }
            let (new, change) = one(body);
            if let Some(change) = change {
                out.changes
                    .push((new.first().map_or(first.span.start, |t| t.span.start), change));
            }
            out.tokens.extend(new);
        }
        out.tokens.extend(stop.cloned());
    }
    out
}

/// A clause as a command, and how a number changes by it; `None` if it is one already or none of these.
fn restate(clause: &[Token]) -> Option<(Vec<Token>, Option<Change>)> {
    counted(clause).or_else(|| {
        let found = nobody(clause)
            .or_else(|| exchanged(clause))
            .or_else(|| sent_off(clause))
            .or_else(|| there(clause))?;
        Some((found, None))
    })
}

fn one(body: &[Token]) -> (Vec<Token>, Option<Change>) {
    let mut rest = strip(body, POLITE);
    while let Some((last, before)) = rest.split_last()
        && before.len() > 1
        && (last.kind == TokenKind::Comma
            || matches!(last.text.as_str(), "please" | "thanks" | "ok" | "okay" | "now"))
    {
        rest = before;
    }
    let Some(first) = rest.first() else {
        return (body.to_vec(), None);
    };
    if let Some(list) = UNWISH
        .iter()
        .find(|l| rest.len() > l.len() && starts_with(rest, l))
    {
        let tail = strip(&rest[list.len()..], &[&["any", "more"], &["any"]]);
        let end = tail
            .iter()
            .rposition(|t| !matches!(t.text.as_str(), "please" | "anymore" | "more" | "any"));
        let tail = &tail[..end.map_or(tail.len(), |e| e + 1)];
        // "no more cones" means all of them, as "remove the cones" does
        return (with_verb("remove", first, tail), None);
    }
    // "could the lorry be swapped for a van?"
    let asks = matches!(
        first.text.as_str(),
        "could" | "can" | "should" | "would" | "must" | "may" | "might" | "shall"
    );
    if asks
        && rest.get(1).is_some_and(|t| {
            matches!(
                t.text.as_str(),
                "the" | "both" | "all" | "that" | "those" | "these" | "every"
            )
        })
    {
        return one(&rest[1..]);
    }
    // "leave everything as it is but put a cone there", "change nothing except the weather"
    let all = rest
        .get(1)
        .is_some_and(|t| matches!(t.text.as_str(), "everything" | "all" | "nothing" | "things"));
    let same = rest.get(1).is_some_and(|t| t.text == "nothing")
        || rest
            .iter()
            .take(8)
            .any(|t| matches!(t.text.as_str(), "as" | "else" | "unchanged" | "same" | "alone"));
    if matches!(first.text.as_str(), "leave" | "keep" | "change" | "touch") && all && same {
        let cut = rest.iter().position(|t| {
            t.kind == TokenKind::Comma
                || matches!(
                    t.text.as_str(),
                    "but" | "except" | "and" | "only" | "save" | "just"
                )
        });
        let tail = cut.map_or(&[][..], |k| strip(&rest[k + 1..], POLITE));
        return if tail.is_empty() {
            (Vec::new(), None)
        } else {
            one(tail)
        };
    }
    // "apart from the truck nothing should remain", "only the walkers may stay"
    let lead = [
        &["apart", "from"][..],
        &["except", "for"],
        &["except"],
        &["besides"],
        &["other", "than"],
        &["save", "for"],
        &["bar"],
        &["only"],
        &["just"],
        &["nothing", "but"],
    ]
    .into_iter()
    .find(|l| starts_with(rest, l));
    let stays = rest.iter().position(|t| {
        matches!(
            t.text.as_str(),
            "stay"
                | "stays"
                | "remain"
                | "remains"
                | "kept"
                | "left"
                | "go"
                | "survive"
                | "gone"
                | "disappear"
                | "removed"
        )
    });
    if let (Some(l), Some(_)) = (lead, stays) {
        let np = &rest[l.len()..];
        let end = np.iter().position(|t| {
            t.kind == TokenKind::Comma
                || matches!(
                    t.text.as_str(),
                    "may"
                        | "should"
                        | "can"
                        | "must"
                        | "shall"
                        | "is"
                        | "are"
                        | "will"
                        | "gets"
                        | "get"
                        | "everything"
                        | "nothing"
                        | "stays"
                        | "stay"
                        | "remain"
                        | "remains"
                        | "all"
                        | "has"
                        | "have"
                )
        });
        if let Some(end) = end.filter(|e| np[..*e].iter().any(is_noun)) {
            return (with_verb("keep only", first, &np[..end]), None);
        }
    }
    // "five people, not three", "four cones instead of six"
    let not_n = (1..rest.len()).find(|i| {
        let n = match rest[*i].text.as_str() {
            "not" => 1,
            "instead" | "rather" => 2,
            _ => return false,
        };
        rest.get(i + n).is_some_and(|t| number(t).is_some())
    });
    if let Some(k) = not_n
        && let Some(n) = rest[..k].iter().position(|t| number(t).is_some())
        && rest[n..k].iter().any(is_noun)
    {
        let end = if rest[k - 1].kind == TokenKind::Comma {
            k - 1
        } else {
            k
        };
        return (with_verb("keep exactly", first, &rest[n..end]), None);
    }
    if let Some(found) = restate(rest) {
        return found;
    }
    if let Some((tokens, change)) = arithmetic(rest) {
        return (tokens, Some(change));
    }
    // "I want the bus gone", "I'd like two more people"
    if let Some(list) = SPEAKER
        .iter()
        .find(|l| rest.len() > l.len() && starts_with(rest, l))
    {
        let wish = &rest[list.len()..];
        return (wished(wish, first), None);
    }
    // "everything away except the bus", "all out but the bus"
    if matches!(
        first.text.as_str(),
        "everything" | "all" | "everyone" | "remove" | "delete" | "clear" | "erase" | "take"
    ) {
        let cut = rest.iter().position(|t| {
            matches!(
                t.text.as_str(),
                "except" | "but" | "excluding" | "bar" | "save" | "besides"
            )
        });
        let everything = rest
            .iter()
            .take(cut.unwrap_or(0))
            .any(|t| matches!(t.text.as_str(), "everything" | "all" | "everyone"));
        if let Some(cut) = cut.filter(|_| everything) {
            let nouns = rest[..cut].iter().any(|t| is_noun(t) && t.text != "everything");
            let tail = strip(&rest[cut + 1..], &[&["for"], &["from"]]);
            if !nouns && !tail.is_empty() {
                return (with_verb("keep only", first, tail), None);
            }
        }
    }
    // "have a cyclist follow the bus", "let somebody else join the pedestrian"
    let fresh = rest.get(1).is_some_and(|t| {
        matches!(
            t.text.as_str(),
            "a" | "an" | "another" | "somebody" | "someone" | "some" | "one" | "two" | "three"
        ) || number(t).is_some()
    });
    let does = rest.iter().skip(2).take(6).any(|t| {
        matches!(
            sense(t),
            Some(Sense::State(_, true) | Sense::Rel(_) | Sense::Across)
        ) || is_verb(t)
    });
    if matches!(first.text.as_str(), "let" | "have" | "make" | "get") && fresh && does {
        return (with_verb("add", first, &rest[1..]), None);
    }
    if matches!(first.text.as_str(), "let" | "have" | "make" | "get")
        && rest.len() > 3
        && !matches!(rest[1].text.as_str(), "rid" | "it" | "that")
        && let Some(found) = restate(&rest[1..])
    {
        return found;
    }
    // ("clear the car away" is no weather)
    let clears = first.text == "clear"
        && rest.get(1).is_some_and(|t| {
            matches!(
                t.text.as_str(),
                "the" | "my" | "both" | "those" | "these" | "that"
            )
        });
    if (is_verb(first) || clears)
        && first.text != "let"
        && !(first.text == "get" && rest.len() > 2)
        && first.text != "have"
    {
        return (rest.to_vec(), None);
    }
    // "let the cyclist ride behind me", "have the people stand on the right", "get the bus behind me"
    if matches!(first.text.as_str(), "let" | "have" | "get") && rest.len() > 2 && rest[1].text != "rid" {
        let tail = &rest[1..];
        if let Some(found) = restate(tail) {
            return found;
        }
        if matches!(
            tail[0].text.as_str(),
            "the" | "all" | "my" | "both" | "every" | "that"
        ) {
            return (wished(tail, first), None);
        }
        if first.text == "have" {
            return (with_verb("add", first, tail), None);
        }
        return (rest.to_vec(), None);
    }
    (stated(rest).unwrap_or_else(|| rest.to_vec()), None)
}

#[cfg(test)]
mod tests {
    use super::super::tokens::tokens;
    use super::*;

    fn said(text: &str) -> String {
        let list: Vec<String> = rephrase(&tokens(text))
            .tokens
            .into_iter()
            .map(|t| t.text)
            .collect();
        list.join(" ")
    }

    #[test]
    fn statements_become_commands() {
        assert_eq!(said("The bus should go"), "remove the bus");
        assert_eq!(said("I want the bus gone"), "remove the bus");
        assert_eq!(said("the taxi ought to be a van"), "make the taxi a van");
        assert_eq!(
            said("let the cyclist ride behind me instead"),
            "move the cyclist behind me"
        );
        assert_eq!(said("everything away except the bus"), "keep only the bus");
        assert_eq!(said("could you remove the bus?"), "remove the bus .");
        assert_eq!(said("add a bus behind me"), "add a bus behind me");
        let less = rephrase(&tokens("one pedestrian less"));
        assert_eq!(less.changes, [(less.tokens[0].span.start, Change::Plus(-1))]);
        assert_eq!(
            rephrase(&tokens("double the number of parked cars")).changes[0].1,
            Change::Times(2.0)
        );
        assert_eq!(rephrase(&tokens("remove the second truck")).ordinals.len(), 1);
        assert!(rephrase(&[]).tokens.is_empty());
    }
}
