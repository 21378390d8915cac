//! Origin of figures: state of the program, date and machine.

use std::path::Path;
use std::process::Command;
use std::time::{SystemTime, UNIX_EPOCH};

use serde::Serialize;

use calibration::machine;

/// Heading of a list of figures.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Origin {
    /// Commit of the source tree that the program was built in, with `-dirty` if files differ from it. Without the
    /// tree: `version` and the program's version.
    pub commit: String,
    /// Day (UTC), as 2026-11-25.
    pub date: String,
    /// Processor, threads, kernels.
    pub machine: String,
    /// Cores that the program may use.
    pub cores: usize,
    /// The command line that was run.
    pub command: String,
}

impl Origin {
    /// The origin of figures measured now, by this build on this machine.
    pub fn now(command: String) -> Self {
        let seconds = SystemTime::now()
            .duration_since(UNIX_EPOCH)
            .map_or(0, |d| d.as_secs());
        Self {
            commit: commit(Path::new(env!("CARGO_MANIFEST_DIR")))
                .unwrap_or_else(|| format!("version {}", env!("CARGO_PKG_VERSION"))),
            date: day(seconds),
            machine: machine::machine(),
            cores: std::thread::available_parallelism().map_or(1, usize::from),
            command,
        }
    }
}

/// Description of a folder's commit by git; `None` without git, or if the folder is in no repository.
fn commit(folder: &Path) -> Option<String> {
    let mut git = Command::new("git");
    git.arg("-C").arg(folder);
    let out = git
        .args(["describe", "--always", "--dirty", "--abbrev=12", "--exclude=*"])
        .output()
        .ok()?;
    let text = String::from_utf8(out.stdout).ok()?.trim().to_owned();
    (out.status.success() && !text.is_empty()).then_some(text)
}

/// The day of a Unix time in the Gregorian calendar (days_from_civil of Hinnant, backwards).
fn day(seconds: u64) -> String {
    let days = seconds / 86_400 + 719_468; // since the first of March of the year 0
    let (era, in_era) = (days / 146_097, days % 146_097);
    let year_of_era = (in_era - in_era / 1460 + in_era / 36_524 - in_era / 146_096) / 365;
    let in_year = in_era - (365 * year_of_era + year_of_era / 4 - year_of_era / 100);
    let from_march = (5 * in_year + 2) / 153;
    let day = in_year - (153 * from_march + 2) / 5 + 1;
    let month = if from_march < 10 {
        from_march + 3
    } else {
        from_march - 9
    };
    let year = era * 400 + year_of_era + u64::from(month <= 2);
    format!("{year:04}-{month:02}-{day:02}")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn days_of_the_calendar() {
        for (seconds, expected) in [
            (0, "1970-01-01"),
            (951_782_399, "2000-02-28"),
            (951_782_400, "2000-02-29"),
            (951_868_800, "2000-03-01"),
            (1_764_028_800, "2025-11-25"),
            (4_107_542_400, "2100-03-01"),
        ] {
            assert_eq!(day(seconds), expected);
        }
    }

    #[test]
    fn without_a_repository_the_version_stands_in() {
        let empty = tempfile::tempdir().expect("a folder");
        assert_eq!(commit(empty.path()), None);
        assert_eq!(commit(Path::new("/nowhere")), None);
        let origin = Origin::now("sceneloom eval all".into());
        assert!(
            !origin.commit.is_empty() && origin.cores > 0 && origin.date.len() == 10,
            "{origin:?}"
        );
    }
}
