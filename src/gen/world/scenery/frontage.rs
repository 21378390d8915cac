//! Buildings that line the roads: lots side by side along a line at the setback, and a second row behind.

use glam::DVec2;

use super::setting::{RoadsideKind, RoadsideStyle};
use super::site::ScenerySite;
use super::walk;
use scene::Form;
use scene::background::{Building, Facade, Roof, STOREY_M};
use scene::draw::Draw;

/// Building style of a setting; ranges in m.
struct Lots {
    setback: [f64; 2],
    width: [f64; 2],
    depth: [f64; 2],
    gap: [f64; 2],
    storeys: [u32; 2],
    /// Share of the lots that are built on.
    share: f64,
    /// Share of pitched roofs.
    pitched: f64,
    /// Weights of [`Facade`]: plain, balconies, bays, arcade, glass.
    facades: [f64; 5],
    /// Share of the second row, behind the first.
    behind: f64,
}

fn lots(setting: RoadsideKind) -> Option<Lots> {
    let lots = |setback, width, depth, gap, storeys, share, pitched, facades, behind| Lots {
        setback,
        width,
        depth,
        gap,
        storeys,
        share,
        pitched,
        facades,
        behind,
    };
    Some(match setting {
        RoadsideKind::OldTown => lots(
            [0.3, 0.9],
            [6.0, 13.0],
            [9.0, 13.0],
            [0.0, 0.0],
            [2, 5],
            0.93,
            0.7,
            [0.6, 0.08, 0.2, 0.12, 0.0],
            0.5,
        ),
        RoadsideKind::City => lots(
            [0.5, 4.0],
            [14.0, 32.0],
            [11.0, 16.0],
            [0.0, 5.0],
            [3, 9],
            0.9,
            0.15,
            [0.3, 0.35, 0.1, 0.1, 0.15],
            0.5,
        ),
        RoadsideKind::Suburb => lots(
            [3.5, 7.0],
            [9.0, 14.0],
            [8.0, 11.0],
            [3.5, 9.0],
            [1, 2],
            0.9,
            0.85,
            [0.8, 0.1, 0.1, 0.0, 0.0],
            0.4,
        ),
        RoadsideKind::Industry => lots(
            [4.0, 11.0],
            [18.0, 42.0],
            [16.0, 26.0],
            [5.0, 14.0],
            [2, 3],
            0.8,
            0.15,
            [0.9, 0.0, 0.0, 0.0, 0.1],
            0.3,
        ),
        RoadsideKind::Retail => lots(
            [3.0, 8.0],
            [22.0, 46.0],
            [16.0, 24.0],
            [6.0, 16.0],
            [1, 2],
            0.75,
            0.05,
            [0.5, 0.0, 0.0, 0.2, 0.3],
            0.0,
        ),
        RoadsideKind::Country => lots(
            [7.0, 16.0],
            [9.0, 22.0],
            [8.0, 12.0],
            [14.0, 40.0],
            [1, 2],
            0.3,
            0.95,
            [1.0, 0.0, 0.0, 0.0, 0.0],
            0.1,
        ),
        RoadsideKind::Park => lots(
            [8.0, 14.0],
            [7.0, 14.0],
            [6.0, 9.0],
            [25.0, 50.0],
            [1, 1],
            0.25,
            0.6,
            [0.7, 0.0, 0.0, 0.3, 0.0],
            0.0,
        ),
        RoadsideKind::Forest | RoadsideKind::Motorway => return None,
    })
}

/// Puts buildings along every road.
pub(super) fn buildings(site: &mut ScenerySite<'_>) {
    let mut draw = Draw::new(site.seed, "buildings");
    // The setback is the same on both sides where their settings are alike, so that one line serves both.
    let setback = draw.unit();
    for row in 0..2 {
        for setting in RoadsideKind::ALL {
            let Some(lots) = lots(setting) else { continue };
            let mut distance = lots.setback[0] + setback * (lots.setback[1] - lots.setback[0]);
            if row == 1 {
                distance += lots.depth[1] + 5.0;
            }
            if ![DVec2::Y, -DVec2::Y]
                .iter()
                .any(|p| site.side(*p * 20.0).setting == setting)
            {
                continue;
            }
            for line in walk::lines(site, distance) {
                line_up(site, &line, &lots, setting, row, &mut draw);
            }
        }
    }
}

/// Lots from one end of a line to the other.
fn line_up(
    site: &mut ScenerySite<'_>,
    line: &[DVec2],
    lots: &Lots,
    setting: RoadsideKind,
    row: usize,
    draw: &mut Draw,
) {
    let total = walk::length_m(line);
    // Lots of one street have an eaves height in common, more or less.
    let usual = lots.storeys[0] + draw.below((lots.storeys[1] - lots.storeys[0] + 1) as usize) as u32;
    let mut at = draw.range(0.0, 4.0);
    while at < total {
        let width = draw.range(lots.width[0], lots.width[1]);
        let gap = if draw.chance(0.15) {
            lots.gap[1] + draw.range(0.0, 4.0)
        } else {
            draw.range(lots.gap[0], lots.gap[1])
        };
        let built = draw.chance(lots.share * if row == 1 { lots.behind } else { 1.0 });
        let (depth, pick, storey_shift) = (
            draw.range(lots.depth[0], lots.depth[1]),
            draw.bits(),
            draw.below(3),
        );
        let span = walk::part(line, at, (at + width).min(total));
        let (Some(a), Some(b)) = (span.first().copied(), span.last().copied()) else {
            break;
        };
        let front = a.distance(b);
        let side = *site.side((a + b) / 2.0);
        let wanted = built && side.setting == setting && Draw::new(pick, "built").chance(side.built);
        if wanted
            && front > 0.6 * lots.width[0]
            && let Some(building) = building(site, a, b, depth, lots, &side, usual, storey_shift, pick)
        {
            // Houses wall to wall share their edge.
            site.put(
                Form::Building(building),
                if lots.gap[1] > 0.0 { 0.4 } else { 0.0 },
            );
        }
        // On a bend the chord is shorter than the distance along the line; a building there is as wide as the chord.
        at += width.min(total) + gap;
    }
}

/// A building whose front runs from `a` to `b`, if there is room; a shallower one where there is less.
#[expect(clippy::too_many_arguments, reason = "one lot, described once")]
fn building(
    site: &ScenerySite<'_>,
    a: DVec2,
    b: DVec2,
    depth: f64,
    lots: &Lots,
    side: &RoadsideStyle,
    usual: u32,
    storey_shift: usize,
    pick: u64,
) -> Option<Building> {
    let mut draw = Draw::new(pick, "lot");
    let along = (b - a).normalize_or(DVec2::X);
    let away = along.perp(); // the road is on the right
    let facade = [
        Facade::Plain,
        Facade::Balconies,
        Facade::Bays,
        Facade::Arcade,
        Facade::Glass,
    ][draw.weighted(&lots.facades)];
    let pitched = draw.chance(lots.pitched);
    let storeys = side.storeys.unwrap_or(
        (usual + storey_shift as u32)
            .saturating_sub(1)
            .clamp(lots.storeys[0], lots.storeys[1]),
    );
    let storey_m = match side.setting {
        RoadsideKind::Industry | RoadsideKind::Retail => draw.range(3.6, 4.6),
        _ => STOREY_M,
    };
    // Projecting parts must not hang over the road.
    let hangs = matches!(facade, Facade::Balconies | Facade::Bays);
    let room = site.paved_m((a + b) / 2.0);
    let facade = if hangs && room < 1.8 {
        Facade::Plain
    } else {
        facade
    };
    for (share, cut_m) in [(1.0, 0.0), (1.0, 0.7), (0.7, 0.7), (0.6, 1.6)] {
        let depth = depth * share;
        // On the inside of a bend neighbours would meet at the back: a narrower one fits.
        let (a, b) = (a + along * cut_m, b - along * cut_m);
        let (c, d) = (b + away * depth, a + away * depth);
        // Some have a wing at the back: an L.
        let wing = draw.chance(0.25) && a.distance(b) > 11.0 && share == 1.0;
        let mut outline_m = vec![a, b, c, d];
        if wing {
            let inner = a.lerp(b, draw.range(0.4, 0.6));
            let deeper = depth * draw.range(1.3, 1.8);
            outline_m = vec![
                a,
                b,
                b + away * deeper,
                inner + away * deeper,
                inner + away * depth,
                d,
            ];
        }
        if a.distance(b) < 4.0 || !site.free_outline(&outline_m, 0.2) {
            continue;
        }
        let roof = match pitched && outline_m.len() == 4 {
            true if draw.chance(0.75) => Roof::Gabled,
            true => Roof::Hipped,
            false => Roof::Flat,
        };
        return Some(Building {
            outline_m,
            height_m: f64::from(storeys) * storey_m + draw.range(0.0, 0.5),
            roof,
            facade,
        });
    }
    None
}
