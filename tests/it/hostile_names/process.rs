//! The built program, run to its end.

use std::process::Command;

/// Its exit status, standard output and standard error.
pub fn run(args: &[&str]) -> (i32, String, String) {
    let output = Command::new(env!("CARGO_BIN_EXE_sceneloom"))
        .args(args)
        .env_remove("DISPLAY")
        .env_remove("WAYLAND_DISPLAY")
        .output()
        .expect("the built program runs");
    let text = |bytes: &[u8]| String::from_utf8_lossy(bytes).into_owned();
    let code = output.status.code().unwrap_or(-1);
    (code, text(&output.stdout), text(&output.stderr))
}

/// Runs what must be refused: exit status 2 and one line.
pub fn refused(args: &[&str]) -> String {
    let (code, said, error) = run(args);
    assert_eq!((code, &*said), (2, ""), "{args:?}: {error}");
    super::one_line(error.trim_end_matches('\n')).to_owned()
}
