//! The command line: one subcommand per file. See README for the rules that all of them follow.

mod check;
mod dataset;
mod dataset_occ3d;
mod demo;
mod diff;
mod doctor;
mod edit;
mod eval;
mod export;
pub(crate) mod generate;
mod import;
mod new;
pub(crate) mod output;
mod progress;
mod prompt;
mod region_arg;
mod render;
mod scenery;
mod shot;
pub(crate) mod trade;
pub(crate) mod trials;
mod wrong;

use std::path::PathBuf;
use std::process::ExitCode;

pub(crate) use generate::full_params;

use clap::{Args, Parser, Subcommand};

use self::region_arg::RegionArg;
use crate::open;
use ::trade::Stops;
use diffusion::solver::SolverKind;
use job::{GenParams, Named, Precision, RegionMode};

/// Sceneloom: paint a driving scene's layout, edit boxes and voxels, see occupancy, cameras and LiDAR follow.
#[derive(Parser)]
#[command(name = "sceneloom", version, about, args_conflicts_with_subcommands = true)]
struct Cli {
    #[command(subcommand)]
    command: Option<Command>,
    /// Scene to open in the editor (.loom or .xodr); without one the bundled scene opens.
    scene: Option<PathBuf>,
    /// Write how fast the editor is (frames, edits, the worker's stages, processor time) as JSON lines, with a summary.
    #[arg(long, value_name = "FILE")]
    trace: Option<PathBuf>,
}

#[derive(Subcommand)]
enum Command {
    /// The main job without a window: edits of the bundled scene, regenerated, with pictures and a report.
    Demo(demo::Demo),
    /// A scene from a procedural world.
    New(new::New),
    /// A scene from a road network (OpenDRIVE).
    Import(import::Import),
    /// A scene from words, or an edit of a scene by words.
    Prompt(prompt::Prompt),
    /// Occupancy from layout and boxes.
    Generate(generate::Generate),
    /// Apply edits and regenerate what they touch, by inversion.
    Edit(edit::EditCommand),
    /// What stands beside the roads, drawn anew by rules or by a network: everywhere or in a region.
    Scenery(scenery::Scenery),
    /// Pictures of what the sensors see.
    Render(render::Render),
    /// The 3D viewport alone, off screen.
    Shot(shot::Shot),
    /// The quality checks; exit 1 if one of severity error fires.
    Check(check::Check),
    /// What differs between two scenes.
    Diff(diff::Diff),
    /// Files for other programs.
    Export(export::Export),
    /// Training and evaluation data from procedural worlds.
    Dataset(dataset::Dataset),
    /// Held-out quality.
    Eval(eval::Eval),
    /// What each knob of speed and accuracy costs and buys, measured on this machine.
    Trade(trade::Trade),
    /// What this machine offers.
    Doctor(doctor::Doctor),
}

/// Options that every command has.
#[derive(Args, Clone, Debug, Default)]
pub(crate) struct Common {
    /// Print exactly one JSON object on stdout at the end.
    #[arg(long)]
    json: bool,
    /// Show progress on stderr even when it is not a terminal.
    #[arg(long)]
    progress: bool,
    /// Folder of weights (occ_vae.safetensors, occ_dit.safetensors) instead of the bundled ones.
    #[arg(long, value_name = "DIR", global = true)]
    weights: Option<PathBuf>,
}

/// Knobs of a generation.
#[derive(Args, Clone, Debug)]
struct Gen {
    /// Steps of the sampler.
    #[arg(long, value_name = "N")]
    steps: Option<u32>,
    /// Method of the sampler: ddim, dpmpp2m, unipc, or obelm, whose inversion is exact.
    #[arg(long)]
    solver: Option<SolverKind>,
    /// Classifier-free guidance weight; 1 means none.
    #[arg(long, value_name = "W")]
    guidance: Option<f64>,
    /// How far guided predictions are scaled back to the spread of the unguided ones, 0 to 1.
    #[arg(long, value_name = "R")]
    guidance_rescale: Option<f64>,
    /// How much grows beside the road, 0 to 1; not named, the networks choose, or an edit keeps it.
    #[arg(long, value_name = "D")]
    vegetation: Option<f32>,
    /// How much is built beside the road, 0 to 1.
    #[arg(long, value_name = "D")]
    buildings: Option<f32>,
    /// How much low furniture stands beside the road, 0 to 1.
    #[arg(long, value_name = "D")]
    clutter: Option<f32>,
    /// Share of columns that hold anything: 1 complete (the default for all of a scene), about 0.4 as real labels are.
    #[arg(long, value_name = "D")]
    completeness: Option<f32>,
    /// Fixes every random draw.
    #[arg(long, default_value_t = 0)]
    seed: u64,
    /// What is regenerated: `auto`, what an edit touches; `full`, everything from fresh noise; or `X0,Y0,X1,Y1`, what
    /// an edit touches and a rectangle (ego frame, m; give it a strength above 0).
    #[arg(long, value_name = "REGION", allow_hyphen_values = true)]
    region: Option<RegionArg>,
    /// Number of fixed-point updates per inversion step.
    #[arg(long, value_name = "N")]
    inversion_iterations: Option<u32>,
    /// Draw the region anew, from fresh noise at this share of the steps, 0 to 1: 1 keeps nothing of what was there; 0, the
    /// default, starts from the noise that its source comes from.
    #[arg(long, value_name = "S", default_value_t = 0.0)]
    strength: f64,
    /// Compute every token, not only those around an edit.
    #[arg(long)]
    dense: bool,
    /// A stop of the measured trade: `draft`, `balanced`, `accurate` or another that `sceneloom trade` names; the
    /// options beside it go first.
    #[arg(long, value_name = "STOP")]
    quality: Option<String>,
    /// In what the network's products are computed: f32, or int8, which is faster where the machine has AVX-512 VNNI.
    #[arg(long, value_parser = ["f32", "int8"])]
    precision: Option<String>,
    /// Steps in which what the coarse latent decodes to is refined, down to single voxels; 0 leaves it.
    #[arg(long, value_name = "N")]
    fine_steps: Option<u32>,
    /// Leave out the corrections of the networks' output: placed boxes, painted ground, inventions, what hangs, holes.
    #[arg(long)]
    raw: bool,
}

impl Gen {
    fn params(&self, default: GenParams) -> anyhow::Result<GenParams> {
        let default = match &self.quality {
            Some(name) => {
                let stops = Stops::bundled();
                let Some(stop) = stops.named(name) else {
                    let names: Vec<&str> = stops.stops.iter().map(|s| s.name.as_str()).collect();
                    anyhow::bail!("--quality {name}: expected one of {}", names.join(", "));
                };
                stop.knobs.on(default)
            }
            None => default,
        };
        Ok(GenParams {
            steps: self.steps.unwrap_or(default.steps),
            solver: self.solver.unwrap_or(default.solver),
            guidance: self.guidance.unwrap_or(default.guidance),
            guidance_rescale: self.guidance_rescale.unwrap_or(default.guidance_rescale),
            named: Named {
                vegetation: self.vegetation,
                building: self.buildings,
                clutter: self.clutter,
                completeness: self.completeness,
            }
            .or_else(&default.named),
            seed: self.seed,
            region: match self.region {
                Some(RegionArg::Full) => RegionMode::Full,
                Some(_) => RegionMode::Auto,
                None => default.region,
            },
            redraw: match self.region {
                Some(RegionArg::Rect(mask)) => mask,
                _ => default.redraw,
            },
            inversion_iterations: self.inversion_iterations.unwrap_or(default.inversion_iterations),
            fine_steps: self.fine_steps.unwrap_or(default.fine_steps),
            strength: self.strength,
            keep_objects: !self.raw,
            local: !self.dense && default.local,
            precision: match self.precision.as_deref() {
                Some("int8") => Precision::Int8,
                Some(_) => Precision::F32,
                None => default.precision,
            },
            ..default
        })
    }
}

/// Why a command ends other than well.
enum Stop {
    /// It ran, and what was checked fell short: exit 1.
    Short(String),
    /// Bad input or arguments: one line, exit 2.
    Bad(anyhow::Error),
}

impl<E: Into<anyhow::Error>> From<E> for Stop {
    fn from(error: E) -> Self {
        Stop::Bad(error.into())
    }
}

type Outcome = Result<(), Stop>;

/// Whether a command line can be parsed, program name first; the message that a user would see if not. Runs nothing.
pub fn accepts(arguments: impl IntoIterator<Item = std::ffi::OsString>) -> Result<(), String> {
    let parsed = Cli::try_parse_from(arguments);
    parsed.map(|_| ()).map_err(|e| wrong::message(&e))
}

/// What reads our output may end early (`| head`): then the program ends too, as others do, and says nothing.
fn quiet_when_nobody_reads() {
    let loud = std::panic::take_hook();
    std::panic::set_hook(Box::new(move |info| {
        let said = info.payload_as_str().unwrap_or_default();
        if said.starts_with("failed printing to stdout") && said.contains("Broken pipe") {
            std::process::exit(141);
        }
        loud(info);
    }));
}

/// Parses the arguments, runs the command or the editor, prints an error once; the exit code of the process.
pub fn main() -> ExitCode {
    quiet_when_nobody_reads();
    let cli = match Cli::try_parse() {
        Ok(cli) => cli,
        Err(error) => {
            // --help and --version come this way too, with exit 0; bad arguments with 2.
            match error.use_stderr() {
                true => eprint!("{}", wrong::message(&error)),
                false => drop(error.print()),
            }
            return ExitCode::from(u8::try_from(error.exit_code()).unwrap_or(2));
        }
    };
    let outcome = match cli.command {
        Some(Command::Demo(c)) => c.run(),
        Some(Command::New(c)) => c.run(),
        Some(Command::Scenery(c)) => c.run(),
        Some(Command::Import(c)) => c.run(),
        Some(Command::Prompt(c)) => c.run(),
        Some(Command::Generate(c)) => c.run(),
        Some(Command::Edit(c)) => c.run(),
        Some(Command::Render(c)) => c.run(),
        Some(Command::Shot(c)) => c.run(),
        Some(Command::Check(c)) => c.run(),
        Some(Command::Diff(c)) => c.run(),
        Some(Command::Export(c)) => c.run(),
        Some(Command::Dataset(c)) => c.run(),
        Some(Command::Eval(c)) => c.run(),
        Some(Command::Trade(c)) => c.run(),
        Some(Command::Doctor(c)) => c.run(),
        None => editor(cli.scene, cli.trace),
    };
    match outcome {
        Ok(()) => ExitCode::SUCCESS,
        Err(Stop::Short(what)) => {
            eprintln!("sceneloom: {what}");
            ExitCode::from(1)
        }
        Err(Stop::Bad(error)) => {
            eprintln!("sceneloom: {}", output::one_line(&error));
            ExitCode::from(2)
        }
    }
}

fn editor(path: Option<PathBuf>, trace: Option<PathBuf>) -> Outcome {
    let scene = match &path {
        Some(path) => open::scene(path)?,
        None => open::bundled()?,
    };
    if !doctor::has_display() {
        eprintln!("no display: running the demo without a window");
        return demo::Demo::default().run();
    }
    crate::run_window(scene, path, trace)?;
    Ok(())
}
