// The ego vehicle: flat-shaded solid faces under the same light as the voxels.

struct Surface {
    @builtin(position) clip: vec4<f32>,
    @location(0) p: vec3<f32>,
    @location(1) @interpolate(flat) normal: vec3<f32>,
    @location(2) @interpolate(flat) color: vec3<f32>,
}

@vertex
fn vs_main(
    @location(0) p: vec3<f32>,
    @location(1) normal: vec4<f32>,
    @location(2) color: vec4<f32>,
) -> Surface {
    var out: Surface;
    out.clip = frame.clip_from_ego * vec4<f32>(p, 1.0);
    out.p = p;
    out.normal = normal.xyz;
    out.color = color.rgb;
    return out;
}

@fragment
fn fs_main(in: Surface) -> @location(0) vec4<f32> {
    let n = normalize(in.normal);
    let reached = mix(vec2<f32>(0.9, 1.0), light_at(in.p + n * (0.5 * frame.grid_size.w)), frame.toggles.z);
    // A gloss that follows the view keeps dark glass from being a hole.
    let shine = pow(max(dot(reflect(-frame.sun.xyz, n), toward_eye(in.p)), 0.0), 12.0) * reached.y * 0.12;
    let lit = in.color * in.color * lighting(n, reached) + vec3<f32>(shine);
    return vec4<f32>(with_fog(encode(lit), in.p, in.clip.y), 1.0);
}
