//! `sceneloom-worlds`: frames of procedural worlds for training, into a folder of shards or as a stream.

use std::io::Write;
use std::path::PathBuf;
use std::time::Instant;

use anyhow::{Context, bail};
use clap::Parser;

use dataset::{occupancy_frame, shard};

/// Frames of procedural worlds: complete voxels, simulated labels, draft, layout and headings.
#[derive(Parser)]
struct Args {
    /// Number of frames.
    #[arg(long, default_value_t = 1024)]
    frames: u64,
    /// First frame; frames of one seed are all distinct.
    #[arg(long, default_value_t = 0)]
    from: u64,
    /// Seed of the data set: 1 trains, 2 validates, 3 is for `sceneloom eval` alone.
    #[arg(long, default_value_t = 1)]
    seed: u64,
    /// Folder of shards to write or resume.
    #[arg(short, long, conflicts_with = "stream")]
    output: Option<PathBuf>,
    /// Write shards to standard output, each after its length as 8 little-endian bytes.
    #[arg(long)]
    stream: bool,
    /// Frames per streamed shard.
    #[arg(long, default_value_t = 8)]
    per_shard: usize,
    /// Threads; all cores if left out.
    #[arg(long)]
    threads: Option<usize>,
}

fn main() {
    if let Err(e) = run(Args::parse()) {
        let _ = writeln!(std::io::stderr(), "sceneloom-worlds: {e:#}");
        std::process::exit(2);
    }
}

fn run(args: Args) -> anyhow::Result<()> {
    if args.seed == 3 {
        bail!("--seed 3 is for `sceneloom eval` alone, expected another");
    }
    let Some(to) = args.from.checked_add(args.frames) else {
        bail!("--from {} and --frames {} exceed 64 bits", args.from, args.frames);
    };
    if let Some(threads) = args.threads {
        rayon::ThreadPoolBuilder::new()
            .num_threads(threads)
            .build_global()?;
    }
    let make = |index: u64| occupancy_frame(args.seed, index, |_| None);
    let start = Instant::now();
    let made = match (&args.output, args.stream) {
        (Some(dir), _) => {
            let frame = |i: usize| -> std::io::Result<_> { Ok(make(args.from + i as u64)) };
            let report = shard::write(dir, args.frames as usize, frame, |done| {
                let _ = write!(std::io::stderr(), "\r{done} of {} frames", args.frames);
                true
            });
            report.with_context(|| format!("write {}", dir.display()))?.frames as u64
        }
        (None, true) => {
            let mut out = std::io::stdout().lock();
            shard::stream(&mut out, args.from..to, args.per_shard, make).context("standard output")?
        }
        (None, false) => bail!("-o DIR or --stream is missing: where should the frames go?"),
    };
    let rate = made as f64 / start.elapsed().as_secs_f64();
    let _ = writeln!(std::io::stderr(), "\r{made} frames, {rate:.1} frames/s");
    Ok(())
}
