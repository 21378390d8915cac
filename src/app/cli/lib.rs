//! The command line: one subcommand per file. docs/command_line.md has the rules that all of them follow.

mod check;
mod common;
mod dataset;
mod dataset_occ3d;
mod demo;
mod diff;
mod doctor;
mod edit;
mod endpoint;
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
mod trade;
mod wrong;

use std::path::PathBuf;
use std::process::ExitCode;

use clap::{Parser, Subcommand};

pub(crate) use common::Common;
use common::{Gen, Outcome, Stop};

use app::open;

/// Sceneloom: paint a driving scene's layout, edit boxes and voxels, see occupancy, cameras and LiDAR follow.
#[derive(Parser)]
#[command(name = "sceneloom", version, about, args_conflicts_with_subcommands = true)]
struct Cli {
    #[command(subcommand)]
    command: Option<Command>,
    #[arg(help = format!("File to open in the editor: {}; without one the bundled scene opens", formats::import::in_words()))]
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
    /// A scene from a file of another program: roads, labels, a point cloud, boxes.
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
    app::run_window(scene, path, trace)?;
    Ok(())
}
