// What is painted on roads, and the surface of roads.
// ---- march/paint.rs, in f32

fn paint_bits(which: u32, p: vec2f) -> u32 {
    let c = floor((p - low_m()) / VOXEL_M);
    if all(c >= vec2f(0.0)) && all(c < vec2f(columns())) {
        return words[section(which) + u32(c.x) * columns().y + u32(c.y)];
    }
    return 0u;
}
// Distance to the nearest line of a kind and how far along it, negative for none within 1 m.
fn nearest_line(kind: u32, p: vec2f) -> vec2f {
    let c = floor((p - low_m()) / BIN_M);
    var best = vec2f(-1.0, 0.0);
    if !(all(c >= vec2f(0.0)) && all(c < vec2f(view.bins.xy))) {
        return best;
    }
    let bin = section(13u) + u32(c.x) * view.bins.y + u32(c.y);
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

