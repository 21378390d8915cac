//! A list of boxes: a scene of them alone, on open ground, with the draft of their voxels.

use std::collections::BTreeMap;
use std::sync::Arc;

use scene::{BevLayout, Frame, Scene, SensorRig, draft};

use super::{Content, ImportedScene, Importer};
use crate::{FormatError, Holds, box_list, input, recipe};

/// See [`box_list`].
pub const IMPORTER: Importer = Importer {
    id: "boxes",
    title: "lists of boxes",
    extensions: &["json"],
    holds: &[Holds::Boxes],
    largest: input::LARGEST_TEXT,
    recognises: |head| {
        let text = String::from_utf8_lossy(head);
        text.contains("\"sceneloom_boxes\"")
    },
    in_folder: None,
    read: |source| {
        let (list, recipe) = box_list::read(source.bytes).map_err(FormatError::new)?;
        let found = list.len();
        let boxes: BTreeMap<_, _> = list.into_iter().map(|b| (b.id, b)).collect();
        if boxes.len() < found {
            return Err(FormatError::new("two boxes have the same id"));
        }
        let layout = BevLayout::default();
        let occupancy = draft::draft(&layout, boxes.values());
        let frame = Frame::new(layout, boxes, occupancy);
        let mut scene = Scene::single(source.name, frame, Arc::new(SensorRig::default()), 0);
        recipe::restore(&recipe, &mut scene);
        Ok(Content::Scene(Box::new(ImportedScene {
            sweep: None,
            scene,
            inferred: &[],
            skipped: BTreeMap::new(),
            notes: Vec::new(),
        })))
    },
    #[cfg(test)]
    sample: || {
        box_list::to_bytes("s", crate::table_tests::scene().frame(), None, None, None).expect("finite")
    },
};
