//! Broken files: one clear line each, never a panic, an endless loop or a heap that grows without bound.

use std::time::{Duration, Instant};

use formats::opendrive::{self, OpenDriveError};
use glam::DVec2;
use numeric::splitmix::SplitMix64;
use scene::Relief;

use super::{OWN, own_bytes};

/// A road of one lane that is fine as it stands.
const FAIR: &str = r#"<?xml version="1.0"?>
<OpenDRIVE>
  <header revMajor="1" revMinor="6"/>
  <road id="7" length="50" junction="-1">
    <planView>
      <geometry s="0" x="0" y="0" hdg="0" length="30"><line/></geometry>
      <geometry s="30" x="30" y="0" hdg="0" length="20"><arc curvature="0.01"/></geometry>
    </planView>
    <lanes><laneOffset s="0" a="0" b="0" c="0" d="0"/>
      <laneSection s="0">
        <center><lane id="0" type="none"/></center>
        <right><lane id="-1" type="driving"><width sOffset="0" a="3.5" b="0" c="0" d="0"/><roadMark sOffset="0" type="solid"/></lane></right>
      </laneSection>
      <laneSection s="20">
        <right><lane id="-1" type="driving"><width sOffset="0" a="3.5" b="0" c="0" d="0"/></lane></right>
      </laneSection>
    </lanes>
    <objects><object type="crosswalk" id="1" s="10" t="0" length="3" width="4"><repeat s="10" length="20" distance="5"/></object></objects>
  </road>
</OpenDRIVE>"#;

fn refused(text: &str) -> String {
    let error: OpenDriveError = opendrive::read(text.as_bytes()).expect_err(text);
    let line = error.to_string();
    assert!(!line.contains('\n') && line.len() < 300, "{line}");
    line
}

/// Whatever was read has to draw, too.
fn use_it(bytes: &[u8]) -> Result<(), OpenDriveError> {
    let network = opendrive::read(bytes)?;
    let (at, heading) = network.suggest_pose();
    let import = network.to_layout(at, heading);
    let points = import.layout.polylines.iter().flat_map(|l| &l.points_m);
    assert!(points.into_iter().all(|p| p.is_finite()));
    assert!((0.0..=1.0).contains(&import.drivable_share));
    assert_eq!(import.background.problem(), None);
    let heights = import.layout.relief.heights_m().unwrap_or_default();
    assert!(heights.iter().all(|h| h.abs() <= Relief::LIMIT_M));
    network.pose_on_lane_near(DVec2::new(3.0, 4.0));
    Ok(())
}

#[test]
fn what_is_wrong_is_named() {
    use_it(FAIR.as_bytes()).expect("fair");
    let cases: [(&str, &str, &[&str]); 22] = [
        (
            r#"length="30""#,
            r#"length="NaN""#,
            &["road \"7\", geometry 1 (line 6)", "length", "finite", "NaN"],
        ),
        (
            r#"hdg="0" length="20""#,
            r#"hdg="inf" length="20""#,
            &["geometry 2 (line 7)", "hdg", "inf"],
        ),
        (
            r#"curvature="0.01""#,
            r#"curvature="1e400""#,
            &["arc 1", "curvature", "1e400"],
        ),
        (r#"curvature="0.01""#, r#"curvature="x&#10;y""#, &["curvature"]),
        (
            r#"curvature="0.01""#,
            r#"curvature="1e9""#,
            &["geometry 2", "turn"],
        ),
        (r#"curvature="0.01""#, "", &["curvature", "no such attribute"]),
        (
            r#"length="30""#,
            r#"length="0""#,
            &["geometry 1", "length", "above 0"],
        ),
        (r#"length="30""#, r#"length="-3""#, &["length", "-3"]),
        (r#"length="30""#, r#"length="1e12""#, &["geometry 1", "1000000"]),
        (r#"length="50""#, r#"length="1e12""#, &["road \"7\"", "length"]),
        (r#"length="50""#, r#"length="-1""#, &["road \"7\"", "length"]),
        (
            r#" length="50""#,
            "",
            &["road \"7\"", "length", "no such attribute"],
        ),
        (r#"s="30""#, r#"s="0""#, &["geometry 2", "s", "more than 0"]),
        (r#"x="30""#, r#"x="1e300""#, &["geometry 2", "x", "magnitude"]),
        (
            r#"x="0" y="0" hdg="0" length="30""#,
            r#"length="30""#,
            &["geometry 1", "x"],
        ),
        ("<line/>", "", &["geometry 1", "paramPoly3", "none"]),
        ("<line/>", "<clothoid/>", &["geometry 1", "<clothoid>"]),
        ("planView", "planview", &["road \"7\"", "planView"]),
        (
            "<OpenDRIVE>",
            "<OpenDRIVE><road id=\"9\" length=\"3\"><planView/></road>",
            &["planView", "geometry", "at least one"],
        ),
        (
            r#"<laneSection s="20">"#,
            r#"<laneSection s="-1">"#,
            &["laneSection 2", "at least 0", "-1"],
        ),
        (
            r#"<lane id="-1""#,
            r#"<lane id="1""#,
            &["lane \"1\"", "negative whole number"],
        ),
        (r#"a="3.5""#, r#"a="wide""#, &["lane \"-1\"", "width 1", "wide"]),
    ];
    for (from, to, expected) in cases {
        let count = if from == "planView" { 9 } else { 1 };
        let line = refused(&FAIR.replacen(from, to, count));
        for part in expected {
            assert!(line.contains(part), "{to}: {line:?} does not say {part:?}");
        }
    }
    assert!(refused("").starts_with("not an XML file"));
    assert!(refused("PK\u{3}\u{4}").starts_with("not an XML file"));
    assert!(refused("<osm version='0.6'/>").contains("<osm>"));
    assert!(refused("<OpenDRIVE/>").contains("at least one road"));
    assert!(refused("<!DOCTYPE a [<!ENTITY b 'c'>]><OpenDRIVE/>").starts_with("not an XML file"));
    assert!(
        opendrive::read(b"<OpenDRIVE a='\xff'/>")
            .expect_err("bytes")
            .to_string()
            .contains("byte 14")
    );
}

#[test]
fn other_encodings_are_read() {
    let fair = opendrive::read(FAIR.as_bytes()).expect("fair");
    let wide: Vec<u8> = FAIR.encode_utf16().flat_map(u16::to_le_bytes).collect();
    assert_eq!(
        opendrive::read(&[&[0xff, 0xfe][..], &wide].concat()),
        Ok(fair.clone())
    );
    assert_eq!(
        opendrive::read(&[&[0xef, 0xbb, 0xbf][..], FAIR.as_bytes()].concat()),
        Ok(fair)
    );
    let latin = FAIR
        .replace("1.0\"?", "1.0\" encoding=\"ISO-8859-1\"?")
        .replace("revMajor", "name=\"Stra~e\" revMajor");
    let bytes: Vec<u8> = latin.bytes().map(|b| if b == b'~' { 0xdf } else { b }).collect();
    assert_eq!(opendrive::read(&bytes).expect("Latin-1").name, "Straße");
}

#[test]
fn the_unknown_is_counted() {
    let text = FAIR
        .replace(
            "</planView>",
            "</planView><lateralProfile><shape s=\"0\" t=\"1\"/></lateralProfile><railroad a=\"1\"/>",
        )
        .replace(
            "</objects>",
            "<object type=\"dragon\" s=\"1\" t=\"2\"/><object s=\"1\" t=\"2\"/><bridge s=\"1\"/></objects>",
        )
        .replacen("type=\"driving\"", "type=\"hover\"", 1)
        .replace("type=\"solid\"", "type=\"wavy\"")
        .replace(
            "</OpenDRIVE>",
            "<station id=\"1\"/><junction id=\"5\" type=\"virtual\"/><userData code=\"x\"/></OpenDRIVE>",
        );
    let skipped = opendrive::read(text.as_bytes()).expect("fair").skipped;
    let expected = [
        "lateralProfile/shape",
        "road/railroad",
        "object dragon",
        "object without type",
        "objects/bridge",
        "lane type hover",
        "road mark type wavy",
        "OpenDRIVE/station",
        "junction of type virtual",
        "userData",
    ];
    for kind in expected {
        assert_eq!(skipped.get(kind), Some(&1), "{kind} in {skipped:?}");
    }
    assert_eq!(skipped.values().sum::<usize>(), expected.len(), "{skipped:?}");
}

/// Row 62 of the extremes table: truncated files.
#[test]
fn row_62_truncated_roads_are_refused() {
    for name in OWN {
        let bytes = own_bytes(name);
        for cut in (0..bytes.len() - 20).step_by(997) {
            let error = use_it(&bytes[..cut]).expect_err("half a file");
            assert!(
                matches!(error, OpenDriveError::NotXml { .. }),
                "{name} cut at {cut}: {error}"
            );
        }
    }
}

/// Row 62 of the extremes table: damaged bytes.
#[test]
fn row_62_flipped_bytes_never_panic() {
    let mut dice = SplitMix64::new(62);
    let (mut fine, mut refused) = (0, 0);
    for name in OWN {
        let whole = own_bytes(name);
        for _ in 0..200 {
            let mut bytes = whole.clone();
            for _ in 0..=dice.below(4) {
                let at = dice.below(bytes.len());
                bytes[at] = match dice.below(3) {
                    0 => bytes[at] ^ (1 << dice.below(8)),
                    1 => b"0123456789.-e\"<>"[dice.below(16)],
                    _ => dice.below(256) as u8,
                };
            }
            *if use_it(&bytes).is_ok() {
                &mut fine
            } else {
                &mut refused
            } += 1;
        }
    }
    println!("flipped bytes: {fine} still read, {refused} refused");
    assert!(fine > 50 && refused > 50);
}

/// Row 62 of the extremes table: numbers at the edge of what a float can say, in every place.
#[test]
fn row_62_extreme_numbers_never_panic_or_hang() {
    const EXTREMES: [&str; 14] = [
        "NaN", "inf", "0", "-0", "-1", "1", "1e-300", "1e-9", "1e5", "1e12", "-1e12", "1e308", "-1e308", "",
    ];
    let started = Instant::now();
    let mut dice = SplitMix64::new(7);
    let (mut fine, mut refused) = (0, 0);
    for name in OWN {
        let text = String::from_utf8(own_bytes(name)).expect("UTF-8");
        let numbers: Vec<(usize, usize)> = text
            .match_indices("=\"")
            .map(|(at, _)| (at + 2, at + 2 + text[at + 2..].find('"').expect("a quote")))
            .filter(|(a, b)| text[*a..*b].parse::<f64>().is_ok())
            .collect();
        for _ in 0..100 {
            let mut changed = text.clone();
            let mut places: Vec<(usize, usize)> = (0..=dice.below(3))
                .map(|_| numbers[dice.below(numbers.len())])
                .collect();
            places.sort_unstable();
            places.dedup();
            for (a, b) in places.into_iter().rev() {
                changed.replace_range(a..b, EXTREMES[dice.below(EXTREMES.len())]);
            }
            let before = Instant::now();
            *if use_it(changed.as_bytes()).is_ok() {
                &mut fine
            } else {
                &mut refused
            } += 1;
            assert!(
                before.elapsed() < Duration::from_secs(60),
                "{name} took {:?}",
                before.elapsed()
            );
        }
    }
    println!(
        "extreme numbers: {fine} still read, {refused} refused, {:?}",
        started.elapsed()
    );
    assert!(fine > 50 && refused > 50);
}

/// Row 62 of the extremes table (the time limits are far above what is needed: machines are shared): files made to cost far more than their size.
#[test]
fn row_62_bombs_stay_small() {
    let road = |view: &str, rest: &str| {
        format!(
            r#"<OpenDRIVE><road id="1" length="1e6"><planView>{view}</planView>{rest}</road></OpenDRIVE>"#
        )
    };
    let lanes = |n: usize, width: &str| {
        let lane = |i: usize| {
            format!(
                r#"<lane id="-{i}" type="driving"><width sOffset="0" a="{width}" b="0" c="0" d="0"/></lane>"#
            )
        };
        let all: String = (1..=n).map(lane).collect();
        format!(r#"<lanes><laneSection s="0"><right>{all}</right></laneSection></lanes>"#)
    };
    let circle = r#"<geometry s="0" x="0" y="0" hdg="0" length="2000"><arc curvature="0.1"/></geometry>"#;
    let long = r#"<geometry s="0" x="0" y="0" hdg="0" length="1e6"><arc curvature="0.0002"/></geometry>"#;
    let spirals: String = (0..3000)
        .map(|i| format!(r#"<geometry s="{i}" x="0" y="0" hdg="0" length="1"><spiral curvStart="-199" curvEnd="199"/></geometry>"#))
        .collect();
    let crossing = r#"<objects><object type="crosswalk" s="0" t="0" length="1" width="1"><repeat s="0" length="1e300" distance="1e-300"/></object></objects>"#;
    let bombs = [
        (
            "deep",
            format!(
                "{}{}",
                "<OpenDRIVE>".repeat(100_000),
                "</OpenDRIVE>".repeat(100_000)
            ),
        ),
        ("circles in one place", road(circle, &lanes(500, "0.1"))),
        ("wide lanes", road(circle, &lanes(50, "1e6"))),
        ("long arc", road(long, &lanes(3, "3"))),
        ("spirals", road(&spirals, &lanes(3, "3"))),
        ("many lanes", road(circle, &lanes(20_000, "0.001"))),
        ("copies", road(circle, &(lanes(1, "3") + crossing))),
        (
            "rows of copies",
            road(
                circle,
                &crossing.replace(
                    "<repeat",
                    &(r#"<repeat s="0" length="100" distance="0.01"/>"#.repeat(5000) + "<repeat"),
                ),
            ),
        ),
        (
            "poly3",
            road(
                &spirals.replace(
                    r#"<spiral curvStart="-199" curvEnd="199"/>"#,
                    r#"<poly3 a="0" b="9" c="1e3" d="-1e5"/>"#,
                ),
                &lanes(1, "3"),
            ),
        ),
    ];
    for (name, text) in bombs {
        let started = Instant::now();
        let result = use_it(text.as_bytes());
        println!(
            "{name}: {} bytes, {:?}, {}",
            text.len(),
            started.elapsed(),
            result.map_or_else(|e| e.to_string(), |()| "read".into())
        );
        assert!(
            started.elapsed() < Duration::from_secs(60),
            "{name}: {:?}",
            started.elapsed()
        );
    }
}
