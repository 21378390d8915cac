//! A process that is spoken to in lines, whatever its lines mean.

use std::io::{BufRead, BufReader, Read, Write};
use std::path::Path;
use std::process::{Child, ChildStdin, Command, Stdio};
use std::sync::mpsc::{Receiver, channel};
use std::time::Duration;

use serde_json::{Value, json};

/// Nothing here takes longer, s.
const LONGEST_S: u64 = 300;

pub fn command(args: &[&str]) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_sceneloom"));
    command
        .args(args)
        .env_remove("DISPLAY")
        .env_remove("WAYLAND_DISPLAY")
        .env_remove("SCENELOOM_MCP_TOKEN");
    command
}

/// A running process. Its output is read on a thread, so that it never waits for us.
pub struct Talk {
    child: Child,
    input: Option<ChildStdin>,
    lines: Receiver<String>,
    id: i64,
}

impl Talk {
    /// Starts a subcommand on a folder.
    pub fn start(subcommand: &str, folder: &Path) -> Self {
        let folder = folder.display().to_string();
        let mut child = command(&[subcommand, "--folder", &folder])
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .stderr(Stdio::inherit())
            .spawn()
            .expect("the built program runs");
        let output = BufReader::new(child.stdout.take().expect("a pipe"));
        let (told, lines) = channel();
        std::thread::spawn(move || {
            for line in output.lines().map_while(Result::ok) {
                if told.send(line).is_err() {
                    return;
                }
            }
        });
        let input = child.stdin.take();
        Self {
            child,
            input,
            lines,
            id: 0,
        }
    }

    /// Writes bytes as they are.
    pub fn write(&mut self, bytes: &[u8]) {
        let input = self.input.as_mut().expect("not ended");
        input
            .write_all(bytes)
            .and_then(|()| input.flush())
            .expect("the program reads");
    }

    /// Writes a value as a line.
    pub fn send(&mut self, value: &Value) {
        self.write(format!("{value}\n").as_bytes());
    }

    /// The next line of its output.
    pub fn line(&mut self) -> Value {
        let line = self
            .lines
            .recv_timeout(Duration::from_secs(LONGEST_S))
            .expect("a reply");
        serde_json::from_str(&line).unwrap_or_else(|e| panic!("{e}: {line}"))
    }

    /// A call of a session: its receipt, or the error in one line.
    pub fn call(&mut self, name: &str, args: Value) -> Result<Value, String> {
        self.id += 1;
        self.send(&json!({ "id": self.id, "call": name, "args": args }));
        let reply = self.line();
        assert_eq!(reply["id"], self.id, "{reply}");
        outcome(&reply)
    }

    /// The receipt of a call of a session that does not fail.
    pub fn did(&mut self, name: &str, args: Value) -> Value {
        self.call(name, args)
            .unwrap_or_else(|error| panic!("{name}: {error}"))
    }

    /// Most memory that it has taken, MiB; 0 where the system does not tell.
    pub fn most_memory_mib(&self) -> u64 {
        self.status_mib("VmHWM:")
    }

    /// Memory that it takes now, MiB; 0 where the system does not tell.
    pub fn memory_mib(&self) -> u64 {
        self.status_mib("VmRSS:")
    }

    fn status_mib(&self, line: &str) -> u64 {
        let status = format!("/proc/{}/status", self.child.id());
        let text = std::fs::read_to_string(status).unwrap_or_default();
        let line = text.lines().find_map(|l| l.strip_prefix(line));
        let kib = line.and_then(|l| l.trim().trim_end_matches(" kB").parse::<u64>().ok());
        kib.unwrap_or(0) / 1024
    }

    /// Ends its input; what it still says, and whether it ended well.
    pub fn end(mut self) -> (Vec<Value>, bool) {
        self.input = None;
        let ended = self.child.wait().expect("it ends").success();
        let rest = self
            .lines
            .iter()
            .map(|line| serde_json::from_str(&line).expect("JSON"))
            .collect();
        (rest, ended)
    }
}

/// The receipt of a reply of a session, or its error, which is one line.
pub fn outcome(reply: &Value) -> Result<Value, String> {
    match reply["ok"].as_bool() {
        Some(true) => Ok(reply["receipt"].clone()),
        _ => {
            let error = reply["error"].as_str().expect("an error").to_owned();
            assert!(one_line(&error), "{error}");
            Err(error)
        }
    }
}

/// True for one line of at most 300 characters that says something.
pub fn one_line(text: &str) -> bool {
    text.len() > 5 && text.chars().count() <= 300 && !text.contains('\n')
}

/// Everything that a reader holds, as text.
pub fn all_of(mut reader: impl Read) -> String {
    let mut text = String::new();
    reader.read_to_string(&mut text).expect("text");
    text
}
