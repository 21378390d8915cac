//! Sentences of edits cast into plain commands, one turn of speech after another.

use super::super::lexicon::{Sense, look_up};
use super::super::tokens::{Token, TokenKind};
use super::super::wording::replaced;
use super::Talk;
use super::causing::{caused, caused_later, let_be, wished_beside};
use super::limits::{for_each, group_cut, half_of, no_more_than, not_those, now_there, sent, so_many_not};
use super::steps::{another_so_far, far_times, pushed_away, to_so_far};
use super::strips::{
    changed_to, cleared_of, everyone_there, off_site, off_with, other_strip, own_side, place_first,
    stopped_at,
};
use super::topics::{gapped, of_group, topic};
use super::words::{find, first_noun, has_noun, is, is_place, led, number, text, trimmed};

/// A sentence (without its stop) in plain words.
pub fn plain(tokens: Vec<Token>, talk: &Talk<'_>) -> Vec<Token> {
    let out = replaced(
        &tokens,
        "get rid of|getting rid of|do away with|dispose of",
        "remove",
    );
    let out = replaced(
        &out,
        "i no longer need|we no longer need|i no longer require|we no longer require|i have no more use for|we have no more use for|i have no further use for|we have no further use for|i have no use for|we have no use for|we have no more need of|we have no need of|i have no need of|i have no more need of",
        "we dont need",
    );
    let out = super::colours::whatever(out);
    let out = everyone_there(out);
    let out = replaced(&out, "together with|along with|and also|as well as", "and");
    let out = replaced(&out, "not just|not only|not merely", "not");
    let out = replaced(
        &out,
        "further along the road , away from us|further along the road , away from me|further along the road|further down the road|further up the road|farther along the road|farther down the road|further on down the road|further along the street|further down the street|further along|farther along",
        "further away",
    );
    let out = replaced(
        &out,
        "have all reached|have both reached|have already reached|has already reached|have since reached|has since reached|have safely reached|has safely reached|have now reached|has now reached|has reached|have reached|has arrived on|have arrived on|has made it to|have made it to|has got to|have got to|has arrived at|have arrived at|have arrived in|has arrived in",
        "should go to",
    );
    let out = replaced(
        &out,
        "all that is parked|everything that is parked|everything parked|all that are parked|whatever is parked|anything parked|all things parked|everything which is parked",
        "all parked vehicles",
    );
    let out = replaced(&out, "a single one", "one");
    let out = replaced(&out, "a single", "one");
    let out = far_times(out);
    let out = wished_beside(out);
    let out = replaced(&out, "drop all|ditch all", "remove all");
    let out = replaced(&out, "drop both|ditch both", "remove both");
    let out = replaced(&out, "drop every|ditch every", "remove every");
    let out = replaced(
        &out,
        "everything stays except that|everything stays the same except that|everything stays as it is except that|everything remains except that|nothing changes except that|all stays as it is except that|all stays the same except that|the only change is that|the only difference is that|the one change is that|what changes is that",
        "",
    );
    let out = gets(left_over(without_care(out)));
    let out = now_there(out, talk);
    let out = pushed_away(half_of(group_cut(out)));
    let out = another_so_far(out);
    let out = to_so_far(out);
    let out = caused(out);
    let out = caused_later(out);
    let out = in_parts(out, &["let", "may", "could"], let_be);
    let out = so_many_not(out, talk);
    let out = takes_over(out);
    let out = place_first(out);
    let out = topic(out, talk);
    let out = of_group(gapped(out));
    let out = other_strip(out, talk);
    let out = instead(out, talk);
    let out = for_each(out, talk);
    let out = sent(out, talk);
    let out = no_more_than(out, talk);
    let out = off_with(off_site(stopped_at(changed_to(out))));
    let out = cleared_of(out);
    let out = own_side(out);
    super::which::any_so_many(not_those(out, talk), talk)
}

/// The same for what begins after "and" or a comma with one of these words.
fn in_parts(tokens: Vec<Token>, begin: &[&str], recast: fn(Vec<Token>) -> Vec<Token>) -> Vec<Token> {
    let mut out = recast(tokens);
    for k in 1..out.len() {
        let begins = is(out.get(k), begin)
            && (out[k - 1].kind == TokenKind::Comma || is(out.get(k - 1), &["and", "then", "but"]));
        if begins {
            let tail = out.split_off(k);
            out.extend(recast(tail));
            return out;
        }
    }
    out
}

/// "without touching the bus, add a taxi": what is not to change.
fn without_care(tokens: Vec<Token>) -> Vec<Token> {
    let Some((i, n)) = find(
        &tokens,
        &[
            "without touching",
            "without moving",
            "without changing",
            "without altering",
            "without disturbing",
            "without removing",
            "but without touching",
            "and without touching",
            "while leaving",
            "not touching",
        ],
    ) else {
        return tokens;
    };
    if !has_noun(&tokens[i + n..]) {
        return tokens;
    }
    let end = (i + n..tokens.len())
        .find(|k| tokens[*k].kind != TokenKind::Word || is(tokens.get(*k), &["and", "but"]))
        .map_or(tokens.len(), |k| k + 1);
    let out = [&tokens[..i], &tokens[end..]].concat();
    if has_noun(&out) {
        trimmed(&out).to_vec()
    } else {
        tokens
    }
}

/// "the van gets a trailer": a trailer behind it.
fn gets(tokens: Vec<Token>) -> Vec<Token> {
    let Some((i, n)) = find(
        &tokens,
        &[
            "gets a",
            "receives a",
            "is given a",
            "should have a",
            "should get a",
            "tows a",
            "now tows a",
            "should tow a",
            "pulls a",
            "should pull a",
            "has a",
            "now has a",
        ],
    ) else {
        return tokens;
    };
    let known =
        is(tokens.first(), &["the", "my", "that"]) && first_noun(&tokens[..i]).is_some_and(|x| x.0 < 5);
    let trailer = super::words::longest(&tokens[i + n..])
        .is_some_and(|l| matches!(l.0, Sense::Noun(k, _) if k.classes[0] == crate::scene::Class::Trailer));
    if !(known && trailer) {
        return tokens;
    }
    let end = (i + n..tokens.len())
        .find(|k| tokens[*k].kind == TokenKind::Comma || text(&tokens[*k]) == "and")
        .unwrap_or(tokens.len());
    let behind = led("behind", &tokens[i], &[&tokens[..i]]);
    led(
        "add a",
        &tokens[0],
        &[&tokens[i + n..end], &behind, &tokens[end..]],
    )
}

/// "only one pedestrian left on the crossing": left over, not on the left.
fn left_over(tokens: Vec<Token>) -> Vec<Token> {
    let few = tokens.iter().any(|t| {
        matches!(
            text(t),
            "only" | "just" | "should" | "must" | "exactly" | "no" | "one"
        )
    });
    let mut out: Vec<Token> = Vec::new();
    for (i, t) in tokens.iter().enumerate() {
        let noun = i > 0 && matches!(look_up(text(&tokens[i - 1])), Some(Sense::Noun(..)));
        let next = tokens.get(i + 1).is_none_or(|n| {
            n.kind != TokenKind::Word
                || matches!(
                    text(n),
                    "on" | "in" | "at" | "there" | "here" | "standing" | "please"
                )
        });
        let be = tokens[..i]
            .iter()
            .any(|t| matches!(text(t), "be" | "have" | "want" | "need" | "is" | "are" | "only"));
        if !(text(t) == "left" && noun && next && few && be) {
            out.push(t.clone());
        }
    }
    out
}

/// "a parked lorry replaces the bus": replace the bus with it.
fn takes_over(tokens: Vec<Token>) -> Vec<Token> {
    let fresh = is(tokens.first(), &["a", "an", "another", "one"])
        || tokens.first().is_some_and(|t| number(t).is_some());
    let found = find(
        &tokens,
        &[
            "replaces",
            "replace",
            "takes over from",
            "stands in for",
            "substitutes for",
            "supersedes",
            "will replace",
            "should replace",
            "is to replace",
            "takes the place of",
            "take the place of",
            "is there instead of",
            "comes instead of",
            "stands there instead of",
            "comes in the place of",
            "is put in place of",
            "ousts",
        ],
    );
    let Some((i, n)) = found.filter(|(i, _)| fresh && first_noun(&tokens[..*i]).is_some_and(|x| x.1 <= *i))
    else {
        return tokens;
    };
    let old = &tokens[i + n..];
    let known = is(
        old.first(),
        &["the", "my", "that", "this", "both", "all", "one", "every"],
    );
    if !known || !has_noun(old) {
        return tokens;
    }
    let end = old
        .iter()
        .position(|t| t.kind == TokenKind::Comma)
        .unwrap_or(old.len());
    let with = led("with", &tokens[0], &[&tokens[..i]]);
    led("replace", &tokens[0], &[&old[..end], &with, &old[end..]])
}

/// "bus behind ego instead, 15 m": what is there is moved.
fn instead(tokens: Vec<Token>, talk: &Talk<'_>) -> Vec<Token> {
    let Some(i) = tokens
        .iter()
        .position(|t| text(t) == "instead")
        .filter(|i| *i > 1)
    else {
        return tokens;
    };
    let (Some((a, b)), false) = (first_noun(&tokens), is(tokens.get(i + 1), &["of"])) else {
        return tokens;
    };
    let bare = tokens[..a]
        .iter()
        .all(|t| matches!(look_up(text(t)), Some(Sense::State(..) | Sense::Color(_))));
    let leaves = is(tokens.get(b), &["away", "out", "off", "gone"]);
    if !bare
        || leaves
        || b > i
        || !is_place(&tokens[b..])
        || talk.fits(&tokens[..b]) != 1
        || has_noun(&tokens[b..i])
    {
        return tokens;
    }
    let mut rest = [&tokens[b..i], &tokens[i + 1..]].concat();
    rest.retain(|t| t.kind != TokenKind::Comma);
    led("move the", &tokens[0], &[&tokens[..b], &rest])
}
