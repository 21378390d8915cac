//! Who has something done, and is no part of the scene: "the school wants three more children there", "the foreman sent one of the
//! workers over to the left sidewalk", "no one else saw it"; and what is named with what it replaces: "use barriers for the cones".

use super::super::lexicon::{Sense, look_up};
use super::super::tokens::Token;
use super::super::wording::{begins, rewritten};
use super::Talk;
use super::gifts::begins_at;
use super::headway::is_mark;
use super::lists::IN_PLACE;
use super::some_of::removes;
use super::vacated::Room;
use super::words::{first_noun, has_noun, is, is_goal, is_place, leads, led, noun_at, number, trimmed};
use crate::scene::Class;

/// A sentence (without its stop) as what is asked for.
pub fn plain(tokens: Vec<Token>, talk: &Talk<'_>) -> Vec<Token> {
    let out = given_there(sent_over(they_want(tokens), talk), talk);
    let out = not_wanted(use_for(out, talk), talk);
    let out = overtaken_by(out, talk);
    come_there(with_the_others(instead_there(out, talk), talk))
}

const THEY: &str = "school|residents|neighbours|neighbors|council|city|mayor|committee|client|customer|boss|producer|director|planners|people here|parents|public|citizens|locals|\
    ministry|town|municipality|authority|authorities|insurance|court|judge|prosecutor|prosecution|defence|reviewer|reviewers|team|crew chief|inspector|police|traffic police|fire brigade|\
    shopkeepers|cyclists association|operator|ops|stakeholders|brief|script|plan|spec|specification|scenario|test plan|ticket|requirement|requirements|regulations|law|rules|storyboard|\
    customers|clients|planning department|planning office|department|management|examiner|instructor|professor|supervisor|lead|art director|editor|everybody|everyone";
const WANT: &str = "wants|want|would like|would like to see|would like to have|wants to see|want to see|wants to have|want to have|asks for|ask for|needs|requires|require|requests|request|\
    demands|demand|wishes for|has asked for|have asked for|asked for|calls for|call for|called for|insists on|insist on|requested|demanded|wanted|is asking for|are asking for|prefers|prefer|\
    specifies|prescribes|foresees|provides for|have requested|has requested|would prefer|hope for|wish for";

/// "the school wants three more children": we do.
fn they_want(tokens: Vec<Token>) -> Vec<Token> {
    let the = usize::from(is(tokens.first(), &["the", "our", "my", "some", "local"]));
    let who = begins(&tokens[the..], THEY).map(|n| the + n);
    let Some(n) = who.and_then(|w| begins(&tokens[w..], WANT).map(|n| w + n)) else {
        return tokens;
    };
    let np = &tokens[n..];
    let new = is(np.first(), &["a", "an", "another", "some", "more"])
        || np.first().is_some_and(|t| number(t).is_some());
    // "my boss wants blue sky and sunshine"
    if !new && !has_noun(np) && super::parting::only_sky(np) {
        return led("make it", &tokens[0], &[np]);
    }
    if new && first_noun(np).is_some_and(|x| x.0 < 5) {
        return led("i want", &tokens[0], &[np]);
    }
    tokens
}

const SENT: &str = "sent|has sent|had sent|waved|has waved|ordered|has ordered|directed|has directed|called|has called|guided|has guided|led|has led|pulled|has pulled|brought|has brought|\
    moved|has moved|have moved|pushed|has pushed|walked|escorted|has escorted|told|steered|has steered|shifted|has shifted|took|has taken|sends|waves|moves|orders|directs|brings|guides|\
    leads|helped|has helped|carried|has carried|have sent|dragged|has dragged|rolled|has rolled|backed|has backed";

/// What leaves it standing there.
const LEFT: &str = "left|has left|have left|had left|parked|has parked|have parked|put|has put|have put|abandoned|has abandoned|have abandoned|placed|has placed|have placed|positioned|\
    has positioned|have positioned|stood|has stood|have stood|dumped|has dumped|have dumped|deposited|has deposited|stopped|has stopped|ditched|has ditched|stranded|has stranded|\
    dropped|has dropped|set|has set|have set|set down|has set down|has just left|has just parked|has just put|parks|leaves|puts|places";

/// True for somebody who is said to do something.
fn person(tokens: &[Token]) -> Option<usize> {
    const OTHERS: &str = "foreman|boss|supervisor|teacher|owner|driver|operator|dispatcher|controller|marshal|steward|warden|tow truck driver|recovery service|fire brigade|police|\
        site manager|manager|mechanic|somebody|someone|attendant|valet|instructor|director|stage manager|inspector|sergeant|mother|father|a gust of wind|wind|storm";
    if let Some(n) = begins(tokens, OTHERS) {
        return Some(n);
    }
    let n = noun_at(tokens)?;
    let name: Vec<&str> = tokens[..n].iter().map(|t| t.text.as_str()).collect();
    match look_up(&name.join(" ")) {
        Some(Sense::Noun(noun, _)) if noun.classes[0] == Class::Pedestrian => Some(n),
        _ => None,
    }
}

/// "the foreman sent one of the workers over to the left sidewalk": he is there.
fn sent_over(tokens: Vec<Token>, talk: &Talk<'_>) -> Vec<Token> {
    let the = usize::from(is(
        tokens.first(),
        &["the", "a", "an", "our", "my", "some", "his", "her", "its"],
    ));
    let who = tokens.get(the..).and_then(person).map(|n| the + n);
    let left = who.and_then(|w| begins(&tokens[w..], LEFT).map(|n| w + n));
    let Some(n) = who
        .and_then(|w| begins(&tokens[w..], SENT).map(|n| w + n))
        .or(left)
    else {
        return tokens;
    };
    let np = &tokens[n..];
    let part = usize::from(np.first().is_some_and(|t| number(t).is_some()) && is(np.get(1), &["of"])) * 2;
    let Some((_, b)) = first_noun(np)
        .filter(|x| x.0 < 5 && is(np.get(part), &["the", "that", "both", "all", "those", "these"]))
    else {
        return tokens;
    };
    let to = &np[b..];
    if is_place(to) && !is(to.first(), &["away", "off", "out", "home"]) && talk.fits(&np[part..b]) > 0 {
        if left.is_some() && part == 0 && !is_goal(to) {
            let stands = led("should be standing", &tokens[0], &[to]);
            return [&np[..b], &stands].concat();
        }
        return led("move", &tokens[0], &[np]);
    }
    tokens
}

const GIVES: &str = "give me|give us|let me have|let us have|lets have|let me see|i want|we want|id like|i would like|i need|we need|show us|we would like|i would like to have|\
    i would like to see|get me|bring me|id like to have|id like to see|hand me|let us see|we could use|i could use|id rather have|i would rather have";

/// "take the bus out and give me a taxi in its place": put one there.
fn given_there(tokens: Vec<Token>, talk: &Talk<'_>) -> Vec<Token> {
    rewritten(&tokens, |i, out| {
        let n = begins(&tokens[i..], GIVES).filter(|_| begins_at(&tokens, i))?;
        let new = is(tokens.get(i + n), &["a", "an", "another"])
            || tokens.get(i + n).is_some_and(|t| number(t).is_some());
        let np = &tokens[i + n..];
        let (_, b) = first_noun(np).filter(|x| new && x.0 < 4)?;
        let late = trimmed(&np[b..]);
        let here = leads(late, &IN_PLACE) == Some(late.len()) && !late.is_empty()
            || late.len() == 1 && is(late.first(), &["there"]);
        let gone = talk.room == Room::Gone || (0..i).any(|k| removes(tokens.get(k)) && begins_at(&tokens, k));
        (here && gone).then(|| {
            out.extend(led("put", &tokens[i], &[]));
            i + n
        })
    })
}

/// "use barriers for the cones, same number": those in their place.
fn use_for(tokens: Vec<Token>, talk: &Talk<'_>) -> Vec<Token> {
    let Some(n) = leads(&tokens, &["use", "take", "substitute", "have"])
        .filter(|_| !is(tokens.get(1), &["the", "all", "both", "that"]))
    else {
        return tokens;
    };
    let Some(k) = (n + 1..tokens.len().min(n + 5)).find(|k| is(tokens.get(*k), &["for"])) else {
        return tokens;
    };
    let old = &tokens[k + 1..];
    let Some((_, b)) = first_noun(old)
        .filter(|x| x.0 < 4 && is(old.first(), &["the", "all", "both", "those", "these", "that"]))
    else {
        return tokens;
    };
    let late = trimmed(&old[b..]);
    let same = [
        "same number",
        "the same number",
        "as many",
        "just as many",
        "one for one",
        "one each",
        "in the same number",
        "one to one",
        "same count",
        "in equal number",
    ];
    let whole = first_noun(&tokens[n..k]).is_some_and(|x| x.1 == k - n);
    if !whole || !(late.is_empty() || leads(late, &same) == Some(late.len())) || talk.fits(&old[..b]) == 0 {
        return tokens;
    }
    led(
        "replace",
        &tokens[0],
        &[&old[..b], &led("with", &tokens[0], &[&tokens[n..k]])],
    )
}

/// "the scooter is not required, kindly remove": it.
fn not_wanted(tokens: Vec<Token>, talk: &Talk<'_>) -> Vec<Token> {
    let Some((_, b)) = first_noun(&tokens).filter(|x| {
        x.0 < 4
            && is(
                tokens.first(),
                &["the", "that", "this", "both", "all", "those", "these"],
            )
    }) else {
        return tokens;
    };
    let Some(link) = (b + 1..tokens.len()).find(|k| is_mark(&tokens[*k]) || is(tokens.get(*k), &["so"]))
    else {
        return tokens;
    };
    let why = &tokens[b..link];
    let mut rest = &tokens[link + 1..];
    while is(
        rest.first(),
        &["so", "please", "kindly", "do", "just", "then", "and", "therefore"],
    ) {
        rest = &rest[1..];
    }
    let verb = removes(rest.first());
    let tail = ["please", "away", "out", "off", "now", "sir", "same", "the same"];
    let nothing = rest.iter().skip(1).all(|t| is(Some(t), &tail));
    let stated = is(
        why.first(),
        &[
            "is", "are", "was", "were", "looks", "look", "isnt", "arent", "seems", "does", "doesnt", "has",
        ],
    );
    if verb && nothing && stated && !has_noun(why) && talk.fits(&tokens[..b]) > 0 {
        return led("remove", &tokens[0], &[&tokens[..b]]);
    }
    tokens
}

const POSTURE: &str = "wait|stand|drive|ride|be|park|stay|sit|waiting|standing|driving|riding|parked|walk|walking|should wait|should stand|should drive|should ride|should be|must be|\
    should be waiting|should be standing|should be driving|waits|stands|drives|rides|is|sits|is parked|is waiting|is standing|follow|come";

/// "let a cyclist wait there instead of the car": one for the other.
fn instead_there(tokens: Vec<Token>, talk: &Talk<'_>) -> Vec<Token> {
    let lead = begins(
        &tokens,
        "let|have|make|i want|id like|i would like|we want|now|please|show|we need|i need",
    )
    .unwrap_or(0);
    let rest = &tokens[lead..];
    let new = is(rest.first(), &["a", "an"]);
    let Some((_, b)) = first_noun(rest).filter(|x| new && x.0 < 4) else {
        return tokens;
    };
    let to = b + usize::from(is(rest.get(b), &["to"]));
    let Some(verb) = begins(&rest[to..], POSTURE).map(|n| to + n) else {
        return tokens;
    };
    let instead = (verb..rest.len()).find_map(|k| {
        leads(&rest[k..], &["instead of", "in place of", "rather than", "not"]).map(|n| (k, k + n))
    });
    let Some((k, from)) = instead else { return tokens };
    let old = &rest[from..];
    let whole = first_noun(old).is_some_and(|x| x.0 < 4 && x.1 == old.len())
        && is(old.first(), &["the", "that", "this"]);
    if !whole || talk.fits(old) != 1 {
        return tokens;
    }
    let at = trimmed(&rest[verb..k]);
    if leads(
        at,
        &["there", "here", "in that place", "in that spot", "at that spot"],
    ) == Some(at.len())
    {
        return led(
            "replace",
            &tokens[0],
            &[old, &led("with", &tokens[0], &[&rest[..b]])],
        );
    }
    // (another place than the old one had)
    if is_place(at) && !has_noun(at) {
        return [
            &led("remove", &tokens[0], &[old]),
            &led("and add", &tokens[0], &[&rest[..b], at])[..],
        ]
        .concat();
    }
    tokens
}

/// "two more people, both on the left sidewalk with the old man": he is there already.
fn with_the_others(tokens: Vec<Token>, talk: &Talk<'_>) -> Vec<Token> {
    // "two more people turned up, both on the right sidewalk": there
    let late = (3..tokens.len()).find(|k| {
        is_mark(&tokens[k - 1])
            && leads(&tokens[*k..], &["both", "all", "both of them", "all of them"]).is_some()
    });
    if let Some(k) = late
        && tokens.first().is_some_and(|t| number(t).is_some_and(|n| n > 1))
        && is(tokens.get(1), &["more", "further", "additional", "other", "new"])
        && is(
            tokens.get(k - 2),
            &[
                "arrived", "come", "up", "appeared", "forward", "joined", "along", "came", "shown",
            ],
        )
    {
        let n = k + leads(&tokens[k..], &["both", "all", "both of them", "all of them"]).unwrap_or(1);
        let place = &tokens[n..];
        let with = place
            .iter()
            .position(|t| is(Some(t), &["with"]))
            .unwrap_or(place.len());
        let named = first_noun(&tokens[..k]).filter(|x| x.0 < 4);
        let known = with == place.len() || talk.fits(&place[with + 1..]) > 0;
        if let Some((_, b)) = named.filter(|_| is_place(place) && known && !has_noun(&place[..with])) {
            return led("add", &tokens[0], &[&tokens[..b], &place[..with]]);
        }
    }
    let Some(k) =
        (4..tokens.len()).find(|k| is(tokens.get(*k), &["with"]) && is(tokens.get(k + 1), &["the"]))
    else {
        return tokens;
    };
    let np = &tokens[k + 1..];
    let whole = first_noun(np).is_some_and(|x| x.1 == np.len());
    let both = (1..k).find(|i| is_mark(&tokens[i - 1]) && is(tokens.get(*i), &["both", "all"]));
    match both {
        Some(i) if whole && is_place(&tokens[i + 1..k]) && !has_noun(&tokens[i..k]) && talk.fits(np) > 0 => {
            tokens[..k].to_vec()
        }
        _ => tokens,
    }
}

/// "the truck is overtaken by a motorcycle in the left lane": that is new.
fn overtaken_by(tokens: Vec<Token>, talk: &Talk<'_>) -> Vec<Token> {
    let Some((_, b)) = first_noun(&tokens).filter(|x| x.0 < 4 && is(tokens.first(), &["the", "that", "my"]))
    else {
        return tokens;
    };
    let n = leads(
        &tokens[b..],
        &[
            "is overtaken by",
            "is being overtaken by",
            "gets overtaken by",
            "is passed by",
            "is being passed by",
            "gets passed by",
            "was overtaken by",
            "was being overtaken by",
        ],
    );
    let Some(np) = n
        .and_then(|n| tokens.get(b + n..))
        .filter(|np| is(np.first(), &["a", "an", "another"]))
    else {
        return tokens;
    };
    let placed = first_noun(np).is_some_and(|x| x.0 < 4 && is_place(&np[x.1..]) && !has_noun(&np[x.1..]));
    if placed && talk.fits(&tokens[..b]) > 0 {
        return led("add", &tokens[0], &[np]);
    }
    tokens
}

/// "next to the woman there comes yet a man with a child": add them there.
fn come_there(tokens: Vec<Token>) -> Vec<Token> {
    let found = (0..tokens.len().min(8)).find_map(|k| {
        let n = leads(
            &tokens[k..],
            &[
                "there comes",
                "there come",
                "there will come",
                "comes there",
                "there is coming",
                "there are coming",
            ],
        )?;
        Some((k, k + n))
    });
    let Some((k, mut from)) = found else { return tokens };
    while is(tokens.get(from), &["yet", "still", "also", "too", "now"]) {
        from += 1;
    }
    let np = &tokens[from..];
    let new =
        is(np.first(), &["a", "an", "another", "some"]) || np.first().is_some_and(|t| number(t).is_some());
    let place = &tokens[..k];
    let named = first_noun(np).is_some_and(|x| x.0 < 4);
    if !new || !named || !(place.is_empty() || is_place(place)) {
        return tokens;
    }
    led("add", &tokens[0], &[np, place])
}

/// "No one else saw it.": nobody goes.
pub fn unseen(tokens: Vec<Token>) -> Vec<Token> {
    let n = leads(
        &tokens,
        &[
            "no one else",
            "nobody else",
            "noone else",
            "no one",
            "nobody",
            "noone",
        ],
    )
    .unwrap_or(0);
    let does = [
        "saw",
        "noticed",
        "heard",
        "remembers",
        "knows",
        "minds",
        "cares",
        "mentioned",
        "reported",
        "recalls",
        "sees",
        "remembered",
        "needs",
        "wants",
        "likes",
        "confirmed",
        "was",
        "complained",
    ];
    let end = tokens.len().min(n + 4);
    let it = n > 0
        && is(tokens.get(n), &does)
        && !is(tokens.get(n), &["was"])
        && tokens[n + 1..end].len() == tokens.len() - n - 1;
    let object = tokens
        .get(n + 1)
        .is_none_or(|t| is(Some(t), &["it", "that", "this", "them", "him", "her", "about"]));
    if it && object { Vec::new() } else { tokens }
}
