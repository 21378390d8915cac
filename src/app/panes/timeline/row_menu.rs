//! The menu of a row, which edits its motion: retime, mirror, copy, attach, trim.

use egui::Ui;

use scene::{BoxId, Motion, Moving, Scene};

use crate::command::Command;
use crate::playback::{Copied, Playback};
use crate::state::called;
use editor::traffic::shown;
use editor::{Edit, keyframes};
use language::t;
use widgets::theme;

/// Most neighbours in the menu to which an object can be attached.
const MOST_NEIGHBOURS: usize = 8;

/// Draws the menu's entries.
pub(super) fn entries(
    ui: &mut Ui,
    scene: &Scene,
    playback: &mut Playback,
    id: Option<BoxId>,
    commands: &mut Vec<Command>,
) {
    let (clip, now_s) = (scene.clip(), scene.time_s());
    let there_s = id
        .and_then(|id| clip.tracks.get(&id))
        .map_or([None; 2], |t| t.there_s);
    let motion = clip.motion(id);
    let place = |time_s: f64| match id {
        Some(id) => clip.moving(id, time_s),
        None => clip.ego_moving(time_s),
    };
    ui.label(egui::RichText::new(title(scene, id)).color(theme::text_weak()));
    keyframe_entries(ui, scene, id, commands);
    let mut set = |label: &'static str, motion: Motion, [from_s, to_s]: [Option<f64>; 2]| {
        commands.push(Command::Apply(
            label,
            vec![Edit::SetMotion {
                id,
                motion: Some(motion),
                from_s,
                to_s,
            }],
        ));
    };
    if let Some(motion) = motion {
        let timed = !matches!(motion, Motion::Attached { .. });
        for (text, times) in [("Twice as fast", 2.0), ("Half as fast", 0.5)] {
            if ui.add_enabled(timed, egui::Button::new(t(text))).clicked() {
                set(text, quicker(motion, times), there_s);
                ui.close();
            }
        }
        if ui
            .add_enabled(timed, egui::Button::new(t("Begin at this moment")))
            .clicked()
        {
            let start_s = start_s(motion);
            set("Begin later", motion.retimed(|t| t + now_s - start_s), there_s);
            ui.close();
        }
        let hint = t("In the line that we drive along: from our left to our right");
        if ui
            .button(t("Mirror to our other side"))
            .on_hover_text(hint)
            .clicked()
        {
            let pose = scene.frame().world_from_ego;
            let ahead = (pose.rotation * glam::DVec3::X).truncate();
            set(
                "Mirror motion",
                motion.mirrored(pose.translation_m.truncate(), ahead.to_angle()),
                there_s,
            );
            ui.close();
        }
        ui.separator();
        if ui.button(t("Copy motion")).clicked() {
            playback.copied = place(0.0).map(|start| Copied {
                motion: motion.clone(),
                start,
            });
            ui.close();
        }
    }
    let copied = playback
        .copied
        .clone()
        .zip(place(now_s).or_else(|| shown(scene, id)));
    let hint = t("The same way from where this is at the moment that is shown");
    if ui
        .add_enabled(copied.is_some(), egui::Button::new(t("Paste motion")))
        .on_hover_text(hint)
        .clicked()
        && let Some((copied, here)) = copied
    {
        set(
            "Paste motion",
            copied.motion.carried(&copied.start, &here),
            there_s,
        );
        ui.close();
    }
    let Some(own) = id else { return };
    ui.menu_button(t("Attach to"), |ui| {
        let Some(here) = place(now_s) else { return };
        for (to, there, name) in neighbours(scene, own, &here) {
            if ui.button(name).clicked() {
                let back = glam::DVec2::from_angle(-there.yaw_rad);
                let attached = Motion::Attached {
                    to,
                    at_m: back.rotate(here.at_m - there.at_m),
                    yaw_deg: (here.yaw_rad - there.yaw_rad).to_degrees(),
                };
                set("Attach", attached, there_s);
                ui.close();
            }
        }
    })
    .response
    .on_hover_text(t("It keeps its place beside another moving object"));
    if let Some(motion) = motion {
        ui.separator();
        for (text, trimmed) in trims(there_s, now_s) {
            if ui
                .add_enabled(trimmed != there_s, egui::Button::new(t(text)))
                .clicked()
            {
                set(text, motion.clone(), trimmed);
                ui.close();
            }
        }
    }
}

/// Entries that make a keyframe at the moment shown, or delete it.
fn keyframe_entries(ui: &mut Ui, scene: &Scene, id: Option<BoxId>, commands: &mut Vec<Command>) {
    let steps = [
        ("Keyframe here", "Make keyframe", keyframes::key_here(scene, id)),
        (
            "Take this keyframe away",
            "Delete keyframe",
            keyframes::drop_key(scene, id),
        ),
    ];
    for (text, label, edits) in steps {
        let button = ui.add_enabled(edits.is_ok(), egui::Button::new(t(text)));
        if button.clicked()
            && let Ok(edits) = edits
        {
            commands.push(Command::Apply(label, edits));
            ui.close();
        }
    }
    ui.separator();
}

/// The ways to trim the span, s, in which an object exists.
fn trims(there_s: [Option<f64>; 2], now_s: f64) -> [(&'static str, [Option<f64>; 2]); 3] {
    let [from_s, to_s] = there_s;
    [
        (
            "Appears at this moment",
            [Some(now_s), to_s.filter(|to| *to > now_s)],
        ),
        (
            "Disappears at this moment",
            [from_s.filter(|from| *from < now_s), Some(now_s)],
        ),
        ("There all the time", [None; 2]),
    ]
}

/// The title of the row's object.
fn title(scene: &Scene, id: Option<BoxId>) -> String {
    match id.and_then(|id| scene.frame().boxes.get(&id)) {
        Some(b) => format!("{} {}", theme::sentence(&called(b)), b.id.0),
        None => t("Ego vehicle").to_owned(),
    }
}

/// Time at which a motion leaves its starting place, s.
fn start_s(motion: &Motion) -> f64 {
    let stands = match motion {
        Motion::Keys(keys) => keys
            .windows(2)
            .take_while(|pair| pair[0].at_m == pair[1].at_m)
            .count(),
        Motion::Path(path) => path
            .speeds
            .windows(2)
            .take_while(|pair| pair[0].mps == 0.0 && pair[1].mps == 0.0)
            .count(),
        Motion::Attached { .. } => 0,
    };
    motion.times_s().get(stands).copied().unwrap_or(0.0)
}

/// The motion sped up by a factor from the time at which it begins to move.
fn quicker(motion: &Motion, times: f64) -> Motion {
    let start_s = start_s(motion);
    let later = |t: f64| {
        if t > start_s {
            start_s + (t - start_s) / times
        } else {
            t
        }
    };
    let mut out = motion.retimed(later);
    // A path with one steady speed has no times to retime, so the speed itself is scaled.
    if let Motion::Path(path) = &mut out
        && let [only] = path.speeds.as_mut_slice()
    {
        let most = scene::clip::Path::MAX_MPS;
        only.mps = (only.mps * times).clamp(-most, most);
    }
    out
}

/// Other moving objects that are not attached to anything, the nearest first.
fn neighbours(scene: &Scene, own: BoxId, here: &Moving) -> Vec<(BoxId, Moving, String)> {
    let clip = scene.clip();
    let free = clip
        .tracks
        .iter()
        .filter(|(id, t)| **id != own && !matches!(t.motion, Motion::Attached { .. }));
    let mut out: Vec<(BoxId, Moving, String)> = free
        .filter_map(|(id, t)| {
            Some((
                *id,
                clip.moving(*id, scene.time_s())?,
                format!("{} {}", called(&t.made), id.0),
            ))
        })
        .collect();
    out.sort_by(|a, b| {
        a.1.at_m
            .distance(here.at_m)
            .total_cmp(&b.1.at_m.distance(here.at_m))
    });
    out.truncate(MOST_NEIGHBOURS);
    out
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::DVec2;
    use scene::clip::{Path, Speed};

    #[test]
    fn twice_as_fast_is_there_in_half_of_the_time() {
        let path = Path {
            points_m: vec![DVec2::ZERO, DVec2::new(100.0, 0.0)],
            start_m: 0.0,
            speeds: vec![
                Speed {
                    time_s: 1.0,
                    mps: 2.0,
                },
                Speed {
                    time_s: 5.0,
                    mps: 6.0,
                },
            ],
            rear_first: false,
        };
        let steady = Path {
            speeds: vec![Speed {
                time_s: 1.0,
                mps: 4.0,
            }],
            ..path.clone()
        };
        let at = |m: &Motion, t: f64| m.at(t, |_| None).expect("there").at_m.x;
        for motion in [Motion::Path(path), Motion::Path(steady)] {
            let fast = quicker(&motion, 2.0);
            for t in [1.0, 2.0, 4.0, 5.0] {
                assert!(
                    (at(&motion, t) - at(&fast, 1.0 + (t - 1.0) / 2.0)).abs() < 1e-9,
                    "{t}"
                );
            }
        }
    }
}
