//! Depths that the cameras see, as 16-bit pictures.

use scene::sensor_data::depth_mm;

use super::{ExportSpan, Exporter, OutFile, Product};
use crate::{FormatError, Holds, calibration, png, sensor_names};

/// `CAMERA_depth_mm.png` for each camera: millimetres along the optical axis, 0 where there is no depth.
pub const EXPORTER: Exporter = Exporter {
    id: "depth",
    title: "Cameras: depth in millimetres, 16-bit PNG",
    file_name: None,
    holds: &[Holds::Pictures],
    lost: "",
    span: ExportSpan::Moment,
    needs: &[Product::CameraMaps],
    write: |scene, products| {
        let recipe = products.recipe().clone();
        let (mut files, mut size) = (Vec::new(), None);
        products.camera_maps(&mut |m| {
            size = Some([m.width as u32, m.height as u32]);
            let mm = depth_mm(&m.depth_m);
            let bytes = recipe.in_png(false, |text| png::grey16(m.width, m.height, &mm, text));
            let name = format!("{}_depth_mm.png", sensor_names::of_file(&scene.rig, &m.camera));
            files.push(OutFile::new(&name, bytes.map_err(FormatError::new)?));
            Ok(())
        })?;
        let calibration = calibration::to_bytes(scene, &products.world_from_ego(), size);
        files.push(OutFile::new(calibration::FILE, calibration));
        Ok(files)
    },
};
