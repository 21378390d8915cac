//! Filter and grouping of the listed findings: by severity, by words, by kind or by object.

use std::collections::BTreeSet;

use editor::checks::{Finding, Severity, title};
use language::t;
use scene::BoxId;

/// Grouping of the list.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) enum Grouping {
    /// By the check.
    #[default]
    Kind,
    /// By the box that it is about.
    Object,
    /// A plain list without groups.
    List,
}

impl Grouping {
    /// Every grouping, with name and hint.
    pub(super) const ALL: [(Grouping, &'static str, &'static str); 3] = [
        (Grouping::Kind, "By kind", "What a check found, together"),
        (Grouping::Object, "By object", "What is about a box, together"),
        (Grouping::List, "List", "The worst first"),
    ];
}

/// Filter and grouping chosen by the user.
#[derive(Clone, Debug, Default)]
pub(super) struct Triage {
    /// Grouping of the list.
    pub grouping: Grouping,
    /// Severities that are not listed.
    pub hidden: [bool; Severity::ALL.len()],
    /// Words that must all be in a listed finding.
    pub words: String,
    /// Groups that a click folded or unfolded. Groups of infos only are folded at first.
    pub turned: BTreeSet<String>,
}

/// A line of the list.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum TriageRow {
    /// Header of a group.
    Group {
        /// Title of the group.
        title: String,
        /// Its findings, by index.
        of: Vec<usize>,
        /// The worst severity among them.
        worst: Severity,
        /// True if the findings are not listed.
        folded: bool,
    },
    /// A finding, by index.
    Finding(usize),
}

impl Triage {
    fn shows(&self, finding: &Finding) -> bool {
        let hidden = Severity::ALL
            .iter()
            .zip(self.hidden)
            .any(|(s, hidden)| hidden && *s == finding.severity);
        let text = || {
            let (says, kind) = (&finding.text, title(finding.check));
            format!("{says} {} {kind} {} {}", t(says), t(kind), finding.check).to_lowercase()
        };
        !hidden
            && (self.words.is_empty() || {
                let text = text();
                self.words
                    .to_lowercase()
                    .split_whitespace()
                    .all(|word| text.contains(word))
            })
    }

    fn group(&self, finding: &Finding, name: &dyn Fn(BoxId) -> String) -> String {
        match (self.grouping, finding.box_id) {
            (Grouping::Kind | Grouping::List, _) => title(finding.check).to_owned(),
            (Grouping::Object, Some(id)) => name(id),
            (Grouping::Object, None) => "Of no object".to_owned(),
        }
    }

    /// The lines for findings that are sorted by severity, the worst first; `name` gives the name of a box.
    pub(super) fn lines(&self, findings: &[&Finding], name: &dyn Fn(BoxId) -> String) -> Vec<TriageRow> {
        let shown = (0..findings.len()).filter(|i| self.shows(findings[*i]));
        if self.grouping == Grouping::List {
            return shown.map(TriageRow::Finding).collect();
        }
        let mut groups: Vec<(String, Vec<usize>)> = Vec::new();
        for i in shown {
            let name = self.group(findings[i], name);
            match groups.iter_mut().find(|(of, _)| *of == name) {
                Some((_, list)) => list.push(i),
                None => groups.push((name, vec![i])),
            }
        }
        let mut out = Vec::new();
        for (title, of) in groups {
            // A single error or warning needs no header.
            if let ([only], true) = (&of[..], findings[of[0]].severity > Severity::Info) {
                out.push(TriageRow::Finding(*only));
                continue;
            }
            let worst = findings[of[0]].severity;
            let folded = (worst == Severity::Info) != self.turned.contains(&title);
            let below: Vec<TriageRow> = of
                .iter()
                .filter(|_| !folded)
                .map(|i| TriageRow::Finding(*i))
                .collect();
            out.push(TriageRow::Group {
                title,
                of,
                worst,
                folded,
            });
            out.extend(below);
        }
        out
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn finding(check: &'static str, severity: Severity, id: u32, text: &str) -> Finding {
        Finding {
            check,
            severity,
            where_m: glam::DVec3::ZERO,
            time_s: None,
            box_id: (id > 0).then_some(BoxId(id)),
            cells: Vec::new(),
            text: text.into(),
            fixes: Vec::new(),
        }
    }

    fn titles(lines: &[TriageRow]) -> Vec<(String, usize, bool)> {
        let of = |line: &TriageRow| match line {
            TriageRow::Group {
                title, of, folded, ..
            } => Some((title.clone(), of.len(), *folded)),
            TriageRow::Finding(_) => None,
        };
        lines.iter().filter_map(of).collect()
    }

    #[test]
    fn findings_are_grouped_filtered_and_folded() {
        let all = [
            finding("off_road", Severity::Error, 7, "car 7 is off the road"),
            finding("off_road", Severity::Warning, 8, "car 8 is off the road"),
            finding(
                "floating_voxels",
                Severity::Warning,
                0,
                "3 voxels of manmade float",
            ),
            finding("no_lidar_returns", Severity::Info, 7, "car 7 has no LiDAR return"),
            finding("no_lidar_returns", Severity::Info, 9, "bus 9 has no LiDAR return"),
        ];
        let all: Vec<&Finding> = all.iter().collect();
        let mut triage = Triage::default();
        let name = |id: BoxId| format!("object {}", id.0);
        let by_kind = triage.lines(&all, &name);
        let expected = [("Off the road", 2, false), ("No LiDAR return", 2, true)];
        assert_eq!(titles(&by_kind), expected.map(|(t, n, f)| (t.to_owned(), n, f)));
        assert_eq!(by_kind.len(), 5, "what is folded is not listed");
        assert!(by_kind.contains(&TriageRow::Finding(2)), "alone, without a head");
        triage.turned.insert("No LiDAR return".into());
        assert_eq!(triage.lines(&all, &name).len(), 7);
        triage.grouping = Grouping::Object;
        let names: Vec<String> = titles(&triage.lines(&all, &name))
            .into_iter()
            .map(|(t, ..)| t)
            .collect();
        assert_eq!(names, ["object 7", "object 9"]);
        triage.grouping = Grouping::List;
        triage.words = "LIDAR car".into();
        assert_eq!(triage.lines(&all, &name), [TriageRow::Finding(3)]);
        triage.words.clear();
        triage.hidden = [false, false, true];
        assert_eq!(triage.lines(&all, &name), [0, 1, 2].map(TriageRow::Finding));
    }
}
