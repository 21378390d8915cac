//! Procedural scenery around things that are there already.

use glam::DVec2;

use scene::raster::{disc_cells, line_cells, polygon_cells};
use scene::{Background, Extent, Form};

/// Room around a thing of the file, m.
const ROOM_M: f64 = 1.0;

/// The columns of a map that things stand on, with some room around them.
pub struct OccupiedColumns {
    extent: Extent,
    is_taken: Vec<bool>,
}

impl OccupiedColumns {
    /// The columns taken by some forms.
    pub fn by<'a>(extent: Extent, forms: impl IntoIterator<Item = &'a Form>) -> Self {
        let mut out = Self {
            extent,
            is_taken: vec![false; extent.columns()],
        };
        forms.into_iter().for_each(|form| out.add(form));
        out
    }

    /// Adds the columns of a form.
    pub fn add(&mut self, form: &Form) {
        let (extent, is_taken) = (self.extent, &mut self.is_taken);
        columns(extent, form, ROOM_M, |x, y| is_taken[extent.index(x, y)] = true);
    }

    /// True if nothing stands where a form would.
    pub fn is_free(&self, form: &Form) -> bool {
        let mut free = true;
        columns(self.extent, form, 0.0, |x, y| {
            free &= !self.is_taken[self.extent.index(x, y)]
        });
        free
    }
}

/// The things that are there, and those of the things drawn on a map that keep clear of them.
pub fn merged(extent: Extent, there: Background, drawn: &Background) -> Background {
    let taken = OccupiedColumns::by(extent, there.iter().map(|t| &t.form));
    let mut out = there;
    for thing in drawn.iter().filter(|t| taken.is_free(&t.form)) {
        out.add(thing.form.clone());
    }
    out
}

/// The columns of a map that a form stands on or hangs over, grown by a margin.
pub fn columns(extent: Extent, form: &Form, margin_m: f64, mut visit: impl FnMut(usize, usize)) {
    let around = |outline_m: &[DVec2], visit: &mut dyn FnMut(usize, usize)| {
        polygon_cells(extent, outline_m, &mut *visit);
        let ring: Vec<DVec2> = outline_m.iter().chain(outline_m.first()).copied().collect();
        line_cells(extent, &ring, margin_m + extent.voxel_m() / 2.0, visit);
    };
    match form {
        Form::Building(b) => around(&b.outline_m, &mut visit),
        Form::Shrubs(s) => around(&s.outline_m, &mut visit),
        Form::Line(l) => line_cells(extent, &l.points_m, l.width_m / 2.0 + margin_m, visit),
        Form::Bridge(b) => line_cells(extent, &b.points_m, b.width_m / 2.0 + margin_m, visit),
        Form::Tree(t) => disc_cells(extent, t.position_m, t.crown_radius_m + margin_m, visit),
        Form::Post(p) => disc_cells(extent, p.position_m, form.overhang_m() + margin_m, visit),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use scene::background::{Building, Tree, TreeKind};

    #[test]
    fn drawn_scenery_keeps_clear_of_what_is_there() {
        let tree = |x: f64| {
            Form::Tree(Tree {
                position_m: DVec2::new(x, 15.0),
                height_m: 6.0,
                crown_radius_m: 1.5,
                kind: TreeKind::Broadleaf,
            })
        };
        let mut there = Background::default();
        let house = Building::rectangle(DVec2::new(0.0, 15.0), DVec2::splat(5.0), DVec2::X, 9.0);
        there.add(Form::Building(house.clone()));
        let mut drawn = Background::default();
        for x in [-20.0, 0.0, 6.0, 20.0] {
            drawn.add(tree(x));
        }
        let both = merged(Extent::WINDOW, there, &drawn);
        let forms: Vec<Form> = both.iter().map(|t| t.form.clone()).collect();
        assert_eq!(forms, [Form::Building(house), tree(-20.0), tree(20.0)]);
    }
}
