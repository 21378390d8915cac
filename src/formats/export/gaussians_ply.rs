//! A scene as Gaussians in the PLY that splat viewers read: the layout of Kerbl et al. 2023 (arXiv 2308.04079), with class,
//! instance and LiDAR strength after it.

use scene::truth::class_names;
use scene::{GaussianScene, SceneGaussian};

use super::{ExportSpan, Exporter, OutFile, Product};
use crate::Holds;
use crate::recipe::{NAME, Recipe};

/// See [`to_bytes`].
pub const EXPORTER: Exporter = Exporter {
    id: "gaussians-ply",
    title: "Splats: 3-D Gaussians, PLY, ego frame, with class, instance, LiDAR strength",
    file_name: Some("scene_gaussians.ply"),
    holds: &[Holds::Pictures],
    lost: "",
    span: ExportSpan::Moment,
    needs: &[Product::Gaussians],
    write: |_, products| {
        let gaussians = products.gaussians()?;
        let bytes = to_bytes(&gaussians, products.recipe());
        Ok(vec![OutFile::new("scene_gaussians.ply", bytes)])
    },
};

/// The properties of a Gaussian in order, all but the last three `float`.
const FLOATS: [&str; 17] = [
    "x", "y", "z", "nx", "ny", "nz", "f_dc_0", "f_dc_1", "f_dc_2", "opacity", "scale_0", "scale_1",
    "scale_2", "rot_0", "rot_1", "rot_2", "rot_3",
];

/// Binary little-endian PLY. Of each Gaussian: x, y, z in the ego frame, m; its normal, along the shortest axis; coefficients of
/// the spherical harmonic of degree 0 (sRGB colour = 0.5 + 0.28209479 f); the logit of its opacity; logarithms of its three
/// standard deviations in m; its quaternion w, x, y, z. Then class (as in truth maps), the box it belongs to, 0 for none, and
/// the strength of a LiDAR's echo. Names of classes and the recipe are comments.
pub fn to_bytes(scene: &GaussianScene, recipe: &Recipe) -> Vec<u8> {
    let names = class_names();
    let classes: String = names
        .iter()
        .enumerate()
        .map(|(id, name)| format!("comment class {id} {name}\n"))
        .collect();
    let floats: String = FLOATS
        .iter()
        .map(|name| format!("property float {name}\n"))
        .collect();
    let b = &scene.baking;
    let mut out = format!(
        "ply\nformat binary_little_endian 1.0\ncomment frame ego: x forward, y left, z up, m\n\
         comment baked from {} pictures of {} x {} px at {} places, {} samples, {} rounds\ncomment {NAME} {}\n\
         {classes}element vertex {}\n{floats}property uchar class\nproperty uint instance\nproperty float strength\nend_header\n",
        b.views,
        b.size_px[0],
        b.size_px[1],
        b.stands,
        b.samples,
        b.rounds,
        recipe.to_json(),
        scene.gaussians.len()
    )
    .into_bytes();
    out.reserve(scene.gaussians.len() * (4 * FLOATS.len() + 9));
    for g in &scene.gaussians {
        let numbers = g.position_m.into_iter().chain(normal(g)).chain(g.sh0());
        let numbers = numbers.chain([logit(g.opacity)]);
        let numbers = numbers.chain(g.std_m.map(f32::ln)).chain(g.rotation_wxyz);
        out.extend(numbers.flat_map(f32::to_le_bytes));
        out.push(g.class);
        out.extend(g.instance.to_le_bytes());
        out.extend(g.strength.to_le_bytes());
    }
    out
}

/// The shortest axis.
fn normal(g: &SceneGaussian) -> [f32; 3] {
    let [w, x, y, z] = g.rotation_wxyz;
    let turn = glam::Quat::from_xyzw(x, y, z, w);
    let [a, b, c] = g.std_m;
    let axis = match (a <= b && a <= c, b <= c) {
        (true, _) => glam::Vec3::X,
        (false, true) => glam::Vec3::Y,
        (false, false) => glam::Vec3::Z,
    };
    (turn * axis).to_array()
}

/// The logarithm of the odds, finite for 0 and 1 too.
fn logit(p: f32) -> f32 {
    let p = p.clamp(1e-6, 1.0 - 1e-6);
    (p / (1.0 - p)).ln()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::table_tests::two_gaussians;

    /// Reads a PLY of this layout back, by name.
    fn vertices(bytes: &[u8]) -> Vec<std::collections::BTreeMap<String, f64>> {
        let end = b"end_header\n";
        let at = bytes.windows(end.len()).position(|w| w == end).expect("a header") + end.len();
        let header = std::str::from_utf8(&bytes[..at]).expect("text");
        let mut count = 0;
        let mut properties = Vec::new();
        for line in header.lines() {
            let words: Vec<&str> = line.split(' ').collect();
            match words[..] {
                ["element", "vertex", n] => count = n.parse().expect("a count"),
                ["property", kind, name] => properties.push((kind.to_owned(), name.to_owned())),
                _ => {}
            }
        }
        let mut rest = &bytes[at..];
        let mut out = Vec::new();
        for _ in 0..count {
            let mut vertex = std::collections::BTreeMap::new();
            for (kind, name) in &properties {
                let value;
                (value, rest) = match kind.as_str() {
                    "uchar" => (f64::from(rest[0]), &rest[1..]),
                    "uint" => {
                        let (word, rest) = rest.split_first_chunk::<4>().expect("four bytes");
                        (f64::from(u32::from_le_bytes(*word)), rest)
                    }
                    _ => {
                        let (word, rest) = rest.split_first_chunk::<4>().expect("four bytes");
                        (f64::from(f32::from_le_bytes(*word)), rest)
                    }
                };
                vertex.insert(name.clone(), value);
            }
            out.push(vertex);
        }
        assert!(rest.is_empty());
        out
    }

    #[test]
    fn what_is_written_is_what_viewers_expect() {
        let scene = two_gaussians();
        let read = vertices(&to_bytes(&scene, &Recipe::default()));
        assert_eq!(read.len(), 2);
        for (g, v) in scene.gaussians.iter().zip(&read) {
            let near = |name: &str, value: f32| {
                let got = v[name];
                assert!((got - f64::from(value)).abs() < 1e-5, "{name}: {got} {value}");
            };
            for (i, axis) in ["x", "y", "z"].into_iter().enumerate() {
                near(axis, g.position_m[i]);
            }
            for i in 0..3 {
                assert!((v[&format!("scale_{i}")].exp() - f64::from(g.std_m[i])).abs() < 1e-6);
                let color = 0.5 + 0.282_094_79 * v[&format!("f_dc_{i}")];
                assert!((color - f64::from(g.color[i])).abs() < 1e-6);
            }
            for i in 0..4 {
                near(&format!("rot_{i}"), g.rotation_wxyz[i]);
            }
            let alpha = 1.0 / (1.0 + (-v["opacity"]).exp());
            assert!((alpha - f64::from(g.opacity)).abs() < 1e-6);
            assert_eq!(v["class"], f64::from(g.class));
            assert_eq!(v["instance"], f64::from(g.instance));
            near("strength", g.strength);
        }
        // The first is a disc that lies on the ground, turned about the vertical.
        assert!((read[0]["nz"].abs() - 1.0).abs() < 1e-6);
    }

    #[test]
    fn nothing_at_all_is_a_sound_file_too() {
        assert!(vertices(&to_bytes(&GaussianScene::default(), &Recipe::default())).is_empty());
    }
}
