//! People: bodies and clothes around joints. Lengths are shares of the height; x forward, y left, z up from the ground.

use glam::Vec3;

use super::aids::{pram, wheelchair};
use super::build::ObjectBuilder;
use super::gait::{ANKLE, ARM, Gait, HALF_HIPS, HALF_SHOULDERS, Joints, LEG, NECK_AND_HEAD, bent, on_foot};
use super::{ObjectPart, PartMaterial, rgb};
use crate::pictures::appearance::noise::{hash1, unit};

/// What a person wears and looks like.
pub(super) struct Looks {
    coat: PartMaterial,
    trousers: PartMaterial,
    hair: PartMaterial,
    /// Hair to the shoulders; a coat to the knees; a bag on the back.
    long_hair: bool,
    long_coat: bool,
    backpack: bool,
    /// A helmet in this colour.
    pub helmet: Option<PartMaterial>,
    vest: bool,
    cap: bool,
}

impl Looks {
    /// The looks of a person by number, and by what the person is called.
    pub(super) fn new(id: u32, name: &str) -> Self {
        let one_of = |salt: u32, colors: &[[u8; 3]]| {
            let [r, g, b] = colors[hash1(id, salt) as usize % colors.len()];
            PartMaterial::Cloth(worn(rgb(r, g, b)))
        };
        let share = |salt: u32| unit(hash1(id, salt));
        let mut out = Self {
            coat: one_of(1, &COATS),
            trousers: one_of(2, &TROUSERS),
            hair: one_of(6, &HAIR),
            long_hair: share(7) < 0.4,
            long_coat: share(8) < 0.25,
            backpack: share(9) < 0.3,
            helmet: None,
            vest: false,
            cap: false,
        };
        let is = |part: &str| name.contains(part);
        if is("woman") || is("girl") {
            out.long_hair = true;
        } else if is("man") || is("boy") {
            out.long_hair = false;
        }
        if is("worker") {
            out.vest = true;
            out.helmet = Some(PartMaterial::Plain(rgb(206, 160, 44)));
            (out.backpack, out.long_coat) = (false, false);
        }
        if is("police") {
            (out.coat, out.trousers) = (
                PartMaterial::Cloth(worn(rgb(40, 46, 66))),
                PartMaterial::Cloth(worn(rgb(34, 38, 50))),
            );
            (out.cap, out.long_coat, out.backpack) = (true, false, false);
        }
        out
    }
}

/// A colour as cloth has it that was washed: greyer and darker.
fn worn(color: Vec3) -> Vec3 {
    let gray = Vec3::splat(color.dot(Vec3::new(0.21, 0.72, 0.07)));
    color.lerp(gray, 0.3) * 0.75
}

const COATS: [[u8; 3]; 12] = [
    [38, 44, 62],
    [60, 62, 66],
    [122, 52, 48],
    [196, 190, 178],
    [62, 78, 70],
    [150, 126, 84],
    [84, 98, 122],
    [24, 24, 28],
    [156, 160, 164],
    [96, 74, 60],
    [44, 72, 104],
    [176, 144, 60],
];
const TROUSERS: [[u8; 3]; 7] = [
    [44, 54, 78],
    [30, 32, 38],
    [70, 72, 76],
    [112, 100, 80],
    [58, 74, 104],
    [24, 24, 26],
    [88, 84, 74],
];
const HAIR: [[u8; 3]; 6] = [
    [28, 22, 18],
    [62, 44, 30],
    [96, 70, 44],
    [150, 120, 76],
    [120, 118, 114],
    [18, 16, 16],
];

/// Adds a person in a box, by name, else by its shape: in a wheelchair, lying, with a pram, else on foot.
pub(super) fn person(b: &mut ObjectBuilder, id: u32, name: &str, gait: Gait) {
    let s = b.s;
    let mut looks = Looks::new(id, name);
    let is = |part: &str| name.contains(part);
    let (sits, pushes) = (is("wheelchair"), is("pram") || is("stroller"));
    let is_named = sits || pushes;
    if sits || !is_named && (0.95..1.4).contains(&s.x) && s.y > 0.55 && (1.15..1.5).contains(&s.z) {
        (looks.long_coat, looks.backpack) = (false, false);
        wheelchair(b, id, &looks);
    } else if s.z < 0.8 && s.x > 1.5 * s.z {
        (looks.long_coat, looks.backpack) = (false, false);
        lying(b, id, &looks);
    } else if pushes || !is_named && (1.25..2.2).contains(&s.x) && s.z > 1.4 {
        let foot = Vec3::new(-0.5 * s.x + 0.36, 0.0, 0.0);
        let mut joints = on_foot(id, s.z, 0.72, gait);
        let push = |side: f32| Vec3::new(0.2, side * 0.09, 0.58);
        joints.wrists = [push(1.0), push(-1.0)];
        joints.elbows_to = Vec3::new(-0.5, 0.0, -1.0);
        pram(b, foot.x + 0.2 * s.z);
        body(b, foot, s.z, id, &joints, &looks);
    } else {
        let joints = on_foot(id, s.z, s.x, gait);
        body(b, Vec3::ZERO, s.z, id, &joints, &looks);
    }
}

/// Somebody who lies on the ground, as long as the box: the standing figure, laid on its back.
fn lying(b: &mut ObjectBuilder, id: u32, looks: &Looks) {
    let (length_m, first) = (b.s.x.min(2.0), b.parts.len());
    body(
        b,
        Vec3::ZERO,
        length_m,
        id,
        &on_foot(id, length_m, 0.7, Gait::default()),
        looks,
    );
    let back_m = 0.08 * length_m;
    let laid = |p: Vec3| Vec3::new(p.z - length_m / 2.0, p.y, back_m - p.x);
    for (part, _) in &mut b.parts[first..] {
        match part {
            ObjectPart::Limb(ends, ..) => *ends = ends.map(laid),
            ObjectPart::Round(middle, radii) => {
                (*middle, *radii) = (laid(*middle), Vec3::new(radii.z, radii.y, radii.x))
            }
            _ => {}
        }
    }
}

/// Adds the body around the joints: its feet are at `foot` (m), and it is `height_m` tall if it stands.
pub(super) fn body(
    b: &mut ObjectBuilder,
    foot: Vec3,
    height_m: f32,
    id: u32,
    joints: &Joints,
    looks: &Looks,
) {
    let mut body = Body {
        foot,
        height_m,
        parts: &mut b.parts,
    };
    let child = ((1.55 - height_m) / 0.6).clamp(0.0, 1.0);
    let (hips, shoulders) = (joints.hips, joints.shoulders);
    let up = (shoulders - hips).normalize_or(Vec3::Z);
    let ahead = Vec3::new(up.z, 0.0, -up.x).normalize_or(Vec3::X);
    let coat = looks.coat;
    for (i, side) in [1.0, -1.0].into_iter().enumerate() {
        let hip = hips + Vec3::Y * side * HALF_HIPS;
        let ankle = joints.ankles[i];
        let knee = bent([hip, ankle], [LEG, LEG], Vec3::X);
        body.limb([hip, knee], [0.054, 0.038], looks.trousers);
        body.limb([knee, ankle], [0.038, 0.027], looks.trousers);
        let heel = ankle + Vec3::new(-0.012, 0.0, 0.018 - ANKLE);
        body.limb([heel, joints.toes[i]], [0.022, 0.018], PartMaterial::Dark);
        let shoulder = shoulders + Vec3::Y * side * HALF_SHOULDERS;
        let wrist = shoulder + (joints.wrists[i] - shoulder).clamp_length_max(0.998 * (ARM[0] + ARM[1]));
        let elbow = bent([shoulder, wrist], ARM, joints.elbows_to);
        body.limb([shoulder, elbow], [0.034, 0.029], coat);
        body.limb([elbow, wrist], [0.029, 0.022], coat);
        let hand = wrist + (wrist - elbow).normalize_or(Vec3::NEG_Z) * 0.035;
        body.limb([wrist, hand], [0.017, 0.020], PartMaterial::Skin);
    }
    let chest = hips.lerp(shoulders, 0.84);
    let neck = shoulders + up * 0.03 + ahead * 0.006;
    body.trunk([chest, hips + up * 0.03], [0.063, 0.056], 1.82, coat);
    body.trunk(
        [hips + up * 0.02, hips - up * 0.02],
        [0.056, 0.05],
        1.6,
        looks.trousers,
    );
    body.trunk([shoulders - up * 0.012, neck], [0.044, 0.032], 2.35, coat);
    if looks.vest {
        let vest = PartMaterial::Plain(rgb(206, 126, 24));
        body.trunk([chest, hips + up * 0.05], [0.068, 0.062], 1.76, vest);
    }
    if looks.long_coat && up.z > 0.95 {
        let low = Vec3::new(hips.x, 0.0, hips.z - 0.17);
        body.cone(low, 0.2, [0.11, 0.078], coat);
    }
    if looks.backpack && up.z > 0.9 {
        let pack = PartMaterial::Cloth(rgb(52, 46, 56));
        let back = hips.lerp(shoulders, 0.45) - ahead * 0.085;
        body.limb([back, back + up * 0.13], [0.055, 0.05], pack);
    }
    let round = 0.062 + 0.016 * child;
    // The head stays upright, and its top is at the height of the person.
    let head = Vec3::new(neck.x + 0.018, neck.y, shoulders.z + NECK_AND_HEAD - round * 1.13);
    body.limb([neck, head], [0.03, 0.03], PartMaterial::Skin);
    body.round(
        head,
        [round * 0.95, round * 0.76, round * 1.08],
        PartMaterial::Skin,
    );
    body.round(
        head + Vec3::new(round, 0.0, -0.12 * round),
        [round * 0.18, round * 0.15, round * 0.22],
        PartMaterial::Skin,
    );
    for side in [0.34, -0.34] {
        let eye = head + Vec3::new(0.84, side, 0.1) * round;
        body.round(eye, [round * 0.1, round * 0.13, round * 0.08], PartMaterial::Dark);
    }
    body.head_of(head, round, id, looks);
}

/// Collects the parts of a body in shares of its height.
struct Body<'a> {
    foot: Vec3,
    height_m: f32,
    parts: &'a mut Vec<(ObjectPart, PartMaterial)>,
}

impl Body<'_> {
    fn at(&self, p: Vec3) -> Vec3 {
        self.foot + p * self.height_m
    }

    fn limb(&mut self, ends: [Vec3; 2], radii: [f32; 2], material: PartMaterial) {
        let [a, b] = ends.map(|p| self.at(p));
        let part = ObjectPart::Limb([a, b], radii.map(|r| r * self.height_m), 1.0);
        self.parts.push((part, material));
    }

    /// A limb that is some times wider than deep.
    fn trunk(&mut self, ends: [Vec3; 2], radii: [f32; 2], wide: f32, material: PartMaterial) {
        let [a, b] = ends.map(|p| self.at(p));
        let part = ObjectPart::Limb([a, b], radii.map(|r| r * self.height_m), wide);
        self.parts.push((part, material));
    }

    fn round(&mut self, middle: Vec3, radii: [f32; 3], material: PartMaterial) {
        let part = ObjectPart::Round(self.at(middle), Vec3::from(radii) * self.height_m);
        self.parts.push((part, material));
    }

    fn cone(&mut self, foot: Vec3, height: f32, radii: [f32; 2], material: PartMaterial) {
        let [bottom, top] = radii.map(|r| r * self.height_m);
        let part = ObjectPart::Cone(self.at(foot), height * self.height_m, bottom, top);
        self.parts.push((part, material));
    }

    /// Hair, a cap or a helmet.
    fn head_of(&mut self, head: Vec3, round: f32, id: u32, looks: &Looks) {
        let up = |x: f32, z: f32| head + Vec3::new(x, 0.0, z) * round;
        if let Some(helmet) = looks.helmet {
            self.round(up(-0.1, 0.45), [round * 1.12, round * 0.98, round * 0.9], helmet);
        } else if looks.cap || unit(hash1(id, 10)) < 0.12 {
            let cap = if looks.cap {
                looks.coat
            } else {
                PartMaterial::Cloth(rgb(64, 60, 70))
            };
            self.round(up(-0.08, 0.62), [round * 1.03, round * 0.86, round * 0.62], cap);
            self.round(up(0.85, 0.52), [round * 0.55, round * 0.6, round * 0.1], cap);
        } else {
            self.round(
                up(-0.2, 0.32),
                [round * 0.94, round * 0.86, round * 0.9],
                looks.hair,
            );
        }
        if looks.long_hair {
            self.limb(
                [up(-0.42, 0.2), up(-0.5, -1.15)],
                [round * 0.72, round * 0.6],
                looks.hair,
            );
        }
    }
}
