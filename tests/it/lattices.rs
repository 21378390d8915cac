//! Maps of other voxels than those of Occ3D: lists of voxels of data sets are opened as they are, edited, sensed, generated,
//! saved and written back.

use std::collections::{BTreeMap, BTreeSet};
use std::io::{Cursor, Read, Write};
use std::path::Path;
use std::sync::Arc;

use app::export::{ExportOptions, ExportProgress, export_all};
use editor::{Document, Shape};
use formats::import::{self, Content, ImportOptions};
use formats::{export, loom};
use glam::DVec3;
use job::pipeline::OccPipeline;
use job::{GenParams, Job, JobCtx, Pipeline};
use nets::OccModels;
use npyz::WriterBuilder;
use scene::{BevLayer, Class, Edit, Extent, Lattice, Scene};
use zip::write::SimpleFileOptions;
use zip::{ZipArchive, ZipWriter};

/// Rows of a street with cars, a house, trees and noise, in an order of columns, and sorted.
fn rows(size: [usize; 3], cell_m: f64, z_first: bool) -> Vec<[i32; 4]> {
    let at = |x_m: f64, y_m: f64, z_m: f64| {
        [
            ((x_m / cell_m) + size[0] as f64 / 2.0) as i32,
            ((y_m / cell_m) + size[1] as f64 / 2.0) as i32,
            ((z_m + 5.0) / cell_m) as i32,
        ]
    };
    let mut cells = BTreeMap::new();
    let mut block = |low: [f64; 3], high: [f64; 3], class: u8| {
        let (low, mut high) = (at(low[0], low[1], low[2]), at(high[0], high[1], high[2]));
        high[2] = high[2].max(low[2] + 1);
        for x in low[0]..high[0] {
            for y in low[1]..high[1] {
                for z in low[2]..high[2] {
                    cells.insert([x, y, z], i32::from(class));
                }
            }
        }
    };
    // x to the right, y ahead; the ground is 1.84 m below the LiDAR.
    block(
        [-5.0, -40.0, -2.0],
        [5.0, 40.0, -1.8],
        Class::DriveableSurface.id(),
    );
    block([5.0, -40.0, -2.0], [9.0, 40.0, -1.8], Class::Sidewalk.id());
    block([-3.0, 10.0, -1.8], [-1.2, 14.4, -0.2], Class::Car.id());
    block([1.0, 20.0, -1.8], [2.8, 24.4, -0.2], Class::Car.id());
    block([12.0, -20.0, -1.8], [22.0, 10.0, 2.8], Class::Manmade.id());
    block([-12.0, 5.0, 0.0], [-9.0, 8.0, 2.0], Class::Vegetation.id());
    block([-0.5, 2.0, 1.0], [0.0, 2.5, 1.5], Class::Others.id());
    let row = |(&[x, y, z], &class): (&[i32; 3], &i32)| match z_first {
        true => [z, y, x, class],
        false => [x, y, z, class],
    };
    let mut rows: Vec<[i32; 4]> = cells.iter().map(row).collect();
    rows.sort_unstable();
    rows
}

fn npy(rows: &[[i32; 4]]) -> Vec<u8> {
    let mut bytes = Vec::new();
    let mut writer = npyz::WriteOptions::new()
        .default_dtype()
        .shape(&[rows.len() as u64, 4])
        .writer(&mut bytes)
        .begin_nd()
        .expect("in memory");
    writer
        .extend(rows.as_flattened().iter().copied())
        .expect("in memory");
    writer.finish().expect("in memory");
    bytes
}

fn read_rows(bytes: &[u8]) -> Vec<[i32; 4]> {
    let file = npyz::NpyFile::new(bytes).expect("an array");
    let values: Vec<i32> = file.into_vec().expect("whole numbers");
    values.as_chunks::<4>().0.to_vec()
}

fn open(path: &Path) -> Scene {
    match import::read(path).expect("read").1 {
        Content::Scene(found) => found.scene,
        other => panic!("{other:?}"),
    }
}

fn written(scene: &Scene, id: &str, folder: &Path) -> Vec<u8> {
    let format = export::from_id(id).expect("a format");
    let path = folder.join(format!("out_{id}.npy"));
    let options = ExportOptions::default();
    export_all(scene, &[format], &options, &path, &ExportProgress::default()).expect("written");
    std::fs::read(path).expect("there")
}

/// OpenOccupancy's grid, as a scene.
fn fine(folder: &Path) -> Scene {
    let path = folder.join("frame.npy");
    std::fs::write(&path, npy(&rows([512, 512, 40], 0.2, true))).expect("written");
    open(&path)
}

#[test]
fn voxels_of_a_data_set_come_back_as_they_were_but_for_the_edit() {
    let dir = tempfile::tempdir().expect("a folder");
    for (id, size, cell_m, z_first) in [
        ("openoccupancy", [512, 512, 40], 0.2, true),
        ("surroundocc", [200, 200, 16], 0.5, false),
    ] {
        let rows = rows(size, cell_m, z_first);
        let path = dir.path().join(format!("{id}.npy"));
        std::fs::write(&path, npy(&rows)).expect("written");
        let scene = open(&path);
        let extent = scene.frame().extent();
        assert_eq!(extent.shape(), size, "{id}");
        assert_eq!(
            extent.lattice(),
            Lattice::new(cell_m, size[2], -3.16).expect("sound")
        );
        assert_eq!(scene.frame().occupancy.count_set(), rows.len());
        assert_eq!(scene.frame().boxes.len(), 2, "{id}: two cars");
        assert!(
            read_rows(&written(&scene, id, dir.path())) == rows,
            "{id}: as it was"
        );

        // A car is painted away by voxels, one is put elsewhere.
        let mut document = Document::new(scene);
        let car = *document.scene().frame().boxes.values().next().expect("a car");
        document
            .apply("Remove", &Edit::RemoveBox { id: car.id })
            .expect("sound");
        let before = document.scene().frame().occupancy.clone();
        let cells: Vec<[usize; 3]> = (0..3).map(|i| [40 + i, 60, 5]).collect();
        let paint = Edit::PaintVoxels {
            cells,
            class: Class::Barrier,
        };
        document.apply("Paint", &paint).expect("sound");
        assert_eq!(document.scene().frame().occupancy.count_different(&before), 3);
        let after = read_rows(&written(document.scene(), id, dir.path()));
        let (old, new): (BTreeSet<_>, BTreeSet<_>) = (rows.iter().collect(), after.iter().collect());
        let gone: Vec<_> = old.difference(&new).collect();
        let come: Vec<_> = new.difference(&old).collect();
        assert!(!gone.is_empty() && gone.iter().all(|row| row[3] == i32::from(Class::Car.id())));
        let barriers = come.iter().filter(|row| row[3] == i32::from(Class::Barrier.id()));
        assert_eq!(barriers.count(), 3);
        // Ground is laid where the car stood, and nothing else came.
        let laid = i32::from(Class::DriveableSurface.id());
        assert!(
            come.iter()
                .all(|row| [laid, i32::from(Class::Barrier.id())].contains(&row[3]))
        );
        document.undo();
        document.undo();
        assert!(
            read_rows(&written(document.scene(), id, dir.path())) == rows,
            "{id}: undone"
        );
    }
}

#[test]
fn a_file_keeps_the_lattice_and_the_history() {
    let dir = tempfile::tempdir().expect("a folder");
    let mut document = Document::new(fine(dir.path()));
    let origin = document.scene().clone();
    let add = Edit::AddBox {
        class: Class::Truck,
        center_m: DVec3::new(20.0, -2.0, 1.4),
        size_m: DVec3::new(7.0, 2.5, 2.8),
        yaw_deg: 5.0,
        velocity_mps: None,
        id: None,
        label: Default::default(),
    };
    document.apply("Add", &add).expect("sound");
    let trucks = document.scene().frame().occupancy.class_counts()[usize::from(Class::Truck.id())];
    // 7 x 2.5 x 2.8 m in voxels of 8 litres: 6,125, drawn to whole voxels.
    assert!((5000..8000).contains(&trucks), "{trucks}");
    let bytes = loom::to_bytes(&document.to_save()).expect("sound");
    let (mut again, note) = Document::open(loom::from_bytes(&bytes).expect("sound"));
    assert_eq!(note, None);
    assert!(again.scene().is_same(document.scene()));
    again.undo();
    assert!(again.scene().is_same(&origin));

    // Lattices that are none are refused in one line.
    for (voxel_m, bins, says) in [
        ("0.0", "40", "voxels of 0 m"),
        ("0.2", "0", "0 bins"),
        ("0.2", "1000000000", "bins"),
        ("1e99", "40", "voxels of"),
        ("-0.2", "40", "voxels of"),
    ] {
        let damaged = rewritten(&bytes, |text| {
            text.replace("\"voxel_m\":0.2", &format!("\"voxel_m\":{voxel_m}"))
                .replace("\"bins\":40", &format!("\"bins\":{bins}"))
        });
        let line = loom::from_bytes(&damaged).expect_err("refused").to_string();
        assert!(line.contains(says) && !line.contains('\n'), "{line}");
    }
}

/// A project file with another `scene.json`.
pub(crate) fn rewritten(bytes: &[u8], change: impl Fn(&str) -> String) -> Vec<u8> {
    let mut archive = ZipArchive::new(Cursor::new(bytes)).expect("a zip");
    let mut out = ZipWriter::new(Cursor::new(Vec::new()));
    for i in 0..archive.len() {
        let mut entry = archive.by_index(i).expect("there");
        let mut content = Vec::new();
        entry.read_to_end(&mut content).expect("sound");
        let name = entry.name().expect("a name").into_owned();
        if name == "scene.json" {
            let text = String::from_utf8(content).expect("JSON");
            content = change(&text).into_bytes();
        }
        out.start_file(name, SimpleFileOptions::default())
            .expect("in memory");
        out.write_all(&content).expect("in memory");
    }
    out.finish().expect("in memory").into_inner()
}

#[test]
fn sensors_and_networks_work_on_it_and_leave_the_rest() {
    let dir = tempfile::tempdir().expect("a folder");
    let scene = fine(dir.path());
    let placed = scene.for_sensors();
    assert_eq!(placed.frame().extent().lattice(), Lattice::OCC3D);
    let sweep = sensors::lidar::rolling::of_voxels(&placed);
    let cars = sweep.points.iter().filter(|p| p.class == Class::Car).count();
    assert!(
        sweep.points.len() > 5000 && cars > 50,
        "{} {cars}",
        sweep.points.len()
    );

    // A car is moved: its draft is the result. A walkway is painted: the networks draw on it, in their voxels.
    let mut document = Document::new(scene);
    let car = *document.scene().frame().boxes.values().next().expect("a car");
    let moved = Edit::MoveBox {
        id: car.id,
        center_m: Some(car.center_m - DVec3::X * 6.0),
        yaw_deg: None,
        size_m: None,
    };
    document.apply("Move", &moved).expect("sound");
    let mut pipeline = OccPipeline::new(OccModels::bundled().expect("bundled"));
    let mut run = |scene: &Arc<Scene>| {
        let job = Job {
            scene: scene.clone(),
            params: GenParams {
                steps: 4,
                ..GenParams::default()
            },
        };
        pipeline.run(&job, &JobCtx::detached()).expect("a result")
    };
    let result = run(document.scene());
    assert_eq!(result.occupancy, document.scene().frame().occupancy);
    assert_eq!(result.report.network_calls, 0);
    assert!(result.report.voxels_changed > 0);
    let walkway = Edit::PaintBev {
        layer: BevLayer::Walkway,
        shape: Shape::Disc {
            center_m: car.center_m.truncate(),
            radius_m: 4.0,
        },
        value: true,
    };
    document.apply("Paint", &walkway).expect("sound");
    let result = run(document.scene());
    let source = &document.scene().frame().source.occupancy;
    assert_eq!(result.occupancy.extent(), source.extent());
    assert!(result.report.network_calls > 0);
    // Objects and ground are the draft's, voxel by voxel; what is coarse is told.
    let draft = &document.scene().frame().occupancy;
    let is_exact = |label: u8| Class::from_id(label).is_some_and(|c| c.is_object() || c.is_ground());
    let exact = |grid: &scene::VoxelGrid| -> Vec<_> { grid.iter_set().filter(|v| is_exact(v.3)).collect() };
    assert_eq!(exact(&result.occupancy), exact(draft));
    let notes = result.report.notes.join(" ");
    let coarse = draft.count_different(&result.occupancy);
    assert_eq!(
        notes.contains("as coarse as theirs of 0.4 m"),
        coarse > 0,
        "{coarse}: {notes}"
    );
    // Far from the car nothing differs.
    let far = |x: usize, y: usize| {
        let p = source.extent().center(x, y, 0).truncate();
        p.distance(car.center_m.truncate()) > 25.0
    };
    let [nx, ny] = [source.extent().nx(), source.extent().ny()];
    let columns = (0..nx).flat_map(|x| (0..ny).map(move |y| (x, y)));
    for (x, y) in columns.filter(|(x, y)| far(*x, *y)) {
        assert_eq!(result.occupancy.column(x, y), source.column(x, y), "{x} {y}");
    }
    let rev = document.scene().content();
    document.adopt(rev, result.occupancy).expect("of this map");
}

#[test]
fn what_has_no_voxels_of_a_data_set_is_refused_in_one_line() {
    let options = ImportOptions {
        resample: true,
        ..ImportOptions::default()
    };
    let path = crate::house::root().join("assets/roads/four_arm_junction.xodr");
    let line = import::read_with(&path, options)
        .err()
        .expect("refused")
        .to_string();
    assert!(line.contains("OpenOccupancy") && !line.contains('\n'), "{line}");
    assert_eq!(Extent::WINDOW.lattice(), Lattice::OCC3D);
}
