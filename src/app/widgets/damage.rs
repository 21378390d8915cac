//! Rectangles of the window that differ from the frame before: where triangles changed, or a texture that they show.

use egui::epaint::{ClippedPrimitive, Primitive};
use egui::{Pos2, Rect, TextureId, pos2};

use viewport::ui_mesh::{UiMesh, UiVertex};

/// Most rectangles that stay separate; more are joined.
const MOST: usize = 8;

/// All triangles of a frame.
#[derive(Clone, Default)]
pub(crate) struct Frame {
    pub vertices: Vec<UiVertex>,
    pub indices: Vec<u32>,
    /// Triangles of one texture each, with their clip rectangle, points.
    pub parts: Vec<(Rect, TextureId, UiMesh)>,
}

/// A texture that was written to: completely, or a part as shares of its width and height.
pub(crate) type Touched = (TextureId, Option<Rect>);

impl Frame {
    pub fn new(primitives: Vec<ClippedPrimitive>) -> Self {
        let mut out = Self::default();
        for ClippedPrimitive { clip_rect, primitive } in primitives {
            let Primitive::Mesh(mesh) = primitive else {
                continue;
            };
            let (first, base_vertex) = (out.indices.len() as u32, out.vertices.len() as i32);
            out.vertices.extend(mesh.vertices.iter().map(|v| UiVertex {
                position: [v.pos.x, v.pos.y],
                at: [v.uv.x, v.uv.y],
                color: v.color.to_array(),
            }));
            out.indices.extend_from_slice(&mesh.indices);
            let mesh_of = UiMesh {
                scissor: [0; 4],
                indices: first..out.indices.len() as u32,
                base_vertex,
            };
            out.parts.push((clip_rect, mesh.texture_id, mesh_of));
        }
        out
    }

    fn part(&self, i: usize) -> TexturedTriangles<'_> {
        let (clip, texture, mesh) = &self.parts[i];
        let end = self
            .parts
            .get(i + 1)
            .map_or(self.vertices.len(), |(_, _, next)| next.base_vertex as usize);
        TexturedTriangles {
            clip: *clip,
            texture: *texture,
            vertices: &self.vertices[mesh.base_vertex as usize..end],
            indices: &self.indices[mesh.indices.start as usize..mesh.indices.end as usize],
        }
    }

    /// The bounding rectangle of a part, points.
    pub fn bounds(&self, i: usize) -> Rect {
        self.part(i).bounds()
    }

    /// Rectangles, points, outside of which this frame equals the frame before.
    pub fn damage(&self, before: &Frame, touched: &[Touched]) -> Vec<Rect> {
        let (new, old) = (self.parts.len(), before.parts.len());
        let same = (0..new.min(old))
            .take_while(|&i| self.part(i) == before.part(i))
            .count();
        let same_after = (0..new.min(old) - same)
            .take_while(|&i| self.part(new - 1 - i) == before.part(old - 1 - i))
            .count();
        let (ours, theirs) = (same..new - same_after, same..old - same_after);
        let mut rects = Vec::new();
        if ours.len() == theirs.len() {
            for (i, j) in ours.zip(theirs) {
                rects.extend(self.part(i).differs_from(&before.part(j)));
            }
        } else {
            rects.extend(ours.map(|i| self.bounds(i)));
            rects.extend(theirs.map(|j| before.bounds(j)));
        }
        for (texture, share) in touched {
            for i in (0..new).filter(|&i| self.parts[i].1 == *texture) {
                rects.push(self.part(i).showing(*share));
            }
        }
        joined(rects.into_iter().filter(Rect::is_positive).collect())
    }
}

/// Triangles of one texture.
#[derive(PartialEq)]
struct TexturedTriangles<'a> {
    clip: Rect,
    texture: TextureId,
    vertices: &'a [UiVertex],
    indices: &'a [u32],
}

impl TexturedTriangles<'_> {
    fn at(&self, index: u32) -> Pos2 {
        self.vertices
            .get(index as usize)
            .map_or(Pos2::ZERO, |v| pos2(v.position[0], v.position[1]))
    }

    fn bounds(&self) -> Rect {
        let all = self.vertices.iter().map(|v| pos2(v.position[0], v.position[1]));
        Rect::from_points(&all.collect::<Vec<_>>()).intersect(self.clip)
    }

    /// Bounding rectangle of the triangles with a vertex in a range.
    fn around(&self, range: std::ops::Range<usize>) -> Rect {
        let mut out = Rect::NOTHING;
        for triangle in self.indices.chunks_exact(3) {
            if triangle.iter().any(|i| range.contains(&(*i as usize))) {
                triangle.iter().for_each(|i| out.extend_with(self.at(*i)));
            }
        }
        out.intersect(self.clip)
    }

    /// Rectangles in which two parts differ.
    fn differs_from(&self, before: &TexturedTriangles<'_>) -> Vec<Rect> {
        if self == before {
            return Vec::new();
        }
        if (self.clip, self.texture) != (before.clip, before.texture) {
            return vec![self.bounds(), before.bounds()];
        }
        let (a, b) = (self.vertices, before.vertices);
        let same = a.iter().zip(b).take_while(|(a, b)| a == b).count();
        let rest = a.len().min(b.len()) - same;
        let same_after = (0..rest)
            .take_while(|&i| a[a.len() - 1 - i] == b[b.len() - 1 - i])
            .count();
        if a.len() == b.len() && same == a.len() {
            // Equal corners, joined in another way.
            return vec![self.bounds(), before.bounds()];
        }
        vec![
            self.around(same..a.len() - same_after),
            before.around(same..b.len() - same_after),
        ]
    }

    /// The rectangle in which a share of the texture is shown, for a part that is one rectangle; else the bounds of the
    /// part.
    fn showing(&self, share: Option<Rect>) -> Rect {
        let all = self.bounds();
        let Some(share) = share.filter(|_| self.vertices.len() == 4) else {
            return all;
        };
        // Shown undistorted: each corner of the rectangle has its corner of the texture.
        let corner = |of: fn(f32, f32) -> f32, axis: usize| {
            let position = self.vertices.iter().map(|v| v.position[axis]).reduce(of);
            let at = self.vertices.iter().map(|v| v.at[axis]).reduce(of);
            (position.unwrap_or(0.0), at.unwrap_or(0.0))
        };
        let along = |axis: usize, part: f32| {
            let ((low, from), (high, to)) = (corner(f32::min, axis), corner(f32::max, axis));
            low + (part - from) / (to - from).max(1e-6) * (high - low)
        };
        let min = pos2(along(0, share.min.x), along(1, share.min.y));
        let max = pos2(along(0, share.max.x), along(1, share.max.y));
        // The neighbouring pixel takes part in the interpolation.
        Rect::from_min_max(min, max).expand(2.0).intersect(all)
    }
}

/// Joins rectangles that touch, then the nearest ones until at most [`MOST`] are left.
fn joined(rects: Vec<Rect>) -> Vec<Rect> {
    let mut out: Vec<Rect> = Vec::new();
    for mut rect in rects {
        while let Some(i) = out.iter().position(|r| r.intersects(rect)) {
            rect = rect.union(out.swap_remove(i));
        }
        out.push(rect);
    }
    while out.len() > MOST {
        let waste = |a: Rect, b: Rect| a.union(b).area() - a.area() - b.area();
        let mut best = (f32::INFINITY, 0, 1);
        for i in 0..out.len() {
            for j in i + 1..out.len() {
                let cost = waste(out[i], out[j]);
                if cost < best.0 {
                    best = (cost, i, j);
                }
            }
        }
        let other = out.swap_remove(best.2);
        out[best.1] = out[best.1].union(other);
    }
    out
}

#[cfg(test)]
mod tests {
    use egui::{Color32, Context, Mesh, vec2};

    use super::*;

    fn frame(shapes: &[(Rect, Color32)], texture: TextureId) -> Frame {
        let mut mesh = Mesh::with_texture(texture);
        for (rect, color) in shapes {
            mesh.add_rect_with_uv(*rect, Rect::from_min_max(Pos2::ZERO, pos2(1.0, 1.0)), *color);
        }
        Frame::new(vec![ClippedPrimitive {
            clip_rect: Rect::from_min_size(Pos2::ZERO, vec2(1000.0, 500.0)),
            primitive: Primitive::Mesh(mesh),
        }])
    }

    fn square(x: f32, y: f32) -> Rect {
        Rect::from_min_size(pos2(x, y), vec2(10.0, 10.0))
    }

    #[test]
    fn a_shape_that_changes_damages_its_own_place() {
        let texture = TextureId::default();
        let row = |highlit: usize, extra: bool| {
            let mut shapes: Vec<_> = (0..20)
                .map(|i| {
                    let color = if i == highlit { Color32::RED } else { Color32::BLUE };
                    (square(i as f32 * 40.0, 100.0), color)
                })
                .collect();
            if extra {
                shapes.insert(3, (square(500.0, 300.0), Color32::GREEN));
            }
            frame(&shapes, texture)
        };
        assert!(row(5, false).damage(&row(5, false), &[]).is_empty());
        assert_eq!(
            row(6, false).damage(&row(7, false), &[]),
            [square(240.0, 100.0).union(square(280.0, 100.0))]
        );
        // A shape is added or removed between others.
        assert_eq!(row(5, true).damage(&row(5, false), &[]), [square(500.0, 300.0)]);
        assert_eq!(row(5, false).damage(&row(5, true), &[]), [square(500.0, 300.0)]);
    }

    #[test]
    fn a_texture_that_was_written_damages_where_it_is_shown() {
        let (picture, other) = (TextureId::User(7), TextureId::User(8));
        let shown = Rect::from_min_size(pos2(100.0, 50.0), vec2(400.0, 200.0));
        let new = frame(&[(shown, Color32::WHITE)], picture);
        assert!(new.damage(&new, &[(other, None)]).is_empty());
        assert_eq!(new.damage(&new, &[(picture, None)]), [shown]);
        let share = Rect::from_min_max(pos2(0.5, 0.25), pos2(0.75, 0.5));
        let part = Rect::from_min_max(pos2(300.0, 100.0), pos2(400.0, 150.0));
        assert_eq!(new.damage(&new, &[(picture, Some(share))]), [part.expand(2.0)]);
    }

    #[test]
    fn rectangles_are_joined_until_they_are_few() {
        let apart: Vec<Rect> = (0..30)
            .map(|i| square(i as f32 * 30.0, (i % 3) as f32 * 100.0))
            .collect();
        let few = joined(apart.clone());
        assert!(few.len() <= MOST);
        assert!(apart.iter().all(|r| few.iter().any(|f| f.contains_rect(*r))));
        let touching = joined(vec![square(0.0, 0.0), square(5.0, 5.0), square(100.0, 0.0)]);
        assert_eq!(touching.len(), 2);
    }

    /// Outside the damage, the same triangles are drawn as before.
    #[test]
    fn a_window_is_undamaged_where_nothing_changed() {
        let ctx = Context::default();
        let draw = |name: &str, ticked: bool| {
            let mut ticked = ticked;
            let output = ctx.run_ui(egui::RawInput::default(), |ui| {
                ui.label("A line of text");
                ui.checkbox(&mut ticked, "A box");
                ui.add_space(60.0);
                ui.label(name);
            });
            Frame::new(ctx.tessellate(output.shapes, 1.0))
        };
        let _fonts = draw("warm up", false);
        let before = draw("name", false);
        assert!(draw("name", false).damage(&before, &[]).is_empty());
        let damage = draw("names", false).damage(&before, &[]);
        assert!(
            !damage.is_empty() && damage.iter().all(|r| r.min.y > 60.0),
            "{damage:?}"
        );
    }

    /// Every triangle that egui would draw is in the frame, with its own vertices.
    #[test]
    fn a_frame_holds_what_egui_tessellated() {
        let ctx = Context::default();
        let output = ctx.run_ui(egui::RawInput::default(), |ui| {
            ui.label("text");
            let rect = Rect::from_min_size(ui.max_rect().min, vec2(10.0, 10.0));
            ui.painter().rect_filled(rect, 0.0, Color32::RED);
        });
        let primitives = ctx.tessellate(output.shapes, 1.0);
        let meshes: Vec<_> = primitives
            .iter()
            .filter_map(|p| match &p.primitive {
                Primitive::Mesh(mesh) => Some(mesh.clone()),
                Primitive::Callback(_) => None,
            })
            .collect();
        let frame = Frame::new(primitives);
        assert!(!meshes.is_empty() && frame.parts.len() == meshes.len());
        for (i, mesh) in meshes.iter().enumerate() {
            let part = frame.part(i);
            assert_eq!((part.texture, part.indices), (mesh.texture_id, &mesh.indices[..]));
            for (ours, theirs) in part.vertices.iter().zip(&mesh.vertices) {
                assert_eq!(ours.position, [theirs.pos.x, theirs.pos.y]);
                assert_eq!(ours.color, theirs.color.to_array());
            }
        }
    }
}
