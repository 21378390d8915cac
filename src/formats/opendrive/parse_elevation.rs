//! From XML to the height of a road's surface. Profiles that no road can have are counted.

use roxmltree::Node;

use super::elevation::{LaneHeight, MOST_ELEVATION_M, SurfaceProfile};
use super::geometry::cubic;
use super::lanes::{CubicPiece, Cubics};
use super::xml::{
    Result, Skipped, ascending, bad, child, count, count_others, four, named, number, number_or,
};

/// Two records that meet with a larger difference leave a step, m.
const JUMP_M: f64 = 0.2;
/// Two records of tilt that meet with a larger difference leave a step, rad.
const JUMP_RAD: f64 = 0.05;

/// The profiles of a road that is `end_s_m` long.
pub(super) fn surface(road: Node<'_, '_>, end_s_m: f64, skipped: &mut Skipped) -> Result<SurfaceProfile> {
    let mut out = SurfaceProfile::default();
    if let Some(profile) = child(road, "elevationProfile") {
        count_others(profile, &["elevation"], skipped);
        out.elevation = records(profile, "elevation", |_| true, skipped)?;
        doubts(&out.elevation, "elevation", JUMP_M, end_s_m, skipped);
        let ends = ends(&out.elevation, end_s_m);
        if ends
            .iter()
            .flatten()
            .any(|m| m.is_nan() || m.abs() > MOST_ELEVATION_M)
        {
            count(skipped, format!("elevation beyond {MOST_ELEVATION_M:.0} m (cut)"));
        }
    }
    if let Some(profile) = child(road, "lateralProfile") {
        count_others(profile, &["superelevation", "crossfall"], skipped);
        out.superelevation = records(profile, "superelevation", |_| true, skipped)?;
        doubts(&out.superelevation, "superelevation", JUMP_RAD, end_s_m, skipped);
        for node in named(profile, "crossfall") {
            let side = node.attribute("side").unwrap_or("both");
            if !matches!(side, "left" | "right" | "both") {
                return Err(bad(node, "side", "left, right or both", &format!("{side:?}")));
            }
        }
        let is_on = |side: &'static str| {
            move |n: &Node<'_, '_>| [side, "both"].contains(&n.attribute("side").unwrap_or("both"))
        };
        let mut once = Skipped::default(); // what holds for both sides counts once
        out.crossfall_left = records(profile, "crossfall", is_on("left"), &mut once)?;
        out.crossfall_right = records(profile, "crossfall", is_on("right"), skipped)?;
    }
    Ok(out)
}

/// The records of one name, sorted by where they begin.
fn records(
    profile: Node<'_, '_>,
    name: &'static str,
    counts: impl Fn(&Node<'_, '_>) -> bool,
    skipped: &mut Skipped,
) -> Result<Cubics> {
    let mut out: Vec<CubicPiece> = Vec::new();
    let mut in_order = true;
    for node in named(profile, name).filter(counts) {
        let s_m = number(node, "s")?;
        let k = four(node, ["a", "b", "c", "d"])?;
        if s_m < -1e-6 {
            count(skipped, format!("{name} that begins before its road"));
        }
        in_order &= out.last().is_none_or(|before| before.s_m <= s_m);
        out.push(CubicPiece { s_m, k });
    }
    if !in_order {
        count(skipped, format!("{name} records out of order (sorted)"));
        out.sort_by(|a, b| a.s_m.total_cmp(&b.s_m)); // stable
    }
    Ok(Cubics(out))
}

/// The values at the start and end of every record.
fn ends(cubics: &Cubics, end_s_m: f64) -> Vec<[f64; 2]> {
    let pieces = cubics.0.iter().enumerate();
    pieces
        .map(|(i, piece)| {
            let until = cubics.0.get(i + 1).map_or(end_s_m, |next| next.s_m);
            [0.0, (until - piece.s_m).max(0.0)].map(|ds| cubic(&piece.k, ds))
        })
        .collect()
}

/// Counts the steps between records.
fn doubts(cubics: &Cubics, name: &str, jump: f64, end_s_m: f64, skipped: &mut Skipped) {
    let ends = ends(cubics, end_s_m);
    for pair in ends.windows(2) {
        let step = (pair[1][0] - pair[0][1]).abs();
        if step > jump || step.is_nan() {
            count(skipped, format!("jump in the {name}"));
        }
    }
}

/// The heights of a lane.
pub(super) fn lane_heights(lane: Node<'_, '_>) -> Result<Vec<LaneHeight>> {
    let mut out: Vec<LaneHeight> = Vec::new();
    for node in named(lane, "height") {
        let s_m = number_or(node, "sOffset", 0.0)?;
        ascending(node, "sOffset", s_m, out.last().map(|h| h.s_m))?;
        out.push(LaneHeight {
            s_m,
            inner_m: number_or(node, "inner", 0.0)?,
            outer_m: number_or(node, "outer", 0.0)?,
        });
    }
    Ok(out)
}
