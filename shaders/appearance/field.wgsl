// Voxels as a softened field, and the first surface of it along a ray.
// ---- field.rs

fn to_field(p: vec3f) -> vec3f { return (p - vec3f(low_m(), BOTTOM_M)) * 2.5 + 0.5; }
fn in_field(q: vec3f) -> bool {
    return all(q >= vec3f(0.0)) && all(q < vec3f(vec3u(view.field.xy, NZ) - 1u));
}
fn field_at(x: u32, y: u32, z: u32) -> u32 { return (x * view.field.y + y) * NZ + z; }
fn field_column(i: u32, share: f32) -> f32 {
    let low = f32(byte(section(0u), i));
    return low + (f32(byte(section(0u), i + 1u)) - low) * share;
}
fn blend(q: vec3f) -> f32 {
    let c = floor(q);
    let f = q - c;
    let i = field_at(u32(c.x), u32(c.y), u32(c.z));
    let low = mix(field_column(i, f.z), field_column(i + NZ, f.z), f.y);
    let j = i + view.field.y * NZ;
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
    if !in_field(q) || !mask_bit(u32(q.x) * (view.field.y - 1u) + u32(q.y), u32(q.z)) {
        return 0.0;
    }
    return blend(q);
}
fn label_near(q: vec3f) -> u32 {
    let r = min(vec3u(max(q + 0.5, vec3f(0.0))), vec3u(view.field.xy, NZ) - 1u);
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
    let last = view.field.xy - 1u;
    let c = min(q, last);
    var around = array<vec2u, 9>(
        vec2u(1u, 1u), vec2u(0u, 1u), vec2u(2u, 1u), vec2u(1u, 0u), vec2u(1u, 2u),
        vec2u(0u, 0u), vec2u(0u, 2u), vec2u(2u, 0u), vec2u(2u, 2u),
    );
    for (var k = 0; k < 9; k++) {
        let xy = min(max(c + around[k], vec2u(1u)) - 1u, last);
        let i = words[section(4u) + xy.x * view.field.y + xy.y];
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
    let lo = vec2u(index / blocks().y, index % blocks().y) * BLOCK;
    let cells = view.field.xy - 1u;
    let hi = min(lo + BLOCK, cells) - 1u;
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
        let mask = column_mask(cell.x * cells.y + cell.y);
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

