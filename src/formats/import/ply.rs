//! Point clouds as PLY (ascii, binary little and big endian): a cloud becomes the occupancy of a scene.
//!
//! The properties `x`, `y`, `z` of the element `vertex` are read, in metres, taken as the ego frame (x forward, y left,
//! z up, ground near z = 0), and a property of `LABELS` with the classes' numbers (Occ3D, 0 to 16). See `cloud` for the
//! use of points with and without labels. Other properties and elements are left out and counted, lists too. A file of
//! 3D Gaussians (`f_dc_0`, `scale_0`) is read as the points in their middles.

use std::collections::BTreeMap;

use glam::DVec3;
use scene::message::quoted;

use super::cloud::Cloud;
use super::{Content, ImportFile, Importer};
use crate::sweep_file::{LABELS, PlyBody, PlyError, PlyHeader, Property, STRENGTHS};
use crate::{FormatError, Holds};

/// See the module.
pub const IMPORTER: Importer = Importer {
    id: "ply",
    title: "point clouds, Gaussians as points",
    extensions: &["ply"],
    holds: &[Holds::Points],
    largest: 512 << 20,
    recognises: |head| head.starts_with(b"ply\n") || head.starts_with(b"ply\r\n"),
    in_folder: None,
    read: |source| {
        let (cloud, left_out) = read(source).map_err(FormatError::new)?;
        let loaded = cloud.scene(source.name, left_out).map_err(FormatError::new)?;
        Ok(Content::Scene(Box::new(loaded)))
    },
    #[cfg(test)]
    sample: tests::sample,
};

/// The points, and what is left out of the file by kind.
fn read(source: &ImportFile<'_>) -> Result<(Cloud, BTreeMap<String, usize>), PlyError> {
    let header = PlyHeader::read(source.bytes)?;
    let vertex = header.elements.iter().position(|e| e.name == "vertex");
    let at = vertex.ok_or(PlyError::Missing("x"))?;
    let points = &header.elements[at];
    let property = |is: &dyn Fn(&str) -> bool| {
        let of = |p: &Property| p.length.is_none() && is(&p.name);
        points.properties.iter().position(of)
    };
    let axis = |name: &'static str| property(&|p| p == name).ok_or(PlyError::Missing(name));
    let mut wanted = vec![axis("x")?, axis("y")?, axis("z")?];
    let beside = [LABELS.as_slice(), &STRENGTHS].map(|names| {
        let at = names
            .iter()
            .find_map(|name| property(&|p| p.to_lowercase() == *name));
        wanted.extend(at);
        at.map(|_| wanted.len() - 1)
    });

    let mut body = PlyBody::new(&source.bytes[header.body..], header.encoding);
    for before in &header.elements[..at] {
        body.pass(before, &[], |_| {})?;
    }
    let mut cloud = Cloud::from_source(source);
    let is_gaussian = |name: &str| points.properties.iter().any(|p| p.name == name);
    let are_gaussians = is_gaussian("f_dc_0") && is_gaussian("scale_0");
    if are_gaussians {
        cloud.is_map();
    }
    body.pass(points, &wanted, |v| {
        let [label, strength] = beside.map(|at| at.map(|at| v[at]));
        cloud.add(DVec3::new(v[0], v[1], v[2]), label, strength)
    })?;

    let mut left_out = BTreeMap::new();
    if are_gaussians {
        let what = "colours, sizes and turns of Gaussians, read as the points in their middles";
        left_out.insert(what.to_owned(), points.count);
    } else {
        for (i, p) in points.properties.iter().enumerate() {
            if !wanted.contains(&i) || Some(i) == beside[1].map(|at| wanted[at]) {
                left_out.insert(format!("property {}", quoted(&p.name, 40)), 1);
            }
        }
    }
    for (i, element) in header.elements.iter().enumerate() {
        if i != at && element.count > 0 {
            left_out.insert(format!("element {}", quoted(&element.name, 40)), element.count);
        }
    }
    Ok((cloud, left_out))
}

#[cfg(test)]
#[path = "ply_tests.rs"]
mod tests;
