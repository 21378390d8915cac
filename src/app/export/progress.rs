//! How far an export is.

use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};

use anyhow::bail;

use super::Format;
use formats::export::Product;
use scene::SensorRig;

/// Written while nothing is baked.
const NOT_BAKING: usize = usize::MAX;

/// How far an export has come, and whether it is still wanted. Shared between the one who writes and the one who waits.
#[derive(Debug)]
pub struct ExportProgress {
    done: AtomicUsize,
    of: AtomicUsize,
    /// How far the Gaussians are, percent.
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
    /// Begins to count what these formats take, of one moment each.
    pub(super) fn begin(&self, formats: &[Format], rig: &SensorRig) {
        let pictures = formats.iter().filter(|f| takes_pictures(f)).count() * rig.cameras.len();
        self.done.store(0, Ordering::Relaxed);
        self.of.store(pictures, Ordering::Relaxed);
    }

    /// Says how many pictures are ready, of how many.
    pub fn count(&self, done: usize, of: usize) {
        self.done.store(done, Ordering::Relaxed);
        self.of.store(of, Ordering::Relaxed);
    }

    /// So many pictures more are to be made than was known.
    pub(super) fn more(&self, pictures: usize) {
        self.of.fetch_add(pictures, Ordering::Relaxed);
    }

    /// A picture is ready.
    pub(super) fn made(&self) {
        self.done.fetch_add(1, Ordering::Relaxed);
    }

    /// Says how far the Gaussians are, 0 to 1, and whether to go on.
    pub(super) fn baking(&self, share: f32) -> bool {
        self.baked
            .store((share.clamp(0.0, 1.0) * 100.0) as usize, Ordering::Relaxed);
        !self.is_cancelled()
    }

    /// The Gaussians are ready.
    pub(super) fn baked(&self) {
        self.baked.store(NOT_BAKING, Ordering::Relaxed);
    }

    /// Asks the export to stop; it does before its next picture, and writes nothing.
    pub fn cancel(&self) {
        self.cancelled.store(true, Ordering::Relaxed);
    }

    /// True once it was asked to stop.
    pub fn is_cancelled(&self) -> bool {
        self.cancelled.load(Ordering::Relaxed)
    }

    /// Pictures that are ready, of how many; none while there is nothing to count. Of a clip it is known how many there are once
    /// its second moment begins.
    pub fn pictures(&self) -> Option<(usize, usize)> {
        let of = self.of.load(Ordering::Relaxed);
        (of > 0).then(|| (self.done.load(Ordering::Relaxed), of))
    }

    /// How far Gaussians are that are baked now, percent.
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
