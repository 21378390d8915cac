//! Turns of speech of edits, put into words that the clause reader knows.

use super::super::tokens::{Token, TokenKind};
use super::super::wording::{replaced, without_order};
use super::Talk;
use super::lists::{MATES, STAYS};
use super::words::{find, first_noun, has_noun, is, is_finite, is_place, leads, led, number, text};

const WHOLE: &str =
    "the whole thing|the entire thing|this whole thing|the whole lot|the whole image|the whole situation";
const ON_FOOT: &str = "everyone who is on foot|everybody who is on foot|everyone on foot|everybody on foot|anyone on foot|anybody on foot|all who are on foot|all those on foot|those on foot|anyone who is on foot|anybody who is on foot|everyone whos on foot|everybody whos on foot|everyone who walks|everybody who walks|everyone who is walking|everybody who is walking|everyone going on foot|everyone walking|everybody walking|all people on foot|all persons on foot";
const DRY: &str = "let it stop raining|let it stop snowing|make it stop raining|make it stop snowing|it should stop raining|it should stop snowing|it has to stop raining|it must stop raining|it has stopped raining|it has stopped snowing|it stopped raining|it stopped snowing|its stopped raining|its stopped snowing|it stops raining|it stops snowing|it has ceased raining|it has quit raining|the rain has stopped|the rain stopped|the rain has ended|the rain is over|the rain has gone|the rain is gone|the rain stops|the rain has cleared|the rain has passed|the rain has let up|it no longer rains|it is no longer raining|its no longer raining|it isnt raining any more|it isnt raining anymore|it is not raining any more|it is not raining anymore|no more rain|the snow has stopped|the snowfall has stopped|it no longer snows|it is no longer snowing|the fog has lifted|the fog lifted|the fog has cleared|the fog is gone|the fog has gone|the storm has passed|the shower has passed|the shower is over|the clouds are gone|the clouds have gone|the clouds have cleared|the clouds have parted|the clouds have lifted|the clouds have passed|the clouds have disappeared|the clouds have moved on|the overcast is over|the overcast has cleared";

const IF_ONLY: &str =
    "if only there were|if only there was|i wish there were|i wish there was|if only we had|i wish we had";
const APPEARS: &str = "turns up|shows up|pops up|comes along|turn up|show up|pop up|appears on|appears in|appears at|comes into view";
const COMES_UP: &str = "walks up to|goes up to|comes up to|steps up to|runs up to|drives up to|rides up to|walk up to|go up to|come up to|step up to|run up to|drive up to|ride up to|strolls up to|stroll up to";

/// "let the car cut in, so that it sits between us": where it ends counts.
fn so_that(tokens: &[Token]) -> Vec<Token> {
    let found = find(
        tokens,
        &[
            "so that it",
            "so that he",
            "so that she",
            "so that they",
            "so it",
            "such that it",
        ],
    )
    .filter(|(i, n)| {
        let next = &tokens[i + n..];
        let stands = is(
            next.first(),
            &[
                "sits", "stands", "drives", "ends", "sit", "stand", "comes", "rides", "lands", "walks",
            ],
        );
        stands
            && (1..next.len().min(4)).any(|k| is_place(&next[k..]))
            && tokens[..*i]
                .iter()
                .any(|t| matches!(text(t), "let" | "have" | "make"))
    });
    let Some((i, n)) = found else {
        return tokens.to_vec();
    };
    let mut out = super::words::trimmed(&tokens[..i]).to_vec();
    out.extend(led("and", &tokens[i], &[&tokens[i + n..]]));
    out
}

/// A sentence of an edit in plain words; its tokens as they are, if there is nothing to change.
pub fn worded(sentence: &[Token], talk: &Talk<'_>) -> Vec<Token> {
    let (body, stop) = match sentence.split_last() {
        Some((last, body)) if last.kind == TokenKind::Stop => (body, std::slice::from_ref(last)),
        _ => (sentence, &[][..]),
    };
    if body.is_empty() {
        return sentence.to_vec();
    }
    let mut out = super::untouched::cut(body);
    if out.is_empty() {
        return stop.to_vec();
    }
    out = super::skies::plain(&out);
    // "there shouldn't be anyone on foot any more"
    if let Some((i, n)) = find(
        &out,
        &[
            "be anyone on foot",
            "be anybody on foot",
            "be any people on foot",
            "be any persons on foot",
        ],
    ) && out[..i]
        .iter()
        .any(|t| text(t).ends_with("nt") || matches!(text(t), "not" | "no"))
    {
        let late = leads(
            &out[i + n..],
            &["any more", "anymore", "any longer", "at all", "now"],
        )
        .unwrap_or(0);
        let rest = out[i + n + late..].to_vec();
        out = led("remove all the pedestrians", &out[0], &[&rest]);
    }
    out = replaced(&out, ON_FOOT, "all pedestrians");
    out = super::which::plain(out, talk);
    out = super::recast::plain(out, talk);
    if let Some(new) = second_one(&out) {
        out = new;
    }
    out = replaced(&out, IF_ONLY, "add");
    out = replaced(&out, "do without|dispense with|spare me|manage without", "remove");
    let whole = [
        "empty the scene",
        "clear the scene",
        "wipe the scene",
        "empty the picture",
        "clear the picture",
        "empty out the scene",
        "clear out the scene",
        "start from scratch",
        "start from an empty scene",
        "wipe the slate clean",
    ];
    if leads(&out, &whole).is_some_and(|n| n == out.len()) {
        out = led("remove everything", &out[0], &[]);
    }
    out = replaced(&out, APPEARS, "should be");
    out = replaced(&out, COMES_UP, "goes to");
    out = so_that(&out);
    for i in 1..out.len() {
        let noun = first_noun(&out[i + 1..]).is_some_and(|n| n.0 == 0);
        if text(&out[i]) == "each" && noun && super::super::rephrase::is_verb(&out[0]) {
            out[i].text = "every".into();
        }
    }
    out = super::gaps::filled(out, talk);
    if let Some(new) = super::idioms::plain(&out, talk).or_else(|| super::passive::added(&out, talk)) {
        out = new;
    }
    out = without_order(&out);
    out = replaced(&out, WHOLE, "the scene");
    out = replaced(&out, DRY, "clear weather");
    out = mates(out);
    out = denied_place(out);
    out = lifted(out);
    out = beside_me(out);
    out = as_far(out, talk);
    if let Some(new) = one_not_other(&out, talk) {
        out = new;
    }
    out.extend_from_slice(stop);
    out
}

/// "his mate stays put": the other one.
fn mates(mut tokens: Vec<Token>) -> Vec<Token> {
    let found = (0..tokens.len().saturating_sub(1)).find(|i| {
        is(tokens.get(*i), &["his", "her", "their", "its"])
            && is(tokens.get(i + 1), &MATES)
            && !tokens[i + 2..].is_empty()
            && (leads(&tokens[i + 2..], &STAYS).is_some()
                || is(
                    tokens.get(i + 2),
                    &[
                        "does", "doesnt", "has", "didnt", "remained", "is", "will", "wont", "goes", "walks",
                        "stands", "keeps", "waits",
                    ],
                ))
    });
    if let Some(i) = found {
        let many = text(&tokens[i + 1]).ends_with('s');
        let other = led(if many { "the others" } else { "the other" }, &tokens[i], &[]);
        tokens.splice(i..i + 2, other);
    }
    tokens
}

/// "to my right, not left": where it shall not be is known by where it shall.
fn denied_place(mut tokens: Vec<Token>) -> Vec<Token> {
    let places = [
        "left",
        "right",
        "behind",
        "ahead",
        "front",
        "in front",
        "to the left",
        "to the right",
        "on the left",
        "on the right",
        "to my left",
        "to my right",
        "on my left",
        "on my right",
        "the left",
        "the right",
        "in front of me",
        "behind me",
        "in the front",
        "at the back",
    ];
    let found = (1..tokens.len()).find_map(|i| {
        let n = is(tokens.get(i), &["not", "instead"]).then_some(1)?;
        let of = usize::from(is(tokens.get(i), &["instead"]) && is(tokens.get(i + 1), &["of"]));
        if is(tokens.get(i), &["instead"]) && of == 0 {
            return None;
        }
        let len = leads(&tokens[i + n + of..], &places)?;
        let end = i + n + of + len;
        let ends = tokens
            .get(end)
            .is_none_or(|t| matches!(t.kind, TokenKind::Comma | TokenKind::Mark | TokenKind::Stop));
        let comma = tokens[i - 1].kind == TokenKind::Comma;
        (ends && comma && i > 2).then_some((i - 1, end))
    });
    if let Some((from, to)) = found {
        tokens.drain(from..to);
    }
    tokens
}

/// "cones not barriers - replace all four, same spot": one kind for the other.
fn one_not_other(tokens: &[Token], talk: &Talk<'_>) -> Option<Vec<Token>> {
    let meant = leads(
        tokens,
        &[
            "i meant",
            "i mean",
            "i said",
            "they should be",
            "those should be",
            "these should be",
            "they must be",
            "those must be",
            "those are",
            "they are",
            "these are",
            "theyre",
            "make them",
            "make those",
            "make these",
        ],
    );
    let tokens = &tokens[meant.unwrap_or(0)..];
    let (a0, a1) = first_noun(tokens).filter(|n| n.0 <= 1)?;
    let not = leads(
        &tokens[a1..],
        &["not", "instead of", "rather than", "in place of"],
    )
    .map(|n| a1 + n)
    .or_else(|| {
        let comma = tokens.get(a1).is_some_and(|t| t.kind == TokenKind::Comma);
        (comma && is(tokens.get(a1 + 1), &["not"])).then_some(a1 + 2)
    })?;
    let (b0, b1) = first_noun(&tokens[not..]).filter(|n| n.0 <= 1)?;
    let (old, rest) = (&tokens[not + b0..not + b1], &tokens[not + b1..]);
    let swaps = find(
        rest,
        &[
            "replace",
            "swap",
            "exchange",
            "change",
            "same spot",
            "same place",
            "same spots",
            "same places",
            "same position",
            "same positions",
            "please",
        ],
    )
    .is_some();
    let number_led = a0 == 1 && number(&tokens[0]).is_some();
    if has_noun(rest) || !(swaps || meant.is_some() && rest.len() < 2) || talk.fits(old) == 0 || number_led {
        return None;
    }
    let many = matches!(
        super::look_up(text(old.last()?)),
        Some(super::Sense::Noun(_, true))
    );
    let lead = if many { "replace all the" } else { "replace the" };
    let with = led(
        if many { "with" } else { "with a" },
        &tokens[a0],
        &[&tokens[a0..a1]],
    );
    Some(led(lead, &tokens[a0], &[old, &with]))
}

/// "the cyclist gets company: a second one rides behind the first": another cyclist, behind the cyclist.
fn second_one(tokens: &[Token]) -> Option<Vec<Token>> {
    let (i, n) = find(
        tokens,
        &[
            "a second one",
            "another one",
            "a further one",
            "a third one",
            "one more of them",
        ],
    )?;
    let (a, b) = first_noun(&tokens[..i])?;
    let noun = &tokens[a..b];
    let company = find(
        &tokens[..i],
        &[
            "company",
            "companion",
            "joined",
            "not alone",
            "no longer alone",
            "reinforcement",
            "reinforcements",
            "support",
            "escort",
        ],
    )?;
    debug_assert!(company.0 < i);
    let rest = &tokens[i + n..];
    let verb = rest.first().is_some_and(|t| is_finite(text(t), false));
    let mut out = led(if verb { "another" } else { "add another" }, &tokens[i], &[noun]);
    match find(
        rest,
        &[
            "the first one",
            "the first",
            "the other one",
            "the other",
            "him",
            "her",
            "it",
            "them",
        ],
    ) {
        Some((k, m)) => {
            out.extend_from_slice(&rest[..k]);
            out.extend(led("the", &tokens[i], &[noun]));
            out.extend_from_slice(&rest[k + m..]);
        }
        None => out.extend_from_slice(rest),
    }
    Some(out)
}

/// "take the man off the sidewalk and put him on the road": only where it is put counts.
fn lifted(tokens: Vec<Token>) -> Vec<Token> {
    let takes = is(
        tokens.first(),
        &[
            "take", "get", "grab", "pick", "lift", "fetch", "pull", "remove", "bring",
        ],
    );
    let noun = first_noun(&tokens).filter(|n| n.0 < 6 && takes);
    let put = (2..tokens.len().saturating_sub(2)).find(|i| {
        is(
            tokens.get(*i),
            &[
                "put", "place", "set", "move", "bring", "park", "lay", "send", "stand",
            ],
        ) && is(tokens.get(i + 1), &["it", "them", "him", "her"])
            && is(tokens.get(i - 1), &["and", "then"])
    });
    let (Some((_, end)), Some(put)) = (noun, put) else {
        return tokens;
    };
    let off = is(tokens.get(end), &["out", "off", "away", "from", "up"]);
    let place = (put + 2..tokens.len()).any(|i| is_place(&tokens[i..]));
    if !off || !place || put <= end {
        return tokens;
    }
    let any = is(tokens.get(1), &["any"]);
    let mut out = led(if any { "move" } else { "put" }, &tokens[0], &[&tokens[1..end]]);
    out.extend_from_slice(&tokens[put + 2..]);
    out
}

/// "woman to my right": a place, and no way to go, where nothing is moved.
fn beside_me(mut tokens: Vec<Token>) -> Vec<Token> {
    let noun = first_noun(&tokens).filter(|n| n.0 <= 2 && !super::super::rephrase::is_verb(&tokens[0]));
    let Some((_, end)) = noun else {
        return tokens;
    };
    let side = find(
        &tokens,
        &["to my right", "to my left", "to our right", "to our left"],
    );
    if is(tokens.first(), &["a", "an", "another", "some"]) || number(&tokens[0]).is_some() {
        return tokens;
    }
    if let Some((i, _)) = side.filter(|s| s.0 == end) {
        let be = led("should be on", &tokens[i], &[]);
        tokens.splice(i..=i, be);
    }
    tokens
}

/// "on my right, same distance": as many metres as it is away now.
fn as_far(tokens: Vec<Token>, talk: &Talk<'_>) -> Vec<Token> {
    let same = find(
        &tokens,
        &[
            "at the same distance",
            "in the same distance",
            "same distance",
            "the same distance",
            "equally far",
        ],
    );
    let side = find(
        &tokens,
        &[
            "on my right",
            "on my left",
            "to my right",
            "to my left",
            "on the right",
            "on the left",
            "behind me",
            "ahead of me",
            "in front of me",
            "on our right",
            "on our left",
            "to our right",
            "to our left",
            "behind us",
            "ahead of us",
            "in front of us",
        ],
    );
    // ("from behind us to in front of us": where it goes)
    let side = side.map(|(i, n)| {
        match find(
            &tokens[i + n..],
            &[
                "in front of us",
                "in front of me",
                "ahead of us",
                "ahead of me",
                "behind us",
                "behind me",
            ],
        ) {
            Some((k, m)) if is(tokens.get(i.wrapping_sub(1)), &["from"]) => (i + n + k, m),
            _ => (i, n),
        }
    });
    let noun = first_noun(&tokens).filter(|n| n.0 < 4);
    let (Some((at, n)), Some((place, _)), Some((_, end))) = (same, side, noun) else {
        return tokens;
    };
    let from = usize::from(super::super::rephrase::is_verb(&tokens[0]));
    let Some(metres) = tokens
        .get(from..end)
        .and_then(|np| talk.range(np))
        .filter(|_| place < at)
    else {
        return tokens;
    };
    let mut out = tokens[..place].to_vec();
    out.push(Token {
        kind: TokenKind::Number(metres),
        text: format!("{metres}"),
        span: tokens[place].span,
    });
    out.extend(led("m", &tokens[place], &[&tokens[place..at]]));
    while out
        .last()
        .is_some_and(|t| t.kind == TokenKind::Comma || matches!(text(t), "and" | "but"))
    {
        out.pop();
    }
    out.extend_from_slice(&tokens[at + n..]);
    out
}
