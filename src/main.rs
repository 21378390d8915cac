//! Parses arguments, runs, reports the error once, exits.

fn main() -> std::process::ExitCode {
    cli::main(option_env!("SCENELOOM_COMMIT"))
}
