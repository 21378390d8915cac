//! Things beside the road: buildings, trees, shrubs, hedges, walls, fences, poles, signs, bridges. Plain data in metres
//! of the clip's world frame; heights are above the ground where the thing stands.

mod bridge;
mod building;
mod columns;
mod line;
mod part;
mod post;
mod problem;
mod shrubs;
mod tree;

use std::collections::BTreeMap;

use glam::{DVec2, DVec3};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::solid::Solid;
use super::{Class, Extent, Pose};

pub use bridge::Bridge;
pub use building::{Building, Facade, Roof, STOREY_M};
pub use columns::ColumnLabels;
pub use line::{LineKind, SceneryLine};
pub use part::{PartRole, ThingPart};
pub use post::{Post, PostKind};
pub use problem::crossing_edges;
pub use shrubs::Shrubs;
pub use tree::{Tree, TreeKind};

/// Names a thing of the background; unique in a scene.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize, JsonSchema)]
#[serde(transparent)]
pub struct ThingId(pub u32);

/// Kind and place of a thing. As JSON: `{"tree": {"position_m": [8, -6], "height_m": 7, …}}`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub enum Form {
    /// A building with vertical walls.
    Building(Building),
    /// A tree.
    Tree(Tree),
    /// An area of shrubs and undergrowth.
    Shrubs(Shrubs),
    /// A hedge, wall, fence or rail.
    Line(SceneryLine),
    /// A pole, sign, lamp, stop, bench or bin.
    Post(Post),
    /// A road or path carried over the ground.
    Bridge(Bridge),
}

/// One thing of the background.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Thing {
    /// Its id.
    pub id: ThingId,
    /// Kind and place.
    pub form: Form,
    /// Number that selects one of many variants of its details (boughs, balconies); moving a thing keeps it.
    #[serde(default)]
    pub look: u32,
    /// True if it was added or changed by hand, by words or by a file, rather than drawn by a seed: it stays when
    /// scenery is drawn anew.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub placed: bool,
}

/// Height of the ground at a point, m, in the frame that the form is given in.
pub type GroundM<'a> = &'a dyn Fn(DVec2) -> f64;

impl Form {
    /// Its name in words.
    pub fn name(&self) -> &'static str {
        match self {
            Self::Building(_) => "building",
            Self::Tree(_) => "tree",
            Self::Shrubs(_) => "shrubs",
            Self::Line(line) => line.kind.name(),
            Self::Post(post) => post.kind.name(),
            Self::Bridge(_) => "bridge",
        }
    }

    /// Class of most of its voxels.
    pub fn class(&self) -> Class {
        match self {
            Self::Tree(_) | Self::Shrubs(_) => Class::Vegetation,
            Self::Line(line) => line.kind.class(),
            Self::Post(post) => post.kind.class(),
            Self::Building(_) | Self::Bridge(_) => Class::Manmade,
        }
    }

    /// True if it shows what kind of place it stands in; see [`Background::describes_place`].
    pub fn describes_place(&self) -> bool {
        match self {
            Self::Building(_) | Self::Tree(_) | Self::Shrubs(_) => true,
            Self::Line(line) => line.kind != LineKind::GuardRail,
            Self::Post(_) | Self::Bridge(_) => false,
        }
    }

    /// The first problem with it, in one line; `None` if it is sound.
    pub fn problem(&self) -> Option<String> {
        problem::problem(self)
    }

    /// Points that it is drawn and dragged by, m: its outline, line or place.
    pub fn points_m(&self) -> Vec<DVec2> {
        match self {
            Self::Building(b) => b.outline_m.clone(),
            Self::Shrubs(s) => s.outline_m.clone(),
            Self::Line(l) => l.points_m.clone(),
            Self::Bridge(b) => b.points_m.clone(),
            Self::Tree(t) => vec![t.position_m],
            Self::Post(p) => vec![p.position_m],
        }
    }

    /// Changes every point and heading: `point` maps points, `turn_rad` is added to headings.
    pub fn map_points(&mut self, mut point: impl FnMut(DVec2) -> DVec2, turn_rad: f64) {
        let mut all = |points: &mut Vec<DVec2>| points.iter_mut().for_each(|p| *p = point(*p));
        match self {
            Self::Building(b) => all(&mut b.outline_m),
            Self::Shrubs(s) => all(&mut s.outline_m),
            Self::Line(l) => all(&mut l.points_m),
            Self::Bridge(b) => all(&mut b.points_m),
            Self::Tree(t) => t.position_m = point(t.position_m),
            Self::Post(p) => {
                p.position_m = point(p.position_m);
                p.yaw_rad += turn_rad;
            }
        }
    }

    /// The form seen in another frame, by the heading and ground position of `to_from_here`.
    pub fn in_frame(&self, to_from_here: &Pose) -> Self {
        let mut out = self.clone();
        if *to_from_here != Pose::IDENTITY {
            let ahead = to_from_here.apply(DVec3::X) - to_from_here.apply(DVec3::ZERO);
            let turn_rad = ahead.y.atan2(ahead.x);
            out.map_points(|p| to_from_here.apply(p.extend(0.0)).truncate(), turn_rad);
        }
        out
    }

    /// Middle of its points, m.
    pub fn middle_m(&self) -> DVec2 {
        let points = self.points_m();
        points.iter().sum::<DVec2>() / points.len().max(1) as f64
    }

    /// Height of its top above the ground, m.
    pub fn height_m(&self) -> f64 {
        match self {
            Self::Building(b) => b.height_m,
            Self::Tree(t) => t.height_m,
            Self::Shrubs(s) => s.height_m,
            Self::Line(l) => l.height_m,
            Self::Post(p) => p.height_m,
            Self::Bridge(b) => b.height_m,
        }
    }

    /// How far it reaches beyond its points on the ground, m.
    pub fn overhang_m(&self) -> f64 {
        match self {
            Self::Building(b) => b.overhang_m(),
            Self::Tree(t) => t.crown_radius_m,
            Self::Shrubs(_) => 0.4,
            Self::Line(l) => l.width_m / 2.0,
            Self::Post(p) => p.kind.reach_m(),
            Self::Bridge(b) => b.width_m / 2.0 + 0.3,
        }
    }

    /// Corners of the upright box around it on the ground, m.
    pub fn bounds_m(&self) -> (DVec2, DVec2) {
        let reach = DVec2::splat(self.overhang_m());
        let points = self.points_m();
        let min = points.iter().copied().fold(DVec2::INFINITY, DVec2::min);
        let max = points.iter().copied().fold(DVec2::NEG_INFINITY, DVec2::max);
        (min - reach, max + reach)
    }
}

impl Thing {
    /// Its parts, in the frame of the form and of `ground_m`.
    pub fn parts(&self, ground_m: GroundM<'_>) -> Vec<ThingPart> {
        let (look, mut out) = (u64::from(self.look), Vec::new());
        match &self.form {
            Form::Building(b) => b.parts(look, ground_m, &mut out),
            Form::Tree(t) => t.parts(look, ground_m, &mut out),
            Form::Shrubs(s) => s.parts(look, ground_m, &mut out),
            Form::Line(l) => l.parts(look, ground_m, &mut out),
            Form::Post(p) => p.parts(look, ground_m, &mut out),
            Form::Bridge(b) => b.parts(ground_m, &mut out),
        }
        out
    }

    /// Appends the solids of [`Self::parts`].
    pub fn solids(&self, ground_m: GroundM<'_>, out: &mut Vec<Solid>) {
        out.extend(self.parts(ground_m).into_iter().map(|part| part.solid));
    }
}

/// All things of a scene by id.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Background {
    things: BTreeMap<ThingId, Thing>,
    next_at_least: u32, // 0 but while a change is applied again
}

impl Background {
    /// Most things of a scene; more are refused.
    pub const MAX_THINGS: usize = 20_000;

    /// Things in the order of their ids.
    pub fn iter(&self) -> impl DoubleEndedIterator<Item = &Thing> + ExactSizeIterator {
        self.things.values()
    }

    /// The thing of that id.
    pub fn get(&self, id: ThingId) -> Option<&Thing> {
        self.things.get(&id)
    }

    /// Number of things.
    pub fn len(&self) -> usize {
        self.things.len()
    }

    /// True if there are no things.
    pub fn is_empty(&self) -> bool {
        self.things.is_empty()
    }

    /// The id above all in use; a gap if the largest id is in use.
    pub fn next_id(&self) -> ThingId {
        let next = self
            .things
            .keys()
            .next_back()
            .map_or(Some(1), |id| id.0.checked_add(1))
            .map(|next| next.max(self.next_at_least));
        let gap = || (1..u32::MAX).find(|id| !self.things.contains_key(&ThingId(*id)));
        ThingId(next.or_else(gap).unwrap_or(u32::MAX))
    }

    /// Gives no id below one, until another limit is set: things that are added again keep their ids.
    pub fn give_from(&mut self, id: ThingId) {
        self.next_at_least = id.0;
    }

    /// Inserts a thing. Returns the one of the same id that it replaces.
    pub fn insert(&mut self, thing: Thing) -> Option<Thing> {
        self.things.insert(thing.id, thing)
    }

    /// Adds a form that a seed drew, under the next id, which also becomes its look.
    pub fn add(&mut self, form: Form) -> ThingId {
        self.add_as(form, false)
    }

    /// Adds a form under the next id, which also becomes its look; see [`Thing::placed`].
    pub fn add_as(&mut self, form: Form, placed: bool) -> ThingId {
        let id = self.next_id();
        self.insert(Thing {
            id,
            form,
            look: id.0,
            placed,
        });
        id
    }

    /// True if it shows what kind of place it is: there are buildings, plants or walls. Signs, lamps, benches and
    /// bridges alone do not show it.
    pub fn describes_place(&self) -> bool {
        self.things.values().any(|t| t.form.describes_place())
    }

    /// Removes a thing.
    pub fn remove(&mut self, id: ThingId) -> Option<Thing> {
        self.things.remove(&id)
    }

    /// All things in another frame; see [`Form::in_frame`].
    pub fn in_frame(&self, to_from_here: &Pose) -> Self {
        let moved = |t: &Thing| Thing {
            form: t.form.in_frame(to_from_here),
            ..t.clone()
        };
        self.things.values().map(moved).collect()
    }

    /// Its things that reach into a map.
    pub fn in_extent(&self, extent: Extent) -> Vec<Thing> {
        in_extent(extent, self.iter())
    }

    /// The first problem with it, in one line; `None` if it is sound.
    pub fn problem(&self) -> Option<String> {
        if self.len() > Self::MAX_THINGS {
            return Some(format!(
                "the background holds {} things, expected at most {}",
                self.len(),
                Self::MAX_THINGS
            ));
        }
        self.things
            .values()
            .find_map(|t| t.form.problem().map(|p| format!("thing {}: {p}", t.id.0)))
    }
}

/// The things that reach into a map.
pub fn in_extent<'a>(extent: Extent, things: impl IntoIterator<Item = &'a Thing>) -> Vec<Thing> {
    let (from, to) = (extent.min_m().truncate(), extent.max_m().truncate());
    let reaches_in = |t: &&Thing| {
        let (lo, hi) = t.form.bounds_m();
        lo.cmplt(to).all() && hi.cmpgt(from).all()
    };
    things.into_iter().filter(reaches_in).cloned().collect()
}

impl FromIterator<Thing> for Background {
    fn from_iter<T: IntoIterator<Item = Thing>>(things: T) -> Self {
        let things = things.into_iter().map(|t| (t.id, t)).collect();
        Self {
            things,
            next_at_least: 0,
        }
    }
}

#[cfg(test)]
mod tests;
