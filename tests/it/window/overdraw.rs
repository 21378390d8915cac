//! How often a pixel is painted in one frame of the window. On a software rasteriser that is what a frame costs.

use egui::epaint::Primitive;
use egui::{Pos2, Rect};

use super::bench::Bench;

/// Area of a triangle inside a rectangle (Sutherland and Hodgman 1974).
fn area_inside(triangle: [Pos2; 3], clip: Rect) -> f64 {
    let mut polygon: Vec<[f64; 2]> = triangle
        .iter()
        .map(|p| [f64::from(p.x), f64::from(p.y)])
        .collect();
    let edges = [
        (0, 1.0, f64::from(clip.left())),
        (0, -1.0, -f64::from(clip.right())),
        (1, 1.0, f64::from(clip.top())),
        (1, -1.0, -f64::from(clip.bottom())),
    ];
    for (axis, sign, limit) in edges {
        let inside = |p: &[f64; 2]| p[axis] * sign - limit;
        let mut kept = Vec::with_capacity(polygon.len() + 1);
        for (i, a) in polygon.iter().enumerate() {
            let b = &polygon[(i + 1) % polygon.len()];
            let (da, db) = (inside(a), inside(b));
            if da >= 0.0 {
                kept.push(*a);
            }
            if (da < 0.0) != (db < 0.0) {
                let t = da / (da - db);
                kept.push([a[0] + t * (b[0] - a[0]), a[1] + t * (b[1] - a[1])]);
            }
        }
        polygon = kept;
        if polygon.is_empty() {
            return 0.0;
        }
    }
    let next = |i: usize| polygon[(i + 1) % polygon.len()];
    let doubled: f64 = polygon
        .iter()
        .enumerate()
        .map(|(i, a)| a[0] * next(i)[1] - a[1] * next(i)[0])
        .sum();
    doubled.abs() / 2.0
}

#[test]
fn pixels_are_not_painted_over_and_over() {
    let mut bench = Bench::new();
    bench.steps(4);
    let ctx = bench.harness.ctx.clone();
    let shapes = bench.harness.output().shapes.clone();
    let screen = ctx.content_rect();
    let mut all = 0.0;
    let mut large = Vec::new();
    for primitive in ctx.tessellate(shapes, ctx.pixels_per_point()) {
        let Primitive::Mesh(mesh) = &primitive.primitive else {
            continue;
        };
        let clip = primitive.clip_rect.intersect(screen);
        for corners in mesh.indices.chunks_exact(3) {
            let at = |i: usize| mesh.vertices[corners[i] as usize].pos;
            let triangle = [at(0), at(1), at(2)];
            let area = area_inside(triangle, clip);
            if area > 8_000.0 {
                let color = mesh.vertices[corners[0] as usize].color;
                large.push((area as i64, triangle, color, mesh.texture_id));
            }
            all += area;
        }
    }
    let times = all / f64::from(screen.area());
    large.sort_by_key(|l| -l.0);
    for l in &large {
        println!("{l:?}");
    }
    println!("each pixel {times:.2} times");
    assert!(times < 2.0, "each pixel is painted {times:.2} times");
}
