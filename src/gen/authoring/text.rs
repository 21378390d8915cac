//! Texts to scenes and edits: shared by the window and the command line.

use std::collections::BTreeMap;

use anyhow::bail;

use super::afterwards::{off_by, told};
use super::in_motion::set_in_motion;
use super::new_ground::beside_new_ground;
use super::open;
use super::prompting::{How, Laid, lay_out};
use editor::clashes::{clashes, new_clashes};
use editor::{Edit, apply_all};
use place::description::Description;
use scene::{Clip, Frame, Scene};
use words::answer::answer;
use words::beside::edits::{OpenBackground, ThingOutcome, carry_out as carry_out_beside, means_barriers};
use words::beside::wishes::scenery;
use words::carry_out::carry_out;
use words::conditions::of_style;
use words::describe::{Described, describe};
use words::hear::{CheckedReading, hear, hear_objects};
use words::reader::Mode;
use words::reading::Reading;
use words::stage::{OpenScene, ReadingOutcome};
use world::World;

/// A scene made from a description.
pub struct DraftedScene {
    /// The scene, its occupancy drafted.
    pub scene: Scene,
    /// Graph, road and places, with how they were made.
    pub laid: Laid,
}

/// Most letters of a scene's title.
const LONGEST_TITLE: usize = 48;

/// Title of a scene that is made from words: the words, cut between two of them.
pub fn title(words: &str) -> String {
    let mut out = String::new();
    for word in words.split_whitespace() {
        if out.chars().count() + word.chars().count() > LONGEST_TITLE {
            let short = match out.is_empty() {
                true => word.chars().take(LONGEST_TITLE).collect(),
                false => out.trim_end_matches([',', ';', '.', ' ']).to_owned(),
            };
            return short + "…";
        }
        out.extend([if out.is_empty() { "" } else { " " }, word]);
    }
    out.trim_end_matches(['.', ',']).to_owned()
}

/// A prompt for a new scene, read.
#[derive(Clone, Debug)]
pub struct Prompted {
    /// Result of the readers for the prompt, with its doubts; the reading may have been changed by hand since.
    pub heard: CheckedReading,
    /// The description of the scene.
    pub described: Described,
}

impl Prompted {
    /// The description of a reading.
    pub fn new(heard: CheckedReading) -> Self {
        let described = describe(&heard.reading);
        Self { heard, described }
    }

    /// The answer in a sentence.
    pub fn answer(&self) -> String {
        let remarks = &self.described.remarks;
        let mut text = answer(&self.heard.reading, None, remarks, &self.heard.missing);
        let Reading { acts, background } = &self.heard.reading;
        if acts.is_empty() && self.heard.missing.is_empty() {
            text.clear();
        }
        if !background.is_empty() {
            let words: Vec<String> = background.iter().map(|s| s.described()).collect();
            text = format!("{text} Beside the road: {}.", words.join("; "));
        }
        text.trim().to_owned()
    }

    /// Doubts about the reading, one line each.
    pub fn doubts(&self) -> Vec<String> {
        doubts(&self.heard)
    }
}

/// Doubts about how a text was read, one line each.
pub fn doubts(heard: &CheckedReading) -> Vec<String> {
    use words::answer::sentence;
    let mut out = Vec::new();
    let unsure = heard.unsure.iter().filter_map(|i| heard.reading.acts.get(*i));
    let unsure: Vec<String> = unsure.map(|a| sentence(&a.what)).collect();
    if !unsure.is_empty() {
        out.push(format!("not sure of: {}", unsure.join("; ")));
    }
    if let Some(other) = &heard.other {
        out.push(format!("it may also mean: {}", answer(other, None, &[], &[])));
    }
    out
}

/// Reads a prompt for a new scene; an error in one line if nothing in it can become one.
pub fn read(prompt: &str) -> anyhow::Result<Prompted> {
    if prompt.trim().is_empty() {
        bail!(
            "the prompt is empty: say what the scene should hold, such as \"two parked cars and a bus ahead, at night\""
        );
    }
    let prompted = Prompted::new(hear(prompt, Mode::Prompt)?);
    if prompted.described.description.is_empty() {
        let some: Vec<&str> = prompted
            .heard
            .missing
            .iter()
            .take(4)
            .map(|m| m.words.as_str())
            .collect();
        let what = if some.is_empty() {
            String::new()
        } else {
            format!(" (not understood: {})", some.join(", "))
        };
        bail!("nothing in the prompt names a part of a driving scene{what}; prompts are read in English");
    }
    Ok(prompted)
}

/// Road, objects and ego for a description, all drawn from `seed`. The occupancy is that of a procedural world, as made
/// by `sceneloom new`.
pub fn make(prompt: &str, description: &Description, seed: u64, how: &How) -> DraftedScene {
    made(lay_out(prompt, description, seed, how), seed)
}

/// A scene of a layout from words; unmet wishes for its background are added to those for the road.
pub fn made(mut laid: Laid, seed: u64) -> DraftedScene {
    let relief = &laid.road.layout.relief;
    for b in &mut laid.placement.boxes {
        // On a road that was kept; boxes that were kept too are on its ground already.
        if b.center_m.z == b.size_m.z / 2.0 {
            b.center_m.z += relief.height_m(b.center_m.truncate());
        }
    }
    let boxes: BTreeMap<_, _> = laid.placement.boxes.iter().map(|b| (b.id, *b)).collect();
    let (things, short) = scenery(&laid.description, &laid.road.layout, &boxes, seed);
    laid.road.missing.extend(short);
    let world = World::with_background(laid.road.layout.clone(), boxes, things, seed);
    let mut scene = open::of_world(&world, "prompt");
    scene.prompt = laid.description.style().into();
    scene.conditions = laid.description.conditions(scene.seed);
    let before = scene.clone();
    let cannot = set_in_motion(&mut scene, &laid);
    laid.road.missing.extend(cannot);
    let off = off_by(&laid);
    laid.notes.extend(off.into_iter().chain(told(&clashes(&scene))));
    let edits = beside_new_ground(&before, &scene);
    laid.road.missing.extend(take_over(&edits, &mut scene));
    DraftedScene { scene, laid }
}

/// Applies all edits on new ground, or none of them and returns the reason.
fn take_over(edits: &[Edit], scene: &mut Scene) -> Option<String> {
    let mut drawn = scene.clone();
    match apply_all(edits, &mut drawn) {
        Ok(()) => *scene = drawn,
        Err(error) => return Some(format!("scenery on the new ground: {error}")),
    }
    None
}

/// A text as a change of a scene.
#[derive(Clone, Debug)]
pub struct Edited {
    /// Result of the readers for the text, with its doubts.
    pub heard: CheckedReading,
    /// Result of the acts: changes, questions, remarks.
    pub outcome: ReadingOutcome,
    /// Result of the clauses on scenery.
    pub things: ThingOutcome,
}

impl Edited {
    /// All edits, in order: those of the background after those of boxes and map.
    pub fn edits(&self) -> Vec<Edit> {
        [self.outcome.edits.as_slice(), &self.things.edits].concat()
    }

    /// True if a question must be answered first.
    pub fn asks(&self) -> bool {
        !(self.outcome.questions.is_empty() && self.things.questions.is_empty())
    }

    /// Overlaps and collisions of the changed scene that were not there `before`, in the words of the checks.
    fn clashes(&self, before: &Scene) -> Vec<String> {
        let edits = self.edits();
        let mut after = before.clone();
        // (nothing changes while a question is open)
        match !self.asks() && !edits.is_empty() && apply_all(&edits, &mut after).is_ok() {
            true => new_clashes(before, &after),
            false => Vec::new(),
        }
    }

    /// The answer in a sentence, with the collisions that the checks find in the result; `before` is the scene that it
    /// changes.
    pub fn answer_on(&self, before: &Scene) -> String {
        let clashes = told(&self.clashes(before)).map(|c| format!("But {c}."));
        let parts: Vec<String> = Some(self.answer()).into_iter().chain(clashes).collect();
        parts.join(" ")
    }

    /// The answer in a sentence, without checks of the result.
    pub fn answer(&self) -> String {
        let mut parts = Vec::new();
        let reading = &self.heard.reading;
        if !reading.acts.is_empty() || !self.heard.missing.is_empty() || reading.is_empty() {
            parts.push(answer(
                &self.heard.reading,
                Some(&self.outcome),
                &self.outcome.remarks,
                &self.heard.missing,
            ));
        }
        if !self.things.done.is_empty() {
            parts.push(format!("Beside the road: {}.", self.things.done.join("; ")));
        }
        parts.extend(self.things.cannot.iter().map(|c| format!("Not done: {c}.")));
        parts.join(" ")
    }
}

/// Reads words as edits of a scene, and carries them out on a copy.
///
/// # Errors
///
/// If the bundled weights are damaged.
pub fn read_edit(prompt: &str, scene: &Scene, seed: u64) -> anyhow::Result<Edited> {
    let mut heard = hear(prompt, Mode::Edit)?;
    // ("fence" and "guard rail" name barriers too, if there are any)
    if means_barriers(&heard.reading.background, &scene.frame().boxes) {
        heard = hear_objects(prompt, Mode::Edit)?;
    }
    Ok(edited(heard, scene, seed))
}

/// Carries out a given reading, in the frame of the ego vehicle at the moment that is shown.
pub fn edited(heard: CheckedReading, scene: &Scene, seed: u64) -> Edited {
    let ego = scene.in_ego();
    let frame = ego.frame();
    let mut outcome = carry_out(&heard.reading, &open_scene(&ego, scene.clip()), seed);
    put_on_ground(&mut outcome.edits, frame);
    let open = OpenBackground {
        things: &ego.background,
        layout: &frame.layout,
        boxes: &frame.boxes,
    };
    let mut things = carry_out_beside(&heard.reading.background, &open, seed);
    let pose = scene.frame().world_from_ego;
    let (here, map) = (frame.extent(), scene.frame().extent());
    for edits in [&mut outcome.edits, &mut things.edits] {
        for edit in edits {
            let in_ego = std::mem::replace(edit, Edit::ConfirmInferred {});
            *edit = in_ego.into_world(&pose, here, map);
        }
    }
    Edited {
        things,
        heard,
        outcome,
    }
}

/// Puts boxes on the ground. Words place things on level ground: new boxes are put on the ground of the frame, moved
/// boxes keep their height above it.
fn put_on_ground(edits: &mut [Edit], frame: &Frame) {
    let relief = &frame.layout.relief;
    if relief.is_flat() {
        return;
    }
    let ground_m = |center_m: glam::DVec3| relief.height_m(center_m.truncate());
    for edit in edits {
        match edit {
            Edit::AddBox { center_m, size_m, .. } => center_m.z = ground_m(*center_m) + size_m.z / 2.0,
            Edit::MoveBox {
                id,
                center_m: Some(center_m),
                ..
            } => {
                let was_m = frame.boxes.get(id).map_or(0.0, |b| ground_m(b.center_m));
                center_m.z += ground_m(*center_m) - was_m;
            }
            _ => {}
        }
    }
}

/// The part of a scene that text edits need: the frame of a moment, and the clip that the moment belongs to.
pub fn open_scene<'a>(scene: &'a Scene, clip: &'a Clip) -> OpenScene<'a> {
    let frame = scene.frame();
    OpenScene {
        boxes: &frame.boxes,
        layout: &frame.layout,
        prompt: &scene.prompt,
        conditions: scene.conditions,
        clip: Some(clip),
        ego_moves: clip.ego.is_some(),
        length_s: clip.length_s,
    }
}

/// Edits of a list in which each new style text sets the conditions that it names, as these words would in a prompt.
pub fn with_conditions(edits: &[Edit], seed: u64) -> Vec<Edit> {
    let mut out = Vec::with_capacity(edits.len());
    for edit in edits {
        out.push(edit.clone());
        if let Edit::SetPrompt { prompt } = edit {
            let conditions = of_style(prompt, seed);
            out.push(Edit::SetConditions { conditions });
        }
    }
    out
}

/// Objects that were left out and requirements that could not be met, in words, one line each.
pub fn shortfalls(made: &Laid) -> Vec<String> {
    let description = &made.description;
    let mut out = Vec::new();
    for (o, nodes) in description.foreground.iter().zip(&made.graphed.nodes) {
        let left: Vec<&String> = made
            .placement
            .left_out
            .iter()
            .filter(|(id, _)| nodes.contains(id))
            .map(|(_, why)| why)
            .collect();
        let beyond = (o.count.n as usize).saturating_sub(nodes.len());
        if let Some(why) = left.first() {
            let placed = nodes.len() - left.len();
            out.push(format!("{}: {placed} of {} placed: {why}", o.called(), o.count.n));
        } else if beyond > 0 {
            out.push(format!("{}: {} of {} placed", o.called(), nodes.len(), o.count.n));
        }
    }
    for (i, o) in description.foreground.iter().enumerate() {
        let far = o
            .relations
            .iter()
            .filter_map(|r| r.distance_m)
            .find(|d| *d > 40.0);
        if let Some(d) = far {
            out.push(format!(
                "{}: {d:.0} m lies outside the scene, which reaches 40 m from the ego vehicle",
                o.called()
            ));
        }
        let nodes = &made.graphed.nodes[i];
        let mut names: Vec<&str> = made
            .placement
            .unmet
            .iter()
            .map(|k| &made.graphed.graph.edges[*k])
            .filter(|e| nodes.contains(&e.from))
            .map(|e| e.relation.name())
            .collect();
        names.dedup();
        if !names.is_empty() {
            out.push(format!(
                "{}: could not be met: {}",
                o.called(),
                names.join(", ").replace('_', " ")
            ));
        }
    }
    out.extend(made.road.missing.iter().cloned());
    out
}

#[cfg(test)]
mod tests {
    #[test]
    fn titles_are_cut_between_words() {
        assert_eq!(super::title("night,  a bus\n ahead."), "night, a bus ahead");
        let long = "busy intersection at night in the rain, five cones block my lane";
        assert_eq!(
            super::title(long),
            "busy intersection at night in the rain, five…"
        );
        assert_eq!(super::title(&"ä".repeat(60)), format!("{}…", "ä".repeat(48)));
        assert_eq!(super::title(""), "");
    }

    use super::*;
    use editor::Document;
    use scene::Extent;
    use scene::{BoxId, Relief, SceneBox};

    #[test]
    fn scenery_that_is_refused_is_told_and_not_half_drawn() {
        let description = read("a parked car 12 m ahead")
            .expect("a scene")
            .described
            .description;
        let mut scene = make("", &description, 3, &How::default()).scene;
        let before = scene.clone();
        let id = *before.frame().boxes.keys().next().expect("the car");
        let refused = [Edit::RemoveBox { id }, Edit::RemoveBox { id: BoxId(4000) }];
        let said = take_over(&refused, &mut scene).expect("no such box");
        assert!(
            said.starts_with("scenery on the new ground: ") && said.contains("4000"),
            "{said}"
        );
        assert_eq!(scene.content(), before.content());
        assert_eq!(take_over(&refused[..1], &mut scene), None);
        assert!(scene.frame().boxes.is_empty());
    }

    /// Boxes that words add or move on a grade stand on its ground.
    #[test]
    fn words_know_the_ground() {
        let prompted = read("a parked car 12 m ahead, a bus 25 m ahead").expect("a scene");
        let description = prompted.described.description;
        let mut scene = make("", &description, 3, &How::default()).scene;
        scene.change_canvas(|frame| {
            frame.layout.relief = Relief::from_fn(Extent::WINDOW, |p| 0.06 * p.x);
            for b in frame.boxes.values_mut() {
                b.center_m.z += 0.06 * b.center_m.x;
            }
        });
        let above_m = |frame: &Frame, b: &SceneBox| {
            b.center_m.z - b.size_m.z / 2.0 - frame.layout.relief.height_m(b.center_m.truncate())
        };
        let reading = read_edit(
            "add a truck 18 m ahead; move the bus 5 m back; replace the car with a van",
            &scene,
            1,
        )
        .expect("weights");
        let edits = reading.edits();
        assert!(edits.len() >= 3, "{reading:?}");
        let mut document = Document::new(scene);
        document.apply_all("Words", &edits).expect("sound edits");
        let frame = document.scene().frame().clone();
        assert!(frame.boxes.len() >= 3);
        for b in frame.boxes.values() {
            let above_m = above_m(&frame, b);
            assert!(above_m.abs() < 0.15, "{:?} {above_m} m above the ground", b.class);
        }
    }
}

#[cfg(test)]
#[path = "motion_tests.rs"]
mod motion_tests;
