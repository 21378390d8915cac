//! What `-o` names: files, links, pipes, what is open already.
#![cfg(unix)]

use std::os::unix::fs::{FileTypeExt, symlink};
use std::path::Path;
use std::process::{Command, Stdio};

use super::process::{refused, run};

fn kind(path: &Path) -> std::fs::FileType {
    std::fs::symlink_metadata(path).expect("there").file_type()
}

/// Commands that write one file each, with what they write it to at the end.
const COMMANDS: [&[&str]; 2] = [
    &["new", "--template", "straight", "--seed", "3", "-o"],
    &["export", "--format", "boxes", "SCENE", "-o"],
];

#[test]
fn pipes_links_and_open_files_are_written_to_as_what_they_are() {
    let dir = tempfile::tempdir().expect("a folder");
    let at = |name: &str| dir.path().join(name);
    let text = |name: &str| at(name).display().to_string();
    let scene = text("scene.loom");
    assert_eq!(
        run(&["new", "--template", "straight", "--seed", "3", "-o", &scene]).0,
        0
    );
    let made = Command::new("mkfifo").arg(at("pipe")).status();
    assert!(made.expect("mkfifo").success());
    symlink("pipe", at("to_pipe")).expect("a link");
    symlink("real", at("link")).expect("a link");
    symlink("round", at("round")).expect("a link");
    for command in COMMANDS {
        let with = |target: &str| -> Vec<String> {
            let args = command.iter().map(|arg| arg.replace("SCENE", &scene));
            args.chain([target.to_owned()]).collect()
        };
        let did = |target: &str| {
            let args = with(target);
            let (code, _, error) = run(&args.iter().map(String::as_str).collect::<Vec<_>>());
            assert_eq!(code, 0, "{args:?}: {error}");
        };
        did(&text("real"));
        let expected = std::fs::read(at("real")).expect("a file");
        std::fs::remove_file(at("real")).expect("removed");
        // A link to nothing, then to a file: the link stays.
        for _ in 0..2 {
            did(&text("link"));
            assert!(kind(&at("link")).is_symlink());
            assert!(std::fs::read(at("real")).expect("a file") == expected);
        }
        for pipe in ["pipe", "to_pipe"] {
            let reader = std::thread::spawn({
                let path = at("pipe");
                move || std::fs::read(path).expect("a pipe")
            });
            did(&text(pipe));
            assert!(reader.join().expect("no panic") == expected && kind(&at("pipe")).is_fifo());
        }
        // Standard output holds the file and nothing else; what is said goes to the other.
        let args = with("/proc/self/fd/1");
        if Path::new("/proc/self/fd").exists() {
            let (as_pipe, as_file) = (Stdio::piped(), std::fs::File::create(at("out")).expect("a file"));
            let output = |to: Stdio| {
                let child = Command::new(env!("CARGO_BIN_EXE_sceneloom"))
                    .args(&args)
                    .stdout(to)
                    .stderr(Stdio::piped())
                    .spawn();
                child.expect("it runs").wait_with_output().expect("it ends")
            };
            let piped = output(as_pipe);
            assert!(piped.status.success() && piped.stdout == expected && !piped.stderr.is_empty());
            assert!(output(as_file.into()).status.success());
            assert!(std::fs::read(at("out")).expect("a file") == expected);
        }
        let round = with(&text("round"));
        let line = refused(&round.iter().map(String::as_str).collect::<Vec<_>>());
        assert!(line.contains("circle"), "{line}");
        let _socket = std::os::unix::net::UnixListener::bind(at("socket")).expect("a socket");
        let socket = with(&text("socket"));
        let line = refused(&socket.iter().map(String::as_str).collect::<Vec<_>>());
        assert!(line.contains("expected a file or a pipe"), "{line}");
        assert!(kind(&at("socket")).is_socket());
        std::fs::remove_file(at("socket")).expect("removed");
        std::fs::remove_file(at("real")).expect("removed");
    }
}
