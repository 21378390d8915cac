//! Turns of speech that prompts and edits share, in plain words before either grammar reads them: courtesies, ordinals in
//! digits, numbers said in a roundabout way, what only a part of a thing is named for.

use super::lexicon::{Sense, look_up};
use super::tokens::{Token, TokenKind};
use super::wording::{begins, replaced, rewritten, word};

const COURTESY: &str = "if it is not too much trouble|if its not too much trouble|if it isnt too much trouble|if that is not too much trouble|if thats not too much trouble|if that isnt too much trouble|if it is no trouble|if its no trouble|if you dont mind|if you do not mind|if possible|if it is possible|if its possible|if thats possible|if that is possible|if it is ok|if its ok|if thats ok|if that is okay|if thats okay|if you would be so kind|if you please|if i may ask|if i may|if it is not asking too much|if thats not asking too much|if it is no bother|if its no bother|if youd be so kind|when you get a chance|when you have a moment|if it isnt asking too much";
const REMINDERS: &str = "dont forget to|do not forget to|dont forget about|do not forget about|dont forget|do not forget|not to forget|not forgetting|lets not forget|let us not forget";
const EXACTLY: &str = "no more and no fewer than|no more and no less than|no fewer and no more than|no less and no more than|no more nor fewer than|neither more nor fewer than|neither more nor less than|neither fewer nor more than|neither less nor more than|not more and not less than|not more and not fewer than|no more no less than|precisely|exactly and only|a total of exactly";
const PARTS: &str = "the back of|the rear of|the rear end of|the tail of|the tail end of|the back end of|the front of|the side of|the silhouette of|the outline of|the shape of|the figure of|the taillights of|the tail lights of|the rear lights of|the headlights of|the form of";
const ANY_KIND: &str = "of any other kind|of any kind|of any other sort|of any sort|of any other type|of any type|whatsoever|of whatever kind";
const FREE: &str = "my lane is free and|our lane is free and|my lane is free ,|our lane is free ,|my own lane is free ,|our own lane is free ,|the ego lane is free ,|my lane is clear ,|our lane is clear ,|my lane is empty ,|our lane is empty ,|my lane is free .|our lane is free .|my lane is empty .";
const ORDINALS: [&str; 12] = [
    "first", "second", "third", "fourth", "fifth", "sixth", "seventh", "eighth", "ninth", "tenth",
    "eleventh", "twelfth",
];

const CLOSING: &str = "that is all|thats all|this is all|and that is it|and thats it|that is everything|thats everything|that is already everything|thats already everything|nothing more than that|no more than that|that will be all|thatll be all|that would be all|that will do|that should be all|that is the lot|thats the lot";

const CROSSES_OURS: &str = "street that crosses ours|road that crosses ours|street which crosses ours|road which crosses ours|street that crosses mine|road that crosses mine|street that crosses our street|street that crosses our road|road that crosses our road|road that crosses our street|street that crosses my street|road that crosses my road|street crossing ours|road crossing ours|street crossing our road|street crossing our street|road crossing our street|road crossing our road|street running across ours|road running across ours|street that runs across ours";

const SET_OFF: &str = "quite near|quite close|very near|very close|rather close|rather near|of course|as usual|as always|by the way|for example|for instance|say|i think|i guess|i believe|apparently|obviously|as it happens|so it seems|it seems|sadly|luckily|unfortunately|fortunately|naturally|needless to say|believe it or not|as you can see|you see|mind you|i suppose|let us say|lets say|i would say|id say|in fact|actually|surprisingly|for a change|as so often|however|though|on the other hand|by contrast|in contrast|in turn";

fn is_number(t: &Token) -> bool {
    matches!(t.kind, TokenKind::Number(_))
        || matches!(look_up(&t.text), Some(Sense::Count(c)) if c.is_exact() && t.text != "a")
}

/// A text in plain words.
pub fn plain(tokens: &[Token]) -> Vec<Token> {
    let out = super::same_words::plain(&ordinals(&paced(&halves(&tens(tokens)))));
    let out = super::slips::put_right(out);
    let out = without_courtesy(&out);
    let out = replaced(&out, REMINDERS, "and");
    let out = replaced(&out, EXACTLY, "exactly");
    let out = bounds(&out);
    let out = replaced(&out, ANY_KIND, "");
    let out = replaced(&out, "( ego ) vehicle|( ego ) car|( ego )", "ego vehicle");
    let out = replaced(&out, FREE, "");
    let out = without_asides(&without_closing(&out));
    let out = replaced(&own_thing(&out), "in number|in numbers", "in total");
    let out = replaced(
        &of_so_many(&out),
        "ourselves|myself|itself|himself|herself|themselves",
        "",
    );
    let out = replaced(&out, CROSSES_OURS, "cross street");
    let out = super::parker::lacking(&both_the(&out));
    let out = super::coloured_ones::named(&out);
    let out = sides_in_short(&out);
    let out = super::ellipsis_lanes::strip_named_before(&this_one(&out));
    super::carried::plain(this_side(&some_so_many(&part_for_whole(&out))))
}

/// "thirty-five": one number, as whoever looks for a number expects.
fn tens(tokens: &[Token]) -> Vec<Token> {
    const TENS: &str = "twenty|thirty|forty|fifty|sixty|seventy|eighty|ninety";
    const ONES: &str = "one|two|three|four|five|six|seven|eight|nine";
    rewritten(tokens, |i, out| {
        let next = tokens.get(i + 1)?;
        begins(&tokens[i..], TENS)?;
        begins(&tokens[i + 1..], ONES)?;
        let sum = super::ellipsis::number(&tokens[i])? + super::ellipsis::number(next)?;
        out.push(Token {
            kind: TokenKind::Number(f64::from(sum)),
            text: sum.to_string(),
            span: tokens[i].span.to(next.span),
        });
        Some(i + 2)
    })
}

/// "twelve and a half metres": 12.5 m.
fn halves(tokens: &[Token]) -> Vec<Token> {
    rewritten(tokens, |i, out| {
        let whole = super::ellipsis::number(&tokens[i]).filter(|n| *n > 0)?;
        let n = 1 + begins(tokens.get(i + 1..)?, "and a half|and one half")?;
        let unit = (1..=2).any(|k| {
            let words = tokens.get(i + n..i + n + k);
            let words = words.map(|w| w.iter().map(|t| t.text.as_str()).collect::<Vec<_>>().join(" "));
            words.is_some_and(|w| matches!(look_up(&w), Some(Sense::Unit(_))))
        });
        unit.then(|| {
            let metres = f64::from(whole) + 0.5;
            out.push(Token {
                kind: TokenKind::Number(metres),
                text: metres.to_string(),
                span: tokens[i].span.to(tokens[i + n - 1].span),
            });
            i + n
        })
    })
}

/// "ten paces ahead": in metres, as far as that is with ordinary steps.
fn paced(tokens: &[Token]) -> Vec<Token> {
    const PACE_M: f64 = 0.75;
    const STEPS: &str = "paces|steps|strides|footsteps|big steps|long strides|large steps|good paces";
    const WHITHER: &str = "ahead|in front|before|behind|away|from|off|back|forward|forwards|backwards|to|towards|toward|left|right|nearer|closer|further|farther|up|down|beyond|past|apart|after|of|on|aside|beside";
    rewritten(tokens, |i, out| {
        let many = super::ellipsis::number(&tokens[i]).filter(|n| *n > 0)?;
        let n = 1 + begins(tokens.get(i + 1..)?, STEPS)?;
        let rest = &tokens[i + n..];
        let far = rest.first().is_none_or(|t| t.kind != TokenKind::Word) || begins(rest, WHITHER).is_some();
        // ("in three steps" is how, not how far)
        let how = out
            .last()
            .is_some_and(|t| matches!(t.text.as_str(), "in" | "these" | "those"));
        (far && !how).then(|| {
            let metres = f64::from(many) * PACE_M;
            out.push(Token {
                kind: TokenKind::Number(metres),
                text: metres.to_string(),
                span: tokens[i].span,
            });
            out.push(word("m", &tokens[i + n - 1]));
            i + n
        })
    })
}

/// "1st", "2nd": in words.
fn ordinals(tokens: &[Token]) -> Vec<Token> {
    let mut out: Vec<Token> = Vec::new();
    let mut i = 0;
    while i < tokens.len() {
        let joined = tokens.get(i + 1).is_some_and(|t| {
            matches!(t.text.as_str(), "st" | "nd" | "rd" | "th") && t.span.start == tokens[i].span.end
        });
        let nth = match tokens[i].kind {
            TokenKind::Number(v) if joined && (1.0..=12.0).contains(&v) => ORDINALS.get(v as usize - 1),
            _ => None,
        };
        match nth {
            Some(nth) => {
                if !out
                    .last()
                    .is_some_and(|t| matches!(t.text.as_str(), "the" | "a" | "its" | "my"))
                {
                    out.push(word("the", &tokens[i]));
                }
                out.push(word(nth, &tokens[i]));
                i += 2;
            }
            None => {
                out.push(tokens[i].clone());
                i += 1;
            }
        }
    }
    out
}

/// What is only polite, with the commas that set it off.
fn without_courtesy(tokens: &[Token]) -> Vec<Token> {
    let comma = |t: Option<&Token>| t.is_some_and(|t| t.kind == TokenKind::Comma);
    rewritten(tokens, |i, out| {
        // (", please," between two clauses)
        let please = tokens[i].text == "please"
            && comma(out.last())
            && comma(tokens.get(i + 1))
            && tokens
                .get(i + 2)
                .is_some_and(|t| matches!(t.text.as_str(), "and" | "but"));
        let mut i = i + begins(&tokens[i..], COURTESY).or(please.then_some(1))?;
        if comma(tokens.get(i)) && (comma(out.last()) || out.is_empty()) {
            i += 1;
            let inside =
                out.len() > 1 && matches!(out[out.len() - 2].text.as_str(), "and" | "but" | "with" | "or");
            if inside {
                out.pop();
            }
        }
        Some(i)
    })
}

/// "and that is all the traffic I want": what was named is everything, and no more of it.
fn without_closing(tokens: &[Token]) -> Vec<Token> {
    const MORE: &str = "the|i|we|there|you|that|of|for|to|it|please|folks|really";
    rewritten(tokens, |i, out| {
        let said = begins(&tokens[i..], CLOSING).filter(|n| {
            let next = &tokens[i + n..];
            let ends = next.first().is_none_or(|t| t.kind != TokenKind::Word);
            // ("that is all in our lane" says where)
            !out.is_empty() && (ends || begins(next, MORE).is_some())
        });
        let from = i + said?;
        let end =
            (from..tokens.len()).find(|k| matches!(tokens[*k].kind, TokenKind::Stop | TokenKind::Comma));
        while out
            .last()
            .is_some_and(|t| t.kind == TokenKind::Comma || matches!(t.text.as_str(), "and" | "but"))
        {
            out.pop();
        }
        Some(end.unwrap_or(tokens.len()))
    })
}

/// "no fewer than six": at least six, and not none.
fn bounds(tokens: &[Token]) -> Vec<Token> {
    const LEAST: &str = "no fewer than|no less than|not fewer than|not less than|nothing less than";
    const MOST: &str = "no more than|not more than|no greater number than";
    rewritten(tokens, |i, out| {
        let (n, which) = [(LEAST, "least"), (MOST, "most")]
            .iter()
            .find_map(|(said, word)| begins(&tokens[i..], said).map(|n| (n, *word)))
            .filter(|(n, _)| tokens.get(i + n).is_some_and(is_number))?;
        out.extend(["at", which].map(|w| word(w, &tokens[i])));
        Some(i + n)
    })
}

/// "a family of five": five people.
fn of_so_many(tokens: &[Token]) -> Vec<Token> {
    const GROUP: &str =
        "family of|group of|party of|team of|crew of|band of|gang of|bunch of|crowd of|class of";
    rewritten(tokens, |i, out| {
        let n = begins(&tokens[i..], GROUP).filter(|n| {
            let many = tokens.get(i + n).is_some_and(is_number);
            let bare = tokens.get(i + n + 1).is_none_or(|t| {
                !matches!(
                    look_up(&t.text),
                    Some(Sense::Noun(..) | Sense::Attribute(_) | Sense::Size(_) | Sense::Color(_))
                )
            });
            many && bare
        });
        let n = n?;
        if out
            .last()
            .is_some_and(|t| matches!(t.text.as_str(), "a" | "the" | "one" | "another"))
        {
            out.pop();
        }
        out.push(tokens[i + n].clone());
        out.push(word("people", &tokens[i]));
        Some(i + n + 1)
    })
}

/// "his own car": his car.
fn own_thing(tokens: &[Token]) -> Vec<Token> {
    rewritten(tokens, |i, out| {
        let whose = out
            .last()
            .is_some_and(|b| matches!(b.text.as_str(), "his" | "her" | "their" | "its"));
        let thing = tokens.get(i + 1).is_some_and(super::ellipsis::is_noun);
        (tokens[i].text == "own" && whose && thing).then_some(i + 1)
    })
}

/// ", unable to pass,": why somebody does what is told says nothing of where.
fn without_asides(tokens: &[Token]) -> Vec<Token> {
    const LEAD: &str = "unable|ready|willing|eager|keen|hoping|hesitant|reluctant|afraid|impatient|unwilling|intending|unsure|obliged|determined|prepared|anxious|desperate|wanting|meaning|wishing|refusing|failing";
    rewritten(tokens, |i, out| {
        let aside = begins(&tokens[i..], LEAD)
            .filter(|_| out.last().is_some_and(|t| t.kind == TokenKind::Comma))
            .filter(|n| tokens.get(i + n).is_some_and(|t| t.text == "to"));
        let end =
            aside.and_then(|n| (i + n..tokens.len().min(i + 8)).find(|k| tokens[*k].kind != TokenKind::Word));
        // ", quite near,"
        let said = begins(&tokens[i..], SET_OFF).filter(|n| {
            let comma = |t: Option<&Token>| t.is_some_and(|t| t.kind == TokenKind::Comma);
            comma(out.last()) && comma(tokens.get(i + n))
        });
        if let Some(n) = said {
            out.pop();
            let verb = tokens.get(i + n + 1).is_some_and(|t| {
                matches!(
                    t.text.as_str(),
                    "is" | "are"
                        | "stands"
                        | "stand"
                        | "was"
                        | "were"
                        | "comes"
                        | "come"
                        | "drives"
                        | "drive"
                        | "disappears"
                        | "disappear"
                        | "leaves"
                        | "leave"
                        | "goes"
                        | "go"
                        | "stays"
                        | "stay"
                        | "remains"
                        | "remain"
                        | "should"
                        | "must"
                        | "shall"
                        | "has"
                        | "have"
                        | "can"
                        | "may"
                        | "becomes"
                        | "moves"
                        | "waits"
                        | "rides"
                )
            });
            return Some(i + n + usize::from(verb));
        }
        let plain = |k: usize| !tokens[i..k].iter().any(super::ellipsis::is_noun);
        let end =
            end.filter(|k| matches!(tokens[*k].kind, TokenKind::Comma | TokenKind::Stop) && plain(*k))?;
        out.pop();
        Some(end)
    })
}

/// "on both the sides": on both sides; "both the bus and the car": the bus and the car.
fn both_the(tokens: &[Token]) -> Vec<Token> {
    let mut out: Vec<Token> = Vec::new();
    for (i, t) in tokens.iter().enumerate() {
        let after =
            i > 0 && tokens[i - 1].text == "both" && matches!(t.text.as_str(), "the" | "these" | "those");
        let many = tokens[i + 1..]
            .iter()
            .take(3)
            .find(|t| {
                t.text == "sides" || matches!(look_up(&t.text), Some(Sense::Noun(..) | Sense::Place(..)))
            })
            .is_some_and(|t| {
                t.text == "sides"
                    || matches!(look_up(&t.text), Some(Sense::Noun(_, true)))
                    || matches!(look_up(&t.text), Some(Sense::Place(..))) && t.text.ends_with('s')
            });
        let two = tokens[i + 1..]
            .iter()
            .take(7)
            .position(|t| t.text == "and")
            .is_some_and(|k| {
                tokens
                    .get(i + 2 + k)
                    .is_some_and(|t| matches!(t.text.as_str(), "the" | "that" | "those"))
            });
        if after && two && !many {
            out.pop();
        }
        if !(after && many) {
            out.push(t.clone());
        }
    }
    out
}

/// "lhs", "rhs".
fn sides_in_short(tokens: &[Token]) -> Vec<Token> {
    let mut out: Vec<Token> = Vec::new();
    for (i, t) in tokens.iter().enumerate() {
        let side = match t.text.as_str() {
            "lhs" => "left",
            "rhs" => "right",
            _ => {
                out.push(t.clone());
                continue;
            }
        };
        let led = i > 0
            && matches!(
                tokens[i - 1].text.as_str(),
                "the" | "my" | "our" | "on" | "at" | "to"
            );
        let lead: &[&str] = match (
            led,
            i > 0 && tokens[i - 1].text.len() == 2 && tokens[i - 1].text != "my",
        ) {
            (true, true) => &["the"],
            (true, false) => &[],
            (false, _) => &["on", "the"],
        };
        out.extend(lead.iter().chain([&side, &"side"]).map(|w| word(w, t)));
    }
    out
}

/// "one more motorcycle, but this one is following us": which is.
fn this_one(tokens: &[Token]) -> Vec<Token> {
    const LEAD: &str = ", but this one|, and this one|, only this one|, this one|but this one|, but that one|, and that one|, this one though|, however this one";
    const VERB: &str = "is|are|has|stands|drives|comes|waits|rides|parks|sits|walks|follows|faces|goes|should be|should|must be|moves|heads";
    rewritten(tokens, |i, out| {
        let n = begins(&tokens[i..], LEAD)
            .filter(|n| begins(&tokens[i + n..], VERB).is_some() && !out.is_empty())?;
        out.push(word("which", &tokens[i]));
        // "which should be behind us" is which is
        let should = begins(&tokens[i + n..], "should be|must be|shall be|is to be");
        if should.is_some() {
            out.push(word("is", &tokens[i + n]));
        }
        Some(i + n + should.unwrap_or(0))
    })
}

/// "we make out the back of a bus": a bus. "at the back of a bus" is a place.
fn part_for_whole(tokens: &[Token]) -> Vec<Token> {
    rewritten(tokens, |i, out| {
        let whole = begins(&tokens[i..], PARTS).filter(|n| {
            tokens
                .get(i + n)
                .is_some_and(|t| matches!(t.text.as_str(), "a" | "an" | "another") || is_number(t))
                && !out.last().is_some_and(|t| {
                    matches!(
                        look_up(&t.text),
                        Some(Sense::In | Sense::At | Sense::Rel(_) | Sense::EgoRel(_) | Sense::Across)
                    ) || matches!(
                        t.text.as_str(),
                        "to" | "from"
                            | "of"
                            | "against"
                            | "for"
                            | "with"
                            | "into"
                            | "turn"
                            | "left"
                            | "right"
                    )
                })
        });
        let thing = i + whole?;
        out.push(tokens[thing].clone());
        Some(thing + 1)
    })
}

/// "some ten metres", "some twenty cars": about so many.
fn some_so_many(tokens: &[Token]) -> Vec<Token> {
    rewritten(tokens, |i, _| {
        (tokens[i].text == "some" && tokens.get(i + 1).is_some_and(is_number)).then_some(i + 1)
    })
}

/// "just this side of the cones": between us and them, whichever way they are turned. "This side of the road" is a place.
fn this_side(tokens: &[Token]) -> Vec<Token> {
    const NEAR: &str = "on this side of|on our side of|on the near side of|on the nearer side of|this side of|to this side of|at the near side of";
    rewritten(tokens, |i, out| {
        let n = begins(&tokens[i..], NEAR)?;
        let the = matches!(
            tokens.get(i + n)?.text.as_str(),
            "the" | "those" | "these" | "all" | "both"
        );
        let many = usize::from(tokens.get(i + n + 1).is_some_and(is_number));
        let thing = tokens.get(i + n + 1 + many).is_some_and(super::ellipsis::is_noun);
        (the && thing).then_some(())?;
        if out
            .last()
            .is_some_and(|t| matches!(t.text.as_str(), "just" | "right" | "immediately" | "directly"))
        {
            out.pop();
        }
        out.extend(["between", "us", "and"].map(|w| word(w, &tokens[i])));
        Some(i + n)
    })
}

#[cfg(test)]
mod tests {
    use super::super::tokens::tokens;
    use super::*;

    #[test]
    fn plain_words() {
        let said = |t: &str| {
            let list: Vec<String> = plain(&tokens(t)).into_iter().map(|t| t.text).collect();
            list.join(" ")
        };
        assert_eq!(
            said("the 1st 15 m, the 2nd 30 m"),
            "the first 15 m , the second 30 m"
        );
        assert_eq!(
            said("a bus and, if it's not too much trouble, a lorry"),
            "a bus and a truck"
        );
        assert_eq!(said("no more and no fewer than two cars"), "exactly two cars");
        assert_eq!(said("on both the sides"), "on both sides");
        assert_eq!(said("both the bus and the car"), "the bus and the car");
        assert_eq!(said("two vans lhs"), "two vans on the left side");
        assert_eq!(
            said("one more motorcycle, but this one is following us"),
            "one more motorcycle which is following us"
        );
        assert_eq!(said("we see the back of a bus"), "we see a bus");
        assert_eq!(said("at the back of a bus"), "at the back of a bus");
        assert_eq!(said("some ten metres ahead"), "ten metres ahead");
    }
}
