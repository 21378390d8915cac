//! Strips told by who is there: "in the same lane as the bus", "let a truck drive in that lane", "on the pavement opposite".

use super::super::holds::role_of;
use super::super::tokens::{Token, TokenKind};
use super::super::wording::{begins, rewritten};
use super::Talk;
use super::words::{first_noun, is, led, text};
use crate::scene::SceneBox;
use crate::scene::graph::LaneRole as L;

const STRIP: &str = "lane|sidewalk|pavement|footpath|walkway|footway|kerb|curb|roadside|side of the road|side of the street|edge of the road|verge|shoulder";

/// A sentence in which they bear their names.
pub fn plain(tokens: Vec<Token>, talk: &Talk<'_>) -> Vec<Token> {
    let out = goes_over(owners_lane(as_before(opposite_last(tokens)), talk), talk);
    own_lane(in_that(same_as(in_theirs(out, talk), talk), talk), talk)
}

/// "a car follows the two cyclists in their lane": where these are.
fn in_theirs(tokens: Vec<Token>, talk: &Talk<'_>) -> Vec<Token> {
    let fresh = is(
        tokens.first(),
        &[
            "a", "an", "another", "add", "put", "make", "let", "have", "place", "two",
        ],
    );
    rewritten(&tokens, |i, out| {
        let own =
            is(tokens.get(i), &["his", "her", "its", "their"]) && is(out.last(), &["in", "along", "on"]);
        let n = begins(tokens.get(i + 1..)?, "lane|own lane|very lane").filter(|_| own && fresh)?;
        let at = (0..out.len())
            .rev()
            .find(|k| is(out.get(*k), &["the", "that", "both", "those"]))?;
        let (_, b) = first_noun(&out[at..]).filter(|x| x.0 < 4)?;
        let name = name_of(&talk.boxes_of(&out[at..at + b]), talk).filter(|name| is_of_kind(true, name))?;
        // (a comma parts nothing here)
        let comma = out
            .len()
            .checked_sub(2)
            .filter(|k| out[*k].kind == TokenKind::Comma);
        if let Some(k) = comma {
            out.remove(k);
        }
        out.extend(led(name, &tokens[i], &[]));
        Some(i + 1 + n)
    })
}

/// "only 7 m ahead, same lane as before": what is not told otherwise stays so.
fn as_before(tokens: Vec<Token>) -> Vec<Token> {
    const BEFORE: &str = "in the same lane as before|the same lane as before|same lane as before|in the same lane as now|same lane as now|still in the same lane|still in its lane|in its own lane as before|on the same side as before|same side as before";
    rewritten(&tokens, |i, out| {
        let comma = usize::from(tokens[i].kind == TokenKind::Comma);
        let n = begins(tokens.get(i + comma..)?, BEFORE).filter(|_| comma == 1 && !out.is_empty())?;
        let end = i + comma + n;
        tokens
            .get(end)
            .is_none_or(|t| t.kind != TokenKind::Word)
            .then_some(end)
    })
}

/// "in the coach's lane": where the coach is.
fn owners_lane(tokens: Vec<Token>, talk: &Talk<'_>) -> Vec<Token> {
    rewritten(&tokens, |i, out| {
        let (_, b) = first_noun(&tokens[i..]).filter(|x| x.0 < 4 && is(tokens.get(i), &["the", "that"]))?;
        let lane = is(tokens.get(i + b), &["lane"])
            && is(out.last(), &["in", "into", "to", "along"])
            // ("the bus lane" is a lane for buses)
            && talk.text.to_lowercase().contains("s lane")
            && talk.text.contains(['\'', '\u{2019}']);
        let name =
            name_of(&talk.boxes_of(&tokens[i..i + b]), talk).filter(|name| lane && is_of_kind(true, name))?;
        out.extend(led(name, &tokens[i], &[]));
        // ("in the coach's lane behind it": behind the coach)
        let end = i + b + 1;
        let by = begins(
            tokens.get(end..)?,
            "behind|ahead of|in front of|after|right behind|just behind",
        );
        let it = by
            .map(|n| end + n)
            .filter(|k| is(tokens.get(*k), &["it", "him", "her"]));
        if let Some(k) = it {
            out.extend_from_slice(&tokens[end..k]);
            out.extend_from_slice(&tokens[i..i + b]);
        }
        Some(it.map_or(end, |k| k + 1))
    })
}

/// "the van is 15 m behind us in its lane": the lane where it drives now.
fn own_lane(tokens: Vec<Token>, talk: &Talk<'_>) -> Vec<Token> {
    const OWN: &str = "in its lane|in its own lane|to its lane|to its own lane|within its lane|in his lane|in his own lane|in her lane|in their lane|\
        in their own lane|along its lane|along its own lane|on its lane|on its own lane|in its current lane|in its present lane|to his lane";
    rewritten(&tokens, |i, out| {
        let n = begins(&tokens[i..], OWN)?;
        // ("it keeps to its lane" asks for nothing)
        if is(out.last(), &["keep", "keeps", "keeping", "sticks", "stick"]) {
            let verb = if text(out.last()?).ends_with('s') {
                "stays"
            } else {
                "stay"
            };
            out.pop();
            out.extend(led(verb, &tokens[i], &[]));
            out.extend(led("in its lane", &tokens[i], &[]));
            return Some(i + n);
        }
        const STAYS: &[&str] = &[
            "stay",
            "stays",
            "staying",
            "remain",
            "remains",
            "remaining",
            "left",
            "it",
            "him",
            "them",
        ];
        (!is(out.last(), STAYS)).then_some(())?;
        // (who goes back to it is not in it)
        (!is(
            out.last(),
            &["back", "return", "returns", "returned", "again", "over"],
        ))
        .then_some(())?;
        let named = (0..out.len()).rev().find_map(|k| {
            let the = is(out.get(k), &["the", "that", "both", "my", "our"]);
            let (a, b) = first_noun(&out[k..]).filter(|x| x.0 < 4 && (the || k == 0))?;
            Some((k + usize::from(!the) * a, k + b))
        });
        let name = match named {
            Some((a, b)) => name_of(&talk.boxes_of(&out[a..b]), talk)?,
            None => {
                let np = led(&format!("the {}", talk.last.as_deref()?), &tokens[i], &[]);
                name_of(&talk.boxes_of(&np), talk)?
            }
        };
        is_of_kind(true, name).then_some(())?;
        out.push(tokens[i].clone());
        out.extend(led(name, &tokens[i], &[]));
        Some(i + n)
    })
}

/// "the vans go over to the right", who stand at the left kerb: to the kerb there.
fn goes_over(tokens: Vec<Token>, talk: &Talk<'_>) -> Vec<Token> {
    const GOES: &str = "go|goes|move|moves|come|comes|cross|crosses|change|changes|swing|swings|switch|switches|went|moved|crossed|should go|should move|should cross|must go|shift|shifts|get|gets";
    const TO: &str = "over to the|across to the|to the";
    const SIDE: &str = "side|hand side|one|side of the road|side of the street|hand side of the road|hand side of the street";
    rewritten(&tokens, |i, out| {
        let goes = begins(&tokens[i..], GOES)?;
        let over = is(tokens.get(i + goes), &["over", "across"]);
        let at = i + goes + begins(&tokens[i + goes..], TO)?;
        let side = text(tokens.get(at)?).to_string();
        let n = begins(&tokens[at + 1..], SIDE).filter(|_| is(tokens.get(at), &["left", "right"]));
        (over || n.is_some()).then_some(())?;
        let end = at + 1 + n.unwrap_or(0);
        let closes = tokens
            .get(end)
            .is_none_or(|t| t.kind != TokenKind::Word || is(Some(t), &["and", "now", "please", "too"]));
        let name = (0..out.len()).rev().find_map(|k| {
            is(
                out.get(k),
                &["the", "that", "both", "all", "my", "every", "those", "these"],
            )
            .then_some(())?;
            let (_, b) = first_noun(&out[k..]).filter(|x| x.0 < 4)?;
            name_of(&talk.boxes_of(&out[k..k + b]), talk)
        })?;
        let strip = name
            .strip_prefix("the left ")
            .or(name.strip_prefix("the right "))
            .filter(|s| matches!(*s, "roadside" | "sidewalk"))?;
        (closes && matches!(side.as_str(), "left" | "right")).then(|| {
            out.extend(led(&format!("should be on the {side} {strip}"), &tokens[i], &[]));
            end
        })
    })
}

/// "on the pavement opposite": on the opposite pavement.
fn opposite_last(tokens: Vec<Token>) -> Vec<Token> {
    rewritten(&tokens, |i, out| {
        let n = begins(&tokens[i..], STRIP).filter(|_| is(out.last(), &["the"]))?;
        let m = begins(
            &tokens[i + n..],
            "opposite|across the road|across the street|over the road|over the way|across the way",
        )?;
        let end = i + n + m;
        // ("on the kerb opposite the bus" is across from it)
        tokens
            .get(end)
            .is_none_or(|t| t.kind != TokenKind::Word || is(Some(t), &["and", "too", "please", "instead"]))
            .then(|| {
                out.extend(led("opposite", &tokens[i], &[&tokens[i..i + n]]));
                end
            })
    })
}

/// The words for where all of these are, if that is one lane or strip.
pub(super) fn name_of(boxes: &[SceneBox], talk: &Talk<'_>) -> Option<&'static str> {
    let role = role_of(talk.map, boxes.first()?)?;
    let all = boxes.iter().all(|b| role_of(talk.map, b) == Some(role));
    let name = match role {
        L::Ego => "our lane",
        L::Left => "the left lane",
        L::Right => "the right lane",
        L::Oncoming => "the oncoming lane",
        L::LeftSidewalk => "the left sidewalk",
        L::RightSidewalk => "the right sidewalk",
        L::LeftRoadside => "the left roadside",
        L::RightRoadside => "the right roadside",
        _ => return None,
    };
    all.then_some(name)
}

/// True if a lane is spoken of and named, or a strip and no lane.
fn is_of_kind(lane: bool, name: &str) -> bool {
    lane == name.ends_with(" lane")
}

/// "in the same lane as the bus": in the oncoming lane, if it is there.
fn same_as(tokens: Vec<Token>, talk: &Talk<'_>) -> Vec<Token> {
    rewritten(&tokens, |i, out| {
        let the = usize::from(is(tokens.get(i), &["the"]));
        let same = i + the;
        let n = begins(tokens.get(same + 1..)?, STRIP).filter(|_| is(tokens.get(same), &["same"]))?;
        let as_ = same + 1 + n;
        is(tokens.get(as_), &["as"]).then_some(())?;
        let np = &tokens[as_ + 1..];
        let (_, b) = first_noun(np).filter(|x| x.0 < 4 && is(np.first(), &["the", "that", "those"]))?;
        let name = name_of(&talk.boxes_of(&np[..b]), talk)?;
        is_of_kind(is(tokens.get(same + 1), &["lane"]), name).then_some(())?;
        if !is(out.last(), &["in", "on", "along", "at", "into", "onto", "to"]) {
            let at = if name.ends_with(" lane") { "in" } else { "on" };
            out.extend(led(at, &tokens[i], &[]));
        }
        out.extend(led(name, &tokens[i], &[]));
        Some(as_ + 1 + b)
    })
}

/// "delete the taxi, then let a bus come towards us in that lane": where the taxi was.
fn in_that(tokens: Vec<Token>, talk: &Talk<'_>) -> Vec<Token> {
    rewritten(&tokens, |i, out| {
        let that = is(tokens.get(i), &["that", "this"])
            && is(
                out.last(),
                &["in", "on", "along", "into", "onto", "at", "down", "to"],
            );
        let n = begins(tokens.get(i + 1..)?, STRIP).filter(|_| that)?;
        // ("on that side of the bus" says where)
        is(tokens.get(i + 1 + n), &["of", "as", "where", "which"])
            .then_some(())
            .map_or(Some(()), |()| None)?;
        let lane = is(tokens.get(i + 1), &["lane"]);
        // what was named before it in the sentence, else what was spoken of last
        let before = (0..out.len()).rev().find_map(|k| {
            is(out.get(k), &["the", "that", "both", "my"]).then_some(())?;
            let (_, b) = first_noun(&out[k..]).filter(|x| x.0 < 4)?;
            name_of(&talk.boxes_of(&out[k..k + b]), talk).filter(|name| is_of_kind(lane, name))
        });
        let last = || {
            let np = led(&format!("the {}", talk.last.as_deref()?), &tokens[i], &[]);
            name_of(&talk.boxes_of(&np), talk).filter(|name| is_of_kind(lane, name))
        };
        // ("three cones in that lane": where those stand that are there)
        let own = || {
            let (a, b) = first_noun(out).filter(|x| x.1 + 1 == out.len())?;
            name_of(&talk.boxes_of(&out[a..b]), talk).filter(|name| is_of_kind(lane, name))
        };
        let name = before.or_else(last).or_else(own)?;
        out.extend(led(name, &tokens[i], &[]));
        Some(i + 1 + n)
    })
}
