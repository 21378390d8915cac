//! Pictures with the truth about them, from the same hits: classes, instances, depths, normals, flow, boxes.

use scene::sensor_data::depth_mm;
use scene::truth::{self, CameraTruth, SeenBox};
use serde_json::{Value, json};

use super::{ExportPicture, ExportSpan, Exporter, OutFile, Product};
use crate::npz::{self, Array, NpzValues};
use crate::recipe::{self, Recipe};
use crate::{FormatError, Holds, calibration, png, sensor_names};

/// For each camera `CAMERA.png`, `CAMERA_class.png`, `CAMERA_instance.png`, `CAMERA_depth_mm.png`, `CAMERA_normal.png` and
/// `CAMERA_truth.npz`; for all `truth.json` (boxes and classes) and `calibration.json`.
pub const EXPORTER: Exporter = Exporter {
    id: "truth",
    title: "Cameras: pictures with class, instance, depth, normal, flow and boxes of every pixel",
    file_name: None,
    holds: &[Holds::Pictures],
    lost: "",
    span: ExportSpan::Moment,
    needs: &[Product::Truth],
    write: |scene, products| {
        let recipe = products.recipe().clone();
        let (mut files, mut cameras, mut size) = (Vec::new(), Vec::new(), None);
        products.truth(&mut |picture, truth| {
            size = Some([truth.width as u32, truth.height as u32]);
            let name = sensor_names::of_file(&scene.rig, &truth.camera.name);
            files.extend(of_camera(&recipe, &name, &picture, &truth)?);
            cameras.push(boxes(&truth));
            Ok(())
        })?;
        files.push(summary(&recipe, cameras)?);
        let world_from_ego = products.world_from_ego();
        let calibration = calibration::to_bytes(scene, &world_from_ego, size);
        files.push(OutFile::new(calibration::FILE, calibration));
        Ok(files)
    },
};

/// The files of one camera, which begin with a name (see [`sensor_names::of_file`]). Errors if a picture has no pixel.
pub fn of_camera(
    recipe: &Recipe,
    name: &str,
    picture: &ExportPicture,
    truth: &CameraTruth,
) -> Result<Vec<OutFile>, FormatError> {
    let (w, h) = (truth.width, truth.height);
    let mut files = Vec::new();
    let mut add = |ending: &str, bytes: Result<Vec<u8>, png::PngError>| -> Result<(), FormatError> {
        let bytes = bytes.map_err(FormatError::new)?;
        files.push(OutFile::new(&format!("{name}{ending}"), bytes));
        Ok(())
    };
    let own = recipe.in_png(true, |text| {
        png::rgba(picture.width, picture.height, &picture.rgba, text)
    });
    add(".png", own)?;
    recipe.in_png(false, |text| {
        // Outside the lens is one past the last class, so that the palette stays short.
        let labels = truth.plane(|p| p.class.min(truth::STOP_LINE + 1));
        add("_class.png", png::indexed(w, h, &labels, &palette(), text))?;
        let ids = truth.plane(|p| p.instance.min(u32::from(u16::MAX)) as u16);
        add("_instance.png", png::grey16(w, h, &ids, text))?;
        let mm = depth_mm(&truth.plane(|p| p.depth_m));
        add("_depth_mm.png", png::grey16(w, h, &mm, text))?;
        let normals: Vec<u8> = truth
            .pixels
            .iter()
            .flat_map(|p| normal_rgba(p.normal_in_camera))
            .collect();
        add("_normal.png", png::rgba(w, h, &normals, text))
    })?;
    let bytes = arrays(truth).map_err(FormatError::new)?;
    files.push(OutFile::new(&format!("{name}_truth.npz"), bytes));
    Ok(files)
}

/// Colour of a normal as in the view *Normals*: right red, up green, towards the camera blue; grey where there is none.
fn normal_rgba([x, y, z]: [f32; 3]) -> [u8; 4] {
    let [r, g, b] = [x, -y, -z].map(|v| ((v * 0.5 + 0.5).clamp(0.0, 1.0) * 255.0).round() as u8);
    [r, g, b, 255]
}

fn palette() -> Vec<[u8; 3]> {
    (0..=truth::STOP_LINE).map(truth::color).chain([[0; 3]]).collect()
}

/// `class` u8, `instance` u32, `depth_m` f32, each [h, w]; with a next moment `flow_px` f32 [h, w, 2].
fn arrays(truth: &CameraTruth) -> std::io::Result<Vec<u8>> {
    let (flat, pairs) = ([truth.height, truth.width], [truth.height, truth.width, 2]);
    let array = |name, values| Array {
        name,
        shape: &flat,
        values,
    };
    let mut arrays = vec![
        array("class", NpzValues::U8(truth.plane(|p| p.class))),
        array("instance", NpzValues::U32(truth.plane(|p| p.instance))),
        array("depth_m", NpzValues::F32(truth.plane(|p| p.depth_m))),
    ];
    if truth.flow_s.is_some() {
        arrays.push(Array {
            name: "flow_px",
            shape: &pairs,
            values: NpzValues::F32(truth.pixels.iter().flat_map(|p| p.flow_px).collect()),
        });
    }
    npz::to_bytes(&arrays)
}

/// The boxes that one camera sees, as JSON.
pub fn boxes(truth: &CameraTruth) -> Value {
    json!({
        "camera": truth.camera.name,
        "width": truth.width,
        "height": truth.height,
        "flow_s": truth.flow_s,
        "boxes": truth.boxes.iter().map(seen).collect::<Vec<_>>(),
    })
}

fn seen(b: &SeenBox) -> Value {
    let of = &b.of;
    json!({
        "id": of.id,
        "class": of.class,
        "class_id": truth::of_class(of.class),
        "center_m": of.center_m,
        "size_m": of.size_m,
        "yaw_rad": of.yaw_rad,
        "velocity_mps": of.velocity_mps,
        "center_in_camera_m": b.center_in_camera_m,
        "corners_px": b.corners_px,
        "visible_px": b.visible_px,
        "whole_px": b.whole_px,
        "visibility": b.visibility,
        "in_picture": b.in_picture,
        "visible_bounds_px": b.visible_bounds_px,
        "whole_bounds_px": b.whole_bounds_px,
    })
}

/// `truth.json`: the boxes of all cameras and the names of the classes.
pub fn summary(recipe: &Recipe, cameras: Vec<Value>) -> Result<OutFile, FormatError> {
    let names = truth::class_names();
    let class =
        |(i, name): (usize, String)| json!({ "index": i, "name": name, "rgb": truth::color(i as u8) });
    let mut classes: Vec<Value> = names.into_iter().enumerate().map(class).collect();
    classes.push(
        json!({ "index": truth::STOP_LINE + 1, "name": "outside the lens (255 in npz)", "rgb": [0, 0, 0] }),
    );
    let value = json!({
        "format": "sceneloom_truth",
        "version": 1,
        "frame": "boxes: ego, x forward, y left, z up, m; sizes length, width, height; corners by the signs along x, y, z",
        "classes": classes,
        "cameras": cameras,
        recipe::NAME: recipe,
    });
    let text = serde_json::to_string_pretty(&value).map_err(FormatError::new)?;
    Ok(OutFile::new("truth.json", text.into_bytes()))
}
