//! A radar scan as nuScenes keeps it: a `.pcd` file of 18 fields (nuscenes-devkit, `RadarPointCloud.from_file`).

use glam::DVec3;

use scene::{RadarPattern, RadarReturn, RadarScan};

/// The fields: name, bytes, type (`F` floating point, `I` signed).
const FIELDS: [(&str, u8, char); 18] = [
    ("x", 4, 'F'),
    ("y", 4, 'F'),
    ("z", 4, 'F'),
    ("dyn_prop", 1, 'I'),
    ("id", 2, 'I'),
    ("rcs", 4, 'F'),
    ("vx", 4, 'F'),
    ("vy", 4, 'F'),
    ("vx_comp", 4, 'F'),
    ("vy_comp", 4, 'F'),
    ("is_quality_valid", 1, 'I'),
    ("ambig_state", 1, 'I'),
    ("x_rms", 1, 'I'),
    ("y_rms", 1, 'I'),
    ("invalid_state", 1, 'I'),
    ("pdh0", 1, 'I'),
    ("vx_rms", 1, 'I'),
    ("vy_rms", 1, 'I'),
];
/// Speeds over the ground below which a target counts as standing, m/s.
const STANDS_MPS: f32 = 0.3;
/// Codes of the field `dyn_prop`.
const MOVING: u8 = 0;
const STATIONARY: u8 = 1;
const ONCOMING: u8 = 2;
/// Code of `ambig_state` for a speed without doubt, which readers keep.
const UNAMBIGUOUS: u8 = 3;
/// Code of an accuracy that is not told.
const UNTOLD: u8 = 31;
/// Code of `pdh0` for the most certain returns.
const CERTAIN: u8 = 1;

/// The file of a scan in the ego frame: returns in the frame of the sensor, speeds as vectors along the ray. A scan without returns
/// has one that is NaN, by which readers know it.
pub fn to_bytes(scan: &RadarScan, radar: &RadarPattern) -> Vec<u8> {
    let count = scan.returns.len().max(1);
    let list = |of: fn(&(&str, u8, char)) -> String| FIELDS.iter().map(of).collect::<Vec<_>>().join(" ");
    let mut out = format!(
        "# .PCD v0.7 - Point Cloud Data file format\nVERSION 0.7\nFIELDS {}\nSIZE {}\nTYPE {}\nCOUNT {}\nWIDTH {count}\nHEIGHT 1\nVIEWPOINT 0 0 0 1 0 0 0\nPOINTS {count}\nDATA binary\n",
        list(|f| f.0.to_owned()),
        list(|f| f.1.to_string()),
        list(|f| f.2.to_string()),
        list(|_| "1".to_owned()),
    )
    .into_bytes();
    let sensor_from_ego = radar.ego_from_sensor().inverse();
    for (id, one) in scan.returns.iter().enumerate() {
        let at = sensor_from_ego.apply(DVec3::from_array(one.position_m.map(f64::from)));
        row(at.as_vec3().to_array(), id, one, &mut out);
    }
    if scan.returns.is_empty() {
        out.extend([f32::NAN; 3].into_iter().flat_map(f32::to_le_bytes));
        let rest: usize = FIELDS[3..].iter().map(|f| usize::from(f.1)).sum();
        out.extend(std::iter::repeat_n(0, rest));
    }
    // The devkit wants a byte behind the last row.
    out.push(b'\n');
    out
}

fn row([x, y, z]: [f32; 3], id: usize, one: &RadarReturn, out: &mut Vec<u8>) {
    let (sin, cos) = one.azimuth_rad.sin_cos();
    let along = |speed: f32| [speed * cos, speed * sin];
    let ([vx, vy], [vx_comp, vy_comp]) = (along(one.speed_mps), along(one.speed_over_ground_mps));
    let moves = match one.speed_over_ground_mps {
        v if v.abs() < STANDS_MPS => STATIONARY,
        v if v < 0.0 => ONCOMING,
        _ => MOVING,
    };
    out.extend([x, y, z].into_iter().flat_map(f32::to_le_bytes));
    out.push(moves);
    out.extend((id as i16).to_le_bytes());
    let numbers = [one.rcs_dbsm, vx, vy, vx_comp, vy_comp];
    out.extend(numbers.into_iter().flat_map(f32::to_le_bytes));
    out.extend([1, UNAMBIGUOUS, UNTOLD, UNTOLD, 0, CERTAIN, UNTOLD, UNTOLD]);
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::table_tests::radar_return;
    use scene::SensorRig;

    #[test]
    fn rows_are_43_bytes_behind_a_header_of_eleven_lines() {
        let rig = SensorRig::default();
        let radar = &rig.radars[1];
        let scan = RadarScan {
            radar: radar.name.clone(),
            returns: vec![radar_return(radar, 20.0, -8.0); 3],
        };
        let bytes = to_bytes(&scan, radar);
        let end = bytes
            .windows(12)
            .position(|w| w == b"DATA binary\n")
            .expect("a header")
            + 12;
        let header = std::str::from_utf8(&bytes[..end]).expect("text");
        assert_eq!(header.lines().count(), 11);
        assert!(header.contains("WIDTH 3\nHEIGHT 1\n"));
        assert_eq!(bytes.len() - end, 3 * 43 + 1);
        let f32_at = |at: usize| f32::from_le_bytes(bytes[end + at..][..4].try_into().expect("four"));
        // Straight ahead of a radar that looks to the left.
        assert!((f32_at(0) - 20.0).abs() < 1e-4 && f32_at(4).abs() < 1e-4 && f32_at(8).abs() < 1e-4);
        assert_eq!((bytes[end + 12], f32_at(15), f32_at(19)), (ONCOMING, 10.0, -8.0));
        let none = to_bytes(&RadarScan::default(), radar);
        assert!(
            none.len() == end + 44 && f32::from_le_bytes(none[end..][..4].try_into().expect("four")).is_nan()
        );
    }
}
