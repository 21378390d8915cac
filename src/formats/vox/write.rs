//! A map as a `.vox` file.

use scene::classes::Palette;
use scene::{Class, VoxelGrid};

use super::{LONGEST, OWN_NAME, middle};

/// Version of the format that all its readers know.
const VERSION: u32 = 150;

/// A map as a file: a model for each part of at most 256 columns a side, all as large as each other or one column smaller.
pub(crate) fn to_bytes(grid: &VoxelGrid) -> Vec<u8> {
    let extent = grid.extent();
    let mut main = Vec::new();
    let mut parts = Vec::new();
    for x in spans(extent.nx()) {
        for y in spans(extent.ny()) {
            let from = [x.start, y.start];
            let size = [x.len(), y.len(), extent.nz()];
            chunk(
                &mut main,
                b"SIZE",
                &size.map(|n| n as u32).map(u32::to_le_bytes).concat(),
            );
            chunk(&mut main, b"XYZI", &voxels(grid, from, size));
            let [fx, fy] = [0, 1].map(|axis| i64::from(extent.from()[axis]) + from[axis] as i64);
            let at = [
                fx + middle(size[0] as i64),
                fy + middle(size[1] as i64),
                middle(size[2] as i64),
            ];
            parts.push(at);
        }
    }
    graph(&mut main, &parts);
    let color = |k: usize| match Class::from_id(k as u8).filter(|class| *class != Class::Free) {
        Some(class) => class.color_in(Palette::Standard),
        None => [75, 75, 75],
    };
    let colors: Vec<u8> = (0..256).map(color).flat_map(|[r, g, b]| [r, g, b, 255]).collect();
    chunk(&mut main, b"RGBA", &colors);
    let mut names = (Class::COUNT as u32 - 1).to_le_bytes().to_vec();
    let classes = Class::ALL.iter().filter(|class| **class != Class::Free);
    classes.for_each(|class| string(&mut names, class.name()));
    chunk(&mut main, b"NOTE", &names);

    let mut out = b"VOX ".to_vec();
    out.extend(VERSION.to_le_bytes());
    out.extend(b"MAIN");
    out.extend(0u32.to_le_bytes());
    out.extend((main.len() as u32).to_le_bytes());
    out.append(&mut main);
    out
}

/// So many columns in as few spans of at most 256 as will do, as equal as can be.
fn spans(columns: usize) -> Vec<std::ops::Range<usize>> {
    let parts = columns.div_ceil(LONGEST);
    (0..parts)
        .map(|i| columns * i / parts..columns * (i + 1) / parts)
        .collect()
}

/// Voxels of a part of the map: x, y, z and the number of the colour.
fn voxels(grid: &VoxelGrid, from: [usize; 2], size: [usize; 3]) -> Vec<u8> {
    let mut out = vec![0; 4]; // their number
    for x in 0..size[0] {
        for y in 0..size[1] {
            let column = grid.column(from[0] + x, from[1] + y).iter().enumerate();
            for (z, label) in column.filter(|(_, label)| **label != Class::FREE) {
                out.extend([x as u8, y as u8, z as u8, label + 1]);
            }
        }
    }
    let count = (out.len() / 4 - 1) as u32;
    out[..4].copy_from_slice(&count.to_le_bytes());
    out
}

/// The nodes: a transform and a group of all, and for each model a transform and a shape.
fn graph(main: &mut Vec<u8>, parts: &[[i64; 3]]) {
    let transform = |main: &mut Vec<u8>, id: usize, name: &str, at: Option<[i64; 3]>| {
        let mut node = ints(&[id as i32]);
        dict(&mut node, &[("_name", name)]);
        // Its child, a reserved number, its layer, the number of its moments.
        node.extend(ints(&[id as i32 + 1, -1, 0, 1]));
        let at = at.map(|[x, y, z]| format!("{x} {y} {z}"));
        let at: Vec<(&str, &str)> = at.iter().map(|at| ("_t", at.as_str())).collect();
        dict(&mut node, &at);
        chunk(main, b"nTRN", &node);
    };
    transform(main, 0, OWN_NAME, None);
    let mut group = ints(&[1]);
    dict(&mut group, &[]);
    group.extend(ints(&[parts.len() as i32]));
    (0..parts.len()).for_each(|i| group.extend(ints(&[2 + 2 * i as i32])));
    chunk(main, b"nGRP", &group);
    for (i, at) in parts.iter().enumerate() {
        transform(main, 2 + 2 * i, &format!("part {}", i + 1), Some(*at));
        let mut shape = ints(&[3 + 2 * i as i32]);
        dict(&mut shape, &[]);
        shape.extend(ints(&[1, i as i32]));
        dict(&mut shape, &[]);
        chunk(main, b"nSHP", &shape);
    }
}

fn ints(of: &[i32]) -> Vec<u8> {
    of.iter().flat_map(|v| v.to_le_bytes()).collect()
}

fn string(out: &mut Vec<u8>, text: &str) {
    out.extend((text.len() as u32).to_le_bytes());
    out.extend(text.as_bytes());
}

fn dict(out: &mut Vec<u8>, pairs: &[(&str, &str)]) {
    out.extend((pairs.len() as u32).to_le_bytes());
    for (key, value) in pairs {
        string(out, key);
        string(out, value);
    }
}

fn chunk(out: &mut Vec<u8>, id: &[u8; 4], content: &[u8]) {
    out.extend(id);
    out.extend((content.len() as u32).to_le_bytes());
    out.extend(0u32.to_le_bytes());
    out.extend(content);
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn parts_are_no_longer_than_a_model_may_be() {
        for columns in [1, 200, 256, 257, 500, 511, 513, 8192] {
            let spans = spans(columns);
            assert_eq!((spans[0].start, spans[spans.len() - 1].end), (0, columns));
            assert!(spans.windows(2).all(|pair| pair[0].end == pair[1].start));
            assert!(
                spans.iter().all(|s| (1..=LONGEST).contains(&s.len())),
                "{columns}"
            );
        }
    }
}
