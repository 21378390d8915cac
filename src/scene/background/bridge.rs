//! Bridges: a deck carried over the ground on piers, with railings.

use glam::{DVec2, DVec3};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::{GroundM, PartRole, ThingPart};
use crate::Class;
use crate::solid::Solid;

const PIECE_M: f64 = 3.0;
const MAX_PIECES: usize = 10_000;
/// Piers stand this far apart, m.
const PIER_STEP_M: f64 = 14.0;

/// A bridge. What is below stays as it is.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Bridge {
    /// Middle of the deck, world frame, m; at least two vertices.
    #[schemars(with = "Vec<[f64; 2]>")]
    pub points_m: Vec<DVec2>,
    /// Width of the deck, m.
    pub width_m: f64,
    /// Top of the deck above the ground at the middle of the line, m. The deck is level.
    pub height_m: f64,
    /// Thickness of the deck, m.
    pub thickness_m: f64,
    /// True if vehicles drive on it: its surface is road, else sidewalk.
    #[serde(default)]
    pub for_vehicles: bool,
}

impl Bridge {
    pub(super) fn parts(&self, ground_m: GroundM<'_>, out: &mut Vec<ThingPart>) {
        let deck = match self.for_vehicles {
            true => Class::DriveableSurface,
            false => Class::Sidewalk,
        };
        let middle = self.points_m[self.points_m.len() / 2];
        let top = ground_m(middle) + self.height_m;
        let mut to_pier = PIER_STEP_M / 2.0;
        let mut pieces = 0;
        for pair in self.points_m.windows(2) {
            let (length, along) = (
                pair[0].distance(pair[1]),
                (pair[1] - pair[0]).normalize_or(DVec2::X),
            );
            let count = (length / PIECE_M).ceil().max(1.0);
            for i in 0..count as usize {
                pieces += 1;
                if pieces > MAX_PIECES {
                    return;
                }
                let p = pair[0].lerp(pair[1], (i as f64 + 0.5) / count);
                let step = length / count;
                let body = DVec3::new(step + 0.05, self.width_m, self.thickness_m - 0.2);
                let under = top - self.thickness_m;
                out.push(ThingPart::new(
                    PartRole::BridgeBody,
                    Solid::block(Class::Manmade, p.extend(under), body, along),
                ));
                let surface = DVec3::new(step + 0.05, self.width_m, 0.2);
                out.push(ThingPart::new(
                    PartRole::Deck,
                    Solid::block(deck, p.extend(top - 0.2), surface, along),
                ));
                for side in [-0.5, 0.5] {
                    let at = p + along.perp() * (side * self.width_m);
                    let rail = DVec3::new(step + 0.05, 0.2, 1.0);
                    out.push(ThingPart::new(
                        PartRole::BridgeBody,
                        Solid::block(Class::Manmade, at.extend(top), rail, along),
                    ));
                }
                to_pier -= step;
                let low = ground_m(p) - 0.3;
                if to_pier <= 0.0 && under - low > 1.0 {
                    to_pier = PIER_STEP_M;
                    let pier = DVec3::new(0.9, self.width_m * 0.6, under - low);
                    out.push(ThingPart::new(
                        PartRole::BridgeBody,
                        Solid::block(Class::Manmade, p.extend(low), pier, along),
                    ));
                }
            }
        }
    }
}
