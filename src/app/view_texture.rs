//! The texture by which egui shows what the 3D viewport drew.

use super::view3d::Gpu;

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
