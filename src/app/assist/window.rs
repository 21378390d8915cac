//! Assistants in a running window: an MCP server over HTTP whose calls reach the document by tasks.

use std::net::{Ipv4Addr, SocketAddr};
use std::path::PathBuf;

use anyhow::Context;
use crossbeam_channel::unbounded;

use crate::desk::{Desk, DocumentTask, Holder};
use crate::folder::Folder;
use crate::mcp::{http, random_token};
use crate::service::Service;
use app::shell::guests::{AssistantListener, OpenDoor, Wake};

/// The port that is tried first, so that clients find the window again.
pub const PORT: u16 = 7333;

/// The door of a window.
pub struct WindowDoor {
    /// The one folder whose files calls may read and write.
    pub folder: PathBuf,
    /// The port that is tried first; if it is taken, any free one is used.
    pub port: u16,
}

impl AssistantListener for WindowDoor {
    fn open(&mut self, wake: Wake) -> anyhow::Result<OpenDoor> {
        let folder = Folder::new(&self.folder)?;
        let (sender, tasks) = unbounded();
        let hand = move |task: DocumentTask| {
            let sent = sender.send(task).is_ok();
            wake();
            sent
        };
        let root = folder.root().to_owned();
        let make = move || Desk::new(Holder::Elsewhere(Box::new(hand)), folder, None);
        let (service, _) = Service::start(make).context("start a thread for assistants")?;
        let token = random_token()?;
        let at = |port: u16| SocketAddr::from((Ipv4Addr::LOCALHOST, port));
        let server = http(service.clone(), at(self.port), token.clone())
            .or_else(|_| http(service, at(0), token.clone()))?;
        Ok(OpenDoor {
            url: server.url(),
            token,
            folder: root,
            tasks,
            listening: Box::new(server),
        })
    }
}
