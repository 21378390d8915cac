//! Clients that mean no good: connections that are silent, slow, or break off in the middle.

use std::io::Write;
use std::net::TcpStream;

/// Connections of a crowd.
const MANY: usize = 1000;

/// A crowd of connections, each of which has said what is said by its number. They stay open until they are dropped. As many as
/// this process may hold beside its other files.
pub fn crowd(address: &str, say: impl Fn(usize) -> Vec<u8>) -> Vec<TcpStream> {
    let many = files_allowed().map_or(MANY, |files| MANY.min(files / 2));
    let connect = |i| {
        let mut stream = TcpStream::connect(address).expect("it listens");
        // (a server need not wait for all of it)
        let _ = stream.write_all(&say(i));
        stream
    };
    let crowd: Vec<TcpStream> = (0..many).map(connect).collect();
    println!("{} hostile connections", crowd.len());
    crowd
}

/// How many files this process may have open; none where the system does not tell.
fn files_allowed() -> Option<usize> {
    let limits = std::fs::read_to_string("/proc/self/limits").ok()?;
    let line = limits.lines().find(|l| l.starts_with("Max open files"))?;
    line.split_whitespace().nth(3)?.parse().ok()
}

/// How many files a process has open; none where the system does not tell.
pub fn open_files(process: u32) -> Option<usize> {
    Some(std::fs::read_dir(format!("/proc/{process}/fd")).ok()?.count())
}
