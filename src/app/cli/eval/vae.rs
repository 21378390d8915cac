//! `eval vae`: what encoding and decoding keep, of procedural worlds or of a folder of labels.

use std::collections::BTreeMap;
use std::path::Path;

use anyhow::Context;
use serde_json::{Value, json};

use super::{Bar, Eval, TEST_SEED, scene, with_interval};
use crate::app::cli::progress::Progress;
use crate::app::open;
use crate::formats::occ3d;
use crate::generation::dataset::{OccupancyFrame, occupancy_frame};
use crate::generation::metrics::agreement::AgreementCount;
use crate::generation::metrics::iou::Confusion;
use crate::generation::pipeline::OccPipeline;
use crate::scene::{Class, VoxelGrid};

impl Eval {
    /// Encode and decode: complete worlds and simulated labels.
    pub(super) fn vae(
        &self,
        pipeline: &OccPipeline,
        progress: &Progress,
    ) -> anyhow::Result<(Value, Vec<Bar>)> {
        let vae = &pipeline.models().vae;
        type Pick = fn(&OccupancyFrame) -> &VoxelGrid;
        let kinds: [(&str, Pick); 2] = [("complete", |f| &f.dense), ("labels", |f| &f.labels)];
        let mut totals = [Confusion::default(), Confusion::default()];
        let mut frames: [[Vec<f64>; 2]; 2] = Default::default();
        let mut agreement = AgreementCount::default();
        for i in 0..self.frames {
            progress.at("vae", i, self.frames);
            let world = occupancy_frame(TEST_SEED, i as u64, |_| None);
            for (k, (_, pick)) in kinds.iter().enumerate() {
                let truth = pick(&world);
                let found = vae.decode(&vae.encode(truth)?)?;
                if k == 0 {
                    agreement.add(scene(i as u64).frame(), &found);
                }
                let mut one = Confusion::default();
                one.add(truth, &found);
                totals[k].merge(&one);
                frames[k][0].extend(one.mean_iou().0);
                frames[k][1].extend(one.occupied_iou());
            }
        }
        let mut report = json!({});
        for (k, (name, _)) in kinds.iter().enumerate() {
            report[*name] = figures(&totals[k], &frames[k]);
        }
        report["complete"]["layout_agreement_of_reconstructions"] = json!(agreement.iou());
        let bars = vec![
            ("complete miou", totals[0].mean_iou().0.unwrap_or(f64::NAN), 0.75),
            ("complete iou", totals[0].occupied_iou().unwrap_or(f64::NAN), 0.80),
        ];
        Ok((report, bars))
    }

    /// The same for labels from files; no bars, since what can be reached depends on the data.
    pub(super) fn vae_on_files(
        &self,
        dir: &Path,
        pipeline: &OccPipeline,
        progress: &Progress,
    ) -> anyhow::Result<(Value, Vec<Bar>)> {
        let vae = &pipeline.models().vae;
        let (mut total, mut frames) = (Confusion::default(), [Vec::new(), Vec::new()]);
        let files = open::files_below(dir, "npz", "Occ3D frames")?;
        let used = &files[..files.len().min(self.frames)];
        for (i, path) in used.iter().enumerate() {
            progress.at("vae", i, used.len());
            let truth = occ3d::load(path)
                .with_context(|| path.display().to_string())?
                .labels;
            let mut one = Confusion::default();
            one.add(&truth, &vae.decode(&vae.encode(&truth)?)?);
            total.merge(&one);
            frames[0].extend(one.mean_iou().0);
            frames[1].extend(one.occupied_iou());
        }
        let report = json!({ "data": dir, "files": used.len(), "labels": figures(&total, &frames) });
        Ok((report, Vec::new()))
    }
}

/// mIoU and IoU over all frames, per frame and per class.
fn figures(total: &Confusion, frames: &[Vec<f64>; 2]) -> Value {
    let (mean, present) = total.mean_iou();
    let per_class: BTreeMap<&str, f64> = Class::ALL[..17]
        .iter()
        .filter_map(|c| Some((c.name(), (total.class_iou(*c)? * 1e3).round() / 1e3)))
        .collect();
    json!({
        "miou": mean,
        "iou": total.occupied_iou(),
        "classes_present": present,
        "miou_per_frame": with_interval(&frames[0]),
        "iou_per_frame": with_interval(&frames[1]),
        "per_class": per_class,
    })
}
