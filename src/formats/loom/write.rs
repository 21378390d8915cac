//! A scene into the entries of a project file.

use scene::{BevLayout, Scene};

use super::archive::Writer;
use super::check::check;
use super::header::{SceneHeader, entry_name};
use super::manifest::Manifest;
use super::{ProjectError, SCENE};

/// The scene as the bytes of a project file.
pub fn to_bytes(scene: &Scene) -> Result<Vec<u8>, ProjectError> {
    check(scene)?;
    let mut out = Writer::new();
    out.json(super::MANIFEST, &Manifest::of(scene))?;
    let header = SceneHeader::of(scene);
    out.json(SCENE, &header)?;
    for ((index, frame), header) in scene.frames.iter().enumerate().zip(&header.frames) {
        let name = |part: &str| entry_name(index, part);
        out.put(&name("layout.u32"), &layout_bytes(&frame.layout))?;
        if header.relief {
            out.put(&name("relief.f32"), &relief_bytes(&frame.layout))?;
        }
        out.labels(&name("occupancy.u8"), &frame.occupancy)?;
        if header.painted {
            out.labels(&name("painted.u8"), &frame.painted)?;
        }
        if let Some(unobserved) = &frame.inferred.unobserved {
            let words = unobserved.words().iter();
            let bytes: Vec<u8> = words.flat_map(|w| w.to_le_bytes()).collect();
            out.put(&name("unobserved.u16"), &bytes)?;
        }
        if header.source.layout {
            out.put(&name("source_layout.u32"), &layout_bytes(&frame.source.layout))?;
        }
        if header.source.relief {
            let bytes = relief_bytes(&frame.source.layout);
            out.put(&name("source_relief.f32"), &bytes)?;
        }
        if header.source.occupancy {
            out.labels(&name("source_occupancy.u8"), &frame.source.occupancy)?;
        }
    }
    out.finish()
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
