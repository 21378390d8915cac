// From splats near to far to lists per tile: `place` projects the sorted ones again, keeps what the
// blending needs and counts the tiles they touch, `emit` writes a pair of tile and splat for each
// touch, in order, and after a stable sort by tile `mark` finds where each tile's list lies.

@group(0) @binding(1) var<storage, read> gaussians: array<Gaussian>;
// After `place`: first tile and one past the last, 16 bits each, x then y (counted on over all cameras).
@group(0) @binding(2) var<storage, read_write> items: array<vec2<u32>>;
@group(0) @binding(3) var<storage, read_write> ledger: Ledger;
@group(0) @binding(4) var<storage, read_write> splats: array<Splat>;
@group(0) @binding(5) var<storage, read_write> pairs: array<vec2<u32>>;
@group(0) @binding(6) var<storage, read_write> ranges: array<vec2<u32>>;

var<workgroup> items_there: u32;
var<workgroup> partial: array<u32, 256>;

// Sums over the threads up to and with this one.
fn scanned(thread: u32, value: u32) -> u32 {
    partial[thread] = value;
    workgroupBarrier();
    for (var step = 1u; step < 256u; step *= 2u) {
        var before = 0u;
        if thread >= step {
            before = partial[thread - step];
        }
        workgroupBarrier();
        partial[thread] += before;
        workgroupBarrier();
    }
    return partial[thread];
}

@compute @workgroup_size(256)
fn place(@builtin(workgroup_id) group: vec3<u32>, @builtin(local_invocation_index) thread: u32) {
    if thread == 0u {
        items_there = ledger.count;
    }
    let n = workgroupUniformLoad(&items_there);
    if group.x * 256u >= n {
        return;
    }
    let rank = group.x * 256u + thread;
    var touches = 0u;
    if rank < n {
        let index = items[rank].y;
        let view = index / batch.gaussians;
        let placed = project(gaussians[index % batch.gaussians], view);
        let t = placed.tiles;
        let row = view * batch.tiles.y;
        touches = (t.y - t.x) * (t.w - t.z);
        splats[rank] = placed.splat;
        items[rank] = vec2(t.x | (t.y << 16u), (row + t.z) | ((row + t.w) << 16u));
    }
    let sum = scanned(thread, touches);
    if thread == 255u {
        ledger.sums[group.x] = sum;
    }
}

@compute @workgroup_size(256)
fn emit(@builtin(workgroup_id) group: vec3<u32>, @builtin(local_invocation_index) thread: u32) {
    if thread == 0u {
        items_there = ledger.before;
    }
    let n = workgroupUniformLoad(&items_there);
    if group.x * 256u >= n {
        return;
    }
    let rank = group.x * 256u + thread;
    var t = vec4(0u);
    if rank < n {
        let packed = items[rank];
        t = vec4(packed.x & 0xffffu, packed.x >> 16u, packed.y & 0xffffu, packed.y >> 16u);
    }
    let touches = (t.y - t.x) * (t.w - t.z);
    var at = ledger.sums[group.x] + scanned(thread, touches) - touches;
    let room = arrayLength(&pairs);
    for (var y = t.z; y < t.w; y++) {
        for (var x = t.x; x < t.y; x++) {
            if at < room {
                pairs[at] = vec2(y * batch.tiles.x + x, rank);
            }
            at++;
        }
    }
}

@compute @workgroup_size(256)
fn mark(@builtin(global_invocation_id) id: vec3<u32>) {
    let n = ledger.count;
    if id.x >= n {
        return;
    }
    let tile = pairs[id.x].x;
    if id.x == 0u || pairs[max(id.x, 1u) - 1u].x != tile {
        ranges[tile].x = id.x;
    }
    if id.x + 1u == n || pairs[min(id.x + 1u, n - 1u)].x != tile {
        ranges[tile].y = id.x + 1u;
    }
}
