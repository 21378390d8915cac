//! Pictures that the cameras take.

use super::{ExportSpan, Exporter, OutFile, Product};
use crate::{FormatError, Holds, calibration, png, sensor_names};

/// `CAMERA.png` for each camera.
pub const EXPORTER: Exporter = Exporter {
    id: "pictures",
    title: "Cameras: pictures in the prompt's weather, PNG",
    file_name: None,
    holds: &[Holds::Pictures],
    lost: "",
    span: ExportSpan::Moment,
    needs: &[Product::Pictures],
    write: |scene, products| {
        let recipe = products.recipe().clone();
        let (mut files, mut size) = (Vec::new(), None);
        products.pictures(&mut |p| {
            size = Some([p.width as u32, p.height as u32]);
            let bytes = recipe.in_png(true, |text| png::rgba(p.width, p.height, &p.rgba, text));
            let name = format!("{}.png", sensor_names::of_file(&scene.rig, &p.camera));
            files.push(OutFile::new(&name, bytes.map_err(FormatError::new)?));
            Ok(())
        })?;
        let calibration = calibration::to_bytes(scene, &products.world_from_ego(), size);
        files.push(OutFile::new(calibration::FILE, calibration));
        Ok(files)
    },
};
