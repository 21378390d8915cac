//! Sceneloom's own rows in an OpenDRIVE file: the layout to the last cell, beside the roads that are made of it.
//!
//! `<userData code="sceneloom" value="layout 1">` holds `<extent from="-100 -100" columns="200 200" roads="..."/>`, then
//! `<cells rows="2">3*40 0*160</cells>` (map layers as bits, run by run along y, for so many columns along x), `<heights>` of the
//! same form (m; only where the ground is not flat) and `<line kind="lane_center">x y x y</line>`, with
//! `kind="speed_limit" mm_per_s="13889"` for limits. `roads` is a check sum of the text from the first `<road ` up to
//! the rows: the rows are ignored if another program has changed a road.

use std::fmt::Write as _;

use glam::DVec2;
use roxmltree::Node;

use super::xml::{child, named};
use scene::{BevLayout, Extent, Polyline, PolylineKind, Relief};

/// Value of the `code` attribute.
pub(super) const CODE: &str = "sceneloom";
/// Value of the `value` attribute.
const VERSION: &str = "layout 1";
/// Names of the kinds of lines, as in project files; a speed limit has its number beside it.
const KINDS: [(&str, PolylineKind); 5] = [
    ("lane_center", PolylineKind::LaneCenter),
    ("road_divider", PolylineKind::RoadDivider),
    ("lane_divider", PolylineKind::LaneDivider),
    ("stop_line", PolylineKind::StopLine),
    ("ped_crossing", PolylineKind::PedCrossing),
];

/// Name and attribute of a speed limit.
const LIMIT: &str = "speed_limit";
const LIMIT_FIELD: &str = "mm_per_s";

/// A layout as it was written, still packed.
#[derive(Clone, Debug, PartialEq)]
pub struct OwnLayout {
    extent: Extent,
    cells: Vec<RepeatedColumns<u8>>,
    heights: Vec<RepeatedColumns<f32>>, // empty if flat
    lines: Vec<Polyline>,
}

/// Equal columns along x: how many, and their runs along y.
#[derive(Clone, Debug, PartialEq)]
struct RepeatedColumns<T> {
    count: usize,
    runs: Vec<(T, u16)>,
}

impl OwnLayout {
    /// The map that it covers.
    pub fn extent(&self) -> Extent {
        self.extent
    }

    /// The layout, bit for bit.
    pub fn layout(&self) -> BevLayout {
        let cells = unpacked(&self.cells).map(u32::from).collect();
        let mut layout = BevLayout::from_cells_over(self.extent, cells, self.lines.clone())
            .expect("rows were counted when they were read");
        if !self.heights.is_empty() {
            let heights = unpacked(&self.heights).collect();
            layout.relief = Relief::from_heights(self.extent, heights).unwrap_or_default();
        }
        layout
    }

    /// From the rows; `roads` is the text between the first `<road ` and them. Errors in a few words.
    pub(super) fn read(node: Node<'_, '_>, roads: &str) -> Result<Self, &'static str> {
        if node.attribute("value") != Some(VERSION) {
            return Err("rows of another version");
        }
        let of = child(node, "extent").ok_or("rows without an extent")?;
        if of.attribute("roads") != Some(check_sum(roads).as_str()) {
            return Err("rows left out, as the roads were changed since");
        }
        let pair = |field: &str| -> Option<[i64; 2]> {
            let numbers: Result<Vec<i64>, _> = of
                .attribute(field)?
                .split(' ')
                .take(3)
                .map(str::parse::<i64>)
                .collect();
            numbers.ok()?.try_into().ok()
        };
        let (from, columns) = pair("from")
            .zip(pair("columns"))
            .ok_or("rows without an extent")?;
        let from = from.map(i32::try_from);
        let columns = columns.map(usize::try_from);
        let extent = match (from, columns) {
            ([Ok(x), Ok(y)], [Ok(nx), Ok(ny)]) => Extent::new([x, y], [nx, ny]).ok(),
            _ => None,
        };
        let extent = extent.ok_or("rows without an extent")?;
        let cells = packed(node, "cells", extent, |text| text.parse().ok())?;
        let sound = |m: f32| (m.abs() <= Relief::LIMIT_M).then_some(m);
        let heights = match child(node, "heights") {
            Some(_) => packed(node, "heights", extent, |text| text.parse().ok().and_then(sound))?,
            None => Vec::new(),
        };
        if cells.is_empty() {
            return Err("rows without cells");
        }
        let lines = named(node, "line").map(line).collect::<Option<Vec<_>>>();
        Ok(Self {
            extent,
            cells,
            heights,
            lines: lines.ok_or("rows with an unreadable line")?,
        })
    }
}

/// The rows of a layout, to be put behind the text of its roads.
pub(super) fn write(layout: &BevLayout, roads: &str) -> String {
    let extent = layout.extent();
    let [x, y] = extent.from();
    let mut out = format!(
        "  <userData code=\"{CODE}\" value=\"{VERSION}\">\n    <extent from=\"{x} {y}\" columns=\"{} {}\" roads=\"{}\"/>\n",
        extent.nx(),
        extent.ny(),
        check_sum(roads.trim_start()),
    );
    pack(&mut out, "cells", extent, layout.cells(), |a, b| a == b);
    let relief = layout.relief.crop(extent);
    if let Some(heights) = relief.heights_m() {
        pack(&mut out, "heights", extent, heights, |a, b| {
            a.to_bits() == b.to_bits()
        });
    }
    for line in layout.polylines.iter() {
        let name = match line.kind {
            PolylineKind::SpeedLimit { mm_per_s } => format!("{LIMIT}\" {LIMIT_FIELD}=\"{mm_per_s}"),
            kind => {
                let known = KINDS.iter().find(|(_, known)| *known == kind);
                known.map_or("", |(name, _)| name).to_owned()
            }
        };
        let points = line.points_m.iter().map(|p| format!("{} {}", p.x, p.y));
        let _ = writeln!(
            out,
            "    <line kind=\"{name}\">{}</line>",
            points.collect::<Vec<_>>().join(" ")
        );
    }
    out.push_str("  </userData>\n");
    out
}

fn pack<T: std::fmt::Display>(
    out: &mut String,
    name: &str,
    extent: Extent,
    values: &[T],
    same: impl Fn(&T, &T) -> bool,
) {
    let rows: Vec<&[T]> = values.chunks(extent.ny()).collect();
    let equal = |a: &&[T], b: &&[T]| a.iter().zip(b.iter()).all(|(a, b)| same(a, b));
    for rows in rows.chunk_by(equal) {
        let runs = rows[0].chunk_by(&same);
        let runs: Vec<String> = runs.map(|run| format!("{}*{}", run[0], run.len())).collect();
        let _ = writeln!(
            out,
            "    <{name} rows=\"{}\">{}</{name}>",
            rows.len(),
            runs.join(" ")
        );
    }
}

/// The rows of one name; together they cover exactly the extent.
fn packed<T>(
    node: Node<'_, '_>,
    name: &'static str,
    extent: Extent,
    value: impl Fn(&str) -> Option<T>,
) -> Result<Vec<RepeatedColumns<T>>, &'static str> {
    let mut out = Vec::new();
    let mut left = extent.nx();
    for node in named(node, name) {
        let count = node.attribute("rows").and_then(|n| n.parse().ok());
        let count: usize = count
            .filter(|n| (1..=left).contains(n))
            .ok_or("rows beyond their extent")?;
        left -= count;
        let mut runs = Vec::new();
        let mut columns = extent.ny();
        for run in node.text().unwrap_or_default().split(' ') {
            let (of, length) = run.split_once('*').ok_or("rows with an unreadable run")?;
            let length: u16 = length.parse().map_err(|_| "rows with an unreadable run")?;
            columns = columns
                .checked_sub(usize::from(length))
                .filter(|_| length > 0)
                .ok_or("rows beyond their extent")?;
            runs.push((value(of).ok_or("rows with an unreadable run")?, length));
        }
        if columns > 0 {
            return Err("rows shorter than their extent");
        }
        runs.shrink_to_fit();
        out.push(RepeatedColumns { count, runs });
    }
    match left {
        0 => Ok(out),
        _ if out.is_empty() => Ok(out),
        _ => Err("rows shorter than their extent"),
    }
}

fn unpacked<T: Copy>(rows: &[RepeatedColumns<T>]) -> impl Iterator<Item = T> {
    let one = |runs: &[(T, u16)]| -> Vec<T> {
        let values = runs
            .iter()
            .flat_map(|(value, n)| std::iter::repeat_n(*value, usize::from(*n)));
        values.collect()
    };
    rows.iter()
        .flat_map(move |rows| std::iter::repeat_n(one(&rows.runs), rows.count).flatten())
}

fn line(node: Node<'_, '_>) -> Option<Polyline> {
    let name = node.attribute("kind")?;
    let kind = match name {
        LIMIT => PolylineKind::SpeedLimit {
            mm_per_s: node.attribute(LIMIT_FIELD)?.parse().ok()?,
        },
        _ => KINDS.iter().find(|(known, _)| *known == name)?.1,
    };
    let text = node.text().unwrap_or_default();
    let numbers = text
        .split(' ')
        .filter(|n| !n.is_empty())
        .map(|n| n.parse::<f64>());
    let numbers: Vec<f64> = numbers.collect::<Result<_, _>>().ok()?;
    let points = numbers.chunks(2).map(|p| match p {
        [x, y] if x.is_finite() && y.is_finite() => Some(DVec2::new(*x, *y)),
        _ => None,
    });
    Some(Polyline {
        kind,
        points_m: points.collect::<Option<_>>()?,
    })
}

/// FNV-1a of 64 bits (Fowler, Noll and Vo 1991), as hexadecimal digits.
fn check_sum(text: &str) -> String {
    let hash = text.bytes().fold(0xcbf2_9ce4_8422_2325_u64, |hash, byte| {
        (hash ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3)
    });
    format!("{hash:016x}")
}
