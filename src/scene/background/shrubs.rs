//! Areas of shrubs and undergrowth: slim stems and low bushes spread over an outline.

use glam::{DVec2, DVec3};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::{GroundM, PartRole, ThingPart};
use crate::Class;
use crate::draw::{Draw, hash};
use crate::road_map::inside;
use crate::solid::Solid;

/// Plants in one area never exceed this number.
const MAX_PLANTS: f64 = 4000.0;

/// An area of shrubs.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Shrubs {
    /// Corners on the ground, world frame, m; closed without repeating the first, edges do not cross.
    #[schemars(with = "Vec<[f64; 2]>")]
    pub outline_m: Vec<DVec2>,
    /// Height of the tallest above the ground, m.
    pub height_m: f64,
    /// Plants per square metre, 0 to 2.
    pub per_m2: f64,
}

impl Shrubs {
    pub(super) fn parts(&self, look: u64, ground_m: GroundM<'_>, out: &mut Vec<ThingPart>) {
        let mut draw = Draw::new(hash(look), "shrubs");
        let min = self.outline_m.iter().copied().fold(DVec2::INFINITY, DVec2::min);
        let max = self
            .outline_m
            .iter()
            .copied()
            .fold(DVec2::NEG_INFINITY, DVec2::max);
        let size = max - min;
        let tries = (size.x * size.y * self.per_m2).min(MAX_PLANTS) as usize;
        for _ in 0..tries {
            let p = min + DVec2::new(draw.unit(), draw.unit()) * size;
            // Every plant takes the same number of draws, so that a corner moved changes only what it uncovers.
            let (is_bush, tall, wide) = (draw.chance(0.2), draw.range(0.35, 1.0), draw.unit());
            if !inside(&self.outline_m, p) {
                continue;
            }
            let base = p.extend(ground_m(p) - 0.05);
            let height = self.height_m * tall;
            out.push(ThingPart::new(
                PartRole::Bush,
                match is_bush {
                    true => {
                        let radius = 0.35 + 0.55 * wide;
                        let radii = DVec3::new(radius, radius, height);
                        Solid::ellipsoid(Class::Vegetation, base, radii, 0.3)
                    }
                    false => {
                        let radius = 0.12 + 0.16 * wide;
                        Solid::frustum(Class::Vegetation, base, height, radius, radius * 0.7)
                    }
                },
            ));
        }
    }
}
