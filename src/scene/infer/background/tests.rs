//! Tests on labels painted by hand: an obvious single thing becomes one thing.

use glam::DVec2;

use super::*;
use crate::VoxelGrid;
use crate::Window;
use crate::background::LineKind;
use crate::raster::{disc_cells, line_cells, polygon_cells};

/// Ground everywhere, then columns of a class from the ground up to a height.
struct Labels(VoxelGrid);

impl Labels {
    fn new() -> Self {
        let mut grid = VoxelGrid::new();
        for c in 0..Window::COLUMNS {
            grid.set(c / Window::NY, c % Window::NY, 0, Class::Terrain.id());
        }
        Self(grid)
    }

    fn stand(&mut self, x: usize, y: usize, class: Class, from_m: f64, to_m: f64) {
        for z in 0..Window::NZ {
            let middle = Window::center(0, 0, z).z;
            if middle >= from_m && middle <= to_m {
                self.0.set(x, y, z, class.id());
            }
        }
    }

    fn line(&mut self, ends: [(f64, f64); 2], class: Class, to_m: f64) {
        let points = ends.map(|(x, y)| DVec2::new(x, y));
        let mut cells = Vec::new();
        line_cells(crate::Extent::WINDOW, &points, 0.25, |x, y| cells.push((x, y)));
        cells
            .into_iter()
            .for_each(|(x, y)| self.stand(x, y, class, -1.0, to_m));
    }

    fn things(&self) -> Vec<Form> {
        let found = background(&self.0, &BevLayout::default());
        found.iter().map(|t| t.form.clone()).collect()
    }
}

#[test]
fn nothing_gives_nothing() {
    assert!(background(&VoxelGrid::new(), &BevLayout::default()).is_empty());
    assert!(Labels::new().things().is_empty());
}

/// Two facades that meet at a corner, nothing seen behind them: one building with straight walls.
#[test]
fn two_facades_are_one_building() {
    let mut labels = Labels::new();
    let outline = [(10.0, 10.0), (24.0, 10.0), (24.0, 20.0), (10.0, 20.0)].map(|(x, y)| DVec2::new(x, y));
    polygon_cells(crate::Extent::WINDOW, &outline, |x, y| {
        labels.0.set(x, y, 0, Class::FREE)
    });
    labels.line([(10.2, 10.2), (23.8, 10.2)], Class::Manmade, 4.0);
    labels.line([(10.2, 10.2), (10.2, 19.8)], Class::Manmade, 4.0);
    let found = labels.things();
    let [Form::Building(b)] = &found[..] else {
        panic!("{found:?}")
    };
    assert!((3.6..4.6).contains(&b.height_m), "{}", b.height_m);
    assert_eq!(b.outline_m.len(), 4);
    let (lo, hi) = found[0].bounds_m();
    assert!(lo.distance(DVec2::new(10.0, 10.0)) < 1.0, "{lo}");
    assert!(hi.distance(DVec2::new(24.0, 20.0)) < 1.5, "{hi}");
}

/// One long facade whose height changes is two buildings; one seen from the front only reaches back.
#[test]
fn a_step_in_height_parts_buildings() {
    let mut labels = Labels::new();
    let behind = [(-20.0, 8.2), (20.0, 8.2), (20.0, 18.0), (-20.0, 18.0)].map(|(x, y)| DVec2::new(x, y));
    polygon_cells(crate::Extent::WINDOW, &behind, |x, y| {
        labels.0.set(x, y, 0, Class::FREE)
    });
    labels.line([(-19.8, 8.2), (0.0, 8.2)], Class::Manmade, 3.0);
    labels.line([(0.2, 8.2), (19.8, 8.2)], Class::Manmade, 5.0);
    let found = labels.things();
    let heights: Vec<f64> = found.iter().map(Form::height_m).collect();
    assert_eq!(found.len(), 2, "{found:?}");
    assert!((heights[0] - heights[1]).abs() > 1.5, "{heights:?}");
    for form in &found {
        let (lo, hi) = form.bounds_m();
        assert!(lo.y < 8.5 && hi.y > 15.0, "{lo} {hi}");
    }
}

#[test]
fn low_long_and_thin_is_a_wall_and_one_column_a_pole() {
    let mut labels = Labels::new();
    labels.line([(-15.0, -9.0), (12.0, -9.0)], Class::Manmade, 1.5);
    labels.stand(150, 150, Class::Manmade, -1.0, 5.0);
    let found = labels.things();
    let lines: Vec<_> = found
        .iter()
        .filter(|f| matches!(f, Form::Line(l) if l.kind == LineKind::Wall))
        .collect();
    assert_eq!((lines.len(), found.len()), (1, 2), "{found:?}");
    let Form::Line(wall) = lines[0] else {
        unreachable!()
    };
    assert!(wall.points_m[0].distance(wall.points_m[1]) > 25.0);
    assert!(
        found
            .iter()
            .any(|f| matches!(f, Form::Post(p) if p.height_m > 4.0))
    );
}

/// Trees with stems, two crowns that touch among them, a hedge and a patch of shrubs.
#[test]
fn vegetation_becomes_trees_hedges_and_shrubs() {
    let mut labels = Labels::new();
    let places = [(10.0, 10.0), (13.4, 10.0), (-12.0, 14.0)].map(|(x, y)| DVec2::new(x, y));
    for p in places {
        disc_cells(crate::Extent::WINDOW, p, 1.8, |x, y| {
            labels.stand(x, y, Class::Vegetation, 2.0, 4.6)
        });
        disc_cells(crate::Extent::WINDOW, p, 0.25, |x, y| {
            labels.stand(x, y, Class::Vegetation, -1.0, 4.6)
        });
    }
    labels.line([(-30.0, -8.0), (-10.0, -8.0)], Class::Vegetation, 1.2);
    let patch = [(5.0, -20.0), (11.0, -20.0), (11.0, -15.0), (5.0, -15.0)].map(|(x, y)| DVec2::new(x, y));
    polygon_cells(crate::Extent::WINDOW, &patch, |x, y| {
        labels.stand(x, y, Class::Vegetation, -1.0, 0.6)
    });
    let found = labels.things();
    let trees: Vec<&crate::background::Tree> = found
        .iter()
        .filter_map(|f| if let Form::Tree(t) = f { Some(t) } else { None })
        .collect();
    assert_eq!(trees.len(), 3, "{found:?}");
    for p in places {
        let near = trees
            .iter()
            .find(|t| t.position_m.distance(p) < 0.6)
            .expect("a tree there");
        assert!((1.2..2.4).contains(&near.crown_radius_m) && (4.0..5.4).contains(&near.height_m));
    }
    let count = |name: &str| found.iter().filter(|f| f.name() == name).count();
    assert_eq!(
        (count("hedge"), count("shrubs"), found.len()),
        (1, 1, 5),
        "{found:?}"
    );
}
