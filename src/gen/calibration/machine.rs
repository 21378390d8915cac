//! Load, name and memory of the machine. Times taken on a busy machine are worth little, those of another machine
//! nothing.

use std::path::Path;
use std::sync::LazyLock;

use serde::Serialize;

/// Load per core above which times are not to be trusted.
pub const BUSY: f64 = 0.5;

/// Load of the machine by all processes.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct Load {
    /// Mean number of running processes over the last minute, per core; `None` where the system does not tell.
    pub per_core: Option<f64>,
    /// Cores.
    pub cores: usize,
}

impl Load {
    /// The load at this moment.
    pub fn now() -> Self {
        let cores = std::thread::available_parallelism().map_or(1, usize::from);
        let text = std::fs::read_to_string("/proc/loadavg").ok();
        let one = text.and_then(|t| t.split_whitespace().next()?.parse::<f64>().ok());
        Self {
            per_core: one.map(|l| l / cores as f64),
            cores,
        }
    }

    /// True if the machine is too busy for times taken now to be trusted.
    pub fn is_busy(&self) -> bool {
        self.per_core.is_some_and(|l| l > BUSY)
    }

    /// One line for the user.
    pub fn describe(&self) -> String {
        match self.per_core {
            Some(l) => format!("{l:.2} running processes per core on {} cores", self.cores),
            None => format!("load unknown on {} cores", self.cores),
        }
    }
}

/// Names this machine: processor, threads, what our kernels find.
pub fn machine() -> String {
    // (asked for with every frame of the panel)
    static NAME: LazyLock<String> = LazyLock::new(describe_machine);
    NAME.clone()
}

fn describe_machine() -> String {
    let text = std::fs::read_to_string("/proc/cpuinfo").unwrap_or_default();
    let name = text
        .lines()
        .find_map(|l| l.strip_prefix("model name")?.split_once(": "));
    let threads = rayon::current_num_threads();
    let bytes = if nn::int8::fast_here() { ", VNNI" } else { "" };
    format!(
        "{}, {threads} threads{bytes}",
        name.map_or("unknown processor", |(_, name)| name.trim())
    )
}

/// Largest memory this process has held, MB; `None` where the system does not tell.
pub fn peak_rss_mb() -> Option<f64> {
    let status = std::fs::read_to_string("/proc/self/status").ok()?;
    let line = status.lines().find(|l| l.starts_with("VmHWM:"))?;
    let kb: f64 = line.split_whitespace().nth(1)?.parse().ok()?;
    Some((kb / 102.4).round() / 10.0)
}

/// Resets the peak of this process's memory, so that the next peak is that of what follows.
pub fn forget_peak_memory() {
    // If the reset fails, peaks are those of the whole run, which readers must then assume.
    std::fs::write("/proc/self/clear_refs", "5").ok();
}

/// A path as reports show it: the file's name alone for an absolute path, since folders of this machine do not belong
/// there.
pub fn told(path: &Path) -> String {
    let name = path.file_name().filter(|_| path.is_absolute());
    name.map_or_else(
        || path.display().to_string(),
        |name| name.to_string_lossy().into_owned(),
    )
}
