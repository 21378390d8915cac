//! Occ3D labels: their voxels are kept, and the parts that they do not carry are inferred.

use std::collections::BTreeMap;

use scene::Unobserved;
use scene::message::quoted;

use super::{Content, GUESSED, ImportFile, ImportedScene, Importer, first_entry_ends, labelled, nuplan_occ};
use crate::{FormatError, Holds, occ3d, recipe};

/// See [`occ3d`].
pub const IMPORTER: Importer = Importer {
    id: "occ3d",
    title: "labels of Occ3D and Nuplan-Occ",
    extensions: &["npz"],
    holds: &[Holds::Occupancy],
    largest: occ3d::LARGEST_FILE,
    recognises: |head| first_entry_ends(head, ".npy"),
    in_folder: None,
    read: |source| match nuplan_occ::list_in(source.bytes) {
        Some(list) => nuplan_occ::read(source, &list).map_err(FormatError::new),
        None => read(source).map_err(FormatError::new),
    },
    #[cfg(test)]
    sample: || occ3d::to_bytes(&crate::table_tests::scene().frame().occupancy),
};

fn read(source: &ImportFile<'_>) -> Result<Content, occ3d::Occ3dError> {
    let found = occ3d::read_found(source.bytes)?;
    let frame = found.frame;
    let mut skipped: BTreeMap<String, usize> = BTreeMap::new();
    if let Some(set) = found.set {
        let renamed = match set.renamed() {
            none if none.is_empty() => "renumbered".to_owned(),
            renamed => format!("shown as classes: {renamed}"),
        };
        let note = format!("labels taken for those of {} and {renamed}", set.title);
        skipped.insert(note, frame.labels.count_set());
    }
    for name in &found.left_out {
        *skipped.entry(format!("array {}", quoted(name, 40))).or_default() += 1;
    }
    // A voxel was seen if any sensor that the file tells of saw it.
    let seen = match (frame.lidar_observed, frame.camera_observed) {
        (Some(lidar), Some(camera)) => Some(lidar.iter().zip(&camera).map(|(a, b)| *a || *b).collect()),
        (one, other) => one.or(other),
    };
    let unobserved = seen.and_then(|seen: Vec<bool>| Unobserved::from_observed(&seen));
    let mut scene = labelled(source.name, frame.labels, unobserved);
    if found.data_labels.is_some() {
        scene.change_canvas(|frame| frame.inferred.data_labels = found.data_labels);
    }
    if let Some(told) = &found.recipe {
        recipe::restore(told, &mut scene);
    }
    Ok(Content::Scene(Box::new(ImportedScene {
        sweep: None,
        scene,
        inferred: &GUESSED,
        skipped,
        notes: Vec::new(),
    })))
}

#[cfg(test)]
mod tests {
    use scene::{Class, Window};

    use super::*;
    use crate::npz::{Array, NpzValues, to_bytes};

    fn npz(arrays: Vec<(&str, Vec<u8>)>) -> Vec<u8> {
        let array = |(name, values)| Array {
            name,
            shape: &[Window::NX, Window::NY, Window::NZ],
            values: NpzValues::U8(values),
        };
        to_bytes(&arrays.into_iter().map(array).collect::<Vec<_>>()).expect("memory")
    }

    fn loaded(bytes: &[u8]) -> ImportedScene {
        let source = ImportFile {
            bytes,
            name: "labels",
            path: None,
            options: Default::default(),
        };
        match read(&source).expect("read") {
            Content::Scene(loaded) => *loaded,
            other => panic!("expected a scene, not {other:?}"),
        }
    }

    /// Labels with a car ahead to the left, all else free.
    fn marker(car: u8, free: u8) -> Vec<u8> {
        let mut labels = vec![free; Window::VOXELS];
        labels[(125 * Window::NY + 110) * Window::NZ + 2] = car;
        labels
    }

    #[test]
    fn three_numberings_give_one_scene_and_say_so() {
        let occ3d = loaded(&npz(vec![("semantics", marker(4, 17))]));
        assert_eq!(occ3d.skipped, BTreeMap::new());
        let openocc = loaded(&npz(vec![
            ("semantics", marker(0, 16)),
            ("flow", vec![0; Window::VOXELS]),
        ]));
        let waymo = loaded(&npz(vec![("voxel_label", marker(1, 23))]));
        for same in [&openocc, &waymo] {
            assert!(same.scene.frame().occupancy == occ3d.scene.frame().occupancy);
        }
        let notes = |loaded: &ImportedScene| {
            loaded
                .skipped
                .iter()
                .map(|(k, n)| format!("{k} {n}"))
                .collect::<Vec<_>>()
        };
        assert_eq!(
            notes(&openocc),
            [
                "array flow 1",
                "labels taken for those of OpenDriveLab's openocc and renumbered 1"
            ]
        );
        assert!(
            notes(&waymo)[0].starts_with(
                "labels taken for those of Occ3D-Waymo and shown as classes: general object as others; vehicle as car; sign, traffic light"
            ),
            "{:?}",
            notes(&waymo)
        );
        // At (10.2, 4.2, 0) m: ahead and to the left.
        let at = occ3d
            .scene
            .frame()
            .extent()
            .voxel_at(glam::DVec3::new(10.2, 4.2, 0.0));
        let [x, y, z] = at.expect("inside");
        assert_eq!(occ3d.scene.frame().occupancy.get(x, y, z), Class::Car.id());
    }

    #[test]
    fn masks_of_waymo_are_masks() {
        let mut seen = vec![1; Window::VOXELS];
        seen[3] = 0;
        let file = npz(vec![
            ("voxel_label", marker(1, 23)),
            ("origin_voxel_state", seen.clone()),
            ("final_voxel_state", vec![0; Window::VOXELS]),
            ("infov", seen),
        ]);
        let loaded = loaded(&file);
        let unobserved = loaded.scene.frame().inferred.unobserved.clone().expect("masks");
        assert_eq!((unobserved.words()[0], unobserved.words()[1]), (1 << 3, 0));
        assert_eq!(loaded.skipped.get("array infov"), Some(&1));
    }

    #[test]
    fn labels_beyond_a_numbering_are_refused() {
        let line = |array, label: u8, free| {
            let mut labels = vec![free; Window::VOXELS];
            labels[16] = label;
            let bytes = npz(vec![(array, labels)]);
            let refused = occ3d::read(&bytes).expect_err("refused");
            refused.to_string()
        };
        assert_eq!(
            line("semantics", 18, 16),
            "array semantics: class 18 at voxel 0, 1, 0, expected 0 to 16"
        );
        assert_eq!(
            line("voxel_label", 17, 23),
            "array voxel_label: class 17 at voxel 0, 1, 0, expected 0 to 15, 23"
        );
        let large = Array {
            name: "voxel_label",
            shape: &[1600, 1600, 64],
            values: NpzValues::U8(vec![23; 1600 * 1600 * 64]),
        };
        let line = occ3d::read(&to_bytes(&[large]).expect("memory")).expect_err("too fine");
        assert!(line.to_string().contains("Occ3D-Waymo at 0.1 m"), "{line}");
    }
}
