//! Rule books of sparse convolutions: which sites feed which rows, computed once for a set of sites. One form serves
//! submanifold, strided and transposed convolution (Graham et al. 2018, arXiv 1711.10275).

use rayon::prelude::*;

/// Sites that are worked on together.
pub(crate) const PIECE: usize = 256;

/// Sources of the rows of a sparse convolution.
pub struct RuleBook {
    rows: usize,
    pieces: Vec<Piece>,
}

/// [`PIECE`] rows: pairs [row of the piece, site], tap by tap.
pub(crate) struct Piece {
    ends: Vec<u32>, // of each tap's pairs
    pairs: Vec<[u32; 2]>,
}

impl RuleBook {
    /// The rule book of `rows` rows of `taps` taps each; `source(row, tap)` is the site there, `sites` or more for
    /// none.
    pub fn new(rows: usize, taps: usize, sites: usize, source: impl Fn(usize, usize) -> u32 + Sync) -> Self {
        let piece = |room: &mut Vec<[u32; 2]>, first: usize| {
            let last = (first + PIECE).min(rows);
            room.resize(PIECE * taps, [0; 2]);
            let (mut ends, mut n) = (Vec::with_capacity(taps), 0);
            for tap in 0..taps {
                for row in first..last {
                    // Written without a branch that would have to be predicted: entries of missing sites are
                    // overwritten.
                    let site = source(row, tap);
                    room[n] = [(row - first) as u32, site];
                    n += usize::from((site as usize) < sites);
                }
                ends.push(n as u32);
            }
            Piece {
                ends,
                pairs: room[..n].to_vec(),
            }
        };
        let firsts: Vec<usize> = (0..rows).step_by(PIECE).collect();
        let pieces = firsts.into_par_iter().map_init(Vec::new, piece).collect();
        Self { rows, pieces }
    }

    /// A rule book without rows.
    pub fn none() -> Self {
        Self {
            rows: 0,
            pieces: Vec::new(),
        }
    }

    /// Rows of the output of a convolution.
    pub fn rows(&self) -> usize {
        self.rows
    }

    /// Its pieces, in order.
    pub(crate) fn pieces(&self) -> &[Piece] {
        &self.pieces
    }

    /// All pairs [row, site] of a tap, in order.
    pub fn pairs(&self, tap: usize) -> impl Iterator<Item = [u32; 2]> + '_ {
        self.pieces.iter().enumerate().flat_map(move |(i, piece)| {
            let first = (i * PIECE) as u32;
            piece.tap(tap).iter().map(move |[row, site]| [first + row, *site])
        })
    }
}

impl Piece {
    /// Pairs of a tap.
    pub(crate) fn tap(&self, tap: usize) -> &[[u32; 2]] {
        let from = if tap == 0 { 0 } else { self.ends[tap - 1] };
        &self.pairs[from as usize..self.ends[tap] as usize]
    }
}
