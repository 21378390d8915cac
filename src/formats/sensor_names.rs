//! Names of sensors in files: names that folders and topics may have, none of them twice.

use scene::SensorRig;
use scene::plain_name::folded;

use crate::export::OutFile;

/// Name of the LiDAR.
pub const LIDAR: &str = "LIDAR_TOP";

/// Names of the rig's cameras in its order: letters, digits, `-` and `_`; a name that is taken gets a number.
pub fn cameras(rig: &SensorRig) -> Vec<String> {
    none_twice(rig.cameras.iter().map(|c| tidy(&c.name, "CAM")), &[LIDAR])
}

/// Names of the rig's radars in its order, by the same rules.
pub fn radars(rig: &SensorRig) -> Vec<String> {
    let others = cameras(rig);
    let taken: Vec<&str> = others.iter().map(String::as_str).chain([LIDAR]).collect();
    none_twice(rig.radars.iter().map(|r| tidy(&r.name, "RADAR")), &taken)
}

/// Beginning of the names of a camera's files: the camera's name in letters and digits of any language, `-`, `_` and
/// `.`. It gets a number if a camera before it in the rig has the same name.
pub fn of_file(rig: &SensorRig, camera: &str) -> String {
    let tidy = |name: &str| OutFile::new(name, Vec::new()).name;
    let place = rig.cameras.iter().position(|c| c.name == camera);
    let mut all = none_twice(rig.cameras.iter().map(|c| tidy(&c.name)), &[]);
    place.map_or_else(|| tidy(camera), |i| all.swap_remove(i))
}

/// Adds numbers to names that are there already, the case of letters aside.
fn none_twice(names: impl Iterator<Item = String>, taken: &[&str]) -> Vec<String> {
    let mut out: Vec<String> = Vec::new();
    for tidy in names {
        let mut name = tidy.clone();
        let mut number = 2;
        let is_taken = |name: &str| {
            let mut taken = out.iter().map(String::as_str).chain(taken.iter().copied());
            taken.any(|taken| folded(taken) == folded(name))
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
        let files: Vec<String> = rig.cameras.iter().map(|c| of_file(&rig, &c.name)).collect();
        assert_eq!(files, ["CAM_FRONT", "a_b", "a.b", "", "cam_front_2", "LIDAR_TOP"]);
        let rig = SensorRig {
            cameras: ["a b", "a_b", "前"].map(|name| Camera::new(name, 90.0)).to_vec(),
            ..SensorRig::default()
        };
        assert_eq!(
            ["a b", "a_b", "前", "x y"].map(|name| of_file(&rig, name)),
            ["a_b", "a_b_2", "前", "x_y"]
        );
    }
}
