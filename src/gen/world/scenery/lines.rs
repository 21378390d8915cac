//! Fences, hedges, walls and rails along roads and lots, and poles, signs and furniture on the sidewalk.

use glam::DVec2;

use super::setting::RoadsideKind;
use super::site::ScenerySite;
use super::walk;
use scene::Form;
use scene::background::{LineKind, Post, PostKind, SceneryLine};
use scene::draw::Draw;

/// Boundary along the road in a setting: weights of hedge, wall, fence, guard rail, none; and its distance, m.
fn boundary(setting: RoadsideKind) -> ([f64; 5], [f64; 2]) {
    match setting {
        RoadsideKind::Suburb => ([0.34, 0.18, 0.3, 0.0, 0.18], [0.5, 1.2]),
        RoadsideKind::Industry => ([0.08, 0.15, 0.52, 0.0, 0.25], [0.6, 2.5]),
        RoadsideKind::Country => ([0.25, 0.1, 0.3, 0.1, 0.25], [1.6, 4.0]),
        RoadsideKind::Motorway => ([0.03, 0.12, 0.05, 0.7, 0.1], [0.7, 1.5]),
        RoadsideKind::Forest => ([0.0, 0.05, 0.12, 0.25, 0.58], [0.8, 2.0]),
        RoadsideKind::Park => ([0.2, 0.15, 0.2, 0.0, 0.45], [0.6, 1.5]),
        RoadsideKind::City => ([0.1, 0.1, 0.08, 0.0, 0.72], [0.4, 0.8]),
        RoadsideKind::OldTown => ([0.02, 0.12, 0.06, 0.0, 0.8], [0.3, 0.6]),
        RoadsideKind::Retail => ([0.2, 0.05, 0.15, 0.05, 0.55], [0.6, 2.0]),
    }
}

const KINDS: [Option<LineKind>; 5] = [
    Some(LineKind::Hedge),
    Some(LineKind::Wall),
    Some(LineKind::Fence),
    Some(LineKind::GuardRail),
    None,
];

/// Puts boundaries along the roads, lot by lot, with gates between them.
pub(super) fn lines(site: &mut ScenerySite<'_>) {
    let mut draw = Draw::new(site.seed, "boundaries");
    let ends = [site.side(DVec2::Y * 20.0), site.side(DVec2::Y * -20.0)].map(|s| s.setting);
    for (i, setting) in ends.iter().enumerate() {
        if i == 1 && ends[0] == ends[1] {
            break;
        }
        let (weights, distance) = boundary(*setting);
        let distance = draw.range(distance[0], distance[1]);
        for line in walk::lines(site, distance) {
            let total = walk::length_m(&line);
            let mut at = draw.range(0.0, 6.0);
            while at < total {
                let long = *setting == RoadsideKind::Motorway || *setting == RoadsideKind::Forest;
                let run = if long {
                    draw.range(40.0, 90.0)
                } else {
                    draw.range(7.0, 24.0)
                };
                let kind = KINDS[draw.weighted(&weights)];
                let tall = draw.range(0.75, 1.3);
                let points = walk::thinned(&walk::part(&line, at, at + run));
                at += run + draw.range(1.2, 4.0);
                let Some(kind) = kind else { continue };
                // Pieces that find room; a driveway or a house leaves a gap.
                let fits = |p: &DVec2| {
                    site.free(*p, 0.4) && site.paved_m(*p) > 0.25 && site.side(*p).setting == *setting
                };
                let fine = dense(&points);
                let runs: Vec<Vec<DVec2>> = fine
                    .split(|p| !fits(p))
                    .filter(|r| r.len() > 2)
                    .map(walk::thinned)
                    .collect();
                for points_m in runs {
                    let mut line = SceneryLine::typical(kind, points_m);
                    line.height_m *= if kind == LineKind::GuardRail { 1.0 } else { tall };
                    if kind == LineKind::Wall && *setting == RoadsideKind::Motorway {
                        line.height_m *= 2.0; // against noise
                    }
                    site.put(Form::Line(line), 0.2);
                }
            }
        }
    }
}

/// A point at least every 0.8 m.
fn dense(line: &[DVec2]) -> Vec<DVec2> {
    let mut out = Vec::new();
    for pair in line.windows(2) {
        let n = (pair[0].distance(pair[1]) / 0.8).ceil().max(1.0);
        out.extend((0..n as usize).map(|i| pair[0].lerp(pair[1], i as f64 / n)));
    }
    out.extend(line.last());
    out
}

/// Lamps, signs and furniture along the kerb, clutter behind it.
pub(super) fn posts(site: &mut ScenerySite<'_>, draw: &mut Draw) {
    // The kerb side of the sidewalk; where there is none, beside the road.
    let spacing = draw.range(9.0, 18.0);
    for line in walk::lines(site, 0.45).into_iter().chain(kerbs(site)) {
        let total = walk::length_m(&line);
        let mut at = draw.range(0.0, spacing);
        while at < total {
            let p = walk::part(&line, at, at + 0.2).first().copied();
            at += spacing * draw.range(0.5, 1.4);
            let (pick, turn) = (draw.bits(), draw.range(-0.1, 0.1));
            let Some(p) = p else { break };
            if site.road_m(p) < 0.35 || !site.free(p, 0.5) {
                continue;
            }
            let mut lot = Draw::new(pick, "post");
            let setting = site.side(p).setting;
            let rural = matches!(
                setting,
                RoadsideKind::Forest | RoadsideKind::Country | RoadsideKind::Motorway
            );
            if rural && lot.chance(0.6) {
                continue;
            }
            let kinds = [
                PostKind::StreetLight,
                PostKind::Sign,
                PostKind::Pole,
                PostKind::TrafficLight,
                PostKind::BusStop,
                PostKind::Bench,
                PostKind::Bin,
                PostKind::Bollard,
            ];
            let weights = match rural {
                true => [0.2, 0.4, 0.35, 0.0, 0.02, 0.0, 0.03, 0.0],
                false => [0.3, 0.22, 0.1, 0.05, 0.04, 0.08, 0.12, 0.09],
            };
            let kind = kinds[lot.weighted(&weights)];
            let toward = site.toward_lane(p);
            // Signs face along the road, shelters open towards it.
            let facing = match kind {
                PostKind::Sign | PostKind::TrafficLight => toward.perp(),
                _ => toward,
            };
            if kind == PostKind::BusStop && !(site.road_m(p) > 1.2 && site.free(p, 2.0)) {
                continue;
            }
            let mut post = Post::typical(kind, p, facing.to_angle() + turn);
            post.height_m *= lot.range(0.85, 1.15);
            site.put(Form::Post(post), 0.5);
        }
    }
}

/// Lines along the inner edge of sidewalks, 0.6 m from the road.
fn kerbs(site: &ScenerySite<'_>) -> Vec<Vec<DVec2>> {
    // A sidewalk's outer edge lies at distance 0 from paved ground; its kerb is found from there inwards.
    let outer = walk::lines(site, 0.45);
    let inward = |p: DVec2| {
        let away = site.away(p)?;
        let mut q = p;
        for _ in 0..24 {
            if site.road_m(q) <= 0.75 {
                return (site.road_m(q) > 0.35).then_some(q);
            }
            q -= away * 0.25;
        }
        None
    };
    outer
        .iter()
        .flat_map(|line| {
            let inner: Vec<Option<DVec2>> = line.iter().map(|p| inward(*p)).collect();
            let runs = inner.split(Option::is_none);
            runs.map(|r| r.iter().flatten().copied().collect::<Vec<_>>())
                .filter(|r| r.len() > 6)
                .collect::<Vec<_>>()
        })
        .collect()
}
