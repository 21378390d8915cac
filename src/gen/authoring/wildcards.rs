//! Wildcards in a prompt: `{car|bus|truck}` is one of these words, `{2-5}` one of these numbers. A seed selects which.

use numeric::splitmix::Draw;

/// Largest number of a range; a prompt never needs more objects.
const MOST: u32 = 999;

/// The text with each wildcard drawn. The rest stays as it is, so a text without wildcards is unchanged. The same text
/// and seed give the same result.
pub fn drawn(text: &str, seed: u64) -> String {
    let mut draw = Draw::new(seed, "wildcards");
    let mut out = String::with_capacity(text.len());
    let mut rest = text;
    while let Some(open) = rest.find('{') {
        let (before, from) = rest.split_at(open);
        out.push_str(before);
        let inside = &from[1..];
        match inside
            .find(['{', '}'])
            .filter(|at| inside[*at..].starts_with('}'))
        {
            Some(close) => {
                match one_of(&inside[..close], &mut draw) {
                    Some(one) => out.push_str(&one),
                    None => out.push_str(&from[..close + 2]),
                }
                rest = &inside[close + 1..];
            }
            None => {
                out.push('{');
                rest = inside;
            }
        }
    }
    out.push_str(rest);
    out
}

/// One of the choices between the braces; `None` if that is not a wildcard.
fn one_of(inside: &str, draw: &mut Draw) -> Option<String> {
    if inside.contains('|') {
        let words: Vec<&str> = inside.split('|').map(str::trim).collect();
        return Some(words[draw.below(words.len())].to_owned());
    }
    let (low, high) = inside.split_once('-')?;
    let number = |text: &str| text.trim().parse::<u32>().ok().filter(|n| *n <= MOST);
    let (low, high) = (number(low)?, number(high)?);
    let (low, high) = (low.min(high), low.max(high));
    Some((low + draw.below((high - low + 1) as usize) as u32).to_string())
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::BTreeSet;

    #[test]
    fn one_is_drawn_by_the_seed() {
        let text = "{2-5} {red|blue} {car|bus|truck}s ahead";
        let all: BTreeSet<String> = (0..400).map(|seed| drawn(text, seed)).collect();
        // Four numbers, two colours, three kinds: each comes up.
        assert_eq!(all.len(), 24);
        assert!(all.contains("2 red cars ahead") && all.contains("5 blue trucks ahead"));
        assert_eq!(drawn(text, 7), drawn(text, 7));
        // Each wildcard is a draw of its own.
        let twice: BTreeSet<String> = (0..50).map(|seed| drawn("{a|b}{a|b}", seed)).collect();
        assert_eq!(twice.len(), 4);
        assert_eq!(
            drawn("{9-9} cones, {a car|}", 1).split(',').next(),
            Some("9 cones")
        );
    }

    #[test]
    fn what_is_no_wildcard_stays() {
        for text in [
            "",
            "two cars",
            "{",
            "}{",
            "{car}",
            "{2-}",
            "{-3}",
            "{1-100000}",
            "a { b",
            "{a{b}",
            "{Straße–ü}",
        ] {
            assert_eq!(drawn(text, 3), text);
        }
        let half = drawn("{a {x|y} b", 3);
        assert!(half == "{a x b" || half == "{a y b", "{half}");
    }
}
