//! State of the tools between two frames: the hand of the editor, and state that only the window has.

use std::ops::{Deref, DerefMut};

use editor::tools::{DRAW_ORDER, Hand, InpaintArea, Toolbox};
use editor::{Edit, Shape};
use glam::DVec2;
use job::GenParams;
use job::inpaint::InpaintMask;
use scene::Scene;

use crate::scenery::SceneryMethod;

/// Least steps of an inpainting: it starts from fresh noise, without the inverted noise that already holds most of the
/// result.
const FEWEST_INPAINT_STEPS: u32 = 10;

/// The tools and their state. It dereferences to a [`Hand`].
#[derive(Clone, Debug)]
pub struct ToolState {
    /// The tools themselves.
    pub toolbox: Toolbox,
    /// The tool in hand, the selection, and the options of the tools.
    pub hand: Hand,
    /// Latent cells that are marked to be inpainted.
    pub region: InpaintMask,
    /// True if words change only objects in that region.
    pub words_within: bool,
    /// Number of inpaintings so far; each one uses other noise.
    pub times_inpainted: u64,
    /// The method that draws scenery.
    pub drawer: SceneryMethod,
    /// Number of times that scenery was drawn.
    pub scenery_draws: u64,
    /// Opacity of each map layer over the layers below it, in draw order, 0 to 1.
    pub layer_opacity: [f32; DRAW_ORDER.len()],
    /// Opacity of all map layers together over voxels, 0 to 1.
    pub layers_opacity: f32,
    /// Layers shown before one layer was shown alone.
    pub before_solo: Option<u32>,
    /// Position of the pointer over the bird's-eye view, ego frame, m.
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
            drawer: SceneryMethod::Rules(None),
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
    /// The edits limited to the marked region, and the number of objects that this leaves out; see
    /// [`within`](editor::within).
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

    /// Sets parameters so that they inpaint the region.
    pub fn inpaint_region(&mut self, params: &mut GenParams) {
        self.times_inpainted += 1;
        params.inpaint = self.region.clone();
        params.strength = self.region_strength;
        params.steps = params.steps.max(FEWEST_INPAINT_STEPS);
        params.seed = params.seed.wrapping_add(self.times_inpainted);
    }

    /// Marks an area of the map to be inpainted, or removes the mark.
    pub fn mark(&mut self, extent: scene::Extent, area: &InpaintArea, on: bool) {
        let cells = match area {
            InpaintArea::Rect(a_m, b_m) => InpaintMask::of_rect(extent, *a_m, *b_m),
            InpaintArea::Outline(points_m) => InpaintMask::of_outline(extent, points_m),
            InpaintArea::Stroke(a_m, b_m, width_m) => {
                let stroke = Shape::Line {
                    points_m: vec![*a_m, *b_m],
                    width_m: *width_m,
                };
                // A stroke outside the map marks no cell.
                self.region
                    .set_columns(extent, &stroke.cells(extent).unwrap_or_default(), on);
                return;
            }
            InpaintArea::All => {
                let (low, high) = (extent.min_m().truncate(), extent.max_m().truncate());
                InpaintMask::of_rect(extent, low, high)
            }
        };
        for cell in cells.cells() {
            self.region.set(cell, on);
        }
    }
}
