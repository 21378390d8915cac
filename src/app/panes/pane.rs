//! The trait of a pane, and the context that it draws from.

use std::sync::Arc;

use egui::Ui;

use editor::Document;
use job::GenParams;
use scene::Scene;

use super::camera_strip::CameraStrip;
use super::compare::Compare;
use super::id::PaneId;
use super::prompt::field::PromptField;
use crate::canvas::BevCanvas;
use crate::command::Command;
use crate::seen::SeenScene;
use crate::sensing::Sensing;
use crate::shell::checking::Checking;
use crate::shell::live::Bounds;
use crate::shell::tuning::Tuning;
use crate::shell::versions::Versions;
use crate::state::UiState;
use crate::view3d::View3d;
use language::t;
use widgets::icons::Icon;

/// Place where a pane opens that is not in the dock yet.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PanePlacement {
    /// Below the largest view.
    BelowView,
    /// Below the row of large views, so that it hides no part of them.
    BelowViews,
    /// In the column of the panes with lists and numbers.
    Column,
    /// In that column too, and a layout that was saved before this pane existed gains it.
    ColumnAtOnce,
}

impl PanePlacement {
    /// True if the place is in the column of the panes with lists and numbers.
    pub fn is_column(self) -> bool {
        matches!(self, PanePlacement::Column | PanePlacement::ColumnAtOnce)
    }
}

/// Description of a pane, known before it is drawn.
#[derive(Clone, Debug)]
pub struct PaneInfo {
    /// Its id in files.
    pub id: PaneId,
    /// Its title for the user.
    pub title: String,
    /// Icon beside its title in menus.
    pub icon: Icon,
    /// Place where it opens.
    pub place: PanePlacement,
    /// Width that a column of such panes needs for its texts, points; 0 for views, which take any.
    pub column_points: f32,
}

/// Context of every pane: the scene on screen, and the parts of the program that panes show or change.
pub struct PaneContext<'a> {
    /// The scene on screen: the document's, a preview of its generation, or the reference state.
    pub scene: &'a Arc<Scene>,
    /// The scene as the large views show it, without hidden objects.
    pub seen: SeenScene,
    /// The document that is edited.
    pub document: &'a Document,
    /// Tools, layers, options.
    pub state: &'a mut UiState,
    /// The bird's-eye view.
    pub canvas: &'a mut BevCanvas,
    /// The 3D view.
    pub view3d: &'a mut View3d,
    /// The strip of camera pictures.
    pub strip: &'a mut CameraStrip,
    /// The prompt field and the reading of its words.
    pub prompt: &'a mut PromptField,
    /// The reference state.
    pub compare: &'a mut Compare,
    /// Versions generated so far.
    pub versions: &'a mut Versions,
    /// The quality slider.
    pub tuning: &'a mut Tuning,
    /// The newest results of the sensors.
    pub sensing: &'a Sensing,
    /// Findings of the quality checks.
    pub checking: &'a Checking,
    /// Parameters of generation after an edit.
    pub params: &'a GenParams,
    /// Regions that are still to be generated.
    pub unsettled: &'a Arc<[Bounds]>,
    /// A generation runs.
    pub generating: bool,
    /// The graphics device, if there is one.
    pub render_state: Option<&'a egui_wgpu::RenderState>,
}

/// One pane of the window. It keeps state that only itself needs; the rest comes with the context.
pub trait Pane {
    /// Its id in files.
    fn id(&self) -> PaneId;

    /// Its title for the user.
    fn title(&self) -> String;

    /// Its title for a scene, in the language of the interface. A camera pane shows the name that the rig gives its
    /// camera.
    fn title_in(&self, _scene: &Scene) -> String {
        t(&self.title()).to_owned()
    }

    /// Icon beside its title in menus.
    fn icon(&self) -> Icon;

    /// Place where it opens.
    fn place(&self) -> PanePlacement {
        PanePlacement::BelowView
    }

    /// Width that a column of such panes needs for its texts, points; 0 for views, which take any.
    fn column_points(&self) -> f32 {
        0.0
    }

    /// True if it shows the reference state while the key for that is held.
    fn shows_before(&self) -> bool {
        false
    }

    /// Draws the controls of its header, from right to left.
    fn controls(&mut self, _ui: &mut Ui, _cx: &mut PaneContext<'_>, _commands: &mut Vec<Command>) {}

    /// Draws the pane below its header.
    fn ui(&mut self, ui: &mut Ui, cx: &mut PaneContext<'_>, commands: &mut Vec<Command>);
}
