//! Text input of the UNet: the tokenizer and text encoder of CLIP (Radford et al. 2021, arXiv 2103.00020).

mod encoder;
mod tokenizer;

pub use encoder::TextEncoder;
pub use tokenizer::Words;
