//! Windows that are taken away from outside, by a display server that ends or by `xkill`. The window library then
//! panics in its own code when it asks for the window's size. The panic becomes an error in one line, and unsaved work
//! is kept as after any other end.

use std::panic::{AssertUnwindSafe, catch_unwind, resume_unwind};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

/// The message for the user.
const LINE: &str = "the window was taken away from outside; what was not saved is offered at the next start";

/// True for a source file of the window library that talks to the display server.
fn talks_to_display(file: &str) -> bool {
    let file = file.replace('\\', "/");
    file.contains("/winit-") && file.contains("/platform_impl/")
}

/// Runs an event loop and returns its errors. Errors in one line if the window was taken away; any other panic goes on.
pub fn guarded<E: std::fmt::Display>(run: impl FnOnce() -> Result<(), E>) -> anyhow::Result<()> {
    guarded_from(talks_to_display, run)
}

fn guarded_from<E: std::fmt::Display>(
    is_theirs: fn(&str) -> bool,
    run: impl FnOnce() -> Result<(), E>,
) -> anyhow::Result<()> {
    let gone = Arc::new(AtomicBool::new(false));
    let (seen, here) = (gone.clone(), std::thread::current().id());
    let before = std::panic::take_hook();
    std::panic::set_hook(Box::new(move |info| {
        let place = info.location();
        let theirs = place.is_some_and(|place| is_theirs(place.file()));
        if theirs && std::thread::current().id() == here {
            seen.store(true, Ordering::Relaxed);
            let place = place.map(ToString::to_string).unwrap_or_default();
            tracing::error!(place, "{LINE}");
        } else {
            before(info);
        }
    }));
    match catch_unwind(AssertUnwindSafe(run)) {
        Ok(Ok(())) => Ok(()),
        Ok(Err(error)) => {
            let said = error.to_string().replace('\n', "; ");
            Err(anyhow::anyhow!("the window could not be opened: {said}"))
        }
        Err(_) if gone.load(Ordering::Relaxed) => Err(anyhow::anyhow!(LINE)),
        Err(panic) => resume_unwind(panic),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_window_that_is_gone_is_an_error_of_one_line() {
        let here = |file: &str| file.ends_with("gone.rs");
        let gone = guarded_from(here, || -> Result<(), String> { panic!("BadWindow") });
        assert_eq!(gone.expect_err("gone").to_string(), LINE);
        let failed = guarded_from(here, || Err("no display\nat all"));
        assert_eq!(
            failed.expect_err("failed").to_string(),
            "the window could not be opened: no display; at all"
        );
        assert!(guarded_from(here, || Ok::<(), String>(())).is_ok());
        // Panics in our own code are not reported so.
        let other = catch_unwind(|| guarded_from(|_| false, || -> Result<(), String> { panic!("ours") }));
        assert!(other.is_err());
    }

    #[test]
    fn the_library_of_windows_is_told_by_its_files() {
        let at = |path: &str| talks_to_display(&format!("/home/x/.cargo/registry/src/index/{path}"));
        assert!(at("winit-0.30.13/src/platform_impl/linux/x11/window.rs"));
        assert!(at("winit-0.30.13/src/platform_impl/linux/wayland/window/mod.rs"));
        assert!(!at("egui-winit-0.37.0/src/lib.rs") && !at("winit-0.30.13/src/event_loop.rs"));
        assert!(!talks_to_display("src/app/shell/app.rs"));
    }
}
