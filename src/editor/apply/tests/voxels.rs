//! Paint.

use super::*;

#[test]
fn painted_voxels_are_locked() {
    let mut scene = street();
    let source = scene.frame().source.clone();
    let [x, y] = cell(10.1, 1.7);
    let paint = |z, class| Edit::PaintVoxels {
        cells: vec![[x, y, z]],
        class,
    };
    paint(3, Class::Free).apply(&mut scene).expect("inside");
    paint(12, Class::Car).apply(&mut scene).expect("inside");
    paint(0, Class::Manmade).apply(&mut scene).expect("inside");
    let column = |scene: &Scene| scene.frame().occupancy.column(x, y).to_vec();
    assert_eq!(column(&scene)[3], FREE);
    // Neither stamping nor clearing nor ground touches them.
    let nudge = |dx: f64| Edit::MoveBox {
        id: BoxId(1),
        center_m: Some(DVec3::new(10.0 + dx, 1.6, 0.85)),
        yaw_deg: None,
        size_m: None,
    };
    nudge(0.2).apply(&mut scene).expect("is there");
    assert_eq!(column(&scene)[2], Class::Car.id());
    assert_eq!(
        [column(&scene)[0], column(&scene)[3], column(&scene)[12]],
        [15, FREE, 4]
    );
    Edit::RemoveBox { id: BoxId(1) }
        .apply(&mut scene)
        .expect("is there");
    assert_eq!(
        [column(&scene)[0], column(&scene)[2], column(&scene)[12]],
        [15, FREE, 4]
    );
    // A result cannot overrule them either.
    scene = crate::replay::with_result(&scene, VoxelGrid::new(), None).expect("always");
    assert_eq!([column(&scene)[0], column(&scene)[12]], [15, 4]);
    assert_eq!(scene.frame().occupancy.count_set(), 2);
    assert!(!Arc::ptr_eq(&source, &scene.frame().source));
    assert_eq!(scene.frame().source.occupancy, scene.frame().occupancy);
    assert_eq!(scene.frame().source.boxes, scene.frame().boxes);
    // Unlocking keeps what is shown.
    Edit::UnlockVoxels {
        cells: vec![[x, y, 0]],
    }
    .apply(&mut scene)
    .expect("inside");
    assert_eq!(scene.frame().painted.get(x, y, 0), NOT_PAINTED);
    assert_eq!(scene.frame().painted.count_set(), 2);
    assert_eq!(column(&scene)[0], 15);
    Edit::ClearPaint {}.apply(&mut scene).expect("always");
    assert_eq!(scene.frame().painted.count_set(), 0);
}
