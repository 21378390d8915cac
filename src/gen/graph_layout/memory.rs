//! A memory of scenes: scenes with their descriptions. A short prompt retrieves the nearest ones (cosine of text
//! vectors, X-Scene's Algorithm 1), and they propose the parts that it leaves open.

use std::collections::BTreeMap;
use std::sync::{Arc, OnceLock};

use glam::{DVec2, DVec3};
use serde::{Deserialize, Serialize};
use thiserror::Error;

use super::describe::sentence;
use super::facts::{Environment, Facts, RoadKind};
use super::graph_of::graph_of;
use nets::text::{TextEncoder, cosine};
use nn::ops::OpsError;
use nn::weights::WeightsError;
use scene::graph::SceneGraph;
use scene::message::one_line;
use scene::road_map::RoadMap;
use scene::{BevLayout, BoxId, BoxLabel, Class, SceneBox};
use world::draw::{Draw, hash};
use world::template;

/// Format of bank files.
pub const VERSION: u32 = 1;
/// Number of entries that a proposal is made from.
pub const NEAREST: usize = 5;

/// A problem with a bank, or with encoding a text.
#[derive(Debug, Error)]
pub enum MemoryError {
    /// Not JSON of this shape.
    #[error("memory bank: {0}")]
    Malformed(String),
    /// An error of the encoder's weights.
    #[error(transparent)]
    Weights(#[from] WeightsError),
    /// An error of the encoder.
    #[error(transparent)]
    Encoder(#[from] OpsError),
}

/// Source of an entry's road.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub enum RoadRef {
    /// A procedural template.
    Template {
        /// Its name.
        name: String,
        /// Seed of its variation.
        seed: u64,
    },
    /// A place on a road file that ships with the program or that the user has (formats know how to read it).
    Imported {
        /// Name of the file.
        file: String,
        /// Place of the ego vehicle, in the file's frame, m.
        position_m: DVec2,
        /// Its heading, rad.
        heading_rad: f64,
    },
    /// A scene of the user's.
    Scene {
        /// Path of the .loom file.
        path: String,
    },
}

impl RoadRef {
    /// The layout, if this room can make it: for templates. The caller reads the others.
    pub fn layout(&self) -> Option<BevLayout> {
        match self {
            Self::Template { name, seed } => template::layout(name, *seed),
            _ => None,
        }
    }
}

/// A remembered scene.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct RememberedScene {
    /// Description as a person would give it.
    pub text: String,
    /// The facts of the description.
    pub facts: Facts,
    /// Its road.
    pub road: RoadRef,
    boxes: Vec<[f64; 9]>, // class id, x, y, z, length, width, height, yaw, speed
}

impl RememberedScene {
    /// An entry for a scene. `told` is its author's text; a description is added.
    pub fn new(
        told: &str,
        layout: &BevLayout,
        boxes: &BTreeMap<BoxId, SceneBox>,
        road: RoadRef,
        seed: u64,
    ) -> Self {
        let name = match &road {
            RoadRef::Template { name, .. } => Some(name.as_str()),
            _ => None,
        };
        let facts = Facts::from_layout(layout, &RoadMap::new(layout), boxes, name, seed);
        let described = sentence(&facts, 0.95, seed);
        let round = |v: f64| (v * 100.0).round() / 100.0;
        let row = |b: &SceneBox| {
            let (c, s) = (b.center_m, b.size_m);
            let speed = b.velocity_mps.dot(b.heading());
            [
                f64::from(b.class.id()),
                c.x,
                c.y,
                c.z,
                s.x,
                s.y,
                s.z,
                b.yaw_rad,
                speed,
            ]
            .map(round)
        };
        let sound = boxes.values().filter(|b| b.problem().is_none());
        Self {
            text: if told.trim().is_empty() {
                described
            } else {
                format!("{}. {described}", told.trim())
            },
            facts,
            road,
            boxes: sound.map(row).collect(),
        }
    }

    /// Its objects; rows that are not sound boxes are left out.
    pub fn boxes(&self) -> BTreeMap<BoxId, SceneBox> {
        let mut out = BTreeMap::new();
        for (i, [class, x, y, z, l, w, h, yaw_rad, speed]) in self.boxes.iter().copied().enumerate() {
            let Some(class) = Class::from_id(class.clamp(0.0, 255.0) as u8) else {
                continue;
            };
            let b = SceneBox {
                id: BoxId(i as u32 + 1),
                class,
                center_m: DVec3::new(x, y, z),
                size_m: DVec3::new(l, w, h),
                yaw_rad,
                velocity_mps: DVec2::from_angle(yaw_rad) * speed,
                label: BoxLabel::default(),
            };
            if b.problem().is_none() {
                out.insert(b.id, b);
            }
        }
        out
    }

    /// Its scene graph, on its layout.
    pub fn graph(&self, layout: &BevLayout) -> SceneGraph {
        graph_of(&RoadMap::new(layout), &self.boxes(), hash(self.text.len() as u64)).0
    }
}

/// Entries as they are stored in a file.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Bank {
    /// The format: [`VERSION`].
    pub version: u32,
    /// Scenes.
    pub entries: Vec<RememberedScene>,
}

impl Bank {
    /// Reads a file's text.
    pub fn parse(text: &str) -> Result<Self, MemoryError> {
        let bank: Self = serde_json::from_str(text).map_err(|e| MemoryError::Malformed(one_line(&e)))?;
        if bank.version != VERSION {
            let found = bank.version;
            return Err(MemoryError::Malformed(format!(
                "version is {found}, expected {VERSION}"
            )));
        }
        Ok(bank)
    }

    /// The bank that ships with the program.
    pub fn bundled() -> Result<Self, MemoryError> {
        Self::parse(assets::memory::BANK)
    }
}

/// Statements of a prompt; parts that are `None` or absent are open.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct RetrievalQuery {
    /// The prompt.
    pub text: String,
    /// Kind of road.
    pub road: Option<RoadKind>,
    /// Surroundings.
    pub environment: Option<Environment>,
    /// True for night.
    pub night: Option<bool>,
    /// Index in [`WEATHERS`](super::facts::WEATHERS).
    pub weather: Option<usize>,
    /// Stated numbers of objects by class (0 for excluded classes).
    pub counts: BTreeMap<Class, usize>,
}

/// An entry that was retrieved.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Retrieved {
    /// Index in [`SceneMemory::entries`].
    pub entry: usize,
    /// Cosine of the texts.
    pub similarity: f64,
    /// The similarity less a penalty for contradictions of the prompt; the list is sorted by it.
    pub score: f64,
}

/// A proposal for the open parts of a prompt.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Proposal {
    /// The entries it comes from, the best first.
    pub from: Vec<Retrieved>,
    /// A road of the stated kind, or of the kind that was retrieved.
    pub road: RoadRef,
    /// Its kind.
    pub road_kind: RoadKind,
    /// Surroundings, the stated or the retrieved ones.
    pub environment: Environment,
    /// Night, stated or that of most retrieved scenes; `None` if they do not agree.
    pub night: Option<bool>,
    /// Weather, in the same way.
    pub weather: Option<usize>,
    /// Usual counts (moving, parked, waiting) of classes that were not counted: medians over the retrieved scenes.
    pub counts: BTreeMap<Class, [usize; 3]>,
}

/// Entries with their vectors.
pub struct SceneMemory {
    encoder: Arc<TextEncoder>,
    entries: Vec<RememberedScene>,
    vectors: Vec<Vec<f32>>,
}

impl SceneMemory {
    /// The bundled bank with the shipped encoder, made once.
    pub fn bundled() -> Result<Arc<Self>, MemoryError> {
        static MEMORY: OnceLock<Arc<SceneMemory>> = OnceLock::new();
        if let Some(memory) = MEMORY.get() {
            return Ok(memory.clone());
        }
        let memory = Self::new(TextEncoder::bundled()?, Bank::bundled()?.entries)?;
        Ok(MEMORY.get_or_init(|| Arc::new(memory)).clone())
    }

    /// A memory of these entries. Errors, as in all functions below that encode a text, if the encoder cannot compute.
    pub fn new(encoder: Arc<TextEncoder>, entries: Vec<RememberedScene>) -> Result<Self, MemoryError> {
        let vectors = entries.iter().map(|e| encoder.encode(&e.text));
        Ok(Self {
            vectors: vectors.collect::<Result<_, _>>()?,
            encoder,
            entries,
        })
    }

    /// A memory of the entries and these in addition: the user's own scenes.
    pub fn with(&self, more: Vec<RememberedScene>) -> Result<Self, MemoryError> {
        let mut entries = self.entries.clone();
        entries.extend(more);
        Self::new(self.encoder.clone(), entries)
    }

    /// All entries.
    pub fn entries(&self) -> &[RememberedScene] {
        &self.entries
    }

    /// The `k` entries nearest to a text, the best first; ties by their order.
    pub fn nearest(&self, text: &str, k: usize) -> Result<Vec<Retrieved>, MemoryError> {
        self.ranked(text, k, |_| 0.0)
    }

    fn ranked(
        &self,
        text: &str,
        k: usize,
        penalty: impl Fn(&RememberedScene) -> f64,
    ) -> Result<Vec<Retrieved>, MemoryError> {
        let wanted = self.encoder.encode(text)?;
        let mut all: Vec<Retrieved> = self
            .vectors
            .iter()
            .zip(&self.entries)
            .enumerate()
            .map(|(entry, (v, e))| {
                let similarity = cosine(&wanted, v);
                let score = similarity - penalty(e);
                Retrieved {
                    entry,
                    similarity,
                    score,
                }
            })
            .collect();
        all.sort_by(|a, b| b.score.total_cmp(&a.score).then(a.entry.cmp(&b.entry)));
        all.truncate(k);
        Ok(all)
    }

    /// Proposes the open parts of a prompt, from the [`NEAREST`] entries; the entry that gives the road is drawn from
    /// `seed` in proportion to exp(score / 0.1). `None` if the memory is empty.
    pub fn fill_in(&self, open: &RetrievalQuery, seed: u64) -> Result<Option<Proposal>, MemoryError> {
        const SHARPNESS: f64 = 0.1;
        let from = self.ranked(&open.text, NEAREST, |e| contradictions(open, &e.facts))?;
        let Some(best) = from.first().map(|r| r.score) else {
            return Ok(None);
        };
        let weights: Vec<f64> = from
            .iter()
            .map(|r| ((r.score - best) / SHARPNESS).exp())
            .collect();
        let agreed = |says: &dyn Fn(&Facts) -> usize| -> Option<usize> {
            let of = |r: &Retrieved| says(&self.entries[r.entry].facts);
            let first = of(from.first()?);
            let with = from.iter().filter(|r| of(r) == first).count();
            (4 * with >= 3 * from.len()).then_some(first)
        };
        let night = agreed(&|f| usize::from(f.night)).map(|n| n == 1);
        let weather = agreed(&|f| f.weather);
        let chosen = &self.entries[from[Draw::new(seed, "retrieval").weighted(&weights)].entry];
        let mut counts = BTreeMap::new();
        for class in Class::OBJECTS
            .into_iter()
            .filter(|c| !open.counts.contains_key(c))
        {
            let of = |state: usize| {
                let mut n: Vec<usize> = from
                    .iter()
                    .map(|r| {
                        self.entries[r.entry]
                            .facts
                            .counts
                            .get(&class)
                            .map_or(0, |c| c[state])
                    })
                    .collect();
                n.sort_unstable();
                n[n.len() / 2]
            };
            let usual = [of(0), of(1), of(2)];
            if usual != [0; 3] {
                counts.insert(class, usual);
            }
        }
        let road_kind = open.road.unwrap_or(chosen.facts.road);
        let road = if chosen.facts.road == road_kind {
            chosen.road.clone()
        } else {
            RoadRef::Template {
                name: road_kind.template().into(),
                seed: hash(seed),
            }
        };
        Ok(Some(Proposal {
            from,
            road,
            road_kind,
            environment: open.environment.unwrap_or(chosen.facts.environment),
            night: open.night.or(night),
            weather: open.weather.or(weather),
            counts,
        }))
    }
}

/// Penalty for the contradictions between an entry and the prompt.
fn contradictions(open: &RetrievalQuery, facts: &Facts) -> f64 {
    let mut out = 0.0;
    let mut against = |says: bool, weight: f64| out += if says { weight } else { 0.0 };
    against(open.road.is_some_and(|r| r != facts.road), 0.5);
    against(open.environment.is_some_and(|e| e != facts.environment), 0.2);
    against(open.night.is_some_and(|n| n != facts.night), 0.05);
    against(open.weather.is_some_and(|w| w != facts.weather), 0.05);
    for (class, n) in &open.counts {
        against((*n > 0) != (facts.count(*class) > 0), 0.05);
    }
    out
}
