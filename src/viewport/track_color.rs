//! A colour for each moving object, by its number, equal at every moment and in every view.

use scene::BoxId;

/// sRGB. Neighbouring numbers have hues far apart (steps of the golden ratio), at three levels of brightness.
pub fn track_color(id: BoxId) -> [u8; 3] {
    const GOLDEN: f64 = 0.618_033_988_749_894_8;
    let hue = (f64::from(id.0) * GOLDEN).fract() * 6.0;
    let value = [1.0, 0.86, 0.72][id.0 as usize % 3];
    let saturation = 0.62;
    let channel = |shift: f64| {
        let k = (hue + shift).rem_euclid(6.0);
        let share = 1.0 - saturation * (1.0 - ((k - 3.0).abs() - 1.0).clamp(0.0, 1.0));
        (value * share * 255.0).round() as u8
    };
    [channel(0.0), channel(4.0), channel(2.0)]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn neighbours_are_told_apart() {
        let away = |a: [u8; 3], b: [u8; 3]| -> i32 {
            (0..3).map(|i| (i32::from(a[i]) - i32::from(b[i])).abs()).sum()
        };
        for id in 0..300 {
            let own = track_color(BoxId(id));
            assert!(own.iter().all(|v| *v > 40), "{id}: {own:?}");
            for other in id + 1..id + 8 {
                let other = track_color(BoxId(other));
                assert!(away(own, other) > 40, "{id}: {own:?} {other:?}");
            }
        }
        assert_eq!(track_color(BoxId(u32::MAX)), track_color(BoxId(u32::MAX)));
    }
}
