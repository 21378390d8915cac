//! Pictures of the maps: render ids and depths as RGBA, depths as 16-bit millimetres.

use scene::sensor_data::{RENDER_IDS, RenderId};
pub use scene::sensor_data::{SKY, depth_mm, render_id_color};
use scene::{BevLayer, CameraMaps, Class, MultiPlaneImage, PerspectiveMap};

/// sRGB colour of a pixel without a depth.
pub const NO_DEPTH: [u8; 3] = [14, 14, 18];

/// The semantic map as RGBA, 4 bytes per pixel, opaque. With `shaded`, surfaces are toned by where
/// they face, edges of nearer things outlined and far things dimmed, all from the depth map, so that
/// shapes of one class can be told apart.
pub fn semantic_rgba(maps: &CameraMaps, shaded: bool) -> Vec<u8> {
    let palette: [[u8; 3]; RENDER_IDS] = std::array::from_fn(|id| render_id_color(id as u8));
    let mut out = Vec::with_capacity(maps.semantic.len() * 4);
    for (at, &id) in maps.semantic.iter().enumerate() {
        // Id 0 is both nothing and the class "others": a surface that covers the pixel is the latter.
        let surface = id != 0 || (maps.coverage[at] > 0.5 && maps.depth_m[at] > 0.0);
        let rgb = match (surface, palette.get(usize::from(id))) {
            (false, _) => SKY,
            (true, Some(rgb)) if id != 0 => *rgb,
            _ => opaque_color(id),
        };
        let tone = if shaded && surface { tone(maps, at) } else { 1.0 };
        out.extend(rgb.map(|c| (f32::from(c) * tone).min(255.0) as u8));
        out.push(255);
    }
    out
}

/// Brightness of a pixel, 0.45 to 1.15: the surface that the depths around it describe, lit from
/// above and the right, an outline where something nearer begins, and haze.
fn tone(maps: &CameraMaps, at: usize) -> f32 {
    /// From the surface to the light in optical axes (x right, y down, z forward), unit length.
    const TO_LIGHT: [f32; 3] = [0.42, -0.68, -0.6];
    /// Focal length over image width of an ordinary 64.5 degree camera; near enough for a tone.
    const FOCAL: f32 = 0.79;
    let d = maps.depth_m[at];
    if d.is_nan() || d <= 0.0 {
        return 1.0;
    }
    let (x, y) = (at % maps.width, at / maps.width);
    // Neighbours outside the image or without depth count as level.
    let depth = |dx: isize, dy: isize| {
        let (x, y) = (x.wrapping_add_signed(dx), y.wrapping_add_signed(dy));
        if x >= maps.width || y >= maps.height {
            return d;
        }
        let v = maps.depth_m[y * maps.width + x];
        if v > 0.0 { v } else { d }
    };
    let (left, right, up, down) = (depth(-1, 0), depth(1, 0), depth(0, -1), depth(0, 1));
    let nearest = left.min(right).min(up).min(down);
    let behind = ((d - nearest) / d - 0.02).clamp(0.0, 0.1) / 0.1;
    // Depth over the image gives the normal: with u, v from the image's middle in focal lengths,
    // it is (-z_u, -z_v, z + u z_u + v z_v), turned to the viewer.
    let focal = FOCAL * maps.width as f32;
    let (zu, zv) = ((right - left) * 0.5 * focal / d, (down - up) * 0.5 * focal / d);
    let u = (x as f32 + 0.5 - maps.width as f32 / 2.0) / focal;
    let v = (y as f32 + 0.5 - maps.height as f32 / 2.0) / focal;
    let normal = [zu, zv, -(1.0 + u * zu + v * zv)];
    let length = normal.iter().map(|n| n * n).sum::<f32>().sqrt();
    let lit = normal.iter().zip(TO_LIGHT).map(|(n, l)| n * l).sum::<f32>() / length;
    // An infinite slope has no direction: taken as level.
    let lit = if lit.is_finite() { lit } else { 0.0 };
    let haze = 1.0 - 0.3 * (d / 60.0).min(1.0);
    (haze * (0.84 + 0.3 * lit) * (1.0 - 0.35 * behind)).clamp(0.45, 1.15)
}

/// Depths as RGBA, 4 bytes per pixel, opaque: warm is near, cold is far, even steps in log depth
/// between `near_m` and `far_m`, beyond which the colour stays. Pixels without a depth (not above 0,
/// or NaN) get [`NO_DEPTH`].
pub fn depth_rgba(depth_m: &[f32], near_m: f32, far_m: f32) -> Vec<u8> {
    let near_m = if near_m > 1e-3 { near_m } else { 1e-3 };
    let far_m = if far_m > near_m { far_m } else { near_m * 1.001 };
    let (at_near, at_far) = (near_m.ln(), far_m.ln());
    let mut out = Vec::with_capacity(depth_m.len() * 4);
    for &d in depth_m {
        let rgb = if d > 0.0 {
            ramp((d.ln() - at_near) / (at_far - at_near))
        } else {
            NO_DEPTH
        };
        out.extend(rgb);
        out.push(255);
    }
    out
}

/// A ramp from warm (0) to cold (1) whose lightness falls all the way, so that it also reads without colour.
pub fn ramp(t: f32) -> [u8; 3] {
    const STOPS: [[f32; 3]; 7] = [
        [255.0, 244.0, 196.0],
        [252.0, 196.0, 94.0],
        [236.0, 128.0, 76.0],
        [196.0, 74.0, 106.0],
        [128.0, 50.0, 134.0],
        [66.0, 42.0, 124.0],
        [28.0, 30.0, 72.0],
    ];
    // NaN lands on the first stop.
    let t = if t > 0.0 { t.min(1.0) } else { 0.0 } * (STOPS.len() - 1) as f32;
    let i = (t as usize).min(STOPS.len() - 2);
    let f = t - i as f32;
    std::array::from_fn(|c| (STOPS[i][c] + (STOPS[i + 1][c] - STOPS[i][c]) * f).round() as u8)
}

/// One plane of a multi-plane image as RGBA, 4 bytes per pixel, opaque: the voxels that the plane cuts in the classes'
/// colours, over a dark image of the first surfaces.
pub fn plane_rgba(image: &MultiPlaneImage, plane: u16) -> Vec<u8> {
    let first = image.first_visible();
    let mut out = Vec::with_capacity(first.len() * 4);
    for (pixel, seen) in first.into_iter().enumerate() {
        let ghost = seen.map_or(NO_DEPTH, |id| render_id_color(id).map(|c| 16 + c / 6));
        out.extend(image.at(pixel, plane).map_or(ghost, opaque_color));
        out.push(255);
    }
    out
}

/// The colour of an id where it is known that something is there: 0 is the class "others", no sky.
fn opaque_color(id: RenderId) -> [u8; 3] {
    match id {
        0 => Class::Others.color(),
        id => render_id_color(id),
    }
}

/// A perspective map as RGBA, 4 bytes per pixel, opaque: road and lines below, boxes see-through over them, the rarer
/// class over the more frequent one, edges in full colour.
pub fn perspective_rgba(map: &PerspectiveMap) -> Vec<u8> {
    const LINES: [BevLayer; 3] = [
        BevLayer::RoadDivider,
        BevLayer::LaneDivider,
        BevLayer::PedCrossing,
    ];
    let object = |i: usize| Class::OBJECTS.get(i).map_or([255; 3], |c| c.color());
    let mut out = Vec::with_capacity(map.channels.len() * 4);
    for (&bits, &edge) in map.channels.iter().zip(&map.edges) {
        let mut rgb = if bits >> 3 & 1 == 1 {
            BevLayer::DrivableArea.color().map(|c| c / 2)
        } else {
            NO_DEPTH
        };
        for (i, layer) in LINES.into_iter().enumerate().rev() {
            if bits >> i & 1 == 1 {
                rgb = layer.color();
            }
        }
        for i in 0..Class::OBJECTS.len() {
            if bits >> (4 + i) & 1 == 1 {
                let over = object(i);
                rgb = std::array::from_fn(|c| ((u16::from(rgb[c]) + u16::from(over[c])) / 2) as u8);
            }
        }
        if edge > 0 {
            rgb = object(usize::from(edge) - 1).map(|c| c.saturating_add(40));
        }
        out.extend(rgb);
        out.push(255);
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ids_have_their_own_colours() {
        let all: std::collections::HashSet<_> = (0..RENDER_IDS as u8).map(render_id_color).collect();
        assert_eq!(all.len(), RENDER_IDS);
        assert_eq!(render_id_color(4), Class::Car.color());
        assert_eq!(render_id_color(200), Class::Others.color());
    }

    #[test]
    fn pictures_have_four_bytes_a_pixel_and_bear_anything() {
        let maps = CameraMaps {
            camera: "TEST".into(),
            width: 4,
            height: 2,
            semantic: vec![0, 4, 4, 11, 19, 255, 1, 2],
            depth_m: vec![-1.0, 5.0, 5.1, f32::NAN, 0.0, 1e9, f32::INFINITY, 1e-20],
            expected_m: vec![0.0; 8],
            median_m: vec![-1.0; 8],
            coverage: vec![1.0; 8],
        };
        let flat = semantic_rgba(&maps, false);
        assert_eq!(flat.len(), 32);
        assert_eq!(flat[..3], SKY);
        assert_eq!(flat[4..7], Class::Car.color());
        let shaded = semantic_rgba(&maps, true);
        assert_eq!(shaded[..3], SKY);
        assert!(shaded.chunks(4).all(|p| p[3] == 255));
        let depth = depth_rgba(&maps.depth_m, 1.0, 60.0);
        assert_eq!(depth[..3], NO_DEPTH);
        assert_eq!(depth[12..15], NO_DEPTH);
        assert_eq!(depth[20..23], ramp(1.0));
        assert_eq!(depth_rgba(&maps.depth_m, f32::NAN, 0.0).len(), 32);
    }

    #[test]
    fn ramp_darkens_with_distance() {
        let luma = |t: f32| {
            let [r, g, b] = ramp(t).map(f32::from);
            0.2126 * r + 0.7152 * g + 0.0722 * b
        };
        for i in 0..200 {
            let t = i as f32 / 200.0;
            assert!(luma(t) > luma(t + 0.02) - 0.01 && luma(t) - luma(t + 0.005) < 6.0);
        }
        assert_eq!(ramp(f32::NAN), ramp(0.0));
    }

    #[test]
    fn millimetres_saturate() {
        let got = depth_mm(&[
            -1.0,
            0.0,
            0.0004,
            0.0006,
            1.2345,
            65.535,
            65.6,
            f32::INFINITY,
            f32::NAN,
        ]);
        assert_eq!(got, vec![0, 0, 0, 1, 1235, 65535, 65535, 65535, 0]);
    }
}
