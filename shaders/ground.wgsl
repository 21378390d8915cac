// The bird's-eye-view layout as a thin plane on the ground.

struct Plane {
    @builtin(position) clip: vec4<f32>,
    @location(0) p: vec3<f32>,
}

@vertex
fn vs_main(@builtin(vertex_index) index: u32) -> Plane {
    let corner = vec2<f32>(f32(index & 1u), f32(index >> 1u)) * frame.grid_size.xy * frame.grid_size.w + frame.grid_min.xy;
    var out: Plane;
    out.p = vec3<f32>(corner, frame.ground.x);
    out.clip = frame.clip_from_ego * vec4<f32>(out.p, 1.0);
    return out;
}

@fragment
fn fs_main(in: Plane) -> @location(0) vec4<f32> {
    let texel = texel_at(voxel_units(in.p).xy, textureDimensions(layout_plane));
    let color = textureLoad(layout_plane, texel, 0);
    let alpha = color.a * frame.toggles.w;
    if alpha == 0.0 {
        discard;
    }
    return vec4<f32>(with_fog(color.rgb, in.p, in.clip.y) * alpha, alpha);
}
