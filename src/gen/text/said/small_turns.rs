//! Small turns of speech of edits, each put into words that other rules read: "one child fewer", "station one of the officers there",
//! "turn him into a jogger on the pavement", "one stays".

use super::super::tokens::{Token, TokenKind};
use super::super::wording::{begins, replaced, rewritten};
use super::words::{first_noun, is, is_place, led, noun_at, number, text, trimmed};

const STAYS_SO: &str = "the rain should go on|the rain goes on|the rain should continue|the rain continues|the rain must go on|the rain can go on|the rain stays|\
    the rain should stay|the rain remains|the snow should go on|the snow goes on|the snow should continue|the snow stays|the snow should stay|the snow remains|\
    the fog should go on|the fog stays|the fog should stay|the fog remains|the storm should go on|the storm stays|the sandstorm stays|the sandstorm should go on|\
    it should keep raining|it should keep snowing|it keeps raining|it keeps snowing";
const WHATEVER: &str = "delete what is|remove what is|erase what is|clear what is|take away what is|delete what stands|remove what stands|delete what drives|remove what drives";
const OFF_THEY_GO: &str = "off they go|away they go|out they go|off it goes|away it goes|out it goes|off he goes|off she goes|away with it then|\
    off they must go|out they must go";
const USES: &str =
    "should use|must use|has to use|have to use|ought to use|uses|should take|must take|is using|are using";

/// A sentence in plainer words.
pub fn plain(tokens: Vec<Token>) -> Vec<Token> {
    let out = replaced(&tokens, STAYS_SO, "");
    let out = replaced(&out, WHATEVER, "delete whatever is");
    let out = replaced(&out, "double park|double parks", "park");
    let out = replaced(&out, OFF_THEY_GO, "remove them");
    let out = cut_from(only_wanted(out));
    let out = one_stays(fewer(besides(out)));
    let out = keeps_beside(too_many(stationed(out)));
    let_use(&uses(&distance_between(&into_there(&out))))
}

/// "cut the green car from the scene": remove it.
fn cut_from(mut tokens: Vec<Token>) -> Vec<Token> {
    let known = is(tokens.get(1), &["the", "both", "all", "every", "that", "those"]);
    let whole = first_noun(&tokens).is_some_and(|n| {
        n.1 == tokens.len() || begins(&tokens[n.1..], "from the|from this|out|out of").is_some()
    });
    if is(tokens.first(), &["cut", "strike", "edit"]) && known && whole {
        tokens[0].text = "remove".into();
    }
    tokens
}

/// "I only want to see one of the workers": keep one of them.
fn only_wanted(tokens: Vec<Token>) -> Vec<Token> {
    const WANTS: &str = "i only want to see|we only want to see|i only want to have|i only want to keep|i only want|we only want|i only need|\
        we only need|i just want|i just need|we just need|i want to see only|i want only|i need only|i want just|we need only";
    match begins(&tokens, WANTS) {
        Some(n)
            if tokens.get(n).is_some_and(|t| number(t).is_some())
                && is(tokens.get(n + 1), &["of"])
                && first_noun(&tokens[n..]).is_some_and(|x| n + x.1 == tokens.len()) =>
        {
            let (a, b) = first_noun(&tokens[n..]).unwrap_or((0, 0));
            let noun = &tokens[n + a..n + b];
            let one = number(&tokens[n]) == Some(1);
            let noun = if one {
                super::topics::singular_of(noun)
            } else {
                noun.to_vec()
            };
            led("there should be", &tokens[0], &[&tokens[n..=n], &noun])
        }
        _ => tokens,
    }
}

/// "there should be one child fewer": one child fewer.
fn fewer(tokens: Vec<Token>) -> Vec<Token> {
    let n = begins(
        &tokens,
        "there should be|there must be|there shall be|i want|we need|i need|make it|let there be",
    );
    // "one cone fewer will do"
    const DOES: &str = "will do|would do|is enough|are enough|is fine|would be fine|is plenty|would be enough|suffices|would suffice|\
        would be better|would be good|would be nice|would be right|is better|will be enough|should do|should be enough";
    let late = (2..tokens.len().min(6)).find(|i| {
        is(tokens.get(i - 1), &["fewer", "less"])
            && begins(&tokens[*i..], DOES).is_some_and(|n| i + n == tokens.len())
    });
    if let Some(late) = late.filter(|_| n.is_none() && number(&tokens[0]).is_some()) {
        return tokens[..late].to_vec();
    }
    match n {
        Some(n)
            if is(tokens.last(), &["fewer", "less"])
                && tokens.get(n).is_some_and(|t| number(t).is_some()) =>
        {
            tokens[n..].to_vec()
        }
        _ => tokens,
    }
}

/// "besides the bus there should also be a tanker": there should be a tanker.
fn besides(tokens: Vec<Token>) -> Vec<Token> {
    let lead = begins(
        &tokens,
        "besides the|in addition to the|aside from the|along with the|beside the|apart from the",
    );
    let Some((_, b)) = lead.and_then(|n| first_noun(&tokens[n..]).map(|x| (n, n + x.1))) else {
        return tokens;
    };
    let rest = trimmed(&tokens[b..]);
    let more = begins(
        rest,
        "there should also be|there must also be|there is also|there are also|there should be|i also want|i want also|i need also|i also need|add",
    );
    // ("in addition to the five cones add two more" means cones)
    let named = more.is_some_and(|m| first_noun(&rest[m..]).is_some());
    if named { rest.to_vec() } else { tokens }
}

/// "one stays": nothing is to be done.
fn one_stays(tokens: Vec<Token>) -> Vec<Token> {
    let many = tokens.first().is_some_and(|t| number(t).is_some());
    let stays = begins(
        tokens.get(1..).unwrap_or(&[]),
        "stays|stay|remains|remain|is left|are left|stays there|stay there|stays behind|stay behind|stays where it is|stay where they are|may stay|can stay",
    );
    if many && stays.is_some_and(|n| n + 1 == tokens.len()) {
        Vec::new()
    } else {
        tokens
    }
}

/// "station one of the officers next to the barrier": one that is there.
fn stationed(mut tokens: Vec<Token>) -> Vec<Token> {
    let known = begins(
        tokens.get(1..).unwrap_or(&[]),
        "one of the|two of the|three of the|the|both|all the|all",
    )
    .is_some();
    if known && is(tokens.first(), &["station", "post", "position", "install"]) {
        tokens[0].text = "move".into();
    }
    tokens
}

/// "there are too many kids, leave just one": keep one.
fn too_many(tokens: Vec<Token>) -> Vec<Token> {
    let lead = begins(
        &tokens,
        "there are too many|there are far too many|there are way too many|we have too many|i see too many|too many",
    );
    let Some((n, (_, b))) = lead.and_then(|n| Some((n, first_noun(&tokens[n..])?))) else {
        return tokens;
    };
    let rest = trimmed(&tokens[n + b..]);
    let keeps = begins(
        rest,
        "leave just|leave only|leave|keep just|keep only|keep|just|only|so leave only|so leave just|so keep only|let just|let only",
    );
    match keeps.and_then(|k| rest.get(k).map(|t| (k, t))) {
        Some((k, many))
            if number(many).is_some()
                && (k + 1 == rest.len() || is(rest.get(k + 1), &["of", "there", "here", "standing"])) =>
        {
            led(
                "keep only",
                &tokens[0],
                &[std::slice::from_ref(many), &tokens[n..n + b]],
            )
        }
        _ => tokens,
    }
}

/// "move the car, and keep the officer standing next to it": he goes along.
fn keeps_beside(tokens: Vec<Token>) -> Vec<Token> {
    rewritten(&tokens, |i, out| {
        let after =
            i > 3 && (is(out.last(), &["and"]) || out.last().is_some_and(|t| t.kind == TokenKind::Comma));
        let keeps =
            after && is(tokens.get(i), &["keep", "leave"]) && is(tokens.get(i + 1), &["the", "both", "all"]);
        let (_, b) = keeps.then(|| first_noun(&tokens[i + 1..]))?.filter(|n| n.0 < 4)?;
        let end = i + 1 + b;
        let stands = usize::from(is(
            tokens.get(end),
            &["standing", "waiting", "parked", "walking", "right"],
        ));
        let rest = &tokens[end + stands..];
        let beside = begins(rest, "next to|beside|near|behind|in front of|close to|by|with")?;
        is(rest.get(beside), &["it", "him", "her", "them"]).then_some(())?;
        out.extend(led("put", &tokens[i], &[&tokens[i + 1..end]]));
        Some(end + stands)
    })
}

/// "turn the cyclist into a jogger on the right pavement": and he is there.
fn into_there(tokens: &[Token]) -> Vec<Token> {
    let turns = is(
        tokens.first(),
        &["turn", "change", "convert", "transform", "make"],
    );
    let into = tokens.iter().position(|t| text(t) == "into").filter(|_| turns);
    let Some((a, b)) = into.and_then(|k| first_noun(&tokens[k..]).map(|x| (k + x.0, k + x.1))) else {
        return tokens.to_vec();
    };
    let near = a < into.unwrap_or(0) + 4;
    let there = begins(&tokens[b..], "on the left|on the right|in the left|in the right|in my lane|in our lane|in the oncoming lane|on the zebra|on the crossing").is_some()
        && is_place(&tokens[b..]);
    if !near
        || !there
        || tokens[b..]
            .iter()
            .any(|t| is(Some(t), &["and", "but"]) || t.kind == TokenKind::Comma)
    {
        return tokens.to_vec();
    }
    let mut out = tokens[..b].to_vec();
    out.extend(led("and put it", &tokens[b], &[&tokens[b..]]));
    out
}

/// "the distance between the police car and my rear": to the police car.
fn distance_between(tokens: &[Token]) -> Vec<Token> {
    rewritten(tokens, |i, out| {
        let n = begins(
            &tokens[i..],
            "the distance between the|the gap between the|the space between the|distance between the|gap between the",
        )?;
        let (_, b) = first_noun(&tokens[i + n..]).filter(|x| x.0 < 4)?;
        let end = i + n + b;
        let ours = begins(
            &tokens[end..],
            "and me|and us|and my rear|and our rear|and my car|and our car|and my bumper|and my back|and my front|and our bumper|and my vehicle|and our vehicle|and the ego vehicle|and my tail",
        )?;
        out.extend(led("the distance to the", &tokens[i], &[&tokens[i + n..end]]));
        Some(end + ours)
    })
}

/// "the cyclist should use the right sidewalk": be on it.
fn uses(tokens: &[Token]) -> Vec<Token> {
    rewritten(tokens, |i, out| {
        let n = begins(&tokens[i..], USES).filter(|_| {
            out.last()
                .is_some_and(|t| noun_at(std::slice::from_ref(t)).is_some())
        })?;
        let strip = begins(
            &tokens[i + n..],
            "the left|the right|the oncoming|the opposite|the other|the sidewalk|the pavement|the zebra|the crossing|the roadside|my lane|our lane",
        );
        // ("take the left one" tells what, "take the bus" whom)
        let place = strip.filter(|_| {
            (i + n..tokens.len().min(i + n + 4)).any(|k| {
                is(
                    tokens.get(k),
                    &[
                        "lane", "sidewalk", "pavement", "zebra", "crossing", "roadside", "kerb", "curb",
                        "footpath",
                    ],
                )
            })
        })?;
        let lane = (i + n..i + n + place + 2).any(|k| is(tokens.get(k), &["lane"]));
        out.extend(led(
            if lane { "should be in" } else { "should be on" },
            &tokens[i],
            &[],
        ));
        Some(i + n)
    })
}

/// "let the bus use the left lane and the car ours": move each there.
fn let_use(tokens: &[Token]) -> Vec<Token> {
    let lets = is(tokens.first(), &["let", "have", "make"])
        && is(tokens.get(1), &["the", "both", "all", "that", "my"]);
    let used =
        first_noun(tokens).filter(|x| lets && x.0 < 5 && is(tokens.get(x.1), &["use", "take", "have"]));
    let Some((_, b)) = used else {
        return tokens.to_vec();
    };
    let strip = |t: &Token| {
        is(
            Some(t),
            &[
                "lane", "sidewalk", "pavement", "roadside", "kerb", "curb", "footpath",
            ],
        )
    };
    let end = (b..tokens.len().min(b + 6)).find(|k| strip(&tokens[*k]));
    let Some(end) = end.filter(|_| is(tokens.get(b + 1), &["the", "my", "our"])) else {
        return tokens.to_vec();
    };
    let mut out = led(
        "move",
        &tokens[0],
        &[&tokens[1..b], &led("to", &tokens[b], &[&tokens[b + 1..=end]])],
    );
    let rest = &tokens[end + 1..];
    // the other one has its own
    let next = &rest[usize::from(is(rest.first(), &["and"]))..];
    let other =
        first_noun(next).filter(|x| next.len() < rest.len() && x.0 < 4 && is(next.first(), &["the", "that"]));
    match other {
        Some((_, e)) if is(next.get(e), &["ours", "mine", "the", "my", "our"]) => {
            out.extend(led(
                "and move",
                &rest[0],
                &[&next[..e], &led("to", &rest[0], &[])],
            ));
            if is(next.get(e), &["ours", "mine"]) {
                out.extend(led("our", &next[e], &[&tokens[end..=end], &next[e + 1..]]));
            } else {
                out.extend_from_slice(&next[e..]);
            }
        }
        _ => out.extend_from_slice(rest),
    }
    out
}

#[cfg(test)]
mod tests {
    use super::super::super::tokens::tokens;
    use super::*;

    #[test]
    fn small_turns() {
        let said = |t: &str| {
            let list: Vec<String> = plain(tokens(t)).into_iter().map(|t| t.text).collect();
            list.join(" ")
        };
        assert_eq!(said("there should be one child fewer"), "one child fewer");
        assert_eq!(said("one stays"), "");
        assert_eq!(
            said("there are too many kids, leave just one"),
            "keep only one kids"
        );
        assert_eq!(
            said("the cyclist should use the right sidewalk"),
            "the cyclist should be on the right sidewalk"
        );
        assert_eq!(
            said("increase the gap between the van and me to 30 m"),
            "increase the distance to the van to 30 m"
        );
        assert_eq!(said("take the bus and leave"), "take the bus and leave");
    }
}
