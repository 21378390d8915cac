//! Boxes with their numbers.

use super::{ExportSpan, Exporter, OutFile, Product};
use crate::{FormatError, Holds, box_list};

/// See [`box_list`].
pub const EXPORTER: Exporter = Exporter {
    id: "boxes",
    title: "Boxes: JSON with centre, size, heading, velocity, LiDAR points",
    file_name: Some("boxes.json"),
    holds: &[Holds::Boxes],
    lost: "",
    span: ExportSpan::Moment,
    needs: &[Product::Seen],
    write: |scene, products| {
        let recipe = products.recipe().clone();
        let seen = products.seen()?;
        let (lidar, camera) = (seen.lidar_returns.as_ref(), seen.camera_pixels.as_ref());
        let bytes = box_list::to_bytes(&scene.name, scene.frame(), lidar, camera, Some(&recipe))
            .map_err(FormatError::new)?;
        Ok(vec![OutFile::new("boxes.json", bytes)])
    },
};
