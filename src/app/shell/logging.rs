//! The log: messages of the program, wgpu, egui and winit, as lines of a file in the folder for state. `SCENELOOM_LOG`
//! sets the filter (`debug`, `info,wgpu_core=warn`, `off`).

use std::fs::{File, OpenOptions};
use std::io::{self, Write};
use std::path::{Path, PathBuf};
use std::sync::Mutex;

use tracing_subscriber::Layer as _;
use tracing_subscriber::filter::Targets;
use tracing_subscriber::layer::SubscriberExt as _;
use tracing_subscriber::util::SubscriberInitExt as _;

use super::folders;

/// The log of this session, and beside it the log of the session before.
const FILE: &str = "log.txt";
const FILE_BEFORE: &str = "log.before.txt";
/// Size after which no more lines are written, bytes.
const MOST_BYTES: u64 = 16 << 20;
/// Default filter. Libraries log every frame, so only their warnings are kept.
const USUAL: &str = "warn,app=info,job=info,sceneloom=info";

/// Path of the log; `None` if the system names no folder for state.
pub fn file() -> Option<PathBuf> {
    folders::state().map(|folder| folder.join(FILE))
}

/// Starts the log of this process. Panics are logged too. Returns the file; `None` if no log can be written, because
/// the program works without one.
pub fn start() -> Option<PathBuf> {
    let folder = folders::state()?;
    let text = std::env::var("SCENELOOM_LOG").unwrap_or_else(|_| USUAL.to_owned());
    let file = start_in(&folder, &text)?;
    let before = std::panic::take_hook();
    std::panic::set_hook(Box::new(move |info| {
        let said = info.payload_as_str().unwrap_or("no message");
        let place = info.location().map(ToString::to_string).unwrap_or_default();
        tracing::error!(place, "panic: {said}");
        before(info);
    }));
    tracing::info!(version = env!("CARGO_PKG_VERSION"), "start");
    Some(file)
}

fn start_in(folder: &Path, text: &str) -> Option<PathBuf> {
    let path = folder.join(FILE);
    let targets = filter(text);
    let writer = Mutex::new(Bounded::open(&path).ok()?);
    let lines = tracing_subscriber::fmt::layer()
        .with_ansi(false)
        .with_writer(writer);
    // Fails if there is a log already, as in tests that open several windows.
    tracing_subscriber::registry()
        .with(lines.with_filter(targets))
        .try_init()
        .ok()?;
    Some(path)
}

/// The filter of a text; the default filter if the text is invalid.
fn filter(text: &str) -> Targets {
    text.parse().unwrap_or_else(|_| USUAL.parse().unwrap_or_default())
}

/// A log file with a limited size.
struct Bounded {
    file: File,
    left: u64,
}

impl Bounded {
    fn open(path: &Path) -> io::Result<Self> {
        if let Some(folder) = path.parent() {
            std::fs::create_dir_all(folder)?;
        }
        // The first session has no log before it.
        let _ = std::fs::rename(path, path.with_file_name(FILE_BEFORE));
        let file = OpenOptions::new().create(true).append(true).open(path)?;
        Ok(Self {
            file,
            left: MOST_BYTES,
        })
    }
}

impl Write for Bounded {
    fn write(&mut self, line: &[u8]) -> io::Result<usize> {
        let length = line.len() as u64;
        if length <= self.left {
            self.left -= length;
            self.file.write_all(line)?;
        }
        Ok(line.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        self.file.flush()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use tracing::Level;

    #[test]
    fn a_log_keeps_the_one_before_and_stops_growing() {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("deep").join(FILE);
        let mut log = Bounded::open(&path).expect("a log");
        log.write_all(b"first\n").expect("written");
        drop(log);
        let mut log = Bounded::open(&path).expect("a log");
        log.left = 10;
        for _ in 0..5 {
            log.write_all(b"second\n").expect("written or dropped");
        }
        let read = |path: &Path| std::fs::read_to_string(path).expect("a file");
        assert_eq!(read(&path), "second\n");
        assert_eq!(read(&path.with_file_name(FILE_BEFORE)), "first\n");
    }

    #[test]
    fn what_is_kept_can_be_chosen() {
        assert!(filter("debug").would_enable("egui", &Level::DEBUG));
        assert!(!filter("off").would_enable("app", &Level::ERROR));
        let usual = filter("=no=filter=");
        assert!(usual.would_enable("app", &Level::INFO) && !usual.would_enable("wgpu_core", &Level::INFO));
        assert!(usual.would_enable("wgpu_core", &Level::WARN));
    }
}
