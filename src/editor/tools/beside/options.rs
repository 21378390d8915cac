//! State that the scenery tools share between two frames: options, selection, clipboard.

use std::collections::BTreeSet;

use glam::DVec2;

use scene::background::{Facade, LineKind, PostKind, Roof, SceneryLine, TreeKind};
use scene::{Background, Form, ThingId};

/// A tool together with the kind that it puts down.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ThingKind {
    /// A tree.
    Tree(TreeKind),
    /// Along a line.
    Line(LineKind),
    /// A small upright one.
    Post(PostKind),
}

/// Options, selection and clipboard of the scenery tools.
#[derive(Clone, Debug)]
pub struct ThingState {
    /// The chosen things.
    pub chosen: BTreeSet<ThingId>,
    /// Outlines of the things are drawn, and the things can be chosen.
    pub shown: bool,
    /// Things can neither be chosen nor changed.
    pub locked: bool,
    /// Things that are moved snap to the kerb.
    pub snap_kerb: bool,
    /// Storeys of the next building.
    pub storeys: u32,
    /// Roof of the next building.
    pub roof: Roof,
    /// Facade of the next building.
    pub facade: Facade,
    /// Kind of the next tree.
    pub tree: TreeKind,
    /// Height of the next tree, m; scattered ones vary about it.
    pub tree_m: f64,
    /// Distance between scattered trees, m.
    pub spacing_m: f64,
    /// Kind of the next line.
    pub line: LineKind,
    /// Its height, m.
    pub line_m: f64,
    /// Height of the next shrubs, m.
    pub shrubs_m: f64,
    /// Kind of the next post.
    pub post: PostKind,
    /// Copied forms, world frame.
    pub clipboard: Vec<Form>,
    /// Kinds whose things are listed one by one.
    pub unfolded: BTreeSet<&'static str>,
}

impl Default for ThingState {
    fn default() -> Self {
        Self {
            chosen: BTreeSet::new(),
            shown: true,
            locked: false,
            snap_kerb: false,
            storeys: 4,
            roof: Roof::Flat,
            facade: Facade::Plain,
            tree: TreeKind::Broadleaf,
            tree_m: 7.0,
            spacing_m: 6.0,
            line: LineKind::Hedge,
            line_m: LineKind::Hedge.typical_m().0,
            shrubs_m: 1.2,
            post: PostKind::StreetLight,
            clipboard: Vec::new(),
            unfolded: BTreeSet::new(),
        }
    }
}

impl ThingState {
    /// True if things can be chosen and changed.
    pub fn is_open(&self) -> bool {
        self.shown && !self.locked
    }

    /// Radius of the crown of a tree of that kind and height, m.
    pub fn crown_m(kind: TreeKind, height_m: f64) -> f64 {
        let share = match kind {
            TreeKind::Broadleaf | TreeKind::Bare => 0.32,
            TreeKind::Conifer => 0.24,
            TreeKind::Columnar => 0.14,
        };
        (height_m * share).clamp(0.4, 8.0)
    }

    /// A line as the options say; its width is the usual one.
    pub fn line_of(&self, points_m: Vec<DVec2>) -> SceneryLine {
        SceneryLine {
            height_m: self.line_m,
            ..SceneryLine::typical(self.line, points_m)
        }
    }

    /// Takes another kind of line, with its usual height.
    pub fn take_line(&mut self, kind: LineKind) {
        (self.line, self.line_m) = (kind, kind.typical_m().0);
    }

    /// Chosen things that are there, by id.
    pub fn chosen_in<'a>(&'a self, all: &'a Background) -> impl Iterator<Item = &'a scene::Thing> {
        self.chosen.iter().filter_map(|id| all.get(*id))
    }
}
