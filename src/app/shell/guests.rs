//! Assistants that drive the editor of the window; off unless the user allows them. Their work arrives as tasks from
//! another thread and is done between two frames. They do slow work themselves, on a copy.

use std::any::Any;
use std::path::PathBuf;
use std::sync::Arc;

use crossbeam_channel::Receiver;

use super::app::{SceneloomApp, one_line};
use editor::Document;
use language::tf;
use runtime::guard::guarded;
use scene::op::Author;

/// A task on the document, to be done by the window's thread.
pub type DocumentTask = Box<dyn FnOnce(&mut Document) + Send>;

/// Requests a frame of the window, in which it does the tasks.
pub type Wake = Arc<dyn Fn() + Send + Sync>;

/// Lets assistants in. The command line gives one to the window, which has no server code.
pub trait AssistantListener {
    /// Begins to listen. The sender of a task calls `wake` after it. Errors in one line.
    fn open(&mut self, wake: Wake) -> anyhow::Result<OpenDoor>;
}

/// An open door; dropping it closes it.
pub struct OpenDoor {
    /// Address for assistants.
    pub url: String,
    /// Token that they must present.
    pub token: String,
    /// The one folder whose files they may read and write.
    pub folder: PathBuf,
    /// Tasks from the assistants.
    pub tasks: Receiver<DocumentTask>,
    /// The listening server.
    pub listening: Box<dyn Any>,
}

/// The door of a window, and whether it is open.
#[derive(Default)]
pub struct Guests {
    door: Option<Box<dyn AssistantListener>>,
    open: Option<OpenDoor>,
    /// The reason why it could not be opened. It is tried again when the user allows assistants again.
    problem: Option<String>,
}

/// Most tasks done between two frames.
const MOST_TASKS: usize = 64;

impl Guests {
    /// Guests with a closed door.
    pub fn new(door: Box<dyn AssistantListener>) -> Self {
        Self {
            door: Some(door),
            ..Self::default()
        }
    }

    /// True if there is a door.
    pub fn are_possible(&self) -> bool {
        self.door.is_some()
    }

    /// The door, if it is open.
    pub fn open(&self) -> Option<&OpenDoor> {
        self.open.as_ref()
    }

    /// The reason why the door is not open although the user allows assistants.
    pub fn problem(&self) -> Option<&str> {
        self.problem.as_deref()
    }

    /// Opens or closes the door by the user's setting. Returns true if opening has just failed.
    fn follow(&mut self, wanted: bool, wake: impl FnOnce() -> Wake) -> bool {
        if !wanted {
            (self.open, self.problem) = (None, None);
            return false;
        }
        let Some(door) = self.door.as_mut() else {
            return false;
        };
        if self.open.is_some() || self.problem.is_some() {
            return false;
        }
        match door.open(wake()) {
            Ok(open) => self.open = Some(open),
            Err(error) => self.problem = Some(one_line(&error)),
        }
        self.problem.is_some()
    }
}

impl SceneloomApp {
    /// Gives the window a door for assistants.
    pub fn with_door(mut self, door: Box<dyn AssistantListener>) -> Self {
        self.guests = Guests::new(door);
        self
    }

    /// Does the tasks that assistants have sent since the last frame.
    pub(crate) fn serve_guests(&mut self, ctx: &egui::Context) {
        let wanted = self.preferences.settings.assistants;
        let wake = || -> Wake {
            let ctx = ctx.clone();
            Arc::new(move || ctx.request_repaint())
        };
        if self.guests.follow(wanted, wake) {
            let why = self.guests.problem().unwrap_or_default().to_owned();
            self.fail(tf!("Assistants cannot come in: {error}", error = why));
        }
        let Some(open) = &self.guests.open else { return };
        let tasks: Vec<DocumentTask> = open.tasks.try_iter().take(MOST_TASKS).collect();
        if tasks.is_empty() {
            return;
        }
        for task in tasks {
            // The document changes completely or not at all.
            let user = self.document.set_author(Author::ASSISTANT);
            let done = guarded("assistant", || task(&mut self.document));
            self.document.set_author(user);
            if let Err(panicked) = done {
                self.fail(panicked.to_string());
            }
        }
        // Objects that they removed are deselected.
        self.state.correcting &= self.document.scene().frame().inferred.any();
        self.state.tidy_selection(self.document.scene());
        ctx.request_repaint();
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crossbeam_channel::{bounded, unbounded};

    /// A door that opens once.
    struct OneTime(Option<Receiver<DocumentTask>>);

    impl AssistantListener for OneTime {
        fn open(&mut self, _: Wake) -> anyhow::Result<OpenDoor> {
            let tasks = self.0.take();
            Ok(OpenDoor {
                url: "http://127.0.0.1:1/mcp".into(),
                token: "t".into(),
                folder: ".".into(),
                tasks: tasks.ok_or_else(|| anyhow::anyhow!("the port is taken"))?,
                listening: Box::new(()),
            })
        }
    }

    #[test]
    fn the_door_follows_the_setting_and_a_failure_is_told_once() {
        let (sender, tasks) = unbounded();
        let mut guests = Guests::new(Box::new(OneTime(Some(tasks))));
        let wake = || -> Wake { Arc::new(|| {}) };
        assert!(!guests.follow(false, wake) && guests.open().is_none());
        assert!(!guests.follow(true, wake) && guests.open().is_some());
        let (answer, answered) = bounded::<()>(1);
        sender.send(Box::new(move |_| drop(answer))).expect("it is open");
        // When the door closes, open tasks are dropped, and their senders get an error.
        assert!(!guests.follow(false, wake) && guests.open().is_none());
        assert!(answered.recv().is_err() && sender.send(Box::new(|_| {})).is_err());
        assert!(guests.follow(true, wake) && guests.problem() == Some("the port is taken"));
        assert!(!guests.follow(true, wake), "told once");
        assert!(!guests.follow(false, wake) && guests.problem().is_none());
    }
}
