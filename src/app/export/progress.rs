//! Progress of an export.

use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};

use anyhow::bail;

use super::Format;
use formats::export::Product;
use scene::SensorRig;

/// Value of `baked` while no Gaussians are baked.
const NOT_BAKING: usize = usize::MAX;

/// Progress of an export and its cancel flag, shared between the thread that writes and the one that waits.
#[derive(Debug)]
pub struct ExportProgress {
    done: AtomicUsize,
    of: AtomicUsize,
    /// Progress of the Gaussians, percent.
    baked: AtomicUsize,
    cancelled: AtomicBool,
}

impl Default for ExportProgress {
    fn default() -> Self {
        Self {
            done: AtomicUsize::new(0),
            of: AtomicUsize::new(0),
            baked: AtomicUsize::new(NOT_BAKING),
            cancelled: AtomicBool::new(false),
        }
    }
}

/// True if a format takes pictures of every camera.
pub(super) fn takes_pictures(format: Format) -> bool {
    let pictures = [Product::CameraMaps, Product::Pictures, Product::Truth];
    format.needs.iter().any(|product| pictures.contains(product))
}

impl ExportProgress {
    /// Starts to count the pictures that these formats take, for one moment each.
    pub(super) fn begin(&self, formats: &[Format], rig: &SensorRig) {
        let pictures = formats.iter().filter(|f| takes_pictures(f)).count() * rig.cameras.len();
        self.done.store(0, Ordering::Relaxed);
        self.of.store(pictures, Ordering::Relaxed);
    }

    /// Sets how many pictures are ready, and of how many.
    pub fn count(&self, done: usize, of: usize) {
        self.done.store(done, Ordering::Relaxed);
        self.of.store(of, Ordering::Relaxed);
    }

    /// Adds pictures that turned out to be needed.
    pub(super) fn more(&self, pictures: usize) {
        self.of.fetch_add(pictures, Ordering::Relaxed);
    }

    /// Counts a picture that is ready.
    pub(super) fn made(&self) {
        self.done.fetch_add(1, Ordering::Relaxed);
    }

    /// Sets the progress of the Gaussians, 0 to 1. Returns whether to go on.
    pub(super) fn baking(&self, share: f32) -> bool {
        self.baked
            .store((share.clamp(0.0, 1.0) * 100.0) as usize, Ordering::Relaxed);
        !self.is_cancelled()
    }

    /// Notes that the Gaussians are ready.
    pub(super) fn baked(&self) {
        self.baked.store(NOT_BAKING, Ordering::Relaxed);
    }

    /// Asks the export to stop. It stops before its next picture and writes no file.
    pub fn cancel(&self) {
        self.cancelled.store(true, Ordering::Relaxed);
    }

    /// True if the export was asked to stop.
    pub fn is_cancelled(&self) -> bool {
        self.cancelled.load(Ordering::Relaxed)
    }

    /// Number of pictures that are ready, and of all pictures; `None` if there are none to count. The number for a clip
    /// is known once its second moment begins.
    pub fn pictures(&self) -> Option<(usize, usize)> {
        let of = self.of.load(Ordering::Relaxed);
        (of > 0).then(|| (self.done.load(Ordering::Relaxed), of))
    }

    /// Progress of the Gaussians that are baked now, percent.
    pub fn baked_percent(&self) -> Option<usize> {
        let percent = self.baked.load(Ordering::Relaxed);
        (percent != NOT_BAKING).then_some(percent)
    }

    pub(super) fn go_on(&self) -> anyhow::Result<()> {
        match self.is_cancelled() {
            true => bail!("cancelled"),
            false => Ok(()),
        }
    }
}
