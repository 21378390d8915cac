//! Voxels of a moving object: made once, at one pose, and stamped at any other. The nearest voxel is taken, so nothing
//! is blurred; at the pose where they were made, the result is the same shape exactly.

use std::sync::Arc;

use crate::grid::NOT_PAINTED;
use crate::raster::box_cells;
use crate::{Class, Extent, SceneBox, VoxelGrid, VoxelPaint, draft};

/// How far voxels of an object may reach beyond its box, m: the corner of one voxel.
pub const MARGIN_M: f64 = 0.6;

/// Labels of an object's columns, where it stood when they were made.
#[derive(Clone, Debug, PartialEq)]
pub struct ObjectVoxels {
    /// Column at the lower corner, counted from the world frame's origin.
    pub from: [i32; 2],
    /// Columns along x and y.
    pub size: [usize; 2],
    /// `[x][y]`, 16 labels each, lowest first; free where the object is not.
    pub columns: Vec<[u8; Extent::NZ]>,
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
        let bin = i64::from(bottom_bin(&self.made)) + up(&self.made, now);
        bin as f64 * Extent::VOXEL_M + Extent::BOTTOM_M - (now.center_m.z - now.size_m.z / 2.0)
    }
}

impl ObjectVoxels {
    /// Columns of a shape at most: a square of 102 m.
    pub const MAX_COLUMNS: usize = 1 << 16;

    /// A shape without voxels.
    pub fn empty() -> Arc<Self> {
        Arc::new(Self {
            from: [0; 2],
            size: [0; 2],
            columns: Vec::new(),
        })
    }

    /// The draft of an object's voxels where it was made, whether that is on a map or not. Empty for one that is too large.
    pub fn drafted(made: &SceneBox) -> Arc<Self> {
        let reach = made.size_m.truncate().length() / 2.0 + Extent::VOXEL_M;
        let column = |metres: f64| (metres * 2.5).floor() as i32;
        let from = [column(made.center_m.x - reach), column(made.center_m.y - reach)];
        let side = (2.0 * reach * 2.5).ceil() as usize + 1;
        let fits = side * side <= Self::MAX_COLUMNS;
        let Some(extent) = Extent::new(from, [side; 2]).ok().filter(|_| fits) else {
            return Self::empty();
        };
        let mut grid = VoxelGrid::over(extent);
        draft::stamp_box(&mut grid, made);
        Self::cut(&grid, made, |_, label| label != Class::FREE)
    }

    /// The shape of an object that is made of these voxels of its class: `[ahead, left, up]` from the middle of its box seen
    /// from above and from its underside. With it the box at which it is made, in the same place and turned to heading 0.
    /// What is beyond the heights of a grid is left out. Errors in one line for none and for one that is not on the box.
    pub fn of_cells(b: &SceneBox, cells: &[[i32; 3]]) -> Result<(SceneBox, Arc<Self>), String> {
        let made = upright(b);
        let middle = (made.center_m.truncate() * 2.5).round().as_ivec2();
        let bottom = bottom_bin(&made);
        let reach = reach(b);
        let size = (2 * reach).as_uvec2().to_array().map(|n| n as usize);
        let up_to = (b.size_m.z * 2.5).ceil() as i32 + 2;
        if size[0].checked_mul(size[1]).is_none_or(|n| n > Self::MAX_COLUMNS) {
            let [length, width, _] = b.size_m.to_array();
            return Err(format!(
                "a box of {length} x {width} m is too large for a shape of its own"
            ));
        }
        let mut columns = vec![[Class::FREE; Extent::NZ]; size[0] * size[1]];
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
            if let Some(z) = usize::try_from(up + bottom).ok().filter(|z| *z < Extent::NZ) {
                columns[i * size[1] + j][z] = b.class.id();
            }
        }
        if columns.iter().flatten().all(|label| *label == Class::FREE) {
            return Err("the shape has no voxel within the heights of the grid".into());
        }
        let from = (middle - reach).to_array();
        Ok((made, Arc::new(Self { from, size, columns })))
    }

    /// The voxels as [`of_cells`](Self::of_cells) takes them, of an object that was made with its box at `made`.
    pub fn cells(&self, made: &SceneBox) -> Vec<[i32; 3]> {
        let now = upright(made);
        let middle = (now.center_m.truncate() * 2.5).round().as_ivec2();
        let reach = reach(made);
        let from = middle - reach;
        let size = (2 * reach).as_uvec2();
        let Ok(extent) = Extent::new(from.to_array(), [size.x as usize, size.y as usize]) else {
            return Vec::new();
        };
        let bottom = bottom_bin(&now);
        let mut out = Vec::new();
        self.visit(extent, made, &now, |[x, y, z], _| {
            out.push([x as i32 - reach.x, y as i32 - reach.y, z as i32 - bottom]);
        });
        out.sort_unstable();
        out
    }

    /// Number of voxels.
    pub fn count(&self) -> usize {
        let set = |column: &[u8; Extent::NZ]| column.iter().filter(|l| **l != Class::FREE).count();
        self.columns.iter().map(set).sum()
    }

    /// The voxels of a grid that belong to a box: labels within its footprint and margin for which `own` is true.
    pub fn cut(grid: &VoxelGrid, b: &SceneBox, own: impl Fn([usize; 3], u8) -> bool) -> Arc<Self> {
        let extent = grid.extent();
        let mut found = Vec::new();
        box_cells(extent, b, MARGIN_M, |x, y| {
            let mut column = *grid.column(x, y);
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
        let mut columns = vec![[Class::FREE; Extent::NZ]; size[0] * size[1]];
        for ([x, y], column) in found {
            columns[(x - low[0]) * size[1] + y - low[1]] = column;
        }
        let from = extent.from();
        Arc::new(Self {
            from: [from[0] + low[0] as i32, from[1] + low[1] as i32],
            size,
            columns,
        })
    }

    /// Visits the voxels that the shape has on a map with its box at `now`; it was made with its box at `made`.
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
        let up = up(made, now);
        box_cells(extent, now, MARGIN_M, |x, y| {
            let p = extent.center(x, y, 0).truncate();
            let from_center = p - now.center_m.truncate();
            let turned = match same_heading {
                true => from_center,
                false => turn.rotate(from_center),
            };
            // Shifted slightly to one side: a half voxel between both poses must round the same way in every column.
            let p_made = (made.center_m.truncate() + turned) * 2.5 + 1e-6;
            let (i, j) = (
                p_made.x.floor() - f64::from(self.from[0]),
                p_made.y.floor() - f64::from(self.from[1]),
            );
            // Written so that NaN fails too.
            if !(i >= 0.0 && j >= 0.0 && i < self.size[0] as f64 && j < self.size[1] as f64) {
                return;
            }
            let column = &self.columns[i as usize * self.size[1] + j as usize];
            for (z, label) in column.iter().enumerate().filter(|(_, l)| **l != Class::FREE) {
                let z = z as i64 + up;
                if (0..Extent::NZ as i64).contains(&z) {
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
        if nx.checked_mul(ny).is_none_or(|n| n > Self::MAX_COLUMNS) || self.columns.len() != nx * ny {
            return Some(format!(
                "a shape of {nx} x {ny} columns that holds {}, expected at most {}",
                self.columns.len(),
                Self::MAX_COLUMNS
            ));
        }
        let labels = self.columns.iter().flatten();
        let wrong = labels.copied().find(|l| Class::from_id(*l).is_none());
        wrong.map(|label| format!("a shape holds label {label}, expected 0 to 17"))
    }
}

/// Number of bins by which a shape is lifted from where it was made.
fn up(made: &SceneBox, now: &SceneBox) -> i64 {
    ((now.center_m.z - made.center_m.z) * 2.5).round() as i64
}

/// The box with heading 0, its middle moved by less than a voxel to where four columns meet.
pub fn upright(b: &SceneBox) -> SceneBox {
    let middle = (b.center_m.truncate() * 2.5).round() / 2.5;
    SceneBox {
        center_m: middle.extend(b.center_m.z),
        yaw_rad: 0.0,
        ..*b
    }
}

/// Number of columns that a box and its margin reach ahead of its middle, and to its left.
fn reach(b: &SceneBox) -> glam::IVec2 {
    ((b.size_m.truncate() / 2.0 + MARGIN_M) * 2.5).ceil().as_ivec2()
}

/// The bin that a box's underside is in.
fn bottom_bin(b: &SceneBox) -> i32 {
    let bottom_m = b.center_m.z - b.size_m.z / 2.0;
    // Shifted slightly up: an underside on the border of two bins is in the upper one.
    ((bottom_m - Extent::BOTTOM_M) * 2.5 + 1e-6).floor() as i32
}

fn corner(found: &[([usize; 2], [u8; Extent::NZ])], of: fn(usize, usize) -> usize) -> Option<[usize; 2]> {
    let all = found.iter().map(|(at, _)| *at);
    all.reduce(|a, b| [of(a[0], b[0]), of(a[1], b[1])])
}
