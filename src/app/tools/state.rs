//! What the tools hold between two frames: the hand of the editor, and what only the window knows of.

use std::ops::{Deref, DerefMut};

use editor::tools::{Area, DRAW_ORDER, Hand, Toolbox};
use editor::{Edit, Shape};
use glam::DVec2;
use job::GenParams;
use job::inpaint::InpaintMask;
use scene::Scene;

use crate::scenery::Drawer;

/// What is inpainted from fresh noise has no inverted noise that already holds most of it.
const FEWEST_INPAINT_STEPS: u32 = 10;

/// The tools and what they hold. It is a [`Hand`] with more.
#[derive(Clone, Debug)]
pub struct ToolState {
    /// The tools themselves.
    pub toolbox: Toolbox,
    /// The tool in hand, what is chosen, the options of the tools.
    pub hand: Hand,
    /// Cells to inpaint although nothing was edited there.
    pub region: InpaintMask,
    /// Words change only what lies in that region.
    pub words_within: bool,
    /// How often cells were inpainted: each time from other noise.
    pub times_inpainted: u64,
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
            toolbox: Toolbox::default(),
            hand: Hand::default(),
            region: InpaintMask::default(),
            words_within: false,
            times_inpainted: 0,
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
    /// Edits as far as they are of the marked region, and how many objects they leave out; see [`within`](editor::within).
    pub fn within_region(&self, scene: &Scene, edits: Vec<Edit>) -> (Vec<Edit>, usize) {
        let extent = scene.frame().extent();
        let columns = extent
            .all_columns()
            .filter(|c| self.region.has_column(extent, *c));
        let (count, sum) = columns.fold((0.0, DVec2::ZERO), |(n, sum), [x, y]| {
            (n + 1.0, sum + extent.center(x, y, 0).truncate())
        });
        let inside = |p: DVec2| {
            let column = extent.column_at(p.x, p.y);
            column.is_some_and(|c| self.region.has_column(extent, c))
        };
        match count > 0.0 {
            true => editor::within::within(scene, edits, &inside, sum / count),
            false => (edits, 0),
        }
    }

    /// Makes parameters inpaint the region.
    pub fn inpaint_region(&mut self, params: &mut GenParams) {
        self.times_inpainted += 1;
        params.inpaint = self.region.clone();
        params.strength = self.region_strength;
        params.steps = params.steps.max(FEWEST_INPAINT_STEPS);
        params.seed = params.seed.wrapping_add(self.times_inpainted);
    }

    /// Marks an area of a map to inpaint, or takes the mark away.
    pub fn mark(&mut self, extent: scene::Extent, area: &Area, on: bool) {
        let cells = match area {
            Area::Rect(a_m, b_m) => InpaintMask::of_rect(extent, *a_m, *b_m),
            Area::Outline(points_m) => InpaintMask::of_outline(extent, points_m),
            Area::Stroke(a_m, b_m, width_m) => {
                let stroke = Shape::Line {
                    points_m: vec![*a_m, *b_m],
                    width_m: *width_m,
                };
                // A stroke beside the map marks nothing.
                self.region
                    .set_columns(extent, &stroke.cells(extent).unwrap_or_default(), on);
                return;
            }
            Area::All => {
                let (low, high) = (extent.min_m().truncate(), extent.max_m().truncate());
                InpaintMask::of_rect(extent, low, high)
            }
        };
        for cell in cells.cells() {
            self.region.set(cell, on);
        }
    }
}
