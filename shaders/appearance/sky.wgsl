// Sky, air and what stands beyond the grid.
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

