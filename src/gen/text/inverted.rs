//! Prompts whose words stand in another order, or that say in a relative clause what a plain one says: "parked behind that is
//! a van", "the children it is waiting for", "some fool has parked his van", "he shows us his back".

use super::ellipsis::{is_noun, number};
use super::lexicon::{Sense, look_up};
use super::tokens::{Token, TokenKind};
use super::wording::{begins, replaced, rewritten, word};

/// A prompt in plain order.
pub fn ordered(tokens: &[Token]) -> Vec<Token> {
    let out = replaced(
        tokens,
        "around is|about is|present is|in sight is|to be seen is",
        "is",
    );
    let out = replaced(
        &out,
        "nothing but|nothing except|nothing other than|nothing more than",
        "only",
    );
    let out = pointing_back(&super::told::plainly(&out));
    let out = participle_first(&out);
    let out = crossed_over(&out);
    let out = beyond(&out);
    let out = without_contact_clause(&out);
    let out = way_of_another(&out);
    let out = lets_go(&super::parker::parker(&out, false));
    let out = labels(&out);
    let out = shown(&out);
    let out = watched_from(&out);
    let out = replaced(
        &out,
        "namely|to wit|viz|that is to say|specifically|to be exact",
        "which is",
    );
    let out = replaced(
        &out,
        "nothing else on wheels|nothing on wheels|nothing else that moves|no other traffic|nothing else drives|nothing else on the road",
        "no other vehicles",
    );
    replaced(
        &out,
        "besides us|besides me|apart from us|apart from me|aside from us|aside from me|besides ours|besides mine|besides my own|besides our own|apart from ours|apart from mine|apart from my own|aside from ours|in addition to ours|not counting mine|not counting ours|not counting my own",
        "",
    )
}

pub(super) fn opens(tokens: &[Token], i: usize) -> bool {
    i == 0
        || matches!(
            tokens[i - 1].kind,
            TokenKind::Comma | TokenKind::Stop | TokenKind::Mark
        )
        || matches!(tokens[i - 1].text.as_str(), "and" | "while" | "but")
}

pub(super) fn is_fresh(t: &Token) -> bool {
    matches!(t.text.as_str(), "a" | "an" | "another") || number(t).is_some()
}

/// "behind that a van": behind it.
fn pointing_back(tokens: &[Token]) -> Vec<Token> {
    let mut out = tokens.to_vec();
    for i in 1..tokens.len() {
        let that = matches!(tokens[i].text.as_str(), "that" | "this");
        let led = matches!(
            tokens[i - 1].text.as_str(),
            "behind" | "of" | "beside" | "after" | "before" | "to" | "near" | "following"
        );
        let next = tokens.get(i + 1).is_none_or(|t| {
            t.kind != TokenKind::Word
                || is_fresh(t)
                || matches!(
                    t.text.as_str(),
                    "is" | "are" | "there" | "stands" | "comes" | "and" | "again" | "waits"
                )
        });
        if that && led && next {
            out[i].text = "it".into();
        }
    }
    out
}

/// "a bus has stopped at the zebra, and two children are walking over": over the zebra.
fn crossed_over(tokens: &[Token]) -> Vec<Token> {
    let zebra = |t: &Token| matches!(t.text.as_str(), "zebra" | "crosswalk" | "stripes" | "crossing");
    let mut out: Vec<Token> = Vec::new();
    for (i, t) in tokens.iter().enumerate() {
        out.push(t.clone());
        let over = matches!(t.text.as_str(), "over" | "across")
            && tokens
                .get(i + 1)
                .is_none_or(|n| matches!(n.kind, TokenKind::Comma | TokenKind::Stop));
        let walks = i > 0
            && matches!(
                tokens[i - 1].text.as_str(),
                "walking"
                    | "walks"
                    | "walk"
                    | "going"
                    | "goes"
                    | "running"
                    | "runs"
                    | "hurrying"
                    | "hurries"
                    | "strolling"
            );
        // "an old woman is halfway across"
        let halfway = i > 1
            && matches!(
                tokens[i - 1].text.as_str(),
                "halfway" | "midway" | "partway" | "way" | "already" | "nearly" | "almost"
            );
        if over && (walks || halfway) && tokens[..i].iter().any(zebra) {
            out.pop();
            out.extend(["across", "the", "zebra"].map(|w| word(w, t)));
        }
    }
    out
}

/// "beyond the cones": farther on than they are.
fn beyond(tokens: &[Token]) -> Vec<Token> {
    let mut out: Vec<Token> = Vec::new();
    for (i, t) in tokens.iter().enumerate() {
        let rest = &tokens[i + 1..];
        let article = begins(rest, "the|that|those|these|this").unwrap_or(0);
        let named = rest.get(article).is_some_and(is_noun) || begins(rest, "them|it|him|her").is_some();
        if t.text == "beyond" && named {
            out.extend(["further", "on", "than"].map(|w| word(w, t)));
        } else {
            out.push(t.clone());
        }
    }
    out
}

/// "parked in front of that is a roller" is "in front of that is a parked roller".
fn participle_first(tokens: &[Token]) -> Vec<Token> {
    let mut out = tokens.to_vec();
    for i in 0..tokens.len() {
        let state = matches!(
            tokens[i].text.as_str(),
            "parked" | "standing" | "waiting" | "stopped" | "sitting" | "walking"
        );
        let placed = (1..=5.min(tokens.len() - i - 1)).any(|n| {
            let words: Vec<&str> = tokens[i + 1..=i + n].iter().map(|t| t.text.as_str()).collect();
            matches!(
                look_up(&words.join(" ")),
                Some(Sense::Rel(_) | Sense::EgoRel(_) | Sense::In | Sense::At | Sense::Possessed(_))
            )
        });
        if !state || !opens(tokens, i) || !placed {
            continue;
        }
        let verb = (i + 2..tokens.len().min(i + 14))
            .take_while(|k| !matches!(tokens[*k].kind, TokenKind::Comma | TokenKind::Stop))
            .find(|k| matches!(tokens[*k].text.as_str(), "is" | "are" | "was" | "were"));
        if let Some(k) = verb.filter(|k| tokens.get(k + 1).is_some_and(is_fresh)) {
            let state = out.remove(i);
            out.insert(k + 1, state);
            break;
        }
    }
    out
}

/// "the children it is waiting for are walking over": a clause without a pronoun of its own says nothing of where they are.
fn without_contact_clause(tokens: &[Token]) -> Vec<Token> {
    let be = |t: Option<&Token>| {
        t.is_some_and(|t| matches!(t.text.as_str(), "is" | "are" | "was" | "were" | "has" | "have"))
    };
    rewritten(tokens, |i, out| {
        let subject = matches!(tokens[i].text.as_str(), "it" | "he" | "she" | "they");
        let led = out.last().is_some_and(is_noun);
        let doing = be(tokens.get(i + 1)) && tokens.get(i + 2).is_some_and(|t| t.text.ends_with("ing"));
        let prep = tokens
            .get(i + 3)
            .is_some_and(|t| matches!(t.text.as_str(), "for" | "to" | "at" | "on" | "with" | "behind"));
        if subject && led && doing && prep && be(tokens.get(i + 4)) {
            return Some(i + 4);
        }
        None
    })
}

/// "the lane ahead of it": the lane, and ahead of it.
fn way_of_another(tokens: &[Token]) -> Vec<Token> {
    let mut out: Vec<Token> = Vec::new();
    for (i, t) in tokens.iter().enumerate() {
        let lane = i > 0 && matches!(tokens[i - 1].text.as_str(), "lane" | "road" | "way" | "street");
        let of = begins(&tokens[i..], "ahead of|in front of").filter(|_| lane);
        let mine =
            of.is_some_and(|n| begins(&tokens[i + n..], "me|us|my|our|the ego|ego|the host").is_some());
        if of.is_some() && !mine && i + 2 < tokens.len() {
            out.push(Token {
                kind: TokenKind::Comma,
                ..word(",", t)
            });
        }
        out.push(t.clone());
    }
    out
}

/// "a lorry lets two girls go over the zebra": it waits for two girls who go over it.
fn lets_go(tokens: &[Token]) -> Vec<Token> {
    const LETS: &str = "lets|is letting|has let|allows|is allowing|let|permits";
    const GO: &str = "go|pass|cross|walk|come|run|get|step|stroll|hurry";
    let mut out = tokens.to_vec();
    for i in 1..tokens.len() {
        let Some(n) = begins(&tokens[i..], LETS).filter(|_| is_noun(&tokens[i - 1])) else {
            continue;
        };
        let verb = (i + n + 1..tokens.len().min(i + n + 6)).find(|k| begins(&tokens[*k..], GO).is_some());
        let Some(k) = verb.filter(|k| tokens[i + n..*k].iter().any(is_noun)) else {
            continue;
        };
        let to = usize::from(tokens[k - 1].text == "to");
        let mut new = tokens[..i].to_vec();
        new.extend(["waits", "for"].map(|w| word(w, &tokens[i])));
        new.extend_from_slice(&tokens[i + n..k - to]);
        new.push(word("who", &tokens[k]));
        new.extend_from_slice(&tokens[k..]);
        out = new;
        break;
    }
    out
}

/// "Rear: a van", "range 20 m": labels of a list in words.
fn labels(tokens: &[Token]) -> Vec<Token> {
    let mut out: Vec<Token> = Vec::new();
    for (i, t) in tokens.iter().enumerate() {
        let colon = tokens.get(i + 1).is_some_and(|t| t.text == ":");
        let label = match t.text.as_str() {
            "rear" | "back" => Some("behind me"),
            "front" => Some("in front of me"),
            _ => None,
        };
        if let Some(label) = label.filter(|_| colon && opens(tokens, i)) {
            out.extend(label.split(' ').map(|w| word(w, t)));
            continue;
        }
        let measure = matches!(t.text.as_str(), "range" | "distance" | "headway" | "gap") && opens(tokens, i);
        let from = i + 1 + usize::from(colon);
        let metres = tokens
            .get(from)
            .is_some_and(|n| matches!(n.kind, TokenKind::Number(_)))
            && tokens
                .get(from + 1)
                .is_some_and(|u| matches!(look_up(&u.text), Some(Sense::Unit(_))));
        if measure && metres && !colon {
            out.push(word("at", t));
            continue;
        }
        out.push(t.clone());
    }
    out
}

/// "shows us its back", "has its front to me": how it faces.
fn shown(tokens: &[Token]) -> Vec<Token> {
    const SHOWS: &str = "shows|show|showing|turns|turn|turning|presents|presenting|offers|has|have|having|with|points|pointing";
    let front = |w: &str| {
        matches!(
            w,
            "front"
                | "nose"
                | "face"
                | "bonnet"
                | "hood"
                | "headlights"
                | "headlamps"
                | "grille"
                | "fronts"
                | "faces"
        )
    };
    let back = |w: &str| {
        matches!(
            w,
            "back" | "rear" | "tail" | "backs" | "taillights" | "boot" | "backside"
        )
    };
    let me = |t: Option<&Token>| t.is_some_and(|t| matches!(t.text.as_str(), "me" | "us"));
    rewritten(tokens, |i, out| {
        let found = begins(&tokens[i..], SHOWS).and_then(|n| {
            let mut k = i + n;
            let mut ego = me(tokens.get(k));
            k += usize::from(ego);
            let own = tokens
                .get(k)
                .is_some_and(|t| matches!(t.text.as_str(), "its" | "his" | "her" | "their"));
            let part = tokens.get(k + 1)?.text.clone();
            k += 2;
            if !ego {
                let turned = begins(&tokens[k..], "turned").unwrap_or(0);
                let to = begins(&tokens[k + turned..], "to|towards|toward|at|on")?;
                ego = me(tokens.get(k + turned + to));
                k += turned + to + 1;
            }
            let way = if front(&part) {
                "facing"
            } else if back(&part) {
                "facing away from"
            } else {
                return None;
            };
            (own && ego).then_some((way, k))
        });
        let (way, end) = found?;
        out.extend(way.split(' ').map(|w| word(w, &tokens[i])));
        out.push(word("me", &tokens[i]));
        Some(end)
    })
}

/// "watches from the pavement", "directs the traffic from the centre": who looks on is there.
fn watched_from(tokens: &[Token]) -> Vec<Token> {
    const DIRECTS: &str = "directing the traffic|directing traffic|directs the traffic|directs traffic|regulating the traffic|regulating traffic|regulates the traffic|regulates traffic|controlling the traffic|controlling traffic|controls the traffic|waving traffic through|waving the traffic through|guiding the traffic|guiding traffic";
    let tokens = replaced(tokens, DIRECTS, "standing");
    let mut out: Vec<Token> = Vec::new();
    for (i, t) in tokens.iter().enumerate() {
        let watches = i > 0
            && matches!(
                tokens[i - 1].text.as_str(),
                "watching"
                    | "watch"
                    | "watches"
                    | "looking"
                    | "look"
                    | "looks"
                    | "on"
                    | "standing"
                    | "waving"
                    | "waves"
                    | "observing"
                    | "observe"
                    | "shouting"
                    | "calling"
                    | "staring"
            );
        if t.text == "from"
            && watches
            && tokens
                .get(i + 1)
                .is_some_and(|n| matches!(n.text.as_str(), "the" | "a" | "my" | "our"))
        {
            let centre = tokens
                .get(i + 2)
                .is_some_and(|n| matches!(n.text.as_str(), "middle" | "centre" | "center"));
            out.push(word(if centre { "in" } else { "on" }, t));
        } else {
            out.push(t.clone());
        }
    }
    out
}

#[cfg(test)]
mod tests {
    use super::super::tokens::tokens;
    use super::*;

    #[test]
    fn words_in_plain_order() {
        let said = |t: &str| {
            let list: Vec<String> = ordered(&tokens(t)).into_iter().map(|t| t.text).collect();
            list.join(" ")
        };
        assert_eq!(
            said("and parked in front of that is a van"),
            "and in front of it is a parked van"
        );
        assert_eq!(
            said("the children it is waiting for are walking"),
            "the children are walking"
        );
        assert_eq!(
            said("some fool has parked his van on the pavement"),
            "a van is parked on the pavement"
        );
        assert_eq!(said("Rear: a van, range 20 m"), "behind me : a van , at 20 m");
        assert_eq!(said("the other shows me its front"), "the other facing me");
        assert_eq!(
            said("it blocks the lane ahead of it"),
            "it blocks the lane , ahead of it"
        );
    }
}
