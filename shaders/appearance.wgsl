// Camera pictures by day and night in any weather: the light that reaches each pixel, computed as
// src/gen/sensors/pictures/appearance does on the processor, function by function under the same names (twins; change both).
// In front stand the constants that src/viewport/appearance/layout.rs makes of the Rust ones, and appearance_* parts:
// one module, three storage buffers, no subgroups.

struct View {
    // Where each section of `words` begins, see layout.rs.
    at: array<vec4u, 6>,
    // to_sun, clouds | sun, haze_per_m | zenith, wet | horizon, snow | ambient, dust | bounce, lamps | haze, exposure
    // | to_sun in the ego frame, highest_m
    air: array<vec4f, 8>,
    // Ego frame to where textures stay: quaternion, shift.
    turn: vec4f,
    shift: vec4f,
    // Where the vehicle stands, x and y in m; height below which nothing is.
    vehicle: vec4f,
    // Voxels of the field along x and y, blocks along x and y.
    field: vec4u,
    // Bins of lines along x and y.
    bins: vec4u,
    // Lower corner of the map, and of the blocks, m.
    low: vec4f,
    // Middle of the map, m; how much wider than around a window the skyline is.
    middle: vec4f,
    // Camera in the ego frame: columns of its rotation, place with the angle of a pixel, focal lengths and centre.
    columns: array<vec4f, 3>,
    place: vec4f,
    lens: vec4f,
    // Width, height, seed, first row that this dispatch draws.
    size: vec4u,
}

@group(0) @binding(0) var<uniform> view: View;
@group(0) @binding(1) var<storage, read> words: array<u32>;
@group(0) @binding(2) var<storage, read_write> samples: array<vec4u>;
@group(0) @binding(3) var<storage, read_write> light: array<vec4f>;

fn section(i: u32) -> u32 { return view.at[i / 4u][i % 4u]; }
fn num(i: u32) -> f32 { return bitcast<f32>(words[i]); }
fn num3(i: u32) -> vec3f { return vec3f(num(i), num(i + 1u), num(i + 2u)); }
fn byte(base: u32, i: u32) -> u32 { return words[base + (i >> 2u)] >> ((i & 3u) * 8u) & 255u; }

fn a_to_sun() -> vec3f { return view.air[0].xyz; }
fn a_clouds() -> f32 { return view.air[0].w; }
fn a_sun() -> vec3f { return view.air[1].xyz; }
fn a_haze_per_m() -> f32 { return view.air[1].w; }
fn a_zenith() -> vec3f { return view.air[2].xyz; }
// Falling rain is 2 more than the wet ground.
fn a_rain() -> bool { return view.air[2].w >= 2.0; }
fn a_wet() -> f32 { return view.air[2].w - select(0.0, 2.0, a_rain()); }
fn a_horizon() -> vec3f { return view.air[3].xyz; }
fn a_snow() -> f32 { return view.air[3].w; }
fn a_ambient() -> vec3f { return view.air[4].xyz; }
fn a_dust() -> f32 { return view.air[4].w; }
fn a_bounce() -> vec3f { return view.air[5].xyz; }
fn a_lamps() -> f32 { return view.air[5].w; }
fn a_haze() -> vec3f { return view.air[6].xyz; }
fn a_exposure() -> f32 { return view.air[6].w; }
fn to_sun_in_ego() -> vec3f { return view.air[7].xyz; }
fn highest_m() -> f32 { return view.air[7].w; }
fn seed() -> u32 { return view.size.z; }
fn columns() -> vec2u { return view.field.xy - 2u; }
fn blocks() -> vec2u { return view.field.zw; }
fn low_m() -> vec2f { return view.low.xy; }
fn blocks_from_m() -> vec2f { return view.low.zw; }

// ---- noise.rs

fn hash3(p: vec3i, salt: u32) -> u32 {
    var h = (u32(p.x) * 0x8da6b343u) ^ (u32(p.y) * 0xd8163841u) ^ (u32(p.z) * 0xcb1ab31fu) ^ (salt * 0x9e3779b9u);
    h ^= h >> 16u;
    h *= 0x85ebca6bu;
    h ^= h >> 13u;
    h *= 0xc2b2ae35u;
    return h ^ (h >> 16u);
}
fn hash1(v: u32, salt: u32) -> u32 { return hash3(vec3i(i32(v), 17, 59), salt); }
fn unit(h: u32) -> f32 { return f32(h >> 8u) * (1.0 / 16777216.0); }
fn unit3(p: vec3i, salt: u32) -> f32 { return unit(hash3(p, salt)); }
fn smoothed(t: f32) -> f32 { return t * t * (3.0 - 2.0 * t); }
fn ramp(lo: f32, hi: f32, v: f32) -> f32 { return smoothed(clamp((v - lo) / (hi - lo), 0.0, 1.0)); }

fn value3(p: vec3f, salt: u32) -> f32 {
    let cell = floor(p);
    let f = p - cell;
    let u = smoothed(f.x);
    let v = smoothed(f.y);
    let c = vec3i(cell);
    var low = 0.0;
    var out = 0.0;
    for (var z = 0; z < 2; z++) {
        let b = c + vec3i(0, 0, z);
        let near = mix(unit3(b, salt), unit3(b + vec3i(1, 0, 0), salt), u);
        let far = mix(unit3(b + vec3i(0, 1, 0), salt), unit3(b + vec3i(1, 1, 0), salt), u);
        out = mix(near, far, v);
        if z == 0 {
            low = out;
        }
    }
    return mix(low, out, smoothed(f.z));
}

fn value2(p: vec2f, salt: u32) -> f32 {
    let cell = floor(p);
    let f = p - cell;
    let u = smoothed(f.x);
    let c = vec3i(vec2i(cell), 7);
    let low = mix(unit3(c, salt), unit3(c + vec3i(1, 0, 0), salt), u);
    let high = mix(unit3(c + vec3i(0, 1, 0), salt), unit3(c + vec3i(1, 1, 0), salt), u);
    return mix(low, high, smoothed(f.y));
}

fn fbm2(start: vec2f, octaves: u32, salt: u32) -> f32 {
    var p = start;
    var sum = 0.0;
    var weight = 1.0;
    var total = 0.0;
    for (var i = 0u; i < octaves; i++) {
        sum += weight * value2(p, salt + i);
        total += weight;
        weight *= 0.5;
        p = vec2f(p.x * 1.6 - p.y * 1.2, p.x * 1.2 + p.y * 1.6) + 3.7;
    }
    return sum / max(total, 1e-6);
}

// ---- small things that Rust has

fn normal_or(v: vec3f, other: vec3f) -> vec3f {
    let n = length(v);
    if n > 1e-20 && n < 1e20 {
        return v / n;
    }
    return other;
}
fn normal2_or(v: vec2f, other: vec2f) -> vec2f {
    let n = length(v);
    if n > 1e-20 && n < 1e20 {
        return v / n;
    }
    return other;
}
fn perp(v: vec2f) -> vec2f { return vec2f(-v.y, v.x); }
fn max3(v: vec3f) -> f32 { return max(v.x, max(v.y, v.z)); }
fn fraction(v: f32) -> f32 { return v - trunc(v); }
fn modulo(v: f32, n: f32) -> f32 { return v - floor(v / n) * n; }
fn powi(v: f32, n: f32) -> f32 {
    if v <= 0.0 {
        return 0.0;
    }
    return pow(v, n);
}
fn srgb(r: f32, g: f32, b: f32) -> vec3f { return pow(vec3f(r, g, b) / 255.0, vec3f(2.2)); }
fn turned(q: vec4f, v: vec3f) -> vec3f {
    let t = 2.0 * cross(q.xyz, v);
    return v + q.w * t + cross(q.xyz, t);
}
fn anchor(p: vec3f) -> vec3f { return turned(view.turn, p) + view.shift.xyz; }
fn anchor_dir(d: vec3f) -> vec3f { return turned(view.turn, d); }

