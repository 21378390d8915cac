//! Occupancy as Occ3D labels, with the masks of what the sensors observed.

use scene::{Class, Extent, Frame, Window};

use super::{ExportSpan, Exporter, ObservationMasks, OutFile, Product, Products};
use crate::occ3d::{self, Occ3dFrame};
use crate::{FormatError, Holds, voxels};

/// See [`occ3d`].
pub const EXPORTER: Exporter = Exporter {
    id: "occ3d",
    title: "Occupancy: Occ3D labels.npz, 200 x 200 x 16 class labels, masks of LiDAR and cameras",
    file_name: Some("labels.npz"),
    holds: &[Holds::Occupancy],
    lost: "which sensor observed a voxel: what any of them observed comes back as observed",
    span: ExportSpan::Moment,
    needs: &[Product::Observed],
    write: |scene, products| {
        let found = labelled_frame(scene.frame(), products)?;
        Ok(vec![OutFile::new(
            "labels.npz",
            occ3d::frame_with_recipe_to_bytes(&found, products.recipe()),
        )])
    },
};

/// See [`occ3d`].
pub const WAYMO_EXPORTER: Exporter = Exporter {
    id: "occ3d-waymo",
    title: "Occupancy: Occ3D-Waymo, 200 x 200 x 16 labels of Waymo, masks of LiDAR and cameras",
    file_name: Some("occ3d_waymo_04.npz"),
    holds: &[Holds::Occupancy],
    lost: "classes that are not among Waymo's: trucks, buses, trailers and construction vehicles come back as cars, barriers as \
           others, other flat ground and terrain as sidewalk; which sensor observed a voxel: what any of them observed comes \
           back as observed",
    span: ExportSpan::Moment,
    needs: &[Product::Observed],
    write: |scene, products| {
        let found = labelled_frame(scene.frame(), products)?;
        let data_labels = scene.frame().inferred.data_labels.as_ref();
        let bytes = occ3d::waymo_to_bytes(&found, data_labels);
        Ok(vec![OutFile::new("occ3d_waymo_04.npz", bytes)])
    },
};

/// Labels and masks of the networks' window. A map of another extent is cut to it.
fn labelled_frame(frame: &Frame, products: &mut dyn Products) -> Result<Occ3dFrame, FormatError> {
    voxels::check(frame)?;
    let ObservationMasks { lidar, camera } = products.observed()?;
    let known = known(frame);
    let [mut lidar, camera] = [lidar, camera];
    if frame.inferred.unobserved.is_some() {
        // What the data set observed stays observed, whatever rays reach it now.
        let words = lidar.iter_mut().zip(&camera).zip(&known);
        words.for_each(|((lidar, camera), known)| *lidar |= known & !camera);
    }
    let [lidar_observed, camera_observed] = [lidar, camera].map(|words| Some(mask(&words, &known)));
    Ok(Occ3dFrame {
        labels: frame.occupancy.crop(Extent::WINDOW),
        lidar_observed,
        camera_observed,
    })
}

/// A bit for each voxel per column of the window, set if its content is known: the voxel is not free, or the frame's
/// data set does not say that nothing observed it. In other voxels free means unknown, whatever rays pass them now.
fn known(frame: &Frame) -> Vec<u16> {
    let unobserved = frame.inferred.unobserved.as_ref();
    let unobserved = unobserved.map(|u| u.crop(Extent::WINDOW));
    let occupancy = frame.occupancy.crop(Extent::WINDOW);
    let word = |[x, y]: [usize; 2]| {
        let unknown = unobserved
            .as_ref()
            .map_or(0, |u| u.words()[Extent::WINDOW.index(x, y)]);
        let bits = occupancy.column(x, y).iter().enumerate();
        bits.fold(!unknown as u16, |word, (z, label)| {
            word | u16::from(*label != Class::FREE) << z
        })
    };
    Extent::WINDOW.all_columns().map(word).collect()
}

/// A flag per voxel `[x][y][z]` from a word per column; a voxel that is not known is not set.
fn mask(words: &[u16], known: &[u16]) -> Vec<bool> {
    let both = words.iter().zip(known).map(|(word, known)| word & known);
    both.flat_map(|word| (0..Window::NZ).map(move |z| word >> z & 1 == 1))
        .collect()
}

#[cfg(test)]
mod tests {
    use scene::Unobserved;

    use super::*;
    use crate::import::Content;
    use crate::npz;
    use crate::table_tests::{Small, random_scene, round_trip, scene};

    /// What comes back: all labels, and as observed what the LiDAR or a camera observed.
    #[test]
    fn labels_and_the_union_of_the_masks_come_back() {
        for seed in 0..100 {
            let scene = random_scene(seed);
            let Some(Content::Scene(back)) = round_trip(&EXPORTER, &scene) else {
                panic!("read as a scene");
            };
            let frame = back.scene.frame();
            assert!(frame.occupancy == scene.frame().occupancy, "seed {seed}");
            assert!(back.skipped.is_empty(), "{:?}", back.skipped);
            // (the tests' recipe is that of another scene)
            let told = Small.recipe().clone();
            assert_eq!(
                (back.scene.seed, back.scene.conditions),
                (told.seed, told.conditions)
            );
            let unobserved = frame.inferred.unobserved.as_ref().expect("masks");
            for [x, y] in Extent::WINDOW.all_columns() {
                let expected = match (x >= 100, y >= 100) {
                    (true, true) => 0,
                    (true, false) => 0xff00,
                    (false, true) => 0x0001,
                    (false, false) => 0xffff,
                };
                let word = unobserved.words()[Extent::WINDOW.index(x, y)];
                assert_eq!(word, expected, "seed {seed}, column {x}, {y}");
            }
        }
    }

    /// Labels of Waymo come back as they were, but for the voxel that was painted.
    #[test]
    fn labels_of_waymo_come_back_but_for_the_edit() {
        let at = |x: usize, y: usize, z: usize| (x * Window::NY + y) * Window::NZ + z;
        for free in [15, 23] {
            let mut labels = vec![free; Window::VOXELS];
            for (i, label) in labels.iter_mut().enumerate().take(150_000) {
                *label = [free, 0, 1, 3, 4, 5, 6, 8, 10, 11, 12, 13, 14][i % 13];
            }
            let array = npz::Array {
                name: "voxel_label",
                shape: &[Window::NX, Window::NY, Window::NZ],
                values: npz::NpzValues::U8(labels.clone()),
            };
            let bytes = npz::to_bytes(&[array]).expect("memory");
            let found = occ3d::read_found(&bytes).expect("read");
            let mut scene = scene();
            scene.change_canvas(|frame| {
                frame.occupancy = found.frame.labels.clone();
                frame.inferred.data_labels = found.data_labels.clone();
                frame.inferred.unobserved = Unobserved::from_observed(&[true; Window::VOXELS]);
                frame.occupancy.set(0, 0, 3, Class::Vegetation.id()); // was a sign
            });
            labels[at(0, 0, 3)] = 11;
            let written = (WAYMO_EXPORTER.write)(&scene, &mut Small)
                .expect("written")
                .remove(0);
            let back = npz::entry(&written.bytes, "voxel_label", 1 << 24).expect("an array");
            assert!(back.ends_with(&labels), "free is {free}");
            let masks = occ3d::read(&written.bytes).expect("read");
            let [lidar, camera] = [masks.lidar_observed, masks.camera_observed].map(|m| m.expect("a mask"));
            assert!(
                lidar.iter().zip(&camera).all(|(a, b)| *a || *b),
                "all was observed"
            );
        }
    }

    #[test]
    fn each_mask_is_its_own_array_and_the_bytes_are_the_same_each_time() {
        let write = || {
            (EXPORTER.write)(&scene(), &mut Small)
                .expect("written")
                .remove(0)
                .bytes
        };
        assert_eq!(write(), write());
        let frame = occ3d::read(&write()).expect("a frame");
        let at = |x: usize, y: usize, z: usize| (x * Window::NY + y) * Window::NZ + z;
        let (lidar, camera) = (
            frame.lidar_observed.expect("a mask"),
            frame.camera_observed.expect("a mask"),
        );
        assert!(lidar[at(100, 0, 7)] && !lidar[at(100, 0, 8)] && !lidar[at(99, 199, 0)]);
        assert!(camera[at(0, 100, 1)] && !camera[at(0, 100, 0)] && !camera[at(199, 99, 5)]);
    }

    /// Free voxels that a data set's masks leave open stay open, however many rays pass them.
    #[test]
    fn what_a_data_set_does_not_know_stays_unknown() {
        let mut scene = scene();
        let [x, y, z] = [150, 120, 4];
        let mut observed = vec![true; Window::VOXELS];
        for z in [z, z + 1] {
            observed[(x * Window::NY + y) * Window::NZ + z] = false;
        }
        scene.change_canvas(|frame| {
            frame.inferred.unobserved = Unobserved::from_observed(&observed);
            frame.occupancy.set(x, y, z + 1, Class::Car.id());
        });
        let Some(Content::Scene(back)) = round_trip(&EXPORTER, &scene) else {
            panic!("read as a scene");
        };
        let unobserved = back.scene.frame().inferred.unobserved.clone().expect("masks");
        let word = unobserved.words()[Extent::WINDOW.index(x, y)];
        assert_eq!(word, 1 << z, "the car beside it was seen");
    }
}
