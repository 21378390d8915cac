//! Changes to one phrase of a prompt that a chip asks for, made in the words: what stands there is what holds.

use crate::generation::text;
use crate::generation::text::description::{Became, Phrase};
use crate::generation::text::lexicon::{Sense, look_up, plural};

/// The prompt without a phrase, and without the comma that stood beside it.
pub fn without(prompt: &str, phrase: &Phrase) -> String {
    let Some(at) = prompt.find(&phrase.text) else {
        return prompt.to_owned();
    };
    let (before, after) = (&prompt[..at], &prompt[at + phrase.text.len()..]);
    let (before, after) = (before.trim_end(), after.trim_start());
    let after = if before.is_empty() || before.ends_with(',') {
        after.trim_start_matches(',').trim_start()
    } else {
        after
    };
    let joint = if before.is_empty() || after.is_empty() || after.starts_with(',') {
        ""
    } else {
        " "
    };
    format!("{before}{joint}{after}").trim_end_matches(',').to_owned()
}

/// The prompt with another number of the objects of a phrase, whose noun is given; none if the words would not be
/// understood so.
pub fn with_number(prompt: &str, phrase: &Phrase, noun: &str, n: u32) -> Option<String> {
    let at = prompt.find(&phrase.text)?;
    let words: Vec<&str> = phrase.text.split_whitespace().collect();
    let is_number = |w: &str| {
        let w = w.to_lowercase();
        w.parse::<f64>().is_ok() || matches!(look_up(&w), Some(Sense::Count(_) | Sense::Article(_)))
    };
    // "a couple of", "half a dozen": all that counts, and the "of" behind it.
    let mut begins = words.iter().take_while(|w| is_number(w)).count();
    if begins > 0 && words.get(begins) == Some(&"of") {
        begins += 1;
    }
    let number = match n {
        0 => "no".to_owned(),
        1 => "one".to_owned(),
        n => n.to_string(),
    };
    let rest = words[begins..].iter().map(|w| match *w == noun {
        true if n == 1 => singular(noun),
        true => plural_of(noun),
        false => (*w).to_owned(),
    });
    let said: Vec<String> = std::iter::once(number).chain(rest).collect();
    let after = &prompt[at + phrase.text.len()..];
    let new = format!("{}{}{after}", &prompt[..at], said.join(" "));
    let reading = text::read(&new).description;
    let counts = |k: usize| reading.foreground.get(k).map_or(0, |o| o.count.n);
    match phrase.became {
        Became::Object(k) if counts(k) == n || n == 0 => Some(new),
        _ => None,
    }
}

fn plural_of(noun: &str) -> String {
    match look_up(noun) {
        Some(Sense::Noun(_, true)) => noun.to_owned(),
        _ => plural(noun),
    }
}

fn singular(noun: &str) -> String {
    if let Some(Sense::Noun(_, false)) = look_up(noun) {
        return noun.to_owned();
    }
    let stems = ["s", "es"]
        .iter()
        .filter_map(|end| noun.strip_suffix(end).map(str::to_owned));
    let stems = stems.chain(noun.strip_suffix("ies").map(|stem| format!("{stem}y")));
    let mut known = stems.filter(|stem| matches!(look_up(stem), Some(Sense::Noun(_, false))));
    known.next().unwrap_or_else(|| noun.to_owned())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_number_is_changed_in_the_words() {
        for (prompt, object, n, expected) in [
            ("two parked cars, a bus ahead", 0, 4, "4 parked cars, a bus ahead"),
            (
                "two parked cars, a bus ahead",
                1,
                3,
                "two parked cars, 3 buses ahead",
            ),
            ("two parked cars", 0, 1, "one parked car"),
            ("a couple of lorries at night", 0, 5, "5 lorries at night"),
            ("rain, a bus", 0, 0, "rain, no buses"),
        ] {
            let reading = text::read(prompt);
            let phrase = reading
                .phrases
                .iter()
                .find(|p| p.became == Became::Object(object))
                .expect("a chip");
            let noun = &reading.description.foreground[object].noun;
            assert_eq!(with_number(prompt, phrase, noun, n).as_deref(), Some(expected));
        }
    }

    #[test]
    fn a_phrase_leaves_with_its_comma() {
        let prompt = "two cars, at night, in the rain";
        let reading = text::read(prompt);
        for (take, left) in [
            ("night", "two cars, in the rain"),
            ("rain", "two cars, at night"),
            ("two cars", "at night, in the rain"),
        ] {
            let phrase = reading
                .phrases
                .iter()
                .find(|p| p.text.contains(take))
                .expect(take);
            let rest = without(prompt, phrase);
            let reading = text::read(&rest);
            assert!(!reading.phrases.iter().any(|p| p.text.contains(take)), "{rest}");
            let same = text::read(left).description;
            assert_eq!(reading.description, same, "{rest} for {left}");
        }
    }
}
