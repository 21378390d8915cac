//! Reading attributes with a place to name in the error, and counting elements that are not understood.

use std::borrow::Cow;
use std::collections::BTreeMap;

use roxmltree::{Document, Node};

use super::geometry::MAX_COORDINATE_M;
pub(crate) use scene::message::quoted as shown;

/// Why a file was refused. Each is shown as one line.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum OpenDriveError {
    /// The bytes are not well-formed XML.
    #[error("not an XML file: {detail}")]
    NotXml {
        /// Message of the XML reader, with line and column.
        detail: String,
    },
    /// XML of another kind.
    #[error("not an OpenDRIVE file: expected the root element <OpenDRIVE>, found <{found}>")]
    NotOpenDrive {
        /// Name of the root element.
        found: String,
    },
    /// More than is read, so that no file takes minutes.
    #[error("{place}: more than {limit} {what}")]
    TooMuch {
        /// Element and line where it became too much.
        place: String,
        /// The bound.
        limit: usize,
        /// Name of what is counted.
        what: &'static str,
    },
    /// An element or attribute is missing or holds something unusable.
    #[error("{place}: {field}: expected {expected}, found {found}")]
    Field {
        /// Element, its id or number, and the line.
        place: String,
        /// Attribute or child element.
        field: String,
        /// The value that was expected.
        expected: String,
        /// The value that was found.
        found: String,
    },
}

pub(crate) type Result<T> = std::result::Result<T, OpenDriveError>;

/// Numbers, by kind, of things that were not understood or are not modelled.
pub type Skipped = BTreeMap<String, usize>;

/// The text of a file: UTF-8, UTF-16 with a byte order mark, or Latin-1 where the header says so.
pub(crate) fn decode(bytes: &[u8]) -> Result<Cow<'_, str>> {
    let utf16 = |of: fn([u8; 2]) -> u16| {
        char::decode_utf16(bytes[2..].chunks_exact(2).map(|c| of([c[0], c[1]])))
            .map(|c| c.unwrap_or(char::REPLACEMENT_CHARACTER))
            .collect::<String>()
    };
    match bytes {
        [0xff, 0xfe, ..] => return Ok(utf16(u16::from_le_bytes).into()),
        [0xfe, 0xff, ..] => return Ok(utf16(u16::from_be_bytes).into()),
        _ => {}
    }
    match std::str::from_utf8(bytes) {
        Ok(text) => Ok(text.into()),
        Err(error) => {
            let head = String::from_utf8_lossy(&bytes[..bytes.len().min(200)]).to_ascii_lowercase();
            if ["iso-8859-1", "latin1", "windows-1252"]
                .iter()
                .any(|name| head.contains(name))
            {
                return Ok(bytes.iter().map(|b| char::from(*b)).collect::<String>().into());
            }
            Err(OpenDriveError::NotXml {
                detail: format!("byte {} is not UTF-8", error.valid_up_to()),
            })
        }
    }
}

pub(crate) fn parse_document(text: &str) -> Result<Document<'_>> {
    super::bounds::check(text)?;
    Document::parse(text).map_err(|error| OpenDriveError::NotXml {
        detail: shown(&error.to_string(), 160),
    })
}

/// Element children.
pub(crate) fn elements<'a, 'i: 'a>(node: Node<'a, 'i>) -> impl Iterator<Item = Node<'a, 'i>> {
    node.children().filter(Node::is_element)
}

/// Element children of one name.
pub(crate) fn named<'a, 'i: 'a>(
    node: Node<'a, 'i>,
    name: &'static str,
) -> impl Iterator<Item = Node<'a, 'i>> {
    elements(node).filter(move |n| n.tag_name().name() == name)
}

/// The first element child of that name.
pub(crate) fn child<'a, 'i: 'a>(node: Node<'a, 'i>, name: &'static str) -> Option<Node<'a, 'i>> {
    named(node, name).next()
}

/// `road "3", lane "-1", width 2 (line 40)`: the element and those around it that have an id or a number.
pub(crate) fn place(node: Node<'_, '_>) -> String {
    const CONTAINERS: [&str; 10] = [
        "OpenDRIVE",
        "planView",
        "lanes",
        "left",
        "center",
        "right",
        "objects",
        "signals",
        "elevationProfile",
        "outlines",
    ];
    let mut parts = Vec::new();
    for n in node.ancestors().filter(Node::is_element) {
        let name = n.tag_name().name();
        if CONTAINERS.contains(&name) && n != node {
            continue;
        }
        parts.push(match n.attribute("id") {
            Some(id) => format!("{} \"{}\"", shown(name, 40), shown(id, 40)),
            None => {
                let before = n.prev_siblings().filter(|s| s.has_tag_name(n.tag_name())).count();
                format!("{} {before}", shown(name, 40)) // prev_siblings starts with the node itself
            }
        });
        if parts.len() == 5 {
            break;
        }
    }
    parts.reverse();
    let line = node.document().text_pos_at(node.range().start).row;
    format!("{} (line {line})", parts.join(", "))
}

/// The error for a field of this element.
pub(crate) fn bad(
    node: Node<'_, '_>,
    field: &str,
    expected: impl Into<String>,
    found: &str,
) -> OpenDriveError {
    OpenDriveError::Field {
        place: place(node),
        field: field.into(),
        expected: expected.into(),
        found: shown(found, 80),
    }
}

/// A finite number; `None` if the attribute is absent.
pub(crate) fn number_or_none(node: Node<'_, '_>, field: &str) -> Result<Option<f64>> {
    let Some(text) = node.attribute(field) else {
        return Ok(None);
    };
    match text.trim().parse::<f64>() {
        Ok(value) if value.is_finite() => Ok(Some(value)),
        _ => Err(bad(node, field, "a finite number", &format!("{text:?}"))),
    }
}

/// A coordinate, if it is not farther from the origin than any place on the earth is in any frame.
pub(crate) fn within_reach(node: Node<'_, '_>, field: &str, value: f64) -> Result<f64> {
    match value.abs() <= MAX_COORDINATE_M {
        true => Ok(value),
        false => {
            let expected = format!("a magnitude of at most {MAX_COORDINATE_M:e}");
            Err(bad(node, field, expected, &value.to_string()))
        }
    }
}

/// A finite number that has to be there.
pub(crate) fn number(node: Node<'_, '_>, field: &str) -> Result<f64> {
    number_or_none(node, field)?.ok_or_else(|| bad(node, field, "a finite number", "no such attribute"))
}

/// A finite number, or the given one if the attribute is absent.
pub(crate) fn number_or(node: Node<'_, '_>, field: &str, otherwise: f64) -> Result<f64> {
    Ok(number_or_none(node, field)?.unwrap_or(otherwise))
}

/// Four coefficients, from the constant up.
pub(crate) fn four(node: Node<'_, '_>, fields: [&str; 4]) -> Result<[f64; 4]> {
    let mut out = [0.0; 4];
    for (value, field) in out.iter_mut().zip(fields) {
        *value = number(node, field)?;
    }
    Ok(out)
}

/// Refuses a start that lies before the one of the record before.
pub(crate) fn ascending(node: Node<'_, '_>, field: &str, s: f64, before: Option<f64>) -> Result<()> {
    match before {
        Some(b) if s < b => Err(bad(
            node,
            field,
            format!("at least {b}, where the record before begins"),
            &format!("{s}"),
        )),
        _ => Ok(()),
    }
}

/// Counts the element children that are not named in `known`, as `parent/child`. One without
/// attributes and children holds nothing that could be lost.
pub(crate) fn count_others(node: Node<'_, '_>, known: &[&str], skipped: &mut Skipped) {
    for n in elements(node) {
        let name = n.tag_name().name();
        if known.contains(&name) || (n.attributes().len() == 0 && elements(n).next().is_none()) {
            continue;
        }
        let kind = match name {
            "userData" => name.into(),
            _ => format!("{}/{}", node.tag_name().name(), shown(name, 40)),
        };
        count(skipped, kind);
    }
}

/// One more of a kind.
pub(crate) fn count(skipped: &mut Skipped, kind: impl Into<String>) {
    *skipped.entry(kind.into()).or_default() += 1;
}
