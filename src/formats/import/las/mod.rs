//! Point clouds as LAS and LAZ (ASPRS LAS 1.0 to 1.4, all point formats): a cloud becomes the occupancy of a scene.
//!
//! Classes are those of the extra byte `occ3d_class`, as this program writes it, or of the standard's classification
//! ([`crate::las`]); noise and withheld points are left out. See `cloud` for the use of points with and without labels.
//! Coordinates are taken as metres. If a cloud does not lie around the origin, as in projected coordinates, its middle
//! becomes the origin and its ground there z = 0; a report names the offset that was subtracted.

mod header;
mod points;

use std::collections::BTreeMap;

use glam::DVec3;
use scene::{Class, Window};

use super::cloud::{Cloud, Label, NothingOnTheMap};
use super::{Content, ImportFile, Importer};
use crate::las::{Asprs, of_asprs};
use crate::{FormatError, Holds};
use header::LasHeader;
use points::LasPoint;

/// See the module.
pub const IMPORTER: Importer = Importer {
    id: "las",
    title: "surveyed point clouds",
    extensions: &["las", "laz"],
    holds: &[Holds::Points],
    largest: 1 << 30,
    recognises: |head| head.starts_with(b"LASF"),
    in_folder: None,
    read: |source| read_around(source, None).map_err(FormatError::new),
    #[cfg(test)]
    sample: tests::sample,
};

/// Why a file is no LAS that is read. One line each.
#[derive(Debug, PartialEq, thiserror::Error)]
pub enum LasError {
    /// A field of the header, or of a record after it.
    #[error("{what} is {found}, expected {expected}")]
    Header {
        /// Which field.
        what: &'static str,
        /// Its value.
        found: String,
        /// The values that are accepted.
        expected: String,
    },
    /// The file holds less than its header says.
    #[error("{found} points, expected {expected} as in the header")]
    Short {
        /// Points there.
        found: u64,
        /// Points promised.
        expected: u64,
    },
    /// Compressed points that cannot be unpacked.
    #[error("LAZ, point {point}: {problem}")]
    Packed {
        /// Which point, from 0.
        point: u64,
        /// Why the points cannot be unpacked.
        problem: String,
    },
    /// No point would be left.
    #[error(transparent)]
    Nothing(#[from] NothingOnTheMap),
}

fn wrong(what: &'static str, found: impl ToString, expected: impl Into<String>) -> LasError {
    LasError::Header {
        what,
        found: found.to_string(),
        expected: expected.into(),
    }
}

/// Reads a file whose point `origin_m` (in the file's coordinates) becomes the origin of the scene, as the ground under the
/// vehicle; without one it is found as the module says.
pub fn read_around(source: &ImportFile<'_>, origin_m: Option<DVec3>) -> Result<Content, LasError> {
    let header = LasHeader::read(source.bytes)?;
    let origin_m = match origin_m {
        Some(origin_m) => origin_m,
        None => origin(&header, source.bytes, source.options.lift_m.is_some())?,
    };
    let (mut cloud, mut noise, mut withheld) = (Cloud::from_source(source), 0, 0);
    let mut of_users = false;
    points::each(&header, source.bytes, |record| {
        let label = match record.class {
            Some(id) => Class::from_id(id)
                .filter(|c| *c != Class::Free)
                .map_or(Label::Unknown, Label::Class),
            None => match of_asprs(record.classification) {
                Asprs::Class(class) => Label::Class(class),
                Asprs::Unclassified => Label::None,
                Asprs::OfUsers => {
                    of_users = true;
                    Label::None
                }
                Asprs::Noise => {
                    noise += 1;
                    return;
                }
            },
        };
        if record.is_withheld {
            withheld += 1;
            return;
        }
        cloud.add_point(record.at_m - origin_m, label, 0.0);
    })?;
    cloud.is_map();
    let mut left_out = BTreeMap::new();
    for (what, count) in [
        ("points of noise", noise),
        ("points withheld", withheld),
        ("classifications of users (64 to 255)", usize::from(of_users)),
    ] {
        if count > 0 {
            left_out.insert(what.to_owned(), count);
        }
    }
    if origin_m != DVec3::ZERO {
        let [x, y, z] = origin_m.to_array();
        left_out.insert(
            format!("offset of x {x:.2}, y {y:.2}, z {z:.2} m, subtracted from every point"),
            1,
        );
    }
    let loaded = cloud.scene(source.name, left_out)?;
    Ok(Content::Scene(Box::new(loaded)))
}

/// Points that tell where a cloud lies.
const SAMPLED: u64 = 1 << 16;
/// Share of them that may be stray on either side.
const STRAY: f64 = 0.01;
/// Ground at the origin: this share of the points within this distance lies lower, m.
const GROUND_SHARE: f64 = 0.1;
const GROUND_REACH_M: f64 = 40.0;

/// The point that is subtracted from every point: zero for a cloud of this program. Else x and y are those of the
/// middle, to the metre, or 0 for a cloud around the origin. z is the height of the ground there; it is 0 where the
/// user says how far to lift, and for a cloud around the origin whose ground is on the map.
fn origin(header: &LasHeader, bytes: &[u8], keeps_height: bool) -> Result<DVec3, LasError> {
    if header.is_own {
        return Ok(DVec3::ZERO);
    }
    let every = header.points.div_ceil(SAMPLED).max(1);
    let (mut sample, mut at) = (Vec::new(), 0);
    points::each(header, bytes, |record: &LasPoint| {
        if at % every == 0 && record.at_m.is_finite() {
            sample.push(record.at_m);
        }
        at += 1;
    })?;
    let middle = |of: &dyn Fn(&DVec3) -> f64| {
        let values = sorted(&sample, of);
        let (low, high) = (share(&values, STRAY), share(&values, 1.0 - STRAY));
        ((low..=high).contains(&0.0), ((low + high) / 2.0).round())
    };
    let ((x_is_around, x_m), (y_is_around, y_m)) = (middle(&|p| p.x), middle(&|p| p.y));
    let moves = !(x_is_around && y_is_around);
    let middle_m = match moves {
        true => DVec3::new(x_m, y_m, 0.0),
        false => DVec3::ZERO,
    };
    if keeps_height {
        return Ok(middle_m);
    }
    let near = |p: &&DVec3| (**p - middle_m).truncate().length() <= GROUND_REACH_M;
    let near: Vec<DVec3> = sample.iter().filter(near).copied().collect();
    let ground = if near.is_empty() { &sample } else { &near };
    let ground_m = share(&sorted(ground, &|p| p.z), GROUND_SHARE);
    let is_on_map = !moves && ground_m.abs() <= -Window::MIN_M[2];
    Ok(match is_on_map {
        true => middle_m,
        false => middle_m.with_z((ground_m * 100.0).round() / 100.0),
    })
}

fn sorted(sample: &[DVec3], of: &dyn Fn(&DVec3) -> f64) -> Vec<f64> {
    let mut values: Vec<f64> = sample.iter().map(of).collect();
    values.sort_by(f64::total_cmp);
    values
}

/// The value below which this share of sorted values lies; 0 of none.
fn share(sorted: &[f64], share: f64) -> f64 {
    let at = (sorted.len() as f64 * share) as usize;
    let value = sorted.get(at.min(sorted.len().saturating_sub(1)));
    value.copied().unwrap_or(0.0)
}

#[cfg(test)]
mod tests;
