//! Numbers and text as XML attributes.

/// A number with at most nine decimals and without trailing zeros; 0 for one that is not finite.
pub(crate) fn number(value: f64) -> String {
    if !value.is_finite() {
        return "0".into();
    }
    let text = format!("{value:.9}");
    match text.trim_end_matches('0').trim_end_matches('.') {
        "-0" | "" => "0".into(),
        text => text.into(),
    }
}

/// Text as the value of an attribute in double quotes.
pub(crate) fn escaped(text: &str) -> String {
    let mut out = String::with_capacity(text.len());
    for c in text.chars() {
        match c {
            '&' => out.push_str("&amp;"),
            '<' => out.push_str("&lt;"),
            '>' => out.push_str("&gt;"),
            '"' => out.push_str("&quot;"),
            // Characters that XML 1.0 does not allow, and characters that readers turn into blanks.
            c if c.is_control() || matches!(c, '\u{fffe}' | '\u{ffff}') => out.push(' '),
            c => out.push(c),
        }
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_and_text_are_tidy() {
        let all = [
            (1.0, "1"),
            (-0.0, "0"),
            (-1e-12, "0"),
            (0.1 + 0.2, "0.3"),
            (100.0, "100"),
            (f64::NAN, "0"),
            (-2.5e-9, "-0.000000003"),
        ];
        for (value, text) in all {
            assert_eq!(number(value), text);
        }
        let text = "a<b> & \"c\"\n\u{1}ä";
        let document = format!("<r a=\"{}\"/>", escaped(text));
        let read = roxmltree::Document::parse(&document).expect("well formed");
        assert_eq!(read.root_element().attribute("a"), Some("a<b> & \"c\"  ä"));
    }
}
