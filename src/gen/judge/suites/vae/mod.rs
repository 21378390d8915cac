//! `eval vae`: what encoding and decoding keep of procedural worlds or of a folder of labels, with the latents that the
//! networks use and with the fine ones.

mod slopes;

use std::collections::BTreeMap;
use std::path::Path;

use anyhow::Context;
use serde_json::{Value, json};

use crate::suite::{Options, SuiteFigures, with_interval};
use authoring::open;
use calibration::MeasurementProgress;
use calibration::held_out::{TEST_SEED, scene};
use dataset::occupancy_frame;
use formats::occ3d;
use job::pipeline::OccPipeline;
use metrics::agreement::AgreementCount;
use metrics::iou::Confusion;
use nets::{CELLS, DecoderInput, OccVae, fine_vae};
use scene::{Class, Unobserved, VoxelGrid, draft, infer};
use slopes::Slopes;

/// Latents that are decoded: the mean; one drawn from the encoder's distribution; the fine network's mean; and the mean
/// again by a decoder that gets the draft and, for labels, what was observed.
const MODES: [&str; 4] = ["mean", "sampled", "fine", "told"];
/// Index of the last mode.
const TOLD: usize = 3;

/// Agreement of one mode on one kind of frames.
#[derive(Default)]
struct ReconstructionAgreement {
    total: Confusion,
    miou: Vec<f64>,
    iou: Vec<f64>,
}

impl ReconstructionAgreement {
    fn add(&mut self, truth: &VoxelGrid, found: &VoxelGrid) {
        let mut one = Confusion::default();
        one.add(truth, found);
        self.total.merge(&one);
        self.miou.extend(one.mean_iou().0);
        self.iou.extend(one.occupied_iou());
    }

    fn miou(&self) -> f64 {
        self.total.mean_iou().0.unwrap_or(f64::NAN)
    }

    fn iou(&self) -> f64 {
        self.total.occupied_iou().unwrap_or(f64::NAN)
    }

    /// mIoU and IoU over all frames, per frame and per class.
    fn report(&self) -> Value {
        json!({
            "miou": self.miou(),
            "iou": self.iou(),
            "classes_present": self.total.mean_iou().1,
            "miou_per_frame": with_interval(&self.miou),
            "iou_per_frame": with_interval(&self.iou),
            "per_class": per_class(&self.total),
        })
    }
}

/// IoU of every class that occurs.
pub(super) fn per_class(total: &Confusion) -> BTreeMap<&'static str, f64> {
    let iou = |c: &Class| Some((c.name(), (total.class_iou(*c)? * 1e3).round() / 1e3));
    Class::ALL[..17].iter().filter_map(iou).collect()
}

fn report(kept: &[ReconstructionAgreement; MODES.len()]) -> Value {
    let each = MODES.iter().zip(kept);
    each.map(|(mode, kept)| ((*mode).to_owned(), kept.report()))
        .collect()
}

/// Encodes and decodes in every mode; returns the reconstruction of the mean.
fn try_all(
    vae: &OccVae,
    fine: &OccVae,
    truth: &VoxelGrid,
    seed: u64,
    input: DecoderInput<'_>,
    kept: &mut [ReconstructionAgreement; MODES.len()],
) -> anyhow::Result<VoxelGrid> {
    let latent = vae.encode(truth)?;
    let mean = vae.decode(&latent)?;
    kept[0].add(truth, &mean);
    kept[TOLD].add(truth, &vae.decode_with(&latent, &[true; CELLS], input)?);
    kept[1].add(truth, &vae.decode(&vae.encode_sampled(truth, seed)?)?);
    kept[2].add(truth, &fine.decode(&fine.encode(truth)?)?);
    Ok(mean)
}

impl Options {
    /// Judges encoding and decoding of complete worlds and simulated labels.
    pub(crate) fn vae(
        &self,
        pipeline: &OccPipeline,
        progress: &dyn MeasurementProgress,
    ) -> anyhow::Result<SuiteFigures> {
        let (vae, fine) = (&pipeline.models().vae, fine_vae()?);
        let [mut complete, mut labels] = <[[ReconstructionAgreement; MODES.len()]; 2]>::default();
        let (mut agreement, mut slopes) = (AgreementCount::default(), Slopes::default());
        for i in 0..self.frames {
            progress.at("vae", i, self.frames);
            slopes.add_world(vae, TEST_SEED, i as u64)?;
            let world = occupancy_frame(TEST_SEED, i as u64, |_| None);
            let mut input = DecoderInput {
                draft: Some(&world.draft),
                observed: None,
            };
            let found = try_all(vae, &fine, &world.dense, i as u64, input, &mut complete)?;
            agreement.add(scene(i as u64).frame(), &found);
            input.observed = Some(&world.observed);
            try_all(vae, &fine, &world.labels, i as u64, input, &mut labels)?;
        }
        let bars = vec![
            ("complete miou", complete[0].miou(), 0.93),
            ("complete iou", complete[0].iou(), 0.95),
            ("labels miou", labels[0].miou(), 0.85),
            ("labels iou", labels[0].iou(), 0.83),
            ("labels miou, told", labels[TOLD].miou(), 0.88),
            ("labels iou, told", labels[TOLD].iou(), 0.86),
            ("labels miou, fine", labels[2].miou(), 0.95),
            ("labels iou, fine", labels[2].iou(), 0.92),
            ("labels miou kept on slopes", 1.0 - slopes.worst_loss(), 0.95),
        ];
        let mut report = json!({ "complete": report(&complete), "labels": report(&labels), "labels_on_slopes": slopes.report() });
        report["complete"]["layout_agreement_of_reconstructions"] = json!(agreement.iou());
        Ok((report, bars))
    }

    /// Judges encoding and decoding of labels from files; no bars, since what can be reached depends on the data.
    pub(crate) fn vae_on_files(
        &self,
        dir: &Path,
        pipeline: &OccPipeline,
        progress: &dyn MeasurementProgress,
    ) -> anyhow::Result<SuiteFigures> {
        let (vae, fine) = (&pipeline.models().vae, fine_vae()?);
        let (mut kept, mut slopes) = (
            <[ReconstructionAgreement; MODES.len()]>::default(),
            Slopes::default(),
        );
        let files = open::files_below(dir, "npz", "Occ3D frames")?;
        let used = &files[..files.len().min(self.frames)];
        for (i, path) in used.iter().enumerate() {
            progress.at("vae", i, used.len());
            let file = occ3d::load(path).with_context(|| path.display().to_string())?;
            let truth = file.labels;
            let (layout, boxes) = (infer::layout(&truth), infer::boxes(&truth));
            let draft = draft::draft(&layout, boxes.values());
            let observed = file.lidar_observed.as_deref().and_then(Unobserved::from_observed);
            let observed = observed.as_ref().map(Unobserved::observed);
            let input = DecoderInput {
                draft: Some(&draft),
                observed: observed.as_deref(),
            };
            try_all(vae, &fine, &truth, i as u64, input, &mut kept)?;
            slopes.add_tilted(vae, &truth, i as u64)?;
        }
        let report = json!({ "data": dir, "files": used.len(), "labels": report(&kept), "labels_tilted": slopes.report() });
        Ok((report, Vec::new()))
    }
}
