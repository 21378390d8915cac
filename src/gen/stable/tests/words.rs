//! The tokenizer beside that of transformers.

use super::{Golden, folder, opened};
use crate::Words;

/// The texts of the script, in its order.
fn texts() -> [String; 8] {
    [
        "A wet road, it's dawn; two cars".into(),
        String::new(),
        "  Many\tspaces\n and CAPITALS ".into(),
        "caf\u{e9} d'or we'll 42 cars!!! ...".into(),
        "\u{4ea4}\u{901a} and \u{1f697}".into(),
        "road ".repeat(100),
        "<|endoftext|> inside <|startoftext|>".into(),
        "cafe\u{301} \u{130} \u{a0} x".into(),
    ]
}

#[test]
fn ids_are_those_of_transformers() {
    for model in ["sd15", "sd21"] {
        let golden = Golden::open(&format!("{model}/golden.safetensors"));
        let words = Words::open(&folder(model).join("tokenizer")).expect("words");
        for (i, text) in texts().iter().enumerate() {
            let ids = words.ids(text, 77).expect("ids");
            let expected: Vec<u32> = golden
                .numbers(&format!("ids.{i}"))
                .iter()
                .map(|v| *v as u32)
                .collect();
            assert_eq!(ids, expected, "{model}: {text:?}");
        }
    }
}

#[test]
fn any_text_gives_as_many_ids_as_asked() {
    let words = Words::open(&folder("sd21").join("tokenizer")).expect("words");
    let long = "\u{1f697}".repeat(100_000);
    for text in [
        "",
        "\0",
        "\u{feff}\u{200b}",
        long.as_str(),
        "a'''b",
        "<|startoftext|>",
    ] {
        let ids = words.ids(text, 77).expect("ids");
        assert_eq!(ids.len(), 77);
        assert!(ids.iter().all(|id| *id <= words.largest()));
    }
}

#[test]
fn ids_that_are_no_words_are_refused() {
    let text = opened("sd15").text;
    let error = text.encode(&[1_000_000; 77]).expect_err("no word").to_string();
    assert_eq!(
        error,
        "token id is 1000000, expected less than 96, the words of the encoder"
    );
    let error = text.encode(&[0; 3]).expect_err("too few").to_string();
    assert_eq!(error, "token ids has 3 values, expected 77");
}
