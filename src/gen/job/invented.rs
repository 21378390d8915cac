//! Voxels that an edit invented: above the ground in the edited region, and in neither the source nor the request.

use crate::region::Region;
use crate::request::VoxelRequest;
use scene::{Class, Frame, VoxelGrid, Window};

/// Counts of one edit, in voxels.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Invented {
    /// Invented voxels by class id: they stand above the ground, the source did not hold their label there, and they
    /// belong to no box or paint of the user.
    pub by_class: [usize; Class::COUNT],
    /// Number of those that have no voxel of their class within one voxel in the source: new things rather than edges
    /// of old ones that moved a little.
    pub apart: usize,
    /// Voxels, ground included, that were put where the source was free and no sensor had observed anything, outside
    /// the columns that the user edited.
    pub into_unobserved: usize,
}

impl Invented {
    /// Counts the invented voxels of an edited frame with its occupancy after the edit; only the region's columns
    /// count.
    pub fn count(frame: &Frame, after: &VoxelGrid, region: &Region) -> Self {
        Self::of_request(&VoxelRequest::from_frame(frame), frame, after, region)
    }

    /// Counts as [`count`](Self::count), with a given request.
    pub fn of_request(request: &VoxelRequest<'_>, frame: &Frame, after: &VoxelGrid, region: &Region) -> Self {
        let source = &frame.source.occupancy;
        let mut out = Self::default();
        request.each_invented(after, region, |x, y, z, label| {
            if let Some(count) = out.by_class.get_mut(usize::from(label)) {
                *count += 1;
            }
            out.apart += usize::from(!is_near(source, [x, y, z], label));
        });
        let Some(unobserved) = &frame.inferred.unobserved else {
            return out;
        };
        for (c, _) in region.columns.iter().enumerate().filter(|(_, c)| **c) {
            let (word, (x, y)) = (unobserved.words()[c], (c / Window::NY, c % Window::NY));
            if word == 0 || request.edited(c) {
                continue;
            }
            let labels = source.column(x, y).iter().zip(after.column(x, y));
            out.into_unobserved += labels
                .enumerate()
                .filter(|(z, (before, now))| {
                    let filled = **before == Class::FREE && **now != Class::FREE;
                    filled && word >> z & 1 == 1 && !request.holds(x, y, *z, **now)
                })
                .count();
        }
        out
    }

    /// Number of invented voxels of all classes.
    pub fn total(&self) -> usize {
        self.by_class.iter().sum()
    }
}

/// True if a voxel of the label lies within one voxel of a place.
fn is_near(grid: &VoxelGrid, [x, y, z]: [usize; 3], label: u8) -> bool {
    let span = |v: usize, n: usize| v.saturating_sub(1)..(v + 2).min(n);
    span(x, Window::NX)
        .any(|i| span(y, Window::NY).any(|j| grid.column(i, j)[span(z, Window::NZ)].contains(&label)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::request::tests::removal;
    use scene::{Unobserved, draft};

    /// A tree of 8 voxels planted by hand where the car was is what is counted, and nothing else.
    #[test]
    fn a_planted_tree_is_counted() {
        let frame = removal();
        let region = Region::of_edit(&frame, 2);
        let clean = draft::draft(&frame.layout, frame.boxes.values());
        assert_eq!(Invented::count(&frame, &clean, &region), Invented::default());
        let [x, y] = Window::column_at(10.0, 0.0).expect("inside");
        let mut planted = clean.clone();
        (0..8).for_each(|z| planted.set(x, y, z, Class::Vegetation.id()));
        let found = Invented::count(&frame, &planted, &region);
        assert_eq!((found.total(), found.apart), (8, 8));
        assert_eq!(found.by_class[usize::from(Class::Vegetation.id())], 8);
        // Where the source has a hedge beside it, one voxel of it more is an edge that moved, two are a new thing.
        let mut grown = frame.clone();
        let mut source = (*grown.source).clone();
        (0..8).for_each(|z| source.occupancy.set(x, y + 1, z, Class::Vegetation.id()));
        grown.source = std::sync::Arc::new(source);
        let mut after = planted.clone();
        after.set(x, y - 1, 3, Class::Vegetation.id());
        let found = Invented::count(&grown, &after, &region);
        assert_eq!((found.total(), found.apart), (9, 1));
        // What is left of the car itself is no invention, another class in its place is.
        let mut stayed = frame.source.occupancy.clone();
        assert_eq!(Invented::count(&frame, &stayed, &region).total(), 0);
        stayed.set(x, y, 2, Class::Truck.id());
        assert_eq!(Invented::count(&frame, &stayed, &region).total(), 1);
        // Outside the region it is not this edit's doing.
        let mut far = clean.clone();
        far.set(0, 0, 3, Class::Vegetation.id());
        assert_eq!(Invented::count(&frame, &far, &region).total(), 0);
    }

    #[test]
    fn voxels_put_where_nobody_looked_are_counted() {
        let mut frame = removal();
        let region = Region::of_edit(&frame, 2);
        // A column of the region beside what was edited: nobody observed it, and the labels are free there.
        let at =
            (0..Window::COLUMNS).find(|c| region.columns[*c] && !VoxelRequest::from_frame(&frame).edited(*c));
        let at = at.expect("the halo");
        let mut observed = vec![true; Window::VOXELS];
        (0..Window::NZ).for_each(|z| observed[at * Window::NZ + z] = false);
        frame.inferred.unobserved = Unobserved::from_observed(&observed);
        let mut source = (*frame.source).clone();
        source
            .occupancy
            .set(at / Window::NY, at % Window::NY, 0, Class::FREE);
        frame.source = std::sync::Arc::new(source);
        let mut after = draft::draft(&frame.layout, frame.boxes.values());
        assert_eq!(
            Invented::count(&frame, &after, &region).into_unobserved,
            1,
            "ground"
        );
        after.set(at / Window::NY, at % Window::NY, 4, Class::Manmade.id());
        let found = Invented::count(&frame, &after, &region);
        assert_eq!((found.into_unobserved, found.total()), (2, 1));
        frame.inferred.unobserved = None;
        assert_eq!(Invented::count(&frame, &after, &region).into_unobserved, 0);
    }
}
