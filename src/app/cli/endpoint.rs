//! A language model as a reader: it is given the words and the schema of readings, and answers with a reading. An
//! OpenAI-compatible endpoint (Ollama, llama.cpp, vLLM); off unless one is named. Built without TLS: http:// only.

use std::time::Duration;

use anyhow::{Context, bail};
use serde_json::{Value, json};

use scene::Scene;
use words::notation;
use words::reader::Mode;
use words::reading::Reading;

/// Largest answer that is read, bytes.
const LARGEST_ANSWER: u64 = 1 << 20;
/// Most acts of an answer.
const MOST_ACTS: usize = 100;
/// Boxes that are described to the model.
const MOST_BOXES: usize = 60;

/// Language model that is asked, and its server.
#[derive(Clone, Debug, PartialEq)]
pub struct Endpoint {
    /// `http://host:port`, with or without `/v1`.
    pub url: String,
    /// Name of the model.
    pub model: String,
    /// How long to wait.
    pub timeout: Duration,
}

/// The JSON Schema of readings.
pub fn schema() -> Value {
    schemars::schema_for!(Reading).to_value()
}

/// Rules for the model beside the schema.
const RULES: &str = "You turn a user's English sentence for a driving-scene editor into a reading: a JSON object of the given \
schema and nothing else. \"add\" brings new things; \"remove\", \"move\", \"set\", \"replace\", \"turn\" and \"count\" change things that \
are there. Write what is said and no more: no relation, state or number that is not in the sentence. The ego vehicle (me, us, \
our car) is the anchor \"ego\"; what stands beside the road (buildings, trees, hedges, lamps) is \"background\", all else \"acts\"; left and right are as it sees them; distances are metres. \"the car\" has the quantity \"the\", \
\"all cars\" and \"the cars\" have \"all\", \"two cars\" of new things have {\"n\": 2}.";

fn request(text: &str, mode: Mode, scene: Option<&Scene>, model: &str) -> Value {
    let task = match mode {
        Mode::Prompt => "The sentence describes a new scene.".to_owned(),
        Mode::Edit => {
            let boxes = scene.map(boxes_in_words).unwrap_or_default();
            format!("The sentence changes a scene that holds: {boxes}.")
        }
    };
    json!({
        "model": model,
        "temperature": 0,
        "stream": false,
        "response_format": {
            "type": "json_schema",
            "json_schema": { "name": "reading", "strict": true, "schema": schema() },
        },
        "messages": [
            { "role": "system", "content": format!("{RULES} {task} Schema: {}", schema()) },
            { "role": "user", "content": text },
        ],
    })
}

/// Boxes of a scene, each in a few words.
fn boxes_in_words(scene: &Scene) -> String {
    let one = |b: &scene::SceneBox| {
        let (x, y) = (b.center_m.x, b.center_m.y);
        let along = if x >= 0.0 { "ahead" } else { "behind" };
        let side = if y >= 0.0 { "left" } else { "right" };
        format!(
            "{} #{} ({:.0} m {along}, {:.0} m {side})",
            b.called(),
            b.id.0,
            x.abs(),
            y.abs()
        )
    };
    let boxes: Vec<String> = scene.frame().boxes.values().take(MOST_BOXES).map(one).collect();
    if boxes.is_empty() {
        "nothing".into()
    } else {
        boxes.join(", ")
    }
}

/// Asks the model for the reading of a text.
///
/// # Errors
///
/// In one line: another scheme than http, no connection, time-out, a status other than 2xx, an answer that is too long or
/// no reading.
pub fn read(endpoint: &Endpoint, text: &str, mode: Mode, scene: Option<&Scene>) -> anyhow::Result<Reading> {
    let url = &endpoint.url;
    if !url.starts_with("http://") {
        bail!(
            "--endpoint is {url:?}, expected http://...: this program is built without TLS; run the model locally or behind a local proxy"
        );
    }
    let base = url.trim_end_matches('/');
    let url = if base.ends_with("/chat/completions") {
        base.to_string()
    } else if base.ends_with("/v1") {
        format!("{base}/chat/completions")
    } else {
        format!("{base}/v1/chat/completions")
    };
    let agent: ureq::Agent = ureq::Agent::config_builder()
        .timeout_global(Some(endpoint.timeout))
        .http_status_as_error(false)
        .build()
        .into();
    let mut response = agent
        .post(&url)
        .header("content-type", "application/json")
        .send(request(text, mode, scene, &endpoint.model).to_string())
        .with_context(|| format!("ask {url}"))?;
    let status = response.status();
    let body = response
        .body_mut()
        .with_config()
        .limit(LARGEST_ANSWER)
        .read_to_string()
        .with_context(|| format!("read the answer of {url}"))?;
    if !status.is_success() {
        let head: String = body.chars().take(120).collect();
        bail!("{url} answered {status}: {}", head.replace(['\n', '\r'], " "));
    }
    let answer: Value =
        serde_json::from_str(&body).with_context(|| format!("{url}: the answer is no JSON"))?;
    let content = answer
        .pointer("/choices/0/message/content")
        .and_then(Value::as_str)
        .with_context(|| format!("{url}: choices[0].message.content is missing"))?;
    let content = content
        .trim()
        .trim_start_matches("```json")
        .trim_matches('`')
        .trim();
    checked(content).with_context(|| format!("{url}: the model's answer is no reading"))
}

/// A reading that can be carried out: of the schema, of a sane size, and sayable in notation.
fn checked(content: &str) -> anyhow::Result<Reading> {
    let reading: Reading = serde_json::from_str(content)?;
    let n = reading.acts.len() + reading.background.len();
    if n == 0 || n > MOST_ACTS {
        bail!("{n} acts, expected 1 to {MOST_ACTS}");
    }
    if let Some(problem) = reading.background.iter().find_map(|s| s.problem()) {
        bail!("background: {problem}");
    }
    // (a reading that the notation cannot express, such as a number that is not finite, is refused)
    let line = notation::write(&reading);
    if line.len() > notation::LONGEST {
        bail!(
            "{} letters of notation, expected at most {}",
            line.len(),
            notation::LONGEST
        );
    }
    let mut checked = Reading::default();
    if !reading.acts.is_empty() {
        checked = notation::parse(&line).map_err(|e| anyhow::anyhow!("{e}"))?;
    }
    checked.background = reading.background;
    Ok(checked)
}

#[cfg(test)]
mod tests {
    use std::io::{BufRead, Read, Write};
    use std::net::TcpListener;

    use super::*;

    /// A server that answers one request with `status` and `body`, or never if `body` is `None`; what it was asked.
    fn server(status: &'static str, body: Option<String>) -> (String, std::thread::JoinHandle<String>) {
        let listener = TcpListener::bind("127.0.0.1:0").expect("a free port");
        let url = format!("http://{}", listener.local_addr().expect("bound"));
        let thread = std::thread::spawn(move || {
            let Ok((mut stream, _)) = listener.accept() else {
                return String::new();
            };
            let asked = read_request(&mut stream);
            match body {
                Some(body) => {
                    let head = format!(
                        "HTTP/1.1 {status}\r\ncontent-type: application/json\r\ncontent-length: {}\r\nconnection: close\r\n\r\n",
                        body.len()
                    );
                    let _ = stream.write_all(head.as_bytes());
                    let _ = stream.write_all(body.as_bytes());
                }
                None => std::thread::sleep(Duration::from_secs(2)),
            }
            asked
        });
        (url, thread)
    }

    /// Reads a request whole: a socket that is closed with bytes unread resets the connection, and the answer is lost.
    fn read_request(stream: &mut std::net::TcpStream) -> String {
        let mut reader = std::io::BufReader::new(stream);
        let mut length = 0;
        let mut line = String::new();
        while reader.read_line(&mut line).is_ok_and(|n| n > 2) {
            if let Some((key, value)) = line.split_once(':')
                && key.eq_ignore_ascii_case("content-length")
            {
                length = value.trim().parse().expect("a length");
            }
            line.clear();
        }
        let mut body = vec![0; length];
        let _ = reader.read_exact(&mut body);
        String::from_utf8_lossy(&body).into_owned()
    }

    fn says(content: &str) -> Option<String> {
        Some(json!({ "choices": [{ "message": { "content": content } }] }).to_string())
    }

    fn ask(url: &str, mode: Mode, timeout: Duration) -> anyhow::Result<Reading> {
        let endpoint = Endpoint {
            url: url.into(),
            model: "tiny".into(),
            timeout,
        };
        read(&endpoint, "two cars at night", mode, None)
    }

    #[test]
    fn a_reading_is_asked_for_by_its_schema_and_taken() {
        let content = r#"{"acts": [{"act": "add", "things": [{"noun": "car", "quantity": {"n": 2}}]}, {"act": "time", "what": "night"}],
            "background": [{"verb": "have", "what": {"tree": null}, "plural": true, "place": {"side": "left"}}]}"#;
        for mode in [Mode::Prompt, Mode::Edit] {
            let (url, asked) = server("200 OK", says(content));
            let reading = ask(&url, mode, Duration::from_secs(60)).expect("a reading");
            assert_eq!(notation::write(&reading), "add 2 car ; time night");
            assert_eq!(reading.background[0].described(), "trees on the left");
            let asked: Value = serde_json::from_str(&asked.join().expect("asked")).expect("JSON");
            let sent = &asked["response_format"]["json_schema"]["schema"];
            assert_eq!(*sent, schema());
            assert!(sent.to_string().contains("right_roadside"), "{sent}");
        }
    }

    #[test]
    fn bad_answers_are_named_in_one_line() {
        let long = Duration::from_secs(60);
        let huge = format!("{{\"acts\": [{}]}}", "\"x\",".repeat(400_000));
        let cases = [
            (says(r#"{"mood": "gloomy"}"#), "200 OK", "no reading"),
            (says(r#"{"acts": [{"act": "dance"}]}"#), "200 OK", "no reading"),
            (says(r#"{"acts": []}"#), "200 OK", "no reading"),
            (
                says(r#"{"acts": [{"act": "add", "things": [{"noun": "dragon"}]}]}"#),
                "200 OK",
                "no reading",
            ),
            (
                says(
                    r#"{"acts": [{"act": "move", "who": [{"noun": "car"}], "to": {"by": {"way": "left", "metres": 1e999}}}]}"#,
                ),
                "200 OK",
                "no reading",
            ),
            (
                says(
                    r#"{"acts": [], "background": [{"verb": "add", "what": {"tree": null}, "count": 4000000000}]}"#,
                ),
                "200 OK",
                "a count above 500",
            ),
            (says(&huge), "200 OK", "read the answer"),
            (Some("not json".into()), "200 OK", "no JSON"),
            (Some("{}".into()), "200 OK", "choices"),
            (
                Some("broken\nin two lines".into()),
                "500 Internal Server Error",
                "500",
            ),
        ];
        for (body, status, needle) in cases {
            let (url, _) = server(status, body);
            let error = format!("{:#}", ask(&url, Mode::Edit, long).expect_err("refused"));
            assert!(error.contains(needle), "{needle:?} is not in {error}");
            assert_eq!(error.lines().count(), 1, "{error}");
        }
        for (url, needle) in [("https://example.org", "TLS"), ("http://127.0.0.1:1", "ask")] {
            let error = format!("{:#}", ask(url, Mode::Prompt, long).expect_err("refused"));
            assert!(error.contains(needle), "{needle:?} is not in {error}");
        }
        let (url, _) = server("200 OK", None);
        let slow = ask(&url, Mode::Prompt, Duration::from_millis(300)).expect_err("timed out");
        assert!(format!("{slow:#}").contains("timeout"));
    }
}
