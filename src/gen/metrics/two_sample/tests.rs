//! Guessing where there is nothing to be told, certainty where there is; on cheap features, then on worlds with a fault.

use super::*;
use crate::local::occupancy;
use scene::{Class, VoxelGrid, Window};
use world::World;
use world::voxelize::{Vertical, complete};

/// Scenes whose windows share something that belongs to the scene alone, `shift` added to one feature of every `every`-th
/// window.
fn scenes(seed: u64, count: usize, shift: f64, every: usize) -> Vec<Windows> {
    let mut draw = Draw::new(seed, "scenes");
    let mut normal = move || (0..12).map(|_| draw.unit()).sum::<f64>() - 6.0;
    let scene = |_| {
        let own: Vec<f64> = (0..6).map(|_| normal()).collect();
        (0..24)
            .map(|w| {
                let mut row: Vec<f64> = own.iter().map(|o| o + normal()).collect();
                row[2] += if w % every == 0 { shift } else { 0.0 };
                row
            })
            .collect()
    };
    (0..count).map(scene).collect()
}

#[test]
fn equal_sets_are_guessed_and_the_interval_says_so() {
    let found: Vec<TwoSample> = (0..12)
        .map(|seed| {
            two_sample(&scenes(seed, 12, 0.0, 1), &scenes(100 + seed, 12, 0.0, 1), seed).expect("sound")
        })
        .collect();
    let guessing = found.iter().filter(|f| f.window.is_guessing()).count();
    let by_scene = found.iter().filter(|f| f.scene.is_guessing()).count();
    let mean = found.iter().map(|f| f.window.mean).sum::<f64>() / 12.0;
    println!("{guessing} {by_scene} of 12, mean {mean:.3}");
    assert!(guessing >= 10 && by_scene >= 10, "{guessing} {by_scene}");
    assert!((mean - 0.5).abs() < 0.08, "{mean}");
}

#[test]
fn a_planted_difference_is_found_and_equal_seeds_give_equal_bits() {
    let plain = scenes(1, 12, 0.0, 1);
    let found = two_sample(&plain, &scenes(2, 12, 4.0, 1), 5).expect("sound");
    assert!(
        found.window.mean > 0.85 && !found.window.is_guessing(),
        "{found:?}"
    );
    assert!(found.scene.mean > 0.85 && !found.scene.is_guessing(), "{found:?}");
    // In every second window.
    let rare = two_sample(&scenes(3, 24, 0.0, 1), &scenes(4, 24, 8.0, 2), 5).expect("sound");
    assert!(
        !rare.window.is_guessing() && rare.window.mean < found.window.mean,
        "{rare:?}"
    );
    let on = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
        let run = || two_sample(&plain, &scenes(2, 12, 4.0, 1), 5).expect("sound");
        pool.expect("a pool").install(run)
    };
    assert_eq!((on(1), on(3)), (found, found));
    let names: Vec<String> = (0..6).map(|i| format!("feature {i}")).collect();
    let tells = tells(&plain, &scenes(2, 12, 4.0, 1), &names, 2);
    assert_eq!((tells.len(), tells[0].feature.as_str()), (2, "feature 2"));
    assert!(tells[0].sigmas > 5.0, "{tells:?}");
}

#[test]
fn sets_that_no_test_can_be_made_of() {
    let some = scenes(1, 4, 0.0, 1);
    assert_eq!(
        two_sample(&some[..3], &some, 0).expect_err("three").to_string(),
        "3 scenes in each set, expected at least 4 with windows"
    );
    let empty = vec![Windows::new(); 4];
    assert!(two_sample(&some, &empty, 0).is_err());
    let narrow: Vec<Windows> = vec![vec![vec![1.0]; 3]; 4];
    assert!(two_sample(&some, &narrow, 0).is_err());
    let mut broken = some.clone();
    broken[1][0][0] = f64::NAN;
    assert!(two_sample(&some, &broken, 0).is_err());
    // Nothing to tell: every window the same.
    let same = two_sample(&narrow, &narrow, 0).expect("sound");
    assert_eq!((same.window.mean, same.scene.mean), (0.5, 0.5));
}

/// Worlds against worlds: guessing. Against worlds whose buildings are nibbled at: found.
#[test]
fn shards_in_worlds_are_found() {
    let grid = |seed: u64| complete(&World::random(seed), Vertical::Occ3d);
    let nibbled = |seed: u64| -> VoxelGrid {
        let (mut out, mut draw) = (grid(seed), Draw::new(seed, "nibbled"));
        for c in 0..Window::COLUMNS {
            if draw.chance(0.35) {
                let column = out.column_mut(c / Window::NY, c % Window::NY);
                let taken = column.iter_mut().skip(1).filter(|l| **l == Class::Manmade.id());
                taken.for_each(|l| *l = Class::FREE);
            }
        }
        out
    };
    // The means of the features by hand: cheap, and enough.
    let by_hand = occupancy::names()
        .iter()
        .filter(|n| !n.starts_with("random"))
        .count();
    let patches = |grids: Vec<VoxelGrid>| -> Vec<Windows> {
        let cut = |rows: Windows| -> Windows { rows.iter().map(|r| r[..by_hand].to_vec()).collect() };
        let each = grids.par_iter();
        each.map(|g| cut(occupancy::patches(&occupancy::windows(g))))
            .collect()
    };
    let worlds = patches((0..14).map(grid).collect());
    let others = patches((50..64).map(grid).collect());
    let nibbled = patches((50..64).map(nibbled).collect());
    let equal = two_sample(&worlds, &others, 1).expect("sound");
    let faulty = two_sample(&worlds, &nibbled, 1).expect("sound");
    println!("{equal:?}\n{faulty:?}");
    assert!(
        equal.window.is_guessing() && equal.scene.is_guessing(),
        "{equal:?}"
    );
    assert!(
        !faulty.window.is_guessing() && faulty.window.mean > equal.window.mean + 0.1,
        "{faulty:?}"
    );
}
