//! The compute pipelines of the splat renderer, and the limits that a device must have to run them.

use super::SplatError;
use crate::error::one_line;
use crate::shaders::COMPUTE_SHADERS;

/// Items that one workgroup of the sort handles, as in the shader.
pub(super) const SORT_BLOCK: u32 = 1024;
/// Threads of the other one-dimensional workgroups.
pub(super) const GROUP: u32 = 256;
/// Bits per pass of the sort.
pub(super) const DIGIT_BITS: u32 = 4;

/// One per entry point.
#[derive(Debug)]
pub(super) struct Pipelines {
    pub project: wgpu::ComputePipeline,
    pub count_digits: wgpu::ComputePipeline,
    pub scan: wgpu::ComputePipeline,
    pub scatter: wgpu::ComputePipeline,
    pub place: wgpu::ComputePipeline,
    pub emit: wgpu::ComputePipeline,
    pub mark: wgpu::ComputePipeline,
    pub blend: wgpu::ComputePipeline,
}

impl Pipelines {
    /// Errors if the device is too small for the shaders or refuses them.
    pub fn new(device: &wgpu::Device) -> Result<Pipelines, SplatError> {
        let limits = device.limits();
        for (limit, has, needs) in [
            (
                "max_storage_buffers_per_shader_stage",
                limits.max_storage_buffers_per_shader_stage,
                4,
            ),
            (
                "max_compute_workgroup_storage_size",
                limits.max_compute_workgroup_storage_size,
                10 << 10,
            ),
            (
                "max_compute_invocations_per_workgroup",
                limits.max_compute_invocations_per_workgroup,
                GROUP,
            ),
            (
                "max_compute_workgroup_size_x",
                limits.max_compute_workgroup_size_x,
                GROUP,
            ),
            (
                "max_compute_workgroup_size_y",
                limits.max_compute_workgroup_size_y,
                16,
            ),
            (
                "max_uniform_buffer_binding_size",
                limits
                    .max_uniform_buffer_binding_size
                    .try_into()
                    .unwrap_or(u32::MAX),
                super::SPLAT_UNIFORM_BYTES as u32,
            ),
        ] {
            if has < needs {
                return Err(SplatError::Unable {
                    adapter: device.adapter_info().name,
                    limit,
                    has: has.into(),
                    needs: needs.into(),
                });
            }
        }
        checked(device, || Pipelines::build(device))
    }

    fn build(device: &wgpu::Device) -> Pipelines {
        let modules = COMPUTE_SHADERS.iter().map(|shader| {
            let module = device.create_shader_module(wgpu::ShaderModuleDescriptor {
                label: Some(shader.name),
                source: wgpu::ShaderSource::Wgsl(shader.source.into()),
            });
            (shader.name, module)
        });
        let modules: std::collections::BTreeMap<_, _> = modules.collect();
        let pipeline = |name: &str, entry: &str| {
            device.create_compute_pipeline(&wgpu::ComputePipelineDescriptor {
                label: Some(entry),
                layout: None,
                module: &modules[name],
                entry_point: Some(entry),
                compilation_options: Default::default(),
                cache: None,
            })
        };
        Pipelines {
            project: pipeline("splat_project", "main"),
            count_digits: pipeline("splat_sort", "count_digits"),
            scan: pipeline("splat_sort", "scan"),
            scatter: pipeline("splat_sort", "scatter"),
            place: pipeline("splat_tiles", "place"),
            emit: pipeline("splat_tiles", "emit"),
            mark: pipeline("splat_tiles", "mark"),
            blend: pipeline("splat_blend", "main"),
        }
    }
}

/// Runs `work` and turns an error of the device into one of the renderer.
pub(crate) fn checked<T>(device: &wgpu::Device, work: impl FnOnce() -> T) -> Result<T, SplatError> {
    let memory = device.push_error_scope(wgpu::ErrorFilter::OutOfMemory);
    let validation = device.push_error_scope(wgpu::ErrorFilter::Validation);
    let internal = device.push_error_scope(wgpu::ErrorFilter::Internal);
    let made = work();
    let errors = [
        pollster::block_on(internal.pop()),
        pollster::block_on(validation.pop()),
        pollster::block_on(memory.pop()),
    ];
    match errors.into_iter().flatten().next() {
        None => Ok(made),
        Some(e) => Err(SplatError::Device(one_line(&e))),
    }
}
