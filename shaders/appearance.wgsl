// Camera pictures by day and night in any weather: the light that reaches each pixel, computed as
// src/gen/sensors/appearance does on the processor, function by function under the same names (twins; change both).
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
fn a_wet() -> f32 { return view.air[2].w; }
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

// ---- field.rs

fn to_field(p: vec3f) -> vec3f { return (p + vec3f(40.0, 40.0, 1.0)) * 2.5 + 0.5; }
fn in_field(q: vec3f) -> bool {
    return all(q >= vec3f(0.0)) && q.x < f32(NX - 1u) && q.y < f32(NY - 1u) && q.z < f32(NZ - 1u);
}
fn field_at(x: u32, y: u32, z: u32) -> u32 { return (x * NY + y) * NZ + z; }
fn field_column(i: u32, share: f32) -> f32 {
    let low = f32(byte(section(0u), i));
    return low + (f32(byte(section(0u), i + 1u)) - low) * share;
}
fn blend(q: vec3f) -> f32 {
    let c = floor(q);
    let f = q - c;
    let i = field_at(u32(c.x), u32(c.y), u32(c.z));
    let low = mix(field_column(i, f.z), field_column(i + NZ, f.z), f.y);
    let j = i + NY * NZ;
    let high = mix(field_column(j, f.z), field_column(j + NZ, f.z), f.y);
    return mix(low, high, f.x) / 255.0;
}
fn field_value(p: vec3f) -> f32 {
    let q = to_field(p);
    if !in_field(q) {
        return 0.0;
    }
    return blend(q);
}
fn mask_bit(cell: u32, z: u32) -> bool {
    return (words[section(2u) + cell * 2u + (z >> 5u)] >> (z & 31u) & 1u) == 1u;
}
fn field_dense(p: vec3f) -> f32 {
    let q = to_field(p);
    if !in_field(q) || !mask_bit(u32(q.x) * CY + u32(q.y), u32(q.z)) {
        return 0.0;
    }
    return blend(q);
}
fn label_near(q: vec3f) -> u32 {
    let r = min(vec3u(max(q + 0.5, vec3f(0.0))), vec3u(NX, NY, NZ) - 1u);
    return byte(section(1u), field_at(r.x, r.y, r.z));
}
fn leaves(p: vec3f) -> f32 { return 0.62 * value3(p * 2.6, 71u) + 0.38 * value3(p * 8.5, 72u) - 0.5; }
// The field inside the grid, with the roughness of leaves if asked for.
fn rough(p: vec3f, leafy: bool) -> f32 {
    let q = to_field(p);
    if !in_field(q) {
        return 0.0;
    }
    let value = blend(q);
    if leafy && value > 0.1 && label_near(q) == VEGETATION {
        return value + leaves(anchor(p)) * LEAVES;
    }
    return value;
}

struct Structure {
    axis: vec2f,
    columns: u32,
    height_m: f32,
    id: u32,
    thin: bool,
    there: bool,
}
fn structure_at(p: vec3f) -> Structure {
    var s = Structure(vec2f(1.0, 0.0), 0u, 0.0, 0u, false, false);
    let q = vec2u(max(round(to_field(p).xy), vec2f(0.0)));
    let c = min(q, vec2u(NX, NY) - 1u);
    var around = array<vec2u, 9>(
        vec2u(1u, 1u), vec2u(0u, 1u), vec2u(2u, 1u), vec2u(1u, 0u), vec2u(1u, 2u),
        vec2u(0u, 0u), vec2u(0u, 2u), vec2u(2u, 0u), vec2u(2u, 2u),
    );
    for (var k = 0; k < 9; k++) {
        let xy = min(max(c + around[k], vec2u(1u)) - 1u, vec2u(NX, NY) - 1u);
        let i = words[section(4u) + xy.x * NY + xy.y];
        if i > 0u {
            let a = section(5u) + (i - 1u) * 8u;
            s = Structure(vec2f(num(a), num(a + 1u)), words[a + 2u], num(a + 3u), words[a + 4u], words[a + 5u] == 1u, true);
            break;
        }
    }
    return s;
}

fn field_normal(p: vec3f, label: u32) -> vec3f {
    var h = 0.15;
    if label == VEGETATION {
        h = 0.06;
    } else if label == MANMADE {
        let s = structure_at(p);
        if s.there && !s.thin && s.height_m > 2.6 {
            h = 0.5;
        }
    }
    var g = vec3f(0.0);
    for (var k = 0u; k < 6u; k++) {
        var d = vec3f(0.0);
        let sign = select(-1.0, 1.0, k % 2u == 0u);
        d[k / 2u] = -sign * h;
        var f: f32;
        if label == VEGETATION {
            f = field_value(p + d * 4.0) * 1.5 + leaves(anchor(p + d)) * LEAVES;
        } else {
            f = field_value(p + d);
        }
        g[k / 2u] += sign * f;
    }
    return normal_or(g, vec3f(0.0, 0.0, 1.0));
}

// Bits of a column of cells, low and high word, between two heights in field units.
fn z_bits(a: f32, b: f32) -> vec2u {
    let lo = max(floor(min(a, b)), 0.0);
    let hi = min(floor(max(a, b)), f32(NZ - 2u));
    if hi < lo {
        return vec2u(0u);
    }
    let l = u32(lo);
    let h = u32(hi);
    var out = vec2u(0u);
    for (var k = 0u; k < 2u; k++) {
        let first = k * 32u;
        if h >= first && l < first + 32u {
            let from_bit = max(l, first) - first;
            let to_bit = min(h, first + 31u) - first;
            out[k] = (0xffffffffu << from_bit) & (0xffffffffu >> (31u - to_bit));
        }
    }
    return out;
}
fn column_mask(cell: u32) -> vec2u {
    let a = section(2u) + cell * 2u;
    return vec2u(words[a], words[a + 1u]);
}
fn block_mask(index: u32) -> vec2u {
    let a = section(3u) + index * 2u;
    return vec2u(words[a], words[a + 1u]);
}

// Distance of the first surface in a block, negative for none.
fn cast_block(index: u32, o: vec3f, d: vec3f, t_in: f32, t_out: f32, stride: f32, leafy: bool) -> f32 {
    let qo = to_field(o);
    let qd = d * 2.5;
    if all((block_mask(index) & z_bits(qo.z + qd.z * t_in, qo.z + qd.z * t_out)) == vec2u(0u)) {
        return -1.0;
    }
    let lo = vec2u(index / BLOCKS, index % BLOCKS) * BLOCK;
    let hi = min(lo + BLOCK, vec2u(CX, CY)) - 1u;
    let enter = t_in + ((t_in + t_out) * 0.5 - t_in) * 1e-4;
    var cell = clamp(vec2u(max(qo.xy + qd.xy * enter, vec2f(0.0))), lo, hi);
    var t = t_in;
    for (var i = 0u; i < 2u * BLOCK + 1u; i++) {
        var next = vec2f(INFINITE);
        for (var a = 0u; a < 2u; a++) {
            if qd[a] != 0.0 {
                next[a] = (f32(cell[a] + select(0u, 1u, qd[a] > 0.0)) - qo[a]) * (1.0 / qd[a]);
            }
        }
        let t_end = min(min(next.x, next.y), t_out);
        let mask = column_mask(cell.x * CY + cell.y);
        if any((mask & z_bits(qo.z + qd.z * t, qo.z + qd.z * t_end)) != vec2u(0u)) {
            var k = ceil(t / stride) * stride;
            for (var guard = 0; guard < 256 && k < t_end; guard++) {
                let p = o + d * k;
                let z = to_field(p).z;
                if z >= 0.0 && z < f32(NZ - 1u) {
                    let zi = u32(z);
                    if (mask[zi >> 5u] >> (zi & 31u) & 1u) == 1u && rough(p, leafy) > SURFACE {
                        var outside = max(k - stride, 0.0);
                        var within = k;
                        for (var r = 0; r < 4; r++) {
                            let middle = (outside + within) * 0.5;
                            if rough(o + d * middle, leafy) > SURFACE {
                                within = middle;
                            } else {
                                outside = middle;
                            }
                        }
                        return within;
                    }
                }
                k += stride;
            }
        }
        if t_end >= t_out {
            return -1.0;
        }
        let a = select(0u, 1u, next.y < next.x);
        if qd[a] > 0.0 {
            if cell[a] >= hi[a] {
                return -1.0;
            }
            cell[a] += 1u;
        } else {
            if cell[a] <= lo[a] {
                return -1.0;
            }
            cell[a] -= 1u;
        }
        t = t_end;
    }
    return -1.0;
}

// ---- ground.rs

fn is_level(p: vec2f) -> bool {
    let q = vec2u(clamp((p + 40.0) * 2.5, vec2f(0.0), vec2f(f32(GRID) - 0.5)));
    return words[section(7u) + q.x * GRID + q.y] == 1u;
}
fn share_at(i: u32) -> vec4f {
    let a = section(6u) + i * 4u;
    return vec4f(num3(a), num(a + 3u));
}
fn shares(p: vec2f) -> vec4f {
    let q = clamp((p + 40.0) * 2.5 - 0.5, vec2f(0.0), vec2f(f32(GRID) - 1.001));
    let c = floor(q);
    let f = q - c;
    let i = u32(c.x) * GRID + u32(c.y);
    let low = mix(share_at(i), share_at(i + 1u), f.y);
    let high = mix(share_at(i + GRID), share_at(i + GRID + 1u), f.y);
    return mix(low, high, f.x);
}

struct GroundAt {
    share: vec4f,
    inside_road_m: f32,
    height_m: f32,
}
fn ground_at(p: vec2f, a: vec2f) -> GroundAt {
    let share = shares(p);
    let inside_road_m = (share.x - 0.5) * 1.23;
    let up = ramp(-0.008, -0.042, inside_road_m);
    let soft = share.w / max(1.0 - share.x, 1e-3);
    var height = 0.0;
    if up > 0.0 {
        var verge = 0.0;
        if soft > 0.02 {
            verge = 0.06 + 0.05 * value2(a * 0.35, 11u) - 0.01;
        }
        let slow = ramp(0.0, -0.35, inside_road_m);
        height = up * KERB_M * (1.0 - soft) + soft * verge * slow;
    }
    return GroundAt(share, inside_road_m, height);
}
fn ground_above(p: vec3f) -> f32 { return p.z - ground_at(p.xy, anchor(p).xy).height_m; }

// Distance where a ray meets the ground, `limit` for none.
fn ground_cast(o: vec3f, d: vec3f, limit: f32) -> f32 {
    if d.z >= -1e-5 {
        return limit;
    }
    let t0 = max((HIGHEST_M - o.z) / d.z, 0.0);
    let t1 = max(-o.z / d.z, 0.0);
    if t0 > limit {
        return limit;
    }
    let span = (t1 - t0) * length(d.xy);
    if t0 >= 60.0 || (span < 2.0 && is_level((o + d * t0).xy) && is_level((o + d * t1).xy)) {
        return min(t1, limit);
    }
    let steps = clamp(ceil((t1 - t0) / 0.12), 2.0, 14.0);
    var before = t0;
    for (var i = 1u; i < u32(steps); i++) {
        let t = t0 + (t1 - t0) * f32(i) / steps;
        if ground_above(o + d * t) <= 0.0 {
            var outside = before;
            var within = t;
            for (var r = 0; r < 5; r++) {
                let middle = (outside + within) * 0.5;
                if ground_above(o + d * middle) <= 0.0 {
                    within = middle;
                } else {
                    outside = middle;
                }
            }
            return min(within, limit);
        }
        before = t;
    }
    return min(t1, limit);
}
fn ground_normal(p: vec3f) -> vec3f {
    if is_level(p.xy) {
        return vec3f(0.0, 0.0, 1.0);
    }
    let h = 0.03;
    var n = vec3f(0.0, 0.0, 2.0 * h);
    for (var k = 0u; k < 4u; k++) {
        var d = vec3f(0.0);
        let sign = select(-1.0, 1.0, k % 2u == 0u);
        d[k / 2u] = -sign * h;
        n[k / 2u] += sign * ground_at((p + d).xy, anchor(p + d).xy).height_m;
    }
    return normalize(n);
}

// ---- sky.rs

fn sky(d: vec3f) -> vec3f {
    let up = max(d.z, 0.0);
    var color = mix(a_horizon(), a_zenith(), powi(up, 0.55));
    let toward = max(dot(d, a_to_sun()), 0.0);
    let clear = 1.0 - a_clouds() * 0.6;
    color += a_sun() * (0.10 * powi(toward, 6.0) + 0.25 * powi(toward, 48.0)) * max(clear, 0.0);
    let q = d.xy / (up + 0.12);
    let salt = seed() ^ 0xc10du;
    if a_clouds() < 0.99 {
        let n = fbm2(q * 0.75 + 9.0, 5u, salt);
        let cover = ramp(1.0 - a_clouds() - 0.06, 1.0 - a_clouds() + 0.22, n) * ramp(0.0, 0.16, up);
        let thick = fbm2(q * 0.75 + 9.0 + a_to_sun().xy * 0.22, 4u, salt);
        let lit = clamp(0.5 + 1.6 * (n - thick), 0.15, 1.0);
        let white = a_sun() * 0.36 * (0.4 + 0.6 * lit) + a_ambient() * (0.42 + 0.2 * lit);
        color = mix(color, white, cover * 0.9);
        if toward > 0.9994 && cover < 0.5 {
            color += a_sun() * 12.0 * ramp(0.9994, 0.99965, toward) * (1.0 - 2.0 * cover);
        }
    } else {
        color *= 0.86 + 0.30 * fbm2(q * 0.55 + 4.0, 4u, salt);
    }
    if a_lamps() >= 1.0 && a_clouds() < 0.9 && up > 0.02 {
        let cell = vec3i(floor(d * 700.0));
        if unit3(cell, 77u) > 0.9995 {
            color += vec3f(0.16 * unit3(cell, 78u)) * ramp(0.05, 0.35, up);
        }
    }
    return color;
}
fn through_air(color: vec3f, t: f32, d: vec3f) -> vec3f {
    let left = exp(-a_haze_per_m() * t);
    let sunward = powi(max(dot(d, a_to_sun()), 0.0), 8.0);
    return mix(a_haze() + a_sun() * (0.08 * sunward), color, left);
}
fn skyline_lit(albedo: vec3f, sun: f32) -> vec3f {
    return albedo * (a_ambient() * 0.62 + a_sun() * sun + a_bounce());
}
// Colour, and 1 if something stands there.
fn skyline(p: vec3f, radius_m: f32, open: f32) -> vec4f {
    let layer = seed() + u32(radius_m);
    let around = p.xy / max(length(p.xy), 1e-3);
    let s = atan2(around.y, around.x) * radius_m;
    let plot = floor(s / 19.0);
    let h = hash1(u32(i32(plot)), layer);
    let scale = radius_m / 75.0;
    let built = unit(h) > 0.45;
    var height = 0.0;
    if built && abs(s / 19.0 - plot - 0.5) <= 0.44 {
        height = 0.7 + 3.0 * (2.0 + floor(3.6 * unit(hash1(h, 1u)) * sqrt(scale)));
    }
    let crown = vec2f(s, 0.0);
    let trees = (2.5 + 5.5 * value2(crown * 0.09 + 3.0, layer ^ 5u) + 1.6 * value2(crown * 0.5, layer ^ 6u)
        + 0.6 * value2(crown * 1.9, layer ^ 7u)) * scale * (0.55 + 0.9 * value2(crown * 0.021, layer ^ 8u));
    let free = 1.0 - open;
    if p.z < trees * free * (0.35 + 0.65 * ramp(0.35, 0.65, value2(crown * 0.045, layer ^ 11u))) {
        let leaf = value2(vec2f(s, p.z) * 1.4, layer ^ 9u) * 0.6 + value2(vec2f(s, p.z) * 0.5, layer ^ 10u) * 0.4;
        let albedo = vec3f(0.055, 0.085, 0.032) * (0.55 + 0.9 * leaf);
        return vec4f(mix(skyline_lit(albedo, 0.34), a_ambient() * 0.75, 0.4 * a_snow()), 1.0);
    }
    if built && p.z < height * free {
        var albedo = mix(vec3f(0.46, 0.43, 0.39), vec3f(0.32, 0.27, 0.24), unit(hash1(h, 2u)));
        var emit = vec3f(0.0);
        let cell = vec2f(s / 2.6, p.z / 3.0);
        let f = cell - floor(cell);
        if f.x > 0.28 && f.x < 0.72 && f.y > 0.3 && f.y < 0.8 && p.z < height - 0.9 {
            albedo = vec3f(0.09, 0.11, 0.13);
            let on = unit3(vec3i(vec2i(floor(cell)), i32(h)), 3u);
            if on < 0.32 {
                emit = vec3f(1.0, 0.72, 0.40) * (0.30 * a_lamps() * (0.4 + on));
            }
        }
        return vec4f(skyline_lit(albedo, 0.3) + emit, 1.0);
    }
    return vec4f(0.0);
}

// ---- things.rs

struct Met {
    t: f32,
    normal: vec3f,
    // KIND_GROUND, KIND_VOXEL or KIND_THING; KIND_NONE for nothing.
    kind: u32,
    // Label or thing, part.
    which: u32,
    part: u32,
}
fn nothing(t: f32) -> Met { return Met(t, vec3f(0.0, 0.0, 1.0), KIND_NONE, 0u, 0u); }

fn thing_word(i: u32) -> u32 { return section(8u) + i * THING_WORDS; }
fn thing_foot(a: u32) -> vec3f { return num3(a + 5u); }
fn thing_heading(a: u32) -> vec2f { return vec2f(num(a + 8u), num(a + 9u)); }
fn thing_size(a: u32) -> vec3f { return num3(a + 10u); }
fn thing_turn(a: u32, d: vec3f) -> vec3f {
    let h = thing_heading(a);
    return vec3f(d.x * h.x + d.y * h.y, d.y * h.x - d.x * h.y, d.z);
}
fn thing_turn_back(a: u32, d: vec3f) -> vec3f {
    let h = thing_heading(a);
    return vec3f(d.x * h.x - d.y * h.y, d.x * h.y + d.y * h.x, d.z);
}
fn quadratic(a: f32, b: f32, c: f32) -> vec3f {
    let disc = b * b - a * c;
    if !(disc >= 0.0 && a > 1e-12) {
        return vec3f(0.0);
    }
    let s = sqrt(disc);
    return vec3f((-b - s) / a, (-b + s) / a, 1.0);
}
fn plane_at(i: u32) -> vec4f {
    let a = section(10u) + i * 4u;
    return vec4f(num3(a), num(a + 3u));
}

// Normal and distance of a part, negative for none.
fn cast_part(part: u32, o: vec3f, d: vec3f, limit: f32) -> vec4f {
    let a = section(9u) + part * PART_WORDS;
    let none = vec4f(0.0, 0.0, 1.0, -1.0);
    let kind = words[a];
    if kind == 0u {
        var near = -INFINITE;
        var far = limit;
        var normal = vec3f(0.0, 0.0, 1.0);
        let first = words[a + 5u];
        let end = first + words[a + 6u];
        for (var i = first; i < end; i++) {
            let plane = plane_at(i);
            let speed = dot(plane.xyz, d);
            let gap = plane.w - dot(plane.xyz, o);
            if abs(speed) < 1e-9 {
                if gap < 0.0 {
                    return none;
                }
            } else if speed > 0.0 {
                far = min(far, gap / speed);
            } else if gap / speed > near {
                near = gap / speed;
                normal = plane.xyz;
            }
            if near > far {
                return none;
            }
        }
        if near > 1e-4 && near < limit {
            return vec4f(normal, near);
        }
        return none;
    }
    let middle = num3(a + 5u);
    if kind == 1u {
        let radius = num(a + 8u);
        let wide = num(a + 9u);
        let p = o - middle;
        let roots = quadratic(d.x * d.x + d.z * d.z, p.x * d.x + p.z * d.z, p.x * p.x + p.z * p.z - radius * radius);
        if roots.z == 0.0 {
            return none;
        }
        var near = roots.x;
        var far = roots.y;
        var normal = vec3f(p.x + d.x * near, 0.0, p.z + d.z * near) / radius;
        if abs(d.y) > 1e-9 {
            let t0 = (-wide - p.y) / d.y;
            let t1 = (wide - p.y) / d.y;
            if min(t0, t1) > near {
                near = min(t0, t1);
                normal = vec3f(0.0, -sign(d.y), 0.0);
            }
            far = min(far, max(t0, t1));
        } else if abs(p.y) > wide {
            return none;
        }
        if near <= far && near > 1e-4 && near < limit {
            return vec4f(normal, near);
        }
        return none;
    }
    if kind == 2u {
        let radii = num3(a + 8u);
        let p = (o - middle) / radii;
        let q = d / radii;
        let roots = quadratic(dot(q, q), dot(p, q), dot(p, p) - 1.0);
        if roots.z > 0.0 && roots.x > 1e-4 && roots.x < limit {
            return vec4f(normal_or((p + q * roots.x) / radii, vec3f(0.0, 0.0, 1.0)), roots.x);
        }
        return none;
    }
    let height = num(a + 8u);
    let bottom = num(a + 9u);
    let top = num(a + 10u);
    let p = o - middle;
    let k = (top - bottom) / height;
    let m = bottom + k * p.z;
    let roots = quadratic(
        d.x * d.x + d.y * d.y - k * k * d.z * d.z, p.x * d.x + p.y * d.y - k * d.z * m, p.x * p.x + p.y * p.y - m * m,
    );
    var best = none;
    if roots.z > 0.0 {
        for (var i = 0; i < 2; i++) {
            let t = roots[i];
            let at = p + d * t;
            if t > 1e-4 && t < limit && at.z >= 0.0 && at.z <= height {
                best = vec4f(normal_or(vec3f(at.xy, -k * length(at.xy)), vec3f(0.0, 0.0, 1.0)), t);
                break;
            }
        }
    }
    let t = (height - p.z) / d.z;
    if t > 1e-4 && t < limit && length((p + d * t).xy) < top && (best.w < 0.0 || t < best.w) {
        best = vec4f(0.0, 0.0, 1.0, t);
    }
    return best;
}

// Normal in box coordinates left as it is: turned by the caller. Distance below 0: none.
fn cast_thing(i: u32, origin: vec3f, dir: vec3f, limit: f32) -> Met {
    let a = thing_word(i);
    var out = nothing(-1.0);
    let to = (thing_foot(a) - origin).xy;
    let beside = to.x * dir.y - to.y * dir.x;
    if beside * beside > num(a + 16u) * dot(dir.xy, dir.xy) {
        return out;
    }
    let o = thing_turn(a, origin - thing_foot(a));
    let d = thing_turn(a, dir);
    let size = thing_size(a);
    let lo = vec3f(-size.x, -size.y, -0.2) / 2.0 - 0.02;
    let hi = vec3f(size.x / 2.0, size.y / 2.0, size.z) + 0.02;
    // An axis along which the ray does not move: no number comes of 0 / 0.
    let still = abs(d) < vec3f(1e-20);
    let inv = 1.0 / select(d, vec3f(1e-20), still);
    let t0 = (lo - o) * inv;
    let t1 = (hi - o) * inv;
    let near = max3(min(t0, t1));
    let far = -max3(-max(t0, t1));
    if near > far || far < 0.0 || near > limit {
        return out;
    }
    var best = limit;
    let first = words[a + 3u];
    let end = first + words[a + 4u];
    for (var part = first; part < end; part++) {
        let hit = cast_part(part, o, d, best);
        if hit.w >= 0.0 {
            best = hit.w;
            out = Met(hit.w, hit.xyz, KIND_THING, i, part);
        }
    }
    return out;
}
// The normal of a body whose edges are rounded.
fn rounded(part: u32, p: vec3f, normal: vec3f, reach: f32) -> vec3f {
    let a = section(9u) + part * PART_WORDS;
    if words[a] != 0u {
        return normal;
    }
    var sum = vec3f(0.0);
    let first = words[a + 5u];
    let end = first + words[a + 6u];
    for (var i = first; i < end; i++) {
        let plane = plane_at(i);
        let near = 1.0 - (plane.w - dot(plane.xyz, p)) / reach;
        if near > 0.0 && dot(plane.xyz, normal) > -0.2 {
            sum += plane.xyz * (near * near);
        }
    }
    return normal_or(sum, normal);
}

// ---- look.rs

// Beginning and end of the things near a point of the ground.
fn things_near(p: vec2f) -> vec2u {
    let c = floor((p - BLOCKS_FROM_M) / BLOCK_M);
    if all(c >= vec2f(0.0)) && all(c < vec2f(f32(BLOCKS))) {
        return block_things(u32(c.x) * BLOCKS + u32(c.y));
    }
    return vec2u(0u);
}
fn block_things(block: u32) -> vec2u {
    let a = section(11u) + block;
    return vec2u(words[a], words[a + 1u]);
}

// The first surface along a ray. Modes: 0 camera, 1 mirror, 2 shadow (anything will do, the ground does not count).
fn trace(o: vec3f, d: vec3f, limit: f32, mode: u32) -> Met {
    var hit = nothing(limit);
    if mode < 2u {
        let t = ground_cast(o, d, limit);
        if t < limit {
            hit = Met(t, vec3f(0.0, 0.0, 1.0), KIND_GROUND, 0u, 0u);
        }
    }
    let size = f32(BLOCKS) * BLOCK_M;
    var t0 = 0.0;
    var t1 = hit.t;
    let low = vec3f(BLOCKS_FROM_M, BLOCKS_FROM_M, -0.4);
    let high = vec3f(BLOCKS_FROM_M + size, BLOCKS_FROM_M + size, highest_m());
    for (var a = 0u; a < 3u; a++) {
        if abs(d[a]) < 1e-9 {
            if o[a] < low[a] || o[a] > high[a] {
                return hit;
            }
        } else {
            let x = (low[a] - o[a]) / d[a];
            let y = (high[a] - o[a]) / d[a];
            t0 = max(t0, min(x, y));
            t1 = min(t1, max(x, y));
        }
    }
    if !(t0 < t1) {
        return hit;
    }
    let q = (o.xy - BLOCKS_FROM_M) / BLOCK_M;
    let qd = d.xy / BLOCK_M;
    var cell = min(vec2u(max(q + qd * (t0 + 1e-4), vec2f(0.0))), vec2u(BLOCKS - 1u));
    var t = t0;
    for (var i = 0u; i < 2u * BLOCKS + 2u; i++) {
        var next = vec2f(INFINITE);
        for (var a = 0u; a < 2u; a++) {
            if abs(qd[a]) >= 1e-9 {
                next[a] = (f32(cell[a] + select(0u, 1u, qd[a] > 0.0)) - q[a]) / qd[a];
            }
        }
        let t_out = min(min(next.x, next.y), t1);
        let index = cell.x * BLOCKS + cell.y;
        let things = block_things(index);
        for (var k = things.x; k < things.y; k++) {
            let met = cast_thing(words[section(12u) + k], o, d, hit.t);
            if met.t >= 0.0 {
                hit = met;
                if mode == 2u {
                    return hit;
                }
            }
        }
        if any(block_mask(index) != vec2u(0u)) && t < hit.t {
            var stride = 0.17;
            var leafy = true;
            var begin = t;
            if mode == 0u {
                stride = min(0.1 + t * 0.002, 0.15);
            } else if mode == 1u {
                leafy = t < 12.0;
            } else {
                stride = 0.16;
                begin = max(t, 0.05);
            }
            let met = cast_block(index, o, d, begin, min(t_out, hit.t), stride, leafy);
            if met >= 0.0 && (met < hit.t || mode == 2u) {
                hit = Met(met, vec3f(0.0), KIND_VOXEL, 0u, 0u);
                if mode == 2u {
                    return hit;
                }
            }
        }
        if hit.t <= t_out || t_out >= t1 {
            break;
        }
        let a = select(0u, 1u, next.y < next.x);
        if qd[a] > 0.0 {
            if cell[a] + 1u >= BLOCKS {
                break;
            }
            cell[a] += 1u;
        } else {
            if cell[a] == 0u {
                break;
            }
            cell[a] -= 1u;
        }
        t = t_out;
    }
    if hit.kind == KIND_VOXEL {
        hit.which = label_near(to_field(o + d * hit.t));
    }
    return hit;
}

// ---- march/paint.rs, in f32

fn paint_bits(which: u32, p: vec2f) -> u32 {
    let c = floor((p + 40.0) / 0.4);
    if all(c >= vec2f(0.0)) && all(c < vec2f(f32(GRID))) {
        return words[section(which) + u32(c.x) * GRID + u32(c.y)];
    }
    return 0u;
}
// Distance to the nearest line of a kind and how far along it, negative for none within 1 m.
fn nearest_line(kind: u32, p: vec2f) -> vec2f {
    let c = floor((p + 40.0) / 2.0);
    var best = vec2f(-1.0, 0.0);
    if !(all(c >= vec2f(0.0)) && all(c < vec2f(40.0))) {
        return best;
    }
    let bin = section(13u) + u32(c.x) * 40u + u32(c.y);
    for (var i = words[bin]; i < words[bin + 1u]; i++) {
        let a = section(14u) + i * 6u;
        if words[a + 4u] != kind {
            continue;
        }
        let start = vec2f(num(a), num(a + 1u));
        let d = vec2f(num(a + 2u), num(a + 3u)) - start;
        let share = clamp(dot(p - start, d) / dot(d, d), 0.0, 1.0);
        let distance_m = distance(p, start + d * share);
        if distance_m <= 1.0 && (best.x < 0.0 || distance_m < best.x) {
            best = vec2f(distance_m, num(a + 5u) + share * length(d));
        }
    }
    return best;
}
// Direction of the crossing that holds a point, and 1 if there is one.
fn crossing_at(p: vec2f) -> vec3f {
    for (var i = 0u; i < section(21u); i++) {
        let a = section(15u) + i * 8u;
        if p.x < num(a + 2u) || p.y < num(a + 3u) || p.x > num(a + 4u) || p.y > num(a + 5u) {
            continue;
        }
        let first = section(16u) + words[a] * 2u;
        let n = words[a + 1u];
        var odd = false;
        for (var k = 0u; k < n; k++) {
            let s = first + k * 2u;
            let e = first + ((k + 1u) % n) * 2u;
            let one = vec2f(num(s), num(s + 1u));
            let two = vec2f(num(e), num(e + 1u));
            if (one.y > p.y) != (two.y > p.y) && p.x < one.x + (p.y - one.y) / (two.y - one.y) * (two.x - one.x) {
                odd = !odd;
            }
        }
        if odd {
            return vec3f(num(a + 6u), num(a + 7u), 1.0);
        }
    }
    return vec3f(0.0);
}

// ---- material.rs

struct Surface {
    albedo: vec3f,
    mirror: f32,
    gloss: f32,
    emit: vec3f,
    normal: vec3f,
    through: f32,
}
fn matt(albedo: vec3f, normal: vec3f) -> Surface { return Surface(albedo, 0.0, 0.0, vec3f(0.0), normal, 0.0); }
fn visible(footprint: f32, feature: f32) -> f32 { return ramp(feature * 1.4, feature * 0.35, footprint); }
fn band(d: f32, wide: f32, footprint: f32) -> f32 {
    let soft = max(footprint * 0.5, 0.004);
    let edge = clamp((wide - d) / soft * 0.5 + 0.5, 0.0, 1.0);
    return clamp(edge * min(wide / max(soft, wide), 1.0), 0.0, 1.0);
}
fn gray(v: f32) -> vec3f { return vec3f(v); }

fn cover(start: Surface, p: vec3f, hold: f32) -> Surface {
    var s = start;
    let a = anchor(p);
    if a_snow() > 0.0 {
        let n = s.normal.z + 0.35 * (value3(a * 3.0, 31u) - 0.5) + 0.15 * (value3(a * 11.0, 32u) - 0.5);
        let lies = ramp(0.42, 0.75, n) * hold * a_snow();
        s.albedo = mix(s.albedo, vec3f(0.80, 0.83, 0.88), lies);
        s.mirror *= 1.0 - lies;
        s.emit *= 1.0 - lies;
    }
    if a_dust() > 0.0 {
        let lies = (0.28 + 0.45 * ramp(0.2, 0.9, s.normal.z)) * a_dust() * hold;
        s.albedo = mix(s.albedo, vec3f(0.46, 0.33, 0.19), lies);
        s.mirror *= 1.0 - lies;
    }
    if a_wet() > 0.0 && s.mirror < 0.03 {
        s.albedo *= 1.0 - 0.35 * a_wet();
        s.mirror = max(s.mirror, 0.02 * a_wet());
        s.gloss = max(s.gloss, 0.35);
    }
    return s;
}

fn slabs(a: vec2f, fp: f32) -> vec3f {
    let q = a / 0.9;
    let cell = floor(q);
    let f = abs(q - cell - 0.5);
    let tone = unit3(vec3i(vec2i(cell), 1), 12u);
    let joint = band(0.5 - max(f.x, f.y), 0.012, fp / 0.9);
    let stain = value2(a * 0.7, 13u) * 0.6 + value2(a * 3.1, 14u) * 0.4;
    let grain = visible(fp, 0.03) * (value2(a * 40.0, 15u) - 0.5) * 0.14;
    let v = (0.27 + 0.045 * (tone - 0.5) * visible(fp, 0.9) + 0.07 * (stain - 0.5)) * (1.0 + grain) * (1.0 - 0.5 * joint);
    return vec3f(v * 1.02, v, v * 0.945);
}
fn pavers(a: vec2f, fp: f32) -> vec3f {
    let row = floor(a.y / 0.12);
    let q = vec2f(a.x / 0.22 + 0.5 * modulo(row, 2.0), a.y / 0.12);
    let cell = floor(q);
    let f = abs(q - cell - 0.5);
    let tone = unit3(vec3i(vec2i(cell), 2), 16u);
    let near = visible(fp, 0.12);
    let joint = band((0.5 - max(f.x, f.y)) * 0.15, 0.006, fp);
    let v = (0.22 + 0.10 * (tone - 0.5) * near + 0.05 * (value2(a * 0.6, 17u) - 0.5)) * (1.0 - 0.5 * joint * near);
    return vec3f(v * 1.12, v * 0.97, v * 0.84);
}
fn grass(a: vec2f, fp: f32) -> vec3f {
    let dry = fbm2(a * 0.13, 4u, seed() ^ 33u);
    var base = mix(vec3f(0.070, 0.105, 0.026), vec3f(0.155, 0.140, 0.058), ramp(0.42, 0.72, dry));
    base = mix(base, vec3f(0.120, 0.090, 0.058), ramp(0.64, 0.74, fbm2(a * 0.35 + 5.0, 3u, seed() ^ 34u)) * 0.8);
    let blades = visible(fp, 0.05) * (value2(a * vec2f(55.0, 42.0), 35u) - 0.5);
    let tufts = visible(fp, 0.25) * (value2(a * 5.5, 36u) - 0.5);
    let waves = value2(a * 0.9, 37u) - 0.5;
    return base * (1.0 + 0.85 * blades + 0.5 * tufts + 0.35 * waves);
}

// Colour and cover of what is painted on the road.
fn road_paint(p: vec2f, a: vec2f, fp: f32) -> vec4f {
    let white = vec3f(0.66, 0.66, 0.63);
    let yellow = vec3f(0.62, 0.40, 0.045);
    let allowed = paint_bits(17u, p);
    let orphans = paint_bits(18u, p);
    var color = white;
    var share = 0.0;
    let wavy = 0.012 * (value2(a * 3.0, 68u) - 0.5);
    if ((allowed | orphans) & BIT_PED_CROSSING) != 0u {
        let crossing = crossing_at(p);
        let orphan = (orphans & BIT_PED_CROSSING) != 0u;
        if crossing.z > 0.0 || orphan {
            let along = select(vec2f(0.0, 1.0), crossing.xy, crossing.z > 0.0);
            share = max(share, band(abs(modulo(dot(p, along), 1.0) - 0.5), 0.25, fp));
        }
    }
    if (allowed & BIT_LANE_DIVIDER) != 0u {
        let near = nearest_line(LINE_LANE_DIVIDER, p);
        if near.x >= 0.0 {
            share = max(share, band(near.x + wavy, 0.075, fp) * band(abs(modulo(near.y, 9.0) - 1.5), 1.5, fp));
        }
    }
    if (allowed & BIT_STOP_LINE) != 0u {
        let near = nearest_line(LINE_STOP_LINE, p);
        if near.x >= 0.0 {
            share = max(share, band(near.x + wavy, 0.2, fp));
        }
    }
    if (allowed & BIT_ROAD_DIVIDER) != 0u {
        let near = nearest_line(LINE_ROAD_DIVIDER, p);
        if near.x >= 0.0 {
            let double = band(abs(near.x + wavy - 0.11), 0.055, fp);
            if double > share {
                color = yellow;
                share = double;
            }
        }
    }
    if (orphans & BIT_ROAD_DIVIDER) != 0u {
        return vec4f(yellow, 1.0);
    }
    if (orphans & (BIT_LANE_DIVIDER | BIT_STOP_LINE)) != 0u {
        return vec4f(white, 1.0);
    }
    return vec4f(color, share);
}

fn road(p: vec2f, a: vec2f, fp: f32, inside_m: f32) -> Surface {
    var tone = 0.088 + 0.035 * (fbm2(a * 0.11, 3u, 51u) - 0.5) + 0.012 * (value2(a * 0.9, 52u) - 0.5);
    let lane = nearest_line(LINE_LANE_CENTER, p);
    var track = 0.0;
    if lane.x >= 0.0 {
        track = ramp(0.42, 0.1, abs(lane.x - 0.82));
        tone *= 1.0 - 0.10 * track;
        tone *= 1.0 - 0.10 * ramp(0.45, 0.0, lane.x) * value2(a * 0.6, 53u);
    }
    let grain = visible(fp, 0.03);
    if grain > 0.0 {
        tone *= 1.0 + grain * (0.55 * (value2(a * 46.0, 54u) - 0.5) + 0.4 * (value2(a * 95.0, 55u) - 0.5));
    }
    tone *= 1.0 + visible(fp, 0.12) * 0.16 * (value2(a * 11.0, 56u) - 0.5);
    let crack = abs(fbm2(a * 0.42 + 31.0, 4u, 57u) - 0.5);
    let seam = band(crack * 2.2, 0.008, fp) * ramp(0.52, 0.62, value2(a * 0.13, 58u));
    tone *= 1.0 - 0.42 * seam;
    tone *= 1.0 - 0.28 * ramp(0.5, 0.05, inside_m);
    var color = gray(tone) * vec3f(1.0, 0.995, 0.985);
    let paint = road_paint(p, a, fp);
    let worn = 0.80 + 0.25 * (value2(a * 5.0, 59u) - 0.5) - 0.28 * ramp(0.60, 0.78, value2(a * 16.0, 60u)) * visible(fp, 0.08);
    color = mix(color, paint.xyz, clamp(paint.w * worn, 0.0, 1.0));
    var s = matt(color, vec3f(0.0, 0.0, 1.0));
    s.mirror = 0.012;
    s.gloss = 0.25;
    if a_wet() > 0.0 {
        let hollow = fbm2(a * 0.32 + 7.0, 3u, 61u) + 0.10 * track;
        let puddle = ramp(0.50, 0.60, hollow) * ramp(0.5, 1.0, a_wet());
        s.albedo *= 1.0 - (0.42 + 0.2 * puddle) * a_wet();
        s.mirror = a_wet() * (0.018 + 0.012 * puddle);
        s.gloss = 0.72 + 0.26 * puddle;
        let ripple = 0.030 * (1.0 - 0.75 * puddle) * visible(fp, 0.25);
        let w = vec2f(value2(a * 6.5, 62u), value2(a * 6.5, 63u)) - 0.5;
        s.normal = normalize(vec3f(w * ripple * 2.0, 1.0));
    }
    if a_snow() > 0.0 {
        let clear = select(0.06, 0.75 * track + 0.14, lane.x >= 0.0);
        let lies = ramp(0.30, 0.62, 0.62 + 0.55 * (fbm2(a * 0.9, 3u, 64u) - 0.5) + 0.30 * (value2(a * 6.0, 65u) - 0.5)
            + 0.26 * visible(fp, 0.12) * (value2(a * 17.0, 70u) - 0.5) - clear);
        let slush = vec3f(0.50, 0.52, 0.56)
            * (0.80 + 0.34 * value2(a * 2.4, 66u) + 0.2 * (value2(a * 9.0, 69u) - 0.5) * visible(fp, 0.1));
        s.albedo = mix(s.albedo * 0.75, slush, lies * 0.93 * a_snow());
        s.mirror = 0.02 * (1.0 - lies);
        s.gloss = 0.6;
    }
    if a_dust() > 0.0 {
        let drift = ramp(0.30, 0.75, fbm2(vec2f(a.x * 0.25, a.y * 0.9), 4u, 67u));
        s.albedo = mix(s.albedo, vec3f(0.42, 0.30, 0.17), 0.25 + 0.6 * drift);
        s.mirror = 0.0;
    }
    return s;
}

fn ground_surface(p: vec3f, normal: vec3f, fp: f32) -> Surface {
    let a = anchor(p).xy;
    let g = ground_at(p.xy, a);
    let edge = max(fp * 0.5, KERB_EDGE_M);
    let on_road = clamp((g.inside_road_m + 0.014) / edge * 0.5 + 0.5, 0.0, 1.0);
    var s = matt(vec3f(0.0), normal);
    if on_road > 0.0 {
        let r = road(p.xy, a, fp, g.inside_road_m);
        s.albedo += r.albedo * on_road;
        s.mirror = r.mirror * on_road;
        s.gloss = r.gloss;
        s.normal = normal_or(mix(s.normal, r.normal, on_road), vec3f(0.0, 0.0, 1.0));
    }
    if on_road < 1.0 {
        let rest = max(1.0 - g.share.x, 1e-3);
        let walk = g.share.y / rest;
        let flat_share = g.share.z / rest;
        let fray = 0.22 * (value2(a * 2.2, 41u) - 0.5) + 0.12 * (value2(a * 9.0, 42u) - 0.5);
        let green = ramp(0.46, 0.54, g.share.w / rest + fray);
        var c = vec3f(0.0);
        if green < 1.0 {
            var paved: vec3f;
            if walk >= flat_share {
                paved = slabs(a, fp);
            } else {
                paved = pavers(a, fp);
            }
            c += paved * (1.0 - green);
        }
        if green > 0.0 {
            c += grass(a, fp) * green;
        }
        let kerb = ramp(0.21, 0.19, -g.inside_road_m) * ramp(0.7, 0.4, g.share.w / rest) * visible(fp, KERB_SEEN_M);
        if kerb > 0.0 {
            let stone = 0.25 + 0.06 * value2(a * 7.0, 43u) + 0.04 * value2(a * 1.1, 44u);
            let side = ramp(0.8, 0.4, normal.z);
            c = mix(c, gray(stone) * vec3f(1.0, 0.985, 0.95) * (1.0 - 0.25 * side), kerb);
        }
        if a_snow() > 0.0 {
            let lies = clamp(0.86 + 0.4 * (value2(a * 1.3, 45u) - 0.5), 0.0, 1.0) * a_snow();
            let drift = 0.72 + 0.13 * value2(a * 0.5, 46u) + 0.06 * value2(a * 2.1, 48u)
                + 0.07 * value2(a * 7.0, 47u) * visible(fp, 0.14);
            c = mix(c, gray(drift) * vec3f(0.965, 0.985, 1.02), lies * ramp(0.35, 0.75, normal.z));
        }
        c *= 1.0 - 0.30 * a_wet();
        c = mix(c, vec3f(0.44, 0.32, 0.18), 0.55 * a_dust());
        s.albedo += c * (1.0 - on_road);
        s.mirror += 0.025 * a_wet() * (1.0 - green) * (1.0 - on_road);
        s.gloss = max(s.gloss, 0.5 * a_wet());
    }
    return s;
}

fn plant(a: vec3f, normal: vec3f, fp: f32) -> Surface {
    var hue = mix(vec3f(0.050, 0.095, 0.022), vec3f(0.115, 0.135, 0.030), value2(a.xy * 0.16, 23u));
    hue = mix(hue, vec3f(0.030, 0.065, 0.025), value2(a.xy * 0.07, 24u));
    let fine = visible(fp, 0.10);
    let leaf = value3(a * 9.0, 25u) * fine + 0.5 * (1.0 - fine);
    let clump = value3(a * 2.3, 26u);
    var s = matt(hue * (0.45 + 0.75 * leaf + 0.45 * clump), normal);
    let jitter = vec3f(value3(a * 13.0, 27u) - 0.5, value3(a * 13.0, 28u) - 0.5, value3(a * 13.0, 29u) - 0.3);
    s.normal = normal_or(normal + jitter * 0.9 * fine, normal);
    s.through = 0.35;
    return s;
}

fn facade(st: Structure, p: vec3f, at: vec2f, a: vec3f, normal: vec3f, fp: f32) -> Surface {
    var walls = array<vec3f, 8>(
        vec3f(198.0, 186.0, 164.0), vec3f(166.0, 92.0, 70.0), vec3f(214.0, 208.0, 198.0), vec3f(150.0, 146.0, 140.0),
        vec3f(188.0, 160.0, 122.0), vec3f(122.0, 70.0, 56.0), vec3f(176.0, 178.0, 180.0), vec3f(222.0, 204.0, 168.0),
    );
    let style = hash1(st.id, 1u) % 8u;
    let tone = walls[style];
    var wall = srgb(tone.x, tone.y, tone.z);
    wall *= 0.90 + 0.14 * value3(a * 0.35, 14u) + 0.05 * (value3(a * 2.5, 15u) - 0.5);
    wall *= 1.0 - 0.25 * ramp(0.9, 0.0, p.z) * (0.4 + 0.6 * value3(a * 1.2, 16u));
    if style == 1u || style == 5u {
        let row = floor(at.y / 0.085);
        let joint = band(abs(at.y / 0.085 - row - 0.5) - 0.40, 0.1, fp / 0.085);
        let odd = row - trunc(row / 2.0) * 2.0;
        let one = unit3(vec3i(i32(floor(at.x / 0.26 + 0.5 * odd)), i32(row), 3), 17u);
        wall *= 1.0 + visible(fp, 0.09) * (0.34 * (one - 0.5) - 0.12 * joint);
    } else {
        wall *= 1.0 + visible(fp, 0.05) * 0.12 * (value3(a * 24.0, 18u) - 0.5);
    }
    var out = matt(wall, normal);
    if st.columns < 24u || st.height_m < 2.3 {
        return out;
    }
    let bay = 1.9 + 1.3 * unit(hash1(st.id, 2u));
    let floor_m = 2.9 + 0.4 * unit(hash1(st.id, 3u));
    let shop = st.height_m > 5.0 && hash1(st.id, 4u) % 3u == 0u;
    out.albedo *= 1.0 - 0.30 * band(abs(at.y - 0.2), 0.3, fp);
    let cornice = band(abs(st.height_m - 0.22 - at.y), 0.16, fp);
    out.albedo = mix(out.albedo, gray(0.42), 0.6 * cornice);
    let column = floor(at.x / bay);
    let row = floor((at.y - 0.25) / floor_m);
    let f = vec2f(at.x / bay - column - 0.5, (at.y - 0.25) / floor_m - row - 0.5) * vec2f(bay, floor_m);
    if row < 0.0 || (row + 1.0) * floor_m + 0.1 > max(st.height_m, floor_m) {
        return out;
    }
    var size = vec2f(min(bay * 0.29, 0.75), 0.72);
    var middle = 0.12;
    if row == 0.0 && shop {
        size = vec2f(bay * 0.42, 1.05);
        middle = -0.15;
    }
    let q = vec2f(abs(f.x), abs(f.y - middle));
    let d = max(q.x - size.x, q.y - size.y);
    let frame = band(abs(d - 0.03), 0.05, fp);
    let glass = ramp(0.004 + fp * 0.3, -0.004 - fp * 0.3, d);
    let trim = select(0.10, 0.55, unit(hash1(st.id, 5u)) > 0.4);
    out.albedo = mix(out.albedo, gray(trim), frame * 0.9);
    let sill = band(abs(f.y - middle + size.y + 0.09), 0.05, fp) * band(q.x, size.x + 0.1, fp);
    out.albedo = mix(out.albedo, gray(0.5), sill * 0.7);
    if glass > 0.0 {
        let cell = vec3i(i32(column), i32(row), i32(st.id));
        let bars = max(band(abs(f.x), 0.03, fp), band(abs(f.y - middle - 0.25), 0.025, fp));
        let drawn = f.y - middle > size.y * (1.0 - 2.0 * ramp(0.45, 1.0, unit3(cell, 6u)));
        let inside = select(gray(0.022), gray(0.30) * vec3f(1.0, 0.96, 0.88), drawn);
        out.albedo = mix(out.albedo, mix(inside, gray(trim), bars * 0.8), glass);
        out.mirror = 0.085 * glass * (1.0 - bars);
        out.gloss = 0.97;
        let on = unit3(cell, 7u);
        if a_lamps() > 0.0 && on < 0.38 {
            let warm = mix(vec3f(1.0, 0.70, 0.38), vec3f(0.85, 0.92, 1.0), ramp(0.26, 0.3, unit3(cell, 8u) * 0.4));
            let room = 0.55 + 0.45 * (1.0 - q.y / size.y) + 0.25 * (value2(f * 2.5 + column * 7.0, 9u) - 0.5);
            let night = ramp(0.1, 1.0, a_lamps());
            out.emit = warm * (room * glass * (1.0 - bars) * (0.15 + 0.55 * night) * select(1.0, 0.55, drawn));
        }
    }
    return out;
}

fn structure_surface(p: vec3f, a: vec3f, start: vec3f, fp: f32) -> Surface {
    let st = structure_at(p);
    if !st.there {
        return matt(gray(0.35), start);
    }
    if st.thin {
        let lamp = st.height_m > 3.9;
        var plates = array<vec3f, 4>(
            vec3f(38.0, 72.0, 118.0), vec3f(120.0, 124.0, 128.0), vec3f(36.0, 88.0, 66.0), vec3f(190.0, 192.0, 192.0),
        );
        var paint = gray(select(0.24, 0.11, lamp));
        if !lamp && st.columns > 1u && p.z > st.height_m - 1.15 {
            let plate = plates[st.id % 4u];
            paint = srgb(plate.x, plate.y, plate.z);
        }
        var s = matt(paint * (0.9 + 0.2 * value3(a * 5.0, 20u)), start);
        s.mirror = 0.03;
        s.gloss = 0.4;
        if a_lamps() > 0.0 && lamp && p.z > st.height_m - 0.55 {
            s.emit = vec3f(1.0, 0.74, 0.42) * 3.5 * a_lamps();
        }
        return s;
    }
    if start.z > 0.62 {
        let c = gray(0.20) * (0.8 + 0.4 * value2(a.xy * 1.2, 19u));
        return matt(c, normalize(mix(vec3f(0.0, 0.0, 1.0), start, 0.4)));
    }
    let level = normal2_or(start.xy, vec2f(1.0, 0.0));
    var wall = st.axis;
    var best = -2.0;
    // As in Rust: of equal ones the last.
    var axes = array<vec2f, 4>(st.axis, perp(st.axis), -st.axis, -perp(st.axis));
    for (var k = 0; k < 4; k++) {
        if dot(axes[k], level) >= best {
            best = dot(axes[k], level);
            wall = axes[k];
        }
    }
    var normal = start;
    var along = perp(level);
    if best > 0.62 {
        normal = normal_or(mix(vec3f(wall, 0.0), start, 0.06), start);
        along = perp(wall);
    }
    return facade(st, p, vec2f(dot(p.xy, along), p.z), a, normal, fp);
}

fn voxel_surface(p: vec3f, label: u32, normal: vec3f, fp: f32) -> Surface {
    let a = anchor(p);
    var s: Surface;
    if label == TRUNK {
        let bark = value3(a * vec3f(14.0, 14.0, 3.0), 22u);
        s = matt(vec3f(0.105, 0.080, 0.058) * (0.55 + 0.9 * bark), normal);
    } else if label == VEGETATION {
        s = plant(a, normal, fp);
    } else if label == MANMADE {
        s = structure_surface(p, a, normal, fp);
    } else {
        let calm = num3(section(22u) + min(label, 17u) * 3u);
        s = matt(calm * (0.8 + 0.4 * value3(a * 4.0, 21u)), normal);
    }
    return cover(s, p, select(1.0, 0.8, label == VEGETATION));
}

// `p` and `n` in box coordinates; the normal stays there too.
fn thing_surface(a: u32, part: u32, p: vec3f, n: vec3f, fp: f32) -> Surface {
    let size = thing_size(a);
    let class_id = words[a];
    let id = words[a + 1u];
    let paint = num3(a + 13u);
    let tint = num3(section(9u) + part * PART_WORDS + 2u);
    let material = words[section(9u) + part * PART_WORDS + 1u];
    var out = matt(gray(0.1), n);
    let lamps = select(0.0, a_lamps(), words[a + 2u] == 1u);
    let x = p.x / size.x;
    let y = abs(p.y) / (size.y / 2.0);
    let z = p.z / size.z;
    let car = class_id == CAR;
    let head_color = vec3f(1.0, 0.95, 0.85) * 7.0;
    let tail_color = vec3f(1.0, 0.035, 0.02);
    let wheel_radius = clamp(0.165 * size.z + 0.06, 0.2, 0.42);
    switch material {
        case 0u: { // Body
            out.albedo = paint;
            out.mirror = 0.05;
            out.gloss = 0.96;
            for (var k = 0; k < 2; k++) {
                let wheel = select(0.3, -0.295, k == 0);
                if length(vec2f(p.x - wheel * size.x, p.z - wheel_radius)) < wheel_radius * 1.17 && abs(n.y) > 0.4 && car {
                    out.albedo = gray(0.006);
                    out.mirror = 0.0;
                }
            }
            if z < 0.17 || (z < 0.25 && abs(n.y) > 0.6) {
                out.albedo = gray(0.012);
                out.mirror = 0.01;
            }
            if !car {
                return out;
            }
            if abs(n.y) > 0.6 && z > 0.22 && z < 0.6 {
                let gap = min(min(abs(x - 0.185), abs(x + 0.03)), abs(x + 0.225)) * size.x;
                out.albedo *= 1.0 - 0.75 * band(min(gap, 9.0), 0.008, fp);
                if min(abs(x + 0.005), abs(x + 0.205)) < 0.016 && abs(z - 0.5) < 0.010 {
                    out.albedo = gray(0.25);
                }
            }
            if x > 0.45 && n.x > 0.2 {
                if y < 0.60 && z > 0.22 && z < 0.40 {
                    out.albedo = gray(0.010 + select(0.0, 0.03, fraction(p.z * 36.0) > 0.6));
                    out.mirror = 0.02;
                }
                if y < 0.30 && z > 0.25 && z < 0.32 {
                    out.albedo = gray(0.62);
                }
            }
            let corner = abs(x) > 0.43 && y > 0.50 && abs(n.x) + abs(n.y) > 0.4;
            if x > 0.43 && corner && z > 0.365 && z < 0.455 {
                out.albedo = gray(0.55);
                out.mirror = 0.08;
                out.gloss = 0.97;
                out.emit = head_color * lamps * ramp(0.2, 0.7, n.x);
            }
            if x < -0.455 && y > 0.48 && z > 0.40 && z < 0.535 && n.x < 0.3 {
                out.albedo = vec3f(0.32, 0.008, 0.010);
                out.mirror = 0.06;
                out.gloss = 0.95;
                let aside = max(abs((z - 0.4675) / 0.0675), abs(y - 0.74) / 0.26);
                out.emit = tail_color * (0.03 + lamps * (0.40 + 0.85 * ramp(1.0, 0.25, aside)));
            }
            if x < -0.47 && n.x < -0.5 && y < 0.3 && z > 0.36 && z < 0.44 {
                out.albedo = gray(0.62);
                out.mirror = 0.0;
            }
        }
        case 1u: { // Cabin
            out.albedo = paint;
            out.mirror = 0.05;
            out.gloss = 0.96;
            let truck = !car;
            let low = select(0.585, 0.48, truck);
            let high = select(0.925, 0.76, truck);
            let across = 0.93 - 0.21 * clamp((z - 0.58) / 0.38, 0.0, 1.0);
            var pane: bool;
            if abs(n.y) > 0.75 {
                if truck {
                    pane = abs(x - 0.9) * size.x > 0.045;
                } else {
                    pane = abs(x + 0.035) * size.x > 0.045 && abs(x + 0.225) * size.x > 0.045;
                }
            } else {
                pane = y < across * 0.94 || (truck && y < 0.84);
            }
            if z > low && z < high && n.z < 0.86 && pane {
                out.albedo = gray(0.012);
                out.mirror = 0.075;
                out.gloss = 0.99;
            }
            if truck && n.x > 0.5 && z < 0.34 {
                out.albedo = gray(0.03);
                if y > 0.58 && z > 0.2 && z < 0.28 {
                    out.albedo = gray(0.5);
                    out.emit = head_color * lamps;
                }
            }
        }
        case 2u: { // Coach
            out.albedo = paint;
            out.mirror = 0.05;
            out.gloss = 0.93;
            if z < 0.16 {
                out.albedo = gray(0.02);
            }
            let side = abs(n.y) > 0.6;
            let window = z > 0.40 && z < 0.74 && abs(n.z) < 0.5;
            let post = side && abs(abs(fraction(p.x / 1.45)) - 0.5) > 0.47;
            if window && !post && (side || y < 0.88) {
                out.albedo = gray(0.014);
                out.mirror = 0.075;
                out.gloss = 0.99;
                out.emit = vec3f(1.0, 0.86, 0.62) * 0.16 * ramp(0.5, 1.0, a_lamps());
            }
            if z > 0.80 && z < 0.90 && n.x > 0.6 && y < 0.7 {
                out.albedo = gray(0.01);
                out.emit = vec3f(1.0, 0.55, 0.1) * (0.25 + 1.2 * lamps)
                    * select(0.0, 1.0, unit3(vec3i(floor(p * 22.0)), id) > 0.55);
            }
            for (var k = 0; k < 2; k++) {
                let wheel = select(0.33, -0.28, k == 0);
                if side && length(vec2f(p.x - wheel * size.x, p.z - 0.48)) < 0.56 {
                    out.albedo = gray(0.006);
                    out.mirror = 0.0;
                }
            }
            if abs(n.x) > 0.6 && y > 0.62 && z > 0.17 && z < 0.25 {
                out.emit = select(tail_color * 0.9, head_color, n.x > 0.0) * lamps;
                out.albedo = select(vec3f(0.3, 0.01, 0.01), gray(0.5), n.x > 0.0);
            }
            if n.x > 0.6 && z > 0.30 && z < 0.74 && y < 0.9 {
                out.albedo = gray(0.014);
                out.mirror = 0.075;
                out.gloss = 0.99;
                out.emit = vec3f(0.0);
            }
        }
        case 3u: { // Cargo
            let rib = abs(abs(fraction(p.x / 0.42)) - 0.5);
            out.albedo = paint * (0.92 + 0.08 * unit(id));
            if abs(n.y) > 0.6 {
                out.albedo *= 1.0 - 0.10 * visible(fp, 0.2) * ramp(0.40, 0.48, rib);
            }
            out.albedo *= 1.0 - 0.25 * ramp(0.55, 0.25, z) * value2(vec2f(p.x, p.z) * 2.0, id);
            out.mirror = 0.03;
            out.gloss = 0.6;
            if n.x < -0.6 && z < 0.36 && y > 0.68 {
                out.albedo = vec3f(0.3, 0.01, 0.01);
                out.emit = tail_color * (0.03 + 0.87 * lamps);
            }
            if n.x < -0.6 && y < 0.02 {
                out.albedo *= 0.4;
            }
        }
        case 4u: { // Wheel
            out.albedo = gray(0.010);
            if abs(n.y) > 0.7 {
                if car {
                    let one = vec2f(p.x + 0.295 * size.x, p.z - wheel_radius);
                    let two = vec2f(p.x - 0.3 * size.x, p.z - wheel_radius);
                    let q = select(two, one, length(one) <= length(two));
                    let d = length(q) / wheel_radius;
                    let spoke = abs(fraction(atan2(q.y, q.x) * 5.0 / 6.2831853));
                    if d < 0.70 && (!(d >= 0.2 && d <= 0.62) || abs(spoke - 0.5) < 0.30) {
                        out.albedo = gray(0.34);
                        out.mirror = 0.10;
                        out.gloss = 0.8;
                    }
                }
                if class_id == BICYCLE {
                    out.albedo = gray(0.04);
                }
            }
        }
        case 5u: { // Dark
            out.albedo = gray(0.022);
        }
        case 6u: { // Plain
            out.albedo = tint;
            out.mirror = 0.03;
            out.gloss = 0.5;
        }
        case 7u: { // Cloth
            out.albedo = tint * (0.72 + 0.5 * value3(p * vec3f(14.0, 14.0, 7.0), id));
        }
        case 8u: { // Skin
            var tones = array<vec3f, 3>(vec3f(224.0, 172.0, 136.0), vec3f(190.0, 130.0, 96.0), vec3f(120.0, 78.0, 54.0));
            let tone = tones[id % 3u];
            out.albedo = srgb(tone.x, tone.y, tone.z);
        }
        default: { // Bands
            var banded = (z > 0.42 && z < 0.60) || (z > 0.72 && z < 0.82);
            if class_id != TRAFFIC_CONE {
                let wide = select(p.x, p.y, size.y > size.x);
                banded = modulo((wide + p.z * 0.8) / 0.5, 1.0) < 0.5;
            }
            out.albedo = select(tint, gray(0.75), banded);
        }
    }
    return out;
}

fn surface(hit: Met, p: vec3f, start: vec3f, fp: f32) -> Surface {
    if hit.kind == KIND_GROUND {
        return ground_surface(p, start, fp);
    }
    if hit.kind == KIND_VOXEL {
        return voxel_surface(p, hit.which, start, fp);
    }
    let a = thing_word(hit.which);
    var s = thing_surface(a, hit.part, thing_turn(a, p - thing_foot(a)), thing_turn(a, start), fp);
    s.normal = start;
    return cover(s, p, 0.75);
}

// ---- shade.rs

fn openness(hit: Met, p: vec3f, n: vec3f) -> f32 {
    let up = vec3f(0.0, 0.0, 1.0);
    let leafy = hit.kind == KIND_VOXEL && hit.which == VEGETATION;
    let side = normal_or(vec3f(-n.y, n.x, 0.0), vec3f(1.0, 0.0, 0.0)) * 1.3;
    var at = array<vec4f, 8>(
        vec4f(n * 0.45 + up * 0.1, 0.34), vec4f(n + up * 0.35, 0.26), vec4f(n * 1.6 + up * 1.2, 0.16),
        vec4f(up * 2.4 + n * 0.8, 0.14), vec4f(n * 0.7 + side, 0.10), vec4f(n * 0.7 - side, 0.10),
        vec4f(up * 0.9, 0.10), vec4f(up * 1.8, 0.10),
    );
    var closed = 0.0;
    for (var k = 0; k < 8; k++) {
        if k == 6 {
            if !leafy {
                break;
            }
            closed *= 0.9;
        }
        closed += at[k].w * field_dense(p + at[k].xyz);
    }
    var open = clamp(1.0 - closed, 0.12, 1.0);
    if p.z < 2.5 {
        let near = things_near(p.xy);
        for (var k = near.x; k < near.y; k++) {
            let i = words[section(12u) + k];
            let a = thing_word(i);
            let size = thing_size(a);
            let q = thing_turn(a, p - thing_foot(a));
            if hit.kind == KIND_GROUND {
                let beside = length(max(abs(q.xy) - size.xy / 2.0, vec2f(0.0)));
                let small = min(min(size.x, size.y) / 1.6, 1.0);
                open *= 1.0 - 0.80 * small * ramp(0.55 * min(size.z, 1.6), 0.0, beside);
            } else if hit.kind == KIND_THING && hit.which == i {
                open *= 0.62 + 0.38 * ramp(0.0, 0.35, clamp(q.z / size.z, 0.0, 1.0));
            }
        }
    }
    return open;
}

fn lamp_light(p: vec3f, lift: vec3f, n: vec3f, to_eye: vec3f, s: Surface, shadows: bool) -> vec3f {
    var out = vec3f(0.0);
    for (var i = 0u; i < section(20u); i++) {
        let a = section(19u) + i * 12u;
        let to = num3(a) - p;
        let d2 = dot(to, to);
        let range_m = num(a + 3u);
        if d2 > range_m * range_m {
            continue;
        }
        let axis = num3(a + 4u);
        let l = to / max(sqrt(d2), 1e-3);
        let facing = dot(n, l);
        let cosine = -dot(l, axis);
        let kind = words[a + 7u];
        var beam: f32;
        if kind == 0u {
            beam = ramp(-0.15, 0.6, cosine);
        } else if kind == 1u {
            let up = -l.z - axis.z;
            let aim = min(pow(0.055 / (0.022 + max(-up, 0.0)), 1.25), min(2.4, 0.12 * sqrt(d2)));
            beam = ramp(0.80, 0.985, cosine) * (0.07 + 0.93 * ramp(0.025, -0.02, up)) * aim + 0.02 * ramp(0.2, 0.9, cosine);
        } else {
            beam = ramp(-0.1, 0.8, cosine);
        }
        if beam <= 0.0 {
            continue;
        }
        let fade = ramp(1.0, 0.55, sqrt(d2) / range_m);
        let near = select(0.6, HEAD_NEAR_M2, kind == 1u);
        let shine = num3(a + 8u) * (beam * fade / (d2 + near));
        let behind = s.through * max(-facing, 0.0) * 0.5;
        if shadows && kind != 2u && max(facing, behind) * max3(shine) * a_exposure() > LAMP_SHADOW_LIGHT {
            let way = num3(a) - lift;
            let far = length(way);
            let clear = select(LAMP_CLEAR_M, LAMP_CLEAR_M * far / max(length(way.xy), 1e-3), kind == 0u);
            if far > clear && trace(lift, way / far, far - clear, 2u).kind != KIND_NONE {
                continue;
            }
        }
        out += s.albedo * shine * (max(facing, 0.0) + behind);
        if s.gloss > 0.2 && facing > 0.0 {
            let between = normal_or(l + to_eye, n);
            let power = exp2(2.0 + 7.0 * s.gloss);
            let spot = powi(max(dot(n, between), 0.0), power) * (power + 2.0) * 0.125;
            out += shine * (s.mirror + 0.015) * min(spot, 30.0) * facing;
        }
    }
    return out;
}

// What stands outside the grid in front of `limit`: colour with air, and 1 if anything does.
fn beyond(o: vec3f, d: vec3f, limit: f32) -> vec4f {
    let level = dot(d.xy, d.xy);
    for (var ring = 0; ring < 3; ring++) {
        let radius = select(select(320.0, 150.0, ring == 1), 72.0, ring == 0);
        let b = dot(o.xy, d.xy);
        let c = dot(o.xy, o.xy) - radius * radius;
        let disc = b * b - level * c;
        if level < 1e-8 || disc <= 0.0 || c > 0.0 {
            continue;
        }
        let t = (-b + sqrt(disc)) / level;
        let p = o + d * t;
        if t > limit || p.z < 0.0 || p.z > 60.0 {
            continue;
        }
        var open = 0.0;
        if radius < 100.0 {
            let aside = normal2_or(perp(p.xy), vec2f(0.0));
            for (var k = -3; k <= 3; k++) {
                open += ramp(0.15, 0.6, shares(p.xy + aside * (f32(k) * 2.6)).x) / 4.0;
            }
            open = min(open, 1.0);
        }
        let found = skyline(anchor_dir(p), radius, open);
        if found.w > 0.0 {
            return vec4f(through_air(found.xyz, t, anchor_dir(d)), 1.0);
        }
    }
    return vec4f(0.0);
}

struct Sample {
    color: vec3f,
    t: f32,
    key: u32,
}

// Light along a ray; what it mirrors is followed once, by a second turn of the loop.
fn light_along(eye: vec3f, ray: vec3f, pixel: f32) -> Sample {
    var o = eye;
    var d = ray;
    var out = Sample(vec3f(0.0), INFINITE, 0u);
    // Of the first surface, for when the mirrored light is known.
    var mean = vec3f(0.0);
    var share = 0.0;
    var gloss = 0.0;
    for (var turn = 0u; turn < 2u; turn++) {
        let first = turn == 0u;
        let limit = select(MIRROR_M, FAR_M, first);
        let hit = trace(o, d, limit, turn);
        let met = hit.kind != KIND_NONE && (first || hit.t > 0.02);
        var color = vec3f(0.0);
        var done = !met;
        if !met || (first && hit.t > 55.0) {
            let behind = beyond(o, d, select(INFINITE, hit.t, met));
            if behind.w > 0.0 {
                color = behind.xyz;
                done = true;
                if first && met {
                    out.t = hit.t;
                    out.key = 1u;
                }
            } else if !met {
                color = sky(anchor_dir(d));
            }
        }
        var follow = false;
        var mirrored = vec3f(0.0);
        var lift = vec3f(0.0);
        if !done {
            let p = o + d * hit.t;
            var start = hit.normal;
            if hit.kind == KIND_VOXEL {
                start = field_normal(p, hit.which);
            } else if hit.kind == KIND_GROUND {
                if hit.t < 60.0 {
                    start = ground_normal(p);
                }
            } else {
                let a = thing_word(hit.which);
                let size = thing_size(a);
                let reach = 0.028 * max(size.z, size.x * 0.5);
                start = thing_turn_back(a, rounded(hit.part, thing_turn(a, p - thing_foot(a)), start, reach));
            }
            var fp = 0.05 + hit.t * 0.004;
            if first {
                fp = hit.t * pixel / sqrt(select(0.6, max(-d.z, 0.03), hit.kind == KIND_GROUND));
            }
            let s = surface(hit, p, start, fp);
            let n = s.normal;
            // The side from which light is looked for.
            var geometric = n;
            if hit.kind == KIND_THING {
                geometric = start;
            } else if hit.kind == KIND_GROUND {
                geometric = vec3f(0.0, 0.0, 1.0);
            } else if hit.which == MANMADE {
                geometric = n * 12.0;
            }
            lift = p + geometric * (0.012 + hit.t * 2e-4);
            color = s.emit;
            let sun = a_sun();
            let facing = dot(n, to_sun_in_ego());
            let strength = max3(sun);
            let lit_through = s.through * max(-facing, 0.0);
            if strength > 0.05 && (facing > 0.0 || lit_through > 0.02) {
                var dark = false;
                if first {
                    dark = trace(lift, to_sun_in_ego(), SHADOW_M, 2u).kind != KIND_NONE;
                }
                if !dark {
                    color += s.albedo * sun * (max(facing, 0.0) * (1.0 - 0.3 * s.through) + lit_through * 0.6);
                    if s.gloss > 0.0 {
                        let between = normal_or(to_sun_in_ego() - d, n);
                        let power = exp2(2.0 + 9.0 * s.gloss);
                        let spot = powi(max(dot(n, between), 0.0), power) * (power + 2.0) * 0.125;
                        color += sun * (s.mirror * min(spot, 25.0) * max(facing, 0.0));
                    }
                }
            } else if strength > 0.0 {
                color += s.albedo * sun * max(facing, 0.0);
            }
            let open = openness(hit, p, n);
            let above = 0.5 + 0.5 * n.z;
            let below = mix(a_bounce(), a_ambient() * 0.75, a_snow() * 0.6);
            color += s.albedo * (a_ambient() * above + below * (1.0 - above) + a_horizon() * 0.08) * open;
            if section(20u) > 0u {
                color += lamp_light(p, lift, n, -d, s, first);
            }
            if s.mirror > 0.008 {
                let grazing = powi(1.0 - clamp(-dot(n, d), 0.0, 1.0), 5.0);
                let part = s.mirror + (1.0 - s.mirror) * grazing * s.gloss * s.gloss * 0.85;
                if part > 0.012 {
                    var r = d - n * (2.0 * dot(d, n));
                    if dot(r, n) < 0.0 {
                        r -= n * (2.0 * dot(r, n));
                    }
                    let around = (a_ambient() * 0.6 + a_horizon() * 0.2) * open;
                    if first && s.gloss > 0.55 {
                        follow = true;
                        mirrored = r;
                        mean = around;
                        share = part;
                        gloss = s.gloss;
                    } else {
                        let seen = mix(around, mix(a_horizon(), a_zenith(), max(r.z, 0.0)) * open, ramp(0.2, 0.8, s.gloss));
                        color = mix(color, seen, part);
                    }
                }
            }
            if first {
                out.t = hit.t;
                var kind = 2u;
                if hit.kind == KIND_VOXEL {
                    kind = 8u + hit.which;
                } else if hit.kind == KIND_THING {
                    kind = 64u + hit.which;
                }
                let steps = vec3u(max(s.normal * 3.0 + 4.0, vec3f(0.0)));
                out.key = kind << 8u | ((steps.x + 8u * steps.y + 32u * steps.z) & 255u);
            } else {
                color = through_air(color, hit.t, anchor_dir(d));
            }
        }
        if first {
            out.color = color;
            if done {
                return out;
            }
            if !follow {
                break;
            }
            o = lift;
            d = mirrored;
        } else {
            out.color = mix(out.color, mix(mean, color, ramp(0.2, 0.8, gloss)), share);
        }
    }
    out.color = through_air(out.color, out.t, anchor_dir(ray));
    return out;
}

// ---- render.rs

fn falling(o: vec3f, d: vec3f, t: f32, pixel: f32, start: vec3f) -> vec3f {
    var color = start;
    let rain = a_wet() >= 1.0;
    if !rain && !(a_snow() > 0.0) {
        return color;
    }
    let level = dot(d.xy, d.xy);
    var rain_m = array<f32, 4>(3.2, 5.0, 7.5, 11.0);
    var snow_m = array<f32, 9>(2.9, 4.0, 5.2, 6.6, 8.2, 10.0, 12.5, 15.5, 19.0);
    let layers = select(9u, 4u, rain);
    for (var layer = 0u; layer < layers; layer++) {
        var radius: f32;
        if rain {
            radius = rain_m[layer];
        } else {
            radius = snow_m[layer];
        }
        let b = dot(o.xy, d.xy);
        let c = dot(o.xy, o.xy) - radius * radius;
        let disc = b * b - level * c;
        if level < 1e-6 || disc <= 0.0 || c > 0.0 {
            continue;
        }
        let at = (-b + sqrt(disc)) / level;
        if at > t {
            break;
        }
        let p = anchor_dir(o + d * at);
        let s = atan2(p.y, p.x) * radius;
        let px = at * pixel;
        if rain {
            let size = vec2f(0.11, 0.62);
            let q = vec2f(s + p.z * (0.05 + 0.015 * f32(layer)), p.z + 0.37 * f32(layer)) / size;
            let cell = floor(q);
            let h = hash3(vec3i(vec2i(cell), i32(layer)), seed() ^ 0x7a1u);
            if h % 100u < 40u {
                let x = abs((q.x - cell.x) - 0.2 - 0.6 * unit(h)) * size.x;
                let y = abs(q.y - cell.y - 0.5);
                let wide = max(0.0022, px * 0.55);
                let line = ramp(wide, wide * 0.4, x) * ramp(0.5, 0.25, y);
                color = mix(color, a_ambient() * 0.75 + a_haze() * 0.4, 0.13 * pow(0.0022 / wide, 0.7) * line);
            }
        } else {
            let size = 0.22 + 0.02 * f32(layer);
            let q = vec2f(s, p.z) / size;
            let cell = floor(q);
            let c2 = vec2i(cell);
            let h = hash3(vec3i(c2, i32(layer)), seed() ^ 0x5e0u);
            if h % 100u < 46u {
                let middle = vec2f(unit3(vec3i(c2, 1), h), unit3(vec3i(c2, 2), h)) * 0.7 + 0.15;
                let off = (q - cell - middle) * size * vec2f(1.0, 0.8);
                let flake = 0.0035 + 0.0055 * unit(h);
                let r = max(flake, px * 0.6);
                let share = 0.75 * (flake / r) * (flake / r) * ramp(r * 1.15, r * 0.3, length(off));
                color = mix(color, a_ambient() * 0.95 + a_haze() * 0.1, share);
            }
        }
    }
    return color;
}

fn sample_at(image: vec2f) -> Sample {
    let at = (image - view.lens.zw) / view.lens.xy;
    let d = normal_or(view.columns[0].xyz * at.x + view.columns[1].xyz * at.y + view.columns[2].xyz, vec3f(0.0));
    let o = view.place.xyz;
    let pixel = view.place.w;
    var s = light_along(o, d, pixel);
    s.color = falling(o, d, s.t, pixel, s.color);
    // Nothing that is not a number leaves.
    let ok = s.color >= vec3f(-1e30);
    if !(all(ok) && all(s.color <= vec3f(1e30))) {
        s.color = vec3f(0.0);
    }
    return s;
}

fn tone(c: vec3f) -> f32 { return sqrt((c.x + c.y + c.z) * a_exposure()); }

// One sample in the middle of each pixel.
@compute @workgroup_size(8, 8)
fn middle(@builtin(global_invocation_id) id: vec3u) {
    let p = id.xy + vec2u(0u, view.size.w);
    if p.x >= view.size.x || p.y >= view.size.y {
        return;
    }
    let s = sample_at(vec2f(p) + 0.5);
    let i = p.y * view.size.x + p.x;
    samples[i] = vec4u(bitcast<vec3u>(s.color), s.key);
    light[i] = vec4f(s.color, 0.0);
}

// Four samples where a pixel differs from its neighbours.
@compute @workgroup_size(8, 8)
fn edges(@builtin(global_invocation_id) id: vec3u) {
    let p = id.xy + vec2u(0u, view.size.w);
    if p.x >= view.size.x || p.y >= view.size.y || view.size.x < 2u || view.size.y < 2u {
        return;
    }
    let i = p.y * view.size.x + p.x;
    let own = samples[i];
    let own_tone = tone(bitcast<vec3f>(own.xyz));
    var differs = false;
    for (var k = 0; k < 4; k++) {
        let q = vec2i(p) + select(vec2i(0, select(-1, 1, k == 3)), vec2i(select(-1, 1, k == 1), 0), k < 2);
        if q.x < 0 || q.y < 0 || q.x >= i32(view.size.x) || q.y >= i32(view.size.y) {
            continue;
        }
        let other = samples[u32(q.y) * view.size.x + u32(q.x)];
        let gap = abs(tone(bitcast<vec3f>(other.xyz)) - own_tone);
        differs = differs || gap > CONTRAST || (other.w != own.w && gap > 0.03);
    }
    if !differs {
        return;
    }
    var places = array<vec2f, 4>(vec2f(0.375, 0.125), vec2f(0.875, 0.375), vec2f(0.625, 0.875), vec2f(0.125, 0.625));
    var sum = vec3f(0.0);
    for (var k = 0; k < 4; k++) {
        sum += min(sample_at(vec2f(p) + places[k]).color, vec3f(5.0 / a_exposure()));
    }
    light[i] = vec4f(sum / 4.0, 0.0);
}
