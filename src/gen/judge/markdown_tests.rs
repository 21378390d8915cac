//! Tests of the table of suites: every suite has its section, what cannot be measured says so, commands name their options.

use super::*;
use crate::table::SUITES;

/// Suites that answer at once, through the same path as the real ones.
static QUICK: [Suite; 2] = [
    Suite {
        name: "one",
        title: "Everything that a report may hold",
        figures: &[
            ("a mean", "/mean"),
            ("a share", "/part/share"),
            ("a | number", "/number"),
            ("nothing", "/absent"),
            ("the mean of nothing", "/none"),
        ],
        takes_data: false,
        quick: |options| options.frames = 3,
        table: None,
        run: |options, progress| {
            progress.at("one", 0, options.frames);
            let report = json!({
                "mean": { "mean": 0.5, "ci95": 0.125, "n": 7 },
                "part": { "share": { "share": 0.25, "low": 0.1, "high": 0.5, "n": 4 } },
                "number": 12345.6,
                "none": { "mean": -0.0, "ci95": 0.0, "n": 0 },
            });
            Ok((
                report,
                vec![
                    ("kept", 1.0, 1.0),
                    ("short", 0.5, 0.75),
                    ("absent", f64::NAN, 0.0),
                ],
            ))
        },
    },
    Suite {
        name: "two",
        title: "One that cannot run",
        figures: &[],
        takes_data: false,
        quick: |_| {},
        table: None,
        run: |_, _| anyhow::bail!("no files\nthere"),
    },
];

fn quick(suite: &Suite) -> Options {
    let mut options = Options::default();
    (suite.quick)(&mut options);
    options
}

#[test]
fn every_suite_has_its_section() {
    let tables = measure_all(QUICK.iter(), &quick, &());
    let origin = Origin::now("sceneloom eval all --quick --markdown".into());
    let text = markdown(&origin, &tables);
    for line in [
        "# Figures",
        "## one: Everything that a report may hold",
        "`sceneloom eval one --frames 3` (n = 3, 0 s)",
        "| a mean | 0.500 | 0.375 to 0.625 | 7 |  |",
        "| a share | 0.250 | 0.100 to 0.500 | 4 |  |",
        "| a \\| number | 12346 |  |  |  |",
        "| nothing | – |  |  |  |",
        "| the mean of nothing | – |  | 0 |  |",
        "| kept | 1 |  |  | ≥ 1 |",
        "| short | 0.500 |  |  | ≥ 0.750, **missed** |",
        "| absent | – |  |  | ≥ 0, **missed** |",
        "## two: One that cannot run",
        "Not measured: no files; there",
    ] {
        assert!(text.lines().any(|l| l == line), "{line:?} is missing in\n{text}");
    }
    assert!(text.contains(&origin.commit) && text.contains(&origin.date));
    let Ok((report, _)) = &tables[0].found else {
        panic!("measured")
    };
    assert_eq!(report.missed(), ["short 0.500 below 0.75", "absent NaN below 0"]);
    assert_eq!(tables[0].json()["n"], 3);
    assert_eq!(tables[1].json()["error"], "no files; there");
}

#[test]
fn a_command_says_no_absolute_path() {
    let here = std::env::current_dir().expect("a folder").join("deep/frames");
    let options = Options {
        frames: 3,
        data: Some(here),
        prompts: Some("sets/a.jsonl".into()),
        ..Options::default()
    };
    let text = command(&SUITES[0], &options);
    assert!(text.ends_with(" --data frames --prompts sets/a.jsonl"), "{text}");
}

/// Figures are told apart by name, pointers start at the root, and a quick run is a small one.
#[test]
fn the_table_of_suites_is_sound() {
    for (i, suite) in SUITES.iter().enumerate() {
        assert!(SUITES[..i].iter().all(|s| s.name != suite.name), "{}", suite.name);
        assert!(!suite.figures.is_empty(), "{}", suite.name);
        for (k, (name, at)) in suite.figures.iter().enumerate() {
            assert!(at.starts_with('/'), "{}: {at}", suite.name);
            assert!(
                suite.figures[..k].iter().all(|f| f.0 != *name && f.1 != *at),
                "{name}"
            );
        }
        let small = quick(suite);
        assert_ne!(small, Options::default(), "{}", suite.name);
        let line = command(suite, &small);
        assert!(
            line.starts_with(&format!("sceneloom eval {} --frames", suite.name)),
            "{line}"
        );
    }
}

/// The quickest real suites on one world: every figure that they show is in their reports.
#[test]
fn real_suites_fill_their_tables() {
    let one = |suite: &Suite| Options {
        frames: 1,
        ..quick(suite)
    };
    for name in ["world", "splat"] {
        let suite = SUITES.iter().find(|s| s.name == name).expect("a suite");
        let report = suite.measure(&one(suite), &()).expect("measured");
        let rows = rows(suite, &report);
        assert_eq!(rows.len(), suite.figures.len() + report.bars.len());
        let empty: Vec<&FigureRow> = rows.iter().filter(|r| r.value.is_none()).collect();
        // (a single world tells nothing of lost echoes)
        assert!(
            empty.iter().all(|r| r.figure.starts_with("lost echoes")),
            "{empty:?}"
        );
    }
}

/// What `eval all --quick --markdown` does, with the smallest numbers of worlds: every suite is measured and every figure found.
/// Run: `cargo test --release -p sceneloom-judge --lib -- --ignored --nocapture quick`.
#[test]
#[ignore = "takes minutes"]
fn quick_run_of_every_suite() {
    let words = concat!(env!("CARGO_MANIFEST_DIR"), "/../../../tests/words/dev");
    let small = |suite: &Suite| Options {
        prompts: Some(words.into()),
        ..quick(suite)
    };
    let tables = measure_all(SUITES.iter(), &small, &());
    println!(
        "{}",
        markdown(
            &Origin::now("sceneloom eval all --quick --markdown".into()),
            &tables
        )
    );
    for table in &tables {
        let Ok((_, rows)) = &table.found else {
            panic!("{}: not measured", table.name)
        };
        let empty: Vec<&str> = rows
            .iter()
            .filter(|r| r.value.is_none())
            .map(|r| r.figure.as_str())
            .collect();
        assert!(empty.is_empty(), "{}: {empty:?}", table.name);
    }
    let all_s: f64 = tables.iter().map(|t| t.wall_s).sum();
    println!("all suites: {all_s:.0} s");
}
