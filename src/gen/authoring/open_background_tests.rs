//! The background inferred from simulated labels of worlds, against the things that the worlds are known to hold.

use std::collections::BTreeSet;

use glam::DVec2;

use super::*;
use editor::{Document, Edit};
use scene::infer;
use scene::raster::{disc_cells, polygon_cells};
use scene::solid::fill::fill;
use scene::{Background, Class, Extent, Form, VoxelGrid, Window};
use world::voxelize::{Drive, labels};

const WORLDS: u64 = 20;

fn cells(outline_m: &[DVec2]) -> BTreeSet<usize> {
    let mut out = BTreeSet::new();
    polygon_cells(Extent::WINDOW, outline_m, |x, y| {
        out.insert(x * Window::NY + y);
    });
    out
}

/// Voxels of a class above the ground's bin.
fn standing(grid: &VoxelGrid, class: Class) -> Vec<[usize; 3]> {
    let of_class = grid.iter_set().filter(|v| v.3 == class.id() && v.2 > 0);
    of_class.map(|(x, y, z, _)| [x, y, z]).collect()
}

fn share((part, all): (usize, usize)) -> f64 {
    part as f64 / all.max(1) as f64
}

/// Columns of things of a class and those right around them.
fn covered(things: &Background, class: Class) -> BTreeSet<usize> {
    let mut out = BTreeSet::new();
    for thing in things.iter().filter(|t| t.form.class() == class) {
        let mut solids = Vec::new();
        thing.solids(&|_| 0.0, &mut solids);
        let mut add = |x: usize, y: usize| {
            for x in x.saturating_sub(1)..=(x + 1).min(Window::NX - 1) {
                for y in y.saturating_sub(1)..=(y + 1).min(Window::NY - 1) {
                    out.insert(x * Window::NY + y);
                }
            }
        };
        for solid in &solids {
            fill(Extent::WINDOW, solid, |_, _| true, |x, y, _, _| add(x, y));
        }
        if let Form::Shrubs(s) = &thing.form {
            polygon_cells(Extent::WINDOW, &s.outline_m, &mut add);
        }
    }
    out
}

/// Manmade voxels that appear when all trees are removed and that were not seen there: there must be none.
fn invented_by_felling(scene: &Scene, grid: &VoxelGrid) -> usize {
    let is_tree = |t: &&scene::Thing| matches!(t.form, Form::Tree(_));
    let tree_ids: Vec<_> = scene.background.iter().filter(is_tree).map(|t| t.id).collect();
    let mut felled = Document::new(scene.clone());
    let fell = Edit::RemoveThings { ids: tree_ids };
    felled.apply("Fell", &fell).expect("there are trees");
    let left = standing(&felled.scene().frame().occupancy, Class::Manmade);
    left.iter()
        .filter(|[x, y, z]| grid.get(*x, *y, *z) != Class::Manmade.id())
        .count()
}

/// Columns of each building.
fn outlines(b: &Background) -> Vec<BTreeSet<usize>> {
    let list = b.iter().filter_map(|t| match &t.form {
        Form::Building(b) => Some(cells(&b.outline_m)),
        _ => None,
    });
    list.collect()
}

/// Place and crown radius of each tree, m.
fn places(b: &Background) -> Vec<(DVec2, f64)> {
    let list = b.iter().filter_map(|t| match &t.form {
        Form::Tree(t) => Some((t.position_m, t.crown_radius_m)),
        _ => None,
    });
    list.collect()
}

/// Known buildings are found (IoU above .3), known trees are near a found one, and removing all things removes nearly
/// all voxels of scenery. Prints the figures.
#[test]
fn things_are_found_in_simulated_labels() {
    let pattern = &SensorRig::default().lidars[0];
    let (mut buildings, mut trees, mut sound_trees, mut sound_buildings) = ((0, 0), (0, 0), (0, 0), (0, 0));
    let (mut cover, mut gone) = ([(0, 0); 2], [(0, 0); 2]);
    let mut other_changes = 0;
    let mut own = (0, 0);
    let mut invented = 0;
    let (mut things, mut seconds) = (0, 0.0);
    for seed in 0..WORLDS {
        let world = World::random(700 + seed);
        let grid = labels(&world, pattern, &Drive::default(), Vertical::Occ3d, seed);
        let layout = infer::layout(&grid);
        let started = std::time::Instant::now();
        let found = infer::background(&grid, &layout);
        seconds += started.elapsed().as_secs_f64();
        assert_eq!(found, infer::background(&grid, &layout));
        assert_eq!(found.problem(), None);
        things += found.len();
        let at = |c: &usize| grid.column(c / Window::NY, c % Window::NY);
        let seen = |c: &usize, class: Class| at(c)[1..].iter().filter(|l| **l == class.id()).count();
        let (known, guessed) = (outlines(&world.background), outlines(&found));
        let same = |a: &BTreeSet<usize>, b: &BTreeSet<usize>| {
            let both = a.intersection(b).count();
            both as f64 / (a.len() + b.len() - both).max(1) as f64
        };
        for k in &known {
            if k.iter().map(|c| seen(c, Class::Manmade)).sum::<usize>() >= 100 {
                buildings.1 += 1;
                let best = guessed.iter().max_by(|a, b| same(k, a).total_cmp(&same(k, b)));
                if let Some(best) = best.filter(|g| same(k, g) > 0.3) {
                    buildings.0 += 1;
                    // Columns of it that are removed with the found thing: the thing's columns and those right around.
                    let goes = |c: &usize| {
                        let (x, y) = ((c / Window::NY) as i64, (c % Window::NY) as i64);
                        (-1..=1).any(|i| (-1..=1).any(|j| best.contains(&(((x + i) * 200 + y + j) as usize))))
                    };
                    for c in k {
                        own.1 += seen(c, Class::Manmade);
                        own.0 += if goes(c) { seen(c, Class::Manmade) } else { 0 };
                    }
                }
            }
        }
        for g in &guessed {
            sound_buildings.1 += 1;
            let inside: usize = known.iter().map(|k| k.intersection(g).count()).sum();
            sound_buildings.0 += usize::from(2 * inside > g.len());
        }
        let (known, guessed) = (places(&world.background), places(&found));
        let near = |list: &[(DVec2, f64)], p: DVec2| list.iter().any(|(q, _)| q.distance(p) < 1.5);
        for (p, radius) in &known {
            let mut voxels = 0;
            disc_cells(Extent::WINDOW, *p, *radius, |x, y| {
                voxels += seen(&(x * Window::NY + y), Class::Vegetation)
            });
            if voxels >= 25 && p.abs().max_element() < 39.0 {
                trees.1 += 1;
                trees.0 += usize::from(near(&guessed, *p));
            }
        }
        for (p, _) in &guessed {
            sound_trees.1 += 1;
            sound_trees.0 += usize::from(near(&known, *p));
        }
        let mut frame = Frame::new(layout, BTreeMap::new(), grid.clone());
        frame.inferred.background = true;
        let mut scene = Scene::single("labels", frame, Arc::new(SensorRig::default()), seed);
        let ids: Vec<_> = found.iter().map(|t| t.id).collect();
        scene.background = Arc::new(found);
        let before = scene.background.clone();
        invented += invented_by_felling(&scene, &grid);
        let mut document = Document::new(scene);
        document
            .apply("Remove", &Edit::RemoveThings { ids })
            .expect("they are there");
        let after = &document.scene().frame().occupancy;
        for (i, class) in [Class::Manmade, Class::Vegetation].into_iter().enumerate() {
            let columns = covered(&before, class);
            let all = standing(&grid, class);
            cover[i].1 += all.len();
            cover[i].0 += all
                .iter()
                .filter(|[x, y, _]| columns.contains(&(x * Window::NY + y)))
                .count();
            gone[i].1 += all.len();
            gone[i].0 += all.len() - standing(after, class).len();
        }
        // Only scenery is removed; the ground under it appears.
        other_changes += grid
            .iter_set()
            .filter(|(x, y, z, l)| {
                let stays = *l != Class::Manmade.id() && *l != Class::Vegetation.id();
                stays && after.get(*x, *y, *z) != *l
            })
            .count();
    }
    println!(
        "buildings found {buildings:?} {:.2}, on known ones {sound_buildings:?} {:.2}; trees within 1.5 m {trees:?} {:.2}, of those found {sound_trees:?} {:.2}; manmade, vegetation voxels covered {:.3} {:.3}, gone with all things {:.3} {:.3}; {:.0} things and {:.0} ms a frame; other voxels changed {other_changes}; a found building's voxels that go with its thing {own:?}",
        share(buildings),
        share(sound_buildings),
        share(trees),
        share(sound_trees),
        share(cover[0]),
        share(cover[1]),
        share(gone[0]),
        share(gone[1]),
        things as f64 / WORLDS as f64,
        1e3 * seconds / WORLDS as f64,
    );
    assert!(share(buildings) > 0.5, "{buildings:?}");
    assert!(share(trees) > 0.6, "{trees:?}");
    assert!(share(gone[0]) >= 0.85 && share(gone[1]) >= 0.85, "{gone:?}");
    assert_eq!((other_changes, invented), (0, 0));
}
