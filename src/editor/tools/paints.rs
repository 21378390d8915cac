//! Layers and classes by their place in the list of the current tool, for the keys 1 to 0; and the one before, for the
//! key X.

use scene::{BevLayer, Class};

use super::{Hand, ToolId};

/// Layers and classes that were painted with last.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct PaintsBefore {
    layer: Trail<BevLayer>,
    class: Trail<Class>,
}

/// The last value seen, and the one before it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Trail<T> {
    now: Option<T>,
    before: Option<T>,
}

impl<T> Default for Trail<T> {
    fn default() -> Self {
        Self {
            now: None,
            before: None,
        }
    }
}

impl<T: Copy + PartialEq> Trail<T> {
    fn see(&mut self, value: T) {
        if self.now != Some(value) {
            self.before = self.now.replace(value);
        }
    }
}

/// Classes that the voxel brush paints, in the order of its list.
pub fn voxel_classes() -> impl Iterator<Item = Class> {
    Class::ALL.into_iter().filter(|c| *c != Class::Free)
}

impl Hand {
    /// Takes the layer or class of that place in the list of the tool in hand, from 0; nothing happens beyond its end.
    pub fn paint_with(&mut self, place: usize) {
        if self.tool == ToolId::VOXEL {
            self.voxel_class = voxel_classes().nth(place).unwrap_or(self.voxel_class);
        } else {
            self.layer = BevLayer::MAP.get(place).copied().unwrap_or(self.layer);
        }
        self.note_paint();
    }

    /// Takes the layer or class before this one again, if there was one.
    pub fn paint_with_last(&mut self) {
        self.note_paint();
        if self.tool == ToolId::VOXEL {
            self.voxel_class = self.painted_before.class.before.unwrap_or(self.voxel_class);
        } else {
            self.layer = self.painted_before.layer.before.unwrap_or(self.layer);
        }
        self.note_paint();
    }

    /// Notes the current layer and class, however they were chosen.
    pub fn note_paint(&mut self) {
        self.painted_before.layer.see(self.layer);
        self.painted_before.class.see(self.voxel_class);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_one_before_changes_places_with_this_one() {
        let mut hand = Hand {
            tool: crate::tools::brush::ID,
            ..Hand::default()
        };
        let first = hand.layer;
        hand.paint_with_last();
        assert_eq!(hand.layer, first, "there was none before");
        hand.paint_with(3);
        assert_eq!(hand.layer, BevLayer::MAP[3]);
        hand.paint_with_last();
        assert_eq!(hand.layer, first);
        hand.paint_with_last();
        assert_eq!(hand.layer, BevLayer::MAP[3]);
        // Chosen in the list of the pane.
        hand.note_paint();
        hand.layer = BevLayer::MAP[5];
        hand.paint_with_last();
        assert_eq!(hand.layer, BevLayer::MAP[3]);
        hand.paint_with(99);
        assert_eq!(hand.layer, BevLayer::MAP[3]);
        // Classes have a memory of their own.
        hand.tool = ToolId::VOXEL;
        let class = hand.voxel_class;
        hand.paint_with(1);
        assert_eq!(Some(hand.voxel_class), voxel_classes().nth(1));
        hand.paint_with_last();
        assert_eq!((hand.voxel_class, hand.layer), (class, BevLayer::MAP[3]));
    }
}
