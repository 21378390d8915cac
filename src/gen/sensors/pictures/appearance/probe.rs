//! Single rays of the renderer, for uses other than its pictures.

use glam::Vec3;

use super::prepared::Appearance;
use super::shade::VisibleSurface;
use super::truth::usable;
use crate::raycast::rays::CameraRay;
use scene::truth::{self, TruthClass};

/// Result of a single ray.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Probe {
    /// Colour as a picture shows it, without lens and sensor: sRGB-coded, 0 to 1.
    pub color: Vec3,
    /// Origin of the ray, m.
    pub from: Vec3,
    /// Direction, a unit vector.
    pub way: Vec3,
    /// Distance, m; infinite for the sky.
    pub t: f32,
    /// Outward unit normal; against the ray for sky and skyline.
    pub normal: Vec3,
    /// Class.
    pub class: TruthClass,
    /// The box that was hit; 0 for none.
    pub instance: u32,
    /// True for the skyline, which stands around the map and not on it.
    pub is_skyline: bool,
}

impl Appearance {
    /// Traces a ray; `pixel_rad` is the angle between neighbouring pixels. `None` where the lens sees nothing.
    pub(crate) fn probe(&self, ray: &CameraRay, pixel_rad: f32) -> Option<Probe> {
        let (from, way) = usable(ray)?;
        let (sample, seen) = self.light_along((from, way), ray.after_s as f32, pixel_rad);
        Some(self.told((from, way), sample.color, seen))
    }

    /// The skyline or sky that a ray would show on an empty map.
    pub(crate) fn probe_behind(&self, from: Vec3, way: Vec3) -> Probe {
        let (color, seen) = self.light_behind((from, way));
        self.told((from, way), color, seen)
    }

    /// The sky in a direction as a picture shows it, whatever hides it.
    pub(crate) fn sky_along(&self, way: Vec3) -> Vec3 {
        let color = self.shown(self.air.sky(self.anchor_dir(way)), 1.0);
        if color.is_finite() { color } else { Vec3::ZERO }
    }

    fn told(&self, (from, way): (Vec3, Vec3), light: Vec3, seen: VisibleSurface) -> Probe {
        let color = self.shown(light, 1.0);
        let probe = Probe {
            color: if color.is_finite() { color } else { Vec3::ZERO },
            from,
            way,
            t: f32::INFINITY,
            normal: -way,
            class: truth::SKY,
            instance: 0,
            is_skyline: false,
        };
        match seen {
            VisibleSurface::Sky => probe,
            VisibleSurface::Skyline(class, t) => Probe {
                t,
                class: truth::of_class(class),
                is_skyline: true,
                ..probe
            },
            VisibleSurface::Surface(hit, footprint) => {
                let (class, instance) = self.label(&hit, footprint);
                let normal = self.normal(&hit);
                Probe {
                    t: hit.t,
                    normal: if normal.is_finite() { normal } else { -way },
                    class,
                    instance,
                    ..probe
                }
            }
        }
    }
}
