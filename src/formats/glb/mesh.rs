//! Voxels to meshes: the faces that lie between a voxel and another class, merged to rectangles (greedy meshing).
//!
//! A face between two voxels of one mesh is left out. Every other face is there, also where it touches another mesh, so
//! each mesh is a closed surface by itself. The voxels in it can be told from it again after it was moved.

use std::collections::{BTreeMap, HashMap};

use glam::DVec3;
use scene::{Class, Window};

/// A mesh of triangles with shared corners, counter-clockwise as seen from outside.
#[derive(Debug, Default, PartialEq)]
pub(crate) struct Mesh {
    /// Corners, m.
    pub(crate) positions: Vec<[f32; 3]>,
    /// Three for each triangle.
    pub(crate) indices: Vec<u32>,
}

/// A rectangle of faces, in corners of voxels.
#[derive(Clone, Copy)]
struct FaceRectangle {
    /// Axis that it is upright to.
    axis: usize,
    /// True if it looks along that axis, false if against it.
    outward: bool,
    /// Where on that axis.
    at: u32,
    /// Corners on the two axes that follow.
    from: [u32; 2],
    to: [u32; 2],
}

/// One mesh for each label in a grid of `columns` (16 labels, lowest first), [`Class::FREE`] where there is nothing. `place`
/// takes corners of voxels to metres.
pub(crate) fn meshes(
    size: [usize; 2],
    column: impl Fn(usize, usize) -> [u8; Window::NZ],
    place: impl Fn(DVec3) -> DVec3,
) -> BTreeMap<u8, Mesh> {
    let mut builders: BTreeMap<u8, QuadMeshBuilder> = BTreeMap::new();
    let mut take = |label: u8, rectangle: FaceRectangle| builders.entry(label).or_default().add(&rectangle);
    let shape = [size[0], size[1], Window::NZ];
    for axis in 0..3 {
        let [a, b] = [(axis + 1) % 3, (axis + 2) % 3];
        let n = [shape[a], shape[b]];
        let (mut below, mut above) = (vec![Class::FREE; n[0] * n[1]], vec![Class::FREE; n[0] * n[1]]);
        for at in 0..=shape[axis] {
            std::mem::swap(&mut below, &mut above);
            slice(&mut above, shape, axis, at, &column);
            for outward in [true, false] {
                let (inside, outside) = if outward {
                    (&below, &above)
                } else {
                    (&above, &below)
                };
                let faces = inside.iter().zip(outside);
                let mask = faces
                    .map(|(i, o)| if i == o { Class::FREE } else { *i })
                    .collect();
                merge(mask, n, |label, from, to| {
                    take(
                        label,
                        FaceRectangle {
                            axis,
                            outward,
                            at: at as u32,
                            from,
                            to,
                        },
                    );
                });
            }
        }
    }
    let placed = |builder: QuadMeshBuilder| builder.finish(&place);
    builders
        .into_iter()
        .map(|(label, b)| (label, placed(b)))
        .collect()
}

/// The labels of a layer of voxels upright to an axis, in the order of the two axes that follow; free beyond the grid.
fn slice(
    out: &mut [u8],
    shape: [usize; 3],
    axis: usize,
    at: usize,
    column: &impl Fn(usize, usize) -> [u8; Window::NZ],
) {
    if at >= shape[axis] {
        out.fill(Class::FREE);
        return;
    }
    match axis {
        // y, z
        0 => {
            for y in 0..shape[1] {
                out[y * Window::NZ..(y + 1) * Window::NZ].copy_from_slice(&column(at, y));
            }
        }
        // z, x
        1 => {
            for x in 0..shape[0] {
                for (z, label) in column(x, at).into_iter().enumerate() {
                    out[z * shape[0] + x] = label;
                }
            }
        }
        // x, y
        _ => {
            for x in 0..shape[0] {
                for y in 0..shape[1] {
                    out[x * shape[1] + y] = column(x, y)[at];
                }
            }
        }
    }
}

/// Visits rectangles that cover every cell of a mask that is not free, each cell once: as long as they can be, then as wide.
fn merge(mut mask: Vec<u8>, n: [usize; 2], mut visit: impl FnMut(u8, [u32; 2], [u32; 2])) {
    let mut next = 0;
    while let Some(found) = mask[next..].iter().position(|label| *label != Class::FREE) {
        let start = next + found;
        let (a, b) = (start / n[1], start % n[1]);
        let label = mask[start];
        let row = &mask[a * n[1]..(a + 1) * n[1]];
        let to_b = b + row[b..].iter().take_while(|l| **l == label).count();
        let full = |mask: &[u8], a: usize| mask[a * n[1] + b..a * n[1] + to_b].iter().all(|l| *l == label);
        let mut to_a = a + 1;
        while to_a < n[0] && full(&mask, to_a) {
            to_a += 1;
        }
        for row in a..to_a {
            mask[row * n[1] + b..row * n[1] + to_b].fill(Class::FREE);
        }
        visit(label, [a, b].map(|v| v as u32), [to_a, to_b].map(|v| v as u32));
        next = a * n[1] + to_b;
    }
}

/// Collects rectangles; corners at the same place become one.
#[derive(Default)]
struct QuadMeshBuilder {
    corners: Vec<[u32; 3]>,
    places: HashMap<[u32; 3], u32>, // looked up alone: its order is never seen
    indices: Vec<u32>,
}

impl QuadMeshBuilder {
    fn add(&mut self, r: &FaceRectangle) {
        let around = [
            [r.from[0], r.from[1]],
            [r.to[0], r.from[1]],
            [r.to[0], r.to[1]],
            [r.from[0], r.to[1]],
        ];
        let mut quad = around.map(|uv| {
            let mut corner = [0; 3];
            corner[r.axis] = r.at;
            corner[(r.axis + 1) % 3] = uv[0];
            corner[(r.axis + 2) % 3] = uv[1];
            self.corner(corner)
        });
        if !r.outward {
            quad.reverse();
        }
        let [a, b, c, d] = quad;
        self.indices.extend([a, b, c, a, c, d]);
    }

    fn corner(&mut self, at: [u32; 3]) -> u32 {
        let corners = &mut self.corners;
        *self.places.entry(at).or_insert_with(|| {
            corners.push(at);
            corners.len() as u32 - 1
        })
    }

    fn finish(self, place: &impl Fn(DVec3) -> DVec3) -> Mesh {
        let placed = |c: &[u32; 3]| place(DVec3::from_array(c.map(f64::from))).as_vec3().to_array();
        Mesh {
            positions: self.corners.iter().map(placed).collect(),
            indices: self.indices,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const NONE: [u8; Window::NZ] = [Class::FREE; Window::NZ];

    fn column(labels: &[(usize, u8)]) -> [u8; Window::NZ] {
        let mut column = NONE;
        labels.iter().for_each(|(z, label)| column[*z] = *label);
        column
    }

    /// Signed volume by the divergence theorem: that of the voxels if every face is there once and looks outward.
    fn volume(mesh: &Mesh) -> f64 {
        let at = |i: u32| glam::Vec3::from_array(mesh.positions[i as usize]).as_dvec3();
        let triangles = mesh.indices.chunks_exact(3);
        triangles
            .map(|t| at(t[0]).dot(at(t[1]).cross(at(t[2]))) / 6.0)
            .sum()
    }

    #[test]
    fn a_slab_is_six_rectangles_and_a_step_has_its_volume() {
        let slab = meshes([30, 20], |_, _| column(&[(3, 7)]), |p| p);
        let mesh = &slab[&7];
        assert_eq!((slab.len(), mesh.positions.len(), mesh.indices.len()), (1, 8, 36));
        assert!((volume(mesh) - 600.0).abs() < 1e-9);
        // Two classes that touch: both are closed.
        let both = meshes([2, 1], |x, _| column(&[(0, 1 + x as u8), (1, 1)]), |p| p);
        assert_eq!(volume(&both[&1]).round(), 3.0);
        assert_eq!(volume(&both[&2]).round(), 1.0);
        assert_eq!(both[&2].indices.len(), 36);
        assert!(meshes([5, 5], |_, _| NONE, |p| p).is_empty());
    }

    #[test]
    fn volume_is_that_of_the_voxels_whatever_their_shape() {
        let mut state = 7u64;
        let mut dice = || {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
            (state >> 40) as u8
        };
        let columns: Vec<[u8; Window::NZ]> = (0..12 * 9)
            .map(|_| [(); Window::NZ].map(|()| [Class::FREE, 1, 2][usize::from(dice() % 3)]))
            .collect();
        let found = meshes([12, 9], |x, y| columns[x * 9 + y], |p| p / 2.0);
        for label in [1, 2] {
            let count = columns.iter().flatten().filter(|l| **l == label).count();
            assert!(
                (volume(&found[&label]) * 8.0 - count as f64).abs() < 1e-3,
                "label {label}"
            );
        }
    }
}
