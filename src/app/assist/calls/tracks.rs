//! Tracks: boxes and the ego vehicle move in ways that have a name.

use anyhow::{Context, bail};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::call::Operation;
use crate::desk::{Desk, Done};
use editor::Edit;
use scene::{BoxId, Class, Clip, Motion, Scene, Template};

/// Arguments of `add_track`.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct AddTrack {
    /// The box that moves from where it is at the moment that is shown; the ego vehicle if left out.
    #[serde(default, rename = "box")]
    box_id: Option<BoxId>,
    /// How it moves, along the lanes of the map.
    template: Template,
    /// Speed, m/s; a usual one of its class if left out.
    #[serde(default)]
    mps: Option<f64>,
    /// When what it is about begins (the cut-in, the crossing, the stop), s; soon if left out.
    #[serde(default)]
    from_s: Option<f64>,
    /// It begins when so much is left between it and the ego vehicle, m, in place of at a time (only if the ego vehicle moves); who
    /// follows keeps so much to the one ahead. Bumper to bumper.
    #[serde(default)]
    gap_m: Option<f64>,
    /// How long the scene lasts from now on, s; as before if left out, or as long as the motion needs if it was one moment.
    #[serde(default)]
    length_s: Option<f64>,
}

/// Arguments of `remove_track`.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct RemoveTrack {
    /// The box that stands from now on where it is at the moment that is shown; the ego vehicle if left out.
    #[serde(default, rename = "box")]
    box_id: Option<BoxId>,
}

/// Arguments of `list_tracks`: none.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct ListTracks {}

/// Receipt of `add_track`.
#[derive(Debug, Serialize, JsonSchema)]
pub struct TrackAdded {
    /// Changes of the scene.
    #[serde(flatten)]
    done: Done,
    /// The track.
    track: TrackState,
    /// How long the scene lasts now, s.
    length_s: f64,
}

/// Receipt of `list_tracks`.
#[derive(Debug, Serialize, JsonSchema)]
pub struct TrackList {
    /// All tracks, the ego vehicle's first.
    tracks: Vec<TrackState>,
    /// How long the scene lasts, s; 0 for one moment.
    length_s: f64,
    /// The moment that is shown, s.
    time_s: f64,
}

/// A moving object, or the moving ego vehicle.
#[derive(Debug, Serialize, JsonSchema)]
pub struct TrackState {
    /// The box; none for the ego vehicle.
    #[serde(rename = "box")]
    box_id: Option<u32>,
    /// Its class; none for the ego vehicle.
    class: Option<Class>,
    /// `keys` (through keyframes), `path` (along a path) or `attached` (to another box).
    motion: String,
    /// When it is there, s: from the first up to the second; none: from the beginning, to the end.
    there_s: [Option<f64>; 2],
    /// Its place at the beginning, the middle and the end of the scene, world frame: time in s, x and y in m, speed in
    /// m/s.
    passes: Vec<[f64; 4]>,
    /// True while its voxels are a draft that `generate` has not drawn yet.
    draft: bool,
}

fn kind(motion: &Motion) -> String {
    match motion {
        Motion::Keys(_) => "keys",
        Motion::Path(_) => "path",
        Motion::Attached { .. } => "attached",
    }
    .to_owned()
}

fn tidy(v: f64) -> f64 {
    (v * 100.0).round() / 100.0 + 0.0
}

/// The track of a box, or (`None`) of the ego vehicle.
fn track_state(scene: &Scene, id: Option<BoxId>) -> Option<TrackState> {
    let clip = scene.clip();
    let track = match id {
        Some(id) => Some(clip.tracks.get(&id)?),
        None => None,
    };
    let motion = match track {
        Some(track) => &track.motion,
        None => clip.ego.as_ref()?,
    };
    let times = [0.0, clip.length_s / 2.0, clip.length_s];
    let at = |time_s: f64| -> Option<[f64; 4]> {
        let moving = match id {
            Some(id) => clip.moving(id, time_s)?,
            None => motion.at(time_s, |to| clip.moving(to, time_s))?,
        };
        let [x, y] = moving.at_m.to_array();
        Some([time_s, x, y, moving.velocity_mps.length()].map(tidy))
    };
    Some(TrackState {
        box_id: id.map(|id| id.0),
        class: track.map(|t| t.made.class),
        motion: kind(motion),
        there_s: track.map_or([None; 2], |t| t.there_s),
        passes: times.into_iter().filter_map(at).collect(),
        draft: track.is_some_and(|t| !t.settled),
    })
}

/// Name of the object of a call, in words.
fn who(id: Option<BoxId>) -> String {
    id.map_or("the ego vehicle".to_owned(), |id| format!("box {}", id.0))
}

impl Operation for AddTrack {
    const NAME: &'static str = "add_track";
    const ABOUT: &'static str = "Lets a box or the ego vehicle move in a way that has a name: drive, follow, stop, cut_in (into our lane), cross (a pedestrian over the road), pull_out, park, turn_left, turn_right. A scene of one moment becomes a clip. A box that has a track gets the new one. Own paths: the edit set_motion of apply.";
    const EXAMPLE: &'static str = r#"{"template": "drive", "mps": 8, "length_s": 6}"#;
    const CHANGES: bool = true;
    type Receipt = TrackAdded;

    fn run(self, desk: &mut Desk) -> anyhow::Result<TrackAdded> {
        let id = self.box_id;
        let mut edits = Vec::new();
        if let Some(length_s) = self.length_s {
            // Written so that NaN fails too.
            if !(length_s > 0.0 && length_s <= Clip::MAX_LENGTH_S) {
                bail!(
                    "length_s is {length_s}, expected more than 0 and at most {} s",
                    Clip::MAX_LENGTH_S
                );
            }
            edits.push(Edit::SetLength {
                length_s,
                rate_hz: None,
            });
        }
        edits.push(Edit::LetMove {
            id,
            template: self.template,
            mps: self.mps,
            from_s: self.from_s,
            gap_m: self.gap_m,
        });
        let step = format!("Let {} {}", who(id), self.template.name().replace('_', " "));
        let done = desk.apply(step, edits)?;
        let scene = desk.scene()?;
        Ok(TrackAdded {
            done,
            track: track_state(&scene, id).context("the motion was not kept")?,
            length_s: scene.clip().length_s,
        })
    }
}

impl Operation for RemoveTrack {
    const NAME: &'static str = "remove_track";
    const ABOUT: &'static str = "Lets a box or the ego vehicle stand where it is at the moment that is shown. The box itself stays; the edit remove_box takes it out.";
    const EXAMPLE: &'static str = "{}";
    const CHANGES: bool = true;
    type Receipt = Done;

    fn run(self, desk: &mut Desk) -> anyhow::Result<Done> {
        let id = self.box_id;
        let scene = desk.scene()?;
        if track_state(&scene, id).is_none() {
            bail!("{} has no track", who(id));
        }
        let edit = Edit::SetMotion {
            id,
            motion: None,
            from_s: None,
            to_s: None,
        };
        desk.apply(format!("Let {} stand", who(id)), vec![edit])
    }
}

impl Operation for ListTracks {
    const NAME: &'static str = "list_tracks";
    const ABOUT: &'static str = "Lists what moves: the ego vehicle and boxes, with the places that they pass (m) and their speeds (m/s).";
    const EXAMPLE: &'static str = "{}";
    const CHANGES: bool = false;
    type Receipt = TrackList;

    fn run(self, desk: &mut Desk) -> anyhow::Result<TrackList> {
        let scene = desk.scene()?;
        let clip = scene.clip();
        let ids = std::iter::once(None).chain(clip.tracks.keys().map(|id| Some(*id)));
        Ok(TrackList {
            tracks: ids.filter_map(|id| track_state(&scene, id)).collect(),
            length_s: clip.length_s,
            time_s: scene.time_s(),
        })
    }
}
