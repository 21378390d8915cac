//! Lines of several and how long they are: "make the queue four cars long", "the row is one car longer".

use super::super::holds::role_of;
use super::super::tokens::Token;
use super::Talk;
use super::words::{first_noun, is, led, number, text, trimmed};
use crate::scene::graph::LaneRole as L;

/// A sentence (without its stop) that says it in plain numbers.
pub fn plain(tokens: Vec<Token>, talk: &Talk<'_>) -> Vec<Token> {
    so_long(&tokens, talk).unwrap_or(tokens)
}

/// "make the queue four cars long", "lengthen the row to five cars", "the queue is one car longer": so many, where they are.
fn so_long(tokens: &[Token], talk: &Talk<'_>) -> Option<Vec<Token>> {
    const LINES: &[&str] = &[
        "queue", "row", "line", "column", "convoy", "string", "chain", "tailback", "jam", "file",
    ];
    const LONGER: &[&str] = &["longer", "shorter"];
    const MORE: &[&str] = &[
        "lengthen", "extend", "expand", "prolong", "grow", "increase", "enlarge",
    ];
    const AROUND: &[&str] = &[
        "make", "let", "have", "be", "is", "are", "should", "must", "shall", "has", "to", "now", "only",
        "just", "gets", "get", "becomes", "become", "grows", "grow", "by", "lengthen", "extend", "expand",
        "prolong", "increase", "enlarge", "out", "up", "could", "can", "needs", "ought", "of", "will", "i",
        "want", "would", "like", "need", "it", "a", "total", "further",
    ];
    let line = tokens
        .iter()
        .take(8)
        .position(|t| is(Some(t), LINES))
        .filter(|k| *k > 0 && is(tokens.get(k - 1), &["the", "that", "this", "our"]))?;
    let n = (line + 1..tokens.len()).find(|k| number(&tokens[*k]).is_some())?;
    let small = |t: &Token| AROUND.contains(&text(t)) || LONGER.contains(&text(t));
    let of = usize::from(is(tokens.get(line + 1), &["of"]));
    let named = first_noun(&tokens[line + 1..n]).filter(|x| of == 1 && x.0 < 3);
    let after = &tokens[line + 1 + named.map_or(0, |x| x.1)..n];
    (tokens[..line - 1].iter().all(small) && after.iter().all(small)).then_some(())?;
    let what = &tokens[n + 1..];
    let more = usize::from(is(what.first(), &["more", "fewer", "less"]));
    let own = first_noun(&what[more..]).filter(|x| x.0 == 0);
    let end = more + own.map_or(0, |x| x.1);
    let tail = &what[end..];
    let long = is(tail.first(), &["long", "in"]) || is(tail.first(), LONGER);
    let rest = trimmed(&tail[usize::from(long)..]);
    let noun = match (own, named) {
        (Some(_), _) => &what[more..end],
        (None, Some((a, b))) => &tokens[line + 1 + a..line + 1 + b],
        (None, None) => return None,
    };
    let longer = |w: &str| tokens.iter().any(|t| text(t) == w);
    let by = longer("longer")
        || is(tokens.get(n.checked_sub(1)?), &["by"]) && tokens.iter().any(|t| MORE.contains(&text(t)));
    let told = long || by || longer("shorter") || tokens[..line].iter().any(|t| MORE.contains(&text(t)));
    (told && rest.is_empty()).then_some(())?;
    let many = &tokens[n..=n];
    if longer("shorter") {
        return Some(led(
            "remove",
            &tokens[0],
            &[many, &led("of the", &tokens[0], &[noun])],
        ));
    }
    let place = led(of_the_line(talk, noun)?, &tokens[0], &[]);
    let verb = if by { "add" } else { "keep exactly" };
    let more = led("more", &tokens[0], &[])[..usize::from(by)].to_vec();
    Some(led(verb, &tokens[0], &[many, &more, noun, &place]))
}

/// The words for where all of a kind stand one behind the other.
fn of_the_line(talk: &Talk<'_>, noun: &[Token]) -> Option<&'static str> {
    let there = talk.boxes_of(&led("all", &noun[0], &[noun]));
    let there = if there.is_empty() {
        talk.boxes_of(noun)
    } else {
        there
    };
    let lanes: Vec<L> = there.iter().filter_map(|b| role_of(talk.map, b)).collect();
    // (the line is where most of them are)
    let role = *lanes
        .iter()
        .max_by_key(|r| lanes.iter().filter(|o| o == r).count())?;
    let in_line = || there.iter().filter(|b| role_of(talk.map, b) == Some(role));
    let ahead = in_line().all(|b| b.center_m.x > 0.0);
    let behind = in_line().all(|b| b.center_m.x < 0.0);
    Some(match (role, ahead, behind) {
        (L::Ego, true, _) => "in our lane ahead of us",
        (L::Ego, _, true) => "in our lane behind us",
        (L::Ego, ..) => "in our lane",
        (L::Left, true, _) => "in the left lane ahead of us",
        (L::Left, _, true) => "in the left lane behind us",
        (L::Left, ..) => "in the left lane",
        (L::Right, true, _) => "in the right lane ahead of us",
        (L::Right, _, true) => "in the right lane behind us",
        (L::Right, ..) => "in the right lane",
        (L::Oncoming, true, _) => "in the oncoming lane ahead of us",
        (L::Oncoming, _, true) => "in the oncoming lane behind us",
        (L::Oncoming, ..) => "in the oncoming lane",
        (L::LeftRoadside, ..) => "on the left roadside",
        (L::RightRoadside, ..) => "on the right roadside",
        (L::LeftSidewalk, ..) => "on the left sidewalk",
        (L::RightSidewalk, ..) => "on the right sidewalk",
        _ => return None,
    })
}
