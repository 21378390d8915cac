//! A single model as a scene: on open ground, ahead of the vehicle.

use std::collections::BTreeMap;
use std::sync::Arc;

use glam::{DAffine3, DVec2, DVec3};
use scene::{
    BevLayout, BoxId, BoxLabel, BoxName, Class, Extent, Frame, Inferred, Scene, SceneBox, SensorRig, draft,
};

use super::class_words::paint_said;
use super::columns::{Heights, Statics};
use super::document::{GltfDocument, LeftOut};
use super::foreign::{Bounds, ForeignNode, each_triangle, static_class};
use super::model::ModelExtents;
use super::paint::Coats;
use super::surface::TriangleRasteriser;
use super::work;
use crate::FormatError;
use crate::import::ImportedScene;

/// A model around the origin, where the ego vehicle is, is moved ahead by this, m.
const AHEAD_M: f64 = 8.0;

/// A single model on open ground.
pub(super) fn scene(
    document: &GltfDocument<'_>,
    abouts: &[ForeignNode],
    all: &Bounds,
    (class, is_guess): (Class, bool),
    name: &str,
    left_out: LeftOut,
) -> Result<ImportedScene, FormatError> {
    let shown = abouts.iter().position(|a| !a.own.is_empty()).unwrap_or(0);
    let first = std::iter::successors(Some(shown), |i| document.nodes[*i].parent)
        .last()
        .unwrap_or(shown);
    let mut outline = ModelExtents::new(&document.nodes[first].world_from_node);
    each_triangle(document, |_, _, corners| {
        corners.into_iter().for_each(|p| outline.add(p))
    })?;
    let id = BoxId(1);
    let b = outline
        .to_box(id, if class.is_object() { class } else { Class::Car })
        .ok_or_else(|| FormatError::new("a model without extent, or farther than 10 km away"))?;
    // On the ground, on the map, and not where the ego vehicle is.
    let extent = Extent::WINDOW;
    let reach = DVec2::splat(all.radius_m()) + b.center_m.truncate().abs();
    let is_on_map = reach.cmple(extent.max_m().truncate()).all();
    let is_at_ego = !is_on_map || b.contains(DVec3::new(0.0, 0.0, b.center_m.z), 0.0);
    let up = DVec3::Z * (b.size_m.z / 2.0 - b.center_m.z);
    let place = match is_at_ego {
        true => {
            let to = DVec3::new(AHEAD_M + b.size_m.x / 2.0, 0.0, b.center_m.z) + up;
            DAffine3::from_translation(to)
                * DAffine3::from_rotation_z(-b.yaw_rad)
                * DAffine3::from_translation(-b.center_m)
        }
        false => DAffine3::from_translation(up),
    };
    let b = SceneBox {
        center_m: place.transform_point3(b.center_m),
        yaw_rad: if is_at_ego { 0.0 } else { b.yaw_rad },
        label: BoxLabel {
            name: label(name, class),
            paint: Coats::new(document)
                .paint(&document.nodes)?
                .or_else(|| paint_said(name)),
        },
        ..b
    };
    work::check(document, TriangleRasteriser::cost, extent, |_, corners| {
        Some(corners.map(|p| place.transform_point3(p)))
    })?;
    let layout = BevLayout::over(extent);
    let mut occupancy = draft::draft(&layout, std::iter::empty());
    let mut boxes = BTreeMap::new();
    if class.is_object() {
        let mut heights = Heights::new(extent, &b);
        each_triangle(document, |_, _, corners| {
            heights.add(corners.map(|p| place.transform_point3(p)))
        })?;
        heights.fill(&b, &mut occupancy)?;
        boxes.insert(id, b);
    } else {
        let mut solid = Statics::new(extent);
        each_triangle(document, |node, primitive, corners| {
            let told = static_class(document, abouts, node, primitive).unwrap_or(class);
            let told = if told.is_object() { class } else { told };
            solid.add(told, corners.map(|p| place.transform_point3(p)));
        })?;
        solid.finish(&mut occupancy)?;
    }
    let guesses = if is_guess {
        boxes.keys().copied().collect()
    } else {
        Default::default()
    };
    let frame = Frame {
        inferred: Inferred {
            boxes: guesses,
            ..Inferred::default()
        },
        ..Frame::new(layout, boxes, occupancy)
    };
    Ok(ImportedScene {
        sweep: None,
        scene: Scene::single(name, frame, Arc::new(SensorRig::default()), 0),
        inferred: if is_guess { &["boxes"] } else { &[] },
        skipped: left_out.report(),
        notes: Vec::new(),
    })
}

/// A model's name for its box, unless it only says the class.
fn label(name: &str, class: Class) -> BoxName {
    match name == class.name() {
        true => BoxName::default(),
        false => BoxName::new(name),
    }
}
