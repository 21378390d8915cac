//! Draws egui on the processor, without a window or a graphics card, for pictures of a pane.

use egui::epaint::{ImageData, Mesh, Primitive};
use egui::{Color32, Context, Pos2, RawInput, Rect, TextureId, Ui, pos2};
use std::collections::HashMap;

use super::picture::RgbaPicture;

/// Texels, row by row.
struct Texture {
    size: [usize; 2],
    texels: Vec<Color32>,
}

/// The picture that `show` draws on `points` (width, height), with `pixels_per_point`.
pub fn picture(
    ctx: &Context,
    points: [f32; 2],
    pixels_per_point: f32,
    mut show: impl FnMut(&mut Ui),
) -> RgbaPicture {
    let input = || RawInput {
        screen_rect: Some(Rect::from_min_size(Pos2::ZERO, points.into())),
        ..RawInput::default()
    };
    ctx.set_pixels_per_point(pixels_per_point);
    let mut textures: HashMap<TextureId, Texture> = HashMap::new();
    let mut last = None;
    // The first passes measure sizes for the layout of the last one.
    for _ in 0..4 {
        let output = ctx.run_ui(input(), &mut show);
        let deltas = output.textures_delta.set.iter();
        for (id, delta) in deltas.flat_map(|(id, deltas)| deltas.iter().map(move |d| (id, d))) {
            let ImageData::Color(image) = &delta.image;
            match (delta.pos, textures.get_mut(id)) {
                (Some([x, y]), Some(texture)) => {
                    for (row, texels) in image.pixels.chunks_exact(image.size[0].max(1)).enumerate() {
                        let at = (y + row) * texture.size[0] + x;
                        texture.texels[at..at + texels.len()].copy_from_slice(texels);
                    }
                }
                _ => {
                    let texture = Texture {
                        size: image.size,
                        texels: image.pixels.clone(),
                    };
                    textures.insert(*id, texture);
                }
            }
        }
        last = Some(output);
    }
    let [width, height] = points.map(|v| (v * pixels_per_point).round() as usize);
    let mut pixels = vec![[0.0f32; 4]; width * height];
    if let Some(output) = last {
        for primitive in ctx.tessellate(output.shapes, pixels_per_point) {
            if let (Primitive::Mesh(mesh), clip) = (&primitive.primitive, primitive.clip_rect)
                && let Some(texture) = textures.get(&mesh.texture_id)
            {
                draw(
                    mesh,
                    texture,
                    clip,
                    pixels_per_point,
                    [width, height],
                    &mut pixels,
                );
            }
        }
    }
    let rgba = pixels
        .into_iter()
        .flat_map(|p| p.map(|v| v.round().clamp(0.0, 255.0) as u8))
        .collect();
    RgbaPicture { width, height, rgba }
}

/// Draws triangles with colours and texture coordinates at their corners, blended over `out` (both premultiplied).
fn draw(
    mesh: &Mesh,
    texture: &Texture,
    clip: Rect,
    scale: f32,
    [width, height]: [usize; 2],
    out: &mut [[f32; 4]],
) {
    for triangle in mesh.indices.chunks_exact(3) {
        let corners = [0, 1, 2].map(|i| mesh.vertices[triangle[i] as usize]);
        let [a, b, c] = corners.map(|v| pos2(v.pos.x * scale, v.pos.y * scale));
        let area = cross(a, b, c);
        if area == 0.0 || !area.is_finite() {
            continue;
        }
        let bound = Rect::from_points(&[a, b, c]).intersect(clip * scale);
        let range = |low: f32, high: f32, n: usize| {
            low.floor().max(0.0) as usize..(high.ceil().max(0.0) as usize).min(n)
        };
        for y in range(bound.min.y, bound.max.y, height) {
            for x in range(bound.min.x, bound.max.x, width) {
                let p = pos2(x as f32 + 0.5, y as f32 + 0.5);
                let weights = [
                    cross(b, c, p) / area,
                    cross(c, a, p) / area,
                    cross(a, b, p) / area,
                ];
                if weights.iter().any(|w| *w < 0.0) || !bound.contains(p) {
                    continue;
                }
                let mix = |of: &dyn Fn(usize) -> f32| (0..3).map(|i| weights[i] * of(i)).sum::<f32>();
                let texel = sample(texture, [mix(&|i| corners[i].uv.x), mix(&|i| corners[i].uv.y)]);
                let source: [f32; 4] = std::array::from_fn(|channel| {
                    mix(&|i| f32::from(corners[i].color[channel])) * texel[channel] / 255.0
                });
                let under = &mut out[y * width + x];
                let through = 1.0 - source[3] / 255.0;
                for (u, s) in under.iter_mut().zip(source) {
                    *u = s + *u * through;
                }
            }
        }
    }
}

fn cross(a: Pos2, b: Pos2, p: Pos2) -> f32 {
    (b.x - a.x) * (p.y - a.y) - (b.y - a.y) * (p.x - a.x)
}

/// The bilinear sample of a texture: between the four nearest texels.
fn sample(texture: &Texture, [u, v]: [f32; 2]) -> [f32; 4] {
    let [width, height] = texture.size;
    if width == 0 || height == 0 {
        return [255.0; 4];
    }
    let (x, y) = (u * width as f32 - 0.5, v * height as f32 - 0.5);
    let (x0, y0) = (x.floor(), y.floor());
    let texel = |dx: f32, dy: f32| {
        let at = |v: f32, n: usize| (v.max(0.0) as usize).min(n - 1);
        let color = texture.texels[at(y0 + dy, height) * width + at(x0 + dx, width)];
        color.to_array().map(f32::from)
    };
    let (fx, fy) = (x - x0, y - y0);
    let [a, b, c, d] = [texel(0.0, 0.0), texel(1.0, 0.0), texel(0.0, 1.0), texel(1.0, 1.0)];
    std::array::from_fn(|i| {
        (a[i] * (1.0 - fx) + b[i] * fx) * (1.0 - fy) + (c[i] * (1.0 - fx) + d[i] * fx) * fy
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use egui::{Stroke, vec2};

    #[test]
    fn shapes_text_and_clips_are_drawn() {
        let ctx = Context::default();
        let shot = picture(&ctx, [60.0, 40.0], 2.0, |ui| {
            let painter = ui.painter();
            let rect = Rect::from_min_size(pos2(10.0, 10.0), vec2(20.0, 10.0));
            painter.rect_filled(rect, 0.0, Color32::from_rgb(200, 30, 10));
            painter
                .with_clip_rect(Rect::from_min_size(pos2(0.0, 0.0), vec2(50.0, 35.0)))
                .hline(0.0..=60.0, 30.0, Stroke::new(2.0, Color32::WHITE));
            painter.text(
                pos2(40.0, 2.0),
                egui::Align2::LEFT_TOP,
                "M",
                egui::FontId::default(),
                Color32::WHITE,
            );
        });
        assert_eq!((shot.width, shot.height), (120, 80));
        let at = |x: usize, y: usize| &shot.rgba[(y * 120 + x) * 4..][..4];
        assert_eq!(at(40, 30), [200, 30, 10, 255]);
        assert_eq!(at(70, 30), [0, 0, 0, 0]);
        assert!(at(90, 60)[0] > 240 && at(110, 60)[3] == 0, "clipped at 50 points");
        let ink = (80..110)
            .flat_map(|x| (4..36).map(move |y| (x, y)))
            .filter(|(x, y)| at(*x, *y)[3] > 128);
        assert!(ink.count() > 20, "a letter");
    }
}
