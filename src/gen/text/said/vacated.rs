//! Places that are pointed back to after something was taken away or moved: "get rid of the car and put the truck in its
//! place", "... and move the bus to where it was", "... and let a scooter ride there".

use super::super::edit_command::target_part;
use super::super::edit_grammar::Command;
use super::super::rephrase::is_verb;
use super::super::tag::tag;
use super::super::tokens::{Span, Token, TokenKind};
use super::super::wording::{begins, rewritten};
use super::super::words::edits::Verb;
use super::forms::takes_place;
use super::lists::{ADVERBS, HELPERS, IN_PLACE, MOTION, MOVES};
use super::some_of::removes;
use super::words::{first_noun, has_noun, is, is_finite, leads, led, number, text, trimmed};
use super::{Piece, Talk};

/// What went before leaves room.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Room {
    /// Nothing went.
    #[default]
    None,
    /// Something is elsewhere now: "there" would be where it is, "in its place" is where it was.
    Moved,
    /// Something is gone: "there" is where it was, too.
    Gone,
}

const INSTEAD_OF_IT: &str = "instead of it|instead of him|instead of her|instead of them|instead of that|instead of those|in lieu of it|in lieu of them|in place of it|in place of him|in place of her|in place of them|in exchange for it|in exchange for them|as a replacement for it|as a replacement for them|to replace it|to make up for it";

/// "put a truck instead of it", "add a truck instead", once what was there is gone: in its place.
pub fn plain(tokens: Vec<Token>, talk: &Talk<'_>) -> Vec<Token> {
    let tokens = closed_with(tokens);
    let out = rewritten(&tokens, |i, out| {
        let n = begins(&tokens[i..], INSTEAD_OF_IT)?;
        let goes = |k: usize| {
            let opens =
                k == 0 || out[k - 1].kind != TokenKind::Word || is(out.get(k - 1), &["and", "please"]);
            opens && removes(out.get(k))
                || is(out.get(k), &["gone", "left", "away", "out", "disappears", "goes"])
        };
        let gone = talk.room == Room::Gone || (0..out.len()).any(goes);
        gone.then(|| {
            out.extend(led("in its place", &tokens[i], &[]));
            // ("instead of it, please put a truck")
            let opens = i == 0 || tokens[i - 1].kind != TokenKind::Word;
            let small = |t: &&Token| t.kind == TokenKind::Comma || is(Some(t), &["please", "there", "now"]);
            i + n
                + if opens {
                    tokens[i + n..].iter().take_while(small).count()
                } else {
                    0
                }
        })
    });
    let alone = talk.room == Room::Gone
        && is(out.last(), &["instead"])
        && is(
            out.first(),
            &[
                "add", "put", "insert", "place", "use", "take", "show", "have", "drop",
            ],
        )
        && (is(out.get(1), &["a", "an"]) || out.get(1).is_some_and(|t| number(t).is_some()))
        && first_noun(&out).is_some_and(|n| n.1 + 1 == out.len());
    if !alone {
        return out;
    }
    let at = &out[0];
    led(
        "put",
        at,
        &[&out[1..out.len() - 1], &led("in its place", at, &[])],
    )
}

/// What a clause that was read leaves.
pub fn room_after(pieces: &[Piece]) -> Option<Room> {
    let moves = |t: Option<&Token>| is(t, &MOVES) && !is(t, &["have", "let", "make", "get", "take", "leave"]);
    pieces.last().and_then(|p| match p {
        Piece::Meant(c, _) => room_of(c.verb),
        Piece::Plain(tokens) => match super::super::edit_command::verb_of(tokens) {
            _ if moves(tokens.first()) => Some(Room::Moved),
            verb => verb.and_then(room_of),
        },
    })
}

/// What a command leaves; `None` if it only says something of what was there before.
pub fn room_of(verb: Verb) -> Option<Room> {
    match verb {
        Verb::Remove | Verb::Clear => Some(Room::Gone),
        Verb::Move => Some(Room::Moved),
        Verb::Note => None,
        _ => Some(Room::None),
    }
}

/// The place where something was, at the end of a clause: where it begins.
fn pointed(body: &[Token], room: Room) -> Option<usize> {
    const NAMES: &[&str] = &[
        "place", "position", "spot", "location", "gap", "space", "slot", "room",
    ];
    let end = body.len();
    (1..end).find(|i| {
        let rest = &body[*i..];
        if leads(rest, &IN_PLACE) == Some(rest.len()) {
            return true;
        }
        if is(rest.first(), &["there"]) {
            return room == Room::Gone && rest.len() == 1;
        }
        // "to the vacated spot", "into the gap it left", "in the place of the car"
        let to = leads(
            rest,
            &[
                "to", "into", "in", "on", "onto", "at", "over to", "up to", "fill", "fills",
            ],
        );
        let of = to
            .and_then(|n| {
                let own = is(
                    rest.get(n),
                    &["its", "his", "her", "their", "that", "this", "the", "same"],
                );
                own.then_some(n + 1)
            })
            .map(|n| {
                let free = leads(
                    &rest[n..],
                    &[
                        "old",
                        "former",
                        "previous",
                        "vacated",
                        "free",
                        "freed",
                        "empty",
                        "now empty",
                        "same",
                        "now free",
                        "very same",
                        "resulting",
                        "vacant",
                        "original",
                        "exact",
                    ],
                );
                n + free.unwrap_or(0)
            })
            .filter(|n| is(rest.get(*n), NAMES))
            .map(|n| &rest[n + 1..]);
        if let Some(of) = of {
            return of.is_empty()
                || of.len() < 6
                    && !has_noun(of)
                    && is(
                        of.first(),
                        &["it", "he", "she", "they", "that", "which", "where", "left"],
                    );
        }
        // "where the car was"
        is(rest.first(), &["where"])
            && is(rest.get(1), &["the", "that", "those", "it", "he", "she", "they"])
            && rest
                .iter()
                .skip(2)
                .any(|t| matches!(text(t), "was" | "were" | "stood" | "had" | "used" | "drove"))
            && first_noun(&rest[1..]).is_none_or(|x| x.0 < 3)
    })
}

/// What comes to where another was, after a clause that left room.
pub fn filled(inner: &[Token], talk: &Talk<'_>) -> Option<Vec<Piece>> {
    if talk.room == Room::None {
        return None;
    }
    let mut body = trimmed(inner);
    while body.len() > 3
        && is(
            body.last(),
            &["instead", "now", "please", "then", "too", "afterwards"],
        )
    {
        body = trimmed(&body[..body.len() - 1]);
    }
    let i = pointed(body, talk.room)?;
    let head = trimmed(&body[..i]);
    let (a, b) = first_noun(head)?;
    let det = (0..a).find(|k| {
        is(
            head.get(*k),
            &["the", "my", "that", "this", "both", "those", "these", "all"],
        )
    });
    let verbal = |t: &Token| {
        let w = text(t);
        MOVES.contains(&w)
            || MOTION.contains(&w)
            || HELPERS.contains(&w)
            || ADVERBS.contains(&w)
            || is_verb(t)
            || is_finite(w, true)
            || matches!(
                w,
                "over" | "up" | "forward" | "right" | "exactly" | "straight" | "down" | "take" | "takes"
            )
    };
    let from = det.unwrap_or(0);
    if head.iter().any(|t| t.kind == TokenKind::Comma) || !head[..from].iter().all(verbal) {
        return None;
    }
    // ("the blue one is still parked there", "everything else is there" tell of what stays)
    let points = is(body.get(i), &["there"]);
    let stays = head
        .iter()
        .any(|t| matches!(text(t), "still" | "already" | "always") || super::untouched::stands_still(t));
    let comes = head[..from]
        .iter()
        .any(|t| is_verb(t) || MOVES.contains(&text(t)))
        || head[b..]
            .iter()
            .any(|t| MOTION.contains(&text(t)) || is_finite(text(t), true));
    let fresh = head[..a]
        .iter()
        .any(|t| number(t).is_some() || is(Some(t), &["a", "an", "another", "some"]))
        || is(head.get(a), &["somebody", "someone"]);
    // (of two that come there only one would find room)
    if stays || has_noun(&head[b..]) || points && !(fresh || det.is_some() && comes) {
        return None;
    }
    let Some(from) = det else {
        return takes_place(body, i, body.len() - i, talk);
    };
    // ("the van standing on the right": what tells which)
    let end = (b..=head.len()).find(|e| head[*e..].iter().all(verbal))?;
    let np = &head[from..end];
    if talk.fits(np) == 0 {
        return None;
    }
    let span = inner.iter().fold(inner[0].span, |s: Span, t| s.to(t.span));
    let mut c = Command::new(Verb::Add, talk.text, span);
    target_part(talk.text, &tag(np), &mut c);
    c.in_place = true;
    c.by = c.targets.first().cloned();
    Some(vec![Piece::Meant(Box::new(c), Some(head[a..b].to_vec()))])
}

/// "take the barrier down and close our lane with six cones": put them there, or where it stood.
fn closed_with(tokens: Vec<Token>) -> Vec<Token> {
    const CLOSES: &str = "close off|close|block off|block|seal off|seal|shut off|shut|cordon off|barricade|fence off|cone off|secure|obstruct|bar";
    const PLACES: &str = "our lane|our own lane|my lane|the ego lane|the left lane|the right lane|the oncoming lane|the lane|the road|our side of the road|\
        the left sidewalk|the right sidewalk|the crossing|the lane ahead of us|our lane ahead of us|it|that lane|this lane|the place|the spot|the gap";
    const THERE: &str = "at the same place|in the same place|at the same spot|in the same spot|at that place|at that spot|there|in its place|instead|\
        at the same position|in the same position|exactly there|where it was|where it stood";
    rewritten(&tokens, |i, out| {
        let linked =
            i > 2 && (is(tokens.get(i - 1), &["and", "then"]) || tokens[i - 1].kind == TokenKind::Comma);
        let removed =
            (0..out.len()).any(|k| removes(out.get(k)) || is(out.get(k), &["dismantle", "gone", "away"]));
        let verb = begins(&tokens[i..], CLOSES).filter(|_| linked && removed && has_noun(out))?;
        let place = begins(tokens.get(i + verb..)?, PLACES)?;
        let with = i + verb + place;
        is(tokens.get(with), &["with", "using", "by"]).then_some(())?;
        let what = &tokens[with + 1..];
        let (_, b) = first_noun(what).filter(|x| x.0 < 4)?;
        (what.first()?.kind != TokenKind::Word
            || number(&what[0]).is_some()
            || is(what.first(), &["a", "an", "some"]))
        .then_some(())?;
        out.extend(led("put", &tokens[i], &[&what[..b]]));
        let end = with + 1 + b;
        let there = begins(&tokens[end..], THERE);
        let it = is(tokens.get(i + verb), &["it"]) || text(&tokens[with - 1]) != "lane" && there.is_some();
        if there.is_some() || it {
            out.extend(led("in the same place", &tokens[i], &[]));
        } else {
            out.extend(led("in", &tokens[i], &[&tokens[i + verb..with]]));
        }
        Some(end + there.unwrap_or(0))
    })
}
