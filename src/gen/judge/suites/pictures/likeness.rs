//! Likeness of learned and rendered pictures as a whole: Fréchet distance (FID) and kernel distance (KID) of features
//! that the program's own segmenter finds in windows of both. Its weights ship, so the figures can be made again
//! anywhere. They are not comparable with those of other networks' features.

use anyhow::Context;
use serde_json::{Value, json};

use super::{RenderedRig, refs_of};
use dataset::picture_pairs::poses;
use dataset::world_of;
use metrics::scenewise::{frechet, kernel, standardised};
use nets::picture::PictureSegmenter;
use scene::{Conditions, SensorRig, TimeOfDay, Weather};
use sensors::pictures::appearance::CameraImage;
use sensors::pictures::painter::PaintInput;
use world::draw::Draw;

use calibration::held_out::TEST_SEED;

/// Features of the windows of all pictures of a world.
type Windows = Vec<Vec<f64>>;

/// Features of rendered and learned pictures of each world, and of rendered ones of other worlds.
#[derive(Default)]
pub(super) struct Likeness {
    rendered: Vec<Windows>,
    learned: Vec<Windows>,
    others: Vec<Windows>,
}

impl Likeness {
    /// Adds a world: its pictures by the renderer and by the network.
    pub(super) fn add(
        &mut self,
        net: &PictureSegmenter,
        rendered: &[&CameraImage],
        learned: &[&CameraImage],
    ) -> anyhow::Result<()> {
        self.rendered.push(windows(net, rendered)?);
        self.learned.push(windows(net, learned)?);
        Ok(())
    }

    /// Adds rendered pictures of another held-out world, in light and weather number `light`.
    pub(super) fn add_other(&mut self, net: &PictureSegmenter, index: u64, light: u64) -> anyhow::Result<()> {
        let (world, seed) = world_of(TEST_SEED, index, |_| None);
        let frame = super::frame_of(&world);
        let [pose, _] = poses(&frame, &mut Draw::new(seed, "learned pictures"));
        let rig = SensorRig::default().standing_at(&pose);
        let (time, weather) = light_of(light);
        let rendered = RenderedRig::from_input(&PaintInput {
            frame: &frame,
            rig: &rig,
            background: &world.background,
            conditions: Conditions::usual(time, weather, seed),
        });
        self.others.push(windows(net, &refs_of(&rendered.images))?);
        Ok(())
    }

    /// Distances of the learned and of the rendered pictures to rendered pictures of other worlds; the latter are the
    /// floor. Null below two worlds.
    pub(super) fn report(&self) -> anyhow::Result<Value> {
        if self.others.len() < 2 {
            return Ok(Value::Null);
        }
        let of = |set: &[Windows]| {
            let [others, set] = standardised(&self.others, set)?;
            let (fid, kid) = (frechet(&others, &set)?, kernel(&others, &set)?);
            Ok(json!({ "fid": fid, "kid": kid }))
        };
        let of = |set: &[Windows]| of(set).map_err(|e: metrics::MetricError| anyhow::anyhow!("{e}"));
        Ok(json!({
            "rendered": of(&self.rendered).context("rendered pictures")?,
            "learned": of(&self.learned).context("learned pictures")?,
        }))
    }
}

/// Time of day and weather that belong to a world's index.
pub(super) fn light_of(index: u64) -> (TimeOfDay, Weather) {
    (
        TimeOfDay::ALL[index as usize % TimeOfDay::ALL.len()],
        Weather::ALL[index as usize / 2 % Weather::ALL.len()],
    )
}

fn windows(net: &PictureSegmenter, images: &[&CameraImage]) -> anyhow::Result<Windows> {
    let mut all = Windows::new();
    for image in images {
        all.extend(net.features(&super::colours(image), [image.height, image.width])?);
    }
    Ok(all)
}
