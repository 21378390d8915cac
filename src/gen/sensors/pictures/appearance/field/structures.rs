//! Buildings, walls and poles: which columns of man-made voxels look alike, and how. A column that belongs to a thing
//! of the scenery looks as that thing does. Every other column looks as the nearest middle of its structure does, so an
//! edit changes no look farther away than 18 m.

use std::collections::BTreeMap;

use glam::Vec2;
use rayon::prelude::*;

use super::super::noise::hash1;
use super::Structure;
use super::owners::Owners;
use scene::Class;
use scene::appearance::{BOTTOM_M, FieldShape, NZ, VOXEL_M};

/// Margin around a thing, columns: connected voxels within it are its own, since labels are ragged.
const RAGGED: usize = 3;
/// Largest distance of the middle whose look a column takes, columns.
const REACH: usize = 32;
/// Radius around a middle within which connected columns decide its look, columns.
const AROUND: usize = 12;
/// Largest depth inside a structure that counts, columns.
const DEEPEST: u32 = 12;
/// An edit changes no look farther away than this, m.
#[cfg(test)]
pub const FARTHEST_M: f64 = (REACH + AROUND) as f64 * scene::Window::VOXEL_M;

/// Columns `[x][y]` of the field that hold man-made voxels.
struct ManmadeColumns<'a> {
    shape: &'a FieldShape,
    solid: &'a [u8],
    has: Vec<bool>,
}

impl<'a> ManmadeColumns<'a> {
    fn new(shape: &'a FieldShape, solid: &'a [u8]) -> Self {
        let FieldShape { nx, ny, .. } = *shape;
        let id = Class::Manmade.id();
        let inner = |c: usize| (1..nx - 1).contains(&(c / ny)) && (1..ny - 1).contains(&(c % ny));
        let has = (0..nx * ny).map(|c| inner(c) && solid[c * NZ..(c + 1) * NZ].contains(&id));
        Self {
            shape,
            solid,
            has: has.collect(),
        }
    }

    /// The eight columns around one that has voxels; none of them is outside, since the ring has none.
    fn around(&self, c: usize) -> impl Iterator<Item = usize> + use<> {
        let ny = self.shape.ny;
        let around = [
            c - ny - 1,
            c - ny,
            c - ny + 1,
            c - 1,
            c + 1,
            c + ny - 1,
            c + ny,
            c + ny + 1,
        ];
        around.into_iter()
    }

    /// Highest voxel of a column, as an index of the field.
    fn top(&self, c: usize) -> usize {
        let id = Class::Manmade.id();
        let column = &self.solid[c * NZ..(c + 1) * NZ];
        column.iter().rposition(|l| *l == id).unwrap_or(0)
    }

    fn at(&self, c: usize) -> Vec2 {
        let ny = self.shape.ny;
        Vec2::new((c / ny) as f32, (c % ny) as f32) * VOXEL_M + self.shape.blocks_from_m
    }

    /// Look that some columns have together.
    fn look(&self, columns: &[usize], id: u32) -> Structure {
        let members = Members::of(columns, self.shape.ny);
        let member = |c: usize, dx: isize, dy: isize| f32::from(u8::from(members.has(c, dx, dy)));
        // Wall directions from the gradient of the ground plan; those at right angles count alike (angle times 4).
        let mut sum = Vec2::ZERO;
        let (mut top, mut wide) = (0, false);
        for &c in columns {
            let mut g = Vec2::ZERO;
            let edge = EDGE as isize;
            for dx in -edge..=edge {
                for dy in -edge..=edge {
                    g += Vec2::new(dx as f32, dy as f32) * member(c, dx, dy);
                }
            }
            if g.length() > 4.0 {
                sum += Vec2::from_angle(g.to_angle() * 4.0) * g.length();
            }
            let square = [(1, 0), (0, 1), (1, 1), (2, 0), (0, 2)];
            wide |= square.into_iter().all(|(dx, dy)| members.has(c, dx, dy));
            top = top.max(self.top(c));
        }
        let highest = columns.iter().filter(|c| self.top(**c) == top);
        let tops: Vec<Vec2> = highest.map(|c| self.at(*c)).collect();
        Structure {
            axis: match sum == Vec2::ZERO {
                true => Vec2::X,
                false => Vec2::from_angle(sum.to_angle() / 4.0),
            },
            columns: columns.len() as u32,
            height_m: top as f32 * VOXEL_M + BOTTOM_M,
            id,
            thin: columns.len() <= THIN && !wide,
            top: tops.iter().sum::<Vec2>() / tops.len().max(1) as f32,
            known: false,
        }
    }
}

/// Most columns of a pole.
const THIN: usize = 16;
/// Radius of the neighbourhood in which the direction of a wall is sought, columns.
const EDGE: usize = 3;

/// Some columns, with room around them.
struct Members {
    from: [usize; 2],
    size: [usize; 2],
    ny: usize,
    has: Vec<bool>,
}

impl Members {
    fn of(columns: &[usize], ny: usize) -> Self {
        let along = |axis: usize| columns.iter().map(move |c| [c / ny, c % ny][axis]);
        let low = [0, 1].map(|axis| along(axis).min().unwrap_or(0));
        let high = [0, 1].map(|axis| along(axis).max().unwrap_or(0));
        let size = [0, 1].map(|axis| high[axis] - low[axis] + 1 + 2 * EDGE);
        let mut members = Self {
            from: low,
            size,
            ny,
            has: vec![false; size[0] * size[1]],
        };
        for c in columns {
            let (x, y) = (c / ny - low[0] + EDGE, c % ny - low[1] + EDGE);
            members.has[x * size[1] + y] = true;
        }
        members
    }

    /// True if the column at this offset from one of them is one too; the offset is at most [`EDGE`].
    fn has(&self, c: usize, dx: isize, dy: isize) -> bool {
        let x = (c / self.ny - self.from[0] + EDGE) as isize + dx;
        let y = (c % self.ny - self.from[1] + EDGE) as isize + dy;
        self.has[x as usize * self.size[1] + y as usize]
    }
}

/// Structure of each column (0 for none, else one more than its place in the list), and the list.
pub fn structures(
    shape: &FieldShape,
    solid: &[u8],
    owners: &Owners,
    seed: u32,
) -> (Vec<u16>, Vec<Structure>) {
    let made = ManmadeColumns::new(shape, solid);
    let owned = owned(&made, owners);
    let mut of = vec![0u16; made.has.len()];
    let mut columns: BTreeMap<u16, Vec<usize>> = BTreeMap::new();
    for (c, owner) in owned.iter().enumerate().filter(|(_, owner)| **owner > 0) {
        columns.entry(*owner).or_default().push(c);
    }
    let mut all: Vec<Structure> = Vec::with_capacity(columns.len());
    for (owner, columns) in columns {
        let known = owners.all[usize::from(owner) - 1];
        let id = hash1(known.look, seed);
        all.push(match known.form {
            None => made.look(&columns, id),
            Some(form) => Structure {
                axis: form.axis,
                columns: form.columns,
                height_m: form.height_m,
                id,
                thin: form.columns as usize <= THIN,
                top: form.middle,
                known: true,
            },
        });
        columns.iter().for_each(|c| of[*c] = all.len() as u16);
    }
    let rest: Vec<usize> = (0..of.len()).filter(|c| made.has[*c] && of[*c] == 0).collect();
    let middles = middles(&made, &rest);
    let mut known: BTreeMap<usize, u16> = BTreeMap::new();
    for (c, middle) in rest.iter().zip(&middles) {
        if all.len() >= usize::from(u16::MAX) - 1 && !known.contains_key(middle) {
            continue;
        }
        of[*c] = *known.entry(*middle).or_insert_with(|| {
            let near = near(&made, &owned, *middle);
            all.push(made.look(&near, hash1(place_number(shape, *middle), seed)));
            all.len() as u16
        });
    }
    (of, all)
}

/// Owner of each column that has voxels: the thing that stands there, or a thing near by whose voxels are connected
/// with it.
fn owned(made: &ManmadeColumns<'_>, owners: &Owners) -> Vec<u16> {
    let mut owned = vec![0u16; made.has.len()];
    if owners.of.len() != owned.len() {
        return owned;
    }
    for (c, owner) in owned.iter_mut().enumerate().filter(|(c, _)| made.has[*c]) {
        *owner = owners.of[c];
    }
    // Posts are slim: voxels beside one belong to another thing.
    let spreads = |owner: u16| owner > 0 && owners.all[usize::from(owner) - 1].form.is_some();
    for _ in 0..RAGGED {
        let free = (0..owned.len()).filter(|c| made.has[*c] && owned[*c] == 0);
        let found = free.filter_map(|c| {
            let beside = made.around(c).map(|n| owned[n]).filter(|o| spreads(*o));
            Some((c, beside.min()?))
        });
        let found: Vec<(usize, u16)> = found.collect();
        found.into_iter().for_each(|(c, owner)| owned[c] = owner);
    }
    owned
}

/// For each of some columns the middle whose look it takes: the deepest of the columns that are connected with it
/// within [`REACH`]. On a tie a hash of the place decides.
fn middles(made: &ManmadeColumns<'_>, columns: &[usize]) -> Vec<usize> {
    let mut number = vec![u32::MAX; if columns.is_empty() { 0 } else { made.has.len() }];
    for (i, c) in columns.iter().enumerate() {
        number[*c] = i as u32;
    }
    let beside = |i: usize| made.around(columns[i]).map(|n| number[n]);
    let mut depth = vec![0u32; columns.len()];
    for round in 1..=DEEPEST {
        let deeper = |i: usize| {
            let all = beside(i).all(|n| n != u32::MAX && depth[n as usize] + 1 >= round);
            if all { round } else { depth[i] }
        };
        let next: Vec<u32> = (0..columns.len()).into_par_iter().map(deeper).collect();
        if next == depth {
            break;
        }
        depth = next;
    }
    let mut best: Vec<(u32, u32, usize)> = columns
        .iter()
        .zip(&depth)
        .map(|(c, depth)| (*depth, hash1(place_number(made.shape, *c), 77), *c))
        .collect();
    for _ in 0..REACH {
        let better = |i: usize| {
            let near = beside(i).filter(|n| *n != u32::MAX).map(|n| best[n as usize]);
            near.fold(best[i], |a, b| if (b.0, b.1) > (a.0, a.1) { b } else { a })
        };
        let next: Vec<(u32, u32, usize)> = (0..columns.len()).into_par_iter().map(better).collect();
        if next == best {
            break;
        }
        best = next;
    }
    best.into_iter().map(|(_, _, c)| c).collect()
}

/// The columns without an owner that are connected with a middle within [`AROUND`] of it.
fn near(made: &ManmadeColumns<'_>, owned: &[u16], middle: usize) -> Vec<usize> {
    let ny = made.shape.ny;
    let within =
        |c: usize| (c / ny).abs_diff(middle / ny) <= AROUND && (c % ny).abs_diff(middle % ny) <= AROUND;
    let mut seen = std::collections::BTreeSet::from([middle]);
    let mut open = vec![middle];
    while let Some(c) = open.pop() {
        for n in made.around(c) {
            if made.has[n] && owned[n] == 0 && within(n) && seen.insert(n) {
                open.push(n);
            }
        }
    }
    seen.into_iter().collect()
}

/// Number of a column of the field by its place in the ego frame, whatever the map.
fn place_number(shape: &FieldShape, column: usize) -> u32 {
    let from = shape.extent.from();
    let at = [column / shape.ny, column % shape.ny];
    let [x, y] = [0, 1].map(|i| at[i] as i64 + i64::from(from[i]) + 100);
    (x * 202 + y) as u32
}
