//! Agreement of occupancy with its layout: columns that hold a class against columns that the layout sets.

use scene::{BevLayer, Class, Frame, VoxelGrid};

/// IoU over BEV columns between the layout and the occupancy.
#[derive(Clone, Copy, Debug, Default, PartialEq, serde::Serialize)]
pub struct LayoutAgreement {
    /// Columns of driveable surface against the layers drivable area and car park, without the
    /// columns that a box covers; `None` if neither has any.
    pub drivable: Option<f64>,
    /// Columns that hold a vehicle class (bus, car, construction vehicle, trailer, truck) against
    /// the footprints of such boxes.
    pub vehicles: Option<f64>,
}

/// Intersection and union in columns, to be summed over frames.
#[derive(Clone, Copy, Debug, Default)]
pub struct AgreementCount {
    drivable: [u64; 2],
    vehicles: [u64; 2],
}

impl AgreementCount {
    /// Counts one frame: the layout and boxes of `frame` against `occupancy`.
    pub fn add(&mut self, frame: &Frame, occupancy: &VoxelGrid) {
        let object_bits: u32 = Class::OBJECTS
            .iter()
            .filter_map(|c| BevLayer::of_object(*c))
            .map(BevLayer::bit)
            .sum();
        let vehicles = Class::OBJECTS.iter().filter(|c| c.is_vehicle());
        let vehicle_bits: u32 = vehicles
            .filter_map(|c| BevLayer::of_object(*c))
            .map(BevLayer::bit)
            .sum();
        let road_bits = BevLayer::DrivableArea.bit() | BevLayer::CarparkArea.bit();
        for (c, cell) in frame.bev_channels().into_iter().enumerate() {
            let [x, y] = frame.extent().column(c);
            let column = occupancy.column(x, y);
            let holds = |test: fn(Class) -> bool| column.iter().any(|v| Class::from_id(*v).is_some_and(test));
            let mut count = |pair: fn(&mut Self) -> &mut [u64; 2], wanted: bool, found: bool| {
                pair(self)[0] += u64::from(wanted && found);
                pair(self)[1] += u64::from(wanted || found);
            };
            if cell & object_bits == 0 {
                let found = holds(|c| c == Class::DriveableSurface);
                count(|s| &mut s.drivable, cell & road_bits != 0, found);
            }
            count(
                |s| &mut s.vehicles,
                cell & vehicle_bits != 0,
                holds(Class::is_vehicle),
            );
        }
    }

    /// The IoUs.
    pub fn iou(&self) -> LayoutAgreement {
        let ratio = |[both, either]: [u64; 2]| (either > 0).then(|| both as f64 / either as f64);
        LayoutAgreement {
            drivable: ratio(self.drivable),
            vehicles: ratio(self.vehicles),
        }
    }
}

/// Agreement of one frame's current occupancy with its layout and boxes.
pub fn layout_agreement(frame: &Frame) -> LayoutAgreement {
    let mut count = AgreementCount::default();
    count.add(frame, &frame.occupancy);
    count.iou()
}
