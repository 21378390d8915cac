//! Every figure on things built by hand, then with its fault put in by hand.

use super::*;
use scene::{Class, Window};
use world::World;
use world::voxelize::{Vertical, complete};

const ROAD: u8 = Class::DriveableSurface as u8;

fn fill(grid: &mut VoxelGrid, x: [usize; 2], y: [usize; 2], z: [usize; 2], label: u8) {
    for i in x[0]..x[1] {
        for j in y[0]..y[1] {
            grid.column_mut(i, j)[z[0]..z[1]].fill(label);
        }
    }
}

/// Terrain with a road of 40 columns through it, a block of 20 x 30 columns and 9 voxels, and a tree.
fn by_hand() -> VoxelGrid {
    let mut grid = VoxelGrid::new();
    fill(&mut grid, [0, 200], [0, 200], [0, 1], Class::Terrain.id());
    fill(&mut grid, [0, 200], [80, 120], [0, 1], ROAD);
    fill(&mut grid, [40, 60], [130, 160], [0, 9], Class::Manmade.id());
    fill(&mut grid, [100, 101], [50, 51], [0, 8], Class::Vegetation.id());
    fill(&mut grid, [98, 103], [48, 53], [8, 12], Class::Vegetation.id());
    grid
}

#[test]
fn counted_by_hand() {
    let found = shape(&by_hand());
    assert_eq!(found["edge_per_manmade_column"], 100.0 / 600.0);
    assert_eq!(found["manmade_parts"], 1.0);
    assert_eq!(found["manmade_part_median_columns"], 600.0);
    assert_eq!(found["roof_steps"], 0.0);
    // A stretch with two sides or more beyond a corner is bent: six at each corner.
    assert_eq!(found["wall_straightness"], (100.0 - 24.0) / 100.0);
    for name in ["driveable_surface", "terrain"] {
        assert_eq!(found[format!("holes.{name}").as_str()], 0.0);
    }
    assert!(!found.contains_key("holes.sidewalk"));
    for name in [
        "crowns_without_trunk",
        "vegetation_without_trunk",
        "unsupported_parts",
    ] {
        assert_eq!(found[name], 0.0, "{name}");
    }
    let empty = shape(&VoxelGrid::new());
    assert_eq!(empty["manmade_parts"], 0.0);
    assert!(!empty.contains_key("roof_steps") && !empty.contains_key("holes.terrain"));
    assert!(
        found
            .keys()
            .all(|name| FIGURES.iter().any(|(known, _)| known == name))
    );
}

#[test]
fn holes_belong_to_the_ground_around_them() {
    let mut grid = by_hand();
    fill(&mut grid, [20, 24], [100, 103], [0, 1], Class::FREE);
    fill(&mut grid, [150, 152], [20, 22], [0, 1], Class::FREE);
    // Something that stands in a gap of the ground is none; a crown far above one is.
    fill(&mut grid, [70, 74], [100, 102], [0, 4], Class::Car.id());
    fill(&mut grid, [98, 103], [48, 50], [0, 1], Class::FREE);
    let found = shape(&grid);
    assert_eq!(found["holes.driveable_surface"], 12.0 / 8000.0);
    let terrain = 200.0 * 160.0 - 600.0; // the block is too wide to be closed, but for its corners
    let holes = found["holes.terrain"] * terrain;
    assert!((holes - 14.0).abs() < 0.1, "{holes}");
    // Ground a bin higher has holes all the same.
    let mut raised = VoxelGrid::new();
    fill(&mut raised, [0, 200], [0, 200], [5, 6], ROAD);
    fill(&mut raised, [20, 24], [100, 103], [5, 6], Class::FREE);
    assert_eq!(shape(&raised)["holes.driveable_surface"], 12.0 / 40_000.0);
}

#[test]
fn a_lifted_crown_and_a_tree_in_the_air() {
    let mut grid = by_hand();
    fill(&mut grid, [100, 101], [50, 51], [3, 7], Class::FREE);
    let lifted = shape(&grid);
    assert_eq!(
        (lifted["crowns_without_trunk"], lifted["unsupported_parts"]),
        (1.0, 1.0)
    );
    assert_eq!(lifted["vegetation_without_trunk"], 101.0 / 104.0);
    assert_eq!(lifted["unsupported_voxels"], 101.0);
    // Beside a wall it hangs on that, and still has no trunk.
    fill(&mut grid, [60, 64], [140, 144], [4, 8], Class::Vegetation.id());
    let beside = shape(&grid);
    assert_eq!(
        (beside["crowns_without_trunk"], beside["unsupported_parts"]),
        (2.0, 1.0)
    );
    // A whole tree planted in the air over the road.
    let mut grid = by_hand();
    fill(&mut grid, [100, 101], [100, 101], [3, 8], Class::Vegetation.id());
    fill(&mut grid, [98, 103], [98, 103], [8, 12], Class::Vegetation.id());
    let planted = shape(&grid);
    assert_eq!(
        (planted["crowns_without_trunk"], planted["unsupported_parts"]),
        (1.0, 1.0)
    );
    // A bush on a hill takes the place of the ground there.
    let mut raised = VoxelGrid::new();
    fill(&mut raised, [0, 200], [0, 200], [5, 6], ROAD);
    fill(&mut raised, [20, 24], [100, 103], [5, 8], Class::Vegetation.id());
    assert_eq!(shape(&raised)["crowns_without_trunk"], 0.0);
    // Its trunk on the road, it stands; at the side of the grid nobody knows.
    fill(&mut grid, [100, 101], [100, 101], [1, 3], Class::Vegetation.id());
    fill(&mut grid, [0, 3], [30, 33], [8, 12], Class::Vegetation.id());
    let stands = shape(&grid);
    assert_eq!(
        (stands["crowns_without_trunk"], stands["unsupported_parts"]),
        (0.0, 0.0)
    );
}

/// A block turned by `angle` runs straight; with every outline column thrown out by chance it does not.
#[test]
fn walls_in_any_direction_are_straight_until_roughened() {
    let mut draw = world::draw::Draw::new(1, "rough walls");
    for degrees in [0.0f64, 7.0, 18.0, 30.0, 45.0, 61.0] {
        let (sin, cos) = degrees.to_radians().sin_cos();
        let (mut smooth, mut rough) = (VoxelGrid::new(), VoxelGrid::new());
        for x in 0..Window::NX {
            for y in 0..Window::NY {
                let (dx, dy) = (x as f64 - 99.7, y as f64 - 100.2);
                let (u, v) = (dx * cos + dy * sin, dy * cos - dx * sin);
                let out = (u.abs() - 40.0).max(v.abs() - 25.0);
                if out < 0.0 {
                    smooth.column_mut(x, y)[..8].fill(Class::Manmade.id());
                }
                if out < 0.0 && (out < -2.0 || draw.chance(0.5)) {
                    rough.column_mut(x, y)[..8].fill(Class::Manmade.id());
                }
            }
        }
        let [smooth, rough] = [shape(&smooth), shape(&rough)];
        let name = "wall_straightness";
        assert!(smooth[name] > 0.8, "{degrees}: {}", smooth[name]);
        assert!(rough[name] < 0.35, "{degrees}: {}", rough[name]);
        assert!(
            rough["wall_deviation_m"] > 1.5 * smooth["wall_deviation_m"],
            "{degrees}"
        );
        assert!(rough["edge_per_manmade_column"] > 1.5 * smooth["edge_per_manmade_column"]);
    }
}

/// In a procedural world: roofs jittered, walls taken apart into shards, the road punched.
#[test]
fn faults_in_a_world_move_their_figures_and_no_others() {
    let world = complete(&World::random(11), Vertical::Occ3d);
    let sound = shape(&world);
    let mut draw = world::draw::Draw::new(2, "faults");
    let [mut roofs, mut shards, mut holes] = [world.clone(), world.clone(), world.clone()];
    for x in 0..Window::NX {
        for y in 0..Window::NY {
            let column = world.column(x, y);
            let top = column.iter().rposition(|l| *l == Class::Manmade.id());
            if let Some(top) = top.filter(|t| (3..15).contains(t))
                && draw.chance(0.3)
            {
                roofs.set(x, y, top + 1, Class::Manmade.id());
            }
            if top.is_some() && draw.chance(0.3) {
                column.iter().enumerate().for_each(|(z, l)| {
                    if *l == Class::Manmade.id() {
                        shards.set(x, y, z, if z == 0 { Class::Terrain.id() } else { Class::FREE });
                    }
                });
            }
            if column[0] == ROAD && draw.chance(0.05) {
                holes.set(x, y, 0, Class::FREE);
            }
        }
    }
    let same = |found: &ShapeFigures, name: &str| found[name] == sound[name];
    let [roofs, shards, holes] = [roofs, shards, holes].map(|g| shape(&g));
    assert!(
        roofs["roof_steps"] > 2.0 * sound["roof_steps"],
        "{roofs:?} {sound:?}"
    );
    assert!(same(&roofs, "edge_per_manmade_column") && same(&roofs, "holes.driveable_surface"));
    assert!(shards["edge_per_manmade_column"] > 1.5 * sound["edge_per_manmade_column"]);
    assert!(shards["wall_straightness"] < 0.7 * sound["wall_straightness"]);
    let missing = holes["holes.driveable_surface"] - sound["holes.driveable_surface"];
    assert!((0.03..0.06).contains(&missing), "{missing}");
    assert!(same(&holes, "roof_steps") && same(&holes, "manmade_parts"));
}
