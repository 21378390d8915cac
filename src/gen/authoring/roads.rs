//! Places on imported roads, as layouts of worlds.

use std::path::Path;

use super::open;
use formats::opendrive::RoadNetwork;
use scene::{BevLayer, BevLayout, Window};
use world::draw::Draw;

/// Share of the worlds that stand on imported roads.
const SHARE: f64 = 1.0 / 3.0;
/// Least drivable share of the map: a smaller share shows a lane's end in a field.
const LEAST_DRIVABLE: f64 = 0.08;
const TRIES: usize = 4;

/// Road networks to draw places from.
#[derive(Default)]
pub struct RoadNetworkPool(Vec<RoadNetwork>);

impl RoadNetworkPool {
    /// Reads every `.xodr` file below a folder.
    pub fn open(dir: &Path) -> anyhow::Result<Self> {
        let files = open::files_below(dir, "xodr", "OpenDRIVE roads")?;
        let networks: anyhow::Result<Vec<_>> = files.iter().map(|f| open::road_network(f)).collect();
        Ok(Self(networks?))
    }

    /// For one seed in three, the layout around a place on a lane of one of the networks, seen from a
    /// vehicle that drives there; the same seed gives the same place. `None` for the other seeds.
    pub fn layout(&self, seed: u64) -> Option<BevLayout> {
        let mut draw = Draw::new(seed, "imported roads");
        if self.0.is_empty() || !draw.chance(SHARE) {
            return None;
        }
        (0..TRIES).find_map(|_| {
            let network = &self.0[draw.below(self.0.len())];
            let lengths: Vec<f64> = network.roads.iter().map(|r| r.length_m()).collect();
            let road = network.roads.get(draw.weighted(&lengths))?;
            let near = road.reference.at(draw.range(0.0, road.length_m())).position_m;
            let pose = network.pose_on_lane_near(near)?;
            let layout = network.to_layout(pose.position_m, pose.heading_rad).layout;
            let drivable = layout.count(BevLayer::DrivableArea) as f64 / Window::COLUMNS as f64;
            (drivable >= LEAST_DRIVABLE).then_some(layout)
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A straight road of one lane on each side, written for this test.
    const ROAD: &str = r#"<OpenDRIVE><header revMajor="1" revMinor="6"/>
        <road name="" length="300" id="1" junction="-1"><planView>
        <geometry s="0" x="0" y="0" hdg="0.4" length="300"><line/></geometry></planView>
        <lanes><laneSection s="0"><left><lane id="1" type="driving"><width sOffset="0" a="3.5" b="0" c="0" d="0"/></lane></left>
        <center><lane id="0" type="none"/></center>
        <right><lane id="-1" type="driving"><width sOffset="0" a="3.5" b="0" c="0" d="0"/></lane></right></laneSection></lanes>
        </road></OpenDRIVE>"#;

    #[test]
    fn a_third_of_the_seeds_stands_on_imported_roads() {
        let dir = tempfile::tempdir().unwrap();
        assert!(RoadNetworkPool::open(dir.path()).is_err(), "an empty folder");
        std::fs::write(dir.path().join("a.xodr"), ROAD).unwrap();
        let roads = RoadNetworkPool::open(dir.path()).unwrap();
        let found: Vec<_> = (0..60).map(|seed| roads.layout(seed)).collect();
        let layouts = found.iter().flatten().count();
        assert!((10..30).contains(&layouts), "{layouts} of 60");
        assert!(found.iter().flatten().all(|l| !l.polylines.is_empty()));
        assert_eq!(found[..10], (0..10).map(|s| roads.layout(s)).collect::<Vec<_>>());
        let climbing = ROAD.replace("<lanes>", "<elevationProfile><elevation s=\"0\" a=\"9\" b=\"0.05\" c=\"0\" d=\"0\"/></elevationProfile><lanes>");
        std::fs::write(dir.path().join("a.xodr"), climbing).unwrap();
        let roads = RoadNetworkPool::open(dir.path()).unwrap();
        for layout in (0..20).filter_map(|seed| roads.layout(seed)) {
            let at = |x: f64| layout.relief.height_m(glam::DVec2::new(x, 0.0));
            let grade = (at(8.0) - at(-8.0)) / 16.0;
            assert!(
                (grade.abs() - 0.05).abs() < 0.002,
                "the relief comes along: {grade}"
            );
        }
        assert!((0..60).all(|seed| RoadNetworkPool::default().layout(seed).is_none()));
    }
}
