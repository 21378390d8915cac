//! Scans without a header, as KITTI and nuScenes keep them: little-endian f32 in columns, x, y, z in m first.

use std::path::Path;

use glam::DVec3;

use super::ImportFile;
use crate::FormatError;

/// Kind of the columns after x, y, z.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum ScanFormat {
    /// KITTI: remission, 0 to 1.
    Kitti,
    /// nuScenes: intensity, 0 to 255, and ring.
    NuScenes,
}

/// Farthest and nearest distance that a LiDAR sees, m: nearer places are no returns.
const FAR_M: f32 = 10_000.0;
const NEAR_M: f32 = 0.1;
/// Points in a head are nearer than this, m.
const HEAD_FAR_M: f32 = 500.0;
/// Share of the places that must be sound, or the file is of another kind. Slots without a return do not count.
const LEAST_SOUND: f64 = 0.9;
/// Strongest echo, and most rings.
const STRONGEST: f32 = 255.0;
const MOST_RINGS: f32 = 1024.0;

impl ScanFormat {
    pub(super) fn count(self) -> usize {
        match self {
            Self::Kitti => 4,
            Self::NuScenes => 5,
        }
    }

    /// True for the first bytes of such a file: numbers where they must lie, of all whole points.
    pub(super) fn are_in(self, head: &[u8]) -> bool {
        let stride = 4 * self.count();
        // A head that ends within a point is the beginning of a longer file.
        if head.len() < stride || (head.len() < 1024 && !head.len().is_multiple_of(stride)) {
            return false;
        }
        let sound = |point: &[u8]| {
            let v = self.values(point);
            slot(&v, HEAD_FAR_M) != Slot::Wild
                && v.iter().all(|v| v.is_finite())
                && match self {
                    Self::Kitti => (0.0..=1.0).contains(&v[3]),
                    Self::NuScenes => {
                        (0.0..=STRONGEST).contains(&v[3])
                            && (0.0..MOST_RINGS).contains(&v[4])
                            && v[4].fract() == 0.0
                    }
                }
        };
        let is_return = |point: &[u8]| slot(&self.values(point), HEAD_FAR_M) == Slot::Return;
        head.chunks_exact(stride).all(sound) && head.chunks_exact(stride).any(is_return)
    }

    fn values(self, point: &[u8]) -> [f32; 5] {
        let value = |i: usize| {
            let bytes = point.get(4 * i..).and_then(|at| at.first_chunk());
            bytes.map_or(0.0, |b| f32::from_le_bytes(*b))
        };
        std::array::from_fn(value)
    }

    /// Positions of the points, in m in the sensor's frame, and strengths of their echoes. Errors if the bytes are no such points.
    pub(super) fn read(
        self,
        bytes: &[u8],
    ) -> Result<impl ExactSizeIterator<Item = (DVec3, f32)> + '_, FormatError> {
        let stride = 4 * self.count();
        let columns = match self {
            Self::Kitti => "x, y, z, remission",
            Self::NuScenes => "x, y, z, intensity, ring",
        };
        if bytes.is_empty() || !bytes.len().is_multiple_of(stride) {
            return Err(FormatError::new(format!(
                "{} bytes, expected points of {stride}: f32 {columns}",
                bytes.len()
            )));
        }
        let at = move |point| {
            let [x, y, z, strength, _] = self.values(point);
            (DVec3::from_array([x, y, z].map(f64::from)), strength)
        };
        let points = bytes.chunks_exact(stride);
        let (mut wild, mut returns) = (0, 0);
        for point in points.clone() {
            match slot(&self.values(point), FAR_M) {
                Slot::Return => returns += 1,
                Slot::Wild => wild += 1,
                Slot::Empty => {}
            }
        }
        let all = points.len();
        if f64::from(wild) > (1.0 - LEAST_SOUND) * f64::from(wild + returns) {
            return Err(FormatError::new(format!(
                "{wild} of {all} points have no coordinates in m, expected f32 {columns}"
            )));
        }
        if returns == 0 {
            return Err(FormatError::new(format!(
                "no return among {all} points, expected f32 {columns} with places in m"
            )));
        }
        Ok(points.map(at))
    }
}

/// Meaning of a place of three numbers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Slot {
    /// A return.
    Return,
    /// No return: the place is not finite, or the sensor's own but for rounding.
    Empty,
    /// No place of a LiDAR's return: too far, or so small that it is no number of a sensor.
    Wild,
}

fn slot(values: &[f32; 5], far_m: f32) -> Slot {
    let place = &values[..3];
    if place.iter().any(|c| !c.is_finite()) {
        return Slot::Empty;
    }
    let far = place.iter().fold(0.0f32, |most, c| most.max(c.abs()));
    // Whole numbers of other files, read as f32, are subnormal.
    let is_number = |c: &f32| *c == 0.0 || c.is_normal();
    match far < far_m && place.iter().all(is_number) {
        true if far < NEAR_M => Slot::Empty,
        true => Slot::Return,
        false => Slot::Wild,
    }
}

/// A file beside the scan that is read if it is there: `count` values of `size` bytes. Errors if it holds another number.
pub(super) fn labels_beside(
    source: &ImportFile<'_>,
    relative: &str,
    (count, size): (usize, usize),
) -> Result<Option<Vec<u8>>, FormatError> {
    match source.path.map(|_| source.place(relative)).transpose()? {
        Some(place) if place.is_file() => {}
        _ => return Ok(None),
    }
    let bytes = source.beside(relative, (count * size) as u64 + 4096)?;
    if bytes.len() != count * size {
        return Err(FormatError::new(format!(
            "{relative}: {} bytes, expected {size} for each of {count} points",
            bytes.len()
        )));
    }
    Ok(Some(bytes))
}

/// The file's name, or an empty one.
pub(super) fn file_name(path: Option<&Path>) -> String {
    let name = path.and_then(Path::file_name);
    name.map_or(String::new(), |n| n.to_string_lossy().into_owned())
}
