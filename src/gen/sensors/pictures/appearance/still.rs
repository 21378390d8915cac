//! Parts of a frame that stay while its boxes move, used again for the next moment where what they are made of is the same.

use std::collections::BTreeMap;
use std::sync::{Arc, Mutex, PoisonError};

use super::field::OccupancyField;
use super::field::owners::Owners;
use super::ground::SmoothGround;
use super::scenery::DrawnScenery;
use crate::pictures::march::ground::{GroundHeightField, SplitGrid};
use crate::pictures::march::paint::RoadMarkings;
use crate::pictures::march::{GroundHeight, remove_voxels};
use crate::pictures::scenery::SceneryInput;
use scene::appearance::FieldShape;
use scene::{Background, BevLayout, Class, Extent, Frame, VoxelGrid, VoxelPaint};

/// Voxels of an object's class this far outside its box are strays of the labels, m.
const STRAY_M: f64 = 0.7;

/// Parts of the frame that was prepared last. Frames prepared with it look as without it.
#[derive(Default)]
pub struct AppearanceCache(Mutex<Option<Arc<StillParts>>>);

impl std::fmt::Debug for AppearanceCache {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("AppearanceCache").finish_non_exhaustive()
    }
}

impl AppearanceCache {
    /// The parts of a frame in an extent, with those of the frame before that are the same.
    pub(super) fn parts(
        &self,
        frame: &Frame,
        background: &Background,
        extent: Extent,
        seed: u32,
    ) -> Arc<StillParts> {
        let kept = || self.0.lock().unwrap_or_else(PoisonError::into_inner);
        let before = kept().clone();
        let parts = Arc::new(StillParts::new(
            frame,
            background,
            (extent, seed),
            before.as_deref(),
        ));
        *kept() = Some(parts.clone());
        parts
    }
}

/// Everything but the boxes, and what it was made of.
pub(super) struct StillParts {
    seed: u32,
    split: SplitGrid,
    layout: BevLayout,
    /// Voxels that the field shows.
    standing: VoxelGrid,
    owners: Owners,
    /// Scenery beside the field.
    pub scenery: DrawnScenery,
    /// The voxels.
    pub field: Arc<OccupancyField>,
    /// The ground.
    pub ground: Arc<SmoothGround>,
    /// Lines on the road.
    pub paint: Arc<RoadMarkings>,
}

impl StillParts {
    fn new(
        frame: &Frame,
        background: &Background,
        (extent, seed): (Extent, u32),
        before: Option<&Self>,
    ) -> Self {
        let (occupancy, layout) = (frame.occupancy.crop(extent), frame.layout.crop(extent));
        let split = SplitGrid::new(&occupancy, before.map(|b| &b.split));
        let (mut standing, mut columns) = (split.standing.clone(), split.ground.clone());
        for b in frame.boxes.values() {
            remove_voxels(&mut standing, &mut columns, b, GroundHeight::Physical, STRAY_M);
        }
        let painted = frame.painted.crop(extent);
        show_painted(&mut standing, &columns, &painted);
        // Parts of another layout or seed share nothing with these.
        let before = before.filter(|b| b.seed == seed && b.layout == layout);
        let scenery = SceneryInput {
            background,
            occupancy: &occupancy,
            painted: &painted,
            layout: &layout,
            inferred: frame.inferred.background,
        };
        let scenery = DrawnScenery::new(scenery, &mut standing, seed, before.map(|b| &b.scenery));
        let shape = FieldShape::from_extent(extent);
        let owners = Owners::new(&scenery.in_field, &scenery.cut, &layout, &shape);
        let same_field = before.filter(|b| b.standing == standing && b.owners == owners);
        let field = same_field.map_or_else(
            || Arc::new(OccupancyField::new(&standing, &owners, seed)),
            |b| b.field.clone(),
        );
        let ground = SmoothGround::new(&columns, &layout, before.map(|b| &b.ground));
        let paint = before.map_or_else(|| Arc::new(RoadMarkings::new(&layout)), |b| b.paint.clone());
        Self {
            seed,
            split,
            layout,
            standing,
            owners,
            scenery,
            field,
            ground,
            paint,
        }
    }
}

/// Shows what was painted by hand onto the ground so low that its labels lie below the ground's physical height: a voxel of it on
/// the ground.
fn show_painted(standing: &mut VoxelGrid, ground: &GroundHeightField, painted: &VoxelPaint) {
    let stands = |class: u8| Class::from_id(class).is_some_and(|c| c != Class::Free && !c.is_ground());
    let mut highest: BTreeMap<[usize; 2], (usize, u8)> = BTreeMap::new();
    for (x, y, z, class) in painted.iter_set().filter(|(.., class)| stands(*class)) {
        let of = highest.entry([x, y]).or_insert((z, class));
        *of = (*of).max((z, class));
    }
    for ([x, y], (z, class)) in highest {
        let on_ground = ground.bin_on(x, y);
        let is_free = on_ground < standing.extent().nz() && standing.get(x, y, on_ground) == Class::FREE;
        if z < on_ground && is_free {
            standing.set(x, y, on_ground, class);
        }
    }
}
