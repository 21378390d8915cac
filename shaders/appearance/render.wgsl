// Rain and snow, and the samples of a pixel: the entry points.
// ---- render.rs

fn falling(eye: vec3f, d: vec3f, t: f32, pixel: f32, start: vec3f) -> vec3f {
    var color = start;
    let o = eye - vec3f(view.vehicle.xy, 0.0);
    let rain = a_rain();
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
