//! Every shader through naga: it parses, it validates, its uniforms are as large as ours.

use naga::proc::Layouter;
use naga::valid::{Capabilities, ValidationFlags, Validator};
use sceneloom::viewport::FRAME_UNIFORM_BYTES;
use sceneloom::viewport::shaders::SHADERS;

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
    let listed: Vec<&str> = SHADERS.iter().map(|s| s.name).collect();
    assert_eq!(files, listed);

    for shader in SHADERS {
        let module = naga::front::wgsl::parse_str(shader.source)
            .unwrap_or_else(|e| panic!("{}: {}", shader.name, e.emit_to_string(shader.source)));
        // No capability beyond the core: it must run on every backend.
        let mut validator = Validator::new(ValidationFlags::all(), Capabilities::empty());
        if let Err(e) = validator.validate(&module) {
            panic!("{}: {}", shader.name, e.emit_to_string(shader.source));
        }
        let entries: Vec<&str> = module.entry_points.iter().map(|e| e.name.as_str()).collect();
        assert!(
            entries.contains(&"vs_main") && entries.contains(&"fs_main"),
            "{}",
            shader.name
        );
    }
}

#[test]
fn uniforms_are_as_large_here_as_there() {
    for shader in SHADERS {
        let module = naga::front::wgsl::parse_str(shader.source).expect("checked above");
        let mut layouter = Layouter::default();
        layouter.update(module.to_ctx()).expect("sized types");
        let (handle, _) = module
            .types
            .iter()
            .find(|(_, t)| t.name.as_deref() == Some("Frame"))
            .expect("the shared part declares Frame");
        assert_eq!(
            layouter[handle].size as usize, FRAME_UNIFORM_BYTES,
            "{}",
            shader.name
        );
    }
}
