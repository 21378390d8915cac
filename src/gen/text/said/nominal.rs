//! Commands said as nouns, as forms and minutes word them: "removal of the left car", "replacement of the van by a bus is
//! requested", "bus removal, please". They are put as the imperatives that they stand for.

use super::super::tokens::{Token, TokenKind};
use super::super::wording::begins;
use super::words::{first_noun, is, led, number, text};

/// What is done, as a noun, with its verb.
const DONE: &[(&str, &str)] = &[
    (
        "remove",
        "removal|deletion|elimination|erasure|clearance|withdrawal|dismissal|subtraction|extraction|eradication|disposal|omission",
    ),
    (
        "add",
        "addition|insertion|inclusion|introduction|creation|installation|provision|deployment",
    ),
    (
        "move",
        "move|relocation|displacement|shift|transfer|movement|repositioning|transposition|translation|shifting|moving|relocating",
    ),
    ("put", "placement|positioning|placing"),
    ("replace", "replacement|replacing"),
    ("substitute", "substitution"),
    ("turn", "conversion|transformation|transmutation"),
    ("swap", "swap|swapping|permutation"),
    ("exchange", "exchange"),
    ("turn", "rotation|turning"),
    ("park", "parking"),
    ("double", "doubling"),
    ("halve", "halving"),
    ("increase", "increase in|increase|raising"),
    ("reduce", "reduction in|reduction|decrease in|decrease|lowering"),
    ("paint", "painting|repainting"),
];
/// What stands before it: who asks for it, or that it is to be done.
const LEADS: &str = "\
    carry out|perform|do|make|initiate|execute|arrange|arrange for|i request|we request|requesting|requested|required|\
    i need|we need|i ask for|we ask for|i am asking for|please note|next step|next|task|action|todo|to do|edit|change|\
    request|requirement|step|proceed with|go ahead with|i would like|id like|i want|i propose|i suggest|wanted|wish|\
    my wish|apply|there should be|there must be|it needs|the scene needs|order|ordered|instruction|measure|we want|\
    i would suggest|id suggest|my suggestion|suggestion|proposal|i recommend|we recommend|schedule|effect|i demand";
/// What follows it: that it is wished for.
const TAILS: &str = "\
    is required|is requested|is needed|is necessary|is desired|is wanted|is called for|is recommended|is asked for|\
    is what i want|is what i need|is what we need|is what we want|would be good|would be nice|would be great|\
    would be better|would be fine|would be helpful|would be appreciated|would be welcome|would be useful|would be best|\
    would be perfect|would be ideal|would help|is to be carried out|must be carried out|should be carried out|is due|\
    has been requested|has been decided|was requested|was decided|is advisable|is overdue|is in order|seems necessary|\
    is to be done|should be done|must be done|is planned|required|requested|needed|necessary|desired|wanted|please";

/// The tokens with every sentence of this kind as an imperative.
pub fn plain(tokens: Vec<Token>) -> Vec<Token> {
    let mut out = Vec::with_capacity(tokens.len());
    for sentence in tokens.split_inclusive(|t| t.kind == TokenKind::Stop) {
        let (body, stop) = match sentence.split_last() {
            Some((last, body)) if last.kind == TokenKind::Stop => (body, std::slice::from_ref(last)),
            _ => (sentence, &[][..]),
        };
        match ordered(body) {
            Some(order) => out.extend(order),
            None => out.extend_from_slice(body),
        }
        out.extend_from_slice(stop);
    }
    out
}

/// What one sentence orders with a noun.
fn ordered(body: &[Token]) -> Option<Vec<Token>> {
    let body = &body[..without_tail(body)];
    let from = lead(body);
    let rest = &body[from..];
    if let Some((verb, n)) = done_at(rest)
        && is(rest.get(n), &["of", "in"])
    {
        let what = &rest[n + 1..];
        // (a shift of snow, a change of mind: nothing that is there)
        let named = first_noun(what).filter(|x| x.0 < 6)?;
        let counted =
            is(what.first(), &["number", "count", "amount"]) || is(what.get(1), &["number", "count"]);
        // ("increase of traffic" is no number)
        if matches!(verb, "increase" | "reduce") && !counted {
            return None;
        }
        let at = &rest[0];
        if counted {
            let the = usize::from(is(what.first(), &["the"]));
            return Some(led(verb, at, &[&led("the", at, &[&what[the..]])]));
        }
        // "placement of a cone on the left" is new, "placement of the cone" is not
        let fresh = is(what.first(), &["a", "an", "another", "one", "some", "more"])
            || what.first().is_some_and(|t| number(t).is_some());
        let verb = match verb {
            "put" | "park" if fresh => "add",
            "turn"
                if named.1 < what.len() && !what[named.1..].iter().any(|t| is(Some(t), &["into", "to"])) =>
            {
                "turn"
            }
            other => other,
        };
        let mut out = led(verb, at, &[what]);
        // ("conversion of the car to a bus")
        if verb == "turn"
            && let Some(k) = (named.1..out.len())
                .find(|k| is(out.get(*k), &["to"]) && is(out.get(k + 1), &["a", "an", "two", "three"]))
        {
            out[k].text = "into".into();
        }
        return Some(out);
    }
    // "lane change of the truck to the right"
    if let Some(n) = begins(
        rest,
        "lane change of|lane change by|change of lane of|change of lanes of|a lane change of|a lane change by",
    ) && let Some((_, b)) = first_noun(&rest[n..]).filter(|x| x.0 < 4)
        && begins(
            &rest[n + b..],
            "to the right|to the left|to its right|to its left",
        ) == Some(rest.len() - n - b)
    {
        return Some(led(
            "move",
            &rest[0],
            &[&rest[n..n + b], &led("one lane", &rest[0], &[&rest[n + b..]])],
        ));
    }
    // "bus removal"
    let (last, np) = rest.split_last()?;
    let (verb, _) = done_at(std::slice::from_ref(last))?;
    let whole = first_noun(np).is_some_and(|x| x.1 == np.len() && x.0 < 3);
    let the = !is(
        np.first(),
        &["the", "all", "both", "a", "an", "one", "every", "that"],
    );
    let the = if the { led("the", last, &[]) } else { Vec::new() };
    (verb == "remove" && whole).then(|| led(verb, last, &[&the, np]))
}

/// The verb of a noun that stands here, and how many tokens the noun takes.
fn done_at(tokens: &[Token]) -> Option<(&'static str, usize)> {
    let the = usize::from(is(tokens.first(), &["the", "a", "an", "some", "another"]));
    let quick = usize::from(is(
        tokens.get(the),
        &[
            "immediate",
            "complete",
            "simple",
            "quick",
            "slight",
            "small",
            "partial",
            "full",
        ],
    ));
    let at = the + quick;
    DONE.iter().find_map(|(verb, list)| {
        let n = begins(tokens.get(at..)?, list)?;
        // ("increase in" takes the preposition that "of" stands for)
        let n = n - usize::from(text(&tokens[at + n - 1]) == "in" && n > 1);
        Some((*verb, at + n))
    })
}

/// Where the noun begins after what leads up to it; 0 if nothing does.
fn lead(body: &[Token]) -> usize {
    let please = usize::from(is(body.first(), &["please", "kindly", "and", "then", "now"]));
    let rest = &body[please..];
    let the = usize::from(is(rest.first(), &["the", "my", "our", "a"]));
    let said = begins(rest, LEADS).or_else(|| Some(the + begins(&rest[the..], LEADS)?));
    let Some(n) = said else {
        return please;
    };
    let mut k = please + n;
    while body
        .get(k)
        .is_some_and(|t| t.kind == TokenKind::Comma || matches!(text(t), ":" | "-" | "is"))
    {
        k += 1;
    }
    match body.get(k..).and_then(done_at) {
        Some(_) => k,
        None => please,
    }
}

/// Where what only says that it is wished begins.
fn without_tail(body: &[Token]) -> usize {
    (2..body.len())
        .find(|i| begins(&body[*i..], TAILS).is_some_and(|n| i + n == body.len()))
        .map_or(body.len(), |i| {
            i - usize::from(body[i - 1].kind == TokenKind::Comma)
        })
}

#[cfg(test)]
mod tests {
    use super::super::super::tokens::tokens;
    use super::*;

    #[test]
    fn nouns_of_doing() {
        let said = |t: &str| {
            let list: Vec<String> = plain(tokens(t)).into_iter().map(|t| t.text).collect();
            list.join(" ")
        };
        for (noun, verb) in [
            ("Removal of the left car", "remove the left car"),
            ("The removal of the bus is required", "remove the bus"),
            (
                "Please carry out the replacement of the van by a bus",
                "replace the van by a bus",
            ),
            ("Conversion of the car to a bus", "turn the car into a bus"),
            ("Bus removal, please", "remove the bus"),
            (
                "An increase in the number of cones to five",
                "increase the number of cones to five",
            ),
        ] {
            assert_eq!(said(noun), verb);
        }
        for plain in ["move the bus", "parking of any kind", "the shift is over"] {
            assert_eq!(said(plain), plain);
        }
    }
}
