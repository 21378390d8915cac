//! Labels with everything at its true height, and back. Labels of Occ3D have the ground two bins below where it is, and every
//! other thing reaches two bins further down than it is ([`Lattice::lowered`]); most other data sets have things where they
//! are.

use super::Lattice;
use crate::Class;
use crate::solid::fill::smear_down;

impl Lattice {
    /// Bins of a column with everything at its true height: those of the lattice, and as many above as labels let it down.
    pub fn true_bins(&self) -> usize {
        self.bins() + self.lowered()
    }
}

/// Labels of a column at their true height, from labels of a lattice: ground goes up, and every other thing loses its lowest
/// bins. Where such a thing is no higher than those bins, its highest bin is kept; one that stands on the ground or on the
/// bottom of the grid stays on it. `out` has [`Lattice::true_bins`].
pub fn raise(lattice: Lattice, column: &[u8], out: &mut [u8]) {
    let by = lattice.lowered();
    out.fill(Class::FREE);
    if by == 0 {
        out.copy_from_slice(column);
        return;
    }
    for (z, label) in column.iter().enumerate().filter(|(_, label)| is_ground(**label)) {
        out[z + by] = *label;
    }
    let is_thing = |z: usize| column[z] != Class::FREE && !is_ground(column[z]);
    let mut next = 0;
    while next < column.len() {
        let from = next;
        while next < column.len() && is_thing(next) {
            next += 1;
        }
        let stands = from == 0 || is_ground(column[from - 1]);
        match next - from {
            0 => next += 1,
            height if height <= by => {
                let least = if stands { from + by } else { next - 1 };
                // Above the ground that was raised.
                let at = (least..out.len()).find(|z| !is_ground(out[*z]));
                if let Some(at) = at.filter(|at| out[*at] == Class::FREE) {
                    out[at] = column[next - 1];
                }
            }
            _ => out[from + by..next].copy_from_slice(&column[from + by..next]),
        }
    }
}

/// Labels of a lattice from a column at true heights, the inverse of [`raise`], in place. Things that end above the lattice's
/// top are cut off there: the labels are its first [`Lattice::bins`].
pub fn lower(lattice: Lattice, column: &mut [u8]) {
    let by = lattice.lowered();
    if by == 0 {
        return;
    }
    let raised = column.to_vec();
    for label in column.iter_mut().filter(|label| is_ground(**label)) {
        *label = Class::FREE;
    }
    smear_down(column, by);
    for (z, label) in raised.iter().enumerate().filter(|(_, label)| is_ground(**label)) {
        let place = &mut column[z.saturating_sub(by)];
        if *place == Class::FREE {
            *place = *label;
        }
    }
}

fn is_ground(label: u8) -> bool {
    Class::from_id(label).is_some_and(Class::is_ground)
}
