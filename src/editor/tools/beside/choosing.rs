//! Things in hand: choosing them beside the boxes, and taking the tool for a kind of them.

use scene::ThingId;

use super::{ThingKind, line, post, tree};
use crate::tools::{Choose, Hand};

impl Hand {
    /// Chooses things; alone they are if no box is chosen either.
    pub fn choose_things(&mut self, ids: &[ThingId], how: Choose) {
        if how == Choose::Only {
            self.choose(&[], Choose::Only);
        }
        let chosen = &mut self.things.chosen;
        for id in ids {
            if how == Choose::Remove || !chosen.insert(*id) && how == Choose::Toggle {
                chosen.remove(id);
            }
        }
    }

    /// True if a box or a thing is chosen.
    pub fn any_chosen(&self) -> bool {
        self.selected.is_some() || !self.things.chosen.is_empty()
    }

    /// Takes a tool for things with a kind.
    pub fn take_thing(&mut self, kind: ThingKind) {
        let things = &mut self.things;
        let tool = match kind {
            ThingKind::Tree(kind) => {
                things.tree = kind;
                tree::ID
            }
            ThingKind::Line(kind) => {
                things.take_line(kind);
                line::ID
            }
            ThingKind::Post(kind) => {
                things.post = kind;
                post::ID
            }
        };
        self.tool = tool;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use scene::BoxId;

    #[test]
    fn boxes_and_things_are_chosen_together_only_on_request() {
        let mut ui = Hand::default();
        ui.choose(&[BoxId(1)], Choose::Only);
        ui.choose_things(&[ThingId(4)], Choose::Add);
        assert!(ui.is_chosen(BoxId(1)) && ui.things.chosen.contains(&ThingId(4)));
        ui.choose_things(&[ThingId(4), ThingId(5)], Choose::Toggle);
        assert_eq!(ui.things.chosen, [ThingId(5)].into());
        ui.choose_things(&[ThingId(6)], Choose::Only);
        assert_eq!((ui.chosen(), ui.things.chosen.len()), (vec![], 1));
        assert!(ui.any_chosen());
        ui.choose(&[BoxId(1)], Choose::Only);
        assert!(ui.things.chosen.is_empty());
    }
}
