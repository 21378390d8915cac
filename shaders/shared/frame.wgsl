// What every drawable shares: the uniforms of a picture, the scene's textures, small helpers.
// Colours: palette and lighting work on squared sRGB values (close to linear light and much cheaper
// than the exact curve on a CPU rasteriser); what leaves a fragment shader is sRGB-encoded and
// premultiplied, because the target is Rgba8Unorm and shown as it is.

struct Frame {
    clip_from_ego: mat4x4<f32>,
    // xyz: eye, m; w: 1 in an orthographic view.
    eye: vec4<f32>,
    // xyz: unit direction of view; w: size of a pixel in m, per m of distance if in perspective.
    forward: vec4<f32>,
    // xy: size in pixels; z: pixels per point; w: points drawn per LiDAR return.
    screen: vec4<f32>,
    // rgb, sRGB; a of the first: 0 for a transparent background.
    background_top: vec4<f32>,
    background_bottom: vec4<f32>,
    // xyz: toward the sun; w: strength of fog.
    sun: vec4<f32>,
    // x: voxel edges, y: road markings, z: shadows, w: opacity of the layout plane.
    toggles: vec4<f32>,
    // xyz: lower corner of the map, m; w: how many times farther away than over a small map fog is.
    grid_min: vec4<f32>,
    // xyz: voxels of the map; w: edge of a voxel, m.
    grid_size: vec4<f32>,
    // x: height of the layout's plane, just above the ground's voxels, m.
    ground: vec4<f32>,
    // Per class: rgb squared sRGB; a: 1 for ground classes.
    palette: array<vec4<f32>, 18>,
}

@group(0) @binding(0) var<uniform> frame: Frame;
@group(0) @binding(1) var light_volume: texture_3d<f32>;
@group(0) @binding(2) var light_sampler: sampler;
@group(0) @binding(3) var markings: texture_2d<f32>;
@group(0) @binding(4) var layout_plane: texture_2d<f32>;

// Lower edge of the view in front of the eye where lines are cut, m.
const NEAR_M = 0.1;

fn encode(squared: vec3<f32>) -> vec3<f32> {
    return sqrt(clamp(squared, vec3<f32>(0.0), vec3<f32>(1.0)));
}

fn background_at(y_px: f32) -> vec3<f32> {
    return mix(frame.background_top.rgb, frame.background_bottom.rgb, y_px / frame.screen.y);
}

// Distance that perspective shrinks by; 1 in an orthographic view.
fn view_depth(p: vec3<f32>) -> f32 {
    return select(max(dot(p - frame.eye.xyz, frame.forward.xyz), NEAR_M), 1.0, frame.eye.w > 0.5);
}

// Edge of a pixel at p, m.
fn pixel_m(p: vec3<f32>) -> f32 {
    return view_depth(p) * frame.forward.w;
}

// Unit vector from p toward the viewer.
fn toward_eye(p: vec3<f32>) -> vec3<f32> {
    return select(normalize(frame.eye.xyz - p), -frame.forward.xyz, frame.eye.w > 0.5);
}

// Ego frame to voxel units of the map.
fn voxel_units(p: vec3<f32>) -> vec3<f32> {
    return (p - frame.grid_min.xyz) / frame.grid_size.w;
}

// The texel of a column: `size` are all of the texture.
fn texel_at(cell: vec2<f32>, size: vec2<u32>) -> vec2<i32> {
    return vec2<i32>(clamp(cell, vec2<f32>(0.0), vec2<f32>(size) - 1.0));
}

// Share of the sky (x) and of the sun (y) that reaches p, a point half a voxel off its surface.
fn light_at(p: vec3<f32>) -> vec2<f32> {
    let cell = voxel_units(p) + vec3<f32>(1.0);
    let size = vec3<f32>(textureDimensions(light_volume));
    return textureSampleLevel(light_volume, light_sampler, cell / size, 0.0).xy;
}

// Light on a surface of normal n: cool sky from above, warm sun, a little from the ground and from
// where the viewer is, so that a side in shade is never dull.
fn lighting(n: vec3<f32>, reached: vec2<f32>) -> vec3<f32> {
    let sky = mix(vec3<f32>(0.30, 0.30, 0.32), vec3<f32>(0.46, 0.50, 0.56), 0.5 + 0.5 * n.z);
    // The two horizontal axes differ a little, so that corners show even in shade.
    let side = 1.0 + 0.10 * (abs(n.x) - abs(n.y));
    let sun = vec3<f32>(0.66, 0.62, 0.54) * max(dot(n, frame.sun.xyz), 0.0);
    let fill = 0.13 * max(-dot(n, frame.forward.xyz), 0.0);
    return (sky * side + fill) * mix(1.0, reached.x, 0.88) + sun * reached.y;
}

// Far things lean toward the background: depth one can see.
fn with_fog(rgb: vec3<f32>, p: vec3<f32>, y_px: f32) -> vec3<f32> {
    let far = clamp((distance(p, frame.eye.xyz) / frame.grid_min.w - 30.0) / 110.0, 0.0, 1.0);
    return mix(rgb, background_at(y_px), far * frame.sun.w);
}
