//! Rules for the names of sensors: the files of cameras carry them.

use std::collections::BTreeMap;

use crate::SensorRig;
use crate::message::{is_hidden, quoted};
use crate::plain_name::{check, folded};

impl SensorRig {
    /// Longest name of a rig, bytes of UTF-8.
    pub const LONGEST_NAME: usize = 200;

    /// The first problem with the names of the rig and its sensors; `None` if they are sound. Sensors have plain names
    /// (see [`crate::plain_name`]), and no two cameras and no two radars have the same one, ignoring case.
    pub(crate) fn names_problem(&self) -> Option<String> {
        if self.name.len() > Self::LONGEST_NAME || self.name.contains(is_hidden) {
            return Some(format!(
                "the rig is called {:?}, expected at most {} bytes without control characters",
                quoted(&self.name, 60),
                Self::LONGEST_NAME
            ));
        }
        let cameras = self.cameras.iter().map(|c| ("camera", &c.name)).enumerate();
        let lidars = self.lidars.iter().map(|l| ("lidar", &l.name)).enumerate();
        let radars = self.radars.iter().map(|r| ("radar", &r.name)).enumerate();
        for (i, (kind, name)) in cameras.chain(lidars).chain(radars) {
            if let Err(problem) = check(name) {
                return Some(format!("{kind} {i}: {problem}"));
            }
        }
        let cameras = self.cameras.iter().map(|c| c.name.as_str());
        let radars = self.radars.iter().map(|r| r.name.as_str());
        alike("cameras", cameras).or_else(|| alike("radars", radars))
    }
}

/// The first two sensors of a kind with the same name but for case, in one line.
fn alike<'a>(kind: &str, names: impl Iterator<Item = &'a str>) -> Option<String> {
    let mut known = BTreeMap::new();
    for (i, name) in names.enumerate() {
        if let Some((first, other)) = known.insert(folded(name), (i, name)) {
            let [a, b] = [other, name].map(|name| quoted(name, 60));
            return Some(format!(
                "{kind} {first} and {i} are called {a:?} and {b:?}, expected names that differ in more than the case of letters"
            ));
        }
    }
    None
}

#[cfg(test)]
mod tests {
    use super::*;

    fn named(names: [&str; 6]) -> SensorRig {
        let mut rig = SensorRig::default();
        for (camera, name) in rig.cameras.iter_mut().zip(names) {
            camera.name = name.into();
        }
        rig
    }

    #[test]
    fn sensors_have_plain_names_of_their_own() {
        assert_eq!(
            named(["a", "b", "前", "front left", "a.b", "a_b"]).problem(),
            None
        );
        let problem = |names| named(names).problem().unwrap_or_default();
        assert!(
            problem(["a", "../../x", "c", "d", "e", "f"])
                .starts_with("camera 1: the name \"../../x\" holds '/'")
        );
        let twice = problem(["a", "b", "CAM", "d", "Cam", "f"]);
        assert!(
            twice.starts_with("cameras 2 and 4 are called \"CAM\" and \"Cam\""),
            "{twice}"
        );
        let mut rig = SensorRig::default();
        rig.lidars[0].name = "/elsewhere/x".into();
        assert!(rig.problem().is_some_and(|p| p.starts_with("lidar 0:")));
        let rig = SensorRig {
            name: "\u{1b}]0;x\u{7}".into(),
            ..SensorRig::default()
        };
        assert!(
            rig.problem()
                .is_some_and(|p| p.starts_with("the rig is called") && !p.contains('\u{1b}'))
        );
    }
}
