//! Groups of cells that a network computes separately.

/// Divides the cells of a square map into groups that are computed separately. Cells that touch are in one group, and
/// so are groups whose rectangles, `reach` cells wider on every side, take no more together than apart. Two edits far
/// from each other thus cost the sum of both, without the cells between them.
pub fn pieces(cells: &[bool], reach: usize) -> Vec<Vec<bool>> {
    let side = cells.len().isqrt();
    let mut groups: Vec<(Vec<bool>, [usize; 4])> = Vec::new(); // with x0, y0, x1, y1
    let mut seen = vec![false; cells.len()];
    for start in (0..cells.len()).filter(|c| cells[*c]) {
        if seen[start] {
            continue;
        }
        let (mut group, mut open) = (vec![false; cells.len()], vec![start]);
        let mut rect = [start / side, start % side, start / side, start % side];
        seen[start] = true;
        while let Some(at) = open.pop() {
            group[at] = true;
            let (x, y) = (at / side, at % side);
            rect = [rect[0].min(x), rect[1].min(y), rect[2].max(x), rect[3].max(y)];
            for i in x.saturating_sub(1)..(x + 2).min(side) {
                for j in y.saturating_sub(1)..(y + 2).min(side) {
                    let next = i * side + j;
                    if cells[next] && !std::mem::replace(&mut seen[next], true) {
                        open.push(next);
                    }
                }
            }
        }
        groups.push((group, rect));
    }
    let cost = |r: [usize; 4]| {
        let along = |lo: usize, hi: usize| (hi + reach + 1).min(side) - lo.saturating_sub(reach);
        along(r[0], r[2]) * along(r[1], r[3])
    };
    let union =
        |a: [usize; 4], b: [usize; 4]| [a[0].min(b[0]), a[1].min(b[1]), a[2].max(b[2]), a[3].max(b[3])];
    let mut i = 0;
    while i < groups.len() {
        let a = groups[i].1;
        let other = (i + 1..groups.len()).find(|&j| {
            let b = groups[j].1;
            cost(union(a, b)) <= cost(a) + cost(b)
        });
        match other {
            Some(j) => {
                let (cells, rect) = groups.swap_remove(j);
                groups[i].0.iter_mut().zip(cells).for_each(|(into, c)| *into |= c);
                groups[i].1 = union(a, rect);
                // The larger one may reach others, also those before it.
                i = 0;
            }
            None => i += 1,
        }
    }
    groups.into_iter().map(|g| g.0).collect()
}
