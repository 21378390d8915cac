//! Counts the voxels of objects, compares them with objects of their class in the same material, and tells which of
//! them the networks made.

use std::collections::BTreeMap;

use serde_json::{Value, json};

use super::trial_run::Brought;
use crate::suite::with_interval;
use job::request::voxels_of;
use numeric::quantile::{median, quantile};
use scene::{Class, Frame};

/// Voxels of the objects of each class.
#[derive(Default)]
pub struct Bands(BTreeMap<Class, Vec<f64>>);

impl Bands {
    /// Takes in the objects of a frame that its occupancy shows.
    pub fn add(&mut self, frame: &Frame) {
        for b in frame.boxes.values() {
            let n = voxels_of(&frame.occupancy, b);
            if n > 0 {
                self.0.entry(b.class).or_default().push(n as f64);
            }
        }
    }

    /// The 5th and 95th percentile.
    fn band(&self, class: Class) -> Option<[f64; 2]> {
        let all = self.0.get(&class)?;
        Some([quantile(all, 0.05), quantile(all, 0.95)])
    }

    /// Median, band and number of objects, by class.
    pub fn report(&self) -> Value {
        let each = self.0.iter().map(|(class, all)| {
            let band = self.band(*class);
            let report = json!({ "median": median(all), "p05_p95": band, "n": all.len() });
            (class.name().to_owned(), report)
        });
        each.collect()
    }
}

/// Objects that were added or moved, by class.
#[derive(Default)]
pub struct Fit(BTreeMap<Class, Vec<Brought>>);

impl Fit {
    /// Takes an object in.
    pub fn add(&mut self, brought: &Brought) {
        self.0.entry(brought.class).or_default().push(*brought);
    }

    /// Figures by class: voxels in the draft, of the networks and as shown; the share of the shown voxels that the
    /// networks made; the share of objects within the band of their class; and for moved objects the ratio of the
    /// number of voxels after to that before.
    pub fn report(&self, bands: &Bands) -> Value {
        let each = self.0.iter().map(|(class, all)| {
            let of = |f: &dyn Fn(&Brought) -> usize| all.iter().map(|b| f(b) as f64).collect::<Vec<_>>();
            let band = bands.band(*class);
            let within = |voxels: &[f64]| {
                let [low, high] = band?;
                let inside = voxels.iter().filter(|v| (low..=high).contains(*v));
                Some(inside.count() as f64 / voxels.len().max(1) as f64)
            };
            let (networks, shown) = (of(&|b| b.networks), of(&|b| b.shown));
            let theirs = all.iter().filter(|b| b.shown > 0);
            let theirs: Vec<f64> = theirs.map(|b| b.shared as f64 / b.shown as f64).collect();
            let drafts = all.iter().filter(|b| b.shown > 2 * b.shared);
            let mut report = json!({
                "n": all.len(),
                "voxels_of_draft": median(&of(&|b| b.draft)),
                "voxels_of_networks": median(&networks),
                "voxels_shown": median(&shown),
                "share_of_networks": with_interval(&theirs),
                "mostly_draft": drafts.count(),
                "band_p05_p95": band,
                "networks_within_band": within(&networks),
                "shown_within_band": within(&shown),
            });
            let moved = all.iter().filter_map(|b| Some((b, b.before.filter(|n| *n > 0)?)));
            let moved: Vec<(&Brought, usize)> = moved.collect();
            if !moved.is_empty() {
                let ratio = |f: &dyn Fn(&Brought) -> usize| {
                    let all: Vec<f64> = moved.iter().map(|(b, n)| f(b) as f64 / *n as f64).collect();
                    json!({ "median": median(&all), "p05": quantile(&all, 0.05), "p95": quantile(&all, 0.95), "most": quantile(&all, 1.0) })
                };
                report["times_its_voxels"] = json!({
                    "networks": ratio(&|b| b.networks),
                    "shown": ratio(&|b| b.shown),
                    "draft": ratio(&|b| b.draft),
                });
            }
            (class.name().to_owned(), report)
        });
        each.collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn truck(networks: usize, shown: usize, shared: usize) -> Brought {
        Brought {
            class: Class::Truck,
            before: Some(500),
            draft: 1470,
            networks,
            shown,
            shared,
        }
    }

    #[test]
    fn voxels_are_held_against_the_band_of_their_class() {
        let mut bands = Bands::default();
        bands
            .0
            .insert(Class::Truck, (0..100).map(|i| 400.0 + f64::from(i)).collect());
        let mut fit = Fit::default();
        fit.add(&truck(450, 450, 450));
        fit.add(&truck(20, 1470, 20));
        let report = fit.report(&bands);
        let truck = &report["truck"];
        assert_eq!(truck["shown_within_band"], 0.5);
        assert_eq!(truck["networks_within_band"], 0.5);
        assert_eq!((&truck["mostly_draft"], &truck["n"]), (&json!(1), &json!(2)));
        assert_eq!(truck["times_its_voxels"]["shown"]["most"], 2.94);
        assert_eq!(bands.report()["truck"]["p05_p95"], json!([404.0, 494.0]));
    }
}
