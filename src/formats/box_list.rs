//! Boxes as a JSON file for other programs.
//!
//! `{"format": "sceneloom_boxes", "version": 1, "scene": name, "time_s": s, "frame": "ego: x forward, y left, z up, m",
//! "boxes": […]}`, each box with `id`; `class` and `class_id` (Occ3D); `center_m` [x, y, z]; `size_m` [length, width, height];
//! `yaw_rad` counter-clockwise from ego x and the same turn as `rotation_wxyz`; `velocity_mps` [x, y] over ground; and, where
//! known, `num_lidar_pts` and `camera_pixels` (returns and pixels of all sensors of a kind together); last `recipe`, how the file came to be ([`Recipe`]). Numbers read back
//! as the very numbers that were written.

use std::collections::BTreeMap;

use glam::{DVec2, DVec3};
use serde::{Deserialize, Serialize};
use serde_json::Value;

use crate::recipe::Recipe;

use scene::message::{one_line, quoted};
use scene::{BoxId, BoxLabel, Class, Frame, SceneBox};

const FORMAT: &str = "sceneloom_boxes";
const VERSION: u32 = 1;
const FRAME: &str = "ego: x forward, y left, z up, m";

#[derive(Serialize, Deserialize)]
struct List {
    format: String,
    version: u32,
    scene: String,
    time_s: f64,
    frame: String,
    boxes: Vec<BoxRecord>,
    #[serde(default, skip_serializing_if = "Value::is_null")]
    recipe: Value,
}

#[derive(Serialize, Deserialize)]
struct BoxRecord {
    id: BoxId,
    class: Class,
    class_id: u8,
    center_m: DVec3,
    size_m: DVec3,
    yaw_rad: f64,
    rotation_wxyz: [f64; 4],
    velocity_mps: DVec2,
    #[serde(default, skip_serializing_if = "BoxLabel::is_empty")]
    label: BoxLabel,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    num_lidar_pts: Option<u32>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    camera_pixels: Option<u32>,
}

/// How often sensors saw each box; a box that is missing counts as 0.
pub type SightingCounts<'a> = Option<&'a BTreeMap<BoxId, u32>>;

/// The boxes of a frame as the bytes of such a file. Errors if JSON cannot hold them: a number is not finite.
pub fn to_bytes(
    scene: &str,
    frame: &Frame,
    lidar: SightingCounts<'_>,
    camera: SightingCounts<'_>,
    recipe: Option<&Recipe>,
) -> Result<Vec<u8>, String> {
    if let Some(problem) = frame.boxes.values().find_map(SceneBox::problem) {
        return Err(problem);
    }
    let entry = |b: &SceneBox| {
        let (sin, cos) = (b.yaw_rad / 2.0).sin_cos();
        let count = |of: SightingCounts<'_>| of.map(|counts| counts.get(&b.id).copied().unwrap_or(0));
        BoxRecord {
            id: b.id,
            class: b.class,
            class_id: b.class.id(),
            center_m: b.center_m,
            size_m: b.size_m,
            yaw_rad: b.yaw_rad,
            rotation_wxyz: [cos, 0.0, 0.0, sin],
            velocity_mps: b.velocity_mps,
            label: b.label,
            num_lidar_pts: count(lidar),
            camera_pixels: count(camera),
        }
    };
    let list = List {
        format: FORMAT.into(),
        version: VERSION,
        scene: scene.into(),
        time_s: frame.time_s,
        frame: FRAME.into(),
        boxes: frame.boxes.values().map(entry).collect(),
        recipe: recipe
            .map_or(Ok(Value::Null), serde_json::to_value)
            .map_err(|e| e.to_string())?,
    };
    let mut bytes = serde_json::to_vec_pretty(&list).map_err(|e| e.to_string())?;
    bytes.push(b'\n');
    Ok(bytes)
}

/// True if the bytes say that they are such a file.
fn is_named(bytes: &[u8]) -> bool {
    bytes.windows(FORMAT.len()).any(|w| w == FORMAT.as_bytes())
}

/// The boxes in the bytes of such a file, and its recipe (null if it has none). Errors in one line.
pub fn read(bytes: &[u8]) -> Result<(Vec<SceneBox>, Value), String> {
    let list: List = serde_json::from_slice(bytes).map_err(|e| match is_named(bytes) {
        true => one_line(&e),
        false => one_line(&format_args!(
            "no list of boxes ({e}), expected \"format\": {FORMAT:?} and \"boxes\" in JSON"
        )),
    })?;
    if (list.format.as_str(), list.version) != (FORMAT, VERSION) {
        return Err(format!(
            "format is {:?} version {}, expected {FORMAT:?} version {VERSION}",
            quoted(&list.format, 80),
            list.version
        ));
    }
    let boxes: Vec<SceneBox> = list
        .boxes
        .iter()
        .map(|e| SceneBox {
            id: e.id,
            class: e.class,
            center_m: e.center_m,
            size_m: e.size_m,
            yaw_rad: e.yaw_rad,
            velocity_mps: e.velocity_mps,
            label: e.label,
        })
        .collect();
    match boxes.iter().find_map(SceneBox::problem) {
        Some(problem) => Err(problem),
        None => Ok((boxes, list.recipe)),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use scene::{BevLayout, VoxelGrid};

    #[test]
    fn boxes_come_back_bit_by_bit() {
        let b = SceneBox {
            id: BoxId(7),
            class: Class::Truck,
            center_m: DVec3::new(0.1 + 0.2, -1e-9, 1.4),
            size_m: DVec3::new(6.9, 2.5, 2.85),
            yaw_rad: 2.0f64.sqrt(),
            velocity_mps: DVec2::new(1.0 / 3.0, 0.0),
            label: BoxLabel::default(),
        };
        let mut frame = Frame::new(BevLayout::default(), [(b.id, b)].into(), VoxelGrid::new());
        let counts = [(BoxId(7), 31)].into();
        let bytes = to_bytes("a scene", &frame, Some(&counts), None, None).expect("finite");
        assert_eq!(read(&bytes).expect("ours"), (vec![b], Value::Null));
        let recipe = Recipe {
            seed: 9,
            ..Recipe::default()
        };
        let with = to_bytes("a scene", &frame, None, None, Some(&recipe)).expect("finite");
        assert_eq!(read(&with).expect("ours").1["seed"], 9);
        let text = String::from_utf8(bytes).expect("UTF-8");
        assert!(text.contains("\"num_lidar_pts\": 31") && !text.contains("camera_pixels"));
        assert!(
            read(text.replace("sceneloom_boxes", "other").as_bytes())
                .expect_err("foreign")
                .contains("other")
        );
        read(b"{").expect_err("no JSON");
        frame.boxes.get_mut(&BoxId(7)).expect("there").center_m.x = f64::NAN;
        assert!(
            to_bytes("a scene", &frame, None, None, None)
                .expect_err("NaN")
                .contains("center_m")
        );
    }
}
