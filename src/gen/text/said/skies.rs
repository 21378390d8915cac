//! Weather and light as edits speak of them: "lift the fog", "broad daylight rather than this darkness".

use super::super::lexicon::{Sense, look_up};
use super::super::tokens::Token;
use super::super::wording::replaced;
use super::words::{find, is, leads, led, text};

const ENDS: &[&str] = &[
    "lift",
    "lose",
    "drop",
    "disperse",
    "stop",
    "end",
    "dispel",
    "get rid of",
    "take away",
    "do away with",
    "let up",
    "clear",
    "clear away",
    "blow away",
    "switch off",
    "turn off",
    "remove",
];
const SKIES: &[&str] = &[
    "fog",
    "mist",
    "rain",
    "snow",
    "haze",
    "storm",
    "sandstorm",
    "drizzle",
    "snowfall",
    "rainfall",
    "downpour",
    "clouds",
    "murk",
];

/// What weather does that ends.
const BLOWS_OVER: &[&str] = &[
    "dies down",
    "dies away",
    "died down",
    "died away",
    "die down",
    "die away",
    "blows over",
    "blown over",
    "blew over",
    "blow over",
    "blows itself out",
    "blown itself out",
    "lets up",
    "let up",
    "passes over",
    "passed over",
    "passes by",
    "passed by",
    "moves on",
    "moved on",
    "moves off",
    "moved off",
    "clears up",
    "cleared up",
    "eases off",
    "eased off",
    "ebbs away",
    "ebbed away",
    "peters out",
    "petered out",
    "fades away",
    "faded away",
    "calms down",
    "calmed down",
    "settles down",
    "burns off",
    "burnt off",
    "burned off",
    "dries up",
    "draws off",
    "has had its day",
];

const CLOUDLESS: &str = "not a cloud in the sky|not a single cloud in the sky|not one cloud in the sky|without a cloud in the sky|without a single cloud in the sky|no cloud in the sky|no clouds in the sky|not a cloud|without clouds|without a cloud|no clouds|cloudless sky|a cloudless sky";
const SUN: &str = "have the sun out|the sun out|the sun comes out|the sun has come out|let the sun come out|let the sun shine|bring out the sun|bring the sun out|the sun should shine|the sun shines again|get the sun out";
const SUNSET: &str = "let the sun set|the sun sets|the sun is setting|the sun goes down|the sun is going down|the sun should set|let the sun go down";
const CLOUDED: &str = "cover the sky with clouds|cover the sky in clouds|fill the sky with clouds|clouds cover the sky|clouds fill the sky|clouds covering the sky|cloud the sky over|a sky full of clouds|the sky is full of clouds|let clouds gather|let clouds cover the sky|the sky clouds over|the sky has clouded over";
const BLUE: &str = "sky : blue|sky : clear|sky : cloudless|sky blue|skies blue|clear blue sky|a clear blue sky|clear blue skies|sky : sunny|weather : fine|weather : good|the fog thins out|the fog thins|fog thins out|the fog has thinned out|the fog is thinning|the mist thins out|the mist has thinned out|fog out|rain out";
const SET: &str = "set the time of day to|set the time to|change the time of day to|change the time to|switch the time to|move the time to|put the time at|turn the clock to|set the clock to|set the weather to|change the weather to|switch the weather to|turn the weather to|set the lighting to|change the lighting to|set the light to|change the light to|darken everything to|darken the scene to|darken the whole scene to|plunge everything into|plunge the scene into|brighten everything to|brighten the scene to|turn everything to|turn everything into|turn the scene into|bathe everything in|bathe the scene in|drown everything in|wrap everything in|wrap the scene in|cover everything in|shroud everything in|shroud the scene in";

/// "the sun has burnt off the fog", "the wind has blown the rain away": clear.
fn dispelled(tokens: Vec<Token>) -> Vec<Token> {
    const DONE: &[&str] = &[
        "burnt off",
        "burned off",
        "burns off",
        "blown away",
        "blows away",
        "blew away",
        "dispelled",
        "dispels",
        "dispersed",
        "disperses",
        "driven off",
        "driven away",
        "drives away",
        "swept away",
        "sweeps away",
        "broken through",
        "breaks through",
        "blown",
        "blows",
        "burnt",
        "burned",
        "chased away",
        "chases away",
        "driven out",
        "beaten",
        "eaten up",
        "melted away",
    ];
    let found = (1..tokens.len()).find_map(|i| {
        let n = leads(&tokens[i..], DONE)?;
        let the = i + n + usize::from(is(tokens.get(i + n), &["the", "this", "that", "all"]));
        is(tokens.get(the), SKIES).then_some(())?;
        let end = the + 1 + usize::from(is(tokens.get(the + 1), &["away", "off"]));
        let lead = &tokens[..i];
        let by = lead.len() < 6
            && lead.iter().any(|t| {
                is(
                    Some(t),
                    &["sun", "wind", "breeze", "sunshine", "warmth", "storm", "heat"],
                )
            });
        by.then_some(end)
    });
    match found {
        Some(end) => [&led("clear weather", &tokens[0], &[])[..], &tokens[end..]].concat(),
        None => tokens,
    }
}

/// "fog where there was rain": fog.
fn where_was(tokens: Vec<Token>) -> Vec<Token> {
    let mut out = tokens;
    let found = (0..out.len()).find_map(|i| {
        is_style(&out[i]).then_some(())?;
        let n = leads(
            &out[i + 1..],
            &[
                "where there was",
                "where there is",
                "where there had been",
                "where we had",
                "where we have",
                "where it was",
                "where it is",
                "where before there was",
                "where once there was",
            ],
        )?;
        let the = i + 1 + n + usize::from(is(out.get(i + 1 + n), &["the", "this", "only"]));
        out.get(the).is_some_and(is_style).then_some((i, the))
    });
    if let Some((i, old)) = found {
        out.drain(i + 1..=old);
        return where_was(out);
    }
    out
}

/// "fog replaces the rain": fog.
fn taken_over(tokens: Vec<Token>) -> Vec<Token> {
    const OVER: &[&str] = &[
        "replaces",
        "replace",
        "takes over from",
        "takes the place of",
        "has replaced",
        "should replace",
        "is to replace",
        "supersedes",
        "drives out",
        "drives away",
        "displaces",
        "must replace",
        "shall replace",
        "instead of",
        "follows",
    ];
    let found = (0..tokens.len()).find_map(|i| {
        is_style(&tokens[i]).then_some(())?;
        let n = leads(&tokens[i + 1..], OVER)?;
        let the = i + 1 + n + usize::from(is(tokens.get(i + 1 + n), &["the", "this", "that"]));
        tokens.get(the).is_some_and(is_style).then_some((i, the))
    });
    match found {
        Some((i, old)) => [&tokens[..=i], &tokens[old + 1..]].concat(),
        None => tokens,
    }
}

fn is_style(t: &Token) -> bool {
    matches!(look_up(text(t)), Some(Sense::Weather(_) | Sense::Time(_)))
}

/// The sentence with its weather in plain words.
pub fn plain(tokens: &[Token]) -> Vec<Token> {
    let mut out = replaced(tokens, CLOUDLESS, "clear weather");
    out = replaced(&out, SUN, "clear weather");
    out = replaced(&out, SUNSET, "make it dusk");
    out = dispelled(replaced(&out, BLUE, "clear weather"));
    out = where_was(out);
    out = replaced(&out, CLOUDED, "overcast weather");
    out = replaced(&out, SET, "make it");
    out = taken_over(out);
    if let Some((i, n)) = find(&out, ENDS) {
        let article = usize::from(is(out.get(i + n), &["the", "this", "that", "all"]));
        if is(out.get(i + n + article), SKIES) && (i == 0 || !is(out.get(i - 1), &["to", "not", "dont"])) {
            let mut clear = led("clear weather", &out[i], &[]);
            // "get rid of the snow and of the cones"
            let end = i + n + article + 1;
            let and = is(out.get(end), &["and"]);
            let of = usize::from(is(out.get(end + 1), &["of"]));
            let more = and && is(out.get(end + 1 + of), &["the", "all", "those", "these", "every"]);
            if more && super::words::has_noun(&out[end + 1..]) {
                clear.extend(led("and remove", &out[end], &[]));
                out.splice(i..end + 1 + of, clear);
            } else {
                out.splice(i..end, clear);
            }
        }
    }
    // "let the rain stop", "the fog should clear"
    let ended = (0..out.len()).find_map(|i| {
        is(out.get(i), SKIES).then_some(())?;
        let helpers = out[i + 1..]
            .iter()
            .take_while(|t| {
                is(
                    Some(t),
                    &[
                        "should", "must", "has", "to", "will", "can", "may", "is", "finally", "now",
                    ],
                )
            })
            .count();
        let verb = is(
            out.get(i + 1 + helpers),
            &[
                "stop",
                "stops",
                "end",
                "ends",
                "ended",
                "cease",
                "ceases",
                "lift",
                "lifts",
                "pass",
                "passes",
                "vanish",
                "vanishes",
                "disappear",
                "disappears",
                "disperse",
                "disperses",
                "go",
                "goes",
                "stopped",
                "lifted",
                "abates",
                "abated",
                "abate",
                "subsides",
                "subsided",
                "subside",
                "dissipates",
                "dissipated",
                "ceased",
                "passed",
                "vanished",
            ],
        ) || helpers > 0 && is(out.get(i + 1 + helpers), &["over", "gone"]);
        let over = leads(&out[i + 1 + helpers..], BLOWS_OVER).unwrap_or(0);
        let verb = verb || over > 0;
        let from = i - usize::from(i > 0 && is(out.get(i - 1), &["the", "this", "that"]));
        let lead = is(out.get(from.wrapping_sub(1)), &["let", "make", "have"]);
        verb.then_some((
            from - usize::from(lead && from > 0),
            i + 1 + helpers + over.max(1),
        ))
    });
    if let Some((from, end)) = ended {
        let away = usize::from(is(out.get(end), &["away"]));
        let clear = led("clear weather", &out[from], &[]);
        // ("and leaves a clear sky" says it again)
        let again = leads(
            &out[end + away..],
            &[
                "and leaves a clear sky",
                "and leaves clear skies",
                "and leaves behind a clear sky",
                "and leaves a blue sky",
                ", leaving a clear sky",
                ", leaving clear skies",
                "leaving a clear sky",
            ],
        )
        .unwrap_or(0);
        out.splice(from..end + away + again, clear);
    }
    // "instead of the fog let there be snow"
    if let Some(n) = leads(&out, &["instead of", "rather than", "in place of"]) {
        let article = usize::from(is(out.get(n), &["the", "this", "that"]));
        let end = n + article + 1;
        if out.get(n + article).is_some_and(is_style) && out[end..].iter().any(is_style) {
            let comma = out
                .get(end)
                .is_some_and(|t| t.kind == super::super::tokens::TokenKind::Comma);
            out.drain(..end + usize::from(comma));
        }
    }
    changed(unwanted(out))
}

/// "the snow has turned to rain", "change night to day": what it becomes.
fn changed(tokens: Vec<Token>) -> Vec<Token> {
    const CHANGE: &[&str] = &[
        "has",
        "have",
        "turned",
        "turns",
        "turn",
        "turning",
        "changed",
        "changes",
        "change",
        "is",
        "was",
        "being",
        "becomes",
        "became",
        "become",
        "becoming",
        "gives",
        "gave",
        "given",
        "way",
        "replaced",
        "into",
        "to",
        "by",
        "with",
        "for",
        "and",
        "yields",
        "yielded",
        "should",
        "must",
        "now",
        "the",
        "a",
        "swapped",
        "exchanged",
        "made",
        "goes",
        "went",
        "over",
    ];
    const INTO: &[&str] = &[
        "into", "to", "by", "with", "for", "becomes", "became", "become", "becoming",
    ];
    let cut = (0..tokens.len()).find_map(|i| {
        if !is_style(&tokens[i]) {
            return None;
        }
        let next = (i + 1..tokens.len().min(i + 8)).find(|k| is_style(&tokens[*k]))?;
        let between = &tokens[i + 1..next];
        let plain = between.iter().all(|t| is(Some(t), CHANGE));
        let swapped = tokens.iter().any(|t| {
            is(
                Some(t),
                &[
                    "replace",
                    "replaced",
                    "swap",
                    "swapped",
                    "exchange",
                    "exchanged",
                    "substitute",
                ],
            )
        });
        let into = between
            .iter()
            .any(|t| is(Some(t), INTO) && (swapped || !is(Some(t), &["by", "with", "for"])));
        // "from fog to snow" and "the fog to snow" alike
        let from = i - usize::from(i > 0 && is(tokens.get(i - 1), &["the", "this", "that", "from"]));
        (plain && into).then_some((from, next))
    });
    match cut {
        Some((from, next)) => {
            let lead = is(
                tokens.get(from.wrapping_sub(1)),
                &[
                    "change", "turn", "switch", "swap", "exchange", "replace", "make", "convert",
                ],
            );
            let start = if lead { from - 1 } else { from };
            [&tokens[..start], &tokens[next..]].concat()
        }
        None => tokens,
    }
}

/// "daylight instead of this darkness": the one that is wished for.
fn unwanted(tokens: Vec<Token>) -> Vec<Token> {
    let prefers = tokens
        .iter()
        .any(|t| matches!(text(t), "prefer" | "rather" | "like" | "want" | "better"));
    let cut = (1..tokens.len()).find_map(|i| {
        let n = leads(
            &tokens[i..],
            &["instead of", "rather than", "in place of", "and not", "not"],
        )
        .or_else(|| leads(&tokens[i..], &["to", "over", "than"]).filter(|_| prefers))?;
        let mut k = i + n;
        while is(tokens.get(k), &["the", "this", "that", "all", "a", "such"]) {
            k += 1;
        }
        (tokens.get(k).is_some_and(is_style) && tokens[..i].iter().any(is_style)).then_some((i, k + 1))
    });
    match cut {
        Some((i, end)) => [&tokens[..i], &tokens[end..]].concat(),
        None => tokens,
    }
}
