//! A sequence as KITTI and SemanticKITTI keep it: scans, labels of points, calibration, poses, labels of objects.
//!
//! ```text
//! velodyne/000000.bin   x, y, z in the velodyne's frame in m and remission 0 to 1, f32 each
//! labels/000000.label   u32 a point: class (SemanticKITTI) below, instance above
//! label_2/000000.txt    objects in the picture of the front camera, as the object development kit has them
//! calib/000000.txt      P0 to P3, R0_rect, Tr_velo_to_cam, Tr_imu_to_velo, for those objects
//! calib.txt             P0 to P3 and Tr, as the odometry development kit has them; and Tr_ego_to_velo
//! poses.txt             the reference camera in the frame of the first one, 12 numbers a line
//! times.txt             s from the first scan on
//! ```
//!
//! The velodyne is the rig's first LiDAR, its axes along the vehicle ([`crate::kitti`]). The cameras 0 to 3 are all the rig's
//! front camera. Its rectified frame is level: P takes points of it to pixels of the camera as it is mounted.

mod camera;
mod objects;

use scene::{LidarSweep, Pose, Scene, SceneBox};

use self::camera::FrontCamera;
use super::{ExportSpan, Exporter, OutFile, Product, Products};
use crate::kitti::{EGO_TO_VELO, ego_from_velo, matrix_of};
use crate::physical::to_physical_ground;
use crate::{FormatError, Holds, semantic_kitti};

/// See the module.
pub const EXPORTER: Exporter = Exporter {
    id: "kitti",
    title: "KITTI sequence: scans, SemanticKITTI labels, calibration, poses, objects of the front camera",
    file_name: None,
    holds: &[Holds::Points],
    lost: "all but the first scan, and its single points: they come back as voxels with the class of most of them; barriers as \
           manmade, cones as others, construction vehicles as trailers",
    span: ExportSpan::Clip,
    needs: &[Product::Sweep],
    write,
};

/// Time between scans, s.
const STEP_S: f64 = 0.1;
/// Most scans.
const MOST: usize = 1000;
/// Points up to this far beyond a box belong to it, m.
const MARGIN_M: f64 = 0.25;

fn write(scene: &Scene, products: &mut dyn Products) -> Result<Vec<OutFile>, FormatError> {
    let velo = ego_from_velo(&scene.rig).ok_or_else(|| FormatError::new("the rig has no LiDAR"))?;
    let camera = FrontCamera::from_rig(&scene.rig);
    let times_s = times_s(scene)?;
    let mut files = Vec::new();
    let (mut poses, mut seconds) = (String::new(), String::new());
    let mut first = None;
    for (i, time_s) in times_s.iter().enumerate() {
        products.show(*time_s)?;
        let moment = scene.at(*time_s);
        let mut sweep = products.sweep()?;
        to_physical_ground(&mut sweep, velo.translation_m, moment.frame());
        let ego = moment.in_ego();
        let boxes: Vec<&SceneBox> = ego.frame().boxes.values().collect();
        let named = |ending: &str| format!("{i:06}.{ending}");
        files.push(OutFile::new(&named("bin"), scan(&sweep, &velo)).within("velodyne"));
        files.push(OutFile::new(&named("label"), labels(&sweep, &boxes)).within("labels"));
        if let Some(camera) = &camera {
            let text = objects::to_text(ego.frame(), camera);
            files.push(OutFile::new(&named("txt"), text.into_bytes()).within("label_2"));
        }
        let calibration = calibration(camera.as_ref(), &velo, true);
        files.push(OutFile::new(&named("txt"), calibration.into_bytes()).within("calib"));
        let world_from_camera = moment.frame().world_from_ego * ego_from_rect(camera.as_ref(), &velo);
        let first = *first.get_or_insert(world_from_camera);
        poses += &line(&matrix_of(&(first.inverse() * world_from_camera)));
        seconds += &format!("{:.6e}\n", time_s - times_s[0]);
    }
    let calibration = calibration(camera.as_ref(), &velo, false);
    files.push(OutFile::new("calib.txt", calibration.into_bytes()));
    files.push(OutFile::new("poses.txt", poses.into_bytes()));
    files.push(OutFile::new("times.txt", seconds.into_bytes()));
    Ok(files)
}

/// Moments from the start of the clip to its end; the moment shown alone where nothing moves. Errors if they are too many.
fn times_s(scene: &Scene) -> Result<Vec<f64>, FormatError> {
    let clip = scene.clip();
    if clip.stands() || clip.length_s <= 0.0 {
        return Ok(vec![scene.time_s()]);
    }
    let last = (clip.length_s / STEP_S + 1e-6).floor() as usize;
    if last >= MOST {
        return Err(FormatError::new(format!(
            "{} scans in {:.1} s, expected at most {MOST}",
            last + 1,
            clip.length_s
        )));
    }
    Ok((0..=last)
        .map(|i| (i as f64 * STEP_S).min(clip.length_s))
        .collect())
}

fn scan(sweep: &LidarSweep, ego_from_velo: &Pose) -> Vec<u8> {
    let velo_from_ego = ego_from_velo.inverse();
    let mut out = Vec::with_capacity(sweep.points.len() * 16);
    for p in &sweep.points {
        let at = velo_from_ego.apply(glam::DVec3::from_array(p.position_in_ego.map(f64::from)));
        let [x, y, z] = at.as_vec3().to_array();
        let remission = (p.intensity / 255.0).clamp(0.0, 1.0);
        out.extend([x, y, z, remission].into_iter().flat_map(f32::to_le_bytes));
    }
    out
}

/// Labels of the points; boxes are in the ego frame. The instance of an object's point is the place of its box in the
/// list, from 1; that of any other point is 0.
fn labels(sweep: &LidarSweep, boxes: &[&SceneBox]) -> Vec<u8> {
    let mut out = Vec::with_capacity(sweep.points.len() * 4);
    for p in &sweep.points {
        let at = glam::DVec3::from_array(p.position_in_ego.map(f64::from));
        let holds = |b: &&SceneBox| b.class == p.class && b.contains(at, MARGIN_M);
        let instance = match p.class.is_object() {
            true => boxes.iter().position(holds).map_or(0, |i| i + 1),
            false => 0,
        };
        let moves = p.velocity_mps != [0.0; 2];
        let class = semantic_kitti::label_of(p.class, moves);
        // A frame holds fewer boxes than 16 bits can name.
        let instance = u16::try_from(instance).unwrap_or_default();
        out.extend((u32::from(instance) << 16 | u32::from(class)).to_le_bytes());
    }
    out
}

/// The level frame of the reference camera; without a front camera at the LiDAR.
fn ego_from_rect(camera: Option<&FrontCamera>, velo: &Pose) -> Pose {
    camera.map_or_else(
        || camera::level(glam::DVec2::X, velo.translation_m),
        |c| c.ego_from_rect,
    )
}

/// Lines of the object development kit (`calib/000000.txt`), or those of the odometry one (`calib.txt`).
fn calibration(camera: Option<&FrontCamera>, velo: &Pose, of_objects: bool) -> String {
    let flat = [1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0];
    let projection = camera.map_or(flat, FrontCamera::projection);
    let mut out: String = (0..4).map(|i| format!("P{i}: {}", line(&projection))).collect();
    let rect_from_velo = matrix_of(&(ego_from_rect(camera, velo).inverse() * *velo));
    let velo_from_ego = matrix_of(&velo.inverse());
    match of_objects {
        true => {
            out += "R0_rect: 1 0 0 0 1 0 0 0 1\n";
            out += &format!("Tr_velo_to_cam: {}", line(&rect_from_velo));
            out += &format!("Tr_imu_to_velo: {}", line(&velo_from_ego));
        }
        false => {
            out += &format!("Tr: {}", line(&rect_from_velo));
            out += &format!("{EGO_TO_VELO}: {}", line(&velo_from_ego));
        }
    }
    out
}

/// Numbers with blanks between them, and the end of the line.
fn line(numbers: &[f64]) -> String {
    let words: Vec<String> = numbers.iter().map(|v| format!("{v:.12e}")).collect();
    words.join(" ") + "\n"
}

#[cfg(test)]
mod tests;
