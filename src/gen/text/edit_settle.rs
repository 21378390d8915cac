//! What the commands of one sentence mean together.

use super::edit::Editor;
use super::edit_grammar::{Back, Command};
use super::mention::{Mention, means_all};
use super::select::{Chosen, choose, fitting};
use super::words::edits::{Pick, Verb};
use crate::scene::{BoxId, SceneBox};

impl Editor<'_> {
    /// What commands of one sentence mean together: "turn the cones into barriers and the barriers into cones", "keep the
    /// coach and the bus, lose the rest".
    pub(super) fn settle(&self, commands: &mut [Command]) {
        let found = |c: &Command| -> Option<Vec<BoxId>> {
            let mut all = Vec::new();
            for m in &c.targets {
                match choose(&self.map, &self.boxes, m, &c.mentions) {
                    Chosen::These(ids) => all.extend(ids),
                    _ => return None,
                }
            }
            (!all.is_empty()).then_some(all)
        };
        for i in 1..commands.len() {
            let (a, b) = (&commands[i - 1], &commands[i]);
            let class = |m: Option<&Mention>| m.map(|m| m.spec.class);
            let crosswise = a.verb == Verb::Replace
                && b.verb == Verb::Replace
                && class(a.by.as_ref()).is_some()
                && class(a.by.as_ref()) == class(b.targets.first())
                && class(b.by.as_ref()) == class(a.targets.first());
            if crosswise {
                commands[i].found = found(&commands[i]);
                continue;
            }
            // "the cars have left, only the truck is still there": what stays of those
            let told = b.verb == Verb::Keep
                && a.verb == Verb::Remove
                && !a.targets.iter().any(means_all)
                && !self.fewer_of_others(a, b)
                && ["only ", "just "]
                    .iter()
                    .any(|w| b.text.to_lowercase().starts_with(w));
            if told {
                commands[i].verb = Verb::Note;
                continue;
            }
            // "keep one parked car, delete the rest of the cars": said twice
            let counted = a.verb == Verb::Keep && a.targets.iter().any(|t| !t.uncounted);
            let words = b.text.to_lowercase();
            let others = b.back == Some(Back::Others)
                || [" rest", " others", " other ", " remaining", " surplus"]
                    .iter()
                    .any(|w| words.contains(w));
            let same = class(a.targets.first()) == class(b.targets.first());
            if counted && b.verb == Verb::Remove && others && (b.back.is_some() || same) {
                commands[i].verb = Verb::Note;
                continue;
            }
            let rest = matches!(a.verb, Verb::Keep | Verb::Note)
                && !a.targets.is_empty()
                && b.verb == Verb::Remove
                && b.back == Some(Back::Others);
            if let Some(kept) = rest.then(|| found(a)).flatten() {
                let alike = |x: &SceneBox| kept.iter().any(|id| self.boxes[id].class == x.class);
                let others = self.boxes.values().any(|x| alike(x) && !kept.contains(&x.id));
                if !others {
                    let rest = self.boxes.keys().filter(|id| !kept.contains(id));
                    commands[i].found = Some(rest.copied().collect());
                }
            }
        }
    }

    /// "the worker is gone and only one cone is left", where there are four: no cones are gone yet.
    fn fewer_of_others(&self, gone: &Command, kept: &Command) -> bool {
        let Some(m) = kept.targets.first().filter(|m| !m.uncounted) else {
            return false;
        };
        let there = self.boxes.values().filter(|b| b.class == m.spec.class).count();
        gone.targets.iter().all(|t| t.spec.class != m.spec.class) && there > m.spec.count.n as usize
    }

    /// True if a command that adds, without a word for that, names what is there already: it is not put in a second time.
    pub(super) fn only_named(&self, c: &Command) -> bool {
        const ORDERS: &[&str] = &[
            "add",
            "insert",
            "include",
            "create",
            "generate",
            "spawn",
            "append",
            "duplicate",
            "introduce",
            "bring",
            "put",
            "place",
            "set",
            "park",
            "give",
            "draw",
            "show",
            "another",
            "more",
            "second",
            "extra",
        ];
        // "two <unknown word> hide behind the car" names only what they are behind
        if c.targets.is_empty() {
            let anchors = !c.mentions.is_empty() && c.mentions.iter().all(|m| m.is_anchor);
            return anchors && !c.in_place && !c.reading.not_understood.is_empty();
        }
        let words = c.text.to_lowercase();
        let ordered = words
            .split(|ch: char| !ch.is_alphanumeric())
            .any(|w| ORDERS.contains(&w));
        let theirs = ["their ", "his ", "her ", "its "]
            .iter()
            .any(|w| words.starts_with(w));
        let named = |m: &Mention| {
            m.definite && m.pick != Some(Pick::More) && !m.is_anchor
                || m.pick == Some(Pick::All)
                || m.uncounted && means_all(m)
        };
        let there = |m: &Mention| m.definite && !fitting(&self.map, &self.boxes, m, &c.mentions).is_empty();
        let again = !ordered && !c.in_place && c.targets.iter().all(there);
        // "half of the cones have been collected" speaks of those that are there; "one of our buses drives behind us" brings one
        let early = |of: &str| {
            words
                .split_once(of)
                .is_some_and(|(before, _)| before.split(' ').count() < 3)
        };
        let placed = c.targets.iter().any(|m| !m.spec.relations.is_empty());
        let part = [" of the ", " of these ", " of those ", " of them "]
            .iter()
            .any(|of| early(of))
            || !placed && [" of our ", " of my "].iter().any(|of| early(of));
        // "one of the cyclists has <unknown word>", "cyclists <unknown word>": said of those that are there
        let alike = |m: &Mention| self.boxes.values().any(|b| m.classes.contains(&b.class));
        let remark = !ordered
            && !c.in_place
            && !c.reading.not_understood.is_empty()
            && c.targets
                .iter()
                .all(|m| m.uncounted && m.plural && !m.is_anchor && alike(m));
        // "barriers cost money", "one is still to come": a remark on what is there
        let told = |m: &Mention| {
            let stays = [" left", " remain", " still", " enough", "where "]
                .iter()
                .any(|w| words.contains(w));
            let bare = m.uncounted && m.plural && m.pick.is_none();
            let named = bare && !fitting(&self.map, &self.boxes, m, &c.mentions).is_empty();
            named || m.spec.relations.is_empty() && alike(m) && (bare || stays)
        };
        let told = !c.in_place && !ordered && c.targets.iter().all(told);
        again || c.implied && (theirs || part || remark || told || c.targets.iter().all(named))
    }
}
