//! Bounds on the cost of an XML file: counted in one pass before the parser sees it, because the parser compares each
//! attribute of an element with those before it, and copies the namespaces of the elements around each.

use super::xml::{OpenDriveError, Result, shown};

/// Attributes of one element; the standard has none with more than about twenty.
pub const MOST_ATTRIBUTES: usize = 200;
/// Elements of a file. A city of 10,000 roads has about half a million.
pub const MOST_ELEMENTS: usize = 2_000_000;
/// Elements around one another; the standard nests about ten.
pub const MOST_NESTED: usize = 200;
/// Declarations of namespaces in a file; the standard has one.
pub const MOST_NAMESPACES: usize = 64;

/// Errors on the first element that goes beyond a bound. Text that is not well formed is left to the parser, which
/// stops there.
pub(super) fn check(text: &str) -> Result<()> {
    let bytes = text.as_bytes();
    let mut found = Count::default();
    let mut at = 0;
    while let Some(start) = find(bytes, at, b"<") {
        let rest = &bytes[start + 1..];
        let end = match rest {
            [b'!', b'-', b'-', ..] => find(bytes, start + 4, b"-->"),
            [b'!', b'[', ..] => find(bytes, start + 2, b"]]>"),
            [b'!', ..] => None, // a document type: the parser refuses it
            [b'?', ..] => find(bytes, start + 2, b"?>"),
            [b'/', ..] => {
                found.nested = found.nested.saturating_sub(1);
                find(bytes, start + 2, b">")
            }
            _ => {
                found.elements += 1;
                let tag = Tag::read(bytes, start + 1);
                found.namespaces += tag.namespaces;
                found.nested += usize::from(!tag.closed);
                found.within(&tag, text, start)?;
                tag.end
            }
        };
        match end {
            Some(end) => at = end + 1,
            None => return Ok(()),
        }
    }
    Ok(())
}

#[derive(Default)]
struct Count {
    elements: usize,
    nested: usize,
    namespaces: usize,
}

impl Count {
    fn within(&self, tag: &Tag, text: &str, start: usize) -> Result<()> {
        let bounds = [
            (tag.attributes, MOST_ATTRIBUTES, "attributes of one element"),
            (self.elements, MOST_ELEMENTS, "elements"),
            (self.nested, MOST_NESTED, "elements around one another"),
            (self.namespaces, MOST_NAMESPACES, "namespaces"),
        ];
        let Some((_, limit, what)) = bounds.into_iter().find(|(found, limit, _)| found > limit) else {
            return Ok(());
        };
        let name = text[start + 1..]
            .split(|c: char| c.is_whitespace() || "/>".contains(c))
            .next();
        let line = 1 + text.as_bytes()[..start].iter().filter(|b| **b == b'\n').count();
        Err(OpenDriveError::TooMuch {
            place: format!("<{}> (line {line})", shown(name.unwrap_or_default(), 40)),
            limit,
            what,
        })
    }
}

/// One start tag, or an element without content.
struct Tag {
    attributes: usize,
    namespaces: usize,
    closed: bool,
    /// Place of its `>`; `None` in a file that is cut short.
    end: Option<usize>,
}

impl Tag {
    /// Each attribute has one equals sign outside of quotes.
    fn read(bytes: &[u8], start: usize) -> Self {
        let (mut attributes, mut namespaces, mut quote) = (0, 0, None);
        let mut name = start;
        for (i, &b) in bytes.iter().enumerate().skip(start) {
            match (quote, b) {
                (Some(q), _) if b == q => quote = None,
                (Some(_), _) => {}
                (None, b'"' | b'\'') => quote = Some(b),
                (None, b'=') => {
                    attributes += 1;
                    namespaces += usize::from(bytes[name..i].starts_with(b"xmlns"));
                }
                (None, b'>') => {
                    return Self {
                        attributes,
                        namespaces,
                        closed: bytes[i - 1] == b'/',
                        end: Some(i),
                    };
                }
                _ => {}
            }
            if matches!(b, b' ' | b'\t' | b'\r' | b'\n' | b'"' | b'\'') {
                name = i + 1;
            }
        }
        Self {
            attributes,
            namespaces,
            closed: false,
            end: None,
        }
    }
}

/// Where `what` ends, at or after `from`.
fn find(bytes: &[u8], from: usize, what: &[u8]) -> Option<usize> {
    let at = bytes.get(from..)?.windows(what.len()).position(|w| w == what)?;
    Some(from + at + what.len() - 1)
}

#[cfg(test)]
mod tests {
    use std::time::{Duration, Instant};

    use super::*;

    fn refused(text: &str) -> String {
        let since = Instant::now();
        let line = super::super::read(text.as_bytes())
            .expect_err("refused")
            .to_string();
        // 200,000 attributes took minutes before they were counted.
        assert!(since.elapsed() < Duration::from_secs(20), "{:?}", since.elapsed());
        assert!(line.chars().count() <= 300 && !line.contains('\n'), "{line}");
        line
    }

    #[test]
    fn each_bound_is_named() {
        let attributes: String = (0..200_000).map(|i| format!(" a{i}=\"=>\"")).collect();
        let line = refused(&format!("<OpenDRIVE>\n<road{attributes}/></OpenDRIVE>"));
        assert_eq!(line, "<road> (line 2): more than 200 attributes of one element");
        let line = refused(&"<a>".repeat(300_000));
        assert_eq!(line, "<a> (line 1): more than 200 elements around one another");
        let names: String = (0..100).map(|i| format!("<a xmlns:n{i}=\"u\"/>")).collect();
        assert_eq!(
            refused(&format!("<r>{names}</r>")),
            "<a> (line 1): more than 64 namespaces"
        );
        let line = refused(&format!("<r>{}</r>", "<a/>".repeat(MOST_ELEMENTS)));
        assert_eq!(line, "<a> (line 1): more than 2000000 elements");
    }

    #[test]
    fn what_only_looks_like_a_tag_is_not_counted() {
        let many = "<b a=''>".repeat(MOST_NESTED + 1);
        for text in [
            format!("<r><!-- {many} --></r>"),
            format!("<r><![CDATA[ {many} ]]></r>"),
            format!("<r><?note {many} ?></r>"),
            format!("<r>{}</r>", "<a b='/>='/>".repeat(MOST_NESTED + 1)),
            format!("<r>{}</r>", "<a b='c' d = \"e\"\n>x</a>".repeat(MOST_NESTED + 1)),
            "<r a='b".to_owned(),
            "<".to_owned(),
            "<!".to_owned(),
            "<!-->".to_owned(),
        ] {
            assert_eq!(check(&text), Ok(()), "{}", &text[..20.min(text.len())]);
        }
    }

    /// An attribute, a name and a value of a megabyte are quoted in part.
    #[test]
    fn a_megabyte_in_the_file_is_a_line_of_300_characters() {
        let long = "x".repeat(1 << 20);
        for text in [
            format!("<{long}/>"),
            format!("<OpenDRIVE><road id=\"{long}\" length=\"a\"/></OpenDRIVE>"),
            format!("<OpenDRIVE><road length=\"{long}\"/></OpenDRIVE>"),
            format!("<OpenDRIVE {long}='' {long}=''/>"),
            format!("<OpenDRIVE><{long}></OpenDRIVE>"),
        ] {
            refused(&text);
        }
    }
}
