//! Trees in rows, in gardens and in woods, and patches of shrubs.

use glam::DVec2;

use super::setting::{RoadsideKind, RoadsideStyle};
use super::site::ScenerySite;
use super::walk;
use scene::background::{Shrubs, Tree, TreeKind};
use scene::draw::{Draw, noise};
use scene::{Form, Window};

/// Trees per 1,000 m² of open ground, how much they gather in groves (0 to 1), and weights of [`TreeKind::ALL`].
fn wood(setting: RoadsideKind) -> (f64, f64, [f64; 4]) {
    match setting {
        RoadsideKind::Forest => (50.0, 0.15, [0.5, 0.38, 0.04, 0.08]),
        RoadsideKind::Park => (19.0, 0.6, [0.7, 0.14, 0.1, 0.06]),
        RoadsideKind::Suburb => (19.0, 0.4, [0.6, 0.18, 0.14, 0.08]),
        RoadsideKind::Country => (15.0, 0.85, [0.66, 0.18, 0.06, 0.1]),
        RoadsideKind::Motorway => (18.0, 0.7, [0.6, 0.24, 0.04, 0.12]),
        RoadsideKind::City => (11.0, 0.3, [0.7, 0.04, 0.18, 0.08]),
        RoadsideKind::OldTown => (5.0, 0.3, [0.75, 0.02, 0.15, 0.08]),
        RoadsideKind::Industry => (9.0, 0.5, [0.6, 0.1, 0.22, 0.08]),
        RoadsideKind::Retail => (9.0, 0.2, [0.7, 0.05, 0.2, 0.05]),
    }
}

/// Shrub patches per 1,000 m² of open ground.
fn undergrowth(setting: RoadsideKind) -> f64 {
    match setting {
        RoadsideKind::Forest => 20.0,
        RoadsideKind::Park => 11.0,
        RoadsideKind::Suburb => 13.0,
        RoadsideKind::Country => 16.0,
        RoadsideKind::Motorway => 18.0,
        RoadsideKind::City => 7.0,
        RoadsideKind::OldTown => 4.0,
        RoadsideKind::Industry => 9.0,
        RoadsideKind::Retail => 7.0,
    }
}

/// A tree of a side at a place.
fn tree(side: &RoadsideStyle, p: DVec2, draw: &mut Draw) -> Tree {
    let (_, _, kinds) = wood(side.setting);
    let kind = TreeKind::ALL[draw.weighted(&kinds)];
    let (height, slim) = match kind {
        TreeKind::Conifer => (draw.range(4.0, 14.0), draw.range(0.14, 0.24)),
        TreeKind::Columnar => (draw.range(4.0, 9.0), draw.range(0.12, 0.18)),
        _ => (draw.range(3.6, 10.0), draw.range(0.24, 0.42)),
    };
    Tree {
        position_m: p,
        height_m: height,
        crown_radius_m: (height * slim).clamp(0.6, 3.4),
        kind,
    }
}

/// Rows of trees in the outer half of the sidewalk or on the verge.
pub(super) fn avenues(site: &mut ScenerySite<'_>, draw: &mut Draw) {
    let on_walk = walk::lines(site, 0.8);
    for line in on_walk {
        let spacing = draw.range(6.5, 12.0);
        let (chance, total, kind) = (draw.unit(), walk::length_m(&line), draw.bits());
        let mut at = draw.range(0.0, spacing);
        while at < total {
            let p = walk::part(&line, at, at + 0.2).first().copied();
            at += spacing * draw.range(0.92, 1.08);
            let Some(p) = p else { break };
            let side = *site.side(p);
            let rows = match side.setting {
                RoadsideKind::City | RoadsideKind::Park => 0.5,
                RoadsideKind::OldTown | RoadsideKind::Suburb | RoadsideKind::Retail => 0.3,
                RoadsideKind::Country => 0.35,
                _ => 0.1,
            };
            if chance > rows * side.green * side.trees || !site.free(p, 0.8) || site.road_m(p) < 0.6 {
                continue;
            }
            // One row, one kind.
            let mut like = Draw::new(kind, "row");
            let mut row = tree(&side, p, &mut like);
            row.height_m *= draw.range(0.9, 1.1);
            row.crown_radius_m = row.crown_radius_m.min(2.4);
            site.put(Form::Tree(row), 1.0);
        }
    }
}

/// Trees on open ground.
pub(super) fn trees(site: &mut ScenerySite<'_>, draw: &mut Draw) {
    for _ in 0..420 {
        let p = DVec2::new(draw.range(-40.0, 40.0), draw.range(-40.0, 40.0));
        let (chance, pick) = (draw.unit(), draw.bits());
        let side = *site.side(p);
        let (per_1000, gather, _) = wood(side.setting);
        // 420 draws over 6,400 m²: 65.6 per 1,000 m².
        let groves = 1.0 - gather + gather * (1.0 + 1.6 * noise(site.seed, p.x / 16.0, p.y / 16.0)).max(0.0);
        let near_road = (site.paved_m(p) / 4.0).min(1.0);
        if chance > per_1000 / 65.6 * side.green * side.trees * groves * near_road {
            continue;
        }
        let new = tree(&side, p, &mut Draw::new(pick, "tree"));
        let crown = new.crown_radius_m;
        // The crown may reach over the sidewalk, the trunk stays off it, and walls keep the crown away.
        if site.paved_m(p) > 0.5 && site.road_m(p) > crown * 0.7 + 0.5 && site.free(p, (crown * 0.6).min(1.5))
        {
            let keep = if side.setting == RoadsideKind::Forest {
                0.7
            } else {
                1.0
            };
            site.put(Form::Tree(new), keep);
        }
    }
}

/// Patches of shrubs and undergrowth.
pub(super) fn shrubs(site: &mut ScenerySite<'_>, draw: &mut Draw) {
    for _ in 0..160 {
        let p = DVec2::new(draw.range(-40.0, 40.0), draw.range(-40.0, 40.0));
        let (chance, pick) = (draw.unit(), draw.bits());
        let side = *site.side(p);
        let patch = 1.0 + 0.8 * noise(site.seed ^ 0x5eed, p.x / 9.0, p.y / 9.0);
        // 160 draws over 6,400 m²: 25 per 1,000 m².
        if chance > undergrowth(side.setting) / 25.0 * side.green * side.shrubs * patch
            || site.paved_m(p) < 1.2
        {
            continue;
        }
        let mut own = Draw::new(pick, "patch");
        let (radius, corners) = (own.range(1.0, 4.5), 6 + own.below(4));
        let outline_m: Vec<DVec2> = (0..corners)
            .map(|i| {
                let angle = i as f64 / corners as f64 * std::f64::consts::TAU;
                let room = (site.paved_m(p) - 0.4).max(0.5);
                p + DVec2::from_angle(angle) * (radius * own.range(0.55, 1.0)).min(room)
            })
            .collect();
        let inside_grid = |q: &DVec2| Window::column_at(q.x, q.y).is_none() || site.free(*q, 0.3);
        if !outline_m.iter().chain([&p]).all(inside_grid) {
            continue;
        }
        let form = Shrubs {
            outline_m,
            height_m: own.range(0.5, 2.4),
            per_m2: own.range(0.3, 1.2),
        };
        site.put(Form::Shrubs(form), 0.0);
    }
}
