//! Trees: a trunk and a crown that rays pass through in part.

use glam::{DVec2, DVec3};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::{GroundM, PartRole, ThingPart};
use crate::Class;
use crate::draw::{Draw, hash};
use crate::solid::Solid;

/// Kind of tree.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, schemars::JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum TreeKind {
    /// A round crown of boughs.
    #[default]
    Broadleaf,
    /// A cone from near the ground.
    Conifer,
    /// A slim upright crown.
    Columnar,
    /// Without leaves.
    Bare,
}

impl TreeKind {
    /// All kinds.
    pub const ALL: [Self; 4] = [Self::Broadleaf, Self::Conifer, Self::Columnar, Self::Bare];
}

/// A tree.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Tree {
    /// Middle of the trunk on the ground, world frame, m.
    #[schemars(with = "[f64; 2]")]
    pub position_m: DVec2,
    /// Top of the crown above the ground, m.
    pub height_m: f64,
    /// Radius of the crown, m.
    pub crown_radius_m: f64,
    /// Kind.
    #[serde(default)]
    pub kind: TreeKind,
}

impl Tree {
    pub(super) fn parts(&self, look: u64, ground_m: GroundM<'_>, out: &mut Vec<ThingPart>) {
        let mut draw = Draw::new(hash(look), "tree");
        let base = self.position_m.extend(ground_m(self.position_m) - 0.1);
        let (height, crown) = (self.height_m + 0.1, self.crown_radius_m);
        let trunk_radius = (0.05 + 0.022 * height) * draw.range(0.8, 1.3);
        let mut trunk = |top: f64| {
            out.push(ThingPart::new(
                PartRole::Trunk,
                Solid::frustum(Class::Vegetation, base, top, trunk_radius, trunk_radius * 0.6),
            ));
        };
        match self.kind {
            TreeKind::Conifer => {
                trunk(height * 0.3);
                let skirt = (height * draw.range(0.06, 0.15)).min(1.6);
                let mut cone = Solid::frustum(
                    Class::Vegetation,
                    base + DVec3::Z * skirt,
                    height - skirt,
                    crown,
                    0.1,
                );
                cone.porosity = 0.35;
                out.push(ThingPart::new(PartRole::Crown, cone));
            }
            TreeKind::Columnar => {
                trunk(height * 0.4);
                let clear = (height * 0.12).min(1.0);
                let half = (height - clear) / 2.0;
                let middle = base + DVec3::Z * (clear + half);
                let radii = DVec3::new(crown, crown, half);
                out.push(ThingPart::new(
                    PartRole::Crown,
                    Solid::ellipsoid(Class::Vegetation, middle, radii, 0.3),
                ));
            }
            TreeKind::Bare => {
                // Branches that spread upward from the trunk.
                let fork = height * draw.range(0.25, 0.4);
                trunk(height);
                let mut branches = Solid::frustum(
                    Class::Vegetation,
                    base + DVec3::Z * fork,
                    height - fork,
                    0.25,
                    crown,
                );
                branches.porosity = 0.6;
                out.push(ThingPart::new(PartRole::Crown, branches));
            }
            TreeKind::Broadleaf => {
                // Boughs with gaps between them rather than one ball, all of them on the trunk.
                let deep = (2.0 * crown).min(height * 0.75);
                let fork = height - deep;
                trunk(fork + deep * 0.6);
                let porosity = draw.range(0.3, 0.45);
                let boughs = 8 + draw.below(6);
                let middle = base + DVec3::Z * (fork + deep / 2.0);
                let core = DVec3::new(crown * 0.5, crown * 0.5, deep * 0.46);
                out.push(ThingPart::new(
                    PartRole::Crown,
                    Solid::ellipsoid(Class::Vegetation, middle, core, porosity),
                ));
                for i in 0..boughs {
                    let angle = (i as f64 + draw.unit()) / boughs as f64 * std::f64::consts::TAU;
                    let size = draw.range(0.26, 0.42);
                    let away = crown * (0.95 - size);
                    let up = draw.range(-0.5, 0.6) * deep / 2.0 * (1.0 - size);
                    let center = middle + (DVec2::from_angle(angle) * away).extend(up);
                    let radii = DVec3::new(
                        crown * size,
                        crown * size,
                        deep / 2.0 * size * draw.range(0.8, 1.1),
                    );
                    out.push(ThingPart::new(
                        PartRole::Crown,
                        Solid::ellipsoid(Class::Vegetation, center, radii, porosity),
                    ));
                }
            }
        }
    }
}
