//! The lie of the land around a road: grades, crests, dips, banks and cuttings, drawn from a seed.

use glam::DVec2;
use serde::{Deserialize, Serialize};

use super::draw::{Draw, noise};
use super::scenery::distance_cells;
use crate::scene::{BevLayer, BevLayout, GridSpec, Relief};

/// A lie of the land.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, clap::ValueEnum)]
#[serde(rename_all = "kebab-case")]
pub enum Terrain {
    /// Level everywhere.
    Flat,
    /// The road climbs, falls or tilts sideways by up to 8 %.
    Grade,
    /// The road falls away ahead and behind.
    Crest,
    /// The road climbs ahead and behind.
    Dip,
    /// A gentle road through uneven ground.
    Hills,
    /// The road runs above its surroundings.
    Embankment,
    /// The road runs below its surroundings, between slopes.
    Cutting,
    /// The ground beside the road rises in a step, held by walls.
    Terrace,
}

impl Terrain {
    const ALL: [Self; 8] = [
        Self::Flat,
        Self::Grade,
        Self::Crest,
        Self::Dip,
        Self::Hills,
        Self::Embankment,
        Self::Cutting,
        Self::Terrace,
    ];

    /// One at random: two fifths of the places are flat.
    pub fn drawn(seed: u64) -> Self {
        let mut draw = Draw::new(seed, "terrain");
        Self::ALL[draw.weighted(&[0.4, 0.2, 0.07, 0.07, 0.12, 0.05, 0.05, 0.04])]
    }

    /// Heights for a layout; 0 under the ego vehicle.
    pub fn relief(self, layout: &BevLayout, seed: u64) -> Relief {
        if self == Self::Flat {
            return Relief::FLAT;
        }
        let mut draw = Draw::new(seed, "relief");
        // Along the road and across it; most roads are gentle.
        let steep =
            |draw: &mut Draw| draw.range(0.0, 1.0).powi(2) * if draw.chance(0.5) { 1.0 } else { -1.0 };
        let grade = match self {
            Self::Grade => DVec2::new(0.08 * steep(&mut draw), 0.05 * steep(&mut draw)),
            _ => DVec2::new(0.03 * steep(&mut draw), 0.02 * steep(&mut draw)),
        };
        let bend = match self {
            Self::Crest => -draw.range(1.0, 3.0),
            Self::Dip => draw.range(1.0, 3.0),
            _ => 0.0,
        };
        let wave = if self == Self::Hills {
            draw.range(0.4, 1.4)
        } else {
            draw.range(0.0, 0.3)
        };
        // Beside the road: how much higher, from where, over which width.
        let (bank, from, width) = match self {
            Self::Embankment => (-draw.range(0.6, 1.6), draw.range(1.0, 2.5), draw.range(2.0, 5.0)),
            Self::Cutting => (draw.range(1.0, 3.2), draw.range(1.0, 2.5), draw.range(3.0, 7.0)),
            Self::Terrace => (draw.range(0.9, 2.2), draw.range(1.2, 2.2), 0.9),
            Self::Hills => (draw.range(-0.6, 1.6), 1.0, draw.range(6.0, 14.0)),
            _ => (draw.range(-0.3, 0.6), 1.0, 8.0),
        };
        let cells = layout.cells();
        let paved = BevLayer::DrivableArea.bit() | BevLayer::CarparkArea.bit() | BevLayer::Walkway.bit();
        let to_paved = distance_cells(|c| cells[c] & paved != 0);
        let road = |p: DVec2| {
            // A parabola near the ego that turns into a straight grade.
            let along = p.x / 30.0;
            let curve = bend * ((1.0 + along * along).sqrt() - 1.0) * 2.0;
            grade.dot(p) + curve + wave * noise(seed ^ 0x9177, p.x / 45.0, p.y / 45.0)
        };
        let at_ego = road(DVec2::ZERO);
        Relief::from_fn(|p| {
            let Some([x, y]) = GridSpec::column_at(p.x, p.y) else {
                return 0.0;
            };
            let away_m = f64::from(to_paved[x * GridSpec::NY + y]) * GridSpec::VOXEL_M;
            let t = ((away_m - from) / width).clamp(0.0, 1.0);
            let rise = t * t * (3.0 - 2.0 * t);
            let uneven = 0.75 + 0.25 * noise(seed ^ 0xba2c, p.x / 12.0, p.y / 12.0);
            let rough = wave * (away_m / 8.0).min(1.0) * 0.6 * noise(seed ^ 0x4011, p.x / 13.0, p.y / 13.0);
            road(p) - at_ego + bank * rise * uneven + rough
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::generation::world::template;

    #[test]
    fn the_ego_stands_at_zero_and_each_lie_is_what_it_says() {
        for seed in 0..12 {
            let layout = template::any_layout(seed);
            for terrain in Terrain::ALL {
                let relief = terrain.relief(&layout, seed);
                assert_eq!(relief.is_flat(), terrain == Terrain::Flat);
                assert!(relief.height_m(DVec2::ZERO).abs() < 0.05, "{terrain:?} {seed}");
            }
        }
        let straight = template::layout("straight", 3).expect("listed");
        let far = |t: Terrain, p: DVec2| t.relief(&straight, 3).height_m(p);
        assert!(far(Terrain::Dip, DVec2::X * 38.0) > far(Terrain::Crest, DVec2::X * 38.0) + 1.0);
        let verge = DVec2::new(0.0, 38.0);
        assert!(far(Terrain::Cutting, verge) > far(Terrain::Embankment, verge) + 1.2);
    }
}
