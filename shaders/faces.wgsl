// Flat translucent rectangles: brush cells with a bright rim, fills of selected boxes, soft shadows.

struct Face {
    @builtin(position) clip: vec4<f32>,
    @location(0) @interpolate(flat) color: vec4<f32>,
    // xy: 0 to 1 over the rectangle; z: style, 0 plain, 1 rim, 2 soft blob.
    @location(1) uv: vec3<f32>,
    @location(2) p: vec3<f32>,
}

@vertex
fn vs_main(
    @location(0) p_style: vec4<f32>,
    @location(1) color: vec4<f32>,
    @builtin(vertex_index) index: u32,
) -> Face {
    let at = index & 3u;
    var out: Face;
    out.uv = vec3<f32>(f32(at == 1u || at == 2u), f32(at >> 1u), p_style.w);
    out.color = color;
    out.p = p_style.xyz;
    let lift = toward_eye(out.p) * min(0.015 + 0.5 * pixel_m(out.p), 0.5 * view_depth(out.p) + 0.5 * frame.eye.w);
    out.clip = frame.clip_from_ego * vec4<f32>(out.p + lift, 1.0);
    return out;
}

@fragment
fn fs_main(in: Face) -> @location(0) vec4<f32> {
    var alpha = in.color.a;
    if in.uv.z > 1.5 {
        let d = abs(in.uv.xy * 2.0 - 1.0);
        let inside = (1.0 - smoothstep(vec2<f32>(0.45), vec2<f32>(1.0), d));
        alpha *= inside.x * inside.y;
    } else if in.uv.z > 0.5 {
        let to_rim = min(min(in.uv.x, 1.0 - in.uv.x), min(in.uv.y, 1.0 - in.uv.y));
        let width = max(0.05, 1.2 * pixel_m(in.p) / frame.grid_size.w);
        alpha = mix(min(1.0, alpha * 2.6), alpha, smoothstep(0.0, width, to_rim));
    }
    return vec4<f32>(in.color.rgb * alpha, alpha);
}
