//! Who is spared: "all the motor vehicles but the bus may disappear".

use super::super::lexicon::{Sense, look_up};
use super::super::tokens::{Token, TokenKind};
use super::Piece;
use super::lists::HELPERS;
use super::words::{find, first_noun, has_noun, is, is_finite, is_place, leads, led, number, text};

/// "every vehicle apart from the one that follows us": the vehicle that does.
pub(super) fn the_one_spared(tokens: Vec<Token>) -> Vec<Token> {
    let found = (2..tokens.len()).find_map(|i| {
        let n = leads(
            &tokens[i..],
            &[
                "but",
                "except for",
                "except",
                "apart from",
                "save for",
                "other than",
                "save",
                "besides",
                "aside from",
                "bar",
            ],
        )?;
        let m = leads(&tokens[i + n..], &["the one", "the ones", "those"])?;
        let next = &tokens[i + n + m..];
        (is(next.first(), &["that", "which", "who"]) || is_place(next)).then_some((i, i + n, m))
    });
    let Some((i, from, m)) = found else {
        return tokens;
    };
    let all = tokens[..i]
        .iter()
        .rposition(|t| matches!(text(t), "all" | "every" | "each" | "any" | "both"));
    let Some((a, b)) = all.and_then(|all| first_noun(&tokens[all..i]).map(|x| (all + x.0, all + x.1))) else {
        return tokens;
    };
    let many = is(tokens.get(from + m - 1), &["ones", "those"]);
    let noun = if many {
        tokens[a..b].to_vec()
    } else {
        super::topics::singular_of(&tokens[a..b])
    };
    let the = led("the", &tokens[from], &[&noun]);
    [&tokens[..from], &the, &tokens[from + m..]].concat()
}

/// "everything stays, but the digger goes": what comes after "but" is a clause of its own. ("everything goes, but the bus
/// stays" spares it.)
fn own_clause(before: &[Token], after: &[Token]) -> bool {
    let said = |t: &Token| HELPERS.contains(&text(t)) || is_finite(text(t), true);
    let told = first_noun(before).is_some_and(|x| before[x.1..].iter().any(said));
    let Some((_, b)) = first_noun(after).filter(|x| x.0 < 4 && told) else {
        return false;
    };
    let verb = &after[b..];
    let ends = verb
        .iter()
        .position(|t| t.kind != TokenKind::Word)
        .unwrap_or(verb.len());
    let stays = verb[..ends].iter().any(|t| {
        is(
            Some(t),
            &[
                "stay", "stays", "remain", "remains", "kept", "left", "survive", "survives", "staying",
                "keep",
            ],
        )
    });
    verb.first().is_some_and(said) && !stays
}

/// The sentence without an exception, and the noun phrase that was excepted.
pub fn except(tokens: &[Token]) -> Option<(Vec<Token>, Vec<Token>)> {
    let all = tokens
        .iter()
        .position(|t| matches!(text(t), "all" | "every" | "each" | "any" | "both"))?;
    let (i, n) = find(
        &tokens[all..],
        &[
            "but not",
            "but",
            "except for",
            "except",
            "apart from",
            "save for",
            "save",
            "bar",
            "other than",
            "excluding",
            "with the exception of",
            "besides",
            "aside from",
        ],
    )
    .map(|(i, n)| (all + i, n))?;
    if is(tokens.get(i), &["but"]) && own_clause(&tokens[..i], &tokens[i + n..]) {
        return None;
    }
    // "everything but the bus" and the like are numbers of their own
    let group = first_noun(&tokens[all..i]).filter(|x| x.0 < 5)?;
    // ("all moving objects" are some)
    let plain = group.0 < 2
        && is(
            tokens.get(all + group.0),
            &["everything", "everyone", "everybody", "objects", "things"],
        )
        && !is_place(&tokens[all + group.1..i])
        && !tokens[all..all + group.0]
            .iter()
            .any(|t| matches!(look_up(text(t)), Some(Sense::State(..))));
    let from = i + n;
    let definite = is(tokens.get(from), &["the", "my", "that", "those", "these"]);
    if plain || !definite || leads(&tokens[from..], &["the one", "the ones", "the following"]).is_some() {
        return None;
    }
    let (_, noun) = first_noun(&tokens[from..]).filter(|x| x.0 < 4)?;
    let end = (from + noun..tokens.len())
        .find(|k| {
            let t = &tokens[*k];
            // (the verb of "that follows us" is no end)
            let relative = (1..3).any(|n| is(tokens.get(k.wrapping_sub(n)), &["that", "which", "who"]));
            // ("the vehicles parked on the right")
            let does = *k == from + noun
                && matches!(
                    text(t),
                    "parked"
                        | "standing"
                        | "waiting"
                        | "driving"
                        | "walking"
                        | "riding"
                        | "coming"
                        | "stopped"
                );
            t.kind != TokenKind::Word
                || !relative && !does && (HELPERS.contains(&text(t)) || is_finite(text(t), true))
                || matches!(text(t), "with" | "by" | "into" | "to" | "onto")
                // "and the coach" is spared, too
                || text(t) == "and" && !(is(tokens.get(k + 1), &["the", "my", "that", "those"])
                    && first_noun(&tokens[k + 1..]).is_some_and(|x| {
                        x.0 < 4
                            && tokens.get(k + 1 + x.1).is_none_or(|t| {
                                t.kind != super::super::tokens::TokenKind::Word || HELPERS.contains(&text(t))
                            })
                    }))
        })
        .unwrap_or(tokens.len());
    let rest = [&tokens[..i], &tokens[end..]].concat();
    has_noun(&rest).then(|| (rest, tokens[from..end].to_vec()))
}

/// "clear the lot, except for the van", "clear the scene but leave the bus": all else there goes.
pub(super) fn cleared_but(tokens: Vec<Token>) -> Vec<Token> {
    const AREAS: &[&str] = &[
        "lot",
        "car park",
        "parking lot",
        "carpark",
        "scene",
        "site",
        "map",
        "picture",
        "image",
        "view",
        "place",
        "area",
        "whole area",
        "whole scene",
        "whole lot",
        "whole place",
        "whole site",
        "whole car park",
        "stage",
        "whole picture",
        "building site",
        "construction site",
        "canvas",
    ];
    const ROADS: &[&str] = &[
        "street",
        "road",
        "highway",
        "motorway",
        "whole street",
        "whole road",
        "whole highway",
        "freeway",
        "whole motorway",
        "carriageway",
    ];
    let Some(n) = leads(
        &tokens,
        &[
            "clear out",
            "empty out",
            "clear",
            "empty",
            "vacate",
            "sweep",
            "wipe",
            "tidy up",
        ],
    ) else {
        return tokens;
    };
    let at = n + usize::from(is(tokens.get(n), &["the", "this", "that", "my", "our"]));
    let area = leads(&tokens[at.min(tokens.len())..], AREAS);
    let road = leads(&tokens[at.min(tokens.len())..], ROADS);
    // "clear my lane but keep the truck"
    let strip = (at..tokens.len().min(at + 4)).find(|k| {
        is(
            tokens.get(*k),
            &[
                "lane",
                "lanes",
                "sidewalk",
                "pavement",
                "footpath",
                "crossing",
                "zebra",
                "kerb",
                "roadside",
                "shoulder",
                "junction",
                "intersection",
                "roundabout",
            ],
        )
    });
    let strip = strip
        .map(|k| k + 1 - at)
        .filter(|m| !has_noun(&tokens[at..at + m]));
    let Some(m) = area.or(road).or(strip).filter(|_| at > n) else {
        return tokens;
    };
    let mut k = at + m;
    while tokens.get(k).is_some_and(|t| {
        t.kind != super::super::tokens::TokenKind::Word || matches!(text(t), "out" | "completely" | "please")
    }) {
        k += 1;
    }
    let but = leads(
        &tokens[k..],
        &[
            "except for",
            "except",
            "apart from",
            "but for",
            "but leave",
            "but keep",
            "and leave only",
            "and keep only",
            "but not",
            "leave only",
            "keep only",
            "leaving only",
            "keeping only",
            "save for",
            "bar",
            "but",
            "aside from",
            "other than",
            "leaving",
            "keeping",
            "with the exception of",
            "but leave only",
            "but keep only",
            "only leave",
            "only keep",
            "just leave",
            "just keep",
            "and leave just",
            "excluding",
            "and leave",
            "and keep",
            "only",
            "just",
        ],
    );
    let np = but.and_then(|b| tokens.get(k + b..)).unwrap_or(&[]);
    // ("only the bus may remain")
    let stays = np
        .iter()
        .rposition(|t| is(Some(t), &["stay", "stays", "remain", "remains", "left", "kept"]));
    let helped = stays.filter(|s| s + 1 == np.len()).map(|s| {
        let helpers = np[..s]
            .iter()
            .rev()
            .take_while(|t| HELPERS.contains(&text(t)) || is(Some(t), &["may", "can", "to"]));
        s - helpers.count()
    });
    let np = &np[..helped.unwrap_or(np.len())];
    let known = is(
        np.first(),
        &["the", "my", "that", "those", "these", "both", "our", "all"],
    ) && first_noun(np).is_some_and(|x| x.0 < 5)
        && !np
            .iter()
            .any(|t| HELPERS.contains(&text(t)) || is_finite(text(t), false));
    if !known {
        return tokens;
    }
    let np: Vec<Token> = np
        .iter()
        .filter(|t| {
            !is(Some(t), &["alone", "there", "untouched", "in", "place"]) || is_place(std::slice::from_ref(t))
        })
        .cloned()
        .collect();
    let place = match (area, road) {
        (Some(_), _) => return led("keep only", &tokens[0], &[&np]),
        (None, Some(_)) => led("on the road", &tokens[0], &[]),
        _ => {
            let lane = tokens[at..at + m].iter().any(|t| is(Some(t), &["lane", "lanes"]));
            led(if lane { "in" } else { "on" }, &tokens[0], &[&tokens[n..at + m]])
        }
    };
    let all = led("remove all objects", &tokens[0], &[&place]);
    [&all, &led("except", &tokens[0], &[&np])[..]].concat()
}

/// "everything except the bus and the kids should disappear": only those stay.
pub(super) fn everything_but(tokens: Vec<Token>) -> Vec<Token> {
    let Some((i, n)) = find(
        &tokens,
        &[
            "but for",
            "but",
            "except for",
            "except",
            "apart from",
            "other than",
            "save for",
            "save",
            "besides",
            "aside from",
            "bar",
            "with the exception of",
            "excluding",
        ],
    )
    .filter(|x| x.0 > 0) else {
        return tokens;
    };
    let from = i + n;
    let before = &tokens[..i];
    if is(tokens.get(i), &["but"]) && own_clause(before, &tokens[from..]) {
        return tokens;
    }
    let Some(whole) = before
        .iter()
        .position(|t| matches!(text(t), "everything" | "everyone" | "everybody"))
        .or_else(|| {
            find(
                before,
                &["all objects", "all the objects", "all things", "all else"],
            )
            .map(|x| x.0)
        })
    else {
        return tokens;
    };
    let many = is(
        tokens.get(from),
        &["the", "my", "that", "those", "these", "both", "our"],
    ) || tokens.get(from).is_some_and(|t| number(t).is_some());
    if is(tokens.get(from), &["that"])
        && is(
            tokens.get(from + 1),
            &["the", "a", "an", "it", "my", "all", "both"],
        )
    {
        return tokens;
    }
    let others = first_noun(&before[..whole]).is_some()
        || before[whole + 1..].iter().any(|t| {
            matches!(look_up(text(t)), Some(Sense::Noun(..))) && !is(Some(t), &["objects", "things"])
        });
    let goes = |t: &Token| {
        is(
            Some(t),
            &[
                "go",
                "goes",
                "gone",
                "disappear",
                "disappears",
                "vanish",
                "vanishes",
                "leave",
                "leaves",
                "removed",
                "deleted",
                "erased",
                "away",
                "out",
                "off",
                "cleared",
            ],
        )
    };
    let close = (from..tokens.len())
        .find(|k| {
            let t = &tokens[*k];
            HELPERS.contains(&text(t))
                || goes(t)
                || is(Some(t), &["stays", "stay", "remains", "remain"])
                || (is(Some(t), &["and"]) || t.kind != TokenKind::Word)
                    && tokens.get(k + 1).is_some_and(super::super::rephrase::is_verb)
        })
        .unwrap_or(tokens.len());
    let np = super::words::trimmed(&tokens[from..close]);
    let gone = (close..tokens.len().min(close + 5))
        .rev()
        .find(|k| goes(&tokens[*k]));
    let removing = before[..whole].iter().any(super::super::rephrase::is_verb)
        && (before.iter().any(goes)
            || super::some_of::removes(before.first())
            || before[..whole]
                .iter()
                .any(|t| is(Some(t), &["rid", "erase", "wipe", "ditch"])));
    // everybody but the child speaks of people alone
    let people = is(tokens.get(whole), &["everyone", "everybody"]) && only_people(np);
    // "everything on the road goes except the bulldozer": what is elsewhere stays
    let told = &before[whole + 1..];
    let told = &told[usize::from(is(told.first(), &["else", "objects"]))..];
    let stop = told
        .iter()
        .position(|t| HELPERS.contains(&text(t)) || goes(t) || t.kind != TokenKind::Word)
        .unwrap_or(told.len());
    let there = is_place(&told[..stop]) && is(told.first(), &["on", "in", "at", "behind", "ahead"]);
    if many
        && there
        && !others
        && first_noun(np).is_some()
        && (gone.is_some() || removing || told[stop..].iter().any(goes))
    {
        let objects = led("remove all the objects", &tokens[0], &[&told[..stop]]);
        let end = gone.map_or(close, |g| g + 1);
        return [&objects, &led("except", &tokens[0], &[np]), &tokens[end..]].concat();
    }
    // "everything goes, but the bus stays"
    let helped = tokens[close..]
        .iter()
        .take_while(|t| HELPERS.contains(&text(t)))
        .count()
        + close;
    let stays = leads(&tokens[helped..], &["stays", "stay", "remains", "remain", "kept"])
        .filter(|_| before[whole + 1..].iter().any(goes))
        .map(|n| helped + n);
    if !many
        || others
        || people
        || first_noun(np).is_none()
        || !(gone.is_some() || removing || stays.is_some())
    {
        return tokens;
    }
    let end = stays.unwrap_or(gone.map_or(close, |g| g + 1));
    led("keep only", &tokens[0], &[np, &tokens[end..]])
}

/// "everything stays except the woman": she goes.
pub(super) fn all_stays_but(tokens: Vec<Token>) -> Vec<Token> {
    let whole = is(tokens.first(), &["everything", "everyone", "everybody", "all"]);
    let Some((i, n)) = find(
        &tokens,
        &[
            "except for",
            "except",
            "apart from",
            "save for",
            "but for",
            "but not",
            "but",
            "save",
            "with the exception of",
            "other than",
            "aside from",
        ],
    )
    .filter(|x| whole && x.0 > 1 && x.0 < 8) else {
        return tokens;
    };
    let stays = tokens[1..i].iter().any(|t| {
        matches!(
            text(t),
            "stay" | "stays" | "remain" | "remains" | "kept" | "left" | "same"
        )
    });
    let plain = tokens[1..i].iter().all(|t| {
        HELPERS.contains(&text(t))
            || is(
                Some(t),
                &[
                    "stay",
                    "stays",
                    "remain",
                    "remains",
                    "kept",
                    "left",
                    "the",
                    "same",
                    "as",
                    "it",
                    "else",
                    "there",
                    "of",
                    "them",
                    "untouched",
                    "just",
                ],
            )
    });
    let np = &tokens[i + n..];
    let known = is(
        np.first(),
        &["the", "my", "that", "both", "those", "these", "all"],
    );
    let verb = np
        .iter()
        .any(|t| HELPERS.contains(&text(t)) || is_finite(text(t), false));
    let Some((_, b)) = first_noun(np).filter(|x| known && x.0 < 4) else {
        return tokens;
    };
    if !stays
        || !plain
        || verb
        || np[b..]
            .iter()
            .any(|t| t.kind != super::super::tokens::TokenKind::Word)
    {
        return tokens;
    }
    led("remove", &tokens[0], &[np])
}

/// True if all that is named walks.
fn only_people(np: &[Token]) -> bool {
    let mut rest = np;
    while let Some((a, b)) = first_noun(rest) {
        let walks = matches!(
            super::words::longest(&rest[a..b]).map(|l| l.0),
            Some(Sense::Noun(n, _)) if n.classes[0] == crate::scene::Class::Pedestrian
        );
        if !walks {
            return false;
        }
        rest = &rest[b..];
    }
    true
}

/// What nobody wants of a kind goes, where it was said.
pub(super) fn unwanted(inner: &[Token], first: &Token) -> Option<Vec<Piece>> {
    let any = is(
        inner.first(),
        &["any", "a", "an", "more", "some", "anybody", "anyone"],
    );
    let (a, b) = first_noun(inner).filter(|n| n.0 < 4)?;
    let many = matches!(look_up(text(&inner[b - 1])), Some(Sense::Noun(_, true)));
    let mut rest = &inner[b..];
    for late in ["any more", "anymore", "any longer", "at all", "no more", "now"] {
        let n = late.split(' ').count();
        if let Some(cut) = rest
            .len()
            .checked_sub(n)
            .filter(|k| find(&rest[*k..], &[late]).is_some())
        {
            rest = &rest[..cut];
        }
    }
    let told = rest.first().is_some_and(|t| {
        is_place(rest) || text(t).ends_with("ing") || text(t) == "parked" || text(t) == "to"
    });
    let verb = usize::from(is(rest.first(), &["to"]) && is(rest.get(1), &["be", "stand", "drive", "wait"]));
    (!rest.is_empty() && told && (any || a == 0 && many)).then(|| {
        let body = is(inner.get(a), &["anybody", "anyone"]);
        let np = if body {
            led("people", first, &[])
        } else {
            inner[a..b].to_vec()
        };
        vec![Piece::Plain(led(
            "remove all the",
            first,
            &[&np, &rest[2 * verb..]],
        ))]
    })
}
