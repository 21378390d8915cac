//! The moments of a clip that formats write.

use scene::Scene;

/// Times from the start of the clip to its end, `rate_hz` a second; the moment shown alone where nothing moves.
pub fn times_s(scene: &Scene, rate_hz: f64) -> Vec<f64> {
    let clip = scene.clip();
    if clip.stands() || clip.length_s <= 0.0 {
        return vec![scene.time_s()];
    }
    let last = (clip.length_s * rate_hz + 1e-6).floor() as usize;
    (0..=last)
        .map(|i| (i as f64 / rate_hz).min(clip.length_s))
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::clip_tests::clip_scene;
    use crate::table_tests::scene;

    #[test]
    fn moments_reach_to_the_end_and_no_farther() {
        assert_eq!(times_s(&scene(), 2.0), [0.0]);
        let mut moving = clip_scene(1);
        moving.change_clip(|clip| clip.length_s = 1.3);
        assert_eq!(times_s(&moving, 2.0), [0.0, 0.5, 1.0]);
        moving.change_clip(|clip| clip.length_s = 0.3);
        // 0.3 * 10 is a hair less than 3.
        assert_eq!(times_s(&moving, 10.0), [0.0, 0.1, 0.2, 0.3]);
    }
}
