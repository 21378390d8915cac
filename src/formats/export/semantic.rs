//! Classes that the cameras see, as pictures with a palette, and the palette as JSON.

use scene::sensor_data::{RENDER_IDS, RenderId, render_id_color};
use scene::{CameraMaps, Class};
use serde_json::json;

use super::{ExportSpan, Exporter, OutFile, Product};
use crate::{FormatError, Holds, calibration, png, sensor_names};

/// `CAMERA_semantic.png` for each camera, and `classes.json`.
pub const EXPORTER: Exporter = Exporter {
    id: "semantic",
    title: "Cameras: class maps, PNG with palette, and classes.json",
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
            let labels = labels(&m);
            let bytes = recipe.in_png(false, |text| {
                png::indexed(m.width, m.height, &labels, &palette(), text)
            });
            let name = format!("{}_semantic.png", sensor_names::of_file(&scene.rig, &m.camera));
            files.push(OutFile::new(&name, bytes.map_err(FormatError::new)?));
            Ok(())
        })?;
        let classes: Vec<_> = (0..=OTHERS)
            .map(|id| json!({ "index": id, "name": label_name(id), "rgb": palette()[usize::from(id)] }))
            .collect();
        let text = serde_json::to_string_pretty(&json!({ "classes": classes })).map_err(FormatError::new)?;
        files.push(OutFile::new("classes.json", text.into_bytes()));
        let calibration = calibration::to_bytes(scene, &products.world_from_ego(), size);
        files.push(OutFile::new(calibration::FILE, calibration));
        Ok(files)
    },
};

/// Label of the class "others", which shares render id 0 with pixels that show nothing.
const OTHERS: u8 = RENDER_IDS as u8;

/// Labels of a map: render ids, and [`OTHERS`] where a surface of that class is.
fn labels(maps: &CameraMaps) -> Vec<u8> {
    let others = |at: usize| maps.coverage[at] > 0.5 && maps.depth_m[at] > 0.0;
    let of = |(at, id): (usize, &RenderId)| if *id == 0 && others(at) { OTHERS } else { *id };
    maps.semantic.iter().enumerate().map(of).collect()
}

fn palette() -> Vec<[u8; 3]> {
    let ids = (0..RENDER_IDS as u8).map(render_id_color);
    ids.chain([Class::Others.color()]).collect()
}

fn label_name(label: u8) -> &'static str {
    match label {
        0 => "nothing",
        17 => "ped_crossing",
        18 => "road_divider",
        19 => "lane_divider",
        OTHERS => "others",
        class => Class::from_id(class).map_or("unknown", Class::name),
    }
}
