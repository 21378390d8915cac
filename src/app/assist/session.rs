//! A session as JSON lines: one call a line in, one reply a line out, in order.

use std::io::{self, BufRead, Write};

use serde_json::{Map, Value, json};

use crate::LONGEST_CALL;
use crate::call::Call;
use crate::desk::Desk;
use crate::lines::{InputLine, next_line};
use runtime::guard::guarded;
use scene::message::{one_line, quoted};

/// Answers every line until the input ends. Errors only if input or output fail.
pub fn session(desk: &mut Desk, mut input: impl BufRead, mut output: impl Write) -> io::Result<()> {
    while let Some(line) = next_line(&mut input, LONGEST_CALL)? {
        let reply = match line {
            InputLine::Whole(line) if line.trim_ascii().is_empty() => continue,
            InputLine::Whole(line) => reply_to(desk, &line),
            InputLine::TooLong { id, bytes } => {
                let error = format!("the line has {bytes} bytes, expected at most {LONGEST_CALL}");
                failed(id.unwrap_or_default(), &error)
            }
        };
        serde_json::to_writer(&mut output, &reply)?;
        output.write_all(b"\n")?;
        output.flush()?;
    }
    Ok(())
}

fn failed(id: Value, error: &str) -> Value {
    json!({ "id": id, "ok": false, "error": one_line(error) })
}

fn reply_to(desk: &mut Desk, line: &[u8]) -> Value {
    let request = match serde_json::from_slice(line) {
        Ok(Value::Object(request)) => request,
        Ok(_) => {
            return failed(
                Value::Null,
                "the line is no JSON object, expected id, call and args",
            );
        }
        Err(e) => return failed(Value::Null, &format!("the line is no JSON: {e}")),
    };
    // (a reply repeats the id, so its length is bounded)
    let id = request.get("id").cloned().unwrap_or_default();
    let id = match &id {
        Value::Number(_) | Value::Null => id,
        Value::String(text) if text.len() <= 200 => id,
        _ => {
            return failed(
                Value::Null,
                "id is neither a number nor a string of at most 200 bytes",
            );
        }
    };
    let (call, args) = match parts(request) {
        Ok(parts) => parts,
        Err(error) => return failed(id, &error),
    };
    match guarded("session", || Call::answer(&call, args, desk)) {
        Ok(Ok(answer)) => json!({ "id": id, "ok": true, "receipt": answer.receipt }),
        Ok(Err(error)) => failed(id, &error),
        Err(panicked) => failed(id, &panicked.to_string()),
    }
}

/// The name of the call and its arguments.
fn parts(mut request: Map<String, Value>) -> Result<(String, Map<String, Value>), String> {
    request.remove("id");
    let call = match request.remove("call") {
        Some(Value::String(call)) => call,
        Some(_) => return Err("call is no string, expected the name of a call".into()),
        None => return Err("call is missing, expected the name of a call".into()),
    };
    let args = match request.remove("args") {
        Some(Value::Object(args)) => args,
        None => Map::new(),
        Some(_) => return Err("args is no object".into()),
    };
    match request.keys().next() {
        Some(key) => Err(format!(
            "unknown key {:?}, expected id, call, args",
            quoted(key, 40)
        )),
        None => Ok((call, args)),
    }
}
