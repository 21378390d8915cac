// What the splat shaders share: a batch of cameras, and how a Gaussian comes onto an image. After
// UniScene (arXiv 2412.05435) equations 13 to 15; the twin on the processor is src/gen/sensors/project.rs.

// Edge of a tile, px.
const TILE: u32 = 16u;
// Sort key of what is not drawn.
const CULLED: u32 = 0xffffffffu;

struct View {
    // Rows of the rotation from ego to optical axes; w: where the camera is in the ego frame, m.
    row_x: vec4<f32>,
    row_y: vec4<f32>,
    row_z: vec4<f32>,
    // What rounding took from that position, m.
    rest: vec4<f32>,
    // Focal lengths, then principal point, px.
    focal_center: vec4<f32>,
    // Where x/z and y/z are held for the Jacobian, then near and far, m (far -1: nothing is drawn).
    limits: vec4<f32>,
}

struct Batch {
    size_px: vec2<u32>,
    tiles: vec2<u32>,
    gaussians: u32,
    // Bits of the near depth: keys start there.
    key_base: u32,
    // Maps written per camera.
    planes: u32,
    compensate: u32,
    low_pass_px2: f32,
    alpha_min: f32,
    alpha_max: f32,
    t_stop: f32,
    views: array<View, 128>,
}

struct Gaussian {
    position: vec3<f32>,
    std_m: f32,
    opacity: f32,
    id: u32,
    unused_a: u32,
    unused_b: u32,
}

// A Gaussian on an image. 2^-e is its shape, with e = (along (dx - shear dy))^2 + (across dy)^2.
struct Splat {
    mean: vec2<f32>,
    along: f32,
    across: f32,
    shear: f32,
    opacity: f32,
    depth: f32,
    id: u32,
}

struct Placed {
    splat: Splat,
    // First tile and one past the last: x, x, y, y. None if the splat is not drawn.
    tiles: vec4<u32>,
}

// Items of a pass over lists whose length only the device knows.
struct Ledger {
    // How many there are now, and how many there were before the last scan.
    count: u32,
    before: u32,
    // Touches of splats and tiles, also those for which there was no room.
    touches: u32,
    unused: u32,
    sums: array<u32>,
}

@group(0) @binding(0) var<uniform> batch: Batch;

// Projects as the twin does, in f32: differences before sums, and the determinant by its closed form
// (a_x a_y)^2 (1 + u^2 + v^2), divided by the variance along y, so that nothing cancels or overflows.
fn project(g: Gaussian, index: u32) -> Placed {
    var out: Placed;
    let view = batch.views[index];
    let d = (g.position - vec3(view.row_x.w, view.row_y.w, view.row_z.w)) - view.rest.xyz;
    let z = dot(view.row_z.xyz, d);
    if !(z > view.limits.z && z <= view.limits.w) {
        return out;
    }
    let uv = vec2(dot(view.row_x.xyz, d), dot(view.row_y.xyz, d)) / z;
    let mean = view.focal_center.xy * uv + view.focal_center.zw;
    // Standard deviation on an image plane at right angles, px.
    let a = view.focal_center.xy * (g.std_m / z);
    if !(max(a.x, a.y) < 1e18 && max(abs(mean.x), abs(mean.y)) < 1e15) {
        return out;
    }
    let held = clamp(uv, -view.limits.xy, view.limits.xy);
    let squares = held * held;
    let low_pass = batch.low_pass_px2;
    let variance = a * a * (1.0 + squares);
    let across = max(variance.y + low_pass, 1e-6);
    let before = a.x * a.x * (a.y * a.y / across) * (1.0 + squares.x + squares.y);
    let along = max(before + low_pass * ((variance.x + across) / across), 1e-12 / across);
    var opacity = g.opacity;
    if batch.compensate != 0u {
        opacity *= sqrt(before / along);
    }
    if !(opacity > 0.0 && opacity >= batch.alpha_min) {
        return out;
    }
    let size = vec2<f32>(batch.size_px);
    var first = vec2(0.0);
    var end = size;
    if batch.alpha_min > 0.0 {
        // Where alpha meets the threshold; a hair more, since it is rounded.
        let reach = sqrt(max(-2.0 * log(batch.alpha_min / opacity), 0.0)) + 0.01;
        let extent = sqrt(vec2(max(variance.x + low_pass, 0.0), across));
        // Pixel i is sampled at i + 1/2.
        first = clamp(ceil(mean - reach * extent - 0.5), vec2(0.0), size);
        end = clamp(floor(mean + reach * extent - 0.5) + 1.0, vec2(0.0), size);
        if !(first.x < end.x && first.y < end.y) {
            return out;
        }
    }
    const HALF_LOG2_E: f32 = 0.72134752;
    out.splat = Splat(
        mean,
        sqrt(HALF_LOG2_E / along),
        sqrt(HALF_LOG2_E / across),
        a.x * held.x * (a.y * held.y / across),
        opacity,
        z,
        g.id,
    );
    let low = vec2<u32>(first) / TILE;
    let high = (vec2<u32>(end) + TILE - 1u) / TILE;
    out.tiles = vec4(low.x, high.x, low.y, high.y);
    return out;
}
