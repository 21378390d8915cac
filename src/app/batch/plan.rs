//! The plan of a batch, as a JSON file.

use std::path::{Path, PathBuf};

use anyhow::{Context, bail};
use glam::DVec2;
use serde::{Deserialize, Serialize};

use editor::Edit;
use formats::input;
use formats::video::VideoKind;
use numeric::splitmix::hash;
use scene::{BoxId, Class, TimeOfDay, Weather};

/// `format` of a plan.
pub const FORMAT: &str = "sceneloom_batch";
/// `version` of a plan.
pub const VERSION: u32 = 1;
/// Variants at most.
pub const MOST_VARIANTS: usize = 1_000_000;

/// A plan. Unknown keys are refused by name.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct BatchPlan {
    /// `sceneloom_batch`.
    pub format: String,
    /// 1.
    pub version: u32,
    /// The scene that every variant begins with.
    pub base: Base,
    /// Seed of every draw; it also decides which variants a sample takes.
    #[serde(default)]
    pub seed: u64,
    /// Axes that vary. A variant takes one value of each, in this order. There is one variant for every combination;
    /// the last axis changes fastest.
    #[serde(default)]
    pub sweep: Vec<VariationAxis>,
    /// Number of combinations to make, drawn by the seed; all of them if left out.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub sample: Option<usize>,
    /// Makes the occupancy with the networks; drafted without networks if left out.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub generate: Option<BatchGeneration>,
    /// Runs the quality checks and counts their findings.
    #[serde(default)]
    pub check: bool,
    /// Files to write of each variant.
    pub write: Vec<Output>,
    /// Rate at which files of a moment are written over a clip, Hz; the first moment only if left out.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub frames_hz: Option<f64>,
    /// Number of variants per tar (WebDataset); a folder for each variant if left out.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub pack: Option<usize>,
}

/// The scene that a variant begins with.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub enum Base {
    /// A procedural world, drawn by the seed.
    Template(String),
    /// A file that the program reads, beside the plan.
    Scene(PathBuf),
    /// A place on the roads of a file.
    Road(RoadPlace),
    /// A new scene by words, drawn by the seed.
    Words(String),
}

/// A place on roads.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct RoadPlace {
    /// The road file, beside the plan.
    pub file: PathBuf,
    /// The ego vehicle's place in the file's frame, m; a good place on a lane if left out.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub at_m: Option<DVec2>,
    /// Its heading, degrees; along the lane if left out.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub heading_deg: Option<f64>,
}

/// One axis: a property that varies.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct VariationAxis {
    /// Its name in records and in the index.
    pub name: String,
    /// The values, each a list of changes made together.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub values: Vec<Value>,
    /// Consecutive seeds in place of values.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub seeds: Option<Seeds>,
}

/// Consecutive seeds.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Seeds {
    /// The first seed.
    pub from: u64,
    /// Number of seeds.
    pub count: usize,
}

/// A value of an axis: one change, or several that are made together. An empty list changes nothing.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(untagged)]
pub enum Value {
    /// Several changes.
    Many(Vec<VariantChange>),
    /// One change.
    One(VariantChange),
}

/// A change of a variant.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub enum VariantChange {
    /// Another seed.
    Seed(u64),
    /// Another base.
    Base(Base),
    /// Another time of day or weather. A part that is left out stays as it is.
    Conditions {
        /// Time of day.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        time: Option<TimeOfDay>,
        /// Weather.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        weather: Option<Weather>,
    },
    /// An edit by words.
    Words(String),
    /// Edits, as `edit --edits` takes them; tracks and templates of motion are among them.
    Edits(Vec<Edit>),
    /// Moves a box from where it is.
    Offset {
        /// The box.
        #[serde(rename = "box")]
        id: BoxId,
        /// Ahead and to the left along its own heading, m.
        #[serde(default)]
        by_m: DVec2,
        /// Turn to the left, degrees.
        #[serde(default)]
        turn_deg: f64,
    },
    /// Sets the number of boxes of a class. Some are removed, or some are added where such an object is found.
    Count {
        /// The class.
        class: Class,
        /// The new number of boxes.
        n: usize,
    },
}

/// How the networks make the occupancy.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct BatchGeneration {
    /// A preset of the measured trade: `draft`, `balanced`, `careful`, `reference`.
    pub quality: String,
    /// True: generates the whole scene. False: only the region that the changes touch.
    #[serde(default)]
    pub whole: bool,
}

/// A kind of file that is written.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Output {
    /// A format of `export --format list`, or `loom`, or of clips `mp4`, `gif` and `apng`: all cameras in two rows.
    pub format: String,
    /// Size of camera pictures, pixels.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub size: Option<[u32; 2]>,
    /// The learned LiDAR in place of the exact one.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub learned_lidar: bool,
}

/// The video format that an output format of a plan names; `None` for other formats.
pub fn video(format: &str) -> Option<VideoKind> {
    match format {
        "mp4" => Some(VideoKind::Mp4),
        "gif" => Some(VideoKind::Gif),
        "apng" => Some(VideoKind::Apng),
        _ => None,
    }
}

impl Value {
    /// The changes of the value.
    pub fn changes(&self) -> &[VariantChange] {
        match self {
            Value::Many(many) => many,
            Value::One(one) => std::slice::from_ref(one),
        }
    }
}

impl VariationAxis {
    /// Number of values.
    pub fn len(&self) -> usize {
        self.seeds.map_or(self.values.len(), |s| s.count)
    }

    /// True without any value.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// The changes of a value.
    pub fn value(&self, i: usize) -> Vec<VariantChange> {
        match self.seeds {
            Some(seeds) => vec![VariantChange::Seed(seeds.from.wrapping_add(i as u64))],
            None => self.values[i].changes().to_vec(),
        }
    }
}

impl BatchPlan {
    /// Reads a plan. Errors in one line that names the file.
    pub fn read(path: &Path) -> anyhow::Result<BatchPlan> {
        let text = input::read_text(path, input::LARGEST_TEXT)?;
        let plan: BatchPlan = serde_json::from_str(&text).with_context(|| path.display().to_string())?;
        match plan.problem() {
            Some(problem) => bail!("{}: {problem}", path.display()),
            None => Ok(plan),
        }
    }

    /// The first fault of the plan in one line; `None` if it is valid.
    pub fn problem(&self) -> Option<String> {
        if self.format != FORMAT || self.version != VERSION {
            let found = scene::message::quoted(&self.format, 60);
            return Some(format!(
                "format is {found:?} version {}, expected {FORMAT:?} version {VERSION}",
                self.version
            ));
        }
        let mut names = std::collections::BTreeSet::new();
        for axis in &self.sweep {
            let name = scene::message::quoted(&axis.name, 60);
            if !names.insert(&axis.name) || axis.name.trim().is_empty() {
                return Some(format!("sweep {name:?}: expected a name that no other has"));
            }
            if axis.is_empty() || (axis.seeds.is_some() && !axis.values.is_empty()) {
                return Some(format!(
                    "sweep {name:?}: expected either values or seeds, at least one"
                ));
            }
        }
        if self
            .count_all()
            .is_none_or(|n| n > MOST_VARIANTS && self.sample.is_none())
        {
            return Some(format!("the sweep has more than {MOST_VARIANTS} combinations"));
        }
        if let Some(n) = self.sample
            && (n == 0 || n > MOST_VARIANTS)
        {
            return Some(format!("sample is {n}, expected 1 to {MOST_VARIANTS}"));
        }
        if self.write.is_empty() {
            return Some("write is empty, expected at least one format".into());
        }
        let known = |id: &str| id == "loom" || video(id).is_some() || formats::export::from_id(id).is_some();
        let unknown = |o: &&Output| !known(&o.format);
        if let Some(output) = self.write.iter().find(unknown) {
            let known: Vec<&str> = formats::export::all().iter().map(|f| f.id).collect();
            let found = scene::message::quoted(&output.format, 60);
            return Some(format!(
                "write: format is {found:?}, expected loom, mp4, gif, apng, {}",
                known.join(", ")
            ));
        }
        if self.frames_hz.is_some_and(|hz| !(hz > 0.0 && hz <= 100.0)) {
            return Some("frames_hz is not above 0 and at most 100".into());
        }
        (self.pack == Some(0)).then(|| "pack is 0, expected at least 1".into())
    }

    /// Number of combinations of all axes; `None` if it does not fit into `usize`.
    fn count_all(&self) -> Option<usize> {
        self.sweep
            .iter()
            .try_fold(1usize, |n, axis| n.checked_mul(axis.len()))
    }

    /// Number of variants.
    pub fn count(&self) -> usize {
        let all = self.count_all().unwrap_or(0);
        self.sample.map_or(all, |n| n.min(all))
    }

    /// The index of the value that a variant takes, for each axis.
    pub fn values_of(&self, variant: usize) -> Vec<usize> {
        let all = self.count_all().unwrap_or(1).max(1);
        let mut rest = match self.sample.is_some_and(|n| n < all) {
            true => shuffled(variant, all, self.seed),
            false => variant,
        };
        let mut values = vec![0; self.sweep.len()];
        for (value, axis) in values.iter_mut().zip(&self.sweep).rev() {
            *value = rest % axis.len();
            rest /= axis.len();
        }
        values
    }
}

/// A permutation of the numbers below `n`, drawn by the seed: a Feistel network of four rounds, repeated until the
/// result is below `n`.
fn shuffled(i: usize, n: usize, seed: u64) -> usize {
    let bits = (usize::BITS - (n - 1).leading_zeros()).max(2);
    let half = bits.div_ceil(2);
    let mask = (1u64 << half) - 1;
    let mut at = i as u64;
    loop {
        let (mut left, mut right) = (at >> half & mask, at & mask);
        for round in 0..4u64 {
            let mixed = hash(hash(seed ^ round) ^ right) & mask;
            (left, right) = (right, left ^ mixed);
        }
        at = left << half | right;
        if at < n as u64 {
            return at as usize;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn plan(json: &str) -> Result<BatchPlan, String> {
        let text = format!(
            r#"{{"format":"sceneloom_batch","version":1,"base":{{"template":"straight"}},"write":[{{"format":"boxes"}}]{json}}}"#
        );
        let plan: BatchPlan = serde_json::from_str(&text).map_err(|e| e.to_string())?;
        plan.problem().map_or(Ok(plan), Err)
    }

    #[test]
    fn every_combination_comes_once() {
        let plan = plan(
            r#","sweep":[{"name":"weather","values":[{"conditions":{"weather":"rain"}},[],[{"conditions":{"time":"night"}},{"seed":4}]]},
            {"name":"seed","seeds":{"from":10,"count":4}}]"#,
        )
        .expect("sound");
        assert_eq!(plan.count(), 12);
        let all: std::collections::BTreeSet<Vec<usize>> = (0..12).map(|i| plan.values_of(i)).collect();
        assert_eq!(all.len(), 12);
        assert_eq!(plan.values_of(5), [1, 1]);
        assert_eq!(plan.sweep[1].value(3), [VariantChange::Seed(13)]);
        assert_eq!(plan.sweep[0].value(2).len(), 2);
        let some = BatchPlan {
            sample: Some(7),
            ..plan.clone()
        };
        let drawn: std::collections::BTreeSet<Vec<usize>> =
            (0..some.count()).map(|i| some.values_of(i)).collect();
        assert_eq!((some.count(), drawn.len()), (7, 7));
        let other = BatchPlan { seed: 1, ..some };
        assert!(
            (0..7).any(|i| !drawn.contains(&other.values_of(i))),
            "another seed draws others"
        );
        for n in [1, 2, 3, 100, 1000] {
            let mut places: Vec<usize> = (0..n).map(|i| shuffled(i, n, 9)).collect();
            places.sort_unstable();
            assert!(places.iter().enumerate().all(|(i, p)| i == *p), "{n}");
        }
    }

    #[test]
    fn bad_plans_are_told_in_a_line() {
        for (json, word) in [
            (r#","sweep":[{"name":"a"}]"#, "values or seeds"),
            (
                r#","sweep":[{"name":"a","seeds":{"from":0,"count":2}},{"name":"a","seeds":{"from":0,"count":2}}]"#,
                "no other",
            ),
            (
                r#","sweep":[{"name":"a","seeds":{"from":0,"count":99999999}}]"#,
                "combinations",
            ),
            (r#","frames_hz":0"#, "frames_hz"),
            (r#","pack":0"#, "pack"),
            (r#","sample":0"#, "sample"),
            (r#","surprise":0"#, "surprise"),
        ] {
            let line = plan(json).expect_err(json);
            assert!(line.contains(word), "{line}");
        }
        let line = serde_json::from_str::<BatchPlan>(
            r#"{"format":"x","version":1,"base":{"template":"a"},"write":[]}"#,
        )
        .expect("it can be read")
        .problem()
        .expect("foreign");
        assert!(line.contains("sceneloom_batch"), "{line}");
    }
}
