// Objects as a few bodies each, and rays against them.
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
fn is_scenery(a: u32) -> bool { return words[a + 18u] == 1u; }
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

// The nearer of a hit and another that counts if it lies within the limit.
fn nearer(best: vec4f, t: f32, normal: vec3f, limit: f32) -> vec4f {
    if t > 1e-4 && t < limit && (best.w < 0.0 || t < best.w) {
        return vec4f(normal, t);
    }
    return best;
}
// A limb: see the processor's.
fn cast_limb(a: vec3f, b: vec3f, radii: vec2f, origin: vec3f, d: vec3f, limit: f32) -> vec4f {
    let skipped = dot(a - origin, d) / dot(d, d);
    let o = origin + d * skipped;
    let axis = b - a;
    let start = o - a;
    let thin = radii.x - radii.y;
    let span = dot(axis, axis) - thin * thin;
    var best = vec4f(0.0, 0.0, 1.0, -1.0);
    for (var k = 0; k < 2; k++) {
        let q = o - select(b, a, k == 0);
        let r = select(radii.y, radii.x, k == 0);
        let roots = quadratic(dot(d, d), dot(q, d), dot(q, q) - r * r);
        if roots.z > 0.0 {
            best = nearer(best, skipped + roots.x, (q + d * roots.x) / r, limit);
        }
    }
    if span > 0.0 {
        let w = dot(start, axis) - radii.x * thin;
        let step = dot(d, axis);
        let square = span * dot(d, d) - step * step;
        let half = span * dot(start, d) - w * step;
        let rest = span * (dot(start, start) - radii.x * radii.x) - w * w;
        let under = half * half - square * rest;
        if under >= 0.0 && square != 0.0 {
            for (var k = 0; k < 2; k++) {
                let t = (-half + select(sqrt(under), -sqrt(under), k == 0)) / square;
                let s = (w + step * t) / span;
                let normal = (start + d * t - axis * s) / (radii.x - thin * s);
                if s >= 0.0 && s <= 1.0 && dot(normal, d) < 0.0 {
                    best = nearer(best, skipped + t, normal, limit);
                }
            }
        }
    }
    return best;
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
    if kind == 5u {
        let narrow = vec3f(1.0, 1.0 / num(a + 13u), 1.0);
        let radii = vec2f(num(a + 11u), num(a + 12u));
        let hit = cast_limb(middle * narrow, num3(a + 8u) * narrow, radii, o * narrow, d * narrow, limit);
        return vec4f(normal_or(hit.xyz * narrow, vec3f(0.0, 0.0, 1.0)), hit.w);
    }
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
    if kind == 4u {
        let radius = num(a + 8u);
        let wide = num(a + 9u);
        let hole = num(a + 10u);
        let p = o - middle;
        var out = none;
        if abs(d.y) > 1e-6 {
            let t = (-wide * sign(d.y) - p.y) / d.y;
            let away = length(p.xz + d.xz * t);
            if away >= hole && away <= radius && t > 1e-4 && t < limit {
                out = vec4f(0.0, -sign(d.y), 0.0, t);
            }
        }
        for (var k = 0; k < 2; k++) {
            let r = select(hole, radius, k == 0);
            let side = select(-1.0, 1.0, k == 0);
            let roots = quadratic(dot(d.xz, d.xz), dot(p.xz, d.xz), dot(p.xz, p.xz) - r * r);
            let t = select(roots.y, roots.x, k == 0);
            let at = p + d * t;
            if roots.z > 0.0 && abs(at.y) <= wide && t > 1e-4 && t < limit && (out.w < 0.0 || t < out.w) {
                out = vec4f(vec3f(at.x, 0.0, at.z) * (side / r), t);
            }
        }
        return out;
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

// True in a place that was cut out of a thing.
fn is_cut(a: u32, p: vec3f) -> bool {
    let cuts = words[a + 19u];
    let first = cuts >> 4u;
    for (var i = 0u; i < (cuts & 15u); i++) {
        if all(p >= plane_at(first + 2u * i).xyz) && all(p <= plane_at(first + 2u * i + 1u).xyz) {
            return true;
        }
    }
    return false;
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
    let size = num3(a + 20u);
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
        if hit.w >= 0.0 && !is_cut(a, origin + dir * hit.w) {
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

