//! Edits of the background: the things change, and at once their voxels in every frame and in its source, so that
//! nothing waits for the networks. All other voxels stay as they are.

use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;

use glam::{DVec2, DVec3};

use super::immediate::refill_ground;
use scene::background::{ColumnLabels, in_extent};
use scene::draft::ground_bin;
use scene::grid::NOT_PAINTED;
use scene::raster::polygon_cells;
use scene::shape::at_least;
use scene::{
    Background, BevLayout, Class, Extent, Form, Frame, Scene, Thing, ThingId, VoxelGrid, VoxelPaint,
};
use scene::{Edit, EditError};

/// Voxels of a thing's class this close to it belong to it, columns: a network does not draw it exactly.
const MARGIN: usize = 1;
/// Most things in one edit.
const MOST: usize = Background::MAX_THINGS;

/// The background after an edit of things; `None` if it changes nothing.
pub(super) fn changed(edit: &Edit, background: &Background) -> Result<Option<Background>, EditError> {
    let mut after = background.clone();
    match edit {
        Edit::AddThings { forms } | Edit::DrawScenery { forms } => {
            at_least("forms", forms.len(), 1)?;
            let total = background.len() + forms.len();
            if forms.len() > MOST || total > MOST {
                return Err(EditError::BadThing(format!(
                    "the background would hold {total} things, expected at most {MOST}"
                )));
            }
            for form in forms {
                after.add_as(sound(form.clone())?, matches!(edit, Edit::AddThings { .. }));
            }
        }
        Edit::RemoveThings { ids } => {
            at_least("ids", ids.len(), 1)?;
            for id in ids {
                after.remove(*id).ok_or(EditError::UnknownThing { id: *id })?;
            }
        }
        Edit::MoveThings { ids, by_m, turn_deg } => {
            at_least("ids", ids.len(), 1)?;
            number("by_m", by_m.is_finite(), || format!("[{}, {}]", by_m.x, by_m.y))?;
            number("turn_deg", turn_deg.is_finite(), || turn_deg.to_string())?;
            let middles = ids.iter().map(|id| Ok(known(background, *id)?.form.middle_m()));
            let middles: Vec<DVec2> = middles.collect::<Result<_, EditError>>()?;
            let pivot = middles.iter().sum::<DVec2>() / middles.len() as f64;
            let turn_rad = turn_deg.rem_euclid(360.0).to_radians();
            let turn = DVec2::from_angle(turn_rad);
            let move_point = |p: DVec2| match turn_rad == 0.0 {
                true => p + *by_m,
                false => pivot + turn.rotate(p - pivot) + *by_m,
            };
            for_each(&mut after, ids, |form| form.map_points(move_point, turn_rad))?;
        }
        Edit::RaiseThings { ids, by_m } => {
            at_least("ids", ids.len(), 1)?;
            number("by_m", by_m.is_finite(), || by_m.to_string())?;
            for_each(&mut after, ids, |form| raise(form, *by_m))?;
        }
        Edit::ChangeThing { id, form } => {
            let new = sound(form.clone())?;
            for_each(&mut after, &[*id], |form| form.clone_from(&new))?;
        }
        _ => return Ok(None),
    }
    Ok((after != *background).then_some(after))
}

fn number(field: &'static str, finite: bool, found: impl Fn() -> String) -> Result<(), EditError> {
    match finite {
        true => Ok(()),
        false => Err(EditError::Number {
            field,
            found: found(),
            expected: "finite numbers",
        }),
    }
}

fn known(background: &Background, id: ThingId) -> Result<&Thing, EditError> {
    background.get(id).ok_or(EditError::UnknownThing { id })
}

fn sound(form: Form) -> Result<Form, EditError> {
    match form.problem() {
        Some(problem) => Err(EditError::BadThing(problem)),
        None => Ok(form),
    }
}

fn for_each(
    background: &mut Background,
    ids: &[ThingId],
    mut change: impl FnMut(&mut Form),
) -> Result<(), EditError> {
    for id in ids {
        let before = known(background, *id)?;
        let mut thing = before.clone();
        change(&mut thing.form);
        thing.form = sound(thing.form)?;
        // A thing that a user moved or shaped is the user's own.
        thing.placed |= thing.form != before.form;
        background.insert(thing);
    }
    Ok(())
}

fn raise(form: &mut Form, by_m: f64) {
    match form {
        Form::Building(b) => b.height_m += by_m,
        Form::Tree(t) => t.height_m += by_m,
        Form::Shrubs(s) => s.height_m += by_m,
        Form::Line(l) => l.height_m += by_m,
        Form::Post(p) => p.height_m += by_m,
        Form::Bridge(b) => b.height_m += by_m,
    }
}

/// Puts a background in place of the scene's: the voxels of things that differ follow in all frames.
pub(super) fn replace_background(scene: &mut Scene, after: Background) {
    let before = std::mem::replace(&mut scene.background, Arc::new(after));
    let after = scene.background.clone();
    let (gone, come) = (only_in(&before, &after), only_in(&after, &before));
    scene.change_canvas(|frame| {
        let extent = frame.extent();
        let (gone, come) = (in_extent(extent, &gone), in_extent(extent, &come));
        if gone.is_empty() && come.is_empty() {
            return;
        }
        let kept = after.in_extent(extent);
        let near: Vec<Thing> = kept
            .into_iter()
            .filter(|t| gone.iter().any(|g| near(extent, t, g)))
            .collect();
        let Frame {
            layout,
            occupancy,
            painted,
            source,
            inferred,
            ..
        } = frame;
        let guessed = inferred.background;
        let change = SceneryChange::on(layout, &gone, &come, &near);
        change.redraw(occupancy, layout, painted, guessed);
        let source = Arc::make_mut(source);
        // The places of things' voxels depend on the ground alone.
        let other = (source.layout.relief != layout.relief)
            .then(|| SceneryChange::on(&source.layout, &gone, &come, &near));
        let change = other.as_ref().unwrap_or(&change);
        change.redraw(&mut source.occupancy, &source.layout, painted, guessed);
    });
}

/// Takes voxels of scenery that belong to no thing out of columns (none: of all) of the current frame and of its source.
pub(super) fn clear_scenery(scene: &mut Scene, cells: Option<&[[usize; 2]]>) {
    let extent = scene.canvas().extent();
    let cells = cells.map_or_else(|| extent.all_columns().collect(), <[_]>::to_vec);
    let kept = scene.background.in_extent(extent);
    let mut frame = Frame::clone(scene.canvas());
    let source = Arc::make_mut(&mut frame.source);
    let grids = [
        (&mut frame.occupancy, &frame.layout),
        (&mut source.occupancy, &source.layout),
    ];
    let mut changed = false;
    for (grid, layout) in grids {
        changed |= clear_columns(grid, layout, &frame.painted, &cells, &kept);
    }
    if changed {
        scene.change_canvas(|canvas| *canvas = frame);
    }
}

/// True if there was something to take out.
fn clear_columns(
    grid: &mut VoxelGrid,
    layout: &BevLayout,
    painted: &VoxelPaint,
    cells: &[[usize; 2]],
    kept: &[Thing],
) -> bool {
    // Voxels of the things' own forms, in these columns and of their class.
    let nz = grid.extent().nz();
    let mut owned: BTreeMap<[usize; 2], Vec<bool>> = BTreeMap::new();
    for thing in kept {
        let class = thing.form.class().id();
        for (at, voxels) in thing.columns(layout) {
            let own = owned.entry(at).or_insert_with(|| vec![false; nz]);
            let now = grid.column(at[0], at[1]);
            for z in 0..nz {
                own[z] |= voxels[z] != Class::FREE && (now[z] == voxels[z] || now[z] == class);
            }
        }
    }
    let mut emptied = Vec::new();
    let mut changed = false;
    for &[x, y] in cells {
        let (own, locked) = (owned.get(&[x, y]), painted.column(x, y));
        let mut column = grid.column(x, y).to_vec();
        for z in 0..nz {
            let scenery = [Class::Manmade.id(), Class::Vegetation.id()].contains(&column[z]);
            if scenery && locked[z] == NOT_PAINTED && !own.is_some_and(|own| own[z]) {
                column[z] = Class::FREE;
            }
        }
        if column != grid.column(x, y) {
            grid.column_mut(x, y).copy_from_slice(&column);
            changed = true;
            if column[ground_bin(layout, x, y)] == Class::FREE {
                emptied.push([x, y]);
            }
        }
    }
    refill_ground(grid, layout, &emptied);
    changed
}

/// Columns of a frame, `[x][y]`, whose voxels an edit of the background from `before` to `after` may change.
pub fn columns_between(before: &Background, after: &Background, frame: &Frame) -> Vec<bool> {
    let extent = frame.extent();
    let mut out = vec![false; extent.columns()];
    let changed = [only_in(before, after), only_in(after, before)].concat();
    for thing in in_extent(extent, &changed) {
        let own = thing.columns(&frame.layout);
        for [x, y] in with_margin(extent, &own)
            .into_iter()
            .chain(grown_over(extent, &thing))
        {
            out[extent.index(x, y)] = true;
        }
    }
    out
}

/// Things of `a` that `b` lacks or has in another form.
fn only_in(a: &Background, b: &Background) -> Vec<Thing> {
    a.iter().filter(|t| b.get(t.id) != Some(t)).cloned().collect()
}

/// Things with their voxels.
type ThingVoxels<'a> = Vec<(&'a Thing, ColumnLabels)>;

/// Change of the background, as the things whose voxels go, come or stay.
struct SceneryChange<'a> {
    /// Things whose voxels are taken away.
    gone: ThingVoxels<'a>,
    /// Things whose voxels are added.
    come: ThingVoxels<'a>,
    /// Things that stay, near to those that go.
    kept: ThingVoxels<'a>,
}

impl<'a> SceneryChange<'a> {
    fn on(layout: &BevLayout, gone: &'a [Thing], come: &'a [Thing], kept: &'a [Thing]) -> Self {
        let drawn = |things: &'a [Thing]| things.iter().map(|t| (t, t.columns(layout))).collect();
        Self {
            gone: drawn(gone),
            come: drawn(come),
            kept: drawn(kept),
        }
    }

    /// Clears the voxels of the things that go, and stamps those of the things that come. Things that stay get back the
    /// voxels that were cleared; with `guessed` (things inferred from voxels) only those that were of their own class:
    /// more of them was never seen there.
    fn redraw(&self, grid: &mut VoxelGrid, layout: &BevLayout, painted: &VoxelPaint, guessed: bool) {
        let mut cleared = ColumnLabels::new();
        for (thing, own) in &self.gone {
            clear(grid, painted, (thing, own), layout, &mut cleared);
        }
        let is_bare = |[x, y]: &[usize; 2]| grid.get(*x, *y, ground_bin(layout, *x, *y)) == Class::FREE;
        let emptied: Vec<[usize; 2]> = cleared.keys().copied().filter(is_bare).collect();
        refill_ground(grid, layout, &emptied);
        for (thing, own) in &self.kept {
            let class = thing.form.class().id();
            stamp(grid, painted, own, |[x, y, z]| {
                let was = cleared.get(&[x, y]).map_or(Class::FREE, |column| column[z]);
                was != Class::FREE && (!guessed || was == class)
            });
        }
        for (_, own) in &self.come {
            stamp(grid, painted, own, |_| true);
        }
    }
}

fn near(extent: Extent, a: &Thing, b: &Thing) -> bool {
    let ((a_lo, a_hi), (b_lo, b_hi)) = (a.form.bounds_m(), b.form.bounds_m());
    let reach = DVec2::splat(2.0 * extent.voxel_m());
    a_lo.cmple(b_hi + reach).all() && b_lo.cmple(a_hi + reach).all()
}

fn clear(
    grid: &mut VoxelGrid,
    painted: &VoxelPaint,
    (thing, own): (&Thing, &ColumnLabels),
    layout: &BevLayout,
    cleared: &mut ColumnLabels,
) {
    let (extent, nz) = (layout.extent(), layout.extent().nz());
    let mut around = with_margin(extent, own);
    let class = thing.form.class().id();
    let top = own
        .values()
        .filter_map(|c| c.iter().rposition(|v| *v != Class::FREE))
        .max();
    let mut top = top.map_or(0, |z| (z + MARGIN).min(nz - 1));
    for [x, y] in grown_over(extent, thing) {
        let height_m = layout.relief.column_m(x, y) + thing.form.height_m();
        let bin = extent.to_voxel_units(DVec3::Z * height_m).z.max(0.0) as usize;
        top = top.max((bin + MARGIN).min(nz - 1));
        around.insert([x, y]);
    }
    for [x, y] in around {
        let locked = painted.column(x, y);
        let mut column = grid.column(x, y).to_vec();
        let mut taken = vec![Class::FREE; nz];
        for z in 0..=top {
            // Its own voxels of any class (a deck, a bin), and its class right around it.
            let is_own = own
                .get(&[x, y])
                .is_some_and(|c| c[z] != Class::FREE && c[z] == column[z]);
            if (is_own || column[z] == class) && locked[z] == NOT_PAINTED {
                taken[z] = std::mem::replace(&mut column[z], Class::FREE);
            }
        }
        if taken.iter().any(|label| *label != Class::FREE) {
            let before = cleared.entry([x, y]).or_insert_with(|| vec![Class::FREE; nz]);
            // The first label, if several things clear the voxel.
            for (before, taken) in before.iter_mut().zip(taken) {
                *before = if *before == Class::FREE { taken } else { *before };
            }
        }
        if column != grid.column(x, y) {
            grid.column_mut(x, y).copy_from_slice(&column);
        }
    }
}

fn with_margin(extent: Extent, own: &ColumnLabels) -> BTreeSet<[usize; 2]> {
    let around = |[x, y]: [usize; 2]| {
        let ys = y.saturating_sub(MARGIN)..=(y + MARGIN).min(extent.ny() - 1);
        let xs = x.saturating_sub(MARGIN)..=(x + MARGIN).min(extent.nx() - 1);
        xs.flat_map(move |x| ys.clone().map(move |y| [x, y]))
    };
    // Inside, where all neighbours are its own, there is no margin.
    let rim = own
        .keys()
        .filter(|at| around(**at).any(|near| !own.contains_key(&near)));
    own.keys()
        .copied()
        .chain(rim.flat_map(|at| around(*at)))
        .collect()
}

/// Columns of an area of shrubs: all plants there belong to the area, whether one of the plants drawn for it stands
/// there or not.
fn grown_over(extent: Extent, thing: &Thing) -> Vec<[usize; 2]> {
    let mut out = Vec::new();
    if let Form::Shrubs(shrubs) = &thing.form {
        polygon_cells(extent, &shrubs.outline_m, |x, y| out.push([x, y]));
    }
    out
}

fn stamp(
    grid: &mut VoxelGrid,
    painted: &VoxelPaint,
    own: &ColumnLabels,
    wanted: impl Fn([usize; 3]) -> bool,
) {
    for (&[x, y], voxels) in own {
        let locked = painted.column(x, y);
        let mut column = grid.column(x, y).to_vec();
        for z in 0..column.len() {
            let taken = Class::from_id(column[z]).is_some_and(Class::is_object);
            if voxels[z] != Class::FREE && !taken && locked[z] == NOT_PAINTED && wanted([x, y, z]) {
                column[z] = voxels[z];
            }
        }
        if column != grid.column(x, y) {
            grid.column_mut(x, y).copy_from_slice(&column);
        }
    }
}

#[cfg(test)]
#[path = "things_tests.rs"]
mod tests;
