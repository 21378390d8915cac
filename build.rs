//! Tells the program its commit: `SCENELOOM_COMMIT` of the environment, else what git says of the checkout, `+` where files differ
//! from it. Builds with debug assertions have none, so that a commit does not make tests build again.

use std::path::Path;
use std::process::Command;

fn main() {
    println!("cargo::rerun-if-changed=build.rs");
    println!("cargo::rerun-if-env-changed=SCENELOOM_COMMIT");
    if std::env::var_os("CARGO_CFG_DEBUG_ASSERTIONS").is_some() {
        return;
    }
    let told = std::env::var("SCENELOOM_COMMIT")
        .ok()
        .filter(|commit| !commit.is_empty());
    if let Some(commit) = told.or_else(of_checkout) {
        println!("cargo::rustc-env=SCENELOOM_COMMIT={commit}");
    }
}

/// The commit of the checkout that holds this file; `None` without git or outside a checkout of the program.
fn of_checkout() -> Option<String> {
    let top = git(&["rev-parse", "--show-toplevel"])?;
    let here = Path::new(env!("CARGO_MANIFEST_DIR")).canonicalize().ok()?;
    if Path::new(&top).canonicalize().ok()? != here {
        return None;
    }
    // HEAD and the branch that it names change with each commit.
    let branch = git(&["symbolic-ref", "-q", "HEAD"]);
    for name in ["HEAD", "packed-refs"].into_iter().chain(branch.as_deref()) {
        if let Some(path) = git(&["rev-parse", "--git-path", name]).filter(|path| Path::new(path).exists()) {
            println!("cargo::rerun-if-changed={path}");
        }
    }
    for folder in ["Cargo.toml", "Cargo.lock", "assets", "shaders", "src"] {
        println!("cargo::rerun-if-changed={folder}");
    }
    let commit = git(&["rev-parse", "--short=10", "HEAD"])?;
    let is_changed =
        git(&["status", "--porcelain", "--untracked-files=no"]).is_none_or(|told| !told.is_empty());
    Some(format!("{commit}{}", if is_changed { "+" } else { "" }))
}

/// What git prints, without the newline; `None` if it fails.
fn git(arguments: &[&str]) -> Option<String> {
    let out = Command::new("git")
        .arg("--no-optional-locks")
        .args(arguments)
        .output()
        .ok()?;
    let text = String::from_utf8(out.stdout).ok()?;
    out.status.success().then(|| text.trim().to_owned())
}
