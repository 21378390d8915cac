//! What there should be or should not, and what is sent out of the scene: "there ought to be four cones", "get the bus out of
//! here", "nobody should be on the crossing".

use super::exchange::{begins_with, trimmed};
use super::lexicon::{Sense, look_up, plural};
use super::said::lists::{HELPERS, NEGATED};
use super::said::words::{first_noun, has_noun, led as command, number, text};
use super::tokens::{Token, TokenKind};

/// What there should be, or should not: "there ought to be four cones", "the street shouldn't have any taxis".
pub fn there(clause: &[Token]) -> Option<Vec<Token>> {
    let first = clause.first()?;
    let mut k = 0;
    let mut not = false;
    let mut should = false;
    let mut owns = false;
    // Words before a noun: "the scene should not show any more ..."
    while let Some(t) = clause.get(k) {
        match text(t) {
            w if NEGATED.contains(&w) => not = true,
            "should" | "must" | "shall" | "ought" | "needs" | "need" | "has" | "supposed" | "want" => {
                should = true
            }
            "contain" | "have" | "show" | "include" | "hold" | "feature" | "contains" | "shows" | "holds" => {
                owns = true
            }
            "there" | "to" | "be" | "is" | "are" | "i" | "we" | "you" | "the" | "this" | "it" | "scene"
            | "picture" | "image" | "street" | "road" | "view" | "id" | "like" | "would" | "rather"
            | "see" | "now" | "please" | "any" | "longer" | "more" | "a" | "total" | "of" | "in" | "all"
            | "altogether" | "lets" | "let" => {}
            _ => break,
        }
        k += 1;
    }
    let rest = &clause[k..];
    let existential = clause[..k].iter().any(|t| text(t) == "there");
    if !has_noun(rest) {
        return None;
    }
    let no = rest.first().is_some_and(|t| matches!(text(t), "no" | "zero"));
    if (not && (existential || owns) && !no) || (existential && no) {
        let rest = if no { &rest[1..] } else { rest };
        let rest = if rest
            .first()
            .is_some_and(|t| matches!(text(t), "more" | "longer" | "any"))
        {
            &rest[1..]
        } else {
            rest
        };
        // "there is not a single car": none
        let rest = trimmed(rest);
        if rest
            .first()
            .is_some_and(|t| matches!(text(t), "single" | "solitary" | "sole" | "one"))
            && let Some((_, b)) = first_noun(rest)
        {
            let mut np = rest[1..b].to_vec();
            if let Some(last) = np.last_mut()
                && matches!(look_up(&last.text), Some(Sense::Noun(_, false)))
            {
                last.text = plural(&last.text);
            }
            return Some(command("remove all the", first, &[&np, &rest[b..]]));
        }
        return Some(command("remove", first, &[rest]));
    }
    // ("there must be at least twelve")
    let least = begins_with(rest, &["at", "least"]) || begins_with(rest, &["at", "minimum"]);
    let rest = if least && existential && should {
        &rest[2..]
    } else {
        rest
    };
    // The article belongs to what is wished for.
    let total = clause[..k].iter().any(|t| text(t) == "total");
    if (existential && should || total) && number(&rest[0]).is_some() {
        let more = rest
            .get(1)
            .is_some_and(|t| matches!(text(t), "more" | "additional" | "extra" | "further"));
        return Some(command(if more { "add" } else { "keep exactly" }, first, &[rest]));
    }
    None
}

/// "get the bus out of here"
pub fn sent_off(clause: &[Token]) -> Option<Vec<Token>> {
    let first = clause.first()?;
    if !matches!(
        text(first),
        "get"
            | "take"
            | "clear"
            | "chase"
            | "throw"
            | "kick"
            | "drive"
            | "haul"
            | "send"
            | "tow"
            | "move"
            | "bring"
            | "cart"
            | "pull"
    ) {
        return None;
    }
    let noun = first_noun(clause)?.1 - 1;
    let tails: &[&[&str]] = &[
        &["out", "of", "here"],
        &["out", "of", "the", "scene"],
        &["out", "of", "the", "picture"],
        &["out", "of", "my", "way"],
        &["out", "of", "the", "way"],
        &["out", "of", "our", "way"],
        &["off", "the", "road"],
        &["off", "the", "street"],
        &["off", "the", "map"],
        &["out", "of", "my", "sight"],
        &["out", "of", "sight"],
        &["out", "of", "view"],
        &["away", "from", "here"],
        &["from", "the", "scene"],
        &["out", "of", "the", "view"],
        &["off", "the", "scene"],
        &["out", "of", "the", "image"],
        &["off"],
        &["away"],
        &["out"],
        &["home"],
        &["off", "the", "carriageway"],
        &["off", "the", "tarmac"],
    ];
    let end = trimmed(clause).len();
    let k = (noun + 1..end).find(|k| {
        tails
            .iter()
            .any(|t| begins_with(&clause[*k..], t) && k + t.len() == end)
    })?;
    Some(command("remove", first, &[&clause[1..k]]))
}

/// "nobody should be on the crossing"
pub fn nobody(clause: &[Token]) -> Option<Vec<Token>> {
    // "there is nobody on the right sidewalk": nobody there
    let there = begins_with(clause, &["there", "is"]) || begins_with(clause, &["there", "are"]);
    let clause = match clause.get(2..) {
        Some(rest)
            if there
                && rest
                    .iter()
                    .any(|t| matches!(text(t), "on" | "in" | "at" | "behind")) =>
        {
            rest
        }
        _ => clause,
    };
    let first = clause.first()?;
    let n = match text(first) {
        "nobody" | "noone" => 1,
        _ => begins_with(clause, &["no", "one"]).then_some(2)?,
    };
    if clause.iter().any(|t| text(t) == "yet") {
        return Some(Vec::new()); // a remark
    }
    // "nobody takes the bus": what nobody does to something else is a remark
    let does = clause[n..]
        .iter()
        .take_while(|t| HELPERS.contains(&text(t)))
        .count()
        + n;
    let object = clause.get(does).is_some_and(|t| {
        matches!(
            text(t),
            "takes"
                | "take"
                | "took"
                | "uses"
                | "use"
                | "used"
                | "needs"
                | "need"
                | "wants"
                | "want"
                | "drives"
                | "drive"
                | "rides"
                | "ride"
                | "likes"
                | "like"
                | "owns"
                | "boards"
                | "catches"
                | "misses"
                | "missed"
                | "buys"
                | "sees"
                | "watches"
                | "saw"
                | "noticed"
                | "notices"
                | "knows"
                | "moved"
                | "touched"
                | "touches"
        )
    }) && clause
        .get(does + 1)
        .is_some_and(|t| matches!(text(t), "the" | "a" | "an" | "this" | "that" | "my" | "our"))
        && first_noun(&clause[does + 1..]).is_some_and(|x| x.0 < 4);
    if object {
        return Some(Vec::new());
    }
    let clause_end = clause
        .iter()
        .position(|t| matches!(text(t), "any" | "anymore" | "here") || t.kind == TokenKind::Comma)
        .unwrap_or(clause.len());
    // "nobody cycles here any more": who cycles goes
    // ("nobody is riding behind us any more", too)
    let who = match clause.get(does).map(text) {
        Some("cycles" | "cycle" | "bikes" | "pedals" | "cycling" | "biking" | "pedalling") => {
            "remove all cyclists"
        }
        Some("drives" | "drive" | "driving") => "remove all vehicles",
        Some("rides" | "ride" | "riding") => "remove all bicycles and motorcycles",
        Some("parks" | "park") => "remove all parked vehicles",
        _ => "remove all people",
    };
    if who != "remove all people" {
        return Some(command(
            who,
            first,
            &[clause.get(does + 1..clause_end).unwrap_or(&[])],
        ));
    }
    let rest: Vec<Token> = clause[n..clause_end.max(n)]
        .iter()
        .filter(|t| !HELPERS.contains(&text(t)))
        .cloned()
        .collect();
    Some(command("remove all people", first, &[&rest]))
}
