//! Every shader through naga: it parses, it validates, its uniforms are as large as ours.

use naga::proc::Layouter;
use naga::valid::{Capabilities, ValidationFlags, Validator};
use viewport::shaders::{COMPUTE_SHADERS, SHADERS, Shader, appearance};
use viewport::{APPEARANCE_UNIFORM_BYTES, FRAME_UNIFORM_BYTES, SPLAT_UNIFORM_BYTES};

#[test]
fn every_shader_file_is_listed_and_validates() {
    let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/shaders");
    let mut files: Vec<String> = std::fs::read_dir(folder)
        .expect("the shaders are there")
        .filter_map(|entry| {
            let name = entry.expect("a readable folder").file_name().into_string();
            let name = name.expect("plain names");
            name.strip_suffix(".wgsl").map(str::to_owned)
        })
        .collect();
    files.sort();
    let mut listed: Vec<&str> = all().map(|s| s.name).collect();
    listed.sort_unstable();
    assert_eq!(files, listed);

    for shader in all() {
        let module = naga::front::wgsl::parse_str(shader.source)
            .unwrap_or_else(|e| panic!("{}: {}", shader.name, e.emit_to_string(shader.source)));
        // No capability beyond the core: it must run on every backend.
        let mut validator = Validator::new(ValidationFlags::all(), Capabilities::empty());
        if let Err(e) = validator.validate(&module) {
            panic!("{}: {}", shader.name, e.emit_to_string(shader.source));
        }
        let entries: Vec<&str> = module.entry_points.iter().map(|e| e.name.as_str()).collect();
        if computes(&shader) {
            let compute = |e: &naga::EntryPoint| e.stage == naga::ShaderStage::Compute;
            assert!(!entries.is_empty() && module.entry_points.iter().all(compute));
            downlevel(&shader, &module);
        } else {
            assert!(
                entries.contains(&"vs_main") && entries.contains(&"fs_main"),
                "{}",
                shader.name
            );
        }
    }
}

fn all() -> impl Iterator<Item = Shader> {
    SHADERS
        .iter()
        .chain(COMPUTE_SHADERS)
        .copied()
        .chain([appearance()])
}

fn computes(shader: &Shader) -> bool {
    COMPUTE_SHADERS.iter().any(|s| s.name == shader.name) || shader.name == "appearance"
}

/// A compute shader keeps to what the smallest devices offer, entry point by entry point: four
/// storage buffers, 256 invocations, 16,352 bytes for a workgroup.
fn downlevel(shader: &Shader, module: &naga::Module) {
    let mut validator = Validator::new(ValidationFlags::all(), Capabilities::empty());
    let info = validator.validate(module).expect("checked by the caller");
    let mut layouter = Layouter::default();
    layouter.update(module.to_ctx()).expect("sized types");
    for (index, entry) in module.entry_points.iter().enumerate() {
        let uses = info.get_entry_point(index);
        let of = |wanted: fn(naga::AddressSpace) -> bool| {
            let used = module.global_variables.iter();
            used.filter(move |(handle, v)| wanted(v.space) && !uses[*handle].is_empty())
        };
        let buffers = of(|s| matches!(s, naga::AddressSpace::Storage { .. })).count();
        let bytes: u32 = of(|s| s == naga::AddressSpace::WorkGroup)
            .map(|(_, v)| layouter[v.ty].size)
            .sum();
        let invocations: u32 = entry.workgroup_size.iter().product();
        println!("{} {}: {buffers} buffers, {bytes} bytes", shader.name, entry.name);
        assert!((1..=4).contains(&buffers) && bytes <= 16_352 && invocations <= 256);
    }
}

#[test]
fn uniforms_are_as_large_here_as_there() {
    for shader in all() {
        let module = naga::front::wgsl::parse_str(shader.source).expect("checked above");
        let mut layouter = Layouter::default();
        layouter.update(module.to_ctx()).expect("sized types");
        let (name, bytes) = match computes(&shader) {
            true if shader.name == "appearance" => ("View", APPEARANCE_UNIFORM_BYTES),
            true => ("Batch", SPLAT_UNIFORM_BYTES),
            // Two numbers, as many to fill up, a colour; `viewport/ui_mesh.rs` binds so many bytes.
            false if shader.name == "ui_mesh" => ("Screen", 32),
            false => ("Frame", FRAME_UNIFORM_BYTES),
        };
        let (handle, _) = module
            .types
            .iter()
            .find(|(_, t)| t.name.as_deref() == Some(name))
            .expect("the shared part declares it");
        assert_eq!(layouter[handle].size as usize, bytes, "{}", shader.name);
    }
}
