//! Closed meshes to voxels: a voxel is filled if its centre is inside, told by counting the faces above and below it.

use glam::{DVec2, DVec3};
use scene::{Extent, Window};

use crate::FormatError;

/// Most columns that the triangles of a mesh are looked for in, and most crossings that are kept: 256 MiB of them.
const MOST_VISITS: u64 = super::work::MOST_WORK;
const MOST_CROSSINGS: usize = 1 << 25;
/// Most crossings for each column of the map: a mesh of voxels has 16.
const MOST_PER_COLUMN: usize = 64;

/// Where the faces of a mesh cross the centre lines of a map's columns.
pub(crate) struct Solid {
    extent: Extent,
    crossings: Vec<Crossing>,
    visits: u64,
}

/// A face over or under the centre of a column.
struct Crossing {
    /// Twice the number of the column, and one more if the face looks up.
    column_and_top: u32,
    /// Height in voxels.
    z: f32,
}

impl Crossing {
    fn column(&self) -> u32 {
        self.column_and_top / 2
    }

    fn is_top(&self) -> bool {
        self.column_and_top % 2 == 1
    }
}

/// How far a face may be from the border of two voxels and still lie on it, in voxels.
const ON_BORDER: f32 = 1e-3;

impl Solid {
    /// A solid on a map, without triangles yet.
    pub(crate) fn new(extent: Extent) -> Self {
        Self {
            extent,
            crossings: Vec::new(),
            visits: 0,
        }
    }

    /// A triangle, m. Its columns are those whose centre it covers as seen from above; of two triangles with a common edge, one
    /// covers a centre on the edge.
    pub(crate) fn add(&mut self, corners: [DVec3; 3]) {
        let [a, b, c] = corners.map(|p| self.extent.to_voxel_units(p));
        let area = edge(a.truncate(), b.truncate(), c.truncate());
        if area == 0.0 || !area.is_finite() {
            return;
        }
        let Some([(x0, x1), (y0, y1)]) = around(self.extent, [a, b, c]) else {
            return;
        };
        self.visits = self.visits.saturating_add(((x1 - x0 + 1) * (y1 - y0 + 1)) as u64);
        if self.is_too_much() {
            return;
        }
        let corners = [a.truncate(), b.truncate(), c.truncate()];
        for x in x0..=x1 {
            for y in y0..=y1 {
                let p = DVec2::new(x as f64 + 0.5, y as f64 + 0.5);
                if !covers(corners, area > 0.0, p) {
                    continue;
                }
                let share = |u: DVec2, v: DVec2| edge(u, v, p) / area;
                let (wa, wb) = (share(corners[1], corners[2]), share(corners[2], corners[0]));
                let z = c.z + wa * (a.z - c.z) + wb * (b.z - c.z);
                self.crossings.push(Crossing {
                    column_and_top: 2 * self.extent.index(x, y) as u32 + u32::from(area > 0.0),
                    z: z as f32,
                });
            }
        }
    }

    /// The columns that [`add`](Self::add) will look at for a triangle, m, told without doing it.
    pub(crate) fn cost(extent: Extent, corners: [DVec3; 3]) -> u64 {
        let columns = around(extent, corners.map(|p| extent.to_voxel_units(p)));
        columns.map_or(0, |[(x0, x1), (y0, y1)]| ((x1 - x0 + 1) * (y1 - y0 + 1)) as u64)
    }

    fn is_too_much(&self) -> bool {
        let most = (self.extent.columns() * MOST_PER_COLUMN).min(MOST_CROSSINGS);
        self.visits > MOST_VISITS || self.crossings.len() > most
    }

    /// Visits the voxels inside. Where the faces of a column do not pair up, because the mesh is open there, the voxels right
    /// behind the faces are visited. Errors where the mesh has more faces over one another than any of voxels.
    pub(crate) fn fill(mut self, mut visit: impl FnMut([usize; 3])) -> Result<(), FormatError> {
        if self.is_too_much() {
            return Err(FormatError::new(format!(
                "{} faces over one another, expected at most {MOST_PER_COLUMN} in each column of the map",
                self.crossings.len()
            )));
        }
        let order = |a: &Crossing, b: &Crossing| a.column().cmp(&b.column()).then(a.z.total_cmp(&b.z));
        self.crossings.sort_unstable_by(order);
        for column in self.crossings.chunk_by(|a, b| a.column() == b.column()) {
            let [x, y] = self.extent.column(column[0].column() as usize);
            if column.len() % 2 == 0 {
                for pair in column.chunks_exact(2) {
                    let above = |c: &Crossing| (c.z - 0.5).ceil().clamp(0.0, Window::NZ as f32) as usize;
                    (above(&pair[0])..above(&pair[1])).for_each(|z| visit([x, y, z]));
                }
            } else {
                for face in column {
                    let z = match face.is_top() {
                        true => (face.z - ON_BORDER).floor(),
                        false => (face.z + ON_BORDER).floor(),
                    };
                    if (0.0..Window::NZ as f32).contains(&z) {
                        visit([x, y, z as usize]);
                    }
                }
            }
        }
        Ok(())
    }
}

/// First and last column along x and y whose centre the rectangle around a triangle covers, all in voxels.
fn around(extent: Extent, [a, b, c]: [DVec3; 3]) -> Option<[(usize, usize); 2]> {
    let (low, high) = (a.min(b).min(c), a.max(b).max(c));
    let range = |axis: usize, n: usize| {
        // Centres are at halves.
        let from = (low[axis] - 0.5).ceil().max(0.0);
        let to = (high[axis] - 0.5).floor().min(n as f64 - 1.0);
        (from <= to).then_some((from as usize, to as usize))
    };
    Some([range(0, extent.nx())?, range(1, extent.ny())?])
}

/// Twice the signed area of a triangle.
fn edge(a: DVec2, b: DVec2, p: DVec2) -> f64 {
    (b - a).perp_dot(p - a)
}

/// True if a triangle covers a point. An edge is computed in one direction whichever triangle it belongs to, so that exactly
/// one of two neighbours covers a point on it or beside it by a rounding error.
fn covers(corners: [DVec2; 3], counter_clockwise: bool, p: DVec2) -> bool {
    (0..3).all(|i| {
        let (a, b) = (corners[i], corners[(i + 1) % 3]);
        let swapped = (b.x, b.y) < (a.x, a.y);
        let (low, high) = if swapped { (b, a) } else { (a, b) };
        // Points on the line count as on its left.
        let left_of_line = edge(low, high, p) >= 0.0;
        left_of_line == (counter_clockwise != swapped)
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::glb::mesh::meshes;
    use scene::Class;

    fn triangles(of: &crate::glb::mesh::Mesh) -> Vec<[DVec3; 3]> {
        let at = |i: u32| glam::Vec3::from_array(of.positions[i as usize]).as_dvec3();
        let each = of.indices.chunks_exact(3);
        each.map(|t| [at(t[0]), at(t[1]), at(t[2])]).collect()
    }

    #[test]
    fn voxels_come_back_from_their_own_mesh() {
        let extent = Extent::new([-20, 7], [40, 30]).expect("sound");
        let mut state = 3u64;
        let mut dice = || {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
            (state >> 33) as usize
        };
        let columns: Vec<[u8; Window::NZ]> = (0..extent.columns())
            .map(|_| [(); Window::NZ].map(|()| [Class::FREE, 4, 4, 9][dice() % 4]))
            .collect();
        let of = meshes(
            [40, 30],
            |x, y| columns[extent.index(x, y)],
            |p| extent.from_voxel_units(p),
        );
        let mut found = vec![[Class::FREE; Window::NZ]; extent.columns()];
        for (label, mesh) in &of {
            let mut solid = Solid::new(extent);
            triangles(mesh).into_iter().for_each(|t| solid.add(t));
            let filled = solid.fill(|[x, y, z]| found[extent.index(x, y)][z] = *label);
            filled.expect("few faces");
        }
        assert_eq!(found, columns);
    }

    #[test]
    fn a_turned_block_has_the_voxels_whose_centres_are_inside() {
        let extent = Extent::WINDOW;
        let block = &meshes([10, 4], |_, _| [5; Window::NZ], |p| p / 2.5)[&5];
        let turn = glam::DQuat::from_euler(glam::EulerRot::ZYX, 0.4, -0.3, 0.2);
        let (shift, size) = (DVec3::new(3.03, -4.41, -0.6), DVec3::new(4.0, 1.6, 6.4));
        let mut solid = Solid::new(extent);
        let place = |p: DVec3| turn * p + shift;
        triangles(block).into_iter().for_each(|t| solid.add(t.map(place)));
        let mut found = std::collections::BTreeSet::new();
        let filled = solid.fill(|voxel| assert!(found.insert(voxel), "twice"));
        filled.expect("few faces");
        let inside = |[x, y, z]: [usize; 3]| {
            let local = turn.inverse() * (extent.center(x, y, z) - shift);
            local.cmpge(DVec3::ZERO).all() && local.cmple(size).all()
        };
        let all = extent
            .all_columns()
            .flat_map(|[x, y]| (0..Window::NZ).map(move |z| [x, y, z]));
        let expected: std::collections::BTreeSet<_> = all.filter(|v| inside(*v)).collect();
        assert!(expected.len() > 300, "{}", expected.len());
        assert_eq!(found, expected);
    }

    #[test]
    fn an_open_mesh_is_its_surface() {
        let mut solid = Solid::new(Extent::WINDOW);
        let corner = |x: f64, y: f64| DVec3::new(x, y, 1.1);
        solid.add([corner(0.0, 0.0), corner(2.0, 0.0), corner(0.0, 2.0)]);
        let mut found = Vec::new();
        solid.fill(|voxel| found.push(voxel)).expect("few faces");
        assert!(found.len() > 8 && found.iter().all(|v| v[2] == 5), "{found:?}");
        // A triangle with infinite corners adds nothing and takes no time.
        let mut solid = Solid::new(Extent::WINDOW);
        solid.add([
            corner(f64::INFINITY, 0.0),
            corner(2.0, f64::NAN),
            corner(0.0, 2.0),
        ]);
        solid.fill(|_| panic!("nothing")).expect("no faces");
    }

    #[test]
    fn a_pile_of_triangles_is_refused() {
        let mut solid = Solid::new(Extent::WINDOW);
        let corner = |x: f64, y: f64| DVec3::new(x, y, 1.1);
        for _ in 0..2000 {
            solid.add([corner(-200.0, -90.0), corner(200.0, -90.0), corner(0.0, 200.0)]);
        }
        let line = solid.fill(|_| ()).expect_err("2000 over one another").to_string();
        assert!(line.contains("expected at most 64 in each column"), "{line}");
    }
}
