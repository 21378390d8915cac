//! A scene as coloured anisotropic Gaussians: the result of baking a scene, and the contents of splat files.

use glam::DQuat;

use super::Pose;
use super::truth::TruthClass;

/// Factor of the spherical harmonic of degree 0: colour = 0.5 + this * coefficient.
pub const SH_C0: f32 = 0.282_094_79;

/// One Gaussian: a place, an ellipsoid around it and a colour that is the same from everywhere.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SceneGaussian {
    /// Centre, m.
    pub position_m: [f32; 3],
    /// From the ellipsoid's axes to the frame of the position: a unit quaternion w, x, y, z.
    pub rotation_wxyz: [f32; 4],
    /// Standard deviations along its axes, m; above 0.
    pub std_m: [f32; 3],
    /// Alpha at the centre, above 0 and below 1.
    pub opacity: f32,
    /// sRGB-coded colour, red, green, blue: 0 to 1 is what a screen shows, and it may lie a little outside, since pictures are
    /// sums of such colours.
    pub color: [f32; 3],
    /// Class of the surface that it shows.
    pub class: TruthClass,
    /// The box it belongs to; 0 where it belongs to none.
    pub instance: u32,
    /// Strength of a LiDAR's echo at normal incidence from 10 m, 0 to 255; 0 for the sky.
    pub strength: f32,
}

impl SceneGaussian {
    /// Coefficients of the spherical harmonic of degree 0, red, green, blue.
    pub fn sh0(&self) -> [f32; 3] {
        self.color.map(|c| (c - 0.5) / SH_C0)
    }

    /// True if every number is finite, the spreads and the opacity lie within their bounds and the quaternion is a unit.
    pub fn is_sound(&self) -> bool {
        let numbers = [&self.position_m[..], &self.rotation_wxyz, &self.color];
        let finite = numbers.iter().all(|n| n.iter().all(|v| v.is_finite()));
        let length = self.rotation_wxyz.iter().map(|v| v * v).sum::<f32>();
        finite
            && self.std_m.iter().all(|s| *s > 0.0 && s.is_finite())
            && self.opacity > 0.0
            && self.opacity < 1.0
            && (length - 1.0).abs() < 1e-3
            && (0.0..=255.0).contains(&self.strength)
    }
}

/// How Gaussians were made of a scene.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Baking {
    /// Places from which the scene was looked at.
    pub stands: u32,
    /// Pictures taken there.
    pub views: u32,
    /// Size of each, px.
    pub size_px: [u32; 2],
    /// Hits of rays on surfaces, skyline and sky.
    pub samples: u64,
    /// Most Gaussians that were allowed.
    pub most: u32,
    /// Steps in which they were fitted to the pictures.
    pub rounds: u32,
}

/// A scene as Gaussians, all in one frame: x forward, y left, z up, m.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct GaussianScene {
    /// The Gaussians, by instance, then by class.
    pub gaussians: Vec<SceneGaussian>,
    /// How they were made.
    pub baking: Baking,
}

impl GaussianScene {
    /// Gives the Gaussians in another frame.
    pub fn place(&mut self, outer_from_inner: &Pose) {
        if *outer_from_inner == Pose::IDENTITY {
            return;
        }
        for g in &mut self.gaussians {
            let p = glam::Vec3::from(g.position_m).as_dvec3();
            g.position_m = outer_from_inner.apply(p).as_vec3().to_array();
            let [w, x, y, z] = g.rotation_wxyz.map(f64::from);
            let q = (outer_from_inner.rotation * DQuat::from_xyzw(x, y, z, w)).normalize();
            g.rotation_wxyz = [q.w, q.x, q.y, q.z].map(|v| v as f32);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn another_frame_moves_and_turns_them() {
        let disc = SceneGaussian {
            position_m: [1.0, 0.0, 2.0],
            rotation_wxyz: [1.0, 0.0, 0.0, 0.0],
            std_m: [0.5, 0.1, 0.01],
            opacity: 0.9,
            color: [0.75, 0.5, 0.25],
            class: 4,
            instance: 7,
            strength: 8.0,
        };
        assert!(disc.is_sound());
        let mut scene = GaussianScene {
            gaussians: vec![disc],
            ..GaussianScene::default()
        };
        scene.place(&Pose::planar(10.0, -4.0, std::f64::consts::FRAC_PI_2));
        let placed = scene.gaussians[0];
        let near = |a: &[f32], b: &[f32]| a.iter().zip(b).all(|(a, b)| (a - b).abs() < 1e-5);
        assert!(near(&placed.position_m, &[10.0, -3.0, 2.0]), "{placed:?}");
        let half = std::f32::consts::FRAC_1_SQRT_2;
        assert!(near(&placed.rotation_wxyz, &[half, 0.0, 0.0, half]), "{placed:?}");
        let back = placed.sh0().map(|f| 0.5 + SH_C0 * f);
        assert!(near(&back, &disc.color) && placed.is_sound());
        for bad in [
            SceneGaussian {
                std_m: [0.0, 1.0, 1.0],
                ..disc
            },
            SceneGaussian { opacity: 1.0, ..disc },
            SceneGaussian {
                position_m: [f32::NAN, 0.0, 0.0],
                ..disc
            },
            SceneGaussian {
                rotation_wxyz: [2.0, 0.0, 0.0, 0.0],
                ..disc
            },
        ] {
            assert!(!bad.is_sound(), "{bad:?}");
        }
    }
}
