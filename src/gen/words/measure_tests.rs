//! Sentences with every kind of number in every place that takes one: no number becomes another quantity, and numbers
//! that are not carried out are reported.

use super::account::Why;
use super::hear::hear;
use super::measure::{Measure, MeasuredQuantity, measures};
use super::reader::{LearnedReader, Mode};
use super::slots::{SlotKind, slots};
use super::tokens::tokens;

/// Numbers that differ, so that each can be identified.
const UNITS: [&str; 22] = [
    "8 m",
    "27 feet",
    "1.2 km",
    "35 km/h",
    "22 mph",
    "9 m/s",
    "6 s",
    "14 seconds",
    "3 minutes",
    "700 ms",
    "3 m/s²",
    "0.4 g",
    "40 degrees",
    "35°",
    "60 %",
    "7 pm",
    "16:30",
    "4 storeys",
    "12 tons",
    "5 years",
    "25 m²",
    "30 Hz",
];

const PLACES: [(&str, bool); 20] = [
    ("a parked car {} ahead", true),
    ("a bus behind us, {}", true),
    ("a {} car on the left", true),
    ("a {} sign on the right", true),
    ("a car driving at {}", true),
    ("two pedestrians and a {} truck", true),
    ("the car brakes after {}", true),
    ("the scene lasts {}", true),
    ("add a car {} ahead of us", false),
    ("add a {} sign on the right", false),
    ("move the bus {} to the left", false),
    ("move the bus {} closer", false),
    ("let the car drive at {}", false),
    ("the car brakes at {}", false),
    ("the pedestrian crosses when we are {} away", false),
    ("turn the car {} to the left", false),
    ("the truck follows the bus at {}", false),
    ("make the trees {} taller", false),
    ("there should be {} cars", false),
    ("we drive {} faster than the bus", false),
];

/// Numbers of a text that are neither in its reading nor reported as missing.
fn unnamed(text: &str, mode: Mode) -> Vec<String> {
    let heard = hear(text, mode).expect("weights");
    let speller = LearnedReader::bundled().expect("weights");
    let tokens = tokens(text, Some(speller.speller()));
    let numbers = measures(&tokens);
    let held = slots(&heard.reading);
    let is_named = |m: &Measure| {
        let span = m.span(&tokens);
        let mut named = heard.missing.iter().map(|x| x.span);
        named.any(|s| s.start < span.end && s.end > span.start)
    };
    let mut out = Vec::new();
    for m in &numbers {
        let span = m.span(&tokens);
        // (counts, lengths and storeys in clauses on scenery belong to them)
        let beside = heard
            .reading
            .background
            .iter()
            .any(|s| s.span.is_some_and(|s| s.start <= span.start && s.end >= span.end));
        let own = matches!(
            m.kind,
            MeasuredQuantity::Count | MeasuredQuantity::Length | MeasuredQuantity::Storeys
        );
        let night = m.kind == MeasuredQuantity::Clock
            && heard
                .reading
                .acts
                .iter()
                .any(|a| matches!(a.what, super::reading::ActKind::Time { .. }));
        if !(is_named(m) || held.iter().any(|s| s.is(m)) || beside && own || night) {
            out.push(format!(
                "{text}: {:?} {} is in nothing and not named",
                m.kind, m.raw
            ));
        }
    }
    // No slot holds a number of another kind.
    for s in &held {
        let small = s.kind == SlotKind::Of(MeasuredQuantity::Count) && s.value <= 1.0;
        let wrong = numbers.iter().any(|m| !s.is(m) && (m.raw - s.value).abs() < 0.01);
        if wrong && !small && !numbers.iter().any(|m| s.is(m)) {
            out.push(format!("{text}: {s:?} is another number"));
        }
    }
    // Clauses on scenery count only with numbers that are counts.
    for said in &heard.reading.background {
        let n = said.count.map(f64::from);
        let counts = |m: &Measure| m.kind != MeasuredQuantity::Count && n == Some(m.raw);
        if numbers.iter().any(counts) {
            out.push(format!("{text}: {n:?} things"));
        }
    }
    out
}

#[test]
fn every_unit_in_every_place_is_carried_out_or_named() {
    let mut wrong = Vec::new();
    for (place, prompt) in PLACES {
        let mode = if prompt { Mode::Prompt } else { Mode::Edit };
        for unit in UNITS {
            wrong.extend(unnamed(&place.replace("{}", unit), mode));
        }
    }
    assert!(
        wrong.is_empty(),
        "{} of {}: {wrong:#?}",
        wrong.len(),
        PLACES.len() * UNITS.len()
    );
}

/// A sign of 30 km/h is one sign, and the number is reported.
#[test]
fn a_speed_is_no_count() {
    for (text, mode) in [
        ("a 30 km/h sign on the right", Mode::Prompt),
        ("add a 30 km/h sign on the right", Mode::Edit),
    ] {
        let heard = hear(text, mode).expect("weights");
        let counts: Vec<Option<u32>> = heard.reading.background.iter().map(|s| s.count).collect();
        assert_eq!(counts, [None], "{text}: {:?}", heard.reading);
        let named: Vec<&str> = heard.missing.iter().map(|m| m.words.as_str()).collect();
        assert_eq!(named, ["30 km/h"], "{text}");
        assert_eq!(heard.missing[0].why, Why::NotCarriedOut);
    }
}

/// Texts that took minutes, and similar ones: the work of the readers is bounded.
#[test]
fn long_texts_of_nothing_end() {
    for piece in [
        "10 m ",
        "10 m, ",
        "5 ",
        "xqzt 10 m ",
        "10 km/h and ",
        "m ",
        "buss 5 ",
    ] {
        let text = piece.repeat(1000);
        for mode in [Mode::Prompt, Mode::Edit] {
            let heard = hear(&text, mode).expect("weights");
            let words = piece.contains("and") || piece == "m " || piece.contains("buss");
            assert!(
                words || heard.reading.acts.is_empty(),
                "{piece}: {:?}",
                heard.reading
            );
            assert!(words || !heard.missing.is_empty(), "{piece}");
        }
    }
}

/// The cost of a text is that of its parts: the possible corrections of a word that occurs a thousand times are looked
/// up once, and a number is not taken for a typing error.
#[test]
fn numbers_are_slips_of_nothing() {
    let all = tokens(&"10 m bsu ".repeat(300), None);
    let of = |text: &str| all.iter().find(|t| t.text == text).map(|t| t.slip_of.clone());
    assert_eq!(of("<m>"), Some(Vec::new()));
    assert_eq!(of("bsu").map(|s| s.contains(&"bus")), Some(true));
}

/// Sentences with readings written by hand: the account must report next to nothing as missing, or its warnings would
/// be noise.
#[test]
fn right_readings_are_said_to_be_whole() {
    use super::account::missing;
    use super::notation::parse;
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../../../tests/words/train.jsonl");
    let text = std::fs::read_to_string(path).expect("sentences");
    let reader = LearnedReader::bundled().expect("weights");
    let (mut all, mut numbers, mut words) = (0, 0, 0);
    for line in text.lines() {
        let record: serde_json::Value = serde_json::from_str(line).expect("a record");
        let (Some(said), Some(reading)) = (record["text"].as_str(), record["reading"].as_str()) else {
            continue;
        };
        let Ok(reading) = parse(reading) else { continue };
        all += 1;
        let rest = super::beside::take(said, !record["base"].is_null()).rest;
        let tokens = tokens(&rest, Some(reader.speller()));
        let found = missing(&rest, &tokens, &reading, reader.speller());
        let measured = measures(&tokens);
        let is_number =
            |m: &&super::account::Missing| measured.iter().any(|x| x.span(&tokens).start == m.span.start);
        let of_numbers = found.iter().filter(is_number).count();
        if !found.is_empty() {
            println!(
                "{said}\n   {:?}",
                found.iter().map(|m| &m.words).collect::<Vec<_>>()
            );
        }
        numbers += usize::from(of_numbers > 0);
        words += usize::from(found.len() > of_numbers);
    }
    println!("{all} readings: numbers are named of {numbers}, words of {words}");
    assert!(all > 1000);
    assert!(100 * numbers < 4 * all, "numbers of {numbers} of {all}");
    assert!(100 * words < 12 * all, "words of {words} of {all}");
}
