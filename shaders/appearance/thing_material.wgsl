// Surfaces of objects, and of anything that a ray met.
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
            let wheel = section(9u) + part * PART_WORDS;
            if abs(n.y) > 0.7 && words[wheel] == 1u {
                let middle = num3(wheel + 5u);
                let q = vec2f(p.x - middle.x, p.z - middle.z);
                let d = length(q) / num(wheel + 8u);
                let turn = atan2(q.y, q.x) / 6.2831853;
                let spoke = abs(fraction(turn * 5.0));
                let bolt = abs(abs(fraction(turn * 10.0)) - 0.5);
                let light = d < 0.70 && (!(d >= 0.2 && d <= 0.62) || abs(spoke - 0.5) < 0.30);
                let heavy = d < 0.60 && !(d >= 0.22 && d <= 0.27) && !(d >= 0.33 && d <= 0.39 && bolt < 0.2);
                if (car && light) || (!car && heavy) {
                    out.albedo = select(gray(0.2), gray(0.34), car);
                    out.mirror = 0.10;
                    out.gloss = 0.8;
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
    let local = thing_turn(a, p - thing_foot(a));
    let n = thing_turn(a, start);
    var s: Surface;
    if is_scenery(a) {
        s = scenery_surface(a, hit.part, local, n, fp);
    } else {
        s = thing_surface(a, hit.part, local, n, fp);
    }
    s.normal = start;
    return cover(s, p, 0.75);
}

