//! What is said by the way: "this panel works better without the cyclist", "the fleet has grown: six parked cars now", "those two
//! cars? Gone.", "put that one behind me", "the truck goes out of service".

use super::super::tokens::{Token, TokenKind};
use super::super::wording::rewritten;
use super::Talk;
use super::lists::HELPERS;
use super::some_of::removes;
use super::words::{find, first_noun, has_noun, is, is_finite, leads, led, number, text, trimmed, word};

/// Names of what is seen as a whole.
const PICTURE: &[&str] = &[
    "panel",
    "frame",
    "picture",
    "image",
    "shot",
    "scene",
    "view",
    "drawing",
    "sketch",
    "still",
    "illustration",
    "diagram",
    "slide",
    "composition",
    "lesson",
    "exercise",
    "example",
    "setting",
    "layout",
    "situation",
    "story",
    "thing",
    "plan",
];

/// A sentence in plainer words.
pub fn plain(tokens: Vec<Token>, talk: &Talk<'_>) -> Vec<Token> {
    let out = works(tokens);
    let out = in_picture(&out);
    let out = out_of_picture(&out);
    let out = that_one(&out);
    let out = out_of_service(out, talk);
    let out = in_the_way(out, talk);
    no_and_just(nothing_happens(out))
}

/// "nothing happens to the white car": nothing is to be done.
fn nothing_happens(tokens: Vec<Token>) -> Vec<Token> {
    let n = leads(
        &tokens,
        &[
            "nothing happens to",
            "nothing should happen to",
            "nothing is to happen to",
            "nothing changes about",
            "nothing changes for",
            "nothing should change about",
            "nothing is to be changed about",
            "nothing is changed about",
            "nothing must happen to",
        ],
    );
    match n {
        Some(n) if first_noun(&tokens[n..]).is_some_and(|x| n + x.1 == tokens.len()) => led(
            "leave",
            &tokens[0],
            &[&tokens[n..], &led("as it is", &tokens[0], &[])],
        ),
        _ => tokens,
    }
}

fn ends(t: Option<&Token>) -> bool {
    t.is_none_or(|t| matches!(t.kind, TokenKind::Comma | TokenKind::Mark | TokenKind::Stop))
}

fn opens(tokens: &[Token], i: usize) -> bool {
    i == 0 || ends(tokens.get(i - 1)) || is(tokens.get(i - 1), &["and", "but", "then", "so", "please", "now"])
}

/// "this panel works better without the cyclist", "it would look best with a bus behind me": with or without it.
fn works(tokens: Vec<Token>) -> Vec<Token> {
    const VERBS: &[&str] = &[
        "works",
        "work",
        "reads",
        "read",
        "looks",
        "look",
        "plays",
        "play",
        "functions",
        "function",
        "goes",
        "is",
        "be",
        "feels",
        "feel",
        "comes across",
        "come across",
        "does",
        "do",
    ];
    const HOW: &[&str] = &[
        "better",
        "best",
        "well",
        "fine",
        "nicer",
        "cleaner",
        "clearer",
        "simpler",
        "stronger",
        "nicely",
        "perfectly",
        "good",
        "great",
        "right",
    ];
    let it = usize::from(is(tokens.first(), &["it", "this", "that", "all", "everything"]));
    let named = is(tokens.first(), &["the", "this", "that", "our", "my"]) && is(tokens.get(1), PICTURE);
    let mut k = if named { 2 } else { it };
    if k == 0 {
        return tokens;
    }
    while is(
        tokens.get(k),
        &[
            "would",
            "will",
            "should",
            "could",
            "might",
            "may",
            "also",
            "really",
            "always",
            "just",
            "certainly",
        ],
    ) {
        k += 1;
    }
    let Some(n) = leads(&tokens[k..], VERBS) else {
        return tokens;
    };
    k += n;
    while is(
        tokens.get(k),
        &[
            "even", "much", "far", "a", "lot", "bit", "just", "as", "so", "quite",
        ],
    ) {
        k += 1;
    }
    let Some(n) = leads(&tokens[k..], HOW) else {
        return tokens;
    };
    k += n;
    k += usize::from(ends(tokens.get(k)) && k < tokens.len());
    match tokens.get(k).map(text) {
        Some("without") => led("remove", &tokens[k], &[&tokens[k + 1..]]),
        Some("with")
            if tokens.get(k + 1).is_some_and(|t| {
                number(t).is_some() || is(Some(t), &["a", "an", "another", "some", "more"])
            }) =>
        {
            led("add", &tokens[k], &[&tokens[k + 1..]])
        }
        Some("if" | "when" | "once") => tokens[k + 1..].to_vec(),
        _ => tokens,
    }
}

/// "no taxi in this panel": in the scene.
fn in_picture(tokens: &[Token]) -> Vec<Token> {
    rewritten(tokens, |i, out| {
        let seen = is(tokens.get(i), &["in", "from", "on"])
            && is(tokens.get(i + 1), &["this", "that"])
            && is(tokens.get(i + 2), PICTURE)
            && !is(tokens.get(i + 2), &["thing", "plan"]);
        (seen && (ends(tokens.get(i + 3)) || is(tokens.get(i + 3), &["and", "any"])) && has_noun(out))
            .then_some(i + 3)
    })
}

/// "has walked out of the frame", "drives out of the picture": it is gone.
fn out_of_picture(tokens: &[Token]) -> Vec<Token> {
    const GOES: &[&str] = &[
        "walked",
        "driven",
        "gone",
        "ridden",
        "moved",
        "stepped",
        "run",
        "rolled",
        "strolled",
        "wandered",
        "cycled",
        "pulled",
        "got",
        "gotten",
        "jogged",
        "disappeared",
        "passed",
    ];
    const GOING: &[&str] = &[
        "walks",
        "drives",
        "goes",
        "rides",
        "moves",
        "steps",
        "runs",
        "rolls",
        "strolls",
        "wanders",
        "cycles",
        "pulls",
        "walk",
        "drive",
        "go",
        "ride",
        "move",
        "step",
        "roll",
        "stroll",
        "wander",
        "cycle",
        "pull",
        "drove",
        "went",
        "rode",
        "ran",
        "walked",
        "rolled",
        "moved",
        "stepped",
        "jogs",
        "jog",
        "disappears",
        "disappear",
    ];
    rewritten(tokens, |i, out| {
        let n = leads(&tokens[i + 1..], &["out of", "off", "from"]).filter(|_| i > 0)?;
        let the = i + 1 + n;
        let end = the + usize::from(is(tokens.get(the), &["the", "this", "our", "my"]));
        let seen = end > the
            && is(
                tokens.get(end),
                &[
                    "frame", "picture", "image", "shot", "scene", "view", "panel", "screen", "sight",
                ],
            )
            || n == 2 && is(tokens.get(end), &["view", "sight", "shot", "frame"]);
        let over =
            is(tokens.get(i), GOES) && is(out.last(), &["has", "have", "had", "already", "just", "since"]);
        if !seen || !(over || is(tokens.get(i), GOING)) {
            return None;
        }
        // ("move the bus out of the picture", "let it drive out of the frame" are orders)
        let orders = opens(tokens, i) || is(out.last(), &["to"]);
        if orders {
            return None;
        }
        out.push(word(if over { "gone" } else { "leaves" }, &tokens[i]));
        Some(end + 1)
    })
}

/// "put that one 8 m behind me": it.
fn that_one(tokens: &[Token]) -> Vec<Token> {
    const VERBS: &[&str] = &[
        "put", "place", "move", "bring", "set", "have", "let", "turn", "make", "paint", "remove", "delete",
        "take", "shift", "park", "send", "drive", "erase", "rotate", "push", "pull",
    ];
    rewritten(tokens, |i, out| {
        let n = leads(
            &tokens[i..],
            &[
                "that one",
                "this one",
                "the new one",
                "that new one",
                "this new one",
            ],
        )?;
        let new = n == 3;
        let after = is(out.last(), VERBS);
        let subject = opens(tokens, i)
            && tokens
                .get(i + n)
                .is_some_and(|t| HELPERS.contains(&text(t)) || is_finite(text(t), false));
        // ("the new one" of a sentence that names others is told by what it says)
        (after && i > 2 || subject && new && i > 2).then(|| {
            out.push(word("it", &tokens[i]));
            i + n
        })
    })
}

/// "take the bus out of service": it goes.
fn out_of_service(tokens: Vec<Token>, talk: &Talk<'_>) -> Vec<Token> {
    const OUT: &[&str] = &[
        "out of service",
        "out of action",
        "out of commission",
        "out of operation",
        "out of circulation",
        "out of traffic",
        "out of play",
        "out of the equation",
        "out of use",
        "off duty",
        "off the streets",
    ];
    rewritten(&tokens, |i, out| {
        let takes = opens(&tokens, i) && is(tokens.get(i), &["take", "put", "pull"]);
        let (_, b) = takes.then(|| first_noun(&tokens[i + 1..]))?.filter(|x| x.0 < 5)?;
        let from = i + 1 + b;
        // (where it is may stand between)
        let at = (from..tokens.len().min(from + 8)).find(|k| leads(&tokens[*k..], OUT).is_some())?;
        let np = &tokens[i + 1..at];
        let whole = !np.iter().any(|t| ends(Some(t)) || is(Some(t), &["and"])) && talk.fits(np) > 0;
        let n = leads(&tokens[at..], OUT).filter(|_| whole)?;
        out.extend(led("remove", &tokens[i], &[np]));
        Some(at + n)
    })
}

/// "with all those cones in the way, clear them out": they go.
fn in_the_way(tokens: Vec<Token>, talk: &Talk<'_>) -> Vec<Token> {
    let found = find(
        &tokens,
        &[
            "in the way",
            "in my way",
            "in our way",
            "blocking the way",
            "in the road",
            "standing around",
        ],
    );
    let Some((i, n)) = found else { return tokens };
    let Some(from) = (0..i).rev().find(|k| {
        is(tokens.get(*k), &["with", "of", "because"])
            && is(tokens.get(k + 1), &["all", "the", "those", "these", "that"])
    }) else {
        return tokens;
    };
    let np = &tokens[from + 1..i];
    let mut k = i + n;
    while tokens.get(k).is_some_and(|t| ends(Some(t)))
        || is(tokens.get(k), &["so", "please", "and", "just", "now"])
    {
        k += 1;
    }
    let orders = removes(tokens.get(k)) || is(tokens.get(k), &["get"]);
    let mut end = k + 1;
    while is(tokens.get(end), &["rid", "of"]) {
        end += 1;
    }
    let them = orders && is(tokens.get(end), &["them", "it", "him", "her"]);
    end += 1;
    while is(
        tokens.get(end),
        &["out", "away", "off", "please", "all", "up", "now"],
    ) {
        end += 1;
    }
    if !them || end < tokens.len() || first_noun(np).is_none_or(|x| x.1 != np.len()) || talk.fits(np) == 0 {
        return tokens;
    }
    led("remove", &tokens[0], &[np])
}

/// "no taxi and no barrier here, just me and that truck": what stays needs no word.
fn no_and_just(tokens: Vec<Token>) -> Vec<Token> {
    if !is(tokens.first(), &["no"]) {
        return tokens;
    }
    let last = (2..tokens.len()).rev().find(|i| {
        tokens[*i].kind == TokenKind::Comma && is(tokens.get(i + 1), &["just", "only", "nothing", "nobody"])
    });
    let Some(i) = last else { return tokens };
    let rest = &tokens[i + 1..];
    let known = rest.iter().any(|t| {
        is(
            Some(t),
            &["the", "that", "those", "my", "our", "this", "me", "us"],
        )
    });
    let fresh = rest
        .iter()
        .any(|t| number(t).is_some() || is(Some(t), &["a", "an", "some"]));
    if !known || fresh || rest.iter().any(|t| HELPERS.contains(&text(t))) {
        return tokens;
    }
    // "no taxi and no barrier": one denial for both
    let here = trimmed(&tokens[..i]);
    let here = match here.last() {
        Some(t) if is(Some(t), &["here", "there"]) => &here[..here.len() - 1],
        _ => here,
    };
    let denied: Vec<Token> = rewritten(here, |k, out| {
        (is(here.get(k), &["no"]) && k > 0 && is(out.last(), &["and", "or"])).then(|| {
            out.push(word("all", &here[k]));
            k + 1
        })
    });
    led("remove all", &tokens[0], &[&denied[1..]])
}

#[cfg(test)]
mod tests {
    use super::super::super::tokens::tokens;
    use super::*;

    #[test]
    fn turns_of_speech() {
        let said = |list: Vec<Token>| {
            let list: Vec<String> = list.into_iter().map(|t| t.text).collect();
            list.join(" ")
        };
        assert_eq!(
            said(works(tokens("this panel works better without the cyclist"))),
            "remove the cyclist"
        );
        assert_eq!(
            said(no_and_just(tokens(
                "no taxi and no barrier here, just me and that truck"
            ))),
            "remove all taxi and all barrier"
        );
        assert_eq!(
            said(out_of_picture(&tokens("the man has walked out of the frame"))),
            "the man has gone"
        );
    }
}
