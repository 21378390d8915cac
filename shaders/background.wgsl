// A calm vertical gradient behind everything.

@vertex
fn vs_main(@builtin(vertex_index) index: u32) -> @builtin(position) vec4<f32> {
    // One triangle over the whole picture, at the far end of reversed depth.
    let xy = vec2<f32>(f32(index & 1u), f32(index >> 1u)) * 4.0 - 1.0;
    return vec4<f32>(xy, 0.0, 1.0);
}

@fragment
fn fs_main(@builtin(position) at: vec4<f32>) -> @location(0) vec4<f32> {
    // Half a step of noise keeps eight bits from showing bands.
    let noise = fract(52.9829189 * fract(dot(at.xy, vec2<f32>(0.06711056, 0.00583715)))) - 0.5;
    return vec4<f32>(background_at(at.y) + noise / 255.0, 1.0);
}

@fragment
fn fs_nothing() -> @location(0) vec4<f32> {
    return vec4<f32>(0.0);
}
