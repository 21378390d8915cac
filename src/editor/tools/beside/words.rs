//! Names of things in undo steps and panels.

use language::{t, tf};
use scene::Form;

/// Name for a set of things. One thing: `tree`; several of a kind: `5 trees`; of several kinds: `5 things`.
pub fn count(forms: &[&Form]) -> String {
    match forms {
        [] => t("nothing").to_owned(),
        [one] => t(one.name()).to_owned(),
        [first, ..] if forms.iter().all(|f| f.name() == first.name()) => {
            tf!("{n} {things}", n = forms.len(), things = t(&plural(first.name())))
        }
        _ => tf!("{n} things", n = forms.len()),
    }
}

/// Plural of a kind, without a number, in English.
pub fn plural(name: &str) -> String {
    match name {
        "shrubs" => "areas of shrubs".to_owned(),
        "stairs" => "stairs".to_owned(),
        name if name.ends_with("ch") => format!("{name}es"),
        name => format!("{name}s"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::DVec2;
    use scene::background::{LineKind, Post, PostKind, SceneryLine};

    #[test]
    fn things_are_called_what_they_are() {
        let hedge = Form::Line(SceneryLine::typical(LineKind::Hedge, vec![DVec2::ZERO, DVec2::X]));
        let bench = Form::Post(Post {
            kind: PostKind::Bench,
            position_m: DVec2::ZERO,
            yaw_rad: 0.0,
            height_m: 1.0,
        });
        assert_eq!(count(&[&hedge]), "hedge");
        assert_eq!(count(&[&hedge, &hedge]), "2 hedges");
        assert_eq!(count(&[&bench, &bench, &bench]), "3 benches");
        assert_eq!(count(&[&hedge, &bench]), "2 things");
    }
}
