//! Point clouds (PCL's PCD, ascii, binary and compressed): a cloud becomes the occupancy of a scene.
//!
//! The fields `x`, `y`, `z` are read, in metres, taken as the ego frame (x forward, y left, z up, ground near z = 0),
//! and a field `label`, `labels`, `class` or `semantic` with the classes' numbers (Occ3D, 0 to 16). See `cloud` for the
//! use of points with and without labels. Other fields, a viewpoint, points that are not finite or lie beside the map
//! are left out and counted.

use std::collections::BTreeMap;

use glam::DVec3;
use scene::message::quoted;

use super::cloud::Cloud;
use super::{Content, ImportFile, Importer};
use crate::sweep_file::{LABELS, LARGEST_PCD, PcdError, PcdHeader, STRENGTHS};
use crate::{FormatError, Holds};

/// See the module.
pub const IMPORTER: Importer = Importer {
    id: "pcd",
    title: "point clouds",
    extensions: &["pcd"],
    holds: &[Holds::Points],
    largest: LARGEST_PCD,
    recognises: |head| {
        let text = String::from_utf8_lossy(head);
        text.starts_with("# .PCD") || (text.contains("FIELDS ") && text.contains("SIZE "))
    },
    in_folder: None,
    read,
    #[cfg(test)]
    sample: tests::sample,
};

fn read(source: &ImportFile<'_>) -> Result<Content, FormatError> {
    let header = PcdHeader::read(source.bytes).map_err(FormatError::new)?;
    let body = &source.bytes[header.body..];
    let axis = |name| {
        header
            .field(&[name])
            .ok_or_else(|| FormatError::new(PcdError::missing(name)))
    };
    let mut wanted = vec![axis("x")?, axis("y")?, axis("z")?];
    let first = |names: &[&str]| names.iter().find_map(|name| header.field(&[name]));
    let beside = [first(&LABELS), first(&STRENGTHS)];
    let kept = wanted.iter().copied().chain(beside[0]).collect::<Vec<_>>();
    let beside = beside.map(|field| {
        wanted.extend(field);
        field.map(|_| wanted.len() - 1)
    });
    let mut cloud = Cloud::from_source(source);
    let read = header.each_point(body, &wanted, |v| {
        let [label, strength] = beside.map(|at| at.map(|at| v[at]));
        cloud.add(DVec3::new(v[0], v[1], v[2]), label, strength)
    });
    read.map_err(FormatError::new)?;
    let mut left_out = BTreeMap::new();
    for (at, field) in header.fields.iter().enumerate() {
        if !kept.contains(&at) {
            left_out.insert(format!("field {}", quoted(&field.name, 40)), 1);
        }
    }
    if header.has_viewpoint {
        left_out.insert("viewpoint".into(), 1);
    }
    let loaded = cloud.scene(source.name, left_out).map_err(FormatError::new)?;
    Ok(Content::Scene(Box::new(loaded)))
}

#[cfg(test)]
#[path = "pcd_tests.rs"]
mod tests;
