//! Writes OpenSCENARIO XML 1.3 (ASAM): standing and moving participants as entities, one trajectory for each track and
//! for the ego vehicle, time of day and weather. The roads are a file beside it, see `opendrive::write`. All poses are
//! in the world frame.

mod entities;
mod environment;
mod story;

use scene::Scene;

use crate::FormatError;
use crate::xml_text::escaped;

/// The file of the roads, beside the scenario.
pub const MAP: &str = "map.xodr";

/// Poses of all trajectories together, at most: about half a gigabyte of text.
pub const MOST_POSES: usize = 4_000_000;

/// The date in every file, always the same, so that a scene always gives the same bytes.
const DATE: &str = "2026-01-01T00:00:00";

/// The bytes of a scenario. Errors if there are too many poses in it.
pub fn to_bytes(scene: &Scene) -> Result<Vec<u8>, FormatError> {
    let clip = scene.clip();
    let moving = clip.tracks.len() + usize::from(clip.ego.is_some());
    let poses = clip.frames().saturating_mul(moving);
    if poses > MOST_POSES {
        return Err(FormatError::new(format!(
            "{moving} trajectories of {} poses, expected at most {MOST_POSES} in all",
            clip.frames()
        )));
    }
    let actors = entities::actors(scene);
    let mut out = String::from("<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<OpenSCENARIO>\n");
    out.push_str(&format!(
        "  <FileHeader revMajor=\"1\" revMinor=\"3\" date=\"{DATE}\" author=\"Sceneloom {}\" description=\"{}\"/>\n",
        env!("CARGO_PKG_VERSION"),
        escaped(&scene.name),
    ));
    out.push_str("  <ParameterDeclarations/>\n  <CatalogLocations/>\n");
    out.push_str(&format!(
        "  <RoadNetwork>\n    <LogicFile filepath=\"{MAP}\"/>\n  </RoadNetwork>\n"
    ));
    entities::write(&mut out, &actors);
    out.push_str("  <Storyboard>\n    <Init>\n      <Actions>\n");
    environment::write(&mut out, &scene.conditions);
    story::init(&mut out, scene, &actors);
    out.push_str("      </Actions>\n    </Init>\n");
    story::story(&mut out, scene, &actors);
    story::stop(&mut out, clip);
    out.push_str("  </Storyboard>\n</OpenSCENARIO>\n");
    Ok(out.into_bytes())
}

#[cfg(test)]
mod tests;
