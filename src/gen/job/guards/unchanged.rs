//! Takes over only what an edit changes: where the networks give a voxel the same label before and after the edit, the
//! source's own label stays. So details that the VAE cannot represent (holes of labels, thin things) are lost only
//! where something changed.

use crate::inpaint::InpaintMask;
use crate::region::Region;
use crate::request::VoxelRequest;
use scene::raster::box_cells;
use scene::{Extent, Frame, VoxelGrid, Window};

/// Distance from a removed or changed box within which its class is not restored, since such a voxel may have been a
/// part of the box, m.
const SCRAPS_M: f64 = 1.2;

/// Restores the source's labels in `generated`, in the region's columns, where it equals `decoded`, the same decoder's
/// output for the source. Skips columns that the user edited, cells of `inpaint`, and voxels near a removed box that
/// have its class and lie in no other box. Returns the number of restored voxels.
pub fn keep_unchanged(
    frame: &Frame,
    region: &Region,
    inpaint: &InpaintMask,
    request: &VoxelRequest<'_>,
    decoded: &VoxelGrid,
    generated: &mut VoxelGrid,
) -> usize {
    let mut gone = vec![0u32; Window::COLUMNS]; // a bit per class
    for (id, b) in &frame.source.boxes {
        if frame.boxes.get(id) != Some(b) {
            box_cells(Extent::WINDOW, b, SCRAPS_M, |x, y| {
                gone[x * Window::NY + y] |= 1 << b.class.id()
            });
        }
    }
    let mut count = 0;
    for (c, _) in region.columns.iter().enumerate().filter(|(_, c)| **c) {
        let (x, y) = (c / Window::NY, c % Window::NY);
        if request.edited(c) || inpaint.has_column(Extent::WINDOW, [x, y]) {
            continue;
        }
        let (source, before) = (frame.source.occupancy.column(x, y), decoded.column(x, y));
        let mut column = *generated.window_column(x, y);
        for (z, now) in column.iter_mut().enumerate() {
            let scrap = gone[c] >> source[z] & 1 == 1 && !request.holds(x, y, z, source[z]);
            if *now == before[z] && *now != source[z] && !scrap {
                *now = source[z];
                count += 1;
            }
        }
        if column != *generated.window_column(x, y) {
            *generated.window_column_mut(x, y) = column;
        }
    }
    count
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeMap;

    use super::*;
    use scene::{BevLayer, BevLayout, Class, draft};

    #[test]
    fn only_differences_are_carried_over() {
        let layout = BevLayout::default();
        let mut source = draft::draft(&layout, std::iter::empty());
        let wall = Class::Manmade.id();
        (1..6).for_each(|z| source.set(90, 90, z, wall)); // thin: the VAE loses its top
        source.set(91, 90, 0, Class::FREE); // a hole: the VAE closes it
        let mut frame = Frame::new(layout, BTreeMap::new(), source.clone());
        frame.layout.set(BevLayer::DrivableArea, 92, 90, true);
        let mut decoded = source.clone();
        decoded.set(90, 90, 5, Class::FREE);
        decoded.set(91, 90, 0, Class::Terrain.id());
        let mut generated = decoded.clone();
        generated.set(90, 90, 1, Class::FREE); // a change: it stays
        generated.set(92, 90, 0, Class::DriveableSurface.id()); // so does what is in an edited column
        let region = Region::of_edit(&frame, 2);
        let request = VoxelRequest::from_frame(&frame);
        let mut found = generated.clone();
        let none = InpaintMask::default();
        assert_eq!(
            keep_unchanged(&frame, &region, &none, &request, &decoded, &mut found),
            2
        );
        let mut expected = source;
        expected.set(90, 90, 1, Class::FREE);
        expected.set(92, 90, 0, Class::DriveableSurface.id());
        assert_eq!(found, expected);
        // Where something new is asked for, nothing of the source comes back.
        let mut inpaint = InpaintMask::default();
        inpaint.set_columns(Extent::WINDOW, &[[90, 90], [91, 90]], true);
        let mut found = generated.clone();
        assert_eq!(
            keep_unchanged(&frame, &region, &inpaint, &request, &decoded, &mut found),
            0
        );
        assert_eq!(found, generated);
    }
}
