//! Words as the clause reader wants them: "the one behind me" is something, the bus driver is the bus.

use super::super::lexicon::{Sense, look_up};
use super::super::tokens::{Token, TokenKind};
use super::super::wording::{begins, rewritten};
use super::Talk;
use super::lists::HELPERS;
use super::words::{self, find, is, is_place, led, number, text};

/// "the one behind me", "what's behind me" as "the object behind me".
pub(super) fn with_ones(body: &[Token]) -> Vec<Token> {
    let mut out = sides_named(body.to_vec());
    // "the driver of the bus", "the bus driver": the bus
    if let Some((i, n)) = find(
        &out,
        &[
            "the driver of",
            "the person driving",
            "the driver in",
            "the man driving",
            "the woman driving",
        ],
    ) {
        out.drain(i..i + n);
    }
    let mut i = 1;
    while i < out.len() {
        let vehicle =
            matches!(look_up(text(&out[i - 1])), Some(Sense::Noun(n, _)) if n.classes[0].is_vehicle());
        if vehicle && is(out.get(i), &["driver", "drivers"]) {
            out.remove(i);
        }
        i += 1;
    }
    let mut i = 0;
    while i + 1 < out.len() {
        let the = is(out.get(i), &["the", "that", "this"]) && is(out.get(i + 1), &["one", "ones"]);
        let more = out.get(i + 2..).unwrap_or(&[]);
        let told = is_place(more) || is(more.first(), &["that", "which", "who"]);
        let first = i == 0 || words::trimmed(&out[..i]).is_empty();
        if the && told && first {
            out[i + 1] = words::word("object", &out[i + 1].clone());
        }
        let what = first
            && (is(out.get(i), &["whats"])
                || is(out.get(i), &["what", "whatever", "whoever"])
                    && is(out.get(i + 1), &["is", "drives", "stands", "comes"]));
        if what {
            let n = if text(&out[i]) == "whats" { 1 } else { 2 };
            let later = out[i + n..].iter().any(|t| HELPERS.contains(&text(t)));
            if later && is_place(&out[i + n..]) {
                let the = led("the object", &out[i].clone(), &[]);
                out.splice(i..i + n, the);
            }
        }
        i += 1;
    }
    out
}

/// "from the right lane to the left one": the left lane.
pub(super) fn sides_named(tokens: Vec<Token>) -> Vec<Token> {
    let mut out = side_added(tokens);
    for i in 1..out.len() {
        // "the car in the right one": lane
        let side = is(
            out.get(i - 1),
            &["left", "right", "other", "oncoming", "opposite", "hand"],
        );
        let place = out[..i].iter().rev().find(|t| {
            matches!(
                text(t),
                "lane" | "sidewalk" | "pavement" | "side" | "kerb" | "curb" | "roadside" | "shoulder"
            )
        });
        // ("the car goes to the left side, the other one stays": the other car)
        let subject = is(out.get(i - 1), &["other"])
            && out
                .get(i + 1)
                .is_some_and(|t| words::is_finite(text(t), false) || HELPERS.contains(&text(t)));
        if let (true, false, true, Some(place)) = (side, subject, is(out.get(i), &["one"]), place.cloned()) {
            out[i] = words::word(text(&place), &out[i].clone());
        }
    }
    out
}

/// "to the far pavement, the one on our left": to the left pavement.
fn side_added(mut tokens: Vec<Token>) -> Vec<Token> {
    const STRIPS: &[&str] = &[
        "lane", "sidewalk", "pavement", "side", "kerb", "curb", "roadside", "shoulder", "footpath", "edge",
        "verge",
    ];
    let found = (2..tokens.len()).find_map(|i| {
        (tokens[i].kind == TokenKind::Comma && is(tokens.get(i - 1), STRIPS)).then_some(())?;
        let n = words::leads(
            &tokens[i + 1..],
            &[
                "the one on our",
                "the one on my",
                "the one on the",
                "the one to our",
                "the one to my",
                "the one to the",
                "that is the one on our",
                "that is the one on my",
                "that is the one on the",
                "that is on our",
                "that is on my",
                "that is on the",
                "that is the",
                "namely the one on our",
                "namely the one on my",
                "namely the one on the",
                "namely the",
                "meaning the one on our",
                "meaning the",
                "which is the one on our",
                "which is on our",
                "which is on the",
                "which is the",
            ],
        )?;
        let side = i + 1 + n;
        is(tokens.get(side), &["left", "right"]).then_some(())?;
        let more = words::leads(
            &tokens[side + 1..],
            &["hand side", "side", "hand one", "one", "hand"],
        )
        .unwrap_or(0);
        let end = side + 1 + more;
        tokens
            .get(end)
            .is_none_or(|t| t.kind != TokenKind::Word || is(Some(t), &["and", "but"]))
            .then_some(())?;
        let the = (i.saturating_sub(4)..i - 1)
            .rev()
            .find(|k| is(tokens.get(*k), &["the", "that"]))?;
        Some((the, i, side, end))
    });
    if let Some((the, comma, side, end)) = found {
        // ("the other lane, the one on our left, should be empty")
        let encloses = tokens.get(end).is_some_and(|t| t.kind == TokenKind::Comma)
            && tokens
                .get(end + 1)
                .is_some_and(|t| HELPERS.contains(&text(t)) || words::is_finite(text(t), true));
        let end = end + usize::from(encloses);
        let (left, strip) = (tokens[side].clone(), tokens[comma - 1].clone());
        tokens.splice(the + 1..end, [left, strip]);
    }
    tokens
}

/// "the two little ones", where nothing else is named: the children.
pub(super) fn little_ones(mut tokens: Vec<Token>, talk: &Talk<'_>) -> Vec<Token> {
    let found = (1..tokens.len()).find(|i| {
        is(tokens.get(*i), &["little", "small", "young"]) && is(tokens.get(i + 1), &["ones", "one"])
    });
    let Some(i) = found.filter(|_| !words::has_noun(&tokens)) else {
        return tokens;
    };
    let many = is(tokens.get(i + 1), &["ones"]);
    let child = led(if many { "children" } else { "child" }, &tokens[i], &[]);
    let vehicles = matches!(&talk.last, Some(last) if last != "pedestrian");
    if vehicles || talk.fits(&child) == 0 {
        return tokens;
    }
    tokens.splice(i..i + 2, child);
    tokens
}

/// "beside the engine", where a fire engine is: that one.
pub(super) fn engine(tokens: Vec<Token>, talk: &Talk<'_>) -> Vec<Token> {
    let called = |b: &crate::scene::SceneBox| b.label.name.as_str().to_lowercase().starts_with("fire");
    if !tokens.iter().any(|t| is(Some(t), &["engine", "appliance"])) || !talk.boxes.values().any(called) {
        return tokens;
    }
    rewritten(&tokens, |i, out| {
        let named =
            is(tokens.get(i), &["engine", "appliance"]) && is(out.last(), &["the", "that", "our", "my"]);
        // ("with the engine running")
        let part = out.len() > 1
            && is(
                out.get(out.len() - 2),
                &["with", "turn", "switch", "start", "off", "on"],
            );
        (named && !part).then_some(())?;
        out.extend(led("fire engine", &tokens[i], &[]));
        Some(i + 1)
    })
}

/// The words without "on foot" and "who is on foot".
pub(super) fn without_feet(body: &[Token]) -> Vec<Token> {
    let Some((i, n)) = find(
        body,
        &[
            "who is on foot",
            "who are on foot",
            "that is on foot",
            "that are on foot",
            "on foot",
        ],
    ) else {
        return body.to_vec();
    };
    let mut out = body.to_vec();
    out.drain(i..i + n);
    out
}

/// Words for where somebody comes from, goes to and stands, where two or three mean one: "coming the other way" is towards us,
/// "is to stand" is "should stand".
pub(super) fn coming(tokens: Vec<Token>, talk: &Talk<'_>) -> Vec<Token> {
    const COMES: &str = "coming|come|comes|came|heading|approaching";
    const OTHER_WAY: &str = "the other way|the opposite way|from the other way|from the opposite way|the other direction|the opposite direction|from the other direction|from the opposite direction|in the other direction|in the opposite direction|from the opposite side|from the other side";
    const AT: &str = "straight at us|straight at me|right at us|right at me|directly at us|directly at me|at us|at me|head on at us|head on at me";
    const DRIVES: &str = "coming|come|comes|came|drives|drive|driving|drove|rides|ride|riding|rode|heads|heading|headed|races|racing|raced|runs|running|ran";
    let out = rewritten(&tokens, |i, out| {
        let go = begins(&tokens[i..], COMES).and_then(|n| Some(n + begins(&tokens[i + n..], OTHER_WAY)?));
        let at = begins(&tokens[i..], DRIVES).and_then(|n| Some(n + begins(&tokens[i + n..], AT)?));
        let n = go.or(at)?;
        out.push(tokens[i].clone());
        out.extend(led("towards us", &tokens[i], &[]));
        Some(i + n)
    });
    let out = rewritten(&out, |i, new| {
        // "a lorry is to stand there" ("what I want is to remove it" is a wish)
        let to = is(out.get(i), &["is", "are"]) && is(out.get(i + 1), &["to"]) && !new.is_empty();
        let verb = out.get(i + 2).filter(|_| to)?;
        let does = is(
            Some(verb),
            &["stand", "be", "drive", "walk", "park", "move", "come", "have"],
        ) || words::is_finite(text(verb), true) && !super::super::rephrase::is_verb(verb);
        let whom = is(
            out.get(i + 3),
            &["the", "both", "all", "every", "my", "it", "them", "him", "her"],
        );
        let wishes = &[
            "what",
            "thing",
            "idea",
            "plan",
            "aim",
            "goal",
            "task",
            "wish",
            "intention",
        ];
        (does && !whom && !new.iter().any(|t| is(Some(t), wishes))).then(|| {
            new.extend(led("should", &out[i], &[]));
            i + 2
        })
    });
    let out = rewritten(&out, |i, new| {
        const ON_TOP: &str = "right on top of|on top of|smack in the middle of|bang in the middle of|slap in the middle of|right in the middle of";
        let n = begins(&out[i..], ON_TOP)?;
        let the = n + usize::from(is(out.get(i + n), &["the", "our", "my"]));
        let place = words::longest(out.get(i + the..)?).is_some_and(|s| matches!(s.0, Sense::Place(..)));
        place.then(|| {
            new.extend(led("on", &out[i], &[]));
            i + n
        })
    });
    let out = rewritten(&out, |i, new| {
        // "a scooter takes up one of the empty bays"
        const TAKES: &str = "takes up|takes|has taken|occupies|fills|uses|now takes up|now occupies|stands in|sits in|pulls into|has pulled into|parks in|is parked in";
        const FREE: &str = "one of the empty|one of the free|one of the vacant|one of the vacated|a free|a vacant|an empty|the empty|the free|the vacant|the freed";
        const BAY: &str = "bay|bays|parking bay|parking bays|space|spaces|parking space|parking spaces|spot|spots|parking spot|parking spots|slot|slots|parking slot|parking slots";
        let takes = begins(&out[i..], TAKES)?;
        let free = i + takes + begins(&out[i + takes..], FREE)?;
        let n = begins(&out[free..], BAY)?;
        new.extend(led("is parked in the car park", &out[i], &[]));
        Some(free + n)
    });
    some_stay(laid_out(into_one(out)), talk)
}

/// "cones should be set out in our lane": how they come there is not told twice.
fn laid_out(tokens: Vec<Token>) -> Vec<Token> {
    const OUT: &str = "set out|set up|put up|put down|put out|laid out|laid down|set down|placed|lined up|positioned|erected|deployed|stationed|installed|arranged";
    rewritten(&tokens, |i, out| {
        let n = begins(&tokens[i..], OUT).filter(|_| is(out.last(), &["be", "been"]))?;
        // (only who is new is put up anywhere)
        let new = number(tokens.first()?).is_some() || is(tokens.first(), &["a", "an", "some", "more"]);
        (new && is_place(tokens.get(i + n..)?)).then_some(i + n)
    })
}

/// "change the car in a motorcycle": into one.
fn into_one(mut tokens: Vec<Token>) -> Vec<Token> {
    if !is(tokens.first(), &["change", "turn", "convert", "transform"]) {
        return tokens;
    }
    for i in 2..tokens.len() {
        let thing = is(tokens.get(i), &["in"])
            && is(tokens.get(i + 1), &["a", "an"])
            && words::noun_at(&tokens[i - 1..i]).is_some()
            && words::first_noun(&tokens[i + 1..]).is_some_and(|x| x.0 < 3);
        if thing {
            tokens[i].text = "into".into();
        }
    }
    tokens
}

/// "only one of the two stays on the left; the other one crosses": nobody goes away.
fn some_stay(tokens: Vec<Token>, talk: &Talk<'_>) -> Vec<Token> {
    let some = is(tokens.first(), &["only", "just"])
        && tokens.get(1).is_some_and(|t| number(t).is_some())
        && is(tokens.get(2), &["of"]);
    let stays = tokens
        .iter()
        .any(|t| is(Some(t), &["stays", "stay", "remains", "remain", "keeps", "keep"]));
    if some
        && stays
        && (talk.others || words::find(&tokens, &["the other", "the others", "the rest"]).is_some())
    {
        tokens[1..].to_vec()
    } else {
        tokens
    }
}
