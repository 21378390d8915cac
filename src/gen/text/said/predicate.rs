//! What a clause says of its subject: helpers and denials taken off, its parts after "and" told apart.

use super::super::lexicon::{Sense, look_up};
use super::super::tokens::{Token, TokenKind};
use super::lists::{
    ADVERBS, AFTERWARDS, GONE, HELPERS, IN_PLACE, NEGATED, OFF_SITE, PRONOUNS, REASONS, THERE,
};
use super::words::{find, has_noun, is, is_finite, is_place, leads, longest, number, text};

/// One verb phrase without its helpers.
#[derive(Clone, Debug, Default)]
pub struct Part {
    /// The verb and what follows it.
    pub main: Vec<Token>,
    /// "not", "no longer".
    pub not: bool,
    /// "has gone": over already.
    pub perfect: bool,
    /// "is": a noun after it says what it becomes.
    pub is: bool,
    /// Any helper stood there.
    pub helped: bool,
}

impl Part {
    pub fn begins(&self, list: &[&str]) -> Option<usize> {
        leads(&self.main, list)
    }

    /// True if it says that the subject is no more in the scene.
    pub fn is_gone(&self) -> bool {
        if self.not {
            let there = self.main.is_empty() || self.begins(&THERE).is_some();
            return there;
        }
        if gone_off(&self.main)
            || is(
                self.main.first(),
                &[
                    "vanished",
                    "vanishes",
                    "vanish",
                    "disappeared",
                    "disappears",
                    "disappear",
                ],
            )
        {
            return true;
        }
        let Some(n) = self.begins(&GONE) else {
            return false;
        };
        let rest = &self.main[n..];
        // "pulls away until it is 32 m ahead of us"
        if is(rest.first(), &["until", "till"]) {
            return false;
        }
        // "goes at a distance of 25 m", "gone 5 m to the left"
        if leads(rest, &["at a distance", "by a distance"]).is_some()
            || is(rest.first(), &["at", "by"]) && rest.get(1).is_some_and(|t| number(t).is_some())
        {
            return false;
        }
        // "has dropped off its passenger"
        let object = |t: Option<&Token>| {
            is(
                t,
                &[
                    "the", "a", "an", "its", "his", "her", "their", "all", "both", "my", "our",
                ],
            )
        };
        if is(rest.first(), &["off", "out", "away", "up", "down"]) && object(rest.get(1)) {
            return false;
        }
        // "was driven off on a trailer"
        if n > 1
            && is(self.main.get(n - 1), &["off", "away", "home"])
            && is(
                rest.first(),
                &[
                    "on",
                    "in",
                    "together",
                    "along",
                    "under",
                    "into",
                    "without",
                    "before",
                    "this",
                    "last",
                    "yesterday",
                    "today",
                    "tonight",
                ],
            )
            && !super::words::is_goal(rest)
            && !super::super::lexicon::look_up(rest.get(2).map_or("", text))
                .is_some_and(|s| matches!(s, Sense::Place(..)))
        {
            return true;
        }
        // "has left the sidewalk", "go to the left", "goes over to", "left of me"
        let ours = leads(
            rest,
            &[
                "from me",
                "from us",
                "from the ego",
                "from my car",
                "from our car",
            ],
        )
        .is_some();
        // ("has gone at a distance of 20 m": there it is)
        let ours = ours || leads(rest, &["at a distance of", "at distance"]).is_some();
        let ends = !ours
            && (rest.is_empty()
                || matches!(rest[0].kind, TokenKind::Comma | TokenKind::Stop | TokenKind::Mark)
                || leads(rest, &AFTERWARDS).is_some());
        let bare = matches!(text(&self.main[0]), "out" | "off" | "away" | "left")
            && self.main.len() > 1
            && n == 1
            && text(&self.main[0]) != "left";
        let side = text(&self.main[0]) == "left" && n == 1 && !self.perfect;
        ends && !(bare && !rest.is_empty() && rest[0].kind != TokenKind::Comma) && !side
    }
}

/// "has got on the bus": who is in a vehicle is not seen.
fn boarded(main: &[Token]) -> bool {
    let n = leads(
        main,
        &[
            "got on",
            "got onto",
            "got in",
            "got into",
            "gotten on",
            "gotten into",
            "gotten in",
            "got aboard",
            "climbed into",
            "climbed aboard",
            "climbed onto",
            "climbed on",
            "sat down in",
            "sitting in",
            "seated in",
            "hopped on",
            "hopped into",
            "hopped onto",
            "stepped into",
            "stepped onto",
            "stepped aboard",
            "jumped into",
            "boarded",
            "entered",
            "been picked up by",
            "picked up by",
            "been taken in by",
            "gets on",
            "gets into",
            "climbs into",
            "boards",
            "get on",
            "get into",
            "climb into",
            "board",
            "inside",
            "taken their seats in",
            "taken a seat in",
            "taken seats in",
        ],
    );
    // ("has boarded it")
    if n.is_some_and(|n| is(main.get(n), &["it", "them"]) && main.len() == n + 1)
        && !is(main.first(), &["inside"])
    {
        return true;
    }
    let Some(np) = n
        .map(|n| &main[n..])
        .filter(|np| is(np.first(), &["the", "a", "an", "our", "my", "that", "one"]))
    else {
        return false;
    };
    super::words::first_noun(np).is_some_and(|(a, b)| {
        a < 4
            && matches!(longest(&np[a..b]).map(|l| l.0), Some(Sense::Noun(n, _)) if n.classes[0].is_vehicle())
    })
}

/// "has gone back to the station", "is back in the depot": where it is no part of the scene.
fn gone_off(main: &[Token]) -> bool {
    if boarded(main) {
        return true;
    }
    let went = is(
        main.first(),
        &[
            "gone", "driven", "walked", "returned", "headed", "ridden", "cycled", "moved", "went", "goes",
            "drives", "returns", "heads", "go", "return", "head", "drive", "taken", "sent", "brought",
            "called", "towed", "back", "at", "in", "inside",
        ],
    );
    let at = (1..main.len().min(4)).find(|i| is(main.get(*i), &OFF_SITE));
    let between = |i: usize| {
        main[1..i].iter().all(|t| {
            is(
                Some(t),
                &[
                    "back", "to", "at", "in", "into", "inside", "the", "a", "his", "her", "their", "its",
                    "off", "home", "for", "our", "away", "now",
                ],
            )
        })
    };
    // ("in", "at" and "back" say it only with such a place)
    let found = at.or_else(|| (4..main.len().min(6)).find(|i| is(main.get(*i), &OFF_SITE)));
    went && found.is_some_and(|i| {
        between(i)
            && main.get(i + 1).is_none_or(|t| {
                t.kind != TokenKind::Word
                    || is(
                        Some(t),
                        &[
                            "and", "already", "now", "again", "for", "by", "long", "with", "because",
                            "where", "today", "tonight", "this", "until", "till", "before", "once", "so",
                            "after", "early",
                        ],
                    )
            })
    })
}

/// Takes the helpers off one verb phrase.
fn part(tokens: &[Token]) -> Part {
    let mut p = Part::default();
    let mut k = 0;
    while let Some(t) = tokens.get(k) {
        let w = text(t);
        if w == "no" && is(tokens.get(k + 1), &["longer", "more"]) {
            p.not = true;
            k += 2;
            continue;
        }
        if w == "to"
            && !tokens
                .get(k + 1)
                .is_some_and(|t| HELPERS.contains(&text(t)) || is_finite(text(t), true))
        {
            break; // "must to the left"
        }
        // "would look better on the left"
        if matches!(w, "look" | "looks" | "fit" | "fits" | "be")
            && is(
                tokens.get(k + 1),
                &["better", "nicer", "good", "best", "fine", "well", "great"],
            )
        {
            k += 2;
            continue;
        }
        if NEGATED.contains(&w) {
            p.not = true;
        } else if HELPERS.contains(&w) {
            // "has the bus behind it" has another object
            p.perfect |= matches!(w, "has" | "have" | "had");
            p.is = matches!(w, "is" | "are" | "be" | "was" | "were" | "been");
            p.helped = true;
        } else {
            let next = |words: &[&str]| is(tokens.get(k + 1), words);
            let adverb = match w {
                "about" => next(&["to"]),
                "longer" | "hereby" | "like" => true,
                // These begin something else.
                "rather" => !next(&["than"]),
                "instead" => !next(&["of"]),
                "so" => !next(&["that"]),
                _ => true,
            };
            let known = ADVERBS.contains(&w) || matches!(w, "longer" | "hereby" | "like");
            if !(known && adverb) {
                break;
            }
        }
        k += 1;
    }
    p.perfect &= !p.is || tokens.iter().take(k).any(|t| text(t) == "been");
    p.main = without_reasons(&tokens[k..]).to_vec();
    while p.main.last().is_some_and(|t| {
        matches!(t.kind, TokenKind::Comma | TokenKind::Mark | TokenKind::Stop)
            || matches!(
                text(t),
                "instead" | "please" | "now" | "and" | "then" | "thanks" | "though" | "so" | "but"
            )
    }) {
        p.main.pop();
    }
    p
}

/// What stands before "because", "so that we see her face", "not ahead", "rather than behind".
fn without_reasons(tokens: &[Token]) -> &[Token] {
    let mut end = tokens.len();
    for i in 1..tokens.len() {
        let rest = &tokens[i..];
        let reason = leads(rest, &REASONS).is_some();
        let against = (matches!(text(&tokens[i]), "not")
            || leads(
                rest,
                &[
                    "rather than",
                    "instead of",
                    "and not",
                    "and no longer",
                    "but no longer",
                    "but not",
                    "no longer",
                ],
            )
            .is_some())
            && !is(tokens.get(i - 1), &["is", "are", "does", "do", "should", "must"]);
        if reason || against {
            end = i;
            break;
        }
    }
    &tokens[..end]
}

/// True if a verb phrase of the same subject begins here: "and is now riding", "and stops".
fn goes_on(tokens: &[Token], plural: bool, before: &[Token]) -> bool {
    let mut k = 0;
    while tokens
        .get(k)
        .is_some_and(|t| ADVERBS.contains(&text(t)) && text(t) != "to" || text(t) == "then")
    {
        k += 1;
    }
    let Some(t) = tokens.get(k) else {
        return false;
    };
    let w = text(t);
    // "has finished its round and left"
    let leaves = w == "left"
        && before.iter().any(|t| matches!(text(t), "has" | "have" | "had"))
        && (tokens.len() == k + 1
            || leads(&tokens[k + 1..], &AFTERWARDS).is_some()
            || tokens[k + 1].kind != TokenKind::Word);
    if leaves {
        return true;
    }
    if HELPERS.contains(&w) || NEGATED.contains(&w) || is_finite(w, plural) {
        return !has_place_only(tokens, k);
    }
    // "should stop and wait", "has gone over and standing": the same form again
    let modal = before.first().is_some_and(|t| {
        matches!(
            text(t),
            "should"
                | "must"
                | "shall"
                | "can"
                | "could"
                | "to"
                | "may"
                | "will"
                | "would"
                | "has"
                | "have"
                | "had"
                | "ought"
                | "needs"
        )
    });
    modal && is_finite(w, true)
        || matches!(longest(&tokens[k..]), Some((Sense::State(..), _))) && w.ends_with("ing")
}

/// "left" and the like are verbs as well as places.
fn has_place_only(tokens: &[Token], k: usize) -> bool {
    matches!(text(&tokens[k]), "left" | "right" | "back")
}

/// The verb phrases of a predicate.
pub fn parts(tokens: &[Token], plural: bool) -> Vec<Part> {
    let mut out = Vec::new();
    let mut from = 0;
    let mut i = 1;
    while i < tokens.len() {
        let link =
            tokens[i].kind == TokenKind::Comma || matches!(text(&tokens[i]), "and" | "but" | "so" | "then");
        if link {
            let mut next = i + 1;
            while tokens.get(next).is_some_and(|t| {
                t.kind == TokenKind::Comma || matches!(text(t), "and" | "but" | "so" | "then")
            }) {
                next += 1;
            }
            // "so it is now", "and it waits there"
            let said_again = is(tokens.get(next), &PRONOUNS) && text(&tokens[i]) != "that";
            let begin = if said_again && !is(tokens.get(next), &["hes", "shes", "theyre"]) {
                next + 1
            } else {
                next
            };
            let rest = &tokens[begin.min(tokens.len())..];
            if goes_on(
                rest,
                plural || said_again && is(tokens.get(next), &["they"]),
                &tokens[from..i],
            ) {
                out.push(part(&tokens[from..i]));
                from = begin;
                i = begin;
                continue;
            }
            // "should not block my lane but the oncoming one"
            if text(&tokens[i]) == "but"
                && out.is_empty()
                && is(rest.first(), &["the", "a", "an", "my", "our"])
            {
                let first = part(&tokens[from..i]);
                if first.not && !first.main.is_empty() {
                    let places = [
                        "lane", "sidewalk", "pavement", "side", "kerb", "curb", "roadside", "footpath",
                        "verge", "shoulder",
                    ];
                    let place = first
                        .main
                        .iter()
                        .rev()
                        .find(|t| places.contains(&text(t)))
                        .cloned();
                    let lead = first
                        .main
                        .iter()
                        .position(|t| is(Some(t), &["the", "a", "an", "my", "our"]))
                        .unwrap_or(1);
                    let mut p = part(rest);
                    let mut main = first.main[..lead].to_vec();
                    main.extend(rest.iter().map(|t| match &place {
                        Some(place) if text(t) == "one" => super::words::word(text(place), t),
                        _ => t.clone(),
                    }));
                    p.main = main;
                    p.helped = true;
                    p.is = first.is;
                    p.not = false;
                    out.push(first);
                    out.push(p);
                    return out;
                }
            }
            // "is not behind us but in front": what is meant comes after "but"
            if text(&tokens[i]) == "but" && is_place(rest) && out.is_empty() {
                let first = part(&tokens[from..i]);
                if first.not {
                    let mut p = part(rest);
                    p.helped = true;
                    p.is = first.is;
                    p.main = rest.to_vec();
                    out.push(first);
                    out.push(p);
                    return out;
                }
            }
        }
        i += 1;
    }
    let mut last = part(&tokens[from..]);
    // its helper was said before: "has finished and left"
    last.perfect |= out.last().is_some_and(|p| p.perfect) && !last.helped && last.begins(&["left"]).is_some();
    out.push(last);
    out
}

/// A number alone: "four are enough", "should be six", "only two".
pub fn alone(main: &[Token]) -> Option<Token> {
    let small = |t: &Token| {
        matches!(
            text(t),
            "only"
                | "just"
                | "exactly"
                | "are"
                | "is"
                | "will"
                | "would"
                | "be"
                | "enough"
                | "suffice"
                | "suffices"
                | "plenty"
                | "do"
                | "sufficient"
                | "in"
                | "total"
                | "altogether"
                | "all"
                | "all told"
                | "of"
                | "them"
                | "at"
                | "most"
                | "now"
                | "please"
                | "number"
                | "should"
                | "must"
                | "may"
                | "shall"
                | "can"
                | "so"
                | "stays"
                | "remains"
                | "remain"
                | "stay"
                | "left"
                | "there"
                | "to"
                | "down"
                | "up"
                | "no"
                | "more"
        ) || t.kind == TokenKind::Comma
    };
    let mut numbers = main.iter().filter(|t| number(t).is_some());
    let n = numbers.next()?.clone();
    let rest = main.iter().filter(|t| number(t).is_none()).all(small);
    (rest && numbers.next().is_none()).then_some(n)
}

/// "a van", "a bus instead": what the subject becomes.
pub fn new_kind(main: &[Token]) -> Option<&[Token]> {
    let article = matches!(text(main.first()?), "a" | "an");
    let noun = super::words::first_noun(main).filter(|n| n.0 <= 4)?;
    let plain = main.get(1..noun.0).unwrap_or_default().iter().all(|t| {
        !matches!(
            look_up(text(t)),
            Some(Sense::Unit(_) | Sense::Rel(_) | Sense::EgoRel(_))
        ) && !matches!(text(t), "bit" | "little" | "metre" | "meter" | "lane")
    });
    // "two of the cones are to be barriers"
    let many = noun.0 == 0
        && noun.1 == main.len()
        && matches!(look_up(text(&main[noun.1 - 1])), Some(Sense::Noun(_, true)));
    (article && plain || many).then_some(main)
}

/// True if the words name a thing that is put in the place of another: one past "in its place".
pub fn in_place(tokens: &[Token]) -> Option<(usize, usize)> {
    find(tokens, &IN_PLACE)
}

/// True if there is anything that places the subject.
pub fn places(main: &[Token]) -> bool {
    (0..main.len()).any(|i| is_place(&main[i..])) || has_noun(main)
}
