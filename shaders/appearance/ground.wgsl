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

// ---- relief.rs

const RELIEF_STEP_M: f32 = 0.2;
const SLOPE_M: f32 = 0.6;

fn has_relief() -> bool { return words[section(23u)] == 1u; }
fn relief_at(p: vec2f) -> f32 {
    let n = columns();
    let q = clamp((p - low_m()) * 2.5 - 0.5, vec2f(0.0), max(vec2f(n) - 1.001, vec2f(0.0)));
    let c = floor(q);
    let f = q - c;
    let i = section(23u) + 1u + u32(c.x) * n.y + u32(c.y);
    let right = select(0u, n.y, n.x > 1u);
    let up = select(0u, 1u, n.y > 1u);
    return mix(mix(num(i), num(i + up), f.y), mix(num(i + right), num(i + right + up), f.y), f.x);
}
fn ground_base(p: vec2f) -> f32 {
    if has_relief() {
        return relief_at(p);
    }
    return 0.0;
}
fn ground_slope(p: vec2f) -> vec2f {
    if !has_relief() {
        return vec2f(0.0);
    }
    let x = vec2f(SLOPE_M, 0.0);
    let y = vec2f(0.0, SLOPE_M);
    return vec2f(relief_at(p + x) - relief_at(p - x), relief_at(p + y) - relief_at(p - y)) / (2.0 * SLOPE_M);
}
// How far a point of a ray is above the ground.
fn relief_above(o: vec3f, d: vec3f, t: f32) -> f32 {
    let p = o + d * t;
    let over = p.z - relief_at(p.xy);
    if over > HIGHEST_M || t > 60.0 {
        return over;
    }
    return ground_above(p);
}
fn relief_beyond(o: vec3f, d: vec3f, from_m: f32, limit: f32) -> f32 {
    if d.z >= -1e-5 {
        return limit;
    }
    var t = from_m;
    for (var k = 0; k < 3; k++) {
        t = (relief_at((o + d * t).xy) - o.z) / d.z;
    }
    return select(limit, t, t > from_m && t < limit);
}
// Distance where a ray meets ground that is not level, `limit` for none.
fn relief_cast(o: vec3f, d: vec3f, limit: f32) -> f32 {
    let block_m = BLOCK_M;
    let n = (columns() + u32(BLOCK) - 1u) / u32(BLOCK);
    let size = vec2f(columns()) / 2.5;
    var t0 = 0.0;
    var t1 = limit;
    for (var a = 0u; a < 2u; a++) {
        let lo = low_m()[a];
        let hi = lo + size[a];
        if abs(d[a]) < 1e-9 {
            if o[a] < lo || o[a] > hi {
                return relief_beyond(o, d, 0.0, limit);
            }
        } else {
            let x = (lo - o[a]) / d[a];
            let y = (hi - o[a]) / d[a];
            t0 = max(t0, min(x, y));
            t1 = min(t1, max(x, y));
        }
    }
    if !(t0 < t1) {
        return relief_beyond(o, d, 0.0, limit);
    }
    let before_map = relief_beyond(o, d, 0.0, t0);
    if before_map < t0 {
        return before_map;
    }
    let level = length(d.xy);
    let q = (o.xy - low_m()) / block_m;
    let qd = d.xy / block_m;
    var cell = min(vec2u(max(q + qd * (t0 + 1e-4), vec2f(0.0))), n - 1u);
    var t = t0;
    var was_above = false;
    let bounds = section(23u) + 1u + columns().x * columns().y;
    for (var k = 0u; k < n.x + n.y + 2u; k++) {
        var next = vec2f(INFINITE);
        for (var a = 0u; a < 2u; a++) {
            if abs(qd[a]) >= 1e-9 {
                next[a] = (f32(cell[a] + select(0u, 1u, qd[a] > 0.0)) - q[a]) / qd[a];
            }
        }
        let t_out = min(min(next.x, next.y), t1);
        let highest = num(bounds + 2u * (cell.x * n.y + cell.y) + 1u);
        if min(o.z + d.z * t, o.z + d.z * t_out) > highest + HIGHEST_M {
            was_above = true;
        } else {
            let steps = clamp(ceil((t_out - t) * max(level, 0.2) / RELIEF_STEP_M), 1.0, 64.0);
            var before = t;
            for (var i = 0u; i <= u32(steps); i++) {
                let at = t + (t_out - t) * f32(i) / steps;
                if relief_above(o, d, at) > 0.0 {
                    was_above = true;
                    before = at;
                } else if was_above {
                    var outside = before;
                    var within = at;
                    for (var r = 0; r < 8; r++) {
                        let middle = (outside + within) * 0.5;
                        if relief_above(o, d, middle) <= 0.0 {
                            within = middle;
                        } else {
                            outside = middle;
                        }
                    }
                    return min(within, limit);
                }
            }
        }
        if t_out >= t1 {
            break;
        }
        let a = select(0u, 1u, next.y < next.x);
        if qd[a] > 0.0 {
            if cell[a] + 1u >= n[a] {
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
    return relief_beyond(o, d, t1, limit);
}

// ---- ground.rs

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
    return GroundAt(share, inside_road_m, ground_base(p) + height);
}
fn ground_above(p: vec3f) -> f32 { return p.z - ground_at(p.xy, anchor(p).xy).height_m; }

// Distance where a ray meets the ground, `limit` for none.
fn ground_cast(o: vec3f, d: vec3f, limit: f32) -> f32 {
    if has_relief() {
        return relief_cast(o, d, limit);
    }
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
    let slope = ground_slope(p.xy);
    if is_level(p.xy) {
        return normalize(vec3f(-slope, 1.0));
    }
    let h = 0.03;
    var n = vec3f(-2.0 * h * slope, 2.0 * h);
    for (var k = 0u; k < 4u; k++) {
        var d = vec3f(0.0);
        let sign = select(-1.0, 1.0, k % 2u == 0u);
        d[k / 2u] = -sign * h;
        n[k / 2u] += sign * (ground_at((p + d).xy, anchor(p + d).xy).height_m - ground_base((p + d).xy));
    }
    return normalize(n);
}

