// LiDAR returns as small squares that face the viewer.

struct Point {
    @builtin(position) clip: vec4<f32>,
    @location(0) @interpolate(flat) color: vec3<f32>,
}

@vertex
fn vs_main(
    @location(0) p: vec3<f32>,
    @location(1) color: vec4<f32>,
    @builtin(vertex_index) index: u32,
) -> Point {
    let at = index & 3u;
    let corner = vec2<f32>(select(-1.0, 1.0, at == 1u || at == 2u), select(-1.0, 1.0, at > 1u));
    let pixel = pixel_m(p);
    // As large as asked on screen, but never larger than a quarter of a voxel when near.
    let size_px = clamp(0.10 / pixel, 0.6 * frame.screen.w, 2.0 * frame.screen.w);
    // Returns lie on voxel faces: toward the viewer by their own size, so that they stay whole.
    let lift = min(0.04 + 1.5 * size_px * pixel, 0.5 * view_depth(p) + 0.5 * frame.eye.w);
    var clip = frame.clip_from_ego * vec4<f32>(p + toward_eye(p) * lift, 1.0);
    clip += vec4<f32>(corner * size_px / frame.screen.xy * clip.w, 0.0, 0.0);
    var out: Point;
    out.clip = clip;
    out.color = color.rgb;
    return out;
}

@fragment
fn fs_main(in: Point) -> @location(0) vec4<f32> {
    return vec4<f32>(in.color, 1.0);
}
