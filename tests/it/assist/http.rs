//! The MCP server over HTTP: who is let in, and that what is let in is answered.

use std::io::{BufRead, BufReader, Write};
use std::net::TcpStream;
use std::process::{Child, Stdio};
use std::time::{Duration, Instant};

use serde_json::{Value, json};

use super::process::{all_of, command};
use crate::crowd::{crowd, open_files};

const TOKEN: &str = "0123456789abcdef";

struct Server {
    child: Child,
    address: String,
}

impl Drop for Server {
    fn drop(&mut self) {
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

fn start(folder: &str) -> Server {
    let mut child = command(&[
        "mcp",
        "--folder",
        folder,
        "--listen",
        "127.0.0.1:0",
        "--token",
        TOKEN,
    ])
    .stderr(Stdio::piped())
    .spawn()
    .expect("the built program runs");
    let mut said = String::new();
    BufReader::new(child.stderr.take().expect("a pipe"))
        .read_line(&mut said)
        .expect("a line");
    let address = said
        .trim()
        .strip_prefix("listening on http://")
        .and_then(|a| a.strip_suffix("/mcp"));
    let address = address.unwrap_or_else(|| panic!("{said}")).to_owned();
    Server { child, address }
}

/// Sends a request; the status and the body of the answer.
fn ask(address: &str, path: &str, headers: &[(&str, &str)], body: &str) -> (u16, String) {
    let mut stream = TcpStream::connect(address).expect("it listens");
    stream
        .set_read_timeout(Some(Duration::from_secs(120)))
        .expect("a timeout");
    let mut text = format!(
        "POST {path} HTTP/1.1\r\nConnection: close\r\nContent-Type: application/json\r\nAccept: application/json, text/event-stream\r\nContent-Length: {}\r\n",
        body.len()
    );
    if !headers.iter().any(|(name, _)| *name == "Host") {
        text += &format!("Host: {address}\r\n");
    }
    for (name, value) in headers {
        text += &format!("{name}: {value}\r\n");
    }
    text += "\r\n";
    stream.write_all(text.as_bytes()).expect("written");
    // (a server that refuses a request need not read all of it)
    let _ = stream.write_all(body.as_bytes());
    let answer = all_of(stream);
    let status = answer
        .split(' ')
        .nth(1)
        .and_then(|s| s.parse().ok())
        .unwrap_or_else(|| panic!("{answer}"));
    let body = answer.split_once("\r\n\r\n").map_or("", |(_, body)| body);
    (status, body.to_owned())
}

fn message(method: &str, params: Value) -> String {
    json!({ "jsonrpc": "2.0", "id": 1, "method": method, "params": params }).to_string()
}

/// Calls a tool of a server at an address; the status and the answer, which is text where it is no JSON.
pub fn call(address: &str, token: &str, name: &str, args: &Value) -> (u16, Value) {
    let body = message("tools/call", json!({ "name": name, "arguments": args }));
    let bearer = format!("Bearer {token}");
    let (status, body) = ask(address, "/mcp", &[("Authorization", &bearer)], &body);
    (status, if status == 200 { value(&body) } else { json!(body) })
}

/// The JSON of a body, which may come in chunks or as an event.
fn value(body: &str) -> Value {
    let from = body.find('{').unwrap_or_else(|| panic!("{body}"));
    let to = body.rfind('}').expect("an end");
    serde_json::from_str(&body[from..=to]).unwrap_or_else(|e| panic!("{e}: {body}"))
}

#[test]
fn only_who_shows_the_token_is_let_in() {
    let dir = tempfile::tempdir().expect("a folder");
    let server = start(&dir.path().display().to_string());
    let list = message("tools/list", json!({}));
    let bearer = format!("Bearer {TOKEN}");
    let good = ("Authorization", bearer.as_str());
    for wrong in [
        "",
        "Bearer",
        "Bearer 0123456789abcdeF",
        "Bearer 0123456789abcdef0",
        TOKEN,
    ] {
        let (status, body) = ask(&server.address, "/mcp", &[("Authorization", wrong)], &list);
        assert_eq!((status, body.lines().count()), (401, 1), "{wrong}: {body}");
    }
    assert_eq!(ask(&server.address, "/mcp", &[], &list).0, 401);
    assert_eq!(ask(&server.address, "/", &[good], &list).0, 404);
    // Pages of a browser, and names of elsewhere that lead here.
    let (status, _) = ask(
        &server.address,
        "/mcp",
        &[good, ("Origin", "https://example.com")],
        &list,
    );
    assert_eq!(status, 403);
    let (status, _) = ask(&server.address, "/mcp", &[good, ("Host", "example.com")], &list);
    assert_eq!(status, 403);

    let (status, body) = ask(&server.address, "/mcp", &[good], &list);
    assert_eq!(status, 200, "{body}");
    assert!(value(&body)["result"]["tools"].as_array().map_or(0, Vec::len) >= 20);
}

#[test]
fn clients_share_one_scene_and_hostile_ones_are_refused() {
    let dir = tempfile::tempdir().expect("a folder");
    let server = start(&dir.path().display().to_string());
    let call = |name: &str, args: Value| call(&server.address, TOKEN, name, &args);
    let (_, made) = call("new", json!({ "template": "straight", "seed": 3 }));
    assert_eq!(made["result"]["structuredContent"]["revision"], 2, "{made}");
    let (_, undone) = call("undo", json!({}));
    assert_eq!(undone["result"]["structuredContent"]["revision"], 1, "{undone}");
    let (_, refused) = call("open", json!({ "file": "../x" }));
    assert_eq!(refused["result"]["isError"], true, "{refused}");
    let (status, _) = call("prompt", json!({ "text": "x".repeat(10 << 20) }));
    assert_eq!(status, 413);
    std::thread::scope(|threads| {
        for _ in 0..50 {
            threads.spawn(|| assert_eq!(call("state", json!({})).0, 200));
        }
    });
    let (status, state) = call("state", json!({}));
    assert_eq!((status, &state["result"]["isError"]), (200, &json!(false)));
}

/// What a hostile client says before it falls silent, by its number.
fn hostile(i: usize) -> Vec<u8> {
    let head = "POST /mcp HTTP/1.1\r\nHost: 127.0.0.1\r\nContent-Type: application/json\r\n";
    let body = "Content-Length: 1000\r\n\r\n{";
    let said = match i % 5 {
        0 => String::new(),
        1 => "POST /mcp HT".into(),
        // Half a head without a token, and a body without one.
        2 => head.into(),
        3 => format!("{head}{body}"),
        // With a token, a body that never ends.
        _ => format!("{head}Authorization: Bearer {TOKEN}\r\n{body}"),
    };
    said.into_bytes()
}

#[test]
fn silent_slow_and_half_connections_keep_no_honest_client_out() {
    let dir = tempfile::tempdir().expect("a folder");
    let server = start(&dir.path().display().to_string());
    let crowd = crowd(&server.address, hostile);
    for _ in 0..3 {
        let start = Instant::now();
        // (a client that hears nothing gives up long after this would have ended)
        let (status, state) = call(&server.address, TOKEN, "state", &json!({}));
        println!("an honest client was answered after {:?}", start.elapsed());
        assert_eq!((status, &state["result"]["isError"]), (200, &json!(false)));
    }
    if let Some(files) = open_files(server.child.id()) {
        assert!(
            files < 500,
            "{files} files are open for {} connections",
            crowd.len()
        );
    }
}

#[test]
fn who_is_refused_is_hung_up_on() {
    let dir = tempfile::tempdir().expect("a folder");
    let server = start(&dir.path().display().to_string());
    let mut stream = TcpStream::connect(&server.address).expect("it listens");
    let limit = Some(Duration::from_secs(120));
    stream.set_read_timeout(limit).expect("a timeout");
    let head = "POST /mcp HTTP/1.1\r\nHost: 127.0.0.1\r\nContent-Length: 0\r\n\r\n";
    stream.write_all(head.as_bytes()).expect("written");
    // (its end comes, though the client asked for none)
    let answer = all_of(stream);
    assert!(
        answer.starts_with("HTTP/1.1 401 ") && answer.contains("connection: close"),
        "{answer}"
    );
}
