//! How a command is asked for: "would you mind removing the bus", "my boss wants you to add a van", "for the next test, ...". Many
//! turns of speech are known by how a sentence begins, so what a command is wrapped in is taken off before anything else is read.

use super::super::tokens::{Span, Token, TokenKind};
use super::super::words::verbs::forms;
use super::apart::{ORDERS, orders_something};
use super::words::{is, leads, led, text};

/// Before a command: "remove".
const TO: &[&str] = &[
    "could you",
    "can you",
    "would you",
    "will you",
    "could we",
    "can we",
    "may we",
    "could i",
    "can i",
    "may i",
    "shall we",
    "should we",
    "might we",
    "couldnt you",
    "cant you",
    "wont you",
    "could one",
    "can one",
    "i want to",
    "i want you to",
    "we want to",
    "we want you to",
    "i need to",
    "i need you to",
    "we need to",
    "we need you to",
    "i would like to",
    "id like to",
    "i would like you to",
    "id like you to",
    "we would like to",
    "wed like to",
    "we would like you to",
    "wed like you to",
    "i would love to",
    "id love to",
    "i would love you to",
    "i wish to",
    "we wish to",
    "i prefer to",
    "id prefer to",
    "i would prefer to",
    "id rather",
    "i would rather",
    "we should",
    "i should",
    "you should",
    "you can",
    "you could",
    "you may",
    "you must",
    "you have to",
    "you need to",
    "we must",
    "we have to",
    "we can",
    "we could",
    "we will",
    "i will",
    "ill",
    "well",
    "i must",
    "i have to",
    "let us",
    "lets",
    "its time to",
    "it is time to",
    "it is best to",
    "its best to",
    "it is better to",
    "its better to",
    "it is necessary to",
    "its necessary to",
    "it is important to",
    "it would be nice to",
    "it would be good to",
    "it would be great to",
    "it would be better to",
    "it would be best to",
    "it would be helpful to",
    "it would be useful to",
    "it would be interesting to",
    "itd be nice to",
    "itd be good to",
    "itd be great to",
    "itd be better to",
    "itd be cool to",
    "it would be cool to",
    "it makes sense to",
    "it would make sense to",
    "i have decided to",
    "ive decided to",
    "we decided to",
    "why dont you",
    "why dont we",
    "why not",
    "why do we not",
    "what if we",
    "what if you",
    "what if i",
    "how about we",
    "how about you",
    "suppose we",
    "go ahead and",
    "be so good as to",
    "be so kind as to",
    "do me a favour and",
    "do me a favor and",
    "feel free to",
    "dont forget to",
    "do not forget to",
    "remember to",
    "make sure to",
    "make sure you",
    "make sure that you",
    "be sure to",
    "be sure you",
    "see to it that you",
    "please be so kind as to",
    "try to",
    "i ask you to",
    "i am asking you to",
    "im asking you to",
    "i beg you to",
    "i must ask you to",
    "the idea is to",
    "the plan is to",
    "the task is to",
    "your task is to",
    "the next step is to",
    "the thing to do is to",
    "all you need to do is",
    "all we need to do is",
    "what i want is to",
    "i think we should",
    "i think you should",
    "i guess we should",
    "i suggest we",
    "i suggest you",
    "i suggest that we",
    "i suggest that you",
    "i propose we",
    "i propose that we",
    "i propose to",
    "i recommend to",
    "maybe we should",
    "perhaps we should",
    "maybe you could",
    "perhaps you could",
    "maybe",
    "perhaps",
    "we are going to",
    "were going to",
    "i am going to",
    "im going to",
    "we now",
    "we then",
    "you then",
    "i now",
    "you might want to",
    "you may want to",
    "we might want to",
    "there is a need to",
    "i have to ask you to",
    "time to",
    "next we",
    "now we",
    "next you",
    "now you",
    "i hereby ask you to",
    "kindly",
    "please",
    "simply",
    "quickly",
    "just",
    "and",
    "also",
    "then",
    "now",
    "next",
    "so",
    "ok",
    "okay",
    "hey",
    "hi",
    "hello",
    "well then",
    "alright",
    "right then",
    "first",
    "firstly",
    "second",
    "secondly",
    "third",
    "thirdly",
    "finally",
    "lastly",
    "last",
    "besides",
    "additionally",
    "furthermore",
    "moreover",
    "oh",
    "oh and",
    "ok so",
    "okay so",
    "first of all",
    "to begin with",
    "to start with",
    "for starters",
    "after that",
    "afterwards",
    "in addition",
    "instead of that",
    "one more thing",
    "another thing",
    "later",
    "meanwhile",
    "actually",
    "on second thought",
    "on second thoughts",
    "immediately",
    "carefully",
    "somebody",
    "someone",
];

/// Before what is done: "removing".
const DOING: &[&str] = &[
    "would you mind",
    "do you mind",
    "how about",
    "what about",
    "i suggest",
    "we suggest",
    "i propose",
    "we propose",
    "i recommend",
    "try",
    "consider",
    "start by",
    "begin by",
    "continue by",
    "go on by",
    "finish by",
    "end by",
    "proceed by",
    "lets try",
    "let us try",
    "i was thinking of",
    "i am thinking of",
    "im thinking of",
    "i would suggest",
    "id suggest",
    "i would propose",
    "id propose",
    "i would recommend",
    "id recommend",
    "i fancy",
    "i feel like",
    "i insist on",
    "i vote for",
    "it is worth",
    "its worth",
    "it would be worth",
    "would you consider",
    "think about",
    "go ahead by",
];

/// Who wants it.
const WHO: &[&str] = &[
    "client",
    "customer",
    "boss",
    "manager",
    "director",
    "team",
    "teacher",
    "instructor",
    "supervisor",
    "colleague",
    "professor",
    "producer",
    "lead",
    "engineer",
    "designer",
    "tester",
    "judge",
    "sergeant",
    "inspector",
    "trainer",
    "user",
    "editor",
    "reviewer",
    "chief",
    "department",
    "management",
    "office",
    "headquarters",
    "city",
    "council",
    "insurance",
    "script",
    "plan",
    "test plan",
    "specification",
    "spec",
    "scenario",
    "protocol",
    "brief",
    "briefing",
    "ticket",
    "requirement",
];
const WANTS: &[&str] = &[
    "wants you to",
    "wants us to",
    "wants me to",
    "asked you to",
    "asked us to",
    "asked me to",
    "asks you to",
    "asks us to",
    "asks me to",
    "told you to",
    "told us to",
    "told me to",
    "tells you to",
    "tells us to",
    "tells me to",
    "would like you to",
    "would like us to",
    "would like me to",
    "needs you to",
    "needs us to",
    "needs me to",
    "expects you to",
    "expects us to",
    "requires us to",
    "requires you to",
    "says to",
    "said to",
    "wants to",
    "would like to",
    "requests you to",
    "requested us to",
    "orders us to",
    "ordered us to",
    "suggested to",
    "suggests to",
    "has asked us to",
    "has asked me to",
    "has asked you to",
    "has told us to",
];

/// What a sentence is for, before a comma.
const FOR: &[&str] = &["for", "in", "as", "with", "during", "on"];
const STEPS: &[&str] = &[
    "test",
    "step",
    "run",
    "scene",
    "shot",
    "take",
    "variant",
    "version",
    "scenario",
    "round",
    "exercise",
    "lesson",
    "case",
    "trial",
    "task",
    "part",
    "phase",
    "iteration",
    "example",
    "experiment",
    "study",
    "training",
    "demo",
    "comparison",
    "measure",
    "edit",
    "change",
    "action",
    "variation",
    "moment",
    "picture",
];

/// The tokens without what commands are wrapped in.
pub fn unasked(tokens: Vec<Token>) -> Vec<Token> {
    let mut out = Vec::with_capacity(tokens.len());
    for sentence in tokens.split_inclusive(|t| t.kind == TokenKind::Stop) {
        let (body, stop) = match sentence.split_last() {
            Some((last, body)) if last.kind == TokenKind::Stop => (body, Some(last)),
            _ => (sentence, None),
        };
        let bare = bare(body);
        // (a command is no question)
        let asked = bare.is_some();
        out.extend(bare.unwrap_or_else(|| body.to_vec()));
        out.extend(stop.map(|s| Token {
            span: if asked {
                Span {
                    start: s.span.start,
                    end: s.span.start,
                }
            } else {
                s.span
            },
            ..s.clone()
        }));
    }
    out
}

/// The command of a sentence, if something is wrapped around it.
fn bare(body: &[Token]) -> Option<Vec<Token>> {
    // (nobody wraps a command in more)
    const MOST_LAYERS: usize = 5;
    let mut rest = &body[..without_tail(body)];
    let tail = rest.len() < body.len();
    for layer in 0..MOST_LAYERS {
        while rest.first().is_some_and(|t| t.kind == TokenKind::Comma) {
            rest = &rest[1..];
        }
        if orders_something(rest) || orders_pointed(rest) {
            return (layer > 0 || tail).then(|| rest.to_vec());
        }
        if let Some(command) = leads(rest, DOING).and_then(|n| done(&rest[n..])) {
            return Some(command);
        }
        let n = leads(rest, TO)
            .or_else(|| someone_wants(rest))
            .or_else(|| step(rest))?;
        rest = &rest[n..];
    }
    None
}

/// "remove it", "let them wait": a command with a pronoun.
fn orders_pointed(rest: &[Token]) -> bool {
    is(rest.first(), ORDERS)
        && is(
            rest.get(1),
            &[
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
            ],
        )
}

/// "removing the bus": remove the bus.
fn done(rest: &[Token]) -> Option<Vec<Token>> {
    let first = rest.first()?;
    let verb = ORDERS.iter().find(|v| forms(v).ing == text(first))?;
    let out = led(verb, first, &[&rest[1..]]);
    (orders_something(&out) || orders_pointed(&out)).then_some(out)
}

/// "the client asked us to": one past it.
fn someone_wants(rest: &[Token]) -> Option<usize> {
    let the = usize::from(is(
        rest.first(),
        &["the", "my", "our", "a", "your", "his", "her", "this"],
    ));
    let who = leads(&rest[the..], WHO)?;
    let wants = leads(&rest[the + who..], WANTS)?;
    Some(the + who + wants)
}

/// "for the next test,": one past the comma.
fn step(rest: &[Token]) -> Option<usize> {
    let comma = rest.iter().take(7).position(|t| t.kind == TokenKind::Comma)?;
    (is(rest.first(), FOR) && comma > 1 && is(rest.get(comma - 1), STEPS)).then_some(comma + 1)
}

/// Where what is only said for courtesy at the end begins.
fn without_tail(body: &[Token]) -> usize {
    const TAILS: &[&str] = &[
        "would you",
        "could you",
        "will you",
        "can you",
        "wont you",
        "please",
        "pls",
        "thanks",
        "thank you",
        "thx",
        "cheers",
        "thats all",
        "that is all",
        "ok",
        "okay",
        "right",
        "if you can",
        "if you could",
        "if you would",
        "if possible",
        "thank you very much",
        "many thanks",
        "thats it",
        "that is it",
        "will ya",
        "mate",
        "thanks a lot",
        "for me",
        "for me please",
        "if thats ok",
        "if you like",
        "if you dont mind",
        "asap",
        "for now",
    ];
    (1..body.len())
        .find(|i| {
            body[*i].kind == TokenKind::Comma
                && leads(&body[i + 1..], TAILS).is_some_and(|n| i + 1 + n == body.len())
        })
        .unwrap_or(body.len())
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
        ] {
            assert_eq!(said(wrapped), "remove the bus");
        }
        for plain in ["we see a bus", "the bus should go", "for the bus, wait"] {
            assert_eq!(said(plain), plain.replace(",", " ,").to_lowercase());
        }
    }
}
