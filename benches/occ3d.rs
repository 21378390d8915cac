//! Our side of `benches/occ3d.py`: reads and writes a frame of Occ3D labels with its two masks, one job at a time as asked on
//! standard input, and answers with milliseconds. Build: `cargo bench -p sceneloom-formats --bench occ3d --no-run`.

use std::io::{BufRead, Write};
use std::path::Path;
use std::time::Instant;

use formats::import::{self, Content};
use formats::occ3d::{self, Occ3dFrame};
use scene::{Class, VoxelGrid, Window};

fn main() {
    // `cargo bench` passes an option of its own.
    let Some(folder) = std::env::args().nth(1).filter(|a| !a.starts_with('-')) else {
        return println!("run by benches/occ3d.py");
    };
    let (mine, path) = (
        Path::new(&folder).join("ours.npz"),
        Path::new(&folder).join("labels.npz"),
    );
    let frame = frame();
    std::fs::write(&path, occ3d::frame_to_bytes(&frame)).expect("a folder that can be written");
    println!("ready");
    for line in std::io::stdin().lock().lines().map_while(Result::ok) {
        let begun = Instant::now();
        // What is made is counted, so that nothing is left out as unused.
        let made = match line.trim() {
            "read" => occ3d::load(&path).map_or(0, |f| f.labels.bricks().len()),
            "write" => {
                let bytes = occ3d::frame_to_bytes(&frame);
                std::fs::write(&mine, &bytes).map_or(0, |()| bytes.len())
            }
            "import" => match import::read(&path) {
                Ok((_, Content::Scene(loaded))) => loaded.scene.frame().boxes.len() + 1,
                _ => 0,
            },
            _ => 0,
        };
        println!("{:.6} {made}", begun.elapsed().as_secs_f64() * 1e3);
        let _ = std::io::stdout().flush();
    }
}

/// The grid that the ray cast is measured on, and what a point above the vehicle sees of it: all around, and ahead.
fn frame() -> Occ3dFrame {
    let path = concat!(
        env!("CARGO_MANIFEST_DIR"),
        "/../../tests/reference/raycast/occupancy.npz"
    );
    let file = std::fs::File::open(path).expect("the reference grid");
    let mut zip = zip::ZipArchive::new(file).expect("an npz file");
    let array = zip.by_name("occupancy.npy").expect("an occupancy array");
    let array = npyz::NpyFile::new(array).expect("an npy file");
    let occupied: Vec<u8> = array.into_vec().expect("u8");
    let class = |(i, occupied): (usize, &u8)| match (*occupied == 1, i % Window::NZ) {
        (false, _) => Class::FREE,
        (true, 0) => Class::DriveableSurface.id(),
        (true, z) => [Class::Manmade, Class::Vegetation][z / 8].id(),
    };
    let labels: Vec<u8> = occupied.iter().enumerate().map(class).collect();
    let seen = |reach: fn([i32; 3]) -> bool| (0..Window::VOXELS).map(|i| sees(&labels, i, reach)).collect();
    Occ3dFrame {
        lidar_observed: Some(seen(|_| true)),
        camera_observed: Some(seen(|[x, y, _]| x > y.abs())),
        labels: VoxelGrid::from_dense(&labels).expect("640,000 labels"),
    }
}

/// True if nothing lies between the middle of the grid, 2.8 m above its bottom, and a voxel.
fn sees(labels: &[u8], voxel: usize, reach: fn([i32; 3]) -> bool) -> bool {
    let at = [voxel / 3200, voxel / 16 % 200, voxel % 16].map(|v| v as i32);
    let way = [at[0] - 100, at[1] - 100, at[2] - 7];
    let steps = way.map(i32::abs).into_iter().max().unwrap_or(0).max(1);
    let open = |step: i32| {
        let p = [0, 1, 2].map(|axis| ([100, 100, 7][axis] * steps + way[axis] * step) / steps);
        labels[((p[0] * 200 + p[1]) * 16 + p[2]) as usize] == Class::FREE
    };
    reach(way) && (0..steps).all(open)
}
