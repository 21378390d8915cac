//! Sentences about streets with the facts behind them: training data of the text encoder.

use safetensors::tensor::Dtype;

use super::Shard;
use super::layout::street;
use graph_layout::describe::sentence;
use graph_layout::facts::Facts;
use nets::text::{TOKENS, token_ids};
use scene::BevLayout;
use scene::road_map::RoadMap;
use world::draw::hash;

/// Shares of the facts that the sentences about one scene give: one gives nearly all, one half, two are short.
pub const SHARES: [f64; 4] = [0.95, 0.5, 0.25, 0.12];
/// Bytes of a sentence that are stored as text.
const LETTERS: usize = 320;

/// One scene in words and numbers.
pub struct TextFrame {
    /// Sentences about it.
    pub sentences: [String; SHARES.len()],
    /// Numbers about it.
    pub features: Vec<f32>,
}

/// Frame `index` of the data set of `seed`; the same arguments give the same frame.
pub fn text_frame(seed: u64, index: u64, roads: impl Fn(u64) -> Option<BevLayout>) -> TextFrame {
    let (layout, boxes, template) = street(seed, index, roads);
    let own = hash(seed ^ hash(index));
    let facts = Facts::from_layout(&layout, &RoadMap::new(&layout), &boxes, template, own);
    TextFrame {
        sentences: std::array::from_fn(|i| sentence(&facts, SHARES[i], hash(own ^ i as u64))),
        features: facts.features(),
    }
}

impl Shard for TextFrame {
    const ARRAYS: &'static [&'static str] = &["text", "ids", "features"];

    /// u8 `text` `[N,4,320]` (UTF-8, cut and padded with 0), i32 `ids` `[N,4,192]` (hashed n-grams, padded with -1),
    /// f32 `features` `[N,57]`.
    fn arrays(frames: &[Self]) -> Vec<(Dtype, Vec<usize>, Vec<u8>)> {
        let (mut text, mut ids, mut features) = (Vec::new(), Vec::new(), Vec::new());
        for frame in frames {
            for sentence in &frame.sentences {
                let bytes = sentence.bytes().chain(std::iter::repeat(0));
                text.extend(bytes.take(LETTERS));
                let found = token_ids(sentence);
                for i in 0..TOKENS {
                    ids.extend(found.get(i).map_or(-1, |id| *id as i32).to_le_bytes());
                }
            }
            frame
                .features
                .iter()
                .for_each(|v| features.extend(v.to_le_bytes()));
        }
        vec![
            (Dtype::U8, vec![SHARES.len(), LETTERS], text),
            (Dtype::I32, vec![SHARES.len(), TOKENS], ids),
            (Dtype::F32, vec![Facts::FEATURES], features),
        ]
    }
}

#[cfg(test)]
mod tests {
    use super::super::write;
    use super::*;

    #[test]
    fn shards_hold_sentences_and_facts() {
        let make = |i: usize| -> std::io::Result<TextFrame> { Ok(text_frame(5, i as u64, |_| None)) };
        let folder = tempfile::tempdir().expect("a folder");
        write(folder.path(), 2, make, |_| true).expect("written");
        let bytes = std::fs::read(folder.path().join("shard_00000.safetensors")).expect("a shard");
        let file = safetensors::SafeTensors::deserialize(&bytes).expect("sound");
        assert_eq!(
            file.tensor("ids").expect("there").shape(),
            [2, SHARES.len(), TOKENS]
        );
        assert_eq!(
            file.tensor("features").expect("there").shape(),
            [2, Facts::FEATURES]
        );
        let frame = text_frame(5, 0, |_| None);
        assert!(frame.sentences.iter().all(|s| !s.is_empty()));
        assert_eq!(frame.sentences, text_frame(5, 0, |_| None).sentences);
    }
}
