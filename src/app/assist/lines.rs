//! Lines of bounded length. Of a line that is too long nothing is kept but the id of the request in it, so that it can be refused.

use std::io::{self, BufRead};

use serde_json::Value;

/// A line of the input.
#[derive(Debug, PartialEq)]
pub enum InputLine {
    /// All of it, without its end.
    Whole(Vec<u8>),
    /// A line that was longer than allowed and was passed over.
    TooLong {
        /// The value of the key `id` of the object that it began with, if that was found.
        id: Option<Value>,
        /// Its length.
        bytes: u64,
    },
}

/// The next line; `None` at the end of the input. A line has at most `most` bytes.
pub fn next_line(input: &mut impl BufRead, most: usize) -> io::Result<Option<InputLine>> {
    let mut line = Vec::new();
    let mut long: Option<(IdFinder, u64)> = None;
    loop {
        let chunk = match input.fill_buf() {
            Ok(chunk) => chunk,
            Err(e) if e.kind() == io::ErrorKind::Interrupted => continue,
            Err(e) => return Err(e),
        };
        if chunk.is_empty() {
            return Ok(match (long, line.is_empty()) {
                (Some((finder, bytes)), _) => Some(too_long(finder, bytes)),
                (None, true) => None,
                (None, false) => Some(InputLine::Whole(line)),
            });
        }
        let end = chunk.iter().position(|b| *b == b'\n');
        let part = &chunk[..end.unwrap_or(chunk.len())];
        let taken = part.len() + usize::from(end.is_some());
        match &mut long {
            Some((finder, bytes)) => {
                finder.read(part);
                *bytes += part.len() as u64;
            }
            None if line.len() + part.len() > most => {
                let mut finder = IdFinder::default();
                finder.read(&line);
                finder.read(part);
                long = Some((finder, (line.len() + part.len()) as u64));
                line = Vec::new();
            }
            None => line.extend_from_slice(part),
        }
        input.consume(taken);
        if end.is_some() {
            return Ok(Some(match long {
                Some((finder, bytes)) => too_long(finder, bytes),
                None => {
                    if line.last() == Some(&b'\r') {
                        line.pop();
                    }
                    InputLine::Whole(line)
                }
            }));
        }
    }
}

fn too_long(finder: IdFinder, bytes: u64) -> InputLine {
    InputLine::TooLong {
        id: finder.id(),
        bytes,
    }
}

/// Finds the value of the key `id` of the outermost object while a text passes by.
#[derive(Default)]
struct IdFinder {
    depth: usize,
    in_string: bool,
    escaped: bool,
    /// A string of the outermost object, which may be a key.
    string: Vec<u8>,
    /// True if the last token of the outermost object was a string.
    key: bool,
    /// Bytes of the value, once the key has come by.
    value: Option<Vec<u8>>,
    done: bool,
}

/// Longest id, bytes.
const LONGEST_ID: usize = 200;

impl IdFinder {
    fn read(&mut self, bytes: &[u8]) {
        for byte in bytes {
            if self.done {
                return;
            }
            self.step(*byte);
        }
    }

    fn step(&mut self, byte: u8) {
        if self.in_string {
            match (self.escaped, byte) {
                (true, _) => self.escaped = false,
                (false, b'\\') => self.escaped = true,
                (false, b'"') => (self.in_string, self.key) = (false, self.depth == 1),
                _ => {}
            }
            if self.in_string && self.depth == 1 && self.string.len() <= LONGEST_ID {
                self.string.push(byte);
            }
            return self.keep(byte);
        }
        match byte {
            b'"' => {
                self.in_string = true;
                self.string.clear();
            }
            b'{' | b'[' => self.depth += 1,
            b'}' | b']' => {
                self.depth = self.depth.saturating_sub(1);
                self.done |= self.depth == 0;
            }
            b',' if self.depth == 1 => {
                self.key = false;
                self.done |= self.value.is_some();
            }
            b':' if self.depth == 1 && self.key => {
                self.key = false;
                if self.string == b"id" {
                    self.value = Some(Vec::new());
                    return;
                }
            }
            _ => {}
        }
        if !self.done {
            self.keep(byte);
        }
    }

    fn keep(&mut self, byte: u8) {
        if let Some(value) = &mut self.value {
            match value.len() < LONGEST_ID {
                true => value.push(byte),
                false => (self.value, self.done) = (None, true),
            }
        }
    }

    fn id(self) -> Option<Value> {
        let value: Value = serde_json::from_slice(&self.value?).ok()?;
        (value.is_number() || value.is_string()).then_some(value)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;
    use std::io::BufReader;

    fn all(text: &[u8], most: usize, buffer: usize) -> Vec<InputLine> {
        let mut input = BufReader::with_capacity(buffer, text);
        let mut out = Vec::new();
        while let Some(line) = next_line(&mut input, most).expect("memory does not fail") {
            out.push(line);
        }
        out
    }

    #[test]
    fn long_lines_are_passed_over_and_their_ids_are_found() {
        let x = "x".repeat(90);
        let cases = [
            (format!("{{\"id\": 7, \"a\": \"{x}\"}}"), Some(json!(7))),
            (
                format!("{{\"a\": \"{x}\", \"id\": \"q\\\"1\"}}"),
                Some(json!("q\"1")),
            ),
            (
                format!("{{\"a\": {{\"id\": 1, \"x\": \"{x}\"}}, \"id\":2}}"),
                Some(json!(2)),
            ),
            (
                format!("{{\"a\": [\"id\", {{\"id\": 3}}], \"b\": \"id\", \"c\": \"{x}\"}}"),
                None,
            ),
            (format!("{{\"a\": \"\\\"id\\\": 4 {x}\"}}"), None),
            (format!("{{\"id\": [1], \"a\": \"{x}\"}}"), None),
            (format!("{{\"id\": \"{}\"", "y".repeat(500)), None),
            (x.clone(), None),
        ];
        for buffer in [1, 7, 4096] {
            for (text, id) in &cases {
                let whole = format!("{{}}\n{text}\r\n{text}\n[1]");
                let lines = all(whole.as_bytes(), 80, buffer);
                assert_eq!(lines.len(), 4, "{text}");
                assert_eq!(lines[0], InputLine::Whole(b"{}".to_vec()));
                for (line, more) in [(&lines[1], 1), (&lines[2], 0)] {
                    let bytes = text.len() as u64 + more;
                    let expected = InputLine::TooLong {
                        id: id.clone(),
                        bytes,
                    };
                    assert_eq!(*line, expected, "{text} {buffer}");
                }
                assert_eq!(lines[3], InputLine::Whole(b"[1]".to_vec()));
            }
        }
        assert_eq!(all(b"", 8, 8), []);
        assert_eq!(
            all(b"\n\n", 8, 8),
            [InputLine::Whole(vec![]), InputLine::Whole(vec![])]
        );
    }
}
