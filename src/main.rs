//! Parses arguments, runs, reports the error once, exits.

fn main() -> std::process::ExitCode {
    app::cli::main()
}
