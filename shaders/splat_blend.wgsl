// Blends the splats of a tile front to back: a workgroup per tile and camera, an invocation per
// pixel. UniScene (arXiv 2412.05435) equations 3, 4, 16 to 18; the twin is src/gen/sensors/tile.rs.

@group(0) @binding(1) var<storage, read> pairs: array<vec2<u32>>;
@group(0) @binding(2) var<storage, read> ranges: array<vec2<u32>>;
@group(0) @binding(3) var<storage, read> splats: array<Splat>;
// [camera][plane][row][column]: coverage, expected depth, median depth, label, margin, light left.
@group(0) @binding(4) var<storage, read_write> maps: array<u32>;

var<workgroup> near: array<Splat, 256>;
// Pixels of the tile that take no more.
var<workgroup> done: atomic<u32>;

@compute @workgroup_size(16, 16)
fn main(
    @builtin(workgroup_id) group: vec3<u32>,
    @builtin(local_invocation_id) local: vec3<u32>,
    @builtin(local_invocation_index) thread: u32,
) {
    let range = ranges[(group.z * batch.tiles.y + group.y) * batch.tiles.x + group.x];
    let pixel = group.xy * TILE + local.xy;
    let inside = pixel.x < batch.size_px.x && pixel.y < batch.size_px.y;
    let at = vec2<f32>(pixel) + 0.5;
    var t = select(0.0, 1.0, inside);
    var live = inside && t >= batch.t_stop;
    var expected = 0.0;
    var median = -1.0;
    // Weights of the 20 ids: in registers, since no index into them is ever computed.
    var w0 = vec4(0.0);
    var w1 = vec4(0.0);
    var w2 = vec4(0.0);
    var w3 = vec4(0.0);
    var w4 = vec4(0.0);
    if !live {
        atomicAdd(&done, 1u);
    }
    for (var start = range.x; start < range.y; start += 256u) {
        // Nobody counts between the two barriers: all see the same number.
        workgroupBarrier();
        let all_done = atomicLoad(&done) == 256u;
        if start + thread < range.y {
            near[thread] = splats[pairs[start + thread].y];
        }
        workgroupBarrier();
        if all_done {
            break;
        }
        let n = min(256u, range.y - start);
        for (var i = 0u; live && i < n; i++) {
            let s = near[i];
            let d = at - s.mean;
            let e = vec2(s.along * (d.x - s.shear * d.y), s.across * d.y);
            // Down to 1e-38, as the twin.
            let alpha = min(s.opacity * exp2(-min(dot(e, e), 125.5)), batch.alpha_max);
            if alpha >= batch.alpha_min {
                let w = alpha * t;
                // As a difference: then weights and what is left add up to 1 whatever was rounded.
                t -= w;
                expected += w * s.depth;
                if median < 0.0 && t < 0.5 {
                    median = s.depth;
                }
                let id = vec4(s.id);
                let none = vec4(0.0);
                let all = vec4(w);
                w0 += select(none, all, id == vec4(0u, 1u, 2u, 3u));
                w1 += select(none, all, id == vec4(4u, 5u, 6u, 7u));
                w2 += select(none, all, id == vec4(8u, 9u, 10u, 11u));
                w3 += select(none, all, id == vec4(12u, 13u, 14u, 15u));
                w4 += select(none, all, id == vec4(16u, 17u, 18u, 19u));
                if !(t >= batch.t_stop) {
                    live = false;
                    atomicAdd(&done, 1u);
                }
            }
        }
    }
    if !inside {
        return;
    }
    var weights = array<vec4<f32>, 5>(w0, w1, w2, w3, w4);
    var coverage = 0.0;
    var top = 0.0;
    var second = 0.0;
    var label = -1;
    for (var id = 0u; id < 20u; id++) {
        let w = weights[id / 4u][id % 4u];
        coverage += w;
        // Strictly more, so that the lowest id keeps a tie.
        if w > top {
            second = top;
            top = w;
            label = i32(id);
        } else {
            second = max(second, w);
        }
    }
    let pixels = batch.size_px.x * batch.size_px.y;
    var to = group.z * batch.planes * pixels + pixel.y * batch.size_px.x + pixel.x;
    maps[to] = bitcast<u32>(coverage);
    to += pixels;
    maps[to] = bitcast<u32>(expected);
    to += pixels;
    maps[to] = bitcast<u32>(median);
    to += pixels;
    maps[to] = bitcast<u32>(label);
    if batch.planes > 4u {
        to += pixels;
        maps[to] = bitcast<u32>(top - second);
        to += pixels;
        maps[to] = bitcast<u32>(t);
    }
}
