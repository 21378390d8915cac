//! Correspondence of squares between the frames of a drive: which part of one frame lies where a part of another does.
//! The temporal networks attend along it.

use glam::DVec2;
use rayon::prelude::*;

/// Half of the window's side, m.
const HALF_M: f64 = 40.0;

/// Numbers that describe the offset of a pair of squares in place, heading and time.
pub(crate) const OFFSETS: usize = 8;

/// The squares that a window is divided into, and which of them belong together.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Squares {
    /// Squares along each side.
    side: usize,
    /// True if squares of the same number belong together, instead of those at the same place of the world.
    same: bool,
}

impl Squares {
    /// Tokens of the transformer, 3.2 m.
    pub const TOKENS: Self = Self {
        side: 25,
        same: false,
    };
    /// Cells of a latent, 1.6 m.
    pub const CELLS: Self = Self {
        side: super::SIDE,
        same: false,
    };

    /// These squares. If `same`, squares of the same number belong together, wherever the vehicle is; otherwise those
    /// at the same place of the world.
    pub fn by_number(self, same: bool) -> Self {
        Self { same, ..self }
    }
}

/// The square of the other frame, and the offsets.
pub(crate) type Pair = (u16, [f32; OFFSETS]);

/// Correspondence of the squares of all pairs of frames.
#[derive(Clone, Debug, PartialEq)]
pub struct Between {
    frames: usize,
    squares: usize,
    /// `[frame][other frame][square]`; `None` where the place is out of sight.
    pairs: Vec<Option<Pair>>,
}

impl Between {
    /// Correspondence for frames whose vehicles stand at these places (x and y in m, heading in rad) every `step_s`
    /// seconds.
    pub fn of(poses: &[[f64; 3]], step_s: f64, Squares { side, same }: Squares) -> Self {
        let (frames, squares) = (poses.len(), side * side);
        let size_m = 2.0 * HALF_M / side as f64;
        let turns: Vec<DVec2> = poses.iter().map(|p| DVec2::from_angle(p[2])).collect();
        let at = |pose: &[f64; 3]| DVec2::new(pose[0], pose[1]);
        let pair = |t: usize, s: usize, square: usize| {
            let own = DVec2::new((square / side) as f64, (square % side) as f64);
            let p = (own + 0.5) * size_m - HALF_M;
            let world = turns[t].rotate(p) + at(&poses[t]);
            // (the inverse of a turn by an angle is its conjugate)
            let back = DVec2::new(turns[s].x, -turns[s].y);
            let place = (back.rotate(world - at(&poses[s])) + HALF_M) / size_m;
            let cell = if same { own } else { place.floor() };
            // Written so that NaN fails too.
            let seen = cell.cmpge(DVec2::ZERO).all() && cell.cmplt(DVec2::splat(side as f64)).all();
            if !seen {
                return None;
            }
            let index = cell.x as usize * side + cell.y as usize;
            let aside = (place - cell - 0.5).clamp(DVec2::splat(-1.0), DVec2::splat(1.0));
            let turned = poses[t][2] - poses[s][2];
            let apart_s = (t as f64 - s as f64) * step_s;
            let itself = if t == s { 1.0 } else { 0.0 };
            let offsets = [
                aside.x,
                aside.y,
                turned.cos(),
                turned.sin(),
                apart_s / 2.0,
                apart_s.abs() / 2.0,
                itself,
                1.0,
            ];
            Some((index as u16, offsets.map(|v| v as f32)))
        };
        let all = (0..frames * frames * squares).into_par_iter();
        let pairs = all.map(|i| pair(i / (frames * squares), i / squares % frames, i % squares));
        Self {
            frames,
            squares,
            pairs: pairs.collect(),
        }
    }

    /// Number of frames.
    pub(crate) fn frames(&self) -> usize {
        self.frames
    }

    /// Number of squares of a frame.
    pub(crate) fn squares(&self) -> usize {
        self.squares
    }

    /// The square of frame `s` where a square of frame `t` lies.
    pub(crate) fn at(&self, t: usize, s: usize, square: usize) -> Option<&Pair> {
        self.pairs[(t * self.frames + s) * self.squares + square].as_ref()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const TOKEN_M: f64 = 3.2;

    #[test]
    fn the_token_of_another_frame_lies_at_the_same_place() {
        // The second frame stands two tokens farther ahead; the third is turned by a quarter.
        let quarter = std::f64::consts::FRAC_PI_2;
        let poses = [[0.0; 3], [2.0 * TOKEN_M, 0.0, 0.0], [0.0, 0.0, quarter]];
        let between = Between::of(&poses, 0.5, Squares::TOKENS);
        let token = |x: usize, y: usize| x * 25 + y;
        let (index, offset) = between.at(0, 1, token(10, 7)).expect("in sight");
        assert_eq!(usize::from(*index), token(8, 7));
        assert_eq!(offset, &[0.0, 0.0, 1.0, 0.0, -0.25, 0.25, 0.0, 1.0]);
        assert!(between.at(0, 1, token(1, 7)).is_none(), "out of sight");
        let (index, offset) = between.at(0, 2, token(20, 12)).expect("in sight");
        assert_eq!(usize::from(*index), token(12, 4));
        assert!((offset[3] + 1.0).abs() < 1e-6);
        assert!(
            between
                .at(1, 1, 3)
                .is_some_and(|p| usize::from(p.0) == 3 && p.1[6] == 1.0)
        );
        let lost = Between::of(&[[0.0; 3], [f64::NAN; 3]], 0.5, Squares::TOKENS);
        assert!(lost.at(0, 1, 0).is_none());
        let far = [[0.0; 3], [90.0, 0.0, 0.0]];
        let same = Between::of(&far, 0.5, Squares::TOKENS.by_number(true));
        assert!(
            same.at(0, 1, 5)
                .is_some_and(|p| usize::from(p.0) == 5 && p.1[0] == -1.0)
        );
    }

    #[test]
    fn cells_are_half_as_large() {
        let between = Between::of(&[[0.0; 3], [3.2, 0.0, 0.0]], 0.5, Squares::CELLS);
        let found = between.at(0, 1, 20 * 50 + 7).expect("in sight");
        assert_eq!(usize::from(found.0), 18 * 50 + 7);
        assert!(found.1[0].abs() < 1e-6, "{}", found.1[0]);
    }
}
