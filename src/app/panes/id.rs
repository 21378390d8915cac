//! The id of a pane, as saved layouts keep it and commands carry it.

use serde::de::{Error, MapAccess, Visitor};
use serde::ser::SerializeMap;
use serde::{Deserialize, Deserializer, Serialize, Serializer};

/// Longest name, bytes.
const LONGEST: usize = 22;

/// The id of a pane: a short name, and for the pane of one camera its index. In settings files it is the name
/// (`"bev"`), or `{"camera": 2}`.
#[derive(Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct PaneId {
    name: [u8; LONGEST],
    len: u8,
    camera: Option<u8>,
}

impl PaneId {
    /// Bird's-eye view.
    pub const BEV: Self = Self::named("bev");
    /// 3D view.
    pub const VIEW3D: Self = Self::named("view3d");
    /// All cameras in a row.
    pub const CAMERAS: Self = Self::named("cameras");
    /// The newest sweep, unrolled: azimuth by beam.
    pub const LIDAR: Self = Self::named("lidar");
    /// The newest radar scans from above.
    pub const RADAR: Self = Self::named("radar");
    /// The scene as 3-D Gaussians.
    pub const SPLATS: Self = Self::named("splats");
    /// The chosen box from above, from its side and from behind.
    pub const BOX_VIEWS: Self = Self::named("box_views");
    /// Prompt: words that become a scene or change it.
    pub const PROMPT: Self = Self::named("prompt");
    /// Versions generated so far.
    pub const VERSIONS: Self = Self::named("versions");
    /// Options of the tool in hand, and the map layers.
    pub const TOOLS: Self = Self::named("tools");
    /// The chosen box in numbers, and the list of boxes.
    pub const OBJECTS: Self = Self::named("objects");
    /// The undo steps.
    pub const HISTORY: Self = Self::named("history");
    /// The quality slider, its measurements, and the receipt of the last edit.
    pub const TRADE: Self = Self::named("trade");
    /// Time: play, keyframes, speeds.
    pub const TIMELINE: Self = Self::named("timeline");
    /// Findings of the quality checks.
    pub const CHECKS: Self = Self::named("checks");

    /// The id of a name. In a constant, a name of more than 22 bytes does not compile.
    pub const fn named(name: &str) -> Self {
        match Self::read(name) {
            Some(id) => id,
            None => panic!("the name of a pane has at most 22 bytes"),
        }
    }

    /// One camera of the rig, by index.
    pub const fn of_camera(index: u8) -> Self {
        let mut id = Self::named("camera");
        id.camera = Some(index);
        id
    }

    /// The id of a name from a file; `None` if the name is too long.
    const fn read(name: &str) -> Option<Self> {
        let bytes = name.as_bytes();
        if bytes.len() > LONGEST {
            return None;
        }
        let mut kept = [0; LONGEST];
        let mut i = 0;
        while i < bytes.len() {
            kept[i] = bytes[i];
            i += 1;
        }
        Some(Self {
            name: kept,
            len: bytes.len() as u8,
            camera: None,
        })
    }

    /// The name; all camera panes have the same.
    pub fn name(&self) -> &str {
        let bytes = self.name.get(..usize::from(self.len)).unwrap_or_default();
        std::str::from_utf8(bytes).unwrap_or_default()
    }

    /// Index of the camera that the pane shows, if it shows one.
    pub fn camera(&self) -> Option<usize> {
        self.camera.map(usize::from)
    }
}

impl std::fmt::Debug for PaneId {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self.camera {
            Some(index) => write!(f, "{}({index})", self.name()),
            None => f.write_str(self.name()),
        }
    }
}

impl Serialize for PaneId {
    fn serialize<S: Serializer>(&self, to: S) -> Result<S::Ok, S::Error> {
        match self.camera {
            None => to.serialize_str(self.name()),
            Some(index) => {
                let mut map = to.serialize_map(Some(1))?;
                map.serialize_entry(self.name(), &index)?;
                map.end()
            }
        }
    }
}

impl<'de> Deserialize<'de> for PaneId {
    fn deserialize<D: Deserializer<'de>>(from: D) -> Result<Self, D::Error> {
        struct Read;
        impl<'de> Visitor<'de> for Read {
            type Value = PaneId;

            fn expecting(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
                f.write_str("the name of a pane, or {\"camera\": its index}")
            }

            fn visit_str<E: Error>(self, name: &str) -> Result<PaneId, E> {
                PaneId::read(name)
                    .ok_or_else(|| E::custom(format!("a pane's name has at most {LONGEST} bytes")))
            }

            fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> Result<PaneId, A::Error> {
                match map.next_entry::<String, u8>()? {
                    Some((name, index)) if name == "camera" => Ok(PaneId::of_camera(index)),
                    _ => Err(A::Error::custom(
                        "a pane with a number is {\"camera\": its index}",
                    )),
                }
            }
        }
        from.deserialize_any(Read)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn settings_files_hold_names_that_a_person_can_read() {
        let all = vec![PaneId::BEV, PaneId::BOX_VIEWS, PaneId::of_camera(2)];
        let text = serde_json::to_string(&all).expect("plain data");
        assert_eq!(text, r#"["bev","box_views",{"camera":2}]"#);
        assert_eq!(serde_json::from_str::<Vec<PaneId>>(&text).expect("the same"), all);
        for wrong in [
            r#"{"camera":900}"#,
            r#"{"door":1}"#,
            "{}",
            "3",
            &format!("{:?}", "x".repeat(23)),
        ] {
            assert!(serde_json::from_str::<PaneId>(wrong).is_err(), "{wrong}");
        }
    }
}
