//! A scene into the entries of a project file.

use scene::{BevLayout, Scene};

use super::archive::Writer;
use super::beside;
use super::check::check;
use super::header::{DATA_LABELS, SceneHeader, entry_name, track_entry, unobserved_entry};
use super::manifest::Manifest;
use super::{ProjectError, SCENE};

/// The bytes of a project file: the scene, and the versions and texts kept with it.
pub fn to_bytes(scene: &Scene) -> Result<Vec<u8>, ProjectError> {
    let mut out = written(scene)?;
    beside::write(&mut out, &scene.kept)?;
    out.finish()
}

/// The scene alone: equal scenes give equal bytes, whatever their files keep beside them.
pub fn alone_to_bytes(scene: &Scene) -> Result<Vec<u8>, ProjectError> {
    written(scene)?.finish()
}

fn written(scene: &Scene) -> Result<Writer, ProjectError> {
    check(scene)?;
    let mut out = Writer::new();
    out.json(super::MANIFEST, &Manifest::present())?;
    let header = SceneHeader::from_scene(scene);
    out.json(SCENE, &header)?;
    let (frame, header) = (scene.canvas(), &header.canvas);
    out.put(&entry_name("layout.u32"), &layout_bytes(&frame.layout))?;
    if header.relief {
        out.put(&entry_name("relief.f32"), &relief_bytes(&frame.layout))?;
    }
    out.labels(&entry_name("occupancy.u8"), &frame.occupancy)?;
    if header.painted {
        out.labels(&entry_name("painted.u8"), &frame.painted)?;
    }
    if let Some(unobserved) = &frame.inferred.unobserved {
        let words = unobserved.words().iter();
        let (entry, width) = unobserved_entry(unobserved.extent());
        let bytes: Vec<u8> = words
            .flat_map(|w| w.to_le_bytes().into_iter().take(width))
            .collect();
        out.put(&entry_name(entry), &bytes)?;
    }
    if let Some(labels) = &frame.inferred.data_labels {
        let rows = labels.numbered().iter();
        let bytes = rows
            .flat_map(|(number, label)| [*number, (*label).into()])
            .flat_map(u32::to_le_bytes);
        out.put(&entry_name(DATA_LABELS), &bytes.collect::<Vec<u8>>())?;
    }
    if header.source.layout {
        out.put(
            &entry_name("source_layout.u32"),
            &layout_bytes(&frame.source.layout),
        )?;
    }
    if header.source.relief {
        let bytes = relief_bytes(&frame.source.layout);
        out.put(&entry_name("source_relief.f32"), &bytes)?;
    }
    if header.source.occupancy {
        out.labels(&entry_name("source_occupancy.u8"), &frame.source.occupancy)?;
    }
    for (id, track) in &scene.clip().tracks {
        out.put(&track_entry(*id), &track.voxels.labels)?;
    }
    Ok(out)
}

fn layout_bytes(layout: &BevLayout) -> Vec<u8> {
    layout.cells().iter().flat_map(|c| c.to_le_bytes()).collect()
}

/// Heights of all columns; zeros if flat.
fn relief_bytes(layout: &BevLayout) -> Vec<u8> {
    match layout.relief.heights_m() {
        Some(heights) => heights.iter().flat_map(|h| h.to_le_bytes()).collect(),
        None => vec![0; 4 * layout.extent().columns()],
    }
}
