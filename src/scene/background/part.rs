//! Parts of things: solids, each with its role in the thing. The role decides what it is made of in pictures.

use crate::solid::Solid;

/// Role of a solid in its thing.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum PartRole {
    /// Walls of a building; their rows of windows begin at the ground.
    Walls,
    /// Walls over an arcade: rows of windows begin above the ground floor.
    UpperWalls,
    /// A pitched roof.
    PitchedRoof,
    /// A lift head or cooling unit on a flat roof.
    RoofUnit,
    /// A column of an arcade.
    Column,
    /// Floor of a balcony.
    BalconyFloor,
    /// Front of a balcony.
    BalconyRail,
    /// A bay over the whole height of a facade.
    Bay,
    /// Trunk of a tree.
    Trunk,
    /// Leaves, or boughs without leaves.
    Crown,
    /// A piece of a hedge.
    Hedge,
    /// A bush or stem of an area of shrubs.
    Bush,
    /// A piece of a wall of masonry.
    Masonry,
    /// A post of a fence or guard rail.
    LinePost,
    /// Boards, mesh or bars between the posts of a fence.
    FencePanel,
    /// The beam of a guard rail.
    RailBeam,
    /// An upright pole.
    Pole,
    /// The arm of a street light, with the lamp at its end.
    LampArm,
    /// The plate of a traffic sign; it faces along the heading.
    SignPlate,
    /// The head of traffic lights; it faces along the heading.
    SignalHead,
    /// Back or side of a bus stop.
    ShelterWall,
    /// Roof of a bus stop.
    ShelterRoof,
    /// A seat, or the back of one.
    Seat,
    /// A bin, box or bag.
    Bin,
    /// A bollard.
    Bollard,
    /// A step of stairs.
    Step,
    /// Surface of a bridge.
    Deck,
    /// Body, pier or railing of a bridge.
    BridgeBody,
}

/// A solid of a thing and its role.
#[derive(Clone, Debug)]
pub struct ThingPart {
    /// Geometry and class.
    pub solid: Solid,
    /// Role.
    pub role: PartRole,
}

impl ThingPart {
    pub(super) fn new(role: PartRole, solid: Solid) -> Self {
        Self { solid, role }
    }
}
