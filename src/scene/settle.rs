//! Settling of a frame: its source takes over the authored state, everywhere or in a part of the map, once the
//! occupancy was generated for it.

use std::collections::BTreeSet;
use std::sync::Arc;

use crate::raster::box_cells;
use crate::{Extent, Frame, SceneBox, SourceFrame};

impl Frame {
    /// Records that the occupancy was generated for everything that is authored.
    pub fn settle(&mut self) {
        self.source = Arc::new(SourceFrame {
            layout: self.layout.clone(),
            boxes: self.boxes.clone(),
            occupancy: self.occupancy.clone(),
        });
    }

    /// Records that the occupancy was generated for everything authored within an extent: the layout there, and boxes
    /// with at least a column there. Other authored parts remain to be generated.
    pub fn settle_within(&mut self, extent: Extent) {
        let mut source = SourceFrame::clone(&self.source);
        source.layout.paste(&self.layout.crop(extent));
        let ids: BTreeSet<_> = source.boxes.keys().chain(self.boxes.keys()).copied().collect();
        for id in ids {
            let states = [source.boxes.get(&id), self.boxes.get(&id)];
            if states[0] == states[1] || !stands_within(self.extent(), extent, states) {
                continue;
            }
            match states[1] {
                Some(now) => source.boxes.insert(id, *now),
                None => source.boxes.remove(&id),
            };
        }
        source.occupancy.paste(&self.occupancy.crop(extent));
        self.source = Arc::new(source);
    }
}

/// True if a state of a box stands within an extent, or if none stands on the map, where nothing is ever generated.
fn stands_within(map: Extent, extent: Extent, states: [Option<&SceneBox>; 2]) -> bool {
    let (mut within, mut on_map) = (false, false);
    for b in states.into_iter().flatten() {
        box_cells(map, b, 0.0, |x, y| {
            let p = map.center(x, y, 0);
            on_map = true;
            within |= extent.column_at(p.x, p.y).is_some();
        });
    }
    within || !on_map
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{BevLayer, BevLayout, BoxId, Class, Relief, VoxelGrid};
    use glam::{DVec2, DVec3};

    fn car(id: u32, x_m: f64) -> SceneBox {
        SceneBox {
            id: BoxId(id),
            class: Class::Car,
            center_m: DVec3::new(x_m, 0.0, 0.8),
            size_m: DVec3::new(4.6, 1.9, 1.6),
            yaw_rad: 0.0,
            velocity_mps: DVec2::ZERO,
            label: Default::default(),
        }
    }

    #[test]
    fn only_what_is_authored_in_a_part_is_settled_there() {
        let map = Extent::new([-100, -100], [500, 200]).expect("sound");
        let mut frame = Frame::new(BevLayout::over(map), Default::default(), VoxelGrid::over(map));
        let [near, border, far] = [car(1, 5.0), car(2, 41.0), car(3, 120.0)];
        frame.boxes = [near, border, far].map(|b| (b.id, b)).into();
        frame.layout.set(BevLayer::Walkway, 10, 10, true);
        frame.layout.set(BevLayer::Walkway, 400, 10, true);
        frame.layout.relief = Relief::from_fn(map, |p| 0.01 * p.x);
        frame.settle_within(Extent::WINDOW);
        let held = |frame: &Frame| frame.source.boxes.keys().map(|id| id.0).collect::<Vec<_>>();
        assert_eq!(held(&frame), [1, 2], "one half of the second stands there");
        assert!(frame.source.layout.has(BevLayer::Walkway, 10, 10));
        assert!(!frame.source.layout.has(BevLayer::Walkway, 400, 10));
        let heights = |frame: &Frame| [100, 350].map(|x| frame.source.layout.relief.column_m(x, 90));
        assert!(heights(&frame)[0] != 0.0 && heights(&frame)[1] == 0.0);
        frame.settle();
        assert!(heights(&frame)[1] != 0.0);
        assert_eq!(held(&frame), [1, 2, 3]);
        assert_eq!(frame.source.layout, frame.layout);
        // A box that was removed beyond the map is settled everywhere.
        frame.boxes.remove(&BoxId(1));
        frame.settle_within(Extent::new([300, -20], [40, 40]).expect("sound"));
        assert_eq!(held(&frame), [1, 2, 3]);
        frame.settle_within(Extent::WINDOW);
        assert_eq!(held(&frame), [2, 3]);
    }
}
