//! Carries out a reading on a scene: act by act, each on the result of the one before.

mod adds;
mod changes;
mod crossing;
mod destinations;
mod motion;
mod moves;
mod road;
#[cfg(test)]
mod tests;

use super::check::look_again;
use super::nouns::Noun;
use super::reading::{ActKind, Amount, Feature, ObjectPhrase, Quantity, Reading};
use super::remark::Remark;
use super::resolve::{Spare, words_of};
use super::stage::{OpenScene, ReadingOutcome, Stage};
use scene::{BoxId, SceneBox, TimeOfDay, Weather};

/// Most acts that are carried out.
pub const MOST_ACTS: usize = 100;

/// The outcome of a reading in a scene; it is the same for the same reading, scene and seed.
pub fn carry_out(reading: &Reading, scene: &OpenScene<'_>, seed: u64) -> ReadingOutcome {
    let boxes: Vec<SceneBox> = scene.boxes.values().copied().collect();
    let with = crossing::with_crossing(reading, scene.layout, &boxes);
    let scene = OpenScene {
        layout: with.as_ref().map_or(scene.layout, |w| &w.layout),
        ..*scene
    };
    let mut stage = Stage::new(&scene, seed);
    stage.stays = stage.said_to_stay(reading);
    stage.crossing_of = with.as_ref().map(|w| w.act);
    for (i, act) in reading.acts.iter().enumerate() {
        stage.act = i;
        stage.out.done.resize(i + 1, super::stage::Done::default());
        if i >= MOST_ACTS {
            stage.remark(Remark::TooMuch);
            break;
        }
        let (before, asked) = (stage.out.edits.len(), stage.out.questions.len());
        let remarks = stage.out.remarks.len();
        if let Some(w) = with.as_ref().filter(|w| w.act == i) {
            stage.paint_crossing(w.outline_m.clone());
        }
        stage.act(&act.what, reading);
        let silent = stage.out.edits.len() == before
            && stage.out.questions.len() == asked
            && stage.out.remarks.len() == remarks;
        if silent && asked == 0 && !matches!(act.what, ActKind::Leave { .. }) {
            stage.remark(Remark::Already);
        }
    }
    look_again(&mut stage, reading);
    stage.out
}

impl Stage<'_> {
    fn act(&mut self, what: &ActKind, reading: &Reading) {
        match what {
            ActKind::Add { things } => self.add(things),
            ActKind::Remove { who } => self.remove(who),
            ActKind::No { who } => {
                for t in who {
                    let t = ObjectPhrase {
                        quantity: Quantity::All,
                        ..t.clone()
                    };
                    let spared = if t.other {
                        self.spoken_of(reading)
                    } else {
                        Vec::new()
                    };
                    let mut ids = self.fitting(&t);
                    ids.retain(|id| !spared.contains(id) && !self.stays.contains(id));
                    self.take(&ids);
                }
            }
            ActKind::Keep { who } => self.keep(who),
            ActKind::Leave { who } => {
                for t in who {
                    let ids = self.fitting(t);
                    if ids.is_empty() {
                        self.remark(Remark::Nobody { what: words_of(t) });
                    } else {
                        self.speak_of(&ids, Some(t.noun));
                    }
                }
            }
            ActKind::Replace { who, things } => self.replace(who, things),
            ActKind::Move { who, to } => self.moved(who, to),
            ActKind::Turn { who, turn } => self.turned(who, turn),
            ActKind::Set { who, traits } => self.set(who, traits),
            ActKind::Count { who, amount } => {
                for t in who {
                    self.count(t, *amount);
                }
            }
            ActKind::Swap { one, other } => self.swap(one, other),
            ActKind::Go { who, how } => self.go(who, how),
            ActKind::Length { seconds } => self.last_for(*seconds),
            ActKind::Time { what } => self.conditions(Some(*what), None),
            ActKind::Weather { what } => self.conditions(None, Some(*what)),
            ActKind::Has {
                what: Feature::Crossing,
                places,
            } => self.add_crossing(places),
            ActKind::Lacks {
                what: Feature::Crossing,
            } => self.erase_crossing(),
            ActKind::Has { .. }
            | ActKind::Lacks { .. }
            | ActKind::Road { .. }
            | ActKind::Lanes { .. }
            | ActKind::OneWay
            | ActKind::Narrow
            | ActKind::Wide
            | ActKind::OwnLane { .. } => self.change_road(what),
            ActKind::Env { .. } => self.remark(Remark::NotInEdits {
                what: "the surroundings",
            }),
            ActKind::Density { .. } => self.remark(Remark::NotInEdits {
                what: "how busy it is",
            }),
        }
    }

    fn take(&mut self, ids: &[BoxId]) {
        if !ids.is_empty() {
            self.gone.clear();
        }
        for id in ids {
            self.take_box(*id);
        }
    }

    fn remove(&mut self, who: &[ObjectPhrase]) {
        if let Some(ids) = self.those(who, Spare::Farthest) {
            self.take(&ids);
        }
    }

    /// Boxes that acts of the text state to stay, as far as they are known before the first act.
    fn said_to_stay(&self, reading: &Reading) -> std::collections::BTreeSet<BoxId> {
        let leaves = reading.acts.iter().filter_map(|a| match &a.what {
            ActKind::Leave { who } => Some(who),
            _ => None,
        });
        let known = |t: &&ObjectPhrase| !t.other && !matches!(t.noun, Noun::It | Noun::One);
        leaves
            .flatten()
            .filter(known)
            .flat_map(|t| self.fitting(t))
            .collect()
    }

    /// Boxes that other acts of the text mention.
    fn spoken_of(&self, reading: &Reading) -> Vec<BoxId> {
        let mut ids = self.last.clone();
        for a in &reading.acts {
            let who = match &a.what {
                ActKind::Leave { who }
                | ActKind::Keep { who }
                | ActKind::Set { who, .. }
                | ActKind::Move { who, .. } => who,
                _ => continue,
            };
            ids.extend(who.iter().flat_map(|t| self.fitting(t)));
        }
        for done in &self.out.done {
            ids.extend(&done.added);
            ids.extend(&done.changed);
        }
        ids
    }

    fn keep(&mut self, who: &[ObjectPhrase]) {
        // (with a number of a kind, that many of it stay)
        let Some(ids) = self.those(who, Spare::Nearest) else {
            return;
        };
        let others: Vec<BoxId> = self
            .boxes
            .keys()
            .filter(|id| !ids.contains(id) && !self.stays.contains(id))
            .copied()
            .collect();
        self.take(&others);
        self.last = ids;
    }

    fn count(&mut self, t: &ObjectPhrase, amount: Amount) {
        let fits = self.fitting(&ObjectPhrase {
            quantity: Quantity::All,
            ..t.clone()
        });
        let (least, most) = match amount {
            Amount::To(a, b) => (a as usize, b as usize),
            Amount::Times(f) => {
                let n = (fits.len() as f64 * f.clamp(0.0, 100.0)).round() as usize;
                (n, n)
            }
        };
        if fits.is_empty() && matches!(amount, Amount::Times(_)) {
            self.remark(Remark::Nobody { what: words_of(t) });
            return;
        }
        if fits.len() > most {
            let n = fits.len() - most;
            let which = ObjectPhrase {
                quantity: Quantity::N(n as u32),
                ..t.clone()
            };
            if let Some(gone) = self.that(&which, Spare::Farthest) {
                self.take(&gone);
            }
            self.last = fits
                .into_iter()
                .filter(|id| self.boxes.contains_key(id))
                .collect();
        } else if fits.len() < least {
            let n = (least - fits.len()).min(400) as u32;
            let new = ObjectPhrase {
                quantity: Quantity::N(n),
                ..t.clone()
            };
            self.add_like(&new, &fits);
        } else {
            self.last = fits;
        }
    }

    /// Sets another time of day or weather. The words of the style are changed accordingly, so that they never
    /// contradict it; its other words stay.
    fn conditions(&mut self, time: Option<TimeOfDay>, weather: Option<Weather>) {
        let mut conditions = self.conditions;
        conditions = time.map_or(conditions, |t| conditions.at(t));
        conditions = weather.map_or(conditions, |w| conditions.under(w));
        if conditions != self.conditions {
            self.set_conditions(conditions);
        }
        let mut words: Vec<&str> = self
            .prompt
            .split(',')
            .map(str::trim)
            .filter(|w| !w.is_empty())
            .collect();
        let is_time = |w: &str| TimeOfDay::ALL.iter().any(|t| t.name() == w);
        if let Some(time) = time {
            words.retain(|w| !is_time(w));
            words.insert(0, time.name());
        }
        if let Some(weather) = weather {
            words.retain(|w| !Weather::ALL.iter().any(|t| t.name() == *w));
            let at = usize::from(words.first().is_some_and(|w| is_time(w)));
            words.insert(at, weather.name());
        }
        let prompt = words.join(", ");
        if prompt != self.prompt {
            self.restyle(prompt);
        }
    }
}
