//! What sensors are called in files: names that folders and topics may have, and none twice.

use scene::SensorRig;

/// What the LiDAR is called.
pub const LIDAR: &str = "LIDAR_TOP";

/// Names of the rig's cameras in its order: letters, digits, `-` and `_`; what was not free gets a number.
pub fn cameras(rig: &SensorRig) -> Vec<String> {
    let mut out: Vec<String> = Vec::new();
    for camera in &rig.cameras {
        let tidy = tidy(&camera.name, "CAM");
        let mut name = tidy.clone();
        let mut number = 2;
        let is_taken = |name: &str| {
            let mut taken = out.iter().map(String::as_str).chain([LIDAR]);
            taken.any(|taken| taken.eq_ignore_ascii_case(name))
        };
        while is_taken(&name) {
            name = format!("{tidy}_{number}");
            number += 1;
        }
        out.push(name);
    }
    out
}

fn tidy(name: &str, or: &str) -> String {
    let one = |c: char| match c.is_ascii_alphanumeric() || c == '-' || c == '_' {
        true => c,
        false => '_',
    };
    match name.chars().take(60).map(one).collect::<String>() {
        empty if empty.is_empty() => or.to_owned(),
        name => name,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use scene::Camera;

    #[test]
    fn names_are_tidy_and_their_own() {
        let rig = SensorRig {
            cameras: ["CAM_FRONT", "a/b", "a.b", "", "cam_front", "LIDAR_TOP"]
                .map(|name| Camera::new(name, 90.0))
                .to_vec(),
            ..SensorRig::default()
        };
        let expected = ["CAM_FRONT", "a_b", "a_b_2", "CAM", "cam_front_2", "LIDAR_TOP_2"];
        assert_eq!(cameras(&rig), expected);
    }
}
