//! `sceneloom dataset pictures --from`: the user's own recordings, as data to train the networks that draw pictures on.

use std::collections::BTreeMap;
use std::ops::Range;
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, PoisonError};

use anyhow::{Context, bail};

use dataset::picture_pairs::{MOMENTS, PicturePair, Recorded, recorded_pair};
use dataset::{self, DatasetReport};
use formats::import::nuscenes::pictures::{PictureDrive, PictureFolder, pixels};

/// Drives that are kept while their pairs are made.
const KEPT: usize = 2;

/// Pairs of key frames that follow each other, of some drives of a folder.
pub(super) struct Pairs {
    folder: PictureFolder,
    /// Drive and first moment of each.
    places: Vec<[usize; 2]>,
    size_px: [u32; 2],
    kept: Mutex<BTreeMap<usize, Arc<PictureDrive>>>,
}

impl Pairs {
    /// Opens the pairs of some drives, or of all; the first so many pairs, or all. Errors if the folder has fewer, or
    /// none.
    pub(super) fn open(
        from: &Path,
        (drives, frames): (Option<Range<usize>>, Option<usize>),
        size_px: [u32; 2],
    ) -> anyhow::Result<Self> {
        let folder = PictureFolder::open(from)?;
        let counts: Vec<usize> = folder.drives().collect();
        let range = drives.unwrap_or(0..counts.len());
        if range.is_empty() || range.end > counts.len() {
            bail!(
                "--drives is {}..{}, expected some of 0..{}, the drives of the folder by name",
                range.start,
                range.end,
                counts.len()
            );
        }
        let of_drive = |drive: usize| (0..counts[drive].saturating_sub(1)).map(move |first| [drive, first]);
        let mut places: Vec<[usize; 2]> = range.flat_map(of_drive).collect();
        if places.is_empty() {
            bail!(
                "{}: no key frame with pictures follows another, expected drives",
                from.display()
            );
        }
        let found = places.len();
        let frames = frames.unwrap_or(found);
        if frames > found || frames == 0 {
            bail!(
                "--frames is {frames}, expected 1 to {found}, the pairs of key frames that follow each other"
            );
        }
        places.truncate(frames);
        Ok(Self {
            places,
            folder,
            size_px,
            kept: Mutex::default(),
        })
    }

    fn drive(&self, which: usize) -> anyhow::Result<Arc<PictureDrive>> {
        let mut kept = self.kept.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(drive) = kept.get(&which) {
            return Ok(drive.clone());
        }
        let drive = Arc::new(self.folder.drive(which)?);
        // Pairs are made in order, so the drive before all others is done with.
        while kept.len() >= KEPT {
            kept.pop_first();
        }
        kept.insert(which, drive.clone());
        Ok(drive)
    }

    fn make(&self, index: usize) -> anyhow::Result<PicturePair> {
        let [which, first] = self.places[index];
        let drive = self.drive(which)?;
        let pair = drive.moments.get(first..first + MOMENTS);
        let pair = pair.with_context(|| format!("drive {which}: a camera without sound intrinsics"))?;
        let scenes = [0, 1].map(|i| drive.scene.at(pair[i].time_s));
        let rgb = |i: usize| -> anyhow::Result<Vec<Vec<u8>>> {
            let of = |file: &PathBuf| Ok(pixels(file, self.size_px)?);
            pair[i].files.iter().map(of).collect()
        };
        let [a, b] = [rgb(0)?, rgb(1)?];
        let taken = |i: usize, rgb| Recorded {
            frame: scenes[i].frame(),
            rig: &pair[i].rig,
            rgb,
        };
        Ok(recorded_pair(
            [taken(0, a), taken(1, b)],
            drive.scene.conditions,
            self.size_px,
        ))
    }

    /// How many there are.
    pub(super) fn count(&self) -> usize {
        self.places.len()
    }

    /// Writes shards of all pairs; also returns how many key frames of the folder lack pictures.
    pub(super) fn write(
        &self,
        output: &Path,
        step: impl Fn(usize) -> bool + Sync,
    ) -> anyhow::Result<(DatasetReport, usize)> {
        let report = dataset::write(output, self.count(), |i| self.make(i), step)?;
        Ok((report, self.folder.incomplete))
    }
}
