//! Lower priority for background work: threads that generate and sense run at a lower priority than the thread that
//! draws, and than a software rasteriser. Works only with `/proc` and `renice`; elsewhere priorities do not change.

use std::process::{Command, Stdio};

/// Increase of the nice value, of at most 19: a tenth of the window's share of a processor.
const NICER: i32 = 10;

/// The system's id of this thread; `None` without `/proc`.
fn thread_id() -> Option<String> {
    let link = std::fs::read_link("/proc/thread-self").ok()?;
    Some(link.file_name()?.to_str()?.to_owned())
}

/// The nice value of this thread, field 19 of `/proc/<pid>/task/<tid>/stat`, proc(5): from -20, the highest priority,
/// to 19.
fn nice() -> Option<i32> {
    let stat = std::fs::read_to_string("/proc/thread-self/stat").ok()?;
    // The name of the thread, in brackets, may contain spaces.
    let (_, rest) = stat.rsplit_once(')')?;
    rest.split_whitespace().nth(16)?.parse().ok()
}

/// Lowers the priority of this thread. Returns true if the system did it.
pub fn give_way() -> bool {
    let (Some(id), Some(nice)) = (thread_id(), nice()) else {
        return false;
    };
    let wanted = (nice + NICER).min(19).to_string();
    // Without `-n`, every `renice` reads the number the same way.
    let renice = Command::new("renice")
        .args([wanted.as_str(), "-p", &id])
        .stdin(Stdio::null())
        .stdout(Stdio::null())
        .stderr(Stdio::null())
        .status();
    renice.is_ok_and(|status| status.success())
}

/// Environment variable for the number of threads, as usual with rayon.
const ASKED_BY: &str = "RAYON_NUM_THREADS";

/// Starts the threads that share the heavy work; a panic on one of them is logged, and the thread goes on; in the window they run at a lower priority. To be called before they
/// are used; later it has no effect. A number of threads from the environment is limited to a useful one. Returns a
/// line that says so if it was limited.
pub fn start_workers(give_way_to_window: bool) -> Option<String> {
    let cores = std::thread::available_parallelism().map_or(1, usize::from);
    let (threads, line) = number(std::env::var(ASKED_BY).ok().as_deref(), cores);
    let pool = rayon::ThreadPoolBuilder::new()
        .num_threads(if threads == 0 { cores } else { threads })
        .start_handler(move |_| {
            if give_way_to_window {
                give_way();
            }
        })
        // The hook has logged it (`logging.rs`); without a handler, a panic in work that nobody waits for ends the program.
        .panic_handler(|_| {});
    // Fails if the pool exists already; the work is done all the same.
    let _ = pool.build_global();
    line
}

/// The number of threads (0: as many as processors), and a message about it, if any.
fn number(asked: Option<&str>, cores: usize) -> (usize, Option<String>) {
    let most = (4 * cores).max(64);
    let Some(text) = asked.map(str::trim).filter(|text| !text.is_empty()) else {
        return (0, None);
    };
    let said = |used: &str| {
        let shown = scene::message::quoted(text, 40);
        Some(format!("{ASKED_BY} is {shown:?}, expected 1 to {most}: {used}"))
    };
    let is_digits = text.chars().all(|c| c.is_ascii_digit());
    match text.parse::<usize>() {
        Ok(0) => (0, None),
        Ok(n) if n <= most => (n, None),
        // A number too large to parse is too many as well.
        _ if is_digits => (most, said(&format!("{most} threads work"))),
        _ => (0, said("as many threads work as there are processors")),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_thread_gives_way_alone() {
        let Some(before) = nice() else { return };
        let inside = std::thread::spawn(|| (give_way(), nice()))
            .join()
            .expect("no panic");
        match inside {
            (true, Some(after)) => assert!(after > before || before >= 15, "{before} {after}"),
            (_, after) => assert_eq!(after, Some(before), "nothing has changed"),
        }
        assert_eq!(nice(), Some(before), "this thread keeps its own");
    }

    /// 100,000 threads hung the machine.
    #[test]
    fn a_number_of_threads_is_kept_to_what_helps() {
        for (asked, threads) in [
            (None, 0),
            (Some(""), 0),
            (Some("0"), 0),
            (Some("1"), 1),
            (Some(" 8 "), 8),
            (Some("64"), 64),
        ] {
            assert_eq!(number(asked, 2), (threads, None), "{asked:?}");
        }
        for (asked, threads) in [
            ("65", 64),
            ("100000", 64),
            ("99999999999999999999999", 64),
            ("-4", 0),
            ("many\nlines", 0),
        ] {
            let (found, line) = number(Some(asked), 2);
            assert_eq!(found, threads, "{asked}");
            let line = line.expect("said");
            assert!(
                line.starts_with("RAYON_NUM_THREADS is ")
                    && line.contains("expected 1 to 64")
                    && !line.contains('\n'),
                "{line}"
            );
        }
        assert_eq!(number(Some("100"), 32), (100, None));
        assert_eq!(number(Some("100000"), 32).0, 128);
    }
}
