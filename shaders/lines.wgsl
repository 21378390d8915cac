// Straight lines as quads that face the viewer, of constant width on screen.

struct Line {
    @builtin(position) clip: vec4<f32>,
    @location(0) @interpolate(flat) color: vec4<f32>,
    // x: pixels off the middle times w, y: half the width in pixels, z: w. The division in the
    // fragment shader makes x linear on screen, which not every backend offers as a qualifier.
    @location(1) across: vec3<f32>,
}

fn to_screen(clip: vec4<f32>) -> vec2<f32> {
    return clip.xy / clip.w * frame.screen.xy * 0.5;
}

// Toward the viewer by a few cm and a pixel: lines on a surface stay on top of it.
fn lifted(p: vec3<f32>) -> vec3<f32> {
    return p + toward_eye(p) * min(0.02 + 1.5 * pixel_m(p), 0.5 * view_depth(p) + 0.5 * frame.eye.w);
}

@vertex
fn vs_main(
    @location(0) from_m: vec3<f32>,
    @location(1) to_m: vec3<f32>,
    @location(2) color: vec4<f32>,
    @location(3) width_pt: f32,
    @builtin(vertex_index) index: u32,
) -> Line {
    var a = frame.clip_from_ego * vec4<f32>(lifted(from_m), 1.0);
    var b = frame.clip_from_ego * vec4<f32>(lifted(to_m), 1.0);
    let end = index & 2u;
    let side = select(-1.0, 1.0, (index & 3u) == 1u || (index & 3u) == 2u);
    var out: Line;
    out.color = color;
    let half_px = 0.5 * width_pt * frame.screen.z;
    // One pixel more on each side to fade out in.
    let reach_px = half_px + 1.0;
    out.across = vec3<f32>(0.0, half_px, 1.0);
    out.clip = vec4<f32>(2.0, 2.0, 2.0, 1.0);
    if max(a.w, b.w) <= NEAR_M {
        return out;
    }
    if a.w < NEAR_M {
        a = mix(a, b, (NEAR_M - a.w) / (b.w - a.w));
    } else if b.w < NEAR_M {
        b = mix(b, a, (NEAR_M - b.w) / (a.w - b.w));
    }
    let along = to_screen(b) - to_screen(a);
    let length_px = length(along);
    let dir = select(vec2<f32>(1.0, 0.0), along / length_px, length_px > 1e-4);
    // Ends reach out by half the width, so that the corners of a box close.
    let forth = select(-half_px, half_px, end != 0u);
    let offset = vec2<f32>(-dir.y, dir.x) * (side * reach_px) + dir * forth;
    var at = select(a, b, vec4<bool>(end != 0u));
    at += vec4<f32>(offset / (frame.screen.xy * 0.5) * at.w, 0.0, 0.0);
    out.clip = at;
    out.across = vec3<f32>(side * reach_px * at.w, half_px, at.w);
    return out;
}

fn covered(in: Line) -> vec4<f32> {
    let alpha = in.color.a * clamp(in.across.y + 0.5 - abs(in.across.x / in.across.z), 0.0, 1.0);
    return vec4<f32>(in.color.rgb * alpha, alpha);
}

@fragment
fn fs_main(in: Line) -> @location(0) vec4<f32> {
    return covered(in);
}

// What lies behind something else shows through, faintly.
@fragment
fn fs_hidden(in: Line) -> @location(0) vec4<f32> {
    return covered(in) * 0.22;
}
