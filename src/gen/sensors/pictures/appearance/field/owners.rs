//! Owners of columns of man-made voxels: the thing of the scenery that each column belongs to. A column with an owner
//! looks as that thing does, whatever else stands, comes or goes around it.

use std::collections::BTreeSet;

use glam::{DVec2, Vec2};

use scene::appearance::FieldShape;
use scene::background::in_extent;
use scene::raster::{disc_cells, line_cells, polygon_cells};
use scene::{Background, BevLayout, Class, Extent, Form, Lattice, Thing, ThingId};

/// Margin around a thing's ground plan within which voxels are its own too, m: labels and networks are not exact.
const MARGIN_M: f64 = Lattice::OCC3D.voxel_m();

/// Columns of a wall without windows, too many for a post.
const BARE_WALL: u32 = 20;

/// Look of a thing of man-made voxels.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ColumnOwner {
    /// See [`Thing::look`].
    pub look: u32,
    /// Properties of its form; `None` for a post, whose voxels are all near one another.
    pub form: Option<OwnForm>,
}

/// Properties of a thing's form that decide how it looks.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct OwnForm {
    /// Direction of its walls, a unit vector; directions at right angles count alike.
    pub axis: Vec2,
    /// Columns of its ground plan.
    pub columns: u32,
    /// Its top, m.
    pub height_m: f32,
    /// Its middle on the ground, m.
    pub middle: Vec2,
}

/// Things and the columns that they own.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Owners {
    /// Owners in the order of their ids.
    pub all: Vec<ColumnOwner>,
    /// For each column of the padded field `[x][y]`: 0, or one more than the place in `all`. Empty if no column has an
    /// owner.
    pub of: Vec<u16>,
}

impl Owners {
    /// Finds the owners among the things of a background, on the ground of a layout that covers the field's map. Of the `cut`
    /// ones bare walls are shown.
    pub fn new(
        background: &Background,
        cut: &BTreeSet<ThingId>,
        layout: &BevLayout,
        shape: &FieldShape,
    ) -> Self {
        let extent = shape.extent;
        let made = |t: &Thing| t.form.class() == Class::Manmade;
        let things: Vec<Thing> = in_extent(extent, background.iter().filter(|t| made(t)));
        let things = &things[..things.len().min(usize::from(u16::MAX) / 2)];
        if things.is_empty() {
            return Self::default();
        }
        let mut of = vec![0u16; shape.nx * shape.ny];
        let mut all: Vec<ColumnOwner> = things.iter().map(|t| owner(t, layout)).collect();
        // A ground plan takes precedence over a margin, a smaller thing over a larger one.
        for margin_m in [MARGIN_M, 0.0] {
            for rank in 0..3 {
                for (i, thing) in things
                    .iter()
                    .enumerate()
                    .filter(|(_, t)| self::rank(&t.form) == rank)
                {
                    let mut columns = 0;
                    plan(extent, &thing.form, margin_m, |x, y| {
                        of[(x + 1) * shape.ny + y + 1] = i as u16 + 1;
                        columns += 1;
                    });
                    if let (Form::Building(_), Some(form)) = (&thing.form, &mut all[i].form) {
                        form.columns = match cut.contains(&thing.id) {
                            true => BARE_WALL,
                            false => columns,
                        };
                    }
                }
            }
        }
        Self { all, of }
    }
}

fn rank(form: &Form) -> usize {
    match form {
        Form::Post(_) => 2,
        Form::Building(_) => 1,
        _ => 0,
    }
}

fn owner(thing: &Thing, layout: &BevLayout) -> ColumnOwner {
    let form = &thing.form;
    let points_m = form.points_m();
    let closed = matches!(form, Form::Building(_));
    let ring: Vec<DVec2> = match closed {
        true => points_m.iter().chain(points_m.first()).copied().collect(),
        false => points_m,
    };
    let mut sum = DVec2::ZERO;
    let mut length_m = 0.0;
    for [a, b] in ring.array_windows::<2>() {
        let way = *b - *a;
        length_m += way.length();
        // Four directions at right angles are one and the same.
        sum += DVec2::from_angle(way.to_angle() * 4.0) * way.length();
    }
    let middle_m = form.middle_m();
    let mut solids = Vec::new();
    thing.solids(&|p| layout.relief.height_m(p), &mut solids);
    let tops = solids.iter().map(|s| s.center.z + s.reach().z);
    let top_m = match form {
        // Its walls alone: the field has no roof to put on them.
        Form::Building(b) => layout.relief.height_m(middle_m) + b.height_m,
        _ => tops.fold(f64::NEG_INFINITY, f64::max),
    };
    let width_m = 2.0 * form.overhang_m();
    ColumnOwner {
        look: thing.look,
        form: (!matches!(form, Form::Post(_))).then(|| OwnForm {
            axis: match sum == DVec2::ZERO {
                true => Vec2::X,
                false => DVec2::from_angle(sum.to_angle() / 4.0).as_vec2(),
            },
            columns: (length_m / Lattice::OCC3D.voxel_m() * (width_m / Lattice::OCC3D.voxel_m()).max(1.0))
                as u32,
            height_m: top_m.clamp(Lattice::OCC3D.bottom_m() + Lattice::OCC3D.voxel_m(), 400.0) as f32,
            middle: middle_m.as_vec2(),
        }),
    }
}

/// The columns under a form, grown by a margin.
fn plan(extent: Extent, form: &Form, margin_m: f64, mut visit: impl FnMut(usize, usize)) {
    match form {
        Form::Building(b) => {
            polygon_cells(extent, &b.outline_m, &mut visit);
            if margin_m > 0.0 {
                let ring: Vec<DVec2> = b.outline_m.iter().chain(b.outline_m.first()).copied().collect();
                line_cells(extent, &ring, form.overhang_m() + margin_m, visit);
            }
        }
        Form::Shrubs(s) => polygon_cells(extent, &s.outline_m, visit),
        Form::Line(l) => line_cells(extent, &l.points_m, l.width_m / 2.0 + margin_m, visit),
        Form::Bridge(b) => line_cells(extent, &b.points_m, b.width_m / 2.0 + margin_m, visit),
        Form::Tree(t) => disc_cells(extent, t.position_m, t.crown_radius_m + margin_m, visit),
        Form::Post(p) => disc_cells(extent, p.position_m, form.overhang_m() + margin_m, visit),
    }
}
