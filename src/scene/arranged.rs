//! Arrangement of objects by the user: groups, hidden objects, locked objects. Sensors and networks do not see it.

use std::collections::BTreeSet;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::{BoxId, BoxName, Scene, ThingId};

/// Boxes and things beside the road.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct Members {
    /// The boxes.
    #[serde(skip_serializing_if = "BTreeSet::is_empty")]
    pub boxes: BTreeSet<BoxId>,
    /// The things.
    #[serde(skip_serializing_if = "BTreeSet::is_empty")]
    pub things: BTreeSet<ThingId>,
}

impl Members {
    /// The members of two lists.
    pub fn of(boxes: impl IntoIterator<Item = BoxId>, things: impl IntoIterator<Item = ThingId>) -> Self {
        Self {
            boxes: boxes.into_iter().collect(),
            things: things.into_iter().collect(),
        }
    }

    /// Number of members.
    pub fn len(&self) -> usize {
        self.boxes.len() + self.things.len()
    }

    /// True if there are no members.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Adds the members of others.
    pub fn add(&mut self, others: &Self) {
        self.boxes.extend(&others.boxes);
        self.things.extend(&others.things);
    }

    /// Removes the members of others.
    pub fn remove(&mut self, others: &Self) {
        self.boxes.retain(|id| !others.boxes.contains(id));
        self.things.retain(|id| !others.things.contains(id));
    }

    /// True if it shares a box or a thing with others.
    pub fn meets(&self, others: &Self) -> bool {
        !self.boxes.is_disjoint(&others.boxes) || !self.things.is_disjoint(&others.things)
    }

    /// True if others have all of its members.
    pub fn is_within(&self, others: &Self) -> bool {
        self.boxes.is_subset(&others.boxes) && self.things.is_subset(&others.things)
    }

    fn keep(&mut self, scene: &Scene) {
        let has = |id: &BoxId| scene.canvas().boxes.contains_key(id) || scene.clip().tracks.contains_key(id);
        self.boxes.retain(has);
        self.things.retain(|id| scene.background.get(*id).is_some());
    }
}

/// Objects that are selected and moved together.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ObjectGroup {
    /// Its name; empty means none.
    #[serde(default, skip_serializing_if = "BoxName::is_empty")]
    pub name: BoxName,
    /// Its members; at least two.
    pub members: Members,
}

/// Groups, hidden objects, locked objects.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Arranged {
    /// The groups; no object is in two of them.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub groups: Vec<ObjectGroup>,
    /// Objects that are neither drawn nor selectable in the large views. Sensors see them.
    #[serde(skip_serializing_if = "Members::is_empty")]
    pub hidden: Members,
    /// Objects that edits do not change.
    #[serde(skip_serializing_if = "Members::is_empty")]
    pub locked: Members,
}

/// A change of the arrangement of objects.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub enum Arrangement {
    /// Not drawn in the large views any more; sensors go on seeing it.
    Hide,
    /// Drawn again.
    Show,
    /// Edits leave it as it is.
    Lock,
    /// Edits may change it again.
    Unlock,
    /// Chosen and moved together from now on; what was in other groups leaves them.
    Group {
        /// Name of the group; empty means none.
        #[serde(default)]
        #[schemars(with = "String")]
        name: BoxName,
    },
    /// In no group any more.
    Ungroup,
}

impl Arranged {
    /// True if nothing is grouped, hidden or locked.
    pub fn is_empty(&self) -> bool {
        *self == Self::default()
    }

    /// Applies a change to objects.
    pub fn arrange(&mut self, members: &Members, how: &Arrangement) {
        match how {
            Arrangement::Hide => self.hidden.add(members),
            Arrangement::Show => self.hidden.remove(members),
            Arrangement::Lock => self.locked.add(members),
            Arrangement::Unlock => self.locked.remove(members),
            Arrangement::Group { .. } | Arrangement::Ungroup => {
                self.groups.iter_mut().for_each(|g| g.members.remove(members));
                if let Arrangement::Group { name } = how {
                    self.groups.push(ObjectGroup {
                        name: *name,
                        members: members.clone(),
                    });
                }
                self.groups.retain(|g| g.members.len() > 1);
            }
        }
    }

    /// The group that a box is in.
    pub fn group_of_box(&self, id: BoxId) -> Option<&ObjectGroup> {
        self.groups.iter().find(|g| g.members.boxes.contains(&id))
    }

    /// The group that a thing is in.
    pub fn group_of_thing(&self, id: ThingId) -> Option<&ObjectGroup> {
        self.groups.iter().find(|g| g.members.things.contains(&id))
    }

    /// The members, with all members of every group that one of them is in.
    pub fn with_groups(&self, members: &Members) -> Members {
        let mut out = members.clone();
        let theirs = self.groups.iter().filter(|g| g.members.meets(members));
        theirs.for_each(|g| out.add(&g.members));
        out
    }

    /// Drops the members that a scene no longer has.
    pub fn keep(&mut self, scene: &Scene) {
        for members in [&mut self.hidden, &mut self.locked] {
            members.keep(scene);
        }
        self.groups.iter_mut().for_each(|g| g.members.keep(scene));
        self.groups.retain(|g| g.members.len() > 1);
    }

    /// The first problem with it, in one line; `None` if it is sound.
    pub fn problem(&self) -> Option<String> {
        let mut seen = Members::default();
        for (i, group) in self.groups.iter().enumerate() {
            if group.members.len() < 2 {
                return Some(format!(
                    "group {i} has {} members, expected at least 2",
                    group.members.len()
                ));
            }
            if seen.meets(&group.members) {
                return Some(format!("group {i} has a member of another group"));
            }
            seen.add(&group.members);
        }
        None
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn members(ids: &[u32]) -> Members {
        Members::of(ids.iter().map(|id| BoxId(*id)), [])
    }

    #[test]
    fn nothing_is_in_two_groups_and_none_has_one_member() {
        let group = |name| Arrangement::Group {
            name: BoxName::new(name),
        };
        let mut all = Arranged::default();
        all.arrange(&members(&[1, 2, 3]), &group("queue"));
        all.arrange(&members(&[3, 4]), &group(""));
        assert_eq!(all.problem(), None);
        assert_eq!(all.groups[0].members, members(&[1, 2]));
        assert_eq!(all.with_groups(&members(&[1, 9])), members(&[1, 2, 9]));
        all.arrange(&members(&[4]), &Arrangement::Ungroup);
        assert_eq!(all.groups.len(), 1);
        all.groups.push(all.groups[0].clone());
        assert!(all.problem().is_some());
        all.groups[1].members = members(&[7]);
        assert!(all.problem().is_some());
    }

    #[test]
    fn hidden_and_locked_go_and_come() {
        let mut all = Arranged::default();
        all.arrange(&members(&[1, 2]), &Arrangement::Hide);
        all.arrange(&members(&[2]), &Arrangement::Lock);
        all.arrange(&members(&[1]), &Arrangement::Show);
        assert_eq!((&all.hidden, &all.locked), (&members(&[2]), &members(&[2])));
        let text = serde_json::to_string(&all).expect("plain data");
        assert_eq!(text, r#"{"hidden":{"boxes":[2]},"locked":{"boxes":[2]}}"#);
        assert_eq!(serde_json::from_str::<Arranged>(&text).expect("as written"), all);
        all.arrange(&members(&[2]), &Arrangement::Show);
        all.arrange(&members(&[2]), &Arrangement::Unlock);
        assert!(all.is_empty());
    }
}
