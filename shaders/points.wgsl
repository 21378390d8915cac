// LiDAR returns as small discs that face the viewer, each cut out of one triangle: half the work of a
// square for a CPU rasteriser.

struct Point {
    @builtin(position) clip: vec4<f32>,
    @location(0) @interpolate(flat) color: vec3<f32>,
    // In radii of the disc.
    @location(1) at: vec2<f32>,
}

@vertex
fn vs_main(
    @location(0) p: vec3<f32>,
    @location(1) color: vec4<f32>,
    @builtin(vertex_index) index: u32,
) -> Point {
    // The triangle around the unit disc.
    let which = index % 3u;
    let corner = vec2<f32>(select(select(-1.7320508, 1.7320508, which == 1u), 0.0, which == 2u), select(-1.0, 2.0, which == 2u));
    let depth = view_depth(p);
    let pixel = depth * frame.forward.w;
    // As large as asked on screen; nearby it grows, but stays smaller than a quarter of a voxel.
    let size_px = clamp(0.10 / pixel, 0.6 * frame.screen.w, 2.0 * frame.screen.w);
    // Returns lie on voxel faces: toward the viewer by their own size, so that they stay whole.
    let lift = min(0.04 + 1.5 * size_px * pixel, 0.5 * depth + 0.5 * frame.eye.w);
    var clip = frame.clip_from_ego * vec4<f32>(p + toward_eye(p) * lift, 1.0);
    clip += vec4<f32>(corner * size_px / frame.screen.xy * clip.w, 0.0, 0.0);
    var out: Point;
    out.clip = clip;
    out.color = color.rgb;
    out.at = corner;
    return out;
}

@fragment
fn fs_main(in: Point) -> @location(0) vec4<f32> {
    if dot(in.at, in.at) > 1.15 {
        discard;
    }
    return vec4<f32>(in.color, 1.0);
}
