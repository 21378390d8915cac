//! The two-sample test of a set of scenes against other worlds, with the features that tell them apart.

use serde_json::{Value, json};

use metrics::local::Windows;
use metrics::two_sample::{tells, two_sample};

/// Fewest scenes of a set.
const FEWEST: usize = 4;
/// Number of features that are named.
const NAMED: usize = 5;

/// Accuracy by window and by scene, .5 where the sets cannot be told apart, and the features that differ most. Null
/// below four scenes.
pub fn report([others, set]: &[Vec<Windows>; 2], names: &[String], seed: u64) -> anyhow::Result<Value> {
    if others.len().min(set.len()) < FEWEST {
        return Ok(Value::Null);
    }
    let found = two_sample(others, set, seed)?;
    let round = |v: f64| (v * 1e4).round() / 1e4;
    let tells: Vec<Value> = tells(others, set, names, NAMED)
        .into_iter()
        .map(|t| {
            json!({
                "feature": t.feature,
                "worlds": round(t.of_x),
                "found": round(t.of_y),
                "sigmas": (t.sigmas * 10.0).round() / 10.0,
            })
        })
        .collect();
    Ok(json!({
        "window": found.window,
        "scene": found.scene,
        "guessing": found.window.is_guessing() && found.scene.is_guessing(),
        "tells": tells,
    }))
}
