//! What is wished by way of how one would like it: "I'd be happier with the bus 8 m nearer", "I could live without the car on
//! the left", "it would look better with the taxi gone"; and ", with the car behind us replaced by a bus".

use super::super::tokens::{Token, TokenKind};
use super::Talk;
use super::lists::List;
use super::words::{find, first_noun, has_noun, is, is_place, leads, led, number, text};
use std::sync::LazyLock;

/// How one likes it.
static LIKING: List = LazyLock::new(|| {
    "\
    happier|happy|better|safer|safe|nicer|nice|glad|comfortable|easier|clearer|prettier|calmer|relaxed|\
    ease|content|best|good|great|perfect|ideal|more|prefer|like|love|live|manage|cope|get|rather|\
    pleased|cleaner|simpler|realistic|fine|believable|convincing|useful|interesting|do|suit|please|\
    preferable|satisfied"
        .split('|')
        .collect()
});
/// Whose liking it is, and what stands around it.
static AROUND: List = LazyLock::new(|| {
    "\
    i|we|id|wed|it|itd|that|this|the|would|will|could|can|might|be|feel|am|are|is|look|looks|work|works|\
    seem|seems|much|far|a|lot|bit|even|at|off|to|me|us|have|see|scene|picture|shot|view|test|whole|\
    thing|situation|street|road|really|definitely|quite|all|also|by|just|image|everything|so|lets|let|\
    makes|make|should|little|way|very|being|for|my|our|same|again|show|want|need|give|now|exactly|but|\
    please|only|once"
        .split('|')
        .collect()
});
/// What has become of something, after "with".
static BECAME: List = LazyLock::new(|| {
    "\
    replaced|removed|gone|turned|deleted|swapped|exchanged|moved|shifted|painted|converted|changed|\
    taken|substituted|relocated|transformed|erased|missing|repainted|rotated|traded"
        .split('|')
        .collect()
});

fn known(t: Option<&Token>) -> bool {
    is(
        t,
        &[
            "the", "that", "this", "these", "those", "my", "both", "all", "our",
        ],
    )
}

/// A sentence (without its stop) that says it plainly.
pub fn plain(tokens: Vec<Token>, talk: &Talk<'_>) -> Vec<Token> {
    let mut tokens = tokens;
    // "couldn't the truck be a digger?"
    if is(
        tokens.first(),
        &["couldnt", "cant", "shouldnt", "wouldnt", "mightnt"],
    ) && known(tokens.get(1))
    {
        tokens[0].text = "could".into();
    }
    let tokens = super::super::wording::replaced(
        &tokens,
        "the night is over|night is over|the night has passed|the night has ended|it should not be night|it shouldnt be night|\
         it must not be night|it is no longer night|its no longer night|it is not night any more|it isnt night any more|\
         it is not night|it isnt night|its not night|the darkness is over|it should not be dark|it shouldnt be dark",
        "make it day",
    );
    let tokens = nothing_there(same_in(tokens));
    absolute(liked(got(pulled_over(tokens, talk), talk), talk), talk)
}

/// "get the car over to the left edge", "have the bus 8 m closer", "get a scooter in between us and the bus".
fn got(mut tokens: Vec<Token>, talk: &Talk<'_>) -> Vec<Token> {
    if !is(tokens.first(), &["get", "have"]) {
        return tokens;
    }
    let get = is(tokens.first(), &["get"]);
    let me = usize::from(is(tokens.get(1), &["me", "us"]));
    let Some((a, b)) = first_noun(&tokens[1 + me..])
        .filter(|x| x.0 < 4)
        .map(|x| (x.0 + 1 + me, x.1 + 1 + me))
    else {
        return tokens;
    };
    let rest = &tokens[b..];
    // (what is to be done to it is another turn of speech)
    let does = rest.iter().any(|t| {
        BECAME.contains(&text(t))
            || text(t).ends_with("ing")
            || is(Some(t), &["be", "rid", "out", "off", "away"])
    });
    let to = usize::from(is(rest.first(), &["over", "across", "back", "up", "down"]));
    let goal = is(rest.get(to), &["to", "onto", "into"])
        && (is(rest.get(to + 1), &["the", "our", "my", "its", "left", "right"])
            || rest.get(to + 1).is_some_and(|t| number(t).is_some()));
    let far = rest.first().is_some_and(|t| number(t).is_some())
        && super::words::unit_at(&rest[1..]).is_some()
        && rest.iter().any(|t| {
            is(
                Some(t),
                &[
                    "closer", "nearer", "further", "farther", "ahead", "behind", "back",
                ],
            )
        });
    let fresh = a > 1 + me
        && !is(tokens.get(2 + me), &["of"])
        && !is(rest.first(), &["to"])
        && (is(tokens.get(1 + me), &["a", "an", "another", "some"]) || number(&tokens[1 + me]).is_some());
    if does {
        return tokens;
    }
    if known(tokens.get(1 + me)) && (get && goal || far) && talk.fits(&tokens[1 + me..b]) > 0 {
        let from = b + if goal { to } else { 0 };
        let at = tokens[0].clone();
        return led("move", &at, &[&tokens[1 + me..b], &tokens[from..]]);
    }
    if get && fresh && is_place(rest) && !goal {
        tokens[0].text = "add".into();
        tokens.drain(1..1 + me);
    }
    tokens
}

/// "I'd like the same thing in the rain": make it rain.
fn same_in(tokens: Vec<Token>) -> Vec<Token> {
    static SAME: List = LazyLock::new(|| {
        "\
        the same thing|the same scene|the same situation|the same picture|the same again|the same|it all|\
        all this|all of this|this scene|the whole thing|the whole scene|this situation|all that|everything|\
        the scene|the same street|exactly the same|the same setting|the same traffic"
            .split('|')
            .collect()
    });
    let found = (0..tokens.len().min(8)).find_map(|i| leads(&tokens[i..], &SAME).map(|n| (i, n)));
    let Some((i, n)) = found.filter(|x| !has_noun(&tokens[..x.0]) && !has_noun(&tokens[x.0 + x.1..])) else {
        return tokens;
    };
    let lead = &tokens[..i];
    let wish = lead.iter().all(|t| {
        AROUND.contains(&text(t))
            || LIKING.contains(&text(t))
            || is(Some(t), &["draw", "do", "try", "repeat"])
    });
    let again = usize::from(is(tokens.get(i + n), &["again", "once"]))
        + usize::from(is(tokens.get(i + n), &["once"]) && is(tokens.get(i + n + 1), &["more"]));
    let k = i + n + again;
    let sky = tokens.get(k..).unwrap_or(&[]).iter().any(|t| {
        matches!(
            super::look_up(text(t)),
            Some(super::Sense::Weather(_) | super::Sense::Time(_))
        )
    });
    let plain = is(
        tokens.get(k),
        &["in", "at", "by", "during", "with", "under", "on"],
    ) && !tokens[k..]
        .iter()
        .any(|t| t.kind != TokenKind::Word || is(Some(t), &["not", "no", "but", "instead"]));
    if wish && sky && plain && !lead.is_empty() {
        return led("make it", &tokens[0], &[&tokens[k + 1..]]);
    }
    tokens
}

/// "behind us there is nothing any more", "nobody should be following us": what is there goes.
fn nothing_there(tokens: Vec<Token>) -> Vec<Token> {
    const US: &[&str] = &[
        "behind us",
        "behind me",
        "ahead of us",
        "ahead of me",
        "in front of us",
        "in front of me",
    ];
    const NOTHING: &[&str] = &[
        "nothing",
        "nobody",
        "no one",
        "no vehicle",
        "no traffic",
        "no other traffic",
        "nothing else",
    ];
    static BE: List = LazyLock::new(|| {
        "\
        there is|there should be|there must be|there shall be|should be|is|must be|there will be|\
        there may be|may be|drives|stands|there ought to be"
            .split('|')
            .collect()
    });
    const LATE: &[&str] = &[
        "any more",
        "anymore",
        "any longer",
        "now",
        "at all",
        "please",
        "left",
    ];
    let closes = |rest: &[Token]| rest.is_empty() || leads(rest, LATE) == Some(rest.len());
    let remove = |place: &[Token], at: &Token| led("remove everything", at, &[place]);
    if let Some(n) = leads(&tokens, US)
        && let Some(m) = leads(&tokens[n..], &BE)
        && let Some(k) = leads(&tokens[n + m..], NOTHING)
        && closes(&tokens[n + m + k..])
    {
        return remove(&tokens[..n], &tokens[0]);
    }
    if let Some(k) = leads(&tokens, NOTHING)
        && let Some(m) =
            leads(&tokens[k..], &BE).or_else(|| leads(&tokens[k..], &["follows us", "follows me"]).map(|_| 0))
    {
        let rest = &tokens[k + m..];
        if let Some(n) = leads(
            rest,
            &[
                "following us",
                "following me",
                "follows us",
                "follows me",
                "tailing us",
                "on our tail",
                "on our heels",
            ],
        ) && closes(&rest[n..])
        {
            return led("remove everything in our lane behind us", &tokens[0], &[]);
        }
    }
    tokens
}

/// "let the bus pull over": it parks at its edge of the road.
fn pulled_over(tokens: Vec<Token>, talk: &Talk<'_>) -> Vec<Token> {
    let found = (1..tokens.len()).find_map(|i| {
        let n = leads(
            &tokens[i..],
            &[
                "pull over",
                "pulls over",
                "pulled over",
                "pulling over",
                "pull in",
                "pulls in",
                "pulled in",
                "pull over to the side",
                "pulls over to the side",
                "pulled over to the side",
                "pull over to the side of the road",
                "pulls over to the side of the road",
                "pulled over to the side of the road",
            ],
        )?;
        let ends = tokens
            .get(i + n)
            .is_none_or(|t| t.kind != TokenKind::Word || is(Some(t), &["please", "now"]));
        let (a, b) = first_noun(&tokens[..i])?;
        (ends && a < 5).then_some((i, n, a, b))
    });
    let Some((i, n, a, b)) = found else {
        return tokens;
    };
    let the = a - usize::from(a > 0);
    let Some(one) = talk.only(&tokens[the..b]) else {
        return tokens;
    };
    let side = if one.heading().x < -0.5 { "left" } else { "right" };
    let park = led(
        "be parked on the",
        &tokens[i],
        &[&led(side, &tokens[i], &[]), &led("roadside", &tokens[i], &[])],
    );
    let should = led("should", &tokens[i], &[]);
    [&tokens[the..b], &should, &park, &tokens[i + n..]].concat()
}

/// "I'd be happier with the bus 8 m nearer", "... without the car on the left".
fn liked(tokens: Vec<Token>, talk: &Talk<'_>) -> Vec<Token> {
    let Some((i, _)) = find(&tokens, &["with", "without"]).filter(|x| (2..14).contains(&x.0)) else {
        return tokens;
    };
    let lead = &tokens[..i];
    let likes = lead.iter().any(|t| LIKING.contains(&text(t)));
    let plain = lead
        .iter()
        .all(|t| AROUND.contains(&text(t)) || LIKING.contains(&text(t)) || t.kind == TokenKind::Comma);
    let begins = is(
        tokens.first(),
        &[
            "i",
            "we",
            "id",
            "wed",
            "it",
            "itd",
            "that",
            "this",
            "the",
            "everything",
            "all",
        ],
    );
    let rest = super::words::trimmed(&tokens[i + 1..]);
    if !likes || !plain || !begins || rest.is_empty() {
        return tokens;
    }
    let at = &tokens[i];
    // (what follows a comma is another clause)
    let end = rest
        .iter()
        .position(|t| t.kind != TokenKind::Word && !matches!(t.kind, TokenKind::Number(_)))
        .unwrap_or(rest.len());
    let Some((a, b)) = first_noun(&rest[..end]).filter(|x| x.0 < 5) else {
        return tokens;
    };
    if text(at) == "without" {
        // ("the nearer one" is looked for later)
        return if known(rest.first()) && (talk.fits(&rest[..end]) > 0 || talk.fits(&rest[a..b]) > 0) {
            led("remove", at, &[rest])
        } else {
            tokens
        };
    }
    if !known(rest.first()) {
        // "with one barrier fewer"
        let so_many =
            rest.first().is_some_and(|t| number(t).is_some()) && is(rest.get(b), &["fewer", "less", "more"]);
        return if so_many { rest.to_vec() } else { tokens };
    }
    match complement(&rest[..end], b, talk) {
        Some(k) => [&rest[..k], &led("should be", at, &[&rest[k..]])].concat(),
        None => tokens,
    }
}

/// Where what is said of a noun phrase begins: after its noun, or after the place that tells which one is meant.
fn complement(np: &[Token], b: usize, talk: &Talk<'_>) -> Option<usize> {
    let became = (b..np.len()).find(|k| BECAME.contains(&text(&np[*k])));
    let k = match became {
        Some(k) => k,
        None => {
            let only = usize::from(is(np.get(b), &["only", "just", "a", "some", "about", "at"]));
            let far = is_place(np.get(b + only..)?)
                || is(
                    np.get(b),
                    &["on", "in", "behind", "ahead", "parked", "painted", "facing"],
                );
            far.then_some(b)?
        }
    };
    (talk.fits(&np[..k]) > 0).then_some(k)
}

/// ", with the car behind us replaced by a bus": it should be.
fn absolute(tokens: Vec<Token>, talk: &Talk<'_>) -> Vec<Token> {
    let found = (0..tokens.len()).find_map(|i| {
        is(tokens.get(i), &["with"]).then_some(())?;
        let lead = &tokens[..i];
        let apart = lead
            .last()
            .is_none_or(|t| t.kind == TokenKind::Comma || is(Some(t), &["and", "but", "only"]));
        // "could we have it with the car replaced": nothing but the wish stands before
        let wish = !lead.is_empty()
            && lead.iter().all(|t| {
                AROUND.contains(&text(t)) || LIKING.contains(&text(t)) || t.kind == TokenKind::Comma
            });
        (apart || wish).then_some(())?;
        known(tokens.get(i + 1)).then_some(())?;
        let rest = &tokens[i + 1..];
        let (_, b) = first_noun(rest).filter(|x| x.0 < 4)?;
        // (who is gone is read elsewhere)
        let k = (b..rest.len().min(b + 7)).find(|k| {
            BECAME.contains(&text(&rest[*k]))
                && (wish || !is(rest.get(*k), &["gone", "missing", "removed", "deleted", "erased"]))
        })?;
        let whole = rest[b..k].iter().all(|t| t.kind == TokenKind::Word);
        (whole && (k == b || is_place(&rest[b..])) && talk.fits(&rest[..k]) > 0).then_some((
            i,
            i + 1 + k,
            wish,
        ))
    });
    let Some((i, k, wish)) = found else {
        return tokens;
    };
    let mut out = if wish || !has_words(&tokens[..i]) {
        Vec::new()
    } else {
        tokens[..i].to_vec()
    };
    // (two clauses, whatever links them)
    if out
        .last()
        .is_some_and(|t| t.kind == TokenKind::Word && !is(Some(t), &["and"]))
    {
        out.extend(led("and", &tokens[i], &[]));
    }
    if out.last().is_some_and(|t| t.kind == TokenKind::Comma) {
        out.extend(led("and", &tokens[i], &[]));
    }
    out.extend_from_slice(&tokens[i + 1..k]);
    out.extend(led("should be", &tokens[i], &[&tokens[k..]]));
    out
}

fn has_words(tokens: &[Token]) -> bool {
    has_noun(tokens) || tokens.iter().any(|t| t.kind == TokenKind::Word)
}
