use serde::Deserialize;

use super::super::notation;
use super::super::tokens::tokens;
use super::{LearnedReader, Mode, Spoken};

#[derive(Deserialize)]
struct Row {
    kind: String,
    text: String,
    tokens: Vec<String>,
    memory: Vec<f32>,
    first: Vec<(String, f32)>,
    line: String,
}

/// Made by `training/words/export_reader.py` with PyTorch from the weights that ship.
fn golden() -> Vec<Row> {
    serde_json::from_str(include_str!("../../../../tests/reference/reader_golden.json")).expect("golden")
}

#[test]
fn the_network_says_what_its_twin_says() {
    let reader = LearnedReader::bundled().expect("weights");
    for row in golden() {
        let mode = if row.kind == "prompt" {
            Mode::Prompt
        } else {
            Mode::Edit
        };
        let said = reader.read(&row.text, mode);
        let tokens: Vec<&str> = said.tokens.iter().map(|t| t.text.as_str()).collect();
        assert_eq!(tokens, row.tokens, "{}", row.text);
        let input = reader.symbols.input(&said.tokens, mode);
        let memory = reader.net.encode(&input);
        for (i, (found, truth)) in memory.first_numbers().zip(&row.memory).enumerate() {
            assert!(
                (found - truth).abs() < 2e-3,
                "{} place {i}: {found}, PyTorch {truth}",
                row.text
            );
        }
        let mut state = reader.net.begin();
        let (p, _) = reader.net.next(&mut state, &memory, None, &input);
        for (symbol, truth) in &row.first {
            let found = (0..p.len())
                .find(|i| reader.symbols.name(*i) == symbol)
                .map_or(0.0, |i| p[i]);
            assert!(
                (found - truth).abs() < 2e-3,
                "{}: {symbol} {found}, PyTorch {truth}",
                row.text
            );
        }
        if notation::parse(&row.line).is_ok() {
            assert_eq!(notation::write(&said.reading), row.line, "{}", row.text);
        }
    }
}

#[test]
fn whatever_is_typed_a_valid_reading_comes_of_it() {
    let reader = LearnedReader::bundled().expect("weights");
    let long = "and a bus behind the car ".repeat(400);
    let beyond = reader.read(&long, Mode::Prompt);
    assert!(!beyond.left_out.is_empty() && beyond.tokens.len() + beyond.left_out.len() == 2400);
    for text in [
        "",
        " ",
        "🚗🚗",
        "((((",
        ";;;;; ### @@",
        "99999999999999999999999 cars 1e400 m",
        "#",
        "\u{0}\u{202e}",
        &long,
    ] {
        for mode in [Mode::Prompt, Mode::Edit] {
            let said = reader.read(text, mode);
            let line = notation::write(&said.reading);
            if !line.is_empty() {
                let again = notation::parse(&line).unwrap_or_else(|e| panic!("{line}: {e}"));
                assert_eq!(notation::write(&again), line);
            }
            assert!(
                said.reading
                    .acts
                    .iter()
                    .all(|a| (0.0..=1.0).contains(&a.confidence))
            );
        }
    }
}

#[test]
fn gone_back_to_any_symbol_it_says_the_same_again() {
    let reader = LearnedReader::bundled().expect("it ships");
    let text = "a straight road, a cone 10 m ahead, a van in the left lane and three people on the crossing";
    let all = tokens(text, Some(reader.speller()));
    let input = reader.symbols.input(&all, Mode::Prompt);
    let memory = reader.net.encode(&input);
    let (mut state, mut first) = (reader.net.begin(), Spoken::default());
    reader.go_on(&mut first, &mut state, &memory, &input, &all);
    assert!(first.said.len() > 10, "{:?}", first.symbols());
    for at in 0..first.said.len() - 1 {
        let mut state = state.clone();
        state.back_to(at + 1, &reader.net);
        let mut again = Spoken {
            said: first.said[..=at].to_vec(),
        };
        reader.go_on(&mut again, &mut state, &memory, &input, &all);
        assert_eq!(again.symbols(), first.symbols(), "from symbol {at}");
        assert!((again.log_p() - first.log_p()).abs() < 1e-6);
    }
}
