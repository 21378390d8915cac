//! What is told around a change, and changes told as what has come of them: "the number of cars goes up to four", "of the
//! cars keep just the silver one", "has turned round and is riding towards us", "so that it hides the view".

use super::super::lexicon::{Sense, look_up, plural};
use super::super::tokens::{Token, TokenKind};
use super::super::wording::{begins, replaced, rewritten};
use super::Talk;
use super::beside_whom;
use super::company::mark;
use super::words::{find, first_noun, has_noun, is, is_place, leads, led, number, text, trimmed, unit_at};

/// A sentence in plainer words.
pub fn plain(tokens: Vec<Token>, talk: &Talk<'_>) -> Vec<Token> {
    let out = farther_than(hides_view(tokens));
    let out = stopped_for(driver(out, talk));
    let out = at_all(turned_and_comes(number_of(out)));
    let out = extra(beside_whom::plain(out, talk));
    none_left(&out)
        .or_else(|| of_these_only(&out, talk))
        .unwrap_or(out)
}

/// What is told beside it, before remarks are cut off.
pub fn facts(tokens: Vec<Token>) -> Vec<Token> {
    own_lane_still(because_sky(tokens))
}

/// "the oncoming driver has stopped": his vehicle.
fn driver(tokens: Vec<Token>, talk: &Talk<'_>) -> Vec<Token> {
    rewritten(&tokens, |i, out| {
        let n = begins(
            &tokens[i..],
            "the oncoming driver|the oncoming motorist|the approaching driver|the driver coming towards us|the driver who comes towards us|the driver in the oncoming lane|the opposing driver",
        )?;
        let it = led("the oncoming vehicle", &tokens[i], &[]);
        let boxes = talk.boxes_of(&it);
        let [b] = boxes.as_slice() else {
            return None;
        };
        out.extend(led(&format!("the oncoming {}", b.class.label()), &tokens[i], &[]));
        Some(i + n)
    })
}

/// "has stopped at the zebra and is waiting for the woman": waits at the zebra.
fn stopped_for(tokens: Vec<Token>) -> Vec<Token> {
    rewritten(&tokens, |i, out| {
        let n = begins(
            &tokens[i..],
            "has stopped|stopped|stops|has halted|has pulled up|has come to a halt|has come to a stop",
        )?;
        let at = i + n;
        (i > 0 && is(tokens.get(at), &["at", "before", "in"])).then_some(())?;
        let and = (at + 2..tokens.len().min(at + 7)).find(|k| is(tokens.get(*k), &["and"]))?;
        let crossing = tokens[at..and]
            .iter()
            .any(|t| is(Some(t), &["zebra", "crossing", "crosswalk", "crossings"]));
        let waits = begins(
            &tokens[and..],
            "and is waiting for|and waits for|and is now waiting for|and lets|and is letting|and gives way to|and is giving way to|and yields to",
        )?;
        let whom = &tokens[and + waits..];
        let (_, b) =
            first_noun(whom).filter(|x| x.0 < 4 && is(whom.first(), &["the", "both", "that", "those"]))?;
        let end = b + leads(
            &whom[b..],
            &["to cross", "cross", "pass", "to pass", "go over", "go across"],
        )
        .unwrap_or(0);
        (crossing && whom.get(end).is_none_or(mark)).then(|| {
            out.extend(led("waits", &tokens[i], &[]));
            out.extend_from_slice(&tokens[at..and]);
            and + waits + end
        })
    })
}

/// "no car at all": no car.
fn without_at_all(tokens: &[Token]) -> Vec<Token> {
    rewritten(tokens, |i, out| {
        let n = begins(&tokens[i..], "at all|whatsoever|of any kind")?;
        let none = out
            .iter()
            .any(|t| is(Some(t), &["no", "none", "nobody", "nothing"]));
        (none && tokens.get(i + n).is_none_or(mark)).then_some(i + n)
    })
}

/// "no oncoming traffic at all": none.
fn at_all(tokens: Vec<Token>) -> Vec<Token> {
    let tokens = replaced(
        &without_at_all(&tokens),
        "no oncoming traffic|no traffic coming towards us|no traffic in the oncoming lane|no traffic coming our way",
        "no oncoming vehicles",
    );
    // ("what if there were no oncoming vehicles")
    if let Some((i, n)) = find(
        &tokens,
        &[
            "there were no oncoming vehicles",
            "there was no oncoming vehicles",
            "there is no oncoming vehicles",
            "theres no oncoming vehicles",
            "there are no oncoming vehicles",
        ],
    ) && !has_noun(&tokens[..i])
    {
        return led("remove all oncoming vehicles", &tokens[i], &[&tokens[i + n..]]);
    }
    tokens
}

/// "the bus has pulled out; it is now driving in our lane" is one sentence; "only one of the officers stays, and he stands
/// ahead of us" is two.
pub fn joined(mut tokens: Vec<Token>) -> Vec<Token> {
    const SET_OFF: &str = "has pulled out|has pulled off|has set off|has driven off|has moved off|has started|has pulled away|has started moving|has started off|pulled out|set off|has left its stop|has left the stop|has left its place|has left the kerb|has left the curb|pulls out|sets off|moves off|drives off";
    let mut i = 0;
    while i < tokens.len() {
        // ("...; same lane, same distance")
        let again = begins(
            tokens.get(i + 1..).unwrap_or(&[]),
            "same lane|same distance|the same lane|in the same lane",
        )
        .is_some();
        let lasts = tokens[i + 1..].iter().take(5).any(|t| text(t) == "distance");
        if i > 0 && again && lasts && tokens[i].kind == TokenKind::Stop {
            tokens[i].kind = TokenKind::Comma;
        }
        let one = leads(
            &tokens[i..],
            &["only one of the", "just one of the", "one of the"],
        );
        let stays = one.and_then(|n| {
            let (a, b) = first_noun(&tokens[i + n..]).filter(|x| x.0 < 3)?;
            let end = i + n + b;
            let verb = leads(
                &tokens[end..],
                &[
                    "stays",
                    "remains",
                    "is left",
                    "may stay",
                    "should stay",
                    "is to stay",
                    "shall stay",
                    "stays here",
                    "stays there",
                ],
            )?;
            let comma = end + verb;
            let and = comma + usize::from(tokens.get(comma)?.kind == TokenKind::Comma);
            let he = and + usize::from(is(tokens.get(and), &["and"]));
            let said = super::words::is_finite(text(tokens.get(he + 1)?), true)
                || is(
                    tokens.get(he + 1),
                    &["is", "should", "must", "has", "shall", "now"],
                );
            (he > comma && a < 3 && said && is(tokens.get(he), &["he", "she", "it"])).then_some((comma, he))
        });
        if let Some((from, to)) = stays {
            let stop = Token {
                kind: TokenKind::Stop,
                ..super::words::word(".", &tokens[from])
            };
            tokens.splice(from..to, [stop]);
        }
        // ("the bus": its name, then that it is off, then where it is now)
        let off = begins(&tokens[i..], SET_OFF).filter(|_| i > 0).and_then(|n| {
            let end = i + n;
            let parted = tokens
                .get(end)
                .is_some_and(|t| matches!(t.kind, TokenKind::Stop | TokenKind::Comma | TokenKind::Mark));
            let next = end + usize::from(parted);
            let and = next + usize::from(is(tokens.get(next), &["and"]));
            let it = and + usize::from(is(tokens.get(and), &["it", "he", "she"]));
            let verb = it + usize::from(is(tokens.get(it), &["now"]));
            let now = is(
                tokens.get(verb),
                &["is", "drives", "rides", "goes", "should", "must", "comes"],
            );
            let named =
                first_noun(&tokens[i.saturating_sub(4)..i]).is_some_and(|x| x.1 == i - i.saturating_sub(4));
            (now && named && it > next).then_some(it)
        });
        if let Some(to) = off {
            tokens.drain(i..to);
        }
        i += 1;
    }
    tokens
}

/// "the workers have gone home, because it's night now": and it is.
fn because_sky(tokens: Vec<Token>) -> Vec<Token> {
    rewritten(&tokens, |i, out| {
        (i > 0).then_some(())?;
        let n = begins(
            &tokens[i..],
            "because|since|as|for|cause|seeing that|now that|given that",
        )?;
        let fact = &tokens[i + n..];
        let k = leads(
            fact,
            &[
                "it is",
                "its",
                "it is now",
                "its now",
                "it has become",
                "it has turned",
                "it has got",
                "it became",
                "it got",
                "it is already",
                "its already",
                "the",
                "there is",
                "theres",
            ],
        )?;
        let end = fact.iter().position(mark).unwrap_or(fact.len());
        let style = |t: &Token| matches!(look_up(text(t)), Some(Sense::Weather(_) | Sense::Time(_)));
        let said = k < end && end < k + 6 && fact[k..end].iter().any(style) && !has_noun(&fact[..end]);
        // ("as the rain lets up", "for the night": no fact of how it is)
        let is_so = !is(fact.first(), &["the"]) && !is(tokens.get(i), &["for"]);
        (said && is_so).then(|| {
            out.extend(led("and", &tokens[i], &[]));
            i + n
        })
    })
}

/// "so that it hides the view": what for.
fn hides_view(tokens: Vec<Token>) -> Vec<Token> {
    const HIDES: &str =
        "hides|blocks|obstructs|obscures|covers|takes|spoils|restricts|limits|hide|block|obstruct|cover";
    const VIEW: &str = "the view|our view|my view|the sight|our sight|my sight|the line of sight|our line of sight|the view of it|the view of the crossing|our view of it|our view of the crossing|the view of the sidewalk|our view of the sidewalk|the view to the right|the view to the left";
    rewritten(&tokens, |i, _| {
        let n = begins(
            &tokens[i..],
            "so that it|so it|so that they|so they|such that it|to|so as to|in order to|which|where it|and|that",
        )?;
        let verb = i + n;
        let view = verb + begins(tokens.get(verb..)?, HIDES)?;
        let end = view + begins(tokens.get(view..)?, VIEW)?;
        (i > 0 && tokens.get(end).is_none_or(mark)).then_some(end)
    })
}

/// "20 m ahead, farther off than the cyclist": told already.
fn farther_than(tokens: Vec<Token>) -> Vec<Token> {
    const FAR: &str = "farther off than|further off than|farther away than|further away than|farther than|further than|nearer than|closer than|closer to us than|nearer to us than|a bit farther off than|a bit further off than|so farther off than|so further off than|that is farther off than|still closer than|even closer than|even farther than|even further than|behind where";
    rewritten(&tokens, |i, out| {
        (tokens.get(i)?.kind == TokenKind::Comma).then_some(())?;
        let n = begins(&tokens[i + 1..], FAR)?;
        let from = out
            .iter()
            .rposition(|t| t.kind == TokenKind::Stop)
            .map_or(0, |k| k + 1);
        let measured =
            (from..out.len()).any(|k| number(&out[k]).is_some() && unit_at(&out[k + 1..]).is_some());
        let (_, b) = first_noun(&tokens[i + 1 + n..]).filter(|x| x.0 < 4)?;
        let end = i + 1 + n + b;
        let end = end + leads(&tokens[end..], &["is", "does", "was", "are"]).unwrap_or(0);
        (measured && tokens.get(end).is_none_or(mark)).then_some(end)
    })
}

/// "place it behind us, still in its own lane": in its own lane.
fn own_lane_still(tokens: Vec<Token>) -> Vec<Token> {
    rewritten(&tokens, |i, _| {
        let own = leads(
            tokens.get(i + 2..)?,
            &[
                "in its own lane",
                "in its lane",
                "in his own lane",
                "in her own lane",
                "in their own lane",
                "in the oncoming lane",
                "in our lane",
                "in the same lane as before",
            ],
        );
        let still = tokens[i].kind == TokenKind::Comma && is(tokens.get(i + 1), &["still", "but", "yet"]);
        let placed = is(tokens.first(), &["put", "place", "move", "set"])
            || (0..i).any(|k| is(tokens.get(k), &["place", "put", "set", "move"]));
        (still && placed && own.is_some()).then_some(i + 2)
    })
}

/// "the number of cars goes up to four": there should be four cars.
fn number_of(tokens: Vec<Token>) -> Vec<Token> {
    const GOES: &str = "goes up to|rises to|grows to|increases to|climbs to|jumps to|goes down to|drops to|falls to|sinks to|shrinks to|decreases to|goes to|is now|is|becomes|should be|must be|has to be|shall be|has gone up to|has risen to|has grown to|has gone down to|has dropped to|has fallen to|is up to|is down to|should rise to|should go up to|should drop to|should go down to|is to be|needs to be|is raised to|is reduced to|has increased to|has decreased to|amounts to|comes to|changes to|is to rise to|gets up to|reaches";
    rewritten(&tokens, |i, out| {
        let n = begins(
            &tokens[i..],
            "the number of|the count of|the total of|the total number of|number of",
        )?;
        let np = &tokens[i + n..];
        let np = &np[usize::from(is(np.first(), &["the"]))..];
        let from = tokens.len() - np.len();
        let (_, b) = first_noun(np).filter(|x| x.0 < 3)?;
        let goes = (b..np.len().min(b + 7)).find_map(|k| Some((k, begins(&np[k..], GOES)?)))?;
        let place = &np[b..goes.0];
        (place.is_empty() || is_place(place)).then_some(())?;
        let count = goes.0 + goes.1;
        let many = np.get(count).filter(|t| number(t).is_some())?;
        let end = from + count + 1;
        tokens
            .get(end)
            .is_none_or(|t| mark(t) || is(Some(t), &["and", "now", "again"]))
            .then_some(())?;
        out.extend(led(
            "there should be",
            &tokens[i],
            &[std::slice::from_ref(many), &np[..goes.0]],
        ));
        Some(end)
    })
}

/// "has turned round and is riding towards us": it rides towards us.
fn turned_and_comes(tokens: Vec<Token>) -> Vec<Token> {
    const TURNED: &str = "has turned round|has turned around|has made a u turn|has turned|turned round|turned around|turns round|turns around|has done a u turn|made a u turn|makes a u turn";
    rewritten(&tokens, |i, _| {
        let n = begins(&tokens[i..], TURNED).filter(|_| i > 0)?;
        let and = i + n;
        let is_at =
            and + usize::from(is(tokens.get(and), &["and"])) + usize::from(is(tokens.get(and + 1), &["now"]));
        let comes = is(
            tokens.get(is_at),
            &["is", "comes", "rides", "drives", "are", "approaches"],
        );
        let end = (is_at..tokens.len())
            .find(|k| mark(&tokens[*k]))
            .unwrap_or(tokens.len());
        let lane = find(&tokens[is_at.min(end)..end], &["lane", "side of the road"]).is_some();
        let towards = find(
            &tokens[is_at.min(end)..end],
            &["towards us", "towards me", "toward us", "toward me", "our way"],
        )
        .is_some();
        (is_at > and && comes && towards && lane).then_some(is_at)
    })
}

/// "two extra cars in the right lane please, one ahead of us": add two cars there.
fn extra(tokens: Vec<Token>) -> Vec<Token> {
    let counted = tokens.first().is_some_and(|t| number(t).is_some());
    let more = is(tokens.get(1), &["extra", "additional", "further", "more", "new"]);
    let named = first_noun(&tokens).is_some_and(|x| x.0 < 4);
    let shared = find(
        &tokens,
        &["one ahead", "one behind", "one in front", "one on", "one in"],
    )
    .is_some();
    if !(counted && more && named && shared) {
        return tokens;
    }
    let please = |i: usize| is(tokens.get(i), &["please"]) && tokens.get(i + 1).is_some_and(mark);
    let rest: Vec<Token> = (2..tokens.len())
        .filter(|i| !please(*i))
        .map(|i| tokens[i].clone())
        .collect();
    led("add", &tokens[0], &[&tokens[..1], &rest])
}

/// "there isn't a single motor vehicle left": all of them go.
fn none_left(tokens: &[Token]) -> Option<Vec<Token>> {
    let from = tokens
        .iter()
        .position(|t| text(t) == "there")
        .filter(|k| !has_noun(&tokens[..*k]))?;
    let n = from
        + leads(
            &tokens[from..],
            &[
                "there isnt",
                "there is not",
                "there arent",
                "there are not",
                "there shouldnt be",
                "there should not be",
                "there mustnt be",
                "there must not be",
            ],
        )?;
    let n = n + leads(
        &tokens[n..],
        &["a single", "any", "one single", "one", "even a single", "a"],
    )?;
    let np = &tokens[n..];
    let (_, b) = first_noun(np).filter(|x| x.0 < 3)?;
    let end = b + leads(
        &np[b..],
        &[
            "left",
            "any more",
            "anymore",
            "left over",
            "remaining",
            "left in the scene",
            "left here",
        ],
    )?;
    tokens.get(n + end).is_none_or(mark).then_some(())?;
    let mut noun = np[..b].to_vec();
    if let Some(last) = noun.last_mut().filter(|t| !t.text.ends_with('s')) {
        last.text = plural(&last.text);
    }
    // ("only the bicycle": that is what stays then)
    let rest = trimmed(&np[end..]);
    let only = is(rest.first(), &["only", "just"]);
    let rest = if only { &[][..] } else { &np[end..] };
    Some(led("remove all", &tokens[0], &[&noun, rest]))
}

/// "of the cars keep just the silver one": all go but that one.
fn of_these_only(tokens: &[Token], talk: &Talk<'_>) -> Option<Vec<Token>> {
    let n = leads(
        tokens,
        &[
            "of the",
            "from the",
            "among the",
            "out of the",
            "of all the",
            "of all",
            "from among the",
            "of these",
            "of those",
        ],
    )?;
    let np = &tokens[n..];
    let (_, b) = first_noun(np).filter(|x| x.0 < 3)?;
    let rest = trimmed(&np[b..]);
    // ("the silver one", or its name in full)
    let one = |t: &[Token]| {
        let named = first_noun(t).filter(|x| x.0 < 4).map(|x| x.1 - 1);
        (1..t.len().min(4)).find(|k| is(t.get(*k), &["one"])).or(named)
    };
    let the = if let Some(k) = leads(
        rest,
        &[
            "keep just",
            "keep only",
            "leave just",
            "leave only",
            "only keep",
            "just keep",
            "only leave",
            "spare only",
            "keep",
        ],
    ) {
        let the = &rest[k..];
        let e = one(the)?;
        trimmed(&the[e + 1..]).is_empty().then_some(&the[..=e])?
    } else {
        let k = leads(rest, &["only", "just"])?;
        let the = &rest[k..];
        let e = one(the)?;
        let late = trimmed(&the[e + 1..]);
        let stays = [
            "stays",
            "remains",
            "should stay",
            "may stay",
            "is left",
            "should remain",
            "is to stay",
            "should be left",
        ];
        (leads(late, &stays)? == late.len()).then_some(&the[..=e])?
    };
    // ("the right-hand one" is told by its side, which is read elsewhere)
    const SIDES: [&str; 10] = [
        "right", "left", "hand", "front", "rear", "nearest", "nearer", "farthest", "closest", "last",
    ];
    if the.iter().any(|t| is(Some(t), &SIDES)) {
        return None;
    }
    is(the.first(), &["the"]).then_some(())?;
    (talk.fits(&np[..b]) > 1).then(|| {
        led(
            "remove all",
            &tokens[0],
            &[&np[..b], &led("but", &tokens[0], &[the])],
        )
    })
}
