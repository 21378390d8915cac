//! Parts of a scene that memory fills in where a prompt leaves them open, with its notes on them.

use std::collections::BTreeMap;
use std::sync::Arc;

use serde::Serialize;

use super::How;
use crate::memory::own_scenes;
use graph_layout::facts::{self, RoadKind};
use graph_layout::memory::{RememberedScene, RetrievalQuery, RoadRef, SceneMemory};
use place::description::{Count, Description, Environment, ObjectSpec};
use scene::graph::ObjectState;
use scene::{BoxLabel, Class, TimeOfDay, Weather};

/// Most objects that memory adds.
const MOST_REMEMBERED: usize = 14;

/// Contributions of memory.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Remembered {
    /// The nearest scenes: a description of each, and its similarity (cosine).
    pub scenes: Vec<(String, f64)>,
    /// Parts that were filled in, in words.
    pub filled: Vec<String>,
    /// True if the road is a remembered one.
    pub road: bool,
    /// The nearest of the scenes as a whole.
    #[serde(skip)]
    pub nearest: Option<RememberedScene>,
}

pub(super) fn memory(how: &How) -> anyhow::Result<(Arc<SceneMemory>, Vec<String>)> {
    let bundled = SceneMemory::bundled()?;
    let Some(folder) = &how.own_scenes else {
        return Ok((bundled, Vec::new()));
    };
    let (own, problems) = own_scenes(folder);
    Ok((Arc::new(bundled.with(own)?), problems))
}

/// Fills open parts of a description from the nearest scenes. Returns the road that they propose.
pub(super) fn fill_in(
    memory: &SceneMemory,
    prompt: &str,
    d: &mut Description,
    seed: u64,
) -> anyhow::Result<Option<(Remembered, RoadRef)>> {
    let mut counts: BTreeMap<Class, usize> = BTreeMap::new();
    for o in &d.foreground {
        *counts.entry(o.class).or_insert(0) += o.count.n as usize;
    }
    for class in d.absent.iter().flat_map(|a| &a.classes) {
        counts.entry(*class).or_insert(0);
    }
    let open = RetrievalQuery {
        text: prompt.to_string(),
        road: d.road.kind.and_then(|k| RoadKind::of_template(k.name())),
        environment: d.environment.map(environment),
        night: d.time_of_day.map(|t| t == TimeOfDay::Night),
        weather: d.weather.and_then(weather_index),
        counts,
    };
    let Some(proposal) = memory.fill_in(&open, seed)? else {
        return Ok(None);
    };
    let mut filled = Vec::new();
    if let (None, Some(night)) = (d.time_of_day, proposal.night) {
        let time = if night { TimeOfDay::Night } else { TimeOfDay::Day };
        d.time_of_day = Some(time);
        filled.push(format!("time: {}", time.name()));
    }
    if let (None, Some(weather)) = (d.weather, proposal.weather) {
        d.weather = [
            Weather::Clear,
            Weather::Overcast,
            Weather::Rain,
            Weather::Snow,
            Weather::Fog,
        ]
        .get(weather)
        .copied();
        filled.extend(d.weather.map(|w| format!("weather: {}", w.name())));
    }
    // A prompt that states how busy it is, or that this is all, leaves no room for more objects.
    let mut room = if d.density.is_some() { 0 } else { MOST_REMEMBERED };
    for (class, by_state) in &proposal.counts {
        for (n, state) in
            by_state
                .iter()
                .zip([ObjectState::Moving, ObjectState::Parked, ObjectState::Waiting])
        {
            let n = (*n).min(room);
            if n == 0 {
                continue;
            }
            room -= n;
            let word = format!("{state:?}").to_lowercase();
            filled.push(format!("{n} x {} ({word})", class.label()));
            d.foreground.push(ObjectSpec {
                class: *class,
                count: Count::exactly(n as u32),
                state: Some(state),
                size: None,
                label: BoxLabel::default(),
                size_m: None,
                relations: Vec::new(),
                motion: None,
            });
        }
    }
    let scenes = proposal
        .from
        .iter()
        .map(|r| (memory.entries()[r.entry].text.clone(), r.similarity))
        .collect();
    Ok(Some((
        Remembered {
            scenes,
            filled,
            road: false,
            nearest: proposal.from.first().map(|r| memory.entries()[r.entry].clone()),
        },
        proposal.road,
    )))
}

/// The contributions that memory would make to a description; `None` without its weights.
pub fn recall(prompt: &str, description: &Description, seed: u64) -> Option<Remembered> {
    let (memory, _) = memory(&How::default()).ok()?;
    let (found, _) = fill_in(&memory, prompt, &mut description.clone(), seed).ok()??;
    Some(found)
}

fn environment(e: Environment) -> facts::Environment {
    match e {
        Environment::Downtown | Environment::Urban => facts::Environment::Downtown,
        Environment::Suburban => facts::Environment::Suburban,
        Environment::Residential => facts::Environment::Residential,
        Environment::Rural => facts::Environment::Rural,
        Environment::Highway => facts::Environment::Highway,
        Environment::Industrial => facts::Environment::Industrial,
        Environment::Nature => facts::Environment::Nature,
    }
}

fn weather_index(w: Weather) -> Option<usize> {
    [
        Weather::Clear,
        Weather::Overcast,
        Weather::Rain,
        Weather::Snow,
        Weather::Fog,
    ]
    .iter()
    .position(|x| *x == w)
}
