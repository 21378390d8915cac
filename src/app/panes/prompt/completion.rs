//! Completions of the word at the caret, offered by the prompt field while the user types.

use std::ops::Range;

/// Fewest letters for which completions are offered; fewer match too many words.
const LEAST_LETTERS: usize = 3;
/// Most completions at once.
const MOST: usize = 4;

const WORDS: [&str; 61] = [
    "ahead",
    "approaching",
    "barriers",
    "behind me",
    "bicycle",
    "blocking my lane",
    "bus",
    "buses",
    "busy",
    "cars",
    "clear",
    "cones",
    "construction vehicle",
    "crossing the road",
    "crossroads",
    "cyclist",
    "dawn",
    "delivery van",
    "dusk",
    "excavator",
    "facing me",
    "foggy",
    "following me",
    "heavy rain",
    "highway",
    "in front of me",
    "in my lane",
    "in the oncoming lane",
    "intersection",
    "motorcycle",
    "moving",
    "nearest",
    "next to",
    "night",
    "on the left",
    "on the right",
    "on the sidewalk",
    "oncoming",
    "parked",
    "parked cars",
    "parking lot",
    "pedestrians",
    "people",
    "rain",
    "remove",
    "replace",
    "residential street",
    "roadworks",
    "roundabout",
    "snow",
    "straight road",
    "suburban street",
    "t-junction",
    "taxi",
    "traffic cones",
    "trailer",
    "truck",
    "turn",
    "vans",
    "waiting at the crossing",
    "without",
];

/// The word that ends at the caret, and its completions.
#[derive(Clone, Debug, PartialEq)]
pub struct Completion {
    /// Byte range of the word in the text.
    pub word: Range<usize>,
    /// The completions, the best first.
    pub ends: Vec<&'static str>,
}

impl Completion {
    /// The completions at a caret, given in characters; `None` inside a word, or if no known word begins so.
    pub fn at(text: &str, caret: usize) -> Option<Self> {
        let end = byte_of(text, caret);
        let (before, after) = text.split_at(end);
        if after.chars().next().is_some_and(char::is_alphanumeric) {
            return None;
        }
        let start = before.rfind([' ', ',', '\n', '.']).map_or(0, |at| at + 1);
        let begun = before[start..].to_lowercase();
        if begun.chars().count() < LEAST_LETTERS {
            return None;
        }
        let words = WORDS.iter().copied();
        let ends: Vec<_> = words
            .filter(|w| w.starts_with(&begun) && *w != begun)
            .take(MOST)
            .collect();
        (!ends.is_empty()).then_some(Self {
            word: start..end,
            ends,
        })
    }

    /// Replaces the word by a completion with a space behind it. Returns the new caret, in characters.
    pub fn take(&self, text: &mut String, end: &str) -> usize {
        let spaced = text[self.word.end..].starts_with(' ');
        text.replace_range(self.word.clone(), end);
        let at = self.word.start + end.len();
        if !spaced {
            text.insert(at, ' ');
        }
        text[..=at].chars().count()
    }
}

/// The byte at which a character begins; the end of the text for larger indices.
fn byte_of(text: &str, character: usize) -> usize {
    text.char_indices()
        .nth(character)
        .map_or(text.len(), |(byte, _)| byte)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_word_at_the_caret_is_completed() {
        let mut text = "größe: two par, a bus".to_owned();
        let found = Completion::at(&text, 14).expect("par begins words");
        assert_eq!(found.ends, ["parked", "parked cars", "parking lot"]);
        assert_eq!(found.take(&mut text, "parking lot"), 23);
        assert_eq!(text, "größe: two parking lot , a bus");
        let mut text = "two par ahead".to_owned();
        let found = Completion::at(&text, 7).expect("par begins words");
        assert_eq!(found.take(&mut text, "parked"), 11);
        assert_eq!(text, "two parked ahead");
    }

    #[test]
    fn nothing_is_offered_inside_a_word_or_for_a_whole_one() {
        assert_eq!(Completion::at("parked", 3), None);
        assert_eq!(Completion::at("ab", 2), None);
        assert_eq!(Completion::at("people", 6), None);
        assert_eq!(Completion::at("", 99), None);
    }
}
