//! Small upright things: poles, signs, lamps, bus stops, benches, bins, stairs.

use glam::{DVec2, DVec3};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::{GroundM, PartRole, ThingPart};
use crate::Class;
use crate::draw::{Draw, hash};
use crate::solid::Solid;

/// Kind of a small upright thing.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, schemars::JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum PostKind {
    /// A bare pole.
    Pole,
    /// A lamp with an arm over the road, along its heading.
    StreetLight,
    /// A traffic sign that faces along its heading.
    Sign,
    /// Traffic lights on a mast.
    TrafficLight,
    /// A shelter with a roof, open along its heading.
    BusStop,
    /// A bench.
    Bench,
    /// A bin, box or bag: what nuScenes calls "others".
    Bin,
    /// A short post that keeps cars out.
    Bollard,
    /// Stairs that climb along the heading.
    Stairs,
}

impl PostKind {
    /// All kinds.
    pub const ALL: [Self; 9] = [
        Self::Pole,
        Self::StreetLight,
        Self::Sign,
        Self::TrafficLight,
        Self::BusStop,
        Self::Bench,
        Self::Bin,
        Self::Bollard,
        Self::Stairs,
    ];

    /// Its name in words.
    pub fn name(self) -> &'static str {
        match self {
            Self::Pole => "pole",
            Self::StreetLight => "street light",
            Self::Sign => "sign",
            Self::TrafficLight => "traffic light",
            Self::BusStop => "bus stop",
            Self::Bench => "bench",
            Self::Bin => "bin",
            Self::Bollard => "bollard",
            Self::Stairs => "stairs",
        }
    }

    /// Class of its voxels.
    pub fn class(self) -> Class {
        match self {
            Self::Bin => Class::Others,
            _ => Class::Manmade,
        }
    }

    /// Usual height, m.
    pub fn typical_height_m(self) -> f64 {
        match self {
            Self::Pole => 6.0,
            Self::StreetLight => 6.5,
            Self::Sign => 2.6,
            Self::TrafficLight => 3.6,
            Self::BusStop => 2.6,
            Self::Bench => 0.8,
            Self::Bin => 0.9,
            Self::Bollard => 0.9,
            Self::Stairs => 1.2,
        }
    }

    /// How far it reaches from its place, m.
    pub(super) fn reach_m(self) -> f64 {
        match self {
            Self::StreetLight => 2.0,
            Self::BusStop => 2.4,
            Self::Stairs => 2.6,
            Self::Bench => 1.1,
            Self::Sign | Self::TrafficLight | Self::Bin => 0.6,
            Self::Pole | Self::Bollard => 0.2,
        }
    }
}

/// A small upright thing.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Post {
    /// Kind.
    pub kind: PostKind,
    /// Its place on the ground, world frame, m.
    #[schemars(with = "[f64; 2]")]
    pub position_m: DVec2,
    /// Heading, rad counter-clockwise from world x.
    #[serde(default)]
    pub yaw_rad: f64,
    /// Height above the ground, m.
    pub height_m: f64,
}

impl Post {
    /// A thing of the usual height of its kind.
    pub fn typical(kind: PostKind, position_m: DVec2, yaw_rad: f64) -> Self {
        Self {
            kind,
            position_m,
            yaw_rad,
            height_m: kind.typical_height_m(),
        }
    }

    pub(super) fn parts(&self, look: u64, ground_m: GroundM<'_>, out: &mut Vec<ThingPart>) {
        let mut draw = Draw::new(hash(look), "post");
        let (p, class) = (self.position_m, self.kind.class());
        let ahead = DVec2::from_angle(self.yaw_rad.rem_euclid(std::f64::consts::TAU));
        let z = ground_m(p);
        let base = p.extend(z - 0.1);
        let height = self.height_m + 0.1;
        let role = match self.kind {
            PostKind::Bollard => PartRole::Bollard,
            _ => PartRole::Pole,
        };
        let mut pole = |radius: f64| {
            out.push(ThingPart::new(
                role,
                Solid::frustum(class, base, height, radius, radius * 0.75),
            ))
        };
        match self.kind {
            PostKind::Pole => pole(0.12),
            PostKind::Bollard => pole(0.1),
            PostKind::StreetLight => {
                pole(0.12);
                let arm = DVec3::new(1.8, 0.2, 0.2);
                let middle = (p + ahead * 0.85).extend(z + self.height_m - 0.2);
                out.push(ThingPart::new(
                    PartRole::LampArm,
                    Solid::block(class, middle, arm, ahead),
                ));
            }
            PostKind::Sign => {
                pole(0.05);
                let side = draw.range(0.6, 0.8);
                let plate = DVec3::new(0.1, side, side);
                let at = (p + ahead * 0.08).extend(z + (self.height_m - side).max(0.0));
                out.push(ThingPart::new(
                    PartRole::SignPlate,
                    Solid::block(class, at, plate, ahead),
                ));
            }
            PostKind::TrafficLight => {
                pole(0.08);
                let head = DVec3::new(0.35, 0.35, 1.0);
                let at = (p + ahead * 0.15).extend(z + (self.height_m - 1.0).max(0.0));
                out.push(ThingPart::new(
                    PartRole::SignalHead,
                    Solid::block(class, at, head, ahead),
                ));
            }
            PostKind::BusStop => {
                let back = DVec3::new(0.15, 3.6, self.height_m);
                out.push(ThingPart::new(
                    PartRole::ShelterWall,
                    Solid::block(class, (p - ahead * 0.8).extend(z), back, ahead),
                ));
                for side in [-1.7, 1.7] {
                    let at = (p + ahead.perp() * side).extend(z);
                    out.push(ThingPart::new(
                        PartRole::ShelterWall,
                        Solid::block(class, at, DVec3::new(1.4, 0.12, self.height_m), ahead),
                    ));
                }
                let roof = DVec3::new(1.9, 3.8, 0.15);
                out.push(ThingPart::new(
                    PartRole::ShelterRoof,
                    Solid::block(class, p.extend(z + self.height_m - 0.15), roof, ahead),
                ));
                let seat = DVec3::new(0.4, 2.4, 0.5);
                out.push(ThingPart::new(
                    PartRole::Seat,
                    Solid::block(class, (p - ahead * 0.5).extend(z), seat, ahead),
                ));
            }
            PostKind::Bench => {
                let seat = DVec3::new(0.5, 1.8, self.height_m * 0.55);
                out.push(ThingPart::new(
                    PartRole::Seat,
                    Solid::block(class, p.extend(z), seat, ahead),
                ));
                let back = DVec3::new(0.1, 1.8, self.height_m);
                out.push(ThingPart::new(
                    PartRole::Seat,
                    Solid::block(class, (p - ahead * 0.22).extend(z), back, ahead),
                ));
            }
            PostKind::Bin => {
                let radius = draw.range(0.3, 0.5);
                out.push(ThingPart::new(
                    PartRole::Bin,
                    Solid::frustum(class, base, height, radius, radius),
                ));
            }
            PostKind::Stairs => {
                // Steps of a fifth of the height, one behind another.
                for step in 0..5 {
                    let rise = (f64::from(step) + 1.0) / 5.0 * self.height_m;
                    let at = (p + ahead * (f64::from(step) * 0.8 - 1.6)).extend(z - 0.1);
                    out.push(ThingPart::new(
                        PartRole::Step,
                        Solid::block(class, at, DVec3::new(0.8, 2.4, rise + 0.1), ahead),
                    ));
                }
            }
        }
    }
}
