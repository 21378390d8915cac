//! Work in the background gives way to the window: threads that generate and sense run at a lower priority than the one
//! that draws, and than a software rasteriser. Only where `/proc` and `renice` are there; elsewhere nothing changes.

use std::process::{Command, Stdio};

/// How much nicer than the window, of 19: a tenth of its share of a processor.
const NICER: i32 = 10;

/// The system's number of this thread; none where `/proc` does not tell.
fn thread_id() -> Option<String> {
    let link = std::fs::read_link("/proc/thread-self").ok()?;
    Some(link.file_name()?.to_str()?.to_owned())
}

/// Field 19 of `/proc/<pid>/task/<tid>/stat`, proc(5): from -20, first in line, to 19.
fn nice() -> Option<i32> {
    let stat = std::fs::read_to_string("/proc/thread-self/stat").ok()?;
    // The name of the thread, in brackets, may hold blanks.
    let (_, rest) = stat.rsplit_once(')')?;
    rest.split_whitespace().nth(16)?.parse().ok()
}

/// Makes this thread give way to others of the program. True if the system did it.
pub fn give_way() -> bool {
    let (Some(id), Some(nice)) = (thread_id(), nice()) else {
        return false;
    };
    let wanted = (nice + NICER).min(19).to_string();
    // Without `-n` the number is meant as it is by every `renice`.
    let renice = Command::new("renice")
        .args([wanted.as_str(), "-p", &id])
        .stdin(Stdio::null())
        .stdout(Stdio::null())
        .stderr(Stdio::null())
        .status();
    renice.is_ok_and(|status| status.success())
}

/// Makes the threads that share the heavy work give way. Call it before they are used; later it does nothing.
pub fn workers_give_way() {
    let pool = rayon::ThreadPoolBuilder::new().start_handler(|_| {
        give_way();
    });
    // Somebody was faster: the work is done all the same.
    let _ = pool.build_global();
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
}
