//! Parts of a frame from a data set that were guessed because the data set does not carry them.

use std::collections::BTreeSet;
use std::sync::Arc;

use super::{BoxId, DataLabels, Extent, Recorded, Window};

/// Bit beside the 16 bits of a column's observed bins in the networks' window: set if these are known. A column of 0 is
/// unknown.
pub const KNOWN: u32 = 1 << Window::NZ;

/// Voxels that no sensor of a data set observed: free there means unknown. One word per column `[x][y]` of a map, one
/// bit per bin.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Unobserved {
    extent: Extent,
    words: Arc<[u64]>,
}

impl Unobserved {
    /// The unobserved voxels of a window, from flags of what was observed, `[x][y][z]`; `None` unless there is one flag
    /// per voxel.
    pub fn from_observed(observed: &[bool]) -> Option<Self> {
        let word = |column: &[bool]| {
            let bits = column.iter().enumerate().filter(|(_, seen)| !**seen);
            bits.fold(0, |word, (z, _)| word | 1 << z)
        };
        (observed.len() == Extent::WINDOW.voxels()).then(|| Self {
            extent: Extent::WINDOW,
            words: observed.chunks_exact(Window::NZ).map(word).collect(),
        })
    }

    /// The unobserved voxels of a map, from its words; `None` unless there is one per column.
    pub fn from_words(extent: Extent, mut words: Vec<u64>) -> Option<Self> {
        let all = extent.lattice().all_bins();
        words.iter_mut().for_each(|word| *word &= all);
        (words.len() == extent.columns()).then(|| Self {
            extent,
            words: words.into(),
        })
    }

    /// The part of it that lies in another extent; all is observed where this one has no columns.
    pub fn crop(&self, extent: Extent) -> Self {
        if extent == self.extent {
            return self.clone();
        }
        Self {
            extent,
            words: extent.crop(&self.extent, &self.words, 0).into(),
        }
    }

    /// Which part of the ground it covers.
    pub fn extent(&self) -> Extent {
        self.extent
    }

    /// One word per column, `[x][y]`.
    pub fn words(&self) -> &[u64] {
        &self.words
    }

    /// The observed voxels of the networks' window: per column `[x][y]` one bit per bin and [`KNOWN`].
    pub fn observed(&self) -> Vec<u32> {
        let observed = |word: &u64| u32::from(!*word as u16) | KNOWN;
        self.words.iter().map(observed).collect()
    }

    /// Share of a column's bins that nothing observed, 0 to 1.
    pub fn share(&self, x: usize, y: usize) -> f64 {
        f64::from(self.words[self.extent.index(x, y)].count_ones()) / self.extent.nz() as f64
    }

    /// Share of all voxels that nothing observed, 0 to 1.
    pub fn total(&self) -> f64 {
        let bits: u32 = self.words.iter().map(|w| w.count_ones()).sum();
        f64::from(bits) / self.extent.voxels() as f64
    }
}

/// Guesses of a frame. A box that the user edits or corrects (`Edit::Correct`) is no longer a guess; the map layers are
/// guesses until the user confirms them.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Inferred {
    /// True if the map layers were read off ground voxels.
    pub layout: bool,
    /// Boxes that were fitted to voxels and not changed since.
    pub boxes: BTreeSet<BoxId>,
    /// True if the things of the background were fitted to voxels.
    pub background: bool,
    /// Voxels that the data set's masks mark as unobserved, if it has masks.
    pub unobserved: Option<Unobserved>,
    /// Labels of the data set where they say more than the class of the voxel, if it has such.
    pub data_labels: Option<DataLabels>,
    /// Parts that are as a recording has them: neither guesses nor mistakes of a designer.
    pub recorded: Arc<Recorded>,
}

impl Inferred {
    /// True if any guess is left.
    pub fn any(&self) -> bool {
        self.layout || self.background || !self.boxes.is_empty()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn unobserved_is_what_was_not_observed() {
        let mut observed = vec![true; Window::VOXELS];
        observed[(3 * Window::NY + 5) * Window::NZ + 2] = false;
        observed[(3 * Window::NY + 5) * Window::NZ + 15] = false;
        let found = Unobserved::from_observed(&observed).expect("one flag per voxel");
        assert_eq!(found.words()[3 * Window::NY + 5], 1 << 2 | 1 << 15);
        assert_eq!((found.share(3, 5), found.share(3, 6)), (0.125, 0.0));
        let told = found.observed();
        assert_eq!(told[3 * Window::NY + 5], KNOWN | 0x7ffb);
        assert_eq!(told[0], KNOWN | 0xffff);
        assert_eq!(found.total(), 2.0 / Window::VOXELS as f64);
        assert_eq!(
            Unobserved::from_words(Extent::WINDOW, found.words().to_vec()),
            Some(found)
        );
        assert_eq!(Unobserved::from_observed(&observed[1..]), None);
        assert_eq!(Unobserved::from_words(Extent::WINDOW, vec![0; 3]), None);
    }
}
