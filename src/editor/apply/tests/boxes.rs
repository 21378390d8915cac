//! Boxes and their voxels.

use super::*;

#[test]
fn removing_a_car_leaves_road_and_the_neighbour() {
    let mut scene = street();
    let before = cars(&scene);
    let source = scene.frame().source.clone();
    Edit::RemoveBox { id: BoxId(1) }
        .apply(&mut scene)
        .expect("is there");
    assert!(!scene.frame().boxes.contains_key(&BoxId(1)));
    assert_eq!(cars(&scene) * 2, before, "one of two equal cars is left, whole");
    assert_eq!(label_at(&scene, 10.1, 1.7, 0), Class::DriveableSurface.id());
    assert_eq!(label_at(&scene, 10.1, 1.7, 3), FREE);
    assert_eq!(label_at(&scene, 10.1, -1.7, 3), Class::Car.id());
    assert!(
        Arc::ptr_eq(&source, &scene.frame().source),
        "edits leave the source"
    );
    Edit::RemoveBox { id: BoxId(2) }
        .apply(&mut scene)
        .expect("is there");
    assert_eq!(cars(&scene), 0);
    let layout = scene.frame().layout.clone();
    assert_eq!(
        scene.frame().occupancy,
        draft(&layout, std::iter::empty()),
        "with both gone the street is as drafted without them"
    );
}

#[test]
fn a_hole_without_layout_continues_the_ground_around() {
    let mut scene = street();
    // Nothing says what the ground is; the voxels still do.
    scene.change_canvas(|frame| frame.layout = BevLayout::default());
    Edit::RemoveBox { id: BoxId(1) }
        .apply(&mut scene)
        .expect("is there");
    assert_eq!(label_at(&scene, 10.1, 1.7, 0), Class::DriveableSurface.id());
    // In the middle of nowhere it becomes terrain.
    let lost = car(1, -20.0, 20.0);
    let mut grid = VoxelGrid::new();
    let [x, y] = cell(-20.0, 20.0);
    grid.set(x, y, 0, Class::Car.id());
    let frame = Frame::new(BevLayout::default(), [(lost.id, lost)].into(), grid);
    let mut scene = Scene::single("nowhere", frame, Arc::new(SensorRig::default()), 0);
    Edit::RemoveBox { id: BoxId(1) }
        .apply(&mut scene)
        .expect("is there");
    assert_eq!(scene.frame().occupancy.count_set(), 1);
    assert_eq!(scene.frame().occupancy.get(x, y, 0), Class::Terrain.id());
}

#[test]
fn boxes_that_overlap_keep_their_voxels() {
    let mut scene = street();
    // A third car shares half its place with the first.
    let add = |x: f64, id: u32| Edit::AddBox {
        class: Class::Car,
        center_m: DVec3::new(x, 1.6, 0.85),
        size_m: DVec3::new(4.6, 1.95, 1.7),
        yaw_deg: 0.0,
        velocity_mps: None,
        id: Some(BoxId(id)),
        label: Default::default(),
    };
    add(12.0, 3).apply(&mut scene).expect("sound");
    Edit::RemoveBox { id: BoxId(1) }
        .apply(&mut scene)
        .expect("is there");
    assert_eq!(
        label_at(&scene, 11.3, 1.7, 2),
        Class::Car.id(),
        "shared place stays"
    );
    assert_eq!(label_at(&scene, 8.3, 1.7, 2), FREE, "own place goes");
}

#[test]
fn adding_stamps_and_moving_is_removing_and_adding() {
    let mut scene = street();
    let add = Edit::AddBox {
        class: Class::Pedestrian,
        center_m: DVec3::new(-5.0, 5.0, 0.9),
        size_m: DVec3::new(0.7, 0.7, 1.8),
        yaw_deg: 45.0,
        velocity_mps: Some(DVec2::new(1.0, 0.0)),
        id: None,
        label: Default::default(),
    };
    add.apply(&mut scene).expect("sound");
    let b = scene.frame().boxes[&BoxId(3)];
    assert_eq!(b.velocity_mps, DVec2::new(1.0, 0.0));
    assert!((b.yaw_rad - std::f64::consts::FRAC_PI_4).abs() < 1e-15);
    assert_eq!(label_at(&scene, -5.0, 5.0, 0), Class::Pedestrian.id());
    assert_eq!(label_at(&scene, -5.0, 5.0, 6), Class::Pedestrian.id());
    assert_eq!(label_at(&scene, -5.0, 5.0, 8), FREE);
    let moved = Edit::MoveBox {
        id: BoxId(3),
        center_m: Some(DVec3::new(-5.0, -5.0, 0.9)),
        yaw_deg: None,
        size_m: None,
    };
    moved.apply(&mut scene).expect("is there");
    assert_eq!(
        scene.frame().boxes[&BoxId(3)].yaw_rad,
        b.yaw_rad,
        "what is left out stays"
    );
    assert_eq!(label_at(&scene, -5.0, 5.0, 0), Class::Sidewalk.id());
    assert_eq!(label_at(&scene, -5.0, 5.0, 4), FREE);
    assert_eq!(label_at(&scene, -5.0, -5.0, 4), Class::Pedestrian.id());
    Edit::SetBoxClass {
        id: BoxId(3),
        class: Class::Barrier,
    }
    .apply(&mut scene)
    .expect("is there");
    assert_eq!(label_at(&scene, -5.0, -5.0, 4), Class::Barrier.id());
    assert_eq!(
        scene.frame().occupancy.class_counts()[Class::Pedestrian as usize],
        0
    );
}

#[test]
fn a_box_put_into_a_hedge_and_taken_out_leaves_the_hedge() {
    let mut scene = street();
    scene.change_canvas(|frame| {
        for x in 100..110 {
            frame.occupancy.column_mut(x, 130)[..4].fill(Class::Vegetation.id());
        }
        *frame = Frame::new(frame.layout.clone(), frame.boxes.clone(), frame.occupancy.clone());
    });
    let before = scene.frame().occupancy.clone();
    let mut put = car(9, 0.0, 0.0);
    put.center_m.x = 2.0;
    put.center_m.y = Extent::WINDOW.center(100, 130, 0).y;
    Edit::AddBox {
        class: put.class,
        center_m: put.center_m,
        size_m: put.size_m,
        yaw_deg: 0.0,
        velocity_mps: None,
        id: Some(put.id),
        label: Default::default(),
    }
    .apply(&mut scene)
    .expect("sound");
    assert!(scene.frame().occupancy.count_different(&before) > 100);
    Edit::RemoveBox { id: put.id }.apply(&mut scene).expect("there");
    assert_eq!(scene.frame().occupancy, before);
}

#[test]
fn a_label_is_no_work_for_the_networks_and_goes_with_the_class() {
    let mut scene = street();
    let before = scene.frame().clone();
    let label = scene::BoxLabel {
        name: BoxName::new("taxi"),
        paint: Some(scene::Paint::Yellow),
    };
    let id = BoxId(1);
    let edit = Edit::LabelBox { id, label };
    edit.apply(&mut scene).expect("box 1 is there");
    let frame = scene.frame();
    assert_eq!(frame.boxes[&id].called(), "yellow taxi");
    assert_eq!(frame.occupancy, before.occupancy);
    assert_eq!(frame.boxes, frame.source.boxes, "nothing waits to be generated");
    let class = Class::Truck;
    Edit::SetBoxClass { id, class }
        .apply(&mut scene)
        .expect("a class of objects");
    assert_eq!(scene.frame().boxes[&id].called(), "yellow truck");
    let nobody = Edit::LabelBox { id: BoxId(99), label };
    assert!(matches!(
        nobody.apply(&mut scene),
        Err(EditError::UnknownBox { .. })
    ));
}

#[test]
fn ids_run_on_and_find_gaps() {
    let mut scene = street();
    let add = |id| Edit::AddBox {
        class: Class::TrafficCone,
        center_m: DVec3::new(-10.0, 0.0, 0.4),
        size_m: DVec3::new(0.4, 0.4, 0.8),
        yaw_deg: 0.0,
        velocity_mps: None,
        id,
        label: Default::default(),
    };
    add(Some(BoxId(u32::MAX))).apply(&mut scene).expect("free");
    add(None).apply(&mut scene).expect("a gap is left");
    let ids: Vec<u32> = scene.frame().boxes.keys().map(|id| id.0).collect();
    assert_eq!(ids, [1, 2, 3, u32::MAX]);
}
