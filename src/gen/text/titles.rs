//! Titles of scenes and catalogue entries: "Occlusion test: ...", "Sandstorm warning test. ...", "VRU catalogue item: ...".
//! What a scene is called is not in it; what its title says of road, time and weather is.

use super::lexicon::{Sense, look_up};
use super::tokens::{Token, TokenKind};

const TITLES: &str = "test|case|scenario|scene|item|exercise|example|situation|drill|check|demo|task|entry|title|setup|recipe|variation|variant|question|lesson|clip|frame|experiment|trial|recording|sequence|snippet|story|report|notes|note|topic|subject|theme|manoeuvre|maneuver|validation|evaluation|catalogue|catalog|assessment|simulation|benchmark|actors|actor|participants|objects|entities|agents|preconditions|elements|contents|props|cast|players|parameters|setting|conditions|inventory";

fn is_title(t: &Token) -> bool {
    TITLES.split('|').any(|w| w == t.text)
}

/// A sentence without the title at its start.
pub fn without(sentence: &[Token]) -> Vec<Token> {
    const LONGEST: usize = 9;
    let end = sentence
        .iter()
        .take(LONGEST)
        .position(|t| t.kind == TokenKind::Stop || matches!(t.text.as_str(), ":" | "-"));
    let Some(end) = end.filter(|e| *e > 0) else {
        return sentence.to_vec();
    };
    let title = &sentence[..end];
    let colon = sentence[end].kind == TokenKind::Mark;
    // a sentence of its own is a title only if its last word says so
    let named = if colon {
        title.iter().any(is_title)
    } else {
        title.last().is_some_and(is_title)
    };
    let tells = title.iter().any(|t| {
        matches!(
            look_up(&t.text),
            Some(
                Sense::Count(_)
                    | Sense::Rel(_)
                    | Sense::EgoRel(_)
                    | Sense::State(_, true)
                    | Sense::Verb(_)
                    | Sense::Nobody
                    | Sense::Not
            )
        ) || matches!(t.kind, TokenKind::Comma)
            || matches!(
                t.text.as_str(),
                "is" | "are"
                    | "there"
                    | "with"
                    | "where"
                    | "has"
                    | "have"
                    | "i"
                    | "we"
                    | "no"
                    | "in"
                    | "on"
                    | "at"
                    | "ahead"
            )
    });
    let article = title.iter().any(|t| matches!(t.text.as_str(), "a" | "an")) && !colon;
    if !named || tells || article {
        return sentence.to_vec();
    }
    let said = title.iter().filter(|t| {
        matches!(
            look_up(&t.text),
            Some(
                Sense::Weather(_)
                    | Sense::Time(_)
                    | Sense::RoadKind(..)
                    | Sense::Place(_, Some(_))
                    | Sense::Environment(_)
            )
        )
    });
    let mut out: Vec<Token> = said.cloned().collect();
    if !out.is_empty() {
        out.push(Token {
            kind: TokenKind::Stop,
            text: ".".into(),
            span: sentence[end].span,
        });
    }
    out.extend_from_slice(&sentence[end + 1..]);
    out
}

#[cfg(test)]
mod tests {
    use super::super::tokens::tokens;
    use super::*;

    #[test]
    fn what_a_scene_is_called_is_not_in_it() {
        let said = |t: &str| {
            let list: Vec<String> = without(&tokens(t)).into_iter().map(|t| t.text).collect();
            list.join(" ")
        };
        assert_eq!(said("Occlusion test: a bus"), "a bus");
        assert_eq!(said("VRU catalogue item: cyclist ahead"), "cyclist ahead");
        assert_eq!(said("Sandstorm warning test."), "sandstorm .");
        assert_eq!(said("Edge case for the detector: a child"), "a child");
        assert_eq!(said("Ahead: a bus"), "ahead : a bus");
        assert_eq!(said("Two cars: one on the left"), "two cars : one on the left");
    }
}
