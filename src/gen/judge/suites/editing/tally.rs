//! Success and invented voxels of edits of one kind, over all scenes.

use std::collections::BTreeMap;

use serde_json::{Value, json};

use super::trial_run::{STATES, Tried};
use crate::suite::with_interval;
use metrics::stats::mean_ci95;
use scene::Class;

/// More invented voxels than this would be noticed as a thing.
pub const MUCH: usize = 20;

/// Figures of one state.
#[derive(Default)]
struct StateFigures {
    success: Vec<f64>,
    invented: Vec<f64>,
    apart: Vec<f64>,
    much: Vec<f64>,
    by_class: [usize; Class::COUNT],
    into_unobserved: usize,
}

/// Edits of one kind with one preset.
#[derive(Default)]
pub struct InventionTally([StateFigures; 3]);

impl InventionTally {
    /// Takes an edit in.
    pub fn add(&mut self, tried: &Tried) {
        for (i, state) in self.0.iter_mut().enumerate() {
            let found = &tried.invented[i];
            state
                .success
                .push(f64::from(u8::from(tried.reached[i].success())));
            state.invented.push(found.total() as f64);
            state.apart.push(found.apart as f64);
            state.much.push(f64::from(u8::from(found.total() > MUCH)));
            state.into_unobserved += found.into_unobserved;
            let classes = state.by_class.iter_mut().zip(found.by_class);
            classes.for_each(|(sum, n)| *sum += n);
        }
    }

    /// Mean number of invented voxels per edit, and share of edits that invent much, of one of [`STATES`].
    pub fn invents(&self, state: usize) -> (f64, f64) {
        let s = &self.0[state];
        (mean_ci95(&s.invented).0, mean_ci95(&s.much).0)
    }

    /// Figures by state.
    pub fn report(&self) -> Value {
        let each = STATES.iter().zip(&self.0).map(|(name, s)| {
            let by_class: BTreeMap<&str, usize> = Class::ALL
                .iter()
                .zip(s.by_class)
                .filter(|(_, n)| *n > 0)
                .map(|(c, n)| (c.name(), n))
                .collect();
            let report = json!({
                "success": with_interval(&s.success),
                "invented": with_interval(&s.invented),
                "invented_most": s.invented.iter().fold(0.0, |m: f64, v| m.max(*v)),
                "invented_apart": with_interval(&s.apart),
                "invent_much": with_interval(&s.much),
                "by_class": by_class,
                "into_unobserved": s.into_unobserved,
            });
            ((*name).to_owned(), report)
        });
        each.collect()
    }
}
