//! A frame: the objects, layout and voxels of a moment, and the state that its occupancy was generated from.

use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;

use crate::clip::OwnShape;
use crate::{
    BevLayout, BoxId, Class, Extent, Inferred, Pose, SceneBox, VoxelGrid, VoxelPaint, Waiver, raster,
};

/// The state in which a frame's occupancy was last generated, imported or accepted. The next generation inpaints the
/// differences between it and the frame; the rest stays bit-identical.
#[derive(Clone, Debug, PartialEq)]
pub struct SourceFrame {
    /// Map layers and polylines the occupancy belongs to.
    pub layout: BevLayout,
    /// Boxes the occupancy belongs to.
    pub boxes: BTreeMap<BoxId, SceneBox>,
    /// The occupancy itself.
    pub occupancy: VoxelGrid,
}

/// One moment of a scene. All coordinates are in the world frame (z up); in a scene that stands still, that is the ego frame
/// (x forward, y left) unless `world_from_ego` says otherwise.
#[derive(Clone, Debug, PartialEq)]
pub struct Frame {
    /// Time since the start of the clip, s.
    pub time_s: f64,
    /// Where the ego vehicle is.
    pub world_from_ego: Pose,
    /// Objects, moving ones at their places of the moment.
    pub boxes: BTreeMap<BoxId, SceneBox>,
    /// Map layers and the polylines they come from.
    pub layout: BevLayout,
    /// The voxels that are shown and that the sensors see: the source with the rough version of the user's edits, or the
    /// last result.
    pub occupancy: VoxelGrid,
    /// Voxels the user painted (or removed, painted as free): locked, generation keeps them.
    pub painted: VoxelPaint,
    /// Which parts of layout and boxes are guesses of an import.
    pub inferred: Inferred,
    /// Findings of the checks that the user accepted.
    pub waivers: Arc<Vec<Waiver>>,
    /// See [`SourceFrame`].
    pub source: Arc<SourceFrame>,
    /// Ids of objects that are not there at this moment, but at others: no new box may have them.
    pub absent: Arc<BTreeSet<BoxId>>,
    /// Objects whose voxels are their own, in place of those of their class. They are in the occupancy too.
    pub own_shapes: Arc<BTreeMap<BoxId, OwnShape>>,
    /// Distance that people and bicycles covered since their motion began, forward along their heading, m: the phase of their steps.
    pub covered_m: Arc<BTreeMap<BoxId, f64>>,
}

impl Frame {
    /// Boxes that a frame holds at most.
    pub const MAX_BOXES: usize = 20_000;
    /// Waivers that a frame holds at most.
    pub const MAX_WAIVERS: usize = 10_000;

    /// A frame whose occupancy is its own source. Layout and occupancy have the same extent.
    pub fn new(layout: BevLayout, boxes: BTreeMap<BoxId, SceneBox>, occupancy: VoxelGrid) -> Self {
        let source = Arc::new(SourceFrame {
            layout: layout.clone(),
            boxes: boxes.clone(),
            occupancy: occupancy.clone(),
        });
        Self {
            time_s: 0.0,
            world_from_ego: Pose::IDENTITY,
            boxes,
            painted: VoxelPaint::over(layout.extent()),
            layout,
            occupancy,
            inferred: Inferred::default(),
            waivers: Arc::default(),
            source,
            absent: Arc::default(),
            own_shapes: Arc::default(),
            covered_m: Arc::default(),
        }
    }

    /// Which part of the ground its layout and its grids cover.
    pub fn extent(&self) -> Extent {
        self.layout.extent()
    }

    /// True in a column whose ground in the frame is a draft and of which neither the source nor a mask of labels knows
    /// anything: the map was made larger there.
    pub fn is_new_ground(&self, x: usize, y: usize) -> bool {
        let holds = |grid: &VoxelGrid| grid.column(x, y).iter().any(|l| *l != Class::FREE);
        let masks = self.inferred.unobserved.as_ref();
        let masked = masks.is_some_and(|m| m.words()[self.extent().index(x, y)] != 0);
        !masked && !holds(&self.source.occupancy) && holds(&self.occupancy)
    }

    /// The part of it that lies in another extent. Boxes, lines and waivers stay, wherever they are. Costs pointers alone
    /// if the extent is its own.
    pub fn crop(&self, extent: Extent) -> Self {
        if extent == self.extent() {
            return self.clone();
        }
        let source = SourceFrame {
            layout: self.source.layout.crop(extent),
            boxes: self.source.boxes.clone(),
            occupancy: self.source.occupancy.crop(extent),
        };
        Self {
            layout: self.layout.crop(extent),
            occupancy: self.occupancy.crop(extent),
            painted: self.painted.crop(extent),
            inferred: Inferred {
                unobserved: self.inferred.unobserved.as_ref().map(|u| u.crop(extent)),
                data_labels: self.inferred.data_labels.as_ref().map(|l| l.crop(extent)),
                ..self.inferred.clone()
            },
            source: Arc::new(source),
            ..self.clone()
        }
    }

    /// All 18 BEV channels, one bit per [`crate::BevLayer`] and cell, row-major `[x][y]`:
    /// the layout's map layers and the footprints of the boxes.
    pub fn bev_channels(&self) -> Vec<u32> {
        raster::bev_channels(&self.layout, self.boxes.values())
    }

    /// The id above all in use.
    pub fn next_box_id(&self) -> BoxId {
        let last = self.boxes.keys().next_back().max(self.absent.last());
        BoxId(last.map_or(1, |id| id.0 + 1))
    }

    /// True if a box of that id is there, now or at another moment.
    pub fn is_taken(&self, id: BoxId) -> bool {
        self.boxes.contains_key(&id) || self.absent.contains(&id)
    }
}
