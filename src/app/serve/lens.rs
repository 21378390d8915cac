//! Lenses and shutters of the protocol and of rigs. Distances in the picture are counted from the upper left corner of the upper
//! left pixel, whose middle is at (0.5, 0.5).

use tonic::Status;

use crate::polynomial;
use crate::wire::{
    CameraParam, CameraSpec, Fisheye, Ftheta, FthetaPolynomial, LinearCde, Pinhole, ShutterType,
};
use scene::rig::Carried;
use scene::{Camera, Lens, ReadOut, Shutter};

/// Largest error, px, of a polynomial that is turned round.
const MOST_ERROR_PX: f64 = 0.5;

/// A camera of a rig as the protocol tells it.
pub fn spec_of(camera: &Camera) -> CameraSpec {
    let [fx, fy] = camera.focal_px;
    let [cx, cy] = camera.center_px;
    let pinhole = |k: &[f64], p: &[f64]| {
        CameraParam::Pinhole(Pinhole {
            principal_point_x: cx,
            principal_point_y: cy,
            focal_length_x: fx,
            focal_length_y: fy,
            radial_coeffs: k.to_vec(),
            tangential_coeffs: p.to_vec(),
            thin_prism_coeffs: vec![0.0; 4],
        })
    };
    let param = match &camera.lens {
        Lens::Pinhole => pinhole(&[0.0; 6], &[0.0; 2]),
        Lens::Distorted { k, p } => pinhole(k, p),
        Lens::Fisheye { k, max_angle_deg } => CameraParam::Fisheye(Fisheye {
            principal_point_x: cx,
            principal_point_y: cy,
            focal_length_x: fx,
            focal_length_y: fy,
            radial_coeffs: k.to_vec(),
            max_angle: max_angle_deg.to_radians(),
        }),
        Lens::FTheta { c, max_angle_deg } => {
            let forward: Vec<f64> = std::iter::once(0.0).chain(c.iter().map(|c| c * fy)).collect();
            let most_rad = max_angle_deg.to_radians();
            let px_of = |a: f64| polynomial::value(&forward, a);
            CameraParam::Ftheta(Ftheta {
                principal_point_x: cx,
                principal_point_y: cy,
                reference_poly: FthetaPolynomial::AngleToPixeldist.into(),
                pixeldist_to_angle_poly: polynomial::inverse(px_of, most_rad).coefficients,
                angle_to_pixeldist_poly: forward.clone(),
                max_angle: most_rad,
                linear_cde: Some(LinearCde {
                    linear_c: fx / fy,
                    linear_d: 0.0,
                    linear_e: 0.0,
                }),
            })
        }
    };
    CameraSpec {
        camera_param: Some(param),
        logical_id: camera.name.clone(),
        resolution_h: camera.height,
        resolution_w: camera.width,
        shutter_type: shutter_of(camera.shutter).into(),
        external_distortion: None,
    }
}

fn shutter_of(shutter: Option<Shutter>) -> ShutterType {
    match shutter.map(|s| s.direction) {
        None => ShutterType::Global,
        Some(ReadOut::TopToBottom) => ShutterType::RollingTopToBottom,
        Some(ReadOut::BottomToTop) => ShutterType::RollingBottomToTop,
        Some(ReadOut::LeftToRight) => ShutterType::RollingLeftToRight,
        Some(ReadOut::RightToLeft) => ShutterType::RollingRightToLeft,
    }
}

/// The order in which a rolling shutter reads; `None` for one that does not roll. Errors if the type is not one of the protocol's.
pub fn direction_of(shutter_type: i32) -> Result<Option<ReadOut>, Status> {
    let known = ShutterType::try_from(shutter_type)
        .map_err(|_| Status::invalid_argument(format!("shutter_type is {shutter_type}, expected 0 to 5")))?;
    Ok(match known {
        ShutterType::Unknown | ShutterType::Global => None,
        ShutterType::RollingTopToBottom => Some(ReadOut::TopToBottom),
        ShutterType::RollingBottomToTop => Some(ReadOut::BottomToTop),
        ShutterType::RollingLeftToRight => Some(ReadOut::LeftToRight),
        ShutterType::RollingRightToLeft => Some(ReadOut::RightToLeft),
    })
}

/// A camera at the origin with the lens and the size of a message, without shutter. `size` stands in for a size that the message
/// does not tell. Errors in one line if a number is bad or something is not supported.
pub fn camera_of(spec: &CameraSpec, size: [u32; 2]) -> Result<Camera, Status> {
    let own = [spec.resolution_w, spec.resolution_h];
    let [width, height] = if own.contains(&0) { size } else { own };
    if spec.external_distortion.is_some() {
        return Err(Status::unimplemented(
            "camera_intrinsics has a windshield model, expected none",
        ));
    }
    let Some(param) = &spec.camera_param else {
        return Err(Status::invalid_argument(
            "camera_intrinsics has no lens, expected ftheta_param, opencv_pinhole_param or opencv_fisheye_param",
        ));
    };
    let (lens, focal_px, center_px) = match param {
        CameraParam::Pinhole(p) => (
            pinhole(p)?,
            [p.focal_length_x, p.focal_length_y],
            [p.principal_point_x, p.principal_point_y],
        ),
        CameraParam::Fisheye(p) => (
            Lens::Fisheye {
                k: padded(&p.radial_coeffs, "opencv_fisheye_param.radial_coeffs")?,
                max_angle_deg: widest_deg(p.max_angle),
            },
            [p.focal_length_x, p.focal_length_y],
            [p.principal_point_x, p.principal_point_y],
        ),
        CameraParam::Ftheta(p) => {
            let corner = corner_px([p.principal_point_x, p.principal_point_y], [width, height]);
            let (lens, focal_px) = ftheta(p, corner)?;
            (lens, focal_px, [p.principal_point_x, p.principal_point_y])
        }
    };
    Ok(Camera {
        name: spec.logical_id.clone(),
        width,
        height,
        focal_px,
        center_px,
        rotation_wxyz: [1.0, 0.0, 0.0, 0.0],
        translation_m: [0.0; 3],
        lens,
        shutter: None,
        carried: Carried::default(),
    })
}

/// Coefficients of which those that are left out are 0.
fn padded<const N: usize>(found: &[f64], what: &str) -> Result<[f64; N], Status> {
    if found.len() > N && found[N..].iter().any(|c| *c != 0.0) {
        return Err(Status::invalid_argument(format!(
            "{what} has {} coefficients, expected at most {N}",
            found.len()
        )));
    }
    Ok(std::array::from_fn(|i| found.get(i).copied().unwrap_or(0.0)))
}

fn pinhole(p: &Pinhole) -> Result<Lens, Status> {
    if p.thin_prism_coeffs.iter().any(|s| *s != 0.0) {
        return Err(Status::unimplemented(
            "opencv_pinhole_param.thin_prism_coeffs are not 0, expected no thin prism",
        ));
    }
    let k = padded(&p.radial_coeffs, "opencv_pinhole_param.radial_coeffs")?;
    let t = padded(&p.tangential_coeffs, "opencv_pinhole_param.tangential_coeffs")?;
    Ok(match k == [0.0; 6] && t == [0.0; 2] {
        true => Lens::Pinhole,
        false => Lens::Distorted { k, p: t },
    })
}

/// The angle of a message, degrees; half a turn where it tells none.
fn widest_deg(max_angle: f64) -> f64 {
    if max_angle == 0.0 {
        180.0
    } else {
        max_angle.to_degrees()
    }
}

/// From the principal point to the farthest corner, px.
fn corner_px(center: [f64; 2], size: [u32; 2]) -> f64 {
    let side = |i: usize| center[i].abs().max((f64::from(size[i]) - center[i]).abs());
    side(0).hypot(side(1))
}

/// The part of a reach in the picture that lies within an angle, px; all of it if `max_angle` is 0.
fn seen_px(angle_of: impl Fn(f64) -> f64, reach_px: f64, max_angle: f64) -> f64 {
    const STEPS: usize = 1000;
    let at = |i: usize| reach_px * i as f64 / STEPS as f64;
    let beyond = (1..=STEPS).find(|i| max_angle > 0.0 && angle_of(at(*i)) >= max_angle);
    beyond.map_or(reach_px, at)
}

/// Lens and focal lengths of an f-theta message; the picture reaches `corner_px` from the principal point.
fn ftheta(p: &Ftheta, corner_px: f64) -> Result<(Lens, [f64; 2]), Status> {
    let linear = p.linear_cde.unwrap_or(LinearCde {
        linear_c: 1.0,
        linear_d: 0.0,
        linear_e: 0.0,
    });
    // (a message that tells 0 for all of them tells nothing)
    let c = match linear.linear_c == 0.0 && linear.linear_d == 0.0 && linear.linear_e == 0.0 {
        true => 1.0,
        false => linear.linear_c,
    };
    if linear.linear_d != 0.0 || linear.linear_e != 0.0 {
        return Err(Status::unimplemented(format!(
            "ftheta_param.linear_cde has d {} and e {}, expected pixels without shear",
            linear.linear_d, linear.linear_e
        )));
    }
    if !corner_px.is_finite() {
        return Err(Status::invalid_argument(
            "ftheta_param has a principal point that is not finite",
        ));
    }
    let backward = p.reference_poly == i32::from(FthetaPolynomial::PixeldistToAngle)
        || p.angle_to_pixeldist_poly.len() < 2;
    let forward = match backward {
        true => {
            let given = &p.pixeldist_to_angle_poly;
            if given.len() < 2 || given.iter().any(|k| !k.is_finite()) {
                return Err(Status::invalid_argument(
                    "ftheta_param has no polynomial of finite numbers, expected two or more coefficients",
                ));
            }
            let angle_of = |r: f64| polynomial::value(given, r);
            let reach_px = seen_px(angle_of, corner_px / c.abs().min(1.0), p.max_angle);
            let fit = polynomial::inverse(angle_of, reach_px);
            // Written so that NaN fails too.
            let fits = fit.error <= MOST_ERROR_PX;
            if !fits {
                return Err(Status::invalid_argument(format!(
                    "ftheta_param.pixeldist_to_angle_poly turned round is off by {:.2} px, expected at most {MOST_ERROR_PX}",
                    fit.error
                )));
            }
            fit.coefficients
        }
        false => p.angle_to_pixeldist_poly.clone(),
    };
    if forward[0].abs() > 1e-6 {
        return Err(Status::invalid_argument(format!(
            "ftheta_param's polynomial begins with {}, expected 0",
            forward[0]
        )));
    }
    let px: [f64; 6] = padded(&forward[1..], "ftheta_param.angle_to_pixeldist_poly")?;
    let focal = px[0];
    let sound = [focal, c].iter().all(|v| *v > 0.0 && v.is_finite());
    if !sound {
        return Err(Status::invalid_argument(format!(
            "ftheta_param has {focal} px per rad in the middle and linear_c {c}, expected both above 0"
        )));
    }
    let lens = Lens::FTheta {
        c: px.map(|k| k / focal),
        max_angle_deg: widest_deg(p.max_angle),
    };
    Ok((lens, [focal * c, focal]))
}

#[cfg(test)]
mod tests {
    use glam::{DVec2, DVec3};

    use super::*;
    use scene::Optics;

    fn camera(lens: Lens) -> Camera {
        Camera {
            lens,
            center_px: [790.0, 455.0],
            ..Camera::new("CAM", 100.0)
        }
    }

    fn lenses() -> [Lens; 4] {
        [
            Lens::Pinhole,
            Lens::Distorted {
                k: [-0.3, 0.1, -0.02, 0.0, 0.0, 0.0],
                p: [3e-4, -2e-4],
            },
            Lens::Fisheye {
                k: [-0.012, 0.009, -0.007, 0.0015],
                max_angle_deg: 95.0,
            },
            Lens::FTheta {
                c: [1.0, -0.01, 0.02, -0.015, 0.002, 0.0],
                max_angle_deg: 80.0,
            },
        ]
    }

    #[test]
    fn lenses_come_back() {
        for lens in lenses() {
            let sent = camera(lens);
            let back = camera_of(&spec_of(&sent), [0, 0]).expect("a camera");
            assert_eq!(back.lens.name(), sent.lens.name());
            assert_eq!([back.width, back.height], [1600, 900]);
            let (a, b) = (Optics::new(&sent), Optics::new(&back));
            for p in [DVec3::new(0.3, -0.2, 1.0), DVec3::new(-0.9, 0.4, 1.4)] {
                let (a, b) = (a.project(p).expect("seen"), b.project(p).expect("seen"));
                assert!(a.distance(b) < 1e-9, "{lens:?}: {a} {b}");
            }
        }
    }

    /// An f-theta lens that is told by angles over pixels shows things where the one told the other way does.
    #[test]
    fn a_polynomial_can_be_told_either_way() {
        let sent = camera(lenses()[3]);
        let mut spec = spec_of(&sent);
        let Some(CameraParam::Ftheta(p)) = &mut spec.camera_param else {
            panic!("an f-theta lens");
        };
        p.reference_poly = FthetaPolynomial::PixeldistToAngle.into();
        p.angle_to_pixeldist_poly.clear();
        let back = camera_of(&spec, [0, 0]).expect("a camera");
        let (a, b) = (Optics::new(&sent), Optics::new(&back));
        for (u, v) in [(800.0, 450.0), (100.0, 80.0), (1500.0, 820.0)] {
            let off = b.project(a.direction(u, v)).expect("seen") - DVec2::new(u, v);
            assert!(off.length() < 1.0, "{u} {v}: {off}");
        }
    }

    #[test]
    fn what_is_not_supported_is_said() {
        let refused = |change: &dyn Fn(&mut CameraSpec)| {
            let mut spec = spec_of(&camera(Lens::Pinhole));
            change(&mut spec);
            camera_of(&spec, [640, 480])
                .expect_err("refused")
                .message()
                .to_owned()
        };
        let pinhole = |change: fn(&mut Pinhole)| {
            move |spec: &mut CameraSpec| {
                if let Some(CameraParam::Pinhole(p)) = &mut spec.camera_param {
                    change(p);
                }
            }
        };
        assert!(refused(&|spec| spec.camera_param = None).contains("no lens"));
        assert!(refused(&pinhole(|p| p.thin_prism_coeffs = vec![0.1])).contains("thin prism"));
        assert!(refused(&pinhole(|p| p.radial_coeffs = vec![0.1; 9])).contains("at most 6"));
        let ftheta = |p: Ftheta| {
            let spec = CameraSpec {
                camera_param: Some(CameraParam::Ftheta(p)),
                ..CameraSpec::default()
            };
            camera_of(&spec, [640, 480])
                .expect_err("refused")
                .message()
                .to_owned()
        };
        assert!(ftheta(Ftheta::default()).contains("no polynomial"));
        let poly = |c: &[f64]| Ftheta {
            reference_poly: 2,
            angle_to_pixeldist_poly: c.to_vec(),
            ..Ftheta::default()
        };
        assert!(ftheta(poly(&[3.0, 100.0])).contains("expected 0"));
        assert!(ftheta(poly(&[0.0, f64::NAN])).contains("px per rad"));
        assert!(ftheta(poly(&[0.0, 0.0, 1.0])).contains("px per rad"));
        let backward = Ftheta {
            reference_poly: 1,
            pixeldist_to_angle_poly: vec![0.0, 1e-3, -1e-5],
            ..Ftheta::default()
        };
        assert!(ftheta(backward).contains("turned round"));
        assert!(direction_of(9).is_err());
        assert_eq!(direction_of(5).expect("global"), None);
    }
}
