//! What a pane is, and what it is given to draw from.

use std::sync::Arc;

use egui::Ui;

use editor::Document;
use job::GenParams;
use scene::Scene;

use super::camera_strip::CameraStrip;
use super::compare::Compare;
use super::id::PaneId;
use super::prompt::field::PromptField;
use crate::canvas::Canvas;
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

/// Where a pane opens that is nowhere yet.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Place {
    /// Below the largest view.
    BelowView,
    /// Under the row of large views, so that it hides nothing of what it speaks of.
    BelowViews,
    /// In the column of the panes with lists and numbers.
    Column,
    /// There too, and a layout that was kept before there was this pane gains it.
    ColumnAtOnce,
}

impl Place {
    /// True if it is in the column of the panes with lists and numbers.
    pub fn is_column(self) -> bool {
        matches!(self, Place::Column | Place::ColumnAtOnce)
    }
}

/// What there is to know about a pane before it is drawn.
#[derive(Clone, Debug)]
pub struct PaneInfo {
    /// Its name in files.
    pub id: PaneId,
    /// Its name for a person.
    pub title: String,
    /// Stands beside its name in menus.
    pub icon: Icon,
    /// Where it opens.
    pub place: Place,
    /// Width that a column of such panes needs for its texts, points; 0 for views, which take any.
    pub column_points: f32,
}

/// What every pane is given: the scene on screen, and the parts of the program that panes show or change.
pub struct PaneContext<'a> {
    /// The scene on screen: the document's, a preview of its generation, or the one before.
    pub scene: &'a Arc<Scene>,
    /// What the large views show of it: without what is hidden.
    pub seen: SeenScene,
    /// What is edited.
    pub document: &'a Document,
    /// Tools, layers, options.
    pub state: &'a mut UiState,
    /// The bird's-eye view.
    pub canvas: &'a mut Canvas,
    /// The 3D view.
    pub view3d: &'a mut View3d,
    /// The camera pictures.
    pub strip: &'a mut CameraStrip,
    /// The prompt's field and what was read from it.
    pub prompt: &'a mut PromptField,
    /// The state that is compared with.
    pub compare: &'a mut Compare,
    /// What was generated so far.
    pub versions: &'a mut Versions,
    /// The quality slider.
    pub tuning: &'a mut Tuning,
    /// What the sensors returned last.
    pub sensing: &'a Sensing,
    /// Findings of the quality checks.
    pub checking: &'a Checking,
    /// How edits are generated.
    pub params: &'a GenParams,
    /// Columns that are to be generated.
    pub unsettled: &'a Arc<[Bounds]>,
    /// A generation runs.
    pub generating: bool,
    /// The graphics device, if there is one.
    pub render_state: Option<&'a egui_wgpu::RenderState>,
}

/// One pane of the window. It keeps what only itself needs; everything else comes with the context.
pub trait Pane {
    /// Its name in files.
    fn id(&self) -> PaneId;

    /// Its name for a person.
    fn title(&self) -> String;

    /// Its name beside a scene, in the language that is shown: a camera carries the one that the rig gives it.
    fn title_in(&self, _scene: &Scene) -> String {
        t(&self.title()).to_owned()
    }

    /// Stands beside its name in menus.
    fn icon(&self) -> Icon;

    /// Where it opens.
    fn place(&self) -> Place {
        Place::BelowView
    }

    /// Width that a column of such panes needs for its texts, points; 0 for views, which take any.
    fn column_points(&self) -> f32 {
        0.0
    }

    /// True if it shows the state before while the key for that is held.
    fn shows_before(&self) -> bool {
        false
    }

    /// What its header offers, from right to left.
    fn controls(&mut self, _ui: &mut Ui, _cx: &mut PaneContext<'_>, _commands: &mut Vec<Command>) {}

    /// Draws it below its header.
    fn ui(&mut self, ui: &mut Ui, cx: &mut PaneContext<'_>, commands: &mut Vec<Command>);
}
