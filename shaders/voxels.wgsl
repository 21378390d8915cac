// Voxel faces: class colour, baked sky and sun, thin lines between voxels, road markings on ground.

// Columns along a side of a brick.
const BRICK = 16u;

struct Surface {
    @builtin(position) clip: vec4<f32>,
    @location(0) p: vec3<f32>,
    @location(1) @interpolate(flat) normal: vec3<f32>,
    // rgb squared sRGB; a: 1 where markings may lie.
    @location(2) @interpolate(flat) color: vec4<f32>,
}

@vertex
fn vs_main(
    @location(0) packed: u32,
    @builtin(vertex_index) index: u32,
    // Place of the brick: x, and y above 16 bits.
    @builtin(instance_index) brick: u32,
) -> Surface {
    let in_brick = vec2<u32>(packed & 31u, (packed >> 5u) & 31u);
    let column = vec2<u32>(brick & 65535u, brick >> 16u) * BRICK + in_brick;
    let corner = vec3<f32>(vec2<f32>(column), f32((packed >> 10u) & 127u));
    let direction = (packed >> 21u) & 7u;
    let axis = direction >> 1u;
    let side = 1.0 - 2.0 * f32(direction & 1u);
    var normal = vec3<f32>(0.0);
    normal[axis] = side;

    // Which way is outward for this corner: see meshing.rs for the order of corners.
    let at = index & 3u;
    let reversed = direction == 1u || direction == 2u || direction == 5u;
    let other = at == 2u || at == select(1u, 3u, reversed);
    let another = at == 2u || at == select(3u, 1u, reversed);
    let a = select(-1.0, 1.0, other);
    let b = select(-1.0, 1.0, another);
    var outward = vec3<f32>(a, b, 0.0);
    if axis == 0u {
        outward = vec3<f32>(0.0, a, b);
    } else if axis == 1u {
        outward = vec3<f32>(a, 0.0, b);
    }

    var out: Surface;
    let p = corner * frame.grid_size.w + frame.grid_min.xyz;
    // Merged rectangles meet in T-junctions; a tenth of a pixel of overlap closes their cracks.
    out.clip = frame.clip_from_ego * vec4<f32>(p + outward * (0.12 * pixel_m(p)), 1.0);
    out.p = p;
    out.normal = normal;
    let base = frame.palette[packed >> 24u];
    out.color = vec4<f32>(base.rgb, base.a * max(normal.z, 0.0));
    return out;
}

// 1 on the border between two voxels, over `width` voxels.
fn edge(u: vec2<f32>, width: f32) -> f32 {
    let to_line = abs(fract(u - 0.5) - 0.5);
    return 1.0 - smoothstep(0.0, width, min(to_line.x, to_line.y));
}

@fragment
fn fs_main(in: Surface) -> @location(0) vec4<f32> {
    let reached = mix(vec2<f32>(0.9, 1.0), light_at(in.p + in.normal * (0.5 * frame.grid_size.w)), frame.toggles.z);
    let cell = voxel_units(in.p);
    var base = in.color.rgb;
    if in.color.a * frame.toggles.y > 0.0 {
        let texel = texel_at(cell.xy, textureDimensions(markings));
        let paint = textureLoad(markings, texel, 0);
        base = mix(base, paint.rgb * paint.rgb, paint.a * frame.toggles.y);
    }
    // Higher is a little lighter, so that levels of one class part from each other.
    base *= 0.95 + 0.012 * cell.z;
    var lit = base * lighting(in.normal, reached);
    let footprint = pixel_m(in.p) / frame.grid_size.w;
    if footprint < 0.24 {
        var u = cell.xy;
        if abs(in.normal.x) > 0.5 {
            u = cell.yz;
        } else if abs(in.normal.y) > 0.5 {
            u = cell.xz;
        }
        let strength = (1.0 - smoothstep(0.04, 0.24, footprint)) * mix(0.22, 0.11, in.color.a);
        lit *= 1.0 - frame.toggles.x * strength * edge(u, max(0.06, 1.5 * footprint));
    }
    return vec4<f32>(with_fog(encode(lit), in.p, in.clip.y), 1.0);
}
