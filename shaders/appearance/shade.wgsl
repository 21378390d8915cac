// Light on surfaces.
// ---- shade.rs

fn openness(hit: Met, p: vec3f, n: vec3f) -> f32 {
    let up = vec3f(0.0, 0.0, 1.0);
    let leafy = hit.kind == KIND_VOXEL && hit.which == VEGETATION;
    let side = normal_or(vec3f(-n.y, n.x, 0.0), vec3f(1.0, 0.0, 0.0)) * 1.3;
    var at = array<vec4f, 8>(
        vec4f(n * 0.45 + up * 0.1, 0.34), vec4f(n + up * 0.35, 0.26), vec4f(n * 1.6 + up * 1.2, 0.16),
        vec4f(up * 2.4 + n * 0.8, 0.14), vec4f(n * 0.7 + side, 0.10), vec4f(n * 0.7 - side, 0.10),
        vec4f(up * 0.9, 0.10), vec4f(up * 1.8, 0.10),
    );
    var closed = 0.0;
    for (var k = 0; k < 8; k++) {
        if k == 6 {
            if !leafy {
                break;
            }
            closed *= 0.9;
        }
        closed += at[k].w * field_dense(p + at[k].xyz);
    }
    var open = clamp(1.0 - closed, 0.12, 1.0);
    if p.z - ground_base(p.xy) < 2.5 {
        let near = things_near(p.xy);
        for (var k = near.x; k < near.y; k++) {
            let i = words[section(12u) + k];
            let a = thing_word(i);
            let size = thing_size(a);
            let q = thing_turn(a, p - thing_foot(a));
            if hit.kind == KIND_GROUND {
                let beside = length(max(abs(q.xy) - size.xy / 2.0, vec2f(0.0)));
                let small = min(min(size.x, size.y) / 1.6, 1.0);
                var dark = 0.80;
                var high = 1.6;
                if is_scenery(a) {
                    if thing_foot(a).z > p.z + 0.5 {
                        continue;
                    }
                    dark = 0.45;
                    high = 2.4;
                }
                open *= 1.0 - dark * small * ramp(0.55 * min(size.z, high), 0.0, beside);
            } else if hit.kind == KIND_THING && hit.which == i {
                let over = select(q.z / size.z, (q.z - num(a + 17u)) / 2.5, is_scenery(a));
                open *= 0.62 + 0.38 * ramp(0.0, 0.35, clamp(over, 0.0, 1.0));
            }
        }
    }
    return open;
}

fn lamp_light(p: vec3f, lift: vec3f, n: vec3f, to_eye: vec3f, s: Surface, shadows: bool) -> vec3f {
    var out = vec3f(0.0);
    for (var i = 0u; i < section(20u); i++) {
        let a = section(19u) + i * 12u;
        let to = num3(a) - p;
        let d2 = dot(to, to);
        let range_m = num(a + 3u);
        if d2 > range_m * range_m {
            continue;
        }
        let axis = num3(a + 4u);
        let l = to / max(sqrt(d2), 1e-3);
        let facing = dot(n, l);
        let cosine = -dot(l, axis);
        let kind = words[a + 7u];
        var beam: f32;
        if kind == 0u {
            beam = ramp(-0.15, 0.6, cosine);
        } else if kind == 1u {
            let up = -l.z - axis.z;
            let aim = min(pow(0.055 / (0.022 + max(-up, 0.0)), 1.25), min(2.4, 0.12 * sqrt(d2)));
            beam = ramp(0.80, 0.985, cosine) * (0.07 + 0.93 * ramp(0.025, -0.02, up)) * aim + 0.02 * ramp(0.2, 0.9, cosine);
        } else {
            beam = ramp(-0.1, 0.8, cosine);
        }
        if beam <= 0.0 {
            continue;
        }
        let fade = ramp(1.0, 0.55, sqrt(d2) / range_m);
        let near = select(0.6, HEAD_NEAR_M2, kind == 1u);
        let shine = num3(a + 8u) * (beam * fade / (d2 + near));
        let behind = s.through * max(-facing, 0.0) * 0.5;
        if shadows && kind != 2u && max(facing, behind) * max3(shine) * a_exposure() > LAMP_SHADOW_LIGHT {
            let way = num3(a) - lift;
            let far = length(way);
            let clear = select(LAMP_CLEAR_M, LAMP_CLEAR_M * far / max(length(way.xy), 1e-3), kind == 0u);
            if far > clear && trace(lift, way / far, far - clear, 3u).kind != KIND_NONE {
                continue;
            }
        }
        out += s.albedo * shine * (max(facing, 0.0) + behind);
        if s.gloss > 0.2 && facing > 0.0 {
            let between = normal_or(l + to_eye, n);
            let power = exp2(2.0 + 7.0 * s.gloss);
            let spot = powi(max(dot(n, between), 0.0), power) * (power + 2.0) * 0.125;
            out += shine * (s.mirror + 0.015) * min(spot, 30.0) * facing;
        }
    }
    return out;
}

// What stands outside the grid in front of `limit`: colour with air, and 1 if anything does.
fn beyond(o: vec3f, d: vec3f, limit: f32) -> vec4f {
    let level = dot(d.xy, d.xy);
    let eye = o.xy - view.middle.xy;
    for (var ring = 0; ring < 3; ring++) {
        let radius = select(select(SKYLINE_2_M, SKYLINE_1_M, ring == 1), SKYLINE_0_M, ring == 0) * view.middle.z;
        let b = dot(eye, d.xy);
        let c = dot(eye, eye) - radius * radius;
        let disc = b * b - level * c;
        if level < 1e-8 || disc <= 0.0 || c > 0.0 {
            continue;
        }
        let t = (-b + sqrt(disc)) / level;
        let p = o + d * t;
        if t > limit || p.z < 0.0 || p.z > 60.0 {
            continue;
        }
        var open = 0.0;
        if ring == 0 {
            let aside = normal2_or(perp(p.xy - view.middle.xy), vec2f(0.0));
            for (var k = -3; k <= 3; k++) {
                open += ramp(0.15, 0.6, shares(p.xy + aside * (f32(k) * 2.6)).x) / 4.0;
            }
            open = min(open, 1.0);
        }
        let found = skyline(anchor_dir(p - vec3f(view.middle.xy, 0.0)), radius, open);
        if found.w > 0.0 {
            return vec4f(through_air(found.xyz, t, anchor_dir(d)), 1.0);
        }
    }
    return vec4f(0.0);
}

struct Sample {
    color: vec3f,
    t: f32,
    key: u32,
}

// Light along a ray; what it mirrors is followed once, by a second turn of the loop.
fn light_along(eye: vec3f, ray: vec3f, pixel: f32) -> Sample {
    var o = eye;
    var d = ray;
    var out = Sample(vec3f(0.0), INFINITE, 0u);
    // Of the first surface, for when the mirrored light is known.
    var mean = vec3f(0.0);
    var share = 0.0;
    var gloss = 0.0;
    for (var turn = 0u; turn < 2u; turn++) {
        let first = turn == 0u;
        let limit = select(MIRROR_M, FAR_M, first);
        let hit = trace(o, d, limit, turn);
        let met = hit.kind != KIND_NONE && (first || hit.t > 0.02);
        var color = vec3f(0.0);
        var done = !met;
        if !met || (first && hit.t > 55.0) {
            let behind = beyond(o, d, select(INFINITE, hit.t, met));
            if behind.w > 0.0 {
                color = behind.xyz;
                done = true;
                if first && met {
                    out.t = hit.t;
                    out.key = 1u;
                }
            } else if !met {
                color = sky(anchor_dir(d));
            }
        }
        var follow = false;
        var mirrored = vec3f(0.0);
        var lift = vec3f(0.0);
        if !done {
            let p = o + d * hit.t;
            var start = hit.normal;
            if hit.kind == KIND_VOXEL {
                start = field_normal(p, hit.which);
            } else if hit.kind == KIND_GROUND {
                if hit.t < 60.0 {
                    start = ground_normal(p);
                }
            } else {
                let a = thing_word(hit.which);
                let size = thing_size(a);
                let reach = 0.028 * max(size.z, size.x * 0.5);
                if !is_scenery(a) {
                    start = rounded(hit.part, thing_turn(a, p - thing_foot(a)), start, reach);
                }
                start = thing_turn_back(a, start);
            }
            var fp = 0.05 + hit.t * 0.004;
            if first {
                fp = hit.t * pixel / sqrt(select(0.6, max(-d.z, 0.03), hit.kind == KIND_GROUND));
            }
            let s = surface(hit, p, start, fp);
            let n = s.normal;
            // The side from which light is looked for.
            var geometric = n;
            if hit.kind == KIND_THING {
                geometric = start;
            } else if hit.kind == KIND_GROUND {
                geometric = vec3f(0.0, 0.0, 1.0);
            } else if hit.which == MANMADE {
                geometric = n * 12.0;
            }
            lift = p + geometric * (0.012 + hit.t * 2e-4);
            color = s.emit;
            let sun = a_sun();
            let facing = dot(n, to_sun_in_ego());
            let strength = max3(sun);
            let lit_through = s.through * max(-facing, 0.0);
            if strength > 0.05 && (facing > 0.0 || lit_through > 0.02) {
                var dark = false;
                if first {
                    dark = trace(lift, to_sun_in_ego(), SHADOW_M, 2u).kind != KIND_NONE;
                }
                if !dark {
                    color += s.albedo * sun * (max(facing, 0.0) * (1.0 - 0.3 * s.through) + lit_through * 0.6);
                    if s.gloss > 0.0 {
                        let between = normal_or(to_sun_in_ego() - d, n);
                        let power = exp2(2.0 + 9.0 * s.gloss);
                        let spot = powi(max(dot(n, between), 0.0), power) * (power + 2.0) * 0.125;
                        color += sun * (s.mirror * min(spot, 25.0) * max(facing, 0.0));
                    }
                }
            } else if strength > 0.0 {
                color += s.albedo * sun * max(facing, 0.0);
            }
            let open = openness(hit, p, n);
            let above = 0.5 + 0.5 * n.z;
            let below = mix(a_bounce(), a_ambient() * 0.75, a_snow() * 0.6);
            color += s.albedo * (a_ambient() * above + below * (1.0 - above) + a_horizon() * 0.08) * open;
            if section(20u) > 0u {
                color += lamp_light(p, lift, n, -d, s, first);
            }
            if s.mirror > 0.008 {
                let grazing = powi(1.0 - clamp(-dot(n, d), 0.0, 1.0), 5.0);
                let part = s.mirror + (1.0 - s.mirror) * grazing * s.gloss * s.gloss * 0.85;
                if part > 0.012 {
                    var r = d - n * (2.0 * dot(d, n));
                    if dot(r, n) < 0.0 {
                        r -= n * (2.0 * dot(r, n));
                    }
                    let around = (a_ambient() * 0.6 + a_horizon() * 0.2) * open;
                    if first && s.gloss > 0.55 {
                        follow = true;
                        mirrored = r;
                        mean = around;
                        share = part;
                        gloss = s.gloss;
                    } else {
                        let seen = mix(around, mix(a_horizon(), a_zenith(), max(r.z, 0.0)) * open, ramp(0.2, 0.8, s.gloss));
                        color = mix(color, seen, part);
                    }
                }
            }
            if first {
                out.t = hit.t;
                var kind = 2u;
                if hit.kind == KIND_VOXEL {
                    kind = 8u + hit.which;
                } else if hit.kind == KIND_THING {
                    kind = 64u + hit.which;
                }
                let steps = vec3u(max(s.normal * 3.0 + 4.0, vec3f(0.0)));
                out.key = kind << 8u | ((steps.x + 8u * steps.y + 32u * steps.z) & 255u);
            } else {
                color = through_air(color, hit.t, anchor_dir(d));
            }
        }
        if first {
            out.color = color;
            if done {
                return out;
            }
            if !follow {
                break;
            }
            o = lift;
            d = mirrored;
        } else {
            out.color = mix(out.color, mix(mean, color, ramp(0.2, 0.8, gloss)), share);
        }
    }
    out.color = through_air(out.color, out.t, anchor_dir(ray));
    return out;
}

