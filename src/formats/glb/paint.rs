//! The paint of a model: the colour of most of its surface, by its materials and their pictures.

use std::collections::BTreeMap;
use std::io::Cursor;

use glam::{DVec2, DVec3};
use gltf::json::material::{AlphaMode, Material};
use gltf::json::mesh::Primitive;
use gltf::json::texture;
use gltf::json::validation::Checked;
use image::{ImageReader, Limits, RgbImage};
use scene::Paint;

use super::accessor::PicturePlaces;
use super::document::{GltfDocument, GltfNode, LeftOut};
use crate::FormatError;

/// Longest side of a picture, pixels, and most memory to decode it, bytes.
const MOST_PX: u32 = 16_384;
const MOST_BYTES: u64 = 512 << 20;
/// A colour counts before whites, greys and blacks (tyres, glass) from this share of the surface on.
const COLOURED: f64 = 0.2;
/// Paints with so little colour that they count only where they are the most.
const MUTED: [Paint; 6] = [
    Paint::White,
    Paint::Silver,
    Paint::Grey,
    Paint::Black,
    Paint::Brown,
    Paint::Beige,
];

/// The colours of a document's materials; its pictures are read when they are first needed.
pub(crate) struct Coats<'a> {
    document: &'a GltfDocument<'a>,
    /// By number; none for one that cannot be read.
    pictures: BTreeMap<usize, Option<RgbImage>>,
}

/// The colour of a primitive: linear shares of red, green and blue, times those of a picture.
struct Coat<'a> {
    factor: DVec3,
    picture: Option<(&'a RgbImage, PicturePlaces<'a>, &'a texture::Info)>,
}

impl<'a> Coats<'a> {
    /// The coats of a document; none of its pictures is read yet.
    pub(crate) fn new(document: &'a GltfDocument<'a>) -> Self {
        Self {
            document,
            pictures: BTreeMap::new(),
        }
    }

    /// The paint of what these nodes show; `None` where no material says a colour. Errors in one line where triangles cannot be
    /// read.
    pub(crate) fn paint(&mut self, nodes: &[GltfNode]) -> Result<Option<Paint>, FormatError> {
        let mut areas = [0.0; Paint::ALL.len()];
        for node in nodes {
            let mesh = node.mesh.and_then(|mesh| self.document.root.meshes.get(mesh));
            for primitive in mesh.map_or(&[][..], |m| &m.primitives) {
                self.add(node, primitive, &mut areas)?;
            }
        }
        Ok(most(&areas))
    }

    /// Adds the areas of a primitive, m², to those of the paints.
    fn add(
        &mut self,
        node: &GltfNode,
        primitive: &Primitive,
        areas: &mut [f64; Paint::ALL.len()],
    ) -> Result<(), FormatError> {
        let document = self.document;
        let Some(coat) = self.coat(primitive) else {
            return Ok(());
        };
        document.corners(primitive, &mut LeftOut::default(), |corners, numbers| {
            let [a, b, c] = corners.map(|p| node.world_from_node.transform_point3(p));
            let area = (b - a).cross(c - a).length() / 2.0;
            if let (true, Some(colour)) = (area.is_finite(), coat.at(numbers)) {
                areas[paint_of(colour) as usize] += area;
            }
        })
    }

    /// The colour of a primitive; `None` if its material has none, or can be seen through.
    fn coat(&mut self, primitive: &Primitive) -> Option<Coat<'_>> {
        let document = self.document;
        let material: &Material = document.root.materials.get(primitive.material?.value())?;
        if material.alpha_mode == Checked::Valid(AlphaMode::Blend) {
            return None;
        }
        let metal = &material.pbr_metallic_roughness;
        let [r, g, b, _] = metal.base_color_factor.0.map(f64::from);
        let factor = DVec3::new(r, g, b);
        let Some(info) = &metal.base_color_texture else {
            // White is the default of a material without a colour.
            return (factor != DVec3::ONE).then_some(Coat {
                factor,
                picture: None,
            });
        };
        let image = document.root.textures.get(info.index.value())?.source.value();
        let set = transform(info)
            .and_then(|t| t.tex_coord)
            .unwrap_or(info.tex_coord);
        let places = document.picture_places(primitive, set)?;
        let read = || document.picture(image).ok().and_then(|bytes| decoded(&bytes));
        let picture = self.pictures.entry(image).or_insert_with(read).as_ref()?;
        Some(Coat {
            factor,
            picture: Some((picture, places, info)),
        })
    }
}

impl Coat<'_> {
    /// Linear shares in the middle of the triangle between those corners.
    fn at(&self, corners: [u64; 3]) -> Option<DVec3> {
        let Some((picture, places, info)) = &self.picture else {
            return Some(self.factor);
        };
        let [a, b, c] = corners.map(|i| places.get(i));
        let mut at = (a? + b? + c?) / 3.0;
        if let Some(t) = transform(info) {
            let pair = |v: [f32; 2]| DVec2::from_array(v.map(f64::from));
            at = DVec2::from_angle(f64::from(t.rotation.0)).rotate(at * pair(t.scale.0)) + pair(t.offset.0);
        }
        if !at.is_finite() {
            return None;
        }
        // Pictures repeat.
        let place = |share: f64, size: u32| ((share.rem_euclid(1.0) * f64::from(size)) as u32).min(size - 1);
        let pixel = picture.get_pixel(place(at.x, picture.width()), place(at.y, picture.height()));
        Some(self.factor * DVec3::from_array(pixel.0.map(linear)))
    }
}

fn transform(info: &texture::Info) -> Option<&gltf::json::extensions::texture::TextureTransform> {
    info.extensions.as_ref()?.texture_transform.as_ref()
}

/// A PNG or JPEG picture of bounded size; `None` if the bytes are no such picture.
fn decoded(bytes: &[u8]) -> Option<RgbImage> {
    let mut reader = ImageReader::new(Cursor::new(bytes)).with_guessed_format().ok()?;
    let mut limits = Limits::default();
    (limits.max_image_width, limits.max_image_height) = (Some(MOST_PX), Some(MOST_PX));
    limits.max_alloc = Some(MOST_BYTES);
    reader.limits(limits);
    let picture = reader.decode().ok()?.to_rgb8();
    (picture.width() > 0 && picture.height() > 0).then_some(picture)
}

/// A byte of sRGB as a linear share of 1.
fn linear(byte: u8) -> f64 {
    let share = f64::from(byte) / 255.0;
    match share <= 0.040_45 {
        true => share / 12.92,
        false => ((share + 0.055) / 1.055).powf(2.4),
    }
}

/// The paint of most of a surface; `None` without any.
fn most(areas: &[f64; Paint::ALL.len()]) -> Option<Paint> {
    let all: f64 = areas.iter().sum();
    let largest = |wanted: &dyn Fn(Paint) -> bool| {
        let of = |paint: &Paint| areas[*paint as usize];
        let there = Paint::ALL
            .into_iter()
            .filter(|paint| wanted(*paint) && of(paint) > 0.0);
        there.max_by(|a, b| of(a).total_cmp(&of(b)))
    };
    let coloured = largest(&|paint| !MUTED.contains(&paint));
    coloured
        .filter(|paint| areas[*paint as usize] >= COLOURED * all)
        .or_else(|| largest(&|_| true))
}

/// The paint that a colour (linear shares of red, green and blue) is called by: its lightness, and where it has some colour, its hue, in
/// [Oklab](https://bottosson.github.io/posts/oklab/).
fn paint_of(colour: DVec3) -> Paint {
    let [r, g, b] = colour.max(DVec3::ZERO).to_array();
    let l = (0.412_221_470_8 * r + 0.536_332_536_3 * g + 0.051_445_992_9 * b).cbrt();
    let m = (0.211_903_498_2 * r + 0.680_699_545_1 * g + 0.107_396_956_6 * b).cbrt();
    let s = (0.088_302_461_9 * r + 0.281_718_837_6 * g + 0.629_978_700_5 * b).cbrt();
    let light = 0.210_454_255_3 * l + 0.793_617_785 * m - 0.004_072_046_8 * s;
    let to_red = 1.977_998_495_1 * l - 2.428_592_205 * m + 0.450_593_709_9 * s;
    let to_yellow = 0.025_904_037_1 * l + 0.782_771_766_2 * m - 0.808_675_766 * s;
    let (chroma, hue_deg) = (to_red.hypot(to_yellow), to_yellow.atan2(to_red).to_degrees());
    let is_warm = (35.0..110.0).contains(&hue_deg);
    match () {
        () if is_warm && light > 0.65 && (0.025..0.08).contains(&chroma) => Paint::Beige,
        () if is_warm && light < 0.55 && chroma >= 0.03 && hue_deg < 100.0 => Paint::Brown,
        () if chroma < 0.06 => match light {
            light if light > 0.9 => Paint::White,
            light if light > 0.69 => Paint::Silver,
            light if light > 0.4 => Paint::Grey,
            _ => Paint::Black,
        },
        () => by_hue(hue_deg),
    }
}

/// The coloured paint whose hue is nearest, degrees of Oklab.
fn by_hue(hue_deg: f64) -> Paint {
    let hues = [
        (Paint::Red, 25.0),
        (Paint::Orange, 50.0),
        (Paint::Yellow, 92.0),
        (Paint::Green, 150.0),
        (Paint::Blue, 262.0),
        (Paint::Purple, 308.0),
        (Paint::Pink, 356.0),
    ];
    let off = |deg: f64| ((hue_deg - deg + 180.0).rem_euclid(360.0) - 180.0).abs();
    let nearest = hues.into_iter().min_by(|a, b| off(a.1).total_cmp(&off(b.1)));
    nearest.map_or(Paint::Grey, |(paint, _)| paint)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of(srgb: [u8; 3]) -> Paint {
        paint_of(DVec3::from_array(srgb.map(linear)))
    }

    #[test]
    fn every_paint_is_called_by_its_name_and_so_are_colours_near_to_it() {
        for (i, paint) in Paint::ALL.into_iter().enumerate() {
            assert_eq!((of(paint.srgb()), paint as usize), (paint, i));
        }
        for (srgb, paint) in [
            ([255, 207, 96], Paint::Yellow),
            ([255, 255, 0], Paint::Yellow),
            ([255, 0, 0], Paint::Red),
            ([0, 255, 0], Paint::Green),
            ([54, 146, 107], Paint::Green),
            ([0, 0, 255], Paint::Blue),
            ([135, 206, 235], Paint::Blue),
            ([255, 165, 0], Paint::Orange),
            ([128, 0, 128], Paint::Purple),
            ([255, 192, 203], Paint::Pink),
            ([54, 54, 58], Paint::Black),
            ([170, 178, 214], Paint::Silver),
            ([255, 255, 255], Paint::White),
        ] {
            assert_eq!(of(srgb), paint, "{srgb:?}");
        }
    }

    #[test]
    fn tyres_and_glass_do_not_paint_a_car() {
        let mut areas = [0.0; Paint::ALL.len()];
        assert_eq!(most(&areas), None);
        areas[Paint::Black as usize] = 9.0;
        areas[Paint::Yellow as usize] = 7.0;
        assert_eq!(most(&areas), Some(Paint::Yellow));
        // A light at its rear does not, either.
        areas[Paint::Yellow as usize] = 1.0;
        assert_eq!(most(&areas), Some(Paint::Black));
    }
}
