//! CLIP's tokenizer: lower case, words by a pattern, byte pair encoding.

use std::collections::BTreeMap;
use std::path::Path;

use tokenizers::models::bpe::{BPE, Vocab};
use tokenizers::normalizers::{Lowercase, NFC, NormalizerWrapper, Replace, Sequence};
use tokenizers::pre_tokenizers::PreTokenizerWrapper;
use tokenizers::pre_tokenizers::byte_level::ByteLevel;
use tokenizers::pre_tokenizers::sequence::Sequence as PreSequence;
use tokenizers::pre_tokenizers::split::{Split, SplitPattern};
use tokenizers::{AddedToken, SplitDelimiterBehavior, Tokenizer};

use crate::StableError;
use crate::config::{TokenizerConfig, read_bounded, read_json};

/// Token before a text.
const FIRST: &str = "<|startoftext|>";
/// Token behind a text, which also stands for unknown words.
const LAST: &str = "<|endoftext|>";
/// Pattern of words: contractions, letters, single digits, and runs of other characters.
const WORDS: &str = r"'s|'t|'re|'ve|'m|'ll|'d|[\p{L}]+|[\p{N}]|[^\s\p{L}\p{N}]+";
/// Largest file of words, bytes; CLIP's `tokenizer.json` has 2 MB.
const MOST_BYTES: u64 = 64 << 20;
/// Longest part of a text that is read, bytes: many times what 77 tokens can hold.
const MOST_TEXT: usize = 1 << 16;

/// Tokenizer from texts to token ids.
pub struct Words {
    tokenizer: Tokenizer,
    first: u32,
    last: u32,
    pad: u32,
    largest: u32,
}

fn refuse(error: impl std::fmt::Display) -> StableError {
    StableError::Tokenizer(error.to_string().replace('\n', " "))
}

impl Words {
    /// Opens a folder with `vocab.json` and `merges.txt`, or with `tokenizer.json`. Errors if they are missing,
    /// damaged, or lack CLIP's tokens for the ends of a text.
    pub fn open(folder: &Path) -> Result<Self, StableError> {
        let whole = folder.join("tokenizer.json");
        let mut tokenizer = if folder.join("vocab.json").exists() || !whole.exists() {
            of_pairs(folder)?
        } else {
            let bytes = read_bounded(&whole, MOST_BYTES)?;
            let mut tokenizer = Tokenizer::from_bytes(&bytes).map_err(refuse)?;
            // `ids` adds the end tokens and sets the length.
            tokenizer.with_post_processor(None::<tokenizers::PostProcessorWrapper>);
            tokenizer.with_padding(None);
            tokenizer.with_truncation(None).map_err(refuse)?;
            tokenizer
        };
        let pad = TokenizerConfig::read(folder)?.pad;
        if let Some(pad) = &pad
            && tokenizer.token_to_id(pad).is_some()
        {
            // The padding token is one word wherever it stands, as in transformers: "!" in 2.1.
            tokenizer
                .add_special_tokens([AddedToken::from(pad.clone(), true)])
                .map_err(refuse)?;
        }
        let id = |word: &str| {
            let id = tokenizer.token_to_id(word);
            id.ok_or_else(|| refuse(format!("{}: no token {word:?}", folder.display())))
        };
        let largest = tokenizer.get_vocab(true).into_values().max();
        Ok(Self {
            first: id(FIRST)?,
            last: id(LAST)?,
            pad: id(pad.as_deref().unwrap_or(LAST))?,
            largest: largest.unwrap_or(0),
            tokenizer,
        })
    }

    /// The largest id.
    pub fn largest(&self) -> u32 {
        self.largest
    }

    /// Exactly `length` ids: the text between its end tokens, cut off or padded. Errors if the tokenizer fails.
    pub fn ids(&self, text: &str, length: usize) -> Result<Vec<u32>, StableError> {
        let end = (0..=MOST_TEXT.min(text.len()))
            .rev()
            .find(|i| text.is_char_boundary(*i));
        let text = &text[..end.unwrap_or(0)];
        let encoded = self.tokenizer.encode(text, false).map_err(refuse)?;
        let mut ids = vec![self.first];
        ids.extend(encoded.get_ids().iter().take(length.saturating_sub(2)));
        ids.push(self.last);
        ids.resize(length, self.pad);
        Ok(ids)
    }
}

/// The tokenizer of `vocab.json` and `merges.txt`.
fn of_pairs(folder: &Path) -> Result<Tokenizer, StableError> {
    let (vocab, merges) = (folder.join("vocab.json"), folder.join("merges.txt"));
    let words: BTreeMap<String, u32> = read_json(&vocab, MOST_BYTES)?;
    let text = String::from_utf8(read_bounded(&merges, MOST_BYTES)?)
        .map_err(|_| refuse(format!("{}: not a text", merges.display())))?;
    let lines = text
        .lines()
        .filter(|l| !l.starts_with("#version") && !l.trim().is_empty());
    let pairs = lines.map(|line| {
        let pair = line
            .split_once(' ')
            .map(|(a, b)| (a.to_owned(), b.trim().to_owned()));
        pair.ok_or_else(|| {
            refuse(format!(
                "{}: expected two parts, found {line:?}",
                merges.display()
            ))
        })
    });
    let pairs = pairs.collect::<Result<Vec<_>, _>>()?;
    let model = BPE::builder()
        .vocab_and_merges(words.into_iter().collect::<Vocab>(), pairs)
        .unk_token(LAST.to_owned())
        .end_of_word_suffix("</w>".to_owned())
        .build()
        .map_err(refuse)?;
    let mut tokenizer = Tokenizer::new(model);
    let spaces = Replace::new(
        tokenizers::normalizers::replace::ReplacePattern::Regex(r"\s+".into()),
        " ",
    );
    let normalizer = Sequence::new(vec![
        NormalizerWrapper::NFC(NFC),
        NormalizerWrapper::Replace(spaces.map_err(refuse)?),
        NormalizerWrapper::Lowercase(Lowercase),
    ]);
    tokenizer.with_normalizer(Some(normalizer)).map_err(refuse)?;
    let split = Split::new(
        SplitPattern::Regex(WORDS.into()),
        SplitDelimiterBehavior::Removed,
        true,
    );
    tokenizer.with_pre_tokenizer(Some(PreSequence::new(vec![
        PreTokenizerWrapper::Split(split.map_err(refuse)?),
        PreTokenizerWrapper::ByteLevel(ByteLevel::new(false, true, false)),
    ])));
    let special = [FIRST, LAST].map(|word| AddedToken::from(word, true));
    tokenizer.add_special_tokens(special).map_err(refuse)?;
    Ok(tokenizer)
}
