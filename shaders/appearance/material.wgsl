// Surfaces of ground, plants, houses and what else is voxels.
fn ground_surface(p: vec3f, normal: vec3f, fp: f32) -> Surface {
    let a = anchor(p).xy;
    let g = ground_at(p.xy, a);
    let edge = max(fp * 0.5, KERB_EDGE_M);
    let on_road = clamp((g.inside_road_m + 0.014) / edge * 0.5 + 0.5, 0.0, 1.0);
    var s = matt(vec3f(0.0), normal);
    if on_road > 0.0 {
        let r = road(p.xy, a, fp, g.inside_road_m);
        s.albedo += r.albedo * on_road;
        s.mirror = r.mirror * on_road;
        s.gloss = r.gloss;
        s.normal = normal_or(mix(s.normal, r.normal, on_road), vec3f(0.0, 0.0, 1.0));
    }
    if on_road < 1.0 {
        let rest = max(1.0 - g.share.x, 1e-3);
        let walk = g.share.y / rest;
        let flat_share = g.share.z / rest;
        let fray = 0.22 * (value2(a * 2.2, 41u) - 0.5) + 0.12 * (value2(a * 9.0, 42u) - 0.5);
        let green = ramp(0.46, 0.54, g.share.w / rest + fray);
        var c = vec3f(0.0);
        if green < 1.0 {
            var paved: vec3f;
            if walk >= flat_share {
                paved = slabs(a, fp);
            } else {
                paved = pavers(a, fp);
            }
            c += paved * (1.0 - green);
        }
        if green > 0.0 {
            c += grass(a, fp) * green;
        }
        let kerb = ramp(0.21, 0.19, -g.inside_road_m) * ramp(0.7, 0.4, g.share.w / rest) * visible(fp, KERB_SEEN_M);
        if kerb > 0.0 {
            let stone = 0.25 + 0.06 * value2(a * 7.0, 43u) + 0.04 * value2(a * 1.1, 44u);
            let side = ramp(0.8, 0.4, normal.z);
            c = mix(c, gray(stone) * vec3f(1.0, 0.985, 0.95) * (1.0 - 0.25 * side), kerb);
        }
        if a_snow() > 0.0 {
            let lies = clamp(0.86 + 0.4 * (value2(a * 1.3, 45u) - 0.5), 0.0, 1.0) * a_snow();
            let drift = 0.72 + 0.13 * value2(a * 0.5, 46u) + 0.06 * value2(a * 2.1, 48u)
                + 0.07 * value2(a * 7.0, 47u) * visible(fp, 0.14);
            c = mix(c, gray(drift) * vec3f(0.965, 0.985, 1.02), lies * ramp(0.35, 0.75, normal.z));
        }
        c *= 1.0 - 0.30 * a_wet();
        c = mix(c, vec3f(0.44, 0.32, 0.18), 0.55 * a_dust());
        s.albedo += c * (1.0 - on_road);
        s.mirror += 0.025 * a_wet() * (1.0 - green) * (1.0 - on_road);
        s.gloss = max(s.gloss, 0.5 * a_wet());
    }
    return s;
}

fn plant(a: vec3f, normal: vec3f, fp: f32) -> Surface {
    var hue = mix(vec3f(0.046, 0.082, 0.022), vec3f(0.082, 0.108, 0.030), value2(a.xy * 0.16, 23u));
    hue = mix(hue, vec3f(0.030, 0.065, 0.025), value2(a.xy * 0.07, 24u));
    let fine = visible(fp, 0.10);
    let leaf = value3(a * 9.0, 25u) * fine + 0.5 * (1.0 - fine);
    let clump = value3(a * 2.3, 26u);
    var s = matt(hue * (0.45 + 0.75 * leaf + 0.45 * clump), normal);
    let jitter = vec3f(value3(a * 13.0, 27u) - 0.5, value3(a * 13.0, 28u) - 0.5, value3(a * 13.0, 29u) - 0.3);
    s.normal = normal_or(normal + jitter * 0.9 * fine, normal);
    s.through = 0.35;
    return s;
}

fn facade(st: Structure, p: vec3f, at: vec2f, a: vec3f, normal: vec3f, fp: f32) -> Surface {
    let style = hash1(st.id, 1u) % 12u;
    var wall = wall_color(style);
    wall *= 0.90 + 0.14 * value3(a * 0.35, 14u) + 0.05 * (value3(a * 2.5, 15u) - 0.5);
    wall *= 1.0 - 0.25 * ramp(0.9, 0.0, p.z) * (0.4 + 0.6 * value3(a * 1.2, 16u));
    if style < 4u {
        let row = floor(at.y / 0.085);
        let joint = band(abs(at.y / 0.085 - row - 0.5) - 0.40, 0.1, fp / 0.085);
        let odd = row - trunc(row / 2.0) * 2.0;
        let one = unit3(vec3i(i32(floor(at.x / 0.26 + 0.5 * odd)), i32(row), 3), 17u);
        wall *= 1.0 + visible(fp, 0.09) * (0.34 * (one - 0.5) - 0.12 * joint);
    } else {
        wall *= 1.0 + visible(fp, 0.05) * 0.12 * (value3(a * 24.0, 18u) - 0.5);
    }
    var out = matt(wall, normal);
    if st.columns < 24u || st.height_m < 2.3 {
        return out;
    }
    let bay = 1.9 + 1.3 * unit(hash1(st.id, 2u));
    let floor_m = 2.9 + 0.4 * unit(hash1(st.id, 3u));
    let shop = st.height_m > 5.0 && hash1(st.id, 4u) % 3u == 0u;
    out.albedo *= 1.0 - 0.30 * band(abs(at.y - 0.2), 0.3, fp);
    let cornice = band(abs(st.height_m - 0.22 - at.y), 0.16, fp);
    out.albedo = mix(out.albedo, gray(0.42), 0.6 * cornice);
    let column = floor(at.x / bay);
    let row = floor((at.y - 0.25) / floor_m);
    let f = vec2f(at.x / bay - column - 0.5, (at.y - 0.25) / floor_m - row - 0.5) * vec2f(bay, floor_m);
    if row < 0.0 || (row + 1.0) * floor_m + 0.1 > max(st.height_m, floor_m) {
        return out;
    }
    var size = vec2f(min(bay * 0.29, 0.75), 0.72);
    var middle = 0.12;
    if row == 0.0 && shop {
        size = vec2f(bay * 0.42, 1.05);
        middle = -0.15;
    }
    let q = vec2f(abs(f.x), abs(f.y - middle));
    let d = max(q.x - size.x, q.y - size.y);
    let frame = band(abs(d - 0.03), 0.05, fp);
    let glass = ramp(0.004 + fp * 0.3, -0.004 - fp * 0.3, d);
    let trim = select(0.10, 0.55, unit(hash1(st.id, 5u)) > 0.4);
    out.albedo = mix(out.albedo, gray(trim), frame * 0.9);
    let sill = band(abs(f.y - middle + size.y + 0.09), 0.05, fp) * band(q.x, size.x + 0.1, fp);
    out.albedo = mix(out.albedo, gray(0.5), sill * 0.7);
    if glass > 0.0 {
        let cell = vec3i(i32(column), i32(row), i32(st.id));
        let bars = max(band(abs(f.x), 0.03, fp), band(abs(f.y - middle - 0.25), 0.025, fp));
        let drawn = f.y - middle > size.y * (1.0 - 2.0 * ramp(0.45, 1.0, unit3(cell, 6u)));
        let inside = select(gray(0.022), gray(0.30) * vec3f(1.0, 0.96, 0.88), drawn);
        out.albedo = mix(out.albedo, mix(inside, gray(trim), bars * 0.8), glass);
        out.mirror = 0.085 * glass * (1.0 - bars);
        out.gloss = 0.97;
        let on = unit3(cell, 7u);
        if a_lamps() > 0.0 && on < 0.38 {
            let warm = mix(vec3f(1.0, 0.70, 0.38), vec3f(0.85, 0.92, 1.0), ramp(0.26, 0.3, unit3(cell, 8u) * 0.4));
            let room = 0.55 + 0.45 * (1.0 - q.y / size.y) + 0.25 * (value2(f * 2.5 + column * 7.0, 9u) - 0.5);
            let night = ramp(0.1, 1.0, a_lamps());
            out.emit = warm * (room * glass * (1.0 - bars) * (0.15 + 0.55 * night) * select(1.0, 0.55, drawn));
        }
    }
    return out;
}

fn structure_surface(p: vec3f, a: vec3f, start: vec3f, fp: f32) -> Surface {
    let st = structure_at(p);
    if !st.there {
        return matt(gray(0.35), start);
    }
    if st.thin {
        let lamp = st.height_m > 3.9;
        var plates = array<vec3f, 4>(
            vec3f(38.0, 72.0, 118.0), vec3f(120.0, 124.0, 128.0), vec3f(36.0, 88.0, 66.0), vec3f(190.0, 192.0, 192.0),
        );
        var paint = gray(select(0.24, 0.11, lamp));
        if !lamp && st.columns > 1u && p.z > st.height_m - 1.15 {
            let plate = plates[st.id % 4u];
            paint = srgb(plate.x, plate.y, plate.z);
        }
        var s = matt(paint * (0.9 + 0.2 * value3(a * 5.0, 20u)), start);
        s.mirror = 0.03;
        s.gloss = 0.4;
        if a_lamps() > 0.0 && lamp && p.z > st.height_m - 0.55 {
            s.emit = vec3f(1.0, 0.74, 0.42) * 3.5 * a_lamps();
        }
        return s;
    }
    if start.z > 0.62 {
        let c = gray(0.20) * (0.8 + 0.4 * value2(a.xy * 1.2, 19u));
        return matt(c, normalize(mix(vec3f(0.0, 0.0, 1.0), start, 0.4)));
    }
    let level = normal2_or(start.xy, vec2f(1.0, 0.0));
    var wall = st.axis;
    var best = -2.0;
    // As in Rust: of equal ones the last.
    var axes = array<vec2f, 4>(st.axis, perp(st.axis), -st.axis, -perp(st.axis));
    for (var k = 0; k < 4; k++) {
        if dot(axes[k], level) >= best {
            best = dot(axes[k], level);
            wall = axes[k];
        }
    }
    var normal = start;
    var along = perp(level);
    if best > 0.62 {
        normal = normal_or(mix(vec3f(wall, 0.0), start, 0.06), start);
        along = perp(wall);
    }
    return facade(st, p, vec2f(dot(p.xy, along), p.z), a, normal, fp);
}

fn voxel_surface(p: vec3f, label: u32, normal: vec3f, fp: f32) -> Surface {
    let a = anchor(p);
    var s: Surface;
    if label == TRUNK {
        let bark = value3(a * vec3f(14.0, 14.0, 3.0), 22u);
        s = matt(vec3f(0.105, 0.080, 0.058) * (0.55 + 0.9 * bark), normal);
    } else if label == VEGETATION {
        s = plant(a, normal, fp);
    } else if label == MANMADE {
        s = structure_surface(p, a, normal, fp);
    } else {
        let calm = num3(section(22u) + min(label, 17u) * 3u);
        s = matt(calm * (0.8 + 0.4 * value3(a * 4.0, 21u)), normal);
    }
    return cover(s, p, select(1.0, 0.8, label == VEGETATION));
}

