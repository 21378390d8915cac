//! Textures by which egui shows the 3D view.

use egui::{Color32, Rect, TextureId, Ui, pos2};

use super::view3d::Gpu;
use widgets::theme;

/// Puts textures over one another into a rectangle, and a note below them.
pub(super) fn put(ui: &Ui, rect: Rect, textures: impl Iterator<Item = TextureId>, note: Option<&str>) {
    let whole = Rect::from_min_max(pos2(0.0, 0.0), pos2(1.0, 1.0));
    for texture in textures {
        ui.painter().image(texture, rect, whole, Color32::WHITE);
    }
    if let Some(text) = note {
        let (at, font) = (
            rect.left_bottom() + egui::vec2(8.0, -8.0),
            egui::FontId::proportional(12.0),
        );
        ui.painter()
            .text(at, egui::Align2::LEFT_BOTTOM, text, font, theme::warn());
    }
}

/// The texture of the picture in egui; registered again if the viewport made a new one.
pub(super) fn register(gpu: &mut Gpu, samples: u32) -> egui::TextureId {
    let size = gpu.viewport.size();
    let device = &gpu.render_state.device;
    let mut renderer = gpu.render_state.renderer.write();
    let (view, filter) = (gpu.viewport.color_view(), wgpu::FilterMode::Linear);
    let id = match gpu.texture {
        Some((id, of, with)) if of == size && with == samples => id,
        Some((id, ..)) => {
            renderer.update_egui_texture_from_wgpu_texture(device, view, filter, id);
            id
        }
        None => renderer.register_native_texture(device, view, filter),
    };
    gpu.texture = Some((id, size, samples));
    id
}
