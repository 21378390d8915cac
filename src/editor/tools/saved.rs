//! Saved brushes: the settings of a brush under a name; voxels kept as a stamp among them.

use serde::{Deserialize, Serialize};

use scene::{BevLayer, Class, Frame};

use super::{Hand, PaintShape, ToolId, VoxelMode, VoxelTip, VoxelVerb};
use crate::voxel_ops::VoxelIndex;

/// Voxels that are set down together: their places from the middle of their underside, and their classes.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(transparent)]
pub struct Stamp {
    voxels: Vec<([i32; 3], Class)>,
}

impl Stamp {
    /// Most voxels of one.
    pub const MOST: usize = 50_000;

    /// Makes a stamp of the voxels of a frame that are not free. `None` if none are left, or more than [`Self::MOST`].
    pub fn from_cells(frame: &Frame, cells: &[VoxelIndex]) -> Option<Self> {
        let label = |[x, y, z]: VoxelIndex| {
            Class::from_id(frame.occupancy.get(x, y, z)).filter(|c| *c != Class::Free)
        };
        let solid: Vec<(VoxelIndex, Class)> = cells.iter().filter_map(|c| Some((*c, label(*c)?))).collect();
        if solid.is_empty() || solid.len() > Self::MOST {
            return None;
        }
        let low = |a: usize| solid.iter().map(|(c, _)| c[a]).min().unwrap_or(0) as i32;
        let high = |a: usize| solid.iter().map(|(c, _)| c[a]).max().unwrap_or(0) as i32;
        let from = [(low(0) + high(0)) / 2, (low(1) + high(1)) / 2, low(2)];
        let at = |c: VoxelIndex| [0, 1, 2].map(|a| c[a] as i32 - from[a]);
        Some(Self {
            voxels: solid.into_iter().map(|(c, class)| (at(c), class)).collect(),
        })
    }

    /// How many voxels it has.
    pub fn len(&self) -> usize {
        self.voxels.len()
    }

    /// True if it has none.
    pub fn is_empty(&self) -> bool {
        self.voxels.is_empty()
    }

    /// A quarter turn counter-clockwise, seen from above.
    pub fn turned(&self) -> Self {
        let turn = |([x, y, z], class): &([i32; 3], Class)| ([-y, *x, *z], *class);
        Self {
            voxels: self.voxels.iter().map(turn).collect(),
        }
    }

    /// Its voxels, by class, with their underside at a cell; what lies outside the grid is left out.
    pub fn at(&self, frame: &Frame, cell: VoxelIndex) -> Vec<(Class, Vec<VoxelIndex>)> {
        let size = frame.extent().shape();
        let mut out: Vec<(Class, Vec<VoxelIndex>)> = Vec::new();
        for (by, class) in &self.voxels {
            let moved = [0, 1, 2].map(|a| i64::try_from(cell[a]).unwrap_or(i64::MAX / 2) + i64::from(by[a]));
            if (0..3).any(|a| moved[a] < 0 || moved[a] >= size[a] as i64) {
                continue;
            }
            let moved = moved.map(|v| v as usize);
            match out.iter_mut().find(|(c, _)| c == class) {
                Some((_, cells)) => cells.push(moved),
                None => out.push((*class, vec![moved])),
            }
        }
        out
    }
}

/// Saved settings of a brush.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum BrushSettings {
    /// The brush of the map.
    Map {
        /// Layer that it paints.
        layer: BevLayer,
        /// Shape that a drag draws.
        shape: PaintShape,
        /// Its diameter, m.
        size_m: f64,
        /// True if it clears.
        erase: bool,
    },
    /// The voxel brush.
    Voxels {
        /// Mode of a drag.
        mode: VoxelMode,
        /// Verb that a drag applies to the voxels.
        verb: VoxelVerb,
        /// Their class.
        class: Class,
        /// Edge, voxels.
        size: usize,
        /// Height, voxels.
        height: usize,
        /// Shape of the brush.
        #[serde(default)]
        tip: VoxelTip,
    },
    /// Voxels that are set down together.
    Stamp(Stamp),
}

/// A brush under a name.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct SavedBrush {
    /// Its name.
    pub name: String,
    /// Settings of the brush.
    pub held: BrushSettings,
}

impl SavedBrush {
    /// Most of them.
    pub const MOST: usize = 100;
}

impl Hand {
    /// The brush in hand; none for tools that are no brush.
    pub fn brush_in_hand(&self) -> Option<BrushSettings> {
        match self.tool {
            ToolId::BRUSH => Some(BrushSettings::Map {
                layer: self.layer,
                shape: self.shape,
                size_m: self.brush_m,
                erase: self.erase,
            }),
            ToolId::VOXEL if self.voxel_mode == VoxelMode::Stamp => {
                (!self.stamp.is_empty()).then(|| BrushSettings::Stamp(self.stamp.clone()))
            }
            ToolId::VOXEL => Some(BrushSettings::Voxels {
                mode: self.voxel_mode,
                verb: self.verb,
                class: self.voxel_class,
                size: self.voxel_size,
                height: self.voxel_height,
                tip: self.voxel_tip,
            }),
            _ => None,
        }
    }

    /// Takes a brush in hand; sizes are brought within their limits.
    pub fn take_brush(&mut self, held: &BrushSettings) {
        match held {
            BrushSettings::Map {
                layer,
                shape,
                size_m,
                erase,
            } => {
                self.tool = ToolId::BRUSH;
                (self.layer, self.shape, self.erase) = (*layer, *shape, *erase);
                if size_m.is_finite() {
                    self.brush_m = size_m.clamp(*Self::BRUSH_M.start(), *Self::BRUSH_M.end());
                }
            }
            BrushSettings::Voxels {
                mode,
                verb,
                class,
                size,
                height,
                tip,
            } => {
                self.tool = ToolId::VOXEL;
                (self.voxel_mode, self.verb, self.voxel_class) = (*mode, *verb, *class);
                self.voxel_tip = *tip;
                self.voxel_size = (*size).clamp(1, Self::MAX_VOXEL_SIZE);
                self.voxel_height = (*height).clamp(1, scene::Lattice::OCC3D.bins());
            }
            BrushSettings::Stamp(stamp) => {
                self.tool = ToolId::VOXEL;
                (self.voxel_mode, self.stamp) = (VoxelMode::Stamp, stamp.clone());
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use scene::{BevLayout, VoxelGrid};

    fn frame() -> Frame {
        let mut grid = VoxelGrid::new();
        for (x, class) in [
            (10, Class::Manmade),
            (11, Class::Manmade),
            (12, Class::Vegetation),
        ] {
            grid.set(x, 20, 3, class.id());
        }
        Frame::new(BevLayout::default(), Default::default(), grid)
    }

    #[test]
    fn a_stamp_is_set_down_as_it_was_turned_and_cut_at_the_edge() {
        let frame = frame();
        let cells = [[10, 20, 3], [11, 20, 3], [12, 20, 3], [12, 20, 4]];
        let stamp = Stamp::from_cells(&frame, &cells).expect("three are solid");
        assert_eq!(stamp.len(), 3);
        assert_eq!(
            stamp.at(&frame, [50, 60, 0]),
            [
                (Class::Manmade, vec![[49, 60, 0], [50, 60, 0]]),
                (Class::Vegetation, vec![[51, 60, 0]]),
            ]
        );
        let turned = stamp.turned().at(&frame, [50, 60, 0]);
        assert_eq!(turned[1], (Class::Vegetation, vec![[50, 61, 0]]));
        let four = (0..4).fold(stamp.clone(), |s, _| s.turned());
        assert_eq!(four, stamp);
        let edge: usize = stamp.at(&frame, [0, 0, 0]).iter().map(|(_, c)| c.len()).sum();
        assert_eq!(edge, 2);
        assert_eq!(stamp.at(&frame, [usize::MAX; 3]), []);
        assert_eq!(Stamp::from_cells(&frame, &[[0, 0, 0]]), None);
    }

    #[test]
    fn brushes_come_back_from_text_and_wild_sizes_are_tamed() {
        let mut hand = Hand {
            tool: ToolId::BRUSH,
            layer: BevLayer::Walkway,
            brush_m: 5.6,
            erase: true,
            ..Hand::default()
        };
        let saved = SavedBrush {
            name: "kerb".into(),
            held: hand.brush_in_hand().expect("a brush"),
        };
        let text = serde_json::to_string(&saved).expect("plain data");
        let back: SavedBrush = serde_json::from_str(&text).expect("as written");
        assert_eq!(back, saved);
        hand = Hand::default();
        hand.take_brush(&back.held);
        assert_eq!(
            (hand.layer, hand.brush_m, hand.erase),
            (BevLayer::Walkway, 5.6, true)
        );
        hand.take_brush(&BrushSettings::Voxels {
            mode: VoxelMode::Block,
            verb: VoxelVerb::Remove,
            class: Class::Car,
            size: 900,
            height: 0,
            tip: VoxelTip::Round,
        });
        assert_eq!(
            (hand.tool, hand.voxel_size, hand.voxel_height),
            (ToolId::VOXEL, 5, 1)
        );
        assert_eq!(hand.voxel_tip, VoxelTip::Round);
        // One of before there were tips.
        let old = r#"{"voxels":{"mode":"brush","verb":"attach","class":"manmade","size":3,"height":2}}"#;
        hand.take_brush(&serde_json::from_str(old).expect("as it was written then"));
        assert_eq!((hand.voxel_size, hand.voxel_tip), (3, VoxelTip::Block));
        hand.tool = ToolId::SELECT;
        assert_eq!(hand.brush_in_hand(), None);
    }
}
