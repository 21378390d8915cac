//! Which part of a picture has to be drawn again after a change of the scene: the rectangle that the changed part of space
//! covers. So a small edit is cheap, even if the processor draws.

use glam::{DMat4, DVec3, DVec4};

use scene::Extent;

/// A part of the ego frame, m.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct EgoBounds {
    pub low_m: DVec3,
    pub high_m: DVec3,
}

impl EgoBounds {
    /// The box around some points; `None` without any, or if one is not finite.
    pub fn around(points: impl IntoIterator<Item = DVec3>) -> Option<Self> {
        let mut part: Option<Self> = None;
        for p in points {
            if !p.is_finite() {
                return None;
            }
            let here = Self { low_m: p, high_m: p };
            part = Some(part.map_or(here, |part| part.with(here)));
        }
        part
    }

    /// Voxels `low..high` of a grid.
    pub fn of_voxels(extent: Extent, low: [usize; 3], high: [usize; 3]) -> Self {
        let corner = |v: [usize; 3]| extent.from_voxel_units(DVec3::from_array(v.map(|c| c as f64)));
        Self {
            low_m: corner(low),
            high_m: corner(high),
        }
    }

    /// The box around both.
    pub fn with(self, other: Self) -> Self {
        Self {
            low_m: self.low_m.min(other.low_m),
            high_m: self.high_m.max(other.high_m),
        }
    }
}

/// How much of a picture differs from the one drawn last.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) enum PictureChange {
    /// No change.
    #[default]
    None,
    /// These parts of space, and a margin of so many pixels around them in the picture.
    Parts(Vec<(EgoBounds, f64)>),
    /// Any change: the whole picture is drawn.
    All,
}

impl PictureChange {
    /// One part, with a margin in pixels.
    pub fn part(part: EgoBounds, around_px: f64) -> Self {
        Self::Parts(vec![(part, around_px)])
    }

    /// Adds another change.
    pub fn add(&mut self, other: Self) {
        *self = match (std::mem::take(self), other) {
            (Self::All, _) | (_, Self::All) => Self::All,
            (Self::None, other) => other,
            (this, Self::None) => this,
            (Self::Parts(mut these), Self::Parts(others)) => {
                these.extend(others);
                Self::Parts(these)
            }
        };
    }
}

/// Pixels of a picture: left, top, width, height.
pub(super) type PixelRect = [u32; 4];

/// Most of the picture is touched, or the touched part is not known.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Whole;

/// If a larger share of a picture than this is touched, all of it is drawn.
const MOST: f64 = 0.6;

/// The pixels that a change touches in a picture of `size`, whose camera maps the ego frame by `clip_from_ego`. [`Whole`] if
/// that is most of it or cannot be told (a part reaches behind the eye); `Ok(None)` if none are.
pub(super) fn touched(
    change: &PictureChange,
    clip_from_ego: &DMat4,
    size: [u32; 2],
) -> Result<Option<PixelRect>, Whole> {
    let parts = match change {
        PictureChange::None => return Ok(None),
        PictureChange::All => return Err(Whole),
        PictureChange::Parts(parts) => parts,
    };
    let [w, h] = size.map(f64::from);
    let (mut low, mut high) = ([f64::INFINITY; 2], [f64::NEG_INFINITY; 2]);
    for (part, around_px) in parts {
        let mut seen = ([f64::INFINITY; 2], [f64::NEG_INFINITY; 2]);
        for i in 0..8 {
            let pick = |axis: usize| {
                if i >> axis & 1 == 0 {
                    part.low_m[axis]
                } else {
                    part.high_m[axis]
                }
            };
            let c = *clip_from_ego * DVec4::new(pick(0), pick(1), pick(2), 1.0);
            if !c.is_finite() || c.w < 1e-3 {
                return Err(Whole);
            }
            let at = [(c.x / c.w + 1.0) * 0.5 * w, (1.0 - c.y / c.w) * 0.5 * h];
            for (axis, px) in at.into_iter().enumerate() {
                seen.0[axis] = seen.0[axis].min(px - around_px);
                seen.1[axis] = seen.1[axis].max(px + around_px);
            }
        }
        // Parts outside the picture must not make the rectangle larger.
        if seen.1[0] < 0.0 || seen.1[1] < 0.0 || seen.0[0] > w || seen.0[1] > h {
            continue;
        }
        for axis in 0..2 {
            low[axis] = low[axis].min(seen.0[axis]);
            high[axis] = high[axis].max(seen.1[axis]);
        }
    }
    let whole = [w, h];
    let from = [0, 1].map(|i| (low[i].floor() - 1.0).clamp(0.0, whole[i]));
    let to = [0, 1].map(|i| (high[i].ceil() + 1.0).clamp(0.0, whole[i]));
    let sides = [0, 1].map(|i| to[i] - from[i]);
    if sides[0] <= 0.0 || sides[1] <= 0.0 {
        return Ok(None);
    }
    if sides[0] * sides[1] > MOST * w * h {
        return Err(Whole);
    }
    Ok(Some([from[0], from[1], sides[0], sides[1]].map(|v| v as u32)))
}

/// Clip space of a rectangle of the picture and `margin_px` around it: what lies in it comes to -1..1.
pub(super) fn crop(rect: PixelRect, margin_px: f64, size: [u32; 2]) -> DMat4 {
    let [x, y, w, h] = rect.map(f64::from);
    let (x, y, w, h) = (
        x - margin_px,
        y - margin_px,
        w + 2.0 * margin_px,
        h + 2.0 * margin_px,
    );
    let [all_w, all_h] = size.map(f64::from);
    let middle = [
        2.0 * (x + w / 2.0) / all_w - 1.0,
        1.0 - 2.0 * (y + h / 2.0) / all_h,
    ];
    let scale = DVec3::new(all_w / w.max(1.0), all_h / h.max(1.0), 1.0);
    DMat4::from_scale(scale) * DMat4::from_translation(DVec3::new(-middle[0], -middle[1], 0.0))
}

/// False if a box of the ego frame, m, is out of view for sure: all corners beyond one and the same side of clip space.
pub(super) fn may_be_seen(low_m: DVec3, high_m: DVec3, clip_from_ego: &DMat4) -> bool {
    let mut beyond = 0b11111u32;
    for i in 0..8 {
        let pick = |axis: usize| {
            if i >> axis & 1 == 0 {
                low_m[axis]
            } else {
                high_m[axis]
            }
        };
        let c = *clip_from_ego * DVec4::new(pick(0), pick(1), pick(2), 1.0);
        let sides = [c.x < -c.w, c.x > c.w, c.y < -c.w, c.y > c.w, c.w <= 0.0];
        beyond &= sides
            .iter()
            .enumerate()
            .fold(0, |m, (i, s)| m | u32::from(*s) << i);
    }
    beyond == 0
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{ViewCamera, ViewPreset};

    const SIZE: [u32; 2] = [400, 300];

    fn cube(at: DVec3, side_m: f64) -> PictureChange {
        PictureChange::part(
            EgoBounds {
                low_m: at - side_m / 2.0,
                high_m: at + side_m / 2.0,
            },
            2.0,
        )
    }

    #[test]
    fn a_part_covers_the_pixels_that_its_points_project_to() {
        let mut camera = ViewCamera::preset(ViewPreset::Top);
        for turn in 0..12 {
            camera.orbit(0.3, if turn < 6 { -0.09 } else { 0.05 });
            let clip = camera.clip_from_world(SIZE);
            let at = DVec3::new(5.0, -4.0, 0.5);
            let Ok(Some([x, y, w, h])) = touched(&cube(at, 2.0), &clip, SIZE) else {
                panic!("a small part of the picture");
            };
            for i in 0..27 {
                let step = |k: i32| f64::from(i / k % 3 - 1);
                let p = at + DVec3::new(step(1), step(3), step(9));
                let px = camera.project(p, SIZE).expect("in front");
                assert!(px.x > f64::from(x) && px.x < f64::from(x + w), "{px} {x} {w}");
                assert!(px.y > f64::from(y) && px.y < f64::from(y + h), "{px} {y} {h}");
            }
            // The cropped clip space holds the same.
            let c = crop([x, y, w, h], 0.0, SIZE) * clip * at.extend(1.0);
            assert!(c.x.abs() < c.w && c.y.abs() < c.w);
        }
    }

    #[test]
    fn what_cannot_be_told_is_all() {
        let camera = ViewCamera::default();
        let clip = camera.clip_from_world(SIZE);
        let touch = |change: &PictureChange| touched(change, &clip, SIZE);
        assert_eq!(touch(&PictureChange::None), Ok(None));
        assert_eq!(touch(&PictureChange::All), Err(Whole));
        assert_eq!(touch(&cube(camera.eye_m(), 4.0)), Err(Whole), "around the eye");
        assert_eq!(touch(&cube(DVec3::ZERO, 200.0)), Err(Whole), "everything");
        let nowhere = EgoBounds::around([DVec3::NAN]);
        assert_eq!(nowhere, None);
        let mut both = cube(DVec3::new(4.0, 0.0, 0.0), 1.0);
        both.add(PictureChange::All);
        assert_eq!(both, PictureChange::All);
        // Beside the picture nothing is touched.
        let ahead = camera.axes()[2];
        let beside = camera.eye_m() + ahead * 10.0 + camera.axes()[0] * 100.0;
        assert_eq!(touch(&cube(beside, 1.0)), Ok(None));
    }
}
