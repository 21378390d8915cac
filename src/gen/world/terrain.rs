//! Terrain around a road: grades, crests, dips, banks and cuttings, drawn from a seed.

use glam::DVec2;
use serde::{Deserialize, Serialize};

use super::scenery::distance_cells;
use scene::draw::{Draw, Noise};
use scene::{BevLayer, BevLayout, Extent, Relief, Window};

/// A lie of the land.
#[derive(
    Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, clap::ValueEnum, schemars::JsonSchema,
)]
#[serde(rename_all = "kebab-case")]
pub enum Terrain {
    /// Level everywhere.
    #[default]
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
    /// The ground beside the road rises in a step, held by walls, with stairs here and there.
    Terrace,
    /// The road crosses a valley on a bridge.
    Viaduct,
}

impl Terrain {
    const ALL: [Self; 9] = [
        Self::Flat,
        Self::Grade,
        Self::Crest,
        Self::Dip,
        Self::Hills,
        Self::Embankment,
        Self::Cutting,
        Self::Terrace,
        Self::Viaduct,
    ];

    /// A random terrain: two fifths of the places are flat.
    pub fn drawn(seed: u64) -> Self {
        let mut draw = Draw::new(seed, "terrain");
        Self::ALL[draw.weighted(&[0.4, 0.2, 0.07, 0.07, 0.09, 0.05, 0.05, 0.04, 0.03])]
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
        // Beside the road: rise, distance at which it starts, and width over which it happens.
        let (bank, from, width) = match self {
            Self::Embankment => (-draw.range(0.6, 1.6), draw.range(1.0, 2.5), draw.range(2.0, 5.0)),
            Self::Cutting => (draw.range(1.0, 3.2), draw.range(1.0, 2.5), draw.range(3.0, 7.0)),
            Self::Terrace => (draw.range(0.9, 2.2), draw.range(1.2, 2.2), 0.9),
            Self::Viaduct => (-draw.range(4.0, 6.0), 0.8, 0.6),
            Self::Hills => (draw.range(-0.6, 1.6), 1.0, draw.range(6.0, 14.0)),
            _ => (draw.range(-0.3, 0.6), 1.0, 8.0),
        };
        let cells = layout.cells();
        let paved = BevLayer::DrivableArea.bit() | BevLayer::CarparkArea.bit() | BevLayer::Walkway.bit();
        let to_paved = distance_cells(layout.extent(), |c| cells[c] & paved != 0);
        let [long, bank_noise, rough_noise] = [0x9177, 0xba2c, 0x4011].map(|salt| Noise::new(seed ^ salt));
        let road = |p: DVec2| {
            // A parabola near the ego that turns into a straight grade.
            let along = p.x / 30.0;
            let curve = bend * ((1.0 + along * along).sqrt() - 1.0) * 2.0;
            grade.dot(p) + curve + wave * long.at(p.x / 45.0, p.y / 45.0)
        };
        let at_ego = road(DVec2::ZERO);
        let stairs = Stairs::drawn(&mut draw, &to_paved);
        let valley = draw.range(12.0, 26.0);
        Relief::from_fn(Extent::WINDOW, |p| {
            let Some([x, y]) = Window::column_at(p.x, p.y) else {
                return 0.0;
            };
            let away_m = f64::from(to_paved[x * Window::NY + y]) * Window::VOXEL_M;
            let width = match self {
                Self::Terrace if stairs.are_at([x, y], p) => STAIRS_M,
                _ => width,
            };
            let t = ((away_m - from) / width).clamp(0.0, 1.0);
            let mut rise = t * t * (3.0 - 2.0 * t);
            if self == Self::Viaduct {
                // The valley ends in slopes ahead and behind.
                rise *= ((valley - p.x.abs()) / 8.0 + 1.0).clamp(0.0, 1.0);
            }
            if away_m == 0.0 {
                return road(p) - at_ego;
            }
            let uneven = 0.75 + 0.25 * bank_noise.at(p.x / 12.0, p.y / 12.0);
            let rough = wave * (away_m / 8.0).min(1.0) * 0.6 * rough_noise.at(p.x / 13.0, p.y / 13.0);
            road(p) - at_ego + bank * rise * uneven + rough
        })
    }
}

/// Length of a flight of stairs seen from above, m: steps of 0.3 m, lower than a voxel each.
const STAIRS_M: f64 = 3.6;

/// Places of the flights of stairs up a terrace: stripes across the road, so many metres apart.
struct Stairs<'a> {
    first_m: f64,
    apart_m: f64,
    to_paved: &'a [f32],
}

impl<'a> Stairs<'a> {
    fn drawn(draw: &mut Draw, to_paved: &'a [f32]) -> Self {
        let apart_m = draw.range(13.0, 26.0);
        Self {
            first_m: draw.range(0.0, apart_m),
            apart_m,
            to_paved,
        }
    }

    fn are_at(&self, [x, y]: [usize; 2], p: DVec2) -> bool {
        let at =
            |x: usize, y: usize| self.to_paved[x.min(Window::NX - 1) * Window::NY + y.min(Window::NY - 1)];
        let along_x = (at(x + 1, y) - at(x.saturating_sub(1), y)).abs();
        let along_y = (at(x, y + 1) - at(x, y.saturating_sub(1))).abs();
        // Across the direction of the climb.
        let along = if along_y > along_x { p.x } else { p.y };
        (along - self.first_m).rem_euclid(self.apart_m) < 2.2
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::template;

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
        let valley = DVec2::new(0.0, 14.0);
        assert!(far(Terrain::Viaduct, valley) < far(Terrain::Viaduct, DVec2::new(39.0, 14.0)) - 1.2);
    }

    /// Along a terrace the ground rises at once in most places, and slowly where stairs lead up.
    #[test]
    fn terraces_have_steps_and_stairs() {
        let straight = template::layout("straight", 3).expect("listed");
        let relief = Terrain::Terrace.relief(&straight, 3);
        let edge = (0..Window::NY)
            .rev()
            .find(|y| straight.cell(100, *y) & BevLayer::Walkway.bit() != 0);
        let edge_m = Window::center(100, edge.expect("a sidewalk"), 0).y;
        let rise = |x: f64| {
            relief.height_m(DVec2::new(x, edge_m + 3.6)) - relief.height_m(DVec2::new(x, edge_m + 0.6))
        };
        let rises: Vec<f64> = (-36..36).map(|x| rise(f64::from(x))).collect();
        let steep = rises.iter().filter(|r| **r > 0.6).count();
        let gentle = rises
            .iter()
            .filter(|r| **r < 0.75 * rises.iter().copied().fold(0.0, f64::max))
            .count();
        assert!(steep > 40 && gentle >= 4, "{steep} {gentle} {rises:?}");
    }
}
