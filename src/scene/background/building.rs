//! Buildings: an outline extruded to a height, with a roof and attachments on the facades.

use glam::{DVec2, DVec3};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::{GroundM, PartRole, ThingPart};
use crate::Class;
use crate::draw::{Draw, hash};
use crate::solid::Solid;

/// Height of a storey, m.
pub const STOREY_M: f64 = 3.0;
/// Foundations reach this far below the lowest ground at the outline, m.
const FOUNDATION_M: f64 = 0.4;
/// Largest distance by which attachments of a facade stand out, m.
const OVERHANG_M: f64 = 1.4;

/// Shape of a roof.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Roof {
    /// Level.
    #[default]
    Flat,
    /// A ridge along the longer side; only of four-cornered outlines.
    Gabled,
    /// Slopes on all sides; only of four-cornered outlines.
    Hipped,
}

/// Look of a facade.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Facade {
    /// A plain wall with windows.
    #[default]
    Plain,
    /// Balconies on the upper storeys.
    Balconies,
    /// Bays that stand out over the whole height.
    Bays,
    /// A ground floor that stands back behind columns.
    Arcade,
    /// Mostly glass.
    Glass,
}

/// A building.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Building {
    /// Corners on the ground, world frame, m; closed without repeating the first, edges do not cross.
    #[schemars(with = "Vec<[f64; 2]>")]
    pub outline_m: Vec<DVec2>,
    /// Height of the walls above the ground at its middle, m.
    pub height_m: f64,
    /// Roof.
    #[serde(default)]
    pub roof: Roof,
    /// Facade.
    #[serde(default)]
    pub facade: Facade,
}

impl Building {
    /// A rectangle: middle, half length along the unit vector `along`, half depth, wall height, m.
    pub fn rectangle(middle_m: DVec2, half_m: DVec2, along: DVec2, height_m: f64) -> Self {
        let corner = |u: f64, v: f64| middle_m + along * (u * half_m.x) + along.perp() * (v * half_m.y);
        Self {
            outline_m: vec![
                corner(-1.0, -1.0),
                corner(1.0, -1.0),
                corner(1.0, 1.0),
                corner(-1.0, 1.0),
            ],
            height_m,
            roof: Roof::Flat,
            facade: Facade::Plain,
        }
    }

    /// Number of storeys that the height makes, at least 1.
    pub fn storeys(&self) -> u32 {
        (self.height_m / STOREY_M).round().max(1.0) as u32
    }

    /// How far anything stands out beyond the outline, m.
    pub(super) fn overhang_m(&self) -> f64 {
        match self.facade {
            Facade::Balconies | Facade::Bays => OVERHANG_M,
            _ if self.roof != Roof::Flat => 0.35,
            _ => 0.0,
        }
    }

    pub(super) fn parts(&self, look: u64, ground_m: GroundM<'_>, out: &mut Vec<ThingPart>) {
        let outline = counter_clockwise(&self.outline_m);
        let n = outline.len();
        let middle = outline.iter().sum::<DVec2>() / n as f64;
        let lowest = outline
            .iter()
            .map(|p| ground_m(*p))
            .fold(ground_m(middle), f64::min);
        let floor = ground_m(middle);
        let (bottom, eaves) = (lowest - FOUNDATION_M, floor + self.height_m);
        let mut draw = Draw::new(hash(look), "building");
        let arcade = self.facade == Facade::Arcade && n == 4 && self.height_m > 1.6 * STOREY_M;
        if arcade {
            let inner: Vec<DVec2> = outline.iter().map(|p| middle + inset(*p - middle, 1.6)).collect();
            out.push(ThingPart::new(
                PartRole::Walls,
                Solid::prism(Class::Manmade, &inner, bottom, floor + STOREY_M),
            ));
            out.push(ThingPart::new(
                PartRole::UpperWalls,
                Solid::prism(Class::Manmade, &outline, floor + STOREY_M, eaves),
            ));
            for (a, b) in edges(&outline) {
                let count = (a.distance(b) / 4.0).floor().max(1.0);
                for i in 0..count as usize {
                    let p = middle + inset(a.lerp(b, i as f64 / count) - middle, 0.3);
                    let height = floor + STOREY_M - bottom;
                    out.push(ThingPart::new(
                        PartRole::Column,
                        Solid::frustum(Class::Manmade, p.extend(bottom), height, 0.22, 0.22),
                    ));
                }
            }
        } else {
            out.push(ThingPart::new(
                PartRole::Walls,
                Solid::prism(Class::Manmade, &outline, bottom, eaves),
            ));
        }
        self.roof_solids(&outline, eaves, &mut draw, out);
        for (a, b) in edges(&outline) {
            self.facade_solids(a, b, floor, &mut draw, out);
        }
    }

    fn roof_solids(&self, outline: &[DVec2], eaves: f64, draw: &mut Draw, out: &mut Vec<ThingPart>) {
        let middle = outline.iter().sum::<DVec2>() / outline.len() as f64;
        if self.roof == Roof::Flat || outline.len() != 4 {
            // A lift head or a cooling unit.
            let size = DVec3::new(draw.range(1.5, 3.5), draw.range(1.5, 2.5), draw.range(0.8, 2.2));
            let along = (outline[1] - outline[0]).normalize_or(DVec2::X);
            let shortest = edges(outline)
                .map(|(a, b)| a.distance(b))
                .fold(f64::INFINITY, f64::min);
            if shortest > 5.0 {
                out.push(ThingPart::new(
                    PartRole::RoofUnit,
                    Solid::block(Class::Manmade, middle.extend(eaves), size, along),
                ));
            }
            return;
        }
        let (a, b) = (outline[1] - outline[0], outline[2] - outline[1]);
        let (along, length, depth) = match a.length() >= b.length() {
            true => (a.normalize_or(DVec2::X), a.length(), b.length()),
            false => (b.normalize_or(DVec2::X), b.length(), a.length()),
        };
        let size = DVec3::new(length + 0.6, depth + 0.6, depth * draw.range(0.22, 0.4));
        let ridge = if self.roof == Roof::Gabled { 0.98 } else { 0.55 };
        let taper = DVec2::new(ridge, 0.04);
        out.push(ThingPart::new(
            PartRole::PitchedRoof,
            Solid::tapered(Class::Manmade, middle.extend(eaves), size, taper, along),
        ));
    }

    /// Appends the attachments of the wall from `a` to `b`; the outside is on its right.
    fn facade_solids(&self, a: DVec2, b: DVec2, floor: f64, draw: &mut Draw, out: &mut Vec<ThingPart>) {
        let (along, length) = ((b - a).normalize_or(DVec2::X), a.distance(b));
        let outward = -along.perp();
        let pitch = draw.range(3.2, 5.0);
        let width = pitch * draw.range(0.45, 0.7);
        let stands_out = draw.range(0.7, OVERHANG_M);
        let count = ((length - 1.0) / pitch).floor();
        if count < 1.0 {
            return;
        }
        let place = |i: usize| {
            let at = (i as f64 + 0.5 - count / 2.0) * pitch + length / 2.0;
            a + along * at + outward * (stands_out / 2.0)
        };
        match self.facade {
            Facade::Balconies => {
                for i in 0..count as usize {
                    for storey in 1..self.storeys() {
                        let z = floor + f64::from(storey) * STOREY_M;
                        let p = place(i);
                        let slab = DVec3::new(width, stands_out, 0.2);
                        out.push(ThingPart::new(
                            PartRole::BalconyFloor,
                            Solid::block(Class::Manmade, p.extend(z - 0.2), slab, along),
                        ));
                        let front = p + outward * (stands_out / 2.0 - 0.06);
                        let rail = DVec3::new(width, 0.12, 1.1);
                        out.push(ThingPart::new(
                            PartRole::BalconyRail,
                            Solid::block(Class::Manmade, front.extend(z), rail, along),
                        ));
                    }
                }
            }
            Facade::Bays => {
                for i in (0..count as usize).step_by(2) {
                    let size = DVec3::new(width, stands_out, self.height_m - 0.4);
                    out.push(ThingPart::new(
                        PartRole::Bay,
                        Solid::block(Class::Manmade, place(i).extend(floor), size, along),
                    ));
                }
            }
            _ => {}
        }
    }
}

/// A vector shortened by `by` metres, not below half its length.
fn inset(v: DVec2, by: f64) -> DVec2 {
    let length = v.length();
    v.normalize_or(DVec2::ZERO) * (length - by * std::f64::consts::SQRT_2).max(length / 2.0)
}

fn edges(outline: &[DVec2]) -> impl Iterator<Item = (DVec2, DVec2)> + '_ {
    (0..outline.len()).map(|i| (outline[i], outline[(i + 1) % outline.len()]))
}

/// The outline with its inside on the left of every edge.
pub(super) fn counter_clockwise(outline_m: &[DVec2]) -> Vec<DVec2> {
    let mut out = outline_m.to_vec();
    if super::problem::signed_area_m2(outline_m) < 0.0 {
        out.reverse();
    }
    out
}
