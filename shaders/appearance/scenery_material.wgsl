// Surfaces of scenery: facades, roofs, masonry, boards, concrete, metal, signs, lights, panes.
// ---- material/facade.rs

const STOREY_M: f32 = 3.0;
const CORNER_M: f32 = 0.45;

struct Bays {
    count: f32,
    pitch: f32,
    margin: f32,
}

fn bays_of(length_m: f32, id: u32, kind: f32) -> Bays {
    var wish = 2.1 + 1.2 * unit(hash1(id, 2u));
    if kind > 1.5 {
        wish = 4.6;
    } else if kind > 0.5 {
        wish = 1.5;
    }
    let room = length_m - 2.0 * CORNER_M;
    let count = max(floor(room / wish), 0.0);
    return Bays(count, room / max(count, 1.0), CORNER_M);
}

fn wall_color(style: u32) -> vec3f {
    var colors = array<vec3f, 12>(
        vec3f(0.215, 0.125, 0.085), vec3f(0.160, 0.090, 0.066), vec3f(0.285, 0.204, 0.148), vec3f(0.130, 0.088, 0.072),
        vec3f(0.540, 0.510, 0.450), vec3f(0.420, 0.385, 0.310), vec3f(0.460, 0.360, 0.230), vec3f(0.330, 0.285, 0.230),
        vec3f(0.300, 0.310, 0.300), vec3f(0.560, 0.545, 0.510), vec3f(0.380, 0.270, 0.200), vec3f(0.225, 0.235, 0.230),
    );
    return colors[style % 12u];
}

// From where to where a wall goes along `along`, seen from a point on it.
fn wall_span(part: u32, n: vec3f, along: vec3f, p: vec3f) -> vec2f {
    var low = -200.0;
    var high = 200.0;
    let a = section(9u) + part * PART_WORDS;
    if words[a] != 0u {
        return vec2f(0.0);
    }
    let first = words[a + 5u];
    let end = first + words[a + 6u];
    for (var i = first; i < end; i++) {
        let plane = plane_at(i);
        let rate = dot(plane.xyz, along);
        if abs(rate) < 1e-3 || dot(plane.xyz, n) > 0.9999 {
            continue;
        }
        let reach = (plane.w - dot(plane.xyz, p)) / rate;
        if rate > 0.0 {
            high = min(high, reach);
        } else {
            low = max(low, reach);
        }
    }
    return vec2f(min(low, 0.0), max(high, 0.0));
}

fn facade_bay(from_wall: Surface, id: u32, kind: f32, bays: Bays, u: f32, row: f32, v: f32, height: f32, fp: f32) -> Surface {
    var out = from_wall;
    let column = clamp(floor((u - bays.margin) / bays.pitch), 0.0, bays.count - 1.0);
    let f = vec2f(u - bays.margin - (column + 0.5) * bays.pitch, v - (row + 0.5) * STOREY_M);
    let cell = vec3i(i32(column), i32(row), i32(id));
    let ground_floor = row == 0.0 && height > 0.0;
    let glass_front = kind > 0.5 && kind < 1.5;
    let hall = kind > 1.5;
    let shop = ground_floor && !hall && height > 5.0 && hash1(id, 4u) % 3u == 0u;
    let in_the_middle = column == floor(bays.count / 2.0);
    let door = ground_floor && !shop && !hall && in_the_middle && bays.count > 1.5;
    let gate = ground_floor && hall && (u32(column) + hash1(id, 9u)) % 3u == 0u;
    var size = vec2f(min(bays.pitch * 0.29, 0.72), 0.72);
    var middle = 0.10;
    if gate {
        size = vec2f(min(bays.pitch * 0.36, 1.9), 1.35);
        middle = -0.13;
    } else if hall && ground_floor {
        return out;
    } else if hall {
        size = vec2f(bays.pitch * 0.42, 0.45);
        middle = 0.45;
    } else if door {
        size = vec2f(0.52, 1.08);
        middle = -0.40;
    } else if shop {
        size = vec2f(bays.pitch * 0.42, 1.12);
        middle = -0.22;
    } else if glass_front {
        size = vec2f(bays.pitch * 0.47, 1.22);
        middle = 0.0;
    }
    let q = vec2f(abs(f.x), abs(f.y - middle));
    let d = max(q.x - size.x, q.y - size.y);
    let trim = gray(select(0.05, 0.52, unit(hash1(id, 5u)) > 0.4 && !glass_front));
    let frame = band(abs(d - 0.03), 0.05, fp);
    out.albedo = mix(out.albedo, trim, frame * 0.9);
    if !door && !gate && !glass_front {
        let sill = band(abs(f.y - middle + size.y + 0.09), 0.05, fp) * band(q.x, size.x + 0.1, fp);
        out.albedo = mix(out.albedo, gray(0.42), sill * 0.8);
    }
    let open = ramp(0.004 + fp * 0.3, -0.004 - fp * 0.3, d);
    if open <= 0.0 {
        return out;
    }
    let shade = 1.0 - 0.55 * ramp(0.16, 0.02, middle + size.y - f.y);
    if door || gate {
        var colors = array<vec3f, 4>(
            vec3f(78.0, 58.0, 44.0), vec3f(54.0, 62.0, 56.0), vec3f(60.0, 64.0, 74.0), vec3f(132.0, 128.0, 120.0),
        );
        let slat = select(abs(abs(f.x) - 0.25) * 2.0, abs(fraction(f.y / 0.28) - 0.5), gate);
        let tone = colors[hash1(id, 10u) % 4u];
        let leaf = srgb(tone.x, tone.y, tone.z) * (1.0 - 0.3 * visible(fp, 0.12) * ramp(0.1, 0.02, slat));
        out.albedo = mix(out.albedo, leaf * shade, open);
        out.mirror = 0.03 * open;
        out.gloss = 0.4;
        return out;
    }
    var bars = band(abs(q.x - size.x / 2.0), 0.03, fp);
    if !(shop || glass_front) {
        bars = max(band(abs(f.x), 0.03, fp), band(abs(f.y - middle - 0.25), 0.025, fp));
    }
    let drawn = !shop && f.y - middle > size.y * (1.0 - 2.0 * ramp(0.45, 1.0, unit3(cell, 6u)));
    let inside = select(gray(0.020), gray(0.28) * vec3f(1.0, 0.96, 0.88), drawn);
    out.albedo = mix(out.albedo, mix(inside, trim, bars * 0.8) * shade, open);
    out.mirror = 0.085 * open * (1.0 - bars);
    out.gloss = 0.97;
    if a_lamps() > 0.0 && unit3(cell, 7u) < 0.38 {
        let warm = mix(vec3f(1.0, 0.70, 0.38), vec3f(0.85, 0.92, 1.0), ramp(0.26, 0.3, unit3(cell, 8u) * 0.4));
        let room = 0.55 + 0.45 * (1.0 - q.y / size.y) + 0.25 * (value2(f * 2.5 + column * 7.0, 9u) - 0.5);
        let night = ramp(0.1, 1.0, a_lamps());
        let goods = value2(vec2f(f.x * 5.0 + column * 3.0, floor(f.y / 0.42) * 7.0), 11u);
        let shelf = abs(abs(fraction(f.y / 0.42)) - 0.5);
        var in_room = 1.0 - 0.65 * ramp(size.x * 0.55, size.x * 0.8, q.x);
        if shop {
            in_room = (0.25 + 0.75 * goods) * (1.0 - 0.6 * ramp(0.40, 0.47, shelf));
        }
        out.emit = warm * (room * in_room * open * (1.0 - bars) * (0.12 + 0.45 * night) * select(1.0, 0.55, drawn));
    }
    return out;
}

fn walls_surface(a: u32, part: u32, walls: vec3f, p: vec3f, n: vec3f, q: vec3f, fp: f32) -> Surface {
    let id = words[a + 1u];
    let along = normal_or(vec3f(-n.y, n.x, 0.0), vec3f(1.0, 0.0, 0.0));
    let span = wall_span(part, n, along, p);
    let u = -span.x;
    let v = p.z - num(a + 17u);
    let height = walls.x;
    let first = walls.y;
    let kind = walls.z;
    let style = hash1(id, 1u) % 12u;
    let hall = kind > 1.5;
    var wall: vec3f;
    if hall {
        wall = wall_color(4u + style % 8u) * 0.8;
    } else {
        wall = wall_color(style);
    }
    let stain = value3(q * 0.35, 14u) + 0.5 * value3(q * 1.1, 15u) + 0.25 * value3(q * 3.1, 13u);
    wall *= 0.74 + 0.30 * stain;
    wall *= 1.0 - 0.28 * ramp(0.9, 0.0, v) * (0.4 + 0.6 * value3(q * 1.2, 16u));
    let streak = value2(vec2f(dot(q.xy, along.xy) * 2.2, q.z * 0.12), 12u);
    wall *= 1.0 - 0.16 * ramp(2.2, 0.0, height - v) * ramp(0.45, 0.9, streak);
    if hall {
        let rib = abs(fraction(u / 0.3) - 0.5);
        wall *= 1.0 - 0.22 * visible(fp, 0.16) * ramp(0.30, 0.45, rib);
    } else if style < 4u {
        let row = floor(v / 0.075);
        let x = u / 0.25 + 0.5 * modulo(row, 2.0);
        let joint = band(0.5 - abs(v / 0.075 - row - 0.5), 0.08, fp / 0.075);
        let tone = unit3(vec3i(i32(floor(x)), i32(row), 3), id);
        wall *= 1.0 + visible(fp, 0.09) * (0.40 * (tone - 0.5) - 0.16 * joint);
    } else {
        wall *= 1.0 + visible(fp, 0.05) * 0.10 * (value3(q * 24.0, 18u) - 0.5);
    }
    var out = matt(wall, n);
    if height < 2.4 {
        return out;
    }
    let plinth = ramp(0.5 + fp * 0.5, 0.49 - fp * 0.5, v);
    out.albedo = mix(out.albedo, gray(0.16) * (0.8 + 0.4 * stain * 0.6), 0.75 * plinth);
    let cornice = band(abs(height - 0.16 - v), 0.16, fp);
    out.albedo = mix(out.albedo, gray(0.36), 0.55 * cornice);
    let bays = bays_of(span.y - span.x, id, kind);
    let row = floor((v - first) / STOREY_M);
    if bays.count < 1.0 || row < 0.0 || (row + 1.0) * STOREY_M + first > height + 0.35 {
        return out;
    }
    return facade_bay(out, id, kind, bays, u, row, v - first, select(height, 0.0, first > 0.0), fp);
}

// ---- material/scenery.rs

fn gravel(q: vec3f, n: vec3f, fp: f32) -> Surface {
    let grain = value2(q.xy * 11.0, 19u) - 0.5;
    let stain = value2(q.xy * 0.5, 33u) + 0.5 * value2(q.xy * 1.7, 34u);
    let c = gray(0.17) * (0.72 + 0.36 * stain) * (1.0 + 0.5 * grain * visible(fp, 0.09));
    return matt(c * vec3f(1.0, 0.97, 0.92), n);
}

fn concrete(color: vec3f, q: vec3f, n: vec3f, fp: f32) -> Surface {
    let stain = value3(q * 0.6, 51u) + 0.5 * value3(q * 1.9, 52u) + 0.25 * value3(q * 6.0, 53u);
    let pores = (value3(q * 30.0, 54u) - 0.5) * visible(fp, 0.03);
    return matt(color * (0.72 + 0.32 * stain + 0.12 * pores), n);
}

fn tiles(color: vec3f, id: u32, u: f32, p: vec3f, q: vec3f, n: vec3f, fp: f32) -> Surface {
    if n.z < 0.25 {
        return concrete(wall_color(hash1(id, 1u) % 12u), q, n, fp);
    }
    let steep = sqrt(max(1.0 - n.z * n.z, 0.01));
    let row = floor(p.z / steep / 0.32);
    let column = floor(u / 0.24 + 0.5 * (row % 2.0));
    let tone = unit3(vec3i(i32(column), i32(row), 7), id);
    let down = p.z / steep / 0.32 - row;
    let shade = visible(fp, 0.22);
    let moss = ramp(0.55, 0.9, value2(q.xy * 0.8 + p.z * 0.3, 35u)) * 0.35;
    var c = color * (0.86 + 0.28 * value2(q.xy * 0.35, 36u));
    c *= 1.0 + shade * (0.42 * (tone - 0.5) - 0.35 * ramp(0.18, 0.0, down));
    return matt(mix(c, vec3f(0.055, 0.065, 0.03), moss), n);
}

fn masonry(color: vec3f, id: u32, u: f32, p: vec3f, q: vec3f, n: vec3f, fp: f32) -> Surface {
    var c = color * (0.78 + 0.3 * value3(q * 0.9, 37u) + 0.12 * value3(q * 3.0, 38u));
    if n.z < 0.7 {
let row = floor(p.z / 0.15);
        let x = u / 0.32 + 0.5 * (row % 2.0);
        let tone = unit3(vec3i(i32(floor(x)), i32(row), 3), id);
        let joint = max(
            band(0.5 - abs(p.z / 0.15 - row - 0.5), 0.07, fp / 0.15), band(0.5 - abs(x - floor(x) - 0.5), 0.035, fp / 0.32),
        );
        let shown = visible(fp, 0.13);
        c *= 1.0 + shown * (0.20 * (tone - 0.5) + 0.10 * (value3(q * 14.0, 41u) - 0.5));
        c = mix(c, gray(0.24), 0.75 * joint * shown);
        c *= 1.0 - 0.22 * ramp(0.5, 0.1, p.z);
    }
    return matt(c, n);
}

fn boards(color: vec3f, id: u32, u: f32, p: vec3f, q: vec3f, n: vec3f, fp: f32) -> Surface {
    let x = u / 0.13;
    let board = floor(x);
    let tone = unit3(vec3i(i32(board), 5, 5), id);
    let gap = band(0.5 - abs(x - board - 0.5), 0.06, fp / 0.13);
    let grain = value3(q * vec3f(22.0, 22.0, 1.6), 39u) - 0.5;
    var c = color * (0.80 + 0.25 * value3(q * 0.8, 40u));
    c *= 1.0 + visible(fp, 0.11) * (0.40 * (tone - 0.5) - 0.75 * gap) + 0.30 * grain * visible(fp, 0.04);
    return matt(c * (1.0 - 0.25 * ramp(0.45, 0.1, p.z)), n);
}

fn metal(color: vec3f, q: vec3f, n: vec3f) -> Surface {
    var s = matt(color * (0.9 + 0.2 * value3(q * 3.0, 20u)), n);
    s.mirror = 0.04;
    s.gloss = 0.45;
    return s;
}

fn pane(u: f32, p: vec3f, n: vec3f, fp: f32) -> Surface {
    let x = u / 1.2;
    let bar = max(band(0.5 - abs(x - floor(x) - 0.5), 0.035, fp / 1.2), band(abs(p.z - 0.95), 0.03, fp));
    var s = matt(mix(vec3f(0.085, 0.105, 0.105), gray(0.11), bar), n);
    s.mirror = 0.08 * (1.0 - bar);
    s.gloss = 0.95;
    return s;
}

fn within(d: f32, edge: f32) -> f32 { return ramp(edge, -edge, d); }
fn bar_at(at: vec2f, middle: vec2f, size: vec2f, edge: f32) -> f32 {
    let d = abs(at - middle) - size;
    return within(max(d.x, d.y), edge);
}

fn sign_surface(plate: vec3f, id: u32, p: vec3f, n: vec3f, fp: f32) -> Surface {
    var s = matt(gray(0.24), n);
    s.mirror = 0.04;
    s.gloss = 0.5;
    if n.x < 0.7 {
        return s;
    }
    let at = vec2f(p.y, p.z - plate.x) / plate.y;
    let edge = max(fp / plate.y * 0.6, 0.012);
    let white = gray(0.62);
    let red = srgb(178.0, 22.0, 26.0);
    var base = srgb(18.0, 72.0, 140.0);
    var over = 0.0;
    var mark = 0.0;
    var color = white;
    switch hash1(id, 22u) % 4u {
        case 0u: {
            let digit = length(at - vec2f(0.22, 0.0));
            base = white;
            over = within(abs(length(at) - 0.78) - 0.13, edge);
            mark = max(
                max(bar_at(at, vec2f(-0.26, 0.0), vec2f(0.06, 0.34), edge), within(digit - 0.30, edge) - within(digit - 0.17, edge)),
                0.0,
            );
            color = gray(0.015);
        }
        case 1u: {
            mark = within(max(abs(at.x) * 0.86 + (at.y + 0.12) * 0.5 - 0.36, -0.62 - at.y), edge) * 0.98;
            let figure = max(
                bar_at(at, vec2f(0.0, -0.18), vec2f(0.05, 0.22), edge), within(length(at - vec2f(0.0, 0.14)) - 0.08, edge),
            );
            color = mix(white, gray(0.015), figure);
        }
        case 2u: {
            let r = length(at - vec2f(-0.02, 0.26));
            let bowl = within(abs(r - 0.24) - 0.10, edge) * ramp(-0.14, -0.10, at.x);
            mark = max(bar_at(at, vec2f(-0.2, 0.0), vec2f(0.11, 0.58), edge), bowl);
        }
        default: {
            let head = within(max(abs(at.x) + at.y - 0.62, 0.22 - at.y), edge);
            mark = max(bar_at(at, vec2f(0.0, -0.14), vec2f(0.12, 0.44), edge), head);
        }
    }
    let rim = within(0.93 - max(abs(at.x), abs(at.y)), edge);
    s.albedo = mix(mix(mix(base, red, over), color, mark), white, rim);
    return s;
}

fn signal_surface(head: vec3f, id: u32, p: vec3f, n: vec3f) -> Surface {
    var s = matt(gray(0.018), n);
    s.mirror = 0.03;
    s.gloss = 0.4;
    if n.x < 0.7 {
        return s;
    }
    var colors = array<vec3f, 3>(vec3f(0.05, 0.9, 0.35), vec3f(1.0, 0.55, 0.05), vec3f(1.0, 0.06, 0.03));
    var states = array<u32, 4>(0u, 2u, 2u, 0u);
    let lit = states[hash1(id, 21u) % 4u];
    for (var k = 0u; k < 3u; k++) {
        let middle = head.x + head.y * 0.62 * (f32(k) - 1.0);
        let off = length(vec2f(p.y - head.z, p.z - middle));
        if off < head.y * 0.24 {
            s.albedo = colors[k] * 0.06 + gray(0.01);
            if k == lit {
                s.emit = colors[k] * (1.1 + 1.9 * a_lamps()) * ramp(head.y * 0.30, head.y * 0.1, off);
            }
        }
    }
    return s;
}

fn lamp_surface(a: u32, p: vec3f, n: vec3f) -> Surface {
    var s = matt(gray(0.12), n);
    s.mirror = 0.04;
    s.gloss = 0.45;
    if n.z < -0.5 && p.x > thing_size(a).x / 2.0 - 0.55 {
        s.albedo = gray(0.5);
        s.emit = vec3f(1.0, 0.74, 0.42) * 3.5 * a_lamps();
    }
    return s;
}

// `p` and `n` in box coordinates; the normal stays there too.
fn scenery_surface(a: u32, part: u32, p: vec3f, n: vec3f, fp: f32) -> Surface {
    let id = words[a + 1u];
    let q = p + vec3f(unit(hash1(id, 31u)), unit(hash1(id, 32u)), 0.0) * 64.0;
    let u = dot(p.xy, normal2_or(vec2f(-n.y, n.x), vec2f(1.0, 0.0)));
    let own = section(9u) + part * PART_WORDS;
    let color = num3(own + 2u);
    switch words[own + 1u] {
        case 10u: {
            if abs(n.z) < 0.7 {
                return walls_surface(a, part, color, p, n, q, fp);
            }
            return gravel(q, n, fp);
        }
        case 11u: { return tiles(color, id, u, p, q, n, fp); }
        case 12u: { return masonry(color, id, u, p, q, n, fp); }
        case 13u: { return boards(color, id, u, p, q, n, fp); }
        case 14u: { return concrete(color, q, n, fp); }
        case 15u: { return metal(color, q, n); }
        case 16u: { return sign_surface(color, id, p, n, fp); }
        case 17u: { return signal_surface(color, id, p, n); }
        case 18u: { return lamp_surface(a, p, n); }
        case 19u: { return pane(u, p, n, fp); }
        case 6u: {
            var s = metal(select(color, color * 0.25, n.z > 0.7), q, n);
            s.mirror = 0.03;
            s.gloss = 0.5;
            return s;
        }
        default: { return matt(gray(0.2), n); }
    }
}
