//! Who has done something to what is there, and what follows: "somebody has tidied the cones away", "only 8 m are left between
//! it and us", "leave two cones standing", "everybody who is not a cyclist".

use super::super::lexicon::{Sense, look_up, plural};
use super::super::tokens::{Token, TokenKind};
use super::super::wording::replaced;
use super::Talk;
use super::lists::HELPERS;
use super::words::{find, first_noun, has_noun, is, is_place, is_unit, leads, led, number, text, trimmed};

const TAKES_PLACE: &str = "has taken the place of|have taken the place of|took the place of|is taking the place of|are taking the place of|will take the place of|should take the place of|shall take the place of|must take the place of|stands in the place of|stands in place of|has come in place of|have come in place of|comes in place of|come in place of|is in place of|are in place of|fills the place of|fills in for|now takes the place of|has been put in place of|has replaced|have replaced|has taken over from|have taken over from|drives in place of|waits in place of|is to take the place of|has taken the spot of|takes the spot of|has taken the position of|takes the position of";
const DRIVER: &str = "the driver behind us|the driver behind me|the motorist behind us|the motorist behind me|the driver who follows us|the driver following us|the driver that follows us";
const DRIVER_AHEAD: &str = "the driver ahead of us|the driver in front of us|the driver ahead of me|the driver in front of me|the motorist ahead of us|the motorist in front of us";
const COUPLE: &str = "the couple|the pair|the duo|that couple|that pair";
/// What makes away with things, in the perfect.
const TAKEN: &[&str] = &[
    "tidied",
    "tidied up",
    "tidied away",
    "cleared",
    "cleared away",
    "cleared up",
    "removed",
    "collected",
    "picked up",
    "packed up",
    "packed away",
    "packed",
    "taken away",
    "taken home",
    "taken in",
    "taken down",
    "taken",
    "towed",
    "towed away",
    "towed off",
    "swept up",
    "swept away",
    "stolen",
    "carried off",
    "carried away",
    "hauled off",
    "hauled away",
    "loaded",
    "loaded up",
    "bought",
    "fetched",
    "put away",
    "gathered",
    "gathered up",
    "gathered in",
    "dismantled",
    "pulled down",
    "brought in",
    "driven away",
    "driven off",
    "driven home",
    "sent home",
    "sent away",
    "chased away",
    "chased off",
    "called off",
    "called back",
    "withdrawn",
    "scrapped",
    "rounded up",
    "cleaned up",
    "confiscated",
    "got rid of",
    "thrown away",
    "stowed away",
    "stowed",
    "wheeled away",
    "rolled away",
    "dragged away",
    "dragged off",
];

const OWNERS: &str = "the owner of the|the owners of the|the rider of the|the riders of the|the owner of that|the owner of this";
const UNTIL_WE: &str = "brakes until|slows down until|speeds up until|accelerates until|drops back until|falls back until|catches up until|hurries up until|slows until|waits until";

/// A sentence (without its stop) in plainer words.
pub fn plain(tokens: Vec<Token>, talk: &Talk<'_>) -> Vec<Token> {
    let out = replaced(&tokens, ", please , but", ", but");
    let out = replaced(&out, TAKES_PLACE, "takes the place of");
    let out = replaced(&out, DRIVER, "the vehicle behind us");
    let out = replaced(&out, DRIVER_AHEAD, "the vehicle in front of us");
    let out = gap_closed(metres_back(out));
    let out = replaced(&out, OWNERS, "the");
    let out = replaced(&out, UNTIL_WE, "moves until");
    let out = we_are(out);
    let out = relatives(out, talk);
    let out = carried_over(out, talk);
    let out = two_let(brought(out, talk));
    let out = couple(out, talk);
    let out = sent_home(done_away(out, talk));
    let out = gap_left(out);
    let out = left_standing(out, talk);
    who_is_not(out)
}

fn opens(tokens: &[Token], i: usize) -> bool {
    i == 0
        || !matches!(tokens[i - 1].kind, TokenKind::Word | TokenKind::Number(_))
        || is(
            tokens.get(i - 1),
            &["and", "then", "but", "so", "because", "since", "that"],
        )
}

fn known(t: Option<&Token>) -> bool {
    is(
        t,
        &[
            "the", "all", "both", "every", "my", "our", "that", "those", "these",
        ],
    )
}

/// "until we are 14 m behind it": until it is 14 m ahead of us.
fn we_are(tokens: Vec<Token>) -> Vec<Token> {
    let found = (1..tokens.len()).find_map(|i| {
        is(tokens.get(i - 1), &["until", "till", "that", "so"]).then_some(())?;
        leads(&tokens[i..], &["we are", "i am", "our car is", "my car is"])?;
        let k = i + 2 + usize::from(is(tokens.get(i + 1), &["car"]));
        (number(tokens.get(k)?).is_some() && is_unit(tokens.get(k + 1))).then_some(())?;
        let n = leads(
            &tokens[k + 2..],
            &["behind", "ahead of", "in front of", "away from", "from"],
        )?;
        let it = is(tokens.get(k + 2 + n), &["it", "him", "her", "them"]);
        (it && tokens
            .get(k + 3 + n)
            .is_none_or(|t| t.kind != TokenKind::Word || is(Some(t), &["and"])))
        .then_some((i, k, n))
    });
    let Some((i, k, n)) = found else {
        return tokens;
    };
    let at = match text(&tokens[k + 2]) {
        "behind" => "ahead of us",
        "ahead" | "in" => "behind us",
        _ => "from us",
    };
    let is_ = if is(tokens.get(k + 2 + n), &["them"]) {
        "they are"
    } else {
        "it is"
    };
    let way = led(at, &tokens[i], &[&tokens[k + 3 + n..]]);
    [&tokens[..i], &led(is_, &tokens[i], &[&tokens[k..k + 2]]), &way].concat()
}

/// "the child's mother has come to stand beside it": somebody new, beside the child.
fn relatives(tokens: Vec<Token>, talk: &Talk<'_>) -> Vec<Token> {
    const KIN: &[&str] = &[
        "mother",
        "father",
        "mum",
        "mom",
        "dad",
        "brother",
        "sister",
        "wife",
        "husband",
        "friend",
        "colleague",
        "teacher",
        "grandmother",
        "grandfather",
        "nanny",
        "boss",
        "boyfriend",
        "girlfriend",
        "son",
        "daughter",
        "mate",
        "partner",
    ];
    let found = (1..tokens.len()).find(|i| {
        let person = matches!(look_up(text(&tokens[*i])), Some(Sense::Noun(n, _)) if n.classes[0] == crate::scene::Class::Pedestrian);
        person && is(tokens.get(i - 1), &["the", "that"]) && is(tokens.get(i + 1), KIN) && opens(&tokens, i - 1)
    });
    let Some(i) = found else {
        return tokens;
    };
    let who = tokens[i - 1..=i].to_vec();
    // (one who is there already is meant otherwise)
    let there = talk.fits(&led("the", &tokens[i], &[&tokens[i + 1..i + 2]])) > 0
        && !is(tokens.get(i + 1), &["friend", "mate", "partner", "colleague"]);
    if talk.fits(&who) == 0 || there && talk.fits(&who) != talk.fits(&led("people", &tokens[i], &[])) {
        return tokens;
    }
    let mut out = [&tokens[..i - 1], &led("a", &tokens[i], &[&tokens[i + 1..i + 2]])].concat();
    for t in &tokens[i + 2..] {
        match text(t) {
            "it" | "him" | "her" | "them" => out.extend_from_slice(&who),
            _ => out.push(t.clone()),
        }
    }
    replaced(
        &out,
        "has come to stand|has come and stands|has come over and stands|comes to stand|came to stand",
        "should stand",
    )
}

/// "the worker carries the cones over to the right edge": they are moved there.
fn carried_over(tokens: Vec<Token>, talk: &Talk<'_>) -> Vec<Token> {
    const CARRIES: &[&str] = &[
        "carries",
        "has carried",
        "carry",
        "have carried",
        "pushes",
        "has pushed",
        "have pushed",
        "pulls",
        "has pulled",
        "drags",
        "has dragged",
        "have dragged",
        "moves",
        "has moved",
        "have moved",
        "brings",
        "has brought",
        "have brought",
        "takes",
        "has taken",
        "have taken",
        "rolls",
        "has rolled",
        "shifts",
        "has shifted",
        "have shifted",
        "puts",
        "has put",
        "have put",
        "has placed",
        "have placed",
        "sets",
        "wheels",
        "has wheeled",
        "leads",
        "has led",
        "have led",
        "guides",
        "has guided",
        "sends",
        "has sent",
        "have sent",
        "waves",
    ];
    let found = (2..tokens.len()).find_map(|i| {
        let n = leads(&tokens[i..], CARRIES)?;
        let from = (0..i).rev().find(|k| opens(&tokens, *k))?;
        let doer = &tokens[from..i];
        let who = known(doer.first()) && first_noun(doer).is_some_and(|x| x.1 == doer.len() && x.0 < 4)
            || is(doer.first(), &["somebody", "someone"]) && doer.len() == 1;
        let np = tokens.get(i + n..)?;
        let (_, b) = first_noun(np).filter(|x| known(np.first()) && x.0 < 4)?;
        let goal = (b..np.len().min(b + 4))
            .any(|k| super::words::is_goal(&np[k..]) || is(np.get(k), &["onto", "to"]));
        (who && goal && talk.fits(&np[..b]) > 0).then_some((from, i + n))
    });
    match found {
        Some((from, np)) => [&tokens[..from], &led("move", &tokens[from], &[&tokens[np..]])].concat(),
        None => tokens,
    }
}

/// "the workers fetch two more cones and set them up beside the four": two more.
fn brought(tokens: Vec<Token>, talk: &Talk<'_>) -> Vec<Token> {
    const BRINGS: &[&str] = &[
        "fetch",
        "fetches",
        "have fetched",
        "has fetched",
        "bring",
        "brings",
        "have brought",
        "has brought",
        "add",
        "adds",
        "have added",
        "has added",
        "set up",
        "sets up",
        "have set up",
        "has set up",
        "put up",
        "puts up",
        "have put up",
        "has put up",
        "put out",
        "puts out",
        "have put out",
        "has put out",
        "lay out",
        "lays out",
        "have placed",
        "has placed",
        "places",
        "have laid out",
        "has laid out",
    ];
    let Some((_, b)) = first_noun(&tokens).filter(|x| x.0 < 4 && known(tokens.first())) else {
        return tokens;
    };
    let Some(n) = leads(&tokens[b..], BRINGS).filter(|_| talk.fits(&tokens[..b]) > 0) else {
        return tokens;
    };
    let np = &tokens[b + n..];
    let fresh = is(np.first(), &["a", "an", "another"]) || np.first().is_some_and(|t| number(t).is_some());
    let Some((_, e)) = first_noun(np).filter(|x| fresh && x.0 < 5) else {
        return tokens;
    };
    let rest = &np[e..];
    let same = leads(
        rest,
        &[
            "and set them up",
            "and put them up",
            "and set it up",
            "and put it",
            "and put them",
            "and place them",
        ],
    )
    .is_some();
    let alike = same && (talk.fits(&np[e - 1..e]) > 0) && first_noun(rest).is_none();
    let rest = if alike { &[][..] } else { rest };
    if !alike && same {
        return tokens;
    }
    led("add", &tokens[0], &[np.get(..e).unwrap_or_default(), rest])
}

/// "instead of the two cars, let two vans drive in the right lane": two vans.
fn two_let(tokens: Vec<Token>) -> Vec<Token> {
    if leads(&tokens, &["instead of", "in place of", "rather than"]).is_none() {
        return tokens;
    }
    let Some(i) = tokens.iter().position(|t| t.kind == TokenKind::Comma) else {
        return tokens;
    };
    let let_ =
        is(tokens.get(i + 1), &["let", "have"]) && tokens.get(i + 2).is_some_and(|t| number(t).is_some());
    let Some((_, b)) = first_noun(tokens.get(i + 2..).unwrap_or_default()).filter(|x| let_ && x.0 < 4) else {
        return tokens;
    };
    let end = i + 2 + b;
    let verb = usize::from(is(
        tokens.get(end),
        &["drive", "stand", "wait", "walk", "ride", "be", "come"],
    ));
    [
        &tokens[..=i],
        &led("put", &tokens[i], &[&tokens[i + 2..end]]),
        &tokens[end + verb..],
    ]
    .concat()
}

/// "the pickup closes the gap to 7 m": so far it is then.
fn gap_closed(tokens: Vec<Token>) -> Vec<Token> {
    let found = (1..tokens.len()).find_map(|i| {
        let verb = [
            "closes",
            "close",
            "closed",
            "narrows",
            "narrowed",
            "reduces",
            "reduced",
            "shortens",
            "shortened",
            "opens",
            "opened",
            "widens",
            "widened",
            "increases",
            "increased",
            "lets",
            "let",
            "cuts",
            "cut",
        ];
        is(tokens.get(i), &verb).then_some(())?;
        let n = leads(
            &tokens[i + 1..],
            &[
                "the gap",
                "the distance",
                "its distance",
                "his distance",
                "her distance",
                "their distance",
                "its gap",
                "his gap",
                "her gap",
                "up the gap",
            ],
        )?;
        let to = (i + 1 + n..tokens.len().min(i + n + 8)).find(|k| {
            is(tokens.get(*k), &["to", "at"])
                && tokens.get(k + 1).is_some_and(|t| number(t).is_some())
                && is_unit(tokens.get(k + 2))
        })?;
        let between = tokens[i + 1 + n..to].iter().all(|t| {
            is(
                Some(t),
                &[
                    "to", "us", "me", "from", "between", "and", "itself", "down", "up", "behind", "ahead",
                    "a", "bit", "grow",
                ],
            )
        });
        let from = (0..i).rev().find(|k| opens(&tokens, *k))?;
        let who = &tokens[from..i];
        let helped = who
            .iter()
            .rposition(|t| !HELPERS.contains(&text(t)))
            .map_or(0, |k| k + 1);
        let one = is(who.first(), &["it", "he", "she", "they"]) && helped == 1
            || known(who.first()) && has_noun(&who[..helped]);
        (between && one).then_some((from + helped, to + 1))
    });
    match found {
        Some((i, k)) => [
            &tokens[..i],
            &led("should keep a distance of", &tokens[i], &[&tokens[k..k + 2]]),
            &tokens[k + 2..],
        ]
        .concat(),
        None => tokens,
    }
}

/// "he is 20 m back now": behind us.
fn metres_back(tokens: Vec<Token>) -> Vec<Token> {
    let found = (1..tokens.len()).find(|i| {
        is(
            tokens.get(i - 1),
            &["is", "are", "stays", "drives", "rides", "now", "keeps"],
        ) && number(&tokens[*i]).is_some()
            && is_unit(tokens.get(i + 1))
            && is(tokens.get(i + 2), &["back"])
            && tokens
                .get(i + 3)
                .is_none_or(|t| t.kind != TokenKind::Word || is(Some(t), &["now", "and", "again"]))
    });
    match found {
        Some(i) => [
            &tokens[..i + 2],
            &led("behind us", &tokens[i], &[]),
            &tokens[i + 3..],
        ]
        .concat(),
        None => tokens,
    }
}

/// "the couple on the left": the two people there.
fn couple(tokens: Vec<Token>, talk: &Talk<'_>) -> Vec<Token> {
    let Some(i) = (0..tokens.len()).find(|i| super::super::wording::begins(&tokens[*i..], COUPLE).is_some())
    else {
        return tokens;
    };
    let people = led("people", &tokens[i], &[]);
    if is(tokens.get(i + 2), &["of"])
        || talk.fits(&people) < 2
        || first_noun(&tokens[i + 2..]).is_some_and(|n| n.0 == 0)
    {
        return tokens;
    }
    // (one group: its verb is that of several)
    let mut out = [
        &tokens[..i],
        &led("the two people", &tokens[i], &[]),
        &tokens[i + 2..],
    ]
    .concat();
    if let Some(t) = out[i..]
        .iter_mut()
        .take(9)
        .find(|t| matches!(text(t), "has" | "is" | "was"))
    {
        t.text = match text(t) {
            "has" => "have",
            "is" => "are",
            _ => "were",
        }
        .into();
    }
    out
}

/// "somebody has tidied the cones away": they are gone, whoever did it.
fn done_away(tokens: Vec<Token>, talk: &Talk<'_>) -> Vec<Token> {
    let found = (1..tokens.len()).find_map(|i| {
        is(tokens.get(i), &["has", "have", "had"]).then_some(())?;
        let skip = usize::from(is(
            tokens.get(i + 1),
            &["already", "now", "finally", "just", "meanwhile", "since", "also"],
        ));
        let v = i + 1 + skip;
        let n = leads(tokens.get(v..)?, TAKEN)?;
        let np = tokens.get(v + n..)?;
        let from = (0..i).rev().find(|k| opens(&tokens, *k))?;
        // "somebody has bought it"
        let someone = is(tokens.get(from), &["somebody", "someone", "they", "people"]) && from + 1 == i;
        if someone
            && is(np.first(), &["it", "them", "him", "her"])
            && np.get(1).is_none_or(|t| {
                t.kind != TokenKind::Word || is(Some(t), &["away", "off", "up", "home", "and", "now"])
            })
        {
            return Some((from, i, v + n, v + n + 1));
        }
        let part =
            np.first().is_some_and(|t| number(t).is_some()) && is(np.get(1), &["of"]) && known(np.get(2));
        (known(np.first()) || part).then_some(())?;
        let (_, b) = first_noun(np).filter(|x| x.0 < 5)?;
        let end = v + n + b;
        // the doer says nothing of a place: "has taken the left lane" is none of this
        let place =
            is_place(&tokens[end..]) && !is(tokens.get(end), &["away", "up", "off", "from", "out", "down"]);
        (!place && talk.fits(&np[if part { 2 } else { 0 }..b]) > 0).then_some((from, i, v + n, end))
    });
    let Some((from, has, np, end)) = found else {
        return tokens;
    };
    let close = (end..tokens.len())
        .find(|k| tokens[*k].kind != TokenKind::Word || is(tokens.get(*k), &["and", "but", "so"]))
        .unwrap_or(tokens.len());
    let remove = led("remove", &tokens[from], &[&tokens[np..end]]);
    // "... and is about to leave": said of him who did it
    let goes_on = is(tokens.get(close), &["and", "but"])
        && tokens
            .get(close + 1)
            .is_some_and(|t| HELPERS.contains(&text(t)) || super::words::is_finite(text(t), false));
    if goes_on {
        return [
            &tokens[..from],
            &remove,
            &tokens[close..=close],
            &tokens[from..has],
            &tokens[close + 1..],
        ]
        .concat();
    }
    [&tokens[..from], &remove, &tokens[close..]].concat()
}

/// "send two children home": they go.
fn sent_home(tokens: Vec<Token>) -> Vec<Token> {
    let Some(i) = (0..tokens.len()).find(|i| {
        is(
            tokens.get(*i),
            &["send", "drive", "escort", "chase", "shoo", "usher", "let"],
        ) && (opens(&tokens, *i) || is(tokens.get(i.wrapping_sub(1)), &["please"]))
    }) else {
        return tokens;
    };
    let from = i + 1;
    let counted = tokens.get(from).is_some_and(|t| number(t).is_some());
    let Some((_, b)) = first_noun(tokens.get(from..).unwrap_or_default()).filter(|x| counted && x.0 < 5)
    else {
        return tokens;
    };
    let home = leads(
        &tokens[from + b..],
        &[
            "home",
            "away",
            "off",
            "back home",
            "packing",
            "go",
            "go home",
            "leave",
        ],
    );
    match home.filter(|n| {
        tokens
            .get(from + b + n)
            .is_none_or(|t| t.kind != TokenKind::Word || is(Some(t), &["and", "but", "please"]))
    }) {
        Some(n) => [
            &tokens[..i],
            &led("remove", &tokens[i], &[&tokens[from..from + b]]),
            &tokens[from + b + n..],
        ]
        .concat(),
        None => tokens,
    }
}

/// "only 8 m are left between it and us": so far it is from us.
fn gap_left(tokens: Vec<Token>) -> Vec<Token> {
    let Some(i) = (0..tokens.len()).find(|i| number(&tokens[*i]).is_some() && is_unit(tokens.get(i + 1)))
    else {
        return tokens;
    };
    let Some(k) = (i + 2..tokens.len().min(i + 9)).find(|k| is(tokens.get(*k), &["between"])) else {
        return tokens;
    };
    let said = tokens[i + 2..k].iter().all(|t| {
        HELPERS.contains(&text(t))
            || is(
                Some(t),
                &[
                    "left",
                    "remain",
                    "remaining",
                    "lie",
                    "of",
                    "space",
                    "room",
                    "distance",
                    "road",
                    "now",
                    "only",
                    "free",
                    "air",
                ],
            )
    });
    let from = (0..=i).rev().find(|j| opens(&tokens, *j)).unwrap_or(0);
    let lead = tokens[from..i].iter().all(|t| {
        is(
            Some(t),
            &[
                "only", "just", "there", "are", "is", "a", "gap", "of", "now", "leave", "leaving", "with",
                "should", "be", "must", "at", "least", "exactly", "about",
            ],
        )
    });
    let rest = &tokens[k + 1..];
    let us = ["us", "me", "ourselves"];
    let who: &[Token] = if is(rest.first(), &us) && is(rest.get(1), &["and"]) {
        &rest[2..]
    } else {
        let Some(and) = rest
            .iter()
            .position(|t| text(t) == "and")
            .filter(|a| is(rest.get(a + 1), &us))
        else {
            return tokens;
        };
        if rest.len() > and + 2 && rest[and + 2].kind == TokenKind::Word {
            return tokens;
        }
        &rest[..and]
    };
    let who = trimmed(who);
    let one = is(who.first(), &["it", "him", "her", "them"]) && who.len() == 1
        || known(who.first()) && first_noun(who).is_some_and(|n| n.1 == who.len());
    if !said || !lead || !one {
        return tokens;
    }
    let subject = match text(&who[0]) {
        "him" => led("he", &who[0], &[]),
        "her" => led("she", &who[0], &[]),
        "them" => led("they", &who[0], &[]),
        _ => who.to_vec(),
    };
    let keeps = led("should keep a distance of", &tokens[i], &[&tokens[i..i + 2]]);
    [&tokens[..from], &subject, &keeps].concat()
}

/// "leave two cones standing and clear the others away": only two are kept.
fn left_standing(tokens: Vec<Token>, talk: &Talk<'_>) -> Vec<Token> {
    const STANDING: &[&str] = &[
        "standing",
        "standing there",
        "there",
        "where they are",
        "where it is",
        "in place",
        "behind",
        "parked",
        "walking",
        "as they are",
        "alone",
        "over",
        "lying",
        "waiting",
        "on the road",
        "on their spot",
        "on the spot",
    ];
    let Some(i) = (0..tokens.len()).find(|i| {
        is(tokens.get(*i), &["leave", "leaving"])
            && (opens(&tokens, *i) || is(tokens.get(i.wrapping_sub(1)), &["please"]))
    }) else {
        return tokens;
    };
    let only = usize::from(is(tokens.get(i + 1), &["only", "just"]));
    let from = i + 1 + only;
    // "and leave the third one standing"
    let one = leads(
        &tokens[from..],
        &[
            "the third one",
            "the third",
            "the other one",
            "the last one",
            "the second one",
            "the fourth one",
            "the remaining one",
            "the other",
            "the others",
            "the rest",
            "the remaining ones",
            "the other two",
            "the other three",
            "the last two",
        ],
    );
    if let Some(n) = one
        && let Some(m) = leads(&tokens[from + n..], STANDING)
        && tokens.get(from + n + m).is_none_or(|t| t.kind != TokenKind::Word)
        && i > 0
    {
        let before = trimmed(&tokens[..i]);
        return [before, &tokens[from + n + m..]].concat();
    }
    let Some(many) = tokens.get(from).filter(|t| number(t).is_some()) else {
        return tokens;
    };
    let Some((a, b)) = first_noun(&tokens[from..]).filter(|x| x.0 < 6) else {
        return tokens;
    };
    let Some(m) = leads(&tokens[from + b..], STANDING) else {
        return tokens;
    };
    let end = from + b + m;
    let closes = tokens
        .get(end)
        .is_none_or(|t| t.kind != TokenKind::Word || is(Some(t), &["and", "but"]));
    let np: Vec<Token> = tokens[from + 1..from + b]
        .iter()
        .filter(|t| !is(Some(t), &["of", "the", "those", "these", "our"]))
        .cloned()
        .collect();
    if !closes || a == 0 || talk.fits(&np) < number(many).unwrap_or(0).max(0) as usize {
        return tokens;
    }
    // what becomes of the others is said by that
    let rest = trimmed(&tokens[end..]);
    let others = find(
        rest,
        &[
            "the others",
            "the rest",
            "the other",
            "all others",
            "all the others",
            "the remaining",
        ],
    )
    .filter(|x| x.0 < 4 && !has_noun(rest));
    let tail: &[Token] = if others.is_some() { &[] } else { &tokens[end..] };
    [
        &tokens[..i],
        &led("keep exactly", &tokens[i], &[std::slice::from_ref(many), &np]),
        tail,
    ]
    .concat()
}

/// "everybody who is not a cyclist": everything but the cyclists.
fn who_is_not(tokens: Vec<Token>) -> Vec<Token> {
    const WHO: &[&str] = &[
        "everybody who is not a",
        "everyone who is not a",
        "everything that is not a",
        "anything that is not a",
        "whatever is not a",
        "everything which is not a",
        "whoever is not a",
        "all that is not a",
        "everybody who isnt a",
        "everyone who isnt a",
        "everything that isnt a",
        "anything that isnt a",
        "whatever isnt a",
        "everything not a",
        "anybody who is not a",
        "anyone who is not a",
        "all those who are not",
        "everybody who is not an",
        "everything that is not an",
        "anything that is not an",
        "whatever is not an",
    ];
    let Some((i, n)) = find(&tokens, WHO) else {
        return tokens;
    };
    let Some((_, b)) = first_noun(&tokens[i + n..]).filter(|x| x.0 < 3) else {
        return tokens;
    };
    let mut np = tokens[i + n..i + n + b].to_vec();
    if let Some(last) = np.last_mut()
        && matches!(look_up(&last.text), Some(Sense::Noun(_, false)))
    {
        last.text = plural(&last.text);
    }
    let all = led("everything but the", &tokens[i], &[&np]);
    [&tokens[..i], &all, &tokens[i + n + b..]].concat()
}
