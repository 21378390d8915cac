//! The file of a sweep with some of its records changed.

use std::collections::BTreeMap;

use glam::DVec3;
use scene::{Pose, Provenance, SweepEdits, SyntheticReturn};

use super::records::NewRecord;
use super::{SweepFile, SweepFileKind, packed};

/// New returns by record.
type NewInSlots = BTreeMap<u32, Option<SyntheticReturn>>;

impl SweepFile<'_> {
    /// The bytes of the file after edits, and the origin of each of its records. Without edits the bytes are those of the file.
    /// A ray that meets something else keeps its record; a record without a return is emptied where the file has empty
    /// records, and left out where it has none; new ones come last.
    pub fn edited(&self, edits: &SweepEdits, file_from_world: &Pose) -> (Vec<u8>, Vec<Provenance>) {
        let count = self.records.count;
        if edits.is_empty() {
            return (self.bytes.to_vec(), vec![Provenance::Recorded; count]);
        }
        let empty = self.empty_place();
        let (mut records, mut origins) = (Vec::with_capacity(count), Vec::with_capacity(count));
        let mut put = |record: NewRecord, provenance: Provenance| {
            records.push(record);
            origins.push(provenance);
        };
        let (in_slots, behind) = self.slots(edits);
        for record in 0..count {
            let changed = edits.changed.get(&(record as u32));
            match changed.or(in_slots.get(&(record as u32))) {
                None => put(NewRecord::Kept(record), Provenance::Recorded),
                Some(Some(new)) => put(self.record(record, new, file_from_world), new.provenance),
                Some(None) => {
                    if let Some(at) = empty {
                        let strength = self.strength.map(|field| (field, 0.0));
                        let emptied = self.axes.iter().map(|axis| (*axis, at));
                        let values = emptied.chain(strength).collect();
                        put(NewRecord::Like(record, values), Provenance::Emptied);
                    }
                }
            }
        }
        for new in behind.into_iter().filter(|new| (new.like as usize) < count) {
            put(
                self.record(new.like as usize, new, file_from_world),
                new.provenance,
            );
        }
        let body = self.records.written(&records);
        let body = match self.kind {
            SweepFileKind::Pcd { is_packed: true, .. } => packed(&body),
            _ => body,
        };
        let head = self.head(records.len());
        ([head, body, self.records.after.to_vec()].concat(), origins)
    }

    /// New returns in the empty records where their rays belong, and those that come behind all records. In an organized cloud
    /// a return for which there is no record takes an empty one of its row, or is left out.
    fn slots<'e>(&self, edits: &'e SweepEdits) -> (NewInSlots, Vec<&'e SyntheticReturn>) {
        let row = match self.kind {
            SweepFileKind::Pcd { row, .. } => row,
            _ => None,
        };
        let (mut slots, mut behind) = (NewInSlots::new(), Vec::new());
        for new in &edits.added {
            let is_free = |slots: &NewInSlots, i: usize| {
                let is_new = !slots.contains_key(&(i as u32)) && i < self.records.count;
                is_new && self.is_empty(self.place(i))
            };
            let own = new.slot.filter(|slot| is_free(&slots, *slot as usize));
            let of_row = row.filter(|_| own.is_none()).and_then(|row| {
                let like = new.like as usize;
                let first = like / row.max(1) * row;
                let free = (first..first + row).filter(|i| is_free(&slots, *i));
                free.min_by_key(|i| i.abs_diff(like)).map(|slot| slot as u32)
            });
            match (own.or(of_row), row) {
                (Some(slot), _) => {
                    slots.insert(slot, Some(*new));
                }
                (None, None) => behind.push(new),
                (None, Some(_)) => {}
            }
        }
        (slots, behind)
    }

    fn is_empty(&self, at: DVec3) -> bool {
        !at.is_finite() || at.length() < super::NEAREST_M
    }

    fn record(&self, like: usize, new: &SyntheticReturn, file_from_world: &Pose) -> NewRecord {
        let at = file_from_world.apply(new.at_m).to_array();
        let place = self.axes.into_iter().zip(at);
        let strength = self.strength.filter(|_| new.strength.is_finite());
        let strength = strength.map(|field| (field, f64::from(new.strength)));
        let label = self.label.map(|field| (field, f64::from(new.class.id())));
        let farther = DVec3::from_array(at).length() / self.place(like).length();
        let ranges = self
            .ranges
            .iter()
            .map(|field| (*field, self.records.value(like, *field) * farther));
        let ranges = ranges.filter(|(_, range)| range.is_finite());
        NewRecord::Like(like, place.chain(strength).chain(label).chain(ranges).collect())
    }

    /// Coordinate of records without a return; `None` if the file has none of these.
    fn empty_place(&self) -> Option<f64> {
        let of_first = (0..self.records.count).map(|i| self.place(i));
        let first = of_first.into_iter().find(|at| self.is_empty(*at));
        let is_organized = matches!(self.kind, SweepFileKind::Pcd { row: Some(_), .. });
        match first {
            Some(at) if at.is_finite() => Some(0.0),
            Some(_) => Some(f64::NAN),
            None => is_organized.then_some(f64::NAN),
        }
    }

    /// The bytes before the records, with their number.
    fn head(&self, count: usize) -> Vec<u8> {
        let before = self.records.before;
        if count == self.records.count || self.kind == SweepFileKind::Scan {
            return before.to_vec();
        }
        let line = |line: &[u8]| {
            let text = String::from_utf8_lossy(line);
            let words: Vec<&str> = text.split_whitespace().collect();
            let ending = match text.ends_with("\r\n") {
                true => "\r\n",
                false => "\n",
            };
            let new = match (self.kind, words.as_slice()) {
                (SweepFileKind::Ply, ["element", "vertex", _]) => format!("element vertex {count}{ending}"),
                (SweepFileKind::Pcd { .. }, [key, ..]) => match key.to_uppercase().as_str() {
                    "WIDTH" | "POINTS" => format!("{key} {count}{ending}"),
                    "HEIGHT" => format!("{key} 1{ending}"),
                    _ => return line.to_vec(),
                },
                _ => return line.to_vec(),
            };
            new.into_bytes()
        };
        before.split_inclusive(|b| *b == b'\n').flat_map(line).collect()
    }
}
