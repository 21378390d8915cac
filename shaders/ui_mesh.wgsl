// Meshes of the window's UI (areas, texts, pictures): what egui's own shader draws, without the branches for other filters and
// dithering, which a software rasteriser computes although no pixel takes them (six times the work).

struct Screen {
    size_points: vec2<f32>,
    padding: vec2<f32>,
    // Gamma-encoded: what is behind everything.
    clear: vec4<f32>,
}

@group(0) @binding(0) var<uniform> screen: Screen;
@group(1) @binding(0) var picture: texture_2d<f32>;
@group(1) @binding(1) var filtered: sampler;

struct Corner {
    @builtin(position) position: vec4<f32>,
    @location(0) at: vec2<f32>,
    @location(1) color: vec4<f32>, // premultiplied, gamma-encoded, as the target
}

@vertex
fn vs_main(
    @location(0) position: vec2<f32>,
    @location(1) at: vec2<f32>,
    @location(2) color: u32,
) -> Corner {
    let part = position / screen.size_points;
    var out: Corner;
    out.position = vec4<f32>(2.0 * part.x - 1.0, 1.0 - 2.0 * part.y, 0.0, 1.0);
    out.at = at;
    out.color = unpack4x8unorm(color);
    return out;
}

@fragment
fn fs_main(in: Corner) -> @location(0) vec4<f32> {
    return in.color * textureSample(picture, filtered, in.at);
}

// One triangle over all of the target.
@vertex
fn vs_all(@builtin(vertex_index) index: u32) -> @builtin(position) vec4<f32> {
    return vec4<f32>(vec2<f32>(f32(index & 1u), f32(index >> 1u)) * 4.0 - 1.0, 0.0, 1.0);
}

@fragment
fn fs_wipe() -> @location(0) vec4<f32> {
    return screen.clear;
}

@fragment
fn fs_copy(@builtin(position) at: vec4<f32>) -> @location(0) vec4<f32> {
    return textureLoad(picture, vec2<i32>(at.xy), 0);
}
