//! Phrases of place that are made of parts: adverbs before relations, the sides of the ego vehicle, hours of the clock.

use crate::scene::graph::RelationKind as R;

/// Adverbs that leave a relation as it is: "just behind", "a little to the left".
pub const ADVERBS: &str = "just|right|directly|immediately|straight|close|shortly|slightly|a little|a bit|a little way|a short way|some way|some distance|a short distance|somewhere|a few steps|a few paces|dead|up|off|over|out|well|diagonally|obliquely|way|not far|a touch|a tad|just off|right up|straight up|squarely|exactly|almost|nearly|half|partly|partially|tight|tucked in|tucked|hard|smack|only just";

/// How many rows of the tables of relations say where something is: adverbs go with those alone.
pub const PLACED: usize = 8;

const LEFT: &[R] = &[R::LeftOf];
const RIGHT: &[R] = &[R::RightOf];

/// "on my left", "over to our right hand side", "along the left flank".
pub fn sides() -> Vec<(&'static [R], String)> {
    let mut out = Vec::new();
    for (side, relation) in [("left", LEFT), ("right", RIGHT)] {
        for prep in [
            "on",
            "to",
            "at",
            "from",
            "along",
            "down",
            "off to",
            "over on",
            "out on",
            "out to",
            "over to",
            "up on",
            "towards",
            "toward",
            "by",
            "off on",
            "away to",
            "in from",
            "coming from",
            "coming in from",
            "out of",
            "further to",
            "somewhere on",
            "somewhere to",
            "round to",
            "around to",
        ] {
            for whose in [
                "the",
                "my",
                "our",
                "your",
                "the drivers",
                "the egos",
                "the ego vehicles",
                "the ego cars",
                "my own",
                "ones",
            ] {
                for tail in [
                    "",
                    " side",
                    " hand side",
                    " flank",
                    " hand",
                    " of me",
                    " of us",
                    " of the ego",
                    " of the ego vehicle",
                    " of my car",
                    " of our car",
                    " of my vehicle",
                ] {
                    out.push((relation, format!("{prep} {whose} {side}{tail}")));
                }
            }
        }
    }
    for (place, relation) in [
        ("drivers side", LEFT),
        ("driver side", LEFT),
        ("drivers hand", LEFT),
        ("passenger side", RIGHT),
        ("passengers side", RIGHT),
        ("passengers hand", RIGHT),
    ] {
        for prep in ["on", "to", "at", "from"] {
            out.push((relation, format!("{prep} the {place}")));
            out.push((relation, format!("{prep} my {place}")));
        }
    }
    out
}

/// "on its left", "to their right".
pub fn possessed() -> Vec<(R, String)> {
    let mut out = Vec::new();
    for prep in ["on", "to", "at", "along", "off to", "over on", "just to", "by"] {
        for whose in ["its", "his", "her", "their"] {
            for (side, relation) in [("left", R::LeftOf), ("right", R::RightOf)] {
                for tail in ["", " side", " hand side", " flank", " hand"] {
                    out.push((relation, format!("{prep} {whose} {side}{tail}")));
                }
            }
            for (end, relation) in [
                ("rear", R::Behind),
                ("back", R::Behind),
                ("tail", R::Behind),
                ("heels", R::Behind),
                ("bumper", R::Behind),
                ("wake", R::Behind),
                ("front", R::InFrontOf),
                ("side", R::NextTo),
            ] {
                out.push((relation, format!("{prep} {whose} {end}")));
            }
        }
    }
    for (whose, relation) in [
        ("in its wake", R::Behind),
        ("hot on its heels", R::Behind),
        ("close on its heels", R::Behind),
        ("in their wake", R::Behind),
        ("by its side", R::NextTo),
        ("in its path", R::InFrontOf),
        ("in its way", R::InFrontOf),
        ("in his way", R::InFrontOf),
    ] {
        out.push((relation, whose.to_string()));
    }
    out
}

/// The hours in words.
pub const HOURS: [&str; 12] = [
    "one", "two", "three", "four", "five", "six", "seven", "eight", "nine", "ten", "eleven", "twelve",
];

/// Which way an hour of the clock lies, from 1 to 12.
pub fn hour(n: u32) -> &'static [R] {
    match n {
        1 | 2 => &[R::InFrontOf, R::RightOf],
        3 => RIGHT,
        4 | 5 => &[R::Behind, R::RightOf],
        6 => &[R::Behind],
        7 | 8 => &[R::Behind, R::LeftOf],
        9 => LEFT,
        10 | 11 => &[R::InFrontOf, R::LeftOf],
        _ => &[R::InFrontOf],
    }
}

/// "at my three oclock", "in the nine oclock position".
pub fn clock() -> Vec<(&'static [R], String)> {
    let mut out = Vec::new();
    for (n, name) in (1..).zip(HOURS) {
        for lead in ["at my", "at our", "on my", "my", "our", "to my"] {
            out.push((hour(n), format!("{lead} {name} oclock")));
        }
        for lead in ["at the", "in the", "at", "in", "at my"] {
            out.push((hour(n), format!("{lead} {name} oclock position")));
            out.push((hour(n), format!("{lead} {name} oclock direction")));
        }
    }
    out
}
