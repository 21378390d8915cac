//! The background of a labelled frame, as things: buildings, walls, poles, trees, hedges and shrubs, inferred from its
//! voxels. Guesses, good enough to select and to take away; the voxels stay as they are.

mod buildings;
mod columns;
mod lines;
mod rectangle;
mod trees;

use columns::{ClassColumns, around};

use crate::{Background, BevLayout, Class, Form, VoxelGrid};

/// Things of the labels, in the ego frame; ids count from 1, the largest kinds first. `layout` tells the height of the
/// ground.
pub fn background(labels: &VoxelGrid, layout: &BevLayout) -> Background {
    let manmade = ClassColumns::from_labels(Class::Manmade, labels, layout);
    let vegetation = ClassColumns::from_labels(Class::Vegetation, labels, layout);
    let map = labels.extent();
    let mut forms = Vec::new();

    let mut taken = vec![false; map.columns()];
    let buildings = buildings::buildings(labels, &manmade, &mut taken);
    forms.extend(buildings.into_iter().map(Form::Building));
    // Columns right beside a facade belong to the building.
    let left: Vec<bool> = (0..map.columns())
        .map(|c| manmade.top_m[c] > 0.0 && !around(map, c, 1).any(|n| taken[n]))
        .collect();
    forms.extend(lines::walls_and_poles(&manmade, &left));

    let mut crowns = vec![false; map.columns()];
    forms.extend(trees::trees(&vegetation, &mut crowns).into_iter().map(Form::Tree));
    let left: Vec<bool> = (0..map.columns())
        .map(|c| vegetation.top_m[c] > 0.0 && !crowns[c])
        .collect();
    forms.extend(lines::hedges_and_shrubs(&vegetation, &left));

    let mut out = Background::default();
    let sound = forms.into_iter().filter(|f| f.problem().is_none());
    for form in sound.take(Background::MAX_THINGS) {
        out.add(form);
    }
    out
}

#[cfg(test)]
mod tests;
