//! A graphics device without a window: for pictures, tests and the command line.

use super::ViewportError;
use super::error::one_line;

/// Any adapter, hardware first, software allowed, with its device and queue.
///
/// Asks for the downlevel limits only, raised to the texture size that the adapter has, so that
/// what works here works in a window too. Honours `WGPU_BACKEND`.
pub fn headless_device() -> Result<(wgpu::AdapterInfo, wgpu::Device, wgpu::Queue), ViewportError> {
    pollster::block_on(request())
}

async fn request() -> Result<(wgpu::AdapterInfo, wgpu::Device, wgpu::Queue), ViewportError> {
    let mut descriptor = wgpu::InstanceDescriptor::new_without_display_handle_from_env();
    if std::env::var_os("WGPU_BACKEND").is_none() {
        // GL needs a display on many systems; it is asked only if nothing better is there.
        descriptor.backends = wgpu::Backends::PRIMARY;
    }
    let adapter = match adapter_of(descriptor).await {
        Ok(adapter) => adapter,
        Err(first) => {
            let descriptor = wgpu::InstanceDescriptor::new_without_display_handle_from_env();
            adapter_of(descriptor)
                .await
                .map_err(|_| ViewportError::NoAdapter(first))?
        }
    };
    let info = adapter.get_info();
    let limits = wgpu::Limits::downlevel_defaults().using_resolution(adapter.limits());
    let (device, queue) = adapter
        .request_device(&wgpu::DeviceDescriptor {
            label: Some("headless"),
            required_limits: limits,
            ..Default::default()
        })
        .await
        .map_err(|e| ViewportError::NoDevice {
            adapter: info.name.clone(),
            reason: one_line(&e),
        })?;
    Ok((info, device, queue))
}

async fn adapter_of(descriptor: wgpu::InstanceDescriptor) -> Result<wgpu::Adapter, String> {
    let instance = wgpu::Instance::new(descriptor);
    instance
        .request_adapter(&wgpu::RequestAdapterOptions {
            power_preference: wgpu::PowerPreference::HighPerformance,
            force_fallback_adapter: false,
            compatible_surface: None,
            apply_limit_buckets: false,
        })
        .await
        .map_err(|e| one_line(&e))
}
