//! Geometry against `tests/reference/opendrive_points.json`: mpmath 1.3.0 quadrature at 40 digits,
//! cross-checked with SciPy 1.17.1 (see its `meta`, where the tolerances below come from).

use formats::opendrive::geometry::{CurveShape, Geometry};
use glam::DVec2;
use serde_json::Value;

fn number(curve: &Value, key: &str) -> f64 {
    curve[key]
        .as_f64()
        .unwrap_or_else(|| panic!("{key} of {}", curve["name"]))
}

fn shape(curve: &Value) -> CurveShape {
    match curve["kind"].as_str() {
        Some("line") => CurveShape::Line,
        Some("arc") => CurveShape::Arc {
            curvature_per_m: number(curve, "curvature"),
        },
        Some("spiral") => CurveShape::Spiral {
            start_per_m: number(curve, "curvStart"),
            end_per_m: number(curve, "curvEnd"),
        },
        Some("paramPoly3") => CurveShape::ParamPoly3 {
            u: ["aU", "bU", "cU", "dU"].map(|k| number(curve, k)),
            v: ["aV", "bV", "cV", "dV"].map(|k| number(curve, k)),
            normalized: curve["pRange"] == "normalized",
        },
        other => panic!("{other:?}"),
    }
}

#[test]
fn points_headings_and_curvatures_match() {
    let text = include_str!("../../reference/opendrive_points.json");
    let file: Value = serde_json::from_str(text).expect("JSON");
    let curves = file["curves"].as_array().expect("a list");
    assert_eq!(curves.len(), 24);
    let mut worst = [0.0f64; 3];
    for curve in curves {
        let length = number(curve, "length");
        let start = DVec2::new(number(curve, "x"), number(curve, "y"));
        let g = Geometry::new(0.0, start, number(curve, "hdg"), length, shape(curve)).expect("a fair curve");
        for row in curve["points"].as_array().expect("rows") {
            let [s, x, y, heading, curvature] = [0, 1, 2, 3, 4].map(|i| row[i].as_f64().expect("a number"));
            let got = g.at(s);
            let scale = length.max(x.abs()).max(y.abs()).max(1.0);
            let errors = [
                (got.position_m.x - x).abs().max((got.position_m.y - y).abs()) / scale,
                (got.heading_rad - heading).abs(),
                (got.curvature_per_m - curvature).abs(),
            ];
            for ((error, limit), worst) in errors.into_iter().zip([1e-9, 1e-11, 1e-12]).zip(&mut worst) {
                assert!(error <= limit, "{} at s = {s}: {errors:?}", curve["name"]);
                *worst = worst.max(error);
            }
        }
    }
    println!(
        "largest error: position {:.1e} (relative), heading {:.1e} rad, curvature {:.1e} 1/m",
        worst[0], worst[1], worst[2]
    );
}

/// A paramPoly3 without pRange is read by the speed at its start.
#[test]
fn a_missing_p_range_is_guessed_and_counted() {
    for (p_range, b_u) in [("normalized", 30.0), ("arcLength", 1.0)] {
        let text = |attribute: &str| {
            format!(
                r#"<OpenDRIVE><road id="1" length="30" junction="-1"><planView><geometry s="0" x="0" y="0" hdg="0" length="30">
                <paramPoly3 aU="0" bU="{b_u}" cU="0" dU="0" aV="0" bV="0" cV="0" dV="0"{attribute}/></geometry></planView></road></OpenDRIVE>"#
            )
        };
        let said = formats::opendrive::read(text(&format!(r#" pRange="{p_range}""#)).as_bytes());
        let guessed = formats::opendrive::read(text("").as_bytes());
        let (said, guessed) = (said.expect("fair"), guessed.expect("fair"));
        assert_eq!(said.roads[0].reference, guessed.roads[0].reference, "{p_range}");
        assert_eq!(guessed.skipped["paramPoly3 without pRange (guessed)"], 1);
        assert!((guessed.roads[0].reference.at(15.0).position_m.x - 15.0).abs() < 1e-12);
    }
}
