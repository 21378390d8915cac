//! Structures that hold roads and ground: retaining walls where the ground steps, parapets where it falls away, bridges
//! across.

use glam::DVec2;

use super::setting::RoadsideKind;
use super::site::ScenerySite;
use super::walk;
use scene::background::{Bridge, LineKind, SceneryLine};
use scene::draw::Draw;
use scene::{BevLayer, Form, Window};

/// Distances from paved ground at which a step of the ground is looked for, m.
const STEPS_AT_M: [f64; 4] = [1.2, 1.6, 2.0, 2.4];
/// Distance over which heights of the ground are compared, m.
const ACROSS_M: f64 = 1.1;
/// Rise within [`ACROSS_M`] from which on the ground is held by a wall, m.
const HELD_M: f64 = 0.6;
/// Fall of the ground beside a road from which on there is a parapet, m.
const FALLS_M: f64 = 1.5;
/// Least number of vertices, 0.8 m apart, of a run that is kept.
const SHORTEST: usize = 4;

/// Rise of the ground from `p` away from the road over a distance, m.
fn rise_m(site: &ScenerySite<'_>, p: DVec2, across_m: f64) -> Option<f64> {
    let away = site.away(p)?;
    let relief = &site.layout.relief;
    Some(relief.height_m(p + away * across_m) - relief.height_m(p))
}

/// Runs of the line at a distance from paved ground for whose rise `enough` is true, each with its greatest rise.
fn runs(site: &ScenerySite<'_>, distance_m: f64, enough: impl Fn(f64) -> bool) -> Vec<(Vec<DVec2>, f64)> {
    let mut out = Vec::new();
    for line in walk::lines(site, distance_m) {
        let rises: Vec<Option<f64>> = line.iter().map(|p| rise_m(site, *p, ACROSS_M)).collect();
        let held = |i: usize| rises[i].is_some_and(&enough);
        let indices: Vec<usize> = (0..line.len()).collect();
        for run in indices.split(|i| !held(*i)).filter(|run| run.len() >= SHORTEST) {
            let most = run
                .iter()
                .filter_map(|i| rises[*i])
                .map(f64::abs)
                .fold(0.0, f64::max);
            out.push((run.iter().map(|i| line[*i]).collect(), most));
        }
    }
    out
}

/// Walls that hold back the ground beside a road, and parapets where it falls away.
pub(super) fn walls(site: &mut ScenerySite<'_>) {
    if site.layout.relief.is_flat() {
        return;
    }
    // The wall stands where most of the rise begins.
    let found = STEPS_AT_M.map(|d| runs(site, d, |rise| rise > HELD_M));
    let length =
        |runs: &Vec<(Vec<DVec2>, f64)>| runs.iter().map(|(line, most)| line.len() as f64 * most).sum();
    let best = found
        .into_iter()
        .max_by(|a, b| f64::total_cmp(&length(a), &length(b)));
    for (line, rise_m) in best.into_iter().flatten() {
        let mut wall = SceneryLine::typical(LineKind::RetainingWall, walk::thinned(&line));
        wall.height_m = rise_m + 0.25;
        site.put(Form::Line(wall), 0.2);
    }
    for (line, _) in runs(site, 0.45, |rise| rise < -FALLS_M) {
        let mut parapet = SceneryLine::typical(LineKind::Wall, walk::thinned(&line));
        parapet.height_m = 1.0;
        site.put(Form::Line(parapet), 0.2);
    }
}

/// Now and then a bridge across the road, ahead of the vehicle or behind it.
pub(super) fn bridges(site: &mut ScenerySite<'_>, draw: &mut Draw) {
    /// Half of the widest road, sidewalks included, that fits between two piers, m.
    const HALF_SPAN_M: f64 = 6.9;
    /// From the middle of the road to the deck's first vertex: its piers then stand 7.5 m from the middle.
    const HALF_LENGTH_M: f64 = 45.0;
    let setting = site.side(DVec2::Y * 20.0).setting;
    let chance = match setting {
        RoadsideKind::Motorway | RoadsideKind::Industry => 0.2,
        RoadsideKind::Country | RoadsideKind::City | RoadsideKind::Park => 0.08,
        _ => 0.0,
    };
    let (wanted, x_m) = (draw.chance(chance), draw.range(14.0, 34.0));
    let x_m = if draw.chance(0.7) { x_m } else { -x_m };
    let (for_vehicles, rise) = (draw.chance(0.6), draw.range(5.6, 6.4));
    let Some([x, _]) = Window::column_at(x_m, 0.0).filter(|_| wanted) else {
        return;
    };
    let paved = BevLayer::DrivableArea.bit() | BevLayer::CarparkArea.bit() | BevLayer::Walkway.bit();
    let width_m = if for_vehicles { 8.0 } else { 3.0 };
    let near = (width_m / 2.0 / Window::VOXEL_M) as usize;
    let under = (x.saturating_sub(near)..=(x + near).min(Window::NX - 1))
        .flat_map(|x| (0..Window::NY).map(move |y| [x, y]))
        .filter(|[x, y]| site.layout.cell(*x, *y) & paved != 0)
        .map(|[x, y]| Window::center(x, y, 0).y);
    let (lo, hi) = under.fold((f64::MAX, f64::MIN), |(lo, hi), y| (lo.min(y), hi.max(y)));
    if hi < lo || hi - lo > 2.0 * HALF_SPAN_M {
        return;
    }
    let middle = DVec2::new(x_m, (lo + hi) / 2.0);
    let ends = [-HALF_LENGTH_M, HALF_LENGTH_M].map(|y| middle + DVec2::Y * y);
    let deck = Bridge {
        points_m: vec![ends[0], middle, ends[1]],
        width_m,
        height_m: rise,
        thickness_m: 1.0,
        for_vehicles,
    };
    site.put(Form::Bridge(deck), 0.6);
}
