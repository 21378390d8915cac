//! Variants in tars, as WebDataset reads them: files of one sample follow each other and share their name up to the
//! first dot.

use std::path::{Path, PathBuf};

use anyhow::Context;

use super::record::{FILE, VariantRecord};
use formats::{atomic, input};
use scene::plain_name;

/// Name of a pack without its ending.
fn stem(pack: usize) -> String {
    format!("shard-{pack:06}")
}

fn tar_of(output: &Path, pack: usize) -> PathBuf {
    output.join(stem(pack) + ".tar")
}

/// File with the records of the variants in a pack. It is written before the tar, so a tar that exists has its records.
fn records_of(output: &Path, pack: usize) -> PathBuf {
    output.join(stem(pack) + ".json")
}

/// True if a pack is complete.
pub fn is_there(output: &Path, pack: usize) -> bool {
    tar_of(output, pack).exists()
}

/// Reads the records of the variants in a pack.
pub fn records(output: &Path, pack: usize) -> anyhow::Result<Vec<VariantRecord>> {
    let path = records_of(output, pack);
    let text = input::read_text(&path, input::LARGEST_TEXT)?;
    serde_json::from_str(&text).with_context(|| path.display().to_string())
}

/// Moves variants from their folders into a tar and removes the folders. Files are named `000012.FORMAT.FILE`, files of
/// a clip's later frames `000012_f0003.FORMAT.FILE`. The same variants give the same bytes: no times, no owners.
pub fn write(output: &Path, pack: usize, records: &[VariantRecord]) -> anyhow::Result<()> {
    let text = serde_json::to_string_pretty(records)?;
    atomic::write(&records_of(output, pack), text.as_bytes())?;
    let half = output.join(format!(".{}.tar", stem(pack)));
    // (a tar that an interrupted run left, or a link that leads elsewhere)
    if half.symlink_metadata().is_ok() {
        std::fs::remove_file(&half).with_context(|| format!("remove {}", half.display()))?;
    }
    let file = std::fs::File::create_new(&half).with_context(|| format!("create {}", half.display()))?;
    let mut tar = tar::Builder::new(std::io::BufWriter::new(file));
    for record in records.iter().filter(|r| r.failed.is_none()) {
        let folder = output.join(format!("{:06}", record.variant));
        let mut add = |path: &str| -> anyhow::Result<()> {
            // (records may come from a file that someone else made)
            path.split('/')
                .try_for_each(plain_name::check_file)
                .with_context(|| record.variant.to_string())?;
            let place = folder.join(path);
            let bytes = std::fs::read(&place).with_context(|| place.display().to_string())?;
            let mut header = tar::Header::new_ustar();
            header.set_size(bytes.len() as u64);
            header.set_mode(0o644);
            header.set_mtime(0);
            Ok(tar.append_data(&mut header, name_of(record.variant, path), bytes.as_slice())?)
        };
        // The files of a sample follow each other: first those of the first moment with the variant's own files, then
        // the others.
        let mut names: Vec<&str> = record.files.iter().map(|f| f.path.as_str()).collect();
        names.push(FILE);
        names.sort_by_key(|path| (frame_of(path), *path));
        names.into_iter().try_for_each(&mut add)?;
    }
    tar.into_inner()?
        .into_inner()
        .map_err(|e| e.into_error())?
        .sync_all()?;
    std::fs::rename(&half, tar_of(output, pack)).with_context(|| format!("rename {}", half.display()))?;
    for record in records {
        let folder = output.join(format!("{:06}", record.variant));
        if folder.exists() {
            std::fs::remove_dir_all(&folder).with_context(|| format!("remove {}", folder.display()))?;
        }
        let failed = output.join(format!("{:06}.failed.json", record.variant));
        if failed.exists() {
            std::fs::remove_file(&failed)?;
        }
    }
    Ok(())
}

/// The frame of a clip that a file belongs to: `f0003/occ3d/labels.npz` belongs to frame 3.
fn frame_of(path: &str) -> usize {
    let first = path.split('/').next().unwrap_or("");
    let number = first
        .strip_prefix('f')
        .filter(|n| n.len() >= 4 && path.contains('/'));
    number.and_then(|n| n.parse().ok()).unwrap_or(0)
}

/// The name of a variant's file in the tar.
fn name_of(variant: usize, path: &str) -> String {
    match (frame_of(path), path.split_once('/')) {
        (0, _) => {
            let own = path.strip_prefix("f0000/").unwrap_or(path);
            format!("{variant:06}.{}", own.replace('/', "."))
        }
        (frame, Some((_, rest))) => format!("{variant:06}_f{frame:04}.{}", rest.replace('/', ".")),
        (_, None) => format!("{variant:06}.{path}"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn files_of_a_sample_share_their_name_up_to_the_dot() {
        assert_eq!(name_of(7, "occ3d/labels.npz"), "000007.occ3d.labels.npz");
        assert_eq!(
            name_of(7, "f0000/truth/CAM_FRONT.png"),
            "000007.truth.CAM_FRONT.png"
        );
        assert_eq!(
            name_of(7, "f0012/truth/CAM_FRONT.png"),
            "000007_f0012.truth.CAM_FRONT.png"
        );
        assert_eq!(name_of(7, "variant.json"), "000007.variant.json");
    }
}
