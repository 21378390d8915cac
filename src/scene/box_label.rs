//! Label of a box beyond its class: a name ("taxi", "school bus") and the colour of its paint.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// A short text that is copied with its box; empty means none.
#[derive(Clone, Copy, Default, PartialEq, Eq, Hash)]
pub struct BoxName {
    bytes: [u8; BoxName::MOST_BYTES],
    len: u8,
}

impl BoxName {
    /// Longest name, bytes of UTF-8.
    pub const MOST_BYTES: usize = 31;

    /// The name, trimmed, with control characters replaced by blanks; a longer text is cut at a character.
    pub fn new(text: &str) -> Self {
        let mut out = Self::default();
        for c in text.trim().chars().map(|c| if c.is_control() { ' ' } else { c }) {
            let (from, to) = (usize::from(out.len), usize::from(out.len) + c.len_utf8());
            if to > Self::MOST_BYTES {
                break;
            }
            c.encode_utf8(&mut out.bytes[from..to]);
            out.len = to as u8;
        }
        out
    }

    /// The name as text.
    pub fn as_str(&self) -> &str {
        // (`new` stores whole characters only)
        std::str::from_utf8(&self.bytes[..usize::from(self.len)]).unwrap_or_default()
    }

    /// True if it is empty.
    pub fn is_empty(&self) -> bool {
        self.len == 0
    }
}

impl std::fmt::Debug for BoxName {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        self.as_str().fmt(f)
    }
}

impl Serialize for BoxName {
    fn serialize<S: serde::Serializer>(&self, s: S) -> Result<S::Ok, S::Error> {
        s.serialize_str(self.as_str())
    }
}

impl<'de> Deserialize<'de> for BoxName {
    fn deserialize<D: serde::Deserializer<'de>>(d: D) -> Result<Self, D::Error> {
        let text = String::deserialize(d)?;
        let name = Self::new(&text);
        if name.as_str() != text {
            return Err(serde::de::Error::custom(format!(
                "name of a box has {} bytes, expected at most {} without control characters and blanks around",
                text.len(),
                Self::MOST_BYTES
            )));
        }
        Ok(name)
    }
}

/// The colour of a box in camera pictures. Nothing else follows from it.
#[derive(
    Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize, schemars::JsonSchema,
)]
#[serde(rename_all = "snake_case")]
pub enum Paint {
    /// White.
    White,
    /// Silver.
    Silver,
    /// Grey.
    Grey,
    /// Black.
    Black,
    /// Red.
    Red,
    /// Orange.
    Orange,
    /// Yellow.
    Yellow,
    /// Green.
    Green,
    /// Blue.
    Blue,
    /// Purple.
    Purple,
    /// Pink.
    Pink,
    /// Brown.
    Brown,
    /// Beige.
    Beige,
}

impl Paint {
    /// All of them.
    pub const ALL: [Self; 13] = [
        Self::White,
        Self::Silver,
        Self::Grey,
        Self::Black,
        Self::Red,
        Self::Orange,
        Self::Yellow,
        Self::Green,
        Self::Blue,
        Self::Purple,
        Self::Pink,
        Self::Brown,
        Self::Beige,
    ];

    /// Its name, as in files.
    pub fn name(self) -> &'static str {
        match self {
            Self::White => "white",
            Self::Silver => "silver",
            Self::Grey => "grey",
            Self::Black => "black",
            Self::Red => "red",
            Self::Orange => "orange",
            Self::Yellow => "yellow",
            Self::Green => "green",
            Self::Blue => "blue",
            Self::Purple => "purple",
            Self::Pink => "pink",
            Self::Brown => "brown",
            Self::Beige => "beige",
        }
    }

    /// sRGB, as lacquer looks in daylight.
    pub fn srgb(self) -> [u8; 3] {
        match self {
            Self::White => [236, 238, 238],
            Self::Silver => [190, 194, 198],
            Self::Grey => [112, 116, 122],
            Self::Black => [28, 29, 32],
            Self::Red => [176, 28, 28],
            Self::Orange => [214, 104, 20],
            Self::Yellow => [232, 190, 24],
            Self::Green => [34, 112, 58],
            Self::Blue => [30, 74, 158],
            Self::Purple => [96, 46, 128],
            Self::Pink => [222, 120, 160],
            Self::Brown => [98, 62, 38],
            Self::Beige => [204, 188, 154],
        }
    }
}

/// Name and paint.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct BoxLabel {
    /// Name of the box; empty means that its class names it.
    #[serde(skip_serializing_if = "BoxName::is_empty")]
    #[schemars(with = "String")]
    pub name: BoxName,
    /// Its colour; none means that pictures choose one.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub paint: Option<Paint>,
}

impl BoxLabel {
    /// True if neither was given.
    pub fn is_empty(&self) -> bool {
        *self == Self::default()
    }

    /// The label in words, with `class` where there is no name: `red taxi`.
    pub fn called(&self, class: &str) -> String {
        let name = if self.name.is_empty() {
            class
        } else {
            self.name.as_str()
        };
        match self.paint {
            Some(paint) => format!("{} {name}", paint.name()),
            None => name.to_owned(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn long_names_end_at_a_character_and_files_with_them_are_refused() {
        let long = "ä".repeat(40);
        let name = BoxName::new(&format!("  {long}\n"));
        assert_eq!(name.as_str(), "ä".repeat(15));
        let text = serde_json::to_string(&BoxLabel {
            name: BoxName::new(" school\tbus "),
            paint: Some(Paint::Yellow),
        });
        let text = text.expect("plain data");
        assert_eq!(text, r#"{"name":"school bus","paint":"yellow"}"#);
        let back: BoxLabel = serde_json::from_str(&text).expect("as written");
        assert_eq!(back.called("bus"), "yellow school bus");
        let bad = format!(r#"{{"name":"{long}"}}"#);
        let error = serde_json::from_str::<BoxLabel>(&bad).expect_err("too long");
        assert!(error.to_string().contains("80 bytes"), "{error}");
        assert!(serde_json::from_str::<BoxLabel>(r#"{"paint":"ultraviolet"}"#).is_err());
    }
}
