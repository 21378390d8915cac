//! Forecast of the time that many pixels take on this machine: reported before they are rendered, from small pictures
//! of the same camera.

use std::time::Instant;

use super::Rendering;
use super::plan::RenderPlan;
use app::truth;
use scene::Scene;
use sensors::cameras::{PreparedSource, RenderOptions};
use sensors::pictures::appearance::Quality;

/// Progress report of a rendering.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum RenderProgress {
    /// Before anything is written, where there are many: pixels of all pictures, and about how long they take, s.
    Takes {
        /// Pixels of all cameras and kinds together.
        pixels: u64,
        /// On this machine as it is now.
        seconds: f64,
    },
    /// Pictures that were made.
    Made {
        /// How many so far.
        pictures: usize,
        /// Number of pictures in all.
        of: usize,
    },
}

/// Receives the reports of a rendering; an error ends the rendering.
pub type Listen<'a> = dyn FnMut(RenderProgress) -> anyhow::Result<()> + 'a;

/// Up to so many pixels, no time is forecast.
const FEW_PIXELS: u64 = 10_000_000;
/// Sizes of the two pictures that are tried, as divisors of each side that was asked for.
const PARTS: [u32; 2] = [16, 8];

impl RenderPlan {
    /// Pictures of cameras in all.
    pub fn pictures(&self, scene: &Scene) -> usize {
        scene.rig.cameras.len() * (self.cameras.len() + usize::from(self.truth))
    }
}

impl Rendering {
    /// Tells how long pictures will take, if there are many pixels.
    pub(super) fn forecast(
        &self,
        plan: &RenderPlan,
        scene: &Scene,
        listen: &mut Listen<'_>,
    ) -> anyhow::Result<()> {
        let of_one = u64::from(self.size[0]) * u64::from(self.size[1]);
        let pixels = of_one.saturating_mul(plan.pictures(scene) as u64);
        if pixels <= FEW_PIXELS {
            return Ok(());
        }
        let Some(first) = scene.rig.cameras.first() else {
            return Ok(());
        };
        let quality = match self.preview {
            true => Quality::Preview,
            false => Quality::Full,
        };
        let mut seconds = 0.0;
        let mut add = |prepared_s: f64, tried: [(u64, f64); 2]| {
            seconds += prepared_s + per_picture_s(of_one, tried) * scene.rig.cameras.len() as f64;
        };
        for of in &plan.cameras {
            let start = Instant::now();
            let ready = PreparedSource::new(of.source, &self.input(scene));
            let prepared_s = start.elapsed().as_secs_f64();
            let tried = self.tried(|size| {
                let options = RenderOptions { size, quality };
                ready
                    .render_all(std::slice::from_ref(first), &options, None)
                    .map(drop)
                    .map_err(anyhow::Error::from)
            })?;
            add(prepared_s, tried);
        }
        if plan.truth {
            let mut rig = (*scene.rig).clone();
            rig.cameras.truncate(1);
            let mut one = scene.clone();
            one.rig = rig.into();
            let tried =
                self.tried(|size| truth::each_camera(&one, &self.input(&one), size, quality, |_, _| Ok(())))?;
            add(0.0, tried);
        }
        listen(RenderProgress::Takes { pixels, seconds })
    }

    /// Pixels and seconds of two small pictures.
    fn tried(
        &self,
        mut render: impl FnMut([u32; 2]) -> anyhow::Result<()>,
    ) -> anyhow::Result<[(u64, f64); 2]> {
        let mut out = [(0, 0.0); 2];
        for (tried, part) in out.iter_mut().zip(PARTS) {
            let size = self.size.map(|side| (side / part).max(8));
            let start = Instant::now();
            render(size)?;
            let pixels = u64::from(size[0]) * u64::from(size[1]);
            *tried = (pixels, start.elapsed().as_secs_f64());
        }
        Ok(out)
    }
}

/// Seconds of a picture of so many pixels, on the line through two smaller ones: part of their time does not grow with them.
fn per_picture_s(pixels: u64, [(few, few_s), (more, more_s)]: [(u64, f64); 2]) -> f64 {
    let rate = (more_s - few_s).max(0.0) / more.saturating_sub(few).max(1) as f64;
    // Where noise hides the growth, all of the time counts as growth: too long a forecast is better than too short a
    // one.
    let rate = if rate > 0.0 {
        rate
    } else {
        more_s / more.max(1) as f64
    };
    more_s + rate * pixels.saturating_sub(more) as f64
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn time_grows_with_pixels_and_its_base_does_not() {
        // 0.1 s, and a second for each million pixels.
        let of = |pixels: u64| 0.1 + pixels as f64 * 1e-6;
        let tried = [(10_000, of(10_000)), (40_000, of(40_000))];
        assert!((per_picture_s(16_000_000, tried) - of(16_000_000)).abs() < 1e-6);
        // A source that paints in one size whatever is asked for.
        assert!((per_picture_s(16_000_000, [(10_000, 2.0), (40_000, 2.0 + 1e-9)]) - 2.0).abs() < 1e-3);
        // Noise: the larger one was faster.
        assert!(per_picture_s(4_000_000, [(10_000, 0.03), (40_000, 0.02)]) >= 2.0);
    }
}
