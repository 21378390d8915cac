//! A LiDAR sweep as LAS or LAZ (ASPRS LAS 1.4, point format 6) for surveying and GIS programs.

use std::io::Cursor;

use glam::{DVec2, DVec3};
use laz::{LasZipCompressor, LazVlr, LazVlrBuilder};
use scene::{LidarPoint, LidarSweep, Scene};

use super::pcd::physical_sweep;
use super::{ExportSpan, Exporter, OutFile, Product, Products};
use crate::las::{CLASS_FIELD, RING_FIELD, SOFTWARE, asprs_of, record_length};
use crate::{FormatError, Holds};

/// LAS without compression; see [`to_bytes`].
pub const EXPORTER: Exporter = Exporter {
    id: "las",
    title: "LiDAR: LAS 1.4 for GIS, ego frame, with ASPRS and Occ3D class, intensity, ring, time",
    file_name: Some("lidar.las"),
    holds: &[Holds::Points],
    lost: "single points: they come back as voxels with the class of most of them",
    span: ExportSpan::Moment,
    needs: &[Product::Sweep],
    write: |scene, products| write(scene, products, "lidar.las", false),
};

/// LAZ: LAS with compression; see [`to_bytes`].
pub const PACKED: Exporter = Exporter {
    id: "laz",
    title: "LiDAR: LAZ, the same as LAS compressed",
    file_name: Some("lidar.laz"),
    holds: &[Holds::Points],
    lost: "single points: they come back as voxels with the class of most of them",
    span: ExportSpan::Moment,
    needs: &[Product::Sweep],
    write: |scene, products| write(scene, products, "lidar.laz", true),
};

fn write(
    scene: &Scene,
    products: &mut dyn Products,
    name: &str,
    is_packed: bool,
) -> Result<Vec<OutFile>, FormatError> {
    let sweep = physical_sweep(scene, products)?;
    let relief = &scene.frame().layout.relief;
    let bytes = to_bytes(&sweep, is_packed, &|at| relief.height_m(at))?;
    Ok(vec![OutFile::new(name, bytes)])
}

const HEADER: usize = 375;
const FORMAT: u8 = 6;
/// Smallest step of a coordinate, m.
const STEP_M: f64 = 0.001;
/// Class (u8) and ring (u16).
const EXTRA: u16 = 3;
const DESCRIPTION: usize = 192;

/// LAS 1.4, point format 6: x, y, z in the ego frame in m, in steps of 1 mm; intensity (0 to 255 times 256), classification of
/// the standard ([`asprs_of`]), GPS time as the time in s (0 at the end of the sweep, before it less), and two extra bytes
/// fields: `occ3d_class` and `ring`. No coordinate system is named: the frame is the vehicle's. `ground_m` is the height of the
/// ground. Points in the order of the sweep. Errors if a point is farther than 2000 km away.
pub fn to_bytes(
    sweep: &LidarSweep,
    is_packed: bool,
    ground_m: &dyn Fn(DVec2) -> f64,
) -> Result<Vec<u8>, FormatError> {
    let length = record_length(FORMAT).unwrap_or_default() + usize::from(EXTRA);
    let mut points = Vec::with_capacity(sweep.points.len() * length);
    let (mut low, mut high) = ([i32::MAX; 3], [i32::MIN; 3]);
    for p in &sweep.points {
        let steps = put(&mut points, p, ground_m)?;
        (0..3).for_each(|i| {
            (low[i], high[i]) = (low[i].min(steps[i]), high[i].max(steps[i]));
        });
    }
    if sweep.points.is_empty() {
        (low, high) = ([0; 3], [0; 3]);
    }
    let mut records = vec![(*b"LASF_Spec\0\0\0\0\0\0\0", 4, "Extra bytes", descriptions())];
    let laszip = match is_packed {
        true => {
            let vlr = LazVlrBuilder::default().with_point_format(FORMAT, EXTRA);
            Some(vlr.map_err(|e| FormatError::new(e.to_string()))?.build())
        }
        false => None,
    };
    if let Some(vlr) = &laszip {
        let mut data = Vec::new();
        vlr.write_to(&mut data).map_err(FormatError::new)?;
        let mut user = [0; 16];
        user[..LazVlr::USER_ID.len()].copy_from_slice(LazVlr::USER_ID.as_bytes());
        records.push((user, LazVlr::RECORD_ID, LazVlr::DESCRIPTION, data));
    }
    let body = HEADER
        + records
            .iter()
            .map(|(_, _, _, data)| 54 + data.len())
            .sum::<usize>();

    let mut out = Vec::with_capacity(body + points.len());
    out.extend(b"LASF");
    out.extend([0, 0]); // file source
    out.extend(0b1_0000u16.to_le_bytes()); // coordinate systems would be WKT; time is not that of GPS
    out.extend([0; 16]); // project
    out.extend([1, 4]);
    out.extend(padded::<32>("simulated LiDAR"));
    out.extend(padded::<32>(&format!("{SOFTWARE} {}", env!("CARGO_PKG_VERSION"))));
    out.extend([0; 4]); // no date: equal scenes give equal bytes
    out.extend((HEADER as u16).to_le_bytes());
    out.extend((body as u32).to_le_bytes());
    out.extend((records.len() as u32).to_le_bytes());
    out.push(FORMAT | if is_packed { 0x80 } else { 0 });
    out.extend((length as u16).to_le_bytes());
    out.extend([0; 24]); // counts of old versions
    out.extend([STEP_M; 3].into_iter().flat_map(f64::to_le_bytes));
    out.extend([0.0f64; 3].into_iter().flat_map(f64::to_le_bytes));
    for i in 0..3 {
        out.extend(
            [high[i], low[i]]
                .into_iter()
                .flat_map(|v| (f64::from(v) * STEP_M).to_le_bytes()),
        );
    }
    out.extend([0; 20]); // no waveforms, no extended records
    out.extend((sweep.points.len() as u64).to_le_bytes());
    out.extend((sweep.points.len() as u64).to_le_bytes()); // all are first returns
    out.extend([0; 14 * 8]);
    for (user, id, title, data) in records {
        out.extend([0, 0]);
        out.extend(user);
        out.extend(id.to_le_bytes());
        out.extend((data.len() as u16).to_le_bytes());
        out.extend(padded::<32>(title));
        out.extend(data);
    }
    let Some(vlr) = laszip else {
        out.extend(points);
        return Ok(out);
    };
    let mut to = Cursor::new(out);
    to.set_position(body as u64);
    let mut packer = LasZipCompressor::new(to, vlr).map_err(|e| FormatError::new(e.to_string()))?;
    packer.compress_many(&points).map_err(FormatError::new)?;
    packer.done().map_err(FormatError::new)?;
    Ok(packer.into_inner().into_inner())
}

/// Appends a point; returns its coordinates in steps.
fn put(out: &mut Vec<u8>, p: &LidarPoint, ground_m: &dyn Fn(DVec2) -> f64) -> Result<[i32; 3], FormatError> {
    let at_m = DVec3::from_array(p.position_in_ego.map(f64::from));
    let steps = (at_m / STEP_M).round();
    if !steps.is_finite() || steps.abs().max_element() >= f64::from(i32::MAX) {
        return Err(FormatError::new(format!(
            "a point at {at_m} m, expected one within 2000 km"
        )));
    }
    let steps = steps.to_array().map(|v| v as i32);
    out.extend(steps.into_iter().flat_map(i32::to_le_bytes));
    out.extend(((p.intensity.clamp(0.0, 255.0) * 256.0).round() as u16).to_le_bytes());
    out.push(0x11); // first return of one
    out.push(0); // no flags, channel 0
    out.push(asprs_of(p.class, at_m.z - ground_m(at_m.truncate())));
    out.push(0); // user data
    out.extend([0; 4]); // scan angle, point source
    out.extend(f64::from(p.time_s).to_le_bytes());
    out.push(p.class.id());
    out.extend(p.ring.to_le_bytes());
    Ok(steps)
}

/// The two descriptions of extra bytes.
fn descriptions() -> Vec<u8> {
    let mut out = Vec::new();
    for (kind, name, text) in [
        (1u8, CLASS_FIELD, "class of Occ3D, 0 to 17"),
        (3, RING_FIELD, "beam, 0 is the lowest"),
    ] {
        let mut one = vec![0; DESCRIPTION];
        one[2] = kind;
        one[4..36].copy_from_slice(&padded::<32>(name));
        one[160..].copy_from_slice(&padded::<32>(text));
        out.extend(one);
    }
    out
}

/// Text with zeros after it; text that is too long is cut.
fn padded<const N: usize>(text: &str) -> [u8; N] {
    let mut out = [0; N];
    let length = text.len().min(N - 1);
    out[..length].copy_from_slice(&text.as_bytes()[..length]);
    out
}
