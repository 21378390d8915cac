//! Lanes and pavements that are left out or pointed to: "the one to my right", "and the right lane a truck", "in the
//! neighbouring lane".

use super::ellipsis::{ends, is_noun, is_strip, is_unit, number};
use super::tokens::{Token, TokenKind};
use super::wording::{begins, replaced, rewritten, word};

/// "the lane to my left has a bus in it, the one to my right a taxi": a lane again, which has something again.
pub(super) fn one_lane(sentence: &[Token]) -> Vec<Token> {
    const SIDES: &str = "to my right|to my left|to our right|to our left|on my right|on my left|on our right|on our left|on the right|on the left|to the right|to the left";
    let Some(lane) = sentence.iter().position(|t| t.text == "lane") else {
        return sentence.to_vec();
    };
    let has = sentence[lane..]
        .iter()
        .find(|t| matches!(t.text.as_str(), "has" | "holds" | "contains" | "carries"));
    let sentence = &replaced(sentence, "holds a|contains a|carries a", "has a")[..];
    let mut out = sentence[..lane].to_vec();
    let mut i = lane;
    while i < sentence.len() {
        let one =
            begins(&sentence[i..], "the one|that").filter(|n| begins(&sentence[i + n..], SIDES).is_some());
        let Some(n) = one else {
            out.push(sentence[i].clone());
            i += 1;
            continue;
        };
        let at = out.len();
        out.extend(["the", "lane"].map(|w| word(w, &sentence[i])));
        i += n;
        let side = begins(&sentence[i..], SIDES).unwrap_or(0);
        out.extend_from_slice(&sentence[i..i + side]);
        i += side;
        let fresh = sentence
            .get(i)
            .is_some_and(|t| matches!(t.text.as_str(), "a" | "an" | "another") || number(t).is_some());
        if fresh && has.is_some() {
            out.push(word("has", &sentence[i]));
            if let Some(t) = out
                .get_mut(at.saturating_sub(1))
                .filter(|t| t.kind == TokenKind::Comma)
            {
                t.kind = TokenKind::Stop;
            }
        }
    }
    out
}

/// "on the left sidewalk ... on the right one", "three lanes, and I drive in the middle one": on the right sidewalk, in the middle
/// lane.
pub(super) fn strip_named_before(tokens: &[Token]) -> Vec<Token> {
    const STRIPS: &str = "sidewalk|sidewalks|pavement|pavements|footpath|footpaths|lane|lanes|kerb|kerbs|curb|curbs|roadside|edge|shoulder|shoulders|verge|verges";
    const IN: &str = "on|onto|to|in|into|at|along|down";
    const SIDE: &str =
        "left|right|middle|centre|center|opposite|oncoming|left hand|right hand|leftmost|rightmost";
    const NEXT: &str =
        "and|but|while|too|instead|as|now|again|ahead|behind|is|are|with|where|i|we|beside|next|in|of";
    let mut strip: Option<String> = None;
    rewritten(tokens, |i, out| {
        let t = &tokens[i];
        if begins(&tokens[i..], STRIPS).is_some() {
            strip = Some(t.text.trim_end_matches('s').to_string());
        } else if is_noun(t) && out.last().is_some_and(|b| b.text == "the") {
            strip = None; // ("the bus in the left lane and the car behind the right one")
        }
        let led = (1..=2).any(|n| {
            i >= n + 2
                && begins(&tokens[i - n - 2..], IN).is_some()
                && tokens[i - n - 1].text == "the"
                && begins(&tokens[i - n..i], SIDE) == Some(n)
        });
        let ends = ends(tokens.get(i + 1)) || begins(&tokens[i + 1..], NEXT).is_some();
        let strip = strip.as_ref().filter(|_| t.text == "one" && led && ends)?;
        out.push(word(strip, t));
        Some(i + 1)
    })
}

/// "the left lane contains two cars, and the right lane a truck": which has it again.
pub(super) fn has_again(sentence: &[Token]) -> Vec<Token> {
    let place = |t: &Token| is_strip(&t.text) || matches!(t.text.as_str(), "lane" | "side" | "one");
    let verb = sentence.iter().position(|t| {
        matches!(
            t.text.as_str(),
            "has" | "holds" | "contains" | "carries" | "hosts" | "features" | "gets"
        )
    });
    let Some(verb) = verb.filter(|v| sentence[..*v].iter().rev().take(5).any(place)) else {
        return sentence.to_vec();
    };
    let mut out = sentence[..=verb].to_vec();
    let mut i = verb + 1;
    while i < sentence.len() {
        let opens =
            sentence[i].kind == TokenKind::Comma || matches!(sentence[i].text.as_str(), "and" | "while");
        let the = i
            + 1
            + usize::from(
                sentence
                    .get(i + 1)
                    .is_some_and(|t| matches!(t.text.as_str(), "and" | "while")),
            );
        let named = opens
            && sentence
                .get(the)
                .is_some_and(|t| matches!(t.text.as_str(), "the" | "my" | "our"));
        // the place, and what it has at once after it
        let fresh = (the + 2..sentence.len().min(the + 8))
            .take_while(|k| !ends(sentence.get(*k)) && !is_noun(&sentence[*k - 1]))
            .find(|k| {
                let again = sentence[*k].text == "one"
                    && matches!(
                        sentence[*k - 1].text.as_str(),
                        "left" | "right" | "hand" | "other" | "far" | "near" | "opposite" | "oncoming"
                    );
                (matches!(sentence[*k].text.as_str(), "a" | "an" | "another")
                    || number(&sentence[*k]).is_some())
                    && !again
                    && !sentence.get(k + 1).is_some_and(is_unit)
            });
        match fresh.filter(|k| named && sentence[the..*k].iter().any(place)) {
            Some(fresh) => {
                out.push(Token {
                    kind: TokenKind::Stop,
                    ..word(".", &sentence[i])
                });
                for t in &sentence[the..fresh] {
                    let same = sentence[..verb]
                        .iter()
                        .rev()
                        .find(|p| place(p) && p.text != "one");
                    match same.filter(|_| t.text == "one") {
                        Some(p) => out.push(word(&p.text, t)),
                        None => out.push(t.clone()),
                    }
                }
                out.push(word("has", &sentence[fresh]));
                i = fresh;
            }
            None => {
                out.push(sentence[i].clone());
                i += 1;
            }
        }
    }
    out
}

/// "to the right of us, in the neighbouring lane": in the right lane.
pub(super) fn next_lane(sentence: &[Token]) -> Vec<Token> {
    const NEXT: &str = "neighbouring lane|neighboring lane|adjacent lane|adjoining lane|next lane|lane next to us|lane next to me|lane next to ours|lane beside us|lane beside ours|lane beside me|lane alongside|lane next to mine|lane beside mine";
    let mut out: Vec<Token> = Vec::new();
    let mut i = 0;
    while i < sentence.len() {
        let side = |t: &&Token| matches!(t.text.as_str(), "left" | "right");
        let stop = |t: &&Token| t.kind != TokenKind::Stop && t.text != "while";
        let next = begins(&sentence[i..], NEXT).and_then(|n| {
            let after = sentence[i + n..]
                .iter()
                .take(5)
                .take_while(|t| stop(t) && t.kind != TokenKind::Comma);
            let before = out.iter().rev().take(12).take_while(|t: &&Token| stop(t));
            let side = after
                .into_iter()
                .find(side)
                .or_else(|| before.into_iter().find(side))?;
            Some((n, side.text.clone()))
        });
        match next {
            Some((n, side)) => {
                out.extend([side.as_str(), "lane"].map(|w| word(w, &sentence[i])));
                i += n;
            }
            None => {
                out.push(sentence[i].clone());
                i += 1;
            }
        }
    }
    out
}
