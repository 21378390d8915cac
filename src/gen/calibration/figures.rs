//! Times and shares as text for people.

/// 0.05 as `50 ms`.
pub fn seconds(s: f64) -> String {
    if s < 0.0995 {
        format!("{:.0} ms", s * 1e3)
    } else if s < 9.95 {
        format!("{s:.2} s")
    } else {
        format!("{s:.0} s")
    }
}

/// A share as `1.8 %`.
pub fn percent(share: f64) -> String {
    let p = share * 100.0;
    if p >= 9.95 {
        format!("{p:.0} %")
    } else if p >= 0.0995 {
        format!("{p:.1} %")
    } else if p >= 0.0095 || p == 0.0 {
        format!("{p:.2} %")
    } else {
        "under 0.01 %".into()
    }
}
