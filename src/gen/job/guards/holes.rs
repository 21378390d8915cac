//! Closes holes in the ground that the networks left in a scene that should be complete, and counts them.

use crate::region::Region;
use scene::draft::{ground_bin, ground_class};
use scene::{BevLayout, Class, VoxelGrid, Window};

/// Lays the layout's ground in columns that have no ground and hold nothing up to the ground's bin. Returns where.
pub fn close_holes(layout: &BevLayout, generated: &mut VoxelGrid) -> Vec<[usize; 3]> {
    close(layout, generated, |_| true)
}

/// Closes holes after an edit of a region. Only columns of the region are closed: those that had ground before or, if
/// the scene should be complete, all of them.
pub fn close_holes_of_edit(
    layout: &BevLayout,
    before: &VoxelGrid,
    (region, complete): (&Region, bool),
    generated: &mut VoxelGrid,
) -> Vec<[usize; 3]> {
    let is_ground = |l: &u8| Class::from_id(*l).is_some_and(Class::is_ground);
    close(layout, generated, |c| {
        let had = || {
            before
                .column(c / Window::NY, c % Window::NY)
                .iter()
                .any(is_ground)
        };
        region.columns[c] && (complete || had())
    })
}

/// The closed holes that stay closed in the result: paint may open them again, and loose voxels are removed again.
pub fn still_closed(mut holes: Vec<[usize; 3]>, result: &VoxelGrid) -> Vec<[usize; 3]> {
    holes.retain(|[x, y, z]| result.get(*x, *y, *z) != Class::FREE);
    holes
}

fn close(layout: &BevLayout, generated: &mut VoxelGrid, may: impl Fn(usize) -> bool) -> Vec<[usize; 3]> {
    let mut closed = Vec::new();
    for c in (0..Window::COLUMNS).filter(|c| may(*c)) {
        let (x, y) = (c / Window::NY, c % Window::NY);
        let bin = ground_bin(layout, x, y);
        let column = generated.column(x, y);
        let is_ground = |l: &u8| Class::from_id(*l).is_some_and(Class::is_ground);
        if column.iter().any(is_ground) || column[..=bin].iter().any(|l| *l != Class::FREE) {
            continue;
        }
        generated.set(x, y, bin, ground_class(layout.cell(x, y)).id());
        closed.push([x, y, bin]);
    }
    closed
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::request::tests::removal;
    use scene::draft;

    #[test]
    fn holes_are_closed_and_nothing_else_changes() {
        let frame = removal();
        let sound = draft::draft(&frame.layout, frame.boxes.values());
        let mut generated = sound.clone();
        assert!(close_holes(&frame.layout, &mut generated).is_empty());
        let bins = [(5, 5), (100, 100)].map(|(x, y)| (x, y, ground_bin(&frame.layout, x, y)));
        for (x, y, bin) in bins {
            generated.set(x, y, bin, Class::FREE);
        }
        // A crown above a hole stays; a wall in the place of the ground is no hole.
        generated.set(5, 5, 12, Class::Vegetation.id());
        let (x, y) = (7, 7);
        let wall = ground_bin(&frame.layout, x, y);
        generated.set(x, y, wall, Class::Manmade.id());
        assert_eq!(close_holes(&frame.layout, &mut generated).len(), 2);
        let mut expected = sound.clone();
        expected.set(5, 5, 12, Class::Vegetation.id());
        expected.set(x, y, wall, Class::Manmade.id());
        assert!(generated == expected);
        // After an edit only what had ground before gets it again.
        let sound_before = sound;
        let mut bare = sound_before.clone();
        let bin = ground_bin(&frame.layout, 3, 3);
        bare.set(3, 3, bin, Class::FREE);
        let mut generated = bare.clone();
        let (x, y, z) = bins[1];
        generated.set(x, y, z, Class::FREE);
        let all = Region::full();
        let holes = close_holes_of_edit(&frame.layout, &bare, (&all, false), &mut generated);
        assert_eq!(
            (&*holes, generated.get(3, 3, bin)),
            (&[bins[1].into()][..], Class::FREE)
        );
        // What the networks were not asked about is free in what they give, and no hole.
        let region = Region::of_edit(&frame, 2);
        assert!(!region.columns[bins[0].0 * Window::NY + bins[0].1]);
        let mut decoded = VoxelGrid::new();
        let holes = close_holes_of_edit(&frame.layout, &sound_before, (&region, true), &mut decoded);
        assert_eq!(holes.len(), region.column_count());
        assert_eq!(decoded.count_set(), holes.len());
        // Counted is what the result holds.
        assert_eq!(still_closed(holes.clone(), &decoded), holes);
        let [x, y, z] = holes[0];
        decoded.set(x, y, z, Class::FREE);
        assert_eq!(still_closed(holes.clone(), &decoded), holes[1..]);
    }
}
