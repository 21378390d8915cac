//! On a software rasteriser the window's panels are drawn by a shader of ours: the shapes that egui is about to hand over
//! are replaced by one callback that draws them all.

use std::sync::{Arc, Mutex, PoisonError};

use egui::epaint::{ClippedPrimitive, ClippedShape, Primitive};
use egui::{Context, FullOutput, Rect, Shape, TextureId};
use egui_wgpu::{CallbackResources, CallbackTrait, RenderState, ScreenDescriptor};

use crate::viewport::panels::{PanelMesh, PanelVertex, Panels};

/// Puts itself between egui and its renderer. Only where it pays, and where the target is not sRGB-converting.
pub fn install(ctx: &Context, render_state: &RenderState) {
    let software = render_state.adapter.get_info().device_type == wgpu::DeviceType::Cpu;
    if software && !render_state.target_format.is_srgb() {
        let panels = Panels::new(&render_state.device, render_state.target_format);
        ctx.add_plugin(SoftwareUi {
            panels: Arc::new(Mutex::new(panels)),
            renderer: render_state.renderer.clone(),
        });
    }
}

struct SoftwareUi {
    panels: Arc<Mutex<Panels>>,
    renderer: Arc<egui::mutex::RwLock<egui_wgpu::Renderer>>,
}

impl egui::Plugin for SoftwareUi {
    fn debug_name(&self) -> &'static str {
        "software ui"
    }

    fn output_hook(&mut self, ctx: &Context, output: &mut FullOutput) {
        let callback = |s: &ClippedShape| matches!(s.shape, Shape::Callback(_));
        if output.shapes.is_empty() || output.shapes.iter().any(callback) {
            return;
        }
        let scale = output.pixels_per_point;
        let screen = ctx.viewport_rect();
        let frame = Frame::new(ctx.tessellate(std::mem::take(&mut output.shapes), scale));
        let all = Painted {
            frame,
            panels: self.panels.clone(),
            renderer: self.renderer.clone(),
        };
        output.shapes = vec![ClippedShape {
            clip_rect: Rect::EVERYTHING,
            transform_after_tessellation: egui::emath::TSTransform::IDENTITY,
            shape: Shape::Callback(egui_wgpu::Callback::new_paint_callback(screen, all)),
        }];
    }
}

/// All triangles of a frame.
#[derive(Default)]
struct Frame {
    vertices: Vec<PanelVertex>,
    indices: Vec<u32>,
    parts: Vec<(Rect, TextureId, PanelMesh)>,
}

impl Frame {
    fn new(primitives: Vec<ClippedPrimitive>) -> Self {
        let mut out = Self::default();
        for ClippedPrimitive { clip_rect, primitive } in primitives {
            let Primitive::Mesh(mesh) = primitive else {
                continue;
            };
            let (first, base_vertex) = (out.indices.len() as u32, out.vertices.len() as i32);
            out.vertices.extend(mesh.vertices.iter().map(|v| PanelVertex {
                position: [v.pos.x, v.pos.y],
                at: [v.uv.x, v.uv.y],
                color: v.color.to_array(),
            }));
            out.indices.extend_from_slice(&mesh.indices);
            let mesh_of = PanelMesh {
                scissor: [0; 4],
                indices: first..out.indices.len() as u32,
                base_vertex,
            };
            out.parts.push((clip_rect, mesh.texture_id, mesh_of));
        }
        out
    }
}

/// The pixels of a rectangle, as egui rounds them: left, top, width, height; none if it is empty.
fn scissor(rect: Rect, scale: f32, size: [u32; 2]) -> Option<[u32; 4]> {
    let pixel = |v: f32, most: u32| ((v * scale).round().max(0.0) as u32).min(most);
    let (left, top) = (pixel(rect.min.x, size[0]), pixel(rect.min.y, size[1]));
    let (right, bottom) = (pixel(rect.max.x, size[0]), pixel(rect.max.y, size[1]));
    (right > left && bottom > top).then(|| [left, top, right - left, bottom - top])
}

struct Painted {
    frame: Frame,
    panels: Arc<Mutex<Panels>>,
    renderer: Arc<egui::mutex::RwLock<egui_wgpu::Renderer>>,
}

impl CallbackTrait for Painted {
    fn prepare(
        &self,
        device: &wgpu::Device,
        queue: &wgpu::Queue,
        screen: &ScreenDescriptor,
        _encoder: &mut wgpu::CommandEncoder,
        _resources: &mut CallbackResources,
    ) -> Vec<wgpu::CommandBuffer> {
        let size = screen.size_in_pixels.map(|s| s as f32 / screen.pixels_per_point);
        let mut panels = self.panels.lock().unwrap_or_else(PoisonError::into_inner);
        panels.upload(device, queue, size, &self.frame.vertices, &self.frame.indices);
        Vec::new()
    }

    fn paint(
        &self,
        info: egui::PaintCallbackInfo,
        pass: &mut wgpu::RenderPass<'static>,
        _resources: &CallbackResources,
    ) {
        let panels = self.panels.lock().unwrap_or_else(PoisonError::into_inner);
        // The window holds the same lock for reading while it draws.
        let renderer = self.renderer.read();
        let cut: Vec<(PanelMesh, TextureId)> = self
            .frame
            .parts
            .iter()
            .filter_map(|(rect, texture, mesh)| {
                let scissor = scissor(*rect, info.pixels_per_point, info.screen_size_px)?;
                Some((
                    PanelMesh {
                        scissor,
                        ..mesh.clone()
                    },
                    *texture,
                ))
            })
            .collect();
        let parts = cut.iter().map(|(mesh, texture)| {
            let group = renderer.texture(texture).map(|t| &t.bind_group);
            (mesh, group)
        });
        panels.draw(pass, parts);
    }
}

#[cfg(test)]
mod tests {
    use egui::{Color32, pos2, vec2};

    use super::*;

    #[test]
    fn rectangles_are_cut_to_the_window() {
        let rect = |x: f32, y: f32, w: f32, h: f32| Rect::from_min_size(pos2(x, y), vec2(w, h));
        assert_eq!(
            scissor(rect(1.0, 2.0, 3.0, 4.0), 2.0, [100, 100]),
            Some([2, 4, 6, 8])
        );
        assert_eq!(scissor(Rect::EVERYTHING, 1.0, [30, 20]), Some([0, 0, 30, 20]));
        assert_eq!(
            scissor(rect(-5.0, -5.0, 8.0, 8.0), 1.0, [30, 20]),
            Some([0, 0, 3, 3])
        );
        assert_eq!(scissor(rect(40.0, 0.0, 5.0, 5.0), 1.0, [30, 20]), None);
        assert_eq!(scissor(Rect::NOTHING, 1.0, [30, 20]), None);
    }

    /// Every triangle that egui would draw is in the frame, with its own vertices.
    #[test]
    fn a_frame_holds_what_egui_tessellated() {
        let ctx = Context::default();
        let output = ctx.run_ui(egui::RawInput::default(), |ui| {
            ui.label("text");
            ui.painter().rect_filled(rect_of(ui), 0.0, Color32::RED);
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
        for (mesh, (_, texture, part)) in meshes.iter().zip(&frame.parts) {
            assert_eq!(*texture, mesh.texture_id);
            let indices = &frame.indices[part.indices.start as usize..part.indices.end as usize];
            for (ours, theirs) in indices.iter().zip(&mesh.indices) {
                let vertex = frame.vertices[(*ours as i32 + part.base_vertex) as usize];
                let of = mesh.vertices[*theirs as usize];
                assert_eq!(vertex.position, [of.pos.x, of.pos.y]);
                assert_eq!(vertex.color, of.color.to_array());
            }
            assert_eq!(indices.len(), mesh.indices.len());
        }
    }

    fn rect_of(ui: &egui::Ui) -> Rect {
        Rect::from_min_size(ui.max_rect().min, vec2(10.0, 10.0))
    }
}
