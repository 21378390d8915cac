//! What a prompt leaves open, filled in by a language model behind an OpenAI-compatible endpoint (Ollama, llama.cpp,
//! vLLM). Off unless an endpoint is named. Built without TLS: http:// only.

use std::time::Duration;

use anyhow::{Context, bail};
use serde::Deserialize;
use serde_json::{Value, json};

use crate::generation::text::description::{
    Count, Density, Description, Environment, ObjectSpec, TimeOfDay, Weather,
};
use crate::generation::text::tokens::Span;
use crate::scene::Class;

/// Largest answer that is read, bytes.
const LARGEST_ANSWER: u64 = 1 << 20;

/// What the model may say; anything else is an error.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct Filled {
    #[serde(default)]
    time_of_day: Option<TimeOfDay>,
    #[serde(default)]
    weather: Option<Weather>,
    #[serde(default)]
    environment: Option<Environment>,
    #[serde(default)]
    density: Option<Density>,
    #[serde(default)]
    background: Vec<String>,
    #[serde(default)]
    objects: Vec<FilledObject>,
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct FilledObject {
    class: Class,
    count: u32,
}

fn request(prompt: &str, model: &str) -> Value {
    let names = |v: Vec<&str>| v.join("|");
    let classes: Vec<&str> = Class::OBJECTS.iter().map(|c| c.name()).collect();
    let schema = format!(
        "Answer with one JSON object and nothing else. Keys, all optional: time_of_day ({}), weather ({}), environment ({}), \
         density ({}), background (list of strings), objects (list of {{\"class\": {}, \"count\": 1 to 20}}). \
         Fill in what the user's driving scene leaves open; contradict nothing that it says.",
        names(TimeOfDay::ALL.iter().map(|t| t.name()).collect()),
        names(Weather::ALL.iter().map(|t| t.name()).collect()),
        names(Environment::ALL.iter().map(|t| t.name()).collect()),
        names(Density::ALL.iter().map(|t| t.name()).collect()),
        names(classes),
    );
    json!({
        "model": model,
        "temperature": 0,
        "stream": false,
        "response_format": { "type": "json_object" },
        "messages": [{ "role": "system", "content": schema }, { "role": "user", "content": prompt }],
    })
}

/// Asks the model and fills what the description leaves open; what the prompt said stays. Answers what was filled in, in
/// words. Errors in one line: another scheme than http, no connection, time-out, a status other than 2xx, an answer that
/// is no JSON of the expected keys and values.
pub fn enrich(
    description: &mut Description,
    prompt: &str,
    endpoint: &str,
    model: &str,
    timeout: Duration,
) -> anyhow::Result<Vec<String>> {
    if !endpoint.starts_with("http://") {
        bail!(
            "--endpoint is {endpoint:?}, expected http://...: this program is built without TLS; run the model locally or behind a local proxy"
        );
    }
    let base = endpoint.trim_end_matches('/');
    let url = if base.ends_with("/chat/completions") {
        base.to_string()
    } else if base.ends_with("/v1") {
        format!("{base}/chat/completions")
    } else {
        format!("{base}/v1/chat/completions")
    };
    let agent: ureq::Agent = ureq::Agent::config_builder()
        .timeout_global(Some(timeout))
        .http_status_as_error(false)
        .build()
        .into();
    let mut response = agent
        .post(&url)
        .header("content-type", "application/json")
        .send(request(prompt, model).to_string())
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
        bail!("{url} answered {status}: {}", head.replace('\n', " "));
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
    let filled: Filled = serde_json::from_str(content)
        .with_context(|| format!("{url}: the model's answer does not fit the schema"))?;
    if let Some(o) = filled
        .objects
        .iter()
        .find(|o| !o.class.is_object() || !(1..=20).contains(&o.count))
    {
        bail!(
            "{url}: the model asked for {} x {}, expected 1 to 20 of an object class",
            o.count,
            o.class.name()
        );
    }
    Ok(fill(description, filled))
}

fn fill(d: &mut Description, filled: Filled) -> Vec<String> {
    let mut notes = Vec::new();
    let mut said = |what: String| notes.push(format!("the language model filled in: {what}"));
    if let (None, Some(v)) = (d.time_of_day, filled.time_of_day) {
        d.time_of_day = Some(v);
        said(v.name().into());
    }
    if let (None, Some(v)) = (d.weather, filled.weather) {
        d.weather = Some(v);
        said(v.name().into());
    }
    if let (None, Some(v)) = (d.environment, filled.environment) {
        d.environment = Some(v);
        said(v.name().into());
    }
    if let (None, Some(v)) = (d.density, filled.density) {
        d.density = Some(v);
        said(format!("{} traffic", v.name()));
    }
    if d.background.is_empty() && !filled.background.is_empty() {
        d.background = filled.background.into_iter().take(12).collect();
        said(d.background.join(", "));
    }
    // Objects only of classes that the prompt neither named nor denied.
    for o in filled.objects {
        let named = d.foreground.iter().any(|f| f.class == o.class)
            || d.absent.iter().any(|a| a.classes.contains(&o.class));
        if named {
            continue;
        }
        said(format!("{} x {}", o.count, o.class.label()));
        d.foreground.push(ObjectSpec {
            class: o.class,
            noun: o.class.label(),
            count: Count::exactly(o.count),
            state: None,
            size: None,
            color: None,
            attributes: Vec::new(),
            size_m: None,
            relations: Vec::new(),
            span: Span { start: 0, end: 0 },
        });
    }
    d.summarise();
    notes
}

#[cfg(test)]
mod tests {
    use std::io::{BufRead, Read, Write};
    use std::net::TcpListener;

    use super::*;
    use crate::generation::text::read;

    /// A server that answers one request with `status` and `body`, or never if `body` is `None`.
    fn server(status: &'static str, body: Option<String>) -> String {
        let listener = TcpListener::bind("127.0.0.1:0").expect("a free port");
        let url = format!("http://{}", listener.local_addr().expect("bound"));
        std::thread::spawn(move || {
            let Ok((mut stream, _)) = listener.accept() else {
                return;
            };
            read_request(&mut stream);
            match body {
                Some(body) => {
                    let head = format!(
                        "HTTP/1.1 {status}\r\ncontent-type: application/json\r\ncontent-length: {}\r\nconnection: close\r\n\r\n",
                        body.len()
                    );
                    let _ = stream.write_all(head.as_bytes());
                    let _ = stream.write_all(body.as_bytes());
                }
                None => std::thread::sleep(Duration::from_secs(20)),
            }
        });
        url
    }

    /// Reads a request whole: a socket that is closed with bytes unread resets the connection, and the answer is lost.
    fn read_request(stream: &mut std::net::TcpStream) {
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
        let _ = reader.read_exact(&mut vec![0; length]);
    }

    fn says(content: &str) -> Option<String> {
        Some(json!({ "choices": [{ "message": { "content": content } }] }).to_string())
    }

    fn ask(prompt: &str, url: &str, timeout: Duration) -> (Description, anyhow::Result<Vec<String>>) {
        let mut d = read(prompt).description;
        let result = enrich(&mut d, prompt, url, "tiny", timeout);
        (d, result)
    }

    #[test]
    fn fills_what_is_open_and_keeps_what_was_said() {
        let long = Duration::from_secs(60);
        let url = server(
            "200 OK",
            says(
                r#"{"time_of_day": "day", "weather": "rain", "objects": [{"class": "bus", "count": 9}, {"class": "car", "count": 2}]}"#,
            ),
        );
        let (d, notes) = ask("a bus at night", &url, long);
        assert_eq!(notes.expect("a good answer").len(), 2);
        assert_eq!(d.time_of_day, Some(TimeOfDay::Night));
        assert_eq!(d.weather, Some(Weather::Rain));
        let counts: Vec<_> = d.foreground.iter().map(|o| (o.class, o.count.n)).collect();
        assert_eq!(counts, [(Class::Bus, 1), (Class::Car, 2)]);
    }

    #[test]
    fn bad_answers_are_named_and_change_nothing() {
        let long = Duration::from_secs(60);
        let before = read("a bus").description;
        let cases = [
            (server("200 OK", says(r#"{"mood": "gloomy"}"#)), "schema"),
            (server("200 OK", says(r#"{"weather": "plasma"}"#)), "schema"),
            (
                server(
                    "200 OK",
                    says(r#"{"objects": [{"class": "car", "count": 4000}]}"#),
                ),
                "1 to 20",
            ),
            (server("200 OK", Some("not json".into())), "no JSON"),
            (server("200 OK", Some("{}".into())), "choices"),
            (server("500 Internal Server Error", Some("broken".into())), "500"),
            ("https://example.org".into(), "TLS"),
            ("http://127.0.0.1:1".into(), "ask"),
        ];
        for (url, needle) in cases {
            let (d, result) = ask("a bus", &url, long);
            let error = format!("{:#}", result.expect_err("refused"));
            assert!(error.contains(needle), "{needle:?} is not in {error}");
            assert_eq!(d, before);
        }
        let (_, result) = ask("a bus", &server("200 OK", None), Duration::from_millis(300));
        assert!(format!("{:#}", result.expect_err("timed out")).contains("timeout"));
    }
}
