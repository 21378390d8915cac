//! Voxels of a moving object: made once, at one pose, and stamped at any other. The nearest voxel is taken, so nothing
//! is blurred; at the pose where they were made, the result is the same shape exactly.

use std::sync::Arc;

use crate::grid::NOT_PAINTED;
use crate::raster::box_cells;
use crate::{Class, Extent, Lattice, SceneBox, VoxelGrid, VoxelPaint, draft};

/// How far voxels of an object may reach beyond its box, m: the corner of one voxel.
pub const MARGIN_M: f64 = 0.6;

/// Labels of an object's columns, where it stood when they were made.
#[derive(Clone, Debug, PartialEq)]
pub struct ObjectVoxels {
    /// Lattice that the voxels are of.
    pub lattice: Lattice,
    /// Column at the lower corner, counted from the world frame's origin.
    pub from: [i32; 2],
    /// Columns along x and y.
    pub size: [usize; 2],
    /// `[x][y][z]`, all bins of the lattice, lowest first; free where the object is not.
    pub labels: Vec<u8>,
}

/// Voxels of an object, and its box at which they were made.
#[derive(Clone, Debug, PartialEq)]
pub struct OwnShape {
    /// The box.
    pub made: SceneBox,
    /// The voxels.
    pub voxels: Arc<ObjectVoxels>,
}

impl OwnShape {
    /// The voxels as [`ObjectVoxels::of_cells`] takes them.
    pub fn cells(&self) -> Vec<[i32; 3]> {
        self.voxels.cells(&self.made)
    }

    /// Height above the box's underside at which the underside of the cells of height 0 is stamped with the box at
    /// `now`, m.
    pub fn bottom_m(&self, now: &SceneBox) -> f64 {
        let lattice = self.voxels.lattice;
        let bin = i64::from(bottom_bin(lattice, &self.made)) + up(lattice, &self.made, now);
        bin as f64 * self.voxels.lattice.voxel_m() + self.voxels.lattice.bottom_m()
            - (now.center_m.z - now.size_m.z / 2.0)
    }
}

impl ObjectVoxels {
    /// Columns of a shape at most: a square of 102 m of 0.4 m voxels.
    pub const MAX_COLUMNS: usize = 1 << 16;

    /// A shape without voxels.
    pub fn empty() -> Arc<Self> {
        Arc::new(Self {
            lattice: Lattice::OCC3D,
            from: [0; 2],
            size: [0; 2],
            labels: Vec::new(),
        })
    }

    /// The draft of an object's voxels where it was made, whether that is on a map or not. Empty for one that is too large.
    pub fn drafted(lattice: Lattice, made: &SceneBox) -> Arc<Self> {
        let reach = made.size_m.truncate().length() / 2.0 + lattice.voxel_m();
        let column = |metres: f64| (metres * lattice.per_m()).floor() as i32;
        let from = [column(made.center_m.x - reach), column(made.center_m.y - reach)];
        let side = (2.0 * reach * lattice.per_m()).ceil() as usize + 1;
        let fits = side * side <= Self::MAX_COLUMNS;
        let Some(extent) = Extent::over(lattice, from, [side; 2]).ok().filter(|_| fits) else {
            return Self::empty();
        };
        let mut grid = VoxelGrid::over(extent);
        draft::stamp_box(&mut grid, made);
        Self::cut(&grid, made, |_, label| label != Class::FREE)
    }

    /// The shape of an object that is made of these voxels of its class: `[ahead, left, up]` from the middle of its box seen
    /// from above and from its underside. With it the box at which it is made, in the same place and turned to heading 0.
    /// What is beyond the heights of a grid is left out. Errors in one line for none and for one that is not on the box.
    pub fn of_cells(
        lattice: Lattice,
        b: &SceneBox,
        cells: &[[i32; 3]],
    ) -> Result<(SceneBox, Arc<Self>), String> {
        let made = upright(lattice, b);
        let middle = (made.center_m.truncate() * lattice.per_m()).round().as_ivec2();
        let bottom = bottom_bin(lattice, &made);
        let reach = reach(lattice, b);
        let size = (2 * reach).as_uvec2().to_array().map(|n| n as usize);
        let up_to = (b.size_m.z * lattice.per_m()).ceil() as i32 + 2;
        let nz = lattice.bins();
        if size[0].checked_mul(size[1]).is_none_or(|n| n > Self::MAX_COLUMNS) {
            let [length, width, _] = b.size_m.to_array();
            return Err(format!(
                "a box of {length} x {width} m is too large for a shape of its own"
            ));
        }
        let mut labels = vec![Class::FREE; size[0] * size[1] * nz];
        for cell @ &[ahead, left, up] in cells {
            let within = |v: i32, reach: i32| (-reach..reach).contains(&v);
            if !within(ahead, reach.x) || !within(left, reach.y) || !(-3..=up_to).contains(&up) {
                let [x, y] = reach.to_array();
                return Err(format!(
                    "cell {cell:?} is not on the box, expected {} to {}, {} to {}, -3 to {up_to}",
                    -x,
                    x - 1,
                    -y,
                    y - 1
                ));
            }
            let [i, j] = [ahead + reach.x, left + reach.y].map(|v| v as usize);
            if let Some(z) = usize::try_from(up + bottom).ok().filter(|z| *z < nz) {
                labels[(i * size[1] + j) * nz + z] = b.class.id();
            }
        }
        if labels.iter().all(|label| *label == Class::FREE) {
            return Err("the shape has no voxel within the heights of the grid".into());
        }
        let from = (middle - reach).to_array();
        let shape = Self {
            lattice,
            from,
            size,
            labels,
        };
        Ok((made, Arc::new(shape)))
    }

    /// The voxels as [`of_cells`](Self::of_cells) takes them, of an object that was made with its box at `made`.
    pub fn cells(&self, made: &SceneBox) -> Vec<[i32; 3]> {
        let lattice = self.lattice;
        let now = upright(lattice, made);
        let middle = (now.center_m.truncate() * lattice.per_m()).round().as_ivec2();
        let reach = reach(lattice, made);
        let from = middle - reach;
        let size = (2 * reach).as_uvec2();
        let Ok(extent) = Extent::over(lattice, from.to_array(), [size.x as usize, size.y as usize]) else {
            return Vec::new();
        };
        let bottom = bottom_bin(lattice, &now);
        let mut out = Vec::new();
        self.visit(extent, made, &now, |[x, y, z], _| {
            out.push([x as i32 - reach.x, y as i32 - reach.y, z as i32 - bottom]);
        });
        out.sort_unstable();
        out
    }

    /// Number of voxels.
    pub fn count(&self) -> usize {
        self.labels.iter().filter(|l| **l != Class::FREE).count()
    }

    /// Labels of a column of the shape, lowest first. Panics outside it.
    pub fn column(&self, x: usize, y: usize) -> &[u8] {
        let nz = self.lattice.bins();
        &self.labels[(x * self.size[1] + y) * nz..][..nz]
    }

    /// The voxels of a grid that belong to a box: labels within its footprint and margin for which `own` is true.
    pub fn cut(grid: &VoxelGrid, b: &SceneBox, own: impl Fn([usize; 3], u8) -> bool) -> Arc<Self> {
        let extent = grid.extent();
        let mut found = Vec::new();
        box_cells(extent, b, MARGIN_M, |x, y| {
            let mut column = grid.column(x, y).to_vec();
            for (z, label) in column.iter_mut().enumerate() {
                if !own([x, y, z], *label) {
                    *label = Class::FREE;
                }
            }
            if column.iter().any(|label| *label != Class::FREE) {
                found.push(([x, y], column));
            }
        });
        let Some(low) = corner(&found, usize::min) else {
            return Self::empty();
        };
        let high = corner(&found, usize::max).unwrap_or(low);
        let size = [high[0] + 1 - low[0], high[1] + 1 - low[1]];
        let nz = extent.nz();
        let mut labels = vec![Class::FREE; size[0] * size[1] * nz];
        for ([x, y], column) in found {
            labels[((x - low[0]) * size[1] + y - low[1]) * nz..][..nz].copy_from_slice(&column);
        }
        let from = extent.from();
        Arc::new(Self {
            lattice: extent.lattice(),
            from: [from[0] + low[0] as i32, from[1] + low[1] as i32],
            size,
            labels,
        })
    }

    /// Visits the voxels that the shape has on a map of its lattice with its box at `now`; it was made with its box at
    /// `made`.
    pub fn visit(
        &self,
        extent: Extent,
        made: &SceneBox,
        now: &SceneBox,
        mut visit: impl FnMut([usize; 3], u8),
    ) {
        // The heading alone turns: cos and sin once, not for every column.
        let turn = glam::DVec2::from_angle(made.yaw_rad - now.yaw_rad);
        let same_heading = made.yaw_rad == now.yaw_rad;
        let lattice = self.lattice;
        let up = up(lattice, made, now);
        box_cells(extent, now, MARGIN_M, |x, y| {
            let p = extent.center(x, y, 0).truncate();
            let from_center = p - now.center_m.truncate();
            let turned = match same_heading {
                true => from_center,
                false => turn.rotate(from_center),
            };
            // Shifted slightly to one side: a half voxel between both poses must round the same way in every column.
            let p_made = (made.center_m.truncate() + turned) * lattice.per_m() + 1e-6;
            let (i, j) = (
                p_made.x.floor() - f64::from(self.from[0]),
                p_made.y.floor() - f64::from(self.from[1]),
            );
            // Written so that NaN fails too.
            if !(i >= 0.0 && j >= 0.0 && i < self.size[0] as f64 && j < self.size[1] as f64) {
                return;
            }
            let column = self.column(i as usize, j as usize);
            for (z, label) in column.iter().enumerate().filter(|(_, l)| **l != Class::FREE) {
                let z = z as i64 + up;
                if (0..extent.nz() as i64).contains(&z) {
                    visit([x, y, z as usize], *label);
                }
            }
        });
    }

    /// Puts the shape into a grid; painted voxels stay.
    pub fn stamp(&self, grid: &mut VoxelGrid, painted: &VoxelPaint, made: &SceneBox, now: &SceneBox) {
        self.visit(grid.extent(), made, now, |[x, y, z], label| {
            if painted.get(x, y, z) == NOT_PAINTED {
                grid.set(x, y, z, label);
            }
        });
    }

    /// The first problem with it, in one line; `None` if it is sound.
    pub fn problem(&self) -> Option<String> {
        let [nx, ny] = self.size;
        let columns = nx.checked_mul(ny).filter(|n| *n <= Self::MAX_COLUMNS);
        if columns.is_none_or(|n| self.labels.len() != n * self.lattice.bins()) {
            return Some(format!(
                "a shape of {nx} x {ny} columns that holds {} labels, expected at most {} columns of {}",
                self.labels.len(),
                Self::MAX_COLUMNS,
                self.lattice
            ));
        }
        let wrong = self.labels.iter().copied().find(|l| Class::from_id(*l).is_none());
        wrong.map(|label| format!("a shape holds label {label}, expected 0 to 17"))
    }
}

/// Number of bins by which a shape is lifted from where it was made.
fn up(lattice: Lattice, made: &SceneBox, now: &SceneBox) -> i64 {
    ((now.center_m.z - made.center_m.z) * lattice.per_m()).round() as i64
}

/// The box with heading 0, its middle moved by less than a voxel to where four columns meet.
pub fn upright(lattice: Lattice, b: &SceneBox) -> SceneBox {
    let middle = (b.center_m.truncate() * lattice.per_m()).round() / lattice.per_m();
    SceneBox {
        center_m: middle.extend(b.center_m.z),
        yaw_rad: 0.0,
        ..*b
    }
}

/// Number of columns that a box and its margin reach ahead of its middle, and to its left.
fn reach(lattice: Lattice, b: &SceneBox) -> glam::IVec2 {
    ((b.size_m.truncate() / 2.0 + MARGIN_M) * lattice.per_m())
        .ceil()
        .as_ivec2()
}

/// The bin that a box's underside is in.
fn bottom_bin(lattice: Lattice, b: &SceneBox) -> i32 {
    let bottom_m = b.center_m.z - b.size_m.z / 2.0;
    // Shifted slightly up: an underside on the border of two bins is in the upper one.
    ((bottom_m - lattice.bottom_m()) * lattice.per_m() + 1e-6).floor() as i32
}

fn corner(found: &[([usize; 2], Vec<u8>)], of: fn(usize, usize) -> usize) -> Option<[usize; 2]> {
    let all = found.iter().map(|(at, _)| *at);
    all.reduce(|a, b| [of(a[0], b[0]), of(a[1], b[1])])
}
