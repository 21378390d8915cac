// Which Gaussians each camera sees, and how deep: one invocation per Gaussian (x) and camera (y).

@group(0) @binding(1) var<storage, read> gaussians: array<Gaussian>;
// Sort key, then camera and Gaussian as one number.
@group(0) @binding(2) var<storage, read_write> items: array<vec2<u32>>;

@compute @workgroup_size(256)
fn main(@builtin(global_invocation_id) id: vec3<u32>) {
    if id.x >= batch.gaussians {
        return;
    }
    let placed = project(gaussians[id.x], id.y);
    let index = id.y * batch.gaussians + id.x;
    // Bits of positive numbers grow with the number.
    let key = bitcast<u32>(placed.splat.depth) - batch.key_base;
    items[index] = vec2(select(CULLED, key, placed.tiles.x < placed.tiles.y), index);
}
