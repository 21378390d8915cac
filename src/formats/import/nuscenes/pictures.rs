//! The cameras' pictures of a folder of tables, drive by drive: one's own recordings as data to train on.

use std::collections::{HashMap, HashSet};
use std::path::{Path, PathBuf};

use scene::message::quoted;
use scene::{Camera, Pose, Scene, SensorRig};

use super::occupancy::in_data_set;
use super::{IMPORTER, in_folder, read, read_drive, rows};
use crate::import::{ImportFile, scene_name};
use crate::nuscenes::pose;
use crate::nuscenes::tables::{CalibratedSensor, EgoPose, NuscenesSample, NuscenesSensor, SampleData};
use crate::{FormatError, input};

/// Cameras of a ring.
pub const VIEWS: usize = 6;
/// Largest picture, bytes.
const LARGEST_PICTURE: u64 = 64 << 20;
/// Longest side of a picture, px.
const LONGEST_SIDE: u32 = 16_384;

/// A folder of tables whose key frames have pictures of six cameras.
pub struct PictureFolder {
    tables: PathBuf,
    bytes: Vec<u8>,
    drives: Vec<Vec<KeyPictures>>,
    /// Key frames that lack the picture of a camera.
    pub incomplete: usize,
}

/// The pictures of a key frame.
struct KeyPictures {
    sample: String,
    pictures: Vec<RecordedPicture>,
}

#[derive(Clone)]
struct RecordedPicture {
    channel: String,
    file: PathBuf,
    global_from_ego: Pose,
}

impl RecordedPicture {
    /// Place in the ring of the camera that took it, that camera in the world frame, and the file. `None` if its
    /// intrinsics are not sound.
    fn placed(&self, cameras: &[Camera], world_from_global: &Pose) -> Option<(usize, Camera, PathBuf)> {
        let camera = cameras.iter().find(|c| c.name == self.channel)?;
        let alone = SensorRig {
            cameras: vec![camera.clone()],
            ..SensorRig::default()
        };
        let world_from_ego = *world_from_global * self.global_from_ego;
        let camera = alone.standing_at(&world_from_ego).cameras.pop()?;
        Some((clockwise(cameras, &self.channel)?, camera, self.file.clone()))
    }
}

/// A drive: the scene that was measured, and its key frames in order of time.
pub struct PictureDrive {
    /// The scene, at its first moment.
    pub scene: Scene,
    /// Key frames with all pictures.
    pub moments: Vec<Photographed>,
}

/// A key frame.
pub struct Photographed {
    /// From the first key frame of the scene on, s.
    pub time_s: f64,
    /// The sensors in the world frame, each camera where it was when its picture was taken: clockwise, the front one second.
    pub rig: SensorRig,
    /// Pictures of those cameras.
    pub files: Vec<PathBuf>,
}

impl PictureFolder {
    /// Looks at a folder. Errors if it holds no such tables, or no key frame has pictures of six cameras.
    pub fn open(folder: &Path) -> Result<Self, FormatError> {
        let tables = in_folder(folder).ok_or_else(|| {
            FormatError::new(format!(
                "{}: expected a folder of nuScenes tables, with scene.json and sample_data.json",
                folder.display()
            ))
        })?;
        let bytes = input::read(&tables, IMPORTER.largest).map_err(FormatError::new)?;
        let source = ImportFile {
            bytes: &bytes,
            name: "",
            path: Some(&tables),
            options: Default::default(),
        };
        let (drives, incomplete) = drives(&source).map_err(|e| e.at(&folder.display()))?;
        let found: usize = drives.iter().map(Vec::len).sum();
        if found == 0 {
            return Err(FormatError::new(format!(
                "{}: 0 of {incomplete} key frames have the pictures of {VIEWS} cameras, expected at least one",
                folder.display()
            )));
        }
        Ok(Self {
            tables,
            bytes,
            drives,
            incomplete,
        })
    }

    /// Number of key frames with all pictures in each drive, in the order of the drives' names.
    pub fn drives(&self) -> impl Iterator<Item = usize> {
        self.drives.iter().map(Vec::len)
    }

    /// A drive. Errors if there is no such, or its tables cannot be read.
    pub fn drive(&self, which: usize) -> Result<PictureDrive, FormatError> {
        let source = ImportFile {
            bytes: &self.bytes,
            name: &scene_name(&self.tables),
            path: Some(&self.tables),
            options: Default::default(),
        };
        let (loaded, recording) = read_drive(&source, which).map_err(|e| e.at(&self.tables.display()))?;
        let scene = loaded.scene;
        let of_key = |key: &KeyPictures| {
            let frame = recording.frames.iter().find(|f| f.token == key.sample)?;
            let placed = |p: &RecordedPicture| p.placed(&scene.rig.cameras, &recording.world_from_global);
            let mut seen: Vec<(usize, Camera, PathBuf)> = key.pictures.iter().filter_map(placed).collect();
            seen.sort_by_key(|(place, ..)| *place);
            let (cameras, files) = seen.into_iter().map(|(_, camera, file)| (camera, file)).unzip();
            let rig = SensorRig {
                cameras,
                ..scene.rig.standing_at(&frame.world_from_ego)
            };
            Some(Photographed {
                time_s: frame.time_s,
                rig,
                files,
            })
        };
        let moments = self.drives.get(which).into_iter().flatten().filter_map(of_key);
        let moments = moments.filter(|m| m.files.len() == VIEWS).collect();
        Ok(PictureDrive { scene, moments })
    }
}

/// A picture at a size: rows from the top, three bytes a pixel, sRGB. A pixel of a larger picture is a mean. Errors if
/// the file is no picture.
pub fn pixels(file: &Path, [width, height]: [u32; 2]) -> Result<Vec<u8>, FormatError> {
    let bytes = input::read(file, LARGEST_PICTURE).map_err(FormatError::new)?;
    let image = || -> image::ImageResult<image::DynamicImage> {
        let mut reader = image::ImageReader::new(std::io::Cursor::new(&bytes)).with_guessed_format()?;
        let mut limits = image::Limits::default();
        (limits.max_image_width, limits.max_image_height) = (Some(LONGEST_SIDE), Some(LONGEST_SIDE));
        reader.limits(limits);
        reader.decode()
    };
    let image = image().map_err(|e| FormatError::new(e).at(&file.display()))?;
    let triangle = image::imageops::FilterType::Triangle;
    Ok(image.resize_exact(width, height, triangle).into_rgb8().into_raw())
}

/// Place of a camera in the ring: clockwise, the one that looks most ahead second.
fn clockwise(cameras: &[Camera], channel: &str) -> Option<usize> {
    let yaw = |camera: &Camera| {
        let ahead = camera.ego_from_camera().rotation * glam::DVec3::Z;
        ahead.y.atan2(ahead.x)
    };
    let mut order: Vec<(&str, f64)> = cameras.iter().map(|c| (&*c.name, yaw(c))).collect();
    order.sort_by(|a, b| b.1.total_cmp(&a.1));
    let front = (0..order.len()).min_by(|a, b| order[*a].1.abs().total_cmp(&order[*b].1.abs()))?;
    let place = order.iter().position(|(name, _)| *name == channel)?;
    Some((place + order.len() + 1 - front) % order.len())
}

/// Key frames with the pictures of six cameras by drive, and how many lack some.
fn drives(source: &ImportFile<'_>) -> Result<(Vec<Vec<KeyPictures>>, usize), FormatError> {
    let scenes = read::listed(source)?;
    let channel_of = channels(source)?;
    let data: Vec<SampleData> = rows::of(source, "sample_data", |row: &SampleData| {
        row.is_key_frame && channel_of.contains_key(&row.calibrated_sensor_token)
    })?;
    let wanted: HashSet<&str> = data.iter().map(|d| &*d.ego_pose_token).collect();
    let poses: Vec<EgoPose> = rows::of(source, "ego_pose", |row: &EgoPose| wanted.contains(&*row.token))?;
    let poses: HashMap<&str, &EgoPose> = poses.iter().map(|p| (&*p.token, p)).collect();
    let mut pictures: HashMap<&str, Vec<RecordedPicture>> = HashMap::new();
    for row in &data {
        let Some(file) = in_data_set(&row.filename).and_then(|at| source.place(&at).ok()) else {
            continue;
        };
        let what = format!("ego pose {}", quoted(&row.ego_pose_token, 40));
        let Some(ego) = poses.get(&*row.ego_pose_token) else {
            continue;
        };
        let taken = pictures.entry(&row.sample_token).or_default();
        let channel = &channel_of[&row.calibrated_sensor_token];
        if file.is_file() && !taken.iter().any(|p| p.channel == *channel) {
            taken.push(RecordedPicture {
                channel: channel.clone(),
                file,
                global_from_ego: pose(&what, ego.rotation, ego.translation).map_err(FormatError::new)?,
            });
        }
    }
    let mut samples: Vec<NuscenesSample> = rows::of(source, "sample", |_| true)?;
    samples.sort_by(|a, b| (a.timestamp, &a.token).cmp(&(b.timestamp, &b.token)));
    let place: HashMap<&str, usize> = scenes.iter().enumerate().map(|(i, s)| (&*s.token, i)).collect();
    let (mut drives, mut incomplete) = (Vec::new(), 0);
    drives.resize_with(scenes.len(), Vec::new);
    for sample in &samples {
        let Some(drive) = place.get(&*sample.scene_token) else {
            continue;
        };
        match pictures.remove(&*sample.token).filter(|p| p.len() == VIEWS) {
            Some(pictures) => drives[*drive].push(KeyPictures {
                sample: sample.token.clone(),
                pictures,
            }),
            None => incomplete += 1,
        }
    }
    Ok((drives, incomplete))
}

/// Channels of cameras by the token of their calibration.
fn channels(source: &ImportFile<'_>) -> Result<HashMap<String, String>, FormatError> {
    let sensors: Vec<NuscenesSensor> =
        rows::of(source, "sensor", |row: &NuscenesSensor| row.modality == "camera")?;
    let channel: HashMap<&str, &str> = sensors.iter().map(|s| (&*s.token, &*s.channel)).collect();
    let calibrated: Vec<CalibratedSensor> =
        rows::of(source, "calibrated_sensor", |row: &CalibratedSensor| {
            channel.contains_key(&*row.sensor_token)
        })?;
    let pair = |c: &CalibratedSensor| (c.token.clone(), channel[&*c.sensor_token].to_owned());
    Ok(calibrated.iter().map(pair).collect())
}

#[cfg(test)]
mod tests {
    use super::super::tests::written;
    use super::*;
    use crate::clip_tests::clip_scene;

    #[test]
    fn pictures_of_a_drive_come_with_the_poses_of_their_cameras() {
        let scene = clip_scene(3);
        let folder = written(&scene);
        let found = PictureFolder::open(folder.path()).expect("ours");
        assert_eq!(
            (found.drives().collect::<Vec<_>>(), found.incomplete),
            (vec![5], 0)
        );
        let drive = found.drive(0).expect("a drive");
        assert_eq!(drive.moments.len(), 5);
        for (i, moment) in drive.moments.iter().enumerate() {
            assert_eq!(moment.time_s, 0.5 * i as f64);
            let now = scene.at(moment.time_s);
            let truth = scene.rig.standing_at(&now.frame().world_from_ego);
            assert_eq!(moment.rig.cameras.len(), VIEWS);
            for ((camera, file), same) in moment.rig.cameras.iter().zip(&moment.files).zip(&truth.cameras) {
                assert_eq!(camera.name, same.name, "clockwise, as those of the known vehicle");
                assert!(file.to_string_lossy().contains(&camera.name));
                let [a, b] = [camera, same].map(Camera::ego_from_camera);
                assert!(a.translation_m.distance(b.translation_m) < 1e-6);
                assert!(a.rotation.angle_between(b.rotation) < 1e-6);
            }
        }
        let small = pixels(&drive.moments[0].files[0], [8, 4]).expect("a picture");
        assert_eq!(small.len(), 8 * 4 * 3);
        assert!(found.drive(1).is_err());
    }

    #[test]
    fn what_is_missing_is_counted_or_named() {
        let folder = written(&clip_scene(4));
        let first = PictureFolder::open(folder.path())
            .expect("ours")
            .drive(0)
            .expect("one");
        let file = &first.moments[1].files[2];
        std::fs::write(file, b"no picture").expect("written");
        let line = pixels(file, [8, 4]).expect_err("none").to_string();
        assert!(
            line.contains(&*file.to_string_lossy()) && !line.contains('\n'),
            "{line}"
        );
        std::fs::remove_file(file).expect("removed");
        let found = PictureFolder::open(folder.path()).expect("still some");
        assert_eq!((found.drives().sum::<usize>(), found.incomplete), (4, 1));
        assert_eq!(found.drive(0).expect("one").moments.len(), 4);
        for moment in &first.moments {
            let _ = std::fs::remove_file(&moment.files[0]);
        }
        let none = |folder: &Path| match PictureFolder::open(folder) {
            Ok(_) => panic!("accepted"),
            Err(error) => error.to_string(),
        };
        assert!(none(folder.path()).contains("0 of 5 key frames have the pictures of 6 cameras"));
        let empty = tempfile::tempdir().expect("a folder");
        assert!(none(empty.path()).contains("expected a folder of nuScenes tables"));
    }
}
