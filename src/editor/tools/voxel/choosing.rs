//! Voxels chosen in a box, a sphere or an outline drawn on the screen.

use std::collections::BTreeSet;

use glam::{DVec2, DVec3};

use crate::Edit;
use crate::choose;
use crate::pick;
use crate::voxel_ops::{self, VoxelIndex};
use scene::{Class, Extent, Frame};

use crate::tools::rays::on_plane;
use crate::tools::{Act, At, Context, Hand, Modifiers, Pointer, Role, ScreenProjection, ToolMark, VoxelMode};

/// A voxel is hidden if something is so many voxels nearer than its middle.
const NEARER: f64 = 2.0;
/// Points of an outline are so far apart at least, points of the screen.
const APART: f64 = 3.0;

/// Region in which voxels are chosen.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum SelectionVolume {
    /// Columns from one corner to the other, so many layers up from the voxel that was pressed.
    Block {
        first: VoxelIndex,
        last: VoxelIndex,
        layers: usize,
    },
    /// About the middle of the voxel that was pressed.
    Sphere { middle: VoxelIndex, radius_m: f64 },
    /// Within an outline on the screen.
    Lasso { points: Vec<DVec2> },
}

impl SelectionVolume {
    /// The region that a press begins; `None` where the press hits no voxel that it needs.
    pub(super) fn begin(cx: &Context<'_>, mode: VoxelMode, at: DVec2) -> Option<Self> {
        if mode == VoxelMode::ChooseLasso {
            return Some(Self::Lasso { points: vec![at] });
        }
        let grid = &cx.frame().occupancy;
        let cell = pick::ray_voxels(&cx.view.ray(at)?, grid, |_, _| true)?.cell;
        Some(match mode {
            VoxelMode::ChooseSphere => Self::Sphere {
                middle: cell,
                radius_m: 0.0,
            },
            _ => Self::Block {
                first: cell,
                last: cell,
                layers: cx.frame().extent().nz(),
            },
        })
    }

    /// Follows the pointer; true if something changed.
    pub(super) fn drag(&mut self, cx: &Context<'_>, pointer: &Pointer) -> bool {
        let extent = cx.frame().extent();
        let on_level = |cell: VoxelIndex| {
            let [x, y, z] = cell;
            on_plane(extent, &cx.view.ray(pointer.at)?, extent.center(x, y, z), 2)
        };
        match self {
            Self::Block { first, last, .. } => {
                let Some(p) = on_level(*first) else { return false };
                let (units, size) = (extent.to_voxel_units(p), extent.shape());
                let clamped = |a: usize| units[a].clamp(0.0, size[a] as f64 - 1.0) as usize;
                let now = [clamped(0), clamped(1), first[2]];
                std::mem::replace(last, now) != now
            }
            Self::Sphere { middle, radius_m } => {
                let [x, y, z] = *middle;
                let Some(p) = on_level(*middle) else { return false };
                let now = p.distance(extent.center(x, y, z));
                std::mem::replace(radius_m, now) != now
            }
            Self::Lasso { points } => {
                let far = points.last().is_none_or(|p| p.distance(pointer.at) >= APART);
                if far {
                    points.push(pointer.at);
                }
                far
            }
        }
    }

    /// The wheel: more or fewer layers.
    pub(super) fn scroll(&mut self, extent: Extent, notches: i32) -> bool {
        let Self::Block { layers, .. } = self else {
            return false;
        };
        *layers = (*layers as i32 + notches).clamp(1, extent.nz() as i32) as usize;
        true
    }

    /// The solid voxels in it. An outline leaves out those behind others, unless it goes `through`.
    pub(super) fn cells(&self, frame: &Frame, view: &dyn ScreenProjection, through: bool) -> Vec<VoxelIndex> {
        let (grid, extent) = (&frame.occupancy, frame.extent());
        let [nx, ny, nz] = extent.shape();
        let mut out = Vec::new();
        let mut within = |x: [usize; 2], y: [usize; 2], z: [usize; 2], is_in: &dyn Fn(VoxelIndex) -> bool| {
            for (x, y) in (x[0]..=x[1]).flat_map(|x| (y[0]..=y[1]).map(move |y| (x, y))) {
                let column = grid.column(x, y);
                let solid = (z[0]..=z[1]).filter(|z| column[*z] != Class::FREE);
                out.extend(solid.map(|z| [x, y, z]).filter(|cell| is_in(*cell)));
            }
        };
        match self {
            Self::Block { first, last, layers } => {
                let range = |a: usize| [first[a].min(last[a]), first[a].max(last[a])];
                let top = (first[2] + layers - 1).min(nz - 1);
                within(range(0), range(1), [first[2], top], &|_| true);
            }
            Self::Sphere { middle, radius_m } => {
                let [x, y, z] = *middle;
                let middle_m = extent.center(x, y, z);
                let reach = (radius_m / extent.voxel_m()).ceil() as usize;
                let range =
                    |a: usize, n: usize| [middle[a].saturating_sub(reach), (middle[a] + reach).min(n - 1)];
                let is_in = |[x, y, z]: VoxelIndex| extent.center(x, y, z).distance(middle_m) <= *radius_m;
                within(range(0, nx), range(1, ny), range(2, nz), &is_in);
            }
            Self::Lasso { points } if points.len() >= 3 => {
                let is_in = |[x, y, z]: VoxelIndex| {
                    let middle_m = extent.center(x, y, z);
                    let on_screen = view.project(middle_m).filter(|p| choose::is_inside(points, *p));
                    on_screen.is_some_and(|p| through || is_seen(frame, view, middle_m, p))
                };
                within([0, nx - 1], [0, ny - 1], [0, nz - 1], &is_in);
            }
            Self::Lasso { .. } => {}
        }
        out
    }

    /// Chooses the solid voxels in it, with symmetry on both sides of the ego axis.
    pub(super) fn take(&self, cx: &mut Context<'_>, how: Joins) {
        let frame = cx.settled.frame();
        let cells = self.cells(frame, cx.view, cx.hand.voxels_through);
        let both = cx.hand.both_sides(frame.extent(), cells);
        let cells = voxel_ops::only(&frame.occupancy, both, false);
        cx.hand.choose_voxels(cells, how);
    }

    /// The marks while the region grows.
    pub(super) fn marks(
        &self,
        frame: &Frame,
        hand: &Hand,
        view: &dyn ScreenProjection,
        color: [u8; 3],
    ) -> Vec<ToolMark> {
        match self {
            Self::Lasso { points } => {
                let closed = points.iter().chain(points.first()).map(|p| At::Screen(*p));
                vec![
                    ToolMark::Voxels(hand.voxels.clone(), color),
                    ToolMark::Dashed(closed.collect(), Role::Choose),
                ]
            }
            _ => {
                let mut cells = self.cells(frame, view, true);
                cells.extend(&hand.voxels);
                vec![ToolMark::Voxels(cells, color)]
            }
        }
    }
}

/// True if nothing hides the middle of a voxel from a view.
fn is_seen(frame: &Frame, view: &dyn ScreenProjection, middle_m: DVec3, at: DVec2) -> bool {
    let Some(ray) = view.ray(at) else { return false };
    let hit = pick::ray_voxels(&ray, &frame.occupancy, |_, _| true);
    let away_m = (middle_m - ray.origin_in_ego).dot(ray.direction_in_ego);
    hit.is_none_or(|hit| hit.distance_m >= away_m - NEARER * frame.extent().voxel_m())
}

/// How voxels join those that are chosen.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Joins {
    /// In place of them.
    Replace,
    /// Besides them.
    Add,
    /// Takes them out of the selection.
    Remove,
}

/// The join that the held keys mean.
pub(super) fn joins(held: Modifiers) -> Joins {
    match (held.shift, held.ctrl) {
        (true, _) => Joins::Add,
        (false, true) => Joins::Remove,
        (false, false) => Joins::Replace,
    }
}

impl Hand {
    /// Chooses voxels: in place of those chosen, besides them, or out of them.
    pub fn choose_voxels(&mut self, cells: Vec<VoxelIndex>, how: Joins) {
        match how {
            Joins::Replace => self.voxels = cells,
            Joins::Add => self.voxels.extend(cells),
            Joins::Remove => {
                let gone: BTreeSet<VoxelIndex> = cells.into_iter().collect();
                self.voxels.retain(|cell| !gone.contains(cell));
            }
        }
        self.voxels.sort_unstable();
        self.voxels.dedup();
    }

    /// Gives the chosen voxels a class, and lets go of them; `free` removes them.
    pub fn paint_chosen_voxels(&mut self, class: Class) -> Vec<Act> {
        let cells = std::mem::take(&mut self.voxels);
        if cells.is_empty() {
            return Vec::new();
        }
        let label = match class {
            Class::Free => "Remove voxels",
            _ => "Recolour voxels",
        };
        vec![Act::Apply(label.into(), vec![Edit::PaintVoxels { cells, class }])]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::pick::PickRay;
    use crate::tools::ViewKind;
    use scene::{BevLayout, VoxelGrid};

    /// Looks straight down: a point of the screen is a hundredth of a metre.
    struct Above;

    impl ScreenProjection for Above {
        fn kind(&self) -> ViewKind {
            ViewKind::Space
        }

        fn project(&self, p_m: DVec3) -> Option<DVec2> {
            Some(p_m.truncate() * 100.0)
        }

        fn ray(&self, at: DVec2) -> Option<PickRay> {
            PickRay::new((at / 100.0).extend(100.0), DVec3::NEG_Z)
        }

        fn right(&self) -> DVec3 {
            DVec3::X
        }

        fn scale(&self) -> f64 {
            1.0
        }
    }

    /// A tower of six voxels with a roof that juts out to one side, and a stone below the roof.
    fn frame() -> Frame {
        let mut grid = VoxelGrid::new();
        for z in 0..6 {
            grid.set(100, 100, z, Class::Manmade.id());
        }
        grid.set(101, 100, 5, Class::Manmade.id());
        grid.set(101, 100, 0, Class::Others.id());
        Frame::new(BevLayout::default(), Default::default(), grid)
    }

    #[test]
    fn boxes_and_spheres_take_what_is_solid_in_them() {
        let frame = frame();
        let block = |layers| SelectionVolume::Block {
            first: [100, 100, 0],
            last: [101, 100, 0],
            layers,
        };
        assert_eq!(block(16).cells(&frame, &Above, false).len(), 8);
        assert_eq!(
            block(1).cells(&frame, &Above, false),
            [[100, 100, 0], [101, 100, 0]]
        );
        let sphere = |radius_m| SelectionVolume::Sphere {
            middle: [100, 100, 5],
            radius_m,
        };
        assert_eq!(sphere(0.0).cells(&frame, &Above, false), [[100, 100, 5]]);
        assert_eq!(sphere(0.41).cells(&frame, &Above, false).len(), 3);
        assert_eq!(sphere(1e6).cells(&frame, &Above, false).len(), 8);
    }

    #[test]
    fn an_outline_takes_what_is_seen_or_all_behind_it() {
        let frame = frame();
        let middle = frame.extent().center(101, 100, 0).truncate() * 100.0;
        let corner = |x: f64, y: f64| middle + DVec2::new(x, y);
        let around = vec![
            corner(-15.0, -15.0),
            corner(15.0, -15.0),
            corner(15.0, 15.0),
            corner(-15.0, 15.0),
        ];
        let area = SelectionVolume::Lasso { points: around };
        assert_eq!(area.cells(&frame, &Above, false), [[101, 100, 5]]);
        assert_eq!(area.cells(&frame, &Above, true), [[101, 100, 0], [101, 100, 5]]);
        let line = SelectionVolume::Lasso {
            points: vec![corner(0.0, 0.0), corner(1.0, 0.0)],
        };
        assert!(line.cells(&frame, &Above, true).is_empty());
    }

    #[test]
    fn voxels_join_those_chosen_or_leave_them() {
        let mut hand = Hand::default();
        hand.choose_voxels(vec![[1, 1, 1], [2, 2, 2]], Joins::Replace);
        hand.choose_voxels(vec![[2, 2, 2], [3, 3, 3]], Joins::Add);
        assert_eq!(hand.voxels, [[1, 1, 1], [2, 2, 2], [3, 3, 3]]);
        hand.choose_voxels(vec![[1, 1, 1], [9, 9, 9]], Joins::Remove);
        assert_eq!(hand.voxels, [[2, 2, 2], [3, 3, 3]]);
        hand.choose_voxels(vec![[4, 4, 4]], Joins::Replace);
        assert_eq!(hand.voxels, [[4, 4, 4]]);
    }
}
