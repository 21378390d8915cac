//! `sceneloom-worlds`: frames of procedural worlds for training, into a folder of shards or as a stream.

use std::io::Write;
use std::path::PathBuf;
use std::time::Instant;

use anyhow::{Context, bail};
use clap::{Parser, ValueEnum};

use dataset::perception::perception_frame;
use dataset::picture_pairs::{Look, Quality, picture_pair};
use dataset::sensors_pair::sensors_pair;
use dataset::{occupancy_frame, shard};

/// What the frames hold.
#[derive(Clone, Copy, PartialEq, ValueEnum)]
enum Kind {
    /// Complete voxels, simulated labels, draft, layout and headings.
    Occupancy,
    /// Two moments of a drive as six cameras see them, and what the voxels tell of each pixel.
    Pictures,
    /// One LiDAR sweep, the boxes around it, and what stands in each column.
    Perception,
    /// One LiDAR sweep, six pictures, and every voxel.
    Sensors,
}

/// Frames of procedural worlds.
#[derive(Parser)]
struct Args {
    /// What the frames hold.
    #[arg(long, value_enum, default_value = "occupancy")]
    kind: Kind,
    /// Size of pictures, px.
    #[arg(long, value_name = "WxH", value_parser = size, default_value = "256x144")]
    size: [u32; 2],
    /// One sample a pixel: three times as fast, with rougher edges.
    #[arg(long)]
    preview: bool,
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
    if args.output.is_none() && !args.stream {
        bail!("-o DIR or --stream is missing: where should the frames go?");
    }
    if let Some(threads) = args.threads {
        rayon::ThreadPoolBuilder::new()
            .num_threads(threads)
            .build_global()?;
    }
    let look = Look {
        size_px: args.size,
        quality: match args.preview {
            true => Quality::Preview,
            false => Quality::Full,
        },
    };
    let start = Instant::now();
    let made = match args.kind {
        Kind::Occupancy => send(&args, to, |i| occupancy_frame(args.seed, i, |_| None))?,
        Kind::Pictures => send(&args, to, |i| picture_pair(args.seed, i, look, |_| None))?,
        Kind::Perception => send(&args, to, |i| perception_frame(args.seed, i, |_| None))?,
        Kind::Sensors => send(&args, to, |i| sensors_pair(args.seed, i, look, |_| None))?,
    };
    let rate = made as f64 / start.elapsed().as_secs_f64();
    let _ = writeln!(std::io::stderr(), "\r{made} frames, {rate:.1} frames/s");
    Ok(())
}

/// Frames up to `to`, into a folder or as a stream; how many.
fn send<F: shard::Shard>(args: &Args, to: u64, make: impl Fn(u64) -> F + Sync) -> anyhow::Result<u64> {
    let Some(dir) = &args.output else {
        let mut out = std::io::stdout().lock();
        return shard::stream(&mut out, args.from..to, args.per_shard, make).context("standard output");
    };
    let frame = |i: usize| -> std::io::Result<_> { Ok(make(args.from + i as u64)) };
    let report = shard::write(dir, args.frames as usize, frame, |done| {
        let _ = write!(std::io::stderr(), "\r{done} of {} frames", args.frames);
        true
    });
    Ok(report.with_context(|| format!("write {}", dir.display()))?.frames as u64)
}

/// `WxH`.
fn size(text: &str) -> Result<[u32; 2], String> {
    let parts = text.split_once('x');
    let parsed = parts.and_then(|(w, h)| Some([w.parse().ok()?, h.parse().ok()?]));
    parsed
        .filter(|[w, h]| (1..=4096).contains(w) && (1..=4096).contains(h))
        .ok_or_else(|| format!("{text:?}, expected two numbers from 1 to 4096 as in 256x144"))
}
