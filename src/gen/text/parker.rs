//! Who is named only for what he has parked, or for what he goes without: "some driver has parked his car there" is a parked
//! car, "a man without shoes is crossing" is a man who crosses.

use super::ellipsis::{is_noun, number};
use super::lexicon::{Sense, look_up, plural};
use super::rephrase::is_place_word;
use super::said::words::is_finite;
use super::tokens::{Token, TokenKind};
use super::wording::{begins, rewritten, word};

/// "some fool has parked his van there": a van is parked; who parked it is not there, if nothing more is said of him. In an
/// edit "the van" is one that is there already.
pub fn parker(tokens: &[Token], edits: bool) -> Vec<Token> {
    const DRIVER: &str = "fool|idiot|moron|jerk|genius|clown|joker|maniac|driver|guy|bloke|motorist|fellow|person|dimwit|twit|lunatic|owner|drivers|motorists|owners";
    const SOMEONE: &str = "somebody|someone";
    const KNOWN: &str = "its driver|the driver|the owner|its owner";
    const LEFT: &str = "has parked|have parked|parked|parks|park|has left|have left|left|has abandoned|have abandoned|abandoned|has dumped|dumped|has ditched|has double parked|has stuck|has put|put|has leaving|is parking|are parking";
    rewritten(tokens, |i, out| {
        let fresh = |t: &Token| {
            matches!(t.text.as_str(), "some" | "a" | "an" | "another" | "one") || number(t).is_some()
        };
        let drives = || {
            let n = begins(tokens.get(i + 1..)?, DRIVER)?;
            fresh(&tokens[i]).then_some(n + 1)
        };
        let told = || begins(&tokens[i..], KNOWN).filter(|_| !edits);
        let n = begins(&tokens[i..], SOMEONE).or_else(told).or_else(drives)?;
        let verb = begins(&tokens[i + n..], LEFT)?;
        let k = i + n + verb;
        // ("somebody left a trailer standing there": what is left there is told, not who left it)
        let own = |t: &Token| matches!(t.text.as_str(), "his" | "her" | "their" | "a" | "an");
        let his = tokens
            .get(k)
            .is_some_and(|t| own(t) || number(t).is_some() || t.text == "the" && !edits);
        let noun = (k + 1..tokens.len().min(k + 5)).find(|j| is_noun(&tokens[*j]))?;
        let more = tokens.get(noun + 1..).is_some_and(|rest| {
            rest.iter()
                .take_while(|t| !matches!(t.kind, TokenKind::Stop))
                .zip(rest.iter().skip(1))
                .any(|(a, b)| {
                    a.text == "and"
                        && matches!(
                            b.text.as_str(),
                            "is" | "stands" | "walks" | "now" | "has" | "he" | "she"
                        )
                })
        });
        if !his || more {
            return None;
        }
        let own_each = matches!(tokens[k].text.as_str(), "his" | "her" | "their");
        let counted = if own_each { &tokens[i] } else { &tokens[k] };
        let many = number(counted).filter(|n| *n > 1);
        out.push(if many.is_some() {
            counted.clone()
        } else {
            word("a", &tokens[i])
        });
        out.extend_from_slice(&tokens[k + 1..=noun]);
        if let (Some(last), true) = (out.last_mut(), many.is_some())
            && matches!(look_up(&last.text), Some(Sense::Noun(_, false)))
        {
            last.text = plural(&last.text);
        }
        let stands = tokens.get(noun + 1).is_some_and(|t| {
            matches!(
                t.text.as_str(),
                "standing" | "parked" | "abandoned" | "lying" | "unattended" | "waiting" | "behind"
            )
        });
        let is = if many.is_some() { "are" } else { "is" };
        out.push(word(is, &tokens[i]));
        if !stands || edits {
            out.push(word("parked", &tokens[i]));
        }
        Some(noun + 1)
    })
}

/// "a man without shoes is crossing": what somebody has not on him is not in the scene.
pub fn lacking(tokens: &[Token]) -> Vec<Token> {
    let known = |t: &Token| {
        matches!(
            look_up(&t.text),
            Some(Sense::Noun(..) | Sense::Place(..) | Sense::Time(_) | Sense::Works)
        )
    };
    rewritten(tokens, |i, out| {
        let someone = out.last().is_some_and(is_noun);
        (tokens[i].text == "without" && someone).then_some(())?;
        let article = tokens.get(i + 1).is_some_and(|t| {
            matches!(
                t.text.as_str(),
                "a" | "an" | "any" | "his" | "her" | "their" | "its"
            )
        });
        let from = i + 1 + usize::from(article);
        let end = (from + 1..tokens.len().min(from + 4)).find(|k| {
            let t = &tokens[*k];
            t.kind != TokenKind::Word
                || matches!(
                    t.text.as_str(),
                    "is" | "are"
                        | "was"
                        | "were"
                        | "has"
                        | "have"
                        | "and"
                        | "who"
                        | "that"
                        | "should"
                        | "must"
                )
                || is_place_word(t)
                || is_finite(&t.text, false)
                || t.text.ends_with("ing") && matches!(look_up(&t.text), Some(Sense::State(..)))
        })?;
        let thing = &tokens[from..end];
        thing
            .iter()
            .all(|t| t.kind == TokenKind::Word && !known(t) && !is_place_word(t))
            .then_some(end)
    })
}

#[cfg(test)]
mod tests {
    use super::super::tokens::tokens;
    use super::*;

    fn text(list: Vec<Token>) -> String {
        list.into_iter().map(|t| t.text).collect::<Vec<_>>().join(" ")
    }

    #[test]
    fn what_is_parked_counts_not_who_parked_it() {
        let said = |t: &str, edits| text(parker(&tokens(t), edits));
        assert_eq!(
            said("Some driver has parked his car here", true),
            "a car is parked here"
        );
        assert_eq!(
            said("Two drivers have left their cars here", false),
            "two cars are parked here"
        );
        assert_eq!(
            said("the driver has parked the van", true),
            "the driver has parked the van"
        );
    }

    #[test]
    fn what_somebody_lacks_is_left_out() {
        let said = |t: &str| text(lacking(&tokens(t)));
        assert_eq!(said("Someone without a light is running"), "someone is running");
        assert_eq!(
            said("a car without a trailer is waiting"),
            "a car without a trailer is waiting"
        );
    }
}
