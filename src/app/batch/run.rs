//! Runs a plan. Variants that exist are kept, failures are recorded, and variants that a killed run left incomplete are
//! made again.

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::{Path, PathBuf};

use anyhow::{Context, bail};

use super::index;
use super::make::Maker;
use super::marks::Marks;
use super::pack;
use super::plan::BatchPlan;
use super::record::{FILE, VariantRecord};
use formats::{atomic, input};
use scene::Scene;

/// Name of the plan's copy in the output folder.
const PLAN: &str = "plan.json";

/// A part of a batch: every `of`th variant, or with packs every `of`th pack.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Shard {
    /// Number of the shard, from 0.
    pub number: usize,
    /// Number of shards.
    pub of: usize,
}

impl Default for Shard {
    /// The whole batch.
    fn default() -> Self {
        Self { number: 0, of: 1 }
    }
}

impl std::str::FromStr for Shard {
    type Err = String;

    /// Parses `I/N`, I from 0.
    fn from_str(text: &str) -> Result<Self, String> {
        let parts = text
            .split_once('/')
            .map(|(i, n)| (i.parse().ok(), n.parse().ok()));
        match parts {
            Some((Some(number), Some(of))) if number < of => Ok(Self { number, of }),
            _ => Err("expected I/N with I from 0 below N, such as 0/4".into()),
        }
    }
}

/// Progress of a run.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct BatchProgress {
    /// The variant that was just handled.
    pub variant: usize,
    /// Number of variants of this shard that are ready or failed.
    pub done: usize,
    /// Number of variants of this shard.
    pub of: usize,
    /// The reason why it failed, if it did.
    pub failed: Option<String>,
}

/// The result of a run.
#[derive(Clone, Debug, Default, PartialEq, serde::Serialize)]
pub struct BatchReport {
    /// Number of variants of the plan.
    pub variants: usize,
    /// Variants made in this run.
    pub made: usize,
    /// Variants that were there already.
    pub kept: usize,
    /// Variants that could not be made: number and reason.
    pub failed: Vec<(usize, String)>,
    /// Number of variants that are not ready yet: of other shards, or left by a stop.
    pub open: usize,
    /// The index, once all variants are ready or failed.
    pub index: Option<PathBuf>,
}

/// A plan and the folder of its variants.
pub struct Batch {
    maker: Maker,
    output: PathBuf,
}

impl Batch {
    /// A batch for a plan. `folder` is the folder of the plan. Makes the output folder and keeps a copy of the plan
    /// there. Errors if the output folder belongs to another plan.
    pub fn new(plan: BatchPlan, folder: &Path, output: &Path) -> anyhow::Result<Self> {
        let maker = Maker::new(plan, folder)?;
        claim(maker.plan(), output)?;
        Ok(Self {
            maker,
            output: output.into(),
        })
    }

    /// The plan.
    pub fn plan(&self) -> &BatchPlan {
        self.maker.plan()
    }

    /// The scene of a variant, made anew.
    pub fn scene(&self, variant: usize) -> anyhow::Result<Scene> {
        self.maker.scene(variant)
    }

    /// Folder of a variant.
    pub fn folder_of(&self, variant: usize) -> PathBuf {
        self.output.join(format!("{variant:06}"))
    }

    fn failed_file(&self, variant: usize) -> PathBuf {
        self.output.join(format!("{variant:06}.failed.json"))
    }

    /// Makes the variants that a shard lacks. `tell` is called after each variant and returns whether to go on.
    /// Variants that failed before are tried again. Errors if files cannot be written.
    pub fn run(
        &self,
        shard: Shard,
        tell: &mut dyn FnMut(&BatchProgress) -> bool,
    ) -> anyhow::Result<BatchReport> {
        let plan = self.plan();
        let size = plan.pack.unwrap_or(1);
        let packs = plan.count().div_ceil(size);
        let mine: Vec<usize> = (0..packs).filter(|p| p % shard.of == shard.number).collect();
        let variants_of = |pack: usize| pack * size..((pack + 1) * size).min(plan.count());
        let of = mine.iter().map(|p| variants_of(*p).len()).sum();
        let mut report = BatchReport {
            variants: plan.count(),
            ..BatchReport::default()
        };
        let mut done = 0;
        'packs: for pack in mine {
            if plan.pack.is_some() && pack::is_there(&self.output, pack) {
                report.kept += variants_of(pack).len();
                done += variants_of(pack).len();
                continue;
            }
            for variant in variants_of(pack) {
                let kept = self.folder_of(variant).join(FILE).exists();
                let failed = if kept { None } else { self.variant(variant)? };
                match &failed {
                    Some(reason) => report.failed.push((variant, reason.clone())),
                    None if kept => report.kept += 1,
                    None => report.made += 1,
                }
                done += 1;
                let progress = BatchProgress {
                    variant,
                    done,
                    of,
                    failed,
                };
                if !tell(&progress) {
                    break 'packs;
                }
            }
            if plan.pack.is_some() {
                pack::write(&self.output, pack, &self.records(variants_of(pack))?)?;
            }
        }
        self.finish(&mut report)?;
        Ok(report)
    }

    /// Makes one variant. Returns the reason if it cannot be made. Errors if files cannot be written.
    fn variant(&self, variant: usize) -> anyhow::Result<Option<String>> {
        let (folder, half) = (
            self.folder_of(variant),
            self.output.join(format!(".making-{variant:06}")),
        );
        for left in [&half, &folder] {
            if left.exists() {
                std::fs::remove_dir_all(left).with_context(|| format!("remove {}", left.display()))?;
            }
        }
        std::fs::create_dir(&half).with_context(|| format!("create {}", half.display()))?;
        let made = catch_unwind(AssertUnwindSafe(|| self.maker.make(variant, &half)));
        let reason = match made {
            Ok(Ok(_)) => None,
            Ok(Err(error)) => Some(scene::message::one_line(&format_args!("{error:#}"))),
            Err(panic) => Some(format!("a fault of the program: {}", said(&*panic))),
        };
        let failed = self.failed_file(variant);
        if let Some(reason) = &reason {
            std::fs::remove_dir_all(&half).with_context(|| format!("remove {}", half.display()))?;
            let record = VariantRecord {
                variant,
                changes: self.maker.changes(variant),
                failed: Some(reason.clone()),
                ..VariantRecord::default()
            };
            atomic::write(&failed, serde_json::to_string_pretty(&record)?.as_bytes())?;
            return Ok(Some(reason.clone()));
        }
        std::fs::rename(&half, &folder).with_context(|| format!("rename to {}", folder.display()))?;
        if failed.exists() {
            std::fs::remove_file(&failed).with_context(|| format!("remove {}", failed.display()))?;
        }
        Ok(None)
    }

    /// Reads the records of variants that are ready or failed and lie in folders.
    fn records(&self, variants: std::ops::Range<usize>) -> anyhow::Result<Vec<VariantRecord>> {
        let read = |variant| {
            let own = self.folder_of(variant).join(FILE);
            let path = if own.exists() {
                own
            } else {
                self.failed_file(variant)
            };
            let text = input::read_text(&path, input::LARGEST_TEXT)?;
            serde_json::from_str(&text).with_context(|| path.display().to_string())
        };
        variants.map(read).collect()
    }

    /// Writes the index and the contact sheet once every variant is ready or failed.
    fn finish(&self, report: &mut BatchReport) -> anyhow::Result<()> {
        let plan = self.plan();
        let ready = |v: usize| match plan.pack {
            Some(size) => pack::is_there(&self.output, v / size),
            None => self.folder_of(v).join(FILE).exists() || self.failed_file(v).exists(),
        };
        report.open = (0..plan.count()).filter(|v| !ready(*v)).count();
        if report.open > 0 {
            return Ok(());
        }
        let records = match plan.pack {
            Some(size) => {
                let packs = 0..plan.count().div_ceil(size);
                let all: anyhow::Result<Vec<Vec<VariantRecord>>> =
                    packs.map(|p| pack::records(&self.output, p)).collect();
                all?.concat()
            }
            None => self.records(0..plan.count())?,
        };
        let marks = Marks::read(&self.output)?;
        report.index = Some(index::write(&self.output, plan, &records, &marks)?);
        Ok(())
    }
}

/// Makes the output folder and keeps a copy of the plan there. Errors if the folder belongs to another plan.
pub fn claim(plan: &BatchPlan, output: &Path) -> anyhow::Result<()> {
    std::fs::create_dir_all(output).with_context(|| format!("create {}", output.display()))?;
    let copy = output.join(PLAN);
    let text = serde_json::to_string_pretty(plan)?;
    if copy.exists() {
        let there = input::read_text(&copy, input::LARGEST_TEXT)?;
        if there != text {
            bail!(
                "{}: the folder belongs to another plan, expected an empty one",
                output.display()
            );
        }
    } else {
        atomic::write(&copy, text.as_bytes()).with_context(|| format!("write {}", copy.display()))?;
    }
    Ok(())
}

/// The message of a panic, on one line.
fn said(panic: &(dyn std::any::Any + Send)) -> String {
    let text = panic.downcast_ref::<String>().map(String::as_str);
    let text = text
        .or(panic.downcast_ref::<&str>().copied())
        .unwrap_or("no reason");
    scene::message::one_line(&text)
}
