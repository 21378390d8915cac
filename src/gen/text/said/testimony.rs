//! Findings and reports: "it has been established that the car came from the right", "at the material time the van had already
//! moved into our lane". What is found holds; a past before the past is what was so then.

use super::super::tokens::{Token, TokenKind};
use super::super::wording::rewritten;
use super::words::{is, leads, led, text, word};

const THEN: &[&str] = &[
    "at the material time",
    "at the relevant time",
    "at the relevant moment",
    "at the decisive moment",
    "at the critical moment",
    "at the time in question",
    "at the moment in question",
    "at that time",
    "at the time",
    "at that moment",
    "at this moment",
    "at that instant",
    "at that point",
    "at that stage",
    "by then",
    "by that time",
    "by this time",
    "by that moment",
    "by that point",
    "at the time of the accident",
    "at the time of the collision",
    "at the time of the crash",
    "at the time of the incident",
    "at the moment of impact",
    "at the time of impact",
    "prior to the collision",
    "prior to the accident",
    "shortly before the accident",
    "shortly before the collision",
    "shortly before the crash",
    "just before the accident",
    "just before the crash",
    "in the meantime",
    "by the time of the accident",
    "by the time of the collision",
];
const BE: &[&str] = &[
    "is",
    "was",
    "has been",
    "had been",
    "has since been",
    "has now been",
    "has meanwhile been",
    "has already been",
    "could be",
    "can be",
    "has also been",
    "was also",
    "is also",
    "was later",
    "was then",
];
const FOUND: &[&str] = &[
    "established",
    "found",
    "undisputed",
    "not disputed",
    "not in dispute",
    "uncontested",
    "proven",
    "proved",
    "shown",
    "confirmed",
    "agreed",
    "determined",
    "ascertained",
    "noted",
    "accepted",
    "beyond doubt",
    "beyond dispute",
    "common ground",
    "settled",
    "recorded",
    "documented",
    "reported",
    "stated",
    "observed",
    "verified",
    "known",
    "certain",
    "clear",
    "evident",
    "a fact",
    "discovered",
    "concluded",
    "decided",
    "on record",
];

/// A sentence without such a frame, in a tense that is read.
pub fn plain(tokens: Vec<Token>) -> Vec<Token> {
    let out = rewritten(&tokens, |i, out| {
        let found = found_that(&tokens, i)
            .or_else(|| shown_that(&tokens, i))
            .or_else(|| have_it(&tokens, i))
            .or_else(|| in_report(&tokens, i));
        let Some(end) = found else {
            return then(&tokens, i);
        };
        // (what was there by the findings is what shall be there)
        if leads(&tokens[end..], &["there was", "there were"]).is_some() {
            out.extend(led("there should be", &tokens[end], &[]));
            return Some(end + 2);
        }
        Some(end)
    });
    pluperfect(&out)
}

fn opens(tokens: &[Token], i: usize) -> bool {
    i == 0 || tokens[i - 1].kind != TokenKind::Word || is(tokens.get(i - 1), &["and", "but", "that", "as"])
}

/// "it has been established that": one past it.
fn found_that(tokens: &[Token], i: usize) -> Option<usize> {
    let it = opens(tokens, i) && is(tokens.get(i), &["it"]);
    let be = it.then(|| leads(&tokens[i + 1..], BE))??;
    let mut k = i + 1 + be;
    while is(
        tokens.get(k),
        &[
            "now",
            "also",
            "since",
            "further",
            "clearly",
            "firmly",
            "generally",
            "meanwhile",
            "later",
        ],
    ) {
        k += 1;
    }
    k += leads(&tokens[k..], FOUND)?;
    let more = is(
        tokens.get(k + 1),
        &[
            "the", "a", "an", "all", "both", "there", "no", "my", "our", "one", "two",
        ],
    );
    (is(tokens.get(k), &["that"]) && more).then_some(k + 1)
}

/// "in my report the cyclist was ...", "according to our notes ...": one past it.
fn in_report(tokens: &[Token], i: usize) -> Option<usize> {
    const PAPERS: &[&str] = &[
        "report",
        "notes",
        "statement",
        "file",
        "log",
        "protocol",
        "drawing",
        "sketch",
        "record",
        "records",
        "diary",
        "notebook",
        "minutes",
        "plan",
        "brief",
        "specification",
        "spec",
        "photo",
        "photos",
        "footage",
        "recording",
        "video",
        "testimony",
        "description",
        "account",
        "memory",
        "paper",
        "papers",
        "documents",
        "document",
        "documentation",
        "table",
        "sheet",
        "email",
        "case file",
        "logbook",
        "tyre marks",
        "tire marks",
        "skid marks",
        "marks",
        "traces",
        "tracks",
        "debris",
        "damage",
        "scratches",
        "reconstruction",
        "original",
        "version",
        "script",
        "storyboard",
        "files",
    ];
    const BY: &[&str] = &[
        "in",
        "on",
        "according to",
        "per",
        "as per",
        "going by",
        "judging by",
        "by",
        "to go by",
        "from",
        "following",
        "as stated in",
        "as written in",
        "in accordance with",
    ];
    let mut k = i + leads(&tokens[i..], BY).filter(|_| opens(tokens, i))?;
    is(
        tokens.get(k),
        &["my", "our", "the", "his", "her", "their", "that", "this", "your"],
    )
    .then_some(())?;
    k += 1;
    let which = [
        "first", "original", "old", "written", "police", "accident", "official", "own", "earlier", "test",
        "witness",
    ];
    k += usize::from(is(tokens.get(k), &which));
    k += leads(&tokens[k..], PAPERS)?;
    k += leads(
        &tokens[k..],
        &[
            "of the accident",
            "of the crash",
            "of the incident",
            "of the officer",
            "of the witness",
        ],
    )
    .unwrap_or(0);
    k += usize::from(tokens.get(k).is_some_and(|t| t.kind == TokenKind::Comma));
    let named = is(
        tokens.get(k),
        &[
            "the", "a", "an", "all", "both", "there", "no", "that", "two", "three", "four", "one",
        ],
    );
    named.then_some(k)
}

/// "the investigation has shown that": one past it.
fn shown_that(tokens: &[Token], i: usize) -> Option<usize> {
    const WHAT: &[&str] = &[
        "investigation",
        "investigations",
        "inquiry",
        "enquiry",
        "reconstruction",
        "analysis",
        "evidence",
        "footage",
        "video",
        "dashcam",
        "recording",
        "recordings",
        "photo",
        "photos",
        "photograph",
        "photographs",
        "report",
        "file",
        "log",
        "measurement",
        "measurements",
        "consultation",
        "poll",
        "study",
        "workshop",
        "meeting",
        "data",
        "court",
        "hearing",
        "expert",
        "experts",
        "police",
        "survey",
        "traces",
        "marks",
        "statement",
        "statements",
        "testimony",
        "protocol",
        "review",
    ];
    const SHOWS: &[&str] = &[
        "shows",
        "show",
        "showed",
        "shown",
        "finds",
        "found",
        "established",
        "confirms",
        "confirm",
        "confirmed",
        "reveals",
        "reveal",
        "revealed",
        "proves",
        "prove",
        "proved",
        "proven",
        "indicates",
        "indicate",
        "indicated",
        "suggests",
        "suggested",
        "concluded",
        "determined",
        "states",
        "stated",
        "says",
        "said",
        "demonstrates",
        "demonstrated",
    ];
    let mut k = i + usize::from(is(tokens.get(i), &["the", "our", "all", "later", "subsequent"]));
    k += usize::from(
        is(
            tokens.get(k),
            &[
                "police",
                "dashcam",
                "later",
                "new",
                "technical",
                "witness",
                "court",
            ],
        ) && is(tokens.get(k + 1), WHAT),
    );
    let what = opens(tokens, i) && is(tokens.get(k), WHAT);
    what.then_some(())?;
    k += 1;
    while is(
        tokens.get(k),
        &[
            "has",
            "have",
            "had",
            "now",
            "since",
            "clearly",
            "also",
            "later",
            "meanwhile",
        ],
    ) {
        k += 1;
    }
    let that = is(tokens.get(k), SHOWS) && is(tokens.get(k + 1), &["that"]);
    let more = is(
        tokens.get(k + 2),
        &[
            "the",
            "a",
            "an",
            "all",
            "both",
            "there",
            "no",
            "my",
            "our",
            "one",
            "two",
            "three",
            "it",
            "residents",
            "people",
            "parents",
            "neighbours",
            "citizens",
            "locals",
            "customers",
        ],
    );
    (that && more).then_some(k + 2)
}

/// "I have it from the police that": one past it.
fn have_it(tokens: &[Token], i: usize) -> Option<usize> {
    let n = leads(
        &tokens[i..],
        &[
            "i have it",
            "we have it",
            "i have it on good authority",
            "i learned",
            "we learned",
            "i was told",
            "we were told",
            "i am told",
            "we are told",
        ],
    )
    .filter(|_| opens(tokens, i))?;
    let that = (i + n..tokens.len().min(i + n + 6)).find(|k| is(tokens.get(*k), &["that"]))?;
    let from = that == i + n || is(tokens.get(i + n), &["from", "by", "on"]);
    (from
        && is(
            tokens.get(that + 1),
            &["the", "a", "an", "all", "both", "there", "no", "two", "three"],
        ))
    .then_some(that + 1)
}

/// "at the material time,": when, of what is told in the past.
fn then(tokens: &[Token], i: usize) -> Option<usize> {
    let had = tokens[i..]
        .iter()
        .take_while(|t| t.kind != TokenKind::Stop)
        .any(|t| is(Some(t), &["had", "was", "were"]) || text(t).len() > 4 && text(t).ends_with("ed"));
    let n = (had && (opens(tokens, i) || is(tokens.get(i - 1), &["had"])))
        .then(|| leads(&tokens[i..], THEN))??;
    let end = i + n + usize::from(tokens.get(i + n).is_some_and(|t| t.kind == TokenKind::Comma));
    tokens
        .get(end)
        .is_some_and(|t| t.kind == TokenKind::Word)
        .then_some(end)
}

/// "had already moved", "had by then moved": has moved.
fn pluperfect(tokens: &[Token]) -> Vec<Token> {
    rewritten(tokens, |i, out| {
        is(tokens.get(i), &["had"]).then_some(())?;
        let mut k = i + 1;
        while is(
            tokens.get(k),
            &[
                "already",
                "just",
                "since",
                "previously",
                "meanwhile",
                "long",
                "now",
                "long",
                "all",
                "both",
            ],
        ) {
            k += 1;
        }
        let verb = tokens.get(k)?;
        let participle = text(verb).len() > 3 && text(verb).ends_with("ed")
            || is(
                Some(verb),
                &[
                    "gone",
                    "left",
                    "driven",
                    "ridden",
                    "come",
                    "got",
                    "gotten",
                    "stood",
                    "been",
                    "run",
                    "begun",
                    "become",
                    "pulled",
                    "put",
                    "swung",
                    "cut",
                    "made",
                    "taken",
                    "overtaken",
                    "fallen",
                    "sat",
                    "set",
                    "spun",
                    "slid",
                ],
            );
        // ("if we had turned it", "I had put it there" are wishes and words of the speaker)
        let spoken = is(out.last(), &["i", "we", "you", "they", "if"])
            || out
                .iter()
                .any(|t| is(Some(t), &["if", "wish", "rather", "better"]));
        if !participle || spoken || i == 0 || is(tokens.get(k + 1), &["to"]) && text(verb) == "been" {
            return None;
        }
        let many = text(&tokens[i - 1]).ends_with('s') && !is(tokens.get(i - 1), &["bus"])
            || is(
                tokens.get(i - 1),
                &["people", "men", "women", "children", "police"],
            );
        out.push(word(if many { "have" } else { "has" }, &tokens[i]));
        Some(k)
    })
}
