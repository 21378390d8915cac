//! Manoeuvres as edits: their time of begin, and the motions that they make.

use scene::{BoxId, Edit, EditError, Scene, Template};

use super::apply_all;
use super::forecast::room_for_us;
use crate::traffic::template::{Wish, leader_mps, motion_of, time_near};

/// The edits of an [`Edit::LetMove`]; none of another edit.
pub(super) fn let_move(scene: &Scene, edit: &Edit) -> Result<Vec<Edit>, EditError> {
    let &Edit::LetMove {
        id,
        template,
        mps,
        from_s,
        gap_m,
    } = edit
    else {
        return Ok(Vec::new());
    };
    let bad = EditError::BadMotion;
    let class = id.and_then(|id| scene.frame().boxes.get(&id)).map(|b| b.class);
    let usual = Wish::usual(template, class);
    // A follower begins as fast as the vehicle ahead, if that one moves.
    let leader = || leader_mps(scene, id).filter(|mps| template == Template::Follow && *mps > 0.5);
    let mut wish = Wish {
        mps: mps.or_else(leader).or(limit_mps(scene, id)).unwrap_or(usual.mps),
        at_s: from_s.unwrap_or(usual.at_s),
        ..usual
    };
    if template == Template::Follow {
        wish.gap_m = gap_m;
    } else if let Some(gap_m) = gap_m {
        wish.at_s = approach_s(scene, id, &wish, gap_m).map_err(bad)?;
    }
    // An object that is to drive from a later moment on stands until then.
    if template == Template::Drive && (from_s.is_some_and(|s| s > 0.0) || gap_m.is_some()) {
        wish.template = Template::PullOut;
    }
    let mut edits = motion_of(scene, id, &wish).map_err(bad)?;
    if id.is_none() {
        // The map must reach where the ego vehicle drives.
        let mut moved = scene.clone();
        apply_all(&edits, &mut moved)?;
        edits.extend(room_for_us(&moved, 0.0));
    }
    Ok(edits)
}

/// The speed limit where a motor vehicle (the ego vehicle if `None`) stands, m/s; `None` where no limit is set.
fn limit_mps(scene: &Scene, id: Option<BoxId>) -> Option<f64> {
    let frame = scene.frame();
    let at_m = match id {
        None => frame.world_from_ego.translation_m,
        Some(id) => frame.boxes.get(&id).filter(|b| b.class.is_vehicle())?.center_m,
    };
    let road = scene.roads.road_at(at_m.truncate(), 1.0)?;
    scene.roads.road(road)?.limit_kph.map(|v| v / 3.6)
}

/// The time at which an object and the ego vehicle are `gap_m` apart, s. Errors in one line.
fn approach_s(scene: &Scene, id: Option<BoxId>, wish: &Wish, gap_m: f64) -> Result<f64, String> {
    if !(0.0..=1000.0).contains(&gap_m) {
        return Err(format!("gap_m is {gap_m}, expected 0 to 1000 m"));
    }
    let id = id.ok_or("gap_m is between an object and the ego vehicle, which has none to itself")?;
    // Until then it moves as before its manoeuvre.
    let stands = matches!(
        wish.template,
        Template::Cross | Template::PullOut | Template::Drive
    );
    let before = match stands {
        true => Vec::new(),
        false => motion_of(
            scene,
            Some(id),
            &Wish {
                template: Template::Drive,
                ..*wish
            },
        )?,
    };
    let mut until = scene.clone();
    apply_all(&before, &mut until).map_err(|e| e.to_string())?;
    time_near(until.clip(), until.canvas(), &scene.rig, id, gap_m).ok_or_else(|| {
        format!(
            "box {} and the ego vehicle never come within {gap_m} m of each other",
            id.0
        )
    })
}
