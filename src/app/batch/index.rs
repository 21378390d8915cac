//! The index of a batch: a Parquet table with a row for each variant, and a sheet of small pictures.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

use anyhow::Context;

use super::marks::Marks;
use super::plan::BatchPlan;
use super::record::VariantRecord;
use super::thumb;
use crate::picture::RgbaPicture;
use formats::table::{self, ColumnValues, ParquetField};
use formats::{atomic, png};

/// Names of the files.
const FILE: &str = "index.parquet";
const SHEET: &str = "contact.png";
/// Most variants on the sheet, and how many stand in a row.
const MOST: usize = 120;
const COLUMNS: usize = 4;

/// Writes the index and, where variants lie in folders, the contact sheet. Returns the path of the index.
pub fn write(
    output: &Path,
    plan: &BatchPlan,
    records: &[VariantRecord],
    marks: &Marks,
) -> anyhow::Result<PathBuf> {
    let path = output.join(FILE);
    let bytes = table::to_bytes(records.len(), &fields(plan, records, marks))?;
    atomic::write(&path, &bytes).with_context(|| format!("write {}", path.display()))?;
    if plan.pack.is_none() {
        sheet(output, records)?;
    }
    Ok(path)
}

fn fields(plan: &BatchPlan, records: &[VariantRecord], marks: &Marks) -> Vec<ParquetField> {
    let texts = |of: &dyn Fn(&VariantRecord) -> String| ColumnValues::Text(records.iter().map(of).collect());
    let numbers =
        |of: &dyn Fn(&VariantRecord) -> i64| ColumnValues::Integer(records.iter().map(of).collect());
    let flags =
        |of: &BTreeSet<usize>| ColumnValues::Flag(records.iter().map(|r| of.contains(&r.variant)).collect());
    let json = |value: &dyn Fn(&VariantRecord) -> serde_json::Result<String>| {
        texts(&|r| value(r).unwrap_or_default())
    };
    let shard = |r: &VariantRecord| {
        plan.pack
            .map_or_else(String::new, |size| format!("shard-{:06}.tar", r.variant / size))
    };
    let found = |r: &VariantRecord, errors: bool| {
        let count = |f: &super::record::Findings| if errors { f.errors } else { f.warnings };
        r.findings.as_ref().map_or(0, |f| count(f) as i64)
    };
    let columns = [
        ("variant", numbers(&|r| r.variant as i64)),
        ("key", texts(&|r| format!("{:06}", r.variant))),
        ("shard", texts(&shard)),
        (
            "seed",
            ColumnValues::Unsigned(records.iter().map(|r| r.seed).collect()),
        ),
        ("scene_sha256", texts(&|r| r.scene_sha256.clone())),
        ("changes", json(&|r| serde_json::to_string(&r.changes))),
        ("conditions", json(&|r| serde_json::to_string(&r.conditions))),
        ("box_count", numbers(&|r| r.boxes.len() as i64)),
        ("boxes", json(&|r| serde_json::to_string(&r.boxes))),
        ("frames", numbers(&|r| r.frames as i64)),
        ("errors", numbers(&|r| found(r, true))),
        ("warnings", numbers(&|r| found(r, false))),
        ("checks", json(&|r| serde_json::to_string(&r.findings))),
        (
            "files",
            ColumnValues::Texts(
                records
                    .iter()
                    .map(|r| r.files.iter().map(|f| f.path.clone()).collect())
                    .collect(),
            ),
        ),
        (
            "bytes",
            numbers(&|r| r.files.iter().map(|f| f.bytes as i64).sum()),
        ),
        ("failed", texts(&|r| r.failed.clone().unwrap_or_default())),
        ("starred", flags(&marks.starred)),
        ("discarded", flags(&marks.discarded)),
    ];
    columns
        .into_iter()
        .map(|(name, values)| ParquetField::Values(name, values))
        .collect()
}

/// The small pictures of the first variants, in the order of their numbers.
fn sheet(output: &Path, records: &[VariantRecord]) -> anyhow::Result<()> {
    let made = records.iter().filter(|r| r.failed.is_none()).take(MOST);
    let pictures: Vec<RgbaPicture> = made
        .filter_map(|r| {
            let path = output.join(format!("{:06}", r.variant)).join(thumb::FILE);
            let image = image::open(path).ok()?.to_rgba8();
            Some(RgbaPicture {
                width: image.width() as usize,
                height: image.height() as usize,
                rgba: image.into_raw(),
            })
        })
        .collect();
    if pictures.is_empty() {
        return Ok(());
    }
    let rows: Vec<Vec<RgbaPicture>> = pictures.chunks(COLUMNS).map(<[RgbaPicture]>::to_vec).collect();
    let all = RgbaPicture::sheet(&rows, 6);
    let bytes = png::rgba(all.width, all.height, &all.rgba, &png::Notes::default())?;
    atomic::write(&output.join(SHEET), &bytes).context("write the contact sheet")
}
