//! Options of a suite, and the command line that sets them.

use std::path::PathBuf;

use job::GenParams;

/// Sizes and choices of a run. A suite reads the options that concern it.
#[derive(Clone, Debug, PartialEq)]
pub struct Options {
    /// Number of held-out worlds, or of frames of `data`.
    pub frames: usize,
    /// Folder of Occ3D frames (`labels.npz`, at any depth) to judge the VAE or edits on instead; for `map`, a project
    /// file.
    pub data: Option<PathBuf>,
    /// Vehicles of a scene that are removed, moved and changed, one by one, at most (editing).
    pub vehicles: usize,
    /// Presets of the quality slider to judge; all but the reference if none is named (editing).
    pub presets: Vec<String>,
    /// Worlds whose objects give the usual number of voxels of a class, at least (editing).
    pub band_worlds: usize,
    /// Random edits, one after another, that must change nothing outside their regions (editing).
    pub random_edits: usize,
    /// Worlds on which every inversion scheme is tried with 5, 10, 20 and 50 steps (editing).
    pub scheme_frames: usize,
    /// Worlds on which a removal is compared with one of 1000 steps (editing).
    pub reference_frames: usize,
    /// Sentences to judge (layout): a file of one JSON object a line, or a folder of such files.
    pub prompts: Option<PathBuf>,
    /// Largest number of sentences, spread evenly; `None` takes all (layout).
    pub sentences: Option<usize>,
    /// Reader of the sentences (layout).
    pub reader: Who,
    /// Prompts on which the placers are compared, with and without memory (layout); 0 leaves that out.
    pub placer_prompts: usize,
    /// Leaves out ablations of layout and boxes, and inpainted squares (generation).
    pub rows_only: bool,
    /// Parameters of whole scenes.
    pub scene_params: GenParams,
    /// Parameters of edits.
    pub edit_params: GenParams,
    /// Folder of weights instead of the bundled ones.
    pub weights: Option<PathBuf>,
}

impl Default for Options {
    fn default() -> Self {
        Self {
            frames: 24,
            data: None,
            vehicles: 6,
            presets: Vec::new(),
            band_worlds: 40,
            random_edits: 0,
            scheme_frames: 0,
            reference_frames: 0,
            prompts: None,
            sentences: None,
            reader: Who::default(),
            placer_prompts: 60,
            rows_only: false,
            scene_params: GenParams::whole_scene(),
            edit_params: GenParams::default(),
            weights: None,
        }
    }
}

/// Reader of the sentences.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, clap::ValueEnum)]
pub enum Who {
    /// The two readers together, as in the program.
    #[default]
    Both,
    /// No reader: the readings given with the sentences are carried out.
    Given,
    /// The learned reader alone.
    Learned,
    /// The grammar alone: a sentence that it does not read to the last word counts as not read.
    Grammar,
}
