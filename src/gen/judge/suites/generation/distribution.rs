//! Distances of a set of scenes to other worlds: by features pooled over the frame, and by those of cells and windows.

use serde_json::{Value, json};

use metrics::frechet::frechet_distance;
use metrics::kernel::{Kernel, mmd2_with_interval};
use metrics::local::Windows;
use metrics::scenewise::{self, standardised};

/// Number of parts that the sets are split into for the intervals of MMD and KID.
const SUBSETS: usize = 8;

/// F3D, KID and MMD of the pooled features of worlds and a set, then Fréchet and kernel distances of the extractor's 192
/// features of single cells (4 x 4 columns) and of windows of 8 x 8 columns. Null below two frames.
pub fn distances(
    pooled: [&Vec<Vec<f64>>; 2],
    cells: &[Vec<Windows>; 2],
    windows: &[Vec<Windows>; 2],
) -> anyhow::Result<Value> {
    let [others, set] = pooled;
    if others.len() < 2 {
        return Ok(Value::Null);
    }
    let kernel = |kernel| -> anyhow::Result<Value> {
        let (mean, half) = mmd2_with_interval(kernel, others, set, SUBSETS)?;
        Ok(json!({ "mean": mean, "ci95": half }))
    };
    // One bandwidth for all rows: that of the worlds among themselves.
    let gaussian = Kernel::median_gaussian(others, others);
    let local = |[x, y]: &[Vec<Windows>; 2], alike: bool| -> anyhow::Result<Value> {
        let scaled;
        let (x, y) = if alike {
            scaled = standardised(x, y)?;
            (&scaled[0], &scaled[1])
        } else {
            (x, y)
        };
        Ok(json!({ "frechet": scenewise::frechet(x, y)?, "kernel": scenewise::kernel(x, y)? }))
    };
    Ok(json!({
        "n": others.len(),
        "pooled": {
            "f3d": frechet_distance(others, set)?,
            "kid": kernel(Kernel::Cubic)?,
            "mmd2_gaussian": kernel(gaussian)?,
        },
        "cells": local(cells, false)?,
        "windows": local(windows, true)?,
    }))
}
