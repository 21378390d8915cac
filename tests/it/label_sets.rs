//! Voxels of other data sets, in each one's own layout: opened, edited by one step, saved, reopened and written back. What the
//! edit did not touch has the labels of the file, also those that the program has no class for. The files are made here.

use std::collections::BTreeMap;
use std::io::{Cursor, Read, Write};
use std::path::Path;

use super::cli::{Folder, json, refused, sceneloom};
use app::export::{ExportOptions, ExportProgress, export_all};
use editor::Document;
use formats::import::{self, Content};
use formats::{export, loom};
use npyz::WriterBuilder;
use scene::{Class, Edit, Scene};
use zip::write::SimpleFileOptions;
use zip::{ZipArchive, ZipWriter};

/// Labels of a street, of three kinds of its own that share the class of a tree, and of a number without a name.
struct Names {
    road: i32,
    car: i32,
    wall: i32,
    trees: [i32; 2],
    odd: i32,
}

/// A layout of files.
struct Layout {
    /// Id of the exporter.
    id: &'static str,
    /// Name of the file that is opened, and the end of that which is written.
    file: &'static str,
    ending: &'static str,
    size: [usize; 3],
    cell_m: f64,
    /// Layer of the ground.
    ground: usize,
    /// True where x is to the right and y ahead, false where x is ahead and y to the left.
    turned: bool,
    names: Names,
    container: Container,
}

#[derive(Clone, Copy)]
enum Container {
    /// Rows z, y, x, label or x, y, z, label.
    Rows { z_first: bool },
    /// The same in an archive, under a name.
    RowsIn(&'static str),
    /// All cells as bytes in an archive, under a name, with a label of free ones.
    Dense(&'static str, u8),
    /// All cells, two bytes each.
    Raw,
}

const NUSCENES: Names = Names {
    road: 11,
    car: 4,
    wall: 15,
    trees: [16, 16],
    odd: 255,
};

const fn rows_of_nuscenes(
    id: &'static str,
    size: [usize; 3],
    cell_m: f64,
    ground: usize,
    z_first: bool,
) -> Layout {
    Layout {
        id,
        file: "frame.npy",
        ending: ".npy",
        size,
        cell_m,
        ground,
        turned: true,
        names: NUSCENES,
        container: Container::Rows { z_first },
    }
}

const LAYOUTS: [Layout; 8] = [
    rows_of_nuscenes("openoccupancy", [512, 512, 40], 0.2, 15, true),
    rows_of_nuscenes("surroundocc", [200, 200, 16], 0.5, 6, false),
    rows_of_nuscenes("surroundocc", [500, 500, 40], 0.2, 15, false),
    rows_of_nuscenes("surroundocc", [800, 800, 64], 0.125, 25, false), // UniScene
    Layout {
        id: "semantic-kitti",
        file: "000000.label",
        ending: ".label",
        size: [256, 256, 32],
        cell_m: 0.2,
        ground: 1,
        turned: false,
        names: Names {
            road: 60,
            car: 252,
            wall: 51,
            trees: [70, 71],
            odd: 1000,
        },
        container: Container::Raw,
    },
    Layout {
        id: "nuplan-occ",
        file: "token.npz",
        ending: ".npz",
        size: [400, 400, 32],
        cell_m: 0.25,
        ground: 5,
        turned: false,
        names: Names {
            road: 7,
            car: 0,
            wall: 5,
            trees: [6, 6],
            odd: 40,
        },
        container: Container::RowsIn("occ"),
    },
    Layout {
        id: "occ3d",
        file: "labels.npz",
        ending: ".npz",
        size: [200, 200, 16],
        cell_m: 0.4,
        ground: 0,
        turned: false,
        names: Names { odd: 0, ..NUSCENES },
        container: Container::Dense("semantics", 17),
    },
    Layout {
        id: "occ3d-waymo",
        file: "000_04.npz",
        ending: ".npz",
        size: [200, 200, 16],
        cell_m: 0.4,
        ground: 0,
        turned: false,
        names: Names {
            road: 13,
            car: 1,
            wall: 6,
            trees: [11, 12],
            odd: 0,
        },
        container: Container::Dense("voxel_label", 23),
    },
];

/// Labels of cells that are not free.
type Cells = BTreeMap<[usize; 3], i32>;

/// A street from 4 m ahead on, a car on it, a wall and trees beside it.
fn street(layout: &Layout) -> Cells {
    let mut cells = Cells::new();
    let [nx, ny, _] = layout.size;
    // (the frame of SemanticKITTI begins at the vehicle)
    let begins = if layout.id == "semantic-kitti" {
        0.0
    } else {
        nx as f64 / 2.0
    };
    let mut block = |ahead: [f64; 2], left: [f64; 2], up: [usize; 2], label: &dyn Fn(usize) -> i32| {
        let cell = |m: f64, middle: f64| (m / layout.cell_m + middle).round() as usize;
        for i in cell(ahead[0], begins)..cell(ahead[1], begins) {
            for j in cell(left[0], ny as f64 / 2.0)..cell(left[1], ny as f64 / 2.0) {
                for k in up[0]..up[1] {
                    let at = match layout.turned {
                        true => [nx - 1 - j, i, layout.ground + k],
                        false => [i, j, layout.ground + k],
                    };
                    cells.insert(at, label(i + j + k));
                }
            }
        }
    };
    let names = &layout.names;
    let layers = (1.6 / layout.cell_m).round() as usize;
    block([4.0, 38.0], [-6.0, 6.0], [0, 1], &|_| names.road);
    block([12.0, 16.5], [1.0, 3.0], [1, 1 + layers], &|_| names.car);
    block([6.0, 30.0], [7.0, 7.6], [1, 1 + layers], &|_| names.wall);
    block([8.0, 12.0], [-9.0, -7.0], [1, 1 + layers], &|i| {
        names.trees[i % 2]
    });
    block([20.0, 20.6], [-9.0, -8.4], [1, 2], &|_| names.odd);
    cells
}

fn array<T: npyz::AutoSerialize + Copy>(shape: &[u64], values: impl IntoIterator<Item = T>) -> Vec<u8> {
    let mut bytes = Vec::new();
    let options = npyz::WriteOptions::new().default_dtype().shape(shape);
    let mut writer = options.writer(&mut bytes).begin_nd().expect("in memory");
    writer.extend(values).expect("in memory");
    writer.finish().expect("in memory");
    bytes
}

fn archive(name: &str, array: &[u8]) -> Vec<u8> {
    let mut zip = ZipWriter::new(Cursor::new(Vec::new()));
    zip.start_file(format!("{name}.npy"), SimpleFileOptions::default())
        .expect("in memory");
    zip.write_all(array).expect("in memory");
    zip.finish().expect("in memory").into_inner()
}

fn unpacked(bytes: &[u8], name: &str) -> Vec<u8> {
    let mut zip = ZipArchive::new(Cursor::new(bytes)).expect("an archive");
    let mut out = Vec::new();
    let mut file = zip.by_name(&format!("{name}.npy")).expect("there");
    file.read_to_end(&mut out).expect("sound");
    out
}

impl Layout {
    fn write(&self, cells: &Cells) -> Vec<u8> {
        let rows = |z_first: bool| {
            let row = |(&[x, y, z], &label): (&[usize; 3], &i32)| match z_first {
                true => [z as i32, y as i32, x as i32, label],
                false => [x as i32, y as i32, z as i32, label],
            };
            let rows: Vec<[i32; 4]> = cells.iter().map(row).collect();
            array(&[rows.len() as u64, 4], rows.into_flattened())
        };
        let dense = |free: u16| {
            let [nx, ny, nz] = self.size;
            let mut all = vec![free; nx * ny * nz];
            for ([x, y, z], label) in cells {
                all[(x * ny + y) * nz + z] = *label as u16;
            }
            all
        };
        match self.container {
            Container::Rows { z_first } => rows(z_first),
            Container::RowsIn(name) => archive(name, &rows(false)),
            Container::Dense(name, free) => {
                let labels = dense(free.into()).into_iter().map(|label| label as u8);
                archive(name, &array(&self.size.map(|n| n as u64), labels))
            }
            Container::Raw => dense(0).into_iter().flat_map(u16::to_le_bytes).collect(),
        }
    }

    fn read(&self, bytes: &[u8]) -> Cells {
        let rows = |npy: &[u8], z_first: bool| -> Cells {
            let values: Vec<i32> = npyz::NpyFile::new(npy)
                .expect("an array")
                .into_vec()
                .expect("whole numbers");
            let rows = values.as_chunks::<4>().0.iter();
            rows.map(|[a, b, c, label]| {
                let [a, b, c] = [*a, *b, *c].map(|v| v as usize);
                (if z_first { [c, b, a] } else { [a, b, c] }, *label)
            })
            .collect()
        };
        let dense = |labels: Vec<u16>, free: u16| -> Cells {
            let [_, ny, nz] = self.size;
            let set = labels.into_iter().enumerate().filter(|(_, label)| *label != free);
            set.map(|(i, label)| ([i / (ny * nz), i / nz % ny, i % nz], label.into()))
                .collect()
        };
        match self.container {
            Container::Rows { z_first } => rows(bytes, z_first),
            Container::RowsIn(name) => rows(&unpacked(bytes, name), false),
            Container::Dense(name, free) => {
                let npy = unpacked(bytes, name);
                let labels: Vec<u8> = npyz::NpyFile::new(&npy[..])
                    .expect("an array")
                    .into_vec()
                    .expect("bytes");
                dense(labels.into_iter().map(u16::from).collect(), free.into())
            }
            Container::Raw => dense(
                bytes
                    .as_chunks::<2>()
                    .0
                    .iter()
                    .map(|b| u16::from_le_bytes(*b))
                    .collect(),
                0,
            ),
        }
    }

    /// Cells of a scene as it is exported.
    fn exported(&self, scene: &Scene, folder: &Path) -> Cells {
        let format = export::from_id(self.id).expect("a format");
        let path = folder.join(format.file_name.unwrap_or("out"));
        let (options, progress) = (ExportOptions::default(), ExportProgress::default());
        let files = export_all(scene, &[format], &options, &path, &progress).expect("written");
        let labels = files
            .iter()
            .find(|(path, _)| path.to_string_lossy().ends_with(self.ending));
        self.read(&std::fs::read(&labels.expect("labels").0).expect("there"))
    }

    fn difference(&self, a: &Cells, b: &Cells) -> Vec<[usize; 3]> {
        let all: std::collections::BTreeSet<&[usize; 3]> = a.keys().chain(b.keys()).collect();
        all.into_iter()
            .filter(|cell| a.get(*cell) != b.get(*cell))
            .copied()
            .collect()
    }
}

#[test]
fn every_layout_comes_back_as_it_was_but_for_the_edit() {
    for layout in &LAYOUTS {
        let name = format!("{} of {} m", layout.id, layout.cell_m);
        let dir = tempfile::tempdir().expect("a folder");
        let cells = street(layout);
        let file = dir.path().join(layout.file);
        std::fs::write(&file, layout.write(&cells)).expect("written");
        assert!(
            layout.read(&layout.write(&cells)) == cells,
            "{name}: the test's own files"
        );
        let Content::Scene(found) = import::read(&file).expect("read").1 else {
            panic!("{name}: no scene");
        };
        let scene = found.scene;
        assert_eq!(scene.frame().extent().voxel_m(), layout.cell_m, "{name}");
        assert_eq!(scene.frame().occupancy.count_set(), cells.len(), "{name}");
        let back = layout.exported(&scene, dir.path());
        assert_eq!(layout.difference(&back, &cells), [[0; 3]; 0], "{name}: as it was");

        // One edit: some trees become a car. It is saved and reopened.
        let trees = scene
            .frame()
            .occupancy
            .iter_set()
            .filter(|v| v.3 == Class::Vegetation.id());
        let mut painted: Vec<[usize; 3]> = trees.map(|(x, y, z, _)| [x, y, z]).step_by(7).take(9).collect();
        if painted.is_empty() {
            let objects = scene
                .frame()
                .occupancy
                .iter_set()
                .filter(|v| v.3 == Class::Others.id());
            painted = objects.map(|(x, y, z, _)| [x, y, z]).step_by(7).take(9).collect();
        }
        assert_eq!(painted.len(), 9, "{name}");
        let mut document = Document::new(scene);
        let paint = Edit::PaintVoxels {
            cells: painted,
            class: Class::Car,
        };
        document.apply("Paint", &paint).expect("sound");
        let bytes = loom::to_bytes(&document.to_save()).expect("sound");
        let (mut document, _) = Document::open(loom::from_bytes(&bytes).expect("sound"));
        let edited = layout.exported(document.scene(), dir.path());
        let changed = layout.difference(&edited, &cells);
        assert_eq!(changed.len(), 9, "{name}");
        let usual_car = match layout.id {
            "semantic-kitti" => 10,
            _ => layout.names.car,
        };
        assert!(changed.iter().all(|cell| edited[cell] == usual_car), "{name}");
        document.undo();
        let undone = layout.exported(document.scene(), dir.path());
        assert_eq!(layout.difference(&undone, &cells), [[0; 3]; 0], "{name}: undone");
    }
}

#[test]
fn labels_of_a_set_that_is_not_known_are_refused_in_one_line() {
    let dir = tempfile::tempdir().expect("a folder");
    let layout = LAYOUTS
        .iter()
        .find(|layout| layout.id == "semantic-kitti")
        .expect("there");
    let file = dir.path().join(layout.file);
    std::fs::write(&file, layout.write(&street(layout))).expect("written");
    let Content::Scene(found) = import::read(&file).expect("read").1 else {
        panic!("no scene");
    };
    let bytes = loom::to_bytes(&found.scene).expect("sound");
    for (from, to, says) in [
        (
            "\"set\":\"semantic-kitti\"",
            "\"set\":\"of-mars\"",
            "set of-mars, expected one of nuscenes",
        ),
        ("\"special\":", "\"special\":9", "labels"),
    ] {
        let damaged = crate::lattices::rewritten(&bytes, |text| {
            assert!(text.contains(from), "{text}");
            text.replacen(from, to, 1)
        });
        let line = loom::from_bytes(&damaged).expect_err("refused").to_string();
        assert!(line.contains(says) && !line.contains('\n'), "{line}");
    }
}

/// What an earlier command changed without generating is drawn by the next edit, which says so; --verify is for maps of 0.4 m.
#[test]
fn an_edit_tells_what_else_it_draws() {
    let folder = Folder::new();
    let scene = folder.scene();
    let paint = r#"[{"paint_voxels": {"cells": [[100, 90, 3]], "class": "barrier"}}]"#;
    let edits = folder.write("paint.json", paint);
    let out = folder.path("out.loom");
    let notes = |from: &str| {
        let report = json(&sceneloom(&[
            "edit", from, "--edits", &edits, "-o", &out, "--json",
        ]));
        report["notes"].to_string()
    };
    assert!(!notes(&scene).contains("changed before"));
    let asked = folder.path("asked.loom");
    let words = ["prompt", "remove the nearest car", "--base", &scene, "-o", &asked];
    assert!(sceneloom(&words).status.success());
    let told = notes(&asked);
    assert!(
        told.contains("voxels that were changed before and not generated since"),
        "{told}"
    );

    let fine = folder.path("fine.loom");
    let new = ["new", "--template", "straight", "--voxel", "0.2", "-o", &fine];
    assert!(sceneloom(&new).status.success());
    refused(
        &["edit", &fine, "--edits", &edits, "--verify", "-o", &out],
        &["--verify", "0.2 m"],
    );
    refused(
        &["new", "--template", "straight", "--bins", "3", "-o", &fine],
        &["--bins", "3 bins"],
    );
}
