//! Removes what an edit invented: things on the road or in place of a removed box, and voxels where a data set's masks
//! say that no sensor looked. The removed voxels are counted for the report.

use crate::inpaint::InpaintMask;
use crate::region::Region;
use crate::request::{VoxelRequest, stands};
use scene::{BevLayer, Class, Extent, Frame, VoxelGrid, Window, draft};

/// Removes invented voxels (see [`VoxelRequest::each_invented`]) from `generated` on roads and car parks, and where a box of
/// the source stood. If the source held a voxel there that stays, it is put back; a column without any ground left gets
/// the layout's. Cells of `inpaint` are skipped, since new content is wanted there. Returns the number of removed
/// voxels.
pub fn keep_clear(
    frame: &Frame,
    region: &Region,
    inpaint: &InpaintMask,
    request: &VoxelRequest<'_>,
    generated: &mut VoxelGrid,
) -> usize {
    let road = BevLayer::DrivableArea.bit() | BevLayer::CarparkArea.bit();
    let source = &frame.source.occupancy;
    let mut found = Vec::new();
    request.each_invented(generated, region, |x, y, z, _| {
        let bare = frame.layout.cell(x, y) & road != 0 || request.left_by_a_box(x * Window::NY + y);
        if bare && !inpaint.has_column(Extent::WINDOW, [x, y]) {
            found.push([x, y, z]);
        }
    });
    for &[x, y, z] in &found {
        let before = source.get(x, y, z);
        let stays = stands(before) && (!is_object(before) || request.holds(x, y, z, before));
        generated.set(x, y, z, if stays { before } else { Class::FREE });
    }
    for &[x, y, _] in &found {
        // Labels have holes: a column that was empty before gets no ground.
        let Some(foot) = source.column(x, y).iter().position(|l| *l != Class::FREE) else {
            continue;
        };
        let is_ground = |l: &u8| Class::from_id(*l).is_some_and(Class::is_ground);
        let column = generated.column(x, y);
        if column[foot] == Class::FREE && !column.iter().any(is_ground) {
            let ground = draft::ground_class(frame.layout.cell(x, y));
            generated.set(x, y, foot, ground.id());
        }
    }
    found.len()
}

fn is_object(label: u8) -> bool {
    Class::from_id(label).is_some_and(Class::is_object)
}

/// Removes voxels from `generated`, in the region's columns, where the source is free and the frame's masks say that nothing
/// was observed: free means unknown there, and stays unknown. Columns that the user edited and cells of `inpaint` are
/// skipped. Returns the number of removed voxels.
pub fn keep_unobserved(
    frame: &Frame,
    region: &Region,
    inpaint: &InpaintMask,
    request: &VoxelRequest<'_>,
    generated: &mut VoxelGrid,
) -> usize {
    let Some(unobserved) = &frame.inferred.unobserved else {
        return 0;
    };
    let mut count = 0;
    for (c, _) in region.columns.iter().enumerate().filter(|(_, c)| **c) {
        let (word, (x, y)) = (unobserved.words()[c], (c / Window::NY, c % Window::NY));
        if word == 0 || request.edited(c) || inpaint.has_column(Extent::WINDOW, [x, y]) {
            continue;
        }
        let before = *frame.source.occupancy.window_column(x, y);
        for (z, before) in before.iter().enumerate() {
            let now = generated.get(x, y, z);
            let unknown = *before == Class::FREE && word >> z & 1 == 1;
            if unknown && now != Class::FREE && !request.holds(x, y, z, now) {
                generated.set(x, y, z, Class::FREE);
                count += 1;
            }
        }
    }
    count
}

/// Observed voxels, as the decoder takes them (`Unobserved::observed`). In columns that the user edited and in cells of
/// `inpaint` no voxel counts as observed. `None` if the frame has no masks.
pub fn observed_still(frame: &Frame, inpaint: &InpaintMask, request: &VoxelRequest<'_>) -> Option<Vec<u32>> {
    let mut observed = frame.inferred.unobserved.as_ref()?.observed();
    for (c, told) in observed.iter_mut().enumerate() {
        let (x, y) = (c / Window::NY, c % Window::NY);
        if request.edited(c) || inpaint.has_column(Extent::WINDOW, [x, y]) {
            *told = 0;
        }
    }
    Some(observed)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::composite::{composite, untouched_voxels_changed};
    use crate::invented::Invented;
    use crate::request::tests::removal;
    use scene::Unobserved;

    fn at(x_m: f64, y_m: f64) -> [usize; 2] {
        Window::column_at(x_m, y_m).expect("inside")
    }

    #[test]
    fn nothing_is_planted_on_the_road() {
        let mut frame = removal();
        // A hedge that stands in the road since ever, within the region.
        let [hx, hy] = at(10.0, 1.4);
        let mut source = (*frame.source).clone();
        (0..4).for_each(|z| source.occupancy.set(hx, hy, z, Class::Vegetation.id()));
        frame.source = std::sync::Arc::new(source);
        let region = Region::of_edit(&frame, 2);
        assert!(region.columns[hx * Window::NY + hy]);
        let clean = draft::draft(&frame.layout, frame.boxes.values());
        let [x, y] = at(10.0, 0.0);
        // Networks that grow a tree out of the car's place, wall the hedge in, and see a car beside it.
        let mut generated = clean.clone();
        (0..9).for_each(|z| generated.set(x, y, z, Class::Vegetation.id()));
        (0..4).for_each(|z| generated.set(hx, hy, z, Class::Manmade.id()));
        generated.set(x + 3, y, 2, Class::Car.id());
        let request = VoxelRequest::from_frame(&frame);
        let none = InpaintMask::default();
        let before = Invented::of_request(&request, &frame, &generated, &region);
        assert_eq!(
            before.total(),
            13,
            "a car that was there leaves car voxels, not new ones"
        );
        assert_eq!(keep_clear(&frame, &region, &none, &request, &mut generated), 13);
        assert_eq!(
            Invented::of_request(&request, &frame, &generated, &region).total(),
            0
        );
        assert_eq!(generated.get(x, y, 0), Class::DriveableSurface.id(), "road again");
        assert_eq!(generated.get(x, y, 5), Class::FREE);
        assert_eq!(generated.get(hx, hy, 3), Class::Vegetation.id(), "the old hedge");
        assert_eq!(keep_clear(&frame, &region, &none, &request, &mut generated), 0);
        let source = &frame.source.occupancy;
        let result = composite(source, &generated, &region, &frame.painted);
        assert_eq!(
            untouched_voxels_changed(source, &result, &region, &frame.painted),
            0
        );
        // Where something new was asked for, it may come; outside the region nothing is touched.
        let mut wanted = clean.clone();
        (0..9).for_each(|z| wanted.set(x, y, z, Class::Vegetation.id()));
        let mut mask = InpaintMask::default();
        mask.set_columns(Extent::WINDOW, &[[x, y]], true);
        assert_eq!(keep_clear(&frame, &region, &mask, &request, &mut wanted), 0);
        assert_eq!(
            keep_clear(&frame, &Region::empty(), &none, &request, &mut wanted),
            0
        );
    }

    #[test]
    fn beside_the_road_only_where_the_box_stood() {
        let mut frame = removal();
        frame.layout = scene::BevLayout::default();
        let mut source = (*frame.source).clone();
        source.layout = frame.layout.clone();
        source.occupancy = draft::draft(&frame.layout, source.boxes.values());
        frame.source = std::sync::Arc::new(source);
        let region = Region::of_edit(&frame, 2);
        let mut generated = draft::draft(&frame.layout, frame.boxes.values());
        let ([x, y], [hx, hy]) = (at(10.0, 0.0), at(10.0, 1.9));
        assert!(
            region.columns[hx * Window::NY + hy]
                && !VoxelRequest::from_frame(&frame).left_by_a_box(hx * Window::NY + hy)
        );
        for (x, y) in [(x, y), (hx, hy)] {
            (0..5).for_each(|z| generated.set(x, y, z, Class::Vegetation.id()));
        }
        let none = InpaintMask::default();
        let cleared = keep_clear(
            &frame,
            &region,
            &none,
            &VoxelRequest::from_frame(&frame),
            &mut generated,
        );
        assert_eq!(cleared, 5);
        assert_eq!(generated.get(x, y, 0), Class::Terrain.id());
        assert_eq!(generated.get(hx, hy, 2), Class::Vegetation.id());
    }

    #[test]
    fn masks_are_respected_but_for_what_was_edited() {
        let mut frame = removal();
        let mut source = (*frame.source).clone();
        source.occupancy = VoxelGrid::new(); // labels of a drive that saw nothing
        frame.source = std::sync::Arc::new(source);
        let region = Region::of_edit(&frame, 2);
        let clean = draft::draft(&frame.layout, frame.boxes.values());
        let mut masked = frame.clone();
        masked.inferred.unobserved = Unobserved::from_observed(&vec![false; Window::VOXELS]);
        let request = VoxelRequest::from_frame(&masked);
        let none = InpaintMask::default();
        let halo = (0..Window::COLUMNS).filter(|c| region.columns[*c] && !request.edited(*c));
        let halo = halo.count();
        assert!(halo > 20);
        let mut generated = clean.clone();
        assert_eq!(
            keep_unobserved(&frame, &region, &none, &request, &mut generated),
            0,
            "no mask"
        );
        let found = Invented::of_request(&request, &masked, &generated, &region);
        assert_eq!(found.into_unobserved, halo);
        assert_eq!(
            keep_unobserved(&masked, &region, &none, &request, &mut generated),
            halo
        );
        let left = Invented::of_request(&request, &masked, &generated, &region);
        assert_eq!(left.into_unobserved, 0);
        let [x, y] = at(10.0, 0.0);
        assert_eq!(
            generated.get(x, y, 0),
            Class::DriveableSurface.id(),
            "under the car"
        );
    }
}
