//! Label sets of data sets, and the labels of a scene that was opened from one.

use std::sync::Arc;

use super::{Class, Extent, VoxelGrid};

/// A label of a data set.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct LabelRow {
    /// Its number in files.
    pub label: u16,
    /// Its name there.
    pub name: &'static str,
    /// The class that its voxels are shown and edited as.
    pub class: Class,
}

/// The labels of a data set. A set is one table of [`label_sets`](crate::label_sets).
#[derive(Debug, PartialEq, Eq)]
pub struct LabelSet {
    /// Name in project files.
    pub id: &'static str,
    /// Name for a person.
    pub title: &'static str,
    /// Its labels, ascending by number.
    pub rows: &'static [LabelRow],
    /// The label that each class is written as, by class id.
    pub written: [u16; Class::COUNT],
}

impl LabelSet {
    fn row(&self, label: u16) -> Option<&LabelRow> {
        let at = self.rows.binary_search_by_key(&label, |row| row.label).ok()?;
        self.rows.get(at)
    }

    /// The class of a label; `None` for a number that no label has.
    pub fn class(&self, label: u16) -> Option<Class> {
        self.row(label).map(|row| row.class)
    }

    /// The class that voxels of a label are shown as; others for a number that no label has.
    pub fn shown(&self, label: u16) -> Class {
        self.class(label).unwrap_or(Class::Others)
    }

    /// Name of a label; `None` for a number that no label has.
    pub fn name(&self, label: u16) -> Option<&'static str> {
        self.row(label).map(|row| row.name)
    }

    /// The label that a class is written as.
    pub fn label(&self, class: Class) -> u16 {
        self.written[usize::from(class.id())]
    }

    /// The labels whose classes have other names, for a person: `vehicle as car; sign, pole as manmade`.
    pub fn renamed(&self) -> String {
        let mut groups: Vec<(Class, Vec<&str>)> = Vec::new();
        let other = |row: &&LabelRow| row.name != row.class.name() && row.class != Class::Free;
        for row in self.rows.iter().filter(other) {
            match groups.iter_mut().find(|(class, _)| *class == row.class) {
                Some((_, names)) => names.push(row.name),
                None => groups.push((row.class, vec![row.name])),
            }
        }
        let words = groups
            .iter()
            .map(|(class, names)| format!("{} as {}", names.join(", "), class.label()));
        words.collect::<Vec<_>>().join("; ")
    }

    /// All labels of files in words, for a message: `0 to 14, 23`.
    pub fn numbers(&self) -> String {
        let mut runs: Vec<[u16; 2]> = Vec::new();
        for row in self.rows {
            match runs.last_mut() {
                Some(run) if run[1] + 1 == row.label => run[1] = row.label,
                _ => runs.push([row.label; 2]),
            }
        }
        let words = runs.iter().map(|[low, high]| match low == high {
            true => low.to_string(),
            false => format!("{low} to {high}"),
        });
        words.collect::<Vec<_>>().join(", ")
    }
}

/// Labels of a data set on a map, where they say more than the class of the voxel. No edit changes them: where an edit changed
/// the class, they no longer count.
#[derive(Clone, Debug, PartialEq)]
pub struct DataLabels {
    set: &'static LabelSet,
    extent: Extent,
    /// Label of free voxels in this file.
    free: u16,
    /// Numbers of voxels, `[x][y][z]`, ascending, with labels that differ from what their class is written as.
    special: Arc<[(u32, u16)]>,
}

impl DataLabels {
    /// Labels of voxels of a map, in any order; the last one counts where a voxel has two. Voxels beyond the map are left out,
    /// labels that no row has are kept.
    pub fn new(
        set: &'static LabelSet,
        extent: Extent,
        free: u16,
        labels: impl IntoIterator<Item = ([usize; 3], u16)>,
    ) -> Self {
        let [nx, ny, nz] = extent.shape();
        let inside = |[x, y, z]: [usize; 3]| x < nx && y < ny && z < nz;
        let on_map = labels.into_iter().filter(|(at, _)| inside(*at));
        let mut all: Vec<(u32, u16)> = on_map.map(|(at, label)| (number(extent, at), label)).collect();
        all.sort_by_key(|(at, _)| *at); // stable
        let mut out = Self {
            set,
            extent,
            free,
            special: Arc::default(),
        };
        let is_last = |i: usize| all.get(i + 1).is_none_or(|next| next.0 != all[i].0);
        let says_more = |label: u16| out.usual(set.shown(label)) != label;
        let special = (0..all.len()).filter(|i| is_last(*i) && says_more(all[*i].1));
        let special = special.map(|i| all[i]).collect();
        out.special = special;
        out
    }

    /// The labels with other ones for some voxels; the last one counts where a voxel has two.
    pub fn with(&self, labels: impl IntoIterator<Item = ([usize; 3], u16)>) -> Self {
        Self::new(self.set, self.extent, self.free, self.special().chain(labels))
    }

    /// Labels by the numbers of voxels `[x][y][z]`, as [`numbered`](Self::numbered) gives them; `None` unless they ascend, are of
    /// the map and say more than the class.
    pub fn from_numbered(
        set: &'static LabelSet,
        extent: Extent,
        free: u16,
        numbered: Vec<(u32, u16)>,
    ) -> Option<Self> {
        let out = Self {
            set,
            extent,
            free,
            special: numbered.into(),
        };
        let ascend = out.special.is_sorted_by(|a, b| a.0 < b.0);
        let inside = out
            .special
            .last()
            .is_none_or(|(at, _)| (*at as usize) < extent.voxels());
        // (a set that writes nothing for free voxels has no such row)
        let is_free = set.class(free).is_none_or(|class| class == Class::Free);
        let say_more = out
            .special
            .iter()
            .all(|(_, label)| out.usual(set.shown(*label)) != *label);
        (ascend && inside && say_more && is_free).then_some(out)
    }

    /// Labels that say more than the class, by the numbers of their voxels `[x][y][z]`, ascending.
    pub fn numbered(&self) -> &[(u32, u16)] {
        &self.special
    }

    /// The label that voxels of a class have in this file, if nothing more is known.
    pub fn usual(&self, class: Class) -> u16 {
        match class {
            Class::Free => self.free,
            class => self.set.label(class),
        }
    }

    /// The set that they are of.
    pub fn set(&self) -> &'static LabelSet {
        self.set
    }

    /// Part of the ground that they cover.
    pub fn extent(&self) -> Extent {
        self.extent
    }

    /// Label of free voxels.
    pub fn free(&self) -> u16 {
        self.free
    }

    /// Voxels with labels that say more than their class, ascending `[x][y][z]`.
    pub fn special(&self) -> impl ExactSizeIterator<Item = ([usize; 3], u16)> + '_ {
        self.special
            .iter()
            .map(|(at, label)| (place(self.extent, *at), *label))
    }

    /// The label of a voxel that is now of a class: the data set's own while an edit has not changed the class.
    pub fn label(&self, voxel: [usize; 3], class: Class) -> u16 {
        let at = number(self.extent, voxel);
        let found = self.special.binary_search_by_key(&at, |(at, _)| *at).ok();
        let label = found.map(|i| self.special[i].1);
        let still = label.filter(|label| self.set.shown(*label) == class);
        still.unwrap_or_else(|| self.usual(class))
    }

    /// Labels of all voxels of a grid of the same extent, `[x][y][z]`.
    pub fn dense(&self, grid: &VoxelGrid) -> Vec<u16> {
        let usual = Class::ALL.map(|class| self.usual(class));
        let mut out = vec![self.free; self.extent.voxels()];
        for (x, y, z, class) in grid.iter_set() {
            let label = usual.get(usize::from(class)).copied().unwrap_or(self.free);
            out[number(self.extent, [x, y, z]) as usize] = label;
        }
        for (at, label) in self.special.iter() {
            let [x, y, z] = place(self.extent, *at);
            if self.set.shown(*label).id() == grid.get(x, y, z) {
                out[*at as usize] = *label;
            }
        }
        out
    }

    /// The part of them that lies in another extent of the same lattice.
    pub fn crop(&self, extent: Extent) -> Self {
        if extent == self.extent {
            return self.clone();
        }
        if extent.lattice() != self.extent.lattice() {
            return Self::new(self.set, extent, self.free, []);
        }
        let (old, new) = (self.extent.from(), extent.from());
        let shifted = |at: usize, axis: usize| usize::try_from(at as i32 + old[axis] - new[axis]).ok();
        let moved = self.special().filter_map(|([x, y, z], label)| {
            let at = [shifted(x, 0)?, shifted(y, 1)?, z];
            Some((at, label))
        });
        Self::new(self.set, extent, self.free, moved)
    }

    /// The same on a map that was moved as a whole, voxel for voxel; `None` unless it has as many voxels.
    pub fn on(&self, extent: Extent) -> Option<Self> {
        (extent.shape() == self.extent.shape()).then(|| Self {
            extent,
            ..self.clone()
        })
    }
}

fn number(extent: Extent, [x, y, z]: [usize; 3]) -> u32 {
    (extent.index(x, y) * extent.nz() + z) as u32
}

fn place(extent: Extent, number: u32) -> [usize; 3] {
    let number = number as usize;
    let [x, y] = extent.column(number / extent.nz());
    [x, y, number % extent.nz()]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Lattice;
    use crate::label_sets::{NUPLAN_OCC, SEMANTIC_KITTI};

    fn extent() -> Extent {
        let lattice = Lattice::new(0.2, 32, -0.4).expect("sound");
        Extent::over(lattice, [0, -8], [16, 16]).expect("sound")
    }

    #[test]
    fn a_label_stays_until_the_class_changes() {
        let (trunk, fence, moving) = (71, 51, 252);
        let unknown = [([4, 4, 4], 7)];
        let given = [
            ([1, 2, 3], trunk),
            ([1, 2, 4], fence),
            ([15, 15, 31], moving),
            ([16, 0, 0], fence),
        ];
        let found = DataLabels::new(&SEMANTIC_KITTI, extent(), 0, given.into_iter().chain(unknown));
        assert_eq!(found.special().len(), 4, "one lies beyond the map");
        assert_eq!(
            found.label([4, 4, 4], Class::Others),
            7,
            "a number without a name stays"
        );
        assert_eq!(found.label([1, 2, 3], Class::Vegetation), trunk);
        assert_eq!(
            found.label([1, 2, 3], Class::Manmade),
            50,
            "a building was painted"
        );
        assert_eq!(found.label([1, 2, 5], Class::Manmade), 50);
        let mut grid = VoxelGrid::over(extent());
        grid.set(1, 2, 3, Class::Vegetation.id());
        grid.set(1, 2, 4, Class::Car.id());
        grid.set(15, 15, 31, Class::Car.id());
        let dense = found.dense(&grid);
        let at = |voxel| dense[number(extent(), voxel) as usize];
        assert_eq!(
            [at([1, 2, 3]), at([1, 2, 4]), at([15, 15, 31]), at([0, 0, 0])],
            [trunk, 10, moving, 0]
        );
        assert_eq!(dense.iter().filter(|label| **label != 0).count(), 3);
    }

    #[test]
    fn numbered_labels_are_checked() {
        let read = |set, free, of: &[(u32, u16)]| DataLabels::from_numbered(set, extent(), free, of.to_vec());
        let last = extent().voxels() as u32 - 1;
        assert!(read(&SEMANTIC_KITTI, 0, &[(3, 51), (last, 71)]).is_some());
        assert!(read(&NUPLAN_OCC, 8, &[(3, 5)]).is_some());
        for of in [[(3, 51), (3, 71)], [(4, 51), (3, 71)], [(3, 51), (last + 1, 71)]] {
            assert_eq!(read(&SEMANTIC_KITTI, 0, &of), None, "{of:?}");
        }
        assert_eq!(read(&SEMANTIC_KITTI, 0, &[(3, 10)]), None, "no more than a car");
        assert_eq!(read(&SEMANTIC_KITTI, 10, &[]), None, "free is no car");
    }

    #[test]
    fn a_crop_keeps_what_lies_in_it() {
        let found = DataLabels::new(&SEMANTIC_KITTI, extent(), 0, [([1, 2, 3], 71), ([9, 2, 3], 51)]);
        let part = extent().with_columns([4, -8], [12, 16]).expect("sound");
        let cropped = found.crop(part);
        assert_eq!(cropped.special().collect::<Vec<_>>(), [([5, 2, 3], 51)]);
        assert_eq!(
            cropped.crop(extent()).special().collect::<Vec<_>>(),
            [([9, 2, 3], 51)]
        );
        assert_eq!(found.on(part), None);
    }
}
