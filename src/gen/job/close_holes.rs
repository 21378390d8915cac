//! A scene that is to be complete has ground everywhere: what the networks left open is closed, and counted.

use scene::draft::{ground_bin, ground_class};
use scene::{BevLayout, Class, VoxelGrid, Window};

/// Lays the layout's ground in columns without any ground in which nothing stands on its place either. Returns how many.
pub fn close_holes(layout: &BevLayout, generated: &mut VoxelGrid) -> usize {
    close(layout, generated, |_, _| true)
}

/// The same after an edit, which digs no holes: where there was ground before or, if all is to be complete, everywhere.
pub fn close_holes_of_edit(
    layout: &BevLayout,
    before: &VoxelGrid,
    complete: bool,
    generated: &mut VoxelGrid,
) -> usize {
    let is_ground = |l: &u8| Class::from_id(*l).is_some_and(Class::is_ground);
    close(layout, generated, |x, y| {
        complete || before.column(x, y).iter().any(is_ground)
    })
}

fn close(layout: &BevLayout, generated: &mut VoxelGrid, may: impl Fn(usize, usize) -> bool) -> usize {
    let mut closed = 0;
    for c in 0..Window::COLUMNS {
        let (x, y) = (c / Window::NY, c % Window::NY);
        let bin = ground_bin(layout, x, y);
        let column = generated.column(x, y);
        let is_ground = |l: &u8| Class::from_id(*l).is_some_and(Class::is_ground);
        if column.iter().any(is_ground) || column[..=bin].iter().any(|l| *l != Class::FREE) || !may(x, y) {
            continue;
        }
        generated.set(x, y, bin, ground_class(layout.cell(x, y)).id());
        closed += 1;
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
        assert_eq!(close_holes(&frame.layout, &mut generated), 0);
        let bins = [(5, 5), (100, 100)].map(|(x, y)| (x, y, ground_bin(&frame.layout, x, y)));
        for (x, y, bin) in bins {
            generated.set(x, y, bin, Class::FREE);
        }
        // A crown above a hole stays; a wall in the place of the ground is no hole.
        generated.set(5, 5, 12, Class::Vegetation.id());
        let (x, y) = (7, 7);
        let wall = ground_bin(&frame.layout, x, y);
        generated.set(x, y, wall, Class::Manmade.id());
        assert_eq!(close_holes(&frame.layout, &mut generated), 2);
        let mut expected = sound.clone();
        expected.set(5, 5, 12, Class::Vegetation.id());
        expected.set(x, y, wall, Class::Manmade.id());
        assert!(generated == expected);
        // After an edit only what had ground before gets it again.
        let before = sound;
        let mut bare = before.clone();
        let bin = ground_bin(&frame.layout, 3, 3);
        bare.set(3, 3, bin, Class::FREE);
        let mut generated = bare.clone();
        let (x, y, z) = bins[1];
        generated.set(x, y, z, Class::FREE);
        assert_eq!(
            close_holes_of_edit(&frame.layout, &bare, false, &mut generated),
            1
        );
        assert_eq!(generated.get(3, 3, bin), Class::FREE);
    }
}
