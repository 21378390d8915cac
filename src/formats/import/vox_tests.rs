use glam::DVec3;
use scene::classes::Palette;
use scene::{Class, Extent, VoxelGrid};

use super::*;
use crate::table_tests::scene;
use crate::vox::to_bytes;

/// A small scene.
pub(super) fn sample() -> Vec<u8> {
    to_bytes(&scene().frame().occupancy)
}

fn placed(bytes: &[u8]) -> VoxMap {
    place(&VoxFile::read(bytes).expect("chunks")).expect("a map")
}

fn refusal(bytes: &[u8]) -> String {
    let source = ImportFile {
        bytes,
        name: "model",
        path: None,
        options: Default::default(),
    };
    read(&source).expect_err("refused")
}

fn chunk(id: &str, content: &[u8]) -> Vec<u8> {
    let size = (content.len() as u32).to_le_bytes();
    [id.as_bytes(), &size, &[0; 4], content].concat()
}

fn file(chunks: &[Vec<u8>]) -> Vec<u8> {
    let children = chunks.concat();
    let size = (children.len() as u32).to_le_bytes();
    [b"VOX \xc8\0\0\0MAIN\0\0\0\0", &size[..], &children].concat()
}

fn ints(of: &[i32]) -> Vec<u8> {
    of.iter().flat_map(|v| v.to_le_bytes()).collect()
}

fn text(t: &str) -> Vec<u8> {
    [&(t.len() as u32).to_le_bytes(), t.as_bytes()].concat()
}

fn dict(pairs: &[(&str, &str)]) -> Vec<u8> {
    let mut out = ints(&[pairs.len() as i32]);
    pairs
        .iter()
        .for_each(|(key, value)| out.extend([text(key), text(value)].concat()));
    out
}

fn model(size: [i32; 3], voxels: &[[u8; 4]]) -> Vec<u8> {
    let content = [ints(&[voxels.len() as i32]), voxels.concat()].concat();
    [chunk("SIZE", &ints(&size)), chunk("XYZI", &content)].concat()
}

fn transform(number: i32, child: i32, attributes: &[(&str, &str)], moment: &[(&str, &str)]) -> Vec<u8> {
    let content = [
        ints(&[number]),
        dict(attributes),
        ints(&[child, -1, 3, 1]),
        dict(moment),
    ]
    .concat();
    chunk("nTRN", &content)
}

fn group(number: i32, children: &[i32]) -> Vec<u8> {
    let content = [
        ints(&[number]),
        dict(&[]),
        ints(&[children.len() as i32]),
        ints(children),
    ]
    .concat();
    chunk("nGRP", &content)
}

fn shape(number: i32, model: i32) -> Vec<u8> {
    chunk(
        "nSHP",
        &[ints(&[number]), dict(&[]), ints(&[1, model]), dict(&[])].concat(),
    )
}

/// The classes' colours of a palette.
fn colors(palette: Palette) -> Vec<u8> {
    let color = |k: usize| Class::from_id(k as u8).map_or([1, 2, 3], |class| class.color_in(palette));
    let all: Vec<u8> = (0..256).map(color).flat_map(|[r, g, b]| [r, g, b, 255]).collect();
    chunk("RGBA", &all)
}

const CAR: u8 = Class::Car as u8 + 1;

/// Where the car's voxels lie, m of the ego frame.
fn cars(grid: &VoxelGrid) -> Vec<DVec3> {
    let cars = grid.iter_set().filter(|v| v.3 == Class::Car.id());
    cars.map(|(x, y, z, _)| grid.extent().center(x, y, z)).collect()
}

#[test]
fn maps_of_any_extent_come_back_with_their_extent() {
    let extents = [
        ([-100, -100], [200, 200]),
        ([-250, -249], [500, 500]),
        ([7, -3], [31, 257]),
        ([-3, 900], [1, 1]),
    ];
    for (from, size) in extents {
        let extent = Extent::new(from, size).expect("sound");
        let mut grid = VoxelGrid::over(extent);
        for (i, [x, y]) in extent.all_columns().enumerate().step_by(37) {
            grid.set(x, y, i % 16, (i % 17) as u8);
        }
        let bytes = to_bytes(&grid);
        assert_eq!(bytes, to_bytes(&grid));
        let back = placed(&bytes);
        assert!(
            back.grid == grid && back.skipped.is_empty(),
            "{extent}: {:?}",
            back.skipped
        );
        let empty = placed(&to_bytes(&VoxelGrid::over(extent)));
        assert_eq!((empty.grid.extent(), empty.grid.count_set()), (extent, 0));
    }
}

/// Without nodes a model stands in the middle on the ground: of two voxels the second is ahead, to the left and above.
#[test]
fn a_bare_model_stands_in_the_middle() {
    let bytes = file(&[
        model([11, 4, 3], &[[0, 0, 0, CAR], [10, 3, 2, CAR]]),
        colors(Palette::Standard),
    ]);
    let back = placed(&bytes);
    let at = |x: f64, y: f64, z: f64| DVec3::new(x, y, z);
    let expected = [at(-1.8, -0.6, -0.8), at(2.2, 0.6, 0.0)];
    let found = cars(&back.grid);
    assert!(
        found.iter().zip(expected).all(|(a, b)| (*a - b).length() < 1e-9),
        "{found:?}"
    );
    assert_eq!(back.grid.extent(), Extent::WINDOW);
}

/// A car of 3 x 1 x 1 voxels, turned to the left by a node, placed ahead to the left by the one above it.
#[test]
fn nodes_turn_and_move() {
    // Rows 0 -1 0, 1 0 0, 0 0 1: a quarter to the left.
    let quarter = (1 | 1 << 4).to_string();
    let bytes = file(&[
        model([3, 1, 1], &[[0, 0, 0, CAR], [1, 0, 0, CAR], [2, 0, 0, CAR + 1]]),
        colors(Palette::ColorBlindSafe),
        transform(0, 1, &[], &[("_t", "50 20 5")]),
        group(1, &[2]),
        transform(2, 3, &[("_name", "car")], &[("_r", &quarter), ("_t", "0 0 1")]),
        shape(3, 0),
    ]);
    let back = placed(&bytes);
    let mut found: Vec<_> = back.grid.iter_set().collect();
    found.sort_unstable();
    // Columns 50 ahead and 20 to the left of the origin, six voxels high, one after another to the left.
    let car = Class::Car.id();
    assert_eq!(
        found,
        [(149, 119, 6, car), (149, 120, 6, car), (149, 121, 6, car + 1)]
    );
}

#[test]
fn what_is_not_shown_or_not_known_is_counted() {
    let grey = CAR + 60;
    let bytes = file(&[
        chunk("PACK", &ints(&[2])),
        model(
            [2, 2, 40],
            &[
                [0, 0, 0, CAR],
                [1, 1, 39, CAR],
                [5, 0, 0, CAR],
                [0, 0, 1, grey],
                [0, 1, 1, 0],
            ],
        ),
        model([1, 1, 1], &[[0, 0, 0, CAR]]),
        colors(Palette::Standard),
        chunk("MATL", &[1, 2, 3]),
        chunk(
            "LAYR",
            &[ints(&[3]), dict(&[("_hidden", "0")]), ints(&[-1])].concat(),
        ),
        transform(0, 1, &[], &[]),
        group(1, &[2, 4, 6, 9]),
        transform(2, 3, &[], &[("_t", "0 0 20")]),
        shape(3, 0),
        transform(4, 5, &[("_hidden", "1")], &[]),
        shape(5, 1),
        transform(6, 7, &[], &[]),
        shape(7, 8),
    ]);
    let back = placed(&bytes);
    let counts: Vec<String> = back
        .skipped
        .iter()
        .map(|(what, n)| format!("{what} {n}"))
        .collect();
    assert_eq!(
        counts,
        [
            "chunk MATL 1",
            "hidden parts 1",
            "nodes that are not there 1",
            "parts without a model 1",
            "voxels above or below the map 1",
            "voxels of colours that no class has, taken as others 1",
            "voxels outside their model 2",
        ]
    );
    assert_eq!(back.grid.class_counts()[..5], [1, 0, 0, 0, 1]);
    // A file without colours has those of the editor, which are no classes'.
    let back = placed(&file(&[model([1, 1, 1], &[[0, 0, 0, 7]])]));
    assert_eq!(
        back.skipped
            .get("voxels of colours that no class has, taken as others"),
        Some(&1)
    );
}

#[test]
fn bad_files_are_one_line() {
    let one = || model([1, 1, 1], &[[0, 0, 0, CAR]]);
    let cases = [
        (b"VOX".to_vec(), "no .vox file"),
        (file(&[]), "no model"),
        (
            [b"VOX ", &ints(&[150])[..], &chunk("PACK", &[])].concat(),
            "a first chunk PACK, expected MAIN",
        ),
        (
            file(&[chunk("XYZI", &ints(&[0]))]),
            "chunk XYZI: no SIZE before it",
        ),
        (
            file(&[chunk("SIZE", &ints(&[1, 0, 1]))]),
            "chunk SIZE: [1, 0, 1] voxels, expected 1 to 256",
        ),
        (
            file(&[chunk("SIZE", &ints(&[1, 1, 257]))]),
            "chunk SIZE: [1, 1, 257] voxels",
        ),
        (
            file(&[
                chunk("SIZE", &ints(&[9, 9, 9])),
                chunk("XYZI", &ints(&[i32::MAX])),
            ]),
            "chunk XYZI: 0 bytes, expected 8589934588",
        ),
        (
            file(&[one(), chunk("RGBA", &[0; 1023])]),
            "chunk RGBA: 1023 bytes, expected 1024",
        ),
        (
            file(&[one(), chunk("nGRP", &ints(&[0, 0, -1]))]),
            "chunk nGRP: 0 bytes, expected 4294967295 entries",
        ),
        (
            file(&[one(), chunk("nSHP", &ints(&[0, -1]))]),
            "chunk nSHP: 0 bytes, expected 4294967295 entries",
        ),
        (
            file(&[one(), transform(0, 1, &[], &[("_r", "0")])]),
            "chunk nTRN: _r is 0, expected a turn",
        ),
        (
            file(&[one(), transform(0, 1, &[], &[("_t", "1 2")])]),
            "chunk nTRN: _t is \"1 2\", expected three",
        ),
        (
            file(&[one(), transform(0, 1, &[], &[("_t", "1 2 NaN")])]),
            "chunk nTRN: \"NaN\", expected a whole",
        ),
        (
            file(&[one(), group(0, &[])]),
            "none of 0 voxels is from 0 to 15 high",
        ),
        // A node that lies in itself, and nodes of which each lies twice in the one before.
        (
            file(&[one(), transform(0, 0, &[], &[])]),
            "nodes within nodes without end",
        ),
        (
            file(
                &(0..40)
                    .map(|i| group(i, &[i + 1; 2]))
                    .chain([one(), shape(40, 0)])
                    .collect::<Vec<_>>(),
            ),
            "nodes within nodes without end",
        ),
        // One voxel on a map of kilometres, and one that no map reaches.
        (
            file(&[one(), transform(0, 1, &[], &[("_t", "9000 9000 0")]), shape(1, 0)]),
            "1 voxels on a map of 9101 x 9101 columns, expected at most 1048832",
        ),
        (
            file(&[
                one(),
                transform(0, 1, &[], &[("_t", "2147483647 0 0")]),
                shape(1, 0),
            ]),
            "1 voxels on a map of",
        ),
    ];
    for (bytes, expected) in cases {
        let line = refusal(&bytes);
        assert!(line.starts_with(expected), "{line}, expected {expected}");
    }
    // Chunks within chunks, as deep as a megabyte goes, are one chunk.
    let nest: Vec<u8> = (0..80_000)
        .rev()
        .flat_map(|inside| [b"nest".to_vec(), ints(&[0, 12 * inside])].concat())
        .collect();
    assert!(placed(&file(&[one(), nest])).skipped.contains_key("chunk nest"));
    let whole = sample();
    for cut in (0..whole.len()).step_by(7).chain(whole.len() - 40..whole.len()) {
        assert!(!refusal(&whole[..cut]).is_empty(), "{cut}");
    }
}
