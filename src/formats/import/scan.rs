//! Scans without a header, as KITTI and nuScenes keep them: little-endian f32 in columns, x, y, z in m first.

use std::path::Path;

use glam::DVec3;

use super::Source;
use crate::FormatError;

/// What the columns after x, y, z are.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Columns {
    /// KITTI: remission, 0 to 1.
    Kitti,
    /// nuScenes: intensity, 0 to 255, and ring.
    NuScenes,
}

/// Farthest that a LiDAR sees, m, and nearest: an echo has a coordinate beyond that.
const FAR_M: f32 = 10_000.0;
const NEAR_M: f32 = 0.01;
/// Points in a head are nearer than this, m.
const HEAD_FAR_M: f32 = 500.0;
/// Share of numbers that must be coordinates, or the file is something else.
const LEAST_SOUND: f64 = 0.9;
/// Strongest echo, and most rings.
const STRONGEST: f32 = 255.0;
const MOST_RINGS: f32 = 1024.0;

impl Columns {
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
            is_echo(&v, HEAD_FAR_M)
                && match self {
                    Self::Kitti => (0.0..=1.0).contains(&v[3]),
                    Self::NuScenes => {
                        (0.0..=STRONGEST).contains(&v[3])
                            && (0.0..MOST_RINGS).contains(&v[4])
                            && v[4].fract() == 0.0
                    }
                }
        };
        let is_somewhere = |point: &[u8]| self.values(point)[..3] != [0.0; 3];
        head.chunks_exact(stride).all(sound) && head.chunks_exact(stride).any(is_somewhere)
    }

    fn values(self, point: &[u8]) -> [f32; 5] {
        let value = |i: usize| {
            let bytes = point.get(4 * i..).and_then(|at| at.first_chunk());
            bytes.map_or(0.0, |b| f32::from_le_bytes(*b))
        };
        std::array::from_fn(value)
    }

    /// Positions of the points, in m in the sensor's frame. Errors if the bytes are no such points.
    pub(super) fn read(self, bytes: &[u8]) -> Result<impl ExactSizeIterator<Item = DVec3> + '_, FormatError> {
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
            DVec3::from_array(
                self.values(point)
                    .first_chunk()
                    .map_or([0.0; 3], |p| p.map(f64::from)),
            )
        };
        let points = bytes.chunks_exact(stride);
        let wild = points.clone().filter(|p| !is_echo(&self.values(p), FAR_M));
        let (wild, all) = (wild.count(), points.len());
        if (wild as f64) > (1.0 - LEAST_SOUND) * all as f64 {
            return Err(FormatError::new(format!(
                "{wild} of {all} points have no coordinates in m, expected f32 {columns}"
            )));
        }
        Ok(points.map(at))
    }
}

/// True for the place of an echo that is no farther than this along any axis, or of none, which is all zeros.
fn is_echo(values: &[f32; 5], far_m: f32) -> bool {
    let place = &values[..3];
    let within = place.iter().all(|c| c.abs() < far_m);
    within && (place.iter().any(|c| c.abs() > NEAR_M) || *place == [0.0; 3])
}

/// A file beside the scan that is read if it is there: `count` values of `size` bytes. Errors if it holds another number.
pub(super) fn labels_beside(
    source: &Source<'_>,
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
