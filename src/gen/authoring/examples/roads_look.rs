use editor::roads::recognise;
use scene::roads::NodeKind;
use scene::{BevLayer, BevLayout, RoadNetwork};
use std::io::Write;

fn main() {
    let out = std::env::args().nth(1).unwrap();
    let seeds: u64 = std::env::args().nth(2).unwrap().parse().unwrap();
    for name in world::template::TEMPLATES {
        let mut sheet: Vec<Vec<[u8; 3]>> = Vec::new();
        for seed in 0..seeds {
            let layout = world::template::layout(name, seed).unwrap();
            let t = std::time::Instant::now();
            let net = recognise(&layout, &RoadNetwork::default());
            let ms = t.elapsed().as_secs_f64() * 1e3;
            let t = std::time::Instant::now();
            let drawn = net.draw(layout.extent()).layout;
            let ms2 = t.elapsed().as_secs_f64() * 1e3;
            let (mut both, mut any) = (0, 0);
            for [x, y] in layout.extent().all_columns() {
                let (a, b) = (
                    layout.has(BevLayer::DrivableArea, x, y),
                    drawn.has(BevLayer::DrivableArea, x, y),
                );
                both += usize::from(a && b);
                any += usize::from(a || b);
            }
            let junctions: Vec<usize> = net
                .nodes
                .iter()
                .map(|n| net.arms(n.id).len())
                .filter(|n| *n > 2)
                .collect();
            let rings = net
                .nodes
                .iter()
                .filter(|n| matches!(n.kind, NodeKind::Roundabout { .. }))
                .count();
            println!(
                "{name} {seed}: iou {:.3} roads {} junctions {junctions:?} rings {rings} {ms:.0} ms draw {ms2:.1} ms: {}",
                both as f64 / any as f64,
                net.roads.len(),
                net.roads
                    .iter()
                    .map(|r| r.summary())
                    .collect::<Vec<_>>()
                    .join("; ")
            );
            sheet.push(picture(&layout, &drawn, &net));
        }
        let w = 400;
        let mut f = std::io::BufWriter::new(std::fs::File::create(format!("{out}/{name}.ppm")).unwrap());
        write!(f, "P6 {} {} 255\n", w * sheet.len(), w).unwrap();
        for row in 0..w {
            for s in &sheet {
                for p in &s[row * w..(row + 1) * w] {
                    f.write_all(p).unwrap();
                }
            }
        }
    }
}

fn picture(layout: &BevLayout, drawn: &BevLayout, net: &RoadNetwork) -> Vec<[u8; 3]> {
    let w = 400;
    let mut out = vec![[20u8, 24, 28]; w * w];
    for row in 0..w {
        for col in 0..w {
            // up is x, left is y
            let (x, y) = (199 - row / 2, 199 - col / 2);
            let c = |l: &BevLayout| {
                if l.has(BevLayer::RoadDivider, x, y) {
                    [230, 200, 60]
                } else if l.has(BevLayer::LaneDivider, x, y) {
                    [220, 220, 220]
                } else if l.has(BevLayer::PedCrossing, x, y) {
                    [240, 150, 240]
                } else if l.has(BevLayer::DrivableArea, x, y) {
                    [90, 90, 100]
                } else if l.has(BevLayer::CarparkArea, x, y) {
                    [60, 90, 140]
                } else if l.has(BevLayer::Walkway, x, y) {
                    [130, 110, 90]
                } else {
                    [20, 24, 28]
                }
            };
            out[row * w + col] = c(layout);
            let (a, b) = (
                layout.has(BevLayer::DrivableArea, x, y),
                drawn.has(BevLayer::DrivableArea, x, y),
            );
            if a && !b {
                out[row * w + col] = [160, 60, 60];
            }
            if b && !a {
                out[row * w + col] = [60, 160, 60];
            }
        }
    }
    let mut dot = |p: glam::DVec2, c: [u8; 3], r: i32| {
        let (row, col) = ((40.0 - p.x) / 0.2, (40.0 - p.y) / 0.2);
        for dr in -r..=r {
            for dc in -r..=r {
                let (i, j) = (row as i32 + dr, col as i32 + dc);
                if (0..w as i32).contains(&i) && (0..w as i32).contains(&j) {
                    out[(i as usize) * w + j as usize] = c;
                }
            }
        }
    };
    for line in net.lines().values() {
        let n = (scene::roads::curve::length_m(line) / 0.2) as usize;
        for k in 0..=n {
            dot(scene::roads::curve::at(line, k as f64 * 0.2).0, [60, 230, 250], 0);
        }
    }
    for r in &net.roads {
        for p in &r.via_m {
            dot(*p, [60, 255, 120], 2);
        }
    }
    for n in &net.nodes {
        dot(n.at_m, [255, 60, 60], 3);
    }
    out
}
