//! How a command is asked for: "would you mind removing the bus", "my boss wants you to add a van", "for the next test, ...", "it has
//! been established that ...". Many turns of speech are known by how a sentence begins or ends, so what it is wrapped in is taken off
//! before anything else is read.

use super::super::tokens::{Span, Token, TokenKind};
use super::super::wording::begins;
use super::super::words::verbs::forms;
use super::apart::{ORDERS, orders_something, says};
use super::words::{has_noun, is, is_place, led, number, text};

/// Before a command: "remove".
const TO: &str = "\
    could you|can you|would you|will you|could we|can we|may we|could i|can i|may i|shall we|should we|might we|\
    couldnt you|cant you|wont you|could one|can one|i want to|i want you to|we want to|we want you to|i need to|\
    i need you to|we need to|we need you to|i would like to|id like to|i would like you to|id like you to|\
    we would like to|wed like to|we would like you to|wed like you to|i would love to|id love to|\
    i would love you to|i wish to|we wish to|i prefer to|id prefer to|i would prefer to|\
    we should|i should|you should|you can|you could|you may|you must|you have to|you need to|we must|we have to|\
    we can|we could|we will|i will|ill|well|i must|i have to|let us|lets|its time to|it is time to|it is best to|\
    its best to|it is better to|its better to|it is necessary to|its necessary to|it is important to|\
    it would be nice to|it would be good to|it would be great to|it would be better to|it would be best to|\
    it would be helpful to|it would be useful to|it would be interesting to|itd be nice to|itd be good to|\
    itd be great to|itd be better to|itd be cool to|it would be cool to|it makes sense to|it would make sense to|\
    i have decided to|ive decided to|we decided to|why dont you|why dont we|why not|why do we not|what if we|\
    what if you|what if i|how about we|how about you|suppose we|go ahead and|be so good as to|be so kind as to|\
    do me a favour and|do me a favor and|feel free to|dont forget to|do not forget to|remember to|make sure to|\
    make sure you|make sure that you|be sure to|be sure you|see to it that you|please be so kind as to|try to|\
    i ask you to|i am asking you to|im asking you to|i beg you to|i must ask you to|the idea is to|the plan is to|\
    the task is to|your task is to|the next step is to|the thing to do is to|all you need to do is|\
    all we need to do is|what i want is to|i think we should|i think you should|i guess we should|i suggest we|\
    i suggest you|i suggest that we|i suggest that you|i propose we|i propose that we|i propose to|i recommend to|\
    maybe we should|perhaps we should|maybe you could|perhaps you could|maybe|perhaps|we are going to|were going to|\
    i am going to|im going to|we now|we then|you then|i now|you might want to|you may want to|we might want to|\
    there is a need to|i have to ask you to|time to|next we|now we|next you|now you|i hereby ask you to|kindly|\
    please to|please|simply|quickly|and|also|then|now|next|so|ok|okay|hey|hi|hello|well then|alright|right then|first|\
    firstly|second|secondly|third|thirdly|finally|lastly|last|additionally|furthermore|moreover|oh|oh and|\
    ok so|okay so|first of all|to begin with|to start with|for starters|after that|afterwards|in addition|\
    instead of that|one more thing|another thing|later|meanwhile|actually|on second thought|on second thoughts|\
    yo|nah|bro|dude|yeah|yep|hmm|uh|um|ey|aye|guys|folks|hey guys|man|boss|immediately|carefully|somebody|someone|is it possible to|would it be possible to|is it ok to|would it be ok to|\
    is there a way to|is there any way to|would you be able to|are you able to|are we able to|i wonder if you could|\
    i was wondering if you could|i was wondering whether you could|i wonder whether you could|could i ask you to|\
    may i ask you to|can i ask you to|id ask you to|i would ask you to|any chance to|is there a chance to|\
    would it be too much to|it might be better to|it might be good to|you had better|youd better|we had better";
/// Before what is done: "removing".
const DOING: &str = "\
    would you mind|do you mind|how about|what about|i suggest|we suggest|i propose|we propose|i recommend|try|\
    consider|start by|begin by|continue by|go on by|finish by|end by|proceed by|lets try|let us try|\
    i was thinking of|i am thinking of|im thinking of|i would suggest|id suggest|i would propose|id propose|\
    i would recommend|id recommend|i fancy|i feel like|i insist on|i vote for|it is worth|its worth|\
    it would be worth|would you consider|think about|go ahead by";
/// Who wants it.
const WHO: &str = "\
    client|customer|boss|manager|director|team|teacher|instructor|supervisor|colleague|professor|producer|lead|\
    engineer|designer|tester|judge|sergeant|inspector|trainer|user|editor|reviewer|chief|department|management|\
    office|headquarters|city|council|insurance|script|plan|test plan|specification|spec|scenario|protocol|brief|\
    briefing|ticket|requirement";
const WANTS: &str = "\
    wants you to|wants us to|wants me to|asked you to|asked us to|asked me to|asks you to|asks us to|asks me to|\
    told you to|told us to|told me to|tells you to|tells us to|tells me to|would like you to|would like us to|\
    would like me to|needs you to|needs us to|needs me to|expects you to|expects us to|requires us to|\
    requires you to|says to|said to|wants to|would like to|requests you to|requested us to|orders us to|\
    ordered us to|suggested to|suggests to|has asked us to|has asked me to|has asked you to|has told us to";
/// Before a statement, with or without "that".
const TOLD: &str = "\
    as far as i know|as far as we know|as i recall|as i remember|as we know|as you know|it has been established|\
    it has been decided|it was established|it is established|it is known|it has been confirmed|it was confirmed|\
    we have learned|we have learnt|we learned|i have learned|i have decided|we have decided|i decided|i want it so|\
    lets say|let us say|lets assume|let us assume|assume|lets suppose|let us suppose|suppose|suppose now|supposing|\
    imagine|imagine now|picture|from now on|as of now|at the material time|at that moment|at that time|\
    at that point|at this point|at this moment|in this version|in the new version|in the end|in fact|in truth|\
    in reality|to be precise|to be exact|strictly speaking|my information is|the fact is|the truth is|it is a fact|\
    it is agreed|it has been agreed|we agreed|i am told|i am informed|i hear|i have heard|we have been told|\
    word has it|it is reported|it was reported|correction|i noticed|we noticed|i think|i believe|i guess|i suppose|\
    i would say|id say|i find|it appears|it seems|it turned out|it turns out|it is important|it is essential|\
    it must be so|i insist|i demand|we demand|i request|i prefer|please note|note|note well|mind you|\
    just so you know|for your information|by now|nowadays|these days|this time|meanwhile|in the meantime|actually|\
    apparently|evidently|obviously|indeed|finally|and finally|now|then|next|also|so|ok|okay|hey|well|oh|please|and|\
    moreover|furthermore|on second thought|on second thoughts|suddenly|later|afterwards";
/// Who or what states it.
const SAYERS: &str = "\
    witness|witnesses|witness one|witness two|witness three|witness a|witness b|second witness|other witness|report|reports|log|statement|police report|accident report|video|footage|recording|data|notes|\
    sketch|colleague|map|file|record|records|transcript|plaintiff|defendant|claimant|story|page|text|caption|\
    storyboard";
const SAYS: &str = "\
    says|said|states|stated|claims|claimed|reports|reported|tells us|told us|tells me|told me|confirms|confirmed|\
    insists|writes|wrote|specifies|requires|demands|assumes|shows|maintains|testified|has testified|has stated|\
    has confirmed|believes|thinks|wants it so|swears|recalls|remembers|explains|explained|adds|contradicts that|disagrees|contradicts this|objects|corrects that|\
    corrects this|differs|sees it differently|corrected that|contradicted that";
/// What a sentence is for, before a comma: "for the next test".
const FOR: &[&str] = &["for", "in", "as", "with", "during", "on"];
const STEPS: &str = "\
    test|step|run|scene|shot|take|variant|version|scenario|round|exercise|lesson|case|trial|task|part|phase|\
    iteration|example|experiment|study|training|demo|comparison|measure|edit|change|action|variation|moment|picture";
/// What is only said for courtesy at the end, after a comma.
const TAILS: &str = "\
    would you|could you|will you|can you|wont you|please|pls|thanks|thank you|thx|cheers|thats all|that is all|ok|\
    okay|right|if you can|if you could|if you would|if possible|thank you very much|many thanks|thats it|that is it|\
    will ya|mate|thanks a lot|for me|for me please|if thats ok|if you like|if you dont mind|asap|for now|as agreed|\
    as discussed|as planned|as requested|as promised|nothing else|nothing more|no more no less|and thats it|\
    and that is it|and nothing else|and thats all|and leave the rest as it is|and leave everything else as it is|\
    but keep everything else|but keep the rest|and keep the rest|if that works|i think|i guess|i believe|i suppose|\
    for realism|for more realism|for variety|for a change|for fun|much better|as usual";
/// Tails that need no comma.
const BARE_TAILS: &str = "\
    for more realism|for the test|for this test|for the demo|for realism|for variety|for my test|for our test|\
    for the scenario|for the shot|for the scene|for the study|for our study|for my thesis|as agreed|as discussed|\
    as planned|as requested|as promised|for me please|tbh|lol|lmao|ngl|imo|imho|haha|bro|dude|innit|to be honest|\
    if you ask me|my friend|buddy|guys";
/// How a reason begins that follows a comma.
const WHY: &str = "\
    because|since it|since that|since this|since we|since i|as it looks|as it makes|as that|as in the real|\
    as i need|as we need|that would be|that is better|thats better|that makes|that looks|that way|it makes|it looks|\
    it would look|it would be|this makes|this would|this looks|i need that|i need it|i want it|i want that|i think|\
    i guess|i believe|i suppose|i hope|i like|i love|i hate|i prefer it|so it looks|so that the test|so the test|\
    so that the scene|so the scene|to make it|to make the|in order to|to test|to see whether|to see if|to see how|\
    just to|only to|will that|would that|is that|does that|if that|otherwise|the customer|the client|my boss|\
    much better|far better|which would be";
/// How a purpose begins that stands before a command.
const PURPOSE: &str = "\
    to make|in order to|so as to|to keep|to get|to test|to see|to show|to have|to increase";

/// The tokens without what sentences are wrapped in.
pub fn unasked(tokens: Vec<Token>) -> Vec<Token> {
    let mut out = Vec::with_capacity(tokens.len());
    for sentence in tokens.split_inclusive(|t| t.kind == TokenKind::Stop) {
        let (body, stop) = match sentence.split_last() {
            Some((last, body)) if last.kind == TokenKind::Stop => (body, Some(last)),
            _ => (sentence, None),
        };
        let bare = bare(body);
        // (a command is no question)
        let start = |s: &Token| Span {
            start: s.span.start,
            end: s.span.start,
        };
        let unwrapped = bare.is_some();
        out.extend(bare.unwrap_or_else(|| body.to_vec()));
        out.extend(stop.map(|s| Token {
            span: if unwrapped { start(s) } else { s.span },
            ..s.clone()
        }));
    }
    out
}

/// The command or statement of a sentence, if something is wrapped around it.
fn bare(body: &[Token]) -> Option<Vec<Token>> {
    // (nobody wraps a sentence in more)
    const MOST_LAYERS: usize = 5;
    const ASKS: &[&str] = &[
        "is", "are", "was", "were", "does", "do", "did", "why", "where", "who", "what", "how", "has", "have",
    ];
    let question = is(body.first(), ASKS);
    let mut rest = &body[..without_tail(body)];
    let tail = rest.len() < body.len();
    for layer in 0..MOST_LAYERS {
        while rest.first().is_some_and(|t| t.kind == TokenKind::Comma) {
            rest = &rest[1..];
        }
        if orders_something(rest) || orders_pointed(rest) {
            return (layer > 0 || tail).then(|| rest.to_vec());
        }
        if let Some(n) = reason_before(rest) {
            rest = &rest[n..];
            continue;
        }
        if let Some(command) = begins(rest, DOING).and_then(|n| done(&rest[n..])) {
            return Some(command);
        }
        let told = begins(rest, TOLD)
            .or_else(|| someone_says(rest))
            .map(|n| n + that(&rest[n..]));
        let to = begins(rest, TO)
            .or_else(|| someone_wants(rest))
            .or_else(|| step(rest));
        // (the longer one: "i think we should" is more than "i think")
        match to.max(told) {
            Some(n) => rest = &rest[n..],
            None => return (says(rest) && !question && (layer > 0 || tail)).then(|| rest.to_vec()),
        }
    }
    None
}

/// "remove it", "let them wait": a command with a pronoun.
fn orders_pointed(rest: &[Token]) -> bool {
    const POINTED: &[&str] = &[
        "it",
        "them",
        "him",
        "her",
        "both",
        "one",
        "everything",
        "everyone",
        "that",
        "more",
    ];
    is(rest.first(), ORDERS) && is(rest.get(1), POINTED)
}

/// "removing the bus": remove the bus.
fn done(rest: &[Token]) -> Option<Vec<Token>> {
    let first = rest.first()?;
    let verb = ORDERS.iter().find(|v| forms(v).ing == text(first))?;
    let out = led(verb, first, &[&rest[1..]]);
    (orders_something(&out) || orders_pointed(&out)).then_some(out)
}

/// How many tokens an article or a possessive takes here.
fn the(rest: &[Token]) -> usize {
    usize::from(is(
        rest.first(),
        &["the", "my", "our", "a", "one", "your", "his", "her", "this"],
    ))
}

/// "the client asked us to": one past it.
fn someone_wants(rest: &[Token]) -> Option<usize> {
    let who = the(rest) + begins(&rest[the(rest)..], WHO)?;
    Some(who + begins(&rest[who..], WANTS)?)
}

/// "the revised report says": one past it.
fn someone_says(rest: &[Token]) -> Option<usize> {
    const WHICH: &[&str] = &[
        "new", "revised", "second", "other", "first", "original", "final", "official", "latest",
    ];
    let from = the(rest);
    let from = from + usize::from(is(rest.get(from), WHICH));
    let who = begins(rest.get(from..)?, SAYERS).or_else(|| begins(&rest[from..], WHO))?;
    Some(from + who + begins(&rest[from + who..], SAYS)?)
}

/// ", that" before what is told.
fn that(rest: &[Token]) -> usize {
    let mark = rest
        .first()
        .is_some_and(|t| t.kind == TokenKind::Comma || text(t) == ":");
    let n = usize::from(mark);
    n + usize::from(is(rest.get(n), &["that"]))
}

/// "for the next test,", "in the new take": one past it.
fn step(rest: &[Token]) -> Option<usize> {
    if !is(rest.first(), FOR) {
        return None;
    }
    let at = |k: usize| begins(&rest[k..], STEPS) == Some(1);
    let bare = (2..rest.len().min(6)).find(|k| {
        at(*k)
            && is(rest.get(1), &["the", "this", "our", "my", "a", "that"])
            && is(
                rest.get(k + 1),
                &["the", "a", "an", "two", "three", "there", "both", "all"],
            )
    });
    if let Some(k) = bare {
        return Some(k + 1);
    }
    let comma = rest.iter().take(7).position(|t| t.kind == TokenKind::Comma)?;
    // ("for safety, ...")
    let aim =
        comma < 4 && is(rest.first(), &["for"]) && !has_noun(&rest[..comma]) && number(&rest[1]).is_none();
    (comma > 1 && (aim || at(comma - 1))).then_some(comma + 1)
}

/// "because it looks better,", "to make it harder,": one past the comma, if a command follows.
fn reason_before(rest: &[Token]) -> Option<usize> {
    let why = is(rest.first(), &["because", "since", "as"])
        && !is(rest.get(1), &["before", "well", "for", "to", "far"])
        || begins(rest, PURPOSE).is_some();
    let comma = rest
        .iter()
        .take(14)
        .position(|t| t.kind == TokenKind::Comma)
        .filter(|_| why)?;
    // (what is named before the command may be what it means by "it")
    (comma > 2 && orders_something(&rest[comma + 1..]) && !has_noun(&rest[..comma])).then_some(comma + 1)
}

/// Where what is only said for courtesy or as a reason at the end begins.
fn without_tail(body: &[Token]) -> usize {
    let comma = |i: usize| body[i].kind == TokenKind::Comma || matches!(text(&body[i]), "-" | "(");
    let set_off = (2..body.len()).find(|i| {
        let rest = &body[i + 1..];
        let closed = |n: usize| n == rest.len() || n + 1 == rest.len() && text(&rest[n]) == ")";
        comma(*i) && !rest.is_empty() && (begins(rest, TAILS).is_some_and(closed) || reason_after(rest))
    });
    let bare =
        || (2..body.len()).find(|i| begins(&body[*i..], BARE_TAILS).is_some_and(|n| i + n == body.len()));
    set_off.or_else(bare).unwrap_or(body.len())
}

/// ", because it looks better", ", that would be better", ", I like buses": why it is asked for.
fn reason_after(rest: &[Token]) -> bool {
    let goes_on = rest
        .iter()
        .any(|t| is(Some(t), &["and", "then", "but", "so"]) || t.kind == TokenKind::Comma);
    let measures = rest.iter().any(|t| number(t).is_some());
    // ("I want it parked on the left": that is where)
    let placed = begins(
        rest,
        "i want it|i need it|i want that|i need that|i like it|i prefer it",
    )
    .is_some_and(|n| (n..rest.len().min(n + 4)).any(|k| is_place(&rest[k..])));
    begins(rest, WHY).is_some() && !placed && !goes_on && !measures && rest.len() < 14
}

#[cfg(test)]
mod tests {
    use super::super::super::tokens::tokens;
    use super::*;

    #[test]
    fn commands_unwrapped() {
        let said = |t: &str| {
            let list: Vec<String> = unasked(tokens(t)).into_iter().map(|t| t.text).collect();
            list.join(" ")
        };
        for wrapped in [
            "would you mind removing the bus",
            "my boss wants you to remove the bus",
            "for the next test, remove the bus",
            "it's time to remove the bus",
            "I think we should remove the bus, please",
            "ok so remove the bus, would you",
            "because it looks better, remove the bus",
            "remove the bus, that would be better",
        ] {
            assert_eq!(said(wrapped), "remove the bus");
        }
        for plain in ["we see a bus", "the bus should go", "for the bus, wait"] {
            assert_eq!(said(plain), plain.replace(",", " ,").to_lowercase());
        }
    }
}
