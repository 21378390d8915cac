//! Groups, hidden and locked objects: commands for the selection, and edits that locks prevent.

use language::{t, tf};

use crate::arranging::{arranging, label};
use crate::shell::app::SceneloomApp;
use crate::shell::toasts::MessageLevel;
use crate::tools::Choose;
use editor::{Edit, arranged};
use scene::{Arrangement, BoxId, Members};

impl SceneloomApp {
    fn members(&self) -> Members {
        let things = self.state.tools.things.chosen.iter().copied();
        Members::of(self.state.chosen(), things)
    }

    /// Arranges the selection. Locking a selection that is locked already unlocks it.
    pub(super) fn arrange(&mut self, how: Arrangement) {
        let chosen = self.members();
        let arranged = self.document.settled_scene().arranged.clone();
        let how = match how {
            Arrangement::Lock if !chosen.is_empty() && chosen.is_within(&arranged.locked) => {
                Arrangement::Unlock
            }
            how => how,
        };
        if chosen.is_empty() {
            return self.note(t("Choose something first"));
        }
        if matches!(how, Arrangement::Group { .. }) && chosen.len() < 2 {
            return self.note(t("A group needs at least two objects"));
        }
        let hides = how == Arrangement::Hide;
        self.apply(label(&how), &[arranging(&chosen, how)]);
        if hides {
            self.state.choose(&[], Choose::Only);
        }
    }

    pub(super) fn hide_others(&mut self) {
        let chosen = self.members();
        let all = self.document.settled_scene().frame().boxes.keys().copied();
        let mut others = Members::of(all, []);
        others.remove(&chosen);
        match chosen.is_empty() || others.is_empty() {
            true => self.note(t("Choose what is to stay visible first")),
            false => self.apply("Hide", &[arranging(&others, Arrangement::Hide)]),
        }
    }

    pub(super) fn show_all(&mut self) {
        let hidden = self.document.settled_scene().arranged.hidden.clone();
        match hidden.is_empty() {
            true => self.note(t("Nothing is hidden")),
            false => self.apply("Show", &[arranging(&hidden, Arrangement::Show)]),
        }
    }

    pub(super) fn unlock_all(&mut self) {
        let locked = self.document.settled_scene().arranged.locked.clone();
        match locked.is_empty() {
            true => self.note(t("Nothing is locked")),
            false => self.apply("Unlock", &[arranging(&locked, Arrangement::Unlock)]),
        }
    }

    /// The edits that do not change locked objects. With `says`, a toast tells which objects stay as they are.
    pub(crate) fn unlocked(&mut self, edits: Vec<Edit>, says: bool) -> Vec<Edit> {
        let (open, kept) = arranged::unlocked(self.document.settled_scene(), edits);
        if says && !kept.is_empty() {
            let text = match (kept.len(), kept.boxes.first()) {
                (1, Some(BoxId(id))) => tf!("Box {id} is locked", id = id),
                (1, None) => t("This thing is locked").to_owned(),
                (n, _) => tf!("{n} locked objects stay as they are", n = n),
            };
            let now_s = self.now_s();
            self.toasts.push(MessageLevel::Info, text, now_s);
        }
        open
    }
}
