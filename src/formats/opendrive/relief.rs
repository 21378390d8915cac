//! The ground between and beyond roads: a membrane stretched over the road surfaces, level at the edges of the window.

use scene::{Extent, Relief};

/// Heights below this are rounding, m.
const TINY_M: f64 = 1e-4;
/// Sweeps on every grid of the pyramid.
const SWEEPS: usize = 40;
/// Successive over-relaxation.
const OVER: f64 = 1.6;

/// Relief over known heights per column (`None` where nothing is known), relative to the ground under the ego vehicle.
/// Flat if nothing is known or all known heights are the same.
/// Also the height of that ground in the frame of the known heights, m.
pub(super) fn over(extent: Extent, known_m: &[Option<f64>]) -> (Relief, f64) {
    let (low, high) = known_m
        .iter()
        .flatten()
        .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), m| {
            (low.min(*m), high.max(*m))
        });
    if known_m.iter().all(Option::is_none) || high - low <= TINY_M {
        return (Relief::FLAT, if low.is_finite() { low } else { 0.0 });
    }
    let heights = membrane(extent.nx(), extent.ny(), known_m);
    // The ego vehicle stands on the corner of four columns; at the rim of a map beside it, on the nearest.
    let at = |x: i64, y: i64| {
        let place = |n: i64, from: i32, most: usize| (n - i64::from(from)).clamp(0, most as i64 - 1) as usize;
        let [from_x, from_y] = extent.from();
        heights[extent.index(place(x, from_x, extent.nx()), place(y, from_y, extent.ny()))]
    };
    let ego = 0.25 * (at(-1, -1) + at(0, -1) + at(-1, 0) + at(0, 0));
    let cut = |m: &f64| {
        let m = m - ego;
        let m = if m.abs() < TINY_M { 0.0 } else { m };
        m.clamp(f64::from(-Relief::LIMIT_M), f64::from(Relief::LIMIT_M)) as f32
    };
    // All heights are finite and within the limit, so none is refused.
    let relief = Relief::from_heights(extent, heights.iter().map(cut).collect()).unwrap_or_default();
    (relief, ego)
}

/// Lowest and highest ground of a map, m: voxels hold no lower ground, and leave too little room for things on higher
/// ground.
const SHOWN_M: [f64; 2] = [-0.4, 3.2];

/// The relief of a map with its hills lowered so far that voxels can show them; slopes near the ego vehicle's height
/// stay nearly as they are. `None` if voxels can show the relief as it is.
pub(super) fn levelled(relief: &Relief) -> Option<Relief> {
    let (extent, heights_m) = (relief.extent()?, relief.heights_m()?);
    let shown = |m: &f32| (SHOWN_M[0]..=SHOWN_M[1]).contains(&f64::from(*m));
    if heights_m.iter().all(shown) {
        return None;
    }
    let low = |m: &f32| {
        let m = f64::from(*m);
        let most_m = SHOWN_M[usize::from(m > 0.0)];
        (most_m * (m / most_m).tanh()) as f32
    };
    Relief::from_heights(extent, heights_m.iter().map(low).collect()).ok()
}

/// Laplace's equation with the known cells held and free edges, on a pyramid of grids: coarse ones first.
/// At least one cell is known.
fn membrane(nx: usize, ny: usize, known: &[Option<f64>]) -> Vec<f64> {
    if known.iter().all(Option::is_some) || nx * ny == 1 {
        return known.iter().map(|k| k.unwrap_or(0.0)).collect();
    }
    let (hx, hy) = (nx.div_ceil(2), ny.div_ceil(2));
    let mut sums = vec![(0.0, 0.0); hx * hy];
    for (i, k) in known.iter().enumerate() {
        if let Some(k) = k {
            let sum = &mut sums[i / ny / 2 * hy + i % ny / 2];
            *sum = (sum.0 + k, sum.1 + 1.0);
        }
    }
    let half: Vec<Option<f64>> = sums.iter().map(|(s, n)| (*n > 0.0).then(|| s / n)).collect();
    let coarse = membrane(hx, hy, &half);
    let mut heights: Vec<f64> = (0..nx * ny)
        .map(|i| known[i].unwrap_or(coarse[i / ny / 2 * hy + i % ny / 2]))
        .collect();
    for _ in 0..SWEEPS {
        for x in 0..nx {
            for y in 0..ny {
                let i = x * ny + y;
                if known[i].is_some() {
                    continue;
                }
                let left = if x > 0 { i - ny } else { i };
                let right = if x + 1 < nx { i + ny } else { i };
                let low = if y > 0 { i - 1 } else { i };
                let high = if y + 1 < ny { i + 1 } else { i };
                let mean = 0.25 * (heights[left] + heights[right] + heights[low] + heights[high]);
                heights[i] += OVER * (mean - heights[i]);
            }
        }
    }
    heights
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::DVec2;
    use scene::Window;

    fn known(height: impl Fn(DVec2) -> Option<f64>) -> Vec<Option<f64>> {
        let at = |c: usize| height(Window::center(c / Window::NY, c % Window::NY, 0).truncate());
        (0..Window::COLUMNS).map(at).collect()
    }

    #[test]
    fn level_ground_stays_flat() {
        assert!(over(Extent::WINDOW, &vec![None; Window::COLUMNS]).0.is_flat());
        assert!(
            over(Extent::WINDOW, &known(|p| (p.y.abs() < 4.0).then_some(17.25)))
                .0
                .is_flat()
        );
    }

    #[test]
    fn banks_join_two_roads_and_level_off_beyond() {
        // One road at the ego, another 20 m to the left and 3 m higher.
        let (relief, _) = over(
            Extent::WINDOW,
            &known(|p| match p.y {
                y if y.abs() < 4.0 => Some(8.0),
                y if (20.0..28.0).contains(&y) => Some(11.0),
                _ => None,
            }),
        );
        let at = |y: f64| relief.height_m(DVec2::new(5.0, y));
        assert!(at(0.0).abs() < 1e-5 && (at(24.0) - 3.0).abs() < 1e-5);
        assert!((at(12.0) - 1.5).abs() < 0.1, "half way up: {}", at(12.0));
        assert!(
            at(-35.0).abs() < 0.02 && (at(38.0) - 3.0).abs() < 0.02,
            "{} {}",
            at(-35.0),
            at(38.0)
        );
        // No step steeper than the bank itself by much.
        let steepest = (0..190).map(|i| {
            let y = -38.0 + f64::from(i) * 0.4;
            (at(y + 0.4) - at(y)).abs() / 0.4
        });
        assert!(steepest.fold(0.0, f64::max) < 0.3);
    }

    #[test]
    fn hills_of_a_map_are_lowered_to_what_voxels_show() {
        let of = |height: fn(DVec2) -> f64| Relief::from_fn(Extent::WINDOW, height);
        assert!(levelled(&of(|p| 0.01 * p.x.max(0.0))).is_none());
        assert!(levelled(&Relief::FLAT).is_none());
        let low = levelled(&of(|p| 0.1 * p.x)).expect("4 m down and up");
        let at = |x: f64| low.height_m(DVec2::new(x, 0.0));
        assert!((at(1.0) - 0.1).abs() < 0.01, "{}", at(1.0));
        assert!((at(39.0) - 3.2 * (3.9f64 / 3.2).tanh()).abs() < 0.01);
        assert!((at(-39.0) + 0.4).abs() < 0.01, "{}", at(-39.0));
        let rises = (-39..39).all(|x| at(f64::from(x)) <= at(f64::from(x) + 1.0));
        assert!(rises);
    }

    #[test]
    fn a_grade_runs_through() {
        let (relief, _) = over(
            Extent::WINDOW,
            &known(|p| (p.y.abs() < 4.0).then_some(100.0 + 0.06 * p.x)),
        );
        for x in [-30.0, 0.0, 33.0] {
            assert!((relief.height_m(DVec2::new(x, 1.0)) - 0.06 * x).abs() < 1e-4);
            let beside = relief.height_m(DVec2::new(x, 12.0));
            assert!((beside - 0.06 * x).abs() < 0.7, "{x}: {beside}");
        }
    }

    #[test]
    fn heights_beyond_the_limit_are_cut() {
        let (relief, _) = over(
            Extent::WINDOW,
            &known(|p| (p.y.abs() < 4.0).then_some(if p.x > 10.0 { 1e4 } else { 0.0 })),
        );
        assert_eq!(relief.height_m(DVec2::new(30.0, 0.0)), f64::from(Relief::LIMIT_M));
    }
}
