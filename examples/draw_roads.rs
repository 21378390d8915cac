//! Draws layouts cut out of OpenDRIVE files, to look at: `cargo run --release --example draw_roads -- OUT_DIR FILE…`.
//! Each picture is the window at the suggested place, or at `--at X,Y,HEADING_DEG` given before the files; ego looks up.

use std::path::Path;

use glam::DVec2;
use sceneloom::formats::opendrive;
use sceneloom::scene::{BevLayer, GridSpec, PolylineKind};

const SCALE: usize = 3;

fn main() -> anyhow::Result<()> {
    let mut args = std::env::args().skip(1).peekable();
    let out_dir = args
        .next()
        .ok_or_else(|| anyhow::anyhow!("usage: draw_roads OUT_DIR [--at X,Y,DEG] FILE…"))?;
    std::fs::create_dir_all(&out_dir)?;
    let mut place = None;
    if args.peek().is_some_and(|a| a == "--at") {
        let numbers: Vec<f64> = args
            .by_ref()
            .nth(1)
            .unwrap_or_default()
            .split(',')
            .map(str::parse)
            .collect::<Result<_, _>>()?;
        anyhow::ensure!(numbers.len() == 3, "--at X,Y,DEG");
        place = Some((DVec2::new(numbers[0], numbers[1]), numbers[2].to_radians()));
    }
    for file in args {
        let started = std::time::Instant::now();
        let network = opendrive::read(&std::fs::read(&file)?)?;
        let read_s = started.elapsed().as_secs_f64();
        let (at, heading) = place.unwrap_or_else(|| network.suggest_pose());
        let import = network.to_layout(at, heading);
        println!(
            "{file}: {} roads, at {:.1},{:.1} heading {:.1} deg: {} roads, {} lanes, {} crossings, drivable {:.1} %, read {read_s:.3} s, all {:.3} s\n  skipped {:?}",
            network.roads.len(),
            at.x,
            at.y,
            heading.to_degrees(),
            import.road_count,
            import.lane_count,
            import.crossing_count,
            100.0 * import.drivable_share,
            started.elapsed().as_secs_f64(),
            import.skipped
        );
        let mut picture = image::RgbImage::from_pixel(
            (GridSpec::NY * SCALE) as u32,
            (GridSpec::NX * SCALE) as u32,
            image::Rgb([22, 26, 24]),
        );
        let mut dot = |x_m: f64, y_m: f64, color: [u8; 3]| {
            let column = (40.0 - y_m) / GridSpec::VOXEL_M * SCALE as f64;
            let row = (40.0 - x_m) / GridSpec::VOXEL_M * SCALE as f64;
            if column >= 0.0 && row >= 0.0 && column < picture.width().into() && row < picture.height().into()
            {
                picture.put_pixel(column as u32, row as u32, image::Rgb(color));
            }
        };
        const ORDER: [BevLayer; 7] = [
            BevLayer::DrivableArea,
            BevLayer::Walkway,
            BevLayer::CarparkArea,
            BevLayer::PedCrossing,
            BevLayer::StopLine,
            BevLayer::RoadDivider,
            BevLayer::LaneDivider,
        ];
        for x in 0..GridSpec::NX {
            for y in 0..GridSpec::NY {
                let center = GridSpec::center(x, y, 0);
                let Some(layer) = ORDER.into_iter().rev().find(|l| import.layout.has(*l, x, y)) else {
                    continue;
                };
                for sub in 0..SCALE * SCALE {
                    let step = |i: usize| (i as f64 + 0.5) / SCALE as f64 * GridSpec::VOXEL_M - 0.2;
                    dot(
                        center.x + step(sub / SCALE),
                        center.y + step(sub % SCALE),
                        layer.color(),
                    );
                }
            }
        }
        for line in import
            .layout
            .polylines
            .iter()
            .filter(|l| l.kind == PolylineKind::LaneCenter)
        {
            let total: f64 = line.points_m.windows(2).map(|p| p[0].distance(p[1])).sum();
            let mut walked = 0.0;
            for ends in line.points_m.windows(2) {
                let length = ends[0].distance(ends[1]);
                for i in 0..(length / 0.1) as usize {
                    let p = ends[0].lerp(ends[1], i as f64 * 0.1 / length);
                    let share = ((walked + i as f64 * 0.1) / total * 200.0) as u8;
                    dot(p.x, p.y, [55 + share, 120, 255 - share]); // blue at its start, red at its end
                }
                walked += length;
            }
        }
        for i in -20..=20 {
            dot(f64::from(i) * 0.1, -1.0, [0, 255, 0]);
            dot(f64::from(i) * 0.1, 1.0, [0, 255, 0]);
            dot(2.0, f64::from(i) * 0.05, [0, 255, 0]);
        }
        let stem = Path::new(&file).file_stem().unwrap_or_default().to_string_lossy();
        picture.save(Path::new(&out_dir).join(format!("{stem}.png")))?;
    }
    Ok(())
}
