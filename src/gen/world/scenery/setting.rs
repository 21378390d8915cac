//! The kind of place on either side of the ego's road.

use serde::{Deserialize, Serialize};

use scene::draw::Draw;
use scene::{BevLayer, BevLayout, PolylineKind};

/// A kind of place.
#[derive(
    Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, clap::ValueEnum, schemars::JsonSchema,
)]
#[serde(rename_all = "kebab-case")]
pub enum RoadsideKind {
    /// Old houses wall to wall.
    OldTown,
    /// Blocks of flats and offices, with balconies and shops.
    City,
    /// Houses with gardens, hedges and fences.
    Suburb,
    /// Halls, yards and fences.
    Industry,
    /// A dense wood.
    Forest,
    /// Fields, hedgerows, a farm now and then.
    Country,
    /// A road with guard rails and banks, nothing near it.
    Motorway,
    /// Lawns, trees and benches.
    Park,
    /// Large shops around car parks.
    Retail,
}

impl RoadsideKind {
    /// All settings.
    pub const ALL: [Self; 9] = [
        Self::OldTown,
        Self::City,
        Self::Suburb,
        Self::Industry,
        Self::Forest,
        Self::Country,
        Self::Motorway,
        Self::Park,
        Self::Retail,
    ];
}

impl RoadsideKind {
    /// Name to show: `Old town`.
    pub fn label(self) -> &'static str {
        match self {
            Self::OldTown => "Old town",
            Self::City => "City",
            Self::Suburb => "Suburb",
            Self::Industry => "Industry",
            Self::Forest => "Forest",
            Self::Country => "Country",
            Self::Motorway => "Motorway",
            Self::Park => "Park",
            Self::Retail => "Retail",
        }
    }
}

/// One side of the ego's road.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RoadsideStyle {
    /// The kind of place.
    pub setting: RoadsideKind,
    /// Number of trees and shrubs, 1 = usual for the setting; 0 is none.
    pub green: f64,
    /// Number of trees beyond that: a factor on `green`.
    pub trees: f64,
    /// Number of shrubs beyond that: a factor on `green`.
    pub shrubs: f64,
    /// Number of buildings, 1 = usual for the setting; 0 is none.
    pub built: f64,
    /// Storeys of every building; none leaves it to the setting.
    pub storeys: Option<u32>,
}

impl RoadsideStyle {
    /// A side that is usual for a setting.
    pub fn usual(setting: RoadsideKind) -> Self {
        Self {
            setting,
            green: 1.0,
            trees: 1.0,
            shrubs: 1.0,
            built: 1.0,
            storeys: None,
        }
    }
}

/// Styles of both sides of the ego's road.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Style {
    /// Left of the ego's road.
    pub left: RoadsideStyle,
    /// Right of it.
    pub right: RoadsideStyle,
}

impl Style {
    /// A style with the same side on the left and on the right.
    pub fn both(side: RoadsideStyle) -> Self {
        Self {
            left: side,
            right: side,
        }
    }

    /// A style that suits the layout: streets with sidewalks run through towns, wide roads without through the country.
    pub fn drawn(layout: &BevLayout, seed: u64) -> Self {
        let mut draw = Draw::new(seed, "scenery style");
        let weights = weights(layout);
        let side = |draw: &mut Draw| RoadsideStyle {
            setting: RoadsideKind::ALL[draw.weighted(&weights)],
            green: draw.range(0.4, 1.4),
            trees: 1.0,
            shrubs: 1.0,
            built: draw.range(0.6, 1.1),
            storeys: None,
        };
        let left = side(&mut draw);
        // Two sides of a street are mostly alike.
        let right = match draw.chance(0.6) {
            true => RoadsideStyle {
                green: draw.range(0.4, 1.4),
                ..left
            },
            false => side(&mut draw),
        };
        Self { left, right }
    }
}

/// Weight of each of [`RoadsideKind::ALL`] beside a layout.
fn weights(layout: &BevLayout) -> [f64; 9] {
    let count = |layer: BevLayer| layout.count(layer) as f64;
    let road = count(BevLayer::DrivableArea).max(1.0);
    let (walk, lots) = (
        count(BevLayer::Walkway) / road,
        count(BevLayer::CarparkArea) / road,
    );
    let lanes = layout
        .polylines
        .iter()
        .filter(|l| l.kind == PolylineKind::LaneCenter)
        .count();
    if walk < 0.02 && lanes >= 4 {
        // No sidewalks and many lanes.
        return [0.0, 0.02, 0.03, 0.1, 0.25, 0.2, 0.4, 0.0, 0.0];
    }
    if lots > 0.35 {
        return [0.02, 0.2, 0.1, 0.2, 0.02, 0.02, 0.0, 0.08, 0.36];
    }
    if walk < 0.02 {
        return [0.04, 0.06, 0.25, 0.12, 0.22, 0.25, 0.0, 0.03, 0.03];
    }
    [0.2, 0.28, 0.2, 0.08, 0.04, 0.02, 0.0, 0.12, 0.06]
}
