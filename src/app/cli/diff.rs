//! `sceneloom diff`: differences between two scenes: boxes, things beside the road, layout cells, voxels by class,
//! LiDAR.

use std::path::PathBuf;
use std::sync::Arc;

use serde_json::{Map, Value, json};

use super::{CommandResult, Common, output};
use anyhow::anyhow;
use app::open;
use app::picture::{RgbaPicture, layout_top, lidar_top, occupancy_top};
use assist::{changed_voxels, gained_and_lost};
use editor::columns_between;
use job::GenParams;
use job::region::edited_columns;
use scene::{Background, BevLayer, Class, Frame, LidarSweep, Scene, SceneBox, SourceFrame, Thing};
use sensors::lidar;

/// Arguments.
#[derive(clap::Args)]
pub struct Diff {
    /// Scene before.
    a: PathBuf,
    /// Scene after.
    b: PathBuf,
    /// Picture to write: both from above, and what changed between them.
    #[arg(short, long, value_name = "SHEET.png")]
    output: Option<PathBuf>,
    #[command(flatten)]
    common: Common,
}

/// A range that differs by less did not change, m.
const SAME_RANGE_M: f32 = 1e-3;
/// Pixels per column on the sheet.
const SCALE: usize = 3;

impl Diff {
    pub(super) fn run(self) -> CommandResult {
        let (a, b) = (open::scene(&self.a)?, open::scene(&self.b)?);
        let (before, after) = (a.frame(), b.frame());
        if before.extent() != after.extent() {
            return Err(anyhow!(
                "{} and {} are maps of different places or sizes, expected the same for both",
                self.a.display(),
                self.b.display()
            )
            .into());
        }
        let mut report = Map::new();
        report.insert("boxes".into(), boxes(before, after));
        report.insert("layout".into(), layout(before, after));
        report.insert("things".into(), things(&a.background, &b.background));
        // Columns where B's voxels may differ: those that an edit from A to B would inpaint, and those around things
        // that differ.
        let of_things = columns_between(&a.background, &b.background, after);
        let region = edited_columns(&edited(before, after), GenParams::default().halo_columns as usize);
        let region_count = region.iter().filter(|c| **c).count();
        let changed = changed_voxels(before, after);
        let inside = |[x, y, _]: &[usize; 3]| {
            let column = after.extent().index(*x, *y);
            region[column] || of_things[column]
        };
        let changed_inside = changed.iter().filter(|v| inside(v)).count();
        report.insert("voxels_changed".into(), changed.len().into());
        report.insert("voxels".into(), json!(gained_and_lost(before, after, &changed)));
        report.insert(
            "region".into(),
            json!({
                "columns": region_count,
                "share": region_count as f64 / region.len() as f64,
                "columns_of_things": of_things.iter().filter(|c| **c).count(),
            }),
        );
        report.insert("changed_inside_region".into(), changed_inside.into());
        report.insert(
            "changed_outside_region".into(),
            (changed.len() - changed_inside).into(),
        );
        let sweep = |s: &Scene| {
            let placed = s.for_sensors();
            lidar::rig_sweep(&placed.frame().occupancy, &placed.rig).unwrap_or_default()
        };
        let sweeps = (sweep(&a), sweep(&b));
        report.insert("lidar".into(), lidar_report(&a, &b, &sweeps.0, &sweeps.1));
        report.insert(
            "prompt".into(),
            json!({ "changed": a.prompt != b.prompt, "a": a.prompt, "b": b.prompt }),
        );
        report.insert(
            "conditions".into(),
            json!({ "changed": a.conditions != b.conditions, "a": a.conditions, "b": b.conditions }),
        );
        report.insert("rig_changed".into(), (a.rig != b.rig).into());
        report.insert("frames".into(), json!([a.clip().frames(), b.clip().frames()]));
        if let Some(path) = &self.output {
            let sheet = RgbaPicture::sheet(
                &[
                    vec![
                        layout_top(before, SCALE),
                        layout_top(after, SCALE),
                        layout_change(before, after),
                    ],
                    vec![
                        occupancy_top(&before.occupancy, SCALE),
                        occupancy_top(&after.occupancy, SCALE),
                        voxel_change(after, &changed),
                    ],
                    vec![
                        lidar_top(before.extent(), &sweeps.0, SCALE),
                        lidar_top(after.extent(), &sweeps.1, SCALE),
                    ],
                ],
                6,
            );
            output::write_png(path, sheet.width, sheet.height, &sheet.rgba)?;
            report.insert("files".into(), json!([path]));
        }
        let report = Value::Object(report);
        output::report(&self.common, &report, || text(&report));
        Ok(())
    }
}

/// The report for a person.
fn text(report: &Value) -> String {
    let changes = |of: &str| {
        let count = |key: &str| report[of][key].as_array().map_or(0, Vec::len);
        let (added, removed, changed) = (count("added"), count("removed"), count("changed"));
        format!("{of}: {added} added, {removed} removed, {changed} changed")
    };
    let mut lines = vec![
        changes("boxes"),
        changes("things"),
        format!("layout cells changed: {}", report["layout"]["cells_changed"]),
        format!(
            "voxels changed: {} ({} inside the region of the edit, {} outside)",
            report["voxels_changed"], report["changed_inside_region"], report["changed_outside_region"]
        ),
    ];
    for (class, of) in report["voxels"].as_object().into_iter().flatten() {
        lines.push(format!("  {class}: +{} -{}", of["gained"], of["lost"]));
    }
    let lidar = &report["lidar"];
    lines.push(match lidar["rays_changed"].as_u64() {
        Some(changed) => format!("LiDAR: {changed} of {} rays changed", lidar["rays"]),
        None => "LiDAR: not compared, as the sensors differ".to_owned(),
    });
    lines.join("\n")
}

/// The later frame as an edit of the earlier one.
fn edited(before: &Frame, after: &Frame) -> Frame {
    Frame {
        source: Arc::new(SourceFrame {
            layout: before.layout.clone(),
            boxes: before.boxes.clone(),
            occupancy: before.occupancy.clone(),
        }),
        ..after.clone()
    }
}

fn things(before: &Background, after: &Background) -> Value {
    let of = |t: &Thing| json!({ "id": t.id, "name": t.form.name(), "middle_m": t.form.middle_m() });
    let only = |here: &Background, there: &Background| -> Vec<Value> {
        here.iter()
            .filter(|t| there.get(t.id).is_none())
            .map(of)
            .collect()
    };
    let differs = |t: &&Thing| before.get(t.id).is_some_and(|was| was != *t);
    let changed: Vec<Value> = after.iter().filter(differs).map(of).collect();
    json!({ "added": only(after, before), "removed": only(before, after), "changed": changed })
}

fn boxes(before: &Frame, after: &Frame) -> Value {
    let of = |b: &SceneBox| json!({ "id": b.id, "class": b.class, "center_m": b.center_m });
    let only = |here: &Frame, there: &Frame| -> Vec<Value> {
        let gone = here.boxes.values().filter(|b| !there.boxes.contains_key(&b.id));
        gone.map(of).collect()
    };
    let pairs = before
        .boxes
        .values()
        .filter_map(|a| Some((a, after.boxes.get(&a.id)?)));
    let changed: Vec<Value> = pairs.filter(|(a, b)| a != b).map(|(a, b)| change(a, b)).collect();
    json!({ "added": only(after, before), "removed": only(before, after), "changed": changed })
}

/// The differences between two boxes of one id.
fn change(a: &SceneBox, b: &SceneBox) -> Value {
    let mut out = Map::new();
    out.insert("id".into(), json!(a.id));
    let mut note = |key: &str, differs: bool, value: Value| {
        if differs {
            out.insert(key.into(), value);
        }
    };
    note("class", a.class != b.class, json!([a.class, b.class]));
    note(
        "moved_m",
        a.center_m != b.center_m,
        json!(b.center_m - a.center_m),
    );
    note("resized_m", a.size_m != b.size_m, json!(b.size_m - a.size_m));
    let turn = (b.yaw_rad - a.yaw_rad).to_degrees().rem_euclid(360.0);
    let turn = if turn > 180.0 { turn - 360.0 } else { turn };
    note("turned_deg", a.yaw_rad != b.yaw_rad, json!(turn));
    note(
        "velocity_mps",
        a.velocity_mps != b.velocity_mps,
        json!([a.velocity_mps, b.velocity_mps]),
    );
    Value::Object(out)
}

fn layout(before: &Frame, after: &Frame) -> Value {
    let (a, b) = (before.layout.cells(), after.layout.cells());
    let mut layers = Map::new();
    for layer in BevLayer::MAP {
        let count = |with: &[u32], without: &[u32]| {
            let pairs = with.iter().zip(without);
            pairs
                .filter(|(w, o)| **w & layer.bit() != 0 && **o & layer.bit() == 0)
                .count()
        };
        let (set, cleared) = (count(b, a), count(a, b));
        if set + cleared > 0 {
            layers.insert(layer.name().into(), json!({ "set": set, "cleared": cleared }));
        }
    }
    let cells = a.iter().zip(b).filter(|(a, b)| a != b).count();
    let lines = before.layout.polylines != after.layout.polylines;
    json!({ "cells_changed": cells, "layers": layers, "polylines_changed": lines })
}

/// Ray by ray, where both scenes have the same LiDAR.
fn lidar_report(a: &Scene, b: &Scene, sweep_a: &LidarSweep, sweep_b: &LidarSweep) -> Value {
    let same_sensor =
        a.rig.lidars.first() == b.rig.lidars.first() && a.rig.ego_speed_mps == b.rig.ego_speed_mps;
    let rays = sweep_a.rays.max(sweep_b.rays);
    let rays_changed = same_sensor.then(|| {
        let by_ray = |sweep: &LidarSweep| -> std::collections::BTreeMap<(u16, u16), (f32, Class)> {
            let points = sweep.points.iter();
            points
                .map(|p| ((p.ring, p.azimuth), (p.range_m, p.class)))
                .collect()
        };
        let (of_a, of_b) = (by_ray(sweep_a), by_ray(sweep_b));
        let differs = |ray: &(u16, u16), range_m: f32, class: Class| match of_b.get(ray) {
            Some((other_m, other)) => (range_m - other_m).abs() > SAME_RANGE_M || class != *other,
            None => true,
        };
        let changed = of_a
            .iter()
            .filter(|(ray, (range_m, class))| differs(ray, *range_m, *class))
            .count();
        changed + of_b.keys().filter(|ray| !of_a.contains_key(ray)).count()
    });
    json!({
        "rays": rays,
        "returns": [sweep_a.points.len(), sweep_b.points.len()],
        "rays_changed": rays_changed,
    })
}

/// The later layout, dark; changed cells bright: orange where a layer went, blue where one came.
fn layout_change(before: &Frame, after: &Frame) -> RgbaPicture {
    let (a, b) = (before.bev_channels(), after.bev_channels());
    marked(layout_top(after, SCALE), |x, y| {
        let i = after.extent().index(x, y);
        mark(b[i] & !a[i] != 0, a[i] & !b[i] != 0)
    })
}

/// The later occupancy, dark; columns bright that gained (blue) or lost voxels (orange), or both (yellow).
fn voxel_change(after: &Frame, changed: &[[usize; 3]]) -> RgbaPicture {
    let extent = after.extent();
    let mut flags = vec![(false, false); extent.columns()];
    for &[x, y, z] in changed {
        let now_free = after.occupancy.get(x, y, z) == Class::FREE;
        let flag = &mut flags[extent.index(x, y)];
        *flag = (flag.0 | !now_free, flag.1 | now_free);
    }
    marked(occupancy_top(&after.occupancy, SCALE), |x, y| {
        let (came, went) = flags[extent.index(x, y)];
        mark(came, went)
    })
}

/// Colours that the colour-blind tell apart, too.
fn mark(came: bool, went: bool) -> Option<[u8; 3]> {
    match (came, went) {
        (true, true) => Some([250, 220, 60]),
        (true, false) => Some([70, 160, 255]),
        (false, true) => Some([255, 140, 40]),
        (false, false) => None,
    }
}

fn marked(mut picture: RgbaPicture, of: impl Fn(usize, usize) -> Option<[u8; 3]>) -> RgbaPicture {
    let (width, height) = (picture.width, picture.height);
    for (at, pixel) in picture.rgba.chunks_exact_mut(4).enumerate() {
        let (column, row) = (at % width / SCALE, at / width / SCALE);
        // Ego x is up, ego y is left.
        let cell = of(height / SCALE - 1 - row, width / SCALE - 1 - column);
        for (channel, value) in pixel[..3].iter_mut().enumerate() {
            *value = cell.map_or(*value / 3, |color| color[channel]);
        }
    }
    picture
}
