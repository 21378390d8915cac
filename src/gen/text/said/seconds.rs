//! One more of what is there, told by the one that is there: "a second bus follows the first one", "second taxi right behind the
//! first", "copy the truck and put the copy behind us", "one more cyclist is coming, he rides beside the first one".

use super::super::foremost::ordinal;
use super::super::lexicon::plural;
use super::super::tokens::{Token, TokenKind};
use super::Talk;
use super::words::{first_noun, is, is_finite, is_place, leads, led, number, text, trimmed};

const FIRST: &[&str] = &[
    "the first one",
    "the first",
    "the other one",
    "the existing one",
    "the old one",
    "the one already there",
    "the one that is already there",
    "the one that is there",
    "the present one",
    "the original one",
    "the original",
];
const REST: &[&str] = &[
    "the others",
    "the other ones",
    "the rest",
    "the first ones",
    "the existing ones",
];
const COMES: &[&str] = &[
    "is coming",
    "comes",
    "is coming along",
    "comes along",
    "is coming up",
    "is here",
    "is there",
    "has come",
    "has arrived",
    "has joined us",
    "has joined",
    "has turned up",
    "has shown up",
    "has appeared",
    "arrives",
    "appears",
    "turns up",
    "shows up",
    "came",
    "arrived",
    "joins us",
    "is arriving",
    "is added",
];
const COPY: &[&str] = &["copy", "duplicate", "clone", "replica", "double", "twin"];

/// A sentence (without its stop) in plainer words.
pub fn plain(tokens: Vec<Token>, talk: &Talk<'_>) -> Vec<Token> {
    one_more(who_comes(companion(copied(tokens, talk), talk), talk), talk)
}

fn joins(t: Option<&Token>) -> bool {
    t.is_none_or(|t| t.kind != TokenKind::Word) || is(t, &["and", "then", "now"])
}

/// "one more bus is coming, it follows the first one": it does; "the ambulance has come and stands there": one that was not there.
fn who_comes(tokens: Vec<Token>, talk: &Talk<'_>) -> Vec<Token> {
    let Some((_, b)) = first_noun(&tokens).filter(|n| n.0 < 4) else {
        return tokens;
    };
    let np = &tokens[..b];
    let the = is(np.first(), &["the"]) && talk.has_none(np);
    let fresh =
        is(np.first(), &["a", "an", "another"]) || number(&np[0]) == Some(1) && is(np.get(1), &["more"]);
    let Some(n) = leads(&tokens[b..], COMES).filter(|_| the || fresh) else {
        return tokens;
    };
    let mut k = b + n;
    while k < tokens.len() && (tokens[k].kind == TokenKind::Comma || is(tokens.get(k), &["and"])) {
        k += 1;
    }
    let he = is(
        tokens.get(k),
        &["it", "he", "she", "who", "which", "that", "this"],
    );
    let says = k + usize::from(he);
    let verb = tokens
        .get(says)
        .is_some_and(|t| is_finite(text(t), false) || is(Some(t), &["is", "should", "will"]));
    if k == b + n || !verb {
        return tokens;
    }
    let mut who = np.to_vec();
    if the {
        who[0].text = "another".into();
    }
    [&who, &tokens[says..]].concat()
}

/// "the cyclist gets a companion riding behind him": another cyclist there.
fn companion(tokens: Vec<Token>, talk: &Talk<'_>) -> Vec<Token> {
    const GETS: &[&str] = &[
        "gets",
        "has",
        "should have",
        "should get",
        "needs",
        "now has",
        "has got",
        "is given",
        "receives",
        "finds",
        "gets joined by",
        "is joined by",
    ];
    const MATES: &[&str] = &[
        "a companion",
        "a partner",
        "a mate",
        "a buddy",
        "a twin",
        "a second of its kind",
        "a peer",
        "a fellow",
        "company",
        "a colleague",
    ];
    let Some((a, b)) = first_noun(&tokens).filter(|n| n.0 < 4 && is(tokens.first(), &["the", "my", "that"]))
    else {
        return tokens;
    };
    let gets = leads(&tokens[b..], GETS).and_then(|n| leads(&tokens[b + n..], MATES).map(|m| b + n + m));
    let Some(from) = gets.filter(|_| talk.fits(&tokens[..b]) == 1) else {
        return tokens;
    };
    let verb = usize::from(is(
        tokens.get(from),
        &[
            "riding", "driving", "walking", "standing", "parked", "waiting", "going", "right", "directly",
        ],
    ));
    let verb = verb + usize::from(verb == 1 && is(tokens.get(from + 1), &["right", "directly", "just"]));
    let place = &tokens[from + verb..];
    let him = place.iter().position(|t| is(Some(t), &["him", "her", "it"]));
    let Some(k) = him.filter(|k| is_place(place) && joins(place.get(k + 1))) else {
        return tokens;
    };
    let another = led("add another", &tokens[0], &[&tokens[a..b]]);
    [&another, &place[..k], &tokens[..b], &place[k + 1..]].concat()
}

/// "a second bus follows the first one": add another one following the bus.
fn one_more(tokens: Vec<Token>, talk: &Talk<'_>) -> Vec<Token> {
    let lead = leads(&tokens, &["and", "also", "then", "please", "now"]).unwrap_or(0);
    const ADDS: &[&str] = &[
        "add",
        "put",
        "place",
        "insert",
        "make",
        "create",
        "i need",
        "i want",
        "we need",
        "there is",
        "there should be",
        "give me",
        "there must be",
        "i would like",
        "id like",
        "show",
    ];
    let adds = leads(&tokens[lead..], ADDS).unwrap_or(0);
    let body = &tokens[lead + adds..];
    let article = usize::from(is(body.first(), &["a", "an", "one"]));
    let nth = body.get(article).and_then(|t| ordinal(text(t)));
    let more = is(body.get(article), &["more"]) && article == 1;
    let other = article == 0 && is(body.first(), &["another"]);
    if !(nth.is_some_and(|n| n > 1) || more || other) {
        return tokens;
    }
    let from = article + 1;
    let Some((a, b)) = first_noun(&body[from.min(body.len())..]).filter(|n| n.0 < 3) else {
        return tokens;
    };
    let np = &body[from..from + b];
    let noun = &np[a..];
    let there = talk.fits(noun);
    // ("second car" is one that is there, where there are as many)
    if there == 0 || nth.is_some_and(|n| article == 0 && adds == 0 && n <= there) {
        return tokens;
    }
    let rest = &body[from + b..];
    let mut out = led("add another", &tokens[0], &[np]);
    // ("third pedestrian, same sidewalk": with the others, where more of a kind come to stand anyhow)
    let tail = trimmed(rest);
    let same = leads(
        tail,
        &["same", "the same", "on the same", "in the same", "at the same"],
    );
    if same.is_some_and(|n| {
        n + 1 == tail.len()
            && is(
                tail.last(),
                &["lane", "sidewalk", "pavement", "side", "edge", "street"],
            )
    }) {
        return out;
    }
    let mut pointed = false;
    let mut k = 0;
    while k < rest.len() {
        let first = leads(&rest[k..], FIRST)
            .filter(|n| there == 1 && joins(rest.get(k + n)) || is_place(&rest[k + n..]));
        let first = first.filter(|_| there == 1);
        let others = leads(&rest[k..], REST);
        // ("between the other two")
        let two = leads(
            &rest[k..],
            &[
                "the other two",
                "the first two",
                "the two others",
                "the existing two",
            ],
        )
        .filter(|n| there == 2 && joins(rest.get(k + n)));
        // ("the first bus", "the other cyclist")
        let named = is(rest.get(k), &["the"])
            && is(rest.get(k + 1), &["first", "other", "existing", "old"])
            && rest
                .get(k + 2)
                .is_some_and(|t| noun.last().is_some_and(|n| text(t) == text(n)));
        if let Some(n) = first {
            // ("with the first one")
            if is(out.last(), &["with"]) {
                out.pop();
                out.extend(led("next to", &rest[k], &[]));
            }
            out.extend(led("the", &rest[k], &[noun]));
            k += n;
        } else if named && there == 1 {
            out.extend(led("the", &rest[k], &[&rest[k + 2..k + 3]]));
            k += 3;
        } else if let Some(n) = two {
            let last = &noun[noun.len() - 1];
            out.extend(led(
                "the two",
                &rest[k],
                &[&noun[..noun.len() - 1], &led(&plural(text(last)), last, &[])],
            ));
            k += n;
        } else if let Some(n) = others {
            out.extend(led("the", &rest[k], &[&noun[..noun.len() - 1]]));
            let last = &noun[noun.len() - 1];
            let many = if there == 1 {
                text(last).to_string()
            } else {
                plural(text(last))
            };
            out.extend(led(&many, last, &[]));
            k += n;
        } else {
            out.push(rest[k].clone());
            k += 1;
            continue;
        }
        pointed = true;
    }
    let verb = rest
        .first()
        .is_some_and(|t| is_finite(text(t), false) || is(Some(t), &["is", "should", "has", "will", "must"]));
    if !verb {
        // a note, which names where: "second taxi, right behind the first"
        // ("shows up on the left sidewalk" has a verb of its own)
        let opens = rest.first().is_some_and(|t| {
            t.kind == TokenKind::Comma
                || is_place(rest)
                || is(Some(t), &["with", "parked"])
                || text(t).ends_with("ing")
                || is_place(&rest[1..])
                    && is(
                        Some(t),
                        &["right", "directly", "just", "close", "also", "immediately"],
                    )
        });
        let placed = opens && (0..rest.len()).any(|k| is_place(&rest[k..])) || pointed;
        return if placed && (pointed || nth.is_some()) {
            out
        } else {
            tokens
        };
    }
    if !pointed {
        return tokens;
    }
    let at = np.len() + 2;
    let follows = leads(
        rest,
        &[
            "follows",
            "is following",
            "should follow",
            "trails",
            "is trailing",
            "tails",
        ],
    );
    let tail = out[at..].to_vec();
    match follows {
        Some(n) => [&out[..at], &led("following", &rest[0], &[&tail[n..]])].concat(),
        None => [&led("another", &tokens[0], &[np]), &tail[..]].concat(),
    }
}

/// "copy the truck and put the copy behind us", "make a copy of the bus behind the car": another one there.
fn copied(tokens: Vec<Token>, talk: &Talk<'_>) -> Vec<Token> {
    let made = leads(
        &tokens,
        &[
            "make", "create", "add", "put", "place", "insert", "i want", "i need",
        ],
    )
    .filter(|n| is(tokens.get(*n), &["a", "one", "another"]) && is(tokens.get(n + 1), COPY))
    .filter(|n| is(tokens.get(n + 2), &["of"]))
    .map(|n| n + 3);
    let Some(from) =
        made.or_else(|| is(tokens.first(), &["copy", "duplicate", "clone", "replicate"]).then_some(1))
    else {
        return tokens;
    };
    let known = is(tokens.get(from), &["the", "that", "this", "my"]);
    let Some((_, b)) = first_noun(&tokens[from..]).filter(|n| known && n.0 < 4) else {
        return tokens;
    };
    if talk.fits(&tokens[from..from + b]) == 0 {
        return tokens;
    }
    let np = &tokens[from + 1..from + b];
    let rest = &tokens[from + b..];
    let another = led("add another", &tokens[0], &[np]);
    // ("... and put the copy behind us")
    let later = (0..rest.len()).find_map(|i| {
        let link = rest[i].kind != TokenKind::Word || is(rest.get(i), &["and", "then"]);
        link.then_some(())?;
        let open = trimmed(&rest[i..]);
        let verb = leads(
            open,
            &[
                "put", "place", "move", "set", "park", "position", "stick", "have", "let", "insert",
            ],
        );
        let k = verb.unwrap_or(0);
        let the = usize::from(is(open.get(k), &["the", "that", "this", "its"]));
        let copy = is(open.get(k + the), COPY) && the == 1
            || the == 0 && verb.is_some() && is(open.get(k), &["it"])
            || leads(&open[k..], &["the second one", "the new one", "the other one"]).is_some();
        let n = leads(&open[k..], &["the second one", "the new one", "the other one"]).unwrap_or(the + 1);
        copy.then(|| (verb, &open[(k + n).min(open.len())..]))
    });
    match later {
        Some((verb, place)) if is_place(place) => {
            let parked = if verb.is_some_and(|_| rest.iter().any(|t| text(t) == "park")) {
                led("parked", &tokens[0], &[])
            } else {
                Vec::new()
            };
            [&another, &parked, &there(place)[..]].concat()
        }
        Some((None, says))
            if says
                .first()
                .is_some_and(|t| is_finite(text(t), false) || is(Some(t), &["is", "should"])) =>
        {
            match leads(
                says,
                &["goes", "should go", "belongs", "comes", "should be", "is"],
            )
            .filter(|n| is_place(&says[*n..]))
            {
                Some(n) => [&another, &there(&says[n..])[..]].concat(),
                None => [&another[1..], says].concat(),
            }
        }
        Some(_) => tokens,
        None if rest.is_empty() || is_place(rest) => [&another, &there(rest)[..]].concat(),
        None => tokens,
    }
}

/// Where a copy comes to: "into the left lane" is in it.
fn there(place: &[Token]) -> Vec<Token> {
    match leads(place, &["to", "into", "onto"]) {
        Some(n) if !is(place.get(n), &["my", "our"]) || is(place.get(n + 1), &["lane"]) => led(
            if is(place.first(), &["onto"]) { "on" } else { "in" },
            &place[0],
            &[&place[n..]],
        ),
        _ => place.to_vec(),
    }
}
