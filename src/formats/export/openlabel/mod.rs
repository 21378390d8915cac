//! ASAM OpenLABEL 1.0.0: boxes of a clip as labels, one JSON file.
//!
//! Coordinate systems: `odom` (the world frame), in it `vehicle-iso8855` (the ego frame), in that every sensor. Every moment
//! of the clip's rate is a frame with its time in s and the transform of the vehicle to `odom`. Cuboids are in `odom`: x, y, z,
//! a quaternion x, y, z, w, then length, width, height in m. Matrices are row-major and take points of the inner system to the
//! outer one. Intrinsics are at the rig's own size. The prompt, time of day and weather are tags.

use scene::{Camera, Lens, Pose, Scene, SceneBox};
use serde_json::{Map, Value, json};

use super::{ExportSpan, Exporter, OutFile, Products};
use crate::sensor_names::{self, LIDAR};
use crate::{FormatError, Holds, moments, recipe};

/// See the module.
pub const EXPORTER: Exporter = Exporter {
    id: "openlabel",
    title: "OpenLABEL 1.0.0: boxes of a clip as labels, with sensors and vehicle, JSON",
    file_name: Some("openlabel.json"),
    holds: &[Holds::Boxes],
    lost: "",
    span: ExportSpan::Clip,
    needs: &[],
    write: |scene, products| Ok(vec![OutFile::new("openlabel.json", to_bytes(scene, products)?)]),
};

/// The world frame.
const ODOM: &str = "odom";
/// The ego frame, as the standard calls it.
const VEHICLE: &str = "vehicle-iso8855";
/// Key of the one ontology.
const ONTOLOGY: &str = "0";

/// The file.
fn to_bytes(scene: &Scene, products: &mut dyn Products) -> Result<Vec<u8>, FormatError> {
    if let Some(problem) = scene.rig.problem() {
        return Err(FormatError::new(problem));
    }
    let cameras = sensor_names::cameras(&scene.rig);
    let times_s = moments::times_s(scene, scene.clip().rate_hz);
    let (mut frames, mut objects) = (Map::new(), Objects::new());
    for (i, &time_s) in times_s.iter().enumerate() {
        products.show(time_s)?;
        let now = scene.at(time_s);
        let mut in_frame = Map::new();
        for b in now.frame().boxes.values() {
            if let Some(problem) = b.problem() {
                return Err(FormatError::new(problem));
            }
            in_frame.insert(b.id.0.to_string(), json!({"object_data": data(b)}));
            objects.entry(b.id).or_insert_with(|| (*b, Vec::new())).1.push(i);
        }
        let pose = now.frame().world_from_ego;
        let to_odom = json!({"src": VEHICLE, "dst": ODOM, "transform_src_to_dst": matrix(&pose)});
        let properties = json!({
            "timestamp": time_s,
            "transforms": {format!("{VEHICLE}_to_{ODOM}"): to_odom},
        });
        frames.insert(
            i.to_string(),
            json!({"frame_properties": properties, "objects": in_frame}),
        );
    }
    let objects: Map<String, Value> = objects
        .into_iter()
        .map(|(id, (b, at))| (id.0.to_string(), object(&b, &at)))
        .collect();
    let file = json!({"openlabel": {
        "metadata": {
            "schema_version": "1.0.0",
            "name": &*scene.name,
            "annotator": concat!("sceneloom ", env!("CARGO_PKG_VERSION")),
            "comment": "a scene that was made, not measured",
            (recipe::NAME): products.recipe(),
        },
        "ontologies": {ONTOLOGY: "urn:sceneloom:nuscenes-classes"},
        "coordinate_systems": coordinate_systems(scene, &cameras),
        "streams": streams(scene, &cameras),
        "tags": tags(scene),
        "objects": objects,
        "frame_intervals": [{"frame_start": 0, "frame_end": times_s.len() - 1}],
        "frames": frames,
    }});
    serde_json::to_vec(&file).map_err(FormatError::new)
}

/// Boxes of the objects when they first appear, and the frames that they are in.
type Objects = std::collections::BTreeMap<scene::BoxId, (SceneBox, Vec<usize>)>;

/// An object through the clip.
fn object(b: &SceneBox, frames: &[usize]) -> Value {
    let intervals = intervals(frames);
    let mut texts = Vec::new();
    if !b.label.name.is_empty() {
        texts.push(json!({"name": "name", "val": b.label.name.as_str()}));
    }
    if let Some(paint) = b.label.paint {
        texts.push(json!({"name": "paint", "val": paint.name()}));
    }
    let pointer = |kind: &str| json!({"type": kind, "frame_intervals": intervals});
    let mut out = json!({
        "name": format!("{} {}", b.called(), b.id.0),
        "type": b.class.name(),
        "ontology_uid": ONTOLOGY,
        "coordinate_system": ODOM,
        "frame_intervals": intervals,
        "object_data_pointers": {"shape": pointer("cuboid"), "velocity_mps": pointer("vec")},
    });
    if !texts.is_empty() {
        out["object_data"] = json!({"text": texts});
    }
    out
}

/// Where an object is in a frame, and how fast over the ground.
fn data(b: &SceneBox) -> Value {
    let (sin, cos) = (b.yaw_rad / 2.0).sin_cos();
    let ([x, y, z], [length, width, height]) = (b.center_m.to_array(), b.size_m.to_array());
    json!({
        "cuboid": [{
            "name": "shape",
            "coordinate_system": ODOM,
            "val": [x, y, z, 0.0, 0.0, sin, cos, length, width, height],
        }],
        "vec": [{"name": "velocity_mps", "coordinate_system": ODOM, "val": b.velocity_mps.to_array()}],
    })
}

/// Runs of frames, both ends included.
fn intervals(frames: &[usize]) -> Value {
    let runs = frames.chunk_by(|a, b| a + 1 == *b);
    runs.map(|run| json!({"frame_start": run[0], "frame_end": run[run.len() - 1]}))
        .collect()
}

fn coordinate_systems(scene: &Scene, cameras: &[String]) -> Value {
    let rig = &scene.rig;
    let of_cameras = rig.cameras.iter().zip(cameras);
    let sensors = of_cameras.map(|(camera, name)| (name.as_str(), camera.ego_from_camera()));
    let lidar = rig.lidars.first().map(|lidar| (LIDAR, lidar.ego_from_sensor()));
    let mut names = Vec::new();
    let mut out = Map::new();
    for (name, pose) in sensors.chain(lidar) {
        let system = json!({
            "type": "sensor_cs", "parent": VEHICLE, "children": [], "pose_wrt_parent": matrix(&pose),
        });
        out.insert(name.into(), system);
        names.push(name);
    }
    let start = scene.at(0.0).frame().world_from_ego;
    let vehicle = json!({
        "type": "local_cs", "parent": ODOM, "children": names, "pose_wrt_parent": matrix(&start),
    });
    let odom = json!({"type": "scene_cs", "parent": "", "children": [VEHICLE]});
    out.insert(VEHICLE.into(), vehicle);
    out.insert(ODOM.into(), odom);
    out.into()
}

fn streams(scene: &Scene, cameras: &[String]) -> Value {
    let camera = |(camera, name): (&Camera, &String)| {
        let ([fx, fy], [cx, cy]) = (camera.focal_px, camera.center_px);
        let size = |mut intrinsics: Value| {
            intrinsics["width_px"] = camera.width.into();
            intrinsics["height_px"] = camera.height.into();
            intrinsics
        };
        // Of OpenCV's order, in which p1 and p2 come after k2.
        let matrix = |k: [f64; 6], p: [f64; 2]| {
            let intrinsics = json!({
                "camera_matrix": [fx, 0.0, cx, 0.0, 0.0, fy, cy, 0.0, 0.0, 0.0, 1.0, 0.0],
                "distortion_coeffs": [k[0], k[1], p[0], p[1], k[2], k[3], k[4], k[5]],
            });
            json!({"intrinsics_pinhole": size(intrinsics)})
        };
        let properties = match camera.lens {
            Lens::Pinhole => matrix([0.0; 6], [0.0; 2]),
            Lens::Distorted { k, p } => matrix(k, p),
            Lens::Fisheye { k, .. } => json!({"intrinsics_fisheye": size(json!({
                "center_x_px": cx, "center_y_px": cy, "focal_length_x": fx, "focal_length_y": fy, "lens_coeffs": k,
            }))}),
            Lens::FTheta { c, .. } => json!({"intrinsics_custom": size(json!({
                "model": "f_theta", "center_px": [cx, cy], "focal_px": [fx, fy], "coefficients": c,
            }))}),
        };
        let stream = json!({
            "type": "camera", "description": "", "uri": "", "stream_properties": properties,
        });
        (name.clone(), stream)
    };
    let mut out: Map<String, Value> = scene.rig.cameras.iter().zip(cameras).map(camera).collect();
    if !scene.rig.lidars.is_empty() {
        out.insert(
            LIDAR.into(),
            json!({"type": "lidar", "description": "", "uri": ""}),
        );
    }
    out.into()
}

fn tags(scene: &Scene) -> Value {
    let conditions = &scene.conditions;
    let text = |kind: &str, said: &str| {
        json!({
            "type": kind,
            "ontology_uid": ONTOLOGY,
            "tag_data": {"text": [{"name": kind, "type": "value", "val": said}]},
        })
    };
    json!({
        "0": text("time_of_day", conditions.time.name()),
        "1": text("weather", conditions.weather.name()),
        "2": text("prompt", &scene.prompt),
    })
}

/// 4 x 4, row by row.
fn matrix(pose: &Pose) -> Value {
    let [x, y, z] = [glam::DVec3::X, glam::DVec3::Y, glam::DVec3::Z].map(|axis| pose.rotation * axis);
    let t = pose.translation_m;
    json!({"matrix4x4": [
        x.x, y.x, z.x, t.x, x.y, y.y, z.y, t.y, x.z, y.z, z.z, t.z, 0.0, 0.0, 0.0, 1.0,
    ]})
}

#[cfg(test)]
mod tests;
