//! What is said of those who are not in the scene and of those who sit in it: "someone should take the cones away", "the learner
//! behind us in the van"; and what is said beside a command: "for safety two cones ...", "..., as if it were passing us", "..., add
//! it to the sketch", "..., cones stay put".

use super::super::edit_command::verb_of;
use super::super::lexicon::{Sense, look_up};
use super::super::tokens::{Token, TokenKind};
use super::super::wording::{begins, rewritten};
use super::super::words::edits::Verb;
use super::Talk;
use super::gifts::begins_at;
use super::words::{first_noun, has_noun, is, is_place, led, number, text, word};
use crate::scene::Class;

/// Words that begin what somebody is to do something with.
const DETERMINERS: &[&str] = &[
    "the",
    "all",
    "both",
    "that",
    "those",
    "these",
    "a",
    "an",
    "another",
    "it",
    "them",
    "him",
    "her",
    "our",
    "my",
    "every",
    "everything",
    "everybody",
    "everyone",
    "some",
    "more",
];

/// A sentence (without its stop) in plainer words.
pub fn plain(tokens: Vec<Token>, talk: &Talk<'_>) -> Vec<Token> {
    let out = for_what(asked_of_somebody(tokens));
    let out = stays_put(added_again(as_if(out)), talk);
    in_vehicle(not_alone(out, talk), talk)
}

fn ends(t: Option<&Token>) -> bool {
    t.is_none_or(|t| t.kind != TokenKind::Word && !matches!(t.kind, TokenKind::Number(_)))
}

/// "someone should take the cones off the road", "could somebody remove it": a command.
fn asked_of_somebody(tokens: Vec<Token>) -> Vec<Token> {
    const ASK: &str = "could|can|would|will|may|should|please let|let|have|please have|i want|we want|i need|we need|i would like|id like";
    const WHO: &str = "someone|somebody|anybody|anyone|some one|some person|one of you|whoever";
    const SHOULD: &str = "should please|should|must|has to|have to|needs to|ought to|shall|had better|better|please|is to|will have to|could|can|may|might|would|to|needs";
    // (what somebody does himself brings him into the scene)
    const HIMSELF: &[&str] = &[
        "walk", "ride", "drive", "guide", "lead", "face", "sit", "stand", "hold", "push", "pull", "leave",
        "point", "direct", "keep",
    ];
    rewritten(&tokens, |i, _| {
        begins_at(&tokens, i).then_some(())?;
        let ask = begins(&tokens[i..], ASK).unwrap_or(0);
        let who = begins(tokens.get(i + ask..)?, WHO)?;
        let at = i + ask + who;
        let should = begins(tokens.get(at..)?, SHOULD).unwrap_or(0);
        (ask + should > 0).then_some(())?;
        let rest = &tokens[at + should..];
        let also = usize::from(is(
            rest.first(),
            &["also", "now", "please", "just", "quickly", "kindly"],
        ));
        let rest = &rest[also..];
        let verb = verb_of(rest).filter(|v| *v != Verb::Keep && !is(rest.first(), HIMSELF))?;
        let upon =
            (1..4).any(|k| is(rest.get(k), DETERMINERS) || rest.get(k).is_some_and(|t| number(t).is_some()));
        (upon && verb != Verb::Note).then_some(())?;
        Some(at + should + also)
    })
}

/// "for safety two cones are to be placed ...": the two cones.
fn for_what(tokens: Vec<Token>) -> Vec<Token> {
    const AIMS: &str = "to be safe|to be on the safe side|just to be safe|just in case|for the sake of safety|for the sake of clarity|\
        for the sake of completeness|for safetys sake|in the interest of safety|as a precaution|as a safety measure|as a warning|by way of precaution|\
        be safe|be on the safe side|for reasons of safety|for safety reasons";
    // (what is for these is no aim)
    const OTHERS: &[&str] = &[
        "every", "each", "all", "now", "that", "this", "the", "a", "an", "us", "me", "it", "once", "good",
        "both",
    ];
    rewritten(&tokens, |i, _| {
        begins_at(&tokens, i).then_some(())?;
        let new = |k: usize| {
            tokens.get(k).is_some_and(|t| {
                number(t).is_some() || is(Some(t), &["a", "an", "the", "another", "some", "more"])
            })
        };
        if let Some(n) = begins(&tokens[i..], AIMS) {
            return (new(i + n) || ends(tokens.get(i + n)) && i + n < tokens.len()).then_some(i + n);
        }
        is(tokens.get(i), &["for"]).then_some(())?;
        let n = (2..5).find(|k| new(i + k))?;
        // ("for take two the bus is out" counts the takes)
        (!is(tokens.get(i + n + 1), &["the", "a", "an", "both", "all"])).then_some(())?;
        let aim = &tokens[i + 1..i + n];
        let plain = aim
            .iter()
            .all(|t| t.kind == TokenKind::Word && number(t).is_none())
            && !is(aim.first(), OTHERS)
            && !has_noun(aim)
            && !is_place(aim);
        (plain && has_noun(&tokens[i + n..])).then_some(i + n)
    })
}

/// "..., as if it were just passing us": how it looks, and no place.
fn as_if(tokens: Vec<Token>) -> Vec<Token> {
    const AS_IF: &str = "as if|as though|like as if|just as if|just as though|almost as if";
    // (how it stands or is turned may be told so)
    const TELLS: &[&str] = &[
        "park", "parked", "stand", "standing", "wait", "waiting", "stop", "stopped", "look", "looking",
        "face", "facing", "cross", "crossing", "turn", "turning", "not", "never", "no", "only",
    ];
    let found = (4..tokens.len()).find_map(|i| {
        let n = begins(&tokens[i..], AS_IF)?;
        is(
            tokens.get(i + n),
            &["it", "he", "she", "they", "we", "i", "someone", "the"],
        )
        .then_some(())?;
        let close = (i + n..tokens.len())
            .find(|k| ends(tokens.get(*k)))
            .unwrap_or(tokens.len());
        let before = tokens[..i].len() - usize::from(ends(tokens.get(i - 1)));
        let b = first_noun(&tokens[..before])?.1;
        let placed = (b..before).any(|k| is_place(&tokens[k..before]));
        let tells = tokens[i + n..close].iter().any(|t| is(Some(t), TELLS));
        (placed && !tells).then_some((before, close))
    });
    match found {
        Some((i, close)) => [&tokens[..i], &tokens[close..]].concat(),
        None => tokens,
    }
}

/// "a bus stands behind us, add it to the sketch": said twice.
fn added_again(tokens: Vec<Token>) -> Vec<Token> {
    const ADDS: &str =
        "add|put|draw|place|insert|include|bring|sketch|show|paint|enter|mark|note|take|write|pop|set|get";
    const INTO: &str = "to|into|in|on|onto";
    const WHOLE: &str = "sketch|scene|picture|drawing|plan|map|diagram|layout|image|scenario|situation|report|list|model|view|frame|file|setup|record|\
        panel|plot|chart|figure|screen|canvas|simulation|illustration|page|paper|board|protocol|record|test|set";
    let found = (4..tokens.len()).find_map(|i| {
        let linked = ends(tokens.get(i - 1)) || is(tokens.get(i - 1), &["and", "so", "please", "then"]);
        let n = begins(&tokens[i..], ADDS).filter(|_| linked)?;
        is(
            tokens.get(i + n),
            &["it", "him", "her", "them", "this", "that", "those", "these"],
        )
        .then_some(())?;
        let mut k = i + n + 1;
        if let Some(m) = begins(&tokens[k..], INTO) {
            let the = usize::from(is(tokens.get(k + m), &["the", "my", "our", "your", "this"]));
            k += m + the + begins(tokens.get(k + m + the..)?, WHOLE)?;
        } else if begins(&tokens[i..], "add|draw|include|insert|sketch") != Some(n) {
            return None;
        }
        k += begins(&tokens[k..], "too|please|as well|also|for me|then|now").unwrap_or(0);
        (k == tokens.len()).then_some(())?;
        let before = (0..i)
            .rev()
            .find(|k| !ends(tokens.get(*k)) && !is(tokens.get(*k), &["and", "so", "please", "then"]))?;
        let before = &tokens[..=before];
        let (a, _) = first_noun(before)?;
        let fresh = before[..a]
            .iter()
            .any(|t| number(t).is_some() || is(Some(t), &["a", "an", "another", "some", "more"]));
        // ("take a cone and put it in the picture" begins with what it takes)
        (fresh && verb_of(before).is_none_or(|v| v == Verb::Add)).then_some(before.len())
    });
    match found {
        Some(end) => tokens[..end].to_vec(),
        None => tokens,
    }
}

/// What the noun at the end of these words names.
fn class_of(np: &[Token]) -> Option<Class> {
    let (a, b) = first_noun(np)?;
    match super::words::longest(&np[a..b]).map(|l| l.0) {
        Some(Sense::Noun(n, _)) => n.classes.first().copied(),
        _ => None,
    }
}

/// "excavator over to the left edge, cones stay put": they stay anyhow.
fn stays_put(tokens: Vec<Token>, talk: &Talk<'_>) -> Vec<Token> {
    const STAYS: &str = "stay|stays|remain|remains|stay put|stays put|stay there|stays there|remain there|stay where they are|stays where it is|\
        remain where they are|remains where it is|stay in place|stays in place|remain in place|remains in place|can stay|may stay|can stay put|\
        stay as they are|stays as it is|remain as they are|remains as it is|untouched|unchanged|as they are|as it is";
    const REST: &str = "the rest|everything else|all else|the others|rest|others";
    let found = (3..tokens.len()).find_map(|i| {
        ends(tokens.get(i)).then_some(())?;
        let from = i + 1 + usize::from(is(tokens.get(i + 1), &["and", "but", "while"]));
        let rest = tokens.get(from..)?;
        let before = class_of(&tokens[..i])?;
        let end = match begins(rest, REST) {
            Some(n) => n,
            None => {
                let (a, b) = first_noun(rest)?;
                let other = class_of(rest).is_some_and(|c| c != before) && talk.fits(&rest[..b]) > 0;
                (other && (a == 0 || a == 1 && is(rest.first(), &["the", "my", "our", "both"])))
                    .then_some(b)?
            }
        };
        (from + end + begins(rest.get(end..)?, STAYS)? == tokens.len()).then_some(i)
    });
    // ("everything goes, the bus stays" spares it)
    let whole = |t: &Token| {
        is(
            Some(t),
            &[
                "all",
                "everything",
                "everybody",
                "everyone",
                "every",
                "only",
                "nothing",
                "else",
                "gone",
                "out",
                "off",
                "away",
            ],
        )
    };
    // (who goes somewhere, and is not gone; "kids on the left sidewalk, bus stays" is read whole)
    let goes = |i: usize| {
        let body = &tokens[..i];
        first_noun(body)
            .is_some_and(|x| x.0 < 4 && (x.1..body.len()).any(|k| is(body.get(k), &["to", "onto", "into"])))
    };
    match found {
        Some(i) if !tokens[..i].iter().any(whole) && goes(i) => tokens[..i].to_vec(),
        _ => tokens,
    }
}

/// "the red car is not alone, behind it follows a blue one": behind the red car.
fn not_alone(tokens: Vec<Token>, talk: &Talk<'_>) -> Vec<Token> {
    const ALONE: &str = "is not alone|isnt alone|is not alone any more|isnt alone any more|is no longer alone|is not alone anymore|isnt alone anymore|\
        are not alone|arent alone|are no longer alone|is not on its own|is not the only one|is not by itself|is not by himself|is not by herself";
    const BESIDE: &str = "behind|after|next to|beside|in front of|ahead of|alongside|near|close to|right behind|directly behind|close behind|just behind";
    let found = (1..tokens.len().min(8)).find_map(|i| {
        let n = begins(&tokens[i..], ALONE)?;
        let from = i + n + usize::from(ends(tokens.get(i + n)));
        let from = from + usize::from(is(tokens.get(from), &["and", "because", "since", "as"]));
        let by = begins(tokens.get(from..)?, BESIDE)?;
        is(tokens.get(from + by), &["it", "him", "her", "them"]).then_some(())?;
        (talk.fits(&tokens[..i]) > 0).then_some((i, from, from + by))
    });
    match found {
        Some((i, from, it)) => {
            let the = usize::from(!is(
                tokens.first(),
                &["the", "both", "our", "my", "that", "these", "those"],
            ));
            let the = led("the", &tokens[0], &[])[..the].to_vec();
            [&tokens[from..it], &the, &tokens[..i], &tokens[it + 1..]].concat()
        }
        None => tokens,
    }
}

/// "the learner behind us in the van", "the man at the wheel of the bus": the van, the bus.
fn in_vehicle(tokens: Vec<Token>, talk: &Talk<'_>) -> Vec<Token> {
    const WHERE: &str = "behind us|behind me|ahead of us|ahead of me|in front of us|in front of me|beside us|beside me|next to us|next to me";
    const IN: &str = "in the|in that|inside the|at the wheel of the|behind the wheel of the|at the steering wheel of the|behind the steering wheel of the|\
        driving the|who drives the|who is driving the|steering the|sitting in the|who sits in the|who is sitting in the|at the controls of the";
    // (who gets out is a person again)
    const OUT: &[&str] = &[
        "out",
        "climbs",
        "climbed",
        "alights",
        "leaves",
        "leave",
        "left",
        "lane",
        "stop",
        "s",
        "shelter",
        "park",
        "queue",
        "steps",
        "stepped",
        "exits",
        "exit",
        "wants",
        "says",
        "said",
        "told",
        "reports",
        "reported",
        "saw",
        "complains",
        "complained",
    ];
    rewritten(&tokens, |i, out| {
        is(tokens.get(i), &["the", "that"]).then_some(())?;
        let (at, n, place) = (i + 2..tokens.len().min(i + 5)).find_map(|k| {
            let place = begins(&tokens[k..], WHERE).unwrap_or(0);
            let n = begins(tokens.get(k + place..)?, IN)?;
            Some((k, n, place))
        })?;
        let who = &tokens[i + 1..at];
        let person = who
            .iter()
            .all(|t| t.kind == TokenKind::Word && number(t).is_none())
            && who.last().is_some_and(|t| match look_up(text(t)) {
                Some(Sense::Noun(n, _)) => n.classes.first() == Some(&Class::Pedestrian),
                _ => is(
                    Some(t),
                    &[
                        "learner",
                        "driver",
                        "beginner",
                        "novice",
                        "chauffeur",
                        "colleague",
                        "guy",
                        "chap",
                    ],
                ),
            });
        let what = at + place + n;
        let (a, b) = first_noun(&tokens[what..]).filter(|x| x.0 < 3)?;
        let wheels = class_of(&tokens[what + a..what + b]).is_some_and(|c| {
            matches!(
                c,
                Class::Car | Class::Truck | Class::Bus | Class::ConstructionVehicle
            )
        });
        let end = what + b;
        let gets_out = tokens[end..tokens.len().min(end + 4)]
            .iter()
            .any(|t| is(Some(t), OUT));
        let np = [&[word("the", &tokens[i])], &tokens[what..end]].concat();
        (person && wheels && !gets_out && talk.fits(&np) > 0).then(|| {
            out.extend(np);
            // ("the learner behind us in the van behind us")
            if begins(&tokens[end..], WHERE).is_none() {
                out.extend_from_slice(&tokens[at..at + place]);
            }
            end
        })
    })
}
