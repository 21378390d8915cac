//! Things that run along a line: hedges, walls, fences, guard rails.

use glam::{DVec2, DVec3};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::{GroundM, PartRole, ThingPart};
use crate::Class;
use crate::draw::{Draw, hash};
use crate::solid::Solid;

/// Pieces follow the ground in steps of this length, m.
const PIECE_M: f64 = 2.0;
/// Pieces of one line never exceed this number.
const MAX_PIECES: usize = 20_000;

/// Kind of a thing that runs along a line.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, schemars::JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum LineKind {
    /// Clipped shrubs.
    Hedge,
    /// Masonry.
    Wall,
    /// Posts with rails or mesh between them.
    Fence,
    /// A steel rail beside a road.
    GuardRail,
    /// Holds back higher ground.
    RetainingWall,
}

impl LineKind {
    /// All kinds.
    pub const ALL: [Self; 5] = [
        Self::Hedge,
        Self::Wall,
        Self::Fence,
        Self::GuardRail,
        Self::RetainingWall,
    ];

    /// Its name in words.
    pub fn name(self) -> &'static str {
        match self {
            Self::Hedge => "hedge",
            Self::Wall => "wall",
            Self::Fence => "fence",
            Self::GuardRail => "guard rail",
            Self::RetainingWall => "retaining wall",
        }
    }

    /// Class of its voxels.
    pub fn class(self) -> Class {
        match self {
            Self::Hedge => Class::Vegetation,
            _ => Class::Manmade,
        }
    }

    /// Usual height and width, m.
    pub fn typical_m(self) -> (f64, f64) {
        match self {
            Self::Hedge => (1.3, 0.9),
            Self::Wall => (1.6, 0.3),
            Self::Fence => (1.4, 0.12),
            Self::GuardRail => (0.8, 0.3),
            Self::RetainingWall => (2.0, 0.4),
        }
    }
}

/// A thing along a line.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct SceneryLine {
    /// Kind.
    pub kind: LineKind,
    /// Vertices on the ground, world frame, m; at least two.
    #[schemars(with = "Vec<[f64; 2]>")]
    pub points_m: Vec<DVec2>,
    /// Height above the ground, m.
    pub height_m: f64,
    /// Width, m.
    pub width_m: f64,
}

impl SceneryLine {
    /// A line of the usual height and width of its kind.
    pub fn typical(kind: LineKind, points_m: Vec<DVec2>) -> Self {
        let (height_m, width_m) = kind.typical_m();
        Self {
            kind,
            points_m,
            height_m,
            width_m,
        }
    }

    pub(super) fn parts(&self, look: u64, ground_m: GroundM<'_>, out: &mut Vec<ThingPart>) {
        let mut draw = Draw::new(hash(look), "line");
        let (class, mut pieces) = (self.kind.class(), 0);
        for pair in self.points_m.windows(2) {
            let length = pair[0].distance(pair[1]);
            let along = (pair[1] - pair[0]).normalize_or(DVec2::X);
            let count = (length / PIECE_M).ceil().max(1.0);
            for i in 0..count as usize {
                pieces += 1;
                if pieces > MAX_PIECES {
                    return;
                }
                let (a, b) = (
                    pair[0].lerp(pair[1], i as f64 / count),
                    pair[0].lerp(pair[1], (i as f64 + 1.0) / count),
                );
                let middle = (a + b) / 2.0;
                let low = ground_m(a).min(ground_m(b)).min(ground_m(middle)) - 0.1;
                let top = ground_m(middle) + self.height_m;
                let size = DVec3::new(a.distance(b), self.width_m, top - low);
                match self.kind {
                    LineKind::Hedge => {
                        let mut piece = Solid::tapered(
                            class,
                            middle.extend(low),
                            DVec3::new(size.x + 0.1, size.y, size.z * draw.range(0.93, 1.0)),
                            DVec2::new(1.0, draw.range(0.75, 0.95)),
                            along,
                        );
                        piece.porosity = 0.15;
                        out.push(ThingPart::new(PartRole::Hedge, piece));
                    }
                    LineKind::Wall | LineKind::RetainingWall => {
                        out.push(ThingPart::new(
                            PartRole::Masonry,
                            Solid::block(class, middle.extend(low), size, along),
                        ));
                    }
                    LineKind::Fence => {
                        out.push(ThingPart::new(
                            PartRole::LinePost,
                            Solid::frustum(class, a.extend(low), size.z, 0.06, 0.06),
                        ));
                        // Mesh or boards: half of what meets it goes through.
                        let mut mesh = Solid::block(class, middle.extend(low), size, along);
                        mesh.porosity = 0.5;
                        out.push(ThingPart::new(PartRole::FencePanel, mesh));
                    }
                    LineKind::GuardRail => {
                        out.push(ThingPart::new(
                            PartRole::LinePost,
                            Solid::frustum(class, a.extend(low), size.z, 0.07, 0.07),
                        ));
                        let rail = DVec3::new(size.x, size.y, 0.32);
                        out.push(ThingPart::new(
                            PartRole::RailBeam,
                            Solid::block(class, middle.extend(top - 0.32), rail, along),
                        ));
                    }
                }
            }
        }
    }
}
