use super::*;

fn line(points: &[[f64; 2]]) -> Vec<DVec3> {
    points.iter().map(|[x, y]| DVec3::new(*x, *y, 0.0)).collect()
}

#[test]
fn bounds_are_turned_so_that_the_left_one_is_left() {
    let (left, right) = ([[0.0, 3.0], [10.0, 3.0]], [[0.0, 0.0], [10.0, 0.0]]);
    let back = |points: &[[f64; 2]; 2]| [points[1], points[0]];
    for (l, r) in [
        (left, right),
        (left, back(&right)),
        (back(&left), right),
        (back(&left), back(&right)),
    ] {
        let lanelet = Lanelet::new(1, line(&l), line(&r), Use::Traffic).expect("bounds");
        assert_eq!(lanelet.bounds, [line(&left), line(&right)], "{l:?} {r:?}");
    }
    // Left and right the other way round: it is driven back.
    let lanelet = Lanelet::new(1, line(&right), line(&left), Use::Traffic).expect("bounds");
    assert_eq!(lanelet.bounds, [line(&back(&right)), line(&back(&left))]);
    assert!(Lanelet::new(1, line(&[[0.0, 0.0]; 3]), line(&right), Use::Traffic).is_none());
}

#[test]
fn a_bend_of_lanelets_has_no_gaps() {
    let arc = |radius: f64| -> Vec<DVec3> {
        let all =
            (0..=12).map(|i| DVec2::from_angle(f64::from(i) * 0.13 - 1.57) * radius + DVec2::new(0.0, 12.0));
        all.map(|p| p.extend(0.0)).collect()
    };
    let bend = Lanelet::new(1, arc(10.25), arc(13.75), Use::Traffic).expect("bounds");
    let map = LaneletMap {
        lanelets: vec![bend],
        ..LaneletMap::default()
    };
    let network = network(map).expect("roads");
    let layout = network.to_layout(DVec2::ZERO, 0.0).layout;
    let extent = layout.extent();
    for [x, y] in extent.all_columns() {
        let p = extent.center(x, y, 0).truncate() - DVec2::new(0.0, 12.0);
        let within = (10.6..13.4).contains(&p.length()) && (-1.5..-0.1).contains(&p.to_angle());
        if within {
            assert!(layout.has(scene::BevLayer::DrivableArea, x, y), "{p}");
        }
    }
    assert!((network.roads[0].length_m() - 12.0 * 1.56).abs() < 0.3);
}
