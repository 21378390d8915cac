//! Corrects floating voxels of generated occupancy. Crowns in the air get a stem; other floating voxels and voxels of
//! objects without a box are removed. Both are counted for the report.

use crate::composite::composite;
use crate::region::Region;
use crate::request::VoxelRequest;
use scene::draft::{ground_bin, ground_class};
use scene::raster::box_cells;
use scene::support::{
    self, CROWN, bins_set, by_class, groups, is_known_to_float, main_class, occupied, reaches_side, stem,
};
use scene::{Class, Extent, Frame, VoxelGrid, Window};

/// Voxels of an object this far outside its box still belong to it, m.
const MARGIN_M: f64 = 0.6;

/// Number of corrected voxels.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Grounded {
    /// Voxels added under crowns as stems.
    pub stems: usize,
    /// Voxels removed because they floated or belonged to an object without a box.
    pub dropped: usize,
}

/// Corrects `generated` inside the region. Left as they are: voxels of the source (unless `all` is inpainted), voxels
/// of boxes and paint, and groups that may be held by something outside the grid.
pub fn keep_grounded(
    frame: &Frame,
    region: &Region,
    all: bool,
    request: &VoxelRequest<'_>,
    generated: &mut VoxelGrid,
) -> Grounded {
    let mut out = Grounded::default();
    let source = &frame.source.occupancy;
    let inside = |x: usize, y: usize| region.columns[x * Window::NY + y];
    let is_new = |grid: &VoxelGrid, [x, y, z]: [usize; 3]| {
        let label = grid.get(x, y, z);
        inside(x, y) && (all || source.get(x, y, z) != label) && !request.holds(x, y, z, label)
    };
    for cell in without_box(frame, region, generated) {
        if is_new(generated, cell) {
            let [x, y, z] = cell;
            let at_foot = z == ground_bin(&frame.layout, x, y);
            let label = match at_foot {
                true => ground_class(frame.layout.cell(x, y)).id(),
                false => Class::FREE,
            };
            generated.set(x, y, z, label);
            out.dropped += 1;
        }
    }
    // Support also depends on the voxels around the region.
    let whole = composite(source, generated, region, &frame.painted);
    let occupied = occupied(&whole);
    let stands = support::supported(
        Extent::WINDOW,
        &occupied,
        &support::ground(Extent::WINDOW, &by_class(&whole)),
    );
    let hanging = occupied.iter().zip(&stands).enumerate();
    let hanging = hanging
        .flat_map(|(c, (all, stands))| bins_set(Extent::WINDOW, c, all & !stands))
        .collect();
    for group in groups(Extent::WINDOW, hanging) {
        let new: Vec<_> = group.iter().copied().filter(|c| is_new(&whole, *c)).collect();
        let class = main_class(&whole, &group);
        let is_crown = class == Class::Vegetation && group.len() >= CROWN;
        // A group at the top of the grid may go on above it and be held there; a tree may not.
        let needs_stem = all && is_crown && !reaches_side(Extent::WINDOW, &group);
        let floats = needs_stem || is_known_to_float(&whole, frame.inferred.unobserved.as_ref(), &group);
        if new.is_empty() || !floats {
            continue;
        }
        let stem = match is_crown {
            true => stem(&whole, &group),
            false => Vec::new(),
        };
        if !stem.is_empty() && stem.iter().all(|[x, y, _]| inside(*x, *y)) {
            out.stems += stem.len();
            stem.iter()
                .for_each(|[x, y, z]| generated.set(*x, *y, *z, class.id()));
        } else {
            out.dropped += new.len();
            new.iter()
                .for_each(|[x, y, z]| generated.set(*x, *y, *z, Class::FREE));
        }
    }
    out
}

/// Voxels of the region with an object class that no box within reach has.
fn without_box(frame: &Frame, region: &Region, generated: &VoxelGrid) -> Vec<[usize; 3]> {
    let mut explained = vec![0u32; Window::COLUMNS];
    for b in frame.boxes.values() {
        box_cells(Extent::WINDOW, b, MARGIN_M, |x, y| {
            explained[x * Window::NY + y] |= 1 << b.class.id()
        });
    }
    let mut out = Vec::new();
    for (c, _) in region.columns.iter().enumerate().filter(|(_, c)| **c) {
        let (x, y) = (c / Window::NY, c % Window::NY);
        let labels = generated.column(x, y).iter().enumerate();
        let unboxed = labels.filter(|(_, label)| {
            let is_object = Class::from_id(**label).is_some_and(Class::is_object);
            is_object && explained[c] >> **label & 1 == 0
        });
        out.extend(unboxed.map(|(z, _)| [x, y, z]));
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::request::tests::removal;
    use scene::draft;

    /// A crown, a wall in the air and a car without a box, beside a hedge that hung in the source already.
    fn scene() -> (Frame, VoxelGrid, Region) {
        let mut frame = removal();
        let mut source = (*frame.source).clone();
        source.occupancy.set(150, 120, 8, Class::Vegetation.id());
        frame.source = std::sync::Arc::new(source);
        let mut generated = draft::draft(&frame.layout, frame.boxes.values());
        generated.set(150, 120, 8, Class::Vegetation.id());
        for x in 120..123 {
            for y in 120..123 {
                generated.set(x, y, 7, Class::Vegetation.id());
            }
            generated.set(x, 130, 9, Class::Manmade.id());
            (1..3).for_each(|z| generated.set(x, 140, z, Class::Car.id()));
        }
        let mut columns = vec![false; Window::COLUMNS];
        for x in 110..160 {
            (110..150).for_each(|y| columns[x * Window::NY + y] = true);
        }
        (frame, generated, Region::of_columns(columns))
    }

    #[test]
    fn what_hangs_gets_a_stem_or_goes_and_cars_need_a_box() {
        let (frame, mut generated, region) = scene();
        let request = VoxelRequest::from_frame(&frame);
        let boxed = request_voxels(&frame, &generated);
        let found = keep_grounded(&frame, &region, false, &request, &mut generated);
        let stem = (1..7).filter(|z| generated.get(121, 121, *z) == Class::Vegetation.id());
        assert_eq!(stem.count(), 6);
        assert_eq!((found.stems, found.dropped), (6, 9));
        assert_eq!(generated.get(121, 130, 9), Class::FREE);
        assert_eq!(generated.get(121, 140, 2), Class::FREE);
        // It hung there before, and nobody inpainted it.
        assert_eq!(generated.get(150, 120, 8), Class::Vegetation.id());
        assert_eq!(request_voxels(&frame, &generated), boxed);
        // Sound things are left alone.
        let again = keep_grounded(&frame, &region, false, &request, &mut generated);
        assert_eq!(again, Grounded::default());
        // Inpainted, it goes too; a voxel is no crown.
        let all = keep_grounded(&frame, &Region::full(), true, &request, &mut generated);
        assert_eq!((all.stems, all.dropped), (0, 1));
        // A crown at the top of the grid hangs from nothing; a wall there may go on beyond.
        for z in 12..Window::NZ {
            (0..9).for_each(|c| generated.set(130 + c / 3, 120 + c % 3, z, Class::Vegetation.id()));
            generated.set(140, 120, z, Class::Manmade.id());
        }
        let edited = keep_grounded(&frame, &region, false, &request, &mut generated.clone());
        assert_eq!(edited, Grounded::default());
        let all = keep_grounded(&frame, &Region::full(), true, &request, &mut generated);
        assert_eq!((all.stems, all.dropped), (11, 0));
    }

    #[test]
    fn nothing_changes_outside_the_region() {
        let (frame, mut generated, _) = scene();
        let before = generated.clone();
        let request = VoxelRequest::from_frame(&frame);
        let found = keep_grounded(&frame, &Region::empty(), false, &request, &mut generated);
        assert_eq!((found, generated), (Grounded::default(), before));
    }

    fn request_voxels(frame: &Frame, grid: &VoxelGrid) -> usize {
        let boxes = frame.boxes.values();
        boxes.map(|b| crate::request::voxels_of(grid, b)).sum()
    }
}
