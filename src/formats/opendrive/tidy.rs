//! Small gaps in drivable ground, closed. Grids are `[x][y]`, one flag per cell.

use scene::Extent;

const SIDES: [(i64, i64); 4] = [(-1, 0), (1, 0), (0, -1), (0, 1)];
const AROUND: [(i64, i64); 9] = [
    (-1, -1),
    (-1, 0),
    (-1, 1),
    (0, -1),
    (0, 0),
    (0, 1),
    (1, -1),
    (1, 0),
    (1, 1),
];

/// A larger island in a junction is meant, cells (9.6 m2).
const LARGEST_HOLE: usize = 60;

/// Morphological closing by one cell. Cells that are `named` by a lane of the file (a median, a kerb) are not changed.
pub(super) fn close_gaps(extent: Extent, drivable: &mut [bool], named: &[bool]) {
    let grown: Vec<bool> = (0..drivable.len())
        .map(|i| neighbours(extent, i, &AROUND).flatten().any(|n| drivable[n]))
        .collect();
    for i in 0..drivable.len() {
        drivable[i] |= !named[i] && neighbours(extent, i, &AROUND).flatten().all(|n| grown[n]);
    }
}

/// Paves the small patches that the connecting roads of a junction leave between them.
pub(super) fn fill_junction_holes(
    extent: Extent,
    drivable: &mut [bool],
    named: &[bool],
    in_junction: &[bool],
) {
    let mut seen = drivable.to_vec();
    for first in 0..drivable.len() {
        if std::mem::replace(&mut seen[first], true) {
            continue;
        }
        let (mut patch, mut at_junction, mut stays) = (vec![first], false, false);
        let mut next = 0;
        while next < patch.len() {
            let cell = patch[next];
            next += 1;
            stays |= named[cell];
            for neighbour in neighbours(extent, cell, &SIDES) {
                match neighbour {
                    None => stays = true, // cut by the window: its size is not known
                    Some(n) if drivable[n] => at_junction |= in_junction[n],
                    Some(n) if !seen[n] => {
                        seen[n] = true;
                        patch.push(n);
                    }
                    Some(_) => {}
                }
            }
        }
        if at_junction && !stays && patch.len() <= LARGEST_HOLE {
            patch.into_iter().for_each(|cell| drivable[cell] = true);
        }
    }
}

/// The cells at these steps from one; `None` for those outside of the map.
fn neighbours(extent: Extent, cell: usize, steps: &[(i64, i64)]) -> impl Iterator<Item = Option<usize>> {
    let [x, y] = extent.column(cell).map(|n| n as i64);
    steps.iter().map(move |(dx, dy)| {
        let (x, y) = (x + dx, y + dy);
        let inside = (0..extent.nx() as i64).contains(&x) && (0..extent.ny() as i64).contains(&y);
        inside.then(|| extent.index(x as usize, y as usize))
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use scene::Window;

    fn at(x: usize, y: usize) -> usize {
        x * Window::NY + y
    }

    #[test]
    fn cracks_close_and_named_cells_stay() {
        let mut drivable = vec![true; Window::COLUMNS];
        let mut named = vec![false; Window::COLUMNS];
        for x in 0..Window::NX {
            for y in [20, 50, 80, 81, 82, 83] {
                drivable[at(x, y)] = false;
            }
            named[at(x, 50)] = true;
        }
        close_gaps(Extent::WINDOW, &mut drivable, &named);
        assert!(
            (0..Window::NX).all(|x| drivable[at(x, 20)]),
            "a crack closes, to the edge of the window"
        );
        assert!((0..Window::NX).all(|x| !drivable[at(x, 50)]), "a median stays");
        assert!((0..Window::NX).all(|x| !drivable[at(x, 81)]), "a wide gap stays");
    }

    #[test]
    fn only_small_holes_of_junctions_fill() {
        let mut drivable = vec![true; Window::COLUMNS];
        let mut in_junction = vec![false; Window::COLUMNS];
        let hole = |grid: &mut Vec<bool>, x0: usize, size: usize| {
            (x0..x0 + size).for_each(|x| (50..50 + size).for_each(|y| grid[at(x, y)] = false));
        };
        hole(&mut drivable, 20, 5); // away from the junction
        hole(&mut drivable, 60, 5);
        hole(&mut drivable, 100, 20); // an island
        hole(&mut drivable, 195, 5); // cut by the window
        (at(50, 0)..Window::COLUMNS).for_each(|i| in_junction[i] = true);
        fill_junction_holes(
            Extent::WINDOW,
            &mut drivable,
            &vec![false; Window::COLUMNS],
            &in_junction,
        );
        assert_eq!(
            [22, 62, 110, 197].map(|x| drivable[at(x, 52)]),
            [false, true, false, false]
        );
    }
}
