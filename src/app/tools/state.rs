//! What the tools hold between two frames: the hand of the editor, and what only the window knows of.

use std::ops::{Deref, DerefMut};

use editor::Shape;
use editor::tools::{Area, DRAW_ORDER, Hand};
use glam::DVec2;
use job::GenParams;
use job::redraw::RedrawMask;

use crate::scenery::Drawer;

/// What is drawn anew has no inverted noise that already holds most of it.
const FEWEST_STEPS_ANEW: u32 = 10;

/// What the tools hold. It is a [`Hand`] with more.
#[derive(Clone, Debug)]
pub struct ToolState {
    /// The tool in hand, what is chosen, the options of the tools.
    pub hand: Hand,
    /// Cells to be drawn anew although nothing was edited there.
    pub region: RedrawMask,
    /// How often cells were drawn anew: each time other noise.
    pub region_draws: u64,
    /// What draws scenery.
    pub drawer: Drawer,
    /// Times that scenery was drawn.
    pub scenery_draws: u64,
    /// Opacity of each map layer over what lies below it, in draw order, 0 to 1.
    pub layer_opacity: [f32; DRAW_ORDER.len()],
    /// Opacity of all map layers together over voxels, 0 to 1.
    pub layers_opacity: f32,
    /// Layers shown before one was shown alone.
    pub before_solo: Option<u32>,
    /// Where the pointer is over the bird's-eye view, ego frame, m.
    pub pointer_m: Option<DVec2>,
}

impl Default for ToolState {
    fn default() -> Self {
        Self {
            hand: Hand::default(),
            region: RedrawMask::default(),
            region_draws: 0,
            drawer: Drawer::Rules(None),
            scenery_draws: 0,
            layer_opacity: [1.0; DRAW_ORDER.len()],
            layers_opacity: 0.5,
            before_solo: None,
            pointer_m: None,
        }
    }
}

impl Deref for ToolState {
    type Target = Hand;

    fn deref(&self) -> &Hand {
        &self.hand
    }
}

impl DerefMut for ToolState {
    fn deref_mut(&mut self) -> &mut Hand {
        &mut self.hand
    }
}

impl ToolState {
    /// Makes parameters draw the region anew.
    pub fn draw_anew(&mut self, params: &mut GenParams) {
        self.region_draws += 1;
        params.redraw = self.region;
        params.strength = self.region_strength;
        params.steps = params.steps.max(FEWEST_STEPS_ANEW);
        params.seed = params.seed.wrapping_add(self.region_draws);
    }

    /// Marks an area to be drawn anew, or takes the mark away.
    pub fn mark(&mut self, area: &Area, on: bool) {
        let cells = match area {
            Area::Rect(a_m, b_m) => RedrawMask::of_rect(*a_m, *b_m),
            Area::Outline(points_m) => RedrawMask::of_outline(points_m),
            Area::Stroke(a_m, b_m, width_m) => {
                let stroke = Shape::Line {
                    points_m: vec![*a_m, *b_m],
                    width_m: *width_m,
                };
                // A stroke beside the grid marks nothing.
                self.region.set_columns(&stroke.cells().unwrap_or_default(), on);
                return;
            }
            Area::All => {
                let corner_m = DVec2::splat(scene::GridSpec::MAX_M[0]);
                RedrawMask::of_rect(-corner_m, corner_m)
            }
        };
        for [i, j] in cells.cells() {
            self.region.set(i, j, on);
        }
    }
}
