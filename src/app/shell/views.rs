//! The views and the panes around them.

use std::collections::BTreeMap;

use egui::Rect;

use super::dock::Dock;
use super::workspace::Workspace;
use crate::canvas::BevCanvas;
use crate::panes;
use crate::panes::camera_strip::CameraStrip;
use crate::panes::compare::Compare;
use crate::panes::pane::Pane;
use crate::panes::prompt::field::PromptField;
use crate::seen::SeenScenes;
use crate::view3d::View3d;
use crate::views_shown::ViewsShown;
use scene::{Extent, SceneBox};
use viewport::ViewOptions;

/// Owner of all views of the scene.
pub struct Views {
    /// The bird's-eye view.
    pub canvas: BevCanvas,
    /// The 3D view.
    pub view3d: View3d,
    pub(crate) strip: CameraStrip,
    /// The prompt field.
    pub prompt: PromptField,
    pub(crate) panes: Vec<Box<dyn Pane>>,
    pub(crate) dock: Dock,
    /// The docks of the other workspaces, as they were left.
    left: BTreeMap<Workspace, Dock>,
    pub(crate) compare: Compare,
    pub(crate) seen: SeenScenes,
    pub(crate) render_state: Option<egui_wgpu::RenderState>,
    /// The area between the bars, for the panes, in the last frame.
    pub(crate) center: Rect,
    /// The view settings before the views were cleaned.
    pub(crate) before_clean: Option<Box<BeforeClean>>,
}

/// View settings that are restored after a clean view.
pub(crate) struct BeforeClean {
    pub(crate) shown: ViewsShown,
    pub(crate) options: ViewOptions,
    pub(crate) paths: bool,
}

impl Views {
    /// Changes the workspace. The panes of another workspace stand as they were left; choosing the same workspace again
    /// resets its panes.
    pub fn change_workspace(&mut self, from: Workspace, to: Workspace) {
        let next = match from == to {
            true => None,
            false => self.left.remove(&to),
        };
        let before = std::mem::replace(&mut self.dock, next.unwrap_or_else(|| Dock::workspace(to)));
        if from != to {
            self.left.insert(from, before);
        }
    }

    /// Views with the panes of a dock.
    pub fn new(view3d: View3d, dock: Dock, render_state: Option<egui_wgpu::RenderState>) -> Self {
        Self {
            canvas: BevCanvas::default(),
            view3d,
            strip: CameraStrip::default(),
            prompt: PromptField::default(),
            panes: panes::all(),
            dock,
            left: BTreeMap::new(),
            compare: Compare::default(),
            seen: SeenScenes::default(),
            render_state,
            center: Rect::NOTHING,
            before_clean: None,
        }
    }

    /// Drops all pictures, because colours have changed.
    pub(crate) fn forget_pictures(&mut self) {
        self.canvas.forget_pictures();
        self.strip = CameraStrip::default();
        self.view3d.forget_pictures();
    }

    /// Centres a box in both large views.
    pub(crate) fn frame_box(&mut self, b: &SceneBox) {
        self.canvas.frame_box(b);
        self.view3d.frame_box(b);
    }

    /// Fits the whole map into both large views.
    pub(crate) fn frame_all(&mut self, extent: Extent) {
        self.view3d.frame_map(extent);
        self.canvas.frame_all_again();
    }
}
