// The ground: its kinds, heights and normal.
// ---- ground.rs

fn is_level(p: vec2f) -> bool {
    let q = vec2u(clamp((p - low_m()) * 2.5, vec2f(0.0), vec2f(columns()) - 0.5));
    return words[section(7u) + q.x * columns().y + q.y] == 1u;
}
fn share_at(i: u32) -> vec4f {
    let a = section(6u) + i * 4u;
    return vec4f(num3(a), num(a + 3u));
}
fn shares(p: vec2f) -> vec4f {
    let n = columns();
    let q = clamp((p - low_m()) * 2.5 - 0.5, vec2f(0.0), max(vec2f(n) - 1.001, vec2f(0.0)));
    let c = floor(q);
    let f = q - c;
    let i = u32(c.x) * n.y + u32(c.y);
    // To the next column along x and along y, if there is one.
    let right = select(0u, n.y, n.x > 1u);
    let up = select(0u, 1u, n.y > 1u);
    let low = mix(share_at(i), share_at(i + up), f.y);
    let high = mix(share_at(i + right), share_at(i + right + up), f.y);
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

