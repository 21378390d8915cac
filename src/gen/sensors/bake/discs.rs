//! From the samples of a cell to a Gaussian: a flat disc along the surface, sized by how they spread.

use glam::{DMat3, DQuat, DVec3, Quat, Vec3};

use super::samples::SurfaceSample;
use super::tree::Leaf;

/// Standard deviation of a Gaussian over that of its samples: neighbours overlap and leave no gaps.
const WIDER: f64 = 1.7;
/// Weight of the cell's own shape, in samples.
const PRIOR: f64 = 3.0;
/// Largest area of a Gaussian over that of its pixels: more than 1, so that other views do not see through.
const OVERLAP: f64 = 1.5;
/// Least standard deviation of a Gaussian, m.
const THIN_M: f64 = 0.003;

/// Place, turn and spread of a Gaussian.
pub(super) struct Disc {
    pub position_m: Vec3,
    pub rotation: Quat,
    pub std_m: Vec3,
    pub normal: Vec3,
}

/// The disc of a leaf.
pub(super) fn disc(samples: &[SurfaceSample], leaf: &Leaf) -> Disc {
    let n = samples.len().max(1) as f64;
    let mean = samples.iter().map(|s| s.at.as_dvec3()).sum::<DVec3>() / n;
    let normal = samples.iter().map(|s| Vec3::from(s.normal.map(f32::from)));
    let normal = normal.sum::<Vec3>().as_dvec3().normalize_or(DVec3::Z);
    let mut covariance = DMat3::ZERO;
    for s in samples {
        let d = s.at.as_dvec3() - mean;
        covariance += DMat3::from_cols(d * d.x, d * d.y, d * d.z);
    }
    let size_m = f64::from(leaf.size_m);
    let plane = DMat3::IDENTITY - DMat3::from_cols(normal * normal.x, normal * normal.y, normal * normal.z);
    // A disc is not larger than what its pixels show.
    let area_m2 = samples.iter().map(|s| f64::from(s.area_m2)).sum::<f64>();
    let area_m2 = (OVERLAP * area_m2).min(size_m * size_m);
    covariance += plane * (PRIOR * area_m2 / 12.0);
    covariance *= WIDER * WIDER / (n + PRIOR);
    let (variances, axes) = principal(covariance);
    let least = (THIN_M * THIN_M).max(1e-4 * size_m * size_m);
    let std_m = variances.map(|v| v.max(least).sqrt());
    Disc {
        position_m: mean.as_vec3(),
        rotation: DQuat::from_mat3(&axes).normalize().as_quat(),
        std_m: std_m.as_vec3(),
        normal: normal.as_vec3(),
    }
}

/// Eigenvalues and eigenvectors (columns, a right-handed frame) of a symmetric matrix, by Jacobi's rotations.
fn principal(m: DMat3) -> (DVec3, DMat3) {
    let mut a = m.to_cols_array_2d();
    let mut v = DMat3::IDENTITY.to_cols_array_2d();
    for _ in 0..12 {
        for (p, q) in [(0, 1), (0, 2), (1, 2)] {
            let off = a[q][p];
            if off.abs() <= 1e-14 * (a[p][p].abs() + a[q][q].abs()) {
                continue;
            }
            let theta = (a[q][q] - a[p][p]) / (2.0 * off);
            let t = theta.signum() / (theta.abs() + (theta * theta + 1.0).sqrt());
            let t = if theta == 0.0 { 1.0 } else { t };
            let c = 1.0 / (t * t + 1.0).sqrt();
            let s = t * c;
            // Columns p and q of a and v, then rows of a.
            for matrix in [&mut a, &mut v] {
                let (x, y) = (matrix[p], matrix[q]);
                matrix[p] = [0, 1, 2].map(|k| c * x[k] - s * y[k]);
                matrix[q] = [0, 1, 2].map(|k| s * x[k] + c * y[k]);
            }
            for column in &mut a {
                let (x, y) = (column[p], column[q]);
                (column[p], column[q]) = (c * x - s * y, s * x + c * y);
            }
        }
    }
    let values = DVec3::new(a[0][0], a[1][1], a[2][2]);
    let mut axes = DMat3::from_cols_array_2d(&v);
    if axes.determinant() < 0.0 {
        axes.z_axis = -axes.z_axis;
    }
    (values, axes)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn principal_axes_give_the_matrix_back() {
        for i in 0..200 {
            let q = DQuat::from_euler(
                glam::EulerRot::ZYX,
                f64::from(i) * 0.37,
                f64::from(i) * 0.11,
                f64::from(i % 7) * 0.5,
            );
            let r = DMat3::from_quat(q);
            let d = DVec3::new(4.0, 1e-6 * f64::from(i % 3), 0.5 + f64::from(i % 2) * 3.5);
            let m = r * DMat3::from_diagonal(d) * r.transpose();
            let (values, axes) = principal(m);
            let back = axes * DMat3::from_diagonal(values) * axes.transpose();
            let error = (back - m)
                .to_cols_array()
                .into_iter()
                .fold(0.0f64, |a, v| a.max(v.abs()));
            assert!(error < 1e-9, "{i}: {error}");
            assert!((axes.determinant() - 1.0).abs() < 1e-9);
            assert!(
                (axes * axes.transpose() - DMat3::IDENTITY)
                    .to_cols_array()
                    .iter()
                    .all(|v| v.abs() < 1e-9)
            );
        }
    }

    #[test]
    fn samples_of_a_wall_make_a_flat_disc() {
        let leaf = Leaf {
            from: 0,
            to: 64,
            size_m: 0.4,
        };
        let samples: Vec<SurfaceSample> = (0..64)
            .map(|i| SurfaceSample {
                at: Vec3::new(5.0, 0.05 * (i % 8) as f32, 0.05 * (i / 8) as f32),
                width_m: 0.02,
                area_m2: 0.0025,
                rgb: [9; 3],
                is_edge: false,
                normal: [-127, 0, 0],
                group: 0,
            })
            .collect();
        let disc = disc(&samples, &leaf);
        assert!((disc.position_m - Vec3::new(5.0, 0.175, 0.175)).length() < 1e-5);
        let axes = [Vec3::X, Vec3::Y, Vec3::Z].map(|a| disc.rotation * a);
        let thin = (0..3)
            .min_by(|a, b| disc.std_m[*a].total_cmp(&disc.std_m[*b]))
            .expect("three");
        assert!(
            axes[thin].x.abs() > 0.999 && disc.std_m[thin] < 0.005,
            "{:?}",
            disc.std_m
        );
        for k in (0..3).filter(|k| *k != thin) {
            assert!(
                (disc.std_m[k] / (0.1155 * WIDER as f32) - 1.0).abs() < 0.06,
                "{:?}",
                disc.std_m
            );
        }
    }
}
