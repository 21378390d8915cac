//! Frames as safetensors shards, written so that an interrupted run can resume, or streamed to a reader.

use std::io::{Read, Write};
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicUsize, Ordering};

use rayon::prelude::*;
use safetensors::tensor::{Dtype, TensorView};

/// Number of frames in a shard.
pub const SHARD_FRAMES: usize = 32;

/// Frames, bytes and shards of a run that wrote a data set.
#[derive(Clone, Debug, Default, serde::Serialize)]
pub struct DatasetReport {
    /// Frames in the folder.
    pub frames: usize,
    /// Bytes written by this run.
    pub bytes: u64,
    /// Shards that were there already and were left alone.
    pub resumed_shards: usize,
}

/// A kind of frame that shards are made of.
pub trait Shard: Send + Sized {
    /// Names of its arrays.
    const ARRAYS: &'static [&'static str];

    /// Type, shape and bytes of each array, in that order, for some frames; the frames come first in the shape.
    fn arrays(frames: &[Self]) -> Vec<(Dtype, Vec<usize>, Vec<u8>)>;
}

/// Writes `frames` frames as `shard_NNNNN.safetensors` into `dir`. Shards that hold all arrays of their frames are
/// kept, so an interrupted run resumes, and a larger one adds to what is there. `make` makes frame i; its first error
/// ends the run. `progress` gets the number of finished frames and may end the run by returning false.
pub fn write<F: Shard, E: From<std::io::Error> + Send>(
    dir: &Path,
    frames: usize,
    make: impl Fn(usize) -> Result<F, E> + Sync,
    progress: impl Fn(usize) -> bool + Sync,
) -> Result<DatasetReport, E> {
    std::fs::create_dir_all(dir)?;
    let mut report = DatasetReport {
        frames,
        ..Default::default()
    };
    let done = AtomicUsize::new(0);
    for (shard, first) in (0..frames).step_by(SHARD_FRAMES).enumerate() {
        let path = dir.join(format!("shard_{shard:05}.safetensors"));
        let n = SHARD_FRAMES.min(frames - first);
        if is_complete(&path, F::ARRAYS, n) {
            report.resumed_shards += 1;
            done.fetch_add(n, Ordering::Relaxed);
            continue;
        }
        let made: Result<Vec<F>, E> = (first..first + n)
            .into_par_iter()
            .map(|i| {
                let frame = make(i)?;
                done.fetch_add(1, Ordering::Relaxed);
                Ok(frame)
            })
            .collect();
        let made = made?;
        report.bytes += write_shard(&path, &made)?;
        if !progress(done.load(Ordering::Relaxed)) {
            break;
        }
    }
    Ok(report)
}

/// True if a shard holds every array with at least `frames` frames. Shards of older versions lack arrays; a former last
/// shard may have fewer frames.
fn is_complete(path: &Path, arrays: &[&str], frames: usize) -> bool {
    let header = || -> Option<serde_json::Value> {
        let mut file = std::fs::File::open(path).ok()?;
        let mut length = [0; 8];
        file.read_exact(&mut length).ok()?;
        let length = u64::from_le_bytes(length).min(1 << 20);
        let mut header = Vec::new();
        file.take(length).read_to_end(&mut header).ok()?;
        serde_json::from_slice(&header).ok()
    };
    let holds = |h: &serde_json::Value, name: &str| {
        let count = h.pointer(&format!("/{name}/shape/0"));
        count
            .and_then(serde_json::Value::as_u64)
            .is_some_and(|n| n >= frames as u64)
    };
    header().is_some_and(|h| arrays.iter().all(|name| holds(&h, name)))
}

fn write_shard<F: Shard>(path: &PathBuf, frames: &[F]) -> std::io::Result<u64> {
    let bytes = shard_bytes(frames)?;
    let mut file = tempfile::NamedTempFile::new_in(path.parent().unwrap_or(Path::new(".")))?;
    file.write_all(&bytes)?;
    file.persist(path)?;
    Ok(bytes.len() as u64)
}

/// Bytes of a safetensors file with some frames.
pub fn shard_bytes<F: Shard>(frames: &[F]) -> std::io::Result<Vec<u8>> {
    let arrays = F::arrays(frames);
    let tensors: Result<Vec<_>, _> = F::ARRAYS
        .iter()
        .zip(&arrays)
        .map(|(name, (dtype, shape, data))| {
            let shape = [&[frames.len()], &shape[..]].concat();
            TensorView::new(*dtype, shape, data).map(|t| (*name, t))
        })
        .collect();
    tensors
        .and_then(|t| safetensors::serialize(t, None))
        .map_err(std::io::Error::other)
}

/// Streams shards of `per_shard` frames to a reader, each after its length as 8 little-endian bytes: frames `from` to
/// `to` in order. Ends without an error when the reader goes away. Returns the number of frames sent.
pub fn stream<F: Shard>(
    out: &mut impl Write,
    frames: std::ops::Range<u64>,
    per_shard: usize,
    make: impl Fn(u64) -> F + Sync,
) -> std::io::Result<u64> {
    let mut sent = 0;
    let mut next = frames.start;
    while next < frames.end {
        let last = (next + per_shard.max(1) as u64).min(frames.end);
        let made: Vec<F> = (next..last).into_par_iter().map(&make).collect();
        let bytes = shard_bytes(&made)?;
        let written = out
            .write_all(&(bytes.len() as u64).to_le_bytes())
            .and_then(|()| out.write_all(&bytes))
            .and_then(|()| out.flush());
        match written {
            Err(e) if e.kind() == std::io::ErrorKind::BrokenPipe => break,
            other => other?,
        }
        sent += last - next;
        next = last;
    }
    Ok(sent)
}

#[cfg(test)]
mod tests {
    use super::*;

    struct Small(u8);

    impl Shard for Small {
        const ARRAYS: &'static [&'static str] = &["value"];

        fn arrays(frames: &[Self]) -> Vec<(Dtype, Vec<usize>, Vec<u8>)> {
            vec![(Dtype::U8, Vec::new(), frames.iter().map(|f| f.0).collect())]
        }
    }

    /// A stream holds the shards one after another, each after its length, and a closed reader ends it quietly.
    #[test]
    fn a_stream_is_shards_after_their_lengths() {
        let mut bytes = Vec::new();
        let sent = stream(&mut bytes, 5..12, 3, |i| Small(i as u8)).expect("into memory");
        assert_eq!(sent, 7);
        let (mut at, mut values) = (0, Vec::new());
        while at < bytes.len() {
            let length = u64::from_le_bytes(bytes[at..at + 8].try_into().expect("8 bytes")) as usize;
            let shard = safetensors::SafeTensors::deserialize(&bytes[at + 8..at + 8 + length]);
            values.extend_from_slice(shard.expect("a shard").tensor("value").expect("its array").data());
            at += 8 + length;
        }
        assert_eq!(values, (5..12).collect::<Vec<u8>>());
        struct Closed;
        impl Write for Closed {
            fn write(&mut self, _: &[u8]) -> std::io::Result<usize> {
                Err(std::io::ErrorKind::BrokenPipe.into())
            }
            fn flush(&mut self) -> std::io::Result<()> {
                Ok(())
            }
        }
        assert_eq!(
            stream(&mut Closed, 0..9, 3, |i| Small(i as u8)).expect("quiet"),
            0
        );
    }

    /// A short last shard is written again when more frames are asked for, a full one is left alone; fewer ask for nothing.
    #[test]
    fn a_short_shard_is_not_complete_for_more_frames() {
        let folder = tempfile::tempdir().expect("a folder");
        let run = |frames| {
            let make = |i: usize| -> std::io::Result<Small> { Ok(Small(i as u8)) };
            write(folder.path(), frames, make, |_| true)
                .expect("written")
                .resumed_shards
        };
        let counts = || -> Vec<Vec<u8>> {
            let read =
                |shard: usize| std::fs::read(folder.path().join(format!("shard_{shard:05}.safetensors")));
            let values = |bytes: Vec<u8>| {
                let file = safetensors::SafeTensors::deserialize(&bytes).expect("a shard");
                file.tensor("value").expect("its array").data().to_vec()
            };
            (0..3).map_while(|s| read(s).ok()).map(values).collect()
        };
        assert_eq!(run(SHARD_FRAMES + 3), 0);
        assert_eq!(run(SHARD_FRAMES + 3), 2);
        assert_eq!(run(SHARD_FRAMES + 5), 1, "the second is short");
        assert_eq!(counts(), [(0..32).collect::<Vec<u8>>(), (32..37).collect()]);
        assert_eq!(run(2 * SHARD_FRAMES + 1), 1);
        assert_eq!(run(7), 1);
        assert_eq!(counts().iter().map(Vec::len).collect::<Vec<_>>(), [32, 32, 1]);
    }
}
