//! Drawing of the window's panels on a software rasteriser, by a shader of ours and only where they changed. The shapes
//! that egui is about to hand over are replaced by one callback, which updates a picture of the window and shows it.

use std::collections::HashMap;
use std::sync::{Arc, Mutex, PoisonError};

use egui::epaint::ClippedShape;
use egui::{Context, FullOutput, Id, Rect, Shape, TextureId, pos2};
use egui_wgpu::{CallbackResources, CallbackTrait, RenderState, ScreenDescriptor};

use super::damage::{Frame, Touched};
use crate::theme;
use viewport::ui_mesh::{UiMesh, UiPainter};

/// Installs the plugin between egui and its renderer, on a software rasteriser with a target that does not convert to
/// sRGB.
pub fn install(ctx: &Context, render_state: &RenderState) {
    let software = render_state.adapter.get_info().device_type == wgpu::DeviceType::Cpu;
    if software && !render_state.target_format.is_srgb() {
        let painter = UiPainter::new(&render_state.device, render_state.target_format);
        ctx.add_plugin(SoftwareUi {
            shared: Arc::new(Mutex::new(SharedPainter {
                painter,
                waiting: Damage::All,
            })),
            render_state: render_state.clone(),
            before: PreviousFrame::default(),
            touched: Vec::new(),
            sizes: HashMap::new(),
        });
    }
}

/// Notes that a texture which egui does not own was drawn into. `share` is the part of it, 0 to 1; `None`: all of it.
pub fn picture_changed(ctx: &Context, texture: TextureId, share: Option<Rect>) {
    ctx.data_mut(|data| {
        let list: &mut Arc<Mutex<Vec<Touched>>> = data.get_temp_mut_or_default(Id::unique("pictures drawn"));
        let mut list = list.lock().unwrap_or_else(PoisonError::into_inner);
        // On a graphics card no plugin takes these notes.
        if list.len() < 64 {
            list.push((texture, share));
        }
    });
}

/// Part of the window that has to be drawn again.
enum Damage {
    All,
    Parts(Vec<Rect>), // points
}

impl Damage {
    fn add(&mut self, other: Damage) {
        match (&mut *self, other) {
            (Self::Parts(these), Self::Parts(others)) => these.extend(others),
            (this, _) => *this = Self::All,
        }
    }
}

struct SharedPainter {
    painter: UiPainter,
    /// Damage that is not drawn yet.
    waiting: Damage,
}

/// The frame handed over last.
#[derive(Default)]
struct PreviousFrame {
    frame: Arc<Frame>,
    scale: f32,
    screen: Option<Rect>,
    clear: [f32; 4],
}

struct SoftwareUi {
    shared: Arc<Mutex<SharedPainter>>,
    render_state: RenderState,
    before: PreviousFrame,
    touched: Vec<Touched>,
    sizes: HashMap<TextureId, [usize; 2]>, // of egui's textures
}

impl SoftwareUi {
    /// Notes the textures that were written to. Returns false if the texture of all text was replaced.
    fn note_textures(&mut self, ctx: &Context, output: &FullOutput) -> bool {
        let pictures: Arc<Mutex<Vec<Touched>>> = ctx.data_mut(|data| {
            data.get_temp_mut_or_default::<Arc<Mutex<Vec<Touched>>>>(Id::unique("pictures drawn"))
                .clone()
        });
        let mut pictures = pictures.lock().unwrap_or_else(PoisonError::into_inner);
        self.touched.append(&mut pictures);
        let mut fonts_stay = true;
        let written = output.textures_delta.set.iter();
        for (id, delta) in written.flat_map(|(id, deltas)| deltas.iter().map(move |d| (id, d))) {
            match (*id == TextureId::default(), delta.pos) {
                // New letters were added beside the old ones.
                (true, Some(_)) => {}
                (true, None) => fonts_stay = false,
                (false, None) => {
                    self.sizes.insert(*id, delta.image.size());
                    self.touched.push((*id, None));
                }
                (false, Some(at)) => {
                    let size = self.sizes.get(id).copied();
                    let part = size.map(|size| part_of(at, delta.image.size(), size));
                    self.touched.push((*id, part));
                }
            }
        }
        fonts_stay
    }
}

impl egui::Plugin for SoftwareUi {
    fn debug_name(&self) -> &'static str {
        "software ui"
    }

    fn output_hook(&mut self, ctx: &Context, output: &mut FullOutput) {
        let callback = |s: &ClippedShape| matches!(s.shape, Shape::Callback(_));
        let fonts_stay = self.note_textures(ctx, output);
        let mut shared = self.shared.lock().unwrap_or_else(PoisonError::into_inner);
        if !fonts_stay {
            shared.waiting = Damage::All;
        }
        if output.shapes.is_empty() || output.shapes.iter().any(callback) {
            return;
        }
        let (scale, screen) = (output.pixels_per_point, ctx.viewport_rect());
        let frame = Arc::new(Frame::new(
            ctx.tessellate(std::mem::take(&mut output.shapes), scale),
        ));
        let clear = theme::panel().to_normalized_gamma_f32();
        let before = &self.before;
        let same_window = (before.scale, before.screen, before.clear) == (scale, Some(screen), clear);
        shared.waiting.add(match same_window {
            true => Damage::Parts(frame.damage(&before.frame, &self.touched)),
            false => Damage::All,
        });
        self.touched.clear();
        self.before = PreviousFrame {
            frame: frame.clone(),
            scale,
            screen: Some(screen),
            clear,
        };
        let all = UiPaintCallback {
            frame,
            clear,
            shared: self.shared.clone(),
            render_state: self.render_state.clone(),
        };
        output.shapes = vec![ClippedShape {
            clip_rect: Rect::EVERYTHING,
            transform_after_tessellation: egui::emath::TSTransform::IDENTITY,
            shape: Shape::Callback(egui_wgpu::Callback::new_paint_callback(screen, all)),
        }];
    }
}

/// The pixels of a rectangle, as egui rounds them: left, top, width, height; `None` if it is empty.
fn scissor(rect: Rect, scale: f32, size: [u32; 2]) -> Option<[u32; 4]> {
    let pixel = |v: f32, most: u32| ((v * scale).round().max(0.0) as u32).min(most);
    let (left, top) = (pixel(rect.min.x, size[0]), pixel(rect.min.y, size[1]));
    let (right, bottom) = (pixel(rect.max.x, size[0]), pixel(rect.max.y, size[1]));
    (right > left && bottom > top).then(|| [left, top, right - left, bottom - top])
}

/// The intersection of two rectangles of pixels; `None` if it is empty.
fn common(a: [u32; 4], b: [u32; 4]) -> Option<[u32; 4]> {
    let low = [0, 1].map(|i| a[i].max(b[i]));
    let high = [0, 1].map(|i| (a[i] + a[i + 2]).min(b[i] + b[i + 2]));
    (high[0] > low[0] && high[1] > low[1]).then(|| [low[0], low[1], high[0] - low[0], high[1] - low[1]])
}

struct UiPaintCallback {
    frame: Arc<Frame>,
    clear: [f32; 4],
    shared: Arc<Mutex<SharedPainter>>,
    render_state: RenderState,
}

impl CallbackTrait for UiPaintCallback {
    fn prepare(
        &self,
        device: &wgpu::Device,
        queue: &wgpu::Queue,
        screen: &ScreenDescriptor,
        _encoder: &mut wgpu::CommandEncoder,
        _resources: &mut CallbackResources,
    ) -> Vec<wgpu::CommandBuffer> {
        let size = screen.size_in_pixels.map(|s| s as f32 / screen.pixels_per_point);
        let mut shared = self.shared.lock().unwrap_or_else(PoisonError::into_inner);
        let frame = &self.frame;
        let painter = &mut shared.painter;
        painter.upload(device, queue, size, self.clear, (&frame.vertices, &frame.indices));
        if painter.fit(device, screen.size_in_pixels) {
            shared.waiting = Damage::All;
        }
        Vec::new()
    }

    fn paint(
        &self,
        info: egui::PaintCallbackInfo,
        pass: &mut wgpu::RenderPass<'static>,
        _resources: &CallbackResources,
    ) {
        let mut shared = self.shared.lock().unwrap_or_else(PoisonError::into_inner);
        let (size, scale) = (info.screen_size_px, info.pixels_per_point);
        let damage: Vec<[u32; 4]> = match std::mem::replace(&mut shared.waiting, Damage::Parts(Vec::new())) {
            Damage::All => vec![[0, 0, size[0], size[1]]],
            // Rounded outward to whole pixels, because shapes are smooth at their edges.
            Damage::Parts(rects) => rects
                .into_iter()
                .filter_map(|r| scissor(r.expand(1.0 / scale), scale, size))
                .collect(),
        };
        // The window holds the same lock for reading while it draws.
        let renderer = self.render_state.renderer.read();
        let frame = &self.frame;
        let placed: Vec<_> = (0..frame.parts.len())
            .filter_map(|i| {
                let (clip, texture, mesh) = &frame.parts[i];
                let clip = scissor(*clip, scale, size)?;
                let covered = scissor(frame.bounds(i).expand(1.0 / scale), scale, size)?;
                let group = renderer.texture(texture).map(|t| &t.bind_group)?;
                Some((mesh, clip, covered, group))
            })
            .collect();
        let (device, queue) = (&self.render_state.device, &self.render_state.queue);
        shared.painter.draw(device, queue, &damage, |rect| {
            placed
                .iter()
                .filter_map(|(mesh, clip, covered, group)| {
                    common(*covered, rect)?;
                    let scissor = common(*clip, rect)?;
                    let mesh = UiMesh {
                        scissor,
                        ..(*mesh).clone()
                    };
                    Some((mesh, *group))
                })
                .collect()
        });
        shared.painter.show(pass, size);
    }
}

/// Texels of a texture as shares of its width and height, with one more on each side, since they may be averaged.
fn part_of(at: [usize; 2], part: [usize; 2], size: [usize; 2]) -> Rect {
    let low = at.map(|v| v.saturating_sub(1));
    let high = [0, 1].map(|i| (at[i] + part[i] + 1).min(size[i]));
    let [x, y, w, h] = [low[0], low[1], high[0] - low[0], high[1] - low[1]].map(|v| v as u32);
    share([x, y, w, h], size.map(|s| s as u32))
}

/// Pixels of a picture of `size` as shares of its width and height.
pub fn share(of_px: [u32; 4], size: [u32; 2]) -> Rect {
    let part = |v: u32, all: u32| v as f32 / all.max(1) as f32;
    let [x, y, w, h] = of_px;
    Rect::from_min_max(
        pos2(part(x, size[0]), part(y, size[1])),
        pos2(part(x + w, size[0]), part(y + h, size[1])),
    )
}

#[cfg(test)]
mod tests {
    use egui::vec2;

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
        assert_eq!(common([0, 0, 10, 10], [5, 6, 10, 10]), Some([5, 6, 5, 4]));
        assert_eq!(common([0, 0, 10, 10], [10, 0, 5, 5]), None);
    }
}
