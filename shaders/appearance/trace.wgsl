// The first surface along a ray.
// ---- prepared.rs

// Beginning and end of the things near a point of the ground.
fn things_near(p: vec2f) -> vec2u {
    let c = floor((p - blocks_from_m()) / BLOCK_M);
    if all(c >= vec2f(0.0)) && all(c < vec2f(blocks())) {
        return block_things(u32(c.x) * blocks().y + u32(c.y));
    }
    return vec2u(0u);
}
fn block_things(block: u32) -> vec2u {
    let a = section(11u) + block;
    return vec2u(words[a], words[a + 1u]);
}

// The first surface along a ray. Modes: 0 camera, 1 mirror, 2 shadow of the sun, 3 of a lamp (anything will do, the
// ground does not count).
fn trace(o: vec3f, d: vec3f, limit: f32, mode: u32) -> Met {
    var hit = nothing(limit);
    if mode < 2u {
        let t = ground_cast(o, d, limit);
        if t < limit {
            hit = Met(t, vec3f(0.0, 0.0, 1.0), KIND_GROUND, 0u, 0u);
        }
    }
    let n = blocks();
    let from_m = blocks_from_m();
    var t0 = 0.0;
    var t1 = hit.t;
    let low = vec3f(from_m, view.vehicle.z);
    let high = vec3f(from_m + vec2f(n) * BLOCK_M, highest_m());
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
    let q = (o.xy - from_m) / BLOCK_M;
    let qd = d.xy / BLOCK_M;
    var cell = min(vec2u(max(q + qd * (t0 + 1e-4), vec2f(0.0))), n - 1u);
    var t = t0;
    for (var i = 0u; i < n.x + n.y + 2u; i++) {
        var next = vec2f(INFINITE);
        for (var a = 0u; a < 2u; a++) {
            if abs(qd[a]) >= 1e-9 {
                next[a] = (f32(cell[a] + select(0u, 1u, qd[a] > 0.0)) - q[a]) / qd[a];
            }
        }
        let t_out = min(min(next.x, next.y), t1);
        let index = cell.x * n.y + cell.y;
        let things = block_things(index);
        for (var k = things.x; k < things.y; k++) {
            let met = cast_thing(words[section(12u) + k], o, d, hit.t);
            if met.t >= 0.0 {
                hit = met;
                if mode >= 2u {
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
                stride = select(0.16, LAMP_STEP_M, mode == 3u);
                begin = max(t, 0.05);
            }
            let met = cast_block(index, o, d, begin, min(t_out, hit.t), stride, leafy);
            if met >= 0.0 && (met < hit.t || mode >= 2u) {
                hit = Met(met, vec3f(0.0), KIND_VOXEL, 0u, 0u);
                if mode >= 2u {
                    return hit;
                }
            }
        }
        if hit.t <= t_out || t_out >= t1 {
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
    if hit.kind == KIND_VOXEL {
        hit.which = label_near(to_field(o + d * hit.t));
    }
    return hit;
}

