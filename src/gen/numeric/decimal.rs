//! Numbers as texts.

/// A number with so many decimals; never a zero with a sign.
pub fn decimal(value: f64, decimals: usize) -> String {
    let text = format!("{value:.decimals$}");
    match text.strip_prefix('-') {
        Some(rest) if rest.bytes().all(|b| matches!(b, b'0' | b'.')) => rest.to_owned(),
        _ => text,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_zero_has_a_sign() {
        assert_eq!(decimal(-0.04, 1), "0.0");
        assert_eq!(decimal(-0.0, 2), "0.00");
        assert_eq!(decimal(-0.06, 1), "-0.1");
        assert_eq!(decimal(12.34, 0), "12");
        assert_eq!(decimal(-10.0, 0), "-10");
    }
}
