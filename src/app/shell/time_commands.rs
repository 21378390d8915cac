//! Carries out commands about time, and plays clips.

use egui::Context;

use super::app::SceneloomApp;
use crate::command::TimeCommand;
use crate::panes::id::PaneId;
use crate::panes::timeline::scope_name;
use editor::Edit;
use editor::document::Label;
use editor::{forecast, keyframes, traffic_drives};
use language::{t, tf};
use scene::{BoxId, Pose, Scene, Scope};

/// The pose that the view follows: of the object while it exists, or of the ego vehicle for `None`.
fn followed_pose(scene: &Scene, id: Option<BoxId>) -> Option<Pose> {
    let Some(id) = id else {
        return Some(scene.frame().world_from_ego);
    };
    let b = scene.frame().boxes.get(&id)?;
    Some(Pose {
        rotation: glam::DQuat::from_rotation_z(b.yaw_rad),
        translation_m: b.center_m,
    })
}

/// Longest press that counts as a tap, s.
const TAP_S: f64 = 0.3;

impl SceneloomApp {
    /// Carries out one time command.
    pub(crate) fn time_command(&mut self, command: TimeCommand) {
        let scene = self.document.scene().clone();
        let (clip, shown_s) = (scene.clip(), scene.time_s());
        let playback = &mut self.state.playback;
        let to_s = match command {
            TimeCommand::Show(time_s) => {
                playback.playing = false;
                Some(time_s)
            }
            TimeCommand::Scrub(time_s) => {
                playback.playing = false;
                Some(clip.time_of(clip.frame_at(time_s)))
            }
            TimeCommand::Play => {
                let from_s = playback.toggle(shown_s, clip.length_s);
                // Pausing stops at a frame, as stepping does.
                let frame_s = || clip.time_of(clip.frame_at(shown_s));
                if playback.playing { from_s } else { Some(frame_s()) }
            }
            TimeCommand::Step(frames) => {
                playback.playing = false;
                let at = clip.frame_at(shown_s) as i64 + i64::from(frames);
                Some(clip.time_of(at.clamp(0, clip.frames() as i64 - 1) as usize))
            }
            TimeCommand::ToStart => Some(playback.span(clip.length_s)[0]),
            TimeCommand::ToEnd => Some(playback.span(clip.length_s)[1]),
            TimeCommand::Key(step) => {
                let id = self.state.selected;
                let times = clip.motion(id).map(scene::Motion::times_s).unwrap_or_default();
                let mut times: Vec<f64> = times
                    .into_iter()
                    .filter(|t| (0.0..=clip.length_s).contains(t))
                    .collect();
                times.sort_by(f64::total_cmp);
                match step > 0 {
                    true => times.into_iter().find(|t| *t > shown_s + 1e-6),
                    false => times.into_iter().rev().find(|t| *t < shown_s - 1e-6),
                }
            }
            TimeCommand::KeyHere => {
                self.time_edit("Make keyframe", keyframes::key_here(&scene, self.state.selected));
                None
            }
            TimeCommand::DropKey => {
                self.time_edit(
                    "Delete keyframe",
                    keyframes::drop_key(&scene, self.state.selected),
                );
                None
            }
            TimeCommand::CopyToFrame(step) => {
                let copied = keyframes::copy_to_frame(&scene, &self.state.chosen(), step);
                let time_s = copied.as_ref().ok().map(|(time_s, _)| *time_s);
                self.time_edit("Copy place to frame", copied.map(|(_, edits)| edits));
                time_s
            }
            TimeCommand::In | TimeCommand::Out => {
                let [from, to] = playback.span(clip.length_s);
                let span = match command {
                    TimeCommand::In => [shown_s, to],
                    _ => [from, shown_s],
                };
                let whole = span == [0.0, clip.length_s] || span[0] >= span[1];
                playback.span_s = (!whole).then_some(span);
                None
            }
            TimeCommand::Traffic => {
                match traffic_drives(&scene) {
                    Ok(start) => {
                        if !start.edits.is_empty() {
                            self.apply("Let traffic drive", &start.edits);
                        }
                        if let Some(said) = start.said() {
                            self.note(&said);
                        }
                    }
                    Err(problem) => self.fail(problem),
                }
                None
            }
            TimeCommand::Forecast(seconds) => {
                self.forecast(seconds);
                None
            }
            TimeCommand::Motion(id, wish) => {
                let edit = Edit::LetMove {
                    id,
                    template: wish.template,
                    mps: Some(wish.mps),
                    from_s: wish.template.has_a_moment().then_some(wish.at_s),
                    gap_m: None,
                };
                self.apply(wish.template.title(), &[edit]);
                None
            }
        };
        if let Some(time_s) = to_s {
            self.show_time(time_s);
        }
    }

    /// Applies edits as one undo step, or shows why there are none.
    fn time_edit(&mut self, label: &'static str, edits: Result<Vec<Edit>, &'static str>) {
        match edits {
            Ok(edits) => self.apply(label, &edits),
            Err(why) => self.note(t(why)),
        }
    }

    /// Makes a forecast of the scene, which is staged for a verdict.
    fn forecast(&mut self, seconds: f64) {
        let before = self.document.settled_scene().clone();
        let found = match forecast(&before, seconds) {
            Ok(found) => found,
            Err(problem) => return self.fail(problem),
        };
        self.apply("Forecast", &found.edits);
        let after = self.document.settled_scene().clone();
        if after.content() == before.content() {
            return;
        }
        let (from_s, to_s) = (before.clip().length_s, after.clip().length_s);
        let note = tf!(
            "{from} to {to} s",
            from = format!("{from_s:.1}"),
            to = format!("{to_s:.1}"),
        );
        self.generation.versions.push("Forecast".to_owned(), note, after);
        self.stage_forecast(before, found.objects);
        if let Some(said) = found.said() {
            self.note(&said);
        }
        self.show_time(from_s);
        self.state.playback.playing = true;
    }

    fn show_time(&mut self, time_s: f64) {
        let followed = self.state.selected;
        let before = followed_pose(self.document.scene(), followed);
        if self.document.show(time_s) && self.state.playback.follow {
            let after = followed_pose(self.document.scene(), followed);
            if let (Some(before), Some(after)) = (before, after) {
                self.views.view3d.camera.go_along(&before, &after);
            }
        }
    }

    /// Shows the next moment of a playing clip.
    pub(crate) fn play(&mut self, ctx: &Context) {
        self.tap_of_space(ctx);
        // When a scene becomes a clip, its timeline opens.
        let lasts = self.document.scene().clip().length_s > 0.0;
        if lasts && !self.state.playback.known {
            self.views.dock.open(PaneId::TIMELINE);
        }
        self.state.playback.known = lasts;
        let scene = self.document.scene();
        let (shown_s, length_s) = (scene.time_s(), scene.clip().length_s);
        let now_s = self.now_s();
        if self.document.is_dragging() {
            return;
        }
        if let Some(time_s) = self.state.playback.tick(shown_s, length_s, now_s) {
            self.show_time(time_s);
        }
        if self.state.playback.playing {
            ctx.request_repaint();
        }
    }

    /// A tap of the space bar plays or pauses; held, the bar lets the pointer move the views.
    fn tap_of_space(&mut self, ctx: &Context) {
        let typing = ctx.text_edit_focused();
        let id = egui::Id::unique("space pressed");
        let (pressed, released, moved, now_s) = ctx.input(|i| {
            let is = |e: &egui::Event, down: bool| {
                matches!(e, egui::Event::Key { key: egui::Key::Space, pressed, repeat: false, modifiers, .. }
                    if *pressed == down && !modifiers.any())
            };
            (
                i.events.iter().any(|e| is(e, true)),
                i.events.iter().any(|e| is(e, false)),
                i.pointer.any_down(),
                i.time,
            )
        });
        let since: Option<f64> = ctx.data(|d| d.get_temp(id));
        // A quick tap goes down and up between two frames.
        let since_s = since.or(pressed.then_some(now_s));
        if released && !moved && !typing && since_s.is_some_and(|since| now_s - since < TAP_S) {
            self.time_command(TimeCommand::Play);
        }
        // A mouse button pressed meanwhile means that the bar was held for the views.
        let since = match (pressed, moved || released) {
            (_, true) => None,
            (true, false) => Some(now_s),
            (false, false) => since,
        };
        ctx.data_mut(|d| match since {
            Some(since) => drop(d.insert_temp(id, since)),
            None => d.remove::<f64>(id),
        });
    }

    /// The label of edits; it names the moments for which a moving object changes, unless these are all.
    pub(crate) fn meant_label(&self, label: Label, edits: &[Edit]) -> Label {
        let scope = self.state.playback.scope;
        let clip = self.document.scene().clip();
        let moves = |edit: &Edit| match edit {
            Edit::RemoveBox { id } | Edit::MoveBox { id, .. } => clip.tracks.contains_key(id),
            _ => false,
        };
        match scope != Scope::WholeTrack && edits.iter().any(moves) {
            true => tf!(
                "{step}, {moments}",
                step = t(&label),
                moments = t(&scope_name(scope).to_lowercase()),
            )
            .into(),
            false => label,
        }
    }

    /// The edits with the scope of the timeline: for the whole track, one moment, or from here on.
    pub(crate) fn meant(&self, edits: Vec<Edit>) -> Vec<Edit> {
        (self.meaning())(edits)
    }

    /// The function of [`Self::meant`] with the present choices, as a value that another thread can use.
    pub(crate) fn meaning(&self) -> impl Fn(Vec<Edit>) -> Vec<Edit> + Send + use<> {
        let (scope, correcting) = (self.state.playback.scope, self.state.correcting);
        let lasts = self.document.scene().clip().length_s != 0.0;
        move |edits| of_moments(crate::state::corrected(correcting, edits), scope, lasts)
    }
}

/// Edits of boxes, limited to the chosen moments.
fn of_moments(edits: Vec<Edit>, scope: Scope, lasts: bool) -> Vec<Edit> {
    if scope == Scope::WholeTrack || !lasts {
        return edits;
    }
    let of_a_moment = |edit: &Edit| {
        matches!(
            edit,
            Edit::AddBox { .. } | Edit::RemoveBox { .. } | Edit::MoveBox { .. }
        )
    };
    let meant = |edit: Edit| match of_a_moment(&edit) {
        true => Edit::At {
            frame: None,
            time_s: None,
            track: None,
            scope: Some(scope),
            edit: Box::new(edit),
        },
        false => edit,
    };
    edits.into_iter().map(meant).collect()
}
