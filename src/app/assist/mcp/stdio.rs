//! MCP over standard input and output: one JSON-RPC message a line.

use std::io::{self, BufRead, Write};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::Duration;

use anyhow::Context;
use rmcp::model::ClientJsonRpcMessage;
use rmcp::service::{RxJsonRpcMessage, TxJsonRpcMessage};
use rmcp::transport::Transport;
use rmcp::{RoleServer, serve_server};
use serde_json::{Value, json};
use tokio::sync::mpsc;

use super::server::{Server, too_long};
use crate::LONGEST_CALL;
use crate::lines::{InputLine, next_line};
use crate::service::Service;
use scene::message::one_line;

/// Messages that are read ahead.
const AHEAD: usize = 4;
/// Size of a message without the arguments of its call, at most, bytes.
const ENVELOPE: usize = 4096;
/// How often it is asked whether all calls are answered, once the input has ended.
const POLL: Duration = Duration::from_millis(10);

const PARSE_ERROR: i32 = -32700;
const INVALID_REQUEST: i32 = -32600;

/// Output for replies, each as a whole line.
type Output = Arc<Mutex<dyn Write + Send>>;

/// Serves a client until the input ends and all calls are answered. Errors only if the system gives no thread.
pub fn stdio(
    service: Service,
    input: impl BufRead + Send + 'static,
    output: impl Write + Send + 'static,
) -> anyhow::Result<()> {
    let runtime = tokio::runtime::Builder::new_current_thread()
        .enable_time()
        .build()
        .context("start the server")?;
    runtime.block_on(async {
        let output: Output = Arc::new(Mutex::new(output));
        let (ahead, messages) = mpsc::channel(AHEAD);
        let replies = output.clone();
        std::thread::Builder::new()
            .name("mcp input".into())
            .spawn(move || read(input, &ahead, &replies))
            .context("start the server")?;
        let lines = Lines {
            messages,
            output,
            service: service.clone(),
        };
        // A client that leaves before it has said hello is no error.
        if let Ok(running) = serve_server(Server::new(service), lines).await {
            running.waiting().await.ok();
        }
        Ok(())
    })
}

/// Reads messages until the input ends or the receiver is gone. Input that is no message is refused at once.
fn read(mut input: impl BufRead, ahead: &mpsc::Sender<ClientJsonRpcMessage>, output: &Output) {
    let refuse = |id: Value, code: i32, message: &str| {
        let error = json!({ "code": code, "message": one_line(message) });
        let reply = json!({ "jsonrpc": "2.0", "id": id, "error": error });
        // (an output that fails ends the server elsewhere)
        let _ = write(output, &reply);
    };
    while let Ok(Some(line)) = next_line(&mut input, LONGEST_CALL + ENVELOPE) {
        let line = match line {
            InputLine::Whole(line) if line.trim_ascii().is_empty() => continue,
            InputLine::Whole(line) => line,
            InputLine::TooLong { id, bytes } => {
                refuse(id.unwrap_or_default(), INVALID_REQUEST, &too_long(bytes));
                continue;
            }
        };
        match serde_json::from_slice(&line) {
            Ok(message) => {
                if ahead.blocking_send(message).is_err() {
                    return;
                }
            }
            Err(error) => {
                let found: Result<Value, _> = serde_json::from_slice(&line);
                match found {
                    Ok(value) => {
                        let id = value.get("id").filter(|id| id.is_number() || id.is_string());
                        // (an unknown notification is nothing to answer)
                        if id.is_some() || value.get("method").is_none() {
                            let wrong = format!("not a message of the protocol: {error}");
                            refuse(id.cloned().unwrap_or_default(), INVALID_REQUEST, &wrong);
                        }
                    }
                    Err(error) => refuse(Value::Null, PARSE_ERROR, &format!("not JSON: {error}")),
                }
            }
        }
    }
}

/// Writes a value as one line.
fn write(output: &Output, value: &impl serde::Serialize) -> io::Result<()> {
    let mut line = serde_json::to_vec(value)?;
    line.push(b'\n');
    let mut output = output.lock().unwrap_or_else(PoisonError::into_inner);
    output.write_all(&line)?;
    output.flush()
}

/// Messages in lines, as a transport of rmcp. A client that does not read its replies is waited for: nothing piles up.
struct Lines {
    messages: mpsc::Receiver<ClientJsonRpcMessage>,
    output: Output,
    service: Service,
}

impl Transport<RoleServer> for Lines {
    type Error = io::Error;

    fn send(
        &mut self,
        item: TxJsonRpcMessage<RoleServer>,
    ) -> impl Future<Output = Result<(), io::Error>> + Send + 'static {
        let output = self.output.clone();
        async move { write(&output, &item) }
    }

    async fn receive(&mut self) -> Option<RxJsonRpcMessage<RoleServer>> {
        let message = self.messages.recv().await;
        if message.is_none() {
            // The input has ended: calls that were made are still answered.
            while !self.service.is_idle() {
                tokio::time::sleep(POLL).await;
            }
        }
        message
    }

    async fn close(&mut self) -> Result<(), io::Error> {
        Ok(())
    }
}
