//! The edit that extends a map to where objects will go.

use glam::DVec2;

use scene::{Edit, Extent};

/// Margin that is added around a path that leaves the map, m, for the surroundings that the sensors see there.
const AROUND_M: f64 = 40.0;
/// A map grows in steps of this size, m.
const STEP_M: f64 = 20.0;

/// The edit that extends a map so that it reaches `sight_m` (along x and y below, then above) around all these places,
/// with a margin where they leave it; `None` where it reaches that far already.
pub(crate) fn reaching(
    extent: Extent,
    places: impl Iterator<Item = DVec2>,
    [sight_below_m, sight_above_m]: [DVec2; 2],
) -> Option<Edit> {
    let (low, high) = (extent.min_m().truncate(), extent.max_m().truncate());
    let [mut below, mut above] = [DVec2::ZERO; 2];
    for p in places {
        // (an axis along which the places stay inside needs no margin)
        below = below.max(low - p + sight_below_m);
        above = above.max(p - high + sight_above_m);
    }
    // Half a metre more is as good as enough.
    let more = |m: f64, sight_m: f64| match m > 0.5 {
        true => ((m + AROUND_M - sight_m) / STEP_M).ceil() * STEP_M,
        false => 0.0,
    };
    let [ahead_m, behind_m] = [more(above.x, sight_above_m.x), more(below.x, sight_below_m.x)];
    let [left_m, right_m] = [more(above.y, sight_above_m.y), more(below.y, sight_below_m.y)];
    let grows = ahead_m + behind_m + left_m + right_m > 0.0;
    grows.then_some(Edit::ExtendMap {
        ahead_m,
        behind_m,
        left_m,
        right_m,
    })
}

/// The distance by which a map reaches beyond places, m: along x and y below them, then above; at most [`AROUND_M`], at
/// least 0.
pub(crate) fn sights_m(extent: Extent, places: impl Iterator<Item = DVec2>) -> [DVec2; 2] {
    let (low, high) = (extent.min_m().truncate(), extent.max_m().truncate());
    places.fold([DVec2::splat(AROUND_M); 2], |[below, above], p| {
        [
            below.min(p - low).max(DVec2::ZERO),
            above.min(high - p).max(DVec2::ZERO),
        ]
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_map_grows_where_it_is_left() {
        let extent = Extent::new([-50, -50], [300, 100]).expect("sound");
        let more = reaching(
            extent,
            [DVec2::new(-60.0, 3.0), DVec2::new(5.0, 0.0)].into_iter(),
            [DVec2::ZERO; 2],
        );
        let wanted = Edit::ExtendMap {
            ahead_m: 0.0,
            behind_m: 80.0,
            left_m: 0.0,
            right_m: 0.0,
        };
        assert_eq!(more, Some(wanted));
        assert_eq!(
            reaching(extent, std::iter::once(DVec2::ZERO), [DVec2::ZERO; 2]),
            None
        );
    }
}
