//! Quality checks of a scene: probable mistakes, their places, and repairs. One check per file; each looks at the frame
//! being edited and never panics, whatever the frame holds.

mod against_lane;
mod box_without_occupancy;
mod findings;
mod floating_voxels;
mod geometry;
mod lanes;
mod locomotion;
mod occupancy_without_box;
mod off_road;
mod on_the_road;
mod out_of_range;
mod over_time;
mod overlapping_boxes;
mod unseen;
mod unsound;
mod unsupported_parts;
pub mod waive;

use std::collections::BTreeMap;

use glam::DVec3;

use super::Edit;
use findings::Findings;
pub use findings::MOST;
pub(crate) use findings::{FindingKind, FindingTally};
use language::{t, tf};
pub(crate) use over_time::{Collision, CollisionPartner, collisions};
use scene::draft::{ground_bin, ground_class};
use scene::{BoxId, Class, Extent, Frame, Scene, SceneBox, support};

/// Worth knowing and no mistake: for example objects that no sensor sees.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Severity {
    /// Worth knowing and no mistake: what no sensor sees.
    Info,
    /// Probably a mistake; the scene can be used.
    Warning,
    /// Wrong: labels, layout or boxes contradict each other or themselves.
    Error,
}

impl Severity {
    /// Every one, the worst first.
    pub const ALL: [Severity; 3] = [Severity::Error, Severity::Warning, Severity::Info];

    /// Name in reports: `info`, `warning`, `error`.
    pub fn name(self) -> &'static str {
        match self {
            Severity::Info => "info",
            Severity::Warning => "warning",
            Severity::Error => "error",
        }
    }
}

/// One way to repair a finding.
#[derive(Clone, Debug, PartialEq)]
pub struct Fix {
    /// Name of the repair, for a button and for the history: `Drop to the ground`.
    pub label: &'static str,
    /// The edits, to be applied as one undo step.
    pub edits: Vec<Edit>,
}

impl Fix {
    /// True if it makes the map larger: such a repair runs only if it is asked for by name, never together with others.
    pub fn enlarges_the_map(&self) -> bool {
        self.edits.iter().any(|e| matches!(e, Edit::ExtendMap { .. }))
    }
}

/// One finding of a check.
#[derive(Clone, Debug, PartialEq)]
pub struct Finding {
    /// Name of the check, as in reports: `overlapping_boxes`.
    pub check: &'static str,
    /// How bad it is.
    pub severity: Severity,
    /// Position in the world frame, m; always finite.
    pub where_m: DVec3,
    /// Time in the clip, s; `None` if it is about the moment that is shown.
    pub time_s: Option<f64>,
    /// The box it is about, if it is about one.
    pub box_id: Option<BoxId>,
    /// The voxels it is about, if it is about voxels.
    pub cells: Vec<[usize; 3]>,
    /// One line for a person.
    pub text: String,
    /// Ways to repair it, the best first; none where a person has to decide.
    pub fixes: Vec<Fix>,
}

impl Finding {
    /// The repair that is tried where all are asked for: the best one. `None` for [`Severity::Info`], and if that
    /// repair has to be asked for by name.
    pub fn first_fix(&self) -> Option<&Fix> {
        let fix = self.fixes.first()?;
        (self.severity > Severity::Info && !fix.enlarges_the_map()).then_some(fix)
    }
}

/// How many findings there are of each severity.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct SeverityCounts {
    /// See [`Severity::Error`].
    pub errors: usize,
    /// See [`Severity::Warning`].
    pub warnings: usize,
    /// See [`Severity::Info`].
    pub infos: usize,
}

impl SeverityCounts {
    /// Counts these findings.
    pub fn from_findings<'a>(findings: impl IntoIterator<Item = &'a Finding>) -> Self {
        let mut out = Self::default();
        for finding in findings {
            *out.of_mut(finding.severity) += 1;
        }
        out
    }

    pub(crate) fn of_mut(&mut self, severity: Severity) -> &mut usize {
        match severity {
            Severity::Error => &mut self.errors,
            Severity::Warning => &mut self.warnings,
            Severity::Info => &mut self.infos,
        }
    }

    /// The number of findings of one severity.
    pub fn count(&self, severity: Severity) -> usize {
        match severity {
            Severity::Error => self.errors,
            Severity::Warning => self.warnings,
            Severity::Info => self.infos,
        }
    }
}

/// Pixels and returns of each box in the sensors; a box that is missing counts as 0.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct VisibilityCounts {
    /// Pixels of all cameras together; `None` if no camera was rendered.
    pub camera_pixels: Option<BTreeMap<BoxId, u32>>,
    /// LiDAR returns; `None` if there was no sweep.
    pub lidar_returns: Option<BTreeMap<BoxId, u32>>,
}

/// Input and caches that the checks share.
struct Context<'a> {
    scene: &'a Scene,
    frame: &'a Frame,
    /// Boxes whose numbers can be relied on, by id.
    boxes: Vec<SceneBox>,
    seen: Option<&'a VisibilityCounts>,
    /// Moving objects over the course of the clip, made when the first check asks for them.
    over_time: std::cell::OnceCell<over_time::OverTime>,
    /// The frame's occupancy as bits, made when the first check asks for it.
    bits: std::cell::OnceCell<Bits>,
    /// Next id that is neither in the frame nor in its source.
    next_id: std::cell::Cell<u32>,
}

/// Occupancy as one word per column, one bit per bin.
struct Bits {
    /// By class id; empty for a class that does not occur.
    by_class: Vec<Vec<u64>>,
    /// Voxels that are not free.
    occupied: Vec<u64>,
    /// Voxels of a ground class.
    ground: Vec<u64>,
    /// Occupied voxels that are supported by the ground, directly or through the voxels they touch.
    supported: Vec<u64>,
}

type CheckFunction = fn(&Context<'_>, &mut Findings);

/// Every check, in the order of reports.
const CHECKS: [(&str, CheckFunction); 18] = [
    (unsound::NAME, unsound::check),
    (out_of_range::NAME, out_of_range::check),
    (overlapping_boxes::NAME, overlapping_boxes::check),
    (box_without_occupancy::NAME, box_without_occupancy::check),
    (occupancy_without_box::NAME, occupancy_without_box::check),
    (off_road::NAME, off_road::check),
    (against_lane::NAME, against_lane::check),
    (on_the_road::NAME, on_the_road::check),
    (floating_voxels::NAME, floating_voxels::check),
    (unsupported_parts::NAME, unsupported_parts::check),
    (over_time::COLLISION, over_time::collision),
    (over_time::THROUGH_WALL, over_time::through_wall),
    (over_time::TOO_FAST, over_time::too_fast),
    (over_time::TOO_SUDDEN, over_time::too_sudden),
    (over_time::BACKWARDS, over_time::backwards),
    (over_time::LEAVES_MAP, over_time::leaves_map),
    (unseen::NO_CAMERA, unseen::by_cameras),
    (unseen::NO_LIDAR, unseen::by_lidar),
];

/// Title of a check for the user: `Boxes overlap`. The name itself for an unknown check.
pub fn title(check: &str) -> &str {
    match check {
        unsound::NAME => "Numbers that cannot be",
        out_of_range::NAME => "Off the ground or beyond the map",
        overlapping_boxes::NAME => "Boxes overlap",
        box_without_occupancy::NAME => "Boxes without voxels",
        occupancy_without_box::NAME => "Voxels without a box",
        off_road::NAME => "Off the road",
        against_lane::NAME => "Against the lane",
        on_the_road::NAME => "Things on the road",
        floating_voxels::NAME => "Floating voxels",
        unsupported_parts::NAME => "Parts without support",
        over_time::COLLISION => "Collisions",
        over_time::THROUGH_WALL => "Through walls",
        over_time::TOO_FAST => "Too fast",
        over_time::TOO_SUDDEN => "Too sudden",
        over_time::BACKWARDS => "Backwards",
        over_time::LEAVES_MAP => "Leaves the map",
        unseen::NO_CAMERA => "In no camera picture",
        unseen::NO_LIDAR => "No LiDAR return",
        other => other,
    }
}

/// Names of all checks, in the order of reports.
pub fn names() -> impl Iterator<Item = &'static str> {
    CHECKS.iter().map(|(name, _)| *name)
}

/// Runs every check on the frame being edited; errors first, else in the order of [`names`]. Without `seen` the two
/// checks that need sensors are left out. Of each check at most [`MOST`] findings are listed; one more counts the rest.
pub fn run_checks(scene: &Scene, seen: Option<&VisibilityCounts>) -> Vec<Finding> {
    run(scene, seen, &CHECKS, MOST).0
}

/// The overlapping boxes alone.
pub(crate) fn overlaps(scene: &Scene) -> Vec<Finding> {
    let overlapping: (_, CheckFunction) = (overlapping_boxes::NAME, overlapping_boxes::check);
    run(scene, None, &[overlapping], MOST).0
}

/// Findings of all checks that need no sensor, and the number of each kind.
pub(crate) fn run_counted(scene: &Scene) -> (Vec<Finding>, FindingTally) {
    run(scene, None, &CHECKS, MOST)
}

/// The number of findings of each kind by the checks that need no sensor, without a list: several times faster where
/// there are many.
pub(crate) fn tally(scene: &Scene) -> FindingTally {
    run(scene, None, &CHECKS, 0).1
}

fn run(
    scene: &Scene,
    seen: Option<&VisibilityCounts>,
    checks: &[(&'static str, CheckFunction)],
    most: usize,
) -> (Vec<Finding>, FindingTally) {
    let frame = scene.frame();
    let highest = |boxes: &BTreeMap<BoxId, SceneBox>| boxes.keys().next_back().map_or(0, |id| id.0);
    let context = Context {
        scene,
        frame,
        boxes: frame
            .boxes
            .iter()
            .filter(|(id, b)| **id == b.id && b.problem().is_none())
            .map(|(_, b)| *b)
            .collect(),
        seen,
        over_time: std::cell::OnceCell::new(),
        bits: std::cell::OnceCell::new(),
        next_id: highest(&frame.boxes)
            .max(highest(&frame.source.boxes))
            .saturating_add(1)
            .into(),
    };
    let mut findings = Findings::from_scene(scene, most);
    for (name, check) in checks {
        check(&context, &mut findings);
        findings.end(name);
    }
    findings.done()
}

impl Context<'_> {
    fn over_time(&self) -> &over_time::OverTime {
        self.over_time
            .get_or_init(|| over_time::OverTime::from_context(self))
    }

    fn bits(&self) -> &Bits {
        self.bits.get_or_init(|| {
            let extent = self.frame.extent();
            let by_class = support::by_class(&self.frame.occupancy);
            let occupied = support::occupied(&self.frame.occupancy);
            let ground = support::ground(extent, &by_class);
            Bits {
                supported: support::supported(extent, &occupied, &ground),
                by_class,
                occupied,
                ground,
            }
        })
    }

    /// An id that no box has, nor had when the frame was last generated; another one each time.
    fn fresh_id(&self) -> BoxId {
        let id = self.next_id.get();
        self.next_id.set(id.saturating_add(1));
        BoxId(id)
    }
}

/// `car 7`
fn name_of(b: &SceneBox) -> String {
    tf!("{class} {id}", class = t(&b.class.label()), id = b.id.0)
}

/// Edits that take voxels away; where the bin of the ground is emptied, the ground that the layout asks for is laid.
fn removal(frame: &Frame, cells: &[[usize; 3]]) -> Vec<Edit> {
    let mut of_class: BTreeMap<Class, Vec<[usize; 3]>> = BTreeMap::new();
    for &[x, y, z] in cells {
        let class = match z {
            z if z == ground_bin(&frame.layout, x, y) => ground_class(frame.layout.cell(x, y)),
            _ => Class::Free,
        };
        of_class.entry(class).or_default().push([x, y, z]);
    }
    of_class
        .into_iter()
        .map(|(class, cells)| Edit::PaintVoxels { cells, class })
        .collect()
}

/// Mean of the centres of voxels, ego frame, m; the origin for none.
fn middle(extent: Extent, cells: &[[usize; 3]]) -> DVec3 {
    let sum: DVec3 = cells.iter().map(|&[x, y, z]| extent.center(x, y, z)).sum();
    sum / (cells.len().max(1) as f64)
}

#[cfg(test)]
#[path = "tests.rs"]
pub(crate) mod tests;
#[cfg(test)]
pub(crate) mod tests_noise;
#[cfg(test)]
mod tests_recorded;
