//! Text about the place under the pointer in the 3D view.

use editor::pick::{PickHit, PickRay};
use editor::pick_things;
use editor::tools::point_of;
use language::{t, tf};
use numeric::decimal::decimal;
use scene::{Class, Scene};

use super::canvas::label_text;
use super::state::{called, position_text};

/// Place, distance, and what is there.
pub(super) fn readout(scene: &Scene, hit: &PickHit, ray: &PickRay) -> String {
    let p = point_of(hit, ray);
    let mut parts = vec![
        format!("{}  z {}", position_text(p.truncate()), decimal(p.z, 1)),
        tf!("{distance} m away", distance = format!("{:.1}", p.length())),
    ];
    match hit {
        PickHit::Box { id, .. } => {
            if let Some(b) = scene.frame().boxes.get(id) {
                parts.push(format!("{} #{}", called(b), id.0));
            }
        }
        PickHit::Voxel(v) => {
            parts.push(Class::from_id(v.label).map_or_else(String::new, |c| label_text(scene, c, v.cell)));
            let thing = pick_things::thing_of_voxel(scene.frame(), &scene.background, v.cell);
            if let Some(thing) = thing.and_then(|id| scene.background.get(id)) {
                parts.push(format!("{} #{}", t(thing.form.name()), thing.id.0));
            }
            let [x, y, z] = v.cell;
            parts.push(tf!("voxel {x}, {y}, {z}", x = x, y = y, z = z));
        }
        PickHit::Ground { .. } if scene.frame().extent().voxel_at(p).is_none() => {
            parts.push(t("outside the map").into());
        }
        PickHit::Ground { .. } => {}
    }
    parts.join("  ·  ")
}
