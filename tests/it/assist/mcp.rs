//! The MCP server over its pipes, spoken to message by message. (A client of the protocol's own makers: tests/readers/mcp_client.py.)

use std::collections::BTreeMap;

use serde_json::{Value, json};

use super::process::{Talk, one_line};

/// Says hello as a client does.
pub fn hello(talk: &mut Talk) -> Value {
    talk.send(&json!({
        "jsonrpc": "2.0", "id": 0, "method": "initialize",
        "params": { "protocolVersion": "2025-06-18", "capabilities": {}, "clientInfo": { "name": "test", "version": "1" } },
    }));
    let reply = talk.line();
    talk.send(&json!({ "jsonrpc": "2.0", "method": "notifications/initialized" }));
    reply
}

fn request(id: impl Into<Value>, name: &str, args: &Value) -> Value {
    json!({
        "jsonrpc": "2.0", "id": id.into(), "method": "tools/call",
        "params": { "name": name, "arguments": args },
    })
}

/// A tool's result: the receipt, or the error in one line.
fn receipt(reply: &Value) -> Result<Value, String> {
    let result = &reply["result"];
    if result["isError"] == false {
        return Ok(result["structuredContent"].clone());
    }
    let error = match result.is_null() {
        true => &reply["error"]["message"],
        false => &result["content"][0]["text"],
    };
    let error = error.as_str().unwrap_or_else(|| panic!("{reply}")).to_owned();
    assert!(one_line(&error), "{error}");
    Err(error)
}

fn did(talk: &mut Talk, name: &str, args: Value) -> Value {
    talk.send(&request("one", name, &args));
    let reply = talk.line();
    assert_eq!(reply["id"], "one", "{reply}");
    receipt(&reply).unwrap_or_else(|e| panic!("{name}: {e}"))
}

#[test]
fn a_client_finds_the_tools_and_uses_them() {
    let dir = tempfile::tempdir().expect("a folder");
    let mut talk = Talk::start("mcp", dir.path());
    let hello = hello(&mut talk);
    assert_eq!(hello["result"]["serverInfo"]["name"], "sceneloom");
    assert!(
        hello["result"]["instructions"]
            .as_str()
            .is_some_and(|t| t.len() > 200)
    );

    talk.send(&json!({ "jsonrpc": "2.0", "id": 1, "method": "tools/list" }));
    let listed = talk.line();
    let tools = listed["result"]["tools"].as_array().expect("tools");
    assert!(tools.len() >= 20, "{}", tools.len());
    for tool in tools {
        assert_eq!(tool["inputSchema"]["type"], "object", "{}", tool["name"]);
        assert_eq!(tool["outputSchema"]["type"], "object", "{}", tool["name"]);
        let about = tool["description"].as_str().expect("a description");
        assert!(about.contains("Example: {"), "{}", tool["name"]);
    }
    let text = listed.to_string();
    assert!(text.len() < 155_000, "{} bytes", text.len());

    let made = did(&mut talk, "new", json!({ "template": "straight", "seed": 3 }));
    assert_eq!(made["revision"], 2);
    talk.send(&request(2, "render", &json!({ "what": ["bev"] })));
    let rendered = talk.line();
    let content = rendered["result"]["content"].as_array().expect("content");
    assert_eq!((content.len(), &content[1]["mimeType"]), (2, &json!("image/png")));
    assert!(
        content[1]["data"]
            .as_str()
            .is_some_and(|d| d.starts_with("iVBORw0KGgo") && d.len() < 1_000_000)
    );
    let as_text: Value = serde_json::from_str(content[0]["text"].as_str().expect("text")).expect("JSON");
    assert_eq!(as_text, rendered["result"]["structuredContent"]);
    assert!(talk.end().1);
}

#[test]
fn calls_are_carried_out_in_the_order_in_which_they_came() {
    let dir = tempfile::tempdir().expect("a folder");
    let mut talk = Talk::start("mcp", dir.path());
    hello(&mut talk);
    did(&mut talk, "new", json!({ "template": "straight", "seed": 3 }));
    for i in 0..20 {
        let word = format!("step {i}");
        talk.send(&request(
            i,
            "apply",
            &json!({ "edits": [{ "keep_words": { "words": word } }] }),
        ));
    }
    let mut revisions = BTreeMap::new();
    for _ in 0..20 {
        let reply = talk.line();
        let done = receipt(&reply).expect("carried out");
        revisions.insert(
            reply["id"].as_i64().expect("an id"),
            done["revision"].as_i64().expect("a number"),
        );
    }
    let expected: BTreeMap<i64, i64> = (0..20).map(|i| (i, i + 3)).collect();
    assert_eq!(revisions, expected);
    let state = did(&mut talk, "state", json!({}));
    assert_eq!(
        state["words"].as_array().and_then(|w| w.last()),
        Some(&json!("step 19"))
    );
    // What was asked for before the input ended is answered.
    talk.send(&request("last", "state", &json!({})));
    let (rest, ended) = talk.end();
    assert!(
        ended && rest.iter().any(|reply| reply["id"] == "last"),
        "{rest:?}"
    );
}

#[test]
fn a_thousand_calls_at_once_are_each_answered_or_refused() {
    let dir = tempfile::tempdir().expect("a folder");
    let mut talk = Talk::start("mcp", dir.path());
    hello(&mut talk);
    did(&mut talk, "state", json!({}));
    let before = talk.most_memory_mib();
    let all: String = (0..1000)
        .map(|i| {
            format!(
                "{}\n",
                request(i, "new", &json!({ "template": "straight", "seed": i % 3 }))
            )
        })
        .collect();
    talk.write(all.as_bytes());
    let (mut done, mut busy) = (0, 0);
    let mut seen = std::collections::BTreeSet::new();
    for _ in 0..1000 {
        let reply = talk.line();
        assert!(seen.insert(reply["id"].as_i64().expect("an id")), "{reply}");
        match receipt(&reply) {
            Ok(_) => done += 1,
            Err(error) => {
                assert!(error.starts_with("busy: 32 calls wait already"), "{error}");
                busy += 1;
            }
        }
    }
    assert!(done >= 32 && busy > 0 && done + busy == 1000, "{done} {busy}");
    let more = talk.most_memory_mib().saturating_sub(before);
    assert!(more < 400, "{more} MiB");
    assert!(did(&mut talk, "state", json!({}))["revision"].as_u64() > Some(1));
    assert!(talk.end().1);
}

#[test]
fn messages_that_are_none_are_refused_and_the_server_lives_on() {
    let dir = tempfile::tempdir().expect("a folder");
    let mut talk = Talk::start("mcp", dir.path());
    hello(&mut talk);
    did(&mut talk, "state", json!({}));
    let before = talk.most_memory_mib();
    let large = "x".repeat(10 << 20);
    let cases: [(String, Value, &str); 9] = [
        (
            request(1, "prompt", &json!({ "text": large })).to_string(),
            json!(1),
            "expected at most 1048576",
        ),
        (
            request("q", "prompt", &json!({ "text": large })).to_string(),
            json!("q"),
            "expected at most 1048576",
        ),
        (
            request(2, "run_code", &json!({ "code": "rm" })).to_string(),
            json!(2),
            "no tool \"run_code\"",
        ),
        (
            request(3, "apply", &json!({ "edits": "all" })).to_string(),
            json!(3),
            "edits",
        ),
        (
            request(4, "show", &json!({ "time_s": "NaN" })).to_string(),
            json!(4),
            "time_s",
        ),
        (
            request(5, "open", &json!({ "file": "../../etc/passwd" })).to_string(),
            json!(5),
            "refused",
        ),
        (
            request(6, "save", &json!({ "file": "/tmp/x.loom" })).to_string(),
            json!(6),
            "refused",
        ),
        (
            "{\"jsonrpc\": \"2.0\", \"id\": 7, \"method\": \"tools/call\", \"params\": NaN}".into(),
            Value::Null,
            "not JSON",
        ),
        (
            "{\"jsonrpc\": \"2.0\", \"id\": 8, \"method\": \"tools/call\", \"params\": 5}".into(),
            json!(8),
            "",
        ),
    ];
    for (line, id, needle) in cases {
        talk.write(line.as_bytes());
        talk.write(b"\n");
        let reply = talk.line();
        assert_eq!(reply["id"], id, "{reply}");
        let error = receipt(&reply).expect_err("refused");
        assert!(error.contains(needle), "{needle}: {error}");
    }
    talk.write(b"hello\n\n{\"jsonrpc\": \"2.0\", \"method\": \"notifications/nonsense\"}\n");
    assert_eq!(talk.line()["id"], Value::Null);
    assert!(did(&mut talk, "state", json!({}))["revision"].is_number());
    let more = talk.most_memory_mib().saturating_sub(before);
    assert!(more < 200, "{more} MiB");
    assert!(talk.end().1);
}

#[test]
fn a_client_that_leaves_at_once_is_no_error() {
    let dir = tempfile::tempdir().expect("a folder");
    let (rest, ended) = Talk::start("mcp", dir.path()).end();
    assert!(rest.is_empty() && ended);
}
