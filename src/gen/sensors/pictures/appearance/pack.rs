//! An appearance as plain numbers, for the renderer of the graphics card: see `scene::appearance`.

use super::Appearance;
use super::prepared::Beam;
use super::things::{DrawnObject, ObjectPart, PartMaterial, rgb};
use glam::Vec3;
use scene::Class;
use scene::appearance::{AppearanceData, AppearanceSection, PART_WORDS, THING_WORDS};

impl Appearance {
    /// All data that the picture of a camera depends on.
    pub fn data(&self) -> AppearanceData {
        let air = &self.air;
        let with = |v: Vec3, w: f32| v.extend(w).to_array();
        let (turn, shift) = self.anchoring();
        let mut out = AppearanceData {
            extent: self.field.shape().extent,
            air: [
                with(air.to_sun, air.clouds),
                with(air.sun, air.haze_per_m),
                // Falling rain is 2 more than the wet ground.
                with(air.zenith, air.wet + if air.rain { 2.0 } else { 0.0 }),
                with(air.horizon, air.snow),
                with(air.ambient, air.dust),
                with(air.bounce, air.lamps),
                with(air.haze, air.exposure),
                with(self.to_sun(), self.highest_m()),
            ],
            turn: turn.to_array(),
            shift_m: shift.to_array(),
            vehicle_m: self.vehicle.to_array(),
            lowest_m: self.lowest_m(),
            seed: self.seed,
            ..AppearanceData::default()
        };
        self.field.pack(&mut out);
        self.ground.pack(&mut out);
        self.pack_things(&mut out);
        self.paint.pack(&mut out);
        let lamps = self.lamps.iter().flat_map(|l| {
            let kind = match l.beam {
                Beam::Street => 0,
                Beam::Head => 1,
                Beam::Glow => 2,
            };
            let [at, axis, color] = [l.at, l.axis, l.color].map(|v| v.to_array().map(f32::to_bits));
            let range = l.range_m.to_bits();
            [
                at[0], at[1], at[2], range, axis[0], axis[1], axis[2], kind, color[0], color[1], color[2], 0,
            ]
        });
        out.push(AppearanceSection::Lamps, lamps);
        out.at[AppearanceSection::LampCount as usize] = self.lamps.len() as u32;
        let calm = (0..=Class::FREE).flat_map(|label| {
            let class = Class::from_id(label).unwrap_or(Class::Others);
            super::material::calm(class).to_array().map(f32::to_bits)
        });
        out.push(AppearanceSection::Calm, calm);
        out
    }

    fn pack_things(&self, out: &mut AppearanceData) {
        let (mut things, mut parts, mut planes) = (Vec::new(), Vec::new(), Vec::<u32>::new());
        for t in &self.things {
            let first = (parts.len() / PART_WORDS) as u32;
            for (part, material) in &t.parts {
                pack_part(part, *material, &mut parts, &mut planes);
            }
            // Cuts lie among the half spaces, two for a cut.
            let cuts = [(planes.len() / 4) as u32, t.cuts.len() as u32];
            let corners = t.cuts.as_flattened().iter().map(|c| c.extend(0.0));
            planes.extend(corners.flat_map(|c| c.to_array().map(f32::to_bits)));
            pack_thing(t, first, cuts, &mut things);
        }
        out.push(AppearanceSection::Things, things);
        out.push(AppearanceSection::Parts, parts);
        out.push(AppearanceSection::Planes, planes);
        let lists: Vec<&[u32]> = self.lists().collect();
        out.push(
            AppearanceSection::ListStarts,
            starts(lists.iter().map(|l| l.len())),
        );
        out.push(AppearanceSection::Lists, lists.concat());
    }
}

/// Starts of lists of these lengths, and the end of the last.
pub fn starts(lengths: impl Iterator<Item = usize>) -> Vec<u32> {
    let mut out = vec![0];
    let mut end = 0;
    for n in lengths {
        end += n as u32;
        out.push(end);
    }
    out
}

fn pack_thing(t: &DrawnObject, first: u32, [cuts, cut_count]: [u32; 2], out: &mut Vec<u32>) {
    let end = out.len() + THING_WORDS;
    out.extend([
        u32::from(t.class.id()),
        t.id,
        u32::from(t.lamps),
        first,
        t.parts.len() as u32,
    ]);
    let numbers = [
        t.foot.to_array().as_slice(),
        &t.heading.to_array(),
        &t.size.to_array(),
        &t.paint.to_array(),
        &[t.circle_m2(), t.floor_m],
    ]
    .concat();
    out.extend(numbers.into_iter().map(f32::to_bits));
    out.push(u32::from(t.is_scenery()));
    out.push(cuts << 4 | cut_count);
    out.extend(t.bound.to_array().map(f32::to_bits));
    out.resize(end, 0);
}

fn pack_part(part: &ObjectPart, material: PartMaterial, out: &mut Vec<u32>, planes: &mut Vec<u32>) {
    let end = out.len() + PART_WORDS;
    let (code, color) = match material {
        PartMaterial::Body => (0, Vec3::ZERO),
        PartMaterial::Cabin => (1, Vec3::ZERO),
        PartMaterial::Coach => (2, Vec3::ZERO),
        PartMaterial::Cargo => (3, Vec3::ZERO),
        PartMaterial::Wheel => (4, Vec3::ZERO),
        PartMaterial::Dark => (5, Vec3::ZERO),
        PartMaterial::Plain(c) => (6, c),
        PartMaterial::Cloth(c) => (7, c),
        PartMaterial::Skin => (8, rgb(224, 172, 136)),
        PartMaterial::Bands(c) => (9, c),
        PartMaterial::Walls(c) => (10, c),
        PartMaterial::Roof(c) => (11, c),
        PartMaterial::Masonry(c) => (12, c),
        PartMaterial::Boards(c) => (13, c),
        PartMaterial::Concrete(c) => (14, c),
        PartMaterial::Metal(c) => (15, c),
        PartMaterial::SignPlate(c) => (16, c),
        PartMaterial::SignalHead(c) => (17, c),
        PartMaterial::Lamp => (18, Vec3::ZERO),
        PartMaterial::Pane => (19, Vec3::ZERO),
    };
    let mut put = |kind: u32, numbers: &[u32]| {
        out.extend([kind, code]);
        out.extend(color.to_array().map(f32::to_bits));
        out.extend(numbers);
        out.resize(end, 0);
    };
    let bits = |v: &[f32]| -> Vec<u32> { v.iter().map(|v| v.to_bits()).collect() };
    match part {
        ObjectPart::Convex(all) => {
            put(0, &[(planes.len() / 4) as u32, all.len() as u32]);
            planes.extend(all.iter().flat_map(|p| p.to_array().map(f32::to_bits)));
        }
        ObjectPart::Wheel(c, radius, half) => put(1, &bits(&[c.x, c.y, c.z, *radius, *half])),
        ObjectPart::Ring(c, radius, half, hole) => {
            put(4, &bits(&[c.x, c.y, c.z, *radius, *half, *hole]));
        }
        ObjectPart::Round(c, r) => put(2, &bits(&[c.x, c.y, c.z, r.x, r.y, r.z])),
        ObjectPart::Limb([a, b], [ra, rb], wide) => {
            put(5, &bits(&[a.x, a.y, a.z, b.x, b.y, b.z, *ra, *rb, *wide]));
        }
        ObjectPart::Cone(f, height, bottom, top) => put(3, &bits(&[f.x, f.y, f.z, *height, *bottom, *top])),
    }
}
